//! Reading and setting variables by value reference.

use crate::unit::attributes::find;
use crate::unit::derived::{DerivedSource, derived};
use crate::unit::fault::Fault;
use crate::unit::instance::{Unit, no_block};
use crate::unit::life_cycle::Phase;
use crate::unit::outputs::{source, state};
use crate::unit::values::Values;
use crate::unit::variables::{Input, Kind, Metadata, Output, Role, VARIABLES};

impl Unit {
    /// Sets values of one type, all or none.
    ///
    /// Setting a fixed parameter after initialization is refused even if the value is the present one.
    ///
    /// # Errors
    /// A reference to no variable of this type, a variable that cannot be set now, or a value outside its limits.
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
        let mut states = None;
        self.begin_inputs();
        for (&reference, &value) in references.iter().zip(values) {
            let (Some(metadata), value) = (Metadata::of(reference), real(value)) else { continue };
            match metadata.role {
                Role::Input(input) => self.inputs[input].value = value,
                // Continuous states are the only outputs that can be set.
                Role::Output(output) => {
                    state(output).into_iter().for_each(|i| states.get_or_insert(self.states)[i] = value);
                }
                Role::Parameter(_) | Role::Link(_) | Role::Text(_) | Role::Derived(_) => {
                    self.values[metadata.variable] = value;
                    if Values::is_of_ground(metadata.variable) {
                        self.ground = None;
                    }
                }
            }
        }
        if let Some(states) = states.filter(|states| *states != self.states) {
            self.set_states(&states)?;
        }
        self.invalidate();
        Ok(())
    }

    #[inline]
    fn settable(&self, metadata: &Metadata) -> Result<(), Fault> {
        if let Role::Output(output) = metadata.role
            && state(output).is_some()
            && self.life.phase == Phase::ContinuousTimeMode
        {
            return Ok(());
        }
        metadata.settable(self.life.phase)
    }

    /// Sets texts, all or none.
    ///
    /// # Errors
    /// A reference to no String, or a variable that cannot be set now.
    pub fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Result<(), Fault> {
        for &reference in references {
            self.settable(known(reference, Kind::String)?)?;
        }
        for (&reference, &text) in references.iter().zip(texts) {
            if let Role::Text(text_variable) = known(reference, Kind::String)?.role {
                self.values[text_variable] = text.into();
            }
        }
        self.forget_ground();
        Ok(())
    }

    /// Returns the text of a variable.
    ///
    /// # Errors
    /// A reference to no String.
    pub fn text(&self, reference: u32) -> Result<&str, Fault> {
        match known(reference, Kind::String)?.role {
            Role::Text(text) => Ok(&self.values[text]),
            Role::Input(_) | Role::Parameter(_) | Role::Link(_) | Role::Derived(_) | Role::Output(_) => Ok(""),
        }
    }

    /// Returns the value of a variable of this type. Integers and Booleans (0 or 1) become real numbers.
    ///
    /// # Errors
    /// A reference to no variable of this type, or values that make no block or record.
    pub fn get(&mut self, kind: Kind, reference: u32) -> Result<f64, Fault> {
        let metadata = known(reference, kind)?;
        match metadata.role {
            Role::Input(input) => Ok(self.present_inputs()[input].value),
            Role::Parameter(_) | Role::Link(_) | Role::Text(_) => Ok(self.values[metadata.variable]),
            Role::Derived(parameter) => match (derived(parameter), &self.simulation) {
                (DerivedSource::Block(of), Some(simulation)) => Ok(of(simulation.block())),
                (DerivedSource::Block(of), None) => Ok(of(&self.block()?)),
                (DerivedSource::Supports(of), _) => Ok(of(&self.block_on_supports()?)),
                (DerivedSource::Ground(of), _) => Ok(of.value(&*self.ground()?)),
            },
            Role::Output(output) => {
                if let Some(value) = self.state_output(output) {
                    return Ok(value);
                }
                let (_, acting) = self.preview()?;
                let Unit { simulation, observed, .. } = self;
                let simulation = simulation.as_ref().ok_or_else(no_block)?;
                Ok(source(output).value(observed, simulation, &acting))
            }
        }
    }
}

/// Returns the variable with this value reference, if it has this type.
#[inline(always)]
pub(super) fn known(reference: u32, kind: Kind) -> Result<&'static Metadata, Fault> {
    find(&VARIABLES, reference, kind)
}

/// Returns the Real output with this value reference; an error says what was `wanted`.
pub(super) fn output(reference: u32, wanted: &str) -> Result<Output, Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Output(output) => Ok(output),
        Role::Input(_) | Role::Parameter(_) | Role::Link(_) | Role::Text(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::new(format!("{name} is {}; expected {wanted}", causality.one())))
        }
    }
}

/// Returns the input with this value reference; an error says what was `wanted`.
#[inline(always)]
pub(super) fn input(reference: u32, wanted: &str) -> Result<(Input, &'static Metadata), Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Input(input) => Ok((input, metadata)),
        Role::Output(_) | Role::Parameter(_) | Role::Link(_) | Role::Text(_) | Role::Derived(_) => {
            let Metadata { name, causality, .. } = metadata;
            Err(Fault::new(format!("{name} is {}; expected {wanted}", causality.one())))
        }
    }
}
