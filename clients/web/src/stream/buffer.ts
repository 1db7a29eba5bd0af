/**
 * What has been received of one turn, addressed by sample: FAP frames and marks. The sound is with the processor. Twin of
 * fapstream/stream/buffer.py.
 */

import type { Begin, Mark } from "../protocol/generated";

export const N_FAPS = 68;
/** Sound louder than this counts as sound: -40 dB of full scale. */
const AUDIBLE = 328;
const KEEP_FRAMES = 256;
/** Also where nobody looks at them; more than a player keeps in store. */
const MOST_FRAMES = 2048;
const MOST_MARKS = 512;
/** A frame stands for what follows it for so long, or twice the distance of frames if that is more. */
const HOLD_S = 0.12;

/** FAP values by number, 0 unused; shape (69,). */
export type FapValues = Float32Array;

/** A face at a sample; `values` are of the FAPs that the session has, in their order. */
export interface Frame {
  sample: number;
  values: Int32Array;
}

/** A slice of a turn from `sample` on. */
export interface Slice {
  sample: number;
  pcm: Int16Array;
  frames: Frame[];
  marks: Mark[];
}

export class TurnBuffer {
  /** The sample after the last one there is. */
  received = 0;
  /** First sample loud enough to be noticed; null while there was none. */
  onset: number | null = null;
  private readonly frames: Frame[] = [];
  private marks: Mark[] = [];
  private hold: number;
  private spacing = Infinity;

  constructor(readonly begin: Begin, private readonly faps: Uint8Array) {
    this.hold = HOLD_S * begin.sample_rate;
  }

  /** More of the turn; what is here already is left out. */
  push({ sample, pcm, frames, marks }: Slice): void {
    for (const frame of frames) this.add(frame);
    if (this.frames.length > MOST_FRAMES) this.frames.splice(0, KEEP_FRAMES);
    this.marks.push(...marks.filter((mark) => mark.sample >= this.received));
    if (this.marks.length > MOST_MARKS) this.marks.splice(0, this.marks.length - MOST_MARKS);
    if (this.onset === null) {
      const at = pcm.findIndex((v) => Math.abs(v) > AUDIBLE);
      if (at >= 0) this.onset = sample + at;
    }
    this.received = Math.max(this.received, sample + pcm.length);
  }

  /** Forget the frames and marks from `sample` on: others are to come. */
  discard(sample: number): void {
    this.frames.splice(this.after(sample - 1));
    this.marks = this.marks.filter((mark) => mark.sample < sample);
    this.received = Math.min(this.received, sample);
  }

  /** Is there a frame that tells what the face is like at `sample`? */
  holds(sample: number): boolean {
    const after = this.after(sample);
    return this.joined(after) || (after > 0 && sample - this.frames[after - 1].sample <= this.hold);
  }

  /** Write the face at `sample` into `out`: linear between frames, held where the next one is missing. */
  face(sample: number, out: FapValues): void {
    out.fill(0);
    if (!this.frames.length) return;
    const after = this.after(sample);
    const low = Math.max(0, after - 1);
    const [a, b] = [this.frames[low], this.frames[this.joined(after) ? after : low]];
    const blend = b === a ? 0 : (sample - a.sample) / (b.sample - a.sample);
    for (let k = 0; k < this.faps.length; k++) out[this.faps[k]] = a.values[k] + (b.values[k] - a.values[k]) * blend;
    if (low >= 2 * KEEP_FRAMES) this.frames.splice(0, KEEP_FRAMES);
  }

  /** The marks that began up to `sample` and were not taken before, in order. */
  take(sample: number): Mark[] {
    const ahead = this.marks.findIndex((mark) => mark.sample > sample);
    return this.marks.splice(0, ahead < 0 ? this.marks.length : ahead);
  }

  private add(frame: Frame): void {
    const last = this.frames.at(-1);
    if (last && frame.sample <= last.sample) return;
    if (last) {
      this.spacing = Math.min(this.spacing, frame.sample - last.sample);
      this.hold = Math.max(HOLD_S * this.begin.sample_rate, 2 * this.spacing);
    }
    this.frames.push(frame);
  }

  /** How many frames are at `sample` or before it. */
  private after(sample: number): number {
    let [low, high] = [0, this.frames.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.frames[middle].sample <= sample) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Do frame `after` and the one before it follow each other? */
  private joined(after: number): boolean {
    const inside = after > 0 && after < this.frames.length;
    return inside && this.frames[after].sample - this.frames[after - 1].sample <= this.hold;
  }
}
