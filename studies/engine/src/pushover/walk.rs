//! A path of rotations → equilibria along it, through lift-offs, landings, yielding, unloading, slack and breaking.

use super::statics::{Equilibrium, Stretch, height};
use super::{Landmark, LandmarkKind, PushoverError};
use rocking_block::block::restraints::{self, RestraintFunction, Ties};
use rocking_block::block::{Block, Body, Contacts, Corner, Foundation, Regime};
use rocking_block::excitation::Excitation;
use rocking_block::numerics::roots::{has_fallen, sign_change};
use rocking_block::system::System;
use rocking_block::system::beginning::Initial;
use rocking_block::system::instant::Pose;

/// A function along the path: positive until it falls through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Watched {
    /// The load on a standing corner (N).
    Load(Corner),
    /// The height of a lifted corner above its support (m).
    Gap(Corner),
    /// That of a restraint.
    Restraint(RestraintFunction),
    /// Friction that is left before the foot slides (N).
    Grip,
    /// Growth of the lateral force (N/rad).
    Growth,
    /// The lateral force (N), in the direction of the rotation.
    Force,
}

/// The block on its way along a path of rotations.
pub(super) struct Walk<'a> {
    block: Block,
    stretch: Stretch,
    direction: f64,
    /// The present equilibrium.
    pub at: Equilibrium,
    /// Energy lost by yielding (J), by the numbers of the restraints.
    pub lost: [f64; restraints::MAX],
    /// Whether a path away from the upright position ends at the balance.
    ends_at_balance: bool,
    /// Whether the lateral force grew at the end of the last step.
    grew: bool,
    /// Whether the foot of an upright block on a rigid base slides, so that the block turns no further.
    slides: bool,
    /// The rows so far.
    pub rows: &'a mut Vec<Equilibrium>,
    landmarks: &'a mut Vec<Landmark>,
}

/// Round-off of a function that begins at zero, relative to the size of its terms.
pub(super) const ROUNDING: f64 = 1e-12;

/// Greatest number of events at one rotation.
const MAX_EVENTS: u32 = 200;

impl<'a> Walk<'a> {
    /// Begins at θ = 0 under the weight and the restraints' pull, in this direction.
    ///
    /// # Errors
    /// The vertical forces do not balance.
    pub fn new(
        block: &Block,
        direction: f64,
        ends_at_balance: bool,
        rows: &'a mut Vec<Equilibrium>,
        landmarks: &'a mut Vec<Landmark>,
    ) -> Result<Walk<'a>, PushoverError> {
        let block = without_dashpots(*block);
        let system = System { block, flies: true };
        let Pose { contacts, restraints: states, .. } = system.beginning(&Initial::default(), 0.0, &Excitation::none());
        let regime = match block.foundation {
            Foundation::Viscoelastic => contacts.regime(),
            Foundation::Rigid => Contacts::<f64>::FULL.regime(),
        };
        let stretch = Stretch { regime, place: 0.0, states };
        let at = stretch.equilibrium(&block, 0.0, direction, 0.0)?;
        if regime == Regime::Separated || at.reaction.iter().any(|&load| load < -ROUNDING * block.mass * block.gravity)
        {
            return Err(PushoverError::no_equilibrium(0.0));
        }
        let lost = [0.0; restraints::MAX];
        let mut walk =
            Walk { block, stretch, direction, at, lost, ends_at_balance, grew: true, slides: false, rows, landmarks };
        walk.record(LandmarkKind::AtRest);
        walk.rows.push(at);
        if block.foundation == Foundation::Rigid {
            walk.pivot()?;
        }
        Ok(walk)
    }

    /// Returns the motion of the block at the end of a path that stopped early.
    pub fn reason(&self) -> &'static str {
        match self.landmarks.last().map(|landmark| landmark.kind) {
            Some(LandmarkKind::Slides) => "slides",
            _ => "leaves the ground",
        }
    }

    /// Records the end of the path: the balance where the force has vanished.
    pub fn end(&mut self) {
        let is_balanced = self.at.force * self.direction <= ROUNDING * self.block.mass * self.block.gravity;
        if is_balanced {
            self.record_balance();
        } else {
            self.record(LandmarkKind::End);
        }
    }

    /// Records the balance, with a force of exactly zero.
    fn record_balance(&mut self) {
        let at = Equilibrium { force: 0.0, moment: 0.0, ..self.at };
        self.landmarks.push(Landmark { kind: LandmarkKind::Balance, at });
    }

    fn record(&mut self, kind: LandmarkKind) {
        self.landmarks.push(Landmark { kind, at: self.at });
    }

    /// Walks to a rotation in steps of at most this length (rad).
    ///
    /// Returns whether it gets there: not beyond the balance, nor where the block slides or leaves the ground.
    ///
    /// # Errors
    /// The vertical forces do not balance on the way.
    pub fn to(&mut self, target: f64, step: f64) -> Result<bool, PushoverError> {
        let direction = if target >= self.at.theta { 1.0 } else { -1.0 };
        if direction != self.direction {
            self.direction = direction;
            self.at = self.solve(self.at.theta)?;
        }
        let mut events_here = 0;
        while !self.slides {
            let (from, left) = (self.at.theta, (target - self.at.theta) * direction);
            let Some((watched, next)) = self.first_fall(step.min(left))? else {
                if left <= step {
                    self.commit(target)?;
                    return Ok(true);
                }
                self.commit(from + step * direction)?;
                continue;
            };
            events_here = if next == from { events_here + 1 } else { 0 };
            if events_here > MAX_EVENTS {
                return Err(PushoverError::no_equilibrium(from));
            }
            if next != from {
                self.commit(next)?;
            }
            if !self.pass(watched)? {
                return Ok(false);
            }
        }
        Ok(false)
    }

    fn solve(&self, theta: f64) -> Result<Equilibrium, PushoverError> {
        self.stretch.equilibrium(&self.block, theta, self.direction, self.at.v)
    }

    /// Moves to a rotation without an event before it.
    fn commit(&mut self, theta: f64) -> Result<(), PushoverError> {
        let next = self.solve(theta)?;
        for number in self.block.restraints.numbers() {
            let yielded = next.restraints[number].plastic - self.at.restraints[number].plastic;
            self.lost[number] += restraints::yield_force(&self.block, number) * yielded.abs();
        }
        (self.at, self.grew) = (next, self.value(Watched::Growth, &next) > 0.0);
        self.rows.push(next);
        Ok(())
    }

    /// Solves anew after an event, for another row at the same rotation where forces jump.
    fn resume(&mut self) -> Result<(), PushoverError> {
        let next = self.solve(self.at.theta)?;
        let jump = (next.force - self.at.force).abs();
        self.at = next;
        if jump > ROUNDING * self.block.mass * self.block.gravity {
            self.rows.push(next);
        }
        Ok(())
    }

    /// Returns the first function that falls within a step, and the rotation there. The step has this length (rad).
    fn first_fall(&self, step: f64) -> Result<Option<(Watched, f64)>, PushoverError> {
        let (from, direction) = (self.at.theta, self.direction);
        let end = self.solve(from + step * direction)?;
        let mut first: Option<(Watched, f64)> = None;
        for watched in self.watched() {
            let rounding = ROUNDING * self.size(watched);
            let (at_start, at_end) = (self.value(watched, &self.at), self.value(watched, &end));
            let falls_at_once = match watched {
                // Forces jump in events, and with them the growth.
                Watched::Growth => at_start <= 0.0,
                Watched::Force => false,
                _ => has_fallen(at_start, rounding) || (at_start <= rounding && has_fallen(at_end, rounding)),
            };
            let distance = if falls_at_once {
                0.0
            } else if at_start > 0.0 && has_fallen(at_end, rounding) {
                let value =
                    |x: f64| self.solve(from + x * direction).map_or(f64::NAN, |there| self.value(watched, &there));
                sign_change(0.0, step, at_start, at_end, value)
            } else {
                continue;
            };
            // A block on a rigid base lands upright.
            let is_upright = self.block.foundation == Foundation::Rigid && matches!(watched, Watched::Gap(_));
            let distance = if is_upright { from.abs() } else { distance };
            if first.is_none_or(|(_, nearest)| distance < nearest) {
                first = Some((watched, distance));
            }
        }
        Ok(first.map(|(watched, distance)| (watched, from + distance * direction)))
    }

    fn watched(&self) -> impl Iterator<Item = Watched> {
        let Walk { block, stretch, .. } = self;
        let corners = Corner::BOTH.map(|corner| match stretch.regime.touches(corner) {
            true => Watched::Load(corner),
            false => Watched::Gap(corner),
        });
        let of_restraints = restraints::watched(block, &stretch.states.modes()).into_iter().flatten();
        let outwards = self.at.theta * self.direction >= 0.0;
        corners
            .into_iter()
            .chain(of_restraints.map(Watched::Restraint))
            .chain((block.friction > 0.0).then_some(Watched::Grip))
            .chain((self.ends_at_balance && outwards && self.grew).then_some(Watched::Growth))
            .chain((self.ends_at_balance && outwards).then_some(Watched::Force))
    }

    fn value(&self, watched: Watched, at: &Equilibrium) -> f64 {
        let Walk { block, stretch, direction, .. } = self;
        match watched {
            Watched::Load(corner) => at.reaction[corner.index()],
            Watched::Gap(corner) => {
                let above = height(block, corner, at.kinematics.sin_cos, at.v);
                match block.foundation {
                    Foundation::Viscoelastic => above - block.free_height(corner),
                    Foundation::Rigid => above,
                }
            }
            Watched::Restraint(function) => function.value(block, &stretch.states, &at.kinematics),
            Watched::Grip => block.friction * (at.reaction[0] + at.reaction[1]) - at.horizontal.abs(),
            // F and θ change their signs together.
            Watched::Growth => at.stiffness,
            Watched::Force => at.force * direction,
        }
    }

    /// Returns the size of the terms of a function.
    fn size(&self, watched: Watched) -> f64 {
        let Body { mass, gravity, r0, .. } = self.block.body;
        match watched {
            Watched::Load(_) | Watched::Grip | Watched::Force | Watched::Growth => mass * gravity,
            Watched::Gap(_) => r0,
            Watched::Restraint(function) => function.size(&self.block),
        }
    }

    /// Passes an event at the present rotation; returns whether the path continues.
    fn pass(&mut self, watched: Watched) -> Result<bool, PushoverError> {
        match watched {
            Watched::Load(corner) => {
                if self.stretch.regime.pivot() == Some(corner) {
                    self.record(LandmarkKind::Separation);
                    return Ok(false);
                }
                self.stand(Regime::on(corner.other()));
                self.record(LandmarkKind::LiftOff(corner));
            }
            Watched::Gap(corner) => match self.block.foundation {
                Foundation::Viscoelastic => {
                    self.stand(Regime::FullContact);
                    self.record(LandmarkKind::Landing(corner));
                }
                Foundation::Rigid => {
                    self.pivot()?;
                    return Ok(!self.slides);
                }
            },
            Watched::Restraint(function) => {
                let kinematics = self.at.kinematics;
                if let Some(event) = function.switch(&self.block, &mut self.stretch.states, || kinematics, ROUNDING) {
                    self.record(LandmarkKind::Restraint(event));
                }
            }
            Watched::Grip => {
                self.record(LandmarkKind::Slides);
                return Ok(false);
            }
            Watched::Growth => {
                self.grew = false;
                return Ok(true);
            }
            Watched::Force => {
                self.record_balance();
                return Ok(false);
            }
        }
        self.resume()?;
        Ok(true)
    }

    /// Changes the corners in contact; the block keeps its horizontal place.
    fn stand(&mut self, regime: Regime) {
        self.stretch.regime = regime;
        self.stretch.place = self.at.u - self.stretch.lean(&self.block, self.at.kinematics.sin_cos);
    }

    /// Turns about the other corner of a rigid base, at θ = 0, unless the foot slides before the lateral force lifts a corner.
    fn pivot(&mut self) -> Result<(), PushoverError> {
        let pivot = if self.direction > 0.0 { Corner::Right } else { Corner::Left };
        let upright = self.at;
        self.stand(Regime::on(pivot));
        self.resume()?;
        if self.block.friction > 0.0 && self.value(Watched::Grip, &self.at) < -ROUNDING * self.size(Watched::Grip) {
            // While the force grows, H is linear in it, and the sum of both reactions stays.
            let lifts = self.at;
            let limit = self.block.friction * (lifts.reaction[0] + lifts.reaction[1]) * lifts.horizontal.signum();
            let part = ((limit - upright.horizontal) / (lifts.horizontal - upright.horizontal)).clamp(0.0, 1.0);
            let at = |from: f64, to: f64| from + part * (to - from);
            self.at = Equilibrium {
                regime: Regime::FullContact,
                reaction: [0, 1].map(|i| at(upright.reaction[i], lifts.reaction[i])),
                horizontal: at(upright.horizontal, lifts.horizontal),
                force: at(upright.force, lifts.force),
                moment: at(upright.moment, lifts.moment),
                ..upright
            };
            self.rows.pop();
            self.rows.push(self.at);
            self.slides = true;
            self.record(LandmarkKind::Slides);
            return Ok(());
        }
        self.record(LandmarkKind::LiftOff(pivot.other()));
        Ok(())
    }
}

/// Returns the block with restraints without dashpots, which do nothing in a slow motion.
fn without_dashpots(mut block: Block) -> Block {
    let mut ties = block.ties().to_vec();
    ties.iter_mut().for_each(|tie| tie.damping = 0.0);
    block.body.restraints.ties = Ties::of(&ties);
    block
}
