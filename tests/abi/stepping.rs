//! Communication steps and inputs between them, reproducible to the bit.

use crate::functions::*;
use crate::host::{Instance, call, reference};

const ALPHA: f64 = 0.25;

/// The block of the paper's figure 6 under a one-sine pulse: eleven events in ten seconds.
fn under_a_pulse(tolerance: f64) -> Instance {
    let instance = Instance::new("block");
    instance.set("pulse.shape", 2.0);
    instance.set("pulse.amplitude", 6.2622);
    instance.set("pulse.period", std::f64::consts::TAU / 5.0);
    instance.initialize(Some(tolerance));
    instance
}

/// Returns the outputs after each step of a run with inputs, rates and irregular steps.
fn busy_run(instance: &Instance) -> Vec<Vec<u64>> {
    let mut time = 0.0;
    (0..60)
        .map(|i| {
            let step = 0.01 + 0.05 * f64::from(i * i % 7);
            busy_step(instance, i, time, step);
            time += step;
            instance.output_bits()
        })
        .collect()
}

fn busy_step(instance: &Instance, i: i32, time: f64, step: f64) {
    instance.set("a_gx", 2.5 * (0.9 * f64::from(i)).sin());
    instance.set("a_gz", 0.5 * (1.7 * f64::from(i)).cos());
    if i % 3 == 0 {
        instance.set_rate("a_gx", 1.5);
        instance.set_rate("M_y", -300.0);
    }
    instance.step(time, step);
}

#[test]
fn any_communication_step_gives_the_same_motion() {
    // Relative to alpha; the bounds for the reference trajectories at these tolerances.
    for (tolerance, bound) in [(1e-8, 1e-5), (1e-10, 1e-7)] {
        let run = |steps: &dyn Fn(i32) -> f64| {
            let instance = under_a_pulse(tolerance);
            let (mut time, mut i) = (0.0, 0);
            while time < 10.0 {
                let next = (time + steps(i)).min(10.0);
                instance.step(time, next - time);
                (time, i) = (next, i + 1);
            }
            instance
        };
        let one = run(&|_| 10.0);
        assert!(one.get("events.impacts") >= 4.0 && one.get("events.liftoffs") >= 5.0);
        let others: [&dyn Fn(i32) -> f64; 6] =
            [&|_| 1.0, &|_| 0.1, &|_| 0.01, &|_| 0.003, &|i| 1e-5 * 1.3_f64.powi(i % 40), &|i| {
                [0.5, 1e-6][(i % 2) as usize]
            }];
        for (i, steps) in others.into_iter().enumerate() {
            let other = run(steps);
            for (name, scale) in
                [("theta", ALPHA), ("theta_dot", ALPHA), ("peak.theta", ALPHA), ("events.last_time", 1.0)]
            {
                let difference = (other.get(name) - one.get(name)).abs();
                assert!(difference <= bound * scale, "steps {i} at {tolerance:e}: {name} differs by {difference:e}");
            }
            for name in ["regime", "events.impacts", "events.liftoffs"] {
                assert_eq!(other.get(name), one.get(name), "steps {i} at {tolerance:e}: {name}");
            }
        }
    }
}

/// A ramp with its derivative is the same signal in one step or in ten, with values set again or not.
#[test]
fn a_ramp_is_followed_exactly() {
    let ramped = |steps: i32, set_again: bool| {
        let instance = Instance::new("block");
        instance.set("a_gx", -1.0);
        instance.set("F_z", 500.0);
        instance.initialize(Some(1e-11));
        let step = 2.0 / f64::from(steps);
        for i in 0..steps {
            let time = step * f64::from(i);
            if set_again {
                instance.set("a_gx", -1.0 + 4.0 * time);
                instance.set("F_z", 500.0 - 700.0 * time);
            }
            instance.set_rate("a_gx", 4.0);
            instance.set_rate("F_z", -700.0);
            instance.step(time, step);
        }
        assert!((instance.get("a_gx") - 7.0).abs() < 1e-12, "the input is where the ramp ends");
        assert!((instance.get("F_z") + 900.0).abs() < 1e-9);
        instance
    };
    let one = ramped(1, true);
    assert!(one.get("events.liftoffs") > 0.0);
    for other in [ramped(10, true), ramped(10, false), ramped(7, false)] {
        for (name, scale) in [("theta", ALPHA), ("theta_dot", ALPHA), ("energy.input", 1e4), ("peak.theta", ALPHA)] {
            let difference = (other.get(name) - one.get(name)).abs();
            // A few units of the integrator's tolerance.
            assert!(difference <= 1e-9 * scale, "{name} differs by {difference:e}");
        }
    }
}

#[test]
fn without_derivatives_the_input_is_held() {
    let run = |zero_rates: bool| {
        let instance = Instance::new("block");
        instance.initialize(None);
        let mut trace = Vec::new();
        for i in 0..20 {
            let time = f64::from(i) * 0.125;
            // A rate applies to one step only.
            if i == 3 {
                instance.set_rate("a_gx", 20.0);
            } else if zero_rates {
                instance.set_rate("a_gx", 0.0);
            }
            let before = instance.get("a_gx");
            instance.step(time, 0.125);
            let moved = instance.get("a_gx") - before;
            assert_eq!(moved, if i == 3 { 2.5 } else { 0.0 }, "step {i}");
            trace.push(instance.output_bits());
        }
        trace
    };
    assert_eq!(run(false), run(true));
}

/// A constant input differs from the ramp, so the test above notices an FMU without derivatives.
#[test]
fn a_held_input_differs_from_a_ramp() {
    let run = |rate: f64| {
        let instance = Instance::new("block");
        instance.initialize(None);
        instance.set_rate("a_gx", rate);
        instance.step(0.0, 1.0);
        instance.get("theta")
    };
    assert_eq!(run(0.0), 0.0);
    assert!(run(1.0) < -1e-6, "ground that accelerates to the right leaves the block behind");
}

#[test]
fn derivatives_may_come_before_initialization_ends() {
    let run = |when: u32| {
        let instance = Instance::new("block");
        let set = || {
            instance.set("a_gx", 1.0);
            instance.set_rate("a_gx", 5.0);
        };
        if when == 0 {
            set();
        }
        assert_eq!(instance.setup(None, 0.0, None), OK);
        if when == 1 {
            set();
        }
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        if when == 2 {
            set();
        }
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        if when == 3 {
            set();
        }
        instance.step(0.0, 1.0);
        assert_eq!(instance.get("a_gx"), 6.0);
        instance.get("theta").to_bits()
    };
    assert_eq!([run(0), run(1), run(2)], [run(3); 3]);
}

/// Inputs may be set in any order and number of calls; the last value counts.
#[test]
fn several_values_in_one_call() {
    let one = Instance::new("one");
    let many = Instance::new("many");
    for instance in [&one, &many] {
        instance.initialize(None);
    }
    let references = ["a_gz", "F_x", "a_gx", "a_gx"].map(reference);
    assert_eq!(call!(one, set_real, references.as_ptr(), 4, [1.0, 50.0, 9.0, 3.0].as_ptr()), OK);
    assert_eq!(
        call!(one, set_real_input_derivatives, references.as_ptr(), 3, [1; 3].as_ptr(), [1.0, 2.0, 3.0].as_ptr()),
        OK
    );
    for (name, value, rate) in [("a_gx", 3.0, 3.0), ("F_x", 50.0, 2.0), ("a_gz", 1.0, 1.0)] {
        many.set_rate(name, rate);
        many.set(name, value);
    }
    for instance in [&one, &many] {
        instance.step(0.0, 0.7);
    }
    assert_eq!(one.bits(), many.bits());
}

#[test]
fn a_reset_in_the_middle_gives_the_same_bits() {
    let fresh = |instance: &Instance| {
        instance.set_paper_block();
        instance.set("initial.theta", 0.05);
        instance.initialize(Some(1e-9));
        busy_run(instance)
    };
    let new = Instance::new("block");
    let first = fresh(&new);
    assert!(new.get("events.impacts") > 2.0, "the run is not an empty one");
    let used = Instance::new("block");
    used.set("dimensionless.alpha", 0.4);
    used.set("epsilon", 0.5);
    used.initialize(Some(1e-5));
    used.set("a_gx", 4.0);
    used.set_rate("a_gx", 3.0);
    used.go(0.0, 1.0, 0.25);
    assert_eq!(call!(used, reset), OK);
    assert_eq!(fresh(&used), first);
}

#[test]
fn interleaved_instances_give_the_same_bits_as_one_alone() {
    let start = |theta: f64| {
        let instance = Instance::new("block");
        instance.set("initial.theta", theta);
        instance.initialize(None);
        instance
    };
    let thetas = [0.05, -0.11];
    let alone = thetas.map(|theta| busy_run(&start(theta)));
    let together = thetas.map(start);
    let mut time = 0.0;
    for i in 0..60 {
        let step = 0.01 + 0.05 * f64::from(i * i % 7);
        for (instance, trace) in together.iter().zip(&alone) {
            busy_step(instance, i, time, step);
            assert_eq!(instance.output_bits(), trace[i as usize], "step {i}");
        }
        time += step;
    }
}

#[test]
fn instances_in_several_threads_give_the_same_bits() {
    let run = || {
        let instance = Instance::new("block");
        instance.set("initial.theta", 0.05);
        instance.initialize(None);
        busy_run(&instance)
    };
    let alone = run();
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(run)).collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
}

/// libcosim sets values right after instantiation, without `fmi2SetupExperiment`; some masters set no stop time.
#[test]
fn no_experiment_is_needed() {
    let bare = Instance::new("block");
    bare.set("initial.theta", 0.1);
    assert_eq!(call!(bare, enter_initialization_mode), OK);
    assert_eq!(call!(bare, exit_initialization_mode), OK);
    let full = Instance::new("block");
    assert_eq!(full.setup(None, 0.0, Some(2.0)), OK);
    full.set("initial.theta", 0.1);
    assert_eq!(call!(full, enter_initialization_mode), OK);
    assert_eq!(call!(full, exit_initialization_mode), OK);
    for instance in [&bare, &full] {
        instance.go(0.0, 2.0, 0.125);
    }
    assert_eq!(bare.bits(), full.bits());
}

/// Without a pulse only differences of time matter; a start far from 0 loses digits of time.
#[test]
fn runs_begin_at_the_start_time() {
    let run = |start: f64| {
        let instance = Instance::new("block");
        instance.set("initial.theta", 0.1);
        assert_eq!(instance.setup(Some(1e-10), start, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        assert_eq!(call!(instance, exit_initialization_mode), OK);
        assert_eq!(instance.get("events.last_time"), start);
        instance.step(start, 3.0);
        assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(start + 3.0));
        instance.get("theta")
    };
    for start in [-100.0, 1000.0] {
        let difference = (run(start) - run(0.0)).abs();
        assert!(difference <= 1e-8 * ALPHA, "from {start} s on theta differs by {difference:e}");
    }
}

/// Reading outputs between calls changes no later bit.
#[test]
fn reading_between_calls_changes_no_bit() {
    let run = |reads: bool| {
        let instance = Instance::new("block");
        instance.set("initial.theta", 0.003);
        instance.initialize(None);
        let mut seen = Vec::new();
        for i in 0..40 {
            let x = f64::from(i);
            instance.set("a_gx", (0.7 * x).sin());
            instance.set("F_x", 1234.5 * (0.3 * x).cos());
            if reads {
                instance.output_bits();
            }
            instance.set_rate("a_gx", 17.3 * (0.2 * x).cos());
            instance.set_rate("F_x", -4321.0);
            instance.step(0.013 * x, 0.013 * (x + 1.0) - 0.013 * x);
            if reads {
                instance.output_bits();
            }
            instance.set_rate("a_gx", 0.1);
            seen.push(instance.output_bits());
        }
        seen
    };
    assert_eq!(run(true), run(false));
}
