//! An event → what it does, and the regime anew.

use crate::block::Foundation;
use crate::dynamics::{Instant, State, energy};
use crate::events::{Creep, Event, EventKind, Surface, gap_opening, reaction_rate};
use crate::excitation::Excitation;
use crate::impact;
use crate::regime::{Corner, Regime};
use crate::simulation::stepping::Point;
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
                    Foundation::Rigid => self.start_to_rock(corner),
                }
                EventKind::LiftOff(corner)
            }
            Surface::Gap(corner) => {
                match self.block.foundation {
                    Foundation::Viscoelastic => self.land(corner, at, excitation),
                    Foundation::Rigid => self.change_pivot(corner, at),
                }
                EventKind::Landing(corner)
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
        if self.regime == Regime::Separated {
            self.end(Ending::Separated);
        }
        observer(&Event { time: self.time, kind, before, after: self.regime });
        Ok(())
    }

    /// The reaction of `corner` fell through zero.
    pub(super) fn lift(&mut self, corner: Corner, surface: Surface, at: &Point, excitation: &Excitation) {
        let mut touching = Corner::BOTH.map(|c| self.regime.touches(c));
        let opens = self.regime != Regime::FullContact || {
            let rate = at.instant.corner_dot[corner.index()];
            gap_opening(&self.moment(at, excitation), corner, rate) >= 0.0
        };
        self.held = (!opens && matches!(surface, Surface::Reaction(_))).then_some(corner);
        if self.held.is_some() {
            return;
        }
        let corners = corners_of(&at.instant);
        touching[corner.index()] = false;
        self.creep[corner.index()] =
            Creep { depth: self.block.static_deflection() - corners[corner.index()].0, since: self.time };
        self.counts.liftoffs += 1;
        let Instant { theta, theta_dot, v, v_dot, .. } = at.instant;
        self.settle(touching, corners, theta, theta_dot, v, v_dot, excitation);
    }

    /// The gap under `corner` closed while the other corner stands.
    pub(super) fn land(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        let i = corner.index();
        let Instant { theta, mut theta_dot, v, mut v_dot, .. } = at.instant;
        let mut corners = corners_of(&at.instant);
        corners[i].0 = self.creep[i].top(&self.block, self.time).value;
        if corners[i].1 < 0.0 {
            (v_dot, theta_dot) = impact::landing(&self.block, corner, theta, v_dot, theta_dot);
            let standing = corner.other();
            corners[standing.index()].1 = impact::corner_rate(&self.block, standing, theta, v_dot, theta_dot);
            // Exactly ε times the rate before, which the map gives only to rounding.
            corners[i].1 *= self.block.epsilon;
            self.counts.impacts += 1;
        }
        self.settle([true; 2], corners, theta, theta_dot, v, v_dot, excitation);
    }

    /// Decides the regime: takes the corners that touch, drops one whose support would have to pull, or would have to
    /// within the resolution of time, and repeats. Heights and rates of the corners are given beside `v`, `v̇`, since
    /// their exact values (a rate of zero, say) decide.
    #[expect(clippy::too_many_arguments, reason = "the state before it is known which coordinates describe it")]
    pub(super) fn settle(
        &mut self,
        mut touching: [bool; 2],
        mut corners: [(f64, f64); 2],
        theta: f64,
        mut theta_dot: f64,
        v: f64,
        v_dot: f64,
        excitation: &Excitation,
    ) {
        let block = self.block;
        let omega_v = block.omega_v;
        self.held = None;
        // Two events closer than this cannot be told apart.
        let resolution = 4.0 * f64::EPSILON * self.time.abs().max(1.0 / omega_v);
        loop {
            let before = std::mem::replace(&mut self.regime, Regime::of_touching(touching));
            if let (LiftOff::KeepMomentum, Regime::FullContact, Some(pivot)) =
                (self.settings.lift_off, before, self.regime.pivot())
            {
                theta_dot = impact::new_pivot(&block, pivot, theta, theta_dot);
                corners[pivot.index()].1 = impact::corner_rate(&block, pivot, theta, v_dot, theta_dot);
            }
            let (w, w_dot) = match self.regime {
                Regime::FullContact => (0.5 * (corners[0].0 + corners[1].0), 0.5 * (corners[0].1 + corners[1].1)),
                Regime::TiltingLeft => corners[0],
                Regime::TiltingRight => corners[1],
                Regime::Separated => (v, v_dot),
            };
            self.state = State::new(theta, theta_dot, w, w_dot);
            let point = self.point(excitation);
            let drop = Corner::BOTH
                .into_iter()
                .filter(|corner| touching[corner.index()])
                .map(|corner| {
                    let (height, rate) = corners[corner.index()];
                    let n = 0.5 * block.gravity - 0.5 * omega_v * omega_v * height - block.xi_v * omega_v * rate;
                    (corner, n, rate)
                })
                .filter(|&(corner, n, rate)| self.cannot_stay(corner, n, rate, resolution, &point, excitation))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((corner, ..)) = drop else { break };
            touching[corner.index()] = false;
            self.creep[corner.index()] =
                Creep { depth: block.static_deflection() - corners[corner.index()].0, since: self.time };
            self.counts.liftoffs += 1;
        }
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
        let opening = || gap_opening(&self.moment(point, excitation), corner, corner_dot);
        if falling && self.regime == Regime::FullContact && opening() < 0.0 {
            self.held = Some(corner);
            return false;
        }
        falling
    }

    /// On the rigid base, `corner` lifts from rest.
    pub(super) fn start_to_rock(&mut self, corner: Corner) {
        self.regime = Regime::on(corner.other());
        self.state = State::zeros();
        self.counts.liftoffs += 1;
    }

    /// On the rigid base, the pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, at: &Point) {
        // Rocking comes to rest after infinitely many impacts in finite time; below this part of p they are not told
        // apart any more.
        const REST: f64 = 1e-9;
        let theta_dot = self.block.restitution().max(0.0) * at.state[1];
        self.counts.impacts += 1;
        if theta_dot.abs() < REST * self.block.p {
            self.regime = Regime::FullContact;
            self.state = State::zeros();
        } else {
            self.regime = Regime::on(corner);
            self.state = State::new(0.0, theta_dot, 0.0, 0.0);
            self.counts.liftoffs += 1;
        }
    }

    pub(super) fn end(&mut self, ending: Ending) {
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

fn corners_of(x: &Instant<f64>) -> [(f64, f64); 2] {
    [(x.corner[0], x.corner_dot[0]), (x.corner[1], x.corner_dot[1])]
}
