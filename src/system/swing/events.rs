//! A swing → its landing, its quarter turn and its greatest rotation.

use std::f64::consts::FRAC_PI_2;

use crate::block::Corner;
use crate::numerics::bernstein::{Bernstein, DEGREE, Zero};
use crate::system::swing::{Bounds, ORDER, Series, Swing};

/// Width of the last Newton step to the greatest rotation, over the swing. The error of its place is of the order of the width's square,
/// that of the rotation of its fourth power.
pub(super) const TOP_WIDTH: f64 = 1e-5;

/// Round-off of the acceleration of a block leaving the base, over its change.
pub(super) const LANDING_ROUNDING: f64 = 1e-12;

/// Least fraction of a swing after which a landing is not mere round-off. The block leaves the base without a rate.
pub(super) const MIN_LANDING: f64 = 1e-3;

/// Maximum number of Newton's steps to a landing or to the greatest rotation.
pub(super) const MAX_NEWTON: u32 = 60;

/// Ratio of successive places below which Newton's method still takes a step.
pub(super) const STILL: f64 = 1.0 - 4.0 * f64::EPSILON;

impl Swing {
    /// The fraction of the swing after which the block comes down.
    ///
    /// Needs bounds that are certain, and a negative rotation at the end. θ̈ then points to the base all the time, so that Newton's
    /// method approaches the zero from the end of the swing without passing it. The result is within 4 ulp.
    #[inline]
    pub fn landing(&self) -> f64 {
        let mut fraction = 1.0;
        for _ in 0..MAX_NEWTON {
            let [theta, slope] = self.theta_at(fraction);
            let next = fraction - theta / slope;
            if next >= STILL * fraction {
                break;
            }
            fraction = next;
        }
        fraction
    }

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
            return self.top(-corner.sign(), fraction, most);
        }
        Bernstein::of(self.away_from(corner, fraction), self.order).highest(most).map(|place| place * fraction)
    }

    /// The fraction at which the rotation peaks if θ̈ always points to the base.
    ///
    /// Newton's method for the zero of θ̇, until a tangent shows that the rotation does not exceed `most` (rad).
    fn top(&self, away: f64, fraction: f64, most: f64) -> Option<f64> {
        let ([_, first], [_, last]) = (self.theta_at(0.0), self.theta_at(fraction));
        if first * away <= 0.0 || last * away >= 0.0 {
            return None;
        }
        let (mut low, mut high, mut place) = (0.0, fraction, fraction * (first / (first - last)));
        for _ in 0..MAX_NEWTON {
            let [theta, slope, half_curvature] = self.curve_at(place);
            let rises = slope * away > 0.0;
            let end = if rises { high } else { low };
            if theta * away + slope * away * (end - place) <= most {
                return None;
            }
            (low, high) = if rises { (place, high) } else { (low, place) };
            let next = place - slope / (2.0 * half_curvature);
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            if (next - place).abs() <= TOP_WIDTH {
                return Some(next);
            }
            place = next;
        }
        Some(place)
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
