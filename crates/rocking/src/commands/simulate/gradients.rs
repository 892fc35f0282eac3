//! The parameters named by `--gradients` → the derivatives of a run, as text and as JSON.

use serde::Serialize;

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

/// Derivatives with respect to one parameter, in SI units.
#[derive(Serialize)]
pub struct GradientSummary<'a> {
    parameter: &'a str,
    unit: &'static str,
    peak: PeakDerivatives,
    /// Of the times of the events; null where one grazes, and after it.
    event_times: &'a [f64],
}

#[derive(Serialize)]
struct PeakDerivatives {
    theta: f64,
    uplift: f64,
    #[serde(rename = "N")]
    reaction: f64,
    #[serde(rename = "H")]
    horizontal: f64,
    friction_demand: f64,
    slip: f64,
}

/// An event from which on there are no derivatives.
#[derive(Serialize)]
pub struct GrazingSummary {
    t: f64,
    event: &'static str,
    corner: Option<&'static str>,
}

impl GrazingSummary {
    /// Returns the event.
    pub fn of(&Grazing { time, kind }: &Grazing) -> GrazingSummary {
        let (event, corner) = kind.map_or(("held", None), |kind| (kind.word(), kind.location()));
        GrazingSummary { t: time, event, corner }
    }
}

/// Returns the derivatives for each parameter.
pub fn summaries(gradients: &Gradients) -> Vec<GradientSummary<'_>> {
    gradients.parameters.iter().map(summary).collect()
}

fn summary(Derivatives { name, events, peaks, .. }: &Derivatives) -> GradientSummary<'_> {
    GradientSummary {
        parameter: name,
        unit: unit(name),
        peak: PeakDerivatives {
            theta: peaks.theta,
            uplift: peaks.uplift,
            reaction: peaks.reaction,
            horizontal: peaks.horizontal,
            friction_demand: peaks.friction_demand,
            slip: peaks.slip,
        },
        event_times: events,
    }
}

/// Returns the lines of the summary.
pub fn lines(gradients: &Gradients) -> String {
    let mut text = String::new();
    for Derivatives { name, peaks, .. } in &gradients.parameters {
        let per = match unit(name) {
            "1" => String::new(),
            unit => format!(" per {unit}"),
        };
        text += &format!(
            "{:13} peak |θ| {:.6e} rad, uplift {:.6e} m, N {:.6e} N, |H| {:.6e} N{per}\n",
            format!("d/d({name})"),
            peaks.theta,
            peaks.uplift,
            peaks.reaction,
            peaks.horizontal
        );
    }
    if let Some(GrazingSummary { t, event, corner }) = gradients.grazing.as_ref().map(GrazingSummary::of) {
        let corner = corner.map_or(String::new(), |corner| format!(" of {corner}"));
        text += &format!("{:13} {event}{corner} at t = {t:.9} s: from there on there are no derivatives\n", "grazing");
    }
    text
}
