//! The rigid base: lift-off, Housner's change of the pivot, slip, landing from flight, grip.
//!
//! No corner is pulled. Let go, the last corner either rises or is pressed on; if it is pressed on, it slides along the base
//! without friction until it can be held again, as it does on supports.

use crate::block::Foundation;
use crate::dynamics::{Footing, State, instant};
use crate::events::Surface;
use crate::excitation::Excitation;
use crate::impact::{self, Velocities};
use crate::regime::{Corner, Regime};
use crate::simulation::motion::Point;
use crate::simulation::placement::Placement;
use crate::simulation::{Initial, Simulation};

impl Simulation {
    pub(super) fn place_on_rigid_base(&mut self, initial: &Initial) {
        let lean = if initial.theta != 0.0 { initial.theta } else { initial.theta_dot };
        self.regime = match lean {
            lean if lean < 0.0 => Regime::TiltingLeft,
            lean if lean > 0.0 => Regime::TiltingRight,
            _ => Regime::FullContact,
        };
        self.state = State::new(initial.theta, initial.theta_dot, 0.0, 0.0);
    }

    /// The corner on the rigid base that would have to be pulled at this point or right after it, the one more so if both
    /// would; none on supports, whose reactions follow from the motion.
    pub(super) fn leaving_rigid_base(&self, at: &Point, excitation: &Excitation) -> Option<Corner> {
        if self.block.foundation == Foundation::Viscoelastic {
            return None;
        }
        let falls = |corner: Corner| Surface::Reaction(corner).sample(&self.moment(at, excitation)).rate < 0.0;
        Corner::BOTH
            .into_iter()
            .filter(|&corner| self.regime.touches(corner))
            .map(|corner| (corner, at.instant.reaction[corner.index()]))
            .filter(|&(corner, n)| n < 0.0 || (n == 0.0 && falls(corner)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(corner, _)| corner)
    }

    /// How the block goes on from this point if a corner cannot stay on the rigid base; nothing if all can.
    pub(super) fn released(&self, at: &Point, excitation: &Excitation) -> Option<Simulation> {
        let corner = self.leaving_rigid_base(at, excitation)?;
        let mut released = self.clone();
        released.lift_from_rigid_base(corner, at, excitation);
        Some(released)
    }

    /// `corner` is not held on the rigid base any more, nor is any other that would have to be pulled then.
    pub(super) fn lift_from_rigid_base(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        self.let_go(corner, at);
        self.settle_on_rigid_base(excitation);
    }

    fn settle_on_rigid_base(&mut self, excitation: &Excitation) {
        loop {
            let point = self.point(excitation);
            match self.leaving_rigid_base(&point, excitation) {
                Some(corner) => self.let_go(corner, &point),
                None => break,
            }
        }
    }

    /// `corner` lifts, or slides from here on if it is the last one and would be pressed on without being held. The paper's
    /// analysis ends when the last corner bears nothing.
    fn let_go(&mut self, corner: Corner, at: &Point) {
        let x = &at.instant;
        let last = !self.regime.touches(corner.other());
        if last && self.flies() && self.footing.grips() {
            let flight = Footing::Free { u: x.u, u_dot: x.u_dot };
            let state = [x.theta, x.theta_dot, x.v, x.v_dot];
            let free = instant(&self.block, Regime::Separated, state, flight, at.forcing);
            if free.corner_ddot[corner.index()] < 0.0 {
                return self.release(x);
            }
        }
        let mut now = Placement::of(x, self.regime);
        now.touching[corner.index()] = false;
        self.counts.liftoffs += 1;
        self.go_on_from(&now);
    }

    /// Without any corner on the base, the block flies.
    fn go_on_from(&mut self, now: &Placement) {
        (self.regime, self.state) = (now.regime(), now.state());
        if self.regime == Regime::Separated {
            self.footing = Footing::Free { u: now.u, u_dot: now.velocities.u_dot };
        }
    }

    /// The pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
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
        self.settle_on_rigid_base(excitation);
    }

    /// `corner` comes down from flight, or while the other one slides.
    pub(super) fn land_on_rigid_base(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        let other = corner.other();
        let now = Placement::of(&at.instant, self.regime);
        let gap = Surface::Gap(other).sample(&self.moment(at, excitation));
        let level = gap.value <= Surface::Gap(other).rounding(&self.block) && gap.rate < 0.0;
        if self.regime == Regime::Separated && level {
            let (impulses, rates, velocities) = self.level_landing(&now);
            if impulses.iter().all(|&impulse| impulse >= 0.0) {
                self.counts.impacts += 2;
                self.come_down(now, velocities, rates.map(Some), excitation);
            } else if impulses[corner.index()] < 0.0 {
                self.land_on_corner(other, now, excitation);
            } else {
                self.land_on_corner(corner, now, excitation);
            }
        } else {
            self.land_on_corner(corner, now, excitation);
        }
    }

    /// Impulses, rates of the corners and velocities of the block if both corners come down at once.
    fn level_landing(&self, now: &Placement) -> ([f64; 2], [f64; 2], Velocities) {
        let block = &self.block;
        let land = |rates: [f64; 2]| impact::landing_on_both(block, now.theta, now.velocities, rates);
        let rates = Corner::BOTH.map(|corner| self.rebound(corner, now.corners[corner.index()].1));
        let (impulses, velocities) = land(rates);
        let (before, after) = (now.velocities.kinetic(block), velocities.kinetic(block));
        if after <= before {
            return (impulses, rates, velocities);
        }
        // All velocities after the landing are in proportion to the rebound.
        let rates = rates.map(|rate| rate * (before / after).sqrt());
        let (impulses, velocities) = land(rates);
        (impulses, rates, velocities)
    }

    /// `corner` comes down alone: it stops horizontally and rebounds with ε times its vertical rate, but with no more than
    /// the energy allows, and no less than the horizontal stop alone throws it up.
    fn land_on_corner(&mut self, corner: Corner, now: Placement, excitation: &Excitation) {
        let block = self.block;
        let before = now.velocities;
        let land = |rate: f64| impact::landing_with_grip(&block, corner, now.theta, before, rate);
        let mut rate = self.rebound(corner, now.corners[corner.index()].1);
        // The energy after the landing grows with the square of the rate.
        let [energy, held, rebound] = [before, land(0.0), land(rate)].map(|velocities| velocities.kinetic(&block));
        if rebound > energy {
            rate *= ((energy - held).max(0.0) / (rebound - held)).sqrt();
        }
        if land(rate).v_dot < before.v_dot {
            let thrown = impact::grip(&block, Regime::on(corner), now.theta, before);
            let thrown = impact::corner_rate(&block, corner, now.theta, thrown.v_dot, thrown.theta_dot);
            rate = self.or_rest(corner, thrown);
        }
        self.counts.impacts += 1;
        // The other one slid.
        self.counts.liftoffs += u32::from(self.regime.touches(corner.other()));
        let mut rates = [None; 2];
        rates[corner.index()] = Some(rate);
        self.come_down(now, land(rate), rates, excitation);
    }

    /// Vertical rate of a corner after its landing (m/s), upwards.
    fn rebound(&self, corner: Corner, rate: f64) -> f64 {
        self.or_rest(corner, (-self.block.epsilon * rate).max(0.0))
    }

    /// The corners with a rate have come down; those whose rate is zero stand.
    fn come_down(
        &mut self,
        mut now: Placement,
        velocities: Velocities,
        rates: [Option<f64>; 2],
        excitation: &Excitation,
    ) {
        now.strike(&self.block, velocities);
        for (i, rate) in rates.into_iter().enumerate() {
            now.touching[i] = rate == Some(0.0);
            if let Some(rate) = rate {
                now.corners[i] = (0.0, rate);
                self.counts.liftoffs += u32::from(rate != 0.0);
            }
        }
        if now.regime() == Regime::FullContact {
            now.theta = 0.0;
        }
        if now.regime() == Regime::Separated {
            self.go_on_from(&now);
        } else {
            self.hold(&now, excitation);
        }
        self.settle_on_rigid_base(excitation);
    }

    /// What slides is held from here on where it is.
    pub(super) fn grip_rigid_base(&mut self, now: Placement, excitation: &Excitation) {
        let (velocities, rates) = match self.regime.pivot() {
            Some(corner) => {
                let held = impact::landing_with_grip(&self.block, corner, now.theta, now.velocities, 0.0);
                (held, Corner::BOTH.map(|of| (of == corner).then_some(0.0)))
            }
            None => (Velocities { u_dot: 0.0, v_dot: 0.0, theta_dot: 0.0 }, [Some(0.0); 2]),
        };
        self.come_down(now, velocities, rates, excitation);
    }
}
