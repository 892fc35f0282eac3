//! Changes to a record: its trend, a filter, another time step.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Changes to a record, applied in this order; none by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Processing {
    /// Whether to subtract the line that fits the accelerations best, by least squares.
    pub baseline: bool,
    /// Corner frequencies of a band-pass filter (Hz).
    ///
    /// It is a Butterworth filter of order 4, run forwards and backwards so that it has no phase; each corner keeps half of the amplitude. As
    /// usual for accelerograms, zeros are put before and after the record for the filter's transients, `1.5 · 4/f` long with the
    /// lower corner f (A. M. Converse, A. G. Brady, BAP: Basic strong-motion accelerogram processing software, USGS Open-File Report 92-296A, 1992),
    /// and removed afterwards.
    pub band_pass: Option<[f64; 2]>,
    /// New time step (s), with accelerations linear between the samples.
    pub resample: Option<f64>,
}

impl Processing {
    /// Whether the record stays unchanged.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Processing::default()
    }
}

/// The changes in words, empty without any. An example is `baseline removed, band-pass 0.1 to 25 Hz, resampled every 0.005 s`.
impl fmt::Display for Processing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Processing { baseline, band_pass, resample } = self;
        let parts = [
            baseline.then(|| "baseline removed".to_owned()),
            band_pass.map(|[low, high]| format!("band-pass {low} to {high} Hz")),
            resample.map(|step| format!("resampled every {step} s")),
        ];
        f.write_str(&parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}
