//! A fit → its weaknesses in sentences.

use crate::fit::{Estimate, Fit, TestFit};

/// The note on a fit without intervals.
pub const NO_INTERVALS: &str = "the intervals are unknown: the search for them kept finding better fits, and ended with this one; \
                                expected narrower bounds or more starts";

/// Returns the note on an interval with an end whose search has not settled.
pub fn unsettled(name: &str) -> String {
    format!(
        "the interval of {name} is rough: the search for an end has not settled within its evaluations; compare the quadratic interval"
    )
}

/// Lists the weaknesses of a fit.
pub fn notes(fit: &Fit) -> Vec<String> {
    let mut notes = Vec::new();
    if !fit.is_converged {
        notes.push("the search has not ended at a minimum; expected narrower bounds or more starts".into());
    }
    for Estimate { name, at_bound, bounds: [low, high], .. } in &fit.estimates {
        if let Some(bound) = at_bound {
            notes.push(format!(
                "{name} ends at its bound {bound:.6}, of {low:.6} to {high:.6}: the data favour a value beyond it, or do not determine it"
            ));
        }
    }
    for Estimate { name, interval, .. } in &fit.estimates {
        let sides = match interval {
            Some([None, None]) => "both bounds",
            Some([None, Some(_)]) => "the lower bound",
            Some([Some(_), None]) => "the upper bound",
            _ => continue,
        };
        notes.push(format!("the interval of {name} reaches {sides}: the data do not limit it there"));
    }
    for values in &fit.other_minima {
        let values: Vec<String> = fit
            .estimates
            .iter()
            .zip(values)
            .map(|(estimate, value)| format!("{} = {value:.5}", estimate.name))
            .collect();
        notes
            .push(format!("another minimum fits as well at this level, and intervals cover it: {}", values.join(", ")));
    }
    notes.extend(fit.reduced_chi_squared.and_then(|reduced| misfit(reduced, fit)));
    for (number, test) in (1..).zip(&fit.tests) {
        let name = if fit.tests.len() > 1 { format!("test_{number}: ") } else { String::new() };
        // Residuals far below the noise are errors of the integration.
        let is_measured = fit.reduced_chi_squared.is_none_or(|reduced| reduced > 0.01);
        notes.extend(correlation(test).filter(|_| is_measured).map(|note| format!("{name}{note}")));
        if let Some(time) = test.grazing {
            notes.push(format!(
                "{name}an event grazes at {time:.4} s of the run; later values count in the sum of squares, but have no derivatives"
            ));
        }
        if let Some(time) = test.overturned {
            notes.push(format!("{name}the fitted block has overturned at {time:.4} s of the run"));
        }
    }
    notes.extend(
        fit.combinations
            .iter()
            .filter(|combination| !combination.is_determined)
            .map(|combination| combination.meaning.clone()),
    );
    notes
}

/// Residuals that are far from the noise. They differ by more than three standard deviations of χ², and by a tenth.
fn misfit(reduced: f64, fit: &Fit) -> Option<String> {
    let values: usize = fit.tests.iter().map(|test| test.times.len()).sum();
    let freedom = values.saturating_sub(fit.estimates.len()).max(1) as f64;
    let far = (3.0 * (2.0 / freedom).sqrt()).max(0.21);
    let times = reduced.sqrt();
    if reduced > 1.0 + far {
        Some(format!(
            "the residuals are {times:.3} times the noise: the model does not describe the tests within the noise, and intervals are too narrow"
        ))
    } else if reduced < 1.0 - far {
        Some(format!(
            "the residuals are only {times:.3} times the noise: the noise is less than given, and intervals are too wide"
        ))
    } else {
        None
    }
}

/// Residuals that are not white. Their correlation is beyond three standard deviations of that of white noise.
fn correlation(test: &TestFit) -> Option<String> {
    let correlation = test.autocorrelation;
    if correlation.abs() <= 3.0 / (test.residuals.len() as f64).sqrt() {
        return None;
    }
    let durbin_watson = test.durbin_watson;
    let about = format!(
        "the residuals are correlated, by {correlation:.2} from each to the next (Durbin–Watson {durbin_watson:.2}, white noise 2)"
    );
    Some(match correlation > 0.0 {
        // The variance of a mean of an autoregressive process of first order.
        true => {
            let factor = ((1.0 + correlation) / (1.0 - correlation)).sqrt();
            format!(
                "{about}: the model is in error, or the noise is not white; intervals are too narrow, by a factor of some {factor:.1}"
            )
        }
        false => format!("{about}: the noise is not white, as after a filter; intervals do not hold"),
    })
}
