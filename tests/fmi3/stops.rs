//! Steps that stop at events have the bits of whole ones.

use crate::host::{Instance, Wanted};

/// A block that rocks under a pulse.
fn rocking(event_mode: bool, early_return: bool) -> Instance {
    let instance = Instance::new(Wanted { event_mode, early_return, ..Wanted::default() });
    instance.set_all(&[
        ("pulse.shape", 2.0),
        ("pulse.amplitude", 6.2622),
        ("pulse.period", 1.2566370614359172),
        ("on_separation", 3.0),
        ("epsilon", 0.3),
    ]);
    instance.initialize(event_mode);
    instance
}

#[test]
fn stopping_at_events_gives_the_bits_of_whole_steps() {
    let ends = || (0..80).map(|i| (f64::from(i) * 0.1, f64::from(i + 1) * 0.1));
    let whole = rocking(false, false);
    for (here, there) in ends() {
        assert!(!whole.step(here, there - here).early);
    }
    for event_mode in [false, true] {
        let stopped = rocking(event_mode, true);
        let events: Vec<f64> =
            ends().flat_map(|(here, there)| stopped.step_by_events(here, there, event_mode)).collect();
        assert_eq!(stopped.output_bits(), whole.output_bits(), "event mode {event_mode}");
        assert!(events.len() >= 2 && events.is_sorted(), "{events:?}");
        assert_eq!(events.last(), Some(&whole.get("events.last_time")));
    }
}

/// A master that ignores the event gets the same bits.
#[test]
fn an_unhandled_event_is_applied_in_the_next_step() {
    let [handled, forgotten] = [(), ()].map(|()| rocking(true, true));
    handled.step_by_events(0.0, 4.0, true);
    let mut here = 0.0;
    while here < 4.0 {
        here = forgotten.step(here, 4.0 - here).reached;
    }
    assert_eq!(handled.output_bits(), forgotten.output_bits());
}

/// Overturning and separation stop the step of a block that is held from then on, as other events do. A run that ends there tells their times.
#[test]
fn a_block_that_is_held_stops_the_step() {
    let [overturning, separation] = [[12.0, 2.5, 0.0], [1.0, 1.2, -0.02]].map(|[amplitude, period, v]| {
        [("pulse.shape", 2.0), ("pulse.amplitude", amplitude), ("pulse.period", period), ("initial.v", v)]
    });
    for (choice, excitation) in [("on_overturning", overturning), ("on_separation", separation)] {
        let run = |action: f64, event_mode: bool| {
            let instance = Instance::new(Wanted { event_mode, early_return: true, ..Wanted::default() });
            instance.set_all(&excitation);
            instance.set_all(&[("initial.settled", 0.0), ("on_separation", 3.0), (choice, action)]);
            instance.initialize(event_mode);
            instance
        };
        let held = run(2.0, true);
        let stops = held.step_by_events(0.0, 4.0, true);
        let ended = run(1.0, false);
        let mut last = 0.0;
        loop {
            let step = ended.step(last, 4.0 - last);
            last = step.reached;
            if step.terminates {
                break;
            }
        }
        assert!(0.0 < last && last < 4.0, "{choice}");
        assert_eq!(stops.last(), Some(&last), "{choice}: {stops:?}");
        assert_eq!((held.get("time"), held.get("theta_dot")), (4.0, 0.0), "{choice}");
    }
}
