/** FAP values to vertices, as protocol/HEAD.md defines it: tables, rotations, normals. Plain loops over typed arrays. */

import type { FatEntry, Head, Part, Point, Turn } from "./model";
import { NormalField } from "./normals";

/** Radians per FAP unit of an angle. */
export const AU = 1e-5;

/** One part as it is now; `positions` and `normals` are the same arrays for good. */
export interface Shape {
  part: Part;
  positions: Float32Array;
  normals: Float32Array;
}

/** Row-major 3x3. */
type Matrix = number[];

const IDENTITY: Matrix = [1, 0, 0, 0, 1, 0, 0, 0, 1];

export class Deformer {
  readonly shapes: Shape[];
  private readonly fields: Map<string, NormalField>;
  private readonly byName: Map<string, Shape>;

  constructor(private readonly head: Head) {
    this.fields = new Map(head.parts.map((part) => [part.name, fieldOf(head, part)]));
    this.shapes = head.parts.map((part) => ({
      part,
      positions: part.positions.slice(),
      normals: this.fields.get(part.name)!.rest.slice(),
    }));
    this.byName = new Map(this.shapes.map((shape) => [shape.part.name, shape]));
  }

  /** Put every part where `values` (69,), FAP n at n, want it. */
  apply(values: ArrayLike<number>): void {
    const moved = new Set<string>();
    for (const { part, positions } of this.shapes) positions.set(part.positions);
    for (const entry of this.head.fat) {
      const value = driveValue(entry, values);
      if (!value) continue;
      displace(entry, value, this.byName.get(entry.part)!.positions);
      moved.add(entry.part);
    }
    for (const { part, positions, normals } of this.shapes) {
      const field = this.fields.get(part.name)!;
      if (moved.has(part.name)) field.write(positions, normals);
      else normals.set(field.rest);
    }
    for (const turn of this.head.turns) if (turn.faps.some((fap) => values[fap])) this.turn(turn, values);
  }

  private turn(turn: Turn, values: ArrayLike<number>): void {
    const matrix = rotation(turn, values);
    for (const name of turn.parts ?? this.byName.keys()) {
      const { positions, normals } = this.byName.get(name)!;
      const weights = turn.weights.get(name);
      rotate(positions, matrix, turn.pivot, weights);
      rotate(normals, matrix, [0, 0, 0], weights);
    }
  }
}

function fieldOf(head: Head, part: Part): NormalField {
  const movable = head.fat.filter((entry) => entry.part === part.name).map((entry) => entry.indices);
  return new NormalField(part, movable);
}

/** Where a frame of FAPs stands between the entry's knots. */
function driveValue({ drive }: FatEntry, values: ArrayLike<number>): number {
  let value = 0;
  for (const [fap, coefficient] of drive) value += coefficient * values[fap];
  return value;
}

/** Add what the entry does at one value of its drive to `positions`. */
function displace({ knots, indices, deltas, scale }: FatEntry, value: number, positions: Float32Array): void {
  for (const [knot, weight] of knotShares(knots, value)) {
    const share = weight * scale;
    const row = knot * indices.length * 3;
    for (let i = 0; i < indices.length; i++) {
      const to = indices[i] * 3;
      const from = row + i * 3;
      positions[to] += deltas[from] * share;
      positions[to + 1] += deltas[from + 1] * share;
      positions[to + 2] += deltas[from + 2] * share;
    }
  }
}

/**
 * [knot, weight] of the (at most two) knots that the value of a drive lies between. 0 is a knot too, whose
 * displacement is nothing. Beyond the ends the last segment goes on: weights may leave [0, 1].
 */
export function knotShares(knots: readonly number[], value: number): [number, number][] {
  const points = [...knots, 0].sort((a, b) => a - b);
  let segment = points.findLastIndex((point) => point <= value);
  segment = Math.min(Math.max(segment, 0), points.length - 2);
  const [low, high] = [points[segment], points[segment + 1]];
  const share = (value - low) / (high - low);
  const pairs: [number, number][] = [[knots.indexOf(low), 1 - share], [knots.indexOf(high), share]];
  return pairs.filter(([knot, weight]) => knot >= 0 && weight !== 0);
}

/** The matrix of a turn: axes[0] * axes[1] * ... */
export function rotation({ faps, axes }: Pick<Turn, "faps" | "axes">, values: ArrayLike<number>): Matrix {
  return faps.map((fap, i) => aboutAxis(axes[i], values[fap] * AU)).reduce(multiply, IDENTITY);
}

/** Right-handed rotation about an axis of any length (Rodrigues). */
function aboutAxis(axis: Point, angle: number): Matrix {
  const length = Math.hypot(...axis);
  const [x, y, z] = axis.map((a) => a / length);
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  const t = 1 - c;
  return [
    t * x * x + c, t * x * y - s * z, t * x * z + s * y,
    t * x * y + s * z, t * y * y + c, t * y * z - s * x,
    t * x * z - s * y, t * y * z + s * x, t * z * z + c,
  ];
}

function multiply(a: Matrix, b: Matrix): Matrix {
  return a.map((_, i) => {
    const [row, column] = [i - (i % 3), i % 3];
    return a[row] * b[column] + a[row + 1] * b[column + 3] + a[row + 2] * b[column + 6];
  });
}

/** Move `vectors` (3n,) by weight times what the rotation about `pivot` would move them. */
function rotate(vectors: Float32Array, m: Matrix, [px, py, pz]: Point, weights: Float32Array | undefined): void {
  const [a, b, c, d, e, f, g, h, k] = [m[0] - 1, m[1], m[2], m[3], m[4] - 1, m[5], m[6], m[7], m[8] - 1];
  for (let i = 0, v = 0; i < vectors.length; i += 3, v++) {
    const w = weights ? weights[v] : 1;
    if (w === 0) continue;
    const [x, y, z] = [vectors[i] - px, vectors[i + 1] - py, vectors[i + 2] - pz];
    vectors[i] += w * (a * x + b * y + c * z);
    vectors[i + 1] += w * (d * x + e * y + f * z);
    vectors[i + 2] += w * (g * x + h * y + k * z);
  }
}
