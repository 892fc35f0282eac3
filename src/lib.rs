//! A rigid block rocking on two viscoelastic supports, after A. Palmeri and N. Makris,
//! "Response analysis of rigid structures rocking on viscoelastic foundation",
//! Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800.

pub mod regime;
pub mod scalar;

pub mod block;
pub mod dynamics;
pub mod events;
pub mod excitation;
pub mod impact;
pub mod integrator;
pub mod outputs;
pub mod peaks;
pub mod roots;
pub mod simulation;

pub mod fmi2;

#[cfg(feature = "program")]
pub mod cli;
#[cfg(feature = "program")]
pub mod records;
#[cfg(feature = "program")]
pub mod study;
