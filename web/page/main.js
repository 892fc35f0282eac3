// The page: fields ↔ state ↔ address; state → run → drawing, plots, words; studies in the background.

import { Engine, study } from "./engine.js";
import { DEFAULTS, FIELDS, STATE, fromHash, toHash } from "./fields.js";
import { Histories, StudyPlot } from "./plots.js";
import { Scene } from "./scene.js";

const $ = (id) => document.getElementById(id);
const engine = new Engine();
const helpers = Array.from({ length: Math.min(4, Math.max(1, (navigator.hardwareConcurrency ?? 2) - 1)) }, () => new Engine());

let state = fromHash(location.hash);
let run = null;
const controls = new Map();

// ---------------------------------------------------------------- fields

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** Position of a slider (0 to 1000) ↔ value. */
const toPosition = ([least, most, scale], value) =>
  1000 * (scale === "log" ? Math.log(value / least) / Math.log(most / least) : (value - least) / (most - least));

function toValue([least, most, scale], position) {
  const part = position / 1000;
  const value = scale === "log" ? least * (most / least) ** part : least + part * (most - least);
  // Three digits, and no more than the slider resolves.
  const rounded = scale === "log" ? Number(value.toPrecision(3)) : Math.round(value / ((most - least) / 200)) * ((most - least) / 200);
  return String(Number(rounded.toPrecision(4)));
}

function makeField(field) {
  const { id, label, symbol, unit, kind, options, slider, title, hint } = field;
  const name = [label, symbol].filter(Boolean).join(" ");
  const heading = () => [element("b", { textContent: label }), element("span", { textContent: [symbol, unit && unit !== "1" ? `[${unit}]` : ""].filter(Boolean).join(" ") })];
  const error = element("p", { className: "error", id: `${id}-error`, hidden: true });
  const box = element("div", { className: "field", id: `field-${id}` });
  if (title) box.title = title;
  const control = { field, box, error, inputs: [] };
  if (kind === "segments") {
    const group = element("div", { className: "segments" });
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", label);
    for (const [value, text] of options) {
      const input = element("input", { type: "radio", name: id, value });
      input.addEventListener("change", () => change(id, value));
      group.append(element("label", {}, input, text));
      control.inputs.push(input);
    }
    box.append(element("div", { className: "label" }, ...heading()), group, error);
    control.show = (value) => control.inputs.forEach((input) => (input.checked = input.value === value));
  } else if (kind === "choice") {
    const select = element("select", { id });
    for (const [value, text] of options) select.append(element("option", { value, textContent: text }));
    select.addEventListener("change", () => change(id, select.value));
    box.append(element("label", { htmlFor: id }, ...heading()), select, error);
    control.inputs.push(select);
    control.show = (value) => (select.value = value);
  } else if (kind === "file") {
    const slot = id === "record" ? "record" : "vertical";
    const input = element("input", { type: "file", id, hidden: true });
    const text = element("span", { textContent: "Drop a file here: PEER AT2, SMC, CSV, COSMOS, CSMIP or ESM" });
    const button = element("button", { type: "button", textContent: "Choose a file", id: `${id}-choose` });
    button.setAttribute("aria-label", `Choose a file: ${label}`);
    button.addEventListener("click", () => input.click());
    input.addEventListener("change", () => input.files[0] && take(slot, input.files[0]));
    const drop = element("div", { className: "drop" }, text, element("div", { style: "margin-top:.5rem" }, button), input);
    box.append(element("div", { className: "label" }, ...heading()), drop, error);
    control.inputs.push(button);
    control.show = () => {
      const known = state[`${slot}_name`];
      if (known) text.replaceChildren(element("b", { textContent: known }), "drop another file to replace it");
    };
  } else {
    const input = element("input", { type: "text", id, inputMode: hint === "name or number" ? "text" : "decimal", spellcheck: false });
    if (hint) input.placeholder = hint;
    input.setAttribute("aria-describedby", `${id}-error`);
    input.addEventListener("input", () => change(id, input.value));
    control.inputs.push(input);
    const entry = element("div", { className: slider ? "entry" : "entry plain" });
    if (slider) {
      const range = element("input", { type: "range", min: 0, max: 1000, step: "any", tabIndex: 0 });
      range.setAttribute("aria-label", unit && unit !== "1" ? `${name}, slider` : `${name}, slider`);
      range.addEventListener("input", () => {
        input.value = toValue(slider, Number(range.value));
        range.setAttribute("aria-valuetext", `${input.value} ${unit === "1" ? "" : unit}`);
        change(id, input.value);
      });
      // Arrow keys move by a hundredth of the range.
      range.addEventListener("keydown", (event) => {
        const by = { ArrowRight: 10, ArrowUp: 10, ArrowLeft: -10, ArrowDown: -10, PageUp: 100, PageDown: -100 }[event.key];
        if (!by) return;
        event.preventDefault();
        range.value = Number(range.value) + by;
        range.dispatchEvent(new Event("input"));
      });
      entry.append(range);
      control.range = range;
    }
    entry.append(input);
    box.append(element("label", { htmlFor: id }, ...heading()), entry, error);
    control.show = (value) => {
      if (document.activeElement !== input || input.value !== value) input.value = value;
      const number = Number(value.replace(",", "."));
      if (slider && document.activeElement !== control.range && Number.isFinite(number)) {
        control.range.value = Math.min(1000, Math.max(0, toPosition(slider, number) || 0));
        control.range.setAttribute("aria-valuetext", `${value} ${unit === "1" ? "" : unit}`);
      }
    };
  }
  return control;
}

for (const field of FIELDS) {
  const control = makeField(field);
  controls.set(field.id, control);
  const group = $(`group-${field.group}`);
  (group.classList.contains("fields") ? group : group.querySelector(".fields")).append(control.box);
}

/** Shows the state in the fields, and only the fields that are in use. */
function showFields() {
  for (const [id, { field, box, show }] of controls) {
    box.hidden = Boolean(field.when && !field.when(state));
    if (field.surfaces) show(pairOf(field));
    else show(field.preset ? presetOf(state) : (state[id] ?? ""));
  }
  document.querySelectorAll("details[data-when]").forEach((details) => {
    const needed = details.dataset.when === "file" ? ["file"] : ["file", "embedded"];
    details.hidden = !needed.includes(state.excitation);
  });
}

const presetOf = ({ eta, xi_v }) => (FIELDS.find(({ id }) => id === "preset").options.some(([value]) => value === `${eta},${xi_v}`) ? `${eta},${xi_v}` : "");

/** Offers pairs of surfaces; a choice sets the middle of their values. */
function offerSurfaces(pairs) {
  for (const [id, { field, inputs: [select] }] of controls) {
    if (!field.surfaces) continue;
    for (const { surfaces, state: condition, low, high, kind, source } of pairs.filter(({ quantity }) => quantity === field.surfaces)) {
      const digits = (value) => String(Number(value.toPrecision(3)));
      const range = digits(low) === digits(high) ? digits(low) : `${digits(low)} to ${digits(high)}`;
      const value = String(Number(((low + high) / 2).toFixed(3)));
      const textContent = `${surfaces}${condition && `, ${condition}`}: ${range}${kind === "measured" ? "" : `, ${kind}`} (${source.name})`;
      select.append(element("option", { value: `${value}|${textContent}`, textContent }));
    }
    controls.get(id).box.title = "Sets the middle of the values";
  }
  showFields();
}

/** The pair last chosen, until its value is changed. */
const chosenPairs = {};
const pairOf = ({ surfaces }) => (chosenPairs[surfaces]?.startsWith(`${state[surfaces]}|`) ? chosenPairs[surfaces] : "");

function change(id, value) {
  const { surfaces } = controls.get(id).field;
  if (id === "preset") {
    if (value) [state.eta, state.xi_v] = value.split(",");
  } else if (surfaces) {
    chosenPairs[surfaces] = value;
    if (value) [state[surfaces]] = value.split("|");
  } else state[id] = value;
  showFields();
  remember();
  const { group } = controls.get(id).field;
  if (group === "spectrum" || group === "ensemble") return showErrors([], group);
  request();
}

let hashTimer = 0;
function remember() {
  clearTimeout(hashTimer);
  hashTimer = setTimeout(() => {
    const hash = toHash(state);
    history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
  }, 150);
}

/** Shows each message beside its field; one without a field beside the run. */
function showErrors(errors, scope = "run") {
  for (const [id, { field, error, inputs }] of controls) {
    const isStudy = field.group === "spectrum" || field.group === "ensemble";
    if (scope === "run" ? isStudy : field.group !== scope) continue;
    const found = errors.find(({ field: of }) => of === (field.errors ?? id) && (field.kind !== "segments" || !fileOf(of)));
    error.hidden = !found;
    error.textContent = found ? found.message : "";
    inputs.forEach((input) => (found ? input.setAttribute("aria-invalid", "true") : input.removeAttribute("aria-invalid")));
    if (found) for (let at = error.parentElement; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  }
  const shown = ({ field }) => [...controls.values()].some((control) => (control.field.errors ?? control.field.id) === field && !control.error.hidden);
  const rest = errors.filter((error) => !shown(error));
  const place = scope === "run" ? $("run-error") : document.querySelector(`#${scope} > .error`);
  place.hidden = rest.length === 0;
  place.textContent = rest.map(({ field, message }) => (field === "run" ? message : `${field}: ${message}`)).join(" · ");
}
const fileOf = (field) => field === "vertical" && state.vertical === "file";

// ---------------------------------------------------------------- files

async function take(slot, file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  state[`${slot}_name`] = file.name;
  if (slot === "record") state.excitation = "file";
  else state.vertical = "file";
  for (const one of [engine, ...helpers]) one.setFile(slot, file.name, bytes);
  showFields();
  remember();
  request();
}

for (const name of ["dragenter", "dragover"]) {
  addEventListener(name, (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    document.querySelectorAll(".drop").forEach((drop) => drop.classList.add("over"));
  });
}
for (const name of ["dragleave", "drop"]) {
  addEventListener(name, () => document.querySelectorAll(".drop").forEach((drop) => drop.classList.remove("over")));
}
addEventListener("drop", (event) => {
  const file = event.dataTransfer?.files[0];
  if (!file) return;
  event.preventDefault();
  take(event.target.closest?.("#field-vertical_file") ? "vertical" : "record", file);
});

// ---------------------------------------------------------------- the run

let running = false;
let again = false;

/** Asks for a run of the present state; while one is computed, only the last request is kept. */
async function request() {
  if (running) {
    again = true;
    return;
  }
  running = true;
  const begin = performance.now();
  const answer = await engine.call({ op: "run", fields: state });
  running = false;
  if (answer) receive(answer, begin);
  if (again) {
    again = false;
    request();
  }
}

function receive({ reply, buffer }, begin) {
  showErrors(reply.ok ? [] : reply.errors);
  document.body.classList.toggle("stale", !reply.ok && run !== null);
  $("stale").hidden = reply.ok || run === null;
  if (!reply.ok) {
    if (run === null) $("outcome").textContent = "No run yet: see the messages beside the fields.";
    return;
  }
  const all = new Float64Array(buffer);
  const series = Object.fromEntries(reply.series.map((name, i) => [name, all.subarray(i * reply.rows, (i + 1) * reply.rows)]));
  run = { ...reply, series };
  scene.setBlock(reply.block, reachOf(run));
  $("scene").setAttribute("aria-label", `The moving block. ${reply.sentence}`);
  histories.show(run);
  const { t } = series;
  const slider = $("time");
  [slider.min, slider.max] = [t[0], t[t.length - 1]];
  // The block is shown at its greatest tilt unless the motion is playing.
  if (!playing) setTime(clockTouched ? Math.min(time, t[t.length - 1]) : timeOfPeak(run));
  else setTime(Math.min(time, t[t.length - 1]));
  showOutcome(reply);
  // The plots are drawn after this function returns; the tests read these values.
  setTimeout(() => {
    const { dataset } = document.documentElement;
    dataset.latency = (performance.now() - begin).toFixed(1);
    dataset.runs = Number(dataset.runs ?? 0) + 1;
  });
}

/** Greatest horizontal distance of the block's corners from the middle of its base at rest (m). */
function reachOf({ series: { theta, u }, block: { b, h, height, eccentricity, ties } }) {
  let reach = ties.reduce((most, [, [x]]) => Math.max(most, Math.abs(x)), b);
  const above = Math.max(h, height - h);
  for (let i = 0; i < theta.length; i++) {
    const [s, c] = [Math.abs(Math.sin(theta[i])), Math.cos(theta[i])];
    reach = Math.max(reach, Math.abs(eccentricity + u[i]) + (b + Math.abs(eccentricity)) * Math.abs(c) + above * s);
  }
  return reach;
}

function timeOfPeak({ series: { t, theta } }) {
  let best = 0;
  for (let i = 1; i < theta.length; i++) if (Math.abs(theta[i]) > Math.abs(theta[best])) best = i;
  return t[best];
}

let announced = "";
let announceTimer = 0;

function showOutcome(reply) {
  $("verdict").className = `verdict ${reply.outcome}`;
  // A screen reader hears the last of a series of outcomes.
  clearTimeout(announceTimer);
  if (announced !== reply.sentence) {
    announceTimer = setTimeout(() => ($("outcome").textContent = announced = reply.sentence), announced ? 60 : 0);
  }
  $("warnings").replaceChildren(...reply.warnings.map((text) => element("li", { textContent: text })));
  const { peak, block } = reply;
  const rows = [
    ["Greatest tilt |θ|/α", peak.ratio],
    ["Greatest uplift of a corner", `${peak.uplift} mm`],
    ["Greatest vertical reaction", `${peak.reaction} M g`],
    ["Greatest horizontal reaction", `${peak.horizontal} M g`],
    ["Impacts, lift-offs", `${reply.impacts}, ${reply.liftoffs}`],
    ["Lifts off a rigid base beyond", `${block.lift_off} g`],
  ];
  rows.splice(4, 0, block.friction > 0 ? ["Greatest slip of the foot", `${peak.slip} mm`] : ["Friction demand |H|/N", Number(peak.friction_demand) > 10 ? "more than 10" : peak.friction_demand]);
  peak.tension.forEach((tension, i) => rows.push([`Greatest tension of tie ${i + 1}`, `${tension} N`]));
  const list = rows.flatMap(([name, value]) => [element("dt", { textContent: name }), element("dd", { textContent: value })]);
  list.push(element("dd", { className: "wide", textContent: `${reply.description}. ${block.line}` }));
  $("numbers").replaceChildren(...list);
  $("command").textContent = reply.command;
}

// ---------------------------------------------------------------- time

const scene = new Scene($("scene"));
const histories = new Histories($("plots"), (at) => {
  clockTouched = true;
  setTime(at);
});
let time = 0;
let playing = false;
let clockTouched = false;
let lastFrame = 0;

function setTime(value) {
  if (!run) return;
  const { t } = run.series;
  time = Math.min(Math.max(value, t[0]), t[t.length - 1]);
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  const part = t[high] > t[low] ? (time - t[low]) / (t[high] - t[low]) : 0;
  const at = (name) => run.series[name][low] + part * (run.series[name][high] - run.series[name][low]);
  scene.pose({ theta: at("theta"), u: at("u"), v: at("v"), uplift_L: at("uplift_L"), uplift_R: at("uplift_R"), a_gx: at("a_gx"),
    broken: run.broken.map((at) => at !== null && at <= time) });
  histories.setTime(time);
  $("time").value = time;
  $("time").setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
  $("clock").textContent = `${time.toFixed(2)} s`;
}

function frame(now) {
  if (!playing) return;
  const speed = Number($("speed").value);
  const end = run.series.t[run.series.t.length - 1];
  setTime(time + (Math.min(now - lastFrame, 100) / 1000) * speed);
  lastFrame = now;
  if (time >= end) return play(false);
  requestAnimationFrame(frame);
}

function play(on) {
  playing = on && run !== null;
  $("play").textContent = playing ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", String(playing));
  if (!playing) return;
  clockTouched = true;
  const { t } = run.series;
  if (time >= t[t.length - 1] - 1e-6 || !playedBefore) setTime(t[0]);
  playedBefore = true;
  lastFrame = performance.now();
  requestAnimationFrame(frame);
}
let playedBefore = false;

$("play").addEventListener("click", () => play(!playing));
$("time").addEventListener("input", () => {
  clockTouched = playedBefore = true;
  setTime(Number($("time").value));
});

// ---------------------------------------------------------------- exports

function save(name, type, content) {
  const link = element("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from files may lack the clipboard's permission.
    const area = document.body.appendChild(element("textarea", { value: text }));
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  $("copied").textContent = `${what} copied`;
  setTimeout(() => ($("copied").textContent = ""), 2500);
}

for (const [op, name, type] of [["csv", "history.csv", "text/csv"], ["svg", "history.svg", "image/svg+xml"]]) {
  $(`save-${op}`).addEventListener("click", async () => {
    const answer = await engine.call({ op });
    if (answer?.reply.ok) save(name, type, answer.buffer);
  });
}
$("copy-link").addEventListener("click", () => {
  const hash = toHash(state);
  copy(location.href.split("#")[0] + (hash ? `#${hash}` : ""), "link");
});
$("copy-command").addEventListener("click", () => copy($("command").textContent, "command"));
$("reset").addEventListener("click", () => {
  state = { ...DEFAULTS };
  clockTouched = playedBefore = false;
  play(false);
  showFields();
  remember();
  request();
});

// ---------------------------------------------------------------- studies

const studyPlots = [];

function setUpStudy(name, plotOf, rowsOf) {
  const root = $(name);
  const part = (selector) => root.querySelector(selector);
  let stop = null;
  let result = null;
  part(".cancel").addEventListener("click", () => stop?.abort());
  part(".start").addEventListener("click", async () => {
    stop = new AbortController();
    result = null;
    const begin = performance.now();
    let plot = null;
    let due = 0;
    showErrors([], name);
    part(".start").disabled = true;
    part(".cancel").hidden = part("progress").hidden = false;
    part("progress").value = 0;
    part(".after").hidden = true;
    part(".state").textContent = "";
    try {
      const fields = { ...state };
      const piece = (prepared, from, rows) => {
        plot ??= plotOf(part(".plot"), prepared, fields);
        rowsOf(plot, prepared, from, rows);
        if (performance.now() > due) {
          plot.draw();
          due = performance.now() + 100;
        }
      };
      const progress = (done, rows) => (part("progress").value = done / rows);
      const made = await study(helpers, { op: name, fields }, stop.signal, piece, progress);
      plot?.draw();
      if (!made.errors) {
        if (plot) studyPlots.push(plot);
        const seconds = ((performance.now() - begin) / 1000).toFixed(1);
        part(".state").textContent = made.complete ? `${made.rows} rows in ${seconds} s` : "cancelled";
        part(".after").hidden = !made.complete;
        part("pre").textContent = made.command;
        result = made.complete ? made : null;
      } else {
        showErrors(made.errors, name);
        part(".state").textContent = "not started";
      }
    } catch (error) {
      part(".state").textContent = `stopped: ${error.message}`;
    }
    part(".start").disabled = false;
    part(".cancel").hidden = part("progress").hidden = true;
  });
  part(".save").addEventListener("click", () => result && save(`${name}.csv`, "text/csv", result.table));
  part(".save-study")?.addEventListener("click", () => result && save("study.toml", "application/toml", result.file));
}

setUpStudy(
  "spectrum",
  (root, { p, bases, omega_p }) => {
    const x = omega_p ? p.map((value) => omega_p / value) : p.map((value) => (2 * Math.PI) / value);
    const names = bases.map((base) => (base === "rigid" ? "rigid base" : base.startsWith("rigid") ? "rigid base" : "supports"));
    const colours = ["--left", "--right"];
    const marks = { width: 0, points: { show: true, size: 5, fill: undefined }, value: () => "" };
    return new StudyPlot(root, {
      xLabel: omega_p ? "ωₚ/p" : "2π/p (s): larger blocks to the right",
      yLabel: "peak |θ|/α",
      series: [
        ...names.map((name, i) => [`|θ|/α, ${name}`, colours[i]]),
        ...names.map((name, i) => [`overturned, ${name}`, colours[i], { ...marks, paths: () => null }]),
      ],
      x,
      range: [0, 1.35],
      alarm: [1],
      aria: "Peak rotation over the size of the block; marks above the line show the blocks that overturn",
    });
  },
  (plot, { p, bases, columns }, from, rows) => {
    const [outcome, peak] = ["outcome", "peak.theta/alpha [1]"].map((name) => columns.indexOf(name));
    rows.forEach((fields, i) => {
      const [base, size] = [Math.floor((from + i) / p.length), (from + i) % p.length];
      const fell = fields[outcome] === "overturned";
      plot.set(base, size, fell || fields[outcome] === "failed" ? null : Math.min(Number(fields[peak]), 1.1));
      plot.set(bases.length + base, size, fell ? 1.2 + 0.08 * base : null);
    });
  },
);

setUpStudy(
  "ensemble",
  (root, { strengths }, { excitation }) =>
    new StudyPlot(root, {
      xLabel: excitation === "pulse" ? "amplitude aₚ (m/s²)" : "scale of the record",
      yLabel: "probability",
      series: [["overturned", "--left", { points: { show: true, size: 5 } }]],
      x: strengths[0] < strengths[strengths.length - 1] ? strengths : [...strengths].reverse(),
      range: [0, 1.04],
      alarm: [],
      aria: "Probability of overturning over the strength of the ground motion",
    }),
  (plot, { columns, strengths }, from, rows) => {
    const column = columns.indexOf("P(overturned) [1]");
    const falls = strengths[0] > strengths[strengths.length - 1];
    rows.forEach((fields, i) => {
      const row = falls ? strengths.length - 1 - from - i : from + i;
      plot.set(0, row, fields[column] === "" ? null : Number(fields[column]));
    });
  },
);

// ---------------------------------------------------------------- start

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  histories.redraw();
  studyPlots.forEach((plot) => plot.redraw());
});
addEventListener("hashchange", () => {
  state = fromHash(location.hash);
  showFields();
  request();
});
addEventListener("keydown", (event) => {
  if (event.target.matches?.("input, select, button, summary, textarea, pre")) return;
  if (event.key === " ") {
    event.preventDefault();
    play(!playing);
  }
});
$("controls").addEventListener("submit", (event) => event.preventDefault());
$("version").textContent = VERSION;
showFields();
request();
engine.call({ op: "surfaces" }).then((answer) => answer && offerSurfaces(answer.reply.pairs));
