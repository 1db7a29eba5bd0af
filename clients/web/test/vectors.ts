/** Reads protocol/vectors: `{"hex"}`, `{"i16"}` and `{"i32"}` become the arrays they stand for. */

import { readFileSync } from "node:fs";

const ROOT = new URL("../../../protocol/vectors/", import.meta.url);

export function vectors<T>(name: string): T[] {
  return JSON.parse(readFileSync(new URL(name, ROOT), "utf-8"), revive) as T[];
}

export function bytes(hex: string): Uint8Array {
  return Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));
}

export function hex(data: Uint8Array): string {
  return Array.from(data, (b) => b.toString(16).padStart(2, "0")).join("");
}

function revive(_key: string, value: unknown): unknown {
  if (!value || typeof value !== "object" || Object.keys(value).length !== 1) return value;
  const box = value as { hex?: string; i16?: number[]; i32?: number[] };
  if (box.hex !== undefined) return bytes(box.hex);
  if (box.i16) return Int16Array.from(box.i16);
  return box.i32 ? Int32Array.from(box.i32) : value;
}
