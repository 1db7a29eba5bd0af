import { describe, expect, it } from "vitest";
import { IDLE_FAPS, IdleLife, type Mode } from "../../src/motion/idle";
import { vectors } from "../vectors";

interface Case {
  seed: number;
  mode: Mode;
  times: number[];
  faps: number[];
  values: number[][];
}

/** Frames at 100 Hz. */
function frames(seed: number, seconds: number): Float32Array[] {
  const life = new IdleLife(seed, "listen");
  return Array.from({ length: seconds * 100 }, (_, k) => {
    const values = new Float32Array(69);
    life.write(k / 100, values);
    return values;
  });
}

describe("vectors/life.json", () => {
  for (const { seed, mode, times, faps, values } of vectors<Case>("life.json")) {
    it(`${seed} ${mode}`, () => {
      const life = new IdleLife(seed, mode);
      times.forEach((t, k) => {
        const out = new Float32Array(69);
        life.write(t, out);
        const expected = new Float32Array(69);
        faps.forEach((fap, i) => (expected[fap] = values[k][i]));
        for (let fap = 1; fap < 69; fap++) expect(Math.abs(out[fap] - expected[fap]), `FAP ${fap} at ${t}`).toBeLessThan(0.02);
      });
    });
  }
});

describe("IdleLife", () => {
  const minute = frames(1, 60);

  it("follows from its seed", () => {
    expect(frames(1, 60)).toEqual(minute);
    expect(frames(2, 60)).not.toEqual(minute);
  });

  it("is a function of time: order does not matter", () => {
    const life = new IdleLife(1, "listen");
    const out = new Float32Array(69);
    for (const k of [5000, 17, 2400, 2399]) {
      life.write(k / 100, out);
      expect(out).toEqual(minute[k]);
    }
  });

  it("moves only what it says it moves", () => {
    const moved = new Set(minute.flatMap((values) => [...values.keys()].filter((fap) => values[fap] !== 0)));
    expect([...moved].sort()).toEqual([...IDLE_FAPS].sort());
  });

  it("keeps the gaze where it is while the head turns", () => {
    for (const values of minute) {
      const inward = (values[24] - values[23]) / 2;
      const world = (values[23] + values[24]) / 2 + values[49];
      expect(inward).toBeGreaterThan(0);
      expect(Math.abs(world)).toBeLessThan(0.35e5);
    }
  });
});
