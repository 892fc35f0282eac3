//! A record → its acceleration and velocity over time, and its response spectrum.

use crate::chart::{Chart, Curve, extents};
use crate::history::thinned;
use crate::line_style::LineStyle;
use crate::page::stacked;
use crate::picture::PictureError;
use rocking_records::Record;
use rocking_studies::intensity::spectral_acceleration;

/// Heights of the charts.
const HEIGHTS: [u32; 3] = [4000, 4000, 5200];
/// Greatest period of the spectrum (s), and its points.
const GREATEST_PERIOD: f64 = 4.0;
const PERIODS: u32 = 400;

/// Draws a record. The velocity starts at rest, without a correction of the baseline; the spectrum has 5 % damping.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn record(record: &Record, title: &str) -> Result<String, PictureError> {
    let mut rows: Vec<[f64; 3]> = Vec::with_capacity(record.acceleration.len());
    for (number, &acceleration) in record.acceleration.iter().enumerate() {
        let velocity = rows
            .last()
            .map_or(0.0, |[_, before, velocity]| velocity + 0.5 * record.time_step * (before + acceleration));
        rows.push([record.sample_time(number), acceleration, velocity]);
    }
    let chart = |x: &'static str, y: &'static str, points: Vec<(f64, f64)>| {
        let curves = vec![Curve::new(LineStyle::BLACK, vec![points])];
        let [_, range] = extents(&curves);
        let ends = curves[0].segments[0].iter().map(|point| point.0);
        let [start, end] = rocking_studies::statistics::range(ends).unwrap_or([0.0, 1.0]);
        Chart { x: (x, start..end), y: (y, range), curves, ..Chart::default() }
    };
    let over_time = |value: usize| thinned(&rows, |row| row[0], |row| row[value]);
    let spectrum = (1..=PERIODS).map(|i| {
        let period = GREATEST_PERIOD * f64::from(i) / f64::from(PERIODS);
        (period, spectral_acceleration(record, period))
    });
    stacked(
        &[title.into()],
        &[],
        &[
            (HEIGHTS[0], vec![], chart("", "acceleration (m/s²)", over_time(1))),
            (HEIGHTS[1], vec![], chart("time (s)", "velocity (m/s)", over_time(2))),
            (HEIGHTS[2], vec![], chart("period (s)", "Sa, 5 % damping (m/s²)", spectrum.collect())),
        ],
    )
}
