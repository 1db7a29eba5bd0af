/** The AudioWorklet: a shell round stream/player, and one that hands out what comes in. */

/// <reference types="audioworklet" />

import { Player, type Command } from "../stream/player";

class FapPlayer extends AudioWorkletProcessor {
  private open = true;
  private readonly player = new Player(sampleRate, (report) => this.port.postMessage(report));

  constructor() {
    super();
    this.port.onmessage = ({ data }: MessageEvent<Command | { kind: "close" }>) => {
      if (data.kind === "close") this.open = false;
      else this.player.handle(data);
    };
  }

  process(_inputs: Float32Array[][], [[out]]: Float32Array[][]): boolean {
    this.player.render(out, currentFrame);
    return this.open;
  }
}

/** Samples handed out at once, s. */
const GROUP_S = 0.02;

class FapCapture extends AudioWorkletProcessor {
  private group = new Int16Array(Math.round(GROUP_S * sampleRate));
  private filled = 0;

  process([[input]]: Float32Array[][]): boolean {
    for (const value of input ?? []) {
      this.group[this.filled++] = Math.max(-32768, Math.min(32767, Math.round(value * 32768)));
      if (this.filled === this.group.length) this.handOut();
    }
    return true;
  }

  private handOut(): void {
    this.port.postMessage(this.group, [this.group.buffer]);
    this.group = new Int16Array(Math.round(GROUP_S * sampleRate));
    this.filled = 0;
  }
}

registerProcessor("fap-player", FapPlayer);
registerProcessor("fap-capture", FapCapture);
