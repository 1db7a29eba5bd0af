import { describe, expect, it } from "vitest";
import { decode, encode, ProtocolError, type Side } from "../../src/protocol/codec";
import type { Message } from "../../src/protocol/generated";
import { bytes, hex, vectors } from "../vectors";

interface Case { name: string; from: Side; hex: string; message: Message; code: string }

describe("protocol/vectors", () => {
  it.each(vectors<Case>("messages.json"))("$name: both ways", ({ from, message, hex: wire }) => {
    expect(hex(encode(message))).toBe(wire);
    expect(decode(bytes(wire), from)).toEqual(message);
  });

  it.each(vectors<Case>("invalid.json"))("refuses: $name", ({ from, hex: wire, code }) => {
    const error = caught(() => decode(bytes(wire), from));
    expect(error.code).toBe(code);
    expect(error.fatal).toBe(code === "protocol");
  });

  it.each(vectors<Case>("lenient.json"))("reads: $name", ({ from, hex: wire, message }) => {
    expect(decode(bytes(wire), from)).toEqual(message);
  });
});

describe("encode", () => {
  it.each<[string, Message]>([
    ["a float", { type: "ping", id: 1.5 }],
    ["too much", { type: "ping", id: 2 ** 32 }],
    ["a missing field", { type: "end" } as unknown as Message],
    ["a long text", { type: "speak", turn: 1, text: new Uint8Array(65537) }],
  ])("refuses %s", (_, message) => expect(() => encode(message)).toThrow(ProtocolError));
});

describe("decode", () => {
  it("counts str in code points", () => {
    const message: Message = { type: "hello", lang: "🙂".repeat(16) };
    expect(decode(encode(message), "client")).toEqual(message);
    expect(() => encode({ type: "hello", lang: "🙂".repeat(17) })).toThrow(ProtocolError);
  });

  it("gives arrays that stand alone, wherever they lay in the frame", () => {
    for (const pad of ["", "a", "ab", "abc"]) {
      const packet: Message = {
        type: "packet", turn: 1, sample: 0, pcm: Int16Array.of(-2, 300), wide: Int32Array.of(-70000),
        marks: [{ kind: "word", sample: 0, duration: 0, text: pad }],
      };
      const frame = new Uint8Array([0, ...encode(packet)]).subarray(1);
      expect(decode(frame, "server")).toEqual(packet);
    }
  });

  it("never throws anything but a ProtocolError, whatever comes", () => {
    const wire = encode({ type: "begin", turn: 3, voice: "gr2", lang: "el", sample_rate: 16000, fps: 25 });
    for (let at = 0; at < wire.length; at++) {
      for (const value of [0x00, 0x7f, 0x91, 0xc1, 0xc7, 0xdf, 0xff]) {
        const broken = wire.slice();
        broken[at] = value;
        try {
          decode(broken, "server");
        } catch (e) {
          expect(e).toBeInstanceOf(ProtocolError);
        }
      }
    }
  });
});

function caught(run: () => unknown): ProtocolError {
  try {
    run();
  } catch (e) {
    if (e instanceof ProtocolError) return e;
    throw e;
  }
  throw new Error("nothing was thrown");
}
