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
use report::{FragilityReport, MeasureReport, RowCounts, SurfaceReport};
use rocking_charts::fragility as charts;
use rocking_charts::picture::PictureFormat;
use rocking_studies::fragility::{
    Assessment, Case, Component, Ida, Limit, LossProgram, Surface, SweepTable, Uncertainty, openquake, pelicun,
    split_heading, sufficiency_of_cases,
};
use rocking_studies::intensity::Measure;

/// Options of `rocking fragility`.
#[derive(Parser)]
pub struct FragilityCommand {
    /// Table of a sweep; `-` for standard input
    #[arg(value_name = "TABLE.csv")]
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
    options.check(explicit)?;
    let FragilityCommand { im, fit, beside, ida, .. } = options;
    let plot = options.picture.plot.as_deref();
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
    let named: Vec<&str> = im.iter().chain(beside).chain(&options.surface).map(String::as_str).collect();
    // All columns identify the curves of an analysis.
    let (name, table) = fit.table(&options.table, ida.is_none().then_some(&named))?;
    let limit = fit.limit(&table);
    let found = table.cases(limit)?;
    let rows = RowCounts::of(&table, &found);
    let data = CurveData { name: &name, table: &table, cases: &found.cases, limit, blocks: charts::blocks(&table) };
    let (mut measures, mut surface, mut svg, mut exported) = (Vec::new(), None, None, Vec::new());
    let (mut intervals, mut warnings) = (None, Vec::from_iter(rows.warning()));
    for measure in im {
        let found = options.assess(&data, measure, format.is_some(), explicit)?;
        // That of missing intervals is the same for all measures.
        let new = found.warnings.into_iter().filter(|warning| !warnings.contains(warning)).collect::<Vec<_>>();
        warnings.extend(new);
        intervals.get_or_insert(found.intervals);
        measures.push(found.report);
        (surface, svg, exported) = (found.surface, found.svg, found.exported);
    }
    let mut pictures: Vec<(Pending, Vec<u8>)> =
        export_files.into_iter().zip(exported.into_iter().map(String::into_bytes)).collect();
    if let (Some(file), Some(format), Some(svg)) = (picture, format, svg) {
        pictures.push((file, format.encode(&svg)?));
    }
    if let (Some(file), Some(format)) = (ida_picture, ida_format) {
        let curves = Ida::read(&table, &im[0])?;
        let svg = charts::ida(&data.blocks, &curves, &table.heading(&im[0])?)?;
        pictures.push((file, format.encode(&svg)?));
    }
    Pending::write(pictures)?;
    let result = FragilityReport {
        table: name,
        limit: limit.to_string(),
        link: fit.link.to_string(),
        confidence: fit.ci,
        intervals: intervals.unwrap_or_default(),
        rows,
        measures,
        surface,
    };
    for warning in &warnings {
        eprintln!("rocking: warning: {warning}");
    }
    let written = WrittenFiles::new(outputs);
    options.report.print("fragility", &written, &warnings, &(result.text() + &written.lines()), &result)
}

/// The rows from which the curves are made.
struct CurveData<'a> {
    /// Name of the table.
    name: &'a str,
    table: &'a SweepTable,
    cases: &'a [Case],
    limit: Limit,
    /// The blocks in words, for pictures.
    blocks: String,
}

impl CurveData<'_> {
    /// Returns a column, with a number for each case that has one.
    fn column(&self, name: &str) -> anyhow::Result<Vec<Option<f64>>> {
        let numbers = self.table.numbers(name)?;
        Ok(self.cases.iter().map(|case| numbers[case.row]).collect())
    }
}

/// The curve of a measure, and the results made from it.
struct MeasureResults {
    report: MeasureReport,
    surface: Option<SurfaceReport>,
    /// The picture.
    svg: Option<String>,
    /// Contents of the files of the export.
    exported: Vec<String>,
    /// The method of the intervals in words.
    intervals: String,
    warnings: Vec<String>,
}

impl FragilityCommand {
    /// Refuses options without an effect, and several measures where one is expected.
    fn check(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        explicit.refuse_unless(self.picture.plot.is_some(), &["plot-format"], "without --plot")?;
        explicit.refuse_unless(self.export.is_some(), &["id", "alpha", "p", "g"], "without --export")?;
        self.fit.check(explicit)?;
        let count = self.im.len();
        for option in ["plot", "surface", "ida", "export"].into_iter().filter(|option| explicit.has(option)) {
            anyhow::ensure!(count == 1, "--{option} with {count} measures; expected one --im");
        }
        Ok(())
    }

    /// Fits the curve of a measure, and makes its picture and its export where they are asked for.
    fn assess(
        &self,
        data: &CurveData,
        measure: &str,
        is_drawn: bool,
        explicit: &ExplicitOptions,
    ) -> anyhow::Result<MeasureResults> {
        let &CurveData { name, table, cases, limit, ref blocks } = data;
        let FitOptions { link, ci, .. } = self.fit;
        let heading = &table.heading(measure)?;
        let at = || format!("{name}: {measure}");
        let (values, uncertainty) = (data.column(measure)?, self.fit.uncertainty());
        let assessment = Assessment::new(cases, &values, link, ci, uncertainty).with_context(at)?;
        let mut warnings = assessment.warnings(heading);
        let p_value = |other: &String| {
            let found = sufficiency_of_cases(cases, &values, &data.column(other)?, link);
            Ok((other.clone(), found.with_context(|| format!("{name}: {measure} beside {other}"))?))
        };
        let sufficiency = self.beside.iter().map(p_value).collect::<anyhow::Result<BTreeMap<_, _>>>()?;
        let (mut surface, mut svg, mut exported) = (None, None, Vec::new());
        if let Some(other) = &self.surface {
            let found = Surface::new(cases, &values, &data.column(other)?, link);
            let found = found.with_context(|| format!("{name}: {measure} and {other}"))?;
            let headings = [heading, &*table.heading(other)?];
            if is_drawn {
                svg = Some(charts::surface(blocks, &found.data, &found.fit, headings, limit)?);
            }
            surface = Some(SurfaceReport::of(headings, &found));
        } else if is_drawn {
            svg = Some(charts::curve(blocks, &assessment, heading, limit, ci)?);
        }
        if let Some(program) = self.export {
            let component = self.component(table, heading, limit, &assessment, explicit).with_context(at)?;
            warnings.extend(component.crossings());
            exported = match program {
                LossProgram::Pelicun => pelicun(&[component], self.block.g)?.to_vec(),
                LossProgram::OpenQuake => vec![openquake(&[component], self.block.g)?],
            };
        }
        let report = MeasureReport::of(heading, &assessment, sufficiency);
        let intervals = uncertainty.words(assessment.independence);
        Ok(MeasureResults { report, surface, svg, exported, intervals, warnings })
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

    /// Returns the curve of the measure with this heading, and those of the further limits, as a component of the export.
    fn component(
        &self,
        table: &SweepTable,
        heading: &str,
        limit: Limit,
        found: &Assessment,
        explicit: &ExplicitOptions,
    ) -> anyhow::Result<Component> {
        let measure: Measure = split_heading(heading).0.parse().map_err(anyhow::Error::msg)?;
        let (base, factor) = self.block.base(measure, explicit)?;
        let numbers = table.numbers(heading)?;
        let further = |&limit: &Limit| {
            let cases = table.cases(limit)?.cases;
            let values: Vec<Option<f64>> = cases.iter().map(|case| numbers[case.row]).collect();
            let found = Assessment::new(&cases, &values, self.fit.link, self.fit.ci, Uncertainty::Profile);
            Ok((limit, found.with_context(|| limit.to_string())?.fit))
        };
        let further = self.export_limit.iter().map(further).collect::<anyhow::Result<Vec<_>>>()?;
        let curves = || std::iter::once((limit, &found.fit)).chain(further.iter().map(|(limit, fit)| (*limit, fit)));
        let limits: Vec<String> = curves().map(|(limit, _)| limit.to_string()).collect();
        let file = table.file().rsplit(['/', '\\']).next().unwrap_or_default();
        let description = format!(
            "{} over {heading} in {} rows of {file}, by rocking-block {}",
            limits.join(", "),
            found.data.observations().len(),
            env!("CARGO_PKG_VERSION")
        );
        Ok(Component::new(&self.id, base, factor, curves(), &description)?)
    }
}
