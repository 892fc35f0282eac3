//! Choices of a run: tolerance, and the treatment of complete separation and overturning.

use serde::{Deserialize, Serialize};

use crate::run::Ending;

/// Choices at complete separation, by the numbers of the FMU's `on_separation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum OnSeparation {
    /// The run ends.
    Terminate = 1,
    /// Time goes on with the block frozen.
    Hold = 2,
    /// The block flies, and lands.
    Fly = 3,
}

/// Choices at overturning, by the numbers of the FMU's `on_overturning`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum OnOverturning {
    /// The run ends.
    Terminate = 1,
    /// Time goes on with the block frozen.
    Hold = 2,
}

/// Settings of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Relative tolerance of the integrator, 1e-14…1e-1. It is the error allowed in a step, as an equivalent velocity over the rocking
    /// velocity α p.
    pub tolerance: f64,
    /// At complete separation.
    pub on_separation: OnSeparation,
    /// At overturning.
    pub on_overturning: OnOverturning,
}

impl Settings {
    /// The smallest and the largest tolerance. A new run replaces one outside by the nearer one.
    pub const TOLERANCES: [f64; 2] = [1e-14, 1e-1];

    /// The tolerance of studies, which need only outcome and peak rotation. docs/code/performance.md gives its effect.
    pub const OF_STUDIES: f64 = 1e-6;

    /// Returns the settings with a tolerance within its limits.
    pub(crate) fn within_limits(self) -> Settings {
        let [least, most] = Settings::TOLERANCES;
        Settings { tolerance: self.tolerance.clamp(least, most), ..self }
    }

    /// Whether time goes on after an ending, with the block held.
    pub(crate) fn holds(&self, ending: Ending) -> bool {
        match ending {
            Ending::Separated | Ending::Toppled => self.on_separation == OnSeparation::Hold,
            Ending::Overturned => self.on_overturning == OnOverturning::Hold,
        }
    }
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { tolerance: 1e-8, on_separation: OnSeparation::Terminate, on_overturning: OnOverturning::Terminate }
    }
}
