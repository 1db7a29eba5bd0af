import { describe, expect, it } from "vitest";
import type { Begin, Mark, Packet } from "../../src/protocol/generated";
import { TurnBuffer } from "../../src/stream/buffer";

const BEGIN: Begin = { type: "begin", turn: 1, voice: "v", lang: "el", sample_rate: 16000, fps: 25 };
const FAPS = Uint8Array.of(3, 48);
const mark = (sample: number): Mark => ({ kind: "word", sample, duration: 1, text: String(sample) });

function packet(k: number, values = [k, -k], extra: Partial<Packet> = {}): Packet {
  return { type: "packet", turn: 1, sample: k * 640, pcm: new Int16Array(640), faps: Int32Array.from(values), ...extra };
}

function face(buffer: TurnBuffer, sample: number): number[] {
  const out = new Float32Array(69).fill(9);
  buffer.face(sample, out);
  return [out[3], out[48], out[4]].map((v) => v + 0);
}

describe("the face of a sample", () => {
  const buffer = new TurnBuffer(BEGIN, FAPS);
  for (let k = 0; k < 10; k++) buffer.push(packet(k));

  it("is the frame's where a frame holds", () => expect(face(buffer, 640 * 4)).toEqual([4, -4, 0]));
  it("is linear between frames", () => expect(face(buffer, 640 * 4.25)).toEqual([4.25, -4.25, 0]));
  it("holds the first and the last", () => {
    expect(face(buffer, -5)).toEqual([0, 0, 0]);
    expect(face(buffer, 640 * 20)).toEqual([9, -9, 0]);
  });

  it("is neutral while there is no frame", () => expect(face(new TurnBuffer(BEGIN, FAPS), 100)).toEqual([0, 0, 0]));

  it("takes several frames a packet", () => {
    const fast = new TurnBuffer({ ...BEGIN, fps: 50 }, FAPS);
    fast.push(packet(0, [1, 1, 2, 2]));
    fast.push(packet(1, [3, 3, 4, 4]));
    expect(face(fast, 480)[0]).toBe(2.5);
    expect(face(fast, 320 * 3)[0]).toBe(4);
  });

  it("is right after minutes, with the past forgotten", () => {
    const long = new TurnBuffer(BEGIN, FAPS);
    for (let k = 0; k < 9000; k++) {
      long.push(packet(k));
      if (k % 10 === 0 && k > 50) expect(face(long, 640 * (k - 40.5))[0]).toBe(k - 40.5);
    }
    expect((long as unknown as { rows: unknown[] }).rows.length).toBeLessThan(1000);
  });
});

it("gives marks once, when they are reached", () => {
  const buffer = new TurnBuffer(BEGIN, FAPS);
  buffer.push(packet(0, [0, 0], { marks: [mark(0), mark(100)] }));
  buffer.push(packet(1, [0, 0], { marks: [mark(700)] }));
  expect(buffer.take(99).map(({ sample }) => sample)).toEqual([0]);
  expect(buffer.take(700).map(({ sample }) => sample)).toEqual([100, 700]);
  expect(buffer.take(9999)).toEqual([]);
});

it("knows where sound begins", () => {
  const buffer = new TurnBuffer(BEGIN, FAPS);
  buffer.push(packet(0));
  expect(buffer.onset).toBeNull();
  const pcm = new Int16Array(640);
  pcm[7] = -5000;
  buffer.push(packet(1, [0, 0], { pcm }));
  expect(buffer.onset).toBe(647);
  expect(buffer.received).toBe(1280);
});
