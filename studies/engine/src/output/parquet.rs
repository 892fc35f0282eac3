//! Tables → Parquet, and back.
//!
//! The names of columns are those of the table, without their units, and missing numbers and empty texts are nulls. The metadata of the file has
//! the units, a JSON object by the names of the columns, the description of the study, line by line, and a checksum of the whole file, under `units`,
//! `study` and `checksum`.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::{FileMetaData, KeyValue};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::output::seal::{self, SealingWriter};
use crate::output::table::{Heading, Kind, Series, Table, Values};

/// Rows of a group, which is kept in memory until it is compressed. Only the last one has fewer: the bytes of a file do not depend on the
/// batches of its rows.
const GROUP: usize = 1 << 16;

/// A file in progress.
pub struct ParquetWriter<W: Write + Send> {
    writer: SerializedFileWriter<SealingWriter<W>>,
    group: Table,
}

impl<W: Write + Send> ParquetWriter<W> {
    /// Begins the file of a table with these columns.
    ///
    /// # Errors
    /// `out` takes no bytes.
    pub fn new(out: W, study: &[String], columns: &[Heading]) -> io::Result<ParquetWriter<W>> {
        ParquetWriter::begun(out, study, columns).map_err(io::Error::other)
    }

    fn begun(out: W, study: &[String], columns: &[Heading]) -> Result<ParquetWriter<W>> {
        let units: BTreeMap<&str, &str> =
            columns.iter().filter_map(|heading| Some((heading.name.as_str(), heading.unit.as_deref()?))).collect();
        let units = serde_json::to_string(&units).map_err(|error| ParquetError::External(error.into()))?;
        let metadata = [("units", units), ("study", study.join("\n")), ("checksum", seal::BLANK.into())];
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(Default::default()))
            .set_created_by(concat!("rocking-block ", env!("CARGO_PKG_VERSION")).into())
            .set_key_value_metadata(Some(metadata.map(|(key, value)| KeyValue::new(key.into(), value)).into()))
            .build();
        let fields = columns.iter().map(field).collect::<Result<_>>()?;
        let schema = Type::group_type_builder("schema").with_fields(fields).build()?;
        let writer = SerializedFileWriter::new(SealingWriter::new(out), Arc::new(schema), Arc::new(properties))?;
        Ok(ParquetWriter { writer, group: Table::new(columns.to_vec()) })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// `out` takes no bytes.
    pub fn push(&mut self, rows: Table) -> io::Result<()> {
        self.group.append(rows);
        while self.group.rows() >= GROUP {
            let more = self.group.split_off(GROUP);
            self.end_group().map_err(io::Error::other)?;
            self.group = more;
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// `out` takes no bytes.
    pub fn finish(mut self) -> io::Result<W> {
        if self.group.rows() > 0 {
            self.end_group().map_err(io::Error::other)?;
        }
        self.writer.inner_mut().begin_end();
        self.writer.into_inner().map_err(io::Error::other)?.finish()
    }

    fn end_group(&mut self) -> Result<()> {
        let empty = Table::new(self.group.headings());
        let rows = std::mem::replace(&mut self.group, empty);
        let mut group = self.writer.next_row_group()?;
        for column in rows.columns() {
            // The schema has as many columns as the table.
            let Some(mut writer) = group.next_column()? else { break };
            let is_known: Vec<i16> = (0..rows.rows()).map(|row| i16::from(!is_missing(column, row))).collect();
            match &column.values {
                Values::Real(values) => {
                    let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
                    writer.typed::<DoubleType>().write_batch(&known, Some(&is_known), None)?;
                }
                Values::Integer(values) => {
                    writer.typed::<Int64Type>().write_batch(values, Some(&is_known), None)?;
                }
                Values::Boolean(values) => {
                    writer.typed::<BoolType>().write_batch(values, Some(&is_known), None)?;
                }
                Values::Choice(_) | Values::Text(_) => {
                    let words = (0..rows.rows()).filter_map(|row| column.word(row).filter(|word| !word.is_empty()));
                    let words: Vec<ByteArray> = words.map(ByteArray::from).collect();
                    writer.typed::<ByteArrayType>().write_batch(&words, Some(&is_known), None)?;
                }
            }
            writer.close()?;
        }
        group.close().map(|_| ())
    }
}

fn is_missing(column: &Series, row: usize) -> bool {
    match &column.values {
        Values::Real(values) => values[row].is_nan(),
        Values::Integer(_) | Values::Boolean(_) => false,
        Values::Choice(_) | Values::Text(_) => column.word(row).is_none_or(str::is_empty),
    }
}

fn field(heading: &Heading) -> Result<Arc<Type>> {
    let (physical, logical) = match heading.kind {
        Kind::Real => (PhysicalType::DOUBLE, None),
        Kind::Integer => (PhysicalType::INT64, None),
        Kind::Boolean => (PhysicalType::BOOLEAN, None),
        Kind::Choice(_) | Kind::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let field = Type::primitive_type_builder(&heading.name, physical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()?))
}

/// Returns the file of a table with these columns; one without rows may lack them.
///
/// # Errors
/// None in practice: the file is written to memory.
pub fn file(study: &[String], columns: &[Heading], table: Table) -> io::Result<Vec<u8>> {
    let mut writer = ParquetWriter::new(Vec::new(), study, columns)?;
    if table.rows() > 0 {
        writer.push(table)?;
    }
    writer.finish()
}

/// A file, read column by column in groups of rows.
pub(super) struct Groups {
    reader: SerializedFileReader<File>,
    pub(super) headings: Vec<Heading>,
}

impl Groups {
    /// Opens a file.
    ///
    /// # Errors
    /// The content is not that of a Parquet file, or a column has columns of its own.
    pub(super) fn new(content: File) -> io::Result<Groups> {
        Groups::begun(content).map_err(io::Error::other)
    }

    fn begun(content: File) -> Result<Groups> {
        let reader = SerializedFileReader::new(content)?;
        let metadata = reader.metadata().file_metadata();
        let units: BTreeMap<String, String> =
            entry(metadata, "units").and_then(|units| serde_json::from_str(units).ok()).unwrap_or_default();
        let heading = |field: &Arc<Type>| {
            let kind = match (
                field.is_primitive().then(|| field.get_physical_type()),
                field.get_basic_info().logical_type_ref(),
            ) {
                (Some(PhysicalType::DOUBLE | PhysicalType::FLOAT), _) => Kind::Real,
                (Some(PhysicalType::INT64 | PhysicalType::INT32), None | Some(LogicalType::Integer { .. })) => {
                    Kind::Integer
                }
                (Some(PhysicalType::BOOLEAN), _) => Kind::Boolean,
                (Some(_), _) => Kind::Text,
                (None, _) => {
                    let name = field.name();
                    return Err(ParquetError::General(format!(
                        "column {name} has columns of its own; expected plain ones"
                    )));
                }
            };
            Ok(Heading { name: field.name().into(), unit: units.get(field.name()).cloned(), kind })
        };
        let headings = metadata.schema().get_fields().iter().map(heading).collect::<Result<Vec<_>>>()?;
        Ok(Groups { reader, headings })
    }

    /// The description of the study, line by line.
    pub(super) fn study(&self) -> Vec<String> {
        entry(self.reader.metadata().file_metadata(), "study").unwrap_or_default().lines().map(String::from).collect()
    }

    /// Number of groups.
    pub(super) fn count(&self) -> usize {
        self.reader.num_row_groups()
    }

    /// Begins with the wanted columns of a group.
    ///
    /// # Errors
    /// The content is damaged.
    pub(super) fn group(&self, group: usize, is_wanted: &[bool]) -> io::Result<GroupReader> {
        self.begin_group(group, is_wanted).map_err(io::Error::other)
    }

    fn begin_group(&self, group: usize, is_wanted: &[bool]) -> Result<GroupReader> {
        let group = self.reader.get_row_group(group)?;
        let wanted = self.headings.iter().enumerate().filter(|(number, _)| is_wanted[*number]);
        let column = |(number, heading): (usize, &Heading)| Ok((heading.clone(), group.get_column_reader(number)?));
        Ok(GroupReader {
            left: group.metadata().num_rows() as usize,
            columns: wanted.map(column).collect::<Result<_>>()?,
        })
    }
}

/// Columns of a group, read in batches of rows.
pub(super) struct GroupReader {
    left: usize,
    columns: Vec<(Heading, ColumnReader)>,
}

impl GroupReader {
    /// Reads the next rows, and returns their number with their columns.
    ///
    /// # Errors
    /// The content is damaged, or a column is neither one of numbers, whole numbers, booleans nor texts.
    pub(super) fn next(&mut self, most: usize) -> io::Result<Option<(usize, Vec<Series>)>> {
        let rows = self.left.min(most);
        self.left -= rows;
        let columns = self.columns.iter_mut().map(|(heading, reader)| series(heading, reader, rows));
        let columns = columns.collect::<Result<_>>().map_err(io::Error::other)?;
        Ok((rows > 0).then_some((rows, columns)))
    }
}

fn entry<'a>(metadata: &'a FileMetaData, key: &str) -> Option<&'a str> {
    let entries = metadata.key_value_metadata().into_iter().flatten();
    entries.filter(|entry| entry.key == key).find_map(|entry| entry.value.as_deref())
}

fn series(heading: &Heading, reader: &mut ColumnReader, rows: usize) -> Result<Series> {
    let mut kind = heading.kind.clone();
    let values = match reader {
        ColumnReader::DoubleColumnReader(reader) => Values::Real(all(reader, rows, f64::NAN)?),
        ColumnReader::FloatColumnReader(reader) => {
            Values::Real(all(reader, rows, f32::NAN)?.into_iter().map(f64::from).collect())
        }
        ColumnReader::Int64ColumnReader(reader) => Values::Integer(all(reader, rows, 0)?),
        ColumnReader::Int32ColumnReader(reader) => {
            Values::Integer(all(reader, rows, 0)?.into_iter().map(i64::from).collect())
        }
        ColumnReader::BoolColumnReader(reader) => Values::Boolean(all(reader, rows, false)?),
        ColumnReader::ByteArrayColumnReader(reader) => {
            let (mut words, mut known) = (Vec::new(), HashMap::new());
            let mut position = |text: ByteArray| match known.get(text.data()) {
                Some(position) => Ok(*position),
                None => {
                    let next = words.len() as u32;
                    words.push(text.as_utf8()?.to_string());
                    known.insert(text.data().to_vec(), next);
                    Ok(next)
                }
            };
            let texts = all(reader, rows, ByteArray::from(""))?;
            let positions = texts.into_iter().map(&mut position).collect::<Result<_>>()?;
            kind = Kind::Choice(words.into());
            Values::Choice(positions)
        }
        _ => {
            let expected = "expected numbers, whole numbers, booleans or texts";
            return Err(ParquetError::General(format!("column {} has another type; {expected}", heading.name)));
        }
    };
    Ok(Series { heading: Heading { kind, ..heading.clone() }, values })
}

/// Reads all values of a column, `missing` for nulls.
fn all<T: DataType>(reader: &mut ColumnReaderImpl<T>, rows: usize, missing: T::T) -> Result<Vec<T::T>> {
    let (mut known, mut is_known) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
    while is_known.len() < rows {
        let before = is_known.len();
        let (read, ..) = reader.read_records(rows - before, Some(&mut is_known), None, &mut known)?;
        if is_known.len() == before {
            // A required column has no levels.
            is_known.resize(before + read, 1);
        }
        if read == 0 {
            return Err(ParquetError::EOF(format!("a column has {before} of {rows} rows")));
        }
    }
    let mut known = known.into_iter();
    let value = |is_known: &i16| match is_known {
        0 => missing.clone(),
        _ => known.next().unwrap_or(missing.clone()),
    };
    Ok(is_known.iter().map(value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::parts::{self, PartState};
    use crate::output::resumable::TableHeader;
    use crate::output::seal::Seal;
    use crate::output::table::samples;
    use crate::output::table_files::TableFiles;

    fn read(path: &std::path::Path) -> Option<Table> {
        Some(TableFiles::of(path).ok()?.read(&|_| true).ok()?.0)
    }

    fn table(rows: std::ops::Range<u64>) -> Table {
        let row = |number: u64| (number, 0.1 + 0.2 - (number % 7) as f64, ["a\"b", "", "long"][number as usize % 3]);
        samples::table(&rows.map(row).collect::<Vec<_>>())
    }

    /// Rows of two groups and a part of a third one.
    #[test]
    fn a_file_restores_all_values_with_their_units() {
        let rows = 2 * GROUP as u64 + 2000;
        let study = ["a study".into(), "of two lines".into()];
        let mut writer = ParquetWriter::new(Vec::new(), &study, &table(0..0).headings()).unwrap();
        for begin in (0..rows).step_by(999) {
            writer.push(table(begin..(begin + 999).min(rows))).unwrap();
        }
        let content = writer.finish().unwrap();
        // The batches leave no trace.
        assert!(content == file(&study, &table(0..0).headings(), table(0..rows)).unwrap());
        assert!(content.starts_with(b"PAR1") && content.ends_with(b"PAR1"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        std::fs::write(&path, &content).unwrap();
        let (found, expected) = (read(&path).unwrap(), table(0..rows));
        assert_eq!(found.rows(), expected.rows());
        for (found, expected) in found.columns().iter().zip(expected.columns()) {
            assert_eq!((&found.heading.name, &found.heading.unit), (&expected.heading.name, &expected.heading.unit));
            for row in 0..rows as usize {
                assert_eq!(found.text(row), expected.text(row), "{} in row {row}", found.heading);
            }
        }
        let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        assert_eq!(reader.num_row_groups(), 3);
        let groups = Groups::new(File::open(&path).unwrap()).unwrap();
        assert_eq!(groups.study(), study);
        assert_eq!(reader.metadata().file_metadata().num_rows(), rows as i64);
        assert_eq!(seal::check(&path).unwrap(), Seal::Whole);
        let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert!(metadata.contains(&KeyValue::new("study".into(), "a study\nof two lines".to_string())), "{metadata:?}");
        assert!(
            metadata.contains(&KeyValue::new("units".into(), r#"{"length":"1","root":"1","x":"m/s2"}"#.to_string()))
        );
    }

    #[test]
    fn other_content_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        let content = file(&[], &table(0..0).headings(), table(0..100)).unwrap();
        for content in [&b"row,x [m]\n0,1\n"[..], &content[..content.len() / 2], &content[content.len() / 2..]] {
            std::fs::write(&path, content).unwrap();
            assert_eq!(read(&path), None);
        }
    }

    /// The part is broken for its program, and its readers name the remedy.
    #[test]
    fn a_damaged_part_is_named_with_its_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part-00001-of-00001.parquet");
        let study = ["a study", "part 1 of 1, 100 rows of 100 in blocks of 3"].map(String::from);
        let header = TableHeader { study: study.to_vec(), columns: table(0..0).headings() };
        let content = file(&study, &header.columns, table(0..100)).unwrap();
        std::fs::write(&path, &content).unwrap();
        assert_eq!(parts::state(&path, &header).unwrap(), PartState::Complete);
        let files = TableFiles::of(folder.path()).unwrap();
        assert_eq!(files.read(&|_| true).unwrap().0.rows(), 100);
        let (mut spoilt, mut without_footer) = (content.clone(), content.clone());
        spoilt[10..200].fill(0);
        without_footer[content.len() - 300..].fill(0);
        let check = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            let message = files.read(&|_| true).unwrap_err().to_string();
            assert!(message.starts_with(&format!("{}: is damaged: ", path.display())), "{message}");
            assert!(message.ends_with("; make it anew: delete it, and run part 1 of 1 again"), "{message}");
            assert_eq!(parts::state(&path, &header).unwrap(), PartState::Broken);
        };
        let cut = [&content[..content.len() - 1], &content[..content.len() / 2], b""];
        cut.into_iter().chain([&spoilt[..], &without_footer]).for_each(check);
        for bit in (0..8 * content.len()).step_by(97) {
            let mut flipped = content.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            check(&flipped);
        }
    }

    /// The checksum of a file that was made with other rows than its description says is right.
    #[test]
    fn the_rows_of_a_part_are_those_of_its_plan() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part-00001-of-00001.parquet");
        let study = ["a study", "part 1 of 1, 4 rows of 4 in blocks of 1"].map(String::from);
        let row = |number: &u64| (*number, 0.5, "long");
        for (rows, message) in [
            (&[0, 1, 1, 3][..], "found row 1 in place of row 2"),
            (&[0, 1, 2], "found 3 rows, expected 4"),
            (&[0, 1, 2, 3, 3], "found 5 rows or more, expected 4"),
        ] {
            let table = samples::table(&rows.iter().map(row).collect::<Vec<_>>());
            std::fs::write(&path, file(&study, &table.headings(), table).unwrap()).unwrap();
            let found = TableFiles::of(folder.path()).unwrap().read(&|_| true).unwrap_err().to_string();
            assert!(found.contains(&format!(": is damaged: {message}; make it anew")), "{found}");
        }
    }
}
