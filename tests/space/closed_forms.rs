//! Motions with a known solution: Euler's top, the tilt under a constant acceleration, small oscillations, sliding, Housner's pendulum.

use nalgebra::{Matrix2, Rotation3, Unit, Vector2, Vector3, Vector4};
use rocking_block::space::motion::{OMEGA, QUATERNION, Turn, VELOCITY};
use rocking_block::space::{
    Base, BaseSize, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceRun, SpaceSupports,
};

use crate::{AT_REST, STILL, advance, held, run, two_axis};

fn turn(run: &SpaceRun) -> Turn<f64> {
    Turn::of(&run.state().numbers)
}

fn omega(run: &SpaceRun) -> Vector3<f64> {
    Vector3::from_row_slice(&run.state().numbers[OMEGA..OMEGA + 3])
}

/// Angular momentum about the centre of mass.
fn momentum(run: &SpaceRun) -> Vector3<f64> {
    turn(run).rotate(&(run.body().inertia * turn(run).rotate_back(&omega(run))))
}

/// In flight the axis of a body of revolution goes round its angular momentum L at the rate L/I_x, and keeps its angle to it.
#[test]
fn a_top_in_flight_precesses() {
    let base = Base::Circle { size: BaseSize::Slenderness { alpha: 1.25, p: 3.0 }, feet: 8 };
    let body = SpaceBody::new(&SpaceParameters { base, ..SpaceParameters::default() }).unwrap();
    let initial = SpaceInitial { tilt: [0.2, 0.1], twist: 0.4, omega: [0.5, -1.0, 6.0], vertical: Some([40.0, 8.0]) };
    let mut run = run(body, 1e-11, STILL, &initial);
    let (axis, l) = (turn(&run).rotate(&Vector3::z()), momentum(&run));
    for i in 1..=12 {
        let t = 0.25 * f64::from(i);
        assert!(advance(&mut run, t, &SpaceInputs::default()).is_empty());
        let angle = l.norm() * t / run.body().inertia[(0, 0)];
        let expected = Rotation3::from_axis_angle(&Unit::new_normalize(l), angle) * axis;
        let found = turn(&run).rotate(&Vector3::z());
        assert!((found - expected).norm() < 1e-9, "{found} at {t}, not {expected}");
        assert!((momentum(&run) - l).norm() < 1e-9 * l.norm());
        let height = 40.0 + 8.0 * t - 0.5 * 9.81 * t * t;
        assert!((run.state().numbers[2] - height).abs() < 1e-9, "{} at {t}", run.state().numbers[2]);
    }
}

/// An uneven body that spins in flight keeps its angular momentum and its energy, and its quaternion a norm of 1 in 10^5 steps, or
/// `SPACE_STEPS` of them.
#[test]
fn a_spinning_body_keeps_momentum_energy_and_norm() {
    let base = Base::Circle { size: BaseSize::Slenderness { alpha: 1.25, p: 3.0 }, feet: 3 };
    let inertia = Some([0.17, 0.19, 0.3, 0.005, -0.01, 0.008]);
    let parameters = SpaceParameters { base, mass: 1.0, inertia, ..SpaceParameters::default() };
    let body = SpaceBody::new(&parameters).unwrap();
    let initial = SpaceInitial { omega: [0.3, 0.2, 4.0], vertical: Some([10.0, 1e6]), ..AT_REST };
    let mut run = run(body, 1e-10, STILL, &initial);
    let (l, start) = (momentum(&run), rotational_energy(&run));
    let steps = std::env::var("SPACE_STEPS").map_or(100_000, |steps| steps.parse().expect("a whole number"));
    while run.state().counts.steps < steps {
        let until = run.time() + 100.0;
        assert!(advance(&mut run, until, &SpaceInputs::default()).is_empty());
        let q = &run.state().numbers[QUATERNION..VELOCITY];
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((norm - 1.0).abs() < 4.0 * f64::EPSILON, "a norm of {norm:e}");
    }
    // Each step makes at most an error of the tolerance.
    let steps = run.state().counts.steps as f64;
    assert!((momentum(&run) - l).norm() < 1e-10 * steps * l.norm());
    assert!((rotational_energy(&run) - start).abs() < 1e-10 * steps * start);
}

fn rotational_energy(run: &SpaceRun) -> f64 {
    0.5 * momentum(run).dot(&omega(run))
}

/// Linear stiffness or damping of sway and rocking in the plane x–z, for the motions X and θ of the standing block.
fn sway_rocking(of_foot: [f64; 2], body: &SpaceBody, axis: usize) -> Matrix2<f64> {
    let (n, h) = (body.count() as f64, body.center_height);
    let squares: f64 = body.feet.iter().map(|foot| foot.place[axis] * foot.place[axis]).sum();
    let [vertical, horizontal] = of_foot;
    let sway = n * horizontal;
    Matrix2::new(sway, -sway * h, -sway * h, sway * h * h + vertical * squares)
}

/// Stiffness and damping with the weight's moment.
fn linear(body: &SpaceBody, axis: usize) -> [Matrix2<f64>; 2] {
    let mut stiffness = sway_rocking([body.stiffness, body.horizontal_stiffness], body, axis);
    stiffness[(1, 1)] -= body.mass * body.gravity * body.center_height;
    [stiffness, sway_rocking([body.damping, body.horizontal_damping], body, axis)]
}

#[test]
fn a_constant_acceleration_tilts_the_standing_block() {
    let (parameters, _) = two_axis(10.0);
    let body = SpaceBody::new(&SpaceParameters { kappa: 0.6, ..parameters }).unwrap();
    let a = 1e-4;
    let mut run = run(body.clone(), 1e-12, STILL, &AT_REST);
    advance(&mut run, 20.0, &held([a, 0.0, 0.0]));
    let [stiffness, _] = linear(&body, 0);
    let expected = stiffness.try_inverse().unwrap() * Vector2::new(-body.mass * a, 0.0);
    let seen = run.observe(&held([a, 0.0, 0.0]));
    let found = Vector2::new(seen.displacement.x, seen.attitude.tilt_x);
    assert!((found - expected).norm() < 1e-4 * expected.norm(), "{found}, not {expected}");
    assert_eq!((seen.touching(), seen.sliding()), (4, 0));
    assert!((seen.force.x - body.mass * a).abs() < 1e-5 * a, "{}", seen.force.x);
}

/// Steps `M ẍ + C ẋ + K x = 0` by the classical Runge–Kutta method.
fn damped(mass: Vector2<f64>, [k, c]: [Matrix2<f64>; 2], start: Vector4<f64>, duration: f64) -> Vector4<f64> {
    const STEPS: usize = 20_000;
    let rate = |x: Vector4<f64>| {
        let force = -(k * x.xy() + c * Vector2::new(x.z, x.w));
        Vector4::new(x.z, x.w, force.x / mass.x, force.y / mass.y)
    };
    let h = duration / STEPS as f64;
    (0..STEPS).fold(start, |x, _| {
        let a = rate(x);
        let b = rate(x + a * (0.5 * h));
        let c = rate(x + b * (0.5 * h));
        let d = rate(x + c * h);
        x + (a + (b + c) * 2.0 + d) * (h / 6.0)
    })
}

/// Heave, sway with rocking in both planes, and twist of the standing block.
#[test]
fn small_oscillations_are_those_of_the_stiffness_matrix() {
    let (parameters, _) = two_axis(10.0);
    let body =
        SpaceBody::new(&SpaceParameters { kappa: 0.8, xi_h: Some(0.1), eccentricity: [0.0; 2], ..parameters }).unwrap();
    const SMALL: f64 = 1e-6;
    let initial = SpaceInitial { omega: [-0.7 * SMALL, SMALL, 0.5 * SMALL], vertical: Some([0.0, SMALL]), ..AT_REST };
    let mut run = run(body.clone(), 1e-13, STILL, &initial);
    for t in [0.05, 0.11, 0.3] {
        assert!(advance(&mut run, t, &SpaceInputs::default()).is_empty());
        let seen = run.observe(&SpaceInputs::default());
        let close = |name: &str, found: f64, expected: f64, scale: f64| {
            assert!((found - expected).abs() < 1e-5 * scale, "{name} at {t}: {found:e}, not {expected:e}");
        };
        let inertia = body.inertia;
        for (axis, tilt, sign) in [(0, seen.attitude.tilt_x, 1.0), (1, seen.attitude.tilt_y, 0.7)] {
            let mass = Vector2::new(body.mass, inertia[(1 - axis, 1 - axis)]);
            let start = Vector4::new(0.0, 0.0, 0.0, sign * SMALL);
            let expected = damped(mass, linear(&body, axis), start, t);
            close("sway", seen.displacement[axis], expected.x, 0.1 * SMALL);
            close("rocking", tilt, expected.y, 0.1 * SMALL);
        }
        let oscillator = |mass: f64, k: f64, c: f64, rate: f64| {
            let (decay, square) = (0.5 * c / mass, k / mass);
            let omega = (square - decay * decay).sqrt();
            rate / omega * (-decay * t).exp() * (omega * t).sin()
        };
        let n = body.count() as f64;
        let heave = oscillator(body.mass, n * body.stiffness, n * body.damping, SMALL);
        close("heave", seen.displacement.z, heave, 0.02 * SMALL);
        let squares: f64 = body.feet.iter().map(|foot| foot.place.xy().norm_squared()).sum();
        let twist = oscillator(
            inertia[(2, 2)],
            squares * body.horizontal_stiffness,
            squares * body.horizontal_damping,
            0.5 * SMALL,
        );
        close("twist", seen.attitude.twist, twist, 0.01 * SMALL);
    }
}

fn low(friction: f64, feet: usize) -> SpaceBody {
    let base = Base::Circle { size: BaseSize::Slenderness { alpha: 1.25, p: 3.0 }, feet };
    let supports = SpaceSupports::OfRocking { eta: 30.0, xi_v: 0.4 };
    SpaceBody::new(&SpaceParameters { base, supports, friction, mass: 2.0, ..SpaceParameters::default() }).unwrap()
}

/// A low block slides steadily with the relative acceleration a − μ g.
#[test]
fn a_block_slides_steadily_under_more_than_friction_holds() {
    let body = low(0.25, 6);
    let mut run = run(body, 1e-11, STILL, &AT_REST);
    let a = held([0.3 * 9.81, 0.4 * 9.81, 0.0]);
    advance(&mut run, 3.0, &a);
    let seen = run.observe(&a);
    assert_eq!((seen.touching(), seen.sliding()), (6, 6));
    let expected = -0.25 * 9.81;
    for (axis, part) in [(0, 0.6), (1, 0.8)] {
        let expected = expected * part;
        assert!((seen.acceleration[axis] - expected).abs() < 1e-6, "{}, not {expected}", seen.acceleration[axis]);
    }
}

/// `I_z ω̇_z = −μ Σ N_i ρ_i` slows a twist, until it stops.
#[test]
fn friction_stops_a_twist() {
    let body = low(0.2, 12);
    let rate = 0.2 * body.mass * body.gravity * body.half_width / body.inertia[(2, 2)];
    let spin = 1.5 * rate;
    let initial = SpaceInitial { omega: [0.0, 0.0, spin], vertical: None, ..AT_REST };
    let mut run = run(body, 1e-11, STILL, &initial);
    advance(&mut run, 0.5, &SpaceInputs::default());
    let before = omega(&run).z;
    assert!((before - spin + 0.5 * rate).abs() < 1e-2 * rate, "{before}");
    advance(&mut run, 1.3, &SpaceInputs::default());
    let slowing = (before - omega(&run).z) / 0.8;
    // The springs, which follow the turning feet, incline the friction by a small angle.
    assert!((slowing - rate).abs() < 1e-4 * rate, "{slowing}, not {rate}");
    advance(&mut run, 6.0, &SpaceInputs::default());
    assert!(omega(&run).norm() < 1e-9, "{}", omega(&run));
    let seen = run.observe(&SpaceInputs::default());
    assert_eq!((seen.touching(), seen.sliding()), (12, 0));
}

/// Released over an edge or a corner, a block on stiff supports moves as Housner's pendulum. The difference falls with 1/η².
#[test]
fn a_block_on_stiff_supports_is_housners_pendulum() {
    for tilt in [[0.1, 0.0], [0.07, 0.07]] {
        let difference = |eta: f64| {
            let (mut parameters, _) = two_axis(10.0);
            let size = BaseSize::Slenderness { alpha: 0.25, p: 1.5 };
            parameters.base = Base::Rectangle { size, depth_ratio: 1.0 };
            parameters.supports = SpaceSupports::OfRocking { eta, xi_v: 0.2 };
            let body = SpaceBody::new(&parameters).unwrap();
            // About the edge or the corner, with the centre of mass over it at the angle `most`.
            let is_edge = tilt[1] == 0.0;
            let reach = if is_edge { body.half_width } else { body.half_width * 2.0_f64.sqrt() };
            let square = reach * reach + body.center_height * body.center_height;
            let (most, length) = ((reach / body.center_height).atan(), square.sqrt());
            let inertia = body.inertia[(0, 0)] + body.mass * square;
            let start = f64::hypot(tilt[0], tilt[1]);
            let mut run = run(body.clone(), 1e-10, STILL, &SpaceInitial { tilt, vertical: None, ..AT_REST });
            let until = 0.2;
            advance(&mut run, until, &SpaceInputs::default());
            // ω from the energy of the pendulum at the tilt that was reached.
            let reached = run.observe(&SpaceInputs::default()).attitude.tilt;
            let fallen = body.mass * body.gravity * length * ((most - start).cos() - (most - reached).cos());
            let expected = (2.0 * fallen.max(0.0) / inertia).sqrt();
            (omega(&run).norm() - expected).abs() / expected
        };
        let differences = [40.0, 80.0, 160.0, 320.0].map(difference);
        println!("{tilt:?}: {differences:?}");
        assert!(differences[3] < 2e-3, "{differences:?}");
        assert!(differences[3] < 0.1 * differences[1], "{differences:?}");
    }
}
