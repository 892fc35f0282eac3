//! One run of a case, whose instructions `scripts/dev/instructions` counts:
//! `one_run (sine | record | flight | through-fmu | space | reference RECORD) [TOLERANCE]`.
//!
//! `through-fmu` is `record` through the functions of the FMU of FMI 2.0. `reference` runs the block of most cases of tests/reference
//! under a record that may not be redistributed. `space` is a block on four feet under pulses in two directions.

#[path = "../tests/common/fmu.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod fmu;

use fmu::{Fmu, OK, reference};
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::space::{
    DirectedPulse, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceRun, SpaceSetup,
};
use rocking_records::ReadOptions;

const RECORD: &[u8] = include_bytes!("records/np01002p_4225a_a.smc");

fn block(alpha: f64, p: f64, eta: f64, xi_v: f64, epsilon: f64) -> Block {
    let common = Common { epsilon, ..Common::default() };
    Block::from_dimensionless(
        &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
        &common,
    )
    .expect("a block")
}

/// Callgrind counts inside it, so that it is never inlined.
#[inline(never)]
fn counted(simulation: &mut Simulation, ground: &Ground, end: f64) -> f64 {
    run(simulation, ground, end)
}

/// Steps from stop to stop of the ground motion, and returns the time of the end (s).
#[inline(always)]
fn run(simulation: &mut Simulation, ground: &Ground, end: f64) -> f64 {
    while simulation.time() < end {
        let (inputs, until) = ground.inputs_from(simulation.time());
        let progress = simulation.advance(until.min(end), &inputs, &mut |_| ()).expect("the case runs");
        if let Progress::Ended(_, time) = progress {
            return time;
        }
    }
    end
}

/// Sets the input and its rate at each sample, and steps to the next one, as an importer does. Never inlined, as above.
#[inline(never)]
fn counted_through_fmu(fmu: &mut Fmu, input: u32, intervals: &[(Inputs, f64)]) {
    for (Inputs { time, a_gx, .. }, until) in intervals {
        assert_eq!(fmu.set_reals(&[input], &[a_gx.value]), OK);
        assert_eq!(fmu.set_rates(&[input], &[1], &[a_gx.rate]), OK);
        assert_eq!(fmu.step(*time, until - time), OK);
    }
}

/// Runs `record` through the functions of the FMU.
fn run_through_fmu(ground: &Ground, end: f64, tolerance: f64) {
    let (mut time, mut intervals) = (0.0, Vec::new());
    while time < end {
        let (inputs, until) = ground.inputs_from(time);
        intervals.push((inputs, until.min(end)));
        time = until;
    }
    let (mut fmu, input) = (Fmu::new(), reference("a_gx"));
    let block = [("alpha", 0.15), ("p", 2.0), ("eta", 40.0), ("xi_v", 0.2)];
    for (name, value) in block {
        assert_eq!(fmu.set(reference(&format!("dimensionless.{name}")), value), OK);
    }
    assert_eq!(fmu.set(input, intervals[0].0.a_gx.value), OK);
    assert_eq!([fmu.setup(Some(tolerance), 0.0, None), fmu.enter(), fmu.exit()], [OK; 3]);
    counted_through_fmu(&mut fmu, input, &intervals);
}

/// Steps to a time (s). Never inlined, as above.
#[inline(never)]
fn counted_in_space(run: &mut SpaceRun, end: f64) {
    run.advance(end, &SpaceInputs::default(), &mut |_| ()).expect("the case runs");
}

/// Runs `space`.
fn run_in_space(tolerance: f64) {
    let end = 5.0;
    let pulse = |amplitude, period, start, azimuth| {
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, start, ..Pulse::NONE };
        DirectedPulse::horizontal(pulse, azimuth)
    };
    let setup = SpaceSetup {
        body: SpaceBody::new(&SpaceParameters::default()).expect("a block"),
        settings: Settings { tolerance, on_separation: OnSeparation::Fly, ..Settings::default() },
        pulses: [pulse(3.7, 1.05, 0.0, 0.0), pulse(3.0, 0.84, 0.2, 1.57), DirectedPulse::NONE],
    };
    let mut run = SpaceRun::new(setup, &SpaceInitial { vertical: Some([0.0; 2]), ..SpaceInitial::default() }, 0.0);
    counted_in_space(&mut run, end);
    let counts = run.state().counts;
    println!("{end} {} {}", counts.evaluations, counts.landings);
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_default();
    if case == "space" {
        let tolerance = arguments.next().map_or(1e-8, |text| text.parse().expect("a tolerance"));
        return run_in_space(tolerance);
    }
    let sine = |amplitude, period| Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE };
    let (block, pulse, ground, end) = match case.as_str() {
        "sine" => (block(0.25, 1.0, 40.0, 0.1, 0.0), sine(4.0, 1.2566), Ground::default(), 10.0),
        "flight" => (block(0.3, 2.5, 80.0, 0.02, 0.6), sine(4.0, 0.8), Ground::default(), 4.0),
        "record" | "through-fmu" => {
            let record =
                rocking_records::parse("np01002p_4225a_a.smc", RECORD, &ReadOptions::default()).expect("a record");
            let end = record.start_time + record.duration();
            let ground = Ground { horizontal: Some(record), vertical: None };
            (block(0.15, 2.0, 40.0, 0.2, 0.0), Pulse::NONE, ground, end)
        }
        "reference" => {
            let path = arguments.next().expect("a record");
            let record = rocking_records::read(path.as_ref(), &ReadOptions::default()).expect("a record");
            let end = record.start_time + record.duration();
            let ground = Ground { horizontal: Some(record), vertical: None };
            (block(0.25, 1.0, 40.0, 0.1, 0.0), Pulse::NONE, ground, end)
        }
        other => panic!("case \"{other}\"; expected sine, record, flight, through-fmu, space or reference"),
    };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let tolerance = arguments.next().map_or(settings.tolerance, |text| text.parse().expect("a tolerance"));
    let settings = Settings { tolerance, ..settings };
    let (inputs, _) = ground.inputs_from(0.0);
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let ended = if case == "through-fmu" {
        // The FMU does not report its evaluations, which are those of the core.
        run_through_fmu(&ground, end, tolerance);
        run(&mut simulation, &ground, end)
    } else {
        counted(&mut simulation, &ground, end)
    };
    let counts = simulation.counts();
    println!("{ended} {} {}", counts.evaluations, counts.impacts);
}
