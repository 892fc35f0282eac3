//! Figures 10 to 13: peak rotations over size under pulses and records.

use crate::figure::{self, Figure, FigureError, page};
use crate::ground_motions::GroundMotion;
use crate::parameters::{
    ALPHA, Detail, PULSE_BASES, PULSE_RATIO, RECORD_ETA, RECORD_P, RECORD_SUPPORTS, SPECTRUM_ALPHA, SPECTRUM_AMPLITUDE,
    SPECTRUM_FREQUENCY, spectrum_pulse,
};
use rocking_block::block::{BlockError, Common, Ratios, Supports};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::Settings;
use rocking_charts::canvas::{TEXT, text};
use rocking_charts::chart::{bars_height, rotations};
use rocking_charts::formula::formula;
use rocking_charts::line_style::LineStyle;
use rocking_charts::numerals::short;
use rocking_charts::page::{MARGIN, Symbol};
use rocking_charts::picture::PictureError;
use rocking_charts::spectrum::{Abscissa, Curves, base_name};
use rocking_studies::output::runner::Study;
use rocking_studies::output::runner::in_parallel;
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::run::outcome::End;
use rocking_studies::spectrum::statistics::BlockOutcome;
use rocking_studies::spectrum::{CheckedSpectrum, FoundationCurve, ScaledFeatures, Sizes, Spectrum};

/// Height of a panel without its outcome bars: under pulses and under records.
const HEIGHT: [u32; 2] = [6600, 5600];

/// A panel of a figure. Two of them, left and right, make a row.
pub struct Panel {
    /// Name in the table.
    pub name: String,
    /// Title.
    pub title: String,
    /// Spectrum, or `None` if the vertical record of the right column is missing.
    pub spectrum: Option<CheckedSpectrum>,
}

/// Returns the abscissa of a figure.
pub fn abscissa(number: u8) -> Abscissa {
    if number < 12 { Abscissa::PulseRatio } else { Abscissa::TwoPiOverP }
}

/// Returns the ground motions of Figure 12 or 13. Those of 12 are the first two of Table I.
pub fn record_sources(number: u8, sources: &[GroundMotion]) -> &[GroundMotion] {
    let (first, others) = sources.split_at(2.min(sources.len()));
    if number == 12 { first } else { others }
}

/// Returns the panels of Figure 10, 11, 12 or 13, row by row. For other figures there are none.
///
/// # Errors
/// An invalid block.
pub fn panels(number: u8, detail: &Detail, sources: &[GroundMotion]) -> Result<Vec<Panel>, BlockError> {
    match number {
        10 | 11 => SPECTRUM_ALPHA
            .iter()
            .flat_map(|&alpha| SPECTRUM_AMPLITUDE.map(|amplitude| pulse_panel(number, alpha, amplitude, detail)))
            .collect(),
        12 | 13 => record_sources(number, sources)
            .iter()
            .flat_map(|source| RECORD_SUPPORTS.map(|support| record_panels(source, support, detail)))
            .flatten()
            .collect(),
        _ => Ok(Vec::new()),
    }
}

fn pulse_panel(number: u8, alpha: f64, amplitude: f64, detail: &Detail) -> Result<Panel, BlockError> {
    let p = PULSE_RATIO.map(|ratio| SPECTRUM_FREQUENCY / ratio);
    let pulse = spectrum_pulse(number, amplitude, alpha);
    Ok(Panel {
        name: format!("alpha = {alpha}, a_p = {amplitude} g tan alpha"),
        title: format!("α = {} rad, a_p = {} g tan α", short(alpha), short(amplitude)),
        spectrum: Some(spectrum(alpha, &PULSE_BASES, [p[1], p[0]], detail, Ground::default(), pulse)?),
    })
}

/// Returns the panels of a row: the horizontal motion alone, and both components.
fn record_panels(source: &GroundMotion, [xi_v, epsilon]: [f64; 2], detail: &Detail) -> [Result<Panel, BlockError>; 2] {
    let supports = RECORD_ETA.map(|eta| FoundationCurve::viscoelastic(eta, xi_v, epsilon));
    let bases: Vec<FoundationCurve> = std::iter::once(FoundationCurve::HOUSNER).chain(supports).collect();
    let panel = |motion: &str, ground: Option<Ground>| {
        let spectrum = ground.map(|ground| spectrum(ALPHA, &bases, RECORD_P, detail, ground, source.pulse));
        Ok(Panel {
            name: format!("{}, {motion}, xi_v = {xi_v}, epsilon = {epsilon}", source.name),
            title: format!("ξ_v = {}, ε = {}, {motion}", short(xi_v), short(epsilon)),
            spectrum: spectrum.transpose()?,
        })
    };
    let with_vertical = source.ground.vertical.is_some().then(|| source.ground.clone());
    [panel("a_gx alone", Some(source.horizontal_only().ground)), panel("a_gx and a_gz", with_vertical)]
}

fn spectrum(
    alpha: f64,
    bases: &[FoundationCurve],
    [least, greatest]: [f64; 2],
    detail: &Detail,
    ground: Ground,
    pulse: Pulse,
) -> Result<CheckedSpectrum, BlockError> {
    let spectrum = Spectrum {
        alpha,
        common: Common::default(),
        in_proportion: ScaledFeatures::default(),
        bases: bases.to_vec(),
        sizes: Sizes { least, greatest, count: detail.sizes },
        motions: vec![("".into(), ground)],
        pulse,
        // The analysis ends at complete separation.
        settings: Settings::default(),
        duration: None,
        friction_demand: None,
        step: None,
    };
    spectrum.checked()
}

/// The name of a panel, its table, and the number of a row of it.
type PanelRow<'a> = (&'a str, &'a Table, usize);

/// Makes Figure 10, 11, 12 or 13.
pub fn figure(number: u8, detail: &Detail, sources: &[GroundMotion]) -> Result<Figure, FigureError> {
    let panels = panels(number, detail, sources)?;
    let over = abscissa(number);
    let mut lines: Vec<String> = match number {
        12 | 13 => record_sources(number, sources)
            .iter()
            .map(|source| format!("motion {}: {}", source.name, source.description()))
            .collect(),
        _ => Vec::new(),
    };
    for panel in &panels {
        lines.push(format!("panel {}", panel.name));
        match &panel.spectrum {
            Some(spectrum) => lines.extend(spectrum.header().study.into_iter().skip(1).map(|line| format!("  {line}"))),
            None => lines.push("  no vertical record at hand".into()),
        }
    }
    let (mut drawn, mut tables, mut failed) = (Vec::new(), Vec::new(), 0);
    for panel in &panels {
        let Some(spectrum) = &panel.spectrum else {
            drawn.push(None);
            continue;
        };
        let mut rows = Table::default();
        let made = in_parallel(spectrum.rows() as usize, |number| spectrum.make(&[number as u64], None));
        made.into_iter().for_each(|row| rows.append(row.table));
        let outcomes = BlockOutcome::all(&rows).map_err(PictureError::Drawing)?;
        failed += outcomes.iter().filter(|outcome| outcome.end == End::Failed).count() as u64;
        let mut curves = Curves::new(spectrum, over);
        curves.add(spectrum, &outcomes);
        drawn.push(Some(curves));
        tables.push((panel.name.as_str(), rows));
    }
    // The name of the panel replaces the number of the row and the name of the ground motion.
    let panel = TableColumn::text("panel", |(name, ..): &PanelRow| name.to_string());
    let headings = tables.first().map_or(&[][..], |(_, table)| table.columns()).iter().map(|column| &column.heading);
    let others = headings.enumerate().skip(2).map(|(number, heading)| {
        TableColumn::text(heading.to_string(), move |(_, table, row): &PanelRow| table.columns()[number].text(*row))
    });
    let columns: Vec<_> = std::iter::once(panel).chain(others).collect();
    let rows = tables.iter().flat_map(|(name, table)| (0..table.rows()).map(move |row| (*name, table, row)));
    let svg = draw(number, sources, &panels, &drawn)?;
    Ok(Figure { failed, ..figure::figure(number, &lines, &columns, &rows.collect::<Vec<_>>(), svg)? })
}

/// Draws the panels in two columns, under a line for each record.
fn draw(
    number: u8,
    sources: &[GroundMotion],
    panels: &[Panel],
    drawn: &[Option<Curves>],
) -> Result<String, FigureError> {
    const HEAD: u32 = 800;
    let bases = panels.iter().find_map(|panel| panel.spectrum.as_ref()).map(|spectrum| spectrum.bases.as_slice());
    let bases = bases.unwrap_or_default();
    let names = bases.iter().map(|&base| match (number, base.supports) {
        (12 | 13, Supports::Viscoelastic(Ratios { eta, .. })) => format!("η = {}", short(eta)),
        _ => base_name(base),
    });
    let mut legend: Vec<_> = names.enumerate().map(|(i, name)| (Symbol::Curve(LineStyle::of(i)), name)).collect();
    for fill in drawn.iter().flatten().flat_map(Curves::fills) {
        if !legend.contains(&fill) {
            legend.push(fill);
        }
    }
    let (records, rows_each) = match number {
        12 | 13 => (record_sources(number, sources), RECORD_SUPPORTS.len()),
        _ => (&sources[..0], SPECTRUM_ALPHA.len()),
    };
    let rows = panels.len() / 2;
    let row_height = HEIGHT[usize::from(number >= 12)] + bars_height(bases.len());
    let page_height = rows as u32 * row_height + records.len() as u32 * HEAD;
    page(number, &legend, page_height, |root, body| {
        let mut rest = body.clone();
        for (row, (panels, drawn)) in panels.chunks(2).zip(drawn.chunks(2)).enumerate() {
            if let Some(source) = records.get(row / rows_each).filter(|_| row % rows_each == 0) {
                let (head, under) = rest.split_vertically(HEAD);
                rest = under;
                let letter = (b'a' + (row / rows_each) as u8) as char;
                let line = format!("({letter}) {}", source.description());
                head.draw_text(&formula(&line), &text(1.1 * TEXT), (MARGIN as i32, 280))?;
            }
            let (line, under) = rest.split_vertically(row_height);
            rest = under;
            let (left, right) = line.split_horizontally(line.dim_in_pixel().0 / 2);
            let highest = drawn.iter().flatten().map(Curves::highest).fold(1e-9, f64::max);
            for ((panel, curves), area) in panels.iter().zip(drawn).zip([left, right]) {
                let Some(shown) = curves.as_ref().or(drawn[0].as_ref()) else { continue };
                let mut chart = shown.chart(panel.title.clone());
                chart.y.1 = rotations(std::iter::once(highest));
                if curves.is_none() {
                    // The axes of the panel at the left, without curves.
                    chart.message = "no vertical record at hand".into();
                    (chart.curves, chart.bars) = (Vec::new(), Vec::new());
                    let height = area.dim_in_pixel().1 - bars_height(bases.len());
                    chart.draw(root, &area.split_vertically(height).0)?;
                    continue;
                }
                if number < 12 {
                    let limits = (0..bases.len()).filter_map(|i| Some((LineStyle::of(i), shown.limit(i)?)));
                    chart.verticals = limits.collect();
                }
                chart.draw(root, &area)?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blocks_of_all_panels_are_valid() {
        let sources = crate::ground_motions::read(None).unwrap();
        for number in 10..=13 {
            let panels = panels(number, &Detail::FULL, &sources).unwrap();
            assert_eq!(panels.len(), if number < 12 { 8 } else { 16 });
        }
    }
}
