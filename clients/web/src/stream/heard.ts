/** From the processor's reports to the sample being heard: the clock that the picture follows. */

import type { Halt, Report } from "./player";

export interface Heard {
  turn: number;
  /** Sample of the turn, which may lie between two. */
  sample: number;
  /** See Halt of the player; in every state but `playing` the sample stands. */
  state: "playing" | Halt | "over";
}

interface Span {
  turn: number;
  frame: number;
  sample: number;
  /** Samples a context frame. */
  step: number;
  end: number;
  after: Heard["state"];
}

export class HeardMap {
  private readonly spans: Span[] = [];

  constructor(private readonly contextRate: number) {}

  apply(report: Report): void {
    if (report.kind === "play") {
      const { turn, frame, sample, rate } = report;
      const span = this.spans.at(-1);
      if (span) span.end = Math.min(span.end, frame);
      this.spans.push({ turn, frame, sample, step: rate / this.contextRate, end: Infinity, after: "waiting" });
    } else if (report.kind === "pause") {
      this.close(report, report.state);
    } else if (report.kind === "over") {
      this.close(report, "over");
    }
  }

  /** What is heard at a context frame (which may lie between two); null before the first sound. */
  at(frame: number): Heard | null {
    while (this.spans.length > 1 && this.spans[1].frame <= frame) this.spans.shift();
    const span = this.spans[0];
    if (!span || frame < span.frame) return null;
    const sample = span.sample + (Math.min(frame, span.end) - span.frame) * span.step;
    return { turn: span.turn, sample, state: frame < span.end ? "playing" : span.after };
  }

  /** A context frame at which `sample` of `turn` is heard; null if it was or will be at none we know of. */
  frameOf(turn: number, sample: number): number | null {
    for (const span of this.spans) {
      const frame = span.frame + (sample - span.sample) / span.step;
      if (span.turn === turn && frame >= span.frame && frame < span.end) return frame;
    }
    return null;
  }

  private close(report: { turn: number; frame: number; sample: number }, after: Heard["state"]): void {
    const { turn, frame, sample } = report;
    const span = this.spans.at(-1);
    if (span?.turn === turn && span.end === Infinity) Object.assign(span, { end: frame, after });
    else this.spans.push({ turn, frame, sample, step: 0, end: frame, after });
  }
}
