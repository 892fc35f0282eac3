//! `rocking spectrum`.

use std::path::Path;

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, Settings};
use rocking_studies::run::Run;
use rocking_studies::run::outcome::End;
use rocking_studies::spectrum::{FoundationCurve, Sizes};

use crate::program::{Table, files, refused, rocking, stdout, text};
use crate::studies::{PULSE, labels, resumes_to_the_same_bytes};

/// Few blocks; some separate, some overturn, and some rock.
const FEW: [&str; 6] = ["--points", "9", "--p-min", "0.6", "--p-max", "6"];

fn spectrum<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["spectrum"], &PULSE[..], &FEW[..], more].concat()
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for threads in ["1", "2", "7"] {
        stdout(folder.path(), &spectrum(&["--csv", &format!("{threads}.csv"), "--threads", threads]));
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("1.csv") == read("2.csv"));
    assert!(read("1.csv") == read("7.csv"));
}

#[test]
fn an_interrupted_spectrum_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &spectrum(&["--csv", "whole.csv"]));
    resumes_to_the_same_bytes(folder.path(), &spectrum(&[]), "whole.csv");
}

/// A resumed row that the picture needs is refused with its place, and the table stays as it was.
#[test]
fn a_resumed_row_with_a_bad_number_is_named() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &spectrum(&["--csv", "a.csv"]));
    let path = folder.path().join("a.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let row = text.lines().find(|line| line.starts_with("3,")).unwrap();
    let size = Table::read(&path).get(3, "p [rad/s]").to_string();
    for bad in ["much", "NaN"] {
        let damaged = text.replace(row, &row.replace(&size, bad));
        std::fs::write(&path, &damaged).unwrap();
        let expected = format!("row 3 has p [rad/s] = {bad}; expected a number");
        let again = ["--csv", "a.csv", "--plot", "a.svg", "--resume"];
        refused(folder.path(), &spectrum(&again), &["a.csv", &expected]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), damaged);
    }
}

/// A picture of an existing table equals that of a new one.
#[test]
fn a_complete_spectrum_can_be_drawn_again() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &spectrum(&["--csv", "a.csv", "--plot", "a.svg"]));
    stdout(folder.path(), &spectrum(&["--csv", "a.csv", "--plot", "b.svg", "--resume"]));
    stdout(folder.path(), &spectrum(&["--csv", "a.csv", "--plot", "c.png", "--resume", "--over", "2pi/p"]));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert_eq!(svg, std::fs::read_to_string(folder.path().join("b.svg")).unwrap());
    let labels = labels(&svg);
    for label in ["peak |θ|/α", "ωp/p", "η = 40, ξv = 0.1, ε = 0", "rigid base", "overturning"] {
        assert!(labels.iter().any(|drawn| drawn == label), "{label} is not in the picture: {labels:?}");
    }
    assert_eq!(&std::fs::read(folder.path().join("c.png")).unwrap()[..8], b"\x89PNG\r\n\x1a\n");
}

/// Each row equals the single run to the last digit, in the library and in `rocking simulate`.
#[test]
fn rows_equal_single_runs() {
    let folder = tempfile::tempdir().unwrap();
    let bases = ["--foundation", "40,0.1,0", "--foundation", "rigid", "--foundation", "60,0.1,0.4"];
    stdout(folder.path(), &spectrum(&[&bases[..], &["--csv", "s.csv", "--on-separation", "terminate"]].concat()));
    let table = Table::read(&folder.path().join("s.csv"));
    assert_eq!(table.rows.len(), 27);
    let mut words = Vec::new();
    for row in 0..27 {
        let rigid = table.get(row, "foundation") == "rigid";
        assert_eq!(rigid, row / 9 == 1);
        let (eta, epsilon) = [(40.0, 0.0), (40.0, 0.0), (60.0, 0.4)][row / 9];
        let p = table.number(row, "p [rad/s]");
        let sizes = Sizes { least: 0.6, greatest: 6.0, count: 9 };
        assert_eq!(p, sizes.p(row as u64 % 9));
        assert!((table.number(row, "2pi/p [s]") * p / std::f64::consts::TAU - 1.0).abs() < 1e-15);
        assert!((table.number(row, "omega_p/p [1]") * p / 5.0 - 1.0).abs() < 1e-15);
        let foundation = if rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
        let d = Dimensionless { alpha: 0.25, p, supports: Supports::of(foundation, Ratios { eta, xi_v: 0.1 }) };
        let common = Common { epsilon, ..Common::default() };
        let run = Run {
            block: Block::from_dimensionless(&d, &common).unwrap(),
            settings: Settings { tolerance: Settings::OF_STUDIES, ..Settings::default() },
            initial: Initial::default(),
            pulse: Pulse {
                shape: PulseShape::OneSine,
                amplitude: 6.2622,
                period: 1.2566370614359172,
                start: 0.0,
                ..Pulse::NONE
            },
            ground: Ground::default(),
            duration: None,
            output_step: f64::INFINITY,
        };
        let history = run.history(|_| ()).unwrap();
        let p = table.get(row, "p [rad/s]");
        let base = if rigid { "rigid" } else { "viscoelastic" };
        let mut block = vec!["--p", p, "--foundation", base, "--csv", "x.csv", "--tolerance", "1e-6"];
        if row >= 18 {
            block.extend(["--eta", "60", "--epsilon", "0.4"]);
        }
        let printed = stdout(folder.path(), &[&["simulate"], &PULSE[..], &block].concat());
        let word = table.get(row, "outcome");
        words.push(word.to_string());
        let peak = table.number(row, "peak.theta/alpha [1]");
        assert_eq!(peak, history.peaks.theta / 0.25);
        assert_eq!(table.number(row, "peak.N [N]"), history.peaks.reaction);
        assert!(printed.contains(&format!("|θ|/α = {peak:.4},")), "{peak} is not in: {printed}");
        let end_time = table.number(row, "end_time [s]");
        match history.ending {
            None => {
                assert_eq!(end_time, history.rows[history.rows.len() - 1].time);
                assert!(
                    word == "completed" && printed.contains(&format!("completed at t = {end_time:.4} s: the block "))
                );
            }
            Some((ending, time)) => {
                assert_eq!(end_time, time);
                assert_eq!(word, if ending.is_overturning() { "overturned" } else { "separated" });
                assert!(printed.contains(&format!("{ending} at t = {time:.4} s")), "{printed}");
            }
        }
        let separated = history.ending.is_some_and(|(ending, _)| ending.is_separation());
        assert_eq!(table.get(row, "flights [1]"), if separated { "1" } else { "0" });
        assert_eq!(
            table.get(row, "first_separation [s]"),
            if separated { end_time.to_string() } else { String::new() }
        );
    }
    // The test needs all three outcomes.
    for end in [End::Completed, End::Separated, End::Overturned] {
        assert!(words.iter().any(|word| word == end.word()), "no block {end}: {words:?}");
    }
}

/// By default blocks fly, as in `rocking simulate --on-separation fly`; without separation the rows do not change.
#[test]
fn blocks_that_separate_fly() {
    let folder = tempfile::tempdir().unwrap();
    let hard = ["--foundation", "60,0.1,0.4"];
    stdout(folder.path(), &spectrum(&[&hard[..], &["--csv", "end.csv", "--on-separation", "terminate"]].concat()));
    stdout(folder.path(), &spectrum(&[&hard[..], &["--csv", "fly.csv"]].concat()));
    let [end, fly] = ["end.csv", "fly.csv"].map(|name| Table::read(&folder.path().join(name)));
    let (mut landed, mut at_once) = (0, 0);
    for row in 0..9 {
        if end.get(row, "flights [1]") == "0" {
            assert_eq!(fly.rows[row], end.rows[row]);
            continue;
        }
        // A corner without reaction may slide on its support before it leaves it (docs/unit/model.md).
        let (first, time) = (fly.get(row, "first_separation [s]"), end.number(row, "end_time [s]"));
        at_once += usize::from(first.parse() == Ok(time));
        assert!(first.is_empty() || first.parse::<f64>().unwrap() >= time);
        if end.get(row, "outcome") == "overturned" {
            assert_eq!(fly.get(row, "outcome"), "overturned");
            continue;
        }
        let block = ["--eta", "60", "--epsilon", "0.4", "--p", fly.get(row, "p [rad/s]")];
        let printed = stdout(
            folder.path(),
            &[&["simulate"], &PULSE[..], &block, &["--on-separation", "fly", "--csv", "x.csv"]].concat(),
        );
        let peak = fly.number(row, "peak.theta/alpha [1]");
        assert!(printed.contains(&format!("|θ|/α = {peak:.4},")), "{peak}: {printed}");
        if fly.get(row, "outcome") == "completed" {
            landed += 1;
            assert!(printed.contains("completed at"), "{printed}");
        }
    }
    assert!(landed > 0 && at_once > 0, "{landed}, {at_once}");
}

/// Writes a horizontal record, and a vertical one that matters.
fn records(folder: &Path) {
    let sample = |i: u32, a: f64, f: f64| a * (f * 0.02 * f64::from(i)).sin();
    let text = |a: f64, f: f64| (0..100).map(|i| format!("{}\n", sample(i, a, f))).collect::<String>();
    std::fs::write(folder.join("h.csv"), text(4.0, 5.0)).unwrap();
    std::fs::write(folder.join("v.csv"), text(2.0, 17.0)).unwrap();
}

#[test]
fn a_record_with_and_without_its_vertical_component() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let unit = ["--unit", "m/s2", "--dt", "0.02", "--points", "3", "--p-max", "2", "--foundation", "40,0.4,0"];
    let both = [&["spectrum", "--record", "h.csv", "--vertical", "v.csv"], &unit[..]].concat();
    stdout(folder.path(), &[&both[..], &["--also-horizontal", "--csv", "both.csv", "--plot", "both.svg"]].concat());
    stdout(folder.path(), &[&["spectrum", "--record", "h.csv"], &unit[..], &["--csv", "one.csv"]].concat());
    let (both, one) = (Table::read(&folder.path().join("both.csv")), Table::read(&folder.path().join("one.csv")));
    assert_eq!((both.rows.len(), one.rows.len()), (6, 3));
    for row in 0..3 {
        assert_eq!(both.rows[row], one.rows[row]);
        assert_eq!(both.get(row, "omega_p/p [1]"), "");
        assert_eq!(both.get(row + 3, "motion"), "horizontal + vertical");
        let peaks = [row, row + 3].map(|row| both.number(row, "peak.theta/alpha [1]"));
        assert!((peaks[0] - peaks[1]).abs() > 1e-3 * peaks[0], "{peaks:?}");
    }
    let labels = labels(&std::fs::read_to_string(folder.path().join("both.svg")).unwrap());
    for label in ["2π/p (s)", "η = 40, ξv = 0.4, ε = 0; horizontal + vertical"] {
        assert!(labels.iter().any(|drawn| drawn == label), "{label} is not in the picture: {labels:?}");
    }
}

#[test]
fn foundations_of_curves_are_read_as_they_are_written() {
    for base in [
        FoundationCurve::HOUSNER,
        FoundationCurve::rigid(0.2, 1.0),
        FoundationCurve::rigid(0.0, 0.95),
        FoundationCurve::viscoelastic(40.0, 0.1, 0.5),
    ] {
        assert_eq!(base.to_string().parse(), Ok(base));
        assert_eq!(base.to_string().to_uppercase().parse(), Ok(base));
    }
}

/// `rigid,EPSILON,FACTOR`, `simulate` and a study file with the same factor describe the same block.
#[test]
fn the_restitution_factor_is_the_same_to_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let bases = ["--foundation", "rigid,0,0.9", "--foundation", "rigid,0.3"];
    stdout(folder.path(), &spectrum(&[&bases[..], &["--csv", "s.csv"]].concat()));
    let table = Table::read(&folder.path().join("s.csv"));
    let study = "[study]\ndesign = \"grid\"\n[parameters]\nfoundation = \"Rigid\"\nrestitution_factor = 0.9\n\
                 dimensionless.alpha = 0.25\ndimensionless.p = [6, 0.6]\npulse.shape = \"OneSine\"\npulse.amplitude = 6.2622\n\
                 pulse.period = 1.2566370614359172\n";
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "w.csv"]);
    let swept = Table::read(&folder.path().join("w.csv"));
    let mut impacts = 0.0;
    for (row, of_sweep) in [(0, 0), (8, 1)] {
        assert_eq!((table.number(row, "restitution_factor [1]"), table.get(row, "eta [1]")), (0.9, ""));
        assert_eq!(table.number(row + 9, "restitution_factor [1]"), 1.0);
        for column in ["p [rad/s]", "end_time [s]", "peak.theta/alpha [1]", "events.impacts [1]"] {
            assert_eq!(table.get(row, column), swept.get(of_sweep, column), "{column} in row {row}");
        }
        impacts += table.number(row, "events.impacts [1]");
        // Housner's e = 1 − 3/2 sin² α.
        let e = 0.9 * (1.0 - 1.5 * 0.25_f64.sin().powi(2));
        let simulate = ["simulate", "--foundation", "rigid", "--restitution-factor", "0.9", "--on-separation", "fly"];
        let of_row = ["--csv", "x.csv", "--p", table.get(row, "p [rad/s]")];
        let printed = stdout(folder.path(), &[&simulate[..], &PULSE, &of_row].concat());
        assert!(printed.contains(&format!("e = {e:.4}, 0.9 × Housner's")), "{printed}");
        assert!(printed.contains(&format!("|θ|/α = {:.4}", table.number(row, "peak.theta/alpha [1]"))), "{printed}");
    }
    assert!(impacts > 2.0, "{impacts}");
}

#[test]
fn a_restitution_factor_without_effect_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let factor = ["--restitution-factor", "0.9", "--csv", "x.csv"];
    refused(folder.path(), &[&["simulate"], &factor[..]].concat(), &["--restitution-factor", "--foundation rigid"]);
    let output = rocking(folder.path(), &[&["search", "overturning", "--period", "1"], &factor[..]].concat());
    assert!(!output.status.success() && text(&output.stderr).contains("--foundation rigid"));
    let beyond = "search overturning --period 1 --alpha 0.25 --foundation rigid --restitution-factor 1.2";
    refused(
        folder.path(),
        &beyond.split(' ').collect::<Vec<_>>(),
        &["restitution_factor = 1.2", "e = 0.908", "1.0898"],
    );
}

#[test]
fn a_table_of_another_study_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &spectrum(&["--csv", "s.csv"]));
    let path = folder.path().join("s.csv");
    let whole = std::fs::read_to_string(&path).unwrap();
    let go_on = |more: &[&'static str]| spectrum(&[&["--csv", "s.csv", "--resume"], more].concat());
    refused(folder.path(), &spectrum(&["--csv", "s.csv"]), &["s.csv: exists already", "--resume"]);
    refused(
        folder.path(),
        &[&["spectrum", "--alpha", "0.2"], &PULSE[2..], &FEW, &["--csv", "s.csv", "--resume"]].concat(),
        &["s.csv:2:", "found `# alpha = 0.25", "expected `# alpha = 0.2,"],
    );
    refused(folder.path(), &go_on(&["--foundation", "40,0.2,0"]), &["s.csv:4:", "found `# foundation 40,0.1,0`"]);
    refused(folder.path(), &go_on(&["--tolerance", "1e-9"]), &["tolerance = 1e-6", "tolerance = 1e-9"]);
    refused(
        folder.path(),
        &go_on(&["--on-separation", "terminate"]),
        &["on_separation = Fly", "on_separation = Terminate"],
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
    // The table of a running study.
    let file = std::fs::File::open(&path).unwrap();
    file.lock().unwrap();
    refused(folder.path(), &go_on(&[]), &["s.csv: is being written"]);
    file.unlock().unwrap();
    // Wrong rows: one missing, one too many, one without its last column.
    let lines: Vec<&str> = whole.lines().collect();
    let row = lines.iter().position(|line| line.starts_with("3,")).unwrap();
    let without = [&lines[..row], &lines[row + 1..]].concat();
    let more = [&lines[..], &["18,more"]].concat();
    let shorter = lines[row].rsplit_once(',').unwrap().0;
    let cut = [&lines[..row], &[shorter], &lines[row + 1..]].concat();
    let cases = [(without, "expected row 3"), (more, "at most 18"), (cut, "21 columns")];
    for (lines, words) in cases {
        let text = lines.join("\n") + "\n";
        std::fs::write(&path, &text).unwrap();
        refused(folder.path(), &go_on(&[]), &["s.csv", words]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }
}

/// A number edited in a table is refused with its file, row and column, for statistics and for a picture.
#[test]
fn edited_numbers_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &spectrum(&["--csv", "s.csv"]));
    let path = folder.path().join("s.csv");
    let whole = std::fs::read_to_string(&path).unwrap();
    let heading = whole.lines().find(|line| line.starts_with("row,")).unwrap();
    let row = whole.lines().find(|line| line.starts_with("3,")).unwrap();
    for (column, found) in
        [("peak.theta/alpha [1]", "0.1.2"), ("flights [1]", "x"), ("outcome", "stood"), ("2pi/p [s]", "nan")]
    {
        let place = heading.split(',').position(|name| name == column).unwrap();
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[place] = found;
        std::fs::write(&path, whole.replace(row, &fields.join(","))).unwrap();
        let options = ["--csv", "s.csv", "--resume", "--over", "2pi/p", "--plot", "s.svg"];
        refused(folder.path(), &spectrum(&options), &["s.csv: ", "row 3", column, found, "expected"]);
    }
}

/// A pulse that ends before a run without a record starts is said once; with a record the run starts with the pulse.
#[test]
fn a_pulse_before_the_start_is_said() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("still.csv"), "t,a\n0,0\n0.01,0\n0.02,0\n").unwrap();
    let pulse = ["--pulse", "one-sine", "--amplitude", "6", "--period", "0.5", "--start", "-1"];
    let still = ["--record", "still.csv", "--unit", "m/s2"];
    let simulate = ["simulate", "--foundation", "rigid"];
    let spectrum = ["spectrum", "--points", "3", "--csv", "s.csv", "--force"];
    for command in [&simulate[..], &spectrum] {
        for record in [&[][..], &still] {
            let output = rocking(folder.path(), &[command, &pulse, record].concat());
            let said = text(&output.stderr);
            assert!(output.status.success(), "{said}");
            let times = said.matches("the pulse ends at -0.5 s, before the run starts").count();
            assert_eq!(times, usize::from(record.is_empty()), "{command:?} {record:?}: {said}");
        }
    }
}

#[test]
fn wrong_spectra_are_refused_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &[&str]); 10] = [
        (&["--foundation", "40,0.1"], &["--foundation 40,0.1", "ETA,XI_V,EPSILON"]),
        (&["--foundation", "rigid,0.1,1,0"], &["--foundation rigid,0.1,1,0", "rigid,EPSILON,FACTOR"]),
        (&["--foundation", "rigid,0,1.2"], &["restitution_factor = 1.2", "e = 0.9", "1.08", "at most 1"]),
        (&["--foundation", "40,0.1,1.5"], &["epsilon = 1.5", "0 <= epsilon <= 1"]),
        (&["--foundation", "-1,0.1,0"], &["eta = -1"]),
        (&["--alpha", "2"], &["alpha = 2"]),
        (&["--p-min", "7"], &["--p-max = 6", "above --p-min"]),
        (&["--step", "0"], &["--step = 0"]),
        (&["--plot", "s.jpeg"], &[".jpeg"]),
        (&["--plot", "none/s.png"], &["none/s.png"]),
    ];
    for (more, words) in cases {
        let arguments = spectrum(&["--csv", "s.csv"]);
        // The tested value replaces the default one, since clap refuses repeated options.
        let kept = arguments.iter().position(|argument| *argument == more[0]);
        let mut arguments = arguments.clone();
        if let Some(place) = kept {
            arguments.drain(place..place + 2);
        }
        refused(folder.path(), &[&arguments[..], more].concat(), words);
        assert!(files(folder.path()).is_empty(), "{more:?} left {:?}", files(folder.path()));
    }
    refused(
        folder.path(),
        &["spectrum", "--csv", "s.csv"],
        &["no excitation; expected --record, --vertical or --pulse"],
    );
    refused(folder.path(), &spectrum(&["--csv", "none/s.csv"]), &["none/s.csv: cannot be written"]);
}

/// Eccentricity and ties in proportion: blocks of p and 2p under similar pulses rock alike, and slide a quarter of the way.
#[test]
fn held_blocks_of_all_sizes_are_similar() {
    let folder = tempfile::tempdir().unwrap();
    let held = "--friction 0.3 --eccentricity-ratio -0.15 \
                --tie-ratio block_z=1.4,ground_x=2,stiffness=0.4,pretension=0.01,damping=0.02,strength=0.05";
    let tables = [(1.0, "large.csv"), (2.0, "small.csv")].map(|(p, name)| {
        let (least, most, period) = (0.5 * p, 4.0 * p, 2.0 / p);
        let line = format!(
            "spectrum --pulse one-sine --amplitude 4 --period {period} --p-min {least} --p-max {most} --points 7 \
             --foundation 40,0.1,0 --foundation rigid {held} --csv {name}"
        );
        stdout(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
        Table::read(&folder.path().join(name))
    });
    let mut held = [0, 0];
    for row in 0..14 {
        let [large, small] = tables.each_ref().map(|table| {
            ["peak.theta/alpha [1]", "peak.slip [m]", "peak.tie_1.tension [N]"].map(|name| table.number(row, name))
        });
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a.abs() + 1e-3);
        assert!(close(large[0], small[0]), "row {row}: {large:?} {small:?}");
        assert!(close(large[1], 4.0 * small[1]) && close(large[2], small[2]), "row {row}: {large:?} {small:?}");
        held = [held[0] + i32::from(large[1] > 0.01), held[1] + i32::from(large[2] > 200.0)];
    }
    assert!(held[0] > 3 && held[1] > 3, "{held:?}");
}

/// A row equals the run of the block with the absolute values of its proportions.
#[test]
fn proportions_are_those_of_the_block() {
    let folder = tempfile::tempdir().unwrap();
    let excitation =
        "--alpha 0.25 --pulse one-sine --amplitude 3.2 --period 0.8 --on-separation fly --g 9.81 --mass 700";
    let line = format!(
        "spectrum {excitation} --p-min 1 --p-max 2 --points 2 --foundation 40,0.1,0 --eccentricity-ratio 0.1 \
         --tie-ratio block_x=-0.1,block_z=1,ground_x=-2,stiffness=0.5,pretension=0.02,slack=0.01,damping=0.03,strength=1 \
         --csv spectrum.csv"
    );
    stdout(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
    let row = Table::read(&folder.path().join("spectrum.csv"));
    let (p, alpha, mass, g) = (2.0, 0.25_f64, 700.0, 9.81);
    let r0 = 0.75 * g / (p * p);
    let (weight, b) = (mass * g, r0 * alpha.sin());
    let tie = format!(
        "block_x={},block_z={r0},ground_x={},stiffness={},pretension={},slack={},damping={},strength={weight}",
        -0.1 * r0,
        -2.0 * r0,
        0.5 * weight / r0,
        0.02 * weight,
        0.01 * r0,
        0.03 * mass * p
    );
    let line = format!("simulate {excitation} --p {p} --eccentricity {} --tie {tie} --tolerance 1e-6 --json", 0.1 * b);
    let json: serde_json::Value =
        serde_json::from_str(&stdout(folder.path(), &line.split_whitespace().collect::<Vec<_>>())).unwrap();
    for (column, pointer) in
        [("peak.theta/alpha [1]", "/peak/theta~1alpha"), ("peak.tie_1.tension [N]", "/ties/0/peak_tension")]
    {
        let (found, expected) = (row.number(0, column), json.pointer(pointer).and_then(|x| x.as_f64()).unwrap());
        assert!((found / expected - 1.0).abs() < 1e-5 && expected > 0.01, "{column}: {found}, not {expected}");
    }
}
