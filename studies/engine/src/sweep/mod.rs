//! Parameters over grids or samples × ground motions × strengths → a table of outcomes.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | parameters and their values → the combinations of a grid or a Latin hypercube |
//! | [`ground_motion`] | records → ground motions with their measures |
//! | [`strength`] | `scales`, `levels`, `hunt` or `least` → factors on the records |
//! | [`hunt`] | the runs of a block under a record → the level of the next one |
//! | [`ensemble`] | distributions of uncertain quantities → samples of each row, probabilities |
//! | [`amplified`] | factors on records → doubts about strong ones |
//! | [`change`] | a block → the same block with another base, foundation, friction or ties |
//! | `columns` | a row → the columns of the table |
//! | `records` | `[[records]]` of a study file → ground motions |
//! | [`mod@file`] | a study file → a sweep with valid values |

pub mod amplified;
pub mod change;
mod columns;
pub mod ensemble;
pub mod file;
pub mod ground_motion;
pub mod hunt;
pub mod parameters;
pub(crate) mod records;
pub mod strength;

use crate::building::Building;
use crate::doubts;
use crate::intensity::Measure;
use crate::output::parts::{Part, PartNumber};
use crate::output::resumable::TableHeader;
use crate::output::runner::{MAX_RUNS, Study, StudyRows};
use crate::output::table::{Table, headings};
use crate::run::batch::outcomes;
use crate::run::outcome::{End, Holds, Outcome};
use crate::run::rows::RunRow;
use crate::run::{Run, is_moved};
use crate::search::{self, OutcomeMap, Scan};
use crate::sweep::change::{Change, holds_of_variables, tie_field};
use crate::sweep::ensemble::{Ensemble, SpreadTarget};
use crate::sweep::file::Checks;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::hunt::Hunt;
use crate::sweep::parameters::{Design, ParameterValues, SweptParameter};
use crate::sweep::strength::Strengths;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, BlockError};
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::OnSeparation;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// A sweep: each combination of parameters × each motion × each strength is a row.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Description of the study, line by line.
    pub text: Vec<String>,
    /// The parameters named in the study.
    pub parameters: Vec<SweptParameter>,
    /// How they are combined.
    pub design: Design,
    /// Ground motions, at least one; an empty motion is no shaking.
    pub motions: Vec<GroundMotion>,
    /// The building on whose floors the blocks stand, if any.
    pub building: Option<Building>,
    /// The strengths of each.
    pub strengths: Strengths,
    /// The samples of each row, if any.
    pub ensemble: Option<Ensemble>,
    /// Measures of the records with a column in the table.
    pub measures: Vec<Measure>,
    /// Behaviour at complete separation, unless `on_separation` is a parameter.
    pub on_separation: OnSeparation,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
    /// Duration of each run (s); without it, until the block has come down.
    pub duration: Option<f64>,
    /// Longest time between two stops (s). Without it, only record samples and pulse ends are stops.
    pub step: Option<f64>,
    /// Friction demand (1) of the column with the longest time above it, if any.
    pub friction_demand: Option<f64>,
    /// Amplitude (m) of the column of half cycles of plastic elongations, if any.
    pub half_cycles: Option<f64>,
    /// Changes of each block, one after the other. The ground motions stay those of the blocks without them.
    pub changes: Vec<Change>,
    /// Doubts about the records and their scale, a sentence each.
    pub remarks: Vec<String>,
}

impl Sweep {
    /// Number of combinations of parameters; `None` if it overflows.
    pub fn combinations(&self) -> Option<u64> {
        self.design.combinations(&self.parameters)
    }

    /// The numbers of the combinations that are checked, in their order.
    fn combinations_to_check<'a>(&'a self, checks: Checks<'a>) -> Box<dyn Iterator<Item = u64> + 'a> {
        match checks {
            Checks::All => Box::new(0..self.combinations().unwrap_or(0)),
            Checks::Parts(parts) => {
                let per_combination = self.motions.len() as u64 * self.strengths.count();
                let of_part = move |part: &PartNumber| {
                    let plan = Part::new(self, *part).plan();
                    (0..plan.rows()).map(move |position| plan.row(position) / per_combination)
                };
                let mut last = None;
                let numbers = parts.iter().flat_map(of_part);
                Box::new(numbers.filter(move |number| last.replace(*number) != Some(*number)))
            }
            Checks::None => Box::new(std::iter::empty()),
        }
    }

    /// The values of the parameters in a combination, in the order of `parameters`.
    pub fn combination(&self, number: u64) -> Vec<f64> {
        self.design.combination(number, &self.parameters)
    }

    /// The variables of the FMU in a combination.
    ///
    /// Variables without a value in the study have the FMU's start value, except `on_separation`.
    pub fn values(&self, combination: &[f64]) -> Values {
        let mut values = Values::default();
        values[Variable::OnSeparation] = f64::from(self.on_separation as i32);
        for (swept, value) in self.parameters.iter().zip(combination) {
            values[swept.parameter.metadata.variable] = *value;
        }
        values
    }

    /// Friction and ties of the blocks of the sweep.
    pub fn holds(&self) -> Holds {
        let any = |variable: Variable| {
            let swept = self.parameters.iter().find(|swept| swept.parameter.metadata.variable == variable);
            swept.is_some_and(|swept| match &swept.values {
                ParameterValues::List(values) => values.iter().any(|&value| value > 0.0),
                ParameterValues::Range { to, .. } => *to > 0.0,
            })
        };
        self.changes.iter().fold(holds_of_variables(any), |holds, change| change.holds(holds))
    }

    /// Remarks on blocks and pulses beyond reason, one of each kind.
    fn doubts(&self, checks: Checks) -> Vec<String> {
        let values = || self.combinations_to_check(checks).map(|number| self.values(&self.combination(number)));
        // An empty motion is no shaking.
        let has_record = self.motions.iter().all(|motion| !motion.ground.is_empty());
        let mut remarks = doubts::of_blocks(values().filter_map(|values| self.block(&values).ok()));
        remarks.extend(doubts::of_pulses(values().map(|values| (values.pulse(), values[Variable::G])), has_record));
        remarks
    }

    /// Everything that affects the rows, line by line: the study without comments and `[assess]`.
    pub fn identity(&self) -> Vec<String> {
        let Sweep { parameters, design, strengths, ensemble, measures, changes, .. } = self;
        let Sweep { on_separation, tolerance, duration, step, friction_demand, half_cycles, .. } = self;
        let names = parameters.iter().map(|SweptParameter { parameter, values }| (parameter.name(), values));
        let mut lines: Vec<String> = names.map(|swept| format!("{swept:?}")).collect();
        lines.push(format!("{:?}", (design, strengths, ensemble, measures, changes)));
        lines.push(format!("{:?}", (on_separation, tolerance, duration, step, friction_demand)));
        lines.extend(half_cycles.map(|amplitude| format!("half cycles above {amplitude:?}")));
        lines.extend(self.described_motions());
        lines
    }

    /// The names and the contents of the ground motions.
    fn described_motions(&self) -> impl Iterator<Item = String> {
        self.motions.iter().map(|GroundMotion { names, ground, floor, .. }| {
            let floor = floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
            format!("{}{floor}: {}", names.join(" + "), ground.fingerprint())
        })
    }

    /// Whether the blocks stand on the floors of a building.
    pub fn has_building(&self) -> bool {
        self.motions.iter().any(|motion| motion.floor.is_some())
    }

    /// The inputs and the run of a row. The measure has a `hunted` level if other rows decide it.
    fn row(&self, row: u64, hunted: Option<f64>) -> (RowInputs<'_>, Run) {
        let (strengths, motions) = (self.strengths.count(), self.motions.len() as u64);
        let motion_number = (row / strengths % motions) as usize;
        let motion = &self.motions[motion_number];
        let combination = self.combination(row / strengths / motions);
        let values = self.values(&combination);
        let block = valid(values.block());
        let changed = if self.changes.is_empty() { block } else { valid(self.block(&values)) };
        let level = self.strengths.measure().zip(hunted).or(self.strengths.level(row % strengths));
        let scale = match level {
            Some((measure, value)) => motion.scale_to(measure, value, &block),
            None => self.strengths.scale(row % strengths, motion, &block),
        };
        let run = self.run_of(changed, &values, motion, scale);
        (RowInputs { row, combination, values, block, motion_number, motion, scale, level }, run)
    }

    /// The run of a row, without the spread of an ensemble.
    pub fn run(&self, row: u64) -> Run {
        let Strengths::Hunt(_, hunt) = &self.strengths else { return self.row(row, None).1 };
        let (curve, before) = (row / hunt.runs, row % hunt.runs);
        let found = self.hunted(hunt, &[curve], before, None);
        self.row(row, found.first().map(|runs| next_level(hunt, runs))).1
    }

    /// Makes the first runs of these curves, each of a block under a ground motion.
    fn hunted(&self, hunt: &Hunt, curves: &[u64], count: u64, width: Option<VectorWidth>) -> Vec<Vec<SweepRow<'_>>> {
        let mut found: Vec<Vec<SweepRow>> = curves.iter().map(|_| Vec::new()).collect();
        for run in 0..count {
            let next = curves.iter().zip(&found);
            let next = next.map(|(curve, rows)| self.row(curve * hunt.runs + run, Some(next_level(hunt, rows))));
            let made = RunRow::all(width, next.collect(), |_| [], || ());
            found.iter_mut().zip(made).for_each(|(rows, row)| rows.push(row));
        }
        found
    }

    /// The sweep with changed blocks under its ground motions.
    #[must_use]
    pub fn with(&self, changes: &[Change]) -> Sweep {
        Sweep { changes: [&self.changes, changes].concat(), ..self.clone() }
    }

    /// Checks that all blocks are valid with these changes. One of them has to read each changed parameter.
    ///
    /// # Errors
    /// The first invalid parameter, or the condition under which a block would read an unread one.
    pub fn check_changes(&self, changes: &[Change]) -> Result<(), String> {
        let changed = self.with(changes);
        let is_of_tie = |variable| {
            let kind = |change: &Change| match change {
                Change::Tied(_) => Some(LinkKind::Tie),
                Change::Damped(_) => Some(LinkKind::Damper),
                Change::Parameter(..)
                | Change::Width(_)
                | Change::StiffnessRatio(_)
                | Change::DampingRatio(_)
                | Change::FrictionOverThreshold(_) => None,
            };
            let mut added = changes.iter().filter_map(kind).map(|kind| [Tie { kind, ..Tie::default() }; 2]);
            added.any(|mut ties| tie_field(&mut ties, variable).is_some())
        };
        // An unread parameter and the condition under which a block reads it; `None` once a combination has read all.
        let mut unread = Some(("", "a combination"));
        for number in 0..self.combinations().unwrap_or(0) {
            let values = self.values(&self.combination(number));
            changed.block(&values).map_err(|error| error.to_string())?;
            let values = changes.iter().fold(values, |values, change| change.values(values));
            let found = changes.iter().find_map(|change| {
                let parameter = change.parameter().filter(|&variable| !is_of_tie(variable))?.name();
                values.unread_by_motion().find(|(name, _)| *name == parameter)
            });
            unread = unread.and(found);
        }
        unread
            .map_or(Ok(()), |(name, needed)| Err(format!("{name} is read by no block of the study; expected {needed}")))
    }

    /// The variables in the middle of the study, each in its range's or list's middle.
    pub fn middle(&self) -> Values {
        let middle: Vec<f64> = self.parameters.iter().map(|swept| swept.values.at(0.5)).collect();
        self.values(&middle)
    }

    /// A ground motion at one of the strengths. It is scaled for a block if the strength is relative to it.
    pub fn ground(&self, motion: usize, strength: u64, block: &Block) -> Ground {
        let motion = &self.motions[motion];
        motion.ground.clone().scaled(self.strengths.scale(strength, motion, block))
    }

    /// The block of these values with the changes of the sweep.
    ///
    /// # Errors
    /// The first parameter that a change makes invalid.
    pub fn block(&self, values: &Values) -> Result<Block, BlockError> {
        let changed = self.changes.iter().fold(values.clone(), |values, change| change.values(values));
        self.changes.iter().try_fold(changed.block()?, |block, change| change.block(block, &self.changes))
    }

    /// The run of a changed block with the other values.
    fn run_of(&self, block: Block, values: &Values, motion: &GroundMotion, scale: f64) -> Run {
        Run {
            block,
            settings: values.settings(Some(self.tolerance)),
            initial: values.initial(),
            pulse: values.pulse(),
            duration: self.duration,
            output_step: self.step.unwrap_or(f64::INFINITY),
            ground: motion.ground.clone().scaled(scale),
        }
    }

    /// The runs of a row's samples.
    fn samples<'a>(&'a self, inputs: &RowInputs<'a>) -> impl Iterator<Item = Run> + use<'a> {
        let RowInputs { row, motion, scale: nominal, .. } = *inputs;
        let sampled = self.ensemble.as_ref().map(|ensemble| (ensemble, inputs.values.clone()));
        sampled.into_iter().flat_map(move |(ensemble, nominal_values)| {
            ensemble.probabilities(row).into_iter().map(move |probabilities| {
                let (mut values, mut scale) = (nominal_values.clone(), nominal);
                for (spread, probability) in ensemble.spreads.iter().zip(probabilities) {
                    match &spread.target {
                        SpreadTarget::Scale => scale = spread.value(scale, probability),
                        SpreadTarget::Parameter(parameter) => {
                            let variable = parameter.metadata.variable;
                            values[variable] = spread.value(values[variable], probability);
                        }
                    }
                }
                self.run_of(valid(self.block(&values)), &values, motion, scale)
            })
        })
    }

    /// Searches, for each row, the values of a measure at which the block overturns.
    fn least(
        &self,
        measure: Measure,
        scan: &Scan,
        rows: &[(RowInputs, Run)],
        width: Option<VectorWidth>,
    ) -> Vec<OutcomeMap<End>> {
        let run = |&(row, value): &(usize, f64)| {
            let (RowInputs { motion, block, .. }, run) = &rows[row];
            let ground = motion.ground.clone().scaled(motion.scale_to(measure, value, block));
            Run { ground, ..run.clone() }
        };
        let end = |outcome: Outcome| match outcome.end {
            // The search looks for overturning only.
            End::Separated => End::Completed,
            end => end,
        };
        search::changes(scan, rows.len(), |values| {
            // Chunks bound the number of outcomes in memory; only the ends are kept.
            let chunks = values.chunks(MAX_RUNS as usize);
            chunks.flat_map(|values| outcomes(width, values.iter().map(run), || ())).map(end).collect()
        })
    }

    /// Whether a record, a pulse or the initial state moves the block.
    pub fn moves(&self, combination: &[f64], motion: &GroundMotion) -> bool {
        let values = self.values(combination);
        is_moved(&motion.ground, &values.pulse(), &values.initial())
    }
}

/// The block of values that reading the study has checked.
fn valid(block: Result<Block, BlockError>) -> Block {
    block.expect("all blocks of a study are valid")
}

/// Returns the level of the run after these.
fn next_level(hunt: &Hunt, rows: &[SweepRow]) -> f64 {
    let runs = rows.iter().filter_map(|row| Some((row.inputs.level?.1, row.outcome.end == End::Overturned)));
    hunt.next(&runs.collect::<Vec<_>>())
}

/// A row with its run.
type SweepRow<'a> = RunRow<RowInputs<'a>>;

/// A row with the outcomes over the range of its search.
type SearchRow<'a> = (RowInputs<'a>, OutcomeMap<End>);

/// The inputs of a row.
struct RowInputs<'a> {
    row: u64,
    combination: Vec<f64>,
    values: Values,
    /// The block without the changes of the sweep.
    block: Block,
    motion_number: usize,
    motion: &'a GroundMotion,
    scale: f64,
    /// The measure prescribed instead of a factor, and its value.
    level: Option<(Measure, f64)>,
}

impl RowInputs<'_> {
    /// A measure of the scaled record.
    fn intensity(&self, measure: Measure) -> Option<f64> {
        let prescribed = self.level.filter(|(prescribed, _)| *prescribed == measure).map(|(_, value)| value);
        prescribed.or_else(|| self.motion.intensity(measure, self.scale, &self.block))
    }
}

impl Study for Sweep {
    fn header(&self) -> TableHeader {
        let mut study = vec![concat!("rocking-block ", env!("CARGO_PKG_VERSION"), " sweep").to_string()];
        study.extend(self.text.iter().cloned());
        study.push(format!("on_separation = {:?}, where the study does not name it", self.on_separation));
        study.extend(self.changes.iter().map(|change| format!("each block changed: {change:?}")));
        study.extend(self.described_motions());
        let columns = match self.strengths {
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Hunt(..) => headings(&self.columns_of_runs()),
            Strengths::Least(measure, _) => headings(&self.columns_of_searches(measure)),
        };
        TableHeader { study, columns }
    }

    fn rows(&self) -> u64 {
        self.combinations().unwrap_or(0) * self.motions.len() as u64 * self.strengths.count()
    }

    fn runs_in_a_row(&self) -> u64 {
        match &self.strengths {
            Strengths::Least(_, scan) => scan.points,
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Hunt(..) => {
                1 + self.ensemble.as_ref().map_or(0, |ensemble| u64::from(ensemble.samples))
            }
        }
    }

    fn rows_together(&self) -> u64 {
        match &self.strengths {
            Strengths::Hunt(_, hunt) => hunt.runs,
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Least(..) => 1,
        }
    }

    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        if let Strengths::Hunt(_, hunt) = &self.strengths {
            let mut curves: Vec<u64> = numbers.iter().map(|number| number / hunt.runs).collect();
            curves.dedup();
            let mut rows: Vec<_> = self.hunted(hunt, &curves, hunt.runs, width).into_iter().flatten().collect();
            rows.retain(|row| numbers.binary_search(&row.inputs.row).is_ok());
            return RunRow::table(&self.columns_of_runs(), &rows);
        }
        let rows: Vec<_> = numbers.iter().map(|&number| self.row(number, None)).collect();
        if let Strengths::Least(measure, scan) = &self.strengths {
            let found = self.least(*measure, scan, &rows, width);
            let rows: Vec<SearchRow> = rows.into_iter().map(|(inputs, _)| inputs).zip(found).collect();
            return StudyRows { table: Table::of(&self.columns_of_searches(*measure), &rows), failure: None };
        }
        RunRow::table(&self.columns_of_runs(), &RunRow::all(width, rows, |inputs| self.samples(inputs), || ()))
    }
}
