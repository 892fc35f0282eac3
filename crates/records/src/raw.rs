//! Content of a file in its own unit, caller's options → a record.

use super::claims::{self, Claim, SAME_STEP, StatedStep};
use super::error::RecordError;
use super::format::Format;
use super::options::{ReadOptions, Setting};
use super::processing::Processing;
use super::record::{Peak, Record};
use super::text::{FileText, number, print_quantum};
use super::unit::Unit;

/// Largest accepted peak (g). The largest ever recorded are near 4 g, so a larger one means a wrong unit.
const LARGEST_PEAK: f64 = 20.0;

/// Relative difference below which two peaks are equal.
const SAME_PEAK: f64 = 1e-4;

pub(super) struct StatedCount {
    pub(super) line: usize,
    /// Name of the count in the header.
    pub(super) key: &'static str,
    pub(super) value: usize,
}

pub(super) struct StatedPeak {
    pub(super) line: usize,
    /// Largest acceleration, in the unit of the values.
    pub(super) value: f64,
    /// Unit of the last printed digit, in the unit of the values.
    pub(super) quantum: f64,
}

impl StatedPeak {
    /// Returns a peak printed in a header in the unit of the values. `None` for text that is no number.
    pub(super) fn printed(line: usize, token: &str) -> Option<StatedPeak> {
        let value = number(token).filter(|value| value.is_finite())?;
        Some(StatedPeak { line, value, quantum: print_quantum(token) })
    }

    /// Returns the peak if a unit of the header has `factor` units of the values.
    pub(super) fn times(self, factor: f64) -> StatedPeak {
        StatedPeak { value: factor * self.value, quantum: factor * self.quantum, ..self }
    }
}

/// Content of a file in its own unit.
pub(super) struct Raw {
    pub(super) format: Format,
    pub(super) title: String,
    pub(super) unit: Option<(usize, Unit)>,
    /// Statements of the text before the values.
    pub(super) claims: Vec<Claim>,
    pub(super) time_step: Option<StatedStep>,
    pub(super) count: Option<StatedCount>,
    pub(super) peak: Option<StatedPeak>,
    /// Reason to doubt the values.
    pub(super) doubt: Option<String>,
    /// (s)
    pub(super) start_time: f64,
    pub(super) values: Vec<f64>,
}

impl Raw {
    pub(super) fn new(format: Format) -> Raw {
        Raw {
            format,
            title: String::new(),
            unit: None,
            claims: Vec::new(),
            time_step: None,
            count: None,
            peak: None,
            doubt: None,
            start_time: 0.0,
            values: Vec::new(),
        }
    }

    /// Settles unit and time step, checks count and peak, and converts to m/s².
    ///
    /// A peak that differs from that of the header is a reason for doubt.
    pub(super) fn into_record(
        self,
        source: &FileText<'_>,
        options: &ReadOptions,
    ) -> Result<(Record, Option<String>), RecordError> {
        let file = || source.name.clone();
        if let Some(StatedCount { line, key, value }) = self.count
            && value != self.values.len()
        {
            let counted = self.values.len();
            let message = format!("found {counted} values in the file, expected {value}, the header's {key}");
            return Err(source.line_error(line, message));
        }
        if self.values.len() < 2 {
            let message = format!("found {} values, expected at least 2", self.values.len());
            return Err(RecordError::File { file: file(), message });
        }
        let time_step = claims::time_step(source, self.time_step, &self.claims, options.time_step)?;
        let (unit_line, unit) = claims::unit(source, self.unit, &self.claims, options)?;
        let doubt = self.doubt.or_else(|| {
            let stated = self.peak.as_ref()?;
            let found = self.values.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
            let StatedPeak { line, value, quantum } = *stated;
            // Values may be printed with fewer digits than their peak.
            let tolerance = quantum.max(SAME_PEAK * value.abs());
            let differs = (found - value.abs()).abs() > tolerance * (1.0 + SAME_STEP);
            differs.then(|| {
                format!("the peak of the values is {found} {unit}, and line {line} states {} {unit}", value.abs())
            })
        });
        let title = if self.title.is_empty() { file() } else { self.title };
        let Raw { format, start_time, values, .. } = self;
        let processing = Processing::default();
        let record = Record { title, format, unit, start_time, time_step, acceleration: values.into(), processing };
        let record = record.scaled(unit.factor(options.gravity));
        let Peak { acceleration, time } = record.peak();
        // Written so that infinity and NaN from an overflow are refused as well.
        let peak = acceleration.abs() / options.gravity;
        if !(peak <= LARGEST_PEAK && record.acceleration.iter().all(|a| a.is_finite())) {
            return Err(match unit_line {
                Some(line) => {
                    let found = format!("the peak is {peak:.3e} g at {time} s in the file's unit, {unit}");
                    source.line_error(line, format!("{found}; expected at most {LARGEST_PEAK} g"))
                }
                None => {
                    let found =
                        format!("the peak would be {peak:.3e} g at {time} s in {unit}, more than {LARGEST_PEAK} g");
                    source.needs_setting(None, found, Setting::Unit, unit.others())
                }
            });
        }
        Ok((record, doubt))
    }
}
