//! `rocking ida`: a study file → incremental dynamic analysis. It has a table of runs, fractiles and a picture.

use clap::Parser;
use serde_json::json;

use crate::commands::sweep::{SweepOptions, model};
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::is_standard_output;
use crate::output::summary::{Object, Summary};
use rocking_charts::fragility as charts;
use rocking_charts::numerals::significant;
use rocking_studies::fragility::{Ida, IdaCurve, Response, SweepTable};
use rocking_studies::intensity::Measure;
use rocking_studies::output::table::Table;
use rocking_studies::statistics::range;
use rocking_studies::sweep::file::Checks;
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
pub fn run(options: &IdaCommand) -> anyhow::Result<()> {
    let IdaCommand { sweep: options, picture } = options;
    let plot = picture.plot.as_deref();
    let format = picture.format()?;
    let csv = options.study.csv();
    check_table(csv)?;
    let sweep = options.read(&NamedFile::of_options([("csv", Some(csv)), ("plot", plot)]), Checks::All)?;
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
    warn(&sweep.remarks);
    let mut outputs = Outputs::open([("plot", plot)])?;
    let mut table = Table::default();
    let mut scales = sweep.hunted_scales();
    let mut follow = |rows| {
        if let Some(scales) = &mut scales {
            scales.take(&rows);
        }
        table.append(rows);
        Ok(())
    };
    let summary = options.study.run(&sweep, Some(&mut follow), true)?;
    let name = if is_standard_output(csv) { "the table".into() } else { csv.display().to_string() };
    let table = SweepTable::new(&name, table);
    let ida = Ida::read(&table, &measure.to_string())?;
    let found = scales.map(|scales| scales.doubts()).unwrap_or_default();
    warn(&found);
    let remarks = [sweep.remarks.as_slice(), &found].concat();
    outputs
        .fill("plot", || Ok(format.encode(&charts::ida(&charts::Blocks::of(&table), &ida, &measure.heading())?)?))?;
    outputs.write()?;
    options.study.report("ida", (csv, &summary), items(model(&sweep), &ida, measure), &[("plot", plot)], &remarks)
}

/// The curves of an analysis in numbers, after the items of the study.
fn items(mut summary: Summary, ida: &Ida, measure: Measure) -> Summary {
    let capacity = |(number, curve): (usize, &IdaCurve)| {
        // The least level that overturns, and the greatest below that does not.
        let found = curve.overturning();
        let greatest = curve.levels.last().copied().unwrap_or_default();
        Object::default()
            .with("curve", &curve.name)
            .with("stands", found.map_or(greatest, |[below, _]| below))
            .with("overturns", found.map(|[_, least]| least))
            // The least level at which a tie or damper breaks, null if none does.
            .with_some("breaks", ida.breaks.as_ref().map(|breaks| breaks[number]))
    };
    let capacities: Vec<Object> = ida.curves.iter().enumerate().map(capacity).collect();
    let overturning = ida.curves.iter().filter(|curve| curve.overturning().is_some()).count();
    summary.entry("im", measure.to_string());
    summary.entry("unit", measure.unit());
    let curves = ida.curves.len();
    summary.item("curves", curves, "curves", format!("{curves}, {overturning} overturning"));
    summary.entry("overturning", overturning);
    let unit = if measure.unit() == "1" { String::new() } else { format!(", {}", measure.unit()) };
    add_fractiles(&mut summary, ida, &format!("{measure}{unit}"));
    if let Some(breaks) = &ida.breaks {
        let levels: Vec<f64> = breaks.iter().flatten().copied().collect();
        let text = range(levels.iter().copied()).map(|[least, greatest]| {
            let span = between([least, greatest], |level| significant(level, 4));
            format!("first at {span}{}, in {} of {curves} curves", suffix(measure), levels.len())
        });
        summary.line("breaks", text.unwrap_or_else(|| "no tie or damper at any level".into()));
    }
    summary.entry("capacities", capacities);
    summary
}

/// The unit behind a number of a measure.
fn suffix(measure: Measure) -> String {
    if measure.unit() == "1" { String::new() } else { format!(" {}", measure.unit()) }
}

/// Writes the least and the greatest value of a fractile.
fn between([low, high]: [f64; 2], write: fn(f64) -> String) -> String {
    match high {
        _ if low == high => write(low),
        f64::INFINITY => format!("above {}", write(low)),
        _ => format!("{} to {}", write(low), write(high)),
    }
}

/// Adds the fractiles of the peak |θ|/α over the curves at all levels, and the levels from which they overturn. The measure has this
/// heading.
fn add_fractiles(summary: &mut Summary, ida: &Ida, heading: &str) {
    /// Levels shown, evenly among all.
    const SHOWN: usize = 6;
    let fractiles = FRACTILES.map(|fraction| ida.fractile(fraction));
    let peaks = |i: usize| fractiles.each_ref().map(|fractile| fractile[i]);
    let line = |first: &str, [a, b, c]: [&str; 3]| format!("{first:>12} {a:>14} {b:>14} {c:>14}");
    summary.line("fractiles", format!("peak {} that 16, 50 and 84 % of the curves do not exceed", ida.rotation));
    summary.line("", line(heading, ["16 %", "50 %", "84 %"]));
    let step = ida.levels.len().div_ceil(SHOWN).max(1);
    for (i, level) in ida.levels.iter().enumerate().skip(step - 1).step_by(step) {
        let shown = peaks(i).map(|peak| match peak {
            Response::Stands(peak) => significant(peak, 3),
            Response::Overturns => "overturned".into(),
            Response::Unknown => "unknown".into(),
        });
        summary.line("", line(&significant(*level, 4), shown.each_ref().map(String::as_str)));
    }
    let overturns = FRACTILES.map(|fraction| (fraction, ida.fractile_overturns(fraction)));
    let shown = overturns.map(|(_, level)| between(level, |level| significant(level, 4)));
    summary.line("", line("overturns at", shown.each_ref().map(String::as_str)));
    let overturns = overturns.map(|(fraction, [low, high])| {
        let known = Some(low).filter(|low| *low == high);
        let range = [Some(low), Some(high).filter(|high| high.is_finite())];
        Object::default().with("fraction", fraction).with("overturns", known).with("range", range)
    });
    summary.entry("fractiles_overturn", overturns);
    let peak = |response: Response| match response {
        Response::Stands(peak) => json!(peak),
        Response::Overturns => "overturned".into(),
        Response::Unknown => "unknown".into(),
    };
    let at = |(i, level): (usize, &f64)| Object::default().with("level", level).with("peaks", peaks(i).map(peak));
    summary.entry("fractiles", ida.levels.iter().enumerate().map(at).collect::<Vec<_>>());
}
