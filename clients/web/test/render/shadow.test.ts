import { Vector3 } from "three";
import { expect, it } from "vitest";
import { readHead } from "../../src/head/glb";
import { look } from "../../src/render/look";
import { shadowMatrix } from "../../src/render/shadow";
import { smallHead } from "../glb";

const head = readHead(smallHead());
const { target, height } = head.camera;
const at = (along: number) => new Vector3(...look.defines.KEY_FROM).setLength(along).add(new Vector3(...target)).applyMatrix4(shadowMatrix(head));

it("looks along the key light at what the camera looks at", () => {
  expect(at(0).length()).toBeCloseTo(0);
  const nearer = at(0.1 * height);
  expect(nearer.x).toBeCloseTo(0);
  expect(nearer.y).toBeCloseTo(0);
  expect(nearer.z).toBeCloseTo(-0.1 / look.shadow.reach);
});

it("holds a sphere of its reach", () => expect(at(-look.shadow.reach * height).z).toBeCloseTo(1));
