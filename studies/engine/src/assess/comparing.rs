//! The results of a report → the variants that help, and the assumption that matters.

use std::collections::BTreeSet;

use crate::assess::results::{Comparison, Report, Sensitivity};

impl Comparison {
    /// The least and the greatest annual rate over all outcomes of runs that have none; `None` without a greatest one.
    pub fn rates(&self) -> Option<[f64; 2]> {
        match self.rate_of_unknown {
            Some([none, all]) => Some([none.unwrap_or(0.0), all?]),
            None => self.rate.map(|rate| [rate; 2]),
        }
    }
}

impl Report {
    /// The object as it is, and its variants.
    fn plain_and_variants(&self) -> Option<(&Comparison, &[Comparison])> {
        self.variants.split_first()
    }

    /// The variants without any exceedance, of an object with some.
    pub fn without_exceedance(&self) -> Vec<&Comparison> {
        match self.plain_and_variants() {
            Some((plain, variants)) if plain.runs.exceeded > 0 => {
                variants.iter().filter(|variant| variant.runs.at_most() == 0).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The variant with the least annual rate, if the object and a variant have one. Where runs have no known outcome, the greatest rate counts.
    pub fn least_rate(&self) -> Option<&Comparison> {
        let (plain, variants) = self.plain_and_variants()?;
        plain.rates()?;
        let found = variants.iter().filter_map(|variant| Some((variant, variant.rates()?[1])));
        found.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(variant, _)| variant)
    }

    /// Whether the annual rate of a variant is below that of the object, whatever the outcome of runs without a known one.
    pub fn reduces_rate(&self, variant: &Comparison) -> bool {
        let plain = self.variants.first().and_then(Comparison::rates);
        plain.zip(variant.rates()).is_some_and(|(plain, variant)| variant[1] < plain[0])
    }

    /// The variants with the fewest runs beyond the limit, if these are fewer than those of the object. A run with an unknown outcome may
    /// exceed the limit.
    pub fn fewest_runs(&self) -> Vec<&Comparison> {
        let at_most = |variant: &&Comparison| variant.runs.at_most();
        let Some((plain, variants)) = self.plain_and_variants() else { return Vec::new() };
        match self.variants.iter().map(|variant| variant.runs.at_most()).min() {
            Some(least) if least < plain.runs.exceeded => variants.iter().filter(|of| at_most(of) == least).collect(),
            _ => Vec::new(),
        }
    }

    /// The variants that help: those without an exceedance, or else the one with the least rate, or else those with the fewest runs.
    pub fn helpful(&self) -> Vec<&Comparison> {
        let without = self.without_exceedance();
        if !without.is_empty() {
            return without;
        }
        match self.least_rate() {
            Some(variant) => Some(variant).filter(|variant| self.reduces_rate(variant)).into_iter().collect(),
            None => self.fewest_runs(),
        }
    }

    /// Number of independent ground motions: components, polarities and floors of one event at one station count once.
    pub fn independent_motions(&self) -> usize {
        self.motions.iter().map(|motion| &motion.motion).collect::<BTreeSet<_>>().len()
    }

    /// The assumption whose range changes the number of runs beyond the limit most.
    pub fn strongest_assumption(&self) -> Option<&Sensitivity> {
        self.sensitivity.iter().max_by_key(|sensitivity| sensitivity.change())
    }
}

impl Sensitivity {
    /// The change of the number of runs beyond the limit from one end of the range to the other.
    pub fn change(&self) -> usize {
        self.ends[0].runs.exceeded.abs_diff(self.ends[1].runs.exceeded)
    }
}
