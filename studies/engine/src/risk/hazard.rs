//! Levels, rates → a hazard curve.

use crate::intensity::MeasureColumn;
use crate::mismatch::Mismatch;

/// A hazard curve: the annual rate at which an intensity measure exceeds a level.
#[derive(Clone, Debug, PartialEq)]
pub struct HazardCurve {
    /// Name of the measure, such as `PGA` or `Sa(1 s)`, if known.
    pub measure: Option<String>,
    /// Unit of the levels, an SI unit if known to [`si`](crate::intensity::si).
    pub unit: Option<String>,
    /// Remarks on levels that were left out.
    pub remarks: Vec<String>,
    levels: Vec<f64>,
    rates: Vec<f64>,
}

/// Greatest rise of a rate, over the rate before, that is round-off: that of simulated catalogues and of probabilities near 1e-10.
const ROUND_OFF: f64 = 1e-5;

impl HazardCurve {
    /// Checks levels and annual rates, and drops a first level of zero, and levels at the end with rate zero.
    ///
    /// Levels must increase, from zero or more. Rates must not increase; a rise within round-off is replaced by the rate before it. At least two
    /// rates must be positive.
    ///
    /// # Errors
    /// The first level or rate that violates this.
    pub fn new(levels: &[f64], rates: &[f64]) -> Result<HazardCurve, Mismatch> {
        if levels.len() != rates.len() {
            let found = format!("{} levels and {} rates", levels.len(), rates.len());
            return Err(Mismatch::new(found, "a rate for each level"));
        }
        let mut remarks = Vec::new();
        // The logarithm of a measure needs no level 0, at which every event counts.
        let [levels, rates] = match levels.first() {
            Some(0.0) => {
                remarks.push("the level 0 was left out".to_string());
                [&levels[1..], &rates[1..]]
            }
            _ => [levels, rates],
        };
        let mut rates = rates.to_vec();
        for i in 1..rates.len() {
            if rates[i] > rates[i - 1] && rates[i] <= rates[i - 1] * (1.0 + ROUND_OFF) {
                rates[i] = rates[i - 1];
            }
        }
        for (i, (&level, &rate)) in levels.iter().zip(&rates).enumerate() {
            if !(level > 0.0 && level.is_finite() && (i == 0 || level > levels[i - 1])) {
                let expected = match i {
                    0 => "a level above 0".into(),
                    _ => format!("levels that increase, here above {}", levels[i - 1]),
                };
                return Err(Mismatch::new(format!("{level} as level {}", i + 1), expected));
            }
            if !(rate >= 0.0 && rate.is_finite() && (i == 0 || rate <= rates[i - 1])) {
                let expected = match i {
                    0 => "a rate of at least 0".into(),
                    _ => format!("rates of at least 0 that do not increase, here at most {}", rates[i - 1]),
                };
                return Err(Mismatch::new(format!("the rate {rate} at the level {level}"), expected));
            }
        }
        let positive = rates.iter().filter(|rate| **rate > 0.0).count();
        if positive < 2 {
            return Err(Mismatch::new(format!("{positive} levels with a rate above 0"), "two or more"));
        }
        if positive < levels.len() {
            remarks.push(format!(
                "{} levels from {} on have a rate of 0 and were left out",
                levels.len() - positive,
                levels[positive]
            ));
        }
        let [levels, rates] = [levels, &rates].map(|all| all[..positive].to_vec());
        Ok(HazardCurve { measure: None, unit: None, remarks, levels, rates })
    }

    /// The levels with a rate above zero.
    pub fn levels(&self) -> &[f64] {
        &self.levels
    }

    /// The annual rates of these levels.
    pub fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Multiplies the levels by a factor above zero. The factor may change the unit, or make the measure relative.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> HazardCurve {
        self.levels.iter_mut().for_each(|level| *level *= factor);
        self
    }

    /// Returns the hazard over the measure of a fragility curve, in its unit. The measure `behind` it is that of the hazard, with the
    /// factor of the former on it, as of [`MeasureColumn::behind`].
    ///
    /// # Errors
    /// A hazard curve of another measure or unit, or without a unit.
    pub fn over(
        self,
        column: &MeasureColumn,
        (behind, factor): &(MeasureColumn, f64),
    ) -> Result<HazardCurve, Mismatch> {
        if let Some(found) = self.measure.as_ref().filter(|found| **found != behind.name) {
            return Err(Mismatch::new(format!("a hazard curve of {found}"), format!("one of {}", behind.name)));
        }
        if self.unit != behind.unit {
            let found = self.unit.as_ref().map_or("levels without a unit".into(), |unit| format!("levels in {unit}"));
            let unit = behind.unit.as_deref().unwrap_or("1");
            let expected = format!("{unit}, or a unit of it, for the fragility curve over {column}");
            return Err(Mismatch::new(found, expected));
        }
        let unit = column.unit.clone().or(Some("1".into()));
        Ok(HazardCurve { measure: Some(column.name.clone()), unit, ..self.scaled(*factor) })
    }

    /// The annual rate at which this level above zero is exceeded.
    pub fn rate(&self, level: f64) -> f64 {
        let x = libm::log(level);
        let laws = self.power_laws();
        laws.iter().find(|law| x <= law.to).map_or(0.0, |law| law.rate(x))
    }

    /// The power laws between the levels, the first and the last one continued beyond.
    pub(super) fn power_laws(&self) -> Vec<PowerLaw> {
        let last = self.levels.len() - 1;
        let between = (0..last).map(|i| {
            let [from, to] = [self.levels[i], self.levels[i + 1]].map(libm::log);
            let slope = libm::log(self.rates[i] / self.rates[i + 1]) / (to - from);
            PowerLaw { from, to, at: from, rate: self.rates[i], slope }
        });
        let between: Vec<PowerLaw> = between.collect();
        let below = PowerLaw { from: f64::NEG_INFINITY, to: between[0].from, ..between[0] };
        let end = &between[last - 1];
        let above = PowerLaw { from: end.to, to: f64::INFINITY, at: end.to, rate: self.rates[last], slope: end.slope };
        std::iter::once(below).chain(between.iter().copied()).chain([above]).collect()
    }
}

/// A part of a hazard curve: `H = rate · exp(−slope (x − at))`. It holds for x = ln m between `from` and `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PowerLaw {
    pub from: f64,
    pub to: f64,
    pub at: f64,
    pub rate: f64,
    /// At least zero.
    pub slope: f64,
}

impl PowerLaw {
    pub fn rate(&self, x: f64) -> f64 {
        self.rate * libm::exp(-self.slope * (x - self.at))
    }

    /// The part between two logarithms; `None` if they lie outside.
    pub fn between(&self, from: f64, to: f64) -> Option<PowerLaw> {
        let part = PowerLaw { from: self.from.max(from), to: self.to.min(to), ..*self };
        (part.from < part.to).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_between_levels_lie_on_power_laws() {
        let hazard = HazardCurve::new(&[0.1, 0.2, 0.4], &[1e-2, 2.5e-3, 3.125e-4]).unwrap();
        for (level, rate) in
            [(0.1, 1e-2), (0.05, 4e-2), (0.4, 3.125e-4), (0.8, 3.906_25e-5), (0.141_421_356_237_309_5, 5e-3)]
        {
            assert!((hazard.rate(level) / rate - 1.0).abs() < 1e-14, "{level}: {}", hazard.rate(level));
        }
    }

    #[test]
    fn invalid_curves_are_refused_with_the_values_found() {
        let refused = |levels: &[f64], rates: &[f64]| HazardCurve::new(levels, rates).unwrap_err().to_string();
        assert_eq!(refused(&[0.1], &[0.1, 0.2]), "found 1 levels and 2 rates; expected a rate for each level");
        assert_eq!(refused(&[-1.0, 1.0], &[0.2, 0.1]), "found -1 as level 1; expected a level above 0");
        let found = refused(&[0.2, 0.2], &[0.2, 0.1]);
        assert_eq!(found, "found 0.2 as level 2; expected levels that increase, here above 0.2");
        let found = refused(&[0.1, 0.2], &[0.1, 0.2]);
        assert!(found.starts_with("found the rate 0.2 at the level 0.2; expected rates"), "{found}");
        assert_eq!(refused(&[0.1, 0.2], &[0.1, 0.0]), "found 1 levels with a rate above 0; expected two or more");
        assert!(refused(&[0.1, 0.2], &[f64::NAN, 0.0]).contains("the rate NaN"));
    }

    /// A simulated catalogue has the level 0, and rates that rise in their last digits.
    #[test]
    fn a_level_of_zero_and_rises_by_round_off_are_no_faults() {
        let hazard = HazardCurve::new(&[0.0, 0.1, 0.2, 0.4], &[1.0, 1e-4, 1e-4 + 1e-10, 1e-5]).unwrap();
        assert_eq!((hazard.levels(), hazard.rates()), (&[0.1, 0.2, 0.4][..], &[1e-4, 1e-4, 1e-5][..]));
        assert_eq!(hazard.remarks, ["the level 0 was left out"]);
        assert!(HazardCurve::new(&[0.1, 0.2], &[1e-4, 1.01e-4]).is_err());
    }

    #[test]
    fn levels_with_a_rate_of_zero_are_left_out() {
        let hazard = HazardCurve::new(&[0.1, 0.2, 0.4, 0.8], &[1e-2, 1e-3, 0.0, 0.0]).unwrap();
        assert_eq!((hazard.levels(), hazard.rates()), (&[0.1, 0.2][..], &[1e-2, 1e-3][..]));
        assert_eq!(hazard.remarks, ["2 levels from 0.4 on have a rate of 0 and were left out"]);
    }
}
