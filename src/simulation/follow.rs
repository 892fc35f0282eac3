//! A run one step at a time, with the event at the end of a step before it is applied: for those who integrate other quantities
//! beside the motion, such as its derivatives.

use crate::excitation::{Excitation, Inputs, Pulse};
use crate::numerics::dop853::EVALUATIONS_PER_STEP;
use crate::simulation::stepping::{MOST_STEPS, StepStart};
use crate::simulation::{AtEvent, Pending, Simulation, SimulationError};
use crate::system::System;
use crate::system::events::Surface;
use crate::system::instant::Pose;

/// The way in which a run went on. On a corner of the rigid base, where it moves by [swings](crate::system::swing), `Step` and `ShortStep`
/// tell nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// It stayed where it was: an event happens at once.
    Stayed,
    /// By a step of order 8, or by a part of one up to an event.
    Step,
    /// By a [short step](crate::numerics::short).
    ShortStep,
    /// The block rests to the stop.
    Rested,
}

/// A run that goes to a stop one step at a time. It has the bits of [`Simulation::advance`].
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    stop: f64,
    begins: bool,
    budget: u64,
}

impl Steps {
    /// The steps of a run on the way to `until` (s): to there, or to where its pulse begins or ends.
    pub fn towards(simulation: &Simulation, until: f64) -> Steps {
        let stop = simulation.pulse.next_kink(simulation.pose.time).map_or(until, |kink| kink.min(until));
        Steps { stop, begins: true, budget: MOST_STEPS }
    }

    /// Takes the next step under these inputs, and returns its course and the surface through which the motion falls at its end.
    /// [`Simulation::settle`] applies that event. None if the run has reached the stop, or has ended.
    pub fn next(
        &mut self,
        simulation: &mut Simulation,
        inputs: &Inputs,
    ) -> Result<Option<(Course, Option<Surface>)>, SimulationError> {
        let (time, counts) = (simulation.pose.time, simulation.counts);
        if time >= self.stop || simulation.ending.is_some() {
            return Ok(None);
        }
        let excitation = Excitation::from_time(time, inputs, &simulation.pulse, &simulation.system.block);
        let start = StepStart { of_piece: std::mem::take(&mut self.begins), short_failed: false };
        simulation.single_step(self.stop, &excitation, start, AtEvent::Stop, &mut self.budget, &mut |_| ())?;
        let evaluations = simulation.counts.evaluations - counts.evaluations;
        let course = if simulation.pose.time == time {
            Course::Stayed
        } else if simulation.counts.steps == counts.steps {
            Course::Rested
        } else if evaluations < EVALUATIONS_PER_STEP {
            Course::ShortStep
        } else {
            Course::Step
        };
        Ok(Some((course, simulation.pending.map(|Pending { surface, .. }| surface))))
    }
}

impl Simulation {
    /// Comes to `until` (s) once steps have led there, or the block is held.
    pub fn arrive(&mut self, until: f64) {
        if self.ending.is_none() || self.is_frozen() {
            self.pose.time = until;
        }
    }

    /// The block now.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The block and the rules by which it moves.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// The pulse.
    pub fn pulse(&self) -> &Pulse {
        &self.pulse
    }
}
