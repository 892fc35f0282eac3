//! Heading, legend and drawing functions of the charts → a page.

use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{Area, Drawn, Mark, PIXEL, SHADE, TEXT, WIDTH, anchored, drawing_of, fill, grey, outline, text};
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
/// The first line of the heading is larger; each is wrapped, and [`formula`](fn@formula) has marked its subscripts. `draw` gets the whole
/// page and the area.
///
/// # Errors
/// The drawing fails.
pub fn page(
    heading: &[String],
    legend: &[Key],
    height: u32,
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    page_of([WIDTH, height], heading, legend, draw)
}

/// Draws a [`page`] of another width.
///
/// # Errors
/// The drawing fails.
pub fn page_of(
    [width, height]: [u32; 2],
    heading: &[String],
    legend: &[Key],
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, PictureError> {
    let lines = heading_lines(heading, width);
    let head = head_height(lines.len());
    let svg = drawing_of([width, head + legend_height(legend) + height], |root| {
        let (top, rest) = root.split_vertically(head);
        draw_heading(&top, &lines)?;
        draw(root, &with_legend(&rest, legend)?)
    })?;
    Ok(svg.replacen("<svg ", &format!("<svg {HEADING}{}\" ", lines.len()), 1))
}

/// Attribute of a drawing with the number of lines of its heading, which are its first texts.
const HEADING: &str = "data-heading=\"";

/// A line of a heading, and its font size.
type HeadingLine = (String, f64);

/// Wraps the lines of a heading. The first one is larger.
fn heading_lines(heading: &[String], width: u32) -> Vec<HeadingLine> {
    let sizes = std::iter::once(1.15 * TEXT).chain(std::iter::repeat(TEXT));
    let lines = heading.iter().zip(sizes).filter(|(line, _)| !line.is_empty());
    let wrap = |(line, size): (&String, f64)| {
        wrapped(line, size, f64::from(width - 2 * MARGIN)).into_iter().map(move |line| (line, size))
    };
    lines.flat_map(wrap).collect()
}

/// Returns the height of a heading with this number of lines.
const fn head_height(lines: usize) -> u32 {
    450 + LINE * lines as u32
}

fn draw_heading(area: &Area, lines: &[HeadingLine]) -> Drawn {
    for (i, (line, size)) in (0..).zip(lines) {
        area.draw_text(&line.replace('\u{A0}', " "), &text(*size), (MARGIN as i32, 280 + LINE as i32 * i))?;
    }
    Ok(())
}

/// Replaces the heading of a page by a title. An empty title leaves no heading, as journals want it.
///
/// # Errors
/// [`PictureError::Drawing`].
pub fn titled(svg: &str, title: &str) -> Result<String, PictureError> {
    let no_page = || PictureError::Drawing("found no heading; expected a page".into());
    let (before, marked) = svg.split_once(HEADING).ok_or_else(no_page)?;
    let (count, rest) = marked.split_once("\" ").ok_or_else(no_page)?;
    let count: usize = count.parse().map_err(|_| no_page())?;
    let (open, mut body) = rest.split_once('>').ok_or_else(no_page)?;
    let sizes = open.split_once("viewBox=\"0 0 ").and_then(|(_, sizes)| sizes.split_once('"')).ok_or_else(no_page)?;
    let sizes: Vec<u32> = sizes.0.split(' ').filter_map(|size| size.parse().ok()).collect();
    let &[width, height] = sizes.as_slice() else { return Err(no_page()) };

    let background;
    (background, body) = body.split_at(body.find("/>").map_or(0, |at| at + 2));
    for _ in 0..count {
        (_, body) = body.split_once("</text>").ok_or_else(no_page)?;
    }
    let lines = heading_lines(&[title.into()], width);
    let shift = i64::from(head_height(count)) - i64::from(head_height(lines.len()));
    let [old_height, height] = [i64::from(height), i64::from(height) - shift];
    let background = background.replacen("y=\"0\"", &format!("y=\"{shift}\""), 1);
    let background = background.replacen(&format!("height=\"{old_height}\""), &format!("height=\"{height}\""), 1);
    let heading = drawing_of([width, head_height(lines.len())], |root| draw_heading(root, &lines))?;
    let heading = heading.find("<text").map_or("", |at| heading[at..].trim_end().trim_end_matches("</svg>"));
    let pixel = i64::from(PIXEL);
    Ok(format!(
        "{before}{HEADING}{}\" width=\"{}\" height=\"{}\" viewBox=\"0 {shift} {width} {height}\" \
         xmlns=\"http://www.w3.org/2000/svg\">{background}<g transform=\"translate(0 {shift})\">{heading}</g>{body}",
        lines.len(),
        i64::from(width) / pixel,
        height / pixel
    ))
}

/// A chart of a page, with its height and its legend.
pub type StackedChart<'a> = (u32, Vec<Key>, Chart<'a>);

/// Draws a page of charts, one under the other.
///
/// # Errors
/// The drawing fails.
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
///
/// # Errors
/// The drawing fails.
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
    use super::{page, titled, wrapped};
    use crate::picture::PictureFormat;

    /// A title takes the place of both lines of a heading, and the picture is as much lower.
    #[test]
    fn a_title_replaces_the_heading() {
        let heading = ["a name".to_string(), "its values".into()];
        let svg = page(&heading, &[], 5000, |_, body| {
            Ok(body.draw_text("a curve", &crate::canvas::text(340.0), (500, 500))?)
        })
        .unwrap();
        let long = "word ".repeat(60);
        for (title, lines) in [("", 0), ("Figure 3", 1), (long.as_str(), 3)] {
            let titled = titled(&svg, title).unwrap();
            let document = roxmltree::Document::parse(&titled).unwrap();
            let attribute = |name| document.root_element().attribute(name).unwrap();
            assert_eq!(attribute("height").parse(), Ok((450 + 500 * lines + 5000) / 10), "{title}");
            assert!(!titled.contains("a name") && !titled.contains("its values") && titled.contains("a curve"));
            let texts = document.descendants().filter(|node| node.has_tag_name("text")).count();
            assert_eq!((texts, attribute("data-heading").parse()), (lines + 1, Ok(lines)), "{titled}");
            assert!(PictureFormat::Png.encode(&titled).is_ok());
        }
    }

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
