//! `rocking ida`: a study file → incremental dynamic analysis: the table of its runs, fractiles and a picture.

use std::fmt::Write;

use clap::Parser;
use serde::Serialize;

use crate::commands::sweep::SweepOptions;
use crate::options::explicit::ExplicitOptions;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Pending};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::is_standard_output;
use rocking_charts::fragility as charts;
use rocking_charts::numerals::significant;
use rocking_studies::fragility::{Ida, Response, SweepTable};
use rocking_studies::intensity::Measure;
use rocking_studies::output::table::Table;
use rocking_studies::sweep::strength::Strengths;

/// Options of `rocking ida`.
#[derive(Parser)]
pub struct IdaCommand {
    #[command(flatten)]
    sweep: SweepOptions,
    #[command(flatten)]
    picture: PictureOptions,
}

/// The fractiles of a summary, as parts of the curves.
const FRACTILES: [f64; 3] = [0.16, 0.5, 0.84];

/// Runs the command.
pub fn run(options: &IdaCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let IdaCommand { sweep: options, picture } = options;
    explicit.refuse_unless(picture.plot.is_some(), &["plot-format"], "without --plot")?;
    let plot = picture.plot.as_deref();
    let format = picture.format()?;
    let csv = options.study.csv();
    check_table(csv)?;
    let sweep = options.read(&NamedFile::of_options([("csv", Some(csv)), ("plot", plot)]))?;
    let measure = match &sweep.strengths {
        Strengths::Levels(measure, _) | Strengths::Hunt(measure, _) => *measure,
        Strengths::Scales(_) | Strengths::Least(..) => anyhow::bail!(
            "{}: has no levels of an intensity measure; expected levels = {{ im = \"PGV\", values = [0.2, 0.4] }} or \
             hunt = {{ im = \"PGV\", first = 0.1 }} in [study]",
            options.file.display()
        ),
    };
    anyhow::ensure!(
        sweep.ensemble.is_none(),
        "{}: has an ensemble, whose runs belong to no curve; expected none",
        options.file.display()
    );
    warn(sweep.remarks.iter().cloned());
    let file = plot.map(Pending::new).transpose()?;
    let mut table = Table::default();
    let mut follow = |rows| {
        table.append(rows);
        Ok(())
    };
    let summary = options.study.run(&sweep, Some(&mut follow))?;
    let name = if is_standard_output(csv) { "the table".into() } else { csv.display().to_string() };
    let table = SweepTable::new(&name, table);
    let ida = Ida::read(&table, &measure.to_string())?;
    if let (Some(file), Some(format)) = (file, format) {
        let svg = charts::ida(&charts::Blocks::of(&table), &ida, &measure.heading())?;
        Pending::write(vec![(file, format.encode(&svg)?)])?;
    }
    let result = IdaResult::of(&ida, measure);
    options.study.report("ida", (csv, &summary), (&result.text(), &result), &[("plot", plot)], &sweep.remarks)
}

/// The curves of an analysis in numbers.
#[derive(Serialize)]
struct IdaResult {
    im: String,
    unit: &'static str,
    curves: usize,
    /// Curves that overturn.
    overturning: usize,
    /// Fractiles of the least level that overturns; `None` where fewer curves do.
    overturning_fractiles: [Fractile; 3],
    /// Fractiles of the peak |θ|/α at levels.
    fractiles: Vec<AtLevel>,
    /// The least level that overturns, and the greatest below that does not, of each curve.
    capacities: Vec<Capacity>,
}

#[derive(Serialize)]
struct Fractile {
    fraction: f64,
    level: Option<f64>,
}

#[derive(Serialize)]
struct AtLevel {
    level: f64,
    /// Peaks by [`FRACTILES`].
    peaks: [Peak; 3],
}

#[derive(Serialize)]
#[serde(untagged)]
enum Peak {
    Stands(f64),
    Word(&'static str),
}

#[derive(Serialize)]
struct Capacity {
    curve: String,
    stands: f64,
    overturns: Option<f64>,
}

impl IdaResult {
    fn of(ida: &Ida, measure: Measure) -> IdaResult {
        let fractiles = FRACTILES.map(|fraction| ida.fractile(fraction));
        let peak = |response: Response| match response {
            Response::Stands(peak) => Peak::Stands(peak),
            Response::Overturns => Peak::Word("overturned"),
            Response::Unknown => Peak::Word("unknown"),
        };
        let at = |(i, &level): (usize, &f64)| AtLevel {
            level,
            peaks: [0, 1, 2].map(|part: usize| peak(fractiles[part][i])),
        };
        let capacities = ida.curves.iter().map(|curve| {
            let found = curve.overturning();
            let greatest = curve.levels.last().copied().unwrap_or_default();
            Capacity {
                curve: curve.name.split_whitespace().collect::<Vec<_>>().join(" "),
                stands: found.map_or(greatest, |[below, _]| below),
                overturns: found.map(|[_, least]| least),
            }
        });
        let capacities: Vec<Capacity> = capacities.collect();
        IdaResult {
            im: measure.to_string(),
            unit: measure.unit(),
            curves: ida.curves.len(),
            overturning: capacities.iter().filter(|capacity| capacity.overturns.is_some()).count(),
            overturning_fractiles: FRACTILES.map(|fraction| Fractile { fraction, level: ida.overturning(fraction) }),
            fractiles: ida.levels.iter().enumerate().map(at).collect(),
            capacities,
        }
    }

    fn text(&self) -> String {
        /// Levels shown, evenly among all.
        const SHOWN: usize = 6;
        let IdaResult { im, unit, curves, overturning, overturning_fractiles, fractiles, .. } = self;
        let unit = if *unit == "1" { String::new() } else { format!(" {unit}") };
        let levels = overturning_fractiles.iter().map(|Fractile { fraction, level }| {
            let level = level.map_or("none".into(), |level| format!("{}{unit}", significant(level, 4)));
            format!("{} % {level}", significant(100.0 * fraction, 2))
        });
        let mut text = format!("curves        {curves}, {overturning} overturning\n");
        let levels = levels.collect::<Vec<_>>().join(", ");
        // Writing to a String never fails.
        let _ = writeln!(text, "overturning   by {im}: {levels}");
        let _ = writeln!(
            text,
            "peak |θ|/α    {:>12} {:>10} {:>10} {:>10}",
            format!("{im}{}", unit.replace(' ', ", ")),
            "16 %",
            "50 %",
            "84 %"
        );
        let step = fractiles.len().div_ceil(SHOWN).max(1);
        for AtLevel { level, peaks } in fractiles.iter().skip(step - 1).step_by(step) {
            let shown = peaks.each_ref().map(|peak| match peak {
                Peak::Stands(peak) => significant(*peak, 3),
                Peak::Word(word) => (*word).into(),
            });
            let _ = writeln!(
                text,
                "{:14}{:>12} {:>10} {:>10} {:>10}",
                "",
                significant(*level, 4),
                shown[0],
                shown[1],
                shown[2]
            );
        }
        text
    }
}
