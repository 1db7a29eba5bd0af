import { beforeEach, describe, expect, it } from "vitest";
import { Face } from "../../src/motion/face";
import { IDLE_FAPS } from "../../src/motion/idle";
import { TurnBuffer } from "../../src/stream/buffer";
import type { Heard } from "../../src/stream/heard";

const BEGIN = { type: "begin", turn: 1, voice: "v", lang: "en", sample_rate: 16000, fps: 25 } as const;
const at = (sample: number, state: Heard["state"] = "playing"): Heard => ({ turn: 1, sample, state });
/** The lips' FAP 3, a lid, a brow, an eye and the head. */
const FAPS = Uint8Array.of(3, 19, 31, 23, 48);

let buffer: TurnBuffer;
let face: Face;

/** Frame k, with the lips at `lips`. */
function push(k: number, lips: number): void {
  const values = Int32Array.of(lips, 0, 40, -3000, 5000);
  buffer.push({ sample: 640 * k, pcm: new Int16Array(640), marks: [], frames: [{ sample: 640 * k, values }] });
}

beforeEach(() => {
  buffer = new TurnBuffer(BEGIN, FAPS);
  for (let k = 0; k < 10; k++) {
    push(k, 100 * k);
  }
  face = new Face(1);
});

/** The largest step of each FAP from one picture to the next, 100 a second. */
function steps(show: (t: number) => ArrayLike<number>, from: number, to: number): Map<number, number> {
  const most = new Map<number, number>();
  let last: number[] | null = null;
  for (let t = from; t < to; t += 0.01) {
    const now = Array.from(show(t));
    if (last) now.forEach((v, fap) => most.set(fap, Math.max(most.get(fap) ?? 0, Math.abs(v - last![fap]))));
    last = now;
  }
  return most;
}

describe("Face", () => {
  it("shows the lips of the heard sample from the first on; a turn met in its middle is caught up with in 0.15 s", () => {
    face.show(null, null, 0, false);
    for (let k = 0; k < 10; k++) expect(face.show(buffer, at(640 * k), 0.04 * (k + 1), false)[3]).toBeCloseTo(100 * k, 3);
    const late = new Face(1);
    late.show(null, null, 0, false);
    late.show(buffer, at(640 * 5), 0.01, false);
    expect(late.show(buffer, at(640 * 5), 0.17, false)[3]).toBe(500);
  });

  it("takes the head over softly, wholly after its time", () => {
    for (let t = 0; t < 10; t += 0.02) face.show(null, null, t, false);
    const idle = face.values[48];
    expect(Math.abs(face.show(buffer, at(100), 10.02, false)[48] - idle)).toBeLessThan(0.1 * 5000);
    expect(face.show(buffer, at(3200), 10.8, false)[48]).toBe(5000);
  });

  it("never jumps where a turn begins, waits, goes on and ends", () => {
    const heard = (t: number): Heard | null => {
      if (t < 3 || t > 6) return null;
      return t > 4 && t < 5 ? at(3200, "waiting") : at(3200);
    };
    const show = (t: number) => face.show(heard(t) && buffer, heard(t), t, false);
    const most = steps(show, 0, 9);
    expect(most.get(3)).toBeLessThan(70);
    expect(most.get(31)).toBeLessThan(3);
    expect(most.get(48)).toBeLessThan(250);
    expect(most.get(19)).toBeLessThan(350);
    for (const fap of IDLE_FAPS) expect(most.get(fap)! > 0).toBe(true);
  });

  it.each(["starved", "paused"] as const)("comes to rest where the sound stops (%s), and softly back", (state) => {
    face.show(buffer, at(5120), 0, false);
    const fall = steps((t) => face.show(buffer, at(5120, state), t, false), 0.01, 1);
    expect(fall.get(3)).toBeLessThan(50);
    expect(face.values[3]).toBe(0);
    const idle = face.show(buffer, at(5120, state), 2, false)[48];
    expect(face.show(buffer, at(5120, state), 3, false)[48]).not.toBe(idle);
    const rise = steps((t) => face.show(buffer, at(5120 + 16000 * (t - 3)), t, false), 3, 3.17);
    expect(rise.get(3)).toBeLessThan(320);
    expect(face.values[3]).toBe(900);
  });

  it("is on time when the sound comes back where the lips stood at rest", () => {
    face.show(buffer, at(0), 0, false);
    for (let t = 0.01; t < 1; t += 0.03) face.show(buffer, at(0, "starved"), t, false);
    for (let k = 1; k < 10; k++) expect(face.show(buffer, at(320 * k), 1 + k / 50, false)[3]).toBeCloseTo(50 * k, 3);
  });

  it("holds a frame for a moment where others are missing, then rests", () => {
    const shown: number[] = [];
    for (let k = 0; k < 100; k++) shown.push(face.show(buffer, at(5760 + 160 * k), k / 100, false)[3]);
    expect([shown[11], shown[60]]).toEqual([900, 0]);
    expect(Math.max(...shown.slice(1).map((v, k) => Math.abs(v - shown[k])))).toBeLessThan(60);
  });

  it("follows a leap of what is heard without one of the lips", () => {
    for (let k = 50; k < 60; k++) push(k, 800);
    face.show(buffer, at(0), 0, false);
    const shown: number[] = [];
    for (let k = 0; k < 20; k++) shown.push(face.show(buffer, at(640 * 50 + 160 * k), (k + 1) / 100, false)[3]);
    expect(shown[0]).toBeLessThan(50);
    expect(Math.max(...shown.slice(1).map((v, k) => v - shown[k]))).toBeLessThan(280);
    expect(shown[19]).toBe(800);
  });

  it("lives while the text has run dry", () => {
    face.show(buffer, at(640), 0, false);
    face.show(buffer, at(640), 1, false);
    face.show(buffer, at(640, "waiting"), 10, false);
    expect(face.show(buffer, at(640, "waiting"), 11, false)[48]).not.toBe(5000);
    expect(face.values[3]).toBe(100);
  });

  it("eases the lips to neutral when the turn lets go, without a jump", () => {
    face.show(buffer, at(640 * 8), 0, false);
    let last = face.values[3];
    for (let t = 0.01; t < 0.4; t += 0.01) {
      const now = face.show(null, null, t, false)[3];
      expect(now).toBeLessThanOrEqual(last + 1e-6);
      expect(last - now).toBeLessThan(50);
      last = now;
    }
    expect(last).toBeCloseTo(0, 6);
  });

  it("does not catch up on its life after the page was hidden", () => {
    face.show(null, null, 0, false);
    const before = [...face.show(null, null, 0.25, false)];
    const other = new Face(1);
    other.show(null, null, 0, false);
    expect([...other.show(null, null, 1e7, false)]).toEqual(before);
  });

  it("keeps still but for the lips where motion is not wanted", () => {
    for (let t = 0; t < 20; t += 0.05) {
      const values = face.show(buffer, at(640), t, true);
      expect([values[3], values[19], values[23], values[48]]).toEqual([100, 0, 0, 0]);
      expect(face.show(null, null, t, true)[49]).toBe(0);
    }
  });
});
