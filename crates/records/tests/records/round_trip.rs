//! Random records, written as each variant of PEER file and read back; random bytes, which must not panic.

use std::fmt::Write;

use proptest::prelude::*;
use rocking_records::{Choice, Format, ReadOptions, Unit, parse};

use super::networks::{all, options_of};
use super::unit_and_step;

/// Layout of a PEER file.
#[derive(Debug, Clone, Copy)]
struct Variant {
    header: fn(usize, f64) -> String,
    /// Number of values per line.
    per_line: usize,
    line_end: &'static str,
    /// Text after the last value.
    last: &'static str,
}

const VARIANTS: [Variant; 7] = [
    Variant {
        header: |n, dt| {
            format!(
                "PEER STRONG MOTION DATABASE RECORD. PROCESSING BY PACIFIC ENGINEERING.\nSOMEWHERE\nACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.2 Hz LP=0.0 Hz\nNPTS={n:6}, DT= {dt:.5} SEC\n"
            )
        },
        per_line: 5,
        line_end: "\n",
        last: "\n",
    },
    Variant {
        header: |n, dt| {
            format!(
                "PEER NGA STRONG MOTION DATABASE RECORD\nSOMEWHERE\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS={n:7}, DT=   {} SEC,                 \n",
                format!("{dt:.5}").trim_start_matches('0')
            )
        },
        per_line: 5,
        line_end: "\n",
        last: "               \n",
    },
    Variant {
        header: |n, dt| format!("A\nB\nACCELERATION TIME HISTORY IN UNITS OF G\nNPTS={n:7}, dt=  {dt:.5}\n"),
        per_line: 5,
        line_end: "\n",
        last: "\n",
    },
    Variant {
        header: |n, dt| {
            format!(
                "PEER NGA STRONG MOTION DATABASE RECORD\nSOMEWHERE\nACCELERATION TIME HISTORY IN UNITS OF G\n{n}    {dt:.5}    NPTS, DT\n"
            )
        },
        per_line: 5,
        line_end: "\r\r\n",
        last: "\r\r\n",
    },
    Variant {
        header: |n, dt| format!("A\nB\nACCELERATION TIME HISTORY IN UNITS OF G\nNPTS={n:7}, DT= {dt:.5} SEC\n"),
        per_line: 5,
        line_end: "\r\n",
        last: "\r\n",
    },
    Variant {
        header: |n, dt| {
            format!(
                "El Centro\nmany points\n8F10.5, i.e., 8 points across in\na row\nThe units are (g)\n*** Begin data ***\nNPTS= {n}, DT= {dt:.5} SEC\n"
            )
        },
        per_line: 8,
        line_end: "\n",
        last: "\n*** End Data ***\n\n\n",
    },
    Variant { header: |_, _| String::new(), per_line: 5, line_end: "\r\n", last: "" },
];

fn written(variant: &Variant, values: &[f64], dt: f64) -> String {
    let mut text = (variant.header)(values.len(), dt).replace('\n', variant.line_end);
    for (index, value) in values.iter().enumerate() {
        if index > 0 && index % variant.per_line == 0 {
            text.push_str(variant.line_end);
        }
        write!(text, "  {}", fortran(*value)).unwrap();
    }
    text + variant.last
}

/// Formats a number with an exponent of two digits, as Fortran and C do.
fn fortran(value: f64) -> String {
    let (mantissa, exponent) =
        format!("{value:.7e}").split_once('e').map(|(m, e)| (m.to_owned(), e.parse::<i32>().unwrap())).unwrap();
    let (sign, exponent) = if exponent < 0 { ('-', -exponent) } else { ('+', exponent) };
    format!("{mantissa:>10}E{sign}{exponent:02}")
}

proptest! {
    #![proptest_config(crate::cases::cases(256))]

    #[test]
    fn peer_is_read_as_written(
        values in prop::collection::vec(-15.0..15.0_f64, 3..60),
        steps in 1..2000_u32,
        variant in prop::sample::select(&VARIANTS[..]),
    ) {
        let dt = f64::from(steps) * 1e-4;
        let text = written(&variant, &values, dt);
        let options = if text.contains("NPTS") { ReadOptions::default() } else { unit_and_step(Unit::G, dt) };
        let record = parse("written", text.as_bytes(), &options).map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!(record.format, Format::Peer);
        prop_assert!((record.time_step - dt).abs() <= 1e-15);
        prop_assert_eq!(record.acceleration.len(), values.len());
        for (read, value) in record.acceleration.iter().zip(&values) {
            // Written with eight digits.
            prop_assert!((read / 9.81 - value).abs() <= 0.51e-7 * value.abs().max(1e-300), "{} for {}", read / 9.81, value);
        }
    }

    /// A file with a count, cut after its first value, is refused or read in full.
    #[test]
    fn a_cut_file_is_never_misread(
        values in prop::collection::vec(-15.0..15.0_f64, 30..60),
        cut in 0.0..1.0_f64,
        variant in prop::sample::select(&VARIANTS[..6]),
    ) {
        let text = written(&variant, &values, 0.01);
        let whole = parse("whole", text.as_bytes(), &ReadOptions::default()).unwrap();
        let header = (variant.header)(values.len(), 0.01).len();
        let end = header + 40 + ((text.len() - header - 40) as f64 * cut) as usize;
        if let Ok(record) = parse("cut", &text.as_bytes()[..end], &ReadOptions::default()) {
            prop_assert_eq!(record.acceleration, whole.acceleration);
        }
    }

    /// A file of a national network, cut off anywhere, is refused or read in full; JMA states no count.
    #[test]
    fn a_cut_file_of_a_network_is_never_misread(which in 0..16_usize, cut in 0.0..1.0_f64) {
        let (format, text, channel) = all().into_iter().nth(which).unwrap();
        let options = options_of(channel);
        let whole = parse("whole", text.as_bytes(), &options).unwrap();
        let end = (text.len() as f64 * cut) as usize;
        if let Ok(record) = parse("cut", &text.as_bytes()[..end], &options) {
            if format == Format::Jma {
                // The end of a number shows only behind many numbers.
                let sure = if record.acceleration.len() > 17 { record.acceleration.len() } else { record.acceleration.len() - 1 };
                prop_assert!(whole.acceleration.starts_with(&record.acceleration[..sure]));
            } else {
                prop_assert_eq!(record.acceleration, whole.acceleration);
            }
        }
    }

    /// A file of a national network with bytes overwritten is refused in one line, or read with finite values.
    #[test]
    fn a_damaged_file_of_a_network_does_not_panic(
        which in 0..16_usize,
        places in prop::collection::vec((0.0..1.0_f64, prop::sample::select(&b"\n 0179.-+,:/=#ENx\xE9"[..])), 1..12),
        read_as in prop::sample::select(formats()),
    ) {
        let (_, text, channel) = all().into_iter().nth(which).unwrap();
        let mut bytes = text.into_bytes();
        for (place, byte) in places {
            let place = (bytes.len() as f64 * place) as usize;
            bytes[place] = byte;
        }
        for format in [None, read_as] {
            match parse("damaged", &bytes, &ReadOptions { format, ..options_of(channel) }) {
                Ok(record) => prop_assert!(record.is_valid()),
                Err(error) => prop_assert!(!error.to_string().contains('\n'), "{}", error),
            }
        }
    }

    /// Times with as many digits as they need, as Python, pandas and JavaScript write them, have the step with which they were made, to the
    /// round-off of the last time.
    #[test]
    fn steps_of_times_in_shortest_form_are_exact(step in 1e-4..1.0_f64, rows in 3..3000_u32, scientific in any::<bool>()) {
        let row = |i: u32| {
            let time = f64::from(i) * step;
            if scientific { format!("{time:?} 0.1\n") } else { format!("{time} 0.1\n") }
        };
        let text: String = (0..rows).map(row).collect();
        let found = parse("times", text.as_bytes(), &ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() }).unwrap();
        prop_assert!((found.time_step - step).abs() <= 4.0 * f64::EPSILON * step, "{} for {step}", found.time_step);
    }

    /// Random layouts, of random lines of numbers.
    #[test]
    fn random_layouts_do_not_panic(
        layout in "[0-9]{0,3}[XPx,(]{0,2}[0-9]{0,3}[FEDGI(]{1,2}[0-9.]{0,4}[E)]{0,2}",
        text in "[0-9 .+DEd\n-]{0,200}",
        skip in prop::option::of(0..4_usize),
    ) {
        let layout = layout.parse().ok();
        let options = ReadOptions { layout, skip, ..unit_and_step(Unit::G, 0.01) };
        if let Ok(record) = parse("layout", text.as_bytes(), &options) {
            prop_assert!(record.is_valid());
        }
    }

    #[test]
    fn random_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = parse("bytes", &bytes, &unit_and_step(Unit::G, 0.01));
    }

    /// Random words of the formats pass more checks than random bytes.
    #[test]
    fn random_words_do_not_panic(
        words in prop::collection::vec(prop::sample::select(&WORDS[..]), 0..80),
        format in prop::sample::select(formats()),
        channel in prop::sample::select(&[None, Some("0"), Some("1"), Some("18446744073709551615"), Some("Up")][..]),
    ) {
        let channel = channel.map(|channel| channel.parse::<Choice>().unwrap());
        let options = ReadOptions { format, channel, ..ReadOptions::default() };
        if let Err(error) = parse("words", words.concat().as_bytes(), &options) {
            prop_assert!(!error.to_string().contains('\n'), "{}", error);
        }
    }

    /// The public SMC file with bytes overwritten.
    #[test]
    fn a_damaged_smc_does_not_panic(places in prop::collection::vec((0..5000_usize, any::<u8>()), 1..10)) {
        let mut bytes = include_bytes!("../../../../examples/records/0111a.smc").to_vec();
        for (place, byte) in places {
            bytes[place] = byte;
        }
        let _ = parse("damaged", &bytes, &ReadOptions::default());
    }
}

/// All formats, and detection.
fn formats() -> Vec<Option<Format>> {
    std::iter::once(None).chain(Format::NAMES.split(", ").map(|name| Some(name.parse().unwrap()))).collect()
}

const WORDS: [&str; 62] = [
    "\n",
    "\n",
    "\n",
    "\n",
    "\r",
    " ",
    " ",
    "  ",
    "\t",
    ",",
    ";",
    "\"",
    "=",
    "é",
    "²",
    "0.1",
    "-1.5E-02",
    ".5D+01",
    "1e300",
    "7",
    "0",
    "-999",
    "NPTS=",
    "DT=",
    "NPTS, DT",
    "UNITS OF G",
    "UNITS: CM/SEC/SEC)",
    "2 CORRECTED ACCELEROGRAM",
    "|",
    "*** End",
    "/& END",
    "(Format v01.20 with 13 text lines) acceleration",
    "100 Real-header values follow on  17 lines, Format= (6F13.6)",
    "7  acceleration pts, units=cm/sec2(04),Format=(8F10.5)",
    "7 POINTS OF ACCEL DATA EQUALLY SPACED AT .02 SEC. (UNITS: CM/SEC/SEC)",
    "SAMPLING_INTERVAL_S: 0.01",
    "NDATA: 3",
    "UNITS: cm/s^2",
    "t [s],a [g]",
    "t [s]  a [g]",
    "Period",
    "VELOCITY TIME HISTORY",
    "18446744073709551615",
    "#",
    "UNCORRECTED ACCELEROGRAM DATA",
    "NO. OF POINTS = 3",
    "UNITS ARE SEC AND G/10",
    "Scale Factor      3920(gal)/6182761",
    "Sampling Freq(Hz) 100Hz",
    "Duration Time(s)  0.03",
    "Memo.",
    "#Time,RelativeTime(s),N-S(gal)",
    "#SampleRate(Hz): 100",
    "#RecordLength(sec): 0.03",
    "#DataSequence: Time U(+)",
    "SITE CODE=",
    "SAMPLING RATE= 100Hz",
    "RAW PGA VALUES (gal) : (N-S) 1",
    "ARCHIVO ESTANDAR DE ACELERACION",
    "/3/3/3",
    "* VOL1DS FILE",
    "Component Up",
];
