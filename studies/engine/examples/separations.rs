//! Error rates of the rules of docs/unit/model.md that decide the outcome of a run early.
//!
//!     cargo run --release -p rocking-studies --example separations [RECORD ...]
//!
//! A thousand random blocks run as in the paper's analysis, which ends at complete separation: half under a pulse, half under a
//! record (the embedded one, and those given). Blocks that separate run once more and fly: does the rule predict
//! which of them overturn? Runs that ended because the block had come down continue: does the outcome change?

use std::f64::consts::TAU;
use std::path::Path;

use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_records::{ReadOptions, Record};
use rocking_studies::run::Run;
use rocking_studies::run::outcome::{End, Outcome};
use rocking_studies::statistics::sampling::LatinHypercube;
use rocking_studies::sweep::parameters::ParameterValues;

const BLOCKS: u32 = 1000;

/// The ranges of α (rad), p (rad/s), η, ξ_v, ε, the largest acceleration over g tan α, and ω_p/p. The first three and the last
/// are sampled logarithmically.
const RANGES: [(f64, f64, bool); 7] = [
    (0.05, 0.35, true),
    (0.4, 6.0, true),
    (20.0, 300.0, true),
    (0.02, 0.5, false),
    (0.0, 0.6, false),
    (1.0, 8.0, false),
    (1.0, 12.0, true),
];

/// The outcomes of a block's two or three runs.
struct Made {
    pulse: bool,
    paper: Outcome,
    flying: Option<Outcome>,
    longer: Option<Outcome>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let embedded = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records/np01002p_4225a_a.smc").to_string();
    let paths = std::iter::once(embedded).chain(std::env::args().skip(1));
    let options = ReadOptions::default();
    let records = paths.map(|path| rocking_records::read(Path::new(&path), &options)).collect::<Result<Vec<_>, _>>()?;
    let cube = LatinHypercube::new(BLOCKS, RANGES.len(), 1);
    let made: Vec<Made> = (0..BLOCKS).into_par_iter().map(|number| make(&cube, number, &records)).collect();
    for (name, pulse) in [("pulses", true), ("records", false)] {
        let of: Vec<&Made> = made.iter().filter(|made| made.pulse == pulse).collect();
        let count = |rule: End, flown: End| {
            let is = |made: &&&Made| {
                made.paper.end == rule && made.flying.as_ref().is_some_and(|flying| flying.end == flown)
            };
            of.iter().filter(is).count()
        };
        println!(
            "{name}: {} blocks, {} failed",
            of.len(),
            of.iter().filter(|made| made.paper.end == End::Failed).count()
        );
        println!(
            "  separated beyond alpha on the way over: {} overturn, {} stand",
            count(End::Overturned, End::Overturned),
            count(End::Overturned, End::Completed)
        );
        println!(
            "  separated otherwise:                    {} overturn, {} stand",
            count(End::Separated, End::Overturned),
            count(End::Separated, End::Completed)
        );
        let pairs = || of.iter().filter_map(|made| made.longer.as_ref().map(|longer| (&made.paper, longer)));
        let changed = pairs().filter(|(paper, longer)| paper.end != longer.end).count();
        let rise = |value: fn(&Outcome) -> f64| {
            pairs().map(|(paper, longer)| value(longer) / value(paper) - 1.0).fold(0.0, f64::max)
        };
        println!(
            "  came down: {}, of which {changed} end otherwise within 100/p; greatest rise of a peak since: theta {:.1e}, N {:.1e}, H {:.1e}",
            pairs().count(),
            rise(|outcome| outcome.peaks.theta),
            rise(|outcome| outcome.peaks.reaction),
            rise(|outcome| outcome.peaks.horizontal)
        );
    }
    Ok(())
}

fn make(cube: &LatinHypercube, number: u32, records: &[Record]) -> Made {
    let mut values = [0.0; RANGES.len()];
    for (direction, (value, (from, to, logarithmic))) in values.iter_mut().zip(RANGES).enumerate() {
        *value = ParameterValues::Range { from, to, logarithmic }.at(cube.coordinate(number, direction));
    }
    let [alpha, p, eta, xi_v, epsilon, strength, ratio] = values;
    let common = Common { epsilon, ..Common::default() };
    let block = Block::from_dimensionless(
        &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
        &common,
    )
    .expect("a valid block");
    let greatest = strength * common.gravity * alpha.tan();
    let (pulse, ground) = if number.is_multiple_of(2) {
        let shapes = [PulseShape::OneSine, PulseShape::OneCosine, PulseShape::C1, PulseShape::C2];
        let shape = shapes[number as usize / 2 % shapes.len()];
        (Pulse { shape, amplitude: greatest, period: TAU / (ratio * p), start: 0.0, ..Pulse::NONE }, Ground::default())
    } else {
        let record = records[number as usize / 2 % records.len()].clone();
        let factor = greatest / record.peak().acceleration.abs();
        (Pulse::NONE, Ground { horizontal: Some(record.scaled(factor)), vertical: None })
    };
    let run = Run { pulse, ground, ..Run::at_rest(block, Settings::default()) };
    let paper = run.outcome();
    let flies = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let separated = paper.flights.count > 0;
    let flying = separated.then(|| Run { settings: flies, ..run.clone() }.outcome());
    let longer = (paper.end == End::Completed)
        .then(|| Run { duration: Some(paper.end_time - run.start() + 100.0 / p), ..run.clone() }.outcome());
    Made { pulse: number.is_multiple_of(2), paper, flying, longer }
}
