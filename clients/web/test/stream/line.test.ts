import { describe, expect, it } from "vitest";
import { Line } from "../../src/stream/line";

const RATE = 16000;
const REACH = 17;
/** A voice of 100 Hz. */
const VOICE = Int16Array.from({ length: 40000 }, (_, k) => (
  6000 * [1, 3, 7].reduce((sum, n) => sum + Math.sin((2 * Math.PI * 100 * n * k) / RATE + n) / n, 0)
));

function filled(n: number, at = 0): Line {
  const line = new Line(RATE, REACH);
  expect(line.push(0, VOICE.subarray(0, n))).toBe(n);
  line.at = at;
  return line;
}

/** What lies from `at` on, as int16, and the sample of the turn at each place. */
function rest(line: Line): { pcm: number[]; samples: number[] } {
  const { data, index } = line.window(line.at);
  const n = line.end - line.at;
  const pcm = Array.from(data.subarray(index, index + n), (v) => Math.round(v * 32768));
  const samples: number[] = [];
  for (; line.at < line.end; line.at++) samples.push(line.sample(line.at));
  return { pcm, samples };
}

const range = (from: number, to: number) => Array.from({ length: to - from }, (_, k) => from + k);

describe("Line", () => {
  it("ignores what is here already", () => {
    const line = filled(1000);
    expect(line.push(0, VOICE.subarray(0, 400))).toBe(0);
    expect(line.push(900, VOICE.subarray(900, 1300))).toBe(300);
    expect(rest(line)).toEqual({ pcm: [...VOICE.subarray(0, 1300)], samples: range(0, 1300) });
  });

  it("bridges a gap, where the sample leaps", () => {
    const line = filled(3200, 3100);
    line.push(16000, VOICE.subarray(16000, 19200));
    const { pcm, samples } = rest(line);
    expect(samples).toEqual([...range(3100, 3200), ...range(16000, 19200)]);
    expect(pcm.slice(180)).toEqual([...VOICE.subarray(16080, 19200)]);
  });

  it("lets what is discarded give way within 5 ms", () => {
    const line = filled(8000, 1000);
    line.discard(4000);
    expect([line.next, line.end]).toEqual([4000, 4000]);
    line.push(4000, new Int16Array(800));
    const { pcm, samples } = rest(line);
    expect(samples).toEqual(range(1000, 4800));
    expect(pcm.slice(0, 3000)).toEqual([...VOICE.subarray(1000, 4000)]);
    expect(pcm.slice(3000, 3080).some((v) => v !== 0)).toBe(true);
    expect(pcm.slice(3080).some((v) => v !== 0)).toBe(false);
  });

  it("cannot discard what has a part in what was heard", () => {
    const line = filled(8000, 5000);
    line.discard(100);
    expect([line.next, line.end]).toEqual([5000 + REACH, 5000 + REACH]);
    expect(line.push(100, VOICE.subarray(100, 6000))).toBe(1000 - REACH);
    expect(rest(line).samples).toEqual(range(5000, 6000));
  });

  it.each([-1, 1] as const)("leaves a period out or says it twice (%i)", (way) => {
    const line = filled(8000, 2000 - REACH);
    const change = line.alter(way)!;
    const lag = way * change.samples;
    expect(lag % 160).toBe(0);
    expect(change.quiet).toBe(false);
    line.at = 2000;
    const { pcm, samples } = rest(line);
    expect(samples).toEqual([
      ...range(0, lag).map((k) => 2000 + (1 - way) * k), ...range(2000 + (1 - way) * lag, 8000),
    ]);
    expect(pcm.slice(lag)).toEqual([...VOICE.subarray(2000 + (1 - way) * lag, 8000)]);
    expect(pcm.slice(0, lag).every((v, k) => Math.abs(v - VOICE[2000 + k]) < 300)).toBe(true);
    expect([...line.window(line.end).data.subarray(line.window(line.end).index)].some((v) => v !== 0)).toBe(false);
  });

  it("changes nothing twice in one place, and no noise", () => {
    const line = filled(8000, 2000);
    expect(line.alter(-1)).not.toBeNull();
    expect(line.alter(-1)).toBeNull();
    const noise = new Line(RATE, REACH);
    noise.push(0, Int16Array.from({ length: 8000 }, (_, k) => 9000 * Math.sin(k * k)));
    noise.at = 2000;
    expect([noise.alter(-1), noise.alter(1)]).toEqual([null, null]);
  });

  it("bridges a gap with packets shorter than the bridge as with one", () => {
    const [whole, pieces] = [filled(3200, 3100), filled(3200, 3100)];
    whole.push(16050, VOICE.subarray(16050, 16250));
    for (let k = 16050; k < 16250; k++) pieces.push(k, VOICE.subarray(k, k + 1));
    const [expected, found] = [rest(whole).pcm, rest(pieces).pcm];
    expect(found.length).toBe(300);
    expect(found.every((v, k) => Math.abs(v - expected[k]) <= 2)).toBe(true);
  });

  it("leaves out what was not played, but for the last; later leaps keep their places", () => {
    const line = filled(8000, 1000 - REACH);
    line.push(10000, VOICE.subarray(10000, 12000));
    line.skip(2500);
    expect(line.next).toBe(12000);
    line.at = 1000;
    const { pcm, samples } = rest(line);
    expect(samples).toEqual([...range(7500, 8000), ...range(10000, 12000)]);
    expect(pcm.slice(80, 500)).toEqual([...VOICE.subarray(7580, 8000)]);
    expect(pcm.slice(580)).toEqual([...VOICE.subarray(10080, 12000)]);
  });

  it("leaves nothing out of what is not there", () => {
    const line = filled(1000, 500 - REACH);
    line.skip(500);
    line.skip(900);
    line.at = 500;
    expect(rest(line).pcm).toEqual([...VOICE.subarray(500, 1000)]);
  });

  it("leaves out much of a pause", () => {
    const line = new Line(RATE, REACH);
    line.push(0, new Int16Array(8000));
    line.at = 1000;
    expect(line.alter(-1)).toEqual({ samples: -240, quiet: true });
    expect(line.end).toBe(7760);
  });

  it("leaves no sample out where it is cut within a change", () => {
    const line = filled(8000, 2000 - REACH);
    line.alter(-1);
    line.discard(2100);
    expect(line.next).toBe(2100);
    line.push(2100, VOICE.subarray(2100, 3000));
    line.at = 2000;
    expect(rest(line).samples).toEqual([...range(0, 50).map((k) => 2000 + 2 * k), ...range(2100, 3000)]);
  });
});
