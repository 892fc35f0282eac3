//! Choices in any case, sizes instead of angles, and errors of the command line.

use rocking_block::excitation::Pulse;
use rocking_studies::spec::{BlockSpec, option};

use crate::program::{refusal, rocking, stdout, text};

/// Study file with these words for its choices.
fn study(words: [&str; 5]) -> String {
    let [design, foundation, separation, shape, spacing] = words;
    format!(
        "[study]\ndesign = \"{design}\"\n[parameters]\nalpha = 0.2\np = {{ from = 2, to = 3, count = 2, spacing = \"{spacing}\" }}\n\
         foundation = \"{foundation}\"\non_separation = \"{separation}\"\npulse.shape = \"{shape}\"\npulse.amplitude = 5\n\
         pulse.period = 1\n"
    )
}

/// Study files take the words of the program and of the FMU, in any case; tables hold those of the program.
#[test]
fn choices_are_read_in_any_case() {
    let folder = tempfile::tempdir().unwrap();
    let mut tables = Vec::new();
    for words in [
        ["grid", "rigid", "fly", "one-sine", "log"],
        ["GRID", "Rigid", "Fly", "OneSine", "LOG"],
        ["Grid", "RIGID", "FLY", "ONE_SINE", "Log"],
    ] {
        std::fs::write(folder.path().join("study.toml"), study(words)).unwrap();
        let table = stdout(folder.path(), &["sweep", "study.toml", "--csv", "-"]);
        tables.push(table.lines().filter(|line| !line.starts_with('#')).map(String::from).collect::<Vec<_>>());
    }
    assert!(tables.iter().all(|table| *table == tables[0]));
    assert!(
        tables[0][0].starts_with("row,alpha [rad],p [rad/s],foundation,on_separation,pulse.shape,"),
        "{}",
        tables[0][0]
    );
    assert!(tables[0][1].starts_with("0,0.2,2,rigid,fly,one-sine,"), "{}", tables[0][1]);
    let old = study(["grid", "rigid", "fly", "one-sine", "log"]).replace("alpha =", "dimensionless.alpha =");
    std::fs::write(folder.path().join("study.toml"), &old).unwrap();
    let table = stdout(folder.path(), &["sweep", "study.toml", "--csv", "-"]);
    assert!(table.ends_with(&(tables[0].join("\n") + "\n")), "the FMU has another name for the same parameter");
    std::fs::write(folder.path().join("study.toml"), old.replace("alpha =", "alpha = 0.2\nalpha =")).unwrap();
    let twice = refusal(folder.path(), &["sweep", "study.toml", "--csv", "x.csv"]);
    assert!(twice.contains("is given twice"), "{twice}");
    let pulse = ["simulate", "--amplitude", "5", "--csv", "x.csv"];
    let of = |words: [&str; 3]| {
        let [shape, foundation, separation] = words;
        let words = ["--pulse", shape, "--foundation", foundation, "--on-separation", separation];
        stdout(folder.path(), &[&pulse[..], &words].concat())
    };
    assert_eq!(of(["one-sine", "rigid", "fly"]), of(["One-Sine", "RIGID", "Fly"]));
    let search =
        ["search", "overturning", "--period", "1", "--points", "3", "--resolution", "0.1", "--foundation", "Rigid"];
    stdout(folder.path(), &search);
}

#[test]
fn all_commands_take_sizes_instead_of_angles() {
    let folder = tempfile::tempdir().unwrap();
    let (alpha, p) = (0.25_f64.atan(), (0.75 * 9.81 / (0.5 * 0.8_f64.hypot(3.2))).sqrt());
    let search =
        ["search", "overturning", "--period", "1", "--points", "3", "--resolution", "1e-3", "--foundation", "rigid"];
    let sizes = ["--width", "0.8", "--height", "3.2"];
    let angles = [format!("--alpha={alpha}"), format!("--p={p}")];
    let angles: Vec<&str> = angles.iter().map(String::as_str).collect();
    assert_eq!(
        stdout(folder.path(), &[&search[..], &sizes].concat()),
        stdout(folder.path(), &[&search[..], &angles].concat())
    );
    let spectrum =
        ["spectrum", "--pulse", "c1", "--amplitude", "4", "--points", "2", "--foundation", "rigid", "--csv", "-"];
    let alpha = format!("--alpha={}", libm::atan2(0.8, 3.2));
    assert_eq!(
        stdout(folder.path(), &[&spectrum[..], &sizes].concat()),
        stdout(folder.path(), &[&spectrum[..], &[&alpha]].concat())
    );
    for (command, message) in [
        (
            &["search", "damping", "--width", "1", "--eta", "40"][..],
            "--width without --height; expected both, or --center-height",
        ),
        (&["search", "damping", "--height", "1"], "--height has no effect without --width"),
        (
            &["search", "damping", "--width", "1", "--height", "4"],
            "--width without --eta; expected the stiffness ratio of the supports",
        ),
        (&["search", "damping", "--xi-v", "0.2"], "--xi-v has no effect in a search for the damping of supports"),
        (
            &["search", "damping", "--width", "1", "--height", "4", "--eta", "40", "--p", "2"],
            "--p has no effect with --width",
        ),
        (
            &["search", "overturning", "--period", "1", "--width", "1", "--height", "4"],
            "--width without --eta, or --stiffness and --damping; expected the supports, or --foundation rigid",
        ),
    ] {
        assert_eq!(refusal(folder.path(), command), message);
    }
}

/// Errors of the command-line library are one line as well.
#[test]
fn errors_of_the_command_line_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["simulate", "--alpha", "wide"][..], &["'wide' for '--alpha <RAD>'", "expected a number"][..]),
        (&["simulate", "--pulse", "one-sin"], &["'one-sin'", "possible values: none, one-sine", "similar value"]),
        (&["simulate", "--alfa", "1"], &["unexpected argument '--alfa'", "'--alpha'"]),
        (
            &["search", "damping", "--depth", "1"],
            &["unexpected argument '--depth'", "`rocking sketch` and `rocking search overturning` have it"],
        ),
        (&["ida", "x.toml", "--rate", "1"], &["unexpected argument '--rate'", "; `rocking search damping` has it"]),
        (&["spectrum", "--pulse", "c1"], &["required", "--csv <FILE.csv>"]),
        (&["spectrum", "--csv", "x.csv", "--resume", "--force"], &["cannot be used with"]),
        (&["fragility", "x.csv", "--im", "PGV", "--limit", "-1"], &["found limit `-1`", "a number > 0"]),
        (&["simulte"], &["unrecognized subcommand 'simulte'"]),
    ] {
        let output = rocking(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.starts_with("rocking: ") && message.lines().count() == 1, "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{words:?}: {message}");
    }
    assert!(stdout(folder.path(), &["--help"]).lines().count() > 10);
    let loose = "--tolerance = 5; expected a number from 1e-14 to 0.1";
    for command in [
        &["simulate", "--theta", "0.1"][..],
        &["search", "damping"],
        &["spectrum", "--pulse", "c1", "--amplitude", "1", "--csv", "x.csv"],
    ] {
        assert_eq!(refusal(folder.path(), &[command, &["--tolerance", "5"]].concat()), loose);
    }
    for command in [
        &["simulate", "--theta", "0.1", "--duration", "0.1", "--csv", "x.csv"][..],
        &["search", "overturning", "--period", "1", "--points", "2", "--resolution", "100"],
    ] {
        let soft = rocking(folder.path(), &[command, &["--eta", "0.001"]].concat());
        let message = text(&soft.stderr);
        assert!(
            message.contains("warning: the block falls over by itself on supports of eta = 0.001")
                && message.contains("expected eta > "),
            "{message}"
        );
    }
}

/// Only `--force` replaces an existing table; the result equals that under a new name.
#[test]
fn only_force_replaces_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let spectrum = ["spectrum", "--pulse", "c1", "--amplitude", "4", "--points", "2", "--foundation", "rigid"];
    let to = |more: &[&'static str]| [&spectrum[..], &["--csv", "x.csv"], more].concat();
    stdout(folder.path(), &to(&["--p-min", "1"]));
    let refused = refusal(folder.path(), &to(&[]));
    assert!(refused.contains("--resume") && refused.contains("--force"), "{refused}");
    stdout(folder.path(), &to(&["--force"]));
    stdout(folder.path(), &[&spectrum[..], &["--csv", "y.csv"]].concat());
    let [x, y] = ["x.csv", "y.csv"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(x == y);
    // An extension that names no format draws a warning.
    let output = rocking(folder.path(), &[&spectrum[..], &["--csv", "z.txt"]].concat());
    assert!(
        output.status.success()
            && text(&output.stderr).contains("z.txt: the table is written as CSV; expected a name in .csv")
    );
}

/// The help of each number of a block or a pulse ends with its default, which is that of the specification.
#[test]
fn the_help_of_blocks_and_pulses_names_their_defaults() {
    let folder = tempfile::tempdir().unwrap();
    let help = |command: &[&str]| {
        stdout(folder.path(), &[command, &["-h"]].concat()).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    // From the end of its own value to the value of the next option.
    let found = |help: &str, name: &str| {
        let (_, rest) = help.split_once(&format!("--{} <", option(name)))?;
        let of_option = rest.split_once('>').unwrap().1.split('<').next().unwrap();
        Some(of_option.split_once("[default: ").map(|(_, rest)| rest.split(']').next().unwrap().to_string()))
    };
    let Pulse { period, start, phase, cycles, .. } = Pulse::NONE;
    let of_pulse = [("period", period), ("start", start), ("phase", phase), ("cycles", cycles)];
    let of_pulse = of_pulse.map(|(name, default)| (name, Some(default)));
    let text = |value: f64| if value == f64::INFINITY { "none".into() } else { value.to_string() };
    let of_block = BlockSpec::defaults().numbers();
    let of_simulate = help(&["simulate"]);
    for (name, default) in of_block.into_iter().chain(of_pulse) {
        assert_eq!(found(&of_simulate, name), Some(default.map(text)), "{name}");
    }
    // Other commands have some of these options, and those the same defaults.
    for (command, count) in
        [(&["search", "damping"][..], 9), (&["search", "overturning"], 11), (&["spectrum"], 5), (&["frame"], 2)]
    {
        let help = help(command);
        let same =
            of_block.into_iter().filter_map(|(name, default)| Some((name, found(&help, name)??, default.map(text)?)));
        let same: Vec<_> = same.collect();
        assert!(same.iter().all(|(_, found, default)| found == default), "{command:?}: {same:?}");
        assert_eq!(same.len(), count, "{command:?}: {same:?}");
    }
}
