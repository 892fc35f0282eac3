//! A swing → its derivatives in several directions, by the series of its tangent equation.
//!
//! With the moment `M = X (g + a_z) − Q a_x + m` of Housner's equation, the inertia `I = I0/M + X² + Q²`, and `dX/dθ = Q`, `dQ/dθ = −X`,
//! the rotation changes in a direction by
//!
//! ```text
//! I δθ̈ = S δθ + δM − δI θ̈        S = Q (g + a_z) + X a_x
//! ```
//!
//! where δM is the change of M at constant θ. A change of the lever stretches and turns it, `δX = a X + b Q` and `δQ = a Q − b X` with
//! constants a and b, so that
//!
//! ```text
//! δM = a (M − m) + b S + X δ(g + a_z) − Q δa_x + δm
//! ```
//!
//! Equal powers of τ give the coefficients of δθ from the series of the swing. S is the same for all directions, so each of them
//! takes one sum of products per power, or two where it changes a pulse.

use super::{ORDER, RECIPROCAL, Swing};
use crate::block::{Block, Corner, Foot};
use crate::excitation::Excitation;
use crate::numerics::gradient::Gradient;
use crate::numerics::numbers::Numbers;
use crate::numerics::wide::{PlainTask, vectorized};

/// A swing with its derivatives in N directions.
#[derive(Clone, Copy, Debug)]
pub struct Tangents<'a, const N: usize> {
    swing: &'a Swing,
    /// The series of δθ in powers of the elapsed part.
    series: [Numbers<f64, N>; ORDER + 1],
}

impl Swing {
    /// The derivatives of the swing, from those of block, excitation and start `[t, θ, θ̇]`, whose values are those of the swing. The
    /// time does not vary.
    pub fn tangents<const N: usize>(
        &self,
        block: &Block<Gradient<N>>,
        corner: Corner,
        excitation: &Excitation<Gradient<N>>,
        start: [Gradient<N>; 3],
    ) -> Tangents<'_, N> {
        Tangents { swing: self, series: vectorized(Vary { swing: self, block, corner, excitation, start }) }
    }
}

/// A swing that varies.
struct Vary<'a, const N: usize> {
    swing: &'a Swing,
    block: &'a Block<Gradient<N>>,
    corner: Corner,
    excitation: &'a Excitation<Gradient<N>>,
    start: [Gradient<N>; 3],
}

impl<const N: usize> PlainTask for Vary<'_, N> {
    type Output = [Numbers<f64, N>; ORDER + 1];

    #[inline(always)]
    fn run(self) -> [Numbers<f64, N>; ORDER + 1] {
        let Vary { swing, block, corner, excitation, start: [time, theta, theta_dot] } = self;
        let Swing { size, order, theta: ref rotation, ref x, ref q, ref forcing } = *swing;
        let (sin, cos) = libm::sincos(rotation[0]);
        let lever = block.lever(Foot::Corner(corner), Gradient::from(sin), Gradient::from(cos));
        let square = lever.x * lever.x + lever.q * lever.q;
        let inertia = square + block.i0;
        let stretch = Numbers(((lever.x * x[0] + lever.q * q[0]) * (1.0 / square.re)).eps);
        let turn = Numbers(((lever.x * q[0] - lever.q * x[0]) * (1.0 / square.re)).eps);
        let inertia_change = Numbers((inertia * (1.0 / inertia.re)).eps);
        let mut varied = excitation.series::<{ ORDER + 1 }>(time);
        varied.scale(size);
        // Coefficients of a_x that vary.
        let varies = |term: &Gradient<N>| term.eps.iter().any(|eps| *eps != 0.0);
        let terms = varied.x[..varied.terms].iter().rposition(varies).map_or(0, |last| last + 1);
        let gravity = block.gravity;
        let (weight, weights) = ([forcing.z[0] + gravity.re, forcing.z[1]], [varied.z[0] + gravity, varied.z[1]]);

        let mut stiffness = [0.0; ORDER + 1];
        let mut tangent = [Numbers::zeros(); ORDER + 1];
        (tangent[0], tangent[1]) = (Numbers(theta.eps), Numbers(theta_dot.eps) * size);
        let (scale, to_moment) = (size * size / inertia.re, inertia.re / (size * size));
        for k in 0..order - 1 {
            let mut stiff = q[k] * weight[0];
            if k > 0 {
                stiff += q[k - 1] * weight[1];
            }
            for j in 0..forcing.terms.min(k + 1) {
                stiff += x[k - j] * forcing.x[j];
            }
            stiffness[k] = stiff;
            let moment = rotation[k + 2] * (to_moment * ((k + 1) * (k + 2)) as f64);
            let mut sum = stretch * moment + turn * stiff - inertia_change * moment + Numbers(weights[0].eps) * x[k];
            if k > 0 {
                sum = sum + Numbers(weights[1].eps) * x[k - 1];
            }
            if k < 2 {
                sum = sum - stretch * forcing.moment[k] + Numbers(varied.moment[k].eps);
            }
            for j in 0..terms.min(k + 1) {
                sum = sum - Numbers(varied.x[j].eps) * q[k - j];
            }
            for j in 0..k + 1 {
                sum = sum + tangent[k - j] * stiffness[j];
            }
            tangent[k + 2] = sum * (scale * RECIPROCAL[k + 1] * RECIPROCAL[k + 2]);
        }
        tangent
    }
}

impl<const N: usize> Tangents<'_, N> {
    /// `[θ, θ̇]` (rad, rad/s) after a part of the swing.
    pub fn at(&self, part: f64) -> [Gradient<N>; 2] {
        let (mut change, mut slope) = (Numbers::zeros(), Numbers::zeros());
        for k in (0..self.swing.order + 1).rev() {
            slope = slope * part + change;
            change = change * part + self.series[k];
        }
        let [theta, theta_dot] = self.swing.at(part);
        [Gradient::new(theta, change.0), Gradient::new(theta_dot, (slope * (1.0 / self.swing.size)).0)]
    }
}
