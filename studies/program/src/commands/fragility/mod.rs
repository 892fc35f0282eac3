//! `rocking fragility`: the table of a sweep → fragility curves.

pub mod report;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::options::choices;
use crate::options::explicit::ExplicitOptions;
use crate::options::fit::FitOptions;
use crate::options::measure::BlockScales;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::PictureOptions;
use crate::output::report::ReportOptions;
use report::{MeasureReport, SurfaceReport, summary, warning_of_left_out};
use rocking_charts::directions::directions;
use rocking_charts::fragility as charts;
use rocking_charts::picture::PictureFormat;
use rocking_studies::fragility::{
    Assessment, CaseStore, Collected, Component, Ida, Limit, LossProgram, Motions, RowCounts, Surface, Uncertainty,
    openquake, pelicun, sufficiency_of,
};
use rocking_studies::intensity::MeasureColumn;

/// Options of `rocking fragility`.
#[derive(Parser)]
pub struct FragilityCommand {
    /// Table of a sweep, in CSV or Parquet; a folder of parts or of other such files, or a pattern of them in quotes; `-` for standard input
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Intensity measure, or any other column of positive numbers, with or without its unit; several are compared
    #[arg(long, value_name = "COLUMN", required_unless_present = "plot_polar")]
    im: Vec<String>,
    #[command(flatten)]
    fit: FitOptions,
    /// Second measure, for a surface of both
    #[arg(long, value_name = "COLUMN")]
    surface: Option<String>,
    /// Column against which the sufficiency of each measure is tested
    #[arg(long, value_name = "COLUMN")]
    beside: Vec<String>,
    /// Picture of incremental dynamic analysis, peaks over the levels of a sweep; SVG or PNG by its extension
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    ida: Option<PathBuf>,
    /// Polar chart of the outcomes by azimuth, of a table of blocks in space, also without --im; SVG or PNG by its extension
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    plot_polar: Option<PathBuf>,
    /// Write the curve for a program of loss assessment
    #[arg(long, value_parser = choices::loss_program(), value_name = "PROGRAM", requires = "export_to", help_heading = "Export")]
    export: Option<LossProgram>,
    /// Folder for `fragility.csv` and `fragility.json` of pelicun, or file for the NRML of OpenQuake
    #[arg(long, value_name = "PATH", requires = "export", help_heading = "Export")]
    export_to: Option<PathBuf>,
    /// Identifier of the component of pelicun, or taxonomy of OpenQuake's assets
    #[arg(long, value_name = "ID", default_value = "rocking.block", help_heading = "Export")]
    id: String,
    /// Limit of a further damage state in the export, such as 0.5 beside overturned
    #[arg(long, value_name = "LIMIT", requires = "export", help_heading = "Export")]
    export_limit: Vec<Limit>,
    #[command(flatten)]
    block: BlockScales,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &FragilityCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let FragilityCommand { im, fit, ida, .. } = options;
    options.check(explicit)?;
    let plot = options.picture.plot.as_deref();
    let format = options.picture.format()?;
    let ida_format = ida.as_deref().map(PictureFormat::of).transpose()?;
    let polar_format = options.plot_polar.as_deref().map(PictureFormat::of).transpose()?;
    let exports = options.export_files();
    if options.export == Some(LossProgram::Pelicun) {
        let folder = options.export_to.as_deref().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    }
    let outputs = [("plot", plot), ("ida", ida.as_deref()), ("plot-polar", options.plot_polar.as_deref())];
    let outputs = outputs.into_iter().chain(exports.iter().map(|path| ("export-to", Some(path.as_path()))));
    let mut outputs = Outputs::checked(&[NamedFile::new("the table", &options.table)], outputs)?;

    let mut table = options.cases()?;
    let mut assess = |i: usize| options.assess(&mut table, i, plot.is_some(), explicit);
    let (mut curves, mut without_curve) = (Vec::new(), Vec::new());
    for found in (0..im.len()).map(&mut assess) {
        match found {
            Ok(curve) => curves.push(curve),
            // A measure without a curve, as one that separates both classes, does not end the comparison.
            Err(error) if im.len() > 1 => without_curve.push(error),
            Err(error) => return Err(error),
        }
    }
    if curves.is_empty() && !im.is_empty() {
        return Err(without_curve.remove(0));
    }
    let mut warnings = Vec::from_iter(warning_of_left_out(&table.counts));
    warnings.extend(without_curve.iter().map(|error| format!("{error:#}")));
    for warning in curves.iter().flat_map(|curve| &curve.warnings) {
        // That of missing intervals is the same for all measures.
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    for content in curves.iter().flat_map(|curve| &curve.exported) {
        outputs.fill("export-to", || Ok(content.clone().into_bytes()))?;
    }
    if let Some(svg) = curves.iter().find_map(|curve| curve.svg.as_ref()) {
        outputs.fill("plot", || Ok(format.encode(svg)?))?;
    }
    if let Some(format) = ida_format {
        // All columns identify the curves of an analysis.
        let rows = fit.rows.table(&options.table)?;
        let curves = Ida::read(&rows, &im[0])?;
        let svg = charts::ida(&table.blocks, &curves, &rows.heading(&im[0])?)?;
        outputs.fill("ida", || Ok(format.encode(&svg)?))?;
    }
    if let Some(format) = polar_format {
        let rows = fit.rows.table(&options.table)?;
        let svg = directions(&table.blocks, &rows.directions(table.limit)?, table.limit)?;
        outputs.fill("plot-polar", || Ok(format.encode(&svg)?))?;
    }
    let written = outputs.write()?;
    warn(&warnings);
    let summary = summary(&table, fit, &curves);
    options.report.print("fragility", &written, &warnings, &(summary.text + &written.lines()), &summary.json)
}

/// The cases of a table for each measure and limit, and words on its blocks.
struct TableCases {
    name: String,
    blocks: String,
    is_in_space: bool,
    /// Headings of the measures, of the columns beside them and of that of the surface.
    headings: Vec<String>,
    limit: Limit,
    counts: RowCounts,
    motions: Motions,
    /// For each measure: its own cases, those beside other columns, and those of the surface.
    stores: std::vec::IntoIter<CaseStore>,
    /// The cases for further limits of the export.
    further: Vec<(Limit, Collected)>,
}

/// The curve of a measure; of a single one also its surface, its picture and its export.
struct MeasureCurve {
    report: MeasureReport,
    /// Method of the intervals.
    intervals: String,
    warnings: Vec<String>,
    surface: Option<SurfaceReport>,
    svg: Option<String>,
    exported: Vec<String>,
}

impl FragilityCommand {
    /// Refuses options without effect.
    fn check(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        explicit.refuse_unless(self.export.is_some(), &["id", "alpha", "p", "g"], "without --export")?;
        self.fit.check(explicit)?;
        for option in ["plot", "surface", "ida", "export"].into_iter().filter(|option| explicit.has(option)) {
            anyhow::ensure!(self.im.len() == 1, "--{option} with {} measures; expected one --im", self.im.len());
        }
        Ok(())
    }

    /// Reads the cases for all measures and limits in one pass over the table.
    fn cases(&self) -> anyhow::Result<TableCases> {
        let FragilityCommand { im, fit, beside, surface, .. } = self;
        let one = |name: &String| (name.clone(), None);
        let with = |name: &String, other: &String| (name.clone(), Some(other.clone()));
        let others: Vec<&String> = beside.iter().chain(surface).collect();
        let columns =
            im.iter().flat_map(|name| std::iter::once(one(name)).chain(others.iter().map(|other| with(name, other))));
        let mut found = Collected::new(fit.limit, fit.rows.cluster.clone(), columns.collect());
        let collected = |limit| Collected::new(Some(limit), fit.rows.cluster.clone(), vec![one(&im[0])]);
        let further = self.export_limit.iter().map(|&limit| (limit, collected(limit)));
        let mut further: Vec<(Limit, Collected)> = further.collect();
        let (mut blocks, mut headings, mut is_in_space) = (charts::Blocks::default(), None, false);
        let named: Vec<&str> = im.iter().chain(others).map(String::as_str).collect();
        let name = fit.rows.read_batches(&self.table, &named, &mut |batch, is_part| {
            blocks.take(batch);
            is_in_space = batch.is_in_space();
            if headings.is_none() {
                headings = Some(named.iter().map(|name| batch.heading(name)).collect::<Result<Vec<_>, _>>()?);
            }
            further.iter_mut().try_for_each(|(_, found)| found.take(batch, is_part).map(drop))?;
            found.take(batch, is_part)?;
            Ok(())
        })?;
        Ok(TableCases {
            name,
            blocks: blocks.to_string(),
            is_in_space,
            headings: headings.unwrap_or_default(),
            limit: found.limit.unwrap_or(Limit::Overturned),
            counts: found.counts,
            motions: found.motions,
            stores: found.stores.into_iter(),
            further,
        })
    }

    /// Fits the curve of a measure. Its surface, its picture and its export are made as requested.
    fn assess(
        &self,
        table: &mut TableCases,
        i: usize,
        draws: bool,
        explicit: &ExplicitOptions,
    ) -> anyhow::Result<MeasureCurve> {
        let FragilityCommand { im, beside, fit, .. } = self;
        let (link, ci) = (fit.link, fit.rows.ci);
        let TableCases { name, blocks, headings, limit, motions, stores, further, .. } = table;
        let (measure, Some(heading)) = (&im[i], headings.get(i)) else { anyhow::bail!("{name}: no rows") };
        let at = || format!("{name}: {measure}");
        // All stores of the measure, also if it has no curve.
        let count = 1 + beside.len() + usize::from(self.surface.is_some());
        let mut own = stores.by_ref().take(count).collect::<Vec<_>>().into_iter();
        let mut store = || own.next().unwrap_or_default();
        let found = Assessment::of(store(), motions, link, ci, fit.uncertainty()).with_context(at)?;
        let mut warnings = found.warnings(heading);
        let p_value = |other: &String| {
            let found = sufficiency_of(store(), motions, link);
            Ok((other.clone(), found.with_context(|| format!("{name}: {measure} beside {other}"))?))
        };
        let sufficiency = beside.iter().map(p_value).collect::<anyhow::Result<BTreeMap<_, _>>>()?;
        let (mut surface, mut svg, mut exported) = (None, None, Vec::new());
        if let Some(other) = &self.surface {
            let found = Surface::of(store(), motions, link);
            let found = found.with_context(|| format!("{name}: {measure} and {other}"))?;
            let headings = [heading, headings.last().unwrap_or(heading)].map(String::as_str);
            if draws {
                svg = Some(charts::surface(blocks, &found, headings, *limit)?);
            }
            surface = Some(SurfaceReport::of(headings, &found));
        } else if draws {
            svg = Some(charts::curve(blocks, &found, heading, *limit, ci)?);
        }
        if let Some(program) = self.export {
            let further = std::mem::take(further);
            let component = self.component(name, heading, *limit, &found, further, explicit).with_context(at)?;
            warnings.extend(component.crossings());
            exported = match program {
                LossProgram::Pelicun => pelicun(&[component], self.block.g)?.to_vec(),
                LossProgram::OpenQuake => vec![openquake(&[component], self.block.g)?],
            };
        }
        let intervals = found.intervals();
        let report = MeasureReport::of(heading, &found, &sufficiency);
        Ok(MeasureCurve { report, intervals, warnings, surface, svg, exported })
    }

    /// Returns the files of the export.
    fn export_files(&self) -> Vec<PathBuf> {
        match (self.export, &self.export_to) {
            (Some(LossProgram::Pelicun), Some(folder)) => {
                ["fragility.csv", "fragility.json"].map(|file| folder.join(file)).to_vec()
            }
            (Some(LossProgram::OpenQuake), Some(file)) => vec![file.clone()],
            _ => Vec::new(),
        }
    }

    /// Returns the curve of the measure with this heading as a component of the export. The curves of the further limits are part of it.
    fn component(
        &self,
        table: &str,
        heading: &str,
        limit: Limit,
        found: &Assessment,
        further: Vec<(Limit, Collected)>,
        explicit: &ExplicitOptions,
    ) -> anyhow::Result<Component> {
        let (behind, factor) = self.block.behind(&MeasureColumn::of_heading(heading), explicit)?;
        let measure = behind.name.parse().map_err(anyhow::Error::msg)?;
        let fit = |(limit, Collected { limit: of_table, stores, motions, .. }): (Limit, Collected)| {
            let limit = of_table.unwrap_or(limit);
            let store = stores.into_iter().next().unwrap_or_default();
            let found = Assessment::of(store, &motions, self.fit.link, self.fit.rows.ci, Uncertainty::Profile);
            Ok((limit, found.with_context(|| limit.to_string())?.fit))
        };
        let further = further.into_iter().map(fit).collect::<anyhow::Result<Vec<_>>>()?;
        let curves = || std::iter::once((limit, &found.fit)).chain(further.iter().map(|(limit, fit)| (*limit, fit)));
        let limits: Vec<String> = curves().map(|(limit, _)| limit.to_string()).collect();
        let file = table.rsplit(['/', '\\']).next().unwrap_or_default();
        let description = format!(
            "{} over {heading} in {} rows of {file}, by rocking-block {}",
            limits.join(", "),
            found.rows,
            env!("CARGO_PKG_VERSION")
        );
        Ok(Component::new(&self.id, measure, factor, curves(), &description)?)
    }
}
