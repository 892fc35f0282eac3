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

/// Returns the results of a bar with their grey levels, the farthest from the middle first: of two on one side, the shorter lies over the longer.
fn ends(bar: &Bar, middle: f64) -> Vec<(f64, u8)> {
    let mut ends: Vec<(f64, u8)> =
        bar.results.into_iter().zip([LOW, HIGH]).filter_map(|(result, grey)| Some((result?, grey))).collect();
    ends.sort_by(|(a, _), (b, _)| (b - middle).abs().total_cmp(&(a - middle).abs()));
    ends
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
        let bars = ends(bar, middle).into_iter().map(|(result, grey)| Tile {
            x: result.min(middle)..result.max(middle),
            y: bottom + 0.12..bottom + 0.55,
            grey,
        });
        tiles.extend(bars);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever end is farther from the middle, it is drawn first.
    #[test]
    fn the_shorter_of_two_bars_on_one_side_is_seen() {
        let bar = |results| Bar { name: "a".into(), values: [1.0, 2.0], results };
        assert_eq!(ends(&bar([Some(1.1), Some(1.3)]), 1.0), [(1.3, HIGH), (1.1, LOW)]);
        assert_eq!(ends(&bar([Some(1.3), Some(1.1)]), 1.0), [(1.3, LOW), (1.1, HIGH)]);
        assert_eq!(ends(&bar([Some(0.6), None]), 1.0), [(0.6, LOW)]);
    }
}
