/** Builds the page of the render benchmark into the folder given. */

import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { build } from "vite";

const outDir = resolve(process.argv[2]);
const rolldownOptions = { input: { bench: `${import.meta.dirname}/bench.ts` }, output: { format: "es", entryFileNames: "[name].js" } };

const options = { outDir, emptyOutDir: true, target: "es2022", modulePreload: false, chunkSizeWarningLimit: 1000, rolldownOptions };
await build({ configFile: false, root: import.meta.dirname, logLevel: "warn", publicDir: false, build: options });

const PAGE = `<!doctype html>
<title>bench</title>
<link rel="icon" href="data:,">
<style>body { margin: 0 } canvas { width: 512px; height: 512px }</style>
<canvas></canvas>
<script type="module" src="bench.js"></script>
`;
writeFileSync(`${outDir}/index.html`, PAGE);
