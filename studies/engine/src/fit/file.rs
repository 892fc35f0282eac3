//! A study file with `[fit]` → a problem.

use std::path::Path;

use toml::de::DeTable;

use crate::fit::problem::{FitError, Free, Options, Problem, Test, unit};
use crate::input::parameters::{Parameter, Vocabulary, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, THE_FILE, number};
use crate::spec::fit::{FitFile, FitTable, TestTable};
use crate::sweep::file::values;
use crate::sweep::parameters::ParameterValues;
use crate::sweep::records;
use rocking_block::excitation::records::Ground;
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
    let file = Section::<FitFile>::read(source, THE_FILE, document.span(), document.get_ref())?;
    let FitTable { starts, seed, level, tolerance, .. } = file.fit;
    let shared = parameters(&file, "", &["parameters"])?;
    let (mut tests, mut files, mut values) = (Vec::new(), Vec::new(), Values::default());
    for (number, table) in file.tests.iter().enumerate() {
        let path = format!("tests.{number}.");
        let of_test = parameters(&file, &path, &["initial", "pulse"])?;
        values = set(source, shared.iter().chain(&of_test))?;
        tests.push(test(&file, &path, table, folder, &values, &mut files)?);
    }
    let block = values.block_parameters(|variable| values[variable]);
    let default = Options::default();
    let options = Options {
        starts: starts.unwrap_or(default.starts),
        seed: seed.map_or(default.seed, |seed| seed.0),
        level: level.map_or(default.level, |level| level.0),
        tolerance: tolerance.unwrap_or(default.tolerance),
    };
    let ties = values.ties(|variable| values[variable]);
    let free = free(&file, "fit.", &file.fit.free)?;
    let problem = Problem { block, ties, free, tests, options };
    let path = |error: &FitError| match error {
        FitError::Test { number, .. } => format!("tests.{}", number - 1),
        _ => "fit".into(),
    };
    let checked = problem.check().and_then(|()| crate::fit::unknowns::unknowns(&problem).map(|_| ()));
    checked.map_err(|error| file.refused(&path(&error), error.to_string()))?;
    Ok((problem, files))
}

/// A parameter with its value in the text.
type GivenParameter<'a> = (Parameter, SpannedValue<'a>);

/// Reads the parameters of these tables, whose paths begin with `path`.
fn parameters<'a>(
    file: &Section<'a, FitFile>,
    path: &str,
    tables: &[&str],
) -> Result<Vec<GivenParameter<'a>>, StudyFileError> {
    let mut found = Vec::new();
    for key in tables {
        let prefix = if path.is_empty() { String::new() } else { format!("{key}.") };
        if let Some(table) = file.get(&format!("{path}{key}")).and_then(|value| value.get_ref().as_table()) {
            flatten(file.source, Vocabulary::Plane, &prefix, table, &[], &mut found)?;
        }
    }
    let parameter = |(name, value): (String, SpannedValue<'a>)| {
        Ok((Parameter::named(&name).map_err(|message| file.source.wrong(&value.span(), message))?, value))
    };
    found.into_iter().map(parameter).collect()
}

/// Returns the variables with these parameters set. Each must have one value and be read by the block.
fn set<'a>(
    source: StudyText<'a>,
    parameters: impl Iterator<Item = &'a GivenParameter<'a>> + Clone,
) -> Result<Values, StudyFileError> {
    let mut set = Values::default();
    for (parameter, value) in parameters.clone() {
        match (parameter.variable(), values(source, parameter, value, false)?) {
            (Some(variable), ParameterValues::List(list)) if list.len() == 1 => set[variable] = list[0],
            _ => {
                let message = format!("{} has several values; expected one, the first start", parameter.name());
                return Err(source.wrong(&value.span(), message));
            }
        }
    }
    for (parameter, value) in parameters.clone() {
        let name = parameter.full_name();
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

/// Reads the test of a table, whose path ends with a dot.
fn test(
    file: &Section<FitFile>,
    path: &str,
    table: &TestTable,
    folder: &Path,
    values: &Values,
    files: &mut Vec<String>,
) -> Result<Test, StudyFileError> {
    let refused = |key: &str, message: String| file.refused(&format!("{path}{key}"), message);
    let block = values.block().map_err(|error| refused("", error.to_string()))?;
    let output = table.output.as_deref().unwrap_or("theta");
    let time = table.time.clone().unwrap_or(Choice::Name("t".into()));
    let column = table.column.clone().unwrap_or(Choice::Name(output.into()));
    if table.factor == Some(0.0) {
        return Err(file.wrong(&format!("{path}factor"), "a number other than 0"));
    }
    let name = &table.data;
    let read = read_table(&folder.join(name), [&time, &column], &unit(&block, output), table.factor);
    let (times, values_over_time) = read.map_err(|message| refused("data", format!("{name}: {message}")))?;
    files.push(name.into());
    let mut ground = Ground::default();
    if let Some(record) = &table.record {
        let place = format!("{path}record");
        if record.polarity.is_some() {
            let message = "polarity has no effect on a test, which has one motion; expected a record as it was";
            return Err(refused("record.polarity", message.into()));
        }
        let found = records::Files { file, path: place, table: record, folder, vocabulary: Vocabulary::Plane }
            .read(values[Variable::G])?;
        let [of_record] = &found[..] else {
            return Err(refused(
                "record",
                format!("record has {} files; expected one for each direction", found.len()),
            ));
        };
        ground = of_record.ground.clone();
        files.extend(of_record.files.iter().filter(|name| !name.is_empty()).cloned());
    }
    if ground.is_empty() && table.scale.is_some() {
        return Err(file.wrong(&format!("{path}scale"), "a record; it has no effect without one"));
    }
    Ok(Test {
        output: output.into(),
        times,
        values: values_over_time,
        noise: table.noise.map(|noise| noise.0),
        initial: values.initial(),
        pulse: values.pulse(),
        ground,
        scale: table.scale.unwrap_or(1.0),
        zero: table.zero.unwrap_or(0.0),
        delay: table.delay.unwrap_or(0.0),
        free: free(file, path, &table.free)?,
    })
}

/// Reads `free`, `bounds` and `prior` of the table whose path this is, with a dot.
fn free(file: &Section<FitFile>, path: &str, names: &Option<Vec<String>>) -> Result<Vec<Free>, StudyFileError> {
    let mut found: Vec<Free> = names.iter().flatten().map(|name| Free::named(name)).collect();
    for (key, expected) in [("bounds", "both ends, as in [0.1, 0.3]"), ("prior", "mean and standard deviation")] {
        let value = file.get(&format!("{path}{key}"));
        let Some(table) = value.and_then(|value| value.get_ref().as_table()) else { continue };
        let mut pairs = Vec::new();
        leaves("", table, &mut pairs);
        for (name, value) in pairs {
            let wrong = |message: String| file.source.wrong(&value.span(), message);
            let numbers = value.get_ref().as_array().filter(|list| list.len() == 2);
            let both = numbers.and_then(|list| Some([number(&list[0])?, number(&list[1])?]));
            let both = both.ok_or_else(|| file.source.unexpected(&name, value, expected))?;
            let Some(free) = found.iter_mut().find(|free| free.name == name) else {
                let names: Vec<&str> = found.iter().map(|free| free.name.as_str()).collect();
                let names = names.join(", ");
                return Err(wrong(format!("{key} of {name}, which is not free; expected one of {names}")));
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

/// Reads two columns of a CSV file: times (s) and values. The values are multiplied by a factor, and are then in this unit.
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
