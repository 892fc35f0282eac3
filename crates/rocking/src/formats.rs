//! Name of an output → its format.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::choices;
use rocking_charts::picture::PictureFormat;

/// Extensions of other formats than CSV, with advice for a table in one.
const NOT_CSV: [(&[&str], &str); 7] = [
    (&["xlsx", "xls", "xlsm", "ods", "numbers"], "write .csv and open that in the spreadsheet"),
    (
        &["parquet", "feather", "arrow", "h5", "hdf5", "mat", "npy", "npz", "pkl", "nc", "db", "sqlite"],
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

/// Refuses a table whose extension names another format, and warns of one that names none. Other extensions are accepted.
pub fn check_table(path: &Path) -> anyhow::Result<()> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    if TEXT.contains(&extension.as_str()) {
        eprintln!("rocking: warning: {}: the table is written as CSV; expected a name in .csv", path.display());
    }
    match NOT_CSV.iter().find(|(extensions, _)| extensions.contains(&extension.as_str())) {
        Some((_, advice)) => {
            anyhow::bail!("{}: a table is written as CSV, not as .{extension}; {advice}", path.display())
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
}

impl PictureOptions {
    /// Returns the format of the picture, if there is one.
    pub fn format(&self) -> anyhow::Result<Option<PictureFormat>> {
        let Some(path) = &self.plot else { return Ok(None) };
        match (self.plot_format, path.extension()) {
            (Some(chosen), None) => Ok(Some(chosen)),
            (Some(chosen), Some(_)) if PictureFormat::of(path)? != chosen => {
                anyhow::bail!("--plot {} has the extension of another format than --plot-format", path.display())
            }
            (Some(_) | None, _) => Ok(Some(PictureFormat::of(path)?)),
        }
    }
}
