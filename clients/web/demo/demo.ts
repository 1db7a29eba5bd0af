/** The page to try it. Uses nothing but the element's public face. */

import type { FapHead, OwnTurn, Stats, Turn } from "../src/index";

interface Voice { name: string; lang: string; engine: string; description?: string }

const LANGUAGES: Record<string, { name: string; texts: [label: string, text: string][] }> = {
  en: {
    name: "English",
    texts: [
      ["Hello", "Hello! I am a talking head. Type something, and I will say it."],
      ["Numbers", "It is 21:45, and 3.5 million people are still awake."],
      ["Lips", "Peter Piper picked a peck of pickled peppers. We show you a few blue moons above the bay."],
      ["Feelings", "I have good news. \\:)1000 We won! And I have bad news. \\:|1000 It is raining again."],
    ],
  },
  el: {
    name: "Ελληνικά",
    texts: [
      ["Γεια", "Γεια σου! Είμαι ένα κεφάλι που μιλάει. Γράψε κάτι και θα το πω."],
      ["Αριθμοί", "Η ώρα είναι 21:45 και έξω έχει 28 βαθμούς."],
      ["Χείλη", "Ο παπάς ο παχύς έφαγε παχιά φακή. Γιατί, παπά παχύ, έφαγες παχιά φακή;"],
      ["Διάθεση", "Έχω καλά νέα. \\:)1000 Κερδίσαμε! Έχω και άσχημα. \\:|1000 Πάλι βρέχει."],
    ],
  },
};

const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const head = find<FapHead>("head");
const text = find<HTMLTextAreaElement>("text");
const voice = find<HTMLSelectElement>("voice");
const face = find<HTMLSelectElement>("face");
const rate = find<HTMLInputElement>("rate");
const live = find<HTMLInputElement>("live");
const speak = find<HTMLButtonElement>("speak");
const stop = find<HTMLButtonElement>("stop");
const pause = find<HTMLButtonElement>("pause");
const back = find<HTMLButtonElement>("back");
const mic = find<HTMLButtonElement>("mic");

/** What the address says behind `#`: a token where the server asks for one, and a channel to listen to. */
const wishes = new URLSearchParams(location.hash.slice(1));
for (const name of ["token", "channel"]) {
  const value = wishes.get(name);
  if (value) head.setAttribute(name, value);
}
document.querySelector<HTMLElement>(".panel")!.hidden = wishes.has("channel");

let voices: Voice[] = [];
let lang = navigator.language.startsWith("el") ? "el" : "en";
/** The turn being typed, and how much of the text it has been given. */
let typed: { turn: Turn; given: number } | null = null;

function chooseLanguage(next: string): void {
  lang = next;
  for (const button of find("languages").children) button.setAttribute("aria-pressed", String(button.id === `lang-${lang}`));
  const fitting = voices.filter((v) => v.lang === lang);
  voice.replaceChildren(...fitting.map(({ name, engine, description }) => new Option(description || `${name} (${engine})`, name)));
  voice.disabled = !fitting.length;
  const texts = LANGUAGES[lang].texts;
  find("samples").replaceChildren(...texts.map(([label, sample]) => button(label, () => (text.value = sample))));
  text.lang = lang;
  text.value = texts[0][1];
}

/** Heads by name, the server's own choice first. */
function offerHeads(names: string[]): void {
  const wanted = head.getAttribute("head") ?? names[0];
  const title = (name: string) => name[0].toUpperCase() + name.slice(1);
  face.replaceChildren(...names.map((name) => new Option(title(name), name, false, name === wanted)));
  find("faces").hidden = names.length < 2;
}

function button(label: string, onclick: () => void): HTMLButtonElement {
  const element = document.createElement("button");
  Object.assign(element, { type: "button", textContent: label, onclick });
  return element;
}

const options = () => ({ lang, voice: voice.value || undefined, rate: Number(rate.value) });

function say(): void {
  if (live.checked) finishTyped();
  else if (text.value.trim()) watch(head.speak(text.value, options()));
}

/** Hand over the whole words typed so far. */
function follow(): void {
  if (!live.checked) return;
  const given = typed?.given ?? 0;
  const end = text.value.search(/\S*$/);
  if (end <= given) return;
  typed ??= { turn: watch(head.speak("", { ...options(), open: true })), given: 0 };
  typed.turn.append(text.value.slice(given, end));
  typed.given = end;
}

function finishTyped(): void {
  if (typed) typed.turn.append(text.value.slice(typed.given)).end();
  else if (text.value.trim()) watch(head.speak(text.value, options()));
  typed = null;
  text.value = "";
}

let speaking = 0;

function watch(turn: Turn): Turn {
  busy(1);
  turn.then(() => undefined, () => undefined).then(() => {
    if (typed?.turn === turn) typed = null;
    busy(-1);
  });
  return turn;
}

/** The turn that says what the microphone hears. */
let own: OwnTurn | null = null;

async function hear(): Promise<void> {
  if (own) {
    own.end();
    return;
  }
  mic.disabled = true;
  try {
    const { turn } = await head.hear();
    own = turn;
    mic.setAttribute("aria-pressed", "true");
    watch(turn).then(() => undefined, () => undefined).then(() => {
      own = null;
      mic.setAttribute("aria-pressed", "false");
    });
  } catch (e) {
    status("wait", (e as Error).message);
  } finally {
    mic.disabled = false;
  }
}

function busy(change: number): void {
  speaking += change;
  stop.disabled = pause.disabled = back.disabled = speaking === 0;
  if (speaking === 0) pause.setAttribute("aria-pressed", "false");
}

function status(state: "on" | "off" | "wait", message: string): void {
  Object.assign(find("status"), { textContent: message }).dataset.state = state;
}

function show(name: string, value: string): void {
  document.querySelector(`[data-of=${name}]`)!.textContent = value;
}

const ms = (value: number | null, digits = 0) => (value === null ? "–" : `${value.toFixed(digits)} ms`);

head.addEventListener("ready", (event) => {
  const server = (event as CustomEvent<{ server: string; voices: Voice[]; heads: string[] }>).detail;
  voices = server.voices;
  offerHeads(server.heads);
  const kept = text.value;
  if (!voices.some((v) => v.lang === lang)) lang = voices[0]?.lang ?? lang;
  chooseLanguage(lang);
  text.value = kept || text.value;
  status("on", server.server);
});
head.addEventListener("disconnected", () => status("off", "Not connected"));
head.addEventListener("error", (event) => {
  const { message, fatal } = (event as Event as CustomEvent<{ message: string; fatal: boolean }>).detail;
  if (fatal) status("off", message);
});
head.addEventListener("stats", (event) => {
  const { latencyMs, skewMs, queueMs, underruns } = (event as CustomEvent<Stats>).detail;
  show("latency", ms(latencyMs));
  show("skew", ms(skewMs, 1));
  show("queue", ms(queueMs));
  show("underruns", String(underruns));
});

find("languages").replaceChildren(...Object.entries(LANGUAGES).map(([code, { name }]) =>
  Object.assign(button(name, () => chooseLanguage(code)), { id: `lang-${code}`, lang: code })));
find("form").addEventListener("submit", (event) => (event.preventDefault(), say()));
text.addEventListener("input", follow);
text.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && !event.shiftKey && !event.isComposing) (event.preventDefault(), say());
});
live.addEventListener("change", () => {
  if (live.checked) text.value = "";
  else if (typed) finishTyped();
  speak.textContent = live.checked ? "Finish" : "Speak";
  text.placeholder = live.checked ? "Type: every finished word is spoken at once" : "";
  text.focus();
});
face.addEventListener("change", () => head.setAttribute("head", face.value));
rate.addEventListener("input", () => (find("rate-value").textContent = `${Number(rate.value).toFixed(2)}×`));
pause.addEventListener("click", () => {
  const on = pause.getAttribute("aria-pressed") !== "true";
  pause.setAttribute("aria-pressed", String(on));
  if (on) head.pause();
  else head.continue();
});
mic.addEventListener("click", () => void hear());
back.addEventListener("click", () => head.seek(0));
stop.addEventListener("click", () => ((typed = null), void head.interrupt()));
find("snippet").textContent =
  `<script type="module" src="${location.origin}/fap-head.js"></script>\n<fap-head id="head" captions></fap-head>\n<script type="module">\n  const head = document.getElementById("head");\n  head.addEventListener("ready", () => head.speak("Hello!"));\n</script>`;
find("copy").addEventListener("click", () => void navigator.clipboard?.writeText(find("snippet").textContent!));
chooseLanguage(lang);
