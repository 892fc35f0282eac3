//! Columns under a beam: the equivalent block, the table and refusals.

use serde_json::Value;

use crate::program::{files, refused, stdout};

const FRAME: [&str; 11] =
    ["frame", "--columns", "4", "--width", "1.6", "--height", "9.6", "--mass", "3e4", "--beam-mass", "4.8e5"];

/// p̂² = p² (1 + 2γ_b)/(1 + 3γ_b) for rectangular columns (Makris and Vassiliou 2013); at rest each base bears a quarter of the
/// weight of columns and beam, and each top a quarter of the beam.
#[test]
fn a_frame_has_the_published_frequency_parameter_and_its_weight() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--theta", "0.1", "--duration", "1", "--json", "--csv", "frame.csv"];
    let printed: Value = serde_json::from_str(&stdout(folder.path(), &[&FRAME[..], &options].concat())).unwrap();
    let exact = (0.75 * 9.81 / 0.8_f64.hypot(4.8) * 9.0 / 13.0).sqrt();
    assert!((printed["frame"]["p"].as_f64().unwrap() - exact).abs() < 1e-14, "{printed}");
    assert_eq!(printed["frame"]["mass_ratio"], 4.0);
    let table = std::fs::read_to_string(folder.path().join("frame.csv")).unwrap();
    assert!(table.starts_with("t [s],theta [rad],theta_dot [rad/s],theta_ddot [rad/s2],beam_u [m],"), "{table}");
    // Nothing moves it before the pulse begins.
    let pulse = ["--pulse", "one-sine", "--amplitude", "2", "--start", "1", "--duration", "0.5", "--csv", "rest.csv"];
    stdout(folder.path(), &[&FRAME[..], &pulse].concat());
    let table = std::fs::read_to_string(folder.path().join("rest.csv")).unwrap();
    let last: Vec<f64> = table.lines().last().unwrap().split(',').map(|field| field.parse().unwrap()).collect();
    for (column, force) in [(7, 6e5 * 9.81 / 4.0), (9, 4.8e5 * 9.81 / 4.0)] {
        assert!((last[column] / force - 1.0).abs() < 1e-14, "{last:?}");
    }
}

#[test]
fn frames_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (options, message) in [
        (["--theta", "0.1", "--columns", "1"], "columns = 1; expected 2 to"),
        (["--theta", "0.1", "--beam-mass", "-1"], "beam_mass = -1 is not valid"),
        (["--step", "0.1", "--duration", "1"], "nothing moves the frame; expected --record, --pulse or --theta"),
    ] {
        let kept: Vec<&str> = FRAME[1..].chunks(2).filter(|pair| pair[0] != options[2]).flatten().copied().collect();
        refused(folder.path(), &[&FRAME[..1], &kept, &options].concat(), &[message]);
    }
    assert_eq!(files(folder.path()), [""; 0]);
}

/// The picture has the rotation, the beam and the forces of a column.
#[test]
fn a_frame_has_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let options = "frame --columns 4 --width 1 --height 5 --mass 5000 --beam-mass 20000 --theta 0.05 --plot frame.svg";
    stdout(folder.path(), &options.split(' ').collect::<Vec<_>>());
    let svg = std::fs::read_to_string(folder.path().join("frame.svg")).unwrap();
    for words in ["free motion", "θ/α", "beam (m)", "force of a column (kN)", "horizontal force of the base"] {
        assert!(svg.contains(words), "{words}");
    }
}
