//! `rocking sketch`: options → a block → its sketch and its values.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use serde::Serialize;

use crate::block_options::BlockOptions;
use crate::explicit_options::ExplicitOptions;
use crate::formats::PictureOptions;
use crate::output::Pending;
use crate::report::{ReportOptions, WrittenFiles};
use crate::summary::Parameters;
use rocking_block::block::{Block, Foundation};
use rocking_charts::history::block_line;
use rocking_charts::picture::PictureFormat;
use rocking_charts::sketch::Sketch;

/// Options of `rocking sketch`.
#[derive(Parser)]
pub struct Options {
    #[command(flatten)]
    block: BlockOptions,
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
    /// Horizontal acceleration of the ground at which the block begins to rock on a rigid base (m/s²).
    rocking_acceleration: f64,
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
pub fn run(options: &Options, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let Options { block, picture, report } = options;
    block.refuse_unread(explicit)?;
    explicit.refuse_unless(picture.plot.is_some(), &["plot-format"], "without --plot")?;
    let format = picture.format()?.unwrap_or(PictureFormat::Png);
    let block = block.block(explicit)?;
    let plot = picture.plot.clone().map_or_else(default_output, Ok)?;
    let file = Pending::new(&plot)?;
    let svg = Sketch::of(&block).svg()?;
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
        Values { block: Parameters::of(block), supports, rocking_acceleration: block.gravity * block.b / block.h }
    }

    fn text(&self, block: &Block) -> String {
        let mut text = format!("block         {}, M = {} kg\n", block_line(block), block.mass);
        if let Some(Supports { stiffness, damping, delta_s, theta_separation }) = &self.supports {
            text += &format!(
                "supports      K = {stiffness:.4e} N/m, C = {damping:.4e} N.s/m each, δ_s = {:.3} mm; a corner lifts at |θ|/α = \
                 {:.4}\n",
                1e3 * delta_s,
                theta_separation / block.alpha
            );
        }
        text + &format!("rocks         beyond g tan α = {:.4} m/s² on a rigid base\n", self.rocking_acceleration)
    }
}
