/**
 * Messages to bytes and back, as protocol/SPEC.md section 2 has it. Driven by the generated field
 * tables: a new message needs no code here.
 */

import { LIMITS, MESSAGES, STRUCTS, type FieldSpec, type Message } from "./generated";
import { pack, unpack, type Plain, type PlainMap } from "./msgpack";

export type Side = "client" | "server";
type Fields = Record<string, unknown>;

const ITEM_BYTES: Record<string, number> = { i16: 2, i32: 4 };
const LITTLE = new Uint8Array(Uint16Array.of(1).buffer)[0] === 1;

/** The conversation broke the contract. `code` is one of protocol/schema/errors.json. */
export class ProtocolError extends Error {
  constructor(message: string, readonly code: string = "protocol", readonly fatal: boolean = true) {
    super(message);
    this.name = "ProtocolError";
  }
}

/** One WebSocket frame's worth of bytes. Throws ProtocolError when a value does not fit its field. */
export function encode(message: Message): Uint8Array<ArrayBuffer> {
  const { type, ...fields } = message as unknown as Fields & { type: string };
  const map = packFields(fields, MESSAGES[type].fields, type);
  const data = pack(new Map<Plain, Plain>([["type", type], ...map]));
  if (data.length > LIMITS.max_message_bytes) throw new ProtocolError(`${type}: ${data.length} bytes`);
  return data;
}

/**
 * The message in `data`, sent by `sender`; null for a type this version does not know. `seen` is told the type
 * before the rest is looked at.
 * Throws ProtocolError: fatal `protocol` if the bytes are no message at all, else `bad_message`.
 */
export function decode(data: Uint8Array, sender: Side, seen?: (type: string) => void): Message | null {
  const fields = readMap(data);
  const type = fields.get("type");
  seen?.(String(type));
  if (typeof type !== "string") throw new ProtocolError("a message needs a `type` of type str");
  if (!Object.hasOwn(MESSAGES, type)) return null;
  const { from, fields: specs } = MESSAGES[type];
  if (from !== sender && from !== "both") throw new ProtocolError(`\`${type}\` does not come from a ${sender}`);
  return { type, ...readFields(fields, specs, type) } as unknown as Message;
}

function readMap(data: Uint8Array): PlainMap {
  if (data.length > LIMITS.max_message_bytes) throw new ProtocolError(`message of ${data.length} bytes`);
  let value: Plain;
  try {
    value = unpack(data);
  } catch (e) {
    throw new ProtocolError(`not a MessagePack map: ${(e as Error).message}`);
  }
  if (!(value instanceof Map)) throw new ProtocolError("not a MessagePack map");
  return value;
}

function readFields(fields: PlainMap, specs: FieldSpec[], where: string): Fields {
  const values: Fields = {};
  for (const spec of specs) {
    const raw = fields.get(spec.name);
    if (raw === undefined) {
      if (spec.optional) continue;
      throw bad(`${where}.${spec.name} is missing`);
    }
    const problem = problemOf(raw, spec);
    if (problem) throw bad(`${where}.${spec.name}: ${problem}`);
    values[spec.name] = rich(raw, spec, where);
  }
  return values;
}

/** A checked MessagePack value as the messages hold it. */
function rich(raw: Plain, spec: FieldSpec, where: string): unknown {
  if (spec.type === "i16") return new Int16Array(inOrder(raw as Uint8Array, 2).buffer);
  if (spec.type === "i32") return new Int32Array(inOrder(raw as Uint8Array, 4).buffer);
  if (spec.type === "text" && typeof raw === "string") return new TextEncoder().encode(raw);
  if (spec.type === "list" && spec.of! in STRUCTS) {
    return (raw as PlainMap[]).map((item) => readFields(item, STRUCTS[spec.of!], `${where}.${spec.name}[]`));
  }
  return raw;
}

function packFields(values: Fields, specs: FieldSpec[], where: string): PlainMap {
  const map: PlainMap = new Map();
  for (const spec of specs) {
    const value = values[spec.name];
    if (value === undefined && spec.optional) continue;
    const raw = plain(value, spec, where);
    const problem = problemOf(raw, spec);
    if (problem) throw bad(`${where}.${spec.name}: ${problem}`);
    map.set(spec.name, raw);
  }
  return map;
}

/** A value as MessagePack carries it. */
function plain(value: unknown, spec: FieldSpec, where: string): Plain {
  if (value instanceof Int16Array || value instanceof Int32Array) {
    const bytes = new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
    return inOrder(bytes, value.BYTES_PER_ELEMENT);
  }
  if (spec.type === "list" && spec.of! in STRUCTS && Array.isArray(value)) {
    return value.map((item) => packFields(item as Fields, STRUCTS[spec.of!], `${where}.${spec.name}[]`));
  }
  return value as Plain;
}

/** What is wrong with a MessagePack value for this field; empty if nothing. */
function problemOf(raw: Plain, spec: FieldSpec): string {
  if (!hasType(raw, spec)) return `expected ${spec.type}`;
  if (spec.enum && !spec.enum.includes(raw as string | number)) return `none of ${spec.enum.join(", ")}`;
  if (spec.type === "bool") return "";
  if (spec.type === "int") {
    const [low, high] = [spec.min ?? -Number.MAX_SAFE_INTEGER, spec.max ?? Number.MAX_SAFE_INTEGER];
    return (raw as number) >= low && (raw as number) <= high ? "" : `${raw} is not within ${low} to ${high}`;
  }
  const size = sizeOf(raw as string | Uint8Array | Plain[], spec);
  if (!Number.isInteger(size)) return `${(raw as Uint8Array).length} bytes are no ${spec.type}`;
  return spec.max === undefined || size <= spec.max ? "" : `length ${size}, more than ${spec.max}`;
}

function sizeOf(raw: string | Uint8Array | Plain[], spec: FieldSpec): number {
  if (typeof raw === "string") return [...raw].length;
  return raw.length / (ITEM_BYTES[spec.type] ?? 1);
}

function hasType(raw: Plain, spec: FieldSpec): boolean {
  switch (spec.type) {
    case "int": return typeof raw === "number" && Number.isInteger(raw);
    case "str": return typeof raw === "string";
    case "bool": return typeof raw === "boolean";
    case "text": return typeof raw === "string" || raw instanceof Uint8Array;
    case "u8": case "i16": case "i32": return raw instanceof Uint8Array;
    case "list": return Array.isArray(raw) && raw.every((item) =>
      spec.of! in STRUCTS ? item instanceof Map : typeof item === "string");
  }
}

/** Little-endian items of `size` bytes in this machine's order, or back; always an aligned copy. */
function inOrder(bytes: Uint8Array, size: number): Uint8Array<ArrayBuffer> {
  const copy = new Uint8Array(bytes);
  for (let i = 0; !LITTLE && i < copy.length; i += size) copy.subarray(i, i + size).reverse();
  return copy;
}

function bad(message: string): ProtocolError {
  return new ProtocolError(message, "bad_message", false);
}
