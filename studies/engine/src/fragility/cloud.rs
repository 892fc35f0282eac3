//! Rows of a table over a measure → a cloud: a line through rotations of blocks that stand, and the probability of overturning.

use crate::fragility::assessment::{Assessment, Uncertainty};
use crate::fragility::cases::{Case, Motions, RowCounts};
use crate::fragility::ida::ROTATIONS;
use crate::fragility::likelihood::Link;
use crate::fragility::line::Line;
use crate::fragility::observation::CurveFitError;
use crate::fragility::profile::Interval;
use crate::fragility::store::CaseStore;
use crate::fragility::table::{SweepTable, SweepTableError};
use crate::run::limit::Limit;
use crate::statistics::normal;

/// A row whose outcome is known.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudRow {
    /// Value of the measure.
    pub measure: Option<f64>,
    /// Whether the block overturned.
    pub overturned: bool,
    /// Peak |θ|/α, in space the tilt over that of the balance, if the block rocks and stands.
    pub peak: Option<f64>,
    /// Number of the ground motion; `None` for a row with its own.
    pub motion: Option<usize>,
    /// Properties of the record, in the order of their columns.
    pub beside: Vec<Option<f64>>,
}

/// The columns of a cloud.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CloudColumns {
    /// The measure.
    pub im: String,
    /// Properties of the records for which the residuals are tested.
    pub beside: Vec<String>,
    /// The column of the clusters, if it is not the motions.
    pub cluster: Option<String>,
}

/// The rows of a table that is read batch by batch.
pub struct CloudRows {
    columns: CloudColumns,
    rows: Vec<(u64, CloudRow)>,
    motions: Motions,
    /// Counts of all rows relative to overturning.
    pub counts: RowCounts,
    is_in_space: bool,
}

impl CloudRows {
    /// Begins without rows.
    pub fn new(columns: CloudColumns) -> CloudRows {
        let motions = Motions::clustered(columns.cluster.clone());
        CloudRows { columns, rows: Vec::new(), motions, counts: RowCounts::default(), is_in_space: false }
    }

    /// Takes a batch of rows. `is_part` says that the rows of the whole table are in the order of their column `row`, otherwise in that of
    /// the batches.
    ///
    /// # Errors
    /// Those of [`SweepTable::cases`], a column that is missing or has no numbers, and an ensemble.
    pub fn take(&mut self, batch: &SweepTable, is_part: bool) -> Result<(), SweepTableError> {
        if batch.column("ensemble.samples").is_ok() {
            let expected = "expected the rotation and the outcome of a single run in each row";
            return Err(batch.refused(format!("found an ensemble; {expected}")));
        }
        self.is_in_space = batch.is_in_space();
        let before = self.counts.all as u64;
        let numbers = if is_part { Some(batch.numbers("row")?) } else { None };
        let place = |row: usize| match &numbers {
            Some(numbers) => numbers[row].unwrap_or_default() as u64,
            None => before + row as u64,
        };
        let measures = batch.numbers(&self.columns.im)?;
        let beside = self.columns.beside.iter().map(|name| batch.numbers(name)).collect::<Result<Vec<_>, _>>()?;
        let outcomes = batch.outcomes(Limit::Overturned, &mut self.motions, place)?;
        self.counts.take(&outcomes);
        let cases = outcomes.iter().enumerate().filter_map(|(row, outcome)| outcome.case(row));
        self.rows.extend(cases.map(|case| {
            let row = CloudRow {
                measure: measures[case.row],
                overturned: case.fraction > 0.0,
                peak: case.peak,
                motion: case.motion,
                beside: beside.iter().map(|numbers| numbers[case.row]).collect(),
            };
            (place(case.row), row)
        }));
        Ok(())
    }

    /// Fits the cloud, with intervals at a confidence above 0 and below 1.
    ///
    /// # Errors
    /// Those of [`Cloud::of`].
    pub fn cloud(mut self, confidence: f64) -> Result<Cloud, CurveFitError> {
        self.rows.sort_by_key(|(place, _)| *place);
        let rows: Vec<CloudRow> = self.rows.into_iter().map(|(_, row)| row).collect();
        let found = Cloud::of(&rows, &self.columns, confidence)?;
        let unknown = found.unknown + self.counts.all - self.counts.decided;
        Ok(Cloud { unknown, rotation: ROTATIONS[usize::from(self.is_in_space)], ..found })
    }
}

/// The regression of the residuals of a cloud on a property of the records.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CloudSufficiency {
    /// Change of ln(|θ|/α) with the property.
    pub slope: f64,
    /// Probability of at least this slope, to either side, if the property has no effect.
    pub p: f64,
}

/// The probability that blocks overturn, or rock, over the measure.
pub struct Share {
    /// Measure of each row, whether it does, and the number of its motion.
    pub cases: Vec<(f64, bool, usize)>,
    /// The curve.
    pub curve: ShareCurve,
}

/// The curve of a [`Share`].
pub enum ShareCurve {
    /// Logistic regression on ln IM.
    Logistic(Box<Assessment>),
    /// Measure from which all rows do: 0 if all do, ∞ if none does, otherwise the geometric mean of the nearest rows of both classes.
    Step(f64),
}

impl Share {
    /// Fits rows with their measures, whether they do, and their motions.
    fn of(rows: Vec<(f64, bool, usize)>, cluster: Option<&str>, confidence: f64) -> Result<Share, CurveFitError> {
        let exceeded = rows.iter().filter(|(_, does, _)| *does).count();
        let of_class =
            |class: bool| rows.iter().filter(move |(_, does, _)| *does == class).map(|(measure, ..)| *measure);
        let below = of_class(false).fold(0.0, f64::max);
        let above = of_class(true).fold(f64::INFINITY, f64::min);
        let curve = match exceeded {
            0 => ShareCurve::Step(f64::INFINITY),
            _ if exceeded == rows.len() => ShareCurve::Step(0.0),
            _ if below < above => ShareCurve::Step((below * above).sqrt()),
            _ => {
                let mut store = CaseStore::default();
                for (row, &(measure, does, motion)) in rows.iter().enumerate() {
                    let fraction = f64::from(u8::from(does));
                    let case = Case { row, fraction, unknown: 0.0, peak: None, motion: Some(motion) };
                    store.push(row as u64, &case, [Some(measure), Some(1.0)]);
                }
                let count = rows.iter().map(|(.., motion)| motion + 1).max().unwrap_or_default();
                let motions = Motions::in_order(cluster.map(String::from), count);
                let found = Assessment::of(store, &motions, Link::Logit, confidence, Uncertainty::Profile)?;
                ShareCurve::Logistic(Box::new(found))
            }
        };
        Ok(Share { cases: rows, curve })
    }

    /// Number of rows that do, and of all rows.
    pub fn counts(&self) -> [usize; 2] {
        [self.cases.iter().filter(|(_, does, _)| *does).count(), self.cases.len()]
    }

    /// The probability at a measure above zero.
    pub fn probability(&self, measure: f64) -> f64 {
        match &self.curve {
            ShareCurve::Logistic(found) => found.fit.probability(&[measure]),
            ShareCurve::Step(threshold) => f64::from(u8::from(measure >= *threshold)),
        }
    }
}

/// A cloud analysis: rotations of the blocks that rock and stand over a measure, beside those that overturn.
///
/// The median rotation is `exp(a) IM^b` times α. The probability of exceeding a rotation is that of F. Jalayer and others, Analytical
/// fragility assessment using unscaled ground motion records, EESD 46 (2017) 2639–2663, with the probability that a standing block rocks as
/// a third part.
pub struct Cloud {
    /// The line through ln(|θ|/α) over ln IM.
    pub line: Line,
    /// Intervals of its coefficients.
    pub intervals: [Interval; 2],
    /// Confidence level of the intervals.
    pub confidence: f64,
    /// Part of the variance of ln(|θ|/α) that the line describes.
    pub r_squared: f64,
    /// The probability of overturning, over all rows with a measure.
    pub overturning: Share,
    /// The probability that a standing block rocks.
    pub rocking: Share,
    /// Rows left out, whose outcome or measure is unknown.
    pub unknown: usize,
    /// Rows with an outcome left out for lack of a measure.
    pub without_measure: usize,
    /// Tests of the measure beside properties of the records, in the order of their columns.
    pub sufficiency: Vec<(String, CloudSufficiency)>,
    /// The measure and the peak of each row behind the line.
    pub points: Vec<[f64; 2]>,
    /// The symbol of the rotation.
    pub rotation: &'static str,
    columns: CloudColumns,
}

impl Cloud {
    /// Fits a cloud to the rows of blocks in the plane in the order of their table. `confidence` is above 0 and below 1.
    ///
    /// # Errors
    /// Fewer than three rows that rock and stand, a measure that is not above zero, a property that is missing or does not vary, and those of
    /// [`Assessment::of`].
    pub fn of(rows: &[CloudRow], columns: &CloudColumns, confidence: f64) -> Result<Cloud, CurveFitError> {
        let CloudColumns { im, beside, cluster } = columns;
        let shared = rows.iter().filter_map(|row| Some(row.motion? + 1)).max().unwrap_or_default();
        let known = rows
            .iter()
            .enumerate()
            .filter_map(|(number, row)| Some((row.measure?, row.motion.unwrap_or(shared + number), row)));
        let known: Vec<(f64, usize, &CloudRow)> = known.collect();
        if let Some((measure, ..)) = known.iter().find(|(measure, ..)| !(*measure > 0.0 && measure.is_finite())) {
            return Err(CurveFitError(format!("{im} = {measure} in a row; expected measures > 0")));
        }
        let rocking = || known.iter().filter_map(|(measure, motion, row)| Some((*measure, row.peak?, *motion, row)));
        let points: Vec<[f64; 2]> = rocking().map(|(measure, peak, ..)| [measure, peak]).collect();
        let motions: Vec<usize> = rocking().map(|(_, _, motion, _)| motion).collect();
        let [x, y] = [0, 1].map(|i| points.iter().map(|point: &[f64; 2]| libm::log(point[i])).collect::<Vec<f64>>());
        let Some(line) = Line::of(&x, &y, &motions) else {
            let found = points.len();
            return Err(CurveFitError(format!(
                "found {found} rows that rock and stand; expected three or more, at different {im}"
            )));
        };
        let test = |(i, name): (usize, &String)| {
            let property: Option<Vec<f64>> = rocking().map(|(.., row)| row.beside[i]).collect();
            let property = property.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
            let property = property.ok_or_else(|| {
                CurveFitError(format!("{name} is missing in a row that rocks and stands; expected a number in each"))
            })?;
            let found = Line::of(&property, &line.residuals, &motions).ok_or_else(|| {
                CurveFitError(format!("{name} does not vary; expected a property that differs between records"))
            })?;
            Ok((name.clone(), CloudSufficiency { slope: found.coefficients[1], p: found.p() }))
        };
        let sufficiency = beside.iter().enumerate().map(test).collect::<Result<Vec<_>, CurveFitError>>()?;
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let scatter: f64 = y.iter().map(|y| (y - mean) * (y - mean)).sum();
        let left: f64 = line.residuals.iter().map(|residual| residual * residual).sum();
        let share = |rows: Vec<(f64, bool, usize)>| Share::of(rows, cluster.as_deref(), confidence);
        let all: Vec<_> = known.iter().map(|(measure, motion, row)| (*measure, row.overturned, *motion)).collect();
        let standing = known.iter().filter(|(.., row)| !row.overturned);
        let standing: Vec<_> = standing.map(|(measure, motion, row)| (*measure, row.peak.is_some(), *motion)).collect();
        Ok(Cloud {
            intervals: line.intervals(confidence),
            confidence,
            r_squared: 1.0 - left / scatter,
            overturning: share(all)?,
            rocking: share(standing)?,
            unknown: rows.len() - known.len(),
            without_measure: rows.len() - known.len(),
            sufficiency,
            points,
            rotation: ROTATIONS[0],
            columns: columns.clone(),
            line,
        })
    }

    /// The units that errors, intervals and tests treat as independent, in words.
    pub fn units(&self) -> String {
        self.line.independence.words(self.columns.cluster.as_deref())
    }

    /// The median rotation of blocks that rock and stand, at a measure above zero.
    pub fn median(&self, measure: f64) -> f64 {
        let [a, b] = self.line.coefficients;
        libm::exp(a + b * libm::log(measure))
    }

    /// The scatter over the slope: the smaller, the better the measure (Padgett and others, 2008).
    pub fn proficiency(&self) -> f64 {
        self.line.deviation / self.line.coefficients[1]
    }

    /// The probability of exceeding a rotation above zero, at a measure above zero.
    pub fn exceedance(&self, rotation: f64, measure: f64) -> f64 {
        let collapse = self.overturning.probability(measure);
        let above = (libm::log(self.median(measure)) - libm::log(rotation)) / self.line.deviation;
        collapse + (1.0 - collapse) * self.rocking.probability(measure) * normal::probability(above)
    }

    /// Warnings of rows without the measure, and of both curves.
    pub fn warnings(&self) -> Vec<String> {
        let CloudColumns { im, .. } = &self.columns;
        let missing =
            (self.without_measure > 0).then(|| format!("{} rows without {im} are left out", self.without_measure));
        let of_curve = |share: &Share| match &share.curve {
            ShareCurve::Logistic(found) => found.warnings(im),
            ShareCurve::Step(_) => Vec::new(),
        };
        missing.into_iter().chain([&self.overturning, &self.rocking].into_iter().flat_map(of_curve)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(text: &str, beside: &[&str]) -> Result<Cloud, String> {
        let table = SweepTable::read("t.csv", text.as_bytes()).unwrap();
        let beside = beside.iter().map(|name| name.to_string()).collect();
        let mut rows = CloudRows::new(CloudColumns { im: "PGV".into(), beside, cluster: None });
        rows.take(&table, false).map_err(|error| error.to_string())?;
        rows.cloud(0.95).map_err(|error| error.to_string())
    }

    /// Rotations on 2 PGV²: the line finds them, all standing blocks above 0.1 m/s rock, and from 0.6 on all overturn.
    #[test]
    fn a_planted_cloud_is_found() {
        let mut text = "row,PGV [m/s],M,outcome,peak.theta/alpha [1]\n".to_string();
        for (row, pgv) in [0.05, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5].into_iter().enumerate() {
            let peak = if pgv < 0.1 { 0.0 } else { 2.0 * pgv * pgv };
            text += &format!("{row},{pgv},{},completed,{peak}\n", row % 3);
        }
        text += "7,0.7,1,overturned,9\n8,0.3,1,failed,\n9,,1,completed,0.4\n";
        let found = cloud(&text, &["M"]).unwrap();
        let [a, b] = found.line.coefficients;
        assert!((libm::exp(a) - 2.0).abs() < 1e-12 && (b - 2.0).abs() < 1e-12 && found.r_squared > 1.0 - 1e-12);
        assert_eq!((found.points.len(), found.unknown, found.without_measure), (6, 2, 1));
        assert_eq!(found.overturning.counts(), [1, 8]);
        assert_eq!(found.rocking.counts(), [6, 7]);
        let threshold = (0.5_f64 * 0.7).sqrt();
        assert_eq!([0.99, 1.01].map(|by| found.overturning.probability(by * threshold)), [0.0, 1.0]);
        // At the median of a standing block that rocks, one half exceeds the rotation.
        assert!((found.exceedance(found.median(0.3), 0.3) - 0.5).abs() < 1e-9);
        // Below the threshold no block rocks, and none exceeds a rotation that the line would.
        assert!(found.median(0.05) > 0.001 && found.exceedance(0.001, 0.05) == 0.0);
        assert_eq!(found.warnings(), ["1 rows without PGV are left out"]);
        let refused = |text: &str, beside: &[&str]| cloud(text, beside).err().unwrap();
        let few = "PGV,outcome,peak.theta/alpha\n1,completed,0.5\n2,completed,0.7\n";
        assert_eq!(refused(few, &[]), "found 2 rows that rock and stand; expected three or more, at different PGV");
        let constant = text.replace(",0,completed", ",1,completed").replace(",2,completed", ",1,completed");
        let expected = "M does not vary; expected a property that differs between records";
        assert_eq!(refused(&constant, &["M"]), expected);
        let negative = text.replace("0,0.05", "0,-0.05");
        assert_eq!(refused(&negative, &[]), "PGV = -0.05 in a row; expected measures > 0");
        let ensemble = "PGV,outcome,peak.theta/alpha,ensemble.samples\n1,completed,0.5,4\n";
        assert!(refused(ensemble, &[]).starts_with("t.csv: found an ensemble; expected"));
    }
}
