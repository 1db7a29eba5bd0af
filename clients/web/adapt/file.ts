/** The file that points are kept in, as fapstream/adapt/points.py reads and writes it. */

import { VIEWS, within, type Facing, type FeaturePoint, type Mark, type Marks, type Size, type ViewName } from "./marks";

const VERSION = 1;

/** The points of one photo, and the photo they belong to. */
export interface Sheet {
  size: Size;
  marks: Marks;
  facing?: Facing;
}

export type Sheets = Partial<Record<ViewName, Sheet>>;

/** The text of a file. */
export function formatPoints(sheets: Sheets): string {
  const rows = VIEWS.flatMap((view) => (sheets[view] ? [[view, row(sheets[view])]] : []));
  return `${JSON.stringify({ version: VERSION, ...Object.fromEntries(rows) }, null, 1)}\n`;
}

function row({ size, marks, facing }: Sheet): object {
  const points = [...marks].map(([name, { at: [x, y], confidence }]) => {
    const sure = confidence === undefined ? [] : [round(confidence, 3)];
    return [name, [round(x, 2), round(y, 2), ...sure]];
  });
  return { ...(facing && { facing }), size, points: Object.fromEntries(points) };
}

function round(value: number, digits: number): number {
  return Number(value.toFixed(digits));
}

/** What `formatPoints` wrote. Throws RangeError, saying where, for anything else. */
export function parsePoints(text: string, features: readonly FeaturePoint[]): Sheets {
  const data = parseJson(text);
  if (!isObject(data) || data.version !== VERSION) fail("version", `is not ${VERSION}: not a file of feature points`);
  const sheets = VIEWS.filter((view) => data[view] !== undefined && data[view] !== null)
    .map((view) => [view, sheet(data[view], view, features)] as const);
  if (!sheets.length) fail("front", "is missing");
  return Object.fromEntries(sheets);
}

function parseJson(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return fail("the file", "is not JSON");
  }
}

function sheet(data: unknown, view: ViewName, features: readonly FeaturePoint[]): Sheet {
  if (!isObject(data) || !isObject(data.points)) return fail(view, "has no points");
  const { size, facing } = data;
  if (!isNumbers(size, 2, 2) || !size.every((side) => side > 0)) return fail(`${view}.size`, "is not a width and a height");
  const known = new Set(features.filter(({ views }) => views.includes(view)).map(({ name }) => name));
  const marks = Object.entries(data.points).map(([name, value]): [string, Mark] => {
    if (!known.has(name)) fail(`${view}.points.${name.slice(0, 40)}`, `is no feature point of a ${view} photo`);
    if (!isNumbers(value, 2, 3)) return fail(`${view}.points.${name}`, "is not [x, y] or [x, y, confidence]");
    const [x, y, confidence] = value;
    return [name, { at: within([x, y], [size[0], size[1]]), ...(confidence !== undefined && { confidence }) }];
  });
  return { size: [size[0], size[1]], marks: new Map(marks), ...((facing === "left" || facing === "right") && { facing }) };
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function isNumbers(value: unknown, least: number, most: number): value is number[] {
  return Array.isArray(value) && value.length >= least && value.length <= most && value.every(Number.isFinite);
}

function fail(place: string, reason: string): never {
  throw new RangeError(`${place} ${reason}`);
}
