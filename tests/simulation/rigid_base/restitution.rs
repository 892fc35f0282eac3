//! The restitution factor: `e = factor (1 − 3/2 sin² α)` for a homogeneous block and ε = 0.

use rocking_block::block::{Block, BlockError, Common, Corner, Dimensionless, Supports};
use rocking_block::excitation::{Inputs, Pulse};
use rocking_block::simulation::{Initial, OnSeparation};

use super::{go, start};

fn made(alpha: f64, epsilon: f64, restitution_factor: f64) -> Result<Block, BlockError> {
    let supports = Supports::Rigid { restitution_factor };
    Block::from_dimensionless(&Dimensionless { alpha, p: 1.0, supports }, &Common { epsilon, ..Common::default() })
}

/// Each impact leaves e² of the energy.
#[test]
fn each_impact_leaves_the_factors_part_of_the_energy() {
    let housner = 1.0 - 1.5 * 0.25_f64.sin().powi(2);
    for factor in [0.0, 0.6, 1.0, 1.05, 1.0 / housner] {
        let block = made(0.25, 0.0, factor).unwrap();
        let e = factor * housner;
        assert!(
            (block.restitution() - e).abs() < 1e-15
                && (block.housner_restitution(Corner::Left) - housner).abs() < 1e-15
        );
        let initial = Initial { theta: 0.1, ..Initial::default() };
        let mut simulation = start(block, OnSeparation::Terminate, Pulse::NONE, &initial, &Inputs::default());
        let before = simulation.energies().total;
        let events = go(&mut simulation.clone(), 1.5, &Inputs::default());
        go(&mut simulation, events[0].time + 1e-9, &Inputs::default());
        let after = simulation.energies().total;
        assert!((after / before - e * e).abs() < 1e-9, "{factor}: {} instead of {}", after / before, e * e);
        assert_eq!(events.len(), 1, "{factor}: {events:?}");
    }
}

#[test]
fn a_factor_that_gains_energy_is_refused() {
    // e = 0.9082 and 0.9082 + 0.4 (1 − 0.9082), by (6).
    for (epsilon, most) in [(0.0, 1.1), (0.4, 1.05)] {
        let error = made(0.25, epsilon, 1.2).unwrap_err();
        let e = made(0.25, epsilon, 1.0).unwrap().restitution();
        assert_eq!(error, BlockError::Restitution { factor: 1.2, housner: e });
        let text = error.to_string();
        for number in ["1.2".to_string(), e.to_string(), (1.2 * e).to_string()] {
            assert!(text.contains(&number), "{number} is not in: {text}");
        }
        assert!(made(0.25, epsilon, most).is_ok());
    }
    assert!(made(0.25, 1.0, 1.0).is_ok());
    // A factor of 1/e up to round-off counts as elastic; anything beyond is refused.
    let rounded = made(0.25, 1.0, 1.0 + f64::EPSILON).unwrap();
    assert_eq!(rounded.restitution(), 1.0);
    assert!(made(0.25, 1.0, 1.0 + 2e-12).is_err());
    for factor in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(made(0.25, 0.0, factor).is_err(), "{factor}");
    }
}
