//! `rocking figures`, and what the paper finds, as numbers on small grids. docs/figures.md has the whole of it.

use std::path::Path;

use rocking_block::excitation::Pulse;
use rocking_block::simulation::{Ending, Initial, Settings};
use rocking_block::study::figures::parameters::{self, Detail, NUMBERS, SPECTRUM_AMPLITUDE, TOWER_ETA, block};
use rocking_block::study::figures::sources::{self, Source};
use rocking_block::study::figures::{history_run, least_damping, panels, tower_run};
use rocking_block::study::ground::Ground;
use rocking_block::study::history::{History, Run};
use rocking_block::study::outcome::End;
use rocking_block::study::spectrum::Base;

use crate::{Table, files, made, refused};

const RIGID: Base = Base::HOUSNER;
const SMALL: Detail = Detail { step: 0.02, slendernesses: 2, dampings: 11, sizes: 9 };

fn supports(eta: f64, xi_v: f64, epsilon: f64) -> Base {
    Base::Viscoelastic { eta, xi_v, epsilon }
}

fn history(base: Base) -> History {
    history_run(base, &SMALL).unwrap().history(|_| ()).unwrap()
}

/// A block with p = 1 rad/s under the one-sine pulse of a frequency ω_p/p and an amplitude over g tan α, for 3/p.
fn under_pulse(alpha: f64, base: Base, amplitude: f64, ratio: f64) -> History {
    let pulse = parameters::pulse(amplitude, alpha);
    let run = Run {
        block: block(alpha, parameters::PULSE_FREQUENCY / ratio, base).unwrap(),
        settings: Settings::default(),
        initial: Initial::default(),
        pulse,
        ground: Ground::default(),
        duration: Some(3.0 * ratio / parameters::PULSE_FREQUENCY),
        output_step: 0.01,
    };
    run.history(|_| ()).unwrap()
}

/// The records, where they are; the test says so where they are not.
fn records() -> Option<Vec<Source>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/records");
    if !folder.is_dir() {
        eprintln!("SKIPPED: the records of ../shared/records are not here");
        return None;
    }
    let sources = sources::read(Some(&folder)).unwrap();
    assert!(sources.iter().skip(1).all(Source::is_record), "{sources:?}");
    Some(sources)
}

/// Figure 6: the peak is below the rigid base's and rises towards it with η.
#[test]
fn stiffer_supports_come_closer_to_the_rigid_base() {
    let rigid = history(RIGID).peaks.theta;
    let ratios = parameters::ETA.map(|eta| history(supports(eta, 0.1, 0.0)).peaks.theta / rigid);
    assert!(ratios.is_sorted() && ratios[3] < 1.0, "{ratios:?}");
    // Slightly below: 9 % at η = 80, 29 % at η = 20.
    assert!(ratios[3] > 0.9 && ratios[0] > 0.7, "{ratios:?}");
    // That depends on the pulse: a weaker one, which barely lifts a rigid block, turns it round.
    let [rigid, soft] = [RIGID, supports(80.0, 0.1, 0.0)].map(|base| under_pulse(0.25, base, 1.5, 5.0).peaks.theta);
    assert!(soft > 1.1 * rigid, "{soft} {rigid}");
}

/// Figures 7 and 8: more energy is left with a larger ε, and the block separates more easily.
#[test]
fn larger_restitution_decays_more_slowly_and_separates() {
    let left = parameters::EPSILON.map(|epsilon| {
        let history = history(supports(40.0, 0.1, epsilon));
        assert_eq!(history.ending, None);
        history.rows.last().unwrap().energies.total
    });
    assert!(left.is_sorted() && left[2] > 1.05 * left[0], "{left:?}");
    assert_eq!(history(supports(80.0, 0.1, 0.0)).ending, None);
    assert!(matches!(history(supports(80.0, 0.1, 0.4)).ending, Some((Ending::Separated, _))));
}

/// ε = 0.4 with ξ_v = 0.1 can lose less than the rigid base: here 9 % against 14 % of what the ground put in, until 3/p.
#[test]
fn supports_can_lose_less_than_the_rigid_base() {
    let [supports, rigid] = [supports(60.0, 0.1, 0.4), RIGID].map(|base| {
        let history = under_pulse(0.2, base, 1.5, 5.0);
        let energies = history.rows.last().unwrap().energies;
        (energies.dashpots + energies.impacts) / energies.input
    });
    assert!(supports < 0.8 * rigid, "{supports} {rigid}");
}

/// Figure 9: the damping needed grows with α and η; it is ε that does not matter, since the block separates before it lands.
#[test]
fn damping_against_separation_grows_with_slenderness_angle_and_stiffness() {
    let least = |alpha, eta, epsilon| {
        least_damping(alpha, eta, epsilon, &SMALL).unwrap().against_separation.expect("a damping that does")
    };
    let [a, b] = [0.25, 0.35].map(|alpha| [40.0, 80.0].map(|eta| least(alpha, eta, 0.0)));
    assert!(a[0] < a[1] && b[0] < b[1] && a[0] < b[0] && a[1] < b[1], "{a:?} {b:?}");
    assert_eq!(least(0.25, 80.0, 0.4), a[1]);
    let run = Run {
        block: block(0.25, 1.0, supports(80.0, 0.1, 0.4)).unwrap(),
        settings: Settings::default(),
        initial: Initial { theta_dot: parameters::RATE * 0.25, ..Initial::default() },
        pulse: Pulse::NONE,
        ground: Ground::default(),
        duration: Some(1.0),
        output_step: 0.01,
    };
    let outcome = run.outcome();
    assert_eq!(outcome.counts.impacts, 0);
    assert!(outcome.end == End::Separated && outcome.end_time < 0.1, "{outcome:?}");
}

/// A soft support lets a slender block fall; it separates on its way down, and no damping that is too small helps.
#[test]
fn a_block_that_falls_counts_as_overturned() {
    let least = least_damping(0.15, 20.0, 0.0, &SMALL).unwrap();
    assert!(least.against_separation.unwrap() < 0.1, "{least:?}");
    assert!(least.against_overturning.unwrap() > 0.1, "{least:?}");
}

/// Figure 11: the smaller α, the less the peak depends on η and ε; on ξ_v it depends more.
#[test]
fn dependence_on_the_supports_over_slenderness() {
    let difference = |alpha, a, b| {
        let amplitude = SPECTRUM_AMPLITUDE[1];
        let [a, b, rigid] = [a, b, RIGID].map(|base| under_pulse(alpha, base, amplitude, 6.0).peaks.theta);
        (a - b).abs() / rigid
    };
    let of = |alpha| {
        let reference = supports(80.0, 0.1, 0.0);
        [supports(20.0, 0.1, 0.0), supports(80.0, 0.4, 0.0)].map(|other| difference(alpha, other, reference))
    };
    let ([eta, xi_v], [eta_large, xi_v_large]) = (of(0.1), of(0.25));
    assert!(eta < 0.7 * eta_large, "{eta} {eta_large}");
    assert!(xi_v > 2.0 * xi_v_large, "{xi_v} {xi_v_large}");
    // ε = 0.4 separates at α = 0.25 and does not at 0.1.
    let ends = [0.1, 0.25].map(|alpha| under_pulse(alpha, supports(80.0, 0.1, 0.4), 2.5, 6.0).ending.is_some());
    assert_eq!(ends, [false, true]);
}

/// Figures 12 and 13: with ξ_v = 0.4 and ε = 0 no block separates while it rocks; with ξ_v = 0.1 and ε = 0.4 many do, and
/// the vertical motion makes it worse. Peaks lie above and below the rigid base's.
#[test]
fn separation_and_peaks_under_records() {
    let Some(sources) = records() else { return };
    let (mut lowest, mut greatest) = (f64::INFINITY, 0.0_f64);
    let mut separated = [[0; 5]; 2];
    for (figure, number) in [12, 13].into_iter().enumerate() {
        for panel in panels(number, &SMALL, &sources) {
            let spectrum = &panel.spectrum;
            let mut rigid = Vec::new();
            for row in 0..spectrum.bases.len() as u64 * SMALL.sizes {
                let place = spectrum.place(row);
                let outcome = spectrum.run(row).unwrap().outcome();
                let end = outcome.end;
                separated[figure][place.base] += u32::from(end == End::Separated);
                let peak = (end == End::Completed).then_some(outcome.peaks.theta);
                if place.base == 0 {
                    rigid.push(peak);
                } else if let (Some(peak), Some(rigid)) = (peak, rigid[(row % SMALL.sizes) as usize])
                    && rigid > 0.05 * spectrum.alpha
                {
                    (lowest, greatest) = (lowest.min(peak / rigid), greatest.max(peak / rigid));
                }
            }
        }
    }
    let [alone, vertical] = separated;
    assert_eq!([alone[3], vertical[3]], [0, 0], "xi_v = 0.4, epsilon = 0");
    assert!(alone[2] > 5, "xi_v = 0.1, epsilon = 0.4: {separated:?}");
    assert!(alone[1] == 0 && vertical[1] > 3, "xi_v = 0.1, epsilon = 0: {separated:?}");
    assert!(lowest < 0.9 && greatest > 1.5, "{lowest} to {greatest}");
}

/// Figure 14: stiffnesses 75 times apart (η = 100 and 863) change the tower's peak rotation by less than 15 %.
#[test]
fn the_bridge_tower_does_not_mind_its_pads() {
    let sources = sources::read(None).unwrap();
    for source in records().unwrap_or(sources).iter().map(Source::horizontal_only) {
        let peak = |base| tower_run(base, &source).unwrap().outcome().peaks.theta / parameters::TOWER_ALPHA;
        let stiff = TOWER_ETA[2..].iter().map(|&eta| peak(supports(eta, 0.1, 0.0)));
        let (low, high) = stiff.fold((f64::INFINITY, 0.0_f64), |(low, high), peak| (low.min(peak), high.max(peak)));
        assert!(high < 1.15 * low && high < 0.15, "{}: {low} to {high}", source.name);
    }
}

#[test]
fn a_missing_record_is_replaced_by_its_pulse_and_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let told = made(folder.path(), &["figures", "--out", "out", "--records", ".", "--only", "14"]);
    let pulses =
        ["its type C1 pulse, a_p = 4.11 m/s²", "a_p = 2.44", "its type C2 pulse, a_p = 1.64", "its type A pulse"];
    let table = std::fs::read_to_string(folder.path().join("out/figure_14.csv")).unwrap();
    for pulse in pulses {
        assert!(told.contains(pulse) && table.contains(pulse), "{pulse}: {told}{table}");
    }
    assert_eq!(Table::read(&folder.path().join("out/figure_14.csv")).rows.len(), 24);
}

#[test]
fn one_figure_is_made_alone() {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), &["figures", "--out", "new/out", "--only", "3"]);
    assert_eq!(files(&folder.path().join("new/out")), ["figure_03.csv", "figure_03.png"]);
    let table = Table::read(&folder.path().join("new/out/figure_03.csv"));
    for row in 0..table.rows.len() {
        let [alpha, epsilon, e] = ["alpha", "epsilon", "e"].map(|column| table.number(row, column));
        // Eq. (6) for a rectangle is a straight line from Housner's 1 − 3/2 sin² α to 1.
        let exact = 1.0 - (1.0 - epsilon) * 1.5 * alpha.sin().powi(2);
        assert!((e - exact).abs() < 1e-14, "{alpha} {epsilon} {e} {exact}");
    }
}

#[test]
fn what_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let figures = |rest: &[&'static str]| [&["figures", "--out", "out"], rest].concat();
    refused(folder.path(), &figures(&["--only", "3,5"]), &["found figure 5", "expected 3, 6"]);
    refused(folder.path(), &figures(&["--records", "nowhere"]), &["nowhere", "no such folder"]);
    std::fs::write(folder.path().join("PCD164.AT2"), "nothing").unwrap();
    refused(folder.path(), &figures(&["--records", "."]), &["PCD164.AT2"]);
    assert_eq!(files(folder.path()), ["PCD164.AT2"]);
}

/// The page on the figures says what they were made with.
#[test]
fn the_documentation_has_the_captions() {
    let page = include_str!("../../docs/figures.md").split_whitespace().collect::<Vec<_>>().join(" ");
    for number in NUMBERS {
        let caption = parameters::caption(number).unwrap();
        assert!(page.contains(&caption), "Figure {number}: `{caption}` is not in docs/figures.md");
    }
}
