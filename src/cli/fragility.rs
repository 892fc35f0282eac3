//! `rocking fragility`: the table of a sweep → fragility curves.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Parser, ValueEnum};

use crate::cli::excitation::finite;
use crate::cli::formats::PictureOptions;
use crate::cli::fragility_report::{Curves, Measure, Rows, SurfaceResult};
use crate::cli::given::Given;
use crate::cli::input;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::report::{ReportOptions, Written};
use crate::study::fragility::{Assessment, Ida, Limit, Link, Surface, Table, Uncertainty, sufficiency_beside};
use crate::study::fragility_plot;
use crate::study::picture::PictureFormat;

/// Options of `rocking fragility`.
#[derive(Parser)]
pub struct Options {
    /// Table of a sweep; `-` for standard input
    #[arg(value_name = "TABLE.csv")]
    table: PathBuf,
    /// Intensity measure, or any other column of numbers above zero, with or without its unit; several are compared
    #[arg(long, value_name = "COLUMN", required = true)]
    im: Vec<String>,
    /// What a block is not to do: overturned, or any number such as 0.5 for |theta|/alpha > 0.5. The probability of ensembles
    /// where the table has one, the outcomes of single runs otherwise
    #[arg(long, value_name = "LIMIT", default_value = "overturned")]
    limit: Limit,
    /// Rows that count: those in which a column has this value; all of several
    #[arg(long = "where", value_name = "COLUMN=VALUE")]
    conditions: Vec<String>,
    /// Distribution: the normal one for lognormal fragility, or the logistic one
    #[arg(long, value_enum, default_value_t = LinkName::Probit)]
    link: LinkName,
    /// Confidence of the intervals and of the band
    #[arg(long, value_name = "PART", default_value_t = 0.95)]
    ci: f64,
    /// Intervals from this many bootstrap samples of the records, in place of the profile likelihood, which is clustered by
    /// record where several rows share one
    #[arg(long, value_name = "SAMPLES", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    bootstrap: Option<u32>,
    /// From which the samples follow
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// A second measure: the surface of both
    #[arg(long, value_name = "COLUMN")]
    surface: Option<String>,
    /// Columns against which the sufficiency of each measure is tested
    #[arg(long, value_name = "COLUMN")]
    beside: Vec<String>,
    /// Picture of the peaks over the levels of the measure, of a sweep with levels, SVG or PNG by its ending
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    ida: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Clone, Copy, ValueEnum)]
enum LinkName {
    Probit,
    Logit,
}

impl From<LinkName> for Link {
    fn from(link: LinkName) -> Link {
        match link {
            LinkName::Probit => Link::Probit,
            LinkName::Logit => Link::Logit,
        }
    }
}

/// Does what the options say.
pub fn run(options: &Options, given: &Given) -> anyhow::Result<()> {
    let Options { im, limit, ci, bootstrap, seed, beside, ida, .. } = options;
    let plot = options.picture.plot.as_deref();
    given.only_if(plot.is_some(), &["plot-format"], "without --plot")?;
    given.only_if(bootstrap.is_some(), &["seed"], "without --bootstrap")?;
    finite("ci", *ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
    for option in ["plot", "surface", "ida"].into_iter().filter(|option| given.has(option)) {
        anyhow::ensure!(im.len() == 1, "--{option} with {} measures; expected one --im", im.len());
    }
    let format = options.picture.format()?;
    let ida_format = ida.as_deref().map(PictureFormat::of).transpose()?;
    let outputs = [("--plot", plot), ("--ida", ida.as_deref())];
    let outputs: Vec<Named> = outputs.iter().filter_map(|(option, path)| Some(Named::new(option, (*path)?))).collect();
    check_distinct(&[Named::new("the table", &options.table)], &outputs)?;
    let picture = plot.map(Pending::new).transpose()?;
    let ida_picture = ida.as_deref().map(Pending::new).transpose()?;
    let (name, text) = input::text(&options.table)?;
    let mut table = Table::read(&name, text.as_bytes())?;
    for condition in &options.conditions {
        let (column, value) = condition
            .split_once('=')
            .with_context(|| format!("--where {condition}; expected COLUMN=VALUE, as in foundation=rigid"))?;
        table.keep(column, value)?;
    }
    let found = table.cases(*limit)?;
    let column = |name: &str| -> anyhow::Result<Vec<Option<f64>>> {
        let numbers = table.numbers(name)?;
        Ok(found.cases.iter().map(|case| numbers[case.row]).collect())
    };
    let uncertainty = bootstrap.map_or(Uncertainty::Profile, |samples| Uncertainty::Bootstrap(samples, *seed));
    let link = options.link.into();
    let (mut measures, mut surface, mut svg) = (Vec::new(), None, None);
    let mut intervals = None;
    for measure in im {
        let heading = table.heading(measure)?;
        let at = || format!("{name}: {measure}");
        let values = column(measure)?;
        let assessment = Assessment::new(&found.cases, &values, link, *ci, uncertainty).with_context(at)?;
        intervals.get_or_insert_with(|| uncertainty.words(assessment.independence));
        let p_value = |other: &String| {
            let found = sufficiency_beside(&found.cases, &values, &column(other)?, link);
            Ok((other.clone(), found.with_context(|| format!("{name}: {measure} beside {other}"))?))
        };
        let sufficiency = beside.iter().map(p_value).collect::<anyhow::Result<BTreeMap<_, _>>>()?;
        if let Some(other) = &options.surface {
            let found = Surface::new(&found.cases, &values, &column(other)?, link);
            let found = found.with_context(|| format!("{name}: {measure} and {other}"))?;
            let headings = [heading, table.heading(other)?];
            if format.is_some() {
                svg = Some(fragility_plot::surface(
                    &fragility_plot::blocks(&table),
                    &found.data,
                    &found.fit,
                    headings,
                    *limit,
                )?);
            }
            surface = Some(SurfaceResult::of(headings, &found));
        } else if format.is_some() {
            svg = Some(fragility_plot::curve(&fragility_plot::blocks(&table), &assessment, heading, *limit, *ci)?);
        }
        measures.push(Measure::of(heading, &assessment, sufficiency));
    }
    let mut pictures = Vec::new();
    if let (Some(file), Some(format), Some(svg)) = (picture, format, svg) {
        pictures.push((file, format.encode(&svg)?));
    }
    if let (Some(file), Some(format)) = (ida_picture, ida_format) {
        let curves = Ida::read(&table, &im[0])?;
        pictures.push((
            file,
            format.encode(&fragility_plot::ida(&fragility_plot::blocks(&table), &curves, table.heading(&im[0])?)?)?,
        ));
    }
    Pending::write(pictures)?;
    let result = Curves {
        table: name,
        limit: limit.to_string(),
        link: link.to_string(),
        confidence: *ci,
        intervals: intervals.unwrap_or_default(),
        rows: Rows::of(&table, &found),
        measures,
        surface,
    };
    let written = Written::new([("plot", plot), ("ida", ida.as_deref())]);
    options.report.print("fragility", &written, &[], &(result.words() + &written.lines()), &result)
}
