//! Stripes and their curve → a picture.

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, range};
use crate::fragility::{axis, band, probability_of, spread};
use crate::line_style::LineStyle;
use crate::numerals::{short, significant};
use crate::page::{Symbol, page};
use crate::picture::PictureError;
use rocking_studies::fragility::{Assessment, Limit, Stripe};

/// Height of the chart.
const HEIGHT: u32 = 9000;
/// Points of the curve and of its band.
const POINTS: u32 = 600;

/// Draws the fraction of the runs at each level, and the curve with its band.
///
/// `blocks` describes the blocks; `heading` is name and unit of the measure.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn stripes(
    blocks: &str,
    stripes: &[Stripe],
    found: &Assessment,
    heading: &str,
    limit: Limit,
    confidence: f64,
) -> Result<String, PictureError> {
    let x = range(stripes.iter().map(|stripe| stripe.level));
    let at = spread(x.end, POINTS);
    let curve = at.iter().map(|&measure| (measure, found.fit.probability(&[measure]))).collect();
    let (axis, unit) = axis(heading);
    let ordinate = probability_of(limit);
    // On the side of the mark that is away from the curve.
    let note = |stripe: &Stripe| {
        let (fraction, text) = (stripe.fraction(), format!("{}/{}", short(stripe.exceeded), stripe.runs));
        let [aside, above] =
            if fraction > found.fit.probability(&[stripe.level]) { [-0.03, 0.06] } else { [0.004, -0.05] };
        ((stripe.level + aside * x.end, fraction + above), text)
    };
    let chart = Chart {
        x: (&axis, x.clone()),
        y: (&ordinate, -0.08..1.08),
        areas: vec![band(&at, &found.band(&at))],
        curves: vec![Curve::new(LineStyle::BLACK, vec![curve])],
        marks: stripes.iter().map(|stripe| (Mark::Circle, (stripe.level, stripe.fraction()))).collect(),
        notes: stripes.iter().map(note).collect(),
        ..Chart::default()
    };
    let mut legend = vec![
        (Symbol::Curve(LineStyle::BLACK), "curve of maximum likelihood".to_string()),
        (Symbol::Mark(Mark::Circle), "fraction of the runs at a level, with their numbers".into()),
    ];
    if chart.shows_band() {
        legend.insert(1, (Symbol::Band, format!("{} % confidence", short(100.0 * confidence))));
    }
    let title = format!(
        "{} levels, {} runs: median {}{unit}, β = {}",
        stripes.len(),
        found.rows,
        significant(found.fit.median(), 4),
        significant(found.fit.dispersion(), 4)
    );
    page(&[title, blocks.into()], &legend, HEIGHT, |root, area| chart.draw(root, area))
}
