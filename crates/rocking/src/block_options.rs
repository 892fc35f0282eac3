//! Options of a single block → a block.

use anyhow::Context;
use clap::Args;

use crate::choices;
use crate::explicit_options::ExplicitOptions;
use crate::run_options::warn_of_soft_supports;
use crate::tie::tie;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, BlockError, Common, Dimensionless, Foundation, Parameterization, Physical};
use rocking_block::words::Words;

/// The parameters of a block.
#[derive(Args)]
#[command(next_help_heading = "Block")]
pub struct BlockOptions {
    /// Slenderness angle alpha [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.25)]
    alpha: f64,
    /// Frequency parameter p [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 1.0)]
    p: f64,
    /// Stiffness ratio eta = omega_v/p of the supports
    #[arg(long, default_value_t = 40.0)]
    eta: f64,
    /// Vertical damping ratio xi_v of the supports
    #[arg(long, default_value_t = 0.1)]
    xi_v: f64,
    /// Width of the base; with --height, --stiffness, --damping and --mass it replaces alpha, p, eta and xi_v [m]
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Twice the height of the centre of mass above the base [m]
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// Height of the centre of mass above the base, instead of --height [m]
    #[arg(long, value_name = "M")]
    center_height: Option<f64>,
    /// Centroidal moment of inertia I0, instead of --gamma; with --width and --mass [kg.m2]
    #[arg(long, value_name = "KG.M2")]
    inertia: Option<f64>,
    /// Stiffness K of one support; not on a rigid base [N/m]
    #[arg(long, value_name = "N/M")]
    stiffness: Option<f64>,
    /// Damping C of one support; not on a rigid base [N.s/m]
    #[arg(long, value_name = "N.S/M")]
    damping: Option<f64>,
    /// Mass M; it changes the motion only together with --stiffness, --inertia or --tie [kg]
    #[arg(long, value_name = "KG", default_value_t = Common::default().mass)]
    mass: f64,
    /// Shape factor gamma = M R0²/I0
    #[arg(long, default_value_t = Common::default().gamma)]
    gamma: f64,
    /// Restitution epsilon of the landing corner, from 0 to 1
    #[arg(long, default_value_t = Common::default().epsilon)]
    epsilon: f64,
    /// Gravitational acceleration, also for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// Foundation under the block
    #[arg(long, value_parser = choices::foundation(), default_value = Foundation::Viscoelastic.word())]
    foundation: Foundation,
    /// Factor on Housner's restitution e of the rigid base; their product is at most 1
    #[arg(long, value_name = "FACTOR", default_value_t = Common::default().restitution_factor)]
    restitution_factor: f64,
    #[command(flatten)]
    extended: ExtendedBlockOptions,
}

/// Eccentricity, friction and ties of a block.
#[derive(Args)]
pub struct ExtendedBlockOptions {
    /// Distance of the centre of mass from the middle of the base, positive to the right [m]
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_hyphen_values = true)]
    eccentricity: f64,
    /// Coulomb's coefficient of friction of the feet; 0 for no limit, so that they do not slide
    #[arg(long, value_name = "MU", default_value_t = 0.0)]
    friction: f64,
    /// A tie to the ground: block_x, block_z and ground_x, ground_z are its ends, from the middle of the base at rest [m];
    /// stiffness [N/m], pretension [N], slack [m], damping [N.s/m], strength [N]; others
    /// are 0, and a tie without strength does not break. One option per tie
    #[arg(long, value_name = "KEY=NUMBER,...", value_parser = tie, allow_hyphen_values = true)]
    tie: Vec<Tie>,
}

impl ExtendedBlockOptions {
    /// Returns these parameters with their own eccentricity and friction.
    pub fn common(&self, common: Common) -> Common {
        Common { eccentricity: self.eccentricity, friction: self.friction, ..common }
    }

    /// Returns a block with these ties.
    pub fn tied(&self, block: Block) -> Result<Block, BlockError> {
        block.with_ties(&self.tie)
    }
}

impl BlockOptions {
    /// Returns the foundation.
    pub fn foundation(&self) -> Foundation {
        self.foundation
    }

    /// Returns the gravitational acceleration (m/s²).
    pub fn gravity(&self) -> f64 {
        self.g
    }

    /// Returns the height of the body (m), which is unknown if only that of its centre of mass is given.
    pub fn body_height(&self, block: &Block) -> Option<f64> {
        self.center_height.is_none().then_some(2.0 * block.h)
    }

    /// Refuses options without effect.
    pub fn refuse_without_effect(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        let on_supports = match self.foundation {
            Foundation::Viscoelastic => true,
            Foundation::Rigid => false,
        };
        let of_supports = ["eta", "xi-v", "stiffness", "damping"];
        explicit.refuse_unless(on_supports, &of_supports, "on a rigid base")?;
        let needed = "on viscoelastic supports; expected --foundation rigid";
        explicit.refuse_unless(!on_supports, &["restitution-factor"], needed)?;
        explicit.refuse_unless(self.width.is_none(), &["alpha", "p", "eta", "xi-v"], "with --width")?;
        let of_sizes = ["height", "center-height", "inertia", "stiffness", "damping"];
        explicit.refuse_unless(self.width.is_some(), &of_sizes, "without --width")?;
        explicit.refuse_unless(self.center_height.is_none(), &["height"], "with --center-height")?;
        explicit.refuse_unless(self.inertia.is_none(), &["gamma"], "with --inertia")
    }

    /// Returns the block, and warns of supports too soft to keep it upright.
    pub fn block(&self, explicit: &ExplicitOptions) -> anyhow::Result<Block> {
        let block = self.checked()?;
        for (option, given, why) in [
            ("stiffness", self.stiffness.is_some(), "eta and xi_v depend"),
            ("inertia", self.inertia.is_some(), "p depends"),
            ("tie", !self.extended.tie.is_empty(), "the effect of a tie depends"),
        ] {
            let has_mass = !given || explicit.has("mass");
            anyhow::ensure!(has_mass, "--{option} without --mass; expected both, since {why} on the mass");
        }
        warn_of_soft_supports(&block);
        Ok(block)
    }

    fn checked(&self) -> anyhow::Result<Block> {
        let (parameterization, common) = self.parameters()?;
        Ok(self.extended.tied(Block::from_parameters(&parameterization, &common)?)?)
    }

    /// Returns the parameters in the parameterization of the options.
    pub fn parameters(&self) -> anyhow::Result<(Parameterization, Common)> {
        let BlockOptions { alpha, p, eta, xi_v, mass, gamma, epsilon, g, foundation, restitution_factor, .. } = *self;
        let common = Common { mass, gamma, epsilon, gravity: g, foundation, restitution_factor, ..Common::default() };
        let common = self.extended.common(common);
        let BlockOptions { width: Some(width), height, center_height, inertia, stiffness, damping, .. } = *self else {
            return Ok((Parameterization::Dimensionless(Dimensionless { alpha, p, eta, xi_v }), common));
        };
        let height = center_height.map(|height| 2.0 * height).or(height);
        let height = height.context("--width without --height; expected both, or --center-height")?;
        let (stiffness, damping) = match (foundation, stiffness, damping) {
            (Foundation::Viscoelastic, Some(stiffness), Some(damping)) => (stiffness, damping),
            (Foundation::Viscoelastic, ..) => {
                anyhow::bail!(
                    "--width without --stiffness and --damping; expected both and --mass, or --foundation rigid"
                )
            }
            // The rigid base reads neither; these make a valid block.
            (Foundation::Rigid, ..) => (mass * g / height, 0.0),
        };
        Ok((Parameterization::Physical(Physical { width, height, stiffness, damping, inertia }), common))
    }
}
