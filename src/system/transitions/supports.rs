//! Lift-off from the supports and landing on them while the other corner stands; the regime anew.

use crate::contact::{Contact, Creep};
use crate::contact::{Corner, Regime};
use crate::system::dynamics::{Footing, Instant};
use crate::system::impact::{self, Velocities};
use crate::system::now::Now;
use crate::system::surfaces::{Surface, gap_opening, pressure_if_gripped, reaction_rate};
use crate::system::transitions::placement::Placement;
use crate::system::transitions::{Change, Leaving};

impl Change<'_> {
    /// The reaction of `corner` fell through zero, or the corner is not held any more.
    pub(super) fn lift(&mut self, corner: Corner, surface: Surface, now: &Now) -> Leaving {
        let x = &now.instant;
        // A foot that slides lifts just when its gap opens; and the paper's analysis ends where the last reaction falls.
        let opens = !self.pose.footing.grips() || self.lets_go(corner, x.corner_dot[corner.index()], now);
        match self.regime() {
            Regime::FullContact => {
                let other_is_held = self.contacts().held() == Some(corner.other());
                self.pose.contacts.let_bear();
                if !opens && other_is_held {
                    return self.bear_nothing(x);
                }
                if !opens && matches!(surface, Surface::Reaction(_)) {
                    self.keep(corner, x.corner[corner.index()]);
                    return Leaving::Held;
                }
            }
            Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated if !opens => {
                self.release(x);
                return Leaving::Slides;
            }
            Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated => {}
        }
        let (before, placement) = (self.regime(), Placement::of(x));
        self.take_off(corner, &placement);
        self.settle(before, placement);
        Leaving::Lifts
    }

    /// Neither corner bears anything, so that nothing holds the block horizontally. The paper's analysis ends here.
    fn bear_nothing(&mut self, x: &Instant<f64>) -> Leaving {
        let placement = Placement::of(x);
        if self.system.flies {
            self.release(x);
        } else {
            for corner in Corner::BOTH {
                self.take_off(corner, &placement);
            }
        }
        self.settle(Regime::FullContact, placement);
        if self.regime() == Regime::FullContact { Leaving::Slides } else { Leaving::Lifts }
    }

    /// Whether the gap under `corner`, which bears nothing any more, opens once it is let go. The paper's analysis ends
    /// when the last corner bears nothing.
    fn lets_go(&self, corner: Corner, corner_dot: f64, now: &Now) -> bool {
        let last = !now.regime.touches(corner.other());
        (last && !self.system.flies) || gap_opening(now, corner, corner_dot) >= 0.0
    }

    /// The gap under `corner` closed while the other corner stands and grips.
    pub(super) fn land(&mut self, corner: Corner, now: &Now) {
        let block = &self.system.block;
        let (regime, mut placement) = (self.regime(), Placement::of(&now.instant));
        let before = placement.velocities;
        self.put_down(corner, &mut placement);
        let rate = placement.corners[corner.index()].1;
        if rate < 0.0 {
            let (v_dot, theta_dot) = impact::landing(block, corner, placement.theta, before.v_dot, before.theta_dot);
            placement.strike(block, Velocities { v_dot, theta_dot, ..before });
            // Exactly ε times the rate before, which the map gives only to rounding.
            placement.corners[corner.index()].1 = block.epsilon * rate;
            self.tally.impacts += 1;
            self.tally.constraint += impact::landing_loss(block, corner, placement.theta, rate);
        }
        placement.velocities.u_dot = block.h * libm::cos(placement.theta) * placement.velocities.theta_dot;
        self.tally.constraint += placement.velocities.kinetic(block) - before.kinetic(block);
        self.settle(regime, placement);
    }

    /// `corner` touches from now on, at the height of its support.
    pub(super) fn put_down(&mut self, corner: Corner, placement: &mut Placement) {
        placement.corners[corner.index()].0 = self.support(corner).value;
        self.set(corner, Contact::Bearing);
    }

    /// `corner` has left its support, which creeps back from here on.
    fn take_off(&mut self, corner: Corner, placement: &Placement) {
        self.set(corner, Contact::Lifted(self.creep_from(placement.corners[corner.index()].0)));
        self.tally.liftoffs += 1;
    }

    /// `corner` is held on its support at this height (m).
    fn keep(&mut self, corner: Corner, height: f64) {
        self.set(corner, Contact::Held(self.creep_from(height)));
    }

    /// A support that bears nothing from here on creeps back from this height (m).
    fn creep_from(&self, height: f64) -> Creep {
        Creep { depth: self.system.block.static_deflection() - height, since: self.pose.time }
    }

    /// Decides the regime: takes the corners that touch, drops one whose support would have to pull, or would have to
    /// within the resolution of time, and repeats. `before` is the regime that the block comes from.
    pub(super) fn settle(&mut self, mut before: Regime, mut placement: Placement) {
        let block = &self.system.block;
        let omega_v = block.omega_v;
        // Two events closer than this cannot be told apart.
        let resolution = 4.0 * f64::EPSILON * self.pose.time.abs().max(1.0 / omega_v);
        loop {
            self.pose.contacts.let_bear();
            let regime = self.regime();
            if let (Regime::FullContact, Some(pivot), true) = (before, regime.pivot(), self.pose.footing.grips()) {
                self.hold_pivot(pivot, &mut placement);
            }
            before = regime;
            if regime == Regime::Separated && self.pose.footing.grips() {
                self.pose.footing = Footing::Free { u: placement.u, u_dot: placement.velocities.u_dot };
            }
            self.place(&placement);
            let mut now = self.now();
            let slides = !self.pose.footing.grips() && regime != Regime::Separated;
            if slides && pressure_if_gripped(block, regime, &now.instant) > Surface::Slide.rounding(block) {
                self.grip(&mut placement);
                now = self.now();
            }
            (placement.u, placement.velocities.u_dot) = (now.instant.u, now.instant.u_dot);
            let mut leaving: Option<(Corner, f64)> = None;
            for corner in Corner::BOTH.into_iter().filter(|&corner| regime.touches(corner)) {
                let (height, rate) = placement.corners[corner.index()];
                let n = 0.5 * block.gravity - 0.5 * omega_v * omega_v * height - block.xi_v * omega_v * rate;
                // What rounding left of a zero, and then the rate decides.
                let n = if n.abs() <= Surface::Reaction(corner).rounding(block) { 0.0 } else { n };
                match self.leaves(corner, n, rate, resolution, &now) {
                    Some(Leaving::Lifts) if leaving.is_none_or(|(_, least)| n.total_cmp(&least).is_lt()) => {
                        leaving = Some((corner, n));
                    }
                    Some(Leaving::Lifts) | None => {}
                    Some(Leaving::Held) => {
                        self.pose.contacts.let_bear();
                        self.keep(corner, height);
                    }
                    Some(Leaving::Slides) => self.release(&now.instant),
                }
            }
            let Some((corner, _)) = leaving else { break };
            self.take_off(corner, &placement);
        }
    }

    /// [`Placement::hold_pivot`], and the energy that comes with it.
    fn hold_pivot(&mut self, pivot: Corner, placement: &mut Placement) {
        let block = &self.system.block;
        let before = placement.velocities;
        placement.hold_pivot(block, pivot);
        self.tally.constraint += placement.velocities.kinetic(block) - before.kinetic(block);
    }

    /// Whether and how a touching corner with the reaction `n` (per mass) and the vertical rate `corner_dot` leaves its
    /// support now.
    fn leaves(&self, corner: Corner, n: f64, corner_dot: f64, resolution: f64, now: &Now) -> Option<Leaving> {
        if n < 0.0 {
            return Some(Leaving::Lifts);
        }
        let falling = {
            let corner_ddot = now.instant.corner_ddot[corner.index()];
            let rate = reaction_rate(&self.system.block, corner_dot, corner_ddot);
            // Without damping and after a landing at ε = 0 the rate is zero, and the next derivative decides.
            n + rate * resolution < 0.0 || (n == 0.0 && (rate < 0.0 || (rate == 0.0 && corner_ddot > 0.0)))
        };
        if !falling {
            None
        } else if !self.pose.footing.grips() || self.lets_go(corner, corner_dot, now) {
            Some(Leaving::Lifts)
        } else {
            match now.regime {
                Regime::FullContact => Some(Leaving::Held),
                Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated => Some(Leaving::Slides),
            }
        }
    }
}
