//! Cases in batches → a list of rows, or sorted and counted rows if they are many.

use crate::fragility::cases::{Case, Motions, RowCounts, RowOutcome};
use crate::fragility::data::Data;
use crate::fragility::likelihood::Link;
use crate::fragility::many::{ManyRows, ManyRowsBuilder};
use crate::fragility::observation::{CurveFitError, Observation};
use crate::fragility::regression::CurveFit;
use crate::fragility::table::{SweepTable, SweepTableError};
use crate::run::limit::Limit;

/// Most rows that are kept as a list. More are sorted and counted.
const MAX_LIST: usize = 1 << 17;

/// The cases of a table over one or two measures.
#[derive(Default)]
pub struct CaseStore {
    /// Places in the table, cases and measures.
    list: Vec<(u64, Case, [f64; 2])>,
    many: Option<ManyRowsBuilder>,
    /// Number of cases without a value of a measure, which are left out.
    without_measure: usize,
    /// The error of the first row that a fit refuses.
    refused: Option<CurveFitError>,
}

/// Cases with values of the measures.
pub(super) enum StoredRows {
    /// In the order of the table, with the number of the record of each.
    Few(Vec<(Case, [f64; 2])>, Vec<usize>),
    /// Sorted.
    Many(Box<ManyRows>),
}

impl CaseStore {
    /// Takes a case with its place in the table. For a curve, the second measure is 1. A case without a value of a measure is left out and
    /// counted.
    pub fn push(&mut self, place: u64, case: &Case, measures: [Option<f64>; 2]) {
        let [Some(first), Some(second)] = measures else {
            self.without_measure += 1;
            return;
        };
        match &mut self.many {
            None => {
                self.list.push((place, *case, [first, second]));
                if self.list.len() > MAX_LIST {
                    self.many = Some(ManyRowsBuilder::default());
                    for (place, case, measures) in std::mem::take(&mut self.list) {
                        self.push(place, &case, measures.map(Some));
                    }
                }
            }
            Some(many) => {
                if self.refused.is_none() {
                    self.refused = many.push(case, [first, second]).err();
                }
            }
        }
    }

    /// Number of cases that were left out since they have no value of a measure.
    pub fn without_measure(&self) -> usize {
        self.without_measure
    }

    /// Fits the curve of the first measure; `motions` are those of the cases.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn fit(self, motions: &Motions, link: Link) -> Result<CurveFit, CurveFitError> {
        match self.rows(motions)? {
            StoredRows::Few(rows, _) => {
                let observation =
                    |(case, [measure, _]): &(Case, [f64; 2])| Observation::with_probability(&[*measure], case.fraction);
                Data::new(rows.iter().map(observation).collect())?.fit(link)
            }
            StoredRows::Many(rows) => rows.curve(link).map(|(_, fit, _)| fit),
        }
    }

    /// Returns the rows; `motions` are those of the cases.
    pub(super) fn rows(mut self, motions: &Motions) -> Result<StoredRows, CurveFitError> {
        if let Some(error) = self.refused {
            return Err(error);
        }
        let ranks = &motions.ranks();
        if let Some(many) = self.many {
            return Ok(StoredRows::Many(Box::new(many.finish(ranks))));
        }
        self.list.sort_by_key(|(place, ..)| *place);
        let record = |(row, (_, case, _)): (usize, &(u64, Case, [f64; 2]))| match case.motion {
            Some(number) => ranks[number],
            None => ranks.len() + row,
        };
        let records = self.list.iter().enumerate().map(record).collect();
        Ok(StoredRows::Few(self.list.into_iter().map(|(_, case, measures)| (case, measures)).collect(), records))
    }

    /// The values of the measure in increasing order. Each has its sum of fractions and its number of rows.
    ///
    /// # Errors
    /// A row that a fit refuses.
    pub fn levels(self, motions: &Motions) -> Result<Vec<(f64, f64, usize)>, CurveFitError> {
        match self.rows(motions)? {
            StoredRows::Few(mut rows, _) => {
                rows.sort_by(|(_, one), (_, other)| one[0].total_cmp(&other[0]));
                let alike = rows.chunk_by(|(_, one), (_, other)| one[0] == other[0]);
                Ok(alike
                    .map(|rows| (rows[0].1[0], rows.iter().map(|(case, _)| case.fraction).sum(), rows.len()))
                    .collect())
            }
            StoredRows::Many(rows) => Ok(rows.levels()),
        }
    }
}

/// Counts and cases of a table read batch by batch, relative to a limit.
pub struct Collected {
    /// The limit; `None` before the first batch unless it was given.
    pub limit: Option<Limit>,
    /// The measures of each store.
    columns: Vec<(String, Option<String>)>,
    /// The cases over each list of columns.
    pub stores: Vec<CaseStore>,
    /// The cases over the first list of columns as if no run without a verdict exceeded the limit, then as if all did, if they are asked
    /// for.
    pub completions: Option<[CaseStore; 2]>,
    /// The ground motions of the cases.
    pub motions: Motions,
    /// Counts of the rows.
    pub counts: RowCounts,
}

impl Collected {
    /// Begins with a limit, or the usual one of the table, the column of the clusters, if it is not the motions, and each store's
    /// columns: one measure or two.
    pub fn new(limit: Option<Limit>, cluster: Option<String>, columns: Vec<(String, Option<String>)>) -> Collected {
        let stores = columns.iter().map(|_| CaseStore::default()).collect();
        let motions = Motions::clustered(cluster);
        Collected { limit, columns, stores, completions: None, motions, counts: RowCounts::default() }
    }

    /// Keeps the completions as well.
    #[must_use]
    pub fn with_completions(mut self) -> Collected {
        self.completions = Some(Default::default());
        self
    }

    /// Takes a batch of rows, and returns their outcomes. `is_part` says that the rows of the whole table are in the order of their column
    /// `row`, otherwise in that of the batches.
    ///
    /// # Errors
    /// Those of [`SweepTable::outcomes`], and a column that is missing or has no numbers.
    pub fn take(&mut self, batch: &SweepTable, is_part: bool) -> Result<Vec<RowOutcome>, SweepTableError> {
        let limit = batch.limit_of(self.limit.unwrap_or_else(|| batch.usual_limit()));
        self.limit = Some(limit);
        let before = self.counts.all as u64;
        let numbers = if is_part { Some(batch.numbers("row")?) } else { None };
        let place = |row: usize| match &numbers {
            Some(numbers) => numbers[row].unwrap_or_default() as u64,
            None => before + row as u64,
        };
        let outcomes = batch.outcomes(limit, &mut self.motions, place)?;
        self.counts.take(&outcomes);
        for (store, (first, second)) in self.stores.iter_mut().zip(&self.columns) {
            let first = batch.numbers(first)?;
            let second = second.as_ref().map(|name| batch.numbers(name)).transpose()?;
            for case in outcomes.iter().enumerate().filter_map(|(row, outcome)| outcome.case(row)) {
                let second = second.as_ref().map_or(Some(1.0), |numbers| numbers[case.row]);
                store.push(place(case.row), &case, [first[case.row], second]);
            }
        }
        for (store, unknown_exceed) in self.completions.iter_mut().flatten().zip([false, true]) {
            let measures = batch.numbers(&self.columns[0].0)?;
            for (row, outcome) in outcomes.iter().enumerate() {
                store.push(place(row), &outcome.completed(row, unknown_exceed), [measures[row], Some(1.0)]);
            }
        }
        Ok(outcomes)
    }
}
