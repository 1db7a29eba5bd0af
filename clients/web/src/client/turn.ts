/** One thing said, as the page holds it: text goes in, promises say how far it got. */

import type { Begin, Done } from "../protocol/generated";

export interface SpeakOptions {
  lang?: string | undefined;
  voice?: string | undefined;
  /** 1 is the voice's own speed, 2 twice as fast. */
  rate?: number | undefined;
  /** 1 is the voice's own pitch. */
  pitch?: number | undefined;
  /** 1 is the voice's own loudness. */
  volume?: number | undefined;
  /** Words after a word that the server waits for before it speaks it; absent for the server's default. */
  lookAhead?: number | undefined;
  /** Keep the turn open for `append`; `end` closes it. */
  open?: boolean | undefined;
}

/** How a turn ended. `heard` (samples) and `char` (code points of the text) tell how far an interrupted one got. */
export interface TurnEnd {
  turn: number;
  reason: Done["reason"];
  samples: number;
  heard?: number;
  char?: number;
}

/** What a server or a turn could not do; `code` is one of protocol/schema/errors.json, or of this client. */
export class HeadFault extends Error {
  constructor(readonly code: string, message: string, readonly fatal = false, readonly turn?: number) {
    super(message);
    this.name = "HeadFault";
  }
}

/** What a turn asks of the conversation it belongs to. */
export interface TurnDesk {
  append(turn: Turn, bytes: Uint8Array): void;
  feed(turn: Turn, pcm: Int16Array): void;
  end(turn: Turn): void;
  interrupt(turn: Turn): Promise<TurnEnd>;
  splice(turn: Turn, char: number): void;
  seek(turn: Turn, back: number): void;
  pause(turn: Turn, on: boolean): void;
}

/** Awaiting a turn waits until it has been heard to its end. */
export class Turn implements PromiseLike<TurnEnd> {
  /** Fulfilled when its first sample is heard. */
  readonly started: Promise<Begin>;
  /** Fulfilled when it has been heard to its end or was interrupted; rejected with a HeadFault if it failed. */
  readonly finished: Promise<TurnEnd>;
  open = true;
  /** When its first text was handed in, ms. */
  askedAt: number | undefined;
  private readonly writer = new Utf8Writer();
  private readonly begun = deferred<Begin>();
  private readonly ended = deferred<TurnEnd>();

  constructor(readonly id: number, readonly options: SpeakOptions, private readonly desk: TurnDesk) {
    this.started = this.begun.promise;
    this.finished = this.ended.promise;
    this.started.catch(() => undefined);
    this.finished.catch(() => undefined);
  }

  /** More of the text; it may be cut anywhere. Throws a HeadFault once the text has ended. */
  append(text: string): this {
    if (!this.open) throw new HeadFault("turn_ended", `the text of turn ${this.id} has ended`, false, this.id);
    this.desk.append(this, this.writer.write(text));
    return this;
  }

  /** The text is complete. */
  end(): this {
    if (!this.open) return this;
    const rest = this.writer.flush();
    if (rest.length) this.desk.append(this, rest);
    this.open = false;
    this.desk.end(this);
    return this;
  }

  /** Stop saying it. */
  interrupt(): Promise<TurnEnd> {
    return this.desk.interrupt(this);
  }

  /**
   * Revise the text: its first `char` code points stay, what follows is dropped as far as it was not heard, and `text`
   * comes instead; more may be appended. An `end` before it is undone.
   */
  splice(char: number, text: string): this {
    this.writer.flush();
    this.open = true;
    this.desk.splice(this, char);
    return this.append(text);
  }

  /** Say it again from the beginning of the sentence being heard (0), or so many sentences before it. */
  seek(back = 1): this {
    this.desk.seek(this, back);
    return this;
  }

  /** Stop where it is. */
  pause(): this {
    this.desk.pause(this, true);
    return this;
  }

  /** Go on after a pause. */
  continue(): this {
    this.desk.pause(this, false);
    return this;
  }

  then<A = TurnEnd, B = never>(
    done?: ((end: TurnEnd) => A | PromiseLike<A>) | null, failed?: ((reason: unknown) => B | PromiseLike<B>) | null,
  ): Promise<A | B> {
    return this.finished.then(done, failed);
  }

  /** For the conversation: it is heard from now on. */
  settleStart(begin: Begin): void {
    this.begun.resolve(begin);
  }

  /** For the conversation: it is over. */
  settle(end: TurnEnd | HeadFault): void {
    this.open = false;
    if (end instanceof HeadFault) {
      this.begun.reject(end);
      this.ended.reject(end);
    } else {
      this.begun.reject(new HeadFault("turn_ended", `turn ${this.id} ended before it was heard`, false, this.id));
      this.ended.resolve(end);
    }
  }
}

/** A turn that somebody speaks himself: fed with sound, which the head says. It has no text to append to, to revise or to seek in. */
export class OwnTurn extends Turn {
  constructor(id: number, private readonly to: TurnDesk) {
    super(id, {}, to);
  }

  /** More sound, at the rate with which the turn was opened. Throws a HeadFault once it has ended. */
  feed(pcm: Int16Array): this {
    if (!this.open) throw new HeadFault("turn_ended", `the sound of turn ${this.id} has ended`, false, this.id);
    this.to.feed(this, pcm);
    return this;
  }

  override append(): never {
    throw new HeadFault("no_text", `turn ${this.id} is sound and takes no text`, false, this.id);
  }

  override splice(): never {
    return this.append();
  }

  override seek(): never {
    return this.append();
  }
}

function deferred<T>() {
  let resolve!: (value: T) => void;
  let reject!: (reason: unknown) => void;
  const promise = new Promise<T>((yes, no) => ([resolve, reject] = [yes, no]));
  return { promise, resolve, reject };
}

/** Text to UTF-8, keeping back half a surrogate pair until its other half comes. */
class Utf8Writer {
  private half = "";
  private readonly encoder = new TextEncoder();

  write(text: string): Uint8Array {
    const all = this.half + text;
    const cut = /[\uD800-\uDBFF]$/.test(all) ? all.length - 1 : all.length;
    this.half = all.slice(cut);
    return this.encoder.encode(all.slice(0, cut));
  }

  flush(): Uint8Array {
    return this.encoder.encode(this.half);
  }
}
