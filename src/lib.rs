//! A rigid block rocking on two viscoelastic supports, after A. Palmeri and N. Makris,
//! "Response analysis of rigid structures rocking on viscoelastic foundation",
//! Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800.
//!
//! The modules stand in the order in which the data flows:
//!
//! | module | in → out |
//! | --- | --- |
//! | [`records`] | accelerogram files → ground accelerations, linear between their samples |
//! | [`scalar`] | what formulas need of a number: `f64`, and dual numbers for derivatives |
//! | [`dual`] | a number with its derivative |
//! | [`block`] | parameters → all that the equations need |
//! | [`excitation`] | inputs over a step, pulses → what drives the block at any time |
//! | [`contact`] | what each corner does → the regime |
//! | [`system`] | pose and excitation → accelerations, reactions, and what an event makes of them: no clock, no counters |
//! | [`numerics`] | a right-hand side → steps, their errors, roots: knows nothing of blocks |
//! | [`simulation`] | the driver: step → locate → apply → go on; peaks, energies, outputs |
//! | [`model`] | the variables of modelDescription.xml ↔ block, pulse, outputs: no C, no version of FMI |
//! | [`fmi`] | pointers of C → slices; panics and faults → a status and a message: what all versions of FMI share |
//! | [`fmi2`] | the model behind the C interface of FMI 2.0 |
//! | [`fmi3`] | the model behind the C interface of FMI 3.0 |
//! | [`study`] | runs → histories, spectra, sweeps, searches, the paper's figures, tables, pictures |
//! | [`cli`] | the command line |
//!
//! Arrows run one way: what the block is does not know how it is stepped, and neither knows how it is shown.

pub mod records;

pub mod scalar;

pub mod dual;

pub mod block;

pub mod excitation;

pub mod contact;

pub mod system;

pub mod numerics;

pub mod simulation;

pub mod model;

#[cfg(any(feature = "fmi", doc))]
pub mod fmi;

#[cfg(any(feature = "fmi", doc))]
pub mod fmi2;

#[cfg(any(feature = "fmi", doc))]
pub mod fmi3;

#[cfg(feature = "studies")]
pub mod study;

#[cfg(feature = "program")]
pub mod cli;
