// Builds the page: one file with the engine, the plots, the style and the scripts inside.
// node studies/web/build.mjs ENGINE.wasm VERSION OUTPUT.html

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import binaryen from "binaryen";
import { build } from "esbuild";
import { call, start } from "./page/worker.js";

const LARGEST = 2.5e6;
const here = dirname(fileURLToPath(import.meta.url));
const [wasm, version, output] = process.argv.slice(2);
const read = (path) => readFileSync(join(here, path), "utf8");

/**
 * Keeps only the functions that the page calls. The drawing library brings bindings to web pages, with their own exports, which
 * drawing to SVG never uses. No pass touches the remaining instructions: they give the bits of the program.
 */
function reduced(bytes) {
  const module = binaryen.readBinary(bytes);
  for (let i = module.getNumExports() - 1; i >= 0; i--) {
    const { name } = binaryen.getExportInfo(module.getExportByIndex(i));
    if (name !== "memory" && !name.startsWith("rocking_")) module.removeExport(name);
  }
  module.runPasses(["remove-unused-module-elements", "strip-debug", "strip-producers", "strip-target-features"]);
  return module.emitBinary();
}

async function script(entry, define = {}) {
  const made = await build({
    entryPoints: [join(here, "page", entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: ["chrome110", "firefox113", "safari16.4"],
    define,
  });
  // `</script` would end the element.
  return made.outputFiles[0].text.replaceAll("</script", "<\\/script");
}

/** Writes what the fields need to know of the engine, for the page and for its tests. */
function writeSpecification(bytes) {
  const { reply } = call(start(new WebAssembly.Module(bytes)), { op: "specification" });
  const folder = join(here, "../../target/web");
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, "specification.js"), `export const SPECIFICATION = ${JSON.stringify(reply)};\n`);
}

const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
writeSpecification(readFileSync(wasm));
const worker = await script("worker.js");
const parts = {
  "/*STYLE*/": read("node_modules/uplot/dist/uPlot.min.css") + read("page/style.css"),
  "<!--LICENCES-->": escaped(`uPlot ${JSON.parse(read("node_modules/uplot/package.json")).version}\n\n${read("node_modules/uplot/LICENSE")}\n` +
    `DejaVu Sans, whose letters are in exported pictures\n\n${read("../charts/assets/LICENSE_DEJAVU")}\n`),
  "<!--ENGINE-->": gzipSync(reduced(readFileSync(wasm)), { level: 9 }).toString("base64"),
  "<!--SCRIPT-->": await script("main.js", { WORKER_SOURCE: JSON.stringify(worker), VERSION: JSON.stringify(version) }),
};
let page = read("page/index.html");
for (const [place, content] of Object.entries(parts)) page = page.replace(place, () => content);
const size = Buffer.byteLength(page);
if (size > LARGEST) throw new Error(`the page has ${size} bytes; expected at most ${LARGEST}`);
writeFileSync(output, page);
console.log(`${output}: ${size} bytes`);
