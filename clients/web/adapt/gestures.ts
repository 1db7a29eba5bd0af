/** Fingers, pens, mice and wheels on a photo, told as what they mean. Places are CSS pixels of the box. */

import type { Position } from "./marks";

export interface Gestures {
  /** Take hold of the point within `reach` of `at`; false if there is none. */
  grab(at: Position, reach: number): boolean;
  drag(to: Position): void;
  drop(): void;
  hover(at: Position | null): void;
  pan(by: Position): void;
  zoom(factor: number, at: Position): void;
  reset(): void;
}

/** How near a mouse has to be to a point. */
export const REACH = 12;
const TOUCH_REACH = 24;
/** A hand that shakes so little does not drag. */
const STILL = 3;
const WHEEL = 0.0015;

/** Listen to `canvas`. One pointer drags a point or else the photo, two zoom. */
export function listen(canvas: HTMLCanvasElement, told: Gestures): void {
  const pointers = new Map<number, Position>();
  let held = false;
  let from: Position | null = null;

  const place = ({ clientX, clientY }: MouseEvent): Position => {
    const { left, top } = canvas.getBoundingClientRect();
    return [clientX - left - canvas.clientLeft, clientY - top - canvas.clientTop];
  };
  const letGo = () => {
    if (held) told.drop();
    held = false;
  };

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    letGo();
    if (pointers.size > 1) return;
    from = place(event);
    held = told.grab(from, event.pointerType === "touch" ? TOUCH_REACH : REACH);
  });
  canvas.addEventListener("pointermove", (event) => {
    const [at, last] = [place(event), pointers.get(event.pointerId)];
    if (!last) return told.hover(at);
    pointers.set(event.pointerId, at);
    if (pointers.size > 1) return pinch(pointers, event.pointerId, last, told);
    if (!held) return told.pan([at[0] - last[0], at[1] - last[1]]);
    if (from && distance(at, from) < STILL) return;
    from = null;
    told.drag(at);
  });
  for (const end of ["pointerup", "pointercancel"] as const) {
    canvas.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      letGo();
    });
  }
  canvas.addEventListener("pointerleave", () => told.hover(null));
  canvas.addEventListener("dblclick", () => told.reset());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
    told.zoom(Math.exp(-event.deltaY * lines * WHEEL * (event.ctrlKey ? 5 : 1)), place(event));
  }, { passive: false });
}

/** One of two fingers has moved: the photo follows both. */
function pinch(pointers: ReadonlyMap<number, Position>, id: number, last: Position, told: Gestures): void {
  const now = pointers.get(id)!;
  const [, other] = [...pointers].find(([key]) => key !== id)!;
  const [before, after] = [middle(last, other), middle(now, other)];
  told.pan([after[0] - before[0], after[1] - before[1]]);
  told.zoom(distance(now, other) / Math.max(1, distance(last, other)), after);
}

function middle([ax, ay]: Position, [bx, by]: Position): Position {
  return [(ax + bx) / 2, (ay + by) / 2];
}

export function distance([ax, ay]: Position, [bx, by]: Position): number {
  return Math.hypot(ax - bx, ay - by);
}
