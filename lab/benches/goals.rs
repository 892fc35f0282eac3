//! Overheads around the solver, as ratios of times measured in turn: `cargo bench -p rocking-benches --bench goals [-- RECORD [BLOCKS]]`.
//!
//! RECORD replaces the embedded accelerogram; BLOCKS is the number of blocks of the spectrum. The FMU is the one that `cargo run --release`
//! has packed; `--profile release` compares it with the solver as that command compiles it.

#[path = "../../tests/common/fmu.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod fmu;

mod common;

use std::f64::consts::FRAC_PI_3;
use std::hint::black_box;
use std::sync::Mutex;
use std::time::Instant;

use common::library::PackedFmu;
use common::{block, instance, intervals, loma_prieta, right_hand_side, run_record};
use rocking_block::block::Foundation;
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Excitation, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{Initial, Settings, Simulation};
use rocking_block::system::instant::State;
use rocking_records::ReadOptions;
use rocking_studies::output::resumable::{TableHeader, TableOptions};
use rocking_studies::output::runner::{self, Study, StudyRows};
use rocking_studies::run::batch::{LaneUse, in_lanes};
use rocking_studies::spectrum::{CheckedSpectrum, FoundationCurve, Sizes, Spectrum};

const ROUNDS: usize = 7;

/// Least times (s) of the tasks, which run in turn.
fn least<const N: usize>(rounds: usize, mut tasks: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut least = [f64::INFINITY; N];
    for _ in 0..rounds {
        for (least, task) in least.iter_mut().zip(&mut tasks) {
            let start = Instant::now();
            task();
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    least
}

fn main() {
    // cargo bench adds its own argument.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let ground = arguments.first().map_or_else(loma_prieta, |path| {
        let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let record =
            rocking_records::parse(path, &bytes, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        Ground { horizontal: Some(record), vertical: None }
    });
    let blocks = arguments.get(1).map_or(1000, |text| text.parse().expect("BLOCKS, a number"));

    record_through_the_fmu(&ground);
    short_steps_of_the_fmu();
    spectrum(ground.clone(), blocks);
    many_threads(ground.clone(), blocks);
    lanes(ground, blocks);
}

fn record_through_the_fmu(ground: &Ground) {
    let intervals = intervals(ground);
    let packed = PackedFmu::of_build();
    let [core, fmu] = least(
        30 * ROUNDS,
        [
            &mut || {
                black_box(run_record(&intervals));
            },
            &mut || packed.run_record(&intervals),
        ],
    );
    println!(
        "one run of {} intervals: core {:.3} ms, through fmi2DoStep {:.3} ms",
        intervals.len(),
        1e3 * core,
        1e3 * fmu
    );
    println!("    ratio {:.3}", fmu / core);
}

/// Compares steps of 0.1 ms with a raised corner with the right-hand side at the same state.
fn short_steps_of_the_fmu() {
    const STEPS: u32 = 10_000;
    const STEP: f64 = 1e-4;
    let block = block(Foundation::Viscoelastic);
    let inputs = Inputs { a_gx: Ramp::held(4.0), ..Inputs::default() };
    let mut simulation = Simulation::new(block, Settings::default(), Pulse::NONE, &Initial::default(), 0.0, &inputs);
    for k in 1..=STEPS {
        simulation.advance(f64::from(k) * STEP, &inputs, &mut |_| ()).expect("the run goes through");
    }
    let evaluations = simulation.counts().evaluations as f64 / f64::from(STEPS);
    let excitation = Excitation::from_time(0.0, &inputs, &Pulse::NONE, &block);
    let (regime, state) = (simulation.regime(), *simulation.state());
    // Independent evaluations overlap in the processor; those of a step wait for each other.
    let mut alone = || {
        for k in 0..STEPS {
            let time = black_box(f64::from(k) * STEP);
            black_box(right_hand_side(&block, regime, &excitation, time, black_box::<&State>(&state)));
        }
    };
    let mut in_turn = || {
        let mut x = state;
        for k in 0..STEPS {
            let time = black_box(f64::from(k) * STEP);
            x = x + right_hand_side(&block, regime, &excitation, time, &x).state * 1e-12;
        }
        black_box(x);
    };
    let mut steps = || {
        let mut fmu = instance(0.0, 4.0);
        for k in 0..STEPS {
            assert_eq!(fmu.step(f64::from(k) * STEP, STEP), fmu::OK);
        }
    };
    let [alone, in_turn, step] =
        least(ROUNDS, [&mut alone, &mut in_turn, &mut steps]).map(|time| 1e9 * time / f64::from(STEPS));
    println!("fmi2DoStep of 0.1 ms: {step:.0} ns, of {evaluations:.2} evaluations");
    println!("    one right-hand side alone {alone:.1} ns, after another one {in_turn:.1} ns");
    let ratio = |rate: f64| step / (evaluations * rate);
    println!("    ratio of the step to its evaluations {:.2}, {:.2}", ratio(alone), ratio(in_turn));
}

fn spectrum(ground: Ground, blocks: u64) {
    let made = |blocks: u64, threads: usize, lanes: usize| {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("spectrum.csv");
        let spectrum = common::spectrum(ground.clone(), blocks).checked().expect("blocks");
        let pool = runner::pool(Some(threads)).expect("threads");
        let mut table = spectrum.open(&path, TableOptions::default()).expect("a table");
        runner::run(&spectrum, &pool, VectorWidth::at_most(lanes), &mut table, None, |_, _| ())
            .expect("the spectrum is made");
    };
    made(blocks / 10, 2, 1);
    let before = peak_memory();
    made(blocks, 2, 1);
    let after = peak_memory();
    let single = common::spectrum(ground.clone(), blocks).checked().expect("blocks");
    let rounds = if blocks > 2000 { 2 } else { 3 };
    let [alone, one, two] = least(
        rounds,
        [
            &mut || {
                (0..blocks).for_each(|row| {
                    black_box(single.run(row).outcome());
                })
            },
            &mut || made(blocks, 1, 1),
            &mut || made(blocks, 2, 1),
        ],
    );
    println!("a spectrum of {blocks} blocks: single runs {alone:.2} s, on one thread {one:.2} s, on two {two:.2} s");
    println!("    ratio of two threads to one {:.3}, of one to the single runs {:.3}", one / two, one / alone);
    if let (Some(before), Some(after)) = (before, after) {
        println!("    peak memory: {before} kB with {} blocks, {after} kB with {blocks}", blocks / 10);
    }
}

/// Prints the CPU time of a block in 1, 4 and 8 lanes, its row included, as rows of a table in Markdown.
fn lanes(ground: Ground, blocks: u64) {
    let supports = common::spectrum(ground, blocks);
    let sine = Pulse { shape: PulseShape::OneSine, amplitude: 4.375, period: FRAC_PI_3, ..Pulse::NONE };
    let under_sine = Spectrum {
        alpha: 0.2,
        sizes: Sizes { least: 1.0, greatest: 4.0, ..supports.sizes },
        motions: vec![("pulse".into(), Ground::default())],
        pulse: sine,
        duration: Some(6.0),
        ..supports.clone()
    };
    let smaller = Sizes { least: 0.5, greatest: 1.2, ..supports.sizes };
    let cases = [
        ("supports, a record", supports.clone()),
        (
            "rigid base, the record",
            Spectrum { sizes: Sizes { greatest: 8.0, ..supports.sizes }, ..on_rigid_base(&supports) },
        ),
        ("supports, one sine", under_sine.clone()),
        ("rigid base, one sine, most overturn", on_rigid_base(&under_sine)),
        ("rigid base, one sine, none overturns", Spectrum { sizes: smaller, ..on_rigid_base(&under_sine) }),
    ];
    println!("| {blocks} blocks | tolerance | 1 lane | 4 | 8 | 1 over 4 | 1 over 8 | steps alone |");
    for (name, case) in cases {
        for tolerance in [Settings::OF_STUDIES, Settings::default().tolerance] {
            let case = Spectrum { settings: Settings { tolerance, ..case.settings }, ..case.clone() };
            let case = case.checked().expect("blocks");
            let mut least = [f64::INFINITY; 3];
            for _ in 0..ROUNDS {
                for (least, width) in least.iter_mut().zip([1, 4, 8].map(VectorWidth::at_most)) {
                    *least = least.min(cpu_time(&case, width) / blocks as f64);
                }
            }
            let width = VectorWidth::at_most(4).expect("vectors");
            let LaneUse { in_lanes, alone, .. } = in_lanes(width, (0..blocks).map(|row| case.run(row)), || ()).1;
            let [one, four, eight] = least.map(|time| 1e6 * time);
            println!(
                "| {name} | {tolerance:e} | {one:.1} µs | {four:.1} µs | {eight:.1} µs | {:.2} | {:.2} | {:.1} % |",
                one / four,
                one / eight,
                100.0 * alone as f64 / (in_lanes + alone) as f64
            );
        }
    }
}

fn on_rigid_base(spectrum: &Spectrum) -> Spectrum {
    Spectrum { bases: vec![FoundationCurve::rigid(0.0, 1.0)], ..spectrum.clone() }
}

/// CPU time (s) of the rows of a spectrum, made on this thread.
fn cpu_time(spectrum: &CheckedSpectrum, width: Option<VectorWidth>) -> f64 {
    const BATCH: usize = 512;
    let before = thread_seconds().expect("a system that reports CPU times");
    for from in (0..spectrum.rows()).step_by(BATCH) {
        black_box(spectrum.make_range(from..spectrum.rows().min(from + BATCH as u64), width));
    }
    thread_seconds().expect("as before") - before
}

/// Peak memory of this process (kB), where the system reports it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix(" kB")?.trim().parse().ok()
}

/// A study that measures its batches.
struct Measured {
    study: CheckedSpectrum,
    /// First row and CPU time (s) of each batch.
    batches: Mutex<Vec<(u64, f64)>>,
}

impl Study for Measured {
    fn header(&self) -> TableHeader {
        self.study.header()
    }

    fn rows(&self) -> u64 {
        self.study.rows()
    }

    fn runs_in_a_row(&self) -> u64 {
        self.study.runs_in_a_row()
    }

    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        let (first, before) = (numbers[0], thread_seconds());
        let rows = self.study.make(numbers, width);
        if let (Some(before), Some(after)) = (before, thread_seconds()) {
            self.batches.lock().expect("no thread fails").push((first, after - before));
        }
        rows
    }
}

/// CPU time of this thread (s), where the system reports it.
fn thread_seconds() -> Option<f64> {
    let line = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// Runs a spectrum on more threads than this machine has cores, and computes their idle time if each had its own: a thread takes the
/// next batch whenever it is free.
fn many_threads(ground: Ground, blocks: u64) {
    for threads in [2, 16] {
        let folder = tempfile::tempdir().expect("a folder");
        let study = Measured {
            study: common::spectrum(ground.clone(), blocks).checked().expect("blocks"),
            batches: Mutex::default(),
        };
        let pool = runner::pool(Some(threads)).expect("threads");
        let mut table = study.open(&folder.path().join("table.csv"), TableOptions::default()).expect("a table");
        runner::run(&study, &pool, VectorWidth::at_most(8), &mut table, None, |_, _| ()).expect("the spectrum is made");
        let mut batches = study.batches.into_inner().expect("no thread fails");
        batches.sort_unstable_by_key(|(first, _)| *first);
        let mut free = vec![0.0; threads];
        for (_, seconds) in &batches {
            *free.iter_mut().min_by(|a, b| f64::total_cmp(a, b)).expect("a thread") += seconds;
        }
        let sum: f64 = batches.iter().map(|(_, seconds)| seconds).sum();
        let longest = batches.iter().map(|(_, seconds)| *seconds).fold(0.0, f64::max);
        let end = free.iter().copied().fold(0.0, f64::max);
        println!(
            "{threads} threads: {} batches in {sum:.2} s of CPU time, the longest {:.2} times the mean; {:.1} % of the threads' time idle",
            batches.len(),
            longest * batches.len() as f64 / sum,
            100.0 * (1.0 - sum / (threads as f64 * end))
        );
        if let Some(memory) = peak_memory() {
            println!("    peak memory of all so far: {memory} kB");
        }
    }
}
