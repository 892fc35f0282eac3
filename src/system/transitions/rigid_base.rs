//! The rigid base: lift-off, Housner's change of the pivot, slip, landing from flight, grip.
//!
//! No corner is pulled. Let go, the last corner either rises or is pressed on; if it is pressed on, it slides along the base
//! without friction until it can be held again, as it does on supports.

use crate::contact::{Contact, Contacts, Creep};
use crate::contact::{Corner, Regime};
use crate::system::dynamics::{Footing, State, instant};
use crate::system::impact::{self, Velocities};
use crate::system::now::Now;
use crate::system::transitions::placement::Placement;
use crate::system::transitions::{Change, Leaving};

impl Change<'_> {
    /// `corner` is not held on the rigid base any more, nor is any other that would have to be pulled then.
    pub(super) fn lift_from_rigid_base(&mut self, corner: Corner, now: &Now) -> Leaving {
        let first = self.let_go(corner, now);
        match self.settle_on_rigid_base() {
            Some(Leaving::Lifts) => Leaving::Lifts,
            Some(Leaving::Slides | Leaving::Held) | None => first,
        }
    }

    /// Lets go of the corners that would have to be pulled; how the last of them left.
    fn settle_on_rigid_base(&mut self) -> Option<Leaving> {
        let mut left = None;
        loop {
            let now = self.now();
            match self.system.leaving_rigid_base(&now) {
                Some(corner) => left = Some(self.let_go(corner, &now)),
                None => return left,
            }
        }
    }

    /// `corner` lifts, or slides from here on if it is the last one and would be pressed on without being held. The paper's
    /// analysis ends when the last corner bears nothing.
    fn let_go(&mut self, corner: Corner, now: &Now) -> Leaving {
        let x = &now.instant;
        let last = !now.regime.touches(corner.other());
        if last && self.system.flies && self.pose.footing.grips() {
            let flight = Footing::Free { u: x.u, u_dot: x.u_dot };
            let state = [x.theta, x.theta_dot, x.v, x.v_dot];
            let free = instant(&self.system.block, Regime::Separated, state, flight, now.forcing);
            if free.corner_ddot[corner.index()] < 0.0 {
                self.release(x);
                return Leaving::Slides;
            }
        }
        self.raise(corner);
        self.tally.liftoffs += 1;
        self.go_on_from(&Placement::of(x));
        Leaving::Lifts
    }

    fn raise(&mut self, corner: Corner) {
        self.set(corner, Contact::Lifted(Creep::default()));
    }

    /// Without any corner on the base, the block flies.
    fn go_on_from(&mut self, placement: &Placement) {
        self.place(placement);
        if self.regime() == Regime::Separated {
            self.pose.footing = Footing::Free { u: placement.u, u_dot: placement.velocities.u_dot };
        }
    }

    /// The pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    pub(super) fn change_pivot(&mut self, corner: Corner, now: &Now) {
        let block = &self.system.block;
        let theta_dot = block.restitution().max(0.0) * now.state[1];
        self.tally.impacts += 1;
        self.pose.contacts = Contacts::FULL;
        if theta_dot.abs() < self.system.slowest * block.p {
            self.pose.state = State::zeros();
        } else {
            self.raise(corner.other());
            self.pose.state = State::from([0.0, theta_dot, 0.0, 0.0]);
            self.tally.liftoffs += 1;
        }
        self.settle_on_rigid_base();
    }

    /// `corner` comes down from flight, or while the other one slides.
    pub(super) fn land_on_rigid_base(&mut self, corner: Corner, now: &Now) {
        let other = corner.other();
        let placement = Placement::of(&now.instant);
        if !self.is_level(other, now) {
            return self.land_on_corner(corner, placement);
        }
        let block = &self.system.block;
        let rates = Corner::BOTH.map(|corner| self.rebound(corner, placement.corners[corner.index()].1));
        let (impulses, velocities) = impact::landing_on_both(block, placement.theta, placement.velocities, rates);
        if impulses[corner.index()] < 0.0 {
            self.land_on_corner(other, placement);
        } else if impulses[other.index()] < 0.0 || velocities.kinetic(block) > placement.velocities.kinetic(block) {
            self.land_on_corner(corner, placement);
        } else {
            self.tally.impacts += 2;
            self.come_down(placement, velocities, rates.map(Some));
        }
    }

    /// `corner` comes down alone: it stops horizontally and rebounds with ε times its vertical rate, but with no more than
    /// the energy allows, and no less than the horizontal stop alone throws it up.
    fn land_on_corner(&mut self, corner: Corner, placement: Placement) {
        let block = &self.system.block;
        let before = placement.velocities;
        let land = |rate: f64| impact::landing_with_grip(block, corner, placement.theta, before, rate);
        let mut rate = self.rebound(corner, placement.corners[corner.index()].1);
        // The energy after the landing grows with the square of the rate.
        let [energy, held, rebound] = [before, land(0.0), land(rate)].map(|velocities| velocities.kinetic(block));
        if rebound > energy {
            // None is left where rounding hides what the rate adds to the energy.
            let part = if rebound > held { (energy - held).max(0.0) / (rebound - held) } else { 0.0 };
            rate = self.or_rest(corner, rate * part.sqrt(), 0.0);
        }
        if land(rate).v_dot < before.v_dot {
            let thrown = impact::grip(block, Regime::on(corner), placement.theta, before);
            let thrown = impact::corner_rate(block, corner, placement.theta, thrown.v_dot, thrown.theta_dot);
            rate = self.or_rest(corner, thrown, 0.0);
        }
        self.tally.impacts += 1;
        // The other one slid.
        self.tally.liftoffs += u32::from(self.contacts().touches(corner.other()));
        let mut rates = [None; 2];
        rates[corner.index()] = Some(rate);
        self.come_down(placement, land(rate), rates);
    }

    /// Vertical rate of a corner after its landing (m/s), upwards.
    fn rebound(&self, corner: Corner, rate: f64) -> f64 {
        self.or_rest(corner, (-self.system.block.epsilon * rate).max(0.0), 0.0)
    }

    /// The corners with a rate have come down; those whose rate is zero stand.
    fn come_down(&mut self, mut placement: Placement, velocities: Velocities, rates: [Option<f64>; 2]) {
        placement.strike(&self.system.block, velocities);
        for (corner, rate) in Corner::BOTH.into_iter().zip(rates) {
            if rate == Some(0.0) {
                self.set(corner, Contact::Bearing);
            } else {
                self.raise(corner);
            }
            if let Some(rate) = rate {
                placement.corners[corner.index()] = (0.0, rate);
                self.tally.liftoffs += u32::from(rate != 0.0);
            }
        }
        match self.regime() {
            Regime::Separated => self.go_on_from(&placement),
            Regime::FullContact => {
                placement.theta = 0.0;
                self.hold(&placement);
            }
            Regime::TiltingLeft | Regime::TiltingRight => self.hold(&placement),
        }
        self.settle_on_rigid_base();
    }

    /// What slides is held from here on where it is.
    pub(super) fn grip_rigid_base(&mut self, placement: Placement) {
        let (velocities, rates) = match self.regime().pivot() {
            Some(corner) => {
                let held =
                    impact::landing_with_grip(&self.system.block, corner, placement.theta, placement.velocities, 0.0);
                (held, Corner::BOTH.map(|of| (of == corner).then_some(0.0)))
            }
            None => (Velocities { u_dot: 0.0, v_dot: 0.0, theta_dot: 0.0 }, [Some(0.0); 2]),
        };
        self.come_down(placement, velocities, rates);
    }
}
