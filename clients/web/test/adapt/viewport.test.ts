import { describe, expect, it } from "vitest";
import type { Position, Size } from "../../adapt/marks";
import { panned, resized, round, showing, toBox, toPhoto, whole, zoomed, type Viewport } from "../../adapt/viewport";

const photo: Size = [1000, 500];
const box: Size = [400, 300];
const fit = whole(photo, box);

function expectNear(place: Position, wanted: Position): void {
  expect(place[0]).toBeCloseTo(wanted[0], 6);
  expect(place[1]).toBeCloseTo(wanted[1], 6);
}

function expectFilled(port: Viewport): void {
  const [[left, top], [right, bottom]] = [toBox(port, [0, 0]), toBox(port, [...photo])];
  if (right - left >= box[0]) expect([left <= 1e-6, right >= box[0] - 1e-6]).toEqual([true, true]);
  else expect(left + right).toBeCloseTo(box[0]);
  if (bottom - top >= box[1]) expect([top <= 1e-6, bottom >= box[1] - 1e-6]).toEqual([true, true]);
  else expect(top + bottom).toBeCloseTo(box[1]);
}

describe("the whole photo", () => {
  it("fits into the box, corners and the middle of its first pixel", () => {
    expectNear(toBox(fit, [0, 0]), [0, 50]);
    expectNear(toBox(fit, [1000, 500]), [400, 250]);
    expectNear(toBox(fit, [0.5, 0.5]), [0.2, 50.2]);
  });
  it("goes there and back", () => expectNear(toPhoto(fit, toBox(fit, [123.25, 45.5])), [123.25, 45.5]));
});

describe("zooming", () => {
  it("keeps what is under the pointer, once the box is filled", () => {
    const port = zoomed(fit, 3, [200, 150], photo, box);
    const at: Position = [130, 170];
    const closer = zoomed(port, 1.7, at, photo, box);
    expect(closer.scale).toBeCloseTo(port.scale * 1.7);
    expectNear(toPhoto(closer, at), toPhoto(port, at));
  });
  it("ends at the whole photo and at a pixel as large as a thumbnail", () => {
    expect(zoomed(fit, 0.1, [0, 0], photo, box)).toEqual(fit);
    expect(zoomed(fit, 1e9, [0, 0], photo, box).scale).toBe(24);
  });
  it("never leaves a gap", () => {
    let port = fit;
    for (const [factor, at] of [[1.3, [0, 0]], [5, [399, 299]], [0.4, [0, 299]], [0.3, [200, 10]]] as [number, Position][]) {
      port = zoomed(port, factor, at, photo, box);
      expectFilled(port);
    }
  });
});

describe("panning", () => {
  const port = zoomed(fit, 4, [200, 150], photo, box);
  it("moves the photo with the hand", () => expectNear(toPhoto(panned(port, [30, -20], photo, box), [130, 130]), toPhoto(port, [100, 150])));
  it("stops at the edges", () => {
    expectNear(toPhoto(panned(port, [9999, 9999], photo, box), [0, 0]), [0, 0]);
    expectNear(toPhoto(panned(port, [-9999, -9999], photo, box), [...box]), [...photo]);
  });
  it("does nothing to a photo that is all there", () => expect(panned(fit, [50, 50], photo, box)).toEqual(fit));
});

describe("showing a point", () => {
  const port = zoomed(fit, 8, [200, 150], photo, box);
  it("pans as far as it needs", () => {
    const seen = toBox(showing(port, [700, 300], 40, photo, box), [700, 300]);
    expect(seen[0]).toBeCloseTo(box[0] - 40);
  });
  it("leaves the photo where it is if the point is seen", () => expect(showing(port, [500, 250], 40, photo, box)).toEqual(port));
});

describe("looking at a face", () => {
  const places: Position[] = [[400, 100], [600, 100], [500, 300]];
  it("has all of it in the box, in the middle", () => {
    const port = round(places, photo, box);
    expectNear(toBox(port, [500, 200]), [200, 150]);
    for (const [x, y] of places.map((at) => toBox(port, at))) expect(x > 20 && x < 380 && y > 20 && y < 280).toBe(true);
    expect(port.scale).toBeGreaterThan(2 * fit.scale);
  });
  it("is the whole photo where there is no face, or one that fills it", () => {
    expect(round([], photo, box)).toEqual(fit);
    expect(round([[0, 0], [1000, 500]], photo, box)).toEqual(fit);
  });
});

describe("another box", () => {
  it("shows the same middle at the same zoom", () => {
    const port = zoomed(fit, 5, [120, 140], photo, box);
    const wide: Size = [800, 600];
    const other = resized(port, box, photo, wide);
    expectNear(toPhoto(other, [400, 300]), toPhoto(port, [200, 150]));
    expect(other.scale).toBeCloseTo(2 * port.scale);
  });
  it("shows the whole photo if it did", () => expect(resized(fit, box, photo, [200, 900])).toEqual(whole(photo, [200, 900])));
});
