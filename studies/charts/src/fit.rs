//! A fit to tests → measured and fitted values and their residuals over time.

use crate::chart::{Chart, Curve, extents};
use crate::formula::formula;
use crate::history::{block_line, thinned};
use crate::line_style::LineStyle;
use crate::page::{StackedChart, Symbol, stacked};
use crate::picture::PictureError;
use rocking_studies::fit::{Fit, TestFit};

/// Heights of the charts of a test: values, residuals.
const HEIGHTS: [u32; 2] = [5200, 3800];

/// Draws each test with its fit, and the residuals under it.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn fit(fit: &Fit, title: &str) -> Result<String, PictureError> {
    let heading = [title.into(), formula(&block_line(&fit.block))];
    let legend = [
        (Symbol::Curve(LineStyle::WIDE_GREY), "measured".to_string()),
        (Symbol::Curve(LineStyle::THIN), "fitted".to_string()),
    ];
    let charts = fit.tests.iter().enumerate().flat_map(|(number, test)| charts(number, test, fit));
    let all: Vec<StackedChart> =
        charts.zip(HEIGHTS.into_iter().cycle()).map(|(chart, height)| (height, vec![], chart)).collect();
    stacked(&heading, &legend, &all)
}

fn charts<'a>(number: usize, test: &TestFit, fit: &Fit) -> [Chart<'a>; 2] {
    let TestFit { output, unit, times, measured, fitted, residuals, durbin_watson, .. } = test;
    let start = times.first().copied().unwrap_or(0.0);
    let end = times.last().copied().unwrap_or(1.0);
    let rows: Vec<[f64; 4]> = (0..times.len()).map(|i| [times[i], measured[i], fitted[i], residuals[i]]).collect();
    let curve = |style, value: usize| Curve::new(style, vec![thinned(&rows, |row| row[0], |row| row[value])]);
    let of_test = if fit.tests.len() > 1 { format!("test {}: ", number + 1) } else { String::new() };
    let chart = |title: String, x, curves: Vec<Curve>| {
        let [_, y] = extents(&curves);
        Chart { title, x: (x, start..end), y: ("", y), curves, ..Chart::default() }
    };
    // An underscore would mark a subscript.
    let title = format!("{of_test}{} ({unit})", output.replace('_', " "));
    let below = format!("measured less fitted; Durbin–Watson {durbin_watson:.2}, white noise 2");
    [
        chart(title, "", vec![curve(LineStyle::WIDE_GREY, 1), curve(LineStyle::THIN, 2)]),
        chart(below, "time (s)", vec![curve(LineStyle::THIN, 3)]),
    ]
}
