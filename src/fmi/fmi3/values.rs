//! Reading and setting variables by the types of FMI 3.0.

use std::mem::MaybeUninit;

use crate::fmi::fmi3::instance::{Answer, Instance, write};
use crate::fmi::fmi3::types::Status;
use crate::unit::attributes::{Causality, Kind, Known};
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Phase;

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

/// Returns the variable with this value reference.
pub(super) fn known<U: Fmu>(reference: u32) -> Result<Known, Fault> {
    U::known(reference).ok_or_else(|| {
        Fault::new(format!("value reference {reference} does not exist; expected 1 to {}", U::VARIABLES))
    })
}

/// Refuses any variable, since none has the type `wanted`.
///
/// # Errors
/// The first variable. An empty list has none.
pub fn of_no_type<U: Fmu>(references: &[u32], wanted: &str) -> Answer {
    let Some(&reference) = references.first() else { return Ok(Status::Ok) };
    Err(mismatch::<U>(reference, wanted))
}

pub(super) fn mismatch<U: Fmu>(reference: u32, wanted: &str) -> Fault {
    match known::<U>(reference) {
        Ok(Known { name, kind, is_size, .. }) => {
            let found = if is_size { "UInt64" } else { type_name(kind) };
            Fault::new(format!("{name} (value reference {reference}) is of type {found}; expected {wanted}"))
        }
        Err(fault) => fault,
    }
}

/// Refuses variables of another kind, and those that only FMI 3.0 has.
fn check<U: Fmu>(references: &[u32], kind: Kind) -> Result<(), Fault> {
    let wrong = |&&reference: &&u32| U::known(reference).is_none_or(|known| known.kind != kind || known.of_fmi3);
    references.iter().find(wrong).map_or(Ok(()), |&reference| Err(mismatch::<U>(reference, type_name(kind))))
}

/// Refuses variables that are not sizes of arrays.
fn check_sizes<U: Fmu>(references: &[u32]) -> Result<(), Fault> {
    let wrong = references.iter().find(|&&reference| U::known(reference).is_none_or(|known| !known.is_size));
    wrong.map_or(Ok(()), |&reference| Err(mismatch::<U>(reference, "UInt64")))
}

/// Whether a variable is a Float64 that only FMI 3.0 has.
fn is_float_of_fmi3<U: Fmu>(reference: u32) -> bool {
    U::known(reference).is_some_and(|known| known.of_fmi3 && !known.is_size)
}

/// Whether only FMI 3.0 has a variable.
fn is_of_fmi3<U: Fmu>(reference: u32) -> bool {
    U::known(reference).is_some_and(|known| known.of_fmi3)
}

/// Refuses arrays whose length differs from the number of values of the variables.
pub(super) fn fits(expected: usize, found: usize) -> Result<(), Fault> {
    if expected == found {
        return Ok(());
    }
    Err(Fault::new(format!("nValues = {found}; expected {expected}, the number of values of the variables")))
}

impl<U: Fmu> Instance<U> {
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
        check::<U>(references, kind)?;
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
        check::<U>(references, kind)?;
        fits(references.len(), values.len())?;
        self.set(kind.base(), references, values, real)
    }

    /// `fmi3GetFloat64`.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn get_floats(&mut self, references: &[u32], values: &mut [MaybeUninit<f64>]) -> Answer {
        if !references.iter().any(|&reference| is_of_fmi3::<U>(reference)) {
            return self.get_scalars(Kind::Real, references, values, |value| value);
        }
        self.may_read(references)?;
        fits(self.value_count(references), values.len())?;
        let mut found = Vec::with_capacity(values.len());
        for &reference in references {
            if is_float_of_fmi3::<U>(reference) {
                self.unit.read_fmi3_variable(reference, &mut |value| found.push(value))?;
            } else {
                check::<U>(&[reference], Kind::Real)?;
                found.push(self.unit.get(Kind::Real, reference)?);
            }
        }
        let lost = found.iter().any(|number| !number.is_finite());
        write(found.into_iter().map(Ok), values)?;
        if lost { Ok(self.answer_without_numbers("a value")) } else { Ok(Status::Ok) }
    }

    /// `fmi3SetFloat64`, all or none. In an intermediate update, sets inputs of a later time.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be set or is outside its limits.
    pub fn set_floats(&mut self, references: &[u32], values: &[f64]) -> Answer {
        if self.unit.life().phase != Phase::SettingAhead {
            return if !references.iter().any(|&reference| is_of_fmi3::<U>(reference)) {
                self.set_scalars(Kind::Real, references, values, |value| value)
            } else {
                self.set_arrays(references, values)
            };
        }
        check::<U>(references, Kind::Real)?;
        fits(references.len(), values.len())?;
        self.version.check_required(references)?;
        let inputs = || {
            references
                .iter()
                .zip(values)
                .filter_map(|(&reference, &value)| Some((reference, U::known(reference)?, value)))
        };
        for (reference, Known { name, causality, .. }, value) in inputs() {
            if causality != Causality::Input {
                return Err(Fault::new(format!(
                    "{name} is no input; expected an input, which alone is set inside a step"
                )));
            }
            U::admits(reference, value)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.unit.set_ahead(reference, value);
        }
        Ok(Status::Ok)
    }

    /// Sets Float64 variables, some of them only of FMI 3.0, all or none.
    fn set_arrays(&mut self, references: &[u32], values: &[f64]) -> Answer {
        let size = |&reference: &u32| self.unit.size(reference);
        fits(references.iter().map(size).sum(), values.len())?;
        let mut changed = self.unit.clone();
        let mut rest = values;
        for reference in references {
            let (these, others) = rest.split_at(size(reference));
            rest = others;
            if is_float_of_fmi3::<U>(*reference) {
                changed.set_fmi3_variable(*reference, these)?;
            } else {
                check::<U>(&[*reference], Kind::Real)?;
                changed.set(Kind::Real, &[*reference], these, |value| value)?;
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
        check_sizes::<U>(references)?;
        fits(references.len(), values.len())?;
        self.may_read(references)?;
        write(references.iter().map(|&reference| Ok(self.unit.array_size(reference))), values)
    }

    /// `fmi3SetUInt64`: sets sizes of arrays, whose elements become zero.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a size that may not be set or is outside its limits.
    pub fn set_sizes(&mut self, references: &[u32], values: &[u64]) -> Answer {
        check_sizes::<U>(references)?;
        fits(references.len(), values.len())?;
        let mut changed = self.unit.clone();
        references.iter().zip(values).try_for_each(|(&reference, &size)| changed.resize(reference, size))?;
        self.unit = changed;
        Ok(Status::Ok)
    }

    /// Refuses to read a variable inside a step that was not requested for intermediate updates.
    fn may_read(&self, references: &[u32]) -> Result<(), Fault> {
        if self.unit.life().phase == Phase::ReadingOutputs { self.version.check_required(references) } else { Ok(()) }
    }

    /// `fmi3GetString`: checks the arguments before the strings are read.
    ///
    /// # Errors
    /// A variable of another type, a wrong number of values, or a value that may not be read now.
    pub fn check_texts(&self, references: &[u32], count: usize) -> Result<(), Fault> {
        check::<U>(references, Kind::String)?;
        fits(references.len(), count)?;
        self.may_read(references)
    }

    /// `fmi3GetOutputDerivatives`, order 1 only.
    ///
    /// # Errors
    /// A variable that is no Real output, an order other than 1, a wrong number of values, or a value that may not be read now.
    pub fn derivatives(&mut self, references: &[u32], orders: &[i32], values: &mut [MaybeUninit<f64>]) -> Answer {
        fits(self.value_count(references), values.len())?;
        self.may_read(references)?;
        self.output_derivatives(references, orders, values)
    }
}
