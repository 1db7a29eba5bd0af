/**
 * Joins one session, the turns of the page and the sound. No page, no socket, no sound card in here:
 * bytes and what is heard come in as arguments; commands, bytes and events go out through ports.
 */

import { ProtocolError } from "../protocol/codec";
import { LIMITS, type Begin, type ClientMessage, type Hello, type Listen, type Live, type Ready } from "../protocol/generated";
import { ClientSession, type ServerEvent } from "../protocol/session";
import type { TurnBuffer } from "../stream/buffer";
import type { Heard } from "../stream/heard";
import { HeadFault, OwnTurn, Turn, type SpeakOptions, type TurnDesk, type TurnEnd } from "./turn";
import { Turns, type Spoken, type Stage } from "./turns";

const ACK_MS = 250;
/** A listener has no credit to give: it only says how it fares. */
const LISTENER_ACK_MS = 5000;
const PING_MS = 10_000;
/** Of one `hear`. */
const MOST_SAMPLES = 8192;
const SILENT_MS = 30_000;
/** Errors after which the server has forgotten the turn they name. */
const REFUSALS = new Set(["too_many_turns", "unknown_voice", "unknown_language", "voice_unavailable"]);

/** A factor as whole percent, from `least` to four times. */
const percent = (factor: number, least: number): number => Math.round(Math.min(400, Math.max(least, factor * 100)));

export interface Ports extends Stage {
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Close the connection; `disconnected` follows. */
  drop(): void;
}

/** What a session is for: to speak, or to watch a channel. */
export type Wish = Omit<Hello, "type" | "resume" | "received"> | Omit<Listen, "type" | "talk" | "turn" | "sample">;

export class Conversation implements TurnDesk {
  ready: Ready | null = null;
  underruns = 0;
  /** Picture minus sound in microseconds; whoever draws it says so. */
  skew = 0;
  private session = new ClientSession();
  private readonly turns: Turns;
  /** Packets that came when their sound should have been heard. */
  late = 0;
  private listens = false;
  private talk: string | undefined;
  /** The server's key to this session, as long as it may be resumed. */
  private key: string | undefined;
  private lostAt: number | null = null;
  private outbox: ClientMessage[] = [];
  private last = 0;
  private acked = 0;
  private pinged = 0;
  private listened = 0;

  constructor(private readonly ports: Ports) {
    this.turns = new Turns(ports);
  }

  /** Turns that are not over. */
  get busy(): boolean {
    return this.turns.size > 0;
  }

  // --- the connection

  /** There is a connection: say what it is for, and go on where the one before it broke off. */
  connected(wish: Wish): void {
    this.listened = this.pinged = this.ports.now();
    this.session.reconnect();
    this.listens = "channel" in wish && !("fps" in wish);
    if (this.listens) this.send({ ...(wish as Listen), type: "listen", ...this.place() });
    else this.send({ type: "hello", ...wish, ...(this.key !== undefined && { resume: this.key, received: this.session.received }) });
  }

  /** The connection is lost. What is being said is not, if it comes back soon. */
  disconnected(): void {
    this.ready = null;
    this.lostAt ??= this.ports.now();
    if (this.key === undefined && !this.listens) this.forget();
  }

  /** Say goodbye. */
  leave(): void {
    if (this.ready) this.send({ type: "bye" });
    this.key = undefined;
    this.disconnected();
    this.forget();
  }

  /** The turns that the server knew are lost. */
  private forget(): void {
    const unsent = new Set(this.outbox.map((message) => ("turn" in message ? message.turn : 0)));
    for (const live of this.turns.all()) {
      if (!unsent.has(live.turn.id)) this.turns.fail(live, "connection_lost", "the connection to the server was lost");
    }
  }

  /** A listener's: what it has of the talk that it hears. */
  private place(): Partial<Listen> {
    const turn = this.turns.all().at(-1);
    return this.talk === undefined || !turn?.buffer ? {} : { talk: this.talk, turn: turn.turn.id, sample: turn.buffer.received };
  }

  /** No turn can be heard, for this reason. */
  silence({ code, message }: HeadFault): void {
    this.outbox = [];
    for (const live of this.turns.all()) this.turns.fail(live, code, message, true);
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
    if (this.listens) throw new HeadFault("listening", "a head that listens to a channel does not speak");
    const turn = new Turn(++this.last, options, this);
    this.turns.add(turn);
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

  /** A turn of sound, so many samples a second. */
  hear(sampleRate: number): OwnTurn {
    if (this.listens) throw new HeadFault("listening", "a head that listens to a channel does not speak");
    const turn = new OwnTurn(++this.last, this);
    this.turns.add(turn);
    this.post({ type: "hear", turn: turn.id, pcm: new Int16Array(0), sample_rate: sampleRate });
    return turn;
  }

  /** Sound while there is no connection is let go: nobody waits for what was said then. */
  feed(turn: Turn, pcm: Int16Array): void {
    if (!this.ready || !this.turns.get(turn.id)) return;
    for (let at = 0; at < pcm.length; at += MOST_SAMPLES) {
      this.send({ type: "hear", turn: turn.id, pcm: pcm.slice(at, at + MOST_SAMPLES) });
    }
  }

  end(turn: Turn): void {
    this.post({ type: "end", turn: turn.id });
  }

  interrupt(turn: Turn): Promise<TurnEnd> {
    const live = this.turns.get(turn.id);
    if (!live || live.stopping) return turn.finished;
    this.ports.sound({ kind: "stop", turn: turn.id });
    const unsent = this.outbox.some((message) => (message.type === "speak" || message.type === "hear") && message.turn === turn.id);
    if (!this.ready || this.listens || live.done || unsent) {
      this.outbox = this.outbox.filter((message) => !("turn" in message) || message.turn !== turn.id);
      if (!this.ready && !unsent && !live.done) this.outbox.push({ type: "interrupt", turn: turn.id, heard: Math.floor(live.heard) });
      this.turns.cut(live);
      return turn.finished;
    }
    this.turns.stop(live);
    this.send({ type: "interrupt", turn: turn.id, heard: Math.floor(live.heard) });
    return turn.finished;
  }

  /** Stop everything said or waiting; tells how far the first of them got. */
  async interruptAll(): Promise<TurnEnd | null> {
    const ends = this.turns.all().map(({ turn }) => this.interrupt(turn));
    return (await Promise.allSettled(ends)).find((end) => end.status === "fulfilled")?.value ?? null;
  }

  splice(turn: Turn, char: number): void {
    if (this.turns.get(turn.id)) this.post({ type: "splice", turn: turn.id, char, ...this.heardOf(turn) });
  }

  seek(turn: Turn, back: number): void {
    if (this.turns.get(turn.id)) this.post({ type: "seek", turn: turn.id, back, ...this.heardOf(turn) });
  }

  pause(turn: Turn, on: boolean): void {
    if (!this.turns.get(turn.id)) return;
    this.ports.sound({ kind: "pause", on });
    this.post(on ? { type: "pause", turn: turn.id, ...this.heardOf(turn) } : { type: "continue", turn: turn.id });
  }

  private heardOf(turn: Turn): { heard?: number } {
    const live = this.turns.get(turn.id);
    return live?.buffer ? { heard: Math.floor(live.heard) } : {};
  }

  // --- time

  /** The face's source at the heard sample; null if that turn is not (or no longer) ours to show. */
  bufferOf(heard: Heard | null): TurnBuffer | null {
    return this.turns.at(heard)?.buffer ?? null;
  }

  /** When text of a turn was first handed in (ms), and its first audible sample, as far as they are known. */
  onsetOf(turn: number): { asked: number; sample: number } | null {
    const live = this.turns.get(turn);
    const asked = live?.turn.askedAt;
    const sample = live?.buffer?.onset ?? null;
    return asked === undefined || sample === null ? null : { asked, sample };
  }

  /** Sound received and not yet heard, of all turns, in ms. */
  get queueMs(): number {
    return this.turns.queueMs;
  }

  /** `heard` is what is heard now. Tells the page what was reached, and the server four times a second. */
  advance(heard: Heard | null): void {
    const now = this.ports.now();
    if (this.lostAt !== null && now - this.lostAt > LIMITS.linger_ms) this.giveUp();
    this.turns.advance(heard);
    const live = this.turns.at(heard);
    if (live?.buffer && now - this.acked >= (this.listens ? LISTENER_ACK_MS : ACK_MS)) this.ack(live, live.buffer);
    this.keepAlive();
  }

  /** The server keeps the session no longer. */
  private giveUp(): void {
    this.lostAt = null;
    this.key = undefined;
    this.forget();
  }

  private ack(live: Spoken, buffer: TurnBuffer): void {
    if (!this.ready) return;
    this.acked = this.ports.now();
    const sample = Math.floor(live.heard);
    const queue = Math.max(0, buffer.received - sample);
    const { underruns, late } = this;
    const { received } = this.session;
    this.send({ type: "ack", turn: live.turn.id, sample, queue, underruns, skew: Math.round(this.skew), received, late });
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

  private take(message: ServerEvent): void {
    switch (message.type) {
      case "ready": return this.greet(message);
      case "begin": return this.open(message);
      case "packet": return this.turns.packet(message);
      case "done": return this.turns.done(message);
      case "discard": return this.turns.discard(message);
      case "live": return this.watch(message);
      case "skip": return this.ports.emit("skip", { reason: message.reason });
      case "pause": return this.ports.sound({ kind: "pause", on: true });
      case "continue": return this.ports.sound({ kind: "pause", on: false });
      case "error": return this.complain(message);
      case "bye": return this.ports.drop();
      case "pong": return;
    }
  }

  private greet(ready: Ready): void {
    const back = this.lostAt !== null;
    this.ready = ready;
    this.lostAt = null;
    this.key = ready.resume;
    if (back && !ready.resumed && !this.listens) this.forget();
    for (const data of this.session.again) this.ports.send(data);
    const { server, voices, heads, fps, channel, listen } = ready;
    const resumed = ready.resumed ?? false;
    this.ports.emit("ready", { server, voices, heads, fps, resumed, ...(channel && { channel }), ...(listen && { listen }) });
    for (const message of this.outbox.splice(0)) this.send(message);
  }

  /** To a listener: who speaks. With another one, what was being said is over. */
  private watch({ on, talk, channel }: Live): void {
    if (talk !== this.talk || !on) {
      for (const live of this.turns.all()) {
        this.ports.sound({ kind: "stop", turn: live.turn.id });
        this.turns.cut(live);
      }
    }
    this.talk = talk;
    this.ports.emit("live", { channel, on, ...(talk !== undefined && { talk }) });
  }

  private open(begin: Begin): void {
    const live = this.turns.get(begin.turn) ?? (this.listens ? this.turns.add(new Turn(begin.turn, {}, this)) : undefined);
    if (!live || live.stopping || live.buffer || !this.ready) return;
    this.turns.begin(live, begin, this.ready.faps, this.listens || begin.delay !== undefined);
  }

  private complain({ code, message, fatal, turn }: { code: string; message: string; fatal: boolean; turn?: number }): void {
    const live = turn === undefined ? undefined : this.turns.get(turn);
    if (live && !live.buffer && REFUSALS.has(code)) this.turns.fail(live, code, message, fatal);
    else this.ports.emit("error", new HeadFault(code, message, fatal, turn));
    if (fatal) this.ports.drop();
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
