import { describe, expect, it } from "vitest";
import { Sent } from "../../src/protocol/sent";

const data = (n: number) => Uint8Array.of(n, n);

describe("Sent", () => {
  it("sends again what the other side does not have", () => {
    const sent = new Sent();
    [1, 2, 3].forEach((n) => sent.append(data(n)));
    expect(sent.after(1)).toEqual([data(2), data(3)]);
    expect(sent.after(3)).toEqual([]);
    expect(sent.after(4)).toBeNull();
    sent.forget(2);
    expect(sent.after(1)).toBeNull();
    expect(sent.after(2)).toEqual([data(3)]);
    sent.forget(99);
    expect(sent.after(3)).toEqual([]);
  });

  it("keeps no more than it may", () => {
    const sent = new Sent();
    [1, 2, 3].forEach((n) => sent.append(data(n)));
    sent.shrink(3);
    expect(sent.after(1)).toBeNull();
    expect(sent.after(2)).toEqual([data(3)]);
  });
});
