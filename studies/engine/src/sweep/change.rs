//! A block → the same block with another base, foundation, friction or ties; in space without ties.

use crate::input::parameters::Parameter;
use crate::run::outcome::Holds;
use crate::space::facts;
use crate::spec::SpecError;
use crate::spec::numbers_in_space::{NumbersInSpace, SpaceNumber};
use rocking_block::block::restraints::{LinkKind, Tie, tie};
use rocking_block::block::{Block, BlockError, BlockParameters, Body, KelvinVoigt, Outline, Springs, Supports};
use rocking_block::space::{Base, BaseSize, FootPlace, SpaceBody, SpaceParameters, SpaceSupports};
use rocking_block::unit::links::LINKS;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// Slack of a tie over R0, that of a strap tightened by hand.
const SLACK: f64 = 0.01;

/// Stiffness of a damper over M g/R0.
const DAMPER_STIFFNESS: f64 = 10.0;

/// Stiffness of a damper that yields over that before, as that of steel in bending.
const HARDENING: f64 = 0.03;

/// A change of each block of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Another value of a parameter, in its unit.
    Parameter(Variable, f64),
    /// Another value of a number of a block in space, in its unit.
    Number(&'static SpaceNumber, f64),
    /// A factor on the width of the base, in space also on its depth. Mass, inertia, height of the centre of mass, supports and ties stay.
    Width(f64),
    /// A factor on the stiffness ratio η; ξ_v stays.
    StiffnessRatio(f64),
    /// A factor on the damping ratio ξ_v.
    DampingRatio(f64),
    /// A coefficient of friction over the static threshold (b − |e_x|)/h of the block. Below 1 the block slides before it rocks.
    FrictionOverThreshold(f64),
    /// A horizontal tie to each side at twice the height of the centre of mass. Its anchor, at a distance of h, moves with the ground. The
    /// stiffness (M g/R0) is the number; the ties have a slack of R0/100, no pretension, and do not break, unless [`Change::Parameter`]
    /// beside it says so: `tie_1` is the first tie of the block, that on the left if it had none.
    Tied(f64),
    /// A damper under each corner, as stiff as ten times M g/R0. Its anchor, at a depth of half the width, moves with the ground. The
    /// number is its yield force over the weight M g; the hardening is 0.03, and it does not break, unless [`Change::Parameter`] beside it
    /// says so: `damper_1` is the first damper of the block, that on the left if it had none.
    Damped(f64),
}

impl Change {
    /// Another value of a parameter of a study, in the plane or in space.
    pub(crate) fn of_parameter(parameter: &Parameter, value: f64) -> Change {
        match (parameter.variable(), parameter.in_space_number()) {
            (Some(variable), _) => Change::Parameter(variable, value),
            (None, Some(number)) => Change::Number(number, value),
            (None, None) => unreachable!("{} is a variable or a number", parameter.name()),
        }
    }

    /// The parameter that it changes, if it is one.
    pub(super) fn parameter(self) -> Option<Variable> {
        match self {
            Change::Parameter(variable, _) => Some(variable),
            Change::Number(..)
            | Change::Width(_)
            | Change::StiffnessRatio(_)
            | Change::DampingRatio(_)
            | Change::FrictionOverThreshold(_)
            | Change::Tied(_)
            | Change::Damped(_) => None,
        }
    }

    /// The values with the change, if it is one of a parameter.
    pub(super) fn values(self, mut values: Values) -> Values {
        if let Change::Parameter(variable, value) = self {
            values[variable] = value;
        }
        values
    }

    /// The block with the change, one of `changes`.
    ///
    /// # Errors
    /// The first parameter that is no longer valid.
    pub fn block(self, block: Block, changes: &[Change]) -> Result<Block, BlockError> {
        let Body { b, h, r0, mass, gravity, .. } = block.body;
        match self {
            Change::Parameter(..) | Change::Number(..) => Ok(block),
            Change::Width(factor) => {
                rebuilt(&Block { body: Body { b: b * factor, ..block.body }, ..block }, block.springs())
            }
            Change::StiffnessRatio(factor) => {
                let softer = |Springs { stiffness, damping }| Springs {
                    stiffness: stiffness * factor * factor,
                    damping: damping * factor,
                };
                rebuilt(&block, block.springs().with(softer))
            }
            Change::DampingRatio(factor) => {
                let damped = |springs: Springs| Springs { damping: springs.damping * factor, ..springs };
                rebuilt(&block, block.springs().with(damped))
            }
            Change::FrictionOverThreshold(ratio) => {
                let friction = ratio * (b - block.eccentricity.abs()) / h;
                rebuilt(&Block { body: Body { friction, ..block.body }, ..block }, block.springs())
            }
            Change::Tied(ratio) => {
                let side = |sign: f64| Tie {
                    block: [sign * b, 2.0 * h],
                    ground: [sign * (b + h), 2.0 * h],
                    stiffness: ratio * mass * gravity / r0,
                    slack: SLACK * r0,
                    ..Tie::default()
                };
                with_links(block, [side(-1.0), side(1.0)], changes)
            }
            Change::Damped(ratio) => {
                let side = |sign: f64| Tie {
                    block: [sign * b, 0.0],
                    ground: [sign * b, -b],
                    stiffness: DAMPER_STIFFNESS * mass * gravity / r0,
                    yield_force: ratio * mass * gravity,
                    hardening: HARDENING,
                    kind: LinkKind::Damper,
                    ..Tie::default()
                };
                with_links(block, [side(-1.0), side(1.0)], changes)
            }
        }
    }

    /// Makes the change of a number of a block in space, if it is one.
    pub(super) fn number(self, numbers: &mut NumbersInSpace) {
        if let Change::Number(number, value) = self {
            *numbers.number_mut(number) = Some(value);
        }
    }

    /// The parameters of a block in space with the change.
    ///
    /// # Errors
    /// Ties and dampers, which only a block in the plane has.
    pub(super) fn in_space(self, parameters: SpaceParameters, body: &SpaceBody) -> Result<SpaceParameters, SpecError> {
        let feet = |stiffness: f64, damping: f64| SpaceSupports::OfFoot { stiffness, damping };
        let (stiffness, damping) = (body.stiffness, body.damping);
        let of_plane = |parameter| Err(SpecError::OfPlane { parameter, instead: "expected a change without it" });
        match self {
            Change::Parameter(..) | Change::Number(..) => Ok(parameters),
            Change::Width(factor) => {
                let size =
                    BaseSize::Lengths { width: 2.0 * body.half_width * factor, center_height: body.center_height };
                let base = match parameters.base {
                    Base::Rectangle { depth_ratio, .. } => Base::Rectangle { size, depth_ratio },
                    Base::Circle { feet, .. } => Base::Circle { size, feet },
                    Base::List { feet, center_height } => {
                        let wider = |foot: FootPlace| FootPlace { x: factor * foot.x, y: factor * foot.y, ..foot };
                        Base::List { feet: feet.into_iter().map(wider).collect(), center_height }
                    }
                };
                let inertia = Some(facts::inertia(body));
                Ok(SpaceParameters { base, supports: feet(stiffness, damping), inertia, ..parameters })
            }
            Change::StiffnessRatio(factor) => {
                let supports = feet(stiffness * factor * factor, damping * factor);
                Ok(SpaceParameters { supports, ..parameters })
            }
            Change::DampingRatio(factor) => {
                Ok(SpaceParameters { supports: feet(stiffness, damping * factor), ..parameters })
            }
            Change::FrictionOverThreshold(ratio) => {
                Ok(SpaceParameters { friction: ratio * body.edge_distance / body.center_height, ..parameters })
            }
            Change::Tied(_) => of_plane("ties"),
            Change::Damped(_) => of_plane("dampers"),
        }
    }

    /// Friction and ties of blocks with the change.
    pub(super) fn holds(self, holds: Holds) -> Holds {
        match self {
            Change::Parameter(Variable::Friction, value) => Holds { friction: value > 0.0, ..holds },
            Change::FrictionOverThreshold(_) => Holds { friction: true, ..holds },
            Change::Tied(_) => Holds { ties: holds.ties + 2, ..holds },
            Change::Damped(_) => Holds { dampers: holds.dampers + 2, yields: true, ..holds },
            Change::Parameter(variable, value) => holds.or(holds_of_variables(|of| of == variable && value > 0.0)),
            Change::Number(..) | Change::Width(_) | Change::StiffnessRatio(_) | Change::DampingRatio(_) => holds,
        }
    }
}

/// Ties and dampers of blocks whose variables may be above zero where `is_positive` says so.
pub(super) fn holds_of_variables(is_positive: impl Fn(Variable) -> bool) -> Holds {
    let is = |variable: Option<Variable>| variable.is_some_and(&is_positive);
    let last = |kind| {
        let of_kind = LINKS.iter().filter(|(_, tie)| tie.kind == kind);
        (1..).zip(of_kind).filter(|(_, (_, tie))| is(tie.stiffness)).map(|(number, _)| number).last().unwrap_or(0)
    };
    Holds {
        friction: is(Some(Variable::Friction)),
        ties: last(LinkKind::Tie),
        dampers: last(LinkKind::Damper),
        yields: LINKS.iter().any(|(_, tie)| is(tie.yield_force)),
    }
}

/// The block with two more ties or dampers. `changes` may give their parameters.
fn with_links(block: Block, added: [Tie; 2], changes: &[Change]) -> Result<Block, BlockError> {
    let mut ties = [block.ties(), &added].concat();
    for change in changes {
        let Change::Parameter(variable, value) = *change else { continue };
        if let Some(field) = tie_field(&mut ties, variable) {
            *field = value;
        }
    }
    block.with_ties(&ties)
}

/// The field of a parameter of a tie of [`Change::Tied`] or a damper of [`Change::Damped`]. Ends and stiffness follow from the block, and
/// so does the yield force of a damper.
pub(super) fn tie_field(ties: &mut [Tie], variable: Variable) -> Option<&mut f64> {
    let names = tie::names(ties);
    let (name, key) = variable.name().split_once('.')?;
    let tie = &mut ties[names.iter().position(|known| known == name)?];
    let is_given = match tie.kind {
        LinkKind::Tie => matches!(key, "pretension" | "slack" | "damping" | "strength"),
        LinkKind::Damper => matches!(key, "damping" | "strength" | "hardening"),
    };
    tie.number(key).filter(|_| is_given)
}

/// The block with another half width, friction or supports; mass, inertia and ties are kept.
fn rebuilt(block: &Block, supports: Supports<Springs>) -> Result<Block, BlockError> {
    let outline = Outline::Sizes { width: 2.0 * block.b, height: 2.0 * block.h, inertia: Some(block.inertia()) };
    let supports = supports.with(KelvinVoigt::Springs);
    Block::new(&BlockParameters { outline, supports, common: block.common() })?.with_ties(block.ties())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::{Common, Dimensionless, Ratios};

    fn block() -> Block {
        let dimensionless =
            Dimensionless { alpha: 0.2, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 50.0, xi_v: 0.1 }) };
        Block::from_dimensionless(&dimensionless, &Common::default()).unwrap()
    }

    #[track_caller]
    fn near(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-14, "{value}, expected {expected}");
    }

    #[test]
    fn a_change_leaves_the_rest_of_the_block() {
        let before = block();
        let wider = Change::Width(1.1).block(before, &[]).unwrap();
        near(wider.b, 1.1 * before.b);
        near(libm::tan(wider.alpha), 1.1 * libm::tan(before.alpha));
        for of in [|b: &Block| b.h, |b: &Block| b.inertia(), |b: &Block| b.stiffness, |b: &Block| b.omega_v] {
            near(of(&wider), of(&before));
        }
        let softer = Change::StiffnessRatio(0.5).block(before, &[]).unwrap();
        near(softer.eta(), 25.0);
        near(softer.xi_v, 0.1);
        near(softer.p, 2.0);
        near(Change::DampingRatio(2.0).block(before, &[]).unwrap().xi_v, 0.2);
        let sliding = Change::FrictionOverThreshold(0.8).block(before, &[]).unwrap();
        near(sliding.friction, 0.8 * libm::tan(0.2));
        near(sliding.p, 2.0);
    }

    #[test]
    fn a_change_in_space_leaves_the_rest_of_the_block() {
        let size = BaseSize::Lengths { width: 0.6, center_height: 1.5 };
        let supports = SpaceSupports::OfRocking { eta: 50.0, xi_v: 0.1 };
        let base = Base::Rectangle { size, depth_ratio: 1.5 };
        let parameters = SpaceParameters { base, supports, kappa: 0.7, friction: 0.6, ..SpaceParameters::default() };
        let before = SpaceBody::new(&parameters).unwrap();
        let changed =
            |change: Change| SpaceBody::new(&change.in_space(parameters.clone(), &before)?).map_err(SpecError::from);
        let wider = changed(Change::Width(1.2)).unwrap();
        for (foot, old) in wider.feet.iter().zip(&before.feet) {
            near(foot.place.x, 1.2 * old.place.x);
            near(foot.place.y, 1.2 * old.place.y);
        }
        let springs =
            |body: &SpaceBody| [body.stiffness, body.damping, body.horizontal_stiffness, body.horizontal_damping];
        springs(&wider).into_iter().zip(springs(&before)).for_each(|(new, old)| near(new, old));
        assert_eq!((wider.inertia, wider.mass, wider.friction), (before.inertia, before.mass, 0.6));
        let softer = changed(Change::StiffnessRatio(0.5)).unwrap();
        let factors = [0.25, 0.5, 0.25, 0.5];
        springs(&softer)
            .into_iter()
            .zip(springs(&before))
            .zip(factors)
            .for_each(|((new, old), factor)| near(new, factor * old));
        near(softer.xi_v, 0.1);
        near(changed(Change::DampingRatio(2.0)).unwrap().xi_v, 0.2);
        near(changed(Change::FrictionOverThreshold(0.8)).unwrap().friction, 0.8 * 0.3 / 1.5);
        let message = changed(Change::Tied(5.0)).unwrap_err().spelled(str::to_owned);
        assert_eq!(message, "ties is for a block in the plane; expected a change without it");
    }

    /// The ties of a tilted block pull it back. Their moment about the corner grows with the stiffness.
    #[test]
    fn ties_join_those_of_the_block() {
        let once = Change::Tied(5.0).block(block(), &[]).unwrap();
        let twice = Change::Tied(5.0).block(once, &[]).unwrap();
        assert_eq!([once, twice].map(|block| block.ties().len()), [2, 4]);
        let [left, right] = [once.ties()[0], once.ties()[1]];
        assert_eq!(left.block[0], -right.block[0]);
        near(right.stiffness, 5.0 * once.mass * once.gravity / once.r0);
        near(right.ground[0] - right.block[0], once.h);
    }

    #[test]
    fn parameters_beside_ties_are_theirs() {
        let changes = [
            Change::Tied(5.0),
            Change::Parameter(Variable::Tie1Damping, 300.0),
            Change::Parameter(Variable::Tie2Slack, 0.0),
            Change::Parameter(Variable::Tie2Strength, 7e3),
        ];
        let plain = changes[0].block(block(), &[]).unwrap();
        let [left, right] = [plain.ties()[0], plain.ties()[1]];
        let expected = [Tie { damping: 300.0, ..left }, Tie { slack: 0.0, strength: 7e3, ..right }];
        assert_eq!(changes[0].block(block(), &changes).unwrap().ties(), expected);
        // The second tie of a block that has one is that on the left.
        let tied = block().with_ties(&[right]).unwrap();
        assert_eq!(
            changes[0].block(tied, &changes[2..]).unwrap().ties(),
            [right, Tie { slack: 0.0, strength: 7e3, ..left }, right]
        );
    }
}
