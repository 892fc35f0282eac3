//! `rocking stripes`: the table of a sweep over levels, or counts at levels → a fragility curve and the fractions at the levels.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;

use crate::commands::fragility::report::{
    MeasureReport, add_curves, add_without_curve, summary_of_rows, warning_of_left_out,
};
use crate::options::explicit::ExplicitOptions;
use crate::options::fit::FitOptions;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary, aligned};
use rocking_charts::fragility::Blocks;
use rocking_charts::numerals::significant;
use rocking_charts::stripes::stripes;
use rocking_studies::fragility::{Assessment, Collected, Limit, Stripe, SweepTable, split_heading};
use rocking_studies::output::table::{Table, TableColumn};

/// Options of `rocking stripes`.
#[derive(Parser)]
pub struct StripesCommand {
    /// Table of a sweep with levels, or of counts: a row for each level with the number of its `runs` and of those `exceeded`; CSV, Parquet, a
    /// folder or a pattern of such files, or `-` for standard input
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Intensity measure of the levels, with or without its unit
    #[arg(long, value_name = "COLUMN")]
    im: String,
    #[command(flatten)]
    fit: FitOptions,
    /// Table of the levels with their runs, fractions and the curve; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &StripesCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let StripesCommand { table, im, fit, csv, picture, report } = options;
    fit.check(explicit)?;
    csv.iter().try_for_each(|csv| check_table(csv))?;
    let format = picture.format()?;
    let outputs = [("csv", csv.as_deref()), ("plot", picture.plot.as_deref())];
    let mut outputs = Outputs::checked(&[NamedFile::new("the table", table)], outputs)?;
    let columns = vec![(im.clone(), None), (im.clone(), None)];
    let mut rows = Collected::new(fit.limit, fit.rows.cluster.clone(), columns);
    let (mut blocks, mut heading, mut is_in_space) = (Blocks::default(), String::new(), false);
    let mut take = |batch: &SweepTable, is_part: bool| -> anyhow::Result<()> {
        blocks.take(batch);
        is_in_space = batch.is_in_space();
        heading = batch.heading(im)?;
        match batch.unrolled(im)? {
            Some(runs) => Ok(rows.take(&runs, false).map(drop)?),
            None => Ok(rows.take(batch, is_part).map(drop)?),
        }
    };
    let name = fit.rows.read_batches(table, &[im, "runs", "exceeded"], &mut take)?;
    let Collected { limit, stores, motions, counts, .. } = rows;
    let limit = limit.unwrap_or(Limit::Overturned);
    let at = || format!("{name}: {im}");
    let [store, of_levels]: [_; 2] = stores.try_into().unwrap_or_else(|_| unreachable!("two lists of columns"));
    let levels = Stripe::all(&of_levels.levels(&motions).with_context(at)?, im).with_context(|| name.clone())?;
    let found = Assessment::of(store, &motions, fit.link, fit.rows.ci, fit.uncertainty()).with_context(at)?;
    let mut warnings = Vec::from_iter(warning_of_left_out(&counts));
    warnings.extend(found.warnings(&heading));
    let ci = fit.rows.ci;
    outputs.fill_table("csv", || Ok(table_of(&levels, &found, &heading)))?;
    outputs
        .fill("plot", || Ok(format.encode(&stripes(&blocks.to_string(), &levels, &found, &heading, limit, ci)?)?))?;
    let written = outputs.write()?;
    warn(&warnings);
    let mut summary = summary_of_rows(&name, is_in_space, limit, &counts);
    let curve = MeasureReport::of(&heading, &found, &BTreeMap::new());
    add_curves(&mut summary, fit, &found.intervals(), &[&curve]);
    add_without_curve(&mut summary, &[&curve]);
    add_levels(&mut summary, &levels, &found, &heading);
    report.print("stripes", &written, &warnings, &(summary.text + &written.lines()), &summary.json)
}

/// A level with the probability of the curve and its interval.
type Level<'a> = (&'a Stripe, f64, [f64; 2]);

/// Returns the levels with the curve.
fn with_curve<'a>(levels: &'a [Stripe], found: &Assessment) -> Vec<Level<'a>> {
    let measures: Vec<f64> = levels.iter().map(|stripe| stripe.level).collect();
    let band = found.band(&measures).into_iter().map(|[low, high]| [low.unwrap_or(0.0), high.unwrap_or(1.0)]);
    let curve = levels.iter().zip(band).map(|(stripe, band)| (stripe, found.fit.probability(&[stripe.level]), band));
    curve.collect()
}

/// Returns the table of the levels of the measure with this heading.
fn table_of(levels: &[Stripe], found: &Assessment, heading: &str) -> Table {
    let (name, unit) = split_heading(heading);
    let columns: [TableColumn<Level>; 7] = [
        TableColumn::real(name, "1", |(stripe, ..): &Level| stripe.level).with_unit(unit),
        TableColumn::count("runs", |(stripe, ..): &Level| stripe.runs),
        TableColumn::real("exceeded", "1", |(stripe, ..): &Level| stripe.exceeded),
        TableColumn::real("fraction", "1", |(stripe, ..): &Level| stripe.fraction()),
        TableColumn::real("probability", "1", |(_, probability, _): &Level| *probability),
        TableColumn::real("probability.low", "1", |(.., [low, _]): &Level| *low),
        TableColumn::real("probability.high", "1", |(.., [_, high]): &Level| *high),
    ];
    Table::of(&columns, &with_curve(levels, found))
}

/// Adds the levels of the measure with this heading.
fn add_levels(summary: &mut Summary, levels: &[Stripe], found: &Assessment, heading: &str) {
    let head = [heading, "runs", "exceeded", "fraction", "curve"].map(String::from).to_vec();
    let levels = with_curve(levels, found);
    let line = |(stripe, probability, [low, high]): &Level| {
        vec![
            significant(stripe.level, 4),
            stripe.runs.to_string(),
            significant(stripe.exceeded, 4),
            format!("{:.3}", stripe.fraction()),
            format!("{probability:.3} ({low:.3} to {high:.3})"),
        ]
    };
    let lines: Vec<Vec<String>> = std::iter::once(head).chain(levels.iter().map(line)).collect();
    summary.line("levels", levels.len());
    summary.text += &aligned(&lines, 0..4);
    let object = |(stripe, probability, band): &Level| {
        let counts = Object::default().with("level", stripe.level).with("runs", stripe.runs);
        let of_rows = counts.with("exceeded", stripe.exceeded).with("fraction", stripe.fraction());
        of_rows.with("probability", probability).with("probability_interval", band)
    };
    summary.entry("levels", levels.iter().map(object).collect::<Vec<_>>());
}
