//! The table of a spectrum → a drawing: peak rotations over size, and where blocks separated or overturned.

use std::f64::consts::TAU;
use std::io::Read;
use std::ops::Range;

use crate::excitation::Pulse;
use crate::study::chart::{
    Chart, Curve, Fill, Lane, MOST_ROTATION, Sample, headed, keys, keys_height, lanes_height, rotations,
};
use crate::study::formula::formula;
use crate::study::look::Look;
use crate::study::numerals::{short, significant};
use crate::study::outcome::End;
use crate::study::picture::PictureError;
use crate::study::runner::Study;
use crate::study::spectrum::{Base, Spectrum};

/// Stretches of the abscissa in which a curve is drawn by its first, least, greatest and last value.
const STRETCHES: u64 = 1500;

/// What the sizes are drawn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Abscissa {
    /// 2π/p (s).
    TwoPiOverP,
    /// Frequency ratio ω_p/p of pulse and block (1).
    PulseRatio,
}

/// A curve where it has many points: all that a line of a picture can show of a stretch of it.
#[derive(Clone, Debug, Default)]
struct Stretch {
    from: f64,
    to: f64,
    /// First, least, greatest and last value with their abscissas, in the order of these.
    points: Vec<(f64, f64)>,
    /// Some of its blocks left the ground completely and did not overturn.
    separated: bool,
    /// Of these, some runs ended there, and have no peak rotation.
    without: bool,
    overturned: bool,
    undecided: bool,
    failed: bool,
}

impl Abscissa {
    /// Its name and unit.
    pub(super) fn name(self) -> &'static str {
        match self {
            Abscissa::TwoPiOverP => "2π/p (s)",
            Abscissa::PulseRatio => "ω_p/p",
        }
    }

    /// That of a block with this p (rad/s).
    pub(super) fn of(self, p: f64, pulse: &Pulse) -> f64 {
        match self {
            Abscissa::TwoPiOverP => TAU / p,
            Abscissa::PulseRatio => TAU / pulse.period / p,
        }
    }

    fn column(self) -> &'static str {
        match self {
            Abscissa::TwoPiOverP => "2pi/p [s]",
            Abscissa::PulseRatio => "omega_p/p [1]",
        }
    }
}

/// A block of a spectrum as its picture shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    x: f64,
    /// Peak |θ|/α (1).
    peak: f64,
    end: End,
    /// Whether it left the ground completely.
    flew: bool,
}

/// The block of a row of the table (without the row's number), from the columns that the picture shows.
pub(super) fn point<S: AsRef<str>>(over: Abscissa, row: &[S]) -> Result<Point, String> {
    let field = |name: &str| {
        let place = Spectrum::column(name).and_then(|place| row.get(place));
        place.map(AsRef::as_ref).ok_or_else(|| format!("found no column {name} in the table"))
    };
    let number = |name: &str| {
        let text = field(name)?;
        text.parse::<f64>().map_err(|_| format!("found {name} = `{text}` in the table; expected a number"))
    };
    Ok(Point {
        x: number(over.column())?,
        peak: number("peak.theta/alpha [1]")?,
        end: field("outcome")?.parse()?,
        flew: field("flights [1]")? != "0",
    })
}

impl Stretch {
    fn add(&mut self, Point { x, peak, end, flew }: Point) {
        self.to = x;
        self.separated |= flew && end != End::Overturned;
        match end {
            End::Completed => self.points.push((x, peak)),
            End::Separated => self.without = true,
            End::Overturned => self.overturned = true,
            End::Undecided => self.undecided = true,
            End::Failed => self.failed = true,
        }
        if let &[first, a, b, c, last] = self.points.as_slice() {
            let mut inner = [a, b, c];
            inner.sort_by(|a, b| a.1.total_cmp(&b.1));
            let mut kept = [inner[0], inner[2]];
            kept.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.points = vec![first, kept[0], kept[1], last];
        }
    }

    fn is_whole(&self) -> bool {
        !(self.without || self.overturned || self.undecided || self.failed)
    }
}

/// Draws a spectrum from its table as SVG; `title` says what moved the ground.
pub fn spectrum(spectrum: &Spectrum, table: impl Read, over: Abscissa, title: &str) -> Result<String, PictureError> {
    let failed = |error: Box<dyn std::error::Error>| PictureError::Drawing(error.to_string());
    let curves = read(spectrum, table, over).map_err(failed)?;
    let count = curves.0.len();
    let mut samples: Vec<_> = (0..count).map(|i| (Sample::Curve(Look::of(i)), name(spectrum, i))).collect();
    samples.extend(curves.fills());
    let chart = curves.chart(over, curves.beyond(), (0..count).map(|i| (i, Look::of(i))));
    let heading = [heading(spectrum, title), block_line(spectrum)];
    headed(&heading, keys_height(&samples) + 12_000 + lanes_height(count), |root, body| {
        let (samples_area, rest) = body.split_vertically(keys_height(&samples));
        keys(&samples_area, &samples)?;
        chart.draw(root, &rest)
    })
}

/// What moves the ground, with the formulas of a pulse marked; the name of a file is not a formula.
pub(super) fn heading(spectrum: &Spectrum, title: &str) -> String {
    let is_pulse = spectrum.motions.iter().all(|(_, ground)| ground.end().is_none());
    if is_pulse { formula(title) } else { title.into() }
}

/// The parameters that all blocks of a spectrum have, with their formulas marked.
pub(super) fn block_line(spectrum: &Spectrum) -> String {
    formula(&format!("α = {} rad, γ = {}", short(spectrum.alpha), short(spectrum.common.gamma)))
}

pub(super) fn read(
    spectrum: &Spectrum,
    table: impl Read,
    over: Abscissa,
) -> Result<Curves, Box<dyn std::error::Error>> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(table);
    Curves::gather(
        spectrum,
        reader.records().map(|record| {
            let record = record?;
            // The row's number stands first.
            let row: Vec<&str> = record.iter().skip(1).collect();
            Ok(point(over, &row)?)
        }),
    )
}

/// The curves of a spectrum, one for each ground motion and foundation.
pub(super) struct Curves(Vec<Vec<Stretch>>);

impl Curves {
    /// Takes the blocks in the order of the rows.
    pub(super) fn gather<E>(spectrum: &Spectrum, rows: impl Iterator<Item = Result<Point, E>>) -> Result<Curves, E> {
        let count = spectrum.sizes.count;
        let size = count.div_ceil(STRETCHES);
        let mut curves = vec![Vec::new(); (spectrum.rows() / count) as usize];
        for (row, values) in (0..spectrum.rows()).zip(rows) {
            let point = values?;
            let curve = &mut curves[(row / count) as usize];
            if (row % count).is_multiple_of(size) {
                curve.push(Stretch { from: point.x, to: point.x, ..Stretch::default() });
            }
            if let Some(stretch) = curve.last_mut() {
                stretch.add(point);
            }
        }
        Ok(Curves(curves))
    }

    /// The pieces of a curve between blocks that have no peak rotation. A block between two of those makes a single point,
    /// which is no line; its lane shows it.
    pub(super) fn pieces(&self, curve: usize) -> Vec<Vec<(f64, f64)>> {
        let mut pieces = vec![Vec::new()];
        for stretch in &self.0[curve] {
            if let Some(piece) = pieces.last_mut() {
                piece.extend(&stretch.points);
            }
            if !stretch.is_whole() {
                pieces.push(Vec::new());
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }

    /// Greatest peak |θ|/α of the lines.
    pub(super) fn highest(&self) -> f64 {
        let pieces = (0..self.0.len()).flat_map(|curve| self.pieces(curve));
        pieces.filter(|piece| piece.len() > 1).flatten().fold(0.0_f64, |high, point| high.max(point.1))
    }

    /// Says in words that blocks that stand rotate beyond the picture; empty if none does.
    fn beyond(&self) -> String {
        match self.highest() {
            highest if highest > MOST_ROTATION => {
                format!("peaks above {} not shown; the greatest is {}", short(MOST_ROTATION), significant(highest, 4))
            }
            _ => String::new(),
        }
    }

    /// Keys to what is in the lanes.
    pub(super) fn fills(&self) -> Vec<(Sample, String)> {
        let all = || self.0.iter().flatten();
        let there = [
            (Fill::Separated, all().any(|s| s.separated)),
            (Fill::Overturned, all().any(|s| s.overturned)),
            (Fill::Undecided, all().any(|s| s.undecided)),
            (Fill::Failed, all().any(|s| s.failed)),
        ];
        there.into_iter().filter(|(_, is)| *is).map(|(fill, _)| (Sample::Fill(fill), fill.name().into())).collect()
    }

    /// The least abscissa of a curve from which on no block separates; nothing if none does, or the last one.
    pub(super) fn limit(&self, curve: usize) -> Option<f64> {
        let curve = &self.0[curve];
        let last = curve.iter().rposition(|stretch| stretch.separated)?;
        curve.get(last + 1).map(|stretch| stretch.from)
    }

    /// A chart of some of the curves, each with a lane.
    pub(super) fn chart(
        &self,
        over: Abscissa,
        title: String,
        which: impl Iterator<Item = (usize, Look)>,
    ) -> Chart<'static> {
        let all = || self.0.iter().flatten();
        let (from, to) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s.from), b.max(s.to)));
        let margin = 0.02 * (to - from);
        let (curves, lanes) = which
            .map(|(i, look)| (Curve { look, pieces: self.pieces(i), ends: false }, lane(&self.0[i], look, from..to)))
            .unzip();
        Chart {
            title,
            x: (over.name(), from - margin..to + margin),
            y: ("peak |θ|/α", rotations(std::iter::once(self.highest()))),
            marks_alpha: true,
            curves,
            lanes,
            ..Chart::default()
        }
    }
}

fn lane(stretches: &[Stretch], look: Look, range: Range<f64>) -> Lane {
    let mut parts = Vec::new();
    for (i, stretch) in stretches.iter().enumerate() {
        // A block stands for its surroundings, half way to the next one.
        let from = if i == 0 { stretch.from } else { 0.5 * (stretches[i - 1].to + stretch.from) };
        let to = stretches.get(i + 1).map_or(stretch.to, |next| 0.5 * (stretch.to + next.from));
        let fills = [
            (stretch.separated, Fill::Separated),
            (stretch.overturned, Fill::Overturned),
            (stretch.undecided, Fill::Undecided),
            (stretch.failed, Fill::Failed),
        ];
        parts.extend(fills.into_iter().filter(|(is, _)| *is).map(|(_, fill)| (from..to, fill)));
    }
    Lane { look, range, parts }
}

/// What a curve is, in words.
fn name(spectrum: &Spectrum, curve: usize) -> String {
    let place = spectrum.place(curve as u64 * spectrum.sizes.count);
    let base = base_name(spectrum.bases[place.base]);
    if spectrum.motions.len() > 1 { format!("{base}; {}", spectrum.motions[place.motion].0) } else { base }
}

/// A foundation in words.
pub(super) fn base_name(base: Base) -> String {
    match base {
        Base::Rigid { epsilon: 0.0, restitution_factor: 1.0 } => "rigid base".into(),
        Base::Rigid { epsilon, restitution_factor: 1.0 } => format!("rigid base, ε = {}", short(epsilon)),
        Base::Rigid { epsilon, restitution_factor } => {
            format!("rigid base, ε = {}, {} × Housner's e", short(epsilon), short(restitution_factor))
        }
        Base::Viscoelastic { eta, xi_v, epsilon } => {
            format!("η = {}, ξ_v = {}, ε = {}", short(eta), short(xi_v), short(epsilon))
        }
    }
}
