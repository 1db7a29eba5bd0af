/**
 * Time-stretch by whole pitch periods, without changing the pitch: one period is left out, or said twice, under a
 * cross-fade. Twin of fapstream/stream/stretch.py. Full scale is 1, `rate` Hz.
 */

export type Sound = Float32Array;

/** Of a pitch period: 400 to 67 Hz. */
const SHORTEST_S = 0.0025;
const LONGEST_S = 0.015;
/** Shorter stretches are alike by chance, within the ringing of a formant. */
const LEAST_COMPARED_S = 0.0125;
/** Periods are first sought at this rate. */
const COARSE_HZ = 8000;
/** Likeness from which two periods may stand for each other. */
export const ALIKE = 0.9;
/** Likeness from which a sound is continued as a voice rather than as noise. */
const VOICED = 0.5;
/** Root mean square of a pause: -48 dB of full scale. */
const QUIET = 0.004;
/** Noise that is repeated would buzz: it falls faster than a voice. */
const NOISE_FALL_S = 0.012;
/** A step dies away with this time constant. */
const DECAY_S = 0.0014;

/** The shortest and the longest period in samples. */
export function periods(rate: number): { least: number; most: number } {
  return { least: Math.round(SHORTEST_S * rate), most: Math.round(LONGEST_S * rate) };
}

/** Is there nothing in it that anyone would miss? */
export function isQuiet(sound: Sound): boolean {
  return sound.reduce((sum, v) => sum + v * v, 0) <= QUIET * QUIET * sound.length;
}

/** Normalised cross-correlation of n samples at `at` and at `other`, every `step`th; 0 if one of them is silent. */
export function likeness(sound: Sound, at: number, other: number, n: number, step = 1): number {
  let [aa, bb, ab] = [0, 0, 0];
  for (let k = 0; k < n; k++) {
    const a = sound[at + k * step];
    const b = sound[other + k * step];
    aa += a * a;
    bb += b * b;
    ab += a * b;
  }
  return aa * bb > 1e-12 ? ab / Math.sqrt(aa * bb) : 0;
}

export interface Period {
  /** In samples; 0 if there is too little sound to tell. */
  lag: number;
  alike: number;
}

/** The lag at which the sound from `at` on is most like what lies a lag ahead (way 1) or back (-1), and that likeness. */
export function period(sound: Sound, at: number, way: number, rate: number): Period {
  const { least, most } = periods(rate);
  const window = Math.round(LEAST_COMPARED_S * rate);
  const ahead = sound.length - at;
  const room = way > 0 ? Math.min(ahead - window, Math.floor(ahead / 2)) : Math.min(ahead >= window ? ahead : 0, at);
  const top = Math.min(most, room);
  if (top < least) return { lag: 0, alike: 0 };
  const step = Math.max(1, Math.floor(rate / COARSE_HZ));
  const coarse = { from: Math.floor(least / step), to: Math.floor(top / step), window: Math.floor(window / step), step };
  const near = best(sound, at, way, coarse).lag;
  return best(sound, at, way, { from: Math.max(least, step * (near - 1)), to: Math.min(top, step * (near + 1)), window, step: 1 });
}

/** Of the lags from `from` to `to`, each `step` samples, the first with the greatest likeness. */
function best(sound: Sound, at: number, way: number, lags: { from: number; to: number; window: number; step: number }): Period {
  const { from, to, window, step } = lags;
  const found = { lag: from, alike: -Infinity };
  for (let lag = from; lag <= to; lag++) {
    const alike = likeness(sound, at, at + way * lag * step, Math.max(lag, window), step);
    if (alike > found.alike) Object.assign(found, { lag, alike });
  }
  return found;
}

/**
 * From `old` to `fresh`, both of one length, along a straight line: what is alike keeps its strength. They may be a part
 * of a fade of that `length`, of which so much was `done` before.
 */
export function fade(old: Sound, fresh: Sound, done = 0, length = old.length): Sound {
  return old.map((v, k) => v + (fresh[k] - v) * ((done + k + 1) / (length + 1)));
}

/**
 * What follows `past` when the sound breaks off: its last period again and again, dying away. Joins without a step and
 * ends in silence after `seconds`, or earlier if it is noise.
 */
export function fall(past: Sound, rate: number, seconds: number): Sound {
  const { most } = periods(rate);
  const last = past.at(-1) ?? 0;
  const decay = (k: number) => Math.exp(-(k + 1) / (DECAY_S * rate));
  if (past.length < 2 * most || isQuiet(past.subarray(-2 * most))) {
    return Float32Array.from({ length: Math.round(8 * DECAY_S * rate) }, (_, k) => last * decay(k));
  }
  let { lag, alike } = period(past.slice().reverse(), 0, 1, rate);
  let length = Math.round(seconds * rate);
  if (alike < VOICED) [lag, length] = [most, Math.min(length, Math.round(NOISE_FALL_S * rate))];
  const again = loop(past, lag);
  const step = last - past[past.length - lag - 1];
  return Float32Array.from({ length }, (_, k) => {
    const sunk = 0.5 + 0.5 * Math.cos((Math.PI * (k + 1)) / length);
    return (again[k % lag] + step * decay(k)) * sunk;
  });
}

/** The last `lag` samples, whose end goes over into what came before their beginning. */
function loop(past: Sound, lag: number): Sound {
  const again = past.slice(-lag);
  const start = past.length - lag;
  const n = Math.min(Math.floor(lag / 4), start);
  again.set(fade(again.slice(lag - n), past.subarray(start - n, start)), lag - n);
  return again;
}
