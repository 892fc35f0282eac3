//! A record and the pulse fitted to it → accelerations and velocities over time.

use crate::chart::{Chart, Curve, extents};
use crate::formula::formula;
use crate::history::thinned;
use crate::line_style::LineStyle;
use crate::page::{Symbol, stacked};
use crate::picture::PictureError;
use rocking_block::excitation::Pulse;
use rocking_studies::pulse_fit::{FitSample, PulseFit};
use rocking_studies::spec::pulse::text;

/// Heights of the charts of accelerations and velocities.
const HEIGHTS: [u32; 2] = [4600, 5200];

/// Draws record and pulse. The time goes from a pulse's duration before its start to a duration after its end.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn pulse_fit(samples: &[FitSample], fit: &PulseFit, title: &str) -> Result<String, PictureError> {
    let duration = fit.pulse.duration();
    let ends = [fit.pulse.start - duration, fit.pulse.end() + duration];
    let shown: Vec<FitSample> =
        samples.iter().filter(|sample| (ends[0]..=ends[1]).contains(&sample.time)).copied().collect();
    let start = shown.first().map_or(0.0, |sample| sample.time);
    let end = shown.last().map_or(1.0, |sample| sample.time);
    let chart = |x: &'static str, y: &'static str, values: [&dyn Fn(&FitSample) -> f64; 2]| {
        let line = |value| vec![thinned(&shown, |sample| sample.time, value)];
        let [record, pulse] = values.map(line);
        let curves = vec![Curve::new(LineStyle::FAINT, record), Curve::new(LineStyle::BLACK, pulse)];
        let [_, range] = extents(&curves);
        Chart { x: (x, start..end), y: (y, range), curves, ..Chart::default() }
    };
    let accelerations =
        chart("", "acceleration (m/s²)", [&|sample| sample.acceleration[0], &|sample| sample.acceleration[1]]);
    let velocities = chart("time (s)", "velocity (m/s)", [&|sample| sample.velocity[0], &|sample| sample.velocity[1]]);
    let digits = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
    let Pulse { shape, amplitude, period, start, phase, cycles } = fit.pulse;
    let [amplitude, period, phase, cycles] = [amplitude, period, phase, cycles].map(digits);
    let shown_pulse = Pulse { shape, amplitude, period, start, phase, cycles };
    let shown_pulse = text(&shown_pulse).replace("= -", "= −");
    let heading = [title.into(), formula(&format!("{shown_pulse}; R² = {:.3} of the velocity", fit.r_squared))];
    let legend = [
        (Symbol::Curve(LineStyle::FAINT), "record".to_string()),
        (Symbol::Curve(LineStyle::BLACK), "pulse".to_string()),
    ];
    stacked(&heading, &legend, &[(HEIGHTS[0], vec![], accelerations), (HEIGHTS[1], vec![], velocities)])
}
