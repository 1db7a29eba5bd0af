/** Puts a head on a canvas: geometry that follows the deformer, textures, camera. Knows nothing of time or turns. */

import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, LinearMipmapLinearFilter, LinearMipmapNearestFilter, Mesh,
  PerspectiveCamera, RepeatWrapping, Scene, Texture, WebGLRenderer, type RawShaderMaterial,
} from "three";
import { Deformer, type Shape } from "../head/deform";
import type { Head, Material, Picture } from "../head/model";
import { ordered } from "../head/order";
import { frame } from "./camera";
import { layerOf, look } from "./look";
import { undoTurn } from "./pose";
import { Shadow } from "./shadow";
import { materialFor, newShared, type Pictures } from "./studio";

/** What a part shows without any picture. */
const BARE: Pictures = { map: null, normal: null };

/** Where the processor has to draw, shadows follow a little late: they are two fifths of the triangles. */
export const SHADOW_EVERY = 4;

export interface StageOptions {
  /** Smooth edges; null where the graphics card does it at no cost worth naming. */
  antialias: boolean | null;
  /** Keep the picture readable after it has been shown. */
  capture: boolean;
}

export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(look.fov, 1, 0.05, 10);
  private readonly shared = newShared();
  private readonly shadow: Shadow;
  private head: Head | null = null;
  private wanted: Head | null = null;
  private deformer: Deformer | null = null;
  /** Leave out what is hardly seen, where the processor has to draw. */
  private readonly thrifty = rendersInSoftware();
  /** Pictures for which one shadow has to do. */
  private readonly shadowEvery: number;
  private pictures = 0;
  private yaw = 0;

  /** Throws if there is no WebGL2. */
  constructor(private readonly canvas: HTMLCanvasElement, { capture, antialias }: StageOptions) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: antialias ?? !this.thrifty, preserveDrawingBuffer: capture });
    this.renderer.setClearColor(0, 0);
    this.shadowEvery = this.thrifty ? SHADOW_EVERY : 1;
    this.shadow = new Shadow(this.shared, this.thrifty ? look.shadow.thriftySize : look.shadow.size);
  }

  /** Show `head`, in place of the one before. */
  async show(head: Head): Promise<void> {
    this.wanted = head;
    const pictures = await loadPictures(head, this.thrifty);
    if (this.wanted !== head) return pictures.forEach(drop);
    this.clear();
    this.head = head;
    this.deformer = new Deformer(head);
    this.pictures = 0;
    this.shadow.aim(head);
    for (const shape of this.deformer.shapes) this.add(shape, head, pictures.get(shape.part.material) ?? BARE);
    this.aim();
  }

  /** `width` and `height` in CSS pixels. */
  resize(width: number, height: number, pixelRatio: number): void {
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.setSize(Math.max(1, width), Math.max(1, height), false);
    this.aim();
  }

  /** Draw the head with the FAPs `values` (69,), seen from `yaw` radians beside. False if there is no head yet. */
  draw(values: ArrayLike<number>, yaw = 0): boolean {
    if (!this.head) return false;
    this.turn(yaw);
    this.pose(values);
    this.render();
    return true;
  }

  /** Put every vertex where the FAPs `values` (69,) want it. */
  pose(values: ArrayLike<number>): void {
    this.deformer!.apply(values);
    for (const mesh of this.scene.children as Mesh[]) {
      mesh.geometry.attributes.position.needsUpdate = true;
      mesh.geometry.attributes.normal.needsUpdate = true;
    }
    undoTurn(this.head!, values, this.shared.rest.value);
  }

  /** Draw what there is. */
  render(): void {
    if (this.pictures++ % this.shadowEvery === 0) this.shadow.draw(this.renderer);
    this.renderer.render(this.scene, this.camera);
  }

  dispose(): void {
    this.clear();
    this.shadow.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private turn(yaw: number): void {
    if (yaw === this.yaw) return;
    this.yaw = yaw;
    this.aim();
  }

  private aim(): void {
    if (!this.head) return;
    const { clientWidth: w, clientHeight: h } = this.canvas;
    this.camera.aspect = w && h ? w / h : 1;
    const { position, target } = frame(this.head.camera, this.camera.fov, this.camera.aspect, this.yaw);
    this.camera.position.set(...position);
    this.camera.lookAt(...target);
    this.camera.updateProjectionMatrix();
  }

  private add(shape: Shape, head: Head, pictures: Pictures): void {
    const { name, material } = shape.part;
    const mesh = new Mesh(geometryOf(shape), materialFor(shape.part, head, pictures, this.shared, this.thrifty));
    mesh.frustumCulled = false;
    mesh.renderOrder = layerOf(name, material.alpha === "BLEND");
    this.scene.add(mesh);
    this.shadow.add(shape.part, mesh.geometry, pictures.map);
  }

  private clear(): void {
    this.shadow.clear();
    for (const mesh of [...this.scene.children] as Mesh<BufferGeometry, RawShaderMaterial>[]) {
      const { map, normalMap } = mesh.material.uniforms;
      drop({ map: map.value as Texture | null, normal: normalMap.value as Texture | null });
      mesh.geometry.dispose();
      mesh.material.dispose();
      this.scene.remove(mesh);
    }
  }
}

function geometryOf({ part, positions, normals }: Shape): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute("uv", new BufferAttribute(part.uvs, 2));
  geometry.setIndex(new BufferAttribute(ordered(part.triangles, positions.length / 3), 1));
  return geometry;
}

function drop({ map, normal }: Pictures): void {
  map?.dispose();
  normal?.dispose();
}

async function loadPictures(head: Head, thrifty: boolean): Promise<Map<Material, Pictures>> {
  const load = async (picture: Picture | null) => picture && (await loadTexture(picture, thrifty));
  const materials = [...new Set(head.parts.map(({ material }) => material))];
  const loaded = materials.map(async (material) => {
    const [map, normal] = await Promise.all([load(material.texture), load(material.normal)]);
    return [material, { map, normal }] as const;
  });
  return new Map(await Promise.all(loaded));
}

async function loadTexture({ data, mime }: Picture, thrifty: boolean): Promise<Texture> {
  const bitmap = await createImageBitmap(new Blob([data], { type: mime }), { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const texture = new Texture(bitmap);
  texture.flipY = false;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.anisotropy = thrifty ? 1 : 4;
  texture.minFilter = thrifty ? LinearMipmapNearestFilter : LinearMipmapLinearFilter;
  texture.needsUpdate = true;
  return texture;
}

let software: boolean | undefined;

/** Where the processor has to draw, smooth edges would cost half of the frames. */
function rendersInSoftware(): boolean {
  if (software === undefined) {
    const gl = "OffscreenCanvas" in globalThis ? new OffscreenCanvas(1, 1).getContext("webgl2") : null;
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    software = /llvmpipe|swiftshader|software|basic render/i.test(String(names && gl?.getParameter(names.UNMASKED_RENDERER_WEBGL)));
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return software;
}
