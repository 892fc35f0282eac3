// The input fields: names, labels, units, ranges of their sliders, and when they are shown. Units, defaults and choices are the engine's.

import { SPECIFICATION } from "../../../target/web/specification.js";

const { units, defaults, links, pulses } = SPECIFICATION;
const formats = Object.fromEntries(SPECIFICATION.formats);

const on = (field, ...values) => (state) => values.includes(state[field]);
const all = (...conditions) => (state) => conditions.every((condition) => condition(state));

const record = on("excitation", "embedded", "file");
const plane = on("body", "plane");
const space = on("body", "space");
/** A block in space stands on feet, whatever was chosen for the plane. */
const supports = (state) => space(state) || state.foundation === "viscoelastic";
const rigid = all(plane, on("foundation", "rigid"));
const inStiffness = all(on("shape", "size"), on("supports", "stiffness"));
const inRatios = (state) => !inStiffness(state);
const gabor = all(on("excitation", "pulse"), on("pulse", "gabor"));
const hasVertical = all(record, on("vertical", "file"));
/** The second horizontal component is that of the visitor's own record. */
const mayHaveSecond = all(space, on("excitation", "file"));
const hasSecond = all(mayHaveSecond, on("record_y", "file"));

/** A unit as readers know it. */
const written = (unit) => unit.replaceAll(".", "·").replaceAll("2", "²");

/** A number of the engine, with its unit and its default. */
const number = (id, label, group, more = {}) =>
  ({ id, label, unit: written(units[id]), value: id in defaults ? String(defaults[id]) : "", group, ...more });

/** Options with the engine's words, in its order: each with its label. */
const labelled = (words, labels) => words.map((word) => [word, labels[word] ?? word]);

/** Formats that visitors know by another name than the engine's. */
const FORMATS = { smc: "USGS SMC", columns: "table (CSV)", esm: "ESM, AFAD", knet: "K-NET, KiK-net", nsmn: "NSMN (Turkey)" };

/** Settings for information missing from a file. A file of fixed width needs a layout, which has no field. */
const settings = (prefix, slot, when) => [
  { id: `${prefix}unit`, label: "Unit", kind: "choice", value: "", group: slot, when, options: [
    ["", "as the file says"], ...SPECIFICATION.units_of_records] },
  number("dt", "Time step", slot, { id: `${prefix}dt`, hint: "as the file says", when }),
  { id: `${prefix}format`, label: "Format", kind: "choice", value: "", group: slot, when, options: [
    ["", "by its content"], ...labelled(Object.keys(formats).filter((word) => word !== "fixed"), { ...formats, ...FORMATS })] },
  { id: `${prefix}channel`, label: "Channel", value: "", hint: "name or number", group: slot, when },
  { id: `${prefix}acceleration_column`, label: "Column of accelerations", value: "", hint: "name or number", group: slot, when },
  { id: `${prefix}time_column`, label: "Column of times", value: "", hint: "name or number", group: slot, when },
];

/** Labels of the numbers of ties and dampers, in the order of the fields; others follow under their names. */
const OF_LINKS = {
  block_x: "on the block, to the right of the middle", block_z: "on the block, above the base",
  ground_x: "on the ground, to the right", ground_z: "on the ground, above",
  stiffness: "stiffness", pretension: "pretension", slack: "slack", yield_force: "yields at, 0: elastic",
  hardening: "stiffness after yielding over before", damping: "damping", "damper.stiffness": "stiffness, 0: a dashpot", strength: "strength, 0: unbreakable",
};

/** A tie or a damper between a point of the block and one of the ground, with these numbers and otherwise zeros. */
const link = (kind, place, values, when) =>
  Object.keys({ ...OF_LINKS, ...links[kind] }).filter((key) => key in links[kind]).map((key) => ({
    id: `${kind}_${place}_${key}`,
    label: `${kind[0].toUpperCase()}${kind.slice(1)} ${place}: ${OF_LINKS[`${kind}.${key}`] ?? OF_LINKS[key] ?? key.replaceAll("_", " ")}`,
    unit: written(links[kind][key]), value: values[key] ?? "0", group: "tie", when }));

/** A tie, whose end on the ground is at `ground_x` (m) to the right. */
const tie = (place, ground_x, when) => link("tie", place, { block_z: "1.914", ground_x, stiffness: "10000" }, when);

/** A damper under the corner at `x` (m) to the right. */
const damper = (place, x, when) =>
  link("damper", place, { block_x: x, ground_x: x, ground_z: "-0.6", stiffness: "200000", yield_force: "1000", hardening: "0.02" }, when);

/** Labels of pulses. */
const PULSES = {
  "one-sine": "one sine (type A)", "one-cosine": "one cosine (type B)", c1: "type C1", c2: "type C2", "half-sine": "half sine",
  "symmetric-ricker": "symmetric Ricker wavelet", "antisymmetric-ricker": "antisymmetric Ricker wavelet", gabor: "Mavroeidis and Papageorgiou",
};

export const FIELDS = [
  { id: "body", label: "The block moves", kind: "segments", value: "plane", group: "block",
    options: [["plane", "in a plane"], ["space", "in space"]] },
  { id: "shape", label: "Describe the block by", kind: "segments", value: "size", group: "block",
    options: [["size", "width and height"], ["ratios", "α and p"]] },
  number("width", "Width", "block", { symbol: "2b", value: "0.348", slider: [0.1, 5, "log"], when: on("shape", "size") }),
  number("height", "Height", "block", { symbol: "2h", value: "1.914", slider: [0.3, 20, "log"], when: on("shape", "size"),
    title: "Twice the height of the centre of mass, unless that is given below" }),
  number("depth", "Depth", "block", { symbol: "2d", value: "0.58", slider: [0.1, 5, "log"], when: space, title: "Of the base, across the width" }),
  number("alpha", "Slenderness", "block", { symbol: "α", slider: [0.05, 0.6], when: on("shape", "ratios") }),
  number("p", "Frequency parameter", "block", { symbol: "p", slider: [0.3, 6, "log"], when: on("shape", "ratios"),
    title: "√(3g/4R) of a rectangle: larger for smaller blocks" }),

  { id: "foundation", label: "Stands on", kind: "segments", value: "viscoelastic", group: "foundation", when: plane,
    options: [["viscoelastic", "supports"], ["rigid", "rigid base"]] },
  { id: "preset", label: "Supports", kind: "choice", value: "", group: "foundation", when: all(supports, inRatios), preset: ["eta", "xi_v"],
    options: [["", "own values"], ["20,0.1", "soft: η = 20, ξᵥ = 0.1"], ["40,0.1", "of the paper: η = 40, ξᵥ = 0.1"],
      ["80,0.1", "stiff: η = 80, ξᵥ = 0.1"], ["60,0.4", "with dampers: η = 60, ξᵥ = 0.4"]] },
  { id: "supports", label: "Stiffness and damping as", kind: "segments", value: "ratios", group: "foundation",
    when: all(supports, on("shape", "size")), options: [["ratios", "η and ξᵥ"], ["stiffness", "K and C"]] },
  number("eta", "Stiffness ratio", "foundation", { symbol: "η", slider: [10, 300, "log"], when: all(supports, inRatios),
    title: "Vertical frequency of the block on its supports, over p" }),
  number("xi_v", "Damping ratio", "foundation", { symbol: "ξᵥ", slider: [0, 0.6], when: all(supports, inRatios) }),
  number("stiffness", "Stiffness of a support", "foundation", { symbol: "K", value: "6050000", slider: [1e4, 1e10, "log"], when: all(supports, inStiffness) }),
  number("damping", "Damping of a support", "foundation", { symbol: "C", value: "11000", slider: [1e2, 1e8, "log"], when: all(supports, inStiffness) }),
  number("kappa", "Horizontal over vertical stiffness", "foundation", { symbol: "κ", value: "1", slider: [0.1, 3, "log"], when: space }),
  number("epsilon", "Restitution of a corner", "foundation", { symbol: "ε", slider: [0, 1], when: plane }),
  number("restitution_factor", "Factor on Housner’s e", "foundation", { slider: [0.8, 1.1], when: rigid }),
  { id: "sliding", label: "The feet", kind: "segments", value: "none", group: "foundation",
    options: [["none", "do not slide"], ["friction", "slide with friction"]] },
  number("friction", "Friction", "foundation", { symbol: "μ", value: "0.4", slider: [0.01, 1, "log"], when: on("sliding", "friction") }),
  { id: "surfaces_friction", label: "Friction of", kind: "choice", value: "", group: "foundation", when: on("sliding", "friction"), surfaces: "friction", options: [["", "choose surfaces"]] },
  { id: "surfaces_restitution", label: "Restitution of", kind: "choice", value: "", group: "foundation", surfaces: "restitution_factor",
    when: rigid, options: [["", "choose surfaces"]] },

  number("eccentricity", "Eccentricity", "more", { symbol: "eₓ", slider: [-1, 1], title: "The centre of mass to the right of the middle" }),
  number("center_height", "Height of the centre of mass", "more", { hint: "half the height", when: on("shape", "size") }),
  number("inertia", "Moment of inertia", "more", { symbol: "I₀", hint: "from γ", when: all(plane, on("shape", "size")),
    title: "About the centre of mass" }),
  number("mass", "Mass", "more", { symbol: "M" }),
  number("gamma", "Shape factor", "more", { symbol: "γ", title: "M R₀²/I₀; 3 for a homogeneous rectangle",
    when: (state) => space(state) || state.shape !== "size" || state.inertia.trim() === "" }),
  number("g", "Gravity", "more", { symbol: "g" }),

  { id: "tie", label: "Tied to the ground", kind: "segments", value: "none", group: "tie", when: plane, options: [["none", "no"], ["one", "by one tie"], ["two", "by two"]] },
  ...tie(1, "2", all(plane, on("tie", "one", "two"))),
  ...tie(2, "-2", all(plane, on("tie", "two"))),
  { id: "damper", label: "Damped", kind: "segments", value: "none", group: "tie", when: plane, options: [["none", "no"], ["one", "by one damper"], ["two", "by two"]] },
  ...damper(1, "-0.174", all(plane, on("damper", "one", "two"))),
  ...damper(2, "0.174", all(plane, on("damper", "two"))),

  { id: "excitation", label: "Moved by", kind: "segments", value: "embedded", group: "ground",
    options: [["embedded", "Loma Prieta"], ["file", "own record"], ["pulse", "pulse"], ["release", "release"]] },
  { id: "record", slot: "record", label: "Accelerogram", kind: "file", group: "ground", when: on("excitation", "file") },
  { id: "record_y", label: "Second component, along y", kind: "segments", value: "none", group: "ground", when: mayHaveSecond,
    title: "The other horizontal component of the motion, with the step and the length of the first",
    options: [["none", "none"], ["file", "from a file"]] },
  { id: "record_y_file", slot: "record_y", errors: "record_y", label: "Accelerogram along y", kind: "file", group: "ground", when: hasSecond },
  { id: "scale", label: "Scale", unit: "1", value: "1", slider: [0.1, 10, "log"], group: "ground", when: record },
  { id: "pulse", label: "Shape of the pulse", kind: "choice", value: "one-sine", group: "ground", when: on("excitation", "pulse"),
    options: labelled(pulses.filter((word) => word !== "none"), PULSES) },
  number("amplitude", "Amplitude", "ground", { symbol: "aₚ", value: "4", slider: [0.2, 20, "log"], when: on("excitation", "pulse") }),
  number("period", "Period", "ground", { symbol: "Tₚ", value: "0.8", slider: [0.1, 5, "log"], when: on("excitation", "pulse") }),
  number("phase", "Phase", "ground", { symbol: "ν", value: "0", slider: [-3.14, 3.14], when: gabor }),
  number("cycles", "Duration in periods", "ground", { symbol: "γ", value: "2", slider: [1, 5], when: gabor }),
  { id: "tilt", label: "Tilt at release", symbol: "θ/α", unit: "1", value: "0.6", slider: [-0.99, 0.99], group: "ground", when: on("excitation", "release") },
  { id: "azimuth", label: "Direction from x towards y", symbol: "φ", unit: "°", value: "30", slider: [0, 360], group: "ground", when: space,
    title: "That of the record, which turns the second one with it, of the pulse or of the tilt, seen from above" },
  { id: "theta_dot", label: "Velocity at release", symbol: "θ̇", unit: "rad/s", value: "0", slider: [-2, 2], group: "ground", when: all(plane, on("excitation", "release")) },
  ...settings("", "file", on("excitation", "file")),
  { id: "vertical", label: "Vertical motion", kind: "segments", value: "none", group: "vertical", when: record,
    options: [["none", "none"], ["file", "from a file"]] },
  { id: "vertical_file", slot: "vertical", errors: "vertical", label: "Vertical accelerogram", kind: "file", group: "vertical", when: hasVertical },
  ...settings("vertical_", "vertical", hasVertical),

  { id: "on_separation", label: "When the block leaves the ground", kind: "segments", value: "fly", group: "run",
    options: [["fly", "it flies"], ["terminate", "end the run"]] },
  number("duration", "Duration", "run", { hint: "until it is decided" }),
  number("step", "Time between rows", "run", { hint: "the record's" }),
  number("tolerance", "Relative tolerance", "run"),

  number("p", "Smallest p (largest block)", "spectrum", { id: "p_min", value: "0.5" }),
  number("p", "Largest p (smallest block)", "spectrum", { id: "p_max", value: "8" }),
  { id: "points", label: "Number of sizes", value: "120", group: "spectrum" },
  { id: "also_rigid", label: "Compare with", kind: "choice", value: "yes", group: "spectrum", when: supports,
    options: [["yes", "rigid base"], ["no", "nothing"]] },

  { id: "scale_from", label: "Smallest factor", unit: "1", value: "0.5", group: "ensemble" },
  { id: "scale_to", label: "Largest factor", unit: "1", value: "3", group: "ensemble" },
  { id: "scale_count", label: "Number of factors", value: "24", group: "ensemble" },
  { id: "samples", label: "Runs per factor", value: "24", group: "ensemble" },
  { id: "spread", label: "Spread of the strength", unit: "1", value: "0.1", group: "ensemble", title: "Coefficient of variation" },
];

/** Fields whose values make up a state: not files, and not presets of other fields. */
export const STATE = FIELDS.filter((field) => field.kind !== "file" && !field.preset && !field.surfaces);

export const DEFAULTS = Object.fromEntries(STATE.map(({ id, value }) => [id, value]));

const inHash = (hash) => new URLSearchParams(hash.replace(/^#/, ""));

/** Names of files are kept in the address as a reminder. */
const isKnown = (id) => Object.hasOwn(DEFAULTS, id) || ["record_name", "record_y_name", "vertical_name"].includes(id);

/** The state in the address, with defaults for the rest. */
export function fromHash(hash) {
  const state = { ...DEFAULTS };
  const given = inHash(hash);
  for (const [id, value] of given) if (isKnown(id)) state[id] = value;
  // Links of earlier versions have no switch: a coefficient above 0 was the limit.
  if (!given.has("sliding") && Number(given.get("friction")) > 0) state.sliding = "friction";
  return state;
}

/** A message for each name in the address that is no field's. */
export function unknownIn(hash) {
  const names = [...inHash(hash).keys()].filter((id) => !isKnown(id));
  return names.map((id) => ({ field: "link", message: `found ${id.slice(0, 40)}; expected the name of a field, as eta` }));
}

/** The address of a state: only the values that differ from the defaults and are in use. */
export function toHash(state) {
  const parts = new URLSearchParams();
  for (const { id, when } of STATE) {
    if (state[id] !== DEFAULTS[id] && (!when || when(state))) parts.set(id, state[id]);
  }
  if (state.excitation === "file" && state.record_name) parts.set("record_name", state.record_name);
  if (hasSecond(state) && state.record_y_name) parts.set("record_y_name", state.record_y_name);
  if (state.vertical === "file" && state.vertical_name) parts.set("vertical_name", state.vertical_name);
  return parts.toString();
}
