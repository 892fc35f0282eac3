//! A result at both ends of the ranges of several quantities → a tornado chart.

use crate::chart::{Chart, Curve, Tile};
use crate::fragility::axis;
use crate::line_style::LineStyle;
use crate::numerals::short;
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use rocking_studies::statistics::range;

/// Height of a bar with its label, and of the axis under the bars.
const ROW: u32 = 1150;
const AXIS: u32 = 1400;
/// Grey levels of the bars for the low and the high end of a range.
const LOW: u8 = 195;
const HIGH: u8 = 120;
/// Space beyond the bars, relative to their extent, and the least extent relative to the middle.
const MARGIN: f64 = 0.15;
const MIN_RANGE: f64 = 0.02;

/// A quantity, its range, and the results at both ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Name and unit.
    pub name: String,
    /// Both ends of the range.
    pub values: [f64; 2],
    /// The results there, where they lie within the runs.
    pub results: [Option<f64>; 2],
}

/// Draws the bars, the longest on top; `middle` is the result without a change, `heading` name and unit of the result.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn tornado(title: &str, heading: &str, middle: f64, bars: &[Bar]) -> Result<String, PictureError> {
    let reach = |bar: &Bar| {
        let offsets = bar.results.into_iter().flatten().map(|result| (result - middle).abs());
        offsets.fold(0.0, f64::max)
    };
    let mut sorted: Vec<&Bar> = bars.iter().collect();
    sorted.sort_by(|a, b| reach(b).total_cmp(&reach(a)));
    let results = bars.iter().flat_map(|bar| bar.results).flatten().chain([middle]);
    let [low, high] = range(results).unwrap_or([middle; 2]);
    let margin = MARGIN * (high - low).max(MIN_RANGE * middle.abs());
    let x = low - margin..high + margin;
    let rows = sorted.len() as f64;
    let (mut tiles, mut notes) = (Vec::new(), Vec::new());
    for (number, bar) in sorted.iter().enumerate() {
        let bottom = rows - 1.0 - number as f64;
        for (result, grey) in bar.results.into_iter().zip([LOW, HIGH]) {
            let Some(result) = result else { continue };
            tiles.push(Tile { x: result.min(middle)..result.max(middle), y: bottom + 0.12..bottom + 0.55, grey });
        }
        let [from, to] = bar.values.map(short);
        let missing = match bar.results {
            [Some(_), Some(_)] => "",
            [None, Some(_)] => "; beyond the runs at the low end",
            [Some(_), None] => "; beyond the runs at the high end",
            [None, None] => "; beyond the runs at both ends",
        };
        let at = (x.start + 0.01 * (x.end - x.start), bottom + 0.78);
        notes.push((at, format!("{} from {from} to {to}{missing}", bar.name)));
    }
    let (axis, _) = axis(heading);
    let chart = Chart {
        x: (&axis, x),
        y: ("", 0.0..rows.max(1.0)),
        curves: vec![Curve::new(LineStyle::DASHED, vec![vec![(middle, 0.0), (middle, rows.max(1.0))]])],
        tiles,
        notes,
        // No numbers at the ordinate.
        names: vec![(0.0, "".into())],
        ..Chart::default()
    };
    let legend = [
        (Symbol::Grey(LOW), "low end of the range".to_string()),
        (Symbol::Grey(HIGH), "high end of the range".into()),
        (Symbol::Curve(LineStyle::DASHED), "the study as it is".into()),
    ];
    page(&[title.into()], &legend, ROW * sorted.len().max(1) as u32 + AXIS, |root, area| chart.draw(root, area))
}
