//! Derivatives in time: of inputs over the next step, of outputs at the present time.

use crate::block::restraints;
use crate::unit::fault::Fault;
use crate::unit::instance::Unit;
use crate::unit::instance::access::{input, known, output};
use crate::unit::outputs::{OutputRates, source};
use crate::unit::variables::{Kind, Metadata, Role};

impl Unit {
    /// Sets the time derivatives of inputs over the next step. The order is 1.
    ///
    /// # Errors
    /// A reference to no Real input, an order other than 1, or a derivative that is not finite.
    #[inline]
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Fault> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            let (_, metadata) = input(reference, "an input with derivatives")?;
            first_order(metadata, order)?;
            if !value.is_finite() {
                return Err(Fault::new(format!("derivative of {} = {value}; expected a finite number", metadata.name)));
            }
        }
        self.begin_inputs();
        if !std::mem::replace(&mut self.rates_are_new, true) {
            self.inputs.hold();
        }
        for (&reference, &value) in references.iter().zip(values) {
            if let Some(Metadata { role: Role::Input(input), .. }) = Metadata::of(reference) {
                self.inputs[*input].rate = value;
            }
        }
        self.invalidate();
        Ok(())
    }

    /// Returns the exact time derivatives of outputs, from the equations of motion. The order is 1.
    ///
    /// # Errors
    /// A reference to no Real output, an order other than 1, or values that make no block or record.
    pub fn output_derivatives<'a>(
        &mut self,
        references: &'a [u32],
        orders: &[i32],
    ) -> Result<impl Iterator<Item = Result<f64, Fault>> + use<'a>, Fault> {
        let output = |reference| output(reference, "an output with derivatives in time");
        for (&reference, &order) in references.iter().zip(orders) {
            output(reference)?;
            first_order(known(reference, Kind::Real)?, order)?;
        }
        let (simulation, inputs) = self.preview()?;
        let observed = simulation.observe_rates(&inputs);
        let now = OutputRates {
            observed,
            rates: observed.map(|x| x.eps),
            energies: simulation.energy_rates(&inputs),
            slip: simulation.slip(),
            peaks: simulation.peaks(),
            yield_forces: std::array::from_fn(|number| restraints::yield_force(simulation.block(), number)),
        };
        let rate = move |output| source(output).rate(&now);
        Ok(references.iter().map(move |&reference| output(reference).map(&rate)))
    }
}

fn first_order(metadata: &Metadata, order: i32) -> Result<(), Fault> {
    if order == 1 {
        return Ok(());
    }
    Err(Fault::new(format!("derivative of {} of order {order}; expected 1", metadata.name)))
}
