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
use crate::block::{Body, Corner, Foot};
use crate::excitation::Excitation;
use crate::numerics::gradient::{Directions, MultiDual};
use crate::numerics::scalar::CombinesWith;
use crate::numerics::wide::{DIRECTIONS, DirectionsTask, Number, Packed, with_directions};

/// The series of δθ in powers of the elapsed fraction of a swing.
pub type TangentSeries<D = [f64; DIRECTIONS]> = [D; ORDER + 1];

/// No derivatives.
pub const NO_TANGENTS: TangentSeries = [[0.0; DIRECTIONS]; ORDER + 1];

impl Swing {
    /// `[θ, θ̇]` (rad, rad/s) after a fraction of the swing, with derivatives. They follow from those of block, excitation and start `[t,
    /// θ, θ̇]`, whose values are those of the swing. The time does not vary. Their series goes to `series`.
    pub fn varied(
        &self,
        body: &Body<Number>,
        corner: Corner,
        excitation: &Excitation<Number>,
        start: [Number; 3],
        fraction: f64,
        mut series: Option<&mut TangentSeries>,
    ) -> [Number; 2] {
        let vary = Vary { swing: self, body, corner, excitation, start, fraction };
        let change = with_directions(Task(vary, series.as_deref_mut()))
            .unwrap_or_else(|| Task(vary, series).run::<[f64; DIRECTIONS]>());
        self.with_derivatives(fraction, change)
    }

    /// `[θ, θ̇]` after a fraction of the swing, with derivatives from the series of [`Swing::varied`].
    pub fn varied_by(&self, series: &TangentSeries, fraction: f64) -> [Number; 2] {
        self.with_derivatives(fraction, sums(series, self.order, fraction, self.size))
    }

    fn with_derivatives(&self, fraction: f64, [change, rate]: [[f64; DIRECTIONS]; 2]) -> [Number; 2] {
        let [theta, theta_dot] = self.at(fraction);
        [Number::new(theta, change), Number::new(theta_dot, rate)]
    }
}

/// `[δθ, δθ̇]` after a fraction of a swing of this order and size (s).
#[inline(always)]
fn sums<D: Directions>(series: &TangentSeries<D>, order: usize, fraction: f64, size: f64) -> [D; 2] {
    let (mut change, mut slope) = (D::zeros(), D::zeros());
    for k in (0..order + 1).rev() {
        slope = slope.times(fraction).plus(change);
        change = change.times(fraction).plus(series[k]);
    }
    [change, slope.times(1.0 / size)]
}

/// The changes of a forcing in powers of the elapsed fraction of a swing.
struct Changes<D> {
    x: [D; ORDER + 1],
    /// The number of those of x that may differ from zero.
    terms: usize,
    z: [D; 2],
    moment: [D; 2],
}

impl<D: Packed> Changes<D>
where
    MultiDual<D>: CombinesWith<Number>,
{
    /// Expands the changes of an excitation over a swing of this size (s). Their series in x has no more than `TERMS` terms.
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "an iterator would put the changes into memory")]
    fn of<const TERMS: usize>(excitation: &Excitation<Number>, time: Number, size: f64) -> Changes<D> {
        let mut forcing = excitation.series::<TERMS, MultiDual<D>>(time.into());
        forcing.scale(size);
        let mut x = [D::zeros(); ORDER + 1];
        for k in 0..TERMS {
            x[k] = forcing.x[k].eps;
        }
        let ([z, z_rate], [moment, moment_rate]) = (forcing.z, forcing.moment);
        Changes { x, terms: forcing.terms, z: [z.eps, z_rate.eps], moment: [moment.eps, moment_rate.eps] }
    }
}

/// A varying swing up to a fraction of it.
#[derive(Clone, Copy)]
struct Vary<'a> {
    swing: &'a Swing,
    body: &'a Body<Number>,
    corner: Corner,
    excitation: &'a Excitation<Number>,
    start: [Number; 3],
    fraction: f64,
}

/// `[δθ, δθ̇]` of a swing that varies; the series goes to the second field.
struct Task<'a>(Vary<'a>, Option<&'a mut TangentSeries>);

impl DirectionsTask for Task<'_> {
    type Output = [[f64; DIRECTIONS]; 2];

    #[inline(always)]
    fn run<D: Packed>(self) -> Self::Output
    where
        MultiDual<D>: CombinesWith<Number>,
    {
        let Task(vary, series) = self;
        let Vary { swing, body, corner, excitation, start: [time, theta, theta_dot], fraction } = vary;
        let Swing { size, order, theta: ref rotation, ref x, ref q, ref forcing } = *swing;
        let (sin, cos) = libm::sincos(rotation[0]);
        let lever = body.lever(Foot::Corner(corner), MultiDual::<D>::from(sin), MultiDual::from(cos));
        let square = lever.x * lever.x + lever.q * lever.q;
        let inertia = square + body.i0;
        let stretch = ((lever.x * x[0] + lever.q * q[0]) * (1.0 / square.re)).eps;
        let turn = ((lever.x * q[0] - lever.q * x[0]) * (1.0 / square.re)).eps;
        let inertia_change = inertia.eps.times(1.0 / inertia.re);
        let varied = if excitation.is_linear() {
            Changes::of::<2>(excitation, time, size)
        } else {
            Changes::of::<{ ORDER + 1 }>(excitation, time, size)
        };
        let gravity = body.gravity;
        let weight = [forcing.z[0] + gravity.re, forcing.z[1]];
        let weights = [varied.z[0].plus(gravity.eps.into()), varied.z[1]];

        let mut stiffness = [0.0; ORDER + 1];
        let mut tangent = [D::zeros(); ORDER + 1];
        (tangent[0], tangent[1]) = (theta.eps.into(), D::from(theta_dot.eps).times(size));
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
            let mut sum = stretch.times(moment).plus(turn.times(stiff)).minus(inertia_change.times(moment));
            sum = sum.plus(weights[0].times(x[k]));
            if k > 0 {
                sum = sum.plus(weights[1].times(x[k - 1]));
            }
            if k < 2 {
                sum = sum.minus(stretch.times(forcing.moment[k])).plus(varied.moment[k]);
            }
            for j in 0..varied.terms.min(k + 1) {
                sum = sum.minus(varied.x[j].times(q[k - j]));
            }
            for j in 0..k + 1 {
                sum = sum.plus(tangent[k - j].times(stiffness[j]));
            }
            tangent[k + 2] = sum.times(scale * RECIPROCAL[k + 1] * RECIPROCAL[k + 2]);
        }
        if let Some(series) = series {
            for k in 0..order + 1 {
                series[k] = tangent[k].into();
            }
        }
        let [change, rate] = sums(&tangent, order, fraction, size);
        [change.into(), rate.into()]
    }
}
