//! Rates of all outputs, compared with differences in time.

use rocking_block::excitation::Ramp;
use rocking_block::numerics::dual::Dual;
use rocking_block::space::outputs::{FootObservation, SpaceObservation};
use rocking_block::space::run::{SpaceRates, SpaceRun};
use rocking_block::space::{SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters};

use crate::{AT_REST, STILL, advance, run, two_axis};

/// Time between two samples (s).
const STEP: f64 = 5e-5;

/// Names, units of size and numbers of an observation.
fn numbers(body: &SpaceBody, seen: &SpaceObservation) -> Vec<(String, f64, f64)> {
    let (weight, g, length) = (body.mass * body.gravity, body.gravity, body.r0);
    let SpaceObservation { attitude, omega, displacement, velocity, acceleration, angular_acceleration, .. } = seen;
    let mut all = vec![
        ("tilt".to_string(), 1.0, attitude.tilt),
        ("tilt_x".into(), 1.0, attitude.tilt_x),
        ("tilt_y".into(), 1.0, attitude.tilt_y),
        ("twist".into(), 1.0, attitude.twist),
        ("drift_x".into(), length, seen.drift[0]),
        ("drift_y".into(), length, seen.drift[1]),
    ];
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let of_axis = [
            ("omega", 1.0, omega[i]),
            ("displacement", length, displacement[i]),
            ("velocity", length, velocity[i]),
            ("acceleration", g, acceleration[i]),
            ("angular acceleration", g / length, angular_acceleration[i]),
            ("force", weight, seen.force[i]),
            ("moment", weight * length, seen.moment[i]),
        ];
        all.extend(of_axis.map(|(name, size, number)| (format!("{name} {axis}"), size, number)));
    }
    for (i, &FootObservation { normal, horizontal, uplift, slip, friction_demand, .. }) in seen.feet.iter().enumerate()
    {
        let of_foot = [
            ("N", weight, normal),
            ("H_x", weight, horizontal[0]),
            ("H_y", weight, horizontal[1]),
            ("uplift", length, uplift),
            ("slip", length, slip),
            ("friction demand", 1.0, friction_demand),
        ];
        all.extend(of_foot.map(|(name, size, number)| (format!("{name} of foot {i}"), size, number)));
    }
    all
}

/// Names, units of size and numbers of energies and greatest values, or their rates.
fn sums(run: &SpaceRun, rates: Option<&SpaceRates>) -> Vec<(String, f64, f64)> {
    let body = run.body();
    let (weight, length) = (body.mass * body.gravity, body.r0);
    let energies = rates.map_or_else(|| run.energies(), |rates| rates.energies);
    let peaks = run.peaks();
    let peaks = match rates {
        Some(SpaceRates { peaks, .. }) => {
            [peaks.tilt, peaks.twist, peaks.drift, peaks.normal, peaks.uplift, peaks.slip]
        }
        None => [run.peak_tilt(), peaks.twist(), peaks.drift(), peaks.normal, peaks.uplift, peaks.slip],
    };
    let [tilt, twist, drift, normal, uplift, slip] = peaks;
    [
        ("kinetic energy", weight * length, energies.stored.kinetic),
        ("energy of the weight", weight * length, energies.stored.weight),
        ("energy of the supports", weight * length, energies.stored.supports),
        ("input", weight * length, energies.input),
        ("dashpots", weight * length, energies.dashpots),
        ("slip energy", weight * length, energies.slip),
        ("residual", weight * length, energies.residual),
        ("peak tilt", 1.0, tilt),
        ("peak twist", 1.0, twist),
        ("peak drift", length, drift),
        ("peak N", weight, normal),
        ("peak uplift", length, uplift),
        ("peak slip", length, slip),
    ]
    .map(|(name, size, number)| (name.to_string(), size, number))
    .into()
}

fn all(run: &SpaceRun, inputs: &SpaceInputs) -> Vec<(String, f64, f64)> {
    let mut all = numbers(run.body(), &run.observe(inputs));
    all.extend(sums(run, None));
    all
}

/// The inputs, which change with time.
fn ramps() -> SpaceInputs {
    let ramp = |value, rate| Ramp { value, rate };
    SpaceInputs {
        ground: [ramp(0.01, 0.05), ramp(-0.02, 0.03), ramp(0.03, -0.04)],
        moment: [ramp(0.02, -0.1), ramp(0.0, 0.05), ramp(0.1, -0.1)],
        ..SpaceInputs::default()
    }
}

/// Five points in time without an event among them, again and again: their difference is the rate at the middle one.
#[test]
fn rates_match_differences_in_time() {
    let inputs = ramps();
    let mut windows = 0;
    let mut grown = std::collections::BTreeSet::new();
    for friction in [10.0, 0.2, 0.0] {
        let (parameters, pulses) = two_axis(friction);
        let mut run = run(SpaceBody::new(&parameters).unwrap(), 1e-12, pulses, &AT_REST);
        for window in 1..60 {
            let start = 0.05 * f64::from(window);
            advance(&mut run, start, &inputs);
            if run.state().ending.is_some() {
                break;
            }
            let mut samples = vec![all(&run, &inputs)];
            let mut rates = None;
            let mut events = 0;
            for i in 1..5 {
                events += advance(&mut run, start + f64::from(i) * STEP, &inputs).len();
                samples.push(all(&run, &inputs));
                if i == 2 {
                    rates = Some(run.rates(&inputs));
                }
            }
            let rates = rates.unwrap();
            // Just before a lift-off the friction demand grows too fast for differences.
            events += advance(&mut run, start + 100.0 * STEP, &inputs).len();
            if events > 0 {
                continue;
            }
            windows += 1;
            let mut found = numbers(run.body(), &rates.observed.map(|x: Dual| x.eps));
            let demand = rates.observed.friction_demand();
            let of_greatest = |foot: &FootObservation<Dual>| foot.friction_demand == demand;
            assert!(demand.re == 0.0 || rates.observed.feet.iter().any(of_greatest), "{demand:?} at {start}");
            found.extend(sums(&run, Some(&rates)));
            for (k, (name, size, found)) in found.into_iter().enumerate() {
                let y = |i: usize| samples[i][k].2;
                let expected = (y(0) - 8.0 * y(1) + 8.0 * y(3) - y(4)) / (12.0 * STEP);
                if name.starts_with("peak") {
                    let grows = (0..4).filter(|&i| y(i + 1) > y(i)).count();
                    match grows {
                        0 => assert_eq!(found, 0.0, "{name} at {start}"),
                        4 => _ = grown.insert(name.clone()),
                        _ => continue,
                    }
                }
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-6 * (expected.abs() + size),
                    "μ = {friction}, t = {start}: rate of {name} is {found:e}, not {expected:e}"
                );
            }
        }
    }
    assert!(windows > 100, "{windows}");
    assert_eq!(grown.len(), 6, "{grown:?}");
}

/// Upright, without a trial force, and where the block is held: no quotient of zeros.
#[test]
fn rates_are_finite_at_rest() {
    for friction in [10.0, 0.0] {
        let (parameters, _) = two_axis(friction);
        let parameters = SpaceParameters { eccentricity: [0.0; 2], ..parameters };
        let run = run(SpaceBody::new(&parameters).unwrap(), 1e-8, STILL, &SpaceInitial { ..AT_REST });
        for inputs in [SpaceInputs::default(), ramps()] {
            let rates = run.rates(&inputs);
            let mut found = numbers(run.body(), &rates.observed.map(|x: Dual| x.eps));
            found.extend(sums(&run, Some(&rates)));
            for (name, _, rate) in found {
                assert!(rate.is_finite(), "μ = {friction}: rate of {name} is {rate}");
            }
        }
    }
}
