import { describe, expect, it } from "vitest";
import { ProtocolError } from "../../src/protocol/codec";
import { FapDecoder, type Changes } from "../../src/protocol/faps";
import { bytes, vectors } from "../vectors";

interface Step { key?: boolean; mask?: string; faps?: number[]; wide?: number[]; rows?: number[][]; refused?: boolean }
interface Case { name: string; channels: number; steps: Step[] }

describe("protocol/vectors/faps.json", () => {
  it.each(vectors<Case>("faps.json"))("$name", ({ channels, steps }) => {
    const decoder = new FapDecoder(channels);
    for (const { key, mask, faps, wide, rows, refused } of steps) {
      const changes: Changes = {
        ...(key && { key }), ...(mask && { mask: bytes(mask) }),
        ...(faps && { faps: Int16Array.from(faps) }), ...(wide && { wide: Int32Array.from(wide) }),
      };
      if (refused) expect(() => decoder.decode(changes)).toThrow(ProtocolError);
      else expect(decoder.decode(changes).map((row) => [...row])).toEqual(rows);
    }
  });
});
