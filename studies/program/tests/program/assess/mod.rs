//! Reports on an object: their numbers equal those of the single commands, their bytes, and refusals; [`page`] has the words, [`in_space`] objects in space.

mod in_space;
mod page;

use std::fs;
use std::path::Path;
use std::process::Command;

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
    let records = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records");
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
    let names = reported(&folder.join("one"));
    for name in ["report.html", "runs.csv", "variants.csv", "states.csv", "spectrum.csv", "sketch.png", "rate.png"] {
        assert!(names.iter().any(|known| known == name), "{name} is not in {names:?}");
    }
    assert_eq!(names, reported(&folder.join("two")));
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
        (
            "[assess]\ntitle = \"a\"\nname = 1\n",
            &["study.toml:15: there is no name in assess; expected one of author, date, hazard, im"],
        ),
        ("[assess]\ntitle = \"a\"\nim = \"PFA\"\n", &["study.toml:15: im = \"PFA\"; expected one of PGA"]),
        ("[assess]\ntitle = \"a\"\nhazard = { file = \"no.csv\" }\n", &["study.toml:15: no.csv: cannot be read"]),
        (
            "[assess]\ntitle = \"a\"\nim = \"PGA\"\nhazard = { file = \"hazard.csv\" }\n",
            &["study.toml:16: hazard.csv: found a hazard curve of PGV; expected one of PGA"],
        ),
        (
            "[assess]\ntitle = \"a\"\nhazard = { file = \"hazard.csv\", unit = \"in/s\" }\n",
            &["study.toml:15: hazard.csv: found the unit in/s; expected m/s, as the file says"],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", parameters = { eta = 20 } }]\n",
            &[
                "study.toml:15: b: dimensionless.eta is read by no block of the study; expected foundation = Viscoelastic",
            ],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", ties = 10, parameters.tie_1.block_x = 1 }]\n",
            &["study.toml:15: b: tie_1.block_x is read by no block of the study; expected tie_1.stiffness"],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", parameters = { tie_1.damping = 9 } }]\n",
            &["study.toml:15: b: tie_1.damping is read by no block of the study; expected tie_1.stiffness"],
        ),
        (
            "[assess]\ntitle = \"a\"\nsensitivity = { eta = [20, 80] }\n",
            &["study.toml:15: dimensionless.eta is read by no block of the study; expected foundation = Viscoelastic"],
        ),
        (
            "[assess]\ntitle = \"a\"\nvariants = [{ name = \"b\", parameters = { p = -1 } }]\n",
            &["study.toml:15:", "-1", "expected"],
        ),
        (
            "[assess]\ntitle = \"a\"\nstates = [{ name = \"slips\", limit = \"slip:0.1\" }]\n",
            &["study.toml:15: a limit on the slip without friction; expected friction in [parameters]"],
        ),
        (
            "[assess]\ntitle = \"a\"\nstates = [{ name = \"o\", limit = \"overturned\" }, { name = \"r\", limit = 0.5 }]\n",
            &["study.toml:15: r = theta/alpha>0.5 after o = overturned; expected the least severe state first"],
        ),
        (
            "[assess]\ntitle = \"a\"\nstates = [{ name = \"a\", limit = 0.5 }, { name = \"b\", limit = 0.3 }]\n",
            &["study.toml:15: b = theta/alpha>0.3 after a = theta/alpha>0.5; expected the least severe state first"],
        ),
        (
            "[assess]\ntitle = \"a\"\nstates = [{ name = \"yields\", limit = \"plastic:0.02\" }]\n",
            &[
                "study.toml:15: a limit on plastic elongations without a tie or damper that yields; expected yield_force",
            ],
        ),
    ] {
        let folder = folder(assess);
        refused(folder.path(), &["assess", "study.toml"], words);
        let left = files(folder.path());
        assert!(!folder.path().join("report/report.html").exists(), "{left:?}");
    }
}

/// A file of several sites: the choice is a name, or coordinates as text or as a list.
#[test]
fn a_site_is_a_name_or_a_list_of_coordinates() {
    let study = |site: &str| {
        let folder = folder(&format!("[assess]\ntitle = \"a\"\nhazard = {{ file = \"sites.csv\", site = {site} }}\n"));
        let sites = "name,lon,lat,5,20,80\nRome,12.5,41.9,1e-2,1e-3,1e-4\nMilan,9.2,45.5,1e-3,1e-4,1e-5\n";
        fs::write(folder.path().join("sites.csv"), sites).unwrap();
        folder
    };
    for (site, words) in [
        ("[12.5, 41]", "study.toml:15: sites.csv: found no site 12.5,41; expected one such as Rome; Milan"),
        (
            "[12.5]",
            "study.toml:15: site = [12.5]; expected a text in quotes or a list of 2 values, each a finite number",
        ),
        ("[\"Rome\"]", "study.toml:15: site = [\"Rome\"]; expected a text in quotes or a list of 2 values"),
    ] {
        refused(study(site).path(), &["assess", "study.toml"], &[words]);
    }
    let rate =
        |site: &str| json(study(site).path(), &["assess", "study.toml", "--out", "o"])["states"][2]["rate"].clone();
    assert_eq!(rate("[12.5, 41.9]"), rate("\"Rome\""));
}

/// In a building, the ground has the pulses and the floor the threshold: a stiff one moves with the ground.
#[test]
fn pulses_and_thresholds_go_through_the_building() {
    let assess = "[assess]\ntitle = \"a\"\npulse_periods = [0.8]\nvariants = [{ name = \"wide\", width = 1.1 }]\nsensitivity = { p = [2.1, 2.3] }\n";
    let building = |stiffness: &str| {
        format!(
            "[building]\nfloor_masses = [1e5]\nstorey_stiffnesses = [{stiffness}]\ndamping = 0.05\nfloors = [1]\n{assess}"
        )
    };
    let report = |text: &str| {
        let folder = folder(text);
        let report = json(folder.path(), &["assess", "study.toml", "--out", "report"]);
        let table = Table::read(&folder.path().join("report/runs.csv"));
        (report, fs::read_to_string(folder.path().join("report/report.html")).unwrap(), table)
    };
    let (ground, page, _) = report(assess);
    assert!(page.contains("horizontal ground acceleration") && !page.contains("PFA"));
    // 16 periods of 0.01 s in a sample of the pulse.
    let (stiff, page, table) = report(&building("4e12"));
    let least = |report: &Value| report["pulses"][0]["amplitude"].as_f64().unwrap();
    assert!((least(&stiff) / least(&ground) - 1.0).abs() < 2e-3, "{} {}", least(&stiff), least(&ground));
    assert_eq!([&stiff["pulses"][0]["floor"], &stiff["building"]["floors"]], [1, 1]);
    for words in
        ["It stands on floor 1 of an elastic building of one floor", "horizontal floor acceleration", "PFA (g)"]
    {
        assert!(page.contains(words), "{words}");
    }
    let (soft, _, soft_table) = report(&building("6e6"));
    assert!(least(&soft) < 0.9 * least(&ground), "{} {}", least(&soft), least(&ground));
    // The PGA of the ground at which the floor meets the threshold, from the columns of the runs.
    for (report, table) in [(&stiff, table), (&soft, soft_table)] {
        let threshold = report["object"]["static_threshold"].as_f64().unwrap();
        let [pga, pfa] = ["PGA", "PFA"].map(|name| table.column(name));
        let expected = pga.iter().zip(&pfa).map(|(pga, pfa)| threshold * pga / pfa).fold(f64::INFINITY, f64::min);
        let found = report["building"]["least_pga"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// Blocks that hang on damped ties at the end have come to rest, and count as beyond the limit of tied blocks.
#[test]
fn blocks_that_hang_on_ties_are_not_counted_as_standing() {
    let variant = "[assess]\ntitle = \"T\"\nvariants = [{ name = \"loose\", ties = 10, parameters = { tie_1.slack = 0.45, tie_2.slack = 0.45, \
                   tie_1.damping = 2e4, tie_2.damping = 2e4 } }]\nsensitivity = {}\n";
    let folder = folder(variant);
    let report = json(folder.path(), &["assess", "study.toml", "--out", "report"]);
    let [plain, loose] = [0, 1].map(|variant| &report["variants"][variant]);
    assert_eq!((plain["limit"].as_str(), loose["limit"].as_str()), (Some("overturned"), Some("balance")));
    let exceeded = loose["runs"]["exceeded"].as_u64().unwrap();
    assert!(exceeded > 3, "{loose}");
    let table = Table::read(&folder.path().join("report/variants.csv"));
    assert_eq!([0, 1].map(|row| table.get(row, "limit")), ["overturned", "balance"]);
    assert_eq!([0, 1].map(|row| table.number(row, "runs") + table.number(row, "unknown")), [40.0, 40.0]);
    let page = fs::read_to_string(folder.path().join("report/report.html")).unwrap();
    assert!(page.contains(&format!(
        "{exceeded} of 40 runs pass their balance; as it is, {} overturn.",
        plain["runs"]["exceeded"]
    )));
}

/// A ground motion named twice would make one curve of two: it is refused before the first run.
#[test]
fn a_ground_motion_is_named_once() {
    let folder = folder("[[records]]\nhorizontal = \"0111a.smc\"\n[assess]\ntitle = \"a\"\n");
    refused(folder.path(), &["assess", "study.toml"], &["0111a.smc twice; expected each ground motion once"]);
}

/// The files of a report, without the rows that it keeps.
fn reported(folder: &Path) -> Vec<String> {
    files(folder).into_iter().filter(|name| name != "kept").collect()
}

/// A second call with another title computes nothing again, and one after an interruption only the missing runs. Damaged rows are made again. The files
/// equal those of a fresh call.
#[test]
fn rows_are_kept_between_calls() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let steps = |report: &Value| -> Vec<(String, u64, u64)> {
        let step = |step: &Value| {
            (step["name"].as_str().unwrap().into(), step["runs"].as_u64().unwrap(), step["kept"].as_u64().unwrap())
        };
        report["steps"].as_array().unwrap().iter().map(step).collect()
    };
    let first = steps(&json(folder, &["assess", "study.toml", "--out", "report"]));
    let names: Vec<&str> = first.iter().map(|(name, ..)| name.as_str()).collect();
    assert_eq!(names[..4], ["the object", "sliding", "wider", "friction 0.3"]);
    assert_eq!(names[names.len() - 2..], ["other sizes", "pulses"]);
    assert!(first.iter().all(|(_, runs, kept)| *runs > 0 && *kept == 0), "{first:?}");
    let study = fs::read_to_string(folder.join("study.toml")).unwrap();
    fs::write(folder.join("study.toml"), study.replace("Test <block>", "Another")).unwrap();
    let tables =
        || fs::read_dir(folder.join("report/kept")).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let mut all = tables();
    all.sort();
    assert_eq!(all.len(), first.len() - 1);
    // Cut in the middle of a row, and changed.
    let text = fs::read_to_string(&all[0]).unwrap();
    fs::write(&all[0], &text[..text.len() / 2]).unwrap();
    let text = fs::read_to_string(&all[1]).unwrap();
    fs::write(&all[1], text.replace("\n3,", "\n7,")).unwrap();
    // The page is another one.
    refused(
        folder,
        &["assess", "study.toml", "--out", "report"],
        &["report.html: exists already; expected --force to replace it"],
    );
    let second = steps(&json(folder, &["assess", "study.toml", "--out", "report", "--force"]));
    let part = second.iter().filter(|(_, runs, kept)| *kept > 0 && kept < runs).count();
    let whole = second.iter().filter(|(_, runs, kept)| kept == runs).count();
    assert_eq!((part, whole), (1, first.len() - 3), "{second:?}");
    stdout(folder, &["assess", "study.toml", "--out", "fresh"]);
    for name in reported(&folder.join("fresh")) {
        let [kept, fresh] = ["report", "fresh"].map(|out| fs::read(folder.join(out).join(&name)).unwrap());
        assert!(kept == fresh, "{name} differs");
    }
    assert_eq!(tables().len(), all.len());
}

/// Rows of another build of the program are not used: its steps may differ.
#[test]
fn rows_of_another_program_are_made_again() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let program = folder.join("rocking");
    let built = fs::read(env!("CARGO_BIN_EXE_rocking")).unwrap();
    fs::copy(env!("CARGO_BIN_EXE_rocking"), &program).unwrap();
    // Bytes after the end of a program do not change it.
    let kept = |bytes: &[u8]| -> Vec<u64> {
        fs::write(&program, [&built, bytes].concat()).unwrap();
        let made = Command::new(&program)
            .args(["assess", "study.toml", "--json", "--force"])
            .current_dir(folder)
            .output()
            .unwrap();
        let report: Value = serde_json::from_slice(&made.stdout).unwrap();
        let steps = report["result"]["steps"].as_array().or(report["steps"].as_array()).unwrap();
        steps.iter().map(|step| step["kept"].as_u64().unwrap()).collect()
    };
    assert!(kept(b"").iter().all(|&kept| kept == 0));
    assert!(kept(b"").iter().any(|&kept| kept > 0));
    assert!(kept(b"another").iter().all(|&kept| kept == 0));
}

/// A comment behind a value changes no row: the table is continued.
#[test]
fn a_comment_behind_a_value_is_no_other_study() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    stdout(folder, &["sweep", "study.toml", "--csv", "runs.csv"]);
    let study = fs::read_to_string(folder.join("study.toml")).unwrap();
    fs::write(folder.join("study.toml"), study.replace("p = 2.2", "p = 2.2 # [rad/s], measured")).unwrap();
    let printed = stdout(folder, &["sweep", "study.toml", "--csv", "runs.csv", "--resume"]);
    assert!(printed.contains("40, 40 resumed"), "{printed}");
    let help = stdout(folder, &["fragility", "--help"]);
    assert!(help.contains("half_cycles:20"), "{help}");
}

/// A report on an uneven object under both polarities: the runs double, the ground motions do not.
#[test]
fn both_polarities_are_one_ground_motion() {
    let folder = folder(ASSESS);
    let folder = folder.path();
    let study = STUDY.replace("p = 2.2", "p = 2.2\neccentricity = 0.03") + "polarity = \"both\"\n" + ASSESS;
    fs::write(folder.join("study.toml"), study).unwrap();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    assert_eq!((report["motions"].as_array().unwrap().len(), &report["reversed"]), (2, &2.into()));
    assert_eq!(report["runs"], 80);
    let page = fs::read_to_string(folder.join("report/report.html")).unwrap();
    assert!(page.contains("80 runs (4 blocks × 2 ground motions in both polarities × 5 strengths)"));
    assert!(page.contains("computed runs under 2 ground motions in both polarities"));
}
