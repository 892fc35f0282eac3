//! Random blocks under random pulses: no failed run, no number that is not finite, no foot that is pulled, balanced energy.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use proptest::prelude::*;
use rocking_block::space::motion::{QUATERNION, VELOCITY};
use rocking_block::space::{
    Base, BaseSize, DirectedPulse, SpaceBody, SpaceEventKind, SpaceInitial, SpaceInputs, SpaceParameters, SpaceSupports,
};

use crate::{cases, of_foot, run, sine};

pub fn bases() -> impl Strategy<Value = Base> {
    let size = (0.1..0.6, 1.0..4.0).prop_map(|(alpha, p)| BaseSize::Slenderness { alpha, p });
    prop_oneof![
        (size.clone(), 0.4..2.5).prop_map(|(size, depth_ratio)| Base::Rectangle { size, depth_ratio }),
        (size, 3..20_usize).prop_map(|(size, feet)| Base::Circle { size, feet }),
    ]
}

pub fn blocks() -> impl Strategy<Value = SpaceParameters> {
    let numbers = (10.0..150.0, 0.02..1.0, 0.3..4.0, 0.02..1.0);
    let friction = prop_oneof![Just(0.0), 0.05..1.0, Just(10.0)];
    (bases(), numbers, friction).prop_map(|(base, (eta, xi_v, kappa, xi_h), friction)| SpaceParameters {
        base,
        supports: SpaceSupports::OfRocking { eta, xi_v },
        kappa,
        xi_h: Some(xi_h),
        friction,
        mass: 3.0,
        ..SpaceParameters::default()
    })
}

pub fn pulses() -> impl Strategy<Value = [DirectedPulse; 3]> {
    let pulse = |most: f64| (0.0..most, 2.0..20.0, 0.0..0.5, 0.0..7.0);
    (pulse(8.0), pulse(8.0), pulse(14.0)).prop_map(|pulses| {
        let of = |(amplitude, omega, start, azimuth): (f64, f64, f64, f64), is_vertical: bool| {
            let direction = if is_vertical { [0.0, 0.0, 1.0] } else { [azimuth.cos(), azimuth.sin(), 0.0] };
            sine(amplitude, omega, start, direction)
        };
        [of(pulses.0, false), of(pulses.1, false), of(pulses.2, true)]
    })
}

pub fn beginnings() -> impl Strategy<Value = SpaceInitial> {
    let rates = [-0.5..0.5, -0.5..0.5, -2.0..2.0_f64];
    let flight = ([-0.3..0.3, -0.3..0.3], 0.1..0.5_f64, -1.0..4.0_f64, [-8.0..8.0, -8.0..8.0, -8.0..8.0_f64]);
    prop_oneof![
        Just(crate::AT_REST),
        flight.prop_map(|(tilt, height, rate, omega)| SpaceInitial {
            tilt,
            twist: 0.0,
            omega,
            vertical: Some([height, rate])
        }),
        ([-0.1..0.1, -0.1..0.1], -3.0..3.0, rates).prop_map(|(tilt, twist, omega)| SpaceInitial {
            tilt,
            twist,
            omega,
            vertical: None
        }),
    ]
}

/// The events of each foot in two seconds, in calls of equal length.
fn events_in(
    parts: u32,
    body: &SpaceBody,
    pulses: [DirectedPulse; 3],
    initial: &SpaceInitial,
) -> (Vec<Vec<(SpaceEventKind, f64)>>, f64) {
    let mut run = run(body.clone(), 1e-10, pulses, initial);
    let mut events = Vec::new();
    for part in 1..=parts {
        let until = 2.0 * f64::from(part) / f64::from(parts);
        run.advance(until, &SpaceInputs::default(), &mut |event| events.push(*event)).unwrap();
    }
    let tilt = run.observe(&SpaceInputs::default()).attitude.tilt;
    ((0..body.count()).map(|foot| of_foot(&events, foot)).collect(), tilt)
}

proptest! {
    #![proptest_config(cases::cases(40))]

    /// Whether a block stands, slides, rocks or tumbles in flight, the lengths of calls have no effect on its events.
    #[test]
    fn random_runs_have_the_same_events_in_calls_of_any_length(
        block in blocks(),
        pulses in pulses(),
        initial in beginnings(),
    ) {
        let body = SpaceBody::new(&block).unwrap();
        let (whole, tilt) = events_in(1, &body, pulses, &initial);
        let (parts, tilt_in_parts) = events_in(331, &body, pulses, &initial);
        let kinds = |events: &[Vec<(SpaceEventKind, f64)>]| -> Vec<Vec<SpaceEventKind>> {
            events.iter().map(|events| events.iter().map(|event| event.0).collect()).collect()
        };
        prop_assert_eq!(kinds(&whole), kinds(&parts), "{:?}, {:?}", whole, parts);
        prop_assert!((tilt - tilt_in_parts).abs() < 1e-6, "{tilt}, {tilt_in_parts}");
    }
}

/// The most steps and the greatest residual so far, which `--nocapture` shows.
static STEPS: AtomicU64 = AtomicU64::new(0);
static RESIDUAL: AtomicU64 = AtomicU64::new(0);

proptest! {
    #![proptest_config(cases::cases(200))]

    #[test]
    fn random_runs_hold(
        block in blocks(),
        pulses in pulses(),
        initial in beginnings(),
        tolerance in prop_oneof![Just(1e-8), Just(1e-10)],
    ) {
        let body = SpaceBody::new(&block).unwrap();
        let (weight, scale) = (body.mass * body.gravity, body.energy_scale());
        let mut run = run(body, tolerance, pulses, &initial);
        for part in 1..=30 {
            let result = run.advance(0.1 * f64::from(part), &SpaceInputs::default(), &mut |_| ());
            prop_assert!(result.is_ok(), "{result:?}");
            let seen = run.observe(&SpaceInputs::default());
            prop_assert!(run.state().numbers.iter().all(|number| number.is_finite()));
            for foot in &seen.feet {
                prop_assert!(foot.normal >= -1e-10 * weight, "a foot is pulled by {:e} M g", -foot.normal / weight);
                prop_assert!(foot.uplift >= -1e-12, "a lifted foot is {:e} m below its support", -foot.uplift);
            }
            let residual = run.energies().residual.abs() / scale;
            prop_assert!(residual < 10.0 * tolerance, "a residual of {residual:e} M g R0 at {tolerance:e}");
            let norm: f64 = run.state().numbers[QUATERNION..VELOCITY].iter().map(|x| x * x).sum();
            prop_assert!((norm - 1.0).abs() < 1e-15);
        }
        let (counts, residual) = (run.state().counts, run.energies().residual.abs() / scale);
        // The bits of positive numbers are in their order.
        if counts.steps > STEPS.fetch_max(counts.steps, Relaxed) || residual.to_bits() > RESIDUAL.fetch_max(residual.to_bits(), Relaxed) {
            println!("{} steps, a residual of {residual:e} M g R0 at {tolerance:e}", counts.steps);
        }
        prop_assert!(counts.steps < 20_000, "{counts:?}");
    }
}
