/** The meshes of any glTF scene as they stand at rest: transforms, skins and quantisation worked in. */

import { below, Document, list, MAX_SIZE, natural, number, numbers, object, UNSIGNED, WIDTHS, type Json, type Numbers } from "./document";
import { HeadError, type Material, type Picture } from "./model";

/** 4x4, column by column. */
export type Matrix = number[];

const MAX_NODES = 1 << 12;
const MAX_MESHES = 256;
const MAX_TARGETS = 1024;
const MAX_JOINTS = 1024;
/** Vertices of one primitive. */
const MAX_SURFACE = 1 << 18;
const ANY = [5120, 5121, 5122, 5123, 5126];
const READABLE = ["KHR_mesh_quantization", "KHR_texture_", "KHR_materials_", "VRM", "EXT_texture_webp"];
const SCALE: Record<number, number> = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };
const IDENTITY: Matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export interface Node {
  name: string;
  parent: number;
  world: Matrix;
  mesh: unknown;
  skin: unknown;
}

/**
 * One primitive at rest, in the scene's coordinates. `moves`: displacements (3n,) by shape. Vertex v hangs on the
 * nodes `joints[width * v + k]` with `weights` that sum to 1.
 */
export interface Surface {
  names: string[];
  positions: Float64Array;
  normals: Float64Array;
  uvs: Float64Array;
  triangles: Uint32Array;
  material: Material;
  moves: Map<string, Float64Array>;
  joints: Numbers;
  weights: Float64Array;
  width: number;
}

/** `mesh/target` to the shapes the target is part of, with its strength in each. */
export type Wanted = Map<string, Map<string, number>>;

/** A document read as a scene. Pictures that cannot be read are left out; `notes` says which. */
export class Scene extends Document {
  readonly notes = new Set<string>();
  readonly nodes: Node[];

  constructor({ document, binary }: { document: Json; binary: Uint8Array }) {
    super(document, binary);
    for (const name of list(document.extensionsRequired ?? [], "extensionsRequired")) {
      if (READABLE.some((start) => String(name).startsWith(start))) continue;
      throw new HeadError(`${String(name)} is not read here; export the model without it`);
    }
    this.nodes = this.readNodes();
  }

  extension(name: string): Json | null {
    const row = ((this.document.extensions ?? {}) as Json)[name];
    return row && typeof row === "object" ? (row as Json) : null;
  }

  surfaces(wanted: Wanted): Surface[] {
    const found: Surface[] = [];
    this.nodes.forEach((node, i) => {
      if (node.mesh === undefined) return;
      for (const primitive of this.primitives(node.mesh)) {
        if ((primitive.mode ?? 4) !== 4) this.notes.add("what is not made of triangles is left out");
        else found.push(this.surface(i, node, primitive, wanted));
        if (found.length > MAX_MESHES) throw new HeadError(`there are more than ${MAX_MESHES} primitives`);
      }
    });
    return found;
  }

  /** The morph targets' names by mesh and number; a convention in `extras`. */
  targetNames(): string[][] {
    const meshes = list(this.document.meshes, "meshes").slice(0, MAX_MESHES);
    return meshes.map((mesh, i) => {
      const names: string[] = [];
      for (const owner of [mesh as Json, ...this.primitives(i)]) {
        const given = (owner.extras as { targetNames?: unknown } | null | undefined)?.targetNames;
        if (Array.isArray(given)) names.push(...given.slice(names.length, MAX_TARGETS).map(String));
      }
      return names;
    });
  }

  private primitives(mesh: unknown): Json[] {
    const rows = list(this.item("meshes", mesh, "mesh").primitives, `meshes[${String(mesh)}].primitives`);
    if (rows.length > MAX_MESHES) throw new HeadError(`meshes[${String(mesh)}] has more than ${MAX_MESHES} primitives`);
    return rows.map((row) => object(row, `meshes[${String(mesh)}]`));
  }

  protected override image(reference: unknown, where: string): Picture | null {
    try {
      return super.image(reference, where);
    } catch (e) {
      this.notes.add(`a picture is left out: ${(e as Error).message}`);
      return null;
    }
  }

  protected override repeat(): number {
    return 1;
  }

  private surface(number: number, node: Node, primitive: Json, wanted: Wanted): Surface {
    const where = `meshes[${String(node.mesh)}]`;
    const attributes = object(primitive.attributes, where);
    const positions = this.floats(attributes.POSITION, "VEC3", `${where}.POSITION`);
    const n = positions.length / 3;
    if (n > MAX_SURFACE) throw new HeadError(`${where} has ${n} vertices; ${MAX_SURFACE} are the limit`);
    const optional = (name: string, kind: string) =>
      attributes[name] === undefined ? new Float64Array(n * WIDTHS[kind]) : this.floats(attributes[name], kind, `${where}.${name}`, n);
    const material = this.material(primitive.material, where);
    const mesh = this.item("meshes", node.mesh, where);
    return kept(this.placed(number, attributes, {
      names: [material.name, String(mesh.name ?? ""), node.name],
      positions, normals: optional("NORMAL", "VEC3"), uvs: optional("TEXCOORD_0", "VEC2"),
      triangles: this.triangles(primitive, n, where), material, moves: this.moves(primitive, wanted, node.mesh as number, n),
      joints: new Uint16Array(n).fill(number), weights: new Float64Array(n).fill(1), width: 1,
    }));
  }

  private triangles(primitive: Json, count: number, where: string): Uint32Array {
    const indices = primitive.indices === undefined
      ? Uint32Array.from({ length: count }, (_, v) => v)
      : Uint32Array.from(this.accessor(primitive.indices, "SCALAR", UNSIGNED, `${where}.indices`));
    if (indices.length % 3) throw new HeadError(`${where}.indices are no triangles`);
    below(indices, count, `${where}.indices`);
    return indices;
  }

  private moves(primitive: Json, wanted: Wanted, mesh: number, count: number): Map<string, Float64Array> {
    const moves = new Map<string, Float64Array>();
    const targets = list(primitive.targets ?? [], `meshes[${mesh}].targets`).slice(0, MAX_TARGETS);
    targets.forEach((target, k) => {
      const shapes = wanted.get(`${mesh}/${k}`);
      const { POSITION: index } = object(target, `meshes[${mesh}].targets`);
      if (!shapes || index === undefined) return;
      const move = this.floats(index, "VEC3", `meshes[${mesh}].targets[${k}]`, count);
      for (const [shape, strength] of shapes) {
        const sum = moves.get(shape) ?? new Float64Array(move.length);
        for (let i = 0; i < sum.length; i++) sum[i] += strength * move[i];
        moves.set(shape, sum);
      }
    });
    return moves;
  }

  /** In the scene's coordinates: by the node, or by the joints of its skin (glTF 2.0, 3.7.3.3). */
  private placed(number: number, attributes: Json, surface: Surface): Surface {
    const node = this.nodes[number];
    if (node.skin === undefined) return transformed(surface, Float64Array.from(node.world));
    const where = `skins[${String(node.skin)}]`;
    const skin = this.item("skins", node.skin, where);
    const joints = list(skin.joints, where).map((joint) => natural(joint, where, this.nodes.length - 1));
    if (!joints.length || joints.length > MAX_JOINTS) throw new HeadError(`${where} needs 1 to ${MAX_JOINTS} joints`);
    const bind = skin.inverseBindMatrices === undefined ? null : this.floats(skin.inverseBindMatrices, "MAT4", where);
    if (bind && bind.length < 16 * joints.length) throw new HeadError(`${where} has too few matrices`);
    const matrices = joints.map((joint, k) => multiply(this.nodes[joint].world, bind ? [...bind.subarray(16 * k, 16 * k + 16)] : IDENTITY));
    const { chosen, weights, width } = this.influences(attributes, surface.positions.length / 3, joints.length, where);
    const blend = new Float64Array((16 * weights.length) / width);
    for (let k = 0; k < weights.length; k++) {
      const at = 16 * Math.floor(k / width);
      if (weights[k]) for (let i = 0; i < 16; i++) blend[at + i] += weights[k] * matrices[chosen[k]][i];
    }
    return transformed({ ...surface, joints: chosen.map((k) => joints[k]), weights, width }, blend);
  }

  private influences(attributes: Json, count: number, joints: number, where: string) {
    const sets = [0, 1].filter((k) => attributes[`JOINTS_${k}`] !== undefined);
    if (!sets.length) throw new HeadError(`${where} is used by a mesh without JOINTS_0`);
    const width = 4 * sets.length;
    const chosen = new Uint16Array(count * width);
    const weights = new Float64Array(count * width);
    sets.forEach((k, set) => {
      const numbers = this.accessor(attributes[`JOINTS_${k}`], "VEC4", [5121, 5123], where, count);
      const shares = this.floats(attributes[`WEIGHTS_${k}`], "VEC4", where, count);
      for (let v = 0; v < count; v++) {
        chosen.set(numbers.subarray(4 * v, 4 * v + 4), width * v + 4 * set);
        for (let i = 0; i < 4; i++) weights[width * v + 4 * set + i] = Math.max(shares[4 * v + i], 0);
      }
    });
    below(chosen, joints, where);
    for (let v = 0; v < count; v++) {
      const row = weights.subarray(width * v, width * (v + 1));
      if (row.reduce((a, b) => a + b) <= 1e-9) row[0] = 1;
      const total = row.reduce((a, b) => a + b);
      row.forEach((w, i) => (row[i] = w / total));
    }
    return { chosen, weights, width };
  }

  /** An accessor's numbers, integers normalised where it says so (glTF 2.0, 3.11). */
  private floats(index: unknown, kind: string, where: string, count?: number): Float64Array {
    const values = this.accessor(index, kind, ANY, where, count);
    const row = this.item("accessors", index, where);
    const most = row.normalized === true ? SCALE[row.componentType as number] : undefined;
    const out = Float64Array.from(values);
    if (most) for (let i = 0; i < out.length; i++) out[i] = Math.max(out[i] / most, -1);
    return out;
  }

  /** All nodes with their transforms; a node has one parent at most, and none is its own ancestor. */
  private readNodes(): Node[] {
    const rows = list(this.document.nodes, "nodes").map((row, i) => object(row, `nodes[${i}]`));
    if (rows.length > MAX_NODES) throw new HeadError(`nodes are more than ${MAX_NODES}`);
    const children = rows.map((row, i) => {
      const where = `nodes[${i}].children`;
      return list(row.children ?? [], where).map((child) => natural(child, where, rows.length - 1));
    });
    const parents = new Int32Array(rows.length).fill(-1);
    children.forEach((list, i) => list.forEach((child) => {
      if (parents[child] >= 0) throw new HeadError(`nodes[${child}] is a child of two nodes`);
      parents[child] = i;
    }));
    const worlds: Matrix[] = [];
    const queue = rows.flatMap((_, i) => (parents[i] < 0 ? [i] : []));
    for (const i of queue) {
      const own = local(rows[i], `nodes[${i}]`);
      worlds[i] = parents[i] < 0 ? own : multiply(worlds[parents[i]], own);
      if (!worlds[i].every((x) => Math.abs(x) < 1e9)) throw new HeadError("the transforms of nodes grow without bounds");
      queue.push(...children[i]);
    }
    return rows.map(({ name, mesh, skin }, i) => {
      if (!worlds[i]) throw new HeadError(`nodes[${i}] is its own ancestor`);
      return { name: String(name ?? ""), parent: parents[i], world: worlds[i], mesh, skin };
    });
  }
}

/** How far each vertex hangs on any of `nodes`, 0 to 1. */
export function hanging({ joints, weights, width, positions }: Surface, nodes: ReadonlySet<number>): Float64Array {
  const total = new Float64Array(positions.length / 3);
  for (let k = 0; k < weights.length; k++) if (nodes.has(joints[k])) total[Math.floor(k / width)] += weights[k];
  return total;
}

/** With those triangles only, and without the vertices that none of them uses. */
export function kept(surface: Surface, triangles: Uint32Array = surface.triangles): Surface {
  const count = surface.positions.length / 3;
  const again = new Int32Array(count).fill(-1);
  for (const v of triangles) again[v] = 0;
  const used: number[] = [];
  for (let v = 0; v < count; v++) if (again[v] === 0) again[v] = used.push(v) - 1;
  if (used.length === count) return { ...surface, triangles };
  const pick = <T extends Numbers | Float64Array>(values: T, width: number): T => {
    const out = new (values.constructor as new (length: number) => T)(used.length * width);
    for (let i = 0; i < out.length; i++) out[i] = values[used[Math.floor(i / width)] * width + (i % width)];
    return out;
  };
  return {
    ...surface,
    positions: pick(surface.positions, 3), normals: pick(surface.normals, 3), uvs: pick(surface.uvs, 2),
    triangles: triangles.map((v) => again[v]),
    moves: new Map([...surface.moves].map(([name, move]) => [name, pick(move, 3)])),
    joints: pick(surface.joints, surface.width), weights: pick(surface.weights, surface.width),
  };
}

/** By the transforms of its vertices, or one for all; those of a mirrored mesh turn its triangles round. */
export function transformed(surface: Surface, matrices: Float64Array): Surface {
  const moves = new Map([...surface.moves].map(([name, move]) => [name, linear(move, matrices)]));
  const positions = linear(surface.positions, matrices);
  const step = matrices.length > 16 ? 16 : 0;
  for (let i = 0; i < positions.length; i++) positions[i] += matrices[Math.floor(i / 3) * step + 12 + (i % 3)];
  if (positions.some((x) => !(Math.abs(x) < MAX_SIZE))) throw new HeadError(`a node puts its mesh more than ${MAX_SIZE} away`);
  const { turned, mirrored } = cofactors(matrices);
  const normals = linear(surface.normals, turned);
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.max(Math.sqrt(normals[i] ** 2 + normals[i + 1] ** 2 + normals[i + 2] ** 2), 1e-12);
    for (let k = i; k < i + 3; k++) normals[k] /= length;
  }
  return { ...surface, positions, normals, moves, triangles: mirrored ? surface.triangles.slice().reverse() : surface.triangles };
}

/** Vectors (3n,) times the 3x3 parts of their matrices. */
function linear(values: Float64Array, m: Float64Array): Float64Array {
  const out = new Float64Array(values.length);
  const step = m.length > 16 ? 16 : 0;
  for (let i = 0, at = 0; i < values.length; i += 3, at += step) {
    const x = values[i], y = values[i + 1], z = values[i + 2];
    if (x === 0 && y === 0 && z === 0) continue;
    out[i] = m[at] * x + m[at + 4] * y + m[at + 8] * z;
    out[i + 1] = m[at + 1] * x + m[at + 5] * y + m[at + 9] * z;
    out[i + 2] = m[at + 2] * x + m[at + 6] * y + m[at + 10] * z;
  }
  return out;
}

/** What turns normals: the inverse transposes, times positive numbers; and whether most matrices mirror. */
function cofactors(matrices: Float64Array): { turned: Float64Array; mirrored: boolean } {
  const turned = new Float64Array(matrices.length);
  let mirrored = 0;
  for (let at = 0; at < matrices.length; at += 16) {
    const [a, b, c, , d, e, f, , g, h, k] = matrices.subarray(at, at + 11);
    const rows = [
      e * k - f * h, f * g - d * k, d * h - e * g, 0,
      c * h - b * k, a * k - c * g, b * g - a * h, 0,
      b * f - c * e, c * d - a * f, a * e - b * d,
    ];
    const size = a * rows[0] + b * rows[1] + c * rows[2];
    if (!(Math.abs(size) > 1e-15)) throw new HeadError("a node flattens its mesh to nothing");
    mirrored += Math.sign(size);
    rows.forEach((x, i) => (turned[at + i] = x * Math.sign(size)));
  }
  return { turned, mirrored: mirrored < 0 };
}

function multiply(a: Matrix, b: Matrix): Matrix {
  return a.map((_, at) => {
    const [column, row] = [4 * Math.floor(at / 4), at % 4];
    return a[row] * b[column] + a[row + 4] * b[column + 1] + a[row + 8] * b[column + 2] + a[row + 12] * b[column + 3];
  });
}

function local(node: Json, where: string): Matrix {
  if (node.matrix !== undefined) return numbers(node.matrix, where, 16);
  const [x0, y0, z0, w0] = numbers(node.rotation ?? [0, 0, 0, 1], where, 4);
  const size = number(Math.hypot(x0, y0, z0, w0), where);
  if (size < 1e-9) throw new HeadError(`${where}.rotation is no quaternion`);
  const [x, y, z, w] = [x0 / size, y0 / size, z0 / size, w0 / size];
  const [sx, sy, sz] = numbers(node.scale ?? [1, 1, 1], where, 3);
  const [tx, ty, tz] = numbers(node.translation ?? [0, 0, 0], where, 3);
  return [
    sx * (1 - 2 * (y * y + z * z)), sx * 2 * (x * y + z * w), sx * 2 * (x * z - y * w), 0,
    sy * 2 * (x * y - z * w), sy * (1 - 2 * (x * x + z * z)), sy * 2 * (y * z + x * w), 0,
    sz * 2 * (x * z + y * w), sz * 2 * (y * z - x * w), sz * (1 - 2 * (x * x + y * y)), 0, tx, ty, tz, 1,
  ];
}
