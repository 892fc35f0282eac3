//! A pose and an event → the pose right after, and what happened.
//!
//! Everything here is a function of its arguments. A `Change` is where the new pose is put together: it begins as the pose
//! before and is taken apart into a [`Transition`] at the end.

mod along;
mod beginning;
mod flight;
mod placement;
mod rigid_base;
mod supports;

use crate::block::Foundation;
use crate::contact::{Contact, Contacts, Corner, Regime};
use crate::excitation::Excitation;
use crate::numerics::roots::Sample;
use crate::system::System;
use crate::system::dynamics::{Footing, Instant};
use crate::system::now::{Motion, Now, Pose};
use crate::system::surfaces::{EventKind, Surface};
use placement::Placement;

pub use along::{Along, Start};
pub use beginning::Initial;

/// What became of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// The pose right after.
    pub pose: Pose,
    /// What happened; nothing that a user would see where a corner is held from here on, or bears again.
    pub happened: Option<EventKind>,
    /// What it comes to.
    pub tally: Tally,
}

/// What is counted in a transition.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Landings to which the impact map (or e, on the rigid base) was applied.
    pub impacts: u32,
    /// Corners that lifted.
    pub liftoffs: u32,
    /// Energy per unit mass (m²/s²) that came with changes of the horizontal constraint.
    pub constraint: f64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// How a corner that bears nothing any more leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Leaving {
    /// It lifts.
    Lifts,
    /// It stays on its support and slides.
    Slides,
    /// It stays, and is held.
    Held,
}

impl System {
    /// What becomes of the block at `now`, in the pose that goes on from there, when the motion has fallen through a surface.
    pub fn transition(&self, pose: &Pose, now: &Now, surface: Surface) -> Transition {
        let mut change = Change::begin(self, pose, now.excitation);
        let happened = match (surface, self.block.foundation) {
            (Surface::Reaction(corner) | Surface::Held(corner), foundation) => {
                let leaving = match foundation {
                    Foundation::Viscoelastic => change.lift(corner, surface, now),
                    Foundation::Rigid => change.lift_from_rigid_base(corner, now),
                };
                match leaving {
                    Leaving::Lifts => Some(EventKind::LiftOff(corner)),
                    Leaving::Slides => Some(EventKind::Slip),
                    Leaving::Held => None,
                }
            }
            (Surface::Gap(corner), foundation) => {
                match (foundation, pose.footing.grips()) {
                    (Foundation::Viscoelastic, true) => change.land(corner, now),
                    (Foundation::Viscoelastic, false) => change.land_freely(corner, now),
                    (Foundation::Rigid, true) => change.change_pivot(corner, now),
                    (Foundation::Rigid, false) => change.land_on_rigid_base(corner, now),
                }
                Some(EventKind::Landing(corner))
            }
            (Surface::Slide, foundation) => {
                let placement = Placement::of(&now.instant);
                match foundation {
                    Foundation::Viscoelastic => change.grip_and_settle(placement),
                    Foundation::Rigid => change.grip_rigid_base(placement),
                }
                Some(EventKind::Grip)
            }
            (Surface::Unloaded(_), _) => {
                change.pose.contacts.let_bear();
                None
            }
            (Surface::QuarterTurn, _) => Some(EventKind::Overturning),
        };
        let Change { pose, tally, .. } = change;
        Transition { pose, happened, tally }
    }

    /// The corner on the rigid base that would have to be pulled at this instant or right after it, the one more so if both
    /// would; none on supports, whose reactions follow from the motion.
    pub fn leaving_rigid_base(&self, now: &Now) -> Option<Corner> {
        if self.block.foundation == Foundation::Viscoelastic {
            return None;
        }
        let falls = |corner: Corner| Surface::Reaction(corner).sample(now).rate < 0.0;
        Corner::BOTH
            .into_iter()
            .filter(|&corner| now.regime.touches(corner))
            .map(|corner| (corner, now.instant.reaction[corner.index()]))
            .filter(|&(corner, n)| n < 0.0 || (n == 0.0 && falls(corner)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(corner, _)| corner)
    }

    /// The pose in which the block goes on from `now` if a corner cannot stay on the rigid base; nothing if all can.
    pub fn released(&self, pose: &Pose, now: &Now) -> Option<Pose> {
        self.released_by(pose, now).map(|(pose, _)| pose)
    }

    /// The same, and the regimes through which it comes there.
    fn released_by(&self, pose: &Pose, now: &Now) -> Option<(Pose, Path)> {
        let corner = self.leaving_rigid_base(now)?;
        let mut change = Change::begin(self, pose, now.excitation);
        change.lift_from_rigid_base(corner, now);
        Some((change.pose, change.path))
    }
}

/// A pose that is being changed.
struct Change<'a> {
    system: &'a System,
    excitation: &'a Excitation,
    pose: Pose,
    tally: Tally,
    path: Path,
}

/// The regimes through which a pose passes in one instant, as corners leave: with both corners, with one, with none.
type Path = [Option<Regime>; 3];

impl<'a> Change<'a> {
    fn begin(system: &'a System, pose: &Pose, excitation: &'a Excitation) -> Change<'a> {
        Change { system, excitation, pose: *pose, tally: Tally::default(), path: [None; 3] }
    }

    fn regime(&self) -> Regime {
        self.pose.contacts.regime()
    }

    /// The block in the present pose.
    fn now(&mut self) -> Now<'a> {
        self.tally.evaluations += 1;
        Motion::from_pose(&self.system.block, &self.pose, self.excitation).at(self.pose.time, self.pose.state)
    }

    /// Nothing holds the block horizontally from here on.
    fn release(&mut self, x: &Instant<f64>) {
        self.pose.footing = Footing::Free { u: x.u, u_dot: x.u_dot };
    }

    /// Goes on from a placement on the present contacts.
    fn place(&mut self, placement: &Placement) {
        let regime = self.regime();
        self.pose.state = placement.state(regime).into();
        let left = Corner::BOTH.into_iter().filter(|&corner| !regime.touches(corner)).count();
        self.path[left] = Some(regime);
    }

    /// What touches is held from here on where it is, with velocities that agree with that.
    fn hold(&mut self, placement: &Placement) {
        self.place(placement);
        self.pose.footing = Footing::AT_START;
        let offset = placement.u - self.now().instant.u;
        self.pose.footing = Footing::Grips { offset };
    }

    /// Height of the support under a corner that has left it (m), and its rate (m/s).
    fn support(&self, corner: Corner) -> Sample {
        self.pose.contacts.top(corner, &self.system.block, self.pose.time)
    }

    /// A corner's rate after a landing (m/s), or that of its support if the corner would leave it by little more. So a sequence
    /// of ever lower flights ends: none is begun that would not rise ten times as high as what rounding leaves of a gap.
    fn or_rest(&self, corner: Corner, rate: f64, support_rate: f64) -> f64 {
        let block = &self.system.block;
        let slowest = (20.0 * block.gravity * Surface::Gap(corner).rounding(block)).sqrt();
        if rate > support_rate && rate - support_rate < slowest { support_rate } else { rate }
    }

    fn set(&mut self, corner: Corner, contact: Contact) {
        self.pose.contacts.set(corner, contact);
    }

    fn contacts(&self) -> &Contacts {
        &self.pose.contacts
    }
}
