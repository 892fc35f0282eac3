//! Records of the components → the motion of the ground, or why they do not belong together.

use rocking_block::space::SpaceGround;
use rocking_records::Record;

/// How a caller calls the components x, y and z, and the remedy for components of different time steps.
#[derive(Clone, Copy, Debug)]
pub struct ComponentNames {
    /// The components.
    pub names: [&'static str; 3],
    /// What gives all components one time step, for "…; resample".
    pub resample: &'static str,
    /// What gives all components one length.
    pub cut: &'static str,
}

impl ComponentNames {
    /// Refuses a component y without x.
    ///
    /// # Errors
    /// A message with the names.
    pub fn check_pair(&self, has_x: bool, has_y: bool) -> Result<(), String> {
        if has_y && !has_x {
            return Err(format!("{} without {}; expected both horizontal components", self.names[1], self.names[0]));
        }
        Ok(())
    }
}

/// Refuses an azimuth that is given, by its name, where it turns nothing. Without y it turns x alone, a motion along one line.
///
/// # Errors
/// A message with the name.
pub fn check_azimuth(name: &str, is_given: bool, has_x: bool, has_pulse: bool) -> Result<(), String> {
    match !is_given || has_x || has_pulse {
        true => Ok(()),
        false => Err(format!("{name} has no effect without a horizontal record or a pulse, which it turns")),
    }
}

/// Returns the motion of the ground, with both horizontal components turned by an azimuth (rad).
///
/// # Errors
/// A component y without x, a component that is given twice, or components whose samples do not stand at the same times.
pub fn of_components(
    records: [Option<Record>; 3],
    azimuth: f64,
    known_as: ComponentNames,
) -> Result<SpaceGround, String> {
    let ComponentNames { names, resample, cut } = known_as;
    known_as.check_pair(records[0].is_some(), records[1].is_some())?;
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        if let (Some(first), Some(second)) = (&records[i], &records[j])
            && first.acceleration == second.acceleration
            && first.acceleration.iter().any(|acceleration| *acceleration != 0.0)
        {
            return Err(format!("{} has the samples of {}; expected each component once", names[j], names[i]));
        }
    }
    SpaceGround { records, azimuth }.checked().map_err(|error| {
        let of_unit = ["record.x", "record.y", "record.z"];
        let named = of_unit.iter().zip(names).fold(error, |error, (unit, name)| error.replace(unit, name));
        let advice = if named.contains(" time step of ") { resample } else { cut };
        format!("{named}; {advice}")
    })
}
