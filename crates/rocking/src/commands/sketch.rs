//! `rocking sketch`: options → a block → its sketch and its values.

use rocking_studies::spec::BlockSpec;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use serde::Serialize;

use crate::commands::simulate::summary::Parameters;
use crate::options::block;
use crate::options::explicit::ExplicitOptions;
use crate::output::files::Pending;
use crate::output::formats::PictureOptions;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_block::block::{Block, Foundation};
use rocking_charts::history::block_line;
use rocking_charts::picture::PictureFormat;
use rocking_charts::sketch::Sketch;

/// Options of `rocking sketch`.
#[derive(Parser)]
pub struct SketchCommand {
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Values of a block that `simulate` does not report.
#[derive(Serialize)]
struct Values {
    block: Parameters,
    #[serde(flatten)]
    supports: Option<Supports>,
    /// Start of the motion on a rigid base; unknown for a block with ties, which has no closed form.
    #[serde(flatten)]
    start: Option<Start>,
}

/// Least horizontal acceleration of the ground that moves a block on a rigid base (m/s²).
#[derive(Serialize)]
enum Start {
    /// Towards the corner that is nearer to the centre of mass.
    #[serde(rename = "rocking_acceleration")]
    Rocks(f64),
    /// The block slides before a corner lifts.
    #[serde(rename = "sliding_acceleration")]
    Slides(f64),
}

/// Values of viscoelastic supports, by the names of the FMU's variables.
#[derive(Serialize)]
struct Supports {
    #[serde(rename = "K")]
    stiffness: f64,
    #[serde(rename = "C")]
    damping: f64,
    delta_s: f64,
    theta_separation: f64,
}

/// Runs the command.
pub fn run(options: &SketchCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let SketchCommand { block: given, picture, report } = options;
    explicit.refuse_unless(picture.plot.is_some(), &["plot-format"], "without --plot")?;
    let format = picture.format()?.unwrap_or(PictureFormat::Png);
    let block = block::block(given)?;
    let plot = picture.plot.clone().map_or_else(default_output, Ok)?;
    let file = Pending::new(&plot)?;
    let svg = Sketch { block, height: given.body_height(&block) }.svg()?;
    Pending::write(vec![(file, format.encode(&svg)?)])?;
    let written = WrittenFiles::new([("plot", Some(plot.as_path()))]);
    let values = Values::of(&block);
    report.print("sketch", &written, &[], &(values.text(&block) + &written.lines()), &values)
}

/// Returns the picture `out/sketch.png`, in a folder that exists.
fn default_output() -> anyhow::Result<PathBuf> {
    let folder = Path::new("out");
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    Ok(folder.join("sketch.png"))
}

impl Values {
    fn of(block: &Block) -> Values {
        let supports = match block.foundation {
            Foundation::Viscoelastic => Some(Supports {
                stiffness: block.stiffness,
                damping: block.damping,
                delta_s: block.static_deflection(),
                theta_separation: block.separation_angle(),
            }),
            Foundation::Rigid => None,
        };
        let slope = (block.b - block.eccentricity.abs()) / block.h;
        let start = match block.friction {
            _ if !block.ties().is_empty() => None,
            friction if friction > 0.0 && friction < slope => Some(Start::Slides(friction * block.gravity)),
            _ => Some(Start::Rocks(slope * block.gravity)),
        };
        Values { block: Parameters::of(block), supports, start }
    }

    fn text(&self, block: &Block) -> String {
        let mut text = format!("block         {}, M = {} kg\n", block_line(block), block.mass);
        if let Some(Supports { stiffness, damping, delta_s, theta_separation }) = &self.supports {
            text += &format!(
                "supports      K = {stiffness:.4e} N/m, C = {damping:.4e} N.s/m each, δ_s = {:.3} mm",
                1e3 * delta_s
            );
            if block.eccentricity == 0.0 && block.ties().is_empty() {
                text += &format!("; a corner lifts at |θ|/α = {:.4}", theta_separation / block.alpha);
            }
            text.push('\n');
        }
        match self.start {
            None => {}
            Some(Start::Rocks(acceleration)) => {
                let alpha = match block.eccentricity {
                    0.0 => "α",
                    to_the_right if to_the_right > 0.0 => "α_R",
                    _ => "α_L",
                };
                text += &format!("rocks         beyond g tan {alpha} = {acceleration:.4} m/s² on a rigid base\n");
            }
            Some(Start::Slides(acceleration)) => {
                text += &format!("slides        beyond μ g = {acceleration:.4} m/s² on a rigid base\n");
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::restraints::Tie;
    use rocking_block::block::{Common, Physical};

    /// Shenton (1996): a block rocks beyond g tan α of its nearer corner, and slides beyond μ g if that is less.
    #[test]
    fn the_start_of_the_motion_follows_the_nearer_corner_and_friction() {
        let block = |eccentricity: f64, friction: f64| {
            let physical =
                Physical { width: 0.8, height: 2.0, supports: rocking_block::block::Supports::HOUSNER, inertia: None };
            let common = Common { eccentricity, friction, gravity: 10.0, ..Common::default() };
            Block::from_physical(&physical, &common).unwrap()
        };
        let text = |block: Block| Values::of(&block).text(&block).lines().last().unwrap().to_string();
        for (eccentricity, friction, expected) in [
            (0.0, 0.0, "rocks         beyond g tan α = 4.0000 m/s² on a rigid base"),
            (0.1, 0.0, "rocks         beyond g tan α_R = 3.0000 m/s² on a rigid base"),
            (-0.1, 0.35, "rocks         beyond g tan α_L = 3.0000 m/s² on a rigid base"),
            (-0.1, 0.25, "slides        beyond μ g = 2.5000 m/s² on a rigid base"),
        ] {
            assert_eq!(text(block(eccentricity, friction)), expected);
        }
        let tie = Tie { block: [0.4, 1.8], ground: [0.6, 1.8], stiffness: 1e6, ..Tie::default() };
        let tied = block(0.0, 0.0).with_ties(&[tie]).unwrap();
        assert!(Values::of(&tied).start.is_none() && text(tied).starts_with("block "));
    }
}
