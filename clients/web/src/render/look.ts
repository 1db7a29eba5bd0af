/** The look that all clients share (fapstream/assets/look): which shader settings a part takes, and in which order parts are drawn. */

import look from "../../../../fapstream/assets/look/look.json";

/** A setting of the shader: a vector, a number or a switch. */
type Setting = number | readonly number[] | boolean;
type Settings = Record<string, Setting | undefined>;

export { look };

/** Settings of the part `name`, as text to be put after `#define NAME `; what is false is left out. */
export function definesFor(name: string): Record<string, string> {
  const finish = look.finishes.find(({ parts }) => startsOneOf(name, parts))!;
  const settings: Settings = { ...look.defines, ...finish.defines };
  const chosen = Object.entries(settings).filter(([, value]) => value !== undefined && value !== false);
  return Object.fromEntries(chosen.map(([key, value]) => [key, glsl(value as number | readonly number[] | true)]));
}

/** What is drawn first hides what lies under it; what may be transparent comes last. */
export function layerOf(name: string, transparent: boolean): number {
  const named = look.layers.findIndex((start) => start && name.startsWith(start));
  return (named < 0 ? look.layers.indexOf("") : named) + (transparent ? look.layers.length : 0);
}

/** Does the part stand in the light of others? */
export function castsShadow(name: string): boolean {
  return startsOneOf(name, look.shadow.casters);
}

function startsOneOf(name: string, starts: readonly string[]): boolean {
  return starts.some((start) => name.startsWith(start));
}

function glsl(value: number | readonly number[] | true): string {
  if (value === true) return "1";
  return typeof value === "number" ? value.toFixed(5) : `vec${value.length}(${value.map((x) => x.toFixed(5)).join(", ")})`;
}
