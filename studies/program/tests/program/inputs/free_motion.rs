//! Free motion: an initial state without excitation.

use std::path::Path;

use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse};
use rocking_block::simulation::{Initial, Settings, Simulation};

use crate::program::{Table, refusal, stdout};

/// Column of the table of a run.
fn column(folder: &Path, name: &str) -> Vec<f64> {
    Table::read(&folder.join("run.csv")).column(name)
}

/// Line of a summary.
fn line<'a>(printed: &'a str, name: &str) -> &'a str {
    printed.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no line {name} in {printed}"))
}

#[test]
fn an_initial_state_alone_is_free_motion() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["simulate", "--alpha", "0.25", "--p", "1", "--csv", "run.csv", "--duration", "3"];
    for (option, initial) in [
        ("--theta", Initial { theta: 0.1, ..Initial::default() }),
        ("--theta-dot", Initial { theta_dot: 0.1, ..Initial::default() }),
    ] {
        let printed = stdout(folder.path(), &[&run[..], &[option, "0.1"]].concat());
        assert_eq!(line(&printed, "excitation").split_whitespace().skip(1).collect::<Vec<_>>(), ["free", "motion"]);
        assert!(column(folder.path(), "a_gx").iter().all(|a| *a == 0.0));
        // The same block in the library.
        let d =
            Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 }) };
        let block = Block::from_dimensionless(&d, &Common::default()).unwrap();
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs);
        for (t, theta) in column(folder.path(), "t").into_iter().zip(column(folder.path(), "theta")) {
            simulation.advance(t, &inputs, &mut |_| ()).unwrap();
            assert_eq!(simulation.observe(&inputs).theta, theta);
        }
        assert_eq!(simulation.time(), 3.0);
    }
}

/// An initial state, a pulse and the embedded record move the same block; a rotation of zero is an initial state.
#[test]
fn the_block_does_not_depend_on_the_excitation() {
    let folder = tempfile::tempdir().unwrap();
    let block = |more: &[&str]| {
        let printed = stdout(folder.path(), &[&["simulate", "--csv", "run.csv", "--duration", "0.1"], more].concat());
        (line(&printed, "block").to_string(), line(&printed, "excitation").to_string())
    };
    let (embedded, record) = block(&[]);
    assert!(record.contains("Loma Prieta"), "{record}");
    for more in [&["--theta", "0.1"][..], &["--theta-dot", "-0.1"], &["--v", "0.01"], &["--theta", "0"]] {
        assert_eq!(block(more), (embedded.clone(), "excitation    free motion".into()), "{more:?}");
    }
    assert_eq!(block(&["--pulse", "c1", "--amplitude", "1"]).0, embedded);
    let help = stdout(folder.path(), &["simulate", "--help"]);
    assert!(help.contains("without excitation, the block moves freely"), "{help}");
    // Without --record the factor scales the embedded record.
    assert!(
        refusal(folder.path(), &["simulate", "--theta", "0.1", "--scale", "2"]).starts_with("--scale has no effect")
    );
    stdout(folder.path(), &["simulate", "--scale", "2", "--csv", "run.csv", "--duration", "8"]);
    let peak = column(folder.path(), "a_gx").into_iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
    // examples/records/README.md: 222.5 cm/s² at 7.55 s.
    assert!((peak - 2.0 * 2.225).abs() < 1e-3, "{peak}");
}
