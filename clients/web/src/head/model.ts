/** What a head is made of: parts, face animation tables and rotations (protocol/HEAD.md). Metres, +y up, +z the gaze. */

export type Point = [number, number, number];

/** Encoded picture, as embedded in the file. */
export interface Picture {
  data: Uint8Array<ArrayBuffer>;
  mime: string;
}

export interface Material {
  name: string;
  /** Linear RGBA. */
  color: [number, number, number, number];
  texture: Picture | null;
  /** Tangent-space normal map (glTF's normalTexture, +y up), repeated `normalRepeat` times along u and v. */
  normal: Picture | null;
  normalRepeat: number;
  roughness: number;
  metallic: number;
  alpha: "OPAQUE" | "MASK" | "BLEND";
  cutoff: number;
  doubleSided: boolean;
}

/** One mesh: positions and normals (3n,), uvs (2n,), triangles (3m,). */
export interface Part {
  name: string;
  positions: Float32Array;
  normals: Float32Array;
  uvs: Float32Array;
  triangles: Uint32Array;
  material: Material;
}

/**
 * How FAPs move `indices` of a part: `deltas` (knots x n x 3), times `scale` metres at each knot; `knots` are
 * values of the drive, the sum of coefficient * FAP.
 */
export interface FatEntry {
  /** [FAP number, coefficient] pairs; mostly one FAP with coefficient 1. */
  drive: [number, number][];
  part: string;
  knots: number[];
  indices: Uint32Array;
  deltas: Int16Array;
  scale: number;
}

/** Rotations about one pivot, R = axes[0] * axes[1] * ..., one FAP (in AU) per axis; `parts` null is every part. */
export interface Turn {
  faps: number[];
  axes: Point[];
  parts: string[] | null;
  pivot: Point;
  /** Weights (n,) by part; a part not named turns fully. */
  weights: Map<string, Float32Array>;
}

export interface Head {
  name: string;
  parts: Part[];
  /** A box round the lips at rest. */
  mouth: { center: Point; size: [number, number] };
  /** The portrait: what to look at, and the height of the framed picture. */
  camera: { target: Point; height: number };
  fat: FatEntry[];
  turns: Turn[];
}

/** A head file that does not follow protocol/HEAD.md; the message says where. */
export class HeadError extends Error {
  constructor(message: string) {
    super(message);
    this.name = "HeadError";
  }
}
