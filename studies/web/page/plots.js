// Plots of a history and of studies, by uPlot.

import uPlot from "uplot";

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Lengths of text (px) at the size of text that the user has chosen. */
const scaled = (length) => (length / 16) * parseFloat(getComputedStyle(document.documentElement).fontSize);

/** Greatest |θ|/α that is drawn. */
const MAX_ROTATION = 1.6;

const number = (value) => (value === null || value === undefined ? "–" : value.toPrecision(4).replace("-", "−"));

function axes(xLabel, yLabel, x = true) {
  const common = () => ({
    stroke: () => colour("--ink-soft"),
    grid: { stroke: () => colour("--grid"), width: 1 },
    ticks: { stroke: () => colour("--grid"), width: 1, size: 4 },
    font: `${scaled(12)}px system-ui, sans-serif`,
    labelFont: `${scaled(12)}px system-ui, sans-serif`,
    labelGap: 0,
  });
  return [
    { ...common(), label: x ? xLabel : null, labelSize: scaled(18), size: x ? scaled(24) : 8, values: x ? undefined : (u, splits) => splits.map(() => "") },
    { ...common(), label: yLabel, labelSize: scaled(20), size: scaled(52), space: scaled(22), values: (u, splits) => splits.map((value) => String(Number(value.toPrecision(6))).replace("-", "−")) },
  ];
}

const line = (label, name, extra = {}) => ({
  label,
  stroke: () => colour(name),
  width: 1.4,
  points: { show: false },
  value: (u, value) => number(value),
  ...extra,
});

/** Draws a horizontal line at each of these values. */
function levels(u, values, name) {
  const { ctx } = u;
  ctx.save();
  ctx.strokeStyle = colour(name);
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
  for (const value of values) {
    const y = Math.round(u.valToPos(value, "y", true)) + 0.5;
    if (y < u.bbox.top || y > u.bbox.top + u.bbox.height) continue;
    ctx.beginPath();
    ctx.moveTo(u.bbox.left, y);
    ctx.lineTo(u.bbox.left + u.bbox.width, y);
    ctx.stroke();
  }
  ctx.restore();
}

const symmetric = (u, least, greatest) => {
  const most = Math.max(Math.abs(least ?? 0), Math.abs(greatest ?? 0), 1e-9) * 1.08;
  return [-most, most];
};

const REGIMES = [[-1, "on left"], [0, "on both"], [1, "on right"], [2, "in flight"]];

/** The plots of a history, with a common time axis. */
export class Histories {
  #plots = [];

  constructor(root, seek) {
    this.root = root;
    this.seek = seek;
    new ResizeObserver(() => this.#resize()).observe(root);
  }

  /** Shows a run: its series as arrays, its events, the block. */
  show(run) {
    this.run = run;
    const { series, block } = run;
    const { t } = series;
    const part = (values, by) => Float64Array.from(values, (value) => value / by);
    const theta = part(series.theta, block.alpha);
    const reach = theta.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    this.rotation = reach > 0.4 ? Math.min(Math.max(1.12, 1.06 * reach), MAX_ROTATION) : 1.15 * Math.max(reach, 1e-6);
    this.flies = run.events.some((event) => event.after === 2) || series.regime.includes(2);
    const vertical = series.a_gz.some((value) => value !== 0);
    const slides = "slip" in series;
    const { links } = block;
    const forces = links.map(({ column }) => series[column]);
    const data = [
      [t, theta],
      [t, part(series.N_L, block.weight), part(series.N_R, block.weight)],
      [t, series.regime],
      ...(slides ? [[t, part(series.slip, 0.001)]] : []),
      ...(forces.length ? [[t, ...forces.map((force) => part(force, block.weight))]] : []),
      [t, part(series.a_gx, block.g), ...(vertical ? [part(series.a_gz, block.g)] : [])],
    ];
    const kind = `${vertical} ${this.flies} ${slides} ${links.map(({ name }) => name)}`;
    if (this.#plots.length === 0 || this.kind !== kind) {
      this.#plots.splice(0).forEach((plot) => plot.destroy());
      this.kind = kind;
      const all = this.#options(vertical, slides, links);
      for (const { hooks } of all) (hooks.draw ??= []).push((plot) => this.#movePlayhead(plot));
      this.#plots = all.map((options, i) => new uPlot(options, data[i], this.root));
      this.#plots.forEach((plot, i) => this.#dress(plot, all[i].aria));
    } else {
      this.#plots.forEach((plot, i) => plot.setData(data[i]));
    }
  }

  #options(vertical, slides, links) {
    const sync = { key: "time" };
    const base = (label, height, aria) => ({
      width: this.root.clientWidth,
      height: scaled(height),
      padding: [8, 12, 0, 0],
      cursor: { sync, drag: { x: true, y: false }, points: { size: 6 } },
      legend: { show: false },
      scales: { x: { time: false } },
      axes: axes("time (s)", label, label === "ground (g)"),
      hooks: {},
      aria,
    });
    const rotation = base("θ/α", 210, "Rotation over the critical tilt, over time");
    rotation.scales.y = { range: () => [-this.rotation, this.rotation] };
    rotation.series = [{}, line("θ/α", "--ink")];
    rotation.hooks = { drawAxes: [(u) => levels(u, [-1, 1], "--alarm")] };
    const reactions = base("N/(M g)", 170, "Vertical reactions of both corners over the weight, over time");
    reactions.series = [{}, line("left N_L", "--left"), line("right N_R", "--right")];
    const regimes = base("", this.flies ? 112 : 92, "Which corners touch, over time");
    const rows = this.flies ? REGIMES : REGIMES.slice(0, 3);
    regimes.scales.y = { range: () => [-1.5, rows.length - 1.5] };
    regimes.series = [{}, { label: "touching", stroke: "transparent", points: { show: false }, paths: () => null,
      value: (u, value) => rows.find(([regime]) => regime === value)?.[1] ?? "–" }];
    regimes.axes[1] = { ...regimes.axes[1], label: null, size: scaled(72), splits: () => rows.map(([regime]) => regime),
      values: (u, splits) => splits.map((value) => rows.find(([regime]) => regime === value)?.[1] ?? ""), grid: { show: false }, ticks: { show: false } };
    regimes.hooks = { draw: [(u) => this.#drawRegimes(u)] };
    const slip = base("slip (mm)", 130, "Displacement of the foot from its position at the start, over time");
    slip.scales.y = { range: symmetric };
    slip.series = [{}, line("slip", "--ink")];
    const force = base("T/(M g)", 130, "Forces of the ties and dampers over the weight, over time");
    const pushes = links.some(({ kind }) => kind === "damper");
    force.scales.y = { range: pushes ? symmetric : (u, least, greatest) => [0, Math.max(greatest ?? 0, 1e-9) * 1.08] };
    force.series = [{}, ...links.map(({ name }, i) => line(name, ["--left", "--right", "--ink", "--alarm"][i]))];
    const ground = base("ground (g)", 156, "Ground acceleration over time");
    ground.scales.y = { range: symmetric };
    ground.series = [{}, line("horizontal", "--ink"), ...(vertical ? [line("vertical", "--right")] : [])];
    return [rotation, reactions, regimes, ...(slides ? [slip] : []), ...(links.length ? [force] : []), ground];
  }

  #drawRegimes(u) {
    const { ctx, bbox } = u;
    const { events, series } = this.run;
    const end = series.t[series.t.length - 1];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    let [regime, since] = [series.regime[0], series.t[0]];
    for (const event of [...events, { t: end, after: null }]) {
      const [x0, x1] = [since, event.t].map((time) => u.valToPos(time, "x", true));
      const [y0, y1] = [regime + 0.36, regime - 0.36].map((value) => u.valToPos(value, "y", true));
      ctx.fillStyle = colour({ "-1": "--left", 0: "--both", 1: "--right", 2: "--alarm" }[regime]);
      ctx.fillRect(x0, y0, Math.max(x1 - x0, 0.5), y1 - y0);
      [regime, since] = [event.after, event.t];
    }
    ctx.restore();
  }

  /** Adds the playhead and the click that seeks. */
  #dress(plot, aria) {
    plot.head = plot.over.appendChild(document.createElement("div"));
    plot.head.className = "playhead";
    plot.root.setAttribute("role", "img");
    plot.root.setAttribute("aria-label", aria);
    let down = 0;
    plot.over.addEventListener("pointerdown", (event) => (down = event.clientX));
    plot.over.addEventListener("click", (event) => {
      // A drag zooms.
      if (Math.abs(event.clientX - down) > 4) return;
      const { left } = plot.over.getBoundingClientRect();
      this.seek(plot.posToVal(event.clientX - left, "x"));
    });
  }

  /** Moves the playhead to a time (s). */
  setTime(time) {
    this.time = time;
    for (const plot of this.#plots) this.#movePlayhead(plot);
  }

  #movePlayhead(plot) {
    const { min, max } = plot.scales.x;
    // A plot has no scale before it is first drawn.
    if (!plot.head || min == null || this.time === undefined) return;
    plot.head.hidden = this.time < min || this.time > max;
    plot.head.style.transform = `translateX(${plot.valToPos(this.time, "x")}px)`;
  }

  redraw() {
    this.#plots.forEach((plot) => plot.redraw(false));
  }

  #resize() {
    const width = this.root.clientWidth;
    this.#plots.forEach((plot) => width > 0 && plot.setSize({ width, height: plot.height }));
  }
}

/** A plot of a study that grows row by row. */
export class StudyPlot {
  constructor(root, { xLabel, yLabel, series, x, range, log, alarm, aria }) {
    this.root = root;
    const height = scaled(260);
    this.data = [x, ...series.map(() => new Array(x.length).fill(null))];
    const plotAxes = axes(xLabel, yLabel);
    this.plot = new uPlot(
      {
        width: root.clientWidth,
        height,
        padding: [10, 14, 0, 0],
        legend: { show: true, live: true },
        scales: { x: { time: false, distr: log ? 3 : 1 }, y: { range: () => range } },
        axes: plotAxes,
        series: [{ label: xLabel, value: (u, value) => number(value) }, ...series.map(([label, name, extra]) => line(label, name, extra))],
        hooks: { drawAxes: [(u) => levels(u, alarm, "--alarm")] },
      },
      this.data,
      root,
    );
    this.plot.root.setAttribute("role", "img");
    this.plot.root.setAttribute("aria-label", aria);
    this.observer = new ResizeObserver(() => root.clientWidth > 0 && this.plot.setSize({ width: root.clientWidth, height }));
    this.observer.observe(root);
  }

  set(series, index, value) {
    this.data[1 + series][index] = value;
  }

  draw() {
    this.plot.setData(this.data);
  }

  redraw() {
    this.plot.redraw(false);
  }

  destroy() {
    this.observer.disconnect();
    this.plot.destroy();
  }
}
