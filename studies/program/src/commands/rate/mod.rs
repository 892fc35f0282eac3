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
use rocking_studies::fragility::{Assessment, CaseStore, Collected, Interval, Limit};
use rocking_studies::intensity::MeasureColumn;
use rocking_studies::mismatch::Mismatch;
use rocking_studies::risk::{
    AnnualRate, FragilityCurve, HazardCurve, HazardOptions, interval, read_hazard, unknown_rates,
};
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
    /// Kind of the curves of OpenQuake, such as quantile-0.84, instead of the mean
    #[arg(long, value_name = "KIND")]
    kind: Option<String>,
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
    /// Median of a lognormal curve, in the unit of --im
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
    /// Its measure, with the unit of its numbers.
    over: MeasureColumn,
    assessment: Option<Assessment>,
    /// Rows of its table without a known outcome, with the curves if none of them exceeds the limit, and if all do.
    unknown: Option<(usize, [Option<FragilityCurve>; 2])>,
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
    let of_table = ["limit", "where", "partial", "link", "ci", "cluster", "bootstrap"];
    explicit.refuse_unless(table.is_some(), &of_table, "without --table")?;
    explicit.refuse_unless(!empirical, &["link", "ci", "cluster", "bootstrap"], "with --empirical")?;
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
    let ends = fragility.assessment.as_ref().map(|assessment| (fit.rows.ci, interval(&hazard, assessment)));
    let heading = fragility.over.to_string();
    let (fragility, found, years) = (&fragility, &found, &options.years);
    let unknown = fragility.unknown.as_ref().map(|(rows, curves)| (*rows, unknown_rates(&hazard, curves)));
    let report = RateReport { file, im: &heading, fragility, found, ends, unknown, years };
    outputs.fill("plot", || {
        let band = |at: &[f64]| -> Option<Vec<Interval>> { Some(fragility.assessment.as_ref()?.band(at)) };
        let svg = rocking_charts::rate::rate(&report.lines(), found, &heading, &fragility.ordinate, band)?;
        Ok(format.encode(&svg)?)
    })?;
    outputs.fill_table("csv", || Ok(report.table()))?;
    let written = outputs.write()?;
    let of_curve = fragility.assessment.iter().flat_map(|assessment| assessment.warnings(&heading));
    let warnings: Vec<String> = of_curve.chain(report.warnings()).collect();
    warn(&warnings);
    let summary = report.summary();
    options.report.print("rate", &written, &warnings, &(summary.text + &written.lines()), &summary.json)
}

impl RateCommand {
    /// Reads the hazard curve of the measure of a fragility curve. It is relative to the block if that measure is.
    fn hazard(&self, fragility: &Fragility, explicit: &ExplicitOptions) -> anyhow::Result<(String, HazardCurve)> {
        let behind = self.block.behind(&fragility.over, explicit)?;
        let HazardReading { site, hazard_unit, investigation_time, kind } = &self.reading;
        let options = HazardOptions {
            measure: Some(behind.0.name.clone()),
            unit: hazard_unit.clone(),
            site: site.clone(),
            years: *investigation_time,
            kind: kind.clone(),
            gravity: self.block.g,
        };
        let (name, text) = input::text(&self.hazard)?;
        let hazard = read_hazard(&name, &text, &options).with_context(|| name.clone())?;
        anyhow::ensure!(
            hazard.unit.is_some(),
            "{name}: no unit of the levels; expected --hazard-unit, for a fragility curve over {}",
            fragility.over
        );
        let hazard = hazard.over(&fragility.over, &behind).with_context(|| name.clone())?;
        Ok((name, hazard))
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
        let im = self.im.as_deref().context(
            "--median without --im; expected the measure with the unit of the median, such as --im \"PGA [g]\"",
        )?;
        let named = MeasureColumn::of_heading(im);
        let (unit, factor) = named.si(gravity).context("--im")?;
        let over = MeasureColumn { unit: Some(unit), ..named };
        let median = median * factor;
        Ok(Fragility {
            curve: FragilityCurve::lognormal(median, beta)?,
            text: format!("lognormal over {over}, median {median:.4}, beta {beta:.4}"),
            json: of_curve("lognormal", &over).with("median", median).with("beta", beta),
            over,
            assessment: None,
            unknown: None,
            ordinate: "probability of exceedance".into(),
            rows: None,
        })
    }

    fn fitted(&self, path: &Path) -> anyhow::Result<Fragility> {
        let im = self.im.as_deref().context("--table without --im; expected the column of the intensity measure")?;
        let (link, ci) = (self.fit.link, self.fit.rows.ci);
        let columns = vec![(im.into(), None)];
        let mut found = Collected::new(self.fit.limit, self.fit.rows.cluster.clone(), columns).with_completions();
        let mut heading = None;
        let name = self.fit.rows.read_batches(path, &[im], &mut |batch, is_part| {
            if heading.is_none() {
                heading = Some(batch.heading(im)?);
            }
            found.take(batch, is_part)?;
            Ok(())
        })?;
        let over = MeasureColumn::of_heading(heading.as_deref().unwrap_or(im));
        let limit = found.limit.unwrap_or(Limit::Overturned);
        let Collected { stores, completions, motions, counts, .. } = found;
        let completed = |store: CaseStore| match self.empirical {
            true => tabulated(&store.levels(&motions).ok()?).ok(),
            false => FragilityCurve::of(&store.fit(&motions, link).ok()?).ok(),
        };
        let rows = counts.all - counts.decided + counts.partly_known;
        let unknown = completions.filter(|_| rows > 0).map(|stores| (rows, stores.map(completed)));
        let store = stores.into_iter().next().unwrap_or_default();
        let at = || format!("{name}: {im}");
        let ordinate = probability_of(limit);
        let json = |curve: &str| of_curve(curve, &over).with("table", &name).with("limit", limit.to_string());
        if self.empirical {
            let levels = store.levels(&motions).with_context(at)?;
            let row_count: usize = levels.iter().map(|(.., rows)| rows).sum();
            anyhow::ensure!(
                row_count >= 2 * levels.len(),
                "{name}: {im} has {} levels in {row_count} rows; expected several rows at each level, as from a sweep with levels",
                levels.len()
            );
            let rows = range(levels.iter().map(|(level, ..)| *level));
            let curve = tabulated(&levels).with_context(at)?;
            let text = format!("empirical, fractions at {} levels of {over}; {limit} in {name}", levels.len());
            let json = json("empirical").with("levels", levels.len());
            return Ok(Fragility { curve, over, assessment: None, unknown, ordinate, rows, text, json });
        }
        let assessment = Assessment::of(store, &motions, link, ci, self.fit.uncertainty()).with_context(at)?;
        let rows = range(assessment.marks().iter().map(|row| row.measures[0]));
        let curve = FragilityCurve::of(&assessment.fit).with_context(at)?;
        let (median, beta) = (assessment.fit.median(), assessment.fit.dispersion());
        let text = format!("{link} over {over}, median {median:.4}, beta {beta:.4}; {limit} in {name}");
        let json =
            json(link.word()).with("median", median).with("beta", beta).with("intervals", assessment.intervals());
        Ok(Fragility { curve, over, assessment: Some(assessment), unknown, ordinate, rows, text, json })
    }
}

/// The curve of levels with their sums of fractions and numbers of rows.
fn tabulated(levels: &[(f64, f64, usize)]) -> Result<FragilityCurve, Mismatch> {
    let (levels, fractions): (Vec<f64>, Vec<f64>) =
        levels.iter().map(|(level, sum, rows)| (*level, sum / *rows as f64)).unzip();
    FragilityCurve::tabulated(&levels, &fractions)
}

/// Begins the numbers of a curve with its kind, its measure and its unit.
fn of_curve(kind: &str, over: &MeasureColumn) -> Object {
    Object::from([("curve", kind), ("im", &over.name)]).with("unit", over.unit.as_deref().unwrap_or("1"))
}
