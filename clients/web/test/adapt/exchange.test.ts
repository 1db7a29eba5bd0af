import { describe, expect, it } from "vitest";
import { Exchange, type Request } from "../../adapt/exchange";
import type { Marks } from "../../adapt/marks";
import type { Asked, Fault, Fit, Head, Photo } from "../../adapt/wire";

const points = (x: number): Request => ({ type: "points", front: new Map([["9.3", { at: [x, 0] }]]) as Marks });
const photo = (view: "front" | "profile"): Request => ({ type: "photo", view, data: Uint8Array.of(1) });
const head: Request = { type: "head", front: new Map() };
const fit = (seq: number): Fit => ({ type: "fit", seq, fitted: true });
const picture = (view: "front" | "profile"): Photo => ({ type: "photo", view, width: 1, height: 1, picture: new Uint8Array(), points: new Map() });
const fault = (about: Partial<Fault>): Fault => ({ type: "error", code: "bad_points", message: "", fatal: false, ...about });

function opened() {
  const sent: Asked[] = [];
  const exchange = new Exchange((message) => sent.push(message));
  exchange.begin();
  return { exchange, sent };
}

const xs = (sent: Asked[]) => sent.flatMap((message) => (message.type === "points" ? [message.front.get("9.3")!.at[0]] : []));

describe("Exchange", () => {
  it("has one points message on its way, and of those that wait only the newest", () => {
    const { exchange, sent } = opened();
    for (let x = 0; x < 10; x++) exchange.ask(points(x));
    expect(xs(sent)).toEqual([0]);
    expect(exchange.settles(fit(1))).toBe(true);
    exchange.proceed();
    expect(xs(sent)).toEqual([0, 9]);
    expect(exchange.settles(fit(2))).toBe(true);
    exchange.proceed();
    expect(sent).toHaveLength(2);
  });

  it("numbers requests upwards, over reconnections as well", () => {
    const { exchange, sent } = opened();
    exchange.ask(points(0));
    exchange.end();
    exchange.begin();
    exchange.ask(head);
    expect(sent.map((message) => message.type !== "photo" && message.seq)).toEqual([1, 2]);
  });

  it("takes no answer for another's", () => {
    const { exchange } = opened();
    expect(exchange.settles(fit(1))).toBe(false);
    exchange.ask(points(0));
    expect(exchange.settles(fit(0))).toBe(false);
    expect(exchange.settles({ type: "head", seq: 1, head: new Uint8Array(), points: "" } satisfies Head)).toBe(false);
    expect(exchange.settles(picture("front"))).toBe(false);
    exchange.end();
    exchange.begin();
    exchange.ask(points(1));
    expect(exchange.settles(fit(1))).toBe(false);
    expect(exchange.settles(fit(2))).toBe(true);
  });

  it("lets photos go before points, and points before heads", () => {
    const { exchange, sent } = opened();
    exchange.ask(points(0));
    for (const request of [head, points(1), photo("profile"), photo("front")]) exchange.ask(request);
    for (const answer of [fit(1), picture("front"), picture("profile"), fit(2)]) {
      expect(exchange.settles(answer)).toBe(true);
      exchange.proceed();
    }
    expect(sent.map(({ type }) => type)).toEqual(["points", "photo", "photo", "points", "head"]);
    expect(exchange.busy("head")).toBe(true);
  });

  it("goes on after an error about the request at hand, and only that", () => {
    const { exchange } = opened();
    exchange.ask(points(0));
    expect(exchange.settles(fault({ seq: 7 }))).toBe(false);
    expect(exchange.settles(fault({ seq: 1 }))).toBe(true);
    exchange.proceed();
    exchange.ask(photo("front"));
    expect(exchange.settles(fault({ view: "profile" }))).toBe(false);
    expect(exchange.settles(fault({ seq: 1 }))).toBe(false);
    expect(exchange.settles(fault({ view: "front" }))).toBe(true);
    expect(exchange.settles(fault({}))).toBe(true);
  });

  it("sends and keeps nothing while the server is not there", () => {
    const sent: Asked[] = [];
    const exchange = new Exchange((message) => sent.push(message));
    exchange.ask(photo("front"));
    exchange.begin();
    exchange.ask(points(1));
    exchange.ask(points(2));
    exchange.end();
    exchange.begin();
    expect(exchange.busy("points")).toBe(false);
    expect(xs(sent)).toEqual([1]);
    expect(sent).toHaveLength(1);
  });
});
