//! Options and study parameters without effect are refused; the message says what they need.

use crate::program::{RECORD, refusal, stdout};

const PULSE: [&str; 6] = ["--pulse", "one-sine", "--amplitude", "5", "--period", "1.2"];
/// Few runs.
const FEW: [&str; 6] = ["--csv", "s.csv", "--points", "2", "--p-min", "3"];

#[track_caller]
fn has_no_effect(command: &[&str], options: &[&str], why: &str) {
    let folder = tempfile::tempdir().unwrap();
    let message = refusal(folder.path(), &[command, options].concat());
    assert_eq!(message, format!("{} has no effect {why}", options[0]), "{command:?}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "something was left");
}

#[test]
fn options_of_pulses_and_records_need_one() {
    let spectrum = [&["spectrum"], &FEW[..]].concat();
    let with_record = [&spectrum[..], &["--record", RECORD]].concat();
    let with_pulse = [&spectrum[..], &PULSE].concat();
    for option in ["--amplitude", "--period", "--start"] {
        has_no_effect(&["simulate"], &[option, "1"], "without --pulse");
        has_no_effect(&["simulate", "--record", RECORD], &[option, "1"], "without --pulse");
        has_no_effect(&with_record, &[option, "1"], "without --pulse");
    }
    for option in ["--phase", "--cycles"] {
        has_no_effect(&with_pulse, &[option, "1"], "without --pulse gabor");
        has_no_effect(&["search", "overturning", "--period", "1"], &[option, "1"], "without --pulse gabor");
    }
    let without_record = [&["simulate", "--theta", "0.1"][..], &[&["simulate"], &PULSE[..]].concat(), &with_pulse];
    for command in without_record {
        has_no_effect(command, &["--scale", "2"], "without --record or --vertical");
        for options in [["--unit", "g"], ["--dt", "0.01"], ["--format", "smc"], ["--channel", "1"]] {
            has_no_effect(command, &options, "without a record");
        }
    }
    // The embedded record is complete.
    has_no_effect(&["simulate"], &["--unit", "cm/s2"], "without a record");
    has_no_effect(&["search", "overturning", "--period", "1"], &["--dt", "0.01"], "without a record");
    for command in [&["simulate", "--record", RECORD][..], &["search", "overturning", "--record", RECORD], &with_record]
    {
        has_no_effect(command, &["--vertical-unit", "cm/s2"], "without a vertical record");
        has_no_effect(
            command,
            &["--channel", "1"],
            "without a file of several channels (COSMOS, CSMIP, K-NET, GeoNet, NSMN, UNAM, RENADIC, BHRC, JMA, CWB)",
        );
        has_no_effect(command, &["--time-column", "t"], "without a columns or fixed width file");
    }
    has_no_effect(&with_record, &["--also-horizontal"], "without --vertical");
    has_no_effect(&with_record, &["--over", "2pi/p"], "without --plot");
    for options in [["--pulse", "one-sine"], ["--period", "1"]] {
        has_no_effect(&["search", "overturning", "--record", RECORD], &options, "with --record");
    }
    has_no_effect(&["simulate", "--quiet"], &["--events"], "with --quiet");
    for command in [&["simulate"][..], &with_record] {
        has_no_effect(command, &["--plot-format", "png"], "without --plot");
    }
}

#[test]
fn options_of_supports_need_them() {
    let rigid = [&["simulate", "--foundation", "rigid"], &PULSE[..]].concat();
    let options = [["--eta", "40"], ["--xi-v", "0.1"], ["--v", "0"], ["--v-dot", "0"]];
    for options in options {
        has_no_effect(&rigid, &options, "on a rigid base");
    }
    for options in [["--stiffness", "1e6"], ["--damping", "1e3"]] {
        has_no_effect(&[&rigid[..], &["--width", "1", "--height", "4"]].concat(), &options, "on a rigid base");
    }
    let sizes = ["--width", "1", "--height", "4", "--stiffness", "1e6", "--damping", "1e3"];
    for (options, because) in [
        (["--alpha", "0.2"], "with --width"),
        (["--p", "2"], "with --width"),
        (["--eta", "40"], "with --stiffness and --damping"),
        (["--xi-v", "0.1"], "with --stiffness and --damping"),
    ] {
        has_no_effect(&[&["simulate"], &PULSE[..], &sizes].concat(), &options, because);
    }
    let spectrum = [&["spectrum"], &PULSE[..], &FEW, &["--foundation", "rigid"]].concat();
    for options in [["--eta", "40"], ["--xi-v", "0.1"]] {
        has_no_effect(
            &["search", "overturning", "--period", "1", "--foundation", "rigid"],
            &options,
            "on a rigid base",
        );
    }
    let factor = ["--restitution-factor", "0.9"];
    let expected = "on viscoelastic supports; expected --foundation rigid";
    has_no_effect(&[&["simulate"], &PULSE[..]].concat(), &factor, expected);
    has_no_effect(
        &["search", "overturning", "--period", "1"],
        &factor,
        "on viscoelastic supports; expected --foundation rigid",
    );
    let folder = tempfile::tempdir().unwrap();
    let both = [&spectrum[..], &["--foundation", "40,0.1,0"]].concat();
    stdout(folder.path(), &both);
    // Parameters at their defaults are not refused.
    stdout(folder.path(), &[&rigid[..], &["--csv", "x.csv"]].concat());
}

/// Width and height define a block on a rigid base, the same as alpha and p do.
#[test]
fn a_rigid_base_needs_no_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let rigid = [&["simulate", "--foundation", "rigid", "--duration", "3"], &PULSE[..]].concat();
    let peak = |options: &[&str]| {
        let printed = stdout(folder.path(), &[&rigid[..], options, &["--csv", "x.csv"]].concat());
        printed.lines().find(|line| line.starts_with("peak")).unwrap().to_string()
    };
    // tan α = 1/4, and p² = 3 g/(4 R0) with R0 = √17/2 m.
    let (alpha, p) = (0.25_f64.atan(), (0.75 * 9.81 / (0.5 * 17.0_f64.sqrt())).sqrt());
    let peaks =
        [peak(&["--width", "1", "--height", "4"]), peak(&["--alpha", &alpha.to_string(), "--p", &p.to_string()])];
    assert_eq!(peaks[0], peaks[1]);
    assert!(!peaks[0].contains("|θ|/α = 0.0000"), "{}", peaks[0]);
    for (options, message) in [
        (&["--width", "1"][..], "--width without --height; expected both, or --center-height"),
        (&["--width", "1", "--height", "4", "--stiffness", "1e6"], "--stiffness without --damping; expected both"),
        (
            &["--width", "1", "--height", "4", "--stiffness", "1e6", "--damping", "1e3"],
            "--stiffness without --mass; expected both, since eta and xi_v depend on the mass",
        ),
    ] {
        assert_eq!(refusal(folder.path(), &[&["simulate"], options].concat()), message);
    }
}

/// Sizes go with ratios, and the paper's parameters with the stiffness of a support.
#[test]
fn outline_and_supports_are_given_independently() {
    let folder = tempfile::tempdir().unwrap();
    // With α = arctan(1/4), p = 1 rad/s and M = 1000 kg, ω_v = 50 rad/s takes K = 1.25e6 N/m, and ξ_v = 0.2 takes C = 1e4 N.s/m.
    let (alpha, r0) = (0.25_f64.atan(), 0.75 * 9.81);
    let of = |name: &str, value: f64| [format!("--{name}"), value.to_string()];
    let paper = [of("alpha", alpha), of("p", 1.0)].concat();
    let sizes = [of("width", 2.0 * r0 * alpha.sin()), of("height", 2.0 * r0 * alpha.cos())].concat();
    let ratios = [of("eta", 50.0), of("xi-v", 0.2)].concat();
    let springs = [of("stiffness", 1.25e6), of("damping", 1e4), of("mass", 1000.0)].concat();
    let peak = |outline: &[String], supports: &[String]| {
        let options: Vec<&str> = outline.iter().chain(supports).map(String::as_str).collect();
        let printed = stdout(folder.path(), &[&["simulate", "--csv", "x.csv"], &PULSE[..], &options].concat());
        printed.lines().find(|line| line.starts_with("peak")).unwrap().to_string()
    };
    let expected = peak(&paper, &ratios);
    assert!(!expected.contains("|θ|/α = 0.0000"), "{expected}");
    for (outline, supports) in [(&paper, &springs), (&sizes, &ratios), (&sizes, &springs)] {
        assert_eq!(peak(outline, supports), expected, "{outline:?} {supports:?}");
    }
}

/// Study files are checked the same way; the message has the line.
#[test]
fn study_parameters_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let study = |parameters: &str, records: &str| {
        let text = format!("[study]\ndesign = \"grid\"\n[parameters]\ninitial.theta = 0.1\n{parameters}\n{records}");
        std::fs::write(folder.path().join("study.toml"), text).unwrap();
        refusal(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"])
    };
    for (parameter, needed) in [
        ("pulse.amplitude = 5", "a pulse.shape"),
        ("pulse.period = [0.5, 2]", "a pulse.shape"),
        ("pulse.start = 1", "a pulse.shape"),
        ("pulse.cycles = 3", "pulse.shape = Gabor"),
        ("physical.width = 1", "parameterization = Physical"),
        ("initial.v = 0.1", "initial.settled = false"),
    ] {
        let name = parameter.split_whitespace().next().unwrap().trim_start_matches("physical.");
        let message = format!("study.toml:5: {name} is read by no block of the study; expected {needed}");
        assert_eq!(study(parameter, ""), message);
    }
    // Sizes alone do not define the supports.
    let on_supports = "physical.width, physical.height, physical.K, physical.C, mass";
    for (sizes, missing, expected) in [
        ("physical.width = 1\nphysical.height = 4", "physical.K", on_supports),
        ("physical.width = 1\nphysical.height = 4\nphysical.K = 1e6", "physical.C", on_supports),
        ("physical.width = 1\nphysical.height = 4\nphysical.K = 1e6\nphysical.C = 0", "mass", on_supports),
        ("foundation = \"Rigid\"\nphysical.width = 1", "physical.height", "physical.width, physical.height"),
        (
            "foundation = [\"Rigid\", \"Viscoelastic\"]\nphysical.width = 1\nphysical.height = 4",
            "physical.K",
            on_supports,
        ),
    ] {
        let message = format!("study.toml:5: parameterization = \"Physical\" without {missing}; expected {expected}");
        assert_eq!(study(&format!("parameterization = \"Physical\"\n{sizes}"), ""), message);
    }
    for parameter in ["dimensionless.eta = 60", "initial.v_dot = 1"] {
        let name = parameter.split_whitespace().next().unwrap().trim_start_matches("dimensionless.");
        let message = study(&format!("{parameter}\nfoundation = \"Rigid\""), "");
        let needed = "foundation = Viscoelastic";
        assert_eq!(message, format!("study.toml:5: {name} is read by no block of the study; expected {needed}"));
    }
    let records = |more: &str| format!("[[records]]\nhorizontal = \"{RECORD}\"\n{more}\n");
    for (more, needed) in [
        ("vertical_unit = \"g\"", "a vertical record"),
        (
            "channel = 1",
            "a file of several channels (COSMOS, CSMIP, K-NET, GeoNet, NSMN, UNAM, RENADIC, BHRC, JMA, CWB)",
        ),
        ("acceleration_column = 2", "a columns or fixed width file"),
    ] {
        let name = more.split_whitespace().next().unwrap();
        let message = study("", &records(more));
        assert_eq!(message, format!("study.toml:8: {name} has no effect without {needed}"));
    }
    // One of the two foundations reads eta.
    let text = "[study]\ndesign = \"grid\"\n[parameters]\ninitial.theta = 0.1\ndimensionless.eta = 60\n\
                foundation = [\"Rigid\", \"Viscoelastic\"]\n";
    std::fs::write(folder.path().join("study.toml"), text).unwrap();
    stdout(folder.path(), &["sweep", "study.toml", "--csv", "s.csv"]);
}
