// The moving block in space: a pose of the engine → a drawing in axonometry, seen from the right in front and above. Lengths in metres.

import { add } from "./scene.js";

/** Directions of the drawing, to the right and up, and towards the viewer, in the axes of space. */
const RIGHT = [0.866, 0.5, 0];
const UP = [-0.171, 0.296, 0.94];
const VIEWER = [0.47, -0.814, 0.342];

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => a.map((x, i) => x - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const at = (place) => `${dot(place, RIGHT)},${-dot(place, UP)}`;

/** Turns a place by the twist about the vertical, then by the tilt towards the azimuth. */
function turned([x, y, z], { tilt, azimuth, twist }) {
  const [s, c] = [Math.sin(twist), Math.cos(twist)];
  const v = [x * c - y * s, x * s + y * c, z];
  const axis = [-Math.sin(azimuth), Math.cos(azimuth), 0];
  const [sin, cos] = [Math.sin(tilt), Math.cos(tilt)];
  const [across, along] = [cross(axis, v), dot(axis, v) * (1 - cos)];
  return v.map((part, i) => part * cos + across[i] * sin + axis[i] * along);
}

export class SceneInSpace {
  /** The series of a pose. */
  series = ["tilt", "azimuth", "twist", "u", "w", "v", "a_gx", "a_gy"];

  constructor(svg) {
    this.svg = svg;
    this.world = add(svg, "g");
  }

  /** Draws the block of a run at rest, with room for its motion. */
  setBlock({ block, series: { tilt, u, w } }) {
    this.block = block;
    const { corners, height, eccentricity: [e_x, e_y] } = block;
    const half = Math.max(...corners.map(([x, y]) => Math.hypot(x, y)));
    let drift = 0;
    let most = 0;
    for (let i = 0; i < tilt.length; i++) {
      drift = Math.max(drift, Math.hypot(u[i] + e_x, w[i] + e_y));
      most = Math.max(most, Math.abs(tilt[i]));
    }
    const size = Math.max(height, 2.2 * half);
    const reach = Math.max(0.75 * size, drift + half + height * Math.sin(Math.min(most, Math.PI / 2)));
    this.unit = size / 100;
    this.svg.replaceChildren(this.world);
    this.world.replaceChildren();
    this.svg.setAttribute("viewBox", `${-reach} ${-1.05 * height - 0.4 * half} ${2 * reach} ${1.05 * height + 0.4 * half + 0.55 * reach}`);
    const floor = 1.3 * reach;
    const square = [[-floor, -floor], [floor, -floor], [floor, floor], [-floor, floor]].map(([x, y]) => at([x, y, 0]));
    add(this.world, "polygon", { class: "soil", points: square.join(" ") });
    // The base at rest, x and y.
    const rest = corners.map(([x, y]) => at([x + e_x, y + e_y, 0]));
    add(this.world, "polygon", { class: "rest", points: rest.join(" "), "stroke-width": 0.5 * this.unit });
    for (const [name, x, y] of [["x", 1, 0], ["y", 0, 1]]) {
      const end = (part) => [part * (half + 0.2 * size) * x, part * (half + 0.2 * size) * y, 0];
      const [[x1, y1], [x2, y2], [left, top]] = [end(0), end(1), end(1.15)].map((place) => at(place).split(","));
      add(this.world, "line", { class: "ground", x1, y1, x2, y2, "stroke-width": 0.4 * this.unit });
      add(this.world, "text", { class: "arrow-label", x: left, y: top, "font-size": 4 * this.unit, "text-anchor": "middle" }).textContent = name;
    }
    const sides = corners.map((corner, i) => [corner, corners[(i + 1) % corners.length]]);
    const h = block.h;
    this.faces = [
      corners.map(([x, y]) => [x, y, height - h]),
      corners.map(([x, y]) => [x, y, -h]).reverse(),
      ...sides.map(([[ax, ay], [bx, by]]) => [[ax, ay, -h], [bx, by, -h], [bx, by, height - h], [ax, ay, height - h]]),
    ].map((places) => ({ places, polygon: add(this.world, "polygon", { class: "block", "stroke-width": 0.8 * this.unit, "stroke-linejoin": "round" }) }));
    this.arrow = add(this.world, "g", { class: "arrow" });
    this.shaft = add(this.arrow, "line", { "stroke-width": 1.1 * this.unit });
    this.tip = add(this.arrow, "circle", { r: 1.6 * this.unit });
    this.pose({ tilt: 0, azimuth: 0, twist: 0, u: 0, w: 0, v: 0, a_gx: 0, a_gy: 0 });
  }

  /** Moves the block to a pose of the history; the arrow is the ground acceleration. */
  pose(pose) {
    const { h, eccentricity: [e_x, e_y], g } = this.block;
    const centre = [e_x + pose.u, e_y + pose.w, h + pose.v];
    for (const { places, polygon } of this.faces) {
      const moved = places.map((place) => turned(place, pose).map((part, i) => part + centre[i]));
      const outward = cross(minus(moved[1], moved[0]), minus(moved[2], moved[1]));
      const facing = dot(outward, VIEWER) / Math.hypot(...outward);
      polygon.setAttribute("visibility", facing > 0 ? "visible" : "hidden");
      polygon.setAttribute("fill-opacity", 0.45 + 0.5 * Math.max(0, facing));
      polygon.setAttribute("points", moved.map(at).join(" "));
    }
    const scale = 30 * this.unit;
    const [x, y] = [pose.a_gx / g, pose.a_gy / g].map((ratio) => scale * Math.max(-1.5, Math.min(1.5, ratio)));
    const [x2, y2] = at([x, y, 0]).split(",");
    this.arrow.setAttribute("visibility", Math.hypot(x, y) < 0.4 * this.unit ? "hidden" : "visible");
    for (const [key, value] of Object.entries({ x1: 0, y1: 0, x2, y2 })) this.shaft.setAttribute(key, value);
    this.tip.setAttribute("cx", x2);
    this.tip.setAttribute("cy", y2);
  }
}
