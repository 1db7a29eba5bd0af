/** glTF 2.0 documents in GLB containers, with bounds on everything. Throws HeadError and nothing else. */

import { HeadError, type Material, type Picture, type Point } from "./model";
import { pictureSize } from "./picture";

export type Json = Record<string, unknown>;
export type Numbers = Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array | Float32Array;

const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const MAX_FILE = 64 << 20;
const MAX_JSON = 8 << 20;
/** Numbers of all accessors together, as often as they are used. */
const MAX_NUMBERS = 1 << 25;
/** Pixels along a side of a picture, and of the pictures of all materials together. */
const MAX_PICTURE = 4096;
const MAX_PIXELS = 1 << 26;
/** Of a float: far beyond any scene, and its square is still one. */
export const MAX_SIZE = 1e8;
export const WIDTHS: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
const TYPES: Record<number, { new (data: ArrayBuffer): Numbers; BYTES_PER_ELEMENT: number }> = {
  5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array,
};
export const UNSIGNED = [5121, 5123, 5125];
export const FLOAT = [5126];

export function splitGlb(data: Uint8Array): { document: Json; binary: Uint8Array } {
  if (data.length > MAX_FILE) throw new HeadError(`${data.length} bytes; a head has at most ${MAX_FILE}`);
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (data.length < 20 || view.getUint32(0, true) !== 0x46546c67) throw new HeadError("not a GLB file");
  if (view.getUint32(4, true) !== 2 || view.getUint32(8, true) !== data.length) {
    throw new HeadError(`GLB header says version ${view.getUint32(4, true)}, ${view.getUint32(8, true)} bytes; there are ${data.length}`);
  }
  const chunks = new Map<number, Uint8Array>();
  for (let at = 12; at + 8 <= data.length; ) {
    const [size, kind] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    if (at + 8 + size > data.length) throw new HeadError(`the chunk at byte ${at} runs past the end of the file`);
    if (!chunks.has(kind)) chunks.set(kind, data.subarray(at + 8, at + 8 + size));
    at += 8 + size;
  }
  const json = chunks.get(JSON_CHUNK);
  if (!json || json.length > MAX_JSON) throw new HeadError(`JSON chunk: missing, or more than ${MAX_JSON} bytes`);
  try {
    return { document: object(JSON.parse(new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(json)), "JSON"), binary: chunks.get(BINARY_CHUNK) ?? new Uint8Array() };
  } catch (e) {
    throw e instanceof HeadError ? e : new HeadError(`JSON chunk: ${(e as Error).message}`);
  }
}

/** One document being read; every check says where it stopped. */
export class Document {
  private numbersLeft = MAX_NUMBERS;
  private pixelsLeft = MAX_PIXELS;
  private readonly materials = new Map<unknown, Material>();

  constructor(protected readonly document: Json, private readonly binary: Uint8Array) {
    if (object(document.asset, "asset").version !== "2.0") throw new HeadError("asset.version is not 2.0");
  }

  /** The material of that number: parts that name the same one share one object. */
  protected material(index: unknown, where: string): Material {
    const material = this.materials.get(index) ?? this.readMaterial(index, where);
    this.materials.set(index, material);
    return material;
  }

  private readMaterial(index: unknown, where: string): Material {
    const row = index === undefined ? {} : this.item("materials", index, where);
    const pbr = object(row.pbrMetallicRoughness ?? {}, `${where}.pbrMetallicRoughness`);
    return {
      name: String(row.name ?? ""),
      color: numbers(pbr.baseColorFactor ?? [1, 1, 1, 1], `${where}.baseColorFactor`, 4) as Material["color"],
      texture: this.image(pbr.baseColorTexture, where),
      normal: this.image(row.normalTexture, where),
      normalRepeat: this.repeat(row.normalTexture, where),
      roughness: number(pbr.roughnessFactor ?? 1, `${where}.roughnessFactor`),
      metallic: number(pbr.metallicFactor ?? (index === undefined ? 0 : 1), `${where}.metallicFactor`),
      alpha: alphaOf(row.alphaMode ?? "OPAQUE", where),
      cutoff: number(row.alphaCutoff ?? 0.5, `${where}.alphaCutoff`),
      doubleSided: row.doubleSided === true,
    };
  }

  protected image(reference: unknown, where: string): Picture | null {
    if (reference === undefined) return null;
    const texture = this.item("textures", object(reference, where).index, where);
    const image = this.item("images", texture.source, where);
    if (image.bufferView === undefined) throw new HeadError(`${where}: its image is not embedded in the binary chunk`);
    const data = this.view(image.bufferView, where).slice();
    const size = pictureSize(data);
    if (!size) throw new HeadError(`${where}: its image is no PNG, JPEG or WebP`);
    const [width, height] = size;
    this.pixelsLeft -= width * height;
    if (Math.max(width, height) > MAX_PICTURE || this.pixelsLeft < 0) {
      throw new HeadError(`${where}: its image has ${width} x ${height} pixels; ${MAX_PICTURE} a side are the limit`);
    }
    return { data, mime: String(image.mimeType ?? "") };
  }

  /** How often a picture lies along u and v: KHR_texture_transform's scale. */
  protected repeat(reference: unknown, where: string): number {
    const { extensions } = (reference ?? {}) as { extensions?: { KHR_texture_transform?: { scale?: unknown } } };
    return positive(numbers(extensions?.KHR_texture_transform?.scale ?? [1, 1], where, 2)[0], where);
  }

  /** A copy of the accessor's numbers; sparse and interleaved ones too. `count`: how many there have to be. */
  protected accessor(index: unknown, kind: string, types: number[], where: string, count?: number): Numbers {
    const row = this.item("accessors", index, where);
    const type = TYPES[row.componentType as number];
    if (row.type !== kind || !types.includes(row.componentType as number) || !type) {
      throw new HeadError(`${where}: accessor is no ${kind} of a type that fits`);
    }
    const n = natural(row.count, where);
    const width = WIDTHS[kind];
    if (count !== undefined && n !== count) throw new HeadError(`${where} has ${n} values for ${count} vertices`);
    this.numbersLeft -= n * width;
    if (this.numbersLeft < 0) throw new HeadError(`${where}: the accessors together have more than ${MAX_NUMBERS} numbers`);
    if (row.bufferView === undefined && (row.sparse === undefined || count === undefined)) throw new HeadError(`${where}: no buffer view`);
    const values = row.bufferView === undefined
      ? new type(new ArrayBuffer(n * width * type.BYTES_PER_ELEMENT))
      : this.rows(row, row.componentType as number, n, width, where);
    if (row.sparse !== undefined) this.scatter(values, object(row.sparse, where), row.componentType as number, width, where);
    if (values instanceof Float32Array && !bounded(values)) throw new HeadError(`${where} has values that are not finite or beyond ${MAX_SIZE}`);
    return values;
  }

  private scatter(values: Numbers, sparse: Json, component: number, width: number, where: string): void {
    const [at, to] = [object(sparse.indices, where), object(sparse.values, where)];
    const n = natural(sparse.count, where);
    if (!UNSIGNED.includes(at.componentType as number) || n * width > values.length) throw new HeadError(`${where}.sparse`);
    const indices = this.rows(at, at.componentType as number, n, 1, where);
    const rows = this.rows(to, component, n, width, where);
    below(indices, values.length / width, `${where}.sparse`);
    for (let i = 0; i < n; i++) values.set(rows.subarray(i * width, (i + 1) * width), indices[i] * width);
  }

  /** `n` rows of the buffer view that `at` names, from its `byteOffset` on, at the view's stride. */
  private rows(at: Json, component: number, n: number, width: number, where: string): Numbers {
    const { bufferView: view, byteOffset: offset } = at;
    const type = TYPES[component];
    const packed = width * type.BYTES_PER_ELEMENT;
    const stride = natural(this.item("bufferViews", view, where).byteStride ?? packed, where);
    const data = this.view(view, where);
    const start = natural(offset ?? 0, where);
    if (stride < packed || start + (n - 1) * stride + packed > data.length) throw new HeadError(`${where} ends outside its buffer view`);
    if (stride === packed) return new type(data.slice(start, start + n * packed).buffer);
    const out = new Uint8Array(n * packed);
    for (let i = 0; i < n; i++) out.set(data.subarray(start + i * stride, start + i * stride + packed), i * packed);
    return new type(out.buffer);
  }

  private view(index: unknown, where: string): Uint8Array<ArrayBuffer> {
    const row = this.item("bufferViews", index, where);
    const start = natural(row.byteOffset ?? 0, where);
    const end = start + natural(row.byteLength, where);
    if (row.buffer !== 0 || row.extensions || end > this.binary.length) throw new HeadError(`${where}: buffer view`);
    return new Uint8Array(this.binary.buffer as ArrayBuffer, this.binary.byteOffset + start, end - start);
  }

  protected item(table: string, index: unknown, where: string): Json {
    const rows = this.document[table];
    const row = Array.isArray(rows) && Number.isInteger(index) ? (rows[index as number] as unknown) : undefined;
    return object(row, `${where}: ${table}[${String(index)}]`);
  }
}

function bounded(values: Float32Array): boolean {
  for (let i = 0; i < values.length; i++) if (!(Math.abs(values[i]) <= MAX_SIZE)) return false;
  return true;
}

function alphaOf(mode: unknown, where: string): Material["alpha"] {
  if (mode !== "OPAQUE" && mode !== "MASK" && mode !== "BLEND") throw new HeadError(`${where}: alphaMode is ${String(mode)}`);
  return mode;
}

export function object(value: unknown, where: string): Json {
  if (!value || typeof value !== "object" || Array.isArray(value)) throw new HeadError(`${where} is missing or no object`);
  return value as Json;
}

export function list(value: unknown, where: string): unknown[] {
  if (!Array.isArray(value)) throw new HeadError(`${where} is no list`);
  return value;
}

export function number(value: unknown, where: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new HeadError(`${where}: a number is missing`);
  return value;
}

/** A whole number from `least` to `most`. */
export function natural(value: unknown, where: string, most = 2 ** 31, least = 0): number {
  if (!Number.isInteger(value) || (value as number) < least || (value as number) > most) {
    throw new HeadError(`${where}: ${String(value)} is no whole number from ${least} to ${most}`);
  }
  return value as number;
}

export function positive(value: unknown, where: string): number {
  if (number(value, where) <= 0) throw new HeadError(`${where} is not positive`);
  return value as number;
}

export function numbers(value: unknown, where: string, count?: number): number[] {
  const items = list(value, where).map((item) => number(item, where));
  if (count !== undefined && items.length !== count) throw new HeadError(`${where} needs ${count} numbers`);
  return items;
}

export function point(value: unknown, where: string): Point {
  return numbers(value, where, 3) as Point;
}

export function sized<T extends Numbers>(values: T, length: number, where: string): T {
  if (values.length !== length) throw new HeadError(`${where} has ${values.length} values, not ${length}`);
  return values;
}

export function below(indices: Numbers, count: number, where: string): void {
  for (const index of indices) if (index >= count) throw new HeadError(`${where}: there are only ${count} vertices`);
}
