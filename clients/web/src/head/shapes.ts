/** The face shapes other people's avatars have, ARKit's and Oculus', and how FAPs drive them. The tables are fapstream's. */

import aliases from "../../../../fapstream/head/data/aliases.tsv?raw";
import driveTable from "../../../../fapstream/head/data/drives.tsv?raw";
import substituteTable from "../../../../fapstream/head/data/substitutes.tsv?raw";
import visemeTable from "../../../../fapstream/head/data/visemes.tsv?raw";

/** [FAP, strength per FAP unit] pairs; the sum is held between 0 and 1. */
export type Drive = [number, number][];
type Pairs = [string, number][];

/** Before the names of VRM's presets, which are not names of morph targets. */
export const PRESET = "vrm:";

/** What drives the shapes a head has. `missing`: ARKit shapes it lacks; `instead`: what stands in for them. */
export interface Plan {
  drives: Map<string, Drive>;
  missing: string[];
  instead: Map<string, string[]>;
}

/** Rows of a table: name, TAB, the rest. */
export function rows(table: string): [string, string][] {
  const lines = table.split("\n").filter((line) => line.trim() && !line.startsWith("#"));
  return lines.map((line) => [line.slice(0, line.indexOf("\t")), line.slice(line.indexOf("\t") + 1)]);
}

const pairs = (text: string): Pairs => text.split(" ").map((pair) => [pair.split("=")[0], Number(pair.split("=")[1])]);
const drives: [string, Drive][] = rows(driveTable).map(([name, text]) => [name, pairs(text).map(([fap, value]) => [Number(fap), value / 1000])]);
const substitutes: [string, Pairs][] = rows(substituteTable).map(([name, text]) => [name, pairs(text)]);
const names = tableOfNames();

/**
 * The name used here for what a file calls `name`. Case, blanks, underscores, prefixes up to a dot or colon and
 * a final .001 do not count; _L is Left.
 */
export function known(name: string): string | undefined {
  const preset = name.startsWith(PRESET) ? PRESET : "";
  return names.get(preset + keyOf(name.slice(preset.length)));
}

/** How FAPs drive a head that has the shapes `has`; those that begin with `without` are neither driven nor missing. */
export function plan(has: ReadonlySet<string>, without?: string): Plan {
  const found = new Map<string, Map<number, number>>();
  const result: Plan = { drives: new Map(), missing: [], instead: new Map() };
  for (const [name, drive] of drives) {
    if (without && name.startsWith(without)) continue;
    const parts = has.has(name) ? new Map([[name, 1]]) : standIns(name, has);
    if (!has.has(name)) result.missing.push(name);
    if (!has.has(name) && parts.size) result.instead.set(name, [...parts.keys()]);
    for (const [other, strength] of parts) {
      const row = found.get(other) ?? new Map<number, number>();
      found.set(other, row);
      for (const [fap, value] of drive) row.set(fap, (row.get(fap) ?? 0) + strength * value);
    }
  }
  for (const [name, row] of found) {
    const drive = [...row].filter(([, value]) => Math.abs(value) > 1e-9).sort(([a], [b]) => a - b);
    if (drive.length) result.drives.set(name, drive);
  }
  return result;
}

/** The shapes in `has`, with strengths, that stand in for one that is missing. */
function standIns(name: string, has: ReadonlySet<string>, seen: string[] = []): Map<string, number> {
  for (const [, choice] of substitutes.filter(([missing]) => missing === name)) {
    const total = new Map<string, number>();
    const complete = choice.every(([other, strength]) => {
      const found = has.has(other) ? new Map([[other, 1]]) : seen.includes(other) ? new Map<string, number>() : standIns(other, has, [...seen, name]);
      for (const [shape, share] of found) total.set(shape, (total.get(shape) ?? 0) + strength * share);
      return found.size > 0;
    });
    if (complete && total.size) return total;
  }
  return new Map();
}

function keyOf(name: string): string {
  const plain = name.replace(/\.\d+$/, "").replace(/[\s_-](l|left)$/i, "Left").replace(/[\s_-](r|right)$/i, "Right");
  return plain.split(/[.:]/).at(-1)!.toLowerCase().replace(/[^a-z0-9]/g, "");
}

function tableOfNames(): Map<string, string> {
  const proper = [
    ...drives.map(([name]) => name), ...rows(visemeTable).map(([name]) => name), "mouthShrugUpper",
    ...substitutes.flatMap(([, choice]) => choice.map(([name]) => name)),
  ];
  const table = new Map(proper.map((name) => [keyOf(name), name]));
  for (const [name, text] of rows(aliases)) {
    for (const alias of text.split(" ")) {
      const preset = alias.startsWith(PRESET) ? PRESET : "";
      table.set(preset + keyOf(alias.slice(preset.length)), name);
    }
  }
  for (const [key, name] of [...table]) if (!key.startsWith(PRESET)) table.set(PRESET + key, name);
  return table;
}
