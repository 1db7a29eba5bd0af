/**
 * Joins one session, the turns of the page and the sound. No page, no socket, no sound card in here:
 * bytes and what is heard come in as arguments; commands, bytes and events go out through ports.
 */

import { ProtocolError } from "../protocol/codec";
import { LIMITS, type Begin, type ClientMessage, type Done, type Hello, type Packet, type Ready, type ServerMessage } from "../protocol/generated";
import { ClientSession } from "../protocol/session";
import { TurnBuffer, type Frame } from "../stream/buffer";
import type { Heard } from "../stream/heard";
import type { Command } from "../stream/player";
import { HeadFault, Turn, type SpeakOptions, type TurnDesk, type TurnEnd } from "./turn";

const ACK_MS = 250;
const PING_MS = 10_000;
const SILENT_MS = 30_000;
/** Errors after which the server has forgotten the turn they name. */
const REFUSALS = new Set(["too_many_turns", "unknown_voice", "unknown_language", "voice_unavailable"]);

/** A factor as whole percent, from `least` to four times. */
const percent = (factor: number, least: number): number => Math.round(Math.min(400, Math.max(least, factor * 100)));

export interface Ports {
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Close the connection; `disconnected` follows. */
  drop(): void;
  sound(command: Command): void;
  emit(name: string, detail: object): void;
  /** Monotonic milliseconds. */
  now(): number;
}

/** One turn on its way from `speak` to its last sample. */
interface Live {
  turn: Turn;
  buffer: TurnBuffer | null;
  done: Done | null;
  heard: number;
  /** End of the last word begun, in code points. */
  char: number;
  stopping: { deadline: number } | null;
}

export class Conversation implements TurnDesk {
  ready: Ready | null = null;
  underruns = 0;
  /** Picture minus sound in microseconds; whoever draws it says so. */
  skew = 0;
  private session = new ClientSession();
  private readonly live = new Map<number, Live>();
  private outbox: ClientMessage[] = [];
  private last = 0;
  private acked = 0;
  private pinged = 0;
  private listened = 0;

  constructor(private readonly ports: Ports) {}

  /** Turns that are not over. */
  get busy(): boolean {
    return this.live.size > 0;
  }

  // --- the connection

  connected(hello: Omit<Hello, "type">): void {
    this.session = new ClientSession();
    this.listened = this.pinged = this.ports.now();
    this.send({ type: "hello", ...hello });
  }

  disconnected(): void {
    this.ready = null;
    this.session = new ClientSession();
    const unsent = new Set(this.outbox.map((message) => ("turn" in message ? message.turn : 0)));
    for (const id of [...this.live.keys()]) {
      if (!unsent.has(id)) this.fail(new HeadFault("connection_lost", "the connection to the server was lost", false, id));
    }
  }

  /** Say goodbye. */
  leave(): void {
    if (this.ready) this.send({ type: "bye" });
    this.disconnected();
  }

  /** No turn can be heard, for this reason. */
  silence({ code, message }: HeadFault): void {
    this.outbox = [];
    for (const id of [...this.live.keys()]) this.fail(new HeadFault(code, message, true, id));
  }

  received(data: Uint8Array): void {
    this.listened = this.ports.now();
    try {
      const message = this.session.receive(data);
      if (message) this.take(message);
    } catch (e) {
      if (!(e instanceof ProtocolError)) throw e;
      this.ports.emit("error", new HeadFault(e.code, `from the server: ${e.message}`, e.fatal));
      if (e.fatal) this.ports.drop();
    }
  }

  // --- what the page wants

  speak(text: string, options: SpeakOptions): Turn {
    const turn = new Turn(++this.last, options, this);
    this.live.set(turn.id, { turn, buffer: null, done: null, heard: 0, char: 0, stopping: null });
    turn.append(text);
    return options.open ? turn : turn.end();
  }

  append(turn: Turn, bytes: Uint8Array): void {
    if (bytes.length) turn.askedAt ??= this.ports.now();
    const { lang, voice, rate, pitch, volume, lookAhead } = turn.options;
    const wishes = {
      ...(lang && { lang }), ...(voice && { voice }),
      ...(rate && { rate: percent(rate, 25) }),
      ...(pitch && { pitch: percent(pitch, 25) }),
      ...(volume !== undefined && { volume: percent(volume, 0) }),
      ...(lookAhead !== undefined && { look_ahead: Math.round(Math.min(1000, Math.max(0, lookAhead))) }),
    };
    const step = LIMITS.max_fragment_bytes;
    for (let at = 0; at === 0 || at < bytes.length; at += step) {
      this.post({ type: "speak", turn: turn.id, text: bytes.subarray(at, at + step), ...wishes });
    }
  }

  end(turn: Turn): void {
    this.post({ type: "end", turn: turn.id });
  }

  interrupt(turn: Turn): Promise<TurnEnd> {
    const live = this.live.get(turn.id);
    if (!live || live.stopping) return turn.finished;
    this.ports.sound({ kind: "stop", turn: turn.id });
    if (!this.ready || live.done || this.outbox.some((message) => "turn" in message && message.turn === turn.id)) {
      this.outbox = this.outbox.filter((message) => !("turn" in message) || message.turn !== turn.id);
      this.settle(live, this.cut(live));
      return turn.finished;
    }
    turn.open = false;
    live.stopping = { deadline: this.ports.now() + LIMITS.interrupt_deadline_ms };
    this.send({ type: "interrupt", turn: turn.id, heard: Math.floor(live.heard) });
    return turn.finished;
  }

  /** Stop everything said or waiting; tells how far the first of them got. */
  async interruptAll(): Promise<TurnEnd | null> {
    const ends = [...this.live.values()].map(({ turn }) => this.interrupt(turn));
    return (await Promise.allSettled(ends)).find((end) => end.status === "fulfilled")?.value ?? null;
  }

  // --- time

  /** The face's source at the heard sample; null if that turn is not (or no longer) ours to show. */
  bufferOf(heard: Heard | null): TurnBuffer | null {
    const live = heard && heard.state !== "over" ? this.live.get(heard.turn) : undefined;
    return live && !live.stopping ? live.buffer : null;
  }

  /** When text of a turn was first handed in (ms), and its first audible sample, as far as they are known. */
  onsetOf(turn: number): { asked: number; sample: number } | null {
    const live = this.live.get(turn);
    const asked = live?.turn.askedAt;
    const sample = live?.buffer?.onset ?? null;
    return asked === undefined || sample === null ? null : { asked, sample };
  }

  /** Sound received and not yet heard, of all turns, in ms. */
  get queueMs(): number {
    let total = 0;
    for (const { buffer, heard } of this.live.values()) {
      if (buffer) total += (Math.max(0, buffer.received - heard) * 1000) / buffer.begin.sample_rate;
    }
    return total;
  }

  /** `heard` is what is heard now. Tells the page what was reached, and the server four times a second. */
  advance(heard: Heard | null): void {
    const now = this.ports.now();
    for (const live of [...this.live.values()]) {
      if (live.stopping && now > live.stopping.deadline) this.settle(live, this.cut(live));
      else if (heard && live.buffer && live.turn.id <= heard.turn) this.reach(live, heard);
    }
    this.keepAlive();
  }

  private reach(live: Live, heard: Heard): void {
    const { turn, buffer } = live;
    if (live.stopping || !buffer) return;
    const over = turn.id < heard.turn || heard.state === "over";
    if (turn.id === heard.turn) {
      live.heard = Math.min(heard.sample, buffer.received);
      live.turn.settleStart(buffer.begin);
      this.pass(live, buffer);
      if (!over && this.ports.now() - this.acked >= ACK_MS) this.ack(live, buffer);
    }
    if (over && live.done) {
      live.heard = buffer.received;
      this.pass(live, buffer);
      this.settle(live, live.done);
    }
  }

  /** The marks that were reached, as events. */
  private pass(live: Live, buffer: TurnBuffer): void {
    for (const mark of buffer.take(live.heard)) {
      if (mark.kind === "word") live.char = mark.char_end ?? live.char;
      this.ports.emit(mark.kind, { turn: live.turn.id, ...mark });
    }
  }

  private ack(live: Live, buffer: TurnBuffer): void {
    this.acked = this.ports.now();
    const sample = Math.floor(live.heard);
    const queue = Math.max(0, buffer.received - sample);
    this.send({ type: "ack", turn: live.turn.id, sample, queue, underruns: this.underruns, skew: Math.round(this.skew) });
  }

  /** Ask now and then whether the server is still there; a question without an answer ends the connection. */
  private keepAlive(): void {
    const now = this.ports.now();
    if (!this.ready || now - this.pinged < PING_MS) return;
    if (this.listened < this.pinged) {
      if (now - this.pinged > SILENT_MS) this.ports.drop();
      return;
    }
    this.pinged = now;
    this.send({ type: "ping", id: Math.floor(now) % 2 ** 32 });
  }

  // --- what the server says

  private take(message: ServerMessage): void {
    switch (message.type) {
      case "ready": return this.greet(message);
      case "begin": return this.open(message);
      case "packet": return this.feed(message);
      case "done": return this.finish(message);
      case "error": return this.complain(message);
      case "bye": return this.ports.drop();
      case "pong": return;
    }
  }

  private greet(ready: Ready): void {
    this.ready = ready;
    const { server, voices, heads, fps } = ready;
    this.ports.emit("ready", { server, voices, heads, fps });
    for (const message of this.outbox.splice(0)) this.send(message);
  }

  private open(begin: Begin): void {
    const live = this.live.get(begin.turn);
    if (!live || live.stopping || !this.ready) return;
    live.buffer = new TurnBuffer(begin, this.ready.faps);
    this.ports.sound({ kind: "begin", turn: begin.turn, rate: begin.sample_rate });
    const { voice, lang, sample_rate: sampleRate } = begin;
    this.ports.emit("begin", { turn: begin.turn, voice, lang, sampleRate });
  }

  private feed(packet: Packet): void {
    const live = this.live.get(packet.turn);
    if (!live?.buffer || live.stopping) return;
    const { turn, sample, pcm, marks = [], hold = false } = packet;
    live.buffer.push({ sample, pcm, marks, frames: framesOf(packet, live.buffer.begin, this.ready!.faps.length) });
    this.ports.sound({ kind: "pcm", turn, sample, pcm, hold });
  }

  private finish(done: Done): void {
    const live = this.live.get(done.turn);
    if (!live) return;
    live.done = done;
    if (live.stopping || !live.buffer) this.settle(live, done);
    else this.ports.sound({ kind: "end", turn: done.turn });
  }

  private complain({ code, message, fatal, turn }: { code: string; message: string; fatal: boolean; turn?: number }): void {
    const fault = new HeadFault(code, message, fatal, turn);
    const live = turn === undefined ? undefined : this.live.get(turn);
    if (live && !live.buffer && REFUSALS.has(code)) this.fail(fault);
    else this.ports.emit("error", fault);
    if (fatal) this.ports.drop();
  }

  // --- the end of a turn

  /** How an interrupted turn ends if only this side can say. */
  private cut(live: Live): TurnEnd {
    const { turn, buffer, heard, char } = live;
    return { turn: turn.id, reason: "interrupted", samples: buffer?.received ?? 0, heard: Math.floor(heard), char };
  }

  private settle(live: Live, { turn, reason, samples, heard, char }: TurnEnd): void {
    this.live.delete(turn);
    const end: TurnEnd = { turn, reason, samples, ...(heard !== undefined && { heard }), ...(char !== undefined && { char }) };
    live.turn.settle(reason === "failed" ? new HeadFault("synthesis_failed", "the voice failed", false, turn) : end);
    this.ports.emit("done", end);
  }

  private fail(fault: HeadFault): void {
    const live = this.live.get(fault.turn!)!;
    this.live.delete(fault.turn!);
    this.ports.sound({ kind: "stop", turn: fault.turn! });
    live.turn.settle(fault);
    this.ports.emit("error", fault);
  }

  /** Send now, or once the server is ready. */
  private post(message: ClientMessage): void {
    if (this.ready) this.send(message);
    else this.outbox.push(message);
  }

  private send(message: ClientMessage): void {
    this.ports.send(this.session.send(message));
  }
}

/** The packet's FAP frames, `width` values each: frame k of the turn holds at sample k * sample_rate / fps. */
function framesOf({ sample, faps }: Packet, { fps, sample_rate }: Begin, width: number): Frame[] {
  const first = Math.ceil((sample * fps) / sample_rate);
  return Array.from({ length: faps.length / width }, (_, k) => (
    { sample: ((first + k) * sample_rate) / fps, values: faps.subarray(k * width, (k + 1) * width) }
  ));
}
