//! Parameters → a block.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rocking_block::block::restraints::LinkKind;
use rocking_block::block::{self as engine, Common, Corner, Foundation, Parameterization};
use rocking_studies::doubts;
use rocking_studies::spec::words::{Words, friction};
use rocking_studies::spec::{BlockSpec, HoldSpec, SpecError};

use crate::options::{choice, friction_of_block, warn};
use crate::tie;

/// All foundations.
pub const FOUNDATIONS: [Foundation; 2] = [Foundation::Viscoelastic, Foundation::Rigid];

/// The parameters of a block; the Python class of the same name adds the methods.
#[pyclass(frozen, subclass, eq, hash, module = "rocking_block._engine")]
#[derive(Clone, Debug)]
pub struct Block {
    /// The parameters as given; of a block of the engine, η, which may differ from ω_v/p by round-off.
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
    /// Returns the parameters of this block in the user's parameterization.
    pub fn parameterization(&self) -> PyResult<(Parameterization, Common)> {
        self.spec.parameters().map_err(refused)
    }
}

#[pymethods]
impl Block {
    #[new]
    #[pyo3(signature = (
        *, alpha=None, p=None, eta=None, xi_v=None, width=None, height=None, K=None, C=None, mass=None, gamma=None,
        epsilon=0.0, g=9.81, foundation="viscoelastic", restitution_factor=None, center_height=None, inertia=None,
        eccentricity=0.0, friction=None, ties=None, dampers=None,
    ))]
    #[allow(non_snake_case, clippy::too_many_arguments)]
    fn new(
        py: Python,
        alpha: Option<f64>,
        p: Option<f64>,
        eta: Option<f64>,
        xi_v: Option<f64>,
        width: Option<f64>,
        height: Option<f64>,
        K: Option<f64>,
        C: Option<f64>,
        mass: Option<f64>,
        gamma: Option<f64>,
        epsilon: f64,
        g: f64,
        foundation: &str,
        restitution_factor: Option<f64>,
        center_height: Option<f64>,
        inertia: Option<f64>,
        eccentricity: f64,
        friction: Option<f64>,
        ties: Option<&Bound<PyAny>>,
        dampers: Option<&Bound<PyAny>>,
    ) -> PyResult<Block> {
        let spec = BlockSpec {
            alpha,
            p,
            eta,
            xi_v,
            width,
            height,
            center_height,
            inertia,
            stiffness: K,
            damping: C,
            mass,
            gamma,
            epsilon: Some(epsilon),
            g: Some(g),
            foundation: Some(choice("foundation", foundation, &FOUNDATIONS)?),
            restitution_factor,
            hold: HoldSpec {
                eccentricity: Some(eccentricity),
                friction: Some(friction::to_user(friction_of_block(friction)?)),
                ties: tie::one_or_several(LinkKind::Tie, ties)?,
                dampers: tie::one_or_several(LinkKind::Damper, dampers)?,
            },
        };
        let block = spec.block().map_err(refused)?;
        warn_of_blocks(py, &[block], 1)?;
        Ok(Block { block, spec })
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

    #[getter]
    fn foundation(&self) -> &'static str {
        self.block.foundation.word()
    }

    #[getter]
    pub fn alpha(&self) -> f64 {
        self.block.alpha
    }

    #[getter]
    pub fn p(&self) -> f64 {
        self.block.p
    }

    #[getter]
    pub fn eta(&self) -> f64 {
        self.of_supports(self.spec.eta.unwrap_or(self.block.eta()))
    }

    #[getter]
    pub fn xi_v(&self) -> f64 {
        self.of_supports(self.block.xi_v)
    }

    #[getter]
    fn omega_v(&self) -> f64 {
        self.of_supports(self.block.omega_v)
    }

    #[getter]
    #[allow(non_snake_case)]
    fn K(&self) -> f64 {
        self.of_supports(self.block.stiffness)
    }

    #[getter]
    #[allow(non_snake_case)]
    fn C(&self) -> f64 {
        self.of_supports(self.block.damping)
    }

    #[getter]
    fn delta_s(&self) -> f64 {
        self.of_supports(self.block.static_deflection())
    }

    #[getter]
    fn theta_separation(&self) -> f64 {
        self.of_supports(self.block.separation_angle())
    }

    #[getter]
    fn width(&self) -> f64 {
        2.0 * self.block.b
    }

    #[getter]
    fn height(&self) -> f64 {
        2.0 * self.block.h
    }

    #[getter]
    #[allow(non_snake_case)]
    fn R0(&self) -> f64 {
        self.block.r0
    }

    #[getter]
    #[allow(non_snake_case)]
    fn I0(&self) -> f64 {
        self.block.inertia()
    }

    #[getter]
    pub fn mass(&self) -> f64 {
        self.block.mass
    }

    #[getter]
    pub fn gamma(&self) -> f64 {
        self.block.gamma
    }

    #[getter]
    pub fn epsilon(&self) -> f64 {
        self.block.epsilon
    }

    #[getter]
    pub fn g(&self) -> f64 {
        self.block.gravity
    }

    #[getter]
    fn e(&self) -> f64 {
        self.block.restitution()
    }

    #[getter]
    fn e_max(&self) -> f64 {
        self.block.max_restitution()
    }

    #[getter]
    pub fn eccentricity(&self) -> f64 {
        self.block.eccentricity
    }

    #[getter]
    #[allow(non_snake_case)]
    fn alpha_L(&self) -> f64 {
        self.block.alpha_of(Corner::Left)
    }

    #[getter]
    #[allow(non_snake_case)]
    fn alpha_R(&self) -> f64 {
        self.block.alpha_of(Corner::Right)
    }

    #[getter]
    pub fn friction(&self) -> f64 {
        friction::to_user(self.block.friction)
    }

    #[getter]
    fn ties<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        tie::of_kind(LinkKind::Tie, self.block.ties(), py)
    }

    #[getter]
    fn dampers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        tie::of_kind(LinkKind::Damper, self.block.ties(), py)
    }

    #[getter]
    pub fn restitution_factor(&self) -> f64 {
        match self.block.foundation {
            Foundation::Rigid => self.block.restitution_factor,
            Foundation::Viscoelastic => f64::NAN,
        }
    }
}

impl Block {
    /// Returns a block of the engine; its explicit η may differ from ω_v/p by round-off.
    pub fn with_eta(block: engine::Block, eta: f64) -> Block {
        Block { spec: BlockSpec { eta: Some(eta), ..BlockSpec::default() }, block }
    }

    /// Returns a value that a rigid base lacks.
    fn of_supports(&self, value: f64) -> f64 {
        match self.block.foundation {
            Foundation::Viscoelastic => value,
            Foundation::Rigid => f64::NAN,
        }
    }
}

/// Returns the error with the names of Python.
fn refused(error: SpecError) -> PyErr {
    PyValueError::new_err(error.spelled(|name| match name.split_once(" = ") {
        Some((name, value)) => format!("{name}=\"{value}\""),
        None => name.into(),
    }))
}

/// Warns of the first block whose supports are too soft to keep it upright, and of parameters beyond reason.
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
