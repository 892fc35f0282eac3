//! Parameters of a pulse, some of them given → a checked pulse.

use rocking_block::excitation::{Pulse, PulseShape};
use schemars::JsonSchema;

use crate::spec::words::Words;
use crate::spec::{SpecError, limits};

/// The parameters of a pulse as a user gives them; others have their defaults.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct PulseSpec {
    /// Pulse, alone or added to the record [default: none]
    #[schemars(skip)]
    #[cfg_attr(feature = "clap", arg(id = "pulse", long = "pulse", value_name = "SHAPE", value_parser = shapes()))]
    pub shape: Option<PulseShape>,
    /// Acceleration amplitude a_p of the pulse [m/s2]
    #[cfg_attr(feature = "clap", arg(long, value_name = "A"))]
    pub amplitude: Option<f64>,
    /// Period T_p of the pulse [s] [default: 1]
    #[schemars(extend("exclusiveMinimum" = 0))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub period: Option<f64>,
    /// Start time of the pulse [s] [default: 0]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub start: Option<f64>,
    /// Further parameters of a Gabor pulse.
    #[schemars(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    pub gabor: GaborSpec,
}

/// Phase and duration of a Gabor pulse as a user gives them.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Debug, Default, PartialEq, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct GaborSpec {
    /// Phase nu of the velocity in the middle of a Gabor pulse [rad] [default: 0]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD"))]
    pub phase: Option<f64>,
    /// Duration gamma of a Gabor pulse in periods, at least 1 [default: 2]
    #[schemars(range(min = 1))]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N"))]
    pub cycles: Option<f64>,
}

/// Returns the shape and the numbers of a pulse, without its start, in one line.
pub fn text(pulse: &Pulse) -> String {
    let Pulse { shape, amplitude, period, phase, cycles, .. } = pulse;
    let common = format!("{} pulse, a_p = {amplitude} m/s², T_p = {period} s", shape.word());
    match shape {
        PulseShape::Gabor => format!("{common}, ν = {phase} rad, γ = {cycles}"),
        _ => common,
    }
}

impl PulseSpec {
    /// Whether there is a pulse.
    pub fn has_shape(&self) -> bool {
        self.shape.is_some_and(|shape| shape != PulseShape::None)
    }

    /// Returns the pulse, of shape `none` if there is none.
    ///
    /// # Errors
    /// The first parameter that would not be read, that is missing, or that is out of range.
    pub fn pulse(&self) -> Result<Pulse, SpecError> {
        match (self.has_shape(), self.amplitude) {
            (true, None) => Err(SpecError::Lacks { parameter: "pulse", missing: "`amplitude`; expected both" }),
            (true, Some(0.0)) => Err(SpecError::OutOfRange {
                parameter: "amplitude".into(),
                value: 0.0,
                expected: "an acceleration a_p other than 0 m/s2".into(),
            }),
            (_, amplitude) => self.with_amplitude(amplitude),
        }
    }

    /// Returns the pulse with this amplitude (m/s²), if any. It serves searches of the amplitude, and rows of several.
    ///
    /// # Errors
    /// The first parameter that would not be read, or that is out of range.
    pub fn with_amplitude(&self, amplitude: Option<f64>) -> Result<Pulse, SpecError> {
        let given = [("amplitude", amplitude), ("period", self.period), ("start", self.start)];
        if let (false, Some((parameter, _))) = (self.has_shape(), given.iter().find(|(_, value)| value.is_some())) {
            return Err(SpecError::NoEffect { parameter, why: "without `pulse`" });
        }
        limits::check::<PulseSpec>(&given)?;
        let pulse = Pulse {
            shape: self.shape.unwrap_or(PulseShape::None),
            amplitude: amplitude.unwrap_or(0.0),
            period: self.period.unwrap_or(Pulse::NONE.period),
            start: self.start.unwrap_or(Pulse::NONE.start),
            ..Pulse::NONE
        };
        self.gabor.of(pulse)
    }
}

impl GaborSpec {
    /// Returns the pulse with this phase and this duration, which only a Gabor pulse has.
    ///
    /// # Errors
    /// A parameter that would not be read, or that is out of range.
    pub fn of(&self, pulse: Pulse) -> Result<Pulse, SpecError> {
        let given = [("phase", self.phase), ("cycles", self.cycles)];
        if let (true, Some((parameter, _))) =
            (pulse.shape != PulseShape::Gabor, given.iter().find(|(_, value)| value.is_some()))
        {
            return Err(SpecError::NoEffect { parameter, why: "without `pulse = gabor`" });
        }
        limits::check::<GaborSpec>(&given)?;
        let [phase, cycles] = [self.phase.unwrap_or(pulse.phase), self.cycles.unwrap_or(pulse.cycles)];
        Ok(Pulse { phase, cycles, ..pulse })
    }
}

/// The words of shapes as options, with a line of help for each.
#[cfg(feature = "clap")]
pub fn shapes() -> impl clap::builder::TypedValueParser<Value = PulseShape> {
    super::choices(|shape| match shape {
        PulseShape::None => "No pulse",
        PulseShape::OneSine => "Type A: one sine of acceleration",
        PulseShape::OneCosine => "Type B: one cosine of acceleration",
        PulseShape::C1 => "Type C1: one cycle of displacement and back",
        PulseShape::C2 => "Type C2: two cycles of displacement and back",
        PulseShape::HalfSine => "Half a sine of acceleration, T_p/2 long",
        PulseShape::Rectangular => "Constant acceleration, T_p long",
        PulseShape::SymmetricRicker => "Symmetric Ricker wavelet, 3 T_p long",
        PulseShape::AntisymmetricRicker => "Antisymmetric Ricker wavelet, 4 T_p long",
        PulseShape::Gabor => "Wavelet of Mavroeidis and Papageorgiou (2003), --cycles T_p long, with --phase",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_a_pulse_does_not_read_or_lacks_are_refused() {
        let some = Some(1.0);
        let sine = PulseSpec { shape: Some(PulseShape::OneSine), amplitude: some, ..PulseSpec::default() };
        let phase = GaborSpec { phase: some, cycles: None };
        let few = GaborSpec { phase: None, cycles: Some(0.5) };
        for (spec, expected) in [
            (PulseSpec { period: some, ..PulseSpec::default() }, "<period> has no effect without <pulse>"),
            (PulseSpec { gabor: phase.clone(), ..sine.clone() }, "<phase> has no effect without <pulse = gabor>"),
            (PulseSpec { amplitude: None, ..sine.clone() }, "<pulse> without <amplitude>; expected both"),
            (
                PulseSpec { amplitude: Some(0.0), ..sine.clone() },
                "<amplitude> = 0; expected an acceleration a_p other than 0 m/s2",
            ),
            (PulseSpec { period: Some(0.0), ..sine.clone() }, "<period> = 0; expected a time > 0 s"),
            (PulseSpec { start: Some(f64::NAN), ..sine.clone() }, "<start> = NaN; expected a finite time in s"),
            (
                PulseSpec { shape: Some(PulseShape::Gabor), gabor: few, ..sine.clone() },
                "<cycles> = 0.5; expected a number of at least 1",
            ),
        ] {
            assert_eq!(spec.pulse().unwrap_err().spelled(|name| format!("<{name}>")), expected);
        }
        assert_eq!(PulseSpec::default().pulse(), Ok(Pulse::NONE));
        let gabor = PulseSpec { shape: Some(PulseShape::Gabor), gabor: phase, ..sine };
        assert_eq!(gabor.pulse(), Ok(Pulse { shape: PulseShape::Gabor, amplitude: 1.0, phase: 1.0, ..Pulse::NONE }));
    }
}
