/**
 * Normals of a part whose vertices move. Only the neighbourhood of vertices that can move is computed
 * again; what comes out is the file's own normal plus what the movement changed, so nothing jumps
 * at the border or at rest. Vertices split for texture seams keep one normal.
 */

import type { Part } from "./model";

/** Split vertices share a normal if their normals at rest differ by less than this angle's cosine. */
const SAME_SURFACE = 0.7;

export class NormalField {
  /** Normals at rest, unit length (3n,). */
  readonly rest: Float32Array;
  /** Vertices to compute, and the triangles round them as corner groups. */
  private readonly vertices: Uint32Array;
  private readonly triangles: Uint32Array;
  private readonly group: Uint32Array;
  private readonly sums: Float32Array;
  /** Normals at rest as this file computes them, for `vertices`. */
  private readonly reference: Float32Array;

  constructor(part: Part, movable: Uint32Array[]) {
    const count = part.positions.length / 3;
    this.group = weld(part);
    this.sums = new Float32Array(count * 3);
    const all = this.compute(part.triangles, part.positions, vertexRange(count));
    this.rest = part.normals.some((n) => n !== 0) ? part.normals : all;
    const near = neighbourhood(part.triangles, this.group, movable);
    this.vertices = near.vertices;
    this.triangles = near.triangles;
    this.reference = this.compute(this.triangles, part.positions, this.vertices);
  }

  /** Write the normals of the part at `positions` into `out`. */
  write(positions: Float32Array, out: Float32Array): void {
    out.set(this.rest);
    const now = this.compute(this.triangles, positions, this.vertices);
    for (let i = 0; i < this.vertices.length; i++) {
      const to = this.vertices[i] * 3;
      for (let k = 0; k < 3; k++) out[to + k] += now[3 * i + k] - this.reference[3 * i + k];
    }
  }

  /** Unit normals of `vertices`, summed over `triangles` by area. */
  private compute(triangles: Uint32Array, positions: Float32Array, vertices: Uint32Array): Float32Array {
    const { group, sums } = this;
    sums.fill(0);
    for (let t = 0; t < triangles.length; t += 3) this.addFace(triangles, t, positions);
    const normals = new Float32Array(vertices.length * 3);
    for (let i = 0; i < vertices.length; i++) {
      const from = group[vertices[i]] * 3;
      const [x, y, z] = [sums[from], sums[from + 1], sums[from + 2]];
      const scale = 1 / (Math.sqrt(x * x + y * y + z * z) || 1);
      normals[3 * i] = x * scale;
      normals[3 * i + 1] = y * scale;
      normals[3 * i + 2] = z * scale;
    }
    return normals;
  }

  private addFace(triangles: Uint32Array, t: number, p: Float32Array): void {
    const { group, sums } = this;
    const a = triangles[t] * 3, b = triangles[t + 1] * 3, c = triangles[t + 2] * 3;
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (let k = 0; k < 3; k++) {
      const to = group[triangles[t + k]] * 3;
      sums[to] += nx;
      sums[to + 1] += ny;
      sums[to + 2] += nz;
    }
  }
}

/** For each vertex the first one at the same place on the same surface. */
function weld({ positions, normals }: Part): Uint32Array {
  const group = vertexRange(positions.length / 3);
  const seen = new Map<string, number[]>();
  for (let v = 0; v < group.length; v++) {
    const at = `${positions[3 * v]} ${positions[3 * v + 1]} ${positions[3 * v + 2]}`;
    const here = seen.get(at) ?? [];
    const twin = here.find((other) => alike(normals, v, other));
    if (twin === undefined) seen.set(at, [...here, v]);
    else group[v] = twin;
  }
  return group;
}

/** Do the file's normals, where it has any, allow the two to be one surface? */
function alike(normals: Float32Array, v: number, w: number): boolean {
  let [dot, length] = [0, 0];
  for (let k = 0; k < 3; k++) {
    dot += normals[3 * v + k] * normals[3 * w + k];
    length += normals[3 * v + k] ** 2;
  }
  return length === 0 || dot > SAME_SURFACE;
}

/** Vertices of triangles with a movable corner, and all triangles round those vertices. */
function neighbourhood(triangles: Uint32Array, group: Uint32Array, movable: Uint32Array[]) {
  const grow = (marked: Uint8Array): { corners: Uint8Array; faces: number[] } => {
    const corners = new Uint8Array(group.length);
    const faces: number[] = [];
    for (let t = 0; t < triangles.length; t += 3) {
      const face = [triangles[t], triangles[t + 1], triangles[t + 2]];
      if (!face.some((v) => marked[group[v]])) continue;
      face.forEach((v) => (corners[group[v]] = 1));
      faces.push(...face);
    }
    return { corners, faces };
  };
  const moved = new Uint8Array(group.length);
  for (const indices of movable) indices.forEach((v) => (moved[group[v]] = 1));
  const { corners } = grow(moved);
  return {
    vertices: vertexRange(group.length).filter((v) => corners[group[v]]),
    triangles: Uint32Array.from(grow(corners).faces),
  };
}

function vertexRange(count: number): Uint32Array {
  return Uint32Array.from({ length: count }, (_, v) => v);
}
