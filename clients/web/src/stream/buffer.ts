/** What has been received of one turn, addressed by sample: FAP frames and marks. The sound is with the processor. */

import type { Begin, Mark, Packet } from "../protocol/generated";

export const N_FAPS = 68;
/** Sound louder than this counts as sound: -40 dB of full scale. */
const AUDIBLE = 328;
const KEEP_FRAMES = 256;

/** FAP values by number, 0 unused; shape (69,). */
export type FapValues = Float32Array;

export class TurnBuffer {
  received = 0;
  /** First sample loud enough to be noticed; null while there was none. */
  onset: number | null = null;
  private rows: Int32Array[] = [];
  /** Number of the frame in rows[0]. */
  private first = 0;
  private marks: Mark[] = [];

  constructor(readonly begin: Begin, private readonly faps: Uint8Array) {}

  push(packet: Packet): void {
    const width = this.faps.length;
    for (let at = 0; at < packet.faps.length; at += width) this.rows.push(packet.faps.subarray(at, at + width));
    this.marks.push(...(packet.marks ?? []));
    if (this.onset === null) {
      const at = packet.pcm.findIndex((v) => Math.abs(v) > AUDIBLE);
      if (at >= 0) this.onset = packet.sample + at;
    }
    this.received += packet.pcm.length;
  }

  /** Write the face at `sample` into `out`, linearly between frames, the last one held. */
  face(sample: number, out: FapValues): void {
    out.fill(0);
    if (!this.rows.length) return;
    const { fps, sample_rate } = this.begin;
    const at = Math.max(0, (Math.max(0, sample) * fps) / sample_rate - this.first);
    const index = Math.min(Math.floor(at), this.rows.length - 1);
    const [a, b] = [this.rows[index], this.rows[Math.min(index + 1, this.rows.length - 1)]];
    const blend = Math.min(1, at - index);
    for (let k = 0; k < this.faps.length; k++) out[this.faps[k]] = a[k] + (b[k] - a[k]) * blend;
    this.forget(index);
  }

  /** The marks that began up to `sample` and were not taken before, in order. */
  take(sample: number): Mark[] {
    const ahead = this.marks.findIndex((mark) => mark.sample > sample);
    return this.marks.splice(0, ahead < 0 ? this.marks.length : ahead);
  }

  private forget(index: number): void {
    if (index < 2 * KEEP_FRAMES) return;
    this.rows.splice(0, KEEP_FRAMES);
    this.first += KEEP_FRAMES;
  }
}
