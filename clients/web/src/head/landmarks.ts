/** Where the eyes, the mouth and the chin of an unknown head are, told by what its shapes move. */

import type { Point } from "./model";
import { EYES, kindOf, SIDES, type Side } from "./rig";
import type { Surface } from "./scene";

export const LIPS = ["mouthPucker", "mouthFunnel", "viseme_U", "viseme_O", "mouthClose"];
export const JAW = ["jawOpen", "mouthOpen", "viseme_aa", "viseme_O", "viseme_E"];
const BLINKS: Record<Side, string> = { l: "eyeBlinkLeft", r: "eyeBlinkRight" };
/** How far the eye's centre lies behind its lids, in eye distances. */
const BEHIND_LIDS = 0.2;
/** How far the top of the spine lies below and behind the eyes' centres, in eye distances (average adult). */
const PIVOT = [0.67, 1.28];

/** In the coordinates of the surfaces. `eyes` are centres of rotation, left first. */
export interface Landmarks {
  eyes: [Point, Point];
  mouth: Point;
  mouthSize: [number, number];
  chin: number;
  top: number;
  pivot: Point;
}

export function distance(a: Point, b: Point): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** `bones`: places of `head`, `leftEye` and `rightEye`, as far as known. */
export function find(surfaces: readonly Surface[], bones: ReadonlyMap<string, Point>): Landmarks {
  const jaw = moving(surfaces, JAW, 0.7);
  const moved = moving(surfaces, LIPS, 0.6);
  const lips = moved.length ? moved : jaw;
  const [low, high] = [0.01, 0.99].map((share) => [0, 1, 2].map((k) => quantile(lips.map((p) => p[k]), share)));
  const width = Math.max(high[0] - low[0], 1e-6);
  const mouth: Point = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2]];
  const guess = (side: number): Point => [mouth[0] + side * 0.6 * width, mouth[1] + 1.35 * width, mouth[2] - 0.5 * width];
  const eyes = eyesOf(surfaces, bones, mouth) ?? [guess(1), guess(-1)];
  const centre = [0, 1, 2].map((k) => (eyes[0][k] + eyes[1][k]) / 2) as Point;
  const apart = distance(...eyes);
  const top = surfaces.reduce((most, { positions }) => highest(most, positions), -Infinity);
  return {
    eyes, mouth, mouthSize: [width, Math.max(high[1] - low[1], 0.2 * width)],
    chin: jaw.length ? Math.min(...jaw.map(([, y]) => y)) : mouth[1] - 0.6 * (centre[1] - mouth[1]),
    top: Math.min(Math.max(top, centre[1] + apart), centre[1] + 4 * apart),
    pivot: bones.get("head") ?? [centre[0], centre[1] - PIVOT[0] * apart, centre[2] - PIVOT[1] * apart],
  };
}

/** The vertices that a shape moves by more than `share` of the most; the first of `shapes` that the head has. */
function moving(surfaces: readonly Surface[], shapes: readonly string[], share: number): Point[] {
  for (const shape of shapes) {
    const rows = surfaces.flatMap(({ positions, moves }) => (moves.has(shape) ? [{ positions, length: lengths(moves.get(shape)!) }] : []));
    const most = rows.reduce((a, { length }) => length.reduce((b, c) => Math.max(b, c), a), 0);
    if (most > 0) return rows.flatMap(({ positions, length }) => points(positions).filter((_, v) => length[v] > share * most));
  }
  return [];
}

/** By bones, by meshes that are eyes, or by the lids; an eye that is not found mirrors the other. */
function eyesOf(surfaces: readonly Surface[], bones: ReadonlyMap<string, Point>, mouth: Point): [Point, Point] | null {
  const balls = surfaces.filter(({ names }) => kindOf(names) === "eye").flatMap(({ positions }) => points(positions));
  const found = SIDES.map((side, i): Point | undefined => {
    const here = (p: Point) => (p[0] - mouth[0]) * (i ? -1 : 1) > 0;
    const bone = bones.get(EYES[side]);
    if (bone) return bone;
    const ball = balls.filter(here);
    if (ball.length) return middle(ball);
    const lids = moving(surfaces, [BLINKS[side], "blink"], 0.5).filter(here);
    if (!lids.length) return undefined;
    const [x, y, z] = middle(lids);
    return [x, y, z - BEHIND_LIDS * 2 * Math.abs(x - mouth[0])];
  });
  const mirror = (p: Point | undefined): Point | undefined => p && [2 * mouth[0] - p[0], p[1], p[2]];
  const left = found[0] ?? mirror(found[1]);
  const right = found[1] ?? mirror(found[0]);
  return left && right && left[0] - right[0] > 1e-6 ? [left, right] : null;
}

function points(values: Float64Array): Point[] {
  return Array.from({ length: values.length / 3 }, (_, v) => [values[3 * v], values[3 * v + 1], values[3 * v + 2]]);
}

function lengths(values: Float64Array): number[] {
  return points(values).map((p) => Math.hypot(...p));
}

function highest(most: number, positions: Float64Array): number {
  for (let i = 1; i < positions.length; i += 3) most = Math.max(most, positions[i]);
  return most;
}

/** The middle of a bounding box. */
function middle(all: readonly Point[]): Point {
  return [0, 1, 2].map((k) => {
    const [low, high] = all.reduce(([a, b], p) => [Math.min(a, p[k]), Math.max(b, p[k])], [Infinity, -Infinity]);
    return (low + high) / 2;
  }) as Point;
}

/** Between the two nearest values, linearly. */
function quantile(values: number[], share: number): number {
  const sorted = values.sort((a, b) => a - b);
  const at = share * (sorted.length - 1);
  const low = Math.floor(at);
  return sorted[low] + (at - low) * (sorted[Math.min(low + 1, sorted.length - 1)] - sorted[low]);
}
