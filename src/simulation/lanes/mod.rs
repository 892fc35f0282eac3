//! Several runs → the same kind of step of all of them at once, one in each lane of the processor's vectors.
//!
//! A step reads the [`Simulation`] of each run. If all tests exclude an event, a peak inside the step, a repeated step and rest,
//! the simulation gets the bits of a step taken alone. Otherwise the run takes that step alone, with the stages or the swing of its lane if
//! only an event or a peak may be inside. A step on supports with too great an error is repeated in a lane.
//! So do runs with friction or restraints, in flight, sliding, held, or at rest on the rigid base.

mod bounds;
mod force_peaks;
mod fours;
mod kernel;
mod pulses;
mod swings;

use std::sync::Arc;

use crate::block::{Block, Foundation, Regime};
use crate::excitation::{Excitation, Inputs, Wave};
use crate::numerics::control::{Attempt, LONGEST, ShortStepTo, is_resolved, shortest, size_factor};
use crate::numerics::dop853::{EVALUATIONS_PER_STEP, Step};
use crate::numerics::short::EVALUATIONS_PER_SHORT_STEP;
use crate::numerics::wide::VectorWidth;
use crate::simulation::peaks::Peaks;
use crate::simulation::smooth_piece::{MOST_STEPS, StepStart};
use crate::simulation::stepping::Limits;
use crate::simulation::{Simulation, SimulationError};
use crate::system::System;
use crate::system::events::Event;
use crate::system::forces;
use crate::system::instant::State;
use crate::system::law::Gripping;
use fours::Fours;
use kernel::Stepped;
use swings::Swinging;

/// A run that is stepped in a lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The caller's mark of the run.
    pub tag: usize,
    /// The run's own, which a step can borrow while the simulation changes: to share it for each step would take longer than many a swing.
    system: Arc<System>,
    simulation: Simulation,
    /// Time of the next stop (s).
    until: f64,
    /// Time to which the excitation is smooth (s).
    stop: f64,
    /// Time at which the piece that ends there begins (s).
    since: f64,
    /// Whether nothing but horizontal and vertical accelerations acts.
    without_moment: bool,
    /// The pulse that acts, unless it is constant.
    wave: Option<Wave>,
    /// The longest step that the pulse allows (s).
    longest_under_pulse: f64,
    /// How runs in the present contacts are stepped together, if they are.
    course: Option<Course>,
    /// Whether the smooth piece begins at the present time.
    begins: bool,
    budget: u64,
    /// Limits of a step in each regime without a pulse.
    limits: [Limits; 3],
    /// The numbers that steps on supports read.
    fours: Fours,
    /// The longest step (s).
    longest: f64,
    /// The step that comes next.
    attempt: Attempt,
    /// Whether a short step would suffice if earlier steps had made no errors.
    grows: bool,
    /// Whether a short step has just been ruled out here.
    short_failed: bool,
    /// Whether the step that comes next is a shorter attempt of one of order 8 that made too great an error.
    retries: bool,
    /// The step of order 8 from here, if a lane has made it and it may hold an event or a peak.
    accepted: Option<Step>,
    /// The swings of a run on the rigid base.
    swinging: Swinging,
}

/// The way in which runs are stepped together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// By steps on supports, in this regime.
    Steps(Regime),
    /// By swings about a corner of the rigid base.
    Swings,
}

/// The kind of a step: runs whose next steps are of the same kind are stepped together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A step on supports.
    Step {
        /// The regime.
        regime: Regime,
        /// Whether it is a short step, or one of order 8.
        short: bool,
    },
    /// A swing about either corner of the rigid base.
    Swing {
        /// Whether a pulse acts, or only what is linear in time.
        is_wave: bool,
        /// Whether it probably ends with a landing, which takes several iterations.
        lands: bool,
    },
}

impl Kind {
    /// The number of kinds.
    pub const COUNT: usize = 10;

    const REGIMES: [Regime; 3] = [Regime::FullContact, Regime::TiltingLeft, Regime::TiltingRight];

    /// Its number, from 0.
    pub fn number(self) -> usize {
        match self {
            Kind::Step { regime, short } => regime_index(regime).unwrap_or(0) + if short { 0 } else { 3 },
            Kind::Swing { is_wave, lands } => 6 + usize::from(is_wave) + 2 * usize::from(lands),
        }
    }

    /// The kind of a number.
    pub fn numbered(number: usize) -> Kind {
        match number {
            0..6 => Kind::Step { regime: Kind::REGIMES[number % 3], short: number < 3 },
            _ => Kind::Swing { is_wave: number % 2 == 1, lands: number >= 8 },
        }
    }
}

/// Returns the index of a regime among those in which blocks are stepped together; `None` in flight.
fn regime_index(regime: Regime) -> Option<usize> {
    match regime {
        Regime::FullContact => Some(0),
        Regime::TiltingLeft => Some(1),
        Regime::TiltingRight => Some(2),
        Regime::Separated => None,
    }
}

/// The way in which runs in the present contacts are stepped together; none for other runs.
fn course_in_lanes(Simulation { pose, system, .. }: &Simulation) -> Option<Course> {
    let gripping = pose.footing.grips() && pose.contacts.held().is_none();
    if !gripping || forces::switch(&system.block) {
        return None;
    }
    let regime = pose.contacts.regime();
    match system.block.foundation {
        Foundation::Viscoelastic => regime_index(regime).is_some().then_some(Course::Steps(regime)),
        Foundation::Rigid => regime.pivot().is_some().then_some(Course::Swings),
    }
}

/// The next action of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Nothing: it has come to the time that was asked for, or to its end.
    Arrived,
    /// A step that it takes alone.
    Alone,
    /// A step that it may take together with others of the kind.
    Together(Kind),
}

impl Lane {
    /// A run that takes no step before [`Lane::send`] has given it a stop.
    pub fn new(simulation: Simulation, tag: usize) -> Lane {
        let time = simulation.time();
        let course = course_in_lanes(&simulation);
        let swinging = Swinging::of(&simulation);
        let limits = [
            simulation.limits(Gripping::<true, true, false>, 0.0),
            simulation.limits(Gripping::<true, false, false>, 0.0),
            simulation.limits(Gripping::<false, true, false>, 0.0),
        ];
        let mut fours = Fours::default();
        fours.read(&simulation, &limits);
        Lane {
            tag,
            course,
            system: Arc::clone(&simulation.system),
            simulation,
            until: time,
            stop: time,
            since: time,
            without_moment: false,
            wave: None,
            longest_under_pulse: f64::INFINITY,
            begins: true,
            budget: 0,
            limits,
            fours,
            longest: f64::INFINITY,
            attempt: Attempt::to_stop(0.0),
            grows: false,
            short_failed: false,
            retries: false,
            accepted: None,
            swinging,
        }
    }

    /// The run as it stands.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Sends the run to `until` (s) under these inputs, as [`Simulation::advance`] does. All further calls until it arrives need the same inputs.
    #[inline(always)]
    pub fn send(&mut self, until: f64, inputs: &Inputs) {
        (self.until, self.budget) = (until, MOST_STEPS);
        self.stop = self.simulation.pose.time;
        if self.stop < until && self.simulation.ending.is_none() {
            self.begin_piece(inputs);
        }
    }

    #[inline(always)]
    fn begin_piece(&mut self, inputs: &Inputs) {
        let Simulation { pulse, pose, system, counts, .. } = &mut self.simulation;
        self.stop = pulse.next_kink(pose.time).map_or(self.until, |kink| kink.min(self.until));
        self.since = pose.time;
        let on_supports = system.block.foundation == Foundation::Viscoelastic;
        let wave = if on_supports && inputs.is_ground_motion() && !pulse.acts_at(pose.time) {
            self.without_moment = true;
            let Inputs { time, a_gx, a_gz, .. } = *inputs;
            self.fours.set_ground(time, [a_gx, a_gz]);
            None
        } else {
            let excitation = Excitation::from_time(pose.time, inputs, pulse, &system.block);
            if !on_supports {
                self.swinging.begin_piece(&system.block, &excitation);
            }
            let ground = excitation.without_moment().filter(|_| on_supports);
            self.without_moment = ground.is_some();
            ground.and_then(|(time, ramps, wave)| {
                self.fours.set_ground(time, ramps);
                wave
            })
        };
        // A copy of none would be one of all its bytes.
        if wave.is_some() || self.wave.is_some() {
            self.wave = wave;
            self.longest_under_pulse = wave.map_or(f64::INFINITY, |wave| LONGEST / wave.frequency());
        }
        self.begins = true;
        counts.evaluations += 1;
    }

    /// The next action of the run under the inputs of [`Lane::send`].
    #[inline]
    pub fn next_step(&mut self, inputs: &Inputs) -> Next {
        if self.is_landing() {
            return Next::Alone;
        }
        let time = self.simulation.pose.time;
        if time >= self.until || self.simulation.ending.is_some() {
            if self.simulation.ending.is_none() || self.simulation.is_frozen() {
                self.simulation.pose.time = self.until;
            }
            return Next::Arrived;
        }
        if time >= self.stop {
            self.begin_piece(inputs);
        }
        self.kind().map_or(Next::Alone, Next::Together)
    }

    /// The kind of the step that comes next, if it can be taken in a lane.
    #[inline]
    fn kind(&mut self) -> Option<Kind> {
        let regime = match self.course? {
            Course::Steps(regime) if self.without_moment => regime,
            Course::Steps(_) => return None,
            Course::Swings => return self.swing_kind(),
        };
        let longest = self.limits[regime_index(regime)?].longest.min(self.longest_under_pulse);
        self.longest = longest;
        let (time, stop) = (self.simulation.pose.time, self.stop);
        let size = stop - time;
        if self.budget == 0 || !is_resolved(size, longest) {
            return None;
        }
        let control = &self.simulation.control;
        let short = match self.short_failed || self.retries {
            true => ShortStepTo::TooFar,
            false => control.short_step(size, longest),
        };
        let is_short = short == ShortStepTo::Stop;
        if is_short {
            self.attempt = Attempt::to_stop(size);
        } else if !self.retries {
            self.attempt = control.attempt(size, longest, shortest(time, stop));
            self.grows = short == ShortStepTo::NotYet;
        }
        self.fours.step = [time, self.end_time(), self.attempt.size, longest];
        Some(Kind::Step { regime, short: is_short })
    }

    /// Takes a step alone under the inputs of [`Lane::send`], or rests as long as that lasts, and reports each event to `observer`.
    pub fn step_alone(&mut self, inputs: &Inputs, observer: &mut dyn FnMut(&Event)) -> Result<(), SimulationError> {
        let landing = self.take_landing();
        let rests = self.course.is_none();
        let attempt = std::mem::take(&mut self.retries).then_some(self.attempt);
        let Lane { system, simulation, stop, since, begins, short_failed, accepted, swinging, budget, .. } = self;
        let block = &system.block;
        let on_supports = block.foundation == Foundation::Viscoelastic;
        let excitation = match on_supports {
            true => Excitation::from_time(*since, inputs, &simulation.pulse, block),
            false => swinging.excitation,
        };
        let done = if let Some(surface) = landing {
            simulation.apply_alone(surface, block, &excitation, observer)
        } else {
            let start = StepStart { of_piece: *begins, short_failed: *short_failed, attempt };
            (*begins, *short_failed) = (false, false);
            let known = swinging.known.take();
            let (step, swing) = (accepted.as_ref(), known.as_deref());
            let done = simulation.single_step(*stop, block, &excitation, !rests, start, step, swing, budget, observer);
            // A step is large: it is not moved.
            *accepted = None;
            done
        };
        // There may have been an event.
        self.course = course_in_lanes(&self.simulation);
        match on_supports {
            true => self.fours.read(&self.simulation, &self.limits),
            false => self.swinging.turn(&self.simulation),
        }
        done
    }

    #[inline(always)]
    fn block(&self) -> &Block {
        &self.system.block
    }

    /// Time at the end of the step that comes next (s).
    #[inline(always)]
    fn end_time(&self) -> f64 {
        if self.attempt.last { self.stop } else { self.simulation.pose.time + self.attempt.size }
    }

    /// Comes to the end of a step.
    #[inline]
    fn arrive(&mut self, stepped: &Stepped, lane: usize, short: bool) {
        if short {
            self.simulation.counts.evaluations += EVALUATIONS_PER_SHORT_STEP + 1;
        } else {
            self.accept(stepped, lane);
        }
        let Lane { simulation, fours, .. } = self;
        simulation.counts.steps += 1;
        simulation.events_in_this_instant = 0;
        simulation.pose.time = fours.step[1];
        let [theta, theta_dot, w, w_dot] = &stepped.state;
        simulation.pose.state = State::from([theta[lane], theta_dot[lane], w[lane], w_dot[lane]]);
        let [input, dashpots] = &stepped.sums;
        let [theta, reaction, horizontal, uplift, friction_demand] = &stepped.peaks;
        fours.sums = [input[lane], dashpots[lane], friction_demand[lane], 0.0];
        fours.peaks = [theta[lane], reaction[lane], horizontal[lane], uplift[lane]];
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = &mut simulation.peaks;
        [*theta, *reaction, *horizontal, *uplift] = fours.peaks;
        [simulation.sums.input, simulation.sums.dashpots, *friction_demand, _] = fours.sums;
        (self.begins, self.short_failed, self.retries) = (false, false, false);
        self.budget -= 1;
    }

    /// Takes note that the error of a step of order 8 is small enough.
    #[inline]
    fn accept(&mut self, stepped: &Stepped, lane: usize) {
        let Lane { simulation, attempt, longest, .. } = self;
        simulation.control.accept(attempt, size_factor(stepped.root[lane]), *longest);
        simulation.counts.evaluations += EVALUATIONS_PER_STEP;
        if self.grows {
            simulation.control.grow_short();
        }
    }

    /// Takes note that the error of a step of order 8 is too great. A shorter one comes next, unless the clock does not resolve it: returns
    /// whether it does.
    fn reject(&mut self, root: f64) -> bool {
        let Lane { simulation, attempt, stop, .. } = self;
        let factor = size_factor(root);
        if attempt.size * factor < shortest(simulation.pose.time, *stop) {
            return false;
        }
        *attempt = simulation.control.reject(attempt, factor);
        simulation.counts.evaluations += EVALUATIONS_PER_STEP;
        simulation.counts.rejected += 1;
        self.retries = true;
        true
    }

    /// Takes note that a short step does not do. One of order 8 comes next.
    fn rule_out_short_step(&mut self) {
        self.simulation.counts.evaluations += EVALUATIONS_PER_SHORT_STEP + 1;
        self.short_failed = true;
    }
}

/// Takes the next step, of this kind, of each run of a group of at most one run per lane.
///
/// Returns a bit for each run that has stepped, or for which another kind of step comes next; the others must take the step alone.
pub fn step_group(width: VectorWidth, kind: Kind, group: &mut [Box<Lane>]) -> u32 {
    match kind {
        Kind::Step { regime, short } => step(width, regime, short, group),
        Kind::Swing { is_wave, .. } => swing(width, is_wave, group),
    }
}

/// The same for swings.
fn swing(width: VectorWidth, is_wave: bool, group: &mut [Box<Lane>]) -> u32 {
    let mut swung = swings::swing(width, is_wave, group);
    for (lane, run) in group.iter_mut().enumerate() {
        if swung.taken >> lane & 1 == 1 {
            run.arrive_by_swing(&swung, lane);
        } else {
            run.swinging.known = swung.known[lane].take();
        }
    }
    swung.taken
}

/// The same for steps on supports.
fn step(width: VectorWidth, regime: Regime, short: bool, group: &mut [Box<Lane>]) -> u32 {
    let mut stepped = kernel::step(width, regime, short, group);
    let mut rejected = 0;
    for (lane, run) in group.iter_mut().enumerate() {
        if stepped.taken >> lane & 1 == 1 {
            run.arrive(&stepped, lane, short);
        } else if !short {
            let fails = stepped.failed >> lane & 1 == 1;
            rejected |= u32::from(fails && run.reject(stepped.root[lane])) << lane;
        } else if (stepped.failed | stepped.eventful) >> lane & 1 == 1 {
            if stepped.failed >> lane & 1 == 1 {
                run.simulation.control.reject_short(run.attempt.size, stepped.root[lane]);
            }
            run.rule_out_short_step();
        }
    }
    for (lane, mut step) in std::mem::take(&mut stepped.accepted) {
        let run = &mut group[lane];
        run.accept(&stepped, lane);
        run.simulation.counts.steps += 1;
        step.end_time = run.end_time();
        (run.accepted, run.short_failed, run.retries) = (Some(step), true, false);
    }
    let ruled_out = if short { stepped.failed | stepped.eventful } else { rejected };
    stepped.taken | ruled_out
}

#[cfg(test)]
mod tests;
