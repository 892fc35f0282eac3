//! Observations of several records → how much a curve would change with other records.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

use crate::study::fragility::{Data, Fit, FitError, Interval, Link};

/// What the curves of resampled records have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// The curve of each sample that has one.
    pub fits: Vec<Fit>,
    /// Samples that have none: a single class, or classes that do not overlap.
    pub without: usize,
}

impl Bootstrap {
    /// The interval of a feature that holds this part of its values, as much left out above as below; no bounds for fewer
    /// than two curves.
    pub fn interval(&self, confidence: f64, of: impl Fn(&Fit) -> f64) -> Interval {
        let mut values: Vec<f64> = self.fits.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        if values.len() < 2 {
            return Interval { low: None, high: None };
        }
        // Between two values linearly, as most programs do.
        let at = |part: f64| {
            let place = part * (values.len() - 1) as f64;
            let below = place.floor() as usize;
            let above = (below + 1).min(values.len() - 1);
            values[below] + (place - below as f64) * (values[above] - values[below])
        };
        Interval { low: Some(at(0.5 - 0.5 * confidence)), high: Some(at(0.5 + 0.5 * confidence)) }
    }
}

/// Fits curves to samples of the groups, each drawn with replacement and as large as the whole (B. Efron, Bootstrap methods:
/// another look at the jackknife, Ann. Stat. 7 (1979) 1–26). `groups` says for each observation which group it belongs to, such
/// as its record: rows of a group are not independent of each other and stay together.
///
/// The same seed gives the same curves on every machine: ChaCha with 8 rounds, a stream for each sample.
///
/// # Errors
/// [`FitError::OneMotion`] for fewer than two groups.
pub fn bootstrap(data: &Data, groups: &[usize], link: Link, samples: u32, seed: u64) -> Result<Bootstrap, FitError> {
    let count = groups.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    for (observation, &group) in data.observations().iter().zip(groups) {
        members[group].push(observation);
    }
    let members: Vec<_> = members.into_iter().filter(|members| !members.is_empty()).collect();
    if members.len() < 2 {
        return Err(FitError::OneMotion { found: members.len() });
    }
    let mut found = Bootstrap { fits: Vec::new(), without: 0 };
    for sample in 0..samples {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(sample.into());
        // The remainder of 64 bits favours no group by more than 2⁻³².
        let mut draw = || &members[(random.next_u64() % members.len() as u64) as usize];
        let drawn = (0..members.len()).flat_map(|_| draw().iter().map(|&row| row.clone())).collect();
        match Data::new(drawn).and_then(|data| data.fit(link)) {
            Ok(fit) => found.fits.push(fit),
            Err(_) => found.without += 1,
        }
    }
    Ok(found)
}
