//! A block, tests of it and the names of free parameters → a checked problem.

use crate::spec::fit::FitTable;
use crate::spec::limits;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, BlockError, BlockParameters};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Initial, OnSeparation, Settings, SimulationError};
use rocking_gradients::Parameters;

use crate::run::table::columns;
use crate::run::{Run, is_moved};

/// A free parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Free {
    /// Its name: that of a derivative of a run, or a test's `zero` or `delay`.
    pub name: String,
    /// Its bounds; by default a range about its value.
    pub bounds: Option<[f64; 2]>,
    /// Mean and standard deviation of prior knowledge.
    pub prior: Option<[f64; 2]>,
}

impl Free {
    /// Returns a free parameter with the usual bounds.
    pub fn named(name: &str) -> Free {
        Free { name: name.into(), ..Free::default() }
    }
}

/// A test of a block: one quantity over time, free or under a ground motion.
#[derive(Clone, Debug)]
pub struct Test {
    /// Name of the measured column, as in the table of a run: `theta`.
    pub output: String,
    /// Times (s), increasing.
    pub times: Vec<f64>,
    /// Measured values, in the unit of the column.
    pub values: Vec<f64>,
    /// Standard deviation of their errors, if known.
    pub noise: Option<f64>,
    /// State of the block at the start of the run.
    pub initial: Initial,
    /// A pulse of the ground.
    pub pulse: Pulse,
    /// Records of the ground, without the scale.
    pub ground: Ground,
    /// Factor on the records (1).
    pub scale: f64,
    /// Offset of the sensor: the measured value of zero, in the unit of the column.
    pub zero: f64,
    /// Measured time at time 0 of the run (s).
    pub delay: f64,
    /// The test's own free parameters.
    pub free: Vec<Free>,
}

impl Test {
    /// Returns a release test: the rotation (rad) over time (s) of a block let go. It is let go at rest with this tilt (rad).
    pub fn release(theta: f64, times: Vec<f64>, values: Vec<f64>) -> Test {
        Test {
            output: "theta".into(),
            times,
            values,
            noise: None,
            initial: Initial { theta, ..Initial::default() },
            pulse: Pulse::NONE,
            ground: Ground::default(),
            scale: 1.0,
            zero: 0.0,
            delay: 0.0,
            free: Vec::new(),
        }
    }

    /// Refuses a test that is not valid for this block.
    fn check(&self, block: &Block) -> Result<(), String> {
        let Test { output, times, values, noise, initial, pulse, ground, scale, zero, delay, .. } = self;
        let known: Vec<String> = columns(block)
            .iter()
            .map(|column| column.heading().name.clone())
            .filter(|name| is_measured(name))
            .collect();
        let finite = |numbers: &[f64]| numbers.iter().position(|number| !number.is_finite());
        let moves = is_moved(ground, pulse, initial);
        let fault = if !known.contains(output) {
            format!("there is no measured quantity {output}; expected one of {}", known.join(", "))
        } else if times.len() != values.len() {
            format!("{} times and {} values; expected equal numbers", times.len(), values.len())
        } else if times.len() < 2 {
            format!("{} values; expected two at least", times.len())
        } else if let Some(i) = finite(times).or(finite(values)) {
            format!("value {} at t = {} s is {}; expected finite numbers", i + 1, times[i], values[i])
        } else if let Some(i) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
            format!("time {} is {} s, after {} s; expected increasing times", i + 2, times[i + 1], times[i])
        } else if let Some(noise) = noise.filter(|noise| !(*noise > 0.0 && noise.is_finite())) {
            format!("noise = {noise}; expected a standard deviation > 0")
        } else if !moves {
            "nothing moves the block; expected a record, a pulse or an initial state".into()
        } else if let Some(number) =
            [*scale, *zero, *delay, initial.theta, initial.theta_dot].iter().find(|x| !x.is_finite())
        {
            format!("{number} among scale, zero, delay and the initial state; expected finite numbers")
        } else {
            return Ok(());
        };
        Err(fault)
    }
}

/// Options of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Number of starts. They are the values of the problem, and points of a Latin hypercube within the bounds.
    pub starts: u32,
    /// Seed of that hypercube.
    pub seed: u64,
    /// Confidence level of intervals.
    pub level: f64,
    /// Relative tolerance of the runs.
    pub tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options { starts: 16, seed: 1, level: 0.95, tolerance: Settings::default().tolerance }
    }
}

/// A block, its tests and the free parameters of a fit.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The parameters of the block.
    pub block: BlockParameters,
    /// Its ties.
    pub ties: Vec<Tie>,
    /// Free parameters of the block, which all tests share.
    pub free: Vec<Free>,
    /// The tests.
    pub tests: Vec<Test>,
    /// Starts, seed, level, tolerance.
    pub options: Options,
}

/// The reason why a fit is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// An option or a free parameter that is not valid.
    #[error("{0}")]
    Invalid(String),
    /// A test that is not valid.
    #[error("test_{number}: {message}")]
    Test {
        /// Number of the test, from 1.
        number: usize,
        /// The fault and the expected content.
        message: String,
    },
    /// A block that is not valid.
    #[error(transparent)]
    Block(BlockError),
    /// A run that fails at every start.
    #[error("found no start whose runs succeed; expected narrower bounds; the first failure: {0}")]
    Runs(SimulationError),
    /// Starts whose blocks are not valid.
    #[error("found no start with a valid block; expected narrower bounds")]
    Starts,
}

impl Problem {
    /// Returns the parameters of the block in a test.
    pub fn parameters(&self, test: &Test) -> Parameters {
        Parameters {
            block: self.block,
            ties: self.ties.clone(),
            initial: test.initial,
            pulse: test.pulse,
            scale: (!test.ground.is_empty()).then_some(test.scale),
        }
    }

    /// Returns the run of a test with these parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub fn run(&self, test: &Test, parameters: &Parameters) -> Result<Run, BlockError> {
        let block = parameters.checked_block()?;
        let ground = test.ground.clone().scaled(parameters.scale.unwrap_or(1.0));
        let settings =
            Settings { tolerance: self.options.tolerance, on_separation: OnSeparation::Fly, ..Settings::default() };
        Ok(Run { initial: parameters.initial, pulse: parameters.pulse, ground, ..Run::at_rest(block, settings) })
    }

    /// Returns the unit of the quantity that a test measures.
    ///
    /// # Errors
    /// An invalid block, or a column that its runs lack.
    pub fn unit(&self, test: &Test) -> Result<String, FitError> {
        let block = self.parameters(test).checked_block().map_err(FitError::Block)?;
        Ok(unit(&block, &test.output))
    }

    /// Returns the numbers of measured values of the tests.
    pub fn counts(&self) -> Vec<usize> {
        self.tests.iter().map(|test| test.values.len()).collect()
    }

    /// Refuses a problem that is not valid.
    ///
    /// # Errors
    /// The first invalid option, prior or test.
    pub fn check(&self) -> Result<(), FitError> {
        let Options { starts, level, tolerance, .. } = self.options;
        let starts = Some(f64::from(starts));
        let numbers = [("starts", starts), ("level", Some(level)), ("tolerance", Some(tolerance))];
        limits::check::<FitTable>(&numbers).map_err(|error| FitError::Invalid(error.spelled(str::to_owned)))?;
        if self.tests.is_empty() {
            return Err(FitError::Invalid("there is no test; expected one at least".into()));
        }
        for (number, test) in (1..).zip(&self.tests) {
            let block = self.parameters(test).checked_block().map_err(FitError::Block)?;
            test.check(&block).map_err(|message| FitError::Test { number, message })?;
        }
        let with_noise = self.tests.iter().filter(|test| test.noise.is_some()).count();
        if with_noise != 0 && with_noise != self.tests.len() {
            let without = self.tests.iter().position(|test| test.noise.is_none()).unwrap_or(0);
            let message = "noise is missing, and another test has it; expected it for all tests or for none".into();
            return Err(FitError::Test { number: without + 1, message });
        }
        if with_noise == 0 {
            if let Some(other) = self.tests.iter().position(|test| test.output != self.tests[0].output) {
                let [one, two] = [&self.tests[0].output, &self.tests[other].output];
                let message = format!("it measures {two}, and test_1 {one}; expected the noise of each test");
                return Err(FitError::Test { number: other + 1, message });
            }
            let all = self.free.iter().chain(self.tests.iter().flat_map(|test| &test.free));
            if let Some(free) = all.into_iter().find(|free| free.prior.is_some()) {
                let name = &free.name;
                return Err(FitError::Invalid(format!(
                    "prior of {name} without noise; expected both, since one weighs the other"
                )));
            }
        }
        Ok(())
    }
}

/// Returns the unit of a column of a run of this block.
pub(super) fn unit(block: &Block, output: &str) -> String {
    let columns = columns(block);
    let column = columns.iter().find(|column| column.heading().name == output);
    column.and_then(|column| column.heading().unit.clone()).unwrap_or_else(|| "1".into())
}

/// Whether a test may measure a column. It may measure a motion, a reaction, or a height.
fn is_measured(name: &str) -> bool {
    !matches!(name, "t" | "regime" | "a_gx" | "a_gz") && !name.starts_with("energy.")
}
