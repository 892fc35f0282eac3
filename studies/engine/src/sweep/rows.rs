//! The number of a row → its inputs, its run and its samples; rows → a table.
//!
//! A sweep makes rows of blocks in the plane and in space alike: [`SweptRun`] is what it asks of either.

use crate::intensity::{BlockScales, Measure};
use crate::output::runner::{MAX_RUNS, StudyRows};
use crate::output::table::{Heading, Table, TableColumn, headings};
use crate::run::Run;
use crate::run::outcome::End;
use crate::run::rows::{Experiment, RunOutcome, RunRow};
use crate::search::{self, OutcomeMap, Scan};
use crate::spec::numbers_in_space::NumbersInSpace;
use crate::sweep::Sweep;
use crate::sweep::ensemble::SpreadTarget;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::hunt::Hunt;
use crate::sweep::strength::Strengths;
use rocking_block::block::{Block, BlockError};
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::unit::values::Values;

/// A run that a sweep makes of the values of a row.
pub(super) trait SweptRun: Experiment {
    /// Returns the run without ground motion, and the scales of its block without the changes of the sweep.
    fn of(sweep: &Sweep, values: &RowValues) -> (BlockScales, Self);

    /// Returns the run under a ground motion times `scale`.
    fn under(self, motion: &GroundMotion, scale: f64) -> Self;

    /// Returns the columns of its outcome.
    fn columns<'a>(sweep: &'a Sweep) -> Vec<TableColumn<'a, SweepRow<'a, Self>>>;
}

/// A row with its run.
pub(super) type SweepRow<'a, E> = RunRow<RowInputs<'a>, E>;

/// A row with the outcomes over the range of its search.
pub(super) type SearchRow<'a> = (RowInputs<'a>, OutcomeMap<End>);

/// The values of the parameters of a row.
#[derive(Clone, Debug)]
pub(super) struct RowValues {
    /// The variables of the FMU; for a block in space those of the pulse and of complete separation.
    pub variables: Values,
    /// The numbers of a block in space.
    pub in_space: Option<Box<NumbersInSpace>>,
}

/// The inputs of a row.
pub(super) struct RowInputs<'a> {
    pub row: u64,
    pub combination: Vec<f64>,
    pub values: RowValues,
    /// Those of the block without the changes of the sweep.
    pub scales: BlockScales,
    pub motion_number: usize,
    pub motion: &'a GroundMotion,
    /// Factor on the records.
    pub scale: f64,
    /// The measure prescribed instead of a factor, and its value.
    pub level: Option<(Measure, f64)>,
}

impl RowInputs<'_> {
    /// A measure of the scaled record.
    pub fn intensity(&self, measure: Measure) -> Option<f64> {
        let prescribed = self.level.filter(|(prescribed, _)| *prescribed == measure).map(|(_, value)| value);
        prescribed.or_else(|| self.motion.intensity(measure, self.scale, self.scales))
    }
}

/// The block of values that reading the study has checked.
fn valid(block: Result<Block, BlockError>) -> Block {
    block.expect("all blocks of a study are valid")
}

impl SweptRun for Run {
    fn of(sweep: &Sweep, RowValues { variables, .. }: &RowValues) -> (BlockScales, Run) {
        let block = valid(variables.block());
        let changed = if sweep.changes.is_empty() { block } else { valid(sweep.block(variables)) };
        let run = Run {
            block: changed,
            settings: variables.settings(Some(sweep.tolerance)),
            initial: variables.initial(),
            pulse: variables.pulse(),
            duration: sweep.duration,
            output_step: sweep.step.unwrap_or(f64::INFINITY),
            ground: Ground::default(),
        };
        ((&block).into(), run)
    }

    fn under(self, motion: &GroundMotion, scale: f64) -> Run {
        Run { ground: motion.ground.clone().scaled(scale), ..self }
    }

    fn columns<'a>(sweep: &'a Sweep) -> Vec<TableColumn<'a, SweepRow<'a, Run>>> {
        sweep.columns_of_outcomes()
    }
}

/// Returns the level of the run after these.
fn next_level<E: SweptRun>(hunt: &Hunt, rows: &[SweepRow<E>]) -> f64 {
    let runs = rows.iter().filter_map(|row| Some((row.inputs.level?.1, row.outcome.end() == End::Overturned)));
    hunt.next(&runs.collect::<Vec<_>>())
}

impl Sweep {
    /// The values of the parameters in a combination.
    pub(super) fn row_values(&self, combination: &[f64]) -> RowValues {
        RowValues { variables: self.values(combination), in_space: self.numbers_in_space(combination) }
    }

    /// The inputs and the run of a row. The measure has a `hunted` level if other rows decide it.
    fn row<E: SweptRun>(&self, row: u64, hunted: Option<f64>) -> (RowInputs<'_>, E) {
        let (strengths, motions) = (self.strengths.count(), self.motions.len() as u64);
        let motion_number = (row / strengths % motions) as usize;
        let motion = &self.motions[motion_number];
        let combination = self.combination(row / strengths / motions);
        let values = self.row_values(&combination);
        let (scales, run) = E::of(self, &values);
        let level = self.strengths.measure().zip(hunted).or(self.strengths.level(row % strengths));
        let scale = match level {
            Some((measure, value)) => motion.scale_to(measure, value, scales),
            None => self.strengths.scale(row % strengths, motion, scales),
        };
        let run = run.under(motion, scale);
        (RowInputs { row, combination, values, scales, motion_number, motion, scale, level }, run)
    }

    /// Makes the first runs of these curves, each of a block under a ground motion.
    fn hunted<E: SweptRun>(
        &self,
        hunt: &Hunt,
        curves: &[u64],
        count: u64,
        width: Option<VectorWidth>,
    ) -> Vec<Vec<SweepRow<'_, E>>> {
        let mut found: Vec<Vec<SweepRow<E>>> = curves.iter().map(|_| Vec::new()).collect();
        for run in 0..count {
            let next = curves.iter().zip(&found);
            let next = next.map(|(curve, rows)| self.row(curve * hunt.runs + run, Some(next_level(hunt, rows))));
            let made = RunRow::all(width, next.collect(), |_| [], || ());
            found.iter_mut().zip(made).for_each(|(rows, row)| rows.push(row));
        }
        found
    }

    /// The runs of a row's samples.
    fn samples<'a, E: SweptRun>(&'a self, inputs: &RowInputs<'a>) -> impl Iterator<Item = E> + use<'a, E> {
        let RowInputs { row, motion, scale: nominal, .. } = *inputs;
        let sampled = self.ensemble.as_ref().map(|ensemble| (ensemble, inputs.values.clone()));
        sampled.into_iter().flat_map(move |(ensemble, nominal_values)| {
            ensemble.probabilities(row).into_iter().map(move |probabilities| {
                let (mut values, mut scale) = (nominal_values.clone(), nominal);
                for (spread, probability) in ensemble.spreads.iter().zip(probabilities) {
                    match &spread.target {
                        SpreadTarget::Scale => scale = spread.value(scale, probability),
                        SpreadTarget::Parameter(parameter) => {
                            let nominal = values.number(parameter).unwrap_or(f64::NAN);
                            values.set(parameter, spread.value(nominal, probability));
                        }
                    }
                }
                E::of(self, &values).1.under(motion, scale)
            })
        })
    }

    /// Searches, for each row, the values of a measure at which the block overturns.
    fn least<E: SweptRun>(
        &self,
        measure: Measure,
        scan: &Scan,
        rows: &[(RowInputs, E)],
        width: Option<VectorWidth>,
    ) -> Vec<OutcomeMap<End>> {
        let run = |&(row, value): &(usize, f64)| {
            let (RowInputs { motion, scales, .. }, run) = &rows[row];
            run.clone().under(motion, motion.scale_to(measure, value, *scales))
        };
        let end = |outcome: E::Outcome| match outcome.end() {
            // The search looks for overturning only.
            End::Separated => End::Completed,
            end => end,
        };
        search::changes(scan, rows.len(), |values| {
            // Chunks bound the number of outcomes in memory; only the ends are kept.
            let chunks = values.chunks(MAX_RUNS as usize);
            chunks.flat_map(|values| E::outcomes(width, values.iter().map(run), || ())).map(end).collect()
        })
    }

    /// The headings of the table.
    pub(super) fn headings_of<E: SweptRun>(&self) -> Vec<Heading> {
        match self.strengths {
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Hunt(..) => {
                headings(&self.columns_of_runs::<E>())
            }
            Strengths::Least(measure, _) => headings(&self.columns_of_searches(measure)),
        }
    }

    /// Makes rows by their ascending numbers.
    pub(super) fn made<E: SweptRun>(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        if let Strengths::Hunt(_, hunt) = &self.strengths {
            let mut curves: Vec<u64> = numbers.iter().map(|number| number / hunt.runs).collect();
            curves.dedup();
            let mut rows: Vec<_> = self.hunted::<E>(hunt, &curves, hunt.runs, width).into_iter().flatten().collect();
            rows.retain(|row| numbers.binary_search(&row.inputs.row).is_ok());
            return RunRow::table(&self.columns_of_runs(), &rows);
        }
        let rows: Vec<(RowInputs, E)> = numbers.iter().map(|&number| self.row(number, None)).collect();
        if let Strengths::Least(measure, scan) = &self.strengths {
            let found = self.least(*measure, scan, &rows, width);
            let rows: Vec<SearchRow> = rows.into_iter().map(|(inputs, _)| inputs).zip(found).collect();
            return StudyRows { table: Table::of(&self.columns_of_searches(*measure), &rows), failure: None };
        }
        RunRow::table(&self.columns_of_runs(), &RunRow::all(width, rows, |inputs| self.samples(inputs), || ()))
    }

    /// The run of a row of blocks in the plane, without the spread of an ensemble.
    pub fn run(&self, row: u64) -> Run {
        let Strengths::Hunt(_, hunt) = &self.strengths else { return self.row(row, None).1 };
        let (curve, before) = (row / hunt.runs, row % hunt.runs);
        let found = self.hunted(hunt, &[curve], before, None);
        self.row(row, found.first().map(|runs| next_level::<Run>(hunt, runs))).1
    }
}
