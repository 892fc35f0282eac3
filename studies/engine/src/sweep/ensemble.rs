//! `ensemble` of a study file → samples of each row and the limits exceeded.
//!
//! Overturning under a given record is close to chance: a change of the record by one percent changes four outcomes in a hundred
//! (docs/studies/fragility.md). A probability over small unknown variations can be predicted.

use crate::input::parameters::{Parameter, Vocabulary, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, number};
use crate::output::table::TableColumn;
use crate::run::limit::Limit;
use crate::run::outcome::End;
use crate::run::rows::RunOutcome;
use crate::spec::study::{Distribution, EnsembleTable, SpreadTable, StudyFile};
use crate::spec::values::Word;
use crate::statistics::normal;
use crate::statistics::sampling::shuffled;
use rocking_block::unit::variables::Kind;

/// The samples of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    /// Number of samples, at least one.
    pub samples: u32,
    /// Decides how the values of several spreads are paired.
    pub seed: u64,
    /// The uncertain quantities, at least one.
    pub spreads: Vec<UncertainQuantity>,
    /// Limits whose exceedances are counted; overturning comes first.
    pub limits: Vec<Limit>,
}

/// An uncertain quantity and its distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainQuantity {
    /// The quantity.
    pub target: SpreadTarget,
    /// The kind of distribution.
    pub distribution: Distribution,
    /// The standard deviation.
    pub width: SpreadWidth,
}

/// The quantity that an ensemble varies.
#[derive(Clone, Debug, PartialEq)]
pub enum SpreadTarget {
    /// The factor on the records.
    Scale,
    /// A parameter of the block, its initial state or the pulse.
    Parameter(Parameter),
}

/// The standard deviation of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpreadWidth {
    /// Coefficient of variation (1), relative to the row's value. For a lognormal distribution, relative to the mean.
    Relative(f64),
    /// In the unit of the value. A lognormal distribution takes its ratio to the row's value as `Relative`.
    Absolute(f64),
}

impl UncertainQuantity {
    /// The quantile at `probability` in a row with the value `nominal`. The probability is above 0 and below 1.
    pub fn value(&self, nominal: f64, probability: f64) -> f64 {
        let (relative, deviation) = match self.width {
            SpreadWidth::Relative(relative) => (relative, relative * nominal.abs()),
            SpreadWidth::Absolute(deviation) => (deviation / nominal.abs(), deviation),
        };
        match self.distribution {
            Distribution::Uniform => nominal + deviation * 3.0_f64.sqrt() * (2.0 * probability - 1.0),
            Distribution::Normal => nominal + deviation * normal::quantile(probability),
            Distribution::Lognormal => {
                nominal * libm::exp(libm::log1p(relative * relative).sqrt() * normal::quantile(probability))
            }
        }
    }
}

impl Ensemble {
    /// For each sample of a row, the probability at which it takes each spread's quantile.
    ///
    /// In each row a spread takes the midpoints `(i + ½)/n` of n strata of equal probability. The fraction of a distribution beyond
    /// a threshold is then off by at most 1/(2n), and on average by less than with random points in the strata or anywhere.
    /// The pairing of several spreads is drawn anew for each row: a Latin hypercube.
    pub fn probabilities(&self, row: u64) -> Vec<Vec<f64>> {
        let directions = self.spreads.len() as u64;
        let strata: Vec<Vec<u32>> = (0..directions)
            .map(|direction| match direction {
                0 => (0..self.samples).collect(),
                // The top bit keeps these streams apart from those of a design with the same seed.
                _ => shuffled(self.samples, self.seed, (1 << 63) | (row * directions + direction)),
            })
            .collect();
        let midpoint = |stratum: u32| (f64::from(stratum) + 0.5) / f64::from(self.samples);
        (0..self.samples as usize).map(|sample| strata.iter().map(|of| midpoint(of[sample])).collect()).collect()
    }

    /// The columns of a row's samples, by their outcomes.
    ///
    /// A fraction is that of the samples with a known verdict, and missing if there are none. The number of the others gives its range.
    pub(super) fn columns<'c, R: 'c, O: RunOutcome + 'c>(&self, samples: fn(&R) -> &[O]) -> Vec<TableColumn<'c, R>> {
        let ended = move |row: &R, end| samples(row).iter().filter(|outcome| outcome.end() == end).count();
        let verdicts = move |row: &R, limit: Limit, found: Option<bool>| {
            samples(row).iter().filter(|sample| limit.verdict(sample.end(), sample.response(limit)) == found).count()
        };
        let mut columns = vec![
            TableColumn::count("ensemble.samples", move |row| samples(row).len()),
            TableColumn::count("ensemble.failed", move |row| ended(row, End::Failed)),
            TableColumn::count("ensemble.undecided", move |row| ended(row, End::Undecided)),
        ];
        let limits = || self.limits.iter().copied();
        columns.extend(
            limits().map(|limit| {
                TableColumn::count(format!("ensemble.{limit}"), move |row| verdicts(row, limit, Some(true)))
            }),
        );
        columns.extend(limits().map(|limit| {
            TableColumn::count(format!("ensemble.unknown({limit})"), move |row| verdicts(row, limit, None))
        }));
        columns.extend(limits().map(|limit| {
            TableColumn::optional(format!("P({limit})"), "1", move |row| {
                let [exceeded, not] = [true, false].map(|exceeds| verdicts(row, limit, Some(exceeds)));
                (exceeded + not > 0).then(|| exceeded as f64 / (exceeded + not) as f64)
            })
        }));
        columns
    }
}

/// Greatest number of spreads; each doubles the number of corners to check.
const MAX_SPREADS: usize = 8;

/// Reads the table `ensemble`.
pub(super) fn read(
    file: &Section<StudyFile>,
    vocabulary: Vocabulary,
    given: &EnsembleTable,
) -> Result<Ensemble, StudyFileError> {
    let source = file.source;
    let refused = |message: String| file.refused("study.ensemble", message);
    let mut found = Vec::new();
    if let Some(table) = file.get("study.ensemble").and_then(|value| value.get_ref().as_table()) {
        flatten(source, vocabulary, "", table, &["samples", "seed", "limits", "scale"], &mut found)?;
    }
    found.sort_by_key(|(_, value)| value.span().start);
    let mut spreads = Vec::new();
    if let Some(value) = file.get("study.ensemble.scale") {
        spreads.push(spread(source, "scale", SpreadTarget::Scale, value)?);
    }
    for (name, value) in &found {
        let parameter = vocabulary.parameter(name).map_err(|message| source.wrong(&value.span(), message))?;
        if parameter.kind() != Kind::Real {
            return Err(source
                .wrong(&value.span(), format!("{name} has no distribution; expected a parameter that is a number")));
        }
        spreads.push(spread(source, name, SpreadTarget::Parameter(parameter), value)?);
    }
    if !(1..=MAX_SPREADS).contains(&spreads.len()) {
        let found = spreads.len();
        return Err(refused(format!(
            "ensemble spreads {found} values; expected scale or parameters, 1 to {MAX_SPREADS}"
        )));
    }
    match (spreads.len(), given.seed) {
        (1, Some(_)) => return Err(file.wrong("study.ensemble.seed", "several spreads; a single one does not use it")),
        (2.., None) => {
            let expected = "a whole number, which decides how the values of several spreads are paired";
            return Err(refused(format!("ensemble has no seed; expected {expected}")));
        }
        _ => (),
    }
    let limit = |(number, word): (usize, &Word)| {
        const EXPECTED: &str = "a number > 0 for |theta|/alpha, \"balance\", \"breaks\", or a slip or plastic elongation in metres, as in \"slip:0.1\" or \"plastic:0.02\"";
        const IN_SPACE: &str = "a number > 0 for the tilt over that of the balance, \"balance\", or \"twist:0.1\" in rad, \"slip:0.1\" or \"drift:0.1\" in metres";
        let limit = word.limit().ok().map(|limit| match vocabulary {
            Vocabulary::Plane => limit,
            Vocabulary::Space => limit.in_space(),
        });
        let fits = |limit: &Limit| match limit {
            Limit::Overturned | Limit::HalfCycles(_) => false,
            Limit::Slip(_) => true,
            Limit::Balance | Limit::Rotation(_) | Limit::Plastic(_) | Limit::Breaks => vocabulary == Vocabulary::Plane,
            Limit::Tilt(_) | Limit::Twist(_) | Limit::Drift(_) => vocabulary == Vocabulary::Space,
        };
        let expected = match vocabulary {
            Vocabulary::Plane => EXPECTED,
            Vocabulary::Space => IN_SPACE,
        };
        limit.filter(fits).ok_or_else(|| file.wrong(&format!("study.ensemble.limits.{number}"), expected))
    };
    let others: Vec<Limit> = given.limits.iter().flatten().enumerate().map(limit).collect::<Result<_, _>>()?;
    let limits = std::iter::once(Limit::Overturned).chain(others).collect();
    Ok(Ensemble { samples: given.samples, seed: given.seed.map_or(0, |seed| seed.0), spreads, limits })
}

/// Reads a coefficient of variation, or a table with a distribution and its width.
fn spread<'a>(
    source: StudyText<'a>,
    name: &str,
    target: SpreadTarget,
    value: SpannedValue<'a>,
) -> Result<UncertainQuantity, StudyFileError> {
    const EXPECTED: &str = "a coefficient of variation > 0, or a table as in { distribution = \"normal\", cov = 0.1 }";
    let Some(table) = value.get_ref().as_table() else {
        let relative = number(value).filter(|width| *width > 0.0 && width.is_finite());
        let relative = relative.ok_or_else(|| source.wrong(&value.span(), format!("{name} expects {EXPECTED}")))?;
        return Ok(UncertainQuantity {
            target,
            distribution: Distribution::Lognormal,
            width: SpreadWidth::Relative(relative),
        });
    };
    let table = Section::<SpreadTable>::read(source, name, value.span(), table)?;
    let width = match (table.cov, table.deviation) {
        (Some(relative), None) => SpreadWidth::Relative(relative.0),
        (None, Some(deviation)) => SpreadWidth::Absolute(deviation.0),
        _ => {
            let message = format!("{name} has no cov; expected either cov or deviation, a number > 0");
            return Err(source.wrong(&value.span(), message));
        }
    };
    Ok(UncertainQuantity { target, distribution: table.distribution.unwrap_or(Distribution::Lognormal), width })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(distribution: Distribution, width: SpreadWidth) -> UncertainQuantity {
        UncertainQuantity { target: SpreadTarget::Scale, distribution, width }
    }

    /// Checks the median or mean, the standard deviation, and the reference of a relative width.
    #[test]
    fn distributions_have_the_requested_width() {
        const COUNT: u32 = 20_000;
        for distribution in [Distribution::Uniform, Distribution::Normal, Distribution::Lognormal] {
            for (nominal, width) in [(2.0, SpreadWidth::Relative(0.3)), (-0.5, SpreadWidth::Absolute(0.15))] {
                let spread = spread(distribution, width);
                let values: Vec<f64> =
                    (0..COUNT).map(|i| spread.value(nominal, (f64::from(i) + 0.5) / f64::from(COUNT))).collect();
                let mean = values.iter().sum::<f64>() / f64::from(COUNT);
                let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / f64::from(COUNT);
                assert!((variance.sqrt() / mean.abs() / 0.3 - 1.0).abs() < 2e-3, "{distribution:?} {mean} {variance}");
                assert!((spread.value(nominal, 0.5) / nominal - 1.0).abs() < 1e-15);
                if distribution != Distribution::Lognormal {
                    assert!((mean / nominal - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    /// Each row has one sample per stratum. The order differs between rows and between all spreads but the first.
    #[test]
    fn samples_are_the_midpoints_of_strata() {
        let scale = spread(Distribution::Normal, SpreadWidth::Relative(0.1));
        let ensemble = Ensemble { samples: 9, seed: 4, spreads: vec![scale; 3], limits: Vec::new() };
        let of = |row: u64, direction: usize| {
            ensemble.probabilities(row).iter().map(|sample| sample[direction]).collect::<Vec<_>>()
        };
        let midpoints: Vec<f64> = (0..9).map(|i| (f64::from(i) + 0.5) / 9.0).collect();
        for (row, direction) in [(0, 0), (0, 1), (0, 2), (1, 1), (7, 2)] {
            let mut sorted = of(row, direction);
            sorted.sort_by(f64::total_cmp);
            assert_eq!(sorted, midpoints);
        }
        assert_eq!(of(5, 0), midpoints);
        assert_ne!(of(0, 1), of(0, 2));
        assert_ne!(of(0, 1), of(1, 1));
        assert_eq!(of(3, 2), of(3, 2));
    }
}
