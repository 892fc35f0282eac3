// CPU time of runs in WebAssembly over that in the program: node studies/web/tests/ratio.mjs [ROUNDS]
//
// Both make the same spectrum, one run after the other on one thread and without lanes, in turn. The shortest time of each counts.

import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { DEFAULTS } from "../page/fields.js";
import { call, start } from "../page/worker.js";

const root = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const target = process.env.CARGO_TARGET_DIR ?? join(root, "target");
const exports = start(new WebAssembly.Module(readFileSync(join(root, "target/web/rocking_web.wasm"))));
const { reply } = call(exports, { op: "spectrum", fields: { ...DEFAULTS, points: "400" } });
const words = reply.command.replace("spectrum.csv", "-").split(" ").slice(1);
const rounds = Number(process.argv[2] ?? 5);
let [wasm, native] = [Infinity, Infinity];
for (let round = 0; round < rounds; round++) {
  let begin = performance.now();
  call(exports, { op: "rows", from: 0, to: reply.rows });
  wasm = Math.min(wasm, performance.now() - begin);
  begin = performance.now();
  execFileSync(join(target, "release/rocking"), [...words, "--lanes", "1", "--threads", "1"], { cwd: root, stdio: ["ignore", "ignore", "ignore"] });
  native = Math.min(native, performance.now() - begin);
}
console.log(`${reply.rows} runs: WebAssembly ${wasm.toFixed(0)} ms, program ${native.toFixed(0)} ms, ratio ${(wasm / native).toFixed(2)}`);
