//! The ties and dampers among the variables: their names and the variables of their parameters.

use crate::block::restraints::{LinkKind, Tie, tie};
use crate::unit::variables::Variable;

/// A tie or damper among the variables: its name and its parameters. A damper has no variables of pretension and slack, which are 0.
pub type LinkVariables = (&'static str, Tie<Option<Variable>>);

/// The ties and dampers among the variables, in the order of their numbers.
pub const LINKS: [LinkVariables; tie::VARIABLES] = [
    (
        "tie_1",
        Tie {
            block: [Some(Variable::Tie1BlockX), Some(Variable::Tie1BlockZ)],
            ground: [Some(Variable::Tie1GroundX), Some(Variable::Tie1GroundZ)],
            stiffness: Some(Variable::Tie1Stiffness),
            pretension: Some(Variable::Tie1Pretension),
            slack: Some(Variable::Tie1Slack),
            damping: Some(Variable::Tie1Damping),
            strength: Some(Variable::Tie1Strength),
            yield_force: Some(Variable::Tie1YieldForce),
            hardening: Some(Variable::Tie1Hardening),
            kind: LinkKind::Tie,
        },
    ),
    (
        "tie_2",
        Tie {
            block: [Some(Variable::Tie2BlockX), Some(Variable::Tie2BlockZ)],
            ground: [Some(Variable::Tie2GroundX), Some(Variable::Tie2GroundZ)],
            stiffness: Some(Variable::Tie2Stiffness),
            pretension: Some(Variable::Tie2Pretension),
            slack: Some(Variable::Tie2Slack),
            damping: Some(Variable::Tie2Damping),
            strength: Some(Variable::Tie2Strength),
            yield_force: Some(Variable::Tie2YieldForce),
            hardening: Some(Variable::Tie2Hardening),
            kind: LinkKind::Tie,
        },
    ),
    (
        "damper_1",
        Tie {
            block: [Some(Variable::Damper1BlockX), Some(Variable::Damper1BlockZ)],
            ground: [Some(Variable::Damper1GroundX), Some(Variable::Damper1GroundZ)],
            stiffness: Some(Variable::Damper1Stiffness),
            pretension: None,
            slack: None,
            damping: Some(Variable::Damper1Damping),
            strength: Some(Variable::Damper1Strength),
            yield_force: Some(Variable::Damper1YieldForce),
            hardening: Some(Variable::Damper1Hardening),
            kind: LinkKind::Damper,
        },
    ),
    (
        "damper_2",
        Tie {
            block: [Some(Variable::Damper2BlockX), Some(Variable::Damper2BlockZ)],
            ground: [Some(Variable::Damper2GroundX), Some(Variable::Damper2GroundZ)],
            stiffness: Some(Variable::Damper2Stiffness),
            pretension: None,
            slack: None,
            damping: Some(Variable::Damper2Damping),
            strength: Some(Variable::Damper2Strength),
            yield_force: Some(Variable::Damper2YieldForce),
            hardening: Some(Variable::Damper2Hardening),
            kind: LinkKind::Damper,
        },
    ),
];
