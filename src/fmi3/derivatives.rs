//! Derivatives in a direction, and of a weighted sum.

use std::mem::MaybeUninit;

use crate::fmi3::instance::{Answer, Instance, write};
use crate::fmi3::types::Status;
use crate::fmi3::values::{FLOAT64, fits, known, mismatch, own};
use crate::model::fault::Fault;
use crate::model::life_cycle::Phase;
use crate::model::unit::derivatives::Direction;

impl Instance {
    /// `fmi3GetDirectionalDerivative`.
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
            return self.directional_derivative(unknowns, knowns, seed, sensitivities);
        }
        fits(self.sizes(knowns), seed.len())?;
        let (mut direction, mut rest) = (Direction::default(), seed);
        for known in knowns {
            let (components, others) = rest.split_at(self.size(known));
            rest = others;
            add(&mut direction, *known, 0, components)?;
        }
        write(self.unit.derivative_at_beginning(unknowns, &direction)?, sensitivities)
    }

    /// `fmi3GetAdjointDerivative`: the derivatives of a sum of unknowns, each times its seed, with respect to each known.
    ///
    /// There are few directions but for the samples of a record, each of which takes no longer: a reverse mode would not be worth
    /// it.
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
            for (known, place) in knowns.iter().zip(sensitivities) {
                place.write(weighted(&mut self.unit.directional_derivative(unknowns, &[*known], &[1.0])?)?);
            }
            return Ok(Status::Ok);
        }
        fits(self.sizes(knowns), sensitivities.len())?;
        let mut places = sensitivities.iter_mut();
        for known in knowns {
            for (i, place) in (0..self.size(known)).zip(&mut places) {
                let mut direction = Direction::default();
                add(&mut direction, *known, i, &[1.0])?;
                place.write(weighted(&mut self.unit.derivative_at_beginning(unknowns, &direction)?)?);
            }
        }
        Ok(Status::Ok)
    }

    /// How many values a variable has.
    fn size(&self, reference: &u32) -> usize {
        own(*reference).map_or(1, |own| self.unit.size(own))
    }

    fn sizes(&self, references: &[u32]) -> usize {
        references.iter().map(|reference| self.size(reference)).sum()
    }
}

/// Refuses as unknowns what only FMI 3.0 has: nothing of it is an output.
fn check_unknowns(references: &[u32]) -> Result<(), Fault> {
    references.iter().find_map(|&reference| own(reference)).map_or(Ok(()), |own| {
        Err(Fault::new(format!(
            "{} is no output and no calculated parameter; only these are differentiated",
            own.name()
        )))
    })
}

/// Goes in the direction of values of a variable, from the value with the number `first` on.
fn add(direction: &mut Direction, reference: u32, first: usize, components: &[f64]) -> Result<(), Fault> {
    match own(reference) {
        Some(own) if known(reference)?.1 == FLOAT64 => direction.add_own(own, first, components),
        Some(_) => Err(mismatch(reference, FLOAT64)),
        None => components.iter().try_for_each(|&component| direction.add(reference, component)),
    }
}
