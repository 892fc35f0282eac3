//! Rows at levels of a measure, or their counts → stripes.

use crate::fragility::observation::CurveFitError;
use crate::fragility::table::{SweepTable, SweepTableError};
use crate::output::table::{Table, TableColumn};

/// The rows at a level.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Stripe {
    /// The level.
    pub level: f64,
    /// Number of decided rows.
    pub runs: usize,
    /// Number of those that exceed the limit. For ensembles, the sum of the fractions of samples that do.
    pub exceeded: f64,
}

impl Stripe {
    /// The fraction of the rows that exceeds the limit.
    pub fn fraction(&self) -> f64 {
        self.exceeded / self.runs as f64
    }

    /// Merges values of a measure in increasing order, each with its sum of fractions and its number of rows, to levels. `im` is the
    /// measure in errors.
    ///
    /// # Errors
    /// More than half of the rows have a level of their own.
    pub fn all(values: &[(f64, f64, usize)], im: &str) -> Result<Vec<Stripe>, CurveFitError> {
        /// Relative distance of levels. A scaled record meets its level to round-off.
        const ROUND_OFF: f64 = 1e-9;
        let alike = values.chunk_by(|(one, ..), (other, ..)| other - one <= ROUND_OFF * other);
        let stripe = |values: &[(f64, f64, usize)]| Stripe {
            level: values[0].0,
            runs: values.iter().map(|(.., runs)| runs).sum(),
            exceeded: values.iter().map(|(_, exceeded, _)| exceeded).sum(),
        };
        let stripes: Vec<Stripe> = alike.map(stripe).collect();
        let rows: usize = stripes.iter().map(|stripe| stripe.runs).sum();
        if 2 * stripes.len() > rows {
            return Err(CurveFitError(format!(
                "found {} levels of {im} in {rows} rows; expected stripes of several runs, as of levels in a sweep",
                stripes.len()
            )));
        }
        Ok(stripes)
    }
}

/// The row and the outcome of each run of levels with their counts: those that exceed the limit come first.
///
/// # Errors
/// Counts that are not whole numbers, or more runs exceeded than there are.
pub fn unrolled(runs: &[f64], exceeded: &[f64]) -> Result<Vec<(usize, bool)>, CurveFitError> {
    let mut rows = Vec::new();
    for (row, (&runs, &exceeded)) in runs.iter().zip(exceeded).enumerate() {
        let is_count = |number: f64| number >= 0.0 && number.fract() == 0.0;
        if !(is_count(runs) && is_count(exceeded) && exceeded <= runs) {
            return Err(CurveFitError(format!(
                "{exceeded} of {runs} runs are exceeded in row {row}; expected whole numbers, 0 to all"
            )));
        }
        rows.extend((0..runs as usize).map(|run| (row, run < exceeded as usize)));
    }
    Ok(rows)
}

impl SweepTable {
    /// A row for each run, if the table has a row for each level with the number of its `runs` and of those `exceeded`.
    ///
    /// # Errors
    /// A column has no numbers, and those of [`unrolled`].
    pub fn unrolled(&self, im: &str) -> Result<Option<SweepTable>, SweepTableError> {
        let has = |name: &str| self.column(name).is_ok();
        if has("outcome") || !has("runs") || !has("exceeded") {
            return Ok(None);
        }
        let count = |name: &str| -> Result<Vec<f64>, SweepTableError> {
            Ok(self.numbers(name)?.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
        };
        let (heading, levels) = (&self.column(im)?.heading, count(im)?);
        let rows = unrolled(&count("runs")?, &count("exceeded")?).map_err(|error| self.refused(error.to_string()))?;
        let level = |&(row, _): &(usize, bool)| levels[row];
        let columns = [
            TableColumn::real(&heading.name, "", level).with_unit(heading.unit.as_deref()),
            TableColumn::choice("outcome", ["completed", "overturned"], |&(_, exceeds)| usize::from(exceeds)),
        ];
        Ok(Some(SweepTable::new(&self.file, Table::of(&columns, &rows))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_differ_by_round_off_are_one_level() {
        let values = [(0.2, 0.0, 3), (0.2 * (1.0 + 1e-15), 1.0, 1), (0.4, 2.5, 4)];
        let found = Stripe::all(&values, "PGV").unwrap();
        assert_eq!(found.iter().map(|stripe| (stripe.runs, stripe.exceeded)).collect::<Vec<_>>(), [(4, 1.0), (4, 2.5)]);
        assert_eq!((found[0].level, found[1].fraction()), (0.2, 0.625));
        let alone = Stripe::all(&[(0.2, 0.0, 1), (0.3, 1.0, 2)], "PGV").unwrap_err().to_string();
        assert!(alone.starts_with("found 2 levels of PGV in 3 rows; expected stripes"), "{alone}");
    }

    #[test]
    fn counts_become_rows() {
        let table = |text: &str| SweepTable::read("t.csv", text.as_bytes()).unwrap();
        let counts = table("PGV [m/s],runs,exceeded\n0.2,3,1\n0.4,2,2\n").unrolled("PGV").unwrap().unwrap();
        assert_eq!(counts.numbers("PGV [m/s]").unwrap(), [0.2, 0.2, 0.2, 0.4, 0.4].map(Some));
        let words: Vec<bool> = counts
            .cases(crate::run::limit::Limit::Overturned)
            .unwrap()
            .0
            .iter()
            .map(|case| case.fraction > 0.0)
            .collect();
        assert_eq!(words, [true, false, false, true, true]);
        for wrong in ["4,1", "2.5,3", "-1,3", ",3"] {
            let (exceeded, runs) = wrong.split_once(',').unwrap();
            let found = table(&format!("PGV,runs,exceeded\n0.2,{runs},{exceeded}\n")).unrolled("PGV").unwrap_err();
            assert!(found.to_string().contains("runs are exceeded in row 0; expected whole numbers"), "{found}");
        }
        assert!(table("PGV,outcome,runs,exceeded\n").unrolled("PGV").unwrap().is_none());
    }
}
