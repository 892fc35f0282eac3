//! Fits to synthetic tests with planted parameters: intervals must contain them at their confidence level.

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::fit::{Estimate, Fit, Free, Options, Problem, Test, fit};
use rocking_studies::output::runner::pool;
use rocking_studies::run::{Row, Run};

use crate::planted::{NOISE, Planted, rigid, supports};

fn fitted(problem: &Problem) -> Fit {
    fit(problem, &pool(Some(1)).unwrap(), &|_, _| ()).unwrap()
}

/// Estimate and planted value of each parameter of the block.
fn pairs<'a>(planted: &'a Planted, fit: &'a Fit) -> impl Iterator<Item = (&'a Estimate, f64)> {
    fit.estimates.iter().map(|estimate| (estimate, planted.planted(&estimate.name)))
}

/// Without errors the least squares are at the planted parameters, which all starts miss; the runs have a tolerance of 1e-8.
#[test]
fn planted_parameters_are_found_without_errors() {
    for (planted, error) in [(rigid(), 1e-6), (supports(), 1e-5)] {
        let found = fitted(&planted.problem(planted.measured(0)));
        for (Estimate { name, value, .. }, truth) in pairs(&planted, &found) {
            assert!((value / truth - 1.0).abs() < error, "{name} = {value}, planted {truth}");
        }
    }
}

/// Of 30 intervals of 80 %, fewer than 18 contain the truth in 3 of 1000 seeds, and all of them in 1 of 1000.
#[test]
fn intervals_contain_the_truth() {
    let planted = rigid();
    let (mut profile, mut quadratic, mut notes) = (0, 0, 0);
    for seed in 1..=10 {
        let mut problem = planted.problem(planted.measured(seed));
        problem.options.level = 0.8;
        let found = fitted(&problem);
        for (Estimate { interval, quadratic_interval, .. }, truth) in pairs(&planted, &found) {
            let Some([Some(low), Some(high)]) = *interval else { panic!("{found:?}") };
            profile += usize::from((low..=high).contains(&truth));
            quadratic += usize::from((quadratic_interval[0]..=quadratic_interval[1]).contains(&truth));
            // Errors of 1 % make these parameters nearly linear.
            let width = (high - low) / (quadratic_interval[1] - quadratic_interval[0]);
            assert!((width - 1.0).abs() < 0.1, "{interval:?} {quadratic_interval:?}");
        }
        notes += found.notes.len();
    }
    assert!((18..30).contains(&profile) && (18..30).contains(&quadratic), "{profile} {quadratic}");
    // White errors of the stated size cause no note, except by chance.
    assert!(notes <= 1);
}

/// Runs of whole fits, without derivatives and with them. A run with them takes a third to two thirds of the instructions of a run with
/// a row at each measured time, and one without them, for 100 values at most, less (docs/studies/fit.md).
#[test]
fn a_fit_takes_few_runs() {
    for (planted, without, most) in [(rigid(), 13, 29), (supports(), 32, 44)] {
        for seed in 1..=4 {
            let found = fitted(&planted.problem(planted.measured(seed)));
            assert!(found.runs[0] <= without && found.runs[1] <= most, "{seed}: {:?}", found.runs);
        }
    }
}

/// The estimates with the noise given and estimated are the same; the estimated noise is the planted one to 3 of its deviations.
#[test]
fn noise_that_is_not_given_is_estimated() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(3));
    let given = fitted(&problem);
    problem.tests[0].noise = None;
    let found = fitted(&problem);
    assert!(pairs(&planted, &found).zip(&given.estimates).all(|((a, _), b)| (a.value / b.value - 1.0).abs() < 1e-4));
    let noise = found.noise.unwrap() / (NOISE * planted.releases[0][0]);
    let values = problem.tests[0].values.len() as f64;
    assert!((noise - 1.0).abs() < 3.0 / (2.0 * values).sqrt(), "{noise}");
    // Standard errors are in proportion to it.
    let errors = found.estimates[0].standard_error / given.estimates[0].standard_error;
    assert!((errors / noise - 1.0).abs() < 1e-3, "{errors} {noise}");
    assert_eq!(found.reduced_chi_squared, None);
}

/// One parameter has no others to be fitted again along its profile.
#[test]
fn one_parameter_is_fitted_alone() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(2));
    problem.block = planted.truth.with(&problem.block.common);
    problem.free = vec![Free::named("p")];
    let found = fitted(&problem);
    let Some([Some(low), Some(high)]) = found.estimates[0].interval else { panic!("{found:?}") };
    assert!(low < 3.1 && 3.1 < high && high - low < 0.01, "{low} to {high}");
}

/// A sensor with a drift of its zero, and a clock that is late.
#[test]
fn zero_and_delay_are_found_with_the_tilt() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(0));
    let [zero, delay] = [0.004, 0.0731];
    let test = &mut problem.tests[0];
    test.times.iter_mut().for_each(|time| *time += delay);
    test.values.iter_mut().for_each(|value| *value += zero);
    test.initial.theta *= 1.1;
    test.free = ["initial.theta", "zero", "delay"].map(Free::named).into();
    let found = fitted(&problem);
    let planted_at = [("test_1.zero", zero), ("test_1.delay", delay), ("test_1.initial.theta", planted.releases[0][0])];
    for Estimate { name, value, standard_error, .. } in &found.estimates {
        let truth = planted_at.iter().find(|(known, _)| known == name).map_or_else(|| planted.planted(name), |of| of.1);
        // Steps end below a thousandth of a standard error.
        assert!((value - truth).abs() < 0.005 * standard_error, "{name} = {value} ± {standard_error}, planted {truth}");
    }
    // A test's own parameters have the quadratic interval alone.
    assert!(found.estimates[3..].iter().all(|estimate| estimate.interval.is_none()));
}

/// A block whose restitution is fixed at a wrong value cannot follow the test, and the fit says so.
#[test]
fn a_wrong_model_is_reported() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(4));
    problem.free.pop();
    let found = fitted(&problem);
    assert!(found.reduced_chi_squared.unwrap() > 4.0);
    assert!(found.tests[0].durbin_watson < 0.5);
    for part in ["times the noise", "correlated"] {
        assert!(found.notes.iter().any(|note| note.contains(part)), "{part}: {:?}", found.notes);
    }
}

#[test]
fn an_estimate_at_its_bound_is_reported() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(4));
    problem.free[1].bounds = Some([0.23, 0.3]);
    let found = fitted(&problem);
    assert_eq!(found.estimates[1].at_bound, Some(0.23));
    assert!(found.notes.iter().any(|note| note.starts_with("alpha ends at its bound 0.23")), "{:?}", found.notes);
}

/// The rotation does not depend on the mass, and a prior a hundred times as narrow as the data's interval decides.
#[test]
fn priors_count_and_what_the_data_do_not_tell_is_named() {
    let planted = rigid();
    let mut problem = planted.problem(planted.measured(4));
    problem.free.push(Free::named("mass"));
    let without = fitted(&problem);
    assert!(without.notes.iter().any(|note| note == "the data do not determine mass"), "{:?}", without.notes);
    assert_eq!(without.estimates[3].interval, Some([None, None]));
    let [mean, deviation] = [3.11, 0.01 * without.estimates[0].standard_error];
    problem.free[0].prior = Some([mean, deviation]);
    problem.free[3].prior = Some([1100.0, 10.0]);
    let with = fitted(&problem);
    assert!((with.estimates[0].value - mean).abs() < 0.1 * without.estimates[0].standard_error);
    let Estimate { value, standard_error, interval, .. } = &with.estimates[3];
    let Some([Some(low), Some(high)]) = *interval else { panic!("{interval:?}") };
    assert!((value - 1100.0).abs() < 0.01 && (standard_error - 10.0).abs() < 0.01, "{value} ± {standard_error}");
    assert!((high - low - 2.0 * 1.959964 * 10.0).abs() < 0.1, "{low} to {high}");
    assert!(with.notes.iter().any(|note| note == "the data do not determine mass"), "a prior is no datum");
}

/// The same bits with any number of threads.
#[test]
fn threads_change_no_bit() {
    let planted = rigid();
    let problem = planted.problem(planted.measured(8));
    let two = fit(&problem, &pool(Some(2)).unwrap(), &|_, _| ()).unwrap();
    assert_eq!(two.estimates, fitted(&problem).estimates);
}

/// A block under a pulse whose amplitude is unknown, by its reactions as well as its rotation.
#[test]
fn a_shaking_table_test_of_two_quantities_is_fitted() {
    let dimensionless =
        Dimensionless { alpha: 0.25, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 30.0, xi_v: 0.2 }) };
    let common = Common::default();
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 4.0, period: 0.8, ..Pulse::NONE };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let run = Run { pulse, duration: Some(3.0), output_step: 0.01, ..Run::at_rest(block, settings) };
    let rows = run.history(|_| ()).unwrap().rows;
    let test = |output: &str, noise: f64, value: fn(&Row) -> f64| Test {
        output: output.into(),
        pulse: Pulse { amplitude: 3.6, ..pulse },
        initial: Initial::default(),
        noise: Some(noise),
        free: vec![Free::named("pulse.amplitude")],
        ..Test::release(0.0, rows.iter().map(|row| row.time).collect(), rows.iter().map(value).collect())
    };
    let tests =
        vec![test("theta", 1e-3, |row| row.observation.theta), test("N_L", 50.0, |row| row.observation.reaction[0])];
    let supports = dimensionless.supports.with(|ratios| Ratios { eta: 33.0, ..ratios });
    let block = Dimensionless { alpha: 0.27, supports, ..dimensionless }.with(&common);
    let free = vec![Free::named("alpha"), Free::named("eta")];
    let found = fitted(&Problem { block, ties: Vec::new(), free, tests, options: Options::default() });
    for (estimate, truth) in found.estimates.iter().zip([0.25, 30.0, 4.0, 4.0]) {
        assert!((estimate.value / truth - 1.0).abs() < 1e-5, "{estimate:?}");
    }
    assert_eq!(found.block.foundation, Foundation::Viscoelastic);
}

/// A fault that a problem gets.
type Change<'a> = &'a dyn Fn(&mut Problem);

#[test]
fn errors_say_what_was_found_and_what_is_expected() {
    let planted = rigid();
    let sound = planted.problem(planted.measured(1));
    let message_of = |change: &dyn Fn(&mut Problem)| {
        let mut problem = sound.clone();
        change(&mut problem);
        fit(&problem, &pool(Some(1)).unwrap(), &|_, _| ()).unwrap_err().to_string()
    };
    let cases: [(Change, &str); 12] = [
        (&|of| of.free[0].name = "eta".into(), "eta is no real parameter of this block; expected one of alpha, p"),
        (&|of| of.free[0].name = "initial.theta".into(), "initial.theta belongs to a test; expected it among"),
        (&|of| of.free[1].name = "p".into(), "p is given twice; expected it once"),
        (&|of| of.free.clear(), "nothing is free; expected one parameter at least"),
        (&|of| of.free[0].bounds = Some([4.0, 5.0]), "p = 2.635 is not within its bounds [4, 5]; expected"),
        (
            &|of| of.free[0].prior = Some([3.0, 0.0]),
            "prior of p = [3, 0]; expected a mean and a standard deviation > 0",
        ),
        (&|of| of.tests.clear(), "there is no test; expected one at least"),
        (
            &|of| of.tests[0].output = "tilt".into(),
            "test_1: there is no measured quantity tilt; expected one of theta, ",
        ),
        (&|of| of.tests[0].values.truncate(250), "test_1: 251 times and 250 values; expected equal numbers"),
        (&|of| of.tests[0].times[4] = 0.0, "test_1: time 5 is 0 s, after 0.06 s; expected increasing times"),
        (&|of| of.tests[0].initial.theta = 0.0, "test_1: nothing moves the block; expected a record, a pulse or"),
        (&|of| of.options.level = 1.0, "level = 1; expected a number above 0 and below 1"),
    ];
    for (change, expected) in cases {
        let message = message_of(change);
        assert!(message.starts_with(expected), "{message}");
    }
    let mut unweighted = sound;
    unweighted.tests[0].noise = None;
    unweighted.free[0].prior = Some([3.0, 0.1]);
    let message = fit(&unweighted, &pool(Some(1)).unwrap(), &|_, _| ()).unwrap_err().to_string();
    assert_eq!(message, "prior of p without noise; expected both, since one weighs the other");
}
