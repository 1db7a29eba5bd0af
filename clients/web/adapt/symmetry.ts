/** The two sides of a face seen from in front: the line between them, and what lies opposite. */

import type { Facing, FeaturePoint, Marks, Position } from "./marks";

/** A line through `at` along the unit vector `along`. */
export interface Line {
  at: Position;
  along: Position;
}

/** Points closer together than this share of the face's pairs say nothing of its direction. */
const LEAST_EXTENT = 0.25;

/**
 * The middle of the face: along the points on it, else along the middles of the pairs, else upright through those.
 * Null if there is neither. `without` and its mirror point have no say: they are being moved.
 */
export function midline(marks: Marks, features: readonly FeaturePoint[], without = ""): Line | null {
  const own = features.flatMap(({ name, mirror }): Position[] => (!mirror && marks.has(name) ? [marks.get(name)!.at] : []));
  const pairs = pairsOf(marks, features, without);
  const middles = pairs.map(([a, b]): Position => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
  const width = mean(pairs.map(([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1])));
  const along = direction(own, width) ?? direction(middles, width);
  if (along) return along;
  const rest = middles.length ? middles : own;
  return rest.length ? { at: centre(rest), along: [0, 1] } : null;
}

/** Where the mirror point of one at `at` lies. */
export function opposite({ at: [x, y], along: [dx, dy] }: Line, at: Position): Position {
  const off = (at[0] - x) * dy - (at[1] - y) * dx;
  return [at[0] - 2 * off * dy, at[1] + 2 * off * dx];
}

/** Points that a profile hides: of pairs those on the far side of the nose, as the front photo's `places` tell the sides. */
export function hidden(facing: Facing, features: readonly FeaturePoint[], places: ReadonlyMap<string, Position>): Set<string> {
  const isLeft = (a: string, b: string) => (places.get(a)?.[0] ?? 0) > (places.get(b)?.[0] ?? 0);
  const far = features.filter(({ name, mirror }) => mirror && isLeft(name, mirror) !== (facing === "left"));
  return new Set(far.map(({ name }) => name));
}

function pairsOf(marks: Marks, features: readonly FeaturePoint[], without: string): [Position, Position][] {
  return features.flatMap(({ name, mirror }): [Position, Position][] => {
    if (!mirror || name > mirror || name === without || mirror === without) return [];
    const [a, b] = [marks.get(name), marks.get(mirror)];
    return a && b ? [[a.at, b.at]] : [];
  });
}

/** The line that `points` lie along (least squares across it); null if they do not tell, or lie across the face. */
function direction(points: readonly Position[], width: number): Line | null {
  if (points.length < 2) return null;
  const [cx, cy] = centre(points);
  const [xx, xy, yy] = [0, 1, 2].map((k) => mean(points.map(([x, y]) => (x - cx) ** (2 - k) * (y - cy) ** k)));
  const angle = Math.atan2(2 * xy, xx - yy) / 2;
  const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
  const places = points.map(([x, y]) => (x - cx) * dx + (y - cy) * dy);
  const extent = Math.max(...places) - Math.min(...places);
  if (Math.abs(dx) > Math.abs(dy) || extent <= Math.max(1, LEAST_EXTENT * width)) return null;
  return { at: [cx, cy], along: [dx, dy] };
}

function centre(points: readonly Position[]): Position {
  return [mean(points.map(([x]) => x)), mean(points.map(([, y]) => y))];
}

function mean(values: readonly number[]): number {
  return values.reduce((sum, value) => sum + value, 0) / Math.max(1, values.length);
}
