//! The recomputed figures of Palmeri and Makris (2008).
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | the paper's values and those chosen here → blocks, pulses, captions |
//! | [`ground_motions`] | a folder of records → the ground motions of Table I |
//! | `figure` | caption, drawing and rows → a picture and a table |
//! | `restitution` | Figure 3 |
//! | `histories` | Figures 6 to 8 |
//! | `damping` | Figure 9 |
//! | `spectra` | Figures 10 to 13 |
//! | `tower` | Figure 14 |
//! | [`plane`] | pulses → the ones that reproduce the paper's findings |

pub mod ground_motions;
pub mod parameters;

mod figure;

mod restitution;

mod histories;

mod damping;

mod spectra;

mod tower;

pub mod plane;

pub use damping::{LeastDamping, least_damping};
pub use figure::{Figure, FigureError};
pub use histories::{Comparison, comparisons, history_run};
pub use spectra::{Panel, abscissa, panels};
pub use tower::{tower_bases, tower_run, tower_sources};

use ground_motions::GroundMotion;
use parameters::Detail;

/// Makes a figure on the current pool of threads; `sources` are the ground motions of Table I.
///
/// # Errors
/// A number without a figure, and the errors of its runs and of its drawing.
pub fn make(number: u8, detail: &Detail, sources: &[GroundMotion]) -> Result<Figure, FigureError> {
    match number {
        3 => restitution::figure(),
        6..=8 => histories::figure(number, detail),
        9 => damping::figure(detail),
        10..=13 => spectra::figure(number, detail, sources),
        14 => tower::figure(sources),
        _ => Err(FigureError::Number(number)),
    }
}
