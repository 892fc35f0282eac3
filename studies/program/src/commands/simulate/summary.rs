//! A run → its summary.

use serde::Serialize;

use super::gradients;
use crate::output::summary::{Object, Summary};

use rocking_block::block::restraints::{LinkKind, TieState};
use rocking_block::block::{Block, Corner, Foundation};
use rocking_block::simulation::{Ending, Energies};
use rocking_block::space::{SpaceBody, SpaceParameters};
use rocking_block::system::events::Event;
use rocking_charts::history::{block_line, link_names};
use rocking_charts::history_in_space;
use rocking_studies::run::gradients::Gradients;
use rocking_studies::run::outcome::{Count, End, Holds};
use rocking_studies::run::stopping_rule::loses_energy;
use rocking_studies::run::{History, Run};
use rocking_studies::space::facts;
use rocking_studies::spec::words::Words;

/// Summarizes a run; names are those of the tables and of the FMU's variables.
///
/// `demand` is a coefficient of friction with the longest time above it (s).
pub fn of(
    run: &Run,
    history: &History,
    gradients: &Gradients,
    excitation: &str,
    demand: Option<(f64, f64)>,
    with_events: bool,
) -> Summary {
    let (block, counts) = (&run.block, &history.counts);
    let mut summary = Summary::default();
    summary.item("excitation", excitation, "excitation", excitation);
    summary.item("block", parameters(block), "block", format!("{}, M = {} kg", block_line(block), block.mass));
    add_end(&mut summary, run, history);
    add_peaks(&mut summary, block, history);
    if let Some((coefficient, time)) = demand {
        summary.entry("friction_demand", Object::from([("coefficient", coefficient), ("longest_time_above", time)]));
    }
    add_holds(&mut summary, block, history);
    if let Some((demand, time)) = demand {
        summary.line("friction", format!("|H|/(N_L + N_R) exceeds {demand} for at most {time:.4} s at a time"));
    }
    gradients::add_entries(&mut summary, gradients);
    add_events(&mut summary, history, with_events);
    add_energy(&mut summary, block, history);
    add_steps(&mut summary, [counts.steps, counts.rejected, counts.evaluations]);
    if with_events {
        history.events.iter().for_each(|event| summary.line("", event));
    }
    gradients::add_lines(&mut summary, gradients);
    summary
}

/// Adds the parameters of a block in space.
pub fn add_block_in_space(summary: &mut Summary, parameters: &SpaceParameters, body: &SpaceBody) {
    let numbers: Object = facts::of_block(parameters, body).into_iter().collect();
    let numbers = numbers.with("inertia", facts::inertia(body)).with("feet", facts::feet(body));
    let line = format!("in space, {}, M = {} kg", history_in_space::block_line(parameters, body), body.mass);
    summary.item("block", numbers, "block", line);
}

/// The parameters of a block that have a meaning for it.
pub fn parameters(block: &Block) -> Object {
    let on_supports = block.foundation == Foundation::Viscoelastic;
    let is_uneven = block.eccentricity != 0.0;
    let links = |kind| {
        // An elastic tie has no numbers of yielding.
        let of_tie = block.ties().iter().filter(|tie| tie.kind == kind).map(|tie| {
            let is_shown = |(name, _): &(&str, f64)| tie.yields() || !matches!(*name, "yield_force" | "hardening");
            tie.named().filter(is_shown).collect()
        });
        let links: Vec<Object> = of_tie.collect();
        (!links.is_empty()).then_some(links)
    };
    Object::default()
        .with("foundation", block.foundation.word())
        .with("alpha", block.alpha)
        .with("p", block.p)
        .with_some("eta", on_supports.then(|| block.eta()))
        .with_some("xi_v", on_supports.then_some(block.xi_v))
        .with_some("e", (!on_supports).then(|| block.restitution()))
        .with("epsilon", block.epsilon)
        .with("R0", block.r0)
        .with("width", 2.0 * block.b)
        .with("height", 2.0 * block.h)
        .with("mass", block.mass)
        .with("gamma", block.gamma)
        .with("g", block.gravity)
        .with_some("eccentricity", is_uneven.then_some(block.eccentricity))
        .with_some("alpha_L", is_uneven.then(|| block.alpha_of(Corner::Left)))
        .with_some("alpha_R", is_uneven.then(|| block.alpha_of(Corner::Right)))
        .with_some("friction", (block.friction > 0.0).then_some(block.friction))
        .with_some("ties", links(LinkKind::Tie))
        .with_some("dampers", links(LinkKind::Damper))
}

/// Adds the numbers of steps, of repeated ones and of evaluations.
pub fn add_steps(summary: &mut Summary, [steps, rejected, evaluations]: [u64; 3]) {
    summary.item(
        "steps",
        Object::from([("accepted", steps), ("rejected", rejected), ("evaluations", evaluations)]),
        "steps",
        format!("{steps} ({rejected} repeated), {evaluations} evaluations"),
    );
}

/// Adds how the run ended.
fn add_end(summary: &mut Summary, run: &Run, history: &History) {
    let History { end, ending, is_at_rest, ref lean, .. } = *history;
    let last = history.rows.last().map_or(0.0, |row| row.time);
    let text = match ending {
        Some((ending @ Ending::Separated, time)) => {
            format!("{ending} at t = {time:.4} s; --on-separation fly follows the block")
        }
        Some((ending, time)) => format!("{ending} at t = {time:.4} s"),
        None => format!("{end} at t = {last:.4} s: {}", prospect(run, history)),
    };
    summary.item("outcome", end.word(), "end", text);
    summary.entry("end_time", ending.map_or(last, |(_, time)| time));
    // At rest, or bound to come to rest.
    summary.entry("has_come_down", end == End::Completed);
    summary.entry("is_at_rest", is_at_rest);
    summary.entry("passed_balance", lean.passed_balance());
    summary.entry("ends_tilted", history.ends_tilted(&run.block));
    summary.entry("end.theta/alpha", lean.end / run.block.alpha);
    let Count { count, first } = history.breaks();
    if !run.block.ties().is_empty() {
        summary.entry("ties_broken", count);
    }
    if let Some(first) = first {
        summary.entry("first_break", first);
    }
}

/// Predicts the future of a block that neither overturned nor separated.
fn prospect(run: &Run, history: &History) -> &'static str {
    match (history.end, run.duration) {
        (End::Completed, _) if history.ends_tilted(&run.block) => "the block is at rest, tilted",
        (End::Completed, _) if history.is_at_rest => "the block is at rest",
        (End::Completed, _) if loses_energy(&run.block) => "the block will come to rest",
        (End::Completed, _) => "the block will not overturn",
        (_, Some(_)) => "the duration is too short to tell whether the block overturns",
        (_, None) => "the block may still overturn",
    }
}

/// Adds the greatest values, and the rotation past the balance or at the end.
fn add_peaks(summary: &mut Summary, block: &Block, history: &History) {
    let (peaks, weight) = (&history.peaks, block.mass * block.gravity);
    summary.item(
        "peak",
        Object::from([
            ("theta", peaks.theta),
            ("theta/alpha", peaks.theta / block.alpha),
            ("theta/balance", history.lean.over_balance),
            ("uplift", peaks.uplift),
            ("N", peaks.reaction),
            ("H", peaks.horizontal),
            ("friction_demand", peaks.friction_demand),
        ]),
        "peak",
        format!(
            "|θ|/α = {:.4}, uplift {:.1} mm, N = {:.3} M g, |H| = {:.3} M g",
            peaks.theta / block.alpha,
            1e3 * peaks.uplift,
            peaks.reaction / weight,
            peaks.horizontal / weight
        ),
    );
    if let Some(balance) = balance(block, history) {
        summary.line("balance", balance);
    }
}

/// Describes a block beyond its balance or leaning at the end, if it does either.
fn balance(block: &Block, history: &History) -> Option<String> {
    let (tilted, rest) = (history.ends_tilted(block), history.lean.end / block.alpha);
    if history.end != End::Overturned && history.lean.passed_balance() {
        let (over, back) = (history.lean.over_balance, if tilted { " and ends tilted" } else { "" });
        return Some(format!(
            "the block passed its balance, |θ| = {over:.4} of that angle{back}; θ/α = {rest:.4} at the end"
        ));
    }
    tilted.then(|| format!("the block ends tilted: θ/α = {rest:.4}"))
}

/// Adds the slip, and the ties and dampers with their breaks.
fn add_holds(summary: &mut Summary, block: &Block, history: &History) {
    let (peaks, slip) = (&history.peaks, &history.slip);
    if block.friction > 0.0 {
        let [now, peak, total] = [slip.now, peaks.slip, slip.total].map(|slip| 1e3 * slip);
        summary.item(
            "slip",
            Object::from([("now", slip.now), ("total", slip.total), ("peak", peaks.slip)]),
            "slip",
            format!("{now:.1} mm at the end, at most {peak:.1} mm, {total:.1} mm in all"),
        );
    }
    let mut of_kinds = [Vec::new(), Vec::new()];
    for (number, (name, tie)) in link_names(block).iter().zip(block.ties()).enumerate() {
        let (force, plastic, lost) = (peaks.pull[number], peaks.plastic[number], history.yield_works[number]);
        let is_broken = history.ties[number] == TieState::Broken;
        let is_damper = tie.kind == LinkKind::Damper;
        let shows_yielding = tie.yields() || is_damper;
        let of_link = Object::default()
            .with(&format!("peak_{}", tie.kind.force()), force)
            .with_some("peak_plastic", shows_yielding.then_some(plastic))
            .with_some("yield_energy", shows_yielding.then_some(lost))
            .with("broken", is_broken);
        of_kinds[usize::from(is_damper)].push(of_link);
        let yielding = if tie.yields() {
            let plastic = 1e3 * plastic;
            format!(", plastic elongation of at most {plastic:.2} mm, {lost:.1} J lost by yielding")
        } else {
            String::new()
        };
        let broken = if is_broken { "; it broke" } else { "" };
        summary.line(name, format!("{} of at most {force:.4e} N{yielding}{broken}", tie.kind.force()));
    }
    for (key, links) in ["ties", "dampers"].into_iter().zip(of_kinds).filter(|(_, links)| !links.is_empty()) {
        summary.entry(key, links);
    }
    if let Count { count, first: Some(time) } = history.breaks() {
        let (name, [one, several]) = match Holds::of(block).dampers {
            0 => ("ties", ["tie", "ties"]),
            _ => ("breaks", ["tie or damper", "ties and dampers"]),
        };
        let broke = if count == 1 { format!("1 {one} broke,") } else { format!("{count} {several} broke, the first") };
        summary.line(name, format!("{broke} at t = {time:.4} s"));
    }
}

/// Adds the number of events, and their list in JSON.
fn add_events(summary: &mut Summary, history: &History, with_list: bool) {
    let History { events, counts, ending, is_at_rest, .. } = history;
    let last = events.last().map(|event| event.time);
    let event = |event: &Event| {
        Object::default()
            .with("t", event.time)
            .with("event", event.kind.word())
            .with("corner", event.kind.location())
            .with("before", event.before.to_string())
            .with("after", event.after.to_string())
    };
    let so_far = if ending.is_some() || *is_at_rest { "" } else { " so far" };
    let at = last.map(|time| format!(", the last at t = {time:.4} s")).unwrap_or_default();
    summary.item(
        "events",
        Object::from([("impacts", counts.impacts), ("liftoffs", counts.liftoffs)])
            .with("last_time", last)
            .with_some("list", with_list.then(|| events.iter().map(event).collect::<Vec<_>>())),
        "events",
        format!("{} impacts, {} lift-offs{so_far}{at}", counts.impacts, counts.liftoffs),
    );
}

/// Adds the energies at the end, with the greatest values of the run.
fn add_energy(summary: &mut Summary, block: &Block, history: &History) {
    let energies = history.rows.last().map(|row| row.energies).unwrap_or_default();
    let (total, residual) = (history.greatest_energy(), history.greatest_residual());
    let relative = if total > 0.0 { residual / total } else { 0.0 };
    let mut taken = String::new();
    if block.friction > 0.0 {
        taken += &format!(", friction {:.1} J", energies.friction);
    }
    let Holds { ties, dampers, .. } = Holds::of(block);
    if ties > 0 {
        taken += &format!(", ties {:.1} J", energies.restraints.ties);
    }
    if dampers > 0 {
        taken += &format!(", dampers {:.1} J", energies.restraints.dampers);
    }
    summary.item(
        "energy",
        EnergyEntries { energies, greatest_total: total, greatest_residual: residual },
        "energy",
        format!(
            "input {:.1} J, dashpots {:.1} J, impacts {:.1} J{taken}; residual {relative:.1e} of the largest",
            energies.input, energies.dashpots, energies.impacts
        ),
    );
}

#[derive(Serialize)]
struct EnergyEntries {
    #[serde(flatten)]
    energies: Energies,
    greatest_total: f64,
    greatest_residual: f64,
}
