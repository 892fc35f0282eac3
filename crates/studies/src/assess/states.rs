//! The table of a sweep, limits → curves and annual rates.

use crate::assess::plan::State;
use crate::assess::results::{Counts, CurveResult, RateResult, StateResult};
use crate::fragility::{Assessment, Case, CaseStore, Limit, Link, SweepTable, SweepTableError, Uncertainty};
use crate::intensity::Measure;
use crate::risk::{AnnualRate, FragilityCurve, HazardCurve, interval, probability_in};
use crate::statistics::range;

/// Confidence level of all intervals.
pub(super) const CONFIDENCE: f64 = 0.95;

/// The curve of a limit over the runs of a table.
pub struct StateCurve {
    /// The runs.
    pub counts: Counts,
    /// The curve, or the reason why there is none.
    pub assessment: Result<Assessment, String>,
    /// The annual rate, with a hazard curve.
    pub rate: Option<AnnualRate>,
    /// Bounds of the rate from the runs alone.
    pub(super) rate_bounds: [Option<f64>; 2],
    /// Least and greatest measure of the runs.
    range: [f64; 2],
}

impl StateCurve {
    /// Fits the curve of a limit, and integrates it over a hazard curve. It does so as `rocking fragility` and `rocking rate`.
    ///
    /// # Errors
    /// The table has no such measure, or no slip for a limit on it.
    pub fn new(
        table: &SweepTable,
        measure: Measure,
        limit: Limit,
        hazard: Option<&HazardCurve>,
    ) -> Result<StateCurve, SweepTableError> {
        let (cases, motions, counts) = table.cases(limit)?;
        let numbers = table.numbers(&measure.to_string())?;
        let range = range(cases.iter().filter_map(|case| numbers[case.row])).unwrap_or([f64::NAN; 2]);
        let mut store = CaseStore::default();
        cases.iter().for_each(|case| store.push(case.row as u64, case, [numbers[case.row], Some(1.0)]));
        let fitted = Assessment::of(store, &motions, Link::Probit, CONFIDENCE, Uncertainty::Profile);
        let assessment = fitted.map_err(|error| error.to_string());
        let curve = assessment.as_ref().ok().and_then(|found| FragilityCurve::of(&found.fit).ok());
        let rate = hazard.zip(curve).map(|(hazard, curve)| AnnualRate::new(hazard, &curve));
        let rate_bounds = hazard.map_or([None; 2], |hazard| rate_bounds(hazard, &cases, &numbers));
        Ok(StateCurve { counts: counts.into(), assessment, rate, rate_bounds, range })
    }

    /// The numbers of the curve.
    pub(super) fn curve(&self) -> Option<CurveResult> {
        let found = self.assessment.as_ref().ok()?;
        Some(CurveResult {
            median: found.fit.median(),
            median_interval: found.median,
            beta: found.fit.dispersion(),
            beta_interval: found.dispersion,
            auc: found.auc,
        })
    }

    /// The annual rate with its interval.
    fn rate(&self, hazard: &HazardCurve, years: f64) -> Option<RateResult> {
        let (rate, assessment) = (self.rate.as_ref()?, self.assessment.as_ref().ok()?);
        let fraction = |contribution: f64| if rate.rate > 0.0 { contribution / rate.rate } else { 0.0 };
        let [least, greatest] = self.range;
        Some(RateResult {
            rate: rate.rate,
            rate_interval: interval(hazard, assessment),
            probability: probability_in(years, rate.rate),
            below_runs: fraction(rate.between(0.0, least)),
            above_runs: fraction(rate.between(greatest, f64::INFINITY)),
            outside_hazard: fraction(rate.below_hazard + rate.above_hazard),
        })
    }

    /// The result of a state.
    pub(super) fn result(&self, state: &State, hazard: Option<&HazardCurve>, years: f64) -> StateResult {
        StateResult {
            name: state.name.clone(),
            limit: state.limit.to_string(),
            source: state.source.clone(),
            runs: self.counts,
            curve: self.curve(),
            no_curve: self.assessment.as_ref().err().cloned(),
            rate: hazard.and_then(|hazard| self.rate(hazard, years)),
            rate_bounds: self.rate_bounds,
        }
    }
}

/// Bounds of the rate without a curve. They are the rates of the least measure from which on all runs exceed a limit, and of the greatest
/// one up to which none does. `measures` are those of all rows; those without a case may exceed it or not.
fn rate_bounds(hazard: &HazardCurve, cases: &[Case], measures: &[Option<f64>]) -> [Option<f64>; 2] {
    let mut fractions: Vec<Option<f64>> = vec![None; measures.len()];
    for case in cases {
        fractions[case.row] = Some(case.fraction);
    }
    let rows = || measures.iter().zip(&fractions).filter_map(|(measure, fraction)| Some(((*measure)?, *fraction)));
    // Beyond these lies a row that may not exceed the limit, or may exceed it.
    let open = rows().filter(|(_, fraction)| *fraction != Some(1.0)).map(|(x, _)| x).fold(0.0, f64::max);
    let touched = rows().filter(|(_, fraction)| *fraction != Some(0.0)).map(|(x, _)| x).fold(f64::INFINITY, f64::min);
    let all = rows().map(|(x, _)| x).filter(|x| *x > open).reduce(f64::min);
    let none = rows().map(|(x, _)| x).filter(|x| *x < touched).reduce(f64::max);
    [all, none].map(|level| level.map(|level| hazard.rate(level)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step at an unknown measure between two levels has a rate between theirs. Unknown outcomes widen the bounds.
    #[test]
    fn the_runs_bound_the_rate_where_they_have_no_curve() {
        let hazard = HazardCurve::new(&[0.1, 1.0, 2.0], &[1e-2, 1e-4, 1e-5]).unwrap();
        let rate = |level: f64| Some(hazard.rate(level));
        let of = |fractions: &[Option<f64>]| {
            let measures: Vec<Option<f64>> = (1..=fractions.len()).map(|i| Some(0.2 * i as f64)).collect();
            let case = |(row, fraction): (usize, &Option<f64>)| {
                Some(Case { row, fraction: (*fraction)?, unknown: 0.0, peak: None, motion: None })
            };
            let cases: Vec<Case> = fractions.iter().enumerate().filter_map(case).collect();
            rate_bounds(&hazard, &cases, &measures)
        };
        let (no, yes, open) = (Some(0.0), Some(1.0), None);
        assert_eq!(of(&[no, no, no]), [None, rate(0.2 * 3.0)]);
        assert_eq!(of(&[yes, yes]), [rate(0.2), None]);
        assert_eq!(of(&[no, no, yes, yes]), [rate(0.2 * 3.0), rate(0.4)]);
        assert_eq!(of(&[no, open, open, yes]), [rate(0.8), rate(0.2)]);
        let step = |at: f64| AnnualRate::new(&hazard, &FragilityCurve::lognormal(at, 0.0).unwrap()).rate;
        let [least, most] = of(&[no, no, yes, yes]).map(Option::unwrap);
        assert!(least <= step(0.5) && step(0.5) <= most);
    }
}
