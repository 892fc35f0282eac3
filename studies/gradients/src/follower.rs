//! A run, step by step → the derivatives of its state, of its outputs, and of the times of its events.

use rocking_block::block::{Contact, Corner};
use rocking_block::excitation::{Excitation, Inputs};
use rocking_block::numerics::State;
use rocking_block::simulation::Simulation;
use rocking_block::simulation::follow::{Rates, ReachedEvent, Samples, StepKind, repeat_step};
use rocking_block::simulation::outputs::{Observation, observe};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::system::System;
use rocking_block::system::evaluation::{Evaluation, Motion};
use rocking_block::system::events::{Event, EventKind};
use rocking_block::system::forces::energy;
use rocking_block::system::instant::{Footing, Pose};

use crate::peaks::{PeakSegments, Segment};
use crate::varied::Varied;
use crate::{BATCH, Number};

/// An event with the derivatives of its time.
#[derive(Clone, Copy, Debug)]
pub struct EventGradient {
    /// The event.
    pub event: Event,
    /// Derivatives of its time (s per unit of the parameter). NaN where it grazes.
    pub time: [f64; BATCH],
}

/// A grazing event, after which no derivatives exist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grazing {
    /// Its time (s).
    pub time: f64,
    /// Its kind. `None` for a corner that becomes held or bears again, which is not reported.
    pub kind: Option<EventKind>,
}

/// The derivatives of a run in the directions of a batch. They advance with it, step by step.
#[derive(Clone, Debug)]
pub struct Follower {
    pub(crate) varied: Varied,
    pub(crate) system: System<Number>,
    /// The block, with derivatives at the fixed time of the run.
    pub(crate) pose: Pose<Number>,
    /// Derivatives of the time of the present event or kink; zeros after it.
    shift: [f64; BATCH],
    /// Displacement of the foot since the start (m).
    slip: Number,
    peak_segments: PeakSegments,
    excitation: Excitation<Number>,
    events: Vec<EventGradient>,
    grazing: Option<Grazing>,
}

impl Follower {
    /// Returns the derivatives of a run at its beginning under these inputs.
    pub fn new(simulation: &Simulation, varied: Varied, inputs: &Inputs) -> Follower {
        let system = System { block: varied.block, flies: simulation.system().flies };
        let time = simulation.time();
        let excitation = varied.excitation(inputs, simulation.pulse().acts_at(time));
        let pose = system.beginning(&varied.initial, Number::from(time), &excitation);
        let mut follower = Follower {
            varied,
            system,
            pose,
            shift: [0.0; BATCH],
            slip: Number::from(0.0),
            peak_segments: PeakSegments::new(),
            excitation,
            events: Vec::new(),
            grazing: None,
        };
        follower.adopt_values(simulation.pose());
        // The peaks begin with the block that a jump of the excitation has released.
        let now = follower.at(&follower.pose, &excitation);
        let start = Segment {
            start: follower.system.pose_after_jump(&follower.pose, &now).unwrap_or(follower.pose),
            start_shift: follower.shift,
            excitation,
            kind: StepKind::Stayed,
            end: time,
            end_shift: [0.0; BATCH],
        };
        follower.peak_segments.begin(&start, simulation.block().restraints.numbers());
        follower
    }

    /// Begins a smooth piece of the run under these inputs. The time at which the pulse begins or ends varies with its parameters, and
    /// the rate of the state jumps there.
    pub(crate) fn begin_piece(&mut self, simulation: &Simulation, inputs: &Inputs) {
        let (pulse, time) = (simulation.pulse(), simulation.time());
        if let Some((shift, acted)) = self.varied.kink(pulse, time) {
            for (acts, sign) in [(acted, 1.0), (!acted, -1.0)] {
                let excitation = self.varied.excitation(inputs, acts);
                let rates = Rates::of(&self.at(&self.pose, &excitation));
                self.pose = moved(&self.pose, &rates, shift.map(|shift| sign * shift));
            }
            self.pose.time = Number::from(time);
            self.shift = shift;
        }
        self.excitation = self.varied.excitation(inputs, pulse.acts_at(time));
    }

    /// Follows a step of the run to its present time and `fall`, if any. `peaks` are those before the step; `observer` receives the
    /// block at these `times` (s) inside it.
    pub(crate) fn take_step(
        &mut self,
        kind: &StepKind,
        fall: Option<ReachedEvent>,
        peaks: &Peaks,
        simulation: &Simulation,
        times: &[f64],
        observer: &mut dyn FnMut(&Sample),
    ) {
        let start_shift = self.shift;
        let start = if *peaks == simulation.peaks() { None } else { Some(self.pose) };
        self.advance(kind, simulation, times, observer);
        let (end, slip_rate) = (simulation.time(), fall.map_or(0.0, |fall| fall.rates.slip));
        let end_shift = match fall {
            Some(fall) => {
                self.shift = self.event_time(fall, kind);
                self.shift
            }
            // The excitation may jump where the pulse begins or ends.
            None => self.varied.kink(simulation.pulse(), end).map_or([0.0; BATCH], |(shift, _)| shift),
        };
        let Some(start) = start else { return };
        let segment = Segment { start, start_shift, excitation: self.excitation, kind: *kind, end, end_shift };
        self.peak_segments.record(peaks, &simulation.peaks(), (self.slip, slip_rate), &segment);
    }

    fn advance(&mut self, kind: &StepKind, simulation: &Simulation, times: &[f64], observer: &mut dyn FnMut(&Sample)) {
        let slides = !self.pose.footing.grips() && self.pose.contacts.regime().foot().is_some();
        let end = simulation.time();
        let foot_at_start = slides.then(|| self.at(&self.pose, &self.excitation).foot_place());
        let follower = &*self;
        let mut sample = |pose: &Pose<Number>| observer(&Sample { follower, pose, foot_at_start });
        match kind {
            StepKind::Stayed => return,
            StepKind::Rested => {
                let mut state = self.pose.state;
                for rate in [1, 3] {
                    state[rate] = Number::from(0.0);
                }
                for &time in times {
                    sample(&Pose { time: time.into(), state, ..self.pose });
                }
                self.pose.state = state;
            }
            StepKind::Step | StepKind::ShortStep | StepKind::Swing(_) => {
                let samples = Samples { times, seen: &mut sample };
                let end = repeat_step(&self.system.block, &self.pose, &self.excitation, kind, end, samples);
                (self.pose.state, self.pose.footing) = end;
            }
        }
        self.adopt_values(simulation.pose());
        if let Some(start) = foot_at_start {
            self.slip = self.slip + self.at(&self.pose, &self.excitation).foot_place() - start;
        }
        self.shift = [0.0; BATCH];
    }

    /// Returns the derivatives of the time at which an event function falls through zero.
    fn event_time(&self, ReachedEvent { function, rate, grazes, .. }: ReachedEvent, kind: &StepKind) -> [f64; BATCH] {
        let Number { re: value, eps } = function.value(&self.at(&self.pose, &self.excitation));
        if matches!(kind, StepKind::Stayed) && value < -function.rounding(&self.system.block) {
            // A jump of the excitation, or another event, took the event function below zero in this instant.
            return self.shift;
        }
        if grazes { [f64::NAN; BATCH] } else { eps.map(|eps| -eps / rate) }
    }

    /// Applies an event that the run just passed. `after` are the run's rates after it.
    ///
    /// The pose moves to the varied time of the event under the mode before it, through the transition, and back to the time of the run
    /// under the mode after it.
    pub(crate) fn pass_event(
        &mut self,
        fall: &ReachedEvent,
        happened: Option<Event>,
        after: &Rates,
        simulation: &Simulation,
    ) {
        let (shift, time) = (self.shift, simulation.time());
        let before = moved(&self.pose, &fall.rates, shift);
        self.pose = self.system.transition(&before, &self.at(&before, &self.excitation), fall.function).pose;
        self.adopt_values(simulation.pose());
        if shift.iter().any(|shift| !shift.is_finite()) && self.grazing.is_none() {
            self.grazing = Some(Grazing { time, kind: happened.map(|event| event.kind) });
        }
        self.events.extend(happened.map(|event| EventGradient { event, time: shift }));
        if !simulation.is_frozen() {
            let slowed = fall.rates.slip - after.slip;
            let landed = self.pose.contacts.regime().foot().is_some() && before.contacts.regime().foot().is_none();
            self.pose = moved(&self.pose, after, shift.map(|shift| -shift));
            let eps = if landed {
                self.at(&self.pose, &self.excitation).foot_place().eps
            } else {
                std::array::from_fn(|i| self.slip.eps[i] + slowed * shift[i])
            };
            self.slip = Number::new(simulation.slip().now, eps);
            if landed && simulation.peaks().slip == self.slip.re.abs() {
                self.peak_segments.record_slip(self.slip, after.slip, shift);
            }
        }
        self.pose.time = Number::from(time);
    }

    /// Replaces the values, which differ by round-off, by those of the run. A pose of another kind makes the derivatives NaN.
    fn adopt_values(&mut self, run: &Pose) {
        let pose = &mut self.pose;
        let same = pose.restraints.adopt_values(&run.restraints, |number, value| number.re = value);
        let mut alike = same || self.system.block.restraints.is_empty();
        pose.time.re = run.time;
        for (number, value) in pose.state.0.iter_mut().zip(run.state.0) {
            number.re = value;
        }
        match (&mut pose.footing, run.footing) {
            (Footing::Grips { offset }, Footing::Grips { offset: value }) => offset.re = value,
            (Footing::Free { u, u_dot }, Footing::Free { u: value, u_dot: rate })
            | (Footing::Slides { u, u_dot, .. }, Footing::Slides { u: value, u_dot: rate, .. }) => {
                (u.re, u_dot.re) = (value, rate);
            }
            (footing, value) => (*footing, alike) = (value.map(Number::from), false),
        }
        for corner in Corner::BOTH {
            match (pose.contacts.of_mut(corner), run.contacts.of(corner)) {
                (Contact::Bearing, Contact::Bearing) => {}
                (Contact::Held(creep, slide), Contact::Held(value, run)) => {
                    alike &= *slide == run;
                    (creep.depth.re, creep.since.re, *slide) = (value.depth, value.since, run);
                }
                (Contact::Lifted(creep), Contact::Lifted(value)) => {
                    (creep.depth.re, creep.since.re) = (value.depth, value.since);
                }
                (contact, value) => (*contact, alike) = (value.map(Number::from), false),
            }
        }
        debug_assert!(alike, "{pose:?} {run:?}");
        if !alike {
            for number in &mut pose.state.0 {
                number.eps = [f64::NAN; BATCH];
            }
        }
    }

    pub(crate) fn at<'a>(&'a self, pose: &Pose<Number>, excitation: &'a Excitation<Number>) -> Evaluation<'a, Number> {
        Motion::from_pose(&self.system.block, pose, excitation).at_outlined(pose.time, pose.state)
    }

    /// Implements [`ObserveInside`](crate::peaks::ObserveInside).
    fn inside(&self, segment: &Segment, elapsed: f64) -> [Observation<Number>; 2] {
        let Segment { start, excitation, kind, .. } = segment;
        // A short step has no dense output, so a part of it is repeated as a step of order 8.
        let kind = if let StepKind::Swing(_) = kind { kind } else { &StepKind::Step };
        let mut pose = *start;
        if elapsed != 0.0 {
            let (samples, end) = (Samples { times: &[], seen: &mut |_| () }, start.time.re + elapsed);
            let (state, footing) = repeat_step(&self.system.block, start, excitation, kind, end, samples);
            pose = Pose { time: end.into(), state, footing, ..pose };
        }
        let now = self.at(&pose, excitation);
        let along = self.at(&moved(&pose, &Rates::of(&now), [1.0; BATCH]), excitation);
        [self.observed(&now), self.observed(&along)]
    }

    fn observed(&self, now: &Evaluation<Number>) -> Observation<Number> {
        let heights = now.support_heights.map(|top| top.re);
        observe(&self.system.block, now.regime, &now.instant, heights, now.forcing)
    }

    /// Returns the observed quantities right after these inputs begin to act, with derivatives.
    pub fn observe(&self, simulation: &Simulation, inputs: &Inputs) -> Observation<Number> {
        let excitation = self.varied.excitation(inputs, simulation.pulse().acts_at(simulation.time()));
        let now = self.at(&self.pose, &excitation);
        let shown = match simulation.ending() {
            Some(_) => now,
            None => match self.system.pose_after_jump(&self.pose, &now) {
                Some(released) => self.at(&released, &excitation),
                None => now,
            },
        };
        let seen = self.observed(&shown);
        if simulation.is_frozen() { seen.without_motion() } else { seen }
    }

    /// Returns kinetic and total energy (J), and the ground accelerations (m/s²).
    pub fn energies_and_ground(&self, simulation: &Simulation, inputs: &Inputs) -> ([Number; 2], [Number; 2]) {
        let excitation = self.varied.excitation(inputs, simulation.pulse().acts_at(simulation.time()));
        let (block, now) = (&self.system.block, self.at(&self.pose, &excitation));
        let (kinetic, potential) = energy(block, now.regime, &now.forcing, &now.instant);
        let ground = excitation.at(self.pose.time);
        ([kinetic * block.mass, (kinetic + potential) * block.mass], [ground.x, ground.z])
    }

    /// Returns the block, with derivatives at this time.
    pub fn pose(&self) -> &Pose<Number> {
        &self.pose
    }

    /// Returns the displacement of the foot since the start (m).
    pub fn slip(&self) -> Number {
        self.slip
    }

    /// Returns the peaks since the start.
    pub fn peaks(&self, simulation: &Simulation) -> Peaks<Number> {
        let inside = |segment: &Segment, elapsed: f64| self.inside(segment, elapsed);
        self.peak_segments.peaks(&self.system.block, &simulation.peaks(), &inside)
    }

    /// Returns the events since the start, with the derivatives of their times.
    pub fn events(&self) -> &[EventGradient] {
        &self.events
    }

    /// Returns the grazing event, if there was one.
    pub fn grazing(&self) -> Option<Grazing> {
        self.grazing
    }
}

/// The block inside a step, with its derivatives at that time.
pub struct Sample<'a> {
    follower: &'a Follower,
    pose: &'a Pose<Number>,
    /// Position of the foot at the beginning of the step (m), if it slides.
    foot_at_start: Option<Number>,
}

impl Sample<'_> {
    /// Returns the block.
    pub fn pose(&self) -> &Pose<Number> {
        self.pose
    }

    /// Returns the observed quantities.
    pub fn observe(&self) -> Observation<Number> {
        self.follower.observed(&self.follower.at(self.pose, &self.follower.excitation))
    }

    /// Returns the observed quantities with their rates along the motion (1/s) added to their derivatives.
    pub fn observe_along(&self) -> Observation<Number> {
        let Sample { follower, pose, .. } = *self;
        let now = follower.at(pose, &follower.excitation);
        follower.observed(&follower.at(&moved(pose, &Rates::of(&now), [1.0; BATCH]), &follower.excitation))
    }

    /// Returns the displacement of the foot since the start (m).
    pub fn slip(&self) -> Number {
        let now = || self.follower.at(self.pose, &self.follower.excitation).foot_place();
        self.foot_at_start.map_or(self.follower.slip, |start| self.follower.slip + now() - start)
    }
}

/// Returns the pose moved along the motion by `shift` (s) in each direction.
fn moved(pose: &Pose<Number>, rates: &Rates, shift: [f64; BATCH]) -> Pose<Number> {
    let moved =
        |number: Number, rate: f64| Number::new(number.re, std::array::from_fn(|i| number.eps[i] + rate * shift[i]));
    let mut footing = pose.footing;
    if let Footing::Free { u, u_dot } | Footing::Slides { u, u_dot, .. } = &mut footing {
        (*u, *u_dot) = (moved(*u, rates.u[0]), moved(*u_dot, rates.u[1]));
    }
    let state = State::from(std::array::from_fn(|i| moved(pose.state[i], rates.state[i])));
    Pose { time: moved(pose.time, 1.0), state, footing, ..*pose }
}
