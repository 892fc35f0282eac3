//! Distributions of what is not known exactly → samples of a run, and the probability of what they do.
//!
//! Whether a rocking block overturns under a given record is next to chance: a change of the record by one percent turns four
//! outcomes in a hundred (docs/fragility.md). What can be predicted is a probability, over small changes that nobody knows.

use crate::study::normal;
use crate::study::outcome::{End, Outcome};
use crate::study::parameters::Parameter;
use crate::study::sampling::shuffled;

/// The samples of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    /// How many, at least one.
    pub samples: u32,
    /// From which follows how the values of several spreads are combined.
    pub seed: u64,
    /// What is spread, at least one.
    pub spreads: Vec<Spread>,
    /// Limits on |θ|/α (1) of which it is counted how often they are exceeded.
    pub limits: Vec<f64>,
}

/// What is not known exactly, and how much.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// What it is.
    pub of: Spreading,
    /// Its distribution.
    pub distribution: Distribution,
    /// How wide that is.
    pub width: Width,
}

/// What an ensemble spreads.
#[derive(Clone, Debug, PartialEq)]
pub enum Spreading {
    /// The factor on the records.
    Scale,
    /// A parameter of the block, its beginning or the pulse.
    Parameter(Parameter),
}

/// A distribution about the value of the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Between two values at the same distance from the row's.
    Uniform,
    /// The row's value is the mean.
    Normal,
    /// The row's value is the median; it keeps its sign.
    Lognormal,
}

/// The standard deviation of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// Beside the row's value: the coefficient of variation (1), for a lognormal distribution standard deviation over mean.
    Relative(f64),
    /// In the unit of the value; for a lognormal distribution `Relative` of it over the row's value.
    Absolute(f64),
}

impl Spread {
    /// The value below which lies this part of the distribution, above 0 and below 1, where the row has `nominal`.
    pub fn value(&self, nominal: f64, part: f64) -> f64 {
        let (relative, deviation) = match self.width {
            Width::Relative(relative) => (relative, relative * nominal.abs()),
            Width::Absolute(deviation) => (deviation / nominal.abs(), deviation),
        };
        match self.distribution {
            Distribution::Uniform => nominal + deviation * 3.0_f64.sqrt() * (2.0 * part - 1.0),
            Distribution::Normal => nominal + deviation * normal::quantile(part),
            Distribution::Lognormal => {
                nominal * libm::exp(libm::log1p(relative * relative).sqrt() * normal::quantile(part))
            }
        }
    }
}

impl Ensemble {
    /// Where the samples of a row lie in the distributions: for each sample the part of each spread's distribution below it.
    ///
    /// The values of a spread are the middles of as many strata of the same probability, `(i + ½)/n`, in each row: for the
    /// part of a distribution beyond a threshold this is off by 1/(2n) at most, and by less in the mean than random places
    /// in the strata, or anywhere. Which values of several spreads meet is drawn for each row: a Latin hypercube.
    pub fn parts(&self, row: u64) -> Vec<Vec<f64>> {
        let directions = self.spreads.len() as u64;
        let strata: Vec<Vec<u32>> = (0..directions)
            .map(|direction| match direction {
                0 => (0..self.samples).collect(),
                // Streams that no design of the same seed reads.
                _ => shuffled(self.samples, self.seed, (1 << 63) | (row * directions + direction)),
            })
            .collect();
        let middle = |stratum: u32| (f64::from(stratum) + 0.5) / f64::from(self.samples);
        (0..self.samples as usize).map(|sample| strata.iter().map(|of| middle(of[sample])).collect()).collect()
    }

    /// Names and units of the columns that [`Tally::fields`] fills.
    pub fn columns(&self) -> Vec<String> {
        let mut columns: Vec<String> =
            ["samples", "failed", "undecided", "overturned"].map(|name| format!("ensemble.{name} [1]")).into();
        columns.extend(self.limits.iter().map(|limit| format!("ensemble.theta/alpha>{limit} [1]")));
        columns.push("P(overturned) [1]".into());
        columns.extend(self.limits.iter().map(|limit| format!("P(theta/alpha>{limit}) [1]")));
        columns
    }
}

/// What the samples of a row did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    samples: u32,
    failed: u32,
    undecided: u32,
    /// Samples that overturned, and those that exceeded each limit.
    exceeded: Vec<u32>,
    /// Samples whose outcome tells whether each limit was exceeded.
    known: Vec<u32>,
}

impl Tally {
    /// Nothing yet, for so many limits.
    pub fn new(limits: usize) -> Tally {
        Tally { exceeded: vec![0; 1 + limits], known: vec![0; 1 + limits], ..Tally::default() }
    }

    /// Counts a sample of a block of slenderness α (rad). One that overturns exceeds every limit. One that fails tells nothing,
    /// one that is undecided only of the limits that it has exceeded.
    pub fn add(&mut self, outcome: &Outcome, alpha: f64, limits: &[f64]) {
        self.samples += 1;
        self.failed += u32::from(outcome.end == End::Failed);
        self.undecided += u32::from(outcome.end == End::Undecided);
        let overturned = outcome.end == End::Overturned;
        let rotated = limits.iter().map(|limit| overturned || outcome.peaks.theta / alpha > *limit);
        for (place, exceeds) in std::iter::once(overturned).chain(rotated).enumerate() {
            let is_known = match outcome.end {
                End::Failed => false,
                End::Undecided => exceeds,
                End::Completed | End::Separated | End::Overturned => true,
            };
            self.known[place] += u32::from(is_known);
            self.exceeded[place] += u32::from(is_known && exceeds);
        }
    }

    /// The counts, and their parts of the samples that tell, as they stand in tables.
    pub fn fields(&self) -> Vec<String> {
        let part = |(&count, &known): (&u32, &u32)| match known {
            0 => String::new(),
            _ => (f64::from(count) / f64::from(known)).to_string(),
        };
        let counts = [self.samples, self.failed, self.undecided].into_iter().chain(self.exceeded.iter().copied());
        let parts = self.exceeded.iter().zip(&self.known).map(part);
        counts.map(|count| count.to_string()).chain(parts).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(distribution: Distribution, width: Width) -> Spread {
        Spread { of: Spreading::Scale, distribution, width }
    }

    /// Mean (median for the lognormal one), standard deviation, and what a relative width is relative to.
    #[test]
    fn distributions_have_the_width_that_is_asked_for() {
        const COUNT: u32 = 20_000;
        for distribution in [Distribution::Uniform, Distribution::Normal, Distribution::Lognormal] {
            for (nominal, width) in [(2.0, Width::Relative(0.3)), (-0.5, Width::Absolute(0.15))] {
                let spread = spread(distribution, width);
                let values: Vec<f64> =
                    (0..COUNT).map(|i| spread.value(nominal, (f64::from(i) + 0.5) / f64::from(COUNT))).collect();
                let mean = values.iter().sum::<f64>() / f64::from(COUNT);
                let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / f64::from(COUNT);
                assert!((variance.sqrt() / mean.abs() / 0.3 - 1.0).abs() < 2e-3, "{distribution:?} {mean} {variance}");
                assert!((spread.value(nominal, 0.5) / nominal - 1.0).abs() < 1e-15);
                if distribution != Distribution::Lognormal {
                    assert!((mean / nominal - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    /// Each stratum has one sample in each row, in an order that differs between rows and between spreads but the first.
    #[test]
    fn samples_are_the_middles_of_strata() {
        let scale = spread(Distribution::Normal, Width::Relative(0.1));
        let ensemble = Ensemble { samples: 9, seed: 4, spreads: vec![scale; 3], limits: Vec::new() };
        let of =
            |row: u64, direction: usize| ensemble.parts(row).iter().map(|parts| parts[direction]).collect::<Vec<_>>();
        let middles: Vec<f64> = (0..9).map(|i| (f64::from(i) + 0.5) / 9.0).collect();
        for (row, direction) in [(0, 0), (0, 1), (0, 2), (1, 1), (7, 2)] {
            let mut sorted = of(row, direction);
            sorted.sort_by(f64::total_cmp);
            assert_eq!(sorted, middles);
        }
        assert_eq!(of(5, 0), middles);
        assert_ne!(of(0, 1), of(0, 2));
        assert_ne!(of(0, 1), of(1, 1));
        assert_eq!(of(3, 2), of(3, 2));
    }
}
