//! State, regime and excitation of an instant → the sum of forces → accelerations and reactions, about the standing foot.
//!
//! The vertical coordinate of the state, `w`, is the height of the foot (the touching corner, or the middle of the base in full
//! contact), in flight that of the centre of mass. The spring forces follow from this small number, and the difference of `v` and
//! `R0 [cos α − cos(α ± θ)]`, which cancels, is never formed.
//!
//! A gripping foot, a rigid base and a held corner are constraints: each adds the inertia of the centre of mass that it moves, or
//! determines the rotation. Forces and energies are per unit of the block's mass.

use crate::block::{Body, Corner, Foot, Foundation, Kinematics, Lever, Regime, StandingSlide};
use crate::excitation::Forcing;
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Scalar};
use crate::system::forces::{self, friction, support};
use crate::system::instant::{Footing, Held, Instant};

/// Solves the equations of motion at one instant. See [`Forcing`] for signs.
#[inline]
pub fn instant<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    regime: Regime,
    state: [T; 4],
    footing: Footing<T>,
    forcing: Forcing<T>,
) -> Instant<T> {
    instant_of(body, body.foundation, regime, state, footing, forcing, |x| x)
}

/// Solves the equations of motion for the part of [`instant`] that `pick` takes.
///
/// It is inlined, so that only this part is computed, and the compiler removes the branches of other foundations and regimes if
/// `foundation`, that of the block, and `regime` are constants.
#[inline(always)]
pub fn instant_of<P: Scalar, T: CombinesWith<P>, R>(
    body: &Body<P>,
    foundation: Foundation,
    regime: Regime,
    state: [T; 4],
    footing: Footing<T>,
    forcing: Forcing<T>,
    pick: impl Fn(Instant<T>) -> R,
) -> R {
    let posture = Posture::new(body, state, footing);
    match regime {
        Regime::FullContact => pick(posture.on(Foot::Middle, foundation, forcing)),
        Regime::TiltingLeft => pick(posture.on(Foot::Corner(Corner::Left), foundation, forcing)),
        Regime::TiltingRight => pick(posture.on(Foot::Corner(Corner::Right), foundation, forcing)),
        Regime::Separated => pick(posture.in_flight(forcing)),
    }
}

/// Solves the equations of motion of a block with a held corner. Its state is θ and θ̇ alone.
pub fn instant_held<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    [theta, theta_dot]: [T; 2],
    held: Held<T>,
    footing: Footing<T>,
    forcing: Forcing<T>,
) -> Instant<T> {
    let zero = T::from(0.0);
    Posture::new(body, [theta, theta_dot, zero, zero], footing).held(held, forcing)
}

/// Solves the equations of motion at an instant `x`, with the rates along the motion in dual parts.
///
/// The dual parts of the forcing are its rates.
#[inline(always)]
pub fn instant_with_rates<R: Scalar>(
    body: &Body<R>,
    regime: Regime,
    [_, _, w, _]: [R; 4],
    footing: Footing<R>,
    x: &Instant<R>,
    forcing: Forcing<Dual<R>>,
) -> Instant<Dual<R>>
where
    Dual<R>: CombinesWith<R>,
{
    let state = [
        Dual::new(x.theta, x.theta_dot),
        Dual::new(x.theta_dot, x.theta_ddot),
        Dual::new(w, x.w_dot),
        Dual::new(x.w_dot, x.w_ddot),
    ];
    instant_of(body, body.foundation, regime, state, footing.with_rates(x), forcing, |x| x)
}

/// Solves [`instant_held`] at an instant `x`, with rates along the motion in the dual parts.
pub fn instant_held_with_rates<R: Scalar>(
    body: &Body<R>,
    held: &Held<R>,
    footing: Footing<R>,
    x: &Instant<R>,
    forcing: Forcing<Dual<R>>,
) -> Instant<Dual<R>>
where
    Dual<R>: CombinesWith<R>,
{
    let state = [Dual::new(x.theta, x.theta_dot), Dual::new(x.theta_dot, x.theta_ddot)];
    instant_held(body, state, held.with_rates(body), footing.with_rates(x), forcing)
}

/// The state with its sine and cosine.
#[derive(Clone, Copy)]
struct Posture<'a, P, T> {
    body: &'a Body<P>,
    theta: T,
    theta_dot: T,
    w: T,
    w_dot: T,
    sin: T,
    cos: T,
    footing: Footing<T>,
}

impl<'a, P: Scalar, T: CombinesWith<P>> Posture<'a, P, T> {
    #[inline(always)]
    fn new(body: &'a Body<P>, [theta, theta_dot, w, w_dot]: [T; 4], footing: Footing<T>) -> Posture<'a, P, T> {
        let (sin, cos) = theta.sin_cos();
        Posture { body, theta, theta_dot, w, w_dot, sin, cos, footing }
    }

    /// Solves eqs. (7)–(13) on supports, or Housner's equation on a rigid base.
    ///
    /// On supports `v̈ = Σ N_I/M − g − a_z`. On the rigid base `v̈ = −X θ̈ − Q θ̇²`, and N follows.
    #[inline(always)]
    fn on(&self, foot: Foot, foundation: Foundation, forcing: Forcing<T>) -> Instant<T> {
        let lever = self.body.lever(foot, self.sin, self.cos);
        let centripetal = lever.q * (self.theta_dot * self.theta_dot);
        let forcing = self.with_forces(Some(foot), forcing);
        match (foundation, foot) {
            (Foundation::Viscoelastic, _) => {
                let (reaction, lift, mut moment) = self.supports(foot);
                if let Footing::Slides { direction, .. } = self.footing {
                    moment = moment - lever.q * friction::reaction(self.body, direction, lift);
                }
                let theta_ddot = self.theta_ddot(lever, moment, None, forcing);
                let v_ddot = lift - self.body.gravity - forcing.z;
                let w_ddot = v_ddot + lever.x * theta_ddot + centripetal;
                self.moving(foot, [theta_ddot, v_ddot, w_ddot], reaction, forcing)
            }
            // The height of the foot is constant: `v̈ = −X θ̈ − Q θ̇²`, and N follows.
            (Foundation::Rigid, Foot::Corner(corner)) => {
                let weight = forcing.z + self.body.gravity;
                // The arm of N and of the friction proportional to it.
                let arm = match self.footing {
                    Footing::Slides { direction, .. } => lever.x - friction::reaction(self.body, direction, lever.q),
                    Footing::Grips { .. } | Footing::Free { .. } => lever.x,
                };
                let theta_ddot = self.theta_ddot(lever, arm * (weight - centripetal), Some(arm), forcing);
                let v_ddot = -(lever.x * theta_ddot) - centripetal;
                let zero = T::from(0.0);
                self.moving(foot, [theta_ddot, v_ddot, zero], at_corner(corner, v_ddot + weight), forcing)
            }
            (Foundation::Rigid, Foot::Middle) => self.at_rest(forcing),
        }
    }

    /// Returns the reactions of the supports, their sum, and their moment about the mass centre.
    #[inline(always)]
    fn supports(&self, foot: Foot) -> ([T; 2], T, T) {
        match foot {
            Foot::Middle => {
                let (left, right) = (self.support(Corner::Left, foot), self.support(Corner::Right, foot));
                ([left.0, right.0], left.0 + right.0, left.1 + right.1)
            }
            Foot::Corner(standing) => {
                let (reaction, moment) = self.support(standing, foot);
                (at_corner(standing, reaction), reaction, moment)
            }
        }
    }

    /// Returns the reaction under a corner, and its moment about the centre of mass.
    #[inline(always)]
    fn support(&self, corner: Corner, foot: Foot) -> (T, T) {
        let reaction = support::reaction(self.body, corner, self.height(corner, foot), self.rate(corner, foot));
        (reaction, reaction * self.body.lever(Foot::Corner(corner), self.sin, self.cos).x)
    }

    /// Returns θ̈ from the moments about the centre of mass. They are those of the vertical reactions, of the loads, and of H, which acts Q
    /// below it.
    ///
    /// On supports under a gripping foot `(i0 + Q²) θ̈ = Σ X_I N_I/M − Q (a_x − X θ̇²) + m`.
    ///
    /// A gripping foot imposes `ü = Q θ̈ − X θ̇²` on the centre of mass by H, a rigid base `v̈ = −X θ̈ − Q θ̇²` by N. `rigid_arm` is the
    /// arm of that N, and `vertical` the moment of other vertical reactions.
    #[inline(always)]
    fn theta_ddot(&self, Lever { x, q }: Lever<T>, vertical: T, rigid_arm: Option<T>, forcing: Forcing<T>) -> T {
        let (mut moment, mut inertia) = (vertical, T::from(self.body.i0));
        if let Some(arm) = rigid_arm {
            inertia = x * arm + inertia;
        }
        if let Footing::Grips { .. } = self.footing {
            moment = -(q * (forcing.x - x * (self.theta_dot * self.theta_dot))) + moment;
            inertia = q * q + inertia;
        }
        (moment + forcing.moment) / inertia
    }

    /// Returns the reactions that keep a block at rest on the rigid base. A corner whose reaction would have to pull lifts: without loads, for
    /// `|a_gx| > (g + a_gz) tan α`.
    #[inline(always)]
    fn at_rest(&self, forcing: Forcing<T>) -> Instant<T> {
        let body = self.body;
        let (zero, one) = (T::from(0.0), T::from(1.0));
        let upright = Posture { theta_dot: zero, w: zero, w_dot: zero, sin: zero, cos: one, ..*self };
        let weight = forcing.z + body.gravity;
        let x = upright.moving(Foot::Middle, [zero; 3], [weight, zero], forcing);
        let couple = (x.horizontal * body.h - forcing.moment) * (P::from(0.5) / body.b);
        // A corner bears the force that keeps the block from turning about the other one. Near zero its moment has the bits of that in
        // `theta_ddot`, so that a corner that cannot stay is never pressed back at once.
        let bears = |other: Corner| {
            let s = other.sign();
            let moment = match self.footing {
                Footing::Slides { direction, .. } => {
                    let arm = -friction::reaction(body, direction, T::from(body.h)) + body.offset(other);
                    arm * weight
                }
                Footing::Grips { .. } | Footing::Free { .. } => weight * body.offset(other) - x.horizontal * body.h,
            };
            let moment = (moment + forcing.moment) * s;
            let fraction = body.weight_fraction[other.other().index()];
            let (n, exact) = (weight * fraction - couple * s, moment * (P::from(0.5) / body.b));
            let n = T::select_less(n.value(), zero.value(), exact, n);
            T::select_less(moment.value(), zero.value(), exact, n)
        };
        Instant { theta_dot: self.theta_dot, reaction: Corner::each(|corner| bears(corner.other())), ..x }
    }

    /// Solves the equations of flight, where w = v: `v̈ = −g − a_z` and `θ̈ = m/i0`.
    #[inline(always)]
    fn in_flight(&self, forcing: Forcing<T>) -> Instant<T> {
        let Posture { body, theta_dot, w, w_dot, sin, cos, .. } = *self;
        let zero = T::from(0.0);
        let forcing = self.with_forces(None, forcing);
        let theta_ddot = forcing.moment * T::from(P::from(1.0) / body.i0);
        let v_ddot = -forcing.z - body.gravity;
        let (h, e) = (body.h, body.eccentricity);
        let middle = [
            w + self.versine() * h + sin * e,
            w_dot + sin * theta_dot * h + cos * theta_dot * e,
            v_ddot
                + (sin * theta_ddot + cos * theta_dot * theta_dot) * h
                + (cos * theta_ddot - sin * theta_dot * theta_dot) * e,
        ];
        let over = Posture { w: middle[0], w_dot: middle[1], ..*self };
        let x = over.moving(Foot::Middle, [theta_ddot, v_ddot, middle[2]], [zero; 2], forcing);
        Instant { w_dot, w_ddot: v_ddot, v: w, v_dot: w_dot, slip_rate: zero, friction_power: zero, ..x }
    }

    /// Solves the equations of full contact with a held corner, whose motion is known.
    ///
    /// The reaction of the other corner accelerates the centre of mass; both motions together determine the rotation. Horizontally the
    /// middle of the base holds the block, or slides. Filippov's solution mixes full contact, with H = H_f at the middle, and the regime on
    /// the standing corner, with H_f or −H_f there, such that the corner stays held.
    fn held(mut self, held: Held<T>, forcing: Forcing<T>) -> Instant<T> {
        let Held { corner, top: [top, top_dot, top_ddot], standing } = held;
        let Posture { body, theta_dot, sin, cos, .. } = self;
        let (offset, middle) = (body.half_base(corner), Foot::Middle);
        (self.w, self.w_dot) = (top - sin * offset, top_dot - cos * theta_dot * offset);
        let forcing = self.with_forces(Some(middle), forcing);
        let other = corner.other();
        let n = support::reaction(body, other, self.height(other, middle), self.rate(other, middle));
        let v_ddot = n - body.gravity - forcing.z;
        let lever = body.lever(Foot::Corner(corner), sin, cos);
        let theta_dot2 = theta_dot * theta_dot;
        let theta_ddot = (top_ddot - v_ddot - lever.q * theta_dot2) / lever.x;
        let Lever { x, q } = body.lever(middle, sin, cos);
        let w_ddot = v_ddot + x * theta_ddot + q * theta_dot2;
        let mut x = self.moving(middle, [theta_ddot, v_ddot, w_ddot], at_corner(other, n), forcing);
        if let Footing::Slides { .. } = self.footing {
            let Lever { x: arm, q: height } = body.lever(Foot::Corner(other), sin, cos);
            // The moment of H about the centre of mass, per mass, as the rotation needs it.
            let moment = n * arm + forcing.moment - theta_ddot * body.i0;
            match standing {
                StandingSlide::Follows => {}
                // `λ Q_m H_f − (1 − λ) Q_I H_f = moment` gives `H = (2 λ − 1) H_f`.
                StandingSlide::Opposes => {
                    x.horizontal = (moment * 2.0 + (height - q) * x.horizontal) / (height + q);
                    x.u_ddot = x.horizontal - forcing.x;
                }
            }
            x.friction_power = moment * theta_dot + friction::power(x.horizontal, x.u_dot);
        }
        let i = corner.index();
        // Exactly the motion of the support, since events depend on the last bit.
        (x.corner[i], x.corner_dot[i], x.corner_ddot[i]) = (top, top_dot, top_ddot);
        x
    }

    /// Returns the motion that follows from `[θ̈, v̈, ẅ]` and the vertical reactions.
    #[inline(always)]
    fn moving(
        &self,
        foot: Foot,
        [theta_ddot, v_ddot, w_ddot]: [T; 3],
        reaction: [T; 2],
        forcing: Forcing<T>,
    ) -> Instant<T> {
        let Posture { body, theta, theta_dot, w, w_dot, sin, cos, footing } = *self;
        let Lever { x, q } = body.lever(foot, sin, cos);
        let (versine, offset) = (self.versine(), body.offset_from(foot));
        let across = sin * body.h - versine * offset;
        let (u, u_dot, u_ddot, horizontal) = match footing {
            Footing::Grips { offset } => {
                let u_ddot = q * theta_ddot - x * (theta_dot * theta_dot);
                (across + offset, q * theta_dot, u_ddot, u_ddot + forcing.x)
            }
            Footing::Free { u, u_dot } => (u, u_dot, -forcing.x, T::from(0.0)),
            Footing::Slides { u, u_dot, direction } => {
                let horizontal = friction::reaction(body, direction, reaction[0] + reaction[1]);
                (u, u_dot, horizontal - forcing.x, horizontal)
            }
        };
        let slip_rate = u_dot - q * theta_dot;
        Instant {
            theta,
            theta_dot,
            theta_ddot,
            w_dot,
            w_ddot,
            u,
            u_dot,
            u_ddot,
            v: w - versine * body.h - sin * offset,
            v_dot: w_dot - x * theta_dot,
            v_ddot,
            corner: [self.height(Corner::Left, foot), self.height(Corner::Right, foot)],
            corner_dot: [self.rate(Corner::Left, foot), self.rate(Corner::Right, foot)],
            corner_ddot: [
                self.acceleration(Corner::Left, foot, w_ddot, theta_ddot),
                self.acceleration(Corner::Right, foot, w_ddot, theta_ddot),
            ],
            reaction,
            horizontal,
            slip_rate,
            friction_power: friction::power(horizontal, slip_rate),
        }
    }

    /// Returns the forcing with the pull of the restraints; `foot` is `None` in flight.
    #[inline(always)]
    fn with_forces(&self, foot: Option<Foot>, forcing: Forcing<T>) -> Forcing<T> {
        // Passing a copy keeps the original in registers.
        let Forcing { x, z, moment, restraints } = forcing;
        if restraints.pull() { pulled(*self, foot, Forcing { x, z, moment, restraints }) } else { forcing }
    }

    /// Returns the height of a corner above its position at rest (m).
    #[inline(always)]
    fn height(&self, corner: Corner, foot: Foot) -> T {
        match self.body.from_foot(corner, foot) {
            Some(distance) => self.w - self.sin * distance,
            None => self.w,
        }
    }

    /// Returns the vertical velocity of a corner (m/s).
    #[inline(always)]
    fn rate(&self, corner: Corner, foot: Foot) -> T {
        match self.body.from_foot(corner, foot) {
            Some(distance) => self.w_dot - self.cos * self.theta_dot * distance,
            None => self.w_dot,
        }
    }

    /// Returns the vertical acceleration of a corner (m/s²).
    #[inline(always)]
    fn acceleration(&self, corner: Corner, foot: Foot, w_ddot: T, theta_ddot: T) -> T {
        let Posture { theta_dot, sin, cos, .. } = *self;
        match self.body.from_foot(corner, foot) {
            Some(distance) => w_ddot - (cos * theta_ddot - sin * theta_dot * theta_dot) * distance,
            None => w_ddot,
        }
    }

    /// `1 − cos θ` without cancellation.
    #[inline(always)]
    fn versine(&self) -> T {
        self.sin * self.sin / (self.cos + 1.0)
    }
}

/// Returns the forcing with the pull of the restraints. Not inlined, so that the equations without restraints stay small.
#[inline(never)]
fn pulled<P: Scalar, T: CombinesWith<P>>(
    posture: Posture<P, T>,
    foot: Option<Foot>,
    forcing: Forcing<T>,
) -> Forcing<T> {
    let Posture { body, theta_dot, w, w_dot, sin, cos, footing, .. } = posture;
    let foot_or_middle = foot.unwrap_or(Foot::Middle);
    let Lever { x, q } = body.lever(foot_or_middle, sin, cos);
    let (versine, offset) = (posture.versine(), body.offset_from(foot_or_middle));
    let (u, u_dot) = match footing {
        Footing::Grips { offset: slip } => (sin * body.h - versine * offset + slip, q * theta_dot),
        Footing::Free { u, u_dot } | Footing::Slides { u, u_dot, .. } => (u, u_dot),
    };
    let (v, v_dot) = match foot {
        Some(_) => (w - versine * body.h - sin * offset, w_dot - x * theta_dot),
        None => (w, w_dot),
    };
    let kinematics = Kinematics { sin_cos: [sin, cos], theta_dot, center: [u, v], velocity: [u_dot, v_dot] };
    forces::added_to(body, forcing, &kinematics)
}

/// Returns a force at one corner, and zero at the other.
#[inline(always)]
fn at_corner<T: Scalar>(corner: Corner, force: T) -> [T; 2] {
    match corner {
        Corner::Left => [force, T::from(0.0)],
        Corner::Right => [T::from(0.0), force],
    }
}

/// Returns `[w, ẇ]` (m, m/s) from `[θ, θ̇, v, v̇]`. They are height and rate of the foot, in flight of the centre of mass, and zeros on the
/// rigid base.
pub fn foot_height<T: Scalar>(body: &Body, regime: Regime, [theta, theta_dot, v, v_dot]: [T; 4]) -> [T; 2] {
    let Some(foot) = regime.foot() else { return [v, v_dot] };
    if body.foundation == Foundation::Rigid {
        return [T::from(0.0); 2];
    }
    let (sin, cos) = theta.sin_cos();
    let offset = body.offset_from(foot);
    [v + sin * sin / (cos + 1.0) * body.h + sin * offset, v_dot + sin * theta_dot * body.h + cos * theta_dot * offset]
}
