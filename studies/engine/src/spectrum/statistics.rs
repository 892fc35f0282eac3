//! The table of a spectrum → outcomes of each curve, statistics over the ground motions.
//!
//! Peak rotations of the blocks that rock and stand are taken as lognormal: the statistics are those of `ln(|θ|max/α)`. Blocks that
//! overturn, do not rock, or have a run that ends at complete separation, undecided or failed, are excluded and counted. Where
//! some blocks overturn, the mean is conditional on standing.

use std::f64::consts::TAU;

use serde::Serialize;

use crate::mismatch::Mismatch;
use crate::output::table::{Series, Table, TableColumn};
use crate::run::outcome::{End, rocks};
use crate::spectrum::{Spectrum, SpectrumInputs};

/// Numbers of blocks by the ends of their runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EndCounts {
    /// Blocks that stand.
    pub completed: u64,
    /// Blocks that overturned.
    pub overturned: u64,
    /// Blocks whose runs ended at complete separation.
    pub separated: u64,
    /// Blocks whose duration was over before their outcome was known.
    pub undecided: u64,
    /// Blocks whose runs failed.
    pub failed: u64,
}

impl EndCounts {
    fn add(&mut self, end: End) {
        *match end {
            End::Completed => &mut self.completed,
            End::Overturned => &mut self.overturned,
            End::Separated => &mut self.separated,
            End::Undecided => &mut self.undecided,
            End::Failed => &mut self.failed,
        } += 1;
    }

    /// Number of all blocks.
    pub fn all(&self) -> u64 {
        self.completed + self.overturned + self.separated + self.undecided + self.failed
    }
}

/// The outcomes of the blocks of one ground motion on one foundation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveSummary {
    /// Name of the ground motion.
    pub motion: String,
    /// The foundation, as written in options.
    pub foundation: String,
    /// Its blocks by their ends.
    #[serde(flatten)]
    pub ends: EndCounts,
    /// Blocks that left the ground completely at some time, whatever their outcome.
    pub flew: u64,
    /// Total number of complete separations.
    pub flights: u64,
    /// The greatest peak rotation of those that completed.
    pub greatest: Option<Greatest>,
}

/// A greatest peak rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Greatest {
    /// |θ|/α (1).
    #[serde(rename = "peak.theta/alpha")]
    pub peak: f64,
    /// Frequency parameter of the block (rad/s).
    pub p: f64,
}

/// The outcomes of the blocks of one size on one foundation under several ground motions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SizeStatistics {
    /// The blocks by their ends.
    pub ends: EndCounts,
    /// Blocks that completed and [rocked](rocks).
    pub rocked: u64,
    /// Mean of ln(|θ|max/α) of those that rocked.
    mean: f64,
    /// Sum of the squared deviations from the mean.
    squares: f64,
}

impl SizeStatistics {
    fn add(&mut self, BlockOutcome { end, peak, liftoffs, .. }: BlockOutcome) {
        self.ends.add(end);
        if end == End::Completed && rocks(peak, Some(liftoffs as f64)) {
            self.rocked += 1;
            let logarithm = libm::log(peak);
            let off = logarithm - self.mean;
            self.mean += off / self.rocked as f64;
            self.squares += off * (logarithm - self.mean);
        }
    }

    /// Blocks that completed and did not rock.
    pub fn at_rest(&self) -> u64 {
        self.ends.completed - self.rocked
    }

    /// Geometric mean of |θ|max/α (1) of the blocks that rocked; nothing if none did.
    pub fn geometric_mean(&self) -> Option<f64> {
        (self.rocked > 0).then(|| libm::exp(self.mean))
    }

    /// Sample standard deviation of ln(|θ|max/α) (1) of the blocks that rocked; needs two of them.
    pub fn deviation(&self) -> Option<f64> {
        (self.rocked > 1).then(|| (self.squares / (self.rocked - 1) as f64).sqrt())
    }
}

/// The blocks of one foundation under all ground motions of a kind. The kinds have or lack a vertical component.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundationStatistics {
    /// Number of the foundation.
    pub base: usize,
    /// Whether the ground motions have a vertical component.
    pub vertical: bool,
    /// Numbers of the ground motions.
    pub motions: Vec<usize>,
    /// Statistics of each size.
    pub cells: Vec<SizeStatistics>,
}

impl FoundationStatistics {
    /// The direction of the motions, as in spectra of one record.
    pub fn direction(&self) -> &'static str {
        direction(self.vertical)
    }
}

/// The directions of motions without and with a vertical component.
const DIRECTIONS: [&str; 2] = ["horizontal", "horizontal + vertical"];

/// The direction of a motion with or without a vertical component.
pub fn direction(vertical: bool) -> &'static str {
    DIRECTIONS[usize::from(vertical)]
}

/// The outcome of a block in the table of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockOutcome {
    /// Number of the row.
    pub row: u64,
    /// How its run ended.
    pub end: End,
    /// Peak |θ|/α (1).
    pub peak: f64,
    /// Number of complete separations.
    pub flights: u64,
    /// Number of lift-offs.
    pub liftoffs: u64,
}

impl BlockOutcome {
    /// Reads the outcomes from rows of the table.
    ///
    /// # Errors
    /// A column is missing, or a value is impossible.
    pub fn all(rows: &Table) -> Result<Vec<BlockOutcome>, String> {
        let column = |name| rows.column(name).ok_or_else(|| format!("found no column {name} in the table"));
        let [number, end, peak, flights, liftoffs] =
            ["row", "outcome", "peak.theta/alpha", "flights", "events.liftoffs"].map(column);
        let (numbers, end, peak, flights, liftoffs) = (number?, end?, peak?, flights?, liftoffs?);
        let outcome = |row: usize| {
            let number = |series: &Series| {
                let number = series.number(row).filter(|number| number.is_finite() && *number >= 0.0);
                number.ok_or_else(|| {
                    let (row, heading, found) = (numbers.text(row), &series.heading, series.text(row));
                    format!("row {row} has {heading} = {found}; expected a number of at least 0")
                })
            };
            let end = end.word(row).unwrap_or_default().parse().map_err(|error: Mismatch| error.to_string())?;
            let (peak, flights, liftoffs) = (number(peak)?, number(flights)? as u64, number(liftoffs)? as u64);
            Ok(BlockOutcome { row: numbers.number(row).unwrap_or_default() as u64, end, peak, flights, liftoffs })
        };
        (0..rows.rows()).map(outcome).collect()
    }
}

/// Statistics of the table of a spectrum.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// One per ground motion and foundation, in the order of the rows.
    pub curves: Vec<CurveSummary>,
    /// One per foundation and direction of ground motion, for directions with several motions.
    pub groups: Vec<FoundationStatistics>,
}

impl Statistics {
    /// Begins the statistics of a spectrum.
    pub fn new(spectrum: &Spectrum) -> Statistics {
        Statistics { curves: Vec::new(), groups: groups(spectrum) }
    }

    /// Includes the next rows.
    pub fn add(&mut self, spectrum: &Spectrum, outcomes: &[BlockOutcome]) {
        for &outcome in outcomes {
            let SpectrumInputs { motion, base, p, .. } = spectrum.inputs(outcome.row);
            let size = outcome.row % spectrum.sizes.count;
            if size == 0 {
                self.curves.push(CurveSummary {
                    motion: spectrum.motions[motion].0.clone(),
                    foundation: spectrum.bases[base].to_string(),
                    ends: EndCounts::default(),
                    flew: 0,
                    flights: 0,
                    greatest: None,
                });
            }
            if let Some(curve) = self.curves.last_mut() {
                curve.add(outcome, p);
            }
            let group = self.groups.iter_mut().find(|group| group.base == base && group.motions.contains(&motion));
            if let Some(group) = group {
                group.cells[size as usize].add(outcome);
            }
        }
    }

    /// The statistics of all groups, one row per foundation and size.
    pub fn table(&self, spectrum: &Spectrum) -> Table {
        let rows = self.groups.iter().flat_map(|group| {
            (0..).zip(&group.cells).map(move |(size, &cell)| StatisticsRow { group, p: spectrum.sizes.p(size), cell })
        });
        let bases = spectrum.bases.iter().map(ToString::to_string);
        type Of<'a> = TableColumn<'a, StatisticsRow<'a>>;
        let columns = [
            Of::choice("motions", DIRECTIONS, |row| usize::from(row.group.vertical)),
            Of::choice("foundation", bases, |row| row.group.base),
            Of::real("p", "rad/s", |row| row.p),
            Of::real("2pi/p", "s", |row| TAU / row.p),
            Of::optional("omega_p/p", "1", |row| spectrum.pulse_ratio(row.p)),
            Of::count("records", |row| row.cell.ends.all()),
            Of::count("rocked", |row| row.cell.rocked),
            Of::count("at_rest", |row| row.cell.at_rest()),
            Of::count("overturned", |row| row.cell.ends.overturned),
            Of::count("separated", |row| row.cell.ends.separated),
            Of::count("undecided", |row| row.cell.ends.undecided),
            Of::count("failed", |row| row.cell.ends.failed),
            Of::optional("geometric_mean.theta/alpha", "1", |row| row.cell.geometric_mean()),
            Of::optional("deviation_ln.theta/alpha", "1", |row| row.cell.deviation()),
        ];
        Table::of(&columns, &rows.collect::<Vec<_>>())
    }
}

/// The blocks of one size on one foundation.
struct StatisticsRow<'a> {
    group: &'a FoundationStatistics,
    p: f64,
    cell: SizeStatistics,
}

impl CurveSummary {
    fn add(&mut self, BlockOutcome { end, peak, flights, .. }: BlockOutcome, p: f64) {
        self.flew += u64::from(flights > 0);
        self.flights += flights;
        self.ends.add(end);
        if end == End::Completed && self.greatest.is_none_or(|greatest| peak > greatest.peak) {
            self.greatest = Some(Greatest { peak, p });
        }
    }
}

/// The groups of a spectrum with two or more motions, still without outcomes.
fn groups(spectrum: &Spectrum) -> Vec<FoundationStatistics> {
    let mut groups = Vec::new();
    for vertical in [false, true] {
        let is = |motion: &usize| spectrum.motions[*motion].1.vertical.is_some() == vertical;
        let motions: Vec<usize> = (0..spectrum.motions.len()).filter(is).collect();
        if motions.len() > 1 {
            groups.extend((0..spectrum.bases.len()).map(|base| FoundationStatistics {
                base,
                vertical,
                motions: motions.clone(),
                cells: vec![SizeStatistics::default(); spectrum.sizes.count as usize],
            }));
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record a ten-millionth above uplift leaves a peak of 1e-19, and supports give way without a lift-off: neither is rocking.
    #[test]
    fn mean_and_deviation_are_those_of_blocks_that_rock() {
        let mut found = SizeStatistics::default();
        let outcomes = [(0.2, 4), (0.3, 2), (1e-19, 1), (2e-3, 0), (0.0, 0)];
        for (row, (peak, liftoffs)) in (0..).zip(outcomes) {
            found.add(BlockOutcome { row, end: End::Completed, peak, flights: 0, liftoffs });
        }
        assert_eq!((found.rocked, found.at_rest()), (2, 3));
        assert!((found.geometric_mean().unwrap() - 0.06_f64.sqrt()).abs() < 1e-15);
        assert!((found.deviation().unwrap() - 1.5_f64.ln() / 2.0_f64.sqrt()).abs() < 1e-15);
    }
}
