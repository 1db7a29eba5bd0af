import { describe, expect, it } from "vitest";
import type { Begin, Mark } from "../../src/protocol/generated";
import { TurnBuffer, type Slice } from "../../src/stream/buffer";

const BEGIN: Begin = { type: "begin", turn: 1, voice: "v", lang: "el", sample_rate: 16000, fps: 25 };
const FAPS = Uint8Array.of(3, 48);
const mark = (sample: number): Mark => ({ kind: "word", sample, duration: 1, text: String(sample) });

/** 40 ms with one frame, or two. */
function packet(k: number, values = [k, -k], extra: Partial<Slice> = {}): Slice {
  const rows = values.length / 2;
  const frames = Array.from({ length: rows }, (_, i) => (
    { sample: k * 640 + (i * 640) / rows, values: Int32Array.from(values.slice(2 * i, 2 * i + 2)) }
  ));
  return { sample: k * 640, pcm: new Int16Array(640), frames, marks: [], ...extra };
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
    expect((long as unknown as { frames: unknown[] }).frames.length).toBeLessThan(1000);
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

describe("samples of frames", () => {
  const filled = (packets: number) => {
    const buffer = new TurnBuffer(BEGIN, FAPS);
    for (let k = 0; k < packets; k++) buffer.push(packet(k, [k, -k], { marks: [mark(640 * k)] }));
    return buffer;
  };

  it("counts what comes twice once, and may begin anywhere", () => {
    const buffer = filled(3);
    buffer.push(packet(2, [2, -2], { marks: [mark(1280)] }));
    buffer.push(packet(4));
    expect(buffer.received).toBe(5 * 640);
    expect(face(buffer, 640 * 3)[0]).toBe(3);
    expect(buffer.take(9999)).toHaveLength(3);
    const late = new TurnBuffer(BEGIN, FAPS);
    late.push(packet(1000));
    expect([face(late, 640 * 1000)[0], late.received]).toEqual([1000, 640 * 1001]);
  });

  it("replaces what was discarded by what comes then", () => {
    const buffer = filled(10);
    buffer.discard(640 * 5 + 1);
    expect([buffer.received, face(buffer, 640 * 9)[0]]).toEqual([640 * 5 + 1, 5]);
    buffer.push({ sample: 3201, pcm: new Int16Array(639), frames: [{ sample: 3840, values: Int32Array.of(77, 0) }], marks: [mark(3500)] });
    expect([buffer.received, face(buffer, 3840)[0]]).toEqual([3840, 77]);
    expect(buffer.take(9999).map(({ sample }) => sample)).toEqual([0, 640, 1280, 1920, 2560, 3200, 3500]);
    buffer.discard(0);
    expect(face(buffer, 1920)[0]).toBe(0);
  });

  it("holds one for a moment and not over a gap", () => {
    const buffer = filled(3);
    buffer.push(packet(50));
    for (const sample of [0, 640, 1280 + 1920, 32000]) expect(buffer.holds(sample)).toBe(true);
    for (const sample of [-1, 1280 + 1921, 31999]) expect(buffer.holds(sample)).toBe(false);
    expect(face(buffer, 640 * 30)[0]).toBe(2);
    expect(new TurnBuffer(BEGIN, FAPS).holds(0)).toBe(false);
  });

  it("holds them for longer where they are far apart by nature", () => {
    const buffer = new TurnBuffer(BEGIN, FAPS);
    for (let k = 0; k < 5; k++) buffer.push(packet(10 * k));
    expect(face(buffer, 640 * 15)[0]).toBe(15);
    expect([15, 60, 61].map((k) => buffer.holds(640 * k))).toEqual([true, true, false]);
  });
});
