import { describe, expect, it } from "vitest";
import { HeardMap } from "../../src/stream/heard";
import { FLOOR_S } from "../../src/stream/jitter";
import { Player, type Report } from "../../src/stream/player";

const RATE = 48000;
const QUANTUM = 128;
/** The largest step from one frame of the tone to the next. */
const STEEPEST = (12000 / 32768) * ((2 * Math.PI * 440) / RATE);
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

  begin(turn: number, rate: number, live = false): void {
    this.player.handle({ kind: "begin", turn, rate, live });
  }

  /** What is heard at every frame from the first sound on. */
  heard(): number[] {
    const map = new HeardMap(this.contextRate);
    for (const report of this.reports) map.apply(report);
    return this.out.map((_, frame) => map.at(frame)?.sample ?? -1).filter((sample) => sample >= 0);
  }

  /** The largest step from one frame to the next, but for the end of a turn, which breaks off in these tests. */
  steepest(): number {
    const over = this.events.find(({ kind }) => kind === "over")?.frame ?? Infinity;
    const out = this.out.slice(0, over - 60);
    return out.reduce((most, v, i) => Math.max(most, i ? Math.abs(v - out[i - 1]) : 0), 0);
  }

  /** `packets` of a signal that goes on from sample `from`. */
  feed(turn: number, rate: number, packets: number, from = 0, hold = false): number {
    const size = rate / 25;
    for (let k = 0; k < packets; k++) {
      const pcm = Int16Array.from({ length: size }, (_, i) => 12000 * Math.sin((2 * Math.PI * 440 * (from + k * size + i)) / rate));
      this.player.handle({ kind: "pcm", turn, sample: from + k * size, pcm, hold: hold && k === packets - 1 });
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

describe("A card that stood still", () => {
  it.each([[1, false], [3, false], [1, true], [3, true]])("goes on with what is said now: %i turns, playing %s", (turns, playing) => {
    const rig = new Rig();
    rig.begin(1, 16000, true);
    let at = rig.feed(1, 16000, playing ? 10 : 0);
    rig.run(0.1);
    for (let turn = 1; turn <= turns; turn++) {
      if (turn > 1) {
        rig.player.handle({ kind: "end", turn: turn - 1 });
        rig.begin(turn, 16000, true);
        at = 0;
      }
      at = rig.feed(turn, 16000, 400, at);
      expect(rig.player.stats.storeMs).toBeLessThan(5000);
    }
    rig.player.handle({ kind: "catch-up" });
    rig.run(0.5);
    const last = rig.events.at(-1)!;
    expect(last).toMatchObject({ kind: "pause", turn: turns, state: "starved" });
    expect("sample" in last && last.sample).toBeGreaterThan(at - 100);
    expect(rig.steepest()).toBeLessThan(1.1 * STEEPEST);
  });

  it("leaves nothing out of a talk that is not live", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 400);
    rig.player.handle({ kind: "catch-up" });
    rig.run(0.1);
    expect(rig.player.stats.storeMs).toBeGreaterThan(15000);
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
    expect(FLOOR_S).toBeGreaterThan(0.04);
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
    const [pause, again] = rig.events.slice(-2);
    expect(pause).toMatchObject({ kind: "pause", state: "starved" });
    expect(again).toMatchObject({ kind: "play", sample: pause.sample });
    expect(pause.frame - rig.events[0].frame).toBe(Math.ceil(pause.sample * 3 + rig.player.stats.stretchedMs * 48));
    expect(rig.level(pause.frame, pause.frame + 480)).toBeGreaterThan(0.2);
    expect(rig.level(pause.frame + 0.04 * RATE, again.frame)).toBe(0);
    expect(rig.player.stats.underruns).toBe(1);
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
    expect(rig.steepest()).toBeLessThan(1.1 * STEEPEST);
  });

  it("is no fault after a hold, which plays to the last sample", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    const next = rig.feed(1, 16000, 10, 0, true);
    rig.run(2);
    expect(rig.events[1]).toMatchObject({ kind: "pause", state: "waiting", sample: next });
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

describe("pause", () => {
  it("fades, and goes on exactly where it stopped", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 25);
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(0.3);
    rig.player.handle({ kind: "pause", on: true });
    rig.run(0.5);
    const paused = rig.events.at(-1)!;
    expect(paused).toMatchObject({ kind: "pause", state: "paused" });
    expect(rig.level(paused.frame, rig.frame)).toBe(0);
    rig.player.handle({ kind: "pause", on: false });
    rig.run(1);
    const [waiting, again, over] = rig.events.slice(-3);
    expect(waiting).toMatchObject({ state: "waiting", sample: paused.sample });
    expect(again).toMatchObject({ kind: "play", sample: paused.sample });
    expect(over.frame - again.frame).toBe(Math.ceil((16000 - paused.sample) * 3 - 1e-6));
    expect(rig.steepest()).toBeLessThan(1.1 * STEEPEST);
  });

  it("keeps turns from beginning, and may be taken back within its fade", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 10);
    rig.player.handle({ kind: "end", turn: 1 });
    rig.player.handle({ kind: "pause", on: true });
    rig.run(0.1);
    expect(rig.events).toEqual([]);
    rig.player.handle({ kind: "pause", on: false });
    rig.run(0.1);
    rig.player.handle({ kind: "pause", on: true });
    rig.run(0.01);
    rig.player.handle({ kind: "pause", on: false });
    rig.run(0.05);
    expect(rig.events.map(({ kind }) => kind)).toEqual(["play"]);
  });
});

describe("what the server changes", () => {
  it("is cut softly where it is revised, and goes on there", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 25);
    rig.run(0.2);
    rig.player.handle({ kind: "discard", turn: 1, sample: 8000 });
    rig.player.handle({ kind: "pcm", turn: 1, sample: 8000, pcm: new Int16Array(640).fill(3000), hold: false });
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(1);
    const [play, over] = [rig.events[0], rig.events.at(-1)!];
    expect(over).toMatchObject({ kind: "over", sample: 8640, frame: play.frame + 3 * 8640 });
    expect(rig.out[play.frame + 3 * 8300]).toBeCloseTo(3000 / 32768, 3);
    expect(rig.steepest()).toBeLessThan(1.2 * STEEPEST);
  });

  it("is heard as it was where it comes too late, and no sample twice", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    rig.feed(1, 16000, 25);
    rig.run(0.5);
    rig.player.handle({ kind: "discard", turn: 1, sample: 1000 });
    rig.run(0.1);
    const starved = rig.events.at(-1)!;
    expect(starved).toMatchObject({ kind: "pause", state: "starved" });
    expect(starved.sample).toBeGreaterThan(7900);
    rig.player.handle({ kind: "pcm", turn: 1, sample: 1000, pcm: new Int16Array(9000).fill(3000), hold: false });
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(0.5);
    const [again, over] = rig.events.slice(-2);
    expect([again.sample, over.sample]).toEqual([starved.sample, 10000]);
    expect(over.frame - again.frame).toBe(Math.ceil((10000 - starved.sample) * 3 - 1e-6));
  });

  it("leaps without a click where some was skipped", () => {
    const rig = new Rig();
    rig.begin(1, 16000, true);
    rig.feed(1, 16000, 5, 32000);
    rig.feed(1, 16000, 5, 64000);
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(0.6);
    expect(rig.events.map(({ kind, sample }) => [kind, sample])).toEqual([["play", 32000], ["play", 64000], ["over", 67200]]);
    expect(rig.steepest()).toBeLessThan(1.1 * STEEPEST);
  });
});

describe("the store", () => {
  it("of a live talk shrinks to what is needed, imperceptibly", () => {
    const rig = new Rig();
    rig.begin(1, 16000, true);
    let sent = rig.feed(1, 16000, 10);
    const stores: number[] = [];
    for (let k = 0; k < 400; k++) {
      sent = rig.feed(1, 16000, 1, sent);
      rig.run(0.04);
      stores.push(rig.player.stats.storeMs);
    }
    expect(Math.max(...stores.slice(0, 10))).toBeGreaterThan(350);
    expect(Math.max(...stores.slice(-50))).toBeLessThan(50 + 20 + 15);
    expect(Math.min(...stores.slice(-50))).toBeGreaterThan(0);
    expect(rig.player.stats).toMatchObject({ underruns: 0, late: 0 });
    expect(rig.player.stats.stretchedMs).toBeGreaterThan(200);
    expect(rig.player.stats.stretchedMs).toBeLessThan(600);
    const heard = rig.heard();
    expect(heard.every((v, i) => !i || v >= heard[i - 1])).toBe(true);
    expect(rig.steepest()).toBeLessThan(1.3 * STEEPEST);
  });

  it("of one's own turn is kept, and stretched when packets do not come", () => {
    const rig = new Rig();
    rig.begin(1, 16000);
    let sent = rig.feed(1, 16000, 35);
    for (let k = 0; k < 25; k++) {
      sent = rig.feed(1, 16000, 1, sent);
      rig.run(0.04);
    }
    expect(rig.player.stats.stretchedMs).toBe(0);
    rig.run(2);
    const { stretchedMs } = rig.player.stats;
    expect(stretchedMs).toBeGreaterThan(5);
    const starved = rig.events.at(-1)!;
    expect(starved).toMatchObject({ kind: "pause", state: "starved" });
    expect(starved.frame - rig.events[0].frame).toBe(Math.ceil(starved.sample * 3 + stretchedMs * 48 - 1e-6));
    const heard = rig.heard();
    expect(heard.every((v, i) => !i || v >= heard[i - 1])).toBe(true);
    expect(rig.steepest()).toBeLessThan(1.2 * STEEPEST);
  });

  it.each([-200, 200])("of a live talk stays though clocks drift by %i ppm", (ppm) => {
    const player = new Player(16000, () => undefined);
    player.handle({ kind: "begin", turn: 1, rate: 16000, live: true });
    const block = new Float32Array(320);
    const stores: number[] = [];
    let sent = 0;
    for (let k = 0; k < 50 * 120; k++) {
      for (; sent <= 1280 + 320 * k * (1 + 1e-6 * ppm); sent += 640) {
        const pcm = Int16Array.from({ length: 640 }, (_, i) => 9000 * Math.sin((2 * Math.PI * 200 * (sent + i)) / 16000));
        player.handle({ kind: "pcm", turn: 1, sample: sent, pcm, hold: false });
      }
      player.render(block, 320 * k);
      stores.push(player.stats.storeMs);
    }
    expect(player.stats.underruns).toBe(0);
    expect(Math.min(...stores.slice(100))).toBeGreaterThan(0);
    expect(Math.max(...stores)).toBeLessThan(110);
  });
});

it("never clicks and never goes back, whatever happens", () => {
  for (let seed = 1; seed <= 40; seed++) {
    const chance = random(seed);
    const rig = new Rig();
    rig.begin(1, 16000, seed % 2 === 0);
    let end = 0;
    for (let k = 0; k < 60; k++) {
      const what = chance();
      const n = Math.floor(chance() * 700) + 1;
      if (what < 0.45) {
        const start = Math.max(0, end + [0, 0, 0, 0, -300, 5000][Math.floor(chance() * 6)]);
        const pcm = Int16Array.from({ length: n }, (_, i) => 12000 * Math.sin((2 * Math.PI * 440 * (start + i)) / 16000));
        rig.player.handle({ kind: "pcm", turn: 1, sample: start, pcm, hold: false });
        end = Math.max(end, start + n);
      } else if (what < 0.85) rig.run(n / 16000);
      else if (what < 0.95) {
        end = Math.max(0, end - 3 * n);
        rig.player.handle({ kind: "discard", turn: 1, sample: end });
      } else rig.player.handle({ kind: "pause", on: n > 350 });
    }
    rig.player.handle({ kind: "pause", on: false });
    rig.player.handle({ kind: "end", turn: 1 });
    rig.run(4);
    expect(rig.events.at(-1)!.kind).toBe("over");
    expect(rig.out.every((v) => Math.abs(v) <= 1)).toBe(true);
    expect(rig.steepest(), `seed ${seed}`).toBeLessThan(2.5 * STEEPEST + 12000 / 32768 / 240);
    const heard = rig.heard();
    expect(heard.every((v, i) => !i || v >= heard[i - 1] - 1e-9), `seed ${seed}`).toBe(true);
  }
});

/** Numbers in [0, 1) that follow from the seed (Lehmer 1951). */
function random(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

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
  return (rig.player as unknown as { queue: { line: { data: Float32Array } }[] }).queue[0].line.data.length;
}
