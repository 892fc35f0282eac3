//! A step between two instants → the first event inside, peaks, works, and the present instant at its end.

use crate::block::{Block, Foundation};
use crate::numerics::control::near_a_peak;
use crate::simulation::peaks::{Channels, Peaks, greater};
use crate::simulation::smooth_piece::SmoothPiece;
use crate::simulation::step_interior::{EventCrossing, StepInterior, first_event};
use crate::simulation::{Simulation, SimulationError};
use crate::system::evaluation::Evaluation;
use crate::system::events::{Event, EventFunction};
use crate::system::instant::{Powers, State};
use crate::system::motion_mode::MotionMode;

/// The end of a step without events.
pub(super) struct StepEnd<const N: usize> {
    /// The state there.
    pub(super) state: State<f64, N>,
    /// The works on the way, per unit mass.
    pub(super) work: Powers,
    /// The longest step (s).
    pub(super) longest: f64,
}

/// The result of a step.
pub(super) enum Finished {
    /// Nothing: a function that begins at zero rises unseen within it. A step of this size (s) is to be tried.
    TooLong(f64),
    /// The block has come to an event.
    Left,
    /// The block has come to the end of the step.
    Lasts,
}

/// The part of a step that is tried next where a function that begins at zero rises and falls unseen within it.
const SHORTENED: f64 = 0.125;

/// The part of the longest step below which such a rise is taken for none: the fall is placed at the end of the step.
const SHORTEST_RISE: f64 = 1e-10;

/// The part of a step that the clock resolves where a shorter one is tried.
const MIN_SHORTENED: f64 = 1e-2;

/// The time (s) of an event, `elapsed` seconds after another.
///
/// A landing after less than the clock resolves is at the next time of the clock: in the same instant the base or a support that only
/// pulls there would lift the block again, and again.
pub(super) fn event_time(function: EventFunction, time: f64, elapsed: f64) -> f64 {
    let lands = matches!(function, EventFunction::Gap(_));
    if lands && elapsed > 0.0 { (time + elapsed).max(time.next_up()) } else { time + elapsed }
}

impl Simulation {
    /// Goes from `here` to the end of a step, or to the first event inside, with the peaks on the way, and applies the event.
    #[inline(always)]
    pub(super) fn finish<'a, L: MotionMode, const N: usize>(
        &mut self,
        piece: &SmoothPiece,
        here: &mut Evaluation<'a>,
        mut there: Evaluation<'a>,
        end: &StepEnd<N>,
        mut inside: StepInterior<'_, 'a, L, N>,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Finished, SimulationError> {
        let (mode, size) = (inside.motion.mode(), there.time - here.time);
        let mut event = first_event(here, &there, end.longest, &mut inside);
        if let Some(EventCrossing { rise_unseen: true, elapsed, .. }) = &mut event {
            if size > SHORTEST_RISE * end.longest && self.pose.time + MIN_SHORTENED * size > self.pose.time {
                self.counts.evaluations += inside.evaluations;
                self.counts.steps -= 1;
                self.counts.rejected += 1;
                return Ok(Finished::TooLong(SHORTENED * size));
            }
            *elapsed = size;
        }
        let (mut beyond, mut work) = (end.state, end.work);
        if let Some(EventCrossing { elapsed, function, .. }) = event
            && elapsed < size
        {
            there = inside.at(elapsed);
            there.time = event_time(function, here.time, elapsed);
            work = inside.work(elapsed);
            if N > 4 {
                beyond = inside.state(elapsed);
            }
        }
        let elapsed = event.map_or(size, |fall| fall.elapsed);
        self.update_peaks(here, &there, near_a_peak(elapsed, end.longest), &mut inside);
        self.counts.evaluations += inside.evaluations;
        if !mode.grips() {
            self.accumulate_slip(here, &there);
        }
        if N > 4 {
            self.sums.add(std::array::from_fn(|i| *beyond.0.get(6 + i).unwrap_or(&0.0)));
            self.peaks.include_pulls_of_step(here, &there, |elapsed| inside.at(elapsed));
            self.accumulate_plastic(here, &there);
        } else {
            work[0] += here.footing.free_work(&there.footing);
        }
        self.commit(&there, work);
        if mode.held().is_some() {
            // The corner lifts and lands so often that only the energy tells.
            let dissipated: f64 = beyond.0.iter().skip(6).sum();
            let made = there.energy() - here.energy() - work[0] + work[1] + dissipated;
            self.sums.constraint += made;
            self.sums.impacts -= made;
        }
        if let Some(EventCrossing { function, .. }) = event {
            self.apply_or_stop(function, &there, piece, observer)?;
            return Ok(Finished::Left);
        }
        *here = there;
        Ok(Finished::Lasts)
    }

    /// Includes the slip of the foot in a step.
    pub(super) fn accumulate_slip(&mut self, here: &Evaluation, there: &Evaluation) {
        if self.slides() {
            let path = there.foot_place() - here.foot_place();
            self.slip.now += path;
            self.slip.total += path.abs();
            self.peaks.slip = greater(self.peaks.slip, self.slip.now.abs());
        }
    }

    /// Includes the peaks of a step.
    #[inline(always)]
    pub(super) fn update_peaks<L: MotionMode, const N: usize>(
        &mut self,
        here: &Evaluation,
        there: &Evaluation,
        near: f64,
        inside: &mut StepInterior<L, N>,
    ) {
        let duration = there.time - here.time;
        if duration <= 0.0 {
            return;
        }
        let [start, end] = self.channels_at_ends(here, there, near);
        self.peaks.include_step(&start, &end, duration, |channel, number, elapsed| {
            inside.candidate(channel, number, elapsed)
        });
    }

    /// The channels at both ends of a step. The rates of H and of the friction demand, and those of the
    /// reactions on the rigid base, take dual numbers; so they are formed only where one of these is `near` its peak, as a
    /// part of that, and are zero elsewhere.
    #[inline(always)]
    pub(super) fn channels_at_ends(&self, here: &Evaluation, there: &Evaluation, near: f64) -> [Channels; 2] {
        let Block { mass, foundation, .. } = self.system.block;
        let Peaks { reaction, horizontal, friction_demand, .. } = self.peaks;
        let close = |now: &Evaluation| {
            let [left, right] = now.instant.reaction;
            let shear = mass * now.instant.horizontal.abs();
            shear > near * horizontal
                || shear > near * friction_demand * mass * (left + right)
                || (foundation == Foundation::Rigid && mass * left.max(right) > near * reaction)
        };
        if close(here) || close(there) {
            [here.channels(), there.channels()]
        } else {
            [here.cheap_channels(), there.cheap_channels()]
        }
    }
}
