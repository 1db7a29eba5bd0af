import { describe, expect, it } from "vitest";
import type { FeaturePoint, Marks, Position } from "../../adapt/marks";
import { hidden, midline, opposite } from "../../adapt/symmetry";

const both = ["front", "profile"] as const;
const features: FeaturePoint[] = [
  { name: "9.3", title: "tip of the nose", views: both },
  { name: "2.1", title: "chin", views: both },
  { name: "3.7", title: "left eye", views: both, mirror: "3.12" },
  { name: "3.12", title: "right eye", views: both, mirror: "3.7" },
  { name: "8.3", title: "left corner", views: both, mirror: "8.4" },
  { name: "8.4", title: "right corner", views: both, mirror: "8.3" },
  { name: "9.1", title: "left wing", views: both, mirror: "9.2" },
  { name: "9.2", title: "right wing", views: both, mirror: "9.1" },
];

const marks = (places: Record<string, Position>): Marks => new Map(Object.entries(places).map(([name, at]) => [name, { at }]));
/** A face with its middle at x = 100, tilted by `angle` about (100, 100). */
function face(angle: number): Record<string, Position> {
  const upright: Record<string, Position> = { "9.3": [100, 100], "2.1": [100, 180], "3.7": [140, 60], "3.12": [60, 60], "8.3": [120, 140], "8.4": [80, 140], "9.1": [110, 105], "9.2": [90, 105] };
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return Object.fromEntries(Object.entries(upright).map(([name, [x, y]]) => [name, [100 + c * (x - 100) - s * (y - 100), 100 + s * (x - 100) + c * (y - 100)] as Position]));
}
const pick = (places: Record<string, Position>, ...names: string[]) => marks(Object.fromEntries(names.map((name) => [name, places[name]])));

function expectNear(place: Position, wanted: Position): void {
  expect(place[0]).toBeCloseTo(wanted[0], 6);
  expect(place[1]).toBeCloseTo(wanted[1], 6);
}

describe.each([-0.6, 0, 0.3])("a face tilted by %f", (angle) => {
  const places = face(angle);

  it.each([
    ["the points on its middle", ["9.3", "2.1", "3.7", "3.12"]],
    ["the middles of the pairs", ["9.3", "3.7", "3.12", "8.3", "8.4"]],
    ["all", Object.keys(places)],
  ])("mirrors by %s", (_, names) => {
    const line = midline(pick(places, ...names), features)!;
    expectNear(opposite(line, places["3.7"]), places["3.12"]);
    expectNear(opposite(line, places["8.4"]), places["8.3"]);
  });

  it("is not misled by the pair that is being moved", () => {
    const off = { ...places, "3.7": [500, -90] as Position };
    const line = midline(pick(off, "3.7", "3.12", "8.3", "8.4", "9.1", "9.2"), features, "3.12")!;
    expectNear(opposite(line, places["8.3"]), places["8.4"]);
  });
});

describe("midline", () => {
  it("is upright through the middle of the pairs if they tell no more", () => {
    const line = midline(marks({ "3.7": [140, 60], "3.12": [60, 64] }), features)!;
    expectNear(opposite(line, [150, 70]), [50, 70]);
  });

  it("is upright where the points on it lie too close together, or across", () => {
    for (const chin of [[101, 105], [180, 110]] as Position[]) {
      const line = midline(marks({ "9.3": [100, 100], "2.1": chin, "3.7": [140, 60], "3.12": [60, 60] }), features)!;
      expect(line.along).toEqual([0, 1]);
      expect(line.at[0]).toBe(100);
    }
  });

  it("needs something to go by", () => {
    expect(midline(new Map(), features)).toBeNull();
    expect(midline(marks({ "3.7": [140, 60] }), features)).toBeNull();
    expect(midline(marks({ "9.3": [100, 60] }), features)).toEqual({ at: [100, 60], along: [0, 1] });
  });

  it("is its own mirror image", () => {
    const line = midline(pick(face(0.3), "9.3", "2.1"), features)!;
    expectNear(opposite(line, line.at), line.at);
    expectNear(opposite(line, opposite(line, [7, 8])), [7, 8]);
  });
});

describe("hidden", () => {
  const places = new Map(Object.entries(face(0)));
  it("is the right side of who looks to the left of the picture", () => expect(hidden("left", features, places)).toEqual(new Set(["3.12", "8.4", "9.2"])));
  it("is the left side of who looks to the right", () => expect(hidden("right", features, places)).toEqual(new Set(["3.7", "8.3", "9.1"])));
});
