//! Spectra of several records → a drawing: for each foundation the single records, and the geometric mean and the standard
//! deviation of those blocks that rock and stand; under it, how many overturn.

use std::io::Read;
use std::ops::Range;

use crate::study::chart::{self, Chart, Curve, MOST_ROTATION, Sample, headed, keys, keys_height, rotations};
use crate::study::look::Look;
use crate::study::numerals::{short, significant};
use crate::study::picture::PictureError;
use crate::study::spectrum::Spectrum;
use crate::study::spectrum_plot::{self, Abscissa, Curves};
use crate::study::spectrum_statistics::{Cell, Group, Statistics};

/// Heights of the chart of a foundation and of the strip under it.
const HEIGHTS: [u32; 2] = [8000, 3600];
/// More sizes than a line can show are passed over.
const MOST_SIZES: usize = 1500;
/// Grey levels of the parts of the records that overturn, separate, stay undecided and fail.
const GREYS: [u8; 4] = [25, 140, 225, 190];

/// Draws the spectra of several records from their table and its statistics as SVG; `title` says what moves the ground.
pub fn spectrum(
    spectrum: &Spectrum,
    statistics: &Statistics,
    table: impl Read,
    over: Abscissa,
    title: &str,
) -> Result<String, PictureError> {
    let curves =
        spectrum_plot::read(spectrum, table, over).map_err(|error| PictureError::Drawing(error.to_string()))?;
    let groups = &statistics.groups;
    let samples = samples(groups);
    let heading = [spectrum_plot::heading(spectrum, title), spectrum_plot::block_line(spectrum)];
    let panel: u32 = HEIGHTS.iter().sum();
    headed(&heading, keys_height(&samples) + panel * groups.len() as u32, |root, body| {
        let (head, mut rest) = body.split_vertically(keys_height(&samples));
        keys(&head, &samples)?;
        for group in groups {
            let (area, below) = rest.split_vertically(panel);
            let (upper, lower) = area.split_vertically(HEIGHTS[0]);
            let places = places(spectrum, group, over);
            let range = match (places.first(), places.last()) {
                (Some((a, _)), Some((b, _))) => a.min(*b)..a.max(*b),
                _ => 0.0..1.0,
            };
            let margin = 0.02 * (range.end - range.start);
            let range = range.start - margin..range.end + margin;
            peaks(spectrum, group, &curves, &places, range.clone()).draw(root, &upper)?;
            fractions(&places, range, over).draw(root, &lower)?;
            rest = below;
        }
        Ok(())
    })
}

/// The keys.
fn samples(groups: &[Group]) -> Vec<(Sample, String)> {
    let any = |count: fn(&Cell) -> u64| groups.iter().flat_map(|group| &group.cells).any(|cell| count(cell) > 0);
    let [overturned, separated, undecided, failed] = GREYS.map(Sample::Bar);
    let samples = [
        (true, Sample::Curve(Look::FAINT), "one record"),
        (true, Sample::Curve(Look::BLACK), "geometric mean of all records"),
        (true, Sample::Curve(Look::DASHED), "of those under which the block rocks and stands, if at least half"),
        (
            true,
            Sample::Band,
            "±1 standard deviation of ln(peak |θ|/α) of the same records, without those that overturn",
        ),
        (true, overturned, "share of records that overturn the block"),
        (any(|cell| cell.separated), separated, "that end the run at separation"),
        (any(|cell| cell.undecided), undecided, "that leave it undecided"),
        (any(|cell| cell.failed), failed, "whose run fails"),
    ];
    samples.into_iter().filter(|(is, ..)| *is).map(|(_, sample, name)| (sample, name.into())).collect()
}

/// Abscissas and statistics of the sizes that are drawn.
fn places<'a>(spectrum: &Spectrum, group: &'a Group, over: Abscissa) -> Vec<(f64, &'a Cell)> {
    let cells: Vec<(u64, &Cell)> = (0..).zip(&group.cells).collect();
    let step = cells.len().div_ceil(MOST_SIZES).max(1);
    let shown = cells.iter().step_by(step);
    shown.map(|&(number, cell)| (over.of(spectrum.sizes.p(number), &spectrum.pulse), cell)).collect()
}

/// The peaks under single records, their mean and their band.
fn peaks(
    spectrum: &Spectrum,
    group: &Group,
    curves: &Curves,
    places: &[(f64, &Cell)],
    range: Range<f64>,
) -> Chart<'static> {
    let bases = spectrum.bases.len();
    let pieces: Vec<_> = group.motions.iter().flat_map(|motion| curves.pieces(motion * bases + group.base)).collect();
    let around = |cell: &Cell| {
        let cell = Some(cell).filter(|cell| counts(cell))?;
        let (mean, deviation) = (cell.geometric_mean()?, cell.deviation()?);
        let factor = libm::exp(deviation);
        Some((mean / factor, mean * factor))
    };
    let uppers = places.iter().filter_map(|(_, cell)| Some(around(cell)?.1));
    let highest = pieces.iter().flatten().map(|point| point.1).fold(0.0, f64::max);
    let y = rotations(uppers.chain([highest]));
    let area = |run: Range<usize>| {
        let bounds = places[run].iter().filter_map(|(x, cell)| Some((*x, around(cell)?)));
        bounds.map(|(x, (lower, upper))| (x, lower.min(y.end), upper.min(y.end))).collect()
    };
    let areas = runs(places, |cell| around(cell).is_some()).into_iter().map(area).collect();
    let mean = |look: Look, run: &[(f64, &Cell)]| {
        let line = run.iter().filter_map(|(x, cell)| Some((*x, cell.geometric_mean()?))).collect();
        Curve { look, pieces: vec![line], ends: false }
    };
    let mut drawn = vec![Curve { look: Look::FAINT, pieces, ends: false }];
    for run in runs(places, |cell| counts(cell) && !all_count(cell)) {
        // The line goes on to the neighbours that have a mean of all.
        let wider = &places[run.start.saturating_sub(1)..places.len().min(run.end + 1)];
        let wider: Vec<_> = wider.iter().copied().filter(|(_, cell)| counts(cell)).collect();
        drawn.push(mean(Look::DASHED, &wider));
    }
    drawn.extend(runs(places, all_count).into_iter().map(|run| mean(Look::BLACK, &places[run])));
    let both = spectrum.motions.iter().any(|(_, ground)| ground.vertical.is_some() != group.vertical);
    let direction = if both { format!("; {}", group.direction()) } else { String::new() };
    let base = spectrum_plot::base_name(spectrum.bases[group.base]);
    let mut title = format!("{base}{direction}; {} records", group.motions.len());
    if highest > MOST_ROTATION {
        title += &format!("; peaks above {} not shown, to {}", short(MOST_ROTATION), significant(highest, 4));
    }
    Chart { title, x: ("", range), y: ("peak |θ|/α", y), areas, curves: drawn, marks_alpha: true, ..Chart::default() }
}

/// Whether mean and band of a size are drawn: those of a minority of the records would say more of these than of the size.
fn counts(cell: &Cell) -> bool {
    cell.rocked > 0 && 2 * cell.rocked >= cell.motions()
}

fn all_count(cell: &Cell) -> bool {
    cell.rocked == cell.motions()
}

/// The shares of the records under which a block does not stand, over the same abscissa.
fn fractions(places: &[(f64, &Cell)], range: Range<f64>, over: Abscissa) -> Chart<'static> {
    let mut cells = Vec::new();
    for (number, (x, cell)) in places.iter().enumerate() {
        // A size stands for its surroundings, half way to the next one.
        let half = |other: Option<&(f64, &Cell)>| other.map_or(*x, |(other, _)| 0.5 * (x + other));
        let before = number.checked_sub(1).and_then(|number| places.get(number));
        let ends = [half(before), half(places.get(number + 1))];
        let mut bottom = 0.0;
        for (count, grey) in [cell.overturned, cell.separated, cell.undecided, cell.failed].into_iter().zip(GREYS) {
            let top = bottom + count as f64 / cell.motions().max(1) as f64;
            if count > 0 {
                cells.push(chart::Cell { x: ends[0].min(ends[1])..ends[0].max(ends[1]), y: bottom..top, grey });
            }
            bottom = top;
        }
    }
    Chart { x: (over.name(), range), y: ("share of records", 0.0..1.0), cells, ..Chart::default() }
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
