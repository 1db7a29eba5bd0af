/**
 * FAP frames as packets carry them: what has changed since the frame before, and a whole face now and then
 * (protocol/SPEC.md, 3.2).
 */

import { ProtocolError } from "./codec";
import type { Packet } from "./generated";

export type Changes = Pick<Packet, "key" | "mask" | "faps" | "wide">;

/** Changes of one turn in, frames of `channels` values out. */
export class FapDecoder {
  private shown: Int32Array;

  constructor(private readonly channels: number) {
    this.shown = new Int32Array(channels);
  }

  /** Throws ProtocolError, and changes nothing, if mask and values do not agree. */
  decode({ key, mask, faps, wide }: Changes): Int32Array[] {
    const width = Math.ceil(this.channels / 8);
    const bits = mask ?? new Uint8Array(0);
    const values = faps ?? wide ?? new Int16Array(0);
    if (faps && wide) throw new ProtocolError("a packet has either `faps` or `wide`");
    if (bits.length % width) throw new ProtocolError(`a mask of ${bits.length} bytes is no frames of ${this.channels} channels`);
    const rows: Int32Array[] = [];
    let shown = key ? new Int32Array(this.channels) : this.shown;
    let used = 0;
    for (let at = 0; at < bits.length; at += width) {
      shown = shown.slice();
      for (let channel = 0; channel < 8 * width; channel++) {
        if (!((bits[at + (channel >> 3)] >> (channel & 7)) & 1)) continue;
        if (channel >= this.channels) throw new ProtocolError(`the mask names channels beyond ${this.channels}`);
        if (used < values.length) shown[channel] = values[used];
        used++;
      }
      rows.push(shown);
    }
    if (used !== values.length) throw new ProtocolError(`the mask wants ${used} FAP values, there are ${values.length}`);
    this.shown = shown;
    return rows;
  }
}
