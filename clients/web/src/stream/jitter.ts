/**
 * How much sound has to be in store, from when packets arrive. Twin of fapstream/stream/jitter.py, which says more.
 * Times are seconds; arrivals are counted on the sound card's own clock.
 */

/** A packet and a little: with less in store a packet that is on time comes too late. */
export const FLOOR_S = 0.05;
/** More is never waited for: a server sends at most 1.5 s ahead. */
export const MOST_S = 1.2;
const WINDOW_S = 20;
/** Of the lateness in the window. The latest alone does not count: one stall is no habit. */
const QUANTILE = 0.995;
/** One underrun lets the target grow by no more than this; and by so much more than what was missing. */
const GROW_S = 0.2;
const MARGIN_S = 0.02;
const DECAY_S = 60;
/** A packet that comes within this part of its own duration after the one before waited with it. */
const BURST = 0.5;
/** A store may lie above and below the target by so much; together more than one pitch period. */
const SLACK_S = 0.02;
const LACK_S = 0.005;

/** Lateness of packets against the earliest ones, and `targetS`, which follows from it. */
export class Jitter {
  targetS = FLOOR_S;
  /** [arrival, arrival - end], the second ascending: the first is the window's least. */
  private readonly earliest: [number, number][] = [];
  /** [arrival, lateness] of what came first in its burst. */
  private readonly events: [number, number][] = [];
  private readonly sorted: number[] = [];
  private last: { end: number; arrival: number } | null = null;
  private eased: number | null = null;

  /** The sender's clock has been stopped or turned: what comes next is on time. */
  restart(): void {
    this.earliest.length = 0;
    this.last = null;
  }

  /** A packet that was sent in real time ends at `endS` of the talk. How late it is, s. */
  observe(endS: number, arrivalS: number): number {
    const late = this.lateness(arrivalS, arrivalS - endS);
    const { last } = this;
    this.last = { end: endS, arrival: arrivalS };
    if (!last || arrivalS - last.arrival >= BURST * (endS - last.end)) this.count(arrivalS, late);
    this.ease(arrivalS);
    return late;
  }

  /** The sound had been dry for `dryS` when it came: so much would just have been enough. */
  underrun(dryS: number): void {
    this.targetS = Math.min(MOST_S, this.targetS + Math.min(dryS + MARGIN_S, GROW_S));
  }

  /** The target rises to what the window asks for, and comes down slowly. */
  ease(nowS: number): void {
    const quantile = this.sorted[Math.floor(QUANTILE * (this.sorted.length - 1))] ?? 0;
    const aim = Math.min(MOST_S, FLOOR_S + quantile);
    const since = this.eased === null ? 0 : Math.max(0, nowS - this.eased);
    this.eased = nowS;
    const excess = this.targetS - aim;
    this.targetS = excess <= 0 ? aim : this.targetS - excess * Math.min(1, since / DECAY_S);
  }

  private lateness(arrival: number, offset: number): number {
    const { earliest } = this;
    while (earliest.length && earliest.at(-1)![1] >= offset) earliest.pop();
    earliest.push([arrival, offset]);
    while (earliest[0][0] < arrival - WINDOW_S) earliest.shift();
    return offset - earliest[0][1];
  }

  private count(arrival: number, late: number): void {
    this.events.push([arrival, late]);
    this.sorted.splice(place(this.sorted, late), 0, late);
    while (this.events[0][0] < arrival - WINDOW_S) this.sorted.splice(place(this.sorted, this.events.shift()![1]), 1);
  }
}

/** Where `value` belongs in what is sorted, before its equals. */
function place(sorted: number[], value: number): number {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * What a live talk's store wants: -1 to shrink, 1 to grow, 0 nothing. `levelS` is the store right after a packet plus
 * that packet's lateness: no jitter is in it.
 */
export function steer(levelS: number, targetS: number): -1 | 0 | 1 {
  if (levelS > targetS + SLACK_S) return -1;
  return levelS < targetS - LACK_S ? 1 : 0;
}
