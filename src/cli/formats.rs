//! Names of outputs → the formats that their endings ask for.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::study::picture::PictureFormat;

/// Endings of other formats than CSV, and what to do for a table in one.
const NOT_CSV: [(&[&str], &str); 7] = [
    (&["xlsx", "xls", "xlsm", "ods", "numbers"], "write .csv and open that in the spreadsheet"),
    (
        &["parquet", "feather", "arrow", "h5", "hdf5", "mat", "npy", "npz", "pkl", "nc", "db", "sqlite"],
        "write .csv and convert it, as with pandas.read_csv(\"run.csv\", comment=\"#\").to_parquet(\"run.parquet\")",
    ),
    (&["json", "jsonl", "yaml", "toml", "xml"], "write .csv; --json prints the summary as JSON"),
    (&["tsv"], "write .csv, in which commas separate the columns"),
    (&["gz", "bz2", "xz", "zst", "zip"], "compress standard output, as with --csv - | gzip > run.csv.gz"),
    (
        &["svg", "png", "pdf", "eps", "ps", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff"],
        "write .csv; the picture is another output",
    ),
    (&["doc", "docx", "html", "htm", "md", "tex"], "write .csv and import that"),
];

/// Endings of texts in any format, which programs do not open as a table.
const TEXT: [&str; 5] = ["txt", "text", "dat", "out", "log"];

/// Refuses a name for the table of `--csv` whose ending says another format, and warns of one that says none. Any other name
/// will do.
pub fn check_table(path: &Path) -> anyhow::Result<()> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if TEXT.contains(&ending.as_str()) {
        eprintln!("rocking: warning: {}: the table is CSV all the same; a name in .csv says so", path.display());
    }
    match NOT_CSV.iter().find(|(endings, _)| endings.contains(&ending.as_str())) {
        Some((_, advice)) => anyhow::bail!("{}: a table is written as CSV, not as .{ending}; {advice}", path.display()),
        None => Ok(()),
    }
}

/// Formats of pictures.
#[derive(Clone, Copy, ValueEnum)]
pub enum Format {
    /// Pixels
    Png,
    /// Lines and text, which scale
    Svg,
}

impl From<Format> for PictureFormat {
    fn from(format: Format) -> PictureFormat {
        match format {
            Format::Png => PictureFormat::Png,
            Format::Svg => PictureFormat::Svg,
        }
    }
}

/// The picture of a command.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct PictureOptions {
    /// Picture, SVG or PNG by its ending; `-` for standard output
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Format of a picture whose name has no ending, such as `-`
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub plot_format: Option<Format>,
}

impl PictureOptions {
    /// Format of the picture, if one is asked for.
    pub fn format(&self) -> anyhow::Result<Option<PictureFormat>> {
        let Some(path) = &self.plot else { return Ok(None) };
        let chosen = self.plot_format.map(PictureFormat::from);
        match (chosen, path.extension()) {
            (Some(chosen), None) => Ok(Some(chosen)),
            (Some(chosen), Some(_)) if PictureFormat::of(path)? != chosen => {
                anyhow::bail!("--plot {} has the ending of another format than --plot-format", path.display())
            }
            (Some(_) | None, _) => Ok(Some(PictureFormat::of(path)?)),
        }
    }
}
