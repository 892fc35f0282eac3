//! Words of the command line → choices of the engine, each with a line of help.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use rocking_block::block::Foundation;
use rocking_block::excitation::PulseShape;
use rocking_block::simulation::OnSeparation;
use rocking_block::words::Words;
use rocking_charts::picture::PictureFormat;
use rocking_charts::spectrum::Abscissa;
use rocking_studies::fragility::{Link, LossProgram};

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

/// Foundation under the block.
pub fn foundation() -> impl TypedValueParser<Value = Foundation> {
    choice(&[
        (Foundation::Viscoelastic, "A spring and a dashpot under each corner"),
        (Foundation::Rigid, "Housner's rigid base"),
    ])
}

/// Shape of a pulse.
pub fn pulse_shape() -> impl TypedValueParser<Value = PulseShape> {
    choice(&[
        (PulseShape::None, "No pulse"),
        (PulseShape::OneSine, "Type A: one sine of acceleration"),
        (PulseShape::OneCosine, "Type B: one cosine of acceleration"),
        (PulseShape::C1, "Type C1: one cycle of displacement and back"),
        (PulseShape::C2, "Type C2: two cycles of displacement and back"),
        (PulseShape::HalfSine, "Half a sine of acceleration, T_p/2 long"),
        (PulseShape::Rectangular, "Constant acceleration, T_p long"),
        (PulseShape::SymmetricRicker, "Symmetric Ricker wavelet, 3 T_p long"),
        (PulseShape::AntisymmetricRicker, "Antisymmetric Ricker wavelet, 4 T_p long"),
        (PulseShape::Gabor, "Wavelet of Mavroeidis and Papageorgiou (2003), --cycles T_p long, with --phase"),
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
