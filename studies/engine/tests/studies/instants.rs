//! Events that the clock does not resolve: blocks at the edge of lift-off, and clocks far from zero.

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_records::{ReadOptions, Record};
use rocking_studies::run::Run;
use rocking_studies::run::batch::outcomes;
use rocking_studies::run::outcome::{End, Outcome};

use crate::cases::cases;

const G: f64 = 9.81;

/// A POSIX clock (s), whose resolution is 2.4e-7 s.
const POSIX: f64 = 1.7e9;

fn loma_prieta() -> Record {
    let bytes = include_bytes!("../../../../examples/records/np01002p_4225a_a.smc");
    rocking_records::parse("np01002p_4225a_a.smc", bytes, &ReadOptions::default()).unwrap()
}

fn run(dimensionless: &Dimensionless, common: &Common, record: Record) -> Run {
    let block = Block::from_dimensionless(dimensionless, common).unwrap();
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    Run { ground: Ground { horizontal: Some(record), vertical: None }, ..Run::at_rest(block, settings) }
}

/// The record times the factor with which its peak is just what lifts the block.
fn at_the_edge(alpha: f64, p: f64, excess: f64, start_time: f64) -> Run {
    let record = loma_prieta();
    let factor = G * alpha.tan() / record.peak().acceleration.abs() * (1.0 + excess);
    let common = Common { gravity: G, ..Common::default() };
    let record = Record { start_time, ..record.scaled(factor) };
    run(&Dimensionless { alpha, p, supports: Supports::HOUSNER }, &common, record)
}

/// It lifts at the peak for less than the clock resolves, and stands.
#[test]
fn a_block_that_the_peak_of_a_record_hardly_lifts_stands() {
    let record = loma_prieta().scaled(0.6662935867121493);
    let common = Common::default();
    let outcome = run(&Dimensionless { alpha: 0.15, p: 4.0, supports: Supports::HOUSNER }, &common, record).outcome();
    assert_eq!((outcome.end, outcome.failure), (End::Completed, None));
    assert!(outcome.peaks.theta < 1e-20, "{}", outcome.peaks.theta);
}

/// Blocks that the peak of the record exceeds by round-off, or by up to a thousandth.
#[test]
fn runs_at_the_edge_of_lift_off_do_not_fail() {
    let excess = prop_oneof![
        4 => (-8..8_i32).prop_map(|ulps| f64::from(ulps) * f64::EPSILON),
        1 => (3.0..16.0_f64).prop_map(|digits| 10_f64.powf(-digits)),
    ];
    let start_time = prop_oneof![3 => Just(0.0), 1 => 0.0..100.0, 1 => Just(POSIX)];
    let block = (0.01..0.6_f64, 0.5..8.0_f64, excess, start_time);
    proptest!(cases(40), |(blocks in prop::collection::vec(block, 16))| {
        let runs = || blocks.iter().map(|&(alpha, p, excess, start_time)| at_the_edge(alpha, p, excess, start_time));
        let alone: Vec<Outcome> = runs().map(|run| run.outcome()).collect();
        for (outcome, block) in alone.iter().zip(&blocks) {
            prop_assert_eq!((outcome.end, &outcome.failure), (End::Completed, &None), "{:?}", block);
        }
        prop_assert_eq!(outcomes(VectorWidth::widest(), runs(), || ()), alone);
    });
}

/// Impacts come closer and closer before rest. The samples of the record are up to 1.2e-7 s off, of 0.005 s.
#[test]
fn a_run_on_a_posix_clock_has_the_outcome_of_one_from_zero() {
    for epsilon in [0.0, 0.4] {
        let common = Common { epsilon, ..Common::default() };
        let made = [0.0, POSIX].map(|start_time| {
            let record = Record { start_time, ..loma_prieta().scaled(1.5) };
            run(&Dimensionless { alpha: 0.2, p: 2.0, supports: Supports::HOUSNER }, &common, record).outcome()
        });
        let [near, far] = &made;
        assert_eq!((near.end, far.end), (End::Completed, End::Completed), "{common:?}: {made:?}");
        let difference = far.peaks.theta / near.peaks.theta - 1.0;
        assert!(near.peaks.theta > 0.1 && difference.abs() < 1e-3, "{common:?}: {difference}");
    }
}

/// Runs on supports in which the clock does not tell a lift-off from the landing after it, or in which a corner stops beside a held one.
#[test]
fn runs_on_supports_on_a_posix_clock_do_not_fail() {
    let gripping = Dimensionless {
        alpha: 0.40824,
        p: 6.16571,
        supports: Supports::Viscoelastic(Ratios { eta: 10.0, xi_v: 0.16356 }),
    };
    let sliding = Dimensionless {
        alpha: 0.449915787007557,
        p: 1.0844043647489054,
        supports: Supports::Viscoelastic(Ratios { eta: 11.894613110255117, xi_v: 0.6234912499371702 }),
    };
    let friction = 0.4630170698342313;
    for (dimensionless, friction, strength) in [(gripping, 0.0, 2.3595), (sliding, friction, 1.3642814034301431)] {
        let outcome = on_a_posix_clock(&dimensionless, &Common { friction, ..Common::default() }, strength).outcome();
        assert_eq!(outcome.failure, None);
    }
}

/// Random blocks, overturning ones among them, on clocks of 1.7e9 s.
#[test]
fn runs_on_a_posix_clock_do_not_fail() {
    let supports = prop_oneof![Just(None), (10.0..80.0_f64, 0.02..1.0_f64).prop_map(Some)];
    let friction = prop_oneof![Just(0.0), 0.03..1.0_f64];
    let block = (0.05..0.6_f64, 0.5..8.0_f64, supports, 0.0..0.9_f64, friction);
    proptest!(cases(60), |((alpha, p, supports, epsilon, friction) in block, strength in 0.5..4.0_f64)| {
        let foundation = if supports.is_some() { Foundation::Viscoelastic } else { Foundation::Rigid };
        let (eta, xi_v) = supports.unwrap_or((60.0, 0.1));
        let common = Common { epsilon, friction, ..Common::default() };
        let outcome = on_a_posix_clock(&Dimensionless { alpha, p, supports: Supports::of(foundation, Ratios { eta, xi_v }) }, &common, strength).outcome();
        prop_assert_eq!(outcome.failure, None);
    });
}

/// A run under the record with a peak of `strength` times g tan α.
fn on_a_posix_clock(dimensionless: &Dimensionless, common: &Common, strength: f64) -> Run {
    let record = loma_prieta();
    let factor = strength * G * dimensionless.alpha.tan() / record.peak().acceleration.abs();
    run(dimensionless, common, Record { start_time: POSIX, ..record.scaled(factor) })
}
