//! A plan → the commands that give the same numbers.

use rocking_block::block::{Block, Foundation};
use rocking_block::words::Words;
use rocking_studies::assess::{Plan, Results};

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
    if let Some(hazard) = &report.hazard {
        let file = quoted(&hazard.file);
        commands.push(format!(
            "rocking rate {file} --table runs.csv --im {} --limit {} --years {}",
            quoted(&im),
            quoted(limit),
            report.years
        ));
    }
    commands.extend(pulses(plan));
    commands
}

/// Returns the search of the first pulse, if α, p and the foundation describe the block.
fn pulses(plan: &Plan) -> Option<String> {
    let Block { alpha, p, gamma, gravity, epsilon, restitution_factor, xi_v, .. } = plan.block;
    if plan.block.is_extended() {
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
    let plain = |c: char| c.is_alphanumeric() || "._-/".contains(c);
    if word.chars().all(plain) { word.into() } else { format!("\"{word}\"") }
}
