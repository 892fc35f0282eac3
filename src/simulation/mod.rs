//! A run: its state, and the driver that steps it through its events.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`outputs`], `energies`, [`peaks`], `force_peaks` | an instant, or a step → quantities that users see, energies, greatest values |
//! | `state` | the data of a run, and views of them |
//! | `limits`, `step_interior` | a mode → the longest step; a step → the motion and the first event inside |
//! | `step` | the interface of steps: `StepsInput` → `StepsOutcome` |
//! | `stepping`, `rest`, `swings` | steps under one mode, to the first event: Runge–Kutta steps; rest and swings on the rigid base |
//! | `driver` | step → locate the first event → apply it → decide the regime → continue |
//! | [`exchange`] | the same run, stepped by an importer's solver |
//! | `follow` | a run one step at a time, with derivatives |
//! | `lanes` | several runs, a step at a time in the lanes of vectors |
//! | `initial_sensitivity` | derivatives of the beginning |

mod driver;
mod energies;
pub mod exchange;
#[cfg(feature = "lanes")]
pub mod follow;
mod force_peaks;
mod initial_sensitivity;
#[cfg(feature = "lanes")]
pub mod lanes;
mod limits;
pub mod outputs;
pub mod peaks;
mod rest;
mod state;
mod step;
mod step_interior;
mod stepping;
mod swings;

pub use crate::run::{Ending, OnOverturning, OnSeparation, Progress, Settings, SimulationError};
pub use crate::system::beginning::Initial;
pub use energies::{Energies, EnergySums};
pub use initial_sensitivity::{InitialDerivatives, Start};
pub use state::{Counts, Simulation, Slip};
