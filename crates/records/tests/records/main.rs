//! Accelerogram files: real ones of every format, synthetic ones, and random ones.

#[path = "../../../../tests/common/cases.rs"]
mod cases;
mod claims;
mod columns;
mod networks;
mod real;
mod refused;
mod round_trip;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;

use rocking_records::{ReadOptions, Record, RecordError, Unit, parse};

/// Options for a file without header.
pub fn unit_and_step(unit: Unit, time_step: f64) -> ReadOptions {
    ReadOptions { unit: Some(unit), time_step: Some(time_step), ..ReadOptions::default() }
}

/// Reads a text as a file.
fn parsed(text: &str, options: &ReadOptions) -> Result<Record, RecordError> {
    parse("made-up", text.as_bytes(), options)
}

/// Returns the message with which a text is refused.
pub fn refusal(text: &str, options: &ReadOptions) -> String {
    let message = parsed(text, options).expect_err(text).to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

/// Checks the message for a text read without options.
#[track_caller]
pub fn assert_refused(text: &str, expected: &str) {
    let message = refusal(text, &ReadOptions::default());
    assert_eq!(message, expected);
}

/// Returns the record of a valid text.
#[track_caller]
pub fn accelerations(text: &str, options: &ReadOptions) -> Record {
    parsed(text, options).unwrap_or_else(|error| panic!("{error}"))
}

/// The last sample at or before a time is found from any guess, also where times of samples round either way.
#[test]
fn a_sample_is_found_from_any_guess() {
    let record = Record { start_time: 0.3, ..accelerations("0 1 2 3 4 5", &unit_and_step(Unit::G, 0.1)) };
    let times: Vec<f64> = (0..=6).map(|i| 0.3 + f64::from(i) * 0.1).collect();
    for time in times.iter().flat_map(|time| [time.next_down(), *time, time.next_up(), time + 0.05]) {
        let found = times.iter().rposition(|sample| *sample <= time);
        assert_eq!(record.sample_at(time), found, "{time}");
        for guess in [0, 1, 2, 3, 4, 5, 6, 7, usize::MAX] {
            assert_eq!(record.sample_near(time, guess), found, "{time} from {guess}");
        }
    }
}
