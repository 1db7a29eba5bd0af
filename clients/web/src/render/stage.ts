/** Puts a head on a canvas: geometry that follows the deformer, textures, camera. Knows nothing of time or turns. */

import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, LinearMipmapLinearFilter, Mesh, NoToneMapping, PerspectiveCamera,
  Scene, SRGBColorSpace, Texture, WebGLRenderer, type ShaderMaterial,
} from "three";
import { Deformer, type Shape } from "../head/deform";
import type { Head, Material } from "../head/model";
import { ordered } from "../head/order";
import { frame } from "./camera";
import { materialFor } from "./studio";

/** What is drawn first hides what lies under it; what is drawn last may be transparent. */
const LAYERS = ["hair", "shirt", "collar", "skin", "", "cornea", "brow", "lash"];

export interface StageOptions {
  /** Smooth edges; null where the graphics card does it at no cost worth naming. */
  antialias: boolean | null;
  /** Keep the picture readable after it has been shown. */
  capture: boolean;
}

export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(20, 1, 0.05, 10);
  private head: Head | null = null;
  private wanted: Head | null = null;
  private deformer: Deformer | null = null;

  /** Throws if there is no WebGL2. */
  constructor(private readonly canvas: HTMLCanvasElement, { capture, antialias }: StageOptions) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: antialias ?? !rendersInSoftware(), preserveDrawingBuffer: capture });
    this.renderer.toneMapping = NoToneMapping;
    this.renderer.outputColorSpace = SRGBColorSpace;
    this.renderer.setClearColor(0, 0);
  }

  /** Show `head`, in place of the one before. */
  async show(head: Head): Promise<void> {
    this.wanted = head;
    const textures = await loadTextures(head, rendersInSoftware() ? 1 : 4);
    if (this.wanted !== head) return textures.forEach((texture) => texture.dispose());
    this.clear();
    this.head = head;
    this.deformer = new Deformer(head);
    for (const shape of this.deformer.shapes) this.scene.add(meshOf(shape, head, textures.get(shape.part.material) ?? null));
    this.aim();
  }

  /** `width` and `height` in CSS pixels. */
  resize(width: number, height: number, pixelRatio: number): void {
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.setSize(Math.max(1, width), Math.max(1, height), false);
    this.aim();
  }

  /** Draw the head with the FAPs `values` (69,). False if there is no head yet. */
  draw(values: ArrayLike<number>): boolean {
    if (!this.deformer) return false;
    this.deformer.apply(values);
    for (const mesh of this.scene.children as Mesh[]) {
      mesh.geometry.attributes.position.needsUpdate = true;
      mesh.geometry.attributes.normal.needsUpdate = true;
    }
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  dispose(): void {
    this.clear();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private aim(): void {
    if (!this.head) return;
    const { clientWidth: w, clientHeight: h } = this.canvas;
    this.camera.aspect = w && h ? w / h : 1;
    const { position, target } = frame(this.head.camera, this.camera.fov, this.camera.aspect);
    this.camera.position.set(...position);
    this.camera.lookAt(...target);
    this.camera.updateProjectionMatrix();
  }

  private clear(): void {
    for (const mesh of [...this.scene.children] as Mesh<BufferGeometry, ShaderMaterial>[]) {
      mesh.geometry.dispose();
      (mesh.material.uniforms.map.value as Texture | null)?.dispose();
      mesh.material.dispose();
      this.scene.remove(mesh);
    }
  }
}

function meshOf({ part, positions, normals }: Shape, head: Head, map: Texture | null): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute("uv", new BufferAttribute(part.uvs, 2));
  geometry.setIndex(new BufferAttribute(ordered(part.triangles, positions.length / 3), 1));
  const mesh = new Mesh(geometry, materialFor(part.name, part.material, head, map, rendersInSoftware()));
  mesh.frustumCulled = false;
  mesh.renderOrder = layerOf(part.name, part.material.alpha === "BLEND");
  return mesh;
}

function layerOf(name: string, transparent: boolean): number {
  const layer = LAYERS.findIndex((start) => start && name.startsWith(start));
  if (transparent) return LAYERS.length + layer;
  return layer < 0 ? LAYERS.indexOf("") : layer;
}

async function loadTextures(head: Head, anisotropy: number): Promise<Map<Material, Texture>> {
  const materials = head.parts.map(({ material }) => material).filter(({ texture }) => texture);
  const loaded = materials.map(async (material) => {
    const { data, mime } = material.texture!;
    const bitmap = await createImageBitmap(new Blob([data], { type: mime }), { colorSpaceConversion: "none", premultiplyAlpha: "none" });
    const texture = new Texture(bitmap);
    texture.flipY = false;
    texture.anisotropy = anisotropy;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.needsUpdate = true;
    return [material, texture] as const;
  });
  return new Map(await Promise.all(loaded));
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
