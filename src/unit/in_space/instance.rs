//! Calls of an importer, of any version of FMI → a block in space in motion.

use std::cell::OnceCell;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::simulation::Progress;
use crate::space::energies::SpaceEnergies;
use crate::space::outputs::{FootObservation, SpaceObservation};
use crate::space::{SpaceBody, SpaceEvent, SpaceGround, SpaceInputs, SpaceRun, SpaceState};
use crate::unit::attributes::{Causality, Kind, Known, Variability, find};
use crate::unit::fault::Fault;
use crate::unit::fmu::{Fmu, Reached};
use crate::unit::in_space::outputs::{SpaceDerived, SpaceSource, derived, source};
use crate::unit::in_space::values::SpaceValues;
use crate::unit::in_space::variables::{
    FMI3_VARIABLES, Fmi3Variable, GUID, Input, Metadata, Role, TOKEN, VARIABLES, fmi3_metadata,
};
use crate::unit::life_cycle::{Interface, LifeCycle, Phase};

/// An instance as a safe state machine, without pointers and messages. A copy of it is a saved state.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "SavedUnit", try_from = "SavedUnit")]
pub struct SpaceUnit {
    life: LifeCycle,
    values: SpaceValues,
    /// The importer's inputs, linear in time.
    inputs: SpaceInputs,
    /// Whether rates were set since the last step. Otherwise the next step holds the inputs constant.
    rates_are_new: bool,
    /// The inputs at the end of the present substep, if known in advance.
    at_end: Option<SpaceInputs>,
    /// The FMU's own records, once they are read. Saved states share them; serialized states contain them.
    ground: Option<Arc<SpaceGround>>,
    /// The block in motion; before initialization ends, a preview from the present values.
    run: Option<SpaceRun>,
    observed: Cache,
}

/// The content of a serialized state: the setup of a run follows from the values.
#[derive(Serialize, Deserialize)]
struct SavedUnit {
    life: LifeCycle,
    values: SpaceValues,
    inputs: SpaceInputs,
    rates_are_new: bool,
    at_end: Option<SpaceInputs>,
    ground: Option<Arc<SpaceGround>>,
    state: Option<SpaceState>,
}

impl From<SpaceUnit> for SavedUnit {
    fn from(unit: SpaceUnit) -> SavedUnit {
        let SpaceUnit { life, values, inputs, rates_are_new, at_end, ground, run, observed: _ } = unit;
        let state = run.map(|run| run.state().clone());
        SavedUnit { life, values, inputs, rates_are_new, at_end, ground, state }
    }
}

impl TryFrom<SavedUnit> for SpaceUnit {
    type Error = String;

    fn try_from(saved: SavedUnit) -> Result<SpaceUnit, String> {
        let SavedUnit { life, values, inputs, rates_are_new, at_end, ground, state } = saved;
        if !values.are_valid() {
            return Err("the values are not within their limits".into());
        }
        let setup = |_| values.setup(life.experiment.tolerance);
        let run = state.map(|state| SpaceRun::resume(setup(())?, state)).transpose()?;
        Ok(SpaceUnit { life, values, inputs, rates_are_new, at_end, ground, run, observed: Cache::default() })
    }
}

/// Observation and energies of the present time, computed when an output needs them.
#[derive(Clone, Debug, Default)]
struct Cache {
    observation: OnceCell<SpaceObservation>,
    energies: OnceCell<SpaceEnergies>,
    /// Whether inputs changed or a step was taken since. These leave the memory to the next reader.
    is_stale: bool,
}

impl Cache {
    /// Drops what is stale.
    fn refresh(&mut self) {
        if self.is_stale {
            *self = Cache::default();
        }
    }
}

fn no_block() -> Fault {
    Fault::new("found no block; expected the call after initialization")
}

/// Returns the variable with this value reference if only FMI 3.0 has it.
fn fmi3_variable(reference: u32) -> Option<Fmi3Variable> {
    let index = (reference as usize).checked_sub(VARIABLES.len() + 1)?;
    FMI3_VARIABLES.get(index).map(|metadata| metadata.variable)
}

/// Returns the input with this value reference.
fn input(reference: u32, wanted: &str) -> Result<Input, Fault> {
    let Metadata { name, causality, role, .. } = find(&VARIABLES, reference, Kind::Real)?;
    match role {
        Role::Input(input) => Ok(*input),
        Role::Parameter(_) | Role::Text(_) | Role::Derived(_) | Role::Output(_) => {
            Err(Fault::new(format!("{name} is {}; expected {wanted}", causality.one())))
        }
    }
}

/// Refuses what the description does not declare.
fn not_declared(what: &str) -> Fault {
    Fault::new(format!("{what} are not offered by this FMU; expected a call that its description declares"))
}

impl SpaceUnit {
    /// Drops the preview after a change of values.
    fn forget(&mut self) {
        self.run = None;
        self.observed = Cache::default();
    }

    /// Applies changed values: before initialization ends to the whole block, later to the observation.
    fn take_up_values(&mut self) {
        if self.life.phase.is_initialized() {
            self.observed.is_stale = true;
        } else {
            self.forget();
        }
    }

    /// Makes the present time the reference of the inputs, before they change.
    fn begin_inputs(&mut self) {
        self.inputs = self.inputs.moved_to(self.time());
        if self.at_end.take().is_some() {
            self.inputs = self.inputs.held();
        }
    }

    fn ground(&mut self) -> Result<Arc<SpaceGround>, Fault> {
        let ground = match self.ground.take() {
            Some(ground) => ground,
            None => Arc::new(self.values.ground().map_err(Fault)?),
        };
        Ok(self.ground.insert(ground).clone())
    }

    /// Makes the block in motion, unless it is there.
    fn preview(&mut self) -> Result<&SpaceRun, Fault> {
        if self.run.is_none() {
            self.ground()?;
            let setup = self.values.setup(self.life.experiment.tolerance).map_err(Fault)?;
            let run = SpaceRun::new(setup, &self.values.initial(), self.life.experiment.start);
            return Ok(self.run.insert(run));
        }
        self.run.as_ref().ok_or_else(no_block)
    }

    /// Returns the inputs and the FMU's own records at the present time.
    fn acting(&self) -> SpaceInputs {
        let inputs = self.inputs.moved_to(self.time());
        with_ground(&inputs, self.ground.as_deref(), self.time()).0
    }

    /// Returns the observation of the present time. A block that is held shows no motion and no forces.
    fn observation(&mut self) -> Result<&SpaceObservation, Fault> {
        self.preview()?;
        self.observed.refresh();
        let acting = self.acting();
        let run = self.run.as_ref().ok_or_else(no_block)?;
        Ok(self.observed.observation.get_or_init(|| {
            let observed = run.observe(&acting);
            if !run.is_frozen() {
                return observed;
            }
            let held =
                |foot: &FootObservation| FootObservation { slip: foot.slip, uplift: foot.uplift, ..Default::default() };
            SpaceObservation {
                time: observed.time,
                attitude: observed.attitude,
                displacement: observed.displacement,
                drift: observed.drift,
                feet: observed.feet.iter().map(held).collect(),
                ..SpaceObservation::default()
            }
        }))
    }

    fn output(&mut self, source: &SpaceSource) -> Result<f64, Fault> {
        match source {
            SpaceSource::Observed(of) => Ok(of(self.observation()?)),
            SpaceSource::Foot(number, of) => {
                let is_rectangle = self.values.is_rectangle();
                Ok(self.observation()?.feet.get(*number).filter(|_| is_rectangle).map_or(0.0, of))
            }
            SpaceSource::Energy(of) => {
                self.preview()?;
                self.observed.refresh();
                let run = self.run.as_ref().ok_or_else(no_block)?;
                Ok(of(self.observed.energies.get_or_init(|| run.energies())))
            }
            SpaceSource::Run(of) => Ok(of(self.preview()?)),
        }
    }

    fn calculated(&mut self, source: &SpaceDerived) -> Result<f64, Fault> {
        match (source, &self.run) {
            (SpaceDerived::Body(of), Some(run)) => Ok(of(run.body())),
            (SpaceDerived::Body(of), None) => {
                let body: SpaceBody = self.values.body().map_err(Fault)?;
                Ok(of(&body))
            }
            (SpaceDerived::Peak(_) | SpaceDerived::End, _) => Ok(source.of_ground(&*self.ground()?)),
        }
    }

    /// Advances to `until` (s), at most to the first event later than `after` (s). Returns `None` if that stops it.
    fn advance_by_intervals(
        &mut self,
        until: f64,
        after: f64,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<Option<Progress>, Fault> {
        let SpaceUnit { life, inputs, ground, run, observed, .. } = self;
        let run = run.as_mut().ok_or_else(no_block)?;
        observed.is_stale = true;
        loop {
            let (acting, end) = with_ground(inputs, ground.as_deref(), run.time());
            let end = end.min(until);
            match run.advance_to_event(end, after, &acting, observer) {
                Ok(Some(Progress::Reached)) if end < until => {}
                Ok(progress) => {
                    if let Some(Progress::Ended(..)) = progress {
                        life.phase = Phase::StepFailed;
                    }
                    return Ok(progress);
                }
                Err(error) => {
                    life.phase = Phase::Error;
                    return Err(Fault::new(error.to_string()));
                }
            }
        }
    }

    /// Begins a communication step and returns its end (s).
    fn begin_step(&mut self, time: f64, step: f64) -> Result<f64, Fault> {
        let run = self.run.as_mut().ok_or_else(no_block)?;
        let until = self.life.begin_step(run.time(), time, step)?;
        run.set_time(time);
        Ok(until)
    }
}

/// Returns the inputs plus the records' lines from `time` (s) on, and their end (s).
fn with_ground(inputs: &SpaceInputs, ground: Option<&SpaceGround>, time: f64) -> (SpaceInputs, f64) {
    match ground.filter(|ground| ground.end().is_some()) {
        None => (*inputs, f64::INFINITY),
        Some(ground) => {
            let (motion, end) = ground.inputs_from(time);
            (motion.plus(inputs), end)
        }
    }
}

impl Fmu for SpaceUnit {
    type Event = SpaceEvent;
    type Direction = ();

    const GUID: &'static str = GUID;
    const TOKEN: &'static str = TOKEN;
    const CONTENT_VERSION: u32 = 1;
    const VARIABLES: usize = VARIABLES.len() + FMI3_VARIABLES.len();
    const INTERFACES: &'static [Interface] = &[Interface::CoSimulation];

    fn new(interface: Interface) -> SpaceUnit {
        SpaceUnit {
            life: LifeCycle::new(interface),
            values: SpaceValues::default(),
            inputs: SpaceInputs::default(),
            rates_are_new: false,
            at_end: None,
            ground: None,
            run: None,
            observed: Cache::default(),
        }
    }

    fn life(&self) -> &LifeCycle {
        &self.life
    }

    fn life_mut(&mut self) -> &mut LifeCycle {
        &mut self.life
    }

    fn is_valid(&self) -> bool {
        self.life.is_valid()
            && [&self.inputs].into_iter().chain(&self.at_end).all(SpaceInputs::is_finite)
            && self.ground.as_ref().is_none_or(|ground| ground.records.iter().flatten().all(|record| record.is_valid()))
            && if self.run.is_some() { self.ground.is_some() } else { !self.life.phase.is_initialized() }
    }

    fn time(&self) -> f64 {
        self.run.as_ref().map_or(self.life.experiment.start, SpaceRun::time)
    }

    fn known(reference: u32) -> Option<Known> {
        if let Some(metadata) = Metadata::of(reference) {
            return Some(metadata.known());
        }
        let variable = fmi3_variable(reference)?;
        let known = Known::of_fmi3(fmi3_metadata(variable).name, variable == Fmi3Variable::FootCount);
        Some(match variable {
            Fmi3Variable::N | Fmi3Variable::Uplift | Fmi3Variable::Slip => {
                Known { causality: Causality::Output, variability: Variability::Continuous, ..known }
            }
            Fmi3Variable::Time
            | Fmi3Variable::IntermediateInterval
            | Fmi3Variable::FootCount
            | Fmi3Variable::FootX
            | Fmi3Variable::FootY
            | Fmi3Variable::FootGap => known,
        })
    }

    fn check(references: &[u32], kind: Kind) -> Result<(), Fault> {
        references.iter().try_for_each(|&reference| find(&VARIABLES, reference, kind).map(|_| ()))
    }

    fn admits(reference: u32, value: f64) -> Result<(), Fault> {
        Metadata::of(reference).map_or(Ok(()), |metadata| metadata.admits(value)).map_err(Fault)
    }

    fn get(&mut self, kind: Kind, reference: u32) -> Result<f64, Fault> {
        let metadata = find(&VARIABLES, reference, kind)?;
        match metadata.role {
            Role::Input(input) => Ok(input.of(&mut self.inputs.moved_to(self.time())).value),
            Role::Parameter(_) | Role::Text(_) => Ok(self.values[metadata.variable]),
            Role::Derived(parameter) => self.calculated(&derived(parameter)),
            Role::Output(output) => self.output(&source(output)),
        }
    }

    fn set<V: Copy>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &[V],
        real: impl Fn(V) -> f64,
    ) -> Result<(), Fault> {
        for (&reference, &value) in references.iter().zip(values) {
            let metadata = find(&VARIABLES, reference, kind)?;
            metadata.settable(self.life.phase)?;
            metadata.admits(real(value)).map_err(Fault::new)?;
        }
        self.begin_inputs();
        for (&reference, &value) in references.iter().zip(values) {
            let (Some(metadata), value) = (Metadata::of(reference), real(value)) else { continue };
            match metadata.role {
                Role::Input(input) => input.of(&mut self.inputs).value = value,
                Role::Parameter(_) | Role::Text(_) | Role::Derived(_) | Role::Output(_) => {
                    self.values[metadata.variable] = value;
                    if SpaceValues::is_of_ground(metadata.variable) {
                        self.ground = None;
                    }
                }
            }
        }
        self.take_up_values();
        Ok(())
    }

    fn text(&self, reference: u32) -> Result<&str, Fault> {
        match find(&VARIABLES, reference, Kind::String)?.role {
            Role::Text(text) => Ok(&self.values[text]),
            Role::Input(_) | Role::Parameter(_) | Role::Derived(_) | Role::Output(_) => Ok(""),
        }
    }

    fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Result<(), Fault> {
        for &reference in references {
            find(&VARIABLES, reference, Kind::String)?.settable(self.life.phase)?;
        }
        for (&reference, &text) in references.iter().zip(texts) {
            if let Role::Text(variable) = find(&VARIABLES, reference, Kind::String)?.role {
                self.values[variable] = text.into();
            }
        }
        self.ground = None;
        self.take_up_values();
        Ok(())
    }

    fn size(&self, reference: u32) -> usize {
        match fmi3_variable(reference) {
            Some(
                Fmi3Variable::FootX
                | Fmi3Variable::FootY
                | Fmi3Variable::FootGap
                | Fmi3Variable::N
                | Fmi3Variable::Uplift
                | Fmi3Variable::Slip,
            ) => self.values.foot_count(),
            Some(Fmi3Variable::Time | Fmi3Variable::IntermediateInterval | Fmi3Variable::FootCount) | None => 1,
        }
    }

    fn read_fmi3_variable(&mut self, reference: u32, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        let Some(variable) = fmi3_variable(reference) else { return Ok(()) };
        let count = self.values.foot_count();
        let mut feet = |of: fn(&FootObservation) -> f64| {
            let feet = &self.observation()?.feet;
            (0..count).for_each(|i| give(feet.get(i).map_or(0.0, of)));
            Ok(())
        };
        match variable {
            Fmi3Variable::N => feet(|foot| foot.normal),
            Fmi3Variable::Uplift => feet(|foot| foot.uplift),
            Fmi3Variable::Slip => feet(|foot| foot.slip),
            Fmi3Variable::Time => {
                give(self.time());
                Ok(())
            }
            Fmi3Variable::FootCount
            | Fmi3Variable::FootX
            | Fmi3Variable::FootY
            | Fmi3Variable::FootGap
            | Fmi3Variable::IntermediateInterval => {
                self.values.of_fmi3(variable).iter().copied().for_each(give);
                Ok(())
            }
        }
    }

    fn set_fmi3_variable(&mut self, reference: u32, values: &[f64]) -> Result<(), Fault> {
        let Some(variable) = fmi3_variable(reference) else { return Ok(()) };
        let metadata = fmi3_metadata(variable);
        let name = metadata.name;
        if self.life.phase.is_initialized() {
            return Err(Fault::new(format!(
                "{name} is a fixed parameter; expected it to be set before initialization ends"
            )));
        }
        values.iter().try_for_each(|&value| metadata.admits(value)).map_err(Fault::new)?;
        let Some(places) = self.values.of_fmi3_mut(variable) else {
            return Err(Fault::new(format!("{name} is set; expected a real parameter")));
        };
        places.copy_from_slice(values);
        self.forget();
        Ok(())
    }

    fn array_size(&self, _: u32) -> u64 {
        self.values.foot_count() as u64
    }

    fn resize(&mut self, _: u32, size: u64) -> Result<(), Fault> {
        fmi3_metadata(Fmi3Variable::FootCount).admits(size as f64).map_err(Fault::new)?;
        self.values.resize(size as usize);
        self.forget();
        Ok(())
    }

    fn is_time(reference: u32) -> bool {
        fmi3_variable(reference) == Some(Fmi3Variable::Time)
    }

    fn interval(&self) -> f64 {
        self.values.interval
    }

    fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault> {
        let used = self.life.plan(tolerance, start, stop)?;
        self.inputs.time = start;
        self.forget();
        Ok(used)
    }

    fn enter_initialization_mode(&mut self) {
        self.life.phase = Phase::InitializationMode;
        self.forget();
    }

    fn exit_initialization_mode(&mut self) -> Result<Vec<(&'static str, &'static str)>, Fault> {
        self.preview()?;
        self.life.phase = Phase::StepComplete;
        Ok(self.values.unread())
    }

    fn unset_sizes(&self) -> Vec<(&'static str, f64)> {
        self.values.unset_sizes()
    }

    fn advance(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&SpaceEvent)) -> Result<Progress, Fault> {
        let present = self.time();
        let until = self.begin_step(time, step)?;
        self.inputs = SpaceInputs { time, ..self.inputs.moved_to(present) };
        if !self.rates_are_new {
            self.inputs = self.inputs.held();
        }
        let progress = self.advance_by_intervals(until, f64::INFINITY, observer)?;
        self.rates_are_new = false;
        Ok(progress.unwrap_or(Progress::Reached))
    }

    fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Fault> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            input(reference, "an input with derivatives")?;
            let name = find(&VARIABLES, reference, Kind::Real)?.name;
            if order != 1 {
                return Err(Fault::new(format!("derivative of {name} of order {order}; expected 1")));
            }
            if !value.is_finite() {
                return Err(Fault::new(format!("derivative of {name} = {value}; expected a finite number")));
            }
        }
        self.begin_inputs();
        if !std::mem::replace(&mut self.rates_are_new, true) {
            self.inputs = self.inputs.held();
        }
        for (&reference, &value) in references.iter().zip(values) {
            input(reference, "an input with derivatives")?.of(&mut self.inputs).rate = value;
        }
        self.take_up_values();
        Ok(())
    }

    fn output_derivatives(&mut self, _: &[u32], _: &[i32]) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Err::<std::iter::Empty<_>, _>(not_declared("derivatives of outputs in time"))
    }

    fn has_ended(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.state().ending.is_some() && !run.is_frozen())
    }

    fn begin_substeps(&mut self, time: f64, step: f64, _: &mut dyn FnMut(&SpaceEvent)) -> Result<f64, Fault> {
        self.begin_step(time, step)
    }

    fn needs_substep(&self) -> bool {
        self.at_end.is_none()
    }

    fn rests(&self) -> bool {
        false
    }

    fn begin_setting_ahead(&mut self, end: f64) {
        self.at_end = Some(SpaceInputs { time: end, ..self.inputs.moved_to(self.time()) });
        self.life.phase = Phase::SettingAhead;
    }

    fn set_ahead(&mut self, reference: u32, value: f64) {
        if let (Some(at_end), Ok(input)) = (&mut self.at_end, input(reference, "an input")) {
            input.of(at_end).value = value;
        }
    }

    fn end_setting_ahead(&mut self) {
        self.life.phase = Phase::StepComplete;
        if let Some(at_end) = &self.at_end {
            self.inputs = self.inputs.moved_to(self.time()).line_to(at_end);
        }
    }

    fn do_substep(
        &mut self,
        until: f64,
        after: Option<f64>,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<Reached, Fault> {
        let end = self.at_end.map_or(until, |at_end| at_end.time.min(until));
        let progress = self.advance_by_intervals(end, after.unwrap_or(f64::INFINITY), observer)?;
        let time = self.time();
        if let Some(at_end) = self.at_end.take_if(|at_end| time >= at_end.time) {
            self.inputs = at_end;
        }
        Ok(match progress {
            Some(Progress::Ended(ending, time)) => Reached::Ended(ending, time),
            Some(Progress::Reached) => Reached::End,
            None => Reached::Event,
        })
    }

    /// All states are continuous at an event, which has happened when the step is left.
    fn apply_pending_event(&mut self, _: &mut dyn FnMut(&SpaceEvent)) -> Result<(), Fault> {
        Ok(())
    }

    fn enter_event_mode(&mut self) {
        self.life.phase = Phase::EventMode;
    }

    fn directional_derivative(
        &mut self,
        _: &[u32],
        _: &[u32],
        _: &[f64],
        _: f64,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Err::<std::iter::Empty<_>, _>(not_declared("directional derivatives"))
    }

    fn add_to_direction((): &mut (), _: u32, _: usize, _: &[f64]) -> Result<(), Fault> {
        Err(not_declared("directional derivatives"))
    }

    fn initial_directional_derivative(
        &mut self,
        _: &[u32],
        (): &(),
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Err::<std::iter::Empty<_>, _>(not_declared("directional derivatives"))
    }
}
