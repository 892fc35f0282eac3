//! State, regime and excitation of an instant → the observed quantities, with exact derivatives on request.

use serde::{Deserialize, Serialize};

use crate::block::restraints::{self, ObservedRestraint};
use crate::block::{Body, Corner, Regime};
use crate::excitation::Forcing;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Scalar};
use crate::system::dynamics::{instant, instant_held};
use crate::system::evaluation::Evaluation;
use crate::system::forces;
use crate::system::instant::{Footing, Held, Instant};

/// Greatest reported friction demand of a block without a limit of friction. The ratio has no bound as the vertical reaction vanishes.
pub const MAX_FRICTION_DEMAND: f64 = 1e6;

/// Motion, reactions and corners at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<T> {
    /// Which corners touch.
    pub regime: Regime,
    /// Rotation θ (rad), positive to the right.
    pub theta: T,
    /// θ̇ (rad/s).
    pub theta_dot: T,
    /// θ̈ (rad/s²).
    pub theta_ddot: T,
    /// Height of the centre of mass above rest, relative to the ground (m).
    pub v: T,
    /// v̇ (m/s).
    pub v_dot: T,
    /// v̈ (m/s²).
    pub v_ddot: T,
    /// Horizontal displacement of the centre of mass (m), positive to the right. It is relative to the ground.
    pub u: T,
    /// u̇ (m/s).
    pub u_dot: T,
    /// ü (m/s²).
    pub u_ddot: T,
    /// Vertical reactions N_L, N_R (N).
    pub reaction: [T; 2],
    /// Horizontal reaction H on the block (N), positive to the right.
    pub horizontal: T,
    /// Moment of the reactions, `b (N_L − N_R)` (N.m), positive clockwise. It is about the middle of the base at rest.
    pub base_moment: T,
    /// Heights of the corners L, R above their places at rest (m).
    pub corner: [T; 2],
    /// Their heights above their supports (m), zero for a corner that touches.
    pub uplift: [T; 2],
    /// Friction demand `|H|/(N_L + N_R)` (1). It is at most μ, or [`MAX_FRICTION_DEMAND`] without a limit.
    pub friction_demand: T,
    /// Sliding velocity of the foot (m/s), positive to the right. Zero where it grips, and in flight.
    pub slip_rate: T,
    /// The restraints, by their numbers.
    pub restraints: [ObservedRestraint<T>; restraints::MAX],
    /// Powers of the excitation and of the dashpots (W). The second is positive for dissipation.
    pub power: [T; 2],
    /// Power taken by friction (W).
    pub friction_power: T,
    /// Powers taken by the restraints (W).
    pub restraint_power: restraints::RestraintEnergies<T>,
}

/// Returns the observation of an instant; `support_heights` are the heights of the supports.
#[inline(always)]
pub fn observe<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    regime: Regime,
    x: &Instant<T>,
    support_heights: [T; 2],
    forcing: Forcing<T>,
) -> Observation<T> {
    let Channels { theta, reaction, horizontal, uplift, friction_demand } =
        Channels::of(body, regime, x, support_heights);
    let power = x.powers(body, regime, forcing);
    let [friction_power, restraint_power @ ..] = forces::dissipated(body, &forcing, x).map(|power| power * body.mass);
    Observation {
        regime,
        theta,
        theta_dot: x.theta_dot,
        theta_ddot: x.theta_ddot,
        v: x.v,
        v_dot: x.v_dot,
        v_ddot: x.v_ddot,
        u: x.u,
        u_dot: x.u_dot,
        u_ddot: x.u_ddot,
        reaction,
        horizontal,
        base_moment: (reaction[0] - reaction[1]) * body.b,
        corner: x.corner,
        uplift,
        friction_demand,
        slip_rate: x.slip_rate,
        restraints: forces::observe_restraints(body, &forcing.restraints, x),
        power: [power[0] * body.mass, power[1] * body.mass],
        friction_power,
        restraint_power: restraints::RestraintEnergies::from_array(restraint_power),
    }
}

/// The observed quantities that have peaks, or these with their rates of change, in the units of [`Observation`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Channels<T = Dual> {
    /// Rotation θ (rad).
    pub theta: T,
    /// Vertical reactions N_L, N_R (N).
    pub reaction: [T; 2],
    /// Horizontal reaction H (N).
    pub horizontal: T,
    /// Heights of the corners above their supports (m).
    pub uplift: [T; 2],
    /// Friction demand (1).
    pub friction_demand: T,
}

impl<T: Scalar> Channels<T> {
    /// Those of an instant; `support_heights` are the heights of the supports.
    #[inline(always)]
    pub fn of<P: Scalar>(body: &Body<P>, regime: Regime, x: &Instant<T>, support_heights: [T; 2]) -> Channels<T>
    where
        T: CombinesWith<P>,
    {
        let [left, right] = x.reaction;
        let reaction = [left * body.mass, right * body.mass];
        let horizontal = x.horizontal * body.mass;
        Channels {
            theta: x.theta,
            reaction,
            horizontal,
            // No closure: it would not be inlined into the lanes, and compiled without their vectors.
            uplift: [
                uplift(regime, x, support_heights, Corner::Left),
                uplift(regime, x, support_heights, Corner::Right),
            ],
            friction_demand: friction_demand(regime, T::from(body.friction), horizontal, reaction[0] + reaction[1]),
        }
    }
}

/// The gap of a corner, not below zero. Its rate is that of the gap even where round-off leaves it below zero, as at a landing:
/// the peaks bound the motion inside a step by the rates at its ends.
#[inline(always)]
fn uplift<T: Scalar>(regime: Regime, x: &Instant<T>, support_heights: [T; 2], corner: Corner) -> T {
    let (i, zero) = (corner.index(), T::Real::from(0.0));
    let gap = x.corner[i] - support_heights[i];
    let below = T::Real::select_less(gap.value(), zero, gap.value(), zero);
    if regime.touches(corner) { T::constant(zero) } else { gap - T::constant(below) }
}

/// `|H|/N`, at most the coefficient of friction, or [`MAX_FRICTION_DEMAND`] where that is zero. At the lift-off of a sliding corner
/// both vanish, and round-off would decide.
#[inline(always)]
fn friction_demand<T: Scalar>(regime: Regime, friction: T, horizontal: T, vertical: T) -> T {
    // The smallest positive number: only zero is less.
    const MIN_ABOVE_ZERO: f64 = f64::from_bits(1);
    let (zero, none) = (T::from(0.0), T::Real::from(0.0));
    if regime == Regime::Separated {
        return zero;
    }
    let shear = T::select_less(horizontal.value(), none, -horizontal, horizontal);
    let bound = T::select_less(none, friction.value(), friction, T::from(MAX_FRICTION_DEMAND));
    let on_nothing = T::select_less(shear.value(), T::Real::from(MIN_ABOVE_ZERO), zero, bound);
    T::select_less(shear.value(), vertical.value() * bound.value(), shear / vertical, on_nothing)
}

impl<T: Scalar> Observation<T> {
    /// Applies `f` to each number.
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Observation<U> {
        Observation {
            regime: self.regime,
            theta: f(self.theta),
            theta_dot: f(self.theta_dot),
            theta_ddot: f(self.theta_ddot),
            v: f(self.v),
            v_dot: f(self.v_dot),
            v_ddot: f(self.v_ddot),
            u: f(self.u),
            u_dot: f(self.u_dot),
            u_ddot: f(self.u_ddot),
            reaction: self.reaction.map(&f),
            horizontal: f(self.horizontal),
            base_moment: f(self.base_moment),
            corner: self.corner.map(&f),
            uplift: self.uplift.map(&f),
            friction_demand: f(self.friction_demand),
            slip_rate: f(self.slip_rate),
            restraints: self.restraints.map(|restraint| restraint.map(&f)),
            power: self.power.map(&f),
            friction_power: f(self.friction_power),
            restraint_power: self.restraint_power.map(&f),
        }
    }

    /// The quantities that have peaks.
    pub fn channels(&self) -> Channels<T> {
        let Observation { theta, reaction, horizontal, uplift, friction_demand, .. } = *self;
        Channels { theta, reaction, horizontal, uplift, friction_demand }
    }

    /// The observation of a held block: no rates, accelerations or reactions. All derivatives are zero.
    pub fn frozen(&self) -> Observation<T> {
        self.map(|x| T::constant(x.value())).without_motion()
    }

    /// The observation of a block that is held: no rates, accelerations and reactions.
    pub fn without_motion(&self) -> Observation<T> {
        let zero = T::from(0.0);
        Observation {
            theta_dot: zero,
            theta_ddot: zero,
            v_dot: zero,
            v_ddot: zero,
            u_dot: zero,
            u_ddot: zero,
            reaction: [zero; 2],
            horizontal: zero,
            base_moment: zero,
            friction_demand: zero,
            slip_rate: zero,
            restraints: self.restraints.map(|restraint| ObservedRestraint { pull: zero, ..restraint }),
            power: [zero; 2],
            friction_power: zero,
            restraint_power: self.restraint_power.map(|_| zero),
            ..*self
        }
    }
}

impl<R: Scalar> Evaluation<'_, R>
where
    Dual<R>: CombinesWith<R>,
{
    /// The observed quantities with their exact rates along the motion in the dual parts.
    #[inline(always)]
    pub fn observe_rates(&self) -> Observation<Dual<R>> {
        let rate = self.forcing_rate();
        let forcing = self.forcing.with_derivative(rate);
        observe(self.body, self.regime, &self.with_rates(rate), self.support_heights, forcing)
    }
}

impl Evaluation<'_> {
    /// The observed quantities.
    pub fn observe(&self) -> Observation<f64> {
        observe(self.body, self.regime, &self.instant, self.support_heights.map(|top| top.re), self.forcing)
    }

    /// The observed quantities with exact derivatives in the dual parts. They are with respect to the forcing in a direction, and to
    /// `time`, with which supports creep.
    pub fn observe_direction(&self, direction: Forcing<f64>, time: f64) -> Observation<Dual> {
        let state = [self.state[0], self.state[1], self.state[2], self.state[3]].map(Dual::from);
        let footing = self.footing.map(Dual::from);
        let forcing = self.forcing.with_derivative(direction);
        let x = self.instant_along(state, footing, forcing, time);
        let support_heights = self.support_heights.map(|top| Dual::new(top.re, time * top.eps));
        observe(self.body, self.regime, &x, support_heights, forcing)
    }

    /// Solves the equations of motion with derivatives in the direction of state, footing, forcing and `time`, with which the support of
    /// a held corner creeps.
    pub(super) fn instant_along(
        &self,
        state: [Dual; 4],
        footing: Footing<Dual>,
        forcing: Forcing<Dual>,
        time: f64,
    ) -> Instant<Dual> {
        let Some(held) = self.held else { return instant(self.body, self.regime, state, footing, forcing) };
        let Held { corner, top, standing } = held.with_rates(self.body);
        let held = Held { corner, top: top.map(|top| Dual::new(top.re, time * top.eps)), standing };
        instant_held(self.body, [state[0], state[1]], held, footing, forcing)
    }
}
