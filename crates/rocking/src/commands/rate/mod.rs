//! `rocking rate`: a hazard curve, a fragility curve → the annual rate of exceedance.

mod report;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Parser};

use crate::options::checks::check;
use crate::options::explicit::ExplicitOptions;
use crate::options::fit::FitOptions;
use crate::options::input;
use crate::options::measure::BlockScales;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::Object;
use report::RateReport;
use rocking_charts::fragility::probability_of;
use rocking_studies::fragility::{Assessment, Collected, Interval, Limit, split_heading};
use rocking_studies::intensity::Measure;
use rocking_studies::risk::{AnnualRate, FragilityCurve, HazardCurve, HazardOptions, interval, read_hazard, si};
use rocking_studies::spec::words::Words;
use rocking_studies::statistics::range;

/// Options of `rocking rate`.
#[derive(Parser)]
pub struct RateCommand {
    /// Hazard curve: CSV with two columns such as `PGV [m/s],rate [1/year]`, CSV exported by OpenQuake or nshmp-haz, or JSON of the
    /// hazard services of the USGS; `-` for standard input
    #[arg(value_name = "HAZARD")]
    hazard: PathBuf,
    #[command(flatten)]
    reading: HazardReading,
    #[command(flatten)]
    fragility: FragilityOptions,
    #[command(flatten)]
    block: BlockScales,
    /// Years for which the probability of exceeding the limit is reported
    #[arg(long, value_name = "YEARS,...", value_delimiter = ',', default_values_t = [1.0, 50.0], help_heading = "Results")]
    years: Vec<f64>,
    /// Table of the deaggregation: the part of the rate between the hazard's levels; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Args)]
#[command(next_help_heading = "Reading the hazard")]
struct HazardReading {
    /// Name of the site, or LON,LAT, in a file of several
    #[arg(long, value_name = "SITE", allow_hyphen_values = true)]
    site: Option<String>,
    /// Unit of the levels, if the file does not name it: g, m/s2, cm/s2, m/s, cm/s, m, cm or s
    #[arg(long, value_name = "UNIT")]
    hazard_unit: Option<String>,
    /// Years to which the probabilities of the file refer; without it, it has annual rates
    #[arg(long, value_name = "YEARS")]
    investigation_time: Option<f64>,
}

#[derive(Args)]
#[command(next_help_heading = "Fragility")]
struct FragilityOptions {
    /// Intensity measure: a column of the table, or name and unit of the median, such as "PGV [m/s]"
    #[arg(long, value_name = "COLUMN")]
    im: Option<String>,
    /// Table of a sweep, to which a curve is fitted as by `rocking fragility`
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["median", "beta"])]
    table: Option<PathBuf>,
    /// Median of a lognormal curve, in the unit of --im or else in SI units
    #[arg(long, value_name = "M", requires = "beta")]
    median: Option<f64>,
    /// Dispersion of a lognormal curve; 0 for a step
    #[arg(long, value_name = "BETA", requires = "median")]
    beta: Option<f64>,
    /// Use the fractions of the table's rows at each of its levels, without a fitted curve
    #[arg(long, requires = "table")]
    empirical: bool,
    #[command(flatten)]
    fit: FitOptions,
}

/// A fragility curve and its origin.
struct Fragility {
    curve: FragilityCurve,
    /// Name and unit of the measure, if known.
    heading: Option<String>,
    assessment: Option<Assessment>,
    /// Name of its probability.
    ordinate: String,
    /// Least and greatest measure of the rows.
    rows: Option<[f64; 2]>,
    /// The curve in words.
    text: String,
    /// The curve in numbers.
    json: Object,
}

/// Runs the command.
pub fn run(options: &RateCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let FragilityOptions { table, empirical, fit, .. } = &options.fragility;
    fit.check(explicit)?;
    explicit.refuse_unless(table.is_some(), &["where", "link", "ci", "bootstrap"], "without --table")?;
    explicit.refuse_unless(!empirical, &["link", "ci", "bootstrap"], "with --empirical")?;
    check("g", options.block.g, |x| x > 0.0, "an acceleration above 0")?;
    for &years in &options.years {
        check("years", years, |x| x > 0.0, "a number of years above 0")?;
    }
    let csv = options.csv.as_deref();
    csv.map_or(Ok(()), check_table)?;
    let format = options.picture.format()?;
    let tables = table.iter().map(|path| NamedFile::new("--table", path));
    let inputs: Vec<_> = std::iter::once(NamedFile::new("the hazard curve", &options.hazard)).chain(tables).collect();
    let mut outputs = Outputs::checked(&inputs, [("csv", csv), ("plot", options.picture.plot.as_deref())])?;

    let fragility = options.fragility.read(options.block.g)?;
    let (file, hazard) = options.hazard(&fragility, explicit)?;
    let found = AnnualRate::new(&hazard, &fragility.curve);
    anyhow::ensure!(
        found.rate.is_finite(),
        "{file}: the hazard grows faster towards small measures than the logistic curve falls, so that the rate is not bounded; \
         expected a hazard curve from lower levels, or --link probit"
    );
    let ends = fragility.assessment.as_ref().map(|assessment| (fit.ci, interval(&hazard, assessment)));
    let heading = fragility.heading.clone().unwrap_or_else(|| heading(&hazard));
    let (fragility, found, years) = (&fragility, &found, &options.years);
    let report = RateReport { file, im: &heading, fragility, found, ends, years };
    outputs.fill("plot", || {
        let band = |at: &[f64]| -> Option<Vec<Interval>> { Some(fragility.assessment.as_ref()?.band(at)) };
        let svg = rocking_charts::rate::rate(&report.lines(), found, &heading, &fragility.ordinate, band)?;
        Ok(format.encode(&svg)?)
    })?;
    outputs.fill("csv", || Ok(report.table().into_bytes()))?;
    let written = outputs.write()?;
    let of_curve = fragility.assessment.iter().flat_map(|assessment| assessment.warnings(&heading));
    let warnings: Vec<String> = of_curve.chain(report.warnings()).collect();
    warn(&warnings);
    let summary = report.summary();
    options.report.print("rate", &written, &warnings, &(summary.text + &written.lines()), &summary.json)
}

fn heading(hazard: &HazardCurve) -> String {
    let name = hazard.measure.as_deref().unwrap_or("measure");
    hazard.unit.as_ref().map_or(name.into(), |unit| format!("{name} [{unit}]"))
}

impl RateCommand {
    /// Reads the hazard curve of the measure of a fragility curve. It is relative to the block if that measure is.
    fn hazard(&self, fragility: &Fragility, explicit: &ExplicitOptions) -> anyhow::Result<(String, HazardCurve)> {
        let (name, unit) = fragility.heading.as_deref().map(split_heading).unzip();
        let measure = name.and_then(|name| name.parse::<Measure>().ok());
        let relative = measure.filter(|measure| Measure::OF_BLOCK.contains(measure));
        let (base, factor) = match measure {
            Some(measure) => {
                let (base, factor) = self.block.base(measure, explicit)?;
                (Some(base.to_string()), factor)
            }
            None => {
                explicit.refuse_unless(false, &["alpha", "p"], "without a measure relative to the block")?;
                (name.map(String::from), 1.0)
            }
        };
        let HazardReading { site, hazard_unit, investigation_time } = &self.reading;
        let options = HazardOptions {
            measure: base,
            unit: hazard_unit.clone(),
            site: site.clone(),
            years: *investigation_time,
            gravity: self.block.g,
        };
        let (name, text) = input::text(&self.hazard)?;
        let hazard = read_hazard(&name, &text, &options).with_context(|| name.clone())?;
        if let (None, Some(Some(unit)), Some(found)) = (relative, unit, &hazard.unit) {
            anyhow::ensure!(
                found == unit,
                "{name}: found levels in {found}; expected {unit}, the unit of the fragility curve"
            );
        }
        if let (Some(measure), None) = (measure, &hazard.unit) {
            anyhow::bail!("{name}: no unit of the levels; expected --hazard-unit, as for {}", measure.heading());
        }
        Ok((name, hazard.scaled(factor)))
    }
}

impl FragilityOptions {
    fn read(&self, gravity: f64) -> anyhow::Result<Fragility> {
        match (&self.table, self.median, self.beta) {
            (Some(path), ..) => self.fitted(path),
            (None, Some(median), Some(beta)) => self.lognormal(median, beta, gravity),
            (None, ..) => anyhow::bail!("found no fragility curve; expected --table and --im, or --median and --beta"),
        }
    }

    fn lognormal(&self, median: f64, beta: f64, gravity: f64) -> anyhow::Result<Fragility> {
        let (mut heading, mut factor) = (None, 1.0);
        if let Some((name, found)) = self.im.as_deref().map(split_heading) {
            let measure = name.parse::<Measure>().ok();
            let name = measure.map_or(name.into(), |measure| measure.to_string());
            let mut unit = found.or(measure.map(Measure::unit));
            if let Some((si, of_si)) = found.and_then(|found| si(found, gravity)) {
                (unit, factor) = (Some(si), of_si);
            }
            if let (Some(found), Some(expected)) = (found, measure.map(Measure::unit)) {
                anyhow::ensure!(unit == Some(expected), "--im {name} in {found}; expected a unit of {expected}");
            }
            heading = Some(unit.map_or(name.clone(), |unit| format!("{name} [{unit}]")));
        }
        let median = median * factor;
        Ok(Fragility {
            curve: FragilityCurve::lognormal(median, beta)?,
            heading,
            assessment: None,
            ordinate: "probability of exceedance".into(),
            rows: None,
            text: format!("lognormal, median {median:.4}, beta {beta:.4}"),
            json: Object::default().with("curve", "lognormal").with("median", median).with("beta", beta),
        })
    }

    fn fitted(&self, path: &Path) -> anyhow::Result<Fragility> {
        let im = self.im.as_deref().context("--table without --im; expected the column of the intensity measure")?;
        let FitOptions { link, ci, .. } = self.fit;
        let mut found = Collected::new(self.fit.limit, vec![(im.into(), None)]);
        let mut heading = None;
        let name = self.fit.read_batches(path, &[im], &mut |batch, is_part| {
            if heading.is_none() {
                heading = Some(batch.heading(im)?);
            }
            Ok(found.take(batch, is_part)?)
        })?;
        let limit = found.limit.unwrap_or(Limit::Overturned);
        let Collected { stores, motions, .. } = found;
        let store = stores.into_iter().next().unwrap_or_default();
        let at = || format!("{name}: {im}");
        let ordinate = probability_of(limit);
        let json = |curve: &str| Object::from([("curve", curve), ("table", &name)]).with("limit", limit.to_string());
        if self.empirical {
            let levels = store.levels(&motions).with_context(at)?;
            let row_count: usize = levels.iter().map(|(.., rows)| rows).sum();
            anyhow::ensure!(
                row_count >= 2 * levels.len(),
                "{name}: {im} has {} levels in {row_count} rows; expected several rows at each level, as from a sweep with levels",
                levels.len()
            );
            let rows = range(levels.iter().map(|(level, ..)| *level));
            let (levels, fractions): (Vec<f64>, Vec<f64>) =
                levels.iter().map(|(level, sum, rows)| (*level, sum / *rows as f64)).unzip();
            let curve = FragilityCurve::tabulated(&levels, &fractions).with_context(at)?;
            let text = format!("empirical, fractions at {} levels; {limit} in {name}", levels.len());
            let json = json("empirical").with("levels", levels.len());
            return Ok(Fragility { curve, heading, assessment: None, ordinate, rows, text, json });
        }
        let uncertainty = self.fit.uncertainty();
        let assessment = Assessment::of(store, &motions, link, ci, uncertainty).with_context(at)?;
        let rows = range(assessment.marks().iter().map(|row| row.measures[0]));
        let curve = FragilityCurve::of(&assessment.fit).with_context(at)?;
        let (median, beta) = (assessment.fit.median(), assessment.fit.dispersion());
        let text = format!("{link}, median {median:.4}, beta {beta:.4}; {limit} in {name}");
        let intervals = uncertainty.words(assessment.independence);
        let json = json(link.word()).with("median", median).with("beta", beta).with("intervals", intervals);
        Ok(Fragility { curve, heading, assessment: Some(assessment), ordinate, rows, text, json })
    }
}
