/** What of a caption has been said: marks in, as they are heard, and three pieces of text out. */

export interface CaptionMark {
  text: string;
  char_start?: number;
  char_end?: number;
}

/** `said` + `word` + `ahead` is the caption; nothing of `ahead` has been heard. */
export interface CaptionView {
  said: string;
  word: string;
  ahead: string;
}

const NOTHING: CaptionView = { said: "", word: "", ahead: "" };

export class Captions {
  view: CaptionView = NOTHING;
  /** The caption in code points, and where in it the last word ended. */
  private text: string[] = [];
  private start: number | undefined;
  private at = 0;

  clear(): void {
    this.view = NOTHING;
    this.text = [];
    this.at = 0;
  }

  caption({ text, char_start }: CaptionMark): void {
    this.text = [...text];
    this.start = char_start;
    this.at = 0;
    this.view = { said: "", word: "", ahead: text };
  }

  /** A word has begun. One that the caption does not hold is added to it. */
  word({ text, char_start }: CaptionMark): void {
    let from = this.find(text, char_start);
    if (from < 0) {
      if (this.text.length) this.text.push(" ");
      from = this.text.length;
      this.text.push(...text);
    }
    this.at = Math.max(this.at, from + [...text].length);
    const slice = (a: number, b?: number) => this.text.slice(a, b).join("");
    this.view = { said: slice(0, from), word: slice(from, this.at), ahead: slice(this.at) };
  }

  private find(text: string, start: number | undefined): number {
    const word = [...text];
    const same = (at: number) => at >= 0 && word.every((c, i) => this.text[at + i] === c);
    const offset = start === undefined || this.start === undefined ? -1 : start - this.start;
    if (same(offset)) return offset;
    for (let at = this.at; at + word.length <= this.text.length; at++) if (same(at)) return at;
    return -1;
  }
}
