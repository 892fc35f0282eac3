//! Calls of an importer, whatever the version of FMI → a block in motion: all of an instance but its messages.

pub mod derivatives;
pub mod exchange;
mod rates;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::excitation::Inputs;
use crate::ground::Ground;
use crate::simulation::exchange::States;
use crate::simulation::outputs::Observation;
use crate::simulation::{Energies, Progress, Settings, Simulation, SimulationError};
use crate::system::events::Event;
use crate::unit::fault::Fault;
use crate::unit::life_cycle::Phase;
use crate::unit::outputs::{source, state};
use crate::unit::substeps::Substep;
use crate::unit::values::{DerivedSource, PerInput, Values, derived};
use crate::unit::variables::{Input, Kind, Metadata, Output, Role, VARIABLES, Variability};

/// What is known of the run before it begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Experiment {
    tolerance: Option<f64>,
    start: f64,
    stop: Option<f64>,
}

/// Who steps the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interface {
    /// The block itself.
    CoSimulation,
    /// A solver of the importer.
    ModelExchange,
}

/// An instance as a safe state machine: no pointer, no C, and no messages. A copy of it is a saved state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    interface: Interface,
    pub(super) phase: Phase,
    experiment: Experiment,
    pub(super) values: Values,
    /// Rates of the inputs, and whether they were set since the last step: otherwise the next step holds the inputs.
    rates: PerInput,
    rates_are_new: bool,
    /// The block in motion; before initialization ends, what it would start as, if that is known.
    pub(super) simulation: Option<Simulation>,
    /// What acts at the present time: the inputs, and the records inside.
    inputs: Inputs,
    /// The part of a step in which the inputs are known beforehand; see [`crate::unit::substeps`].
    pub(super) substep: Option<Substep>,
    /// Where the communication step would have ended that was left early (s).
    pub(super) left: Option<f64>,
    /// The records inside, once they are read. Shared with saved states; serialized states hold them whole, so that no file
    /// is needed to resume from one.
    ground: Option<Arc<Ground>>,
    /// In Model Exchange the continuous states, as they were set or as the last event left them.
    states: States,
    /// In Model Exchange the inputs at the end of the last completed step.
    last_inputs: PerInput,
    /// What is seen at the present time, until something changes it.
    #[serde(skip)]
    seen: Option<(Observation<f64>, Energies)>,
}

/// Largest error of a master's clock, relative to the greater of step and time.
const CLOCK_ROUNDING: f64 = 1e-9;

/// Largest part of a communication step that a master's clock may skip.
const MOST_SKIPPED: f64 = 1e-3;

/// Largest accepted error (s) of a master's clock near `time` (s) for a communication step of `step` (s).
fn clock_slack(step: f64, time: f64) -> f64 {
    (CLOCK_ROUNDING * step.max(time.abs())).min(MOST_SKIPPED * step)
}

impl Unit {
    /// A new instance, all values at their starts.
    pub fn new(interface: Interface) -> Unit {
        Unit {
            interface,
            phase: Phase::Instantiated,
            experiment: Experiment::default(),
            values: Values::default(),
            rates: PerInput::default(),
            rates_are_new: false,
            simulation: None,
            inputs: Inputs::default(),
            substep: None,
            left: None,
            ground: None,
            states: States::default(),
            last_inputs: PerInput::default(),
            seen: None,
        }
    }

    /// Who steps the block.
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// Where the instance is in its life.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// A panic was caught: nothing can be trusted any more.
    pub fn fail_fatally(&mut self) {
        self.phase = Phase::Fatal;
    }

    /// Whether this can be the state of an instance of this FMU: what a file says of itself is not enough.
    pub fn is_valid(&self) -> bool {
        let times = [self.experiment.start, self.inputs.time, self.left.unwrap_or(0.0)];
        let looked_at = matches!(self.phase, Phase::SettingAhead | Phase::LookingIn);
        let stepped = matches!(self.phase, Phase::StepComplete | Phase::StepFailed);
        self.values.are_valid()
            && self.phase != Phase::Fatal
            && match self.interface {
                Interface::CoSimulation => self.phase != Phase::ContinuousTimeMode,
                Interface::ModelExchange => !stepped,
            }
            && !looked_at
            && times.iter().chain(&self.rates).chain(&self.states).chain(&self.last_inputs).all(|x| x.is_finite())
            && self.ground.as_ref().is_none_or(|ground| ground.is_valid())
            && self.substep.as_ref().is_none_or(Substep::is_valid)
            && match &self.simulation {
                Some(simulation) => {
                    self.ground.is_some()
                        && simulation.is_valid()
                        && self.values.block().as_ref() == Ok(simulation.block())
                }
                None => !self.phase.is_initialized(),
            }
    }

    /// The run as it is planned. Gives the tolerance that is followed where it is not the one that was asked for.
    pub fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault> {
        if !start.is_finite() {
            return Err(Fault::new(format!("startTime = {start:?}; expected a finite time")));
        }
        if let Some(stop) = stop
            && !(stop.is_finite() && stop > start)
        {
            return Err(Fault::new(format!("stopTime = {stop:?}; expected a finite time after startTime = {start:?}")));
        }
        if let Some(tolerance) = tolerance
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Fault::new(format!("tolerance = {tolerance:?}; expected a finite number > 0")));
        }
        self.experiment = Experiment { tolerance, start, stop };
        self.forget();
        let [least, most] = Settings::TOLERANCES;
        let followed = |tolerance: f64| tolerance.clamp(least, most);
        Ok(tolerance.filter(|&tolerance| followed(tolerance) != tolerance).map(followed))
    }

    /// The initialization begins.
    pub fn enter_initialization_mode(&mut self) {
        self.phase = Phase::InitializationMode;
        self.forget();
    }

    /// The values become a block, or the call is refused and they can be corrected. Gives the parameters that were set and
    /// that nothing reads, each with what it needs.
    pub fn exit_initialization_mode(&mut self) -> Result<Vec<(&'static str, &'static str)>, Fault> {
        self.preview()?;
        self.phase = match self.interface {
            Interface::CoSimulation => Phase::StepComplete,
            Interface::ModelExchange => {
                self.states = self.states()?;
                Phase::EventMode
            }
        };
        Ok(self.values.unread().collect())
    }

    /// Sizes of the block that were not set but are read, each with the start value in its place.
    pub fn unset_sizes(&self) -> Vec<(&'static str, f64)> {
        self.values.unset_sizes().map(|variable| (variable.name(), self.values[variable])).collect()
    }

    /// The run ends.
    pub fn terminate(&mut self) {
        self.phase = Phase::Terminated;
    }

    /// Goes on from `time` (s), which is the present one but for a master's rounding, by `step` (s), and reports each event
    /// as it happens. Allocates no memory unless it fails.
    pub fn advance(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<Progress, Fault> {
        let until = self.begin_step(time, step)?;
        if !self.rates_are_new {
            self.rates = PerInput::default();
        }
        let inputs = self.values.inputs(time, &self.rates);
        let progress = self.go_on(until, &inputs, |simulation, until, inputs| {
            simulation.advance(until, inputs, observer).map(|progress| (progress, false))
        })?;
        self.rates_are_new = false;
        let elapsed = self.time() - time;
        for (input, rate) in Input::ALL.into_iter().zip(self.rates) {
            self.values[input.variable()] += rate * elapsed;
        }
        Ok(progress.0)
    }

    /// Refuses a communication step that cannot be done, and takes up the master's rounding; gives the step's end (s).
    pub(super) fn begin_step(&mut self, time: f64, step: f64) -> Result<f64, Fault> {
        let Unit { experiment, simulation, left, .. } = self;
        let Some(simulation) = simulation else { return Err(Fault::new("there is no block yet")) };
        let present = simulation.time();
        if !(step.is_finite() && step > 0.0) {
            return Err(Fault::new(format!("communicationStepSize = {step:?} at t = {present:?} s; expected > 0 s")));
        }
        let slack = clock_slack(step, present);
        // A time that is no number is off by no number.
        if !time.is_finite() || (time - present).abs() > slack {
            return Err(Fault::new(format!(
                "currentCommunicationPoint = {time:?} s; the FMU is at t = {present:?} s and takes at most {slack:e} s off"
            )));
        }
        let until = time + step;
        if let Some(stop) = experiment.stop
            && until > stop + clock_slack(step, stop)
        {
            return Err(Fault::new(format!("a step to t = {until:?} s passes stopTime = {stop:?} s")));
        }
        if until == time {
            return Err(Fault::new(format!("communicationStepSize = {step:e} s is lost in t = {time:?} s")));
        }
        simulation.set_time(time);
        // The rest of a step that was left early ends where that step would have ended, up to the rounding of `time + step`.
        let rounding = slack.max(f64::EPSILON * until.abs());
        Ok(left.take().filter(|end| (end - until).abs() <= rounding && *end > time).unwrap_or(until))
    }

    /// Goes on to `until` (s) under these inputs and the records inside, from one of their samples to the next. `advance` does
    /// one such piece, and says how far it came and whether it stopped there.
    pub(super) fn go_on(
        &mut self,
        until: f64,
        inputs: &Inputs,
        mut advance: impl FnMut(&mut Simulation, f64, &Inputs) -> Result<(Progress, bool), SimulationError>,
    ) -> Result<(Progress, bool), Fault> {
        let Unit { phase, simulation, inputs: acting, ground, seen, .. } = self;
        let (Some(simulation), Some(ground)) = (simulation, ground) else {
            return Err(Fault::new("there is no block yet"));
        };
        *seen = None;
        let (progress, stopped) = loop {
            let (sum, stop) = with_ground(inputs, ground, simulation.time());
            *acting = sum;
            match advance(simulation, stop.min(until), acting) {
                Ok((Progress::Reached, false)) if stop < until => {}
                Ok(progress) => break progress,
                Err(error) => {
                    *phase = Phase::Error;
                    return Err(Fault::new(error.to_string()));
                }
            }
        };
        match progress {
            Progress::Reached if stopped => {}
            // A record may have a sample here, from which it goes on otherwise.
            Progress::Reached if !ground.is_empty() => *acting = with_ground(inputs, ground, simulation.time()).0,
            Progress::Reached => {}
            Progress::Ended(..) => *phase = Phase::StepFailed,
        }
        Ok((progress, stopped))
    }

    /// The inputs with the records inside at the present time, and until when they act (s).
    pub(super) fn acting(&self, inputs: &Inputs) -> (Inputs, f64) {
        self.ground.as_ref().map_or((*inputs, f64::INFINITY), |ground| with_ground(inputs, ground, self.time()))
    }

    /// Applies the event at which a step was left, if one was, under the inputs as they are now.
    pub fn settle(&mut self, observer: &mut dyn FnMut(&Event)) -> Result<(), Fault> {
        let Unit { phase, simulation, inputs: acting, seen, .. } = self;
        let Some(simulation) = simulation else { return Err(Fault::new("there is no block yet")) };
        *seen = None;
        simulation.settle(acting, observer).map_err(|error| {
            *phase = Phase::Error;
            Fault::new(error.to_string())
        })
    }

    /// Whether the run has come to its end, by itself.
    pub fn has_ended(&self) -> bool {
        self.simulation.as_ref().is_some_and(|simulation| simulation.ending().is_some() && !simulation.is_frozen())
    }

    /// The present time (s); before there is a block, that of the planned start.
    pub fn time(&self) -> f64 {
        self.simulation.as_ref().map_or(self.experiment.start, Simulation::time)
    }

    /// Refuses variables that do not exist or are of another type.
    pub fn check(&self, references: &[u32], kind: Kind) -> Result<(), Fault> {
        references.iter().try_for_each(|&reference| known(reference, kind).map(|_| ()))
    }

    /// Sets values of one type, all or none. Values that repeat the present one of a fixed parameter are refused, too.
    pub fn set<V: Copy>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &[V],
        real: impl Fn(V) -> f64,
    ) -> Result<(), Fault> {
        for (&reference, &value) in references.iter().zip(values) {
            let metadata = known(reference, kind)?;
            self.settable(metadata)?;
            metadata.admits(real(value)).map_err(Fault::new)?;
        }
        let mut states = self.states;
        for (&reference, &value) in references.iter().zip(values) {
            let Metadata { variable, role, .. } = VARIABLES[reference as usize];
            if let Role::Output(output) = role {
                // A continuous state: nothing else that is put out can be set.
                state(output).into_iter().for_each(|i| states[i] = real(value));
                continue;
            }
            self.values[variable] = real(value);
            if Values::is_of_ground(variable) {
                self.ground = None;
            }
        }
        if states != self.states {
            self.set_states(&states)?;
        }
        self.take_up_values();
        Ok(())
    }

    fn settable(&self, metadata: &Metadata) -> Result<(), Fault> {
        let Metadata { name, causality, variability, role, .. } = metadata;
        if let Role::Output(output) = *role
            && state(output).is_some()
            && self.phase == Phase::ContinuousTimeMode
        {
            return Ok(());
        }
        if !metadata.is_settable() {
            return Err(Fault::new(format!("{name} is {}, which cannot be set", causality.one())));
        }
        if self.phase.is_initialized() && *variability == Variability::Fixed {
            return Err(Fault::new(format!("{name} is a fixed parameter; it can be set until initialization ends")));
        }
        Ok(())
    }

    /// Sets texts, all or none.
    pub fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Result<(), Fault> {
        for &reference in references {
            self.settable(known(reference, Kind::String)?)?;
        }
        for (&reference, &text) in references.iter().zip(texts) {
            if let Role::Text(place) = known(reference, Kind::String)?.role {
                self.values[place] = text.into();
            }
        }
        self.forget_ground();
        Ok(())
    }

    /// The text of a variable.
    pub fn text(&self, reference: u32) -> Result<&str, Fault> {
        match known(reference, Kind::String)?.role {
            Role::Text(text) => Ok(&self.values[text]),
            Role::Input(_) | Role::Parameter(_) | Role::Derived(_) | Role::Output(_) => Ok(""),
        }
    }

    /// Values that were set act from here on: until initialization ends on the whole block, between steps on what is seen. Even
    /// if only rates of inputs were set, these are rounded in another way then, so that nothing is seen again as it was.
    fn take_up_values(&mut self) {
        if self.phase.is_initialized() {
            let time = self.simulation.as_ref().map_or(self.experiment.start, Simulation::piece_time);
            let inputs = self.values.inputs(time, &self.rates);
            self.substep = None;
            self.inputs = self.ground.as_ref().map_or(inputs, |ground| with_ground(&inputs, ground, time).0);
            if let Some(simulation) = &mut self.simulation {
                simulation.change_inputs(&self.inputs);
            }
            self.seen = None;
        } else {
            self.forget();
        }
    }

    /// The value of a variable of this type; Integers and Booleans (0 or 1) as the real numbers that they are.
    pub fn get(&mut self, kind: Kind, reference: u32) -> Result<f64, Fault> {
        let metadata = known(reference, kind)?;
        match metadata.role {
            Role::Parameter(_) | Role::Input(_) | Role::Text(_) => Ok(self.values[metadata.variable]),
            Role::Derived(parameter) => match (derived(parameter), &self.simulation) {
                (DerivedSource::Block(of), Some(simulation)) => Ok(of(simulation.block())),
                (DerivedSource::Block(of), None) => Ok(of(&self.block()?)),
                (DerivedSource::Ground(of), _) => Ok(of.value(&*self.ground()?)),
            },
            Role::Output(output) => {
                if let Some(value) = self.state_output(output) {
                    return Ok(value);
                }
                let (seen, energies) = match self.seen {
                    Some(seen) => seen,
                    None => {
                        let (simulation, inputs) = self.preview()?;
                        let seen = (simulation.observe(&inputs), simulation.energies());
                        *self.seen.insert(seen)
                    }
                };
                let (simulation, _) = self.preview()?;
                Ok(source(output).value(&seen, &energies, simulation))
            }
        }
    }

    fn block(&self) -> Result<Block, Fault> {
        self.values.block().map_err(|error| Fault::new(error.to_string()))
    }

    /// The records, read when they are needed first.
    fn ground(&mut self) -> Result<Arc<Ground>, Fault> {
        let ground = match self.ground.take() {
            Some(ground) => ground,
            None => Arc::new(self.values.ground().map_err(Fault)?),
        };
        Ok(self.ground.insert(ground).clone())
    }

    /// Forgets the records, of which values have changed.
    pub(super) fn forget_ground(&mut self) {
        self.ground = None;
        self.take_up_values();
    }

    /// Forgets what followed from values that have changed.
    fn forget(&mut self) {
        self.simulation = None;
        self.seen = None;
    }

    /// The block in motion and the inputs that act on it; until initialization ends, as the present values would start it.
    fn preview(&mut self) -> Result<(&Simulation, Inputs), Fault> {
        if self.simulation.is_none() {
            let block = self.block()?;
            let ground = self.ground()?;
            let Unit { values, experiment, rates, .. } = self;
            let (inputs, _) = with_ground(&values.inputs(experiment.start, rates), &ground, experiment.start);
            let mut simulation = Simulation::new(
                block,
                values.settings(experiment.tolerance),
                values.pulse(),
                &values.initial(),
                experiment.start,
                &inputs,
            );
            self.inputs = inputs;
            if self.interface == Interface::ModelExchange {
                simulation.begin_exchange();
            }
            self.simulation = Some(simulation);
        }
        let Unit { simulation, inputs, .. } = self;
        let simulation = simulation.as_ref().ok_or_else(|| Fault::new("there is no block yet"))?;
        Ok((simulation, *inputs))
    }
}

/// The inputs and the piece of the records that acts at `time` (s), and the end of that piece (s).
fn with_ground(inputs: &Inputs, ground: &Ground, time: f64) -> (Inputs, f64) {
    if ground.is_empty() {
        return (*inputs, f64::INFINITY);
    }
    let (piece, end) = ground.piece_at(time);
    (piece.plus(inputs), end)
}

/// The variable of this number, if it has this type.
fn known(reference: u32, kind: Kind) -> Result<&'static Metadata, Fault> {
    let Some(metadata) = VARIABLES.get(reference as usize) else {
        let last = VARIABLES.len() - 1;
        return Err(Fault::new(format!("value reference {reference} does not exist; expected 0 to {last}")));
    };
    if metadata.kind.base() != kind {
        let found = metadata.kind;
        return Err(Fault::new(format!(
            "{} (value reference {reference}) is of type {found}, not {kind}",
            metadata.name
        )));
    }
    Ok(metadata)
}

/// The Real output of this number.
fn output(reference: u32, what: &str) -> Result<Output, Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Output(output) => Ok(output),
        Role::Input(_) | Role::Parameter(_) | Role::Text(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::new(format!("{name} is {}; only an output {what}", causality.one())))
        }
    }
}

/// The input of this number.
fn input(reference: u32, what: &str) -> Result<(Input, &'static Metadata), Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Input(input) => Ok((input, metadata)),
        Role::Output(_) | Role::Parameter(_) | Role::Text(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::new(format!("{name} is {}; only an input {what}", causality.one())))
        }
    }
}
