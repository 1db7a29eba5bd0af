/**
 * What a living face does unasked: blinks, glances, and a head that is never quite still. Seeded, a function of time.
 * Twin of fapstream/motion/idle.py, on the same table; protocol/vectors/life.json holds both to one face.
 */

import life from "../../../../fapstream/motion/data/life.json";
import { AU } from "../head/deform";
import type { FapValues } from "../stream/buffer";
import { Events, logNormal, minimumJerk, noise, normal, uniform } from "./chance";

/** People who talk blink and look away more than people who listen. */
export type Mode = "talk" | "listen";

const { blink, gaze, head } = life;

/** Channels of chance, as in Python. */
const [BLINK, CLOSE, SHUT, OPEN, PARTIAL] = [0, 1, 2, 3, 4];
const [FIXATION, POINT, MICRO_YAW, MICRO_PITCH] = [10, 11, 12, 13];
const [ON, AWAY, SIZE, DIRECTION] = [20, 21, 22, 23];
const HEAD = 30;

/** The lids and where they meet. */
export const LIDS = Object.entries(blink.shut).map(([fap, shut]) => [Number(fap), shut] as const);
const [PITCH, YAW, ROLL] = [head.pitch.fap, head.yaw.fap, head.roll.fap];
const RADIAN = Math.PI / 180;

/** The FAPs that idle life moves: lids, head, eyes. */
export const LID_FAPS = LIDS.map(([fap]) => fap);
export const HEAD_FAPS = [PITCH, YAW, ROLL];
export const EYE_FAPS = [23, 24, 25, 26];
export const IDLE_FAPS = [...LID_FAPS, ...HEAD_FAPS, ...EYE_FAPS];

type Pair = readonly [yaw: number, pitch: number];

export class IdleLife {
  private readonly blinks: Events;
  private readonly fixations: Events;
  private readonly glances: Events;

  constructor(private readonly seed: number, private readonly mode: Mode) {
    const { on_s } = gaze.aversion[mode];
    this.blinks = new Events((k) => logNormal(seed, BLINK, k, blink.interval_s[mode]));
    this.fixations = new Events((k) => logNormal(seed, FIXATION, k, gaze.fixation_s));
    this.glances = new Events((k) => this.away(k) + logNormal(seed, ON, k, on_s));
  }

  /** Write the idle FAPs at `t` seconds, t >= 0, into `out`. */
  write(t: number, out: FapValues): void {
    const [n, into] = this.glances.at(t);
    const glance = this.glance(n);
    const away = this.away(n);
    const { share, move_s } = gaze.aversion.head;
    const slow = minimumJerk(into / move_s) - minimumJerk((into - away) / move_s);
    const [pitch, yaw, roll] = sway(this.seed, t);
    out[PITCH] = (pitch + slow * share * glance[1] * RADIAN) / AU;
    out[YAW] = (yaw + slow * share * glance[0] * RADIAN) / AU;
    out[ROLL] = roll / AU;
    this.aim(t, glance, step(glance, into) - step(glance, into - away), slow, out);
  }

  /** Turn eyes and lids; `out` has the head already. */
  private aim(t: number, glance: Pair, share: number, slow: number, out: FapValues): void {
    const [k, since] = this.fixations.at(t);
    const [from, to] = [this.point(k - 1), this.point(k)];
    const x = step([to[0] - from[0], to[1] - from[1]], since);
    const yaw = RADIAN * (from[0] + x * (to[0] - from[0]) + share * glance[0]) - out[YAW] * AU;
    const down = RADIAN * (from[1] + x * (to[1] - from[1]) + share * glance[1]);
    const pitch = down + gaze.viewer.pitch_rad - out[PITCH] * AU;
    const near = 1 / gaze.viewer.distance_m;
    const inward = gaze.half_eyes_m * (near + (1 / gaze.far_m - near) * slow);
    [yaw - inward, yaw + inward, pitch, pitch].forEach((angle, i) => (out[EYE_FAPS[i]] = angle / AU));
    const closed = this.shut(t);
    LIDS.forEach(([fap, shut], i) => {
      const open = pitch * (i < 2 ? gaze.lids.upper : gaze.lids.lower);
      out[fap] = open + closed * (shut - open);
    });
  }

  /** How far the lids are shut, 0 to 1. */
  private shut(t: number): number {
    const [k, into] = this.blinks.at(t);
    const { share, depth } = blink.partial;
    const within = ([low, high]: number[], channel: number) => low + (high - low) * uniform(this.seed, channel, k);
    const [close, shut, open] = [within(blink.close_s, CLOSE), within(blink.shut_s, SHUT), within(blink.open_s, OPEN)];
    const course = into < close
      ? minimumJerk(into / close)
      : 1 - minimumJerk(Math.max(0, (into - close - shut) / open) ** 0.75);
    return (uniform(this.seed, PARTIAL, k) < share ? depth : 1) * course;
  }

  /** Fixation k: degrees left and down of the middle of the viewer's face. */
  private point(fixation: number): Pair {
    const k = Math.max(fixation, 0);
    const { yaw_deg, pitch_deg } = choose(gaze.points, uniform(this.seed, POINT, k));
    const micro = gaze.micro_deg;
    return [yaw_deg + micro * normal(this.seed, MICRO_YAW, k), pitch_deg + micro * normal(this.seed, MICRO_PITCH, k)];
  }

  /** How far glance n goes, degrees; glance 0 was over before time began. */
  private glance(n: number): Pair {
    if (n === 0) return [0, 0];
    const { mean, least, most } = gaze.aversion.size_deg;
    const size = Math.min(least - mean * Math.log(1 - uniform(this.seed, SIZE, n)), most);
    const way = choose(gaze.aversion.directions, uniform(this.seed, DIRECTION, n));
    return [size * way.yaw, size * way.pitch];
  }

  private away(n: number): number {
    return logNormal(this.seed, AWAY, n, gaze.aversion[this.mode].away_s);
  }
}

/** How much of a saccade over `way` degrees is done, 0 to 1: the main sequence. */
function step(way: Pair, since: number): number {
  const { base, per_deg } = gaze.saccade_s;
  return minimumJerk(since / (base + per_deg * Math.hypot(...way)));
}

/** Pitch, yaw and roll of the head, radians: drift with a 1/f-like spectrum, and breath. */
function sway(seed: number, t: number): [number, number, number] {
  const start = minimumJerk(t / head.ease_s);
  const [pitch, yaw, roll] = [head.pitch, head.yaw, head.roll].map(
    ({ rms_rad }, i) => start * rms_rad * drift(seed, HEAD + 10 * i, t),
  );
  const { hz, wander, pitch_rad } = head.breath;
  const phase = hz * t + wander * noise(seed, HEAD + 9, hz * t);
  return [pitch + start * pitch_rad * Math.sin(2 * Math.PI * phase), yaw, roll];
}

/** Octaves of noise, each faster and smaller than the one before; rms about 1. */
function drift(seed: number, channel: number, t: number): number {
  let [total, power, rate, size] = [0, 0, head.slowest_hz, 1];
  for (let octave = 0; octave < head.octaves; octave++) {
    total += size * noise(seed, channel + octave, rate * t);
    power += size * size;
    rate *= 2;
    size *= head.falloff;
  }
  return total / (0.5 * Math.sqrt(power));
}

function choose<T extends { share: number }>(options: T[], share: number): T {
  let left = share;
  return options.find((option) => (left -= option.share) < 0) ?? options[options.length - 1];
}
