//! Records with missing information: the error names the option, or the key of a study file, that supplies it.

use std::path::Path;

use crate::program::{Table, refusal, stdout};
use crate::skipped::skip;

/// Three accelerations; the second is the peak.
const VALUES: &str = "0.1\n-0.3\n0.2\n";
/// Times and two components.
const TABLE: &str = "t,north,east [m/s2]\n0,0.1,1\n0.5,-0.3,3\n1,0.2,2\n";

/// An error, and the option with its value that resolves it.
type Resolution = (&'static str, &'static [&'static str]);

/// CSMIP file of two channels, in cm/s².
fn channels() -> String {
    let channel = |number: usize, peak: f64| {
        let header: String = (0..8).map(|i| format!("HEADER {i} OF CHAN {number}\n")).collect();
        let values: String = [1.0, -peak, 2.0].iter().map(|a| format!("{a:10.3}")).collect();
        format!(
            "{header}       3 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)\n{values}\n\
             /&  ----------  END OF DATA FOR CHANNEL  {number}  ----------\n"
        )
    };
    channel(1, 30.0) + &channel(2, 40.0)
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("a.txt", VALUES), ("table.csv", TABLE), ("two.V2", &channels())] {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    folder
}

/// Returns the peak horizontal and vertical accelerations of a run (m/s²).
fn peaks(folder: &Path, arguments: &[&str]) -> [f64; 2] {
    let run = ["simulate", "--duration", "1", "--step", "0.01", "--csv", "run.csv"];
    stdout(folder, &[&run, arguments].concat());
    let table = Table::read(&folder.join("run.csv"));
    ["a_gx", "a_gz"].map(|name| table.column(name).into_iter().fold(0.0, |peak: f64, a| peak.max(a.abs())))
}

#[track_caller]
fn near(found: [f64; 2], expected: [f64; 2]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}, expected {expected:?}");
}

/// Each error names the option that resolves it, until the record is read.
#[test]
fn errors_name_the_option_that_resolves_them() {
    let folder = folder();
    let path = folder.path();
    let cases: [(&str, &[Resolution], f64); 3] = [
        (
            "a.txt",
            &[
                ("a.txt: no time step in the file and none given; expected --dt in seconds", &["--dt", "0.5"]),
                ("a.txt: no unit in the file and none given; expected --unit g, m/s2 or cm/s2", &["--unit", "g"]),
            ],
            0.3 * 9.81,
        ),
        (
            "table.csv",
            &[
                (
                    "table.csv, line 1: found 3 columns named t, north, east [m/s2], but no clear acceleration column; \
                     expected --acceleration-column 1 to 3 or a name",
                    &["--acceleration-column", "NORTH"],
                ),
                (
                    "table.csv: no unit in the file and none given; expected --unit g, m/s2 or cm/s2",
                    &["--unit", "m/s2"],
                ),
            ],
            0.3,
        ),
        (
            "two.V2",
            &[(
                "two.V2: found 2 channels (1: HEADER 0 OF CHAN 1, 2: HEADER 0 OF CHAN 2); expected --channel 1 to 2 or a name",
                &["--channel", "2"],
            )],
            0.4,
        ),
    ];
    for (file, errors, peak) in cases {
        for vertical in [false, true] {
            // Vertical files have their own options.
            let own =
                |option: &str| if vertical { option.replacen("--", "--vertical-", 1) } else { option.to_string() };
            let mut arguments = vec![if vertical { "--vertical" } else { "--record" }.to_string(), file.to_string()];
            for (message, option) in errors {
                let given: Vec<&str> = arguments.iter().map(String::as_str).collect();
                let message = message.replace("expected --", &format!("expected {}", own("--")));
                assert_eq!(refusal(path, &[&["simulate"], &given[..]].concat()), message);
                arguments.extend([own(option[0]), option[1].to_string()]);
            }
            let given: Vec<&str> = arguments.iter().map(String::as_str).collect();
            near(peaks(path, &given), if vertical { [0.0, peak] } else { [peak, 0.0] });
        }
    }
}

/// Options apply to both records unless a vertical option differs.
#[test]
fn vertical_records_may_have_their_own_options() {
    let folder = folder();
    let path = folder.path();
    let both = ["--record", "a.txt", "--vertical", "a.txt", "--unit", "m/s2", "--dt", "0.25"];
    near(peaks(path, &both), [0.3, 0.3]);
    near(peaks(path, &[&both[..], &["--vertical-unit", "cm/s2"]].concat()), [0.3, 0.003]);
    let table = ["--record", "table.csv", "--vertical", "table.csv", "--acceleration-column", "2", "--unit", "m/s2"];
    near(peaks(path, &[&table[..], &["--vertical-acceleration-column", "east"]].concat()), [0.3, 3.0]);
    let channels = ["--record", "two.V2", "--channel", "1", "--vertical", "two.V2", "--vertical-channel", "2"];
    near(peaks(path, &channels), [0.3, 0.4]);
    // Only the horizontal file has channels, and it states its unit.
    let mixed = ["--record", "two.V2", "--channel", "1", "--vertical", "a.txt", "--vertical-unit", "g"];
    near(peaks(path, &[&mixed[..], &["--vertical-dt", "0.01"]].concat()), [0.3, 0.3 * 9.81]);
    for (option, value, expected) in [
        ("--vertical-unit", "furlong", "--vertical-unit: found unit \"furlong\", expected one of g, m/s2"),
        ("--vertical-dt", "0", "--vertical-dt = 0; expected a time > 0 s"),
        ("--vertical-skip", "100001", "--vertical-skip = 100001; expected a whole number from 0 to 100000"),
    ] {
        let message = refusal(path, &[&["simulate"], &both[..], &[option, value]].concat());
        assert!(message.starts_with(expected), "{message}");
    }
    // A contradiction with the vertical file is resolved by a vertical option.
    let message = refusal(
        path,
        &[
            "simulate",
            "--record",
            "a.txt",
            "--vertical",
            "two.V2",
            "--unit",
            "g",
            "--dt",
            "0.02",
            "--vertical-channel",
            "1",
        ],
    );
    assert_eq!(message, "two.V2, line 9: the file is in cm/s² but g was given; expected --vertical-unit cm/s2");
}

/// Columns by number, in a table that begins with another column; a format that the content does not suggest.
#[test]
fn columns_and_formats_are_chosen() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("c.csv"), "sample,when,a [m/s2]\n1,0,0.5\n2,0.25,-0.75\n3,0.5,0\n").unwrap();
    near(peaks(path, &["--record", "c.csv", "--time-column", "2", "--acceleration-column", "3"]), [0.75, 0.0]);
    let message = refusal(path, &["simulate", "--record", "c.csv", "--time-column", "time"]);
    let found = "c.csv, line 1: found 3 columns named sample, when, a [m/s2], not \"time\"";
    assert_eq!(message, format!("{found}; expected --time-column 1 to 3 or a name"));
    // Two numbers a line are time and acceleration, unless --format says otherwise.
    std::fs::write(path.join("pairs.txt"), "0 0.5\n0.1 0.75\n0.2 0.25\n").unwrap();
    let options = ["--record", "pairs.txt", "--unit", "m/s2"];
    near(peaks(path, &options), [0.75, 0.0]);
    std::fs::write(path.join("pairs.txt"), "0 0.5\n0.1 -0.95\n0.2 0.25\n").unwrap();
    near(peaks(path, &[&options[..], &["--format", "peer", "--dt", "0.01"]].concat()), [0.95, 0.0]);
    let message = refusal(path, &["simulate", "--record", "a.txt", "--format", "smc"]);
    assert!(message.starts_with("a.txt, line 1: found an SMC file of the kind"), "{message}");
}

/// The message has the name of the file once, and the reason once.
#[test]
fn an_unreadable_file_is_named_once() {
    let folder = folder();
    for option in ["--record", "--vertical"] {
        let message = refusal(folder.path(), &["simulate", option, "none.AT2"]);
        assert_eq!(message.matches("none.AT2").count(), 1, "{message}");
        assert_eq!(message.matches("os error").count(), 1, "{message}");
    }
}

/// Study files take the same settings under the same names.
#[test]
fn study_files_have_the_same_settings() {
    let folder = folder();
    let path = folder.path();
    let sweep = |records: &str| {
        let study = format!("[study]\ndesign = \"grid\"\n[[records]]\n{records}\n");
        std::fs::write(path.join("study.toml"), study).unwrap();
        ["sweep", "study.toml", "--csv", "s.csv"]
    };
    for (records, message) in [
        (
            "horizontal = \"a.txt\"\ndt = 0.5",
            "study.toml:4: a.txt: no unit in the file and none given; expected unit g, m/s2 or cm/s2",
        ),
        (
            "horizontal = \"a.txt\"\nunit = \"g\"\ndt = 0.5\nvertical = \"two.V2\"",
            "study.toml:7: two.V2: found 2 channels (1: HEADER 0 OF CHAN 1, 2: HEADER 0 OF CHAN 2); expected \
             vertical_channel 1 to 2 or a name",
        ),
        (
            "horizontal = \"two.V2\"\nchannel = 1\nvertical = \"a.txt\"\nvertical_unit = \"g\"",
            "study.toml:6: a.txt: no time step in the file and none given; expected vertical_dt in seconds",
        ),
        (
            "horizontal = \"a.txt\"\nformat = \"wav\"",
            "study.toml:5: found format \"wav\", expected one of peer, smc, columns, cosmos, csmip, esm, knet, geonet, nsmn, \
             unam, renadic, bhrc, usc, jma, cwb, csmnc, esd, npts, fixed",
        ),
        (
            "horizontal = \"a.txt\"\nchannel = 0",
            "study.toml:5: channel = 0; expected a whole number from 1 to 1000 or a text in quotes",
        ),
    ] {
        assert_eq!(refusal(path, &sweep(records)), message);
    }
    let records = "horizontal = \"two.V2\"\nchannel = 1\nvertical = \"table.csv\"\nvertical_unit = \"cm/s2\"\n\
                   vertical_acceleration_column = 2\nvertical_time_column = \"t\"";
    stdout(path, &sweep(records));
    let table = Table::read(&path.join("s.csv"));
    near(["PGA", "PGA.vertical"].map(|column| table.number(0, column)), [0.3, 0.003]);
}

/// Real files of every format are read, some of them after the option that the error names.
///
/// `../shared/records/README.md` describes their quirks.
#[test]
fn real_files_are_read_with_the_options_that_errors_name() {
    let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/records/formats");
    if !formats.exists() {
        skip("real files of every format: the records of ../shared/records are not at hand");
        return;
    }
    let incomplete: [(&str, &[&str]); 5] = [
        ("CHV1-20140203E.txt", &["--unit", "cm/s2"]),
        ("Northridge_Sylmar_County.dat", &["--unit", "m/s2"]),
        ("San Fernando.dat", &["--unit", "m/s2"]),
        ("ce36456p_CE36456.V2", &["--channel", "3"]),
        ("rrsmv1_1.txt", &["--dt", "0.005", "--unit", "m/s2"]),
    ];
    // A spectrum, velocities, and beginnings of files whose headers count more values.
    let refused = [
        "SeismoSignal_Imperial Valley.txt",
        "RSN1063_NORTHR_RRS228_velocity_cm_s.txt",
        "knet_AOM0011801241951_head.EW",
        "knet_csv_head.csv",
        "geonet_HSES_head.V1A",
        "geonet_WPWS_head.V2A",
        "unam_ACAC_head.191",
        "china_csmnc_head.dat",
        "deepsoil_pystrata_head.txt",
        // Velocities, as their headers say.
        "iris_geocsv_velocity.csv",
        "iris_tspair_velocity.txt",
        "scec_s02-lf_head.bbp",
    ];
    let mut read = 0;
    for entry in std::fs::read_dir(&formats).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let record = ["record", path.to_str().unwrap()];
        if refused.contains(&name) {
            refusal(&formats, &record);
            continue;
        }
        let mut arguments = record.to_vec();
        if let Some((_, options)) = incomplete.iter().find(|(file, _)| *file == name) {
            for pair in options.chunks(2) {
                let message = refusal(&formats, &arguments);
                assert!(message.contains(&format!("; expected {} ", pair[0])), "{message}");
                arguments.extend(pair);
            }
        }
        stdout(&formats, &arguments);
        read += 1;
    }
    assert_eq!(read, 34);
}
