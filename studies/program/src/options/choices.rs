//! Words of the command line → choices of the engine, each with a line of help.

use clap::builder::TypedValueParser;

use rocking_charts::picture::PictureFormat;
use rocking_charts::spectrum::Abscissa;
use rocking_studies::fragility::{Link, LossProgram};
use rocking_studies::output::format::TableFormat;
use rocking_studies::spec::choice;

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

/// Format of a table.
pub fn table_format() -> impl TypedValueParser<Value = TableFormat> {
    choice(&[(TableFormat::Csv, "Comma-separated values"), (TableFormat::Parquet, "Typed columns, compressed")])
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
