/**
 * Which face to show: the turn's at the heard sample, idle life when nothing is said. Where one takes over from the
 * other, what was shown lasts as an offset that dies away: nothing jumps, and lips are on time.
 */

import { N_FAPS, type FapValues, type TurnBuffer } from "../stream/buffer";
import type { Heard } from "../stream/heard";
import { minimumJerk } from "./chance";
import { EYE_FAPS, HEAD_FAPS, IdleLife, LID_FAPS, LIDS } from "./idle";

/** How long what was shown before lasts, s: moods and heads take their time, eyes leap. */
const FADE_S = { mood: 0.6, head: 0.7, eyes: 0.06, lids: 0.16 };
/** The mouth is at the disposal of a turn that begins, soon back where one goes on, and slow to rest. */
const MOUTH_FADE_S = { turn: 0.15, back: 0.06, rest: 0.35 };
/** Brows, cheeks and nose. */
const MOOD_FAPS = [31, 32, 33, 34, 35, 36, 37, 38, 41, 42, 61, 62, 63, 64];
/** The heard sample has leapt if it is further on, or back, than time and this much account for. */
const LEAP_S = 0.1;
/** Idle life takes no longer steps than this: a page that was hidden does not catch up on its blinks. */
const LONGEST_STEP_S = 0.25;

export class Face {
  /** The face shown last; shape (69,), FAP n at n. */
  readonly values: FapValues = new Float32Array(N_FAPS + 1);
  private readonly target: FapValues = new Float32Array(N_FAPS + 1);
  private readonly offset: FapValues = new Float32Array(N_FAPS + 1);
  /** By FAP; 0 for the mouth's. */
  private readonly fades = new Float32Array(N_FAPS + 1);
  private readonly life: IdleLife;
  /** What is shown: a turn's own face, its lips with idle life round them, or idle life alone. */
  private source = "";
  private since = 0;
  private time = -1;
  private lived = 0;
  private heard: Heard | null = null;
  /** The turn whose sound has stopped, and its face there: from it the mouth goes on. */
  private silent: Heard | null = null;
  private readonly stood: FapValues = new Float32Array(N_FAPS + 1);
  private leaps = 0;
  private mouth = MOUTH_FADE_S.rest;
  /** The turn shown last. */
  private spoke: number | null = null;

  constructor(seed: number) {
    this.life = new IdleLife(seed, "listen");
    const groups = [[MOOD_FAPS, FADE_S.mood], [HEAD_FAPS, FADE_S.head], [EYE_FAPS, FADE_S.eyes], [LID_FAPS, FADE_S.lids]] as const;
    for (const [faps, fade] of groups) for (const fap of faps) this.fades[fap] = fade;
  }

  /** The values at `now` (s) for what is heard; `buffer` is that turn's, null if none holds the face. */
  show(buffer: TurnBuffer | null, heard: Heard | null, now: number, calm: boolean): FapValues {
    const step = this.time < 0 ? 0 : Math.max(0, now - this.time);
    this.time = now;
    this.lived += Math.min(step, LONGEST_STEP_S);
    this.since += step;
    const holds = buffer !== null && heard !== null && tells(buffer, heard);
    if (holds) {
      this.watch(buffer, heard, step);
      buffer.face(heard.sample, this.target);
    } else {
      this.target.fill(0);
      this.stood.fill(0);
      this.silent = heard?.state === "starved" || heard?.state === "paused" ? heard : null;
    }
    const lives = !holds || heard.state === "waiting";
    if (lives && !calm) this.life.write(this.lived, this.target);
    if (calm) for (const fap of [...HEAD_FAPS, ...EYE_FAPS]) this.target[fap] = 0;
    this.blend(holds ? heard.turn : null, `${lives} ${calm} ${this.leaps}`);
    return this.values;
  }

  /** Note where the turn had stopped until now. A leap of what is heard is caught up with as if it had been silent. */
  private watch(buffer: TurnBuffer, heard: Heard, step: number): void {
    const { heard: last, silent } = this;
    this.heard = heard;
    this.silent = null;
    buffer.face(silent?.turn === heard.turn ? silent.sample : heard.sample, this.stood);
    if (last?.turn !== heard.turn) return;
    const on = (heard.sample - last.sample) / buffer.begin.sample_rate;
    if (on < -LEAP_S || on > step + LEAP_S) this.leaps++;
  }

  private blend(turn: number | null, how: string): void {
    const source = `${turn} ${how}`;
    if (source !== this.source) {
      for (let fap = 1; fap <= N_FAPS; fap++) {
        const fresh = this.fades[fap] ? this.target[fap] : this.stood[fap];
        this.offset[fap] = this.source ? this.values[fap] - fresh : 0;
      }
      this.source = source;
      this.since = 0;
      this.mouth = turn === null ? MOUTH_FADE_S.rest : turn === this.spoke ? MOUTH_FADE_S.back : MOUTH_FADE_S.turn;
      this.spoke = turn ?? this.spoke;
    }
    for (let fap = 1; fap <= N_FAPS; fap++) {
      this.values[fap] = this.target[fap] + this.offset[fap] * (1 - minimumJerk(this.since / (this.fades[fap] || this.mouth)));
    }
    for (const [fap, shut] of LIDS) this.values[fap] = Math.min(this.values[fap], shut);
  }
}

/** Does the turn have the face? Where sound or frames are missing it comes to rest, and lives. */
function tells(buffer: TurnBuffer, { sample, state }: Heard): boolean {
  return (state === "playing" || state === "waiting") && buffer.holds(sample);
}
