//! `[building]` of a study file → a building and its floors.

use crate::building::{Building, Damping};
use crate::input::study_file::{Section, StudyFileError};
use crate::spec::study::{BuildingTable, RayleighTable};

/// Reads the building and the numbers of its floors, 0 for the ground. By default all floors above it.
///
/// # Errors
/// A key that is missing, unknown or out of range, or a floor that the building lacks.
pub fn read(root: &Section) -> Result<Option<(Building, Vec<usize>)>, StudyFileError> {
    let (Some(section), Some(table)) = (root.section::<BuildingTable>("building")?, root.get("building")) else {
        return Ok(None);
    };
    let is_shear = section.get("floor_masses").is_some() || section.get("storey_stiffnesses").is_some();
    let (needed, unread): (&[&str], &[&str]) = match is_shear {
        true => (&["floor_masses", "storey_stiffnesses"], &["frequencies", "participation", "shapes"]),
        false => (&["frequencies", "participation", "shapes"], &[]),
    };
    if let Some((key, value)) = unread.iter().find_map(|&key| Some((key, section.get(key)?))) {
        return Err(section.wrong(key, value, "none beside floor_masses and storey_stiffnesses"));
    }
    let numbers = |key: &str| {
        let found = section.numbers(key, |_| true, "a list of numbers")?;
        found.ok_or_else(|| {
            section.lacks(key, &format!("{}, or floor_masses and storey_stiffnesses", needed.join(", ")))
        })
    };
    let damping = damping(&section)?;
    let building = if is_shear {
        Building::shear(&numbers("floor_masses")?, &numbers("storey_stiffnesses")?, &damping)
    } else {
        let shapes = section.lists("shapes", "a list of lists of numbers, a list per mode with a value per floor")?;
        Building::of_modes(&numbers("frequencies")?, &numbers("participation")?, &shapes, &damping)
    };
    let building = building.map_err(|error| {
        let value = section.get(error.name).unwrap_or(table);
        section.refused(value, error.to_string())
    })?;
    let last = building.floors();
    let expected = format!("floors from 0, the ground, to {last}");
    let is_floor = |x: f64| x.fract() == 0.0 && (0.0..=last as f64).contains(&x);
    let floors = section.numbers("floors", is_floor, &expected)?;
    let floors: Vec<usize> =
        floors.map_or_else(|| (1..=last).collect(), |list| list.iter().map(|&x| x as usize).collect());
    let twice = floors.iter().enumerate().find(|(number, floor)| floors[..*number].contains(floor));
    if let (Some((_, floor)), Some(value)) = (twice, section.get("floors")) {
        return Err(section.refused(value, format!("floors names {floor} twice; expected each floor once")));
    }
    Ok(Some((building, floors)))
}

fn damping(section: &Section) -> Result<Damping, StudyFileError> {
    const EXPECTED: &str = "a ratio, or a list of one per mode";
    let rayleigh = section.section::<RayleighTable>("rayleigh")?;
    match (section.get("damping"), rayleigh) {
        (Some(value), Some(_)) => Err(section.wrong("damping", value, "none beside rayleigh")),
        (Some(value), None) if value.get_ref().is_array() => {
            Ok(Damping::Each(section.numbers("damping", |_| true, EXPECTED)?.unwrap_or_default()))
        }
        (_, None) => {
            let ratio = section.number("damping", |_| true, EXPECTED)?;
            ratio.map(Damping::All).ok_or_else(|| section.lacks("damping", "a ratio, a list, or rayleigh"))
        }
        (None, Some(rayleigh)) => {
            const MODES: &str = "two modes, as in [1, 3]";
            let ratio = rayleigh.number("damping", |x| x > 0.0, "a ratio > 0")?;
            let ratio = ratio.ok_or_else(|| rayleigh.lacks("damping", "the ratio in both modes"))?;
            let modes = rayleigh.numbers("modes", |x| x.fract() == 0.0 && x >= 1.0, MODES)?;
            match modes.as_deref() {
                Some([i, j]) => Ok(Damping::Rayleigh(ratio, [*i as usize, *j as usize])),
                _ => Err(rayleigh.lacks("modes", MODES)),
            }
        }
    }
}
