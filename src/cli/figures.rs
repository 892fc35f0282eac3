//! `rocking figures`: the figures of the paper → a folder of pictures and tables.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use serde::Serialize;

use crate::cli::formats::Format;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::progress::Progress;
use crate::cli::report::{self, ReportOptions, Written};
use crate::study::figures::parameters::{Detail, NUMBERS};
use crate::study::figures::{self, FigureError, Work, sources};
use crate::study::picture::PictureFormat;
use crate::study::place::STANDARD;
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
    #[command(flatten)]
    report: ReportOptions,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let mut numbers: Vec<u8> = if options.only.is_empty() { NUMBERS.to_vec() } else { options.only.clone() };
    numbers.sort_unstable();
    numbers.dedup();
    if let Some(&unknown) = numbers.iter().find(|number| !NUMBERS.contains(number)) {
        anyhow::bail!("--only: {}", FigureError::Number(unknown));
    }
    let (out, records) = (&options.out, options.records.as_deref());
    anyhow::ensure!(out != Path::new(STANDARD), "--out -: standard output takes one file; expected a folder");
    let sources = sources::read(records)?;
    std::fs::create_dir_all(out).with_context(|| format!("{}: cannot be made", out.display()))?;
    let (format, ending) = match options.format {
        Format::Png => (PictureFormat::Png, "png"),
        Format::Svg => (PictureFormat::Svg, "svg"),
    };
    let files = |number: u8| ["csv", ending].map(|ending| out.join(format!("figure_{number:02}.{ending}")));
    let written: Vec<PathBuf> = numbers.iter().flat_map(|&number| files(number)).collect();
    let named = |option: &str, paths: &[PathBuf]| paths.iter().map(|path| Named::new(option, path)).collect::<Vec<_>>();
    check_distinct(&named("--records", &sources::files(records)), &named("--out", &written))?;
    let of_sources: Vec<String> =
        sources.iter().map(|source| format!("{:<14}{}\n", source.name, source.with_vertical())).collect();
    if !options.report.json {
        report::print(&of_sources.concat(), false)?;
    }
    let pool = runner::pool(options.threads.map(usize::from))?;
    let detail = Detail::FULL;
    let mut bar = Progress::new(numbers.iter().map(|&number| figures::tasks(number, &detail, &sources)).sum(), 0);
    let (mut done, mut failed) = (0, 0);
    for &number in &numbers {
        let [table, picture] = files(number);
        let (table, picture) = (Pending::new(&table)?, Pending::new(&picture)?);
        let mut told = || {
            done += 1;
            bar.show(done);
        };
        let figure = figures::make(number, &detail, &sources, &mut Work { pool: &pool, done: &mut told })?;
        Pending::write(vec![(table, figure.table.into_bytes()), (picture, format.encode(&figure.svg)?)])?;
        failed += figure.failed;
    }
    bar.clear();
    let written = Written::new([("out", Some(out.as_path()))]);
    let failures = (failed > 0).then(|| format!("{failed} runs failed; they have the word `failed` in the tables"));
    let pulses = sources.iter().filter(|source| !source.is_record()).map(|source| source.label.clone());
    let warnings: Vec<String> = pulses.chain(failures.clone()).collect();
    let files = numbers.iter().flat_map(|&number| files(number)).map(|path| path.display().to_string()).collect();
    let result = FiguresResult {
        figures: numbers,
        files,
        sources: sources.iter().map(|source| (source.name, source.with_vertical())).collect(),
        failed,
    };
    options.report.print("figures", &written, &warnings, &written.lines(), &result)?;
    failures.map_or(Ok(()), |failures| anyhow::bail!(failures))
}

#[derive(Serialize)]
struct FiguresResult {
    figures: Vec<u8>,
    files: Vec<String>,
    /// The ground motions of Table I.
    sources: BTreeMap<&'static str, String>,
    failed: u64,
}
