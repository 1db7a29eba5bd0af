import { describe, expect, it } from "vitest";
import { IDLE_FAPS, IdleLife, smooth } from "../../src/motion/idle";

function minute(seed: number): Float32Array[] {
  const life = new IdleLife(seed);
  return Array.from({ length: 6000 }, (_, k) => {
    const values = new Float32Array(69);
    life.write(k / 100, values);
    return values;
  });
}

describe("IdleLife", () => {
  const frames = minute(1);

  it("follows from its seed", () => {
    expect(minute(1)).toEqual(frames);
    expect(minute(2)).not.toEqual(frames);
  });

  it("moves only what it says it moves", () => {
    const moved = new Set(frames.flatMap((values) => [...values.keys()].filter((fap) => values[fap] !== 0)));
    expect([...moved].sort()).toEqual([...IDLE_FAPS].sort());
  });

  it("blinks 8 to 30 times a minute, lids meeting", () => {
    const shut = frames.map((values) => values[19] + values[21] > 1000);
    const blinks = shut.filter((now, k) => now && !shut[k - 1]).length;
    expect(blinks).toBeGreaterThanOrEqual(8);
    expect(blinks).toBeLessThanOrEqual(30);
  });

  it("turns the head gently and never jumps", () => {
    for (const fap of [48, 49, 50]) {
      const track = frames.map((values) => values[fap]);
      expect(Math.max(...track.map(Math.abs))).toBeLessThan(3000);
      expect(Math.max(...track) - Math.min(...track)).toBeGreaterThan(500);
      expect(Math.max(...track.slice(1).map((v, k) => Math.abs(v - track[k])))).toBeLessThan(60);
    }
  });

  it("does not catch up on blinks after a long pause", () => {
    const life = new IdleLife(3);
    const values = new Float32Array(69);
    life.write(0, values);
    const started = performance.now();
    life.write(1e6, values);
    expect(performance.now() - started).toBeLessThan(50);
  });
});

it("smooth is held beyond its ends", () => expect([-1, 0, 0.5, 1, 2].map(smooth)).toEqual([0, 0, 0.5, 1, 1]));
