//! State, regime and excitation of an instant → accelerations, reactions, energy.
//!
//! The vertical coordinate of the state, `w`, is the height of what stands: of the touching corner, of the middle of
//! the base in full contact, of the centre of mass in flight. So the spring forces come from a number that is itself
//! small, and the difference of `v` and `R0 [cos α − cos(α ± θ)]`, which cancels, is never formed.
//!
//! Within this module forces and energies are per unit of the block's mass; with `δ_s = g/ω_v²`, one support gives
//! `N/M = g/2 − ω_v² v_I/2 − ξ_v ω_v v̇_I`, eq. (8).

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::contact::{Corner, Regime};
use crate::dual::{Dual, Dual64};
use crate::excitation::Forcing;
use crate::numerics;
use crate::scalar::{Beside, Elementary, Real, Scalar};

/// `[θ, θ̇, w, ẇ]` in rad, rad/s, m, m/s; θ positive clockwise (the block tilts to the right), w positive up.
pub type State = numerics::State;

/// Powers that are integrated along (m²/s³): of the excitation, and of the dashpots (positive when they take energy).
pub type Powers = numerics::Quadratures;

/// Everything that the equations of motion say of one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant<T> {
    /// Rotation θ (rad).
    pub theta: T,
    /// θ̇ (rad/s).
    pub theta_dot: T,
    /// θ̈ (rad/s²).
    pub theta_ddot: T,
    /// ẇ (m/s).
    pub w_dot: T,
    /// ẅ (m/s²).
    pub w_ddot: T,
    /// Horizontal place of the centre of mass over the middle of the base (m), positive to the right.
    pub u: T,
    /// u̇ relative to the ground (m/s).
    pub u_dot: T,
    /// ü (m/s²).
    pub u_ddot: T,
    /// Height v of the centre of mass above its place at rest (m).
    pub v: T,
    /// v̇ (m/s).
    pub v_dot: T,
    /// v̈ (m/s²).
    pub v_ddot: T,
    /// Heights of the corners L and R above their places at rest (m).
    pub corner: [T; 2],
    /// Their rates (m/s).
    pub corner_dot: [T; 2],
    /// Their accelerations (m/s²).
    pub corner_ddot: [T; 2],
    /// Vertical reactions N_L/M, N_R/M (m/s²), positive up.
    pub reaction: [T; 2],
    /// Horizontal reaction H/M on the block (m/s²), positive to the right.
    pub horizontal: T,
}

/// What holds the block horizontally.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Footing<T> {
    /// What touches does not slide: the middle of the base in full contact, the corner on one corner.
    Grips {
        /// How far the block has moved to the right since the start (m), by flights and slides.
        offset: T,
    },
    /// Nothing: in flight, and where a support bears the block again but does not grip it yet.
    Free {
        /// Horizontal place of the centre of mass over where the middle of the base was at the start (m).
        u: T,
        /// u̇ relative to the ground (m/s).
        u_dot: T,
    },
}

impl<T> Footing<T> {
    /// The same with each number changed by `f`.
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Footing<U> {
        match self {
            Footing::Grips { offset } => Footing::Grips { offset: f(offset) },
            Footing::Free { u, u_dot } => Footing::Free { u: f(u), u_dot: f(u_dot) },
        }
    }

    /// Whether what touches does not slide.
    pub fn grips(&self) -> bool {
        matches!(self, Footing::Grips { .. })
    }
}

impl Footing<f64> {
    /// A block that has not moved from its place.
    pub const AT_START: Footing<f64> = Footing::Grips { offset: 0.0 };

    /// Both numbers finite.
    pub fn is_finite(&self) -> bool {
        match *self {
            Footing::Grips { offset } => offset.is_finite(),
            Footing::Free { u, u_dot } => u.is_finite() && u_dot.is_finite(),
        }
    }

    /// Work of the horizontal forcing, per unit mass (m²/s²), until the footing is `after`, while nothing holds the block: there
    /// `ü = −a_x`, and `∫ −a_x u̇ dt = Δ(u̇²)/2`. Zero while the block grips.
    pub fn free_work(&self, after: &Footing<f64>) -> f64 {
        match (self, after) {
            (Footing::Free { u_dot: from, .. }, Footing::Free { u_dot: to, .. }) => 0.5 * (to - from) * (to + from),
            (Footing::Grips { .. }, _) | (_, Footing::Grips { .. }) => 0.0,
        }
    }
}

/// The equations of motion at one instant.
///
/// The excitation may be that of any smooth piece; see [`Forcing`] for signs.
#[inline]
pub fn instant<P: Scalar, T: Beside<P>>(
    block: &Block<P>,
    regime: Regime,
    state: [T; 4],
    footing: Footing<T>,
    forcing: Forcing<T>,
) -> Instant<T> {
    instant_of(block, block.foundation, regime, state, footing, forcing, |x| x)
}

/// What `pick` takes of [`instant`]: only that is computed, since it is inlined into the equations of each regime. Of a
/// `foundation` (that of the block) and a `regime` that the compiler knows only their equations are left.
#[inline(always)]
pub fn instant_of<P: Scalar, T: Beside<P>, R>(
    block: &Block<P>,
    foundation: Foundation,
    regime: Regime,
    state: [T; 4],
    footing: Footing<T>,
    forcing: Forcing<T>,
    pick: impl Fn(Instant<T>) -> R,
) -> R {
    let posture = Posture::new(block, state, footing);
    match (regime, foundation) {
        (Regime::FullContact, Foundation::Viscoelastic) => pick(posture.full_contact(forcing)),
        (Regime::FullContact, Foundation::Rigid) => pick(posture.at_rest(forcing)),
        (Regime::TiltingLeft, Foundation::Viscoelastic) => pick(posture.on_support(Corner::Left, forcing)),
        (Regime::TiltingRight, Foundation::Viscoelastic) => pick(posture.on_support(Corner::Right, forcing)),
        (Regime::TiltingLeft, Foundation::Rigid) => pick(posture.on_rigid_base(Corner::Left, forcing)),
        (Regime::TiltingRight, Foundation::Rigid) => pick(posture.on_rigid_base(Corner::Right, forcing)),
        (Regime::Separated, _) => pick(posture.in_flight(forcing)),
    }
}

/// The equations of motion at an instant `x` with, in the dual parts, the exact rates of change along the motion while the
/// forcing changes as its dual parts say.
pub fn along(
    block: &Block,
    regime: Regime,
    state: &State,
    footing: Footing<f64>,
    x: &Instant<f64>,
    forcing: Forcing<Dual64>,
) -> Instant<Dual64> {
    along_of(block, regime, state.0, footing, x, forcing)
}

/// The same of any numbers, inlined into the equations of a `regime` that the compiler knows.
#[inline(always)]
pub fn along_of<R: Real>(
    block: &Block<R>,
    regime: Regime,
    [_, _, w, _]: [R; 4],
    footing: Footing<R>,
    x: &Instant<R>,
    forcing: Forcing<Dual<R>>,
) -> Instant<Dual<R>>
where
    Dual<R>: Beside<R>,
{
    let state = [
        Dual::new(x.theta, x.theta_dot),
        Dual::new(x.theta_dot, x.theta_ddot),
        Dual::new(w, x.w_dot),
        Dual::new(x.w_dot, x.w_ddot),
    ];
    let footing = match footing {
        Footing::Grips { offset } => Footing::Grips { offset: Dual::new(offset, R::default()) },
        Footing::Free { u, u_dot } => Footing::Free { u: Dual::new(u, u_dot), u_dot: Dual::new(u_dot, x.u_ddot) },
    };
    instant_of(block, block.foundation, regime, state, footing, forcing, |x| x)
}

/// The state with its sine and cosine.
pub(super) struct Posture<'a, P, T> {
    pub(super) block: &'a Block<P>,
    pub(super) theta: T,
    pub(super) theta_dot: T,
    pub(super) w: T,
    pub(super) w_dot: T,
    pub(super) sin: T,
    pub(super) cos: T,
    pub(super) footing: Footing<T>,
}

/// Place, rate and acceleration of the centre of mass, and the reaction per mass.
pub(super) struct Horizontal<T> {
    pub(super) u: T,
    pub(super) u_dot: T,
    pub(super) u_ddot: T,
    pub(super) reaction: T,
}

impl<'a, P: Scalar, T: Beside<P>> Posture<'a, P, T> {
    #[inline(always)]
    pub(super) fn new(
        block: &'a Block<P>,
        [theta, theta_dot, w, w_dot]: [T; 4],
        footing: Footing<T>,
    ) -> Posture<'a, P, T> {
        let (sin, cos) = theta.sin_cos();
        Posture { block, theta, theta_dot, w, w_dot, sin, cos, footing }
    }

    /// θ̈ from the moments per mass about the centre of mass: of the loads, of the vertical reactions, and of H/M, which
    /// acts `arm` below. A foot that grips moves the centre of mass by `ü = arm θ̈ − centripetal`.
    #[inline(always)]
    fn turning(&self, arm: T, centripetal: T, vertical: T, forcing: Forcing<T>) -> T {
        match self.footing {
            Footing::Grips { .. } => {
                (-(arm * (forcing.x - centripetal)) + vertical + forcing.moment) / (arm * arm + self.block.i0)
            }
            Footing::Free { .. } => (vertical + forcing.moment) * T::from(P::from(1.0) / self.block.i0),
        }
    }

    /// Horizontal motion, given that of a foot that grips at its first place.
    #[inline(always)]
    pub(super) fn horizontal(&self, u: T, u_dot: T, u_ddot: T, forcing: Forcing<T>) -> Horizontal<T> {
        match self.footing {
            Footing::Grips { offset } => Horizontal { u: u + offset, u_dot, u_ddot, reaction: u_ddot + forcing.x },
            Footing::Free { u, u_dot } => Horizontal { u, u_dot, u_ddot: -forcing.x, reaction: T::from(0.0) },
        }
    }

    /// `1 − cos θ` without cancellation.
    #[inline(always)]
    pub(super) fn versine(&self) -> T {
        self.sin * self.sin / (self.cos + 1.0)
    }

    /// Reaction of one support per mass, from its corner's height and rate; eq. (8).
    #[inline(always)]
    pub(super) fn support(&self, height: T, rate: T) -> T {
        let Block { gravity, omega_v, xi_v, .. } = *self.block;
        -(height * (omega_v * 0.5 * omega_v)) - rate * (xi_v * omega_v) + gravity * 0.5
    }

    /// Heights of the corners, their rates and their accelerations, from those of the middle of the base, b from either.
    #[inline(always)]
    pub(super) fn corners(&self, [middle, middle_dot, middle_ddot]: [T; 3], theta_ddot: T) -> [[T; 2]; 3] {
        let Posture { theta_dot, sin, cos, .. } = *self;
        let b = self.block.b;
        let (tilt, tilt_dot) = (sin * b, cos * theta_dot * b);
        let tilt_ddot = (cos * theta_ddot - sin * theta_dot * theta_dot) * b;
        [
            [middle + tilt, middle - tilt],
            [middle_dot + tilt_dot, middle_dot - tilt_dot],
            [middle_ddot + tilt_ddot, middle_ddot - tilt_ddot],
        ]
    }

    /// Eqs. (7)–(10): both corners touch; w is the height of the middle of the base.
    #[inline(always)]
    fn full_contact(&self, forcing: Forcing<T>) -> Instant<T> {
        let Posture { block, theta, theta_dot, w, w_dot, sin, cos, .. } = *self;
        let Block { b, h, gravity, omega_v, xi_v, .. } = *block;
        let (omega2, damping) = (omega_v * omega_v, xi_v * 2.0 * omega_v);
        let tilt = sin * b;
        let tilt_dot = cos * theta_dot * b;
        // v̈ + a_gz = (N_L + N_R)/M − g, and the couple of the supports: N_L − N_R.
        let rise = -(w * omega2) - w_dot * damping;
        let sum = rise + gravity;
        let difference = -(tilt * omega2) - tilt_dot * damping;
        let arm = cos * h;
        let centripetal = sin * theta_dot * theta_dot * h;
        let theta_ddot = self.turning(arm, centripetal, cos * difference * b + sin * sum * h, forcing);
        let v_ddot = rise - forcing.z;
        let along = self.horizontal(sin * h, arm * theta_dot, arm * theta_ddot - centripetal, forcing);
        let w_ddot = v_ddot + sin * theta_ddot * h + cos * theta_dot * theta_dot * h;
        let [corner, corner_dot, corner_ddot] = self.corners([w, w_dot, w_ddot], theta_ddot);
        Instant {
            theta,
            theta_dot,
            theta_ddot,
            w_dot,
            w_ddot,
            u: along.u,
            u_dot: along.u_dot,
            u_ddot: along.u_ddot,
            v: w - self.versine() * h,
            v_dot: w_dot - sin * theta_dot * h,
            v_ddot,
            corner,
            corner_dot,
            corner_ddot,
            reaction: [self.support(corner[0], corner_dot[0]), self.support(corner[1], corner_dot[1])],
            horizontal: along.reaction,
        }
    }

    /// Eqs. (11)–(13): one corner touches; w is its height.
    #[inline(always)]
    fn on_support(&self, corner: Corner, forcing: Forcing<T>) -> Instant<T> {
        let s = corner.sign();
        let (reach, height) = (self.reach(s), self.height(s));
        let n = self.support(self.w, self.w_dot);
        let theta_dot2 = self.theta_dot * self.theta_dot;
        let theta_ddot = self.turning(height, reach * theta_dot2 * s, reach * n * s, forcing);
        let v_ddot = n - self.block.gravity - forcing.z;
        let w_ddot = v_ddot + reach * theta_ddot * s + height * theta_dot2;
        self.about(corner, theta_ddot, w_ddot, v_ddot, n, forcing)
    }

    /// No corner touches; w = v.
    #[inline(always)]
    fn in_flight(&self, forcing: Forcing<T>) -> Instant<T> {
        let Posture { block, theta, theta_dot, w, w_dot, sin, cos, .. } = *self;
        let Block { h, i0, gravity, .. } = *block;
        let zero = T::from(0.0);
        let theta_ddot = forcing.moment * T::from(P::from(1.0) / i0);
        let v_ddot = -forcing.z - gravity;
        let (middle, middle_dot) = (w + self.versine() * h, w_dot + sin * theta_dot * h);
        let middle_ddot = v_ddot + (sin * theta_ddot + cos * theta_dot * theta_dot) * h;
        let along = self.horizontal(sin * h, cos * theta_dot * h, -forcing.x, forcing);
        let [corner, corner_dot, corner_ddot] = self.corners([middle, middle_dot, middle_ddot], theta_ddot);
        Instant {
            theta,
            theta_dot,
            theta_ddot,
            w_dot,
            w_ddot: v_ddot,
            u: along.u,
            u_dot: along.u_dot,
            u_ddot: along.u_ddot,
            v: w,
            v_dot: w_dot,
            v_ddot,
            corner,
            corner_dot,
            corner_ddot,
            reaction: [zero; 2],
            horizontal: zero,
        }
    }

    /// `R0 sin φ`, `φ = α + sθ`: horizontal distance from corner to centre of mass (m).
    #[inline(always)]
    pub(super) fn reach(&self, s: f64) -> T {
        self.cos * self.block.b + self.sin * (self.block.h * s)
    }

    /// `R0 cos φ`: height of the centre of mass over the corner (m).
    #[inline(always)]
    pub(super) fn height(&self, s: f64) -> T {
        self.cos * self.block.h - self.sin * (self.block.b * s)
    }

    /// Kinematics of the block about its one standing corner.
    #[inline(always)]
    pub(super) fn about(
        &self,
        corner: Corner,
        theta_ddot: T,
        w_ddot: T,
        v_ddot: T,
        n: T,
        forcing: Forcing<T>,
    ) -> Instant<T> {
        let Posture { block, theta, theta_dot, w, w_dot, sin, cos, .. } = *self;
        let Block { b, h, .. } = *block;
        let s = corner.sign();
        let (reach, height) = (self.reach(s), self.height(s));
        let along = self.horizontal(
            sin * h - self.versine() * (b * s),
            height * theta_dot,
            height * theta_ddot - reach * theta_dot * theta_dot * s,
            forcing,
        );
        let across = b * (2.0 * s);
        let standing = |pair: [T; 2]| match corner {
            Corner::Left => pair,
            Corner::Right => [pair[1], pair[0]],
        };
        Instant {
            theta,
            theta_dot,
            theta_ddot,
            w_dot,
            w_ddot,
            u: along.u,
            u_dot: along.u_dot,
            u_ddot: along.u_ddot,
            v: w - self.versine() * h - sin * (b * s),
            v_dot: w_dot - reach * theta_dot * s,
            v_ddot,
            corner: standing([w, w - sin * across]),
            corner_dot: standing([w_dot, w_dot - cos * theta_dot * across]),
            corner_ddot: standing([w_ddot, w_ddot - (cos * theta_ddot - sin * theta_dot * theta_dot) * across]),
            reaction: standing([n, T::from(0.0)]),
            horizontal: along.reaction,
        }
    }
}

impl<T: Scalar> Instant<T> {
    /// Powers of the excitation and of the dashpots per unit mass (m²/s³); the first is `−a_gx u̇ − a_gz v̇` with the
    /// loads' work in it.
    #[inline(always)]
    pub fn powers<P: Scalar>(&self, block: &Block<P>, regime: Regime, forcing: Forcing<T>) -> [T; 2]
    where
        T: Beside<P>,
    {
        let input = forcing.moment * self.theta_dot - forcing.x * self.u_dot - forcing.z * self.v_dot;
        let [left, right] = self.corner_dot;
        let squares = match regime {
            Regime::FullContact => left * left + right * right,
            Regime::TiltingLeft => left * left,
            Regime::TiltingRight => right * right,
            Regime::Separated => T::from(0.0),
        };
        [input, squares * (block.xi_v * block.omega_v)]
    }
}

/// `[w, ẇ]`, height (m) and rate (m/s) of what stands, from `[θ, θ̇, v, v̇]`; zeros on the rigid base, which does not give way.
pub fn height_of_what_stands<T: Elementary>(
    block: &Block,
    regime: Regime,
    [theta, theta_dot, v, v_dot]: [T; 4],
) -> [T; 2] {
    let Block { b, h, .. } = *block;
    let (sin, cos) = theta.sin_cos();
    let (middle, middle_dot) = (v + sin * sin / (cos + 1.0) * h, v_dot + sin * theta_dot * h);
    match (block.foundation, regime) {
        (_, Regime::Separated) => [v, v_dot],
        (Foundation::Rigid, _) => [T::from(0.0); 2],
        (Foundation::Viscoelastic, Regime::FullContact) => [middle, middle_dot],
        (Foundation::Viscoelastic, Regime::TiltingLeft) => [middle + sin * b, middle_dot + cos * theta_dot * b],
        (Foundation::Viscoelastic, Regime::TiltingRight) => [middle - sin * b, middle_dot - cos * theta_dot * b],
    }
}

/// Energy per unit mass (m²/s²): kinetic, and potential of weight and touching springs; zero at rest.
///
/// `E = ½ I0 θ̇² + ½ M (u̇² + v̇²) + M g v + ½ K Σ_touching (δ_s − v_I)² − ½ M g δ_s`, with the terms that cancel at rest
/// taken together.
pub fn energy<P: Elementary, T: Beside<P>>(block: &Block<P>, regime: Regime, x: &Instant<T>) -> (T, T) {
    let Block { b, h, i0, gravity, omega_v, .. } = *block;
    let kinetic = (x.theta_dot * x.theta_dot * i0 + x.u_dot * x.u_dot + x.v_dot * x.v_dot) * 0.5;
    let (sin, cos) = x.theta.sin_cos();
    let sunk = sin * sin / (cos + 1.0) * h;
    let omega2 = omega_v * omega_v;
    let springs = |height: T| height * height * (omega2 * 0.25);
    let rest = gravity * 0.25 * block.static_deflection();
    let potential = match (block.foundation, regime) {
        (Foundation::Rigid, _) => x.v * gravity,
        (Foundation::Viscoelastic, Regime::FullContact) => springs(x.corner[0]) + springs(x.corner[1]) - sunk * gravity,
        (Foundation::Viscoelastic, Regime::TiltingLeft) => {
            springs(x.corner[0]) + x.corner[0] * (gravity * 0.5) - (sunk + sin * b) * gravity - rest
        }
        (Foundation::Viscoelastic, Regime::TiltingRight) => {
            springs(x.corner[1]) + x.corner[1] * (gravity * 0.5) - (sunk - sin * b) * gravity - rest
        }
        (Foundation::Viscoelastic, Regime::Separated) => x.v * gravity - rest * 2.0,
    };
    (kinetic, potential)
}
