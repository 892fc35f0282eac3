//! A hazard curve, a fragility curve → annual rate, deaggregation, interval.

use crate::fragility::{Assessment, Independence, Interval};
use crate::risk::curve::FragilityCurve;
use crate::risk::hazard::HazardCurve;
use rocking_block::numerics::roots::sign_change;

/// The annual rate at which a limit is exceeded, and its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnualRate {
    /// The rate (1/year).
    pub rate: f64,
    /// Its contribution from measures below the hazard's least level (1/year).
    pub below_hazard: f64,
    /// Its contribution from measures above the hazard's greatest level (1/year).
    pub above_hazard: f64,
    /// The hazard curve.
    pub hazard: HazardCurve,
    /// The fragility curve.
    pub curve: FragilityCurve,
}

/// The part of the rate from a range of the measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatePart {
    /// Lower end, zero below the hazard's least level.
    pub from: f64,
    /// Upper end, infinite above the hazard's greatest level.
    pub to: f64,
    /// The part of the rate (1/year).
    pub rate: f64,
    /// Its fraction of the whole (1).
    pub fraction: f64,
}

impl AnnualRate {
    /// Integrates a fragility curve over a hazard curve. Both are over one measure in one unit.
    pub fn new(hazard: &HazardCurve, curve: &FragilityCurve) -> AnnualRate {
        let mut found = AnnualRate {
            rate: 0.0,
            below_hazard: 0.0,
            above_hazard: 0.0,
            hazard: hazard.clone(),
            curve: curve.clone(),
        };
        let [least, greatest] = found.hazard_range();
        let inside = found.between(least, greatest);
        found.below_hazard = found.between(0.0, least);
        found.above_hazard = found.between(greatest, f64::INFINITY);
        found.rate = found.below_hazard + inside + found.above_hazard;
        found
    }

    /// The contribution to the rate (1/year) of a range of the measure. The range is within zero to infinity.
    pub fn between(&self, from: f64, to: f64) -> f64 {
        let [from, to] = [from, to].map(libm::log);
        let laws = self.hazard.power_laws();
        laws.iter().filter_map(|law| law.between(from, to)).map(|law| self.curve.contribution(&law)).sum()
    }

    /// The hazard's least and greatest level.
    pub fn hazard_range(&self) -> [f64; 2] {
        let levels = self.hazard.levels();
        [levels[0], levels[levels.len() - 1]]
    }

    /// The parts of the rate below, between and above the hazard's levels.
    pub fn deaggregation(&self) -> Vec<RatePart> {
        let ends = std::iter::once(0.0).chain(self.hazard.levels().iter().copied()).chain([f64::INFINITY]);
        let ends: Vec<f64> = ends.collect();
        let part = |ends: &[f64]| {
            let rate = self.between(ends[0], ends[1]);
            RatePart { from: ends[0], to: ends[1], rate, fraction: rate / self.rate }
        };
        ends.windows(2).map(part).collect()
    }

    /// The measure below which this fraction of the rate arises. `None` without a finite rate above zero.
    pub fn quantile(&self, fraction: f64) -> Option<f64> {
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            return None;
        }
        let excess = |x: f64| fraction - self.between(0.0, libm::exp(x)) / self.rate;
        let [mut low, mut high] = self.hazard_range().map(libm::log);
        // Doubling the distance brackets any quantile of a finite rate soon.
        let mut step = high - low;
        while excess(low) < 0.0 && low > -700.0 {
            (low, step) = (low - step, 2.0 * step);
        }
        while excess(high) > 0.0 && high < 700.0 {
            (high, step) = (high + step, 2.0 * step);
        }
        Some(libm::exp(sign_change(low, high, excess(low), excess(high), excess)))
    }
}

/// The rates if no run without a known outcome exceeds the limit, and if all do. `completions` are the curves of both; `None` where the runs
/// have no curve.
///
/// Runs without a known outcome are left out of a curve, and its interval does not know of them.
pub fn unknown_rates(hazard: &HazardCurve, completions: &[Option<FragilityCurve>; 2]) -> Interval {
    completions.each_ref().map(|curve| {
        let rate = AnnualRate::new(hazard, curve.as_ref()?).rate;
        Some(rate).filter(|rate| rate.is_finite())
    })
}

/// The probability of at least one event in some years. Events have this annual rate and are independent.
pub fn probability_in(years: f64, rate: f64) -> f64 {
    -libm::expm1(-rate * years)
}

/// The interval of the annual rate from the uncertainty of a fitted curve. An end that is not finite is `None`.
///
/// With a bootstrap, the interval of the rates of its curves. Otherwise the rates of the lower and the upper end of the pointwise
/// band, which lie at least as far apart as those of any curve inside the band.
///
/// The rate is that of all motions of a site; rows of a single one do not tell how far it may be wrong. An upper end above the hazard's
/// greatest rate is `None`: more motions than the curve has would exceed the limit, and of the weaker ones it says nothing, so that any number
/// would be one of its continuation.
pub fn interval(hazard: &HazardCurve, assessment: &Assessment) -> Interval {
    /// Points of the band; between them the probability is linear in the logarithm.
    const POINTS: u32 = 240;
    /// Upper end of the band below which it is left out. The number of halvings of the measure to get there follows.
    const NEGLIGIBLE: f64 = 1e-9;
    const HALVINGS: usize = 30;
    if assessment.independence == Independence::OneMotion {
        return [None; 2];
    }
    let finite = |rate: f64| Some(rate).filter(|rate| rate.is_finite());
    let within_hazard = |rate: &f64| *rate <= hazard.rates()[0];
    let of_fit = |fit: &_| match FragilityCurve::of(fit) {
        Ok(curve) => AnnualRate::new(hazard, &curve).rate,
        // A curve that falls exceeds the limit at any small measure.
        Err(_) => f64::INFINITY,
    };
    if let Some(found) = assessment.bootstrap_interval(of_fit) {
        let [low, high] = found.map(|end| end.and_then(finite));
        return [low, high.filter(within_hazard)];
    }
    let levels = hazard.levels();
    let [median, beta] = [assessment.fit.median(), assessment.fit.dispersion().abs()];
    let greatest = levels[0].min(median);
    let mut halves = std::iter::successors(Some(greatest), |measure| Some(0.5 * measure)).take(HALVINGS);
    let negligible = halves.find(|&measure| assessment.band(&[measure])[0][1].unwrap_or(1.0) < NEGLIGIBLE);
    let from = libm::log(negligible.unwrap_or(greatest));
    let to = libm::log(levels[levels.len() - 1].max(median * libm::exp(6.0 * beta)));
    let at = |point: u32| libm::exp(from + (to - from) * f64::from(point) / f64::from(POINTS));
    let at: Vec<f64> = (0..=POINTS).map(at).collect();
    let band = assessment.band(&at);
    let rate = |probability: fn(&Interval) -> f64| {
        let probabilities: Vec<f64> = band.iter().map(probability).collect();
        let curve = FragilityCurve::tabulated(&at, &probabilities).ok()?;
        finite(AnnualRate::new(hazard, &curve).rate)
    };
    // A band that reaches down to the smallest measures bounds no rate.
    let high = negligible.and_then(|_| rate(|[_, high]| high.unwrap_or(1.0)));
    [rate(|[low, _]| low.unwrap_or(0.0)), high.filter(within_hazard)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Case, CaseStore, Link, Motions, Uncertainty};

    /// A hazard `k0 m^−k` at these levels.
    fn power_law(k0: f64, k: f64, levels: &[f64]) -> HazardCurve {
        let rates: Vec<f64> = levels.iter().map(|level| k0 * libm::exp(-k * libm::log(*level))).collect();
        HazardCurve::new(levels, &rates).unwrap()
    }

    fn levels() -> Vec<f64> {
        (0..20).map(|i| 0.05 * libm::exp(0.2 * f64::from(i))).collect()
    }

    #[track_caller]
    fn near(value: f64, exact: f64, tolerance: f64) {
        assert!((value / exact - 1.0).abs() <= tolerance, "{value:e}, exactly {exact:e}");
    }

    /// λ = k0 median^−k exp(k²β²/2) (Cornell et al. 2002, eq. 8). It holds far outside the levels and for narrow curves, too.
    #[test]
    fn a_power_law_and_a_lognormal_curve_have_the_closed_form() {
        for (k, median, beta) in
            [(2.5, 0.6, 0.4), (1.0, 0.3, 0.05), (4.0, 1.0, 0.9), (3.0, 30.0, 0.3), (3.0, 0.001, 0.3), (12.0, 0.5, 1.0)]
        {
            let hazard = power_law(1e-4, k, &levels());
            let found = AnnualRate::new(&hazard, &FragilityCurve::lognormal(median, beta).unwrap());
            let exact = 1e-4 * libm::exp(-k * libm::log(median) + 0.5 * k * k * beta * beta);
            near(found.rate, exact, 1e-10);
            let sum: f64 = found.deaggregation().iter().map(|part| part.rate).sum();
            near(sum, exact, 1e-10);
        }
    }

    /// The logistic curve has λ = k0 median^−k πkβ/sin(πkβ), a beta function. It is infinite from kβ = 1 on.
    #[test]
    fn a_power_law_and_a_logistic_curve_have_the_closed_form() {
        for (k, median, beta) in [(2.5, 0.6, 0.2), (1.0, 0.3, 0.05), (2.0, 3.0, 0.49)] {
            let found = AnnualRate::new(
                &power_law(1e-4, k, &levels()),
                &FragilityCurve::Parametric { link: Link::Logit, median, beta },
            );
            let angle = std::f64::consts::PI * k * beta;
            near(found.rate, 1e-4 * libm::exp(-k * libm::log(median)) * angle / libm::sin(angle), 1e-12);
        }
        let found = AnnualRate::new(
            &power_law(1e-4, 3.0, &levels()),
            &FragilityCurve::Parametric { link: Link::Logit, median: 0.5, beta: 0.4 },
        );
        assert_eq!((found.rate, found.quantile(0.5)), (f64::INFINITY, None));
    }

    /// A step gives the hazard at its place. It stands inside and outside of the levels, and on one of them.
    ///
    /// Between the levels the rates are power laws, here m⁻², constant, and m⁻³, which the first and the last continue.
    #[test]
    fn a_step_gives_the_hazard_itself() {
        let hazard = HazardCurve::new(&[0.1, 0.2, 0.4, 0.8], &[1e-2, 2.5e-3, 2.5e-3, 3.125e-4]).unwrap();
        for median in [0.03, 0.1, 0.13, 0.3, 0.5, 0.8, 2.0] {
            let step = FragilityCurve::lognormal(median, 0.0).unwrap();
            let exact = match median {
                ..0.2 => 1e-4 / (median * median),
                ..0.4 => 2.5e-3,
                _ => 1.6e-4 / (median * median * median),
            };
            near(AnnualRate::new(&hazard, &step).rate, exact, 1e-14);
            // Half a table's step of 1e-9 changes the rate by that times the slope of the hazard.
            let table =
                FragilityCurve::tabulated(&[median * (1.0 - 1e-9), median * (1.0 + 1e-9)], &[0.0, 1.0]).unwrap();
            near(AnnualRate::new(&hazard, &table).rate, exact, 1e-8);
        }
    }

    /// A constant probability p gives p times the hazard at the least level. It holds within the hazard's range.
    #[test]
    fn a_constant_probability_gives_its_fraction_of_the_hazard() {
        let hazard = power_law(1e-4, 2.0, &levels());
        let found = AnnualRate::new(&hazard, &FragilityCurve::tabulated(&[0.1, 1.0], &[0.3, 0.3]).unwrap());
        near(found.rate, 0.3 * hazard.rates()[0], 1e-13);
        near(found.above_hazard, 0.3 * hazard.rates()[19], 1e-13);
        assert_eq!(found.below_hazard, 0.0);
    }

    /// A lognormal curve tabulated every h = 0.004 β has its rate. The error is within the h²/12 β² of linear interpolation.
    ///
    /// The table is integrated piece by piece, the curve in closed form, which the tests above compare with Cornell's.
    #[test]
    fn a_table_of_a_curve_has_its_rate() {
        let hazard = HazardCurve::new(&[0.1, 0.3, 0.5, 1.2], &[1e-2, 4e-3, 3e-4, 1e-5]).unwrap();
        let curve = FragilityCurve::lognormal(0.5, 0.4).unwrap();
        let at: Vec<f64> = (0..=4000).map(|i| 0.5 * libm::exp(0.4 * (f64::from(i) / 250.0 - 8.0))).collect();
        let probabilities: Vec<f64> = at.iter().map(|m| curve.probability(*m)).collect();
        let table = FragilityCurve::tabulated(&at, &probabilities).unwrap();
        near(AnnualRate::new(&hazard, &table).rate, AnnualRate::new(&hazard, &curve).rate, 2e-6);
    }

    /// The hazard of levels far above the median says nothing of the motions that bring most of the rate: both methods leave the end open.
    #[test]
    fn no_interval_ends_above_the_greatest_rate_of_the_hazard() {
        let rows = || (0..60).map(|i| (0.1 + 0.02 * f64::from(i), i * 7 % 20 < i / 3));
        for uncertainty in [Uncertainty::Profile, Uncertainty::Bootstrap(100, 1)] {
            let mut store = CaseStore::default();
            for (row, (measure, exceeds)) in rows().enumerate() {
                let fraction = f64::from(u8::from(exceeds));
                let case = Case { row, fraction, unknown: 0.0, peak: None, motion: None };
                store.push(row as u64, &case, [Some(measure), Some(1.0)]);
            }
            let found = Assessment::of(store, &Motions::default(), Link::Probit, 0.95, uncertainty).unwrap();
            let inside = power_law(1e-4, 2.0, &levels());
            let rate = AnnualRate::new(&inside, &FragilityCurve::of(&found.fit).unwrap()).rate;
            let [low, high] = interval(&inside, &found).map(Option::unwrap);
            assert!(low < rate && rate < high && high <= inside.rates()[0], "{low} {rate} {high}");
            let above = power_law(1e-4, 2.0, &[3.0, 4.0]);
            let [low, high] = interval(&above, &found);
            assert!(low.is_some_and(|low| low > above.rates()[0]) && high.is_none(), "{low:?} {high:?}");
        }
    }

    #[test]
    fn quantiles_divide_the_rate() {
        let hazard = HazardCurve::new(&[0.1, 0.3, 0.5, 1.2], &[1e-2, 4e-3, 3e-4, 1e-5]).unwrap();
        for median in [0.01, 0.5, 20.0] {
            let found = AnnualRate::new(&hazard, &FragilityCurve::lognormal(median, 0.4).unwrap());
            for fraction in [0.05, 0.5, 0.95] {
                near(found.between(0.0, found.quantile(fraction).unwrap()) / found.rate, fraction, 1e-10);
            }
        }
    }

    #[test]
    fn rates_become_probabilities() {
        near(probability_in(50.0, 1.0 / 475.0), 0.099_912_373_747_740_74, 1e-12);
        near(probability_in(1.0, 1e-12), 1e-12, 1e-12);
    }
}
