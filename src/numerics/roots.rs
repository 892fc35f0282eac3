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
    /// Returns the sample of the function with the opposite sign.
    #[inline(always)]
    pub fn negated(self) -> Sample<R> {
        Sample { value: -self.value, rate: -self.rate }
    }
}

/// Number of pieces into which a step that may hide a root is cut. A step is shorter than a third of the shortest period of the motion, so
/// that a piece is shorter than 1/24 of it and close to a cubic.
const PIECES: u32 = 8;

/// Maximum number of halvings of a piece that may still hide a root.
const HALVINGS_OF_A_PIECE: u32 = 6;

/// Maximum number of halvings of a step that may still hide a peak.
const HALVINGS_OF_A_STEP: u32 = 6;

/// Whether a function that is not below `floor` at the start may fall below it within `duration`, by the bounds of [`may_rise_inside`].
#[inline]
fn may_be_below(floor: f64, start: Sample, end: Sample, duration: f64) -> bool {
    let third = duration * (1.0 / 3.0);
    end.value < floor
        || start.value + third * start.rate < floor
        || end.value - third * end.rate < floor
        || (start.rate < 0.0 && end.rate > 0.0 && tangent_intersection(start, end, duration) < floor)
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
        || (start.rate > 0.0 && end.rate < 0.0 && rises(tangent_intersection(start, end, duration)))
}

/// Returns the value at which the end tangents intersect.
#[inline]
fn tangent_intersection(start: Sample, end: Sample, duration: f64) -> f64 {
    let meeting = (end.value - start.value - end.rate * duration) / (start.rate - end.rate);
    start.value + start.rate * meeting
}

/// Returns the first time in `[0, duration]` at which `function` falls through zero, or `None`.
///
/// `start` and `end` are the function's samples at 0 and `duration`. A function within `rounding` of zero at the start is muted until it
/// has left zero upwards; [`leaves_downwards`] decides whether it does. Between samples it may dip below zero and come back; the bottom of a
/// dip is sought where the rate changes sign. The result is within round-off of a sign change, see [`sign_change`].
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
    // A function that leaves zero with a rate of zero may dip by errors of the step.
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

/// Returns a time in an interval at which a function is below `floor`, with its value there; it begins above.
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
    // The curvature changes sign inside.
    let halvings = halvings.checked_sub(1)?;
    let half = 0.5 * (low + high);
    let middle = (half, function(half));
    below(floor, [(low, left), middle], halvings, function)
        .or_else(|| below(floor, [middle, (high, right)], halvings, function))
}

/// Whether a function that begins at zero first leaves the band of its round-off downwards.
pub fn leaves_downwards(start: Sample, rounding: f64, duration: f64, mut function: impl FnMut(f64) -> Sample) -> bool {
    // The time at which its rate would take it to −2 `rounding`.
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

/// Returns the time at which a function that is zero at `low` and negative at `high` falls through zero: `low`, unless it rises first.
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

/// Whether a function may fall through zero; false only if its values and rates at both ends exclude it.
#[inline]
pub fn may_fall(start: Sample, end: Sample, rounding: f64, duration: f64) -> bool {
    if start.value > rounding {
        may_be_below(0.0, start, end, duration)
    } else {
        // An event has just happened or is about to: search, unless the function stays at zero.
        start.value < -rounding || end.value.abs() > rounding
    }
}

/// Returns the greatest of `most` and the values of `function` in `[0, duration]`, from its samples at both ends.
#[inline]
pub fn greatest(most: f64, start: Sample, end: Sample, duration: f64, mut function: impl FnMut(f64) -> Sample) -> f64 {
    if may_rise_inside(most, start, end, duration) {
        // The error of the value at a maximum is the square of that of its time.
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
    // The curvature changes sign inside.
    let Some(halvings) = halvings.checked_sub(1) else { return most };
    let half = 0.5 * (low + high);
    let middle = (half, function(half));
    let most = highest(most, [(low, left), middle], width, halvings, function);
    highest(most, [middle, (high, right)], width, halvings, function)
}

/// Finds a sign change of a continuous function with `f(low) ≥ 0 > f(high)` to round-off (4 ulp of `high`).
///
/// Returns the end of the bracket at which `|f|` is smaller.
///
/// The ITP method of I. F. D. Oliveira and R. H. C. Takahashi, "An enhancement of the bisection method average
/// performance preserving minmax optimality", ACM TOMS 47 (2020), doi:10.1145/3423597: at most one evaluation more than
/// bisection, and superlinear for smooth functions.
pub fn sign_change(low: f64, high: f64, at_low: f64, at_high: f64, f: impl FnMut(f64) -> f64) -> f64 {
    sign_change_within(4.0 * f64::EPSILON * high.abs().max(low.abs()), low, high, at_low, at_high, f)
}

/// Finds a sign change as [`sign_change`] does, to this `width` of the bracket.
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
