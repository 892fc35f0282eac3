//! Derivatives of peaks at the first instant, at jumps of the excitation, at events and where a slide stops.

use rocking_block::block::restraints::Tie;
use rocking_block::block::{Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::Initial;
use rocking_block::simulation::peaks::Peaks;
use rocking_gradients::Parameters;

use crate::run::Run;

/// A block at rest under a pulse.
fn run(
    alpha: f64,
    p: f64,
    (foundation, common): (Foundation, Common),
    pulse: Pulse,
    tolerance: f64,
    duration: f64,
) -> Run {
    let supports = Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 });
    Run {
        name: "a pulse".into(),
        parameters: Parameters {
            block: Dimensionless { alpha, p, supports }.with(&common),
            ties: Vec::new(),
            initial: Initial::default(),
            pulse,
            scale: None,
        },
        ground: Ground::default(),
        flies: true,
        tolerance,
        step: duration,
        rows: 1,
        difference: 1e-6,
    }
}

fn pulse(shape: PulseShape, amplitude: f64, period: f64, start: f64) -> Pulse {
    Pulse { shape, amplitude, period, start, ..Pulse::NONE }
}

fn on(foundation: Foundation, friction: f64) -> (Foundation, Common) {
    (foundation, Common { friction, ..Common::default() })
}

pub fn named<T: Copy>(peaks: &Peaks<T>) -> [(&'static str, T); 6] {
    let Peaks { theta, reaction, horizontal, uplift, friction_demand, slip, .. } = *peaks;
    [
        ("theta", theta),
        ("N", reaction),
        ("H", horizontal),
        ("uplift", uplift),
        ("demand", friction_demand),
        ("slip", slip),
    ]
}

/// A jump of the excitation lifts the block at the first instant, when its reactions are greatest.
#[test]
fn peaks_at_the_first_instant() {
    let run = run(0.25, 2.0, on(Foundation::Rigid, 0.0), pulse(PulseShape::OneCosine, 7.27, 1.0, 0.0), 1e-10, 0.2);
    let found = run.gradients(&["pulse.amplitude"]);
    let step = 1e-4;
    let [before, after] = [-step, step].map(|step| run.with("pulse.amplitude", 7.27 + step).plain().peaks);
    for (((name, found), (_, before)), (_, after)) in
        named(&found.peaks).into_iter().zip(named(&before)).zip(named(&after))
    {
        let difference = (after - before) / (2.0 * step);
        assert!((found.eps[0] - difference).abs() <= 1e-6 * (1.0 + found.re.abs()), "{name}: {found:?}, {difference}");
    }
}

/// A pulse that begins later moves all peaks in time without a change, whatever their kind and the tolerance; where the pulse ends with a jump,
/// at events, and where a slide stops at an impact.
#[test]
fn a_later_pulse_leaves_all_peaks() {
    let rigid = |friction| on(Foundation::Rigid, friction);
    for (alpha, common, pulse, duration) in [
        (0.25, rigid(0.0), pulse(PulseShape::Rectangular, 2.8, 1.0, 0.1), 2.0),
        (0.25, on(Foundation::Viscoelastic, 0.0), pulse(PulseShape::OneCosine, 6.0, 1.0, 0.1), 2.0),
        (0.25, on(Foundation::Viscoelastic, 0.3), pulse(PulseShape::OneCosine, 6.0, 1.0, 0.1), 2.0),
        (0.39, rigid(0.56), pulse(PulseShape::OneSine, 6.8, 1.1, 0.1), 4.0),
    ] {
        for tolerance in [1e-10, 1e-7] {
            let found = run(alpha, 2.0, common, pulse, tolerance, duration).gradients(&["pulse.start"]);
            assert!(found.grazing.is_none());
            // A block on its way over has its greatest rotation at the end of the run, which does not move.
            let turns = found.rows.last().unwrap().1.theta.re.abs() >= (1.0 - 1e-9) * found.peaks.theta.re;
            for (name, peak) in named(&found.peaks) {
                if turns && ["theta", "uplift"].contains(&name) {
                    continue;
                }
                let most = 1e-3 * peak.re.abs() * if tolerance < 1e-8 { 1e-2 } else { 1.0 };
                assert!(peak.eps[0].abs() <= most, "{name} of {pulse:?}, {tolerance}: {peak:?}");
            }
        }
    }
}

/// A pulse that ends with a jump ends with the greatest H while the block turns: the peak moves with the end.
#[test]
fn a_peak_at_a_jump_moves_with_it() {
    let run = run(0.25, 2.0, on(Foundation::Rigid, 0.0), pulse(PulseShape::Rectangular, 2.8, 1.0, 0.1), 1e-10, 2.0);
    let found = run.gradients(&["pulse.period"]);
    let step = 1e-4;
    let [before, after] = [-step, step].map(|step| run.with("pulse.period", 1.0 + step).plain().peaks);
    for (((name, found), (_, before)), (_, after)) in
        named(&found.peaks).into_iter().zip(named(&before)).zip(named(&after))
    {
        let difference = (after - before) / (2.0 * step);
        assert!(
            (found.eps[0] - difference).abs() <= 1e-5 * (found.re.abs() + difference.abs()),
            "{name}: {found:?}, {difference}"
        );
    }
}

/// Where a foot slides, the greatest demand is μ.
#[test]
fn the_demand_of_a_sliding_foot_is_the_coefficient_of_friction() {
    let pulse = pulse(PulseShape::OneCosine, 6.0, 1.0, 0.1);
    for foundation in [Foundation::Rigid, Foundation::Viscoelastic] {
        let found = run(0.25, 2.0, on(foundation, 0.2), pulse, 1e-7, 2.0).gradients(&["friction", "pulse.amplitude"]);
        let demand = found.peaks.friction_demand;
        assert!((demand.re - 0.2).abs() < 1e-9 && found.peaks.slip.re > 0.0, "{demand:?}");
        assert!((demand.eps[0] - 1.0).abs() < 1e-6 && demand.eps[1].abs() < 1e-6, "{demand:?}");
    }
}

/// A tie that breaks has pulled with its strength, also where the dashpot takes more at once in an impact.
#[test]
fn the_peak_pull_of_a_broken_tie_is_its_strength() {
    let mut at_impacts = 0;
    for strength in (2..60).map(|i| 100.0 * f64::from(i)) {
        let mut run = run(0.25, 2.0, on(Foundation::Rigid, 0.0), pulse(PulseShape::OneSine, 6.0, 1.0, 0.1), 1e-10, 2.0);
        run.parameters.block.common.mass = 1000.0;
        let tie =
            Tie { block: [0.0, 3.0], stiffness: 1e4, pretension: 100.0, damping: 1e4, strength, ..Tie::default() };
        run.parameters.ties = vec![tie];
        let found = run.gradients(&["tie_1.strength", "pulse.amplitude"]);
        let Some(broken) = found.events.iter().find(|(kind, _)| kind.word() == "break") else { continue };
        at_impacts +=
            found.events.iter().filter(|event| event.0.word() == "landing" && event.1.re == broken.1.re).count();
        let pull = found.peaks.pull[0];
        let off = [pull.re / strength - 1.0, pull.eps[0] - 1.0, pull.eps[1]];
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{strength}: {pull:?}, {broken:?}");
    }
    assert!(at_impacts > 3, "{at_impacts}");
}
