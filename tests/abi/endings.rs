//! Complete separation and overturning, terminated or held.

use crate::common::{Case, cases};
use crate::functions::*;
use crate::host::{FMU, Instance, call};
use crate::reference::{prepare, relative};

const RATES_AND_REACTIONS: [&str; 11] =
    ["theta_dot", "theta_ddot", "v_dot", "v_ddot", "u_dot", "u_ddot", "N_L", "N_R", "H", "M_base", "friction_demand"];

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).unwrap()
}

/// Returns the case at its beginning, with a tight tolerance.
fn start(case: &Case, hold: bool) -> Instance {
    let instance = Instance::new("block");
    prepare(&instance, case);
    if hold {
        instance.set("on_separation", 2.0);
        instance.set("on_overturning", 2.0);
    }
    instance.initialize(Some(1e-10));
    instance
}

/// Steps by 0.01 s until just before the end of the run, and returns the time.
fn approach(instance: &Instance, case: &Case) -> f64 {
    let steps = (case.t_final / 0.01).floor();
    instance.go(0.0, steps * 0.01, 0.01);
    steps * 0.01
}

#[test]
fn the_end_of_a_run_is_a_discarded_step_with_the_outputs_of_its_time() {
    for (name, flag, other, regime) in
        [("sine_separates", "separated", "overturned", 2.0), ("overturns", "overturned", "separated", 1.0)]
    {
        let case = case(name);
        let instance = start(&case, false);
        let time = approach(&instance, &case);
        assert_eq!([instance.get(flag), instance.get(other)], [0.0; 2]);
        assert_eq!(instance.boolean_status(TERMINATED), Ok(false));
        assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(time));
        let before = instance.save();
        assert_eq!(instance.try_step(time, 0.01), DISCARD);
        assert_eq!(instance.messages(), [], "the standard, 2.1.3: without logging a discarded step is not logged");
        instance.restore(before);
        instance.free(before);
        let discarded = c"logStatusDiscard".as_ptr();
        assert_eq!(call!(instance, set_debug_logging, 1, 1, &discarded), OK);

        assert_eq!(instance.try_step(time, 0.01), DISCARD);
        assert_eq!(call!(instance, set_debug_logging, 0, 0, std::ptr::null()), OK);
        let ended = instance.real_status(LAST_SUCCESSFUL_TIME).unwrap();
        assert!((ended - case.t_final).abs() <= 1e-6, "{name} ends at {ended} s instead of {} s", case.t_final);
        assert_eq!(instance.boolean_status(TERMINATED), Ok(true));
        let mut status = OK;
        assert_eq!((call!(instance, get_status, DO_STEP_STATUS, &mut status), status), (OK, DISCARD));
        let messages = instance.messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert_eq!((messages[0].status, messages[0].category.as_str()), (DISCARD, "logStatusDiscard"));
        assert!(messages[0].text.contains(&format!("{ended}")), "{:?} should hold {ended}", messages[0].text);

        assert_eq!([instance.get(flag), instance.get(other)], [1.0, 0.0]);
        assert_eq!(instance.get("regime").abs(), regime);
        assert_eq!(instance.get("events.last_time"), ended);
        if flag == "overturned" {
            assert!((instance.get("theta").abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        } else {
            assert_eq!([instance.get("N_L"), instance.get("N_R"), instance.get("H")], [0.0; 3]);
            // In flight after t_e, with the motion at the last instant of contact.
            assert!((instance.get("v_ddot") + 9.81).abs() < 1e-9 && instance.get("theta_ddot").abs() < 1e-9);
        }
        let bits = instance.bits();
        instance.refuses(instance.try_step(ended, 0.01), &["fmi2DoStep", "stepFailed"]);
        instance.refuses(instance.try_set("a_gx", 1.0), &["fmi2SetReal", "stepFailed"]);
        assert_eq!(call!(instance, terminate), OK);
        assert_eq!(instance.bits(), bits, "{name}: final values after fmi2Terminate");
    }
}

#[test]
fn the_end_does_not_depend_on_the_communication_step() {
    for name in ["sine_separates", "overturns"] {
        let case = case(name);
        for step in [10.0, 0.7] {
            let instance = start(&case, false);
            let mut time = 0.0;
            while instance.try_step(time, step) == OK {
                time += step;
            }
            let ended = instance.real_status(LAST_SUCCESSFUL_TIME).unwrap();
            assert!((ended - case.t_final).abs() <= 1e-6, "{name} in steps of {step} s ends at {ended} s");
        }
    }
}

#[test]
fn a_block_that_is_held_is_frozen_where_the_run_would_have_ended() {
    for (name, flag) in [("sine_separates", "separated"), ("overturns", "overturned")] {
        let case = case(name);
        let (ended, held) = (start(&case, false), start(&case, true));
        let time = approach(&ended, &case);
        assert_eq!(approach(&held, &case), time);
        assert_eq!(ended.try_step(time, 0.01), DISCARD);
        held.step(time, 0.01);
        held.messages();
        assert_eq!(held.boolean_status(TERMINATED), Ok(false));
        assert_eq!(held.real_status(LAST_SUCCESSFUL_TIME), Ok(time + 0.01));
        for place in ["theta", "v", "u", "v_L", "v_R", "events.last_time", "events.liftoffs", "regime", "peak.theta"] {
            assert_eq!(held.get(place).to_bits(), ended.get(place).to_bits(), "{name}: {place}");
        }
        let frozen = still_bits(&held);
        let mut now = time + 0.01;
        for i in 0..20 {
            assert_eq!(held.get(flag), 1.0, "{name}");
            for still in RATES_AND_REACTIONS {
                assert_eq!(held.get(still), 0.0, "{name}: {still}");
            }
            held.set("a_gx", f64::from(i));
            held.set_rate("a_gz", 100.0);
            held.step(now, 0.3);
            now += 0.3;
            assert_eq!(still_bits(&held), frozen, "{name}");
        }
        assert_eq!(held.messages(), []);
    }
}

/// Returns the bits of all outputs except the heights above the supports.
fn still_bits(instance: &Instance) -> Vec<u64> {
    let outputs = FMU.description.outputs().filter(|output| !output.name.starts_with("uplift"));
    outputs.map(|output| instance.get(&output.name).to_bits()).collect()
}

/// The supports under a held block are held too: heights above them are constant, and their rates are zero.
#[test]
fn a_block_that_is_held_keeps_its_height_over_the_supports() {
    let case = case("sine_separates");
    let (ended, held) = (start(&case, false), start(&case, true));
    let time = approach(&held, &case);
    approach(&ended, &case);
    assert_eq!(ended.try_step(time, 0.01), DISCARD);
    held.step(time, 0.01);
    held.step(time + 0.01, 1.0);
    for name in ["uplift_L", "uplift_R"] {
        assert_eq!(held.get(name), ended.get(name), "{name}");
    }
}

/// The run of a block that begins in the air ends at its start.
#[test]
fn a_start_in_the_air() {
    for hold in [false, true] {
        let instance = Instance::new("block");
        instance.set("initial.settled", 0.0);
        instance.set("initial.v", 1.0);
        instance.set("on_separation", if hold { 2.0 } else { 1.0 });
        instance.initialize(None);
        assert_eq!([instance.get("separated"), instance.get("regime")], [1.0, 2.0]);
        if hold {
            instance.step(0.0, 1.0);
            assert_eq!(instance.get("v"), 1.0);
        } else {
            assert_eq!(instance.try_step(0.0, 1.0), DISCARD);
            assert_eq!(instance.real_status(LAST_SUCCESSFUL_TIME), Ok(0.0));
            assert_eq!(instance.boolean_status(TERMINATED), Ok(true));
        }
    }
}

/// With `Fly` the run continues after separation.
#[test]
fn a_separation_may_end_in_a_landing() {
    let case = case("sine_separates");
    let instance = Instance::new("block");
    prepare(&instance, &case);
    instance.set("on_separation", 3.0);
    instance.initialize(Some(1e-10));
    let (mut regimes, mut time) = (Vec::new(), 0.0);
    while time < case.t_final + 0.5 {
        instance.step(time, 0.001);
        time += 0.001;
        let regime = instance.get("regime");
        if regimes.last() != Some(&regime) {
            regimes.push(regime);
        }
        if regime == 2.0 {
            assert_eq!([instance.get("N_L"), instance.get("N_R"), instance.get("H")], [0.0; 3]);
        }
    }
    let flight = regimes.iter().position(|&regime| regime == 2.0).expect("a flight");
    assert!(regimes.len() >= flight + 2, "{regimes:?}");
    assert_eq!([instance.get("separated"), instance.get("overturned")], [0.0; 2]);
}

/// A master that can restore a state repeats the step with an end before that of the run.
#[test]
fn a_discarded_step_can_be_taken_back() {
    let case = case("sine_separates");
    let instance = start(&case, false);
    let time = approach(&instance, &case);
    let state = instance.save();
    assert_eq!(instance.try_step(time, 0.01), DISCARD);
    let ended = instance.real_status(LAST_SUCCESSFUL_TIME).unwrap();
    let final_theta = instance.get("theta");
    instance.restore(state);
    instance.free(state);
    let short = (ended - time) * 0.999;
    instance.step(time, short);
    assert_eq!(instance.get("separated"), 0.0);
    assert!(relative(instance.get("theta"), final_theta) < 1e-3);
    assert_eq!(instance.try_step(time + short, 0.01), DISCARD);
    assert!((instance.real_status(LAST_SUCCESSFUL_TIME).unwrap() - ended).abs() < 1e-9);
}

/// A toppling block leaves its supports before it lies on its side: it has separated and overturned.
#[test]
fn a_block_that_separates_on_its_way_over_has_overturned() {
    for (choice, ended) in [(1.0, DISCARD), (2.0, OK)] {
        let instance = Instance::new("block");
        let block = [("dimensionless.alpha", 0.2), ("dimensionless.p", 1.3), ("dimensionless.eta", 60.0)];
        let pulse = [("pulse.shape", 2.0), ("pulse.amplitude", 5.0), ("pulse.period", 1.2)];
        for (name, value) in block.into_iter().chain(pulse).chain([("on_separation", choice)]) {
            instance.set(name, value);
        }
        instance.initialize(None);
        assert_eq!([instance.get("separated"), instance.get("overturned")], [0.0; 2]);
        assert_eq!(instance.try_step(0.0, 10.0), ended);
        assert_eq!([instance.get("separated"), instance.get("overturned"), instance.get("regime")], [1.0, 1.0, 2.0]);
        let theta = instance.get("theta").abs();
        assert!((0.2..1.5).contains(&theta), "{theta}");
    }
}
