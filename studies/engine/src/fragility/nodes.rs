//! Many rows over a measure → few weighted observations with the same likelihood.
//!
//! The log-likelihood of a row is a smooth function of its predictor `a + b ln IM`. Within a narrow cell of ln IM, the rows of each class are
//! replaced by the nodes and weights of their own Gauss quadrature (W. Gautschi, Orthogonal polynomials: computation and approximation, Oxford
//! University Press 2004, 2.2 and 3.1), which has the sums of all polynomials up to degree 15. The nearest complex poles of the likelihood and of
//! its information lie 2.8 from the real axis, so that a cell over which the predictor grows by 1 has an error of (0.5/2.8)¹⁶ times the norm of
//! the quadrature's remainder, 2·10⁻⁵: far below round-off.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::fragility::data::Data;
use crate::fragility::observation::Observation;

/// Nodes of a class in a cell.
const NODES: usize = 8;
/// Greatest growth of the predictor over a cell.
pub(super) const MAX_GROWTH: f64 = 1.0;
/// Most values of the measure in a cell, which are in memory.
const MAX_VALUES: usize = 1 << 16;

/// An observation with its ground motion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub observation: Observation,
    pub motion: u32,
}

/// Rows with the same measure and, unless motions are mixed, the same motion.
struct Value {
    /// Logarithm of the measure.
    x: f64,
    measure: f64,
    /// Weight of the rows that exceed the limit, and of the others.
    weights: [f64; 2],
    motion: u32,
}

/// Takes rows in the order of their measures, and makes nodes of them.
pub(super) struct Reducer {
    /// Width of a cell in ln IM.
    width: f64,
    /// Whether rows of different motions stay apart.
    is_by_motion: bool,
    cell: Vec<Value>,
    nodes: Vec<Node>,
}

impl Reducer {
    /// Begins with cells of this width in ln IM.
    pub fn new(width: f64, is_by_motion: bool) -> Reducer {
        Reducer { width, is_by_motion, cell: Vec::new(), nodes: Vec::new() }
    }

    /// Takes rows of a measure, at least the last one.
    pub fn push(&mut self, measure: f64, fraction: f64, weight: f64, motion: u32) {
        let weights = [weight * fraction, weight * (1.0 - fraction)];
        let same = |last: &Value| last.measure == measure && (!self.is_by_motion || last.motion == motion);
        if let Some(last) = self.cell.last_mut().filter(|last| same(last)) {
            last.weights = [last.weights[0] + weights[0], last.weights[1] + weights[1]];
            return;
        }
        let x = libm::log(measure);
        let is_full = self.cell.len() == MAX_VALUES && self.cell.last().is_some_and(|last| last.measure < measure);
        if is_full || self.cell.first().is_some_and(|first| x - first.x > self.width) {
            self.end_cell();
        }
        self.cell.push(Value { x, measure, weights, motion });
    }

    /// Number of nodes of the cells that have ended.
    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the nodes.
    pub fn finish(mut self) -> Vec<Node> {
        self.end_cell();
        self.nodes
    }

    fn end_cell(&mut self) {
        if self.is_by_motion {
            self.cell.sort_by_key(|value| value.motion);
        }
        for values in self.cell.chunk_by(|a, b| !self.is_by_motion || a.motion == b.motion) {
            let node = |measure: f64, fraction: f64, weight: f64| Node {
                observation: Observation { measures: smallvec::smallvec![measure], fraction, weight },
                motion: values[0].motion,
            };
            if values.len() <= NODES {
                self.nodes.extend(values.iter().map(|Value { measure, weights: [up, down], .. }| {
                    node(*measure, (up / (up + down)).min(1.0), up + down)
                }));
                continue;
            }
            for (class, fraction) in [1.0, 0.0].into_iter().enumerate() {
                let points =
                    values.iter().map(|value| (value.x, value.weights[class])).filter(|(_, weight)| *weight > 0.0);
                let found = quadrature(&points.collect::<Vec<_>>());
                self.nodes.extend(found.into_iter().map(|(x, weight)| node(libm::exp(x), fraction, weight)));
            }
        }
        self.cell.clear();
    }
}

/// The data of rows in few observations. `rows` has the measure, the fraction, the weight and the motion of each, in the order of the
/// measures; cells have this width in ln IM.
pub(super) fn reduced(width: f64, rows: impl Iterator<Item = (f64, f64, f64, u32)>) -> Data {
    let mut reducer = Reducer::new(width, false);
    rows.for_each(|(measure, fraction, weight, motion)| reducer.push(measure, fraction, weight, motion));
    Data::checked(observations(reducer.finish()))
}

/// The observations of nodes.
pub(super) fn observations(nodes: impl IntoIterator<Item = Node>) -> Vec<Observation> {
    nodes.into_iter().map(|node| node.observation).collect()
}

/// Returns up to [`NODES`] points and weights with the same sums of polynomials. Both lists of points increase.
///
/// Stieltjes' procedure and the eigenvalues of the Jacobi matrix.
fn quadrature(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= NODES {
        return points.to_vec();
    }
    let (low, high) = (points[0].0, points[points.len() - 1].0);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut values: Vec<[f64; 3]> = points.iter().map(|(x, _)| [(x - middle) / half, 0.0, 1.0]).collect();
    let mut jacobi = DMatrix::zeros(NODES, NODES);
    let all: f64 = points.iter().map(|(_, weight)| weight).sum();
    let (mut size, mut before) = (0, 1.0);
    for number in 0..NODES {
        let (mut norm, mut first) = (0.0, 0.0);
        for ([t, _, p], (_, weight)) in values.iter().zip(points) {
            let square = weight * p * p;
            norm += square;
            first += square * t;
        }
        // Points that differ by round-off.
        if norm <= 1e-28 * all {
            break;
        }
        let (alpha, beta) = (first / norm, norm / before);
        jacobi[(number, number)] = alpha;
        if let Some(last) = number.checked_sub(1) {
            jacobi[(number, last)] = beta.sqrt();
            jacobi[(last, number)] = beta.sqrt();
        }
        (size, before) = (number + 1, norm);
        for [t, last, p] in &mut values {
            (*last, *p) = (*p, (*t - alpha) * *p - beta * *last);
        }
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = jacobi.view((0, 0), (size, size)).into_owned().symmetric_eigen();
    let node = |number: usize| {
        let first = eigenvectors[(0, number)];
        (middle + half * eigenvalues[number].clamp(-1.0, 1.0), all * first * first)
    };
    let mut nodes: Vec<(f64, f64)> = (0..size).map(node).filter(|(_, weight)| *weight > 0.0).collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::likelihood::Link;

    /// The sums of all powers up to the 15th, and not of the 16th.
    #[test]
    fn nodes_have_the_sums_of_polynomials() {
        let point = |i: u32| (2.0 + 0.3 * f64::from(i * i % 997) / 997.0, 1.0 + f64::from(i % 3));
        let mut points: Vec<(f64, f64)> = (1..900).map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nodes = quadrature(&points);
        assert_eq!(nodes.len(), NODES);
        let sum = |points: &[(f64, f64)], power: i32| -> f64 {
            points.iter().map(|(x, weight)| weight * ((x - 2.15) / 0.15).powi(power)).sum()
        };
        let error = |power: i32| (sum(&nodes, power) - sum(&points, power)).abs() / sum(&points, 0);
        assert!((0..16).all(|power| error(power) < 1e-14), "{:?}", (0..16).map(error).collect::<Vec<_>>());
        assert!(error(16) > 1e-7, "{}", error(16));
    }

    /// Data of 20,000 rows and their nodes have the same curve and likelihood. Fractions count in both classes.
    #[test]
    fn the_curve_of_nodes_is_that_of_the_rows() {
        let row = |i: u64| {
            let [u, v] = [7_919, 104_729].map(|prime| (i * prime % 1_000_003) as f64 / 1_000_003.0);
            let measure = (2.0 * u - 1.0).exp();
            let fraction =
                if i.is_multiple_of(10) { v } else { f64::from(u8::from(v < 1.0 / (1.0 + measure.powf(-3.0)))) };
            Observation::with_probability(&[measure], fraction)
        };
        let mut rows: Vec<Observation> = (1..20_000).map(row).collect();
        rows.sort_by(|a, b| a.measures[0].total_cmp(&b.measures[0]));
        let mut reducer = Reducer::new(0.25, false);
        rows.iter().for_each(|row| reducer.push(row.measures[0], row.fraction, row.weight, 0));
        let nodes = observations(reducer.finish());
        assert!(nodes.len() < 200, "{}", nodes.len());
        for link in [Link::Probit, Link::Logit] {
            let [many, few] = [&rows, &nodes].map(|rows| Data::new(rows.clone()).unwrap().fit(link).unwrap());
            let pairs = [
                (many.median(), few.median()),
                (many.dispersion(), few.dispersion()),
                (many.log_likelihood, few.log_likelihood),
                (many.covariance[(1, 1)], few.covariance[(1, 1)]),
            ];
            assert!(pairs.iter().all(|(many, few)| (few / many - 1.0).abs() < 1e-12), "{link}: {pairs:?}");
        }
    }
}
