//! Sweeps of blocks in space, and fragility curves over their tables.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use crate::program::{Table, refusal, stdout};
use crate::studies::{labels, resumes_to_the_same_bytes};

/// Two blocks under two pairs, in two directions, at two scales: 16 rows.
const STUDY: &str = r#"
[study]
design = "grid"
azimuths = [0, 30]
scales = [0.7, 1.5]
periods = [0.4]

[parameters]
width = 0.3
height = 1.4
depth_ratio = [1, 1.6]
eta = 50
xi_v = 0.2
friction = 0.4

[[records]]
x = "a.csv"
y = "b.csv"
z = "c.csv"
unit = "m/s2"

[[records]]
x = "b.csv"
y = "a.csv"
unit = "m/s2"
"#;

/// Writes three components and a study into a folder.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, amplitude, frequency, phase) in [("a", 4.0, 9.0, 0.0), ("b", 3.0, 7.0, 0.4), ("c", 1.0, 15.0, 0.2)] {
        let rows = (0..240).map(|i| f64::from(i) * 0.01).map(|t| {
            let fade = (t / 2.4 * std::f64::consts::PI).sin();
            format!("{t},{}\n", amplitude * fade * (frequency * t + phase).sin())
        });
        let text = format!("t,a\n{}", rows.collect::<String>());
        std::fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Each row has the bits of the run of `simulate` with its block, its motion and its strength.
#[test]
fn rows_are_the_runs_of_simulate() {
    let folder = folder(STUDY);
    let printed = stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    assert!(printed.starts_with("model         block in space\n"), "{printed}");
    let table = Table::read(&folder.path().join("s.csv"));
    assert_eq!(table.rows.len(), 16);
    for row in [0, 3, 6, 11, 15] {
        let of = |name: &str| table.number(row, name);
        let text = |name: &str| table.get(row, name);
        let mut line =
            String::from("simulate --width 0.3 --height 1.4 --eta 50 --xi-v 0.2 --friction 0.4 --unit m/s2 --json");
        write!(
            line,
            " --depth-ratio {} --record {} --record-y {}",
            of("depth_ratio"),
            text("record"),
            text("record_y")
        )
        .unwrap();
        if !text("vertical").is_empty() {
            write!(line, " --vertical {}", text("vertical")).unwrap();
        }
        write!(line, " --scale {} --azimuth {} --tolerance 1e-6 --step 1e6", of("scale"), of("azimuth")).unwrap();
        let line = format!("{line} --on-separation fly --csv run.csv");
        let run: Value = serde_json::from_str(&stdout(folder.path(), &line.split(' ').collect::<Vec<_>>())).unwrap();
        assert_eq!(run["outcome"], text("outcome"));
        assert_eq!(number(&run["end_time"]), of("end_time"), "row {row}");
        for peak in ["tilt", "tilt/alpha", "twist", "uplift", "N", "slip", "drift"] {
            assert_eq!(number(&run["peak"][peak]), of(&format!("peak.{peak}")), "{peak} in row {row}");
        }
        for event in ["lift_offs", "landings", "slides", "sticks"] {
            assert_eq!(number(&run["events"][event]), of(&format!("events.{event}")), "{event} in row {row}");
        }
        for end in ["tilt/alpha", "twist", "drift_x", "drift_y"] {
            assert_eq!(number(&run["end"][end]), of(&format!("end.{end}")), "{end} in row {row}");
        }
    }
    assert!(table.column("peak.twist").iter().any(|twist| *twist > 1e-3), "some blocks twist");
}

/// The same pair, with its components swapped, is the same motion, and its rows are clustered.
#[test]
fn pairs_of_one_instrument_are_one_motion() {
    let folder = folder(STUDY);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    assert!((0..16).all(|row| table.get(row, "motion") == "a.csv"));
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    assert!(text.contains("\n# block in space\n"), "{text}");
}

/// Parts and interruptions leave the bytes of the rows.
#[test]
fn parts_and_resumed_tables_have_the_same_rows() {
    let folder = folder(STUDY);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    resumes_to_the_same_bytes(folder.path(), &["sweep", "study.toml"], "s.csv");
    let rows = |file: &str| {
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(String::from).collect::<Vec<_>>()
    };
    let mut of_parts = Vec::new();
    for part in ["1/3", "2/3", "3/3"] {
        stdout(folder.path(), &["sweep", "study.toml", "--part", part, "--out", "parts", "--part-format", "csv"]);
        of_parts.extend(rows(&format!("parts/part-0000{}-of-00003.csv", &part[..1])));
    }
    of_parts.sort_by_key(|line| line.split(',').next().unwrap().parse::<u32>().unwrap());
    assert_eq!(of_parts, rows("s.csv"));
    let forecast: Value =
        serde_json::from_str(&stdout(folder.path(), &["sweep", "study.toml", "--dry-run", "--json"])).unwrap();
    assert_eq!((forecast["model"].as_str(), forecast["rows"].as_u64()), (Some("block in space"), Some(16)));
}

/// Levels of a measure over all directions are met, and random directions are drawn once in each part of a turn.
#[test]
fn levels_and_random_directions_are_met() {
    let study = STUDY
        .replace("scales = [0.7, 1.5]", "levels = { im = \"PGV.RotD50\", values = [0.1, 0.3] }")
        .replace("azimuths = [0, 30]", "azimuths = { count = 4, seed = 7 }");
    let folder = folder(&study);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    assert_eq!(table.rows.len(), 32);
    for row in 0..32 {
        assert_eq!(table.number(row, "PGV.RotD50"), [0.1, 0.3][row % 2]);
        let azimuth = table.number(row, "azimuth");
        let quarter = (row / 2) % 4;
        assert!((90.0 * quarter as f64..90.0 * (quarter + 1) as f64).contains(&azimuth), "{azimuth} in row {row}");
    }
    assert_ne!(table.number(0, "azimuth"), table.number(8, "azimuth"), "each motion has its own directions");
}

/// The median over all directions of the table is that of samples turned here, with the velocity by the trapezoidal rule.
#[test]
fn measures_are_those_of_their_definitions() {
    let folder = folder(STUDY);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let [a, b] = ["a.csv", "b.csv"].map(|name| Table::read(&folder.path().join(name)).column("a"));
    let turned = |degrees: u32| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        a.iter().zip(&b).map(|(x, y)| x * cos + y * sin).collect::<Vec<f64>>()
    };
    let pga = |samples: &[f64]| samples.iter().map(|a| a.abs()).fold(0.0, f64::max);
    let pgv = |samples: &[f64]| {
        let mut velocity = 0.0;
        let velocities = samples.windows(2).map(|pair| {
            velocity += 0.005 * (pair[0] + pair[1]);
            f64::abs(velocity)
        });
        velocities.fold(0.0, f64::max)
    };
    let scale = table.number(0, "scale");
    let uplift = 9.81 * 0.3 / 1.4;
    for (name, of, tolerance, block) in [
        ("PGA", &pga as &dyn Fn(&[f64]) -> f64, 1e-12, "PGA.RotD50/(g tan alpha)"),
        // The velocity may peak between samples.
        ("PGV", &pgv, 2e-3, "p PGV.RotD50/(g tan alpha)"),
    ] {
        let mut values: Vec<f64> = (0..180).map(|degrees| scale * of(&turned(degrees))).collect();
        let [x, y] = [values[0], values[90]];
        values.sort_by(f64::total_cmp);
        let median = 0.5 * (values[89] + values[90]);
        for (word, expected) in
            [("larger", x.max(y)), ("geomean", (x * y).sqrt()), ("RotD50", median), ("RotD100", values[179])]
        {
            let found = table.number(0, &format!("{name}.{word}"));
            assert!((found / expected - 1.0).abs() < tolerance, "{name}.{word} = {found}, not {expected}");
        }
        // p² = γ/(1 + γ) g/R0 of a homogeneous block.
        let p = (0.75 * 9.81 / 0.15_f64.hypot(0.7)).sqrt();
        let factor = if name == "PGA" { 1.0 } else { p };
        let found = table.number(0, block) / (factor * median / uplift);
        assert!((found - 1.0).abs() < tolerance, "{block}: {found}");
    }
}

/// The example runs as it stands, and its fragility curves name their limits.
#[test]
fn the_example_runs_and_its_curves_name_their_limits() {
    let folder = tempfile::tempdir().unwrap();
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/space/study.toml");
    stdout(folder.path(), &["sweep", study.to_str().unwrap(), "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    assert_eq!(table.rows.len(), 48);
    let fragility = |limit: &[&str]| {
        let line = [&["fragility", "s.csv", "--im", "PGV.RotD50", "--plot", "f.svg"], limit].concat();
        let printed = stdout(folder.path(), &line);
        let svg = std::fs::read_to_string(folder.path().join("f.svg")).unwrap();
        (printed, svg)
    };
    for (limit, word, picture) in [
        ("0.7", "tilt/alpha>0.7", "tilt above 0.7"),
        ("tilt:0.7", "tilt/alpha>0.7", "tilt above 0.7"),
        ("balance", "tilt/alpha>1", "tilt above 1"),
        ("twist:0.02", "twist>0.02", "twist above 0.02 rad"),
        ("slip:0.02", "slip>0.02", "slip above 0.02 m"),
        ("drift:0.1", "drift>0.1", "drift above 0.1 m"),
    ] {
        let (printed, svg) = fragility(&["--limit", limit]);
        assert!(printed.contains(&format!("limit         {word}: exceeded in ")), "{printed}");
        assert!(printed.contains("model         block in space"), "{printed}");
        assert!(printed.contains("for the only motion"), "{printed}");
        assert!(!printed.contains("overturn") && !svg.contains("overturning"), "{printed}");
        let words = labels(&svg).join("\n");
        assert!(words.contains(picture) && words.contains("blocks in space"), "{picture} is not in {words}");
    }
    // A former table has the tilt over that over the nearest edge, too.
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    let former = text.replacen("peak.twist", "peak.tilt/alpha_edge", 1);
    std::fs::write(folder.path().join("s.csv"), former).unwrap();
    let message = refusal(folder.path(), &["fragility", "s.csv", "--im", "PGV.RotD50"]);
    let expected = "s.csv: found the column peak.tilt/alpha_edge, of a former release; expected only peak.tilt/alpha";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn what_only_the_plane_has_is_refused_by_name() {
    for (old, new, expected) in [
        ("friction = 0.4", "friction = 0.4\ntie_1.stiffness = 1e5", "tie_1.stiffness is for a block in the plane"),
        (
            "eta = 50",
            "eta = 50\nepsilon = 0.1",
            "epsilon is for a block in the plane; in space feet land on their dashpots",
        ),
        (
            "eta = 50",
            "foundation = \"rigid\"",
            "foundation is for a block in the plane; in space a block stands on feet",
        ),
        ("eta = 50", "parameterization = \"physical\"", "parameterization is for a block in the plane"),
        ("eta = 50", "eta = 50\nomega_v = 80", "eta has no effect with omega_v"),
        ("eta = 50", "eta = 50\nstiffness = 80", "there is no parameter stiffness of a block in space"),
        ("eta = 50", "eta = -50", "eta = -50; expected a number > 0"),
        (
            "depth_ratio = [1, 1.6]",
            "kappa = 1",
            "kappa is for a block in space; expected depth, depth_ratio, base or feet",
        ),
        ("depth_ratio = [1, 1.6]", "base = \"hexagon\"", "base = \"hexagon\"; expected \"rectangle\" or \"circle\""),
        ("depth_ratio = [1, 1.6]", "base = \"circle\"\nfeet = 2", "feet = 2; expected a whole number from 3 to 64"),
        ("depth_ratio = [1, 1.6]", "feet = \"none.csv\"", "none.csv: cannot be read"),
        ("periods = [0.4]", "friction_demand = 0.3", "friction_demand is for a block in the plane"),
        ("x = \"a.csv\"", "horizontal = \"a.csv\"", "horizontal is for a block in the plane; expected x"),
        ("z = \"c.csv\"", "vertical = \"c.csv\"", "vertical is for a block in the plane; expected z"),
        ("z = \"c.csv\"", "z = \"a.csv\"", "z has the samples of x; expected each component once"),
        ("y = \"b.csv\"\nz = \"c.csv\"", "cut = true", "cut has no effect without y or z"),
        (
            "scales = [0.7, 1.5]",
            "levels = { im = \"PGV\", values = [0.3] }",
            "found the measure PGV; expected one of two components",
        ),
        ("[study]", "[building]\nfrequencies = [1]\n[study]", "building is for a block in the plane"),
        ("azimuths = [0, 30]", "azimuths = [0, 30, 0]", "each direction once"),
    ] {
        assert!(STUDY.contains(old), "{old}");
        let folder = folder(&STUDY.replacen(old, new, 1));
        let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
        assert!(message.contains(expected) && message.contains("study.toml:"), "{new}: {message}");
    }
    // Free motion has no direction.
    let (head, _) = STUDY.split_once("\n[[records]]").unwrap();
    let free = head.replace("scales = [0.7, 1.5]\nperiods = [0.4]", "").replace("eta", "initial.tilt_x = 0.05\neta");
    let folder = folder(&free);
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let expected = "study.toml:4: azimuths has no effect without a horizontal record or a pulse, which it turns";
    assert_eq!(message, expected);
    std::fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv", "--lanes", "4"]);
    assert_eq!(
        message,
        "--lanes has no effect on blocks in space, which are stepped one by one; expected --threads alone"
    );
    // Components of other lengths are cut only if the study says so.
    let text = std::fs::read_to_string(folder.path().join("b.csv")).unwrap();
    let shorter: String = text.lines().take(200).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.path().join("b.csv"), shorter).unwrap();
    std::fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    assert!(message.contains("cut = true in [[records]] cuts the components"), "{message}");
    std::fs::write(folder.path().join("study.toml"), STUDY.replace("unit =", "cut = true\nunit =")).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
}

/// Samples of an ensemble vary numbers of the block and count its limits.
#[test]
fn ensembles_vary_numbers_of_space() {
    let ensemble = "ensemble = { scale = 0.1, kappa = 0.2, seed = 3, samples = 4, limits = [0.6, \"twist:0.001\"] }";
    let study = STUDY.replace("periods = [0.4]", ensemble).replace("friction = 0.4", "friction = 0.4\nkappa = 0.8");
    let folder = folder(&study);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let exceeded = table.column("ensemble.tilt/alpha>0.6");
    assert!(exceeded.iter().any(|count| (1.0..4.0).contains(count)), "{exceeded:?}");
    assert!(table.column("P(twist>0.001)").iter().any(|p| *p > 0.0));
    std::fs::write(folder.path().join("study.toml"), study.replace("\nkappa = 0.8", "")).unwrap();
    let message = refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    assert!(message.contains("kappa of the ensemble has no value in [parameters]"), "{message}");
}

/// Curves of incremental dynamic analysis are one for each block, motion and direction, and their peaks are tilts.
#[test]
fn incremental_dynamic_analysis_has_a_curve_for_each_direction() {
    let study = STUDY.replace("scales = [0.7, 1.5]", "levels = { im = \"PGA.RotD100\", values = [1, 3, 6] }");
    let folder = folder(&study);
    let printed = stdout(folder.path(), &["ida", "study.toml", "--csv", "s.csv", "--plot", "ida.svg"]);
    assert!(printed.contains("model         block in space"), "{printed}");
    assert!(
        printed.contains("curves        8, ") && printed.contains("peak tilt over that of the balance that 16"),
        "{printed}"
    );
    let svg = std::fs::read_to_string(folder.path().join("ida.svg")).unwrap();
    let labels = labels(&svg);
    assert!(labels.contains(&"peak tilt over that of the balance".to_string()), "{labels:?}");
}

/// A circle, feet in a file beside the study, and a swept frequency have the runs of `simulate`, also under a pulse that turns.
#[test]
fn other_bases_are_those_of_simulate() {
    let circle = "base = \"circle\"\nfeet = 12\nalpha = 0.2\np = 2\nomega_v = [60, 120]\n";
    let feet =
        "feet = \"feet.csv\"\ncenter_height = 1.2\nmass = 500\ninertia_tensor = [200, 200, 60]\nomega_v = [60, 120]\n";
    for (parameters, options) in [
        (circle, "--base circle --feet 12 --alpha 0.2 --p 2"),
        (feet, "--feet feet.csv --center-height 1.2 --mass 500 --inertia-tensor 200,200,60"),
    ] {
        let study = format!(
            "[study]\ndesign = \"grid\"\nazimuths = [0, 25]\n[parameters]\n{parameters}\
             pulse = {{ shape = \"one-sine\", amplitude = 4, period = 0.6 }}\ninitial.twist = 0.1\n"
        );
        let folder = folder(&study);
        std::fs::write(folder.path().join("feet.csv"), "x,y,gap\n-0.3,-0.3,0\n0.3,-0.3,0\n0,0.35,0\n").unwrap();
        stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
        let table = Table::read(&folder.path().join("s.csv"));
        assert_eq!(table.rows.len(), 4);
        for row in 0..4 {
            let of = |name: &str| table.number(row, name);
            let line = format!(
                "simulate {options} --omega-v {} --azimuth {} --pulse one-sine --amplitude 4 --period 0.6 --twist 0.1 \
                 --tolerance 1e-6 --step 1e6 --on-separation fly --json --csv run.csv",
                of("omega_v"),
                of("azimuth")
            );
            let printed = stdout(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
            let run: Value = serde_json::from_str(&printed).unwrap();
            for peak in ["tilt", "twist", "slip", "drift"] {
                assert_eq!(number(&run["peak"][peak]), of(&format!("peak.{peak}")), "{peak} in row {row} of {options}");
            }
        }
        let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
        assert_eq!(text.contains("\n# feet.csv: 3 feet, crc32 "), parameters == feet, "{text}");
    }
}
