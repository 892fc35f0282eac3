// The engine of the page gives the bytes of the program: node --test studies/web/tests/bits.mjs
//
// Both get the same input in their own form: the page's fields, and the command line that the page shows.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { DEFAULTS, fromHash, toHash } from "../page/fields.js";
import { call, start } from "../page/worker.js";

const root = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const target = process.env.CARGO_TARGET_DIR ?? join(root, "target");
const program = process.env.ROCKING ?? join(target, "release", "rocking");
const module = new WebAssembly.Module(readFileSync(join(root, "target/web/rocking_web.wasm")));
const cases = JSON.parse(readFileSync(join(root, "tests/reference/cases.json"), "utf8"));

/** Runs the program in the repository's folder with the words of a command line. */
function rocking(command, changes = {}) {
  const words = command.match(/'(?:[^'\\]|\\.)*'|\S+/g).map((word) => word.replace(/^'|'$/g, ""));
  const args = words.slice(1).map((word) => changes[word] ?? word);
  return execFileSync(program, args, { cwd: root, maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"] });
}

function page() {
  const exports = start(module);
  return (request, bytes) => {
    const { reply, buffer } = call(exports, request, bytes);
    return { ...reply, bytes: Buffer.from(buffer) };
  };
}

/** Checks table and picture of a run against those of the command line that the page shows. */
function compare(ask, fields) {
  const run = ask({ op: "run", fields: { ...DEFAULTS, ...fields } });
  assert.ok(run.ok, JSON.stringify(run.errors));
  assert.ok(run.rows > 100);
  const table = ask({ op: "csv" }).bytes;
  // In space a line before the headings names the model.
  assert.equal(table.toString().split("\n").length, run.rows + (run.in_space ? 3 : 2));
  assert.ok(table.equals(rocking(run.command, { "history.csv": "-" })), `the table of ${run.command}`);
  const svg = rocking(run.command.replace("--csv history.csv", "--plot - --plot-format svg"));
  assert.ok(ask({ op: "svg" }).bytes.equals(svg), `the picture of ${run.command}`);
  return run;
}

test("the embedded record gives the bytes of the program", () => {
  compare(page(), {});
  const alone = compare(page(), { shape: "ratios", alpha: "0.15", p: "2", xi_v: "0.2", scale: "1", on_separation: "terminate" });
  assert.equal(alone.command, "rocking simulate --alpha 0.15 --p 2 --xi-v 0.2 --csv history.csv");
});

/** Blocks in space: size or ratios, feet by η and ξ_v or by K and C, friction, under each kind of motion and in several directions. */
const IN_SPACE = {
  "under the embedded record": { scale: "2" },
  "under a pulse along a diagonal": { excitation: "pulse", amplitude: "2.5", azimuth: "57.5", kappa: "0.6", depth: "0.9" },
  "released in a direction": { excitation: "release", tilt: "0.4", azimuth: "200", sliding: "friction", friction: "0.3" },
  "in ratios": { shape: "ratios", alpha: "0.2", p: "2", depth: "0.7", excitation: "pulse", amplitude: "3", azimuth: "0", on_separation: "terminate" },
  "on springs": { supports: "stiffness", mass: "900", eccentricity: "0.05", excitation: "pulse", amplitude: "2", duration: "4", step: "0.02", tolerance: "1e-7" },
};
for (const [name, fields] of Object.entries(IN_SPACE)) {
  test(`a block in space ${name} gives the bytes of the program`, () => {
    const ask = page();
    const run = compare(ask, { body: "space", ...fields });
    assert.ok(run.in_space && run.numbers.length > 4 && run.units.length === run.series.length);
    // The first series is that of the table, and pieces make the whole.
    const lines = ask({ op: "csv" }).bytes.toString().trimEnd().split("\n");
    assert.equal(run.bytes.readDoubleLE(8 * (run.rows - 1)), Number(lines.at(-1).split(",")[0]));
    const pieces = [[0, 40], [40, run.rows]].map(([from, to]) => ask({ op: "csv", from, to }).bytes);
    assert.ok(Buffer.concat(pieces).equals(ask({ op: "csv" }).bytes));
    assert.match(ask({ op: "svg", plan: true }).bytes.toString(), /middle of the base/);
  });
}

test("what a block in space does not have is refused beside its field", () => {
  const ask = page();
  const refused = (fields) => ask({ op: "run", fields: { ...DEFAULTS, body: "space", ...fields } }).errors ?? [];
  assert.equal(refused({ depth: "0" })[0].field, "depth");
  assert.equal(refused({ xi_v: "0" })[0].field, "xi_v");
  assert.equal(refused({ azimuth: "north" })[0].field, "azimuth");
  assert.equal(refused({ eccentricity: "0.3" })[0].field, "eccentricity");
  assert.deepEqual(refused({ foundation: "rigid", tie: "one" }), [], "choices of the plane stay unread");
  const study = ask({ op: "spectrum", fields: { ...DEFAULTS, body: "space" } });
  assert.match(study.errors[0].message, /for a block in the plane/);
});

// Pulses, a small block, free motion, supports and the rigid base.
for (const name of ["sine_eta40", "sine_rigid", "cosine_small_block", "free_rigid", "free_095", "overturns", "sine_separates"]) {
  test(`the reference case ${name} gives the bytes of the program`, () => {
    const found = cases.find((one) => one.name === name);
    const { alpha, p, eta = 40, xi_v = 0.1, epsilon = 0, foundation = "viscoelastic", gamma = 3, g, M = 1, t_end, dt, a_gx } = found;
    const texts = { alpha, p, eta, xi_v, epsilon, foundation, gamma, g, mass: M, duration: t_end, step: dt };
    const fields = { shape: "ratios", on_separation: "terminate" };
    for (const [key, value] of Object.entries(texts)) fields[key] = String(value);
    if (a_gx?.kind === "sine" || a_gx?.kind === "cosine") {
      Object.assign(fields, { excitation: "pulse", pulse: `one-${a_gx.kind}`, amplitude: String(a_gx.a_p), period: String((2 * Math.PI) / a_gx.omega_p) });
    } else {
      const { theta = 0, theta_dot = 0 } = found.initial;
      Object.assign(fields, { excitation: "release", tilt: String(theta / alpha), theta_dot: String(theta_dot) });
    }
    const run = compare(page(), fields);
    assert.equal(run.outcome === "undecided" ? "completed" : run.outcome, found.end);
    // A block that has overturned ends between two samples of the reference.
    if (found.end !== "overturned") assert.ok(Math.abs(run.peak.theta - found.peak_theta) < 1e-3 * alpha, `${run.peak.theta} and ${found.peak_theta}`);
  });
}

test("dropped files, one of them vertical, give the bytes of the program", () => {
  const ask = page();
  const folder = mkdtempSync(join(tmpdir(), "rocking-"));
  try {
    const files = { record: "0111a.smc", vertical: "np01002p_4225a_a.smc" };
    for (const [slot, name] of Object.entries(files)) ask({ op: "file", slot, name }, readFileSync(join(root, "examples/records", name)));
    const fields = { ...DEFAULTS, excitation: "file", vertical: "file", scale: "3" };
    const run = ask({ op: "run", fields });
    assert.ok(run.ok, JSON.stringify(run.errors));
    const changes = { "history.csv": "-", [files.record]: `examples/records/${files.record}`, [files.vertical]: `examples/records/${files.vertical}` };
    assert.ok(ask({ op: "csv" }).bytes.equals(rocking(run.command, changes)), run.command);
    // A table without a unit: the message appears beside the unit, and the unit resolves it.
    const rows = Array.from({ length: 600 }, (_, i) => `${(i / 100).toFixed(2)},${(3 * Math.sin(i / 10)).toFixed(4)}`).join("\n");
    const path = join(folder, "my record's.csv");
    writeFileSync(path, `t,a\n${rows}\n`);
    ask({ op: "file", slot: "record", name: "my record's.csv" }, readFileSync(path));
    const refused = ask({ op: "run", fields: { ...fields, vertical: "none" } });
    assert.deepEqual(refused.errors.map(({ field }) => field), ["unit"]);
    assert.match(refused.errors[0].message, /my record's\.csv.*unit/);
    const read = ask({ op: "run", fields: { ...fields, vertical: "none", unit: "m/s2", scale: "1" } });
    assert.ok(read.ok, JSON.stringify(read.errors));
    const command = read.command.replace("'my record'\\''s.csv'", path.replaceAll(" ", "\u0001"));
    const words = command.split(" ").slice(1).map((word) => word.replaceAll("\u0001", " ").replace("history.csv", "-"));
    const table = execFileSync(program, words, { maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"] });
    assert.ok(ask({ op: "csv" }).bytes.equals(table));
  } finally {
    rmSync(folder, { recursive: true });
  }
});

// A tie that goes slack and breaks.
const TIE = { tie: "one", tie_1_stiffness: "3e4", tie_1_slack: "0.01", tie_1_strength: "4e3", shape: "ratios", alpha: "0.2", p: "2" };
const TIES = { ...TIE, tie: "two", tie_2_stiffness: "5e4", tie_2_ground_x: "-2" };
// A body as measured: its centre of mass is low, and its inertia known.
const MEASURED = { center_height: "1.05", inertia: "640", mass: "1200" };
const MEASURED_ON_SUPPORTS = { ...MEASURED, supports: "stiffness", stiffness: "2e6", damping: "3000" };

/** All rows of a study in pieces of three. */
function rows(ask, count) {
  let lines = "";
  for (let from = 0; from < count; from += 3) lines += ask({ op: "rows", from, to: from + 3 }).bytes.toString();
  return lines;
}

test("spectra in pieces give the bytes of the program", () => {
  const rigid = { excitation: "pulse", foundation: "rigid", epsilon: "0.2", mass: "70", sliding: "friction", friction: "0.4" };
  for (const fields of [{ points: "9" }, { points: "5", ...rigid }, { points: "5", eccentricity: "0.05" }, { points: "5", ...TIES }]) {
    const ask = page();
    const study = ask({ op: "spectrum", fields: { ...DEFAULTS, ...fields } });
    assert.ok(study.ok, JSON.stringify(study.errors));
    const table = rocking(study.command, { "spectrum.csv": "-" }).toString();
    assert.equal(study.header + rows(ask, study.rows), table);
  }
});

test("ensembles in pieces give the bytes of the program", () => {
  const sizes = { shape: "size", supports: "stiffness", stiffness: "2e6", damping: "3000", mass: "1500", sliding: "friction", friction: "0.4" };
  for (const fields of [{}, { excitation: "pulse", ...sizes }, { foundation: "rigid", on_separation: "terminate" }, TIE, TIES, MEASURED_ON_SUPPORTS]) {
    const ask = page();
    const study = ask({ op: "ensemble", fields: { ...DEFAULTS, scale_count: "4", samples: "5", ...fields } });
    assert.ok(study.ok, JSON.stringify(study.errors));
    // The study file names the embedded record from the repository's folder.
    const path = join(root, `.study-${process.pid}.toml`);
    try {
      writeFileSync(path, study.file);
      const table = rocking(study.command, { "study.toml": path, "ensemble.csv": "-" }).toString();
      assert.equal(study.header + rows(ask, study.rows), table);
    } finally {
      rmSync(path, { force: true });
    }
  }
});

// Every kind of block, and every kind of motion: the fields that the user of the page would set.
const BLOCKS = {
  "α and p": { shape: "ratios", alpha: "0.2", p: "2" },
  "width and height": {},
  "K and C": { supports: "stiffness", stiffness: "2e6", damping: "3000" },
  "a rigid base": { foundation: "rigid", epsilon: "0.1", restitution_factor: "0.95" },
  "α and p on a rigid base": { shape: "ratios", alpha: "0.2", p: "2", foundation: "rigid" },
};
const HOLDS = {
  alone: {},
  "with friction": { sliding: "friction", friction: "0.45" },
  eccentric: { eccentricity: "-0.04", mass: "1500", gamma: "2.8", g: "9.8" },
  "with a tie": { tie: "one", tie_1_stiffness: "3e4", tie_1_slack: "0.01", tie_1_damping: "100", tie_1_strength: "4e3" },
  "with dampers": { damper: "two", damper_1_yield_force: "800", tie: "one", tie_1_yield_force: "300" },
  "with all": { tie: "two", tie_1_pretension: "50", eccentricity: "0.03", sliding: "friction", friction: "0.5", tolerance: "1e-7" },
};
const pulse = { excitation: "pulse", amplitude: "5", period: "0.7" };
const MOTIONS = {
  "the embedded record": { scale: "1.5", duration: "8" },
  "a record": { excitation: "file", record_name: "0111a.smc", scale: "-3", step: "0.01" },
  "a vertical record, too": { excitation: "file", vertical: "file", scale: "3", on_separation: "terminate" },
  "a pulse": pulse,
  "a pulse downwards": { ...pulse, pulse: "symmetric-ricker", amplitude: "-4" },
  "a pulse with a phase": { ...pulse, pulse: "gabor", phase: "-0.5", cycles: "2.5" },
  "a tilt": { excitation: "release", tilt: "-0.5", theta_dot: "-0.1" },
};

/** A page with the files of its motions, whose names are paths from the repository's folder. */
function pageWithFiles() {
  const ask = page();
  for (const slot of ["record", "vertical"]) ask({ op: "file", slot, name: "examples/records/0111a.smc" }, readFileSync(join(root, "examples/records/0111a.smc")));
  return ask;
}

for (const [block, sizes] of Object.entries(BLOCKS)) {
  test(`the program runs the commands of a block by ${block} and gives the page's tables`, () => {
    const ask = pageWithFiles();
    const path = join(root, `.study-${process.pid}-${Object.keys(BLOCKS).indexOf(block)}.toml`);
    for (const [hold, holds] of Object.entries(HOLDS)) {
      for (const [motion, moved] of Object.entries(MOTIONS)) {
        const fields = { ...DEFAULTS, ...sizes, ...holds, ...moved };
        const of = `${block}, ${hold}, ${motion}`;
        const run = ask({ op: "run", fields });
        assert.ok(run.ok, `${of}: ${JSON.stringify(run.errors)}`);
        assert.ok(ask({ op: "csv" }).bytes.equals(rocking(run.command, { "history.csv": "-" })), `${of}: ${run.command}`);
        if (fields.excitation === "release") continue;
        // Friction and eccentricity of a given size belong to one block, and a few studies tell.
        const study = { ...fields, points: "2", p_min: "1", p_max: "4", scale_count: "2", samples: "2", duration: "4" };
        const spectrum = ask({ op: "spectrum", fields: study });
        assert.ok(spectrum.ok, `${of}: ${JSON.stringify(spectrum.errors)}`);
        const table = rocking(spectrum.command, { "spectrum.csv": "-" }).toString();
        assert.equal(spectrum.header + rows(ask, spectrum.rows), table, `${of}: ${spectrum.command}`);
        const ensemble = ask({ op: "ensemble", fields: study });
        assert.ok(ensemble.ok, `${of}: ${JSON.stringify(ensemble.errors)}`);
        try {
          writeFileSync(path, ensemble.file);
          const swept = rocking(ensemble.command, { "study.toml": path, "ensemble.csv": "-" }).toString();
          assert.equal(ensemble.header + rows(ask, ensemble.rows), swept, `${of}: ${ensemble.file}`);
        } finally {
          rmSync(path, { force: true });
        }
      }
    }
  });
}

test("a table in pieces is the whole table", () => {
  const ask = page();
  const { rows: count } = ask({ op: "run", fields: DEFAULTS });
  const whole = ask({ op: "csv" });
  assert.equal(whole.rows, count);
  const pieces = [];
  for (let from = 0; from < count; from += 1000) pieces.push(ask({ op: "csv", from, to: from + 1000 }).bytes);
  assert.ok(pieces.length > 3 && Buffer.concat(pieces).equals(whole.bytes));
});

test("a tied block that passes its balance is not said to stay upright", () => {
  const tie = (number, side) => ({ block_z: "1.8", ground_z: "1.8", ground_x: `${1.5 * side}`, stiffness: "6e4", slack: "0.6", damping: "2e4" });
  const tied = { shape: "ratios", alpha: "0.2", p: "2", foundation: "rigid", tie: "two", excitation: "pulse", amplitude: "4", period: "1.5" };
  for (const [number, side] of [[1, -1], [2, 1]]) {
    for (const [key, value] of Object.entries(tie(number, side))) tied[`tie_${number}_${key}`] = value;
  }
  const sentence = (fields) => page()({ op: "run", fields: { ...DEFAULTS, ...tied, ...fields } }).sentence;
  assert.match(sentence({}), /^The block passes its balance and ends tilted to the (left|right), at [\d.]+ % of the critical tilt α, held by a tie\.$/);
  const elastic = {};
  for (const number of [1, 2]) Object.assign(elastic, { [`tie_${number}_stiffness`]: "2e4", [`tie_${number}_slack`]: "0.3", [`tie_${number}_damping`]: "0" });
  for (const [duration, end] of [["", "does not overturn"], ["40", "comes back upright"]]) {
    assert.equal(sentence({ ...elastic, duration }), `The block passes its balance, tilts to 156 % of the critical tilt α and ${end}.`);
  }
  assert.match(sentence({ tie_1_strength: "100", tie_2_strength: "100" }), /^The block overturns .* tie breaks/);
});

test("wrong input is refused beside its field", () => {
  const ask = page();
  const refused = (fields) => {
    const { ok, errors } = ask({ op: "run", fields: { ...DEFAULTS, ...fields } });
    assert.equal(ok, false);
    return errors.map(({ field, message }) => `${field}: ${message}`);
  };
  assert.deepEqual(refused({ width: "wide", height: "" }), [
    "width: found wide; expected a length > 0 m",
    "height: found nothing; expected a length > 0 m",
  ]);
  // Choices of links that are none of the page's.
  for (const [field, found] of Object.entries({ shape: "sphere", tie: "three", supports: "sand", sliding: "ice", vertical: "up", foundation: "mud" })) {
    assert.match(refused({ [field]: found }).join(), new RegExp(`^${field}: found ${found}; expected one of `));
  }
  assert.deepEqual(refused({ epsilon: "2" }), ["epsilon: found 2; expected a number from 0 to 1"]);
  assert.match(refused({ eccentricity: "0.4" })[0], /^eccentricity: .*expected less than half the width/);
  assert.match(refused({ foundation: "rigid", sliding: "friction", friction: "1.5" })[0], /^friction: .*jam/);
  assert.match(refused({ sliding: "friction", friction: "0" })[0], /^friction: found 0; expected a number > 0/);
  assert.deepEqual(refused({ excitation: "file", record_name: "lost.at2" }), ["record: no file yet; expected lost.at2"]);
  assert.match(refused({ step: "1e-9" })[0], /^step: .*expected at most/);
  // The engine continues to work.
  assert.ok(ask({ op: "run", fields: { ...DEFAULTS, width: "0,6" } }).ok);
});

test("friction, ties, a measured body and a velocity give the bytes of the program, and other runs than without", () => {
  const plain = compare(page(), {});
  const spun = { excitation: "release", tilt: "-0.4", theta_dot: "0.6" };
  const sliding = { foundation: "rigid", sliding: "friction", friction: "0.3", eccentricity: "0.05" };
  for (const fields of [{ sliding: "friction", friction: "0.2" }, { eccentricity: "-0.1" }, TIE, TIES, MEASURED, MEASURED_ON_SUPPORTS, spun, sliding]) {
    assert.notEqual(compare(page(), fields).peak.theta, plain.peak.theta);
  }
});

test("feet slide by a switch, and links of earlier versions by their coefficient", () => {
  assert.equal(page()({ op: "run", fields: DEFAULTS }).block.friction, 0);
  assert.equal(page()({ op: "run", fields: { ...DEFAULTS, sliding: "friction", friction: "0.2" } }).block.friction, 0.2);
  for (const [hash, sliding] of [["", "none"], ["friction=0", "none"], ["#friction=0.3", "friction"], ["sliding=none&friction=0.3", "none"]]) {
    assert.equal(fromHash(hash).sliding, sliding, hash);
  }
  assert.equal(toHash(fromHash("friction=0.3")), "sliding=friction&friction=0.3");
  assert.equal(toHash(fromHash("friction=0")), "");
});

test("numbers beyond reason draw a warning", () => {
  const warnings = (fields) => page()({ op: "run", fields: { ...DEFAULTS, duration: "0.1", ...fields } }).warnings.join("\n");
  assert.equal(warnings({}), "");
  assert.match(warnings({ width: "600", height: "2400", foundation: "rigid" }), /^the block is 600 m wide and 2400 m high/);
  assert.match(warnings({ excitation: "pulse", amplitude: "400" }), /^the amplitude of the pulse, 400 m\/s2, is 40.77 g/);
});
