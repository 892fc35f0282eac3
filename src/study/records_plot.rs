//! Spectra of several records → a drawing: for each foundation the single records, and the geometric mean and the standard
//! deviation of those blocks that rock and stand; under it, how many overturn.

use std::error::Error;
use std::io::Read;
use std::ops::Range;

use plotters::prelude::*;

use crate::study::formula::{formula, typeset};
use crate::study::letters::FONT_FAMILY;
use crate::study::picture::PictureError;
use crate::study::plot::{GRID, INK, LEFT, short};
use crate::study::spectrum::Spectrum;
use crate::study::spectrum_plot::{self, Abscissa, Curves};
use crate::study::spectrum_statistics::{Cell, Group, Statistics};

const WIDTH: u32 = 1920;
/// Title, block and keys.
const HEAD: u32 = 240;
/// Name, chart and strip of one foundation.
const PANEL: u32 = 930;
const NAME: u32 = 56;
const CHART: u32 = 590;
/// More sizes than a line can show are passed over.
const MOST_SIZES: usize = 1500;

const RECORD: RGBColor = RGBColor(125, 125, 125);
const BAND: RGBColor = RGBColor(220, 220, 220);
const SEPARATED: RGBColor = RGBColor(165, 165, 165);
const FAILED: RGBColor = RGBColor(215, 215, 215);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), Box<dyn Error>>;

/// Draws the spectra of several records from their table and its statistics as SVG; `title` says what moves the ground.
pub fn spectrum(
    spectrum: &Spectrum,
    statistics: &Statistics,
    table: impl Read,
    over: Abscissa,
    title: &str,
) -> Result<String, PictureError> {
    let mut svg = String::new();
    let drawn = (|| -> Drawn {
        let curves = spectrum_plot::read(spectrum, table, over)?;
        let groups = &statistics.groups;
        let size = (WIDTH, HEAD + PANEL * groups.len() as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, mut rest) = root.split_vertically(HEAD);
        head_of(spectrum, groups, title, &head)?;
        for group in groups {
            let (panel, below) = rest.split_vertically(PANEL);
            self::panel(spectrum, group, &curves, over, &panel)?;
            rest = below;
        }
        root.present()?;
        Ok(())
    })();
    drawn.map_err(|error| PictureError::Drawing(error.to_string()))?;
    Ok(typeset(&svg))
}

fn text(size: u32) -> TextStyle<'static> {
    (FONT_FAMILY, size).into_font().color(&INK)
}

fn head_of(spectrum: &Spectrum, groups: &[Group], title: &str, area: &Area) -> Drawn {
    let left = LEFT as i32 + 16;
    area.draw_text(title, &text(34), (left, 24))?;
    let line = format!("α = {} rad, γ = {}", short(spectrum.alpha), short(spectrum.common.gamma));
    area.draw_text(&line, &text(26), (left, 72))?;
    let sample = |x: i32, y: i32, style: ShapeStyle| PathElement::new(vec![(x, y), (x + 70, y)], style);
    let bar = |x: i32, y: i32, style: ShapeStyle| Rectangle::new([(x, y - 11), (x + 70, y + 11)], style);
    let [upper, lower, lowest] = [132, 170, 208];
    area.draw(&sample(left, upper, RECORD.stroke_width(2)))?;
    area.draw_text("one record", &text(24), (left + 84, upper - 14))?;
    area.draw(&sample(left + 330, upper, INK.stroke_width(6)))?;
    area.draw_text("geometric mean of all records", &text(24), (left + 414, upper - 14))?;
    for x in [0, 38] {
        let dash = vec![(left + 860 + x, upper), (left + 860 + x + 26, upper)];
        area.draw(&PathElement::new(dash, INK.stroke_width(6)))?;
    }
    let dashed = "of those under which the block rocks and stands, if at least half";
    area.draw_text(dashed, &text(24), (left + 944, upper - 14))?;
    area.draw(&bar(left, lower, BAND.filled()))?;
    let band =
        "± 1 standard deviation of ln(peak |θ| / α) of the same records: what overturns is neither in mean nor in band";
    area.draw_text(band, &text(24), (left + 84, lower - 14))?;
    let any = |count: fn(&Cell) -> u64| groups.iter().flat_map(|group| &group.cells).any(|cell| count(cell) > 0);
    let fills = [
        (true, INK, "part of the records that overturn the block"),
        (any(|cell| cell.separated), SEPARATED, "that end the run at separation"),
        (any(|cell| cell.failed), FAILED, "whose run fails"),
    ];
    let mut x = left;
    for (_, colour, name) in fills.into_iter().filter(|(is, ..)| *is) {
        area.draw(&bar(x, lowest, colour.filled()))?;
        area.draw_text(name, &text(24), (x + 84, lowest - 14))?;
        x += 660;
    }
    Ok(())
}

fn panel(spectrum: &Spectrum, group: &Group, curves: &Curves, over: Abscissa, area: &Area) -> Drawn {
    let (name, rest) = area.split_vertically(NAME);
    let both = spectrum.motions.iter().any(|(_, ground)| ground.vertical.is_some() != group.vertical);
    let direction = if both { format!("; {}", group.direction()) } else { String::new() };
    let base = spectrum_plot::base_name(spectrum.bases[group.base]);
    let records = group.motions.len();
    name.draw_text(&formula(&format!("{base}{direction}; {records} records")), &text(28), (LEFT as i32 + 16, 20))?;
    let (chart, strip) = rest.split_vertically(CHART);
    let places = places(spectrum, group, over);
    let range = match (places.first(), places.last()) {
        (Some((a, _)), Some((b, _))) => a.min(*b)..a.max(*b),
        _ => 0.0..1.0,
    };
    let margin = 0.02 * (range.end - range.start);
    let range = range.start - margin..range.end + margin;
    charted(spectrum, group, curves, &places, range.clone(), &chart)?;
    fractions(&places, range, over, &strip)
}

/// Abscissas and statistics of the sizes that are drawn.
fn places<'a>(spectrum: &Spectrum, group: &'a Group, over: Abscissa) -> Vec<(f64, &'a Cell)> {
    let cells: Vec<(u64, &Cell)> = (0..).zip(&group.cells).collect();
    let step = cells.len().div_ceil(MOST_SIZES).max(1);
    let shown = cells.iter().step_by(step);
    shown.map(|&(number, cell)| (over.of(spectrum.sizes.p(number), &spectrum.pulse), cell)).collect()
}

fn charted(
    spectrum: &Spectrum,
    group: &Group,
    curves: &Curves,
    places: &[(f64, &Cell)],
    range: Range<f64>,
    area: &Area,
) -> Drawn {
    let bases = spectrum.bases.len();
    let pieces: Vec<_> = group.motions.iter().flat_map(|motion| curves.pieces(motion * bases + group.base)).collect();
    let around = |cell: &Cell| {
        let cell = Some(cell).filter(|cell| counts(cell))?;
        let (mean, deviation) = (cell.geometric_mean()?, cell.deviation()?);
        let factor = libm::exp(deviation);
        Some((mean / factor, mean * factor))
    };
    let peaks = pieces.iter().flatten().map(|point| point.1);
    let uppers = places.iter().filter_map(|(_, cell)| Some(around(cell)?.1));
    let highest = peaks.chain(uppers).fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .margin_right(48)
        .margin_left(16)
        .margin_top(8)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, 16)
        .build_cartesian_2d(range, 0.0..1.06 * highest.max(1e-9))?;
    mesh(&mut chart, "peak |θ| / α", None, 8)?;
    for run in runs(places, |cell| around(cell).is_some()) {
        let bounds = || places[run.clone()].iter().filter_map(|(x, cell)| Some((*x, around(cell)?)));
        let upper = bounds().map(|(x, (_, upper))| (x, upper));
        let outline: Vec<(f64, f64)> = bounds().map(|(x, (lower, _))| (x, lower)).chain(upper.rev()).collect();
        chart.draw_series(std::iter::once(Polygon::new(outline, BAND.filled())))?;
    }
    for piece in pieces {
        chart.draw_series(std::iter::once(PathElement::new(piece, RECORD.stroke_width(2))))?;
    }
    let mean = |run: &[(f64, &Cell)]| -> Vec<(f64, f64)> {
        run.iter().filter_map(|(x, cell)| Some((*x, cell.geometric_mean()?))).collect()
    };
    let heavy = INK.stroke_width(6);
    for run in runs(places, |cell| counts(cell) && !all_count(cell)) {
        // The line goes on to the neighbours that have a mean of all.
        let wider = &places[run.start.saturating_sub(1)..places.len().min(run.end + 1)];
        let wider: Vec<_> = wider.iter().copied().filter(|(_, cell)| counts(cell)).collect();
        chart.draw_series(DashedLineSeries::new(mean(&wider), 18, 12, heavy))?;
    }
    for run in runs(places, all_count) {
        chart.draw_series(std::iter::once(PathElement::new(mean(&places[run]), heavy)))?;
    }
    Ok(())
}

/// Whether mean and band of a size are drawn: those of a minority of the records would say more of these than of the size.
fn counts(cell: &Cell) -> bool {
    cell.rocked > 0 && 2 * cell.rocked >= cell.motions()
}

fn all_count(cell: &Cell) -> bool {
    cell.rocked == cell.motions()
}

/// The parts of the records under which a block does not stand, over the same abscissa.
fn fractions(places: &[(f64, &Cell)], range: Range<f64>, over: Abscissa, area: &Area) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin_right(48)
        .margin_left(16)
        .margin_top(12)
        .set_label_area_size(LabelAreaPosition::Left, LEFT)
        .set_label_area_size(LabelAreaPosition::Bottom, 88)
        .build_cartesian_2d(range, 0.0..1.0)?;
    mesh(&mut chart, "part of records", Some(over.name()), 3)?;
    for (number, (x, cell)) in places.iter().enumerate() {
        // A size stands for its surroundings, half way to the next one.
        let half = |other: Option<&(f64, &Cell)>| other.map_or(*x, |(other, _)| 0.5 * (x + other));
        let before = number.checked_sub(1).and_then(|number| places.get(number));
        let ends = [half(before), half(places.get(number + 1))];
        let mut bottom = 0.0;
        for (count, colour) in [(cell.overturned, INK), (cell.separated, SEPARATED), (cell.failed, FAILED)] {
            let top = bottom + count as f64 / cell.motions().max(1) as f64;
            if count > 0 {
                let corners = [(ends[0], bottom), (ends[1], top)];
                chart.draw_series(std::iter::once(Rectangle::new(corners, colour.filled())))?;
            }
            bottom = top;
        }
    }
    Ok(())
}

fn mesh<'a>(
    chart: &mut ChartContext<
        'a,
        SVGBackend<'a>,
        Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
    >,
    ordinate: &str,
    abscissa: Option<&str>,
    labels: usize,
) -> Drawn {
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(2))
        .axis_style(ShapeStyle::from(INK).stroke_width(2))
        .label_style(text(26))
        .axis_desc_style(text(28))
        .y_desc(ordinate)
        .x_labels(12)
        .y_labels(labels)
        .y_label_formatter(&|y| short(*y));
    match abscissa {
        Some(name) => mesh.x_desc(formula(name)).x_label_formatter(&|x| short(*x)).draw()?,
        None => mesh.x_label_formatter(&|_| String::new()).draw()?,
    }
    Ok(())
}

/// The runs of neighbouring sizes of which this is so.
fn runs(places: &[(f64, &Cell)], is: impl Fn(&Cell) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for number in (0..places.len()).filter(|number| is(places[*number].1)) {
        match found.last_mut() {
            Some(run) if run.end == number => run.end += 1,
            _ => found.push(number..number + 1),
        }
    }
    found
}
