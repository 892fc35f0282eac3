//! Parameters named by `--gradients` → the derivatives of a run in its summary.

use crate::output::summary::{Object, Summary};
use rocking_gradients::{Grazing, Parameters, unit};
use rocking_studies::run::gradients::{Derivatives, Gradients};

/// Refuses a parameter that this run does not read.
pub fn check(parameters: &Parameters, names: &[String]) -> anyhow::Result<()> {
    let known = parameters.names();
    for (i, name) in names.iter().enumerate() {
        anyhow::ensure!(
            known.contains(name),
            "gradients: {name} is no real parameter of this run; expected one of {}",
            known.join(", ")
        );
        anyhow::ensure!(!names[..i].contains(name), "gradients: {name} is given twice; expected it once");
    }
    Ok(())
}

/// Adds the derivatives for each parameter, and the event from which on there are none.
pub fn add_entries(summary: &mut Summary, gradients: &Gradients) {
    let of = |Derivatives { name, events, peaks, .. }: &Derivatives| {
        let peak = Object::from([
            ("theta", peaks.theta),
            ("uplift", peaks.uplift),
            ("N", peaks.reaction),
            ("H", peaks.horizontal),
            ("friction_demand", peaks.friction_demand),
            ("slip", peaks.slip),
        ]);
        // Times are null where an event grazes, and after it.
        Object::from([("parameter", name.as_str()), ("unit", unit(name))])
            .with("peak", peak)
            .with("event_times", events)
    };
    if !gradients.parameters.is_empty() {
        summary.entry("gradients", gradients.parameters.iter().map(of).collect::<Vec<_>>());
    }
    if let Some(grazing) = &gradients.grazing {
        let (event, corner) = kind(grazing);
        summary.entry("grazing", Object::default().with("t", grazing.time).with("event", event).with("corner", corner));
    }
}

/// Adds a line for each parameter.
pub fn add_lines(summary: &mut Summary, gradients: &Gradients) {
    for Derivatives { name, peaks, .. } in &gradients.parameters {
        let per = match unit(name) {
            "1" => String::new(),
            unit => format!(" per {unit}"),
        };
        let text = format!(
            "peak |θ| {:.6e} rad, uplift {:.6e} m, N {:.6e} N, |H| {:.6e} N{per}",
            peaks.theta, peaks.uplift, peaks.reaction, peaks.horizontal
        );
        summary.line(&format!("d/d({name})"), text);
    }
    if let Some(grazing) = &gradients.grazing {
        let (event, corner) = kind(grazing);
        let corner = corner.map_or(String::new(), |corner| format!(" of {corner}"));
        let time = grazing.time;
        summary.line("grazing", format!("{event}{corner} at t = {time:.9} s: from there on there are no derivatives"));
    }
}

/// The event that grazes, and its corner.
fn kind(grazing: &Grazing) -> (&'static str, Option<&'static str>) {
    grazing.kind.map_or(("held", None), |kind| (kind.word(), kind.location()))
}
