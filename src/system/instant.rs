//! The quantities of one instant: the state, the horizontal hold, a held corner, and the motion that follows from them.

use serde::{Deserialize, Serialize};

use crate::block::restraints::States;
use crate::block::{Body, Contacts, Corner, Kinematics, Regime, StandingSlide};
use crate::numerics;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{Real, Scalar};

/// The state `[θ, θ̇, w, ẇ]` in rad, rad/s, m, m/s. The rotation θ is positive clockwise (the block tilts to the right), w positive up.
pub use crate::numerics::State;

/// Powers integrated beside the state (m²/s³): of the excitation, and dissipated by the dashpots.
pub type Powers = numerics::Quadratures;

/// The equations of motion, solved at one instant.
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
    /// Horizontal displacement of the centre of mass (m), positive to the right. It is measured from the position above the middle of the
    /// base.
    pub u: T,
    /// u̇ relative to the ground (m/s).
    pub u_dot: T,
    /// ü (m/s²).
    pub u_ddot: T,
    /// Height v of the centre of mass above its position at rest (m).
    pub v: T,
    /// v̇ (m/s).
    pub v_dot: T,
    /// v̈ (m/s²).
    pub v_ddot: T,
    /// Heights of the corners L and R above their positions at rest (m).
    pub corner: [T; 2],
    /// Their rates (m/s).
    pub corner_dot: [T; 2],
    /// Their accelerations (m/s²).
    pub corner_ddot: [T; 2],
    /// Vertical reactions N_L/M, N_R/M (m/s²), positive up.
    pub reaction: [T; 2],
    /// Horizontal reaction H/M on the block (m/s²), positive to the right.
    pub horizontal: T,
    /// Velocity of the foot (m/s), positive to the right. Zero where it grips, and in flight.
    pub slip_rate: T,
    /// Power per mass that friction dissipates (m²/s³).
    pub friction_power: T,
}

impl<T: Scalar> Kinematics<T> {
    /// Returns position and motion of the block at an instant.
    #[inline(always)]
    pub fn of(x: &Instant<T>) -> Kinematics<T> {
        let (sin, cos) = x.theta.sin_cos();
        Kinematics { sin_cos: [sin, cos], theta_dot: x.theta_dot, center: [x.u, x.v], velocity: [x.u_dot, x.v_dot] }
    }
}

/// The horizontal hold of the block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Footing<T> {
    /// The foot does not slide.
    Grips {
        /// Displacement of the foot to the right since the start (m), by flights and slides.
        offset: T,
    },
    /// No hold: in flight, and on a support that does not grip yet.
    Free {
        /// Horizontal displacement of the centre of mass since the start (m).
        u: T,
        /// u̇ relative to the ground (m/s).
        u_dot: T,
    },
    /// Friction: the foot slides.
    Slides {
        /// Horizontal displacement of the centre of mass since the start (m).
        u: T,
        /// u̇ relative to the ground (m/s).
        u_dot: T,
        /// The sign of the foot's velocity: +1 to the right, −1 to the left.
        direction: f64,
    },
}

impl<T> Footing<T> {
    /// Returns the footing with each number converted by `f`.
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Footing<U> {
        match self {
            Footing::Grips { offset } => Footing::Grips { offset: f(offset) },
            Footing::Free { u, u_dot } => Footing::Free { u: f(u), u_dot: f(u_dot) },
            Footing::Slides { u, u_dot, direction } => Footing::Slides { u: f(u), u_dot: f(u_dot), direction },
        }
    }

    /// Returns the footing with its rates along the motion in the dual parts.
    #[inline(always)]
    pub fn with_rates(self, x: &Instant<T>) -> Footing<Dual<T>>
    where
        T: Scalar,
    {
        match self {
            Footing::Grips { offset } => Footing::Grips { offset: Dual::new(offset, T::default()) },
            Footing::Free { u, u_dot } => Footing::Free { u: Dual::new(u, u_dot), u_dot: Dual::new(u_dot, x.u_ddot) },
            Footing::Slides { u, u_dot, direction } => {
                Footing::Slides { u: Dual::new(u, u_dot), u_dot: Dual::new(u_dot, x.u_ddot), direction }
            }
        }
    }

    /// Whether the foot does not slide.
    pub fn grips(&self) -> bool {
        matches!(self, Footing::Grips { .. })
    }
}

impl Footing<f64> {
    /// Footing of a block that has not moved.
    pub const AT_START: Footing<f64> = Footing::Grips { offset: 0.0 };

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        match *self {
            Footing::Grips { offset } => offset.is_finite(),
            Footing::Free { u, u_dot } => u.is_finite() && u_dot.is_finite(),
            Footing::Slides { u, u_dot, direction } => u.is_finite() && u_dot.is_finite() && direction.abs() == 1.0,
        }
    }

    /// Returns the work of the horizontal forcing per unit mass (m²/s²) on a free block. It ends when the footing is `after`.
    ///
    /// `ü = −a_x` gives `∫ −a_x u̇ dt = Δ(u̇²)/2`. Zero for other footings.
    pub fn free_work(&self, after: &Footing<f64>) -> f64 {
        match (self, after) {
            (Footing::Free { u_dot: from, .. }, Footing::Free { u_dot: to, .. }) => 0.5 * (to - from) * (to + from),
            (Footing::Grips { .. } | Footing::Slides { .. }, _)
            | (_, Footing::Grips { .. } | Footing::Slides { .. }) => 0.0,
        }
    }
}

/// Position, velocities and contacts of the block, which determine its motion together with the excitation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose<T = f64> {
    /// Time (s).
    pub time: T,
    /// `[θ, θ̇, w, ẇ]`; the meaning of w depends on the regime, see [`super::dynamics`].
    pub state: State<T>,
    /// The contacts of the corners.
    pub contacts: Contacts<T>,
    /// The horizontal hold.
    pub footing: Footing<T>,
    /// The states of the restraints.
    pub restraints: States<T>,
}

impl<T> Pose<T> {
    /// Returns a pose in which no restraint acts.
    pub fn unrestrained(time: T, state: State<T>, contacts: Contacts<T>, footing: Footing<T>) -> Pose<T> {
        Pose { time, state, contacts, footing, restraints: States::NONE }
    }
}

impl Pose {
    /// Whether the foot slides.
    pub fn slides(&self) -> bool {
        !self.footing.grips() && self.contacts.regime() != Regime::Separated
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let Pose { time, state, contacts, footing, restraints } = self;
        let finite = state.is_finite() && contacts.is_finite() && footing.is_finite();
        time.is_finite() && finite && restraints.is_finite()
    }
}

/// A corner held on its support: it moves with the support and bears no load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held<T> {
    /// The corner.
    pub corner: Corner,
    /// Height of its support above rest (m), with its rate (m/s) and acceleration (m/s²).
    pub top: [T; 3],
    /// The slide of the standing corner.
    pub standing: StandingSlide,
}

impl<R: Scalar> Held<R> {
    /// Returns a corner held on a support of this height and rate. The support creeps by `C ÿ = −K ẏ`.
    pub fn on(body: &Body<R>, corner: Corner, support: Dual<R>, standing: StandingSlide) -> Held<R> {
        Held { corner, top: [support.re, support.eps, creeping(body, support.eps)], standing }
    }

    /// Returns the held corner with its rates in the dual parts.
    pub fn with_rates(&self, body: &Body<R>) -> Held<Dual<R>> {
        let [value, rate, acceleration] = self.top;
        let jerk = creeping(body, acceleration);
        let top = [Dual::new(value, rate), Dual::new(rate, acceleration), Dual::new(acceleration, jerk)];
        Held { corner: self.corner, top, standing: self.standing }
    }
}

/// Returns the rate of change of a rate of a creeping support. Zero for one at rest, also without damping, where K/C is infinite.
pub(super) fn creeping<R: Scalar>(body: &Body<R>, rate: R) -> R {
    R::select_less(R::Real::from(0.0), rate.value().abs(), -(body.creep_rate * rate), R::from(0.0))
}
