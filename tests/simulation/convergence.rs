//! Convergence orders of the integrator on smooth motion, and error over tolerance on whole runs.

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Regime, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Forcing, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::control::StepControl;
use rocking_block::numerics::dop853::{self, DenseOutput, DenseStep};
use rocking_block::numerics::dual::Dual;
use rocking_block::numerics::roots::{PIECES, first_fall};
use rocking_block::numerics::short::{self, ShortStep};
use rocking_block::numerics::{Rate, StageRates};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::dynamics::instant;
use rocking_block::system::instant::{Footing, State};
use rocking_records::ReadOptions;

use crate::blocks::plain;
use crate::common::cases;

/// Rate of a block on its right corner under a non-polynomial horizontal acceleration.
fn rate(block: &Block, time: f64, x: &State) -> Rate {
    let forcing =
        Forcing { x: 2.0 * libm::sin(9.0 * time), z: 0.5 * libm::cos(7.0 * time), moment: 0.0, ..Forcing::default() };
    let x = instant(block, Regime::TiltingRight, [x[0], x[1], x[2], x[3]], Footing::AT_START, forcing);
    let quadratures = x.powers(block, Regime::TiltingRight, forcing).into();
    Rate { state: State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot]), quadratures }
}

fn start() -> State {
    State::from([0.1, -0.05, -0.004, 0.03])
}

/// Returns the state after 0.4 s in `steps` equal steps, and the dense output a third into the last.
fn run(steps: u32) -> (State, State, f64) {
    let block = plain();
    let size = 0.4 / f64::from(steps);
    let (mut x, mut inside, mut inside_time) = (start(), State::zeros(), 0.0);
    for i in 0..steps {
        let time = size * f64::from(i);
        let f = |t: f64, x: &State| rate(&block, t, x);
        let step = DenseStep::attempt(time, size, x, f(time, &x), &f);
        inside_time = time + size / 3.0;
        inside = step.dense(f(time + size, &step.end), &f).state(size / 3.0);
        x = step.end;
    }
    (x, inside, inside_time)
}

/// Returns the state at a time (s) by the classical Runge–Kutta method, which shares no coefficient with the solver.
fn exact(time: f64) -> State {
    const STEPS: u32 = 10_000;
    let (block, size) = (plain(), time / f64::from(STEPS));
    let slope = |t: f64, x: State| rate(&block, t, &x).state;
    (0..STEPS).fold(start(), |x, i| {
        let t = size * f64::from(i);
        let k1 = slope(t, x);
        let k2 = slope(t + 0.5 * size, x + k1 * (0.5 * size));
        let k3 = slope(t + 0.5 * size, x + k2 * (0.5 * size));
        let k4 = slope(t + size, x + k3 * size);
        x + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (size / 6.0)
    })
}

fn slope(errors: &[(f64, f64)]) -> f64 {
    let n = errors.len() as f64;
    let logs: Vec<(f64, f64)> = errors.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let (mx, my) = logs.iter().fold((0.0, 0.0), |s, l| (s.0 + l.0 / n, s.1 + l.1 / n));
    let covariance: f64 = logs.iter().map(|l| (l.0 - mx) * (l.1 - my)).sum();
    covariance / logs.iter().map(|l| (l.0 - mx).powi(2)).sum::<f64>()
}

#[test]
fn steps_are_of_order_eight() {
    let exact = exact(0.4);
    let errors: Vec<(f64, f64)> =
        [20, 24, 28, 32, 40].iter().map(|&n| (0.4 / f64::from(n), (run(n).0 - exact).norm())).collect();
    let order = slope(&errors);
    assert!((7.6..9.0).contains(&order), "order {order} from {errors:?}");
}

#[test]
fn the_dense_output_is_of_order_seven() {
    let errors: Vec<(f64, f64)> = [8, 10, 12, 16, 20]
        .iter()
        .map(|&n| {
            let (_, inside, time) = run(n);
            (0.4 / f64::from(n), (inside - exact(time)).norm())
        })
        .collect();
    let order = slope(&errors);
    // One step adds an error of order h^8 to those of the steps before.
    assert!((7.0..9.0).contains(&order), "order {order} from {errors:?}");
}

/// The steps are of order 5, their embedded estimate of order 4.
#[test]
fn short_steps_are_of_order_five() {
    let block = plain();
    let f = |t: f64, x: &State| rate(&block, t, x);
    // 0.4 s in equal steps: final state and greatest estimated error.
    let run = |steps: u32| {
        let size = 0.4 / f64::from(steps);
        let weights = State::from([1.0; 4]);
        (0..steps).fold((start(), 0.0_f64), |(x, estimate), i| {
            let time = size * f64::from(i);
            let step = ShortStep::attempt(time, size, x, f(time, &x), &f);
            (step.end, estimate.max(step.error(f(time + size, &step.end), weights, 0.0)))
        })
    };
    let exact = exact(0.4);
    let (mut errors, mut estimates) = (Vec::new(), Vec::new());
    for steps in [40, 50, 64, 80, 100] {
        let (size, (end, estimate)) = (0.4 / f64::from(steps), run(steps));
        errors.push((size, (end - exact).norm()));
        estimates.push((size, estimate));
    }
    let order = slope(&errors);
    assert!((4.7..5.5).contains(&order), "order {order} from {errors:?}");
    // The local error is one order above that of the embedded result.
    let order = slope(&estimates);
    assert!((4.7..5.5).contains(&order), "order {order} of the estimates {estimates:?}");
}

/// Interpolation between the ends of a step: displacements of order 6, velocities and works of order 4.
///
/// The dense output, of order 7 as shown above, stands for the exact motion: one step of it is far more accurate.
#[test]
fn the_interpolant_of_a_short_step_has_its_orders() {
    let block = plain();
    let f = |t: f64, x: &State| rate(&block, t, x);
    let mut found = [[(0.0, 0.0); 4]; 3];
    for (i, size) in [0.003, 0.004, 0.005, 0.006].into_iter().enumerate() {
        // Many initial states, because the error may vanish by chance at one.
        let (mut time, mut x, mut sums) = (0.0, start(), [0.0; 3]);
        for _ in 0..50 {
            let first = f(time, &x);
            let step = DenseStep::attempt(time, size, x, first, &f);
            let last = f(time + size, &step.end);
            let exact = step.dense(last, &f);
            let between = DenseOutput::between(time, size, [(x, first), (step.end, last)], step.work);
            let elapsed = 0.4 * size;
            let off = between.state(elapsed) - exact.state(elapsed);
            let of_works = between.work(elapsed) - exact.work(elapsed);
            for (sum, off) in sums.iter_mut().zip([off[0].hypot(off[2]), off[1].hypot(off[3]), of_works.norm()]) {
                *sum += off * off;
            }
            for end in [0.0, size] {
                assert!((between.state(end) - exact.state(end)).norm() < 1e-14, "{end}");
            }
            (time, x) = (time + 0.008, DenseStep::attempt(time, 0.008, x, first, &f).end);
        }
        for (series, sum) in sums.into_iter().enumerate() {
            found[series][i] = (size, sum.sqrt());
        }
    }
    let [displacements, velocities, works] = found;
    for (errors, expected) in [(displacements, 6.0), (velocities, 4.0), (works, 4.0)] {
        let order = slope(&errors);
        assert!((order - expected).abs() < 0.5, "order {order}, expected {expected}, from {errors:?}");
    }
}

/// Between stops every few milliseconds most steps take six evaluations; each restart takes one more.
#[test]
fn short_steps_lead_from_stop_to_stop() {
    let block = plain();
    let push = |time: f64| Ramp { value: 4.0 * libm::sin(5.0 * time), rate: 20.0 * libm::cos(5.0 * time) };
    let mut simulation = Simulation::new(
        block,
        Settings::default(),
        Pulse::NONE,
        &Initial::default(),
        0.0,
        &Inputs { a_gx: push(0.0), ..Inputs::default() },
    );
    let stops = 2000;
    for k in 0..stops {
        let (time, until) = (0.002 * f64::from(k), 0.002 * f64::from(k + 1));
        let inputs = Inputs { time, a_gx: push(time), ..Inputs::default() };
        simulation.advance(until, &inputs, &mut |_| ()).unwrap();
    }
    let counts = simulation.counts();
    assert!(counts.impacts > 3, "{counts:?}");
    assert!(counts.evaluations < 8 * stops as u64, "{counts:?}");
}

/// In a run with impacts the error in units of α is proportional to the tolerance and below 100 times it.
///
/// The exact rotation is that of an independent program (tests/reference).
#[test]
fn the_error_follows_the_tolerance() {
    let pulse = Pulse {
        shape: PulseShape::OneSine,
        amplitude: 6.2622,
        period: std::f64::consts::TAU / 5.0,
        start: 0.0,
        ..Pulse::NONE
    };
    let theta = |tolerance: f64| {
        let settings = Settings { tolerance, ..Settings::default() };
        let mut simulation = Simulation::new(plain(), settings, pulse, &Initial::default(), 0.0, &Inputs::default());
        simulation.advance(8.0, &Inputs::default(), &mut |_| ()).unwrap();
        assert!(simulation.counts().rejected > 0, "no step was rejected");
        simulation.observe(&Inputs::default()).theta
    };
    let case = cases().into_iter().find(|case| case.name == "sine_eta40").unwrap();
    let exact = case.rows().iter().find(|row| row.t == 8.0).unwrap().theta;
    let errors: Vec<(f64, f64)> =
        [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10].iter().map(|&t| (t, (theta(t) - exact).abs() / 0.25)).collect();
    for &(tolerance, error) in &errors {
        assert!(error < 100.0 * tolerance, "{error} alpha at {tolerance}: {errors:?}");
    }
    let order = slope(&errors);
    assert!((0.7..1.3).contains(&order), "the error goes with the tolerance to the power {order}: {errors:?}");
}

/// The error sets the factor of the next step size; after a rejected step the size does not grow.
///
/// A step shortened by a stop does not shorten the following ones, unless its own error requires it.
#[test]
fn sizes_follow_the_errors() {
    let [far, longest, shortest] = [1e6, 10.0, 1e-12];
    let mut control = StepControl::NEW;
    let next = |control: &StepControl| control.attempt(far, longest, shortest).size;
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-5, "{found}, not {expected}");
    close(next(&control), longest);
    let again = control.reject(&control.attempt(far, longest, shortest), 0.01);
    assert_eq!((again.size, again.last), (0.1, false));
    control.accept(&again, 3.0, longest);
    close(next(&control), 0.1);
    control.accept(&control.attempt(far, longest, shortest), 3.0, longest);
    close(next(&control), 0.3);
    control.accept(&control.attempt(far, longest, shortest), 0.5, longest);
    close(next(&control), 0.15);
    for factor in [1.0, 2.0] {
        let to_stop = control.attempt(0.01, longest, shortest);
        assert_eq!((to_stop.size, to_stop.last), (0.01, true));
        control.accept(&to_stop, factor, longest);
        close(next(&control), 0.15);
    }
    control.accept(&control.attempt(0.01, longest, shortest), 0.5, longest);
    close(next(&control), 0.005);
    let again = control.reject(&control.attempt(far, longest, shortest), 0.5);
    control.accept(&again, 0.8, longest);
    close(next(&control), 0.002);
}

#[test]
fn an_invalid_step_size_is_refused() {
    for (size, valid) in [("0.1", true), ("0.0", false), ("-0.1", false)] {
        let control: StepControl = serde_json::from_str(&format!("{{\"size\": {size}, \"short_size\": 1.0}}")).unwrap();
        assert_eq!(control.is_valid(), valid, "{size}");
    }
}

/// The looped and the unrolled stages agree to the bit.
#[test]
fn looped_and_unrolled_stages_are_the_same() {
    let block = plain();
    let f = |t: f64, x: &State| rate(&block, t, x);
    let (time, size, x) = (0.3, 0.02, start());
    let first = f(time, &x);
    let mut rates = StageRates::beginning_with(first);
    let step = DenseStep::attempt(time, size, x, first, &f);
    assert_eq!((step.end, step.work), dop853::attempt_in_loop(time, size, x, &mut rates, &f));
    let mut rates = StageRates::beginning_with(first);
    let step = ShortStep::attempt(time, size, x, first, &f);
    assert_eq!((step.end, step.work), short::attempt_in_loop(time, size, x, &mut rates, &f));
}

/// Errors of state and works combine as a root sum of squares.
#[test]
fn the_error_of_a_short_step_covers_state_and_works() {
    let block = plain();
    let f = |t: f64, x: &State| rate(&block, t, x);
    let step = ShortStep::attempt(0.3, 0.02, start(), f(0.3, &start()), &f);
    let end = f(0.32, &step.end);
    let weights = State::from([1.0, 0.5, 3.0, 2.0]);
    let [state, work, all] =
        [(weights, 0.0), (State::zeros(), 7.0), (weights, 7.0)].map(|(weights, work)| step.error(end, weights, work));
    assert!(state > 0.0 && work > 0.0 && (all / state.hypot(work) - 1.0).abs() < 1e-12, "{state}, {work}, {all}");
}

/// A dip that is short relative to the interval is found where it begins.
#[test]
fn a_dip_late_in_a_long_interval_is_found() {
    let dip = |t: f64| Dual::new((t - 74.5) * (t - 75.5), 2.0 * t - 150.0);
    let root = first_fall(dip(0.0), dip(80.0), 1e-15, 80.0, PIECES, false, &mut { dip }).unwrap();
    assert!((root - 74.5).abs() < 1e-12, "{root}");
}

/// Returns evaluations and steps per stop of a bouncing block, with stops every `size` (s).
fn costs_of_a_stop(size: f64, tolerance: f64) -> [f64; 2] {
    let block = plain();
    let settings = Settings { tolerance, ..Settings::default() };
    let vertical = Some((0.05 * block.static_deflection(), 0.0));
    let initial = Initial { vertical, ..Initial::default() };
    let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
    let mut stop = || {
        simulation.advance(simulation.time() + size, &Inputs::default(), &mut |_| ()).unwrap();
        simulation.counts()
    };
    // The motion has decayed enough that no new peak occurs.
    let before = (0..60).map(|_| stop()).last().unwrap();
    let after = (0..10).map(|_| stop()).last().unwrap();
    [(after.evaluations - before.evaluations) as f64 / 10.0, (after.steps - before.steps) as f64 / 10.0]
}

/// A step to a near stop takes six evaluations and the restart one, at loose tolerances as well.
#[test]
fn short_steps_take_six_evaluations() {
    for tolerance in [1e-8, 1e-6, 1e-4] {
        assert_eq!(costs_of_a_stop(0.05 / plain().omega_v, tolerance), [7.0, 1.0], "tolerance {tolerance}");
    }
}

/// At the tolerance of studies, works of a motion far weaker than rocking at α p are as accurate as the motion.
#[test]
fn the_balance_of_energy_of_a_weak_motion_holds_at_a_loose_tolerance() {
    let bytes = include_bytes!("../../examples/records/0111a.smc");
    let record = rocking_records::parse("0111a.smc", bytes, &ReadOptions::default()).unwrap();
    let ground = Ground { horizontal: Some(record), vertical: None }.scaled(2.0);
    let common = Common::default();
    let block =
        Block::from_dimensionless(&Dimensionless { alpha: 0.2, p: 0.5, supports: Supports::HOUSNER }, &common).unwrap();
    let settings = Settings { tolerance: Settings::OF_STUDIES, ..Settings::default() };
    let (inputs, _) = ground.inputs_from(0.0);
    let mut simulation = Simulation::new(block, settings, Pulse::NONE, &Initial::default(), 0.0, &inputs);
    let (mut residual, mut largest) = (0.0_f64, 0.0_f64);
    while simulation.time() < 30.0 {
        let (inputs, until) = ground.inputs_from(simulation.time());
        simulation.advance(until.min(30.0), &inputs, &mut |_| ()).unwrap();
        let energies = simulation.energies();
        residual = residual.max(energies.residual.abs());
        largest = largest.max(energies.total);
    }
    assert!(simulation.counts().liftoffs > 0 && simulation.peaks().theta < 1e-4 * block.alpha);
    assert!(residual < 1e-8 * largest, "{residual} J of {largest} J");
}

/// With close stops and a loose tolerance, events and works match those of a tight tolerance.
#[test]
fn a_loose_tolerance_keeps_events_between_close_stops() {
    let run = |tolerance: f64| {
        let push = |time: f64| Ramp { value: 5.0 * libm::sin(5.0 * time), rate: 25.0 * libm::cos(5.0 * time) };
        let settings = Settings { tolerance, ..Settings::default() };
        let begin = Inputs { a_gx: push(0.0), ..Inputs::default() };
        let mut simulation = Simulation::new(plain(), settings, Pulse::NONE, &Initial::default(), 0.0, &begin);
        let mut events = Vec::new();
        for k in 0..1500 {
            let (time, until) = (0.004 * f64::from(k), 0.004 * f64::from(k + 1));
            let inputs = Inputs { time, a_gx: push(time), ..Inputs::default() };
            simulation.advance(until, &inputs, &mut |event| events.push(event.time)).unwrap();
        }
        (events, simulation)
    };
    let ((loose, a), (narrow, b)) = (run(1e-6), run(1e-12));
    assert_eq!(loose.len(), narrow.len());
    assert!(loose.len() > 10, "{} events", loose.len());
    for (loose, narrow) in loose.iter().zip(&narrow) {
        assert!((loose - narrow).abs() < 2e-5, "an event at {loose} s, not {narrow} s");
    }
    assert!(a.counts().steps >= 1500, "fewer steps than stops: {:?}", a.counts());
    let [loose, narrow] = [a, b].map(|simulation| simulation.energies());
    for (loose, narrow) in [(loose.input, narrow.input), (loose.dashpots, narrow.dashpots)] {
        assert!((loose / narrow - 1.0).abs() < 1e-4, "{loose}, not {narrow}");
    }
}

/// Returns the greatest difference in rotation, in α, from Housner's block with the e of ε = `of`.
///
/// The released block has four impacts in the four seconds compared.
fn from_housner(eta: f64, xi_v: f64, epsilon: f64, of: f64) -> f64 {
    let rotation = |foundation, epsilon| -> Vec<f64> {
        let d = Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::of(foundation, Ratios { eta, xi_v }) };
        let common = Common { epsilon, ..Common::default() };
        let block = Block::from_dimensionless(&d, &common).unwrap();
        let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
        let initial = Initial { theta: 0.1, ..Initial::default() };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        let rotation = |i| {
            simulation.advance(0.02 * f64::from(i), &inputs, &mut |_| ()).unwrap();
            simulation.observe(&inputs).theta
        };
        (1..=200).map(rotation).collect()
    };
    let (soft, rigid) = (rotation(Foundation::Viscoelastic, epsilon), rotation(Foundation::Rigid, of));
    soft.iter().zip(rigid).map(|(soft, rigid)| (soft - rigid).abs()).fold(0.0, f64::max) / 0.25
}

/// Damped supports with ε = 0 tend to Housner's block as η⁻²; docs/unit/model.md has the numbers.
#[test]
fn damped_supports_tend_to_the_rigid_base() {
    for xi_v in [0.1, 0.4] {
        let distances: Vec<(f64, f64)> =
            [200.0, 400.0, 800.0, 1600.0].iter().map(|&eta| (eta, from_housner(eta, xi_v, 0.0, 0.0))).collect();
        let order = slope(&distances);
        assert!((order + 2.0).abs() < 0.05, "order {order}: {distances:?}");
    }
}

/// Supports with ε > 0 or without damping do not tend to Housner's block, neither of that ε nor of ε = 0.
#[test]
fn other_supports_do_not_tend_to_the_rigid_base() {
    for eta in [400.0, 1600.0] {
        let far = from_housner(eta, 0.1, 0.4, 0.4);
        assert!((far - 0.09).abs() < 2e-3, "η = {eta}: {far}");
    }
    let near = [1600.0, 3200.0].map(|eta| from_housner(eta, 0.1, 0.4, 0.0));
    // Second order would reduce the first to a quarter, and the lower ones to a sixteenth.
    assert!(near.iter().all(|near| (5e-5..1e-3).contains(near)) && near[1] > near[0] / 2.0, "{near:?}");
    let undamped = [400.0, 1600.0].map(|eta| from_housner(eta, 0.0, 0.0, 0.0));
    assert!(undamped[1] > undamped[0] / 4.0, "{undamped:?}");
}
