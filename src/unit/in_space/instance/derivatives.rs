//! Exact derivatives: of outputs in time, and of outputs in a direction of inputs, continuous states and time.

use crate::space::SpaceInputs;
use crate::space::motion::{PER_FOOT, dimension};
use crate::space::piece::OF_FEET;
use crate::space::run::SpaceRates;
use crate::unit::attributes::{Kind, find};
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::in_space::instance::{SpaceUnit, fmi3_variable, no_block, output};
use crate::unit::in_space::outputs::{of_feet, source};
use crate::unit::in_space::variables::{Fmi3Variable, Role, VARIABLES, fmi3_metadata};
use crate::unit::life_cycle::Interface;

/// A direction of inputs at the present time.
#[derive(Clone, Debug, Default)]
pub struct SpaceDirection {
    inputs: SpaceInputs,
    time: f64,
}

impl SpaceDirection {
    /// Adds a component of an input, or of time.
    pub(super) fn add(&mut self, reference: u32, components: &[f64]) -> Result<(), Fault> {
        if fmi3_variable(reference) == Some(Fmi3Variable::Time) {
            self.time += components.iter().sum::<f64>();
            return Ok(());
        }
        let name = name(reference)?;
        match find(&VARIABLES, reference, Kind::Real).map(|metadata| metadata.role) {
            Ok(Role::Input(input)) => {
                for &component in components {
                    input.of(&mut self.inputs).value += finite(name, component)?;
                }
                Ok(())
            }
            _ => Err(Fault::new(format!(
                "{name} is no direction of this FMU's derivatives; expected an input or, later in Model Exchange, a continuous state"
            ))),
        }
    }
}

/// Returns the name of a variable.
fn name(reference: u32) -> Result<&'static str, Fault> {
    match fmi3_variable(reference) {
        Some(variable) => Ok(fmi3_metadata(variable).name),
        None => find(&VARIABLES, reference, Kind::Real).map(|metadata| metadata.name),
    }
}

fn finite(name: &str, component: f64) -> Result<f64, Fault> {
    if component.is_finite() {
        return Ok(component);
    }
    Err(Fault::new(format!("direction {component} of {name}; expected a finite number")))
}

impl SpaceUnit {
    /// Returns the changes of outputs, arrays of FMI 3.0 element by element.
    pub(super) fn changes(&self, references: &[u32], now: &SpaceRates) -> Result<Vec<f64>, Fault> {
        let (is_named, count) = (self.names_feet(), self.values.fmi3.foot_count());
        let observed = now.observed.map(|x| x.eps);
        let mut changes = Vec::with_capacity(references.len());
        for &reference in references {
            match fmi3_variable(reference).and_then(of_feet) {
                Some(of) => changes.extend((0..count).map(|i| observed.feet.get(i).map_or(0.0, of))),
                None => changes.push(source(output(reference, "an output")?).rate(now, &observed, is_named)),
            }
        }
        Ok(changes)
    }

    /// Returns exact directional derivatives of outputs: with respect to inputs and `time`, and in Model Exchange to states.
    pub(super) fn derivatives_along(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<Vec<f64>, Fault> {
        let mut along = SpaceDirection { time: finite("time", time)?, ..SpaceDirection::default() };
        let mut states = Vec::new();
        let mut rest = direction;
        for &known in knowns {
            let (components, others) = rest.split_at(rest.len().min(self.size(known)));
            rest = others;
            match self.states_of(known) {
                Some(first) => {
                    let name = name(known)?;
                    states.resize(self.state_count(), 0.0);
                    for (state, &component) in states[first..].iter_mut().zip(components) {
                        *state += finite(name, component)?;
                    }
                }
                None => along.add(known, components)?,
            }
        }
        self.along(unknowns, &along, states)
    }

    /// Returns exact directional derivatives of outputs with respect to inputs, and to states of Model Exchange if there are any.
    pub(super) fn along(
        &mut self,
        unknowns: &[u32],
        SpaceDirection { inputs, time }: &SpaceDirection,
        mut states: Vec<f64>,
    ) -> Result<Vec<f64>, Fault> {
        self.preview()?;
        let run = self.run.as_ref().ok_or_else(no_block)?;
        // Co-Simulation has blocks on any number of feet, whatever number is declared.
        states.resize(dimension(run.body().count()), 0.0);
        let now = run.along(&self.effective_inputs(), &states, inputs, *time);
        self.changes(unknowns, &now)
    }

    /// Returns the place of the first continuous state of a variable, if it is one now.
    fn states_of(&self, reference: u32) -> Option<usize> {
        let is_stepped_outside = self.life.interface == Interface::ModelExchange && self.life.phase.is_initialized();
        if !is_stepped_outside {
            return None;
        }
        let count = self.values.fmi3.foot_count();
        match fmi3_variable(reference) {
            Some(Fmi3Variable::StretchX) => Some(OF_FEET),
            Some(Fmi3Variable::StretchY) => Some(OF_FEET + count),
            Some(Fmi3Variable::Slip) => Some(OF_FEET + PER_FOOT * count),
            Some(_) => None,
            None => self.state_place(output(reference, "a state").ok()?),
        }
    }
}
