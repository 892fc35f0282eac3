//! Rows of a large table → a curve or surface, in passes over sorted rows. Its intervals and its quality are found as well.

use chacha20::rand_core::Rng;
use nalgebra::DMatrix;

use crate::fragility::bootstrap::Bootstrap;
use crate::fragility::cases::Case;
use crate::fragility::clusters::{self, Independence, MAX_REFITS};
use crate::fragility::data::Data;
use crate::fragility::goodness::{Fitted, Group, Grouping};
use crate::fragility::likelihood::Link;
use crate::fragility::nodes::{MAX_GROWTH, Node, Reducer, observations, reduced};
use crate::fragility::observation::{CurveFitError, Observation, check_row};
use crate::fragility::quality::{AreaUnderCurve, Scatter};
use crate::fragility::regression::{CurveFit, Sums, fit_of};
use crate::fragility::rows::{EqualRows, OWN, RowSorter, SortedRows, total};
use crate::fragility::separation::{Ends, Hulls, check_classes, check_overlap};
use crate::output::runner::in_parallel;
use crate::statistics::sampling;

/// Rows of a picture.
const MAX_MARKS: usize = 10_000;
/// Nodes of single records, which are kept in memory: 80 bytes each.
const MAX_NODES: usize = 1 << 20;

/// Rows over one or two measures, in the making.
#[derive(Default)]
pub(super) struct ManyRowsBuilder {
    sorter: RowSorter,
    count: usize,
    ends: [Ends; 2],
    /// Number of rows of each ground motion.
    of_motions: Vec<u32>,
    /// Number of rows that share their motion with no other row.
    own: usize,
    scatter: Scatter,
}

impl ManyRowsBuilder {
    /// Takes a row with its measures; the second is 1 for a curve.
    ///
    /// # Errors
    /// A row that a fit refuses.
    pub fn push(&mut self, case: &Case, measures: [f64; 2]) -> Result<(), CurveFitError> {
        check_row(self.count, &measures, case.fraction, 1.0)?;
        self.count += 1;
        self.ends.iter_mut().zip(measures).for_each(|(ends, measure)| ends.take(measure, case.fraction));
        match case.motion {
            Some(number) => {
                let last = self.of_motions.len().max(number + 1);
                self.of_motions.resize(last, 0);
                self.of_motions[number] += 1;
            }
            None => self.own += 1,
        }
        if let Some(peak) = case.peak {
            self.scatter.take(measures[0], peak);
        }
        let motion = case.motion.map_or(OWN, |number| number as u32);
        // A fraction of −0 has other bits.
        self.sorter.push(EqualRows { measures, fraction: case.fraction + 0.0, motion, count: 1 });
        Ok(())
    }

    /// Ends with the rows in order. `ranks` has the place of each motion in the order of their first rows.
    pub fn finish(self, ranks: &[usize]) -> ManyRows {
        let ManyRowsBuilder { sorter, count, ends, of_motions, own, scatter } = self;
        let mut motions: Vec<u32> = (0..of_motions.len() as u32).filter(|&of| of_motions[of as usize] > 0).collect();
        motions.sort_by_key(|&motion| ranks[motion as usize]);
        ManyRows { sorted: sorter.finish(), count, ends, motions, own, scatter }
    }
}

/// Rows over one or two measures.
pub(super) struct ManyRows {
    sorted: SortedRows,
    pub count: usize,
    ends: [Ends; 2],
    /// Ground motions that occur, in the order of their first rows.
    motions: Vec<u32>,
    own: usize,
    pub scatter: Scatter,
}

/// The quality of a curve over many rows.
pub(super) struct Quality {
    pub auc: f64,
    pub brier: f64,
    pub groups: Vec<Group>,
    /// Some of the rows in the order of their measures, including the ends.
    pub marks: Vec<Observation>,
}

impl ManyRows {
    /// The independent units.
    pub fn independence(&self) -> Independence {
        Independence::of_counts(self.motions.len() + self.own, self.count)
    }

    /// All rows: the first measure, the fraction, the weight and the motion.
    fn rows(&self) -> impl Iterator<Item = (f64, f64, f64, u32)> {
        self.sorted.batches().flatten().map(|row| (row.measures[0], row.fraction, f64::from(row.count), row.motion))
    }

    /// The values of the first measure, with the sum of fractions and number of rows.
    pub fn levels(&self) -> Vec<(f64, f64, usize)> {
        let mut levels: Vec<(f64, f64, usize)> = Vec::new();
        for (measure, fraction, weight, _) in self.rows() {
            match levels.last_mut() {
                Some((last, sum, count)) if *last == measure => {
                    (*sum, *count) = (*sum + weight * fraction, *count + weight as usize)
                }
                _ => levels.push((measure, weight * fraction, weight as usize)),
            }
        }
        levels
    }

    /// Fits a curve over the first measure. Returns its data in few observations, with the width of their cells.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn curve(&self, link: Link) -> Result<(Data, CurveFit, f64), CurveFitError> {
        check_classes(&self.ends[..1], self.count)?;
        check_overlap(&self.ends[0], self.rows().map(|(measure, fraction, weight, _)| (measure, fraction, weight)))?;
        // Over the range of both classes, the predictor grows by less than 30 with this many rows.
        let [low, high] = self.ends[0].range();
        let overlap = Some(self.ends[0].overlap()).filter(|overlap| *overlap > 0.0);
        let mut width = overlap.unwrap_or_else(|| libm::log(high / low)) / 30.0;
        loop {
            let data = reduced(width, self.rows());
            let fit = data.fit(link)?;
            let growth = fit.coefficients[1].abs() * width;
            if growth <= MAX_GROWTH {
                return Ok((data, fit, width));
            }
            width *= 0.5 * MAX_GROWTH / growth;
        }
    }

    /// The quality of a curve.
    pub fn quality(&self, fit: &CurveFit) -> Quality {
        let is_clustered = matches!(self.independence(), Independence::Motions(_));
        // Rows are in the order of their scores.
        let sign = if fit.coefficients[1] < 0.0 { -1.0 } else { 1.0 };
        let (mut area, mut squares) = (AreaUnderCurve::default(), Vec::new());
        let mut groups = Grouping::new(self.count, is_clustered);
        let (mut marks, mut passed, mut last) = (Vec::new(), 0, None);
        let apart = self.count.div_ceil(MAX_MARKS);
        for rows in self.sorted.batches() {
            let probabilities = in_parallel(rows.len(), |number| fit.probability(&rows[number].measures[..1]));
            let mut sum = 0.0;
            for (row, probability) in rows.iter().zip(probabilities) {
                let &EqualRows { measures: [measure, _], fraction, motion, count } = row;
                let weight = f64::from(count);
                area.take(sign * probability, [weight * (1.0 - fraction), weight * fraction]);
                sum += weight * (probability - fraction) * (probability - fraction);
                let record = (motion != OWN).then_some(motion as usize);
                groups.take(Fitted { measure, fraction, probability }, weight, count as usize, record);
                let observation = || Observation::with_probability(&[measure], fraction);
                marks.extend((marks.len() * apart <= passed).then(observation));
                passed += count as usize;
                last = Some((measure, fraction));
            }
            squares.push(sum);
        }
        marks.extend(last.map(|(measure, fraction)| Observation::with_probability(&[measure], fraction)));
        let area = area.finish();
        Quality {
            auc: if sign < 0.0 { 1.0 - area } else { area },
            brier: total(&squares) / self.count as f64,
            groups: groups.finish(),
            marks,
        }
    }

    /// The covariance of the coefficients of a curve or surface, as in [`clusters::covariance`]. `width` is that of the cells of a curve.
    ///
    /// Surfaces have no full refits.
    pub fn covariance(&self, fit: &CurveFit, width: Option<f64>) -> Option<DMatrix<f64>> {
        let Independence::Motions(count) = self.independence() else { return Some(fit.covariance.clone()) };
        let (size, coefficients) = (fit.coefficients.len(), fit.coefficients.as_slice());
        let term = |predictor: f64, y: f64| fit.link.term(predictor, y);
        let sums_of = |row: &EqualRows| Sums::of_row(row, coefficients, term, |term| term.information);
        let last = self.motions.iter().max().map_or(0, |last| *last as usize + 1);
        let (mut of_motions, mut of_own) = (vec![Sums::default(); last], Sums::default());
        for rows in self.sorted.batches() {
            let sums = in_parallel(rows.len(), |number| sums_of(&rows[number]));
            for (row, sums) in rows.iter().zip(sums) {
                let sum = of_motions.get_mut(row.motion as usize).unwrap_or(&mut of_own);
                *sum = *sum + sums;
            }
        }
        let of_motion = |&motion: &u32| of_motions[motion as usize];
        let whole = self.motions.iter().map(of_motion).fold(of_own, |sum, other| sum + other).squares(size);
        let step = |sums: &Sums| clusters::step(&whole, &sums.score(size), &sums.squares(size));
        let nodes = match width {
            Some(width) if count <= MAX_REFITS => self.nodes_by_motion(width),
            _ => None,
        };
        let refitted = |motion: u32| {
            let others = nodes.as_ref()?.iter().filter(|node| node.motion != motion).cloned();
            let data = Data::new(observations(others)).ok()?;
            Some(data.fit(fit.link).ok()?.coefficients - &fit.coefficients)
        };
        let shifts = self.motions.iter().map(|motion| refitted(*motion).or_else(|| step(&of_motion(motion))));
        let of_motions = clusters::of_shifts(shifts, size, count);
        let of_own = self.sorted.sum(|row| {
            let mut squares = Sums::default();
            if row.motion == OWN {
                let one = sums_of(&EqualRows { count: 1, ..*row });
                squares.add_square(
                    step(&one).as_ref().map_or(&[f64::NAN; 3][..size], |shift| shift.as_slice()),
                    f64::from(row.count),
                );
            }
            squares
        });
        let of_own = of_own.squares(size) * ((count - 1) as f64 / count as f64);
        of_motions.map(|of_motions| of_motions + of_own).filter(|sum| sum.iter().all(|value| value.is_finite()))
    }

    /// The rows of each motion in few nodes, unless these are many after all. They are in the order of their measures.
    fn nodes_by_motion(&self, width: f64) -> Option<Vec<Node>> {
        let mut reducer = Reducer::new(width, true);
        for (measure, fraction, weight, motion) in self.rows() {
            reducer.push(measure, fraction, weight, motion);
            if reducer.count() > MAX_NODES {
                return None;
            }
        }
        let mut nodes = reducer.finish();
        let measure = |node: &Node| node.observation.measures[0];
        nodes.sort_by(|a, b| measure(a).total_cmp(&measure(b)));
        Some(nodes)
    }

    /// Fits curves to resampled records, or to rows where no record repeats. [`bootstrap`](crate::fragility::bootstrap()) draws rows in the
    /// order of the table; this one does in that of their measures.
    ///
    /// # Errors
    /// Fewer than two groups, and those of temporary files.
    pub fn bootstrap(&self, link: Link, samples: u32, seed: u64, width: f64) -> Result<Bootstrap, CurveFitError> {
        let is_clustered = self.independence() != Independence::Rows;
        let nodes = if is_clustered && self.own == 0 { self.nodes_by_motion(width) } else { None };
        let groups = if is_clustered { self.motions.len() + self.own } else { self.count };
        if groups < 2 {
            return Err(CurveFitError::one_motion(groups));
        }
        let mut places = vec![None; self.motions.iter().max().map_or(0, |last| *last as usize + 1)];
        let shared = if is_clustered { &self.motions[..] } else { &[] };
        shared.iter().enumerate().for_each(|(place, &motion)| places[motion as usize] = Some(place));
        let mut found = Bootstrap { fits: Vec::new(), without: 0, groups };
        // How often each group was drawn, a byte for each row of the table at most.
        let mut drawn = vec![0_u8; groups];
        for sample in 0..samples {
            let mut random = sampling::stream(seed, sample.into());
            drawn.fill(0);
            for _ in 0..groups {
                let times = &mut drawn[(random.next_u64() % groups as u64) as usize];
                *times = times.saturating_add(1);
            }
            let (mut ends, mut next) = (Ends::default(), shared.len());
            let mut weighted = |weight: f64, motion: u32| match places.get(motion as usize).copied().flatten() {
                Some(place) => weight * f64::from(drawn[place]),
                None => {
                    let own = &drawn[next..next + weight as usize];
                    next += own.len();
                    own.iter().map(|times| f64::from(*times)).sum()
                }
            };
            let of_node = |Node { observation, motion }: &Node| {
                (observation.measures[0], observation.fraction, observation.weight, *motion)
            };
            let rows: Box<dyn Iterator<Item = (f64, f64, f64, u32)>> = match &nodes {
                Some(nodes) => Box::new(nodes.iter().map(of_node)),
                None => Box::new(self.rows()),
            };
            let drawn_rows = rows.filter_map(|(measure, fraction, weight, motion)| {
                let weight = Some(weighted(weight, motion)).filter(|weight| *weight > 0.0)?;
                ends.take(measure, fraction);
                Some((measure, fraction, weight, 0))
            });
            let sampled = reduced(width, drawn_rows);
            let has_curve = ends.only_class().is_none() && ends.separating().is_none();
            match has_curve.then(|| sampled.fit(link)) {
                Some(Ok(fit)) => found.fits.push(fit),
                Some(Err(_)) | None => found.without += 1,
            }
        }
        Ok(found)
    }

    /// Fits a surface over both measures.
    ///
    /// # Errors
    /// Those of [`Data::new`] and [`Data::fit`].
    pub fn surface(&self, link: Link) -> Result<CurveFit, CurveFitError> {
        check_classes(&self.ends, self.count)?;
        let mut hulls = Hulls::default();
        for rows in self.sorted.batches() {
            hulls.take(rows.iter().map(|row| (row.measures, row.fraction, row.count)));
        }
        hulls.check()?;
        let sum = self.sorted.sum(|row| f64::from(row.count) * row.fraction);
        fit_of(&self.sorted, link, self.count as f64, sum / self.count as f64)
    }

    /// The area under the receiver operating characteristic, the Brier score, and some rows.
    pub fn quality_of_surface(&self, fit: &CurveFit) -> (f64, f64, Vec<Observation>) {
        let (mut marks, mut passed) = (Vec::new(), 0);
        let apart = self.count.div_ceil(MAX_MARKS);
        let mut scores = RowSorter::default();
        for row in self.sorted.batches().flatten() {
            let observation = || Observation::with_probability(&row.measures, row.fraction);
            marks.extend((marks.len() * apart <= passed).then(observation));
            passed += row.count as usize;
            scores.push(EqualRows { measures: [fit.probability(&row.measures), 1.0], motion: OWN, ..*row });
        }
        let (scores, mut area) = (scores.finish(), AreaUnderCurve::default());
        for EqualRows { measures: [score, _], fraction, count, .. } in scores.batches().flatten() {
            let weight = f64::from(*count);
            area.take(*score, [weight * (1.0 - fraction), weight * fraction]);
        }
        let squares = scores.sum(|row| {
            let error = row.measures[0] - row.fraction;
            f64::from(row.count) * (error * error)
        });
        (area.finish(), squares / self.count as f64, marks)
    }
}

#[cfg(test)]
mod tests;
