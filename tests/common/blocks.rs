//! Blocks for tests.

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, PulseShape, Ramp};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::{VARIABLES, Variable};

/// Returns a block with the parameters `[α (rad), p (rad/s), η, ξ_v]`.
pub fn block([alpha, p, eta, xi_v]: [f64; 4], common: &Common) -> Block {
    block_on(Foundation::Viscoelastic, [alpha, p, eta, xi_v], common)
}

/// Returns a block with the parameters `[α (rad), p (rad/s), η, ξ_v]`; a rigid base takes the first two.
pub fn block_on(foundation: Foundation, [alpha, p, eta, xi_v]: [f64; 4], common: &Common) -> Block {
    let supports = Supports::of(foundation, Ratios { eta, xi_v });
    Block::from_dimensionless(&Dimensionless { alpha, p, supports }, common).unwrap()
}

/// Returns a homogeneous block of 1000 kg on supports.
pub fn supported(alpha: f64, p: f64, eta: f64, xi_v: f64, epsilon: f64) -> Block {
    block([alpha, p, eta, xi_v], &Common { epsilon, ..Common::default() })
}

/// Returns a homogeneous block of 1000 kg on the rigid base.
pub fn rigid(alpha: f64, p: f64, epsilon: f64) -> Block {
    block_on(Foundation::Rigid, [alpha, p, f64::NAN, f64::NAN], &Common { epsilon, ..Common::default() })
}

/// Returns a homogeneous block of 1000 kg that lands without rebound.
pub fn on(foundation: Foundation, alpha: f64, p: f64, eta: f64, xi_v: f64) -> Block {
    block_on(foundation, [alpha, p, eta, xi_v], &Common::default())
}

/// Returns a squat block on soft, overdamped supports: corners are held, and slide.
pub fn squat(common: &Common) -> Block {
    block([0.9, 1.0, 8.0, 1.5], common)
}

/// Returns a block without round numbers, whose parameters cannot be mistaken for one another.
pub fn uneven(foundation: Foundation, xi_v: f64) -> Block {
    let common = Common { mass: 7.0, gamma: 2.3, epsilon: 0.35, ..Common::default() };
    block_on(foundation, [0.42, 1.7, 11.0, xi_v], &common)
}

/// Returns the block of the figures of the paper and of most reference trajectories.
pub fn plain() -> Block {
    supported(0.25, 1.0, 40.0, 0.1, 0.0)
}

/// Returns all shapes of pulses except `none`.
pub fn shapes() -> Vec<PulseShape> {
    let items = VARIABLES.iter().find(|metadata| metadata.variable == Variable::PulseShape).unwrap().items;
    let shape = |&(number, _): &(i32, &str)| {
        let mut values = Values::default();
        values[Variable::PulseShape] = f64::from(number);
        values.pulse().shape
    };
    items.iter().map(shape).filter(|&shape| shape != PulseShape::None).collect()
}

/// Returns ramps of all inputs.
pub fn ramps() -> Inputs {
    let ramp = |value, rate| Ramp { value, rate };
    Inputs {
        time: 0.2,
        a_gx: ramp(1.3, -2.0),
        a_gz: ramp(-0.8, 1.5),
        f_x: ramp(2.0, 11.0),
        f_z: ramp(-3.0, 5.0),
        m_y: ramp(1.1, -4.0),
    }
}
