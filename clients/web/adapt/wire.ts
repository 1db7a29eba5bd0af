/** The messages of protocol/ADAPT.md, to and from MessagePack. */

import { Float, pack, unpack, type Plain, type PlainMap } from "../src/protocol/msgpack";
import { VIEWS, type Facing, type FeaturePoint, type Mark, type Marks, type Position, type ViewName } from "./marks";

export const SUBPROTOCOL = "fapstream.adapt.v1";

export interface Ready { type: "ready"; points: FeaturePoint[]; edges: Uint16Array; automatic: boolean; methods: string[] }
export interface Photo {
  type: "photo"; view: ViewName; width: number; height: number; picture: Uint8Array<ArrayBuffer>; points: Marks; facing?: Facing; note?: string;
}
/** The fitted head in one photo: its vertices (n, 2), and where it has each feature point. */
export interface Laid { mesh: Float32Array; points: ReadonlyMap<string, Position>; facing?: Facing }
export interface Fit { type: "fit"; seq: number; front?: Laid; profile?: Laid; fitted: boolean; error_px?: number; ms?: number }
export interface Head { type: "head"; seq: number; head: Uint8Array<ArrayBuffer>; points: string }
export interface Fault { type: "error"; code: string; message: string; seq?: number; view?: ViewName; fatal: boolean }
export type ServerMessage = Ready | Photo | Fit | Head | Fault;

export interface Hello { type: "hello"; token?: string }
export interface PhotoUp { type: "photo"; view: ViewName; data: Uint8Array }
export interface PointsUp { type: "points"; seq: number; front: Marks; profile?: Marks; method?: string }
export interface HeadUp extends Omit<PointsUp, "type"> { type: "head"; name?: string }
/** What is answered. */
export type Asked = PhotoUp | PointsUp | HeadUp;
export type ClientMessage = Hello | Asked;

export function encode(message: ClientMessage): Uint8Array<ArrayBuffer> {
  return pack(new Map(Object.entries(message).map(([name, value]) => [name, value instanceof Map ? packMarks(value) : value])));
}

function packMarks(marks: Marks): PlainMap {
  const numbers = ({ at, confidence }: Mark) => [...at, ...(confidence === undefined ? [] : [confidence])];
  return new Map([...marks].map(([name, mark]) => [name, numbers(mark).map((value) => new Float(value))]));
}

/** Throws RangeError or TypeError for what is no message of the server. */
export function decode(data: Uint8Array): ServerMessage {
  const fields = new Fields(unpack(data), "message");
  const read = READERS[fields.text("type")];
  if (!read) throw new TypeError(`unknown message ${fields.text("type").slice(0, 40)}`);
  return read(fields);
}

const READERS: Record<string, (fields: Fields) => ServerMessage> = {
  ready: (f) => ({
    type: "ready", points: f.list("points").map(featurePoint), edges: new Uint16Array(whole(f.bytes("edges"), 4).buffer),
    automatic: f.flag("automatic"), methods: f.list("methods").map(String),
  }),
  photo: (f) => ({
    type: "photo", view: f.view("view"), width: f.number("width"), height: f.number("height"), picture: f.bytes("picture"),
    points: f.positions("points", ([x, y, confidence]) => ({ at: [x, y], ...(confidence !== undefined && { confidence }) })),
    ...f.facing(), ...f.optional("note", () => f.text("note")),
  }),
  fit: (f) => ({
    type: "fit", seq: f.number("seq"), fitted: f.flag("fitted"), ...f.optional("error_px", () => f.number("error_px")),
    ...f.optional("ms", () => f.number("ms")), ...f.optional("front", () => laid(f, "front")), ...f.optional("profile", () => laid(f, "profile")),
  }),
  head: (f) => ({ type: "head", seq: f.number("seq"), head: f.bytes("head"), points: f.text("points") }),
  error: (f) => ({
    type: "error", code: f.text("code"), message: f.text("message"), fatal: f.has("fatal") && f.flag("fatal"),
    ...f.optional("seq", () => f.number("seq")), ...f.optional("view", () => f.view("view")),
  }),
};

function featurePoint(value: Plain): FeaturePoint {
  const f = new Fields(value, "points");
  const views = f.list("views").filter((view): view is ViewName => VIEWS.includes(view as ViewName));
  return { name: f.text("name"), title: f.text("title"), views, ...f.optional("mirror", () => f.text("mirror")) };
}

function laid(fields: Fields, view: ViewName): Laid {
  const f = fields.inner(view);
  const mesh = new Float32Array(whole(f.bytes("mesh"), 8).buffer);
  return { mesh, points: f.positions("points", ([x, y]): Position => [x, y]), ...f.facing() };
}

function whole(bytes: Uint8Array<ArrayBuffer>, unit: number): Uint8Array<ArrayBuffer> {
  if (bytes.length % unit) throw new RangeError(`${bytes.length} bytes are not so many pairs`);
  return bytes;
}

/** A map whose fields are of the kind that is asked for, or throw. */
class Fields {
  private readonly map: PlainMap;

  constructor(value: Plain | undefined, private readonly name: string) {
    if (!(value instanceof Map)) throw new TypeError(`${name} is no map`);
    this.map = value;
  }

  has(name: string): boolean {
    return this.map.has(name);
  }

  /** `{name: read()}`, or nothing if there is no such field. */
  optional<N extends string, T>(name: N, read: () => T): { [name in N]?: T } {
    return this.has(name) ? { [name]: read() } as { [name in N]?: T } : {};
  }

  text(name: string): string {
    return this.of(name, (value): value is string => typeof value === "string");
  }

  flag(name: string): boolean {
    return this.of(name, (value): value is boolean => typeof value === "boolean");
  }

  bytes(name: string): Uint8Array<ArrayBuffer> {
    return this.of(name, (value): value is Uint8Array<ArrayBuffer> => value instanceof Uint8Array);
  }

  list(name: string): Plain[] {
    return this.of(name, (value): value is Plain[] => Array.isArray(value));
  }

  number(name: string): number {
    return plainNumber(this.of(name, isNumber));
  }

  view(name: string): ViewName {
    return this.of(name, (value): value is ViewName => VIEWS.includes(value as ViewName));
  }

  facing(): { facing?: Facing } {
    return this.optional("facing", () => this.of("facing", (value): value is Facing => value === "left" || value === "right"));
  }

  inner(name: string): Fields {
    return new Fields(this.map.get(name), name);
  }

  /** A map of names to numbers, at least two each. */
  positions<T>(name: string, read: (numbers: number[]) => T): Map<string, T> {
    return new Map([...this.inner(name).map].map(([key, value]) => {
      if (!Array.isArray(value) || value.length < 2 || !value.every(isNumber)) throw new TypeError(`${name}.${String(key)} is no position`);
      return [String(key), read(value.map(plainNumber))];
    }));
  }

  private of<T extends Plain>(name: string, fits: (value: Plain | undefined) => value is T): T {
    const value = this.map.get(name);
    if (!fits(value)) throw new TypeError(`${this.name}.${name} is missing or of the wrong kind`);
    return value;
  }
}

function isNumber(value: Plain | undefined): value is number | Float {
  return typeof value === "number" || value instanceof Float;
}

function plainNumber(value: number | Float): number {
  return typeof value === "number" ? value : value.value;
}
