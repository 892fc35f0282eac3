//! A function of time with its rate, and its values at both ends of a step → the first time at which it falls through
//! zero, and the greatest value in between.
//!
//! A sample of the function is a dual number: its value, and its derivative with respect to time.
//!
//! The searches are compiled once for all functions, which they call by pointers: a call takes far less than the dense output that it
//! evaluates.

use crate::numerics::dual::Dual;
use crate::numerics::scalar::{self, Real, Runs};

/// Number of pieces of the longest step where it may hide a root. A step is shorter than a third of the shortest period of the motion, so
/// that a piece is shorter than 1/24 of it and close to a cubic.
pub const PIECES: u32 = 8;

/// Returns the number of pieces of a step that is this fraction of the longest.
///
/// None is longer than a piece of the longest step.
pub fn pieces(fraction_of_longest: f64) -> u32 {
    // NaN gives one piece.
    ((f64::from(PIECES) * fraction_of_longest).ceil() as u32).clamp(1, PIECES)
}

/// Maximum number of halvings of a step, pieces included, that may still hide a root.
const HALVINGS: u32 = 9;

/// Maximum number of halvings of a step that may still hide a peak.
const HALVINGS_OF_A_STEP: u32 = 6;

/// Maximum number of interpolations before the ITP method takes over. A function close to a cubic takes three or four.
const INTERPOLATIONS: u32 = 8;

/// The fraction tried of a step in which a function rises and falls unseen. Such a function begins at zero.
pub const SHORTENED: f64 = 0.125;

/// The fraction of the longest step below which such a rise is neglected. The fall is then placed at the end of the step.
const SHORTEST_RISE: f64 = 1e-10;

/// The fraction of a step that the clock must resolve to try it.
const MIN_SHORTENED: f64 = 1e-2;

/// Whether a step of `size` (s) from `time` (s) may be tried anew with a [`SHORTENED`] one. The longest step is `longest` (s).
#[inline]
pub fn may_shorten(time: f64, size: f64, longest: f64) -> bool {
    size > SHORTEST_RISE * longest && time + MIN_SHORTENED * size > time
}

/// A time and the sample of a function there.
type TimedSample = (f64, Dual);

/// A function of time with its rate.
pub type Function<'a> = dyn FnMut(f64) -> Dual + 'a;

/// Whether a function with this value has fallen through zero: it is below by more than its round-off. Its event is due at once.
#[inline(always)]
pub fn has_fallen(value: f64, rounding: f64) -> bool {
    value < -rounding
}

/// Whether a function may fall below `floor` within `duration`, by the bounds of [`may_exceed`]. It is not below at the start.
#[inline]
fn may_be_below(floor: f64, start: Dual, end: Dual, duration: f64) -> bool {
    end.re < floor || may_exceed(-floor, -start, -end, duration)
}

/// Whether a function may exceed `most` inside `duration`, in each run. It does not at the ends.
///
/// The intersection of the end tangents bounds a function whose curvature keeps its sign. The control polygon bounds the cubic with these
/// ends, whatever its curvature.
#[inline(always)]
fn may_exceed<T: Real>(most: T, start: Dual<T>, end: Dual<T>, duration: T) -> T::Runs {
    let (zero, third) = (T::from(0.0), duration * (1.0 / 3.0));
    let polygon = scalar::greatest(start.re + third * start.eps, end.re - third * end.eps);
    let exceeds = most.less(polygon);
    let turns = zero.less(start.eps).and(end.eps.less(zero));
    if !turns.any() {
        return exceeds;
    }
    // The end tangents intersect here.
    let meeting = (end.re - start.re - end.eps * duration) / (start.eps - end.eps);
    exceeds.or(turns.and(most.less(start.re + start.eps * meeting)))
}

/// Whether a function may exceed `most` and its values at both ends inside `duration`, in each run, by tangents and control polygon.
#[inline(always)]
pub fn may_rise_inside<T: Real>(most: T, start: Dual<T>, end: Dual<T>, duration: T) -> T::Runs {
    may_exceed(scalar::greatest(most, scalar::greatest(start.re, end.re)), start, end, duration)
}

/// Whether a function may exceed `most` in `[0, duration]`, by its samples at both ends.
#[inline]
pub fn may_pass(most: f64, start: Dual, end: Dual, duration: f64) -> bool {
    most < start.re || most < end.re || may_exceed(most, start, end, duration)
}

/// Returns the first time in `[0, duration]` at which `function` falls through zero, or `None`.
///
/// `start` and `end` are the function's samples at 0 and `duration`. A function within `rounding` of zero at the start is muted until it
/// has left zero upwards; one that leaves it downwards has fallen at once, which [`leaves_downwards`] tells the caller. Between samples it may dip below zero and come back; the bottom of a
/// dip is sought where the rate changes sign. All `pieces` are searched in turn; if the ends of longer intervals bound the function as well
/// (`bounded`), only those that may hold the first fall. The result is within round-off of a sign change, see [`sign_change`].
pub fn first_fall(
    start: Dual,
    end: Dual,
    rounding: f64,
    duration: f64,
    pieces: u32,
    bounded: bool,
    function: &mut Function,
) -> Option<f64> {
    if has_fallen(start.re, rounding) {
        return Some(0.0);
    }
    let (piece, last) = (duration / f64::from(pieces), (duration, end));
    // A function that leaves zero with a rate of zero may dip by errors of the step.
    let rises = start.eps * duration > rounding;
    let (mut left, mut muted, mut passed) = ((0.0, start), start.re <= rounding, 0);
    while (muted || !bounded) && passed < pieces {
        passed += 1;
        let time = duration * f64::from(passed) / f64::from(pieces);
        let right = if passed == pieces { last } else { (time, function(time)) };
        let floor = if muted { -rounding } else { 0.0 };
        let found = if muted && !rises {
            (right.1.re < floor).then_some([left, right])
        } else {
            first_below(floor, [left, right], piece, HALVINGS, function)
        };
        if let Some([above, below]) = found {
            return Some(if muted { fall_after_zero(left.0, below, function) } else { fall([above, below], function) });
        }
        muted &= right.1.re <= rounding;
        left = right;
    }
    if passed == pieces {
        return None;
    }
    let bracket = first_below(0.0, [left, last], piece, HALVINGS, function)?;
    Some(fall(bracket, function))
}

/// Returns an interval in which a function first falls below `floor`. It is above at the beginning, and below at the end.
///
/// An interval longer than `piece` is halved where it may hold more than one fall.
fn first_below(
    floor: f64,
    [left, right]: [TimedSample; 2],
    piece: f64,
    halvings: u32,
    function: &mut Function,
) -> Option<[TimedSample; 2]> {
    let [(low, at_low), (high, at_high)] = [left, right];
    let is_piece = high - low <= piece;
    if at_high.re < floor {
        if is_piece || descends(at_low, at_high, high - low) {
            return Some([left, right]);
        }
    } else if !may_be_below(floor, at_low, at_high, high - low) {
        return None;
    }
    if is_piece && at_low.eps < 0.0 && at_high.eps > 0.0 {
        let bottom = sign_change(low, high, -at_low.eps, -at_high.eps, |t| -function(t).eps);
        let sample = function(bottom);
        return (sample.re < floor).then_some([left, (bottom, sample)]);
    }
    // The curvature changes sign inside.
    let halvings = halvings.checked_sub(1)?;
    let half = 0.5 * (low + high);
    let middle = (half, function(half));
    if middle.1.re < floor {
        return first_below(floor, [left, middle], piece, halvings, function);
    }
    first_below(floor, [left, middle], piece, halvings, function)
        .or_else(|| first_below(floor, [middle, right], piece, halvings, function))
}

/// Whether the control polygon of a cubic with these ends descends, and so the cubic.
fn descends(start: Dual, end: Dual, duration: f64) -> bool {
    let third = duration * (1.0 / 3.0);
    start.eps <= 0.0 && end.eps <= 0.0 && start.re + third * start.eps >= end.re - third * end.eps
}

/// Whether a function that begins at zero first leaves the band of its round-off downwards, by its rate there.
pub fn leaves_downwards(start: Dual, rounding: f64, duration: f64, function: &mut Function) -> bool {
    // The time at which its rate would take it to −2 `rounding`.
    let mut time = if start.re.abs() <= rounding { -2.0 * rounding / start.eps } else { 0.0 };
    while time > 0.0 && time < duration {
        let value = function(time).re;
        if value.abs() > rounding {
            return value < 0.0;
        }
        time *= 2.0;
    }
    false
}

/// Returns the time at which a function that is zero at `low` falls through zero. It does so after a rise, however short, or else at `low`;
/// at `below` it is negative.
///
/// A rise may be lost in round-off; where the function still rises, it has not fallen yet.
fn fall_after_zero(low: f64, below: TimedSample, function: &mut Function) -> f64 {
    const HALVINGS: u32 = 40;
    let mut end = below;
    let mut found = low;
    for _ in 0..HALVINGS {
        let time = 0.5 * (low + end.0);
        let middle = (time, function(time));
        if middle.1.re > 0.0 {
            found = fall([middle, end], function);
            break;
        }
        end = middle;
    }
    let rate = function(found).eps;
    if rate <= 0.0 || below.1.eps >= 0.0 {
        return found;
    }
    let top = sign_change(found, below.0, rate, below.1.eps, |time| function(time).eps);
    let at_top = function(top);
    if at_top.re > 0.0 { fall([(top, at_top), below], function) } else { top }
}

/// Finds the [`sign_change`] of a function with known rates in a third of the evaluations. Needs a value ≥ 0 at `left` and < 0 at `right`.
///
/// The time is interpolated over values and rates at both ends of the bracket until a point is within round-off of zero by its rate. As
/// round-off of the function may prevent that, each point is moved by half the final width towards the end farther from zero, so that the
/// bracket closes from both sides.
fn fall([mut left, mut right]: [TimedSample; 2], function: &mut Function) -> f64 {
    let half_width = 2.0 * f64::EPSILON * right.0;
    let mut shift = half_width;
    for _ in 0..INTERPOLATIONS {
        if right.0 - left.0 <= 2.0 * half_width {
            break;
        }
        let is_nearer_left = left.1.re < -right.1.re;
        let point = interpolated_fall(left, right) + if is_nearer_left { shift } else { -shift };
        let point = between(left.0, point, right.0);
        let sample = function(point);
        if sample.re.abs() <= 2.0 * half_width * -sample.eps {
            return point;
        }
        let is_left = sample.re >= 0.0;
        *if is_left { &mut left } else { &mut right } = (point, sample);
        // Round-off of the function may exceed the width.
        shift = if is_left == is_nearer_left { 4.0 * shift } else { half_width };
    }
    sign_change_within(2.0 * half_width, left.0, right.0, left.1.re, right.1.re, &mut |t| function(t).re)
}

/// Returns the time at value zero on the cubic t(value) with these ends. NaN unless the function falls at both.
fn interpolated_fall((low, left): TimedSample, (high, right): TimedSample) -> f64 {
    if !(left.eps < 0.0 && right.eps < 0.0) {
        return f64::NAN;
    }
    let fall = left.re - right.re;
    let x = left.re / fall;
    let y = 1.0 - x;
    low + x * (x * (3.0 - 2.0 * x) * (high - low) + y * fall * (x / right.eps - y / left.eps))
}

/// Returns `point` if it lies between two others, or else their middle.
fn between(low: f64, point: f64, high: f64) -> f64 {
    if point > low && point < high { point } else { 0.5 * (low + high) }
}

/// Whether a function may fall through zero. False only if values and rates at both ends exclude it.
#[inline]
pub fn may_fall(start: Dual, end: Dual, rounding: f64, duration: f64) -> bool {
    if start.re > rounding {
        may_be_below(0.0, start, end, duration)
    } else {
        // An event has just happened or is about to: search, unless the function stays at zero. It may also leave zero and be back.
        has_fallen(start.re, rounding) || end.re.abs() > rounding || -start.eps * duration > rounding
    }
}

/// Whether the bounds of a function let it fall through zero, in each run. One that begins at zero has to fall below its `rounding`.
#[inline(always)]
pub fn may_fall_by_bounds<T: Real>(start: Dual<T>, end: Dual<T>, rounding: T, duration: T) -> T::Runs {
    let depth = T::select_less(rounding, start.re, T::from(0.0), rounding);
    let (start, end) = (-start, -end);
    let greater_end = scalar::greatest(start.re, end.re);
    depth.less(greater_end).or(may_exceed(depth, start, end, duration))
}

/// Returns the greatest of `most` and the values of `function` in `[0, duration]`. Its samples at both ends are given.
#[inline]
pub fn greatest(most: f64, start: Dual, end: Dual, duration: f64, function: &mut Function) -> f64 {
    if may_rise_inside(most, start, end, duration) {
        // The error of the value is the square of that of the time, with the rise to the maximum added its cube.
        highest(most, [(0.0, start), (duration, end)], 1e-6 * duration, HALVINGS_OF_A_STEP, function)
    } else {
        most.max(start.re).max(end.re)
    }
}

/// Returns the rate of a value that equals its `peak` and grows, or zero.
pub fn rate_of_peak(peak: f64, value: Dual) -> f64 {
    // The value at the step's last instant and the observed one are the same number up to rounding.
    const AT_PEAK: f64 = 1.0 - 8.0 * f64::EPSILON;
    if value.re >= AT_PEAK * peak && value.eps > 0.0 { value.eps } else { 0.0 }
}

fn highest(most: f64, [left, right]: [TimedSample; 2], width: f64, halvings: u32, function: &mut Function) -> f64 {
    let inside = may_rise_inside(most, left.1, right.1, right.0 - left.0);
    let most = most.max(left.1.re).max(right.1.re);
    if !inside {
        return most;
    }
    if left.1.eps > 0.0 && right.1.eps < 0.0 {
        return top(most, [left, right], width, function);
    }
    // The curvature changes sign inside.
    let Some(halvings) = halvings.checked_sub(1) else { return most };
    let half = 0.5 * (left.0 + right.0);
    let middle = (half, function(half));
    let most = highest(most, [left, middle], width, halvings, function);
    highest(most, [middle, right], width, halvings, function)
}

/// Returns the greatest of `most` and the values of a function between `left` and `right`. It rises at `left` and falls at `right`. The
/// place of its top is found within `width`, and the rise to it is added.
///
/// The first points are tops of cubics; later ones follow from the rates alone, which need not be those of the values to the last digit.
fn top(mut most: f64, [mut left, mut right]: [TimedSample; 2], width: f64, function: &mut Function) -> f64 {
    let mut nearest = [left, right];
    let mut next = top_of_cubic(nearest);
    for evaluations in 1..=INTERPOLATIONS {
        let time = between(left.0, next, right.0);
        let sample = function(time);
        most = most.max(sample.re);
        *if sample.eps >= 0.0 { &mut left } else { &mut right } = (time, sample);
        let [first, second] = nearest;
        let other = if (time - first.0).abs() < (time - second.0).abs() { first } else { second };
        nearest = [other, (time, sample)];
        let distance = sample.eps * (time - other.0) / (other.1.eps - sample.eps);
        if distance.abs() <= width {
            return most.max(sample.re + 0.5 * sample.eps * distance);
        }
        if !may_rise_inside(most, left.1, right.1, right.0 - left.0) {
            return most;
        }
        next = if evaluations == 1 { top_of_cubic(nearest) } else { time + distance };
    }
    let time = sign_change_within(width, left.0, right.0, left.1.eps, right.1.eps, &mut |t| function(t).eps);
    most.max(function(time).re)
}

/// Returns the time of the maximum of a cubic with these samples; NaN without one.
fn top_of_cubic([(first, a), (second, b)]: [TimedSample; 2]) -> f64 {
    let duration = second - first;
    let (start, end, rise) = (duration * a.eps, duration * b.eps, 3.0 * (b.re - a.re));
    // The derivative is `start + 2 linear x + square x²`, and its slope there is negative.
    let (linear, square) = (rise - 2.0 * start - end, 3.0 * (start + end) - 2.0 * rise);
    first + duration * start / ((linear * linear - square * start).sqrt() - linear)
}

/// Finds a sign change of a continuous function to round-off (4 ulp of `high`). Needs `f(low) ≥ 0 > f(high)`.
///
/// Returns the end of the bracket at which `|f|` is smaller.
///
/// The ITP method of I. F. D. Oliveira and R. H. C. Takahashi, "An enhancement of the bisection method average
/// performance preserving minmax optimality", ACM TOMS 47 (2020), doi:10.1145/3423597: at most one evaluation more than
/// bisection, and superlinear for smooth functions.
pub fn sign_change(low: f64, high: f64, at_low: f64, at_high: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    sign_change_within(4.0 * f64::EPSILON * high.abs().max(low.abs()), low, high, at_low, at_high, &mut f)
}

/// Finds a sign change as [`sign_change`] does, to this `width` of the bracket.
fn sign_change_within(
    width: f64,
    low: f64,
    high: f64,
    at_low: f64,
    at_high: f64,
    f: &mut dyn FnMut(f64) -> f64,
) -> f64 {
    let (mut a, mut b, mut fa, mut fb) = (low, high, at_low, at_high);
    let half_width = 0.5 * width;
    let truncation = 0.2 / (high - low);
    let mut slack = 2.0 * half_width;
    // The number of bisections to the final width, and one to spare.
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
        // The secant of two infinite or equal values is NaN.
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
mod tests;
