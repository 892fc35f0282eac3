//! `rocking spectrum` of several records: rows of each record, and statistics over records.

use crate::program::{Table, refusal, stdout};

/// A strong record that overturns small blocks, two others, and one too weak to rock a block on a rigid base.
const RECORDS: [(&str, f64, f64); 4] =
    [("a.csv", 7.0, 5.0), ("b.csv", 4.0, 6.0), ("c.csv", 3.5, 4.0), ("weak.csv", 1.0, 5.0)];
const FEW: [&str; 14] = [
    "--alpha",
    "0.25",
    "--points",
    "7",
    "--p-min",
    "0.8",
    "--p-max",
    "6",
    "--foundation",
    "40,0.1,0.2",
    "--foundation",
    "rigid",
    "--dt",
    "0.02",
];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, amplitude, frequency) in RECORDS {
        let samples = (0..80).map(|i| amplitude * (frequency * 0.02 * f64::from(i)).sin());
        std::fs::write(folder.path().join(name), samples.map(|a| format!("{a}\n")).collect::<String>()).unwrap();
    }
    folder
}

fn spectrum<'a>(records: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [&["spectrum", "--unit", "m/s2", "--record"], records, &FEW, more].concat()
}

const NAMES: [&str; 4] = ["a.csv", "b.csv", "c.csv", "weak.csv"];

/// The rows equal those of single records except in row number and motion. Repeated options equal one with several files.
#[test]
fn the_rows_are_those_of_the_single_records() {
    let folder = folder();
    let path = folder.path();
    stdout(path, &spectrum(&NAMES, &["--csv", "all.csv"]));
    stdout(path, &spectrum(&NAMES[..1], &["--record", "b.csv", "c.csv", "--record", "weak.csv", "--csv", "again.csv"]));
    let read = |name: &str| std::fs::read(path.join(name)).unwrap();
    assert!(read("all.csv") == read("again.csv"));
    let all = Table::read(&path.join("all.csv"));
    assert_eq!(all.rows.len(), 4 * 2 * 7);
    for (number, name) in NAMES.iter().enumerate() {
        let file = format!("single-{name}");
        stdout(path, &spectrum(&[name], &["--csv", &file]));
        let single = Table::read(&path.join(file));
        for row in 0..14 {
            let there = 14 * number + row;
            assert_eq!((all.get(there, "motion"), single.get(row, "motion")), (*name, "horizontal"));
            assert!(all.rows[there].iter().skip(2).eq(single.rows[row].iter().skip(2)), "row {row} of {name}");
        }
    }
}

/// Mean and deviation cover the logarithms of the peaks of blocks that lifted off, reached a thousandth of α, and stand.
#[test]
fn statistics_cover_the_blocks_that_rock_and_stand() {
    let folder = folder();
    let path = folder.path();
    stdout(path, &spectrum(&NAMES, &["--csv", "all.csv", "--statistics", "s.csv", "--on-separation", "terminate"]));
    let (all, statistics) = (Table::read(&path.join("all.csv")), Table::read(&path.join("s.csv")));
    assert_eq!(statistics.rows.len(), 2 * 7);
    let (mut alone, mut left_out, mut at_rest) = (0, 0, 0);
    for row in 0..14 {
        let rows: Vec<usize> = (0..4).map(|motion| 14 * motion + row).collect();
        assert!(rows.iter().all(|&r| all.get(r, "p") == statistics.get(row, "p")));
        let count = |word: &str| rows.iter().filter(|&&r| all.get(r, "outcome") == word).count();
        let completed: Vec<(f64, f64)> = rows
            .iter()
            .filter(|&&r| all.get(r, "outcome") == "completed")
            .map(|&r| (all.number(r, "peak.theta/alpha"), all.number(r, "events.liftoffs")))
            .collect();
        let rocks = |(peak, liftoffs): &(f64, f64)| (*peak >= 1e-3 && *liftoffs > 0.0).then(|| peak.ln());
        let logarithms: Vec<f64> = completed.iter().filter_map(rocks).collect();
        assert_eq!(statistics.get(row, "records"), "4");
        let counts = [logarithms.len(), completed.len() - logarithms.len(), count("overturned"), count("separated")];
        for (name, count) in ["rocked", "at_rest", "overturned", "separated"].into_iter().zip(counts) {
            assert_eq!(statistics.get(row, name), count.to_string(), "{name} in row {row}");
        }
        let n = logarithms.len() as f64;
        let mean = logarithms.iter().sum::<f64>() / n;
        let squares: f64 = logarithms.iter().map(|x| (x - mean).powi(2)).sum();
        match logarithms.len() {
            0 => assert_eq!(statistics.get(row, "geometric_mean.theta/alpha"), ""),
            _ => {
                let found = statistics.number(row, "geometric_mean.theta/alpha");
                assert!((found / mean.exp() - 1.0).abs() < 1e-14, "{found} in row {row}");
            }
        }
        match logarithms.len() {
            0 | 1 => assert_eq!(statistics.get(row, "deviation_ln.theta/alpha"), ""),
            _ => {
                let found = statistics.number(row, "deviation_ln.theta/alpha");
                assert!((found - (squares / (n - 1.0)).sqrt()).abs() < 1e-13, "{found} in row {row}");
            }
        }
        alone += usize::from(logarithms.len() == 1);
        left_out += counts[2];
        at_rest += counts[1];
    }
    // The test needs all three kinds of cells.
    assert!(alone > 0 && left_out > 0 && at_rest > 0, "{alone}, {left_out}, {at_rest}");
}

/// The summary, as text and as JSON, counts the rows of the table.
#[test]
fn the_summary_counts_the_rows_of_each_curve() {
    let folder = folder();
    let path = folder.path();
    let printed = stdout(path, &spectrum(&NAMES, &["--csv", "all.csv"]));
    let json = stdout(path, &spectrum(&NAMES, &["--csv", "all.csv", "--resume", "--json"]));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let all = Table::read(&path.join("all.csv"));
    let mut flights = 0.0;
    for (curve, summary) in json["curves"].as_array().unwrap().iter().enumerate() {
        let rows: Vec<usize> = (7 * curve..7 * curve + 7).collect();
        let count = |word: &str| rows.iter().filter(|&&row| all.get(row, "outcome") == word).count();
        for word in ["completed", "overturned", "separated", "failed"] {
            assert_eq!(summary[word], count(word), "{word} of curve {curve}");
        }
        let flown: f64 = rows.iter().map(|&row| all.number(row, "flights")).sum();
        assert_eq!(summary["flights"], flown as u64);
        flights += flown;
        assert_eq!(summary["flew"], rows.iter().filter(|&&row| all.get(row, "flights") != "0").count());
        assert_eq!(summary["motion"], all.get(rows[0], "motion"));
        let standing = rows.iter().filter(|&&row| all.get(row, "outcome") == "completed");
        let peak = |row: &usize| all.number(*row, "peak.theta/alpha");
        let greatest = *standing.clone().max_by(|a, b| peak(a).total_cmp(&peak(b))).unwrap();
        assert_eq!(summary["greatest"]["peak.theta/alpha"], peak(&greatest));
        // Among equal values, such as those of blocks at rest, the first is named.
        let first = *standing.clone().find(|&row| peak(row) == peak(&greatest)).unwrap();
        assert_eq!(summary["greatest"]["p"], all.number(first, "p"));
        let foundation = ["40,0.1,0.2", "rigid"][curve % 2];
        assert_eq!(summary["foundation"], foundation);
        let words: Vec<&str> = printed.lines().nth(curve + 2).unwrap().split_whitespace().collect();
        let counts = ["completed", "overturned", "separated", "undecided", "failed", "flew", "flights"]
            .map(|word| summary[word].to_string());
        assert_eq!(words[..2], [foundation, all.get(rows[0], "motion")]);
        assert_eq!(words[2..9], counts);
        assert_eq!(words[9], format!("{:.4}", peak(&greatest)));
    }
    assert!(flights > 0.0);
}

/// Vertical records pair with horizontal ones in order; horizontal motions alone have separate statistics.
#[test]
fn vertical_records_go_with_the_horizontal_ones() {
    let folder = folder();
    let path = folder.path();
    let pairs = ["--vertical", "weak.csv", "c.csv", "--also-horizontal"];
    stdout(path, &spectrum(&NAMES[..2], &[&pairs[..], &["--csv", "all.csv", "--statistics", "s.csv"]].concat()));
    let all = Table::read(&path.join("all.csv"));
    let motions: Vec<&str> = (0..4).map(|motion| all.get(14 * motion, "motion")).collect();
    assert_eq!(motions, ["a.csv", "b.csv", "a.csv + weak.csv", "b.csv + c.csv"]);
    let statistics = Table::read(&path.join("s.csv"));
    let kinds: Vec<&str> = (0..4).map(|group| statistics.get(7 * group, "motions")).collect();
    assert_eq!(kinds, ["horizontal", "horizontal", "horizontal + vertical", "horizontal + vertical"]);
    assert!((0..28).all(|row| statistics.get(row, "records") == "2"));
}

#[test]
fn the_picture_shows_records_mean_and_overturned_blocks() {
    let folder = folder();
    let path = folder.path();
    stdout(path, &spectrum(&NAMES, &["--csv", "all.csv", "--plot", "all.svg"]));
    let svg = std::fs::read_to_string(path.join("all.svg")).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    // Subscripts are separate elements.
    let labels: String = document.descendants().filter(|node| node.is_text()).filter_map(|node| node.text()).collect();
    for label in [
        "4 records (a.csv, b.csv, c.csv, weak.csv), 0.102 to 0.714 g",
        "η = 40, ξv = 0.1, ε = 0.2; 4 records",
        "rigid base; 4 records",
        "one record",
        "geometric mean of the records under which the block rocks and stands, if at least half",
        "±1 standard deviation of ln(peak |θ|/α) over the same records",
        "share of records: overturned",
    ] {
        assert!(labels.contains(label), "{label} is not in the picture");
    }
    // One record rocks no block on a rigid base: without a line of all records, the key has no entry for it.
    let of_all = "geometric mean of all records";
    assert!(!labels.contains(of_all));
    stdout(path, &spectrum(&NAMES[1..3], &["--csv", "two.csv", "--plot", "two.svg"]));
    assert!(std::fs::read_to_string(path.join("two.svg")).unwrap().contains(of_all));
    // No run ends at separation or fails, so the key has no entry for them.
    assert!(!svg.contains("ended at separation") && !svg.contains("failed"));
    // One thin line per range of standing blocks, and one in the key.
    let all = Table::read(&path.join("all.csv"));
    let stands = |row: usize| all.get(row, "outcome") == "completed";
    let begins = |row: usize| stands(row) && (row.is_multiple_of(7) || !stands(row - 1));
    let stretches = (0..all.rows.len()).filter(|&row| begins(row)).count();
    let drawn = |colour: &str| svg.lines().filter(|line| line.contains(colour)).count();
    assert_eq!(drawn("stroke=\"#969696\""), stretches + 1);
    // One black bar per size and foundation that some record overturns, and one in the key.
    let falls = |row: usize| (0..4).any(|motion| all.get(14 * motion + row, "outcome") == "overturned");
    let sizes = (0..14).filter(|&row| falls(row)).count();
    let bars = svg.lines().filter(|line| line.starts_with("<rect") && line.contains("fill=\"#191919\"")).count();
    assert!(sizes > 0 && bars == sizes + 1, "{bars} bars for {sizes} sizes");
    // A single record has no mean.
    stdout(path, &spectrum(&NAMES[..1], &["--csv", "one.csv", "--plot", "one.svg"]));
    assert!(!std::fs::read_to_string(path.join("one.svg")).unwrap().contains("geometric mean"));
}

#[test]
fn contradictory_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    let refused = |records: &[&'static str], more: &[&'static str]| {
        let message = refusal(path, &spectrum(records, &[more, &["--csv", "x.csv"]].concat()));
        assert!(!path.join("x.csv").exists());
        message
    };
    assert_eq!(
        refused(&NAMES[..3], &["--vertical", "a.csv", "b.csv"]),
        "--record names 3 files and --vertical 2; expected equal numbers, in the same order"
    );
    assert_eq!(refused(&NAMES[..1], &["--statistics", "s.csv"]), "--statistics has no effect without several records");
    assert_eq!(refused(&["a.csv", "b.csv", "a.csv"], &[]), "--record names a.csv twice; expected each record once");
    assert!(refused(&["a.csv", "none.csv"], &[]).starts_with("none.csv: cannot be read"));
    assert!(refused(&["-", "-"], &[]).starts_with("--record - and --record -: standard input holds one record"));
    assert!(refused(&NAMES, &["--statistics", "x.csv"]).contains("--statistics x.csv would replace --csv x.csv"));
    // Folders distinguish records of the same name.
    std::fs::create_dir(path.join("f")).unwrap();
    std::fs::copy(path.join("a.csv"), path.join("f/a.csv")).unwrap();
    stdout(path, &spectrum(&["a.csv", "f/a.csv"], &["--csv", "two.csv"]));
    let two = Table::read(&path.join("two.csv"));
    assert_eq!((two.get(0, "motion"), two.get(14, "motion")), ("a.csv", "f/a.csv"));
}
