use super::*;
use crate::fragility::bootstrap::bootstrap;
use crate::fragility::cases::Motions;
use crate::fragility::goodness::{Goodness, groups};
use crate::fragility::quality::{auc, brier, efficiency, sufficiency};
use crate::fragility::store::CaseStore;
use crate::fragility::{Assessment, Surface, Uncertainty, sufficiency_of};

/// Rows with two measures, some at levels; every third row is undecided between both outcomes.
fn cases(rows: usize, motions: usize) -> Vec<(Case, [f64; 2])> {
    let row = |row: usize| {
        let [u, v, w] = [7_919, 104_729, 1_299_709].map(|prime| ((row + 1) * prime % 1_000_003) as f64 / 1_000_003.0);
        let motion = Some(row % motions);
        let first = if row.is_multiple_of(4) { (1.0 + 8.0 * u).round() / 5.0 } else { (2.0 * u - 1.0).exp() };
        let chance = 1.0 / (1.0 + (first * (1.0 + 0.5 * (row % motions % 3) as f64)).powf(-2.5));
        let fraction = if row.is_multiple_of(3) { chance } else { f64::from(u8::from(v < chance)) };
        (
            Case { row, fraction, unknown: 0.0, peak: (w > 0.5).then_some(0.3 * first * w), motion },
            [first, (w - 0.5).exp()],
        )
    };
    (0..rows).map(row).collect()
}

fn store(rows: &[(Case, [f64; 2])], is_surface: bool) -> CaseStore {
    let mut store = CaseStore::default();
    for (case, [first, second]) in rows {
        store.push(case.row as u64, case, [Some(*first), Some(if is_surface { *second } else { 1.0 })]);
    }
    store
}

/// The curve or surface of the rows as a list, with their data and the record of each. Rows without a motion follow the motions.
fn listed(rows: &[(Case, [f64; 2])], measures: usize, link: Link, motions: usize) -> (Data, CurveFit, Vec<usize>) {
    let observation =
        |(case, values): &(Case, [f64; 2])| Observation::with_probability(&values[..measures], case.fraction);
    let data = Data::new(rows.iter().map(observation).collect()).unwrap();
    let fit = data.fit(link).unwrap();
    (data, fit, rows.iter().map(|(case, _)| case.motion.unwrap_or(motions + case.row)).collect())
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found}, expected {expected}");
}

/// Passes over sorted rows give the results of the functions for lists. Rows in another order give the same bits.
#[test]
fn many_rows_have_the_curve_of_a_list() {
    let mut rows = cases(140_000, 30);
    let motions = Motions::in_order(None, 30);
    let assess = |rows: &[(Case, [f64; 2])], uncertainty: Uncertainty| {
        Assessment::of(store(rows, false), &motions, Link::Probit, 0.95, uncertainty).unwrap()
    };
    let found = assess(&rows, Uncertainty::Profile);
    let (data, fit, records) = listed(&rows, 1, Link::Probit, 30);
    assert!(found.data.observations().len() < 2_000 && found.rows == 140_000);
    near(found.fit.median(), fit.median(), 1e-12);
    near(found.fit.dispersion(), fit.dispersion(), 1e-12);
    near(found.fit.log_likelihood, fit.log_likelihood, 1e-12);
    let probabilities = fit.probabilities(data.observations());
    near(found.auc, auc(data.observations(), &probabilities), 1e-12);
    near(found.brier, brier(data.observations(), &probabilities), 1e-12);
    let groups = Goodness::of(&groups(data.observations(), &probabilities, &records)).unwrap();
    near(found.goodness().unwrap().deviance, groups.deviance, 1e-9);
    let (measures, peaks): (Vec<f64>, Vec<f64>) =
        rows.iter().filter_map(|(case, [first, _])| Some((*first, case.peak?))).unzip();
    near(found.efficiency.unwrap(), efficiency(&measures, &peaks).unwrap(), 1e-10);
    let covariance = clusters::covariance(&data, &fit, &records).unwrap();
    near(found.standard_errors()[0], covariance[(0, 0)].sqrt(), 1e-9);
    near(found.standard_errors()[1], covariance[(1, 1)].sqrt(), 1e-9);
    let drawn = assess(&rows, Uncertainty::Bootstrap(12, 5));
    let expected = bootstrap(&data, &records, Link::Probit, 12, 5).unwrap().interval(0.95, CurveFit::median);
    near(drawn.median[0].unwrap(), expected[0].unwrap(), 1e-11);
    near(drawn.median[1].unwrap(), expected[1].unwrap(), 1e-11);
    rows.reverse();
    let other = assess(&rows, Uncertainty::Profile);
    assert_eq!((&other.fit, other.median, other.auc, other.brier), (&found.fit, found.median, found.auc, found.brier));
    assert_eq!(other.standard_errors(), found.standard_errors());
}

#[test]
fn many_rows_have_the_surface_of_a_list() {
    // More than 100 records, which have no full refits.
    let rows = cases(140_000, 150);
    let motions = Motions::in_order(None, 150);
    let found = Surface::of(store(&rows, true), &motions, Link::Logit).unwrap();
    let (data, fit, records) = listed(&rows, 2, Link::Logit, 150);
    let covariance = clusters::covariance(&data, &fit, &records).unwrap();
    for i in 0..3 {
        near(found.fit.coefficients[i], fit.coefficients[i], 1e-10);
        near(found.standard_errors[i], covariance[(i, i)].sqrt(), 1e-9);
    }
    let probabilities = fit.probabilities(data.observations());
    near(found.auc, auc(data.observations(), &probabilities), 1e-12);
    near(found.brier, brier(data.observations(), &probabilities), 1e-12);
    let others: Vec<f64> = rows.iter().map(|(_, [_, second])| *second).collect();
    let expected = sufficiency(&listed(&rows, 1, Link::Logit, 150).0, &others, Link::Logit, &records).unwrap();
    near(sufficiency_of(store(&rows, true), &motions, Link::Logit).unwrap(), expected, 1e-6);
}

/// Rows with their own motion among records count as clusters of one row.
#[test]
fn rows_without_records_are_clusters_of_their_own() {
    let mut rows = cases(132_000, 120);
    rows.iter_mut().filter(|(case, _)| case.row.is_multiple_of(5)).for_each(|(case, _)| case.motion = None);
    let motions = Motions::in_order(None, 120);
    let found = Assessment::of(store(&rows, false), &motions, Link::Probit, 0.95, Uncertainty::Profile).unwrap();
    let (data, fit, records) = listed(&rows, 1, Link::Probit, 120);
    assert_eq!(found.independence, Independence::of(&records));
    let covariance = clusters::covariance(&data, &fit, &records).unwrap();
    near(found.standard_errors()[0], covariance[(0, 0)].sqrt(), 1e-9);
    near(found.standard_errors()[1], covariance[(1, 1)].sqrt(), 1e-9);
    let groups = groups(data.observations(), &fit.probabilities(data.observations()), &records);
    near(found.goodness().unwrap().deviance, Goodness::of(&groups).unwrap().deviance, 1e-9);
}

#[test]
fn many_rows_without_a_best_curve_are_refused() {
    let assess = |change: fn(&mut Case, &mut [f64; 2])| {
        let mut rows = cases(132_000, 7);
        rows.iter_mut().for_each(|(case, measures)| change(case, measures));
        let motions = Motions::in_order(None, 7);
        let found = Assessment::of(store(&rows, false), &motions, Link::Probit, 0.95, Uncertainty::Profile);
        found.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let refused = assess(|case, _| case.fraction = 1.0);
    assert!(refused.contains("is exceeded in all 132000 rows"), "{refused}");
    let refused = assess(|_, measures| measures[0] = 3.0);
    assert!(refused.contains("the measure 3 in all 132000 rows"), "{refused}");
    let refused = assess(|case, measures| case.fraction = f64::from(u8::from(measures[0] > 1.0)));
    assert!(refused.contains("not exceeded in all rows up to"), "{refused}");
    let refused = assess(|case, measures| {
        measures[0] = if case.row == 131_999 { -1.0 } else { measures[0] };
    });
    assert!(refused.contains("found the measure -1 in row 131999"), "{refused}");
}
