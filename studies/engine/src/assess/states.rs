//! The table of a sweep, limits → curves and annual rates.

use crate::assess::plan::State;
use crate::assess::results::{Counts, CurveResult, RateResult, StateResult};
use crate::fragility::{
    Assessment, Case, CaseStore, Collected, Interval, Limit, Link, SweepTable, SweepTableError, Uncertainty,
};
use crate::intensity::Measure;
use crate::risk::{AnnualRate, FragilityCurve, HazardCurve, interval, probability_in, unknown_rates};
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
    /// See [`RateResult::rate_of_unknown`].
    pub(super) rate_of_unknown: Option<Interval>,
    /// See [`StateResult::separate_at`].
    pub(super) separate_at: [Option<f64>; 2],
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
        let mut found = Collected::new(Some(limit), None, vec![(measure.to_string(), None)]).with_completions();
        let outcomes = found.take(table, false)?;
        let Collected { stores, completions, motions, counts, .. } = found;
        let cases: Vec<Case> = outcomes.iter().enumerate().filter_map(|(row, outcome)| outcome.case(row)).collect();
        let numbers = table.numbers(&measure.to_string())?;
        let range = range(cases.iter().filter_map(|case| numbers[case.row])).unwrap_or([f64::NAN; 2]);
        let hazard_of_unknown = hazard.filter(|_| counts.exceeded_at_most > counts.exceeded);
        let rate_of_unknown = hazard_of_unknown.zip(completions).map(|(hazard, stores)| {
            let curve = |store: CaseStore| FragilityCurve::of(&store.fit(&motions, Link::Probit).ok()?).ok();
            unknown_rates(hazard, &stores.map(curve))
        });
        let store = stores.into_iter().next().unwrap_or_default();
        let fitted = Assessment::of(store, &motions, Link::Probit, CONFIDENCE, Uncertainty::Profile);
        let assessment = fitted.map_err(|error| error.to_string()).and_then(|found| match found.fit.dispersion() {
            // No median: where the probability falls, one half of it bounds nothing.
            beta if beta < 0.0 => {
                Err(format!("the probability of exceeding the limit falls as {measure} grows (β = {beta:.3})"))
            }
            _ => Ok(found),
        });
        let curve = assessment.as_ref().ok().and_then(|found| FragilityCurve::of(&found.fit).ok());
        let rate = hazard.zip(curve).map(|(hazard, curve)| AnnualRate::new(hazard, &curve));
        let separate_at = separate_at(&cases, &numbers);
        Ok(StateCurve { counts: counts.into(), assessment, rate, rate_of_unknown, separate_at, range })
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
            rate_of_unknown: self.rate_of_unknown,
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
            limit: state.limit,
            source: state.source.clone(),
            runs: self.counts,
            curve: self.curve(),
            no_curve: self.assessment.as_ref().err().cloned(),
            rate: hazard.and_then(|hazard| self.rate(hazard, years)),
            separate_at: self.separate_at,
        }
    }
}

/// The greatest measure up to which no run exceeds a limit, and the least one from which on all do. `measures` are those of all rows; those
/// without a case may exceed it or not.
///
/// They bound no rate: few motions that do not exceed a limit say little about all others of their strength.
fn separate_at(cases: &[Case], measures: &[Option<f64>]) -> [Option<f64>; 2] {
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
    [none, all]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unknown outcomes widen the gap.
    #[test]
    fn runs_without_a_curve_lie_on_either_side_of_a_gap() {
        let of = |fractions: &[Option<f64>]| {
            let measures: Vec<Option<f64>> = (1..=fractions.len()).map(|i| Some(i as f64)).collect();
            let case = |(row, fraction): (usize, &Option<f64>)| {
                Some(Case { row, fraction: (*fraction)?, unknown: 0.0, peak: None, motion: None })
            };
            let cases: Vec<Case> = fractions.iter().enumerate().filter_map(case).collect();
            separate_at(&cases, &measures)
        };
        let (no, yes, open) = (Some(0.0), Some(1.0), None);
        assert_eq!(of(&[no, no, no]), [Some(3.0), None]);
        assert_eq!(of(&[yes, yes]), [None, Some(1.0)]);
        assert_eq!(of(&[no, no, yes, yes]), [Some(2.0), Some(3.0)]);
        assert_eq!(of(&[no, open, open, yes]), [Some(1.0), Some(4.0)]);
    }
}
