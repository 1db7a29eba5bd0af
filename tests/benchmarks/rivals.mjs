// TalkingHead's class, headless: the words of sentences and their times in, the weights of the visemes out.
//
// usage: node rivals.mjs PACKAGE < SENTENCES > WEIGHTS
//
// PACKAGE is the unpacked npm package @met4citizen/talkinghead, 1.7.0. All between the words and the weights is
// its own code: `showAvatar`; `speakAudio` with words, wtimes and wdurations; `preProcessText` and
// `wordsToVisemes` of its English; `playAudio`; `animate`; and `updateMorphTargets`, which writes the weights
// where three.js would read them. Ours: what stands for three.js and the browser (it does nothing, whatever is
// asked of it), a face with morph targets and without a shape, and a clock that goes in steps: every instant is
// a frame, where a browser draws 30 a second at most. It hears no sound, so the vowels keep the level that their
// word gave them; with sound it multiplies them by 0.5 + volume / 255.
//
// SENTENCES: {"step_ms": 10, "sentences": [{"n": 300, "words": [], "wtimes": [], "wdurations": []}]}, in ms
// WEIGHTS: for each sentence, for each instant, for each viseme; the visemes in the order of its `visemeNames`

import { readFileSync } from "node:fs";
import { register } from "node:module";
import { resolve } from "node:path";
import { setImmediate } from "node:timers/promises";
import { pathToFileURL } from "node:url";

const EYES = ["Blink", "LookIn", "LookOut"].flatMap((what) => [`eye${what}Left`, `eye${what}Right`]);

/** What the loader of avatars loads: one mesh with a morph target of each name. */
let file;

/** Whatever is asked of it, it answers with itself; as a number it is 0. As a loader, it loads the file. */
const nothing = new Proxy(function () {}, {
  get(_, key) {
    if (key === "loadAsync") return () => file;
    if (key === Symbol.toPrimitive) return () => 0;
    return key === "then" ? undefined : nothing;
  },
  set: () => true,
  apply: () => nothing,
  construct: () => nothing,
});
globalThis.nothing = globalThis.AudioContext = nothing;

/** The class, with nothing in the place of three.js and its add-ons. */
async function load(directory) {
  const main = resolve(directory, "modules/talkinghead.mjs");
  const text = readFileSync(main, "utf8") + readFileSync(resolve(directory, "modules/dynamicbones.mjs"), "utf8");
  const asked = [...text.matchAll(/\bTHREE\.(\w+)|import \{ (\w+) \} from 'three/g)].map((m) => m[1] ?? m[2]);
  const names = [...new Set([...asked, "default"])].map((name) => `nothing as ${name}`);
  const three = `const nothing = globalThis.nothing; export { ${names.join(", ")} };`;
  const url = JSON.stringify(`data:text/javascript,${encodeURIComponent(three)}`);
  const hook = `export const resolve = (name, context, next) =>
    /^three(\\/|$)/.test(name) ? { url: ${url}, shortCircuit: true } : next(name, context);`;
  register(`data:text/javascript,${encodeURIComponent(hook)}`);
  return (await import(pathToFileURL(main))).TalkingHead;
}

/** A new head at time 0, and the mesh of its face. */
async function stand(TalkingHead) {
  const head = new TalkingHead(nothing, { avatarOnly: true, lipsyncModules: ["en"], lipsyncLang: "en" });
  while (!head.lipsync.en) await setImmediate();
  const visemes = head.visemeNames.map((name) => `viseme_${name}`);
  const names = [...visemes, ...head.mtRandomized, ...head.mtExtras.map((extra) => extra.key), ...EYES];
  const morphTargetDictionary = Object.fromEntries(names.map((name, i) => [name, i]));
  const face = { morphTargetDictionary, morphTargetInfluences: names.map(() => 0) };
  const armature = new Proxy({}, { get: (_, key) => (key === "traverse" ? (visit) => visit(face) : nothing) });
  file = { scene: { getObjectByName: (name) => (name === head.opt.modelRoot ? armature : nothing) } };
  await head.showAvatar({ url: "" });
  return { head, face };
}

/** The weights at every instant of a sentence; the visemes come first among the morph targets. */
async function speak(TalkingHead, { n, ...words }, step) {
  const { head, face } = await stand(TalkingHead);
  head.speakAudio({ audio: nothing, ...words }, { isRaw: true });
  return Array.from({ length: n }, (_, i) => {
    head.animate(i ? step : 0);
    return face.morphTargetInfluences.slice(0, head.visemeNames.length).map((w) => Math.round(w * 1e5) / 1e5);
  });
}

const TalkingHead = await load(process.argv[2]);
const { step_ms, sentences } = JSON.parse(readFileSync(0, "utf8"));
const weights = [];
for (const sentence of sentences) weights.push(await speak(TalkingHead, sentence, step_ms));
process.stdout.write(JSON.stringify(weights));
