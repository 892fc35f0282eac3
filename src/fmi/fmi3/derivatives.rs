//! Directional and adjoint derivatives.

use std::mem::MaybeUninit;

use crate::fmi::fmi3::instance::{Answer, Instance, write};
use crate::fmi::fmi3::types::Status;
use crate::fmi::fmi3::values::{FLOAT64, fits, known, mismatch};
use crate::unit::attributes::{Causality, Known};
use crate::unit::fault::Fault;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::Phase;

impl<U: Fmu> Instance<U> {
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
        fits(self.value_count(unknowns), sensitivities.len())?;
        check_unknowns::<U>(unknowns)?;
        if self.unit.life().phase != Phase::InitializationMode {
            fits(self.value_count(knowns), seed.len())?;
            let (mut time, mut others, mut components, mut rest) = (0.0, Vec::new(), Vec::new(), seed);
            for &known in knowns {
                let (these, following) = rest.split_at(self.unit.size(known));
                rest = following;
                if U::is_time(known) {
                    time += these.iter().sum::<f64>();
                } else {
                    others.push(known);
                    components.extend_from_slice(these);
                }
            }
            return self.directional_derivative(unknowns, &others, &components, time, sensitivities);
        }
        fits(self.value_count(knowns), seed.len())?;
        let (mut direction, mut rest) = (U::Direction::default(), seed);
        for known in knowns {
            let (components, others) = rest.split_at(self.unit.size(*known));
            rest = others;
            add::<U>(&mut direction, *known, 0, components)?;
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
        fits(self.value_count(unknowns), seed.len())?;
        check_unknowns::<U>(unknowns)?;
        if let Some(wrong) = seed.iter().find(|x| !x.is_finite()) {
            return Err(Fault::new(format!("seed {wrong}; expected finite numbers")));
        }
        let weighted = |derivatives: &mut dyn Iterator<Item = Result<f64, Fault>>| {
            derivatives
                .zip(seed)
                .try_fold(0.0, |sum, (derivative, factor)| Ok::<f64, Fault>(sum + derivative? * factor))
        };
        if self.unit.life().phase != Phase::InitializationMode {
            fits(self.value_count(knowns), sensitivities.len())?;
            let mut sensitivities = sensitivities.iter_mut();
            for known in knowns {
                let (knowns, time) =
                    if U::is_time(*known) { (&[][..], 1.0) } else { (std::slice::from_ref(known), 0.0) };
                let mut direction = vec![0.0; self.unit.size(*known)];
                for (i, sensitivity) in (0..direction.len()).zip(&mut sensitivities) {
                    direction.fill(0.0);
                    direction[i] = 1.0;
                    let mut derivatives = self.unit.directional_derivative(unknowns, knowns, &direction, time)?;
                    sensitivity.write(weighted(&mut derivatives)?);
                }
            }
            return Ok(Status::Ok);
        }
        fits(self.value_count(knowns), sensitivities.len())?;
        let mut sensitivities = sensitivities.iter_mut();
        for known in knowns {
            for (i, sensitivity) in (0..self.unit.size(*known)).zip(&mut sensitivities) {
                let mut direction = U::Direction::default();
                add::<U>(&mut direction, *known, i, &[1.0])?;
                sensitivity.write(weighted(&mut self.unit.initial_directional_derivative(unknowns, &direction)?)?);
            }
        }
        Ok(Status::Ok)
    }

    /// Returns the number of values of several variables.
    pub fn value_count(&self, references: &[u32]) -> usize {
        references.iter().map(|&reference| self.unit.size(reference)).sum()
    }
}

/// Refuses variables that exist only in FMI 3.0 as unknowns, unless they are outputs.
fn check_unknowns<U: Fmu>(references: &[u32]) -> Result<(), Fault> {
    let mut alone = references
        .iter()
        .filter_map(|&reference| U::known(reference))
        .filter(|known| known.of_fmi3 && known.causality != Causality::Output);
    alone.next().map_or(Ok(()), |Known { name, .. }| {
        Err(Fault::new(format!("{name} is no output; expected an output or a calculated parameter to differentiate")))
    })
}

/// Adds components of a variable to the direction, from the value with index `first` on.
fn add<U: Fmu>(direction: &mut U::Direction, reference: u32, first: usize, components: &[f64]) -> Result<(), Fault> {
    if known::<U>(reference).is_ok_and(|known| known.is_size) {
        return Err(mismatch::<U>(reference, FLOAT64));
    }
    U::add_to_direction(direction, reference, first, components)
}
