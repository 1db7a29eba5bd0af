/** The sound card: one AudioContext for all heads of a page, one sound processor for each head. */

import { OutputClock } from "../stream/clock";
import { HeardMap, type Heard } from "../stream/heard";
import type { Command, Report } from "../stream/player";

/** Why there can be no sound here; for people. */
export class SoundUnavailable extends Error {}

/**
 * Nobody needs sound for so long: the context goes to sleep. Not at once, because Chromium's can stall
 * for good when it is put to sleep and woken in a row.
 */
const SLEEP_MS = 5000;

/** The page's one AudioContext, made when the first head needs it and asleep while there is none. */
class Hub {
  readonly context: AudioContext;
  private readonly clock = new OutputClock();
  private readonly modules = new Map<string, Promise<void>>();
  private users = 0;
  private bedtime: ReturnType<typeof setTimeout> | undefined;

  constructor() {
    this.context = new AudioContext({ latencyHint: "interactive" });
  }

  async join(module: string): Promise<void> {
    this.users++;
    const loaded = this.modules.get(module) ?? this.context.audioWorklet.addModule(module);
    this.modules.set(module, loaded);
    loaded.catch(() => this.modules.delete(module));
    await loaded;
    this.wake();
  }

  leave(): void {
    this.users--;
    clearTimeout(this.bedtime);
    this.bedtime = setTimeout(() => this.sleep(), SLEEP_MS);
  }

  private sleep(): void {
    if (!this.users) void this.context.suspend().catch(() => undefined);
  }

  /** Browsers allow this only after the user has done something. */
  wake(): void {
    if (this.users && this.context.state !== "running") void this.context.resume().catch(() => undefined);
  }

  /** The context frame heard at `now` (ms of performance time). */
  frame(now: number): number {
    const { context, clock } = this;
    if (context.state === "running") {
      const stamp = context.getOutputTimestamp?.();
      if (stamp?.contextTime && stamp.performanceTime) clock.observe(stamp.contextTime, stamp.performanceTime);
      else clock.observe(context.currentTime - (context.outputLatency || context.baseLatency || 0), performance.now());
    }
    return clock.heard(now, context.currentTime) * context.sampleRate;
  }

  /** When a context frame is heard, ms of performance time. */
  when(frame: number): number | null {
    return this.clock.when(frame / this.context.sampleRate);
  }
}

let hub: Hub | null = null;

/** What the environment lacks, or "" if sound is possible. */
function soundProblem(): string {
  if (!globalThis.isSecureContext) {
    return "No sound: this page is not a secure context. Open it over https, or from localhost.";
  }
  if (!("AudioContext" in globalThis) || !("audioWorklet" in BaseAudioContext.prototype)) {
    return "No sound: this browser has no AudioWorklet.";
  }
  return "";
}

export class Sound {
  private constructor(
    private readonly hub: Hub, private readonly node: AudioWorkletNode,
    private readonly map: HeardMap, private readonly changed: () => void,
  ) {
    this.hub.context.addEventListener("statechange", this.changed);
  }

  /** A sound processor of its own, from the script at `module`. Rejects with SoundUnavailable. */
  static async open(module: string, report: (report: Report) => void, changed: () => void): Promise<Sound> {
    const problem = soundProblem();
    if (problem) throw new SoundUnavailable(problem);
    const home = (hub ??= new Hub());
    try {
      await home.join(module);
    } catch {
      home.leave();
      throw new SoundUnavailable(`No sound: ${module} could not be loaded.`);
    }
    const node = new AudioWorkletNode(home.context, "fap-player", { numberOfInputs: 0, outputChannelCount: [1] });
    const map = new HeardMap(home.context.sampleRate);
    node.port.onmessage = ({ data }: MessageEvent<Report>) => (map.apply(data), report(data));
    node.connect(home.context.destination);
    return new Sound(home, node, map, changed);
  }

  /** Blocked until the user does something? */
  get locked(): boolean {
    return this.hub.context.state !== "running";
  }

  unlock(): void {
    this.hub.wake();
  }

  command(command: Command): void {
    this.node.port.postMessage(command);
  }

  /** What is heard at `now`. */
  heard(now: number): Heard | null {
    return this.map.at(this.hub.frame(now));
  }

  /** When a sample is heard, ms of performance time; null if that is not known. */
  when(turn: number, sample: number): number | null {
    const frame = this.map.frameOf(turn, sample);
    return frame === null ? null : this.hub.when(frame);
  }

  close(): void {
    this.hub.context.removeEventListener("statechange", this.changed);
    this.node.port.onmessage = null;
    this.node.port.postMessage({ kind: "close" });
    this.node.disconnect();
    this.hub.leave();
  }
}
