//! Settings of runs, some of them given → the settings of the solver.

#![allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]

use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{OnSeparation, Settings};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::spec::{SpecError, limits};

/// The settings of the runs of a study as a user gives them; others have their defaults.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[schemars(inline)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Runs"))]
pub struct RunSpec {
    /// Relative tolerance of the integration; the default suffices for outcomes and peaks, not for the last digits of reactions [default: 1e-6]
    #[schemars(range(min = Settings::TOLERANCES[0], max = Settings::TOLERANCES[1]))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "TOL"))]
    pub tolerance: Option<f64>,
    /// Action at complete separation [default: fly]
    #[serde(skip)]
    #[cfg_attr(feature = "clap", arg(long, value_parser = separations()))]
    pub on_separation: Option<OnSeparation>,
    /// Duration; by default each run lasts until the ground has come to rest and the block has come down [s]
    // A longer one would be a typing error.
    #[schemars(range(max = 1e6), extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub duration: Option<f64>,
    /// Longest time between two stops of a run; by default runs stop only at a record's samples and a pulse's ends [s]
    // A shorter one would be a typing error.
    #[schemars(range(min = 1e-6))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub step: Option<f64>,
    /// Add a column with the longest time for which |H|/(N_L + N_R) exceeds this coefficient of friction, checked every ms
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MU", help_heading = "Results"))]
    pub friction_demand: Option<f64>,
}

/// The settings of a single run as a user gives them; others have their defaults.
#[derive(Clone, Debug, Default, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Run"))]
pub struct SingleRunSpec {
    /// Relative tolerance of the integration [default: 1e-8]
    #[schemars(range(min = Settings::TOLERANCES[0], max = Settings::TOLERANCES[1]))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "TOL"))]
    pub tolerance: Option<f64>,
    /// Duration; by default the run lasts until the ground has come to rest and the block has come down [s]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub duration: Option<f64>,
    /// Time between rows of the table; by default the record's time step, or 0.01 [s]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub step: Option<f64>,
}

impl RunSpec {
    /// Returns the settings of the solver.
    ///
    /// # Errors
    /// The first setting out of range, also of those beside the solver's.
    pub fn settings(&self) -> Result<Settings, SpecError> {
        let RunSpec { tolerance, on_separation, duration, step, friction_demand } = *self;
        limits::check::<RunSpec>(&[
            ("tolerance", tolerance),
            ("duration", duration),
            ("step", step),
            ("friction_demand", friction_demand),
        ])?;
        let tolerance = tolerance.unwrap_or(Settings::OF_STUDIES);
        Ok(Settings { tolerance, on_separation: on_separation.unwrap_or(OnSeparation::Fly), ..Settings::default() })
    }
}

impl SingleRunSpec {
    /// Returns the settings of the solver with this action at complete separation.
    ///
    /// # Errors
    /// The first setting out of range, also of those beside the solver's.
    pub fn settings(&self, on_separation: OnSeparation) -> Result<Settings, SpecError> {
        let SingleRunSpec { tolerance, duration, step } = *self;
        limits::check::<SingleRunSpec>(&[("tolerance", tolerance), ("duration", duration), ("step", step)])?;
        let default = Settings::default();
        Ok(Settings { tolerance: tolerance.unwrap_or(default.tolerance), on_separation, ..default })
    }

    /// Returns the time between rows (s).
    pub fn output_step(&self, ground: &Ground) -> f64 {
        self.step_of(ground.time_step())
    }

    /// Returns the time between rows (s) under records of this time step (s), if any.
    pub fn step_of(&self, time_step: Option<f64>) -> f64 {
        self.step.or(time_step).unwrap_or(0.01)
    }
}

/// The words of actions at complete separation as options, with a line of help for each.
#[cfg(feature = "clap")]
pub fn separations() -> impl clap::builder::TypedValueParser<Value = OnSeparation> {
    super::choice(&[
        (OnSeparation::Terminate, "End the run, as in the paper's analysis"),
        (OnSeparation::Fly, "Follow the block through flight and landing"),
    ])
}
