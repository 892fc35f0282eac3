//! A calculated parameter → the source of its value.

use crate::block::{Block, Corner};
use crate::excitation::records::Ground;
use crate::numerics::scalar::Elementary;
use crate::unit::variables::Derived;
use rocking_records::Record;

/// The source of a calculated parameter's value.
pub enum DerivedSource<T = f64> {
    /// The block.
    Block(fn(&Block<T>) -> T),
    /// The block as it would stand on its supports.
    Supports(fn(&Block<T>) -> T),
    /// The records.
    Ground(OfGround),
}

/// Returns the source of a calculated parameter.
pub fn derived<T: Elementary>(parameter: Derived) -> DerivedSource<T> {
    use DerivedSource::{Block as OfBlock, Supports as OfSupports};
    match parameter {
        Derived::DerivedAlpha => OfBlock(|block| block.alpha),
        Derived::DerivedAlphaL => OfBlock(|block| block.alpha_of(Corner::Left)),
        Derived::DerivedAlphaR => OfBlock(|block| block.alpha_of(Corner::Right)),
        Derived::DerivedR0 => OfBlock(|block| block.r0),
        Derived::DerivedI0 => OfBlock(Block::inertia),
        Derived::DerivedP => OfBlock(|block| block.p),
        Derived::DerivedOmegaV => OfSupports(|block| block.omega_v),
        Derived::DerivedK => OfSupports(|block| block.stiffness),
        Derived::DerivedC => OfSupports(|block| block.damping),
        Derived::DerivedEta => OfSupports(Block::eta),
        Derived::DerivedXiV => OfSupports(|block| block.xi_v),
        Derived::DerivedDeltaS => OfSupports(|block| block.static_deflection()),
        Derived::DerivedE => OfBlock(Block::restitution),
        Derived::DerivedEMax => OfBlock(Block::max_restitution),
        Derived::DerivedThetaSeparation => OfSupports(Block::separation_angle),
        Derived::DerivedWidth => OfBlock(|block| block.b * 2.0),
        Derived::DerivedHeight => OfBlock(|block| block.h * 2.0),
        Derived::RecordPGA => DerivedSource::Ground(OfGround::Peak),
        Derived::RecordPGAVertical => DerivedSource::Ground(OfGround::VerticalPeak),
        Derived::RecordEnd => DerivedSource::Ground(OfGround::End),
    }
}

/// A parameter calculated from the records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfGround {
    /// Peak acceleration of the horizontal record (m/s²).
    Peak,
    /// Peak acceleration of the vertical record (m/s²).
    VerticalPeak,
    /// Time of the last sample (s).
    End,
}

impl OfGround {
    /// Returns its value.
    pub fn value(self, ground: &Ground) -> f64 {
        let greatest = |record: &Option<Record>| record.as_ref().map_or(0.0, |record| record.peak().acceleration.abs());
        match self {
            OfGround::Peak => greatest(&ground.horizontal),
            OfGround::VerticalPeak => greatest(&ground.vertical),
            OfGround::End => ground.end().unwrap_or(0.0),
        }
    }
}
