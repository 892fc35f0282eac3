//! Outcomes over an intensity measure → a fragility curve.

use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rocking_studies::fragility::{
    self as engine, Assessment, Case, ChosenRows, Collected, Component, Goodness, Interval, Limit, Link, LossProgram,
    RowCounts, RowOutcome, SweepTable, SweepTableError, Uncertainty, completed, is_needed, openquake, pelicun,
};
use rocking_studies::intensity::Measure;
use rocking_studies::output::parts::PartsError;
use rocking_studies::output::table::{Heading, Table};
use rocking_studies::statistics::range;

use crate::measures::{behind, column};
use crate::options::{choice, finite, invalid, pool, whole};
use crate::table::{GivenColumn, files, table};
use crate::work::wait;

/// Lower and upper ends. An end that the data do not bound is the limit of the possible values.
pub type Ends = (f64, f64);

/// Decided rows of a table, batch by batch; many are kept on disk.
#[pyclass(module = "rocking_block._engine")]
#[derive(Default)]
pub struct CaseStore(engine::CaseStore);

#[pymethods]
impl CaseStore {
    #[new]
    fn new() -> CaseStore {
        CaseStore::default()
    }

    /// Takes rows of a table for a fit. Each has its place, the measure, the fraction of its known runs that exceeded the limit, the fraction
    /// of its runs without a verdict, the peak of the blocks that rock and stand, and the number of the ground motion, negative for rows with
    /// their own. A missing measure or peak is nan, and so is the fraction of a row without a known run.
    ///
    /// A surface and a test of sufficiency also take the second measures. `unknown_exceed` says whether runs without a verdict exceed the limit; without it they are left out.
    #[pyo3(signature = (places, measures, fractions, unknown, peaks, motions, unknown_exceed, seconds=None))]
    #[allow(clippy::too_many_arguments)]
    fn push(
        &mut self,
        places: PyReadonlyArray1<i64>,
        measures: PyReadonlyArray1<f64>,
        fractions: PyReadonlyArray1<f64>,
        unknown: PyReadonlyArray1<f64>,
        peaks: PyReadonlyArray1<f64>,
        motions: PyReadonlyArray1<i64>,
        unknown_exceed: Option<bool>,
        seconds: Option<PyReadonlyArray1<f64>>,
    ) {
        let known = |value: f64| Some(value).filter(|value| !value.is_nan());
        let (places, measures, fractions) = (places.as_array(), measures.as_array(), fractions.as_array());
        let (unknown, peaks, motions) = (unknown.as_array(), peaks.as_array(), motions.as_array());
        let seconds = seconds.as_ref().map(PyReadonlyArray1::as_array);
        for row in 0..places.len() {
            let fraction = known(fractions[row]);
            let Some(fraction) = (match unknown_exceed {
                Some(exceed) => Some(completed(fraction, unknown[row], exceed)),
                None => fraction,
            }) else {
                continue;
            };
            let case = Case {
                row,
                fraction,
                // The range of their fraction is counted in Python.
                unknown: 0.0,
                peak: known(peaks[row]),
                motion: usize::try_from(motions[row]).ok(),
            };
            let second = seconds.as_ref().map_or(Some(1.0), |seconds| known(seconds[row]));
            self.0.push(places[row] as u64, &case, [known(measures[row]), second]);
        }
    }
}

/// A surface over two measures, attributes in Python.
#[pyclass(frozen, get_all, module = "rocking_block._engine")]
pub struct Surface {
    rows: usize,
    coefficients: (f64, f64, f64),
    standard_errors: (f64, f64, f64),
    log_likelihood: f64,
    auc: f64,
    brier: f64,
}

/// Fits a surface to the rows of a store with second measures, which is empty then.
#[pyfunction]
pub fn surface(py: Python, store: &mut CaseStore, motions: &Motions, link: &str) -> PyResult<Surface> {
    let link = choice("link", link, &[Link::Probit, Link::Logit])?;
    let (store, motions, pool) = (std::mem::take(&mut store.0), motions.0.clone(), pool(None)?);
    let found = py.detach(|| pool.install(|| engine::Surface::of(store, &motions, link))).map_err(invalid)?;
    let (c, e) = (&found.fit.coefficients, &found.standard_errors);
    Ok(Surface {
        rows: found.rows,
        coefficients: (c[0], c[1], c[2]),
        standard_errors: (e[0], e[1], e[2]),
        log_likelihood: found.fit.log_likelihood,
        auc: found.auc,
        brier: found.brier,
    })
}

/// Returns the p-value of the hypothesis that the first measures of a store, which is empty then, are sufficient beside the second ones.
#[pyfunction]
pub fn sufficiency(py: Python, store: &mut CaseStore, motions: &Motions, link: &str) -> PyResult<f64> {
    let link = choice("link", link, &[Link::Probit, Link::Logit])?;
    let (store, motions, pool) = (std::mem::take(&mut store.0), motions.0.clone(), pool(None)?);
    py.detach(|| pool.install(|| engine::sufficiency_of(store, &motions, link))).map_err(invalid)
}

/// Returns the probabilities at these values of a linear predictor.
#[pyfunction]
pub fn link_probabilities<'py>(
    py: Python<'py>,
    link: &str,
    predictors: PyReadonlyArray1<f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let link = choice("link", link, &[Link::Probit, Link::Logit])?;
    Ok(PyArray1::from_iter(py, predictors.as_array().iter().map(|predictor| link.probability(*predictor))))
}

/// The ground motions of a table.
#[pyclass(module = "rocking_block._engine")]
pub struct Motions(engine::Motions);

#[pymethods]
impl Motions {
    /// Motions with these numbers in the order of their first rows.
    #[staticmethod]
    fn in_order(cluster: Option<String>, count: usize) -> Motions {
        Motions(engine::Motions::in_order(cluster, count))
    }

    #[getter]
    fn cluster(&self) -> Option<String> {
        self.0.cluster.clone()
    }
}

/// The outcomes of a table's rows relative to a limit, taken batch by batch.
#[pyclass(module = "rocking_block._engine")]
pub struct Cases {
    im: String,
    /// The names of the columns that are read whatever the study.
    named: Vec<String>,
    rows: ChosenRows,
    found: Collected,
    /// Number of rows of the batches before, including those that do not count.
    before: usize,
    /// The measure, after the first batch.
    heading: Option<Heading>,
    unknown_exceed: Option<bool>,
    /// The rows, if they are kept.
    kept: Option<KeptRows>,
}

#[pymethods]
impl Cases {
    /// Begins with the measure, the limit, the usual one by default, the column of clusters, and columns with the values of the rows that
    /// count. `unknown_exceed` is the outcome of runs without a verdict in the store, which are left out without it; `keep` keeps the rows.
    #[new]
    fn new(
        im: String,
        limit: Option<&str>,
        cluster: Option<String>,
        conditions: Vec<(String, String)>,
        unknown_exceed: Option<bool>,
        keep: bool,
    ) -> PyResult<Cases> {
        let limit = limit.map(str::parse).transpose().map_err(invalid)?;
        let columns = conditions.iter().map(|(column, _)| column).chain(&cluster);
        let named = std::iter::once(&im).chain(columns).cloned().collect();
        let found = Collected::new(limit, cluster, vec![(im.clone(), None)]);
        let found = if unknown_exceed.is_some() { found.with_completions() } else { found };
        let (rows, kept) = (ChosenRows::new(conditions), keep.then(Default::default));
        Ok(Cases { im, named, rows, found, before: 0, heading: None, unknown_exceed, kept })
    }

    /// Whether a column is read.
    fn needs(&self, column: &str) -> bool {
        is_needed(column, &self.named)
    }

    /// Takes a batch of rows of a table with all these headings; rows of parts are in the order of their numbers, others in that of the
    /// batches.
    fn take(&mut self, file: &str, columns: Vec<GivenColumn>, headings: Vec<String>, is_part: bool) -> PyResult<()> {
        self.take_table(file, table(columns), headings, is_part).map_err(invalid)
    }

    /// Takes the rows of a table in CSV, or of the parts of a study.
    fn read(&mut self, py: Python, path: PathBuf, partial: bool) -> PyResult<()> {
        let files = files(&path, partial).map_err(invalid)?;
        let (name, is_part) = (path.display().to_string(), files.are_numbered());
        let named = self.named.clone();
        let is_wanted = |column: &str| is_needed(column, &named);
        let mut take = |table: Table, headings: &[String]| -> Result<(), Ended> {
            py.check_signals()?;
            Ok(self.take_table(&name, table, headings.to_vec(), is_part).map_err(invalid)?)
        };
        files.read_batches(&is_wanted, &mut take).map_err(|Ended(error)| error)
    }

    /// Refuses a table none of whose rows met a condition.
    fn check(&self, file: &str) -> PyResult<()> {
        self.rows.check(file).map_err(invalid)
    }

    /// The store and the motions, which are empty afterwards.
    fn stored(&mut self) -> (CaseStore, Motions) {
        let Collected { stores, completions, motions, .. } = &mut self.found;
        let store = match (completions, self.unknown_exceed) {
            (Some(completions), Some(exceed)) => std::mem::take(&mut completions[usize::from(exceed)]),
            _ => std::mem::take(&mut stores[0]),
        };
        (CaseStore(store), Motions(std::mem::take(motions)))
    }

    /// The kept rows, as [`CaseStore::push`] takes them; `None` afterwards. Motions are numbered by their first rows: call it before
    /// `stored`.
    fn kept<'py>(&mut self, py: Python<'py>) -> Option<Rows<'py>> {
        let KeptRows { measures, fractions, unknown, peaks, mut motions } = self.kept.take()?;
        let ranks = self.found.motions.ranks();
        for motion in motions.iter_mut().filter(|motion| **motion >= 0) {
            *motion = ranks[*motion as usize] as i64;
        }
        let [measures, fractions, unknown, peaks] =
            [measures, fractions, unknown, peaks].map(|numbers| PyArray1::from_vec(py, numbers));
        Some((measures, fractions, unknown, peaks, PyArray1::from_vec(py, motions)))
    }

    /// The name and the unit of the measure.
    #[getter]
    fn heading(&self) -> (String, Option<String>) {
        self.heading.as_ref().map_or((self.im.clone(), None), |heading| (heading.name.clone(), heading.unit.clone()))
    }

    /// The word of the limit.
    #[getter]
    fn limit(&self) -> String {
        self.found.limit.unwrap_or(Limit::Overturned).to_string()
    }

    /// Numbers of all rows, of failed, separated and undecided ones, of those without the response of the limit, and of ensembles with
    /// samples without a known outcome.
    #[getter]
    fn counts(&self) -> [usize; 6] {
        let RowCounts { all, failed, separated, undecided, without_response, partly_known, .. } = self.found.counts;
        [all, failed, separated, undecided, without_response, partly_known]
    }

    /// Least and greatest number of rows that exceed the limit.
    #[getter]
    fn exceeded(&self) -> Ends {
        (self.found.counts.exceeded, self.found.counts.exceeded_at_most)
    }
}

/// Rows as [`CaseStore::push`] takes them.
#[derive(Default)]
struct KeptRows {
    measures: Vec<f64>,
    fractions: Vec<f64>,
    unknown: Vec<f64>,
    peaks: Vec<f64>,
    motions: Vec<i64>,
}

/// Measures, fractions, fractions without a verdict, peaks and motions of rows.
type Rows<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
);

impl Cases {
    fn take_table(
        &mut self,
        file: &str,
        table: Table,
        headings: Vec<String>,
        is_part: bool,
    ) -> Result<(), SweepTableError> {
        let first = self.before;
        self.before += table.rows();
        let mut batch = SweepTable::batch(file, table, headings, first)?;
        self.rows.keep(&mut batch)?;
        self.heading = Some(batch.column(&self.im)?.heading.clone());
        let rows = self.found.take(&batch, is_part)?;
        if let Some(kept) = &mut self.kept {
            kept.measures.extend(batch.numbers(&self.im)?.into_iter().map(|measure| measure.unwrap_or(f64::NAN)));
            for RowOutcome { fraction, unknown, peak, motion, .. } in rows {
                kept.fractions.push(fraction.unwrap_or(f64::NAN));
                kept.unknown.push(unknown);
                kept.peaks.push(peak.unwrap_or(f64::NAN));
                kept.motions.push(motion.map_or(-1, |number| number as i64));
            }
        }
        Ok(())
    }
}

/// The exception that ends the reading of a table.
struct Ended(PyErr);

impl From<PyErr> for Ended {
    fn from(error: PyErr) -> Ended {
        Ended(error)
    }
}

impl From<PartsError> for Ended {
    fn from(error: PartsError) -> Ended {
        Ended(invalid(error))
    }
}

/// A curve with its uncertainty and predictive power. The Python class of the same name has the documentation.
#[pyclass(frozen, subclass, extends = CurveNumbers, module = "rocking_block._engine")]
pub struct Fragility(pub Assessment);

#[pymethods]
impl Fragility {
    /// Fits the rows of a store, which is empty then, with their motions. With `samples` the intervals come
    /// from a bootstrap, otherwise from the profile likelihood.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python,
        store: &mut CaseStore,
        motions: &Motions,
        link: &str,
        ci: f64,
        samples: Option<i64>,
        seed: i64,
        tick: &Bound<PyAny>,
    ) -> PyResult<PyClassInitializer<Fragility>> {
        let link = choice("link", link, &[Link::Probit, Link::Logit])?;
        finite("ci", ci, |x| x > 0.0 && x < 1.0, "a number above 0 and below 1")?;
        let seed = whole("seed", seed, 0..=i64::MAX)?;
        let samples = samples.map(|samples| whole("samples", samples, 2..=1_000_000)).transpose()?;
        let uncertainty = samples.map_or(Uncertainty::Profile, |samples| Uncertainty::Bootstrap(samples as u32, seed));
        let (store, motions) = (std::mem::take(&mut store.0), motions.0.clone());
        let pool = pool(None)?;
        let fit = move || Assessment::of(store, &motions, link, ci, uncertainty);
        let found = wait(py, tick, move |_| pool.install(fit))?;
        let found = found.map_err(invalid)?;
        Ok(PyClassInitializer::from(CurveNumbers::of(&found)).add_subclass(Fragility(found)))
    }

    /// Returns measures and fractions of rows, in the order of their measures. Of many rows they are some 10,000.
    fn marks<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        let rows = self.0.marks();
        [
            PyArray1::from_iter(py, rows.iter().map(|row| row.measures[0])),
            PyArray1::from_iter(py, rows.iter().map(|row| row.fraction)),
        ]
    }

    /// Returns warnings of missing intervals, and of a curve that falls; `heading` is the name and unit of the measure.
    fn warnings(&self, heading: &str) -> Vec<String> {
        self.0.warnings(heading)
    }

    /// Returns the probabilities at measures above zero.
    fn probabilities<'py>(
        &self,
        py: Python<'py>,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let probabilities = at(&measures)?.into_iter().map(|measure| self.0.fit.probability(&[measure]));
        Ok(PyArray1::from_iter(py, probabilities))
    }

    /// Returns the ends of the pointwise interval of the probability at measures above zero.
    fn intervals<'py>(
        &self,
        py: Python<'py>,
        measures: PyReadonlyArray1<f64>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
        let measures = at(&measures)?;
        let pool = pool(None)?;
        let found = py.detach(|| pool.install(|| self.0.band(&measures)));
        let (low, high): (Vec<f64>, Vec<f64>) = found.into_iter().map(|interval| ends(interval, 0.0, 1.0)).unzip();
        Ok([PyArray1::from_vec(py, low), PyArray1::from_vec(py, high)])
    }
}

/// The numbers of a curve, attributes in Python.
#[pyclass(frozen, subclass, get_all, module = "rocking_block._engine")]
pub struct CurveNumbers {
    /// Number of rows in the fit.
    rows: usize,
    /// Number of rows in the fit that exceed the limit: the sum of their fractions.
    exceeded: f64,
    /// Least and greatest measure.
    range: Ends,
    median: f64,
    median_ci: Ends,
    beta: f64,
    beta_ci: Ends,
    coefficients: (f64, f64),
    standard_errors: (f64, f64),
    log_likelihood: f64,
    auc: f64,
    brier: f64,
    /// Deviance, degrees of freedom and p-value; none for fewer than three groups of rows.
    goodness: Option<(f64, usize, f64)>,
    efficiency: f64,
    rocking: usize,
    independence: String,
}

impl CurveNumbers {
    fn of(found: &Assessment) -> CurveNumbers {
        let [least, greatest] = range(found.marks().iter().map(|row| row.measures[0])).unwrap_or([f64::NAN; 2]);
        let (beta, errors) = (found.fit.dispersion(), found.standard_errors());
        CurveNumbers {
            rows: found.rows,
            exceeded: found.data.observations().iter().map(|row| row.weight * row.fraction).sum(),
            range: (least, greatest),
            median: found.fit.median(),
            median_ci: ends(found.median, 0.0, f64::INFINITY),
            beta,
            // If the probability falls as the measure grows, the dispersion is negative.
            beta_ci: match beta > 0.0 {
                true => ends(found.dispersion, 0.0, f64::INFINITY),
                false => ends(found.dispersion, f64::NEG_INFINITY, 0.0),
            },
            coefficients: (found.fit.coefficients[0], found.fit.coefficients[1]),
            standard_errors: (errors[0], errors[1]),
            log_likelihood: found.fit.log_likelihood,
            auc: found.auc,
            brier: found.brier,
            goodness: found
                .goodness()
                .map(|Goodness { deviance, degrees_of_freedom, p }| (deviance, degrees_of_freedom, p)),
            efficiency: found.efficiency.unwrap_or(f64::NAN),
            rocking: found.rocking,
            independence: found.units(),
        }
    }
}

/// Checks that measures are above zero.
pub fn at(measures: &PyReadonlyArray1<f64>) -> PyResult<Vec<f64>> {
    let measures = measures.as_array().to_vec();
    measures.iter().try_for_each(|&measure| finite("x", measure, |x| x > 0.0, "a measure > 0"))?;
    Ok(measures)
}

pub fn ends([low, high]: Interval, least: f64, greatest: f64) -> Ends {
    (low.unwrap_or(least), high.unwrap_or(greatest))
}

/// A component of an export. It has an identifier, name and unit of the measure of its curves, limits with their curves, and a description.
type Curves<'py> = (String, (String, String), Vec<(String, PyRef<'py, Fragility>)>, String);

/// Returns the text of each file for a program of loss assessment. Remarks on crossing curves follow.
#[pyfunction]
pub fn export_fragility(
    program: &str,
    components: Vec<Curves>,
    alpha: Option<f64>,
    p: Option<f64>,
    g: f64,
) -> PyResult<(Vec<String>, Vec<String>)> {
    let program = choice("program", program, &[LossProgram::Pelicun, LossProgram::OpenQuake])?;
    let component = |(id, over, curves, description): &Curves| -> PyResult<Component> {
        let (behind, factor) = behind(&column(over), alpha, p, g)?;
        let measure: Measure = behind.name.parse().map_err(invalid)?;
        let limits = curves.iter().map(|(limit, _)| limit.parse()).collect::<Result<Vec<Limit>, _>>();
        let fits = curves.iter().map(|(_, curve)| &curve.0.fit);
        Component::new(id, measure, factor, limits.map_err(invalid)?.into_iter().zip(fits), description)
            .map_err(invalid)
    };
    let components = components.iter().map(component).collect::<PyResult<Vec<_>>>()?;
    let files = match program {
        LossProgram::Pelicun => pelicun(&components, g).map(Vec::from),
        LossProgram::OpenQuake => openquake(&components, g).map(|text| vec![text]),
    };
    Ok((files.map_err(invalid)?, components.iter().flat_map(Component::crossings).collect()))
}
