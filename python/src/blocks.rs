//! Parameters of many blocks → the blocks, and columns of their parameters.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rocking_block::block::{self as engine, Common, Dimensionless};
use rocking_block::words::Words;

use crate::block::{Block, FOUNDATIONS, warn_of_soft_supports};
use crate::options::{choice, invalid};

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
        friction: f64,
    ) -> PyResult<Blocks> {
        let foundation = choice("foundation", foundation, &FOUNDATIONS)?;
        let (alpha, p, eta) = (alpha.as_slice()?, p.as_slice()?, eta.as_slice()?);
        let (xi_v, epsilon, factor) = (xi_v.as_slice()?, epsilon.as_slice()?, restitution_factor.as_slice()?);
        let block = |i: usize| {
            let dimensionless = Dimensionless { alpha: alpha[i], p: p[i], eta: eta[i], xi_v: xi_v[i] };
            let common = Common {
                mass,
                gamma,
                epsilon: epsilon[i],
                gravity: g,
                foundation,
                restitution_factor: factor[i],
                friction,
                ..Common::default()
            };
            engine::Block::from_dimensionless(&dimensionless, &common).map_err(invalid)
        };
        let blocks = (0..alpha.len()).map(block).collect::<PyResult<Vec<_>>>()?;
        warn_of_soft_supports(py, &blocks, 2)?;
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
