/**
 * What is asked of the server and what it answers, without a socket: one request at a time, and of each kind only the
 * newest waits. So a drag, however fast, is never more than one answer behind.
 */

import type { Asked, HeadUp, PhotoUp, PointsUp, ServerMessage } from "./wire";

/** A request before it has a number. */
export type Request = PhotoUp | Omit<PointsUp, "seq"> | Omit<HeadUp, "seq">;

/** Whose turn it is first: points belong to photos, heads to points. */
const ORDER = ["front", "profile", "points", "head"] as const;
type Kind = (typeof ORDER)[number];

export class Exchange {
  private readonly waiting = new Map<Kind, Request>();
  private current: Asked | null = null;
  private seq = 0;
  private open = false;

  constructor(private readonly send: (message: Asked) => void) {}

  /** Is a photo, or a head, being worked at or waiting? */
  busy(kind: Kind): boolean {
    return this.waiting.has(kind) || (this.current !== null && kindOf(this.current) === kind);
  }

  /** To be sent as soon as possible, in place of what waits of its kind; not at all while the server is not there. */
  ask(request: Request): void {
    if (!this.open) return;
    this.waiting.set(kindOf(request), request);
    this.next();
  }

  /** The server is there. */
  begin(): void {
    this.open = true;
  }

  /** The server is gone, and with it what it was asked. */
  end(): void {
    this.open = false;
    this.current = null;
    this.waiting.clear();
  }

  /** Does `message` answer the request at hand? What comes late, for another, does not. */
  settles(message: ServerMessage): boolean {
    const { current } = this;
    if (!current) return false;
    if (message.type === "error") return concerns(message, current);
    if (message.type === "photo") return current.type === "photo" && current.view === message.view;
    if (message.type === "fit") return current.type === "points" && current.seq === message.seq;
    return message.type === "head" && current.type === "head" && current.seq === message.seq;
  }

  /** The request at hand is answered: the next one, please. */
  proceed(): void {
    this.current = null;
    this.next();
  }

  private next(): void {
    if (!this.open || this.current) return;
    const kind = ORDER.find((k) => this.waiting.has(k));
    if (!kind) return;
    const request = this.waiting.get(kind)!;
    this.waiting.delete(kind);
    this.current = request.type === "photo" ? request : { ...request, seq: ++this.seq };
    this.send(this.current);
  }
}

function kindOf(request: Request): Kind {
  return request.type === "photo" ? request.view : request.type;
}

/** An error names the request that it is about by its number or its photo; one that names neither is about the only one. */
function concerns({ seq, view }: { seq?: number; view?: string }, current: Asked): boolean {
  if (seq !== undefined) return current.type !== "photo" && current.seq === seq;
  return view === undefined || current.type !== "photo" || current.view === view;
}
