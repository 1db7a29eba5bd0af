import { readFileSync } from "node:fs";
import { defineConfig } from "vite";

/** three.js goes into the bundle; its licence asks to be named there. */
const LICENCE = readFileSync(new URL("node_modules/three/LICENSE", import.meta.url), "utf-8").trim();
const banner = ({ name }: { name: string }) =>
  name === "fap-head" ? `/*! fapstream, Apache-2.0. Contains three.js:\n\n${LICENCE}\n*/` : "";

/** Where the server takes the client from; committed, so that a clone without Node can serve it. */
const OUT = "../../fapstream/server/web";

/**
 * What is built in one go shares its modules. The editor is built by itself, with its own copy of the few it needs:
 * pages that embed fap-head.js shall load one script, not two.
 */
const INPUTS: Record<string, Record<string, string>> = {
  production: { "fap-head": "src/index.ts", "fap-worklet": "src/worklet/processor.ts", demo: "demo/demo.ts" },
  adapt: { adapt: "adapt/adapt.ts" },
};

export default defineConfig(({ mode }) => ({
  publicDir: "public",
  build: {
    outDir: OUT,
    emptyOutDir: true,
    target: "es2022",
    sourcemap: false,
    modulePreload: false,
    chunkSizeWarningLimit: 1000,
    minify: "oxc",
    rolldownOptions: {
      input: INPUTS[mode] ?? INPUTS.production,
      preserveEntrySignatures: "strict",
      external: [/fap-head\.js$/],
      output: { format: "es", entryFileNames: "[name].js", chunkFileNames: "[name].js", postBanner: banner },
    },
  },
  test: { include: ["test/**/*.test.ts"] },
}) as never);
