//! Directional and adjoint derivatives.

use std::mem::MaybeUninit;

use crate::fmi::fmi3::instance::{Answer, Instance, write};
use crate::fmi::fmi3::types::Status;
use crate::fmi::fmi3::values::{FLOAT64, fits, fmi3_variable, known, mismatch};
use crate::unit::fault::Fault;
use crate::unit::instance::derivatives::Direction;
use crate::unit::life_cycle::Phase;
use crate::unit::variables::Fmi3Variable;

impl Instance {
    /// `fmi3GetDirectionalDerivative`.
    ///
    /// # Errors
    /// Unknown variables, arrays of the wrong length, or a direction that is not finite.
    pub fn directional(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivities: &mut [MaybeUninit<f64>],
    ) -> Answer {
        fits(unknowns.len(), sensitivities.len())?;
        check_unknowns(unknowns)?;
        if self.unit.phase() != Phase::InitializationMode {
            fits(knowns.len(), seed.len())?;
            let (of_time, others): (Vec<_>, Vec<_>) = knowns.iter().zip(seed).partition(|(known, _)| is_time(known));
            let time = of_time.into_iter().map(|(_, component)| component).sum();
            let (knowns, seed): (Vec<u32>, Vec<f64>) = others.into_iter().unzip();
            return self.directional_derivative(unknowns, &knowns, &seed, time, sensitivities);
        }
        fits(self.value_count(knowns), seed.len())?;
        let (mut direction, mut rest) = (Direction::default(), seed);
        for known in knowns {
            let (components, others) = rest.split_at(self.size(known));
            rest = others;
            add(&mut direction, *known, 0, components)?;
        }
        write(self.unit.initial_directional_derivative(unknowns, &direction)?, sensitivities)
    }

    /// `fmi3GetAdjointDerivative`: the derivatives of the weighted sum of the unknowns with respect to each known.
    ///
    /// Evaluates one direction per known. There are few, except for samples of a record, so a reverse mode would not pay.
    ///
    /// # Errors
    /// Unknown variables, arrays of the wrong length, or a seed that is not finite.
    pub fn adjoint_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivities: &mut [MaybeUninit<f64>],
    ) -> Answer {
        fits(unknowns.len(), seed.len())?;
        check_unknowns(unknowns)?;
        if let Some(wrong) = seed.iter().find(|x| !x.is_finite()) {
            return Err(Fault::new(format!("seed {wrong}; expected finite numbers")));
        }
        let weighted = |derivatives: &mut dyn Iterator<Item = Result<f64, Fault>>| {
            derivatives
                .zip(seed)
                .try_fold(0.0, |sum, (derivative, factor)| Ok::<f64, Fault>(sum + derivative? * factor))
        };
        if self.unit.phase() != Phase::InitializationMode {
            fits(knowns.len(), sensitivities.len())?;
            for (known, sensitivity) in knowns.iter().zip(sensitivities) {
                let (knowns, time) = if is_time(known) { (&[][..], 1.0) } else { (std::slice::from_ref(known), 0.0) };
                let mut derivatives = self.unit.directional_derivative(unknowns, knowns, &[1.0], time)?;
                sensitivity.write(weighted(&mut derivatives)?);
            }
            return Ok(Status::Ok);
        }
        fits(self.value_count(knowns), sensitivities.len())?;
        let mut sensitivities = sensitivities.iter_mut();
        for known in knowns {
            for (i, sensitivity) in (0..self.size(known)).zip(&mut sensitivities) {
                let mut direction = Direction::default();
                add(&mut direction, *known, i, &[1.0])?;
                sensitivity.write(weighted(&mut self.unit.initial_directional_derivative(unknowns, &direction)?)?);
            }
        }
        Ok(Status::Ok)
    }

    /// Returns the number of values of a variable.
    fn size(&self, reference: &u32) -> usize {
        fmi3_variable(*reference).map_or(1, |variable| self.unit.size(variable))
    }

    /// Returns the number of values of several variables.
    pub fn value_count(&self, references: &[u32]) -> usize {
        references.iter().map(|reference| self.size(reference)).sum()
    }
}

fn is_time(reference: &u32) -> bool {
    fmi3_variable(*reference) == Some(Fmi3Variable::Time)
}

/// Refuses variables that exist only in FMI 3.0 as unknowns, since none is an output.
fn check_unknowns(references: &[u32]) -> Result<(), Fault> {
    references.iter().find_map(|&reference| fmi3_variable(reference)).map_or(Ok(()), |variable| {
        Err(Fault::new(format!(
            "{} is no output; expected an output or a calculated parameter to differentiate",
            variable.name()
        )))
    })
}

/// Adds components of a variable to the direction, from the value with index `first` on.
fn add(direction: &mut Direction, reference: u32, first: usize, components: &[f64]) -> Result<(), Fault> {
    match fmi3_variable(reference) {
        Some(variable) if known(reference)?.1 == FLOAT64 => direction.add_fmi3_variable(variable, first, components),
        Some(_) => Err(mismatch(reference, FLOAT64)),
        None => components.iter().try_for_each(|&component| direction.add(reference, component)),
    }
}
