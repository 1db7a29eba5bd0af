import { describe, expect, it } from "vitest";
import { formatPoints, parsePoints } from "../../adapt/file";
import { scaled, type FeaturePoint, type Marks } from "../../adapt/marks";

const features: FeaturePoint[] = [
  { name: "9.3", title: "tip of the nose", views: ["front", "profile"] },
  { name: "3.5", title: "left pupil", views: ["front"], mirror: "3.6" },
];
const marks: Marks = new Map([["9.3", { at: [10.126, 20] }], ["3.5", { at: [30, 40], confidence: 0.12345 }]]);

describe("the file of points", () => {
  it("has the form that fapstream/adapt/points.py reads", () => {
    const text = formatPoints({ profile: { size: [50, 60], marks: new Map([["9.3", { at: [1, 2] }]]), facing: "left" }, front: { size: [100, 200], marks } });
    expect(JSON.parse(text)).toEqual({
      version: 1,
      front: { size: [100, 200], points: { "9.3": [10.13, 20], "3.5": [30, 40, 0.123] } },
      profile: { facing: "left", size: [50, 60], points: { "9.3": [1, 2] } },
    });
  });

  it("is read back", () => {
    const sheets = parsePoints(formatPoints({ front: { size: [100, 200], marks } }), features);
    expect(sheets).toEqual({ front: { size: [100, 200], marks: new Map([["9.3", { at: [10.13, 20] }], ["3.5", { at: [30, 40], confidence: 0.123 }]]) } });
  });

  it("keeps points within their photo", () => {
    const { front } = parsePoints('{"version": 1, "front": {"size": [10, 10], "points": {"9.3": [11, -1]}}}', features);
    expect(front!.marks.get("9.3")!.at).toEqual([10, 0]);
  });

  const one = (points: unknown, size: unknown = [10, 10]) => JSON.stringify({ version: 1, front: { size, points } });
  it.each([
    ["no JSON", "hello", /not JSON/],
    ["another file", '{"version": 2}', /version is not 1/],
    ["nothing", '{"version": 1}', /front is missing/],
    ["no points", '{"version": 1, "front": {"size": [1, 1]}}', /front has no points/],
    ["no size", one({}, [10]), /front\.size/],
    ["a size of nothing", one({}, [0, 10]), /front\.size/],
    ["an unknown point", one({ "99.1": [1, 1] }), /front\.points\.99\.1 is no feature point/],
    ["half a position", one({ "9.3": [1] }), /front\.points\.9\.3 is not/],
    ["text", one({ "9.3": ["1", 2] }), /front\.points\.9\.3 is not/],
    ["a point of another view", '{"version": 1, "profile": {"size": [9, 9], "points": {"3.5": [1, 1]}}}', /profile\.points\.3\.5 is no feature point/],
  ])("refuses %s, and says where", (_, text, message) => {
    expect(() => parsePoints(text, features)).toThrow(RangeError);
    expect(() => parsePoints(text, features)).toThrow(message);
  });
});

describe("scaled", () => {
  it("takes points to a photo of another size, corner to corner", () => {
    const corners: Marks = new Map([["a", { at: [0, 0] }], ["b", { at: [100, 50], confidence: 0.5 }]]);
    expect(scaled(corners, [100, 50], [300, 100])).toEqual(new Map([["a", { at: [0, 0] }], ["b", { at: [300, 100], confidence: 0.5 }]]));
  });
});
