//! Levels, least overturning levels and ensembles of `rocking sweep`.

use rocking_block::block::{Block, Common, Dimensionless, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::Settings;
use rocking_records::{ReadOptions, Unit, read};
use rocking_studies::intensity::pgv;
use rocking_studies::run::Run;
use rocking_studies::run::outcome::End;
use rocking_studies::search::{Scan, overturning};
use rocking_studies::spec::study::Distribution;
use rocking_studies::sweep::ensemble::{SpreadTarget, SpreadWidth, UncertainQuantity};

use crate::program::{Table, refused, stdout};
use crate::studies::resumes_to_the_same_bytes;

/// Study file of two blocks under a record that overturns them at some strengths.
fn study(strength: &str) -> String {
    format!(
        "[study]\ndesign = \"grid\"\n{strength}\n[parameters]\nalpha = 0.2\np = [1.5, 3]\n\
         foundation = \"rigid\"\n[[records]]\nhorizontal = \"h.csv\"\nunit = \"m/s2\"\ndt = 0.02\n"
    )
}

fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    // Two beating sines: a later wave may or may not catch the block.
    let wave = |t: f64| 3.0 * ((4.0 * t).sin() + (5.3 * t).sin());
    let text: String = (0..400).map(|i| format!("{}\n", wave(0.02 * f64::from(i)))).collect();
    std::fs::write(folder.path().join("h.csv"), text).unwrap();
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

fn sweep(study: &str) -> Table {
    let folder = folder(study);
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "out.csv"]);
    Table::read(&folder.path().join("out.csv"))
}

/// Each row has the requested level of the measure, and equals the run with the factor in that row.
#[test]
fn levels_are_met_by_factors() {
    for im in ["PGV", "Arias", "SI", "Sa(0.4 s)", "PGA/(g tan alpha)", "p PGV/(g tan alpha)"] {
        let table = sweep(&study(&format!("levels = {{ im = \"{im}\", values = [0.7, 2.5] }}")));
        assert_eq!(table.rows.len(), 4);
        let table_column = table.headers.iter().find(|name| name.starts_with(&format!("{im} ["))).unwrap().to_string();
        let mut factors = Vec::new();
        for row in 0..4 {
            let level = table.number(row, &table_column);
            assert_eq!(level, [0.7, 2.5][row % 2], "{im}");
            factors.push(table.get(row, "scale [1]").to_string());
        }
        // The same factors give the same rows.
        let mut distinct = factors.clone();
        distinct.sort();
        distinct.dedup();
        let scaled = sweep(&study(&format!("periods = [0.4]\nscales = [{}]", distinct.join(", "))));
        for row in 0..4 {
            // Each block has its own two of the factors, or both have the same.
            let same = distinct.len() * (row / 2) + distinct.iter().position(|one| *one == factors[row]).unwrap();
            for column in ["outcome", "peak.theta/alpha [1]", "end_time [s]", "Arias [m/s]"] {
                if column != table_column {
                    assert_eq!(table.get(row, column), scaled.get(same, column), "{im} {column}");
                }
            }
            let met = scaled.number(same, &table_column);
            assert!((met / [0.7, 2.5][row % 2] - 1.0).abs() < 1e-14, "{im}: {met}");
        }
    }
}

/// An analysis by hunt and fill makes the runs of a sweep at the levels that it chooses, whatever the lanes and interruptions; the bracket of the
/// least level that overturns narrows to the resolution.
#[test]
fn hunts_make_the_runs_of_a_sweep_at_their_levels() {
    let hunt = study("hunt = { im = \"PGV\", first = 0.1, resolution = 0.05, runs = 14 }");
    let files = folder(&hunt);
    let ida = |more: &[&str]| stdout(files.path(), &[&["ida", "study.toml"], more].concat());
    let text = ida(&["--csv", "out.csv", "--plot", "ida.svg"]);
    let lines = [
        "curves        2, 2 overturning\n",
        "peak |θ|/α that 16, 50 and 84 % of the curves do not exceed\n",
        "overturns at ",
    ];
    assert!(lines.iter().all(|line| text.contains(line)), "{text}");
    ida(&["--csv", "alone.csv", "--lanes", "1", "--threads", "1"]);
    let read = |name: &str| std::fs::read_to_string(files.path().join(name)).unwrap();
    assert_eq!(read("out.csv"), read("alone.csv"));
    assert!(read("ida.svg").contains("<svg"));
    let whole = read("out.csv");
    let rows: Vec<&str> = whole.lines().collect();
    std::fs::write(files.path().join("cut.csv"), rows[..rows.len() - 9].join("\n") + "\n").unwrap();
    ida(&["--csv", "cut.csv", "--resume"]);
    assert_eq!(read("out.csv"), read("cut.csv"));
    let table = Table::read(&files.path().join("out.csv"));
    assert_eq!(table.rows.len(), 28);
    let summary: serde_json::Value = serde_json::from_str(&ida(&["--csv", "json.csv", "--json"])).unwrap();
    // A fractile of the peak overturns where all curves of greater peaks do: that of 84 % first.
    let overturns = |i: usize| summary["fractiles_overturn"][i]["overturns"].as_f64().unwrap();
    assert!(overturns(2) < overturns(0) && overturns(1) == overturns(0), "{}", summary["fractiles_overturn"]);
    for curve in 0..2 {
        let rows = 14 * curve..14 * (curve + 1);
        let levels: Vec<f64> = rows.clone().map(|row| table.number(row, "PGV [m/s]")).collect();
        // The steps grow until the block overturns.
        let hunted = rows.clone().position(|row| table.get(row, "outcome") == "overturned").unwrap();
        let expected = |i: usize| 0.1 + 0.1 * i as f64 + 0.025 * (i * i.saturating_sub(1)) as f64;
        assert!((0..=hunted).all(|i| (levels[i] - expected(i)).abs() < 1e-12), "{levels:?}");
        let least = |is: &dyn Fn(&str) -> bool| {
            let levels =
                rows.clone().filter(|&row| is(table.get(row, "outcome"))).map(|row| table.number(row, "PGV [m/s]"));
            levels.collect::<Vec<f64>>()
        };
        let overturns = least(&|outcome| outcome == "overturned").into_iter().fold(f64::INFINITY, f64::min);
        let stands =
            least(&|outcome| outcome == "completed").into_iter().filter(|&level| level < overturns).fold(0.0, f64::max);
        assert!(overturns - stands <= 0.05 * overturns, "{stands} to {overturns}");
        let capacity = &summary["capacities"][curve];
        assert_eq!((capacity["stands"].as_f64(), capacity["overturns"].as_f64()), (Some(stands), Some(overturns)));
        // The rows are those of a sweep at the same levels.
        let values: Vec<String> = levels.iter().map(f64::to_string).collect();
        let levels = sweep(&study(&format!("levels = {{ im = \"PGV\", values = [{}] }}", values.join(", "))));
        for row in 0..14 {
            let fields =
                |table: &Table| table.rows[14 * curve + row].iter().skip(1).map(String::from).collect::<Vec<_>>();
            assert_eq!(fields(&table), fields(&levels));
        }
    }
    let given = study("levels = { im = \"PGV\", values = [0.2, 0.4, 0.8] }");
    std::fs::write(files.path().join("study.toml"), given).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&ida(&["--csv", "levels.csv", "--json"])).unwrap();
    let levels: Vec<f64> =
        summary["fractiles"].as_array().unwrap().iter().map(|at| at["level"].as_f64().unwrap()).collect();
    assert_eq!(levels, [0.2, 0.4, 0.8]);
    std::fs::write(files.path().join("study.toml"), study("scales = [1, 2]")).unwrap();
    let words = ["study.toml: has no levels of an intensity measure; expected levels = "];
    refused(files.path(), &["ida", "study.toml", "--csv", "x.csv"], &words);
}

/// Least level and overturning ranges equal those of `rocking search` over the factor.
#[test]
fn least_levels_and_islands_are_those_of_a_search() {
    let least = "least = { im = \"PGV\", from = 0.2, to = 4, points = 60, resolution = 1e-3 }";
    let table = sweep(&study(least));
    assert_eq!(table.rows.len(), 2);
    let options =
        ReadOptions { unit: Some(Unit::MetrePerSecondSquared), time_step: Some(0.02), ..ReadOptions::default() };
    let files = folder(&study(least));
    let record = read(&files.path().join("h.csv"), &options).unwrap();
    let pgv = pgv(&record);
    let mut most = 0;
    for row in 0..2 {
        let given = Dimensionless { alpha: 0.2, p: [1.5, 3.0][row], supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&given, &Common::default()).unwrap();
        let settings = Settings { on_separation: rocking_block::simulation::OnSeparation::Fly, ..Settings::default() };
        let scan = Scan { from: 0.2 / pgv, to: 4.0 / pgv, points: 60, resolution: 1e-3 / pgv };
        let ground = Ground { horizontal: Some(record.clone()), vertical: None };
        let found = overturning(&Run { ground, ..Run::at_rest(block, settings) }, &scan, None, &|_, _| ());
        assert_eq!(table.get(row, "outcome"), "overturned");
        let level = table.number(row, "least.PGV [m/s]");
        assert!((level / (found.least(End::Overturned).unwrap() * pgv) - 1.0).abs() < 1e-9, "{level}");
        let stretches = found.stretches();
        let ranges: Vec<_> = stretches.iter().filter(|stretch| stretch.2 == End::Overturned).collect();
        assert_eq!(table.number(row, "overturning_ranges [1]"), ranges.len() as f64);
        let cell = table.get(row, "overturning.PGV [m/s]").to_string();
        let numbers: Vec<f64> =
            cell.split("; ").flat_map(|range| range.split(" to ")).map(|x| x.parse().unwrap()).collect();
        let exact: Vec<f64> = ranges.iter().flat_map(|stretch| [stretch.0 * pgv, stretch.1 * pgv]).collect();
        assert!(numbers.iter().zip(&exact).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{cell}: {exact:?}");
        assert_eq!(numbers[0], level);
        assert_eq!(table.get(row, "least.bound"), "none");
        assert_eq!(table.number(row, "always_from.PGV [m/s]"), numbers[numbers.len() - 2]);
        most = most.max(ranges.len());
    }
    assert!(most > 1, "no island");
}

/// The outcome of a search belongs to no level, least of all to the measure of the unscaled record in the same row.
#[test]
fn searches_for_least_levels_give_no_fragility_curve() {
    let least = "least = { im = \"PGV\", from = 0.2, to = 4, points = 5, resolution = 0.1 }";
    let folder = folder(&study(least));
    let hazard = "PGV [m/s],rate [1/year]\n0.1,1e-2\n1,1e-4\n";
    std::fs::write(folder.path().join("hazard.csv"), hazard).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "t.csv"]);
    let words =
        ["t.csv: found the least levels of searches, least.PGV [m/s]; expected an outcome at one level in each row"];
    for im in ["PGV", "least.PGV"] {
        refused(folder.path(), &["fragility", "t.csv", "--im", im], &words);
        for more in [&[][..], &["--empirical"]] {
            refused(folder.path(), &[&["rate", "hazard.csv", "--table", "t.csv", "--im", im], more].concat(), &words);
        }
    }
}

/// A range that begins with overturning, or ends without, bounds the least level.
#[test]
fn a_least_level_at_an_end_of_the_range_is_a_bound() {
    for (from, to, outcome, bound) in [(3.9, 4.0, "overturned", "upper"), (0.01, 0.02, "completed", "lower")] {
        let table = sweep(&study(&format!(
            "least = {{ im = \"PGV\", from = {from}, to = {to}, points = 3, resolution = 1e-3 }}"
        )));
        for row in 0..2 {
            assert_eq!((table.get(row, "outcome"), table.get(row, "least.bound")), (outcome, bound));
            assert_eq!(table.get(row, "least.PGV [m/s]"), if bound == "upper" { "3.9" } else { "" });
        }
    }
}

/// An ensemble counts the runs with the factors of its distribution.
#[test]
fn an_ensemble_counts_its_runs() {
    let spread = UncertainQuantity {
        target: SpreadTarget::Scale,
        distribution: Distribution::Lognormal,
        width: SpreadWidth::Relative(0.2),
    };
    let factors: Vec<String> = (0..9).map(|i| (spread.value(0.6, (f64::from(i) + 0.5) / 9.0)).to_string()).collect();
    assert_eq!(factors[4], "0.6");
    let single = sweep(&study(&format!("scales = [{}]", factors.join(", "))));
    let table = sweep(&study("scales = [0.6]\nensemble = { scale = 0.2, samples = 9, limits = [0.1, 0.4] }"));
    let mut between = 0;
    for row in 0..2 {
        let of_block = || 9 * row..9 * row + 9;
        let overturned = |row: usize| single.get(row, "outcome") == "overturned";
        let count = of_block().filter(|&row| overturned(row)).count() as f64;
        assert_eq!(table.number(row, "ensemble.samples [1]"), 9.0);
        assert_eq!(table.number(row, "ensemble.failed [1]"), 0.0);
        assert_eq!(table.number(row, "ensemble.overturned [1]"), count);
        assert_eq!(table.number(row, "P(overturned) [1]"), count / 9.0);
        for limit in [0.1, 0.4] {
            let exceeds = |row: &usize| overturned(*row) || single.number(*row, "peak.theta/alpha [1]") > limit;
            let count = of_block().filter(exceeds).count() as f64;
            assert_eq!(table.number(row, &format!("ensemble.theta/alpha>{limit} [1]")), count);
            assert_eq!(table.number(row, &format!("P(theta/alpha>{limit}) [1]")), count / 9.0);
        }
        // The row itself is the run without spread, which equals the middle sample.
        for column in ["outcome", "peak.theta/alpha [1]", "PGV [m/s]"] {
            assert_eq!(table.get(row, column), single.get(9 * row + 4, column));
        }
        between += usize::from(0.0 < count && count < 9.0);
    }
    assert!(between > 0, "all samples have the same outcome");
}

/// Samples count as single runs do: one that ends undecided or separated before a limit is unknown.
#[test]
fn an_ensemble_counts_unknown_samples() {
    let spread = UncertainQuantity {
        target: SpreadTarget::Scale,
        distribution: Distribution::Lognormal,
        width: SpreadWidth::Relative(0.3),
    };
    let undecided = study("duration = 5\nSTRENGTH");
    let separated = study("STRENGTH").replace("alpha = 0.2", "alpha = 0.5\non_separation = \"terminate\"\neta = 20");
    let separated = separated.replace("\"rigid\"", "\"viscoelastic\"") + "vertical = \"h.csv\"\n";
    for (study, scale, end) in [(undecided, 0.6, "undecided"), (separated, 0.9, "separated")] {
        let factor = |i: i32| spread.value(scale, (f64::from(i) + 0.5) / 9.0).to_string();
        let factors = (0..9).map(factor).collect::<Vec<_>>().join(", ");
        let single = sweep(&study.replace("STRENGTH", &format!("scales = [{factors}]")));
        let ensemble = format!("scales = [{scale}]\nensemble = {{ scale = 0.3, samples = 9, limits = [0.3] }}");
        let table = sweep(&study.replace("STRENGTH", &ensemble));
        let over =
            |row: usize| single.get(row, "outcome") == "overturned" || single.number(row, "peak.theta/alpha [1]") > 0.3;
        let open = |row: usize| single.get(row, "outcome") == end;
        let (mut beyond, mut partly) = (0, 0);
        for row in 0..2 {
            let count = |is: &dyn Fn(usize) -> bool| (9 * row..9 * row + 9).filter(|&row| is(row)).count();
            let (exceeded, unknown) = (count(&over), count(&|row| open(row) && !over(row)));
            assert_eq!(table.get(row, "ensemble.theta/alpha>0.3 [1]"), exceeded.to_string(), "{end}");
            assert_eq!(table.get(row, "ensemble.unknown(theta/alpha>0.3) [1]"), unknown.to_string(), "{end}");
            assert_eq!(table.number(row, "P(theta/alpha>0.3) [1]"), exceeded as f64 / (9 - unknown) as f64, "{end}");
            beyond += count(&|row| open(row) && over(row));
            partly += usize::from(unknown > 0);
        }
        assert!(beyond > 0 && partly > 0, "{end}: {beyond} {partly}");
    }
}

const SEVERAL: &str = "scales = [0.5, 0.6, 0.7]\n[study.ensemble]\nsamples = 5\nseed = 3\nscale = 0.1\n\
                       dimensionless.p = { distribution = \"normal\", cov = 0.05 }\n\
                       initial.theta = { distribution = \"uniform\", deviation = 0.01 }";

/// Samples depend on the seed and the row, not on threads or interruptions.
#[test]
fn ensembles_of_several_spreads_are_reproducible() {
    let folder = folder(&study(SEVERAL));
    for threads in ["1", "2"] {
        stdout(folder.path(), &["sweep", "study.toml", "--csv", &format!("{threads}.csv"), "--threads", threads]);
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("1.csv") == read("2.csv"));
    resumes_to_the_same_bytes(folder.path(), &["sweep", "study.toml"], "1.csv");
    let table = Table::read(&folder.path().join("1.csv"));
    let counts: Vec<f64> = (0..6).map(|row| table.number(row, "ensemble.overturned [1]")).collect();
    assert!(counts.iter().any(|&count| 0.0 < count && count < 5.0), "{counts:?}");
}

#[test]
fn wrong_strengths_and_ensembles_are_refused_with_their_line() {
    let cases = [
        (
            "levels = { im = \"PGV\", values = [1] }\nscales = [1]",
            "levels = { im = \"PGV\", values = [1] }; expected none beside scales",
        ),
        ("levels = { im = \"PVG\", values = [1] }", "found intensity measure `PVG`; expected one of PGA, PGV"),
        ("levels = { im = \"T_m\", values = [1] }", "im = \"T_m\"; expected a measure that grows"),
        ("levels = { im = \"PGV\", values = [0] }", "values = 0"),
        ("levels = { im = \"PGV\" }", "has no values"),
        ("levels = { values = [1] }", "levels has no im"),
        ("least = { im = \"PGV\", from = 1, to = 1, points = 9, resolution = 0.1 }", "to = 1; expected a number > 1"),
        ("least = { im = \"PGV\", from = 1, to = 2, resolution = 0.1 }", "has no points"),
        (
            "ensemble = { scale = 0.1, samples = 9 }\nleast = { im = \"PGV\", from = 1, to = 2, points = 9, resolution = 0.1 }",
            "expected none beside least",
        ),
        ("hunt = { im = \"PGV\" }", "hunt has no first; expected a number > 0"),
        (
            "hunt = { im = \"PGV\", first = 0.1, resolution = 1 }",
            "resolution = 1; expected a number above 0 and below 1",
        ),
        ("hunt = { im = \"PGV\", first = 0.1, runs = 0 }", "runs = 0"),
        ("hunt = { im = \"T_m\", first = 0.1 }", "im = \"T_m\"; expected a measure that grows"),
        ("ensemble = { scale = 0.1, samples = 9 }\nhunt = { im = \"PGV\", first = 0.1 }", "expected none beside hunt"),
        ("ensemble = { samples = 9 }", "ensemble spreads 0 values"),
        ("ensemble = { scale = 0.1 }", "ensemble has no samples"),
        ("ensemble = { scale = -0.1, samples = 9 }", "scale expects a coefficient of variation > 0"),
        ("ensemble = { scale = 0.1, samples = 9, seed = 1 }", "seed = 1"),
        ("ensemble = { scale = 0.1, epsilon = 0.1, samples = 9 }", "ensemble has no seed"),
        ("ensemble = { epsilon = 0.1, samples = 9 }", "epsilon = 0 has no coefficient of variation"),
        (
            "ensemble = { epsilon = { distribution = \"normal\", deviation = 0.1 }, samples = 9 }",
            "in a sample of the ensemble, epsilon = -0.15",
        ),
        ("ensemble = { foundation = 0.1, samples = 9 }", "foundation has no distribution"),
        ("ensemble = { size = 0.1, samples = 9 }", "there is no parameter size"),
        ("ensemble = { dimensionless.eta = 0.1, samples = 9 }", "eta of the ensemble is not read"),
        ("ensemble = { scale = { cov = 0.1, deviation = 0.1 }, samples = 9 }", "either cov or deviation"),
        ("ensemble = { scale = { distribution = \"gamma\", cov = 0.1 }, samples = 9 }", "\"lognormal\", \"normal\" or"),
        ("ensemble = { scale = 0.1, samples = 9, limits = [-1] }", "limits = -1"),
    ];
    for (strength, words) in cases {
        let folder = folder(&study(strength));
        refused(folder.path(), &["sweep", "study.toml", "--csv", "out.csv"], &["study.toml:3:", words]);
        assert!(!folder.path().join("out.csv").exists());
    }
}
