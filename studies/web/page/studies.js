// Studies in the background: a spectrum and an ensemble, row by row.

import { $ } from "./dom.js";
import { study } from "./engine.js";
import { save } from "./exports.js";
import { StudyPlot } from "./plots.js";

const HIDDEN_LINE = { paths: () => null };

const STUDIES = {
  spectrum: {
    plotOf(root, { p, bases, omega_p }) {
      const names = bases.map((base) => (base.startsWith("rigid") ? "rigid base" : "supports"));
      const colours = ["--left", "--right"];
      const marks = { width: 0, points: { show: true, size: 5, fill: undefined }, value: () => "", ...HIDDEN_LINE };
      return new StudyPlot(root, {
        xLabel: omega_p ? "ωₚ/p" : "2π/p (s): larger blocks to the right",
        yLabel: "peak |θ|/α",
        series: [
          ...names.map((name, i) => [`|θ|/α, ${name}`, colours[i]]),
          ...names.map((name, i) => [`overturned, ${name}`, colours[i], marks]),
        ],
        x: p.map((value) => (omega_p ?? 2 * Math.PI) / value),
        range: [0, 1.35],
        alarm: [1],
        aria: "Peak rotation over the size of the block; marks above the line show the blocks that overturn",
      });
    },
    addRows(plot, { p, bases }, from, { outcome, "peak.theta/alpha": peak }) {
      outcome.forEach((end, i) => {
        const [base, size] = [Math.floor((from + i) / p.length), (from + i) % p.length];
        const fell = end === "overturned";
        plot.set(base, size, fell || end === "failed" ? null : Math.min(peak[i], 1.1));
        plot.set(bases.length + base, size, fell ? 1.2 + 0.08 * base : null);
      });
    },
  },
  ensemble: {
    plotOf(root, { strengths }, { excitation }) {
      const bound = (name) => [`${name}, where runs are undecided`, "--right", { points: { show: true, size: 7 }, ...HIDDEN_LINE }];
      return new StudyPlot(root, {
        xLabel: excitation === "pulse" ? "amplitude aₚ (m/s²)" : "scale of the record",
        yLabel: "probability",
        series: [["overturned", "--left", { points: { show: true, size: 5 } }], bound("at least"), bound("at most")],
        x: strengths[0] < strengths[strengths.length - 1] ? strengths : [...strengths].reverse(),
        range: [0, 1.04],
        alarm: [],
        aria: "Probability of overturning over the strength of the ground motion; two marks bound it where runs are undecided",
      });
    },
    addRows(plot, { strengths }, from, columns) {
      const falls = strengths[0] > strengths[strengths.length - 1];
      columns["P(overturned)"].forEach((probability, i) => {
        const row = falls ? strengths.length - 1 - from - i : from + i;
        const [samples, fell, unknown] = ["samples", "overturned", "unknown(overturned)"].map((count) => columns[`ensemble.${count}`][i]);
        if (unknown === 0) plot.set(0, row, probability);
        else [fell, fell + unknown].forEach((bound, number) => plot.set(1 + number, row, bound / samples));
      });
    },
  },
};

/** A study of the page: its buttons, its plot and its result. */
class StudySection {
  #plot = null;
  #stop = null;
  #result = null;

  /** `helpers` make the rows of the present `fields()`; `showErrors` shows messages beside the study's fields. */
  constructor(name, helpers, fields, showErrors) {
    Object.assign(this, { name, helpers, fields, showErrors, root: $(name) });
    const on = (selector, action) => this.#part(selector)?.addEventListener("click", action);
    on(".cancel", () => this.#stop?.abort());
    on(".start", () => this.#run());
    on(".save", () => this.#result && save(`${name}.csv`, "text/csv", this.#result.table));
    on(".save-study", () => this.#result && save("study.toml", "application/toml", this.#result.file));
  }

  redraw() {
    this.#plot?.redraw();
  }

  #part(selector) {
    return this.root.querySelector(selector);
  }

  #showRunning(running) {
    this.#part(".start").disabled = running;
    this.#part(".cancel").hidden = this.#part("progress").hidden = !running;
  }

  async #run() {
    this.#stop = new AbortController();
    this.#result = null;
    this.#plot?.destroy();
    this.#plot = null;
    this.showErrors([], this.name);
    this.#part("progress").value = 0;
    this.#part(".after").hidden = true;
    this.#part(".state").textContent = "";
    this.#showRunning(true);
    try {
      this.#part(".state").textContent = await this.#make();
    } catch (error) {
      this.#part(".state").textContent = `stopped: ${error.message}`;
    }
    this.#showRunning(false);
  }

  /** Makes all rows; returns the outcome in words. */
  async #make() {
    const begin = performance.now();
    const fields = { ...this.fields() };
    const { plotOf, addRows } = STUDIES[this.name];
    let due = 0;
    const piece = (prepared, from, columns) => {
      this.#plot ??= plotOf(this.#part(".plot"), prepared, fields);
      addRows(this.#plot, prepared, from, columns);
      if (performance.now() <= due) return;
      this.#plot.draw();
      due = performance.now() + 100;
    };
    const progress = (done, rows) => (this.#part("progress").value = done / rows);
    const made = await study(this.helpers, { op: this.name, fields }, this.#stop.signal, piece, progress);
    this.#plot?.draw();
    if (made.errors) {
      this.showErrors(made.errors, this.name);
      return "not started";
    }
    if (!made.complete) return "cancelled";
    this.#result = made;
    this.#part("pre").textContent = made.command;
    this.#part(".after").hidden = false;
    return `${made.rows} rows in ${((performance.now() - begin) / 1000).toFixed(1)} s`;
  }
}

export const setUpStudies = (...context) => Object.keys(STUDIES).map((name) => new StudySection(name, ...context));
