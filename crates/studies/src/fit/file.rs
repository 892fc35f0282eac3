//! A study file with `[fit]` → a problem.

use std::path::Path;

use toml::de::DeTable;

use crate::fit::problem::{FitError, Free, Options, Problem, Test};
use crate::input::parameters::{Parameter, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, keys};
use crate::run::table::columns;
use crate::spec::fit::{FitFile, FitTable, TestTable};
use crate::spec::study::RecordsTable;
use crate::sweep::file::values;
use crate::sweep::parameters::ParameterValues;
use crate::sweep::records;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::Settings;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;
use rocking_records::Choice;

/// Reads a problem from the text of its file; its paths are relative to `folder`. Returns it with the names of the files read.
///
/// # Errors
/// The first fault of the file or of a file that it names, with its line.
pub fn read(file: &str, text: &str, folder: &Path) -> Result<(Problem, Vec<String>), StudyFileError> {
    let source = StudyText { file, text };
    let document = source.parse()?;
    let root = Section::of::<FitFile>(source, "the file", document.span(), document.get_ref())?;
    let fit = root.section::<FitTable>("fit")?.ok_or_else(|| root.lacks("[fit]", "free = [\"alpha\"] at least"))?;
    let shared = parameters(source, &root, "parameters")?;
    let list = root.get("tests").ok_or_else(|| root.lacks("[[tests]]", "a table for each test"))?;
    let tables = list.get_ref().as_array().filter(|list| !list.is_empty());
    let tables = tables.ok_or_else(|| root.wrong("tests", list, "[[tests]], a table for each test"))?;
    let (mut tests, mut files, mut values) = (Vec::new(), Vec::new(), Values::default());
    for value in tables {
        let table = value.get_ref().as_table().ok_or_else(|| root.wrong("tests", value, "tables"))?;
        let section = Section::of::<TestTable>(source, "[[tests]]", value.span(), table)?;
        let of_test = test_parameters(source, table)?;
        values = set(source, shared.iter().chain(&of_test))?;
        tests.push(test(source, &section, value, folder, &values, &mut files)?);
    }
    let (parameterization, common) = values.block_parameters(|variable| values[variable]);
    let default = Options::default();
    let level = fit.number("level", |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
    let tolerance = fit.number("tolerance", Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)?;
    let options = Options {
        starts: fit.integer("starts", 1..100_001)?.map_or(default.starts, |starts| starts as u32),
        seed: fit.integer("seed", 0..1 << 63)?.unwrap_or(default.seed),
        level: level.unwrap_or(default.level),
        tolerance: tolerance.unwrap_or(default.tolerance),
    };
    let ties = values.ties(|variable| values[variable]);
    let problem = Problem { parameterization, common, ties, free: free(source, &fit)?, tests, options };
    let span = |error: &FitError| match error {
        FitError::Test { number, .. } => tables.get(number - 1).map_or(list.span(), |table| table.span()),
        _ => root.get("fit").map_or(0..0, |fit| fit.span()),
    };
    let checked = problem.check().and_then(|()| crate::fit::unknowns::unknowns(&problem).map(|_| ()));
    checked.map_err(|error| source.wrong(&span(&error), error.to_string()))?;
    Ok((problem, files))
}

/// A parameter with its value in the text.
type GivenParameter<'a> = (Parameter, SpannedValue<'a>);

/// Reads the parameters of a table of the file.
fn parameters<'a>(source: StudyText, root: &Section<'a>, key: &str) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let Some(value) = root.get(key) else { return Ok(Vec::new()) };
    let table = value.get_ref().as_table().ok_or_else(|| root.wrong(key, value, "a table"))?;
    named(source, table, &[])
}

/// Reads the parameters of a test: its initial state and its pulse.
fn test_parameters<'a>(source: StudyText, table: &'a DeTable<'a>) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let is_other = |key: &&&str| !["initial", "pulse"].contains(key);
    let others: Vec<&str> = keys::<TestTable>().iter().filter(is_other).copied().collect();
    named(source, table, &others)
}

fn named<'a>(
    source: StudyText,
    table: &'a DeTable<'a>,
    others: &[&str],
) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let mut found = Vec::new();
    flatten(source, "", table, others, &mut found)?;
    let parameter = |(name, value): (String, SpannedValue<'a>)| {
        Ok((Parameter::named(&name).map_err(|message| source.wrong(&value.span(), message))?, value))
    };
    found.into_iter().map(parameter).collect()
}

/// Returns the variables with these parameters set; each must have one value and be read by the block.
fn set<'a>(
    source: StudyText,
    parameters: impl Iterator<Item = &'a GivenParameter<'a>> + Clone,
) -> Result<Values, StudyFileError> {
    let mut set = Values::default();
    for (parameter, value) in parameters.clone() {
        match values(source, parameter, value, false)? {
            ParameterValues::List(list) if list.len() == 1 => set[parameter.metadata.variable] = list[0],
            _ => {
                let message = format!("{} has several values; expected one, the first start", parameter.name());
                return Err(source.wrong(&value.span(), message));
            }
        }
    }
    for (parameter, value) in parameters.clone() {
        let name = parameter.metadata.name;
        if let Some((_, needed)) = set.unread_by_motion().find(|(unread, _)| *unread == name) {
            return Err(source.wrong(&value.span(), format!("{} is not read; expected {needed}", parameter.name())));
        }
    }
    set.block().map_err(|error| {
        let wrong = parameters.clone().find(|(parameter, _)| parameter.name() == error.name());
        source.wrong(&wrong.map_or(0..0, |(_, value)| value.span()), error.to_string())
    })?;
    Ok(set)
}

/// Reads a test.
fn test(
    source: StudyText,
    section: &Section,
    table: SpannedValue,
    folder: &Path,
    values: &Values,
    files: &mut Vec<String>,
) -> Result<Test, StudyFileError> {
    let finite = |key: &str| section.number(key, |_| true, "a finite number");
    let block = values.block().map_err(|error| source.wrong(&table.span(), error.to_string()))?;
    let output = section.text("output")?.unwrap_or("theta");
    let unit = columns(&block).into_iter().find(|column| column.name == output).map_or("1", |column| column.unit);
    let name = section.text("data")?.ok_or_else(|| section.lacks("data", "a CSV file of times and measured values"))?;
    let time = records::column(section, "time")?.unwrap_or(Choice::Name("t".into()));
    let column = records::column(section, "column")?.unwrap_or(Choice::Name(output.into()));
    let factor = section.number("factor", |x| x != 0.0, "a number other than 0")?;
    let data = section.get("data").unwrap_or(table);
    let read = read_table(&folder.join(name), [&time, &column], unit, factor);
    let (times, values_over_time) = read.map_err(|message| section.refused(data, format!("{name}: {message}")))?;
    files.push(name.into());
    let mut ground = Ground::default();
    if let (Some(record), Some(value)) = (section.section::<RecordsTable>("record")?, section.get("record")) {
        let found = records::in_table(&record, value.span(), source, folder, values[Variable::G])?;
        let [of_record] = &found[..] else {
            let message = format!("record has {} files; expected one for each direction", found.len());
            return Err(section.refused(value, message));
        };
        ground = of_record.ground.clone();
        files.extend(of_record.files.iter().filter(|name| !name.is_empty()).cloned());
    }
    if let (true, Some(value)) = (ground.is_empty(), section.get("scale")) {
        return Err(section.wrong("scale", value, "a record; it has no effect without one"));
    }
    Ok(Test {
        output: output.into(),
        times,
        values: values_over_time,
        noise: section.number("noise", |x| x > 0.0, "a standard deviation > 0")?,
        initial: values.initial(),
        pulse: values.pulse(),
        ground,
        scale: finite("scale")?.unwrap_or(1.0),
        zero: finite("zero")?.unwrap_or(0.0),
        delay: finite("delay")?.unwrap_or(0.0),
        free: free(source, section)?,
    })
}

/// Reads `free`, `bounds` and `prior` of a table.
fn free(source: StudyText, section: &Section) -> Result<Vec<Free>, StudyFileError> {
    let mut found = Vec::new();
    if let Some(value) = section.get("free") {
        let expected = "a list of names, as in [\"alpha\", \"p\"]";
        let list = value.get_ref().as_array().ok_or_else(|| section.wrong("free", value, expected))?;
        for value in list {
            let name = value.get_ref().as_str().ok_or_else(|| section.wrong("free", value, expected))?;
            found.push(Free::named(name));
        }
    }
    for (key, expected) in [("bounds", "both ends, as in [0.1, 0.3]"), ("prior", "mean and standard deviation")] {
        let Some(value) = section.get(key) else { continue };
        let table = value.get_ref().as_table().ok_or_else(|| section.wrong(key, value, "a table of parameters"))?;
        let mut pairs = Vec::new();
        leaves("", table, &mut pairs);
        for (name, value) in pairs {
            let numbers = value.get_ref().as_array().filter(|list| list.len() == 2);
            let number = |value: SpannedValue| crate::input::study_file::number(value);
            let both = numbers.and_then(|list| Some([number(&list[0])?, number(&list[1])?]));
            let both = both.ok_or_else(|| section.wrong(&name, value, expected))?;
            let Some(free) = found.iter_mut().find(|free| free.name == name) else {
                let names: Vec<&str> = found.iter().map(|free| free.name.as_str()).collect();
                let message = format!("{key} of {name}, which is not free; expected one of {}", names.join(", "));
                return Err(source.wrong(&value.span(), message));
            };
            *(if key == "bounds" { &mut free.bounds } else { &mut free.prior }) = Some(both);
        }
    }
    Ok(found)
}

/// Collects the values of a table and of its nested tables, by their dotted names.
fn leaves<'a>(prefix: &str, table: &'a DeTable<'a>, found: &mut Vec<(String, SpannedValue<'a>)>) {
    for (key, value) in table {
        let name = format!("{prefix}{}", key.get_ref());
        match value.get_ref().as_table() {
            Some(group) => leaves(&format!("{name}."), group, found),
            None => found.push((name, value)),
        }
    }
}

/// Reads two columns of a CSV file: times (s), and values times a factor, in this unit.
fn read_table(
    path: &Path,
    wanted: [&Choice; 2],
    unit: &str,
    factor: Option<f64>,
) -> Result<(Vec<f64>, Vec<f64>), String> {
    let reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_path(path);
    let rows: Vec<csv::StringRecord> = reader
        .map_err(|error| error.to_string())?
        .into_records()
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())?;
    let first = rows.first().ok_or("no rows; expected a table of times and values")?;
    let has_header = first.iter().any(|field| field.parse::<f64>().is_err());
    let headings: Vec<&str> = if has_header { first.iter().collect() } else { Vec::new() };
    let position = |column: &Choice| match column {
        Choice::Number(number) => Ok(number - 1),
        Choice::Name(name) => headings
            .iter()
            .position(|heading| heading == name || heading.split(" [").next() == Some(name))
            .ok_or_else(|| match has_header {
                true => format!("there is no column {name}; expected one of {}", headings.join(", ")),
                false => format!("the table has no headings; expected the number of the column, not {name}"),
            }),
    };
    let [time, value] = [position(wanted[0])?, position(wanted[1])?];
    let heading = headings.get(value).copied().unwrap_or_default();
    if let (None, Some(found)) = (factor, heading.split_once('[').and_then(|(_, rest)| rest.strip_suffix(']')))
        && found != unit
    {
        return Err(format!("column {heading} is in {found}; expected {unit}, or the factor that converts it"));
    }
    let number = |row: &csv::StringRecord, column: usize| {
        let field = row.get(column).unwrap_or_default();
        let line = row.position().map_or(0, |position| position.line());
        field.parse::<f64>().map_err(|_| format!("line {line}: column {} = \"{field}\"; expected a number", column + 1))
    };
    let factor = factor.unwrap_or(1.0);
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for row in rows.iter().skip(usize::from(has_header)) {
        times.push(number(row, time)?);
        values.push(factor * number(row, value)?);
    }
    Ok((times, values))
}
