//! The strength at which a block overturns moves with a parameter as the derivatives of a run near it predict.

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_gradients::Parameters;
use rocking_studies::run::Run;
use rocking_studies::search::{Scan, Threshold, overturning};

/// Allowed relative error of a derivative.
const TOLERANCE: f64 = 1e-6;

/// A block and a pulse whose amplitude is searched.
#[derive(Clone)]
struct Search {
    dimensionless: Dimensionless,
    common: Common,
    pulse: Pulse,
    /// A range with one change, from survival to overturning.
    range: [f64; 2],
}

impl Search {
    fn settings(&self) -> Settings {
        Settings { tolerance: 1e-13, on_separation: OnSeparation::Fly, ..Settings::default() }
    }

    fn block(&self) -> Block {
        Block::from_dimensionless(&self.dimensionless, &self.common).unwrap()
    }

    /// The number of a parameter.
    fn number(&mut self, name: &str) -> &mut f64 {
        let Search { dimensionless: Dimensionless { alpha, p, supports }, pulse, .. } = self;
        match (name, supports) {
            ("alpha", _) => alpha,
            ("p", _) => p,
            ("eta", Supports::Viscoelastic(ratios)) => &mut ratios.eta,
            ("restitution_factor", Supports::Rigid { restitution_factor }) => restitution_factor,
            ("pulse.period", _) => &mut pulse.period,
            (other, _) => panic!("no {other}"),
        }
    }

    /// The search's own threshold, to round-off.
    fn threshold(&self) -> f64 {
        let [from, to] = self.range;
        let scan = Scan { from, to, points: 2, resolution: 1e-15 };
        let run = Run { pulse: self.pulse, ..Run::at_rest(self.block(), self.settings()) };
        let map = overturning(&run, &scan, None, &|_, _| ());
        assert_eq!(map.changes.len(), 1, "{map:?}");
        match map.overturning() {
            Threshold::At(strength) => strength,
            other => panic!("{other:?}: {map:?}"),
        }
    }

    /// Central differences of the threshold over a parameter, extrapolated.
    fn differences(&self, name: &str) -> f64 {
        const SIZE: f64 = 1e-4;
        let value = *self.clone().number(name);
        let at = |part: f64| {
            let mut other = self.clone();
            *other.number(name) = value * (1.0 + part * SIZE);
            other.threshold()
        };
        let [one, two] = [1.0, 2.0].map(|part| (at(part) - at(-part)) / (2.0 * part * SIZE * value));
        (4.0 * one - two) / 3.0
    }

    /// The derivatives of the threshold over these parameters, from a run just below it. Near the top, where the run hovers, all its
    /// derivatives have grown along the same unstable motion: the run stays there if `θ_strength d(strength) + θ_q dq = 0`.
    fn predicted(&self, names: &[&str]) -> Vec<f64> {
        // So large that other motions do not matter, so small that the run beside the threshold is still near the top.
        const GROWN: f64 = 1e8;
        let strength = self.threshold().next_down();
        let pulse = Pulse { amplitude: strength, ..self.pulse };
        let parameters = Parameters {
            block: self.dimensionless.with(&self.common),
            ties: Vec::new(),
            initial: Initial::default(),
            pulse,
            scale: None,
        };
        let run = Run { pulse, output_step: 0.02, ..Run::at_rest(self.block(), self.settings()) };
        let names: Vec<String> =
            std::iter::once("pulse.amplitude").chain(names.iter().copied()).map(String::from).collect();
        let (history, gradients) = run.history_with_gradients(&parameters, &names, |_| ()).unwrap().unwrap();
        let of = |number: usize, row: usize| gradients.parameters[number].rows[row].observation.theta;
        let row = (0..history.rows.len()).find(|&row| of(0, row).abs() * strength > GROWN).expect("a run that hovers");
        (1..names.len()).map(|number| -of(number, row) / of(0, row)).collect()
    }

    fn check(&self, names: &[&str]) {
        for (name, predicted) in names.iter().zip(self.predicted(names)) {
            let found = self.differences(name);
            println!("{name}: {predicted} by the derivatives of a run, {found} by differences");
            assert!((predicted - found).abs() <= TOLERANCE * found.abs(), "{name}: {predicted} instead of {found}");
        }
    }
}

fn search(foundation: Foundation, shape: PulseShape, period: f64, range: [f64; 2]) -> Search {
    Search {
        dimensionless: Dimensionless {
            alpha: 0.25,
            p: 1.0,
            supports: Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 }),
        },
        common: Common::default(),
        pulse: Pulse { shape, period, ..Pulse::NONE },
        range,
    }
}

/// The block lands while the ground moves: at rest a shift of its time, which a wrong jump of the derivatives at the impact amounts to,
/// would leave the threshold as it is.
#[test]
fn derivatives_match_thresholds_on_the_rigid_base_under_a_type_c1_pulse() {
    let search = search(Foundation::Rigid, PulseShape::C1, 2.0, [5.0, 8.0]);
    search.check(&["alpha", "p", "restitution_factor", "pulse.period"]);
}

#[test]
fn derivatives_match_thresholds_on_supports_under_a_sine() {
    let search = search(Foundation::Viscoelastic, PulseShape::OneSine, 1.2566, [6.0, 12.0]);
    search.check(&["alpha", "p", "eta", "pulse.period"]);
}
