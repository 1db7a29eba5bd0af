import { afterEach, expect, it, vi } from "vitest";
import { HeadError } from "../../src/head/model";
import { loadHead } from "../../src/io/heads";
import { smallHead } from "../glb";

afterEach(() => vi.unstubAllGlobals());

function serve(...answers: (() => Response)[]) {
  const fetch = vi.fn(() => Promise.resolve().then(() => (answers.length > 1 ? answers.shift()! : answers[0])()));
  vi.stubGlobal("fetch", fetch);
  return fetch;
}

it("fetches a head once, for however many ask", async () => {
  const fetch = serve(() => new Response(smallHead() as Uint8Array<ArrayBuffer>));
  const [a, b] = await Promise.all([loadHead("http://x/1.glb"), loadHead("http://x/1.glb")]);
  expect(a).toBe(b);
  expect(fetch).toHaveBeenCalledTimes(1);
});

it("reads a blob, and does not keep it", async () => {
  const url = URL.createObjectURL(new Blob([smallHead() as Uint8Array<ArrayBuffer>]));
  const head = await loadHead(url);
  expect(head.parts.length).toBeGreaterThan(0);
  expect(await loadHead(url)).not.toBe(head);
  URL.revokeObjectURL(url);
  await expect(loadHead(url)).rejects.toThrow(HeadError);
});

it.each([
  ["is not there", () => new Response("", { status: 404 })],
  ["is no head", () => new Response("hello")],
  ["cannot be reached", () => { throw new TypeError("network"); }],
])("says so when it %s, and tries again when asked again", async (name, answer) => {
  serve(answer, () => new Response(smallHead() as Uint8Array<ArrayBuffer>));
  const url = `http://x/${name}.glb`;
  await expect(loadHead(url)).rejects.toThrow(HeadError);
  expect((await loadHead(url)).name).toBe("small");
});

it("names the file in what is wrong with it", async () => {
  serve(() => new Response(smallHead().slice(0, 400) as Uint8Array<ArrayBuffer>));
  await expect(loadHead("http://x/cut.glb")).rejects.toThrow(/^http:\/\/x\/cut\.glb: GLB header says version 2, \d+ bytes; there are 400$/);
});
