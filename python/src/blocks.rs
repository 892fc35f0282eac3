//! Parameters of many blocks → the blocks, and columns of their parameters.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rocking_block::block::restraints::LinkKind;
use rocking_block::block::{self as engine, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_studies::input::parameters::Parameter;
use rocking_studies::spec::words::Words;

use crate::block::{Block, FOUNDATIONS, warn_of_blocks};
use crate::options::{choice, friction_of_block, invalid};

/// Many blocks on the same kind of foundation.
#[pyclass(frozen, module = "rocking_block._engine")]
pub struct Blocks {
    pub blocks: Vec<engine::Block>,
    /// The explicit η: a block's ω_v/p may differ from it by round-off.
    eta: Vec<f64>,
}

#[pymethods]
impl Blocks {
    /// Returns blocks from arrays of equal length. A rigid base ignores η and ξ_v, supports ignore the factor.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python,
        foundation: &str,
        alpha: PyReadonlyArray1<f64>,
        p: PyReadonlyArray1<f64>,
        eta: PyReadonlyArray1<f64>,
        xi_v: PyReadonlyArray1<f64>,
        epsilon: PyReadonlyArray1<f64>,
        restitution_factor: PyReadonlyArray1<f64>,
        mass: f64,
        gamma: f64,
        g: f64,
        friction: Option<f64>,
    ) -> PyResult<Blocks> {
        let foundation = choice("foundation", foundation, &FOUNDATIONS)?;
        let friction = friction_of_block(friction)?;
        let (alpha, p, eta) = (alpha.as_slice()?, p.as_slice()?, eta.as_slice()?);
        let (xi_v, epsilon, factor) = (xi_v.as_slice()?, epsilon.as_slice()?, restitution_factor.as_slice()?);
        let block = |i: usize| {
            let supports = match foundation {
                Foundation::Viscoelastic => Supports::Viscoelastic(Ratios { eta: eta[i], xi_v: xi_v[i] }),
                Foundation::Rigid => Supports::Rigid { restitution_factor: factor[i] },
            };
            let dimensionless = Dimensionless { alpha: alpha[i], p: p[i], supports };
            let common = Common { mass, gamma, epsilon: epsilon[i], gravity: g, friction, ..Common::default() };
            engine::Block::from_dimensionless(&dimensionless, &common).map_err(invalid)
        };
        let blocks = (0..alpha.len()).map(block).collect::<PyResult<Vec<_>>>()?;
        warn_of_blocks(py, &blocks, 2)?;
        Ok(Blocks { blocks, eta: eta.to_vec() })
    }

    /// Returns the blocks of a list.
    #[staticmethod]
    fn of(blocks: Vec<PyRef<Block>>) -> Blocks {
        Blocks {
            blocks: blocks.iter().map(|block| block.block).collect(),
            eta: blocks.iter().map(|block| block.eta()).collect(),
        }
    }

    fn __len__(&self) -> usize {
        self.blocks.len()
    }

    /// Returns one parameter of all blocks by name.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let parameter: fn(&Block) -> f64 = match name {
            "alpha" => Block::alpha,
            "p" => Block::p,
            "eta" => Block::eta,
            "xi_v" => Block::xi_v,
            "epsilon" => Block::epsilon,
            "restitution_factor" => Block::restitution_factor,
            "mass" => Block::mass,
            "gamma" => Block::gamma,
            "g" => Block::g,
            "eccentricity" => Block::eccentricity,
            "friction" => Block::friction,
            _ => return Err(PyValueError::new_err(format!("blocks have no column {name}"))),
        };
        let value = |(block, eta): (&engine::Block, &f64)| parameter(&Block::with_eta(*block, *eta));
        Ok(PyArray1::from_iter(py, self.blocks.iter().zip(&self.eta).map(value)))
    }

    /// Returns the foundation of each block.
    fn foundations(&self) -> Vec<&'static str> {
        self.blocks.iter().map(|block| block.foundation.word()).collect()
    }
}

/// Returns the unit of a real parameter; that of any tie or damper, `tie_8.stiffness`, is that of the first.
#[pyfunction]
pub fn parameter_unit(name: &str) -> PyResult<&'static str> {
    let of_link = name.split_once('.').and_then(|(link, parameter)| Some((link.split_once('_')?.0, parameter)));
    let of_first = of_link.filter(|(kind, _)| LinkKind::ALL.iter().any(|known| known.word() == *kind));
    let of_first = of_first.map(|(kind, parameter)| format!("{kind}_1.{parameter}"));
    let parameter = Parameter::named(of_first.as_deref().unwrap_or(name)).map_err(PyValueError::new_err)?;
    parameter.metadata.unit.ok_or_else(|| PyValueError::new_err(format!("{name} has no unit")))
}
