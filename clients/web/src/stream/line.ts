/**
 * One turn's sound on its way to the card, in the order in which it is played. What lies in the line may have been
 * joined, shortened and stretched; knots say which sample of the turn is where. Twin of fapstream/stream/line.py.
 */

import { ALIKE, fade, fall, isQuiet, period, periods, type Sound } from "./stretch";

/** How long the old sound goes over into the new where it was cut, or where some is missing. */
const RAMP_S = 0.005;
/** Sound that was played is kept for so long: what may have to be continued or repeated. */
const PAST_S = 0.035;

/**
 * `sample` lies at `index` of the line; from there on `pace` samples of the turn to a place. Where a period is left out
 * the pace is 2, where one is said twice 0: the very mean of what is mixed there.
 */
export interface Knot {
  readonly index: number;
  readonly sample: number;
  readonly pace: number;
}

/** The line has become longer by `samples`, in a pause (`quiet`) or in speech. */
export interface Change {
  samples: number;
  quiet: boolean;
}

const NOTHING = new Float32Array(0);
const sampleAt = ({ index, sample, pace }: Knot, at: number): number => sample + pace * (at - index);

export class Line {
  /** The place that is played; whoever plays it moves it on. */
  at = 0;
  /** The place after the last one filled. */
  end = 0;
  /** The sample of the turn that is expected; null before the first. */
  next: number | null = null;
  /** Is the sound being heard? */
  flows = false;
  private data: Sound = new Float32Array(1 << 15);
  /** Place of data[0]. The signal is 0 before place 0 and from `end` on. */
  private base: number;
  /** The first holds at `at`. */
  private knots: Knot[] = [{ index: 0, sample: 0, pace: 1 }];
  /** What was to follow at the end, and does not: the next sound grows out of it. */
  private falling: Sound = NOTHING;
  private readonly ramp: number;
  private readonly past: number;

  /** `reach`: places on each side of the one played that have a part in what is heard there. */
  constructor(private readonly rate: number, private readonly reach: number) {
    this.ramp = Math.round(RAMP_S * rate);
    this.past = Math.max(reach, Math.round(PAST_S * rate));
    this.base = -reach;
  }

  /** What holds at `at`. */
  get knot(): Knot {
    this.pass();
    return this.knots[0];
  }

  /** Where the next knot holds. */
  get turnAt(): number {
    this.pass();
    return this.knots[1]?.index ?? Infinity;
  }

  /** The sample of the turn at a place, `at` or one less than 1 further on. */
  sample(place: number): number {
    return sampleAt(this.knot, place);
  }

  /** The signal, and where in it a place lies. */
  window(place: number): { data: Sound; index: number } {
    return { data: this.data, index: place - this.base };
  }

  /**
   * The sound from `sample` on, what is here already left out; returns how much was new. Where some is missing the
   * sound is bridged and the sample leaps.
   */
  push(sample: number, pcm: Int16Array): number {
    if (this.next === null) {
      this.tie({ index: this.end, sample, pace: 1 });
      this.next = sample;
    }
    const fresh = Float32Array.from(pcm.subarray(Math.max(0, this.next - sample)), (v) => v / 32768);
    if (!fresh.length) return 0;
    if (sample > this.next) this.leap(sample);
    this.append(fresh);
    this.next = Math.max(this.next, sample) + fresh.length;
    return fresh.length;
  }

  /** Forget the sound from `sample` on, as far as it was not played: the next push goes on there. */
  discard(sample: number): void {
    if (this.next === null || sample >= this.next) return;
    const index = Math.min(this.end, Math.max(this.fixed, this.find(sample)));
    if (index < this.end) this.falling = this.beyond(index);
    this.next = sampleAt(this.holding(index), index);
    this.data.fill(0, index - this.base, this.end - this.base);
    this.end = index;
    this.tie({ index, sample: this.next, pace: 1 });
  }

  /** Leave out what was not played, but for the last `left` samples; it is bridged. */
  skip(left: number): void {
    const start = this.fixed;
    const index = this.end - left;
    if (index <= start) return;
    const [to, from, end] = [start - this.base, index - this.base, this.end - this.base];
    const n = Math.min(this.ramp, left);
    const mixed = fade(this.data.slice(to, to + n), this.data.subarray(from, from + n));
    this.data.copyWithin(to, from, end);
    this.data.set(mixed, to);
    this.data.fill(0, to + left, end);
    const holding = this.holding(index);
    const after = this.knots.filter((knot) => knot.index > index).map((knot) => ({ ...knot, index: knot.index - index + start }));
    this.tie({ index: start, sample: sampleAt(holding, index), pace: holding.pace });
    this.knots.push(...after);
    this.end = start + left;
  }

  /** The sound has died away: nothing has to be bridged. */
  rest(): void {
    this.flows = false;
    this.falling = NOTHING;
  }

  /** Say a period twice (1) or leave one out (-1), as early as possible; null if that would be heard. */
  alter(way: -1 | 1): Change | null {
    const { most } = periods(this.rate);
    const start = this.fixed;
    const low = Math.max(this.base, start - most);
    const high = Math.min(this.end, start + 2 * most);
    if (high <= start || this.knots.some(({ index }) => low < index && index < high)) return null;
    const sound = this.data.subarray(low - this.base, high - this.base);
    const at = start - low;
    const { lag, quiet } = lagOf(sound, at, -way, this.rate);
    if (!lag) return null;
    const other = at - way * lag;
    this.splice(fade(sound.slice(at, at + lag), sound.subarray(other, other + lag)), start, way);
    return { samples: way * lag, quiet };
  }

  private splice(mixed: Sound, start: number, way: -1 | 1): void {
    const lag = mixed.length;
    const sample = sampleAt(this.holding(start), start);
    this.reserve(lag + this.reach);
    const at = start - this.base;
    const end = this.end - this.base;
    this.data.copyWithin(at + lag, at + (1 - way) * lag, end);
    this.data.set(mixed, at);
    this.end += way * lag;
    this.data.fill(0, this.end - this.base, Math.max(end, this.end - this.base));
    const before = this.knots.filter(({ index }) => index < start);
    const after = this.knots.filter(({ index }) => index > start).map((knot) => ({ ...knot, index: knot.index + way * lag }));
    const between = [
      { index: start, sample, pace: 1 - way },
      { index: start + lag, sample: sample + (1 - way) * lag, pace: 1 },
    ];
    this.knots = [...before, ...between, ...after];
  }

  /** The first place that has no part yet in what was heard. */
  private get fixed(): number {
    return this.at + this.reach;
  }

  private append(pcm: Sound): void {
    const n = Math.min(this.falling.length, pcm.length);
    pcm.set(fade(this.falling.slice(0, n), pcm.subarray(0, n), this.ramp - this.falling.length, this.ramp));
    this.falling = this.falling.slice(n); // a packet may be shorter than the ramp
    this.reserve(pcm.length + this.reach);
    this.data.set(pcm, this.end - this.base);
    this.end += pcm.length;
  }

  private leap(sample: number): void {
    if (this.falling.length < this.ramp && (this.end > this.at || this.flows)) this.falling = this.beyond(this.end);
    this.tie({ index: this.end, sample, pace: 1 });
  }

  /** What would be played from `index` on, made up where it is not known. */
  private beyond(index: number): Sound {
    const end = this.end - this.base;
    const known = this.data.subarray(index - this.base, Math.min(end, index - this.base + this.ramp));
    const further = fall(this.data.subarray(Math.max(0, end - this.past), end), this.rate, 2 * RAMP_S);
    const found = new Float32Array(this.ramp);
    found.set(further.subarray(0, this.ramp - known.length), known.length);
    found.set(known);
    return found;
  }

  private pass(): void {
    while (this.knots.length > 1 && this.knots[1].index <= this.at) this.knots.shift();
  }

  private tie(knot: Knot): void {
    while (this.knots.length && this.knots.at(-1)!.index >= knot.index) this.knots.pop();
    const last = this.knots.at(-1);
    const same = last?.pace === knot.pace && sampleAt(last, knot.index) === knot.sample;
    if (!same) this.knots.push(knot);
  }

  private holding(place: number): Knot {
    return this.knots.findLast(({ index }) => index <= place) ?? this.knots[0];
  }

  /** Where a sample lies in the line, or what follows the place where it is missing. */
  private find(sample: number): number {
    let { end } = this;
    for (let k = this.knots.length - 1; k >= 0; k--) {
      const knot = this.knots[k];
      if (knot.sample <= sample) return Math.min(end, knot.index + (knot.pace ? Math.floor((sample - knot.sample) / knot.pace) : 0));
      end = knot.index;
    }
    return this.at;
  }

  /** Room for `more` samples after the last, forgetting what was played long ago; zeros follow the signal. */
  private reserve(more: number): void {
    const used = this.end - this.base;
    if (used + more <= this.data.length) return;
    const keep = Math.max(0, this.at - this.past - this.base);
    const fresh = used + more - keep > this.data.length ? new Float32Array(2 * (used + more)) : this.data;
    fresh.set(this.data.subarray(keep, used));
    fresh.fill(0, used - keep);
    this.data = fresh;
    this.base += keep;
  }
}

/** How much may be left out ahead of `at` (way 1), or said again from behind it (-1), 0 for nothing; and is it quiet? */
function lagOf(sound: Sound, at: number, way: number, rate: number): { lag: number; quiet: boolean } {
  const { most } = periods(rate);
  const around = way > 0 ? sound.subarray(at) : sound.subarray(Math.max(0, at - most), at + most);
  const room = way > 0 ? Math.floor((sound.length - at) / 2) : Math.min(at, sound.length - at);
  if (room > 0 && isQuiet(around)) return { lag: Math.min(most, room), quiet: true };
  const { lag, alike } = period(sound, at, way, rate);
  return { lag: alike >= ALIKE ? lag : 0, quiet: false };
}
