//! A rigid block rocking on two viscoelastic supports, after A. Palmeri and N. Makris,
//! "Response analysis of rigid structures rocking on viscoelastic foundation",
//! Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800.
//!
//! The modules stand in the order in which the data flows:
//!
//! | module | in → out |
//! | --- | --- |
//! | [`block`] | parameters → all that the equations need |
//! | [`excitation`] | inputs over a step, pulses → what drives the block at any time |
//! | [`regime`] | which corners touch |
//! | [`dynamics`] | state, regime, excitation → accelerations, reactions, energy |
//! | [`integrator`] | a step of the equations, its error, and the motion inside it |
//! | [`roots`] | a function over a step → its first fall through zero, its greatest value |
//! | [`events`] | state and supports → the functions whose fall through zero is an event |
//! | [`impact`] | velocities before a landing → velocities after |
//! | [`outputs`] | state and excitation → what a user sees, with exact derivatives |
//! | [`peaks`] | steps → greatest values since the start |
//! | [`simulation`] | the loop: step → locate → apply → settle the regime → go on |
//! | [`fmi2`] | all of it behind the C interface of FMI 2.0 |
//! | [`records`] | accelerogram files → ground accelerations |
//! | [`study`] | runs → histories, spectra, sweeps, searches, the paper's figures, tables, pictures |
//! | [`cli`] | the command line |
//!
//! [`scalar`] has the numbers that the equations are written in: `f64`, and dual numbers for derivatives.

pub mod scalar;

pub mod block;

pub mod excitation;

pub mod regime;

pub mod contact;

pub mod dynamics;

pub mod integrator;

pub mod roots;

pub mod events;

pub mod impact;

pub mod outputs;

pub mod peaks;

pub mod now;

pub mod transitions;

pub mod simulation;

pub mod fmi2;

#[cfg(feature = "records")]
pub mod records;

#[cfg(feature = "program")]
pub mod study;

#[cfg(feature = "program")]
pub mod cli;
