//! The table of a sweep, limits → curves and annual rates.

use crate::assess::plan::State;
use crate::assess::results::{Counts, CurveResult, RateResult, StateResult, ends};
use crate::fragility::{Assessment, Cases, Limit, Link, SweepTable, SweepTableError, Uncertainty};
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
    /// Least and greatest measure of the runs.
    range: [f64; 2],
}

impl StateCurve {
    /// Fits the curve of a limit, as `rocking fragility` does, and integrates it over a hazard curve, as `rocking rate` does.
    ///
    /// # Errors
    /// The table has no such measure, or no slip for a limit on it.
    pub fn new(
        table: &SweepTable,
        measure: Measure,
        limit: Limit,
        hazard: Option<&HazardCurve>,
    ) -> Result<StateCurve, SweepTableError> {
        let Cases { cases, .. } = table.cases(limit)?;
        let numbers = table.numbers(&measure.to_string())?;
        let values: Vec<Option<f64>> = cases.iter().map(|case| numbers[case.row]).collect();
        let range = range(values.iter().flatten().copied()).unwrap_or([f64::NAN; 2]);
        let counts = Counts {
            known: cases.len(),
            exceeded: cases.iter().filter(|case| case.fraction == 1.0).count(),
            left_out: table.rows() - cases.len(),
        };
        let fitted = Assessment::new(&cases, &values, Link::Probit, CONFIDENCE, Uncertainty::Profile);
        let assessment = fitted.map_err(|error| error.to_string());
        let curve = assessment.as_ref().ok().and_then(|found| FragilityCurve::of(&found.fit).ok());
        let rate = hazard.zip(curve).map(|(hazard, curve)| AnnualRate::new(hazard, &curve));
        Ok(StateCurve { counts, assessment, rate, range })
    }

    /// The numbers of the curve.
    pub(super) fn curve(&self) -> Option<CurveResult> {
        let found = self.assessment.as_ref().ok()?;
        Some(CurveResult {
            median: found.fit.median(),
            median_interval: ends(found.median),
            beta: found.fit.dispersion(),
            beta_interval: ends(found.dispersion),
            auc: found.auc,
        })
    }

    /// The reason why there is no curve.
    pub(super) fn no_curve(&self) -> Option<String> {
        self.assessment.as_ref().err().cloned()
    }

    /// The annual rate with its interval.
    fn rate(&self, hazard: &HazardCurve, years: f64) -> Option<RateResult> {
        let (rate, assessment) = (self.rate.as_ref()?, self.assessment.as_ref().ok()?);
        let share = |part: f64| if rate.rate > 0.0 { part / rate.rate } else { 0.0 };
        let [least, greatest] = self.range;
        Some(RateResult {
            rate: rate.rate,
            rate_interval: ends(interval(hazard, assessment)),
            probability: probability_in(years, rate.rate),
            below_runs: share(rate.between(0.0, least)),
            above_runs: share(rate.between(greatest, f64::INFINITY)),
            outside_hazard: share(rate.below_hazard + rate.above_hazard),
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
            no_curve: self.no_curve(),
            rate: hazard.and_then(|hazard| self.rate(hazard, years)),
        }
    }
}
