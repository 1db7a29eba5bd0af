/**
 * What the sound processor does, without the sound card: turns in, context frames out, and reports
 * that say which sample of which turn is rendered at which context frame.
 */

import { interpolate, kernel, type Kernel } from "./resample";

export type Command =
  | { kind: "begin"; turn: number; rate: number }
  | { kind: "pcm"; turn: number; pcm: Int16Array; hold: boolean }
  | { kind: "end"; turn: number }
  | { kind: "stop"; turn: number };

/** `sample` (which may lie between two) is rendered at context frame `frame`. */
export type Report =
  | { kind: "play"; turn: number; frame: number; sample: number; rate: number }
  | { kind: "pause"; turn: number; frame: number; sample: number; underrun: boolean }
  | { kind: "over"; turn: number; frame: number; sample: number }
  | { kind: "tick"; frame: number };

/** Sound in store before it starts, or starts again, in seconds. */
export const PREBUFFER_S = 0.08;
const FADE_OUT_S = 0.02;
const FADE_IN_S = 0.003;
const TICK_FRAMES = 2048;
/** A cut-off sound dies away by this factor a frame instead of clicking. */
const DECAY = 0.985;

class Voice {
  private data = new Float32Array(1 << 15);
  /** Sample number of data[0]. The signal is 0 before sample 0. */
  private base: number;
  received = 0;
  ended = false;
  held = false;
  stopped = false;
  playing = false;
  gain = 1;
  /** Position times context rate: an integer, so that nothing drifts. */
  position = 0;
  private readonly kernel: Kernel;

  constructor(readonly turn: number, readonly rate: number, private readonly contextRate: number) {
    this.kernel = kernel(rate, contextRate);
    this.base = -this.kernel.half;
  }

  get sample(): number {
    return this.position / this.contextRate;
  }

  get startable(): boolean {
    const queued = this.received - this.sample;
    return this.ended || (queued > 0 && (this.held || queued >= PREBUFFER_S * this.rate));
  }

  push(pcm: Int16Array, hold: boolean): void {
    this.reserve(pcm.length + this.kernel.half + 1);
    const end = this.received - this.base;
    for (let i = 0; i < pcm.length; i++) this.data[end + i] = pcm[i] / 32768;
    this.received += pcm.length;
    this.held = hold;
  }

  /** Frames that can be rendered now; the filter looks ahead unless there is nothing to wait for. */
  get frames(): number {
    const limit = this.ended || this.held ? this.received : this.received - this.kernel.half;
    return Math.max(0, Math.ceil((limit * this.contextRate - this.position) / this.rate));
  }

  next(): number {
    const index = Math.floor(this.position / this.contextRate);
    const fraction = this.position / this.contextRate - index;
    this.position += this.rate;
    return interpolate(this.kernel, this.data, index - this.base, fraction);
  }

  /** Room for `more` samples after the last, forgetting what the filter needs no longer; zeros follow the signal. */
  private reserve(more: number): void {
    const used = this.received - this.base;
    if (used + more <= this.data.length) return;
    const keep = Math.floor(this.sample) - this.kernel.half - this.base;
    const fresh = used + more - keep > this.data.length ? new Float32Array(2 * (used + more)) : this.data;
    fresh.set(this.data.subarray(keep, used));
    fresh.fill(0, used - keep);
    this.data = fresh;
    this.base += keep;
  }
}

export class Player {
  private readonly queue: Voice[] = [];
  private last = 0;
  private tick = 0;

  constructor(private readonly contextRate: number, private readonly report: (report: Report) => void) {}

  handle(command: Command): void {
    if (command.kind === "begin") {
      this.queue.push(new Voice(command.turn, command.rate, this.contextRate));
      return;
    }
    const voice = this.queue.find(({ turn }) => turn === command.turn);
    if (!voice) return;
    if (command.kind === "pcm") voice.push(command.pcm, command.hold);
    else if (command.kind === "end") voice.ended = true;
    else voice.stopped = true;
  }

  /** Fill `out`, whose first sample is context frame `frame`. */
  render(out: Float32Array, frame: number): void {
    let at = 0;
    while (at < out.length && this.queue.length) {
      const voice = this.queue[0];
      if (!voice.playing && !this.start(voice, frame + at)) break;
      if (voice.playing) at = this.play(voice, out, at, frame);
    }
    for (; at < out.length; at++) out[at] = this.last *= DECAY;
    if (this.queue.length && frame >= this.tick) {
      this.tick = frame + TICK_FRAMES;
      this.report({ kind: "tick", frame });
    }
  }

  /** False if there is nothing to do for this turn yet. */
  private start(voice: Voice, frame: number): boolean {
    if (voice.stopped) return this.leave(voice, frame);
    if (!voice.startable) return false;
    voice.playing = true;
    voice.gain = 0;
    this.report({ kind: "play", turn: voice.turn, frame, sample: voice.sample, rate: voice.rate });
    return true;
  }

  private play(voice: Voice, out: Float32Array, from: number, frame: number): number {
    const to = Math.min(out.length, from + voice.frames);
    const step = voice.stopped ? -1 / (FADE_OUT_S * this.contextRate) : 1 / (FADE_IN_S * this.contextRate);
    let at = from;
    for (; at < to && (voice.gain > 0 || step > 0); at++) {
      voice.gain = Math.min(1, Math.max(0, voice.gain + step));
      out[at] = this.last = voice.next() * voice.gain;
    }
    if (at < out.length) this.halt(voice, frame + at);
    return at;
  }

  /** The sound stops at `frame`: the turn is over, or has to wait for more. */
  private halt(voice: Voice, frame: number): void {
    voice.playing = false;
    if (voice.stopped || voice.ended) this.leave(voice, frame);
    else this.report({ kind: "pause", turn: voice.turn, frame, sample: voice.sample, underrun: !voice.held });
  }

  private leave(voice: Voice, frame: number): true {
    this.queue.shift();
    const sample = Math.min(voice.sample, voice.received);
    this.report({ kind: "over", turn: voice.turn, frame, sample });
    return true;
  }
}
