import { describe, expect, it } from "vitest";
import { castsShadow, definesFor, layerOf, look } from "../../src/render/look";

describe("definesFor", () => {
  it("writes vectors and numbers as GLSL", () => {
    const skin = definesFor("skin");
    expect(skin.SCATTER).toMatch(/^vec3\(0\.\d{5}, 0\.\d{5}, 0\.\d{5}\)$/);
    expect(skin.SHADOW_SOFT).toMatch(/^0\.\d{5}$/);
    expect(skin.SKIN).toBe("1");
  });
  it("takes the first finish whose name starts the part's", () => {
    for (const name of ["teeth_upper", "tongue", "mouth"]) expect(definesFor(name)).toHaveProperty("HOLLOW");
    expect(definesFor("eye_l")).toHaveProperty("EYE");
    expect(definesFor("hair_back")).toHaveProperty("HAIR");
    expect(definesFor("skin")).not.toHaveProperty("HOLLOW");
  });
  it("knows what to do with a part it has never heard of", () => expect(definesFor("hat")).toHaveProperty("SCATTER"));
  it("scatters light in skin furthest in red", () => {
    const [red, green, blue] = definesFor("skin").SCATTER.match(/\d\.\d+/g)!.map(Number);
    expect(red).toBeGreaterThan(green);
    expect(green).toBeGreaterThan(blue);
  });
  it("gives every finish what the shader asks of all", () => {
    for (const { parts } of look.finishes) {
      expect(definesFor(parts[0]), parts[0]).toMatchObject({ SCATTER: expect.any(String), GLOSS: expect.any(String) });
    }
  });
});

describe("layerOf", () => {
  it("draws what hides much first and what may be transparent last", () => {
    const order = ["hair", "shirt", "skin", "teeth_upper"].map((name) => layerOf(name, false));
    expect(order).toEqual([...order].sort((a, b) => a - b));
    expect(layerOf("lashes_l", true)).toBeGreaterThan(layerOf("cornea_l", true));
    expect(layerOf("hair", true)).toBeGreaterThan(layerOf("lashes_l", false));
  });
});

it("lets hair and skin cast shadows, not what is clear", () => {
  expect(["skin", "hair_front", "cornea_l", "lashes_l"].map(castsShadow)).toEqual([true, true, false, false]);
});
