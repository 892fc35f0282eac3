//! Annual rates of several objects → a chart that ranks them.

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, logarithmic};
use crate::line_style::LineStyle;
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use crate::rate::NEGLIGIBLE;
use rocking_studies::fragility::Interval;
use rocking_studies::statistics::range;

/// Height of an object with its name, and of the axis under all.
const ROW: u32 = 1050;
const AXIS: u32 = 1400;
/// Powers of ten below the least rate after which intervals leave the chart.
const DECADES: f64 = 2.0;
/// Space beyond the greatest number, in powers of ten.
const MARGIN: f64 = 0.15;

/// An object with its annual rate (1/year).
#[derive(Clone, Debug, PartialEq)]
pub struct RankedRate {
    /// Its name.
    pub name: String,
    /// The rate.
    pub rate: f64,
    /// Its interval; an end without a bound is `None`.
    pub interval: Interval,
}

/// Draws the rates as points over their intervals on a logarithmic axis, the first on top. `None` without two rates that are written as numbers.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn ranking(rates: &[RankedRate], confidence: f64) -> Result<Option<String>, PictureError> {
    let shown: Vec<&RankedRate> = rates.iter().filter(|of| of.rate >= NEGLIGIBLE && of.rate.is_finite()).collect();
    let Some([low, high]) = range(shown.iter().map(|of| of.rate)).filter(|_| shown.len() > 1) else { return Ok(None) };
    let greatest = shown.iter().filter_map(|of| of.interval[1]).fold(high, f64::max);
    let least = shown.iter().filter_map(|of| of.interval[0]).fold(low, f64::min);
    let x = libm::log10(least).max(libm::log10(low) - DECADES) - MARGIN..libm::log10(greatest) + MARGIN;
    let rows = shown.len() as f64;
    let abscissas = logarithmic(&(libm::pow(10.0, x.start)..libm::pow(10.0, x.end)));
    let grid = abscissas.iter().map(|(at, _)| vec![(*at, 0.0), (*at, rows)]).collect();
    let (mut intervals, mut marks, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for (number, of) in shown.iter().enumerate() {
        let bottom = rows - 1.0 - number as f64;
        let middle = bottom + 0.3;
        // An end without a bound is at the edge, as one beyond it.
        let [low, high] = of.interval.map(|end| end.map(libm::log10));
        let ends = [low.unwrap_or(x.start).max(x.start), high.unwrap_or(x.end)];
        intervals.push(ends.map(|end| (end, middle)).to_vec());
        marks.push((Mark::Circle, (libm::log10(of.rate), middle)));
        notes.push(((x.start + 0.01 * (x.end - x.start), bottom + 0.7), of.name.clone()));
    }
    let chart = Chart {
        x: ("annual rate (1/year)", x),
        y: ("", 0.0..rows),
        curves: vec![Curve::new(LineStyle::GRID, grid), Curve::new(LineStyle::WIDE_GREY, intervals)],
        marks,
        notes,
        abscissas,
        // No numbers at the ordinate.
        names: vec![(0.0, "".into())],
        ..Chart::default()
    };
    let interval = format!("{} % confidence, up to the edge where it has no bound or ends beyond", 100.0 * confidence);
    let legend = [(Symbol::Mark(Mark::Circle), "rate".to_string()), (Symbol::Curve(LineStyle::WIDE_GREY), interval)];
    let height = ROW * shown.len() as u32 + AXIS;
    page(&[], &legend, height, |root, area| chart.draw(root, area)).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_without_a_number_are_left_out() {
        let of = |name: &str, rate| RankedRate { name: name.into(), rate, interval: [Some(0.1 * rate), None] };
        let rates = [of("tall", 1e-3), of("broad", 2e-5), of("flat", 1e-15)];
        let picture = ranking(&rates, 0.95).unwrap().unwrap();
        assert!(["tall", "broad", "1e-5", "1e-4", "0.001"].iter().all(|text| picture.contains(text)), "{picture}");
        assert!(!picture.contains("flat"));
        assert_eq!(ranking(&rates[1..], 0.95).unwrap(), None);
    }
}
