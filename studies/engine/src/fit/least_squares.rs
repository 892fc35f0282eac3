//! Residuals and their Jacobian → the point of a box with the least sum of squares.
//!
//! Levenberg's and Marquardt's method with an active set of bounds. Every coordinate runs from 0 to 1 between its bounds, so that one
//! damping fits all of them.

use nalgebra::{DMatrix, DVector};

/// Residuals with their Jacobian at a point.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Residuals r; those of priors come last.
    pub residuals: DVector<f64>,
    /// Their derivatives J with respect to the coordinates.
    pub jacobian: DMatrix<f64>,
}

/// The sum of squares `|r + J s|²` as a function of a step s. J and r are rotated into a triangle with one row per coordinate.
#[derive(Clone, Debug)]
pub struct Triangle {
    /// R of `J = Q R`.
    pub r: DMatrix<f64>,
    /// Qᵀ r.
    pub projected: DVector<f64>,
}

impl Linearization {
    /// Returns the sum of squares.
    pub fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Returns the triangle of the first `rows` residuals.
    pub fn triangle_of(&self, rows: usize) -> Triangle {
        let count = self.jacobian.ncols();
        // One column more, for the residuals; rows of zeros change nothing.
        let mut both = DMatrix::zeros(rows.max(count + 1), count + 1);
        both.view_mut((0, 0), (rows, count)).copy_from(&self.jacobian.rows(0, rows));
        both.view_mut((0, count), (rows, 1)).copy_from(&self.residuals.rows(0, rows));
        let upper = both.qr().unpack_r();
        Triangle {
            r: upper.view((0, 0), (count, count)).into(),
            projected: upper.view((0, count), (count, 1)).column(0).into(),
        }
    }

    /// Returns the triangle of all residuals.
    pub fn triangle(&self) -> Triangle {
        self.triangle_of(self.residuals.len())
    }
}

impl Triangle {
    /// Returns the decrease of the sum of squares of the linear model in a step.
    pub fn decrease(&self, step: &DVector<f64>) -> f64 {
        self.projected.norm_squared() - (&self.r * step + &self.projected).norm_squared()
    }

    /// Returns the step from `point` that minimizes `|r + J s|² + damping |s|²` within the box. The `fixed` coordinates stay.
    pub fn step(&self, point: &DVector<f64>, fixed: &[bool], damping: f64) -> DVector<f64> {
        let count = point.len();
        let mut step = DVector::zeros(count);
        let mut held = fixed.to_vec();
        loop {
            let free: Vec<usize> = (0..count).filter(|&i| !held[i]).collect();
            free.iter().for_each(|&i| step[i] = 0.0);
            let target = &self.r * &step + &self.projected;
            let Some(found) = self.solve(&free, &target, damping) else { return step };
            free.iter().zip(&found).for_each(|(&i, &size)| step[i] = size);
            let excess = |i: usize| (point[i] + step[i] - 1.0).max(-point[i] - step[i]);
            let worst = free.iter().copied().max_by(|&i, &j| excess(i).total_cmp(&excess(j)));
            let Some(worst) = worst.filter(|&i| excess(i) > 0.0) else { return step };
            step[worst] = if step[worst] > 0.0 { 1.0 - point[worst] } else { -point[worst] };
            held[worst] = true;
        }
    }

    /// Returns the change of the `free` coordinates that minimizes `|R s + target|² + damping |s|²`. There are no bounds.
    pub fn solve(&self, free: &[usize], target: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
        /// Singular values below this fraction of the greatest are round-off.
        const RANK: f64 = 1e-12;
        if free.is_empty() {
            return Some(DVector::zeros(0));
        }
        let svd = self.r.select_columns(free).try_svd(true, true, f64::EPSILON, 1000)?;
        let least = RANK * svd.singular_values.max();
        let mut components = svd.u?.tr_mul(target);
        for (component, &value) in components.iter_mut().zip(&svd.singular_values) {
            *component *= if value > least { -value / (value * value + damping) } else { 0.0 };
        }
        Some(svd.v_t?.tr_mul(&components))
    }

    /// Returns the covariance `(JᵀJ)⁻¹` of the coordinates for residuals of variance 1. It is huge in directions that change no residual.
    pub fn covariance(&self) -> DMatrix<f64> {
        let count = self.r.ncols();
        let Some(svd) = self.r.clone().try_svd(false, true, f64::EPSILON, 1000) else {
            return DMatrix::from_element(count, count, f64::NAN);
        };
        let least = (1e-14 * svd.singular_values.max()).max(f64::MIN_POSITIVE.sqrt());
        let Some(v) = svd.v_t else { return DMatrix::from_element(count, count, f64::NAN) };
        let inverse = DMatrix::from_diagonal(&svd.singular_values.map(|value| 1.0 / value.max(least)));
        let root = inverse * v;
        root.tr_mul(&root)
    }
}

/// A point with its linearization.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The point.
    pub point: DVector<f64>,
    /// Residuals and Jacobian there.
    pub at: Linearization,
    /// Whether the search has converged to its tolerance.
    pub is_converged: bool,
}

impl Minimum {
    /// Whether the linear model predicts nearly the same residuals at another point.
    pub fn is_alike(&self, other: &DVector<f64>) -> bool {
        (&self.at.jacobian * (other - &self.point)).norm_squared() <= 0.01 * self.at.cost()
    }
}

/// Minimizes the sum of squares from a point with its linearization.
///
/// `linearize` returns `None` where the model fails; such a step is rejected. The search ends when the undamped step predicts a decrease
/// below `tolerance` times the variance of a residual, which `variance` computes from a sum of squares. If a better minimum is `known`, it
/// gives up once that step leads there, or after several rejected steps in succession, as at a kink.
pub fn minimize(
    linearize: impl Fn(&DVector<f64>) -> Option<Linearization>,
    mut point: DVector<f64>,
    mut at: Linearization,
    variance: impl Fn(f64) -> f64,
    tolerance: f64,
    known: Option<&Minimum>,
) -> Minimum {
    /// Greatest number of steps, accepted or not.
    const STEPS: usize = 40;
    /// First damping, and the greatest, over the greatest of the squared columns of J.
    const DAMPING: [f64; 2] = [1e-3, 1e9];
    /// Number of rejected steps in succession after which a search gives up.
    const REJECTED: usize = 3;
    let fixed = vec![false; point.len()];
    let mut triangle = at.triangle();
    let scale = |triangle: &Triangle| triangle.r.column_iter().map(|column| column.norm_squared()).fold(0.0, f64::max);
    let (mut damping, mut growth, mut rejected) = (DAMPING[0] * scale(&triangle), 2.0, 0);
    for _ in 0..STEPS {
        let undamped = triangle.step(&point, &fixed, 0.0);
        // A gain of the size of the residuals' round-off does not count.
        let round_off = f64::EPSILON * at.cost();
        if triangle.decrease(&undamped) <= (tolerance * variance(at.cost())).max(round_off) {
            return Minimum { point, at, is_converged: true };
        }
        let leads_to = |known: &Minimum| {
            let predicted = at.cost() - triangle.decrease(&undamped);
            predicted >= known.at.cost() && known.is_alike(&(&point + &undamped))
        };
        let gives_up = |known: &Minimum| known.at.cost() < at.cost() && (rejected >= REJECTED || leads_to(known));
        if damping > DAMPING[1] * scale(&triangle) || known.is_some_and(gives_up) {
            break;
        }
        let step = triangle.step(&point, &fixed, damping);
        let next = (&point + &step).map(|coordinate| coordinate.clamp(0.0, 1.0));
        match linearize(&next).filter(|found| found.cost() < at.cost()) {
            Some(found) => {
                // H. B. Nielsen, Damping parameter in Marquardt's method, IMM-REP-1999-05, Technical University of Denmark.
                let ratio = (at.cost() - found.cost()) / triangle.decrease(&step);
                let odd = 2.0 * ratio - 1.0;
                damping *= (1.0 - odd * odd * odd).clamp(1.0 / 3.0, 2.0);
                (growth, rejected) = (2.0, 0);
                (point, at) = (next, found);
                triangle = at.triangle();
            }
            None => {
                damping *= growth;
                growth *= 2.0;
                rejected += 1;
            }
        }
    }
    Minimum { point, at, is_converged: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley with its minimum 0 at (1, 1)/4 in the coordinates of the box.
    fn rosenbrock(point: &DVector<f64>) -> Option<Linearization> {
        let (x, y) = (4.0 * point[0], 4.0 * point[1]);
        Some(Linearization {
            residuals: DVector::from_vec(vec![1.0 - x, 10.0 * (y - x * x)]),
            jacobian: DMatrix::from_row_slice(2, 2, &[-4.0, 0.0, -80.0 * x, 40.0]),
        })
    }

    fn from(point: [f64; 2], of: fn(&DVector<f64>) -> Option<Linearization>) -> Minimum {
        let start = DVector::from_row_slice(&point);
        let at = of(&start).unwrap();
        minimize(of, start, at, |_| 1.0, 1e-20, None)
    }

    #[test]
    fn the_valley_is_followed_to_its_minimum() {
        for start in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.9, 0.9]] {
            let found = from(start, rosenbrock);
            assert!(found.is_converged);
            assert!((found.point.add_scalar(-0.25)).amax() < 1e-9, "{start:?}: {}", found.point);
        }
    }

    /// The least sum of squares has x at its bound, by hand. There y = 0.5 of the line `y = 2 - 2 x` is out of reach.
    #[test]
    fn a_minimum_at_a_bound_meets_its_conditions() {
        let outside = |point: &DVector<f64>| {
            Some(Linearization {
                residuals: DVector::from_vec(vec![point[0] - 1.5, point[0] + point[1] - 1.2]),
                jacobian: DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, 1.0]),
            })
        };
        let found = from([0.3, 0.9], outside);
        assert!(found.is_converged);
        // x = 1 is nearest to 1.5, and y = 0.2 then leaves nothing of the second.
        assert!((found.point[0] - 1.0).abs() < 1e-12 && (found.point[1] - 0.2).abs() < 1e-9, "{}", found.point);
    }

    #[test]
    fn the_covariance_is_the_inverse_of_the_normal_matrix() {
        let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 0.5, -1.0, 3.0, 0.1]);
        let at = Linearization { residuals: DVector::from_vec(vec![0.1, 0.2, -0.3]), jacobian: jacobian.clone() };
        let identity = jacobian.tr_mul(&jacobian) * at.triangle().covariance();
        assert!((identity - DMatrix::identity(2, 2)).amax() < 1e-13);
    }
}
