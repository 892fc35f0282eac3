//! Reading and setting variables by the types of FMI 3.0.

use std::mem::MaybeUninit;

use crate::fmi::fmi3::instance::{Answer, Instance, write};
use crate::fmi::fmi3::types::Status;
use crate::unit::fault::Fault;
use crate::unit::life_cycle::Phase;
use crate::unit::variables::{Causality, FMI3_VARIABLES, Fmi3Variable, Kind, Metadata, Role, VARIABLES};

pub(super) const FLOAT64: &str = "Float64";

/// Returns the name of a type in FMI 3.0.
fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => FLOAT64,
        Kind::Integer => "Int32",
        Kind::Boolean => "Boolean",
        Kind::Enumeration => "Enumeration (Int64)",
        Kind::String => "String",
    }
}

/// Returns the variable with this value reference if it exists only in FMI 3.0.
pub(super) fn fmi3_variable(reference: u32) -> Option<Fmi3Variable> {
    let index = (reference as usize).checked_sub(VARIABLES.len() + 1)?;
    FMI3_VARIABLES.get(index).map(|metadata| metadata.variable)
}

/// Returns name and type of a variable.
pub(super) fn known(reference: u32) -> Result<(&'static str, &'static str), Fault> {
    if let Some(metadata) = Metadata::of(reference) {
        return Ok((metadata.name, type_name(metadata.kind)));
    }
    match fmi3_variable(reference) {
        Some(variable @ Fmi3Variable::RecordSamples) => Ok((variable.name(), "UInt64")),
        Some(variable) => Ok((variable.name(), FLOAT64)),
        None => {
            let last = VARIABLES.len() + FMI3_VARIABLES.len();
            Err(Fault::new(format!("value reference {reference} does not exist; expected 1 to {last}")))
        }
    }
}

/// Refuses any variable, since none has the type `wanted`.
///
/// # Errors
/// The first variable. An empty list has none.
pub fn of_no_type(references: &[u32], wanted: &str) -> Answer {
    let Some(&reference) = references.first() else { return Ok(Status::Ok) };
    Err(mismatch(reference, wanted))
}

pub(super) fn mismatch(reference: u32, wanted: &str) -> Fault {
    match known(reference) {
        Ok((name, found)) => {
            Fault::new(format!("{name} (value reference {reference}) is of type {found}; expected {wanted}"))
        }
        Err(fault) => fault,
    }
}

/// Refuses variables of another kind.
pub(super) fn check(references: &[u32], kind: Kind) -> Result<(), Fault> {
    let wrong = |&&reference: &&u32| Metadata::of(reference).is_none_or(|metadata| metadata.kind != kind);
    references.iter().find(wrong).map_or(Ok(()), |&reference| Err(mismatch(reference, type_name(kind))))
}

/// Refuses variables that are not sizes of arrays.
fn check_sizes(references: &[u32]) -> Result<(), Fault> {
    let wrong = references.iter().find(|&&reference| fmi3_variable(reference) != Some(Fmi3Variable::RecordSamples));
    wrong.map_or(Ok(()), |&reference| Err(mismatch(reference, "UInt64")))
}

/// Refuses arrays whose length differs from the number of values of the variables.
pub(super) fn fits(expected: usize, found: usize) -> Result<(), Fault> {
    if expected == found {
        return Ok(());
    }
    Err(Fault::new(format!("nValues = {found}; expected {expected}, the number of values of the variables")))
}

impl Instance {
    /// Reads scalars of one kind.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn get_scalars<T>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &mut [MaybeUninit<T>],
        convert: impl Fn(f64) -> T,
    ) -> Answer {
        check(references, kind)?;
        fits(references.len(), values.len())?;
        self.may_read(references)?;
        self.get(kind.base(), references, values, convert)
    }

    /// Sets scalars of one kind, all or none.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be set or is outside its limits.
    pub fn set_scalars<T: Copy>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &[T],
        real: impl Fn(T) -> f64,
    ) -> Answer {
        check(references, kind)?;
        fits(references.len(), values.len())?;
        self.set(kind.base(), references, values, real)
    }

    /// `fmi3GetFloat64`.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn get_floats(&mut self, references: &[u32], values: &mut [MaybeUninit<f64>]) -> Answer {
        if references.iter().all(|&reference| fmi3_variable(reference).is_none()) {
            return self.get_scalars(Kind::Real, references, values, |value| value);
        }
        self.may_read(references)?;
        let mut found = Vec::with_capacity(values.len());
        for &reference in references {
            match fmi3_variable(reference) {
                Some(variable) if known(reference)?.1 == FLOAT64 => {
                    self.unit.read_fmi3_variable(variable, &mut |value| found.push(value))?;
                }
                Some(_) | None => {
                    check(&[reference], Kind::Real)?;
                    found.push(self.unit.get(Kind::Real, reference)?);
                }
            }
        }
        fits(found.len(), values.len())?;
        let lost = found.iter().any(|number| !number.is_finite());
        write(found.into_iter().map(Ok), values)?;
        if lost { Ok(self.answer_without_numbers("a value")) } else { Ok(Status::Ok) }
    }

    /// `fmi3SetFloat64`, all or none. In an intermediate update, sets inputs of a later time.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be set or is outside its limits.
    pub fn set_floats(&mut self, references: &[u32], values: &[f64]) -> Answer {
        if self.unit.phase() != Phase::SettingAhead {
            return if references.iter().all(|&reference| fmi3_variable(reference).is_none()) {
                self.set_scalars(Kind::Real, references, values, |value| value)
            } else {
                self.set_arrays(references, values)
            };
        }
        check(references, Kind::Real)?;
        fits(references.len(), values.len())?;
        self.version.check_required(references)?;
        let inputs = || references.iter().filter_map(|&reference| Metadata::of(reference)).zip(values);
        for (metadata, &value) in inputs() {
            if metadata.causality != Causality::Input {
                let name = metadata.name;
                return Err(Fault::new(format!(
                    "{name} is no input; expected an input, which alone is set inside a step"
                )));
            }
            metadata.admits(value).map_err(Fault::new)?;
        }
        for (metadata, &value) in inputs() {
            if let Role::Input(input) = metadata.role {
                self.unit.set_ahead(input, value);
            }
        }
        Ok(Status::Ok)
    }

    /// Sets Float64 variables, some of them only of FMI 3.0, all or none.
    fn set_arrays(&mut self, references: &[u32], values: &[f64]) -> Answer {
        let size = |&reference: &u32| fmi3_variable(reference).map_or(1, |variable| self.unit.size(variable));
        fits(references.iter().map(size).sum(), values.len())?;
        let mut changed = self.unit.clone();
        let mut rest = values;
        for reference in references {
            let (these, others) = rest.split_at(size(reference));
            rest = others;
            match fmi3_variable(*reference) {
                Some(variable) if known(*reference)?.1 == FLOAT64 => changed.set_fmi3_variable(variable, these)?,
                Some(_) | None => {
                    check(&[*reference], Kind::Real)?;
                    changed.set(Kind::Real, &[*reference], these, |value| value)?;
                }
            }
        }
        self.unit = changed;
        Ok(Status::Ok)
    }

    /// `fmi3GetUInt64`.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn get_sizes(&mut self, references: &[u32], values: &mut [MaybeUninit<u64>]) -> Answer {
        check_sizes(references)?;
        fits(references.len(), values.len())?;
        self.may_read(references)?;
        let count = self.unit.sample_count() as u64;
        write(references.iter().map(|_| Ok(count)), values)
    }

    /// `fmi3SetUInt64`: sets sizes of arrays, whose elements become zero.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a size that may not be set or is outside its limits.
    pub fn set_sizes(&mut self, references: &[u32], values: &[u64]) -> Answer {
        check_sizes(references)?;
        fits(references.len(), values.len())?;
        let mut changed = self.unit.clone();
        values.iter().try_for_each(|&value| changed.resize_samples(value))?;
        self.unit = changed;
        Ok(Status::Ok)
    }

    /// Refuses to read a variable inside a step that was not requested for intermediate updates.
    fn may_read(&self, references: &[u32]) -> Result<(), Fault> {
        if self.unit.phase() == Phase::ReadingOutputs { self.version.check_required(references) } else { Ok(()) }
    }

    /// `fmi3GetString`: checks the arguments before the strings are read.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn check_texts(&self, references: &[u32], count: usize) -> Result<(), Fault> {
        check(references, Kind::String)?;
        fits(references.len(), count)?;
        self.may_read(references)
    }

    /// `fmi3GetOutputDerivatives`, order 1 only.
    ///
    /// # Errors
    /// A variable that is no Real output, an order other than 1, a wrong number of values, or a value that may not be read now.
    pub fn derivatives(&mut self, references: &[u32], orders: &[i32], values: &mut [MaybeUninit<f64>]) -> Answer {
        fits(references.len(), values.len())?;
        self.may_read(references)?;
        self.output_derivatives(references, orders, values)
    }
}
