//! A study file with an `[assess]` table → everything a report on one object needs.
//!
//! The runs are those of a sweep: its blocks, ground motions and strengths. Variants of the object and assumptions at the ends of
//! their ranges are the same sweep with a [`Change`](crate::sweep::change::Change) of each block, under the same ground motions.
//!
//! | module | in → out |
//! | --- | --- |
//! | `object` | a sweep, the values in its middle → the object, in the plane or in space |
//! | `plan` | `[assess]` of a study file → states, hazard, variants, assumptions |
//! | `alternatives` | the object → its usual variants and the ranges of its assumptions |
//! | `results` | the numbers of a report |
//! | `comparing` | the results of a report → the variants that help, and the assumption that matters |
//! | `states` | the table of a sweep, limits → curves and annual rates |
//! | `pulses` | the object → the least pulses that overturn it |
//! | `spectrum` | the object → blocks of its shape in other sizes |
//! | `describe` | a plan → its object, building, ground motions and hazard in numbers |
//! | `steps` | studies → their tables, kept for further calls |
//! | `work` | a plan → its results |

mod alternatives;
mod comparing;
mod describe;
mod object;
mod plan;
mod pulses;
mod results;
mod spectrum;
mod states;
mod steps;
mod work;

pub use alternatives::{Alternative, Assumption};
pub use object::{AssessedObject, ObjectInSpace, ObjectValues};
pub use plan::{Hazard, Input, Plan, State};
pub use results::{
    BodyResult, BuildingResult, Comparison, Counts, CurveResult, HazardResult, LeastPulse, MotionResult, ObjectResult,
    PlaneResult, RateResult, Report, Sensitivity, SizeResult, SlidingResult, SpaceResult, StateResult,
};
pub use spectrum::SizeSpectrum;
pub use states::StateCurve;
pub use steps::{AssessError, Cache, Step};
pub use work::{Results, assess};
