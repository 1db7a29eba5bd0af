/**
 * Sample-rate conversion by a windowed sinc (Kaiser, beta 9: 90 dB), evaluated from a table of
 * phases with linear interpolation between them: any pair of rates, one filter.
 */

const ZERO_CROSSINGS = 16;
const PHASES = 512;
const BETA = 9;
/** Of the lower Nyquist frequency; the rest is the filter's slope. */
const PASS = 0.94;

export interface Kernel {
  /** Input samples needed on each side of a position. */
  half: number;
  /** (PHASES + 1) rows of 2 * half taps. */
  taps: Float32Array;
}

/** The low-pass that suits a conversion between rates in Hz. Rows sum to 1: a constant stays as it is. */
export function kernel(from: number, to: number): Kernel {
  const cutoff = Math.min(1, to / from) * (from === to ? 1 : PASS);
  const half = Math.ceil(ZERO_CROSSINGS / cutoff);
  const width = 2 * half;
  const taps = new Float32Array((PHASES + 1) * width);
  for (let phase = 0; phase <= PHASES; phase++) {
    const row = taps.subarray(phase * width, (phase + 1) * width);
    let sum = 0;
    for (let k = 0; k < width; k++) {
      const x = k - half + 1 - phase / PHASES;
      row[k] = sinc(x * cutoff) * kaiser(x / half);
      sum += row[k];
    }
    row.forEach((tap, k) => (row[k] = tap / sum));
  }
  return { half, taps };
}

/** The signal at `index + fraction`, fraction in [0, 1); `data` must reach half - 1 before and half after. */
export function interpolate({ half, taps }: Kernel, data: Float32Array, index: number, fraction: number): number {
  const width = 2 * half;
  const at = fraction * PHASES;
  const phase = Math.floor(at);
  const blend = at - phase;
  const row = phase * width;
  const first = index - half + 1;
  let low = 0;
  let high = 0;
  for (let k = 0; k < width; k++) {
    low += taps[row + k] * data[first + k];
    high += taps[row + width + k] * data[first + k];
  }
  return low + (high - low) * blend;
}

function sinc(x: number): number {
  return Math.abs(x) < 1e-9 ? 1 : Math.sin(Math.PI * x) / (Math.PI * x);
}

function kaiser(x: number): number {
  return Math.abs(x) >= 1 ? 0 : bessel(BETA * Math.sqrt(1 - x * x)) / bessel(BETA);
}

/** Modified Bessel function of the first kind, order 0. */
function bessel(x: number): number {
  let sum = 1;
  let term = 1;
  for (let k = 1; k < 40; k++) {
    term *= (x / (2 * k)) ** 2;
    sum += term;
  }
  return sum;
}
