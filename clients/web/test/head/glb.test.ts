import { describe, expect, it } from "vitest";
import { readHead } from "../../src/head/glb";
import { HeadError } from "../../src/head/model";
import { GlbWriter, smallHead } from "../glb";

type Extras = { fat: Record<string, unknown>[]; turns: Record<string, unknown>[]; [key: string]: unknown };

describe("readHead", () => {
  it("reads what protocol/HEAD.md has", () => {
    const head = readHead(smallHead());
    expect(head.parts.map(({ name }) => name)).toEqual(["skin", "eye_l", "eye_r", "teeth_upper", "teeth_lower", "tongue"]);
    expect(head.fat[0]).toMatchObject({ drive: [[3, 1]], part: "skin", knots: [-100, 200], scale: 0.001 });
    expect([...head.fat[0].indices]).toEqual([5, 6]);
    expect(head.turns[1].parts).toBeNull();
    expect(head.turns[1].weights.get("skin")?.[5]).toBeCloseTo(0.2);
    expect(head.camera).toEqual({ target: [0, 0, 0], height: 2 });
  });

  it("reads a file that lies unaligned in a larger buffer", () => {
    const file = smallHead();
    const shifted = new Uint8Array(file.length + 1);
    shifted.set(file, 1);
    expect(readHead(shifted.subarray(1))).toEqual(readHead(file));
  });

  it.each<[string, (writer: GlbWriter, extras: Extras) => void]>([
    ["another version", (_, extras) => (extras.version = 2)],
    ["no extras", (writer) => delete writer.document.extras],
    ["no skin", (writer) => writer.document.nodes.shift()],
    ["two parts of one name", (writer) => writer.part("skin", [0, 0, 0, 0, 0, 0, 0, 0, 0], [0, 1, 2])],
    ["triangles beyond the vertices", (writer) => writer.part("x", [0, 0, 0], [0, 1, 2])],
    ["corners that make no triangle", (writer) => writer.part("x", [0, 0, 0], [0, 0])],
    ["a knot at 0", (_, extras) => (extras.fat[0].knots = [0, 200])],
    ["knots that descend", (_, extras) => (extras.fat[0].knots = [200, -100])],
    ["too few deltas", (_, extras) => (extras.fat[0].knots = [-100, 100, 200])],
    ["a vertex that does not exist", (writer, extras) => (extras.fat[0].indices = writer.accessor(Uint16Array.of(5, 8), 1))],
    ["an unknown part", (_, extras) => (extras.fat[0].part = "beard")],
    ["weights of another size", (writer, extras) => (extras.turns[1].weights = { skin: writer.accessor(Uint8Array.of(1), 1) })],
    ["an axis too few", (_, extras) => (extras.turns[1].axes = [[1, 0, 0]])],
    ["an accessor beyond the file", (writer) => ((writer.document.accessors[0] as { count: number }).count = 1e6)],
    ["an accessor that is none", (_, extras) => (extras.fat[0].deltas = "x")],
    ["no camera", (_, extras) => delete extras.camera],
  ])("refuses %s", (_, change) => {
    expect(() => readHead(smallHead(change as never))).toThrow(HeadError);
  });

  it("throws nothing but HeadError, wherever the file is cut", () => {
    const file = smallHead();
    for (let end = 0; end < file.length; end += 37) expect(() => readHead(file.slice(0, end))).toThrow(HeadError);
    const broken = file.slice();
    new DataView(broken.buffer).setUint32(12, 40, true);
    expect(() => readHead(broken)).toThrow(HeadError);
  });
});
