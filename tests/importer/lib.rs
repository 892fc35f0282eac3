//! Reference trajectories for the tests of rust-fmi.

use std::f64::consts::TAU;

/// A reference trajectory with rows every 0.01 s.
#[derive(Debug)]
pub struct Case {
    /// The name of the unit.
    pub unit: &'static str,
    /// The trajectory.
    pub file: &'static str,
    /// α (rad).
    pub alpha: f64,
    /// Chosen items of enumerations.
    pub choices: &'static [(&'static str, i32)],
    /// Parameters.
    pub reals: &'static [(&'static str, f64)],
    /// Outputs, angles (rad), with their columns in the trajectory.
    pub outputs: &'static [(&'static str, usize)],
}

/// One sine.
pub const IN_THE_PLANE: Case = Case {
    unit: "RockingBlock",
    file: "../reference/sine_eta40.csv",
    alpha: 0.25,
    choices: &[("pulse.shape", 2)],
    reals: &[
        ("dimensionless.alpha", 0.25),
        ("dimensionless.p", 1.0),
        ("mass", 1e5),
        ("pulse.amplitude", 6.2622),
        ("pulse.period", TAU / 5.0),
    ],
    outputs: &[("theta", 1)],
};

/// A release from a corner, with a rate of twist.
pub const IN_SPACE: Case = Case {
    unit: "RockingBlockInSpace",
    file: "../reference_space/corner_release.csv",
    alpha: 0.3,
    choices: &[],
    reals: &[
        ("dimensionless.alpha", 0.3),
        ("dimensionless.p", 1.2),
        ("dimensionless.eta", 30.0),
        ("dimensionless.xi_v", 0.15),
        ("dimensionless.depth_ratio", 1.0),
        ("friction", 10.0),
        ("mass", 1.0),
        ("initial.tilt_x", 0.15),
        ("initial.tilt_y", 0.16),
        ("initial.omega_z", 0.3),
    ],
    outputs: &[("tilt_x", 1), ("tilt_y", 2), ("twist", 3)],
};

impl Case {
    /// The rows of the trajectory.
    ///
    /// # Panics
    /// A file that is missing or has something else.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        let mut file = csv::Reader::from_path(self.file).expect(self.file);
        file.deserialize().collect::<Result<_, _>>().expect(self.file)
    }

    /// The time of the last row (s).
    pub fn duration(&self) -> f64 {
        self.rows().last().map_or(0.0, |row| row[0])
    }

    /// The greatest difference of the outputs from those of a row, over α.
    pub fn difference(&self, row: &[f64], values: &[f64]) -> f64 {
        let of_outputs = self.outputs.iter().zip(values).map(|((_, column), value)| (value - row[*column]).abs());
        of_outputs.fold(0.0, f64::max) / self.alpha
    }
}
