import { describe, expect, it } from "vitest";
import { FLOOR_S, Jitter, steer } from "../../src/stream/jitter";
import { vectors } from "../vectors";

type Step = ["packet", number, number] | ["underrun", number] | ["restart"] | ["ease", number];

describe("vectors/jitter.json", () => {
  for (const { pattern, steps, targets } of vectors<{ pattern: string; steps: Step[]; targets: number[] }>("jitter.json")) {
    it(pattern, () => {
      const jitter = new Jitter();
      steps.forEach((step, k) => {
        if (step[0] === "packet") jitter.observe(step[1], step[2]);
        else if (step[0] === "underrun") jitter.underrun(step[1]);
        else if (step[0] === "ease") jitter.ease(step[1]);
        else jitter.restart();
        expect(jitter.targetS, `step ${k}`).toBeCloseTo(targets[k], 5);
      });
    });
  }
});

it("takes nobody for late after a restart", () => {
  const jitter = new Jitter();
  for (let k = 1; k < 100; k++) jitter.observe(0.04 * k, 0.04 * k);
  jitter.restart();
  expect(jitter.observe(0.04, 60)).toBe(0);
  expect(jitter.targetS).toBeCloseTo(FLOOR_S);
});

it("steers within a band", () => {
  expect([0.05, 0.094, 0.096, 0.119, 0.121].map((level) => steer(level, 0.1))).toEqual([1, 1, 0, 0, -1]);
});

it.each([-200, 200])("keeps a store for four hours though clocks drift by %i ppm", (ppm) => {
  const jitter = new Jitter();
  let [shift, free, least, most] = [0.08, 0, Infinity, 0];
  for (let k = 1; k <= 4 * 3600 * 25; k++) {
    const now = 0.04 * k * (1 + 1e-6 * ppm) + 0.01 * ((k * 0.618) % 1);
    const late = jitter.observe(0.04 * k, now);
    const store = shift + 0.04 * k - now;
    [least, most] = [Math.min(least, store - 0.04), Math.max(most, store - 0.04)];
    const way = now > free ? steer(store + late, jitter.targetS) : 0;
    if (way) [shift, free] = [shift + 0.01 * way, now + 0.2];
  }
  expect(least).toBeGreaterThan(0);
  expect(most).toBeLessThan(0.08);
});
