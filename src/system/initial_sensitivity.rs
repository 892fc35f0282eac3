//! The beginning in dual numbers, through the regimes that its values decide → its exact derivatives.

use crate::block::{Block, Foundation};
use crate::block::{Contact, Corner, Creep, Regime};
use crate::excitation::{Excitation, Forcing};
use crate::numerics::scalar::Elementary;
use crate::system::System;
use crate::system::beginning::Initial;
use crate::system::dynamics::{instant, instant_held};
use crate::system::evaluation::Motion;
use crate::system::events::placement::Placement;
use crate::system::impact::Velocities;
use crate::system::instant::Pose;
use crate::system::instant::{Footing, Held, Instant};

/// A block before the first step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T> {
    /// The block.
    pub block: Block<T>,
    /// Where it is.
    pub initial: Initial<T>,
    /// Its excitation.
    pub forcing: Forcing<T>,
}

/// The beginning in the numbers of a [`Start`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialSensitivity<T> {
    /// The regime in which it begins, and the equations of motion there.
    pub begins: (Regime, Instant<T>),
    /// The same as it goes on in that instant: on the rigid base a corner that would have to be pulled has lifted.
    pub goes_on: (Regime, Instant<T>),
    /// Heights of the supports that nothing touches then (m); zeros for the others.
    pub support_heights: [T; 2],
}

impl System {
    /// The beginning at `time` (s) from `initial` under `excitation`, in the numbers of `start`, whose values are the same.
    pub fn initial_sensitivity<T: Elementary>(
        &self,
        initial: &Initial,
        time: f64,
        excitation: &Excitation,
        start: &Start<T>,
    ) -> InitialSensitivity<T> {
        let zero = T::from(0.0);
        match self.block.foundation {
            Foundation::Viscoelastic => {
                let (pose, path) = self.beginning_on_supports(initial, time, excitation);
                let mut regimes = path.iter();
                let first = regimes.next().unwrap_or(pose.contacts.regime());
                let start = &Start { forcing: Forcing { ties: pose.ties, ..start.forcing }, ..*start };
                let mut walk = Walk::begin(start, first, Placement::on_supports(&start.block, &start.initial));
                for regime in regimes {
                    let grips = walk.footing.grips();
                    if let (Regime::FullContact, Some(pivot), true) = (walk.regime, regime.pivot(), grips) {
                        walk.placement.hold_pivot(&start.block, pivot);
                    }
                    walk.enter(regime);
                }
                walk.hold_foot_like(&pose);
                walk.hold_like(&pose);
                let here = (walk.regime, walk.instant);
                InitialSensitivity { begins: here, goes_on: here, support_heights: walk.support_heights(&pose) }
            }
            Foundation::Rigid => {
                let pose = self.beginning(initial, time, excitation);
                let start = &Start { forcing: Forcing { ties: pose.ties, ..start.forcing }, ..*start };
                let Initial { theta, theta_dot, .. } = start.initial;
                let velocities = Velocities { u_dot: zero, v_dot: zero, theta_dot };
                let level = Placement { corners: [(zero, zero); 2], theta, u: zero, v: zero, velocities };
                let mut walk = Walk::begin(start, pose.contacts.regime(), level);
                let begins = (walk.regime, walk.instant);
                let now = Motion::from_pose(&self.block, &pose, excitation).at(time, pose.state);
                if let Some((pose, path)) = self.released_by(&pose, &now) {
                    for regime in path.iter() {
                        walk.placement = Placement::of(&walk.instant);
                        walk.enter(regime);
                    }
                    walk.hold_foot_like(&pose);
                }
                InitialSensitivity { begins, goes_on: (walk.regime, walk.instant), support_heights: [zero; 2] }
            }
        }
    }
}

/// A block that passes through the regimes of one instant.
struct Walk<'a, T> {
    start: &'a Start<T>,
    placement: Placement<T>,
    footing: Footing<T>,
    regime: Regime,
    instant: Instant<T>,
}

impl<'a, T: Elementary> Walk<'a, T> {
    fn begin(start: &'a Start<T>, regime: Regime, placement: Placement<T>) -> Walk<'a, T> {
        let footing = match regime {
            Regime::Separated => free(&placement),
            Regime::FullContact | Regime::TiltingLeft | Regime::TiltingRight => Footing::Grips { offset: T::from(0.0) },
        };
        let instant = instant(&start.block, regime, placement.state(regime), footing, start.forcing);
        let mut walk = Walk { start, placement, footing, regime, instant };
        walk.follow_regime();
        walk.slide_at_limit();
        walk
    }

    /// Continues in another regime.
    fn enter(&mut self, regime: Regime) {
        let before = self.placement.u;
        if regime == Regime::Separated && !matches!(self.footing, Footing::Free { .. }) {
            self.footing = free(&self.placement);
        }
        self.regime = regime;
        self.look();
        if let (Footing::Grips { offset }, true) = (self.footing, self.start.block.is_extended()) {
            // The place of the block stays.
            self.footing = Footing::Grips { offset: offset + before - self.placement.u };
            self.look();
        }
        self.slide_at_limit();
    }

    /// The foot slides from here on, if H is beyond the limit of friction.
    fn slide_at_limit(&mut self) {
        let (friction, x) = (self.start.block.friction.value(), &self.instant);
        let (h, n) = (x.horizontal.value(), x.reaction[0].value() + x.reaction[1].value());
        if friction > 0.0 && self.footing.grips() && self.regime != Regime::Separated && h.abs() > friction * n {
            let (u, u_dot) = (self.placement.u, self.placement.velocities.u_dot);
            self.footing = Footing::Slides { u, u_dot, direction: -h.signum() };
            self.look();
        }
    }

    /// The foot grips or slides from here on like that of this pose.
    fn hold_foot_like(&mut self, pose: &Pose) {
        let (u, u_dot) = (self.placement.u, self.placement.velocities.u_dot);
        match (self.footing, pose.footing) {
            (Footing::Free { .. }, _) | (Footing::Grips { .. }, Footing::Grips { .. }) => return,
            (_, Footing::Slides { direction, .. }) => self.footing = Footing::Slides { u, u_dot, direction },
            (_, Footing::Free { .. }) => self.footing = Footing::Free { u, u_dot },
            (Footing::Slides { .. }, Footing::Grips { .. }) => {
                self.footing = Footing::Grips { offset: T::from(0.0) };
                self.look();
                self.footing = Footing::Grips { offset: u - self.placement.u };
            }
        }
        self.look();
    }

    /// A corner is held from here on, if one is in this pose.
    fn hold_like(&mut self, pose: &Pose) {
        let Some(corner) = pose.contacts.held() else { return };
        let Walk { start, placement, footing, .. } = self;
        let (block, zero) = (&start.block, T::from(0.0));
        let free = block.free_height(corner);
        let top = if block.damping.value() == 0.0 {
            [free, zero, zero]
        } else {
            let (height, creep) = (placement.corners[corner.index()].0, block.creep_rate());
            let rate = creep * (free - height);
            [height, rate, -(creep * rate)]
        };
        let state = [placement.theta, placement.velocities.theta_dot];
        self.instant = instant_held(block, state, Held { corner, top }, *footing, start.forcing);
        self.follow_regime();
    }

    fn look(&mut self) {
        let Walk { start, placement, footing, regime, .. } = self;
        self.instant = instant(&start.block, *regime, placement.state(*regime), *footing, start.forcing);
        self.follow_regime();
    }

    /// The horizontal motion is that of the regime.
    fn follow_regime(&mut self) {
        (self.placement.u, self.placement.velocities.u_dot) = (self.instant.u, self.instant.u_dot);
    }

    /// Heights of the supports under the corners that have lifted in this pose: free, or where the corner has just left them.
    fn support_heights(&self, pose: &Pose) -> [T; 2] {
        let block = &self.start.block;
        Corner::each(|corner| match pose.contacts.of(corner) {
            Contact::Bearing | Contact::Held(_) => T::from(0.0),
            Contact::Lifted(Creep { depth, .. }) if depth == 0.0 || block.damping.value() == 0.0 => {
                block.free_height(corner)
            }
            Contact::Lifted(_) => self.instant.corner[corner.index()],
        })
    }
}

fn free<T: Elementary>(placement: &Placement<T>) -> Footing<T> {
    Footing::Free { u: placement.u, u_dot: placement.velocities.u_dot }
}
