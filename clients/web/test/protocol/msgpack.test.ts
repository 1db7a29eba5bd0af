import { Decoder, encode as oracle } from "@msgpack/msgpack";
import { describe, expect, it } from "vitest";
import { Float, pack, unpack, type Plain } from "../../src/protocol/msgpack";

const INTS = [0, 1, 127, 128, 255, 256, 65535, 65536, 2 ** 32 - 1, 2 ** 32, Number.MAX_SAFE_INTEGER];
const STRINGS = [0, 1, 31, 32, 255, 256, 65536].map((n) => "α".repeat(n));
const BINS = [0, 1, 255, 256, 65535, 65536].map((n) => new Uint8Array(n).fill(7));
const LISTS = [0, 15, 16, 300].map((n) => Array.from({ length: n }, (_, i) => i));

describe("against @msgpack/msgpack", () => {
  const values: Plain[] = [...INTS, ...INTS.slice(1).map((n) => -n), -32, -33, ...STRINGS, ...BINS, ...LISTS, null, true, false];

  it.each(values.map((value) => [label(value), value] as const))("%s: same bytes, and back", (_, value) => {
    const bytes = pack(value);
    expect(bytes).toEqual(oracle(value));
    expect(unpack(bytes)).toEqual(value);
  });

  it("agrees on maps", () => {
    const map = new Map<Plain, Plain>(Array.from({ length: 20 }, (_, i) => [`key${i}`, [i, -1 - i]]));
    expect(new Decoder().decode(pack(map))).toEqual(Object.fromEntries(map));
    expect(unpack(pack(map))).toEqual(map);
  });
});

describe("strictness", () => {
  it("tells 1.0 from 1", () => expect(unpack(oracle(1, { forceIntegerToFloat: true }))).toEqual(new Float(1)));
  it("never takes a float for an integer", () => expect(() => pack(1.5)).toThrow(RangeError));
  it.each([1.5, 0, -1e300, Infinity])("writes %d as a float when told to", (value) => {
    expect(pack(new Float(value))).toEqual(oracle(value, { forceIntegerToFloat: true }));
    expect(unpack(pack(new Float(value)))).toEqual(new Float(value));
  });
  it.each([
    ["nothing", []], ["a cut string", [0xa5, 0x61]], ["two values", [1, 2]], ["extension", [0xd4, 1, 1]],
    ["broken UTF-8", [0xa2, 0xc3, 0x28]], ["a surrogate", [0xa3, 0xed, 0xa0, 0x80]], ["byte c1", [0xc1]],
    ["a huge array", [0xdd, 0xff, 0xff, 0xff, 0xff]], ["a huge map", [0xdf, 0xff, 0xff, 0xff, 0xff]],
  ])("refuses %s", (_, data) => expect(() => unpack(Uint8Array.from(data))).toThrow());
  it("refuses a bomb of brackets", () => expect(() => unpack(new Uint8Array(100000).fill(0x91))).toThrow(RangeError));
});

function label(value: Plain): string {
  const text = value instanceof Uint8Array ? `bin ${value.length}` : JSON.stringify(value);
  return text.length > 30 ? `${text.slice(0, 20)}... (${text.length})` : text;
}
