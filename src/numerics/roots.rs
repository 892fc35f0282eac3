//! A function of time with its rate, and its values at both ends of a step → the first time at which it falls through
//! zero, and the greatest value in between.

/// Value of a function and its rate of change at one time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sample<R = f64> {
    /// Value.
    pub value: R,
    /// Its derivative with respect to time.
    pub rate: R,
}

impl<R: Default> Default for Sample<R> {
    #[inline(always)]
    fn default() -> Sample<R> {
        Sample { value: R::default(), rate: R::default() }
    }
}

impl<R: std::ops::Neg<Output = R>> Sample<R> {
    /// The sample of the function with the other sign.
    #[inline(always)]
    pub fn negated(self) -> Sample<R> {
        Sample { value: -self.value, rate: -self.rate }
    }
}

/// Pieces into which a step is cut where a root may hide. The step control keeps a step below a third of
/// the shortest period of the motion, so that a piece is below 1/24 of it and a cubic follows it closely.
const PIECES: u32 = 8;

/// Halvings of a piece in which a root may still hide.
const HALVINGS_OF_A_PIECE: u32 = 6;

/// Halvings of a step in which a peak may still hide.
const HALVINGS_OF_A_STEP: u32 = 6;

/// Whether a function that is not below `floor` at the start may be so later in `duration`: at the end, or by the bounds of
/// [`may_rise_inside`].
#[inline]
fn may_be_below(floor: f64, start: Sample, end: Sample, duration: f64) -> bool {
    let third = duration * (1.0 / 3.0);
    end.value < floor
        || start.value + third * start.rate < floor
        || end.value - third * end.rate < floor
        || (start.rate < 0.0 && end.rate > 0.0 && tip(start, end, duration) < floor)
}

/// Whether a function may exceed `most` and its values at both ends inside `duration`.
///
/// The intersection of the end tangents bounds a function whose curvature keeps its sign. The control polygon bounds the cubic with these
/// ends, whatever its curvature.
#[inline]
pub fn may_rise_inside(most: f64, start: Sample, end: Sample, duration: f64) -> bool {
    let third = duration * (1.0 / 3.0);
    let rises = |value: f64| value > most && value > start.value && value > end.value;
    rises(start.value + third * start.rate)
        || rises(end.value - third * end.rate)
        || (start.rate > 0.0 && end.rate < 0.0 && rises(tip(start, end, duration)))
}

/// Returns the value at which the end tangents intersect.
#[inline]
fn tip(start: Sample, end: Sample, duration: f64) -> f64 {
    let meeting = (end.value - start.value - end.rate * duration) / (start.rate - end.rate);
    start.value + start.rate * meeting
}

/// The first time in `[0, duration]` at which `function` falls through zero; `None` if it does not.
///
/// `start` and `end` are the function's samples at 0 and `duration`. A value within `rounding` of zero at the start counts as a zero that
/// the function is leaving upwards, see [`leaves_downwards`]: it is muted until it has left it. Between samples the function may dip below
/// zero and come back; the bottom of a dip is sought where the rate changes sign. The result is within rounding of a sign change, see
/// [`sign_change`].
pub fn first_fall(
    start: Sample,
    end: Sample,
    rounding: f64,
    duration: f64,
    mut function: impl FnMut(f64) -> Sample,
) -> Option<f64> {
    if start.value < -rounding {
        return Some(0.0);
    }
    let mut muted = start.value <= rounding;
    // Otherwise it leaves zero with a rate of zero, and dips may be errors of the step.
    let rises = start.rate * duration > rounding;
    let (mut low, mut left) = (0.0, start);
    for piece in 1..=PIECES {
        let (high, right) = if piece == PIECES {
            (duration, end)
        } else {
            let high = duration * f64::from(piece) / f64::from(PIECES);
            (high, function(high))
        };
        let floor = if muted { -rounding } else { 0.0 };
        let found = match muted && !rises {
            true => (right.value < floor).then_some((high, right.value)),
            false => below(floor, [(low, left), (high, right)], HALVINGS_OF_A_PIECE, &mut function),
        };
        if let Some((time, value)) = found {
            let value_at = |t: f64| function(t).value;
            return Some(match muted {
                true => fall_after_zero(low, time, value, value_at),
                false => sign_change(low, time, left.value, value, value_at),
            });
        }
        muted &= right.value <= rounding;
        (low, left) = (high, right);
    }
    None
}

/// Returns a time in an interval at which a function is below `floor`, and its value. At the beginning it is not below.
fn below(
    floor: f64,
    [(low, left), (high, right)]: [(f64, Sample); 2],
    halvings: u32,
    function: &mut impl FnMut(f64) -> Sample,
) -> Option<(f64, f64)> {
    if right.value < floor {
        return Some((high, right.value));
    }
    if !may_be_below(floor, left, right, high - low) {
        return None;
    }
    if left.rate < 0.0 && right.rate > 0.0 {
        let bottom = sign_change(low, high, -left.rate, -right.rate, |t| -function(t).rate);
        let value = function(bottom).value;
        return (value < floor).then_some((bottom, value));
    }
    // The curvature turns inside.
    let halvings = halvings.checked_sub(1)?;
    let half = 0.5 * (low + high);
    let middle = (half, function(half));
    below(floor, [(low, left), middle], halvings, function)
        .or_else(|| below(floor, [middle, (high, right)], halvings, function))
}

/// Whether a function that begins at zero falls below minus its rounding before it rises above its rounding.
pub fn leaves_downwards(start: Sample, rounding: f64, duration: f64, mut function: impl FnMut(f64) -> Sample) -> bool {
    // When it would be that far below at its rate.
    let mut time = if start.value.abs() <= rounding { -2.0 * rounding / start.rate } else { 0.0 };
    while time > 0.0 && time < duration {
        let value = function(time).value;
        if value.abs() > rounding {
            return value < 0.0;
        }
        time *= 2.0;
    }
    false
}

/// Returns the time at which a function that is zero at `low` and negative at `high` falls through zero: after a rise, however short, or
/// else `low`.
fn fall_after_zero(low: f64, high: f64, at_high: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    const HALVINGS: u32 = 40;
    let (mut below, mut value_below) = (high, at_high);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + below);
        let value = function(middle);
        if value > 0.0 {
            return sign_change(middle, below, value, value_below, function);
        }
        (below, value_below) = (middle, value);
    }
    low
}

/// Whether the function may fall through zero: false only if the ends and their rates exclude it.
#[inline]
pub fn may_fall(start: Sample, end: Sample, rounding: f64, duration: f64) -> bool {
    if start.value > rounding {
        may_be_below(0.0, start, end, duration)
    } else {
        // Just after an event, or before one: look closely, unless the function stays at zero.
        start.value < -rounding || end.value.abs() > rounding
    }
}

/// Returns the greatest of `most` and the values of `function` in `[0, duration]`, from its samples at both ends.
#[inline]
pub fn greatest(most: f64, start: Sample, end: Sample, duration: f64, mut function: impl FnMut(f64) -> Sample) -> f64 {
    if may_rise_inside(most, start, end, duration) {
        // The value at a maximum is as exact as the square of its place.
        highest(most, [(0.0, start), (duration, end)], 1e-8 * duration, HALVINGS_OF_A_STEP, &mut function)
    } else {
        most.max(start.value).max(end.value)
    }
}

fn highest(
    most: f64,
    [(low, left), (high, right)]: [(f64, Sample); 2],
    width: f64,
    halvings: u32,
    function: &mut impl FnMut(f64) -> Sample,
) -> f64 {
    let inside = may_rise_inside(most, left, right, high - low);
    let most = most.max(left.value).max(right.value);
    if !inside {
        return most;
    }
    if left.rate > 0.0 && right.rate < 0.0 {
        let top = sign_change_within(width, low, high, left.rate, right.rate, |t| function(t).rate);
        return most.max(function(top).value);
    }
    // The curvature turns inside.
    let Some(halvings) = halvings.checked_sub(1) else { return most };
    let half = 0.5 * (low + high);
    let middle = (half, function(half));
    let most = highest(most, [(low, left), middle], width, halvings, function);
    highest(most, [middle, (high, right)], width, halvings, function)
}

/// A point within rounding (4 ulp of `high`) of a sign change of a continuous function with `f(low) ≥ 0 > f(high)`;
/// returns the side on which `|f|` is the smaller.
///
/// The ITP method of I. F. D. Oliveira and R. H. C. Takahashi, "An enhancement of the bisection method average
/// performance preserving minmax optimality", ACM TOMS 47 (2020), doi:10.1145/3423597: at most one evaluation more than
/// bisection, and superlinear for smooth functions.
pub fn sign_change(low: f64, high: f64, at_low: f64, at_high: f64, f: impl FnMut(f64) -> f64) -> f64 {
    sign_change_within(4.0 * f64::EPSILON * high.abs().max(low.abs()), low, high, at_low, at_high, f)
}

/// The same within `width`.
pub fn sign_change_within(
    width: f64,
    low: f64,
    high: f64,
    at_low: f64,
    at_high: f64,
    mut f: impl FnMut(f64) -> f64,
) -> f64 {
    let (mut a, mut b, mut fa, mut fb) = (low, high, at_low, at_high);
    let half_width = 0.5 * width;
    let truncation = 0.2 / (high - low);
    let mut slack = 2.0 * half_width;
    // Bisections until the bracket has the final width, and one to spare.
    let mut left = 1;
    let mut width = b - a;
    while width > 2.0 * half_width && left < 1100 {
        width *= 0.5;
        slack *= 2.0;
        left += 1;
    }
    while b - a > 2.0 * half_width && left > 0 {
        let middle = 0.5 * (a + b);
        let radius = (slack - 0.5 * (b - a)).max(0.0);
        let secant = (fa * b - fb * a) / (fa - fb);
        let toward = if middle >= secant { 1.0 } else { -1.0 };
        let shift = truncation * (b - a) * (b - a);
        let truncated = if shift <= (middle - secant).abs() { secant + toward * shift } else { middle };
        let point = if (truncated - middle).abs() <= radius { truncated } else { middle - toward * radius };
        // A secant of two infinite or equal values is no number; bisection always is one.
        let point = if point > a && point < b { point } else { middle };
        let value = f(point);
        if value >= 0.0 {
            (a, fa) = (point, value);
        } else {
            (b, fb) = (point, value);
        }
        slack *= 0.5;
        left -= 1;
    }
    if fa.abs() <= fb.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let dip = |t: f64| Sample { value: (t - 0.43) * (t - 0.47), rate: 2.0 * t - 0.9 };
        let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
        assert!((root - 0.43).abs() < 1e-14, "{root}");
        let shallow = |t: f64| Sample { value: (t - 0.45) * (t - 0.45) + 1e-9, rate: 2.0 * t - 0.9 };
        assert_eq!(first_fall(shallow(0.0), shallow(1.0), 1e-15, 1.0, shallow), None);
    }

    /// A function that leaves a double zero, with a start that rounding made negative, and returns later.
    #[test]
    fn the_zero_at_which_it_starts_is_no_root() {
        let opening = |t: f64| Sample { value: t * t * (0.7 - t) - 1e-18, rate: 1.4 * t - 3.0 * t * t };
        let root = first_fall(opening(0.0), opening(1.0), 1e-15, 1.0, opening).unwrap();
        assert!((root - 0.7).abs() < 1e-14, "{root}");
    }

    /// A hop from zero that is over long before the first sample.
    #[test]
    fn sees_the_end_of_a_short_hop() {
        let hop = |t: f64| Sample { value: t * (1e-5 - t), rate: 1e-5 - 2.0 * t };
        let root = first_fall(hop(0.0), hop(1.0), 1e-15, 1.0, hop).unwrap();
        assert!((root - 1e-5).abs() < 1e-18, "{root}");
        let falling = |t: f64| Sample { value: -t, rate: -1.0 };
        assert!(first_fall(falling(0.0), falling(1.0), 1e-15, 1.0, falling).unwrap() < 1e-12);
    }

    #[test]
    fn the_greatest_value_is_inside() {
        let hump = |t: f64| Sample { value: libm::sin(3.0 * t), rate: 3.0 * libm::cos(3.0 * t) };
        let top = greatest(0.0, hump(0.0), hump(1.0), 1.0, hump);
        assert!((top - 1.0).abs() < 1e-15, "{top}");
    }

    /// A hump between ends at which the function rises, and one between ends at which it falls.
    #[test]
    fn sees_a_hump_where_the_curvature_turns() {
        for (sign, roots) in [(1.0, [0.1, 0.2, 1.0]), (-1.0, [0.05, 0.1, 1.2])] {
            let hump = |t: f64| {
                let [a, b, c] = roots.map(|root| t - root);
                Sample { value: sign * a * b * c, rate: sign * (b * c + a * c + a * b) }
            };
            let (start, end) = (hump(0.0), hump(1.0));
            assert!(start.rate * sign > 0.0 && end.rate * sign > 0.0);
            let greatest_of = |most: f64| greatest(most, start, end, 1.0, hump);
            let sampled = (0..=100_000).map(|k| hump(1e-5 * f64::from(k)).value).fold(f64::NEG_INFINITY, f64::max);
            assert!(sampled > start.value.max(end.value) + 1e-3);
            let found = greatest_of(f64::NEG_INFINITY);
            assert!(found >= sampled && found < sampled + 1e-9, "{found}, {sampled}");
            assert_eq!(greatest_of(sampled + 1.0), sampled + 1.0);
        }
    }

    /// The end tangents of a parabola meet halfway, as far above its top as the top is above the ends.
    #[test]
    fn the_bound_is_where_the_tangents_meet() {
        let hump = |t: f64| Sample { value: t * (4.0 - t), rate: 4.0 - 2.0 * t };
        for (from, to, height) in [(0.0, 4.0, 8.0), (1.0, 4.0, 6.0), (2.5, 4.0, 3.75), (0.0, 1.0, 3.0)] {
            let (start, end, duration) = (hump(from), hump(to), to - from);
            let turns = end.rate < 0.0 && start.rate > 0.0;
            let rises = |most: f64| may_rise_inside(most, start, end, duration);
            assert_eq!((rises(height - 1e-9), rises(height)), (turns, false), "{from} {to}");
            let [start, end] = [start.negated(), end.negated()];
            assert_eq!(may_be_below(1e-9 - height, start, end, duration), turns || height <= -end.value, "{from} {to}");
            assert!(!may_be_below(-height, start, end, duration));
        }
    }

    /// One that is below zero from the beginning has fallen already, even if it rises again.
    #[test]
    fn what_has_fallen_before_falls_at_once() {
        let rising = |t: f64| Sample { value: t - 0.1, rate: 1.0 };
        assert_eq!(first_fall(rising(0.0), rising(1.0), 1e-15, 1.0, rising), Some(0.0));
        assert!(may_fall(rising(0.0), Sample::default(), 1e-15, 1.0));
    }

    /// One that falls at both ends may be below zero in between, if its curvature turns.
    #[test]
    fn sees_a_dip_between_falling_ends() {
        for gap in [0.05, 1e-3] {
            let dip = |t: f64| {
                let [a, b, c] = [t - 0.3, t - 0.3 - gap, t - 1.2];
                Sample { value: -a * b * c, rate: -(b * c + a * c + a * b) }
            };
            let (start, end) = (dip(0.0), dip(1.0));
            assert!(start.value > 0.0 && end.value > 0.0 && start.rate < 0.0 && end.rate < 0.0);
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
            let cubic = |t: f64| Sample { value: a + t * (b + t * (c + t * d)), rate: b + t * (2.0 * c + 3.0 * t * d) };
            let least = (0..=300).map(|k| cubic(0.005 * f64::from(k)).value).fold(f64::INFINITY, f64::min);
            let found = may_be_below(least + 1e-14, cubic(0.0), cubic(1.5), 1.5);
            assert!(found || cubic(0.0).value <= least, "{a} {b} {c} {d}: {least}");
        }
    }

    /// A fall from zero counts even if the function soon comes back; not within rounding, and not from above zero.
    #[test]
    fn a_fall_from_zero_differs_from_a_rise() {
        let falls = |at: f64, rounding: f64| {
            let function = |t: f64| Sample { value: at + t * (t - 1e-4), rate: 2.0 * t - 1e-4 };
            leaves_downwards(function(0.0), rounding, 1.0, function)
        };
        assert!(falls(0.0, 1e-15) && falls(-1e-15, 1e-15) && falls(1e-15, 1e-15));
        assert!(!falls(0.0, 1e-8) && !falls(2e-15, 1e-15));
        let rising =
            |rate: f64| leaves_downwards(Sample { value: 0.0, rate }, 1e-15, 1.0, |t| Sample { value: t * t, rate });
        assert!(!rising(0.0) && !rising(1e-4) && !rising(-1e-18) && !rising(f64::NAN));
    }

    /// A hop from zero, and a dip after it, both over before the first sample.
    #[test]
    fn sees_a_dip_behind_a_short_hop() {
        let dip = |t: f64| {
            let [a, b] = [t - 0.02, t - 0.07];
            Sample { value: t * a * b, rate: a * b + t * (a + b) }
        };
        let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
        assert!((root - 0.02).abs() < 1e-14, "{root}");
        // With a rate of zero at the beginning such a dip is what the errors of a step make of a rise.
        let rise = |t: f64| {
            let Sample { value, rate } = dip(t);
            Sample { value: t * value, rate: t * rate + value }
        };
        assert_eq!(first_fall(rise(0.0), rise(1.0), 1e-15, 1.0, rise), None);
    }

    /// The first of two falls is found, and a dip in a long interval.
    #[test]
    fn finds_the_first_of_several_falls() {
        let wave = |t: f64| Sample { value: 0.5 + libm::cos(2.0 * t), rate: -2.0 * libm::sin(2.0 * t) };
        let end = std::f64::consts::TAU;
        let root = first_fall(wave(0.0), wave(end), 1e-15, end, wave).unwrap();
        assert!((root - std::f64::consts::FRAC_PI_3).abs() < 1e-14, "{root}");
        let dip = |t: f64| Sample { value: (t - 14.5) * (t - 15.5), rate: 2.0 * t - 30.0 };
        let root = first_fall(dip(0.0), dip(16.0), 1e-15, 16.0, dip).unwrap();
        assert!((root - 14.5).abs() < 1e-13, "{root}");
    }

    /// A function that begins at zero is watched for dips once it has left zero.
    #[test]
    fn sees_a_dip_after_it_has_left_zero() {
        let dip =
            |t: f64| Sample { value: t * (t - 0.43) * (t - 0.47), rate: (t - 0.43) * (t - 0.47) + t * (2.0 * t - 0.9) };
        let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
        assert!((root - 0.43).abs() < 1e-13, "{root}");
    }

    /// The bottom of a dip is sought by its rate, however narrow it is; also after a function has left zero without a rate.
    #[test]
    fn sees_a_narrow_dip() {
        for (power, at) in [(0, 0.43), (2, 0.43), (0, 0.9), (2, 0.9)] {
            let dip = |t: f64| {
                let [a, b] = [t - at, t - at - 1e-5];
                let factor = t.powi(power);
                let slope = if power == 0 { 0.0 } else { 2.0 * t };
                Sample { value: factor * a * b, rate: slope * a * b + factor * (a + b) }
            };
            let root = first_fall(dip(0.0), dip(1.0), 1e-15, 1.0, dip).unwrap();
            assert!((root - at).abs() < 1e-11, "{power}, {at}: {root}");
        }
    }

    /// A constant within rounding of zero is no fall.
    #[test]
    fn what_stays_at_zero_does_not_fall() {
        let still = |_: f64| Sample { value: -0.5e-15, rate: 0.0 };
        assert_eq!(first_fall(still(0.0), still(1.0), 1e-15, 1.0, still), None);
        assert!(!may_fall(still(0.0), still(1.0), 1e-15, 1.0));
        // One that leaves zero may come back.
        for end in [-0.5, 0.5] {
            assert!(may_fall(still(0.0), Sample { value: end, rate: end }, 1e-15, 1.0));
        }
    }

    #[test]
    fn a_short_hump_is_as_exact_as_a_long_one() {
        let hump = |t: f64| Sample { value: libm::sin(3e4 * t), rate: 3e4 * libm::cos(3e4 * t) };
        let top = greatest(0.0, hump(0.0), hump(1e-4), 1e-4, hump);
        assert!((top - 1.0).abs() < 1e-15, "{top}");
    }

    #[test]
    fn the_side_of_a_jump_is_that_nearer_to_zero() {
        for (before, after) in [(1e-9, -1.0), (1.0, -1e-9)] {
            let root = sign_change(0.0, 1.0, before, after, |t| if t < 0.3 { before } else { after });
            assert_eq!(root < 0.3, before < 0.5, "{root}");
        }
    }
}
