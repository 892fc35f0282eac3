//! Makes the figures of the paper: `cargo run --release -p paper-figures -- --out FOLDER`. docs/unit/figures.md compares them with the printed ones.

use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;
use paper_figures::parameters::{Detail, NUMBERS};
use paper_figures::{FigureError, ground_motions, make};
use rocking_charts::picture::PictureFormat;
use rocking_studies::output::runner;
use rocking_studies::spec::words::Words;

/// Recomputes the figures of Palmeri and Makris (2008), as pictures with their tables.
#[derive(Parser)]
#[command(version)]
struct Options {
    /// Folder for the pictures and tables, created if missing
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Folder with the records of Table I, named as in docs/unit/figures.md; a pulse replaces each missing record
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// Numbers of the figures to compute, as in 6,9; by default all
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    only: Vec<u8>,
    /// Format of the pictures, png or svg
    #[arg(long, value_parser = format_named, default_value = PictureFormat::Png.word())]
    format: PictureFormat,
    /// Number of threads [default: those of the machine]
    #[arg(long, value_name = "COUNT")]
    threads: Option<usize>,
}

fn format_named(word: &str) -> Result<PictureFormat, String> {
    PictureFormat::named(word).ok_or_else(|| "expected png or svg".into())
}

fn main() -> anyhow::Result<()> {
    let Options { out, records, mut only, format, threads } = Options::parse();
    if only.is_empty() {
        only = NUMBERS.to_vec();
    }
    if let Some(&unknown) = only.iter().find(|number| !NUMBERS.contains(number)) {
        anyhow::bail!("--only: {}", FigureError::Number(unknown));
    }
    let sources = ground_motions::read(records.as_deref())?;
    std::fs::create_dir_all(&out).with_context(|| format!("{}: cannot be created", out.display()))?;
    for source in &sources {
        println!("{:<14}{}", source.name, source.description());
    }
    let pool = runner::pool(threads)?;
    let mut failed = 0;
    for number in only {
        let figure = pool.install(|| make(number, &Detail::FULL, &sources))?;
        failed += figure.failed;
        for (extension, bytes) in [("csv", figure.table.into_bytes()), (format.word(), format.encode(&figure.svg)?)] {
            let path = out.join(format!("figure_{number:02}.{extension}"));
            std::fs::write(&path, bytes).with_context(|| path.display().to_string())?;
            println!("{}", path.display());
        }
    }
    anyhow::ensure!(failed == 0, "{failed} runs failed; the tables mark them `failed`");
    Ok(())
}
