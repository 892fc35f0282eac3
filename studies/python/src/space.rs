//! A block in space and its excitation → columns over time, or outcomes of many motions.

use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::path::{Path, PathBuf};

use numpy::PyArray1;
use pyo3::exceptions::{PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::excitation::PulseShape;
use rocking_block::excitation::records::Ground;
use rocking_block::space::{FootPlace, SpaceBody, SpaceGround, SpaceInitial, SpaceParameters};
use rocking_charts::sketch::SketchInSpace;
use rocking_studies::doubts;
use rocking_studies::intensity::{BlockScales, Measure};
use rocking_studies::output::runner::StudyRows;
use rocking_studies::output::table::Heading;
use rocking_studies::output::table::TableColumn;
use rocking_studies::run::MemoryError;
use rocking_studies::run::rows::RunRow;
use rocking_studies::space::ground::{ComponentNames, check_azimuth, of_components};
use rocking_studies::space::{HistoryInSpace, RunInSpace, facts, foot_names, outcome, table};
use rocking_studies::spec::numbers_in_space::BeginningSpec;
use rocking_studies::spec::space::{BaseShape, FeetSpec, feet_of_table};
use rocking_studies::spec::words::Words;
use rocking_studies::spec::{BlockSpec, SpaceSpec};
use rocking_studies::sweep::ground_motion::{GroundMotion, Transverse};

use crate::block::{number, refused, set};
use crate::options::{PulseOptions, RunOptions, choice, finite, invalid, pool, warn};
use crate::record::{Record, check_periods};
use crate::studies::{Columns, batches, for_python};
use crate::work::wait;

/// The components by the names of Python.
pub const COMPONENTS: ComponentNames = ComponentNames {
    names: ["x", "y", "vertical"],
    resample: "Record.processed(resample=...) gives all components one step",
    cut: "cut the components to the samples that all have",
};

/// The parameters of a block in space; the Python class of the same name adds the methods.
#[pyclass(frozen, subclass, extends = NumbersInSpace, eq, hash, module = "rocking_block._engine")]
pub struct BlockInSpace {
    /// The parameters as given.
    given: Py<PyDict>,
    pub parameters: SpaceParameters,
    pub body: SpaceBody,
}

impl PartialEq for BlockInSpace {
    fn eq(&self, other: &BlockInSpace) -> bool {
        self.parameters == other.parameters
    }
}

impl Hash for BlockInSpace {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // Adding zero turns −0 into 0, so that equal blocks have equal hashes.
        facts::of_block(&self.parameters, &self.body).map(|(_, value)| (value + 0.0).to_bits()).hash(state);
    }
}

#[pymethods]
impl BlockInSpace {
    /// Returns the block of these parameters, which `_block_in_space.py` lists.
    #[new]
    #[pyo3(signature = (**parameters))]
    fn new(py: Python, parameters: Option<&Bound<PyDict>>) -> PyResult<PyClassInitializer<BlockInSpace>> {
        let (mut own, mut shared, mut places) = (SpaceSpec::default(), BlockSpec::default(), None);
        let given = PyDict::new(py);
        for (name, value) in parameters.into_iter().flatten().filter(|(_, value)| !value.is_none()) {
            given.set_item(&name, &value)?;
            match name.extract()? {
                "base" => {
                    let shapes = BaseShape::WORDS.iter().map(|(_, shape)| *shape).collect::<Vec<_>>();
                    own.base = Some(choice("base", &value.str()?.to_string(), &shapes)?);
                }
                "feet" => (own.feet, places) = feet(&value)?,
                "inertia_tensor" => own.inertia_tensor = Some(value.extract()?),
                name => match own.numbers_mut().into_iter().find(|(known, _)| *known == name) {
                    Some((_, field)) => *field = Some(number(name, &value)?),
                    None => set(&mut shared, name, &value)?,
                },
            }
        }
        let read = |path: &Path| match places {
            Some(feet) => Ok(feet),
            None => {
                let name = path.display().to_string();
                let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
                feet_of_table(&name, &text)
            }
        };
        let parameters = own.parameters(&shared, read).map_err(refused)?;
        let body = SpaceBody::new(&parameters).map_err(invalid)?;
        warn(py, doubts::of_blocks_in_space([(parameters.clone(), body.clone(), shared.mass.is_some())]), 2)?;
        let numbers = NumbersInSpace::of(&parameters, &body);
        Ok(PyClassInitializer::from(numbers).add_subclass(BlockInSpace { given: given.unbind(), parameters, body }))
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, PyDict>)> {
        Ok(((), self.parameters(py)?))
    }

    /// Returns the parameters as given.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.given.bind(py).copy()
    }

    /// Returns I_xx, I_yy, I_zz, I_xy, I_xz, I_yz [kg m²].
    #[getter]
    fn _inertia(&self) -> [f64; 6] {
        facts::inertia(&self.body)
    }

    /// Returns the sketch of `rocking sketch` as SVG, which notebooks show.
    fn _repr_svg_(&self, py: Python) -> PyResult<String> {
        let has_height = !self.given.bind(py).contains("center_height")?;
        let height = has_height.then_some(2.0 * self.body.center_height);
        SketchInSpace { parameters: &self.parameters, body: &self.body, height }.svg().map_err(invalid)
    }

    /// Returns x and y of each foot from the centre of mass, and its gap [m].
    #[getter]
    fn _feet(&self) -> Vec<[f64; 3]> {
        facts::feet(&self.body)
    }

    /// Returns the names of the feet.
    #[getter]
    fn foot_names(&self) -> Vec<String> {
        foot_names(&self.parameters)
    }
}

/// Returns the number of feet of a circle, or the places of feet: a file, or rows of x, y and perhaps a gap.
fn feet(value: &Bound<PyAny>) -> PyResult<(Option<FeetSpec>, Option<Vec<FootPlace>>)> {
    if let Ok(count) = value.extract() {
        return Ok((Some(FeetSpec::Count(count)), None));
    }
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok((Some(FeetSpec::File(path)), None));
    }
    let expected = "expected the number of feet of a circle, a file, or an array of shape (n, 2) or (n, 3)";
    let rows: Vec<Vec<f64>> = value.extract().map_err(|_| PyTypeError::new_err(format!("feet: {expected}")))?;
    let place = |row: &Vec<f64>| match row[..] {
        [x, y] => Ok(FootPlace { x, y, gap: 0.0 }),
        [x, y, gap] => Ok(FootPlace { x, y, gap }),
        _ => Err(PyValueError::new_err(format!("feet: found a row of {} numbers; {expected}", row.len()))),
    };
    let places = rows.iter().map(place).collect::<PyResult<_>>()?;
    Ok((Some(FeetSpec::File("feet".into())), Some(places)))
}

/// The numbers of a block in space, attributes in Python.
#[pyclass(frozen, subclass, get_all, module = "rocking_block._engine")]
#[allow(non_snake_case)]
pub struct NumbersInSpace {
    alpha: f64,
    alpha_edge: f64,
    p: f64,
    omega_v: f64,
    xi_v: f64,
    kappa: f64,
    xi_h: f64,
    friction: f64,
    R0: f64,
    width: f64,
    center_height: f64,
    mass: f64,
    g: f64,
    K: f64,
    C: f64,
    K_h: f64,
    C_h: f64,
}

impl NumbersInSpace {
    #[allow(non_snake_case)]
    fn of(parameters: &SpaceParameters, body: &SpaceBody) -> NumbersInSpace {
        let [
            alpha,
            alpha_edge,
            p,
            omega_v,
            xi_v,
            kappa,
            xi_h,
            friction,
            R0,
            width,
            center_height,
            mass,
            g,
            K,
            C,
            K_h,
            C_h,
        ] = facts::of_block(parameters, body).map(|(_, value)| value);
        NumbersInSpace {
            alpha,
            alpha_edge,
            p,
            omega_v,
            xi_v,
            kappa,
            xi_h,
            friction,
            R0,
            width,
            center_height,
            mass,
            g,
            K,
            C,
            K_h,
            C_h,
        }
    }
}

/// The initial state of a block in space: a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct InitialInSpace {
    tilt_x: f64,
    tilt_y: f64,
    twist: f64,
    omega_x: f64,
    omega_y: f64,
    omega_z: f64,
    v: Option<f64>,
    v_dot: Option<f64>,
}

impl InitialInSpace {
    fn initial(&self) -> PyResult<SpaceInitial> {
        let InitialInSpace { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot } = *self;
        let [tilt_x, tilt_y, twist] = [tilt_x, tilt_y, twist].map(Some);
        let [omega_x, omega_y, omega_z] = [omega_x, omega_y, omega_z].map(Some);
        BeginningSpec { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot }.initial().map_err(refused)
    }
}

/// The components of a ground motion.
pub type Components<'py> = [Option<Bound<'py, Record>>; 3];

/// Returns the motion of the ground, turned by the azimuth, which needs a component x or a pulse.
pub fn ground(
    components: &Components,
    scale: f64,
    azimuth: f64,
    has_pulse: bool,
    known_as: ComponentNames,
) -> PyResult<SpaceGround> {
    finite("scale", scale, |_| true, "a finite factor")?;
    finite("azimuth", azimuth, |_| true, "a finite angle")?;
    check_azimuth("azimuth", azimuth != 0.0, components[0].is_some(), has_pulse).map_err(PyValueError::new_err)?;
    let records = components.each_ref().map(|record| record.as_ref().map(|record| record.get().record.clone()));
    let scaled = records.map(|record| record.map(|record| record.scaled(scale)));
    of_components(scaled, azimuth.to_radians(), known_as).map_err(PyValueError::new_err)
}

/// Returns the history of a block in space: a dictionary with `columns`, `events`, `peak`, `counts` and the outcome.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn history_in_space<'py>(
    py: Python<'py>,
    block: &Bound<'py, BlockInSpace>,
    components: Components<'py>,
    scale: f64,
    azimuth: f64,
    pulse: Option<PulseOptions>,
    beginning: InitialInSpace,
    options: RunOptions,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let has_record = components.iter().any(Option::is_some);
    if !has_record && scale != 1.0 {
        return Err(PyValueError::new_err("scale has no effect without a record"));
    }
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let ground = ground(&components, scale, azimuth, pulse.shape != PulseShape::None, COMPONENTS)?;
    let initial = beginning.initial()?;
    if !has_record && pulse.shape == PulseShape::None && initial == SpaceInitial::default() {
        return Err(PyValueError::new_err("nothing moves the block; expected a record, a pulse or an initial state"));
    }
    warn(py, doubts::of_end(&pulse, has_record), 2)?;
    let time_step = ground.records.iter().flatten().map(|record| record.time_step).reduce(f64::min);
    let (BlockInSpace { parameters, body, .. }, settings) = (block.get(), options.settings()?);
    let run = RunInSpace {
        initial,
        ground,
        duration: options.duration,
        output_step: options.step.or(time_step).unwrap_or(0.01),
        ..RunInSpace::at_rest(parameters.clone(), body.clone(), settings).with_pulse(pulse, azimuth)
    };
    run.check_memory().map_err(|error| match error {
        MemoryError::TooManyRows(_) => invalid(error),
        MemoryError::Refused(message) => PyMemoryError::new_err(message),
    })?;
    const PARTS: u64 = 1000;
    let history = wait(py, tick, move |progress| {
        run.history(|fraction| progress.advance((fraction * PARTS as f64) as u64, PARTS))
    })?;
    shown(py, block.get(), &history.map_err(invalid)?)
}

fn shown<'py>(py: Python<'py>, block: &BlockInSpace, history: &HistoryInSpace) -> PyResult<Bound<'py, PyDict>> {
    let HistoryInSpace { rows, events, peaks, counts, ending, end, .. } = history;
    let (columns, units) = (PyDict::new(py), PyDict::new(py));
    for column in table::columns(&block.parameters) {
        let Heading { name, unit, .. } = column.heading();
        columns.set_item(name, PyArray1::from_iter(py, rows.iter().map(|row| column.number(row))))?;
        units.set_item(name, unit)?;
    }
    let names = foot_names(&block.parameters);
    let events = events.iter().map(|event| {
        let (word, foot) = facts::word(event.kind);
        (event.time, word, foot.map(|foot| names[foot].clone()))
    });
    let last = rows.last().map_or(0.0, |row| row.observation.time);
    let result = PyDict::new(py);
    result.set_item("columns", columns)?;
    result.set_item("units", units)?;
    result.set_item("events", events.collect::<Vec<_>>())?;
    result.set_item("peak", facts::of_peaks(peaks).map(|(_, value)| value))?;
    let of_events = [counts.lift_offs, counts.landings, counts.slides, counts.sticks];
    result.set_item("counts", (of_events, [counts.steps, counts.rejected, counts.evaluations]))?;
    result.set_item("outcome", end.word())?;
    result.set_item("end_time", ending.map_or(last, |(_, time)| time))?;
    result.set_item("is_at_rest", history.is_at_rest)?;
    result.set_item("separated", history.separated)?;
    Ok(result)
}

/// A row of outcomes in space: the ground motion and the factor on it.
type Row<'a> = RunRow<(&'a GroundMotion, f64), RunInSpace>;

/// Returns the outcome of each motion at each scale and azimuth [degrees], motion by motion, then scale by scale: the measures and the columns of
/// runs of a sweep, and the reason of the first failed run.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn outcomes_in_space<'py>(
    py: Python<'py>,
    block: &Bound<'py, BlockInSpace>,
    motions: Vec<Components<'py>>,
    scales: Vec<f64>,
    azimuths: Vec<f64>,
    periods: Vec<f64>,
    pulse: Option<PulseOptions>,
    options: RunOptions,
    threads: Option<i64>,
    tick: &Bound<'py, PyAny>,
) -> PyResult<Columns<'py>> {
    let pulse = PulseOptions::pulse_or_none(pulse.as_ref())?;
    let (pool, settings, duration) = (pool(threads)?, options.settings()?, options.duration);
    check_periods(&periods)?;
    scales.iter().try_for_each(|&scale| finite("scale", scale, |_| true, "a finite factor"))?;
    let BlockInSpace { parameters, body, .. } = block.get();
    let of_pair = Measure::of_pair(&periods);
    let mut turned = Vec::new();
    for motion in &motions {
        // Refuses components that do not belong together, and an azimuth without them.
        let has_pulse = pulse.shape != PulseShape::None;
        azimuths.iter().try_for_each(|&azimuth| ground(motion, 1.0, azimuth, has_pulse, COMPONENTS).map(|_| ()))?;
        let [horizontal, y, vertical] =
            motion.each_ref().map(|record| record.as_ref().map(|record| record.get().record.clone()));
        let transverse = y.map(|record| Transverse { file: String::new(), name: String::new(), record });
        let records = Ground { horizontal, vertical };
        let motion = GroundMotion::of_components(Default::default(), records, transverse, &of_pair, body.gravity);
        turned.push(azimuths.iter().map(|&azimuth| motion.turned(azimuth)).collect::<Vec<_>>());
    }
    let has_pair = motions.iter().any(|[x, ..]| x.is_some());
    let shown = if has_pair { [of_pair, Measure::of_pair_to_block()].concat() } else { Vec::new() };
    let (parameters, body) = (parameters.clone(), body.clone());
    let (of_block, count) = (BlockScales::from(&body), motions.len() * scales.len() * azimuths.len());
    let made = wait(py, tick, move |progress| {
        let case = |number: usize| {
            let (of_scale, azimuth) = (number / azimuths.len(), number % azimuths.len());
            (&turned[of_scale / scales.len()][azimuth], scales[of_scale % scales.len()])
        };
        let at_rest = RunInSpace::at_rest(parameters, body, settings);
        let run = |(motion, scale): (&GroundMotion, f64)| RunInSpace {
            ground: motion.in_space(scale),
            duration,
            ..at_rest.clone().with_pulse(pulse, motion.azimuth)
        };
        let measures = shown.iter().map(|&measure| {
            TableColumn::optional(measure.to_string(), measure.unit(), move |row: &Row| {
                row.inputs.0.intensity(measure, row.inputs.1, of_block)
            })
        });
        let columns: Vec<_> = measures.chain(outcome::columns(|row: &Row| &row.outcome)).collect();
        let make = |numbers: Range<u64>| {
            let rows = numbers.map(|number| case(number as usize)).map(|case| (case, run(case))).collect();
            RunRow::table(&columns, &RunRow::all(None, rows, |_| [], || progress.end_if_abandoned()))
        };
        let mut made = StudyRows::default();
        batches(&pool, None, count as u64, 1, progress, make, |batch| made.append(batch));
        made
    })?;
    for_python(py, made)
}
