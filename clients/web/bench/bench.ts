/** What the render benchmark calls in its page. Not shipped. */

import { readHead } from "../src/head/glb";
import { SHADOW_EVERY, Stage } from "../src/render/stage";

/** What one picture takes; counted at WebGL's door. */
interface Cost {
  calls: number;
  triangles: number;
  textureBytes: number;
}

let cost: Cost = { calls: 0, triangles: 0, textureBytes: 0 };
let stage: Stage;
let pixels: WebGL2RenderingContext;

/** Show the head at `url`. */
async function open(canvas: HTMLCanvasElement, url: string, antialias: boolean | null): Promise<Stage> {
  stage = new Stage(canvas, { antialias, capture: false });
  pixels = canvas.getContext("webgl2")!;
  cost = { calls: 0, triangles: 0, textureBytes: 0 };
  await stage.show(readHead(new Uint8Array(await (await fetch(url)).arrayBuffer())));
  stage.resize(canvas.clientWidth, canvas.clientHeight, 1);
  return stage;
}

/** Draw `frames`, deforming for each one or not at all; milliseconds, with every picture really finished. */
function run(frames: number[][], deforming: boolean): number {
  const start = performance.now();
  for (const values of frames) {
    if (deforming) stage.pose(values);
    stage.render();
    pixels.readPixels(0, 0, 1, 1, pixels.RGBA, pixels.UNSIGNED_BYTE, new Uint8Array(4));
  }
  return performance.now() - start;
}

/** What the dearest picture takes (not every one draws shadows anew), and the textures so far. */
function price(): Cost {
  const pictures = Array.from({ length: SHADOW_EVERY }, () => {
    cost.calls = cost.triangles = 0;
    stage.render();
    return { ...cost };
  });
  return pictures.reduce((dearest, next) => (next.triangles > dearest.triangles ? next : dearest));
}

function watch(): void {
  const gl = WebGL2RenderingContext.prototype;
  const { drawElements, texStorage2D } = gl;
  gl.drawElements = function (mode, count, type, offset) {
    cost.calls++;
    cost.triangles += count / 3;
    drawElements.call(this, mode, count, type, offset);
  };
  gl.texStorage2D = function (target, levels, format, width, height) {
    cost.textureBytes += Math.round(4 * width * height * (levels > 1 ? 4 / 3 : 1));
    texStorage2D.call(this, target, levels, format, width, height);
  };
}

watch();
Object.assign(window, { open, run, price });
