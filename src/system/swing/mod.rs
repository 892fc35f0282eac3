//! A block that turns about a corner of the rigid base → its motion as a power series of time.
//!
//! With the place X, Q of the centre of mass as seen from the corner, to the right and up, Housner's equation is
//!
//! ```text
//! (I0/M + X² + Q²) θ̈ = X (g + a_z) − Q a_x + m        Ẋ = Q θ̇        Q̇ = −X θ̇
//! ```
//!
//! where X² + Q² is constant. Let τ be the elapsed fraction of the swing, from 0 to 1, h its duration, and `θ = Σ θ_k τᵏ`; X, Q and the
//! excitation likewise. Equal powers of τ on both sides give one coefficient after the other (Jorba and Zou, "A software package for the
//! numerical integration of ODEs by means of high-order Taylor methods", Experimental Mathematics 14, 2005):
//!
//! ```text
//! (I0/M + X² + Q²) (k+1) (k+2) θ_(k+2) = h² [ Σ X_(k−j) (g + a_z)_j − Σ Q_(k−j) (a_x)_j + m_k ],    j from 0 to k
//!                                n X_n =  Σ j θ_j Q_(n−j),    n Q_n = −Σ j θ_j X_(n−j),            j from 1 to n
//! ```
//!
//! The series ends where its last two terms of θ̇ are below the allowed error, and so are the next two of the pulse: two terms may vanish
//! while later ones do not, as where a sine of the frequency p and the rotation cancel. A swing that would need more than [`ORDER`] terms
//! is shortened. X and Q differ from the displacements of the centre of mass by constants, so that `N/M = g + a_z + Q̈` and `H/M = a_x + Ẍ`.
//!
//! Since |τ| ≤ 1, the sum of the other terms' sizes bounds the distance of a series from its first term. [`Swing::bounds`] tells by such
//! sums whether the block lands, and how large rotation and forces can be; [`Swing::landing`] finds the landing.

mod events;
#[cfg(feature = "lanes")]
pub(crate) mod lanes;
#[cfg(feature = "lanes")]
pub(crate) mod tangent;

use crate::block::{Body, Corner, Lever};
use crate::excitation::{Excitation, Forcing, ForcingSeries};
use crate::numerics::bernstein::{DEGREE, Pair, Row};
use crate::numerics::scalar::{Real, Runs, Scalar, greatest, least};

/// The highest power of a swing. More would make steps longer, but cost more than they save; docs/code/integrator.md.
pub const ORDER: usize = 16;

type Series<T = f64> = [T; ORDER + 1];

/// The motion from an instant on, as series in the elapsed fraction of `size`.
#[derive(Clone, Copy, Debug)]
pub struct Swing<T = f64> {
    /// Its duration (s): over it the last terms are below the error that is allowed.
    pub size: T,
    /// The highest power.
    order: usize,
    theta: Series<T>,
    x: Series<T>,
    q: Series<T>,
    forcing: ForcingSeries<{ ORDER + 1 }, T>,
}

/// A block that turns about a corner.
#[derive(Clone, Copy, Debug)]
pub struct Pivoting<T = f64> {
    /// Horizontal distance of the centre of mass from the corner of the upright block (m). Positive to the right of the corner.
    pub offset: T,
    /// Its height (m).
    pub h: T,
    /// `I0/M` (m²).
    pub i0: T,
    /// g (m/s²).
    pub gravity: T,
    /// The sign of a rotation away from the base.
    pub away: T,
}

impl Pivoting {
    /// A block about one of its corners.
    #[inline]
    pub fn of(body: &Body, corner: Corner) -> Pivoting {
        let Body { h, i0, gravity, .. } = *body;
        Pivoting { offset: body.offset(corner), h, i0, gravity, away: -corner.sign() }
    }
}

impl<T: Scalar> Pivoting<T> {
    /// N/M and H/M (m/s²) at `[θ, θ̇]` (rad, rad/s), by the equation of motion.
    #[inline(always)]
    pub fn forces(&self, [theta, theta_dot]: [T; 2], forcing: &Forcing<T>) -> [T; 2] {
        let (sin, cos) = theta.sin_cos();
        let Lever { x, q } = Lever::of(self.offset, self.h, sin, cos);
        let (weight, square) = (forcing.z + self.gravity, theta_dot * theta_dot);
        let theta_ddot = (x * weight - q * forcing.x + forcing.moment) / (x * x + q * q + self.i0);
        [weight - (x * theta_ddot + q * square), forcing.x + (q * theta_ddot - x * square)]
    }
}

/// Bounds of the motion over a swing.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<T: Real = f64> {
    /// Whether `last` alone shows if the block comes down within the swing. It does not come near the base, accelerates towards it all the
    /// time, or leaves it faster and faster.
    pub is_certain: T::Runs,
    /// The rotation away from the base at the end (rad), negative beyond the base.
    pub last: T,
    /// Whether θ̈ points to the base all the time.
    pub turns_back: T::Runs,
    /// Whether |θ| is greatest at an end, until the block comes down. It only rises or only falls, or θ̈ points away from the base.
    pub is_greatest_at_end: T::Runs,
    /// The greatest |θ| (rad).
    pub theta: T,
    /// The least and the greatest N/M (m/s²).
    pub reaction: [T; 2],
    /// The greatest |H|/M (m/s²).
    pub horizontal: T,
}

/// `k`, `1/k`, `k (k − 1)` or `k/(k + 1)`, and 0 for 0.
const fn numbers(row: usize) -> Series {
    let (mut numbers, mut k) = ([0.0; ORDER + 1], 1);
    while k < ORDER + 1 {
        let n = k as f64;
        numbers[k] = [n, 1.0 / n, n * (n - 1.0), n / (n + 1.0)][row];
        k += 1;
    }
    numbers
}

/// The least order, by which reactions and their changes are known.
const MIN: usize = 4;

/// Longest first attempt of a swing, over the duration of an arc at constant acceleration.
const OF_FLIGHT: f64 = 1.25;

static NUMBER: Series = numbers(0);
static RECIPROCAL: Series = numbers(1);
static PRODUCT: Series = numbers(2);
static OF_NEXT: Series = numbers(3);

/// The fraction of a swing whose last terms meet the allowed error. `fraction` is the allowed error over that of the whole swing.
#[inline(always)]
fn shortening<T: Real>(fraction: T) -> T {
    const SAFETY: f64 = 0.75;
    // The root of order 16.
    fraction.sqrt().sqrt().sqrt().sqrt() * SAFETY
}

/// `∫ s' dτ` and `∫ τ s' dτ` over a fraction, for a series s.
#[inline(always)]
fn way_and_moment<T: Real>(series: &Series<T>, order: usize, fraction: T) -> [T; 2] {
    let (mut way, mut moment) = (T::from(0.0), T::from(0.0));
    for n in (1..order + 1).rev() {
        way = way * fraction + series[n];
        moment = moment * fraction + series[n] * OF_NEXT[n];
    }
    [way * fraction, moment * (fraction * fraction)]
}

impl<T: Real> Swing<T> {
    /// The coefficient k of the moment about the corner, per unit mass. It follows from those of X, Q and the excitation up to k. The first
    /// number is `g + a_z` at the beginning.
    #[inline(always)]
    fn turning(&self, k: usize, weight: T) -> T {
        let Swing { x, q, forcing, .. } = self;
        // The terms that have just been found come last.
        let mut earlier = T::from(0.0);
        if forcing.terms > 2 {
            for j in (1..k + 1).rev() {
                earlier = earlier - q[k - j] * forcing.x[j];
            }
        } else if k > 0 {
            earlier = earlier - q[k - 1] * forcing.x[1];
        }
        if k > 0 {
            earlier = earlier + x[k - 1] * forcing.z[1];
        }
        if k < 2 {
            earlier = earlier + forcing.moment[k];
        }
        earlier + (x[k] * weight - q[k] * forcing.x[0])
    }

    /// The size of the `last` two terms of θ̇ up to n. If the next two of a pulse alone are greater, it is theirs.
    ///
    /// `scale` is the square of the swing's duration over the moment of inertia.
    #[inline(always)]
    fn tail(&self, n: usize, last: T, scale: T) -> T {
        let Swing { q, forcing, .. } = self;
        if forcing.terms == 2 {
            return last;
        }
        let next = (forcing.x[n - 1].abs() + forcing.x[n].abs()) * (q[0].abs() * scale) * RECIPROCAL[n];
        greatest(last, next)
    }

    /// Makes `factor` times the duration the unit of the powers.
    #[inline(always)]
    fn scale(&mut self, factor: T) {
        self.size = self.size * factor;
        let mut power = T::from(1.0);
        for k in 0..self.order + 1 {
            self.theta[k] = self.theta[k] * power;
            self.x[k] = self.x[k] * power;
            self.q[k] = self.q[k] * power;
            power = power * factor;
        }
        self.forcing.scale(factor);
    }

    /// The highest power of the forces. That of a wave exceeds the order of a short swing.
    #[inline(always)]
    fn force_order(&self) -> usize {
        if self.forcing.terms > 2 { ORDER } else { self.order.min(ORDER) }
    }

    /// The series of N/M and H/M (m/s²) up to a fraction, and their degree.
    #[inline(always)]
    fn force_series(&self, fraction: T, gravity: T) -> (Row<[T; 2]>, usize) {
        let Swing { size, ref x, ref q, ref forcing, .. } = *self;
        let (degree, mut forces) = (self.force_order() - 2, [[T::from(0.0); 2]; DEGREE + 1]);
        let (mut per_second, mut power) = (T::from(1.0) / (size * size), T::from(1.0));
        for (k, force) in forces.iter_mut().enumerate().take(degree + 1) {
            let squares = per_second * PRODUCT[k + 2];
            *force = [q[k + 2] * squares, x[k + 2] * squares + forcing.x[k] * power];
            (per_second, power) = (per_second * fraction, power * fraction);
        }
        forces[0][0] = forces[0][0] + (forcing.z[0] + gravity);
        forces[1][0] = forces[1][0] + forcing.z[1] * fraction;
        (forces, degree)
    }

    /// `[θ, θ̇]` (rad, rad/s) after a fraction of the swing.
    #[inline(always)]
    pub fn at(&self, fraction: T) -> [T; 2] {
        let [theta, slope] = self.theta_at(fraction);
        [theta, slope / self.size]
    }

    /// θ (rad) and its rate of change per swing.
    #[inline(always)]
    pub fn theta_at(&self, fraction: T) -> [T; 2] {
        let (mut theta, mut slope) = (T::from(0.0), T::from(0.0));
        for k in (0..self.order + 1).rev() {
            slope = slope * fraction + theta;
            theta = theta * fraction + self.theta[k];
        }
        [theta, slope]
    }
}

impl<T: Real> Swing<T> {
    /// N/M and H/M (m/s²) up to a fraction of the swing, by the series. At its end they are less accurate than the equations of motion.
    #[inline(always)]
    pub fn forces(&self, fraction: T, gravity: T) -> Pair<T> {
        let (forces, degree) = self.force_series(fraction, gravity);
        Pair::of(forces, degree)
    }

    /// Sets the duration, at most `longest` (s), and the first terms from `[θ, θ̇]`. Returns the square of the duration over the moment of
    /// inertia per mass.
    ///
    /// A swing that begins on the base is little longer than the block would stay up at its present acceleration.
    #[inline(always)]
    fn begin(&mut self, block: &Pivoting<T>, [theta, theta_dot]: [T; 2], longest: T) -> T {
        let (zero, (sin, cos)) = (T::from(0.0), theta.sin_cos());
        let Lever { x, q } = Lever::of(block.offset, block.h, sin, cos);
        let (inertia, forcing) = (x * x + q * q + block.i0, &mut self.forcing);
        let turning = x * (forcing.z[0] + block.gravity) - q * forcing.x[0] + forcing.moment[0];
        let flight = theta_dot * inertia * (-2.0 * OF_FLIGHT) / turning;
        let from_base = T::select_less(zero, flight, least(longest, flight), longest);
        let size = T::select_less(zero, theta.abs(), longest, from_base);
        forcing.scale(size);
        (self.theta[0], self.theta[1]) = (theta, theta_dot * size);
        (self.x[0], self.q[0], self.size) = (x, q, size);
        size * size / inertia
    }

    /// [`Swing::work`], with that of a wave in x if it is one.
    #[inline(always)]
    fn work_beside(&self, of_wave: Option<T>, fraction: T) -> T {
        let Swing { ref theta, ref x, ref q, ref forcing, .. } = *self;
        let of_x = match of_wave {
            Some(work) => work,
            None => self.linear_work([forcing.x[0], forcing.x[1]], x, fraction),
        };
        self.linear_work(forcing.moment, theta, fraction) - self.linear_work(forcing.z, q, fraction) - of_x
    }

    /// The work of a force linear in time on the motion with this series.
    #[inline(always)]
    fn linear_work(&self, [value, rate]: [T; 2], series: &Series<T>, fraction: T) -> T {
        let zero = T::from(0.0);
        if !zero.less(value.abs()).or(zero.less(rate.abs())).any() {
            return zero;
        }
        let [way, moment] = way_and_moment(series, self.order.min(ORDER), fraction);
        value * way + rate * moment
    }

    /// Bounds of the motion over the swing.
    #[inline(always)]
    pub fn bounds(&self, block: &Pivoting<T>) -> Bounds<T> {
        let Swing { size, ref theta, ref x, ref q, ref forcing, .. } = *self;
        let (zero, away) = (T::from(0.0), block.away);
        let per_second = T::from(1.0) / (size * size);
        let mut spread = theta[1].abs() + theta[2].abs();
        let (mut steepest, mut bend) = (theta[2].abs() * 2.0, zero);
        let (mut reaction, mut horizontal) = (zero, zero);
        for k in 3..self.force_order() + 1 {
            let term = theta[k].abs();
            spread = spread + term;
            steepest = steepest + term * NUMBER[k];
            bend = bend + term * PRODUCT[k];
            if k > 3 {
                let squares = per_second * PRODUCT[k];
                reaction = reaction + (q[k] * squares).abs();
                horizontal = horizontal + (x[k] * squares + forcing.x[k - 2]).abs();
            }
        }
        let [last, _] = self.theta_at(T::from(1.0));
        let (first, last) = (theta[0] * away, last * away);
        // If θ̈ points to the base all the time, a block that stands off the base or leaves it comes back at most once.
        let turn = theta[2] * (away * 2.0);
        let (turns_back, turns_away) = ((bend + turn).less(zero), bend.less(turn));
        let turns = turns_back.or(turns_away.except((theta[1] * away).less(zero)));
        let leaves = zero.less(T::select_less(zero, first.abs(), first, theta[1] * away));
        reaction = reaction + (q[3] * (per_second * 6.0) + forcing.z[1]).abs();
        horizontal = horizontal + (x[3] * (per_second * 6.0) + forcing.x[1]).abs();
        let first_reaction = block.gravity + forcing.z[0] + q[2] * (per_second * 2.0);
        let first_horizontal = x[2] * (per_second * 2.0) + forcing.x[0];
        Bounds {
            is_certain: spread.less(first).or(leaves.and(turns)),
            last,
            turns_back,
            is_greatest_at_end: steepest.less(theta[1].abs()).or(turns_away),
            theta: first.abs() + spread,
            reaction: [first_reaction - reaction, first_reaction + reaction],
            horizontal: first_horizontal.abs() + horizontal,
        }
    }

    /// θ (rad), its rate of change per swing, and half of the rate of that.
    #[inline(always)]
    fn curve_at(&self, fraction: T) -> [T; 3] {
        let (mut theta, mut slope, mut half_curvature) = (T::from(0.0), T::from(0.0), T::from(0.0));
        for k in (0..self.order + 1).rev() {
            half_curvature = half_curvature * fraction + slope;
            slope = slope * fraction + theta;
            theta = theta * fraction + self.theta[k];
        }
        [theta, slope, half_curvature]
    }
}

impl Swing {
    /// Makes the swing from `[t, θ, θ̇]` on, at most `longest` (s). The last terms of θ̇ may be `allowed` (rad/s per second of the swing).
    #[inline]
    pub fn of(
        body: &Body,
        corner: Corner,
        excitation: &Excitation,
        [time, theta, theta_dot]: [f64; 3],
        longest: f64,
        allowed: f64,
    ) -> Swing {
        let (none, forcing) = ([0.0; ORDER + 1], excitation.series(time));
        let mut swing = Swing { size: longest, order: 1, theta: none, x: none, q: none, forcing };
        let scale = swing.begin(&Pivoting::of(body, corner), [theta, theta_dot], longest);
        let allowed = allowed * swing.size * swing.size;
        let rest = swing.extend(body.gravity, scale, allowed);
        if rest >= allowed {
            swing.scale(shortening(allowed / rest));
        }
        swing
    }

    /// Adds powers until the [tail](Swing::tail) is below `allowed`, in units of the swing. Returns the tail.
    #[inline]
    fn extend(&mut self, gravity: f64, scale: f64, allowed: f64) -> f64 {
        let weight = self.forcing.z[0] + gravity;
        let mut slope = [0.0; ORDER + 1];
        slope[1] = self.theta[1];
        (self.x[1], self.q[1]) = (slope[1] * self.q[0], -slope[1] * self.x[0]);
        // Pairs, which the compiler adds up as vectors.
        let mut levers = [[0.0; 2]; ORDER + 1];
        levers[0] = [self.q[0], -self.x[0]];
        let mut rest;
        // Written out, so that the loops over products have constant bounds.
        macro_rules! terms {
            ($($n:literal)*) => {
                $({
                    const N: usize = $n;
                    let theta = self.turning(N - 2, weight) * scale * (RECIPROCAL[N - 1] * RECIPROCAL[N]);
                    (self.theta[N], slope[N], self.order) = (theta, theta * NUMBER[N], N);
                    levers[N - 1] = [self.q[N - 1], -self.x[N - 1]];
                    let mut sums = [0.0; 2];
                    for j in 0..N {
                        let (rate, lever) = (slope[j + 1], levers[N - 1 - j]);
                        sums = [sums[0] + rate * lever[0], sums[1] + rate * lever[1]];
                    }
                    (self.x[N], self.q[N]) = (sums[0] * RECIPROCAL[N], sums[1] * RECIPROCAL[N]);
                    rest = self.tail(N, slope[N].abs() + slope[N - 1].abs(), scale);
                    if N >= MIN && rest < allowed {
                        return rest;
                    }
                })*
            };
        }
        terms!(2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
        rest
    }

    /// Work of the excitation per unit mass (m²/s²) over a fraction of the swing. It is the integral of `−a_x u̇ − a_z v̇ + m θ̇`.
    #[inline]
    pub fn work(&self, fraction: f64) -> f64 {
        let of_wave = if self.forcing.terms > 2 { Some(self.work_of_wave(fraction)) } else { None };
        self.work_beside(of_wave, fraction)
    }

    /// `∫ a_x u̇ dt` over a fraction of the swing.
    fn work_of_wave(&self, fraction: f64) -> f64 {
        const SERIES: usize = ORDER + 1;
        let Swing { order, ref x, ref forcing, .. } = *self;
        // The velocity of the centre of mass, with zeros before it: each term of the forcing multiplies the same count of numbers.
        let (mut power, mut velocity) = ([0.0; SERIES + 1], [0.0; 2 * SERIES + 1]);
        for n in 1..order + 1 {
            velocity[SERIES + n] = x[n] * NUMBER[n];
        }
        // Written out, so that the loops have constant bounds.
        macro_rules! terms {
            ($($j:literal)*) => {
                $(for n in $j & !1..SERIES + 1 {
                    power[n] += velocity[SERIES - $j + n] * forcing.x[$j];
                })*
            };
        }
        terms!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15);
        let mut work = 0.0;
        for n in (1..SERIES).rev() {
            work = work * fraction + power[n] * RECIPROCAL[n];
        }
        work * fraction
    }
}

#[cfg(test)]
mod tests;
