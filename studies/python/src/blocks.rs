//! Parameters of many blocks → the blocks, and columns of their parameters.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rocking_block::block as engine;
use rocking_block::block::restraints::tie;
use rocking_studies::input::parameters::Parameter;
use rocking_studies::spec::BlockSpec;
use rocking_studies::spec::words::Words;

use crate::block::{Block, set, warn_of_blocks};

/// Many blocks on the same kind of foundation.
#[pyclass(frozen, module = "rocking_block._engine")]
pub struct Blocks(Vec<Py<Block>>);

impl Blocks {
    /// Returns the blocks of the engine.
    pub fn blocks(&self) -> Vec<engine::Block> {
        self.0.iter().map(|block| block.get().block).collect()
    }
}

#[pymethods]
impl Blocks {
    /// Returns blocks from parameters of `common` to all and `columns` of equal length.
    #[new]
    fn new(py: Python, common: &Bound<PyDict>, columns: &Bound<PyDict>) -> PyResult<Blocks> {
        let mut shared = BlockSpec::default();
        for (name, value) in common.iter().filter(|(_, value)| !value.is_none()) {
            set(&mut shared, name.extract()?, &value)?;
        }
        let columns = columns.iter().map(|(name, values)| Ok((name.extract::<String>()?, values.extract()?)));
        let columns: Vec<(String, PyReadonlyArray1<f64>)> = columns.collect::<PyResult<_>>()?;
        let columns = columns.iter().map(|(name, values)| Ok((name.as_str(), values.as_slice()?)));
        let columns: Vec<(&str, &[f64])> = columns.collect::<PyResult<_>>()?;
        let block = |i: usize| {
            let mut spec = shared.clone();
            for (name, values) in &columns {
                let number = spec.number_mut(name);
                let number = number.ok_or_else(|| PyValueError::new_err(format!("a block has no number {name}")))?;
                *number = Some(values[i]);
            }
            Block::of(spec)
        };
        let count = columns.first().map_or(0, |(_, values)| values.len());
        let blocks = (0..count).map(block).collect::<PyResult<Vec<_>>>()?;
        warn_of_blocks(py, &blocks.iter().map(|block| block.block).collect::<Vec<_>>(), 2)?;
        blocks.into_iter().map(|block| Py::new(py, block.with_numbers())).collect::<PyResult<_>>().map(Blocks)
    }

    /// Returns the blocks of a list.
    #[staticmethod]
    fn of(blocks: Vec<Py<Block>>) -> Blocks {
        Blocks(blocks)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Returns one parameter of all blocks, an attribute of each.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let value = |block: &Py<Block>| block.bind(py).getattr(name)?.extract();
        Ok(PyArray1::from_vec(py, self.0.iter().map(value).collect::<PyResult<_>>()?))
    }

    /// Returns the foundation of each block.
    fn foundations(&self) -> Vec<&'static str> {
        self.blocks().iter().map(|block| block.foundation.word()).collect()
    }
}

/// Returns the unit of a real parameter, also of one such as `tie_8.stiffness` that the FMU lacks.
#[pyfunction]
pub fn parameter_unit(name: &str) -> PyResult<&'static str> {
    if let Some(number) = tie::number_of_path(name) {
        return Ok(number.quantity.unit());
    }
    let parameter = Parameter::named(name).map_err(PyValueError::new_err)?;
    parameter.unit().ok_or_else(|| PyValueError::new_err(format!("{name} has no unit")))
}
