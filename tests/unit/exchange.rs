//! The unit in Model Exchange: times of events, and outputs and derivatives of one instant.

use rocking_block::unit::fmu::Fmu;
use rocking_block::unit::instance::{Interface, Unit};
use rocking_block::unit::life_cycle::Phase;
use rocking_block::unit::variables::{Metadata, VARIABLES};

fn metadata(name: &str) -> &'static Metadata {
    VARIABLES.iter().find(|metadata| metadata.name == name).unwrap_or_else(|| panic!("no {name}"))
}

/// Returns a unit in Event Mode with these values.
fn unit(values: &[(&str, f64)]) -> Unit {
    let mut unit = Unit::new(Interface::ModelExchange);
    for &(name, value) in values {
        let metadata = metadata(name);
        unit.set(metadata.kind.base(), &[metadata.reference()], &[value], |value| value).unwrap();
    }
    unit.plan(None, 0.0, None).unwrap();
    unit.enter_initialization_mode();
    unit.exit_initialization_mode().unwrap();
    unit
}

fn get(unit: &mut Unit, name: &str) -> f64 {
    let metadata = metadata(name);
    unit.get(metadata.kind.base(), metadata.reference()).unwrap()
}

/// A kink of the excitation nearer than the clock of a solver resolves belongs to the present instant. CVODE refuses a stop 2 ulp ahead.
#[test]
fn a_time_event_within_round_off_is_present() {
    let (start, period) = (3.178704581404396, 0.5);
    let mut unit =
        unit(&[("pulse.shape", 2.0), ("pulse.amplitude", 4.0), ("pulse.period", period), ("pulse.start", start)]);
    let first = unit.pass_events(&mut |_| ()).unwrap().next_time;
    assert_eq!(first, Some(start));
    unit.set_phase(Phase::ContinuousTimeMode);
    for ulps in [1, 2, 8] {
        let mut unit = unit.clone();
        let time = (0..ulps).fold(start, |time, _| time.next_down());
        unit.set_time(time).unwrap();
        unit.enter_event_mode();
        let next = unit.pass_events(&mut |_| ()).unwrap().next_time.unwrap();
        assert!((next - start - period).abs() < 1e-12, "{ulps} ulp before {start} s: {next} s");
        // The pulse acts from now on.
        unit.set_phase(Phase::ContinuousTimeMode);
        unit.set_time(start + 0.1).unwrap();
        assert!(get(&mut unit, "H") > 1.0);
    }
    unit.set_time(start - 1e-9).unwrap();
    unit.enter_event_mode();
    assert_eq!(unit.pass_events(&mut |_| ()).unwrap().next_time, Some(start));
}

/// At a trial point of a solver beyond the limit of grip, or with a reaction below zero, outputs are those of the derivatives.
#[test]
fn outputs_at_trial_points_are_those_of_the_derivatives() {
    for values in [
        [("foundation", 2.0), ("friction", 0.2), ("pulse.shape", 2.0), ("pulse.amplitude", 2.2), ("pulse.period", 1.0)],
        [
            ("foundation", 1.0),
            ("friction", 0.2),
            ("pulse.shape", 2.0),
            ("pulse.amplitude", 12.0),
            ("pulse.period", 1.0),
        ],
        [("foundation", 2.0), ("friction", 0.0), ("pulse.shape", 2.0), ("pulse.amplitude", 6.0), ("pulse.period", 1.0)],
    ] {
        let mut unit = unit(&values);
        unit.pass_events(&mut |_| ()).unwrap();
        unit.set_phase(Phase::ContinuousTimeMode);
        let indicators = unit.indicators().unwrap();
        unit.set_time(0.25).unwrap();
        assert!(unit.indicators().unwrap().iter().any(|indicator| *indicator < 0.0), "{values:?}: {indicators:?}");
        let derivatives = unit.derivatives().unwrap();
        let outputs = ["theta_ddot", "v_ddot", "u_ddot"].map(|name| get(&mut unit, name));
        assert_eq!(outputs, [derivatives[1], derivatives[3], derivatives[5]], "{values:?}");
        assert_eq!(get(&mut unit, "slides"), 0.0, "{values:?}");
    }
}
