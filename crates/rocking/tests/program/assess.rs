//! Reports on an object: their numbers equal those of the single commands, their bytes, and refusals.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{Table, files, refused, stdout};

const HAZARD: &str = "PGV [m/s],rate [1/year]\n0.05,2e-2\n0.1,5e-3\n0.2,1e-3\n0.5,9e-5\n1,1.2e-5\n2,9e-7\n";

/// Two records, four blocks, five strengths.
const STUDY: &str = "\
[study]
design = \"latin-hypercube\"
samples = 4
seed = 1
levels = { im = \"PGV\", values = [0.2, 0.4, 0.6, 0.9, 1.4] }
[parameters]
foundation = \"rigid\"
alpha = { from = 0.14, to = 0.16 }
p = 2.2
restitution_factor = { from = 0.9, to = 0.98 }
[[records]]
horizontal = \"*.smc\"
";

const ASSESS: &str = "\
[assess]
title = \"Test <block>\"
years = 100
pulse_periods = [0.8]
hazard = { file = \"hazard.csv\" }
states = [{ name = \"rocks\", limit = 0.6, source = \"a & b\" }, { name = \"overturns\", limit = \"overturned\" }]
variants = [{ name = \"sliding\", parameters = { friction = 0.12 } }, { name = \"wider\", width = 1.1 }]
sensitivity = { p = [2.0, 2.4] }
";

fn folder(assess: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let records = concat!(env!("CARGO_MANIFEST_DIR"), "/../../records");
    for record in ["0111a.smc", "np01002p_4225a_a.smc"] {
        fs::copy(Path::new(records).join(record), folder.path().join(record)).unwrap();
    }
    fs::write(folder.path().join("hazard.csv"), HAZARD).unwrap();
    fs::write(folder.path().join("study.toml"), STUDY.to_owned() + assess).unwrap();
    folder
}

#[track_caller]
fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(folder, &[arguments, &["--json"]].concat())).unwrap()
}

/// The runs of the study with another p and one more line at the end of its parameters, where it leaves the samples of the others.
fn swept(folder: &Path, p: f64, line: &str) -> Table {
    let study = STUDY.replace("p = 2.2", &format!("p = {p}")).replace("[[records]]", &format!("{line}\n[[records]]"));
    fs::write(folder.join("other.toml"), study).unwrap();
    stdout(folder, &["sweep", "other.toml", "--csv", "other.csv", "--force"]);
    Table::read(&folder.join("other.csv"))
}

fn overturned(table: &Table) -> u64 {
    (0..table.rows.len()).filter(|&row| table.get(row, "outcome") == "overturned").count() as u64
}

/// The slips of all runs, the least first.
fn slips(table: &Table) -> Vec<f64> {
    let mut slips = table.column("peak.slip");
    slips.sort_by(f64::total_cmp);
    slips
}

#[test]
fn the_numbers_are_those_of_the_single_commands() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    // A sweep leaves [assess] unread, but its table names it.
    stdout(folder, &["sweep", "study.toml", "--csv", "runs.csv"]);
    assert_eq!(fs::read(folder.join("runs.csv")).unwrap(), fs::read(folder.join("report/runs.csv")).unwrap());
    for (state, limit) in [(0, "0.6"), (1, "overturned")] {
        let state = &report["states"][state];
        let alone = json(folder, &["fragility", "runs.csv", "--im", "PGV", "--limit", limit]);
        let curve = &alone["measures"][0];
        for key in ["median", "median_interval", "beta", "beta_interval", "AUC"] {
            assert_eq!(state["curve"][key], curve[key], "{limit}: {key}");
        }
        assert_eq!(state["runs"]["exceeded"].as_f64(), alone["rows"]["exceeded"].as_f64());
        let arguments =
            ["rate", "hazard.csv", "--table", "runs.csv", "--im", "PGV", "--years", "100", "--limit", limit];
        let alone = json(folder, &arguments);
        for key in ["rate", "rate_interval"] {
            assert_eq!(state["rate"][key], alone[key], "{limit}: {key}");
        }
        assert_eq!(state["rate"]["probability"], alone["probabilities"][0]["probability"]);
        assert_eq!(state["rate"]["above_runs"], alone["extrapolated"]["above_rows"]);
    }
    let middle =
        ["--alpha", "0.15000000000000002", "--p", "2.2", "--foundation", "rigid", "--restitution-factor", "0.94"];
    let alone = json(folder, &[&["search", "overturning", "--period", "0.8"], &middle[..]].concat());
    assert_eq!(report["pulses"][0]["amplitude"], alone["least"]);
    assert_eq!(report["object"]["alpha"].as_f64(), Some(0.15000000000000002));
}

/// A variant and an end of a range are the study with that value: a sweep that names it has the same outcomes.
#[test]
fn variants_and_ends_of_ranges_are_sweeps_of_their_own() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    let plain = overturned(&swept(folder, 2.2, ""));
    assert_eq!(report["variants"][0]["runs"]["exceeded"], plain);
    let slid = swept(folder, 2.2, "friction = 0.12");
    let sliding = overturned(&slid);
    assert_eq!(report["variants"][1]["runs"]["exceeded"], sliding);
    assert!(sliding < plain, "{sliding} of {plain}");
    for (end, p) in [(0, 2.0), (1, 2.4)] {
        assert_eq!(report["sensitivity"][0]["ends"][end]["runs"]["exceeded"], overturned(&swept(folder, p, "")));
    }
    let table = Table::read(&folder.join("report/variants.csv"));
    assert_eq!(table.rows.len(), 5);
    assert_eq!(table.number(1, "exceeded"), sliding as f64);
    let slip = report["variants"][1]["peak_slip"].as_f64().unwrap();
    assert_eq!(table.number(1, "peak.slip"), slip);
    assert_eq!(slip, *slips(&slid).last().unwrap());
    // tan α = b/h grows with the base.
    let alphas = [0, 2].map(|variant| report["variants"][variant]["alpha"].as_f64().unwrap().tan());
    assert!((alphas[1] / alphas[0] - 1.1).abs() < 1e-14);
}

/// Blocks with limited friction are sweeps with that coefficient.
#[test]
fn the_slip_is_that_of_sweeps_with_friction() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    let found = report["sliding"].as_array().unwrap();
    assert_eq!(found.iter().map(|found| found["friction"].as_f64().unwrap()).collect::<Vec<_>>(), [0.3, 0.5, 0.7]);
    for found in found {
        let table = swept(folder, 2.2, &format!("friction = {}", found["friction"]));
        assert_eq!(found["runs"]["exceeded"], overturned(&table));
        let slips = slips(&table);
        let [below, above] = [slips.len() / 2 - 1, slips.len() / 2].map(|middle| slips[middle]);
        assert_eq!(found["median_slip"].as_f64(), Some(0.5 * (below + above)));
        assert_eq!(found["greatest_slip"].as_f64(), slips.last().copied());
        assert_eq!(found["slid"], slips.iter().filter(|&&slip| slip > 1e-3).count());
    }
}

#[test]
fn a_report_has_the_same_bytes_on_any_number_of_threads_and_needs_no_other_file() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    stdout(folder, &["assess", "study.toml", "--out", "one", "--threads", "1", "--lanes", "1"]);
    stdout(folder, &["assess", "study.toml", "--out", "two", "--threads", "2"]);
    let names = files(&folder.join("one"));
    for name in ["report.html", "runs.csv", "variants.csv", "states.csv", "spectrum.csv", "sketch.png", "rate.png"] {
        assert!(names.iter().any(|known| known == name), "{name} is not in {names:?}");
    }
    assert_eq!(names, files(&folder.join("two")));
    for name in &names {
        let [one, two] = ["one", "two"].map(|out| fs::read(folder.join(out).join(name)).unwrap());
        assert!(one == two, "{name} differs");
    }
    let page = fs::read_to_string(folder.join("one/report.html")).unwrap();
    assert!(page.contains("<h1>Test &#60;block&#62;</h1>") && page.contains("a &#38; b"), "text is escaped");
    assert_eq!(page.matches("<svg").count(), names.iter().filter(|name| name.ends_with(".png")).count());
    for outside in ["src=", "href=", "url(", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // SHA-256 of the hazard curve, from `sha256sum`.
    assert!(page.contains(HAZARD_SUM));
}

const HAZARD_SUM: &str = "f6e808b867023cb56bbf5588f34bd2bd6ade5d0e29fa1bcb71fd428b9168b6b9";

#[test]
fn studies_that_cannot_be_assessed_are_refused_with_their_line() {
    for (assess, words) in [
        ("", &["study.toml:1: the file has no [assess]; expected title"][..]),
        ("[assess]\n", &["study.toml:13: assess has no title"]),
        ("[assess]\ntitle = \"a\"\nname = 1\n", &["study.toml:15: there is no name in assess; expected one of title"]),
        ("[assess]\ntitle = \"a\"\nim = \"PFA\"\n", &["study.toml:15: im = \"PFA\"; expected one of PGA"]),
        ("[assess]\ntitle = \"a\"\nhazard = { file = \"no.csv\" }\n", &["study.toml:15: no.csv: cannot be read"]),
        (
            "[assess]\ntitle = \"a\"\nim = \"PGA\"\nhazard = { file = \"hazard.csv\" }\n",
            &["study.toml:16: hazard.csv: found a hazard curve of PGV; expected one of PGA"],
        ),
        (
            "[assess]\ntitle = \"a\"\nhazard = { file = \"hazard.csv\", unit = \"in/s\" }\n",
            &["study.toml:15: hazard.csv: found levels in in/s; expected those of PGV [m/s]"],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", parameters = { eta = 20 } }]\n",
            &["study.toml:15: b: no block of the study reads it; expected foundation = Viscoelastic"],
        ),
        (
            "[assess]\ntitle = \"a\"\nsensitivity = { eta = [20, 80] }\n",
            &["study.toml:15: eta: no block of the study reads it; expected foundation = Viscoelastic"],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", parameters = { p = -1 } }]\n",
            &["study.toml:15:", "-1", "expected"],
        ),
        (
            "[assess]\ntitle = \"a\"\nstates = [{ name = \"slips\", limit = \"slip:0.1\" }]\n",
            &["runs.csv: has no column peak.slip"],
        ),
    ] {
        let folder = folder(assess);
        refused(folder.path(), &["assess", "study.toml"], words);
        let left = files(folder.path());
        assert!(!folder.path().join("report/report.html").exists(), "{left:?}");
    }
}
