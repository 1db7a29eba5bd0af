/** What fapstream exports, and avatars that others make, in three's own reader, which knows nothing of FAPs. */

import { readFileSync } from "node:fs";
import { AnimationMixer, Mesh, Vector3, type AnimationClip, type Group } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { describe, expect, it } from "vitest";
import { readAnyHead } from "../../src/head/foreign";

const vectors = (name: string) => new URL(`../../../../protocol/vectors/${name}`, import.meta.url);

function load(url: URL): Promise<{ scene: Group; animations: AnimationClip[] }> {
  const data = new Uint8Array(readFileSync(url)).buffer;
  return new Promise((resolve, reject) => new GLTFLoader().parse(data, "", resolve, reject));
}

/** Where vertex `v` is now, morphed and skinned. */
function place(mesh: Mesh, v: number): Vector3 {
  return mesh.getVertexPosition(v, new Vector3()).applyMatrix4(mesh.matrixWorld);
}

describe("protocol/vectors/deform/talk.glb", () => {
  interface Case { name: string; positions: Record<string, number[][]> }
  const { cases } = JSON.parse(readFileSync(vectors("deform/small.json"), "utf-8")) as { cases: Case[] };
  const loaded = load(vectors("deform/talk.glb"));

  it.each(cases.map((row, second) => [row.name, second, row] as const))("%s", async (_, second, { positions }) => {
    const { scene, animations } = await loaded;
    const mixer = new AnimationMixer(scene);
    mixer.clipAction(animations[0]).play();
    mixer.setTime(second === cases.length - 1 ? second - 1e-7 : second);
    scene.updateMatrixWorld(true);
    for (const [name, points] of Object.entries(positions)) {
      const mesh = scene.getObjectByName(name) as Mesh;
      points.forEach(([x, y, z], v) => expect(place(mesh, v).distanceTo(new Vector3(x, y, z))).toBeLessThan(1e-6));
    }
  });

  it("names its targets after the FAPs", async () => {
    const { scene } = await loaded;
    expect((scene.getObjectByName("skin") as Mesh).morphTargetDictionary).toMatchObject({ "open_jaw@100": 0, "open_jaw@200": 1 });
  });
});

describe("protocol/vectors/foreign/avatar.glb", () => {
  it("stands where three puts it, up to the shift to the top of the spine", async () => {
    const url = vectors("foreign/avatar.glb");
    const { scene } = await load(url);
    const { head } = readAnyHead(new Uint8Array(readFileSync(url)), "avatar");
    scene.updateMatrixWorld(true);
    const shift = scene.getObjectByName("Head")!.getWorldPosition(new Vector3());
    const meshes: Mesh[] = [];
    scene.traverse((thing) => thing instanceof Mesh && meshes.push(thing));
    const there = meshes.flatMap((mesh) => Array.from({ length: mesh.geometry.attributes.position.count }, (_, v) => place(mesh, v).sub(shift)));
    for (const { positions } of head.parts) {
      for (let i = 0; i < positions.length; i += 3 * 97) {
        const [x, y, z] = positions.subarray(i, i + 3);
        expect(Math.min(...there.map((p) => Math.hypot(p.x - x, p.y - y, p.z - z)))).toBeLessThan(2e-6);
      }
    }
  });
});
