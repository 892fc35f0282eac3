//! Caption, picture and table of a figure.

use crate::parameters::caption;
use rocking_block::block::BlockError;
use rocking_block::simulation::SimulationError;
use rocking_charts::canvas::{Area, Drawn};
use rocking_charts::formula::formula;
use rocking_charts::page::{self, Key};
use rocking_charts::picture::PictureError;
use rocking_studies::output::csv::with_headings;
use rocking_studies::output::table::{Table, TableColumn};

/// Error of a figure.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The paper has no such figure with results.
    #[error("found figure {0}; expected 3, 6, 7, 8, 9, 10, 11, 12, 13 or 14")]
    Number(u8),
    /// A parameter is invalid.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// A run failed.
    #[error(transparent)]
    Run(#[from] SimulationError),
    /// The drawing failed.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The table failed.
    #[error("the table cannot be written: {0}")]
    Table(#[from] std::io::Error),
}

/// A figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Number in the paper.
    pub number: u8,
    /// Drawing, as SVG.
    pub svg: String,
    /// Data as CSV: comments that begin with `# `, column names, rows.
    pub table: String,
    /// Number of failed runs, which have the word `failed` in the table.
    pub failed: u64,
}

/// Draws the page of a figure: number, caption, legend and an area of this height.
///
/// `draw` gets the whole page and the area.
pub(crate) fn page(
    number: u8,
    legend: &[Key],
    height: u32,
    draw: impl FnOnce(&Area, &Area) -> Drawn,
) -> Result<String, FigureError> {
    let caption = caption(number).ok_or(FigureError::Number(number))?;
    // The empty first line keeps the caption at normal size.
    let heading = [String::new(), formula(&format!("Figure\u{A0}{number}. {caption}"))];
    Ok(page::page(&heading, legend, height, draw)?)
}

/// Combines the rows of a figure with its drawing. Comments above the rows have the caption and further lines.
pub(crate) fn figure<R>(
    number: u8,
    lines: &[String],
    columns: &[TableColumn<R>],
    rows: &[R],
    svg: String,
) -> Result<Figure, FigureError> {
    let mut table = format!(concat!("# rocking-block ", env!("CARGO_PKG_VERSION"), " figure {}\n"), number);
    let caption = caption(number).ok_or(FigureError::Number(number))?;
    for line in std::iter::once(&caption).chain(lines) {
        table.push_str(&format!("# {}\n", line.replace(['\n', '\r', '\u{A0}'], " ")));
    }
    table.push_str(&with_headings(&Table::of(columns, rows))?);
    Ok(Figure { number, svg, table, failed: 0 })
}
