//! `rocking figures`: the figures of the paper → a folder of pictures and tables.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Parser, ValueEnum};

use crate::cli::output::Pending;
use crate::cli::progress::Progress;
use crate::study::figures::parameters::{Detail, NUMBERS};
use crate::study::figures::{self, FigureError, Work, sources};
use crate::study::picture::PictureFormat;
use crate::study::runner;

/// Options of `rocking figures`.
#[derive(Parser)]
pub struct Options {
    /// Folder for the pictures and the tables; it is made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Folder with the records of Table I (docs/figures.md has their names); a missing one is replaced by its pulse
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// Some of the figures only, as in 6,9
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    only: Vec<u8>,
    /// Format of the pictures
    #[arg(long, value_enum, default_value_t = Format::Png)]
    format: Format,
    /// Threads; without it one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Png,
    Svg,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let numbers: Vec<u8> = if options.only.is_empty() { NUMBERS.to_vec() } else { options.only.clone() };
    if let Some(&unknown) = numbers.iter().find(|number| !NUMBERS.contains(number)) {
        anyhow::bail!("--only: {}", FigureError::Number(unknown));
    }
    let sources = sources::read(options.records.as_deref())?;
    let out = &options.out;
    std::fs::create_dir_all(out).with_context(|| format!("{}: cannot be made", out.display()))?;
    let (format, ending) = match options.format {
        Format::Png => (PictureFormat::Png, "png"),
        Format::Svg => (PictureFormat::Svg, "svg"),
    };
    for source in &sources {
        println!("{:<14}{}", source.name, source.with_vertical());
    }
    let pool = runner::pool(options.threads.map(usize::from))?;
    let detail = Detail::FULL;
    let mut bar = Progress::new(numbers.iter().map(|&number| figures::tasks(number, &detail, &sources)).sum(), 0);
    let (mut done, mut failed) = (0, 0);
    for number in numbers {
        let name = format!("figure_{number:02}");
        let mut files = ["csv", ending]
            .into_iter()
            .map(|ending| Pending::new(&out.join(&name).with_extension(ending)))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let mut told = || {
            done += 1;
            bar.show(done);
        };
        let figure = figures::make(number, &detail, &sources, &mut Work { pool: &pool, done: &mut told })?;
        files[0].write(figure.table.as_bytes())?;
        files[1].write(&format.encode(&figure.svg)?)?;
        Pending::place(files)?;
        failed += figure.failed;
    }
    bar.clear();
    println!("written       {}", out.display());
    anyhow::ensure!(failed == 0, "{failed} runs failed; they have the word `failed` in the tables");
    Ok(())
}
