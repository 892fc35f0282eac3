//! A rigid block rocking on two viscoelastic supports, after A. Palmeri and N. Makris,
//! "Response analysis of rigid structures rocking on viscoelastic foundation",
//! Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800.

#[cfg(feature = "program")]
pub mod records;
