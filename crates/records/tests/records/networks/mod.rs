//! Formats of national networks: short made-up files in their layouts, intact, damaged and cut off.

use rocking_records::{Choice, Format, ReadOptions, Record, parse_with_doubt};

mod california;
mod chile_and_iran;
mod china_and_europe;
mod japan;
mod others;

use super::parsed;
pub use california::*;
pub use chile_and_iran::*;
pub use china_and_europe::*;
pub use japan::*;
pub use others::*;

/// Count of values of most files below.
const COUNT: usize = 40;

/// A decaying oscillation, with its peak at the third value.
pub fn wave(count: usize, peak: f64) -> Vec<f64> {
    let shape = [0.0, 0.5, 1.0, 0.25, -0.5, -0.75];
    (0..count).map(|i| peak * shape[i % 6] / (1.0 + (i / 6) as f64)).collect()
}

/// Prints values in columns of a width, as Fortran does.
pub fn block(values: &[f64], columns: usize, width: usize, decimals: usize) -> String {
    let lines = values
        .chunks(columns)
        .map(|row| row.iter().map(|value| format!("{value:width$.decimals$}")).collect::<String>());
    lines.map(|line| line + "\n").collect()
}

/// Options that choose a channel.
pub fn channel(text: &str) -> ReadOptions {
    ReadOptions { channel: Some(text.parse().unwrap()), ..ReadOptions::default() }
}

fn doubt(text: &str, options: &ReadOptions) -> Option<String> {
    parse_with_doubt("made-up", text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}")).1
}

#[track_caller]
fn assert_values(record: &Record, expected: &[f64], tolerance: f64) {
    assert_eq!(record.acceleration.len(), expected.len());
    for (index, (found, expected)) in record.acceleration.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= tolerance, "value {index}: {found}, expected {expected} m/s²");
    }
}

/// All files of this module, each with a channel.
pub fn all() -> [(Format, String, &'static str); 16] {
    [
        (Format::Knet, knet("E-W"), "1"),
        (Format::Knet, knet_csv(), "E-W"),
        (Format::Csmip, csmip_corrected(), "Up"),
        (Format::Csmip, csmip_uncorrected(&wave(COUNT, 0.0791)), "1"),
        (Format::Renadic, renadic(), "Z"),
        (Format::Bhrc, bhrc(), "V"),
        (Format::Usc, usc(), ""),
        (Format::Geonet, geonet(0), "Up"),
        (Format::Geonet, geonet(25), "Up"),
        (Format::Nsmn, nsmn(), "U-D"),
        (Format::Unam, unam(COUNT), "N90E"),
        (Format::Jma, jma(), "UD"),
        (Format::Cwb, cwb(), "E"),
        (Format::Esm, afad(), ""),
        (Format::Csmnc, csmnc(), ""),
        (Format::Esd, esd(), ""),
    ]
}

/// Options that choose a channel, if the file has several.
pub fn options_of(name: &str) -> ReadOptions {
    ReadOptions { channel: (!name.is_empty()).then(|| name.parse::<Choice>().unwrap()), ..ReadOptions::default() }
}

/// The content alone leads to the format, also when a reader of another format would accept the file.
#[test]
fn each_file_has_one_format() {
    for (format, text, name) in all() {
        assert_eq!(parsed(&text, &options_of(name)).unwrap().format, format);
        // A table of times and accelerations is not read from a header line of its own.
        let commented: String = text.lines().map(|line| format!("// {line}\n")).collect();
        assert!(parsed(&commented, &options_of(name)).is_err(), "{format}");
    }
}
