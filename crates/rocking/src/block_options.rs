//! Options of a single block → a block.

use anyhow::Context;
use clap::Args;

use crate::choices;
use crate::explicit_options::ExplicitOptions;
use crate::run_options::warn_of_soft_supports;
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Physical};
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
    /// Stiffness K of one support; not on a rigid base [N/m]
    #[arg(long, value_name = "N/M")]
    stiffness: Option<f64>,
    /// Damping C of one support; not on a rigid base [N.s/m]
    #[arg(long, value_name = "N.S/M")]
    damping: Option<f64>,
    /// Mass M; it changes the motion only together with --stiffness [kg]
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

    /// Refuses options without effect.
    pub fn refuse_unread(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        let on_supports = match self.foundation {
            Foundation::Viscoelastic => true,
            Foundation::Rigid => false,
        };
        let of_supports = ["eta", "xi-v", "stiffness", "damping"];
        explicit.refuse_unless(on_supports, &of_supports, "on a rigid base")?;
        let needed = "on viscoelastic supports; expected --foundation rigid";
        explicit.refuse_unless(!on_supports, &["restitution-factor"], needed)?;
        explicit.refuse_unless(self.width.is_none(), &["alpha", "p", "eta", "xi-v"], "with --width")?;
        explicit.refuse_unless(self.width.is_some(), &["height", "stiffness", "damping"], "without --width")
    }

    /// Returns the block, and warns of supports too soft to keep it upright.
    pub fn block(&self, explicit: &ExplicitOptions) -> anyhow::Result<Block> {
        let block = self.checked()?;
        let has_mass = self.stiffness.is_none() || explicit.has("mass");
        anyhow::ensure!(has_mass, "--stiffness without --mass; expected both, since eta and xi_v depend on the mass");
        warn_of_soft_supports(&block);
        Ok(block)
    }

    fn checked(&self) -> anyhow::Result<Block> {
        let BlockOptions { alpha, p, eta, xi_v, mass, gamma, epsilon, g, foundation, restitution_factor, .. } = *self;
        let common = Common { mass, gamma, epsilon, gravity: g, foundation, restitution_factor, ..Common::default() };
        let BlockOptions { width: Some(width), height, stiffness, damping, .. } = *self else {
            return Ok(Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common)?);
        };
        let height = height.context("--width without --height; expected both")?;
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
        Ok(Block::from_physical(&Physical { width, height, stiffness, damping, inertia: None }, &common)?)
    }
}
