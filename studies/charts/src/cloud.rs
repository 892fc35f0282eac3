//! A cloud → a picture.

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, logarithmic};
use crate::fragility::axis;
use crate::line_style::LineStyle;
use crate::numerals::significant;
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use rocking_studies::fragility::{Cloud, Share};
use rocking_studies::statistics::range;

/// Height of the chart.
const HEIGHT: u32 = 9000;
/// Space beyond the points on each side, relative to the range of their logarithms.
const MARGIN: f64 = 0.06;

/// Draws the runs that rock and stand, their median and one standard deviation to either side, on logarithmic axes.
///
/// `blocks` describes the blocks; `heading` is name and unit of the measure.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn cloud(blocks: &str, found: &Cloud, heading: &str) -> Result<String, PictureError> {
    let log = |i: usize| found.points.iter().map(move |point| libm::log10(point[i]));
    let spans = [0, 1].map(|i| {
        let [low, high] = range(log(i)).unwrap_or([0.0, 1.0]);
        let margin = MARGIN * (high - low).max(0.1);
        low - margin..high + margin
    });
    let [x, y] = spans.clone();
    let [abscissas, ordinates] =
        spans.each_ref().map(|span| logarithmic(&(libm::pow(10.0, span.start)..libm::pow(10.0, span.end))));
    // On logarithmic axes the median is a straight line.
    let line = |deviations: f64| -> Vec<(f64, f64)> {
        let shift = deviations * found.line.deviation * std::f64::consts::LOG10_E;
        [x.start, x.end].map(|at| (at, libm::log10(found.median(libm::pow(10.0, at))) + shift)).to_vec()
    };
    let grid = abscissas.iter().map(|(at, _)| vec![(*at, y.start), (*at, y.end)]);
    let grid = grid.chain(ordinates.iter().map(|(at, _)| vec![(x.start, *at), (x.end, *at)])).collect();
    let curves = [
        Curve::new(LineStyle::GRID, grid),
        Curve::new(LineStyle::BLACK, vec![line(0.0)]),
        Curve::new(LineStyle::DASHED, vec![line(-1.0), line(1.0)]),
    ];
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: (&axis, x.clone()),
        y: (&format!("peak {}", found.rotation), y.clone()),
        curves: curves.into(),
        marks: log(0).zip(log(1)).map(|point| (Mark::Circle, point)).collect(),
        names: ordinates,
        abscissas,
        ..Chart::default()
    };
    let legend = [
        (Symbol::Mark(Mark::Circle), "a run that rocks and stands".to_string()),
        (Symbol::Curve(LineStyle::BLACK), "median".into()),
        (Symbol::Curve(LineStyle::DASHED), "one standard deviation to either side".into()),
    ];
    let [_, b] = found.line.coefficients;
    let title = format!(
        "{} runs: b = {}, β = {}, R² = {}",
        found.points.len(),
        significant(b, 3),
        significant(found.line.deviation, 3),
        significant(found.r_squared, 3)
    );
    let of = |share: &Share, what: &str| {
        let [exceeded, rows] = share.counts();
        format!("{exceeded} of {rows} {what}")
    };
    let shares = [of(&found.overturning, "runs overturn"), of(&found.rocking, "that stand rock")].join(", ");
    page(&[title, shares, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}
