/** Other people's heads: any GLB or VRM whose morph targets have ARKit, Oculus or VRM names, as a Head. */

import { splitGlb } from "./document";
import { readHead } from "./glb";
import { distance, find, JAW, LIPS, type Landmarks } from "./landmarks";
import { HeadError, type FatEntry, type Head, type Part, type Point, type Turn } from "./model";
import { bonesOf, EYES, kindOf, readVrm, SIDES, subtree, type Side, type Vrm } from "./rig";
import { hanging, kept, Scene, transformed, type Surface, type Wanted } from "./scene";
import { known, plan, type Plan } from "./shapes";

/** Eye distances in metres that are left as they are, and the one that others are brought to. */
const PLAUSIBLE_EYES = [0.045, 0.09];
const EYE_DISTANCE = 0.06;
/** What lies deeper than this under the top of the spine, in metres, is no part of a portrait. */
const BUST_BELOW = 0.35;
const MAX_PARTS = 64;
const NECK_SHARE = 0.4;
/** Without bones: heights, slanting up to the back, between which the neck begins to follow the head. */
const FALLOFF = [-0.16, -0.06];
/** Metres; what a shape moves less is left out. */
const NOTHING = 2e-5;
const EYE_FAPS: Record<Side, number[]> = { l: [23, 25], r: [24, 26] };
const [X, Y, Z]: Point[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

type Named = Map<string, Surface>;
type Subtrees = Map<string, Set<number>>;

/** Our own format or a foreign head, with warnings for people. Throws HeadError and nothing else. */
export function readAnyHead(data: Uint8Array, name = "head"): { head: Head; warnings: string[] } {
  const { document } = splitGlb(data);
  if ((document.extras as { fapstream?: unknown } | undefined)?.fapstream) return { head: readHead(data), warnings: [] };
  return readForeign(data, name);
}

function readForeign(data: Uint8Array, name: string): { head: Head; warnings: string[] } {
  const scene = new Scene(splitGlb(data));
  const vrm = readVrm(scene);
  let surfaces = scene.surfaces(wantedOf(scene, vrm));
  const has = new Set(surfaces.flatMap(({ moves }) => [...moves].filter(([, move]) => move.some((x) => x)).map(([shape]) => shape)));
  if (![...LIPS, ...JAW].some((shape) => has.has(shape))) noFace(scene);
  const sign = vrm.backwards ? -1 : 1;
  if (vrm.backwards) surfaces = surfaces.map((surface) => transformed(surface, Float64Array.of(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1)));
  const rig = bonesOf(scene.nodes, vrm.bones);
  const places = new Map([...rig].map(([bone, i]): [string, Point] => {
    const { world } = scene.nodes[i];
    return [bone, [sign * world[12], world[13], sign * world[14]]];
  }));
  const [normal, marks] = normalised(surfaces, find(surfaces, places));
  const named = namesOf(normal.map(bust).filter(({ triangles }) => triangles.length));
  if (!named.size || named.size > MAX_PARTS) throw new HeadError(`there are ${named.size} parts near the head; 1 to ${MAX_PARTS} can be shown`);
  const subtrees: Subtrees = new Map([...rig].map(([bone, i]) => [bone, subtree(scene.nodes, i)]));
  const eyes = SIDES.flatMap((side) => eyeTurn(side, named, marks, subtrees) ?? []);
  const looks = [...has].filter((shape) => /^(eyeL|l)ook/.test(shape));
  const shapes = eyes.length ? plan(new Set([...has].filter((shape) => !looks.includes(shape))), "eyeLook") : plan(has);
  if (!eyes.length && !looks.length) scene.notes.add("the eyes cannot turn: there are no eye bones, eye meshes or eyeLook shapes");
  const head: Head = {
    name, parts: [...named].map(([part, surface]) => partOf(part, surface)),
    mouth: { center: marks.mouth, size: marks.mouthSize }, camera: cameraOf(marks),
    fat: fatOf(named, shapes), turns: [...eyes, headTurn(named, marks, subtrees)],
  };
  return { head, warnings: [...missing(name, shapes), ...scene.notes] };
}

function missing(name: string, { missing, instead }: Plan): string[] {
  const rows = missing.map((shape) => (instead.has(shape) ? `${shape} (${instead.get(shape)!.join(" + ")} instead)` : shape));
  return rows.length ? [`${name}: shapes are missing: ${rows.join(", ")}`] : [];
}

/** Morph targets by their own names; groups of VRM for shapes that no target is named after. */
function wantedOf(scene: Scene, { groups }: Vrm): Wanted {
  const wanted: Wanted = new Map();
  const add = (key: string, shape: string, strength: number) =>
    wanted.set(key, (wanted.get(key) ?? new Map<string, number>()).set(shape, strength));
  const direct = new Set<string>();
  scene.targetNames().forEach((names, mesh) => {
    const here = new Set<string>();
    names.forEach((target, k) => {
      const shape = known(target);
      if (!shape || here.has(shape)) return;
      here.add(shape);
      add(`${mesh}/${k}`, shape, 1);
    });
    here.forEach((shape) => direct.add(shape));
  });
  for (const [shape, binds] of groups) if (!direct.has(shape)) for (const [mesh, k, strength] of binds) add(`${mesh}/${k}`, shape, strength);
  return wanted;
}

function noFace(scene: Scene): never {
  const seen = scene.targetNames().flat().filter(Boolean).slice(0, 6);
  const has = seen.length ? `its morph targets are called ${seen.join(", ")}` : "it has no named morph targets";
  throw new HeadError(`no face shapes that open the mouth: ${has.slice(0, 140)}; looked for are ARKit's names (jawOpen, mouthSmileLeft, ...), ` +
    "Oculus visemes (viseme_aa, ...) and VRM's expressions (aa, ih, ou, ...)");
}

/** In metres, with the top of the spine in the origin. */
function normalised(surfaces: readonly Surface[], marks: Landmarks): [Surface[], Landmarks] {
  const apart = distance(...marks.eyes);
  const s = apart >= PLAUSIBLE_EYES[0] && apart <= PLAUSIBLE_EYES[1] ? 1 : EYE_DISTANCE / apart;
  const shift = marks.pivot.map((x) => -s * x);
  const to = (p: Point) => p.map((x, k) => s * x + shift[k]) as Point;
  const matrix = Float64Array.of(s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, shift[0], shift[1], shift[2], 1);
  return [surfaces.map((surface) => transformed(surface, matrix)), {
    eyes: [to(marks.eyes[0]), to(marks.eyes[1])], mouth: to(marks.mouth), mouthSize: [s * marks.mouthSize[0], s * marks.mouthSize[1]],
    chin: s * marks.chin + shift[1], top: s * marks.top + shift[1], pivot: [0, 0, 0],
  }];
}

function bust(surface: Surface): Surface {
  const { triangles, positions } = surface;
  const high = (v: number) => positions[3 * v + 1] > -BUST_BELOW;
  return kept(surface, triangles.filter((_, i) => {
    const first = i - (i % 3);
    return high(triangles[first]) || high(triangles[first + 1]) || high(triangles[first + 2]);
  }));
}

/** By part names; the surface of which shapes move most vertices is the skin. */
function namesOf(surfaces: readonly Surface[]): Named {
  const moved = surfaces.map(({ moves }) => [...moves.values()].reduce((sum, move) => sum + movedVertices(move), 0));
  const face = surfaces[moved.indexOf(Math.max(...moved))];
  const named: Named = new Map(face ? [["skin", face]] : []);
  for (const surface of surfaces) {
    if (surface === face) continue;
    let kind = kindOf(surface.names);
    if (["eye", "cornea", "lashes", "brows"].includes(kind)) kind += sideOf(surface);
    let name = kind;
    for (let number = 2; named.has(name); number++) name = `${kind}_${number}`;
    named.set(name, surface);
  }
  return named;
}

function movedVertices(move: Float64Array): number {
  let count = 0;
  for (let i = 0; i < move.length; i += 3) if (Math.fround(move[i]) || Math.fround(move[i + 1]) || Math.fround(move[i + 2])) count++;
  return count;
}

/** `_l` or `_r` for what is all on one side. */
function sideOf(surface: Surface): string {
  const xs = across(surface);
  return xs.every((x) => x > 0) ? "_l" : xs.every((x) => x < 0) ? "_r" : "";
}

/** How far to the left each vertex is. */
function across({ positions }: Surface): Float64Array {
  return positions.filter((_, i) => i % 3 === 0);
}

function partOf(name: string, { positions, normals, uvs, triangles, material }: Surface): Part {
  return { name, positions: Float32Array.from(positions), normals: Float32Array.from(normals), uvs: Float32Array.from(uvs), triangles, material };
}

/** One table for each shape and part, held between 0 and 1 by its knots. */
function fatOf(named: Named, { drives }: Plan): FatEntry[] {
  return [...drives].flatMap(([shape, drive]) => [...named].flatMap(([part, { moves }]): FatEntry[] => {
    const move = moves.get(shape);
    if (!move) return [];
    const moved: number[] = [];
    let most = 0;
    for (let i = 0; i < move.length; i += 3) {
      const far = Math.max(Math.abs(move[i]), Math.abs(move[i + 1]), Math.abs(move[i + 2]));
      if (far > NOTHING) moved.push(i / 3);
      most = Math.max(most, far);
    }
    if (!moved.length) return [];
    const indices = Uint32Array.from(moved);
    const [scale, size] = [most / 32767, 3 * moved.length];
    const deltas = new Int16Array(3 * size);
    for (let i = 0; i < size; i++) deltas[size + i] = Math.round(move[3 * moved[Math.floor(i / 3)] + (i % 3)] / scale);
    deltas.copyWithin(2 * size, size, 2 * size);
    return [{ drive, part, knots: [-1, 1, 2], indices, deltas, scale }];
  }));
}

/** By what hangs on the eye's bone; without one, by the parts that are eyes on that side. */
function eyeTurn(side: Side, named: Named, { eyes }: Landmarks, subtrees: Subtrees): Turn | null {
  const bone = subtrees.get(EYES[side]);
  const parts: string[] = [];
  const weights = new Map<string, Float32Array>();
  for (const [name, surface] of named) {
    const ball = /^(eye|cornea)/.test(name);
    const share = bone ? hanging(surface, bone) : across(surface).map((x) => Number(ball && x > 0 === (side === "l")));
    if (!share.some((w) => w)) continue;
    parts.push(name);
    if (!share.every((w) => w === 1)) weights.set(name, levels(share));
  }
  return parts.length ? { faps: EYE_FAPS[side], axes: [Y, X], parts, pivot: eyes[side === "l" ? 0 : 1], weights } : null;
}

function headTurn(named: Named, { pivot }: Landmarks, subtrees: Subtrees): Turn {
  const [head, neck] = [subtrees.get("head"), subtrees.get("neck")];
  const weights = new Map<string, Float32Array>();
  for (const [name, surface] of named) {
    const share = head ? hanging(surface, head) : falloff(surface);
    if (head && neck) hanging(surface, new Set([...neck].filter((node) => !head.has(node)))).forEach((w, v) => (share[v] += NECK_SHARE * w));
    if (!share.every((w) => w === 1)) weights.set(name, levels(share));
  }
  return { faps: [48, 49, 50], axes: [X, Y, Z], parts: null, pivot, weights };
}

function falloff({ positions }: Surface): Float64Array {
  return Float64Array.from({ length: positions.length / 3 }, (_, v) => {
    const slant = positions[3 * v + 1] + 0.6 * positions[3 * v + 2];
    const rise = Math.min(Math.max((slant - FALLOFF[0]) / (FALLOFF[1] - FALLOFF[0]), 0), 1);
    return rise * rise * (3 - 2 * rise);
  });
}

/** In steps of 1/255, as they are stored. */
function levels(share: Float64Array): Float32Array {
  return Float32Array.from(share, (w) => Math.round(Math.min(Math.max(w, 0), 1) * 255) / 255);
}

/** As the average adult's portrait is framed, from the chin to the top of the hair. */
function cameraOf({ eyes, chin, top }: Landmarks): Head["camera"] {
  return { target: [(eyes[0][0] + eyes[1][0]) / 2, chin + 0.32 * (top - chin), 0.03], height: 1.565 * (top - chin) };
}
