/** What the editor talks about: photos, feature points and where they are. Pixels as protocol/ADAPT.md counts them. */

export const VIEWS = ["front", "profile"] as const;
export type ViewName = (typeof VIEWS)[number];
export type Facing = "left" | "right";
export type Position = readonly [x: number, y: number];
export type Size = readonly [width: number, height: number];

/** A point that can be found in photos; `mirror` is the same one on the other side of the face. */
export interface FeaturePoint {
  name: string;
  title: string;
  views: readonly ViewName[];
  mirror?: string;
}

/** A point in a photo. Without a confidence (0 to 1) somebody placed it by hand, and it is sure. */
export interface Mark {
  readonly at: Position;
  readonly confidence?: number;
}

export type Marks = ReadonlyMap<string, Mark>;

/** The nearest place within a photo of `size`. */
export function within([x, y]: Position, [width, height]: Size): Position {
  return [Math.min(width, Math.max(0, x)), Math.min(height, Math.max(0, y))];
}

/** The same points in a photo of another size. */
export function scaled(marks: Marks, from: Size, to: Size): Marks {
  const [sx, sy] = [to[0] / from[0], to[1] / from[1]];
  return new Map([...marks].map(([name, mark]) => [name, { ...mark, at: [mark.at[0] * sx, mark.at[1] * sy] }]));
}
