//! Accelerogram files: real ones of every format, made-up ones that must be refused, and random ones.

#[path = "common/cases.rs"]
mod cases;
#[path = "records/columns.rs"]
mod columns;
#[path = "records/real.rs"]
mod real;
#[path = "records/refused.rs"]
mod refused;
#[path = "records/round_trip.rs"]
mod round_trip;
#[path = "common/skipped.rs"]
mod skipped;

use rocking_block::records::{ReadOptions, Record, RecordError, Unit, parse};

/// Options of a user who says what a file without header does not say.
pub fn said(unit: Unit, time_step: f64) -> ReadOptions {
    ReadOptions { unit: Some(unit), time_step: Some(time_step), ..ReadOptions::default() }
}

/// Reads a text as if it were a file.
pub fn parsed(text: &str, options: &ReadOptions) -> Result<Record, RecordError> {
    parse("made-up", text.as_bytes(), options)
}

/// The words with which a text is refused.
pub fn refusal(text: &str, options: &ReadOptions) -> String {
    let message = parsed(text, options).expect_err(text).to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

/// What is refused whatever the user says.
#[track_caller]
pub fn assert_refused(text: &str, expected: &str) {
    let message = refusal(text, &ReadOptions::default());
    assert_eq!(message, expected);
}

/// The record of a text that must be read.
#[track_caller]
pub fn accelerations(text: &str, options: &ReadOptions) -> Record {
    parsed(text, options).unwrap_or_else(|error| panic!("{error}"))
}
