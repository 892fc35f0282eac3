//! Rows of one number per channel → the numbers of one channel.

use super::error::RecordError;
use super::text::{FileText, Values, print_quantum};
use super::time_axis::TimeAxis;

/// Layout of the rows.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Number of columns.
    pub(super) columns: usize,
    /// Index of the times, if there are some.
    pub(super) time: Option<usize>,
    /// Index of the accelerations.
    pub(super) chosen: usize,
}

impl Rows {
    /// Reads the chosen column and the times. Every line that is not blank has all columns.
    pub(super) fn read<'s, Fields: Iterator<Item = &'s str>>(
        self,
        source: &'s FileText<'_>,
        lines: impl Iterator<Item = (usize, &'s str)>,
        split: impl Fn(&'s str) -> Fields,
    ) -> Result<(Vec<f64>, TimeAxis), RecordError> {
        let Rows { columns, time, chosen } = self;
        let (mut axis, mut values, mut last) = (TimeAxis::new(), Values::new(source), Values::new(source));
        let mut fields: Vec<&str> = Vec::new();
        for (line, text) in lines {
            if text.trim().is_empty() {
                continue;
            }
            fields.clear();
            fields.extend(split(text));
            if fields.len() != columns {
                let found = format!("{} columns", fields.len());
                return Err(source.header_error(line, &found, format!("a row of {columns} columns")));
            }
            for (index, field) in fields.iter().enumerate() {
                if time == Some(index) {
                    axis.push(line, source.number(line, field)?, print_quantum(field));
                }
                if index == chosen {
                    values.push(line, field)?;
                }
                // A file that is cut off ends here, whichever column is chosen.
                if index + 1 == columns {
                    last.push(line, field)?;
                }
            }
        }
        last.finish()?;
        Ok((values.finish()?, axis))
    }
}
