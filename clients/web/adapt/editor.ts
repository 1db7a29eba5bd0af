/** The editor: photos, points and the session brought together. Nothing here is forgotten when the connection is lost. */

import { cards, type CardEvents } from "./card";
import { formatPoints, parsePoints, type Sheets } from "./file";
import { scaled, VIEWS, within, type Facing, type FeaturePoint, type Marks, type Position, type Size, type ViewName } from "./marks";
import { find, isTyping, letterOf, save } from "./page";
import { Points, type State } from "./points";
import { Preview } from "./preview";
import { Session } from "./session";
import { hidden, midline, opposite } from "./symmetry";
import type { Fault, Fit, Head, Laid, Photo, Ready } from "./wire";

/** Fewer points of the front photo do not fit a head (protocol/ADAPT.md). */
const FEWEST = 8;

/** What there is to do while all is well. */
const HINT = "Drag points to where they belong; the head follows.";

/** One photo as the server has it, or will have it again. */
interface Sitting {
  /** The file, and one that the server has not answered yet. */
  data: Uint8Array | null;
  candidate: Uint8Array | null;
  size: Size | null;
  facing: Facing | null;
  /** What the fitted head says of the front photo, as points. */
  fitted: Marks;
}

const nothing = (): Sitting => ({ data: null, candidate: null, size: null, facing: null, fitted: new Map() });

export class Editor {
  private readonly points = new Points();
  private readonly sittings: Record<ViewName, Sitting> = { front: nothing(), profile: nothing() };
  private readonly cards = cards((view) => this.featuresOf(view), (view) => this.cardEvents(view));
  private readonly preview = new Preview((name) => this.makeHead(name));
  private readonly method = find<HTMLSelectElement>("method");
  private readonly session: Session;
  private ready: Ready | null = null;
  /** Points read from a file before there is a photo for them. */
  private waiting: Sheets = {};
  private connected = false;
  /** The points as they were saved last: leaving without others asks first. */
  private saved: State | null = null;

  constructor(url: string, token: string | null) {
    this.session = new Session(url, token, {
      ready: (message) => this.begin(message),
      photo: (message) => void this.receivePhoto(message),
      fit: (message) => this.receiveFit(message),
      head: (message) => this.receiveHead(message),
      error: (message) => this.complain(message),
      lost: () => this.lose(),
    });
    this.listen();
    this.refresh();
  }

  // --- the page

  private listen(): void {
    find("undo").onclick = () => this.step("undo");
    find("redo").onclick = () => this.step("redo");
    find("wireframe").onclick = () => this.toggle("wireframe");
    find("symmetry").onclick = () => this.toggle("symmetry");
    find("save-points").onclick = () => this.savePoints();
    const input = find<HTMLInputElement>("load-points");
    input.onchange = () => void this.loadPoints(input);
    this.method.onchange = () => this.askFit();
    document.addEventListener("keydown", (event) => this.key(event));
    addEventListener("beforeunload", (event) => {
      if (this.points.undoable && this.points.state !== this.saved) event.preventDefault();
    });
  }

  private key(event: KeyboardEvent): void {
    if (isTyping(event)) return;
    const letter = letterOf(event);
    const command = event.ctrlKey || event.metaKey;
    if (command && letter === "z") this.step(event.shiftKey ? "redo" : "undo");
    else if (command && letter === "y") this.step("redo");
    else if (!command && !event.altKey && letter === "s") this.toggle("symmetry");
    else return;
    event.preventDefault();
  }

  private toggle(id: "wireframe" | "symmetry"): void {
    find(id).setAttribute("aria-pressed", String(!isOn(id)));
    for (const view of VIEWS) this.cards[view].photo.wire(isOn("wireframe") ? this.ready?.edges ?? null : null);
  }

  private refresh(): void {
    const { state, undoable, redoable } = this.points;
    for (const view of VIEWS) this.cards[view].mark(state[view]);
    find<HTMLButtonElement>("undo").disabled = !undoable;
    find<HTMLButtonElement>("redo").disabled = !redoable;
    find<HTMLButtonElement>("save-points").disabled = !this.sittings.front.size;
    find<HTMLInputElement>("load-points").disabled = !this.ready;
    this.preview.able(this.connected && state.front.size >= FEWEST, this.session?.busy("head") ?? false);
  }

  private say(text: string, wrong = false): void {
    const place = find("message");
    if (place.textContent !== text) place.textContent = text;
    place.classList.toggle("wrong", wrong);
  }

  private status(state: "on" | "off" | "wait", text: string): void {
    Object.assign(find("status"), { textContent: text }).dataset.state = state;
  }

  // --- photos

  private cardEvents(view: ViewName): CardEvents {
    return {
      chosen: (data) => this.choosePhoto(view, data),
      move: (name, at, stroke) => this.move(view, name, at, stroke),
      remove: (name) => (this.points.remove(view, name), this.changed()),
    };
  }

  private choosePhoto(view: ViewName, data: Uint8Array): void {
    this.sittings[view].candidate = data;
    this.cards[view].say("");
    this.sendPhoto(view);
  }

  private sendPhoto(view: ViewName): void {
    const { candidate, data } = this.sittings[view];
    const file = candidate ?? data;
    if (!file) return;
    this.session.ask({ type: "photo", view, data: file });
    this.cards[view].busy(!this.connected ? "Waiting for the server ..." : this.ready?.automatic ? "Looking for points ..." : "Reading the photo ...");
  }

  private async receivePhoto(message: Photo): Promise<void> {
    const { view, picture, note } = message;
    const card = this.cards[view];
    this.takePoints(message);
    card.busy("");
    card.say(note ?? "");
    this.changed();
    try {
      card.show(await createImageBitmap(new Blob([picture], { type: "image/jpeg" })));
    } catch {
      card.say("The server's picture of this photo cannot be read.", true);
    }
  }

  /** A new photo brings its own points; one that was sent again has those it had. */
  private takePoints({ view, width, height, points, facing }: Photo): void {
    const sitting = this.sittings[view];
    const size: Size = [width, height];
    if (sitting.size) this.points.rescale(view, sitting.size, size);
    sitting.size = size;
    sitting.facing = facing ?? sitting.facing;
    if (!sitting.candidate) return;
    sitting.data = sitting.candidate;
    sitting.candidate = null;
    const sheet = this.waiting[view];
    delete this.waiting[view];
    this.points.replace(view, sheet ? scaled(sheet.marks, sheet.size, size) : points);
    this.cards[view].photo.lay(null, false);
  }

  // --- points

  private featuresOf(view: ViewName): FeaturePoint[] {
    return this.ready?.points.filter(({ views }) => views.includes(view)) ?? [];
  }

  private move(view: ViewName, name: string, at: Position, stroke: number): void {
    const places = new Map([[name, at]]);
    const mirror = view === "front" && isOn("symmetry") ? this.mirrored(name, at) : null;
    if (mirror) places.set(...mirror);
    this.points.move(view, places, stroke);
    this.changed();
  }

  /** The mirror point of the front photo's point `name`, and where it belongs if that is at `at`. */
  private mirrored(name: string, at: Position): [string, Position] | null {
    const features = this.featuresOf("front");
    const mirror = features.find((feature) => feature.name === name)?.mirror;
    const { fitted, size } = this.sittings.front;
    const line = midline(this.points.state.front, features, name) ?? midline(fitted, features, name);
    return mirror && line && size ? [mirror, within(opposite(line, at), size)] : null;
  }

  private step(way: "undo" | "redo"): void {
    this.points[way]();
    this.changed();
  }

  private changed(): void {
    this.refresh();
    this.askFit();
  }

  private savePoints(): void {
    const { state } = this.points;
    this.saved = state;
    const sheets = VIEWS.flatMap((view) => {
      const { size, facing } = this.sittings[view];
      return size ? [[view, { size, marks: state[view], ...(facing && { facing }) }] as const] : [];
    });
    save(new Blob([formatPoints(Object.fromEntries(sheets))], { type: "application/json" }), `${this.preview.fileName}.points.json`);
  }

  private async loadPoints(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    if (!file) return;
    try {
      this.take(parsePoints(await file.text(), this.ready?.points ?? []));
      this.say(`Points of ${file.name}`);
    } catch (e) {
      this.say(`${file.name}: ${(e as Error).message}`, true);
    }
    input.value = "";
  }

  private take(sheets: Sheets): void {
    for (const view of VIEWS) {
      const [sheet, { size }] = [sheets[view], this.sittings[view]];
      if (sheet && size) this.points.replace(view, scaled(sheet.marks, sheet.size, size));
      else if (sheet) this.waiting[view] = sheet;
    }
    this.changed();
  }

  // --- the server

  private begin(ready: Ready): void {
    this.ready = ready;
    this.connected = true;
    this.status("on", "Connected");
    this.say(this.sittings.front.size ? "" : "Begin with a photo from in front.");
    const chosen = this.method.value;
    this.method.replaceChildren(...ready.methods.map((name) => new Option(name, name, false, name === chosen)));
    find("methods").hidden = ready.methods.length < 2;
    for (const view of VIEWS) {
      this.cards[view].photo.wire(isOn("wireframe") ? ready.edges : null);
      this.sendPhoto(view);
    }
    this.refresh();
  }

  private lose(): void {
    this.connected = false;
    this.status("off", "Connection lost. Trying again ...");
    for (const view of VIEWS) if (this.sittings[view].candidate) this.sendPhoto(view);
    if (this.sittings.front.size) this.say("Your points are kept. The photos are sent again when the server is back.", true);
    this.refresh();
  }

  private get wishes() {
    const { front, profile } = this.points.state;
    const method = this.method.value;
    return { front, ...(this.sittings.profile.size && { profile }), ...(method && { method }) };
  }

  private askFit(): void {
    if (this.sittings.front.size) this.session.ask({ type: "points", ...this.wishes });
  }

  private receiveFit(fit: Fit): void {
    const { front, profile } = this.sittings;
    front.fitted = new Map([...fit.front?.points ?? []].map(([name, at]) => [name, { at }]));
    profile.facing = fit.profile?.facing ?? profile.facing;
    this.cards.front.photo.lay(fit.front ?? null, fit.fitted);
    this.cards.profile.photo.lay(fit.profile ? this.withoutHidden(fit.profile, fit.front) : null, fit.fitted);
    this.showFit(fit);
  }

  /** Nobody can tell where in a profile the points of the far side are. */
  private withoutHidden(profile: Laid, front: Laid | undefined): Laid {
    const { facing } = this.sittings.profile;
    if (!facing || !front) return profile;
    const far = hidden(facing, this.ready?.points ?? [], front.points);
    return { ...profile, points: new Map([...profile.points].filter(([name]) => !far.has(name))) };
  }

  private showFit({ fitted, error_px, ms }: Fit): void {
    const { front, profile } = this.points.state;
    const missing = FEWEST - front.size;
    this.say(missing > 0 ? `Drag ${missing} more of the hollow points of the front photo into place to fit the head.` : HINT);
    find("numbers").hidden = !fitted;
    find("fit-points").textContent = String(front.size + profile.size);
    find("fit-error").textContent = error_px === undefined ? "–" : `${error_px.toFixed(1)} px`;
    find("fit-time").textContent = ms === undefined ? "–" : `${ms.toFixed(0)} ms`;
  }

  private makeHead(name: string): void {
    this.session.ask({ type: "head", ...this.wishes, ...(name && { name }) });
    this.refresh();
  }

  private receiveHead({ head }: Head): void {
    this.preview.show(head);
    this.settled();
  }

  private complain({ message, view }: Fault): void {
    if (view) {
      this.sittings[view].candidate = null;
      this.cards[view].say(message, true);
    } else this.say(message, true);
    this.settled();
  }

  /** A request is answered as soon as everybody has been told. */
  private settled(): void {
    queueMicrotask(() => {
      for (const view of VIEWS) if (!this.session.busy(view)) this.cards[view].busy("");
      this.refresh();
    });
  }
}

function isOn(id: string): boolean {
  return find(id).getAttribute("aria-pressed") === "true";
}
