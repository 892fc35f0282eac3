//! Calls of an importer, of any version of FMI → a block in space in motion.

pub mod derivatives;
mod exchange;
mod fmu;

use std::cell::OnceCell;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::run::Progress;
use crate::space::energies::SpaceEnergies;
use crate::space::outputs::SpaceObservation;
use crate::space::{SpaceBody, SpaceEvent, SpaceGround, SpaceInputs, SpaceRun, SpaceState};
use crate::unit::attributes::{Kind, find};
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::in_space::outputs::{SpaceDerived, SpaceSource};
use crate::unit::in_space::values::SpaceValues;
use crate::unit::in_space::variables::{FMI3_VARIABLES, Fmi3Variable, Input, Metadata, Output, Role, VARIABLES};
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
    /// Model Exchange: the inputs at the end of the last completed step.
    last_inputs: SpaceInputs,
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
    last_inputs: SpaceInputs,
    ground: Option<Arc<SpaceGround>>,
    state: Option<SpaceState>,
}

impl From<SpaceUnit> for SavedUnit {
    fn from(unit: SpaceUnit) -> SavedUnit {
        let SpaceUnit { life, values, inputs, rates_are_new, at_end, last_inputs, ground, run, observed: _ } = unit;
        let state = run.map(|run| run.state().clone());
        SavedUnit { life, values, inputs, rates_are_new, at_end, last_inputs, ground, state }
    }
}

impl TryFrom<SavedUnit> for SpaceUnit {
    type Error = String;

    fn try_from(saved: SavedUnit) -> Result<SpaceUnit, String> {
        let SavedUnit { life, values, inputs, rates_are_new, at_end, last_inputs, ground, state } = saved;
        if !values.are_valid() {
            return Err("the values are not within their limits".into());
        }
        let setup = |_| values.setup(life.experiment.tolerance);
        let run = state.map(|state| SpaceRun::resume(setup(())?, state)).transpose()?;
        Ok(SpaceUnit {
            life,
            values,
            inputs,
            rates_are_new,
            at_end,
            last_inputs,
            ground,
            run,
            observed: Cache::default(),
        })
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

/// Number of feet with names.
const NAMED_FEET: usize = 4;

fn no_block() -> Fault {
    Fault::new("found no block; expected the call after initialization")
}

/// Returns the variable with this value reference if only FMI 3.0 has it.
fn fmi3_variable(reference: u32) -> Option<Fmi3Variable> {
    let index = (reference as usize).checked_sub(VARIABLES.len() + 1)?;
    FMI3_VARIABLES.get(index).map(|metadata| metadata.variable)
}

/// Refuses a derivative that is not of order 1.
fn first_order(name: &str, order: i32) -> Result<(), Fault> {
    if order == 1 {
        return Ok(());
    }
    Err(Fault::new(format!("derivative of {name} of order {order}; expected 1")))
}

/// Returns the output with this value reference.
fn output(reference: u32, wanted: &str) -> Result<Output, Fault> {
    let Metadata { name, causality, role, .. } = find(&VARIABLES, reference, Kind::Real)?;
    match role {
        Role::Output(output) => Ok(*output),
        Role::Parameter(_) | Role::Text(_) | Role::Derived(_) | Role::Input(_) => {
            Err(Fault::new(format!("{name} is {}; expected {wanted}", causality.one())))
        }
    }
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

impl SpaceUnit {
    /// Drops the preview after a change of values.
    fn drop_preview(&mut self) {
        self.run = None;
        self.observed = Cache::default();
    }

    /// Applies changed values: before initialization ends to the whole block, later to the observation.
    fn invalidate(&mut self) {
        if self.life.phase.is_initialized() {
            self.observed.is_stale = true;
        } else {
            self.drop_preview();
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
            self.check_feet(&setup.body)?;
            let mut run = SpaceRun::new(setup, &self.values.initial(), self.life.experiment.start);
            if self.life.interface == Interface::ModelExchange {
                run.begin_exchange();
            }
            return Ok(self.run.insert(run));
        }
        self.run.as_ref().ok_or_else(no_block)
    }

    /// Returns the inputs and the FMU's own records at the present time.
    fn effective_inputs(&self) -> SpaceInputs {
        let since = self.run.as_ref().map_or(self.time(), SpaceRun::piece_time);
        with_ground(&self.inputs.moved_to(self.time()), self.ground.as_deref(), since).0
    }

    /// Returns the observation of the present time. A block that is held shows no motion and no forces.
    fn observation(&mut self) -> Result<&SpaceObservation, Fault> {
        self.preview()?;
        self.observed.refresh();
        let acting = self.effective_inputs();
        let run = self.run.as_ref().ok_or_else(no_block)?;
        Ok(self.observed.observation.get_or_init(|| {
            let observed = run.observe(&acting);
            if run.is_frozen() { observed.held() } else { observed }
        }))
    }

    fn output(&mut self, source: &SpaceSource) -> Result<f64, Fault> {
        match source {
            SpaceSource::Observed(of) => Ok(of(self.observation()?)),
            SpaceSource::Foot(number, of) => {
                let is_named = self.names_feet();
                Ok(self.observation()?.feet.get(*number).filter(|_| is_named).map_or(0.0, of))
            }
            SpaceSource::Energy(of) => {
                self.preview()?;
                self.observed.refresh();
                let run = self.run.as_ref().ok_or_else(no_block)?;
                Ok(of(self.observed.energies.get_or_init(|| run.energies())))
            }
            SpaceSource::FrictionDemand => Ok(self.observation()?.friction_demand()),
            SpaceSource::Peak(of, _) | SpaceSource::Discrete(of) => Ok(of(self.preview()?)),
        }
    }

    /// Whether the outputs of named feet are those of the first four: the corners of a rectangle, or feet that are states in FMI 2.0.
    fn names_feet(&self) -> bool {
        self.values.is_rectangle()
            || self.life.interface == Interface::ModelExchange && self.values.fmi3.foot_count() == NAMED_FEET
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
