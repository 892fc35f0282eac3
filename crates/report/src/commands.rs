//! A plan → the commands that give the same numbers.

use rocking_block::block::{Block, Body, Common, Foundation};
use rocking_studies::assess::{Hazard, Plan, Results};
use rocking_studies::risk::HazardOptions;
use rocking_studies::spec::words::Words;

/// Returns a line for each command.
pub fn commands(plan: &Plan, results: &Results) -> Vec<String> {
    let report = &results.report;
    let (im, study) = (plan.measure.to_string(), &plan.file);
    let limit = &report.states[report.compared_state].limit;
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
        let HazardOptions { unit, site, years, gravity, .. } = options;
        let years = years.map(|years| years.to_string());
        let gravity = (*gravity != Common::default().gravity).then(|| gravity.to_string());
        for (option, value) in [("hazard-unit", unit), ("site", site), ("investigation-time", &years), ("g", &gravity)]
        {
            rate.extend(value.iter().map(|value| format!(" --{option}={}", quoted(value))));
        }
        commands.push(rate);
    }
    commands.extend(pulses(plan));
    commands
}

/// Returns the search of the first pulse, if α, p and the foundation describe the block.
fn pulses(plan: &Plan) -> Option<String> {
    let Block { alpha, gamma, epsilon, restitution_factor, body: Body { p, gravity, xi_v, .. }, .. } = plan.block;
    // No command passes a pulse through a building.
    if plan.block.is_extended() || plan.sweep.has_building() {
        return None;
    }
    let base = match plan.block.foundation {
        Foundation::Rigid => format!("--foundation rigid --restitution-factor {restitution_factor}"),
        Foundation::Viscoelastic => format!("--eta {} --xi-v {xi_v}", plan.block.eta()),
    };
    Some(format!(
        "rocking search overturning --pulse {} --period {} --alpha {alpha} --p {p} --gamma {gamma} --g {gravity} \
         --epsilon {epsilon} {base} --tolerance {}",
        plan.pulse.word(),
        plan.pulse_periods[0],
        plan.sweep.tolerance
    ))
}

/// Quotes a word of a command line if a shell requires it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/,:".contains(c);
    if word.chars().all(plain) && !word.is_empty() { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}
