/** Where the camera stands for a portrait. */

import type { Head, Point } from "../head/model";

/** Width of a portrait that holds the whole head, as a share of its height. */
const NEEDED_WIDTH = 0.8;

/** How far to each side a swinging camera goes, radians, and how long it takes there and back, seconds. */
const SWING = 0.6;
const SWING_S = 14;

/**
 * A camera that frames `height` metres, or more where the picture is too narrow for the head: straight in front, or
 * `yaw` radians round the head, to its left if positive.
 */
export function frame(
  { target, height }: Head["camera"], fovDegrees: number, aspect: number, yaw = 0,
): { position: Point; target: Point } {
  const shown = height * Math.max(1, NEEDED_WIDTH / aspect);
  const distance = shown / 2 / Math.tan((fovDegrees * Math.PI) / 360);
  return { position: [target[0] + distance * Math.sin(yaw), target[1], target[2] + distance * Math.cos(yaw)], target };
}

/** The yaw, radians, of a camera that has been swinging gently for `seconds`; it begins in front. */
export function swing(seconds: number): number {
  return SWING * Math.sin((2 * Math.PI * seconds) / SWING_S);
}
