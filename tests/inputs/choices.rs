//! Choices in any case, sizes in place of angles, and refusals of the command line in one line.

use crate::{made, refusal, rocking};

/// A study on both foundations, with the words of choices as given.
fn study(words: [&str; 5]) -> String {
    let [design, foundation, separation, shape, spacing] = words;
    format!(
        "[study]\ndesign = \"{design}\"\n[parameters]\nalpha = 0.2\np = {{ from = 2, to = 3, count = 2, spacing = \"{spacing}\" }}\n\
         foundation = \"{foundation}\"\non_separation = \"{separation}\"\npulse.shape = \"{shape}\"\npulse.amplitude = 5\n\
         pulse.period = 1\n"
    )
}

/// The words of the program, those of the FMU, and either in capitals are the same choices; tables have the program's.
#[test]
fn choices_have_one_spelling_and_are_read_in_any_case() {
    let folder = tempfile::tempdir().unwrap();
    let mut tables = Vec::new();
    for words in [
        ["grid", "rigid", "fly", "one-sine", "log"],
        ["GRID", "Rigid", "Fly", "OneSine", "LOG"],
        ["Grid", "RIGID", "FLY", "ONE_SINE", "Log"],
    ] {
        std::fs::write(folder.path().join("study.toml"), study(words)).unwrap();
        let table = made(folder.path(), &["sweep", "study.toml", "--csv", "-"]);
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
    let table = made(folder.path(), &["sweep", "study.toml", "--csv", "-"]);
    assert!(
        table.ends_with(&(tables[0].join("\n") + "\n")),
        "the name in the FMU is another one of the same parameter"
    );
    std::fs::write(folder.path().join("study.toml"), old.replace("alpha =", "alpha = 0.2\nalpha =")).unwrap();
    let twice = refusal(folder.path(), &["sweep", "study.toml", "--csv", "x.csv"]);
    assert!(twice.contains("is there twice"), "{twice}");
    let pulse = ["simulate", "--amplitude", "5", "--csv", "x.csv"];
    let of = |words: [&str; 3]| {
        let [shape, foundation, separation] = words;
        let words = ["--pulse", shape, "--foundation", foundation, "--on-separation", separation];
        made(folder.path(), &[&pulse[..], &words].concat())
    };
    assert_eq!(of(["one-sine", "rigid", "fly"]), of(["One-Sine", "RIGID", "Fly"]));
    let search =
        ["search", "overturning", "--period", "1", "--points", "3", "--resolution", "0.1", "--foundation", "Rigid"];
    made(folder.path(), &search);
}

#[test]
fn sizes_stand_for_angles_in_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    let (alpha, p) = (0.25_f64.atan(), (0.75 * 9.81 / (0.5 * 0.8_f64.hypot(3.2))).sqrt());
    let search =
        ["search", "overturning", "--period", "1", "--points", "3", "--resolution", "1e-3", "--foundation", "rigid"];
    let sizes = ["--width", "0.8", "--height", "3.2"];
    let angles = [format!("--alpha={alpha}"), format!("--p={p}")];
    let angles: Vec<&str> = angles.iter().map(String::as_str).collect();
    assert_eq!(
        made(folder.path(), &[&search[..], &sizes].concat()),
        made(folder.path(), &[&search[..], &angles].concat())
    );
    let spectrum =
        ["spectrum", "--pulse", "c1", "--amplitude", "4", "--points", "2", "--foundation", "rigid", "--csv", "-"];
    let alpha = format!("--alpha={}", libm::atan2(0.8, 3.2));
    assert_eq!(
        made(folder.path(), &[&spectrum[..], &sizes].concat()),
        made(folder.path(), &[&spectrum[..], &[&alpha]].concat())
    );
    for (command, told) in [
        (&["search", "damping", "--width", "1"][..], "--width without --height; expected both"),
        (&["search", "damping", "--height", "1"], "--height without --width; expected both"),
        (&["search", "damping", "--width", "1", "--height", "4", "--p", "2"], "--p has no effect with --width"),
        (
            &["search", "overturning", "--period", "1", "--width", "1", "--height", "4"],
            "--width without --eta; expected the stiffness ratio of the supports, or --foundation rigid",
        ),
    ] {
        assert_eq!(refusal(folder.path(), command), told);
    }
}

/// What the library of the command line finds wrong is one line, too.
#[test]
fn mistakes_on_the_command_line_are_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["simulate", "--alpha", "wide"][..], &["'wide' for '--alpha <RAD>'", "expected a number"][..]),
        (&["simulate", "--pulse", "one-sin"], &["'one-sin'", "possible values: none, one-sine", "similar value"]),
        (&["simulate", "--alfa", "1"], &["unexpected argument '--alfa'", "'--alpha'"]),
        (&["spectrum", "--pulse", "c1"], &["required", "--csv <FILE.csv>"]),
        (&["spectrum", "--csv", "x.csv", "--resume", "--force"], &["cannot be used with"]),
        (&["fragility", "x.csv", "--im", "PGV", "--limit", "-1"], &["found limit `-1`", "a number > 0"]),
        (&["simulte"], &["unrecognized subcommand 'simulte'"]),
    ] {
        let output = rocking(folder.path(), arguments);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.starts_with("rocking: ") && told.lines().count() == 1, "{told}");
        assert!(words.iter().all(|word| told.contains(word)), "{words:?}: {told}");
    }
    assert!(made(folder.path(), &["--help"]).lines().count() > 10);
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
        let told = String::from_utf8(soft.stderr).unwrap();
        assert!(
            told.contains("warning: the block falls over by itself on supports of eta = 0.001")
                && told.contains("expected eta > "),
            "{told}"
        );
    }
}

/// A table that is there is replaced on demand alone, and by what a new one would have been.
#[test]
fn a_study_replaces_its_table_with_force() {
    let folder = tempfile::tempdir().unwrap();
    let spectrum = ["spectrum", "--pulse", "c1", "--amplitude", "4", "--points", "2", "--foundation", "rigid"];
    let to = |more: &[&'static str]| [&spectrum[..], &["--csv", "x.csv"], more].concat();
    made(folder.path(), &to(&["--p-min", "1"]));
    let refused = refusal(folder.path(), &to(&[]));
    assert!(refused.contains("--resume") && refused.contains("--force"), "{refused}");
    made(folder.path(), &to(&["--force"]));
    made(folder.path(), &[&spectrum[..], &["--csv", "y.csv"]].concat());
    let [x, y] = ["x.csv", "y.csv"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(x == y);
    // An ending that says nothing is a reason to ask.
    let output = rocking(folder.path(), &[&spectrum[..], &["--csv", "z.txt"]].concat());
    assert!(
        output.status.success()
            && String::from_utf8(output.stderr).unwrap().contains("z.txt: the table is CSV all the same")
    );
}
