//! Parameters over grids or samples × records × strengths → what each block does, a row each.

use std::ops::Range;

use crate::block::Block;
use crate::excitation::PulseShape;
use crate::model::values::Values;
use crate::model::variables::Variable;
use crate::numerics::wide::Width;
use crate::records::ground::Ground;
use crate::simulation::OnSeparation;
use crate::study::ensemble::{Ensemble, Spreading, Tally};
use crate::study::friction;
use crate::study::history::Run;
use crate::study::intensity::{Measure, pga};
use crate::study::outcome::{End, Outcome};
use crate::study::parameters::Parameter;
use crate::study::resumable::Head;
use crate::study::runner::{MOST_RUNS, Study, StudyRow};
use crate::study::sampling::LatinHypercube;
use crate::study::search::{self, Found, Scan};
use crate::study::strength::{Strengths, scale_to};
use crate::study::together::outcomes;

/// A parameter and the values that it takes.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The parameter.
    pub parameter: Parameter,
    /// Its values.
    pub levels: Levels,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Levels {
    /// These; a Latin hypercube takes each of them equally often.
    List(Vec<f64>),
    /// All in a range, of which a Latin hypercube takes samples.
    Range {
        /// Least value.
        from: f64,
        /// Greatest value.
        to: f64,
        /// Whether the logarithm is evenly distributed instead of the value.
        logarithmic: bool,
    },
}

impl Levels {
    /// The value at a part of the way from the first to the last, 0 ≤ part ≤ 1.
    pub fn at(&self, part: f64) -> f64 {
        match *self {
            Levels::List(ref values) => values[((part * values.len() as f64) as usize).min(values.len() - 1)],
            Levels::Range { from, .. } if part == 0.0 => from,
            Levels::Range { to, .. } if part == 1.0 => to,
            Levels::Range { from, to, logarithmic: false } => from + part * (to - from),
            Levels::Range { from, to, logarithmic: true } => from * libm::exp(part * libm::log(to / from)),
        }
    }
}

/// How the parameters are combined.
#[derive(Clone, Debug)]
pub enum Design {
    /// Each value of each with each of all others; the last one changes fastest.
    Grid,
    /// Samples.
    LatinHypercube(LatinHypercube, u32),
}

/// A ground motion and what tells how strong it is.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The files' names as they stand in the study.
    pub names: [String; 2],
    /// The records, unscaled.
    pub ground: Ground,
    /// Measures of the horizontal record, unscaled, taken once for all blocks; no value where there is none.
    intensities: Vec<(Measure, Option<f64>)>,
    /// PGA of the vertical record (m/s²).
    vertical_pga: Option<f64>,
}

impl Motion {
    /// A motion and these measures of it, those of a record alone; `gravity` (m/s²) is that of the Arias intensity.
    pub fn new(names: [String; 2], ground: Ground, measures: &[Measure], gravity: f64) -> Motion {
        let of = |measure: Measure| ground.horizontal.as_ref().and_then(|record| measure.of(record, gravity));
        let intensities = measures.iter().map(|&measure| (measure, of(measure))).collect();
        let vertical_pga = ground.vertical.as_ref().map(pga);
        Motion { names, ground, intensities, vertical_pga }
    }

    /// A measure of the horizontal record times `scale`, beside this block if it is one of those; nothing if it has none,
    /// or was not taken.
    pub fn intensity(&self, measure: Measure, scale: f64, block: &Block) -> Option<f64> {
        let (of_record, factor) = measure.beside(block);
        let (_, value) = self.intensities.iter().find(|(taken, _)| *taken == of_record)?;
        value.map(|value| value * factor * scale.abs().powi(measure.power().into()))
    }
}

/// A sweep: each combination of parameters × each motion × each strength is a row.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// What the study is, a line each.
    pub text: Vec<String>,
    /// The parameters that the study names.
    pub factors: Vec<Factor>,
    /// How they are combined.
    pub design: Design,
    /// Ground motions, at least one, which may be none.
    pub motions: Vec<Motion>,
    /// How strong they are.
    pub strengths: Strengths,
    /// What each row is repeated with, if it is.
    pub ensemble: Option<Ensemble>,
    /// Measures of the records that stand in the table.
    pub measures: Vec<Measure>,
    /// What happens at complete separation, where the study does not name `on_separation`.
    pub on_separation: OnSeparation,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
    /// Duration of each run (s); without it, until the block has come down.
    pub duration: Option<f64>,
    /// Longest time between two stops (s); without it only the records' samples and the pulse's ends are.
    pub step: Option<f64>,
    /// Coefficient of friction (1) for a column of the longest time above it, if there is to be one.
    pub friction: Option<f64>,
}

impl Sweep {
    /// How many combinations of parameters there are; nothing if the number overflows.
    pub fn combinations(&self) -> Option<u64> {
        match &self.design {
            Design::LatinHypercube(_, samples) => Some(u64::from(*samples)),
            Design::Grid => self.factors.iter().try_fold(1_u64, |product, factor| match &factor.levels {
                Levels::List(values) => product.checked_mul(values.len() as u64),
                Levels::Range { .. } => None,
            }),
        }
    }

    /// The values of the parameters in a combination, in the order of `factors`.
    pub fn combination(&self, number: u64) -> Vec<f64> {
        match &self.design {
            Design::LatinHypercube(cube, _) => {
                let part = |direction| cube.coordinate(number as u32, direction);
                self.factors.iter().enumerate().map(|(i, factor)| factor.levels.at(part(i))).collect()
            }
            Design::Grid => {
                let mut rest = number;
                let mut values: Vec<f64> = (self.factors.iter().rev())
                    .map(|factor| match &factor.levels {
                        Levels::List(values) => {
                            let value = values[(rest % values.len() as u64) as usize];
                            rest /= values.len() as u64;
                            value
                        }
                        Levels::Range { from, .. } => *from,
                    })
                    .collect();
                values.reverse();
                values
            }
        }
    }

    /// The variables of the FMU in a combination. What the study does not name has the start value of the FMU, but for
    /// `on_separation`.
    pub fn values(&self, combination: &[f64]) -> Values {
        let mut values = Values::default();
        values[Variable::OnSeparation] = f64::from(self.on_separation as i32);
        for (factor, value) in self.factors.iter().zip(combination) {
            values[factor.parameter.metadata.variable] = *value;
        }
        values
    }

    /// What a row is. Combinations that make no block are refused before a sweep begins.
    fn place(&self, row: u64) -> Place<'_> {
        let (strengths, motions) = (self.strengths.count(), self.motions.len() as u64);
        let motion = &self.motions[(row / strengths % motions) as usize];
        let combination = self.combination(row / strengths / motions);
        let values = self.values(&combination);
        let block = values.block().unwrap_or_else(|error| unreachable!("{error}"));
        let scale = self.strengths.scale(row % strengths, motion, &block);
        Place { combination, values, block, motion, scale, level: self.strengths.level(row % strengths) }
    }

    /// The run of a row, without the spread of an ensemble.
    pub fn run(&self, row: u64) -> Run {
        let Place { values, motion, scale, .. } = self.place(row);
        self.run_of(&values, motion, scale)
    }

    fn run_of(&self, values: &Values, motion: &Motion, scale: f64) -> Run {
        Run {
            block: values.block().unwrap_or_else(|error| unreachable!("{error}")),
            settings: values.settings(Some(self.tolerance)),
            initial: values.initial(),
            pulse: values.pulse(),
            duration: self.duration,
            output_step: self.step.unwrap_or(f64::INFINITY),
            ground: motion.ground.clone().scaled(scale),
        }
    }

    /// The samples of a row.
    fn samples<'a>(&'a self, ensemble: &'a Ensemble, row: u64, place: &'a Place) -> impl Iterator<Item = Run> + 'a {
        ensemble.parts(row).into_iter().map(|parts| {
            let (mut values, mut scale) = (place.values.clone(), place.scale);
            for (spread, part) in ensemble.spreads.iter().zip(parts) {
                match &spread.of {
                    Spreading::Scale => scale = spread.value(scale, part),
                    Spreading::Parameter(parameter) => {
                        let variable = parameter.metadata.variable;
                        values[variable] = spread.value(values[variable], part);
                    }
                }
            }
            self.run_of(&values, place.motion, scale)
        })
    }

    fn samples_in_a_row(&self) -> usize {
        self.ensemble.as_ref().map_or(0, |ensemble| ensemble.samples as usize)
    }

    /// The run of a row, and its samples if it has any.
    fn runs(&self, row: u64, place: &Place) -> Vec<Run> {
        let samples = self.ensemble.iter().flat_map(|ensemble| self.samples(ensemble, row, place));
        std::iter::once(self.run_of(&place.values, place.motion, place.scale)).chain(samples).collect()
    }

    /// At which values of a measure the blocks of some rows overturn.
    fn least(&self, measure: Measure, scan: &Scan, places: &[Place], width: Option<Width>) -> Vec<Found<End>> {
        let run = |&(row, value): &(usize, f64)| {
            let Place { values, motion, block, .. } = &places[row];
            self.run_of(values, motion, scale_to(measure, value, motion, block))
        };
        let end = |outcome: Outcome| match outcome.end {
            // The run's end is not what is looked for.
            End::Separated => End::Completed,
            end => end,
        };
        search::changes(scan, places.len(), |values| {
            // Of many runs no more is kept than how they ended.
            let parts = values.chunks(MOST_RUNS as usize);
            parts.flat_map(|values| outcomes(width, values.iter().map(run), || ())).map(end).collect()
        })
    }

    /// Whether something moves the block in every combination: a record, a pulse, or its beginning.
    pub fn moves(&self, combination: &[f64], motion: &Motion) -> bool {
        let values = self.values(combination);
        let (initial, pulse) = (values.initial(), values.pulse());
        motion.ground.time_step().is_some()
            || pulse.shape != PulseShape::None && pulse.amplitude != 0.0
            || initial.theta != 0.0
            || initial.theta_dot != 0.0
            || initial.vertical.is_some()
    }
}

/// What a row of a sweep is.
struct Place<'a> {
    combination: Vec<f64>,
    values: Values,
    block: Block,
    motion: &'a Motion,
    scale: f64,
    /// The measure that is given in place of the factor, and its value.
    level: Option<(Measure, f64)>,
}

impl Place<'_> {
    /// A measure of the scaled record.
    fn intensity(&self, measure: Measure) -> Option<f64> {
        let given = self.level.filter(|(given, _)| *given == measure).map(|(_, value)| value);
        given.or_else(|| self.motion.intensity(measure, self.scale, &self.block))
    }
}

impl Study for Sweep {
    fn head(&self) -> Head {
        let mut study = vec![concat!("rocking-block ", env!("CARGO_PKG_VERSION"), " sweep").to_string()];
        study.extend(self.text.iter().cloned());
        study.push(format!("on_separation = {:?}, where the study does not name it", self.on_separation));
        for Motion { names, ground, .. } in &self.motions {
            study.push(format!("{}: {}", names.join(" + "), ground.fingerprint()));
        }
        let mut columns: Vec<String> = self.factors.iter().map(|factor| factor.parameter.heading()).collect();
        columns.extend(["record", "vertical", "scale [1]", "PGA.vertical [m/s2]"].map(String::from));
        columns.extend(self.measures.iter().map(|measure| measure.heading()));
        match &self.strengths {
            Strengths::Scales(_) | Strengths::Levels(..) => columns.extend(Outcome::COLUMNS.map(String::from)),
            Strengths::Least(measure, _) => columns.extend(least_columns(*measure)),
        }
        columns.extend(self.friction.map(friction::heading));
        columns.extend(self.ensemble.iter().flat_map(Ensemble::columns));
        Head { study, columns }
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

    fn make(&self, numbers: Range<u64>, width: Option<Width>) -> Vec<StudyRow> {
        let places: Vec<Place> = numbers.clone().map(|number| self.place(number)).collect();
        if let Strengths::Least(measure, scan) = &self.strengths {
            let found = self.least(*measure, scan, &places, width);
            return places.iter().zip(&found).map(|(place, found)| self.row_of_search(place, found)).collect();
        }
        let mut alphas = Vec::new();
        let runs = numbers.zip(&places).flat_map(|(number, place)| self.runs(number, place));
        let outcomes = outcomes(width, runs.inspect(|run| alphas.push(run.block.alpha)), || ());
        let made: Vec<(f64, Outcome)> = alphas.into_iter().zip(outcomes).collect();
        places
            .iter()
            .zip(made.chunks(1 + self.samples_in_a_row()))
            .map(|(place, made)| self.row_of(place, made))
            .collect()
    }
}

impl Sweep {
    /// What stands in a row before what became of its block.
    fn fields_of(&self, place: &Place) -> Vec<String> {
        let Place { combination, motion, scale, .. } = place;
        let mut fields: Vec<String> =
            self.factors.iter().zip(combination).map(|(factor, value)| factor.parameter.display(*value)).collect();
        fields.extend(motion.names.iter().cloned());
        let has_record = motion.ground.time_step().is_some();
        fields.push(if has_record { scale.to_string() } else { String::new() });
        let shown = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
        fields.push(shown(motion.vertical_pga.map(|pga| pga * scale.abs())));
        fields.extend(self.measures.iter().map(|&measure| shown(place.intensity(measure))));
        fields
    }

    /// The row of a search.
    fn row_of_search(&self, place: &Place, found: &Found<End>) -> StudyRow {
        let mut fields = self.fields_of(place);
        fields.extend(least_fields(found));
        StudyRow { fields, failure: None }
    }

    /// A row from the slenderness (rad) of its block and those of its samples, and what became of them.
    fn row_of(&self, place: &Place, made: &[(f64, Outcome)]) -> StudyRow {
        let mut fields = self.fields_of(place);
        let (_, outcome) = &made[0];
        fields.extend(outcome.fields(place.block.alpha));
        let run = || self.run_of(&place.values, place.motion, place.scale);
        fields.extend(self.friction.map(|friction| run().longest_above(friction).to_string()));
        if let Some(Ensemble { limits, .. }) = &self.ensemble {
            let mut tally = Tally::new(limits.len());
            made[1..].iter().for_each(|(alpha, outcome)| tally.add(outcome, *alpha, limits));
            fields.extend(tally.fields());
        }
        StudyRow { fields, failure: outcome.failure.clone() }
    }
}

/// Names and units of the columns of a row that has the outcomes at all values of a measure.
fn least_columns(measure: Measure) -> [String; 6] {
    let unit = measure.unit();
    [
        "outcome".into(),
        format!("least.{measure} [{unit}]"),
        "least.bound".into(),
        format!("always_from.{measure} [{unit}]"),
        "overturning_ranges [1]".into(),
        format!("overturning.{measure} [{unit}]"),
    ]
}

/// Whether the block overturns anywhere; the least value at which it does, and whether that is only a bound; the one from
/// which on it always does; how many ranges there are in which it does, and what they are.
fn least_fields(found: &Found<End>) -> [String; 6] {
    let stretches = found.stretches();
    let ranges: Vec<&(f64, f64, End)> = stretches.iter().filter(|stretch| stretch.2 == End::Overturned).collect();
    let any = |end: End| stretches.iter().any(|stretch| stretch.2 == end);
    let outcome =
        [End::Failed, End::Overturned, End::Undecided].into_iter().find(|&end| any(end)).unwrap_or(End::Completed);
    let shown = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    let last = stretches.last().filter(|stretch| stretch.2 == End::Overturned);
    [
        outcome.to_string(),
        shown(found.overturning().value()),
        found.overturning().bound().into(),
        shown(last.map(|stretch| stretch.0)),
        ranges.len().to_string(),
        ranges.iter().map(|(from, to, _)| format!("{from} to {to}")).collect::<Vec<_>>().join("; "),
    ]
}
