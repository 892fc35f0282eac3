//! An instance of the FMU as a safe state machine: no pointer, no C.

use std::mem::MaybeUninit;

use crate::block::Block;
use crate::excitation::Inputs;
use crate::fmi2::calls::{Call, Phase};
use crate::fmi2::log::{Category, Log};
use crate::fmi2::types::{Status, StatusKind};
use crate::model::values::{PerInput, Values, derived, inputs, source};
use crate::model::variables::{Input, Kind, Metadata, Output, Role, VARIABLES, Variability};
use crate::simulation::outputs::Observation;
use crate::simulation::peaks;
use crate::simulation::{Energies, Progress, Settings, Simulation};

/// A call that was refused or failed: what the importer gets, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The answer.
    pub status: Status,
    /// What was found and what was expected.
    pub message: String,
}

impl Fault {
    /// A refused call: `fmi2Error`, and nothing has changed.
    pub fn error(message: impl Into<String>) -> Fault {
        Fault { status: Status::Error, message: message.into() }
    }
}

/// What a call answers.
pub type Answer = Result<Status, Fault>;

/// What `fmi2SetupExperiment` said.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Experiment {
    tolerance: Option<f64>,
    start: f64,
    stop: Option<f64>,
}

/// All of an instance that a saved state holds.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Core {
    phase: Phase,
    experiment: Experiment,
    values: Values,
    /// Rates of the inputs, and whether they were set since the last step: otherwise the next step holds the inputs.
    rates: PerInput,
    rates_are_new: bool,
    /// The block in motion; before initialization ends, what it would start as, if that is known.
    simulation: Option<Simulation>,
    /// The inputs that act at the present time.
    inputs: Inputs,
}

/// An instance: what a saved state holds, and where its messages go.
#[derive(Debug)]
pub struct Instance {
    /// Messages.
    pub log: Log,
    core: Core,
    /// What is seen at the present time, until something changes it.
    seen: Option<(Observation<f64>, Energies)>,
}

/// By how much a master's clock may be off, relative to the greater of step and time.
const CLOCK_ROUNDING: f64 = 1e-9;

impl Core {
    fn new() -> Core {
        Core {
            phase: Phase::Instantiated,
            experiment: Experiment::default(),
            values: Values::default(),
            rates: PerInput::default(),
            rates_are_new: false,
            simulation: None,
            inputs: Inputs::default(),
        }
    }

    /// Whether this can be the state of an instance of this FMU: what a file says of itself is not enough.
    pub fn is_valid(&self) -> bool {
        let moving = !matches!(self.phase, Phase::Instantiated | Phase::InitializationMode);
        let times = [self.experiment.start, self.inputs.time];
        self.values.are_valid()
            && self.phase != Phase::Fatal
            && times.iter().chain(&self.rates).all(|x| x.is_finite())
            && match &self.simulation {
                Some(simulation) => simulation.is_valid() && self.values.block().as_ref() == Ok(simulation.block()),
                None => !moving,
            }
    }
}

impl Instance {
    /// A new instance, all values at their starts.
    pub fn new(log: Log) -> Instance {
        Instance { log, core: Core::new(), seen: None }
    }

    /// Refuses a call that the present state does not allow.
    pub fn admit(&self, call: Call) -> Result<(), Fault> {
        call.admitted_in(self.core.phase).map_err(Fault::error)
    }

    /// Whether a panic was caught in an earlier call.
    pub fn is_fatal(&self) -> bool {
        self.core.phase == Phase::Fatal
    }

    /// A panic was caught: nothing can be trusted any more.
    pub fn fail_fatally(&mut self) {
        self.core.phase = Phase::Fatal;
    }

    /// `fmi2SetDebugLogging`.
    pub fn set_debug_logging(&mut self, logging: bool, names: &[&str]) -> Answer {
        let categories = names
            .iter()
            .map(|name| {
                Category::ALL.into_iter().find(|c| c.name().to_bytes() == name.as_bytes()).ok_or_else(|| {
                    let known = Category::ALL.map(|c| c.name().to_string_lossy()).join(", ");
                    Fault::error(format!("log category {name:?} does not exist; there are {known}"))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        self.log.choose(logging, (!names.is_empty()).then_some(&categories));
        Ok(Status::Ok)
    }

    /// `fmi2SetupExperiment`.
    pub fn setup_experiment(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Answer {
        if !start.is_finite() {
            return Err(Fault::error(format!("startTime = {start}; expected a finite time")));
        }
        if let Some(stop) = stop
            && !(stop.is_finite() && stop > start)
        {
            return Err(Fault::error(format!("stopTime = {stop}; expected a finite time after startTime = {start}")));
        }
        if let Some(tolerance) = tolerance
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Fault::error(format!("tolerance = {tolerance}; expected a finite number > 0")));
        }
        self.core.experiment = Experiment { tolerance, start, stop };
        self.forget();
        match tolerance {
            Some(tolerance) if !(Settings::TOLERANCES[0]..=Settings::TOLERANCES[1]).contains(&tolerance) => {
                let [least, most] = Settings::TOLERANCES;
                let used = tolerance.clamp(least, most);
                self.log.status(Status::Warning, &format!("tolerance = {tolerance:e} is taken as {used:e}"));
                Ok(Status::Warning)
            }
            _ => Ok(Status::Ok),
        }
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization_mode(&mut self) -> Answer {
        self.core.phase = Phase::InitializationMode;
        self.forget();
        Ok(Status::Ok)
    }

    /// `fmi2ExitInitializationMode`: the values become a block, or the call is refused and they can be corrected.
    pub fn exit_initialization_mode(&mut self) -> Answer {
        self.preview()?;
        let unread: Vec<String> =
            self.core.values.unread().map(|(name, needed)| format!("{name} needs {needed}")).collect();
        self.core.phase = Phase::StepComplete;
        if unread.is_empty() {
            return Ok(Status::Ok);
        }
        self.log.status(
            Status::Warning,
            &format!("set, but not read with the other parameters as they are: {}", unread.join(", ")),
        );
        Ok(Status::Warning)
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Answer {
        self.core.phase = Phase::Terminated;
        Ok(Status::Ok)
    }

    /// `fmi2Reset`: as after instantiation.
    pub fn reset(&mut self) -> Answer {
        self.core = Core::new();
        self.seen = None;
        Ok(Status::Ok)
    }

    /// `fmi2DoStep`. Allocates no memory unless it fails.
    pub fn do_step(&mut self, time: f64, step: f64) -> Answer {
        let Core { phase, experiment, values, rates, rates_are_new, simulation, inputs: acting } = &mut self.core;
        let Some(simulation) = simulation else { return Err(Fault::error("there is no block yet")) };
        let present = simulation.time();
        if !(step.is_finite() && step > 0.0) {
            return Err(Fault::error(format!("communicationStepSize = {step} at t = {present} s; expected > 0 s")));
        }
        let slack = CLOCK_ROUNDING * step.max(present.abs());
        // A time that is no number is off by no number.
        if !time.is_finite() || (time - present).abs() > slack {
            return Err(Fault::error(format!(
                "currentCommunicationPoint = {time:?} s; the FMU is at t = {present:?} s and takes at most {slack:e} s off"
            )));
        }
        let until = time + step;
        if let Some(stop) = experiment.stop
            && until > stop + CLOCK_ROUNDING * step.max(stop.abs())
        {
            return Err(Fault::error(format!("a step to t = {until:?} s passes stopTime = {stop:?} s")));
        }
        if until == time {
            return Err(Fault::error(format!("communicationStepSize = {step:e} s is lost in t = {time:?} s")));
        }
        if !*rates_are_new {
            *rates = PerInput::default();
        }
        let inputs = values.inputs(time, rates);
        simulation.set_time(time);
        let log = &self.log;
        let progress = simulation.advance(until, &inputs, &mut |event| {
            log.tell(Status::Ok, Category::Events, format_args!("{event}"));
        });
        self.seen = None;
        *acting = inputs;
        let progress = progress.map_err(|error| {
            *phase = Phase::Error;
            Fault::error(error.to_string())
        })?;
        *rates_are_new = false;
        for (input, rate) in Input::ALL.into_iter().zip(rates) {
            values[input.variable()] += *rate * (simulation.time() - time);
        }
        log.tell(
            Status::Ok,
            Category::Steps,
            format_args!("step from t = {time:?} s to t = {:?} s", simulation.time()),
        );
        match progress {
            Progress::Reached => Ok(Status::Ok),
            Progress::Ended(ending, at) => {
                *phase = Phase::StepFailed;
                log.tell(
                    Status::Discard,
                    Category::Warning,
                    format_args!("{ending} at t = {at:?} s ends the run; the outputs are those of that time"),
                );
                Ok(Status::Discard)
            }
        }
    }

    /// `fmi2Get…Status` of a Real.
    pub fn real_status(&self, kind: StatusKind) -> Result<f64, Fault> {
        match kind {
            StatusKind::LastSuccessfulTime => Ok(self.core.simulation.as_ref().map_or(0.0, Simulation::time)),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::Terminated => {
                Err(Fault::error(format!("{kind:?} is no Real; fmi2LastSuccessfulTime is")))
            }
        }
    }

    /// `fmi2Get…Status` of a Boolean.
    pub fn boolean_status(&self, kind: StatusKind) -> Result<bool, Fault> {
        match kind {
            StatusKind::Terminated => Ok(self.core.phase == Phase::StepFailed),
            StatusKind::DoStepStatus | StatusKind::PendingStatus | StatusKind::LastSuccessfulTime => {
                Err(Fault::error(format!("{kind:?} is no Boolean; fmi2Terminated is")))
            }
        }
    }

    /// `fmi2GetStatus`: steps are synchronous, so this is what the last step answered.
    pub fn step_status(&self, kind: StatusKind) -> Result<Status, Fault> {
        match (kind, self.core.phase) {
            (StatusKind::DoStepStatus, Phase::StepFailed) => Ok(Status::Discard),
            (StatusKind::DoStepStatus, _) => Ok(Status::Ok),
            (StatusKind::PendingStatus | StatusKind::LastSuccessfulTime | StatusKind::Terminated, _) => {
                Err(Fault::error(format!("{kind:?} is no fmi2Status; fmi2DoStepStatus is")))
            }
        }
    }

    /// Sets values of one type, all or none. Values that repeat the present one of a fixed parameter are refused, too.
    pub fn set<V: Copy>(&mut self, kind: Kind, references: &[u32], values: &[V], real: impl Fn(V) -> f64) -> Answer {
        for (&reference, &value) in references.iter().zip(values) {
            let metadata = known(reference, kind)?;
            self.settable(metadata)?;
            metadata.admits(real(value)).map_err(Fault::error)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.core.values[VARIABLES[reference as usize].variable] = real(value);
        }
        self.take_up_values();
        Ok(Status::Ok)
    }

    fn settable(&self, metadata: &Metadata) -> Result<(), Fault> {
        let Metadata { name, causality, variability, .. } = metadata;
        if !metadata.is_settable() {
            return Err(Fault::error(format!("{name} is a {causality}, which cannot be set")));
        }
        let initialized = !matches!(self.core.phase, Phase::Instantiated | Phase::InitializationMode);
        if initialized && *variability == Variability::Fixed {
            return Err(Fault::error(format!("{name} is a fixed parameter; it can be set until initialization ends")));
        }
        Ok(())
    }

    /// Values that were set act from here on: until initialization ends on the whole block, between steps on what is seen. Even
    /// if only rates of inputs were set, these are rounded in another way then, so that nothing is seen again as it was.
    fn take_up_values(&mut self) {
        match self.core.phase {
            Phase::Instantiated | Phase::InitializationMode => self.forget(),
            Phase::StepComplete | Phase::StepFailed | Phase::Terminated | Phase::Error | Phase::Fatal => {
                let time = self.core.simulation.as_ref().map_or(self.core.experiment.start, Simulation::time);
                self.core.inputs = self.core.values.inputs(time, &self.core.rates);
                self.seen = None;
            }
        }
    }

    /// Reads values of one type.
    pub fn get<V>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &mut [MaybeUninit<V>],
        convert: impl Fn(f64) -> V,
    ) -> Answer {
        for &reference in references {
            known(reference, kind)?;
        }
        for (&reference, value) in references.iter().zip(values) {
            value.write(convert(self.value(&VARIABLES[reference as usize])?));
        }
        Ok(Status::Ok)
    }

    fn value(&mut self, metadata: &Metadata) -> Result<f64, Fault> {
        match metadata.role {
            Role::Parameter(_) | Role::Input(_) => Ok(self.core.values[metadata.variable]),
            Role::Derived(parameter) => {
                let block = match &self.core.simulation {
                    Some(simulation) => *simulation.block(),
                    None => self.block()?,
                };
                Ok(derived(parameter, &block))
            }
            Role::Output(output) => {
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
        self.core.values.block().map_err(|error| Fault::error(error.to_string()))
    }

    /// Forgets what followed from values that have changed.
    fn forget(&mut self) {
        self.core.simulation = None;
        self.seen = None;
    }

    /// The block in motion and the inputs that act on it; until initialization ends, as the present values would start it.
    fn preview(&mut self) -> Result<(&Simulation, Inputs), Fault> {
        if self.core.simulation.is_none() {
            let block = self.block()?;
            let Core { values, experiment, rates, .. } = &self.core;
            let inputs = values.inputs(experiment.start, rates);
            let simulation = Simulation::new(
                block,
                values.settings(experiment.tolerance),
                values.pulse(),
                &values.initial(),
                experiment.start,
                &inputs,
            );
            self.core.inputs = inputs;
            self.core.simulation = Some(simulation);
        }
        let Core { simulation, inputs, .. } = &self.core;
        let simulation = simulation.as_ref().ok_or_else(|| Fault::error("there is no block yet"))?;
        Ok((simulation, *inputs))
    }

    /// `fmi2SetRealInputDerivatives`, order 1 only.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Answer {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            let (_, metadata) = input(reference, "has set derivatives")?;
            if order != 1 {
                return Err(Fault::error(format!("derivative of {} of order {order}; expected 1", metadata.name)));
            }
            if !value.is_finite() {
                return Err(Fault::error(format!(
                    "derivative of {} = {value}; expected a finite number",
                    metadata.name
                )));
            }
        }
        if !self.core.rates_are_new {
            self.core.rates = PerInput::default();
            self.core.rates_are_new = true;
        }
        for (&reference, &value) in references.iter().zip(values) {
            let (input, _) = input(reference, "has set derivatives")?;
            self.core.rates[input as usize] = value;
        }
        self.take_up_values();
        Ok(Status::Ok)
    }

    /// `fmi2GetRealOutputDerivatives`, order 1 only: exact, from the equations of motion.
    pub fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [MaybeUninit<f64>],
    ) -> Answer {
        for (&reference, &order) in references.iter().zip(orders) {
            let (_, metadata) = output(reference, "has derivatives in time")?;
            if order != 1 {
                return Err(Fault::error(format!("derivative of {} of order {order}; expected 1", metadata.name)));
            }
        }
        let (simulation, inputs) = self.preview()?;
        let seen = simulation.observe_rates(&inputs);
        let (rates, channels) = (seen.map(|x| x.eps), peaks::channels(&seen));
        let (energy_rates, peaks) = (simulation.energy_rates(&inputs), simulation.peaks());
        for (&reference, value) in references.iter().zip(values) {
            let (output, _) = output(reference, "has derivatives in time")?;
            value.write(source(output).rate(&rates, &energy_rates, &channels, &peaks));
        }
        Ok(Status::Ok)
    }

    /// `fmi2GetDirectionalDerivative`: exact derivatives of Real outputs with respect to inputs at the present time.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        sensitivities: &mut [MaybeUninit<f64>],
    ) -> Answer {
        for &reference in unknowns {
            output(reference, "can be differentiated")?;
        }
        let mut components = PerInput::default();
        for (&reference, &component) in knowns.iter().zip(direction) {
            let (input, metadata) = input(reference, "is a direction")?;
            if !component.is_finite() {
                return Err(Fault::error(format!(
                    "direction {component} of {}; expected a finite number",
                    metadata.name
                )));
            }
            components[input as usize] += component;
        }
        let along = inputs(0.0, components, &PerInput::default());
        let (simulation, at) = self.preview()?;
        let derivative = simulation.observe_direction(&at, &along).map(|x| x.eps);
        for (&reference, value) in unknowns.iter().zip(sensitivities) {
            let (output, _) = output(reference, "can be differentiated")?;
            value.write(source(output).sensitivity(&derivative));
        }
        Ok(Status::Ok)
    }

    /// `fmi2GetFMUstate`.
    pub fn save(&self) -> Core {
        self.core.clone()
    }

    /// `fmi2SetFMUstate`: from here on as when the state was saved.
    pub fn restore(&mut self, saved: &Core) -> Answer {
        self.core.clone_from(saved);
        self.seen = None;
        Ok(Status::Ok)
    }
}

/// The variable of this number, if it has this type.
fn known(reference: u32, kind: Kind) -> Result<&'static Metadata, Fault> {
    let Some(metadata) = VARIABLES.get(reference as usize) else {
        let last = VARIABLES.len() - 1;
        return Err(Fault::error(format!("value reference {reference} does not exist; expected 0 to {last}")));
    };
    if metadata.kind.base() != kind {
        let found = metadata.kind;
        return Err(Fault::error(format!(
            "{} (value reference {reference}) is of type {found}, not {kind}",
            metadata.name
        )));
    }
    Ok(metadata)
}

/// The Real output of this number.
fn output(reference: u32, what: &str) -> Result<(Output, &'static Metadata), Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Output(output) => Ok((output, metadata)),
        Role::Input(_) | Role::Parameter(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::error(format!("{name} is a {causality}; only an output {what}")))
        }
    }
}

/// The input of this number.
fn input(reference: u32, what: &str) -> Result<(Input, &'static Metadata), Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Input(input) => Ok((input, metadata)),
        Role::Output(_) | Role::Parameter(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::error(format!("{name} is a {causality}; only an input {what}")))
        }
    }
}
