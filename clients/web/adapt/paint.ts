/** Draws a photo and what lies over it. Lengths are CSS pixels of the box; colours have to do on every photo. */

import type { Mark, Marks, Position, Size } from "./marks";
import { toBox, type Viewport } from "./viewport";
import type { Laid } from "./wire";

export const COLOURS = { hand: "#2f7bff", found: "#ffb020", guess: "#ffffff", wrong: "#ff4d4d", wire: "#5cb4ff", rim: "rgb(8 14 22 / .75)" };

const DOT = 4.5;
const LARGE_DOT = 6.5;
/** An error of fewer of the photo's pixels is not worth a line. */
const LEAST_ERROR = 2;
const LOUPE = 62;
/** From the point to the loupe's rim. */
const LOUPE_GAP = 26;
/** How much larger the loupe shows the photo than the view does, and CSS pixels for one of the photo's at least. */
const LOUPE_FACTOR = 2.5;
const LOUPE_LEAST = 1.5;

export interface Scene {
  picture: ImageBitmap;
  port: Viewport;
  box: Size;
  marks: Marks;
  laid: Laid | null;
  /** Is the wireframe the fitted head, or only something to begin with? */
  fitted: boolean;
  edges: Uint16Array | null;
  /** The points drawn larger. */
  selected: string | null;
  hovered: string | null;
}

type Context = CanvasRenderingContext2D;

/** What seldom changes: the photo and the wireframe. */
export function paintGround(context: Context, { picture, port, box, laid, fitted, edges }: Scene): void {
  context.clearRect(0, 0, ...box);
  paintPicture(context, picture, port);
  if (!laid || !edges) return;
  context.globalAlpha = fitted ? 0.5 : 0.3;
  context.strokeStyle = COLOURS.wire;
  context.lineWidth = 0.7;
  context.stroke(wireframe(laid.mesh, edges, port, box));
  context.globalAlpha = 1;
}

function paintPicture(context: Context, picture: ImageBitmap, { scale, shift }: Viewport): void {
  context.imageSmoothingEnabled = scale < 8;
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, ...shift, picture.width * scale, picture.height * scale);
}

/** The edges of `mesh` that may be seen. */
function wireframe(mesh: Float32Array, edges: Uint16Array, { scale, shift: [dx, dy] }: Viewport, [width, height]: Size): Path2D {
  const path = new Path2D();
  for (let e = 0; e < edges.length; e += 2) {
    const [a, b] = [2 * edges[e], 2 * edges[e + 1]];
    const [ax, ay, bx, by] = [scale * mesh[a] + dx, scale * mesh[a + 1] + dy, scale * mesh[b] + dx, scale * mesh[b + 1] + dy];
    if (Math.max(ax, bx) < 0 || Math.max(ay, by) < 0 || Math.min(ax, bx) > width || Math.min(ay, by) > height) continue;
    path.moveTo(ax, ay);
    path.lineTo(bx, by);
  }
  return path;
}

/** Guesses lie under what was found, that under what a hand placed, and the selected point on top. */
export function paintPoints(context: Context, scene: Scene): void {
  const { marks, laid, selected, hovered } = scene;
  for (const [name, mark] of marks) paintError(context, scene, mark, laid?.points.get(name));
  for (const [name, at] of laid?.points ?? []) if (!marks.has(name)) paintPoint(context, scene, at, null, name === hovered);
  const sure = ({ confidence }: Mark) => confidence ?? 2;
  const ordered = [...marks].sort(([, a], [, b]) => sure(a) - sure(b));
  for (const [name, mark] of ordered) paintPoint(context, scene, mark.at, mark, name === hovered);
  const chosen = selected && (marks.get(selected)?.at ?? laid?.points.get(selected));
  if (chosen) paintPoint(context, scene, chosen, marks.get(selected) ?? null, true, true);
}

function paintError(context: Context, { port }: Scene, { at }: Mark, fitted: Position | undefined): void {
  if (!fitted || Math.hypot(at[0] - fitted[0], at[1] - fitted[1]) <= LEAST_ERROR) return;
  context.beginPath();
  context.moveTo(...toBox(port, at));
  context.lineTo(...toBox(port, fitted));
  stroke(context, COLOURS.rim, 3);
  stroke(context, COLOURS.wrong, 1.6);
}

function paintPoint(context: Context, { port }: Scene, at: Position, mark: Mark | null, large: boolean, selected = false): void {
  const [x, y] = toBox(port, at);
  const radius = large ? LARGE_DOT : DOT;
  circle(context, x, y, radius);
  stroke(context, COLOURS.rim, mark ? 2.6 : 3.4);
  if (mark) fill(context, mark.confidence === undefined ? COLOURS.hand : COLOURS.found, opacity(mark));
  stroke(context, COLOURS.guess, mark ? 1.1 : 1.5, mark || large ? 1 : 0.85);
  if (!selected) return;
  circle(context, x, y, radius + 4);
  stroke(context, COLOURS.rim, 3.4);
  stroke(context, COLOURS.guess, 1.6);
}

function opacity({ confidence = 1 }: Mark): number {
  return 0.2 + 0.8 * Math.min(1, Math.max(0, confidence));
}

/** What is round the photo's pixel `at`, magnified, where the finger does not hide it. */
export function paintLoupe(context: Context, scene: Scene, at: Position): void {
  const { picture, port, box, marks } = scene;
  const [x, y] = loupePlace(toBox(port, at), box);
  const scale = Math.max(LOUPE_LEAST, port.scale * LOUPE_FACTOR);
  const near: Viewport = { scale, shift: [x - scale * at[0], y - scale * at[1]] };
  context.save();
  circle(context, x, y, LOUPE);
  context.fillStyle = "#000";
  context.fill();
  context.clip();
  paintPicture(context, picture, near);
  for (const { at: other } of marks.values()) {
    if (other === at) continue;
    circle(context, ...toBox(near, other), DOT);
    stroke(context, COLOURS.guess, 1, 0.7);
  }
  paintCross(context, x, y);
  context.restore();
  circle(context, x, y, LOUPE);
  stroke(context, COLOURS.rim, 5);
  stroke(context, COLOURS.guess, 2.5);
}

/** Above the point if there is room, else beside it, else below. */
function loupePlace([x, y]: Position, [width, height]: Size): Position {
  const off = LOUPE + LOUPE_GAP;
  const places: Position[] = [[x, y - off], [x + off, y], [x - off, y], [x, y + off]];
  const fits = ([px, py]: Position) => px >= LOUPE && py >= LOUPE && px <= width - LOUPE && py <= height - LOUPE;
  return places.find(fits) ?? places[0];
}

function paintCross(context: Context, x: number, y: number): void {
  context.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 5 * dx, y + 5 * dy);
    context.lineTo(x + LOUPE * dx, y + LOUPE * dy);
  }
  stroke(context, COLOURS.rim, 2.4, 0.6);
  stroke(context, COLOURS.guess, 1);
}

function circle(context: Context, x: number, y: number, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

function stroke(context: Context, colour: string, width: number, alpha = 1): void {
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
  context.globalAlpha = 1;
}

function fill(context: Context, colour: string, alpha: number): void {
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  context.fill();
  context.globalAlpha = 1;
}
