// A field → its control: label, inputs, slider and message.

import { element } from "./dom.js";

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

function heading({ label, symbol, unit }) {
  const details = [symbol, unit && unit !== "1" ? `[${unit}]` : ""].filter(Boolean).join(" ");
  return [element("b", { textContent: label }), element("span", { textContent: details })];
}

function segments({ field, box, error, inputs }, { change }) {
  const { id, label, options } = field;
  const group = element("div", { className: "segments" });
  group.setAttribute("role", "radiogroup");
  group.setAttribute("aria-label", label);
  for (const [value, text] of options) {
    const input = element("input", { type: "radio", name: id, value });
    input.addEventListener("change", () => change(id, value));
    group.append(element("label", {}, input, text));
    inputs.push(input);
  }
  box.append(element("div", { className: "label" }, ...heading(field)), group, error);
  return (value) => inputs.forEach((input) => (input.checked = input.value === value));
}

function choice({ field, box, error, inputs }, { change }) {
  const { id, options } = field;
  const select = element("select", { id });
  for (const [value, text] of options) select.append(element("option", { value, textContent: text }));
  select.addEventListener("change", () => change(id, select.value));
  box.append(element("label", { htmlFor: id }, ...heading(field)), select, error);
  inputs.push(select);
  return (value) => (select.value = value);
}

function file({ field, box, error, inputs }, { take }) {
  const { id, label, slot } = field;
  const input = element("input", { type: "file", id, hidden: true });
  const text = element("span", { textContent: "Drop a file here: PEER, SMC, CSV, COSMOS, CSMIP, ESM, K-NET and others" });
  const button = element("button", { type: "button", textContent: "Choose a file", id: `${id}-choose` });
  button.setAttribute("aria-label", `Choose a file: ${label}`);
  button.addEventListener("click", () => input.click());
  input.addEventListener("change", () => {
    take([...input.files], slot);
    // The same file may be chosen again.
    input.value = "";
  });
  const drop = element("div", { className: "drop" }, text, element("div", { style: "margin-top:.5rem" }, button), input);
  box.append(element("div", { className: "label" }, ...heading(field)), drop, error);
  inputs.push(button);
  return (name) => name && text.replaceChildren(element("b", { textContent: name }), "drop another file to replace it");
}

/** A slider that writes into `input`. */
function sliderOf({ label, symbol, unit, slider }, input, changed) {
  const range = element("input", { type: "range", min: 0, max: 1000, step: "any", tabIndex: 0 });
  range.setAttribute("aria-label", `${[label, symbol].filter(Boolean).join(" ")}, slider`);
  const speak = (value) => range.setAttribute("aria-valuetext", `${value} ${unit === "1" ? "" : unit}`);
  range.addEventListener("input", () => {
    input.value = toValue(slider, Number(range.value));
    speak(input.value);
    changed();
  });
  // Arrow keys move by a hundredth of the range.
  range.addEventListener("keydown", (event) => {
    const by = { ArrowRight: 10, ArrowUp: 10, ArrowLeft: -10, ArrowDown: -10, PageUp: 100, PageDown: -100 }[event.key];
    if (!by) return;
    event.preventDefault();
    range.value = Number(range.value) + by;
    range.dispatchEvent(new Event("input"));
  });
  const show = (value) => {
    const number = Number(value.replace(",", "."));
    if (document.activeElement === range || !Number.isFinite(number)) return;
    range.value = Math.min(1000, Math.max(0, toPosition(slider, number) || 0));
    speak(value);
  };
  return { range, show };
}

function text({ field, box, error, inputs }, { change }) {
  const { id, hint, slider } = field;
  const input = element("input", { type: "text", id, inputMode: hint === "name or number" ? "text" : "decimal", spellcheck: false });
  if (hint) input.placeholder = hint;
  input.setAttribute("aria-describedby", `${id}-error`);
  const changed = () => change(id, input.value);
  input.addEventListener("input", changed);
  inputs.push(input);
  const { range, show } = slider ? sliderOf(field, input, changed) : {};
  const entry = element("div", { className: slider ? "entry" : "entry plain" }, ...(range ? [range] : []), input);
  box.append(element("label", { htmlFor: id }, ...heading(field)), entry, error);
  return (value) => {
    if (document.activeElement !== input || input.value !== value) input.value = value;
    show?.(value);
  };
}

const MAKERS = { segments, choice, file, text };

/** The control of a field. `change` receives its new value, `take` its files; `show` shows a value, or the name of a file. */
export function makeControl(field, actions) {
  const { id, kind = "text", title } = field;
  const box = element("div", { className: "field", id: `field-${id}` });
  if (title) box.title = title;
  const control = { field, box, error: element("p", { className: "error", id: `${id}-error`, hidden: true }), inputs: [] };
  control.show = MAKERS[kind](control, actions);
  return control;
}
