import { DoubleSide, FrontSide, Texture, type RawShaderMaterial } from "three";
import { describe, expect, it } from "vitest";
import { readHead } from "../../src/head/glb";
import type { Material } from "../../src/head/model";
import { materialFor, newShared, shadowMaterialFor, type Pictures } from "../../src/render/studio";
import { smallHead } from "../glb";

const head = readHead(smallHead());
const skin = head.parts[0];
const eye = head.parts.find(({ name }) => name === "eye_l")!;
const shared = newShared();
const bare: Pictures = { map: null, normal: null };
const part = (change: Partial<Material>) => ({ ...skin, material: { ...skin.material, ...change } });
const made = (change: Partial<Material> = {}, pictures = bare) => materialFor(part(change), head, pictures, shared);

/** Names of the uniforms that a shader declares. */
const declared = (source: string) => [...source.matchAll(/^uniform \w+ (\w+);/gm)].map(([, name]) => name);
const BY_RENDERER = ["viewMatrix", "projectionMatrix", "cameraPosition"];

describe("materialFor", () => {
  it("gives the shader every uniform that it declares", () => {
    const { uniforms, vertexShader, fragmentShader } = made();
    const asked = [...declared(vertexShader), ...declared(fragmentShader)];
    expect(asked).toContain("shadowMap");
    expect(Object.keys(uniforms).sort()).toEqual([...new Set(asked)].filter((name) => !BY_RENDERER.includes(name)).sort());
  });
  it("takes transparency from the file", () => {
    expect(made({ alpha: "BLEND" })).toMatchObject({ transparent: true, depthWrite: false });
    expect(made({ alpha: "MASK", cutoff: 0.4 }).defines?.CUTOFF).toBe("0.400");
    expect(made()).toMatchObject({ transparent: false, depthWrite: true });
    expect(made().defines).not.toHaveProperty("CUTOFF");
  });
  it("shows the back only of what has two sides", () => {
    expect(made({ doubleSided: true }).side).toBe(DoubleSide);
    expect(made({ doubleSided: false }).side).toBe(FrontSide);
  });
  it("uses pictures only if there are some", () => {
    expect(made().defines).not.toHaveProperty("HAS_MAP");
    expect(made().defines).not.toHaveProperty("HAS_NORMAL");
    const both = made({ normalRepeat: 24 }, { map: new Texture(), normal: new Texture() });
    expect(both.defines).toMatchObject({ HAS_MAP: 1, HAS_NORMAL: 1 });
    expect(both.uniforms.normalRepeat.value).toBe(24);
  });
  it("measures shade in the mouth from the mouth, in an eye from the eye", () => {
    const at = (material: RawShaderMaterial) => material.uniforms.anchor.value.toArray() as number[];
    expect(at(made())).toEqual(head.mouth.center);
    const xs = [...eye.positions].filter((_, i) => i % 3 === 0);
    expect(at(materialFor(eye, head, bare, shared))[0]).toBeCloseTo((Math.min(...xs) + Math.max(...xs)) / 2);
  });
  it("is thrifty only where it is told to be", () => {
    expect(made().defines).not.toHaveProperty("THRIFTY");
    expect(materialFor(skin, head, bare, shared, true).defines).toHaveProperty("THRIFTY");
  });
});

describe("shadowMaterialFor", () => {
  it("cuts holes only where there is a picture of them", () => {
    expect(shadowMaterialFor(part({ alpha: "MASK" }), new Texture(), shared).defines).toHaveProperty("CUTOFF");
    expect(shadowMaterialFor(part({ alpha: "MASK" }), null, shared).defines).toEqual({});
    expect(shadowMaterialFor(skin, new Texture(), shared).defines).toEqual({});
  });
});
