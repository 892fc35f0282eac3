//! A block → the same block with another base, foundation, friction or ties.

use crate::run::outcome::Holds;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, BlockError, Common, Physical};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// Slack of a tie over R0, as that of a strap that was tightened by hand.
const SLACK: f64 = 0.01;

/// A change of each block of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Another value of a parameter, in its unit.
    Parameter(Variable, f64),
    /// A factor on the width of the base; mass, inertia, height of the centre of mass, supports and ties stay.
    Width(f64),
    /// A factor on the stiffness ratio η; ξ_v stays.
    StiffnessRatio(f64),
    /// A factor on the damping ratio ξ_v.
    DampingRatio(f64),
    /// A coefficient of friction over the static threshold (b − |e_x|)/h of the block; below 1 the block slides before it rocks.
    FrictionOverThreshold(f64),
    /// A horizontal tie to each side at twice the height of the centre of mass, to anchors at a distance of h that move with the
    /// ground. The stiffness (M g/R0) is the number; the ties have a slack of R0/100, no pretension, and do not break.
    Tied(f64),
}

impl Change {
    /// The parameter that it changes, if it is one.
    pub(super) fn parameter(self) -> Option<Variable> {
        match self {
            Change::Parameter(variable, _) => Some(variable),
            Change::Width(_)
            | Change::StiffnessRatio(_)
            | Change::DampingRatio(_)
            | Change::FrictionOverThreshold(_)
            | Change::Tied(_) => None,
        }
    }

    /// The values with the change, if it is one of a parameter.
    pub(super) fn values(self, mut values: Values) -> Values {
        if let Change::Parameter(variable, value) = self {
            values[variable] = value;
        }
        values
    }

    /// The block with the change.
    ///
    /// # Errors
    /// The first parameter that is no longer valid.
    pub fn block(self, block: Block) -> Result<Block, BlockError> {
        let Block { b, h, r0, mass, gravity, stiffness, damping, .. } = block;
        match self {
            Change::Parameter(..) => Ok(block),
            Change::Width(factor) => rebuilt(&Block { b: b * factor, ..block }, stiffness, damping),
            Change::StiffnessRatio(factor) => rebuilt(&block, stiffness * factor * factor, damping * factor),
            Change::DampingRatio(factor) => rebuilt(&block, stiffness, damping * factor),
            Change::FrictionOverThreshold(ratio) => {
                let friction = ratio * (b - block.eccentricity.abs()) / h;
                rebuilt(&Block { friction, ..block }, stiffness, damping)
            }
            Change::Tied(ratio) => {
                let side = |sign: f64| Tie {
                    block: [sign * b, 2.0 * h],
                    ground: [sign * (b + h), 2.0 * h],
                    stiffness: ratio * mass * gravity / r0,
                    slack: SLACK * r0,
                    ..Tie::default()
                };
                block.with_ties(&[block.ties(), &[side(-1.0), side(1.0)]].concat())
            }
        }
    }

    /// Friction and ties of blocks with the change.
    pub(super) fn holds(self, Holds { friction, ties }: Holds) -> Holds {
        match self {
            Change::Parameter(Variable::Friction, value) => Holds { friction: value > 0.0, ties },
            Change::Parameter(Variable::Tie1Stiffness, value) if value > 0.0 => Holds { friction, ties: ties.max(1) },
            Change::Parameter(Variable::Tie2Stiffness, value) if value > 0.0 => Holds { friction, ties: 2 },
            Change::FrictionOverThreshold(_) => Holds { friction: true, ties },
            Change::Tied(_) => Holds { friction, ties: ties + 2 },
            Change::Parameter(..) | Change::Width(_) | Change::StiffnessRatio(_) | Change::DampingRatio(_) => {
                Holds { friction, ties }
            }
        }
    }
}

/// The block with another half width, friction or supports; mass, inertia and ties are kept.
fn rebuilt(block: &Block, stiffness: f64, damping: f64) -> Result<Block, BlockError> {
    let Block { mass, gravity, gamma, epsilon, foundation, restitution_factor, eccentricity, friction, .. } = *block;
    let common = Common { mass, gamma, epsilon, gravity, foundation, restitution_factor, eccentricity, friction };
    let (width, height) = (2.0 * block.b, 2.0 * block.h);
    let physical = Physical { width, height, stiffness, damping, inertia: Some(block.inertia()) };
    Block::from_physical(&physical, &common)?.with_ties(block.ties())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::Dimensionless;

    fn block() -> Block {
        let dimensionless = Dimensionless { alpha: 0.2, p: 2.0, eta: 50.0, xi_v: 0.1 };
        Block::from_dimensionless(&dimensionless, &Common::default()).unwrap()
    }

    #[track_caller]
    fn near(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-14, "{value}, expected {expected}");
    }

    #[test]
    fn a_change_leaves_the_rest_of_the_block() {
        let before = block();
        let wider = Change::Width(1.1).block(before).unwrap();
        near(wider.b, 1.1 * before.b);
        near(libm::tan(wider.alpha), 1.1 * libm::tan(before.alpha));
        for of in [|b: &Block| b.h, |b: &Block| b.inertia(), |b: &Block| b.stiffness, |b: &Block| b.omega_v] {
            near(of(&wider), of(&before));
        }
        let softer = Change::StiffnessRatio(0.5).block(before).unwrap();
        near(softer.eta(), 25.0);
        near(softer.xi_v, 0.1);
        near(softer.p, 2.0);
        near(Change::DampingRatio(2.0).block(before).unwrap().xi_v, 0.2);
        let sliding = Change::FrictionOverThreshold(0.8).block(before).unwrap();
        near(sliding.friction, 0.8 * libm::tan(0.2));
        near(sliding.p, 2.0);
    }

    /// The ties of a tilted block pull it back: their moment about the corner grows with the stiffness.
    #[test]
    fn ties_join_those_of_the_block() {
        let once = Change::Tied(5.0).block(block()).unwrap();
        let twice = Change::Tied(5.0).block(once).unwrap();
        assert_eq!([once, twice].map(|block| block.ties().len()), [2, 4]);
        let [left, right] = [once.ties()[0], once.ties()[1]];
        assert_eq!(left.block[0], -right.block[0]);
        near(right.stiffness, 5.0 * once.mass * once.gravity / once.r0);
        near(right.ground[0] - right.block[0], once.h);
    }
}
