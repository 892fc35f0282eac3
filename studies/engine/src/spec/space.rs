//! Parameters of a block in space, beside those that it shares with the block in the plane → checked parameters.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use rocking_block::block::{Block, BlockParameters, Foundation, KelvinVoigt, Outline, Supports};
use rocking_block::space::parameters::FEET;
use rocking_block::space::{Base, BaseSize, FootPlace, SpaceParameters, SpaceSupports};
use schemars::JsonSchema;

use crate::spec::words::Words;
use crate::spec::{BlockSpec, SpecError, limits};

/// Feet of a cylinder whose number is not given.
const FEET_OF_CIRCLE: usize = 32;

/// The shape of a base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseShape {
    /// Four feet at the corners of a rectangle.
    Rectangle,
    /// Feet along a circle.
    Circle,
}

impl Words for BaseShape {
    const WORDS: &'static [(&'static str, BaseShape)] =
        &[("rectangle", BaseShape::Rectangle), ("circle", BaseShape::Circle)];
}

/// The feet as users give them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FeetSpec {
    /// Their number, on a circle.
    Count(usize),
    /// A file with their places.
    File(PathBuf),
}

impl FromStr for FeetSpec {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<FeetSpec, Self::Err> {
        Ok(text.parse().map_or_else(|_| FeetSpec::File(text.into()), FeetSpec::Count))
    }
}

/// The parameters that only a block in space has, as a user gives them; others have their defaults, or follow.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq, JsonSchema)]
#[cfg_attr(
    feature = "clap",
    derive(clap::Args),
    command(
        next_help_heading = "Block in space, on feet with friction (one of --depth, --depth-ratio, --base and --feet makes it)"
    )
)]
pub struct SpaceSpec {
    /// Depth of a rectangular base, across --width [m]
    #[schemars(title = "depth of the base", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub depth: Option<f64>,
    /// Depth of a rectangular base over its width, instead of --depth
    #[schemars(title = "depth over width", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RATIO"))]
    pub depth_ratio: Option<f64>,
    /// Shape of the base [default: rectangle]
    #[schemars(skip)]
    #[cfg_attr(feature = "clap", arg(long, value_parser = base_shapes()))]
    pub base: Option<BaseShape>,
    /// Number of feet of a circular base, 3 to 64 [default: 32]; or the file of a table of feet: x and y from the centre of mass and, if any, the gap
    /// below the foot, in m, a line each. A block on such feet needs --center-height, --inertia-tensor, --mass and --omega-v or --stiffness
    #[schemars(skip)]
    #[cfg_attr(feature = "clap", arg(long, value_name = "FEET"))]
    pub feet: Option<FeetSpec>,
    /// Distance of the centre of mass from the middle of the base along y; --eccentricity is that along x [m] [default: 0]
    #[schemars(title = "eccentricity e_y")]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub eccentricity_y: Option<f64>,
    /// Moments of inertia Ixx,Iyy,Izz about the centre of mass and, if any, the products Ixy,Ixz,Iyz, instead of --gamma [kg.m2]
    #[schemars(skip)]
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "KG.M2,...", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub inertia_tensor: Option<Vec<f64>>,
    /// Circular frequency of the block that moves vertically on its feet, instead of --eta [rad/s]
    #[schemars(title = "frequency ω_v", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD/S"))]
    pub omega_v: Option<f64>,
    /// Horizontal over vertical stiffness of a foot [default: 1]
    #[schemars(title = "stiffness ratio κ", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub kappa: Option<f64>,
    /// Horizontal damping ratio of the feet; by default that of the supports, --xi-v
    #[schemars(title = "damping ratio ξ_h", extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long))]
    pub xi_h: Option<f64>,
}

/// The names of the parameters that make a block one in space.
pub const MAKES_SPACE: [&str; 4] = ["depth", "depth_ratio", "base", "feet"];

impl SpaceSpec {
    /// Whether the block is one in space.
    pub fn is_given(&self) -> bool {
        self.depth.is_some() || self.depth_ratio.is_some() || self.base.is_some() || self.feet.is_some()
    }

    /// Returns the numbers by their names, to set them.
    pub fn numbers_mut(&mut self) -> [(&'static str, &mut Option<f64>); 6] {
        let SpaceSpec { depth, depth_ratio, base: _, feet: _, eccentricity_y, inertia_tensor: _, omega_v, kappa, xi_h } =
            self;
        [
            ("depth", depth),
            ("depth_ratio", depth_ratio),
            ("eccentricity_y", eccentricity_y),
            ("omega_v", omega_v),
            ("kappa", kappa),
            ("xi_h", xi_h),
        ]
    }

    /// Returns the parameters of a block; `read_feet` reads a table of feet.
    ///
    /// # Errors
    /// The first parameter that would not be read, that needs another one, or that is out of range on its own; or that of the table.
    pub fn parameters(
        &self,
        block: &BlockSpec,
        read_feet: impl FnOnce(&Path) -> Result<Vec<FootPlace>, String>,
    ) -> Result<SpaceParameters, SpecError> {
        limits::check::<SpaceSpec>(&[
            ("depth", self.depth),
            ("depth_ratio", self.depth_ratio),
            ("eccentricity_y", self.eccentricity_y),
            ("omega_v", self.omega_v),
            ("kappa", self.kappa),
            ("xi_h", self.xi_h),
        ])?;
        refuse_of_plane(block)?;
        self.refuse_without_effect(block)?;
        let inertia = self.inertia()?;
        let file = match &self.feet {
            Some(FeetSpec::File(path)) => Some(path),
            Some(FeetSpec::Count(_)) | None => None,
        };
        // The feet of a table are the size of the base, and ω_v replaces η.
        let mut sized = block.clone();
        if file.is_some() {
            let missing = "`center_height`; expected the height of the centre of mass above the feet";
            sized.center_height.ok_or(SpecError::Lacks { parameter: "feet", missing })?;
            sized.width = Some(1.0);
        }
        if self.omega_v.is_some() {
            sized.eta = BlockSpec::defaults().eta;
        } else if file.is_some() && block.stiffness.is_none() {
            let missing = "`omega_v`, or `K` and `C`; expected the supports";
            return Err(SpecError::Lacks { parameter: "feet", missing });
        }
        let parameters = sized.parameters()?;
        let needs_mass = block.stiffness.is_some().then_some("K").or(inertia.map(|_| "inertia_tensor"));
        if let (Some(parameter), None) = (needs_mass, block.mass) {
            let missing = "`mass`; expected both, since the motion depends on their ratio";
            return Err(SpecError::Lacks { parameter, missing });
        }
        let base = match file {
            Some(path) => {
                if inertia.is_none() {
                    let missing = "`inertia_tensor`; expected the moments of inertia";
                    return Err(SpecError::Lacks { parameter: "feet", missing });
                }
                let unreadable = |message| SpecError::Unreadable { parameter: "feet".into(), message };
                let feet = read_feet(path).map_err(unreadable)?;
                Base::List { feet, center_height: sized.center_height.unwrap_or_default() }
            }
            None => self.base(&parameters)?,
        };
        let common = parameters.common;
        Ok(SpaceParameters {
            base,
            supports: self.supports(&parameters)?,
            kappa: self.kappa.unwrap_or(SpaceParameters::default().kappa),
            xi_h: self.xi_h,
            // A friction without limit is that which no foot reaches.
            friction: if common.friction > 0.0 { common.friction } else { SpaceParameters::default().friction },
            mass: common.mass,
            gamma: common.gamma,
            gravity: common.gravity,
            eccentricity: [common.eccentricity, self.eccentricity_y.unwrap_or(0.0)],
            inertia,
        })
    }

    /// Returns the base that is no list.
    fn base(&self, parameters: &BlockParameters) -> Result<Base, SpecError> {
        let size = match parameters.outline {
            Outline::Slenderness { alpha, p } => BaseSize::Slenderness { alpha, p },
            Outline::Sizes { width, height, .. } => BaseSize::Lengths { width, center_height: 0.5 * height },
        };
        Ok(match self.base.unwrap_or(BaseShape::Rectangle) {
            BaseShape::Rectangle => {
                let half_width = Block::new(parameters)?.b;
                let of_depth = self.depth.map(|depth| depth / (2.0 * half_width));
                Base::Rectangle { size, depth_ratio: of_depth.or(self.depth_ratio).unwrap_or(1.0) }
            }
            BaseShape::Circle => {
                let feet = match self.feet {
                    Some(FeetSpec::Count(count)) => count,
                    Some(FeetSpec::File(_)) | None => FEET_OF_CIRCLE,
                };
                Base::Circle { size, feet }
            }
        })
    }

    fn supports(&self, parameters: &BlockParameters) -> Result<SpaceSupports, SpecError> {
        let Supports::Viscoelastic(supports) = &parameters.supports else { return Err(ON_RIGID_BASE) };
        Ok(match (supports, self.omega_v) {
            (KelvinVoigt::Ratios(ratios), Some(omega_v)) => SpaceSupports::OfHeave { omega_v, xi_v: ratios.xi_v },
            (KelvinVoigt::Ratios(ratios), None) => SpaceSupports::OfRocking { eta: ratios.eta, xi_v: ratios.xi_v },
            (KelvinVoigt::Springs(springs), _) => {
                SpaceSupports::OfFoot { stiffness: springs.stiffness, damping: springs.damping }
            }
        })
    }

    /// Returns the inertia, with products of zero if only moments are given.
    fn inertia(&self) -> Result<Option<[f64; 6]>, SpecError> {
        let Some(numbers) = &self.inertia_tensor else { return Ok(None) };
        match numbers[..] {
            [x, y, z] => Ok(Some([x, y, z, 0.0, 0.0, 0.0])),
            [xx, yy, zz, xy, xz, yz] => Ok(Some([xx, yy, zz, xy, xz, yz])),
            _ => Err(SpecError::Unreadable {
                parameter: "inertia_tensor".into(),
                message: format!("found {} numbers; expected 3 moments, or 3 moments and 3 products", numbers.len()),
            }),
        }
    }

    /// Refuses parameters that would not be read beside the others.
    fn refuse_without_effect(&self, block: &BlockSpec) -> Result<(), SpecError> {
        let is_list = matches!(self.feet, Some(FeetSpec::File(_)));
        let is_circle = self.base == Some(BaseShape::Circle);
        let own = self.clone().numbers_mut().map(|(name, value)| (name, *value));
        let numbers: Vec<_> = block.numbers().into_iter().chain(own).collect();
        let is_given = |name: &str| match name {
            "base" => self.base.is_some(),
            "feet" => self.feet.is_some(),
            name => numbers.iter().any(|(known, value)| *known == name && value.is_some()),
        };
        let of_size = [
            "alpha",
            "p",
            "width",
            "height",
            "gamma",
            "eccentricity",
            "eccentricity_y",
            "depth",
            "depth_ratio",
            "base",
        ];
        let rules: [(bool, &[&'static str], &'static str); 6] = [
            (is_list, &of_size, "with a table of `feet`"),
            (is_list, &["eta"], "with a table of `feet`; expected `omega_v`"),
            (is_circle, &["depth", "depth_ratio"], "with `base = circle`"),
            (
                !is_circle && !is_list,
                &["feet"],
                "without `base = circle`; a rectangle has four, and a table of feet is a file",
            ),
            (self.depth.is_some(), &["depth_ratio"], "with `depth`"),
            (self.inertia_tensor.is_some(), &["gamma"], "with `inertia_tensor`"),
        ];
        let of_supports: [(bool, &[&'static str], &'static str); 2] = [
            (self.omega_v.is_some(), &["eta"], "with `omega_v`"),
            (block.stiffness.is_some(), &["omega_v"], "with `K` and `C`"),
        ];
        let holding = rules.into_iter().chain(of_supports).filter(|(holds, ..)| *holds);
        let mut unread = holding.flat_map(|(_, names, why)| names.iter().map(move |name| (*name, why)));
        match unread.find(|(name, _)| is_given(name)) {
            Some((parameter, why)) => Err(SpecError::NoEffect { parameter, why }),
            None => Ok(()),
        }
    }
}

/// What is expected instead of a rigid base.
pub const INSTEAD_OF_RIGID: &str = "in space a block stands on feet; expected `eta` of 100 to 300 for a hard base";

/// The error of a block in space on a rigid base.
const ON_RIGID_BASE: SpecError = SpecError::OfPlane { parameter: "foundation = rigid", instead: INSTEAD_OF_RIGID };

/// The parameters of the plane that a block in space does not have, and what is expected instead.
pub const OF_PLANE: [(&str, &str); 5] = [
    ("restitution_factor", "in space feet land on their dashpots; expected `xi_v`"),
    ("epsilon", "in space feet land on their dashpots; expected `xi_v`"),
    ("inertia", "in space it has six numbers; expected `inertia_tensor`"),
    ("ties", "expected it without `depth`, `base` and `feet`"),
    ("dampers", "expected it without `depth`, `base` and `feet`"),
];

/// Refuses parameters that only a block in the plane has.
fn refuse_of_plane(block: &BlockSpec) -> Result<(), SpecError> {
    if block.foundation == Some(Foundation::Rigid) {
        return Err(ON_RIGID_BASE);
    }
    let numbers = block.numbers();
    let is_given = |name: &str| match name {
        "ties" => !block.hold.ties.is_empty(),
        "dampers" => !block.hold.dampers.is_empty(),
        name => numbers.iter().any(|(known, value)| *known == name && value.is_some()),
    };
    match OF_PLANE.into_iter().find(|(name, _)| is_given(name)) {
        Some((parameter, instead)) => Err(SpecError::OfPlane { parameter, instead }),
        None => Ok(()),
    }
}

/// Reads a table of feet: x, y and a gap that may be missing, in m. A first line of names and lines that begin with `#` are skipped.
///
/// # Errors
/// The first line that is no foot, by its number.
pub fn feet_of_table(name: &str, text: &str) -> Result<Vec<FootPlace>, String> {
    let mut feet = Vec::new();
    let mut has_names = false;
    for (i, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> =
            line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|f| !f.is_empty()).collect();
        let numbers: Result<Vec<f64>, &str> = fields.iter().map(|field| field.parse().map_err(|_| *field)).collect();
        let expected = "expected x, y and, if any, a gap in m";
        match numbers.as_deref() {
            Ok(&[x, y]) => feet.push(FootPlace { x, y, gap: 0.0 }),
            Ok(&[x, y, gap]) => feet.push(FootPlace { x, y, gap }),
            Ok(numbers) => return Err(format!("{name}: line {i} has {} numbers; {expected}", numbers.len())),
            Err(_) if feet.is_empty() && !has_names => has_names = true,
            Err(field) => return Err(format!("{name}: line {i} has `{field}`; {expected}")),
        }
        // More feet than a block may have need not be read.
        if feet.len() > FEET[1] {
            break;
        }
    }
    Ok(feet)
}

/// The words of bases as options, with a line of help for each.
#[cfg(feature = "clap")]
pub fn base_shapes() -> impl clap::builder::TypedValueParser<Value = BaseShape> {
    super::choices(|shape| match shape {
        BaseShape::Rectangle => "A foot at each corner of a rectangle",
        BaseShape::Circle => "Feet along a circle of diameter --width, the first one on +x",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::HoldSpec;
    use rocking_block::space::SpaceBody;

    fn refused(space: SpaceSpec, block: BlockSpec) -> String {
        space.parameters(&block, |_| unreachable!()).unwrap_err().spelled(|name| format!("<{name}>"))
    }

    #[test]
    fn a_rectangle_a_circle_and_a_table_make_a_block() {
        let square = SpaceSpec { depth: Some(0.8), ..SpaceSpec::default() };
        let sized = BlockSpec { width: Some(0.5), height: Some(2.0), eta: Some(50.0), ..BlockSpec::default() };
        let body = SpaceBody::new(&square.parameters(&sized, |_| unreachable!()).unwrap()).unwrap();
        assert_eq!((body.half_width, body.feet[3].place.x, body.feet[3].place.y), (0.25, 0.25, 0.4));
        assert_eq!(body.friction, 10.0);
        let by_ratio = SpaceSpec { depth_ratio: Some(1.6), ..SpaceSpec::default() };
        assert_eq!(
            by_ratio.parameters(&sized, |_| unreachable!()).unwrap(),
            square.parameters(&sized, |_| unreachable!()).unwrap()
        );
        let circle = SpaceSpec { base: Some(BaseShape::Circle), ..SpaceSpec::default() };
        assert_eq!(SpaceBody::new(&circle.parameters(&sized, |_| unreachable!()).unwrap()).unwrap().count(), 32);
        let table = "x [m],y [m],gap [m]\n# a comment\n-1,-1\n1 -1 0\n0;1;0\n\n1,1,0.001\n";
        let list = SpaceSpec {
            feet: Some(FeetSpec::File("feet.csv".into())),
            inertia_tensor: Some(vec![1e3, 1e3, 5e2]),
            omega_v: Some(80.0),
            ..SpaceSpec::default()
        };
        let heavy = BlockSpec { center_height: Some(2.0), mass: Some(900.0), ..BlockSpec::default() };
        let parameters = list.parameters(&heavy, |path| feet_of_table(path.to_str().unwrap(), table)).unwrap();
        let body = SpaceBody::new(&parameters).unwrap();
        assert_eq!((body.count(), body.omega_v, body.feet[3].free_height), (4, 80.0, -0.001));
    }

    #[test]
    fn parameters_that_would_not_be_read_are_refused() {
        let depth = SpaceSpec { depth: Some(1.0), ..SpaceSpec::default() };
        let circle = SpaceSpec { base: Some(BaseShape::Circle), ..SpaceSpec::default() };
        let table = SpaceSpec { feet: Some(FeetSpec::File("f".into())), ..SpaceSpec::default() };
        let some = Some(0.5);
        let plain = BlockSpec::default;
        for (space, block, message) in [
            (SpaceSpec { depth: Some(0.0), ..SpaceSpec::default() }, plain(), "<depth> = 0; expected a length > 0 m"),
            (SpaceSpec { xi_h: Some(0.0), ..depth.clone() }, plain(), "<xi_h> = 0; expected a number > 0"),
            (SpaceSpec { depth_ratio: some, ..depth.clone() }, plain(), "<depth_ratio> has no effect with <depth>"),
            (SpaceSpec { depth: some, ..circle.clone() }, plain(), "<depth> has no effect with <base = circle>"),
            (
                SpaceSpec { feet: Some(FeetSpec::Count(4)), ..depth.clone() },
                plain(),
                "<feet> has no effect without <base = circle>; a rectangle has four, and a table of feet is a file",
            ),
            (
                depth.clone(),
                BlockSpec { foundation: Some(Foundation::Rigid), ..plain() },
                "<foundation = rigid> is for a block in the plane; in space a block stands on feet; expected <eta> of 100 to 300 for a hard base",
            ),
            (
                depth.clone(),
                BlockSpec { hold: HoldSpec { ties: vec![Default::default()], ..HoldSpec::default() }, ..plain() },
                "<ties> is for a block in the plane; expected it without <depth>, <base> and <feet>",
            ),
            (
                table.clone(),
                plain(),
                "<feet> without <center_height>; expected the height of the centre of mass above the feet",
            ),
            (table.clone(), BlockSpec { alpha: some, ..plain() }, "<alpha> has no effect with a table of <feet>"),
            (
                table.clone(),
                BlockSpec { center_height: some, ..plain() },
                "<feet> without <omega_v>, or <K> and <C>; expected the supports",
            ),
            (
                SpaceSpec { inertia_tensor: Some(vec![1.0, 2.0]), ..depth.clone() },
                plain(),
                "<inertia_tensor>: found 2 numbers; expected 3 moments, or 3 moments and 3 products",
            ),
            (
                SpaceSpec { inertia_tensor: Some(vec![1.0, 1.0, 1.0]), ..depth },
                plain(),
                "<inertia_tensor> without <mass>; expected both, since the motion depends on their ratio",
            ),
        ] {
            assert_eq!(refused(space, block), message);
        }
        assert_eq!(
            feet_of_table("f", "1,2\n1,b\n").unwrap_err(),
            "f: line 2 has `b`; expected x, y and, if any, a gap in m"
        );
        assert_eq!(
            feet_of_table("f", "1\n").unwrap_err(),
            "f: line 1 has 1 numbers; expected x, y and, if any, a gap in m"
        );
    }
}
