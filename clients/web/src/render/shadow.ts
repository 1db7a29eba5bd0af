/** The key light's view of the head, drawn before each picture: what it does not see lies in shadow. */

import {
  BufferGeometry, Camera, DepthTexture, LessEqualCompare, LinearFilter, Matrix4, Mesh, Scene, UnsignedShortType, Vector3,
  WebGLRenderTarget, type RawShaderMaterial, type Texture, type WebGLRenderer,
} from "three";
import type { Head, Part } from "../head/model";
import { castsShadow, look } from "./look";
import { shadowMaterialFor, type Shared } from "./studio";

export class Shadow {
  private readonly scene = new Scene();
  private readonly camera = new Camera();
  private readonly target: WebGLRenderTarget;

  constructor(private readonly shared: Shared, size: number) {
    const depthTexture = new DepthTexture(size, size, UnsignedShortType);
    depthTexture.compareFunction = LessEqualCompare;
    depthTexture.magFilter = depthTexture.minFilter = LinearFilter;
    this.target = new WebGLRenderTarget(size, size, { depthTexture, generateMipmaps: false });
    shared.shadowMap.value = depthTexture;
  }

  /** Whose shadow falls on what; replaces the head before. */
  aim(head: Head): void {
    this.clear();
    this.shared.shadowMatrix.value.copy(shadowMatrix(head));
  }

  add(part: Part, geometry: BufferGeometry, map: Texture | null): void {
    if (!castsShadow(part.name) || part.material.alpha === "BLEND") return;
    const mesh = new Mesh(litSide(part, geometry), shadowMaterialFor(part, map, this.shared));
    mesh.frustumCulled = false;
    this.scene.add(mesh);
  }

  draw(renderer: WebGLRenderer): void {
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, this.camera);
    renderer.setRenderTarget(null);
  }

  clear(): void {
    for (const mesh of [...this.scene.children] as Mesh<BufferGeometry, RawShaderMaterial>[]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      this.scene.remove(mesh);
    }
  }

  dispose(): void {
    this.clear();
    this.target.dispose();
  }
}

/** How far away from the light, as a cosine, a surface may face and still count: heads turn. */
const FACES_LIGHT = -0.5;

/** The same vertices, and of a closed surface only the triangles that may face the light. */
function litSide(part: Part, geometry: BufferGeometry): BufferGeometry {
  const lit = new BufferGeometry();
  lit.setAttribute("position", geometry.attributes.position).setAttribute("uv", geometry.attributes.uv);
  if (part.material.doubleSided) return lit.setIndex(geometry.index);
  const towards = new Vector3(...look.defines.KEY_FROM).normalize();
  const facing = (v: number) => new Vector3().fromArray(part.normals, 3 * v).dot(towards) > FACES_LIGHT;
  const all = geometry.index!.array;
  const kept: number[] = [];
  for (let t = 0; t < all.length; t += 3) if (facing(all[t])) kept.push(all[t], all[t + 1], all[t + 2]);
  return lit.setIndex(kept);
}

/** Head space to clip space, along the key light, for a sphere of `reach` portrait heights round what the camera looks at. */
export function shadowMatrix({ camera }: Head): Matrix4 {
  const radius = look.shadow.reach * camera.height;
  const towards = new Vector3(...look.defines.KEY_FROM).normalize();
  const side = new Vector3(0, 1, 0).cross(towards).normalize();
  const up = new Vector3().crossVectors(towards, side);
  const target = new Vector3(...camera.target);
  const rows = [side, up, towards.clone().negate()].flatMap((axis) => [axis.x, axis.y, axis.z, -axis.dot(target)].map((x) => x / radius));
  return new Matrix4().set(...(rows.concat(0, 0, 0, 1) as Parameters<Matrix4["set"]>));
}
