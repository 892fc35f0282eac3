//! Parameters → a block.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rocking_block::block::restraints::LinkKind;
use rocking_block::block::{self as engine, BlockParameters, Corner, Foundation};
use rocking_studies::doubts;
use rocking_studies::spec::words::{Words, friction};
use rocking_studies::spec::{BlockSpec, SpecError};

use crate::options::{choice, friction_of_block, warn};
use crate::tie;

/// All foundations.
pub const FOUNDATIONS: [Foundation; 2] = [Foundation::Viscoelastic, Foundation::Rigid];

/// The parameters of a block; the Python class of the same name adds the methods.
#[pyclass(frozen, subclass, extends = BlockNumbers, eq, hash, module = "rocking_block._engine")]
#[derive(Clone, Debug)]
pub struct Block {
    /// The parameters as given.
    spec: BlockSpec,
    pub block: engine::Block,
}

impl PartialEq for Block {
    fn eq(&self, other: &Block) -> bool {
        self.block == other.block
    }
}

impl Hash for Block {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let engine::Block { alpha, gamma, epsilon, restitution_factor, body, .. } = self.block;
        let engine::Body { p, omega_v, xi_v, mass, gravity, eccentricity, friction, .. } = body;
        // Adding zero turns −0 into 0, so that equal blocks have equal hashes.
        [alpha, p, omega_v, xi_v, mass, gamma, epsilon, gravity, restitution_factor, eccentricity, friction]
            .map(|value| (value + 0.0).to_bits())
            .hash(state);
    }
}

impl Block {
    /// Returns the parameters of this block as given.
    pub fn block_parameters(&self) -> PyResult<BlockParameters> {
        self.spec.parameters().map_err(refused)
    }
}

#[pymethods]
impl Block {
    /// Returns the block of these parameters, which `_block.py` lists.
    #[new]
    #[pyo3(signature = (**parameters))]
    fn new(py: Python, parameters: Option<&Bound<PyDict>>) -> PyResult<PyClassInitializer<Block>> {
        let mut spec = BlockSpec::default();
        for (name, value) in parameters.into_iter().flatten().filter(|(_, value)| !value.is_none()) {
            set(&mut spec, name.extract()?, &value)?;
        }
        let block = Block::of(spec)?;
        warn_of_blocks(py, &[block.block], 2)?;
        Ok(block.with_numbers())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, PyDict>)> {
        Ok(((), self.parameters(py)?))
    }

    /// Returns the parameters that define this block: the explicit ones and those common to all blocks.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for (name, value) in self.spec.numbers() {
            // A copy with ties or springs needs the mass; an explicit moment of inertia determines the shape factor.
            let value = match name {
                "mass" => Some(self.block.mass),
                "epsilon" => Some(self.block.epsilon),
                "g" => Some(self.block.gravity),
                "gamma" if self.spec.inertia.is_none() => Some(self.block.gamma),
                "eccentricity" => value.filter(|&value| value != 0.0),
                "friction" => value.filter(|&value| value != f64::INFINITY),
                _ => value,
            };
            if let Some(value) = value {
                parameters.set_item(name, value)?;
            }
        }
        for (name, links) in [("ties", self.ties(py)?), ("dampers", self.dampers(py)?)] {
            if !links.is_empty() {
                parameters.set_item(name, links)?;
            }
        }
        parameters.set_item("foundation", self.foundation())?;
        Ok(parameters)
    }

    /// Returns the names of the numbers that define blocks.
    #[staticmethod]
    #[pyo3(name = "_names")]
    fn names() -> Vec<&'static str> {
        BlockSpec::default().numbers().map(|(name, _)| name).into()
    }

    /// Returns the names of those that a foundation does not have.
    #[staticmethod]
    #[pyo3(name = "_names_of_other_foundation")]
    fn names_of_other_foundation(foundation: &str) -> PyResult<Vec<&'static str>> {
        Ok(BlockSpec::of_other_foundation(choice("foundation", foundation, &FOUNDATIONS)?).into())
    }

    #[getter]
    fn foundation(&self) -> &'static str {
        self.block.foundation.word()
    }

    #[getter]
    fn ties<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        tie::of_kind(LinkKind::Tie, self.block.ties(), py)
    }

    #[getter]
    fn dampers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        tie::of_kind(LinkKind::Damper, self.block.ties(), py)
    }
}

impl Block {
    /// Returns the block of a specification.
    pub fn of(spec: BlockSpec) -> PyResult<Block> {
        let block = spec.block().map_err(refused)?;
        Ok(Block { spec, block })
    }

    /// Returns the block for Python, with its numbers.
    pub fn with_numbers(self) -> PyClassInitializer<Block> {
        PyClassInitializer::from(BlockNumbers::of(&self.block, &self.spec)).add_subclass(self)
    }
}

/// The numbers of a block, attributes in Python; those that its foundation lacks are nan.
#[pyclass(frozen, subclass, get_all, module = "rocking_block._engine")]
#[allow(non_snake_case)]
pub struct BlockNumbers {
    alpha: f64,
    alpha_L: f64,
    alpha_R: f64,
    p: f64,
    eta: f64,
    xi_v: f64,
    omega_v: f64,
    K: f64,
    C: f64,
    delta_s: f64,
    theta_separation: f64,
    width: f64,
    height: f64,
    R0: f64,
    I0: f64,
    mass: f64,
    gamma: f64,
    epsilon: f64,
    g: f64,
    e: f64,
    e_max: f64,
    restitution_factor: f64,
    eccentricity: f64,
    friction: f64,
}

impl BlockNumbers {
    fn of(block: &engine::Block, spec: &BlockSpec) -> BlockNumbers {
        let only_on =
            |foundation: Foundation, value: f64| if block.foundation == foundation { value } else { f64::NAN };
        let of_supports = |value: f64| only_on(Foundation::Viscoelastic, value);
        BlockNumbers {
            alpha: block.alpha,
            alpha_L: block.alpha_of(Corner::Left),
            alpha_R: block.alpha_of(Corner::Right),
            p: block.p,
            eta: of_supports(spec.eta.unwrap_or(block.eta())),
            xi_v: of_supports(block.xi_v),
            omega_v: of_supports(block.omega_v),
            K: of_supports(block.stiffness),
            C: of_supports(block.damping),
            delta_s: of_supports(block.static_deflection()),
            theta_separation: of_supports(block.separation_angle()),
            width: 2.0 * block.b,
            height: 2.0 * block.h,
            R0: block.r0,
            I0: block.inertia(),
            mass: block.mass,
            gamma: block.gamma,
            epsilon: block.epsilon,
            g: block.gravity,
            e: block.restitution(),
            e_max: block.max_restitution(),
            restitution_factor: only_on(Foundation::Rigid, block.restitution_factor),
            eccentricity: block.eccentricity,
            friction: friction::to_user(block.friction),
        }
    }
}

/// Returns a number; the error names it.
pub fn number(name: &str, value: &Bound<PyAny>) -> PyResult<f64> {
    let found = || value.repr().map_or_else(|_| "an object".into(), |found| found.to_string());
    value.extract().map_err(|_| PyTypeError::new_err(format!("{name} = {}; expected a number", found())))
}

/// Sets a parameter by its name in Python.
pub fn set(spec: &mut BlockSpec, name: &str, value: &Bound<PyAny>) -> PyResult<()> {
    match name {
        "foundation" => spec.foundation = Some(choice(name, &value.str()?.to_string(), &FOUNDATIONS)?),
        "friction" => spec.hold.friction = Some(friction::to_user(friction_of_block(Some(number(name, value)?))?)),
        "ties" => spec.hold.ties = tie::one_or_several(LinkKind::Tie, value)?,
        "dampers" => spec.hold.dampers = tie::one_or_several(LinkKind::Damper, value)?,
        name => match spec.number_mut(name) {
            Some(field) => *field = Some(number(name, value)?),
            None => return Err(PyTypeError::new_err(format!("a block has no parameter {name}"))),
        },
    }
    Ok(())
}

/// Returns the error with the names of Python.
pub fn refused(error: SpecError) -> PyErr {
    PyValueError::new_err(error.spelled(|name| match name.split_once(" = ") {
        Some((name, value)) => format!("{name}=\"{value}\""),
        None => name.into(),
    }))
}

/// Warns of supports too soft to keep a block upright, and of parameters beyond reason. The first such block is named.
pub fn warn_of_blocks(py: Python, blocks: &[engine::Block], stack_level: i32) -> PyResult<()> {
    let soft = blocks.iter().find_map(engine::Block::soft_supports);
    warn(py, soft.into_iter().chain(doubts::of_blocks(blocks.iter().copied())), stack_level)
}

/// Returns a hash of numbers that is the same in every Python process.
pub fn hash(parts: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    parts.hash(&mut hasher);
    hasher.finish()
}
