/**
 * What the sound processor does, without the sound card: turns in, context frames out, and reports
 * that say which sample of which turn is rendered at which context frame. Twin of fapstream/stream/player.py.
 */

import { Jitter } from "./jitter";
import { fall, type Sound } from "./stretch";
import { Voice } from "./voice";

/**
 * `pcm` begins at `sample`; `live`: see Voice. `discard`: what was not played from `sample` on is not to be played, the next
 * push goes on there. `pause`: fall silent, and go on with the next sample when it is over. `catch-up`: of a live talk play
 * what is being said now.
 */
export type Command =
  | { kind: "begin"; turn: number; rate: number; live?: boolean }
  | { kind: "pcm"; turn: number; sample: number; pcm: Int16Array; hold: boolean }
  | { kind: "discard"; turn: number; sample: number }
  | { kind: "end"; turn: number }
  | { kind: "stop"; turn: number }
  | { kind: "pause"; on: boolean }
  | { kind: "catch-up" };

/** How it goes. `storeMs` is of the turn being played; `stretchedMs` what was left out or said twice. */
export interface PlayerStats {
  underruns: number;
  late: number;
  storeMs: number;
  targetMs: number;
  stretchedMs: number;
}

/**
 * `sample` (which may lie between two) is rendered at context frame `frame`. From `play` on `rate` samples go by in a
 * second: the turn's rate, twice as many where a period is left out, none where one is said twice.
 */
export type Report =
  | { kind: "play"; turn: number; frame: number; sample: number; rate: number }
  | { kind: "pause"; turn: number; frame: number; sample: number; state: Halt }
  | { kind: "over"; turn: number; frame: number; sample: number }
  | { kind: "tick"; frame: number; stats: PlayerStats };

/** `waiting`: the text has run dry; `starved`: the sound has; `paused`: somebody wants it so. */
export type Halt = "waiting" | "starved" | "paused";

const TICK_FRAMES = 2048;
/** How a sound dies away that breaks off: at the end of what there is, and where more should have come. */
const FALL_S = 0.005;
const STARVED_FALL_S = 0.04;
const PAST_S = 0.035;
/**
 * A live talk of which more than this has not been played goes on with what is being said now: the card may have stood
 * still for hours.
 */
const BEHIND_S = 5;

export class Player {
  private readonly queue: Voice[] = [];
  private readonly jitter = new Jitter();
  /** What was rendered last. */
  private readonly past: Float32Array;
  /** Sound that dies away. */
  private tail: Sound = new Float32Array(0);
  private paused = false;
  /** The one to be rendered next. */
  private frame = 0;
  private tick = 0;
  private readonly counts = { underruns: 0, late: 0, stretchedMs: 0 };

  constructor(private readonly contextRate: number, private readonly report: (report: Report) => void) {
    this.past = new Float32Array(Math.round(PAST_S * contextRate));
  }

  handle(command: Command): void {
    if (command.kind === "begin") {
      this.queue.push(new Voice(command.turn, command.live ?? false, command.rate, this.contextRate, this.jitter));
      return;
    }
    if (command.kind === "pause") return this.pause(command.on);
    if (command.kind === "catch-up") return this.catchUp();
    const voice = this.queue.find(({ turn }) => turn === command.turn);
    if (!voice) return;
    if (command.kind === "pcm") {
      this.counts.late += Number(voice.push(command.sample, command.pcm, command.hold, this.frame));
      if (voice.live && this.storeS > BEHIND_S) this.catchUp(voice);
    } else if (command.kind === "discard") voice.discard(command.sample);
    else if (command.kind === "end") voice.ended = true;
    else voice.stopped = true;
  }

  get stats(): PlayerStats {
    return { ...this.counts, storeMs: 1000 * (this.queue[0]?.storeS ?? 0), targetMs: 1000 * this.jitter.targetS };
  }

  /** Fill `out`, whose first sample is context frame `frame`. */
  render(out: Float32Array, frame: number): void {
    let at = 0;
    while (at < out.length && this.queue.length) {
      const voice = this.queue[0];
      if (!voice.playing && !this.start(voice, frame + at)) break;
      if (voice.playing) at = this.play(voice, out, at, frame);
    }
    out.fill(0, at);
    this.sink(out, at, out.length);
    this.remember(out);
    this.frame = frame + out.length;
    if (this.queue.length && frame >= this.tick) {
      this.tick = frame + TICK_FRAMES;
      this.report({ kind: "tick", frame, stats: this.stats });
    }
  }

  private get storeS(): number {
    return this.queue.reduce((sum, { storeS }) => sum + storeS, 0);
  }

  /** Play this turn next, from where it is now; by default the last of which there is sound. */
  private catchUp(voice = this.queue.findLast(({ live, storeS }) => live && storeS > 0)): void {
    if (!voice) return;
    for (const other of this.queue.slice(0, this.queue.indexOf(voice))) {
      if (other.playing) other.stopped = true;
      else this.leave(other, this.frame);
    }
    voice.catchUp();
  }

  private pause(on: boolean): void {
    if (on === this.paused) return;
    this.paused = on;
    for (const voice of this.queue) voice.interrupt();
    const [voice] = this.queue;
    if (voice?.started && !voice.playing) this.tell(voice, this.frame, on ? "paused" : "waiting");
  }

  /** False if there is nothing to do for this turn yet. */
  private start(voice: Voice, frame: number): boolean {
    if (voice.stopped) return this.leave(voice, frame);
    if (this.paused || !voice.startable(frame)) return false;
    voice.start(frame);
    voice.told = null;
    this.follow(voice, frame);
    return true;
  }

  /** Fill `out` from `from` on as far as this turn goes; where that is. */
  private play(voice: Voice, out: Float32Array, from: number, frame: number): number {
    const fading = voice.stopped || this.paused;
    let at = from;
    while (at < out.length) {
      if (!fading) this.counts.stretchedMs += 1000 * voice.fit(frame + at);
      this.follow(voice, frame + at);
      const to = voice.take(out, at, fading);
      if (to === at) {
        this.halt(voice, out.subarray(0, at), frame + at);
        break;
      }
      this.sink(out, at, to);
      at = to;
    }
    return at;
  }

  /** Tell what is played from here on, if that is not what was to be expected. */
  private follow(voice: Voice, frame: number): void {
    const { knot } = voice.line;
    if (knot === voice.told) return;
    voice.told = knot;
    this.report({ kind: "play", turn: voice.turn, frame, sample: voice.sample, rate: voice.rate * knot.pace });
  }

  /** The sound stops at `frame`, after `out`: the turn is over, or has to wait for more. */
  private halt(voice: Voice, out: Float32Array, frame: number): void {
    const dry = voice.frames === 0;
    voice.rest();
    if (voice.stopped || (dry && voice.ended)) this.leave(voice, frame);
    else if (this.paused || voice.held) this.tell(voice, frame, this.paused ? "paused" : "waiting");
    else {
      this.counts.underruns++;
      voice.dry = frame;
      this.tell(voice, frame, "starved");
    }
    if (voice.gain <= 0) return;
    const past = this.remember(out, new Float32Array(this.past.length));
    this.tail = fall(past, this.contextRate, voice.dry === null ? FALL_S : STARVED_FALL_S);
  }

  private leave(voice: Voice, frame: number): true {
    this.queue.splice(this.queue.indexOf(voice), 1);
    const sample = Math.min(voice.sample, voice.line.next ?? 0);
    this.report({ kind: "over", turn: voice.turn, frame, sample });
    return true;
  }

  private tell(voice: Voice, frame: number, state: Halt): void {
    this.report({ kind: "pause", turn: voice.turn, frame, sample: voice.sample, state });
  }

  /** Add what dies away to `out`. */
  private sink(out: Float32Array, from: number, to: number): void {
    const n = Math.min(to - from, this.tail.length);
    for (let k = 0; k < n; k++) out[from + k] += this.tail[k];
    this.tail = this.tail.subarray(n);
  }

  private remember(out: Float32Array, into = this.past): Float32Array {
    const n = Math.min(out.length, into.length);
    into.set(this.past.subarray(n));
    into.set(out.subarray(out.length - n), into.length - n);
    return into;
  }
}
