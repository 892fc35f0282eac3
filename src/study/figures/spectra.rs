//! Figures 10 to 13: peak rotations over size under pulses and records.

use crate::block::Common;
use crate::excitation::Pulse;
use crate::simulation::Settings;
use crate::study::figures::page::{page, text};
use crate::study::figures::parameters::{
    ALPHA, Detail, PULSE_BASES, PULSE_FREQUENCY, PULSE_RATIO, RECORD_BASES, RECORD_P, SPECTRUM_ALPHA,
    SPECTRUM_AMPLITUDE, pulse,
};
use crate::study::figures::sources::Source;
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::ground::Ground;
use crate::study::outcome::End;
use crate::study::picture::PictureError;
use crate::study::plot::LEFT;
use crate::study::runner::Study;
use crate::study::spectrum::{Base, Sizes, Spectrum};
use crate::study::spectrum_plot::{self, Abscissa, Curves};

/// Width and height of a panel without the lanes of its curves (pixels).
const PANEL: [u32; 2] = [1200, 700];

/// A panel of a figure.
pub struct Panel {
    /// Its name in the table.
    pub name: String,
    /// What stands over it.
    pub title: String,
    /// What it shows.
    pub spectrum: Spectrum,
}

/// The panels of Figure 10, 11, 12 or 13; of another one, none.
pub fn panels(number: u8, detail: &Detail, sources: &[Source]) -> Vec<Panel> {
    match number {
        10 | 11 => {
            let amplitude = SPECTRUM_AMPLITUDE[usize::from(number - 10)];
            let [least, greatest] = PULSE_RATIO;
            let p = [PULSE_FREQUENCY / greatest, PULSE_FREQUENCY / least];
            let panel = |&alpha: &f64| Panel {
                name: format!("alpha = {alpha}"),
                title: format!("α = {alpha} rad"),
                spectrum: spectrum(alpha, &PULSE_BASES, p, detail, Ground::default(), pulse(amplitude, alpha)),
            };
            SPECTRUM_ALPHA.iter().map(panel).collect()
        }
        12 | 13 => {
            let panel = |source: &Source| {
                let source = if number == 12 { source.horizontal_only() } else { source.clone() };
                let title = match (number, source.is_record()) {
                    (13, true) => source.with_vertical(),
                    _ => source.label,
                };
                let spectrum = spectrum(ALPHA, &RECORD_BASES, RECORD_P, detail, source.ground, source.pulse);
                Panel { name: source.name.into(), title, spectrum }
            };
            sources.iter().map(panel).collect()
        }
        _ => Vec::new(),
    }
}

fn spectrum(
    alpha: f64,
    bases: &[Base],
    [least, greatest]: [f64; 2],
    detail: &Detail,
    ground: Ground,
    pulse: Pulse,
) -> Spectrum {
    Spectrum {
        alpha,
        common: Common::default(),
        bases: bases.to_vec(),
        sizes: Sizes { least, greatest, count: detail.sizes },
        motions: vec![("".into(), ground)],
        pulse,
        settings: Settings::default(),
        duration: None,
        step: None,
    }
}

/// How many runs the figure has.
pub fn tasks(number: u8, detail: &Detail, sources: &[Source]) -> u64 {
    panels(number, detail, sources).iter().map(|panel| panel.spectrum.rows()).sum()
}

/// Makes Figure 10, 11, 12 or 13.
pub fn figure(
    number: u8,
    caption: &str,
    detail: &Detail,
    sources: &[Source],
    work: &mut Work,
) -> Result<Figure, FigureError> {
    let panels = panels(number, detail, sources);
    let over = if number < 12 { Abscissa::PulseRatio } else { Abscissa::TwoPiOverP };
    let lines: Vec<String> = panels
        .iter()
        .flat_map(|panel| {
            let title = std::iter::once(format!("panel {}: {}", panel.name, panel.title));
            title.chain(panel.spectrum.head().study.into_iter().skip(1).map(|line| format!("  {line}")))
        })
        .collect();
    // The ground motion of a panel has no other name than the panel's.
    let columns: Vec<&str> = std::iter::once("panel").chain(Spectrum::columns().skip(1)).collect();
    let mut table = Table::new(number, caption, &lines, &columns)?;
    let (mut drawn, mut failed) = (Vec::new(), 0);
    for panel in &panels {
        let spectrum = &panel.spectrum;
        spectrum.check()?;
        let mut rows = Vec::new();
        for (mut row, outcome) in work.make(spectrum.rows(), |number| spectrum.made(number)) {
            failed += u64::from(outcome.end == End::Failed);
            row.fields[0] = panel.name.clone();
            rows.push(row.fields);
        }
        let points = rows.iter().map(|row| spectrum_plot::point(over, row));
        drawn.push(Curves::gather(spectrum, points).map_err(PictureError::Drawing)?);
        rows.into_iter().try_for_each(|row| table.push(row))?;
    }
    let lanes = drawn.iter().map(Curves::lanes).max().unwrap_or(0);
    let rows = panels.len().div_ceil(2);
    let [width, height] = PANEL;
    let svg = page(number, caption, [2 * width, rows as u32 * (height + lanes)], |root, body| {
        for ((area, panel), curves) in body.split_evenly((rows, 2)).iter().zip(&panels).zip(&drawn) {
            let (head, area) = area.split_vertically(64);
            head.draw_text(&panel.title, &text(26), (LEFT as i32 + 16, 24))?;
            let (area, _) = area.split_vertically(area.dim_in_pixel().1 - 16);
            spectrum_plot::panel(&panel.spectrum, curves, over, root, &area, number < 12)?;
        }
        Ok(())
    })?;
    Ok(Figure { number, svg, table: table.finish()?, failed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::BlockError;

    /// What the panels show are blocks.
    #[test]
    fn the_panels_are_valid() {
        let sources = crate::study::figures::sources::read(None).unwrap();
        for number in 10..=13 {
            let panels = panels(number, &Detail::FULL, &sources);
            assert_eq!(panels.len(), 4);
            assert!(panels.iter().all(|panel| panel.spectrum.check().is_ok()));
        }
        let blocks: Result<Vec<_>, BlockError> =
            PULSE_BASES.iter().map(|&base| crate::study::figures::parameters::block(ALPHA, 1.0, base)).collect();
        assert_eq!(blocks.unwrap().len(), PULSE_BASES.len());
    }
}
