//! A study file → a sweep with valid values only.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::building;
use crate::input::parameters::{Parameter, Vocabulary, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, THE_FILE, number};
use crate::intensity::Measure;
use crate::spec::study::{DesignWord, RangeTable, SpacingWord, StudyFile};
use crate::spec::words::friction;
use crate::statistics::sampling::LatinHypercube;
pub use crate::sweep::check::Checks;
use crate::sweep::check::GivenParameter;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::{Design, ParameterValues, SweptParameter};
use crate::sweep::{Sweep, check, ensemble, records, space, strength};
use rocking_block::simulation::Settings;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::{Kind, Variable};

/// Reads a study from the text of its file. Paths of records are relative to `folder`.
///
/// # Errors
/// The first fault of the file or of a record that it names, with its line.
pub fn read(file: &str, text: &str, folder: &Path) -> Result<Sweep, StudyFileError> {
    read_for(file, text, folder, Checks::All)
}

/// As [`read`], with these checks.
///
/// # Errors
/// Those of [`read`].
pub fn read_for(file: &str, text: &str, folder: &Path, checks: Checks) -> Result<Sweep, StudyFileError> {
    let source = StudyText { file, text };
    let document = source.parse()?;
    let file = Section::<StudyFile>::read(source, THE_FILE, document.span(), document.get_ref())?;
    let study = &file.study;
    let samples = design(&file)?;
    let vocabulary = space::vocabulary(&file);
    let given = parameters(&file, vocabulary, samples.is_some())?;
    let in_space = space::read(&file, folder)?;
    let design = match samples {
        Some((samples, seed)) => Design::LatinHypercube(LatinHypercube::new(samples, given.len(), seed), samples),
        None => Design::Grid,
    };
    let periods = study.periods.clone().unwrap_or_default();
    let strengths = strength::read(&file)?;
    let (mut of_record, of_block) = match vocabulary {
        Vocabulary::Plane => (Measure::of_record(&periods), Measure::OF_BLOCK.to_vec()),
        Vocabulary::Space => (Measure::of_pair(&periods), Measure::of_pair_to_block()),
    };
    check::pairs(&file, vocabulary, &strengths)?;
    // Its period need not be one of `periods`.
    let elsewhere = [&Measure::OF_FLOOR[..], &of_block].concat();
    let level = strengths.measure().filter(|measure| !elsewhere.contains(measure));
    of_record.extend(level.filter(|measure| !of_record.contains(measure)));
    let (mut motions, mut remarks) = records::read(&file, folder, vocabulary, &of_record, || gravity(&given, source))?;
    let has_pulse = given.iter().any(|given| given.parameter.variable() == Some(Variable::PulseShape));
    motions = space::turned(&file, motions, has_pulse)?;
    let building = building::file::read(&file)?;
    check::building(&file, &motions, &strengths)?;
    if let Some((building, floors)) = &building {
        remarks.extend(building.doubt());
        let records = motions.iter().filter_map(|motion| motion.ground.horizontal.as_ref());
        remarks.extend(records.filter_map(|record| building.undersampled(record)));
        motions = motions.iter().flat_map(|motion| on_floors(motion, building, floors)).collect();
        of_record.extend(Measure::OF_FLOOR);
    }
    let ensemble = study.ensemble.as_ref().map(|table| ensemble::read(&file, vocabulary, table)).transpose()?;
    let without_records = motions.iter().all(|motion| !motion.has_record());
    for path in strength::KEYS.into_iter().chain(["periods"]).map(|key| format!("study.{key}")) {
        if without_records && file.get(&path).is_some() {
            return Err(file.wrong(&path, "[[records]]; it has no effect without them"));
        }
    }
    check::ensemble(&file, ensemble.as_ref(), without_records, &strengths)?;
    check::of_one_run(&file, &strengths)?;
    let parameters =
        given.iter().map(|g| SweptParameter { parameter: g.parameter, values: g.values.clone() }).collect();
    let Settings { tolerance, on_separation, .. } =
        study.run.settings().map_err(|error| file.refused("study", error.spelled(str::to_owned)))?;
    let mut sweep = Sweep {
        // Blank lines, indentation and comments do not change a study.
        text: text
            .lines()
            .map(|line| without_comment(line).trim())
            .filter(|line| !line.is_empty())
            .map(String::from)
            .collect(),
        parameters,
        design,
        space: in_space,
        motions,
        building: building.map(|(building, _)| building),
        strengths,
        ensemble,
        measures: of_record.into_iter().chain(of_block).collect(),
        tolerance,
        on_separation,
        duration: study.run.duration,
        step: study.run.step,
        friction_demand: study.run.friction_demand,
        half_cycles: study.half_cycles.map(|amplitude| amplitude.0),
        changes: Vec::new(),
        remarks,
    };
    check::combinations(&sweep, &given, &file, checks)?;
    let remarks = sweep.amplified().into_iter().chain(sweep.doubts(checks)).collect::<Vec<_>>();
    sweep.remarks.extend(remarks);
    Ok(sweep)
}

/// Returns a line of TOML without the comment at its end, which is not in quotes.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut is_escaped = false;
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') => return &line[..at],
            (None, '"' | '\'') => quote = Some(c),
            (Some('"'), '\\') if !is_escaped => {
                is_escaped = true;
                continue;
            }
            (Some(open), _) if c == open && !is_escaped => quote = None,
            _ => {}
        }
        is_escaped = false;
    }
    line
}

/// The motions of these floors under a ground motion with a horizontal record.
fn on_floors(motion: &GroundMotion, building: &building::Building, floors: &[usize]) -> Vec<GroundMotion> {
    let of_building = motion.ground.horizontal.iter().flat_map(|record| building.floor_motions(record));
    let mut of_building: Vec<_> = of_building.map(Some).collect();
    // Each floor is taken once: a list that names it twice is refused.
    floors.iter().filter_map(|&floor| of_building.get_mut(floor)?.take()).map(|found| motion.on_floor(found)).collect()
}

/// Reads the samples and the seed of a Latin hypercube; nothing for a grid.
fn design(file: &Section<StudyFile>) -> Result<Option<(u32, u64)>, StudyFileError> {
    match (&file.study.design, file.study.samples, file.study.seed) {
        (DesignWord::Grid, None, None) => Ok(None),
        (DesignWord::Grid, samples, _) => {
            let path = if samples.is_some() { "study.samples" } else { "study.seed" };
            Err(file.wrong(path, "design = \"latin-hypercube\"; a grid does not use it"))
        }
        (DesignWord::LatinHypercube, Some(samples), Some(seed)) => Ok(Some((samples, seed.0))),
        (DesignWord::LatinHypercube, None, _) => {
            Err(file.refused("study", "study has no samples; expected the number of samples"))
        }
        (DesignWord::LatinHypercube, _, None) => {
            Err(file.refused("study", "study has no seed; expected a whole number, which determines the samples"))
        }
    }
}

/// Reads the parameters in the order of the file.
fn parameters<'a>(
    file: &Section<'a, StudyFile>,
    vocabulary: Vocabulary,
    sampled: bool,
) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let Some(table) = file.get("parameters").and_then(|value| value.get_ref().as_table()) else {
        return Ok(Vec::new());
    };
    let (source, mut found) = (file.source, Vec::new());
    let others: &[&str] = if vocabulary == Vocabulary::Space { &space::SHAPE } else { &[] };
    flatten(source, vocabulary, "", table, others, &mut found)?;
    found.sort_by_key(|(_, value)| value.span().start);
    let given = found.into_iter().map(|(name, value)| {
        let parameter = vocabulary.parameter(&name).map_err(|message| source.wrong(&value.span(), message))?;
        let values = values(source, &parameter, value, sampled)?;
        Ok(GivenParameter { value, parameter, values })
    });
    given.collect()
}

/// Reads the values of a parameter: one, a list, or a range.
pub(crate) fn values<'a>(
    source: StudyText<'a>,
    parameter: &Parameter,
    value: SpannedValue<'a>,
    sampled: bool,
) -> Result<ParameterValues, StudyFileError> {
    let name = parameter.name();
    let of = |value: SpannedValue| -> Result<f64, StudyFileError> {
        let at = |message: String| source.wrong(&value.span(), message);
        let found = match (parameter.kind(), value.get_ref()) {
            (Kind::Boolean, DeValue::Boolean(truth)) => f64::from(u8::from(*truth)),
            (Kind::Enumeration, DeValue::String(item)) => parameter.item(item).map_err(at)?,
            (Kind::Real, DeValue::String(none))
                if parameter.is_friction() && none.eq_ignore_ascii_case(friction::NONE) =>
            {
                f64::INFINITY
            }
            (Kind::Boolean, _) | (_, DeValue::Boolean(_) | DeValue::String(_)) => {
                let found = source.text.get(value.span()).unwrap_or_default();
                return Err(at(format!("{name} = {found}; expected {}", parameter.expected())));
            }
            _ => number(value).ok_or_else(|| at(format!("{name} expects {}", parameter.expected())))?,
        };
        parameter.number(found).map_err(at)
    };
    match value.get_ref() {
        DeValue::Array(list) if list.is_empty() => {
            Err(source.wrong(&value.span(), format!("{name} = []; expected at least one value")))
        }
        DeValue::Array(list) => list.iter().map(of).collect::<Result<_, _>>().map(ParameterValues::List),
        DeValue::Table(table) => range(source, parameter, value, table, sampled),
        _ => of(value).map(|value| ParameterValues::List(vec![value])),
    }
}

fn range<'a>(
    source: StudyText<'a>,
    parameter: &Parameter,
    value: SpannedValue<'a>,
    table: &'a DeTable<'a>,
    sampled: bool,
) -> Result<ParameterValues, StudyFileError> {
    let name = parameter.name();
    if parameter.kind() != Kind::Real {
        return Err(source.wrong(&value.span(), format!("{name} has no range; expected a list")));
    }
    let table = Section::<RangeTable>::read(source, name, value.span(), table)?;
    let end = |key: &str, number: f64| parameter.number(number).map_err(|message| table.refused(key, message));
    let (from, to) = (end("from", table.from)?, end("to", table.to)?);
    if from >= to {
        return Err(table.wrong("to", &format!("more than from = {from}")));
    }
    let logarithmic = matches!(table.spacing, Some(SpacingWord::Log));
    if logarithmic && from <= 0.0 {
        return Err(table.wrong("from", "a number > 0 for spacing = \"log\""));
    }
    let range = ParameterValues::Range { from, to, logarithmic };
    match table.count {
        Some(_) if sampled => Err(table.wrong("count", "none, since a Latin hypercube samples the range")),
        Some(count) => {
            let last = (count - 1) as f64;
            Ok(ParameterValues::List((0..count).map(|i| range.at(i as f64 / last)).collect()))
        }
        None if sampled => Ok(range),
        None => {
            Err(source.wrong(&value.span(), format!("{name} has no count; expected the number of values of the grid")))
        }
    }
}

/// The gravity (m/s²) that converts records in g.
fn gravity(given: &[GivenParameter], source: StudyText) -> Result<f64, StudyFileError> {
    match given.iter().find(|given| given.parameter.name() == "g") {
        None => Ok(Values::default()[Variable::G]),
        Some(GivenParameter { values: ParameterValues::List(values), .. }) if values.len() == 1 => Ok(values[0]),
        Some(GivenParameter { value, .. }) => {
            let message = "g takes several values; expected one, which converts records in g";
            Err(source.wrong(&value.span(), message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a study of a block that starts tilted, with these values of p. The lines stand in `[study]`.
    fn study(lines: &str, p: &str) -> Result<Sweep, String> {
        let text = format!("[study]\n{lines}\n[parameters]\ninitial.theta = 0.1\np = {p}\n");
        read("s.toml", &text, Path::new(".")).map_err(|error| error.to_string())
    }

    #[test]
    fn choices_are_read_in_any_case() {
        for (design, rows) in [("grid", 3), ("GRID", 3)] {
            let sweep = study(&format!("design = \"{design}\""), "{ from = 1, to = 4, count = 3, spacing = \"Log\" }");
            let sweep = sweep.unwrap();
            assert_eq!(sweep.combinations(), Some(rows));
            assert!((sweep.combination(1)[1] - 2.0).abs() < 1e-15, "{:?}", sweep.combination(1));
        }
        for design in ["latin-hypercube", "Latin_Hypercube"] {
            let lines = format!("design = \"{design}\"\nsamples = 5\nseed = 1");
            assert_eq!(study(&lines, "{ from = 1, to = 4 }").unwrap().combinations(), Some(5));
        }
    }

    #[test]
    fn unknown_and_unread_values_are_refused_with_their_line() {
        let grid = "design = \"grid\"";
        for (lines, p, expected) in [
            ("design = \"cube\"", "1", "s.toml:2: design = \"cube\"; expected \"grid\" or \"latin-hypercube\""),
            ("samples = 3", "1", "s.toml:1: study has no design; expected \"grid\" or \"latin-hypercube\""),
            (
                "design = \"grid\"\nseed = 3",
                "1",
                "s.toml:3: seed = 3; expected design = \"latin-hypercube\"; a grid does not use it",
            ),
            (
                "design = \"latin-hypercube\"\nseed = 3",
                "1",
                "s.toml:1: study has no samples; expected the number of samples",
            ),
            (
                grid,
                "{ from = 1, to = 4, count = 3, spacing = \"cubic\" }",
                "s.toml:5: spacing = \"cubic\"; expected \"linear\" or \"log\"",
            ),
            (grid, "[1, inf]", "p = inf"),
            ("design = \"grid\"\ntolerance = \"small\"", "1", "s.toml:3: tolerance = \"small\"; expected"),
        ] {
            let message = study(lines, p).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
        let spread = "ensemble = { p = { distribution = \"beta\", cov = 0.1 }, samples = 3 }";
        let message = study(&format!("{grid}\n{spread}"), "1").unwrap_err();
        assert_eq!(message, "s.toml:3: distribution = \"beta\"; expected \"lognormal\", \"normal\" or \"uniform\"");
    }
}
