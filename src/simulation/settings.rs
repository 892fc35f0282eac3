//! Choices of a run: tolerance, and the treatment of complete separation and overturning.

use serde::{Deserialize, Serialize};

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
    /// The smallest and the largest tolerance. [`Simulation::new`](crate::simulation::Simulation::new) replaces one outside by the nearer
    /// one.
    pub const TOLERANCES: [f64; 2] = [1e-14, 1e-1];

    /// The tolerance of studies, which need only outcome and peak rotation. docs/performance.md gives its effect.
    pub const OF_STUDIES: f64 = 1e-6;
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { tolerance: 1e-8, on_separation: OnSeparation::Terminate, on_overturning: OnOverturning::Terminate }
    }
}
