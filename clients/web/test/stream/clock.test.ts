import { expect, it } from "vitest";
import { OutputClock } from "../../src/stream/clock";

it("knows nothing before it is told", () => {
  expect(new OutputClock().heard(1000, 5)).toBe(0);
  expect(new OutputClock().when(1)).toBeNull();
});

it("runs on between timestamps, but never past what was rendered", () => {
  const clock = new OutputClock();
  clock.observe(2, 1000);
  expect(clock.heard(1500, 10)).toBeCloseTo(2.5);
  expect(clock.heard(1500, 2.1)).toBe(2.1);
  expect(clock.when(3)).toBeCloseTo(2000);
});

it("smooths jitter and follows a stall at once", () => {
  const clock = new OutputClock();
  const errors: number[] = [];
  for (let k = 0; k < 500; k++) {
    clock.observe(k / 60 + (k % 2 ? 0.004 : -0.004), (k * 1000) / 60);
    if (k > 100) errors.push(Math.abs(clock.heard((k * 1000) / 60, Infinity) - k / 60));
  }
  expect(Math.max(...errors)).toBeLessThan(0.001);
  clock.observe(500 / 60 - 0.3, 500000 / 60);
  expect(clock.heard(500000 / 60, Infinity)).toBeCloseTo(500 / 60 - 0.3, 3);
});
