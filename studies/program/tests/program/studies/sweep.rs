//! `rocking sweep`.

use std::path::Path;

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Initial, Settings};
use rocking_records::{ReadOptions, Unit, read};
use rocking_studies::intensity::{Measure, spectral_acceleration};
use rocking_studies::run::Run;

use crate::program::{RECORD, Table, files, refused, rocking, stdout, text};
use crate::studies::resumes_to_the_same_bytes;

/// 3 × 2 combinations, two motions, two scales: 24 rows.
pub const GRID: &str = r#"
[study]
design = "grid"
scales = [1, -2.5]
periods = [0.3, 1]

[parameters]
dimensionless.p = { from = 1, to = 4, count = 3, spacing = "log" }
foundation = ["viscoelastic", "RIGID"]
"dimensionless.alpha" = 0.3
epsilon = 0.1

[[records]]
horizontal = "h.csv"
unit = "m/s2"
dt = 0.02

[[records]]
horizontal = "h.csv"
vertical = "v.csv"
unit = "m/s2"
dt = 0.02
"#;

pub const SAMPLES: &str = r#"
[study]
design = "latin-hypercube"
samples = 8
seed = 5

[parameters]
dimensionless.eta = { from = 20, to = 80 }
pulse.period = { from = 0.5, to = 2, spacing = "log" }
pulse.shape = ["OneSine", "OneCosine"]
pulse.amplitude = 6
"#;

/// A folder with a study and two records.
pub fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text =
        |a: f64, f: f64| (0..100).map(|i| format!("{}\n", a * (f * 0.02 * f64::from(i)).sin())).collect::<String>();
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    std::fs::write(folder.path().join("h.csv"), text(4.0, 5.0)).unwrap();
    std::fs::write(folder.path().join("v.csv"), text(2.0, 17.0)).unwrap();
    folder
}

fn sweep(folder: &Path) -> Table {
    stdout(folder, &["sweep", "study.toml", "--csv", "out.csv"]);
    Table::read(&folder.join("out.csv"))
}

/// The numbers are those of the path.
#[test]
fn a_record_may_be_a_url_of_this_machine() {
    let records = folder(GRID);
    let by_path = sweep(records.path());
    let url = format!("file://{}", records.path().join("h.csv").display());
    let by_url = folder(&GRID.replace("h.csv", &url));
    let study = by_url.path().join("study.toml");
    stdout(by_url.path(), &["sweep", study.to_str().unwrap(), "--csv", "out.csv"]);
    let by_url = Table::read(&by_url.path().join("out.csv"));
    assert_eq!(by_url.column("peak.theta/alpha"), by_path.column("peak.theta/alpha"));
}

#[test]
fn one_thread_and_two_give_the_same_bytes_and_so_does_an_interrupted_sweep() {
    for study in [GRID, SAMPLES] {
        let folder = folder(study);
        for threads in ["1", "2"] {
            stdout(folder.path(), &["sweep", "study.toml", "--csv", &format!("{threads}.csv"), "--threads", threads]);
        }
        let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
        assert!(read("1.csv") == read("2.csv"));
        resumes_to_the_same_bytes(folder.path(), &["sweep", "study.toml"], "1.csv");
    }
}

/// Every combination has one row, in order, with the numbers of the single run to the last digit.
#[test]
fn a_grid_holds_the_single_runs() {
    let folder = folder(GRID);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "out.csv", "--on-separation", "terminate"]);
    let table = Table::read(&folder.path().join("out.csv"));
    assert_eq!(table.rows.len(), 24);
    let options =
        ReadOptions { unit: Some(Unit::MetrePerSecondSquared), time_step: Some(0.02), ..ReadOptions::default() };
    let [h, v] = ["h.csv", "v.csv"].map(|name| read(&folder.path().join(name), &options).unwrap());
    let mut ends = Vec::new();
    for row in 0..24 {
        let p = table.number(row, "p [rad/s]");
        let exact = [1.0, 2.0, 4.0][row / 8];
        assert!((p / exact - 1.0).abs() < 1e-15, "p = {p}");
        let foundation = [Foundation::Viscoelastic, Foundation::Rigid][row / 4 % 2];
        assert_eq!(table.get(row, "foundation"), format!("{foundation:?}").to_lowercase());
        let vertical = row / 2 % 2 == 1;
        assert_eq!(
            (table.get(row, "record"), table.get(row, "vertical")),
            ("h.csv", if vertical { "v.csv" } else { "" })
        );
        let scale = [1.0, -2.5][row % 2];
        assert_eq!(table.number(row, "scale [1]"), scale);
        let common = Common { epsilon: 0.1, ..Common::default() };
        let d = Dimensionless { alpha: 0.3, p, supports: Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 }) };
        let run = Run {
            block: Block::from_dimensionless(&d, &common).unwrap(),
            settings: Settings { tolerance: Settings::OF_STUDIES, ..Settings::default() },
            initial: Initial::default(),
            pulse: Pulse::NONE,
            ground: Ground { horizontal: Some(h.clone()), vertical: vertical.then(|| v.clone()) }.scaled(scale),
            duration: None,
            output_step: f64::INFINITY,
        };
        let history = run.history(|_| ()).unwrap();
        let outcome = table.get(row, "outcome");
        ends.push(outcome.to_string());
        let end_time = table.number(row, "end_time [s]");
        match history.ending {
            None => assert_eq!((outcome, end_time), ("completed", history.rows[1].time)),
            Some((ending, time)) => {
                assert_eq!(outcome, if ending.is_overturning() { "overturned" } else { "separated" });
                assert_eq!(end_time, time);
            }
        }
        assert_eq!(table.number(row, "peak.theta/alpha"), history.peaks.theta / 0.3);
        assert_eq!(table.number(row, "peak.uplift [m]"), history.peaks.uplift);
        assert_eq!(table.number(row, "peak.N [N]"), history.peaks.reaction);
        assert_eq!(table.number(row, "peak.H [N]"), history.peaks.horizontal);
        assert_eq!(table.number(row, "events.impacts [1]"), f64::from(history.counts.impacts));
        // Intensity measures are those of the record times the magnitude of the scale factor.
        let pga = h.acceleration.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        assert_eq!(table.number(row, "PGA [m/s2]"), pga * scale.abs());
        assert_eq!(table.number(row, "Sa(0.3 s) [m/s2]"), spectral_acceleration(&h, 0.3) * scale.abs());
        // 4 sin(5 t) begins with the velocity 0.8 (1 − cos 5t), which peaks at 1.6 m/s.
        assert!(
            (table.number(row, "PGV [m/s]") / (1.6 * scale.abs()) - 1.0).abs() < 2e-3,
            "{}",
            table.get(row, "PGV [m/s]")
        );
        assert_eq!(table.get(row, "PGA.vertical [m/s2]").is_empty(), !vertical);
        // Arias intensity grows with the square of the factor; durations and periods do not change.
        for measure in Measure::of_record(&[0.3, 1.0]) {
            let unscaled = measure.of(&h, 9.81).unwrap();
            let exact = unscaled * scale.abs().powi(measure.power().into());
            assert_eq!(table.number(row, &measure.heading()), exact, "{measure}");
        }
        let relative = [
            ("PGA/(g tan alpha) [1]", pga * scale.abs() / (9.81 * 0.3_f64.tan())),
            ("p PGV/(g tan alpha) [1]", p * table.number(row, "PGV [m/s]") / (9.81 * 0.3_f64.tan())),
            ("p T_m [1]", p * table.number(row, "T_m [s]")),
        ];
        for (column, exact) in relative {
            assert!((table.number(row, column) / exact - 1.0).abs() < 1e-14, "{column}: {}", table.get(row, column));
        }
    }
    // The grid has both early ends and blocks that rock on.
    for end in ["completed", "separated", "overturned"] {
        assert!(ends.iter().any(|found| found == end), "no run {end}: {ends:?}");
    }
}

#[test]
fn samples_fill_their_ranges_and_follow_from_the_seed() {
    let folder = folder(SAMPLES);
    let table = sweep(folder.path());
    assert_eq!(table.rows.len(), 8);
    let mut eta: Vec<usize> = (0..8).map(|row| ((table.number(row, "eta [1]") - 20.0) / 7.5) as usize).collect();
    eta.sort_unstable();
    assert!(eta.into_iter().eq(0..8), "one in each eighth of the range");
    let period = |row| (table.number(row, "pulse.period [s]") / 0.5).log2() * 4.0;
    let mut periods: Vec<usize> = (0..8).map(|row| period(row) as usize).collect();
    periods.sort_unstable();
    assert!(periods.into_iter().eq(0..8), "one in each eighth of the logarithms");
    assert_eq!((0..8).filter(|&row| table.get(row, "pulse.shape") == "one-sine").count(), 4);
    assert!((0..8).all(|row| table.get(row, "scale [1]").is_empty() && table.get(row, "PGA [m/s2]").is_empty()));
    std::fs::write(folder.path().join("study.toml"), SAMPLES.replace("seed = 5", "seed = 6")).unwrap();
    refused(folder.path(), &["sweep", "study.toml", "--csv", "out.csv", "--resume"], &["found `# seed = 5`"]);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "other.csv"]);
    let other = Table::read(&folder.path().join("other.csv"));
    assert_ne!(table.get(0, "eta [1]"), other.get(0, "eta [1]"));
}

/// The example of the README.
#[test]
fn the_example_runs() {
    let folder = tempfile::tempdir().unwrap();
    let study = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/fragility.toml");
    stdout(folder.path(), &["sweep", study, "--csv", "out.csv"]);
    let table = Table::read(&folder.path().join("out.csv"));
    assert_eq!(table.rows.len(), 48);
    // The record's peak is 222.5 cm/s² (examples/records/README.md).
    assert!((0..48).all(|row| (table.number(row, "PGA [m/s2]") / table.number(row, "scale [1]") - 2.225).abs() < 1e-3));
    assert!((0..48).all(|row| table.get(row, "outcome") != "failed"));
}

/// Failed runs are marked and counted; the others are computed.
#[test]
fn failed_runs_are_reported_and_the_others_computed() {
    let folder = folder(&GRID.replace("scales = [1, -2.5]", "scales = [1, 1e300]"));
    let output = rocking(folder.path(), &["sweep", "study.toml", "--csv", "out.csv"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        message.contains("\nrocking: 12 of 24 runs failed, the first in row 1: the motion is not finite"),
        "{message}"
    );
    let table = Table::read(&folder.path().join("out.csv"));
    assert_eq!(table.rows.len(), 24);
    for row in 0..24 {
        let failed = row % 2 == 1;
        assert_eq!(table.get(row, "outcome") == "failed", failed);
        // Peaks until the failure.
        assert!(table.number(row, "peak.theta/alpha") >= 0.0 && table.number(row, "end_time [s]") >= 0.0);
    }
    // A resumed study still reports them.
    let output = rocking(folder.path(), &["sweep", "study.toml", "--csv", "out.csv", "--resume"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).ends_with("\nrocking: 12 of 24 runs failed, the first in row 1\n"));
}

/// A changed record of the same name makes another study; a comment does not.
#[test]
fn a_resumed_sweep_needs_the_same_records() {
    let folder = folder(GRID);
    let whole = sweep(folder.path()).rows.len();
    std::fs::write(folder.path().join("study.toml"), format!("# A comment\n{}", GRID.replace('\n', "\n  "))).unwrap();
    let printed = stdout(folder.path(), &["sweep", "study.toml", "--csv", "out.csv", "--resume"]);
    assert!(printed.contains(&format!("{whole} resumed")), "{printed}");
    let record = std::fs::read_to_string(folder.path().join("h.csv")).unwrap();
    std::fs::write(folder.path().join("h.csv"), record.replacen("0.39", "0.40", 1)).unwrap();
    refused(folder.path(), &["sweep", "study.toml", "--csv", "out.csv", "--resume"], &["out.csv:", "crc32"]);
}

/// Without `on_separation` in the study blocks fly, as with `on_separation = "Fly"`.
#[test]
fn blocks_fly_unless_the_study_says_otherwise() {
    let study = "[study]\ndesign = \"grid\"\n[parameters]\ndimensionless.alpha = 0.25\ndimensionless.p = [1, 3]\npulse.shape = \"OneSine\"\n\
                 pulse.amplitude = 9\npulse.period = 1\nepsilon = 0.4\ndimensionless.eta = 80\n";
    let [silent, flying, ending] = ["", "on_separation = \"Fly\"\n", "on_separation = \"Terminate\"\n"].map(|more| {
        let folder = folder(&format!("{study}{more}"));
        stdout(folder.path(), &["sweep", "study.toml", "--csv", "out.csv"]);
        let table = Table::read(&folder.path().join("out.csv"));
        let columns = ["outcome", "end_time [s]", "peak.theta/alpha", "flights [1]", "events.impacts [1]"];
        (0..2).map(|row| columns.map(|column| table.get(row, column).to_string())).collect::<Vec<_>>()
    });
    assert_eq!(silent, flying);
    assert_ne!(silent, ending);
}

/// Each error has its line, before any run begins and any file is written.
#[test]
fn wrong_keys_and_values_are_refused_with_their_line() {
    let cases = [
        ("scales = [1, -2.5]", "scale = [1]", "study.toml:4:", "there is no scale in study"),
        ("scales = [1, -2.5]", "scales = [1, 0]", "study.toml:4:", "scales = 0"),
        ("scales = [1, -2.5]", "scales = [1, \n nan]", "study.toml:5:", "scales = nan"),
        ("periods = [0.3, 1]", "periods = 1", "study.toml:5:", "periods = 1; expected a list"),
        ("design = \"grid\"", "design = \"cube\"", "study.toml:3:", "\"latin-hypercube\""),
        ("design = \"grid\"", "seed = 1", "study.toml:2:", "has no design"),
        ("design = \"grid\"", "design = \"latin-hypercube\"", "study.toml:2:", "samples"),
        ("design = \"grid\"", "design = \"grid\"\nseed = 1", "study.toml:4:", "seed = 1"),
        ("design = \"grid\"", "design = \"grid\"\nduration = -1", "study.toml:4:", "a time > 0 s"),
        ("design = \"grid\"", "design = \"grid\"\ntolerance = true", "study.toml:4:", "tolerance = true"),
        ("dimensionless.p =", "dimensionless.q =", "study.toml:8:", "there is no parameter dimensionless.q"),
        ("epsilon = 0.1", "epsilon = 2", "study.toml:11:", "epsilon = 2; expected 0 to 1"),
        ("epsilon = 0.1", "epsilon = [0, 2]", "study.toml:11:", "epsilon = 2"),
        ("epsilon = 0.1", "epsilon = \"low\"", "study.toml:11:", "expected a number"),
        ("epsilon = 0.1", "epsilon = []", "study.toml:11:", "at least one value"),
        ("epsilon = 0.1", "epsilon = { from = 0, to = 2, count = 3 }", "study.toml:11:", "epsilon = 2"),
        ("epsilon = 0.1", "epsilon = { from = 1, to = 0, count = 3 }", "study.toml:11:", "more than from = 1"),
        ("epsilon = 0.1", "epsilon = { from = 0, to = 1 }", "study.toml:11:", "has no count"),
        ("epsilon = 0.1", "epsilon = { from = 0, to = 1, count = 1 }", "study.toml:11:", "count = 1"),
        ("epsilon = 0.1", "epsilon = { from = 0, to = 1, step = 1 }", "study.toml:11:", "there is no step"),
        ("epsilon = 0.1", "epsilon = { from = 0, to = 1, count = 3, spacing = \"log\" }", "study.toml:11:", "> 0"),
        (
            "epsilon = 0.1",
            "derived.p = 1",
            "study.toml:11:",
            "derived.p (calculated parameter) is not set from outside",
        ),
        (
            "epsilon = 0.1",
            "a_gx = 1",
            "study.toml:11:",
            "a_gx (input) is not set from outside; expected one of parameterization",
        ),
        ("epsilon = 0.1", "g = [9.81, 1.62]", "study.toml:11:", "g takes several values"),
        ("epsilon = 0.1", "physical.width = 1", "study.toml:11:", "width is read by no block"),
        ("epsilon = 0.1", "initial.v = 1", "study.toml:11:", "initial.v is read by no block"),
        ("epsilon = 0.1", "restitution_factor = -1", "study.toml:11:", "restitution_factor = -1"),
        // On the rigid base e = 0.87 for alpha = 0.3 and epsilon = 0, so that the factor makes e > 1.
        ("epsilon = 0.1", "restitution_factor = 1.2", "study.toml:11:", "restitution_factor = 1.2 makes e = 0.8690"),
        (
            "foundation = [\"viscoelastic\", \"RIGID\"]",
            "restitution_factor = 0.9",
            "study.toml:9:",
            "restitution_factor is read by no block",
        ),
        ("epsilon = 0.1", "initial.settled = 1", "study.toml:11:", "true or false"),
        ("\"viscoelastic\", ", "\"elastic\", ", "study.toml:9:", "expected one of viscoelastic, rigid"),
        (
            "\"dimensionless.alpha\" = 0.3",
            "parameterization = \"Physical\"\nphysical.width = 0",
            "study.toml:11:",
            "width = 0",
        ),
        ("horizontal = \"h.csv\"", "horizontal = \"none.csv\"", "study.toml:14:", "none.csv"),
        ("horizontal = \"h.csv\"", "file = \"h.csv\"", "study.toml:14:", "there is no file in [[records]]"),
        ("\"h.csv\"", "\"file://there/h.csv\"", "study.toml:14:", "file://there/h.csv: a URL of another machine"),
        ("unit = \"m/s2\"", "unit = \"furlong\"", "study.toml:15:", "furlong"),
        ("dt = 0.02", "dt = 0", "study.toml:16:", "dt = 0"),
        ("[study]", "[study", "study.toml:2:", "invalid TOML"),
        ("[study]", "[stud]", "study.toml:2:", "there is no stud in the file"),
    ];
    for (old, new, line, words) in cases {
        assert!(GRID.contains(old));
        let folder = folder(&GRID.replacen(old, new, 1));
        let before = files(folder.path());
        refused(folder.path(), &["sweep", "study.toml", "--csv", "out.csv"], &[line, words]);
        assert_eq!(files(folder.path()), before, "{new}");
    }
    let without = folder("[study]\ndesign = \"grid\"\n[parameters]\nepsilon = 0.1\n");
    refused(without.path(), &["sweep", "study.toml", "--csv", "out.csv"], &["nothing moves the block"]);
    let many =
        "epsilon = { from = 0, to = 1, count = 1000000 }\ndimensionless.xi_v = { from = 0, to = 1, count = 1000000 }";
    let many = folder(&GRID.replace("epsilon = 0.1", many));
    refused(many.path(), &["sweep", "study.toml", "--csv", "out.csv"], &["too many rows"]);
    refused(many.path(), &["sweep", "none.toml", "--csv", "out.csv"], &["none.toml: cannot be read"]);
}

/// Both polarities of a record are one motion in two rows: the reversed run of a block is the run of its mirror image.
#[test]
fn a_record_in_both_polarities_is_one_motion() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study = |eccentricity: f64, polarity: &str| {
        format!(
            "[study]\ndesign = \"grid\"\nscales = [1, 3, 5]\n[parameters]\nfoundation = \"rigid\"\nalpha = [0.12, 0.15, 0.2]\np = [2, 3]\n\
             eccentricity = {eccentricity}\n[[records]]\nhorizontal = \"{RECORD}\"\n{polarity}"
        )
    };
    let table = |name: &str, text: String| {
        std::fs::write(folder.join("study.toml"), text).unwrap();
        stdout(folder, &["sweep", "study.toml", "--csv", name]);
        Table::read(&folder.join(name))
    };
    let both = table("both.csv", study(0.03, "polarity = \"both\""));
    let [plain, mirrored] = [0.03, -0.03].map(|e| table(&format!("of_{e}.csv"), study(e, "")));
    assert_eq!(both.rows.len(), 2 * plain.rows.len());
    let rows = |table: &Table, reversed: bool| -> Vec<Vec<String>> {
        let of = |row: &usize| table.get(*row, "record").ends_with(" (reversed)") == reversed;
        let columns = ["alpha", "p", "scale", "PGA", "PGV", "outcome", "peak.theta/alpha", "peak.H", "end_time"];
        let cells = |row: usize| columns.map(|column| table.get(row, column).to_string()).to_vec();
        (0..table.rows.len()).filter(of).map(cells).collect()
    };
    assert_eq!(rows(&both, false), rows(&plain, false));
    assert_eq!(rows(&both, true), rows(&mirrored, false));
    assert_ne!(rows(&both, true), rows(&both, false));

    let curve = stdout(folder, &["fragility", "both.csv", "--im", "PGV"]);
    assert!(curve.contains("36 rows") && curve.contains("for the only motion"), "{curve}");
    for (text, words) in [
        (study(0.03, "polarity = \"reversed\""), "polarity = \"reversed\"; expected \"as-recorded\" or \"both\""),
        (
            study(0.03, "polarity = \"both\"").replace("horizontal", "vertical"),
            "polarity has no effect without horizontal",
        ),
    ] {
        std::fs::write(folder.join("study.toml"), text).unwrap();
        refused(folder, &["sweep", "study.toml", "--csv", "x.csv"], &[words]);
    }
}
