//! The table of a sweep → what its blocks did over its measures.

use std::collections::BTreeMap;
use std::io::Read;
use std::str::FromStr;

use crate::study::outcome::End;
use crate::study::parameters::is_same_word;

/// What a block is not to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Overturn.
    Overturned,
    /// Rotate by more than this |θ|/α (1); a block that overturns has.
    Rotation(f64),
}

/// The words that are given and told.
impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Limit::Overturned => f.write_str("overturned"),
            Limit::Rotation(limit) => write!(f, "theta/alpha>{limit}"),
        }
    }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Limit, String> {
        let lower = text.to_ascii_lowercase();
        if lower == "overturned" {
            return Ok(Limit::Overturned);
        }
        let limit = lower.strip_prefix("theta/alpha>").unwrap_or(&lower).parse().ok();
        limit.filter(|limit: &f64| *limit > 0.0 && limit.is_finite()).map(Limit::Rotation).ok_or_else(|| {
            format!("found limit `{text}`; expected overturned, or a number > 0 for |theta|/alpha, as in 0.5")
        })
    }
}

/// Why a table tells nothing. Lines are those of its rows, from 1 after the names of the columns.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// It is no table.
    #[error("{file}: cannot be read as CSV: {error}")]
    Csv {
        /// The table.
        file: String,
        /// Why.
        error: csv::Error,
    },
    /// A column is missing.
    #[error("{file}: has no column {name}; expected one of {known}")]
    Column {
        /// The table.
        file: String,
        /// Name of the column.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// A field is not what its column has.
    #[error("{file}: row {row} has {column} = {found}; expected {expected}")]
    Field {
        /// The table.
        file: String,
        /// Its row, from 0, as it stands in the first column.
        row: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        found: String,
        /// What would do.
        expected: String,
    },
    /// Levels differ.
    #[error(
        "{file}: the curves have different levels of {im}; expected a sweep with levels = {{ im = \"{im}\", values = [...] }}"
    )]
    Levels {
        /// The table.
        file: String,
        /// Name of the measure.
        im: String,
    },
    /// No row has the value that was asked for.
    #[error("{file}: no row has {column} = {value}")]
    NoRow {
        /// The table.
        file: String,
        /// Name of the column.
        column: String,
        /// What was asked for.
        value: String,
    },
}

/// A table of a sweep.
#[derive(Clone, Debug)]
pub struct Table {
    file: String,
    columns: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// What a block did in a row that tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Place of the row in the table.
    pub row: usize,
    /// The part of its runs that exceeded the limit: 0 or 1 for a single run.
    pub fraction: f64,
    /// Its |θ|max/α, if it lifted off and stands.
    pub peak: Option<f64>,
    /// Number of its ground motion; a row without records has one of its own.
    pub motion: usize,
}

/// The rows of a table beside a limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cases {
    /// Those that tell.
    pub cases: Vec<Case>,
    /// Rows whose runs failed.
    pub failed: usize,
    /// Rows whose runs ended at complete separation before they had exceeded the limit.
    pub separated: usize,
    /// Rows whose duration was over before they had exceeded the limit or stood for good.
    pub undecided: usize,
}

impl Table {
    /// Reads a table; `file` stands for it in errors.
    ///
    /// # Errors
    /// [`TableError::Csv`]: a row with more or fewer fields than there are columns, or bytes that are no text.
    pub fn read(file: &str, content: impl Read) -> Result<Table, TableError> {
        let failed = |error| TableError::Csv { file: file.into(), error };
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(content);
        let columns = reader.headers().map_err(failed)?.iter().map(String::from).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(failed)?;
        Ok(Table { file: file.into(), columns, rows })
    }

    /// Name of the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The different words of a column in the order of their rows, if there is such a column.
    pub fn words(&self, name: &str) -> Option<Vec<&str>> {
        let place = self.place(name).ok()?;
        let mut words: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !words.contains(&&row[place]) {
                words.push(&row[place]);
            }
        }
        Some(words)
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Leaves out all rows but those in which a column has this value.
    ///
    /// # Errors
    /// There is no such column, or no such row.
    pub fn keep(&mut self, column: &str, value: &str) -> Result<(), TableError> {
        let place = self.place(column)?;
        let number: Option<f64> = value.parse().ok();
        let is = |found: &str| is_same_word(found, value) || number.is_some() && found.parse().ok() == number;
        self.rows.retain(|row| is(&row[place]));
        match self.rows.is_empty() {
            true => Err(TableError::NoRow { file: self.file.clone(), column: column.into(), value: value.into() }),
            false => Ok(()),
        }
    }

    /// Name and unit of a column, by its name with or without the unit.
    ///
    /// # Errors
    /// There is no such column.
    pub fn heading(&self, name: &str) -> Result<&str, TableError> {
        self.place(name).map(|place| self.columns[place].as_str())
    }

    /// The numbers of a column, by its name with or without the unit; nothing where a field is empty.
    ///
    /// # Errors
    /// There is no such column, or it has a field that is no number.
    pub fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, TableError> {
        let place = self.place(name)?;
        let number = |row: usize| match &self.rows[row][place] {
            "" => Ok(None),
            text => text.parse().map(Some).map_err(|_| self.wrong(row, place, "a number")),
        };
        (0..self.rows.len()).map(number).collect()
    }

    /// What each row did beside a limit: the probability of an ensemble where the table has one, its single run otherwise.
    ///
    /// # Errors
    /// The table has no outcomes, or one that is none.
    pub fn cases(&self, limit: Limit) -> Result<Cases, TableError> {
        let ends = self.ends()?;
        let column = |name: &str| match self.place(name) {
            Ok(_) => self.numbers(name),
            Err(_) => Ok(vec![None; self.rows.len()]),
        };
        // Peaks decide on limits of the rotation; for overturning they only show how far standing blocks rocked.
        let peaks = match limit {
            Limit::Overturned => column("peak.theta/alpha")?,
            Limit::Rotation(_) => self.numbers("peak.theta/alpha")?,
        };
        let liftoffs = column("events.liftoffs")?;
        let is_ensemble = self.place("ensemble.samples").is_ok();
        let probabilities = match is_ensemble {
            true => self.numbers(&format!("P({limit})"))?,
            false => vec![None; self.rows.len()],
        };
        let mut found = Cases::default();
        let mut motions = BTreeMap::new();
        let names = ["record", "vertical"].map(|name| self.place(name).ok());
        for (row, ((end, peak), probability)) in ends.into_iter().zip(peaks).zip(probabilities).enumerate() {
            let mut known: Vec<String> = names.iter().flatten().map(|&place| self.rows[row][place].into()).collect();
            if known.iter().all(String::is_empty) {
                // No key of one or two names equals these three.
                known = vec![String::new(), String::new(), row.to_string()];
            }
            let next = motions.len();
            let motion = *motions.entry(known).or_insert(next);
            let exceeds = match limit {
                Limit::Overturned => end == End::Overturned,
                Limit::Rotation(limit) => end == End::Overturned || peak.is_some_and(|peak| peak > limit),
            };
            let fraction = match (is_ensemble, end) {
                // Nothing, where no sample tells.
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

    /// How the run of each row ended.
    pub(super) fn ends(&self) -> Result<Vec<End>, TableError> {
        let place = self.place("outcome")?;
        let end = |row: usize| self.rows[row][place].parse().map_err(|error: String| self.wrong(row, place, &error));
        (0..self.rows.len()).map(end).collect()
    }

    /// The fields of each row between its number and a column: what block and ground motion it is of.
    pub(super) fn before(&self, column: &str) -> Result<Vec<String>, TableError> {
        let place = self.place(column)?;
        let fields =
            |row: &csv::StringRecord| row.iter().take(place).skip(1).map(|field| format!("{field}\n")).collect();
        Ok(self.rows.iter().map(fields).collect())
    }

    /// An error at a row that has no level of a measure.
    pub(super) fn no_level(&self, row: usize, im: &str) -> TableError {
        self.place(im).map_or_else(|error| error, |place| self.wrong(row, place, "a level"))
    }

    /// An error where levels differ.
    pub(super) fn no_levels(&self, im: &str) -> TableError {
        TableError::Levels { file: self.file.clone(), im: im.into() }
    }

    fn place(&self, name: &str) -> Result<usize, TableError> {
        let is_named = |column: &str, same: fn(&str, &str) -> bool| {
            same(column, name) || column.split_once(" [").is_some_and(|(known, _)| same(known, name))
        };
        let exact = self.columns.iter().position(|column| is_named(column, |a, b| a == b));
        let in_any_case = || self.columns.iter().position(|column| is_named(column, str::eq_ignore_ascii_case));
        exact.or_else(in_any_case).ok_or_else(|| TableError::Column {
            file: self.file.clone(),
            name: name.into(),
            known: self.columns.join(", "),
        })
    }

    fn wrong(&self, row: usize, place: usize, expected: &str) -> TableError {
        let number = self.rows[row].get(0).and_then(|number| number.parse().ok()).unwrap_or(row);
        let found = self.rows[row][place].to_string();
        let (file, column) = (self.file.clone(), self.columns[place].clone());
        TableError::Field { file, row: number, column, found, expected: expected.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# a study\nrow,p [rad/s],record,PGV [m/s],outcome,peak.theta/alpha [1]\n0,1,a,0.5,completed,0.3\n\
                         1,1,b,0.7,overturned,7\n2,2,a,,completed,0.6\n3,2,b,0.9,separated,0.2\n4,2,b,0.9,separated,0.8\n\
                         5,2,a,0.2,failed,0.1\n6,2,a,0.2,completed,0\n7,2,a,0.2,undecided,0.4\n8,2,b,0.2,undecided,3.3\n";

    fn table(text: &str) -> Table {
        Table::read("t.csv", text.as_bytes()).unwrap()
    }

    #[test]
    fn rows_tell_what_exceeds_a_limit() {
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

    #[test]
    fn an_ensemble_tells_its_probability() {
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
        let told = table(TABLE).numbers("outcome").unwrap_err().to_string();
        assert_eq!(told, "t.csv: row 0 has outcome = completed; expected a number");
        let told = table(TABLE).numbers("PGA").unwrap_err().to_string();
        assert!(told.contains("has no column PGA") && told.contains("PGV [m/s]"), "{told}");
        for rotation in ["0.5", "theta/alpha>0.5", "Theta/Alpha>0.5"] {
            assert_eq!(rotation.parse(), Ok(Limit::Rotation(0.5)));
        }
        assert_eq!("Overturned".parse(), Ok(Limit::Overturned));
        assert_eq!(table(TABLE).numbers("pgv").unwrap(), table(TABLE).numbers("PGV").unwrap());
        for wrong in ["fallen", "-1", "theta/alpha>0", "theta/alpha>x"] {
            assert!(wrong.parse::<Limit>().unwrap_err().contains(wrong));
        }
    }
}
