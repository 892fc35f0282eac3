//! Roots and maxima of functions that are known.

use super::*;

/// The first fall, piece by piece.
fn first_fall(start: Dual, end: Dual, rounding: f64, duration: f64, mut f: impl FnMut(f64) -> Dual) -> Option<f64> {
    super::first_fall(start, end, rounding, duration, PIECES, false, &mut f)
}

/// Where the ends bound longer intervals, the same falls are found with fewer evaluations.
#[test]
fn bounded_functions_are_searched_where_they_may_fall() {
    for at in [0.1, 0.4, 0.77] {
        let cubic = |t: f64| {
            let [a, b, c] = [t - at, t - 1.3, t + 0.4];
            Dual::new(a * b * c, a * b + a * c + b * c)
        };
        let mut calls = [0; 2];
        let [every, bounded] = [false, true].map(|bounded| {
            let function = |t: f64| {
                calls[usize::from(bounded)] += 1;
                cubic(t)
            };
            super::first_fall(cubic(0.0), cubic(1.0), 1e-15, 1.0, PIECES, bounded, &mut { function }).unwrap()
        });
        assert!((every - at).abs() < 4e-15 && (bounded - at).abs() < 4e-15, "{every}, {bounded}, {at}");
        assert!(calls[1] <= 10, "{at}: {calls:?} evaluations");
    }
}

#[test]
fn finds_a_simple_root_in_a_few_evaluations() {
    let mut calls = 0;
    let root = sign_change(0.0, 2.0, 1.0, libm::cos(2.0), |t| {
        calls += 1;
        libm::cos(t)
    });
    assert!((root - std::f64::consts::FRAC_PI_2).abs() <= 4.0 * f64::EPSILON, "{root}");
    // Bisection needs 51 for a bracket of that width.
    assert!(calls <= 51 / 3, "{calls} evaluations");
}

#[test]
fn never_needs_more_than_bisection_and_one() {
    let mut calls = 0;
    let root = sign_change(0.0, 1.0, 1.0, -1e-300, |t| {
        calls += 1;
        if t < 0.987 { 1.0 } else { -1e-300 }
    });
    assert!((root - 0.987).abs() <= 4.0 * f64::EPSILON, "{root}");
    assert!(calls <= 56, "{calls} evaluations");
}

/// A dip between two positive ends: a gap that closes and opens within one step.
#[test]
fn sees_a_dip_between_positive_ends() {
    let dip = |t: f64| Dual::new((t - 0.43) * (t - 0.47), 2.0 * t - 0.9);
    let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
    assert!((root - 0.43).abs() < 1e-14, "{root}");
    let shallow = |t: f64| Dual::new((t - 0.45) * (t - 0.45) + 1e-9, 2.0 * t - 0.9);
    assert_eq!(first_fall(shallow(0.0), shallow(1.0), 1e-15, 1.0, shallow), None);
}

/// A function that leaves a double zero and returns later. Round-off made its start negative.
#[test]
fn the_zero_at_which_it_starts_is_no_root() {
    let opening = |t: f64| Dual::new(t * t * (0.7 - t) - 1e-18, 1.4 * t - 3.0 * t * t);
    let root = first_fall(opening(0.0), opening(1.0), 1e-15, 1.0, opening).unwrap();
    assert!((root - 0.7).abs() < 1e-14, "{root}");
}

/// A hop from zero that is over long before the first sample.
#[test]
fn sees_the_end_of_a_short_hop() {
    let hop = |t: f64| Dual::new(t * (1e-5 - t), 1e-5 - 2.0 * t);
    let root = first_fall(hop(0.0), hop(1.0), 1e-15, 1.0, hop).unwrap();
    assert!((root - 1e-5).abs() < 1e-18, "{root}");
    let falling = |t: f64| Dual::new(-t, -1.0);
    assert!(first_fall(falling(0.0), falling(1.0), 1e-15, 1.0, falling).unwrap() < 1e-12);
}

#[test]
fn the_greatest_value_is_inside() {
    let hump = |t: f64| Dual::new(libm::sin(3.0 * t), 3.0 * libm::cos(3.0 * t));
    let top = greatest(0.0, hump(0.0), hump(1.0), 1.0, &mut { hump });
    assert!((top - 1.0).abs() < 1e-15, "{top}");
}

/// A hump between two ends at which the function rises, or falls.
#[test]
fn sees_a_hump_where_the_curvature_turns() {
    for (sign, roots) in [(1.0, [0.1, 0.2, 1.0]), (-1.0, [0.05, 0.1, 1.2])] {
        let hump = |t: f64| {
            let [a, b, c] = roots.map(|root| t - root);
            Dual::new(sign * a * b * c, sign * (b * c + a * c + a * b))
        };
        let (start, end) = (hump(0.0), hump(1.0));
        assert!(start.eps * sign > 0.0 && end.eps * sign > 0.0);
        let greatest_of = |most: f64| greatest(most, start, end, 1.0, &mut { hump });
        let sampled = (0..=100_000).map(|k| hump(1e-5 * f64::from(k)).re).fold(f64::NEG_INFINITY, f64::max);
        assert!(sampled > start.re.max(end.re) + 1e-3);
        let found = greatest_of(f64::NEG_INFINITY);
        assert!(found >= sampled && found < sampled + 1e-9, "{found}, {sampled}");
        assert_eq!(greatest_of(sampled + 1.0), sampled + 1.0);
    }
}

/// End tangents of a parabola meet twice as high above the chord as its top.
#[test]
fn the_bound_is_where_the_tangents_meet() {
    let hump = |t: f64| Dual::new(t * (4.0 - t), 4.0 - 2.0 * t);
    for (from, to, height) in [(0.0, 4.0, 8.0), (1.0, 4.0, 6.0), (2.5, 4.0, 3.75), (0.0, 1.0, 3.0)] {
        let (start, end, duration) = (hump(from), hump(to), to - from);
        let turns = end.eps < 0.0 && start.eps > 0.0;
        let rises = |most: f64| may_rise_inside(most, start, end, duration);
        assert_eq!((rises(height - 1e-9), rises(height)), (turns, false), "{from} {to}");
        let [start, end] = [-start, -end];
        assert_eq!(may_be_below(1e-9 - height, start, end, duration), turns || height <= -end.re, "{from} {to}");
        assert!(!may_be_below(-height, start, end, duration));
    }
}

/// A function below zero at the beginning has fallen already, even if it rises again.
#[test]
fn what_has_fallen_before_falls_at_once() {
    let rising = |t: f64| Dual::new(t - 0.1, 1.0);
    assert_eq!(first_fall(rising(0.0), rising(1.0), 1e-15, 1.0, rising), Some(0.0));
    assert!(may_fall(rising(0.0), Dual::default(), 1e-15, 1.0));
}

/// A function that falls at both ends may dip below zero if its curvature turns.
#[test]
fn sees_a_dip_between_falling_ends() {
    for gap in [0.05, 1e-3] {
        let dip = |t: f64| {
            let [a, b, c] = [t - 0.3, t - 0.3 - gap, t - 1.2];
            Dual::new(-a * b * c, -(b * c + a * c + a * b))
        };
        let (start, end) = (dip(0.0), dip(1.0));
        assert!(start.re > 0.0 && end.re > 0.0 && start.eps < 0.0 && end.eps < 0.0);
        assert!(may_fall(start, end, 1e-15, 1.0));
        let root = first_fall(start, end, 1e-15, 1.0, dip).unwrap();
        assert!((root - 0.3).abs() < 1e-13, "{root}");
    }
}

/// No value of a cubic is below the bounds, wherever its curvature changes sign.
#[test]
fn no_cubic_dips_unseen() {
    for i in 0..1000 {
        let [a, b, c, d] = [0.123, 0.457, 0.811, 0.239].map(|by: f64| 4.0 * (f64::from(i) * by).fract() - 2.0);
        let cubic = |t: f64| Dual::new(a + t * (b + t * (c + t * d)), b + t * (2.0 * c + 3.0 * t * d));
        let least = (0..=300).map(|k| cubic(0.005 * f64::from(k)).re).fold(f64::INFINITY, f64::min);
        let found = may_be_below(least + 1e-14, cubic(0.0), cubic(1.5), 1.5);
        assert!(found || cubic(0.0).re <= least, "{a} {b} {c} {d}: {least}");
    }
}

/// A fall from zero counts even if the function soon returns. Falls within round-off or from above zero do not.
#[test]
fn a_fall_from_zero_differs_from_a_rise() {
    let falls = |at: f64, rounding: f64| {
        let function = |t: f64| Dual::new(at + t * (t - 1e-4), 2.0 * t - 1e-4);
        leaves_downwards(function(0.0), rounding, 1.0, &mut { function })
    };
    assert!(falls(0.0, 1e-15) && falls(-1e-15, 1e-15) && falls(1e-15, 1e-15));
    assert!(!falls(0.0, 1e-8) && !falls(2e-15, 1e-15));
    let rising = |rate: f64| leaves_downwards(Dual::new(0.0, rate), 1e-15, 1.0, &mut |t| Dual::new(t * t, rate));
    assert!(!rising(0.0) && !rising(1e-4) && !rising(-1e-18) && !rising(f64::NAN));
}

/// A hop from zero, and a dip after it, both over before the first sample.
#[test]
fn sees_a_dip_behind_a_short_hop() {
    let dip = |t: f64| {
        let [a, b] = [t - 0.02, t - 0.07];
        Dual::new(t * a * b, a * b + t * (a + b))
    };
    let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
    assert!((root - 0.02).abs() < 1e-14, "{root}");
    // With a rate of zero at the beginning, the errors of a step can turn a rise into such a dip.
    let rise = |t: f64| {
        let Dual { re: value, eps: rate } = dip(t);
        Dual::new(t * value, t * rate + value)
    };
    assert_eq!(first_fall(rise(0.0), rise(1.0), 1e-15, 1.0, rise), None);
}

/// The first of two falls is found, and a dip in a long interval.
#[test]
fn finds_the_first_of_several_falls() {
    let wave = |t: f64| Dual::new(0.5 + libm::cos(2.0 * t), -2.0 * libm::sin(2.0 * t));
    let end = std::f64::consts::TAU;
    let root = first_fall(wave(0.0), wave(end), 1e-15, end, wave).unwrap();
    assert!((root - std::f64::consts::FRAC_PI_3).abs() < 1e-14, "{root}");
    let dip = |t: f64| Dual::new((t - 14.5) * (t - 15.5), 2.0 * t - 30.0);
    let root = first_fall(dip(0.0), dip(16.0), 1e-15, 16.0, dip).unwrap();
    assert!((root - 14.5).abs() < 1e-13, "{root}");
}

/// A function that begins at zero is watched for dips once it has left zero.
#[test]
fn sees_a_dip_after_it_has_left_zero() {
    let dip = |t: f64| Dual::new(t * (t - 0.43) * (t - 0.47), (t - 0.43) * (t - 0.47) + t * (2.0 * t - 0.9));
    let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
    assert!((root - 0.43).abs() < 1e-13, "{root}");
}

/// The rate leads to the bottom of a dip, however narrow. So it does after a function has left zero without a rate.
#[test]
fn sees_a_narrow_dip() {
    for (power, at) in [(0, 0.43), (2, 0.43), (0, 0.9), (2, 0.9)] {
        let dip = |t: f64| {
            let [a, b] = [t - at, t - at - 1e-5];
            let factor = t.powi(power);
            let slope = if power == 0 { 0.0 } else { 2.0 * t };
            Dual::new(factor * a * b, slope * a * b + factor * (a + b))
        };
        let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
        assert!((root - at).abs() < 1e-11, "{power}, {at}: {root}");
    }
}

/// A constant within round-off of zero is no fall.
#[test]
fn what_stays_at_zero_does_not_fall() {
    let still = |_: f64| Dual::new(-0.5e-15, 0.0);
    assert_eq!(first_fall(still(0.0), still(1.0), 1e-15, 1.0, still), None);
    assert!(!may_fall(still(0.0), still(1.0), 1e-15, 1.0));
    // One that leaves zero may come back.
    for end in [-0.5, 0.5] {
        assert!(may_fall(still(0.0), Dual::new(end, end), 1e-15, 1.0));
    }
}

#[test]
fn a_short_hump_is_as_exact_as_a_long_one() {
    let hump = |t: f64| Dual::new(libm::sin(3e4 * t), 3e4 * libm::cos(3e4 * t));
    let top = greatest(0.0, hump(0.0), hump(1e-4), 1e-4, &mut { hump });
    assert!((top - 1.0).abs() < 1e-15, "{top}");
}

#[test]
fn the_side_of_a_jump_is_that_nearer_to_zero() {
    for (before, after) in [(1e-9, -1.0), (1.0, -1e-9)] {
        let root = sign_change(0.0, 1.0, before, after, |t| if t < 0.3 { before } else { after });
        assert_eq!(root < 0.3, before < 0.5, "{root}");
    }
}
