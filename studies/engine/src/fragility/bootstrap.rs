//! Observations of several records → curves of resampled records.

use chacha20::rand_core::Rng;

use crate::fragility::data::Data;
use crate::fragility::likelihood::Link;
use crate::fragility::observation::CurveFitError;
use crate::fragility::profile::Interval;
use crate::fragility::regression::CurveFit;
use crate::statistics::{quantile, sampling};

/// Least number of groups for intervals.
///
/// Few resampled groups understate the scatter: of two, half the samples hold one alone, and the others are the original data.
/// Standard tests reject true hypotheses too often with five to thirty clusters (A. C. Cameron, J. B. Gelbach, D. L. Miller,
/// Bootstrap-based improvements for inference with clustered errors, Rev. Econ. Stat. 90 (2008) 414–427); ten is a compromise.
pub(super) const MIN_GROUPS: usize = 10;

/// The curves of resampled records.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// The curves of the samples that have one.
    pub fits: Vec<CurveFit>,
    /// Number of samples without a curve: a single class, or classes that do not overlap.
    pub without: usize,
    /// Number of groups: records, or rows where no record repeats.
    pub groups: usize,
}

impl Bootstrap {
    /// Whether all curves are the same to round-off, as of groups with equal rows: their scatter is no knowledge.
    pub fn is_too_alike(&self) -> bool {
        /// Relative difference of coefficients.
        const ROUND_OFF: f64 = 1e-9;
        let Some((first, others)) = self.fits.split_first() else { return false };
        let first = &first.coefficients;
        others.iter().all(|other| (&other.coefficients - first).norm() <= ROUND_OFF * first.norm())
    }

    /// The central interval of this fraction of a feature's values. It is unbounded for fewer than two curves or ten groups, and for curves
    /// that are all the same.
    pub fn interval(&self, confidence: f64, of: impl Fn(&CurveFit) -> f64) -> Interval {
        let mut values: Vec<f64> = self.fits.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        if values.len() < 2 || self.groups < MIN_GROUPS || self.is_too_alike() {
            return [None; 2];
        }
        [-0.5, 0.5].map(|side| Some(quantile(&values, 0.5 + side * confidence)))
    }
}

/// Fits curves to groups of observations drawn with replacement. Each sample has the original number of groups.
///
/// B. Efron, Bootstrap methods: another look at the jackknife, Ann. Stat. 7 (1979) 1–26. `groups` has the group of each
/// observation, such as its record; rows of a group are not independent of each other and stay together. The same seed gives the
/// same curves on every machine: ChaCha with 8 rounds, one stream per sample.
///
/// # Errors
/// Fewer than two groups.
pub fn bootstrap(
    data: &Data,
    groups: &[usize],
    link: Link,
    samples: u32,
    seed: u64,
) -> Result<Bootstrap, CurveFitError> {
    let count = groups.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    for (observation, &group) in data.observations().iter().zip(groups) {
        members[group].push(observation);
    }
    let members: Vec<_> = members.into_iter().filter(|members| !members.is_empty()).collect();
    if members.len() < 2 {
        return Err(CurveFitError::one_motion(members.len()));
    }
    let mut found = Bootstrap { fits: Vec::new(), without: 0, groups: members.len() };
    for sample in 0..samples {
        let mut random = sampling::stream(seed, sample.into());
        // The bias of the remainder of 64 bits is below 2⁻³².
        let mut draw = || &members[(random.next_u64() % members.len() as u64) as usize];
        let drawn = (0..members.len()).flat_map(|_| draw().iter().map(|&row| row.clone())).collect();
        match Data::new(drawn).and_then(|data| data.fit(link)) {
            Ok(fit) => found.fits.push(fit),
            Err(_) => found.without += 1,
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::Observation;

    /// Every draw from groups with equal rows gives the same curve: that is no interval, and a group that differs makes one.
    #[test]
    fn groups_that_agree_give_no_interval_of_zero_width() {
        // Of each group, 0, 1, 2 and 3 of 3 rows at four levels exceed the limit; of the last, one fewer.
        let of = |last: i32| {
            let exceeds = |group: i32, i: i32| i % 3 < i / 3 - i32::from(group == 11 && i == last);
            let rows = (0..12).flat_map(|group| (0..12).map(move |i| (group, i)));
            let rows = rows.map(|(group, i)| Observation::of(&[f64::from(1 + i / 3)], exceeds(group, i))).collect();
            let groups: Vec<usize> = (0..144).map(|row| row / 12).collect();
            bootstrap(&Data::new(rows).unwrap(), &groups, Link::Probit, 40, 1).unwrap()
        };
        let alike = of(-1);
        assert!(alike.is_too_alike() && alike.fits.len() == 40);
        assert_eq!(alike.interval(0.9, CurveFit::median), [None; 2]);
        let [low, high] = of(3).interval(0.9, CurveFit::median).map(Option::unwrap);
        assert!(low < high, "{low} {high}");
    }
}
