//! Blocks of all sizes on several foundations under several ground motions → a table of peak rotations.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`statistics`] | the table of a spectrum → outcomes of each curve, statistics over the ground motions |

pub mod statistics;

use std::f64::consts::TAU;
use std::ops::Range;

use crate::output::fields::Fields;
use crate::output::resumable::TableHeader;
use crate::output::runner::{Study, StudyRow};
use crate::run::Run;
use crate::run::batch::outcomes;
use crate::run::outcome::{Holds, Outcome};
use crate::run::sliding;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, BlockError, Common, Dimensionless, Foundation};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::ground::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::Settings;

/// The foundation of a block, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FoundationParameters {
    /// A rigid base with the ratio e of angular velocities from ε, eq. (6), times a factor.
    Rigid {
        /// Restitution ε (1).
        epsilon: f64,
        /// Factor on Housner's e (1).
        restitution_factor: f64,
    },
    /// Viscoelastic supports.
    Viscoelastic {
        /// Stiffness ratio η (1).
        eta: f64,
        /// Damping ratio ξ_v (1).
        xi_v: f64,
        /// Restitution ε (1).
        epsilon: f64,
    },
}

impl FoundationParameters {
    /// Housner's rigid base: ε = 0 and his e.
    pub const HOUSNER: FoundationParameters = FoundationParameters::Rigid { epsilon: 0.0, restitution_factor: 1.0 };
}

impl std::fmt::Display for FoundationParameters {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FoundationParameters::Rigid { epsilon: 0.0, restitution_factor: 1.0 } => write!(f, "rigid"),
            FoundationParameters::Rigid { epsilon, restitution_factor: 1.0 } => write!(f, "rigid,{epsilon}"),
            FoundationParameters::Rigid { epsilon, restitution_factor } => {
                write!(f, "rigid,{epsilon},{restitution_factor}")
            }
            FoundationParameters::Viscoelastic { eta, xi_v, epsilon } => write!(f, "{eta},{xi_v},{epsilon}"),
        }
    }
}

/// Frequency parameters p (rad/s), evenly spaced in 1/p, from the greatest to the least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Least p (rad/s).
    pub least: f64,
    /// Greatest p (rad/s).
    pub greatest: f64,
    /// Number of sizes, at least two.
    pub count: u64,
}

impl Sizes {
    /// The p (rad/s) of a size, numbered from 0.
    pub fn p(&self, number: u64) -> f64 {
        let last = self.count - 1;
        match number {
            0 => self.greatest,
            _ if number == last => self.least,
            _ => {
                let fraction = number as f64 / last as f64;
                1.0 / ((1.0 - fraction) / self.greatest + fraction / self.least)
            }
        }
    }
}

/// Eccentricity and ties in proportion to each block, so that blocks of all sizes are similar. The units are R0 for places and slack,
/// M g/R0 for stiffness, M g for pretension and strength, and M p for damping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InProportion {
    /// Eccentricity over half the width, e_x/b (1).
    pub eccentricity: f64,
    /// Ties, with all their numbers in these units.
    pub ties: Vec<Tie>,
}

impl InProportion {
    /// The proportions of a block.
    pub fn of(block: &Block) -> InProportion {
        let ties = block.ties().iter().map(|tie| scaled(tie, block, |value, unit| value / unit));
        InProportion { eccentricity: block.eccentricity / block.b, ties: ties.collect() }
    }

    /// The block with `common` and these proportions.
    fn block(&self, dimensionless: &Dimensionless, common: &Common) -> Result<Block, BlockError> {
        let even = Block::from_dimensionless(dimensionless, common)?;
        if *self == InProportion::default() {
            return Ok(even);
        }
        let common = Common { eccentricity: self.eccentricity * even.b, ..*common };
        let block = Block::from_dimensionless(dimensionless, &common)?;
        let ties: Vec<Tie> = self.ties.iter().map(|tie| scaled(tie, &block, |value, unit| value * unit)).collect();
        block.with_ties(&ties)
    }
}

/// A tie whose numbers are made by `change` from their values and their units for this block.
fn scaled(tie: &Tie, block: &Block, change: impl Fn(f64, f64) -> f64) -> Tie {
    let (length, force) = (block.r0, block.mass * block.gravity);
    Tie {
        block: tie.block.map(|place| change(place, length)),
        ground: tie.ground.map(|place| change(place, length)),
        stiffness: change(tie.stiffness, force / length),
        pretension: change(tie.pretension, force),
        slack: change(tie.slack, length),
        damping: change(tie.damping, block.mass * block.p),
        strength: change(tie.strength, force),
    }
}

/// A spectrum: each ground motion × each foundation × each size is a row.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Slenderness angle α (rad).
    pub alpha: f64,
    /// Mass, shape factor, gravity and friction; `bases` and `in_proportion` have the rest.
    pub common: Common,
    /// Eccentricity and ties.
    pub in_proportion: InProportion,
    /// Foundations.
    pub bases: Vec<FoundationParameters>,
    /// Sizes.
    pub sizes: Sizes,
    /// Ground motions with their names.
    pub motions: Vec<(String, Ground)>,
    /// Pulse added to each ground motion.
    pub pulse: Pulse,
    /// Settings of the integration.
    pub settings: Settings,
    /// Duration of each run (s); without it, until the block has come down.
    pub duration: Option<f64>,
    /// Longest time between two stops (s); without it, only record samples and pulse ends are stops.
    pub step: Option<f64>,
    /// Friction demand (1) of the column with the longest time above it, if any.
    pub friction_demand: Option<f64>,
}

/// The ground motion, the foundation and the size of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowInputs {
    /// Number of the ground motion.
    pub motion: usize,
    /// Number of the foundation.
    pub base: usize,
    /// Frequency parameter p (rad/s).
    pub p: f64,
}

impl Spectrum {
    /// Names and units of the columns that identify the block, after the row's number.
    const BLOCK_COLUMNS: [&'static str; 9] = [
        "motion",
        "foundation",
        "eta [1]",
        "xi_v [1]",
        "epsilon [1]",
        "restitution_factor [1]",
        "p [rad/s]",
        "2pi/p [s]",
        "omega_p/p [1]",
    ];

    /// Names and units of the columns after the row's number.
    pub fn columns() -> impl Iterator<Item = &'static str> {
        Spectrum::BLOCK_COLUMNS.into_iter().chain(Outcome::COLUMNS)
    }

    /// The position of a column, not counting the row's number.
    pub fn column(name: &str) -> Option<usize> {
        Spectrum::columns().position(|column| column == name)
    }

    /// Checks that all rows have valid blocks.
    pub fn check(&self) -> Result<(), BlockError> {
        for &base in &self.bases {
            for p in [self.sizes.greatest, self.sizes.least] {
                self.block(base, p)?;
            }
        }
        Ok(())
    }

    /// The inputs of a row.
    pub fn inputs(&self, row: u64) -> RowInputs {
        let curve = (row / self.sizes.count) as usize;
        let (motion, base) = (curve / self.bases.len(), curve % self.bases.len());
        RowInputs { motion, base, p: self.sizes.p(row % self.sizes.count) }
    }

    /// The block of this size on a foundation.
    pub fn block(&self, base: FoundationParameters, p: f64) -> Result<Block, BlockError> {
        // The rigid base reads neither η nor ξ_v; any valid values will do.
        let (foundation, eta, xi_v, epsilon, restitution_factor) = match base {
            FoundationParameters::Rigid { epsilon, restitution_factor } => {
                (Foundation::Rigid, 40.0, 0.1, epsilon, restitution_factor)
            }
            FoundationParameters::Viscoelastic { eta, xi_v, epsilon } => {
                (Foundation::Viscoelastic, eta, xi_v, epsilon, 1.0)
            }
        };
        let common = Common { epsilon, foundation, restitution_factor, ..self.common };
        self.in_proportion.block(&Dimensionless { alpha: self.alpha, p, eta, xi_v }, &common)
    }

    /// The run of a row.
    pub fn run(&self, row: u64) -> Result<Run, BlockError> {
        let RowInputs { motion, base, p } = self.inputs(row);
        let block = self.block(self.bases[base], p)?;
        let ground = &self.motions[motion].1;
        Ok(Run {
            pulse: self.pulse,
            ground: ground.clone(),
            duration: self.duration,
            output_step: self.step.unwrap_or(f64::INFINITY),
            ..Run::at_rest(block, self.settings)
        })
    }
}

impl Study for Spectrum {
    fn header(&self) -> TableHeader {
        let Common { mass, gamma, gravity, friction, .. } = self.common;
        let friction = if friction > 0.0 { format!(", friction = {friction}") } else { String::new() };
        let Sizes { least, greatest, count } = self.sizes;
        let mut study = vec![
            concat!("rocking-block ", env!("CARGO_PKG_VERSION"), " spectrum").to_string(),
            format!("alpha = {}, mass = {mass}, gamma = {gamma}, g = {gravity}{friction}", self.alpha),
            format!("p = {least} to {greatest}, {count} sizes"),
        ];
        let InProportion { eccentricity, ties } = &self.in_proportion;
        if *eccentricity != 0.0 {
            study.push(format!("e_x/b = {eccentricity}"));
        }
        study.extend(ties.iter().map(|tie| format!("tie in R0, M g and p: {tie:?}")));
        study.extend(self.bases.iter().map(|base| format!("foundation {base}")));
        for (name, ground) in &self.motions {
            study.push(format!("motion {name}: {}", ground.fingerprint()));
        }
        if self.pulse.shape != PulseShape::None {
            let Pulse { shape, amplitude, period, start, phase, cycles } = self.pulse;
            let mut pulse = format!("pulse {shape:?}, amplitude = {amplitude}, period = {period}, start = {start}");
            if shape == PulseShape::Gabor {
                pulse.push_str(&format!(", phase = {phase}, cycles = {cycles}"));
            }
            study.push(pulse);
        }
        study.push(format!(
            "tolerance = {:e}, on_separation = {:?}, duration = {}, step = {}",
            self.settings.tolerance,
            self.settings.on_separation,
            self.duration.map_or("until the block has come down".into(), |value| value.to_string()),
            self.step.map_or("none".into(), |value| value.to_string())
        ));
        let columns = Spectrum::columns().map(String::from).chain(self.holds().columns());
        let columns = columns.chain(self.friction_demand.map(sliding::heading)).collect();
        TableHeader { study, columns }
    }

    fn rows(&self) -> u64 {
        (self.motions.len() * self.bases.len()) as u64 * self.sizes.count
    }

    fn runs_in_a_row(&self) -> u64 {
        1
    }

    fn make(&self, numbers: Range<u64>, width: Option<VectorWidth>) -> Vec<StudyRow> {
        let outcomes = outcomes(width, numbers.clone().map(|number| self.valid_run(number)), || ());
        numbers.zip(&outcomes).map(|(number, outcome)| self.row_of(number, outcome)).collect()
    }
}

impl Spectrum {
    /// Makes a row, and returns its outcome too.
    pub fn made(&self, number: u64) -> (StudyRow, Outcome) {
        let outcome = self.valid_run(number).outcome();
        (self.row_of(number, &outcome), outcome)
    }

    /// Friction and ties of the blocks.
    fn holds(&self) -> Holds {
        Holds { friction: self.common.friction > 0.0, ties: self.in_proportion.ties.len() }
    }

    /// The run of a row of a spectrum that has passed [`Spectrum::check`].
    fn valid_run(&self, number: u64) -> Run {
        self.run(number).unwrap_or_else(|error| unreachable!("{error}"))
    }

    /// The row of a run with this outcome.
    fn row_of(&self, number: u64, outcome: &Outcome) -> StudyRow {
        let RowInputs { motion, base, p } = self.inputs(number);
        let base = self.bases[base];
        let (foundation, eta, xi_v, epsilon, factor) = match base {
            FoundationParameters::Rigid { epsilon, restitution_factor } => {
                ("rigid", None, None, epsilon, Some(restitution_factor))
            }
            FoundationParameters::Viscoelastic { eta, xi_v, epsilon } => {
                ("viscoelastic", Some(eta), Some(xi_v), epsilon, None)
            }
        };
        let mut fields = Fields::default();
        fields.extend([self.motions[motion].0.as_str(), foundation]);
        for parameter in [eta, xi_v, Some(epsilon), factor] {
            fields.push_option(parameter);
        }
        fields.extend([p, TAU / p]);
        fields.push_option((self.pulse.shape != PulseShape::None).then(|| TAU / self.pulse.period / p));
        outcome.write(self.alpha, &mut fields);
        fields.extend(self.holds().fields(&outcome.peaks));
        fields.extend(self.friction_demand.map(|demand| self.valid_run(number).longest_above(demand)));
        StudyRow { fields, failure: outcome.failure.clone() }
    }
}
