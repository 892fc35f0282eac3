//! The page of a report: its sentences, and the commands that it prints.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{STUDY, folder, json};

/// A director reads the verdict first, without symbols, then remarks on forces and slips that no anchor or wall allows.
#[test]
fn the_page_is_written_for_its_reader() {
    let links = "mass = 500\nfriction = { from = 0.2, to = 0.4 }\ntie_1.block_x = -0.3\ntie_1.block_z = 2\ntie_1.ground_x = -0.4\ntie_1.ground_z = 2\n\
                 tie_1.stiffness = 2e5\ntie_1.strength = 1e5\ndamper_1.stiffness = 1e5\ndamper_1.block_x = 0.2\ndamper_1.ground_x = 0.2\n\
                 damper_1.ground_z = -0.3\n";
    let assess = "[assess]\ntitle = \"Tied\"\nauthor = \"A. N. Engineer\"\ndate = \"2026-11-29\"\npulse_periods = [1]\n\
                  hazard = { file = \"hazard.csv\" }\nstates = [{ name = \"a\", limit = 0.3 }, { name = \"b\", limit = \"balance\" }]\n";
    let folder = folder("");
    let folder = folder.path();
    let study = STUDY
        .replace("[[records]]", &format!("{links}[[records]]"))
        .replace("samples = 4", "samples = 2")
        .replace("{ from = 0.9, to = 0.98 }", "[0.9, 0.98]");
    fs::write(folder.join("study.toml"), study + assess).unwrap();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    let object = &report["object"];
    assert_eq!((&object["ties"], &object["dampers"]), (&1.into(), &1.into()));
    let range =
        object["friction_range"].as_array().unwrap().iter().map(|end| end.as_f64().unwrap()).collect::<Vec<_>>();
    assert!(range[0] < 0.3 && range[0] < range[1] && range[1] < 0.4, "{object}");
    let page = fs::read_to_string(folder.join("report/report.html")).unwrap();
    let place = |words: &str| page.find(words).unwrap_or_else(|| panic!("{words} is missing"));
    let verdict = place("<p class=\"verdict\">The object ");
    assert!(place("A. N. Engineer, 2026-11-29.") < verdict && verdict < place("<h2>Summary</h2>"));
    let verdict = &page[verdict..place("<h2>Summary</h2>")];
    assert_eq!(verdict.matches("<br>").count(), 1, "two sentences: {verdict}");
    assert!(!["θ", "α", "β"].iter().any(|symbol| verdict.contains(symbol)), "{verdict}");
    for (word, meaning) in
        [("PGV", "peak ground velocity"), ("PGA", "peak ground acceleration"), ("θ", "rotation"), ("β", "dispersion")]
    {
        place(&format!("<dt>{word}</dt><dd>{meaning}"));
    }
    for words in [
        "or of a list of values with the one after its middle",
        "(2 blocks × 2 ground motions × 5 strengths)",
        "runs its tie breaks",
        "<tr><td>dampers</td><td class=\"n\">1</td>",
        "The feet of the runs slide at μ = ",
        "These commands give the numbers of this report, to the last digit.",
        "of 2 ground motions more than 4 times stronger, ",
        "A tie pulls with more than the weight of the object, up to ",
        "The object slips as far as the wall that holds its ties",
    ] {
        place(words);
    }
    for words in ["Runs beyond over", "1 blocks", "have the bits", "overturns: overturning"] {
        assert!(!page.contains(words), "{words}");
    }
    let slip = report["variants"][0]["peak_slip"].as_f64().unwrap();
    assert!(slip > report["variants"][0]["anchor_distance"].as_f64().unwrap(), "{slip} m");
}

/// The page remarks on what `rocking fragility` warns of, and gives a falling curve no median.
#[test]
fn doubts_about_curves_are_remarks() {
    let assess = "[assess]\ntitle = \"a\"\npulse_periods = [1]\nim = \"PGA\"\nvariants = [{ name = \"wider\", width = 1.1 }]\n\
                  sensitivity = { p = [2.0, 2.4] }\n";
    let crossing = folder(assess);
    let report = json(crossing.path(), &["assess", "study.toml", "--out", "report"]);
    let remarks = report["remarks"].to_string();
    assert!(
        remarks.contains("States: the curves of “rocks half way” and “overturns” cross at PGA = 0.344 m/s2"),
        "{remarks}"
    );
    // A slow pulse overturns where a fast one of greater acceleration does not.
    let folder = folder("");
    let folder = folder.path();
    for (name, hertz, peak) in [("slow", 0.7, 0.25), ("fast", 8.0, 0.6)] {
        let value = |t: f64| if t <= 2.0 / hertz { peak * (std::f64::consts::TAU * hertz * t).sin() } else { 0.0 };
        let rows: String =
            (0..400).map(f64::from).map(|i| format!("{:.2},{:.6}\n", 0.01 * i, value(0.01 * i))).collect();
        fs::write(folder.join(format!("{name}.csv")), format!("t [s],a [g]\n{rows}")).unwrap();
    }
    let levels = "levels = { im = \"PGV\", values = [0.2, 0.4, 0.6, 0.9, 1.4] }";
    let study = STUDY.replace(levels, "scales = [0.8, 0.9, 1.0, 1.2, 1.5]").replace("*.smc", "[sf]*[wt].csv");
    fs::write(folder.join("study.toml"), study + assess).unwrap();
    let report = json(folder, &["assess", "study.toml", "--out", "report"]);
    let state = &report["states"][2];
    assert!(state["curve"].is_null(), "{state}");
    let families = "[study]\ndesign = \"grid\"\nscales = [0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5, 1.7, 1.8, 1.9, 2.0]\n\
                    [parameters]\nfoundation = \"rigid\"\nalpha = [0.1, 0.105, 0.11, 0.36, 0.38, 0.4]\np = [2.0, 2.1]\n\
                    [[records]]\nhorizontal = \"slow.csv\"\n";
    fs::write(folder.join("families.toml"), families.to_owned() + assess).unwrap();
    // Slender blocks and stocky ones are no lognormal family.
    let remarks = json(folder, &["assess", "families.toml", "--out", "families"])["remarks"].to_string();
    let poor = "“rocks visibly” fits its runs poorly: of samples of a true curve, less than 0.3 % deviate as far.";
    assert!(remarks.contains(poor), "{remarks}");
    assert!(
        state["no_curve"]
            .as_str()
            .unwrap()
            .starts_with("the probability of exceeding the limit falls as PGA grows (β = -")
    );
}

/// The first lines of code of a page: its commands.
fn commands(page: &str) -> Vec<String> {
    let code = page.split("<pre>").nth(1).unwrap().split("</pre>").next().unwrap();
    let plain = code
        .replace("&#60;", "<")
        .replace("&#62;", ">")
        .replace("&#34;", "\"")
        .replace("&#39;", "'")
        .replace("&#38;", "&");
    plain.replace(" \\\n    ", " ").lines().filter(|line| !line.is_empty()).map(String::from).collect()
}

/// Parameters of viscoelastic supports.
const SUPPORTS: &str = "eta = 35\nxi_v = 0.2\nepsilon = 0.1\n";

/// A report prints commands that a shell runs, with all options of the study, and the numbers of the report.
#[cfg(unix)]
#[test]
fn printed_commands_run_for_studies_with_every_optional_part() {
    let hazard =
        "hazard = { file = \"two sites.csv\", site = [-12.5, 41.9], unit = \"cm/s\", investigation_time = 50 }\n";
    let sites =
        "name,lon,lat,5,20,80,200\nit's Rome,-12.5,41.9,0.4,0.05,5e-3,2e-4\nMilan,9.2,45.5,1e-2,1e-3,1e-4,1e-5\n";
    let states = "states = [{ name = \"a\", limit = 0.6 }, { name = \"slips\", limit = \"slip:0.1\" }, { name = \"o\", limit = \"overturned\" }]\n";
    let ties = "mass = 1000\nfriction = 0.4\ntie_1.block_z = 3\ntie_1.ground_x = -2\ntie_1.ground_z = 3\ntie_1.stiffness = 2e3\n\
                tie_1.strength = 1e3\n";
    let building =
        "[building]\nfloor_masses = [2e5, 2e5]\nstorey_stiffnesses = [1.5e8, 1.2e8]\ndamping = 0.05\nfloors = [1, 2]\n";
    for (parameters, extra, assess) in [
        ("", "", format!("[assess]\ntitle = \"a\"\npulse_periods = [1]\nim = \"PGV\"\n{hazard}")),
        (ties, "", format!("[assess]\ntitle = \"a\"\npulse_periods = [1]\n{hazard}{states}")),
        ("mass = 1000\n", building, "[assess]\ntitle = \"a\"\npulse_periods = [1]\nim = \"PFV\"\n".to_string()),
        (SUPPORTS, "", format!("[assess]\ntitle = \"a\"\npulse_periods = [1]\nim = \"PGV\"\n{hazard}")),
    ] {
        let folder = folder("");
        let folder = folder.path();
        let levels = "values = [0.2, 0.4, 0.6, 0.9, 1.4]";
        let rigid = "foundation = \"rigid\"";
        let factor = "restitution_factor = { from = 0.9, to = 0.98 }\n";
        let [base, factor_here] = if parameters == SUPPORTS { ["", ""] } else { [rigid, factor] };
        let study = STUDY
            .replace("[[records]]", &format!("{parameters}[[records]]"))
            .replace(rigid, base)
            .replace(factor, factor_here)
            .replace(levels, "values = [0.2, 0.5, 0.9]");
        fs::write(folder.join("my study.toml"), study + extra + &assess).unwrap();
        fs::write(folder.join("two sites.csv"), sites).unwrap();
        let report = json(folder, &["assess", "my study.toml", "--out", "first"]);
        let page = fs::read_to_string(folder.join("first/report.html")).unwrap();
        let path = format!(
            "{}:{}",
            Path::new(env!("CARGO_BIN_EXE_rocking")).parent().unwrap().display(),
            std::env::var("PATH").unwrap()
        );
        let commands = commands(&page);
        assert!(commands.iter().any(|command| command.contains("rocking rate")) || !extra.is_empty(), "{commands:?}");
        let searches = parameters.is_empty() || parameters == SUPPORTS;
        assert_eq!(commands.iter().any(|command| command.contains("rocking search")), searches);
        for command in &commands {
            let command = if command.contains("rocking rate") { format!("{command} --json") } else { command.clone() };
            let output = std::process::Command::new("sh")
                .args(["-c", &command])
                .current_dir(folder)
                .env("PATH", &path)
                .output()
                .unwrap();
            let errors = String::from_utf8_lossy(&output.stderr);
            // A curve that the report does not have either.
            let no_curve = report["states"][report["compared_state"].as_u64().unwrap() as usize]["curve"].is_null();
            assert!(output.status.success() || no_curve && errors.contains("found "), "{command}: {errors}");
            if command.contains("rocking rate") && output.status.success() {
                let alone: Value = serde_json::from_slice(&output.stdout).unwrap();
                let state = &report["states"][report["compared_state"].as_u64().unwrap() as usize];
                assert_eq!(state["rate"]["rate"], alone["rate"]);
            }
        }
        assert_eq!(fs::read(folder.join("report/report.html")).unwrap(), page.into_bytes());
    }
}

/// Runs of unknown outcome give a rate its range, and variants without any exceedance stand before those with a rate.
#[test]
fn variants_without_exceedance_come_first() {
    let assess = "[assess]\ntitle = \"a\"\npulse_periods = [1]\nhazard = { file = \"hazard.csv\" }\n\
                  variants = [{ name = \"much wider\", width = 3.0 }, { name = \"a little wider\", width = 1.05 }]\n";
    let folder = folder(assess);
    let report = json(folder.path(), &["assess", "study.toml", "--out", "report"]);
    let [plain, none, little] = [0, 1, 2].map(|i| &report["variants"][i]);
    assert!(plain["runs"]["exceeded"] != 0 && none["runs"]["exceeded"] == 0 && !little["rate"].is_null(), "{report}");
    let page = fs::read_to_string(folder.path().join("report/report.html")).unwrap();
    let first = "Of the variants, “much wider” helps most: no exceedance among 2 motions up to a PGV of 1.4 m/s. Of the variants \
                 with an annual rate, “a little wider” helps most: ";
    assert!(page.contains(first), "{page}");
}
