//! A pose → the equations of motion at any time while its contacts last, and the quantities that follow from them at one instant.
//!
//! # Inlining
//! Functions between a step and the equations are inlined: code for absent forces and unread results is left out, and vectors stay in
//! registers. A function whose name ends in `_outlined` is the only copy of another that is never inlined: for rare modes, or where another
//! copy would add code without saving time. The two do not differ otherwise.

use crate::block::restraints::States;
use crate::block::{Body, Contacts, Corner, Foot, Lever, Regime};
use crate::excitation::{Excitation, Forcing};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Real, Scalar};
use crate::numerics::{Equations, Rate, State};
use crate::system::dynamics::{instant_held, instant_held_with_rates, instant_of, instant_with_rates};
use crate::system::forces::{self, energy};
use crate::system::instant::{Footing, Held, Instant, Pose};
use crate::system::motion_mode::{AnyMode, MotionMode};

/// The block at an instant, or one block per lane. It has a pose, the excitation, and the solved equations of motion.
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<'a, R: Scalar = f64> {
    /// The block.
    pub body: &'a Body<R>,
    /// Its excitation.
    pub excitation: &'a Excitation<R>,
    /// Time (s).
    pub time: R,
    /// Which corners touch.
    pub regime: Regime,
    /// `[θ, θ̇, w, ẇ]`.
    pub state: State<R>,
    /// The horizontal hold.
    pub footing: Footing<R>,
    /// The excitation at this time.
    pub forcing: Forcing<R>,
    /// The equations of motion.
    pub instant: Instant<R>,
    /// Rate of the state, and the powers.
    pub rate: Rate<R>,
    /// Heights of free supports (m), and their rates (m/s). Zeros for touching corners.
    pub support_heights: [Dual<R>; 2],
    /// The held corner, if any.
    pub held: Option<Held<R>>,
}

/// An excitation at a time.
#[derive(Clone, Copy, Debug)]
pub struct ForcingAt<'a, R = f64> {
    /// The excitation, which gives the rate of the forcing.
    pub excitation: &'a Excitation<R>,
    /// The time (s).
    pub time: R,
    /// The forcing at that time, with the memory of the restraints.
    pub forcing: Forcing<R>,
}

/// The motion from a pose on, while the block stands on the same corners.
#[derive(Clone, Copy)]
pub struct Motion<'a, L = AnyMode, const N: usize = 4, T = f64> {
    body: &'a Body<T>,
    excitation: &'a Excitation<T>,
    mode: L,
    since: T,
    footing: Footing<T>,
    contacts: Contacts<T>,
    restraints: States<T>,
}

/// Number of quantities integrated under an extended mode, which integrates u. They are `[θ, θ̇, w, ẇ, u, u̇]`, and the works of
/// [dissipative](forces::dissipated) forces since the beginning of the step, the dampers' last.
pub const DAMPED: usize = 6 + forces::DISSIPATIVE;

/// Number of these of a block without dampers: that of a vector of the processor.
pub const WITH_WORKS: usize = DAMPED - 1;

impl<'a, T: Elementary> Motion<'a, AnyMode, 4, T> {
    /// Returns the motion of a block from a pose on.
    #[inline]
    pub fn from_pose(body: &'a Body<T>, pose: &Pose<T>, excitation: &'a Excitation<T>) -> Self {
        Motion::under(AnyMode::of(body, pose), body, pose, excitation)
    }

    /// Evaluates [`Motion::at`]: with derivatives, each inlined copy would take long to compile.
    #[inline(never)]
    pub fn at_outlined(&self, time: T, state: State<T>) -> Evaluation<'a, T> {
        self.at(time, state)
    }
}

#[cfg(feature = "lanes")]
impl<P: Elementary> Motion<'_, AnyMode, 4, P> {
    /// Returns the rate of a state, without powers, under a mode with its own type. The foot grips, and no corner is held.
    #[inline(always)]
    pub fn state_rate_under<T: CombinesWith<P>>(&self, mode: impl MotionMode, time: T, state: &State<T>) -> State<T> {
        let footing = Footing::Grips { offset: T::from(0.0) };
        instant_of(self.body, mode.foundation(), mode.regime(), state.0, footing, self.excitation.at(time), |x| {
            State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot])
        })
    }
}

#[cfg(feature = "lanes")]
impl<const N: usize, T: Elementary> Motion<'_, AnyMode, N, T> {
    /// Returns the rate of a state by [`Motion::at_outlined`].
    pub fn rate_at_outlined(&self, time: T, state: &State<T, N>) -> State<T, N> {
        let Motion { body, excitation, mode, contacts, restraints, .. } = *self;
        let footing = self.footing_at(time, state);
        let now = Motion::<_, 4, _> { body, excitation, mode, since: time, footing, contacts, restraints };
        self.rate_of(&now.at_outlined(time, first_four(state))).state
    }
}

impl<'a, L: MotionMode, const N: usize, T: Elementary> Motion<'a, L, N, T> {
    /// Returns the motion that begins with a pose in this mode.
    #[inline(always)]
    pub fn under(mode: L, body: &'a Body<T>, pose: &Pose<T>, excitation: &'a Excitation<T>) -> Self {
        let Pose { time, contacts, footing, restraints, .. } = *pose;
        Motion { body, excitation, mode, since: time, footing, contacts, restraints }
    }

    /// Returns the mode of the motion.
    #[inline(always)]
    pub fn mode(&self) -> L {
        self.mode
    }

    /// Evaluates a state at a time.
    #[inline(always)]
    pub fn at(&self, time: T, state: State<T, N>) -> Evaluation<'a, T> {
        let footing = self.footing_at(time, &state);
        if let Some(held) = self.held_at(time) {
            return self.at_held(time, first_four(&state), footing, held);
        }
        let support_heights = self.support_heights(time);
        let forcing = self.mode.acting(self.excitation.at(time), self.restraints);
        let forcing_at = ForcingAt { excitation: self.excitation, time, forcing };
        Evaluation::of(self.mode, self.body, forcing_at, footing, first_four(&state), support_heights)
    }

    /// Returns the state of a pose.
    pub fn state_at(&self, pose: &Pose<T>) -> State<T, N> {
        let zero = T::from(0.0);
        let [u, u_dot] = match pose.footing {
            // The rotation determines it.
            Footing::Grips { .. } => [zero; 2],
            Footing::Free { u, u_dot } | Footing::Slides { u, u_dot, .. } => [u, u_dot],
        };
        let State { 0: [theta, theta_dot, w, w_dot] } = pose.state;
        extended([theta, theta_dot, w, w_dot, u, u_dot], [zero; forces::DISSIPATIVE])
    }

    /// Returns `[θ, θ̇, w, ẇ]` of a state at a time, and the footing.
    #[cfg(feature = "lanes")]
    pub fn place_at(&self, time: T, state: State<T, N>) -> (State<T>, Footing<T>) {
        let footing = self.footing_at(time, &state);
        let state = match self.held_at(time) {
            Some(held) => self.at_held(time, first_four(&state), footing, held).state,
            None => first_four(&state),
        };
        (state, footing)
    }

    /// Returns the state of an instant.
    #[inline(always)]
    pub fn state_of(&self, at: &Evaluation<T>) -> State<T, N> {
        let (State { 0: [theta, theta_dot, w, w_dot] }, zero) = (at.state, T::from(0.0));
        extended([theta, theta_dot, w, w_dot, at.instant.u, at.instant.u_dot], [zero; forces::DISSIPATIVE])
    }

    /// Returns the rate of the state at an instant, and the powers.
    #[inline(always)]
    pub fn rate_of(&self, at: &Evaluation<T>) -> Rate<T, N> {
        let Rate { state: State { 0: [theta, theta_dot, w, w_dot] }, quadratures } = at.rate;
        if const { N == 4 } {
            return Rate { state: State::first_of([theta, theta_dot, w, w_dot]), quadratures };
        }
        let x = &at.instant;
        let state = extended([theta, theta_dot, w, w_dot, x.u_dot, x.u_ddot], at.dissipated());
        Rate { state, quadratures }
    }

    /// Returns the held corner with its support at a time, if any.
    #[inline(always)]
    fn held_at(&self, time: T) -> Option<Held<T>> {
        let Motion { body, mode, contacts, .. } = self;
        let held = |corner| Held::on(body, corner, contacts.top(corner, body, time), contacts.standing_slide());
        mode.held().map(held)
    }

    /// Evaluates [`Motion::at`] with a held corner. Height and rate of the middle of the base follow from θ and θ̇.
    #[inline(never)]
    fn at_held(
        &self,
        time: T,
        State { 0: [theta, theta_dot, ..] }: State<T>,
        footing: Footing<T>,
        held: Held<T>,
    ) -> Evaluation<'a, T> {
        let forcing = self.mode.acting(self.excitation.at(time), self.restraints);
        let instant = instant_held(self.body, [theta, theta_dot], held, footing, forcing);
        let [left, right] = instant.corner;
        Evaluation {
            body: self.body,
            excitation: self.excitation,
            time,
            regime: self.mode.regime(),
            state: State::from([theta, theta_dot, (left + right) * 0.5, instant.w_dot]),
            footing,
            forcing,
            instant,
            rate: rate_of(self.mode, self.body, &instant, forcing),
            support_heights: self.support_heights(time),
            held: Some(held),
        }
    }

    /// Returns the heights of free supports (m), and their rates (m/s). Zeros for touching corners.
    #[inline(always)]
    pub fn support_heights(&self, time: T) -> [Dual<T>; 2] {
        Corner::each(|corner| {
            if self.mode.regime().touches(corner) {
                Dual::default()
            } else {
                self.contacts.top(corner, self.body, time)
            }
        })
    }

    /// Returns the horizontal hold at `time`. In free motion without restraints, `ü = −a_gx` is integrated in closed form.
    #[inline(always)]
    fn footing_at(&self, time: T, state: &State<T, N>) -> Footing<T> {
        match self.footing {
            Footing::Slides { direction, .. } if N > 4 => Footing::Slides { u: state[4], u_dot: state[5], direction },
            Footing::Free { .. } if N > 4 => Footing::Free { u: state[4], u_dot: state[5] },
            Footing::Free { u, u_dot } if !self.mode.grips() => {
                let (velocity, displacement) = self.excitation.horizontal_drift(self.since, time);
                Footing::Free { u: u + u_dot * (time - self.since) - displacement, u_dot: u_dot - velocity }
            }
            Footing::Slides { .. } if !L::STATIC => self.footing,
            // A mode with its own type grips, whatever the variant of the footing.
            Footing::Grips { offset } | Footing::Free { u: offset, .. } | Footing::Slides { u: offset, .. } => {
                Footing::Grips { offset }
            }
        }
    }
}

/// Returns the first N numbers of a motion and the works of dissipative forces.
#[inline(always)]
fn extended<T: Scalar, const N: usize>(motion: [T; 6], works: [T; forces::DISSIPATIVE]) -> State<T, N> {
    State::first_of(forces::joined::<_, 6, { forces::DISSIPATIVE }, DAMPED>(motion, works))
}

/// Returns the works of dissipative forces in a state, in the order of [`Evaluation::dissipated`]; zeros for those that it lacks.
#[inline(always)]
pub fn works_of<T: Scalar, const N: usize>(state: &State<T, N>) -> [T; forces::DISSIPATIVE] {
    std::array::from_fn(|i| state.0.get(6 + i).copied().unwrap_or(T::from(0.0)))
}

/// Returns the first four numbers of a state.
#[inline(always)]
fn first_four<T: Scalar, const N: usize>(state: &State<T, N>) -> State<T> {
    State::from([state[0], state[1], state[2], state[3]])
}

impl<L: MotionMode, const N: usize, T: Elementary> Equations<T, N> for Motion<'_, L, N, T> {
    #[inline(always)]
    fn rate(&self, time: T, state: &State<T, N>) -> Rate<T, N> {
        if L::STATIC { self.rate_here(time, state) } else { self.rate_outlined(time, state) }
    }
}

impl<L: MotionMode, const N: usize, T: Elementary> Motion<'_, L, N, T> {
    /// Returns the rate by a call. A copy in each stage would make the steps of rare modes too large.
    #[inline(never)]
    fn rate_outlined(&self, time: T, state: &State<T, N>) -> Rate<T, N> {
        self.rate_here(time, state)
    }

    #[inline(always)]
    fn rate_here(&self, time: T, state: &State<T, N>) -> Rate<T, N> {
        // A constant condition, so that the other branch is not compiled.
        if const { N > 4 } {
            return self.rate_extended(time, state);
        }
        let footing = self.footing_at(time, state);
        let Rate { state, quadratures } = match self.held_at(time) {
            Some(held) => self.at_held(time, first_four(state), footing, held).rate,
            None => rate(self.mode, self.body, self.excitation.at(time), footing, &first_four(state)),
        };
        Rate { state: State::first_of(state.0), quadratures }
    }

    /// Returns the rate under a mode that also integrates the horizontal motion.
    #[inline(never)]
    fn rate_extended(&self, time: T, state: &State<T, N>) -> Rate<T, N> {
        self.rate_of(&self.at(time, *state))
    }
}

/// Returns the rate of a state and the powers, without a held corner.
#[inline(always)]
pub fn rate<R: Scalar>(
    mode: impl MotionMode,
    body: &Body<R>,
    forcing: Forcing<R>,
    footing: Footing<R>,
    state: &State<R>,
) -> Rate<R> {
    // Blocks with restraints also integrate the horizontal motion.
    let forcing = Forcing { restraints: States::NONE, ..forcing };
    instant_of(body, mode.foundation(), mode.regime(), state.0, footing, forcing, |x| rate_of(mode, body, &x, forcing))
}

#[inline(always)]
fn rate_of<R: Scalar>(mode: impl MotionMode, body: &Body<R>, x: &Instant<R>, forcing: Forcing<R>) -> Rate<R> {
    // `Footing::free_work` is the horizontal part of the work on a free block.
    let closed = !mode.grips() && !mode.integrates_u();
    let integrated = if closed { Forcing { x: R::from(0.0), ..forcing } } else { forcing };
    Rate {
        state: State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot]),
        quadratures: x.powers::<R>(body, mode.regime(), integrated).into(),
    }
}

impl<'a, R: Scalar> Evaluation<'a, R> {
    /// Evaluates a state under a mode without a held corner.
    #[inline(always)]
    pub fn of(
        mode: impl MotionMode,
        body: &'a Body<R>,
        ForcingAt { excitation, time, forcing }: ForcingAt<'a, R>,
        footing: Footing<R>,
        state: State<R>,
        support_heights: [Dual<R>; 2],
    ) -> Evaluation<'a, R> {
        let (foundation, regime) = (mode.foundation(), mode.regime());
        let forcing = mode.acting(forcing, forcing.restraints);
        // The closure is short enough to be inlined; otherwise it would be compiled without the vectors of lanes.
        let (instant, rate) = instant_of(body, foundation, regime, state.0, footing, forcing, |instant| {
            (instant, rate_of(mode, body, &instant, forcing))
        });
        Evaluation {
            body,
            excitation,
            time,
            regime,
            state,
            footing,
            forcing,
            instant,
            rate,
            support_heights,
            held: None,
        }
    }

    /// Returns the rate of the forcing.
    #[inline(always)]
    pub fn forcing_rate(&self) -> Forcing<R> {
        self.excitation.rate_at(self.time)
    }
}

impl<R: Real> Evaluation<'_, R> {
    /// Returns the acceleration of the block, and one equivalent to its velocities (m/s²). Both are sums over rotation and height.
    #[inline(always)]
    pub fn rest_residuals(&self) -> [R; 2] {
        let Instant { theta_dot, theta_ddot, w_dot, w_ddot, .. } = self.instant;
        let Body { r0, omega_v, .. } = *self.body;
        let moves = r0 * (omega_v * theta_dot).abs() + (omega_v * w_dot).abs();
        [r0 * theta_ddot.abs() + w_ddot.abs(), moves]
    }
}

impl<R: Scalar> Evaluation<'_, R>
where
    Dual<R>: CombinesWith<R>,
{
    /// Solves the equations of motion, with rates along the motion in the dual parts. The forcing has this rate.
    #[inline(always)]
    pub fn with_rates(&self, forcing_rate: Forcing<R>) -> Instant<Dual<R>> {
        let Evaluation { body, regime, state, footing, instant: ref x, .. } = *self;
        let forcing = self.forcing.with_derivative(forcing_rate);
        match &self.held {
            Some(held) => instant_held_with_rates(body, held, footing, x, forcing),
            None => instant_with_rates(body, regime, state.0, footing, x, forcing),
        }
    }
}

impl<T: Elementary> Evaluation<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Evaluates [`Evaluation::with_rates`] at the actual rate of the forcing, without inlining.
    #[inline(never)]
    pub fn rates(&self) -> Instant<Dual<T>> {
        self.with_rates(self.forcing_rate())
    }
}

impl<T: Elementary> Evaluation<'_, T> {
    /// Returns the sum of kinetic and potential energy per unit mass (m²/s²).
    pub fn energy(&self) -> T {
        let (kinetic, potential) = energy(self.body, self.regime, &self.forcing, &self.instant);
        kinetic + potential
    }

    /// Returns the acceleration of the foot (m/s²), positive to the right.
    pub fn foot_acceleration(&self) -> T {
        let (x, (sin, cos)) = (&self.instant, self.instant.theta.sin_cos());
        let Lever { x: across, q } = self.body.lever(self.regime.foot().unwrap_or(Foot::Middle), sin, cos);
        x.u_ddot - q * x.theta_ddot + across * x.theta_dot * x.theta_dot
    }

    /// Returns the displacement of the foot since the start (m), positive to the right.
    pub fn foot_place(&self) -> T {
        let (sin, cos) = self.instant.theta.sin_cos();
        let offset = self.body.offset_from(self.regime.foot().unwrap_or(Foot::Middle));
        self.instant.u - (sin * self.body.h - sin * sin / (cos + 1.0) * offset)
    }

    /// Returns the powers per mass (m²/s³) of the dissipative forces other than the supports.
    pub fn dissipated(&self) -> [T; forces::DISSIPATIVE] {
        forces::dissipated(self.body, &self.forcing, &self.instant)
    }
}
