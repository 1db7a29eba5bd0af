/** Against protocol/ADAPT.md, with a general MessagePack implementation as the server. */

import { decode as unpack, encode as pack } from "@msgpack/msgpack";
import { describe, expect, it } from "vitest";
import type { Marks } from "../../adapt/marks";
import { decode, encode } from "../../adapt/wire";

const floats = (...values: number[]) => new Uint8Array(Float32Array.from(values).buffer);
const shorts = (...values: number[]) => new Uint8Array(Uint16Array.from(values).buffer);
const front: Marks = new Map([["9.3", { at: [10, 20.25] }], ["2.1", { at: [1.5, 2], confidence: 0.5 }]]);

describe("encode", () => {
  it("sends a photo as it is", () => {
    expect(unpack(encode({ type: "photo", view: "profile", data: Uint8Array.of(1, 2, 3) })))
      .toEqual({ type: "photo", view: "profile", data: Uint8Array.of(1, 2, 3) });
  });

  it("sends points with the confidence of those that were found", () => {
    expect(unpack(encode({ type: "points", seq: 300, front, profile: new Map(), method: "best" })))
      .toEqual({ type: "points", seq: 300, front: { "9.3": [10, 20.25], "2.1": [1.5, 2, 0.5] }, profile: {}, method: "best" });
  });

  it("leaves out what does not apply", () => {
    expect(unpack(encode({ type: "head", seq: 1, front: new Map(), name: "Ελένη" }))).toEqual({ type: "head", seq: 1, front: {}, name: "Ελένη" });
  });

  it("sends whole pixels as floats as well, but numbers of messages as integers", () => {
    const bytes = encode({ type: "points", seq: 7, front: new Map([["9.3", { at: [10, 20] }]]) });
    expect([...bytes].filter((byte) => byte === 0xcb)).toHaveLength(2);
    expect(bytes).toContain(7);
  });
});

describe("decode", () => {
  it("reads ready", () => {
    const points = [{ name: "3.7", title: "left eye", views: ["front", "profile"], mirror: "3.12" }, { name: "9.3", title: "tip", views: ["front"] }];
    const message = { type: "ready", points, edges: shorts(0, 1, 1, 65535), automatic: true, methods: ["best", "rigid"] };
    expect(decode(pack(message))).toEqual({ ...message, edges: Uint16Array.of(0, 1, 1, 65535) });
  });

  it("reads photo, with and without what may be absent", () => {
    const message = { type: "photo", view: "profile", width: 640, height: 480, picture: Uint8Array.of(255, 216) };
    expect(decode(pack({ ...message, points: { "9.3": [320.5, 200, 0.75] }, facing: "left", note: "Hello" })))
      .toEqual({ ...message, points: new Map([["9.3", { at: [320.5, 200], confidence: 0.75 }]]), facing: "left", note: "Hello" });
    expect(decode(pack({ ...message, points: {} }))).toEqual({ ...message, points: new Map() });
  });

  it("reads fit", () => {
    const laid = { mesh: floats(1, 2, 3.5, 4), points: { "9.3": [1, 2.5] } };
    const read = { mesh: Float32Array.of(1, 2, 3.5, 4), points: new Map([["9.3", [1, 2.5]]]) };
    expect(decode(pack({ type: "fit", seq: 4, front: laid, profile: { ...laid, facing: "right" }, fitted: true, error_px: 1.25, ms: 40 })))
      .toEqual({ type: "fit", seq: 4, front: read, profile: { ...read, facing: "right" }, fitted: true, error_px: 1.25, ms: 40 });
    expect(decode(pack({ type: "fit", seq: 4, front: laid, fitted: false }))).toEqual({ type: "fit", seq: 4, front: read, fitted: false });
  });

  it("reads head and error", () => {
    const head = { type: "head", seq: 5, head: Uint8Array.of(1), points: "{}" };
    expect(decode(pack(head))).toEqual(head);
    const error = { type: "error", code: "bad_photo", message: "no", view: "front" };
    expect(decode(pack(error))).toEqual({ ...error, fatal: false });
    expect(decode(pack({ ...error, fatal: true, seq: 3 }))).toEqual({ ...error, fatal: true, seq: 3 });
  });

  it("skips fields it does not know", () => {
    expect(decode(pack({ type: "head", seq: 5, head: Uint8Array.of(1), points: "", new: [null] }))).not.toHaveProperty("new");
  });

  const fit = { type: "fit", seq: 1, fitted: true };
  it.each<[string, unknown]>([
    ["another type", { type: "hello" }],
    ["no map", [1]],
    ["a missing field", { type: "head", seq: 1, points: "" }],
    ["text for a number", { ...fit, seq: "1" }],
    ["half a vertex", { ...fit, front: { mesh: floats(1, 2, 3), points: {} } }],
    ["half an edge", { type: "ready", points: [], edges: shorts(1), automatic: false, methods: [] }],
    ["half a position", { ...fit, front: { mesh: floats(), points: { "9.3": [1] } } }],
    ["a third side", { ...fit, profile: { mesh: floats(), points: {}, facing: "up" } }],
  ])("refuses %s", (_, message) => expect(() => decode(pack(message))).toThrow());
});
