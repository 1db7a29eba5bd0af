import { describe, expect, it } from "vitest";
import { frame } from "../../src/render/camera";

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
});
