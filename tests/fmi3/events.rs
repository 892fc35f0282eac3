//! Event Mode and early return: events at their times, and the same bits as an uninterrupted run.

use crate::functions::OK;
use crate::host::{Instance, Stepped, Wanted, call};

/// A block that rocks under a pulse, and flies if it separates.
const ROCKING: [(&str, f64); 5] = [
    ("pulse.shape", 2.0),
    ("pulse.amplitude", 6.2622),
    ("pulse.period", 1.2566370614359172),
    ("on_separation", 3.0),
    ("epsilon", 0.3),
];

fn instance(event_mode: bool, early_return: bool, values: &[(&str, f64)]) -> Instance {
    let instance = Instance::new(Wanted { event_mode, early_return, ..Wanted::default() });
    instance.set_all(values);
    instance.initialize(event_mode);
    instance
}

fn rocking(event_mode: bool, early_return: bool, values: &[(&str, f64)]) -> Instance {
    instance(event_mode, early_return, &[&ROCKING, values].concat())
}

/// Steps of 0.1 s to 8 s.
fn ends() -> impl Iterator<Item = (f64, f64)> {
    (0..80).map(|i| (f64::from(i) * 0.1, f64::from(i + 1) * 0.1))
}

fn whole(instance: &Instance, ends: impl Iterator<Item = (f64, f64)>) {
    for (here, there) in ends {
        assert!(!instance.step(here, there - here).early);
    }
}

#[test]
fn stopping_at_events_or_not_gives_the_same_bits() {
    for values in [&[][..], &[("foundation", 2.0)], &[("foundation", 2.0), ("a_gz", -9.0)], &[("initial.theta", 0.1)]] {
        let reference = rocking(false, false, values);
        whole(&reference, ends());
        // With Event Mode but without early return, events are handled inside the step.
        let unbroken = rocking(true, false, values);
        whole(&unbroken, ends());
        assert_eq!(unbroken.output_bits(), reference.output_bits());
        let mut times = Vec::new();
        for event_mode in [false, true] {
            let stopped = rocking(event_mode, true, values);
            let events: Vec<f64> =
                ends().flat_map(|(here, there)| stopped.step_by_events(here, there, event_mode)).collect();
            assert_eq!(stopped.output_bits(), reference.output_bits(), "{values:?}, event mode {event_mode}");
            times.push(events);
        }
        assert_eq!(times[0], times[1]);
        assert!(times[0].len() >= 2, "{values:?}: {:?}", times[0]);
        assert_eq!(times[0].last(), Some(&reference.get("events.last_time")));
    }
}

/// The first lift-off of a rigid block under a ramp of ground acceleration occurs at a_gx = g tan(alpha).
#[test]
fn the_first_lift_off_matches_the_closed_form() {
    let block = instance(true, true, &[("foundation", 2.0)]);
    let lift = 9.81 * 0.25_f64.tan();
    block.set("a_gx", lift * (1.0 - 1e-12));
    assert_eq!(block.step(0.0, 0.25), Stepped { event: false, terminates: false, early: false, reached: 0.25 });
    drop(block);
    // A sine of amplitude 2 g tan(alpha) reaches it a twelfth of its period after its beginning.
    let pulse = [("foundation", 2.0), ("pulse.amplitude", 2.0 * lift), ("pulse.period", 1.2), ("pulse.start", 0.3)];
    let block = rocking(true, true, &pulse);
    let stepped = block.step(0.0, 1.0);
    assert!(stepped.event && stepped.early, "{stepped:?}");
    assert!((stepped.reached - 0.4).abs() < 1e-12, "{stepped:?}");
}

/// Outputs keep their values before the event until it is handled.
#[test]
fn an_impact_is_seen_from_both_sides() {
    let values = [("foundation", 2.0), ("initial.theta", 0.05)];
    let block = instance(true, true, &values);
    let stepped = block.step(0.0, 5.0);
    assert!(stepped.event && stepped.early && !stepped.terminates, "{stepped:?}");
    let (before, impacts) = (block.get("theta_dot"), block.get("events.impacts"));
    assert_eq!((impacts, block.get("time"), block.get("regime")), (0.0, stepped.reached, 1.0));
    assert!(block.get("theta").abs() < 1e-12);
    assert_eq!(call!(block, enter_event_mode), OK);
    assert_eq!(block.get("theta_dot"), before);
    block.handle_event();
    let after = block.get("theta_dot");
    assert_eq!(
        (block.get("events.impacts"), block.get("events.last_time"), block.get("regime")),
        (1.0, stepped.reached, -1.0)
    );
    // Housner's restitution.
    assert!((after / before - block.get("derived.e")).abs() < 1e-12, "{after} after {before}");
}

#[test]
fn the_step_reports_the_end_of_the_run() {
    // Complete separation: epsilon = 0.4 throws the block off its supports.
    let values = [("on_separation", 1.0), ("epsilon", 0.4), ("dimensionless.eta", 60.0)];
    for (event_mode, early_return) in [(false, false), (false, true), (true, true)] {
        let block = rocking(event_mode, early_return, &values);
        let mut here = 0.0;
        let stepped = loop {
            let stepped = block.step(here, 10.0 - here);
            here = stepped.reached;
            if stepped.event {
                assert_eq!(call!(block, enter_event_mode), OK);
                block.handle_event();
            }
            if stepped.terminates {
                break stepped;
            }
            assert!(here < 10.0);
        };
        let expected = Stepped { event: false, terminates: true, early: early_return, reached: here };
        assert_eq!(stepped, expected);
        assert_eq!((block.get("separated"), block.get("events.last_time"), block.get("regime")), (1.0, here, 2.0));
        let bits = block.output_bits();
        // Time stops after that.
        assert_eq!(block.step(here, 1.0), expected);
        assert_eq!(block.output_bits(), bits);
        assert_eq!(call!(block, terminate), OK);
        assert_eq!(block.output_bits(), bits);
    }
}

#[test]
fn overturning_ends_the_run_or_is_an_event_of_a_held_block() {
    let falling = [("initial.theta", 0.3), ("initial.theta_dot", 0.1)];
    let ended = instance(true, true, &falling);
    let at = ended.step(0.0, 20.0);
    assert!(at.terminates && at.early && !at.event, "{at:?}");
    assert_eq!(ended.get("overturned"), 1.0);
    let held = instance(true, true, &[&falling[..], &[("on_overturning", 2.0), ("on_separation", 2.0)]].concat());
    assert_eq!(held.step(0.0, 20.0), Stepped { event: true, terminates: false, early: true, reached: at.reached });
    assert_eq!(held.get("overturned"), 0.0);
    assert!(held.get("theta_dot") > 0.1);
    assert_eq!(call!(held, enter_event_mode), OK);
    held.handle_event();
    assert_eq!((held.get("overturned"), held.get("theta_dot")), (1.0, 0.0));
    assert_eq!(held.get("theta"), ended.get("theta"));
    assert!(!held.step(at.reached, 20.0 - at.reached).early);
}

/// The rest of a step ends exactly at the step's planned end, although the master's rounding differs by an ulp.
#[test]
fn the_rest_of_a_step_ends_where_the_step_would_have() {
    let reference = rocking(false, false, &[]);
    whole(&reference, [(0.0, 4.0)].into_iter());
    let rounded = rocking(false, true, &[]);
    let first = rounded.step(0.0, 4.0);
    assert!(first.early);
    let mut here = first.reached;
    while here < 4.0 {
        here = rounded.step(here, (4.0 - here) * (1.0 + 1e-13)).reached;
    }
    assert_eq!(here, 4.0);
    assert_eq!(rounded.output_bits(), reference.output_bits());
}
