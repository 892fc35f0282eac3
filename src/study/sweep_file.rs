//! A study file → a sweep of which every value is known to be good.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::model::values::Values;
use crate::model::variables::{Kind, Variable};
use crate::simulation::{OnSeparation, Settings};
use crate::study::ensemble::Spreading;
use crate::study::history::{LONGEST, SHORTEST};
use crate::study::intensity::{self, Measure};
use crate::study::parameters::Parameter;
use crate::study::sampling::LatinHypercube;
use crate::study::strength::Strengths;
use crate::study::study_file::{Placed, Section, Source, StudyFileError, number};
use crate::study::sweep::{Design, Factor, Levels, Motion, Sweep};
use crate::study::{sweep_ensemble, sweep_records, sweep_strength};

/// More rows than anybody waits for.
const MOST_ROWS: u64 = 1_000_000_000;

/// A parameter of the file and where it stands there.
struct Given<'a> {
    value: Placed<'a>,
    parameter: Parameter,
    levels: Levels,
}

/// Reads a study from the text of its file. The records' paths are relative to `folder`.
pub fn read(file: &str, text: &str, folder: &Path) -> Result<Sweep, StudyFileError> {
    let source = Source { file, text };
    let document = source.parse()?;
    let (table, place) = (document.get_ref(), document.span());
    let root = Section::new(source, "the file", place, table, &["study", "parameters", "records"])?;
    let keys = ["design", "samples", "seed", "periods", "tolerance", "duration", "step", "friction", "ensemble"];
    let keys = [&keys[..], &sweep_strength::KEYS].concat();
    let study = root.section("study", &keys)?.ok_or_else(|| root.lacks("[study]", "design = \"grid\" at least"))?;
    let samples = design(&study)?;
    let given = parameters(&root, source, samples.is_some())?;
    let design = match samples {
        Some((samples, seed)) => Design::LatinHypercube(LatinHypercube::new(samples, given.len(), seed), samples),
        None => Design::Grid,
    };
    let periods = study
        .numbers(
            "periods",
            |x| intensity::PERIODS.contains(&x),
            "a list of times from 0.001 to 1000 s, as in [0.5, 1.0]",
        )?
        .unwrap_or_default();
    let strengths = sweep_strength::read(&study)?;
    let mut of_record = Measure::of_record(&periods);
    // One at a period that the study does not name is taken too.
    let level = strengths.measure().filter(|measure| !Measure::OF_BLOCK.contains(measure));
    of_record.extend(level.filter(|measure| !of_record.contains(measure)));
    let motions = sweep_records::read(&root, source, folder, &of_record, || gravity(&given, source))?;
    let ensemble = sweep_ensemble::read(&study, source)?;
    let without = motions.iter().all(|motion| motion.ground.time_step().is_none());
    for key in sweep_strength::KEYS.into_iter().chain(["periods"]) {
        if let (true, Some(value)) = (without, study.get(key)) {
            return Err(study.wrong(key, value, "[[records]], without which nothing reads it"));
        }
    }
    if let (Some(ensemble), Some(value)) = (&ensemble, study.get("ensemble")) {
        if without && ensemble.spreads.iter().any(|spread| spread.of == Spreading::Scale) {
            return Err(source.wrong(&value.span(), "scale has no effect without [[records]]"));
        }
        if matches!(strengths, Strengths::Least(..)) {
            return Err(study.wrong("ensemble", value, "none beside least, whose rows are many runs each"));
        }
    }
    let friction = study.number("friction", |x| x > 0.0, "a coefficient > 0")?;
    if let (Strengths::Least(..), Some(_), Some(value)) = (&strengths, friction, study.get("friction")) {
        return Err(study.wrong("friction", value, "none beside least, whose rows are many runs each"));
    }
    let tolerance = study.number("tolerance", Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)?;
    let factors = given.iter().map(|g| Factor { parameter: g.parameter, levels: g.levels.clone() }).collect();
    let sweep = Sweep {
        // What a line says counts, not how it is set.
        text: text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && !line.starts_with('#'))
            .map(String::from)
            .collect(),
        factors,
        design,
        motions,
        strengths,
        ensemble,
        measures: of_record.into_iter().chain(Measure::OF_BLOCK).collect(),
        tolerance: tolerance.unwrap_or(Settings::OF_STUDIES),
        on_separation: OnSeparation::Fly,
        duration: study.number("duration", |x| x > 0.0 && x <= LONGEST, "a time > 0 s, at most 1e6 s")?,
        step: study.number("step", |x| x >= SHORTEST, "a time of at least 1e-6 s")?,
        friction,
    };
    check(&sweep, &given, &study, source)?;
    Ok(sweep)
}

/// Samples and seed of a Latin hypercube; nothing for a grid.
fn design(study: &Section) -> Result<Option<(u32, u64)>, StudyFileError> {
    const EXPECTED: &str = "\"grid\" or \"latin-hypercube\"";
    let design = study.word("design")?.ok_or_else(|| study.lacks("design", EXPECTED))?;
    let samples = study.integer("samples", 1..10_000_001)?;
    let seed = study.integer("seed", 0..1 << 63)?;
    match (design.as_str(), study.get("design")) {
        ("grid", _) => {
            for key in ["samples", "seed"] {
                if let Some(value) = study.get(key) {
                    return Err(study.wrong(
                        key,
                        value,
                        "design = \"latin-hypercube\", without which nothing reads it",
                    ));
                }
            }
            Ok(None)
        }
        ("latin-hypercube", _) => {
            let samples = samples.ok_or_else(|| study.lacks("samples", "how many samples are taken"))?;
            let seed = seed.ok_or_else(|| study.lacks("seed", "a whole number, from which the samples follow"))?;
            Ok(Some((samples as u32, seed)))
        }
        (_, Some(value)) => Err(study.wrong("design", value, EXPECTED)),
        (_, None) => Err(study.lacks("design", EXPECTED)),
    }
}

/// The parameters in the order of the file.
fn parameters<'a>(root: &Section<'a>, source: Source, sampled: bool) -> Result<Vec<Given<'a>>, StudyFileError> {
    let Some(value) = root.get("parameters") else { return Ok(Vec::new()) };
    let table = value.get_ref().as_table().ok_or_else(|| root.wrong("parameters", value, "a table"))?;
    let mut found = Vec::new();
    flatten(source, "", table, &[], &mut found)?;
    found.sort_by_key(|(_, value)| value.span().start);
    let given = found.into_iter().map(|(name, value)| {
        let parameter = Parameter::named(&name).map_err(|message| source.wrong(&value.span(), message))?;
        let levels = levels(source, &parameter, value, sampled)?;
        Ok(Given { value, parameter, levels })
    });
    given.collect()
}

/// The parameters of a table and its groups, except keys of another meaning. `alpha` may be called `dimensionless.alpha` too,
/// in quotes, with a dot, or in a table of its group.
pub(super) fn flatten<'a>(
    source: Source,
    prefix: &str,
    table: &'a DeTable<'a>,
    others: &[&str],
    found: &mut Vec<(String, Placed<'a>)>,
) -> Result<(), StudyFileError> {
    for (key, value) in table {
        if others.contains(&key.get_ref().as_ref()) {
            continue;
        }
        let name = format!("{prefix}{}", key.get_ref());
        match value.get_ref().as_table() {
            Some(group) if Parameter::is_group(&name) => flatten(source, &format!("{name}."), group, &[], found)?,
            _ => {
                let parameter = Parameter::named(&name).map_err(|message| source.wrong(&key.span(), message))?;
                if found.iter().any(|(known, _)| Parameter::named(known) == Ok(parameter)) {
                    return Err(source.wrong(&key.span(), format!("{name} is there twice")));
                }
                found.push((name, value));
            }
        }
    }
    Ok(())
}

/// The values of a parameter: one, a list, or a range.
fn levels(source: Source, parameter: &Parameter, value: Placed, sampled: bool) -> Result<Levels, StudyFileError> {
    let name = parameter.name();
    let of = |value: Placed| -> Result<f64, StudyFileError> {
        let at = |message: String| source.wrong(&value.span(), message);
        let found = match (parameter.metadata.kind, value.get_ref()) {
            (Kind::Boolean, DeValue::Boolean(truth)) => f64::from(u8::from(*truth)),
            (Kind::Enumeration, DeValue::String(item)) => parameter.item(item).map_err(at)?,
            (Kind::Boolean, _) | (_, DeValue::Boolean(_) | DeValue::String(_)) => {
                let found = source.text.get(value.span()).unwrap_or_default();
                return Err(at(format!("{name} = {found}; expected {}", parameter.expected())));
            }
            _ => number(value).ok_or_else(|| at(format!("{name} expects {}", parameter.expected())))?,
        };
        parameter.metadata.admits(found).map_err(at)?;
        Ok(found)
    };
    match value.get_ref() {
        DeValue::Array(list) if list.is_empty() => {
            Err(source.wrong(&value.span(), format!("{name} = []; expected at least one value")))
        }
        DeValue::Array(list) => list.iter().map(of).collect::<Result<_, _>>().map(Levels::List),
        DeValue::Table(table) => range(source, parameter, value, table, of, sampled),
        _ => of(value).map(|value| Levels::List(vec![value])),
    }
}

fn range(
    source: Source,
    parameter: &Parameter,
    value: &Spanned<DeValue>,
    table: &DeTable,
    of: impl Fn(Placed) -> Result<f64, StudyFileError>,
    sampled: bool,
) -> Result<Levels, StudyFileError> {
    let name = parameter.name();
    let section = Section::new(source, name, value.span(), table, &["from", "to", "count", "spacing"])?;
    if parameter.metadata.kind != Kind::Real {
        return Err(source.wrong(&value.span(), format!("{name} has no range; expected a list")));
    }
    let end = |key| section.get(key).ok_or_else(|| section.lacks(key, "from and to, as in { from = 1, to = 4 }"));
    let (from, to) = (of(end("from")?)?, of(end("to")?)?);
    if from >= to {
        return Err(section.wrong("to", end("to")?, &format!("more than from = {from}")));
    }
    let logarithmic = match (section.word("spacing")?.as_deref(), section.get("spacing")) {
        (None | Some("linear"), _) => false,
        (Some("log"), _) if from > 0.0 => true,
        (Some("log"), _) => return Err(section.wrong("from", end("from")?, "a number > 0 for spacing = \"log\"")),
        (_, Some(value)) => return Err(section.wrong("spacing", value, "\"linear\" or \"log\"")),
        (_, None) => false,
    };
    let range = Levels::Range { from, to, logarithmic };
    match (section.integer("count", 2..1_000_001)?, section.get("count")) {
        (Some(_), Some(value)) if sampled => {
            Err(section.wrong("count", value, "none, since a Latin hypercube takes samples"))
        }
        (Some(count), _) => {
            let last = (count - 1) as f64;
            Ok(Levels::List((0..count).map(|i| range.at(i as f64 / last)).collect()))
        }
        (None, _) if sampled => Ok(range),
        (None, _) => Err(section.lacks("count", "how many values a grid takes")),
    }
}

/// The gravity by which records in g are read (m/s²).
fn gravity(given: &[Given], source: Source) -> Result<f64, StudyFileError> {
    match given.iter().find(|given| given.parameter.metadata.variable == Variable::G) {
        None => Ok(Values::default()[Variable::G]),
        Some(Given { levels: Levels::List(values), .. }) if values.len() == 1 => Ok(values[0]),
        Some(Given { value, .. }) => {
            let message = "g takes several values; expected one, by which records in g are read";
            Err(source.wrong(&value.span(), message))
        }
    }
}

/// What only shows when all is put together: the number of rows, parameters that nothing reads, and blocks that are none.
fn check(sweep: &Sweep, given: &[Given], study: &Section, source: Source) -> Result<(), StudyFileError> {
    let line = |name: &str| {
        given.iter().find(|Given { parameter, .. }| {
            let full = parameter.metadata.name;
            full == name || full.ends_with(&format!(".{name}"))
        })
    };
    let place = |key: &str| study.get(key).map_or(0..0, |value| value.span());
    let per_combination = sweep.motions.len() as u64 * sweep.strengths.count();
    let combinations = sweep.combinations();
    let rows = combinations.and_then(|count| count.checked_mul(per_combination)).filter(|rows| *rows <= MOST_ROWS);
    if rows.is_none() {
        let message = format!("combinations × records × strengths are too many rows; expected at most {MOST_ROWS}");
        return Err(source.wrong(&(0..0), message));
    }
    // What each parameter needs to be read, until a combination reads it.
    let mut needed: Vec<Option<&str>> = vec![Some("a combination"); given.len()];
    for number in 0..combinations.unwrap_or(0) {
        let combination = sweep.combination(number);
        let values = sweep.values(&combination);
        let block = values.block().map_err(|error| {
            let place = line(error.name()).map_or(0..0, |given| given.value.span());
            source.wrong(&place, error.to_string())
        })?;
        let is_given = |variable: &&Variable| given.iter().any(|given| given.parameter.metadata.variable == **variable);
        if let Some(missing) = values.sizes().iter().find(|variable| !is_given(variable)) {
            let sizes: Vec<&str> = values.sizes().iter().map(|variable| variable.name()).collect();
            let place = line("parameterization").map_or(0..0, |given| given.value.span());
            let message =
                format!("parameterization = \"Physical\" without {}; expected {}", missing.name(), sizes.join(", "));
            return Err(source.wrong(&place, message));
        }
        if let Some(measure) = sweep.strengths.measure() {
            let has_none = |motion: &&Motion| motion.intensity(measure, 1.0, &block).is_none_or(|value| value <= 0.0);
            if let Some(motion) = sweep.motions.iter().find(has_none) {
                let key = if study.get("levels").is_some() { "levels" } else { "least" };
                let message = format!("the horizontal record of {} has no {measure} above 0", motion.names.join(" "));
                return Err(source.wrong(&place(key), message));
            }
        }
        if let Some(ensemble) = &sweep.ensemble {
            sweep_ensemble::check(ensemble, &values).map_err(|message| source.wrong(&place("ensemble"), message))?;
        }
        if !sweep.motions.iter().all(|motion| sweep.moves(&combination, motion)) {
            let message = "nothing moves the block; expected [[records]], a pulse.shape with a pulse.amplitude, \
                           or an initial.theta or initial.theta_dot";
            return Err(source.wrong(&line("amplitude").map_or(0..0, |given| given.value.span()), message));
        }
        for (given, needed) in given.iter().zip(&mut needed).filter(|(_, needed)| needed.is_some()) {
            let unread = values.unread_by_motion().find(|(name, _)| *name == given.parameter.metadata.name);
            *needed = unread.map(|(_, needed)| needed);
        }
    }
    match given.iter().zip(&needed).find_map(|(given, needed)| needed.map(|needed| (given, needed))) {
        Some((given, needed)) => {
            let name = given.parameter.name();
            let message = format!("{name} is read by no block of the study; expected {needed}");
            Err(source.wrong(&given.value.span(), message))
        }
        None => Ok(()),
    }
}
