//! `rocking cloud`: the table of a sweep → a line through rotations over a measure, and the probability of overturning.

use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;

use crate::commands::fragility::report::{summary_of_rows, with_interval};
use crate::options::fit::RowOptions;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary, aligned};
use rocking_charts::cloud::cloud;
use rocking_charts::fragility::Blocks;
use rocking_charts::numerals::significant;
use rocking_studies::fragility::{Cloud, CloudColumns, CloudRows, Limit, Share, ShareCurve, split_heading};
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::statistics::range;

/// Options of `rocking cloud`.
#[derive(Parser)]
pub struct CloudCommand {
    /// Table of a sweep, in CSV or Parquet; a folder of parts or of other such files, or a pattern of them in quotes; `-` for standard input
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Intensity measure, or any other column of positive numbers, with or without its unit; several are compared
    #[arg(long, value_name = "COLUMN", required = true)]
    im: Vec<String>,
    /// Property of the records, such as magnitude or distance, for which the residuals of each measure are tested
    #[arg(long, value_name = "COLUMN")]
    beside: Vec<String>,
    /// Limit of the curve: overturned, or a number such as 0.5 for |theta|/alpha > 0.5, in space the tilt over that of the balance
    #[arg(long, value_name = "LIMIT", default_value_t = Limit::Overturned)]
    limit: Limit,
    #[command(flatten)]
    rows: RowOptions,
    /// Table of the median and the probabilities over the measure; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Measures of a table of the curve, and of a printed one.
const POINTS: [usize; 2] = [100, 5];

/// Runs the command.
pub fn run(options: &CloudCommand) -> anyhow::Result<()> {
    let CloudCommand { table, im, beside, limit, rows: given, csv, picture, report } = options;
    given.check()?;
    let rotation = match *limit {
        Limit::Overturned => None,
        Limit::Rotation(rotation) | Limit::Tilt(rotation) => Some(rotation),
        other => anyhow::bail!("--limit {other}; expected overturned, or a rotation such as 0.5"),
    };
    csv.iter().try_for_each(|csv| check_table(csv))?;
    let format = picture.format()?;
    let outputs = [("csv", csv.as_deref()), ("plot", picture.plot.as_deref())];
    for (option, _) in outputs.iter().filter(|(_, path)| path.is_some()) {
        anyhow::ensure!(im.len() == 1, "--{option} with {} measures; expected one --im", im.len());
    }
    let mut outputs = Outputs::checked(&[NamedFile::new("the table", table)], outputs)?;
    let columns = |im: &String| CloudColumns { im: im.clone(), beside: beside.clone(), cluster: given.cluster.clone() };
    let mut rows: Vec<CloudRows> = im.iter().map(|im| CloudRows::new(columns(im))).collect();
    let (mut blocks, mut headings, mut is_in_space) = (Blocks::default(), Vec::new(), false);
    let named: Vec<&str> = im.iter().chain(beside).map(String::as_str).collect();
    let name = given.read_batches(table, &named, &mut |batch, is_part| {
        blocks.take(batch);
        is_in_space = batch.is_in_space();
        headings = im.iter().map(|name| batch.heading(name)).collect::<Result<Vec<_>, _>>()?;
        rows.iter_mut().try_for_each(|rows| Ok(rows.take(batch, is_part)?))
    })?;
    let counts = rows[0].counts;
    let found = rows.into_iter().map(|rows| rows.cloud(given.ci));
    let found = found.collect::<Result<Vec<Cloud>, _>>().with_context(|| name.clone())?;
    let limit = if is_in_space { limit.in_space() } else { *limit };
    let curve = |points: usize| Curve::new(&found[0], &headings[0], rotation, limit, points);
    outputs.fill_table("csv", || Ok(curve(POINTS[0]).table()))?;
    outputs.fill("plot", || Ok(format.encode(&cloud(&blocks.to_string(), &found[0], &headings[0])?)?))?;
    let written = outputs.write()?;
    let mut warnings: Vec<String> = found.iter().flat_map(Cloud::warnings).collect();
    warnings.dedup();
    warn(&warnings);
    let mut summary = summary_of_rows(&name, is_in_space, Limit::Overturned, &counts);
    add_clouds(&mut summary, &headings, &found);
    if found.len() == 1 {
        curve(POINTS[1]).add(&mut summary);
    }
    report.print("cloud", &written, &warnings, &(summary.text + &written.lines()), &summary.json)
}

/// Adds the lines of measures with these headings.
fn add_clouds(summary: &mut Summary, headings: &[String], found: &[Cloud]) {
    let first = &found[0];
    let [rocking, standing] = first.rocking.counts();
    let text = format!("{rocking} runs rock and stand, of {standing} that stand");
    summary.line("cloud", text);
    let text = format!("of {} %: {}", 100.0 * first.confidence, first.units());
    summary.entry("confidence", first.confidence);
    summary.item("intervals", first.units(), "intervals", text);
    let head = ["measure", "a", "b", "beta", "beta/b", "R²", "rows"].map(String::from);
    let beside = first.sufficiency.iter().map(|(name, _)| format!("p beside {name}"));
    let mut lines: Vec<Vec<String>> = vec![head.into_iter().chain(beside).collect()];
    for (heading, found) in headings.iter().zip(found) {
        let [a, b] = [0, 1].map(|i| with_interval(found.line.coefficients[i], found.intervals[i]));
        let numbers = [found.line.deviation, found.proficiency(), found.r_squared].map(|number| format!("{number:.3}"));
        let line = [heading.clone(), a, b].into_iter().chain(numbers).chain([found.points.len().to_string()]);
        lines.push(line.chain(found.sufficiency.iter().map(|(_, test)| format!("{:.2e}", test.p))).collect());
    }
    summary.text += &aligned(&lines, 0..0);
    let object = |(heading, found): (&String, &Cloud)| {
        Object::default()
            .with("im", heading)
            .with("rows", found.points.len())
            // Of ln(|θ|/α) over the natural logarithm of the measure.
            .with("coefficients", found.line.coefficients)
            .with("standard_errors", found.line.standard_errors)
            .with("intervals", found.intervals)
            .with("beta", found.line.deviation)
            .with("proficiency", found.proficiency())
            .with("r_squared", found.r_squared)
            .with("overturning", share(&found.overturning))
            .with("rocking", share(&found.rocking))
            .with("unknown", found.unknown)
            .with("sufficiency", found.sufficiency.iter().map(|(name, test)| (name, test)).collect::<Object>())
    };
    summary.entry("clouds", headings.iter().zip(found).map(object).collect::<Vec<_>>());
}

/// Returns the numbers of a share: the coefficients of its logistic curve, or the measure from which all do, which is null if none does.
fn share(share: &Share) -> Object {
    let [exceeded, rows] = share.counts();
    let of_rows = Object::default().with("exceeded", exceeded).with("rows", rows);
    match &share.curve {
        ShareCurve::Logistic(found) => of_rows.with("coefficients", found.fit.coefficients.as_slice()),
        ShareCurve::Step(threshold) => of_rows.with("threshold", threshold),
    }
}

/// The median and the probabilities at measures at even distances of their logarithms.
struct Curve<'a> {
    found: &'a Cloud,
    heading: &'a str,
    /// The limit, and its rotation if it is one.
    limit: Limit,
    rotation: Option<f64>,
    measures: Vec<f64>,
}

impl<'a> Curve<'a> {
    /// Begins with a number of points between the least and the greatest measure of the runs that rock and stand.
    fn new(found: &'a Cloud, heading: &'a str, rotation: Option<f64>, limit: Limit, points: usize) -> Curve<'a> {
        let [low, high] = range(found.points.iter().map(|[measure, _]| *measure)).unwrap_or([1.0, 1.0]);
        let at = |i: usize| match i + 1 == points {
            true => high,
            false => low * libm::exp(libm::log(high / low) * i as f64 / (points - 1) as f64),
        };
        Curve { found, heading, limit, rotation, measures: (0..points).map(at).collect() }
    }

    /// The columns of a measure.
    fn columns(&self) -> Vec<TableColumn<'_, f64>> {
        let (name, unit) = split_heading(self.heading);
        let Curve { found, rotation, .. } = self;
        let probability = |limit: Limit| format!("P({limit})");
        let mut columns = vec![
            TableColumn::real(name, "1", |measure: &f64| *measure).with_unit(unit),
            TableColumn::real("median", "1", |measure: &f64| found.median(*measure)),
            TableColumn::real("P(rocks)", "1", |measure: &f64| found.rocking.probability(*measure)),
            TableColumn::real(probability(Limit::Overturned), "1", |measure: &f64| {
                found.overturning.probability(*measure)
            }),
        ];
        if let Some(rotation) = *rotation {
            let exceedance = move |measure: &f64| found.exceedance(rotation, *measure);
            columns.push(TableColumn::real(probability(self.limit), "1", exceedance));
        }
        columns
    }

    fn table(&self) -> Table {
        Table::of(&self.columns(), &self.measures)
    }

    /// Adds the curve to a summary.
    fn add(&self, summary: &mut Summary) {
        let table = self.table();
        let name = |i: usize, heading: String| match i {
            0 => heading,
            _ => split_heading(&heading).0.to_string(),
        };
        let head = table.headings().iter().enumerate().map(|(i, heading)| name(i, heading.to_string())).collect();
        let line = |row: usize| -> Vec<String> {
            let numbers = table.columns().iter().map(|column| column.number(row).unwrap_or(f64::NAN));
            numbers
                .enumerate()
                .map(|(i, number)| if i < 2 { significant(number, 4) } else { format!("{number:.3}") })
                .collect()
        };
        let lines: Vec<Vec<String>> = std::iter::once(head).chain((0..table.rows()).map(line)).collect();
        summary.line(
            "curve",
            format!("median {} of the runs that rock and stand, and probabilities", self.found.rotation),
        );
        summary.text += &aligned(&lines, 0..lines[0].len());
    }
}
