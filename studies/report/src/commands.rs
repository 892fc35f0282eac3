//! A plan → the commands that give the same numbers.

use rocking_block::block::Common;
use rocking_studies::assess::{Hazard, Plan, Results};
use rocking_studies::risk::HazardOptions;
use rocking_studies::spec::BlockSpec;
use rocking_studies::spec::command::CommandLine;
use rocking_studies::spec::words::Words;

/// Returns a line for each command.
pub fn commands(plan: &Plan, results: &Results) -> Vec<String> {
    let report = &results.report;
    let (im, study) = (plan.measure.to_string(), &plan.file);
    let limit = &report.states[report.compared_state].limit.to_string();
    let mut commands = vec![
        format!("rocking assess {} --out report", quoted(study)),
        format!("rocking sweep {} --csv runs.csv", quoted(study)),
        format!("rocking fragility runs.csv --im {} --limit {}", quoted(&im), quoted(limit)),
    ];
    if let Some(Hazard { file, options, .. }) = &plan.hazard {
        let mut rate = format!(
            "rocking rate {} --table runs.csv --im {} --limit {} --years {}",
            quoted(file),
            quoted(&im),
            quoted(limit),
            report.years
        );
        let HazardOptions { unit, site, years, kind, gravity, .. } = options;
        let years = years.map(|years| years.to_string());
        let gravity = (*gravity != Common::default().gravity).then(|| gravity.to_string());
        for (option, value) in
            [("hazard-unit", unit), ("site", site), ("investigation-time", &years), ("kind", kind), ("g", &gravity)]
        {
            rate.extend(value.iter().map(|value| format!(" --{option}={}", quoted(value))));
        }
        commands.push(rate);
    }
    commands.extend(pulses(plan));
    commands.into_iter().map(|command| folded(&command)).collect()
}

/// Continues a long command on further lines, each from an option on, as a shell reads it: the page is too narrow for all.
fn folded(command: &str) -> String {
    const WIDTH: usize = 100;
    let mut text = String::new();
    let mut width = 0;
    for (number, part) in command.split(" --").enumerate() {
        // Quoted words stay whole.
        let is_option = number > 0 && text.matches('\'').count().is_multiple_of(2);
        let length = part.chars().count() + " --".len();
        match (number, is_option && width + length > WIDTH) {
            (0, _) => width = length,
            (_, true) => {
                text += " \\\n    --";
                width = "    --".len() + length;
            }
            (_, false) => {
                text += " --";
                width += length;
            }
        }
        text += part;
    }
    text
}

/// Returns the search of the first pulse, if α, p and the foundation describe the block.
fn pulses(plan: &Plan) -> Option<String> {
    // No command passes a pulse through a building.
    let is_described = plan.object.in_plane().is_none_or(|block| !block.tracks_foot());
    if !is_described || plan.sweep.has_building() {
        return None;
    }
    let mut line = CommandLine::new("search overturning");
    line.option("pulse", plan.pulse.word()).option("period", plan.pulse_periods[0]);
    match (plan.object.in_plane(), &plan.values.in_space) {
        (Some(block), _) => line.block(&BlockSpec::of(block)),
        (None, Some(numbers)) => line.block_in_space(&numbers.block, &numbers.space),
        (None, None) => return None,
    };
    Some(line.option("tolerance", plan.sweep.tolerance).text())
}

/// Quotes a word of a command line if a shell requires it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/,:".contains(c);
    if word.chars().all(plain) && !word.is_empty() { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}
