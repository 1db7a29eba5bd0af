import { Texture } from "three";
import { describe, expect, it } from "vitest";
import { readHead } from "../../src/head/glb";
import type { Material } from "../../src/head/model";
import { materialFor } from "../../src/render/studio";
import { smallHead } from "../glb";

const head = readHead(smallHead());
const plain = head.parts[0].material;
const made = (name: string, change: Partial<Material> = {}, map: Texture | null = null) =>
  materialFor(name, { ...plain, ...change }, head, map);

describe("materialFor", () => {
  it("scatters light in skin, more in red than in blue", () => {
    const { x, z } = made("skin").uniforms.scatter.value as { x: number; z: number };
    expect(x).toBeGreaterThan(2 * z);
  });
  it("darkens what lies in the mouth", () => {
    for (const name of ["teeth_upper", "tongue", "mouth"]) expect(made(name).defines).toHaveProperty("HOLLOW");
    expect(made("skin").defines).not.toHaveProperty("HOLLOW");
  });
  it("takes transparency from the file", () => {
    expect(made("lashes_l", { alpha: "BLEND" })).toMatchObject({ transparent: true, depthWrite: false });
    expect(made("hair", { alpha: "MASK", cutoff: 0.4 }).defines?.CUTOFF).toBe("0.400");
    expect(made("hair")).toMatchObject({ transparent: false, depthWrite: true });
  });
  it("uses a texture only if there is one", () => {
    expect(made("eye_l").defines).not.toHaveProperty("HAS_MAP");
    expect(made("eye_l", {}, new Texture()).defines).toHaveProperty("HAS_MAP");
  });
  it("knows what to do with a part it has never heard of", () => expect(made("hat").uniforms.gloss.value).toBeGreaterThan(0));
});
