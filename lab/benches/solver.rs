//! Times of the solver's parts and of whole runs: `cargo bench -p rocking-benches --bench solver`.

#[path = "../../tests/common/fmu.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod fmu;

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};

use common::library::PackedFmu;
use common::{block, instance, intervals, loma_prieta, right_hand_side, run_record};
use rocking_block::block::Foundation;
use rocking_block::block::Regime;
use rocking_block::excitation::{Excitation, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::{dop853::DenseStep, short::ShortStep};
use rocking_block::simulation::{Initial, Settings, Simulation};
use rocking_block::system::instant::State;
use rocking_studies::output::resumable::TableOptions;
use rocking_studies::output::runner::{self, Study};

const STATE: [f64; 4] = [0.02, -0.05, -0.004, 0.03];

fn excitation() -> Excitation {
    let inputs = Inputs { a_gx: Ramp { value: 2.0, rate: -1.0 }, a_gz: Ramp::held(0.5), ..Inputs::default() };
    Excitation::from_time(0.0, &inputs, &Pulse::NONE, &block(Foundation::Viscoelastic))
}

fn right_hand_sides(c: &mut Criterion) {
    let mut group = c.benchmark_group("right-hand side");
    let excitation = excitation();
    for (foundation, regimes) in [
        (Foundation::Viscoelastic, &[Regime::FullContact, Regime::TiltingRight, Regime::Separated][..]),
        (Foundation::Rigid, &[Regime::TiltingRight]),
    ] {
        let block = block(foundation);
        for &regime in regimes {
            group.bench_function(format!("{foundation:?}, {regime}"), |b| {
                let state = State::from(STATE);
                b.iter(|| right_hand_side(black_box(&block), regime, &excitation, black_box(0.1), black_box(&state)));
            });
        }
    }
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("one step");
    let (block, excitation, start) = (block(Foundation::Viscoelastic), excitation(), State::from(STATE));
    let rate = |time: f64, x: &State| right_hand_side(&block, Regime::TiltingRight, &excitation, time, x);
    let first = rate(0.0, &start);
    group
        .bench_function("of order 8", |b| b.iter(|| DenseStep::attempt(0.0, black_box(0.02), start, first, &rate).end));
    group.bench_function("of order 5", |b| {
        b.iter(|| ShortStep::attempt(0.0, black_box(0.002), start, first, &rate).end);
    });
}

/// The case sine_eta40 of tests/reference, with no stop but its end.
fn run_pulse() -> Simulation {
    let pulse = Pulse {
        shape: PulseShape::OneSine,
        amplitude: 6.2622,
        period: std::f64::consts::TAU / 5.0,
        start: 0.0,
        ..Pulse::NONE
    };
    let (block, inputs) = (block(Foundation::Viscoelastic), Inputs::default());
    let mut simulation = Simulation::new(block, Settings::default(), pulse, &Initial::default(), 0.0, &inputs);
    simulation.advance(10.0, &inputs, &mut |_| ()).expect("the run goes through");
    simulation
}

fn runs(c: &mut Criterion) {
    let mut group = c.benchmark_group("one run");
    let intervals = intervals(&loma_prieta());
    group.bench_function("pulse", |b| b.iter(run_pulse));
    group.bench_function("record", |b| b.iter(|| run_record(&intervals)));
    let packed = PackedFmu::of_build();
    group.bench_function("record, through fmi2DoStep", |b| b.iter(|| packed.run_record(&intervals)));
}

fn do_step(c: &mut Criterion) {
    let mut fmu = instance(0.0, 4.0);
    let (mut time, step) = (0.0, 1e-4);
    c.bench_function("fmi2DoStep of 0.1 ms", |b| {
        b.iter(|| {
            assert_eq!(fmu.step(time, step), fmu::OK);
            time += step;
        });
    });
}

fn spectra(c: &mut Criterion) {
    let mut group = c.benchmark_group("spectrum of 100 blocks");
    group.sample_size(10);
    let spectrum = common::spectrum(loma_prieta(), 100).checked().expect("blocks");
    for threads in [1, 2] {
        let pool = runner::pool(Some(threads)).expect("threads");
        group.bench_function(format!("threads: {threads}"), |b| {
            b.iter(|| {
                let folder = tempfile::tempdir().expect("a folder");
                let path = folder.path().join("spectrum.csv");
                let mut table = spectrum.open(&path, TableOptions::default()).expect("a table");
                runner::run(&spectrum, &pool, None, &mut table, None, |_, _| ()).expect("a spectrum");
            });
        });
    }
}

criterion_group!(benches, right_hand_sides, steps, runs, do_step, spectra);
criterion_main!(benches);
