/** What a living face does unasked: blinks and small turns of the head. Seeded, a function of time. */

import { AU } from "../head/deform";
import type { FapValues } from "../stream/buffer";

/** Together 1024 IRISD units: the lids meet. */
const LIDS: [fap: number, closed: number][] = [[19, 900], [20, 900], [21, 124], [22, 124]];
const CLOSE_S = 0.08;
const SHUT_S = 0.04;
const OPEN_S = 0.16;
const MEAN_S = 3.8;
const LEAST_S = 1.2;
/** FAP 48 pitch, 49 yaw, 50 roll, radians. */
const SWAY: [fap: number, amplitude: number][] = [[48, 0.016], [49, 0.028], [50, 0.012]];
/** The eyes stay on the viewer: FAP 23-24 against the yaw, 25-26 against the pitch. */
const GAZE: [eye: number, head: number][] = [[23, 49], [24, 49], [25, 48], [26, 48]];

/** The FAPs that idle life moves. */
export const IDLE_FAPS = [...LIDS, ...SWAY, ...GAZE].map(([fap]) => fap);

export class IdleLife {
  private readonly random: () => number;
  private readonly waves: { hz: number; phase: number }[][];
  private blink: number;

  constructor(seed: number) {
    const random = (this.random = generator(seed));
    this.waves = SWAY.map(() => [0.06, 0.11, 0.19].map((hz) => ({ hz: hz * (0.8 + 0.4 * random()), phase: 2 * Math.PI * random() })));
    this.blink = 0.5 + MEAN_S * random();
  }

  /** Write the idle FAPs at `t` seconds, which may not go back, into `out`. */
  write(t: number, out: FapValues): void {
    const closed = this.lid(t);
    for (const [fap, shut] of LIDS) out[fap] = closed * shut;
    SWAY.forEach(([fap, amplitude], i) => {
      const sway = this.waves[i].reduce((sum, { hz, phase }) => sum + Math.sin(2 * Math.PI * hz * t + phase), 0);
      out[fap] = ((sway / 3) * amplitude) / AU;
    });
    for (const [eye, head] of GAZE) out[eye] = -out[head];
  }

  /** How far the lids are shut, 0 to 1. */
  private lid(t: number): number {
    while (t > this.blink + CLOSE_S + SHUT_S + OPEN_S) {
      this.blink = Math.max(t - MEAN_S, this.blink) + LEAST_S - (MEAN_S - LEAST_S) * Math.log(1 - this.random());
    }
    const into = t - this.blink;
    if (into <= 0) return 0;
    return into < CLOSE_S ? smooth(into / CLOSE_S) : smooth(1 - Math.max(0, into - CLOSE_S - SHUT_S) / OPEN_S);
  }
}

/** 3x^2 - 2x^3, held beyond 0 and 1. */
export function smooth(x: number): number {
  const t = Math.min(1, Math.max(0, x));
  return t * t * (3 - 2 * t);
}

/** Numbers in [0, 1) that follow from `seed` (mulberry32). */
function generator(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}
