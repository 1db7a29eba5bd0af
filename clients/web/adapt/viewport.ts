/** Which part of a photo is seen: from its pixels to the CSS pixels of the box it is shown in, and back. */

import type { Position, Size } from "./marks";

/** A photo's pixel (x, y) is seen at (scale x + shift). */
export interface Viewport {
  readonly scale: number;
  readonly shift: Position;
}

/** CSS pixels that a photo's pixel may have at most. */
const LARGEST = 24;
/** What is looked at fills one part in so many of the box. */
const ROOM = 1.35;

/** The whole photo, in the middle of the box. */
export function whole([width, height]: Size, [boxWidth, boxHeight]: Size): Viewport {
  const scale = Math.min(boxWidth / width, boxHeight / height);
  return { scale, shift: [(boxWidth - scale * width) / 2, (boxHeight - scale * height) / 2] };
}

export function toBox({ scale, shift }: Viewport, [x, y]: Position): Position {
  return [scale * x + shift[0], scale * y + shift[1]];
}

export function toPhoto({ scale, shift }: Viewport, [x, y]: Position): Position {
  return [(x - shift[0]) / scale, (y - shift[1]) / scale];
}

/** As large as `places` with some room round them can be seen; all of the photo if there are none. */
export function round(places: readonly Position[], photo: Size, box: Size): Viewport {
  const fit = whole(photo, box);
  if (!places.length) return fit;
  const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((k) => pick(...places.map((at) => at[k]))));
  const span = [0, 1].map((k) => Math.max(1, (high[k] - low[k]) * ROOM));
  const scale = Math.min(LARGEST, Math.max(fit.scale, Math.min(box[0] / span[0], box[1] / span[1])));
  const shift = [0, 1].map((k) => box[k] / 2 - (scale * (low[k] + high[k])) / 2);
  return kept({ scale, shift: [shift[0], shift[1]] }, photo, box);
}

/** Larger by `factor`; what is at `at` in the box stays there, as far as the photo still fills the box. */
export function zoomed(port: Viewport, factor: number, at: Position, photo: Size, box: Size): Viewport {
  const least = whole(photo, box).scale;
  const scale = Math.min(Math.max(LARGEST, least), Math.max(least, port.scale * factor));
  const ratio = scale / port.scale;
  const shift: Position = [at[0] - ratio * (at[0] - port.shift[0]), at[1] - ratio * (at[1] - port.shift[1])];
  return kept({ scale, shift }, photo, box);
}

export function panned({ scale, shift }: Viewport, [dx, dy]: Position, photo: Size, box: Size): Viewport {
  return kept({ scale, shift: [shift[0] + dx, shift[1] + dy] }, photo, box);
}

/** A pan just far enough that the photo's pixel `at` lies at least `margin` within the box. */
export function showing(port: Viewport, at: Position, margin: number, photo: Size, box: Size): Viewport {
  const seen = toBox(port, at);
  const by = seen.map((x, k) => Math.max(0, margin - x) - Math.max(0, x - (box[k] - margin)));
  return panned(port, [by[0], by[1]], photo, box);
}

/** The same part in a box of another size. */
export function resized(port: Viewport, before: Size, photo: Size, box: Size): Viewport {
  const scale = (port.scale / whole(photo, before).scale) * whole(photo, box).scale;
  const middle = toPhoto(port, [before[0] / 2, before[1] / 2]);
  return kept({ scale, shift: [box[0] / 2 - scale * middle[0], box[1] / 2 - scale * middle[1]] }, photo, box);
}

/** No gap where the photo is larger than the box, and the middle where it is smaller. */
function kept({ scale, shift }: Viewport, photo: Size, box: Size): Viewport {
  const held = shift.map((at, k) => {
    const room = box[k] - scale * photo[k];
    return room >= 0 ? room / 2 : Math.min(0, Math.max(room, at));
  });
  return { scale, shift: [held[0], held[1]] };
}
