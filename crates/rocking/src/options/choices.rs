//! Words of the command line → choices of the engine, each with a line of help.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use rocking_block::simulation::OnSeparation;
use rocking_charts::picture::PictureFormat;
use rocking_charts::spectrum::Abscissa;
use rocking_studies::fragility::{Link, LossProgram};
use rocking_studies::spec::words::Words;

/// Returns a parser of the words of these values.
fn choice<T: Words + Send + Sync>(values: &[(T, &'static str)]) -> impl TypedValueParser<Value = T> + use<T> {
    let words = values.iter().map(|(value, help)| PossibleValue::new(value.word()).help(*help));
    PossibleValuesParser::new(words).try_map(|word| T::named(&word).ok_or("expected a known word"))
}

/// Action at complete separation.
pub fn on_separation() -> impl TypedValueParser<Value = OnSeparation> {
    choice(&[
        (OnSeparation::Terminate, "End the run, as in the paper's analysis"),
        (OnSeparation::Fly, "Follow the block through flight and landing"),
    ])
}

/// Program of loss assessment.
pub fn loss_program() -> impl TypedValueParser<Value = LossProgram> {
    choice(&[
        (LossProgram::Pelicun, "Component library: fragility.csv and fragility.json"),
        (LossProgram::OpenQuake, "Fragility model: NRML 0.5"),
    ])
}

/// Format of a picture.
pub fn picture_format() -> impl TypedValueParser<Value = PictureFormat> {
    choice(&[(PictureFormat::Png, "Pixels"), (PictureFormat::Svg, "Lines and text that scale")])
}

/// Distribution of a fragility curve.
pub fn link() -> impl TypedValueParser<Value = Link> {
    choice(&[(Link::Probit, "Normal distribution: lognormal fragility"), (Link::Logit, "Logistic distribution")])
}

/// Horizontal axis of a spectrum.
pub fn abscissa() -> impl TypedValueParser<Value = Abscissa> {
    choice(&[
        (Abscissa::TwoPiOverP, "2 pi/p in seconds"),
        (Abscissa::PulseRatio, "Frequency of the pulse over that of the block"),
    ])
}
