//! `rocking fit`: a study file with tests of a block → estimates with their intervals.

use std::path::{Path, PathBuf};

use clap::Parser;

use crate::options::input;
use crate::options::run::ThreadOptions;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::progress::Progress;
use crate::output::report::ReportOptions;
use rocking_charts::numerals::{ends, readable};
use rocking_studies::fit::{Estimate, Fit, TestFit, file, fit};
use rocking_studies::input::study_file::StudyFileError;
use rocking_studies::output::table::{Table, TableColumn};

/// Options of `rocking fit`.
#[derive(Parser)]
pub struct FitCommand {
    /// Study file in TOML with [fit] and [[tests]], as examples/fit/release.toml; `-` for standard input
    #[arg(value_name = "STUDY.toml")]
    file: PathBuf,
    /// Table of the estimates; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    /// Table of measured and fitted values over time; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    residuals: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &FitCommand) -> anyhow::Result<()> {
    let FitCommand { file: study, csv, residuals, picture, threads, report } = options;
    [csv, residuals].into_iter().flatten().try_for_each(|path| check_table(path))?;
    let format = picture.format()?;
    let (name, text) = input::text(study)?;
    let folder = study.parent().unwrap_or(Path::new(""));
    let (problem, files) =
        file::read(&name, &text, folder).map_err(|error| StudyFileError { file: name.clone(), ..error })?;
    let outputs = [("csv", csv.as_deref()), ("residuals", residuals.as_deref()), ("plot", picture.plot.as_deref())];
    let read = files.iter().map(|file| NamedFile::new("the input", &folder.join(file)));
    let inputs: Vec<_> = std::iter::once(NamedFile::new("the study", study)).chain(read).collect();
    let mut outputs = Outputs::checked(&inputs, outputs)?;

    let bar = Progress::new(0, 0);
    let found = fit(&problem, &threads.pool()?, &|done, all| bar.show_of(done, all));
    let found = found.map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    bar.clear();
    outputs.fill_table("csv", || Ok(table(&found)))?;
    outputs.fill_table("residuals", || Ok(residual_table(&found)))?;
    outputs.fill("plot", || {
        let title = study.file_stem().map_or(name, |stem| stem.to_string_lossy().into_owned());
        Ok(format.encode(&rocking_charts::fit::fit(&found, &format!("fit to {title}"))?)?)
    })?;
    let written = outputs.write()?;
    report.print("fit", &written, &found.notes, &(summary(&found) + &written.lines()), &found)
}

/// Returns the table of the estimates.
fn table(fit: &Fit) -> Table {
    fn number<'c>(name: &str, of: impl Fn(&Estimate) -> Option<f64> + Sync + 'c) -> TableColumn<'c, Estimate> {
        TableColumn::optional(name, "1", of).with_unit(None)
    }
    let end = |end: usize| move |estimate: &Estimate| estimate.interval?[end];
    let columns = [
        TableColumn::text("parameter", |estimate: &Estimate| estimate.name.clone()),
        TableColumn::text("unit", |estimate: &Estimate| estimate.unit.clone()),
        number("value", |estimate| Some(estimate.value)),
        number("standard_error", |estimate| Some(estimate.standard_error)),
        number("low", end(0)),
        number("high", end(1)),
        number("quadratic_low", |estimate| Some(estimate.quadratic_interval[0])),
        number("quadratic_high", |estimate| Some(estimate.quadratic_interval[1])),
        TableColumn::boolean("at_bound", |estimate: &Estimate| estimate.at_bound.is_some()),
    ];
    Table::of(&columns, &fit.estimates)
}

/// Returns the table of measured and fitted values, in the units of the measured quantities.
fn residual_table(fit: &Fit) -> Table {
    let numbers = |(number, test): (usize, &TestFit)| (0..test.times.len()).map(move |i| (number, i));
    let rows: Vec<(usize, usize)> = fit.tests.iter().enumerate().flat_map(numbers).collect();
    fn value<'c>(
        name: &str,
        fit: &'c Fit,
        of: impl Fn(&TestFit) -> &[f64] + Sync + 'c,
    ) -> TableColumn<'c, (usize, usize)> {
        TableColumn::real(name, "s", move |(test, i): &(usize, usize)| of(&fit.tests[*test])[*i])
    }
    let columns = [
        TableColumn::count("test", |(test, _): &(usize, usize)| test + 1).with_unit(None),
        value("t", fit, |test| &test.times),
        value("measured", fit, |test| &test.measured).with_unit(None),
        value("fitted", fit, |test| &test.fitted).with_unit(None),
        value("residual", fit, |test| &test.residuals).with_unit(None),
    ];
    Table::of(&columns, &rows)
}

/// Writes the summary as text.
fn summary(fit: &Fit) -> String {
    let mut text = String::new();
    let longest = fit.estimates.iter().map(|estimate| estimate.name.len()).max().unwrap_or(0);
    let width = longest.max(13);
    let mut line = |name: &str, value: String| text.push_str(&format!("{name:width$} {value}\n"));
    let percent = 100.0 * fit.level;
    for Estimate { name, unit, value, standard_error, interval, quadratic_interval, .. } in &fit.estimates {
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        let shown = |value: f64| readable(value, 5);
        let interval = match interval {
            Some([Some(low), Some(high)]) => format!("{percent} %: {}", ends([*low, *high], 5, readable).join(" to ")),
            Some(ends) => {
                format!("{percent} %: {}", ends.map(|end| end.map_or("the bound".into(), shown)).join(" to "))
            }
            None => format!("{percent} %, quadratic: {}", ends(*quadratic_interval, 5, readable).join(" to ")),
        };
        line(name, format!("{} ± {}{unit}; {interval}", shown(*value), readable(*standard_error, 2)));
    }
    for (number, test) in (1..).zip(&fit.tests) {
        let TestFit { output, unit, times, rms, durbin_watson, autocorrelation, .. } = test;
        line(
            &format!("test_{number}"),
            format!(
                "{output}, {} values; residuals {} {unit} (root mean square), Durbin–Watson {durbin_watson:.2}, autocorrelation \
                 {autocorrelation:.2}",
                times.len(),
                readable(*rms, 3)
            ),
        );
    }
    if let Some(reduced) = fit.reduced_chi_squared {
        line("chi-squared", format!("{reduced:.3} per degree of freedom"));
    }
    if let (Some(noise), Some(test)) = (fit.noise, fit.tests.first()) {
        line("noise", format!("{} {} by the residuals", readable(noise, 3), test.unit));
    }
    if let Some(least) = fit.combinations.iter().rfind(|combination| combination.is_determined) {
        line("weakest", least.meaning.clone());
    }
    line("runs", format!("{}, and {} with derivatives", fit.runs[0], fit.runs[1]));
    for note in &fit.notes {
        line("note", note.clone());
    }
    text
}
