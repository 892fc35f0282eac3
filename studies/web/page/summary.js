// The outcome of a run in words and numbers.

import { $, element } from "./dom.js";

let announced = "";
let announceTimer = 0;

/** Shows the outcome of a run. */
export function showOutcome(reply) {
  $("verdict").className = `verdict ${reply.outcome}`;
  // A screen reader hears the last of a series of outcomes.
  clearTimeout(announceTimer);
  if (announced !== reply.sentence) {
    announceTimer = setTimeout(() => ($("outcome").textContent = announced = reply.sentence), announced ? 60 : 0);
  }
  $("warnings").replaceChildren(...reply.warnings.map((text) => element("li", { textContent: text })));
  const { block } = reply;
  const rows = reply.numbers ?? ofPlane(reply);
  const list = rows.flatMap(([name, value]) => [element("dt", { textContent: name }), element("dd", { textContent: value })]);
  list.push(element("dd", { className: "wide", textContent: `${reply.description}. ${block.line}` }));
  $("numbers").replaceChildren(...list);
  $("command").textContent = reply.command;
}

/** The numbers of a run in the plane; those of one in space are the engine's. */
function ofPlane(reply) {
  const { peak, block } = reply;
  const rows = [
    ["Greatest tilt |θ|/α", peak.ratio],
    ["Greatest uplift of a corner", `${peak.uplift} mm`],
    ["Greatest vertical reaction", `${peak.reaction} M g`],
    ["Greatest horizontal reaction", `${peak.horizontal} M g`],
    ["Impacts, lift-offs", `${reply.impacts}, ${reply.liftoffs}`],
    ["Lifts off a rigid base beyond", `${block.lift_off} g`],
  ];
  const demand = Number(peak.friction_demand) > 10 ? "more than 10" : peak.friction_demand;
  rows.splice(4, 0, block.friction > 0 ? ["Greatest slip of the foot", `${peak.slip} mm`] : ["Friction demand |H|/N", demand]);
  peak.force.forEach((force, i) => {
    const { name, quantity } = block.links[i];
    rows.push([`Greatest ${quantity} of ${name}`, `${force} N`]);
    if (peak.plastic[i] !== null) rows.push([`Greatest plastic elongation of ${name}`, `${peak.plastic[i]} mm`]);
  });
  return rows;
}
