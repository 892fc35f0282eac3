//! `rocking search`, and the searches of the library.

use rocking_block::block::{Block, BlockError, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::{Initial, Settings};
use rocking_studies::run::Run;
use rocking_studies::run::outcome::End;
use rocking_studies::search::{Scan, damping_against_separation, overturning};

use crate::program::{RECORD, Table, files, refused, stdout};

/// No lanes; the module `lanes` compares results with and without them.
const WIDTH: Option<VectorWidth> = None;

const RIGID: Dimensionless = Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::HOUSNER };

fn with(xi_v: f64) -> Result<Block, BlockError> {
    let supports = Supports::Viscoelastic(Ratios { eta: 40.0, xi_v });
    Block::from_dimensionless(&Dimensionless { supports, ..RIGID }, &Common::default())
}

fn end(block: &Block, initial: Initial, pulse: Pulse, duration: f64) -> End {
    let (settings, ground) = (Settings::default(), Ground::default());
    let duration = Some(duration);
    Run { block: *block, settings, initial, pulse, ground, duration, output_step: f64::INFINITY }.outcome().end
}

/// Blocks on both sides of each change have the outcomes found, and separate below the damping needed.
#[test]
fn damping_against_separation_brackets_the_change() {
    let scan = Scan { from: 0.0, to: 0.4, points: 9, resolution: 1e-4 };
    let found =
        damping_against_separation(&with(0.1).unwrap(), 0.95, Settings::default(), &scan, WIDTH, &|_, _| ()).unwrap();
    assert!(!found.changes.is_empty());
    for change in &found.changes {
        assert!(change.above - change.below <= scan.resolution && change.below < change.above);
        for (xi_v, expected) in [(change.below, change.from), (change.above, change.to)] {
            let block = with(xi_v).unwrap();
            let initial = Initial { theta_dot: 0.95 * 0.25, ..Initial::default() };
            assert_eq!(end(&block, initial, Pulse::NONE, 50.0), expected, "xi_v = {xi_v}");
        }
    }
    assert_eq!((found.first, found.last), ((0.0, End::Separated), (0.4, End::Completed)));
    let needed = found.least_without(End::Separated).unwrap();
    let last = found.changes.iter().rfind(|change| change.from == End::Separated).unwrap();
    assert_eq!(needed, last.above);
}

/// On a rigid base the block stands, overturns, stands again under a stronger pulse, and overturns for good.
#[test]
fn overturning_is_found_with_the_island_above_it() {
    let block = Block::from_dimensionless(&RIGID, &Common::default()).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 0.0, period: 1.2566, start: 0.0, ..Pulse::NONE };
    let scan = Scan { from: 5.0, to: 20.0, points: 16, resolution: 1e-6 };
    let found = overturning(&Run { pulse, ..Run::at_rest(block, Settings::default()) }, &scan, WIDTH, &|_, _| ());
    let ends: Vec<End> = found.stretches().iter().map(|stretch| stretch.2).collect();
    assert_eq!(ends, [End::Completed, End::Overturned, End::Completed, End::Overturned]);
    for change in &found.changes {
        assert!(change.above - change.below <= scan.resolution);
        for (amplitude, expected) in [(change.below, change.from), (change.above, change.to)] {
            // Twice the duration of the search settles the outcome.
            let duration = 2.0 * (1.2566 + 50.0);
            assert_eq!(end(&block, Initial::default(), Pulse { amplitude, ..pulse }, duration), expected);
        }
    }
    assert_eq!(found.least(End::Overturned), Some(found.changes[0].above));
}

/// Similarity of the rigid block: scaling p and 1/T_p by one factor leaves the least overturning amplitude.
#[test]
fn similar_blocks_overturn_at_the_same_amplitude() {
    let least = |p: f64| {
        let block = Block::from_dimensionless(&Dimensionless { p, ..RIGID }, &Common::default()).unwrap();
        let pulse = Pulse { shape: PulseShape::OneCosine, amplitude: 0.0, period: 3.0 / p, start: 0.0, ..Pulse::NONE };
        let scan = Scan { from: 2.0, to: 20.0, points: 10, resolution: 1e-5 };
        overturning(&Run { pulse, ..Run::at_rest(block, Settings::default()) }, &scan, WIDTH, &|_, _| ())
            .least(End::Overturned)
            .unwrap()
    };
    assert!((least(0.8) - least(2.4)).abs() < 3e-5, "{} and {}", least(0.8), least(2.4));
}

#[test]
fn the_program_prints_the_result_of_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["search", "damping", "--alpha", "0.25", "--p", "1", "--to", "0.4", "--points", "9", "--resolution", "1e-4"];
    let one = stdout(folder.path(), &[&arguments[..], &["--threads", "1", "--csv", "d.csv"]].concat());
    let two = stdout(folder.path(), &[&arguments[..], &["--threads", "2"]].concat());
    assert_eq!(one, two);
    let scan = Scan { from: 0.0, to: 0.4, points: 9, resolution: 1e-4 };
    let found =
        damping_against_separation(&with(0.1).unwrap(), 0.95, Settings::default(), &scan, WIDTH, &|_, _| ()).unwrap();
    let needed = found.least_without(End::Separated).unwrap();
    // Four decimals, as fine as the resolution.
    assert!(one.contains(&format!("no separation from xi_v = {needed:.4} to 0.4\n")), "{one}");
    assert!(one.contains(&format!("xi_v = {needed:.4} to 0.4: ")), "{one}");
    assert!(one.contains("9 values, 0.05 apart") && one.contains("within 0.0001"), "{one}");
    let table = Table::read(&folder.path().join("d.csv"));
    let stretches = found.stretches();
    assert_eq!(table.rows.len(), stretches.len());
    for (row, (from, to, end)) in stretches.iter().enumerate() {
        assert_eq!((table.number(row, "from"), table.number(row, "to")), (*from, *to));
        assert_eq!(table.get(row, "outcome"), end.to_string());
    }
    let printed =
        stdout(folder.path(), &["search", "damping", "--alpha", "0.25", "--p", "1", "--to", "0.02", "--points", "2"]);
    assert!(printed.contains("separation even at xi_v = 0.02"), "{printed}");
}

/// Records are searched over their scale factor; `rocking simulate` confirms the outcomes on both sides of each change.
#[test]
fn records_are_searched_over_their_scale() {
    let folder = tempfile::tempdir().unwrap();
    let block = ["--record", RECORD, "--vertical", RECORD, "--alpha", "0.15", "--p", "2"];
    let range = ["--from", "1.5", "--to", "3.5", "--points", "5", "--resolution", "1e-3", "--csv", "o.csv"];
    let printed = stdout(folder.path(), &[&["search", "overturning"], &block[..], &range].concat());
    let table = Table::read(&folder.path().join("o.csv"));
    assert_eq!((table.number(0, "from"), table.get(0, "outcome")), (1.5, "completed"));
    let row = (0..table.rows.len()).find(|&row| table.get(row, "outcome") == "overturned").unwrap();
    let least = table.number(row, "from");
    assert_ne!(table.get(row, "from"), format!("{least:.3}"), "the table has all digits");
    assert!(printed.contains(&format!("first overturning at scale = {least:.3}\n")), "{printed}");
    let run = [&["simulate", "--on-separation", "fly", "--csv", "x.csv"], &block[..]].concat();
    for row in 0..table.rows.len() {
        let words = match table.get(row, "outcome") {
            "overturned" => "overturning",
            word => word,
        };
        for scale in ["from", "to"].map(|column| table.get(row, column)) {
            let printed = stdout(folder.path(), &[&run[..], &["--scale", scale]].concat());
            assert!(printed.contains(words), "{words} at {scale}: {printed}");
        }
    }
}

/// Without a duration `simulate` agrees with `search` on both sides of the least overturning amplitude.
///
/// A block that falls slowly is not reported as standing.
#[test]
fn simulate_and_search_agree() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = ["--alpha", "0.25", "--p", "1", "--pulse", "one-sine", "--period", "1.2566"];
    let range = ["--foundation", "rigid", "--from", "6", "--to", "8", "--points", "3", "--csv", "o.csv"];
    stdout(folder.path(), &[&["search", "overturning"], &pulse[..], &range].concat());
    let table = Table::read(&folder.path().join("o.csv"));
    let words =
        ["completed", "overturned"].map(|word| (0..table.rows.len()).find(|&row| table.get(row, "outcome") == word));
    let [Some(below), Some(above)] = words else { panic!("{:?}", table.rows) };
    let rigid = ["--foundation", "rigid", "--csv", "x.csv"];
    for (amplitude, words) in
        [(table.get(below, "to"), "completed at"), (table.get(above, "from"), "overturning, with")]
    {
        let printed = stdout(folder.path(), &[&["simulate", "--amplitude", amplitude], &pulse[..], &rigid].concat());
        assert!(printed.contains(words), "{words} at {amplitude}: {printed}");
    }
    let slow = ["simulate", "--alpha", "0.25", "--p", "1", "--pulse", "one-sine", "--amplitude", "14", "--period", "1"];
    let printed = stdout(folder.path(), &[&slow[..], &rigid].concat());
    assert!(printed.contains("overturning, with complete separation at t = 8.1424 s"), "{printed}");
    // A short duration leaves the outcome undecided.
    let printed = stdout(folder.path(), &[&slow[..], &rigid, &["--duration", "5"]].concat());
    assert!(printed.contains("undecided at t = 5.0000 s: the duration is too short"), "{printed}");
}

/// Progress counts every run once and ends with all runs done.
#[test]
fn progress_ends_with_all_runs_done() {
    let scan = Scan { from: 0.0, to: 0.4, points: 9, resolution: 1e-3 };
    let progressed = std::sync::Mutex::new(Vec::new());
    let progress = |done, runs| progressed.lock().unwrap().push((done, runs));
    damping_against_separation(&with(0.1).unwrap(), 0.95, Settings::default(), &scan, WIDTH, &progress).unwrap();
    let mut progressed = progressed.into_inner().unwrap();
    progressed.sort_unstable();
    assert!(progressed.iter().map(|run| run.0).eq(1..=progressed.len() as u64));
    assert!(progressed[..9].iter().all(|run| run.1 == 9) && progressed.iter().all(|(done, runs)| done <= runs));
    let (done, runs) = progressed[progressed.len() - 1];
    assert_eq!(done, runs, "the number of bisections follows from the width of the change");
}

/// On supports the search begins at zero, since blocks overturn below g tan α; a range above the least value bounds it.
#[test]
fn a_least_value_is_exact_or_reported_as_a_bound() {
    let folder = tempfile::tempdir().unwrap();
    let search = |arguments: &[&str]| {
        let printed = stdout(folder.path(), &[&["search"], arguments, &["--resolution", "1e-4", "--json"]].concat());
        let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
        let [bound, answer] = ["bound", "answer"].map(|name| json[name].as_str().unwrap().to_string());
        (json["least"].as_f64(), bound, answer)
    };
    let block = ["--alpha", "0.2", "--p", "4", "--eta", "30", "--xi-v", "0.3", "--period", "0.8"];
    let overturning = |more: &[&str]| search(&[&["overturning"], &block[..], more].concat());
    let static_limit = 9.81 * 0.2_f64.tan();
    let (found, bound, _) = overturning(&["--points", "41"]);
    assert!((found.unwrap() - 1.9153).abs() < 2e-4 && found.unwrap() < static_limit, "{found:?}");
    assert_eq!(bound, "none");
    let least = found.unwrap().to_string();
    for (from, expected) in [("1.98", "upper"), ("0.5", "none")] {
        let (value, bound, answer) = overturning(&["--from", from, "--to", "3", "--points", "11"]);
        assert_eq!(bound, expected);
        assert_eq!(answer.contains("at most"), expected == "upper", "{answer}");
        assert!(value.unwrap() >= found.unwrap() - 1e-4, "{value:?} beside {least}");
    }
    let (value, bound, answer) = overturning(&["--to", "1", "--points", "5"]);
    assert_eq!((value, bound.as_str()), (None, "lower"));
    assert!(answer.starts_with("no overturning from a_p = 0"), "{answer}");
    // On a rigid base no block rocks below g tan α, unless vertical motion reduces its weight.
    let stretches = |more: &[&str]| {
        let block =
            ["overturning", "--record", RECORD, "--foundation", "rigid", "--points", "3", "--resolution", "0.1"];
        stdout(folder.path(), &[&["search"], &block[..], more, &["--json"]].concat())
    };
    assert!(!stretches(&[]).contains("\"from\":0,") && stretches(&["--vertical", RECORD]).contains("\"from\":0.0,"));
    let (value, bound, answer) = search(&["damping", "--alpha", "0.25", "--p", "1", "--from", "0.5", "--points", "3"]);
    assert_eq!((value, bound.as_str()), (Some(0.5), "upper"));
    assert!(answer.contains("at most"), "{answer}");
}

/// A block in space that turns with its pulse overturns at the same amplitude, and `simulate` confirms both sides of the least one.
#[test]
fn blocks_in_space_are_searched_along_an_azimuth() {
    let folder = tempfile::tempdir().unwrap();
    let block = |width: &str, depth: &str| {
        format!(
            "--width {width} --depth {depth} --height 2 --omega-v 150 --xi-v 0.2 --friction 0.6 --pulse one-sine --period 0.5"
        )
    };
    let search = |of_block: &str, azimuth: &str| {
        let line = format!(
            "search overturning {of_block} --azimuth {azimuth} --points 31 --resolution 1e-4 --csv o.csv --json"
        );
        let printed = stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
        serde_json::from_str::<serde_json::Value>(&printed).unwrap()["least"].as_f64().unwrap()
    };
    let (across, along) = (block("0.4", "0.8"), block("0.8", "0.4"));
    let weak = search(&across, "0");
    assert!((weak - search(&along, "90")).abs() < 2e-4, "{weak}");
    let strong = search(&across, "90");
    assert!(strong > 2.0 * weak, "{strong}, {weak}");
    let table = Table::read(&folder.path().join("o.csv"));
    for (row, column, outcome) in [(0, "to", "completed"), (1, "from", "overturning")] {
        let amplitude = table.get(row, column);
        let line =
            format!("simulate {across} --azimuth 90 --amplitude {amplitude} --tolerance 1e-6 --step 1e6 --csv x.csv");
        let printed = stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
        assert!(printed.contains(outcome), "{amplitude}: {printed}");
    }
    for (more, expected) in [
        ("--lanes 4", "--lanes has no effect for blocks in space"),
        ("--foundation rigid", "--foundation rigid is for a block in the plane"),
        ("--epsilon 0.5", "--epsilon is for a block in the plane"),
    ] {
        let line = format!("search overturning {across} {more}");
        refused(folder.path(), &line.split(' ').collect::<Vec<_>>(), &[expected]);
    }
    let plane = ["search", "overturning", "--period", "0.5", "--azimuth", "30"];
    refused(folder.path(), &plane, &["--azimuth has no effect without one of --depth"]);
}

/// Both components of a motion are searched with one factor, from zero on; `simulate` confirms both sides of the least one.
#[test]
fn pairs_are_searched_over_their_scale() {
    let folder = tempfile::tempdir().unwrap();
    for (name, frequency) in [("x", 9.0), ("y", 7.0)] {
        let row = |i: i32| {
            let t = f64::from(i) * 0.01;
            format!("{t},{}\n", (t * std::f64::consts::PI / 2.0).sin() * (frequency * t).sin())
        };
        let text = format!("t [s],a [m/s2]\n{}", (0..200).map(row).collect::<String>());
        std::fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    let block = "--width 0.3 --depth 0.5 --height 1.6 --eta 60 --xi-v 0.2 --record x.csv --record-y y.csv --azimuth 20";
    let line = format!("search overturning {block} --points 21 --resolution 1e-3 --csv o.csv");
    let printed = stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
    assert!(printed.starts_with("model         block in space\nscale = 0 to "), "{printed}");
    let table = Table::read(&folder.path().join("o.csv"));
    for (row, column, outcome) in [(0, "to", "completed"), (1, "from", "overturning")] {
        let scale = table.get(row, column);
        let line = format!("simulate {block} --scale {scale} --tolerance 1e-6 --step 1e6 --csv run.csv");
        let printed = stdout(folder.path(), &line.split(' ').collect::<Vec<_>>());
        assert!(printed.contains(outcome), "{scale}: {printed}");
    }
    // Up to ten times a PGA of g tan α over the nearest edge, of both components together.
    let last = table.rows.len() - 1;
    let both: f64 = (0..200)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            (t * std::f64::consts::PI / 2.0).sin().abs() * (9.0 * t).sin().hypot((7.0 * t).sin())
        })
        .fold(0.0, f64::max);
    assert!((table.number(last, "to") * both / (98.1 * 0.15 / 0.8) - 1.0).abs() < 1e-12);
}

#[test]
fn wrong_ranges_and_excitations_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &[&str]); 8] = [
        (&["damping", "--from", "0.5", "--to", "0.1"], &["--to = 0.1", "--from = 0.5"]),
        (&["damping", "--from=-0.5"], &["xi_v = -0.5"]),
        (&["damping", "--eta", "0"], &["eta = 0"]),
        (&["damping", "--resolution", "0"], &["--resolution = 0"]),
        (&["overturning", "--period", "0"], &["--period = 0"]),
        (&["overturning", "--period", "1", "--pulse", "none"], &["--pulse none"]),
        (&["overturning", "--record", "none.at2"], &["none.at2"]),
        (&["overturning", "--period", "1", "--vertical", RECORD], &["--vertical without --record"]),
    ];
    for (arguments, words) in cases {
        refused(folder.path(), &[&["search"], arguments, &["--csv", "x.csv"]].concat(), words);
        assert!(files(folder.path()).is_empty());
    }
}
