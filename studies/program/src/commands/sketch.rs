//! `rocking sketch`: options → a block → its sketch and its values.

use rocking_studies::spec::{BlockSpec, SpaceSpec};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::commands::simulate::summary::{add_block_in_space, parameters};
use crate::options::explicit::ExplicitOptions;
use crate::options::{block, in_space};
use crate::output::files::Outputs;
use crate::output::formats::PictureOptions;
use crate::output::report::ReportOptions;
use crate::output::summary::Summary;
use rocking_block::block::{Block, Foundation};
use rocking_block::space::{SpaceBody, SpaceParameters};
use rocking_charts::history::block_line;
use rocking_charts::sketch::{Sketch, SketchInSpace};

/// Options of `rocking sketch`.
#[derive(Parser)]
pub struct SketchCommand {
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    space: SpaceSpec,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &SketchCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let SketchCommand { block: given, space, picture, report } = options;
    let format = picture.format()?;
    let (svg, summary) = if in_space::makes_space(space, explicit, &[])? {
        let (parameters, body) = in_space::block(space, given)?;
        let height = given.center_height.is_none().then_some(2.0 * body.center_height);
        let svg = SketchInSpace { parameters: &parameters, body: &body, height }.svg()?;
        (svg, summary_in_space(&parameters, &body))
    } else {
        let block = block::block(given)?;
        (Sketch { block, height: given.body_height(&block) }.svg()?, summary(&block))
    };
    let plot = picture.plot.clone().map_or_else(default_output, Ok)?;
    let mut outputs = Outputs::open([("plot", Some(plot.as_path()))])?;
    outputs.fill("plot", || Ok(format.encode(&svg)?))?;
    let written = outputs.write()?;
    report.print("sketch", &written, &[], &(summary.text + &written.lines()), &summary.json)
}

/// Returns the picture `out/sketch.png`, in a folder that exists.
fn default_output() -> anyhow::Result<PathBuf> {
    let folder = Path::new("out");
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    Ok(folder.join("sketch.png"))
}

/// The values of a block in space, with those that `simulate` does not report.
fn summary_in_space(parameters: &SpaceParameters, body: &SpaceBody) -> Summary {
    let mut summary = Summary::default();
    summary.entry("model", "block in space");
    add_block_in_space(&mut summary, parameters, body);
    let (stiffness, damping) = (body.stiffness, body.damping);
    let deflection = body.gravity / (body.omega_v * body.omega_v);
    summary.item(
        "K",
        stiffness,
        "feet",
        format!(
            "{} with K = {stiffness:.4e} N/m, C = {damping:.4e} N.s/m each, δ_s = {:.3} mm",
            body.count(),
            1e3 * deflection
        ),
    );
    summary.entry("C", damping);
    summary.entry("delta_s", deflection);
    // The least ground acceleration over the nearest edge on rigid feet.
    let slope = body.edge_distance / body.center_height;
    let (rocks, slides) = (slope * body.gravity, body.friction * body.gravity);
    match body.friction < slope {
        true => summary.item(
            "sliding_acceleration",
            slides,
            "slides",
            format!("beyond μ g = {slides:.4} m/s² on rigid feet"),
        ),
        false => {
            let text = format!("beyond g tan α_edge = {rocks:.4} m/s² over the nearest edge on rigid feet");
            summary.item("rocking_acceleration", rocks, "rocks", text);
        }
    }
    summary
}

/// The values of a block, with those that `simulate` does not report.
fn summary(block: &Block) -> Summary {
    let mut summary = Summary::default();
    summary.item("block", parameters(block), "block", format!("{}, M = {} kg", block_line(block), block.mass));
    let is_plain = block.ties().is_empty();
    if block.foundation == Foundation::Viscoelastic {
        let (stiffness, damping) = (block.stiffness, block.damping);
        let (deflection, separation) = (block.static_deflection(), block.separation_angle());
        let lifts = match block.eccentricity == 0.0 && is_plain {
            true => format!("; a corner lifts at |θ|/α = {:.4}", separation / block.alpha),
            false => String::new(),
        };
        summary.item(
            "K",
            stiffness,
            "supports",
            format!("K = {stiffness:.4e} N/m, C = {damping:.4e} N.s/m each, δ_s = {:.3} mm{lifts}", 1e3 * deflection),
        );
        summary.entry("C", damping);
        summary.entry("delta_s", deflection);
        summary.entry("theta_separation", separation);
    }
    // The least ground acceleration that moves the block on a rigid base; with ties there is no closed form.
    let slope = (block.b - block.eccentricity.abs()) / block.h;
    let (rocks, slides) = (slope * block.gravity, block.friction * block.gravity);
    let alpha = match block.eccentricity {
        0.0 => "α",
        to_the_right if to_the_right > 0.0 => "α_R",
        _ => "α_L",
    };
    if is_plain && block.friction > 0.0 && block.friction < slope {
        let text = format!("beyond μ g = {slides:.4} m/s² on a rigid base");
        summary.item("sliding_acceleration", slides, "slides", text);
    } else if is_plain {
        let text = format!("beyond g tan {alpha} = {rocks:.4} m/s² on a rigid base");
        summary.item("rocking_acceleration", rocks, "rocks", text);
    }
    summary
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::restraints::Tie;
    use rocking_block::block::{BlockParameters, Common, Outline, Supports};

    /// A block rocks beyond g tan α of its nearer corner (Shenton, 1996). It slides beyond μ g if that is less.
    #[test]
    fn the_start_of_the_motion_follows_the_nearer_corner_and_friction() {
        let block = |eccentricity: f64, friction: f64| {
            let outline = Outline::Sizes { width: 0.8, height: 2.0, inertia: None };
            let common = Common { eccentricity, friction, gravity: 10.0, ..Common::default() };
            Block::new(&BlockParameters { outline, supports: Supports::HOUSNER, common }).unwrap()
        };
        let text = |block: Block| summary(&block).text.lines().last().unwrap().to_string();
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
        assert!(text(tied).starts_with("block "));
    }
}
