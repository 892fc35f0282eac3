//! The measured work: a block, a pulse, a record, and the same runs in the core and through the FMU's functions.

pub mod library;

use std::hint::black_box;

use rocking_block::block::Regime;
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Excitation, Inputs, Pulse};
use rocking_block::numerics::Rate;
use rocking_block::simulation::{Initial, Settings, Simulation};
use rocking_block::system::dynamics::instant_of;
use rocking_block::system::instant::{Footing, State};
use rocking_records::ReadOptions;
use rocking_studies::spectrum::{FoundationCurve, ScaledFeatures, Sizes, Spectrum};

use crate::fmu::{Fmu, OK, reference};

/// The block of sine_eta40.
pub fn block(foundation: Foundation) -> Block {
    let common = Common::default();
    Block::from_dimensionless(
        &Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 }) },
        &common,
    )
    .expect("a block")
}

/// Loma Prieta 1989, of the USGS.
pub fn loma_prieta() -> Ground {
    let bytes = include_bytes!("../../../examples/records/np01002p_4225a_a.smc");
    let record = rocking_records::parse("np01002p_4225a_a.smc", bytes, &ReadOptions::default()).expect("a record");
    Ground { horizontal: Some(record), vertical: None }
}

/// The equations of motion at one instant, with the powers, as the integrator evaluates them.
pub fn right_hand_side(block: &Block, regime: Regime, excitation: &Excitation, time: f64, state: &State) -> Rate {
    let forcing = excitation.at(time);
    instant_of(block, block.foundation, regime, state.0, Footing::AT_START, forcing, |x| Rate {
        state: State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot]),
        quadratures: x.powers(block, regime, forcing).into(),
    })
}

/// Inputs and end of each interval of a record, prepared to exclude reading from the measurement.
pub fn intervals(ground: &Ground) -> Vec<(Inputs, f64)> {
    let end = ground.end().expect("a record");
    let (mut time, mut intervals) = (ground.start(), Vec::new());
    while time < end {
        let interval = ground.inputs_from(time);
        time = interval.1;
        intervals.push(interval);
    }
    intervals
}

/// A run under a record, from sample to sample.
pub fn run_record(intervals: &[(Inputs, f64)]) -> Simulation {
    let (inputs, _) = intervals[0];
    let block = block(Foundation::Viscoelastic);
    let mut simulation =
        Simulation::new(block, Settings::default(), Pulse::NONE, &Initial::default(), inputs.time, &inputs);
    for (inputs, until) in intervals {
        black_box(simulation.advance(*until, inputs, &mut |_| ()).expect("the run goes through"));
    }
    simulation
}

/// Parameters of the FMU for [`block`] on supports.
const BLOCK: [(&str, f64); 3] = [("dimensionless.alpha", 0.25), ("dimensionless.p", 1.0), ("dimensionless.eta", 40.0)];

/// An instance of the FMU with this block, initialized at `start` with a horizontal ground acceleration.
pub fn instance(start: f64, a_gx: f64) -> Fmu {
    let mut fmu = Fmu::new();
    for (name, value) in BLOCK.into_iter().chain([("a_gx", a_gx)]) {
        assert_eq!(fmu.set(reference(name), value), OK);
    }
    assert_eq!([fmu.setup(None, start, None), fmu.enter(), fmu.exit()], [OK; 3]);
    fmu
}

/// A rocking spectrum of `count` blocks, p = 0.5 … 4 rad/s.
pub fn spectrum(ground: Ground, count: u64) -> Spectrum {
    Spectrum {
        alpha: 0.25,
        common: Common::default(),
        in_proportion: ScaledFeatures::default(),
        bases: vec![FoundationCurve::viscoelastic(40.0, 0.1, 0.0)],
        sizes: Sizes { least: 0.5, greatest: 4.0, count },
        motions: vec![("record".into(), ground)],
        pulse: Pulse::NONE,
        settings: Settings::default(),
        duration: None,
        friction_demand: None,
        step: None,
    }
}
