/**
 * One head at work: joins conversation, socket, sound, face and stage. The element owns the page and
 * calls `frame` when there is a picture to draw and `beat` when there may be none.
 */

import { Conversation, type Wish } from "./client/conversation";
import { HeadFault, type OwnTurn } from "./client/turn";
import { Sound } from "./io/audio";
import { loadHead } from "./io/heads";
import { capture, microphone } from "./io/microphone";
import { Socket } from "./io/socket";
import { Face } from "./motion/face";
import { SUBPROTOCOL } from "./protocol/generated";
import { Stage, type StageOptions } from "./render/stage";
import type { Heard } from "./stream/heard";
import type { Command, Report } from "./stream/player";

const STATS_MS = 250;
/** How quickly the read-outs follow, as a share of each new value. */
const FOLLOW = 0.15;
/** The picture is never drawn for a sample further ahead than this, ms. */
const MOST_LEAD_MS = 40;

export interface PresenterOptions extends StageOptions {
  socketUrl: string;
  headUrl: string;
  workletUrl: string;
  fps: 25 | 50;
  seed: number;
  token?: string | undefined;
  /** Listen to this channel instead of speaking. */
  channel?: string | undefined;
  /** What a listener wants if the connection is too slow for sound and face. */
  prefer?: "sound" | "face" | undefined;
  /** Let others listen; `ready` tells how. */
  share?: boolean | undefined;
}

/** What the read-out shows; null where nothing was measured yet. */
export interface Stats {
  /** From the text to the first sound heard, of the newest turn. */
  latencyMs: number | null;
  /** Picture minus sound; positive: the face is late. */
  skewMs: number | null;
  queueMs: number;
  underruns: number;
  /** Packets that came when their sound should have been heard; sound in the player, what it aims at, and what it left out or said twice. */
  late: number;
  storeMs: number;
  targetMs: number;
  stretchedMs: number;
  fps: number;
}

export class Presenter {
  readonly conversation: Conversation;
  private readonly socket: Socket;
  private readonly face: Face;
  private stage: Stage | null = null;
  private sound: Sound | null = null;
  /** Why there will be no sound. */
  mute: HeadFault | null = null;
  private readonly waiting: Command[] = [];
  private closed = false;
  /** The head could not be loaded; it is tried again when the server answers. */
  private headless = false;
  private headUrl: string;
  private readonly handOver = new MessageChannel();
  /** What the picture being drawn shows. */
  private shown: Heard | null = null;
  private drawnAt = 0;
  private lead = 0;
  private stats: Stats = {
    latencyMs: null, skewMs: null, queueMs: 0, underruns: 0, late: 0, storeMs: 0, targetMs: 0, stretchedMs: 0, fps: 0,
  };
  private measured = 0;
  private told = 0;

  constructor(
    private readonly options: PresenterOptions, private readonly emit: (name: string, detail: object) => void,
    private readonly changed: () => void,
  ) {
    this.headUrl = options.headUrl;
    this.face = new Face(options.seed);
    this.socket = new Socket(options.socketUrl, SUBPROTOCOL, {
      open: () => this.conversation.connected(this.wish()),
      message: (data) => this.conversation.received(data),
      close: (retryMs) => this.disconnected(retryMs),
    });
    this.conversation = new Conversation({
      send: (data) => this.socket.send(data),
      drop: () => this.socket.drop(),
      sound: (command) => this.command(command),
      emit: (name, detail) => this.announce(name, detail),
      now: () => performance.now(),
    });
    this.handOver.port1.onmessage = () => this.handedOver();
  }

  /** A turn (in an object: awaiting a turn waits for its end) that says what a stream brings, or the microphone. Rejects with a HeadFault. */
  async hear(stream?: MediaStream): Promise<{ turn: OwnTurn }> {
    const sound = stream ?? await microphone();
    let turn: OwnTurn | null = null;
    const taken = await capture(sound, this.options.workletUrl, (pcm) => {
      if (turn?.open) turn.feed(pcm);
      else if (turn) stop();
    }, () => turn?.end());
    const stop = () => {
      taken.stop();
      if (!stream) for (const track of sound.getTracks()) track.stop();
    };
    turn = this.conversation.hear(taken.rate);
    void turn.finished.catch(() => undefined).then(stop);
    return { turn };
  }

  private wish(): Wish {
    const { fps, token, channel, prefer, share } = this.options;
    const who = { client: "fap-head 0.1.0", ...(token && { token }) };
    if (channel) return { ...who, channel, ...(prefer && { prefer }) };
    return { ...who, fps, ...(share && { share }) };
  }

  /** Open everything. What fails is announced as an `error` event. */
  async start(canvas: HTMLCanvasElement): Promise<void> {
    this.socket.start();
    await Promise.all([this.openStage(canvas), this.openSound()]);
  }

  close(): void {
    this.closed = true;
    this.conversation.leave();
    this.socket.stop();
    this.sound?.close();
    this.stage?.dispose();
    this.handOver.port1.close();
  }

  /** Something is to be heard and the browser waits for the user to allow it. */
  get locked(): boolean {
    return this.conversation.busy && (this.sound?.locked ?? false);
  }

  get connected(): boolean {
    return this.conversation.ready !== null;
  }

  unlock(): void {
    if (this.locked) this.command({ kind: "catch-up" });
    this.sound?.unlock();
  }

  /** Show another head; whatever is being said goes on. */
  wear(headUrl: string): void {
    this.headUrl = headUrl;
    void this.loadHead();
  }

  resize(width: number, height: number, pixelRatio: number): void {
    this.stage?.resize(width, height, pixelRatio);
  }

  /** Draw the face of the sample heard now, seen from `yaw` radians beside. `calm`: nothing but the lips moves. */
  frame(calm: boolean, yaw: number): void {
    const now = performance.now();
    const heard = this.sound?.heard(now + this.lead) ?? null;
    const values = this.face.show(this.conversation.bufferOf(heard), heard, now / 1000, calm);
    if (!this.stage?.draw(values, yaw)) return;
    this.stats.fps += FOLLOW * (1000 / Math.max(1, now - this.drawnAt) - this.stats.fps);
    this.shown = heard;
    this.drawnAt = now;
    this.handOver.port2.postMessage(null);
    this.beat();
  }

  /** What has to go on whether there is a picture or not. */
  beat(): void {
    if (this.closed) return;
    const heard = this.sound?.heard(performance.now()) ?? null;
    this.measureLatency(heard);
    this.conversation.advance(heard);
    if (performance.now() - this.told >= STATS_MS && this.conversation.busy) this.tell();
  }

  private async openStage(canvas: HTMLCanvasElement): Promise<void> {
    try {
      this.stage = new Stage(canvas, this.options);
    } catch {
      return this.fault("webgl_unavailable", "No picture: this browser offers no WebGL 2.");
    }
    await this.loadHead();
  }

  private async loadHead(): Promise<void> {
    this.headless = false;
    const url = this.headUrl;
    try {
      const head = await loadHead(url);
      if (this.closed || url !== this.headUrl) return;
      await this.stage?.show(head);
      this.changed();
      this.emit("head", { name: head.name });
    } catch (e) {
      if (url !== this.headUrl) return;
      this.headless = true;
      this.fault("head_unavailable", `Head not loaded: ${(e as Error).message}`);
    }
  }

  private async openSound(): Promise<void> {
    try {
      const sound = await Sound.open(this.options.workletUrl, (report) => this.report(report), this.changed);
      if (this.closed) return sound.close();
      this.sound = sound;
      for (const command of this.waiting.splice(0)) sound.command(command);
    } catch (e) {
      this.mute = new HeadFault("sound_unavailable", (e as Error).message, true);
      this.fault(this.mute.code, this.mute.message);
      this.conversation.silence(this.mute);
    }
  }

  private command(command: Command): void {
    if (this.sound) this.sound.command(command);
    else if (!this.mute) this.waiting.push(command);
  }

  private report(report: Report): void {
    if (report.kind === "pause" && report.state === "starved") this.conversation.underruns++;
    if (report.kind === "tick") {
      Object.assign(this.stats, report.stats);
      this.conversation.late = report.stats.late;
    }
    this.beat();
  }

  private disconnected(retryMs: number): void {
    this.conversation.disconnected();
    this.announce("disconnected", { retryMs: Math.round(retryMs) });
  }

  private announce(name: string, detail: object): void {
    if (name === "done") this.tell();
    if (name === "ready" && this.headless) void this.loadHead();
    this.emit(name, detail);
    this.changed();
  }

  private fault(code: string, message: string): void {
    if (!this.closed) this.announce("error", new HeadFault(code, message, true));
  }

  /** The picture has gone to the compositor: how far is it from what is heard? */
  private handedOver(): void {
    if (this.closed) return;
    const now = performance.now();
    this.lead += FOLLOW * (Math.min(MOST_LEAD_MS, now - this.drawnAt) - this.lead);
    const heard = this.sound?.heard(now);
    const rate = this.conversation.bufferOf(heard ?? null)?.begin.sample_rate;
    if (!heard || !rate || heard.state !== "playing" || this.shown?.turn !== heard.turn) return;
    const skew = ((heard.sample - this.shown.sample) / rate) * 1000;
    this.stats.skewMs = this.stats.skewMs === null ? skew : this.stats.skewMs + FOLLOW * (skew - this.stats.skewMs);
    this.conversation.skew = this.stats.skewMs * 1000;
  }

  private measureLatency(heard: Heard | null): void {
    if (!heard || heard.turn === this.measured || heard.state !== "playing") return;
    const onset = this.conversation.onsetOf(heard.turn);
    const when = onset && this.sound!.when(heard.turn, onset.sample);
    if (when === null || !onset || when > performance.now()) return;
    this.measured = heard.turn;
    this.stats.latencyMs = when - onset.asked;
  }

  private tell(): void {
    this.told = performance.now();
    const { queueMs, underruns } = this.conversation;
    this.emit("stats", { ...this.stats, queueMs, underruns } satisfies Stats);
  }
}
