import { expect, it } from "vitest";
import { pictureSize } from "../../src/head/picture";

const bytes = (...parts: (string | number[])[]) =>
  Uint8Array.from(parts.flatMap((part) => (typeof part === "string" ? [...part].map((c) => c.charCodeAt(0)) : part)));
const zeros = (n: number) => new Array<number>(n).fill(0);

it.each<[string, Uint8Array, [number, number] | null]>([
  ["PNG", bytes([0x89], "PNG\r\n\x1a\n", zeros(4), "IHDR", [0, 0, 4, 1], [0, 0, 0, 8]), [1025, 8]],
  ["JPEG", bytes([0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff, 0xc2, 0, 17, 8, 1, 0, 2, 0], zeros(8)), [512, 256]],
  ["WebP", bytes("RIFF", zeros(4), "WEBPVP8 ", zeros(10), [0x2c, 1, 0x40, 0]), [300, 64]],
  ["lossless WebP", bytes("RIFF", zeros(4), "WEBPVP8L", zeros(4), [0x2f, 0x24, 0x40, 0x0f, 0], zeros(8)), [37, 62]],
  ["large WebP", bytes("RIFF", zeros(4), "WEBPVP8X", zeros(8), [36, 0, 1], [9, 0, 0]), [65573, 10]],
  ["text", bytes("hello, this is no picture at all."), null],
  ["a cut JPEG", bytes([0xff, 0xd8, 0xff, 0xc0]), null],
  ["nothing", bytes(), null],
])("%s", (_, data, size) => expect(pictureSize(data)).toEqual(size));
