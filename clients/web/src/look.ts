/** What the element is made of inside, and how it looks. `part`s and custom properties are its public face. */

import { look } from "./render/look";

/** Behind the head, unless the page wants something else. */
const BACKGROUND = `radial-gradient(120% 90% at 50% 32%, ${look.background.map(([color, at]) => `${color} ${100 * Number(at)}%`).join(", ")})`;

const STYLE = /* css */ `
:host {
  display: block; position: relative; overflow: hidden; contain: content; container-type: inline-size; aspect-ratio: 1;
  background: var(--fap-background, ${BACKGROUND});
  color: var(--fap-color, #fff); font: 500 1rem/1.4 system-ui, sans-serif;
}
:host([hidden]) { display: none; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; opacity: 0; transition: opacity .3s; }
canvas.ready { opacity: 1; }
[hidden] { display: none !important; }
.captions {
  position: absolute; left: 6%; right: 6%; bottom: 5%; text-align: center; text-wrap: balance;
  font-size: var(--fap-caption-size, clamp(.95rem, 2.2cqi, 1.25rem)); line-height: 1.7;
}
.captions:not(.on) { visibility: hidden; }
.captions .heard {
  padding: .22em .55em; border-radius: .45em; background: var(--fap-caption-background, rgb(12 16 22 / .66));
  -webkit-box-decoration-break: clone; box-decoration-break: clone;
}
.captions .ahead::after { content: attr(data-text); visibility: hidden; }
.captions mark { color: var(--fap-caption-mark, #ffd479); background: none; }
.message, .unlock { position: absolute; left: 50%; top: 50%; transform: translate(-50%, -50%); border-radius: 999px; }
.message {
  top: 1rem; transform: translateX(-50%); width: max-content; max-width: 86%; padding: .5em 1em;
  border-radius: .6em; background: rgb(20 24 32 / .84); font-size: .9rem;
  overflow-wrap: anywhere;
}
button {
  font: inherit; color: inherit; border: 0; cursor: pointer; padding: .7em 1.3em; border-radius: 999px;
  background: var(--fap-accent, #2563eb); color: #fff;
}
button:focus-visible { outline: 3px solid #fff; outline-offset: 2px; }
.unlock { top: 74%; box-shadow: 0 6px 30px rgb(0 0 0 / .35); }
.stop { background: rgb(12 16 22 / .66); }
.controls { position: absolute; inset: auto .75rem .75rem; display: flex; gap: .5rem; }
.controls:not([hidden]) ~ .captions { bottom: 5rem; }
.controls input {
  flex: 1; min-width: 0; font: inherit; padding: .6em 1em; border: 0; border-radius: 999px;
  background: rgb(255 255 255 / .92); color: #16202c;
}
@media (prefers-reduced-motion: reduce) { canvas { transition: none; } }
`;

const TEMPLATE = /* html */ `
<form class="controls" part="controls" hidden>
  <input part="input" aria-label="Text to say" autocomplete="off">
  <button part="button" type="submit">Speak</button>
  <button part="button stop" type="button" class="stop">Stop</button>
</form>
<div class="captions" part="captions" aria-live="polite"><span class="heard"><span class="said"></span><mark></mark></span><span class="ahead"></span></div>
<div class="message" part="message" role="status" hidden></div>
<button class="unlock" part="unlock" type="button" hidden>Turn on sound</button>
`;

let sheet: CSSStyleSheet | undefined;

/** Fill a shadow root. The style sheet is shared by all heads and needs no permission of the page's CSP. */
export function furnish(root: ShadowRoot): void {
  if (!sheet) (sheet = new CSSStyleSheet()).replaceSync(STYLE);
  root.adoptedStyleSheets = [sheet];
  root.innerHTML = TEMPLATE;
}
