/** Bones and kinds of parts in other people's heads, told by their names, and what VRM says beyond glTF. */

import partNames from "../../../../fapstream/head/data/part_names.tsv?raw";
import { list, natural, number, object, type Json } from "./document";
import { HeadError } from "./model";
import type { Node, Scene } from "./scene";
import { known, PRESET, rows } from "./shapes";

export const SIDES = ["l", "r"] as const;
export type Side = (typeof SIDES)[number];
export const EYES: Record<Side, string> = { l: "leftEye", r: "rightEye" };

const SIDE: Record<Side, RegExp> = { l: /left|(?:^|[\s_.:-])l(?:[\s_.:-]|$)/i, r: /right|(?:^|[\s_.:-])r(?:[\s_.:-]|$)/i };
const NO_EYE = /brow|lid|lash|end$|target|look|corner/i;
const LAST = /(?:^|[\s_.:-]|(?<=[a-z0-9])(?=[HN]))([Hh]ead|HEAD|[Nn]eck|NECK)$/;
const KINDS = rows(partNames).map(([kind, words]) => [kind, words.split(" ")] as const);
const MAX_BINDS = 4096;

/** `groups`: [mesh, target, strength] by face shape. `backwards`: looks along -z, as VRM 0 has it. */
export interface Vrm {
  bones: Map<string, number>;
  groups: Map<string, [number, number, number][]>;
  backwards: boolean;
}

/** What a part is, from the names of its material, mesh and node; `part` where nothing is recognised. */
export function kindOf(names: readonly string[]): string {
  for (const name of names) {
    const plain = name.toLowerCase().replaceAll("brown", "");
    for (const [kind, words] of KINDS) if (words.some((word) => plain.includes(word))) return kind;
  }
  return "part";
}

/** Node numbers of `head`, `neck`, `leftEye` and `rightEye`, as far as there are any; `given` is what the file says. */
export function bonesOf(nodes: readonly Node[], given: ReadonlyMap<string, number>): Map<string, number> {
  const wanted = ["head", "neck", EYES.l, EYES.r];
  const found = new Map([...given].filter(([name]) => wanted.includes(name)));
  const add = (name: string, i: number) => found.has(name) || found.set(name, i);
  nodes.forEach(({ name, mesh }, i) => {
    if (mesh !== undefined) return;
    const last = LAST.exec(name);
    if (last) add(last[1].toLowerCase(), i);
    else if (/eye/i.test(name) && !NO_EYE.test(name)) for (const side of SIDES) if (SIDE[side].test(name)) add(EYES[side], i);
  });
  return found;
}

/** A node and everything that hangs on it. */
export function subtree(nodes: readonly Node[], top: number): Set<number> {
  const found = new Set([top]);
  nodes.forEach((_, i) => {
    const trail = [];
    let at = i;
    for (; at >= 0 && !found.has(at); at = nodes[at].parent) trail.push(at);
    if (at >= 0) trail.forEach((node) => found.add(node));
  });
  return found;
}

export function readVrm(scene: Scene): Vrm {
  const [vrm1, vrm0] = [scene.extension("VRMC_vrm"), scene.extension("VRM")];
  const vrm = vrm1 ?? vrm0 ?? {};
  const groups: Vrm["groups"] = new Map();
  for (const [name, mesh, bind, full] of vrm1 ? expressions(scene, vrm) : blendShapes(vrm)) {
    const shape = known(PRESET + name);
    const where = `expressions.${name}`;
    const row: [number, number, number] = [natural(mesh, where), natural(bind.index, where, MAX_BINDS), number(bind.weight ?? full, where) / full];
    if (shape) groups.set(shape, [...(groups.get(shape) ?? []), row]);
  }
  return { bones: humanBones(vrm, scene.nodes.length), groups, backwards: !vrm1 && !!vrm0 };
}

type Bind = [name: string, mesh: unknown, bind: Json, full: number];

function humanBones(vrm: Json, count: number): Map<string, number> {
  const { humanBones: bones } = soft(vrm.humanoid);
  const pairs: [unknown, unknown][] = Array.isArray(bones) ? bones.map((row) => [soft(row).bone, row]) : Object.entries(soft(bones));
  return new Map(pairs.filter(([, row]) => row && typeof row === "object")
    .map(([name, row]) => [String(name), natural((row as Json).node, `humanBones.${String(name)}`, count - 1)]));
}

function expressions(scene: Scene, vrm: Json): Bind[] {
  const { preset, custom } = soft(vrm.expressions);
  return [...Object.entries(soft(preset)), ...Object.entries(soft(custom))].flatMap(([name, row]) =>
    binds(soft(row).morphTargetBinds, name).map((bind): Bind => {
      const node = scene.nodes[bind.node as number] as Node | undefined;
      if (!node) throw new HeadError(`expressions.${name}: there is no node ${String(bind.node)}`);
      return [name, node.mesh, bind, 1];
    }));
}

function blendShapes(vrm: Json): Bind[] {
  const { blendShapeGroups: groups } = soft(vrm.blendShapeMaster);
  return (Array.isArray(groups) ? groups : []).map(soft).flatMap((row) => {
    const preset = String(row.presetName ?? "").toLowerCase();
    const name = ["", "unknown"].includes(preset) ? String(row.name ?? "") : preset;
    return binds(row.binds, name).map((bind): Bind => [name, bind.mesh, bind, 100]);
  });
}

function binds(value: unknown, name: string): Json[] {
  return list(value ?? [], `expressions.${name}`).slice(0, MAX_BINDS).map((bind) => object(bind, `expressions.${name}`));
}

/** The object, or an empty one. */
function soft(value: unknown): Json {
  return value && typeof value === "object" ? (value as Json) : {};
}
