//! Several runs → the same kind of step of all of them at once, one in each lane of the processor's vectors.
//!
//! A step reads the [`Simulation`] of each run. If all tests exclude an event, a peak inside the step, a repeated step and rest,
//! the simulation gets the bits of a step taken alone. Otherwise the run takes that step alone, with the stages or the swing of its lane if
//! only an event or a peak may be inside. A step on supports with too great an error is repeated in a lane, as is a short step that may hold
//! an event. Runs with friction or restraints, in flight, sliding, held, or at rest on the rigid base take all their steps alone.

mod kernel;
mod next;
mod pulses;
mod swings;
mod transposed;

use crate::block::{Block, Foundation};
use crate::excitation::{Inputs, Wave};
use crate::numerics::control::{Attempt, LONGEST, ShortStepTo, is_resolved, shortest, size_factor};
use crate::numerics::dop853::EVALUATIONS_PER_STEP;
use crate::numerics::wide::VectorWidth;
use crate::run::{MAX_STEPS, SimulationError};
use crate::simulation::Simulation;
use crate::simulation::limits::Limits;
use crate::simulation::peaks::Peaks;
use crate::simulation::state::{Committed, RunState, Setup};
use crate::simulation::step::{StepsInput, StepsOutcome};
use crate::simulation::stepping::EVALUATIONS_OF_SHORT_STEP;
use crate::system::System;
use crate::system::events::{Event, EventFunction};
use crate::system::instant::State;
use crate::system::motion_mode::{Gripping, MotionMode};
use kernel::StepBatch;
use next::{LaneMode, NextStep, lane_mode};
use swings::LaneSwing;
use transposed::TransposedInputs;

pub use next::{BatchKind, Next, Stance};

/// A run that is stepped in a lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The caller's mark of the run.
    pub tag: usize,
    simulation: Simulation,
    /// Requested time (s).
    until: f64,
    /// Requested time or the next kink of the excitation, whichever is first (s).
    stop: f64,
    /// Time at which the piece that ends there begins (s).
    piece_start: f64,
    /// Whether nothing but horizontal and vertical accelerations acts.
    without_moment: bool,
    /// The pulse that acts, unless it is constant.
    wave: Option<Wave>,
    /// The longest step that the pulse allows (s).
    longest_under_pulse: f64,
    /// How runs in the present contacts are stepped together, if they are.
    mode: Option<LaneMode>,
    budget: u64,
    /// Limits of a step in each regime without a pulse.
    limits: [Limits; 3],
    /// The numbers that steps on supports read.
    transposed: TransposedInputs,
    /// The longest step (s).
    longest: f64,
    /// The size of the step that comes next.
    attempt: Attempt,
    next: NextStep,
    /// The swings of a run on the rigid base.
    swing: LaneSwing,
}

/// Limits of the steps of a run under a mode, without a pulse.
fn limits(simulation: &Simulation, mode: impl MotionMode) -> Limits {
    Limits::of(simulation.block(), simulation.setup.settings.tolerance, mode, 0.0)
}

impl Lane {
    /// A run that takes no step before [`Lane::send`] has given it a stop.
    pub fn new(simulation: Simulation, tag: usize) -> Lane {
        let time = simulation.time();
        let mode = lane_mode(&simulation);
        let swing = LaneSwing::of(&simulation);
        let limits = [
            limits(&simulation, Gripping::<true, true, false>),
            limits(&simulation, Gripping::<true, false, false>),
            limits(&simulation, Gripping::<false, true, false>),
        ];
        let mut transposed = TransposedInputs::default();
        transposed.read(&simulation, &limits);
        Lane {
            tag,
            mode,
            simulation,
            until: time,
            stop: time,
            piece_start: time,
            without_moment: false,
            wave: None,
            longest_under_pulse: f64::INFINITY,
            budget: 0,
            limits,
            transposed,
            longest: f64::INFINITY,
            attempt: Attempt::to_stop(0.0),
            next: NextStep::Open { begins_piece: true },
            swing,
        }
    }

    /// The run as it stands.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Sends the run to `until` (s) under these inputs, as [`Simulation::advance`] does. All further calls until it arrives need the same inputs.
    #[inline(always)]
    pub fn send(&mut self, until: f64, inputs: &Inputs) {
        (self.until, self.budget) = (until, MAX_STEPS);
        self.stop = self.simulation.run.pose.time;
        if self.stop < until && self.simulation.run.ending.is_none() {
            self.begin_piece(inputs);
        }
    }

    #[inline(always)]
    fn begin_piece(&mut self, inputs: &Inputs) {
        let Simulation { setup, run: RunState { pose, counts, .. } } = &mut self.simulation;
        let Setup { pulse, system: System { block, .. }, .. } = &*setup;
        self.stop = pulse.next_kink(pose.time).map_or(self.until, |kink| kink.min(self.until));
        self.piece_start = pose.time;
        let on_supports = block.foundation == Foundation::Viscoelastic;
        let wave = if on_supports && inputs.is_ground_motion() && !pulse.acts_at(pose.time) {
            self.without_moment = true;
            let Inputs { time, a_gx, a_gz, .. } = *inputs;
            self.transposed.set_ground(time, [a_gx, a_gz]);
            None
        } else {
            let excitation = setup.excitation(pose.time, inputs);
            if !on_supports {
                self.swing.begin_piece(block, &excitation);
            }
            let ground = excitation.without_moment().filter(|_| on_supports);
            self.without_moment = ground.is_some();
            ground.and_then(|(time, ramps, wave)| {
                self.transposed.set_ground(time, ramps);
                wave
            })
        };
        // Skips `None`, which would copy the whole struct.
        if wave.is_some() || self.wave.is_some() {
            self.wave = wave;
            self.longest_under_pulse = wave.map_or(f64::INFINITY, |wave| LONGEST / wave.frequency());
        }
        self.next = NextStep::Open { begins_piece: true };
        counts.evaluations += 1;
    }

    /// The next action of the run under the inputs of [`Lane::send`].
    #[inline]
    pub fn next_step(&mut self, inputs: &Inputs) -> Next {
        if let NextStep::Landing(_) = self.next {
            return Next::Alone;
        }
        let time = self.simulation.run.pose.time;
        if time >= self.until || self.simulation.run.ending.is_some() {
            if self.simulation.run.ending.is_none() || self.simulation.is_frozen() {
                self.simulation.run.pose.time = self.until;
            }
            return Next::Arrived;
        }
        if time >= self.stop {
            self.begin_piece(inputs);
        }
        self.kind().map_or(Next::Alone, Next::Together)
    }

    /// The kind of the next step, if a lane can take it.
    #[inline]
    fn kind(&mut self) -> Option<BatchKind> {
        let stance = match self.mode? {
            LaneMode::Steps(stance) if self.without_moment => stance,
            LaneMode::Steps(_) => return None,
            LaneMode::Swings => return self.swing_kind(),
        };
        let longest = self.limits[stance.index()].longest.min(self.longest_under_pulse);
        self.longest = longest;
        let (time, stop) = (self.simulation.run.pose.time, self.stop);
        let size = stop - time;
        if self.budget == 0 || !is_resolved(time, longest) {
            return None;
        }
        let control = &self.simulation.run.control;
        let short = match self.next {
            NextStep::Open { .. } => control.short_step(size, longest),
            NextStep::NotShort
            | NextStep::Shorter
            | NextStep::Made(_)
            | NextStep::Swing { .. }
            | NextStep::Landing(_) => ShortStepTo::TooFar,
        };
        let is_short = short == ShortStepTo::Stop;
        if is_short {
            self.attempt = Attempt::to_stop(size);
        } else if !matches!(self.next, NextStep::Shorter) {
            self.attempt = control.attempt(size, longest, shortest(time, longest)).instead_of(short);
        }
        self.transposed.step = [time, self.end_time(), self.attempt.size, longest];
        Some(BatchKind::Step { stance, short: is_short })
    }

    /// Takes a step alone, or rests as long as that lasts. The inputs are those of [`Lane::send`]; `observer` receives each event.
    ///
    /// # Errors
    /// The solver cannot go on: see [`SimulationError`].
    pub fn step_alone(&mut self, inputs: &Inputs, observer: &mut dyn FnMut(&Event)) -> Result<(), SimulationError> {
        let single = self.mode.is_some();
        let Lane { simulation, stop, piece_start, attempt, next, swing, budget, .. } = self;
        let Simulation { setup, run } = simulation;
        let block = &setup.system.block;
        let on_supports = block.foundation == Foundation::Viscoelastic;
        let excitation = if on_supports { setup.excitation(*piece_start, inputs) } else { swing.excitation };
        let outcome = if let NextStep::Landing(pivot) = *next {
            Ok(StepsOutcome::Event(EventFunction::Gap(pivot.other()), run.now(block, &excitation)))
        } else {
            let (begins_piece, first) = (next.begins_piece(), next.first_step(*attempt));
            let input = StepsInput::of_piece(setup, &excitation, *stop);
            run.steps(&StepsInput { begins_piece, single, first, ..input }, budget)
        };
        let done = match outcome {
            Ok(StepsOutcome::Event(function, now)) => run.apply(setup, function, &now, observer).map(|_| ()),
            Ok(StepsOutcome::Lasts) => Ok(()),
            Err(error) => Err(error),
        };
        self.next = NextStep::Open { begins_piece: false };
        // There may have been an event.
        self.mode = lane_mode(&self.simulation);
        if on_supports {
            self.transposed.read(&self.simulation, &self.limits)
        } else {
            self.swing.set_pivot(&self.simulation)
        }
        done
    }

    #[inline(always)]
    fn block(&self) -> &Block {
        self.simulation.block()
    }

    /// Time at the end of the step that comes next (s).
    #[inline(always)]
    fn end_time(&self) -> f64 {
        if self.attempt.last { self.stop } else { self.simulation.run.pose.time + self.attempt.size }
    }

    /// Comes to the end of a step.
    #[inline]
    fn arrive(&mut self, batch: &StepBatch, lane: usize, short: bool) {
        if !short {
            self.accept(batch, lane);
        }
        let Lane { simulation: Simulation { run, .. }, transposed, .. } = self;
        let [theta, theta_dot, w, w_dot] = &batch.state;
        let [input, dashpots] = &batch.sums;
        run.commit(Committed {
            time: transposed.step[1],
            state: State::from([theta[lane], theta_dot[lane], w[lane], w_dot[lane]]),
            footing: run.pose.footing,
            works: [input[lane], dashpots[lane]],
            evaluations: if short { EVALUATIONS_OF_SHORT_STEP } else { EVALUATIONS_PER_STEP },
        });
        let [theta, reaction, horizontal, uplift, friction_demand] = &batch.peaks;
        transposed.sums = [input[lane], dashpots[lane], friction_demand[lane], 0.0];
        transposed.peaks = [theta[lane], reaction[lane], horizontal[lane], uplift[lane]];
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = &mut run.peaks;
        [*theta, *reaction, *horizontal, *uplift] = transposed.peaks;
        *friction_demand = transposed.sums[2];
        self.next = NextStep::Open { begins_piece: false };
        self.budget -= 1;
    }

    /// Accepts a step of order 8.
    #[inline]
    fn accept(&mut self, batch: &StepBatch, lane: usize) {
        let Lane { simulation: Simulation { run, .. }, attempt, longest, .. } = self;
        run.control.accept(attempt, size_factor(batch.root[lane]), *longest);
    }

    /// Rejects a step of order 8. A shorter one comes next, unless the clock does not resolve it: returns
    /// whether it does.
    fn reject(&mut self, root: f64) -> bool {
        let Lane { simulation: Simulation { run, .. }, attempt, longest, .. } = self;
        let factor = size_factor(root);
        if attempt.size * factor < shortest(run.pose.time, *longest) {
            return false;
        }
        *attempt = run.control.reject(attempt, factor);
        run.reject(EVALUATIONS_PER_STEP);
        self.next = NextStep::Shorter;
        true
    }

    /// Rejects the short step; a step of order 8 follows.
    fn rule_out_short_step(&mut self) {
        self.simulation.run.counts.evaluations += EVALUATIONS_OF_SHORT_STEP;
        self.next = NextStep::NotShort;
    }
}

/// Takes the next step of each run of a group. All are of this kind; there is at most one run per lane.
///
/// Returns a bit for each run that has stepped, or for which another kind of step comes next; the others must take the step alone.
pub fn step_group(width: VectorWidth, kind: BatchKind, group: &mut [Box<Lane>]) -> u32 {
    match kind {
        BatchKind::Step { stance, short } => step(width, stance, short, group),
        BatchKind::Swing { is_wave, .. } => swing(width, is_wave, group),
    }
}

/// Takes a swing of each run of a group. Returns a bit for each run that has taken it.
fn swing(width: VectorWidth, is_wave: bool, group: &mut [Box<Lane>]) -> u32 {
    let mut batch = swings::swing(width, is_wave, group);
    for (lane, run) in group.iter_mut().enumerate() {
        if batch.taken >> lane & 1 == 1 {
            run.arrive_by_swing(&batch, lane);
        } else if let Some(made) = batch.known[lane].take() {
            run.next = NextStep::Swing { made, begins_piece: run.next.begins_piece() };
        }
    }
    batch.taken
}

/// Takes a step on supports of each run of a group. Returns the bits of [`step_group`].
fn step(width: VectorWidth, stance: Stance, short: bool, group: &mut [Box<Lane>]) -> u32 {
    let mut batch = kernel::step(width, stance, short, group);
    let mut rejected = 0;
    for (lane, run) in group.iter_mut().enumerate() {
        if batch.taken >> lane & 1 == 1 {
            run.arrive(&batch, lane, short);
        } else if !short {
            let fails = batch.failed >> lane & 1 == 1;
            rejected |= u32::from(fails && run.reject(batch.root[lane])) << lane;
        } else if (batch.failed | batch.eventful) >> lane & 1 == 1 {
            if batch.failed >> lane & 1 == 1 {
                run.simulation.run.control.reject_short(run.attempt.size, batch.root[lane]);
            }
            run.rule_out_short_step();
        }
    }
    for (lane, mut step) in std::mem::take(&mut batch.accepted) {
        let run = &mut group[lane];
        run.accept(&batch, lane);
        step.end_time = run.end_time();
        run.next = NextStep::Made(step);
    }
    let ruled_out = if short { batch.failed | batch.eventful } else { rejected };
    batch.taken | ruled_out
}

#[cfg(test)]
mod tests;
