/**
 * Builds the client into the server's package, or the folder given, and says how large it is; fails above the limit.
 */

import { readdirSync, readFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "vite";

const LIMIT_KB = 200;
const FOLDER = resolve(process.argv[2] ?? `${import.meta.dirname}/../../fapstream/server/web`);
const OUT = pathToFileURL(`${FOLDER}/`);

for (const mode of ["production", "adapt"]) {
  await build({ root: import.meta.dirname, mode, logLevel: "warn", build: { outDir: FOLDER, emptyOutDir: mode === "production" } });
}

if (/\b(import|export)\b/.test(readFileSync(new URL("fap-worklet.js", OUT), "utf-8"))) {
  throw new Error("fap-worklet.js has to stand alone: some browsers load no modules into a worklet");
}

const sizes = readdirSync(OUT).sort().map((name) => {
  const data = readFileSync(new URL(name, OUT));
  return { name, raw: data.length, gzip: gzipSync(data, { level: 9 }).length };
});
const kb = (bytes) => `${(bytes / 1000).toFixed(1).padStart(7)} kB`;
for (const { name, raw, gzip } of sizes) console.log(`${name.padEnd(16)} ${kb(raw)}  gzip ${kb(gzip)}`);

const total = sizes.filter(({ name }) => name.endsWith(".js")).reduce((sum, { gzip }) => sum + gzip, 0);
console.log(`JavaScript, with three.js: ${(total / 1000).toFixed(1)} kB gzip of at most ${LIMIT_KB} kB`);
if (total > LIMIT_KB * 1000) process.exit(1);
