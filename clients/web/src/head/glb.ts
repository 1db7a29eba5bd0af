/** Head files: GLB (glTF 2.0) bytes to a Head, as protocol/HEAD.md defines them. Throws HeadError and nothing else. */

import { below, Document, FLOAT, list, natural, number, numbers, object, point, positive, sized, splitGlb, UNSIGNED, WIDTHS, type Json } from "./document";
import { HeadError, type FatEntry, type Head, type Part, type Turn } from "./model";

const REQUIRED_PARTS = ["skin"];
/** What knots are apart, of each other and of 0, at the least. */
const KNOT_GAP = 1e-6;
/** Parts are in head coordinates. */
const TRANSFORMS = ["matrix", "translation", "rotation", "scale"];

export function readHead(data: Uint8Array): Head {
  const { document, binary } = splitGlb(data);
  return new Reader(document, binary).head();
}

class Reader extends Document {
  private parts = new Map<string, Part>();

  head(): Head {
    const extras = object(object(this.document.extras, "extras").fapstream, "extras.fapstream");
    if (extras.version !== 1) throw new HeadError(`extras.fapstream.version is ${String(extras.version)}, not 1`);
    list(this.document.nodes, "nodes").forEach((node, i) => this.node(object(node, `nodes[${i}]`), `nodes[${i}]`));
    const missing = REQUIRED_PARTS.filter((name) => !this.parts.has(name));
    if (missing.length) throw new HeadError(`parts are missing: ${missing.join(", ")}`);
    const mouth = object(extras.mouth, "mouth");
    const camera = object(extras.camera, "camera");
    return {
      name: String(extras.name ?? ""),
      parts: [...this.parts.values()],
      mouth: { center: point(mouth.center, "mouth.center"), size: sizeOf(mouth.size) },
      camera: { target: point(camera.target, "camera.target"), height: positive(camera.height, "camera.height") },
      fat: list(extras.fat, "fat").map((row, i) => this.fat(object(row, `fat[${i}]`), `fat[${i}]`)),
      turns: list(extras.turns, "turns").map((row, i) => this.turn(object(row, `turns[${i}]`), `turns[${i}]`)),
    };
  }

  private node(node: Json, where: string): void {
    if (node.mesh === undefined) return;
    const { name } = node;
    if (typeof name !== "string" || !name || this.parts.has(name)) throw new HeadError(`${where} needs a name of its own`);
    if (TRANSFORMS.some((key) => key in node)) throw new HeadError(`${where} has a transform; parts are in head coordinates`);
    const primitives = list(this.item("meshes", node.mesh, where).primitives, `${where}.primitives`);
    if (primitives.length !== 1) throw new HeadError(`${where} needs a mesh of exactly one primitive`);
    this.parts.set(name, this.part(name, object(primitives[0], where), where));
  }

  private part(name: string, primitive: Json, where: string): Part {
    const attributes = object(primitive.attributes, `${where}.attributes`);
    const positions = this.accessor(attributes.POSITION, "VEC3", FLOAT, `${where}.POSITION`) as Float32Array;
    const count = positions.length / 3;
    const triangles = Uint32Array.from(this.accessor(primitive.indices, "SCALAR", UNSIGNED, `${where}.indices`));
    if (triangles.length % 3) throw new HeadError(`${where}.indices are no triangles`);
    below(triangles, count, `${where}.indices`);
    return {
      name,
      positions,
      normals: this.attribute(attributes.NORMAL, "VEC3", count, `${where}.NORMAL`),
      uvs: this.attribute(attributes.TEXCOORD_0, "VEC2", count, `${where}.TEXCOORD_0`),
      triangles,
      material: this.material(primitive.material, where),
    };
  }

  private attribute(index: unknown, kind: string, count: number, where: string): Float32Array {
    if (index === undefined) return new Float32Array(count * WIDTHS[kind]);
    const values = this.accessor(index, kind, FLOAT, where) as Float32Array;
    return sized(values, count * WIDTHS[kind], where);
  }

  private fat(row: Json, where: string): FatEntry {
    const part = this.named(row.part, where);
    const knots = numbers(row.knots, `${where}.knots`);
    if (!knots.length || knots.some((k, i) => Math.abs(k) < KNOT_GAP || (i > 0 && k - knots[i - 1] < KNOT_GAP))) {
      throw new HeadError(`${where}: knots ${knots.join(", ")} must ascend, ${KNOT_GAP} apart, and leave out 0`);
    }
    const indices = Uint32Array.from(this.accessor(row.indices, "SCALAR", UNSIGNED, `${where}.indices`));
    below(indices, part.positions.length / 3, `${where}.indices`);
    const deltas = this.accessor(row.deltas, "VEC3", [5122], `${where}.deltas`) as Int16Array;
    sized(deltas, knots.length * indices.length * 3, `${where}.deltas`);
    return { drive: drive(row, where), part: part.name, knots, indices, deltas, scale: positive(row.scale, where) };
  }

  private turn(row: Json, where: string): Turn {
    const faps = list(row.faps, `${where}.faps`).map((fap) => fapNumber(fap, `${where}.faps`));
    const axes = list(row.axes, `${where}.axes`).map((axis) => point(axis, `${where}.axes`));
    if (axes.length !== faps.length || axes.some((axis) => axis.every((x) => x === 0))) {
      throw new HeadError(`${where} needs one axis that is not zero for each FAP`);
    }
    const parts = row.parts === "*" ? null : list(row.parts, `${where}.parts`).map((name) => this.named(name, where).name);
    const weights = Object.entries(object(row.weights ?? {}, `${where}.weights`)).map(
      ([name, index]) => [name, this.weights(this.named(name, where), index, where)] as const);
    return { faps, axes, parts, pivot: point(row.pivot, `${where}.pivot`), weights: new Map(weights) };
  }

  private weights(part: Part, index: unknown, where: string): Float32Array {
    const values = this.accessor(index, "SCALAR", [5126, 5121], `${where}.weights`);
    sized(values, part.positions.length / 3, `${where}.weights`);
    return values instanceof Float32Array ? values : Float32Array.from(values, (w) => w / 255);
  }

  private named(name: unknown, where: string): Part {
    const part = this.parts.get(name as string);
    if (!part) throw new HeadError(`${where}: there is no part ${JSON.stringify(name)}`);
    return part;
  }
}

/** [FAP, coefficient] pairs of a table's `fap` or `drive`. */
function drive(row: Json, where: string): FatEntry["drive"] {
  if (row.drive === undefined) return [[fapNumber(row.fap, where), 1]];
  const pairs = Object.entries(object(row.drive, `${where}.drive`));
  if (!pairs.length) throw new HeadError(`${where}.drive names no FAP`);
  return pairs.map(([fap, coefficient]) => [fapNumber(Number(fap), where), number(coefficient, `${where}.drive`)]);
}

/** A low-level FAP. */
function fapNumber(value: unknown, where: string): number {
  return natural(value, where, 68, 3);
}

function sizeOf(value: unknown): [number, number] {
  const [width, height] = numbers(value, "mouth.size", 2);
  return [positive(width, "mouth.size"), positive(height, "mouth.size")];
}
