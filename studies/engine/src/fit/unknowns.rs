//! Names of free parameters → their ranges, and a box of coordinates from 0 to 1.

use nalgebra::DVector;
use rocking_block::block::restraints::tie::{self, Quantity};
use rocking_gradients::{Parameters, unit};

use crate::fit::problem::{FitError, Free, Problem, Test};
use crate::spec::{BlockSpec, limits};

/// A parameter to be estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Its name, without the test.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its test. `None` for a parameter of the block, which all tests share.
    pub test: Option<usize>,
    /// Its value at the first start.
    pub start: f64,
    /// Its bounds.
    pub bounds: [f64; 2],
    /// Whether its logarithm is the coordinate.
    pub is_logarithmic: bool,
    /// Mean and standard deviation of its prior.
    pub prior: Option<[f64; 2]>,
}

/// Parameters of a test's measurement, not of its block.
pub const MEASUREMENT_PARAMETERS: [&str; 2] = ["zero", "delay"];

impl Unknown {
    /// Returns the name with the test, such as `test_2.zero`.
    pub fn full_name(&self) -> String {
        self.test.map_or(self.name.clone(), |test| format!("test_{}.{}", test + 1, self.name))
    }

    /// Returns the value at a coordinate.
    pub fn value(&self, coordinate: f64) -> f64 {
        let [low, high] = self.bounds;
        match self.is_logarithmic {
            // The ends are exact.
            _ if coordinate <= 0.0 => low,
            _ if coordinate >= 1.0 => high,
            true => low * libm::exp(coordinate * libm::log(high / low)),
            false => low + coordinate * (high - low),
        }
    }

    /// Returns the coordinate of a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        let [low, high] = self.bounds;
        let found = match self.is_logarithmic {
            true => libm::log(value / low) / libm::log(high / low),
            false => (value - low) / (high - low),
        };
        found.clamp(0.0, 1.0)
    }

    /// Returns the derivative of the value with respect to the coordinate.
    pub fn slope(&self, coordinate: f64) -> f64 {
        let [low, high] = self.bounds;
        if self.is_logarithmic { self.value(coordinate) * libm::log(high / low) } else { high - low }
    }

    /// Returns the derivative of the coordinate with respect to the relative value. That is the logarithm of the value, or the value over
    /// half its range.
    pub fn relative(&self) -> f64 {
        let [low, high] = self.bounds;
        if self.is_logarithmic { 1.0 / libm::log(high / low) } else { 0.5 }
    }
}

/// Returns the factor from a value to its usual bounds. The parameter's logarithm is fitted.
fn factor(name: &str) -> Option<f64> {
    if let Some(number) = tie::number_of_path(name) {
        return match number.quantity {
            Quantity::Force if number.name == "pretension" => Some(3.0),
            Quantity::Stiffness | Quantity::Damping | Quantity::Force => Some(10.0),
            Quantity::Coordinate | Quantity::Length | Quantity::Ratio => None,
        };
    }
    match name {
        "scale" | "pulse.period" | "pulse.cycles" => Some(3.0),
        name if name.contains('.') => None,
        name => limits::properties::<BlockSpec>()[name]["fit_factor"].as_f64(),
    }
}

/// Returns the usual bounds of a parameter with this value in a test. Its logarithm is not fitted.
fn usual_bounds(name: &str, value: f64, test: &Test, [alpha, p, half_width, height]: [f64; 4]) -> [f64; 2] {
    let half = match name {
        "epsilon" => return [0.0, 1.0],
        "eccentricity" => 0.5 * half_width,
        "initial.theta" => 0.5 * alpha,
        "initial.theta_dot" => 0.5 * alpha * p,
        "initial.v" => 0.1 * half_width,
        "initial.v_dot" => 0.1 * half_width * p,
        "pulse.amplitude" => 0.7 * value.abs(),
        "pulse.start" => 0.5 * test.pulse.period,
        "pulse.phase" => std::f64::consts::FRAC_PI_2,
        "zero" => 0.5 * test.values.iter().fold(0.0, |most: f64, value| most.max(value.abs())),
        "delay" => 0.5 / p,
        _ => height,
    };
    [value - half, value + half]
}

/// Returns the unknowns of a problem: those of the block, then those of each test.
///
/// # Errors
/// A free parameter that is unknown, is given twice, has no effect, or has invalid bounds.
pub fn unknowns(problem: &Problem) -> Result<Vec<Unknown>, FitError> {
    let mut found = problem.free.iter().map(|free| unknown(problem, free, None)).collect::<Result<Vec<_>, _>>()?;
    for (number, test) in problem.tests.iter().enumerate() {
        for free in &test.free {
            found.push(unknown(problem, free, Some(number))?);
        }
    }
    for (i, unknown) in found.iter().enumerate() {
        if found[..i].iter().any(|other| other.full_name() == unknown.full_name()) {
            return Err(FitError::Invalid(format!("{} is given twice; expected it once", unknown.full_name())));
        }
    }
    if found.is_empty() {
        return Err(FitError::Invalid("nothing is free; expected one parameter at least, as in alpha".into()));
    }
    Ok(found)
}

fn is_of_test(name: &str) -> bool {
    name == "scale"
        || name.starts_with("initial.")
        || name.starts_with("pulse.")
        || MEASUREMENT_PARAMETERS.contains(&name)
}

fn unknown(problem: &Problem, free: &Free, number: Option<usize>) -> Result<Unknown, FitError> {
    let name = &free.name;
    let shown = number.map_or(name.clone(), |number| format!("test_{}: {name}", number + 1));
    // For a parameter of the block any test will do.
    let test = &problem.tests[number.unwrap_or(0)];
    let mut parameters = problem.parameters(test);
    let mut known: Vec<String> =
        parameters.names().into_iter().filter(|name| is_of_test(name) == number.is_some()).collect();
    if number.is_some() {
        known.extend(MEASUREMENT_PARAMETERS.map(String::from));
    }
    if !known.contains(name) {
        let hint = match (number, is_of_test(name)) {
            (None, true) => format!("{name} belongs to a test; expected it among the free parameters of one, and here"),
            _ => format!(
                "{shown} is no real parameter of this {}; expected",
                if number.is_some() { "test" } else { "block" }
            ),
        };
        return Err(FitError::Invalid(format!("{hint} one of {}", known.join(", "))));
    }
    let start = match name.as_str() {
        "zero" => test.zero,
        "delay" => test.delay,
        _ => parameters.number(name).map_or(f64::NAN, |number| *number),
    };
    let (bounds, is_logarithmic) = bounds(problem, test, name, start, free.bounds, &shown)?;
    if let Some([mean, deviation]) = free.prior
        && !(mean.is_finite() && deviation > 0.0 && deviation.is_finite())
    {
        let message = format!("prior of {shown} = [{mean}, {deviation}]; expected a mean and a standard deviation > 0");
        return Err(FitError::Invalid(message));
    }
    let unit = match name.as_str() {
        "zero" => problem.unit(test)?,
        "delay" => "s".into(),
        _ => unit(name).into(),
    };
    Ok(Unknown { name: name.clone(), unit, test: number, start, bounds, is_logarithmic, prior: free.prior })
}

/// Returns the bounds of a parameter, and whether its logarithm is fitted.
fn bounds(
    problem: &Problem,
    test: &Test,
    name: &str,
    start: f64,
    chosen: Option<[f64; 2]>,
    shown: &str,
) -> Result<([f64; 2], bool), FitError> {
    let positive = factor(name).filter(|_| start > 0.0);
    let usual = match positive {
        Some(factor) => [start / factor, start * factor],
        None => {
            let block = problem.parameters(test).checked_block().map_err(FitError::Block)?;
            usual_bounds(name, start, test, [block.alpha, block.p, block.b, block.h])
        }
    };
    let bounds = chosen.unwrap_or(usual);
    let [low, high] = bounds;
    if !(low.is_finite() && high.is_finite() && low < high) {
        let message = format!("bounds of {shown} = [{low}, {high}]; expected two different numbers, the lower first");
        return Err(FitError::Invalid(message));
    }
    if !(low..=high).contains(&start) {
        return Err(FitError::Invalid(format!(
            "{shown} = {start} is not within its bounds [{low}, {high}]; expected a value inside"
        )));
    }
    Ok((bounds, factor(name).is_some() && low > 0.0))
}

/// Returns the point of the first start.
pub fn first_start(unknowns: &[Unknown]) -> DVector<f64> {
    DVector::from_iterator(unknowns.len(), unknowns.iter().map(|unknown| unknown.coordinate(unknown.start)))
}

/// Sets a parameter, unless it belongs to the measurement.
pub fn set(parameters: &mut Parameters, name: &str, value: f64) {
    if let Some(number) = parameters.number(name) {
        *number = value;
    }
}
