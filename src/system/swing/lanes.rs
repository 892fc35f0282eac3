//! Swings of several blocks at once, one in each lane: the operations of single swings, in their order.
//!
//! The terms of a lane are zero beyond its own order. Zeros change no sum, and where a product with another series would, they are left out.

use std::f64::consts::FRAC_PI_2;

use super::events::{LANDING_ROUNDING, MIN_LANDING};
use super::{MIN, NUMBER, ORDER, Pivoting, RECIPROCAL, Series, Swing, shortening};
use crate::excitation::{Excitation, ForcingSeries};
use crate::numerics::bernstein::{Bernstein, DEGREE, Highest};
use crate::numerics::scalar::{Real, Runs};
use crate::numerics::wide::{Lanes, Simd, Wide};

/// A swing in each lane.
pub struct Swings<V> {
    /// Its `order` is the highest of all lanes.
    pub series: Swing<Wide<V>>,
    /// The order of each lane.
    orders: Wide<V>,
}

/// A term of a series, zero beyond the highest order.
#[inline(always)]
fn term<V: Simd>(series: &Series<Wide<V>>, k: usize) -> Wide<V> {
    if k < ORDER + 1 { series[k] } else { Wide::default() }
}

impl<V: Simd> Swing<Wide<V>> {
    /// The coefficients n of X and Q. They follow from those of θ̇ up to n, and their own up to n − 1.
    #[inline(always)]
    fn lever_terms(&self, n: usize, slope: &Series<Wide<V>>) -> [Wide<V>; 2] {
        let (mut across, mut up) = (Wide::default(), Wide::default());
        let (slopes, xs, qs) = (&slope[1..n + 1], &self.x[..n], &self.q[..n]);
        for j in 0..n {
            across = across + slopes[j] * qs[n - 1 - j];
            up = up - slopes[j] * xs[n - 1 - j];
        }
        [across * RECIPROCAL[n], up * RECIPROCAL[n]]
    }
}

impl<V: Simd> Swings<V> {
    /// Series without terms, under this excitation from `time` (s) on.
    #[inline(always)]
    pub fn under(excitation: &Excitation<Wide<V>>, time: Wide<V>) -> Swings<V> {
        let (none, forcing) = ([Wide::default(); ORDER + 1], excitation.series(time));
        let series = Swing { size: Wide::default(), order: 1, theta: none, x: none, q: none, forcing };
        Swings { series, orders: Wide::default() }
    }

    /// Makes the swings from `[θ, θ̇]` on in place. A copy would cost more than a term. See [`Swing::of`].
    #[inline(always)]
    pub fn make(&mut self, block: &Pivoting<Wide<V>>, start: [Wide<V>; 2], longest: Wide<V>, allowed: Wide<V>) {
        let scale = self.series.begin(block, start, longest);
        let size = self.series.size;
        self.extend(block.gravity, scale, allowed * size * size);
    }

    /// Adds powers, and shortens swings whose error is still too great at the highest one.
    #[inline(always)]
    fn extend(&mut self, gravity: Wide<V>, scale: Wide<V>, allowed: Wide<V>) {
        let Swings { series, orders } = self;
        let zero = Wide::default();
        let weight = series.forcing.z[0] + gravity;
        let mut slope: Series<Wide<V>> = [zero; ORDER + 1];
        slope[1] = series.theta[1];
        (series.x[1], series.q[1]) = (slope[1] * series.q[0], -slope[1] * series.x[0]);
        let mut rest = zero;
        let mut done = zero.less(zero);
        // Written out, so that the loops over products have constant bounds.
        macro_rules! terms {
            ($($n:literal)*) => {
                $({
                    const N: usize = $n;
                    let theta = series.turning(N - 2, weight) * scale * (RECIPROCAL[N - 1] * RECIPROCAL[N]);
                    // A lane that is done gets no further terms.
                    series.theta[N] = done.choose(zero, theta);
                    slope[N] = series.theta[N] * NUMBER[N];
                    let [x, q] = series.lever_terms(N, &slope);
                    (series.x[N], series.q[N]) = (done.choose(zero, x), done.choose(zero, q));
                    series.order = N;
                    *orders = done.choose(*orders, Wide::from(N as f64));
                    if N >= MIN {
                        rest = done.choose(rest, series.tail(N, slope[N].abs() + slope[N - 1].abs(), scale));
                        done = done.or(rest.less(allowed));
                        if done.all() {
                            return;
                        }
                    }
                })*
            };
        }
        terms!(2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
        series.scale(done.choose(Wide::from(1.0), shortening(allowed / rest)));
    }

    /// The lanes without and with a landing, and the fractions of the landings. See [`Swing::first_landing`].
    #[inline(always)]
    pub fn first_landing(&self, lanes: Lanes<V>, away: Wide<V>) -> (Lanes<V>, Lanes<V>, Wide<V>) {
        let Swing { order, ref theta, .. } = self.series;
        let zero = Wide::default();
        let (stands_off, rises) = (zero.less(theta[0].abs()), zero.less(theta[1].abs()));
        let turns = (theta[3] * away * LANDING_ROUNDING).less(theta[2].abs());
        let mut rotation = [zero; DEGREE + 1];
        for k in 0..order.min(ORDER) + 1 {
            // Zeros at the beginning are divided out.
            let from_rest = turns.choose(term(theta, k + 2), term(theta, k + 3));
            rotation[k] = stands_off.choose(theta[k], rises.choose(term(theta, k + 1), from_rest)) * away;
        }
        let moves = stands_off.or(rises);
        let rotation = Bernstein::of(rotation, order);
        let stays = lanes.and(rotation.is_positive());
        let others = lanes.except(stays);
        let (fraction, lands) = rotation.only_zero(others);
        let is_early = fraction.less(Wide::from(MIN_LANDING)).and(lands.except(moves));
        (stays, lands.except(is_early), fraction)
    }

    /// Finds the lanes that exclude a quarter turn, as [`Swing::quarter_turn`] does.
    #[inline(always)]
    pub fn excludes_quarter_turn(&self, away: Wide<V>) -> Lanes<V> {
        let Swing { order, ref theta, .. } = self.series;
        let mut rest = [Wide::default(); DEGREE + 1];
        for k in 0..order.min(ORDER) + 1 {
            rest[k] = theta[k] * -away;
        }
        rest[0] = rest[0] + FRAC_PI_2;
        Bernstein::of(rest, order).is_positive()
    }

    /// The greatest rotation (rad) inside, and the lanes in which it is known. It lies before a fraction of the swing, and is 0 unless it
    /// exceeds `most` and both ends. See [`Swing::highest`].
    #[inline(always)]
    pub fn highest(&self, lanes: Lanes<V>, away: Wide<V>, fraction: Wide<V>, most: Wide<V>) -> (Wide<V>, Lanes<V>) {
        let Swing { order, ref theta, .. } = self.series;
        let (mut rotation, mut power) = ([Wide::default(); DEGREE + 1], away);
        for k in 0..order.min(ORDER) + 1 {
            rotation[k] = theta[k] * power;
            power = power * fraction;
        }
        let Highest { place, exceeds, known } = Bernstein::of(rotation, order).highest_in_lanes(lanes, most);
        let [theta, _] = self.series.theta_at(place * fraction);
        (exceeds.choose(theta.abs(), Wide::default()), known)
    }

    /// See [`Swing::work`].
    #[inline(always)]
    pub fn work(&self, fraction: Wide<V>) -> Wide<V> {
        let of_wave = if self.series.forcing.terms > 2 { Some(self.work_of_wave(fraction)) } else { None };
        self.series.work_beside(of_wave, fraction)
    }

    /// See [`Swing::work_of_wave`], which has the same sums.
    #[inline(always)]
    fn work_of_wave(&self, fraction: Wide<V>) -> Wide<V> {
        let Swing { order, ref x, ref forcing, .. } = self.series;
        let mut velocity: Series<Wide<V>> = [Wide::default(); ORDER + 1];
        for n in 1..order.min(ORDER) + 1 {
            velocity[n] = x[n] * NUMBER[n];
        }
        let mut work = Wide::default();
        // Written out, so that the loops have constant bounds.
        macro_rules! terms {
            ($($n:literal)*) => {
                $({
                    let mut power = Wide::default();
                    for j in 0..$n {
                        power = power + velocity[$n - j] * forcing.x[j];
                    }
                    work = work * fraction + power * RECIPROCAL[$n];
                })*
            };
        }
        terms!(16 15 14 13 12 11 10 9 8 7 6 5 4 3 2 1);
        work * fraction
    }

    /// The swing of one lane.
    #[inline(always)]
    pub fn of_lane(&self, lane: usize) -> Swing {
        let Swing { size, ref theta, ref x, ref q, ref forcing, .. } = self.series;
        let mut swing = Swing {
            size: size.of_lane(lane),
            order: self.orders.of_lane(lane) as usize,
            theta: [0.0; ORDER + 1],
            x: [0.0; ORDER + 1],
            q: [0.0; ORDER + 1],
            forcing: ForcingSeries {
                x: [0.0; ORDER + 1],
                terms: forcing.terms,
                z: [forcing.z[0].of_lane(lane), forcing.z[1].of_lane(lane)],
                moment: [forcing.moment[0].of_lane(lane), forcing.moment[1].of_lane(lane)],
            },
        };
        for k in 0..swing.order + 1 {
            swing.theta[k] = theta[k].of_lane(lane);
            swing.x[k] = x[k].of_lane(lane);
            swing.q[k] = q[k].of_lane(lane);
        }
        for k in 0..forcing.terms {
            swing.forcing.x[k] = forcing.x[k].of_lane(lane);
        }
        swing
    }
}
