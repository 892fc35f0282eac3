//! The same motion turned, mirrored and scaled.

use rocking_block::excitation::Pulse;
use rocking_block::space::{
    Base, DirectedPulse, FootPlace, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceRun, SpaceSupports,
};

use crate::{advance, run, sine};

/// An uneven body on five feet.
fn parameters() -> SpaceParameters {
    let places = [[-1.0, -0.8], [1.1, -0.7], [0.1, 1.0], [0.9, 0.6], [-0.8, 0.7]];
    let feet = places.map(|[x, y]| FootPlace { x, y, gap: if x == 0.9 { 0.002 } else { 0.0 } });
    SpaceParameters {
        base: Base::List { feet: feet.to_vec(), center_height: 3.6 },
        supports: SpaceSupports::OfHeave { omega_v: 50.0, xi_v: 0.25 },
        kappa: 0.7,
        friction: 0.6,
        mass: 1.0,
        inertia: Some([4.8, 4.4, 1.3, 0.17, -0.28, 0.21]),
        ..SpaceParameters::default()
    }
}

fn pulses() -> [DirectedPulse; 3] {
    [sine(2.8, 5.0, 0.0, [1.0, 0.0, 0.0]), sine(2.4, 7.0, 0.1, [0.0, 1.0, 0.0]), sine(2.0, 20.0, 0.3, [0.0, 0.0, 1.0])]
}

/// Applies a linear map of x and y to feet, inertia and pulses.
fn mapped(map: [[f64; 2]; 2]) -> (SpaceParameters, [DirectedPulse; 3]) {
    let of = |[x, y]: [f64; 2]| map.map(|[a, b]| a * x + b * y);
    let mut parameters = parameters();
    if let Base::List { feet, .. } = &mut parameters.base {
        for foot in feet {
            [foot.x, foot.y] = of([foot.x, foot.y]);
        }
    }
    let [xx, yy, zz, xy, xz, yz] = parameters.inertia.unwrap();
    let rows = [of([xx, xy]), of([xy, yy])];
    let [column_x, column_y] = [of([rows[0][0], rows[1][0]]), of([rows[0][1], rows[1][1]])];
    let [xz, yz] = of([xz, yz]);
    parameters.inertia = Some([column_x[0], column_y[1], zz, column_y[0], xz, yz]);
    let pulses = pulses().map(|DirectedPulse { pulse, direction: [x, y, z] }| {
        let [x, y] = of([x, y]);
        DirectedPulse { pulse, direction: [x, y, z] }
    });
    (parameters, pulses)
}

fn end(parameters: &SpaceParameters, pulses: [DirectedPulse; 3], until: f64) -> (SpaceRun, usize) {
    let initial = SpaceInitial { vertical: None, ..crate::AT_REST };
    let mut run = run(SpaceBody::new(parameters).unwrap(), 1e-10, pulses, &initial);
    let events = advance(&mut run, until, &SpaceInputs::default());
    (run, events.len())
}

#[test]
fn a_mirrored_block_has_the_mirrored_bits() {
    let (original, events) = end(&parameters(), pulses(), 3.0);
    assert!(events > 10 && original.state().separated || original.peak_tilt() > 0.01, "{events} events");
    let (parameters, pulses) = mapped([[1.0, 0.0], [0.0, -1.0]]);
    let (mirrored, mirrored_events) = end(&parameters, pulses, 3.0);
    assert_eq!(events, mirrored_events);
    // Displacement, quaternion, velocity, angular velocity.
    let signs = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
    for (i, sign) in signs.into_iter().enumerate() {
        assert_eq!(mirrored.state().numbers[i], sign * original.state().numbers[i], "number {i}");
    }
    assert_eq!(original.state().counts, mirrored.state().counts);
    assert_eq!(original.peaks(), mirrored.peaks());
}

#[test]
fn a_block_turned_by_a_quarter_moves_alike() {
    let (original, events) = end(&parameters(), pulses(), 3.0);
    let (parameters, pulses) = mapped([[0.0, -1.0], [1.0, 0.0]]);
    let (turned, turned_events) = end(&parameters, pulses, 3.0);
    assert_eq!(events, turned_events);
    let [a, b] = [&original, &turned].map(|run| run.peaks().tilt_over_critical);
    assert!(a > 0.01 && (a - b).abs() < 1e-10, "{b}, not {a}");
    let [a, b] = [original, turned].map(|run| run.observe(&SpaceInputs::default()));
    let alpha = 0.25;
    for (found, expected) in [
        (b.attitude.tilt_x, -a.attitude.tilt_y),
        (b.attitude.tilt_y, a.attitude.tilt_x),
        (b.attitude.twist, a.attitude.twist),
        (b.displacement.x, -a.displacement.y),
        (b.displacement.y, a.displacement.x),
        (b.displacement.z, a.displacement.z),
    ] {
        assert!((found - expected).abs() < 1e-10 * alpha, "{found}, not {expected}");
    }
}

/// Lengths times 4, times doubled, mass times 16: the same bits.
#[test]
fn a_block_scaled_by_powers_of_two_has_the_same_bits() {
    let (original, events) = end(&parameters(), pulses(), 3.0);
    let mut scaled = parameters();
    if let Base::List { feet, center_height } = &mut scaled.base {
        *center_height *= 4.0;
        for foot in feet {
            *foot = FootPlace { x: 4.0 * foot.x, y: 4.0 * foot.y, gap: 4.0 * foot.gap };
        }
    }
    scaled.supports = SpaceSupports::OfHeave { omega_v: 25.0, xi_v: 0.25 };
    scaled.mass = 16.0;
    scaled.inertia = scaled.inertia.map(|inertia| inertia.map(|moment| 256.0 * moment));
    let slower = |DirectedPulse { pulse, direction }| {
        let pulse = Pulse { period: 2.0 * pulse.period, start: 2.0 * pulse.start, ..pulse };
        DirectedPulse { pulse, direction }
    };
    let (scaled, scaled_events) = end(&scaled, pulses().map(slower), 6.0);
    assert_eq!(events, scaled_events);
    let scales = [4.0, 4.0, 4.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 0.5, 0.5, 0.5, 64.0, 64.0, 64.0];
    for (i, scale) in scales.into_iter().enumerate() {
        let (found, expected) = (scaled.state().numbers[i], scale * original.state().numbers[i]);
        assert_eq!(found.to_bits(), expected.to_bits(), "number {i}: {found}, not {expected}");
    }
    assert_eq!(original.state().counts, scaled.state().counts);
    assert_eq!(original.peaks().tilt_over_critical, scaled.peaks().tilt_over_critical);
}
