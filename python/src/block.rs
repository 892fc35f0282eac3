//! Parameters → a block.

use std::ffi::CString;
use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rocking_block::block::{
    self as engine, Common, Corner, Dimensionless, Foundation, Parameterization, Physical, restraints,
};
use rocking_block::words::Words;

use crate::options::{choice, invalid};
use crate::tie::Tie;

/// All foundations.
pub const FOUNDATIONS: [Foundation; 2] = [Foundation::Viscoelastic, Foundation::Rigid];

/// The explicit parameters of a block; the others follow.
#[derive(Clone, Debug, Default)]
struct ExplicitParameters {
    alpha: Option<f64>,
    p: Option<f64>,
    eta: Option<f64>,
    xi_v: Option<f64>,
    width: Option<f64>,
    height: Option<f64>,
    stiffness: Option<f64>,
    damping: Option<f64>,
    restitution_factor: Option<f64>,
    center_height: Option<f64>,
    inertia: Option<f64>,
}

impl ExplicitParameters {
    fn named(&self) -> [(&'static str, Option<f64>); 11] {
        let ExplicitParameters { alpha, p, eta, xi_v, width, height, stiffness, damping, restitution_factor, .. } =
            *self;
        [
            ("alpha", alpha),
            ("p", p),
            ("eta", eta),
            ("xi_v", xi_v),
            ("width", width),
            ("height", height),
            ("K", stiffness),
            ("C", damping),
            ("restitution_factor", restitution_factor),
            ("center_height", self.center_height),
            ("inertia", self.inertia),
        ]
    }

    /// Refuses the first of these parameters that the user gave.
    fn refuse(&self, names: &[&str], why: &str) -> PyResult<()> {
        match self.named().into_iter().find(|(name, value)| value.is_some() && names.contains(name)) {
            Some((name, _)) => Err(PyValueError::new_err(format!("{name} has no effect {why}"))),
            None => Ok(()),
        }
    }

    /// Returns the parameters of this block in the user's parameterization.
    fn parameterization(&self, block: &engine::Block) -> Parameterization {
        match self.width {
            None => Parameterization::Dimensionless(Dimensionless {
                alpha: block.alpha,
                p: block.p,
                eta: self.eta.unwrap_or(block.eta()),
                xi_v: block.xi_v,
            }),
            Some(_) => Parameterization::Physical(Physical {
                width: 2.0 * block.b,
                height: 2.0 * block.h,
                stiffness: block.stiffness,
                damping: block.damping,
                inertia: self.inertia,
            }),
        }
    }

    fn block(&self, common: &Common) -> PyResult<engine::Block> {
        match common.foundation {
            Foundation::Viscoelastic => {
                self.refuse(&["restitution_factor"], "on viscoelastic supports; expected foundation=\"rigid\"")?;
            }
            Foundation::Rigid => self.refuse(&["eta", "xi_v", "K", "C"], "on a rigid base")?,
        }
        let Some(width) = self.width else {
            self.refuse(&["height", "center_height", "inertia", "K", "C"], "without width")?;
            let ExplicitParameters { alpha, p, eta, xi_v, .. } = *self;
            let dimensionless = Dimensionless {
                alpha: alpha.unwrap_or(0.25),
                p: p.unwrap_or(1.0),
                eta: eta.unwrap_or(40.0),
                xi_v: xi_v.unwrap_or(0.1),
            };
            return engine::Block::from_dimensionless(&dimensionless, common).map_err(invalid);
        };
        self.refuse(&["alpha", "p", "eta", "xi_v"], "with width")?;
        let missing = |what: &str| PyValueError::new_err(format!("width without {what}"));
        if self.center_height.is_some() {
            self.refuse(&["height"], "with center_height")?;
        }
        let height = self.center_height.map(|height| 2.0 * height).or(self.height);
        let height = height.ok_or_else(|| missing("height; expected both, or center_height"))?;
        let (stiffness, damping) = match (common.foundation, self.stiffness, self.damping) {
            (Foundation::Viscoelastic, Some(stiffness), Some(damping)) => (stiffness, damping),
            (Foundation::Viscoelastic, ..) => {
                return Err(missing("K and C; expected both and mass, or foundation=\"rigid\""));
            }
            // The rigid base ignores both; any valid values will do.
            (Foundation::Rigid, ..) => (common.mass * common.gravity / height, 0.0),
        };
        let physical = Physical { width, height, stiffness, damping, inertia: self.inertia };
        engine::Block::from_physical(&physical, common).map_err(invalid)
    }
}

/// The parameters of a block; the Python class of the same name adds the methods.
#[pyclass(frozen, subclass, eq, hash, module = "rocking_block._engine")]
#[derive(Clone, Debug)]
pub struct Block {
    explicit: ExplicitParameters,
    pub block: engine::Block,
}

impl PartialEq for Block {
    fn eq(&self, other: &Block) -> bool {
        self.block == other.block
    }
}

impl Hash for Block {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let engine::Block { alpha, p, omega_v, xi_v, mass, gamma, epsilon, gravity, restitution_factor, .. } =
            self.block;
        let engine::Block { eccentricity, friction, .. } = self.block;
        // Adding zero turns −0 into 0, so that equal blocks have equal hashes.
        [alpha, p, omega_v, xi_v, mass, gamma, epsilon, gravity, restitution_factor, eccentricity, friction]
            .map(|value| (value + 0.0).to_bits())
            .hash(state);
    }
}

impl Block {
    /// Returns the parameters of this block in the user's parameterization.
    pub fn parameterization(&self) -> (Parameterization, Common) {
        let engine::Block { mass, gamma, epsilon, gravity, foundation, .. } = self.block;
        let engine::Block { restitution_factor, eccentricity, friction, .. } = self.block;
        let common = Common { mass, gamma, epsilon, gravity, foundation, restitution_factor, eccentricity, friction };
        (self.explicit.parameterization(&self.block), common)
    }
}

#[pymethods]
impl Block {
    #[new]
    #[pyo3(signature = (
        *, alpha=None, p=None, eta=None, xi_v=None, width=None, height=None, K=None, C=None, mass=None, gamma=3.0,
        epsilon=0.0, g=9.81, foundation="viscoelastic", restitution_factor=None, center_height=None, inertia=None,
        eccentricity=0.0, friction=0.0, ties=None,
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
        gamma: f64,
        epsilon: f64,
        g: f64,
        foundation: &str,
        restitution_factor: Option<f64>,
        center_height: Option<f64>,
        inertia: Option<f64>,
        eccentricity: f64,
        friction: f64,
        ties: Option<&Bound<PyAny>>,
    ) -> PyResult<Block> {
        let foundation = choice("foundation", foundation, &FOUNDATIONS)?;
        let (stiffness, damping) = (K, C);
        let explicit = ExplicitParameters {
            alpha,
            p,
            eta,
            xi_v,
            width,
            height,
            stiffness,
            damping,
            restitution_factor,
            center_height,
            inertia,
        };
        if inertia.is_some() && gamma != Common::default().gamma {
            return Err(PyValueError::new_err("gamma has no effect with inertia"));
        }
        let restitution_factor = restitution_factor.unwrap_or(1.0);
        let common = Common {
            mass: mass.unwrap_or(1000.0),
            gamma,
            epsilon,
            gravity: g,
            foundation,
            restitution_factor,
            eccentricity,
            friction,
        };
        let ties = ties.map_or(Ok(Vec::new()), Tie::one_or_several)?;
        let ties: Vec<restraints::Tie> = ties.iter().map(Tie::of_engine).collect();
        let block = explicit.block(&common)?.with_ties(&ties).map_err(invalid)?;
        for (name, is_given, why) in [
            ("K", K.is_some(), "eta and xi_v depend"),
            ("inertia", inertia.is_some(), "p depends"),
            ("ties", !ties.is_empty(), "their effect depends"),
        ] {
            if is_given && mass.is_none() {
                let message = format!("{name} without mass; expected both, since {why} on the mass");
                return Err(PyValueError::new_err(message));
            }
        }
        warn_of_soft_supports(py, &[block], 1)?;
        Ok(Block { block, explicit })
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, PyDict>)> {
        Ok(((), self.parameters(py)?))
    }

    /// Returns the parameters that define this block: the explicit ones and those common to all blocks.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for (name, value) in self.explicit.named() {
            if let Some(value) = value {
                parameters.set_item(name, value)?;
            }
        }
        let engine::Block { mass, gamma, epsilon, gravity, .. } = self.block;
        for (name, value) in [("mass", mass), ("gamma", gamma), ("epsilon", epsilon), ("g", gravity)] {
            // An explicit moment of inertia determines the shape factor.
            if name != "gamma" || self.explicit.inertia.is_none() {
                parameters.set_item(name, value)?;
            }
        }
        for (name, value) in [("eccentricity", self.block.eccentricity), ("friction", self.block.friction)] {
            if value != 0.0 {
                parameters.set_item(name, value)?;
            }
        }
        if !self.block.ties().is_empty() {
            parameters.set_item("ties", self.ties(py)?)?;
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
        self.of_supports(self.explicit.eta.unwrap_or(self.block.eta()))
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
        self.block.friction
    }

    #[getter]
    fn ties<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let class = py.import("rocking_block._tie")?.getattr("Tie")?;
        let ties = self.block.ties().iter().map(|tie| class.call((), Some(&Tie::of_python(tie).named(py)?)));
        PyTuple::new(py, ties.collect::<PyResult<Vec<_>>>()?)
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
        Block { explicit: ExplicitParameters { eta: Some(eta), ..ExplicitParameters::default() }, block }
    }

    /// Returns a value that a rigid base lacks.
    fn of_supports(&self, value: f64) -> f64 {
        match self.block.foundation {
            Foundation::Viscoelastic => value,
            Foundation::Rigid => f64::NAN,
        }
    }
}

/// Warns of the first block whose supports are too soft to keep it upright. `stack_level` selects the line that the warning names.
pub fn warn_of_soft_supports(py: Python, blocks: &[engine::Block], stack_level: i32) -> PyResult<()> {
    let Some(warning) = blocks.iter().find_map(engine::Block::soft_supports) else { return Ok(()) };
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(warning)?, stack_level)
}

/// Returns a hash of numbers that is the same in every Python process.
pub fn hash(parts: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    parts.hash(&mut hasher);
    hasher.finish()
}
