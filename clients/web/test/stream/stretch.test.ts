import { describe, expect, it } from "vitest";
import { fade, fall, isQuiet, period } from "../../src/stream/stretch";
import { vectors } from "../vectors";

interface Case {
  rate: number;
  pcm: Int16Array;
  at: number;
  way: number;
  lag: number;
  alike: number;
  fall: number[];
}

describe("vectors/stretch.json", () => {
  for (const { rate, pcm, at, way, lag, alike, fall: expected } of vectors<Case>("stretch.json")) {
    it(`${rate} Hz, way ${way}`, () => {
      const sound = Float32Array.from(pcm, (v) => v / 32768);
      const found = period(sound, at, way, rate);
      expect(found.lag).toBe(lag);
      expect(found.alike).toBeCloseTo(alike, 5);
      const gone = fall(sound, rate, 0.04);
      expected.forEach((v, k) => expect(gone[16 * k]).toBeCloseTo(v, 5));
      expect(Math.ceil(gone.length / 16)).toBe(expected.length);
    });
  }
});

it("finds nothing in too little sound", () => expect(period(new Float32Array(50), 10, 1, 16000).lag).toBe(0));

it("knows a pause", () => {
  expect(isQuiet(new Float32Array(10).fill(0.003))).toBe(true);
  expect(isQuiet(new Float32Array(10).fill(0.1))).toBe(false);
});

it("fades along a line", () => {
  expect([...fade(Float32Array.of(1, 1, 1), Float32Array.of(0, 0, 0))]).toEqual([0.75, 0.5, 0.25]);
});

it("lets noise and steps die away at once", () => {
  const noise = Float32Array.from({ length: 1000 }, (_, k) => Math.sin(k * k));
  expect(fall(noise, 16000, 0.04)).toHaveLength(192);
  const gone = fall(Float32Array.of(0.5), 16000, 0.04);
  expect(gone[0]).toBeGreaterThan(0.47);
  expect(gone.at(-1)).toBeLessThan(1e-3);
});
