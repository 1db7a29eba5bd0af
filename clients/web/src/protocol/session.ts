/**
 * The client's end of a conversation without the wire: messages to send become bytes, bytes received
 * become messages. The tables of protocol/schema/session.json decide what is allowed.
 */

import { decode, encode, ProtocolError } from "./codec";
import {
  SESSION_CLIENT, SESSION_SERVER, TURN_CLIENT, TURN_SERVER,
  type Begin, type ClientMessage, type Done, type Packet, type Ready, type ServerMessage,
} from "./generated";

const N_FAPS = 68;

interface Turn {
  state: string;
  begin: Begin | null;
  /** First sample of the packet that has to come next. */
  samples: number;
}

export class ClientSession {
  state = "opening";
  ready: Ready | null = null;
  private lastTurn = 0;
  private readonly turns = new Map<number, Turn>();

  /** The frame for a message. Throws ProtocolError, and changes nothing, if it does not fit. */
  send(message: ClientMessage): Uint8Array<ArrayBuffer> {
    const data = encode(message);
    const next = step(SESSION_CLIENT, this.state, message.type);
    if ("turn" in message) this.advance(TURN_CLIENT, message.turn, message.type);
    this.state = next;
    return data;
  }

  /** What a frame means; null if it is to be ignored. Throws ProtocolError. */
  receive(data: Uint8Array): ServerMessage | null {
    const message = decode(data, "server") as ServerMessage | null;
    if (!message) return null;
    const next = step(SESSION_SERVER, this.state, message.type);
    if (message.type === "begin" || message.type === "packet" || message.type === "done") {
      return this.receiveTurn(message);
    }
    if (message.type === "ready") this.greet(message);
    this.state = next;
    return message;
  }

  private greet(ready: Ready): void {
    if (!ready.faps.length || !ready.faps.every((n) => n >= 1 && n <= N_FAPS)) {
      throw new ProtocolError("ready.faps names FAPs that do not exist");
    }
    this.ready = ready;
  }

  private receiveTurn(message: Begin | Packet | Done): ServerMessage | null {
    const turn = this.turns.get(message.turn);
    if (!turn) return null;
    this.advance(TURN_SERVER, message.turn, message.type);
    if (message.type === "begin") turn.begin = message;
    if (message.type !== "packet") return message;
    this.follow(turn, message);
    return turn.state === "stopping" ? null : message;
  }

  /** Section 4 of the protocol: packets follow `begin` without gap or overlap. */
  private follow(turn: Turn, packet: Packet): void {
    const where = `turn ${packet.turn}: packet at ${packet.sample}`;
    if (!turn.begin) throw new ProtocolError(`${where} before begin`);
    if (packet.sample !== turn.samples) throw new ProtocolError(`${where}, expected ${turn.samples}`);
    const width = this.ready?.faps.length ?? 1;
    if (packet.faps.length % width) throw new ProtocolError(`${where}: FAP values are no frames of ${width}`);
    turn.samples += packet.pcm.length;
  }

  /** Take the turn's step; nothing happens to a turn that is over. */
  private advance(table: Record<string, Record<string, string>>, id: number, type: string): void {
    const known = this.turns.get(id);
    if (!known && id <= this.lastTurn) return;
    const next = step(table, known?.state ?? "new", type);
    if (next === "over") return void this.turns.delete(id);
    const turn = known ?? { state: next, begin: null, samples: 0 };
    turn.state = next;
    this.turns.set(id, turn);
    this.lastTurn = Math.max(this.lastTurn, id);
  }
}

function step(table: Record<string, Record<string, string>>, state: string, type: string): string {
  const next = table[state]?.[type];
  if (!next) throw new ProtocolError(`\`${type}\` does not fit a state of ${state}`);
  return next;
}
