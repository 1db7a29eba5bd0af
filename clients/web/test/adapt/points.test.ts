import { describe, expect, it } from "vitest";
import type { Marks, Position } from "../../adapt/marks";
import { Points } from "../../adapt/points";

const found: Marks = new Map([["9.3", { at: [10, 20] as Position, confidence: 0.5 }], ["2.1", { at: [10, 40] as Position, confidence: 0.9 }]]);
const at = (x: number, y: number) => new Map([["9.3", [x, y] as Position]]);

function begun(): Points {
  const points = new Points();
  points.replace("front", found);
  return points;
}

describe("Points", () => {
  it("makes what a hand moves sure", () => {
    const points = begun();
    points.move("front", at(11, 21), 1);
    expect(points.state.front.get("9.3")).toEqual({ at: [11, 21] });
    expect(points.state.front.get("2.1")).toEqual(found.get("2.1"));
  });

  it("undoes a stroke as a whole, however many moves it had", () => {
    const points = begun();
    for (let x = 0; x < 5; x++) points.move("front", at(x, 0), 1);
    points.move("front", at(99, 0), 2);
    points.undo();
    expect(points.state.front.get("9.3")!.at).toEqual([4, 0]);
    points.undo();
    expect(points.state.front).toEqual(found);
    expect(points.undoable).toBe(false);
  });

  it("does not join a stroke to one that was undone", () => {
    const points = begun();
    points.move("front", at(1, 0), 1);
    points.undo();
    points.move("front", at(2, 0), 1);
    points.undo();
    expect(points.state.front).toEqual(found);
  });

  it("redoes what was undone until something else is done", () => {
    const points = begun();
    points.move("front", at(1, 0), 1);
    points.remove("front", "2.1");
    points.undo();
    points.undo();
    points.redo();
    points.redo();
    expect([...points.state.front]).toEqual([["9.3", { at: [1, 0] }]]);
    points.undo();
    points.move("front", at(5, 5), 2);
    expect(points.redoable).toBe(false);
    points.redo();
    expect(points.state.front.get("9.3")!.at).toEqual([5, 5]);
  });

  it("has nothing to undo when nothing was there to be removed", () => {
    const points = begun();
    points.remove("front", "8.1");
    expect(points.undoable).toBe(false);
  });

  it("never undoes the first points of a photo, even if they come late", () => {
    const points = begun();
    points.move("front", at(1, 1), 1);
    points.replace("profile", found);
    points.undo();
    expect(points.state).toEqual({ front: found, profile: found });
    expect(points.undoable).toBe(false);
  });

  it("gives points back that another photo, or a file, replaced", () => {
    const points = begun();
    points.replace("front", new Map());
    expect(points.state.front.size).toBe(0);
    points.undo();
    expect(points.state.front).toEqual(found);
  });

  it("takes all of its past along to a photo of another size", () => {
    const points = begun();
    points.move("front", at(50, 60), 1);
    points.rescale("front", [100, 200], [200, 100]);
    expect(points.state.front.get("9.3")!.at).toEqual([100, 30]);
    points.undo();
    expect(points.state.front.get("9.3")).toEqual({ at: [20, 10], confidence: 0.5 });
    points.redo();
    expect(points.state.front.get("9.3")!.at).toEqual([100, 30]);
  });
});
