//! `rocking figures`: the figures of the paper → a folder of pictures and tables.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::options::choices;
use crate::options::run::ThreadOptions;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::progress::Progress;
use crate::output::report::{self, ReportOptions, WrittenFiles};
use crate::output::summary::Object;
use rocking_charts::figures::parameters::{Detail, NUMBERS};
use rocking_charts::figures::{self, FigureError, Workers, ground_motions};
use rocking_charts::picture::PictureFormat;
use rocking_studies::output::output_target::STANDARD;
use rocking_studies::spec::words::Words;

/// Options of `rocking figures`.
#[derive(Parser)]
pub struct FiguresCommand {
    /// Folder for the pictures and tables, created if missing
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Folder with the records of Table I, named as in docs/figures.md; a pulse replaces each missing record
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// Numbers of the figures to compute, as in 6,9; by default all
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    only: Vec<u8>,
    /// Format of the pictures
    #[arg(long, value_parser = choices::picture_format(), default_value = PictureFormat::Png.word())]
    format: PictureFormat,
    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &FiguresCommand) -> anyhow::Result<()> {
    let mut numbers: Vec<u8> = if options.only.is_empty() { NUMBERS.to_vec() } else { options.only.clone() };
    numbers.sort_unstable();
    numbers.dedup();
    if let Some(&unknown) = numbers.iter().find(|number| !NUMBERS.contains(number)) {
        anyhow::bail!("--only: {}", FigureError::Number(unknown));
    }
    let (out, records) = (&options.out, options.records.as_deref());
    anyhow::ensure!(out != Path::new(STANDARD), "--out -: standard output takes one file; expected a folder");
    let sources = ground_motions::read(records)?;
    std::fs::create_dir_all(out).with_context(|| format!("{}: cannot be created", out.display()))?;
    let format = options.format;
    let files = |number: u8| ["csv", format.word()].map(|name| out.join(format!("figure_{number:02}.{name}")));
    let written: Vec<PathBuf> = numbers.iter().flat_map(|&number| files(number)).collect();
    let named =
        |option: &str, paths: &[PathBuf]| paths.iter().map(|path| NamedFile::new(option, path)).collect::<Vec<_>>();
    check_distinct(&named("--records", &ground_motions::files(records)), &named("--out", &written))?;
    let of_sources: Vec<String> =
        sources.iter().map(|source| format!("{:<14}{}\n", source.name, source.description())).collect();
    if !options.report.json {
        report::print(&of_sources.concat(), false)?;
    }
    let pool = options.threads.pool()?;
    let detail = Detail::FULL;
    let bar = Progress::new(numbers.iter().map(|&number| figures::tasks(number, &detail, &sources)).sum(), 0);
    let (mut done, mut failed) = (0, 0);
    for &number in &numbers {
        let [table, picture] = files(number);
        let (table, picture) = (Pending::new(&table)?, Pending::new(&picture)?);
        let mut advance = || {
            done += 1;
            bar.show(done);
        };
        let figure = figures::make(number, &detail, &sources, &mut Workers { pool: &pool, after_each: &mut advance })?;
        Pending::write(vec![(table, figure.table.into_bytes()), (picture, format.encode(&figure.svg)?)])?;
        failed += figure.failed;
    }
    bar.clear();
    let written = WrittenFiles::new([("out", Some(out.as_path()))]);
    let failures = (failed > 0).then(|| format!("{failed} runs failed; the tables mark them `failed`"));
    let pulses = sources.iter().filter(|source| !source.is_record()).map(|source| source.label.clone());
    let warnings: Vec<String> = pulses.chain(failures.clone()).collect();
    let files = numbers.iter().flat_map(|&number| files(number)).map(|path| path.display().to_string());
    let of_sources: BTreeMap<_, _> = sources.iter().map(|source| (source.name, source.description())).collect();
    let json = Object::default()
        .with("figures", &numbers)
        .with("files", files.collect::<Vec<_>>())
        .with("sources", of_sources)
        .with("failed", failed);
    options.report.print("figures", &written, &warnings, &written.lines(), &json)?;
    failures.map_or(Ok(()), |failures| anyhow::bail!(failures))
}
