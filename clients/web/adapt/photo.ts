/** One photo on its canvas: what is seen of it, which point is selected, and what hands and keys do to points. */

import { distance, listen, REACH } from "./gestures";
import { within, type FeaturePoint, type Mark, type Marks, type Position, type Size } from "./marks";
import { paintGround, paintLoupe, paintPoints, type Scene } from "./paint";
import { panned, resized, round, showing, toBox, toPhoto, whole, zoomed, type Viewport } from "./viewport";
import type { Laid } from "./wire";

const STEP = 1;
const LONG_STEP = 10;
const SHORT_STEP = 0.25;
const ZOOM = 1.4;
/** How near to the edge of the box a selected point may be. */
const MARGIN = 48;
const MOST_PIXELS = 2;
const ARROWS: Record<string, Position> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export interface PhotoEvents {
  /** A point is to be at `at`. Moves with the same `stroke` are one. */
  move(name: string, at: Position, stroke: number): void;
  remove(name: string): void;
}

/** Strokes are counted over all photos. */
let strokes = 0;

export class PhotoView {
  private readonly context: CanvasRenderingContext2D;
  private readonly ground = document.createElement("canvas").getContext("2d")!;
  private picture: ImageBitmap | null = null;
  private box: Size = [1, 1];
  private port: Viewport | null = null;
  private marks: Marks = new Map();
  private laid: Laid | null = null;
  private fitted = false;
  private edges: Uint16Array | null = null;
  private selected: string | null = null;
  private hovered: string | null = null;
  /** The point in the hand, and how far from it the hand took hold. */
  private held: { name: string; off: Position; moved: boolean } | null = null;
  /** Nobody has moved or zoomed the photo: it shows the face as soon as that is known. */
  private untouched = true;
  private stale = true;
  private request = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement, private readonly tag: HTMLElement,
    private readonly features: () => readonly FeaturePoint[], private readonly events: PhotoEvents,
  ) {
    this.context = canvas.getContext("2d")!;
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("keydown", (event) => this.key(event));
    listen(canvas, {
      grab: (at, reach) => this.grab(at, reach),
      drag: (to) => this.drag(to),
      drop: () => this.drop(),
      hover: (at) => this.hover(at),
      pan: (by) => this.handle((port, size) => panned(port, by, size, this.box)),
      zoom: (factor, at) => this.zoom(factor, at),
      reset: () => this.reset(),
    });
  }

  // --- what is to be seen

  show(picture: ImageBitmap): void {
    this.picture?.close();
    this.picture = picture;
    this.reset();
  }

  lay(laid: Laid | null, fitted: boolean): void {
    this.laid = laid;
    this.fitted = fitted;
    if (this.untouched) this.reset();
    else this.redraw();
  }

  mark(marks: Marks): void {
    this.marks = marks;
    this.draw();
  }

  /** The wireframe's edges; null hides it. */
  wire(edges: Uint16Array | null): void {
    this.edges = edges;
    this.redraw();
  }

  zoom(factor: number, at: Position = [this.box[0] / 2, this.box[1] / 2]): void {
    this.handle((port, size) => zoomed(port, factor, at, size, this.box));
  }

  /** The face, or all of the photo as long as there is none. */
  reset(): void {
    this.untouched = true;
    const places = this.laid ? this.names.map((name) => this.placeOf(name)!) : [];
    this.look((_, size) => round(places, size, this.box));
  }

  private get size(): Size | null {
    return this.picture && [this.picture.width, this.picture.height];
  }

  private handle(change: (port: Viewport, size: Size) => Viewport): void {
    this.untouched = false;
    this.look(change);
  }

  private look(change: (port: Viewport, size: Size) => Viewport): void {
    if (!this.size) return;
    this.port = change(this.port ?? whole(this.size, this.box), this.size);
    this.redraw();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return;
    const before = this.box;
    this.box = [clientWidth, clientHeight];
    const ratio = Math.min(MOST_PIXELS, devicePixelRatio || 1);
    for (const { canvas } of [this.context, this.ground]) {
      canvas.width = Math.round(clientWidth * ratio);
      canvas.height = Math.round(clientHeight * ratio);
    }
    for (const context of [this.context, this.ground]) context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (this.untouched) this.reset();
    else this.look((port, size) => resized(port, before, size, this.box));
  }

  // --- hands

  private grab(at: Position, reach: number): boolean {
    const name = this.nearest(at, reach);
    if (!name) return false;
    const [x, y] = toBox(this.port!, this.placeOf(name)!);
    this.held = { name, off: [x - at[0], y - at[1]], moved: false };
    this.untouched = false;
    strokes++;
    this.select(name);
    return true;
  }

  private drag([x, y]: Position): void {
    const { held } = this;
    if (!held) return;
    held.moved = true;
    this.move(held.name, toPhoto(this.port!, [x + held.off[0], y + held.off[1]]));
  }

  private drop(): void {
    this.held = null;
    this.draw();
  }

  private hover(at: Position | null): void {
    const name = at && this.nearest(at, REACH);
    this.canvas.classList.toggle("over", name !== null);
    if (name === this.hovered) return;
    this.hovered = name;
    this.draw();
  }

  private nearest(at: Position, reach: number): string | null {
    if (!this.port) return null;
    const near = this.names
      .map((name) => ({ name, off: distance(at, toBox(this.port!, this.placeOf(name)!)) }))
      .filter(({ off }) => off <= reach)
      .sort((a, b) => a.off - b.off);
    return near[0]?.name ?? null;
  }

  // --- keys

  private key(event: KeyboardEvent): void {
    const combined = event.metaKey || (event.ctrlKey && !event.getModifierState("AltGraph"));
    if (combined || !this.picture) return;
    const arrow = ARROWS[event.key];
    if (arrow ? this.nudge(arrow, event) : this.command(event)) event.preventDefault();
  }

  private nudge([dx, dy]: Position, { shiftKey, altKey, repeat }: KeyboardEvent): boolean {
    const at = this.selected && this.placeOf(this.selected);
    if (!at) return false;
    if (!repeat) strokes++;
    const step = shiftKey ? LONG_STEP : altKey ? SHORT_STEP : STEP;
    this.move(this.selected!, [at[0] + step * dx, at[1] + step * dy]);
    return true;
  }

  private command({ key, shiftKey }: KeyboardEvent): boolean {
    switch (key) {
      case "]": return this.step(1);
      case "[": return this.step(-1);
      case "Enter": return !this.selected && this.step(1);
      case "Tab": return this.selected !== null && this.step(shiftKey ? -1 : 1);
      case "Escape": return this.selected !== null && (this.select(null), true);
      case "Delete": case "Backspace": return this.selected !== null && (this.events.remove(this.selected), true);
      case "0": return (this.reset(), true);
      case "+": case "=": return (this.zoom(ZOOM), true);
      case "-": return (this.zoom(1 / ZOOM), true);
      default: return false;
    }
  }

  /** Select the next point, or the one before; past the last one there is none, and the key is the page's. */
  private step(by: 1 | -1): boolean {
    const { names, selected } = this;
    const next = selected ? names.indexOf(selected) + by : by > 0 ? 0 : names.length - 1;
    this.select(names[next] ?? null);
    if (this.selected) this.look((port, size) => showing(port, this.placeOf(this.selected!)!, MARGIN, size, this.box));
    return this.selected !== null;
  }

  // --- points

  /** Those that have a place, in the order of the table. */
  private get names(): string[] {
    return this.features().map(({ name }) => name).filter((name) => this.placeOf(name));
  }

  private placeOf(name: string): Position | undefined {
    return this.marks.get(name)?.at ?? this.laid?.points.get(name);
  }

  private select(name: string | null): void {
    this.selected = name;
    this.draw();
  }

  private move(name: string, at: Position): void {
    this.events.move(name, within(at, this.size!), strokes);
  }

  // --- drawing

  private redraw(): void {
    this.stale = true;
    this.draw();
  }

  private draw(): void {
    this.request ||= requestAnimationFrame(() => {
      this.request = 0;
      this.paint();
    });
  }

  private paint(): void {
    const { picture, port, box, context, ground } = this;
    if (!picture || !port) return;
    const { marks, laid, fitted, edges, selected, hovered, held } = this;
    const scene: Scene = { picture, port, box, marks, laid, fitted, edges, selected, hovered };
    if (this.stale) paintGround(ground, scene);
    this.stale = false;
    context.clearRect(0, 0, ...box);
    context.drawImage(ground.canvas, 0, 0, ...box);
    paintPoints(context, scene);
    const at = held?.moved && marks.get(held.name)?.at;
    if (at) paintLoupe(context, scene, at);
    this.describe();
  }

  /** Name the point under the pointer, or else the selected one. */
  private describe(): void {
    const name = this.held?.moved ? null : this.hovered ?? this.selected;
    this.tag.hidden = !name;
    const text = name ? `${name} ${this.titleOf(name)}, ${stateOf(this.marks.get(name))}` : "";
    if (this.tag.textContent !== text) this.tag.textContent = text;
  }

  private titleOf(name: string): string {
    return this.features().find((feature) => feature.name === name)?.title ?? "";
  }
}

function stateOf(mark: Mark | undefined): string {
  if (!mark) return "a guess";
  return mark.confidence === undefined ? "placed by hand" : `found, ${Math.round(100 * mark.confidence)} % sure`;
}
