//! The results of an assessment → a page with its pictures and tables.
//!
//! | module | in → out |
//! | --- | --- |
//! | `numbers` | numbers → text with their units |
//! | `pictures` | results → drawings |
//! | `tables` | results → CSV |
//! | `sentences` | results → plain English |
//! | `commands` | a plan → the commands that give the same numbers |
//! | `page` | all of these → HTML |
//! | `portfolio` | the order of several objects → a page, a table and lines of a terminal |

mod commands;
mod numbers;
mod page;
mod pictures;
mod portfolio;
mod sentences;
mod tables;

pub use portfolio::{PORTFOLIO_PAGE, portfolio_files, portfolio_text};
use rocking_charts::picture::{PictureError, PictureFormat};
use rocking_studies::assess::{Plan, Results};

/// Name of the page.
pub const PAGE: &str = "report.html";

/// The reason why a report fails.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The page cannot be filled.
    #[error("the page cannot be filled: {0}")]
    Page(#[from] askama::Error),
    /// A table cannot be written.
    #[error("a table cannot be written: {0}")]
    Table(#[from] std::io::Error),
    /// The curves of incremental dynamic analysis cannot be read from the runs.
    #[error(transparent)]
    Runs(#[from] rocking_studies::fragility::SweepTableError),
}

/// Returns the result in a few sentences, a line each.
pub fn text(results: &Results) -> String {
    let (report, range) = (&results.report, range(results));
    let sentences = sentences::verdict(report, range).into_iter().chain(sentences::summary(report, range));
    sentences.map(|sentence| sentence + "\n").collect()
}

/// Returns the least and greatest measure of the runs. Those of the variants count, too; they are under the same ground motions.
fn range(results: &Results) -> [f64; 2] {
    let measures = results.table.numbers(&results.report.im).unwrap_or_default();
    rocking_studies::statistics::range(measures.into_iter().flatten()).unwrap_or([f64::NAN; 2])
}

/// Makes the files of a report, with their names. The page is first, then its pictures and tables.
///
/// The bytes depend on the study alone.
///
/// # Errors
/// None in practice: all results can be drawn and written.
pub fn files(plan: &Plan, results: &Results) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let pictures = pictures::pictures(plan, results)?;
    let page = page::page(plan, results, &pictures)?;
    let mut files = vec![(PAGE.to_string(), page.into_bytes())];
    for picture in &pictures {
        files.push((format!("{}.png", picture.name), PictureFormat::Png.encode(&picture.svg)?));
    }
    files.extend(tables::tables(plan, results)?.into_iter().map(|(name, text)| (name.to_string(), text.into_bytes())));
    Ok(files)
}
