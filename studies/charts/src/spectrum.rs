//! The table of a spectrum → peak rotations over size, with separation and overturning.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::chart::{Chart, Curve, EVEN_BALANCE, Fill, MAX_ROTATION, OutcomeBar, bars_height, rotations};
use crate::formula::formula;
use crate::labels;
use crate::line_style::LineStyle;
use crate::numerals::{short, significant};
use crate::page::{Key, Symbol, page};
use crate::picture::PictureError;
use rocking_block::block::Supports;
use rocking_block::excitation::Pulse;
use rocking_studies::run::outcome::End;
use rocking_studies::spec::words::Words;
use rocking_studies::spectrum::statistics::BlockOutcome;
use rocking_studies::spectrum::{FoundationCurve, Spectrum};

/// Maximum number of stretches of a curve.
const STRETCHES: u64 = 1500;

/// Abscissa of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abscissa {
    /// 2π/p (s).
    TwoPiOverP,
    /// Frequency ratio ω_p/p of pulse and block (1).
    PulseRatio,
}

impl Words for Abscissa {
    const WORDS: &'static [(&'static str, Abscissa)] =
        &[("2pi/p", Abscissa::TwoPiOverP), ("omega_p/p", Abscissa::PulseRatio)];
}

/// A stretch of a curve. It is so short that a picture cannot show more than four of its points.
#[derive(Clone, Debug, Default)]
struct Stretch {
    from: f64,
    to: f64,
    /// First, least, greatest and last value with their abscissas, in the order of the abscissas.
    points: Vec<(f64, f64)>,
    /// Whether some of its blocks had each outcome of [`Fill::ALL`].
    outcomes: [bool; Fill::ALL.len()],
    /// Whether some of its blocks have no peak rotation, so that the line breaks here.
    is_broken: bool,
}

impl Abscissa {
    /// Returns the name with the unit.
    pub(super) fn name(self) -> &'static str {
        match self {
            Abscissa::TwoPiOverP => "2π/p (s)",
            Abscissa::PulseRatio => "ω_p/p",
        }
    }

    /// Returns the abscissa of a block with this p (rad/s).
    pub(super) fn of(self, p: f64, pulse: &Pulse) -> f64 {
        match self {
            Abscissa::TwoPiOverP => TAU / p,
            Abscissa::PulseRatio => TAU / pulse.period / p,
        }
    }
}

impl Stretch {
    fn add(&mut self, x: f64, BlockOutcome { end, peak, flights, .. }: BlockOutcome) {
        self.to = x;
        self.is_broken |= end != End::Completed;
        self.outcomes[Fill::Separated as usize] |= flights > 0 && end != End::Overturned;
        match end {
            End::Completed => self.points.push((x, peak)),
            End::Separated => {}
            End::Overturned => self.outcomes[Fill::Overturned as usize] = true,
            End::Undecided => self.outcomes[Fill::Undecided as usize] = true,
            End::Failed => self.outcomes[Fill::Failed as usize] = true,
        }
        if let &[first, a, b, c, last] = self.points.as_slice() {
            let mut inner = [a, b, c];
            inner.sort_by(|a, b| a.1.total_cmp(&b.1));
            let mut kept = [inner[0], inner[2]];
            kept.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.points = vec![first, kept[0], kept[1], last];
        }
    }

    fn has(&self, fill: Fill) -> bool {
        self.outcomes[fill as usize]
    }
}

/// Draws a spectrum as SVG, with a title for the ground motion.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn spectrum(spectrum: &Spectrum, curves: &Curves, title: &str) -> Result<String, PictureError> {
    let count = curves.curves.len();
    let mut legend: Vec<_> = (0..count).map(|i| (Symbol::Curve(LineStyle::of(i)), name(spectrum, i))).collect();
    legend.extend(curves.fills());
    let chart = curves.chart(beyond(curves.highest()).unwrap_or_default());
    let heading = [heading(spectrum, title), block_line(spectrum)];
    page(&heading, &legend, 12_000 + bars_height(count), |root, body| chart.draw(root, body))
}

/// Describes peaks beyond the ordinate.
pub(super) fn beyond(highest: f64) -> Option<String> {
    let text = || format!("peaks above {} not shown; maximum {}", short(MAX_ROTATION), significant(highest, 4));
    (highest > MAX_ROTATION).then(text)
}

/// Marks the formulas of a title, except in names of record files.
pub(super) fn heading(spectrum: &Spectrum, title: &str) -> String {
    let is_pulse = spectrum.motions.iter().all(|(_, ground)| ground.end().is_none());
    if is_pulse { formula(title) } else { title.into() }
}

/// Describes the common parameters of a spectrum, with marked formulas.
pub(super) fn block_line(spectrum: &Spectrum) -> String {
    formula(&format!("α = {} rad, γ = {}", short(spectrum.alpha), short(spectrum.common.gamma)))
}

/// The curves of a spectrum, one per ground motion and foundation.
pub struct Curves {
    over: Abscissa,
    curves: Vec<Vec<Stretch>>,
}

impl Curves {
    /// Begins the curves of a spectrum.
    pub fn new(spectrum: &Spectrum, over: Abscissa) -> Curves {
        Curves { over, curves: vec![Vec::new(); spectrum.motions.len() * spectrum.bases.len()] }
    }

    /// Their abscissa.
    pub(super) fn over(&self) -> Abscissa {
        self.over
    }

    /// Includes the next blocks of the table.
    pub fn add(&mut self, spectrum: &Spectrum, outcomes: &[BlockOutcome]) {
        let count = spectrum.sizes.count;
        let size = count.div_ceil(STRETCHES);
        for &outcome in outcomes {
            let row = outcome.row;
            let x = self.over.of(spectrum.inputs(row).p, &spectrum.pulse);
            let curve = &mut self.curves[(row / count) as usize];
            if (row % count).is_multiple_of(size) {
                curve.push(Stretch { from: x, to: x, ..Stretch::default() });
            }
            if let Some(stretch) = curve.last_mut() {
                stretch.add(x, outcome);
            }
        }
    }

    /// Returns the segments of a curve between blocks without peak rotation.
    ///
    /// A block between two of these makes a single point without a line; the outcome bar shows it.
    pub(super) fn segments(&self, curve: usize) -> Vec<Vec<(f64, f64)>> {
        let mut segments = vec![Vec::new()];
        for stretch in &self.curves[curve] {
            if let Some(segment) = segments.last_mut() {
                segment.extend(&stretch.points);
            }
            if stretch.is_broken {
                segments.push(Vec::new());
            }
        }
        segments.retain(|segment| !segment.is_empty());
        segments
    }

    /// Returns the greatest peak |θ|/α of the lines.
    pub fn highest(&self) -> f64 {
        let segments = (0..self.curves.len()).flat_map(|curve| self.segments(curve));
        segments.filter(|segment| segment.len() > 1).flatten().fold(0.0_f64, |high, point| high.max(point.1))
    }

    /// Returns the legend of the outcome bars.
    pub fn fills(&self) -> Vec<Key> {
        let shown = Fill::ALL.into_iter().filter(|fill| self.curves.iter().flatten().any(|stretch| stretch.has(*fill)));
        shown.map(|fill| (Symbol::Fill(fill), fill.name().into())).collect()
    }

    /// Returns the abscissa above which no block of a curve separates. There is none if no block or the last one separates.
    pub fn limit(&self, curve: usize) -> Option<f64> {
        let curve = &self.curves[curve];
        let last = curve.iter().rposition(|stretch| stretch.has(Fill::Separated))?;
        curve.get(last + 1).map(|stretch| stretch.from)
    }

    /// Draws the curves with their outcome bars.
    pub fn chart(&self, title: String) -> Chart<'static> {
        let all = || self.curves.iter().flatten();
        let (from, to) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s.from), b.max(s.to)));
        let margin = 0.02 * (to - from);
        let curve = |i| {
            let style = LineStyle::of(i);
            (Curve::new(style, self.segments(i)), outcome_bar(&self.curves[i], style, from..to))
        };
        let (curves, bars) = (0..self.curves.len()).map(curve).unzip();
        Chart {
            title,
            x: (self.over.name(), from - margin..to + margin),
            y: ("peak |θ|/α", rotations(std::iter::once(self.highest()))),
            balance: Some(EVEN_BALANCE),
            curves,
            bars,
            ..Chart::default()
        }
    }
}

fn outcome_bar(stretches: &[Stretch], style: LineStyle, range: Range<f64>) -> OutcomeBar {
    let mut parts: Vec<(Range<f64>, Fill)> = Vec::new();
    for (i, stretch) in stretches.iter().enumerate() {
        // A stretch fills its surroundings, half way to the next one.
        let from = if i == 0 { stretch.from } else { 0.5 * (stretches[i - 1].to + stretch.from) };
        let to = stretches.get(i + 1).map_or(stretch.to, |next| 0.5 * (stretch.to + next.from));
        for fill in Fill::ALL.into_iter().filter(|fill| stretch.has(*fill)) {
            // Neighbours with the same outcome are one part: a seam between them would show.
            match parts.iter_mut().rev().find(|(_, last)| *last == fill) {
                Some((part, _)) if part.end == from && fill != Fill::Failed => part.end = to,
                _ => parts.push((from..to, fill)),
            }
        }
    }
    // Those that others may cover are drawn first.
    parts.sort_by_key(|(_, fill)| *fill as usize);
    OutcomeBar { style, range, parts }
}

/// Names a curve by its foundation and, among several, its ground motion.
fn name(spectrum: &Spectrum, curve: usize) -> String {
    let inputs = spectrum.inputs(curve as u64 * spectrum.sizes.count);
    let base = base_name(spectrum.bases[inputs.base]);
    if spectrum.motions.len() > 1 { format!("{base}; {}", spectrum.motions[inputs.motion].0) } else { base }
}

/// Names a foundation.
pub fn base_name(base: FoundationCurve) -> String {
    let epsilon = base.epsilon;
    match base.supports {
        Supports::Rigid { restitution_factor } => {
            let epsilon = if epsilon == 0.0 { String::new() } else { format!(", ε = {}", short(epsilon)) };
            let factor = match restitution_factor {
                1.0 => String::new(),
                factor => format!(", {} × Housner's e", short(factor)),
            };
            format!("rigid base{epsilon}{factor}")
        }
        Supports::Viscoelastic(ratios) => labels::supports(ratios, epsilon, short),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_with_the_same_outcome_are_one_part_of_a_lane() {
        let stretch = |x: f64, fill: Option<Fill>| {
            let mut outcomes = [false; Fill::ALL.len()];
            fill.into_iter().for_each(|fill| outcomes[fill as usize] = true);
            Stretch { from: x, to: x, outcomes, ..Stretch::default() }
        };
        let [overturned, separated] = [Some(Fill::Overturned), Some(Fill::Separated)];
        let lane = [overturned, overturned, separated, None, overturned];
        let stretches: Vec<Stretch> = (0..5).map(|i| stretch(f64::from(i), lane[i as usize])).collect();
        let bar = outcome_bar(&stretches, LineStyle::BLACK, 0.0..4.0);
        assert_eq!(
            bar.parts,
            [(1.5..2.5, Fill::Separated), (0.0..1.5, Fill::Overturned), (3.5..4.0, Fill::Overturned)]
        );
    }

    #[test]
    fn a_rigid_base_without_restitution_of_corners_has_no_epsilon() {
        let name = |epsilon, restitution_factor| base_name(FoundationCurve::rigid(epsilon, restitution_factor));
        assert_eq!([name(0.0, 1.0), name(0.0, 0.9)], ["rigid base", "rigid base, 0.9 × Housner's e"]);
        assert_eq!(name(0.2, 0.9), "rigid base, ε = 0.2, 0.9 × Housner's e");
    }
}
