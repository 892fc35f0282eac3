//! Parameters of a block, some of them given → a checked block.

use std::sync::LazyLock;

use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{
    Block, BlockParameters, Common, Foundation, KelvinVoigt, Outline, Ratios, Springs, Supports,
};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;
use schemars::JsonSchema;

use crate::spec::SpecError;
#[cfg(feature = "clap")]
use crate::spec::tie;
use crate::spec::words::friction;

/// The parameters of a block as a user gives them; others have their defaults, or follow.
///
/// Titles and limits are for pages and reports; [`BlockSpec::block`] checks a block. A fit varies the logarithm of a parameter with a `fit_factor`,
/// by this factor either way.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Block"))]
pub struct BlockSpec {
    /// Slenderness angle alpha [rad] [default: 0.18]
    #[schemars(title = "slenderness α", extend("fit_factor" = 3, "exclusiveMinimum" = 0, "exclusiveMaximum" = std::f64::consts::FRAC_PI_2))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD"))]
    pub alpha: Option<f64>,
    /// Frequency parameter p [rad/s] [default: 2.75]
    #[schemars(title = "frequency parameter p", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD/S"))]
    pub p: Option<f64>,
    /// Stiffness ratio eta = omega_v/p of the supports; beside --width either it or --stiffness is needed [default: 40]
    #[schemars(title = "stiffness ratio η", extend("fit_factor" = 10, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub eta: Option<f64>,
    /// Vertical damping ratio xi_v of the supports [default: 0.1]
    #[schemars(title = "damping ratio ξ_v", range(min = 0), extend("fit_factor" = 10))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub xi_v: Option<f64>,
    /// Width of the base; with --height or --center-height it replaces alpha and p [m]
    #[schemars(title = "width of the base", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub width: Option<f64>,
    /// Twice the height of the centre of mass above the base [m]
    #[schemars(title = "height", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub height: Option<f64>,
    /// Height of the centre of mass above the base, instead of --height [m]
    #[schemars(title = "height of the centre of mass", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub center_height: Option<f64>,
    /// Centroidal moment of inertia I0, instead of --gamma; with --width and --mass [kg.m2]
    #[schemars(title = "moment of inertia I0", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "KG.M2"))]
    pub inertia: Option<f64>,
    /// Stiffness K of one support; with --damping and --mass it replaces eta and xi_v [N/m]
    #[schemars(rename = "K", title = "stiffness K of a support", extend("fit_factor" = 10, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N/M"))]
    pub stiffness: Option<f64>,
    /// Damping C of one support, with --stiffness [N.s/m]
    #[schemars(rename = "C", title = "damping C of a support", range(min = 0), extend("fit_factor" = 10))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N.S/M"))]
    pub damping: Option<f64>,
    /// Mass M; it changes the motion only together with --stiffness, --inertia, --tie or --damper [kg] [default: 1000]
    #[schemars(title = "mass", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "KG"))]
    pub mass: Option<f64>,
    /// Shape factor gamma = M R0²/I0 [default: 3]
    #[schemars(title = "shape factor γ", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub gamma: Option<f64>,
    /// Restitution epsilon of the landing corner, from 0 to 1 [default: 0]
    #[schemars(title = "restitution ε", range(min = 0, max = 1))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub epsilon: Option<f64>,
    /// Gravitational acceleration, also for records in g [m/s2] [default: 9.81]
    #[schemars(title = "gravity", extend("fit_factor" = 1.5, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M/S2"))]
    pub g: Option<f64>,
    /// Foundation under the block [default: viscoelastic]
    #[schemars(skip)]
    #[cfg_attr(feature = "clap", arg(long, value_parser = foundations()))]
    pub foundation: Option<Foundation>,
    /// Factor on Housner's restitution e of the rigid base; their product is at most 1 [default: 1]
    #[schemars(title = "factor on Housner's restitution e", range(min = 0), extend("fit_factor" = 1.5))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "FACTOR"))]
    pub restitution_factor: Option<f64>,
    /// Eccentricity, friction, ties and dampers.
    #[schemars(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    pub hold: HoldSpec,
}

/// Eccentricity, friction, ties and dampers of a block as a user gives them.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct HoldSpec {
    /// Distance of the centre of mass from the middle of the base, positive to the right [m] [default: 0]
    #[schemars(title = "eccentricity e_x")]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", allow_hyphen_values = true))]
    pub eccentricity: Option<f64>,
    /// Coulomb's coefficient of friction of the feet; without a limit they do not slide [default: none]
    #[schemars(title = "friction μ", extend("fit_factor" = 3, "exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MU", value_parser = friction_of_text))]
    pub friction: Option<f64>,
    /// A tie to the ground: block_x, block_z and ground_x, ground_z are its ends, from the middle of the base at rest [m];
    /// stiffness [N/m], pretension [N], slack [m], damping [N.s/m], strength [N], yield_force [N] and hardening, the stiffness after
    /// yielding over that before; others are 0, and a tie without strength or yield force neither breaks nor yields. One option per tie
    #[schemars(skip)]
    #[cfg_attr(
        feature = "clap",
        arg(long = "tie", value_name = "KEY=NUMBER,...", value_parser = tie::tie, allow_hyphen_values = true)
    )]
    pub ties: Vec<Tie>,
    /// A damper to the ground, which pulls and pushes, with the numbers of a tie but pretension and slack; damping without stiffness
    /// makes a dashpot. One option per damper
    #[schemars(skip)]
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
}

impl BlockSpec {
    /// Returns what parameters are if they are not given and do not follow from others: the start values of the FMU.
    pub fn defaults() -> &'static BlockSpec {
        static DEFAULTS: LazyLock<BlockSpec> = LazyLock::new(|| {
            let mut values = Values::default();
            let spec = BlockSpec { foundation: Some(Foundation::Viscoelastic), ..BlockSpec::default() };
            [Foundation::Rigid, Foundation::Viscoelastic].into_iter().fold(spec, |spec, foundation| {
                values[Variable::Foundation] = f64::from(foundation as i32);
                spec.with(values.block_parameters(|variable| values[variable]))
            })
        });
        &DEFAULTS
    }

    /// Returns the parameters of a block, by its slenderness and its frequency parameter.
    pub fn of(block: &Block) -> BlockSpec {
        let outline = Outline::Slenderness { alpha: block.alpha, p: block.p };
        let supports = block.ratios().with(KelvinVoigt::Ratios);
        let hold = HoldSpec::default().with_links(block.ties());
        let spec = BlockSpec { foundation: Some(block.foundation), hold, ..BlockSpec::default() };
        spec.with(BlockParameters { outline, supports, common: block.common() })
    }

    /// Returns the same with the numbers of these parameters.
    fn with(mut self, mut parameters: BlockParameters) -> BlockSpec {
        for (name, _, &mut number) in parameters.numbers_mut() {
            if let Some(field) = self.number_mut(name) {
                *field = Some(if name == "friction" { friction::to_user(number) } else { number });
            }
        }
        self
    }

    /// Returns the numbers to state for this block. They are those that are no defaults or needed beside others.
    pub fn explicit(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let (needs_mass, needs_eta) = (self.needs_mass().is_some(), self.width.is_some());
        self.numbers().into_iter().zip(BlockSpec::defaults().numbers()).filter_map(
            move |((name, value), (_, default))| {
                let is_needed = (name == "mass" && needs_mass) || (name == "eta" && needs_eta);
                let is_said = value != default || is_needed;
                value.filter(|_| is_said).map(|value| (name, value))
            },
        )
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
        self.clone().numbers_mut().map(|(name, number)| (name, *number))
    }

    /// Returns the numbers by their names, to set them.
    pub fn numbers_mut(&mut self) -> [(&'static str, &mut Option<f64>); 17] {
        let BlockSpec { alpha, p, eta, xi_v, width, height, center_height, inertia, stiffness, damping, .. } = self;
        let BlockSpec { mass, gamma, epsilon, g, foundation: _, restitution_factor, hold, .. } = self;
        let HoldSpec { eccentricity, friction, ties: _, dampers: _ } = hold;
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

    /// Returns the number with this name, to set it.
    pub fn number_mut(&mut self, name: &str) -> Option<&mut Option<f64>> {
        self.numbers_mut().into_iter().find_map(|(known, number)| (known == name).then_some(number))
    }

    /// The foundation.
    pub fn foundation(&self) -> Foundation {
        self.foundation.unwrap_or(Foundation::Viscoelastic)
    }

    /// The gravitational acceleration (m/s²).
    pub fn gravity(&self) -> f64 {
        self.g.or(BlockSpec::defaults().g).unwrap_or_default()
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
        let block = Block::new(&self.parameters()?)?.with_ties(&self.hold.links())?;
        match self.needs_mass() {
            Some((parameter, missing)) if self.mass.is_none() => Err(SpecError::Lacks { parameter, missing }),
            _ => Ok(block),
        }
    }

    /// Returns the parameters as the user gives them, without ties.
    ///
    /// # Errors
    /// The first parameter that would not be read, or that needs another one.
    pub fn parameters(&self) -> Result<BlockParameters, SpecError> {
        self.refuse_without_effect()?;
        let outline = match self.width {
            None => Outline::Slenderness { alpha: 0.0, p: 0.0 },
            Some(width) => {
                let height = self.center_height.map(|height| 2.0 * height).or(self.height);
                let missing = "`height`; expected both, or `center_height`";
                let height = height.ok_or(SpecError::Lacks { parameter: "width", missing })?;
                Outline::Sizes { width, height, inertia: self.inertia }
            }
        };
        let viscoelastic = match (self.stiffness, self.damping) {
            (Some(stiffness), Some(damping)) => KelvinVoigt::Springs(Springs { stiffness, damping }),
            (None, None) => KelvinVoigt::Ratios(Ratios::default()),
            (Some(_), None) => return Err(SpecError::Lacks { parameter: "K", missing: "`C`; expected both" }),
            (None, Some(_)) => return Err(SpecError::Lacks { parameter: "C", missing: "`K`; expected both" }),
        };
        let has_supports = self.eta.is_some() || self.stiffness.is_some();
        let supports = match self.foundation() {
            Foundation::Rigid => Supports::HOUSNER,
            // Those of the default block fit no other one.
            Foundation::Viscoelastic if self.width.is_some() && !has_supports => {
                let missing = "`eta`, or `K` and `C`; expected the supports, or `foundation = rigid`";
                return Err(SpecError::Lacks { parameter: "width", missing });
            }
            Foundation::Viscoelastic => Supports::Viscoelastic(viscoelastic),
        };
        let mut parameters = BlockParameters { outline, supports, common: Common::default() };
        let known = self.numbers().into_iter().zip(BlockSpec::defaults().numbers());
        let known = known.filter_map(|((name, given), (_, default))| Some((name, given.or(default)?)));
        let known: Vec<(&str, f64)> = known.collect();
        // The height of the body may follow from that of the centre of mass.
        for (name, _, number) in parameters.numbers_mut() {
            if let Some(&(_, value)) = known.iter().find(|(known, _)| *known == name) {
                *number = if name == "friction" { friction::of_user(value)? } else { value };
            }
        }
        Ok(parameters)
    }

    /// Refuses parameters that would not be read.
    fn refuse_without_effect(&self) -> Result<(), SpecError> {
        let given = self.numbers();
        let is_given = |name: &str| given.iter().any(|(known, value)| *known == name && value.is_some());
        match self.without_effect().into_iter().find(|(name, _)| is_given(name)) {
            Some((parameter, why)) => Err(SpecError::NoEffect { parameter, why }),
            None => Ok(()),
        }
    }

    /// Returns the names of the numbers that a foundation does not have.
    pub const fn of_other_foundation(foundation: Foundation) -> &'static [&'static str] {
        match foundation {
            Foundation::Rigid => &["eta", "xi_v", "K", "C"],
            Foundation::Viscoelastic => &["restitution_factor"],
        }
    }

    /// Returns the numbers that would not be read beside the others that are given, and why.
    pub fn without_effect(&self) -> Vec<(&'static str, &'static str)> {
        let has_size = self.width.is_some();
        let foundation = match self.foundation() {
            Foundation::Rigid => "on a rigid base",
            Foundation::Viscoelastic => "on viscoelastic supports; expected `foundation = rigid`",
        };
        let has_springs = self.stiffness.is_some() || self.damping.is_some();
        let rules: [(bool, &[&'static str], &'static str); 6] = [
            (true, BlockSpec::of_other_foundation(self.foundation()), foundation),
            (has_size, &["alpha", "p"], "with `width`"),
            (!has_size, &["height", "center_height", "inertia"], "without `width`"),
            (has_springs, &["eta", "xi_v"], "with `K` and `C`"),
            (self.center_height.is_some(), &["height"], "with `center_height`"),
            (self.inertia.is_some(), &["gamma"], "with `inertia`"),
        ];
        let holding = rules.into_iter().filter(|(holds, ..)| *holds);
        holding.flat_map(|(_, names, why)| names.iter().map(move |name| (*name, why))).collect()
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
    use rocking_block::block::BlockError;

    use super::*;
    use crate::spec::limits;

    fn refused(spec: BlockSpec) -> String {
        spec.block().unwrap_err().spelled(|name| format!("<{name}>"))
    }

    /// A number that a user must say is said even where it is that of the default.
    #[test]
    fn mass_and_eta_are_said_where_they_are_needed() {
        let default = BlockSpec::defaults();
        assert_eq!(default.explicit().count(), 0);
        let springs = BlockSpec { width: Some(1.0), stiffness: Some(1e7), mass: Some(1000.0), ..BlockSpec::default() };
        assert_eq!(springs.explicit().collect::<Vec<_>>(), [("width", 1.0), ("K", 1e7), ("mass", 1000.0)]);
        let sized = BlockSpec { width: Some(1.0), height: Some(3.0), eta: default.eta, ..BlockSpec::default() };
        assert_eq!(sized.explicit().collect::<Vec<_>>(), [("eta", 40.0), ("width", 1.0), ("height", 3.0)]);
        let tied =
            BlockSpec { hold: HoldSpec { ties: vec![Tie::default()], ..HoldSpec::default() }, ..default.clone() };
        assert_eq!(tied.explicit().collect::<Vec<_>>(), [("mass", 1000.0)]);
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
            (sized.clone(), "<width> without <eta>, or <K> and <C>; expected the supports, or <foundation = rigid>"),
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

    /// The schema admits exactly the numbers that a block takes.
    #[test]
    fn limits_of_the_schema_are_those_of_the_block() {
        let limits = limits::properties::<BlockSpec>();
        let (stiffness, damping) = (Some(1e7), Some(1e4));
        let supports = BlockSpec { mass: Some(1e3), width: Some(1.0), stiffness, damping, ..BlockSpec::default() };
        let measured = BlockSpec { center_height: Some(2.0), inertia: Some(1e3), ..supports.clone() };
        let sized = BlockSpec { height: Some(3.0), ..supports };
        let rigid = BlockSpec { foundation: Some(Foundation::Rigid), ..BlockSpec::default() };
        let all = [measured, sized, BlockSpec::default(), rigid];
        for (name, _) in BlockSpec::default().numbers() {
            let reads = |spec: &&BlockSpec| spec.without_effect().iter().all(|(unread, _)| *unread != name);
            let of_name = all.iter().find(reads).unwrap();
            for value in [-1.0, 0.0, 0.3, 0.9, 1.0, 1.5, std::f64::consts::FRAC_PI_2] {
                let mut spec = of_name.clone();
                *spec.number_mut(name).unwrap() = Some(value);
                let is_refused = matches!(
                    spec.block(),
                    Err(SpecError::Invalid(BlockError::OutOfRange { .. }) | SpecError::Lacks { .. })
                );
                assert_eq!(limits::admits(&limits[name], value), !is_refused, "{name} = {value}");
            }
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
