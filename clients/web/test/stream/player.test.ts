import { describe, expect, it } from "vitest";
import { Player, PREBUFFER_S, type Report } from "../../src/stream/player";

const RATE = 48000;
const QUANTUM = 128;
type Event = Exclude<Report, { kind: "tick" }>;

/** A player whose time passes by `run`; a packet is 40 ms. */
class Rig {
  readonly reports: Report[] = [];
  readonly out: number[] = [];
  readonly player: Player;

  constructor(readonly contextRate = RATE) {
    this.player = new Player(contextRate, (report) => this.reports.push(report));
  }

  get frame(): number {
    return this.out.length;
  }

  get events(): Event[] {
    return this.reports.filter((report): report is Event => report.kind !== "tick");
  }

  run(seconds: number): void {
    const until = this.frame + seconds * this.contextRate;
    const block = new Float32Array(QUANTUM);
    while (this.frame < until) {
      this.player.render(block, this.frame);
      this.out.push(...block);
    }
  }

  begin(turn: number, rate: number): void {
    this.player.handle({ kind: "begin", turn, rate });
  }

  /** `packets` of a signal that goes on from sample `from`. */
  feed(turn: number, rate: number, packets: number, from = 0, hold = false): number {
    const size = rate / 25;
    for (let k = 0; k < packets; k++) {
      const pcm = Int16Array.from({ length: size }, (_, i) => 12000 * Math.sin((2 * Math.PI * 440 * (from + k * size + i)) / rate));
      this.player.handle({ kind: "pcm", turn, pcm, hold: hold && k === packets - 1 });
    }
    return from + packets * size;
  }

  level(from: number, to: number): number {
    const part = this.out.slice(from, to);
    return Math.sqrt(part.reduce((sum, v) => sum + v * v, 0) / part.length);
  }
}

function simple(rig: Rig, rate: number, seconds: number): void {
  rig.begin(1, rate);
  rig.feed(1, rate, seconds * 25);
  rig.player.handle({ kind: "end", turn: 1 });
  rig.run(seconds + 0.1);
}

describe.each([[16000, 48000], [22050, 48000], [22050, 44100], [48000, 44100], [16000, 16000]])("a turn of %i Hz at %i Hz", (rate, contextRate) => {
  it("is as long as it should be, to the frame", () => {
    const rig = new Rig(contextRate);
    simple(rig, rate, 2);
    const [play, over] = rig.events;
    expect(rig.events.map(({ kind }) => kind)).toEqual(["play", "over"]);
    expect(over.frame - play.frame).toBe(Math.ceil(2 * contextRate));
    expect(over.sample).toBe(2 * rate);
  });

  it("puts every sample where the report says", () => {
    const rig = new Rig(contextRate);
    simple(rig, rate, 1);
    const start = rig.events[0].frame;
    for (let frame = start + 500; frame < start + contextRate / 2; frame += 97) {
      const sample = ((frame - start) * rate) / contextRate;
      expect(rig.out[frame]).toBeCloseTo((12000 / 32768) * Math.sin((2 * Math.PI * 440 * sample) / rate), 3);
    }
  });
});

describe("starting", () => {
  it("waits for the prebuffer, then starts", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 1);
    rig.run(0.2);
    expect(rig.events).toEqual([]);
    rig.feed(1, 16000, 1, 640);
    rig.run(0.01);
    expect(rig.events[0].kind).toBe("play");
    expect(PREBUFFER_S).toBeLessThanOrEqual(0.08);
  });

  it.each([["the turn is over", true, false], ["the text has run dry", false, true]])("starts with less when %s", (_, end, hold) => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 1, 0, hold);
    if (end) rig.player.handle({ kind: "end", turn: 1 });
    rig.run(0.1);
    expect(rig.events[0].kind).toBe("play");
    expect(rig.events[1].sample).toBe(640);
  });

  it("plays turns of different rates one after the other, without a gap", () => {
    const rig = new Rig();
    for (const [turn, rate] of [[1, 16000], [2, 22050]] as const) {
      rig.begin(turn, rate);
      rig.feed(turn, rate, 25);
      rig.player.handle({ kind: "end", turn });
    }
    rig.run(2.1);
    const [, over, play, end] = rig.events;
    expect(play).toMatchObject({ kind: "play", turn: 2, sample: 0, rate: 22050, frame: over.frame });
    expect(end.frame - play.frame).toBe(RATE);
  });

  it("gets over a turn without sound", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(0.01);
    expect(rig.events.map(({ kind }) => kind)).toEqual(["play", "over"]);
  });
});

describe("a packet that comes late", () => {
  it("stops the sound, counts, and goes on with the very next sample", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    const next = rig.feed(1, 16000, 10);
    rig.run(0.8);
    rig.feed(1, 16000, 10, next);
    rig.run(0.2);
    const [play, pause, again] = rig.events;
    expect(pause).toMatchObject({ kind: "pause", underrun: true });
    expect(again).toMatchObject({ kind: "play", sample: pause.sample });
    expect(pause.frame - play.frame).toBe(Math.round(pause.sample * 3));
    expect(rig.level(pause.frame + 1000, again.frame)).toBeLessThan(1e-4);
    const at = again.frame + 1000;
    expect(rig.out[at]).toBeCloseTo((12000 / 32768) * Math.sin((2 * Math.PI * 440 * (again.sample + 1000 / 3)) / 16000), 3);
  });

  it("does not click", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    const next = rig.feed(1, 16000, 10);
    rig.run(0.8);
    rig.feed(1, 16000, 10, next);
    rig.run(0.2);
    const steps = rig.out.slice(1).map((v, i) => Math.abs(v - rig.out[i]));
    expect(Math.max(...steps)).toBeLessThan(1.1 * (12000 / 32768) * ((2 * Math.PI * 440) / RATE));
  });

  it("is no fault after a hold, which plays to the last sample", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    const next = rig.feed(1, 16000, 10, 0, true);
    rig.run(2);
    expect(rig.events[1]).toMatchObject({ kind: "pause", underrun: false, sample: next });
    rig.feed(1, 16000, 10, next);
    rig.run(0.1);
    expect(rig.events[2]).toMatchObject({ kind: "play", sample: next });
  });
});

describe("stop", () => {
  it("fades within 20 ms and lets the next turn begin", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 50);
    rig.begin(2, 16000);
    rig.feed(2, 16000, 50);
    rig.run(0.5);
    const at = rig.frame;
    rig.player.handle({ kind: "stop", turn: 1 });
    rig.run(0.1);
    const over = rig.events.find(({ kind }) => kind === "over")!;
    expect(over.turn).toBe(1);
    expect(over.frame - at).toBeLessThanOrEqual(0.02 * RATE + 1);
    expect(over.frame - at).toBeGreaterThan(0.015 * RATE);
    expect(rig.events.at(-1)).toMatchObject({ kind: "play", turn: 2 });
  });

  it("drops a turn that waits or is dry at once", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 1);
    rig.player.handle({ kind: "stop", turn: 1 });
    rig.run(0.01);
    expect(rig.events).toEqual([{ kind: "over", turn: 1, frame: 0, sample: 0 }]);
    expect(rig.level(0, rig.frame)).toBe(0);
  });
});

it("plays two minutes right, and its memory small", () => {
  const rig = new Rig();
  rig.begin(1, 22050);
  let next = rig.feed(1, 22050, 5);
  const block = new Float32Array(QUANTUM);
  const expected = (at: number) => (12000 / 32768) * Math.sin((2 * Math.PI * 440 * (at - rig.events[0].frame)) / RATE);
  let frame = 0;
  let worst = 0;
  for (let k = 0; k < 120 * 25; k++) {
    next = rig.feed(1, 22050, 1, next);
    for (; frame < (k + 1) * (RATE / 25); frame += QUANTUM) {
      rig.player.render(block, frame);
      if (frame > 2000) worst = Math.max(worst, Math.abs(block[64] - expected(frame + 64)));
    }
  }
  expect(worst).toBeLessThan(1e-3);
  const used = memory(rig);
  rig.player.handle({ kind: "stop", turn: 1 });
  for (; rig.events.length < 2; frame += QUANTUM) rig.player.render(block, frame);
  const [play, over] = rig.events;
  expect(over.kind).toBe("over");
  expect(used).toBeLessThan(1 << 17);
  expect(over.sample).toBeCloseTo(((over.frame - play.frame) * 22050) / RATE, 6);
});

/** Samples of room that the turn being played has. */
function memory(rig: Rig): number {
  return (rig.player as unknown as { queue: { data: Float32Array }[] }).queue[0].data.length;
}
