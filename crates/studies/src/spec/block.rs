//! Parameters of a block, some of them given → a checked block.

use crate::spec::words::friction;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{
    Block, BlockError, Common, Dimensionless, Foundation, Parameterization, Physical, Ratios, Springs, Supports,
};

use crate::spec::SpecError;
#[cfg(feature = "clap")]
use crate::spec::tie;

/// The parameters of a block as a user gives them; others have their defaults, or follow.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Block"))]
pub struct BlockSpec {
    /// Slenderness angle alpha [rad] [default: 0.25]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD"))]
    pub alpha: Option<f64>,
    /// Frequency parameter p [rad/s] [default: 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD/S"))]
    pub p: Option<f64>,
    /// Stiffness ratio eta = omega_v/p of the supports [default: 40]
    #[cfg_attr(feature = "clap", arg(long))]
    pub eta: Option<f64>,
    /// Vertical damping ratio xi_v of the supports [default: 0.1]
    #[cfg_attr(feature = "clap", arg(long))]
    pub xi_v: Option<f64>,
    /// Width of the base; with --height, --stiffness, --damping and --mass it replaces alpha, p, eta and xi_v [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub width: Option<f64>,
    /// Twice the height of the centre of mass above the base [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub height: Option<f64>,
    /// Height of the centre of mass above the base, instead of --height [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub center_height: Option<f64>,
    /// Centroidal moment of inertia I0, instead of --gamma; with --width and --mass [kg.m2]
    #[cfg_attr(feature = "clap", arg(long, value_name = "KG.M2"))]
    pub inertia: Option<f64>,
    /// Stiffness K of one support; not on a rigid base [N/m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N/M"))]
    pub stiffness: Option<f64>,
    /// Damping C of one support; not on a rigid base [N.s/m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N.S/M"))]
    pub damping: Option<f64>,
    /// Mass M; it changes the motion only together with --stiffness, --inertia, --tie or --damper [kg] [default: 1000]
    #[cfg_attr(feature = "clap", arg(long, value_name = "KG"))]
    pub mass: Option<f64>,
    /// Shape factor gamma = M R0²/I0 [default: 3]
    #[cfg_attr(feature = "clap", arg(long))]
    pub gamma: Option<f64>,
    /// Restitution epsilon of the landing corner, from 0 to 1 [default: 0]
    #[cfg_attr(feature = "clap", arg(long))]
    pub epsilon: Option<f64>,
    /// Gravitational acceleration, also for records in g [m/s2] [default: 9.81]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M/S2"))]
    pub g: Option<f64>,
    /// Foundation under the block [default: viscoelastic]
    #[cfg_attr(feature = "clap", arg(long, value_parser = foundations()))]
    pub foundation: Option<Foundation>,
    /// Factor on Housner's restitution e of the rigid base; their product is at most 1 [default: 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "FACTOR"))]
    pub restitution_factor: Option<f64>,
    /// Eccentricity, friction, ties and dampers.
    #[cfg_attr(feature = "clap", command(flatten))]
    pub hold: HoldSpec,
}

/// Eccentricity, friction, ties and dampers of a block as a user gives them.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct HoldSpec {
    /// Distance of the centre of mass from the middle of the base, positive to the right [m] [default: 0]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", allow_hyphen_values = true))]
    pub eccentricity: Option<f64>,
    /// Coulomb's coefficient of friction of the feet; without a limit they do not slide [default: none]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MU", value_parser = friction_of_text))]
    pub friction: Option<f64>,
    /// A tie to the ground: block_x, block_z and ground_x, ground_z are its ends, from the middle of the base at rest [m];
    /// stiffness [N/m], pretension [N], slack [m], damping [N.s/m], strength [N], yield_force [N] and hardening, the stiffness after
    /// yielding over that before; others are 0, and a tie without strength or yield force neither breaks nor yields. One option per tie
    #[cfg_attr(
        feature = "clap",
        arg(long = "tie", value_name = "KEY=NUMBER,...", value_parser = tie::tie, allow_hyphen_values = true)
    )]
    pub ties: Vec<Tie>,
    /// A damper to the ground, which pulls and pushes, with the numbers of a tie but pretension and slack. One option per damper
    #[cfg_attr(
        feature = "clap",
        arg(long = "damper", value_name = "KEY=NUMBER,...", value_parser = tie::damper, allow_hyphen_values = true)
    )]
    pub dampers: Vec<Tie>,
}

impl HoldSpec {
    /// Returns the same with these ties and dampers.
    pub fn with_links(self, links: &[Tie]) -> HoldSpec {
        let (ties, dampers) = links.iter().partition(|tie| tie.kind == LinkKind::Tie);
        HoldSpec { ties, dampers, ..self }
    }

    /// Returns the ties and dampers.
    pub fn links(&self) -> Vec<Tie> {
        [&self.ties[..], &self.dampers].concat()
    }

    /// Returns these parameters with this eccentricity (m) and friction (1).
    ///
    /// # Errors
    /// A friction of zero or below.
    pub fn common(&self, common: Common) -> Result<Common, BlockError> {
        let friction = friction::of_user(self.friction.unwrap_or(f64::INFINITY))?;
        Ok(Common { eccentricity: self.eccentricity.unwrap_or(0.0), friction, ..common })
    }
}

impl BlockSpec {
    /// What a parameter is if it is not given, and does not follow from others.
    pub const DEFAULT: BlockSpec = BlockSpec {
        alpha: Some(0.25),
        p: Some(1.0),
        eta: Some(40.0),
        xi_v: Some(0.1),
        width: None,
        height: None,
        center_height: None,
        inertia: None,
        stiffness: None,
        damping: None,
        mass: Some(1000.0),
        gamma: Some(3.0),
        epsilon: Some(0.0),
        g: Some(9.81),
        foundation: Some(Foundation::Viscoelastic),
        restitution_factor: Some(1.0),
        hold: HoldSpec {
            eccentricity: Some(0.0),
            friction: Some(f64::INFINITY),
            ties: Vec::new(),
            dampers: Vec::new(),
        },
    };

    /// Returns the numbers to state for this block: those that are no defaults, and the mass if it has an effect.
    pub fn said(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let needs_mass = self.needs_mass().is_some();
        self.numbers().into_iter().zip(BlockSpec::DEFAULT.numbers()).filter_map(move |((name, value), (_, default))| {
            let is_said = value != default || (name == "mass" && needs_mass);
            value.filter(|_| is_said).map(|value| (name, value))
        })
    }

    /// The first given parameter whose effect depends on the mass, and why.
    fn needs_mass(&self) -> Option<(&'static str, &'static str)> {
        let depends = [
            ("K", self.stiffness.is_some(), "`mass`; expected both, since eta and xi_v depend on the mass"),
            ("inertia", self.inertia.is_some(), "`mass`; expected both, since p depends on the mass"),
            (
                "ties",
                !self.hold.ties.is_empty(),
                "`mass`; expected both, since the effect of a tie depends on the mass",
            ),
            (
                "dampers",
                !self.hold.dampers.is_empty(),
                "`mass`; expected both, since the effect of a damper depends on the mass",
            ),
        ];
        depends.into_iter().find_map(|(name, is_given, why)| is_given.then_some((name, why)))
    }

    /// Returns the numbers that are given, by their names, in the units of the fields.
    pub fn numbers(&self) -> [(&'static str, Option<f64>); 17] {
        let BlockSpec { alpha, p, eta, xi_v, width, height, center_height, inertia, stiffness, damping, .. } = *self;
        let BlockSpec { mass, gamma, epsilon, g, foundation: _, restitution_factor, .. } = *self;
        let HoldSpec { eccentricity, friction, ties: _, dampers: _ } = self.hold;
        [
            ("alpha", alpha),
            ("p", p),
            ("eta", eta),
            ("xi_v", xi_v),
            ("width", width),
            ("height", height),
            ("center_height", center_height),
            ("inertia", inertia),
            ("K", stiffness),
            ("C", damping),
            ("mass", mass),
            ("gamma", gamma),
            ("epsilon", epsilon),
            ("g", g),
            ("restitution_factor", restitution_factor),
            ("eccentricity", eccentricity),
            ("friction", friction),
        ]
    }

    /// The foundation.
    pub fn foundation(&self) -> Foundation {
        self.foundation.unwrap_or(Foundation::Viscoelastic)
    }

    /// The gravitational acceleration (m/s²).
    pub fn gravity(&self) -> f64 {
        self.number(|spec| spec.g)
    }

    /// A number that has a default.
    fn number(&self, field: fn(&BlockSpec) -> Option<f64>) -> f64 {
        field(self).or(field(&BlockSpec::DEFAULT)).unwrap_or(f64::NAN)
    }

    /// Returns the height of the body (m). It is unknown if only that of its centre of mass is given.
    pub fn body_height(&self, block: &Block) -> Option<f64> {
        self.center_height.is_none().then_some(2.0 * block.h)
    }

    /// Returns the block.
    ///
    /// # Errors
    /// The first parameter that would not be read, that needs another one, or that is out of range.
    pub fn block(&self) -> Result<Block, SpecError> {
        let (parameterization, common) = self.parameters()?;
        let block = Block::from_parameters(&parameterization, &common)?.with_ties(&self.hold.links())?;
        match self.needs_mass() {
            Some((parameter, missing)) if self.mass.is_none() => Err(SpecError::Lacks { parameter, missing }),
            _ => Ok(block),
        }
    }

    /// Returns the parameters in the parameterization of the user.
    ///
    /// # Errors
    /// The first parameter that would not be read, or that needs another one.
    pub fn parameters(&self) -> Result<(Parameterization, Common), SpecError> {
        self.refuse_without_effect()?;
        let common = self.hold.common(Common {
            mass: self.number(|spec| spec.mass),
            gamma: self.number(|spec| spec.gamma),
            epsilon: self.number(|spec| spec.epsilon),
            gravity: self.gravity(),
            ..Common::default()
        })?;
        let restitution_factor = self.number(|spec| spec.restitution_factor);
        let Some(width) = self.width else {
            let supports = match self.foundation() {
                Foundation::Viscoelastic => Supports::Viscoelastic(Ratios {
                    eta: self.number(|spec| spec.eta),
                    xi_v: self.number(|spec| spec.xi_v),
                }),
                Foundation::Rigid => Supports::Rigid { restitution_factor },
            };
            let (alpha, p) = (self.number(|spec| spec.alpha), self.number(|spec| spec.p));
            return Ok((Parameterization::Dimensionless(Dimensionless { alpha, p, supports }), common));
        };
        let lacks = |missing| SpecError::Lacks { parameter: "width", missing };
        let height = self.center_height.map(|height| 2.0 * height).or(self.height);
        let height = height.ok_or(lacks("`height`; expected both, or `center_height`"))?;
        let supports = match (self.foundation(), self.stiffness, self.damping) {
            (Foundation::Viscoelastic, Some(stiffness), Some(damping)) => {
                Supports::Viscoelastic(Springs { stiffness, damping })
            }
            (Foundation::Viscoelastic, ..) => {
                return Err(lacks("`K` and `C`; expected both and `mass`, or `foundation = rigid`"));
            }
            (Foundation::Rigid, ..) => Supports::Rigid { restitution_factor },
        };
        Ok((Parameterization::Physical(Physical { width, height, supports, inertia: self.inertia }), common))
    }

    /// Refuses parameters that would not be read.
    fn refuse_without_effect(&self) -> Result<(), SpecError> {
        let on_supports = self.foundation() == Foundation::Viscoelastic;
        let has_size = self.width.is_some();
        let rules: [(bool, &[&str], &str); 6] = [
            (!on_supports, &["eta", "xi_v", "K", "C"], "on a rigid base"),
            (on_supports, &["restitution_factor"], "on viscoelastic supports; expected `foundation = rigid`"),
            (has_size, &["alpha", "p", "eta", "xi_v"], "with `width`"),
            (!has_size, &["height", "center_height", "inertia", "K", "C"], "without `width`"),
            (self.center_height.is_some(), &["height"], "with `center_height`"),
            (self.inertia.is_some(), &["gamma"], "with `inertia`"),
        ];
        for (holds, names, why) in rules {
            let mut given = self.numbers().into_iter().filter(|(name, value)| value.is_some() && names.contains(name));
            if let (true, Some((parameter, _))) = (holds, given.next()) {
                return Err(SpecError::NoEffect { parameter, why });
            }
        }
        Ok(())
    }
}

/// Reads a friction in the convention of users.
#[cfg(feature = "clap")]
fn friction_of_text(text: &str) -> Result<f64, String> {
    friction::parse(text).map(friction::to_user)
}

/// The words of foundations as options, with a line of help for each.
#[cfg(feature = "clap")]
pub fn foundations() -> impl clap::builder::TypedValueParser<Value = Foundation> {
    super::choices(|foundation| match foundation {
        Foundation::Viscoelastic => "A spring and a dashpot under each corner",
        Foundation::Rigid => "Housner's rigid base",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::unit::values::Values;

    fn refused(spec: BlockSpec) -> String {
        spec.block().unwrap_err().spelled(|name| format!("<{name}>"))
    }

    /// A number that a user must say is said, the mass even where it is that of the default.
    #[test]
    fn the_mass_is_said_where_something_depends_on_it() {
        let default = BlockSpec::DEFAULT;
        assert_eq!(default.said().count(), 0);
        let springs = BlockSpec { width: Some(1.0), stiffness: Some(1e7), ..default.clone() };
        assert_eq!(springs.said().collect::<Vec<_>>(), [("width", 1.0), ("K", 1e7), ("mass", 1000.0)]);
        let tied = BlockSpec { hold: HoldSpec { ties: vec![Tie::default()], ..HoldSpec::default() }, ..default };
        assert_eq!(tied.said().collect::<Vec<_>>(), [("mass", 1000.0)]);
    }

    /// What a user leaves out has the start value of the FMU.
    #[test]
    fn defaults_are_those_of_the_fmu() {
        let rigid = BlockSpec { foundation: Some(Foundation::Rigid), ..BlockSpec::default() };
        let mut values = Values::default();
        assert_eq!(BlockSpec::default().block().unwrap(), values.block().unwrap());
        values[rocking_block::unit::variables::Variable::Foundation] = 2.0;
        assert_eq!(rigid.block().unwrap(), values.block().unwrap());
    }

    #[test]
    fn parameters_without_effect_are_refused() {
        let sized = BlockSpec { width: Some(1.0), height: Some(3.0), ..BlockSpec::default() };
        let springs = BlockSpec { stiffness: Some(1e7), damping: Some(1e4), mass: Some(1e3), ..sized.clone() };
        let rigid = BlockSpec { foundation: Some(Foundation::Rigid), ..sized.clone() };
        assert!(springs.block().is_ok() && rigid.block().is_ok());
        let some = Some(0.5);
        for (spec, message) in [
            (BlockSpec { xi_v: some, ..rigid.clone() }, "<xi_v> has no effect on a rigid base"),
            (
                BlockSpec { restitution_factor: some, ..springs.clone() },
                "<restitution_factor> has no effect on viscoelastic supports; expected <foundation = rigid>",
            ),
            (BlockSpec { alpha: some, ..rigid.clone() }, "<alpha> has no effect with <width>"),
            (BlockSpec { inertia: some, ..BlockSpec::default() }, "<inertia> has no effect without <width>"),
            (BlockSpec { center_height: some, ..rigid.clone() }, "<height> has no effect with <center_height>"),
            (BlockSpec { inertia: some, gamma: Some(3.0), ..rigid.clone() }, "<gamma> has no effect with <inertia>"),
            (sized.clone(), "<width> without <K> and <C>; expected both and <mass>, or <foundation = rigid>"),
            (
                BlockSpec { width: some, ..BlockSpec::default() },
                "<width> without <height>; expected both, or <center_height>",
            ),
            (
                BlockSpec { mass: None, ..springs.clone() },
                "<K> without <mass>; expected both, since eta and xi_v depend on the mass",
            ),
            (
                BlockSpec { inertia: Some(1e3), ..rigid.clone() },
                "<inertia> without <mass>; expected both, since p depends on the mass",
            ),
            (
                BlockSpec { alpha: Some(-0.2), ..BlockSpec::default() },
                "alpha = -0.2 is not valid; expected 0 < alpha < pi/2 rad",
            ),
        ] {
            assert_eq!(refused(spec), message);
        }
    }

    #[test]
    fn a_tie_needs_the_mass() {
        let tie = Tie { ground: [3.0, 0.0], block: [0.0, 2.0], stiffness: 1e5, ..Tie::default() };
        let mut spec = BlockSpec { hold: HoldSpec { ties: vec![tie], ..HoldSpec::default() }, ..BlockSpec::default() };
        assert!(refused(spec.clone()).starts_with("<ties> without <mass>; expected both"));
        spec.mass = Some(1000.0);
        assert_eq!(spec.block().unwrap().ties(), [tie]);
    }
}
