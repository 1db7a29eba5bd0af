import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { AU, Deformer, knotShares, rotation } from "../../src/head/deform";
import { readHead } from "../../src/head/glb";
import { smallHead } from "../glb";

const deformer = () => new Deformer(readHead(smallHead()));
const faps = (values: Record<number, number>) => Object.assign(new Float32Array(69), values);
const vertex = (array: Float32Array, v: number) => [...array.slice(3 * v, 3 * v + 3)].map((x) => Math.round(x * 1e5) / 1e5 + 0);

interface Vectors {
  head: string;
  tolerance_m: number;
  cases: { name: string; faps: Record<string, number>; positions: Record<string, number[][]> }[];
}

describe("protocol/vectors/deform", () => {
  const folder = new URL("../../../../protocol/vectors/deform/", import.meta.url);
  const { head, tolerance_m, cases } = JSON.parse(readFileSync(new URL("small.json", folder), "utf-8")) as Vectors;
  const small = new Deformer(readHead(readFileSync(new URL(head, folder))));

  it.each(cases)("$name", ({ faps: values, positions }) => {
    small.apply(faps(values));
    for (const [name, points] of Object.entries(positions)) {
      const found = small.shapes.find(({ part }) => part.name === name)!.positions;
      expect(found.length).toBe(points.flat().length);
      points.flat().forEach((x, i) => expect(Math.abs(found[i] - x)).toBeLessThanOrEqual(tolerance_m));
    }
  });
});

describe("knotShares", () => {
  it.each<[number, number[], [number, number][]]>([
    [0, [-100, 200], []], [200, [-100, 200], [[1, 1]]], [50, [-100, 200], [[1, 0.25]]], [-50, [-100, 200], [[0, 0.5]]],
    [400, [-100, 200], [[1, 2]]], [-300, [-100, 200], [[0, 3]]], [150, [100, 200], [[0, 0.5], [1, 0.5]]],
    [300, [100, 200], [[0, -1], [1, 2]]], [-100, [100, 200], [[0, -1]]], [50, [-200, -100], [[1, -0.5]]],
  ])("at %i of %j", (value, knots, shares) => expect(knotShares(knots, value)).toEqual(shares));
});

describe("rotation", () => {
  it("multiplies in order, right-handed, whatever the axes' length", () => {
    const quarter = Math.PI / 2 / AU;
    const m = rotation({ faps: [1, 2], axes: [[3, 0, 0], [0, 1, 0]] }, [0, quarter, quarter]).map((x) => Math.round(x) + 0);
    // Rx(90) Ry(90): z goes to x by Ry, and x stays by Rx.
    expect([m[2], m[5], m[8]]).toEqual([1, 0, 0]);
    expect([m[0], m[3], m[6]]).toEqual([0, 1, 0]);
  });
});

describe("Deformer", () => {
  it("adds displacements of all FAPs, linearly between knots", () => {
    const head = deformer();
    head.apply(faps({ 3: 100, 4: 50 }));
    expect(vertex(head.shapes[0].positions, 5)).toEqual([2.5, 0, 0.5]);
    expect(vertex(head.shapes[0].positions, 6)).toEqual([2, 1, 0.5]);
    expect(vertex(head.shapes[0].positions, 4)).toEqual([1, 0, 0]);
  });

  it("turns by weight, after displacing, about the pivot", () => {
    const head = deformer();
    head.apply(faps({ 49: Math.PI / 2 / AU }));
    expect(vertex(head.shapes[1].positions, 1)).toEqual([-1, 0, 0]);
    const [skin] = head.shapes;
    expect(vertex(skin.positions, 0)).toEqual([0, 0, 0]);
    expect(vertex(skin.positions, 1)).toEqual([-1, 0, 0]);
    expect(vertex(skin.positions, 5)).toEqual([2 + 0.2 * (-1 - 2), 0, 0.2 * (1 - 2 - 0)]);
    expect(vertex(skin.normals, 1)).toEqual([1, 0, 0]);
  });

  it("comes back to rest exactly", () => {
    const head = deformer();
    const rest = head.shapes.map(({ positions, normals }) => [positions.slice(), normals.slice()]);
    head.apply(faps({ 3: 170, 4: -30, 23: 20000, 48: 9000, 49: -7000 }));
    expect(head.shapes[0].positions).not.toEqual(rest[0][0]);
    head.apply(faps({}));
    expect(head.shapes.map(({ positions, normals }) => [positions, normals])).toEqual(rest);
  });

  it("recomputes normals, one for both sides of a seam", () => {
    const head = deformer();
    head.apply(faps({ 3: 200 }));
    const { normals } = head.shapes[0];
    expect(vertex(normals, 5)).toEqual([-0.70711, 0, 0.70711]);
    expect(vertex(normals, 0)).toEqual([0, 0, 1]);
    expect(vertex(normals, 4)).toEqual(vertex(normals, 1));
    expect(normals[3 * 4]).toBeLessThan(-0.3);
  });
});
