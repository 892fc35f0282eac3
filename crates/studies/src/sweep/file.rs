//! A study file → a sweep with valid values only.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::building;
use crate::input::parameters::{Parameter, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, number};
use crate::intensity::{self, Measure};
use crate::run::{MAX_DURATION, MIN_STEP};
use crate::spec::study::{RangeTable, StudyFile, StudyTable};
use crate::spec::words::friction;
use crate::statistics::sampling::LatinHypercube;
use crate::sweep::ensemble::{Ensemble, SpreadTarget};
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::{Design, ParameterValues, SweptParameter};
use crate::sweep::strength::Strengths;
use crate::sweep::{Sweep, ensemble, records, strength};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::{Kind, Variable};

/// Greatest number of rows of a sweep.
const MAX_ROWS: u64 = 1_000_000_000;

/// A parameter of the file and the place of its value in the text.
struct GivenParameter<'a> {
    value: SpannedValue<'a>,
    parameter: Parameter,
    values: ParameterValues,
}

/// Reads a study from the text of its file. Paths of records are relative to `folder`.
///
/// # Errors
/// The first fault of the file or of a record that it names, with its line.
pub fn read(file: &str, text: &str, folder: &Path) -> Result<Sweep, StudyFileError> {
    let source = StudyText { file, text };
    let document = source.parse()?;
    let (table, place) = (document.get_ref(), document.span());
    let root = Section::of::<StudyFile>(source, "the file", place, table)?;
    let study =
        root.section::<StudyTable>("study")?.ok_or_else(|| root.lacks("[study]", "design = \"grid\" at least"))?;
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
    let strengths = strength::read(&study)?;
    let mut of_record = Measure::of_record(&periods);
    // Its period need not be one of `periods`.
    let elsewhere = [&Measure::OF_FLOOR[..], &Measure::OF_BLOCK].concat();
    let level = strengths.measure().filter(|measure| !elsewhere.contains(measure));
    of_record.extend(level.filter(|measure| !of_record.contains(measure)));
    let (mut motions, remarks) = records::read(&root, source, folder, &of_record, || gravity(&given, source))?;
    let building = building::file::read(&root)?;
    check_building(&root, &study, building.is_some(), &motions, &strengths)?;
    if let Some((building, floors)) = &building {
        motions = motions.iter().flat_map(|motion| on_floors(motion, building, floors)).collect();
        of_record.extend(Measure::OF_FLOOR);
    }
    let ensemble = ensemble::read(&study, source)?;
    let without_records = motions.iter().all(|motion| !motion.has_record());
    for key in strength::KEYS.into_iter().chain(["periods"]) {
        if let (true, Some(value)) = (without_records, study.get(key)) {
            return Err(study.wrong(key, value, "[[records]]; it has no effect without them"));
        }
    }
    check_ensemble(&study, source, ensemble.as_ref(), without_records, &strengths)?;
    let [friction_demand, half_cycles] = of_one_run(&study, &strengths)?;
    let tolerance = study.number("tolerance", Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)?;
    let parameters =
        given.iter().map(|g| SweptParameter { parameter: g.parameter, values: g.values.clone() }).collect();
    let mut sweep = Sweep {
        // Blank lines, indentation and comments do not change a study.
        text: text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty() && !line.starts_with('#'))
            .map(String::from)
            .collect(),
        parameters,
        design,
        motions,
        building: building.map(|(building, _)| building),
        strengths,
        ensemble,
        measures: of_record.into_iter().chain(Measure::OF_BLOCK).collect(),
        tolerance: tolerance.unwrap_or(Settings::OF_STUDIES),
        on_separation: OnSeparation::Fly,
        duration: study.number("duration", |x| x > 0.0 && x <= MAX_DURATION, "a time > 0 s, at most 1e6 s")?,
        step: study.number("step", |x| x >= MIN_STEP, "a time of at least 1e-6 s")?,
        friction_demand,
        half_cycles,
        changes: Vec::new(),
        remarks,
    };
    check(&sweep, &given, &study, source)?;
    let remarks = sweep.amplified().into_iter().chain(sweep.doubts()).collect::<Vec<_>>();
    sweep.remarks.extend(remarks);
    Ok(sweep)
}

/// Reads the quantities of single runs: the coefficient of friction and the amplitude of half cycles.
fn of_one_run(study: &Section, strengths: &Strengths) -> Result<[Option<f64>; 2], StudyFileError> {
    for key in ["friction_demand", "half_cycles"] {
        if let (Strengths::Least(..), Some(value)) = (strengths, study.get(key)) {
            return Err(study.wrong(key, value, "none beside least, which makes many runs per row"));
        }
    }
    Ok([
        study.number("friction_demand", |x| x > 0.0, "a coefficient of friction > 0")?,
        study.number("half_cycles", |x| x > 0.0, "an amplitude > 0 m")?,
    ])
}

/// Checks that a building has records to shake it, and that a measure of floors has a building.
fn check_building(
    root: &Section,
    study: &Section,
    has_building: bool,
    motions: &[GroundMotion],
    strengths: &Strengths,
) -> Result<(), StudyFileError> {
    let shaken = motions.iter().all(|motion| motion.ground.horizontal.is_some());
    if let (true, false, Some(value)) = (has_building, shaken, root.get("building")) {
        return Err(
            root.refused(value, "building has no effect without a horizontal record in each [[records]]".into())
        );
    }
    let level = strengths.measure().filter(|measure| !has_building && Measure::OF_FLOOR.contains(measure));
    if let (Some(measure), Some(value)) = (level, strength::KEYS.iter().find_map(|key| study.get(key))) {
        return Err(root.refused(value, format!("{measure} is that of a floor; expected a [building]")));
    }
    Ok(())
}

/// Checks that an ensemble spreads only quantities of the study, and that each row has the runs for it.
fn check_ensemble(
    study: &Section,
    source: StudyText,
    ensemble: Option<&Ensemble>,
    without_records: bool,
    strengths: &Strengths,
) -> Result<(), StudyFileError> {
    let (Some(ensemble), Some(value)) = (ensemble, study.get("ensemble")) else { return Ok(()) };
    if without_records && ensemble.spreads.iter().any(|spread| spread.target == SpreadTarget::Scale) {
        return Err(source.wrong(&value.span(), "scale has no effect without [[records]]"));
    }
    match strengths {
        Strengths::Least(..) => Err(study.wrong("ensemble", value, "none beside least, which makes many runs per row")),
        Strengths::Hunt(..) => Err(study.wrong("ensemble", value, "none beside hunt, whose levels follow single runs")),
        Strengths::Scales(_) | Strengths::Levels(..) => Ok(()),
    }
}

/// The motions of these floors under a ground motion with a horizontal record.
fn on_floors(motion: &GroundMotion, building: &building::Building, floors: &[usize]) -> Vec<GroundMotion> {
    let of_building = motion.ground.horizontal.iter().flat_map(|record| building.floor_motions(record));
    let mut of_building: Vec<_> = of_building.map(Some).collect();
    // Each floor is taken once: a list that names it twice is refused.
    floors.iter().filter_map(|&floor| of_building.get_mut(floor)?.take()).map(|found| motion.on_floor(found)).collect()
}

/// Reads the samples and the seed of a Latin hypercube; nothing for a grid.
fn design(study: &Section) -> Result<Option<(u32, u64)>, StudyFileError> {
    const EXPECTED: &str = "\"grid\" or \"latin-hypercube\"";
    let is_sampled = study.choice("design", &[("grid", false), ("latin-hypercube", true)], EXPECTED)?;
    let is_sampled = is_sampled.ok_or_else(|| study.lacks("design", EXPECTED))?;
    let samples = study.integer("samples", 1..10_000_001)?;
    let seed = study.integer("seed", 0..1 << 63)?;
    if !is_sampled {
        let unread = ["samples", "seed"].into_iter().find_map(|key| Some((key, study.get(key)?)));
        return unread.map_or(Ok(None), |(key, value)| {
            Err(study.wrong(key, value, "design = \"latin-hypercube\"; a grid does not use it"))
        });
    }
    let samples = samples.ok_or_else(|| study.lacks("samples", "the number of samples"))?;
    let seed = seed.ok_or_else(|| study.lacks("seed", "a whole number, which determines the samples"))?;
    Ok(Some((samples as u32, seed)))
}

/// Reads the parameters in the order of the file.
fn parameters<'a>(
    root: &Section<'a>,
    source: StudyText,
    sampled: bool,
) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let Some(value) = root.get("parameters") else { return Ok(Vec::new()) };
    let table = value.get_ref().as_table().ok_or_else(|| root.wrong("parameters", value, "a table"))?;
    let mut found = Vec::new();
    flatten(source, "", table, &[], &mut found)?;
    found.sort_by_key(|(_, value)| value.span().start);
    let given = found.into_iter().map(|(name, value)| {
        let parameter = Parameter::named(&name).map_err(|message| source.wrong(&value.span(), message))?;
        let values = values(source, &parameter, value, sampled)?;
        Ok(GivenParameter { value, parameter, values })
    });
    given.collect()
}

/// Reads the values of a parameter: one, a list, or a range.
pub(crate) fn values(
    source: StudyText,
    parameter: &Parameter,
    value: SpannedValue,
    sampled: bool,
) -> Result<ParameterValues, StudyFileError> {
    let name = parameter.name();
    let of = |value: SpannedValue| -> Result<f64, StudyFileError> {
        let at = |message: String| source.wrong(&value.span(), message);
        let found = match (parameter.metadata.kind, value.get_ref()) {
            (Kind::Boolean, DeValue::Boolean(truth)) => f64::from(u8::from(*truth)),
            (Kind::Enumeration, DeValue::String(item)) => parameter.item(item).map_err(at)?,
            (Kind::Real, DeValue::String(none))
                if parameter.metadata.variable == Variable::Friction && none.eq_ignore_ascii_case(friction::NONE) =>
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
        DeValue::Table(table) => range(source, parameter, value, table, of, sampled),
        _ => of(value).map(|value| ParameterValues::List(vec![value])),
    }
}

fn range(
    source: StudyText,
    parameter: &Parameter,
    value: &Spanned<DeValue>,
    table: &DeTable,
    of: impl Fn(SpannedValue) -> Result<f64, StudyFileError>,
    sampled: bool,
) -> Result<ParameterValues, StudyFileError> {
    let name = parameter.name();
    let section = Section::of::<RangeTable>(source, name, value.span(), table)?;
    if parameter.metadata.kind != Kind::Real {
        return Err(source.wrong(&value.span(), format!("{name} has no range; expected a list")));
    }
    let end = |key| section.get(key).ok_or_else(|| section.lacks(key, "from and to, as in { from = 1, to = 4 }"));
    let (from, to) = (of(end("from")?)?, of(end("to")?)?);
    if let Some(key) = ["from", "to"]
        .into_iter()
        .zip([from, to])
        .find_map(|(key, value)| parameter.shown(value).is_infinite().then_some(key))
    {
        return Err(section.wrong(key, end(key)?, "a finite number; a list may contain \"none\""));
    }
    if from >= to {
        return Err(section.wrong("to", end("to")?, &format!("more than from = {from}")));
    }
    let logarithmic = section.choice("spacing", &[("linear", false), ("log", true)], "\"linear\" or \"log\"")?;
    let logarithmic = logarithmic.unwrap_or(false);
    if logarithmic && from <= 0.0 {
        return Err(section.wrong("from", end("from")?, "a number > 0 for spacing = \"log\""));
    }
    let range = ParameterValues::Range { from, to, logarithmic };
    match (section.integer("count", 2..1_000_001)?, section.get("count")) {
        (Some(_), Some(value)) if sampled => {
            Err(section.wrong("count", value, "none, since a Latin hypercube samples the range"))
        }
        (Some(count), _) => {
            let last = (count - 1) as f64;
            Ok(ParameterValues::List((0..count).map(|i| range.at(i as f64 / last)).collect()))
        }
        (None, _) if sampled => Ok(range),
        (None, _) => Err(section.lacks("count", "the number of values of the grid")),
    }
}

/// The gravity (m/s²) that converts records in g.
fn gravity(given: &[GivenParameter], source: StudyText) -> Result<f64, StudyFileError> {
    match given.iter().find(|given| given.parameter.metadata.variable == Variable::G) {
        None => Ok(Values::default()[Variable::G]),
        Some(GivenParameter { values: ParameterValues::List(values), .. }) if values.len() == 1 => Ok(values[0]),
        Some(GivenParameter { value, .. }) => {
            let message = "g takes several values; expected one, which converts records in g";
            Err(source.wrong(&value.span(), message))
        }
    }
}

/// Checks the whole study: the number of rows, unread parameters, and invalid blocks.
fn check(sweep: &Sweep, given: &[GivenParameter], study: &Section, source: StudyText) -> Result<(), StudyFileError> {
    let line = |name: &str| {
        given.iter().find(|GivenParameter { parameter, .. }| {
            let full = parameter.metadata.name;
            full == name || full.ends_with(&format!(".{name}")) || full.starts_with(&format!("{name}."))
        })
    };
    let place = |key: &str| study.get(key).map_or(0..0, |value| value.span());
    if let (false, Some(value)) = (sweep.holds().yields, study.get("half_cycles")) {
        return Err(study.wrong("half_cycles", value, "none without a tie or damper with yield_force"));
    }
    let per_combination = sweep.motions.len() as u64 * sweep.strengths.count();
    let combinations = sweep.combinations();
    let rows = combinations.and_then(|count| count.checked_mul(per_combination)).filter(|rows| *rows <= MAX_ROWS);
    if rows.is_none() {
        let message = format!("combinations × records × strengths give too many rows; expected at most {MAX_ROWS}");
        return Err(source.wrong(&(0..0), message));
    }
    // The condition under which a block reads each parameter; `None` once a combination has read it.
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
            let has_none =
                |motion: &&GroundMotion| motion.intensity(measure, 1.0, &block).is_none_or(|value| value <= 0.0);
            if let Some(motion) = sweep.motions.iter().find(has_none) {
                let key = strength::KEYS.into_iter().find(|key| study.get(key).is_some()).unwrap_or_default();
                let message = format!("the horizontal record of {} has no {measure} above 0", motion.names.join(" "));
                return Err(source.wrong(&place(key), message));
            }
        }
        if let Some(ensemble) = &sweep.ensemble {
            ensemble::check(ensemble, &values).map_err(|message| source.wrong(&place("ensemble"), message))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a study of a block that starts tilted, with these lines in `[study]` and values of p.
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
