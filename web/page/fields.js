// The input fields: names, labels, units, ranges of their sliders, and when they are shown.

const on = (field, ...values) => (state) => values.includes(state[field]);
const all = (...conditions) => (state) => conditions.every((condition) => condition(state));

const record = on("excitation", "embedded", "file");
const supports = on("foundation", "viscoelastic");
const inStiffness = all(on("shape", "size"), on("supports", "stiffness"));
const inRatios = (state) => !inStiffness(state);
const gabor = all(on("excitation", "pulse"), on("pulse", "gabor"));
const hasVertical = all(record, on("vertical", "file"));

/** Settings for information missing from a file. */
const settings = (prefix, slot, when) => [
  { id: `${prefix}unit`, label: "Unit", kind: "choice", value: "", group: slot, when, options: [
    ["", "as the file says"], ["g", "g"], ["m/s2", "m/s²"], ["cm/s2", "cm/s²"]] },
  { id: `${prefix}dt`, label: "Time step", unit: "s", value: "", hint: "as the file says", group: slot, when },
  { id: `${prefix}format`, label: "Format", kind: "choice", value: "", group: slot, when, options: [
    ["", "by its content"], ["peer", "PEER AT2"], ["smc", "USGS SMC"], ["columns", "table (CSV)"], ["cosmos", "COSMOS"],
    ["csmip", "CSMIP"], ["esm", "ESM, AFAD"], ["knet", "K-NET, KiK-net"], ["geonet", "GeoNet"], ["nsmn", "NSMN (Turkey)"],
    ["unam", "UNAM"], ["renadic", "RENADIC"], ["bhrc", "BHRC"], ["usc", "USC"], ["jma", "JMA"], ["cwb", "CWB"]] },
  { id: `${prefix}channel`, label: "Channel", value: "", hint: "name or number", group: slot, when },
  { id: `${prefix}acceleration_column`, label: "Column of accelerations", value: "", hint: "name or number", group: slot, when },
  { id: `${prefix}time_column`, label: "Column of times", value: "", hint: "name or number", group: slot, when },
];

/** A tie or a damper between a point of the block and one of the ground (m). */
const link = (kind, number, [block_x, block_z], [ground_x, ground_z], more, when) =>
  [
    ["block_x", "on the block, to the right of the middle", "m", block_x], ["block_z", "on the block, above the base", "m", block_z],
    ["ground_x", "on the ground, to the right", "m", ground_x], ["ground_z", "on the ground, above", "m", ground_z],
    ...more, ["damping", "damping", "N·s/m", "0"], ["strength", "strength, 0: unbreakable", "N", "0"],
  ].map(([key, label, unit, value]) => ({ id: `${kind}_${number}_${key}`, label: `${kind[0].toUpperCase()}${kind.slice(1)} ${number}: ${label}`, unit, value,
    group: "tie", when }));

/** A tie, whose end on the ground is at `ground_x` (m) to the right. */
const tie = (number, ground_x, when) => link("tie", number, ["0", "2.4"], [ground_x, "0"], [
  ["stiffness", "stiffness", "N/m", "10000"], ["pretension", "pretension", "N", "0"], ["slack", "slack", "m", "0"],
  ["yield_force", "yields at, 0: elastic", "N", "0"], ["hardening", "stiffness after yielding over before", "1", "0"]], when);

/** A damper under the corner at `x` (m) to the right. */
const damper = (number, x, when) => link("damper", number, [x, "0"], [x, "-0.6"], [
  ["stiffness", "stiffness", "N/m", "200000"], ["yield_force", "yields at, 0: elastic", "N", "1000"],
  ["hardening", "stiffness after yielding over before", "1", "0.02"]], when);

export const FIELDS = [
  { id: "shape", label: "Describe the block by", kind: "segments", value: "size", group: "block",
    options: [["size", "width and height"], ["ratios", "α and p"]] },
  { id: "width", label: "Width", symbol: "2b", unit: "m", value: "0.6", slider: [0.1, 5, "log"], group: "block", when: on("shape", "size") },
  { id: "height", label: "Height", symbol: "2h", unit: "m", value: "2.4", slider: [0.3, 20, "log"], group: "block", when: on("shape", "size"),
    title: "Twice the height of the centre of mass, unless that is given below" },
  { id: "alpha", label: "Slenderness", symbol: "α", unit: "rad", value: "0.25", slider: [0.05, 0.6], group: "block", when: on("shape", "ratios") },
  { id: "p", label: "Frequency parameter", symbol: "p", unit: "rad/s", value: "1", slider: [0.3, 6, "log"], group: "block", when: on("shape", "ratios"),
    title: "√(3g/4R) of a rectangle: larger for smaller blocks" },

  { id: "foundation", label: "Stands on", kind: "segments", value: "viscoelastic", group: "foundation",
    options: [["viscoelastic", "supports"], ["rigid", "rigid base"]] },
  { id: "preset", label: "Supports", kind: "choice", value: "", group: "foundation", when: all(supports, inRatios), preset: ["eta", "xi_v"],
    options: [["", "own values"], ["20,0.1", "soft: η = 20, ξᵥ = 0.1"], ["40,0.1", "of the paper: η = 40, ξᵥ = 0.1"],
      ["80,0.1", "stiff: η = 80, ξᵥ = 0.1"], ["60,0.4", "with dampers: η = 60, ξᵥ = 0.4"]] },
  { id: "supports", label: "Stiffness and damping as", kind: "segments", value: "ratios", group: "foundation",
    when: all(supports, on("shape", "size")), options: [["ratios", "η and ξᵥ"], ["stiffness", "K and C"]] },
  { id: "eta", label: "Stiffness ratio", symbol: "η", unit: "1", value: "40", slider: [10, 300, "log"], group: "foundation", when: all(supports, inRatios),
    title: "Vertical frequency of the block on its supports, over p" },
  { id: "xi_v", label: "Damping ratio", symbol: "ξᵥ", unit: "1", value: "0.1", slider: [0, 0.6], group: "foundation", when: all(supports, inRatios) },
  { id: "stiffness", label: "Stiffness of a support", symbol: "K", unit: "N/m", value: "1000000", slider: [1e4, 1e10, "log"], group: "foundation", when: all(supports, inStiffness) },
  { id: "damping", label: "Damping of a support", symbol: "C", unit: "N·s/m", value: "4000", slider: [1e2, 1e8, "log"], group: "foundation", when: all(supports, inStiffness) },
  { id: "epsilon", label: "Restitution of a corner", symbol: "ε", unit: "1", value: "0", slider: [0, 1], group: "foundation" },
  { id: "restitution_factor", label: "Factor on Housner’s e", unit: "1", value: "1", slider: [0.8, 1.1], group: "foundation", when: on("foundation", "rigid") },
  { id: "sliding", label: "The feet", kind: "segments", value: "none", group: "foundation",
    options: [["none", "do not slide"], ["friction", "slide with friction"]] },
  { id: "friction", label: "Friction", symbol: "μ", unit: "1", value: "0.4", slider: [0.01, 1, "log"], group: "foundation", when: on("sliding", "friction") },
  { id: "surfaces_friction", label: "Friction of", kind: "choice", value: "", group: "foundation", when: on("sliding", "friction"), surfaces: "friction", options: [["", "choose surfaces"]] },
  { id: "surfaces_restitution", label: "Restitution of", kind: "choice", value: "", group: "foundation", surfaces: "restitution_factor",
    when: on("foundation", "rigid"), options: [["", "choose surfaces"]] },

  { id: "eccentricity", label: "Eccentricity", symbol: "eₓ", unit: "m", value: "0", slider: [-1, 1], group: "more", title: "The centre of mass to the right of the middle" },
  { id: "center_height", label: "Height of the centre of mass", unit: "m", value: "", hint: "half the height", group: "more", when: on("shape", "size") },
  { id: "inertia", label: "Moment of inertia", symbol: "I₀", unit: "kg·m²", value: "", hint: "from γ", group: "more", when: on("shape", "size"),
    title: "About the centre of mass" },
  { id: "mass", label: "Mass", symbol: "M", unit: "kg", value: "1000", group: "more" },
  { id: "gamma", label: "Shape factor", symbol: "γ", unit: "1", value: "3", group: "more", title: "M R₀²/I₀; 3 for a homogeneous rectangle",
    when: (state) => state.shape !== "size" || state.inertia.trim() === "" },
  { id: "g", label: "Gravity", symbol: "g", unit: "m/s²", value: "9.81", group: "more" },

  { id: "tie", label: "Tied to the ground", kind: "segments", value: "none", group: "tie", options: [["none", "no"], ["one", "by one tie"], ["two", "by two"]] },
  ...tie(1, "3", on("tie", "one", "two")),
  ...tie(2, "-3", on("tie", "two")),
  { id: "damper", label: "Damped", kind: "segments", value: "none", group: "tie", options: [["none", "no"], ["one", "by one damper"], ["two", "by two"]] },
  ...damper(1, "-0.3", on("damper", "one", "two")),
  ...damper(2, "0.3", on("damper", "two")),

  { id: "excitation", label: "Moved by", kind: "segments", value: "embedded", group: "ground",
    options: [["embedded", "Loma Prieta"], ["file", "own record"], ["pulse", "pulse"], ["release", "release"]] },
  { id: "record", slot: "record", label: "Accelerogram", kind: "file", group: "ground", when: on("excitation", "file") },
  { id: "scale", label: "Scale", unit: "1", value: "2", slider: [0.1, 10, "log"], group: "ground", when: record },
  { id: "pulse", label: "Shape of the pulse", kind: "choice", value: "one-sine", group: "ground", when: on("excitation", "pulse"),
    options: [["one-sine", "one sine (type A)"], ["one-cosine", "one cosine (type B)"], ["c1", "type C1"], ["c2", "type C2"], ["half-sine", "half sine"],
      ["rectangular", "rectangular"], ["symmetric-ricker", "symmetric Ricker wavelet"], ["antisymmetric-ricker", "antisymmetric Ricker wavelet"],
      ["gabor", "Mavroeidis and Papageorgiou"]] },
  { id: "amplitude", label: "Amplitude", symbol: "aₚ", unit: "m/s²", value: "4", slider: [0.2, 20, "log"], group: "ground", when: on("excitation", "pulse") },
  { id: "period", label: "Period", symbol: "Tₚ", unit: "s", value: "0.8", slider: [0.1, 5, "log"], group: "ground", when: on("excitation", "pulse") },
  { id: "phase", label: "Phase", symbol: "ν", unit: "rad", value: "0", slider: [-3.14, 3.14], group: "ground", when: gabor },
  { id: "cycles", label: "Duration in periods", symbol: "γ", unit: "1", value: "2", slider: [1, 5], group: "ground", when: gabor },
  { id: "tilt", label: "Tilt at release", symbol: "θ/α", unit: "1", value: "0.6", slider: [-0.99, 0.99], group: "ground", when: on("excitation", "release") },
  { id: "theta_dot", label: "Velocity at release", symbol: "θ̇", unit: "rad/s", value: "0", slider: [-2, 2], group: "ground", when: on("excitation", "release") },
  ...settings("", "file", on("excitation", "file")),
  { id: "vertical", label: "Vertical motion", kind: "segments", value: "none", group: "vertical", when: record,
    options: [["none", "none"], ["file", "from a file"]] },
  { id: "vertical_file", slot: "vertical", errors: "vertical", label: "Vertical accelerogram", kind: "file", group: "vertical", when: hasVertical },
  ...settings("vertical_", "vertical", hasVertical),

  { id: "on_separation", label: "When the block leaves the ground", kind: "segments", value: "fly", group: "run",
    options: [["fly", "it flies"], ["terminate", "end the run"]] },
  { id: "duration", label: "Duration", unit: "s", value: "", hint: "until it is decided", group: "run" },
  { id: "step", label: "Time between rows", unit: "s", value: "", hint: "the record's", group: "run" },
  { id: "tolerance", label: "Relative tolerance", unit: "1", value: "1e-8", group: "run" },

  { id: "p_min", label: "Smallest p (largest block)", unit: "rad/s", value: "0.5", group: "spectrum" },
  { id: "p_max", label: "Largest p (smallest block)", unit: "rad/s", value: "8", group: "spectrum" },
  { id: "points", label: "Number of sizes", value: "120", group: "spectrum" },
  { id: "also_rigid", label: "Compare with", kind: "choice", value: "yes", group: "spectrum", when: supports,
    options: [["yes", "rigid base"], ["no", "nothing"]] },

  { id: "scale_from", label: "Smallest factor", unit: "1", value: "0.5", group: "ensemble" },
  { id: "scale_to", label: "Largest factor", unit: "1", value: "6", group: "ensemble" },
  { id: "scale_count", label: "Number of factors", value: "24", group: "ensemble" },
  { id: "samples", label: "Runs per factor", value: "24", group: "ensemble" },
  { id: "spread", label: "Spread of the strength", unit: "1", value: "0.1", group: "ensemble", title: "Coefficient of variation" },
];

/** Fields whose values make up a state: not files, and not presets of other fields. */
export const STATE = FIELDS.filter((field) => field.kind !== "file" && !field.preset && !field.surfaces);

export const DEFAULTS = Object.fromEntries(STATE.map(({ id, value }) => [id, value]));

const inHash = (hash) => new URLSearchParams(hash.replace(/^#/, ""));

/** Names of files are kept in the address as a reminder. */
const isKnown = (id) => Object.hasOwn(DEFAULTS, id) || id === "record_name" || id === "vertical_name";

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
  if (state.vertical === "file" && state.vertical_name) parts.set("vertical_name", state.vertical_name);
  return parts.toString();
}
