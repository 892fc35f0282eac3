//! `rocking record`.

use rocking_records::{Format, ReadOptions, Record, read};
use rocking_studies::intensity::Measure;

use crate::program::{RECORD, refusal, stdout};

/// The table of a record holds the same bits, including the time step.
#[test]
fn a_table_holds_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let original = read(RECORD.as_ref(), &ReadOptions::default()).unwrap();
    let to_stdout = stdout(folder.path(), &["record", RECORD, "--csv", "-"]);
    stdout(folder.path(), &["record", RECORD, "--csv", "r.csv"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("r.csv")).unwrap(), to_stdout);
    let again = read(&folder.path().join("r.csv"), &ReadOptions::default()).unwrap();
    let Record { format, time_step, start_time, acceleration, .. } = again;
    assert_eq!((format, time_step, start_time), (Format::Columns, original.time_step, original.start_time));
    assert!(acceleration.len() == 7183 && acceleration == original.acceleration);
    // Times are k dt, as everywhere.
    let row = to_stdout.lines().nth(1000).unwrap();
    assert_eq!(row.split(',').next().unwrap().parse(), Ok(999.0 * original.time_step));
}

/// The summary has every measure, at the requested periods; JSON has full precision.
#[test]
fn measures_are_printed_as_text_and_json() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["record", RECORD, "--periods", "0.5,2"];
    let words = stdout(folder.path(), &arguments);
    let json = stdout(folder.path(), &[&arguments[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let record = read(RECORD.as_ref(), &ReadOptions::default()).unwrap();
    for measure in Measure::of_record(&[0.5, 2.0]) {
        let exact = measure.of(&record, 9.81).unwrap();
        assert_eq!(json["records"][0][measure.to_string()].as_f64(), Some(exact), "{measure}");
        let line = words.lines().find_map(|line| line.strip_prefix(&format!("{measure} "))).unwrap();
        let printed: f64 = line.split_whitespace().next().unwrap().parse().unwrap();
        assert!((printed / exact - 1.0).abs() < 1e-5, "{measure}: {line}");
    }
    let message = refusal(folder.path(), &["record", RECORD, "--periods", "0.5,0"]);
    assert!(message.contains("--periods") && message.contains("0.001 to 1000 s"), "{message}");
}

/// Numbers of records/README.md and of the header; the velocity from a midpoint rule in small steps.
#[test]
fn the_summary_agrees_with_the_header() {
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(folder.path(), &["record", RECORD]);
    let word = |name: &str| {
        let line = printed.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}: {printed}"));
        line[name.len()..].trim().to_string()
    };
    assert!(word("title").contains("Loma Prieta") && word("title").contains("component= 133"), "{printed}");
    assert_eq!(word("format"), "SMC, in cm/s²");
    assert_eq!(word("samples"), "7183, every 0.005 s from 0 s");
    assert_eq!(word("duration"), "35.91 s");
    assert_eq!(word("PGA"), "2.2252 m/s² = 0.227 g at 7.55 s");
    let record = read(RECORD.as_ref(), &ReadOptions::default()).unwrap();
    const PARTS: u32 = 100;
    let (mut velocity, mut peak, h) = (0.0, 0.0_f64, record.time_step / f64::from(PARTS));
    for pair in record.acceleration.windows(2) {
        for part in 0..PARTS {
            velocity += h * (pair[0] + (f64::from(part) + 0.5) / f64::from(PARTS) * (pair[1] - pair[0]));
            peak = peak.max(velocity.abs());
        }
    }
    let pgv: f64 = word("PGV").split(' ').next().unwrap().parse().unwrap();
    assert!((pgv / peak - 1.0).abs() < 1e-5, "{pgv}, expected {peak}");
}

#[test]
fn several_records_have_summaries_but_no_table() {
    let folder = tempfile::tempdir().unwrap();
    let other = RECORD.replace("np01002p_4225a_a", "0111a");
    let printed = stdout(folder.path(), &["record", RECORD, &other, "--g", "9.80665"]);
    assert_eq!(printed.matches("\nPGA ").count(), 2, "{printed}");
    let message = refusal(folder.path(), &["record", RECORD, &other, "--csv", "r.csv"]);
    assert_eq!(message, "--csv with 2 records; expected one");
    let message = refusal(folder.path(), &["record", RECORD, "--channel", "2"]);
    assert_eq!(message, "--channel has no effect without a COSMOS or CSMIP file");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
