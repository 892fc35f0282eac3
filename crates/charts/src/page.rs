//! Heading, legend and drawing functions of the charts → a page.

use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{Area, Drawn, Mark, SHADE, TEXT, WIDTH, anchored, drawing_of, fill, grey, outline, text};
use crate::chart::{Chart, Fill, SIDES};
use crate::formula::{self, formula};
use crate::line_style::LineStyle;
use crate::picture::PictureError;

/// Left edge of the heading.
pub const MARGIN: u32 = 480;
/// Height of a line of the heading.
const LINE: u32 = 500;
/// Height of a row of the legend.
const LEGEND_ROW: u32 = 600;

/// An entry of a legend: a symbol and its name.
pub type Key = (Symbol, String);

/// Symbol in a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symbol {
    /// A curve.
    Curve(LineStyle),
    /// A shaded band.
    Band,
    /// A mark at a point.
    Mark(Mark),
    /// A part of an outcome bar.
    Fill(Fill),
    /// A rectangle of this grey level.
    Grey(u8),
}

/// Draws a page: a heading, a legend and an area of this height for the charts.
///
/// The first line of the heading is larger; each is wrapped, and [`formula`] has marked its subscripts. `draw` gets the whole
/// page and the area.
pub fn page(
    heading: &[String],
    legend: &[Key],
    height: u32,
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    page_of([WIDTH, height], heading, legend, draw)
}

/// Draws a [`page`] of another width.
pub fn page_of(
    [width, height]: [u32; 2],
    heading: &[String],
    legend: &[Key],
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let sizes = std::iter::once(1.15 * TEXT).chain(std::iter::repeat(TEXT));
    let lines = heading.iter().zip(sizes).filter(|(line, _)| !line.is_empty()).flat_map(|(line, size)| {
        let wrapped = wrapped(line, size, f64::from(width - 2 * MARGIN));
        wrapped.into_iter().map(move |line| (line, size))
    });
    let lines: Vec<(String, f64)> = lines.collect();
    let head = 450 + LINE * lines.len() as u32;
    drawing_of([width, head + legend_height(legend) + height], |root| {
        let (top, rest) = root.split_vertically(head);
        for (i, (line, size)) in lines.iter().enumerate() {
            top.draw_text(&line.replace('\u{A0}', " "), &text(*size), (MARGIN as i32, 280 + (LINE * i as u32) as i32))?;
        }
        draw(root, &with_legend(&rest, legend)?)
    })
}

/// A chart of a page, with its height and its legend.
pub type StackedChart<'a> = (u32, Vec<Key>, Chart<'a>);

/// Draws a page of charts, one under the other.
pub fn stacked(heading: &[String], legend: &[Key], charts: &[StackedChart]) -> Result<String, PictureError> {
    page(heading, legend, charts.iter().map(|(height, ..)| height).sum(), |root, body| {
        let mut rest = body.clone();
        for (height, legend, chart) in charts {
            let (area, below) = rest.split_vertically(*height);
            chart.draw(root, &with_legend(&area, legend)?)?;
            rest = below;
        }
        Ok(())
    })
}

/// Breaks a text with marked subscripts into lines of limited width, never at a no-break space or beside `=`.
pub fn wrapped(text: &str, size: f64, max_width: f64) -> Vec<String> {
    let text = text.replace(" =", "\u{A0}=").replace("= ", "=\u{A0}");
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if formula::marked_width(&format!("{line} {word}"), size) <= max_width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// Returns the height of a legend.
pub fn legend_height(legend: &[Key]) -> u32 {
    LEGEND_ROW * key_positions(legend).last().map_or(0, |last| last.1 + 1)
}

/// Returns the left edge and the row of each key.
fn key_positions(legend: &[Key]) -> Vec<(i32, u32)> {
    let (mut x, mut row) = (SIDES[0] as i32, 0);
    let mut positions = Vec::new();
    for (_, name) in legend {
        let width = 2000 + formula::width(name, TEXT) as i32;
        if x + width > (WIDTH - SIDES[1]) as i32 && x > SIDES[0] as i32 {
            (x, row) = (SIDES[0] as i32, row + 1);
        }
        positions.push((x, row));
        x += width;
    }
    positions
}

/// Draws a legend at the top of an area and returns the rest of the area.
pub fn with_legend<'a>(area: &Area<'a>, legend: &[Key]) -> Result<Area<'a>, Box<dyn std::error::Error>> {
    let (area, rest) = area.split_vertically(legend_height(legend));
    for ((symbol, name), (x, row)) in legend.iter().zip(key_positions(legend)) {
        let y = (LEGEND_ROW * row + LEGEND_ROW / 2) as i32;
        let bar = [(x, y - 140), (x + 1200, y + 140)];
        match symbol {
            Symbol::Curve(style) => style.draw(&area, &[(x, y), (x + 1200, y)])?,
            Symbol::Band => fill(&area, bar, SHADE)?,
            Symbol::Mark(Mark::Tick) => {
                for tick in [x + 400, x + 520, x + 700, x + 760] {
                    Mark::Tick.draw(&area, (tick, y))?;
                }
            }
            Symbol::Mark(mark) => mark.draw(&area, (x + 600, y))?,
            Symbol::Fill(fill) => fill.draw(&area, bar)?,
            Symbol::Grey(level) => {
                fill(&area, bar, grey(*level))?;
                outline(&area, bar, 40)?;
            }
        }
        area.draw_text(&formula(name), &anchored(TEXT, HPos::Left, VPos::Center), (x + 1380, y))?;
    }
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    /// A heading with a value that does not fit goes on with its name.
    #[test]
    fn a_name_stays_with_its_value() {
        let text = "station = APEEL Array #2 - Redwood City component= 133, 0.227 g";
        for width in 4..70 {
            let lines = wrapped(text, 340.0, 200.0 * f64::from(width));
            let words = |text: &str| text.split([' ', '\u{A0}']).map(str::to_owned).collect::<Vec<_>>();
            assert_eq!(words(&lines.join(" ")), words(text));
            assert!(lines.iter().all(|line| !line.ends_with('=') && !line.starts_with('=')), "{lines:?}");
        }
    }
}
