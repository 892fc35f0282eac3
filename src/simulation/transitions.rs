//! An event → what it does, and the regime anew.

use crate::block::Foundation;
use crate::dynamics::{Footing, Instant, energy};
use crate::events::{Creep, Event, EventKind, Surface, gap_opening, pressure_if_gripped, reaction_rate};
use crate::excitation::Excitation;
use crate::impact::{self, Velocities};
use crate::regime::{Corner, Regime};
use crate::simulation::motion::Point;
use crate::simulation::placement::Placement;
use crate::simulation::{Ending, LiftOff, Simulation, SimulationError};

impl Simulation {
    /// What the event does, and the regime anew.
    pub(super) fn apply(
        &mut self,
        surface: Surface,
        at: &Point,
        excitation: &Excitation,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        const MOST_EVENTS_IN_AN_INSTANT: u32 = 64;
        self.events_in_this_instant += 1;
        if self.events_in_this_instant > MOST_EVENTS_IN_AN_INSTANT {
            return Err(SimulationError::NoRegime { time: self.time, count: self.events_in_this_instant });
        }
        let before = self.regime;
        let energy_before = self.energy_of(&at.instant);
        self.last_event = self.time;
        let kind = match surface {
            Surface::Reaction(corner) | Surface::Held(corner) => {
                match self.block.foundation {
                    Foundation::Viscoelastic => self.lift(corner, surface, at, excitation),
                    Foundation::Rigid => self.lift_from_rigid_base(corner, at, excitation),
                }
                if self.regime == before && !self.footing.grips() {
                    EventKind::Slip
                } else {
                    EventKind::LiftOff(corner)
                }
            }
            Surface::Gap(corner) => {
                match (self.block.foundation, self.footing.grips()) {
                    (Foundation::Viscoelastic, true) => self.land(corner, at, excitation),
                    (Foundation::Viscoelastic, false) => self.land_freely(corner, at, excitation),
                    (Foundation::Rigid, true) => self.change_pivot(corner, at, excitation),
                    (Foundation::Rigid, false) => self.land_on_rigid_base(corner, at, excitation),
                }
                EventKind::Landing(corner)
            }
            Surface::Slide => {
                let mut now = Placement::of(&at.instant, before);
                match self.block.foundation {
                    Foundation::Viscoelastic => {
                        self.grip(&mut now, excitation);
                        self.settle(now, excitation);
                    }
                    Foundation::Rigid => self.grip_rigid_base(now, excitation),
                }
                EventKind::Grip
            }
            Surface::QuarterTurn => {
                self.end(Ending::Overturned);
                EventKind::Overturning
            }
        };
        let after = self.point(excitation);
        self.sums.impacts += energy_before - self.energy_of(&after.instant);
        if self.held.is_some() && self.regime == before {
            // Nothing happened that a user would see: the corner is held from here on.
            return Ok(());
        }
        self.end_if_separated();
        observer(&Event { time: self.time, kind, before, after: self.regime });
        Ok(())
    }

    /// The reaction of `corner` fell through zero.
    fn lift(&mut self, corner: Corner, surface: Surface, at: &Point, excitation: &Excitation) {
        let x = &at.instant;
        // A foot that slides lifts just when its gap opens; and the paper's analysis ends where the last reaction falls.
        let opens = !self.footing.grips() || self.lets_go(corner, x.corner_dot[corner.index()], at, excitation);
        match self.regime {
            Regime::FullContact => {
                self.held = (!opens && matches!(surface, Surface::Reaction(_))).then_some(corner);
                if self.held.is_some() {
                    return;
                }
            }
            _ if !opens => return self.release(x),
            _ => {}
        }
        let mut now = Placement::of(x, self.regime);
        self.take_off(corner, &mut now);
        self.settle(now, excitation);
    }

    /// Whether the gap under `corner`, which bears nothing any more, opens once it is let go. The paper's analysis ends
    /// when the last corner bears nothing.
    fn lets_go(&self, corner: Corner, corner_dot: f64, at: &Point, excitation: &Excitation) -> bool {
        let last = !self.regime.touches(corner.other());
        (last && !self.flies()) || gap_opening(&self.moment(at, excitation), corner, corner_dot) >= 0.0
    }

    /// The gap under `corner` closed while the other corner stands and grips.
    fn land(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        let mut now = Placement::of(&at.instant, self.regime);
        let block = &self.block;
        let before = now.velocities;
        self.put_down(corner, &mut now);
        let rate = now.corners[corner.index()].1;
        if rate < 0.0 {
            let (v_dot, theta_dot) = impact::landing(block, corner, now.theta, before.v_dot, before.theta_dot);
            now.strike(block, Velocities { v_dot, theta_dot, ..before });
            // Exactly ε times the rate before, which the map gives only to rounding.
            now.corners[corner.index()].1 = block.epsilon * rate;
            self.counts.impacts += 1;
            self.sums.constraint += impact::landing_loss(block, corner, now.theta, rate);
        }
        now.velocities.u_dot = block.h * libm::cos(now.theta) * now.velocities.theta_dot;
        self.sums.constraint += now.velocities.kinetic(block) - before.kinetic(block);
        self.settle(now, excitation);
    }

    /// `corner` touches from now on, at the height of its support.
    pub(super) fn put_down(&self, corner: Corner, now: &mut Placement) {
        now.touching[corner.index()] = true;
        now.corners[corner.index()].0 = self.creep[corner.index()].top(&self.block, self.time).value;
    }

    /// `corner` has left its support, which creeps back from here on.
    fn take_off(&mut self, corner: Corner, now: &mut Placement) {
        let i = corner.index();
        now.touching[i] = false;
        self.creep[i] = Creep { depth: self.block.static_deflection() - now.corners[i].0, since: self.time };
        self.counts.liftoffs += 1;
    }

    /// Decides the regime: takes the corners that touch, drops one whose support would have to pull, or would have to
    /// within the resolution of time, and repeats.
    pub(super) fn settle(&mut self, mut now: Placement, excitation: &Excitation) {
        let block = self.block;
        let omega_v = block.omega_v;
        self.held = None;
        // Two events closer than this cannot be told apart.
        let resolution = 4.0 * f64::EPSILON * self.time.abs().max(1.0 / omega_v);
        loop {
            let before = std::mem::replace(&mut self.regime, now.regime());
            if let (Regime::FullContact, Some(pivot), true) = (before, self.regime.pivot(), self.footing.grips()) {
                self.hold_pivot(pivot, &mut now);
            }
            if self.regime == Regime::Separated && self.footing.grips() {
                self.footing = Footing::Free { u: now.u, u_dot: now.velocities.u_dot };
            }
            self.state = now.state();
            let mut point = self.point(excitation);
            let slides = !self.footing.grips() && self.regime != Regime::Separated;
            if slides && pressure_if_gripped(&block, self.regime, &point.instant) > Surface::Slide.rounding(&block) {
                self.grip(&mut now, excitation);
                point = self.point(excitation);
            }
            (now.u, now.velocities.u_dot) = (point.instant.u, point.instant.u_dot);
            let drop = Corner::BOTH
                .into_iter()
                .filter(|corner| now.touching[corner.index()])
                .map(|corner| {
                    let (height, rate) = now.corners[corner.index()];
                    let n = 0.5 * block.gravity - 0.5 * omega_v * omega_v * height - block.xi_v * omega_v * rate;
                    // What rounding left of a zero, and then the rate decides.
                    let n = if n.abs() <= Surface::Reaction(corner).rounding(&block) { 0.0 } else { n };
                    (corner, n, rate)
                })
                .filter(|&(corner, n, rate)| self.cannot_stay(corner, n, rate, resolution, &point, excitation))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((corner, ..)) = drop else { break };
            self.take_off(corner, &mut now);
        }
    }

    /// The other corner has left full contact: from here on the `pivot` is held, no more the middle of the base.
    fn hold_pivot(&mut self, pivot: Corner, now: &mut Placement) {
        let block = &self.block;
        let before = now.velocities;
        if self.settings.lift_off == LiftOff::KeepMomentum {
            let theta_dot = impact::new_pivot(block, pivot, now.theta, before.theta_dot);
            now.strike(block, Velocities { theta_dot, ..before });
        }
        now.velocities.u_dot = impact::height_over(block, pivot, now.theta) * now.velocities.theta_dot;
        self.sums.constraint += now.velocities.kinetic(block) - before.kinetic(block);
    }

    /// Whether a touching corner with the reaction `n` (per mass) and the vertical rate `corner_dot` leaves its support
    /// now.
    pub(super) fn cannot_stay(
        &mut self,
        corner: Corner,
        n: f64,
        corner_dot: f64,
        resolution: f64,
        point: &Point,
        excitation: &Excitation,
    ) -> bool {
        if n < 0.0 {
            return true;
        }
        let falling = {
            let corner_ddot = point.instant.corner_ddot[corner.index()];
            let rate = reaction_rate(&self.block, corner_dot, corner_ddot);
            // Without damping and after a landing at ε = 0 the rate is zero, and the next derivative decides.
            n + rate * resolution < 0.0 || (n == 0.0 && (rate < 0.0 || (rate == 0.0 && corner_ddot > 0.0)))
        };
        if !falling || !self.footing.grips() || self.lets_go(corner, corner_dot, point, excitation) {
            return falling;
        }
        match self.regime {
            Regime::FullContact => self.held = Some(corner),
            _ => self.release(&point.instant),
        }
        false
    }

    pub(super) fn end_if_separated(&mut self) {
        if self.regime == Regime::Separated && !self.flies() {
            self.end(Ending::at_separation(self.block.alpha, self.state[0], self.state[1]));
        }
    }

    fn end(&mut self, ending: Ending) {
        self.ending = Some((ending, self.time));
    }

    /// Whether a held corner bears weight again.
    pub(super) fn bears(&self, corner: Corner, at: &Point) -> bool {
        at.instant.reaction[corner.index()] > Surface::Reaction(corner).rounding(&self.block)
    }

    pub(super) fn energy_of(&self, instant: &Instant<f64>) -> f64 {
        let (kinetic, potential) = energy(&self.block, self.regime, instant);
        kinetic + potential
    }
}
