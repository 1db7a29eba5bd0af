/** Where the camera stands for a portrait. */

import type { Head, Point } from "../head/model";

/** Width of a portrait that holds the whole head, as a share of its height. */
const NEEDED_WIDTH = 0.8;

/** A camera straight in front that frames `height` metres, or more where the picture is too narrow for the head. */
export function frame({ target, height }: Head["camera"], fovDegrees: number, aspect: number): { position: Point; target: Point } {
  const shown = height * Math.max(1, NEEDED_WIDTH / aspect);
  const distance = shown / 2 / Math.tan((fovDegrees * Math.PI) / 360);
  return { position: [target[0], target[1], target[2] + distance], target };
}
