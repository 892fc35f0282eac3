//! What the C interfaces call → the instance.

use crate::run::Progress;
use crate::space::{SpaceEvent, SpaceInputs, SpaceRun};
use crate::unit::attributes::{Causality, Kind, Known, Variability, find};
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, Exchanged, Fmu, Reached};
use crate::unit::in_space::instance::derivatives::SpaceDirection;
use crate::unit::in_space::instance::{Cache, SpaceUnit, first_order, fmi3_variable, input, no_block, output};
use crate::unit::in_space::outputs::{derived, of_feet, source};
use crate::unit::in_space::values::SpaceValues;
use crate::unit::in_space::variables::{
    FMI3_VARIABLES, Fmi3Variable, GUID, Metadata, Role, TOKEN, VARIABLES, fmi3_metadata,
};
use crate::unit::life_cycle::{Interface, LifeCycle, Phase};

/// Whether a variable is the size of arrays.
fn is_size(variable: Fmi3Variable) -> bool {
    matches!(variable, Fmi3Variable::FootCount | Fmi3Variable::RecordSamples)
}

/// Returns the size of arrays with a reference that the C interfaces have found by [`Fmu::known`].
fn size_variable(reference: u32) -> Result<Fmi3Variable, Fault> {
    let size = fmi3_variable(reference).filter(|&variable| is_size(variable));
    size.ok_or_else(|| Fault::new(format!("value reference {reference} is not the size of arrays")))
}

impl Fmu for SpaceUnit {
    type Event = SpaceEvent;
    type Direction = SpaceDirection;

    const GUID: &'static str = GUID;
    const TOKEN: &'static str = TOKEN;
    const CONTENT_VERSION: u32 = 4;
    const VARIABLES: usize = VARIABLES.len() + FMI3_VARIABLES.len();

    fn new(interface: Interface) -> SpaceUnit {
        SpaceUnit {
            life: LifeCycle::new(interface),
            values: SpaceValues::default(),
            inputs: SpaceInputs::default(),
            rates_are_new: false,
            at_end: None,
            last_inputs: SpaceInputs::default(),
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
            && [&self.inputs, &self.last_inputs].into_iter().chain(&self.at_end).all(SpaceInputs::is_finite)
            && self.ground.as_ref().is_none_or(|ground| ground.records.iter().flatten().all(|record| record.is_valid()))
            && match &self.run {
                Some(run) => {
                    let is_exchanged = self.life.interface == Interface::ModelExchange;
                    self.ground.is_some() && run.is_exchanged() == is_exchanged && self.check_feet(run.body()).is_ok()
                }
                None => !self.life.phase.is_initialized(),
            }
    }

    fn time(&self) -> f64 {
        self.run.as_ref().map_or(self.life.experiment.start, SpaceRun::time)
    }

    fn known(reference: u32) -> Option<Known> {
        if let Some(metadata) = Metadata::of(reference) {
            return Some(metadata.known());
        }
        let variable = fmi3_variable(reference)?;
        let known = Known::of_fmi3(fmi3_metadata(variable).name, is_size(variable));
        Some(match of_feet(variable) {
            Some(_) => Known { causality: Causality::Output, variability: Variability::Continuous, ..known },
            None => known,
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
            let is_state = matches!(metadata.role, Role::Output(output) if self.is_settable_state(output));
            if !is_state {
                metadata.settable(self.life.phase)?;
            }
            metadata.admits(real(value)).map_err(Fault::new)?;
        }
        self.begin_inputs();
        for (&reference, &value) in references.iter().zip(values) {
            let (Some(metadata), value) = (Metadata::of(reference), real(value)) else { continue };
            match metadata.role {
                Role::Input(input) => input.of(&mut self.inputs).value = value,
                // Continuous states are the only outputs that can be set.
                Role::Output(output) => self.set_state(output, value),
                Role::Parameter(_) | Role::Text(_) | Role::Derived(_) => {
                    self.values[metadata.variable] = value;
                    if SpaceValues::is_of_ground(metadata.variable) {
                        self.ground = None;
                    }
                }
            }
        }
        self.invalidate();
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
        self.invalidate();
        Ok(())
    }

    fn size(&self, reference: u32) -> usize {
        match fmi3_variable(reference) {
            Some(Fmi3Variable::Indicator(number)) => self.indicator_places(number).len(),
            Some(variable) if !is_size(variable) => self.values.fmi3.size_of(variable),
            Some(_) | None => 1,
        }
    }

    fn read_fmi3_variable(&mut self, reference: u32, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        let Some(variable) = fmi3_variable(reference) else { return Ok(()) };
        if let Some(of) = of_feet(variable) {
            let count = self.values.fmi3.foot_count();
            let feet = &self.observation()?.feet;
            (0..count).for_each(|i| give(feet.get(i).map_or(0.0, of)));
        } else if let Fmi3Variable::Indicator(number) = variable {
            let places = self.indicator_places(number);
            match self.life.interface {
                // A constant, since the importer watches none.
                Interface::CoSimulation => places.for_each(|_| give(1.0)),
                Interface::ModelExchange => self.exchanged(Exchanged::Indicators, &mut |indicators| {
                    indicators[places.clone()].iter().copied().for_each(&mut *give);
                })?,
            }
        } else if variable == Fmi3Variable::Time {
            give(self.time());
        } else {
            self.values.fmi3.of(variable).iter().copied().for_each(give);
        }
        Ok(())
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
        let Some(places) = self.values.fmi3.of_mut(variable) else {
            return Err(Fault::new(format!("{name} is set; expected a real parameter")));
        };
        places.copy_from_slice(values);
        self.ground = None;
        self.drop_preview();
        Ok(())
    }

    fn array_size(&self, reference: u32) -> u64 {
        fmi3_variable(reference).map_or(0, |size| self.values.fmi3.size_of(size) as u64)
    }

    fn resize(&mut self, reference: u32, count: u64) -> Result<(), Fault> {
        let size = size_variable(reference)?;
        fmi3_metadata(size).admits(count as f64).map_err(Fault::new)?;
        self.values.fmi3.resize(size, count as usize);
        self.ground = None;
        self.drop_preview();
        Ok(())
    }

    fn is_time(reference: u32) -> bool {
        fmi3_variable(reference) == Some(Fmi3Variable::Time)
    }

    fn interval(&self) -> f64 {
        self.values.fmi3.interval
    }

    fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault> {
        let used = self.life.plan(tolerance, start, stop)?;
        self.inputs.time = start;
        self.drop_preview();
        Ok(used)
    }

    fn enter_initialization_mode(&mut self) {
        self.life.phase = Phase::InitializationMode;
        self.drop_preview();
    }

    fn exit_initialization_mode(&mut self) -> Result<Vec<(&'static str, &'static str)>, Fault> {
        self.preview()?;
        self.life.phase = match self.life.interface {
            Interface::CoSimulation => Phase::StepComplete,
            Interface::ModelExchange => Phase::EventMode,
        };
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
            first_order(name, order)?;
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
        self.invalidate();
        Ok(())
    }

    fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        for (&reference, &order) in references.iter().zip(orders) {
            match fmi3_variable(reference) {
                Some(variable) if of_feet(variable).is_some() => first_order(fmi3_metadata(variable).name, order)?,
                Some(variable) => {
                    let name = fmi3_metadata(variable).name;
                    return Err(Fault::new(format!(
                        "{name} is no output; expected an output with derivatives in time"
                    )));
                }
                None => {
                    output(reference, "an output with derivatives in time")?;
                    first_order(find(&VARIABLES, reference, Kind::Real)?.name, order)?;
                }
            }
        }
        self.preview()?;
        let run = self.run.as_ref().ok_or_else(no_block)?;
        let rates = self.changes(references, &run.rates(&self.effective_inputs()))?;
        Ok(rates.into_iter().map(Ok))
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

    /// An event has happened when the step is left: it changes no place and no velocity.
    fn apply_pending_event(&mut self, _: &mut dyn FnMut(&SpaceEvent)) -> Result<(), Fault> {
        Ok(())
    }

    fn enter_event_mode(&mut self) {
        SpaceUnit::enter_event_mode(self);
    }

    fn state_count(&self) -> usize {
        SpaceUnit::state_count(self)
    }

    fn indicator_count(&self) -> usize {
        SpaceUnit::indicator_count(self)
    }

    fn pass_events(&mut self, observer: &mut dyn FnMut(&SpaceEvent)) -> Result<AfterEvent, Fault> {
        SpaceUnit::pass_events(self, observer)
    }

    fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        SpaceUnit::set_time(self, time)
    }

    fn set_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        SpaceUnit::set_states(self, states)
    }

    fn exchanged(&mut self, numbers: Exchanged, give: &mut dyn FnMut(&[f64])) -> Result<(), Fault> {
        SpaceUnit::exchanged(self, numbers, give)
    }

    fn complete_step(&mut self) {
        SpaceUnit::complete_step(self);
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Ok(self.derivatives_along(unknowns, knowns, direction, time)?.into_iter().map(Ok))
    }

    fn add_to_direction(
        direction: &mut SpaceDirection,
        reference: u32,
        _: usize,
        components: &[f64],
    ) -> Result<(), Fault> {
        direction.add(reference, components)
    }

    fn initial_directional_derivative(
        &mut self,
        unknowns: &[u32],
        direction: &SpaceDirection,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Ok(self.along(unknowns, direction, Vec::new())?.into_iter().map(Ok))
    }
}
