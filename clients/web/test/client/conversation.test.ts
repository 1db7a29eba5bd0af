import { beforeEach, describe, expect, it } from "vitest";
import { Conversation } from "../../src/client/conversation";
import { HeadFault } from "../../src/client/turn";
import { decode, encode } from "../../src/protocol/codec";
import type { ClientMessage, Mark, ServerMessage } from "../../src/protocol/generated";
import type { Heard } from "../../src/stream/heard";
import type { Command } from "../../src/stream/player";

const READY: ServerMessage = { type: "ready", server: "s", session: "1", fps: 25, faps: Uint8Array.of(3), voices: [], heads: [] };
const RATE = 16000;

let now: number;
let sent: ClientMessage[];
let commands: Command[];
let events: [name: string, detail: Record<string, unknown>][];
let drops: number;
let talk: Conversation;

beforeEach(() => {
  [now, drops, sent, commands, events] = [0, 0, [], [], []];
  talk = new Conversation({
    send: (data) => sent.push(decode(data, "client") as ClientMessage),
    drop: () => (drops++, talk.disconnected()),
    sound: (command) => commands.push(command),
    emit: (name, detail) => events.push([name, detail as Record<string, unknown>]),
    now: () => now,
  });
});

const say = (message: ServerMessage) => talk.received(encode(message));
const named = (name: string) => events.filter(([other]) => other === name).map(([, detail]) => detail);
const of = <T extends ClientMessage["type"]>(type: T) => sent.filter((m) => m.type === type) as Extract<ClientMessage, { type: T }>[];
const text = () => new TextDecoder().decode(Uint8Array.from(of("speak").flatMap((m) => [...m.text])));
const heard = (turn: number, sample: number, state: Heard["state"] = "playing"): Heard => ({ turn, sample, state });
const word = (sample: number, char_end: number): Mark => ({ kind: "word", sample, duration: 10, text: "w", char_start: 0, char_end });

/** The fields of a packet whose one frame has this value. */
const face = (value: number) => ({ mask: Uint8Array.of(1), faps: Int16Array.of(value), key: value === 0 });

function connect(): void {
  talk.connected({});
  say(READY);
}

function begin(turn: number, packets = 0, marks: Mark[] = []): void {
  say({ type: "begin", turn, voice: "v", lang: "en", sample_rate: RATE, fps: 25 });
  for (let k = 0; k < packets; k++) {
    const pcm = new Int16Array(640).fill(1000);
    say({ type: "packet", turn, sample: 640 * k, pcm, ...face(k), ...(k === 0 && marks.length && { marks }) });
  }
}

describe("how a turn is read", () => {
  it("goes to the server in percent, within its limits, and only what was asked for", () => {
    connect();
    talk.speak("a", { pitch: 1.25, volume: 0, lookAhead: 2 });
    talk.speak("a", { rate: 9, pitch: 0.01, volume: 9, lookAhead: 5000 });
    talk.speak("a", {});
    const [first, second, third] = of("speak");
    expect(first).toMatchObject({ pitch: 125, volume: 0, look_ahead: 2 });
    expect(second).toMatchObject({ rate: 400, pitch: 25, volume: 400, look_ahead: 1000 });
    expect(Object.keys(third ?? {}).sort()).toEqual(["text", "turn", "type"]);
  });
});

describe("a turn of sound", () => {
  const hears = () => of("hear").map(({ turn, pcm, sample_rate }) => [turn, pcm.length, sample_rate]);

  it("says its rate once, and is cut into what a message may hold", () => {
    connect();
    const turn = talk.hear(48_000);
    turn.feed(new Int16Array(20_000).fill(7)).feed(new Int16Array(0)).end();
    expect(hears()).toEqual([[1, 0, 48_000], [1, 8192, undefined], [1, 8192, undefined], [1, 3616, undefined]]);
    expect(of("hear")[3]?.pcm[0]).toBe(7);
    expect(of("end")).toEqual([{ type: "end", turn: 1 }]);
    expect(() => turn.feed(new Int16Array(1))).toThrow(HeadFault);
  });

  it("is opened once there is a connection, and lets go what was said before", () => {
    const turn = talk.hear(16_000);
    turn.feed(new Int16Array(320));
    connect();
    turn.feed(new Int16Array(100));
    expect(hears()).toEqual([[1, 0, 16_000], [1, 100, undefined]]);
  });

  it("is played as it comes, and is over when it was heard", async () => {
    connect();
    const turn = talk.hear(RATE);
    say({ type: "begin", turn: 1, voice: "", lang: "en", sample_rate: RATE, fps: 25, delay: 3200 });
    expect(commands).toMatchObject([{ kind: "begin", turn: 1, rate: RATE, live: true }]);
    say({ type: "packet", turn: 1, sample: 0, pcm: new Int16Array(640), ...face(1) });
    turn.end();
    say({ type: "done", turn: 1, reason: "end", samples: 640 });
    talk.advance(heard(1, 640, "over"));
    expect(await turn).toMatchObject({ reason: "end", samples: 640 });
  });

  it("is interrupted before the server knows of it without a word to the server", async () => {
    const turn = talk.hear(RATE);
    expect(await turn.interrupt()).toMatchObject({ reason: "interrupted" });
    connect();
    expect(hears()).toEqual([]);
  });

  it("takes no text, and is not for a head that listens", () => {
    connect();
    const turn = talk.hear(RATE);
    expect(() => turn.append()).toThrow(/takes no text/);
    expect(() => turn.splice()).toThrow(HeadFault);
    expect(() => turn.seek()).toThrow(HeadFault);
    talk.connected({ channel: "news" });
    expect(() => talk.hear(RATE)).toThrow(/does not speak/);
  });
});

describe("a turn", () => {
  it("goes through: text out, sound in, events when heard, done when heard to the end", async () => {
    connect();
    const turn = talk.speak("Καλημέρα", { lang: "el", rate: 1.5 });
    expect(of("speak")).toMatchObject([{ turn: 1, lang: "el", rate: 150 }]);
    expect(of("speak")[0]).not.toHaveProperty("pitch");
    expect(text()).toBe("Καλημέρα");
    expect(of("end")).toHaveLength(1);
    begin(1, 10, [word(0, 3), word(5000, 8)]);
    expect(commands.map(({ kind }) => kind)).toEqual(["begin", ...Array<string>(10).fill("pcm")]);
    expect(named("word")).toEqual([]);
    talk.advance(heard(1, 100));
    expect(await turn.started).toMatchObject({ voice: "v" });
    expect(named("word")).toMatchObject([{ turn: 1, char_end: 3 }]);
    say({ type: "done", turn: 1, reason: "end", samples: 6400 });
    expect(commands.at(-1)).toEqual({ kind: "end", turn: 1 });
    talk.advance(heard(1, 6399));
    expect(named("done")).toEqual([]);
    talk.advance(heard(1, 6400, "over"));
    expect(await turn).toEqual({ turn: 1, reason: "end", samples: 6400 });
    expect(named("word")).toHaveLength(2);
    expect(talk.busy).toBe(false);
  });

  it("waits for the connection", () => {
    talk.speak("a", {});
    expect(sent).toEqual([]);
    connect();
    expect(sent.map(({ type }) => type)).toEqual(["hello", "speak", "end"]);
  });

  it("takes text in pieces, also half a character at a time, and long text in fragments", () => {
    connect();
    const turn = talk.speak("a\ud83d", { open: true });
    turn.append("\ude42b").append("é".repeat(50000)).end();
    expect(text()).toBe(`a🙂b${"é".repeat(50000)}`);
    expect(Math.max(...of("speak").map((m) => m.text.length))).toBeLessThanOrEqual(65536);
    expect(sent.at(-1)).toEqual({ type: "end", turn: 1 });
    expect(() => turn.append("more")).toThrow(expect.objectContaining({ code: "turn_ended" }));
  });

  it("survives a lone surrogate", () => {
    connect();
    talk.speak("x\ud83d", {});
    expect(text()).toBe("x\ufffd");
  });

  it("is over at once when it has no sound", async () => {
    connect();
    const turn = talk.speak("", {});
    say({ type: "done", turn: 1, reason: "end", samples: 0 });
    expect(await turn).toMatchObject({ reason: "end", samples: 0 });
  });

  it("does not need its own end reported once the next one is heard", async () => {
    connect();
    const first = talk.speak("a", {});
    talk.speak("b", {});
    begin(1, 2);
    say({ type: "done", turn: 1, reason: "end", samples: 1280 });
    begin(2, 2);
    talk.advance(heard(2, 10));
    expect(await first).toMatchObject({ reason: "end" });
  });

  it("measures from its first text to its first loud sample", () => {
    connect();
    now = 100;
    const turn = talk.speak("", { open: true });
    now = 300;
    turn.append("a");
    begin(1, 1);
    expect(talk.onsetOf(1)).toEqual({ asked: 300, sample: 0 });
  });
});

describe("interrupt", () => {
  beforeEach(connect);

  it("says what was heard and gives the server's answer", async () => {
    const turn = talk.speak("one two", {});
    begin(1, 10);
    talk.advance(heard(1, 1234.7));
    const stopped = turn.interrupt();
    expect(commands.at(-1)).toEqual({ kind: "stop", turn: 1 });
    expect(sent.at(-1)).toEqual({ type: "interrupt", turn: 1, heard: 1234 });
    expect(talk.bufferOf(heard(1, 1240))).toBeNull();
    say({ type: "packet", turn: 1, sample: 6400, pcm: new Int16Array(640), ...face(1) });
    expect(commands.at(-1)).toEqual({ kind: "stop", turn: 1 });
    say({ type: "done", turn: 1, reason: "interrupted", samples: 7040, heard: 1234, char: 3 });
    expect(await stopped).toEqual({ turn: 1, reason: "interrupted", samples: 7040, heard: 1234, char: 3 });
  });

  it("answers for itself after 2 s, and when the server had finished", async () => {
    const turn = talk.speak("one two", {});
    begin(1, 10, [word(0, 3), word(5000, 7)]);
    talk.advance(heard(1, 1000));
    const stopped = turn.interrupt();
    now = 2100;
    talk.advance(heard(1, 1300));
    expect(await stopped).toMatchObject({ reason: "interrupted", heard: 1000, char: 3 });

    const next = talk.speak("three", {});
    begin(2, 10, [word(0, 5)]);
    say({ type: "done", turn: 2, reason: "end", samples: 6400 });
    talk.advance(heard(2, 500));
    const count = sent.length;
    expect(await next.interrupt()).toMatchObject({ reason: "interrupted", heard: 500, char: 5 });
    expect(sent).toHaveLength(count);
  });

  it("of all tells about the one being heard", async () => {
    talk.speak("a", {});
    const waiting = talk.speak("b", {});
    begin(1, 5);
    talk.advance(heard(1, 640));
    const all = talk.interruptAll();
    for (const turn of [1, 2]) say({ type: "done", turn, reason: "interrupted", samples: 0, heard: turn === 1 ? 640 : 0, char: 0 });
    expect(await all).toMatchObject({ turn: 1, heard: 640 });
    expect(await waiting).toMatchObject({ turn: 2, reason: "interrupted" });
    expect(await talk.interruptAll()).toBeNull();
  });

  it("of a turn that was never sent needs no server", async () => {
    talk.disconnected();
    const turn = talk.speak("a", {});
    expect(await turn.interrupt()).toMatchObject({ reason: "interrupted", heard: 0 });
    connect();
    expect(of("speak")).toEqual([]);
  });
});

describe("what goes wrong", () => {
  it("fails a refused turn and goes on", async () => {
    connect();
    const turn = talk.speak("a", { voice: "x" });
    say({ type: "error", code: "unknown_voice", message: "no", fatal: false, turn: 1 });
    await expect(turn.finished).rejects.toMatchObject({ code: "unknown_voice", turn: 1 });
    expect(named("error")).toMatchObject([{ code: "unknown_voice" }]);
    talk.speak("b", {});
    expect(of("speak").at(-1)).toMatchObject({ turn: 2 });
  });

  it("reports an error that refuses nothing and keeps the turn", () => {
    connect();
    talk.speak("a", {});
    say({ type: "error", code: "text_too_long", message: "no", fatal: false, turn: 1 });
    expect(named("error")).toMatchObject([{ code: "text_too_long" }]);
    expect(talk.busy).toBe(true);
  });

  it("fails turns in progress when the connection is lost; new ones work after", async () => {
    connect();
    const lost = talk.speak("a", {});
    talk.disconnected();
    await expect(lost.finished).rejects.toMatchObject({ code: "connection_lost" });
    const later = talk.speak("b", {});
    connect();
    expect(of("speak").at(-1)).toMatchObject({ turn: 2 });
    begin(2, 1);
    say({ type: "done", turn: 2, reason: "end", samples: 640 });
    talk.advance(heard(2, 640, "over"));
    expect(await later).toMatchObject({ reason: "end" });
  });

  it("fails a turn whose voice failed after what was said of it", async () => {
    connect();
    const turn = talk.speak("a", {});
    begin(1, 2);
    say({ type: "error", code: "synthesis_failed", message: "gone", fatal: false, turn: 1 });
    say({ type: "done", turn: 1, reason: "failed", samples: 1280 });
    expect(talk.busy).toBe(true);
    talk.advance(heard(1, 1280, "over"));
    await expect(turn.finished).rejects.toMatchObject({ code: "synthesis_failed" });
  });

  it.each([["rubbish", Uint8Array.of(0xc1)], ["a gap", encode({ type: "packet", turn: 1, sample: 99, pcm: new Int16Array(0) })]])(
    "drops the connection over %s", (_, data) => {
      connect();
      talk.speak("a", {});
      begin(1, 1);
      talk.received(data);
      expect(drops).toBe(1);
      expect((events.find(([name]) => name === "error")![1] as unknown as HeadFault).code).toBe("protocol");
    });

  it("fails everything said when there is no sound", async () => {
    const early = talk.speak("a", {});
    talk.silence(new HeadFault("sound_unavailable", "none"));
    await expect(early.finished).rejects.toMatchObject({ code: "sound_unavailable", turn: 1 });
    connect();
    expect(of("speak")).toEqual([]);
  });

  it("says goodbye, and fails what was being said", async () => {
    connect();
    const turn = talk.speak("a", {});
    talk.leave();
    expect(sent.at(-1)).toEqual({ type: "bye" });
    await expect(turn.finished).rejects.toMatchObject({ code: "connection_lost" });
  });

  it("keeps a connection that answers, however seldom a hidden page may look", () => {
    connect();
    for (now = 60_000; now < 600_000; now += 60_000) {
      talk.advance(null);
      say({ type: "pong", id: 1 });
    }
    expect(of("ping").length).toBeGreaterThan(5);
    expect(drops).toBe(0);
  });

  it("drops a connection on which nothing is heard any more", () => {
    connect();
    for (now = 0; now < 60_000 && !drops; now += 1000) talk.advance(null);
    expect(of("ping").length).toBeGreaterThan(0);
    expect(drops).toBe(1);
    expect(now).toBeLessThan(45_000);
  });
});

it("acknowledges four times a second while a turn is heard", () => {
  connect();
  talk.speak("a", {});
  begin(1, 50);
  talk.underruns = 2;
  talk.skew = -1500.4;
  for (now = 0; now < 1000; now += 16) talk.advance(heard(1, now * 16));
  expect(of("ack").length).toBeGreaterThanOrEqual(3);
  expect(of("ack").length).toBeLessThanOrEqual(4);
  const { sample, queue, ...rest } = of("ack").at(-1)!;
  expect(sample + queue).toBe(50 * 640);
  expect(rest).toEqual({ type: "ack", turn: 1, underruns: 2, skew: -1500, received: 51, late: 0 });
});

describe("a connection that is lost and comes back", () => {
  const KEY: ServerMessage = { ...READY, resume: "0.k" } as ServerMessage;

  function lose(): void {
    talk.disconnected();
    sent.length = 0;
  }

  it("goes on where it was, says again what the server missed, and nobody notices", async () => {
    talk.connected({ fps: 25 });
    say(KEY);
    const turn = talk.speak("a", { open: true });
    begin(1, 3);
    lose();
    turn.append("b").end();
    expect(sent).toEqual([]);
    talk.connected({ fps: 25 });
    expect(sent).toMatchObject([{ type: "hello", resume: "0.k", received: 4 }]);
    say({ ...KEY, resumed: true, received: 0, resume: "0.l" } as ServerMessage);
    expect(text()).toBe("ab");
    expect(of("end")).toHaveLength(1);
    say({ type: "packet", turn: 1, sample: 1920, pcm: new Int16Array(640), ...face(3) });
    say({ type: "done", turn: 1, reason: "end", samples: 2560 });
    talk.advance(heard(1, 2560, "over"));
    expect(await turn).toMatchObject({ reason: "end" });
    expect(named("error")).toEqual([]);
    lose();
    talk.connected({ fps: 25 });
    expect(of("hello")).toMatchObject([{ resume: "0.l" }]);
  });

  it("fails what was being said if the server has forgotten the session", async () => {
    talk.connected({ fps: 25 });
    say(KEY);
    const lost = talk.speak("a", {});
    lose();
    const later = talk.speak("b", {});
    talk.connected({ fps: 25 });
    say(READY);
    await expect(lost.finished).rejects.toMatchObject({ code: "connection_lost" });
    expect(of("speak")).toMatchObject([{ turn: 2 }]);
    begin(2, 1);
    say({ type: "done", turn: 2, reason: "end", samples: 640 });
    talk.advance(heard(2, 640, "over"));
    expect(await later).toMatchObject({ reason: "end" });
  });

  it("gives up once the server keeps nothing any longer", async () => {
    talk.connected({ fps: 25 });
    say(KEY);
    const lost = talk.speak("a", {});
    lose();
    now = 29_000;
    talk.advance(null);
    expect(talk.busy).toBe(true);
    now = 31_000;
    talk.advance(null);
    await expect(lost.finished).rejects.toMatchObject({ code: "connection_lost" });
    talk.connected({ fps: 25 });
    expect(of("hello")[0]!.resume).toBeUndefined();
  });

  it("tells the server afterwards what was interrupted meanwhile", async () => {
    talk.connected({ fps: 25 });
    say(KEY);
    const turn = talk.speak("a", {});
    begin(1, 5);
    talk.advance(heard(1, 1000));
    lose();
    expect(await turn.interrupt()).toMatchObject({ reason: "interrupted", heard: 1000 });
    talk.connected({ fps: 25 });
    say({ ...KEY, resumed: true, received: 2 } as ServerMessage);
    expect(of("interrupt")).toEqual([{ type: "interrupt", turn: 1, heard: 1000 }]);
  });
});

describe("a turn that is revised", () => {
  it("drops what is void and goes on from there", () => {
    connect();
    const turn = talk.speak("one two", {});
    begin(1, 10, [word(0, 3), word(3000, 7)]);
    talk.advance(heard(1, 1000));
    turn.splice(4, "more").end();
    expect(sent.slice(-3)).toMatchObject([{ type: "splice", turn: 1, char: 4, heard: 1000 }, { type: "speak" }, { type: "end" }]);
    say({ type: "discard", turn: 1, sample: 2000, char: 4 });
    expect(commands.at(-1)).toEqual({ kind: "discard", turn: 1, sample: 2000 });
    expect(named("revised")).toEqual([{ turn: 1, sample: 2000, char: 4 }]);
    say({ type: "packet", turn: 1, sample: 2000, pcm: new Int16Array(640), ...face(0), marks: [word(2100, 8)] });
    talk.advance(heard(1, 2500));
    expect(named("word").map(({ char_end }) => char_end)).toEqual([3, 8]);
  });

  it("can be said again, paused and continued", () => {
    connect();
    const turn = talk.speak("one", {});
    begin(1, 2);
    talk.advance(heard(1, 700));
    turn.seek().pause().continue();
    expect(sent.slice(-3)).toEqual([
      { type: "seek", turn: 1, back: 1, heard: 700 }, { type: "pause", turn: 1, heard: 700 }, { type: "continue", turn: 1 },
    ]);
    expect(commands.slice(-2)).toEqual([{ kind: "pause", on: true }, { kind: "pause", on: false }]);
  });
});

describe("listening", () => {
  const listen = () => {
    talk.connected({ channel: "news" });
    say(READY);
    say({ type: "live", channel: "news", on: true, talk: "a" });
  };

  it("hears turns that it did not open, from where it came", () => {
    listen();
    expect(sent[0]).toEqual({ type: "listen", channel: "news" });
    say({ type: "begin", turn: 7, voice: "v", lang: "en", sample_rate: RATE, fps: 25, sample: 6400, marks: [word(6000, 4)] });
    expect(commands.at(-1)).toEqual({ kind: "begin", turn: 7, rate: RATE, live: true });
    say({ type: "packet", turn: 7, sample: 6400, pcm: new Int16Array(640), ...face(0) });
    expect(commands.at(-1)).toMatchObject({ kind: "pcm", turn: 7, sample: 6400 });
    talk.advance(heard(7, 6500));
    expect(named("word")).toMatchObject([{ turn: 7, char_end: 4 }]);
    say({ type: "skip", reason: "slow" });
    say({ type: "begin", turn: 7, voice: "v", lang: "en", sample_rate: RATE, fps: 25, sample: 64000 });
    say({ type: "packet", turn: 7, sample: 64000, pcm: new Int16Array(640), ...face(0) });
    expect(commands.filter(({ kind }) => kind === "begin")).toHaveLength(1);
    expect(named("skip")).toEqual([{ reason: "slow" }]);
    say({ type: "pause", turn: 7 });
    expect(commands.at(-1)).toEqual({ kind: "pause", on: true });
  });

  it("says where it was when it comes back", () => {
    listen();
    begin(1, 2);
    talk.disconnected();
    sent.length = 0;
    talk.connected({ channel: "news" });
    expect(sent).toEqual([{ type: "listen", channel: "news", talk: "a", turn: 1, sample: 1280 }]);
    say(READY);
    say({ type: "live", channel: "news", on: true, talk: "a" });
    say({ type: "packet", turn: 1, sample: 1280, pcm: new Int16Array(640), ...face(1) });
    expect(commands.at(-1)).toMatchObject({ kind: "pcm", sample: 1280 });
    expect(named("error")).toEqual([]);
  });

  it("lets go of a speaker who has gone, and does not speak itself", () => {
    listen();
    begin(1, 2);
    say({ type: "live", channel: "news", on: true, talk: "b" });
    expect(commands.at(-1)).toEqual({ kind: "stop", turn: 1 });
    expect(talk.busy).toBe(false);
    expect(() => talk.speak("a", {})).toThrow(HeadFault);
  });
});
