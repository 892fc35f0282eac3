//! The table of a sweep, a limit → its decided rows, with their ground motions.

use std::collections::HashMap;

use crate::fragility::table::{SweepTable, SweepTableError};
use crate::input::motion::{MOTION, Motion};
use crate::output::table::{Series, Values};
use crate::run::limit::Limit;
use crate::run::outcome::{End, rocks};

/// The outcome of a row, relative to a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Position of the row in the table.
    pub row: usize,
    /// Fraction of its known runs that exceeded the limit. 0 or 1 for a single run.
    pub fraction: f64,
    /// Fraction of its runs without a verdict, 0 for a single run.
    pub unknown: f64,
    /// Peak |θ|/α, in space the tilt over that of the balance, if the block rocks and stands.
    pub peak: Option<f64>,
    /// Number of its ground motion; `None` for a row without one, which has its own.
    pub motion: Option<usize>,
}

/// The outcome of a row relative to a limit, known or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowOutcome {
    end: End,
    is_ensemble: bool,
    /// Fraction of its known runs that exceeded the limit; `None` if none is known.
    pub fraction: Option<f64>,
    /// Fraction of its runs without a verdict.
    pub unknown: f64,
    /// Peak |θ|/α, in space the tilt over that of the balance, if the block rocks and stands.
    pub peak: Option<f64>,
    /// Number of its ground motion; `None` for a row without one, which has its own.
    pub motion: Option<usize>,
}

impl RowOutcome {
    /// The case of a row whose outcome is known.
    pub fn case(&self, row: usize) -> Option<Case> {
        let RowOutcome { fraction, unknown, peak, motion, .. } = *self;
        fraction.map(|fraction| Case { row, fraction, unknown, peak, motion })
    }

    /// The case of a row as if every run without a verdict exceeded the limit, or none.
    pub fn completed(&self, row: usize, unknown_exceed: bool) -> Case {
        let RowOutcome { fraction, unknown, peak, motion, .. } = *self;
        Case { row, fraction: completed(fraction, unknown, unknown_exceed), unknown: 0.0, peak, motion }
    }
}

/// The fraction of a row's runs that exceed a limit if all those without a verdict do, or none. `fraction` is that of the known ones.
pub fn completed(fraction: Option<f64>, unknown: f64, unknown_exceed: bool) -> f64 {
    let of_unknown = if unknown_exceed { unknown } else { 0.0 };
    fraction.map_or(0.0, |fraction| fraction * (1.0 - unknown)) + of_unknown
}

/// Counts of a table's rows, relative to a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct RowCounts {
    /// All rows.
    pub all: usize,
    /// Rows whose run decides whether the limit is exceeded.
    pub decided: usize,
    /// Number of rows that exceed the limit. For ensembles, the sum of the fractions of samples that do.
    pub exceeded: f64,
    /// Number of rows that exceed the limit if all rows and samples without a known outcome do.
    pub exceeded_at_most: f64,
    /// Rows of ensembles some of whose samples have no known outcome.
    pub partly_known: usize,
    /// Rows whose runs failed.
    pub failed: usize,
    /// Rows whose runs ended at complete separation before exceeding the limit.
    pub separated: usize,
    /// Rows whose duration was too short.
    pub undecided: usize,
    /// Rows of completed runs without the response that the limit refers to.
    pub without_response: usize,
}

impl RowCounts {
    /// Counts rows.
    pub fn take(&mut self, rows: &[RowOutcome]) {
        for row in rows {
            match (row.fraction, row.end) {
                (Some(fraction), _) => {
                    self.decided += 1;
                    self.exceeded += fraction * (1.0 - row.unknown);
                    self.partly_known += usize::from(row.unknown > 0.0);
                }
                (None, End::Undecided) => self.undecided += 1,
                (None, End::Separated) => self.separated += 1,
                (None, End::Completed) if !row.is_ensemble => self.without_response += 1,
                (None, End::Failed | End::Completed | End::Overturned) => self.failed += 1,
            }
            self.exceeded_at_most += completed(row.fraction, row.unknown, true);
        }
        self.all += rows.len();
    }
}

/// The ground motions of a table, or the values of another column by which its rows are clustered.
#[derive(Clone, Debug, Default)]
pub struct Motions {
    /// The column of the clusters, instead of those of the motions.
    pub cluster: Option<String>,
    numbers: HashMap<String, usize>,
    /// Place of the first row of each.
    first: Vec<u64>,
}

/// The columns with the names of records.
const RECORDS: [&str; 2] = ["record", "vertical"];

impl Motions {
    /// Begins with the column of the clusters, if it is not the motions that rows share.
    pub fn clustered(cluster: Option<String>) -> Motions {
        Motions { cluster, ..Motions::default() }
    }

    /// This number of motions, in the order of their first rows.
    pub fn in_order(cluster: Option<String>, count: usize) -> Motions {
        Motions { cluster, numbers: HashMap::new(), first: (0..count as u64).collect() }
    }

    /// The columns that tell the motions, among these of a table.
    pub fn columns(&self, is_known: impl Fn(&str) -> bool) -> Vec<&str> {
        match &self.cluster {
            Some(column) => vec![column],
            None if is_known(MOTION) => vec![MOTION],
            None => RECORDS.into_iter().filter(|name| is_known(name)).collect(),
        }
    }

    /// The number of the motion with these words in the columns named `columns`. `None` without a word.
    pub fn number(&mut self, columns: &[&str], words: &[&str]) -> Option<usize> {
        let word = |name: &str| columns.iter().position(|column| *column == name).map_or("", |i| words[i]);
        let is_named = self.cluster.is_none() && columns.first() != Some(&MOTION);
        let key = match is_named {
            true => Motion::of_names(RECORDS.map(word))?.to_string(),
            false => words.first().filter(|word| !word.is_empty())?.to_string(),
        };
        let next = self.first.len();
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.first.push(u64::MAX);
        }
        Some(number)
    }

    /// Takes note of a row of a motion at this place of the table.
    pub fn see(&mut self, number: usize, place: u64) {
        self.first[number] = self.first[number].min(place);
    }

    /// The place of each motion in the order of their first rows.
    pub fn ranks(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.first.len()).collect();
        order.sort_by_key(|&number| self.first[number]);
        let mut ranks = vec![0; order.len()];
        order.into_iter().enumerate().for_each(|(rank, number)| ranks[number] = rank);
        ranks
    }
}

impl SweepTable {
    /// Returns the rows whose outcome relative to a limit is known, the ground motions, and counts of all rows. The outcome is the probability
    /// of the ensemble if the table has one, else that of the single run.
    ///
    /// # Errors
    /// Those of [`SweepTable::outcomes`].
    pub fn cases(&self, limit: Limit) -> Result<(Vec<Case>, Motions, RowCounts), SweepTableError> {
        let (mut motions, mut counts) = (Motions::default(), RowCounts::default());
        let outcomes = self.outcomes(limit, &mut motions, |row| row as u64)?;
        counts.take(&outcomes);
        let cases = outcomes.iter().enumerate().filter_map(|(row, outcome)| outcome.case(row)).collect();
        Ok((cases, motions, counts))
    }

    /// Returns the outcomes of all rows relative to a limit. The ground motions may have occurred in batches before; `place` is that of a row
    /// in the whole table.
    ///
    /// # Errors
    /// The table has no outcomes, or an unknown one, or its rows are searches for least levels.
    pub fn outcomes(
        &self,
        limit: Limit,
        motions: &mut Motions,
        place: impl Fn(usize) -> u64,
    ) -> Result<Vec<RowOutcome>, SweepTableError> {
        let mut headings = self.table.columns().iter().map(|column| &column.heading);
        if let Some(heading) = headings.find(|heading| heading.name.starts_with("least.")) {
            return Err(self.refused(format!(
                "found the least levels of searches, {heading}; expected an outcome at one level in each row, as from a sweep with \
                 scales or levels"
            )));
        }
        let (ends, limit) = (self.ends()?, self.limit_of(limit));
        let known = |name: &str| self.column(name).ok();
        let peaks = known(self.rotation());
        let is_ensemble = self.column("ensemble.samples").is_ok();
        let limited = if is_ensemble { Vec::new() } else { self.limited(limit)? };
        let liftoffs = known("events.liftoffs").or(known("events.lift_offs"));
        let probabilities = match is_ensemble {
            true => Some(self.column(&format!("P({limit})"))?),
            false => None,
        };
        // Tables of earlier versions do not have it.
        let unknown = known(&format!("ensemble.unknown({limit})"));
        let samples = known("ensemble.samples");
        let number = |column: Option<&Series>, row| column.map_or(Ok(None), |column| self.number(column, row));
        let outcome = |(row, (end, motion)): (usize, (End, Option<usize>))| {
            let mut response = None;
            for column in &limited {
                response = self.number(column, row)?.into_iter().chain(response).reduce(f64::max);
            }
            let fraction = match is_ensemble {
                // Empty if no sample is known.
                true => number(probabilities, row)?,
                false => limit.verdict(end, response).map(|exceeds| f64::from(u8::from(exceeds))),
            };
            let liftoffs = number(liftoffs, row)?;
            let peak = number(peaks, row)?.filter(|peak| end == End::Completed && rocks(*peak, liftoffs));
            let of_samples = number(unknown, row)?.zip(number(samples, row)?);
            let unknown = match fraction {
                Some(_) => of_samples.map_or(0.0, |(unknown, samples)| unknown / samples),
                None => 1.0,
            };
            Ok(RowOutcome { end, is_ensemble, fraction, unknown, peak, motion })
        };
        ends.into_iter().zip(self.motions(motions, place)?).enumerate().map(outcome).collect()
    }

    /// The number of each row's ground motion.
    fn motions(
        &self,
        motions: &mut Motions,
        place: impl Fn(usize) -> u64,
    ) -> Result<Vec<Option<usize>>, SweepTableError> {
        let names: Vec<String> =
            motions.columns(|name| self.column(name).is_ok()).into_iter().map(String::from).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let columns = names.iter().map(|name| self.column(name)).collect::<Result<Vec<&Series>, _>>()?;
        // Words are looked up once for all rows of a batch.
        let position = |column: &Series, row: usize| match &column.values {
            Values::Choice(positions) => Some(positions[row]),
            _ => None,
        };
        let mut seen: HashMap<Vec<u32>, Option<usize>> = HashMap::new();
        let number = |row: usize| {
            let mut by_words = || {
                let words: Vec<String> = columns.iter().map(|column| column.text(row)).collect();
                motions.number(&names, &words.iter().map(String::as_str).collect::<Vec<_>>())
            };
            let positions: Option<Vec<u32>> = columns.iter().map(|column| position(column, row)).collect();
            let motion = match positions {
                Some(positions) => *seen.entry(positions).or_insert_with(by_words),
                None => by_words(),
            };
            if let Some(number) = motion {
                motions.see(number, place(row));
            }
            motion
        };
        Ok((0..self.rows()).map(number).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = crate::fragility::table::tests::TABLE;

    fn table(text: &str) -> SweepTable {
        SweepTable::read("t.csv", text.as_bytes()).unwrap()
    }

    #[test]
    fn rows_are_compared_with_a_limit() {
        let fractions = |limit: &str| {
            let (cases, _, counts) = table(TABLE).cases(limit.parse().unwrap()).unwrap();
            let cases: Vec<_> = cases.iter().map(|case| (case.row, case.fraction, case.motion.unwrap())).collect();
            (cases, counts.failed, counts.separated, counts.undecided)
        };
        assert_eq!(fractions("overturned"), (vec![(0, 0.0, 0), (1, 1.0, 1), (2, 0.0, 0), (6, 0.0, 0)], 1, 2, 2));
        let rotated = vec![(0, 0.0, 0), (1, 1.0, 1), (2, 1.0, 0), (4, 1.0, 1), (6, 0.0, 0), (8, 1.0, 1)];
        assert_eq!(fractions("theta/alpha>0.5"), (rotated, 1, 1, 1));
        let peaks: Vec<_> = table(TABLE).cases(Limit::Overturned).unwrap().0.iter().map(|case| case.peak).collect();
        assert_eq!(peaks, [Some(0.3), None, Some(0.6), None]);
    }

    /// A block that overturns exceeds any slip. The number of its row is not asked for.
    #[test]
    fn rows_are_compared_with_a_slip() {
        let text = "row,outcome,peak.slip [m]\n0,completed,0.05\n1,completed,0.2\n2,overturned,0\n3,undecided,0.3\n\
                    4,undecided,0.1\n";
        let (cases, _, counts) = table(text).cases(Limit::Slip(0.1)).unwrap();
        let cases: Vec<_> = cases.iter().map(|case| (case.row, case.fraction)).collect();
        assert_eq!((cases, counts.undecided), (vec![(0, 0.0), (1, 1.0), (2, 1.0), (3, 1.0)], 1));
        let refused = table(TABLE).cases(Limit::Slip(0.1)).unwrap_err().to_string();
        assert!(refused.starts_with("t.csv: has no column peak.slip"), "{refused}");
    }

    /// The greatest plastic elongation of all ties and dampers counts.
    #[test]
    fn rows_are_compared_with_a_plastic_elongation() {
        let text = "row,outcome,peak.tie_1.plastic [m],peak.damper_1.plastic [m]\n0,completed,0.005,0.02\n\
                    1,completed,0.01,0.005\n2,overturned,0,0\n3,undecided,0.03,\n4,undecided,,\n";
        let (cases, _, counts) = table(text).cases(Limit::Plastic(0.015)).unwrap();
        let cases: Vec<_> = cases.iter().map(|case| (case.row, case.fraction)).collect();
        assert_eq!((cases, counts.undecided), (vec![(0, 1.0), (1, 0.0), (2, 1.0), (3, 1.0)], 1));
        let refused = table(TABLE).cases(Limit::Plastic(0.1)).unwrap_err().to_string();
        assert!(refused.starts_with("t.csv: has no column peak.damper_1.plastic"), "{refused}");
        let text = "row,outcome,half_cycles>0.005 [1]\n0,completed,3\n1,completed,2\n2,undecided,2\n";
        let (cases, _, counts) = table(text).cases("half_cycles:2".parse().unwrap()).unwrap();
        assert_eq!(cases.iter().map(|case| case.fraction).collect::<Vec<_>>(), [1.0, 0.0]);
        assert_eq!(counts.undecided, 1);
    }

    /// Tables of blocks with and without friction, joined: a row without a slip counts neither as one below the limit nor as one above.
    #[test]
    fn a_missing_response_is_left_out_and_counted() {
        let text =
            "row,outcome,peak.slip [m]\n0,completed,0.05\n1,completed,\n2,completed,0.2\n3,overturned,\n4,failed,\n";
        let (cases, _, counts) = table(text).cases(Limit::Slip(0.1)).unwrap();
        let cases: Vec<_> = cases.iter().map(|case| (case.row, case.fraction)).collect();
        assert_eq!((cases, counts.without_response, counts.failed), (vec![(0, 0.0), (2, 1.0), (3, 1.0)], 1, 1));
        assert_eq!((counts.exceeded, counts.exceeded_at_most), (2.0, 4.0));
        let outcomes = table(text).outcomes(Limit::Slip(0.1), &mut Motions::default(), |row| row as u64).unwrap();
        let completed = |unknown_exceed: bool| {
            outcomes.iter().map(|outcome| outcome.completed(0, unknown_exceed).fraction).collect::<Vec<_>>()
        };
        assert_eq!(completed(false), [0.0, 0.0, 1.0, 1.0, 0.0]);
        assert_eq!(completed(true), [0.0, 1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn an_ensemble_gives_its_probability() {
        let ensemble = "row,outcome,peak.theta/alpha [1],ensemble.samples [1],P(overturned) [1]\n0,completed,0.3,4,0.25\n\
                        1,failed,0.3,4,1\n2,failed,0.1,4,\n";
        let (cases, _, counts) = table(ensemble).cases(Limit::Overturned).unwrap();
        assert_eq!(cases.iter().map(|case| case.fraction).collect::<Vec<_>>(), [0.25, 1.0]);
        assert_eq!(counts.failed, 1);
        let refused = table(ensemble).cases(Limit::Rotation(0.5)).unwrap_err().to_string();
        assert!(
            refused.starts_with("t.csv: has no column P(theta/alpha>0.5); expected one of row, outcome"),
            "{refused}"
        );
    }
}
