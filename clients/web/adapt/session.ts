/** The session with the server: a socket that comes back, and one request after the other on it. */

import { Socket } from "../src/io/socket";
import { Exchange, type Request } from "./exchange";
import { decode, encode, SUBPROTOCOL, type Fault, type Fit, type Head, type Photo, type Ready, type ServerMessage } from "./wire";

/** What happens; `lost` until `ready` comes again, and what was asked in between is gone. */
export interface SessionEvents {
  ready(message: Ready): void;
  photo(message: Photo): void;
  fit(message: Fit): void;
  head(message: Head): void;
  error(message: Fault): void;
  lost(): void;
}

export class Session {
  private readonly socket: Socket;
  private readonly exchange: Exchange;

  constructor(url: string, token: string | null, private readonly events: SessionEvents) {
    this.exchange = new Exchange((message) => this.socket.send(encode(message)));
    this.socket = new Socket(url, SUBPROTOCOL, {
      open: () => this.socket.send(encode({ type: "hello", ...(token && { token }) })),
      message: (data) => this.received(data),
      close: () => (this.exchange.end(), this.events.lost()),
    });
    this.socket.start();
  }

  ask(request: Request): void {
    this.exchange.ask(request);
  }

  busy(kind: "front" | "profile" | "head"): boolean {
    return this.exchange.busy(kind);
  }

  private received(data: Uint8Array): void {
    let message: ServerMessage;
    try {
      message = decode(data);
    } catch (e) {
      this.events.error({ type: "error", code: "protocol", message: `from the server: ${(e as Error).message}`, fatal: true });
      return this.socket.drop();
    }
    this.take(message);
  }

  /** Answers that come too late are dropped; errors are told whatever they are about. */
  private take(message: ServerMessage): void {
    const settled = this.exchange.settles(message);
    if (message.type === "ready") this.exchange.begin();
    else if (!settled && message.type !== "error") return;
    this.tell(message);
    if (settled) this.exchange.proceed();
  }

  private tell(message: ServerMessage): void {
    (this.events[message.type] as (message: ServerMessage) => void)(message);
  }
}
