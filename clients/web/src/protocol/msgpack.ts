/**
 * The part of MessagePack that protocol/SPEC.md section 2 and protocol/ADAPT.md use, strictly: a float never passes
 * for an integer, a string is valid UTF-8, nothing follows the value. General decoders blur all three.
 */

export type Plain = null | boolean | number | string | Uint8Array | Float | Plain[] | PlainMap;
export type PlainMap = Map<Plain, Plain>;

/** A floating-point number on the wire: of 64 bits when written. */
export class Float {
  constructor(readonly value: number) {}
}

const MAX_DEPTH = 512;
const MAX_MAP = 64;
const MAX_ARRAY = 4096;
const UTF8 = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });
const TO_UTF8 = new TextEncoder();

/** The one value in `data`; `bin` is copied, so that it is aligned. Throws RangeError or TypeError. */
export function unpack(data: Uint8Array): Plain {
  const reader = new Reader(data);
  const value = reader.value(0);
  if (reader.at !== data.length) throw new RangeError("bytes after the end");
  return value;
}

class Reader {
  at = 0;
  private readonly view: DataView;

  constructor(private readonly data: Uint8Array) {
    this.view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  }

  value(depth: number): Plain {
    if (depth > MAX_DEPTH) throw new RangeError("nested too deeply");
    const head = this.uint(1);
    if (head < 0x80) return head;
    if (head < 0x90) return this.map(head & 0x0f, depth);
    if (head < 0xa0) return this.array(head & 0x0f, depth);
    if (head < 0xc0) return this.text(head & 0x1f);
    if (head >= 0xe0) return head - 0x100;
    return this.long(head, depth);
  }

  private long(head: number, depth: number): Plain {
    switch (head) {
      case 0xc0: return null;
      case 0xc2: return false;
      case 0xc3: return true;
      case 0xc4: case 0xc5: case 0xc6: return this.take(this.uint(1 << (head - 0xc4))).slice();
      case 0xca: return new Float(this.view.getFloat32(this.skip(4)));
      case 0xcb: return new Float(this.view.getFloat64(this.skip(8)));
      case 0xcc: case 0xcd: case 0xce: return this.uint(1 << (head - 0xcc));
      case 0xcf: return Number(this.view.getBigUint64(this.skip(8)));
      case 0xd0: return this.view.getInt8(this.skip(1));
      case 0xd1: return this.view.getInt16(this.skip(2));
      case 0xd2: return this.view.getInt32(this.skip(4));
      case 0xd3: return Number(this.view.getBigInt64(this.skip(8)));
      case 0xd9: case 0xda: case 0xdb: return this.text(this.uint(1 << (head - 0xd9)));
      case 0xdc: case 0xdd: return this.array(this.uint(head === 0xdc ? 2 : 4), depth);
      case 0xde: case 0xdf: return this.map(this.uint(head === 0xde ? 2 : 4), depth);
      default: throw new TypeError(`byte 0x${head.toString(16)} begins nothing this protocol uses`);
    }
  }

  /** Big-endian unsigned integer of 1, 2 or 4 bytes. */
  private uint(bytes: number): number {
    const at = this.skip(bytes);
    if (bytes === 1) return this.view.getUint8(at);
    return bytes === 2 ? this.view.getUint16(at) : this.view.getUint32(at);
  }

  private skip(bytes: number): number {
    const at = this.at;
    if (at + bytes > this.data.length) throw new RangeError("cut short");
    this.at += bytes;
    return at;
  }

  private take(bytes: number): Uint8Array {
    const at = this.skip(bytes);
    return this.data.subarray(at, at + bytes);
  }

  private text(bytes: number): string {
    return UTF8.decode(this.take(bytes));
  }

  private array(length: number, depth: number): Plain[] {
    if (length > MAX_ARRAY) throw new RangeError(`array of ${length}`);
    return Array.from({ length }, () => this.value(depth + 1));
  }

  private map(length: number, depth: number): PlainMap {
    if (length > MAX_MAP) throw new RangeError(`map of ${length}`);
    const map: PlainMap = new Map();
    for (let i = 0; i < length; i++) {
      const key = this.value(depth + 1);
      map.set(key, this.value(depth + 1));
    }
    return map;
  }
}

/** `value` in the shortest form. Numbers must be safe integers; others go as `Float`. Throws RangeError or TypeError. */
export function pack(value: Plain): Uint8Array<ArrayBuffer> {
  const writer = new Writer();
  writer.value(value);
  return writer.bytes();
}

class Writer {
  private data = new Uint8Array(256);
  private view = new DataView(this.data.buffer);
  private at = 0;

  bytes(): Uint8Array<ArrayBuffer> {
    return this.data.slice(0, this.at);
  }

  value(value: Plain): void {
    if (value === null) this.uint(0xc0, 1);
    else if (typeof value === "boolean") this.uint(value ? 0xc3 : 0xc2, 1);
    else if (typeof value === "number") this.integer(value);
    else if (typeof value === "string") this.text(TO_UTF8.encode(value));
    else if (value instanceof Uint8Array) this.binary(value);
    else if (Array.isArray(value)) this.array(value);
    else if (value instanceof Map) this.map(value);
    else this.float(value);
  }

  private integer(n: number): void {
    if (!Number.isSafeInteger(n)) throw new RangeError(`${n} is no safe integer`);
    if (n >= 0) this.natural(n);
    else if (n >= -0x20) this.uint(n + 0x100, 1);
    else if (n >= -0x80) this.tagged(0xd0, n, 1);
    else if (n >= -0x8000) this.tagged(0xd1, n, 2);
    else if (n >= -0x80000000) this.tagged(0xd2, n, 4);
    else this.wide(0xd3, n);
  }

  private natural(n: number): void {
    if (n < 0x80) this.uint(n, 1);
    else if (n < 0x100) this.tagged(0xcc, n, 1);
    else if (n < 0x10000) this.tagged(0xcd, n, 2);
    else if (n < 0x100000000) this.tagged(0xce, n, 4);
    else this.wide(0xcf, n);
  }

  private text(utf8: Uint8Array): void {
    if (utf8.length < 32) this.uint(0xa0 | utf8.length, 1);
    else this.sized(0xd9, utf8.length, 1);
    this.raw(utf8);
  }

  private binary(bytes: Uint8Array): void {
    this.sized(0xc4, bytes.length, 1);
    this.raw(bytes);
  }

  private array(items: Plain[]): void {
    if (items.length < 16) this.uint(0x90 | items.length, 1);
    else this.sized(0xdc, items.length, 2);
    items.forEach((item) => this.value(item));
  }

  private map(map: PlainMap): void {
    if (map.size < 16) this.uint(0x80 | map.size, 1);
    else this.sized(0xde, map.size, 2);
    map.forEach((value, key) => (this.value(key), this.value(value)));
  }

  /** A tag followed by the shortest of the lengths it comes with; `least` bytes is the first one. */
  private sized(tag: number, length: number, least: 1 | 2): void {
    const forms = least === 1 ? [1, 2, 4] : [2, 4];
    const step = forms.findIndex((bytes) => length < 2 ** (8 * bytes));
    this.tagged(tag + step, length, forms[step]);
  }

  private float({ value }: Float): void {
    this.uint(0xcb, 1);
    const at = this.room(8);
    this.view.setFloat64(at, value);
  }

  private tagged(tag: number, n: number, bytes: number): void {
    this.uint(tag, 1);
    this.uint(n, bytes);
  }

  private wide(tag: number, n: number): void {
    this.uint(tag, 1);
    const at = this.room(8);
    this.view.setBigInt64(at, BigInt(n));
  }

  private uint(n: number, bytes: number): void {
    const at = this.room(bytes);
    if (bytes === 1) this.view.setUint8(at, n);
    else if (bytes === 2) this.view.setUint16(at, n);
    else this.view.setUint32(at, n);
  }

  private raw(bytes: Uint8Array): void {
    const at = this.room(bytes.length);
    this.data.set(bytes, at);
  }

  private room(bytes: number): number {
    const at = this.at;
    this.at += bytes;
    if (this.at > this.data.length) {
      const grown = new Uint8Array(Math.max(this.at, this.data.length * 2));
      grown.set(this.data);
      this.data = grown;
      this.view = new DataView(grown.buffer);
    }
    return at;
  }
}
