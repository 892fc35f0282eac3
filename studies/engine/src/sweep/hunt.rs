//! The runs of a block under a record → the level of the next one. This is incremental dynamic analysis by hunt and fill.
//!
//! D. Vamvatsikos, C. A. Cornell, Applied incremental dynamic analysis, Earthquake Spectra 20 (2004) 523–553. The level rises by growing
//! steps until the block overturns; then runs close in on the level at which it does, and the others fill the widest gaps below.

/// Levels of an intensity measure, chosen one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hunt {
    /// The first level, in the unit of the measure.
    pub first: f64,
    /// The first step between levels.
    pub step: f64,
    /// The growth of each further step.
    pub growth: f64,
    /// Gap, over the least level that overturns, below which runs fill lower gaps. It extends from the greatest level that stands.
    pub resolution: f64,
    /// Number of runs.
    pub runs: u64,
}

impl Hunt {
    /// Returns the level of the run after these. Each has its level, and whether it overturned the block.
    pub fn next(&self, runs: &[(f64, bool)]) -> f64 {
        let overturned = runs.iter().filter(|run| run.1).map(|run| run.0).reduce(f64::min);
        let Some(least) = overturned else {
            let steps = runs.len() as f64;
            return self.first + steps * self.step + 0.5 * steps * (steps - 1.0) * self.growth;
        };
        // Rest without shaking stands, too.
        let standing = runs.iter().filter(|run| !run.1 && run.0 < least).map(|run| run.0);
        let mut standing: Vec<f64> = standing.chain([0.0]).collect();
        standing.sort_by(f64::total_cmp);
        let greatest = standing[standing.len() - 1];
        if least - greatest > self.resolution * least {
            return greatest + (least - greatest) / 3.0;
        }
        let widest = standing.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        // A record that overturns at once leaves no gap but the last.
        widest.map_or(0.5 * (greatest + least), |gap| 0.5 * (gap[0] + gap[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block that overturns from 1 on: hunted, enclosed, and filled below.
    #[test]
    fn levels_rise_enclose_and_fill() {
        let hunt = Hunt { first: 0.1, step: 0.2, growth: 0.1, resolution: 0.1, runs: 12 };
        let mut runs = Vec::new();
        for _ in 0..hunt.runs {
            let level = hunt.next(&runs);
            runs.push((level, level >= 1.0));
        }
        let close = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        for (run, expected) in runs.iter().zip([0.1, 0.3, 0.6, 1.0, 0.6 + 0.4 / 3.0, 0.6 + 0.4 / 3.0 + 0.8 / 9.0]) {
            assert!(close(run.0, expected), "{runs:?}");
        }
        let greatest = runs.iter().filter(|run| !run.1).map(|run| run.0).fold(0.0, f64::max);
        assert!(greatest >= 0.9, "{runs:?}");
        // The gap between 0.3 and 0.6 is the widest below.
        let filled = runs.iter().find(|run| close(run.0, 0.45));
        assert!(filled.is_some(), "{runs:?}");
        let mut levels: Vec<f64> = runs.iter().map(|run| run.0).collect();
        levels.sort_by(f64::total_cmp);
        assert!(levels.windows(2).all(|pair| pair[1] > pair[0]), "{runs:?}");
    }

    #[test]
    fn a_record_that_overturns_at_once_is_enclosed_from_below() {
        let hunt = Hunt { first: 0.5, step: 0.5, growth: 0.0, resolution: 0.1, runs: 10 };
        let mut runs = Vec::new();
        for _ in 0..hunt.runs {
            let level = hunt.next(&runs);
            runs.push((level, level >= 0.02));
        }
        let least = runs.iter().filter(|run| run.1).map(|run| run.0).fold(f64::INFINITY, f64::min);
        assert!((0.02..0.03).contains(&least), "{runs:?}");
    }
}
