/** What was sent and may have to be sent again when the connection is lost. */

export class Sent {
  /** Counted messages sent in all. */
  count = 0;
  private bytes = 0;
  private readonly kept: Uint8Array<ArrayBuffer>[] = [];

  append(data: Uint8Array<ArrayBuffer>): void {
    this.count++;
    this.bytes += data.length;
    this.kept.push(data);
  }

  /** The other side has so many. A number that cannot be is clamped. */
  forget(received: number): void {
    while (this.kept.length && this.count - this.kept.length < received) this.drop();
  }

  /** Keep no more than so many bytes; the oldest go first. */
  shrink(most: number): void {
    while (this.kept.length && this.bytes > most) this.drop();
  }

  /** The messages after number `received`; null if they are kept no longer, or there are not so many. */
  after(received: number): Uint8Array<ArrayBuffer>[] | null {
    const missing = this.count - received;
    return missing < 0 || missing > this.kept.length ? null : this.kept.slice(this.kept.length - missing);
  }

  private drop(): void {
    this.bytes -= this.kept.shift()!.length;
  }
}
