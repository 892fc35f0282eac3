//! A rigid block rocking on two viscoelastic supports, after A. Palmeri and N. Makris,
//! "Response analysis of rigid structures rocking on viscoelastic foundation",
//! Earthquake Engineering and Structural Dynamics 37 (2008) 1039-1063, doi:10.1002/eqe.800.
//!
//! A stone 1.9 m high under one cycle of a sine:
//!
//! ```
//! use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
//! use rocking_block::excitation::{Inputs, Pulse, PulseShape};
//! use rocking_block::simulation::{Initial, Settings, Simulation};
//!
//! let supports = Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 });
//! let block = Block::from_dimensionless(&Dimensionless { alpha: 0.18, p: 2.75, supports }, &Common::default())?;
//! let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.5, ..Pulse::NONE };
//! let inputs = Inputs::default();
//! let mut run = Simulation::new(block, Settings::default(), pulse, &Initial::default(), 0.0, &inputs);
//! run.advance(5.0, &inputs, &mut |event| println!("{event:?}"))?;
//! assert!((run.peaks().theta / block.alpha - 0.501).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The modules stand in the order in which the data flows:
//!
//! | module | in → out |
//! | --- | --- |
//! | [`numerics`] | a right-hand side → steps, their errors, roots; numbers with derivatives, lanes: knows nothing of blocks |
//! | [`block`] | parameters → all that the equations need; the contact of each corner → the regime |
//! | [`excitation`] | records, inputs over a step, pulses → the excitation at any time |
//! | [`run`] | what runs of both bodies below share: settings, endings, the steps that a call may take |
//! | [`system`] | pose and excitation → accelerations, reactions, and resets at events; without a clock or counters |
//! | [`simulation`] | the driver: step → locate → apply → go on; peaks, energies, outputs |
//! | [`space`] | a body on n feet, shaken in three directions → its run: a second core beside block, system and simulation |
//! | [`mod@unit`] | the variables of modelDescription.xml and modelDescriptionInSpace.xml ↔ block, pulse, outputs; life cycle, saved states: no C, no version of FMI |
//! | [`fmi`] | the calls of an importer → the unit: code shared by the C interfaces, [`fmi::fmi2`] and [`fmi::fmi3`] |
//!
//! Dependencies run one way: a block is independent of its integration, and both are independent of the interfaces.
//!
//! Other crates may build on [`block`], [`excitation`], [`run`], [`simulation`] and [`space`]. The other modules are public for the FMUs, studies and
//! tests of the repository: docs.rs does not show them, and any release may change them.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

#[cfg_attr(docsrs, doc(hidden))]
pub mod numerics;

pub mod block;

pub mod excitation;

pub mod run;

#[cfg_attr(docsrs, doc(hidden))]
pub mod system;

pub mod simulation;

pub mod space;

#[cfg_attr(docsrs, doc(hidden))]
pub mod unit;

#[cfg_attr(docsrs, doc(hidden))]
pub mod fmi;
