//! Fragility curves of synthetic data with known parameters.

use crate::program::{program, refused, stdout, succeeds};
use crate::studies::labels;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rocking_studies::fragility::{Data, Interval, LikelihoodProfile, Link, Observation, bootstrap, sufficiency};

/// Random numbers, uniform in 0 to 1.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || (random.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
}

/// Rows with measures within half a decade of 1, and random outcomes from a curve of this median and dispersion.
fn synthetic(link: Link, median: f64, dispersion: f64, rows: usize, seed: u64) -> Vec<Observation> {
    let mut uniform = uniform(seed);
    let row = |_| {
        let measure = (2.4 * (uniform() - 0.5)).exp();
        let probability = link.probability((measure / median).ln() / dispersion);
        Observation::of(&[measure], uniform() < probability)
    };
    (0..rows).map(row).collect()
}

/// Assigns each row its own record.
fn records_of_rows(data: &Data) -> Vec<usize> {
    (0..data.observations().len()).collect()
}

/// Of 1000 intervals of 95 %, 950 ± 23 contain the true value.
///
/// The tolerance is 3.3 standard deviations of the binomial distribution, exceeded by chance once in a thousand.
#[test]
fn the_true_curve_is_within_its_band_in_95_of_100_trials() {
    const TRIALS: u64 = 1000;
    for (link, [median, dispersion]) in [(Link::Probit, [1.1, 0.4]), (Link::Logit, [0.9, 0.35])] {
        let trials = (0..TRIALS).into_par_iter().map(|trial| {
            let data = Data::new(synthetic(link, median, dispersion, 100, trial)).unwrap();
            let fit = data.fit(link).unwrap();
            let profile = LikelihoodProfile::new(&data, &fit, 0.95, &records_of_rows(&data)).unwrap();
            let exact = link.probability((0.7 / median).ln() / dispersion);
            [
                is_inside(profile.median(), median),
                is_inside(profile.dispersion(), dispersion),
                is_inside(profile.probability(0.7), exact),
            ]
            .map(u64::from)
        });
        let held = trials.reduce(|| [0; 3], |a, b| [0, 1, 2].map(|i| a[i] + b[i]));
        let spread = 3.3 * (TRIALS as f64 * 0.95 * 0.05).sqrt();
        for count in held {
            assert!((count as f64 - 950.0).abs() < spread, "{link}: {held:?} of 1000, expected 950 ± {spread:.0}");
        }
    }
}

/// Whether a value lies inside an interval.
fn is_inside([low, high]: Interval, value: f64) -> bool {
    low.is_none_or(|low| low <= value) && high.is_none_or(|high| value <= high)
}

/// Records of a population with median capacity 1.
///
/// The capacity of a record is lognormal with deviation 0.35, and its rows scatter about it by 0.2. Over all records the
/// curve is lognormal with deviation √(0.35² + 0.2²).
fn population(records: usize, levels: usize, seed: u64) -> (Vec<Observation>, Vec<usize>) {
    let mut uniform = uniform(seed);
    let mut normal = move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
    let mut found = (Vec::new(), Vec::new());
    for record in 0..records {
        let capacity = 0.35 * normal();
        for level in 0..levels {
            let measure = (2.4 * ((level as f64 + 0.5) / levels as f64 - 0.5)).exp();
            found.0.push(Observation::of(&[measure], measure.ln() > capacity + 0.2 * normal()));
            found.1.push(record);
        }
    }
    found
}

/// With 21 records at ten levels each, only intervals clustered by record have the coverage that they claim.
///
/// Intervals for independent rows contain the population's curve in far fewer than 95 of 100 trials.
#[test]
fn intervals_clustered_by_record_cover_the_population() {
    const TRIALS: u64 = 400;
    let dispersion = 0.35_f64.hypot(0.2);
    let at_07 = Link::Probit.probability(0.7_f64.ln() / dispersion);
    let held = |by_record: bool| {
        let trials = (0..TRIALS).into_par_iter().map(|trial| {
            let (observations, records) = population(21, 10, trial);
            let data = Data::new(observations).unwrap();
            let fit = data.fit(Link::Probit).unwrap();
            let records = if by_record { records } else { records_of_rows(&data) };
            let profile = LikelihoodProfile::new(&data, &fit, 0.95, &records).unwrap();
            let found = [profile.median(), profile.dispersion(), profile.probability(0.7)];
            [0, 1, 2].map(|i| u64::from(is_inside(found[i], [1.0, dispersion, at_07][i])))
        });
        trials.reduce(|| [0; 3], |a, b| [0, 1, 2].map(|i| a[i] + b[i])).map(|count| count as f64 / TRIALS as f64)
    };
    let (rows, records) = (held(false), held(true));
    assert!(rows[0] < 0.8 && rows[2] < 0.85, "{rows:?}");
    // 0.95 ± 3.3 standard deviations of the binomial distribution.
    assert!(records.iter().all(|part| (part - 0.95).abs() < 0.036), "{records:?}");
}

/// At both ends of an interval the log-likelihood has fallen by the amount that the confidence allows.
///
/// The test finds the maximum with the feature fixed there by a fine search over the other coefficient.
#[test]
fn intervals_end_at_the_likelihood_that_the_confidence_allows() {
    let data = Data::new(synthetic(Link::Logit, 1.0, 0.3, 80, 5)).unwrap();
    let fit = data.fit(Link::Logit).unwrap();
    let profile = LikelihoodProfile::new(&data, &fit, 0.9, &records_of_rows(&data)).unwrap();
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
    // 90 % quantile of χ² with one degree of freedom.
    let allowed = fit.log_likelihood - 0.5 * 2.705_543_454_095_404;
    for end in profile.median() {
        let log_median = end.unwrap().ln();
        assert!((best(&|b| log_likelihood(-b * log_median, b)) - allowed).abs() < 1e-6);
    }
    for end in profile.dispersion() {
        assert!((best(&|a| log_likelihood(a, 1.0 / end.unwrap())) - allowed).abs() < 1e-6);
    }
    for end in profile.probability(1.3) {
        let predictor = (end.unwrap() / (1.0 - end.unwrap())).ln();
        assert!((best(&|b| log_likelihood(predictor - b * 1.3_f64.ln(), b)) - allowed).abs() < 1e-6);
    }
}

/// If outcomes do not depend on the measure, the data bound neither the median nor, from above, the dispersion.
#[test]
fn unbounded_intervals_have_no_end() {
    let rows = [(1.0, false), (1.0, true), (2.0, true), (2.0, false), (3.0, true), (3.0, false), (3.0, true)];
    let data = Data::new(rows.map(|(measure, exceeded)| Observation::of(&[measure], exceeded)).to_vec()).unwrap();
    let fit = data.fit(Link::Probit).unwrap();
    let profile = LikelihoodProfile::new(&data, &fit, 0.95, &records_of_rows(&data)).unwrap();
    assert_eq!(profile.median(), [None; 2]);
    assert_eq!(profile.dispersion().map(|end| end.is_some()), [true, false]);
    let [low, high] = profile.probability(2.0).map(Option::unwrap);
    assert!(0.0 < low && high < 1.0);
    let counts = [[1.0, 1.0], [2.0, 1.0], [1.0, 3.0]].map(|measures| Observation::counted(&measures, 1, 2));
    let surface = Data::new(counts.to_vec()).unwrap();
    let refused = LikelihoodProfile::new(&surface, &fit, 0.95, &[0, 1, 2]).err().map(|error| error.to_string());
    assert_eq!(refused.as_deref(), Some("found 2 measures in row 0; expected 1 for a curve"));
}

/// A measure that determines the outcomes is sufficient beside an unrelated one, but not conversely.
///
/// Beside an unrelated measure p-values are uniformly distributed.
#[test]
fn sufficiency_finds_the_measure_that_determines_outcomes() {
    let mut below = [0_u32; 4];
    for trial in 0..400 {
        let rows = synthetic(Link::Probit, 1.0, 0.4, 150, trial);
        let mut uniform = uniform(10_000 + trial);
        let others: Vec<f64> = rows.iter().map(|_| 0.5 + uniform()).collect();
        let alone: Vec<usize> = (0..rows.len()).collect();
        let p = sufficiency(&Data::new(rows.clone()).unwrap(), &others, Link::Probit, &alone).unwrap();
        below[((4.0 * p) as usize).min(3)] += 1;
        let swapped = rows
            .iter()
            .zip(&others)
            .map(|(row, &other)| Observation { measures: [other].as_slice().into(), ..row.clone() });
        let measures: Vec<f64> = rows.iter().map(|row| row.measures[0]).collect();
        assert!(sufficiency(&Data::new(swapped.collect()).unwrap(), &measures, Link::Probit, &alone).unwrap() < 1e-6);
    }
    // χ² with 3 degrees of freedom exceeds 16.3 once in a thousand.
    let chi: f64 = below.iter().map(|&count| (f64::from(count) - 100.0).powi(2) / 100.0).sum();
    assert!(chi < 16.3, "{below:?}");
}

/// Rows repeated ten times add no information: a bootstrap of groups respects this, a bootstrap of rows does not.
#[test]
fn a_bootstrap_of_groups_ignores_repeated_rows() {
    let rows = synthetic(Link::Probit, 1.0, 0.4, 60, 3);
    let tenfold: Vec<Observation> = rows.iter().flat_map(|row| std::iter::repeat_n(row.clone(), 10)).collect();
    let (once, ten) = (Data::new(rows).unwrap(), Data::new(tenfold).unwrap());
    let width = |data: &Data, groups: Vec<usize>| {
        let found = bootstrap(data, &groups, Link::Probit, 400, 7).unwrap();
        assert!(found.fits.len() + found.without == 400 && found.fits.len() > 390);
        let [low, high] = found.interval(0.9, |fit| fit.median().ln()).map(Option::unwrap);
        assert!(low < 0.1 && high > -0.1);
        high - low
    };
    let alone = width(&once, (0..60).collect());
    let grouped = width(&ten, (0..600).map(|row| row / 10).collect());
    let apart = width(&ten, (0..600).collect());
    // The sums of repeated rows have another round-off.
    assert!((grouped / alone - 1.0).abs() < 1e-12, "{grouped} beside {alone}");
    assert!((0.25..0.4).contains(&(apart / alone)), "{}, expected about 1/√10", apart / alone);
    // For comparison, 2 · 1.645 standard errors of the fit.
    let fit = once.fit(Link::Probit).unwrap();
    let [b, var] = [fit.coefficients[1], fit.covariance[(0, 0)]];
    assert!((0.6..1.8).contains(&(alone / (2.0 * 1.645 * var.sqrt() / b))), "{}", alone / (3.29 * var.sqrt() / b));
}

/// A table like that of a sweep, with outcomes from a curve of median 0.6 m/s; some runs failed or separated.
fn table(rows: usize) -> String {
    let observations = synthetic(Link::Probit, 1.0, 0.5, rows, 42);
    let mut uniform = uniform(43);
    let mut text =
        String::from("# a study\nrow,p [rad/s],record,vertical,PGV [m/s],T_m [s],outcome,peak.theta/alpha [1]\n");
    for (row, observation) in observations.iter().enumerate() {
        let pgv = 0.6 * observation.measures[0];
        let (outcome, peak) = match (row % 40, observation.fraction == 1.0) {
            (7, _) => ("failed", 0.1),
            (8, _) => ("separated", 0.2),
            (_, true) => ("overturned", 7.8),
            (_, false) => ("completed", 0.5 * pgv * (0.6 + 0.8 * uniform())),
        };
        text += &format!("{row},{},r{},,{pgv},{},{outcome},{peak}\n", 1 + row % 2, row % 25, 0.3 + uniform());
    }
    text
}

#[test]
fn the_program_finds_the_true_curve_and_counts_omitted_rows() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table(400)).unwrap();
    let arguments = ["fragility", "t.csv", "--im", "PGV", "--im", "T_m [s]", "--beside", "p", "--ci", "0.9"];
    let printed = stdout(folder.path(), &arguments);
    assert!(printed.contains("400 rows, 10 failed, 10 ended at separation\n"), "{printed}");
    assert!(printed.contains("of 380 rows, in ") && printed.contains("intervals of 90 %"), "{printed}");
    let json = stdout(folder.path(), &[&arguments[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let (pgv, period) = (&json["measures"][0], &json["measures"][1]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert_eq!((pgv["im"].as_str(), period["im"].as_str()), (Some("PGV [m/s]"), Some("T_m [s]")));
    assert!((0.5..0.7).contains(&number(&pgv["median"])) && (0.4..0.65).contains(&number(&pgv["beta"])), "{pgv}");
    for (value, interval) in [("median", "median_interval"), ("beta", "beta_interval")] {
        let ends = [0, 1].map(|end| number(&pgv[interval][end]));
        assert!(ends[0] < number(&pgv[value]) && number(&pgv[value]) < ends[1]);
    }
    // PGV predicts the outcomes, T_m does not; p adds nothing to PGV.
    assert!(number(&pgv["AUC"]) > 0.8 && (0.4..0.65).contains(&number(&period["AUC"])));
    assert!(number(&pgv["Brier"]) < number(&period["Brier"]));
    assert!(number(&pgv["sufficiency"]["p"]) > 0.01);
    assert_eq!(number(&json["rows"]["decided"]), 380.0);
    let some = stdout(folder.path(), &["fragility", "t.csv", "--im", "PGV", "--where", "p=1", "--json"]);
    assert!(some.contains("\"all\":200,"), "{some}");
    // Records are independent here, so a bootstrap of records gives intervals of similar width.
    let boot = ["fragility", "t.csv", "--im", "PGV", "--bootstrap", "200", "--seed", "3", "--ci", "0.9", "--json"];
    let text = stdout(folder.path(), &boot);
    assert_eq!(text, stdout(folder.path(), &boot));
    let boot: serde_json::Value = serde_json::from_str(&text).unwrap();
    let width = |of: &serde_json::Value| (number(&of["median_interval"][1]) / number(&of["median_interval"][0])).ln();
    assert!((0.6..1.6).contains(&(width(&boot["measures"][0]) / width(pgv))), "{boot}");
}

/// Efficiency ignores blocks that did not lift off, and those at the edge of uplift with peaks down to 1e-13.
///
/// The report has the number of blocks that remain.
#[test]
fn efficiency_covers_the_blocks_that_rocked() {
    let folder = tempfile::tempdir().unwrap();
    let rocking: Vec<String> = table(300)
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| format!("{line},{}", if line.starts_with("row") { "events.liftoffs [1]" } else { "3" }))
        .collect();
    let still = (0..60).map(|row| format!("{row},1,r{row},,0.{},0.5,completed,0.02,0", 10 + row));
    let trembling = (0..60).map(|row| format!("{row},1,r{row},,0.{},0.5,completed,1e-{},9", 10 + row, 4 + row % 9));
    let more = rocking.iter().cloned().chain(still).chain(trembling).collect::<Vec<_>>().join("\n");
    let of = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        let json = stdout(folder.path(), &["fragility", name, "--im", "PGV", "--json"]);
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        json["measures"][0].clone()
    };
    let (alone, among) = (of("rocking.csv", &rocking.join("\n")), of("all.csv", &more));
    assert_eq!(among["efficiency"], alone["efficiency"]);
    assert_eq!(among["rocking"], alone["rocking"]);
    assert_eq!(among["rows"].as_u64().unwrap(), alone["rows"].as_u64().unwrap() + 120);
    let words = stdout(folder.path(), &["fragility", "all.csv", "--im", "pgv"]);
    let rocking = among["rocking"].as_u64().unwrap();
    assert!(rocking > 50 && words.contains(&format!("  {rocking}")), "{words}");
}

/// A probability that falls as the measure grows is no fragility, which the median and the sign of beta alone do not say.
#[test]
fn a_falling_curve_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("row,PGV [m/s],PGV/PGA [s],outcome\n");
    for (row, observation) in synthetic(Link::Probit, 0.6, 0.5, 100, 11).iter().enumerate() {
        let outcome = if observation.fraction == 1.0 { "overturned" } else { "completed" };
        text += &format!("{row},{},{},{outcome}\n", observation.measures[0], 0.1 / observation.measures[0]);
    }
    std::fs::write(folder.path().join("t.csv"), text).unwrap();
    let arguments = ["fragility", "t.csv", "--im", "PGV", "--im", "PGV/PGA"];
    let (_, warned) = succeeds(&mut program(folder.path(), &[&arguments]));
    let words =
        "rocking: warning: PGV/PGA [s]: the probability of exceeding the limit falls as the measure grows (beta -0.";
    assert!(warned.starts_with(words) && warned.lines().count() == 1, "{warned}");
    let json = stdout(folder.path(), &[&arguments[..], &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json["warnings"][0].as_str().unwrap().starts_with("PGV/PGA [s]: the probability"), "{json}");
}

/// A bootstrap of few records has no intervals, like the profile likelihood of two, and the report says why.
#[test]
fn a_bootstrap_of_few_records_has_no_intervals() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("hazard.csv"), "PGV [m/s],rate [1/year]\n0.1,1e-2\n1,1e-4\n").unwrap();
    let warning = |count: usize| {
        format!("no intervals: a bootstrap of {count} records understates the scatter; expected at least 10 records")
    };
    for (count, few) in [(2, true), (9, true), (10, false)] {
        let mut text = String::from("row,record,PGV [m/s],PGA [m/s2],outcome\n");
        for (row, observation) in synthetic(Link::Probit, 0.6, 0.5, 200, 11).iter().enumerate() {
            let outcome = if observation.fraction == 1.0 { "overturned" } else { "completed" };
            let pgv = observation.measures[0];
            text += &format!("{row},r{},{pgv},{},{outcome}\n", row % count, 10.0 * pgv);
        }
        std::fs::write(folder.path().join("t.csv"), text).unwrap();
        let common = ["t.csv", "--im", "PGV", "--bootstrap", "50"];
        let arguments = [&["fragility"], &common[..], &["--im", "PGA"]].concat();
        let (printed, warned) = succeeds(&mut program(folder.path(), &[&arguments]));
        assert_eq!(printed.matches("(? to ?)").count(), if few { 4 } else { 0 }, "{printed}");
        assert_eq!(warned.matches(&warning(count)).count(), usize::from(few), "{warned}");
        let json = stdout(folder.path(), &[&arguments[..], &["--json"]].concat());
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["measures"][0]["median_interval"][0].is_null(), few);
        assert_eq!(json["warnings"].as_array().unwrap().len(), usize::from(few));
        let rate = [&["rate", "hazard.csv", "--table"], &common[..]].concat();
        let (printed, warned) = succeeds(&mut program(folder.path(), &[&rate]));
        assert_eq!(printed.contains("per year (95 % interval ? to ?)"), few, "{printed}");
        assert_eq!(warned.contains(&warning(count)), few, "{warned}");
    }
}

/// The report names the units that its intervals treat as independent.
#[test]
fn the_report_names_the_method_of_the_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let printed = |name: &str, of: &dyn Fn(usize) -> String, more: &[&str]| {
        let lines = table(200);
        let with = |(row, line): (usize, &str)| match row {
            0 | 1 => line.to_string(),
            _ => {
                let mut fields: Vec<String> = line.split(',').map(String::from).collect();
                fields[2] = of(row);
                fields.join(",")
            }
        };
        let text = lines.lines().enumerate().map(with).collect::<Vec<_>>().join("\n");
        std::fs::write(folder.path().join(name), text).unwrap();
        stdout(folder.path(), &[&["fragility", name, "--im", "PGV"], more].concat())
    };
    let by_record = printed("records.csv", &|row| format!("r{}", row % 7), &[]);
    assert!(by_record.contains("intervals of 95 %: profile likelihood, clustered by 7 records\n"), "{by_record}");
    let bootstrap = printed("records.csv", &|row| format!("r{}", row % 7), &["--bootstrap", "9"]);
    assert!(bootstrap.contains("95 %: 9 bootstrap samples, clustered by 7 records\n"), "{bootstrap}");
    let independent = printed("rows.csv", &|row| format!("r{row}"), &[]);
    assert!(independent.contains("95 %: profile likelihood, rows independent\n"), "{independent}");
    // Rows without records do not share any.
    let none = printed("none.csv", &|_| String::new(), &[]);
    assert!(none.contains("rows independent"), "{none}");
    let one = printed("one.csv", &|_| "r".into(), &[]);
    assert!(one.contains("for the only record"), "{one}");
}

#[test]
fn the_picture_shows_curve_band_and_rows() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table(200)).unwrap();
    let limit = ["--limit", "theta/alpha>0.25"];
    stdout(folder.path(), &[&["fragility", "t.csv", "--im", "PGV", "--plot", "c.svg"], &limit[..]].concat());
    let svg = std::fs::read_to_string(folder.path().join("c.svg")).unwrap();
    let found = labels(&svg);
    for label in ["probability of |θ|/α > 0.25", "PGV (m/s)", "95 % confidence", "lognormal fragility"] {
        assert!(found.iter().any(|known| known == label), "{label}: {found:?}");
    }
    // The picture has the numbers of rows in each of twelve groups.
    let counts: usize = found.iter().filter_map(|label| label.parse::<usize>().ok()).filter(|&count| count > 10).sum();
    let printed = stdout(folder.path(), &[&["fragility", "t.csv", "--im", "PGV"], &limit[..]].concat());
    assert!(printed.contains(&format!(" of {counts} rows")), "{counts}: {printed}");
}

#[test]
fn data_without_information_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("t.csv", &table(60));
    let head = "row,record,PGV [m/s],outcome,peak.theta/alpha [1]\n";
    write("one.csv", &format!("{head}0,a,0.5,completed,0.1\n1,a,0.6,completed,0.2\n"));
    write("apart.csv", &format!("{head}0,a,0.5,completed,0.1\n1,b,0.6,overturned,7\n"));
    write("zero.csv", &format!("{head}0,a,0,completed,0.1\n1,b,0.6,overturned,7\n"));
    let cases: [(&[&str], &[&str]); 9] = [
        (&["one.csv", "--im", "PGV"], &["one.csv: PGV: found one class", "not exceeded in all 2 rows"]),
        (&["apart.csv", "--im", "PGV"], &["apart.csv: PGV: found separable data", "up to 0.5", "from 0.6 on"]),
        (&["zero.csv", "--im", "PGV"], &["zero.csv: PGV: found the measure 0 in row 0"]),
        (&["t.csv", "--im", "PGA"], &["t.csv: has no column PGA"]),
        (&["t.csv", "--im", "record"], &["t.csv: row 0 has record = r0; expected a number"]),
        (&["t.csv", "--im", "PGV", "--where", "p=9"], &["found no row with p = 9"]),
        (&["t.csv", "--im", "PGV", "--where", "record=r1", "--where", "p"], &["--where p; expected COLUMN=VALUE"]),
        (&["t.csv", "--im", "PGV", "--ci", "1"], &["--ci", "below 1"]),
        (&["t.csv", "--im", "PGV", "--im", "T_m", "--plot", "x.svg"], &["--plot with 2 measures"]),
    ];
    for (arguments, words) in cases {
        refused(folder.path(), &[&["fragility"], arguments].concat(), words);
    }
    let alone =
        table(60).lines().filter(|line| line.contains(",r3,") || line.contains("row,")).collect::<Vec<_>>().join("\n");
    write("alone.csv", &(alone + "\n90,1,r3,,0.2,1,overturned,7\n91,1,r3,,2,1,completed,1\n"));
    refused(folder.path(), &["fragility", "alone.csv", "--im", "PGV", "--bootstrap", "9"], &["found 1 ground motion"]);
    assert!(!folder.path().join("x.svg").exists());
}

/// Peaks grow with the level, and every other record overturns from 0.8 m/s on; draws fractiles and a surface.
#[test]
fn curves_over_levels_and_surfaces_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let mut text =
        String::from("row,p [rad/s],record,vertical,scale [1],PGV [m/s],T_m [s],outcome,peak.theta/alpha [1]\n");
    let mut uniform = uniform(1);
    for row in 0..100 {
        let (record, level) = (row / 10, 0.2 * f64::from(row % 10 + 1));
        let outcome = if level > 0.7 && record % 2 == 0 && uniform() < 0.8 { "overturned" } else { "completed" };
        let period = 0.4 + 0.1 * f64::from(record) + 0.2 * uniform();
        text += &format!("{row},2,r{record},,1,{level},{period},{outcome},{}\n", 0.3 * level);
    }
    std::fs::write(folder.path().join("t.csv"), text.as_bytes()).unwrap();
    let common = ["fragility", "t.csv", "--im", "PGV"];
    let more = ["--ida", "ida.svg", "--surface", "T_m", "--plot", "surface.svg"];
    let printed = stdout(folder.path(), &[&common[..], &more].concat());
    assert!(printed.contains("surface       of 100 rows: ("), "{printed}");
    let found = |name: &str| labels(&std::fs::read_to_string(folder.path().join(name)).unwrap());
    for (name, label) in [
        ("ida.svg", "10 curves, 10 levels; overturning counts as more than any peak"),
        ("ida.svg", "peak |θ|/α"),
        ("ida.svg", "PGV (m/s)"),
        ("surface.svg", "Tm (s)"),
        ("surface.svg", "probability of overturning, 100 rows"),
    ] {
        assert!(found(name).iter().any(|known| known == label), "{label}: {:?}", found(name));
    }
    let scales = text.replacen("2,r3,,1,0.2,", "2,r3,,1,0.21,", 1);
    std::fs::write(folder.path().join("scales.csv"), scales).unwrap();
    // Curves with levels of their own.
    stdout(folder.path(), &["fragility", "scales.csv", "--im", "PGV", "--ida", "scales.svg"]);
    assert!(found("scales.svg").contains(&"10 curves, 100 runs; overturning counts as more than any peak".to_string()));
    refused(folder.path(), &[&common[..], &["--im", "T_m", "--surface", "p"]].concat(), &["--surface with 2 measures"]);
    assert!(!folder.path().join("x.svg").exists());
}

/// Samples of ensembles without a known outcome widen the range of the exceeded rows, as whole rows do.
#[test]
fn unknown_samples_give_a_range() {
    let folder = tempfile::tempdir().unwrap();
    let heading = "row,PGV [m/s],outcome,peak.theta/alpha [1],ensemble.samples [1],ensemble.overturned [1],\
                   ensemble.unknown(overturned) [1],P(overturned) [1]";
    let rows = [(0, 0), (1, 4), (3, 0), (0, 8), (4, 2), (7, 0)];
    let line = |(row, (exceeded, unknown)): (usize, (i32, i32))| {
        let end = if unknown == 8 { "undecided" } else { "completed" };
        let fraction =
            if unknown < 8 { (f64::from(exceeded) / f64::from(8 - unknown)).to_string() } else { String::new() };
        format!("{row},{},{end},0.5,8,{exceeded},{unknown},{fraction}\n", 0.1 * (row + 1) as f64)
    };
    let table: String = rows.into_iter().enumerate().map(line).collect();
    std::fs::write(folder.path().join("s.csv"), format!("{heading}\n{table}")).unwrap();
    let arguments = ["fragility", "s.csv", "--im", "PGV"];
    let text = stdout(folder.path(), &arguments);
    assert!(text.contains("exceeded in 1.9 of 5 rows, in 1.9 to 3.6 of all 6"), "{text}");
    let report = stdout(folder.path(), &[&arguments[..], &["--json"]].concat());
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let count = |name: &str| report["rows"][name].as_f64().unwrap();
    assert_eq!(["exceeded", "exceeded_at_most", "partly_known"].map(count), [15.0 / 8.0, 29.0 / 8.0, 2.0]);
    assert_eq!(
        report["warnings"][0],
        "1 undecided rows may exceed the limit and are left out of curves; in 2 rows, samples without a known outcome may exceed the limit and \
         are left out of its probability: it is exceeded in 31.2 % to 60.4 % of all rows"
    );
}
