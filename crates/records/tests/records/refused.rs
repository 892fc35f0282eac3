//! Made-up files that must be refused, and their messages.

use std::path::Path;

use rocking_records::{Format, ReadOptions, RecordError, Setting, Unit, parse, read};

use super::{accelerations, assert_refused, parsed, refusal, unit_and_step};

const HEADER: &str =
    "PEER STRONG MOTION DATABASE RECORD\nSOMEWHERE 1/1/01, STATION, 090\nACCELERATION TIME HISTORY IN UNITS OF G\n";

#[test]
fn wrong_counts_are_refused() {
    let values = "0.1 0.2 0.3\n";
    assert_refused(
        &format!("{HEADER}NPTS= 4, DT= .01 SEC\n{values}"),
        "made-up, line 4: found 3 values in the file, expected 4, the header's NPTS",
    );
    assert_refused(
        &format!("{HEADER}2 0.01 NPTS, DT\n{values}"),
        "made-up, line 4: found 3 values in the file, expected 2, the header's NPTS",
    );
    // No memory is reserved for the count of a header.
    assert_refused(
        &format!("{HEADER}NPTS= 9000000000000000000, DT= .01 SEC\n{values}"),
        "made-up, line 4: found 3 values in the file, expected 9000000000000000000, the header's NPTS",
    );
}

#[test]
fn truncated_numbers_are_refused() {
    let row = "  0.1234567E-01".repeat(20);
    assert!(parsed(&format!("{HEADER}NPTS= 21, DT= .01 SEC\n{row}  0.1234567E-01"), &ReadOptions::default()).is_ok());
    for cut in ["0.1234567E-0", "0.1234567", "0.12", "0"] {
        let message = refusal(&format!("{HEADER}NPTS= 21, DT= .01 SEC\n{row}  {cut}"), &ReadOptions::default());
        let expected = format!(
            "made-up, line 5: the file ends within the number {cut:?}, expected 7 decimals and an exponent as in all numbers before"
        );
        assert_eq!(message, expected);
    }
    assert_refused(
        &format!("{HEADER}NPTS= 21, DT= .01 SEC\n{row}  0.1234567E-"),
        "made-up, line 5: found \"0.1234567E-\", expected a finite number",
    );
}

#[test]
fn units_that_disagree_are_refused() {
    let file = |unit: &str| {
        format!("TITLE\nACCELERATION TIME HISTORY IN UNITS OF {unit}\nNPTS= 3, DT= .01 SEC\n0.1 0.2 0.3\n")
    };
    let none = ReadOptions::default();
    for (unit, expected) in [
        ("G", 0.3 * 9.81),
        ("G. FILTER POINTS: HP=0.2 Hz LP=15.0 Hz", 0.3 * 9.81),
        ("CM/SEC/SEC", 0.003),
        ("cm/s^2", 0.003),
        ("gal", 0.003),
        ("m/s²", 0.3),
        ("M/SEC**2", 0.3),
    ] {
        assert!((accelerations(&file(unit), &none).peak().acceleration - expected).abs() < 1e-15, "{unit}");
    }
    // "²" of a Latin-1 file is a single byte.
    let latin = file("m/s?").into_bytes().into_iter().map(|b| if b == b'?' { 0xB2 } else { b }).collect::<Vec<_>>();
    assert_eq!(parse("latin", &latin, &none).unwrap().unit, Unit::MetrePerSecondSquared);

    assert_refused(
        &file("FURLONGS"),
        "made-up, line 2: found \"ACCELERATION TIME HISTORY IN UNITS OF FURLONGS\", expected a unit among g, m/s2, cm/s2",
    );
    assert_refused(
        &file("CM/S"),
        "made-up, line 2: found a velocity (\"ACCELERATION TIME HISTORY IN UNITS OF CM/S\"), expected an acceleration time history",
    );
    assert_refused(
        "TITLE\nNPTS= 3, DT= .01 SEC\n0.1 0.2 0.3\n",
        "made-up: no unit in the file and none given; expected unit g, m/s2 or cm/s2",
    );
    assert_eq!(
        refusal(&file("G"), &ReadOptions { unit: Some(Unit::CentimetrePerSecondSquared), ..none.clone() }),
        "made-up, line 2: the file is in g but cm/s² was given; expected unit g"
    );
    assert_eq!(
        refusal("0.1\n98.1\n", &unit_and_step(Unit::G, 0.01)),
        "made-up: the peak would be 9.810e1 g at 0.01 s in g, more than 20 g; expected unit m/s2 or cm/s2"
    );
    // If the file states the unit, no option resolves the error.
    assert_refused(
        &file("G").replace("0.3", "30"),
        "made-up, line 2: the peak is 3.000e1 g at 0.02 s in the file's unit, g; expected at most 20 g",
    );
    let metric = ReadOptions { gravity: 10.0, ..none };
    assert_eq!(*accelerations(&file("G"), &metric).acceleration, [1.0, 2.0, 3.0]);
}

#[test]
fn velocities_and_displacements_are_refused() {
    for (found, text) in [
        ("a velocity", "VELOCITY TIME HISTORY IN UNITS OF CM/S"),
        ("a displacement", "DISPLACEMENT TIME SERIES IN UNITS OF CM"),
    ] {
        assert_refused(
            &format!("PEER NGA STRONG MOTION DATABASE RECORD\nTITLE\n{text}\nNPTS= 3, DT= .01 SEC\n0.1 0.2 0.3\n"),
            &format!("made-up, line 3: found {found} ({text:?}), expected an acceleration time history"),
        );
    }
    assert_refused(
        "3 VELOCITY\n*\n",
        "made-up, line 1: found an SMC file of the kind \"3 VELOCITY\", expected an acceleration time history",
    );
    assert_refused(
        "t [s],v [cm/s]\n0,0\n1,1\n",
        "made-up, line 1: found a column named \"v [cm/s]\", expected an acceleration time history",
    );
    assert_refused(
        "EVENT_NAME: X\nSAMPLING_INTERVAL_S: 0.01\nUNITS: cm/s\n0.1\n",
        "made-up, line 3: found a velocity in cm/s, expected an acceleration time history",
    );
    assert_refused(
        "Period [s]\tPSA [g]\n0.1\t0.2\n",
        "made-up, line 1: found a response spectrum (\"Period [s]\\tPSA [g]\"), expected an acceleration time history",
    );
}

#[test]
fn time_steps_that_disagree_are_refused() {
    let file = format!("{HEADER}NPTS= 3, DT= .0200 SEC,\n0.1 0.2 0.3\n");
    let given = |time_step| ReadOptions { time_step: Some(time_step), ..ReadOptions::default() };
    assert_eq!(accelerations(&file, &given(0.02)).time_step, 0.02);
    assert_eq!(
        refusal(&file, &given(0.01)),
        "made-up, line 4: the file has a time step of 0.02 s but 0.01 s was given; expected time step 0.02"
    );
    assert_eq!(refusal(&file, &given(-0.01)), "made-up: time step = -0.01; expected a finite number above 0");
    assert_refused(
        &format!("{HEADER}NPTS= 3\n0.1 0.2 0.3\n"),
        "made-up: no time step in the file and none given; expected time step in seconds",
    );
    assert_refused(
        &format!("{HEADER}NPTS= 3, DT= 0 SEC\n0.1 0.2 0.3\n"),
        "made-up, line 4: found \"time step 0 s\", expected a time step above 0 s",
    );
    assert_refused(
        &format!("{HEADER}NPTS= 3, DT= ten SEC\n0.1 0.2 0.3\n"),
        "made-up, line 4: found \"NPTS= 3, DT= ten SEC\", expected a time step in seconds as DT= 0.01 or 4000 0.01 NPTS, DT",
    );
    assert_refused(
        &format!("{HEADER}NPTS= many, DT= 0.01 SEC\n0.1 0.2 0.3\n"),
        "made-up, line 4: found \"NPTS= many, DT= 0.01 SEC\", expected the count of values as NPTS= 4000 or 4000 0.01 NPTS, DT",
    );
}

#[test]
fn other_files_are_refused() {
    assert_refused("", "made-up: the file is empty, expected an accelerogram");
    assert_refused(" \r\n\r\n", "made-up: the file is empty, expected an accelerogram");
    let binary: Vec<u8> = (0..100u8).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    let error = parse("binary", &binary, &ReadOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "binary: found binary data, expected an accelerogram as ASCII, Latin-1 or UTF-8 text"
    );
    let wide: Vec<u8> = [0xFEFF_u16].into_iter().chain("0.1\n".encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let error = parse("wide", &wide, &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("found UTF-16 text, expected an accelerogram"), "{error}");
    assert_refused(
        "Dear all,\n",
        &format!(
            "made-up, line 1: found \"Dear all,\", expected the header of a known format ({}) or a row of numbers in the first 64 lines",
            Format::NAMES
        ),
    );
    for word in ["NaN", "inf", "-Infinity", "1e999", "*******"] {
        let message = refusal(&format!("{HEADER}NPTS= 3, DT= .01\n0.1 {word} 0.3\n"), &ReadOptions::default());
        assert_eq!(message, format!("made-up, line 5: found {word:?}, expected a finite number"));
    }
    assert_eq!(refusal("0.1\n", &unit_and_step(Unit::G, 0.01)), "made-up: found 1 values, expected at least 2");
    let error = read(std::path::Path::new("no such file"), &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("no such file: cannot be read: "), "{error}");
}

/// Times and accelerations in turn, without a sampling rate, are no evenly spaced record even with a time step.
#[test]
fn pairs_in_smc_are_refused() {
    let smc = include_str!("../../../../examples/records/0111a.smc");
    let unknown = smc.replacen("0.2000000E+03", "0.1700000E+39", 1);
    let (header, _) = unknown.split_at(unknown.find("\n|\n").map_or(0, |_| 0) + unknown.rfind("\n|").unwrap() + 1);
    let (comment, _) = unknown[header.len()..].split_once('\n').unwrap();
    let pairs: String =
        (0..3000).map(|i| format!("{:10}{:10}", format!("{:.4}E0", f64::from(i) * 0.001), "1.0000E+0")).collect();
    let text = format!("{header}{comment}\n{pairs}\n").replacen("      6001", "      6000", 1);
    let message = refusal(&text, &unit_and_step(Unit::CentimetrePerSecondSquared, 0.005));
    assert!(message.contains("whose values are times and accelerations in turn, which is not supported"), "{message}");
}

/// A damaged SMC file.
#[test]
fn damaged_smc_files_are_refused() {
    let smc = include_str!("../../../../examples/records/0111a.smc");
    let none = ReadOptions::default();
    assert_eq!(
        refusal(smc.rsplit_once("-2.8745E-1").unwrap().0, &none),
        "made-up, line 14: found 6000 values in the file, expected 6001, the header's 17th integer"
    );
    assert!(refusal(smc.trim_end().strip_suffix("45E-1").unwrap(), &none).contains("ends within the number \"-2.87\""));
    assert!(
        refusal(&smc.replacen("0.2000000E+03", "0.2000000E+09", 1), &none).contains("expected a sampling rate above 0")
    );
    assert!(refusal(&smc.replacen("|ref", " ref", 1), &none).contains("expected one of 8 comment lines"));
    // The caller must give an unknown sampling rate.
    let unknown = smc.replacen("0.2000000E+03", "0.1700000E+39", 1);
    assert!(matches!(parsed(&unknown, &none), Err(RecordError::NeedsSetting { setting: Setting::TimeStep, .. })));
    assert_eq!(accelerations(&unknown, &unit_and_step(Unit::CentimetrePerSecondSquared, 0.005)).time_step, 0.005);
}

#[test]
fn records_are_linear_between_samples() {
    let record = accelerations("t [s],a [m/s2]\n2.0,1\n2.5,3\n3.0,-4\n", &ReadOptions::default());
    for (t, expected) in [
        (1.999, 0.0),
        (2.0, 1.0),
        (2.25, 2.0),
        (2.5, 3.0),
        (2.875, -2.25),
        (3.0, -4.0),
        (3.001, 0.0),
        (f64::NAN, 0.0),
        (f64::INFINITY, 0.0),
    ] {
        assert_eq!(record.at(t), expected, "at {t} s");
    }
    assert_eq!((record.duration(), record.peak().acceleration, record.peak().time), (1.0, -4.0, 3.0));
    // The end of a long record is not lost to round-off.
    let text: String = (0..1000).map(|i| format!("{}\n", 0.001 * f64::from(i))).collect();
    let long = accelerations(&text, &unit_and_step(Unit::MetrePerSecondSquared, 0.005));
    assert_eq!(long.at(long.start_time + long.duration()), 0.999);
    assert_eq!(*record.scaled(-0.5).acceleration, [-0.5, -1.5, 2.0]);
}

/// Importers may pass the path of a record as a URL.
#[test]
fn a_url_of_this_machine_is_a_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a b%é.txt");
    std::fs::write(&path, "0 0.1\n0.01 0.2\n0.02 0.3\n").unwrap();
    let options = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    let samples = |path: &Path| read(path, &options).unwrap().acceleration;
    let expected = samples(&path);
    let slash = if cfg!(windows) { "/" } else { "" };
    let encoded = format!("{slash}{}/a%20b%25%C3%A9.txt", folder.path().display());
    for url in [format!("file://{encoded}"), format!("file://localhost{encoded}"), format!("file:{encoded}")] {
        assert_eq!(samples(Path::new(&url)), expected, "{url}");
    }
    // An escape that is none stays as it is, as does a name without a slash after the scheme.
    for (name, found) in [
        (format!("file://{encoded}%2"), "cannot be read"),
        ("file:a.txt".into(), "cannot be read"),
        (
            format!("file://elsewhere{encoded}"),
            "cannot be read: a URL of another machine; expected file:///, or a path",
        ),
    ] {
        let message = read(Path::new(&name), &options).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{name}: ")) && message.contains(found), "{message}");
    }
}
