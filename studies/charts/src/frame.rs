//! The history of a frame → its rotation, the way of its beam and the forces of its columns over time.

use crate::chart::{Chart, Curve, extents};
use crate::history::thinned;
use crate::line_style::LineStyle;
use crate::page::{Symbol, stacked};
use crate::picture::PictureError;
use rocking_studies::frame::{Frame, FrameResponse};
use rocking_studies::run::History;

/// Heights of the charts.
const HEIGHTS: [u32; 3] = [4200, 3800, 4800];

/// Draws the history of a frame.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn frame(frame: &Frame, history: &History, title: &str) -> Result<String, PictureError> {
    let rows: Vec<(f64, f64, FrameResponse)> =
        history.rows.iter().map(|row| (row.time, row.observation.theta, frame.response_in(row))).collect();
    type Of<'a> = &'a dyn Fn(&(f64, f64, FrameResponse)) -> f64;
    let end = rows.last().map_or(1.0, |row| row.0);
    let chart = |x: &'static str, y: &'static str, values: &[(LineStyle, Of)]| {
        let line = |(style, value): &(LineStyle, Of)| Curve::new(*style, vec![thinned(&rows, |row| row.0, value)]);
        let curves: Vec<Curve> = values.iter().map(line).collect();
        let [_, range] = extents(&curves);
        Chart { x: (x, rows.first().map_or(0.0, |row| row.0)..end), y: (y, range), curves, ..Chart::default() }
    };
    let alpha = frame.column.alpha;
    let charts = [
        chart("", "θ/α", &[(LineStyle::BLACK, &|row| row.1 / alpha)]),
        chart("", "beam (m)", &[(LineStyle::BLACK, &|row| row.2.beam[0])]),
        chart(
            "time (s)",
            "force of a column (kN)",
            &[(LineStyle::FAINT, &|row| 1e-3 * row.2.base[1]), (LineStyle::DASHED, &|row| 1e-3 * row.2.base[0])],
        ),
    ];
    let legend = [
        (Symbol::Curve(LineStyle::FAINT), "vertical force of the base".to_string()),
        (Symbol::Curve(LineStyle::DASHED), "horizontal force of the base".into()),
    ];
    let charts: Vec<_> = HEIGHTS.into_iter().zip(charts).map(|(height, chart)| (height, vec![], chart)).collect();
    stacked(&[title.into()], &legend, &charts)
}
