// The page: fields ↔ state ↔ address; state → run → drawing, plots, words; studies in the background.

import { makeControl } from "./controls.js";
import { $, element, say } from "./dom.js";
import { Engine } from "./engine.js";
import { copy, setUpSaving } from "./exports.js";
import { DEFAULTS, FIELDS, fromHash, toHash, unknownIn } from "./fields.js";
import { slotsOf, watchDrops } from "./files.js";
import { Player } from "./player.js";
import { Histories } from "./plots.js";
import { Scene } from "./scene.js";
import { SceneInSpace } from "./scene_in_space.js";
import { setUpStudies } from "./studies.js";
import { showOutcome } from "./summary.js";

const engine = new Engine();
const helpers = Array.from({ length: Math.min(4, Math.max(1, (navigator.hardwareConcurrency ?? 2) - 1)) }, () => new Engine());

let state = fromHash(location.hash);
/** Faults of the address, until the user changes a field. */
let faults = unknownIn(location.hash);
let run = null;

// ---------------------------------------------------------------- fields

const controls = new Map(FIELDS.map((field) => [field.id, makeControl(field, { change, take })]));
for (const { field, box } of controls.values()) {
  const group = $(`group-${field.group}`);
  (group.classList.contains("fields") ? group : group.querySelector(".fields")).append(box);
}

/** Shows the state in the fields, and only the fields that are in use. */
function showFields() {
  for (const { field, box, show } of controls.values()) {
    box.hidden = Boolean(field.when && !field.when(state));
    show(valueOf(field));
  }
  const needed = { plane: state.body === "plane", file: state.excitation === "file", record: ["file", "embedded"].includes(state.excitation) };
  document.querySelectorAll("[data-when]").forEach((part) => (part.hidden = !needed[part.dataset.when]));
  $("plots").hidden = !needed.plane;
  $("pictures").hidden = needed.plane;
}

function valueOf({ id, slot, surfaces, preset, options }) {
  if (slot) return state[`${slot}_name`];
  if (surfaces) return chosenPairs[surfaces]?.startsWith(`${state[surfaces]}|`) ? chosenPairs[surfaces] : "";
  const pair = preset?.map((name) => state[name]).join();
  if (preset) return options.some(([value]) => value === pair) ? pair : "";
  return state[id] ?? "";
}

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

function change(id, value) {
  const { surfaces, preset, group } = controls.get(id).field;
  if (preset) {
    if (value) value.split(",").forEach((part, i) => (state[preset[i]] = part));
  } else if (surfaces) {
    chosenPairs[surfaces] = value;
    if (value) [state[surfaces]] = value.split("|");
  } else state[id] = value;
  if (group === "spectrum" || group === "ensemble") {
    showFields();
    remember();
    showErrors([], group);
  } else adopt();
}

/** Shows the state after a change, and asks for its run. */
function adopt() {
  faults = [];
  say($("file-error"), "");
  showFields();
  remember();
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

const isStudy = ({ group }) => group === "spectrum" || group === "ensemble";

/** Shows each message beside its field; one without a field in use beside the run. */
function showErrors(errors, scope = "run") {
  const rest = new Set(errors);
  for (const [id, { field, box, error, inputs }] of controls) {
    if (scope === "run" ? isStudy(field) : field.group !== scope) continue;
    const isOf = ({ field: of }) => of === (field.errors ?? id) && !(field.kind === "segments" && of === id && state[id] === "file");
    const [found, ...others] = box.hidden ? [] : errors.filter(isOf);
    [found, ...others].forEach((error) => rest.delete(error));
    say(error, found?.message ?? "");
    inputs.forEach((input) => (found ? input.setAttribute("aria-invalid", "true") : input.removeAttribute("aria-invalid")));
    if (found) for (let at = error.parentElement; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  }
  const place = scope === "run" ? $("run-error") : document.querySelector(`#${scope} > .error`);
  say(place, [...rest].map(({ field, message }) => (field === "run" ? message : `${field}: ${message}`)).join(" · "));
}

// ---------------------------------------------------------------- files

function refuseFiles(message) {
  say($("file-error"), message);
  $("file-error").scrollIntoView({ block: "nearest" });
}

/** Takes files for the slot on whose field they were dropped, or for those that their names tell. */
async function take(files, on) {
  if (files.length === 0) return;
  const { slots, message } = slotsOf(files.map(({ name }) => name), on, state.body === "space");
  if (message) return refuseFiles(message);
  let contents;
  try {
    contents = await Promise.all(files.map(async (file) => new Uint8Array(await file.arrayBuffer())));
  } catch (error) {
    return refuseFiles(`${files.map(({ name }) => name).join(", ")} cannot be read: ${error.message}`);
  }
  files.forEach(({ name }, i) => {
    const slot = slots[i];
    state[`${slot}_name`] = name;
    if (slot === "record") state.excitation = "file";
    else state[slot] = "file";
    for (const one of [engine, ...helpers]) one.setFile(slot, name, contents[i]);
  });
  adopt();
}

watchDrops(take, refuseFiles);

// ---------------------------------------------------------------- the run

let running = false;
let again = false;
/** Number of runs so far, by which exports name the one that is shown. */
let number = 0;

/** Asks for a run of the present state; while one is computed, only the last request is kept. */
async function request() {
  again = true;
  if (running) return;
  running = true;
  $("result").setAttribute("aria-busy", "true");
  try {
    while (again) {
      again = false;
      const begin = performance.now();
      if (faults.length) receive({ reply: { ok: false, errors: faults } });
      else receive(await engine.call({ op: "run", number: ++number, fields: state }), begin);
    }
  } finally {
    running = false;
    // After the plots are drawn, as in `receive`.
    setTimeout(() => running || $("result").removeAttribute("aria-busy"));
  }
}

function receive({ reply, buffer }, begin) {
  const errors = reply.ok ? faultsOfShowing(reply, buffer) : reply.errors;
  showErrors(errors);
  const isStale = errors.length > 0 && run !== null;
  document.body.classList.toggle("stale", isStale);
  $("stale").hidden = !isStale;
  if (errors.length > 0) {
    const [{ field, message }] = errors;
    const why = field === "run" || field === "link" ? message : "see the messages beside the fields";
    if (run === null) $("outcome").textContent = `No run yet: ${why}.`;
    return;
  }
  // The plots are drawn after this function returns; the tests read these values.
  setTimeout(() => {
    const { dataset } = document.documentElement;
    dataset.latency = (performance.now() - begin).toFixed(1);
    dataset.runs = Number(dataset.runs ?? 0) + 1;
  });
}

/** Shows a run, or the last one again if that fails. */
function faultsOfShowing(reply, buffer) {
  try {
    const all = new Float64Array(buffer);
    const series = Object.fromEntries(reply.series.map((name, i) => [name, all.subarray(i * reply.rows, (i + 1) * reply.rows)]));
    const made = { ...reply, series };
    try {
      draw(made);
      run = made;
    } catch (error) {
      if (run !== null) draw(run);
      throw error;
    }
    return [];
  } catch (error) {
    return [{ field: "run", message: `this run cannot be shown: ${error.message}` }];
  }
}

function draw(run) {
  if (run.in_space) return drawInSpace(run);
  scene.setBlock(run.block, reachOf(run));
  player.scene = scene;
  $("scene").setAttribute("aria-label", `The moving block. ${run.sentence}`);
  player.histories.show(run);
  player.show(run);
  showOutcome(run);
}

/** Shows a run in space; its pictures are those of the engine. */
function drawInSpace(run) {
  sceneInSpace.setBlock(run);
  player.scene = sceneInSpace;
  $("scene").setAttribute("aria-label", `The moving block. ${run.sentence}`);
  player.show(run);
  showOutcome(run);
  showPictures(run);
}

/** Shows the pictures of a run, unless another took its place meanwhile. */
async function showPictures(run) {
  const shown = [];
  for (const [plan, alt] of [[false, "Tilt, twist, forces, contacts and slip of the feet over time"], [true, "Paths of the base and of the centre of mass, seen from above"]]) {
    const { reply, buffer } = await engine.call({ op: "svg", run: run.number, plan });
    if (!reply.ok) return;
    const src = URL.createObjectURL(new Blob([buffer], { type: "image/svg+xml" }));
    shown.push(element("img", { src, alt, onload: () => URL.revokeObjectURL(src) }));
  }
  $("pictures").replaceChildren(...shown);
}

/** Greatest horizontal distance of the block's corners from the middle of its base at rest (m). */
function reachOf({ series: { theta, u }, block: { b, h, height, eccentricity, links } }) {
  let reach = links.reduce((most, { ground: [x] }) => Math.max(most, Math.abs(x)), b);
  const above = Math.max(h, height - h);
  for (let i = 0; i < theta.length; i++) {
    const [s, c] = [Math.abs(Math.sin(theta[i])), Math.cos(theta[i])];
    reach = Math.max(reach, Math.abs(eccentricity + u[i]) + (b + Math.abs(eccentricity)) * Math.abs(c) + above * s);
  }
  return reach;
}

const scene = new Scene($("scene"));
const sceneInSpace = new SceneInSpace($("scene"));
const player = new Player(scene, new Histories($("plots"), (time) => player.seek(time)));

// ---------------------------------------------------------------- start

setUpSaving(engine, () => run, request);
const studies = setUpStudies(helpers, () => state, showErrors);

$("copy-link").addEventListener("click", () => {
  const hash = toHash(state);
  copy(location.href.split("#")[0] + (hash ? `#${hash}` : ""), "link");
});
$("copy-command").addEventListener("click", () => copy($("command").textContent, "command"));
$("reset").addEventListener("click", () => {
  state = { ...DEFAULTS };
  player.reset();
  adopt();
});
// The address is that of the state: a link to a part of the page would replace it.
document.querySelector(".skip").addEventListener("click", (event) => {
  event.preventDefault();
  $("result").focus();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => [player.histories, ...studies].forEach((plot) => plot.redraw()));
addEventListener("hashchange", () => {
  state = fromHash(location.hash);
  faults = unknownIn(location.hash);
  showFields();
  request();
});
addEventListener("keydown", (event) => {
  if (event.key !== " " || event.target.matches?.("input, select, button, summary, textarea, pre")) return;
  event.preventDefault();
  player.toggle();
});
$("controls").addEventListener("submit", (event) => event.preventDefault());
$("version").textContent = VERSION;
showFields();
request();
engine.call({ op: "surfaces" }).then(({ reply }) => reply.ok && offerSurfaces(reply.pairs));
