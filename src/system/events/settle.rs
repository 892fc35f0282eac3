//! The regime after an event: a corner leaves if its support or the rigid base would have to pull it.

use crate::block::{Contact, Corner, Foundation, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::System;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{PoseUpdate, Release, TransitionCounts};
use crate::system::events::friction;
use crate::system::events::grip::{self, pressure_if_gripped};
use crate::system::events::lift_off;
use crate::system::events::placement::Placement;
use crate::system::forces::support::{reaction, reaction_rate};
use crate::system::impact;
use crate::system::instant::{Footing, creeping};

/// A placement, and the footing in it.
type PlacementAndFooting<T> = (Placement<T>, Footing<T>);

impl<T: Elementary> PoseUpdate<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Decides the regime: drops touching corners one by one while a support would pull. It would pull now, or within round-off of time.
    ///
    /// `before` is the previous regime.
    pub(in crate::system) fn resolve_regime(
        &mut self,
        mut before: Regime,
        mut placement: Placement<T>,
    ) -> TransitionCounts {
        let mut counts = TransitionCounts::NONE;
        let block = &self.system.block;
        // Events closer than this differ by round-off. Far from t = 0 the clock may show one time for distinct events.
        let resolution = 4.0 * f64::EPSILON / block.omega_v.value().max(block.p.value());
        loop {
            self.pose.contacts.let_bear();
            let regime = self.regime();
            if let (Regime::FullContact, Some(pivot), true) = (before, regime.pivot(), self.pose.footing.grips()) {
                let kept = if self.landed && block.tracks_foot() {
                    let (kept, of_trial) = self.with_momentum(pivot, &placement);
                    counts += of_trial;
                    kept
                } else {
                    None
                };
                placement = match kept {
                    Some((kept, footing)) => {
                        self.pose.footing = footing;
                        kept
                    }
                    None => {
                        let held = placement.with_pivot_constraint(block, pivot);
                        let gained = held.velocities.kinetic(block) - placement.velocities.kinetic(block);
                        counts += TransitionCounts::constraint(gained.value());
                        held
                    }
                };
            }
            before = regime;
            if regime == Regime::Separated && !matches!(self.pose.footing, Footing::Free { .. }) {
                self.pose.footing = Footing::Free { u: placement.u, u_dot: placement.velocities.u_dot };
            }
            self.place(&placement);
            counts += self.apply_friction(&mut placement);
            counts += self.place_foot(&placement);
            counts += TransitionCounts::EVALUATION;
            let mut now = self.now();
            let slides = !self.pose.footing.grips() && regime != Regime::Separated && block.friction.value() == 0.0;
            if slides && pressure_if_gripped(block, regime, &now.instant).value() > grip::rounding(block) {
                counts += self.grip(&mut placement) + TransitionCounts::EVALUATION;
                now = self.now();
            }
            (placement.u, placement.velocities.u_dot) = (now.instant.u, now.instant.u_dot);
            let mut leaving: Option<(Corner, f64)> = None;
            for corner in Corner::BOTH.into_iter().filter(|&corner| regime.touches(corner)) {
                let (height, rate) = placement.corners[corner.index()];
                let n = reaction(block, corner, height, rate).value();
                // For a reaction of zero the rate decides.
                let n = if n.abs() <= lift_off::rounding(block) { 0.0 } else { n };
                match self.classify_unloading(corner, n, rate, resolution, &now) {
                    Some(Release::Lifts) if leaving.is_none_or(|(_, least)| n.total_cmp(&least).is_lt()) => {
                        leaving = Some((corner, n));
                    }
                    Some(Release::Lifts) | None => {}
                    Some(Release::Held) => {
                        self.pose.contacts.let_bear();
                        counts += self.hold_corner(corner, height);
                    }
                    Some(Release::Slides) => self.free_horizontally(&now.instant),
                }
            }
            let Some((corner, _)) = leaving else { break };
            counts += self.lift_off_support(corner, &placement);
        }
        if self.landed {
            counts += self.rejoin_supports();
        }
        counts
    }

    /// Restarts the recovery of supports whose corners landed and lifted in this instant, from the heights of the corners.
    ///
    /// Such a corner keeps its height, and the clock may be off the landing by its resolution, in which supports creep.
    fn rejoin_supports(&mut self) -> TransitionCounts {
        let leaves_now = |contact: Contact<T>| matches!(contact, Contact::Lifted(creep) if creep.since.value() == self.pose.time.value());
        let leaving = Corner::each(|corner| leaves_now(self.pose.contacts.of(corner)));
        if !leaving.contains(&true) {
            return TransitionCounts::NONE;
        }
        let x = self.now().instant;
        for corner in Corner::BOTH.into_iter().filter(|corner| leaving[corner.index()]) {
            self.pose.contacts.set(corner, Contact::Lifted(self.creep_from(corner, x.corner[corner.index()])));
        }
        TransitionCounts::EVALUATION
    }

    /// Returns placement and footing after a corner landed and lifted in the same instant. An impulse stops the `pivot`. With friction, or
    /// if the impulse would lift it, it slides.
    ///
    /// `None` if the gap of that corner would close again at once.
    fn with_momentum(
        &self,
        pivot: Corner,
        before: &Placement<T>,
    ) -> (Option<PlacementAndFooting<T>>, TransitionCounts) {
        let (block, i) = (&self.system.block, pivot.other().index());
        let mut after = *before;
        let mut trial = *self;
        let (mut footing, mut counts) = (self.pose.footing, TransitionCounts::NONE);
        if block.friction.value() == 0.0 {
            let slides = Footing::Free { u: after.u, u_dot: after.velocities.u_dot };
            trial.pose.footing = slides;
            trial.place(&after);
            counts += TransitionCounts::EVALUATION;
            if pressure_if_gripped(block, trial.regime(), &trial.now().instant).value() < -grip::rounding(block) {
                footing = slides;
            } else {
                after.set_velocities(block, impact::grip(block, trial.regime(), after.theta, after.velocities));
            }
        }
        trial.pose.footing = footing;
        trial.place(&after);
        counts += trial.apply_friction(&mut after) + trial.place_foot(&after) + TransitionCounts::EVALUATION;
        let now = trial.now();
        let support = self.support(pivot.other()).eps;
        let rate = (after.corners[i].1 - support).value();
        let opens = if rate.abs() > friction::speed_rounding(block) {
            rate > 0.0
        } else {
            (now.instant.corner_ddot[i] - creeping(block, support)).value() >= 0.0
        };
        (opens.then_some((after, footing)), counts)
    }

    /// Returns whether and how a touching corner leaves its support. It has the reaction `n` per mass (m/s²) and the rate `corner_dot`
    /// (m/s).
    fn classify_unloading(
        &self,
        corner: Corner,
        n: f64,
        corner_dot: T,
        resolution: f64,
        now: &Evaluation<T>,
    ) -> Option<Release> {
        if n < 0.0 {
            return Some(Release::Lifts);
        }
        let falling = {
            let corner_ddot = now.instant.corner_ddot[corner.index()];
            let rate = reaction_rate(&self.system.block, corner_dot, corner_ddot).value();
            // If the rate is zero as well, as after a landing at ε = 0 without damping, the next derivative decides.
            n + rate * resolution < 0.0 || (n == 0.0 && (rate < 0.0 || (rate == 0.0 && corner_ddot.value() > 0.0)))
        };
        if !falling {
            None
        } else if self.gap_would_open(corner, corner_dot, now) {
            Some(Release::Lifts)
        } else {
            match now.regime {
                Regime::FullContact => Some(Release::Held),
                Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated
                    if self.system.block.friction.value() > 0.0 =>
                {
                    Some(Release::Lifts)
                }
                Regime::TiltingLeft | Regime::TiltingRight | Regime::Separated => Some(Release::Slides),
            }
        }
    }

    /// Lets corners leave the rigid base that it would have to pull. Returns how the last of them left.
    pub(super) fn resolve_regime_on_rigid_base(&mut self) -> (Option<Release>, TransitionCounts) {
        let before = self.apply_friction_here();
        let (last, counts) = self.resolve_regime_under_friction();
        (last, before + counts)
    }

    /// Settles the block on the rigid base after friction has been applied.
    pub(super) fn resolve_regime_under_friction(&mut self) -> (Option<Release>, TransitionCounts) {
        let (mut last, mut counts) = (None, TransitionCounts::NONE);
        loop {
            counts += TransitionCounts::EVALUATION;
            let now = self.now();
            let Some(corner) = self.system.leaving_rigid_base(&now) else { return (last, counts) };
            let (release, of_corner) = self.unload_rigid_corner(corner, &now);
            last = Some(release);
            counts += of_corner + self.apply_friction_here();
        }
    }
}

impl<T: Elementary> System<T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Returns the corner that the rigid base would have to pull now or right after. Of two, it is the one with the lower reaction.
    ///
    /// `None` on supports, whose reactions are continuous.
    pub fn leaving_rigid_base(&self, now: &Evaluation<T>) -> Option<Corner> {
        if self.block.foundation == Foundation::Viscoelastic {
            return None;
        }
        let falls = |corner: Corner| lift_off::reaction(Foundation::Rigid, now, corner).eps.value() < 0.0;
        Corner::BOTH
            .into_iter()
            .filter(|&corner| now.regime.touches(corner))
            .map(|corner| (corner, now.instant.reaction[corner.index()].value()))
            .filter(|&(corner, n)| n < 0.0 || (n == 0.0 && falls(corner)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(corner, _)| corner)
    }
}

impl Evaluation<'_> {
    /// Whether the block is at rest: on both corners, with accelerations and motion below round-off. The round-off is that of the
    /// reactions.
    pub fn rests(&self) -> bool {
        let rounding = lift_off::rounding(self.body);
        self.regime == Regime::FullContact
            && self.footing.grips()
            && self.rest_residuals().into_iter().all(|acceleration| acceleration <= rounding)
    }
}
