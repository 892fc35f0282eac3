//! Derivatives of peaks of random blocks, with the tolerance that users have, against differences of runs with a strict one.

use std::cell::Cell;

use proptest::prelude::*;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, Body, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::Initial;
use rocking_gradients::Parameters;

use crate::cases_of_properties::cases;
use crate::peaks::named;
use crate::run::{Results, Run};

/// The tolerance of runs whose derivatives are tried; differences are those of runs with `STRICT`.
const USUAL: f64 = 1e-8;
const STRICT: f64 = 1e-13;

/// The parameters with respect to which peaks are derived.
const NAMES: [&str; 4] = ["alpha", "pulse.amplitude", "pulse.period", "pulse.start"];

fn block() -> impl Strategy<Value = (Dimensionless, Common, Vec<Tie>)> {
    let dimensionless = (0.1..0.5_f64, 0.8..4.0_f64, 10.0..60.0_f64, 0.05..0.8_f64);
    let friction = prop_oneof![2 => Just(0.0), 1 => 0.1..0.8_f64];
    let rigid = any::<bool>();
    let ties = prop_oneof![3 => Just(None), 1 => (0.1..3.0_f64, 0.0..0.02_f64, 0.0..0.3_f64).prop_map(Some)];
    (dimensionless, friction, rigid, 0.0..0.6_f64, ties).prop_map(
        |((alpha, p, eta, xi_v), friction, rigid, epsilon, ties)| {
            let foundation = if rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
            let common = Common { friction, epsilon, ..Common::default() };
            let size = 9.81 * 0.75 / (p * p);
            let weight = common.mass * common.gravity;
            let ties = ties.map_or(Vec::new(), |(stiffness, slack, damping)| {
                [-1.0, 1.0]
                    .map(|side| Tie {
                        block: [side * 0.5 * size * alpha, 1.5 * size],
                        ground: [side * 2.0 * size, 0.0],
                        stiffness: stiffness * weight / size,
                        slack: slack * size,
                        damping: damping * weight / (size * p),
                        ..Tie::default()
                    })
                    .to_vec()
            });
            (Dimensionless { alpha, p, supports: Supports::of(foundation, Ratios { eta, xi_v }) }, common, ties)
        },
    )
}

/// Whether runs have the same events in the same order.
fn alike(runs: &[Results<f64>]) -> bool {
    let kinds = |results: &Results<f64>| results.events.iter().map(|event| event.0).collect::<Vec<_>>();
    runs.iter().all(|other| kinds(other) == kinds(&runs[0]))
}

#[test]
fn derivatives_of_peaks_match_differences() {
    let shape = prop_oneof![
        Just(PulseShape::OneSine),
        Just(PulseShape::OneCosine),
        Just(PulseShape::HalfSine),
        Just(PulseShape::Rectangular)
    ];
    let pulse = (shape, 1.05..4.0_f64, 0.2..1.5_f64);
    let (tried, skipped) = (Cell::new(0), Cell::new(0));
    proptest!(cases(100), |((dimensionless, common, ties) in block(), (shape, strength, period) in pulse)| {
        let amplitude = strength * common.gravity * dimensionless.alpha.tan();
        let pulse = Pulse { shape, amplitude, period, start: 0.1, ..Pulse::NONE };
        let run = |tolerance| Run {
            name: "random".into(),
            parameters: Parameters {
                block: dimensionless.with(&common),
                ties: ties.clone(),
                initial: Initial::default(),
                pulse,
                scale: None,
            },
            ground: Ground::default(),
            flies: true,
            tolerance,
            step: 2.0,
            rows: 1,
            difference: 1e-6,
        };
        let found = run(USUAL).gradients(&NAMES);
        let Block { alpha, body: Body { r0, mass, gravity, .. }, .. } = run(USUAL).block();
        let sizes = [alpha, mass * gravity, mass * gravity, r0 * alpha, 1.0, r0 * alpha];
        for (i, name) in NAMES.iter().enumerate() {
            let strict = run(STRICT);
            let value = strict.value(name);
            let at = |part: f64| strict.with(name, value * (1.0 + part)).plain();
            let steps = [-2e-6, -1e-6, 0.0, 1e-6, 2e-6].map(at);
            if !alike(&steps) || found.grazing.is_some() {
                continue;
            }
            for (j, (quantity, ours)) in named(&found.peaks).into_iter().enumerate() {
                let at = |k: usize| named(&steps[k].peaks)[j].1;
                let [inner, outer] = [(at(3) - at(1)) / (2e-6 * value), (at(4) - at(0)) / (4e-6 * value)];
                // Peaks far below the size of the motion have its errors.
                let size = (at(2).abs() + 0.01 * sizes[j]) / value;
                // A peak with a kink here, or another one with the usual tolerance, as that of |H|/N in an instant of little N.
                if (inner - outer).abs() > 1e-4 * (inner.abs() + 1e-3 * size) || (ours.re / at(2) - 1.0).abs() > 1e-4 {
                    skipped.set(skipped.get() + 1);
                    continue;
                }
                tried.set(tried.get() + 1);
                let (ours, expected) = (ours.eps[i], (4.0 * inner - outer) / 3.0);
                let case = || format!("{quantity} over {name}: {ours} for {expected}; {dimensionless:?}, {common:?}, {pulse:?}, {ties:?}");
                prop_assert!((ours - expected).abs() <= 1e-3 * expected.abs() + 1e-4 * size, "{}", case());
            }
        }
    });
    assert!(tried.get() > 4 * skipped.get(), "{tried:?} tried, {skipped:?} not resolved");
}
