//! Single runs: their tables, pictures and summaries.

use std::path::Path;

use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::{Initial, Settings, Simulation};

use crate::program::{Table, fails_with, files, refused, stdout};

/// The block of the paper's figures.
const PAPER: [&str; 4] = ["--alpha", "0.25", "--p", "1"];

/// Column of a table.
fn column(path: &Path, name: &str) -> Vec<f64> {
    Table::read(path).column(name)
}

#[test]
fn without_arguments_a_block_rocks_under_a_real_record() {
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(folder.path(), &[]);
    for word in ["Loma Prieta", "|θ|/α", "impacts", "residual", "rocking.csv", "rocking.png"] {
        assert!(printed.contains(word), "{word} is not in:\n{printed}");
    }
    let table = folder.path().join("out/rocking.csv");
    let theta = column(&table, "theta");
    let peak = theta.iter().fold(0.0_f64, |peak, x| peak.max(x.abs())) / 0.18;
    assert!((0.3..0.8).contains(&peak), "peak {peak} alpha");
    let printed: f64 = printed.split("|θ|/α = ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((printed - peak).abs() < 1e-3, "printed {printed}, in the table {peak}");
    let picture = std::fs::read(folder.path().join("out/rocking.png")).unwrap();
    assert_eq!(&picture[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(picture[16..20], [0, 0, 0x09, 0x60], "2400 pixels wide");
}

/// Durations of a whole number of steps, for which the product of decimals rounds badly.
#[test]
fn runs_end_exactly_at_their_duration() {
    let folder = tempfile::tempdir().unwrap();
    for (duration, step, rows) in [("0.9", "0.015", 61), ("0.7", "0.1", 8), ("2.1", "0.3", 8)] {
        let run = ["simulate", "--theta", "0.1", "--csv", "run.csv", "--duration", duration, "--step", step];
        stdout(folder.path(), &run);
        let times = column(&folder.path().join("run.csv"), "t");
        assert_eq!((times.len(), times.last()), (rows, Some(&duration.parse().unwrap())));
    }
    let spectrum = "spectrum --alpha 0.25 --pulse one-sine --amplitude 5 --period 1 --points 3 --foundation rigid --duration 0.9 \
                    --step 0.015 --csv x.csv";
    stdout(folder.path(), &spectrum.split_whitespace().collect::<Vec<_>>());
    let table = std::fs::read_to_string(folder.path().join("x.csv")).unwrap();
    // The smallest block has overturned by then.
    assert_eq!(table.lines().filter(|line| line.contains(",undecided,0.9,")).count(), 2, "{table}");
}

/// Free motion lasts until the block is at rest; otherwise the summary predicts its future.
#[test]
fn summaries_predict_the_future_of_the_block() {
    let folder = tempfile::tempdir().unwrap();
    for (options, end) in [
        ("--theta 0.2 --eta 80", "the block is at rest"),
        ("--theta 0.2 --foundation rigid", "the block is at rest"),
        ("--theta 0.2 --eta 80 --duration 9", "completed at t = 9.0000 s: the block will come to rest"),
        ("--theta 0.1 --xi-v 0", "completed at t = 100.0000 s: the block will not overturn"),
        (
            "--pulse one-sine --amplitude 5 --period 2 --duration 1",
            "undecided at t = 1.0000 s: the duration is too short to tell whether the block overturns",
        ),
    ] {
        let arguments: Vec<&str> =
            "simulate --csv run.csv --alpha 0.25 --p 1".split(' ').chain(options.split(' ')).collect();
        let printed = stdout(folder.path(), &arguments);
        let line = |name: &str| printed.lines().find(|line| line.starts_with(name)).unwrap().to_string();
        assert!(line("end").ends_with(end), "{printed}");
        assert_eq!(line("events").contains(" so far"), !end.ends_with("at rest"), "{printed}");
        let impacts: u32 = line("events").split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(!end.starts_with("the block is at rest") || impacts > 20, "{printed}");
    }
}

/// `--friction-demand` adds a column and leaves the bytes of all others.
#[test]
fn the_time_above_a_friction_is_an_additional_column() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |options: &str, lanes: &str| {
        let spectrum =
            "spectrum --alpha 0.25 --pulse one-sine --amplitude 5 --period 1 --points 20 --csv x.csv --lanes";
        let _ = std::fs::remove_file(folder.path().join("x.csv"));
        let arguments: Vec<&str> = spectrum.split(' ').chain([lanes]).chain(options.split_whitespace()).collect();
        stdout(folder.path(), &arguments);
        let table = std::fs::read_to_string(folder.path().join("x.csv")).unwrap();
        table.lines().filter(|line| !line.starts_with('#')).map(String::from).collect::<Vec<_>>()
    };
    let (without, with) = (rows("", "8"), rows("--friction-demand 0.3", "8"));
    assert_eq!(with, rows("--friction-demand 0.3", "1"));
    assert!(with[0].ends_with(",friction_demand>0.3 [s]"), "{}", with[0]);
    for (with, without) in with.iter().zip(&without) {
        assert_eq!(with.rsplit_once(',').unwrap().0, without);
    }
    let times = with[1..].iter().map(|row| row.rsplit_once(',').unwrap().1.parse::<f64>().unwrap());
    assert!(times.clone().all(|time| (0.0..0.5).contains(&time)) && times.clone().any(|time| time > 0.1));
    let printed = stdout(folder.path(), &["simulate", "--theta", "0.15", "--friction-demand", "0.2", "--csv", "y.csv"]);
    assert!(printed.contains("|H|/(N_L + N_R) exceeds 0.2 for at most 0."), "{printed}");
}

/// Rows that do not fit into memory are refused with their number before the run begins.
#[test]
fn rows_beyond_the_memory_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["simulate", "--theta", "0.1", "--duration", "36", "--csv", "x.csv"];
    for (more, words) in [
        (
            &["--step", "1e-6"][..],
            "36 s in steps of 0.000001 s are 36000000 rows; expected at most 1e7, which need about 13 GB",
        ),
        (
            &["--step", "1e-5", "--gradients", "alpha,eta,xi_v"],
            "are 14400000 rows with the derivatives for 3 parameters; expected at most 1e7",
        ),
    ] {
        refused(folder.path(), &[&run[..], more].concat(), &[words]);
    }
    // A shell whose memory is limited to 3 GB of addresses.
    if cfg!(target_os = "linux") {
        let mut shell = std::process::Command::new("sh");
        let command = r#"ulimit -v 3000000; exec "$0" "$@""#;
        shell.args(["-c", command, env!("CARGO_BIN_EXE_rocking")]).args(run).args(["--step", "1e-5"]);
        let words =
            ["3600000 rows, for which the system does not provide about 4.7 GB of memory; expected longer steps"];
        fails_with(shell.current_dir(folder.path()), &words);
    }
}

#[test]
fn the_table_has_the_numbers_of_the_solver() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["simulate", "--pulse", "one-sine", "--amplitude", "6.2622", "--period", "1.25", "--duration", "3"];
    stdout(folder.path(), &[&arguments[..], &PAPER, &["--csv", "run.csv", "--plot", "run.svg"]].concat());
    let d = Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 }) };
    let block = Block::from_dimensionless(&d, &Common::default()).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 6.2622, period: 1.25, start: 0.0, ..Pulse::NONE };
    let inputs = Inputs::default();
    let mut simulation = Simulation::new(block, Settings::default(), pulse, &Initial::default(), 0.0, &inputs);
    let (t, theta) = (column(&folder.path().join("run.csv"), "t"), column(&folder.path().join("run.csv"), "theta"));
    assert_eq!(t.len(), 301);
    for (t, theta) in t.iter().zip(theta) {
        simulation.advance(*t, &inputs, &mut |_| ()).unwrap();
        assert_eq!(simulation.observe(&inputs).theta, theta);
    }
    let svg = std::fs::read_to_string(folder.path().join("run.svg")).unwrap();
    roxmltree::Document::parse(&svg).unwrap();
    for label in ["θ/α", "N/(M g)", "ground acceleration (g)", "time (s)", "on both", "one-sine pulse"] {
        assert!(svg.contains(label), "{label} is not in the picture");
    }
}

/// The picture ends at |θ|/α = 1.5, with a note for a block that overturns; every line stays inside.
#[test]
fn a_picture_shows_the_relevant_rotations() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |arguments: &[&str]| {
        stdout(folder.path(), &[&["simulate", "--plot", "run.svg"], arguments].concat());
        std::fs::read_to_string(folder.path().join("run.svg")).unwrap()
    };
    let pulse = ["--pulse", "one-sine", "--amplitude", "9", "--period", "1.2566", "--foundation", "rigid"];
    let svg = picture(&[&PAPER[..], &pulse].concat());
    for label in [
        "|θ| = α",
        "|θ|/α &gt; 1.5 after t = 4.4 s; peak 5.791",
        "α = 0.25 rad",
        "rigid base",
        "ground acceleration (g)",
    ] {
        assert!(svg.contains(label), "{label} is not in the picture");
    }
    let drawing = roxmltree::Document::parse(&svg).unwrap();
    let height: f64 = drawing.root_element().attribute("height").unwrap().parse().unwrap();
    let lines: Vec<Vec<[f64; 2]>> = drawing
        .descendants()
        .filter_map(|node| node.attribute("points"))
        .map(|points| {
            let number = |text: &str| text.parse::<f64>().unwrap();
            points
                .split_whitespace()
                .map(|point| point.split_once(',').unwrap())
                .map(|(x, y)| [x, y].map(number))
                .collect()
        })
        .collect();
    assert!(lines.iter().flatten().all(|[x, y]| (0.0..=24_000.0).contains(x) && (0.0..=10.0 * height).contains(y)));
    // The rotation is the longest line. It is smooth: neighbouring points differ by fractions of a pixel.
    let flat = |line: &[[f64; 2]]| line.windows(2).any(|pair| (1.0..10.0).contains(&(pair[0][1] - pair[1][1]).abs()));
    assert!(lines.iter().any(|line| line.len() > 400 && flat(line)));
    let svg = picture(&["--theta", "0.1", "--eta", "80", "--alpha", "0.253", "--p", "1.0005"]);
    for label in ["α = 0.253 rad, p = 1.0005 rad/s, η = 80", "time (s)", "on both"] {
        assert!(svg.contains(label), "{label} is not in the picture");
    }
    assert!(!svg.contains("ground"), "the ground is at rest");
    assert!(!svg.contains("|θ| = α"), "the block stays far from α");
}

/// Each column of a history has a unit.
#[test]
fn the_table_names_its_units() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &["simulate", "--theta", "0.1", "--duration", "1", "--csv", "run.csv"]);
    let table = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    assert!(names.iter().all(|name| name.ends_with(']')), "{names:?}");
    assert_eq!(names[..3], ["t [s]", "theta [rad]", "theta_dot [rad/s]"]);
}

#[test]
fn the_same_run_gives_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        let (csv, plot) = (format!("{name}.csv"), format!("{name}.png"));
        stdout(folder.path(), &["simulate", "--csv", &csv, "--plot", &plot]);
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.csv"), read("b.csv"));
    assert_eq!(read("a.png"), read("b.png"));
}

#[test]
fn a_run_that_ends_early_reports_it_and_ends_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["simulate", "--pulse", "one-sine", "--amplitude", "6.2622", "--period", "1.2566370614359172"];
    let more = ["--eta", "60", "--epsilon", "0.4", "--csv", "run.csv", "--events"];
    let printed = stdout(folder.path(), &[&arguments[..], &PAPER, &more].concat());
    // From the reference case sine_separates.
    assert!(printed.contains("complete separation at t = 1.3901 s"), "{printed}");
    assert!(printed.contains("lift-off of R, tilting right -> separated"), "{printed}");
    let last = *column(&folder.path().join("run.csv"), "t").last().unwrap();
    assert!((last - 1.3900586035017384).abs() < 1e-6, "{last}");
}

#[test]
fn a_pulse_and_a_record_are_added() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ground.csv"), "t [s],a [m/s2]\n0,0\n0.1,1\n0.2,0\n").unwrap();
    let arguments =
        ["simulate", "--record", "ground.csv", "--scale", "2", "--pulse", "one-cosine", "--amplitude", "0.5"];
    stdout(folder.path(), &[&arguments[..], &["--csv", "run.csv", "--step", "0.05"]].concat());
    let a_gx = column(&folder.path().join("run.csv"), "a_gx");
    assert!((a_gx[0] - 0.5).abs() < 1e-12);
    let pulse = 0.5 * (std::f64::consts::TAU * 0.1).cos();
    assert!((a_gx[2] - (2.0 + pulse)).abs() < 1e-12, "{}", a_gx[2]);
}

#[test]
fn the_table_can_go_to_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(folder.path(), &["simulate", "--csv", "-", "--duration", "1"]);
    assert!(printed.starts_with("t [s],theta [rad],theta_dot [rad/s],"), "{printed}");
    assert_eq!(printed.lines().count(), 202);
    assert!(files(folder.path()).is_empty());
}

/// Each error is one line with status 1, and leaves no file.
#[test]
fn errors_are_one_line_and_leave_no_file() {
    let at2 = |count: usize, unit: &str, values: &str| {
        format!(
            "PEER NGA STRONG MOTION DATABASE RECORD\nSOMEWHERE\nACCELERATION TIME HISTORY IN UNITS OF {unit}\n{count}    0.0100    NPTS, DT\n{values}\n"
        )
    };
    let values = "  0.100000E+00  0.200000E+00 -0.100000E+00  0.100000E-01  0.100000E-01";
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("text.at2", b"no accelerogram at all\njust words\n".to_vec(), "text.at2"),
        ("image.at2", vec![0x89, b'P', b'N', b'G', 0, 1, 2, 255, 0, 0], "image.at2"),
        ("empty.at2", Vec::new(), "empty.at2"),
        ("cut.at2", at2(5, "G", "  0.100000E+00  0.200000E+00 -0.100").into_bytes(), "cut.at2"),
        ("count.at2", at2(7, "G", values).into_bytes(), "7"),
        ("unit.at2", at2(5, "FURLONGS", values).into_bytes(), "FURLONGS"),
        ("nan.at2", at2(5, "G", &values.replace("0.200000E+00", "NaN")).into_bytes(), "NaN"),
    ];
    for (name, content, named) in cases {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), content).unwrap();
        refused(folder.path(), &["simulate", "--record", name, "--csv", "run.csv", "--plot", "run.png"], &[named]);
        assert_eq!(files(folder.path()), [name], "a result was left");
    }
    let folder = tempfile::tempdir().unwrap();
    let refuses: [(&[&str], &str); 9] = [
        (&["--record", "missing.at2"], "missing.at2"),
        (&["--csv", "no/such/folder/run.csv"], "found no folder"),
        (&["--csv", "/dev/null/run.csv"], "cannot be written"),
        (&["--plot", "run.jpeg"], ".jpeg"),
        (&["--alpha", "2"], "alpha = 2"),
        (&["--mass", "0"], "mass = 0"),
        (&["--pulse", "c1"], "--amplitude"),
        (&["--duration", "0"], "--duration = 0"),
        (&["--step", "NaN"], "--step = NaN"),
    ];
    for (arguments, named) in refuses {
        refused(folder.path(), &[&["simulate"], arguments].concat(), &[named]);
    }
    assert!(files(folder.path()).iter().all(|name| name == "out"));
}

/// A failed run does not replace the file of an earlier run.
#[test]
fn an_old_result_survives_a_failed_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.csv"), "old").unwrap();
    refused(folder.path(), &["simulate", "--csv", "run.csv", "--plot", "none/run.png"], &["none/run.png"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("run.csv")).unwrap(), "old");
    assert_eq!(files(folder.path()), ["run.csv"]);
}
