// The moving block: a pose of the engine → a drawing. All lengths are in metres, y points up.

const NS = "http://www.w3.org/2000/svg";

export function add(parent, name, attributes = {}) {
  const element = parent.appendChild(document.createElementNS(NS, name));
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

/** Rotates a vector clockwise and moves it. */
function placed([x, y], theta, [cx, cy]) {
  const [s, c] = [Math.sin(theta), Math.cos(theta)];
  return [cx + x * c + y * s, cy - x * s + y * c];
}

export class Scene {
  /** The series of a pose. */
  series = ["theta", "u", "v", "uplift_L", "uplift_R", "a_gx"];

  constructor(svg) {
    this.svg = svg;
    this.world = add(svg, "g");
  }

  /** Draws a block at rest; `block` has its sizes (m), and `reach` the greatest distance of any part of it from the middle (m). */
  setBlock(block, reach) {
    this.block = block;
    const { b, h, on_supports, eccentricity } = block;
    const high = block.height;
    const size = Math.max(high, 2.2 * b);
    reach = Math.max(1.06 * reach, 0.75 * size);
    const support = on_supports ? 0.09 * size : 0;
    this.unit = size / 100;
    this.support = support;
    const below = support + 0.17 * size;
    this.svg.replaceChildren(this.world);
    this.svg.setAttribute("viewBox", `${-reach} ${-1.1 * high} ${2 * reach} ${1.1 * high + below}`);
    this.world.replaceChildren();
    const u = this.unit;
    const g = this.world;
    add(g, "rect", { class: "soil", x: -10 * reach, y: support, width: 20 * reach, height: 10 * size });
    add(g, "line", { class: "ground", x1: -10 * reach, x2: 10 * reach, y1: support, y2: support, "stroke-width": 0.7 * u });
    this.supports = on_supports ? [-b, b].map((x) => ({ x, path: add(g, "path", { class: "support", "stroke-width": 0.55 * u }) })) : [];
    this.shape = add(g, "g");
    add(this.shape, "rect", { class: "block", x: -b - eccentricity, y: h - high, width: 2 * b, height: high, "stroke-width": 0.8 * u, rx: 0.4 * u });
    for (const corner of [-b, b]) {
      add(this.shape, "line", { class: "diagonal", x1: 0, y1: 0, x2: corner - eccentricity, y2: h, "stroke-width": 0.4 * u,
        "stroke-dasharray": `${1.6 * u} ${1.4 * u}` });
    }
    const mark = add(this.shape, "g", { class: "centre" });
    const r = 2.1 * u;
    add(mark, "circle", { r, "stroke-width": 0.6 * u });
    for (const turn of [0, 180]) add(mark, "path", { d: `M0 0 L${r} 0 A${r} ${r} 0 0 1 0 ${r} Z`, transform: `rotate(${turn})` });
    this.ties = block.links.map(({ kind }, number) => add(g, "line", {
      class: number % 2 ? "tie second" : "tie",
      "stroke-width": (kind === "damper" ? 2.1 : 0.7) * u,
    }));
    this.arrow = add(g, "g", { class: "arrow" });
    this.shaft = add(this.arrow, "line", { "stroke-width": 1.1 * u });
    this.head = add(this.arrow, "path");
    this.label = add(g, "text", { class: "arrow-label", x: 0, y: support + 14 * u, "font-size": 3.6 * u, "text-anchor": "middle" });
    this.label.textContent = "ground acceleration";
    this.pose({ theta: 0, u: 0, v: 0, uplift_L: 0, uplift_R: 0, a_gx: 0, broken: [] });
  }

  /** Moves the block to a pose of the history. */
  pose({ theta, u, v, uplift_L, uplift_R, a_gx, broken }) {
    const { b, h, eccentricity, g } = this.block;
    const centre = [eccentricity + u, h + v];
    const degrees = (theta * 180) / Math.PI;
    this.shape.setAttribute("transform", `translate(${centre[0]} ${-centre[1]}) rotate(${degrees})`);
    const corners = [-b, b].map((x) => placed([x - eccentricity, -h], theta, centre));
    this.supports.forEach(({ x, path }, side) => {
      const top = corners[side][1] - [uplift_L, uplift_R][side];
      path.setAttribute("d", this.#springAndDashpot(x, -top));
    });
    this.ties.forEach((line, number) => {
      line.setAttribute("visibility", broken[number] ? "hidden" : "visible");
      const { block: [x, z], ground: [groundX, groundZ] } = this.block.links[number];
      const [endX, endZ] = placed([x - eccentricity, z - h], theta, centre);
      for (const [key, value] of Object.entries({ x1: groundX, y1: -groundZ, x2: endX, y2: -endZ })) line.setAttribute(key, value);
    });
    this.#accelerate(a_gx / g);
  }

  /** A spring on the left, a dashpot on the right, between the ground and `top` (m, downwards). */
  #springAndDashpot(x, top) {
    const w = Math.min(2.6 * this.unit, 0.45 * this.block.b);
    const [foot, l] = [this.support, this.support - top];
    const y = (part) => top + part * l;
    const zigzag = [0.3, 0.38, 0.46, 0.54, 0.62].map((part, i) => `L${x - w + (i % 2 ? 0.6 : -0.6) * w} ${y(part)}`).join("");
    return (
      `M${x} ${y(0)}V${y(0.12)}M${x - w} ${y(0.12)}H${x + w}M${x - w} ${y(0.12)}V${y(0.24)}${zigzag}L${x - w} ${y(0.7)}V${foot}` +
      `M${x + w} ${y(0.12)}V${y(0.5)}M${x + 0.4 * w} ${y(0.5)}H${x + 1.6 * w}` +
      `M${x + 0.4 * w} ${y(0.3)}V${y(0.72)}H${x + 1.6 * w}V${y(0.3)}M${x + w} ${y(0.72)}V${foot}`
    );
  }

  /** An arrow for the ground acceleration in units of g. */
  #accelerate(ratio) {
    const u = this.unit;
    const length = Math.sign(ratio) * Math.min(Math.abs(ratio), 1.5) * 30 * u;
    const y = this.support + 7.5 * u;
    this.arrow.setAttribute("visibility", Math.abs(length) < 0.4 * u ? "hidden" : "visible");
    const tip = length;
    const head = Math.sign(length) * Math.min(3 * u, Math.abs(length));
    for (const [key, value] of Object.entries({ x1: 0, x2: tip - 0.8 * head, y1: y, y2: y })) this.shaft.setAttribute(key, value);
    this.head.setAttribute("d", `M${tip} ${y}L${tip - head} ${y - 1.6 * u}V${y + 1.6 * u}Z`);
  }
}
