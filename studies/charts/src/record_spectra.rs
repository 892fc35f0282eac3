//! Spectra of several records → for each foundation the records, their mean and deviation, and the share that overturns.
//!
//! Geometric mean and standard deviation cover the records under which a block rocks and stands.

use std::ops::Range;

use crate::chart::{Chart, Curve, EVEN_BALANCE, Tile, rotations};
use crate::line_style::LineStyle;
use crate::page::{Key, Symbol, stacked};
use crate::picture::PictureError;
use crate::spectrum::{self, Abscissa, Curves};
use rocking_studies::spectrum::Spectrum;
use rocking_studies::spectrum::statistics::{EndCounts, FoundationStatistics, SizeStatistics, Statistics};

/// Heights of the peaks and of the shares of a foundation.
const HEIGHTS: [u32; 2] = [8000, 3600];
/// Maximum number of sizes of a line; more are thinned evenly.
const MAX_SIZES: usize = 1500;
/// Grey levels of the shares that overturn, separate, stay undecided and fail.
const GREYS: [u8; 4] = [25, 140, 225, 190];

/// Draws the spectra of several records as SVG, with a title for the ground motions.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn spectrum(
    spectrum: &Spectrum,
    statistics: &Statistics,
    curves: &Curves,
    title: &str,
) -> Result<String, PictureError> {
    let over = curves.over();
    let groups = &statistics.groups;
    let heading = [spectrum::heading(spectrum, title), spectrum::block_line(spectrum)];
    let of_group = |group: &FoundationStatistics| {
        let sizes = sizes(spectrum, group, over);
        let range = match (sizes.first(), sizes.last()) {
            (Some((a, _)), Some((b, _))) => a.min(*b)..a.max(*b),
            _ => 0.0..1.0,
        };
        let margin = 0.02 * (range.end - range.start);
        let range = range.start - margin..range.end + margin;
        let peaks = peaks(spectrum, group, curves, &sizes, range.clone());
        [(HEIGHTS[0], vec![], peaks), (HEIGHTS[1], vec![], shares(&sizes, range, over))]
    };
    let charts: Vec<_> = groups.iter().flat_map(of_group).collect();
    stacked(&heading, &legend(groups, charts.iter().map(|(.., chart)| chart)), &charts)
}

/// Returns the keys of the symbols that these charts have.
fn legend<'a>(groups: &[FoundationStatistics], charts: impl Iterator<Item = &'a Chart<'a>> + Clone) -> Vec<Key> {
    let any =
        |count: fn(&SizeStatistics) -> u64| groups.iter().flat_map(|group| &group.cells).any(|cell| count(cell) > 0);
    let has_band = charts.clone().any(Chart::shows_band);
    let has_line = |style| charts.clone().any(|chart| chart.shows_line(style));
    let [overturned, separated, undecided, failed] = GREYS.map(Symbol::Grey);
    let keys = [
        (true, Symbol::Curve(LineStyle::FAINT), "one record"),
        (has_line(LineStyle::BLACK), Symbol::Curve(LineStyle::BLACK), "geometric mean of all records"),
        (
            has_line(LineStyle::DASHED),
            Symbol::Curve(LineStyle::DASHED),
            "geometric mean of the records under which the block rocks and stands, if at least half",
        ),
        (has_band, Symbol::Band, "±1 standard deviation of ln(peak |θ|/α) over the same records"),
        (any(|cell| cell.ends.overturned), overturned, "share of records: overturned"),
        (any(|cell| cell.ends.separated), separated, "ended at separation"),
        (any(|cell| cell.ends.undecided), undecided, "undecided"),
        (any(|cell| cell.ends.failed), failed, "failed"),
    ];
    keys.into_iter().filter(|(is_shown, ..)| *is_shown).map(|(_, symbol, name)| (symbol, name.into())).collect()
}

/// Returns abscissa and statistics of the sizes to draw.
fn sizes<'a>(spectrum: &Spectrum, group: &'a FoundationStatistics, over: Abscissa) -> Vec<(f64, &'a SizeStatistics)> {
    let cells: Vec<(u64, &SizeStatistics)> = (0..).zip(&group.cells).collect();
    let step = cells.len().div_ceil(MAX_SIZES).max(1);
    let shown = cells.iter().step_by(step);
    shown.map(|&(number, cell)| (over.of(spectrum.sizes.p(number), &spectrum.pulse), cell)).collect()
}

/// Draws the peaks under single records, their mean and their band.
fn peaks(
    spectrum: &Spectrum,
    group: &FoundationStatistics,
    curves: &Curves,
    sizes: &[(f64, &SizeStatistics)],
    range: Range<f64>,
) -> Chart<'static> {
    let bases = spectrum.bases.len();
    let segments: Vec<_> =
        group.motions.iter().flat_map(|motion| curves.segments(motion * bases + group.base)).collect();
    let around = |cell: &SizeStatistics| {
        let cell = Some(cell).filter(|cell| counts(cell))?;
        let (mean, deviation) = (cell.geometric_mean()?, cell.deviation()?);
        let factor = libm::exp(deviation);
        Some((mean / factor, mean * factor))
    };
    let uppers = sizes.iter().filter_map(|(_, cell)| Some(around(cell)?.1));
    let highest = segments.iter().flatten().map(|point| point.1).fold(0.0, f64::max);
    let y = rotations(uppers.chain([highest]));
    let area = |run: Range<usize>| {
        let bounds = sizes[run].iter().filter_map(|(x, cell)| Some((*x, around(cell)?)));
        bounds.map(|(x, (lower, upper))| (x, lower.min(y.end), upper.min(y.end))).collect()
    };
    let areas = runs(sizes, |cell| around(cell).is_some()).into_iter().map(area).collect();
    let mean = |style: LineStyle, run: &[(f64, &SizeStatistics)]| {
        let line = run.iter().filter_map(|(x, cell)| Some((*x, cell.geometric_mean()?))).collect();
        Curve::new(style, vec![line])
    };
    let mut drawn = vec![Curve::new(LineStyle::FAINT, segments)];
    for run in runs(sizes, |cell| counts(cell) && !all_count(cell)) {
        // The line extends to the adjacent sizes with a mean of all records.
        let wider = &sizes[run.start.saturating_sub(1)..sizes.len().min(run.end + 1)];
        let wider: Vec<_> = wider.iter().copied().filter(|(_, cell)| counts(cell)).collect();
        drawn.push(mean(LineStyle::DASHED, &wider));
    }
    drawn.extend(runs(sizes, all_count).into_iter().map(|run| mean(LineStyle::BLACK, &sizes[run])));
    let both = spectrum.motions.iter().any(|(_, ground)| ground.vertical.is_some() != group.vertical);
    let direction = if both { format!("; {}", group.direction()) } else { String::new() };
    let base = spectrum::base_name(spectrum.bases[group.base]);
    let beyond = spectrum::beyond(highest).map(|beyond| format!("; {beyond}")).unwrap_or_default();
    Chart {
        title: format!("{base}{direction}; {} records{beyond}", group.motions.len()),
        x: ("", range),
        y: ("peak |θ|/α", y),
        areas,
        curves: drawn,
        balance: Some(EVEN_BALANCE),
        ..Chart::default()
    }
}

/// Returns true if a size has a mean and a band. Those of a minority of the records would mislead.
fn counts(cell: &SizeStatistics) -> bool {
    cell.rocked > 0 && 2 * cell.rocked >= cell.ends.all()
}

fn all_count(cell: &SizeStatistics) -> bool {
    cell.rocked == cell.ends.all()
}

/// Draws the shares of the records under which a block does not stand.
fn shares(sizes: &[(f64, &SizeStatistics)], range: Range<f64>, over: Abscissa) -> Chart<'static> {
    let mut tiles = Vec::new();
    for (number, (x, cell)) in sizes.iter().enumerate() {
        // A size fills its surroundings, half way to the next one.
        let half = |other: Option<&(f64, &SizeStatistics)>| other.map_or(*x, |(other, _)| 0.5 * (x + other));
        let before = number.checked_sub(1).and_then(|number| sizes.get(number));
        let ends = [half(before), half(sizes.get(number + 1))];
        let mut bottom = 0.0;
        let EndCounts { overturned, separated, undecided, failed, .. } = cell.ends;
        for (count, grey) in [overturned, separated, undecided, failed].into_iter().zip(GREYS) {
            let top = bottom + count as f64 / cell.ends.all().max(1) as f64;
            if count > 0 {
                tiles.push(Tile { x: ends[0].min(ends[1])..ends[0].max(ends[1]), y: bottom..top, grey });
            }
            bottom = top;
        }
    }
    Chart { x: (over.name(), range), y: ("share of records", 0.0..1.0), tiles, ..Chart::default() }
}

/// Returns the runs of adjacent sizes with a property.
fn runs(sizes: &[(f64, &SizeStatistics)], is: impl Fn(&SizeStatistics) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for number in (0..sizes.len()).filter(|number| is(sizes[*number].1)) {
        match found.last_mut() {
            Some(run) if run.end == number => run.end += 1,
            _ => found.push(number..number + 1),
        }
    }
    found
}
