//! Warnings of numbers beyond reason, mostly slips of units.

use crate::program::{rocking, text};

const STUDY: &str = "[study]\ndesign = \"grid\"\nduration = 0.1\n[parameters]\np = [0.05, 0.06]\nxi_v = [60, 70]\n\
                     pulse.shape = \"one-sine\"\npulse.amplitude = [300, 400]\n";

/// Two blocks in space, of plausible lengths and in millimetres.
const SPACE: &str = "[study]\ndesign = \"grid\"\nduration = 0.1\n[parameters]\nwidth = [0.6, 600]\nheight = 2.4\ndepth_ratio = 1.5\n\
                     eta = 60\nmass = 3\nxi_v = 60\npulse.shape = \"one-sine\"\npulse.amplitude = 5\npulse.period = 1\n";

#[test]
fn each_kind_is_said_once_per_command() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    std::fs::write(folder.path().join("space.toml"), SPACE).unwrap();
    let (pulse, mm) = ("--pulse one-sine --period 1", "--width 600 --height 2400");
    let (size, damping, amplitude) = ("m wide", "the supports have xi_v", "the amplitude of the pulse");
    let simulate = format!("simulate {pulse} --duration 0.1 --csv run.csv");
    let spectrum = format!("spectrum {pulse} --duration 0.1 --points 3 --csv s.csv");
    for (arguments, expected) in [
        (format!("{simulate} --amplitude 5"), &[][..]),
        (format!("{simulate} --amplitude 5 {mm} --foundation rigid"), &[size]),
        (format!("{simulate} --amplitude 5 --xi-v 80"), &[damping]),
        (format!("{simulate} --amplitude -400"), &[amplitude]),
        (
            format!("frame --columns 2 {mm} --mass 1 --beam-mass 1 {pulse} --amplitude 5 --duration 0.1 --csv f.csv"),
            &[size],
        ),
        (
            format!("search overturning {mm} --foundation rigid --period 1 --points 2 --resolution 1 --csv o.csv"),
            &[size],
        ),
        (
            format!("{spectrum} --amplitude 400 --p-min 0.05 --p-max 0.06 --foundation 40,60,0"),
            &[size, damping, amplitude],
        ),
        ("sweep study.toml --csv t.csv".to_string(), &[size, damping, amplitude]),
        (format!("{simulate} --amplitude 5 --depth 0.5"), &[]),
        (format!("{simulate} --amplitude 5 --depth 900 {mm} --eta 60 --xi-v 60"), &[size, "the feet have xi_v"]),
        (format!("{simulate} --amplitude 5 --width 0.6 --depth 0.9 --height 2.4 --eta 60 --mass 3"), &["density"]),
        (
            "search overturning --width 60 --depth 80 --height 2.4 --eta 60 --period 1 --points 2 --resolution 1 --csv o.csv"
                .to_string(),
            &["lifts a foot beyond 25 g only"],
        ),
        (format!("sketch --depth 900 {mm} --eta 60 --plot s.svg"), &[size]),
        ("sweep space.toml --csv u.csv".to_string(), &[size, "density", "the feet have xi_v"]),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let found = text(&rocking(folder.path(), &arguments).stderr);
        let warnings: Vec<&str> = found.lines().filter(|line| line.contains("warning")).collect();
        assert_eq!(warnings.len(), expected.len(), "{arguments:?}: {found}");
        for expected in expected {
            assert!(found.contains(expected), "{arguments:?}: {found}");
        }
    }
}
