import { describe, expect, it } from "vitest";
import { HeardMap } from "../../src/stream/heard";

function map(): HeardMap {
  const heard = new HeardMap(48000);
  heard.apply({ kind: "play", turn: 1, frame: 1000, sample: 0, rate: 16000 });
  return heard;
}

describe("HeardMap", () => {
  it("is silent before the first sound", () => expect(map().at(999)).toBeNull());

  it("runs at the turn's rate", () => {
    expect(map().at(1000 + 48000)).toEqual({ turn: 1, sample: 16000, state: "playing" });
    expect(map().at(1001.5)?.sample).toBeCloseTo(0.5);
  });

  it.each(["starved", "waiting", "paused"] as const)("stands still in a pause (%s)", (state) => {
    const heard = map();
    heard.apply({ kind: "pause", turn: 1, frame: 4000, sample: 1000, state });
    expect(heard.at(3997)).toMatchObject({ sample: 999, state: "playing" });
    expect(heard.at(9000)).toEqual({ turn: 1, sample: 1000, state });
    heard.apply({ kind: "play", turn: 1, frame: 10000, sample: 1000, rate: 16000 });
    expect(heard.at(9999)).toEqual({ turn: 1, sample: 1000, state });
    expect(heard.at(10003)).toEqual({ turn: 1, sample: 1001, state: "playing" });
  });

  it("goes over to the next turn when that is heard, not when it is reported", () => {
    const heard = map();
    heard.apply({ kind: "over", turn: 1, frame: 4000, sample: 1000 });
    heard.apply({ kind: "play", turn: 2, frame: 4000, sample: 0, rate: 24000 });
    expect(heard.at(3999)?.turn).toBe(1);
    expect(heard.at(4002)).toEqual({ turn: 2, sample: 1, state: "playing" });
    heard.apply({ kind: "over", turn: 2, frame: 5000, sample: 500 });
    expect(heard.at(6000)).toEqual({ turn: 2, sample: 500, state: "over" });
  });

  it("hears of turns that never played", () => {
    const heard = map();
    heard.apply({ kind: "over", turn: 1, frame: 2000, sample: 333 });
    heard.apply({ kind: "over", turn: 2, frame: 2000, sample: 0 });
    expect(heard.at(2500)).toEqual({ turn: 2, sample: 0, state: "over" });
  });

  it("finds the frame of a sample", () => {
    expect(map().frameOf(1, 16000)).toBe(49000);
    expect(map().frameOf(2, 0)).toBeNull();
  });

  it("passes twice as fast where a period is left out, and stands where one is said twice", () => {
    const heard = map();
    for (const [frame, sample, rate] of [[4000, 1000, 32000], [4300, 1200, 16000], [7000, 2100, 0], [7300, 2100, 16000]]) {
      heard.apply({ kind: "play", turn: 1, frame, sample, rate });
    }
    expect(heard.frameOf(1, 1100)).toBe(4150);
    expect(heard.frameOf(1, 2110)).toBe(7330);
    expect([3997, 4150, 4300, 6997, 7150, 7303].map((frame) => heard.at(frame)?.sample)).toEqual([999, 1100, 1200, 2099, 2100, 2101]);
  });
});
