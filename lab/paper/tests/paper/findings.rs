//! Findings of the paper, tested on small grids. docs/unit/figures.md has the full comparison.

use std::f64::consts::TAU;
use std::path::Path;

use paper_figures::ground_motions::{self, GroundMotion};
use paper_figures::parameters::{self, ETA, block};
use paper_figures::plane::{BOUNDS, PulseResponse};
use paper_figures::{
    Comparison, comparisons, history_run, least_damping, panels, tower_bases, tower_run, tower_sources,
};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Ending, Initial, Settings};
use rocking_studies::output::runner::Study;
use rocking_studies::run::outcome::End;
use rocking_studies::run::{History, Run};
use rocking_studies::spectrum::FoundationCurve;

use crate::figures::{RIGID, SMALL, supports};

fn history(base: FoundationCurve) -> History {
    history_run(base, &SMALL).unwrap().history(|_| ()).unwrap()
}

/// A block with p = 1 rad/s under a pulse of Figure 10 or 11 with a frequency ω_p/p, for 3/p.
fn under_pulse(figure: u8, alpha: f64, base: FoundationCurve, amplitude: f64, ratio: f64) -> History {
    let pulse = parameters::spectrum_pulse(figure, amplitude, alpha);
    let p = TAU / pulse.period / ratio;
    let run = Run {
        block: block(alpha, p, base).unwrap(),
        settings: Settings::default(),
        initial: Initial::default(),
        pulse,
        ground: Ground::default(),
        duration: Some(3.0 / p),
        output_step: 0.01,
    };
    run.history(|_| ()).unwrap()
}

/// Returns the records if available; reports a skipped test otherwise.
fn records() -> Option<Vec<GroundMotion>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/records");
    if !folder.is_dir() {
        crate::skipped::skip("figures under records: ../shared/records is not here");
        return None;
    }
    let sources = ground_motions::read(Some(&folder)).unwrap();
    assert!(sources.iter().skip(1).all(GroundMotion::is_record), "{sources:?}");
    Some(sources)
}

/// Figure 6: the peak is slightly below that on the rigid base and rises towards it with η.
#[test]
fn stiffer_supports_come_closer_to_the_rigid_base() {
    let rigid = history(RIGID).peaks.theta;
    let ratios = ETA.map(|eta| history(supports(eta, 0.1, 0.0)).peaks.theta / rigid);
    assert!(ratios.is_sorted_by(|a, b| a < b) && ratios[0] > 0.85 && ratios[3] < 1.0, "{ratios:?}");
}

/// The region of amplitude and frequency in which this finding holds.
#[test]
fn the_pulse_lies_where_the_findings_hold() {
    let at = |amplitude, frequency| PulseResponse::at(amplitude, frequency).unwrap();
    let g_tan = 9.81 * 0.25_f64.tan();
    let [amplitude, period] = parameters::PULSE;
    let (amplitude, frequency) = (amplitude / g_tan, TAU / period);
    let pulse = at(amplitude, frequency);
    // The figure's own runs have the same peaks.
    assert!((pulse.rigid.unwrap() - history(RIGID).peaks.theta / 0.25).abs() < 1e-6);
    assert!(pulse.least_ratio().unwrap() > BOUNDS[1] && pulse.separates_as_eta_grows(), "{pulse:?}");
    assert_eq!(pulse.separates, [false, false, false, true]);
    // It also holds around the pulse.
    for (da, df) in [(-0.2, 0.0), (0.2, 0.0), (0.0, -0.3), (0.0, 0.3)] {
        let near = at(amplitude + da, frequency + df);
        assert!(near.least_ratio().unwrap() > BOUNDS[1] && near.separates_as_eta_grows(), "{near:?}");
    }
    // A weak pulse barely lifts the rigid block but rotates blocks on supports further; below g tan α it lifts none.
    assert_eq!(at(1.5, 5.0).least_ratio(), None);
    assert_eq!(at(0.99, 5.0).rigid, Some(0.0));
    // Under a slow pulse the difference is large; a slower one overturns the rigid block.
    assert!(at(2.5, 5.0).least_ratio().unwrap() < 0.8);
    assert_eq!(at(2.5, 3.0).rigid, None);
    // Under a fast pulse the peaks do not rise with η.
    let fast = at(2.5, 11.0);
    assert!(fast.least_ratio().is_none() && fast.ratios.iter().all(|ratio| ratio.unwrap() < 1.0), "{fast:?}");
    // With ε = 0 no block separates, even on the stiffest supports.
    assert!([pulse, at(1.5, 5.0), at(2.5, 5.0), fast].iter().all(|point| !point.separates_without_restitution));
}

/// Figures 7 and 8: more energy remains with larger ε, less with larger ξ_v; only ε = 0.4 with η = 80 separates.
#[test]
fn larger_restitution_decays_more_slowly_and_separates() {
    for (i, Comparison { solid, dashed, .. }) in comparisons(7).into_iter().enumerate() {
        let [without, with] = [solid, dashed].map(history);
        assert_eq!(without.ending, None);
        if i == 3 {
            assert!(matches!(with.ending, Some((Ending::Separated, _))), "{:?}", with.ending);
        } else {
            assert_eq!(with.ending, None);
            let [a, b] = [without, with].map(|history| history.rows.last().unwrap().energies.total);
            assert!(b > 1.5 * a, "{dashed}: {b} {a}");
        }
    }
    let eight: Vec<f64> =
        comparisons(8).into_iter().map(|pair| history(pair.dashed).rows[300].energies.total).collect();
    assert!(eight[0] > 2.0 * eight[1] && eight[2] > 2.0 * eight[3] && eight[2] > eight[0], "{eight:?}");
}

/// ε = 0.4 with ξ_v = 0.1 can lose less energy than the rigid base: here 9 % against 14 % of the input until 3/p.
#[test]
fn supports_can_lose_less_than_the_rigid_base() {
    let [supports, rigid] = [supports(60.0, 0.1, 0.4), RIGID].map(|base| {
        let history = under_pulse(10, 0.2, base, 1.5, 5.0);
        let energies = history.rows.last().unwrap().energies;
        (energies.dashpots + energies.impacts) / energies.input
    });
    assert!(supports < 0.8 * rigid, "{supports} {rigid}");
}

/// Figure 9: the damping needed grows with α and η but not with ε, since the block separates before it lands.
#[test]
fn damping_against_separation_grows_with_slenderness_angle_and_stiffness() {
    let least = |alpha, eta, epsilon| {
        least_damping(alpha, eta, epsilon, &SMALL).unwrap().against_separation.expect("a sufficient damping")
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

/// On soft supports a slender block falls and separates on its way down, unless the damping is large enough.
#[test]
fn a_block_that_falls_counts_as_overturned() {
    let least = least_damping(0.15, 20.0, 0.0, &SMALL).unwrap();
    assert!(least.against_separation.unwrap() < 0.1, "{least:?}");
    assert!(least.against_overturning.unwrap() > 0.1, "{least:?}");
}

/// Figure 10: with smaller α the peak depends less on η and ε, but more on ξ_v. Figure 11: also more on η.
#[test]
fn dependence_on_the_supports_changes_with_slenderness() {
    let of = |figure, alpha| {
        let peak = |base| under_pulse(figure, alpha, base, 2.5, 7.0).peaks.theta;
        let (reference, rigid) = (peak(supports(80.0, 0.1, 0.0)), peak(RIGID));
        [supports(20.0, 0.1, 0.0), supports(80.0, 0.4, 0.0)].map(|other| (peak(other) - reference).abs() / rigid)
    };
    let ([eta, xi_v], [eta_large, xi_v_large]) = (of(10, 0.1), of(10, 0.25));
    assert!(eta < 0.7 * eta_large, "{eta} {eta_large}");
    assert!(xi_v > 2.0 * xi_v_large, "{xi_v} {xi_v_large}");
    let ([eta, _], [eta_large, _]) = (of(11, 0.1), of(11, 0.25));
    assert!(eta > 1.5 * eta_large, "{eta} {eta_large}");
    // ε = 0.4 separates at α = 0.25 and does not at 0.1.
    for figure in [10, 11] {
        let end = |alpha| under_pulse(figure, alpha, supports(80.0, 0.1, 0.4), 2.5, 6.0).ending;
        assert_eq!(end(0.1), None);
        assert!(matches!(end(0.25), Some((Ending::Separated, _))), "{:?}", end(0.25));
    }
}

/// Figures 12 and 13: separations need ε > 0 or vertical motion, and ξ_v = 0.4 with ε = 0 prevents them.
///
/// Vertical motion adds separations. Peaks lie above and below those on the rigid base.
#[test]
fn separation_and_peaks_under_records() {
    let Some(sources) = records() else { return };
    let (mut lowest, mut greatest) = (f64::INFINITY, 0.0_f64);
    let mut separated = [[0; 4]; 2];
    for number in [12, 13] {
        for (i, panel) in panels(number, &SMALL, &sources).unwrap().into_iter().enumerate() {
            let Some(spectrum) = panel.spectrum else { continue };
            let mut rigid = Vec::new();
            for row in 0..spectrum.rows() {
                let outcome = spectrum.run(row).outcome();
                separated[i % 2][i / 2 % 4] += u32::from(outcome.end == End::Separated);
                let peak = (outcome.end == End::Completed).then_some(outcome.peaks.theta);
                if spectrum.inputs(row).base == 0 {
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
    assert_eq!([alone[0], alone[2], vertical[2]], [0, 0, 0], "epsilon = 0: {separated:?}");
    assert!(alone[1] > 10, "xi_v = 0.1, epsilon = 0.4: {separated:?}");
    // One of the four records has a vertical component.
    assert!(vertical[0] > 3 && vertical[1] > vertical[0], "{separated:?}");
    assert!(lowest < 0.75 && greatest > 1.5, "{lowest} to {greatest}");
}

/// Stiffnesses 75 times apart (η = 100 and 863) change the peak rotation of the tower by less than 15 %.
#[test]
fn the_bridge_tower_hardly_depends_on_its_pads() {
    let sources = records().unwrap_or(ground_motions::read(None).unwrap());
    for source in tower_sources(&sources) {
        let stiff = [100.0, 305.0, 863.0].map(|eta| {
            assert!(tower_bases().contains(&supports(eta, 0.1, 0.0)));
            tower_run(supports(eta, 0.1, 0.0), &source).unwrap().outcome().peaks.theta / parameters::TOWER_ALPHA
        });
        let (low, high) =
            stiff.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &peak| (low.min(peak), high.max(peak)));
        assert!(high < 1.15 * low && high < 0.15, "{}: {low} to {high}", source.name);
    }
}
