//! `ensemble` of a study file → the samples of each row.

use toml::de::DeTable;

use crate::model::values::Values;
use crate::model::variables::Kind;
use crate::study::ensemble::{Distribution, Ensemble, Spread, Spreading, Width};
use crate::study::parameters::Parameter;
use crate::study::study_file::{Placed, Section, Source, StudyFileError, number};
use crate::study::sweep_file::flatten;

/// Keys that are no parameters.
const KEYS: [&str; 4] = ["samples", "seed", "limits", "scale"];
/// More spreads than anybody has, each of which doubles the corners that are checked.
const MOST_SPREADS: usize = 8;

/// Reads the table `ensemble`.
pub(super) fn read(study: &Section, source: Source) -> Result<Option<Ensemble>, StudyFileError> {
    let Some(value) = study.get("ensemble") else { return Ok(None) };
    const EXPECTED: &str = "a table, as in { scale = 0.1, samples = 9 }";
    let table: &DeTable = value.get_ref().as_table().ok_or_else(|| study.wrong("ensemble", value, EXPECTED))?;
    let mut found = Vec::new();
    flatten(source, "", table, &KEYS, &mut found)?;
    found.sort_by_key(|(_, value)| value.span().start);
    let keys: Vec<&str> = table.keys().map(|key| key.get_ref().as_ref()).collect();
    let section = Section::new(source, "ensemble", value.span(), table, &keys)?;
    let mut spreads = Vec::new();
    if let Some(value) = section.get("scale") {
        spreads.push(spread(source, "scale", Spreading::Scale, value)?);
    }
    for (name, value) in &found {
        let parameter = Parameter::named(name).map_err(|message| source.wrong(&value.span(), message))?;
        if parameter.metadata.kind != Kind::Real {
            return Err(source
                .wrong(&value.span(), format!("{name} has no distribution; expected a parameter that is a number")));
        }
        spreads.push(spread(source, name, Spreading::Parameter(parameter), value)?);
    }
    if !(1..=MOST_SPREADS).contains(&spreads.len()) {
        let message =
            format!("ensemble spreads {} values; expected scale or parameters, 1 to {MOST_SPREADS}", spreads.len());
        return Err(source.wrong(&value.span(), message));
    }
    let samples = section.integer("samples", 1..100_001)?;
    let samples = samples.ok_or_else(|| section.lacks("samples", "how many runs each row is made of"))?;
    let seed = section.integer("seed", 0..1 << 63)?;
    if spreads.len() > 1 && seed.is_none() {
        return Err(section.lacks("seed", "a whole number, from which follows which values of several spreads meet"));
    }
    if let (1, Some(value)) = (spreads.len(), section.get("seed")) {
        return Err(section.wrong("seed", value, "several spreads, without which nothing reads it"));
    }
    let limits = section.numbers("limits", |x| x > 0.0, "a list of numbers > 0, as in [0.5, 0.75]")?;
    Ok(Some(Ensemble { samples: samples as u32, seed: seed.unwrap_or(0), spreads, limits: limits.unwrap_or_default() }))
}

/// A coefficient of variation, or a table with a distribution and its width.
fn spread(source: Source, name: &str, of: Spreading, value: Placed) -> Result<Spread, StudyFileError> {
    const EXPECTED: &str = "a coefficient of variation > 0, or a table as in { distribution = \"normal\", cov = 0.1 }";
    let Some(table) = value.get_ref().as_table() else {
        let relative = number(value).filter(|width| *width > 0.0 && width.is_finite());
        let relative = relative.ok_or_else(|| source.wrong(&value.span(), format!("{name} expects {EXPECTED}")))?;
        return Ok(Spread { of, distribution: Distribution::Lognormal, width: Width::Relative(relative) });
    };
    let section = Section::new(source, name, value.span(), table, &["distribution", "cov", "deviation"])?;
    let distribution = match (section.word("distribution")?.as_deref(), section.get("distribution")) {
        (Some("lognormal"), _) | (_, None) => Distribution::Lognormal,
        (Some("normal"), _) => Distribution::Normal,
        (Some("uniform"), _) => Distribution::Uniform,
        (_, Some(value)) => {
            return Err(section.wrong("distribution", value, "\"lognormal\", \"normal\" or \"uniform\""));
        }
    };
    let width = |key| section.number(key, |x| x > 0.0, "a number > 0");
    let width = match (width("cov")?, width("deviation")?) {
        (Some(relative), None) => Width::Relative(relative),
        (None, Some(deviation)) => Width::Absolute(deviation),
        _ => return Err(section.lacks("cov", "either cov or deviation, a number > 0")),
    };
    Ok(Spread { of, distribution, width })
}

/// Checks that whatever values of an ensemble meet make a block, and that the block reads them; the error says why not.
/// Blocks that are valid in all corners are valid between them.
pub(super) fn check(ensemble: &Ensemble, values: &Values) -> Result<(), String> {
    let ends = [0.5 / f64::from(ensemble.samples), 1.0 - 0.5 / f64::from(ensemble.samples)];
    for corner in 0..1_usize << ensemble.spreads.len() {
        let mut values = values.clone();
        for (number, spread) in ensemble.spreads.iter().enumerate() {
            let Spreading::Parameter(parameter) = &spread.of else { continue };
            let (name, variable) = (parameter.name(), parameter.metadata.variable);
            let nominal = values[variable];
            if nominal == 0.0
                && (matches!(spread.width, Width::Relative(_)) || spread.distribution == Distribution::Lognormal)
            {
                let expected = "a deviation of a normal or uniform distribution";
                return Err(format!("{name} = 0 has no coefficient of variation; expected {expected}"));
            }
            values[variable] = spread.value(nominal, ends[corner >> number & 1]);
            parameter
                .metadata
                .admits(values[variable])
                .map_err(|message| format!("in a sample of the ensemble, {message}"))?;
        }
        values.block().map_err(|error| format!("in a sample of the ensemble, {error}"))?;
        let unread = |(name, needed): (&str, &str)| {
            let is = |spread: &Spread| matches!(&spread.of, Spreading::Parameter(p) if p.metadata.name == name);
            let name = Parameter::named(name).ok()?.name();
            let spread = ensemble.spreads.iter().find(|spread| is(spread));
            spread.map(|_| format!("{name} of the ensemble is not read; expected {needed}"))
        };
        if let Some(message) = values.unread_by_motion().find_map(unread) {
            return Err(message);
        }
    }
    Ok(())
}
