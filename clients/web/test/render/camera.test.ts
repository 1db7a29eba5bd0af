import { describe, expect, it } from "vitest";
import { frame, swing } from "../../src/render/camera";

const camera = { target: [0.01, 0.02, 0.03] as [number, number, number], height: 0.3 };
const shown = (aspect: number) => 2 * (frame(camera, 20, aspect).position[2] - 0.03) * Math.tan((10 * Math.PI) / 180);

describe("frame", () => {
  it.each([1, 1.6, 3])("shows the wished height at aspect %f", (aspect) => expect(shown(aspect)).toBeCloseTo(0.3));
  it.each([0.2, 0.5])("shows the whole head at aspect %f", (aspect) => expect(shown(aspect) * aspect).toBeCloseTo(0.24));
  it("looks straight ahead", () => {
    const { position, target } = frame(camera, 20, 1);
    expect(target).toEqual(camera.target);
    expect(position.slice(0, 2)).toEqual(camera.target.slice(0, 2));
  });
  it("goes round the head at the same distance, to its left if positive", () => {
    const [from, to] = [frame(camera, 20, 1), frame(camera, 20, 1, 0.5)].map(({ position }) => position);
    const off = (position: readonly number[]) => Math.hypot(...position.map((x, i) => x - camera.target[i]));
    expect(off(to)).toBeCloseTo(off(from));
    expect(Math.atan2(to[0] - camera.target[0], to[2] - camera.target[2])).toBeCloseTo(0.5);
    expect(to[1]).toBe(from[1]);
  });
});

describe("swing", () => {
  const yaws = Array.from({ length: 600 }, (_, i) => swing(i / 30));

  it("begins in front and reaches both sides alike", () => {
    expect(yaws[0]).toBe(0);
    expect(Math.max(...yaws)).toBeGreaterThan(0.4);
    expect(Math.max(...yaws)).toBeCloseTo(-Math.min(...yaws), 2);
  });
  it("shows no profile, and never jumps", () => {
    expect(Math.max(...yaws)).toBeLessThan(1);
    for (let i = 1; i < yaws.length; i++) expect(Math.abs(yaws[i] - yaws[i - 1])).toBeLessThan(0.02);
  });
});
