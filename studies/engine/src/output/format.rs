//! A table and what it is → the bytes of a file, in the format of its name.

use std::io;
use std::path::Path;

use crate::mismatch::Mismatch;
use crate::output::csv::{comments, with_headings};
use crate::output::parquet;
use crate::output::table::Table;
use crate::spec::words::Words;

/// The format of a file of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values, below comments.
    Csv,
    /// Parquet, in programs that are built with it.
    Parquet,
}

/// The words are the extensions of the files.
impl Words for TableFormat {
    const WORDS: &'static [(&'static str, TableFormat)] =
        &[("csv", TableFormat::Csv), ("parquet", TableFormat::Parquet)];
}

impl TableFormat {
    /// The usual format of parts.
    pub const OF_PARTS: TableFormat = if cfg!(feature = "parquet") { TableFormat::Parquet } else { TableFormat::Csv };

    /// The format of a file, by its name. A name that tells no format is one of CSV.
    pub fn of(path: &Path) -> TableFormat {
        path.extension().and_then(|extension| TableFormat::named(extension.to_str()?)).unwrap_or(TableFormat::Csv)
    }

    /// Refuses a format that this program is built without.
    ///
    /// # Errors
    /// Says what is expected instead.
    pub fn check(self) -> Result<(), Mismatch> {
        match self {
            TableFormat::Parquet if cfg!(not(feature = "parquet")) => {
                let expected = "a name in .csv, or a program built with --features rocking/parquet";
                Err(Mismatch::new("a table in Parquet, without which this program is built", expected))
            }
            TableFormat::Csv | TableFormat::Parquet => Ok(()),
        }
    }
}

/// A table, and lines on what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedTable {
    /// The lines.
    pub study: Vec<String>,
    /// The table.
    pub table: Table,
}

impl DescribedTable {
    /// The bytes of a file.
    ///
    /// # Errors
    /// The program does not know the format.
    pub fn encode(self, format: TableFormat) -> io::Result<Vec<u8>> {
        let DescribedTable { study, table } = self;
        match format {
            TableFormat::Csv => Ok((comments(&study) + &with_headings(&table)?).into_bytes()),
            TableFormat::Parquet => parquet::file(&study, &table.headings(), table),
        }
    }
}

/// A table that needs no lines.
impl From<Table> for DescribedTable {
    fn from(table: Table) -> DescribedTable {
        DescribedTable { study: Vec::new(), table }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::table::samples;

    #[test]
    fn the_name_of_a_file_tells_its_format() {
        for (word, format) in TableFormat::WORDS {
            assert_eq!(TableFormat::of(&Path::new("runs").with_extension(word)), *format);
        }
        assert_eq!(TableFormat::of(Path::new("runs.PARQUET")), TableFormat::Parquet);
        assert_eq!(["runs.txt", "-", "parquet"].map(|name| TableFormat::of(Path::new(name))), [TableFormat::Csv; 3]);
    }

    #[test]
    fn lines_precede_the_headings() {
        let table = samples::table(&[(7, 2.0, "a")]);
        let described = DescribedTable { study: vec!["a study\nof two lines".into()], table };
        let text = String::from_utf8(described.encode(TableFormat::Csv).unwrap()).unwrap();
        assert!(text.starts_with("# a study of two lines\nrow,x [m/s2]"), "{text}");
    }
}
