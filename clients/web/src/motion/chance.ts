/** Chance that can be asked again, as fapstream/motion/chance.py has it: numbers that follow from (seed, channel, index). */

export interface Law {
  median: number;
  sigma: number;
  least: number;
  most: number;
}

/** A number in [0, 1). */
export function uniform(seed: number, channel: number, index: number): number {
  return stir(index + stir(channel + stir(seed))) / 2 ** 32;
}

/** A number of mean 0 and variance 1 (Box and Muller 1958). */
export function normal(seed: number, channel: number, index: number): number {
  const radius = Math.sqrt(-2 * Math.log(1 - uniform(seed, channel, 2 * index)));
  return radius * Math.cos(2 * Math.PI * uniform(seed, channel, 2 * index + 1));
}

/** A number whose logarithm is normal, kept within `least` and `most`. */
export function logNormal(seed: number, channel: number, index: number, law: Law): number {
  const value = law.median * Math.exp(law.sigma * normal(seed, channel, index));
  return Math.min(Math.max(value, law.least), law.most);
}

/** Smooth noise within [-1, 1]: one random value at each integer, quintic between (Perlin 2002). */
export function noise(seed: number, channel: number, at: number): number {
  const cell = Math.floor(at);
  const a = 2 * uniform(seed, channel, cell) - 1;
  const b = 2 * uniform(seed, channel, cell + 1) - 1;
  return a + (b - a) * minimumJerk(at - cell);
}

/** From 0 at 0 to 1 at 1, held beyond (Flash and Hogan 1985). */
export function minimumJerk(x: number): number {
  const t = Math.min(1, Math.max(0, x));
  return t * t * t * (10 - 15 * t + 6 * t * t);
}

/** Instants in seconds, event k+1 following event k by gap(k); event 0 is one second before 0. Going back starts over. */
export class Events {
  private k = 0;
  private start = -1;
  private next: number;

  constructor(private readonly gap: (k: number) => number) {
    this.next = this.start + gap(0);
  }

  /** The newest event at `t` >= -1 s: its number, and how long ago it was. */
  at(t: number): [k: number, since: number] {
    if (t < this.start) {
      [this.k, this.start] = [0, -1];
      this.next = this.start + this.gap(0);
    }
    while (this.next <= t) {
      this.k++;
      this.start = this.next;
      this.next += this.gap(this.k);
    }
    return [this.k, t - this.start];
  }
}

/** MurmurHash3's finaliser (Appleby, public domain). */
function stir(key: number): number {
  let h = (key + 0x9e3779b9) | 0;
  h = Math.imul(h ^ (h >>> 16), 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 13), 0xc2b2ae35);
  return (h ^ (h >>> 16)) >>> 0;
}
