//! Blocks of all sizes on several foundations → a table of peak rotations. They stand under several ground motions.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`statistics`] | the table of a spectrum → outcomes of each curve, statistics over the ground motions |

pub mod statistics;

use std::f64::consts::TAU;

use crate::output::resumable::TableHeader;
use crate::output::runner::{Study, StudyRows};
use crate::output::table::{TableColumn, headings};
use crate::run::Run;
use crate::run::outcome::{self, Holds};
use crate::run::rows::RunRow;
use crate::run::sliding;
use rocking_block::block::restraints::Tie;
use rocking_block::block::restraints::tie::{NUMBERS, Quantity};
use rocking_block::block::{Block, BlockError, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::Settings;

/// What carries the blocks of a curve, and the restitution of their impacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundationCurve {
    /// Viscoelastic supports or a rigid base.
    pub supports: Supports<Ratios>,
    /// Restitution ε (1).
    pub epsilon: f64,
}

impl FoundationCurve {
    /// Housner's rigid base: ε = 0 and his e.
    pub const HOUSNER: FoundationCurve = FoundationCurve::rigid(0.0, 1.0);

    /// Supports with the ratios η and ξ_v, and impacts with the restitution ε.
    pub const fn viscoelastic(eta: f64, xi_v: f64, epsilon: f64) -> FoundationCurve {
        FoundationCurve { supports: Supports::Viscoelastic(Ratios { eta, xi_v }), epsilon }
    }

    /// A rigid base. The ratio e of angular velocities is that from ε, eq. (6), times a factor.
    pub const fn rigid(epsilon: f64, restitution_factor: f64) -> FoundationCurve {
        FoundationCurve { supports: Supports::Rigid { restitution_factor }, epsilon }
    }

    /// That of a block.
    pub fn of(block: &Block) -> FoundationCurve {
        FoundationCurve { supports: block.ratios(), epsilon: block.epsilon }
    }
}

impl std::fmt::Display for FoundationCurve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let epsilon = self.epsilon;
        match self.supports {
            Supports::Rigid { restitution_factor: 1.0 } if epsilon == 0.0 => write!(f, "rigid"),
            Supports::Rigid { restitution_factor: 1.0 } => write!(f, "rigid,{epsilon}"),
            Supports::Rigid { restitution_factor } => write!(f, "rigid,{epsilon},{restitution_factor}"),
            Supports::Viscoelastic(Ratios { eta, xi_v }) => write!(f, "{eta},{xi_v},{epsilon}"),
        }
    }
}

/// Reads the written form, in any case.
impl std::str::FromStr for FoundationCurve {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<FoundationCurve, &'static str> {
        let lower = text.to_lowercase();
        let (rigid, numbers) = match lower.strip_prefix("rigid") {
            Some("") => return Ok(FoundationCurve::HOUSNER),
            Some(rest) => (true, rest.strip_prefix(',').unwrap_or(rest)),
            None => (false, lower.as_str()),
        };
        let numbers: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
        match (rigid, numbers.unwrap_or_default().as_slice()) {
            (true, &[epsilon]) => Ok(FoundationCurve::rigid(epsilon, 1.0)),
            (true, &[epsilon, factor]) => Ok(FoundationCurve::rigid(epsilon, factor)),
            (false, &[eta, xi_v, epsilon]) => Ok(FoundationCurve::viscoelastic(eta, xi_v, epsilon)),
            _ => Err("expected ETA,XI_V,EPSILON, as in 40,0.1,0, or rigid, rigid,EPSILON or rigid,EPSILON,FACTOR"),
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

/// Eccentricity and ties in proportion to each block, for similar blocks of all sizes. The units are R0 for places and slack, M g/R0 for
/// stiffness, M g for pretension and strength, and M p for damping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScaledFeatures {
    /// Eccentricity over half the width, e_x/b (1).
    pub eccentricity: f64,
    /// Ties, with all their numbers in these units.
    pub ties: Vec<Tie>,
}

impl ScaledFeatures {
    /// The proportions of a block.
    pub fn of(block: &Block) -> ScaledFeatures {
        let ties = block.ties().iter().map(|tie| scaled(tie, block, |value, unit| value / unit));
        ScaledFeatures { eccentricity: block.eccentricity / block.b, ties: ties.collect() }
    }

    /// The block with `common` and these proportions.
    fn block(&self, dimensionless: &Dimensionless, common: &Common) -> Result<Block, BlockError> {
        let even = Block::from_dimensionless(dimensionless, common)?;
        if *self == ScaledFeatures::default() {
            return Ok(even);
        }
        let common = Common { eccentricity: self.eccentricity * even.b, ..*common };
        let block = Block::from_dimensionless(dimensionless, &common)?;
        let ties: Vec<Tie> = self.ties.iter().map(|tie| scaled(tie, &block, |value, unit| value * unit)).collect();
        block.with_ties(&ties)
    }
}

/// A tie whose numbers `change` makes from their values and their units. The units are those for this block.
fn scaled(tie: &Tie, block: &Block, change: impl Fn(f64, f64) -> f64) -> Tie {
    let (length, force) = (block.r0, block.mass * block.gravity);
    let mut scaled = *tie;
    for (value, number) in scaled.numbers().into_iter().zip(NUMBERS) {
        let unit = match number.quantity {
            Quantity::Coordinate | Quantity::Length => length,
            Quantity::Force => force,
            Quantity::Stiffness => force / length,
            Quantity::Damping => block.mass * block.p,
            Quantity::Ratio => 1.0,
        };
        *value = change(*value, unit);
    }
    scaled
}

/// A spectrum: each ground motion × each foundation × each size is a row.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Slenderness angle α (rad).
    pub alpha: f64,
    /// Mass, shape factor, gravity and friction; `bases` and `in_proportion` have the rest.
    pub common: Common,
    /// Eccentricity and ties.
    pub in_proportion: ScaledFeatures,
    /// Foundations.
    pub bases: Vec<FoundationCurve>,
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
    /// Longest time between two stops (s). Without it, only record samples and pulse ends are stops.
    pub step: Option<f64>,
    /// Friction demand (1) of the column with the longest time above it, if any.
    pub friction_demand: Option<f64>,
}

/// The ground motion, the foundation and the size of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumInputs {
    /// Number of the row.
    pub row: u64,
    /// Number of the ground motion.
    pub motion: usize,
    /// Number of the foundation.
    pub base: usize,
    /// Frequency parameter p (rad/s).
    pub p: f64,
}

impl Spectrum {
    /// Checks that all rows have valid blocks.
    ///
    /// # Errors
    /// The first invalid block.
    pub fn checked(self) -> Result<CheckedSpectrum, BlockError> {
        for &base in &self.bases {
            for p in [self.sizes.greatest, self.sizes.least] {
                self.block(base, p)?;
            }
        }
        Ok(CheckedSpectrum(self))
    }

    /// ω_p/p of a block (1), if there is a pulse.
    fn pulse_ratio(&self, p: f64) -> Option<f64> {
        (self.pulse.shape != PulseShape::None).then(|| TAU / self.pulse.period / p)
    }

    /// The inputs of a row.
    pub fn inputs(&self, row: u64) -> SpectrumInputs {
        let curve = (row / self.sizes.count) as usize;
        let (motion, base) = (curve / self.bases.len(), curve % self.bases.len());
        SpectrumInputs { row, motion, base, p: self.sizes.p(row % self.sizes.count) }
    }

    /// The block of this size on a foundation.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub fn block(&self, base: FoundationCurve, p: f64) -> Result<Block, BlockError> {
        let common = Common { epsilon: base.epsilon, ..self.common };
        self.in_proportion.block(&Dimensionless { alpha: self.alpha, p, supports: base.supports }, &common)
    }
}

/// A spectrum whose blocks are valid.
#[derive(Clone, Debug)]
pub struct CheckedSpectrum(Spectrum);

impl std::ops::Deref for CheckedSpectrum {
    type Target = Spectrum;

    fn deref(&self) -> &Spectrum {
        &self.0
    }
}

impl Study for CheckedSpectrum {
    fn header(&self) -> TableHeader {
        let Common { mass, gamma, gravity, friction, .. } = self.common;
        let friction = if friction > 0.0 { format!(", friction = {friction}") } else { String::new() };
        let Sizes { least, greatest, count } = self.sizes;
        let mut study = vec![
            concat!("rocking-block ", env!("CARGO_PKG_VERSION"), " spectrum").to_string(),
            format!("alpha = {}, mass = {mass}, gamma = {gamma}, g = {gravity}{friction}", self.alpha),
            format!("p = {least} to {greatest}, {count} sizes"),
        ];
        let ScaledFeatures { eccentricity, ties } = &self.in_proportion;
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
        TableHeader { study, columns: headings(&self.columns()) }
    }

    fn rows(&self) -> u64 {
        (self.motions.len() * self.bases.len()) as u64 * self.sizes.count
    }

    fn runs_in_a_row(&self) -> u64 {
        1
    }

    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        let rows = numbers.iter().map(|&number| (self.inputs(number), self.run(number))).collect();
        RunRow::table(&self.columns(), &RunRow::all(width, rows, |_| [], || ()))
    }
}

impl CheckedSpectrum {
    /// The run of a row.
    pub fn run(&self, row: u64) -> Run {
        let SpectrumInputs { motion, base, p, .. } = self.inputs(row);
        Run {
            pulse: self.pulse,
            ground: self.motions[motion].1.clone(),
            duration: self.duration,
            output_step: self.step.unwrap_or(f64::INFINITY),
            ..Run::at_rest(
                self.block(self.bases[base], p).expect("blocks between two valid sizes are valid"),
                self.settings,
            )
        }
    }

    /// The columns: of the block, of its run, and of the friction that it needs.
    fn columns(&self) -> Vec<TableColumn<'_, RunRow<SpectrumInputs>>> {
        let motions = self.motions.iter().map(|(name, _)| name.clone());
        let base = |row: &RunRow<SpectrumInputs>| self.bases[row.inputs.base];
        let ratios = move |row: &_| base(row).supports.viscoelastic();
        type Of<'a> = TableColumn<'a, RunRow<SpectrumInputs>>;
        let mut columns = vec![
            Of::row(|row| row.inputs.row),
            Of::choice("motion", motions, |row| row.inputs.motion),
            Of::choice("foundation", ["rigid", "viscoelastic"], move |row| usize::from(ratios(row).is_some())),
            Of::optional("eta", "1", move |row| ratios(row).map(|ratios| ratios.eta)),
            Of::optional("xi_v", "1", move |row| ratios(row).map(|ratios| ratios.xi_v)),
            Of::real("epsilon", "1", move |row| base(row).epsilon),
            Of::optional("restitution_factor", "1", move |row| base(row).supports.restitution_factor()),
            Of::real("p", "rad/s", |row| row.inputs.p),
            Of::real("2pi/p", "s", |row| TAU / row.inputs.p),
            Of::optional("omega_p/p", "1", |row| self.pulse_ratio(row.inputs.p)),
        ];
        let holds = Holds::of_parts(self.common.friction, &self.in_proportion.ties);
        columns.extend(outcome::columns(holds, |row: &RunRow<_>| &row.outcome));
        columns.extend(self.friction_demand.map(sliding::column));
        columns
    }
}
