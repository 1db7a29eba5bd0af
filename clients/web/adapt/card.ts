/** One photo's card: choosing or dropping a file, the photo itself, and what there is to say about it. */

import { VIEWS, type FeaturePoint, type Marks, type ViewName } from "./marks";
import { PhotoView, type PhotoEvents } from "./photo";

const MOST_BYTES = 32 * 2 ** 20;
const ZOOM = 1.5;

export interface CardEvents extends PhotoEvents {
  chosen(data: Uint8Array): void;
}

export class Card {
  readonly photo: PhotoView;
  private readonly root: HTMLElement;
  private readonly input: HTMLInputElement;

  constructor(readonly view: ViewName, features: () => readonly FeaturePoint[], private readonly events: CardEvents) {
    this.root = document.getElementById(view)!;
    this.input = this.find("input[type=file]");
    this.photo = new PhotoView(this.find("canvas"), this.find(".tag"), features, events);
    this.find("[data-do=in]").onclick = () => this.photo.zoom(ZOOM);
    this.find("[data-do=out]").onclick = () => this.photo.zoom(1 / ZOOM);
    this.find("[data-do=all]").onclick = () => this.photo.reset();
    this.find("[data-do=replace]").onclick = () => this.input.click();
    this.input.onchange = () => this.choose(this.input.files);
    this.acceptDrops();
  }

  /** There is a photo now. */
  show(picture: ImageBitmap): void {
    this.root.classList.add("filled");
    this.photo.show(picture);
  }

  mark(marks: Marks): void {
    this.photo.mark(marks);
    this.find(".count").textContent = marks.size ? `${marks.size} points` : "";
  }

  /** A sentence under the photo; `wrong` if it asks for something to be done. */
  say(text: string, wrong = false): void {
    const note = this.find(".note");
    note.textContent = text;
    note.classList.toggle("wrong", wrong);
    note.hidden = !text;
  }

  busy(text: string): void {
    this.find(".busy").textContent = text;
    this.find(".busy").hidden = !text;
  }

  private acceptDrops(): void {
    let depth = 0;
    const over = (change: number) => this.root.classList.toggle("dropping", (depth += change) > 0);
    this.root.addEventListener("dragenter", () => over(1));
    this.root.addEventListener("dragleave", () => over(-1));
    this.root.addEventListener("dragover", (event) => event.preventDefault());
    this.root.addEventListener("drop", (event) => {
      event.preventDefault();
      over(-depth);
      this.choose(event.dataTransfer?.files ?? null);
    });
  }

  private async choose(files: FileList | null): Promise<void> {
    const file = files?.[0];
    if (!file) return;
    if (file.size > MOST_BYTES) return this.say(`${file.name} has more than 32 MB.`, true);
    const data = new Uint8Array(await file.arrayBuffer());
    this.input.value = "";
    this.events.chosen(data);
  }

  private find<T extends HTMLElement = HTMLElement>(selector: string): T {
    return this.root.querySelector<T>(selector)!;
  }
}

/** Both cards. A photo that misses its card must not take the page away. */
export function cards(features: (view: ViewName) => readonly FeaturePoint[], events: (view: ViewName) => CardEvents): Record<ViewName, Card> {
  for (const name of ["dragover", "drop"]) document.addEventListener(name, (event) => event.preventDefault());
  return Object.fromEntries(VIEWS.map((view) => [view, new Card(view, () => features(view), events(view))])) as Record<ViewName, Card>;
}
