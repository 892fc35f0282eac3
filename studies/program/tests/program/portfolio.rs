//! Portfolios: each object as `rocking assess` has it, their order, kept rows, and what bad use gets.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{Table, program, refused, rocking, stdout, succeeds, text};

const HAZARD: &str = "PGV [m/s],rate [1/year]\n0.05,2e-2\n0.1,5e-3\n0.2,1e-3\n0.5,9e-5\n1,1.2e-5\n2,9e-7\n";

/// The study of a block under two records, which overturn some of its four sizes.
fn study(title: &str, alpha: f64, assess: &str) -> String {
    format!(
        "[study]
design = \"latin-hypercube\"
samples = 4
seed = 1
levels = {{ im = \"PGV\", values = [0.2, 0.4, 0.6, 0.9, 1.4] }}
[parameters]
foundation = \"rigid\"
alpha = {alpha}
p = {{ from = 2, to = 2.4 }}
[[records]]
horizontal = \"../*.smc\"
[assess]
title = \"{title}\"
pulse_periods = [0.8]
states = [{{ name = \"rocks\", limit = 0.3 }}, {{ name = \"overturns\", limit = \"overturned\" }}]
variants = [{{ name = \"wider\", width = 1.3 }}]
sensitivity = {{ p = [2.0, 2.4] }}
{assess}
"
    )
}

const WITH_HAZARD: &str = "hazard = { file = \"../hazard.csv\" }";

/// A folder with two records, a hazard, and the folder `museum` with three objects: the tallest is the last of them.
fn museum() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let records = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records");
    for record in ["0111a.smc", "np01002p_4225a_a.smc"] {
        fs::copy(Path::new(records).join(record), folder.path().join(record)).unwrap();
    }
    fs::write(folder.path().join("hazard.csv"), HAZARD).unwrap();
    fs::create_dir(folder.path().join("museum")).unwrap();
    for (name, alpha) in [("broad", 0.2), ("middle", 0.16), ("tall one", 0.13)] {
        put(folder.path(), name, &study(&format!("The {name}"), alpha, WITH_HAZARD));
    }
    folder
}

fn put(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(format!("museum/{name}.toml")), text).unwrap();
}

#[track_caller]
fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(folder, &[arguments, &["--json"]].concat())).unwrap()
}

fn names(found: &Value) -> Vec<&str> {
    found["objects"].as_array().unwrap().iter().map(|object| object["name"].as_str().unwrap()).collect()
}

/// Each report has the bytes of `rocking assess`; the order is that of the rates, on the page, in the table and in JSON.
#[test]
fn objects_are_ranked_by_the_rates_of_their_reports() {
    let folder = museum();
    let folder = folder.path();
    let found = json(folder, &["portfolio", "museum"]);
    assert_eq!(names(&found), ["tall one", "middle", "broad"]);
    let table = Table::read(&folder.join("portfolio/portfolio.csv"));
    let page = fs::read_to_string(folder.join("portfolio/portfolio.html")).unwrap();
    let mut sum = 0.0;
    for (row, object) in found["objects"].as_array().unwrap().iter().enumerate() {
        let name = object["name"].as_str().unwrap();
        let alone = json(folder, &["assess", &format!("museum/{name}.toml"), "--out", &format!("alone/{name}")]);
        let of = |place: &str| fs::read(folder.join(place).join(name).join("report.html")).unwrap();
        assert!(of("portfolio") == of("alone"), "{name}: the page is not that of `rocking assess`");
        assert_eq!(object["state"], alone["states"][1], "{name}");
        assert_eq!(object["first"]["rate"], alone["states"][0]["rate"]["rate"]);
        assert_eq!((object["rank"].as_u64(), table.get(row, "rank")), (Some(row as u64 + 1), &*format!("{}", row + 1)));
        assert_eq!(Some(table.number(row, "rate")), alone["states"][1]["rate"]["rate"].as_f64());
        sum += table.number(row, "rate");
        assert_eq!(table.get(row, "page"), format!("{name}/report.html"));
        let link = format!("<a href=\"{}/report.html\">The {name}</a>", name.replace(' ', "%20"));
        assert!(page.contains(&link), "{link}");
    }
    assert!((found["together"].as_f64().unwrap() / sum - 1.0).abs() < 1e-14);
    // Intervals from two motions overlap: no rank is certain.
    assert_eq!(found["objects"][0]["ranks"], serde_json::json!([1, 3]));
    assert!(page.contains("1 (1 to 3)") && page.contains("“The tall one” comes first"));
}

/// Two floors under two records are two ground motions, in counts and in intervals, and the chart ranks the rates.
#[test]
fn floors_of_a_motion_are_one_motion() {
    let folder = museum();
    let folder = folder.path();
    for name in ["broad", "middle", "tall one"] {
        let file = folder.join(format!("museum/{name}.toml"));
        let building = "[building]\nfloor_masses = [1e5, 1e5]\nstorey_stiffnesses = [4e8, 4e8]\ndamping = 0.05\nfloors = [1, 2]\n[assess]";
        fs::write(&file, fs::read_to_string(&file).unwrap().replace("[assess]", building)).unwrap();
    }
    let found = json(folder, &["portfolio", "museum"]);
    let object = &found["objects"][0];
    assert_eq!((&object["motions"], &object["floors"]), (&2.into(), &serde_json::json!([1, 2])));
    let (alone, _) = succeeds(&mut program(folder, &[&["assess", "museum/middle.toml", "--out", "alone"]]));
    assert!(alone.contains("80 computed runs under 2 ground motions on 2 floors with"), "{alone}");
    let fit = ["fragility", "alone/runs.csv", "--im", "PGV"];
    assert_eq!(json(folder, &fit)["intervals"], "profile likelihood, clustered by 2 motions");
    let page = fs::read_to_string(folder.join("portfolio/portfolio.html")).unwrap();
    assert!(page.contains("95 % confidence, up to the edge") && folder.join("portfolio/ranking.png").exists());
}

/// A second call reuses the rows of the first.
#[test]
fn kept_rows_are_used() {
    let folder = museum();
    let folder = folder.path();
    let first = json(folder, &["portfolio", "museum"]);
    refused(folder, &["portfolio", "museum"], &["report.html: exists already; expected --force"]);
    // Runs that no block would make: all of one object stand.
    for table in fs::read_dir(folder.join("portfolio/tall one/kept")).unwrap() {
        let table = table.unwrap().path();
        fs::write(&table, fs::read_to_string(&table).unwrap().replace(",overturned,", ",completed,")).unwrap();
    }
    let again = json(folder, &["portfolio", "museum", "--force"]);
    assert_eq!(again["objects"][0]["state"], first["objects"][1]["state"]);
    let last = &again["objects"][2];
    assert_eq!((&last["name"], &last["rank"]), (&"tall one".into(), &Value::Null));
    assert_eq!(last["state"]["runs"]["exceeded"], 0);
}

#[test]
fn studies_that_disagree_or_share_a_name_are_refused() {
    let folder = museum();
    let folder = folder.path();
    fs::create_dir(folder.join("empty")).unwrap();
    refused(folder, &["portfolio", "empty"], &["empty: the folder has no *.toml", "a study file *.toml with [assess]"]);
    refused(folder, &["portfolio", "absent.toml"], &["no study can be assessed: absent.toml: cannot be read"]);
    fs::write(folder.join("Broad.toml"), "").unwrap();
    let words = ["museum/broad.toml and Broad.toml have one name", "another name for each study file"];
    refused(folder, &["portfolio", "museum", "Broad.toml"], &words);

    put(folder, "other", &study("The broad", 0.2, WITH_HAZARD));
    let words = ["two objects have the title \"The broad\": museum/broad.toml and museum/other.toml"];
    refused(folder, &["portfolio", "museum"], &words);
    put(folder, "other", &study("Another", 0.2, &format!("{WITH_HAZARD}\nyears = 100")));
    let words = ["the years of the probabilities differ: museum/broad.toml has 50 and museum/other.toml 100"];
    refused(folder, &["portfolio", "museum"], &words);
    fs::write(folder.join("strong.csv"), HAZARD.replace("9e-7", "8e-7")).unwrap();
    put(folder, "other", &study("Another", 0.2, "hazard = { file = \"../strong.csv\" }"));
    let words = [
        "the hazards differ: museum/broad.toml has ../hazard.csv (6 levels of PGV) and museum/other.toml ../strong.csv",
        "expected one hazard for all objects",
    ];
    refused(folder, &["portfolio", "museum"], &words);
    // The same numbers under another name are one hazard.
    fs::write(folder.join("strong.csv"), HAZARD).unwrap();
    assert_eq!(names(&json(folder, &["portfolio", "museum"])).len(), 4);
}

/// An invalid study is named, and the others are there; an object without a hazard has no rank.
#[test]
fn an_invalid_study_does_not_cost_the_others() {
    let folder = museum();
    let folder = folder.path();
    put(folder, "invalid", &study("Invalid", 0.2, "years = 0"));
    put(folder, "middle", &study("The middle", 0.16, ""));
    let out = rocking(folder, &["portfolio", "museum"]);
    assert_eq!(out.status.code(), Some(1));
    let error = text(&out.stderr);
    let reason = "museum/invalid.toml:18: years = 0; expected a number > 0";
    assert!(error.contains(reason), "{error}");
    assert!(error.contains("1 of 4 studies could not be assessed: museum/invalid.toml"), "{error}");
    assert!(text(&out.stdout).contains(&format!("not assessed  {reason}")), "{}", text(&out.stdout));
    let page = fs::read_to_string(folder.join("portfolio/portfolio.html")).unwrap();
    assert!(page.contains("<h2>Not assessed</h2>") && page.contains("museum/invalid.toml:18: years = 0"));
    assert!(page.contains("the rate: the study names no hazard"));
    let table = Table::read(&folder.join("portfolio/portfolio.csv"));
    let rows: Vec<_> = (0..3).map(|row| (table.get(row, "object"), table.get(row, "rank"))).collect();
    assert_eq!(rows, [("The tall one", "1"), ("The broad", "2"), ("The middle", "")]);

    // Without the invalid study the call succeeds.
    fs::remove_file(folder.join("museum/invalid.toml")).unwrap();
    succeeds(&mut program(folder, &[&["portfolio", "museum", "--force"]]));
}
