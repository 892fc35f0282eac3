//! Fragility curves against curves that were planted.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rocking_block::study::fragility::{Data, FitError, Link, Observation, Profile, bootstrap, sufficiency};

/// A stream of numbers, evenly distributed in 0 to 1.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || (random.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
}

/// Rows of measures around 1, half a decade each way, with outcomes by the chance of a curve of this median and dispersion.
fn planted(link: Link, median: f64, dispersion: f64, rows: usize, seed: u64) -> Vec<Observation> {
    let mut uniform = uniform(seed);
    let row = |_| {
        let measure = (2.4 * (uniform() - 0.5)).exp();
        let probability = link.probability((measure / median).ln() / dispersion);
        Observation::of(&[measure], uniform() < probability)
    };
    (0..rows).map(row).collect()
}

/// Of 1000 intervals of 95 % as many hold what was planted as the binomial distribution lets expect: 950 ± 3.3 standard
/// deviations of 6.9, which chance alone leaves once in a thousand.
#[test]
fn a_planted_curve_is_within_its_band_in_95_of_100_trials() {
    const TRIALS: u64 = 1000;
    for (link, [median, dispersion]) in [(Link::Probit, [1.1, 0.4]), (Link::Logit, [0.9, 0.25])] {
        let trials = (0..TRIALS).into_par_iter().map(|trial| {
            let data = Data::new(planted(link, median, dispersion, 120, trial)).unwrap();
            let fit = data.fit(link).unwrap();
            let profile = Profile::new(&data, &fit, 0.95).unwrap();
            let at = |measure: f64| {
                let exact = link.probability((measure / median).ln() / dispersion);
                profile.probability(measure).contains(exact)
            };
            [profile.median().contains(median), profile.dispersion().contains(dispersion), at(0.7), at(1.6)]
                .map(u64::from)
        });
        let held = trials.reduce(|| [0; 4], |a, b| [0, 1, 2, 3].map(|i| a[i] + b[i]));
        let spread = 3.3 * (TRIALS as f64 * 0.95 * 0.05).sqrt();
        for count in held {
            assert!((count as f64 - 950.0).abs() < spread, "{link}: {held:?} of 1000, expected 950 ± {spread:.0}");
        }
    }
}

/// The logarithm of the likelihood ratio at both ends of an interval is what the confidence allows: fits of the data with
/// the feature held there, by another way, a fine search over the other coefficient.
#[test]
fn the_ends_of_an_interval_are_where_the_likelihood_has_fallen_enough() {
    let data = Data::new(planted(Link::Logit, 1.0, 0.3, 80, 5)).unwrap();
    let fit = data.fit(Link::Logit).unwrap();
    let profile = Profile::new(&data, &fit, 0.9).unwrap();
    let log_likelihood = |a: f64, b: f64| -> f64 {
        let term = |row: &Observation| {
            let predictor = a + b * row.measures[0].ln();
            -(1.0 + (if row.fraction == 1.0 { -predictor } else { predictor }).exp()).ln()
        };
        data.observations().iter().map(term).sum()
    };
    assert!((log_likelihood(fit.coefficients[0], fit.coefficients[1]) - fit.log_likelihood).abs() < 1e-10);
    let best =
        |of: &dyn Fn(f64) -> f64| (0..200_001).map(|i| of(0.0001 * f64::from(i) - 10.0)).fold(f64::MIN, f64::max);
    // χ² of 90 % with one degree of freedom.
    let allowed = fit.log_likelihood - 0.5 * 2.705_543_454_095_404;
    let (median, dispersion) = (profile.median(), profile.dispersion());
    for end in [median.low, median.high] {
        let log_median = end.unwrap().ln();
        assert!((best(&|b| log_likelihood(-b * log_median, b)) - allowed).abs() < 1e-6);
    }
    for end in [dispersion.low, dispersion.high] {
        assert!((best(&|a| log_likelihood(a, 1.0 / end.unwrap())) - allowed).abs() < 1e-6);
    }
    let band = profile.probability(1.3);
    for end in [band.low, band.high] {
        let predictor = (end.unwrap() / (1.0 - end.unwrap())).ln();
        assert!((best(&|b| log_likelihood(predictor - b * 1.3_f64.ln(), b)) - allowed).abs() < 1e-6);
    }
}

/// Where outcomes do not depend on the measure the data bound neither the median nor, above, the dispersion.
#[test]
fn what_the_data_do_not_bound_has_no_end() {
    let rows = [(1.0, false), (1.0, true), (2.0, true), (2.0, false), (3.0, true), (3.0, false), (3.0, true)];
    let data = Data::new(rows.map(|(measure, exceeded)| Observation::of(&[measure], exceeded)).to_vec()).unwrap();
    let fit = data.fit(Link::Probit).unwrap();
    let profile = Profile::new(&data, &fit, 0.95).unwrap();
    assert!(profile.median().low.is_none() && profile.median().high.is_none());
    assert!(profile.dispersion().low.is_some() && profile.dispersion().high.is_none());
    let band = profile.probability(2.0);
    assert!(0.0 < band.low.unwrap() && band.high.unwrap() < 1.0);
    assert!(matches!(
        Profile::new(
            &Data::new(vec![
                Observation::counted(&[1.0, 1.0], 1, 2),
                Observation::counted(&[2.0, 1.0], 1, 2),
                Observation::counted(&[1.0, 3.0], 1, 2),
            ])
            .unwrap(),
            &fit,
            0.95
        ),
        Err(FitError::Measures { found: 2, .. })
    ));
}

/// A measure that the outcomes follow is sufficient beside one that they do not, and not the other way round; where they do
/// not depend on the second, p-values are evenly distributed.
#[test]
fn sufficiency_tells_what_outcomes_depend_on() {
    let mut below = [0_u32; 4];
    for trial in 0..400 {
        let rows = planted(Link::Probit, 1.0, 0.4, 150, trial);
        let mut uniform = uniform(10_000 + trial);
        let others: Vec<f64> = rows.iter().map(|_| 0.5 + uniform()).collect();
        let p = sufficiency(&Data::new(rows.clone()).unwrap(), &others, Link::Probit).unwrap();
        below[((4.0 * p) as usize).min(3)] += 1;
        let swapped =
            rows.iter().zip(&others).map(|(row, &other)| Observation { measures: vec![other], ..row.clone() });
        let measures: Vec<f64> = rows.iter().map(|row| row.measures[0]).collect();
        assert!(sufficiency(&Data::new(swapped.collect()).unwrap(), &measures, Link::Probit).unwrap() < 1e-6);
    }
    // χ² with 3 degrees of freedom is above 16.3 once in a thousand.
    let chi: f64 = below.iter().map(|&count| (f64::from(count) - 100.0).powi(2) / 100.0).sum();
    assert!(chi < 16.3, "{below:?}");
}

/// Rows that come ten times each tell no more than once: the bootstrap of whole groups knows, that of rows does not.
#[test]
fn a_bootstrap_of_groups_knows_how_many_there_are() {
    let rows = planted(Link::Probit, 1.0, 0.4, 60, 3);
    let tenfold: Vec<Observation> = rows.iter().flat_map(|row| std::iter::repeat_n(row.clone(), 10)).collect();
    let (once, ten) = (Data::new(rows).unwrap(), Data::new(tenfold).unwrap());
    let width = |data: &Data, groups: Vec<usize>| {
        let found = bootstrap(data, &groups, Link::Probit, 400, 7);
        assert!(found.fits.len() + found.without == 400 && found.fits.len() > 390);
        let interval = found.interval(0.9, |fit| fit.median().ln());
        assert!(interval.low.unwrap() < 0.1 && interval.high.unwrap() > -0.1);
        interval.high.unwrap() - interval.low.unwrap()
    };
    let alone = width(&once, (0..60).collect());
    let grouped = width(&ten, (0..600).map(|row| row / 10).collect());
    let apart = width(&ten, (0..600).collect());
    assert_eq!(alone, grouped);
    assert!((0.25..0.4).contains(&(apart / alone)), "{}, expected about 1/√10", apart / alone);
    // Beside the standard error of the fit: 2 · 1.645 of it.
    let fit = once.fit(Link::Probit).unwrap();
    let [b, var] = [fit.coefficients[1], fit.covariance[0][0]];
    assert!((0.6..1.8).contains(&(alone / (2.0 * 1.645 * var.sqrt() / b))), "{}", alone / (3.29 * var.sqrt() / b));
}
