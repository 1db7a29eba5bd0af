/** `<fap-head>`: the one file that touches the page. */

import type { SpeakOptions, Turn, TurnEnd } from "./client/turn";
import { HeadFault, OwnTurn } from "./client/turn";
import { furnish } from "./look";
import { Presenter } from "./presenter";
import type { Ready } from "./protocol/generated";
import { swing } from "./render/camera";
import { Captions, type CaptionMark } from "./stream/captions";

const BEAT_MS = 1000;
const MOST_PIXELS = 2;
/** Browsers resume sound a moment after a gesture; only then is asking for one fair. */
const LOCKED_MS = 200;
/** Where this script came from: server, sound processor and heads are looked for beside it. */
const HOME = import.meta.url;

let heads = 0;

export class FapHead extends HTMLElement {
  static readonly observedAttributes = ["src", "head", "fps", "capture", "antialias", "captions", "controls", "token", "channel", "prefer", "share"];

  private readonly root = this.attachShadow({ mode: "open" });
  private readonly seed = ++heads;
  private readonly captions = new Captions();
  private readonly calm = matchMedia("(prefers-reduced-motion: reduce)");
  private readonly sizes = new ResizeObserver(() => this.resize());
  private presenter: Presenter | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private talking: Turn | null = null;
  private frameRequest = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private lockedSince = 0;
  /** When the head came into view. */
  private shownAt = 0;
  /** What is wrong, by topic; the oldest is shown. */
  private readonly messages = new Map<string, string>();

  constructor() {
    super();
    furnish(this.root);
    this.find<HTMLButtonElement>(".unlock").onclick = () => this.unlock();
    this.find<HTMLButtonElement>(".stop").onclick = () => void this.interrupt();
    this.find<HTMLFormElement>("form").onsubmit = (event) => this.submit(event);
  }

  // --- life in the page

  connectedCallback(): void {
    this.begin();
    document.addEventListener("visibilitychange", this.schedule);
    for (const gesture of GESTURES) document.addEventListener(gesture, this.unlock, { capture: true, passive: true });
    this.sizes.observe(this);
    this.timer = setInterval(() => this.presenter?.beat(), BEAT_MS);
  }

  disconnectedCallback(): void {
    this.finish();
    document.removeEventListener("visibilitychange", this.schedule);
    for (const gesture of GESTURES) document.removeEventListener(gesture, this.unlock, { capture: true });
    this.sizes.disconnect();
    clearInterval(this.timer);
  }

  attributeChangedCallback(name: string, before: string | null, after: string | null): void {
    if (before === after) return;
    if (name === "captions" || name === "controls") return this.refresh();
    if (!this.presenter) return;
    if (name === "head") return this.presenter.wear(this.addresses().headUrl);
    this.finish();
    this.begin();
  }

  private begin(): void {
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("part", "canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", this.getAttribute("aria-label") ?? "Talking head");
    this.root.prepend(this.canvas);
    const options = {
      ...this.addresses(),
      fps: this.getAttribute("fps") === "50" ? 50 as const : 25 as const,
      seed: this.seed,
      token: this.getAttribute("token") ?? undefined,
      channel: this.getAttribute("channel") ?? undefined,
      prefer: this.getAttribute("prefer") === "face" ? "face" as const : undefined,
      share: this.hasAttribute("share"),
      capture: this.hasAttribute("capture"),
      antialias: ANTIALIAS[this.getAttribute("antialias") ?? ""] ?? null,
    };
    this.presenter = new Presenter(options, (name, detail) => this.tell(name, detail), () => this.refresh());
    void this.presenter.start(this.canvas);
    this.resize();
    this.refresh();
    this.schedule();
  }

  private finish(): void {
    cancelAnimationFrame(this.frameRequest);
    this.frameRequest = 0;
    const { presenter, canvas } = this;
    this.presenter = this.canvas = this.talking = null;
    presenter?.close();
    canvas?.remove();
    this.messages.clear();
  }

  private addresses(): { socketUrl: string; headUrl: string; workletUrl: string } {
    const socket = new URL(this.getAttribute("src") ?? new URL("/ws", HOME), document.baseURI);
    socket.protocol = socket.protocol.replace("http", "ws");
    const head = this.getAttribute("head") || "default";
    const [address, base] = /^[\w-]+$/.test(head) ? [`/heads/${head}.glb`, HOME] : [head, document.baseURI];
    const headUrl = URL.canParse(address, base) ? new URL(address, base).href : head;
    return { socketUrl: socket.href, headUrl, workletUrl: new URL("fap-worklet.js", HOME).href };
  }

  // --- drawing

  /** Draw as long as somebody can see it. */
  private readonly schedule = (): void => {
    if (this.frameRequest || document.hidden || !this.presenter) return;
    this.frameRequest = requestAnimationFrame(() => {
      this.frameRequest = 0;
      this.presenter?.frame(this.calm.matches, this.yaw);
      if (this.lockedSince) this.refresh();
      this.schedule();
    });
  };

  /** Where the camera of a turntable is now; who wants less motion sees the head from in front. */
  private get yaw(): number {
    return this.hasAttribute("turntable") && !this.calm.matches ? swing((performance.now() - this.shownAt) / 1000) : 0;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this;
    this.presenter?.resize(clientWidth, clientHeight, Math.min(MOST_PIXELS, devicePixelRatio || 1));
  }

  // --- what the page says

  /** What the server offers; null while there is no connection. */
  get server(): Ready | null {
    return this.presenter?.conversation.ready ?? null;
  }

  /** Say `text`. With `open`, more may follow by `append` until `end`. */
  speak(text: string, options: SpeakOptions = {}): Turn {
    if (!this.presenter) throw new HeadFault("not_connected", "the element is not in a document");
    if (this.presenter.mute) throw this.presenter.mute;
    this.unlock();
    if (this.talking?.open) this.talking.end();
    const factor = (name: string) => {
      const value = Number.parseFloat(this.getAttribute(name) ?? "");
      return Number.isFinite(value) ? value : undefined;
    };
    const manner = { rate: factor("rate"), pitch: factor("pitch"), volume: factor("volume"), lookAhead: factor("look-ahead") };
    const [lang, voice] = [this.getAttribute("lang") ?? undefined, this.getAttribute("voice") ?? undefined];
    const turn = this.presenter.conversation.speak(String(text), { lang, voice, ...manner, ...options });
    this.talking = turn;
    this.refresh();
    return turn;
  }

  /** More text for the open turn; opens one if there is none. (The element takes no children: this is no longer Element.append.) */
  override append(...pieces: (string | Node)[]): Turn {
    const text = pieces.map((piece) => (piece instanceof Node ? piece.textContent : String(piece))).join("");
    return this.talking?.open && !(this.talking instanceof OwnTurn) ? this.talking.append(text) : this.speak(text, { open: true });
  }

  /**
   * Say what the user says, or what `stream` brings, a little later, until `end` or `interrupt`. Without a stream the
   * browser asks for the microphone. The turn comes in an object, because awaiting a turn waits for its end. Rejects
   * with a HeadFault.
   */
  async hear(stream?: MediaStream): Promise<{ turn: OwnTurn }> {
    const { presenter } = this;
    if (!presenter) throw new HeadFault("not_connected", "the element is not in a document");
    if (presenter.mute) throw presenter.mute;
    this.unlock();
    const { turn } = await presenter.hear(stream);
    if (this.talking?.open) this.talking.end();
    this.talking = turn;
    this.refresh();
    return { turn };
  }

  /** The open turn's text, or sound, is complete. */
  end(): void {
    if (this.talking?.open) this.talking.end();
  }

  /** Fall silent at once; tells how far the turn being heard had come. Null if nothing was being said. */
  async interrupt(): Promise<TurnEnd | null> {
    return (await this.presenter?.conversation.interruptAll()) ?? null;
  }

  /** What is being said stops where it is, until `continue`. */
  pause(): void {
    this.talking?.pause();
  }

  /** Say it again from the beginning of the sentence being heard (0), or so many sentences before it. */
  seek(back = 1): void {
    if (!(this.talking instanceof OwnTurn)) this.talking?.seek(back);
  }

  /** Go on after `pause`. */
  continue(): void {
    this.talking?.continue();
  }

  // --- what the page is told

  private tell(name: string, detail: object): void {
    if (name === "caption") this.captions.caption(detail as CaptionMark);
    if (name === "word") this.captions.word(detail as CaptionMark);
    if (name === "done" || name === "disconnected") this.captions.clear();
    if (name === "head") this.appear();
    if (name === "error") this.complain(detail as HeadFault);
    for (const topic of ANSWERS[name] ?? []) this.messages.delete(topic);
    if (name === "disconnected") this.messages.set("connection", "Connection lost. Trying again ...");
    const { code, message, fatal, turn } = detail as HeadFault;
    const plain = detail instanceof HeadFault ? { code, message, fatal, ...(turn !== undefined && { turn }) } : detail;
    this.refresh();
    this.dispatchEvent(new CustomEvent(name, { detail: plain }));
  }

  private appear(): void {
    this.shownAt = performance.now();
    this.canvas?.classList.add("ready");
  }

  private complain({ code, message, fatal, turn }: HeadFault): void {
    if (code === "connection_lost") return;
    if (turn !== undefined) this.messages.set("turn", message);
    else if (fatal) this.messages.set(code.endsWith("_unavailable") ? code : "connection", message);
  }

  // --- what is seen beside the head

  private refresh(): void {
    const { said, word, ahead } = this.captions.view;
    const captions = this.find(".captions");
    captions.classList.toggle("on", this.hasAttribute("captions") && Boolean(said || word));
    this.write(".said", said);
    this.write("mark", word);
    this.find(".ahead").dataset.text = ahead;
    this.find(".controls").hidden = !this.hasAttribute("controls");
    const [message] = this.messages.values();
    this.write(".message", message ?? "");
    this.find(".message").hidden = !message;
    this.askToUnlock();
  }

  private askToUnlock(): void {
    const locked = this.presenter?.locked ?? false;
    this.lockedSince = locked ? this.lockedSince || performance.now() : 0;
    this.find(".unlock").hidden = !locked || performance.now() - this.lockedSince < LOCKED_MS;
  }

  private readonly unlock = (): void => this.presenter?.unlock();

  private submit(event: SubmitEvent): void {
    event.preventDefault();
    const input = this.find<HTMLInputElement>("input");
    if (input.value.trim()) this.speak(input.value);
    input.value = "";
  }

  /** Only what is new is read out by screen readers. */
  private write(selector: string, text: string): void {
    const place = this.find(selector);
    if (place.textContent !== text) place.textContent = text;
  }

  private find<T extends HTMLElement = HTMLElement>(selector: string): T {
    return this.root.querySelector<T>(selector)!;
  }
}

/** Which topics an event settles. */
const ANSWERS: Record<string, string[]> = { ready: ["connection"], head: ["head_unavailable"], begin: ["turn"] };
const ANTIALIAS: Record<string, boolean> = { on: true, off: false };
const GESTURES = ["pointerdown", "keydown", "touchend"] as const;
