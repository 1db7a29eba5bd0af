/** Head files: GLB (glTF 2.0) bytes to a Head, as protocol/HEAD.md defines them. Throws HeadError and nothing else. */

import { HeadError, type FatEntry, type Head, type Material, type Part, type Point, type Turn } from "./model";

type Json = Record<string, unknown>;
type Numbers = Uint8Array | Int16Array | Uint16Array | Uint32Array | Float32Array;

const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const WIDTHS: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3 };
const REQUIRED_PARTS = ["skin", "eye_l", "eye_r", "teeth_upper", "teeth_lower", "tongue"];
const TYPES: Record<number, { new (data: ArrayBuffer): Numbers; BYTES_PER_ELEMENT: number }> = {
  5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array,
};
const UNSIGNED = [5121, 5123, 5125];
const FLOAT = [5126];

export function readHead(data: Uint8Array): Head {
  const { document, binary } = splitGlb(data);
  return new Reader(document, binary).head();
}

function splitGlb(data: Uint8Array): { document: Json; binary: Uint8Array } {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (data.length < 20 || view.getUint32(0, true) !== 0x46546c67) throw new HeadError("not a GLB file");
  if (view.getUint32(4, true) !== 2 || view.getUint32(8, true) !== data.length) throw new HeadError("GLB header");
  const chunks = new Map<number, Uint8Array>();
  for (let at = 12; at + 8 <= data.length; ) {
    const [size, kind] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    if (at + 8 + size > data.length) throw new HeadError(`the chunk at byte ${at} runs past the end of the file`);
    if (!chunks.has(kind)) chunks.set(kind, data.subarray(at + 8, at + 8 + size));
    at += 8 + size;
  }
  const json = chunks.get(JSON_CHUNK);
  if (!json) throw new HeadError("no JSON chunk");
  try {
    return { document: object(JSON.parse(new TextDecoder().decode(json)), "JSON"), binary: chunks.get(BINARY_CHUNK) ?? new Uint8Array() };
  } catch (e) {
    throw e instanceof HeadError ? e : new HeadError(`JSON chunk: ${(e as Error).message}`);
  }
}

/** One document being read; every check says where it stopped. */
class Reader {
  private parts = new Map<string, Part>();

  constructor(private readonly document: Json, private readonly binary: Uint8Array) {}

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
      mouth: { center: point(mouth.center, "mouth.center"), size: numbers(mouth.size, "mouth.size", 2) as [number, number] },
      camera: { target: point(camera.target, "camera.target"), height: positive(camera.height, "camera.height") },
      fat: list(extras.fat, "fat").map((row, i) => this.fat(object(row, `fat[${i}]`), `fat[${i}]`)),
      turns: list(extras.turns, "turns").map((row, i) => this.turn(object(row, `turns[${i}]`), `turns[${i}]`)),
    };
  }

  private node(node: Json, where: string): void {
    if (node.mesh === undefined) return;
    const { name } = node;
    if (typeof name !== "string" || !name || this.parts.has(name)) throw new HeadError(`${where} needs a name of its own`);
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

  private material(index: unknown, where: string): Material {
    const row = index === undefined ? {} : this.item("materials", index, where);
    const pbr = object(row.pbrMetallicRoughness ?? {}, `${where}.pbrMetallicRoughness`);
    return {
      name: String(row.name ?? ""),
      color: numbers(pbr.baseColorFactor ?? [1, 1, 1, 1], `${where}.baseColorFactor`, 4) as Material["color"],
      texture: this.image(pbr.baseColorTexture, where),
      roughness: number(pbr.roughnessFactor ?? 1, `${where}.roughnessFactor`),
      metallic: number(pbr.metallicFactor ?? (index === undefined ? 0 : 1), `${where}.metallicFactor`),
      alpha: (row.alphaMode ?? "OPAQUE") as Material["alpha"],
      cutoff: number(row.alphaCutoff ?? 0.5, `${where}.alphaCutoff`),
      doubleSided: row.doubleSided === true,
    };
  }

  private image(reference: unknown, where: string): Material["texture"] {
    if (reference === undefined) return null;
    const texture = this.item("textures", object(reference, where).index, where);
    const image = this.item("images", texture.source, where);
    return { data: this.view(image.bufferView, where), mime: String(image.mimeType ?? "") };
  }

  private fat(row: Json, where: string): FatEntry {
    const part = this.named(row.part, where);
    const knots = numbers(row.knots, `${where}.knots`);
    if (!knots.length || knots.some((k, i) => k === 0 || (i > 0 && k <= knots[i - 1]))) {
      throw new HeadError(`${where}: knots ${knots.join(", ")} must ascend and leave out 0`);
    }
    const indices = Uint32Array.from(this.accessor(row.indices, "SCALAR", UNSIGNED, `${where}.indices`));
    below(indices, part.positions.length / 3, `${where}.indices`);
    const deltas = this.accessor(row.deltas, "VEC3", [5122], `${where}.deltas`) as Int16Array;
    sized(deltas, knots.length * indices.length * 3, `${where}.deltas`);
    return { fap: number(row.fap, where), part: part.name, knots, indices, deltas, scale: positive(row.scale, where) };
  }

  private turn(row: Json, where: string): Turn {
    const faps = numbers(row.faps, `${where}.faps`);
    const axes = list(row.axes, `${where}.axes`).map((axis) => point(axis, `${where}.axes`));
    if (axes.length !== faps.length) throw new HeadError(`${where} needs one axis for each FAP`);
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

  /** A copy of the accessor's numbers, which may lie unaligned in the file. */
  private accessor(index: unknown, kind: string, types: number[], where: string): Numbers {
    const row = this.item("accessors", index, where);
    const type = TYPES[row.componentType as number];
    if (row.type !== kind || !types.includes(row.componentType as number) || !type || row.sparse) {
      throw new HeadError(`${where}: accessor is no plain ${kind} of a type that fits`);
    }
    const data = this.view(row.bufferView, where);
    const start = number(row.byteOffset ?? 0, where);
    const size = number(row.count, where) * WIDTHS[kind] * type.BYTES_PER_ELEMENT;
    if (start < 0 || size < 0 || start + size > data.length) throw new HeadError(`${where} ends outside its buffer view`);
    return new type(data.slice(start, start + size).buffer);
  }

  private view(index: unknown, where: string): Uint8Array<ArrayBuffer> {
    const row = this.item("bufferViews", index, where);
    const start = number(row.byteOffset ?? 0, where);
    const end = start + number(row.byteLength, where);
    if (start < 0 || end > this.binary.length || row.byteStride) throw new HeadError(`${where}: buffer view`);
    return new Uint8Array(this.binary.subarray(start, end));
  }

  private item(table: string, index: unknown, where: string): Json {
    const row = (this.document[table] as unknown[] | undefined)?.[index as number];
    return object(row, `${where}: ${table}[${String(index)}]`);
  }

  private named(name: unknown, where: string): Part {
    const part = this.parts.get(name as string);
    if (!part) throw new HeadError(`${where}: there is no part ${JSON.stringify(name)}`);
    return part;
  }
}

function object(value: unknown, where: string): Json {
  if (!value || typeof value !== "object" || Array.isArray(value)) throw new HeadError(`${where} is missing or no object`);
  return value as Json;
}

function list(value: unknown, where: string): unknown[] {
  if (!Array.isArray(value)) throw new HeadError(`${where} is no list`);
  return value;
}

function number(value: unknown, where: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new HeadError(`${where}: a number is missing`);
  return value;
}

function positive(value: unknown, where: string): number {
  if (number(value, where) <= 0) throw new HeadError(`${where} is not positive`);
  return value as number;
}

function numbers(value: unknown, where: string, count?: number): number[] {
  const items = list(value, where).map((item) => number(item, where));
  if (count !== undefined && items.length !== count) throw new HeadError(`${where} needs ${count} numbers`);
  return items;
}

function point(value: unknown, where: string): Point {
  return numbers(value, where, 3) as Point;
}

function sized<T extends Numbers>(values: T, length: number, where: string): T {
  if (values.length !== length) throw new HeadError(`${where} has ${values.length} values, not ${length}`);
  return values;
}

function below(indices: Uint32Array, count: number, where: string): void {
  if (indices.some((index) => index >= count)) throw new HeadError(`${where}: there are only ${count} vertices`);
}
