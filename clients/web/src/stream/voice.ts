/**
 * One turn as it is played: when it may start, how loud it is, and how it keeps its store. Twin of
 * fapstream/stream/voice.py; here the turn's rate may differ from the sound card's, whose frames are counted.
 */

import { steer, type Jitter } from "./jitter";
import { Line, type Knot } from "./line";
import { interpolate, kernel, type Kernel } from "./resample";

const FADE_OUT_S = 0.02;
const FADE_IN_S = 0.003;
/** A turn that goes on within a sound comes back more softly than one that begins. */
const FADE_BACK_S = 0.01;
/** After a change, this many times its length passes unchanged: 5 % in speech, half of a pause. */
const SPEECH_EVERY = 20;
const QUIET_EVERY = 2;
/** A store has to be too large for so long before it shrinks: the network may turn out to need it. */
const PATIENCE_S = 3;
const RETRY_S = 0.01;
/** A packet that does not come for so long, and longer than the network is known for, is missing. */
const OVERDUE_S = 0.06;
/** With less in store and a packet missing, time is gained. */
const SCANT_S = 0.3;

export class Voice {
  ended = false;
  held = false;
  stopped = false;
  playing = false;
  started = false;
  gain = 0;
  /** What the listener's map was told last. */
  told: Knot | null = null;
  /** The frame since which sound is missing. */
  dry: number | null = null;
  readonly line: Line;
  /** Place in the line times context rate: an integer, so that nothing drifts. */
  private position = 0;
  private readonly kernel: Kernel;
  private rise: number;
  private arrived = 0;
  private levelS: number | null = null;
  /** The frame since which the store is too large. */
  private above: number | null = null;
  /** Where in the line the next change may be. */
  private free = 0;

  /** `live`: the talk is sent in real time, and a store larger than needed is latency. */
  constructor(
    readonly turn: number, readonly live: boolean, readonly rate: number,
    private readonly contextRate: number, private readonly jitter: Jitter,
  ) {
    this.kernel = kernel(rate, contextRate);
    this.line = new Line(rate, this.kernel.half + 1);
    this.rise = 1 / (FADE_IN_S * contextRate);
  }

  /** Of the turn, what is played next; may lie between two samples. */
  get sample(): number {
    return this.line.sample(this.position / this.contextRate);
  }

  /** Sound in store, s. */
  get storeS(): number {
    return Math.max(0, this.line.end - this.position / this.contextRate) / this.rate;
  }

  /** Is enough in store? In a live talk time does as well: what is not yet played is gained. */
  startable(frame: number): boolean {
    if (this.ended || !this.frames) return this.ended;
    const store = this.levelS === null ? this.storeS : this.levelS + (frame - this.arrived) / this.contextRate;
    return this.held || store >= this.jitter.targetS;
  }

  /** Frames that can be rendered now; the filter looks ahead unless there is nothing to wait for. */
  get frames(): number {
    const limit = this.ended || this.held ? this.line.end : this.line.end - this.kernel.half;
    return this.framesTo(limit);
  }

  /** More of the turn, at `frame`; true if it came too late. */
  push(sample: number, pcm: Int16Array, hold: boolean, frame: number): boolean {
    if (this.line.next === null || this.held) this.jitter.restart();
    const before = this.frames;
    const late = this.line.push(sample, pcm) > 0 && this.note(before, frame);
    this.held = hold;
    return late;
  }

  /** See Line.discard. What replaces it is sent when it is there. */
  discard(sample: number): void {
    this.line.discard(sample);
    this.held = false;
    this.interrupt();
  }

  /** Go on with what is being said now, leaving out all of the store that is not needed. */
  catchUp(): void {
    this.line.skip(Math.ceil(this.jitter.targetS * this.rate));
    this.levelS = this.above = null;
  }

  /** The sender's time has stopped or leapt; what was known of it is worth nothing. */
  interrupt(): void {
    this.jitter.restart();
    this.levelS = this.dry = null;
  }

  /** From this frame on it is heard. */
  start(frame: number): void {
    if (this.levelS !== null) this.levelS += (frame - this.arrived) / this.contextRate;
    if (this.started) this.rise = 1 / (FADE_BACK_S * this.contextRate);
    this.started = this.playing = this.line.flows = true;
    this.dry = null;
    this.gain = 0;
  }

  /** It is no longer heard. */
  rest(): void {
    this.playing = false;
    this.line.rest();
  }

  /** Write into `out` from `from` on what one knot holds; returns up to where. Nothing if there is nothing, or once it has faded away. */
  take(out: Float32Array, from: number, fading: boolean): number {
    const to = Math.min(out.length, from + Math.min(this.frames, this.framesTo(this.line.turnAt)));
    const step = fading ? -1 / (FADE_OUT_S * this.contextRate) : this.rise;
    let at = from;
    for (; at < to && (this.gain > 0 || step > 0); at++) {
      this.gain = Math.min(1, Math.max(0, this.gain + step));
      out[at] = this.next() * this.gain;
    }
    return at;
  }

  /** Shorten or lengthen what comes next, if the store asks for it; by how many seconds. */
  fit(frame: number): number {
    const { line } = this;
    const way = line.at >= this.free ? this.wish(frame) : 0;
    if (!way) return 0;
    const change = line.alter(way);
    if (!change) {
      this.free = line.at + Math.round(RETRY_S * this.rate);
      return 0;
    }
    const size = Math.abs(change.samples);
    this.free = line.at + size * (change.quiet ? QUIET_EVERY : SPEECH_EVERY);
    if (this.levelS !== null) this.levelS += change.samples / this.rate;
    return size / this.rate;
  }

  private wish(frame: number): -1 | 0 | 1 {
    if (this.ended || this.stopped) return 0;
    const { targetS } = this.jitter;
    const missing = frame - this.arrived > Math.max(OVERDUE_S, targetS) * this.contextRate;
    const wanted = this.patient(this.levelS === null ? 0 : steer(this.levelS, targetS), frame);
    const way = missing && this.storeS < SCANT_S ? 1 : wanted;
    return this.held && way > 0 ? 0 : way;
  }

  private patient(way: -1 | 0 | 1, frame: number): -1 | 0 | 1 {
    if (way >= 0) {
      this.above = null;
      return way;
    }
    this.above ??= frame;
    return frame - this.above >= PATIENCE_S * this.contextRate ? way : 0;
  }

  /** New sound has come at `frame`, when `before` frames could be rendered. Is it late? */
  private note(before: number, frame: number): boolean {
    this.arrived = frame;
    const now = frame / this.contextRate;
    if (this.dry !== null && before === 0) this.jitter.underrun((frame - this.dry) / this.contextRate);
    if (this.live) this.levelS = this.storeS + this.jitter.observe(this.line.next! / this.rate, now);
    else this.jitter.ease(now);
    return this.dry !== null && frame - this.dry >= before;
  }

  private framesTo(place: number): number {
    return Math.max(0, Math.ceil((place * this.contextRate - this.position) / this.rate));
  }

  private next(): number {
    const place = Math.floor(this.position / this.contextRate);
    const fraction = this.position / this.contextRate - place;
    this.position += this.rate;
    this.line.at = Math.floor(this.position / this.contextRate);
    const { data, index } = this.line.window(place);
    return interpolate(this.kernel, data, index, fraction);
  }
}
