//! Parameters and their values → the combinations of a grid or a Latin hypercube.

use crate::input::parameters::Parameter;
use crate::statistics::sampling::LatinHypercube;

/// A parameter and its values.
#[derive(Clone, Debug)]
pub struct SweptParameter {
    /// The parameter.
    pub parameter: Parameter,
    /// Its values.
    pub values: ParameterValues,
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValues {
    /// A list; a Latin hypercube takes each value equally often.
    List(Vec<f64>),
    /// A range, sampled by a Latin hypercube.
    Range {
        /// Least value.
        from: f64,
        /// Greatest value.
        to: f64,
        /// Whether the logarithm is evenly distributed instead of the value.
        logarithmic: bool,
    },
}

impl ParameterValues {
    /// The value at a fraction of the way from first to last, 0 to 1.
    pub fn at(&self, fraction: f64) -> f64 {
        match *self {
            ParameterValues::List(ref values) => {
                values[((fraction * values.len() as f64) as usize).min(values.len() - 1)]
            }
            ParameterValues::Range { from, .. } if fraction == 0.0 => from,
            ParameterValues::Range { to, .. } if fraction == 1.0 => to,
            ParameterValues::Range { from, to, logarithmic: false } => from + fraction * (to - from),
            ParameterValues::Range { from, to, logarithmic: true } => from * libm::exp(fraction * libm::log(to / from)),
        }
    }
}

/// How the parameters are combined.
#[derive(Clone, Debug)]
pub enum Design {
    /// Every combination of values; the last parameter changes fastest.
    Grid,
    /// Samples of a Latin hypercube, and their number.
    LatinHypercube(LatinHypercube, u32),
}

impl Design {
    /// Number of combinations; `None` if it overflows.
    pub fn combinations(&self, parameters: &[SweptParameter]) -> Option<u64> {
        match self {
            Design::LatinHypercube(_, samples) => Some(u64::from(*samples)),
            Design::Grid => parameters.iter().try_fold(1_u64, |product, swept| match &swept.values {
                ParameterValues::List(values) => product.checked_mul(values.len() as u64),
                ParameterValues::Range { .. } => None,
            }),
        }
    }

    /// The values of the parameters in a combination, in their order.
    pub fn combination(&self, number: u64, parameters: &[SweptParameter]) -> Vec<f64> {
        match self {
            Design::LatinHypercube(cube, _) => {
                let fraction = |direction| cube.coordinate(number as u32, direction);
                parameters.iter().enumerate().map(|(i, swept)| swept.values.at(fraction(i))).collect()
            }
            Design::Grid => {
                let mut rest = number;
                let mut combination: Vec<f64> = (parameters.iter().rev())
                    .map(|swept| match &swept.values {
                        ParameterValues::List(values) => {
                            let value = values[(rest % values.len() as u64) as usize];
                            rest /= values.len() as u64;
                            value
                        }
                        ParameterValues::Range { from, .. } => *from,
                    })
                    .collect();
                combination.reverse();
                combination
            }
        }
    }
}
