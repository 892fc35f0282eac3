//! Negative numbers are values, not options.

use std::collections::BTreeSet;

use crate::program::{refusal, rocking, stdout, text};

/// Returns the options of a command that take a value, from its help.
fn options(folder: &std::path::Path, command: &[&str]) -> BTreeSet<String> {
    let help = stdout(folder, &[command, &["--help"]].concat());
    let lines = help.lines().map(str::trim).filter(|line| line.starts_with("--") && line.contains('<'));
    lines.map(|line| line.split_whitespace().next().unwrap().to_string()).collect()
}

/// No number is taken for an option.
#[test]
fn negative_numbers_are_values_of_all_options() {
    let folder = tempfile::tempdir().unwrap();
    let commands: [&[&str]; 6] =
        [&["simulate"], &["spectrum"], &["search", "damping"], &["search", "overturning"], &["sweep"], &["record"]];
    let mut tried = 0;
    for command in commands {
        for option in options(folder.path(), command) {
            // The unknown option keeps the command from running.
            let output = rocking(folder.path(), &[command, &[&option, "-1", "--never"]].concat());
            let message = text(&output.stderr);
            assert!(message.contains("unexpected argument '--never'"), "{command:?} {option}: {message}");
            tried += 1;
        }
    }
    assert!(tried > 100, "{tried} options");
}

#[test]
fn negative_numbers_out_of_range_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = ["--pulse", "one-sine", "--amplitude", "-5", "--csv", "s.csv"];
    let spectrum = [&["spectrum"], &pulse[..]].concat();
    let cases: [(&[&str], &[&str], &str); 13] = [
        (&["simulate"], &["--duration", "-1e-3"], "--duration = -0.001; expected a time > 0 s"),
        (&["simulate"], &["--duration", "-1"], "--duration = -1; expected a time > 0 s"),
        (&["simulate"], &["--step", "-1"], "--step = -1; expected a time > 0 s"),
        (&["simulate"], &["--tolerance", "-1"], "--tolerance = -1; expected a number from 1e-14 to 0.1"),
        (&["simulate"], &["--alpha", "-0.2"], "alpha = -0.2 is not valid; expected 0 < alpha < pi/2 rad"),
        (&["simulate", "--record", "none"], &["--dt", "-1"], "--dt = -1; expected a time > 0 s"),
        (&["simulate", "--vertical", "none"], &["--vertical-dt", "-1"], "--vertical-dt = -1; expected a time > 0 s"),
        (
            &["simulate", "--pulse", "c1", "--amplitude", "1"],
            &["--period", "-1"],
            "--period = -1; expected a time > 0 s",
        ),
        (&spectrum, &["--duration", "-1"], "--duration = -1; expected a time > 0 s, at most 1e6 s"),
        (&spectrum, &["--p-min", "-1"], "--p-min = -1; expected a frequency of at least 0.001 rad/s"),
        (&["search", "overturning"], &["--period", "-1"], "--period = -1; expected a time > 0 s"),
        (&["search", "damping"], &["--resolution", "-1"], "--resolution = -1; expected a number > 0"),
        (&["search", "damping"], &["--from", "-0.5"], "xi_v = -0.5 is not valid; expected a finite number >= 0"),
    ];
    for (command, options, message) in cases {
        assert_eq!(refusal(folder.path(), &[command, options].concat()), message);
    }
}
