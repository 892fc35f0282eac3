//! The table of a sweep, a limit → cases that exceed it or not.

use std::collections::BTreeMap;
use std::io::Read;

use crate::input::parameters::is_same_word;
use crate::run::limit::{Limit, Response};
use crate::run::outcome::End;

/// Splits a heading such as `PGV [m/s]` into its name and unit.
pub fn split_heading(heading: &str) -> (&str, Option<&str>) {
    match heading.strip_suffix(']').and_then(|text| text.split_once(" [")) {
        Some((name, unit)) => (name, Some(unit)),
        None => (heading, None),
    }
}

/// The reason why a table cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum SweepTableError {
    /// The file is not a table.
    #[error("{file}: cannot be read as CSV: {error}")]
    Csv {
        /// The table.
        file: String,
        /// The reason.
        error: csv::Error,
    },
    /// A column is missing.
    #[error("{file}: has no column {name}; expected one of {known}")]
    Column {
        /// The table.
        file: String,
        /// Name of the column.
        name: String,
        /// The columns of the table.
        known: String,
    },
    /// A field does not fit its column.
    #[error("{file}: row {row} has {column} = {found}; expected {expected}")]
    Field {
        /// The table.
        file: String,
        /// Its row, from 0, as numbered in the first column.
        row: usize,
        /// Name of the column.
        column: String,
        /// Content of the field.
        found: String,
        /// The expected content.
        expected: String,
    },
    /// The levels of two curves differ.
    #[error(
        "{file}: the curves have different levels of {im}; expected a sweep with levels = {{ im = \"{im}\", values = [...] }}"
    )]
    Levels {
        /// The table.
        file: String,
        /// Name of the measure.
        im: String,
    },
    /// The rows are searches for the least level, whose outcomes belong to no level.
    #[error(
        "{file}: found the least levels of searches, {column}; expected an outcome at one level in each row, as from a sweep with scales \
         or levels"
    )]
    Search {
        /// The table.
        file: String,
        /// Heading of the column of the least levels.
        column: String,
    },
    /// No row has the requested value.
    #[error("{file}: no row has {column} = {value}")]
    NoRow {
        /// The table.
        file: String,
        /// Name of the column.
        column: String,
        /// The requested value.
        value: String,
    },
}

/// The table of a sweep.
#[derive(Clone, Debug)]
pub struct SweepTable {
    file: String,
    columns: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// The outcome of a row, relative to a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Position of the row in the table.
    pub row: usize,
    /// Fraction of its runs that exceeded the limit: 0 or 1 for a single run.
    pub fraction: f64,
    /// Peak |θ|/α, if the block lifted off and stands.
    pub peak: Option<f64>,
    /// Number of its ground motion; each row without records has its own.
    pub motion: usize,
}

/// The rows of a table, relative to a limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cases {
    /// Rows with a known outcome.
    pub cases: Vec<Case>,
    /// Number of rows with failed runs.
    pub failed: usize,
    /// Number of rows that ended at complete separation without exceeding the limit.
    pub separated: usize,
    /// Number of rows that ended undecided without exceeding the limit.
    pub undecided: usize,
}

impl SweepTable {
    /// Reads a table; `file` is its name in errors.
    ///
    /// # Errors
    /// [`SweepTableError::Csv`]: a row with the wrong number of fields, or invalid UTF-8.
    pub fn read(file: &str, content: impl Read) -> Result<SweepTable, SweepTableError> {
        let failed = |error| SweepTableError::Csv { file: file.into(), error };
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(content);
        let columns = reader.headers().map_err(failed)?.iter().map(String::from).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(failed)?;
        Ok(SweepTable { file: file.into(), columns, rows })
    }

    /// Name of the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The distinct words of a column in the order of the rows; `None` without such a column.
    pub fn words(&self, name: &str) -> Option<Vec<&str>> {
        let column = self.position(name).ok()?;
        let mut words: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !words.contains(&&row[column]) {
                words.push(&row[column]);
            }
        }
        Some(words)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Keeps only the rows with this value in a column.
    ///
    /// # Errors
    /// There is no such column, or no such row.
    pub fn keep(&mut self, column: &str, value: &str) -> Result<(), SweepTableError> {
        let position = self.position(column)?;
        let number: Option<f64> = value.parse().ok();
        let is = |found: &str| is_same_word(found, value) || number.is_some() && found.parse().ok() == number;
        self.rows.retain(|row| is(&row[position]));
        match self.rows.is_empty() {
            true => Err(SweepTableError::NoRow { file: self.file.clone(), column: column.into(), value: value.into() }),
            false => Ok(()),
        }
    }

    /// The heading of a column, found by its name with or without the unit.
    ///
    /// # Errors
    /// There is no such column.
    pub fn heading(&self, name: &str) -> Result<&str, SweepTableError> {
        self.position(name).map(|column| self.columns[column].as_str())
    }

    /// The numbers of a column, found by its name with or without the unit; `None` for empty fields.
    ///
    /// # Errors
    /// There is no such column, or a field is not a number.
    pub fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, SweepTableError> {
        let column = self.position(name)?;
        let number = |row: usize| match &self.rows[row][column] {
            "" => Ok(None),
            text => text.parse().map(Some).map_err(|_| self.wrong(row, column, "a number")),
        };
        (0..self.rows.len()).map(number).collect()
    }

    /// Compares each row with a limit: the probability of its ensemble if the table has one, else its single run.
    ///
    /// # Errors
    /// The table has no outcomes, or an unknown one, or its rows are searches for least levels.
    pub fn cases(&self, limit: Limit) -> Result<Cases, SweepTableError> {
        if let Some(column) = self.columns.iter().find(|column| column.starts_with("least.")) {
            return Err(SweepTableError::Search { file: self.file.clone(), column: column.clone() });
        }
        let ends = self.ends()?;
        let numbers = |name: &str| match self.position(name) {
            Ok(_) => self.numbers(name),
            Err(_) => Ok(vec![None; self.rows.len()]),
        };
        // A limit on the rotation needs the peaks; for others they only serve the efficiency.
        let peaks = match limit {
            Limit::Overturned | Limit::Slip(_) => numbers("peak.theta/alpha")?,
            Limit::Rotation(_) => self.numbers("peak.theta/alpha")?,
        };
        let slips = match limit {
            Limit::Slip(_) => self.numbers("peak.slip")?,
            Limit::Overturned | Limit::Rotation(_) => vec![None; self.rows.len()],
        };
        let liftoffs = numbers("events.liftoffs")?;
        let is_ensemble = self.position("ensemble.samples").is_ok();
        let probabilities = match is_ensemble {
            true => self.numbers(&format!("P({limit})"))?,
            false => vec![None; self.rows.len()],
        };
        let mut found = Cases::default();
        let mut motions = BTreeMap::new();
        let names = ["record", "vertical"].map(|name| self.position(name).ok());
        for (row, ((end, peak), probability)) in ends.into_iter().zip(peaks).zip(probabilities).enumerate() {
            let mut known: Vec<String> = names.iter().flatten().map(|&column| self.rows[row][column].into()).collect();
            if known.iter().all(String::is_empty) {
                // A row without records gets a key of three parts, unlike all pairs of names.
                known = vec![String::new(), String::new(), row.to_string()];
            }
            let next = motions.len();
            let motion = *motions.entry(known).or_insert(next);
            let exceeds = limit.is_exceeded(end, Response { rotation: peak, slip: slips[row] });
            let fraction = match (is_ensemble, end) {
                // Empty if no sample decides the limit.
                (true, _) => probability,
                (false, End::Failed) => None,
                (false, End::Undecided) if !exceeds => None,
                (false, End::Separated) if !exceeds => {
                    found.separated += 1;
                    continue;
                }
                (false, _) => Some(f64::from(u8::from(exceeds))),
            };
            match fraction {
                Some(fraction) => {
                    let rocked = end == End::Completed && liftoffs[row] != Some(0.0);
                    let peak = peak.filter(|peak| rocked && *peak > 0.0);
                    found.cases.push(Case { row, fraction, peak, motion });
                }
                None if end == End::Undecided => found.undecided += 1,
                None => found.failed += 1,
            }
        }
        Ok(found)
    }

    /// The end of each row's run.
    pub(super) fn ends(&self) -> Result<Vec<End>, SweepTableError> {
        let column = self.position("outcome")?;
        let end = |row: usize| self.rows[row][column].parse().map_err(|error: String| self.wrong(row, column, &error));
        (0..self.rows.len()).map(end).collect()
    }

    /// The fields of each row between its number and a column: its block and ground motion.
    pub(super) fn fields_before(&self, column: &str) -> Result<Vec<String>, SweepTableError> {
        let position = self.position(column)?;
        let fields =
            |row: &csv::StringRecord| row.iter().take(position).skip(1).map(|field| format!("{field}\n")).collect();
        Ok(self.rows.iter().map(fields).collect())
    }

    /// The error for a row without a level of a measure.
    pub(super) fn no_level(&self, row: usize, im: &str) -> SweepTableError {
        self.position(im).map_or_else(|error| error, |column| self.wrong(row, column, "a level"))
    }

    /// The error for curves with different levels.
    pub(super) fn no_levels(&self, im: &str) -> SweepTableError {
        SweepTableError::Levels { file: self.file.clone(), im: im.into() }
    }

    fn position(&self, name: &str) -> Result<usize, SweepTableError> {
        let is_named = |column: &str, same: fn(&str, &str) -> bool| {
            same(column, name) || column.split_once(" [").is_some_and(|(known, _)| same(known, name))
        };
        let exact = self.columns.iter().position(|column| is_named(column, |a, b| a == b));
        let in_any_case = || self.columns.iter().position(|column| is_named(column, str::eq_ignore_ascii_case));
        exact.or_else(in_any_case).ok_or_else(|| SweepTableError::Column {
            file: self.file.clone(),
            name: name.into(),
            known: self.columns.join(", "),
        })
    }

    fn wrong(&self, row: usize, column: usize, expected: &str) -> SweepTableError {
        let number = self.rows[row].get(0).and_then(|number| number.parse().ok()).unwrap_or(row);
        let found = self.rows[row][column].to_string();
        let (file, column) = (self.file.clone(), self.columns[column].clone());
        SweepTableError::Field { file, row: number, column, found, expected: expected.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# a study\nrow,p [rad/s],record,PGV [m/s],outcome,peak.theta/alpha [1]\n0,1,a,0.5,completed,0.3\n\
                         1,1,b,0.7,overturned,7\n2,2,a,,completed,0.6\n3,2,b,0.9,separated,0.2\n4,2,b,0.9,separated,0.8\n\
                         5,2,a,0.2,failed,0.1\n6,2,a,0.2,completed,0\n7,2,a,0.2,undecided,0.4\n8,2,b,0.2,undecided,3.3\n";

    fn table(text: &str) -> SweepTable {
        SweepTable::read("t.csv", text.as_bytes()).unwrap()
    }

    #[test]
    fn rows_are_compared_with_a_limit() {
        let fractions = |limit: &str| {
            let found = table(TABLE).cases(limit.parse().unwrap()).unwrap();
            let cases: Vec<_> = found.cases.iter().map(|case| (case.row, case.fraction, case.motion)).collect();
            (cases, found.failed, found.separated, found.undecided)
        };
        assert_eq!(fractions("overturned"), (vec![(0, 0.0, 0), (1, 1.0, 1), (2, 0.0, 0), (6, 0.0, 0)], 1, 2, 2));
        let rotated = vec![(0, 0.0, 0), (1, 1.0, 1), (2, 1.0, 0), (4, 1.0, 1), (6, 0.0, 0), (8, 1.0, 1)];
        assert_eq!(fractions("theta/alpha>0.5"), (rotated, 1, 1, 1));
        let peaks: Vec<_> = table(TABLE).cases(Limit::Overturned).unwrap().cases.iter().map(|case| case.peak).collect();
        assert_eq!(peaks, [Some(0.3), None, Some(0.6), None]);
    }

    /// A block that overturns exceeds any slip; the number of its row is not asked for.
    #[test]
    fn rows_are_compared_with_a_slip() {
        let text = "row,outcome,peak.slip [m]\n0,completed,0.05\n1,completed,0.2\n2,overturned,0\n3,undecided,0.3\n\
                    4,undecided,0.1\n";
        let found = table(text).cases(Limit::Slip(0.1)).unwrap();
        let cases: Vec<_> = found.cases.iter().map(|case| (case.row, case.fraction)).collect();
        assert_eq!((cases, found.undecided), (vec![(0, 0.0), (1, 1.0), (2, 1.0), (3, 1.0)], 1));
        let refused = table(TABLE).cases(Limit::Slip(0.1)).unwrap_err().to_string();
        assert!(refused.starts_with("t.csv: has no column peak.slip"), "{refused}");
    }

    #[test]
    fn an_ensemble_gives_its_probability() {
        let ensemble = "row,outcome,peak.theta/alpha [1],ensemble.samples [1],P(overturned) [1]\n0,completed,0.3,4,0.25\n\
                        1,failed,0.3,4,1\n2,failed,0.1,4,\n";
        let found = table(ensemble).cases(Limit::Overturned).unwrap();
        assert_eq!(found.cases.iter().map(|case| case.fraction).collect::<Vec<_>>(), [0.25, 1.0]);
        assert_eq!(found.failed, 1);
        let refused = table(ensemble).cases(Limit::Rotation(0.5)).unwrap_err().to_string();
        assert!(
            refused.starts_with("t.csv: has no column P(theta/alpha>0.5); expected one of row, outcome"),
            "{refused}"
        );
    }

    #[test]
    fn columns_are_found_with_and_without_their_unit() {
        let mut kept = table(TABLE);
        assert_eq!(kept.numbers("PGV").unwrap(), kept.numbers("PGV [m/s]").unwrap());
        assert_eq!(kept.numbers("PGV").unwrap()[..3], [Some(0.5), Some(0.7), None]);
        kept.keep("p", "1.0").unwrap();
        assert_eq!(kept.rows(), 2);
        assert_eq!(kept.keep("record", "c").unwrap_err().to_string(), "t.csv: no row has record = c");
        let message = table(TABLE).numbers("outcome").unwrap_err().to_string();
        assert_eq!(message, "t.csv: row 0 has outcome = completed; expected a number");
        let message = table(TABLE).numbers("PGA").unwrap_err().to_string();
        assert!(message.contains("has no column PGA") && message.contains("PGV [m/s]"), "{message}");
        for rotation in ["0.5", "theta/alpha>0.5", "Theta/Alpha>0.5"] {
            assert_eq!(rotation.parse(), Ok(Limit::Rotation(0.5)));
        }
        for slip in ["slip:0.1", "Slip>0.1"] {
            assert_eq!(slip.parse(), Ok(Limit::Slip(0.1)));
        }
        assert_eq!("Overturned".parse(), Ok(Limit::Overturned));
        assert_eq!(table(TABLE).numbers("pgv").unwrap(), table(TABLE).numbers("PGV").unwrap());
        for wrong in ["fallen", "-1", "theta/alpha>0", "theta/alpha>x", "slip:0", "slip:far", "slip"] {
            assert!(wrong.parse::<Limit>().unwrap_err().contains(wrong));
        }
    }
}
