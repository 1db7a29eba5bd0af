import { beforeEach, describe, expect, it } from "vitest";
import { Face } from "../../src/motion/face";
import { TurnBuffer } from "../../src/stream/buffer";
import type { Heard } from "../../src/stream/heard";

const BEGIN = { type: "begin", turn: 1, voice: "v", lang: "en", sample_rate: 16000, fps: 25 } as const;
const at = (sample: number, state: Heard["state"] = "playing"): Heard => ({ turn: 1, sample, state });

let buffer: TurnBuffer;
let face: Face;
beforeEach(() => {
  buffer = new TurnBuffer(BEGIN, Uint8Array.of(3, 19, 48));
  for (let k = 0; k < 10; k++) {
    buffer.push({ type: "packet", turn: 1, sample: 640 * k, pcm: new Int16Array(640), faps: Int32Array.of(100 * k, 0, 50000) });
  }
  face = new Face(1);
});

describe("Face", () => {
  it("shows the lips of the heard sample at once, at full", () => {
    face.show(null, null, 0, false);
    expect(face.show(buffer, at(640 * 5), 0.01, false)[3]).toBe(500);
  });

  it("takes head and lids over softly", () => {
    face.show(null, null, 0, false);
    const idle = face.values[48];
    const early = face.show(buffer, at(100), 0.02, false)[48];
    expect(Math.abs(early - idle)).toBeLessThan(0.1 * 50000);
    expect(face.show(buffer, at(3200), 0.3, false)[48]).toBe(50000);
  });

  it("stands still while the sound is starved, and lives while the text has run dry", () => {
    face.show(buffer, at(640), 0, false);
    face.show(buffer, at(640), 1, false);
    expect([...face.show(buffer, at(640, "starved"), 5, false)]).toEqual([...face.show(buffer, at(640, "starved"), 9, false)]);
    expect(face.show(buffer, at(640, "waiting"), 10, false)[48]).not.toBe(50000);
    expect(face.values[3]).toBe(100);
  });

  it("eases the lips to neutral when the turn lets go, without a jump", () => {
    face.show(buffer, at(640 * 8), 0, false);
    let last = face.values[3];
    for (let t = 0.01; t < 0.3; t += 0.01) {
      const now = face.show(null, null, t, false)[3];
      expect(now).toBeLessThanOrEqual(last);
      expect(last - now).toBeLessThan(80);
      last = now;
    }
    expect(last).toBe(0);
  });

  it("keeps still but for the lips where motion is not wanted", () => {
    for (let t = 0; t < 20; t += 0.05) {
      const values = face.show(buffer, at(640), t, true);
      expect([values[3], values[19], values[48]]).toEqual([100, 0, 0]);
      expect(face.show(null, null, t, true)[49]).toBe(0);
    }
  });
});
