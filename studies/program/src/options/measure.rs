//! Options of a block → the measure of records behind a measure relative to the block.

use anyhow::Context;
use clap::Args;

use crate::options::checks::{check, checked};
use crate::options::explicit::ExplicitOptions;
use rocking_block::block::Common;
use rocking_studies::intensity::{self, Measure, MeasureColumn};

/// The scales of a block, for measures relative to them.
#[derive(Args)]
#[command(next_help_heading = "Block")]
pub struct BlockScales {
    /// Slenderness angle of the block, for a measure relative to it such as "p PGV/(g tan alpha)" [rad]
    #[arg(long, value_name = "RAD")]
    alpha: Option<f64>,
    /// Frequency parameter of the block, for the same [rad/s]
    #[arg(long, value_name = "RAD/S")]
    p: Option<f64>,
    /// Gravitational acceleration, also for levels in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    pub g: f64,
}

impl BlockScales {
    /// Returns the measure in SI units behind the numbers of a column, that of records if it is relative to the block, and their factor
    /// on it.
    pub fn behind(&self, column: &MeasureColumn, explicit: &ExplicitOptions) -> anyhow::Result<(MeasureColumn, f64)> {
        check("g", self.g, |x| x > 0.0, "an acceleration above 0")?;
        let relative = column.measure.filter(|measure| measure.relative_to() != [false; 2]);
        let of_record = match relative {
            Some(measure) => Some(self.of_record(measure, explicit)?),
            None => {
                explicit.refuse_unless(false, &["alpha", "p"], &format!("on {}", column.name))?;
                None
            }
        };
        Ok(column.behind(of_record, self.g)?)
    }

    /// Returns the measure of records behind one relative to the block, and the factor of the latter on it.
    fn of_record(&self, measure: Measure, explicit: &ExplicitOptions) -> anyhow::Result<(Measure, f64)> {
        let [with_alpha, with_p] = measure.relative_to();
        explicit.refuse_unless(with_alpha, &["alpha"], &format!("on {measure}"))?;
        explicit.refuse_unless(with_p, &["p"], &format!("on {measure}"))?;
        let need = |is_needed: bool, value: Option<f64>, option: &str| match is_needed {
            true => value.with_context(|| format!("no --{option}; expected that of the block, for {measure}")),
            false => Ok(1.0),
        };
        let alpha = checked("alpha", self.alpha, |x| x > 0.0 && x < 1.5, "an angle above 0 and below 1.5 rad")?;
        let p = checked("p", self.p, |x| x > 0.0, "a frequency above 0 rad/s")?;
        let (alpha, p) = (need(with_alpha, alpha, "alpha")?, need(with_p, p, "p")?);
        Ok(measure.record_measure(intensity::BlockScales { alpha, p, gravity: self.g }))
    }
}
