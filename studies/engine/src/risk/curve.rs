//! A fragility curve and a power law → the rate from a range of the measure.

use crate::fragility::{CurveFit, Link};
use crate::mismatch::Mismatch;
use crate::risk::hazard::PowerLaw;
use crate::statistics::normal;

/// The probability that a limit is exceeded, as a function of the intensity measure.
#[derive(Clone, Debug, PartialEq)]
pub enum FragilityCurve {
    /// `F(ln(m/median)/β)`: lognormal for a probit, where β = 0 is a step, and logistic for a logit.
    Parametric {
        /// The distribution function F.
        link: Link,
        /// Median (unit of the measure).
        median: f64,
        /// Dispersion β (1).
        beta: f64,
    },
    /// Probabilities that are linear in the logarithm of the measure between levels and constant beyond.
    Tabulated {
        /// Levels (unit of the measure).
        levels: Vec<f64>,
        /// Their probabilities.
        probabilities: Vec<f64>,
    },
}

impl FragilityCurve {
    /// The lognormal curve of a median and a dispersion.
    ///
    /// # Errors
    /// A median not above zero, or a negative dispersion.
    pub fn lognormal(median: f64, beta: f64) -> Result<FragilityCurve, Mismatch> {
        if !(median > 0.0 && median.is_finite()) {
            return Err(Mismatch::new(format!("the median {median}"), "a number above 0"));
        }
        if !(beta >= 0.0 && beta.is_finite()) {
            let expected = "a number of at least 0, for a probability that grows with the measure";
            return Err(Mismatch::new(format!("the dispersion {beta}"), expected));
        }
        Ok(FragilityCurve::Parametric { link: Link::Probit, median, beta })
    }

    /// A fitted curve of one measure.
    ///
    /// # Errors
    /// A probability that falls with the measure.
    pub fn of(fit: &CurveFit) -> Result<FragilityCurve, Mismatch> {
        let (link, median, beta) = (fit.link, fit.median(), fit.dispersion());
        FragilityCurve::lognormal(median, beta).map(|_| FragilityCurve::Parametric { link, median, beta })
    }

    /// A table of probabilities.
    ///
    /// # Errors
    /// Fewer than two levels, levels that do not increase, or a probability outside 0 to 1.
    pub fn tabulated(levels: &[f64], probabilities: &[f64]) -> Result<FragilityCurve, Mismatch> {
        if levels.len() < 2 || levels.len() != probabilities.len() {
            let found = format!("{} levels and {} probabilities", levels.len(), probabilities.len());
            return Err(Mismatch::new(found, "two or more, a probability for each level"));
        }
        for (i, (&level, probability)) in levels.iter().zip(probabilities).enumerate() {
            if !(level > 0.0 && level.is_finite() && (i == 0 || level > levels[i - 1])) {
                return Err(Mismatch::new(format!("{level} as level {}", i + 1), "levels above 0 that increase"));
            }
            if !(0.0..=1.0).contains(probability) {
                return Err(Mismatch::new(format!("the probability {probability} at the level {level}"), "0 to 1"));
            }
        }
        Ok(FragilityCurve::Tabulated { levels: levels.to_vec(), probabilities: probabilities.to_vec() })
    }

    /// The probability at a measure above zero.
    pub fn probability(&self, measure: f64) -> f64 {
        self.at(libm::log(measure))
    }

    /// The probability at the logarithm of a measure.
    fn at(&self, x: f64) -> f64 {
        match self {
            FragilityCurve::Parametric { link, median, beta } => link.probability(deviate(x, *median, *beta)),
            FragilityCurve::Tabulated { levels, probabilities } => {
                let after = levels.partition_point(|level| libm::log(*level) <= x);
                let [before, after] = [after.max(1) - 1, after.min(levels.len() - 1)];
                let [x0, x1] = [levels[before], levels[after]].map(libm::log);
                let fraction = if x1 > x0 { ((x - x0) / (x1 - x0)).clamp(0.0, 1.0) } else { 0.0 };
                probabilities[before] + fraction * (probabilities[after] - probabilities[before])
            }
        }
    }

    /// `∫ P |dH|` over a power law. Infinite if the hazard grows faster than P falls at small measures.
    ///
    /// By parts this is `P H` at the lower end minus `P H` at the upper end plus `∫ H dP`. Below both the hazard's levels and its own,
    /// a table contributes nothing: a constant probability would meet an unbounded rate.
    pub(super) fn contribution(&self, law: &PowerLaw) -> f64 {
        let inside = match self {
            FragilityCurve::Parametric { link: Link::Probit, median, beta } => {
                lognormal(law, libm::log(*median), *beta)
            }
            FragilityCurve::Parametric { link: Link::Logit, median, beta } => {
                return logistic(law, libm::log(*median), *beta);
            }
            FragilityCurve::Tabulated { levels, probabilities } => {
                if law.from == f64::NEG_INFINITY {
                    let part = law.between(libm::log(levels[0]), law.to);
                    return part.map_or(0.0, |part| self.contribution(&part));
                }
                let pairs = levels.windows(2).zip(probabilities.windows(2));
                pairs
                    .map(|(levels, probabilities)| {
                        linear(law, [levels[0], levels[1]], [probabilities[0], probabilities[1]])
                    })
                    .sum()
            }
        };
        let end = |x: f64| if x.is_finite() { law.rate(x) * self.at(x) } else { 0.0 };
        // Round-off may leave a difference below zero where the hazard is flat.
        (end(law.from) - end(law.to) + inside).max(0.0)
    }
}

/// ln(m/median)/β, infinite for β = 0; at a step the probability is one half.
fn deviate(x: f64, median: f64, beta: f64) -> f64 {
    let distance = x - libm::log(median);
    if distance == 0.0 { 0.0 } else { distance / beta }
}

/// `∫ H dΦ` over a power law. It is `H(x*) exp(−k²β²/2) (Φ(w₁) − Φ(w₀))` with w = z + kβ, which is zero at x*.
///
/// Far from x* the factor overflows; there the difference is that of `H φ(z) Φ(−|w|)/φ(w)` at both ends.
fn lognormal(law: &PowerLaw, mu: f64, beta: f64) -> f64 {
    if beta == 0.0 {
        return if law.from < mu && mu <= law.to { law.rate(mu) } else { 0.0 };
    }
    let shift = law.slope * beta;
    let z = |x: f64| (x - mu) / beta;
    let [lower, upper] = [z(law.from) + shift, z(law.to) + shift];
    let far = |x: f64| {
        let (z, w) = (z(x), z(x) + shift);
        if x.is_finite() { law.rate(x) * normal::density(z) / normal::inverse_mills_ratio(-w.abs()) } else { 0.0 }
    };
    if lower >= 0.0 {
        far(law.from) - far(law.to)
    } else if upper <= 0.0 {
        far(law.to) - far(law.from)
    } else {
        let exponent = -law.slope * (mu - shift * beta - law.at) - 0.5 * shift * shift;
        law.rate * libm::exp(exponent) * (normal::probability(upper) - normal::probability(lower))
    }
}

/// `∫ H dP` over a power law and a linear P. The probability P is linear in the logarithm between two levels.
fn linear(law: &PowerLaw, levels: [f64; 2], probabilities: [f64; 2]) -> f64 {
    let [x0, x1] = levels.map(libm::log);
    let Some(part) = law.between(x0, x1) else { return 0.0 };
    let width = part.to - part.from;
    let mean = match law.slope * width {
        0.0 => 1.0,
        fall => -libm::expm1(-fall) / fall,
    };
    (probabilities[1] - probabilities[0]) / (x1 - x0) * law.rate(part.from) * mean * width
}

/// `∫ P |dH|` over a power law for a logistic curve.
///
/// Below z = −36 the probability is exp(z), above z = 36 it is 1, to round-off; between, Gauss's rule of ten points runs over pieces
/// of at most β and 1/k.
fn logistic(law: &PowerLaw, mu: f64, beta: f64) -> f64 {
    const FAR: f64 = 36.0;
    let [near, far] = [mu - FAR * beta, mu + FAR * beta];
    let mut sum = 0.0;
    if let Some(tail) = law.between(f64::NEG_INFINITY, near) {
        // d/dx of H exp(z) is (1/β − k) H exp(z).
        let growth = 1.0 / beta - law.slope;
        if tail.from == f64::NEG_INFINITY && growth <= 0.0 && law.slope > 0.0 {
            return f64::INFINITY;
        }
        let end = |x: f64| if x.is_finite() { law.rate(x) * libm::exp((x - mu) / beta) } else { 0.0 };
        sum += match growth {
            0.0 => law.slope * end(tail.to) * (tail.to - tail.from),
            growth => law.slope / growth * (end(tail.to) - end(tail.from)),
        };
    }
    if let Some(tail) = law.between(far, f64::INFINITY) {
        sum += law.rate(tail.from) - if tail.to.is_finite() { law.rate(tail.to) } else { 0.0 };
    }
    if let Some(middle) = law.between(near, far) {
        let pieces = ((middle.to - middle.from) * f64::max(1.0 / beta, law.slope)).ceil().max(1.0);
        let half = 0.5 * (middle.to - middle.from) / pieces;
        for i in 0..pieces as u64 {
            let centre = middle.from + (2 * i + 1) as f64 * half;
            for (node, weight) in GAUSS {
                for x in [centre - half * node, centre + half * node] {
                    sum += weight * half * law.slope * law.rate(x) * Link::Logit.probability((x - mu) / beta);
                }
            }
        }
    }
    sum
}

/// Nodes and weights of Gauss's rule of ten points (M. Abramowitz, I. A. Stegun, Handbook of mathematical functions, 25.4).
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_4),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];
