//! The table of a sweep → its columns, by their names.

use std::io::Read;

use crate::input::motion::MOTION;
use crate::input::parameters::is_same_word;
use crate::intensity::Measure;
use crate::mismatch::Mismatch;
use crate::output::reading::{TableReadError, TableReader};
use crate::output::table::{Kind, Series, Table, Values, split_heading};
use crate::run::fatigue;
use crate::run::limit::Limit;
use crate::run::outcome::End;

/// The reason why a table cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum SweepTableError {
    /// The file is not a table.
    #[error(transparent)]
    Read(#[from] TableReadError),
    /// The table lacks the content that an evaluation needs.
    #[error("{file}: {message}")]
    Content {
        /// The table.
        file: String,
        /// The content found, and the expected one.
        message: String,
    },
}

/// Column of blocks with ties: the peak rotation over the balance angle of its side.
const OVER_BALANCE: &str = "peak.theta/balance";

/// Column of blocks in space: the peak tilt over the critical one in the direction of the lean.
const TILT: &str = "peak.tilt/alpha";

/// Its predecessor: the peak tilt over that of the balance over the nearest edge.
const OVER_NEAREST_EDGE: &str = "peak.tilt/alpha_edge";

/// The rows that a fit uses: those with a value in each of some columns.
#[derive(Clone, Debug, Default)]
pub struct ChosenRows {
    /// Columns and their values, with the number of rows that met each condition and those before it.
    conditions: Vec<(String, String, usize)>,
}

impl ChosenRows {
    /// Begins with columns and their values.
    pub fn new(conditions: impl IntoIterator<Item = (String, String)>) -> ChosenRows {
        ChosenRows { conditions: conditions.into_iter().map(|(column, value)| (column, value, 0)).collect() }
    }

    /// The columns of the conditions.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.conditions.iter().map(|(column, ..)| column.as_str())
    }

    /// Keeps only these rows of a batch, which may have none.
    ///
    /// # Errors
    /// There is no such column.
    pub fn keep(&mut self, batch: &mut SweepTable) -> Result<(), SweepTableError> {
        for (column, value, met) in &mut self.conditions {
            batch.keep(column, value)?;
            *met += batch.rows();
        }
        Ok(())
    }

    /// Refuses a table none of whose rows met a condition.
    ///
    /// # Errors
    /// Names the condition.
    pub fn check(&self, file: &str) -> Result<(), SweepTableError> {
        let Some((column, value, _)) = self.conditions.iter().find(|(.., met)| *met == 0) else { return Ok(()) };
        let message = format!("found no row with {column} = {value}; expected a value of that column");
        Err(SweepTableError::Content { file: file.into(), message })
    }
}

/// The table of a sweep.
#[derive(Clone, Debug)]
pub struct SweepTable {
    /// Name of the file.
    pub file: String,
    /// Its columns.
    pub table: Table,
    /// Headings of all columns of the file, including those left out of the table.
    headings: Vec<String>,
    /// Position of the first row in the file.
    first: usize,
    /// Positions of the rows among all from the first one, if some were left out.
    kept: Option<Vec<usize>>,
}

/// Parameters whose ranges describe the blocks of a table. Their columns may have the prefix `dimensionless.`.
pub const DESCRIBED: [&str; 3] = ["alpha", "eta", "xi_v"];

/// Other columns that fits read whatever their measure.
const OF_FITS: [&str; 17] = [
    "row",
    "outcome",
    "peak.theta/alpha",
    OVER_BALANCE,
    "peak.slip",
    "ties.broken",
    "events.liftoffs",
    "ensemble.samples",
    "record",
    "vertical",
    MOTION,
    "eccentricity",
    "foundation",
    TILT,
    "peak.twist",
    "peak.drift",
    "events.lift_offs",
];

/// Whether a fit over the named columns needs a column.
pub fn is_needed(column: &str, named: &[impl AsRef<str>]) -> bool {
    let is_named = |named: &dyn AsRef<str>| {
        let name = split_heading(named.as_ref()).0;
        column.eq_ignore_ascii_case(name) || name.parse::<Measure>().is_ok_and(|measure| measure.to_string() == column)
    };
    DESCRIBED.contains(&column.strip_prefix("dimensionless.").unwrap_or(column))
        || OF_FITS.contains(&column)
        || is_plastic(column)
        || column.starts_with(fatigue::COLUMN)
        || ["P(", "ensemble.", "least."].iter().any(|prefix| column.starts_with(prefix))
        || named.iter().any(|named| is_named(named))
}

/// Whether a column has the plastic elongations of a tie or damper.
fn is_plastic(column: &str) -> bool {
    column.starts_with("peak.") && column.ends_with(".plastic")
}

impl SweepTable {
    /// Evaluates the rows of a study; `file` is the name of the table in errors.
    pub fn new(file: &str, table: Table) -> SweepTable {
        let headings = table.columns().iter().map(|column| column.heading.to_string()).collect();
        SweepTable { file: file.into(), table, headings, first: 0, kept: None }
    }

    /// Evaluates some columns of rows of a file with these headings, from the row at the position `first`.
    ///
    /// # Errors
    /// The table of a former release, whose `peak.tilt/alpha` has another meaning.
    pub fn batch(file: &str, table: Table, headings: Vec<String>, first: usize) -> Result<SweepTable, SweepTableError> {
        let table = SweepTable { file: file.into(), table, headings, first, kept: None };
        if table.headings.iter().any(|heading| split_heading(heading).0 == OVER_NEAREST_EDGE) {
            return Err(table.refused(format!(
                "found the column {OVER_NEAREST_EDGE}, of a former release; expected only {TILT}, the tilt over that of the balance in \
                 the direction of the lean, as from the same study run again"
            )));
        }
        Ok(table)
    }

    /// Reads a table; `file` is its name in errors.
    ///
    /// # Errors
    /// A row with the wrong number of fields or with the headings, or invalid UTF-8.
    pub fn read(file: &str, content: impl Read) -> Result<SweepTable, SweepTableError> {
        let mut reader = TableReader::new(&|_| true);
        reader.read_csv(file, content)?;
        let headings = reader.headings().to_vec();
        SweepTable::batch(file, reader.table(), headings, 0)
    }

    /// The distinct words of a column in the order of the rows. `None` without such a column.
    pub fn words(&self, name: &str) -> Option<Vec<String>> {
        let column = self.column(name).ok()?;
        let mut words = Vec::new();
        for word in (0..self.rows()).map(|row| column.text(row)) {
            if !words.contains(&word) {
                words.push(word);
            }
        }
        Some(words)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.table.rows()
    }

    /// Keeps only the rows with this value in a column; there may be none.
    ///
    /// # Errors
    /// There is no such column.
    fn keep(&mut self, column: &str, value: &str) -> Result<(), SweepTableError> {
        let series = self.column(column)?;
        let number: Option<f64> = value.parse().ok();
        let is = |row: usize| {
            let found = series.text(row);
            is_same_word(&found, value) || number.is_some() && found.parse().ok() == number
        };
        let is_kept: Vec<bool> = (0..self.rows()).map(is).collect();
        let kept = (0..self.rows()).filter(|row| is_kept[*row]).map(|row| self.position(row)).collect();
        self.table.retain(&is_kept);
        self.kept = Some(kept);
        Ok(())
    }

    /// The heading of a column, found by its name with or without the unit.
    ///
    /// # Errors
    /// There is no such column.
    pub fn heading(&self, name: &str) -> Result<String, SweepTableError> {
        self.column(name).map(|column| column.heading.to_string())
    }

    /// The numbers of a column, with `None` for empty fields. Its name may have the unit.
    ///
    /// # Errors
    /// There is no such column, or a field is not a number.
    pub fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, SweepTableError> {
        let column = self.column(name)?;
        (0..self.rows()).map(|row| self.number(column, row)).collect()
    }

    pub(super) fn number(&self, column: &Series, row: usize) -> Result<Option<f64>, SweepTableError> {
        match &column.values {
            Values::Real(_) | Values::Integer(_) => Ok(column.number(row)),
            Values::Boolean(_) | Values::Choice(_) | Values::Text(_) => match column.text(row).as_str() {
                "" => Ok(None),
                text => text.parse().map(Some).map_err(|_| self.wrong(row, column, "a number")),
            },
        }
    }

    /// Whether the blocks are in space.
    pub fn is_in_space(&self) -> bool {
        self.column(TILT).is_ok()
    }

    /// The column of the peak rotation: |θ|/α, or in space the tilt over that of the balance.
    pub(super) fn rotation(&self) -> &'static str {
        if self.is_in_space() { TILT } else { "peak.theta/alpha" }
    }

    /// The limit for the blocks of the table: a rotation or the balance is a tilt in space.
    pub fn limit_of(&self, limit: Limit) -> Limit {
        if self.is_in_space() { limit.in_space() } else { limit }
    }

    /// The columns whose greatest value a limit refers to.
    pub(super) fn limited(&self, limit: Limit) -> Result<Vec<&Series>, SweepTableError> {
        let all_of = |is_one: fn(&str) -> bool, expected: &str| -> Result<Vec<&Series>, SweepTableError> {
            let found: Vec<_> = self.table.columns().iter().filter(|column| is_one(&column.heading.name)).collect();
            if found.is_empty() { self.column(expected).map(|column| vec![column]) } else { Ok(found) }
        };
        // Without ties, even blocks have their peaks over the balance in `peak.theta/alpha`.
        let is_even = self.column(OVER_BALANCE).is_err() && self.column("eccentricity").is_err();
        match limit {
            Limit::Overturned => Ok(Vec::new()),
            Limit::Balance if !is_even => self.column(OVER_BALANCE).map(|column| vec![column]),
            Limit::Balance | Limit::Rotation(_) => self.column("peak.theta/alpha").map(|column| vec![column]),
            Limit::Slip(_) => self.column("peak.slip").map(|column| vec![column]),
            Limit::Plastic(_) => all_of(is_plastic, "peak.damper_1.plastic"),
            Limit::HalfCycles(_) => all_of(|name| name.starts_with(fatigue::COLUMN), fatigue::COLUMN),
            Limit::Breaks => self.column("ties.broken").map(|column| vec![column]),
            Limit::Tilt(_) => self.column(TILT).map(|column| vec![column]),
            Limit::Twist(_) => self.column("peak.twist").map(|column| vec![column]),
            Limit::Drift(_) => self.column("peak.drift").map(|column| vec![column]),
        }
    }

    /// The usual limit: overturning, or the balance of blocks with ties. Ties may hold a block beyond the balance at rest or in motion.
    pub fn usual_limit(&self) -> Limit {
        if self.column(OVER_BALANCE).is_ok() { Limit::Balance } else { Limit::Overturned }
    }

    /// The end of each row's run. A table of others may say 1 or true for overturned, and 0 or false for completed.
    pub(super) fn ends(&self) -> Result<Vec<End>, SweepTableError> {
        let column = self.column("outcome")?;
        let end = |row: usize| match column.text(row).to_ascii_lowercase().as_str() {
            "0" | "false" => Ok(End::Completed),
            "1" | "true" => Ok(End::Overturned),
            word => word.parse().map_err(|error: Mismatch| self.wrong(row, column, &error.expected)),
        };
        // Parses each distinct word once; words that no row uses may be invalid.
        let known: Vec<Option<End>> = match &column.heading.kind {
            Kind::Choice(words) => words.iter().map(|word| word.parse().ok()).collect(),
            _ => Vec::new(),
        };
        let fast = |row: usize| match &column.values {
            Values::Choice(positions) => known.get(positions[row] as usize).copied().flatten(),
            _ => None,
        };
        (0..self.rows()).map(|row| fast(row).map_or_else(|| end(row), Ok)).collect()
    }

    /// The error for a row without a level of a measure.
    pub(super) fn no_level(&self, row: usize, im: &str) -> SweepTableError {
        self.column(im).map_or_else(|error| error, |column| self.wrong(row, column, "a level"))
    }

    /// The column with this name, with or without the unit.
    ///
    /// # Errors
    /// There is no such column.
    pub fn column(&self, name: &str) -> Result<&Series, SweepTableError> {
        let find = |name: &str, same: fn(&str, &str) -> bool| {
            let is = |series: &&Series| same(&series.heading.name, name) || same(&series.heading.to_string(), name);
            self.table.columns().iter().find(is)
        };
        let exact = find(name, |a, b| a == b);
        // `Sa(0.5)` is the column `Sa(0.5 s)`.
        let measure = || find(&name.parse::<Measure>().ok()?.to_string(), |a, b| a == b);
        exact
            .or_else(|| find(name, str::eq_ignore_ascii_case))
            .or_else(measure)
            .ok_or_else(|| self.refused(format!("has no column {name}; expected one of {}", self.headings.join(", "))))
    }

    /// The position of a row among all from the first one.
    fn position(&self, row: usize) -> usize {
        self.kept.as_ref().map_or(row, |kept| kept[row])
    }

    fn wrong(&self, row: usize, column: &Series, expected: &str) -> SweepTableError {
        let number = self.table.column("row").and_then(|numbers| numbers.text(row).parse().ok());
        let number = number.unwrap_or(self.first + self.position(row));
        self.refused(format!("row {number} has {} = {}; expected {expected}", column.heading, column.text(row)))
    }

    pub(super) fn refused(&self, message: String) -> SweepTableError {
        SweepTableError::Content { file: self.file.clone(), message }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::fragility) const TABLE: &str = "# a study\nrow,p [rad/s],record,PGV [m/s],outcome,peak.theta/alpha [1]\n0,1,a,0.5,completed,0.3\n\
                         1,1,b,0.7,overturned,7\n2,2,a,,completed,0.6\n3,2,b,0.9,separated,0.2\n4,2,b,0.9,separated,0.8\n\
                         5,2,a,0.2,failed,0.1\n6,2,a,0.2,completed,0\n7,2,a,0.2,undecided,0.4\n8,2,b,0.2,undecided,3.3\n";

    fn table(text: &str) -> SweepTable {
        SweepTable::read("t.csv", text.as_bytes()).unwrap()
    }

    #[test]
    fn columns_are_found_with_and_without_their_unit() {
        let mut kept = table(TABLE);
        assert_eq!(kept.numbers("PGV").unwrap(), kept.numbers("PGV [m/s]").unwrap());
        assert_eq!(kept.numbers("PGV").unwrap()[..3], [Some(0.5), Some(0.7), None]);
        let mut chosen = |column: &str, value: &str| {
            let mut rows = ChosenRows::new([(column.into(), value.into())]);
            rows.keep(&mut kept).unwrap();
            (kept.rows(), rows.check("t.csv").map_err(|error| error.to_string()))
        };
        assert_eq!(chosen("p", "1.0"), (2, Ok(())));
        let refused = "t.csv: found no row with record = c; expected a value of that column";
        assert_eq!(chosen("record", "c"), (0, Err(refused.into())));
        // Without numbers, rows have those of their positions in the file.
        let read = table("p,outcome\n1,completed\n2,overturned\n2,fallen\n");
        let mut batch = SweepTable::batch("t.csv", read.table, Vec::new(), 1000).unwrap();
        ChosenRows::new([("p".into(), "2".into())]).keep(&mut batch).unwrap();
        let message = batch.ends().unwrap_err().to_string();
        assert!(message.starts_with("t.csv: row 1002 has outcome = fallen; expected"), "{message}");
        let message = table(TABLE).numbers("outcome").unwrap_err().to_string();
        assert_eq!(message, "t.csv: row 0 has outcome = completed; expected a number");
        let message = table(TABLE).numbers("PGA").unwrap_err().to_string();
        assert!(message.contains("has no column PGA") && message.contains("PGV [m/s]"), "{message}");
        for rotation in ["0.5", "theta/alpha>0.5", "Theta/Alpha>0.5"] {
            assert_eq!(rotation.parse(), Ok(Limit::Rotation(0.5)));
        }
        for slip in ["slip:0.1", "Slip>0.1"] {
            assert_eq!(slip.parse(), Ok(Limit::Slip(0.1)));
            assert_eq!(slip.to_lowercase().replace("slip", "Plastic").parse(), Ok(Limit::Plastic(0.1)));
        }
        assert_eq!("Overturned".parse(), Ok(Limit::Overturned));
        assert_eq!(table(TABLE).numbers("pgv").unwrap(), table(TABLE).numbers("PGV").unwrap());
        for wrong in ["fallen", "-1", "theta/alpha>0", "theta/alpha>x", "slip:0", "slip:far", "slip"] {
            assert!(wrong.parse::<Limit>().unwrap_err().contains(wrong));
        }
    }

    #[test]
    fn a_spectral_measure_is_found_without_its_unit_of_time() {
        let table = table("row,Sa(0.5 s) [m/s2],outcome\n0,3,completed\n");
        for name in ["Sa(0.5 s)", "Sa(0.5)", "SA(0.50)", "sa(0.5s)"] {
            assert_eq!(table.numbers(name).unwrap(), [Some(3.0)], "{name}");
        }
        assert!(table.numbers("Sa(0.6)").unwrap_err().to_string().contains("has no column Sa(0.6)"));
    }

    #[test]
    fn fits_need_the_columns_that_they_name() {
        let named = ["PGV [m/s]", "sa(0.5)"];
        for (column, is) in [
            ("PGV", true),
            ("Sa(0.5 s)", true),
            ("dimensionless.alpha", true),
            ("P(0.5)", true),
            ("PGA", false),
            ("end_time", false),
        ] {
            assert_eq!(is_needed(column, &named), is, "{column}");
        }
    }

    #[test]
    fn joined_tables_are_refused_with_that_reason() {
        let message = SweepTable::read("t.csv", TABLE.repeat(2).as_bytes()).unwrap_err().to_string();
        assert!(
            message.starts_with("t.csv: repeats its headings after 9 rows, as in tables joined by cat"),
            "{message}"
        );
    }
}
