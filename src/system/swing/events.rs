//! A swing → its landing, its quarter turn and its greatest rotation.

use std::f64::consts::FRAC_PI_2;

use crate::block::Corner;
use crate::numerics::bernstein::{Bernstein, DEGREE, Zero};
use crate::numerics::scalar::{Real, Runs};
use crate::system::swing::{Bounds, ORDER, Series, Swing};

/// Width of the last Newton step to the greatest rotation, over the swing. The error of its place is of the order of the width's square,
/// that of the rotation of its fourth power.
const TOP_WIDTH: f64 = 1e-5;

/// Round-off of the acceleration of a block leaving the base, over its change.
pub(super) const LANDING_ROUNDING: f64 = 1e-12;

/// Least fraction of a swing after which a landing is not mere round-off. The block leaves the base without a rate.
pub(super) const MIN_LANDING: f64 = 1e-3;

/// Maximum number of Newton's steps to a landing or to the greatest rotation.
const MAX_NEWTON: u32 = 60;

/// Ratio of successive places below which Newton's method still takes a step.
const STILL: f64 = 1.0 - 4.0 * f64::EPSILON;

impl<T: Real> Swing<T> {
    /// The fraction of the swing after which the block comes down in some runs, and 1 in the others.
    ///
    /// Needs bounds that are certain, and a negative rotation at the end. θ̈ then points to the base all the time, so that Newton's
    /// method approaches the zero from the end of the swing without passing it. The result is within 4 ulp.
    #[inline(always)]
    pub fn landing(&self, runs: T::Runs) -> T {
        let mut fraction = T::from(1.0);
        for _ in 0..MAX_NEWTON {
            let [theta, slope] = self.theta_at(fraction);
            let next = fraction - theta / slope;
            let moves = next.less(fraction * STILL).and(runs);
            if !moves.any() {
                break;
            }
            fraction = moves.choose(next, fraction);
        }
        fraction
    }

    /// The fractions at which the rotation peaks in some runs if θ̈ always points to the base, and those of the runs that have a peak.
    ///
    /// Newton's method for the zero of θ̇, until a tangent shows that the rotation does not exceed `most` (rad).
    #[inline(always)]
    pub fn top(&self, runs: T::Runs, away: T, fraction: T, most: T) -> (T, T::Runs) {
        let (zero, first) = (T::from(0.0), self.theta[1]);
        let [_, last] = self.theta_at(fraction);
        let mut active = runs.and(zero.less(first * away)).and((last * away).less(zero));
        let mut found = runs.except(runs);
        let (mut low, mut high, mut place) = (zero, fraction, fraction * (first / (first - last)));
        for _ in 0..MAX_NEWTON {
            if !active.any() {
                break;
            }
            let [theta, slope, half_curvature] = self.curve_at(place);
            let rises = zero.less(slope * away);
            let end = rises.choose(high, low);
            active = active.and(most.less(theta * away + slope * away * (end - place)));
            (low, high) = (rises.choose(place, low), rises.choose(high, place));
            let next = place - slope / (half_curvature * 2.0);
            let outside = next.less(low).or(high.less(next));
            let next = outside.choose((low + high) * 0.5, next);
            let moves = T::from(TOP_WIDTH).less((next - place).abs());
            place = active.choose(next, place);
            found = found.or(active.except(moves));
            active = active.and(moves);
        }
        (place, found.or(active))
    }
}

impl Swing {
    /// The fraction of the swing after which a block on or off the base lands.
    pub fn first_landing(&self, corner: Corner) -> Zero {
        let theta = self.away_from(corner, 1.0);
        let zeros = match theta {
            [0.0, 0.0, second, third, ..] if second.abs() <= LANDING_ROUNDING * third => 3,
            [0.0, 0.0, ..] => 2,
            [0.0, ..] => 1,
            _ => 0,
        };
        let mut rest = [0.0; DEGREE + 1];
        rest[..ORDER + 1 - zeros].copy_from_slice(&theta[zeros..]);
        match Bernstein::of(rest, self.order - zeros).zero() {
            Zero::At(fraction) if zeros > 1 && fraction < MIN_LANDING => Zero::Unclear,
            zero => zero,
        }
    }

    /// The fraction of the swing before a quarter turn about a corner.
    pub fn quarter_turn(&self, corner: Corner) -> Zero {
        let mut rest = self.away_from(corner.other(), 1.0);
        rest[0] += FRAC_PI_2;
        Bernstein::of(rest, self.order).zero()
    }

    /// The fraction of the swing, below `fraction`, at which the rotation off a corner peaks. The peak exceeds `most` (rad) and both ends.
    pub fn highest(&self, corner: Corner, bounds: &Bounds, fraction: f64, most: f64) -> Option<f64> {
        if bounds.turns_back {
            let (place, has_peak) = self.top(true, -corner.sign(), fraction, most);
            return has_peak.then_some(place);
        }
        Bernstein::of(self.away_from(corner, fraction), self.order).highest(most).map(|place| place * fraction)
    }

    /// The series of the rotation off a corner, over the first `fraction` of the swing.
    fn away_from(&self, corner: Corner, fraction: f64) -> Series {
        let (mut theta, mut power) = (self.theta, -corner.sign());
        for term in &mut theta {
            *term *= power;
            power *= fraction;
        }
        theta
    }
}
