/** The points of both photos, and how they came about: every change can be undone. */

import { scaled, type Mark, type Marks, type Position, type Size, type ViewName } from "./marks";

export type State = Readonly<Record<ViewName, Marks>>;

export class Points {
  private now: State = { front: new Map(), profile: new Map() };
  private past: State[] = [];
  private future: State[] = [];
  private stroke: number | null = null;

  get state(): State {
    return this.now;
  }

  get undoable(): boolean {
    return this.past.length > 0;
  }

  get redoable(): boolean {
    return this.future.length > 0;
  }

  /** Put points where a hand wants them. Moves with the same `stroke`, one after the other, are one step. */
  move(view: ViewName, places: ReadonlyMap<string, Position>, stroke: number): void {
    const moved = [...places].map(([name, at]): [string, Mark] => [name, { at }]);
    this.change(view, new Map([...this.now[view], ...moved]), stroke);
  }

  /** Leave a point to the fit again. */
  remove(view: ViewName, name: string): void {
    const left = new Map(this.now[view]);
    if (left.delete(name)) this.change(view, left, null);
  }

  /** Other points altogether: found in a new photo, or read from a file. The first ones there are cannot be undone. */
  replace(view: ViewName, marks: Marks): void {
    if (this.now[view].size) return this.change(view, marks, null);
    const filled = (state: State): State => (state[view].size ? state : { ...state, [view]: marks });
    this.now = filled(this.now);
    this.past = this.past.map(filled);
    this.future = [];
  }

  /** The photo has another size than the one before: what was, and will be redone, moves along. */
  rescale(view: ViewName, from: Size, to: Size): void {
    const moved = (state: State): State => ({ ...state, [view]: scaled(state[view], from, to) });
    this.now = moved(this.now);
    this.past = this.past.map(moved);
    this.future = this.future.map(moved);
  }

  undo(): void {
    this.step(this.past, this.future);
  }

  redo(): void {
    this.step(this.future, this.past);
  }

  private change(view: ViewName, marks: Marks, stroke: number | null): void {
    if (stroke === null || stroke !== this.stroke) this.past.push(this.now);
    this.now = { ...this.now, [view]: marks };
    this.future = [];
    this.stroke = stroke;
  }

  private step(from: State[], to: State[]): void {
    const state = from.pop();
    if (!state) return;
    to.push(this.now);
    this.now = state;
    this.stroke = null;
  }
}
