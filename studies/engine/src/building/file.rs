//! `[building]` of a study file → a building and its floors.

use crate::building::{Building, Damping};
use crate::input::study_file::{Section, StudyFileError};
use crate::spec::study::{BuildingTable, DampingValue, RayleighTable, StudyFile};

/// Reads the building and the numbers of its floors, 0 for the ground. By default all floors above it.
///
/// # Errors
/// A building without modes, or a floor that the building lacks.
pub fn read(file: &Section<StudyFile>) -> Result<Option<(Building, Vec<usize>)>, StudyFileError> {
    let Some(table) = &file.building else { return Ok(None) };
    let BuildingTable { floor_masses, storey_stiffnesses, frequencies, participation, shapes, floors, .. } = table;
    let damping = damping(file, table)?;
    let modes = ["building.frequencies", "building.participation", "building.shapes"];
    let of_modes = modes.into_iter().find(|path| file.get(path).is_some());
    let is_shear = floor_masses.is_some() || storey_stiffnesses.is_some();
    if let (true, Some(path)) = (is_shear, of_modes) {
        return Err(file.wrong(path, "none beside floor_masses and storey_stiffnesses"));
    }
    let building = match (floor_masses, storey_stiffnesses, frequencies, participation, shapes) {
        (Some(masses), Some(stiffnesses), ..) => Building::shear(masses, stiffnesses, &damping),
        (None, None, Some(frequencies), Some(participation), Some(shapes)) => {
            Building::of_modes(frequencies, participation, shapes, &damping)
        }
        _ => {
            const EXPECTED: &str = "floor_masses and storey_stiffnesses, or frequencies, participation and shapes";
            return Err(file.refused("building", format!("building has no modes; expected {EXPECTED}")));
        }
    };
    let building = building.map_err(|error| file.refused(&format!("building.{}", error.name), error.to_string()))?;
    let last = building.floors();
    let floors: Vec<usize> = match floors {
        Some(list) => list.iter().map(|&floor| floor as usize).collect(),
        None => (1..=last).collect(),
    };
    for (number, floor) in floors.iter().enumerate() {
        if *floor > last {
            let place = format!("building.floors.{number}");
            return Err(file.wrong(&place, &format!("floors from 0, the ground, to {last}")));
        }
        if floors[..number].contains(floor) {
            let message = format!("floors names {floor} twice; expected each floor once");
            return Err(file.refused("building.floors", message));
        }
    }
    Ok(Some((building, floors)))
}

fn damping(file: &Section<StudyFile>, table: &BuildingTable) -> Result<Damping, StudyFileError> {
    match (&table.damping, &table.rayleigh) {
        (Some(_), Some(_)) => Err(file.wrong("building.damping", "none beside rayleigh")),
        (Some(DampingValue::All(ratio)), None) => Ok(Damping::All(*ratio)),
        (Some(DampingValue::Each(list)), None) => Ok(Damping::Each(list.clone())),
        (None, Some(RayleighTable { damping, modes })) => {
            Ok(Damping::Rayleigh(damping.0, modes.map(|mode| mode as usize)))
        }
        (None, None) => Err(file.refused("building", "building has no damping; expected a ratio, a list, or rayleigh")),
    }
}
