/**
 * The context time being heard, from the timestamps that the browser gives out: smoothed, because the
 * picture follows it, and quick to follow when the sound card stalls or changes.
 */

const SMOOTH = 0.1;
const SNAP_S = 0.015;

export class OutputClock {
  /** Context seconds minus performance seconds. */
  private offset: number | null = null;

  /** `contextTime` (s) was heard at `performanceTime` (ms). */
  observe(contextTime: number, performanceTime: number): void {
    const offset = contextTime - performanceTime / 1000;
    const error = this.offset === null ? Infinity : offset - this.offset;
    this.offset = Math.abs(error) > SNAP_S ? offset : this.offset! + SMOOTH * error;
  }

  /** Context seconds heard at `now` (ms), never beyond `rendered`. */
  heard(now: number, rendered: number): number {
    return this.offset === null ? 0 : Math.max(0, Math.min(rendered, this.offset + now / 1000));
  }

  /** When context time `time` (s) is heard, in ms of performance time; null if nothing is known yet. */
  when(time: number): number | null {
    return this.offset === null ? null : (time - this.offset) * 1000;
  }
}
