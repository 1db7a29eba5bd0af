/** Where the turn of the head has taken it. */

import { Matrix4 } from "three";
import { rotation } from "../head/deform";
import type { Head } from "../head/model";

/** Undo what the rotations of the whole head (`turns` of all parts) do under the FAPs `values` (69,). */
export function undoTurn(head: Head, values: ArrayLike<number>, out: Matrix4): Matrix4 {
  out.identity();
  for (const turn of head.turns) {
    if (turn.parts) continue;
    const [a, b, c, d, e, f, g, h, k] = rotation(turn, values);
    const [x, y, z] = turn.pivot;
    const back = new Matrix4().set(a, d, g, 0, b, e, h, 0, c, f, k, 0, 0, 0, 0, 1);
    out.multiply(new Matrix4().makeTranslation(x, y, z)).multiply(back).multiply(new Matrix4().makeTranslation(-x, -y, -z));
  }
  return out;
}
