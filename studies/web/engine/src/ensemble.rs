//! Fields → the probability of overturning over the scale, row by row.
//!
//! It is a sweep over scale factors, or amplitudes of a pulse, each with an ensemble of slightly different strengths. The same study
//! as a file for `rocking sweep` gives the same table.

use rocking_block::block::Foundation;
use rocking_block::block::restraints::tie;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_studies::input::parameters::Parameter;
use rocking_studies::intensity::Measure;
use rocking_studies::run::limit::Limit;
use rocking_studies::spec::BlockSpec;
use rocking_studies::spec::study::Distribution;
use rocking_studies::sweep::Sweep;
use rocking_studies::sweep::ensemble::{Ensemble, SpreadTarget, SpreadWidth, UncertainQuantity};
use rocking_studies::sweep::ground_motion::GroundMotion;
use rocking_studies::sweep::parameters::{Design, ParameterValues, SweptParameter};
use rocking_studies::sweep::strength::Strengths;

use crate::fields::{FieldError, Fields};
use crate::inputs::{Excitation, Inputs, Vertical};
use crate::records::EMBEDDED_PATH;

/// A sweep with its ensembles.
#[derive(Clone, Debug)]
pub struct Study {
    /// The sweep.
    pub sweep: Sweep,
    /// Factors on the record, or amplitudes of the pulse (m/s²): one per row.
    pub strengths: Vec<f64>,
    /// The file for `rocking sweep`.
    pub file: String,
}

/// The ensembles of the run's block.
///
/// # Errors
/// One for each field at fault.
pub fn read(mut fields: Fields, inputs: Inputs, vertical: &Vertical) -> Result<Study, Vec<FieldError>> {
    let is_pulse = inputs.excitation == Excitation::Pulse;
    if inputs.excitation == Excitation::Release {
        fields.refuse(FieldError::new("excitation", "found a free motion; an ensemble expects a record or a pulse"));
    }
    let from = fields.number("scale_from", |x| x > 0.0, "a factor > 0");
    let to = fields.number("scale_to", |x| x > from, "a factor above the smallest");
    let count = fields.integer("scale_count", 2, 200);
    let samples = fields.integer("samples", 1, 1000);
    let spread =
        fields.number("spread", |x| x > 0.0 && x <= 1.0, "a coefficient of variation, more than 0 and at most 1");
    if fields.has_errors() {
        return Err(fields.into_errors());
    }
    // The strengths of a pulse are factors on its amplitude.
    let unit = if is_pulse { inputs.run.pulse.amplitude } else { 1.0 };
    let strength = |number: u64| unit * (from + (to - from) * number as f64 / (count - 1) as f64);
    let strengths: Vec<f64> = (0..count).map(strength).collect();
    let parameters = parameters(&inputs, is_pulse.then(|| strengths.clone()));
    let target = match is_pulse {
        true => SpreadTarget::Parameter(parameter("pulse.amplitude")),
        false => SpreadTarget::Scale,
    };
    let (distribution, width) = (Distribution::Lognormal, SpreadWidth::Relative(spread));
    let ensemble = Ensemble {
        samples: samples as u32,
        seed: 0,
        spreads: vec![UncertainQuantity { target, distribution, width }],
        limits: vec![Limit::Overturned],
    };
    let file = file(&inputs, vertical, &parameters, &strengths, spread, samples);
    let of_record = Measure::of_record(&[]);
    let names = match &inputs.excitation {
        Excitation::Embedded => EMBEDDED_PATH.into(),
        Excitation::File { name, .. } => name.clone(),
        Excitation::Pulse | Excitation::Release => String::new(),
    };
    let names = [names, vertical.as_ref().map(|(name, _)| name.clone()).unwrap_or_default()];
    let motion = GroundMotion::new(names, inputs.unscaled.clone(), &of_record, inputs.run.block.gravity);
    let sweep = Sweep {
        text: file.lines().map(str::trim).filter(|line| !line.is_empty()).map(String::from).collect(),
        parameters,
        design: Design::Grid,
        motions: vec![motion],
        space: None,
        building: None,
        strengths: Strengths::Scales(if is_pulse { vec![1.0] } else { strengths.clone() }),
        ensemble: Some(ensemble),
        measures: of_record.into_iter().chain(Measure::OF_BLOCK).collect(),
        // The default, replaced by the study's own value.
        on_separation: OnSeparation::Fly,
        tolerance: Settings::OF_STUDIES,
        duration: inputs.run.duration,
        step: None,
        friction_demand: None,
        half_cycles: None,
        changes: Vec::new(),
        // The page shows doubts beside the files.
        remarks: Vec::new(),
    };
    fields.finish(Study { sweep, strengths, file })
}

fn parameter(name: &str) -> Parameter {
    Parameter::named(name).unwrap_or_else(|message| unreachable!("{message}"))
}

/// The parameters of block, run and pulse that differ from those of the FMU. The pulse has these amplitudes.
fn parameters(inputs: &Inputs, amplitudes: Option<Vec<f64>>) -> Vec<SweptParameter> {
    let mut values: Vec<(&str, Vec<f64>)> = Vec::new();
    let foundation = inputs.spec.foundation();
    // The FMU has ratios only beside the paper's alpha and p.
    let spec = match inputs.spec.eta {
        Some(_) if inputs.spec.width.is_some() => {
            BlockSpec { eta: inputs.spec.eta, ..BlockSpec::of(&inputs.run.block) }
        }
        _ => inputs.spec.clone(),
    };
    if spec.width.is_some() {
        values.push(("parameterization", vec![2.0]));
    }
    values.extend(spec.explicit().map(|(name, value)| (name, vec![value])));
    if foundation != Foundation::Viscoelastic {
        values.push(("foundation", vec![f64::from(foundation as i32)]));
    }
    values.push(("on_separation", vec![f64::from(inputs.run.settings.on_separation as i32)]));
    if let Some(amplitudes) = amplitudes {
        let Pulse { shape, period, phase, cycles, .. } = inputs.run.pulse;
        values.push(("pulse.shape", vec![f64::from(shape as i32)]));
        values.push(("pulse.period", vec![period]));
        if shape == PulseShape::Gabor {
            values.extend([("pulse.phase", vec![phase]), ("pulse.cycles", vec![cycles])]);
        }
        values.push(("pulse.amplitude", amplitudes));
    }
    let swept =
        |name: &str, values| SweptParameter { parameter: parameter(name), values: ParameterValues::List(values) };
    let links = inputs.run.block.ties();
    let ties = tie::names(links).into_iter().zip(links).flat_map(|(name, tie)| {
        let nonzero = tie.named().filter(|(_, value)| *value != 0.0);
        nonzero.map(move |(key, value)| swept(&format!("{name}.{key}"), vec![value]))
    });
    values.into_iter().map(|(name, values)| swept(name, values)).chain(ties).collect()
}

/// The study as a file for `rocking sweep`.
fn file(
    inputs: &Inputs,
    vertical: &Vertical,
    parameters: &[SweptParameter],
    strengths: &[f64],
    spread: f64,
    samples: u64,
) -> String {
    let list = |values: &[f64]| values.iter().map(|&value| decimal(value)).collect::<Vec<_>>().join(", ");
    let is_pulse = inputs.excitation == Excitation::Pulse;
    let target = if is_pulse { "\"pulse.amplitude\"" } else { "scale" };
    let mut text = String::from("[study]\ndesign = \"grid\"\n");
    if !is_pulse {
        text.push_str(&format!("scales = [{}]\n", list(strengths)));
    }
    text.push_str(&format!("ensemble = {{ {target} = {}, samples = {samples} }}\n", decimal(spread)));
    if let Some(duration) = inputs.run.duration {
        text.push_str(&format!("duration = {}\n", decimal(duration)));
    }
    text.push_str("\n[parameters]\n");
    for SweptParameter { parameter, values } in parameters {
        let ParameterValues::List(values) = values else { unreachable!("all values are lists") };
        let value = match values.as_slice() {
            [value] if !parameter.is_choice() => decimal(*value),
            [value] => format!("\"{}\"", parameter.display(*value)),
            values => format!("[{}]", list(values)),
        };
        let name = parameter.name();
        let name = if name.contains('.') { format!("\"{name}\"") } else { name.into() };
        text.push_str(&format!("{name} = {value}\n"));
    }
    let (horizontal, settings) = match &inputs.excitation {
        Excitation::Embedded => (EMBEDDED_PATH, &Vec::new()),
        Excitation::File { name, settings } => (name.as_str(), settings),
        Excitation::Pulse | Excitation::Release => return text,
    };
    text.push_str(&format!("\n[[records]]\nhorizontal = {}\n", quoted(horizontal)));
    let mut settings = settings.clone();
    if let Some((name, vertical_settings)) = vertical {
        text.push_str(&format!("vertical = {}\n", quoted(name)));
        settings.extend(vertical_settings.iter().cloned());
    }
    for (setting, value) in settings {
        let is_number = setting.ends_with("dt") || value.parse::<u32>().is_ok();
        text.push_str(&format!("{setting} = {}\n", if is_number { value } else { quoted(&value) }));
    }
    text
}

/// A number of TOML, in the digits that restore it exactly.
fn decimal(value: f64) -> String {
    format!("{value:?}")
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_strings_are_those_of_toml() {
        assert_eq!([0.1, 1.0, 1e-7, 1e22].map(decimal), ["0.1", "1.0", "1e-7", "1e22"]);
        assert_eq!(quoted("a \"b\" \\c"), r#""a \"b\" \\c""#);
    }
}
