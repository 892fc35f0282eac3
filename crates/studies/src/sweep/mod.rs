//! Parameters over grids or samples × ground motions × strengths → a table of outcomes.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | parameters and their values → the combinations of a grid or a Latin hypercube |
//! | [`ground_motion`] | records → ground motions with their measures |
//! | [`strength`] | `scales`, `levels` or `least` → factors on the records |
//! | [`ensemble`] | distributions of uncertain quantities → samples of each row, probabilities |
//! | [`change`] | a block → the same block with another base, foundation, friction or ties |
//! | `records` | `[[records]]` of a study file → ground motions |
//! | [`mod@file`] | a study file → a sweep with valid values |

pub mod change;
pub mod ensemble;
pub mod file;
pub mod ground_motion;
pub mod parameters;
pub(crate) mod records;
pub mod strength;

use std::ops::Range;

use crate::intensity::Measure;
use crate::output::fields::Fields;
use crate::output::resumable::TableHeader;
use crate::output::runner::{MAX_RUNS, Study, StudyRow};
use crate::run::Run;
use crate::run::batch::outcomes;
use crate::run::outcome::{End, Holds, Outcome};
use crate::run::sliding;
use crate::search::{self, OutcomeMap, Scan};
use crate::sweep::change::Change;
use crate::sweep::ensemble::{Ensemble, SpreadTarget};
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::{Design, ParameterValues, SweptParameter};
use crate::sweep::strength::Strengths;
use rocking_block::block::{Block, BlockError};
use rocking_block::excitation::PulseShape;
use rocking_block::ground::Ground;
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
    /// Ground motions, at least one; a motion without records stands for no ground motion.
    pub motions: Vec<GroundMotion>,
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
    /// Longest time between two stops (s); without it, only record samples and pulse ends are stops.
    pub step: Option<f64>,
    /// Friction demand (1) of the column with the longest time above it, if any.
    pub friction_demand: Option<f64>,
    /// Changes of each block, one after the other. The ground motions stay those of the blocks without them.
    pub changes: Vec<Change>,
}

impl Sweep {
    /// Number of combinations of parameters; `None` if it overflows.
    pub fn combinations(&self) -> Option<u64> {
        self.design.combinations(&self.parameters)
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
        let ties = [Variable::Tie1Stiffness, Variable::Tie2Stiffness].into_iter().rposition(any);
        let holds = Holds { friction: any(Variable::Friction), ties: ties.map_or(0, |last| last + 1) };
        self.changes.iter().fold(holds, |holds, change| change.holds(holds))
    }

    /// Whether the blocks stand on the floors of a building.
    pub fn has_building(&self) -> bool {
        self.motions.iter().any(|motion| motion.floor.is_some())
    }

    /// The inputs of a row. Reading the study file has checked that all combinations are valid blocks.
    fn inputs(&self, row: u64) -> RowInputs<'_> {
        let (strengths, motions) = (self.strengths.count(), self.motions.len() as u64);
        let motion = &self.motions[(row / strengths % motions) as usize];
        let combination = self.combination(row / strengths / motions);
        let values = self.values(&combination);
        let block = values.block().unwrap_or_else(|error| unreachable!("{error}"));
        let scale = self.strengths.scale(row % strengths, motion, &block);
        RowInputs { combination, values, block, motion, scale, level: self.strengths.level(row % strengths) }
    }

    /// The run of a row, without the spread of an ensemble.
    pub fn run(&self, row: u64) -> Run {
        self.nominal_run(&self.inputs(row))
    }

    fn nominal_run(&self, RowInputs { values, motion, scale, .. }: &RowInputs) -> Run {
        self.run_of(values, motion, *scale)
    }

    /// The same sweep of changed blocks, under the same ground motions.
    #[must_use]
    pub fn with(&self, changes: &[Change]) -> Sweep {
        Sweep { changes: [&self.changes, changes].concat(), ..self.clone() }
    }

    /// Checks that all blocks are valid with these changes, and that one of them reads each changed parameter.
    ///
    /// # Errors
    /// The first invalid parameter, or the condition under which a block would read an unread one.
    pub fn check_changes(&self, changes: &[Change]) -> Result<(), String> {
        let changed = self.with(changes);
        // The condition under which a block reads the parameter; `None` once a combination has read it.
        let mut unread = Some("a combination");
        for number in 0..self.combinations().unwrap_or(0) {
            let values = self.values(&self.combination(number));
            changed.block(&values).map_err(|error| error.to_string())?;
            let values = changes.iter().fold(values, |values, change| change.values(values));
            let found = changes.iter().find_map(|change| {
                let parameter = change.parameter()?.name();
                values.unread_by_motion().find(|(name, _)| *name == parameter).map(|(_, needed)| needed)
            });
            unread = unread.and(found);
        }
        unread.map_or(Ok(()), |needed| Err(format!("no block of the study reads it; expected {needed}")))
    }

    /// The variables in the middle of the study: each parameter in the middle of its range or list.
    pub fn middle(&self) -> Values {
        let middle: Vec<f64> = self.parameters.iter().map(|swept| swept.values.at(0.5)).collect();
        self.values(&middle)
    }

    /// A ground motion at one of the strengths, scaled for a block where the strength is relative to it.
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
        self.changes.iter().try_fold(changed.block()?, |block, change| change.block(block))
    }

    fn run_of(&self, values: &Values, motion: &GroundMotion, scale: f64) -> Run {
        Run {
            block: self.block(values).unwrap_or_else(|error| unreachable!("{error}")),
            settings: values.settings(Some(self.tolerance)),
            initial: values.initial(),
            pulse: values.pulse(),
            duration: self.duration,
            output_step: self.step.unwrap_or(f64::INFINITY),
            ground: motion.ground.clone().scaled(scale),
        }
    }

    /// The runs of a row's samples.
    fn samples<'a>(
        &'a self,
        ensemble: &'a Ensemble,
        row: u64,
        inputs: &'a RowInputs,
    ) -> impl Iterator<Item = Run> + 'a {
        ensemble.probabilities(row).into_iter().map(|probabilities| {
            let (mut values, mut scale) = (inputs.values.clone(), inputs.scale);
            for (spread, probability) in ensemble.spreads.iter().zip(probabilities) {
                match &spread.target {
                    SpreadTarget::Scale => scale = spread.value(scale, probability),
                    SpreadTarget::Parameter(parameter) => {
                        let variable = parameter.metadata.variable;
                        values[variable] = spread.value(values[variable], probability);
                    }
                }
            }
            self.run_of(&values, inputs.motion, scale)
        })
    }

    fn samples_in_a_row(&self) -> usize {
        self.ensemble.as_ref().map_or(0, |ensemble| ensemble.samples as usize)
    }

    /// The run of a row, followed by its samples.
    fn runs(&self, row: u64, inputs: &RowInputs) -> Vec<Run> {
        let samples = self.ensemble.iter().flat_map(|ensemble| self.samples(ensemble, row, inputs));
        std::iter::once(self.nominal_run(inputs)).chain(samples).collect()
    }

    /// Searches, for each row, the values of a measure at which the block overturns.
    fn least(
        &self,
        measure: Measure,
        scan: &Scan,
        rows: &[RowInputs],
        width: Option<VectorWidth>,
    ) -> Vec<OutcomeMap<End>> {
        let run = |&(row, value): &(usize, f64)| {
            let RowInputs { values, motion, block, .. } = &rows[row];
            self.run_of(values, motion, motion.scale_to(measure, value, block))
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
        let (initial, pulse) = (values.initial(), values.pulse());
        motion.has_record()
            || pulse.shape != PulseShape::None && pulse.amplitude != 0.0
            || initial.theta != 0.0
            || initial.theta_dot != 0.0
            || initial.vertical.is_some()
    }
}

/// The inputs of a row.
struct RowInputs<'a> {
    combination: Vec<f64>,
    values: Values,
    block: Block,
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
        for GroundMotion { names, ground, floor, .. } in &self.motions {
            let floor = floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
            study.push(format!("{}{floor}: {}", names.join(" + "), ground.fingerprint()));
        }
        let mut columns: Vec<String> = self.parameters.iter().map(|swept| swept.parameter.heading()).collect();
        columns.extend(["record", "vertical"].map(String::from));
        columns.extend(self.has_building().then(|| "floor [1]".into()));
        columns.extend(["scale [1]", "PGA.vertical [m/s2]"].map(String::from));
        columns.extend(self.measures.iter().map(|measure| measure.heading()));
        match &self.strengths {
            Strengths::Scales(_) | Strengths::Levels(..) => {
                columns.extend(Outcome::COLUMNS.map(String::from));
                columns.extend(self.holds().columns());
            }
            Strengths::Least(measure, _) => columns.extend(least_columns(*measure)),
        }
        columns.extend(self.friction_demand.map(sliding::heading));
        columns.extend(self.ensemble.iter().flat_map(Ensemble::columns));
        TableHeader { study, columns }
    }

    fn rows(&self) -> u64 {
        self.combinations().unwrap_or(0) * self.motions.len() as u64 * self.strengths.count()
    }

    fn runs_in_a_row(&self) -> u64 {
        match &self.strengths {
            Strengths::Least(_, scan) => scan.points,
            Strengths::Scales(_) | Strengths::Levels(..) => 1 + self.samples_in_a_row() as u64,
        }
    }

    fn make(&self, numbers: Range<u64>, width: Option<VectorWidth>) -> Vec<StudyRow> {
        let rows: Vec<RowInputs> = numbers.clone().map(|number| self.inputs(number)).collect();
        if let Strengths::Least(measure, scan) = &self.strengths {
            let found = self.least(*measure, scan, &rows, width);
            return rows.iter().zip(&found).map(|(inputs, found)| self.row_of_search(inputs, found)).collect();
        }
        let mut alphas = Vec::new();
        let runs = numbers.zip(&rows).flat_map(|(number, inputs)| self.runs(number, inputs));
        let outcomes = outcomes(width, runs.inspect(|run| alphas.push(run.block.alpha)), || ());
        let made: Vec<(f64, Outcome)> = alphas.into_iter().zip(outcomes).collect();
        let made = made.chunks(1 + self.samples_in_a_row());
        rows.iter().zip(made).map(|(inputs, made)| self.row_of(inputs, made)).collect()
    }
}

impl Sweep {
    /// Whether the column with this heading has numbers and empty fields, rather than words or ranges.
    pub fn is_numeric(heading: &str) -> bool {
        heading.ends_with(']') && !heading.starts_with(RANGES)
    }

    /// The fields before the outcome.
    fn input_fields(&self, inputs: &RowInputs) -> Fields {
        let RowInputs { combination, motion, scale, .. } = inputs;
        let mut fields = Fields::default();
        fields.extend(self.parameters.iter().zip(combination).map(|(swept, value)| swept.parameter.display(*value)));
        fields.extend(&motion.names);
        fields.extend(motion.floor);
        fields.push_option(motion.has_record().then_some(*scale));
        fields.push_option(motion.vertical_pga(*scale));
        for &measure in &self.measures {
            fields.push_option(inputs.intensity(measure));
        }
        fields
    }

    /// The row of a search.
    fn row_of_search(&self, inputs: &RowInputs, found: &OutcomeMap<End>) -> StudyRow {
        let mut fields = self.input_fields(inputs);
        write_least(found, &mut fields);
        StudyRow { fields, failure: None }
    }

    /// The row of a run followed by its samples, each with the slenderness (rad) of its block.
    fn row_of(&self, inputs: &RowInputs, made: &[(f64, Outcome)]) -> StudyRow {
        let mut fields = self.input_fields(inputs);
        let (alpha, outcome) = &made[0];
        outcome.write(*alpha, &mut fields);
        fields.extend(self.holds().fields(&outcome.peaks));
        fields.extend(self.friction_demand.map(|demand| self.nominal_run(inputs).longest_above(demand)));
        if let Some(ensemble) = &self.ensemble {
            ensemble.write(&made[1..], &mut fields);
        }
        StudyRow { fields, failure: outcome.failure.clone() }
    }
}

/// Beginning of the heading of the column of overturning ranges, such as "0.79 to 0.8; 0.85 to 3", in the unit of their ends.
const RANGES: &str = "overturning.";

/// Names and units of the columns filled by [`write_least`].
fn least_columns(measure: Measure) -> [String; 6] {
    let unit = measure.unit();
    [
        "outcome".into(),
        format!("least.{measure} [{unit}]"),
        "least.bound".into(),
        format!("always_from.{measure} [{unit}]"),
        "overturning_ranges [1]".into(),
        format!("{RANGES}{measure} [{unit}]"),
    ]
}

/// Appends the overturning ranges of a search to a row.
///
/// In order: the worst outcome; the least value that overturns, and whether it is only a bound; the value above which the block
/// always overturns; the number of overturning ranges, and the ranges.
fn write_least(found: &OutcomeMap<End>, fields: &mut Fields) {
    let stretches = found.stretches();
    let ranges: Vec<&(f64, f64, End)> = stretches.iter().filter(|stretch| stretch.2 == End::Overturned).collect();
    let any = |end: End| stretches.iter().any(|stretch| stretch.2 == end);
    let outcome =
        [End::Failed, End::Overturned, End::Undecided].into_iter().find(|&end| any(end)).unwrap_or(End::Completed);
    let last = stretches.last().filter(|stretch| stretch.2 == End::Overturned);
    fields.push(outcome);
    fields.push_option(found.overturning().value());
    fields.push(found.overturning().bound());
    fields.push_option(last.map(|stretch| stretch.0));
    fields.push(ranges.len());
    fields.push(ranges.iter().map(|(from, to, _)| format!("{from} to {to}")).collect::<Vec<_>>().join("; "));
}
