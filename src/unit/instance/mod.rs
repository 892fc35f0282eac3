//! Calls of an importer, of any version of FMI → a block in motion. Messages are in [`crate::fmi`].

mod access;
pub(crate) mod derivatives;
pub(crate) mod exchange;
mod fmi3_variables;
mod fmu;
mod rates;
pub(crate) mod substeps;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::excitation::Inputs;
use crate::excitation::records::Ground;
use crate::run::{Progress, SimulationError};
use crate::simulation::Simulation;
use crate::simulation::exchange::ContinuousStates;
use crate::system::events::Event;
use crate::unit::fault::Fault;
pub use crate::unit::life_cycle::Interface;
use crate::unit::life_cycle::{LifeCycle, Phase};
use crate::unit::links::no_balance;
use crate::unit::outputs::ObservationCache;
use crate::unit::values::Values;

/// An instance as a safe state machine, without pointers and messages. A copy of it is a saved state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    life: LifeCycle,
    values: Values,
    /// The importer's inputs, linear in time.
    inputs: Inputs,
    /// Whether rates were set since the last step. Otherwise the next step holds the inputs constant.
    rates_are_new: bool,
    /// The block in motion; before initialization ends, a preview from the present values.
    simulation: Option<Simulation>,
    /// Inputs plus the FMU's own records now, if they are known. See [`Unit::acting`].
    acting: Option<Inputs>,
    /// The inputs at the end of the present substep, if known in advance. See [`substeps`].
    at_end: Option<Inputs>,
    /// The FMU's own records, once they are read. Saved states share them; serialized states contain them, so that resuming
    /// needs no file.
    ground: Option<Arc<Ground>>,
    /// Model Exchange: the continuous states, as set or as the last event left them.
    states: ContinuousStates,
    /// Model Exchange: the inputs at the end of the last completed step.
    last_inputs: Inputs,
    /// Cached observation and energies at the present time.
    #[serde(skip)]
    observed: ObservationCache,
}

fn no_block() -> Fault {
    Fault::new("found no block; expected the call after initialization")
}

impl Unit {
    /// Makes a new instance with start values.
    pub fn new(interface: Interface) -> Unit {
        Unit {
            life: LifeCycle::new(interface),
            values: Values::default(),
            inputs: Inputs::default(),
            rates_are_new: false,
            simulation: None,
            acting: None,
            at_end: None,
            ground: None,
            states: ContinuousStates::default(),
            last_inputs: Inputs::default(),
            observed: ObservationCache::default(),
        }
    }

    /// Whether this can be a state of this FMU, which a checksum cannot ensure.
    pub fn is_valid(&self) -> bool {
        self.values.are_valid()
            && self.life.is_valid()
            && self.states.iter().all(|x| x.is_finite())
            && [&self.inputs, &self.last_inputs]
                .into_iter()
                .chain(&self.at_end)
                .chain(&self.acting)
                .all(Inputs::is_finite)
            && self.ground.as_ref().is_none_or(|ground| ground.is_valid())
            && match &self.simulation {
                Some(simulation) => {
                    self.ground.is_some()
                        && simulation.is_valid()
                        && self.values.block().as_ref() == Ok(simulation.block())
                }
                None => !self.life.phase.is_initialized(),
            }
    }

    /// Sets tolerance, start and stop of the run. Returns the tolerance used if it differs from the requested one.
    ///
    /// # Errors
    /// Times that are not finite or not in order, or a tolerance that is not a finite number above 0.
    pub fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault> {
        let used = self.life.plan(tolerance, start, stop)?;
        self.inputs.time = start;
        self.drop_preview();
        Ok(used)
    }

    /// Begins initialization.
    pub fn enter_initialization_mode(&mut self) {
        self.life.phase = Phase::InitializationMode;
        self.drop_preview();
    }

    /// Makes a block of the values. A refusal lets the importer correct them.
    ///
    /// Returns the parameters that were set but are not read, each with the setting that it needs.
    ///
    /// # Errors
    /// Values that make no block or record.
    pub fn exit_initialization_mode(&mut self) -> Result<Vec<(&'static str, &'static str)>, Fault> {
        self.preview()?;
        self.life.phase = match self.life.interface {
            Interface::CoSimulation => Phase::StepComplete,
            Interface::ModelExchange => {
                self.states = self.states()?;
                Phase::EventMode
            }
        };
        Ok(self.values.unread().collect())
    }

    /// Returns the sizes of the block that are read but unset, with their start values.
    pub fn unset_sizes(&self) -> Vec<(&'static str, f64)> {
        self.values.unset_sizes().map(|variable| (variable.name(), self.values[variable])).collect()
    }

    /// Advances by `step` (s) from `time` (s) and reports each event. `time` is the present one, up to a master's rounding.
    ///
    /// Allocates no memory unless it fails.
    ///
    /// # Errors
    /// A step that does not begin at the present time, has no finite length above 0 or goes beyond the stop; an error of the solver, after
    /// which the unit is in the error state.
    #[inline]
    pub fn advance(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<Progress, Fault> {
        let present = self.time();
        let until = self.begin_step(time, step)?;
        self.inputs.move_to(present);
        self.inputs.time = time;
        if !self.rates_are_new {
            self.inputs.hold();
        }
        let (progress, _) = self.advance_by_intervals(until, |simulation, until, acting| {
            simulation.advance(until, acting, observer).map(|progress| (progress, false))
        })?;
        self.rates_are_new = false;
        Ok(progress)
    }

    /// Refuses an impossible communication step, adopts the master's time, and returns the step's end (s).
    fn begin_step(&mut self, time: f64, step: f64) -> Result<f64, Fault> {
        let simulation = self.simulation.as_mut().ok_or_else(no_block)?;
        let until = self.life.begin_step(simulation.time(), time, step)?;
        simulation.set_time(time);
        Ok(until)
    }

    /// Advances to `until` (s), from sample to sample of the FMU's own records.
    ///
    /// `advance` steps over one interval between samples, and returns its progress and whether it stopped there.
    fn advance_by_intervals(
        &mut self,
        until: f64,
        mut advance: impl FnMut(&mut Simulation, f64, &Inputs) -> Result<(Progress, bool), SimulationError>,
    ) -> Result<(Progress, bool), Fault> {
        let Unit { life, simulation, inputs, acting, ground, observed, .. } = self;
        let (Some(simulation), Some(ground)) = (simulation, ground) else { return Err(no_block()) };
        (*acting, *observed) = (None, ObservationCache::default());
        let mut piece = (!ground.is_empty()).then(|| ground.piece_at(simulation.time()));
        let (progress, stopped) = loop {
            let acting = match &piece {
                Some(piece) => &*acting.insert(piece.inputs.plus(inputs)),
                None => &*inputs,
            };
            let end = piece.as_ref().map_or(until, |piece| piece.end.min(until));
            match (advance(simulation, end, acting), &mut piece) {
                (Ok((Progress::Reached, false)), Some(piece)) if end < until => ground.next_interval(piece),
                (Ok(progress), _) => break progress,
                (Err(error), _) => {
                    life.phase = Phase::Error;
                    return Err(Fault::new(error.to_string()));
                }
            }
        };
        match progress {
            Progress::Reached if stopped => {}
            // The record's slope may change here.
            Progress::Reached if !ground.is_empty() => {
                *acting = Some(with_ground(inputs, ground, simulation.time()).0);
            }
            Progress::Reached => {}
            Progress::Ended(..) => life.phase = Phase::StepFailed,
        }
        if piece.is_none() {
            *acting = Some(*inputs);
        }
        Ok((progress, stopped))
    }

    /// Returns the importer's inputs with the present time as their reference.
    fn present_inputs(&self) -> Inputs {
        self.inputs.moved_to(self.time())
    }

    /// Makes the present time the reference of the inputs, before they change.
    #[inline(always)]
    fn begin_inputs(&mut self) {
        self.inputs.move_to(self.time());
        if self.at_end.take().is_some() {
            self.inputs.hold();
        }
    }

    /// Returns inputs plus the FMU's own records at `time` (s), and their end (s).
    fn with_records(&self, inputs: &Inputs, time: f64) -> (Inputs, f64) {
        self.ground.as_ref().map_or((*inputs, f64::INFINITY), |ground| with_ground(inputs, ground, time))
    }

    /// Applies the event at which a step was left, if any, under the present inputs.
    ///
    /// # Errors
    /// The event leaves no regime that lasts.
    pub fn apply_pending_event(&mut self, observer: &mut dyn FnMut(&Event)) -> Result<(), Fault> {
        let acting = self.effective_inputs();
        let Unit { life, simulation, observed, .. } = self;
        let simulation = simulation.as_mut().ok_or_else(no_block)?;
        *observed = ObservationCache::default();
        simulation.apply_pending_event(&acting, observer).map_err(|error| {
            life.phase = Phase::Error;
            Fault::new(error.to_string())
        })
    }

    /// Whether separation or overturning has ended the run.
    pub fn has_ended(&self) -> bool {
        self.simulation.as_ref().is_some_and(|simulation| simulation.ending().is_some() && !simulation.is_frozen())
    }

    /// Returns the present time (s); before initialization, the planned start.
    #[inline]
    pub fn time(&self) -> f64 {
        self.simulation.as_ref().map_or(self.life.experiment.start, Simulation::time)
    }

    /// Applies changed values: before initialization ends to the whole block, later to the observation.
    ///
    /// A changed rate alone also invalidates the observation, since it changes the rounding of inputs.
    #[inline(always)]
    fn invalidate(&mut self) {
        if !self.life.phase.is_initialized() {
            return self.drop_preview();
        }
        (self.acting, self.observed) = (None, ObservationCache::default());
        if self.life.interface == Interface::ModelExchange {
            self.change_inputs();
        }
    }

    /// Lets changed inputs act on the block of Model Exchange.
    #[inline(never)]
    fn change_inputs(&mut self) {
        let Some(simulation) = &mut self.simulation else { return };
        let inputs = Inputs { time: simulation.piece_time(), ..self.inputs };
        let acting = self.ground.as_ref().map_or(inputs, |ground| with_ground(&inputs, ground, inputs.time).0);
        simulation.change_inputs(self.acting.insert(acting));
    }

    fn block(&self) -> Result<Block, Fault> {
        self.values.block().map_err(|error| Fault::new(error.to_string()))
    }

    fn block_on_supports(&self) -> Result<Block, Fault> {
        self.values.block_on_supports().map_err(|error| Fault::new(error.to_string()))
    }

    /// Returns the records. Files are read at the first call.
    fn ground(&mut self) -> Result<Arc<Ground>, Fault> {
        let ground = match self.ground.take() {
            Some(ground) => ground,
            None => Arc::new(self.values.ground().map_err(Fault)?),
        };
        Ok(self.ground.insert(ground).clone())
    }

    /// Drops the records after a change of their parameters.
    fn forget_ground(&mut self) {
        self.ground = None;
        self.invalidate();
    }

    /// Drops the preview after a change of values.
    fn drop_preview(&mut self) {
        self.simulation = None;
        self.observed = ObservationCache::default();
    }

    /// Returns the block in motion and the inputs that act on it. Before initialization ends they are a preview from the present values.
    fn preview(&mut self) -> Result<(&Simulation, Inputs), Fault> {
        if self.simulation.is_none() {
            let block = self.block()?;
            let ground = self.ground()?;
            let Unit { values, life, inputs, .. } = self;
            let (acting, _) = with_ground(inputs, &ground, life.experiment.start);
            let mut simulation = Simulation::new(
                block,
                values.settings(life.experiment.tolerance),
                values.pulse(),
                &values.initial(),
                life.experiment.start,
                &acting,
            );
            if !simulation.pose().is_finite() {
                return Err(no_balance(simulation.block()));
            }
            self.acting = Some(acting);
            if self.life.interface == Interface::ModelExchange {
                simulation.begin_exchange();
            }
            self.simulation = Some(simulation);
        }
        let acting = self.effective_inputs();
        let simulation = self.simulation.as_ref().ok_or_else(no_block)?;
        Ok((simulation, acting))
    }

    /// Returns the inputs plus the FMU's own records at the present time. A step overwrites them, and few importers read them before.
    fn effective_inputs(&mut self) -> Inputs {
        let acting = self.acting.unwrap_or_else(|| self.with_records(&self.inputs, self.inputs.time).0);
        *self.acting.insert(acting)
    }
}

/// Returns the inputs plus the records' line at `time` (s), and its end (s).
fn with_ground(inputs: &Inputs, ground: &Ground, time: f64) -> (Inputs, f64) {
    if ground.is_empty() {
        return (*inputs, f64::INFINITY);
    }
    let piece = ground.piece_at(time);
    (piece.inputs.plus(inputs), piece.end)
}
