/** The AudioWorklet: a shell round stream/player. */

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

registerProcessor("fap-player", FapPlayer);
