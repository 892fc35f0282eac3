//! Blocks with an eccentric centre of mass, friction and ties: options, columns, limits.

use std::path::Path;

use serde_json::Value;

use crate::program::{RECORD, Table, program, refused, stdout, text};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn json(folder: &Path, arguments: &str) -> Value {
    let arguments: Vec<&str> = arguments.split_whitespace().chain(["--json", "--csv", "run.csv"]).collect();
    serde_json::from_str(&stdout(folder, &arguments)).unwrap()
}

#[test]
fn a_measured_body_has_its_own_angles_and_moment_of_inertia() {
    let folder = folder();
    let body =
        "--width 1.2 --center-height 1.4 --inertia 900 --mass 800 --stiffness 1e6 --damping 2e3 --eccentricity 0.2";
    let json = json(folder.path(), &format!("simulate --theta 0.05 {body}"));
    let number = |pointer: &str| json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"));
    // γ = M R0²/I0, α_L = arctan((b + e_x)/h).
    for (pointer, expected) in [
        ("/block/gamma", 800.0 * (0.36 + 1.96) / 900.0),
        ("/block/alpha_L", (0.8_f64 / 1.4).atan()),
        ("/block/alpha_R", (0.4_f64 / 1.4).atan()),
        ("/block/height", 2.8),
    ] {
        assert!((number(pointer) / expected - 1.0).abs() < 1e-14, "{pointer}: {}", number(pointer));
    }
}

/// The mirror image of a block under the mirror image of a pulse moves as its mirror image.
#[test]
fn mirror_images_move_as_mirror_images() {
    let folder = folder();
    let column = |sign: f64| {
        let run = format!(
            "simulate --pulse one-sine --amplitude {} --period 1 --alpha 0.2 --p 2 --eccentricity {}",
            sign * 3.0,
            sign * 0.1
        );
        json(folder.path(), &run);
        Table::read(&folder.path().join("run.csv")).column("theta")
    };
    let (one, other) = (column(1.0), column(-1.0));
    assert!(one.len() > 100 && one.iter().any(|theta| theta.abs() > 0.02));
    assert!(one.iter().zip(&other).all(|(one, other)| *one == -other));
}

/// Tables have columns for slip and tensions if the block has friction or ties.
#[test]
fn columns_follow_the_block() {
    let folder = folder();
    let own = |options: &str| -> Vec<String> {
        let json = json(folder.path(), &format!("simulate --theta 0.1 --duration 0.1 --mass 1000 {options}"));
        let table = Table::read(&folder.path().join("run.csv"));
        let fixed = table.headers.iter().position(|name| name == "a_gz [m/s2]").unwrap() + 1;
        assert_eq!(json["slip"].is_object(), options.contains("friction"));
        assert_eq!(json["ties"].as_array().map_or(0, Vec::len), options.matches("--tie").count());
        table.headers.iter().skip(fixed).map(String::from).collect()
    };
    assert_eq!(own(""), Vec::<String>::new());
    assert_eq!(own("--friction 0.4"), ["slip [m]", "slip_rate [m/s]", "energy.friction [J]"]);
    let ties = "--tie block_x=1,stiffness=1e3 --tie block_x=-1,stiffness=1e3";
    assert_eq!(own(ties), ["tie_1.tension [N]", "tie_2.tension [N]", "energy.ties [J]"]);
}

/// Dampers have columns, a place in the summary, events and loops.
#[test]
fn dampers_are_shown_with_their_loops() {
    let folder = folder();
    let damper =
        |x: f64| format!("--damper block_x={x},ground_x={x},ground_z=-1,stiffness=2e5,yield_force=900,hardening=0.05");
    let run = format!(
        "simulate --pulse one-sine --amplitude 5.5 --period 1.2 --alpha 0.25 --p 2 --mass 1000 --duration 4 --events {} {}",
        damper(-0.5),
        damper(0.5)
    );
    let found = json(folder.path(), &format!("{run} --plot-loops loops.svg"));
    let dampers = found["dampers"].as_array().unwrap();
    let number = |damper: &Value, key: &str| damper[key].as_f64().unwrap_or_else(|| panic!("{key}: {damper}"));
    assert_eq!(dampers.len(), 2);
    let table = Table::read(&folder.path().join("run.csv"));
    for (i, damper) in (1..).zip(dampers) {
        let greatest = |name: &str| table.column(name).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let force = greatest(&format!("damper_{i}.force"));
        let plastic = greatest(&format!("damper_{i}.plastic"));
        assert!(force <= number(damper, "peak_force") && force > 0.99 * number(damper, "peak_force"), "{damper}");
        assert!(
            plastic <= number(damper, "peak_plastic") && plastic > 0.99 * number(damper, "peak_plastic"),
            "{damper}"
        );
        assert!(number(damper, "yield_energy") >= 900.0 * number(damper, "peak_plastic") && damper["broken"] == false);
    }
    let taken: f64 = dampers.iter().map(|damper| number(damper, "yield_energy")).sum();
    let lost = found.pointer("/energy/dampers").and_then(Value::as_f64).unwrap();
    assert!((lost / taken - 1.0).abs() < 1e-6, "{lost} J, {taken} J");
    let events = found.pointer("/events/list").and_then(Value::as_array).unwrap();
    let of_first: Vec<&str> = events
        .iter()
        .filter(|event| event["corner"] == "damper 1")
        .map(|event| event["event"].as_str().unwrap())
        .collect();
    assert_eq!(of_first[..2], ["yield", "unload"]);
    let loops = std::fs::read_to_string(folder.path().join("loops.svg")).unwrap();
    assert!(loops.starts_with("<svg"), "{}", &loops[..80]);
    for (options, words) in [
        ("simulate --theta 0.1 --csv run.csv --plot-loops loops.svg", "--plot-loops has no effect without --damper"),
        ("simulate --theta 0.1 --csv run.csv --damper stiffness=1e5,ground_z=-1", "--damper without --mass"),
    ] {
        let arguments: Vec<&str> = options.split_whitespace().collect();
        refused(folder.path(), &arguments, &[words]);
    }
}

/// An invalid tie is an error of the command line, with status 2.
#[test]
fn an_invalid_tie_is_refused() {
    let folder = folder();
    for (tie, words) in [
        ("block_x=1", "expected a stiffness > 0"),
        ("stiffness=1e3", "distance of the ends of a tie = 0"),
        ("stiffness=1e3,block=2", "found key `block`; expected one of block_x"),
    ] {
        let arguments = ["simulate", "--theta", "0.1", "--mass", "5", "--csv", "run.csv", "--tie", tie];
        let output = program(folder.path(), &[&arguments]).output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("--tie") && message.contains(words), "{message}");
    }
}

#[test]
fn invalid_options_are_refused() {
    let folder = folder();
    for (options, words) in [
        ("--eccentricity -2", &["eccentricity = -2 m", "half the width"][..]),
        ("--friction 1.4 --foundation rigid", &["friction = 1.4", "rigid base", "1.33"]),
        ("--tie block_x=1,stiffness=1e3", &["--tie without --mass"]),
        ("--inertia 5", &["--inertia has no effect without --width"]),
        ("--center-height 5", &["--center-height has no effect without --width"]),
        ("--width 1 --center-height 2 --height 4 --foundation rigid", &["--height has no effect with --center-height"]),
        (
            "--width 1 --height 4 --inertia 9 --mass 3 --gamma 2 --foundation rigid",
            &["--gamma has no effect with --inertia"],
        ),
        ("--width 1 --height 4 --inertia 9 --foundation rigid", &["--inertia without --mass"]),
    ] {
        let arguments: Vec<&str> = "simulate --theta 0.1 --csv run.csv".split(' ').chain(options.split(' ')).collect();
        refused(folder.path(), &arguments, words);
    }
}

/// The search begins where the side with less base would lift; with ties, which may pull a block aside, it begins at zero.
#[test]
fn the_search_begins_at_the_weaker_side() {
    let folder = folder();
    let from = |options: &str| -> f64 {
        let search =
            "search overturning --foundation rigid --period 1 --alpha 0.25 --p 2 --points 3 --resolution 1 --csv s.csv";
        let arguments: Vec<&str> = search.split(' ').chain(options.split_whitespace()).collect();
        stdout(folder.path(), &arguments);
        Table::read(&folder.path().join("s.csv")).number(0, "from")
    };
    let even = 9.81 * 0.25_f64.tan();
    assert!((from("") / even - 1.0).abs() < 1e-14);
    // R0 = 3/4 g/p².
    let (b, h) = (0.75 * 9.81 / 4.0 * 0.25_f64.sin(), 0.75 * 9.81 / 4.0 * 0.25_f64.cos());
    assert!((from("--eccentricity -0.2") / (9.81 * (b - 0.2) / h) - 1.0).abs() < 1e-14);
    assert_eq!(from("--mass 1000 --tie block_z=1,ground_x=2,stiffness=1e3"), 0.0);
}

/// A study counts half cycles of its amplitude, and a fit takes a limit on them.
#[test]
fn half_cycles_of_dampers_are_a_column_and_a_limit() {
    let folder = folder();
    let study = "[study]\ndesign = \"grid\"\nhalf_cycles = 0.002\n[parameters]\nalpha = 0.25\np = [0.8, 1.5, 3]\npulse.shape = \"OneSine\"\n\
                 pulse.period = [0.5, 1.5]\npulse.amplitude = [1.5, 3, 4.5, 6]\nmass = 1000\ndamper_1.block_x = -0.8\ndamper_1.ground_x = -0.8\n\
                 damper_1.ground_z = -1\ndamper_1.stiffness = 5e5\ndamper_1.yield_force = 800\n";
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let exceeding = |limit: f64, column: &str| {
        let exceeds = |row: usize| table.get(row, "outcome") == "overturned" || table.number(row, column) > limit;
        (0..table.rows.len()).filter(|&row| exceeds(row)).count()
    };
    for (limit, word, expected) in [
        ("half_cycles:4", "half_cycles>4", exceeding(4.0, "half_cycles>0.002")),
        ("Plastic:0.05", "plastic>0.05", exceeding(0.05, "peak.damper_1.plastic")),
    ] {
        let options = ["fragility", "s.csv", "--im", "pulse.amplitude", "--json", "--limit", limit];
        let json: Value = serde_json::from_str(&stdout(folder.path(), &options)).unwrap();
        assert_eq!((json["limit"].as_str(), json["rows"]["exceeded"].as_f64()), (Some(word), Some(expected as f64)));
        assert!((5..20).contains(&expected), "{expected}");
    }
    for (old, new, words) in [
        (
            "damper_1.yield_force = 800\n",
            "",
            "wrong.toml:3: half_cycles = 0.002; expected none without a tie or damper with yield_force",
        ),
        ("half_cycles = 0.002", "half_cycles = 0", "wrong.toml:3: half_cycles = 0; expected a length > 0 m"),
        (
            "half_cycles = 0.002",
            "ensemble = { samples = 3, p = 0.1, limits = [\"half_cycles:2\"] }",
            "wrong.toml:3: limits = \"half_cycles:2\"",
        ),
    ] {
        std::fs::write(folder.path().join("wrong.toml"), study.replace(old, new)).unwrap();
        refused(folder.path(), &["sweep", "wrong.toml", "--csv", "w.csv"], &[words]);
    }
}

/// A sweep accepts the parameters of the FMU and limits on the slip; its columns cover the features of any of its blocks.
#[test]
fn a_sweep_has_columns_for_slip_and_tensions() {
    let folder = folder();
    let study = "[study]\ndesign = \"grid\"\nensemble = { samples = 3, p = 0.1, limits = [0.5, \"slip:0.1\"] }\n\
                 [parameters]\np = 2\nfriction = [\"none\", 0.4]\neccentricity = 0.05\npulse.shape = \"OneSine\"\n\
                 pulse.amplitude = 4\nmass = 1000\ntie_1.block_x = 0.4\ntie_1.stiffness = 1e3\nalpha = 0.25\n";
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let names: Vec<&str> = table.headers.iter().collect();
    for name in ["peak.slip [m]", "peak.tie_1.tension [N]", "P(theta/alpha>0.5) [1]", "P(slip>0.1) [1]"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert!(!names.contains(&"peak.tie_2.tension [N]"));
    for (old, new, words) in [
        ("tie_1.block_x = 0.4", "tie_1.block_x = 0", "study.toml:11: distance of the ends of tie_1 = 0"),
        ("slip:0.1", "slip:no", "study.toml:3: limits = \"slip:no\""),
        ("tie_1.block_x = 0.4", "tie_1.block_x = 0.4\ntie_2.block_x = 1", "tie_2.block_x is read by no block"),
        ("eccentricity = 0.05", "eccentricity = 5", "study.toml:7: eccentricity = 5 m"),
        (
            "[\"none\", 0.4]",
            "[0, 0.4]",
            "study.toml:6: friction = 0 is not valid; expected a number > 0, or none (inf)",
        ),
        (
            "[\"none\", 0.4]",
            "\"low\"",
            "study.toml:6: friction = \"low\"; expected a number > 0, or \"none\" for no limit",
        ),
        ("[\"none\", 0.4]", "{ from = 0.1, to = inf, count = 3 }", "study.toml:6: to = inf; expected a finite number"),
        ("p = 0.1,", "friction = 0.1, seed = 1, p = 0.1,", "study.toml:3: friction = inf cannot vary"),
    ] {
        std::fs::write(folder.path().join("study.toml"), study.replace(old, new)).unwrap();
        refused(folder.path(), &["sweep", "study.toml", "--csv", "t.csv"], &[words]);
    }
}

/// No limit of friction is `none` or `inf` for users; tables write it as infinity, which sorts after all limits.
#[test]
fn no_limit_of_friction_is_a_word_and_sorts_last_in_tables() {
    let folder = folder();
    let run = |options: &[&str]| {
        let run = [
            "simulate",
            "--pulse",
            "one-sine",
            "--amplitude",
            "5",
            "--period",
            "1",
            "--duration",
            "1",
            "--csv",
            "run.csv",
        ];
        stdout(folder.path(), &[&run[..], options].concat());
        std::fs::read(folder.path().join("run.csv")).unwrap()
    };
    let plain = run(&[]);
    for (wrong, words) in [
        ("0", "friction = 0 is not valid; expected a number > 0, or none (inf) for no limit"),
        ("-1", "friction = -1 is not valid"),
        ("low", "found `low`; expected a number > 0, or none for no limit"),
    ] {
        let output =
            program(folder.path(), &[&["simulate", "--csv", "run.csv", "--friction", wrong]]).output().unwrap();
        assert!(text(&output.stderr).contains(words) && output.status.code() == Some(2), "{}", text(&output.stderr));
    }
    for none in ["none", "None", "inf"] {
        assert!(run(&["--friction", none]) == plain, "{none}");
    }
    let study = |friction: &str| {
        let text = format!(
            "[study]\ndesign = \"grid\"\n[parameters]\nfriction = {friction}\npulse.shape = \"one-sine\"\npulse.amplitude = 5\n"
        );
        std::fs::write(folder.path().join("study.toml"), text).unwrap();
        stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv", "--force"]);
        Table::read(&folder.path().join("s.csv"))
    };
    for list in ["[\"none\", 0.05, 0.1]", "[inf, 0.05, 0.1]"] {
        let table = study(list);
        let column = |name: &str| [0, 1, 2].map(|row| table.number(row, name));
        assert_eq!(column("friction"), [f64::INFINITY, 0.05, 0.1]);
        let [free, low, high] = column("peak.slip");
        assert!(free == 0.0 && low > high && high > 0.0, "{free} {low} {high}");
    }
    assert!(!study("\"none\"").headers.iter().any(|heading| heading == "peak.slip [m]"));
}

/// A pulse, and two damped ties that catch a block on either side beyond its balance.
const HELD: &str = "--foundation rigid --alpha 0.2 --p 2 --mass 1000 --pulse one-sine --amplitude 4 --period 1.5 \
                    --tie block_z=1.8,ground_z=1.8,ground_x=-1.5,stiffness=6e4,slack=0.6,damping=2e4 \
                    --tie block_z=1.8,ground_z=1.8,ground_x=1.5,stiffness=6e4,slack=0.6,damping=2e4";

/// A block that hangs on a tie at the end passed its balance and is tilted; the one whose ties break says how many, and when.
#[test]
fn a_block_on_ties_says_what_happened_to_it() {
    let folder = folder();
    let simulate = |options: &str, more: &[&str]| {
        let arguments: Vec<&str> =
            "simulate --csv run.csv --step 0.01".split(' ').chain(options.split_whitespace()).collect();
        stdout(folder.path(), &[&arguments, more].concat())
    };
    let json = |options: &str| -> serde_json::Value { serde_json::from_str(&simulate(options, &["--json"])).unwrap() };
    let held = json(HELD);
    let table = Table::read(&folder.path().join("run.csv"));
    let rotations: Vec<f64> = table.column("theta").iter().map(|theta| theta.abs() / 0.2).collect();
    let peak = rotations.iter().copied().fold(0.0, f64::max);
    assert!(peak > 1.0 && *rotations.last().unwrap() > 1.0, "{peak} {:?}", rotations.last());
    assert_eq!(held["outcome"], "completed");
    assert_eq!([&held["passed_balance"], &held["ends_tilted"]], [true, true]);
    assert_eq!(held["end.theta/alpha"].as_f64().unwrap().abs(), *rotations.last().unwrap());
    assert!((held["peak"]["theta/balance"].as_f64().unwrap() / peak - 1.0).abs() < 1e-4);
    assert_eq!([&held["ties_broken"], &held["first_break"]], [&serde_json::json!(0), &serde_json::Value::Null]);
    let text = simulate(HELD, &[]);
    assert!(text.contains("the block is at rest, tilted") && text.contains("passed its balance"), "{text}");
    assert!(text.contains("ends tilted"), "{text}");

    let weak = HELD.replace("damping=2e4", "damping=2e4,strength=3e3");
    let broken = json(&format!("{weak} --events"));
    let breaks: Vec<f64> = broken["events"]["list"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|event| event["event"] == "break")
        .map(|event| event["t"].as_f64().unwrap())
        .collect();
    assert!(!breaks.is_empty());
    assert_eq!(broken["ties_broken"], breaks.len());
    assert_eq!(broken["first_break"], breaks[0]);
    let text = simulate(&weak, &[]);
    assert!(
        text.contains(&format!("broke, the first at t = {:.4} s", breaks[0])) || text.contains("1 tie broke, at t"),
        "{text}"
    );
}

/// Blocks that come to rest on ties beyond their balance are `completed` and exceed the usual limit of blocks with ties.
#[test]
fn blocks_that_hang_at_rest_on_ties_exceed_the_usual_limit() {
    let folder = folder();
    let ties = [(1, -1.5), (2, 1.5)].map(|(number, x)| {
        format!(
            "tie_{number}.block_z = 1.8\ntie_{number}.ground_z = 1.8\ntie_{number}.ground_x = {x}\ntie_{number}.stiffness = 6e4\n\
             tie_{number}.slack = 0.6\ntie_{number}.damping = 2e4\n"
        )
    });
    let study = "[study]\ndesign = \"grid\"\n[parameters]\nfoundation = \"rigid\"\nalpha = [0.18, 0.2, 0.22]\np = 2\nmass = 1000\n\
                 pulse.shape = \"one-sine\"\npulse.period = [0.8, 1.5]\npulse.amplitude = { from = 1.6, to = 4, count = 12 }\n";
    std::fs::write(folder.path().join("study.toml"), [study, &ties.concat()].concat()).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    assert!((0..table.rows.len()).all(|row| table.get(row, "outcome") == "completed"));
    let hanging = table.column("end.theta/alpha").iter().filter(|end| end.abs() > 1.0).count();
    let beyond = table.column("peak.theta/balance").iter().filter(|peak| **peak > 1.0).count();
    assert!(hanging > 3 && beyond >= hanging && beyond < table.rows.len(), "{hanging} {beyond}");
    let fitted = stdout(folder.path(), &["fragility", "s.csv", "--im", "pulse.amplitude", "--json"]);
    let fitted: serde_json::Value = serde_json::from_str(&fitted).unwrap();
    assert_eq!((fitted["limit"].as_str(), fitted["rows"]["exceeded"].as_f64()), (Some("balance"), Some(beyond as f64)));
}

/// The balance angle is that of the side on which the block is: `arctan((b ± e_x)/h)`.
#[test]
fn an_uneven_block_passes_the_balance_of_its_side() {
    let folder = folder();
    for amplitude in ["-6", "6"] {
        let options = "simulate --foundation rigid --alpha 0.25 --p 2 --eccentricity 0.1 --pulse one-sine --period 1 --json --csv run.csv \
                       --duration 4 --step 0.001 --amplitude";
        let arguments: Vec<&str> = options.split_whitespace().chain([amplitude]).collect();
        let found: serde_json::Value = serde_json::from_str(&stdout(folder.path(), &arguments)).unwrap();
        let table = Table::read(&folder.path().join("run.csv"));
        let sides = ["alpha_L", "alpha_R"].map(|side| found["block"][side].as_f64().unwrap());
        assert!((sides[0] / sides[1] - 1.0).abs() > 0.1);
        let over = |theta: f64| theta.abs() / if theta < 0.0 { sides[0] } else { sides[1] };
        let expected = table.column("theta").into_iter().map(over).fold(0.0, f64::max);
        let given = found["peak"]["theta/balance"].as_f64().unwrap();
        assert!((given / expected - 1.0).abs() < 1e-5 && expected > 0.05, "{amplitude}: {given} {expected}");
    }
}

/// Blocks that swing on elastic ties beyond their balance are undecided for overturning: never dropped in silence, they give a range, and the
/// usual limit counts them.
#[test]
fn undecided_blocks_on_ties_are_counted_or_give_a_range() {
    let folder = folder();
    let tie = |number: u8, x: f64| {
        format!(
            "tie_{number}.block_z = 1.8\ntie_{number}.ground_z = 1.8\ntie_{number}.ground_x = {x}\ntie_{number}.stiffness = 2e4\n\
             tie_{number}.slack = 0.6\ntie_{number}.damping = 500\n"
        )
    };
    let study = "[study]\ndesign = \"grid\"\n[parameters]\nfoundation = \"rigid\"\nalpha = [0.19, 0.2, 0.21]\np = 2\nmass = 1000\n\
                 restitution_factor = 0.9\npulse.shape = \"one-sine\"\npulse.period = 1.5\n\
                 pulse.amplitude = { from = 1.6, to = 3, count = 16 }\n";
    std::fs::write(folder.path().join("study.toml"), [study, &tie(1, -1.5), &tie(2, 1.5)].concat()).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
    let table = Table::read(&folder.path().join("s.csv"));
    let count = |is: &dyn Fn(f64, bool) -> bool| {
        let row = |row: &usize| is(table.number(*row, "peak.theta/alpha"), table.get(*row, "outcome") == "undecided");
        (0..table.rows.len()).filter(row).count() as f64
    };
    let fragility = |limit: &[&str]| -> serde_json::Value {
        let arguments = [&["fragility", "s.csv", "--im", "pulse.amplitude", "--json"], limit].concat();
        serde_json::from_str(&stdout(folder.path(), &arguments)).unwrap()
    };
    let usual = fragility(&[]);
    assert!(count(&|peak, undecided| undecided && peak > 1.0) > 3.0);
    assert_eq!(
        (usual["limit"].as_str(), usual["rows"]["exceeded"].as_f64()),
        (Some("balance"), Some(count(&|peak, _| peak > 1.0)))
    );
    let higher = fragility(&["--limit", "2.5"]);
    let (known, open) = (count(&|peak, _| peak > 2.5), count(&|peak, undecided| undecided && peak <= 2.5));
    assert!(known > 3.0 && open > 2.0, "{known} {open}");
    assert_eq!(higher["rows"]["exceeded"], known);
    assert_eq!(higher["rows"]["exceeded_at_most"], known + open);
    assert!(higher["warnings"][0].as_str().unwrap().contains("may exceed the limit"), "{}", higher["warnings"]);
}

/// The limit `breaks`: the rows in which a tie broke, and those that overturned.
#[test]
fn a_broken_tie_is_a_limit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study = format!(
        "[study]\ndesign = \"grid\"\nlevels = {{ im = \"PGV\", values = [0.1, 0.2, 0.3, 0.4, 0.6, 0.8] }}\n[parameters]\nfoundation = \"rigid\"\n\
         parameterization = \"physical\"\nphysical.width = 0.5\nphysical.center_height = [1.0, 1.2]\nmass = 500\ntie_1.stiffness = 1e5\n\
         tie_1.block_x = -0.25\ntie_1.block_z = 2\ntie_1.ground_x = -1\ntie_1.ground_z = 2\ntie_1.strength = [500, 1500, 4000]\n\
         [[records]]\nhorizontal = \"{}\"\npolarity = \"both\"\n",
        RECORD.replace("np01002p_4225a_a", "*")
    );
    std::fs::write(folder.join("study.toml"), &study).unwrap();
    stdout(folder, &["sweep", "study.toml", "--csv", "runs.csv"]);
    let table = Table::read(&folder.join("runs.csv"));
    let rows = || 0..table.rows.len();
    let breaks = |row: &usize| table.number(*row, "ties.broken") > 0.0;
    let expected = rows().filter(|row| breaks(row) || table.get(*row, "outcome") == "overturned").count();
    assert!(rows().filter(breaks).count() > 5 && rows().filter(|row| !breaks(row)).count() > 5);
    let found = stdout(folder, &["fragility", "runs.csv", "--im", "PGV", "--limit", "Breaks"]);
    assert!(found.contains(&format!("breaks: exceeded in {expected} of {} rows", table.rows.len())), "{found}");

    let study = study.replace("levels =", "ensemble = { scale = 0.1, samples = 4, limits = [\"breaks\"] }\nlevels =");
    std::fs::write(folder.join("study.toml"), study).unwrap();
    stdout(folder, &["sweep", "study.toml", "--csv", "ensemble.csv"]);
    let table = Table::read(&folder.join("ensemble.csv"));
    assert!(table.column("P(breaks)").iter().any(|p| *p > 0.0 && *p < 1.0));
}
