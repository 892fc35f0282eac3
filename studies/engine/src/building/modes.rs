//! Floor masses and storey stiffnesses, or given modes → modes with damping.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, SymmetricEigen};

/// A mode of an elastic building.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Natural frequency (Hz).
    pub frequency: f64,
    /// Damping ratio ζ (1).
    pub damping: f64,
    /// Participation factor Γ of horizontal ground motion, in the scale of `shape` (1).
    pub participation: f64,
    /// Shape φ at each floor, from the first one up (1).
    pub shape: Vec<f64>,
}

impl Mode {
    /// Circular frequency ω (rad/s).
    pub fn omega(&self) -> f64 {
        TAU * self.frequency
    }
}

/// Classical damping of a building.
#[derive(Clone, Debug, PartialEq)]
pub enum Damping {
    /// This ratio in every mode (1).
    All(f64),
    /// A ratio for each mode (1).
    Each(Vec<f64>),
    /// Proportional to mass and stiffness, with this ratio (1) in two modes, counted from 1.
    Rayleigh(f64, [usize; 2]),
}

/// An elastic building with classical damping, at rest before the earthquake.
#[derive(Clone, Debug, PartialEq)]
pub struct Building {
    modes: Vec<Mode>,
    floors: usize,
}

/// The reason why parameters do not define a building.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} {found}; expected {expected}")]
pub struct BuildingError {
    /// The parameter at fault.
    pub name: &'static str,
    found: String,
    expected: String,
}

fn wrong<T>(name: &'static str, found: impl Into<String>, expected: impl Into<String>) -> Result<T, BuildingError> {
    Err(BuildingError { name, found: found.into(), expected: expected.into() })
}

/// Least damping ratio: with less, floors would vibrate for minutes after the earthquake.
const MIN_DAMPING: f64 = 0.001;
/// Least first period (s) within reason, and the greatest of a building without floors and for each of its floors.
const MIN_PERIOD: f64 = 0.03;
const MAX_PERIOD: [f64; 2] = [3.0, 0.2];
/// Greatest number of floors; its eigenproblem takes seconds.
const MAX_FLOORS: usize = 500;

impl Building {
    /// A remark on a first period beyond reason, mostly a slip of units.
    pub fn doubt(&self) -> Option<String> {
        let period = 1.0 / self.modes.first()?.frequency;
        let greatest = MAX_PERIOD[0] + MAX_PERIOD[1] * self.floors as f64;
        let floors = if self.floors == 1 { "one floor".into() } else { format!("{} floors", self.floors) };
        let shown: f64 = format!("{period:.2e}").parse().unwrap_or(period);
        (!(MIN_PERIOD..=greatest).contains(&period)).then(|| {
            format!(
                "the building of {floors} has a first period of {shown} s; expected {MIN_PERIOD} to {greatest:.1} s, from masses in kg and \
                 stiffnesses in N/m"
            )
        })
    }

    /// Makes a shear building of floor masses (kg) and storey stiffnesses (N/m). Both begin at the ground.
    ///
    /// # Errors
    /// [`BuildingError`]: a list of the wrong length or with invalid numbers, or invalid damping.
    pub fn shear(masses: &[f64], stiffnesses: &[f64], damping: &Damping) -> Result<Building, BuildingError> {
        let floors = masses.len();
        check_floors("floor_masses", floors)?;
        check_list("floor_masses", masses, |x| x > 0.0, "masses > 0 kg")?;
        check_list("storey_stiffnesses", stiffnesses, |x| x > 0.0, "stiffnesses > 0 N/m")?;
        if stiffnesses.len() != floors {
            let expected = format!("{floors}, one below each floor");
            return wrong("storey_stiffnesses", format!("has {} values", stiffnesses.len()), expected);
        }
        // Unknowns √m u make the eigenproblem symmetric.
        let matrix = DMatrix::from_fn(floors, floors, |i, j| {
            let stiffness = match i.abs_diff(j) {
                0 => stiffnesses[i] + stiffnesses.get(i + 1).copied().unwrap_or(0.0),
                1 => -stiffnesses[i.max(j)],
                _ => 0.0,
            };
            stiffness / (masses[i] * masses[j]).sqrt()
        });
        let solved = SymmetricEigen::new(matrix);
        let mut order: Vec<usize> = (0..floors).collect();
        order.sort_by(|&i, &j| solved.eigenvalues[i].total_cmp(&solved.eigenvalues[j]));
        let modes = order.into_iter().map(|number| {
            let vector = solved.eigenvectors.column(number);
            let shape: Vec<f64> = vector.iter().zip(masses).map(|(x, mass)| x / mass.sqrt()).collect();
            let largest = shape.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            let shape: Vec<f64> = shape.iter().map(|x| x / largest).collect();
            let first: f64 = shape.iter().zip(masses).map(|(x, mass)| mass * x).sum();
            let second: f64 = shape.iter().zip(masses).map(|(x, mass)| mass * x * x).sum();
            let frequency = solved.eigenvalues[number].sqrt() / TAU;
            Mode { frequency, damping: 0.0, participation: first / second, shape }
        });
        Building { modes: modes.collect(), floors }.damped(damping)
    }

    /// Makes a building of given modes: frequencies (Hz), participation factors and shapes. Shapes have a value per floor.
    ///
    /// # Errors
    /// [`BuildingError`]: lists of different lengths or with invalid numbers, or invalid damping.
    pub fn of_modes(
        frequencies: &[f64],
        participation: &[f64],
        shapes: &[Vec<f64>],
        damping: &Damping,
    ) -> Result<Building, BuildingError> {
        check_list("frequencies", frequencies, |x| x > 0.0, "frequencies > 0 Hz")?;
        check_list("participation", participation, |_| true, "finite numbers")?;
        for (name, count) in [("participation", participation.len()), ("shapes", shapes.len())] {
            if count != frequencies.len() {
                return wrong(name, format!("has {count} values"), format!("{}, one per mode", frequencies.len()));
            }
        }
        let floors = shapes.first().map_or(0, Vec::len);
        check_floors("shapes", floors)?;
        for shape in shapes {
            check_list("shapes", shape, |_| true, "finite numbers")?;
            if shape.len() != floors {
                return wrong(
                    "shapes",
                    format!("has lists of {floors} and {} values", shape.len()),
                    "one value per floor",
                );
            }
        }
        let mode = |((&frequency, &participation), shape): ((&f64, &f64), &Vec<f64>)| Mode {
            frequency,
            damping: 0.0,
            participation,
            shape: shape.clone(),
        };
        let modes = frequencies.iter().zip(participation).zip(shapes).map(mode).collect();
        Building { modes, floors }.damped(damping)
    }

    /// The modes: of a shear building all, in the order of their frequencies.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Number of floors above the ground.
    pub fn floors(&self) -> usize {
        self.floors
    }

    fn damped(mut self, damping: &Damping) -> Result<Building, BuildingError> {
        let count = self.modes.len();
        let ratios = match damping {
            Damping::All(ratio) => vec![*ratio; count],
            Damping::Each(ratios) if ratios.len() == count => ratios.clone(),
            Damping::Each(ratios) => {
                return wrong(
                    "damping",
                    format!("has {} values", ratios.len()),
                    format!("one, or {count}, one per mode"),
                );
            }
            Damping::Rayleigh(ratio, modes) => {
                let [i, j] = *modes;
                if i == j || ![i, j].iter().all(|mode| (1..=count).contains(mode)) {
                    return wrong(
                        "rayleigh",
                        format!("has modes = [{i}, {j}]"),
                        format!("two different modes, 1 to {count}"),
                    );
                }
                let (low, high) = (self.modes[i - 1].omega(), self.modes[j - 1].omega());
                let (mass_factor, stiffness_factor) =
                    (2.0 * ratio * low * high / (low + high), 2.0 * ratio / (low + high));
                let damping = |mode: &Mode| 0.5 * (mass_factor / mode.omega() + stiffness_factor * mode.omega());
                self.modes.iter().map(damping).collect()
            }
        };
        for (number, (mode, ratio)) in self.modes.iter_mut().zip(ratios).enumerate() {
            if !(MIN_DAMPING..1.0).contains(&ratio) {
                let name = if matches!(damping, Damping::Rayleigh(..)) { "rayleigh" } else { "damping" };
                let found = format!("gives mode {} the ratio {ratio}", number + 1);
                return wrong(name, found, format!("{MIN_DAMPING} to less than 1"));
            }
            mode.damping = ratio;
        }
        Ok(self)
    }
}

fn check_floors(name: &'static str, floors: usize) -> Result<(), BuildingError> {
    match (1..=MAX_FLOORS).contains(&floors) {
        true => Ok(()),
        false => wrong(name, format!("has {floors} floors"), format!("1 to {MAX_FLOORS}")),
    }
}

fn check_list(
    name: &'static str,
    values: &[f64],
    fits: impl Fn(f64) -> bool,
    expected: &str,
) -> Result<(), BuildingError> {
    match values.iter().find(|&&value| !(value.is_finite() && fits(value))) {
        Some(value) => wrong(name, format!("has the value {value}"), expected),
        None if values.is_empty() => wrong(name, "is empty", expected),
        None => Ok(()),
    }
}
