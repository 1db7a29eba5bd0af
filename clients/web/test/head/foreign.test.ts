import { readdirSync, readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { Deformer } from "../../src/head/deform";
import { readAnyHead } from "../../src/head/foreign";
import { HeadError } from "../../src/head/model";
import { GlbWriter, smallHead } from "../glb";

interface Vectors {
  head: string;
  tolerance_m: number;
  warnings: string[];
  parts: string[];
  cases: { name: string; faps: Record<string, number>; vertices: Record<string, number[]>; positions: Record<string, number[][]> }[];
}

const folder = new URL("../../../../protocol/vectors/foreign/", import.meta.url);
const frame = (values: Record<number, number>) => Object.assign(new Float32Array(69), values);
const vectors = JSON.parse(readFileSync(new URL("avatar.json", folder), "utf-8")) as Vectors;
const file = new Uint8Array(readFileSync(new URL(vectors.head, folder)));

describe("protocol/vectors/foreign", () => {
  const { head, warnings } = readAnyHead(file, "avatar");
  const deformer = new Deformer(head);

  it("has the same parts and lacks the same shapes", () => {
    expect(head.parts.map(({ name }) => name)).toEqual(vectors.parts);
    expect(warnings).toEqual(vectors.warnings);
  });

  it.each(vectors.cases)("$name", ({ faps, vertices, positions }) => {
    deformer.apply(frame(faps));
    for (const { part, positions: found } of deformer.shapes) {
      vertices[part.name].forEach((v, i) => positions[part.name][i].forEach((x, k) => {
        expect(Math.abs(found[3 * v + k] - x)).toBeLessThanOrEqual(vectors.tolerance_m);
      }));
    }
  });
});

/** A square whose corners do what shapes do; `change` makes it what a test is about. */
function square(names: string[], change: (writer: GlbWriter & { document: Record<string, unknown> }) => void = () => undefined): Uint8Array {
  const writer = new GlbWriter();
  writer.part("Face", [-1, 0, 0, 1, 0, 0, 1, 2, 0, -1, 2, 0].map((x) => x * 0.05), [0, 1, 2, 0, 2, 3]);
  const mesh = writer.document.meshes[0] as { primitives: Record<string, unknown>[]; extras: unknown };
  mesh.extras = { targetNames: names };
  mesh.primitives[0].targets = names.map((_, i) => {
    const move = new Float32Array(12);
    move[3 * (i % 4) + 1] = -0.01 * (i + 1);
    return { POSITION: writer.accessor(move, 3) };
  });
  change(writer as never);
  return writer.file();
}

describe("readAnyHead", () => {
  it("reads our own files as such", () => {
    const { head, warnings } = readAnyHead(smallHead());
    expect(head.name).toBe("small");
    expect(warnings).toEqual([]);
  });

  it("drives shapes between 0 and 1 and says in one line what is missing", () => {
    const { head, warnings } = readAnyHead(square(["jawOpen", "mouthClose", "eyeBlink_L"]), "Ann");
    expect(warnings[0]).toMatch(/^Ann: shapes are missing: browInnerUp, .*mouthPucker/);
    expect(warnings.filter((line) => line.includes("missing"))).toHaveLength(1);
    const deformer = new Deformer(head);
    const rest = head.parts[0].positions;
    const size = (rest[3] - rest[0]) / 0.1;
    const moved = (faps: Record<number, number>, i: number) => {
      deformer.apply(frame(faps));
      return (deformer.shapes[0].positions[i] - rest[i]) / size;
    };
    expect(moved({ 3: 30000 }, 1)).toBeCloseTo(-0.01, 5);
    expect(moved({ 3: -30000 }, 1)).toBeCloseTo(0, 5);
    expect(moved({ 19: 1024 }, 7)).toBeCloseTo(-0.03, 4);
    expect(moved({ 19: 9999 }, 7)).toBeCloseTo(-0.03, 5);
  });

  it("takes visemes, and VRM's presets by number, with VRM 0 turned round", () => {
    expect(readAnyHead(square(["viseme_aa", "viseme_U"])).head.fat.length).toBe(2);
    const vrm = square(["x", "y"], ({ document }) => {
      document.extensions = { VRM: { blendShapeMaster: { blendShapeGroups: [{ presetName: "a", binds: [{ mesh: 0, index: 1, weight: 50 }] }] } } };
    });
    const { head } = readAnyHead(vrm);
    expect(head.fat).toHaveLength(1);
    const [plain] = readAnyHead(square(["viseme_aa"])).head.parts;
    const width = (xs: Float32Array) => Math.sign(xs[3] - xs[0]);
    expect(width(head.parts[0].positions)).toBe(-width(plain.positions));
  });

  it.each<[string, (writer: { document: Record<string, any> }) => void]>([
    ["no face shapes", ({ document }) => (document.meshes[0].extras.targetNames = ["bulge", "dent"])],
    ["no names", ({ document }) => delete document.meshes[0].extras],
    ["a cycle", ({ document }) => (document.nodes[0].children = [0])],
    ["a child of two", ({ document }) => document.nodes.push({ children: [0] }, { children: [0] })],
    ["too many nodes", ({ document }) => document.nodes.push(...Array.from({ length: 5000 }, () => ({})))],
    ["a count of 2^31", ({ document }) => (document.accessors[0].count = 2 ** 31)],
    ["a count without bytes", ({ document }) => ((document.accessors[2].count = 1e7), delete document.accessors[2].bufferView)],
    ["a flat node", ({ document }) => (document.nodes[0].scale = [0, 1, 1])],
    ["a far node", ({ document }) => (document.nodes[0].translation = [1e300, 0, 0])],
    ["an extension that has to be known", ({ document }) => (document.extensionsRequired = ["KHR_draco_mesh_compression"])],
    ["a skin without joints", ({ document }) => ((document.nodes[0].skin = 0), (document.skins = [{ joints: [] }]))],
    ["a stride too small", ({ document }) => (document.bufferViews[0].byteStride = 4)],
    ["targets that are none", ({ document }) => (document.meshes[0].primitives[0].targets = 3)],
    ["a preset that leads nowhere", ({ document }) => (document.extensions = { VRM: { blendShapeMaster: { blendShapeGroups: [{ presetName: "a", binds: [{ mesh: "x" }] }] } } })],
  ])("refuses %s", (_, change) => {
    expect(() => readAnyHead(square(["jawOpen"], change as never))).toThrow(HeadError);
  });

  it("throws nothing but HeadError, whatever is damaged", () => {
    const small = square(["jawOpen", "mouthPucker"]);
    const random = generator(7);
    for (let run = 0; run < 1500; run++) {
      const broken = small.slice();
      for (let i = 0; i < 1 + random(5); i++) broken[12 + random(broken.length - 12)] = random(256);
      harmless(broken);
    }
    for (let end = 0; end < small.length; end += 97) harmless(small.slice(0, end));
  });

  it("throws nothing but HeadError, whatever the document says", () => {
    const random = generator(11);
    const leaves = [null, true, -1, 0, 1, 2, 7, 2 ** 31, 0.5, 1e30, -1e6, "", "x", [], {}, [0], [[]], "VEC3", "jawOpen"];
    for (let run = 0; run < 1500; run++) {
      harmless(square(["jawOpen", "mouthPucker"], ({ document }) => {
        let at = document as Record<string, unknown>;
        for (let depth = 0; depth < 12; depth++) {
          const keys = Object.keys(at);
          if (!keys.length) return;
          const key = keys[random(keys.length)];
          const inner = at[key];
          if (!inner || typeof inner !== "object" || random(6) === 0) return void (at[key] = structuredClone(leaves[random(leaves.length)]));
          at = inner as Record<string, unknown>;
        }
      }));
    }
  });
});

const corpus = new URL("../../../../tests/unit/head/corpus/", import.meta.url);

it.each(readdirSync(corpus))("refuses %s, as Python does", (name) => {
  expect(() => readAnyHead(new Uint8Array(readFileSync(new URL(name, corpus))))).toThrow(HeadError);
});

function harmless(data: Uint8Array): void {
  try {
    readAnyHead(data);
  } catch (e) {
    if (!(e instanceof HeadError)) throw e;
  }
}

/** Numbers below n, the same in every run. */
function generator(seed: number): (n: number) => number {
  return (n) => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return Math.floor((seed / 2 ** 32) * n);
  };
}
