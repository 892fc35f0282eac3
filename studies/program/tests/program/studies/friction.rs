//! The longest time above a coefficient of friction.

use std::f64::consts::{FRAC_2_PI, TAU};

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::run::Run;

fn run(alpha: f64, foundation: Foundation, amplitude: f64) -> Run {
    let common = Common::default();
    let block = Block::from_dimensionless(
        &Dimensionless { alpha, p: 1.5, supports: Supports::of(foundation, Ratios { eta: 60.0, xi_v: 0.2 }) },
        &common,
    )
    .unwrap();
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period: 1.3, start: 0.25, ..Pulse::NONE };
    let (initial, ground) = (Initial::default(), Ground::default());
    Run { block, settings, initial, pulse, ground, duration: None, output_step: f64::INFINITY }
}

/// A block at rest under a sine has H = M a and N = M g: `|a|/g` exceeds μ twice, for `T/2 − T/π asin(μ g/A)`.
#[test]
fn a_block_at_rest_needs_the_friction_of_the_ground_acceleration() {
    let (amplitude, period, gravity) = (3.0, 1.3, 9.81);
    let still = run(0.35, Foundation::Rigid, amplitude);
    for friction in [0.05, 0.1, 0.2, 0.3] {
        let exact = 0.5 * period * (1.0 - FRAC_2_PI * (friction * gravity / amplitude).asin());
        let found = still.longest_above(friction);
        // The excess is linear between checks 1 ms apart: an error of dt²/8 times curvature over slope at both ends.
        let phase = (friction * gravity / amplitude).asin();
        let most = 2.0 * 1e-6 / 8.0 * TAU / period * phase.tan();
        assert!((found - exact).abs() <= 1.1 * most, "{friction}: {found} s, exactly {exact} s");
    }
    assert_eq!(still.longest_above(0.31), 0.0);
}

/// For a rocking block the time agrees with a history of small steps, within the duration of impacts.
#[test]
fn the_time_is_that_of_a_fine_history() {
    for (alpha, foundation, amplitude) in
        [(0.25, Foundation::Viscoelastic, 5.0), (0.2, Foundation::Rigid, 4.0), (0.3, Foundation::Viscoelastic, 7.0)]
    {
        let step = 2.5e-4;
        let run = run(alpha, foundation, amplitude);
        let history = Run { output_step: step, ..run.clone() }.history(|_| ()).unwrap();
        assert!(history.peaks.friction_demand > 1.0 && history.counts.liftoffs > 0);
        for friction in [0.2, 0.3, 0.5] {
            let (mut longest, mut piece) = (0, 0);
            for row in &history.rows {
                piece = if row.observation.friction_demand > friction { piece + 1 } else { 0 };
                longest = longest.max(piece);
            }
            let (found, rows) = (run.longest_above(friction), step * f64::from(longest));
            assert!((found - rows).abs() < 4.0 * step + 0.02 * rows, "{alpha} {friction}: {found} s, {rows} s");
        }
    }
}
