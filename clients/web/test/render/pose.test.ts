import { Matrix4, Vector3 } from "three";
import { expect, it } from "vitest";
import { Deformer } from "../../src/head/deform";
import { readHead } from "../../src/head/glb";
import { undoTurn } from "../../src/render/pose";
import { smallHead } from "../glb";

const head = readHead(smallHead());

it("brings a turned head back to where the file has it", () => {
  const values = new Float64Array(69);
  [values[48], values[49], values[50]] = [12000, -30000, 7000];
  const deformer = new Deformer(head);
  deformer.apply(values);
  const whole = head.turns.filter(({ parts }) => parts === null);
  expect(whole.length).toBeGreaterThan(0);
  const { part, positions } = deformer.shapes.find((shape) => whole.every(({ weights }) => !weights.has(shape.part.name)))!;
  const back = new Vector3().fromArray(positions).applyMatrix4(undoTurn(head, values, new Matrix4()));
  expect(positions[0]).not.toBeCloseTo(part.positions[0], 5);
  expect(back.distanceTo(new Vector3().fromArray(part.positions))).toBeLessThan(1e-6);
});
