//! Results → drawings.

use crate::numbers::{limit, quantity};
use crate::{ReportError, range};
use rocking_charts::directions::directions;
use rocking_charts::fragility::{curve, ida, probability_of, states};
use rocking_charts::picture::PictureError;
use rocking_charts::record_spectra;
use rocking_charts::sketch::{Sketch, SketchInSpace};
use rocking_charts::spectrum::{Abscissa, Curves, spectrum};
use rocking_charts::tornado::{Bar, tornado};
use rocking_studies::assess::{CurveResult, ObjectInSpace, Plan, Results};
use rocking_studies::fragility::{Ida, Limit};
use rocking_studies::spectrum::statistics::BlockOutcome;
use rocking_studies::sweep::strength::Strengths;

/// A drawing, with the name of its file.
pub struct Picture {
    pub name: &'static str,
    pub svg: String,
}

/// Draws everything that the results allow.
pub fn pictures(plan: &Plan, results: &Results) -> Result<Vec<Picture>, ReportError> {
    let report = &results.report;
    let heading = report.im.as_str();
    let blocks = rocking_charts::fragility::Blocks::of(&results.table);
    let mut pictures = Vec::new();
    let mut add = |name: &'static str, svg: String| pictures.push(Picture { name, svg });
    match (plan.object.in_plane(), plan.object.in_space()) {
        (Some(block), _) => add("sketch", Sketch { block: *block, height: plan.height }.svg()?),
        (None, Some(ObjectInSpace { parameters, body })) => {
            add("sketch", SketchInSpace { parameters, body, height: plan.height }.svg()?);
        }
        (None, None) => (),
    }
    if let Some(sizes) = &results.sizes {
        let title = format!("Blocks of this shape in other sizes, ground motions scaled to {}", sizes.strength);
        let mut curves = Curves::new(&sizes.spectrum, Abscissa::TwoPiOverP);
        curves.add(&sizes.spectrum, &BlockOutcome::all(&sizes.table).map_err(PictureError::Drawing)?);
        add(
            "spectrum",
            match sizes.statistics.groups.is_empty() {
                true => spectrum(&sizes.spectrum, &curves, &title)?,
                false => record_spectra::spectrum(&sizes.spectrum, &sizes.statistics, &curves, &title)?,
            },
        );
    }
    if !report.directions.is_empty() {
        let state = plan.states[report.compared_state].limit;
        add("directions", directions("Outcomes by the direction of the ground motion", &report.directions, state)?);
    }
    if let Strengths::Levels(measure, _) = &plan.sweep.strengths {
        let levels = measure.to_string();
        add("ida", ida(&blocks, &Ida::read(&results.table, &levels)?, &measure.heading())?);
    }
    let named = report.states.iter().zip(&results.states);
    let fitted: Vec<_> = named
        .filter_map(|(state, curve)| {
            // A state may be named after its limit.
            let name = match state.limit {
                Limit::Overturned => state.name.clone(),
                other => format!("{}: {}", state.name, limit(other)),
            };
            Some((name, curve.assessment.as_ref().ok()?))
        })
        .collect();
    if !fitted.is_empty() {
        add("states", states("Fragility curves of all states", &fitted, heading)?);
    }
    let state = plan.states[report.compared_state].limit;
    if let Ok(assessment) = &results.states[report.compared_state].assessment {
        add("fragility", curve(&blocks, assessment, heading, state, report.confidence)?);
        if let (Some(rate), Some(result)) = (&results.states[report.compared_state].rate, &report.hazard) {
            let lines = [format!("annual rate from {}", result.file)];
            let band = |at: &[f64]| Some(assessment.band(at));
            add("rate", rocking_charts::rate::rate(&lines, rate, heading, &probability_of(state), band)?);
        }
    }
    let [least, greatest] = range(results);
    let inside = |curve: CurveResult| Some(curve.median).filter(|median| (least..=greatest).contains(median));
    if let Some(middle) = report.variants[0].curve.and_then(inside)
        && !report.sensitivity.is_empty()
    {
        let bar = |sensitivity: &rocking_studies::assess::Sensitivity| Bar {
            name: quantity(&sensitivity.assumption.name),
            values: sensitivity.assumption.values,
            results: sensitivity.ends.each_ref().map(|end| end.curve.and_then(inside)),
        };
        let bars: Vec<Bar> = report.sensitivity.iter().map(bar).collect();
        let title = format!("Median for {} at both ends of each range", limit(state));
        add("sensitivity", tornado(&title, &format!("median {heading}"), middle, &bars)?);
    }
    Ok(pictures)
}
