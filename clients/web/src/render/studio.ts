/** Materials of the shared look (fapstream/assets/look/head.frag) for three.js. */

import {
  DoubleSide, FrontSide, GLSL3, Matrix4, RawShaderMaterial, Vector3, Vector4, type IUniform, type Side, type Texture,
} from "three";
import fragmentShader from "../../../../fapstream/assets/look/head.frag?raw";
import vertexShader from "../../../../fapstream/assets/look/head.vert?raw";
import shadowFragment from "../../../../fapstream/assets/look/shadow.frag?raw";
import shadowVertex from "../../../../fapstream/assets/look/shadow.vert?raw";
import type { Head, Material, Part, Point } from "../head/model";
import { definesFor } from "./look";

/** What all materials of one head have in common; the values change while they are shown. */
export interface Shared {
  /** Undoes the turn of the head. */
  rest: IUniform<Matrix4>;
  /** Head space to the clip space of the key light. */
  shadowMatrix: IUniform<Matrix4>;
  shadowMap: IUniform<Texture | null>;
}

/** The pictures of a material, as far as it has them. */
export interface Pictures {
  map: Texture | null;
  normal: Texture | null;
}

export function newShared(): Shared {
  return { rest: { value: new Matrix4() }, shadowMatrix: { value: new Matrix4() }, shadowMap: { value: null } };
}

/** `thrifty` leaves out what is hardly seen, for processors that have to draw. */
export function materialFor(part: Part, head: Head, { map, normal }: Pictures, shared: Shared, thrifty = false): RawShaderMaterial {
  const { material } = part;
  const defines = definesFor(part.name);
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    defines: {
      ...defines,
      SHADOW: 1,
      ...(map && { HAS_MAP: 1 }),
      ...(normal && { HAS_NORMAL: 1 }),
      ...(thrifty && { THRIFTY: 1 }),
      ...cutoffOf(material),
    },
    uniforms: {
      ...shared,
      map: { value: map },
      normalMap: { value: normal },
      normalRepeat: { value: material.normalRepeat },
      tint: { value: new Vector4(...material.color) },
      roughness: { value: material.roughness },
      anchor: { value: new Vector3(...("EYE" in defines ? centre(part.positions) : head.mouth.center)) },
    },
    transparent: material.alpha === "BLEND",
    depthWrite: material.alpha !== "BLEND",
    side: sideOf(material),
  });
}

/** Depth and nothing else, as the key light sees it. */
export function shadowMaterialFor({ material }: Part, map: Texture | null, { shadowMatrix }: Shared): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: shadowVertex,
    fragmentShader: shadowFragment,
    defines: map ? cutoffOf(material) : {},
    uniforms: { shadowMatrix, map: { value: map } },
    colorWrite: false,
    side: sideOf(material),
  });
}

function cutoffOf({ alpha, cutoff }: Material): Record<string, string> {
  return alpha === "MASK" ? { CUTOFF: cutoff.toFixed(3) } : {};
}

function sideOf({ doubleSided }: Material): Side {
  return doubleSided ? DoubleSide : FrontSide;
}

/** The middle of the box round `positions` (3n,). */
function centre(positions: Float32Array): Point {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return low.map((x, k) => (x + high[k]) / 2) as Point;
}
