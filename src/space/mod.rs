//! The block in space: a rigid body on n feet with friction, shaken in three directions.
//!
//! Every foot is a vertical spring and dashpot that cannot pull, with a horizontal spring, dashpot and Coulomb slider. All forces are functions
//! of the state. docs/unit/model.md has the equations.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | numbers as users give them, and the errors of invalid ones |
//! | `base` | feet → the edges of the base, and the critical tilts over them |
//! | `body` | checked parameters → the numbers of the equations |
//! | [`excitation`] | inputs over a step, records and pulses → the forcing at any time |
//! | [`motion`] | a state → the motion of the body and its feet |
//! | `forces` | the motion of a foot and its contact → the force on it |
//! | [`equations`] | state, contacts and excitation → rates of the state |
//! | `beginning` | tilt, twist and velocities → the state at the start |
//! | `events` | the functions that are watched, and the change of the block at their zeros: a file each |
//! | [`exchange`] | states of an outside solver → their derivatives, event indicators, effects of events |
//! | `piece` | the present piece of a run that is stepped from outside, and the places of its states |
//! | `limits` | contacts and tolerance → allowed errors and the longest step |
//! | [`energies`], [`outputs`] | a state → energies; a block at an instant → the quantities that users see |
//! | `peaks` | the ends of a step → the greatest values, also between them |
//! | `samples` | an end of a step → the samples of the watched functions there |
//! | [`run`], `stepping` | a run: steps, their first events, and the motion after them |

pub(crate) mod base;
pub(crate) mod beginning;
pub(crate) mod body;
pub mod energies;
pub mod equations;
pub(crate) mod events;
pub mod exchange;
pub mod excitation;
pub(crate) mod forces;
mod limits;
pub mod motion;
pub mod outputs;
pub mod parameters;
pub(crate) mod peaks;
pub(crate) mod piece;
pub mod run;
mod samples;
mod stepping;

pub use beginning::SpaceInitial;
pub use body::SpaceBody;
pub use events::{SpaceEvent, SpaceEventKind};
pub use excitation::{DirectedPulse, SpaceGround, SpaceInputs};
pub use parameters::{Base, BaseSize, FootPlace, SpaceError, SpaceParameters, SpaceSupports};
pub use peaks::SpacePeaks;
pub use run::{SpaceRun, SpaceSetup, SpaceState};
