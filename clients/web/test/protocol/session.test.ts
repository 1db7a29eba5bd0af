import { describe, expect, it } from "vitest";
import { encode, ProtocolError } from "../../src/protocol/codec";
import type { ClientMessage, Message, Ready } from "../../src/protocol/generated";
import { ClientSession } from "../../src/protocol/session";
import { vectors } from "../vectors";

interface Step { reconnect?: boolean; again?: Message[]; received?: number; send?: ClientMessage; receive?: Message; refused?: boolean; error?: string; events?: unknown[]; state?: string }
interface Script { name: string; side: string; steps: Step[] }

describe("protocol/vectors/sessions.json", () => {
  const scripts = vectors<Script>("sessions.json").filter((script) => script.side === "client");

  it.each(scripts)("$name", ({ steps }) => {
    const session = new ClientSession();
    for (const step of steps) {
      run(session, step);
      if (step.state) expect(session.state).toBe(step.state);
      if (step.received !== undefined) expect(session.received).toBe(step.received);
      if (step.again) expect(session.again).toEqual(step.again.map((message) => encode(message)));
    }
  });
});

function run(session: ClientSession, step: Step): void {
  if (step.reconnect) return session.reconnect();
  if (step.send) {
    const send = () => session.send(step.send!);
    if (step.refused) expect(send).toThrow(ProtocolError);
    else send();
    return;
  }
  const receive = () => session.receive(encode(step.receive!));
  if (step.error) return expect(receive).toThrow(expect.objectContaining({ code: step.error }));
  const event = receive();
  if (step.events) expect(event ? [event] : []).toHaveLength(step.events.length);
}

describe("ClientSession", () => {
  it("refuses a ready whose frames would have no FAPs", () => {
    const session = new ClientSession();
    session.send({ type: "hello" });
    const ready: Omit<Ready, "faps"> = { type: "ready", server: "s", session: "1", fps: 25, voices: [], heads: [] };
    expect(() => session.receive(encode({ ...ready, faps: Uint8Array.of() }))).toThrow(ProtocolError);
    expect(() => session.receive(encode({ ...ready, faps: Uint8Array.of(69) }))).toThrow(ProtocolError);
    expect(session.ready).toBeNull();
  });

  it("changes nothing when a message is refused", () => {
    const session = new ClientSession();
    session.send({ type: "hello" });
    session.send({ type: "speak", turn: 2, text: new Uint8Array() });
    session.send({ type: "end", turn: 2 });
    expect(() => session.send({ type: "speak", turn: 2, text: new Uint8Array() })).toThrow(ProtocolError);
    expect(() => session.send({ type: "end", turn: 5 })).toThrow(ProtocolError);
    expect(session.send({ type: "interrupt", turn: 2 })).toBeInstanceOf(Uint8Array);
  });
});
