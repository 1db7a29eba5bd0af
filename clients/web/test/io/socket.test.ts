import { expect, it } from "vitest";
import { backoff } from "../../src/io/socket";

it("waits longer after each failure, up to a limit, never the same for all", () => {
  const waits = [0, 1, 2, 3, 4, 5, 50, 5000].map((attempt) => backoff(attempt, 0.999));
  expect(waits).toEqual([...waits].sort((a, b) => a - b));
  expect(waits[0]).toBeLessThanOrEqual(500);
  expect(waits.at(-1)).toBeLessThanOrEqual(10_000);
  expect(backoff(3, 0)).toBeLessThan(backoff(3, 0.9));
  expect(backoff(0, 0)).toBeGreaterThan(100);
});
