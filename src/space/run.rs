//! A run in space: its state, and the driver that steps it through its events.
//!
//! | call | advances |
//! | --- | --- |
//! | [`SpaceRun::advance`] | to a time, over several smooth pieces of the excitation |
//! | `smooth_piece`, in `stepping` | to the end of a piece, step by step, through events |

use serde::{Deserialize, Serialize};

use crate::numerics::control::StepControl;
use crate::numerics::dual::Dual;
use crate::numerics::stepper::Stepper;
use crate::run::{Ending, MAX_STEPS, OnSeparation, Progress, Settings, SimulationError};
use crate::space::beginning::SpaceInitial;
use crate::space::body::SpaceBody;
use crate::space::energies::{SpaceEnergies, StoredEnergy, energy_rates, stored};
use crate::space::equations::{SpaceEquations, with_rates};
use crate::space::events::{SpaceEvent, SpaceEventKind, topples};
use crate::space::excitation::{DirectedPulses, SpaceExcitation, SpaceInputs, next_kink};
use crate::space::forces::FootContact;
use crate::space::limits::SpaceLimits;
use crate::space::motion::{FEET_FROM, VELOCITY, dimension, moving, works};
use crate::space::outputs::SpaceObservation;
use crate::space::peaks::{SpacePeakRates, SpacePeaks};
use crate::space::piece::{SpacePiece, indicator_count, place};
use crate::space::samples::SpaceSamples;

/// Counters since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpaceCounts {
    /// Feet that lifted.
    pub lift_offs: u64,
    /// Feet that landed.
    pub landings: u64,
    /// Feet that began to slide.
    pub slides: u64,
    /// Feet that stuck again.
    pub sticks: u64,
    /// Steps that were accepted.
    pub steps: u64,
    /// Steps that were repeated with a smaller size.
    pub rejected: u64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// The state of a run: plain numbers, which can be saved. A run that is given a saved state continues with the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceState {
    /// Time (s).
    pub time: f64,
    /// The numbers that are integrated; see [`motion`](super::motion).
    pub numbers: Vec<f64>,
    /// The contacts of the feet.
    pub contacts: Vec<FootContact>,
    /// The size of the next step.
    pub control: StepControl,
    /// The reason and the time (s) of the end of the run, if it ended.
    pub ending: Option<(Ending, f64)>,
    /// Whether no foot touched at some time.
    pub separated: bool,
    /// Energy at the start (J).
    pub initial_energy: f64,
    /// Energy of springs lost at lift-offs, less that of supports that had not recovered at landings (J).
    pub lift_off_energy: f64,
    /// Greatest values.
    pub peaks: SpacePeaks,
    /// Counters.
    pub counts: SpaceCounts,
    /// Time of the last event (s), or of the start.
    pub last_event: f64,
    pub(super) events_in_this_instant: usize,
    /// The present smooth piece of a block that is stepped from outside.
    pub(super) piece: Option<SpacePiece>,
}

/// The block, its settings and its pulses, which no step changes.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceSetup {
    /// The block.
    pub body: SpaceBody,
    /// Tolerance, and the treatment of ends.
    pub settings: Settings,
    /// The pulses.
    pub pulses: DirectedPulses,
}

/// What changes with time, and its rates.
#[derive(Clone, Debug)]
pub struct SpaceRates {
    /// The observed quantities with their rates.
    pub observed: SpaceObservation<Dual>,
    /// Rates of the energies (W).
    pub energies: SpaceEnergies,
    /// Rates of the greatest values.
    pub peaks: SpacePeakRates,
}

/// Memory of steps. A run forms it anew.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    pub(super) stepper: Stepper,
    pub(super) limits: SpaceLimits,
    pub(super) rates: Vec<f64>,
    pub(super) end: Vec<f64>,
    pub(super) end_rates: Vec<f64>,
    pub(super) inside: Vec<f64>,
    pub(super) inside_rates: Vec<f64>,
    /// Samples at both ends of a step.
    pub(super) samples: [SpaceSamples; 2],
    /// Which of them fall through zero at an event.
    pub(super) falls: Vec<bool>,
    /// The event indicators for a solver outside.
    pub(super) indicators: Vec<f64>,
}

/// A block in motion.
#[derive(Clone, Debug)]
pub struct SpaceRun {
    pub(super) setup: SpaceSetup,
    pub(super) state: SpaceState,
    pub(super) memory: Memory,
}

impl Memory {
    fn new(body: &SpaceBody) -> Memory {
        let n = dimension(body.count());
        let numbers = || vec![0.0; n];
        let functions = indicator_count(body.count());
        Memory {
            stepper: Stepper::new(n, moving(body.count())),
            limits: SpaceLimits::new(body.count()),
            rates: numbers(),
            end: numbers(),
            end_rates: numbers(),
            inside: numbers(),
            inside_rates: numbers(),
            samples: [SpaceSamples::new(body.count()), SpaceSamples::new(body.count())],
            falls: vec![false; functions],
            indicators: vec![0.0; functions],
        }
    }
}

impl SpaceRun {
    /// Places a block at its beginning at `time` (s).
    pub fn new(setup: SpaceSetup, initial: &SpaceInitial, time: f64) -> SpaceRun {
        let setup = SpaceSetup { settings: setup.settings.within_limits(), ..setup };
        let (numbers, contacts) = initial.state(&setup.body, time);
        let mut state = SpaceState {
            time,
            control: StepControl::NEW,
            ending: None,
            separated: false,
            initial_energy: StoredEnergy::from(stored(&setup.body, &numbers, &contacts)).total(),
            lift_off_energy: 0.0,
            peaks: SpacePeaks::at_start(&setup.body, &numbers),
            counts: SpaceCounts::default(),
            last_event: time,
            events_in_this_instant: 0,
            piece: None,
            numbers,
            contacts,
        };
        state.note_separation(&setup);
        let mut run = SpaceRun { memory: Memory::new(&setup.body), setup, state };
        // Forces and heights of feet do not depend on the excitation.
        let at_start = run.observe(&SpaceInputs::default());
        run.state.peaks.include_feet(&at_start.feet);
        run
    }

    /// Continues a saved state of a run with the same setup.
    ///
    /// # Errors
    /// The state does not belong to a block with as many feet, or is not finite; with the number at fault.
    pub fn resume(setup: SpaceSetup, state: SpaceState) -> Result<SpaceRun, String> {
        let feet = setup.body.count();
        if state.contacts.len() != feet || state.numbers.len() != dimension(feet) {
            return Err(format!("the state has {} feet; expected {feet}", state.contacts.len()));
        }
        if let Some(piece) = &state.piece
            && piece.last.1.len() != dimension(feet)
        {
            return Err(format!("the last step has {} numbers; expected {}", piece.last.1.len(), dimension(feet)));
        }
        let creeps = state.contacts.iter().flat_map(|contact| match contact {
            FootContact::Lifted(creep) => [creep.depth, creep.since],
            FootContact::Sticks | FootContact::Slides => [0.0; 2],
        });
        let others = [state.time, state.last_event, state.initial_energy, state.lift_off_energy];
        let piece = state.piece.iter().flat_map(SpacePiece::numbers);
        let numbers = state.numbers.iter().copied().chain(creeps).chain(others).chain(piece);
        if let Some(number) = numbers.into_iter().find(|number| !number.is_finite()) {
            return Err(format!("the state has the number {number}; expected finite ones"));
        }
        if !state.peaks.is_valid() {
            return Err(format!("the state has the peaks {:?}; expected finite ones, none negative", state.peaks));
        }
        if !state.control.is_valid() {
            return Err("the state has an invalid step size; expected a positive one".into());
        }
        Ok(SpaceRun { memory: Memory::new(&setup.body), setup, state })
    }

    /// Advances to `until` (s) under inputs that are linear in time. Reports each event to `observer` as it happens. `until` is not before
    /// the present time.
    ///
    /// Stops at the end of the run if that comes first. No memory is allocated. On an error the state is that of the last good step.
    ///
    /// # Errors
    /// The solver cannot go on: see [`SimulationError`].
    pub fn advance(
        &mut self,
        until: f64,
        inputs: &SpaceInputs,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<Progress, SimulationError> {
        let progress = self.advance_to_event(until, f64::INFINITY, inputs, observer)?;
        Ok(progress.unwrap_or(Progress::Reached))
    }

    /// Advances as [`SpaceRun::advance`] does, at most to the first event later than `after` (s), which has happened then. Returns `None` if
    /// that stops it.
    ///
    /// # Errors
    /// The solver cannot go on: see [`SimulationError`].
    pub fn advance_to_event(
        &mut self,
        until: f64,
        after: f64,
        inputs: &SpaceInputs,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<Option<Progress>, SimulationError> {
        let mut budget = MAX_STEPS;
        let after = after.max(self.state.last_event);
        while self.state.time < until && self.state.ending.is_none() {
            let stop = next_kink(&self.setup.pulses, self.state.time).map_or(until, |kink| kink.min(until));
            self.smooth_piece(stop, after, inputs, &mut budget, observer)?;
            // A run that ends says so itself; a block that is held from now on stops a step as by any event.
            if self.state.last_event > after && (self.state.ending.is_none() || self.is_frozen()) {
                return Ok(None);
            }
        }
        match self.state.ending {
            Some((ending, time)) if !self.is_frozen() => Ok(Some(Progress::Ended(ending, time))),
            _ => {
                self.state.time = until;
                Ok(Some(Progress::Reached))
            }
        }
    }

    /// Sets the clock to a time (s) that a master has rounded.
    pub fn set_time(&mut self, time: f64) {
        self.state.time = time;
    }

    /// Whether the run has ended and the block is held, without motion or support.
    pub fn is_frozen(&self) -> bool {
        self.state.ending.is_some_and(|(ending, _)| self.setup.settings.holds(ending))
    }

    /// Whether the block has overturned, or is bound to where the run ends now.
    pub fn overturns(&self) -> bool {
        match self.state.ending {
            Some((ending, _)) => ending.is_overturning(),
            None => topples(&self.setup.body, &self.state.numbers),
        }
    }

    /// The state.
    pub fn state(&self) -> &SpaceState {
        &self.state
    }

    /// The block.
    pub fn body(&self) -> &SpaceBody {
        &self.setup.body
    }

    /// The block, its settings and its pulses.
    pub fn setup(&self) -> &SpaceSetup {
        &self.setup
    }

    /// Present time (s).
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Greatest values so far.
    pub fn peaks(&self) -> &SpacePeaks {
        &self.state.peaks
    }

    /// Greatest tilt so far (rad).
    pub fn peak_tilt(&self) -> f64 {
        self.state.peaks.tilt()
    }

    /// Energies now, and their sums since the start (J).
    pub fn energies(&self) -> SpaceEnergies {
        let SpaceState { numbers, contacts, initial_energy, lift_off_energy, .. } = &self.state;
        let stored = StoredEnergy::from(stored(&self.setup.body, numbers, contacts));
        let [input, dashpots, slip] = works(numbers, self.setup.body.count());
        let lift_off = *lift_off_energy;
        let residual = stored.total() - initial_energy - input + dashpots + slip + lift_off;
        SpaceEnergies { stored, input, dashpots, slip, lift_off, residual }
    }

    /// The quantities that users see, under these inputs.
    pub fn observe(&self, inputs: &SpaceInputs) -> SpaceObservation {
        let excitation = self.excitation(inputs);
        let SpaceState { time, numbers, contacts, .. } = &self.state;
        let equations = SpaceEquations { body: &self.setup.body, contacts, excitation: &excitation };
        let mut rates = vec![0.0; numbers.len()];
        equations.rates(*time, numbers, &mut rates);
        SpaceObservation::of(&self.setup.body, contacts, *time, numbers, &rates)
    }

    /// What changes with time under these inputs, with exact rates. Nothing does of a block that is held.
    pub fn rates(&self, inputs: &SpaceInputs) -> SpaceRates {
        let excitation = self.excitation(inputs);
        let SpaceState { time, numbers, contacts, .. } = &self.state;
        let body = &self.setup.body;
        let equations = SpaceEquations { body, contacts, excitation: &excitation };
        let mut rates = vec![0.0; numbers.len()];
        if !self.is_frozen() {
            equations.rates(*time, numbers, &mut rates);
        }
        let mut state = vec![Dual::default(); numbers.len()];
        with_rates(numbers, &rates, &mut state);
        let mut second = vec![Dual::default(); numbers.len()];
        let clock = if self.is_frozen() { 0.0 } else { 1.0 };
        let time = Dual::new(*time, clock);
        equations.rates(time, &state, &mut second);
        let observed = SpaceObservation::of(body, contacts, time, &state, &second);
        let observed = if self.is_frozen() { observed.held() } else { observed };
        SpaceRates {
            peaks: self.state.peaks.rates(&observed),
            energies: energy_rates(body, numbers, &rates, contacts),
            observed,
        }
    }

    /// The change of what users see in a direction of [continuous states](SpaceRun::continuous_states), the values of inputs, and time.
    /// Contacts and greatest values stay. A block that is held has no velocities.
    pub fn along(&self, at: &SpaceInputs, states: &[f64], inputs: &SpaceInputs, time: f64) -> SpaceRates {
        let excitation = self.excitation(at);
        let SpaceState { time: now, numbers: values, contacts, ending, .. } = &self.state;
        let (body, is_frozen) = (&self.setup.body, self.is_frozen());
        let moves = |i: usize| !is_frozen || !(VELOCITY..FEET_FROM).contains(&i);
        let direction = |i: usize| if moves(i) { states[place(i, body.count())] } else { 0.0 };
        let state: Vec<Dual> = values.iter().enumerate().map(|(i, &value)| Dual::new(value, direction(i))).collect();
        let time = Dual::new(*now, if ending.is_some() { 0.0 } else { time });
        let equations = SpaceEquations { body, contacts, excitation: &excitation };
        let forcing = excitation.at(time).moved(inputs, body.mass);
        let mut rates = vec![Dual::default(); values.len()];
        equations.rates_under(&forcing, &state, &mut rates);
        let observed = SpaceObservation::of(body, contacts, time, &state, &rates);
        let stored = StoredEnergy::from(stored(body, &state, contacts).map(|energy| energy.eps));
        SpaceRates {
            observed: if is_frozen { observed.held() } else { observed },
            energies: SpaceEnergies::changing(stored, std::array::from_fn(|i| states[FEET_FROM + i])),
            peaks: SpacePeakRates::default(),
        }
    }

    pub(super) fn excitation(&self, inputs: &SpaceInputs) -> SpaceExcitation {
        SpaceExcitation::new(self.piece_time(), inputs, &self.setup.pulses, self.setup.body.mass)
    }
}

impl SpaceCounts {
    /// Counts an event.
    pub(super) fn add(&mut self, kind: SpaceEventKind) {
        match kind {
            SpaceEventKind::LiftOff(_) => self.lift_offs += 1,
            SpaceEventKind::Landing(_) => self.landings += 1,
            SpaceEventKind::Slides(_) => self.slides += 1,
            SpaceEventKind::Sticks(_) => self.sticks += 1,
            SpaceEventKind::Overturning => {}
        }
    }
}

impl SpaceState {
    /// Moves the clock forward, to another instant if it can tell them apart.
    pub(super) fn move_clock(&mut self, time: f64) {
        if time > self.time {
            self.events_in_this_instant = 0;
        }
        self.time = time;
    }

    /// Whether a foot touches.
    pub fn touches(&self) -> bool {
        self.contacts.iter().any(FootContact::touches)
    }

    /// Notes a block that touches nothing, which ends the run unless it flies.
    pub(super) fn note_separation(&mut self, setup: &SpaceSetup) {
        if self.touches() {
            return;
        }
        self.separated = true;
        if setup.settings.on_separation != OnSeparation::Fly && self.ending.is_none() {
            let ending = if topples(&setup.body, &self.numbers) { Ending::Toppled } else { Ending::Separated };
            self.ending = Some((ending, self.time));
        }
    }
}
