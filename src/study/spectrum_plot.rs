//! The table of a spectrum → a drawing: peak rotations over size, and where blocks separated or fell over.

use std::f64::consts::TAU;
use std::io::Read;

use plotters::prelude::*;

use crate::excitation::Pulse;
use crate::study::look::Look;
use crate::study::outcome::End;
use crate::study::picture::{FONT_FAMILY, PictureError};
use crate::study::plot::{GRID, INK, LEFT, short};
use crate::study::runner::Study;
use crate::study::spectrum::{Base, Spectrum};

const WIDTH: u32 = 1920;
const HEAD: u32 = 116;
const CHART: u32 = 900;
/// Height of the lane of a curve: its name and a bar under it.
const LANE: u32 = 72;
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
    failed: bool,
}

impl Abscissa {
    /// Its name and unit.
    pub(super) fn name(self) -> &'static str {
        match self {
            Abscissa::TwoPiOverP => "2π / p (s)",
            Abscissa::PulseRatio => "ω_p / p",
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
        !(self.without || self.overturned || self.failed)
    }
}

/// Draws a spectrum from its table as SVG; `title` says what moved the ground.
pub fn spectrum(spectrum: &Spectrum, table: impl Read, over: Abscissa, title: &str) -> Result<String, PictureError> {
    let failed = |error: Box<dyn std::error::Error>| PictureError::Drawing(error.to_string());
    let curves = read(spectrum, table, over).map_err(failed)?;
    let mut svg = String::new();
    draw(spectrum, &curves, over, title, &mut svg).map_err(failed)?;
    Ok(svg)
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

    /// The pieces of a curve between blocks that have no peak rotation.
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

    /// Height of the lanes under a chart (pixels).
    pub(super) fn lanes(&self) -> u32 {
        LANE * self.0.len() as u32 + 72
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(
    spectrum: &Spectrum,
    curves: &Curves,
    over: Abscissa,
    title: &str,
    svg: &mut String,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (WIDTH, HEAD + CHART + curves.lanes())).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(HEAD);
    let text = |size: u32| (FONT_FAMILY, size).into_font().color(&INK);
    head.draw_text(title, &text(34), (LEFT as i32 + 16, 24))?;
    let line = format!("α = {} rad, γ = {}", short(spectrum.alpha), short(spectrum.common.gamma));
    head.draw_text(&line, &text(26), (LEFT as i32 + 16, 72))?;
    panel(spectrum, curves, over, &root, &body, false)?;
    root.present()?;
    Ok(())
}

/// Draws a chart with its lanes into an area of `root`. With `limits`, a vertical line stands where the blocks of a curve
/// cease to separate: at the greatest abscissa at which one does.
pub(super) fn panel(
    spectrum: &Spectrum,
    curves: &Curves,
    over: Abscissa,
    root: &Area,
    area: &Area,
    limits: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let (chart, lanes) = area.split_vertically(area.dim_in_pixel().1 - curves.lanes());
    let text = |size: u32| (FONT_FAMILY, size).into_font().color(&INK);
    let (all, curves) = (curves, &curves.0);
    let stretches = || curves.iter().flatten();
    let (from, to) =
        stretches().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s.from), high.max(s.to)));
    let highest = stretches().flat_map(|s| &s.points).fold(0.0_f64, |high, point| high.max(point.1));
    let margin = 0.02 * (to - from);
    let range = from - margin..to + margin;
    let mut context = ChartBuilder::on(&chart)
        .margin_right(48)
        .margin_left(16)
        .margin_top(16)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, 88)
        .build_cartesian_2d(range.clone(), 0.0..1.06 * highest.max(1e-9))?;
    context
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(2))
        .axis_style(ShapeStyle::from(INK).stroke_width(2))
        .label_style(text(26))
        .axis_desc_style(text(28))
        .y_desc("peak |θ| / α")
        .x_desc(over.name())
        .x_labels(12)
        .y_labels(8)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .draw()?;
    for (i, curve) in curves.iter().enumerate() {
        let look = Look::of(i);
        for path in all.pieces(i) {
            let at: Vec<(i32, i32)> = path.iter().map(|point| context.backend_coord(point)).collect();
            look.draw(root, &at)?;
        }
        let separated = curve.iter().filter(|stretch| stretch.separated).map(|stretch| stretch.from.max(stretch.to));
        if let Some(limit) = separated.reduce(f64::max).filter(|_| limits) {
            let ends = [highest * 1.06, 0.0].map(|y| context.backend_coord(&(limit, y)));
            look.draw(root, &ends)?;
        }
    }
    outcomes(spectrum, curves, root, &lanes, |x| context.backend_coord(&(x, 0.0)).0)
}

/// A lane for each curve with its key and its name, and where along the abscissa its blocks have no peak rotation.
fn outcomes(
    spectrum: &Spectrum,
    curves: &[Vec<Stretch>],
    root: &Area,
    area: &Area,
    pixel: impl Fn(f64) -> i32,
) -> Result<(), Box<dyn std::error::Error>> {
    let (base, top) = area.get_base_pixel();
    let text = |size: u32| (FONT_FAMILY, size).into_font().color(&INK);
    let left = base + LEFT as i32 + 16;
    let mut x = left;
    for (fill, name) in [(Fill::Grey, "complete separation"), (Fill::Black, "overturning"), (Fill::Cross, "run failed")]
    {
        if matches!(fill, Fill::Cross) && !curves.iter().flatten().any(|s| s.failed) {
            continue;
        }
        fill.draw(root, (x, top + 14), (x + 64, top + 36))?;
        root.draw_text(name, &text(24), (x + 76, top + 10))?;
        x += 320;
    }
    for (i, curve) in curves.iter().enumerate() {
        let y = top + 72 + LANE as i32 * i as i32;
        Look::of(i).draw(root, &[(base + 16, y), (base + LEFT as i32 / 2 + 8, y), (base + LEFT as i32, y)])?;
        root.draw_text(&name(spectrum, i), &text(24), (left, y - 14))?;
        let ends = [curve.first(), curve.last()].map(|end| end.map_or(left, |end| pixel(end.to)));
        root.draw(&Rectangle::new([(ends[0], y + 20), (ends[1], y + 38)], INK.mix(0.5).stroke_width(1)))?;
        let half = |a: usize, b: usize| match (curve.get(a), curve.get(b)) {
            (Some(a), Some(b)) => 0.5 * (a.to + b.from),
            (Some(end), None) => end.to,
            (None, Some(end)) => end.from,
            (None, None) => 0.0,
        };
        for (j, stretch) in curve.iter().enumerate() {
            let from = pixel(half(j.wrapping_sub(1), j));
            let to = pixel(half(j, j + 1)).max(from + 2);
            for (is, fill) in
                [(stretch.separated, Fill::Grey), (stretch.overturned, Fill::Black), (stretch.failed, Fill::Cross)]
            {
                if is {
                    fill.draw(root, (from, y + 20), (to, y + 38))?;
                }
            }
        }
    }
    Ok(())
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

#[derive(Clone, Copy)]
enum Fill {
    Grey,
    Black,
    Cross,
}

impl Fill {
    fn draw(self, area: &Area, from: (i32, i32), to: (i32, i32)) -> Result<(), Box<dyn std::error::Error>> {
        let style = match self {
            Fill::Grey => INK.mix(0.35).filled(),
            Fill::Black => INK.filled(),
            Fill::Cross => INK.stroke_width(2),
        };
        area.draw(&Rectangle::new([from, to], style))?;
        if matches!(self, Fill::Cross) {
            area.draw(&PathElement::new(vec![from, to], INK.stroke_width(2)))?;
            area.draw(&PathElement::new(vec![(from.0, to.1), (to.0, from.1)], INK.stroke_width(2)))?;
        }
        Ok(())
    }
}
