//! The numbers of a block in space and of its beginning, by the names that studies give them.

use std::path::Path;
use std::sync::LazyLock;

use rocking_block::space::{FootPlace, SpaceInitial, SpaceParameters};
use serde_json::{Value, json};

use crate::spec::space::OF_PLANE;
use crate::spec::{BlockSpec, SpaceSpec, SpecError, limits};

/// The beginning of a run in space, as a user gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeginningSpec {
    /// Component of the tilt towards +x (rad).
    pub tilt_x: Option<f64>,
    /// Component of the tilt towards +y (rad).
    pub tilt_y: Option<f64>,
    /// Twist about the vertical, before the tilt (rad).
    pub twist: Option<f64>,
    /// Angular velocity about x (rad/s).
    pub omega_x: Option<f64>,
    /// Angular velocity about y (rad/s).
    pub omega_y: Option<f64>,
    /// Angular velocity about the vertical (rad/s).
    pub omega_z: Option<f64>,
    /// Height above rest (m); without it and `v_dot` the block is settled on its supports.
    pub v: Option<f64>,
    /// Vertical velocity (m/s).
    pub v_dot: Option<f64>,
}

impl BeginningSpec {
    /// Returns the initial state.
    ///
    /// # Errors
    /// The first number out of range.
    pub fn initial(&self) -> Result<SpaceInitial, SpecError> {
        /// Greatest tilt (rad), just below a quarter turn, at which a block has overturned.
        const GREATEST: f64 = 1.57;
        let BeginningSpec { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot } = *self;
        let vertical = (v.is_some() || v_dot.is_some()).then_some([v.unwrap_or_default(), v_dot.unwrap_or_default()]);
        let numbers = [tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot];
        let [tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot] = numbers.map(Option::unwrap_or_default);
        let is_small = libm::hypot(tilt_x, tilt_y) < GREATEST;
        let numbers = [
            ("tilt_x", tilt_x, is_small, "a tilt, with `tilt_y`, within 1.57 rad"),
            ("tilt_y", tilt_y, is_small, "a tilt, with `tilt_x`, within 1.57 rad"),
            ("twist", twist, true, "a finite angle"),
            ("omega_x", omega_x, true, "a finite rate"),
            ("omega_y", omega_y, true, "a finite rate"),
            ("omega_z", omega_z, true, "a finite rate"),
            ("v", v, true, "a finite number"),
            ("v_dot", v_dot, true, "a finite number"),
        ];
        let wrong = numbers.into_iter().find(|(_, value, fits, _)| !(value.is_finite() && *fits));
        if let Some((parameter, value, _, expected)) = wrong {
            return Err(SpecError::OutOfRange { parameter: parameter.into(), value, expected: expected.into() });
        }
        Ok(SpaceInitial { tilt: [tilt_x, tilt_y], twist, omega: [omega_x, omega_y, omega_z], vertical })
    }
}

/// The names of the numbers of a beginning in studies, with unit and help.
const OF_BEGINNING: [(&str, &str, &str); 8] = [
    ("initial.tilt_x", "rad", "Initial component of the tilt towards +x"),
    ("initial.tilt_y", "rad", "Initial component of the tilt towards +y"),
    ("initial.twist", "rad", "Initial twist about the vertical, before the tilt"),
    ("initial.omega_x", "rad/s", "Initial angular velocity about x"),
    ("initial.omega_y", "rad/s", "Initial angular velocity about y"),
    ("initial.omega_z", "rad/s", "Initial angular velocity about the vertical"),
    ("initial.v", "m", "Initial height above rest; by default settled on the supports"),
    ("initial.v_dot", "m/s", "Initial vertical velocity"),
];

/// A number of a block in space or of its beginning.
#[derive(Debug, PartialEq)]
pub struct SpaceNumber {
    /// Its name in studies and tables.
    pub name: &'static str,
    /// Its unit; `1` for pure numbers.
    pub unit: String,
    /// Its JSON Schema, with limits and help.
    pub schema: Value,
}

/// Returns all numbers of a block in space and of its beginning.
pub fn numbers() -> &'static [SpaceNumber] {
    static NUMBERS: LazyLock<Vec<SpaceNumber>> = LazyLock::new(|| {
        let schemas = [limits::properties::<BlockSpec>(), limits::properties::<SpaceSpec>()];
        let of_block = BlockSpec::default().numbers().map(|(name, _)| name);
        let of_block = of_block.into_iter().filter(|name| OF_PLANE.iter().all(|(known, _)| known != name));
        let of_space = SpaceSpec::default().numbers_mut().map(|(name, _)| name);
        let named = of_block.map(|name| (name, &schemas[0])).chain(of_space.map(|name| (name, &schemas[1])));
        let numbers = named.map(|(name, schemas)| {
            let schema = schemas[name].clone();
            SpaceNumber { name, unit: limits::unit(&schema).unwrap_or("1").into(), schema }
        });
        let of_beginning = OF_BEGINNING.map(|(name, unit, help)| SpaceNumber {
            name,
            unit: unit.into(),
            schema: json!({ "type": "number", "description": format!("{help} [{unit}]") }),
        });
        numbers.chain(of_beginning).collect()
    });
    &NUMBERS
}

/// A block in space and its beginning, with numbers set by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumbersInSpace {
    /// Parameters that the plane has, too.
    pub block: BlockSpec,
    /// Parameters of space only.
    pub space: SpaceSpec,
    /// The beginning.
    pub beginning: BeginningSpec,
}

impl NumbersInSpace {
    /// Returns the place of a number; `None` there stands for its default.
    pub fn number_mut(&mut self, number: &SpaceNumber) -> &mut Option<f64> {
        let BeginningSpec { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot } = &mut self.beginning;
        let of_beginning = [tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot];
        let named = OF_BEGINNING.into_iter().zip(of_beginning).map(|((name, ..), place)| (name, place));
        let named = named.chain(self.space.numbers_mut()).chain(self.block.numbers_mut());
        let place = named.into_iter().find_map(|(name, place)| (name == number.name).then_some(place));
        place.unwrap_or_else(|| unreachable!("{} is listed", number.name))
    }

    /// Returns the block and its beginning; `read_feet` reads a table of feet.
    ///
    /// # Errors
    /// Those of [`SpaceSpec::parameters`], and a beginning out of range. Names of the beginning begin with `initial.`.
    pub fn checked(
        &self,
        read_feet: impl FnOnce(&Path) -> Result<Vec<FootPlace>, String>,
    ) -> Result<(SpaceParameters, SpaceInitial), SpecError> {
        let parameters = self.space.parameters(&self.block, read_feet)?;
        let initial = self.beginning.initial().map_err(|error| error.with_prefix("initial."))?;
        Ok((parameters, initial))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets each number to one of its own, and finds it again.
    #[test]
    fn each_number_can_be_set() {
        for number in numbers() {
            let mut set = NumbersInSpace::default();
            *set.number_mut(number) = Some(0.3);
            assert_ne!(set, NumbersInSpace::default(), "{}", number.name);
        }
        let unit = |name: &str| numbers().iter().find(|number| number.name == name).map(|number| number.unit.as_str());
        assert_eq!(["p", "omega_v", "depth", "kappa"].map(unit), [Some("rad/s"), Some("rad/s"), Some("m"), Some("1")]);
        assert_eq!([unit("epsilon"), unit("restitution_factor"), unit("inertia")], [None; 3]);
    }
}
