//! Fields → a spectrum, row by row.

use rocking_block::block::{Common, Foundation};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_studies::spec::command::CommandLine;
use rocking_studies::spec::words::Words;
use rocking_studies::spectrum::statistics::direction;
use rocking_studies::spectrum::{CheckedSpectrum, FoundationCurve, ScaledFeatures, Sizes, Spectrum};

use crate::command::add_excitation;
use crate::fields::{FieldError, Fields};
use crate::inputs::{Excitation, Inputs, Vertical, block_error};

/// A spectrum of the run's block in all sizes, and its command line.
///
/// # Errors
/// One for each field at fault.
pub fn read(
    mut fields: Fields,
    inputs: Inputs,
    vertical: &Vertical,
) -> Result<(CheckedSpectrum, String), Vec<FieldError>> {
    if inputs.excitation == Excitation::Release {
        fields.refuse(FieldError::new("excitation", "found a free motion; a spectrum expects a record or a pulse"));
    }
    let least = fields.number("p_min", |x| x >= 0.001, "a frequency of at least 0.001 rad/s");
    let greatest = fields.number("p_max", |x| x > least, "a frequency above the smallest p");
    let count = fields.integer("points", 2, 2000);
    let block = &inputs.run.block;
    let base = FoundationCurve::of(block);
    let with_rigid =
        block.foundation == Foundation::Viscoelastic && fields.one_of("also_rigid", &["yes", "no"]) == "yes";
    let bases = std::iter::once(base).chain(with_rigid.then_some(FoundationCurve::HOUSNER));
    let on_separation = inputs.run.settings.on_separation;
    let spectrum = Spectrum {
        alpha: block.alpha,
        common: Common { eccentricity: 0.0, ..block.common() },
        in_proportion: ScaledFeatures::of(block),
        bases: bases.collect(),
        sizes: Sizes { least, greatest, count },
        motions: vec![(direction(vertical.is_some()).into(), inputs.run.ground.clone())],
        pulse: inputs.run.pulse,
        settings: Settings { tolerance: Settings::OF_STUDIES, on_separation, ..Settings::default() },
        duration: inputs.run.duration,
        step: None,
        friction_demand: None,
    };
    let command = command_line(&spectrum, &inputs, vertical);
    let spectrum = fields.finish(spectrum)?;
    Ok((spectrum.checked().map_err(|error| vec![block_error(&error, "ratios")])?, command))
}

fn command_line(spectrum: &Spectrum, inputs: &Inputs, vertical: &Vertical) -> String {
    let default = Common::default();
    let Common { mass, gamma, gravity, friction, .. } = spectrum.common;
    let mut line = CommandLine::new("spectrum");
    add_excitation(&mut line, inputs, vertical, true);
    line.option("alpha", spectrum.alpha);
    for base in &spectrum.bases {
        line.option("foundation", base);
    }
    let Sizes { least, greatest, count } = spectrum.sizes;
    line.option("p-min", least).option("p-max", greatest).option("points", count);
    line.unless("mass", mass, default.mass).unless("gamma", gamma, default.gamma).unless("g", gravity, default.gravity);
    let ScaledFeatures { eccentricity, ties } = &spectrum.in_proportion;
    line.unless("friction", friction, default.friction).unless("eccentricity-ratio", *eccentricity, 0.0);
    for tie in ties {
        line.tie(&format!("{}-ratio", tie.kind.word()), tie);
    }
    let on_separation = spectrum.settings.on_separation;
    line.unless("on-separation", on_separation.word(), OnSeparation::Fly.word());
    if let Some(duration) = spectrum.duration {
        line.option("duration", duration);
    }
    line.option("csv", "spectrum.csv");
    line.text()
}
