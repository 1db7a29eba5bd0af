/**
 * The client's end of a conversation without the wire: messages to send become bytes, bytes received
 * become events. The tables of protocol/schema/session.json decide what is allowed.
 */

import { decode, encode, ProtocolError } from "./codec";
import { FapDecoder } from "./faps";
import {
  EPHEMERAL, SESSION_CLIENT, SESSION_SERVER, TURN_CLIENT, TURN_SERVER,
  type Begin, type ClientMessage, type Mark, type Packet, type Ready, type ServerMessage,
} from "./generated";
import { Sent } from "./sent";

const N_FAPS = 68;
/** What is kept for a resumption; with more than this under way there is none. */
const KEEP_BYTES = 1 << 20;

/** A frame holds at a sample of its turn; `values` are of the channels that `ready.faps` names. */
export interface Frame {
  sample: number;
  values: Int32Array;
}

/** A packet with its frames read and its sound made good. */
export interface Slice {
  type: "packet";
  turn: number;
  sample: number;
  pcm: Int16Array;
  frames: Frame[];
  marks: Mark[];
  hold: boolean;
}

export type ServerEvent = Exclude<ServerMessage, Packet> | Slice;

interface Turn {
  state: string;
  begin: Begin | null;
  /** First sample of the packet that has to come next. */
  samples: number;
  faps: FapDecoder;
}

export class ClientSession {
  state = "opening";
  ready: Ready | null = null;
  /** Counted messages that have come. */
  received = 0;
  /** After a `ready` that resumes: frames to be sent again, before any other. */
  again: Uint8Array<ArrayBuffer>[] = [];
  private sent = new Sent();
  private talk: string | undefined;
  private lastTurn = 0;
  private readonly turns = new Map<number, Turn>();

  /** The frame for a message. Throws ProtocolError, and changes nothing, if it does not fit. */
  send(message: ClientMessage): Uint8Array<ArrayBuffer> {
    const data = encode(message);
    const next = step(SESSION_CLIENT, this.state, message.type);
    if ("turn" in message && message.type !== "listen") this.advance(TURN_CLIENT, message.turn, message.type);
    this.state = next;
    if (!EPHEMERAL.has(message.type)) {
      this.sent.append(data);
      this.sent.shrink(KEEP_BYTES);
    }
    return data;
  }

  /** The connection was lost: `hello` with `resume`, or `listen` with `talk`, may come next. */
  reconnect(): void {
    this.state = "opening";
  }

  /** What a frame means; null if it is to be ignored. Throws ProtocolError. */
  receive(data: Uint8Array): ServerEvent | null {
    const message = decode(data, "server", (type) => (this.received += Number(!EPHEMERAL.has(type)))) as ServerMessage | null;
    if (!message) return null;
    const next = step(SESSION_SERVER, this.state, message.type);
    switch (message.type) {
      case "begin": case "packet": case "discard": case "done": case "pause": case "continue":
        return this.receiveTurn(message);
      case "ready":
        this.greet(message);
        break;
      case "live":
        if (message.talk !== this.talk) this.forgetTurns();
        this.talk = message.talk;
        break;
      case "pong":
        if (message.received !== undefined) this.sent.forget(message.received);
    }
    this.state = next;
    return message;
  }

  private greet(ready: Ready): void {
    if (!ready.faps.length || !ready.faps.every((n) => n >= 1 && n <= N_FAPS)) {
      throw new ProtocolError("ready.faps names FAPs that do not exist");
    }
    this.again = [];
    if (ready.resumed) {
      const again = this.sent.after(ready.received ?? 0);
      if (!again) throw new ProtocolError("the server missed more than is kept here: no going on");
      this.again = again;
    } else if (this.state === "open") {
      this.forgetTurns();
      this.sent = new Sent();
      this.received = 0;
    }
    this.ready = ready;
  }

  private forgetTurns(): void {
    this.turns.clear();
    this.lastTurn = 0;
  }

  private receiveTurn(message: Extract<ServerMessage, { turn: number }> | Packet): ServerEvent | null {
    const watches = this.state === "listening" && message.type === "begin";
    if (!this.turns.has(message.turn) && !watches) return null;
    if (!this.advance(TURN_SERVER, message.turn, message.type)) return null;
    const turn = this.turns.get(message.turn);
    if (!turn) return message as ServerEvent;
    if (message.type === "begin") {
      Object.assign(turn, { begin: message, samples: message.sample ?? 0, faps: new FapDecoder(this.ready?.faps.length ?? 1) });
    } else if (message.type === "discard") {
      turn.samples = Math.min(turn.samples, message.sample);
    }
    if (message.type !== "packet") return message as ServerEvent;
    const slice = this.read(turn, message);
    return turn.state === "stopping" ? null : slice;
  }

  /** Section 4 of the protocol: packets follow `begin` without overlap, and to a speaker without a gap. */
  private read(turn: Turn, packet: Packet): Slice {
    const { type, sample, marks = [], hold = false } = packet;
    const where = `turn ${packet.turn}: packet at ${sample}`;
    if (!turn.begin) throw new ProtocolError(`${where} before begin`);
    if (sample < turn.samples || (sample > turn.samples && turn.state !== "watched")) {
      throw new ProtocolError(`${where}, expected ${turn.samples}`);
    }
    const pcm = packet.pcm ?? new Int16Array(packet.samples ?? 0);
    const { fps, sample_rate: rate } = turn.begin;
    const first = Math.ceil((sample * fps) / rate);
    const frames = turn.faps.decode(packet).map((values, k) => ({ sample: Math.floor(((first + k) * rate) / fps), values }));
    turn.samples = sample + pcm.length;
    return { type, turn: packet.turn, sample, pcm, frames, marks, hold };
  }

  /** Take the turn's step; false if the turn is over and nothing is to happen. */
  private advance(table: Record<string, Record<string, string>>, id: number, type: string): boolean {
    const known = this.turns.get(id);
    if (!known && id <= this.lastTurn) return false;
    const next = step(table, known?.state ?? "new", type);
    if (next === "over") return this.turns.delete(id);
    const turn = known ?? { state: next, begin: null, samples: 0, faps: new FapDecoder(1) };
    turn.state = next;
    this.turns.set(id, turn);
    this.lastTurn = Math.max(this.lastTurn, id);
    return true;
  }
}

function step(table: Record<string, Record<string, string>>, state: string, type: string): string {
  const next = table[state]?.[type];
  if (!next) throw new ProtocolError(`\`${type}\` does not fit a state of ${state}`);
  return next;
}
