//! `rocking fragility`: the table of a sweep → fragility curves.

mod report;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use crate::options::choices;
use crate::options::explicit::ExplicitOptions;
use crate::options::fit::FitOptions;
use crate::options::measure::BlockScales;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::formats::PictureOptions;
use crate::output::report::{ReportOptions, WrittenFiles};
use report::{FragilityReport, MeasureReport, SurfaceReport, warning_of_left_out};
use rocking_charts::fragility as charts;
use rocking_charts::picture::PictureFormat;
use rocking_studies::fragility::{
    Assessment, Collected, Component, Ida, Limit, LossProgram, Surface, Uncertainty, openquake, pelicun, split_heading,
    sufficiency_of,
};
use rocking_studies::intensity::Measure;

/// Options of `rocking fragility`.
#[derive(Parser)]
pub struct FragilityCommand {
    /// Table of a sweep, in CSV or Parquet; a folder of parts or of other such files, or a pattern of them in quotes; `-` for standard input
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Intensity measure, or any other column of positive numbers, with or without its unit; several are compared
    #[arg(long, value_name = "COLUMN", required = true)]
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
    let FragilityCommand { im, fit, beside, ida, .. } = options;
    let FitOptions { link, ci, .. } = fit;
    let plot = options.picture.plot.as_deref();
    explicit.refuse_unless(plot.is_some(), &["plot-format"], "without --plot")?;
    explicit.refuse_unless(options.export.is_some(), &["id", "alpha", "p", "g"], "without --export")?;
    fit.check(explicit)?;
    for option in ["plot", "surface", "ida", "export"].into_iter().filter(|option| explicit.has(option)) {
        anyhow::ensure!(im.len() == 1, "--{option} with {} measures; expected one --im", im.len());
    }
    let format = options.picture.format()?;
    let ida_format = ida.as_deref().map(PictureFormat::of).transpose()?;
    let exports = options.export_files();
    if options.export == Some(LossProgram::Pelicun) {
        let folder = options.export_to.as_deref().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
    }
    let outputs = [("plot", plot), ("ida", ida.as_deref())];
    let outputs = outputs.into_iter().chain(exports.iter().map(|path| ("export-to", Some(path.as_path()))));
    let outputs: Vec<_> = outputs.collect();
    check_distinct(&[NamedFile::new("the table", &options.table)], &NamedFile::of_options(outputs.iter().copied()))?;
    let export_files = exports.iter().map(|path| Pending::new(path)).collect::<anyhow::Result<Vec<_>>>()?;
    let picture = plot.map(Pending::new).transpose()?;
    let ida_picture = ida.as_deref().map(Pending::new).transpose()?;
    let one = |name: &String| [Some(name.clone()), None];
    let with = |name: &String, other: &String| [Some(name.clone()), Some(other.clone())];
    // For each measure: its own cases, those beside other columns, and those of the surface.
    let others: Vec<&String> = beside.iter().chain(&options.surface).collect();
    let columns =
        im.iter().flat_map(|name| std::iter::once(one(name)).chain(others.iter().map(|other| with(name, other))));
    let mut found = fit.collected(None, columns.collect());
    let further = options.export_limit.iter().map(|&limit| (limit, fit.collected(Some(limit), vec![one(&im[0])])));
    let mut further: Vec<(Limit, Collected)> = further.collect();
    let (mut blocks, mut headings) = (charts::Blocks::default(), None);
    let named: Vec<&str> = im.iter().chain(others.iter().copied()).map(String::as_str).collect();
    let name = fit.read_batches(&options.table, &named, &mut |batch, is_part| {
        blocks.take(batch);
        if headings.is_none() {
            headings = Some(named.iter().map(|name| batch.heading(name)).collect::<Result<Vec<_>, _>>()?);
        }
        further.iter_mut().try_for_each(|(_, found)| found.take(batch, is_part))?;
        Ok(found.take(batch, is_part)?)
    })?;
    let (limit, headings) = (found.limit().unwrap_or(Limit::Overturned), headings.unwrap_or_default());
    let blocks = blocks.to_string();
    let uncertainty = fit.uncertainty();
    let (mut measures, mut surface, mut svg) = (Vec::new(), None, None);
    let Collected { stores, motions, counts, .. } = found;
    let mut stores = stores.into_iter();
    let (mut exported, mut warnings) = (Vec::new(), Vec::from_iter(warning_of_left_out(&counts)));
    let mut intervals = None;
    for (measure, heading) in im.iter().zip(&headings) {
        let at = || format!("{name}: {measure}");
        let mut store = || stores.next().unwrap_or_default();
        let assessment = Assessment::of(store(), &motions, *link, *ci, uncertainty).with_context(at)?;
        intervals.get_or_insert_with(|| uncertainty.words(assessment.independence));
        // That of missing intervals is the same for all measures.
        let new = assessment.warnings(heading).into_iter().filter(|warning| !warnings.contains(warning));
        let new: Vec<String> = new.collect();
        warnings.extend(new);
        let p_value = |other: &String| {
            let found = sufficiency_of(store(), &motions, *link);
            Ok((other.clone(), found.with_context(|| format!("{name}: {measure} beside {other}"))?))
        };
        let sufficiency = beside.iter().map(p_value).collect::<anyhow::Result<BTreeMap<_, _>>>()?;
        if let Some(other) = &options.surface {
            let found = Surface::of(store(), &motions, *link);
            let found = found.with_context(|| format!("{name}: {measure} and {other}"))?;
            let headings = [heading, headings.last().unwrap_or(heading)];
            if format.is_some() {
                svg = Some(charts::surface(&blocks, &found, headings.map(String::as_str), limit)?);
            }
            surface = Some(SurfaceReport::of(headings.map(String::as_str), &found));
        } else if format.is_some() {
            svg = Some(charts::curve(&blocks, &assessment, heading, limit, *ci)?);
        }
        if let Some(program) = options.export {
            let further = std::mem::take(&mut further);
            let component =
                options.component(&name, heading, limit, &assessment, further, explicit).with_context(at)?;
            warnings.extend(component.crossings());
            exported = match program {
                LossProgram::Pelicun => pelicun(&[component], options.block.g)?.to_vec(),
                LossProgram::OpenQuake => vec![openquake(&[component], options.block.g)?],
            };
        }
        measures.push(MeasureReport::of(heading, &assessment, sufficiency));
    }
    let mut pictures: Vec<(Pending, Vec<u8>)> =
        export_files.into_iter().zip(exported.into_iter().map(String::into_bytes)).collect();
    if let (Some(file), Some(format), Some(svg)) = (picture, format, svg) {
        pictures.push((file, format.encode(&svg)?));
    }
    if let (Some(file), Some(format)) = (ida_picture, ida_format) {
        // All columns identify the curves of an analysis.
        let table = fit.table(&options.table)?;
        let curves = Ida::read(&table, &im[0])?;
        let svg = charts::ida(&blocks, &curves, &table.heading(&im[0])?)?;
        pictures.push((file, format.encode(&svg)?));
    }
    Pending::write(pictures)?;
    let result = FragilityReport {
        table: name,
        limit: limit.to_string(),
        link: link.to_string(),
        confidence: *ci,
        intervals: intervals.unwrap_or_default(),
        rows: counts,
        measures,
        surface,
    };
    for warning in &warnings {
        eprintln!("rocking: warning: {warning}");
    }
    let written = WrittenFiles::new(outputs);
    options.report.print("fragility", &written, &warnings, &(result.text() + &written.lines()), &result)
}

impl FragilityCommand {
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

    /// Returns the curve of the measure with this heading, and those of the further limits, as a component of the export.
    fn component(
        &self,
        table: &str,
        heading: &str,
        limit: Limit,
        found: &Assessment,
        further: Vec<(Limit, Collected)>,
        explicit: &ExplicitOptions,
    ) -> anyhow::Result<Component> {
        let measure: Measure = split_heading(heading).0.parse().map_err(anyhow::Error::msg)?;
        let (base, factor) = self.block.base(measure, explicit)?;
        let fit = |(limit, Collected { stores, motions, .. }): (Limit, Collected)| {
            let store = stores.into_iter().next().unwrap_or_default();
            let found = Assessment::of(store, &motions, self.fit.link, self.fit.ci, Uncertainty::Profile);
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
        Ok(Component::new(&self.id, base, factor, curves(), &description)?)
    }
}
