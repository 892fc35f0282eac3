//! The tilt over the critical one in the direction of the lean: closed forms, rates, a fine sampling of runs.

use proptest::prelude::*;
use rocking_block::numerics::dual::Dual;
use rocking_block::space::motion::Turn;
use rocking_block::space::{
    Base, BaseSize, FootPlace, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceSupports,
};

use crate::random::{beginnings, blocks, pulses};
use crate::{STILL, cases, run};

const B: f64 = 0.4;
const H: f64 = 1.3;

fn on(base: Base) -> SpaceBody {
    let supports = SpaceSupports::OfHeave { omega_v: 60.0, xi_v: 0.2 };
    let inertia = matches!(base, Base::List { .. }).then_some([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    SpaceBody::new(&SpaceParameters { base, supports, inertia, mass: 1.0, ..SpaceParameters::default() }).unwrap()
}

fn rectangle(depth_ratio: f64) -> SpaceBody {
    on(Base::Rectangle { size: BaseSize::Lengths { width: 2.0 * B, center_height: H }, depth_ratio })
}

/// Returns the peak of a block that begins with this tilt in a direction of its own, after a twist.
fn peak(body: &SpaceBody, tilt: f64, direction: f64, twist: f64) -> f64 {
    let azimuth = direction + twist;
    let initial = SpaceInitial { tilt: [tilt * azimuth.cos(), tilt * azimuth.sin()], twist, ..SpaceInitial::default() };
    let run = run(body.clone(), 1e-8, STILL, &initial);
    let seen = run.observe(&SpaceInputs::default()).tilt_over_critical(body);
    assert_eq!(run.peaks().tilt_over_critical, seen);
    seen
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-13 * expected, "{found}, not {expected}");
}

/// The centre of mass stands over the edge or the corner at the distance to it: b and √2 b of a square, up to √5 b of a base of 1 to 2.
#[test]
fn critical_tilts_are_those_over_edges_and_corners() {
    let (tilt, eighth) = (0.07, std::f64::consts::FRAC_PI_4);
    for twist in [0.0, 0.8, -2.5] {
        for quarter in [0.0, 2.0, 4.0, 6.0] {
            let of = |body: &SpaceBody, direction: f64| peak(body, tilt, direction + quarter * eighth, twist);
            close(of(&rectangle(1.0), 0.0), tilt / (B / H).atan());
            close(of(&rectangle(1.0), eighth), tilt / (B * 2_f64.sqrt() / H).atan());
        }
        let oblong = rectangle(2.0);
        for (direction, distance) in [
            (0.0, B),
            (eighth, B * 2_f64.sqrt()),
            (2_f64.atan(), B * 5_f64.sqrt()),
            (-2_f64.atan(), B * 5_f64.sqrt()),
            (2.0 * eighth, 2.0 * B),
            (6.0 * eighth, 2.0 * B),
        ] {
            close(peak(&oblong, tilt, direction, twist), tilt / (distance / H).atan());
        }
    }
}

/// Towards a foot of a circle the distance is its radius, between two of them that of the chord.
#[test]
fn critical_tilts_of_a_circle_are_those_of_its_polygon() {
    for feet in [3, 5, 8, 64] {
        let body = on(Base::Circle { size: BaseSize::Lengths { width: 2.0 * B, center_height: H }, feet });
        assert_eq!(body.edges.len(), feet);
        let half = std::f64::consts::PI / feet as f64;
        for i in 0..4 * feet {
            let direction = 0.5 * half * i as f64;
            let from_chord = (direction + half).rem_euclid(2.0 * half) - half;
            let distance = B * half.cos() / (half - from_chord.abs()).cos();
            close(peak(&body, 0.05, direction, 0.3), 0.05 / (distance / H).atan());
        }
    }
}

/// Feet with a gap, and feet on and within the edges, do not change the base.
#[test]
fn the_base_is_the_hull_of_feet_without_gaps() {
    let foot = |x: f64, y: f64, gap: f64| FootPlace { x, y, gap };
    let mut feet: Vec<FootPlace> =
        (0..25).map(|i| foot(B * (0.5 * f64::from(i % 5) - 1.0), B * (0.5 * f64::from(i / 5) - 1.0), 0.0)).collect();
    feet.extend([foot(2.0, 0.0, 0.001), foot(B, B, 0.0)]);
    let body = on(Base::List { feet, center_height: H });
    assert_eq!(body.edges.len(), 4 + 2, "the corner with two feet has each of its edges twice");
    for direction in [0.0, 0.3, 0.8, 2.1, 4.0] {
        close(peak(&body, 0.07, direction, 0.0), peak(&rectangle(1.0), 0.07, direction, 0.0));
    }
}

/// A centre of mass over an edge has a least critical tilt, and an upright block no tilt over it.
#[test]
fn a_centre_of_mass_over_an_edge_has_numbers() {
    let foot = |x: f64, y: f64| FootPlace { x, y, gap: 0.0 };
    let body = on(Base::List { feet: vec![foot(-1e-15, -1.0), foot(-1e-15, 1.0), foot(1.0, 0.0)], center_height: H });
    assert!(body.edge_distance > 0.0 && body.edge_distance < 1e-14, "{}", body.edge_distance);
    for tilt in [0.0, f64::MIN_POSITIVE, 1e-300, 1e-9, 0.1] {
        for direction in [0.0, 0.5, 3.0, std::f64::consts::PI] {
            let found = peak(&body, tilt, direction, 0.0);
            assert!(found.is_finite() && found >= 0.0 && (found == 0.0) == (tilt == 0.0), "{found} at {tilt}");
        }
    }
}

/// Returns the tilt over the critical one from a quaternion: the farthest point of the lean on a line between two feet without gaps.
fn expected(body: &SpaceBody, quaternion: [f64; 4]) -> f64 {
    let turn = Turn::of_quaternion(quaternion);
    let up = turn.rotate_back(&nalgebra::Vector3::z());
    let tilt = up.x.hypot(up.y).atan2(up.z);
    if tilt == 0.0 {
        return 0.0;
    }
    let [x, y] = [-up.x, -up.y].map(|number| number / up.x.hypot(up.y));
    let feet: Vec<_> = body.feet.iter().filter(|foot| foot.static_load > 0.0).map(|foot| foot.place).collect();
    let mut farthest = 0.0_f64;
    for a in &feet {
        for b in &feet {
            // Where a + s (b − a) is across the lean.
            let [of_a, of_b] = [a, b].map(|foot| x * foot.y - y * foot.x);
            let s = of_a / (of_a - of_b);
            if (0.0..=1.0).contains(&s) {
                let [along_a, along_b] = [a, b].map(|foot| x * foot.x + y * foot.y);
                farthest = farthest.max(along_a + s * (along_b - along_a));
            }
        }
    }
    tilt / (farthest / body.center_height).atan()
}

proptest! {
    #![proptest_config(cases::cases(100))]

    #[test]
    fn rates_match_differences(
        block in blocks(),
        turn in [-0.6..0.6_f64, -0.6..0.6, -2.0..2.0],
        rates in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        let body = SpaceBody::new(&block).unwrap();
        let quaternion = [1.0, turn[0], turn[1], turn[2]];
        let at = |time: f64| {
            let q: [f64; 4] = std::array::from_fn(|i| quaternion[i] + time * rates[i]);
            let lean = Turn::of_quaternion(std::array::from_fn(|i| Dual::new(q[i], rates[i]))).lean();
            (body.tilt_over_critical(&lean), expected(&body, q))
        };
        let step = 1e-5;
        let ((before, _), (now, plain), (after, _)) = (at(-step), at(0.0), at(step));
        prop_assert!((now.re - plain).abs() < 1e-12 * plain, "{} {plain}", now.re);
        let difference = (after.re - before.re) / (2.0 * step);
        // Between two edges the rate changes.
        let bend = (before.eps - now.eps).abs() + (after.eps - now.eps).abs();
        prop_assert!((now.eps - difference).abs() <= bend + 1e-6, "{}, not {difference}", now.eps);
    }
}

proptest! {
    #![proptest_config(cases::cases(60))]

    /// The peak of a run in one call is the greatest of another one's fine samples, which may miss it by their curvature.
    #[test]
    fn peaks_are_those_of_a_fine_sampling(block in blocks(), pulses in pulses(), initial in beginnings()) {
        const SAMPLES: u32 = 4000;
        let body = SpaceBody::new(&block).unwrap();
        let [mut whole, mut parts] = [(); 2].map(|()| run(body.clone(), 1e-11, pulses, &initial));
        whole.advance(2.0, &SpaceInputs::default(), &mut |_| ()).unwrap();
        let mut samples = Vec::new();
        for part in 0..=SAMPLES {
            parts.advance(2.0 * f64::from(part) / f64::from(SAMPLES), &SpaceInputs::default(), &mut |_| ()).unwrap();
            samples.push(expected(&body, parts.observe(&SpaceInputs::default()).quaternion));
        }
        let greatest = samples.iter().copied().fold(0.0, f64::max);
        let curvature = samples.windows(3).map(|x| (x[0] - 2.0 * x[1] + x[2]).abs()).fold(0.0, f64::max);
        // Round-off grows in a body that bounces, so that its runs in steps of other lengths differ.
        let apart = (whole.peak_tilt() - parts.peak_tilt()).abs() / body.edge_angle;
        for (run, apart) in [(&whole, apart), (&parts, 0.0)] {
            let peak = run.peaks().tilt_over_critical;
            let slack = 1e-7 * (1.0 + greatest) + 2.0 * apart;
            prop_assert!(peak >= greatest - slack, "{peak} is below {greatest}");
            prop_assert!(peak <= greatest + curvature + slack, "{peak} is above {greatest} with {curvature:e}");
            prop_assert!(peak <= run.peak_tilt() / body.edge_angle + 1e-12 * (1.0 + peak), "{peak}");
        }
    }
}
