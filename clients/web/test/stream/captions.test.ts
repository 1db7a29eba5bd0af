import { beforeEach, describe, expect, it } from "vitest";
import { Captions } from "../../src/stream/captions";

let captions: Captions;
beforeEach(() => (captions = new Captions()));
const whole = () => captions.view.said + captions.view.word + captions.view.ahead;

describe("Captions", () => {
  it("shows nothing of a caption before its first word", () => {
    captions.caption({ text: "Hello there." });
    expect(captions.view).toEqual({ said: "", word: "", ahead: "Hello there." });
  });

  it("lights the word and leaves the rest ahead", () => {
    captions.caption({ text: "Καλή 🙂 μέρα, Καλή!", char_start: 10 });
    captions.word({ text: "Καλή", char_start: 10 });
    captions.word({ text: "μέρα", char_start: 17 });
    expect(captions.view).toEqual({ said: "Καλή 🙂 ", word: "μέρα", ahead: ", Καλή!" });
    captions.word({ text: "Καλή", char_start: 23 });
    expect(captions.view).toEqual({ said: "Καλή 🙂 μέρα, ", word: "Καλή", ahead: "!" });
  });

  it("finds repeated words in order where no offsets are given", () => {
    captions.caption({ text: "no no no" });
    for (const said of ["", "no ", "no no "]) {
      captions.word({ text: "no" });
      expect(captions.view.said).toBe(said);
      expect(whole()).toBe("no no no");
    }
  });

  it("adds words that no caption holds", () => {
    captions.word({ text: "one" });
    captions.word({ text: "two" });
    expect(captions.view).toEqual({ said: "one ", word: "two", ahead: "" });
  });

  it("starts anew", () => {
    captions.word({ text: "one" });
    captions.clear();
    expect(whole()).toBe("");
    captions.word({ text: "two" });
    expect(whole()).toBe("two");
  });
});
