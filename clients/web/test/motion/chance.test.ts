import { describe, expect, it } from "vitest";
import { Events, minimumJerk, noise, normal, uniform } from "../../src/motion/chance";

const many = Array.from({ length: 20000 }, (_, k) => k);
const mean = (values: number[]) => values.reduce((sum, v) => sum + v, 0) / values.length;

describe("chance", () => {
  it("is uniform and normal", () => {
    const flat = many.map((k) => uniform(7, 3, k));
    expect(mean(flat)).toBeCloseTo(0.5, 2);
    expect(Math.min(...flat)).toBeGreaterThanOrEqual(0);
    expect(Math.max(...flat)).toBeLessThan(1);
    const bell = many.map((k) => normal(7, 3, k));
    expect(Math.abs(mean(bell))).toBeLessThan(0.03);
    expect(mean(bell.map((v) => v * v))).toBeCloseTo(1, 1);
  });

  it("makes noise without steps, within -1 to 1", () => {
    const track = many.map((k) => noise(7, 3, k / 100));
    expect(Math.max(...track.map(Math.abs))).toBeLessThanOrEqual(1);
    expect(Math.max(...track.slice(1).map((v, k) => Math.abs(v - track[k])))).toBeLessThan(0.05);
  });

  it("holds a minimum jerk beyond its ends", () => expect([-1, 0, 0.5, 1, 2].map(minimumJerk)).toEqual([0, 0, 0.5, 1, 1]));

  it("counts events by their gaps, forward and back", () => {
    const events = new Events((k) => 1 + k);
    expect([0, 1.9, 2, 4.5, 0.5].map((t) => events.at(t))).toEqual([[1, 0], [1, 1.9], [2, 0], [2, 2.5], [1, 0.5]]);
  });
});
