/** Which face to show: the turn's at the heard sample; idle life when nothing is said; soft steps between them. */

import { N_FAPS, type FapValues, type TurnBuffer } from "../stream/buffer";
import type { Heard } from "../stream/heard";
import { IDLE_FAPS, IdleLife, smooth } from "./idle";

const FADE_S = 0.2;
const HEAD_TURNS = [48, 49, 50];

export class Face {
  /** The face shown last; shape (69,), FAP n at n. */
  readonly values: FapValues = new Float32Array(N_FAPS + 1);
  private readonly speech: FapValues = new Float32Array(N_FAPS + 1);
  private readonly idle: FapValues = new Float32Array(N_FAPS + 1);
  private readonly life: IdleLife;
  /** 1 while a turn holds the face, then down to 0; what is left of it fades out with it. */
  private held = 0;
  /** 0 idle life, 1 the turn's own head and lids. */
  private own = 0;
  private time = -1;

  constructor(seed: number) {
    this.life = new IdleLife(seed);
  }

  /** The values at `now` (s) for what is heard; `buffer` is that turn's, null if none holds the face. */
  show(buffer: TurnBuffer | null, heard: Heard | null, now: number, calm: boolean): FapValues {
    const step = this.time < 0 ? 0 : Math.max(0, now - this.time) / FADE_S;
    this.time = now;
    const holds = buffer !== null && heard !== null;
    if (holds) buffer.face(heard.sample, this.speech);
    this.held = holds ? 1 : Math.max(0, this.held - step);
    const wants = holds && heard.state !== "waiting";
    this.own = Math.min(1, Math.max(0, this.own + (wants ? step : -step)));
    this.mix(now, calm);
    return this.values;
  }

  private mix(now: number, calm: boolean): void {
    const left = smooth(this.held);
    for (let fap = 1; fap <= N_FAPS; fap++) this.values[fap] = this.speech[fap] * left;
    if (calm) {
      for (const fap of HEAD_TURNS) this.values[fap] = 0;
      return;
    }
    this.life.write(now, this.idle);
    const own = smooth(this.own);
    for (const fap of IDLE_FAPS) this.values[fap] = this.speech[fap] * own + this.idle[fap] * (1 - own);
  }
}
