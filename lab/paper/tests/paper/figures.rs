//! Contents of each figure as in the paper. docs/unit/figures.md has the captions.

use std::f64::consts::TAU;
use std::path::Path;
use std::process::{Command, Output};

use paper_figures::ground_motions;
use paper_figures::parameters::{self, Detail, ETA, NUMBERS};
use paper_figures::{
    Comparison, abscissa, comparisons, history_run, make, panels, tower_bases, tower_run, tower_sources,
};
use rocking_block::block::{Ratios, Supports};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_charts::spectrum::Abscissa;
use rocking_studies::output::runner::Study;
use rocking_studies::spectrum::FoundationCurve;

use crate::labels::labels;

/// Rigid base.
pub const RIGID: FoundationCurve = FoundationCurve::HOUSNER;
/// Small grids.
pub const SMALL: Detail = Detail { step: 0.02, slendernesses: 2, dampings: 11, sizes: 9 };

/// Makes figures in a folder.
fn paper_figures(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_paper-figures")).args(arguments).current_dir(folder).output().unwrap()
}

/// Makes figures, and returns what is printed.
#[track_caller]
fn made(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = paper_figures(folder, arguments);
    assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The columns of a table by their headings, and its rows.
fn table(path: &Path) -> (Vec<String>, Vec<csv::StringRecord>) {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
    let headings = reader.headers().unwrap().iter().map(String::from).collect();
    (headings, reader.records().map(Result::unwrap).collect())
}

/// Names of the files in a folder, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Viscoelastic supports.
pub fn supports(eta: f64, xi_v: f64, epsilon: f64) -> FoundationCurve {
    FoundationCurve::viscoelastic(eta, xi_v, epsilon)
}

/// Figures 6 and 7 compare foundations for each η, Figure 8 for each ε and ξ_v.
#[test]
fn histories_compare_the_foundations_of_the_paper() {
    let pairs = |number| -> Vec<[FoundationCurve; 2]> {
        comparisons(number).into_iter().map(|Comparison { solid, dashed, .. }| [solid, dashed]).collect()
    };
    let etas = [20.0, 40.0, 60.0, 80.0];
    assert_eq!(pairs(6), etas.map(|eta| [RIGID, supports(eta, 0.1, 0.0)]));
    assert_eq!(pairs(7), etas.map(|eta| [supports(eta, 0.1, 0.0), supports(eta, 0.1, 0.4)]));
    let eight: Vec<[f64; 2]> = pairs(8)
        .into_iter()
        .map(|[solid, dashed]| {
            assert_eq!(solid, RIGID);
            let Supports::Viscoelastic(Ratios { xi_v, .. }) = dashed.supports else { panic!("{dashed:?}") };
            [dashed.epsilon, xi_v]
        })
        .collect();
    assert_eq!(eight, [[0.0, 0.1], [0.0, 0.4], [0.4, 0.1], [0.4, 0.4]]);
    let run = history_run(supports(40.0, 0.1, 0.0), &SMALL).unwrap();
    assert_eq!((run.block.alpha, run.block.p), (0.25, 1.0));
    // The pulse of Rinaldi in Table I: one sine, v_p = 1.75 m/s.
    let row = ground_motions::TABLE.iter().find(|row| row.name == "rinaldi").unwrap();
    assert_eq!(
        run.pulse,
        Pulse { shape: row.shape, amplitude: row.amplitude, period: row.period, start: 0.0, ..Pulse::NONE }
    );
    assert_eq!(row.shape, PulseShape::OneSine);
    assert!((row.amplitude * row.period / TAU * 2.0 - 1.75).abs() < 0.005);
}

/// Figure 10 has one-sine pulses, Figure 11 one-cosine pulses; both show two amplitudes side by side over ω_p/p.
#[test]
fn spectra_under_pulses_are_those_of_the_paper() {
    let sources = ground_motions::read(None).unwrap();
    for (number, shape) in [(10, PulseShape::OneSine), (11, PulseShape::OneCosine)] {
        assert_eq!(abscissa(number), Abscissa::PulseRatio);
        let panels = panels(number, &SMALL, &sources).unwrap();
        assert_eq!(panels.len(), 8);
        for row in panels.chunks(2) {
            let [left, right] = [&row[0], &row[1]].map(|panel| panel.spectrum.as_ref().unwrap());
            assert!(left.alpha == right.alpha && left.bases == right.bases && left.pulse != right.pulse);
            for (spectrum, amplitude) in [(left, 1.5), (right, 2.5)] {
                let Pulse { period, start, .. } = spectrum.pulse;
                assert_eq!((spectrum.pulse.shape, start), (shape, 0.0));
                let peak = amplitude * 9.81 * spectrum.alpha.tan();
                // A sine peaks after a quarter of T_p, a cosine at once; both end after one T_p.
                let first = if shape == PulseShape::OneSine { 0.25 * period } else { 0.0 };
                assert!((spectrum.pulse.acceleration(first) - peak).abs() < 1e-9);
                assert!((spectrum.pulse.end() - period).abs() < 1e-12);
                assert_eq!(spectrum.bases[0], RIGID);
                // The table has the same ω_p/p, with T_p = 2π/ω_p.
                let rows = spectrum.make(&[0], None).table;
                let ratio = rows.column("omega_p/p").unwrap().number(0).unwrap();
                assert!((ratio - TAU / period / spectrum.inputs(0).p).abs() < 1e-9);
            }
        }
    }
}

/// Figures 12 and 13 show two records each over 2π/p: a_gx alone, and with a_gz if available, for each ξ_v and ε.
#[test]
fn spectra_under_records_are_those_of_the_paper() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["PCD164.AT2", "PCD-UP.AT2", "ERZ-NS_unrotated.AT2"] {
        let text = "PEER\nA record\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n 0.0 0.1 -0.1 0.0\n";
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let sources = ground_motions::read(Some(folder.path())).unwrap();
    for (number, names) in [(12, ["pacoima", "erzincan"]), (13, ["sylmar", "rinaldi"])] {
        assert_eq!(abscissa(number), Abscissa::TwoPiOverP);
        let panels = panels(number, &SMALL, &sources).unwrap();
        assert_eq!(panels.len(), 16);
        for (row, pair) in panels.chunks(2).enumerate() {
            let (name, [xi_v, epsilon]) = (names[row / 4], [[0.1, 0.0], [0.1, 0.4], [0.4, 0.0], [0.4, 0.4]][row % 4]);
            let left = pair[0].spectrum.as_ref().unwrap();
            assert!(pair[0].name.contains(name) && pair[0].title.contains("a_gx alone"), "{}", pair[0].name);
            assert!(left.motions[0].1.vertical.is_none() && left.alpha == 0.25);
            assert_eq!(left.bases[0], RIGID);
            for base in &left.bases[1..] {
                assert_eq!(
                    base.supports.viscoelastic().map(|ratios| [ratios.xi_v, base.epsilon]),
                    Some([xi_v, epsilon])
                );
            }
            assert!(pair[1].title.contains("a_gx and a_gz"));
            match &pair[1].spectrum {
                Some(right) => {
                    assert_eq!(name, "pacoima");
                    assert!(right.motions[0].1.vertical.is_some() && right.bases == left.bases);
                }
                None => assert_ne!(name, "pacoima"),
            }
        }
    }
    // The table has the same 2π/p.
    let spectrum = panels(12, &SMALL, &sources).unwrap().swap_remove(0).spectrum.unwrap();
    let rows = spectrum.make(&[0], None).table;
    assert_eq!(rows.column("2pi/p").unwrap().number(0), Some(TAU / spectrum.inputs(0).p));
}

/// Panels of a missing vertical record are empty, with a note; they do not repeat the horizontal ones.
#[test]
fn panels_of_a_missing_vertical_record_are_empty() {
    let sources = ground_motions::read(None).unwrap();
    let figure = make(13, &SMALL, &sources).unwrap();
    // Also above each of the two records.
    assert_eq!(figure.svg.matches("no vertical record at hand").count(), 8 + 2);
    let rows = figure.table.lines().filter(|line| !line.starts_with('#')).count() - 1;
    // The left column: two records, four supports, the rigid base and two η.
    assert_eq!(rows as u64, 2 * 4 * 3 * SMALL.sizes);
}

/// Figure 14: bars for η = 40, 60, 100, a line for the rigid base, records by growing PGA, no vertical motion.
#[test]
fn the_bridge_tower_is_that_of_the_paper() {
    let sources = tower_sources(&ground_motions::read(None).unwrap());
    assert_eq!(
        sources.iter().map(|source| source.name).collect::<Vec<_>>(),
        ["erzincan", "sylmar", "rinaldi", "pacoima"]
    );
    assert!(sources.is_sorted_by(|a, b| a.pga < b.pga));
    assert_eq!(tower_bases()[..3], [40.0, 60.0, 100.0].map(|eta| supports(eta, 0.1, 0.0)));
    assert_eq!(tower_bases()[3], RIGID);
    let run = tower_run(tower_bases()[0], &sources[0]).unwrap();
    assert_eq!((run.block.p, run.block.alpha), (0.38, 0.15));
}

/// Drawings have subscripts, dots and bars, and name the ground motion of each panel.
#[test]
fn the_drawings_are_labelled() {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), &["--out", "out", "--format", "svg", "--only", "6,14"]);
    let drawing =
        |number: u8| std::fs::read_to_string(folder.path().join(format!("out/figure_{number:02}.svg"))).unwrap();
    let six = drawing(6);
    // A band for each η and its key.
    assert_eq!(six.matches("fill=\"#E4E4E4\"").count(), 1 + ETA.len());
    let six = labels(&six);
    for label in ["θ̇/(α p)", "θ/α", "rigid base", "viscoelastic supports", "|θ| ≤ β"] {
        assert!(six.iter().any(|drawn| drawn == label), "{label}: {six:?}");
    }
    assert!(six.iter().any(|label| label.contains("ξv = 0.1")) && six.iter().all(|label| !label.contains('_')));
    let fourteen = labels(&drawing(14));
    let groups = fourteen.iter().filter(|label| label.contains(") PGA ")).collect::<Vec<_>>();
    assert_eq!(groups, ["(a) PGA 0.52 g", "(b) PGA 0.73 g", "(c) PGA 0.84 g", "(d) PGA 1.23 g"]);
}

#[test]
fn a_missing_record_is_replaced_by_its_pulse_and_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let printed = made(folder.path(), &["--out", "out", "--records", ".", "--only", "14"]);
    let pulses = [
        "its c1 pulse instead, a_p = 4.11 m/s²",
        "a_p = 2.44",
        "its c2 pulse instead, a_p = 1.64",
        "its one-sine pulse",
    ];
    let table = std::fs::read_to_string(folder.path().join("out/figure_14.csv")).unwrap();
    for pulse in pulses {
        assert!(printed.contains(pulse) && table.contains(pulse), "{pulse}: {printed}{table}");
    }
    assert_eq!(self::table(&folder.path().join("out/figure_14.csv")).1.len(), 24);
}

#[test]
fn only_the_requested_figure_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), &["--out", "new/out", "--only", "3"]);
    assert_eq!(files(&folder.path().join("new/out")), ["figure_03.csv", "figure_03.png"]);
    let (headings, rows) = table(&folder.path().join("new/out/figure_03.csv"));
    assert!(rows.len() > 10);
    for row in rows {
        let [alpha, epsilon, e] = ["alpha [rad]", "epsilon [1]", "e [1]"].map(|column| -> f64 {
            row[headings.iter().position(|heading| heading == column).unwrap()].parse().unwrap()
        });
        // Eq. (6) for a rectangle is a straight line from Housner's 1 − 3/2 sin² α to 1.
        let exact = 1.0 - (1.0 - epsilon) * 1.5 * alpha.sin().powi(2);
        assert!((e - exact).abs() < 1e-14, "{alpha} {epsilon} {e} {exact}");
    }
}

#[test]
fn wrong_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        let Output { status, stderr, .. } = paper_figures(folder.path(), &[&["--out", "out"], arguments].concat());
        let message = String::from_utf8(stderr).unwrap();
        assert!(!status.success() && words.iter().all(|word| message.contains(word)), "{arguments:?}: {message}");
    };
    refused(&["--only", "3,5"], &["found figure 5", "expected 3, 6"]);
    refused(&["--records", "nowhere"], &["nowhere", "no such folder"]);
    refused(&["--format", "jpeg"], &["expected png or svg"]);
    std::fs::write(folder.path().join("PCD164.AT2"), "nothing").unwrap();
    refused(&["--records", "."], &["PCD164.AT2"]);
    assert_eq!(files(folder.path()), ["PCD164.AT2"]);
}

/// docs/unit/figures.md has the caption of each figure.
#[test]
fn the_documentation_has_the_captions() {
    let page = include_str!("../../../../docs/unit/figures.md").split_whitespace().collect::<Vec<_>>().join(" ");
    for number in NUMBERS {
        let caption = parameters::caption(number).unwrap().replace('\u{A0}', " ");
        assert!(page.contains(&caption), "Figure {number}: `{caption}` is not in docs/unit/figures.md");
    }
}
