/** The turns that are not over: what has come of each, how far it has been heard, and how it ends. */

import { LIMITS, type Begin, type Discard, type Done } from "../protocol/generated";
import type { Slice } from "../protocol/session";
import { TurnBuffer } from "../stream/buffer";
import type { Heard } from "../stream/heard";
import type { Command } from "../stream/player";
import { HeadFault, type Turn, type TurnEnd } from "./turn";

export interface Stage {
  sound(command: Command): void;
  emit(name: string, detail: object): void;
  /** Monotonic milliseconds. */
  now(): number;
}

/** One turn on its way from `speak` to its last sample. */
export interface Spoken {
  readonly turn: Turn;
  /** What has come of it, from its `begin` on. */
  buffer: TurnBuffer | null;
  done: Done | null;
  heard: number;
  /** End of the last word begun, in code points. */
  char: number;
  /** It was interrupted; so long the server may take to say where. */
  stopping: { deadline: number } | null;
}

export class Turns {
  private readonly live = new Map<number, Spoken>();

  constructor(private readonly stage: Stage) {}

  get size(): number {
    return this.live.size;
  }

  get(id: number): Spoken | undefined {
    return this.live.get(id);
  }

  /** In the order in which they were added. */
  all(): Spoken[] {
    return [...this.live.values()];
  }

  add(turn: Turn): Spoken {
    const spoken = { turn, buffer: null, done: null, heard: 0, char: 0, stopping: null };
    this.live.set(turn.id, spoken);
    return spoken;
  }

  // --- what comes of them

  begin(live: Spoken, begin: Begin, faps: Uint8Array, asItComes: boolean): void {
    live.buffer = new TurnBuffer(begin, faps);
    this.stage.sound({ kind: "begin", turn: begin.turn, rate: begin.sample_rate, live: asItComes });
    const { sample = 0, marks = [] } = begin;
    if (marks.length) live.buffer.push({ sample, pcm: new Int16Array(0), frames: [], marks });
    const { voice, lang, sample_rate: sampleRate } = begin;
    this.stage.emit("begin", { turn: begin.turn, voice, lang, sampleRate });
  }

  packet(packet: Slice): void {
    const buffer = this.coming(packet.turn);
    if (!buffer) return;
    const { turn, sample, pcm, hold } = packet;
    buffer.push(packet);
    this.stage.sound({ kind: "pcm", turn, sample, pcm, hold });
  }

  discard({ turn, sample, char }: Discard): void {
    const buffer = this.coming(turn);
    if (!buffer) return;
    buffer.discard(sample);
    this.stage.sound({ kind: "discard", turn, sample });
    this.stage.emit("revised", { turn, sample, char });
  }

  done(done: Done): void {
    const live = this.live.get(done.turn);
    if (!live) return;
    live.done = done;
    if (live.stopping || !live.buffer) this.settle(live, done);
    else this.stage.sound({ kind: "end", turn: done.turn });
  }

  private coming(id: number): TurnBuffer | null {
    const live = this.live.get(id);
    return live && !live.stopping ? live.buffer : null;
  }

  // --- how far they are heard

  /** `heard` is what is heard now. Tells the page what was reached. */
  advance(heard: Heard | null): void {
    const now = this.stage.now();
    for (const live of this.all()) {
      if (live.stopping && now > live.stopping.deadline) this.cut(live);
      else if (heard && live.buffer && live.turn.id <= heard.turn) this.reach(live, live.buffer, heard);
    }
  }

  private reach(live: Spoken, buffer: TurnBuffer, heard: Heard): void {
    const { turn } = live;
    if (live.stopping) return;
    if (turn.id === heard.turn) {
      live.heard = Math.min(heard.sample, buffer.received);
      turn.settleStart(buffer.begin);
      this.pass(live, buffer);
    }
    if (live.done && (turn.id < heard.turn || heard.state === "over")) {
      live.heard = buffer.received;
      this.pass(live, buffer);
      this.settle(live, live.done);
    }
  }

  /** The marks that were reached, as events. */
  private pass(live: Spoken, buffer: TurnBuffer): void {
    for (const mark of buffer.take(live.heard)) {
      if (mark.kind === "word") live.char = mark.char_end ?? live.char;
      this.stage.emit(mark.kind, { turn: live.turn.id, ...mark });
    }
  }

  /** The turn that is heard; null if it is not (or no longer) ours to show. */
  at(heard: Heard | null): Spoken | null {
    const live = heard && heard.state !== "over" ? this.live.get(heard.turn) : undefined;
    return live && live.buffer && !live.stopping ? live : null;
  }

  /** Sound received and not yet heard, of all turns, in ms. */
  get queueMs(): number {
    let total = 0;
    for (const { buffer, heard } of this.live.values()) {
      if (buffer) total += (Math.max(0, buffer.received - heard) * 1000) / buffer.begin.sample_rate;
    }
    return total;
  }

  // --- how they end

  /** It is heard no more; the server has a while to say where it was cut. */
  stop(live: Spoken): void {
    live.turn.open = false;
    live.stopping = { deadline: this.stage.now() + LIMITS.interrupt_deadline_ms };
  }

  /** Interrupted, as far as this side can say. */
  cut(live: Spoken): void {
    const { turn, buffer, heard, char } = live;
    this.settle(live, { turn: turn.id, reason: "interrupted", samples: buffer?.received ?? 0, heard: Math.floor(heard), char });
  }

  fail(live: Spoken, code: string, message: string, fatal = false): void {
    const { id } = live.turn;
    const fault = new HeadFault(code, message, fatal, id);
    this.live.delete(id);
    this.stage.sound({ kind: "stop", turn: id });
    live.turn.settle(fault);
    this.stage.emit("error", fault);
  }

  private settle(live: Spoken, { turn, reason, samples, heard, char }: TurnEnd): void {
    this.live.delete(turn);
    const end: TurnEnd = { turn, reason, samples, ...(heard !== undefined && { heard }), ...(char !== undefined && { char }) };
    live.turn.settle(reason === "failed" ? new HeadFault("synthesis_failed", "the voice failed", false, turn) : end);
    this.stage.emit("done", end);
  }
}
