import { describe, expect, it } from "vitest";
import { ordered } from "../../src/head/order";

/** A grid of n x n quads, its triangles in a scrambled order. */
function grid(n: number): Uint32Array {
  const faces: number[][] = [];
  for (let y = 0; y < n; y++) {
    for (let x = 0; x < n; x++) {
      const a = y * (n + 1) + x;
      faces.push([a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]);
    }
  }
  faces.sort((p, q) => ((p[0] * 7919 + p[1]) % 101) - ((q[0] * 7919 + q[1]) % 101));
  return Uint32Array.from(faces.flat());
}

/** Vertices fetched for each triangle with a cache of 16. */
function missRate(triangles: Uint32Array): number {
  const cache: number[] = [];
  let misses = 0;
  for (const v of triangles) {
    if (cache.includes(v)) continue;
    misses++;
    cache.push(v);
    if (cache.length > 16) cache.shift();
  }
  return (misses * 3) / triangles.length;
}

function faces(triangles: Uint32Array): string[] {
  return Array.from({ length: triangles.length / 3 }, (_, t) => triangles.subarray(3 * t, 3 * t + 3).join(" ")).sort();
}

describe("ordered", () => {
  const before = grid(40);
  const after = ordered(before, 41 * 41);

  it("keeps every triangle and its winding", () => expect(faces(after)).toEqual(faces(before)));
  it("makes the cache work", () => {
    expect(missRate(before)).toBeGreaterThan(2);
    expect(missRate(after)).toBeLessThan(0.85);
  });
  it("copes with loose vertices, islands and nothing", () => {
    expect(faces(ordered(Uint32Array.of(5, 6, 7, 1, 2, 3), 9))).toEqual(["1 2 3", "5 6 7"]);
    expect(ordered(new Uint32Array(), 3)).toHaveLength(0);
  });
});
