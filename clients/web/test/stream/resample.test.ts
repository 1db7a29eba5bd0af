import { describe, expect, it } from "vitest";
import { interpolate, kernel } from "../../src/stream/resample";

const RATES: [number, number][] = [[16000, 48000], [22050, 48000], [16000, 44100], [22050, 44100], [48000, 44100], [16000, 8000], [16000, 16000]];

/** `seconds` of a sine at `hz`, converted from one rate to another; the signal runs on beyond both ends. */
function convert(from: number, to: number, hz: number, seconds = 0.2): Float32Array {
  const filter = kernel(from, to);
  const pad = filter.half;
  const data = Float32Array.from({ length: from * seconds + 2 * pad + 2 }, (_, i) => Math.sin((2 * Math.PI * hz * (i - pad)) / from));
  return Float32Array.from({ length: to * seconds }, (_, n) => {
    const at = (n * from) / to;
    return interpolate(filter, data, Math.floor(at) + pad, at - Math.floor(at));
  });
}

function level(signal: Float32Array): number {
  return Math.sqrt(signal.reduce((sum, v) => sum + v * v, 0) / signal.length);
}

describe("conversion between rates", () => {
  it.each(RATES)("%i to %i Hz leaves a tone in the pass band where and as it was", (from, to) => {
    for (const share of [0.02, 0.3, 0.7]) {
      const hz = (share * Math.min(from, to)) / 2;
      const out = convert(from, to, hz);
      const error = out.map((v, n) => v - Math.sin((2 * Math.PI * hz * n) / to));
      expect(20 * Math.log10(level(error) / Math.SQRT1_2)).toBeLessThan(-70);
    }
  });

  it.each([[48000, 16000], [44100, 16000], [22050, 8000]])("%i to %i Hz keeps out what would fold back", (from, to) => {
    const out = convert(from, to, (1.25 * to) / 2);
    expect(20 * Math.log10(level(out) / Math.SQRT1_2)).toBeLessThan(-70);
  });

  it.each([[16000, 48000], [22050, 48000]])("%i to %i Hz makes no images", (from, to) => {
    const hz = 0.8 * (from / 2);
    const out = convert(from, to, hz);
    const image = from - hz;
    let [re, im] = [0, 0];
    out.forEach((v, n) => ((re += v * Math.cos((2 * Math.PI * image * n) / to)), (im += v * Math.sin((2 * Math.PI * image * n) / to))));
    expect(20 * Math.log10((2 * Math.hypot(re, im)) / out.length)).toBeLessThan(-60);
  });

  it("leaves a constant as it is", () => {
    const filter = kernel(22050, 44100);
    const ones = new Float32Array(200).fill(1);
    for (const fraction of [0, 0.1, 0.49, 0.999]) expect(interpolate(filter, ones, 100, fraction)).toBeCloseTo(1, 5);
  });
});
