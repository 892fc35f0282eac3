//! `rocking record`.

use rocking_records::{Format, ReadOptions, Record, read};
use rocking_studies::intensity::Measure;

use crate::program::{RECORD, refusal, refused, rocking, stdout, text};

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
    // The table tells its origin.
    let comments: Vec<&str> = to_stdout.lines().take_while(|line| line.starts_with("# ")).collect();
    let [title, origin] = comments[..] else { panic!("{comments:?}") };
    assert_eq!(title[2..], original.title.split_whitespace().collect::<Vec<_>>().join(" "));
    assert_eq!(origin, "# from np01002p_4225a_a.smc: SMC, in cm/s²");
    let changed = stdout(folder.path(), &["record", RECORD, "--baseline", "--csv", "-"]);
    assert_eq!(changed.lines().nth(1), Some("# from np01002p_4225a_a.smc: SMC, in cm/s²; baseline removed"));
    // Times are k dt, as everywhere.
    let row = to_stdout.lines().nth(1002).unwrap();
    assert_eq!(row.split(',').next().unwrap().parse(), Ok(999.0 * original.time_step));
}

/// Small files of every format become the same table, whose comments name the format; the table holds the same bits.
#[test]
fn a_table_is_made_of_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lab/fuzz/seeds");
    let mut formats = Vec::new();
    for entry in std::fs::read_dir(seeds).unwrap() {
        let path = entry.unwrap().path();
        let record = ["record", path.to_str().unwrap(), "--csv", "table.csv"];
        let name = path.file_name().unwrap().to_str().unwrap();
        let more: &[&str] = match name {
            "cwb.dat" => &["--channel", "N"],
            "jma.csv" => &["--channel", "EW"],
            "knet.csv" => &["--channel", "E-W"],
            "nsmn.txt" => &["--channel", "N-S"],
            "unam.191" => &["--channel", "N00E"],
            "block.txt" | "time.txt" | "npts.txt" => &["--unit", "g", "--dt", "0.01"],
            _ => &[],
        };
        stdout(folder.path(), &[&record[..], more].concat());
        let options = ReadOptions {
            channel: more.contains(&"--channel").then(|| more[1].parse().unwrap()),
            unit: more.contains(&"--unit").then_some(rocking_records::Unit::G),
            time_step: more.contains(&"--dt").then_some(0.01),
            ..ReadOptions::default()
        };
        let original = read(&path, &options).unwrap();
        let table = read(&folder.path().join("table.csv"), &ReadOptions::default()).unwrap();
        assert_eq!(table.format, Format::Columns, "{name}");
        assert_eq!((&table.acceleration, table.time_step), (&original.acceleration, original.time_step), "{name}");
        assert_eq!(table.title, original.title.split_whitespace().collect::<Vec<_>>().join(" "), "{name}");
        let origin = format!("# from {name}: {}, in {}", original.format, original.unit);
        let lines = std::fs::read_to_string(folder.path().join("table.csv")).unwrap();
        assert_eq!(lines.lines().nth(1), Some(origin.as_str()));
        formats.push(original.format.to_string());
    }
    formats.sort();
    formats.dedup();
    // A layout needs the description of its caller.
    assert_eq!(formats.len() + 1, Format::NAMES.split(", ").count(), "{formats:?}");
}

/// Lines of fixed width below a header of any text; `--scale` is short for `--value-scale` here.
#[test]
fn a_layout_reads_lines_of_fixed_width() {
    let folder = tempfile::tempdir().unwrap();
    let values = [0.0, -1234.5, 2394.8, 100.0, -0.5];
    let lines: String =
        values.chunks(3).map(|row| row.iter().map(|a| format!("{a:8.1}")).collect::<String>() + "\n").collect();
    std::fs::write(folder.path().join("a.dat"), format!("Somewhere 2001\n{}{lines}", "1 2 3\n".repeat(23))).unwrap();
    for scale in ["--scale", "--value-scale"] {
        let layout =
            ["record", "a.dat", "--layout", "3F8.1", "--skip", "24", scale, "0.001", "--unit", "m/s2", "--dt", "0.01"];
        let printed = stdout(folder.path(), &[&layout[..], &["--csv", "r.csv"]].concat());
        assert!(printed.contains("title         Somewhere 2001\nformat        fixed width, in m/s²\n"), "{printed}");
        let record = read(&folder.path().join("r.csv"), &ReadOptions::default()).unwrap();
        assert!(record.acceleration.iter().zip(values).all(|(a, b)| (a - 0.001 * b).abs() < 1e-12), "{record:?}");
    }
    let message = refusal(folder.path(), &["record", RECORD, "--skip", "2"]);
    assert_eq!(message, "--skip has no effect without a fixed width file");
    let message = refusal(folder.path(), &["record", RECORD, "--value-scale", "2"]);
    assert_eq!(message, "--value-scale has no effect without a columns or fixed width file");
    let study = "[study]\ndesign = \"grid\"\n[[records]]\nhorizontal = \"a.dat\"\nlayout = \"3F8.1\"\nskip = 24\nvalue_scale = 0.001\n\
                 unit = \"m/s2\"\ndt = 0.01\n[parameters]\np = 2\n";
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
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

/// Numbers of examples/records/README.md and of the header; the velocity from a midpoint rule in small steps.
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
    assert_eq!(
        message,
        "--channel has no effect without a file of several channels (COSMOS, CSMIP, K-NET, GeoNet, NSMN, UNAM, RENADIC, BHRC, JMA, CWB)"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Files that are no records do not hide the others; the exit status and the last line say that some failed.
#[test]
fn every_file_has_its_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.txt"), "no record\n").unwrap();
    std::fs::write(folder.path().join("c.csv"), "t [s],a [m/s2]\n0,0\n0.1,2\n0.2,0\n").unwrap();
    let run = |more: &[&str]| rocking(folder.path(), &[&["record", "a.txt", "c.csv", "none"], more].concat());
    let found = run(&[]);
    assert_eq!(found.status.code(), Some(1));
    let printed = text(&found.stdout);
    assert!(printed.starts_with("file          c.csv\n") && printed.matches("\nPGA ").count() == 1, "{printed}");
    let errors = text(&found.stderr);
    let lines: Vec<&str> = errors.lines().collect();
    assert_eq!(lines.len(), 3, "{errors}");
    assert!(
        lines[0].starts_with("rocking: a.txt, line 1: found \"no record\"") && lines[1].starts_with("rocking: none: ")
    );
    assert_eq!(lines[2], "rocking: 2 of 3 records cannot be read");
    let found = run(&["--json"]);
    assert_eq!(found.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_str(&text(&found.stdout)).unwrap();
    assert_eq!((json["records"].as_array().unwrap().len(), json["records"][0]["PGA"].as_f64()), (1, Some(2.0)));
    let unreadable: Vec<&str> =
        json["unreadable"].as_array().unwrap().iter().filter_map(|line| line.as_str()).collect();
    assert!(unreadable.len() == 2 && unreadable[0].starts_with("a.txt, line 1: "), "{unreadable:?}");
}

/// Counts taken for m/s² drift by kilometres.
#[test]
fn implausible_peaks_and_displacements_draw_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let warned = |name: &str, peak: f64| {
        let rows: String = (0..200).map(|i| format!("{},{peak}\n", 0.01 * f64::from(i))).collect();
        std::fs::write(folder.path().join(name), format!("t [s],a [m/s2]\n{rows}")).unwrap();
        text(&rocking(folder.path(), &["record", name]).stderr)
    };
    // a t²/2 over 1.99 s.
    assert_eq!(warned("still.csv", 0.5), "");
    let drift = warned("drift.csv", 0.6);
    assert!(drift.starts_with("rocking: warning: drift.csv: the PGD is 1.18803 m; expected at most 1 m"), "{drift}");
    assert!(warned("counts.csv", 60.0).contains("counts.csv: the peak is 6.000e1 m/s², more than in any earthquake"));
}

/// The picture has acceleration, velocity and spectrum, of one record.
#[test]
fn a_record_has_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, &["record", RECORD, "--plot", "record.svg"]);
    let svg = std::fs::read_to_string(folder.join("record.svg")).unwrap();
    for words in
        ["np01002p_4225a_a.smc: ", "acceleration (m/s²)", "velocity (m/s)", "Sa, 5 % damping (m/s²)", "period (s)"]
    {
        assert!(svg.contains(words), "{words}");
    }
    refused(folder, &["record", RECORD, RECORD, "--plot", "x.svg"], &["--plot with 2 records; expected one"]);
}
