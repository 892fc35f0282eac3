//! `rocking fragility`: the table of a sweep → fragility curves.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Parser, ValueEnum};
use serde::Serialize;

use crate::cli::excitation::finite;
use crate::cli::formats::PictureOptions;
use crate::cli::given::Given;
use crate::cli::input;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::report::{ReportOptions, Written};
use crate::study::fragility::{Assessment, Cases, Interval, Limit, Link, Table, Uncertainty, sufficiency_beside};
use crate::study::fragility_plot;

/// Options of `rocking fragility`.
#[derive(Parser)]
pub struct Options {
    /// Table of a sweep; `-` for standard input
    #[arg(value_name = "TABLE.csv")]
    table: PathBuf,
    /// Intensity measure, or any other column of numbers above zero, with or without its unit; several are compared
    #[arg(long, value_name = "COLUMN", required = true)]
    im: Vec<String>,
    /// What a block is not to do: overturned, or theta/alpha>0.5 with any number. The probability of ensembles where the
    /// table has one, the outcomes of single runs otherwise
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
    /// Intervals from so many samples of whole records, in place of the likelihood that takes each row on its own
    #[arg(long, value_name = "SAMPLES", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    bootstrap: Option<u32>,
    /// From which the samples follow
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Columns beside which it is told whether each measure is sufficient
    #[arg(long, value_name = "COLUMN")]
    beside: Vec<String>,
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
    let Options { im, limit, ci, bootstrap, seed, beside, .. } = options;
    let plot = options.picture.plot.as_deref();
    given.only_if(plot.is_some(), &["plot-format"], "without --plot")?;
    given.only_if(bootstrap.is_some(), &["seed"], "without --bootstrap")?;
    finite("ci", *ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
    anyhow::ensure!(plot.is_none() || im.len() == 1, "--plot with {} measures; expected one --im", im.len());
    let format = options.picture.format()?;
    let outputs: Vec<Named> = plot.iter().map(|path| Named::new("--plot", path)).collect();
    check_distinct(&[Named::new("the table", &options.table)], &outputs)?;
    let picture = plot.map(Pending::new).transpose()?;
    let (name, text) = input::text(&options.table)?;
    let mut table = Table::read(&name, text.as_bytes())?;
    for condition in &options.conditions {
        let (column, value) = condition
            .split_once('=')
            .with_context(|| format!("--where {condition}; expected COLUMN=VALUE, as in foundation=Rigid"))?;
        table.keep(column, value)?;
    }
    let found = table.cases(*limit)?;
    let column = |name: &str| -> anyhow::Result<Vec<Option<f64>>> {
        let numbers = table.numbers(name)?;
        Ok(found.cases.iter().map(|case| numbers[case.row]).collect())
    };
    let uncertainty = bootstrap.map_or(Uncertainty::Profile, |samples| Uncertainty::Bootstrap(samples, *seed));
    let link = options.link.into();
    let mut measures = Vec::new();
    let mut written = Vec::new();
    for measure in im {
        let heading = table.heading(measure)?;
        let at = || format!("{name}: {measure}");
        let values = column(measure)?;
        let assessment = Assessment::new(&found.cases, &values, link, *ci, uncertainty).with_context(at)?;
        let p_value = |other: &String| {
            let found = sufficiency_beside(&found.cases, &values, &column(other)?, link);
            Ok((other.clone(), found.with_context(|| format!("{name}: {measure} beside {other}"))?))
        };
        let sufficiency = beside.iter().map(p_value).collect::<anyhow::Result<BTreeMap<_, _>>>()?;
        if let Some(format) = format {
            written.push(format.encode(&fragility_plot::curve(&assessment, heading, *limit, *ci)?)?);
        }
        measures.push(Measure::of(heading, &assessment, sufficiency));
    }
    Pending::write(picture.into_iter().zip(written).collect())?;
    let result = Curves {
        table: name,
        limit: limit.to_string(),
        link: link.to_string(),
        confidence: *ci,
        rows: Rows::of(&table, &found),
        measures,
    };
    let written = Written::new([("plot", plot)]);
    options.report.print("fragility", &written, &[], &(result.words() + &written.lines()), &result)
}

/// What was found; SI units.
#[derive(Serialize)]
struct Curves {
    table: String,
    limit: String,
    link: String,
    confidence: f64,
    rows: Rows,
    measures: Vec<Measure>,
}

/// Rows of the table that count.
#[derive(Serialize)]
struct Rows {
    all: usize,
    /// Those that tell whether the limit is exceeded.
    told: usize,
    /// In how many of these it is: for ensembles, the sum of their probabilities.
    exceeded: f64,
    /// Those whose runs failed.
    failed: usize,
    /// Those whose runs ended at complete separation before the limit was exceeded.
    separated: usize,
}

impl Rows {
    fn of(table: &Table, Cases { cases, failed, separated }: &Cases) -> Rows {
        let exceeded = cases.iter().map(|case| case.fraction).sum();
        Rows { all: table.rows(), told: cases.len(), exceeded, failed: *failed, separated: *separated }
    }
}

/// The curve of a measure.
#[derive(Serialize)]
struct Measure {
    im: String,
    rows: usize,
    median: f64,
    median_interval: [Option<f64>; 2],
    beta: f64,
    beta_interval: [Option<f64>; 2],
    /// Of the natural logarithm of the measure.
    intercept: f64,
    slope: f64,
    standard_errors: Vec<f64>,
    log_likelihood: f64,
    null_log_likelihood: f64,
    #[serde(rename = "AUC")]
    auc: f64,
    #[serde(rename = "Brier")]
    brier: f64,
    efficiency: Option<f64>,
    /// Probability of the data, or of stranger ones, if the measure is sufficient beside each of these.
    sufficiency: BTreeMap<String, f64>,
    /// Samples of the bootstrap without a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    without_curve: Option<usize>,
}

impl Measure {
    fn of(heading: &str, found: &Assessment, sufficiency: BTreeMap<String, f64>) -> Measure {
        let Assessment { data, fit, median, dispersion, auc, brier, efficiency, .. } = found;
        let ends = |Interval { low, high }: &Interval| [*low, *high];
        Measure {
            im: heading.into(),
            rows: data.observations().len(),
            median: fit.median(),
            median_interval: ends(median),
            beta: fit.dispersion(),
            beta_interval: ends(dispersion),
            intercept: fit.coefficients[0],
            slope: fit.coefficients[1],
            standard_errors: fit.standard_errors(),
            log_likelihood: fit.log_likelihood,
            null_log_likelihood: fit.null_log_likelihood,
            auc: *auc,
            brier: *brier,
            efficiency: *efficiency,
            sufficiency,
            without_curve: found.without_curve(),
        }
    }

    /// What stands in the table for a person.
    fn fields(&self) -> Vec<String> {
        let end = |end: Option<f64>| end.map_or("?".into(), |end| format!("{end:.4}"));
        let with = |value: f64, [low, high]: [Option<f64>; 2]| format!("{value:.4} ({} to {})", end(low), end(high));
        let mut fields = vec![
            self.im.clone(),
            with(self.median, self.median_interval),
            with(self.beta, self.beta_interval),
            format!("{:.3}", self.auc),
            format!("{:.4}", self.brier),
            self.efficiency.map_or("none".into(), |efficiency| format!("{efficiency:.3}")),
            self.rows.to_string(),
        ];
        fields.extend(self.sufficiency.values().map(|p| format!("{p:.2e}")));
        fields
    }
}

impl Curves {
    fn words(&self) -> String {
        let Rows { all, told, exceeded, failed, separated } = self.rows;
        let left_out = [(failed, "failed"), (separated, "ended at separation")];
        let left_out = left_out.iter().filter(|(count, _)| *count > 0);
        let left_out: String = left_out.map(|(count, why)| format!(", {count} {why}")).collect();
        let mut words = format!(
            "table         {}: {all} rows{left_out}\n\
             limit         {}: exceeded in {} of {told} rows\n\
             curve         {}, intervals of {} %\n",
            self.table,
            self.limit,
            // A sum of probabilities has more digits than anybody needs.
            (exceeded * 10.0).round() / 10.0,
            self.link,
            100.0 * self.confidence
        );
        let mut rows =
            vec![["measure", "median", "beta", "AUC", "Brier", "efficiency", "rows"].map(String::from).to_vec()];
        rows[0].extend(self.measures[0].sufficiency.keys().map(|other| format!("p beside {other}")));
        rows.extend(self.measures.iter().map(Measure::fields));
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
        for row in &rows {
            let line: String = row.iter().zip(&widths).map(|(field, width)| format!("{field:<width$}  ")).collect();
            // Writing to a String never fails.
            let _ = writeln!(words, "{}", line.trim_end());
        }
        let without: usize = self.measures.iter().filter_map(|measure| measure.without_curve).sum();
        if without > 0 {
            let _ = writeln!(
                words,
                "bootstrap     {without} samples have no curve: their data are separable or of one class"
            );
        }
        words
    }
}
