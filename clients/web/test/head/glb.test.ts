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

  it("makes one object of a material that several parts name, so that its pictures are loaded once", () => {
    const { parts } = readHead(smallHead((writer) => {
      writer.document.materials.push({ name: "eye" }, { name: "eye" });
      writer.document.meshes.slice(1, 5).forEach((mesh, i) => Object.assign((mesh as { primitives: object[] }).primitives[0], { material: i < 2 ? 0 : 1 }));
    }));
    const [skin, left, right, upper, lower] = parts.map(({ material }) => material);
    expect(left).toBe(right);
    expect(upper).toBe(lower);
    expect(upper).not.toBe(left);
    expect(upper).toEqual(left);
    expect(skin.name).toBe("");
  });

  it("reads a file that lies unaligned in a larger buffer", () => {
    const file = smallHead();
    const shifted = new Uint8Array(file.length + 1);
    shifted.set(file, 1);
    expect(readHead(shifted.subarray(1))).toEqual(readHead(file));
  });

  it.each<[string, (writer: GlbWriter, extras: Extras) => void]>([
    ["another version", (_, extras) => (extras.version = 2)],
    ["another glTF", (writer) => (writer.document.asset = { version: "1.0" })],
    ["a place whose square is infinite", (writer) => writer.part("x", [3e38, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2])],
    ["no extras", (writer) => delete writer.document.extras],
    ["no skin", (writer) => writer.document.nodes.shift()],
    ["two parts of one name", (writer) => writer.part("skin", [0, 0, 0, 0, 0, 0, 0, 0, 0], [0, 1, 2])],
    ["triangles beyond the vertices", (writer) => writer.part("x", [0, 0, 0], [0, 1, 2])],
    ["corners that make no triangle", (writer) => writer.part("x", [0, 0, 0], [0, 0])],
    ["a knot at 0", (_, extras) => (extras.fat[0].knots = [0, 200])],
    ["a knot next to 0", (_, extras) => (extras.fat[0].knots = [-1e-9, 200])],
    ["knots next to each other", (_, extras) => (extras.fat[0].knots = [100, 100 + 1e-9])],
    ["knots that descend", (_, extras) => (extras.fat[0].knots = [200, -100])],
    ["too few deltas", (_, extras) => (extras.fat[0].knots = [-100, 100, 200])],
    ["a vertex that does not exist", (writer, extras) => (extras.fat[0].indices = writer.accessor(Uint16Array.of(5, 8), 1))],
    ["an unknown part", (_, extras) => (extras.fat[0].part = "beard")],
    ["weights of another size", (writer, extras) => (extras.turns[1].weights = { skin: writer.accessor(Uint8Array.of(1), 1) })],
    ["a turn by what is no FAP", (_, extras) => (extras.turns[1].faps = [48, 49, 1e9])],
    ["a table of no FAP", (_, extras) => Object.assign(extras.fat[0], { fap: undefined, drive: {} })],
    ["a table of what is no FAP", (_, extras) => (extras.fat[0].fap = [5])],
    ["an axis of length 0", (_, extras) => ((extras.turns[1].axes as number[][])[0] = [0, 0, 0])],
    ["a mouth without height", (_, extras) => (extras.mouth = { center: [0, 0, 0], size: [1, 0] })],
    ["a part that is moved", (writer) => Object.assign(writer.document.nodes[0] as object, { translation: [0, 1, 0] })],
    ["an axis too few", (_, extras) => (extras.turns[1].axes = [[1, 0, 0]])],
    ["an accessor beyond the file", (writer) => ((writer.document.accessors[0] as { count: number }).count = 1e6)],
    ["an accessor that is none", (_, extras) => (extras.fat[0].deltas = "x")],
    ["a material that does not exist", (writer) => Object.assign((writer.document.meshes[1] as { primitives: object[] }).primitives[0], { material: 0 })],
    ["an alphaMode that there is not", (writer) => {
      writer.document.materials.push({ alphaMode: "GLASS" });
      Object.assign((writer.document.meshes[1] as { primitives: object[] }).primitives[0], { material: 0 });
    }],
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
