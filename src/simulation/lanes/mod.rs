//! Several runs → the same kind of step of all of them at once, one in each lane of the processor's vectors.
//!
//! A step reads the [`Simulation`] of each run. If all tests exclude an event, a peak inside the step, a repeated step and rest,
//! the simulation gets the bits of a step taken alone. Otherwise the lane leaves it unchanged, and the run takes that step alone.
//! So do runs on the rigid base, with friction or ties, in flight, sliding, held, or under a pulse.

mod bounds;
mod kernel;

use crate::block::{Block, Foundation};
use crate::block::{Corner, Regime};
use crate::excitation::{Excitation, Inputs, Ramp};
use crate::numerics::control::{Attempt, ShortStepTo, is_resolved, shortest, size_factor};
use crate::numerics::dop853::EVALUATIONS_PER_STEP;
use crate::numerics::roots::Sample;
use crate::numerics::short::EVALUATIONS_PER_SHORT_STEP;
use crate::numerics::wide::{Array, VectorWidth};
use crate::simulation::peaks::Peaks;
use crate::simulation::stepping::{Limits, MOST_STEPS, StepStart};
use crate::simulation::{AtEvent, Simulation, SimulationError};
use crate::system::events::{Event, Surface};
use crate::system::forces;
use crate::system::instant::Pose;
use crate::system::instant::State;
use crate::system::law::Gripping;
use kernel::Stepped;

/// A reference time (s), and the ground accelerations from there on, horizontal and vertical.
type GroundRamps = (f64, [Ramp; 2]);

/// A run that is stepped in a lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The caller's mark of the run.
    pub tag: usize,
    simulation: Simulation,
    inputs: Inputs,
    /// Time of the next stop (s).
    until: f64,
    /// Time to which the excitation is smooth (s).
    stop: f64,
    /// Time at which the piece that ends there begins (s).
    since: f64,
    /// Reference time (s) and ground accelerations, where nothing else acts.
    ground: Option<GroundRamps>,
    /// Whether the smooth piece begins at the present time.
    begins: bool,
    budget: u64,
    /// Limits of a step in each regime, while no pulse acts.
    limits: [Limits; 3],
    /// Round-off of the zero of a gap.
    gap_rounding: f64,
    /// Heights of the supports that nothing touches, with the time of their last evaluation (s).
    support_heights: (f64, [Sample; 2]),
    /// The step that comes next.
    attempt: Attempt,
    /// Whether a short step would suffice if earlier steps had made no errors.
    grows: bool,
    /// Whether a short step has just made too great an error here.
    short_failed: bool,
}

/// The kind of a step: runs whose next steps are of the same kind are stepped together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    regime: Regime,
    /// Whether it is a short step, or one of order 8.
    short: bool,
}

impl Kind {
    /// The number of kinds.
    pub const COUNT: usize = 6;

    const REGIMES: [Regime; 3] = [Regime::FullContact, Regime::TiltingLeft, Regime::TiltingRight];

    /// Its number, from 0.
    pub fn number(self) -> usize {
        place(self.regime).unwrap_or(0) + if self.short { 0 } else { 3 }
    }

    /// The kind of a number.
    pub fn numbered(number: usize) -> Kind {
        Kind { regime: Kind::REGIMES[number % 3], short: number < 3 }
    }
}

/// The place of a regime among those in which blocks are stepped together; none in flight.
fn place(regime: Regime) -> Option<usize> {
    match regime {
        Regime::FullContact => Some(0),
        Regime::TiltingLeft => Some(1),
        Regime::TiltingRight => Some(2),
        Regime::Separated => None,
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
        let gap_rounding = Surface::Gap(Corner::Left).rounding(simulation.block());
        let time = simulation.time();
        let limits = [
            simulation.limits(Gripping::<true, true, false>, 0.0),
            simulation.limits(Gripping::<true, false, false>, 0.0),
            simulation.limits(Gripping::<false, true, false>, 0.0),
        ];
        Lane {
            tag,
            simulation,
            inputs: Inputs::default(),
            until: time,
            stop: time,
            since: time,
            ground: None,
            begins: true,
            budget: 0,
            limits,
            gap_rounding,
            support_heights: (f64::NAN, [Sample::default(); 2]),
            attempt: Attempt::to_stop(0.0),
            grows: false,
            short_failed: false,
        }
    }

    /// The run as it stands.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Sends the run to `until` (s) under these inputs, as [`Simulation::advance`] does.
    pub fn send(&mut self, until: f64, inputs: &Inputs) {
        (self.until, self.inputs, self.budget) = (until, *inputs, MOST_STEPS);
        // The next step begins a piece.
        self.stop = self.simulation.pose.time;
    }

    fn begin_piece(&mut self) {
        let Simulation { pulse, pose, system, counts, .. } = &mut self.simulation;
        self.stop = pulse.next_kink(pose.time).map_or(self.until, |kink| kink.min(self.until));
        self.since = pose.time;
        self.ground = Excitation::from_time(pose.time, &self.inputs, pulse, &system.block).ground_alone();
        self.begins = true;
        counts.evaluations += 1;
    }

    /// The next action of the run.
    #[inline]
    pub fn next_step(&mut self) -> Next {
        let time = self.simulation.pose.time;
        if time >= self.until || self.simulation.ending.is_some() {
            if self.simulation.ending.is_none() || self.simulation.is_frozen() {
                self.simulation.pose.time = self.until;
            }
            return Next::Arrived;
        }
        if time >= self.stop {
            self.begin_piece();
        }
        self.kind().map_or(Next::Alone, Next::Together)
    }

    /// The kind of the step that comes next, if it can be taken in a lane.
    #[inline]
    fn kind(&mut self) -> Option<Kind> {
        let Simulation { pose, system, .. } = &self.simulation;
        let regime = pose.contacts.regime();
        let gripping = pose.footing.grips() && pose.contacts.held().is_none();
        let plain = system.block.foundation == Foundation::Viscoelastic && !forces::switch(&system.block);
        if !plain || !gripping || self.ground.is_none() {
            return None;
        }
        let limits = &self.limits[place(regime)?];
        let longest = limits.longest;
        let (time, stop) = (self.simulation.pose.time, self.stop);
        let size = stop - time;
        if self.budget == 0 || !is_resolved(size, longest) {
            return None;
        }
        let control = &self.simulation.control;
        let short = if self.short_failed { ShortStepTo::TooFar } else { control.short_step(size, longest) };
        if short == ShortStepTo::Stop {
            self.attempt = Attempt::to_stop(size);
            return Some(Kind { regime, short: true });
        }
        self.attempt = control.attempt(size, longest, shortest(time, stop));
        self.grows = short == ShortStepTo::NotYet;
        Some(Kind { regime, short: false })
    }

    /// Takes a step alone, and reports each event to `observer`.
    pub fn step_alone(&mut self, observer: &mut dyn FnMut(&Event)) -> Result<(), SimulationError> {
        let Lane { simulation, inputs, stop, since, begins, short_failed, budget, support_heights, .. } = self;
        let excitation = Excitation::from_time(*since, inputs, &simulation.pulse, &simulation.system.block);
        let start = StepStart { of_piece: *begins, short_failed: *short_failed };
        (*begins, *short_failed) = (false, false);
        // An event may let a support creep from another height.
        support_heights.0 = f64::NAN;
        simulation.single_step(*stop, &excitation, start, AtEvent::Apply, budget, observer)
    }

    /// The ground accelerations under which it is stepped.
    #[inline(always)]
    fn ground(&self) -> GroundRamps {
        self.ground.unwrap_or_default()
    }

    /// The height of the support that a corner has left, and its rate, at the present time.
    #[inline]
    fn top(&self, corner: Corner) -> Sample {
        let Pose { time, ref contacts, .. } = self.simulation.pose;
        if self.support_heights.0 == time {
            self.support_heights.1[corner.index()]
        } else {
            contacts.top(corner, self.block(), time)
        }
    }

    /// The same at the end of the step that comes next.
    #[inline]
    fn top_at_end(&self, corner: Corner) -> Sample {
        self.simulation.pose.contacts.top(corner, self.block(), self.end_time())
    }

    #[inline(always)]
    fn block(&self) -> &Block {
        &self.simulation.system.block
    }

    /// Time at the end of the step that comes next (s).
    #[inline(always)]
    fn end_time(&self) -> f64 {
        if self.attempt.last { self.stop } else { self.simulation.pose.time + self.attempt.size }
    }

    /// Comes to the end of a step.
    #[inline]
    fn arrive(&mut self, stepped: &Stepped, lane: usize, short: bool) {
        let end_time = self.end_time();
        let Lane { simulation, attempt, .. } = self;
        let [left, right] = &stepped.support_heights;
        let top = |of: &Sample<Array>| Sample { value: of.value[lane], rate: of.rate[lane] };
        self.support_heights = (end_time, [top(left), top(right)]);
        if short {
            simulation.counts.evaluations += EVALUATIONS_PER_SHORT_STEP + 1;
        } else {
            simulation.control.accept(attempt, size_factor(stepped.root[lane]), stepped.longest[lane]);
            simulation.counts.evaluations += EVALUATIONS_PER_STEP;
            if self.grows {
                simulation.control.grow_short();
            }
        }
        simulation.counts.steps += 1;
        simulation.events_in_this_instant = 0;
        simulation.pose.time = end_time;
        let [theta, theta_dot, w, w_dot] = &stepped.state;
        simulation.pose.state = State::from([theta[lane], theta_dot[lane], w[lane], w_dot[lane]]);
        let [input, dashpots] = &stepped.sums;
        (simulation.sums.input, simulation.sums.dashpots) = (input[lane], dashpots[lane]);
        let [theta, reaction, horizontal, uplift, friction_demand] = &stepped.peaks;
        simulation.peaks = Peaks {
            theta: theta[lane],
            reaction: reaction[lane],
            horizontal: horizontal[lane],
            uplift: uplift[lane],
            friction_demand: friction_demand[lane],
            ..simulation.peaks
        };
        self.begins = false;
        self.short_failed = false;
        self.budget -= 1;
    }

    /// Takes note that a short step made too great an error. One of order 8 comes next.
    fn fail(&mut self, stepped: &Stepped, lane: usize) {
        self.simulation.counts.evaluations += EVALUATIONS_PER_SHORT_STEP + 1;
        self.simulation.control.reject_short(self.attempt.size, stepped.root[lane]);
        self.short_failed = true;
    }
}

/// Takes the next step, of this kind, of each run of a group of at most one run per lane.
///
/// Returns a bit for each run that has stepped; the others must take the step alone.
pub fn step_group(width: VectorWidth, kind: Kind, group: &mut [Box<Lane>]) -> u32 {
    let stepped = kernel::step(width, kind.regime, kind.short, group);
    for (lane, run) in group.iter_mut().enumerate() {
        if stepped.taken >> lane & 1 == 1 {
            run.arrive(&stepped, lane, kind.short);
        } else if stepped.failed >> lane & 1 == 1 {
            run.fail(&stepped, lane);
        }
    }
    stepped.taken | stepped.failed
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::block::{Common, Dimensionless};
    use crate::excitation::Pulse;
    use crate::simulation::{Initial, Settings};

    /// A block that tilts and does not come down within the next step.
    fn lane() -> Lane {
        let numbers = Dimensionless { alpha: 0.25, p: 2.0, eta: 20.0, xi_v: 0.1 };
        let block = Block::from_dimensionless(&numbers, &Common::default()).unwrap();
        let initial = Initial { theta: 0.15, ..Initial::default() };
        let inputs = Inputs::default();
        Lane::new(Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs), 0)
    }

    fn gives_up(lane: &mut Lane) {
        assert_eq!(lane.next_step(), Next::Alone);
        let error = lane.step_alone(&mut |_| ()).unwrap_err();
        assert!(matches!(error, SimulationError::TooManySteps { .. }), "{error}");
    }

    /// As a run does that is stepped alone.
    #[test]
    fn a_run_that_has_no_steps_left_gives_up() {
        let mut group = [Box::new(lane())];
        group[0].send(10.0, &Inputs::default());
        group[0].budget = 2;
        // The first step makes peaks where there were none, and is taken alone.
        for in_lane in [false, true] {
            let next = group[0].next_step();
            let Next::Together(kind) = next else { panic!("{next:?}") };
            let went = VectorWidth::widest().map(|width| step_group(width, kind, &mut group));
            assert!(went.is_none_or(|went| went == u32::from(in_lane)), "{went:?}");
            if went != Some(1) {
                group[0].step_alone(&mut |_| ()).unwrap();
            }
        }
        gives_up(&mut group[0]);
    }

    /// A stop so far away that the clock cannot resolve the motion on the way.
    #[test]
    fn a_run_that_the_clock_does_not_resolve_gives_up() {
        let mut lane = lane();
        lane.send(1e300, &Inputs::default());
        gives_up(&mut lane);
    }
}
