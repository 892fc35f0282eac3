//! The Jacobian of the data → the determined and the undetermined combinations of parameters.

use serde::Serialize;

use crate::fit::least_squares::Triangle;
use crate::fit::unknowns::Unknown;

/// Standard deviation above which the data do not determine a combination.
const UNDETERMINED: f64 = 0.5;

/// Weights below this one, relative to the largest, are left out of the words.
const SMALL: f64 = 0.15;

/// Largest change of a parameter in the description of an undetermined combination.
const JOINT_CHANGE: f64 = 0.1;

/// A direction of the parameters: a right singular vector of the Jacobian over the noise.
///
/// Coordinates are the logarithms of the parameters, or, for one that may be negative, the parameter over half its range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Combination {
    /// Standard deviation along the direction, by the data alone: the reciprocal of the singular value.
    pub standard_deviation: f64,
    /// Components of the unit vector, in the order of the estimates.
    pub weights: Vec<f64>,
    /// Whether the data determine it.
    pub is_determined: bool,
    /// Its determination by the data, in words.
    pub meaning: String,
}

/// Returns the combinations, the best determined first. `triangle` is that of the data for residuals of this variance.
pub fn combinations(triangle: &Triangle, unknowns: &[Unknown], variance: f64) -> Vec<Combination> {
    let mut r = triangle.r.clone();
    for (mut column, unknown) in r.column_iter_mut().zip(unknowns) {
        column *= unknown.relative();
    }
    let Some(svd) = r.try_svd(false, true, f64::EPSILON, 1000) else { return Vec::new() };
    let Some(v) = svd.v_t else { return Vec::new() };
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|&i, &j| svd.singular_values[j].total_cmp(&svd.singular_values[i]));
    let combination = |i: usize| {
        let row = v.row(i);
        let largest = row.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        // The largest component is positive: the sign of a singular vector is free.
        let weights: Vec<f64> = row.iter().map(|weight| weight * largest.signum()).collect();
        let standard_deviation = variance.sqrt() / svd.singular_values[i].max(f64::MIN_POSITIVE);
        let is_determined = standard_deviation <= UNDETERMINED;
        let meaning = meaning(&weights, unknowns, standard_deviation, is_determined);
        Combination { standard_deviation, weights, is_determined, meaning }
    };
    order.into_iter().map(combination).collect()
}

fn meaning(weights: &[f64], unknowns: &[Unknown], deviation: f64, is_determined: bool) -> String {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let terms: Vec<(String, f64, &Unknown)> = unknowns
        .iter()
        .zip(weights)
        .filter(|(_, weight)| weight.abs() >= SMALL * largest)
        .map(|(unknown, weight)| (unknown.full_name(), weight / largest, unknown))
        .collect();
    let logarithmic = terms.iter().all(|term| term.2.is_logarithmic);
    let product = terms.iter().map(|(name, power, _)| powered(name, *power)).collect::<Vec<_>>().join("·");
    // Lists the joint changes; the largest is `fraction` of the value or of half its range.
    let changes = |fraction: f64| {
        let changes =
            terms.iter().map(|(name, weight, unknown)| format!("{name} by {}", change(unknown, fraction * weight)));
        listed(&changes.collect::<Vec<_>>())
    };
    match (is_determined, &terms[..]) {
        // Along the direction the logarithm of the product changes by 1 over the largest weight.
        (true, _) if logarithmic => format!("the data determine {product} to {:.2} %", 100.0 * deviation / largest),
        (true, [(name, _, unknown)]) => {
            format!("the data determine {name} to {}", change(unknown, deviation / largest).trim_start_matches('+'))
        }
        (true, _) => {
            format!("one standard deviation of the data is a joint change of {}", changes(deviation * largest))
        }
        (false, [(name, ..)]) => format!("the data do not determine {name}"),
        // The product that is constant along the direction.
        (false, [(a, one, _), (b, two, _)]) if logarithmic => {
            let product = match one.abs() > two.abs() {
                true => format!("{}·{b}", powered(a, -two / one)),
                false => format!("{a}·{}", powered(b, -one / two)),
            };
            format!("the data determine {product} at best, but neither {a} nor {b} alone")
        }
        (false, _) => format!("the data do not determine a joint change of {}", changes(JOINT_CHANGE)),
    }
}

/// Formats a change of a coordinate of the Jacobian. It is in per cent, or in the unit of a parameter that may be negative.
fn change(unknown: &Unknown, fraction: f64) -> String {
    if unknown.is_logarithmic {
        return format!("{} %", signed(100.0 * fraction));
    }
    let value = signed(0.5 * (unknown.bounds[1] - unknown.bounds[0]) * fraction);
    if unknown.unit == "1" { value } else { format!("{value} {}", unknown.unit) }
}

/// Formats a number with its sign and two significant digits.
fn signed(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    format!("{rounded:+}")
}

/// Joins words by commas and "and".
fn listed(words: &[String]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => words.join(", "),
    }
}

fn powered(name: &str, power: f64) -> String {
    match format!("{power:.1}").as_str() {
        "1.0" => name.into(),
        power => format!("{name}^{}", power.trim_end_matches(".0")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn logarithmic(name: &str) -> Unknown {
        let bounds = [1.0, std::f64::consts::E];
        Unknown {
            name: name.into(),
            unit: "1".into(),
            test: None,
            start: 1.5,
            bounds,
            is_logarithmic: true,
            prior: None,
        }
    }

    /// Residuals that depend on the product eta·xi_v alone.
    #[test]
    fn a_product_that_the_data_determine_is_named() {
        let r = DMatrix::from_row_slice(2, 2, &[100.0, 100.0, 0.0, 1e-6]);
        let triangle = Triangle { r, projected: DVector::zeros(2) };
        let found = combinations(&triangle, &[logarithmic("eta"), logarithmic("xi_v")], 1.0);
        assert!((found[0].standard_deviation - 1.0 / (100.0 * 2.0_f64.sqrt())).abs() < 1e-9);
        assert_eq!(found[0].meaning, "the data determine eta·xi_v to 1.00 %");
        assert!(found[0].is_determined && !found[1].is_determined);
        let expected = ["eta·xi_v", "xi_v·eta"]
            .map(|product| format!("the data determine {product} at best, but neither eta nor xi_v alone"));
        assert!(expected.contains(&found[1].meaning), "{}", found[1].meaning);
    }

    #[test]
    fn a_parameter_without_effect_is_named() {
        let triangle =
            Triangle { r: DMatrix::from_row_slice(2, 2, &[50.0, 0.0, 0.0, 1e-3]), projected: DVector::zeros(2) };
        let found = combinations(&triangle, &[logarithmic("p"), logarithmic("epsilon")], 1.0);
        assert_eq!(found[0].meaning, "the data determine p to 2.00 %");
        assert_eq!(found[1].meaning, "the data do not determine epsilon");
    }

    /// Changes are in per cent of positive parameters, and in the unit of others. The coordinate of the latter is over half the range.
    #[test]
    fn joint_changes_are_in_units() {
        let tilt = Unknown {
            name: "initial.theta".into(),
            unit: "rad".into(),
            bounds: [-0.1, 0.1],
            is_logarithmic: false,
            ..logarithmic("")
        };
        let of = |second: f64| {
            let r = DMatrix::from_row_slice(2, 2, &[300.0, 660.0, 0.0, second]);
            combinations(&Triangle { r, projected: DVector::zeros(2) }, &[logarithmic("width"), tilt.clone()], 1.0)
        };
        assert_eq!(
            of(70.0)[1].meaning,
            "one standard deviation of the data is a joint change of width by +3.2 % and initial.theta by -0.0029 rad"
        );
        assert_eq!(
            of(0.001)[1].meaning,
            "the data do not determine a joint change of width by +10 % and initial.theta by -0.0091 rad"
        );
        let alone =
            Triangle { r: DMatrix::from_row_slice(2, 2, &[300.0, 0.0, 0.0, 400.0]), projected: DVector::zeros(2) };
        let found = combinations(&alone, &[logarithmic("width"), tilt.clone()], 1.0);
        assert!(found.iter().any(|of| of.meaning == "the data determine initial.theta to 0.0005 rad"), "{found:?}");
    }
}
