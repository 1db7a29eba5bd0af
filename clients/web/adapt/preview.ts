/** The head that was made: put on the page, to be heard and saved. */

import type { FapHead } from "../src/index";
import { find, save } from "./page";

const TEXTS: Record<string, [name: string, text: string]> = {
  en: ["English", "Hello! This is my face, and I can say whatever you type."],
  el: ["Ελληνικά", "Γεια σου! Αυτό είναι το πρόσωπό μου και λέω ό,τι γράψεις."],
};

export class Preview {
  private readonly make = find<HTMLButtonElement>("make");
  private readonly text = find<HTMLTextAreaElement>("text");
  private readonly name = find<HTMLInputElement>("name");
  private lang = "";
  private head: FapHead | null = null;
  private file: Blob | null = null;
  private address = "";

  /** `wanted` is called when the button is pressed. */
  constructor(wanted: (name: string) => void) {
    find("making").addEventListener("submit", (event) => (event.preventDefault(), wanted(this.name.value.trim())));
    find("talking").addEventListener("submit", (event) => (event.preventDefault(), this.speak()));
    find("save-head").onclick = () => this.file && save(this.file, `${this.fileName}.glb`);
    find("languages").replaceChildren(...Object.entries(TEXTS).map(([lang, [label]]) =>
      Object.assign(document.createElement("button"), { type: "button", textContent: label, lang, onclick: () => this.choose(lang) })));
    this.choose(navigator.language.startsWith("el") ? "el" : "en");
  }

  /** What files of this head are called. */
  get fileName(): string {
    return this.name.value.trim().replace(/[^\p{L}\p{N}_-]+/gu, "-") || "head";
  }

  /** Can a head be made, and is one being made? */
  able(able: boolean, making: boolean): void {
    this.make.disabled = !able || making;
    this.make.textContent = making ? "Making the head ..." : this.head ? "Make it again" : "Make the head";
    find("stage").setAttribute("aria-busy", String(making));
  }

  show(data: Uint8Array<ArrayBuffer>): void {
    this.file = new Blob([data], { type: "model/gltf-binary" });
    URL.revokeObjectURL(this.address);
    this.address = URL.createObjectURL(this.file);
    if (this.head) this.head.setAttribute("head", this.address);
    else this.begin();
    find("made").hidden = false;
    find("stage").scrollIntoView({ block: "nearest" });
  }

  private begin(): void {
    const head = document.createElement("fap-head");
    for (const [name, value] of [["head", this.address], ["turntable", ""], ["captions", ""], ["aria-label", "The head made from the photos"]]) {
      head.setAttribute(name, value);
    }
    head.addEventListener("head", () => this.speak());
    this.head = head;
    find("stage").replaceChildren(head);
  }

  private speak(): void {
    if (!this.head || !this.text.value.trim()) return;
    void this.head.interrupt();
    this.head.speak(this.text.value, { lang: this.lang }).finished.catch(() => undefined);
  }

  /** The sample text changes with the language; what somebody wrote stays. */
  private choose(lang: string): void {
    const untouched = !this.text.value.trim() || this.text.value === TEXTS[this.lang]?.[1];
    this.lang = this.text.lang = lang;
    if (untouched) this.text.value = TEXTS[lang][1];
    for (const button of find("languages").children) button.setAttribute("aria-pressed", String((button as HTMLElement).lang === lang));
  }
}
