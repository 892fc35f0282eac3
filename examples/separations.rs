//! How often the rules of docs/model.md err that say what became of a block before it lies on its side or stands still.
//!
//!     cargo run --release --example separations [RECORD ...]
//!
//! A thousand blocks at random, half of them under a pulse, half under a record (that in the folder `records`, and those that
//! are named), each run as in the paper's analysis, which ends at complete separation. Those that separate are run once
//! more and fly: did what the rule takes for overturned overturn, and what it does not, not? And those whose runs end because
//! the block has come down are followed further: does anything happen to them still?

use std::f64::consts::TAU;
use std::path::Path;

use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rocking_block::block::{Block, Common, Dimensionless};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::records::ground::Ground;
use rocking_block::records::{self, ReadOptions, Record};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_block::study::history::Run;
use rocking_block::study::outcome::{End, Outcome};
use rocking_block::study::sampling::LatinHypercube;
use rocking_block::study::sweep::Levels;

const BLOCKS: u32 = 1000;

/// The ranges of α (rad), p (rad/s), η, ξ_v, ε, the greatest acceleration over g tan α, and ω_p/p; those of the first
/// three and the last are sampled by their logarithms.
const RANGES: [(f64, f64, bool); 7] = [
    (0.05, 0.35, true),
    (0.4, 6.0, true),
    (20.0, 300.0, true),
    (0.02, 0.5, false),
    (0.0, 0.6, false),
    (1.0, 8.0, false),
    (1.0, 12.0, true),
];

/// What a block did in its two or three runs.
struct Made {
    pulse: bool,
    paper: Outcome,
    flying: Option<Outcome>,
    longer: Option<Outcome>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let embedded = concat!(env!("CARGO_MANIFEST_DIR"), "/records/np01002p_4225a_a.smc").to_string();
    let paths = std::iter::once(embedded).chain(std::env::args().skip(1));
    let options = ReadOptions::default();
    let records = paths.map(|path| records::read(Path::new(&path), &options)).collect::<Result<Vec<_>, _>>()?;
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
        *value = Levels::Range { from, to, logarithmic }.at(cube.coordinate(number, direction));
    }
    let [alpha, p, eta, xi_v, epsilon, strength, ratio] = values;
    let common = Common { epsilon, ..Common::default() };
    let block = Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).expect("a valid block");
    let greatest = strength * common.gravity * alpha.tan();
    let (pulse, ground) = if number.is_multiple_of(2) {
        let shapes = [PulseShape::OneSine, PulseShape::OneCosine, PulseShape::C1, PulseShape::C2];
        let shape = shapes[number as usize / 2 % shapes.len()];
        (Pulse { shape, amplitude: greatest, period: TAU / (ratio * p), start: 0.0 }, Ground::default())
    } else {
        let record = records[number as usize / 2 % records.len()].clone();
        let factor = greatest / record.peak().acceleration.abs();
        (Pulse::NONE, Ground { horizontal: Some(record.scaled(factor)), vertical: None })
    };
    let run = Run {
        block,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse,
        ground,
        duration: None,
        output_step: f64::INFINITY,
    };
    let paper = run.outcome();
    let flies = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let separated = paper.flights.count > 0;
    let flying = separated.then(|| Run { settings: flies, ..run.clone() }.outcome());
    let longer = (paper.end == End::Completed)
        .then(|| Run { duration: Some(paper.end_time - run.ground.start() + 100.0 / p), ..run.clone() }.outcome());
    Made { pulse: number.is_multiple_of(2), paper, flying, longer }
}
