//! Name of an output → its format.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use crate::options::choices;
use rocking_charts::picture::{PictureError, PictureFormat};
use rocking_charts::titled;
use rocking_studies::output::format::TableFormat;
use rocking_studies::spec::words::Words;

/// Extensions of other formats than CSV, with advice for a table in one.
const NOT_CSV: [(&[&str], &str); 7] = [
    (&["xlsx", "xls", "xlsm", "ods", "numbers"], "write .csv and open that in the spreadsheet"),
    (
        &["feather", "arrow", "h5", "hdf5", "mat", "npy", "npz", "pkl", "nc", "db", "sqlite"],
        "write .csv and convert it, as with pandas.read_csv(\"run.csv\", comment=\"#\").to_parquet(\"run.parquet\")",
    ),
    (&["json", "jsonl", "yaml", "toml", "xml"], "write .csv; --json prints the summary as JSON"),
    (&["tsv"], "write .csv, with commas between the columns"),
    (&["gz", "bz2", "xz", "zst", "zip"], "compress standard output, as with --csv - | gzip > run.csv.gz"),
    (
        &["svg", "png", "pdf", "eps", "ps", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff"],
        "write .csv; the picture is another output",
    ),
    (&["doc", "docx", "html", "htm", "md", "tex"], "write .csv and import that"),
];

/// Extensions of text files that programs do not open as a table.
const TEXT: [&str; 5] = ["txt", "text", "dat", "out", "log"];

/// Returns the format of a table by its name. Refuses one that this program is built without.
pub fn table_format(path: &Path) -> anyhow::Result<TableFormat> {
    let format = TableFormat::of(path);
    format.check().with_context(|| path.display().to_string())?;
    Ok(format)
}

/// Refuses a table whose extension names another format, and warns of one that names none. Other extensions are accepted.
pub fn check_table(path: &Path) -> anyhow::Result<()> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    if TEXT.contains(&extension.as_str()) {
        eprintln!("rocking: warning: {}: the table is written as CSV; expected a name in .csv", path.display());
    }
    if table_format(path)? != TableFormat::Csv {
        return Ok(());
    }
    match NOT_CSV.iter().find(|(extensions, _)| extensions.contains(&extension.as_str())) {
        Some((_, advice)) => {
            anyhow::bail!("{}: found .{extension}; expected a table as .csv or .parquet; {advice}", path.display())
        }
        None => Ok(()),
    }
}

/// The picture of a command.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct PictureOptions {
    /// Picture, SVG or PNG by its extension; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Format of a picture without an extension, such as `-`
    #[arg(long, value_parser = choices::picture_format(), value_name = "FORMAT")]
    pub plot_format: Option<PictureFormat>,
    /// Heading of the picture instead of its own; `--title ""` for none
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
}

/// The format of a picture, and its title instead of its own heading.
#[derive(Clone, Copy)]
pub struct PictureEncoding<'a> {
    format: PictureFormat,
    title: Option<&'a str>,
}

impl PictureEncoding<'_> {
    /// Encodes a drawing.
    ///
    /// # Errors
    /// [`PictureError::Drawing`].
    pub fn encode(self, svg: &str) -> Result<Vec<u8>, PictureError> {
        match self.title {
            None => self.format.encode(svg),
            Some(title) => self.format.encode(&titled(svg, title)?),
        }
    }
}

impl PictureOptions {
    /// Returns the encoding of the picture, PNG if there is none.
    pub fn format(&self) -> anyhow::Result<PictureEncoding<'_>> {
        Ok(PictureEncoding { format: self.checked_format()?, title: self.title.as_deref() })
    }

    fn checked_format(&self) -> anyhow::Result<PictureFormat> {
        let Some(path) = &self.plot else {
            anyhow::ensure!(self.plot_format.is_none(), "--plot-format has no effect without --plot");
            anyhow::ensure!(self.title.is_none(), "--title has no effect without --plot");
            return Ok(PictureFormat::Png);
        };
        match (self.plot_format, path.extension()) {
            (Some(chosen), None) => Ok(chosen),
            (Some(chosen), Some(_)) if PictureFormat::of(path)? != chosen => {
                anyhow::bail!(
                    "found --plot {} and --plot-format {}; expected one format",
                    path.display(),
                    chosen.word()
                )
            }
            (Some(_) | None, _) => Ok(PictureFormat::of(path)?),
        }
    }
}
