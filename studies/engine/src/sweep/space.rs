//! A study of blocks in space: its parameters → blocks and their runs.

use std::path::Path;

use toml::de::DeValue;

use crate::input::parameters::{Parameter, Vocabulary};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, number};
use crate::intensity::BlockScales;
use crate::output::table::TableColumn;
use crate::space::ground::check_azimuth;
use crate::space::{RunInSpace, outcome};
use crate::spec::numbers_in_space::NumbersInSpace;
use crate::spec::space::{BaseShape, FeetSpec, MAKES_SPACE, feet_of_table};
use crate::spec::study::{Azimuths, StudyFile};
use crate::spec::words::Words;
use crate::spec::{SpaceSpec, SpecError};
use crate::statistics::sampling::LatinHypercube;
use crate::sweep::Sweep;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::SweptParameter;
use crate::sweep::rows::{RowValues, SweepRow, SweptRun};
use rocking_block::space::{FootPlace, SpaceBody, SpaceInitial, SpaceParameters};

/// What all blocks in space of a study share.
#[derive(Clone, Debug, PartialEq)]
pub struct BlocksInSpace {
    /// Shape of the base, feet and inertia tensor.
    pub shape: SpaceSpec,
    /// The file of the feet and their places, if a file has them.
    pub feet: Option<(String, Vec<FootPlace>)>,
}

/// The keys of parameters that no study varies.
pub(super) const SHAPE: [&str; 3] = ["base", "feet", "inertia_tensor"];

/// Returns the bodies whose parameters a study names.
pub(super) fn vocabulary(file: &Section<StudyFile>) -> Vocabulary {
    let makes_space = MAKES_SPACE.iter().any(|key| file.get(&format!("parameters.{key}")).is_some());
    if makes_space { Vocabulary::Space } else { Vocabulary::Plane }
}

/// Reads what all blocks of a study share; `None` for blocks in the plane. Paths are relative to `folder`.
pub(super) fn read(file: &Section<StudyFile>, folder: &Path) -> Result<Option<BlocksInSpace>, StudyFileError> {
    if vocabulary(file) == Vocabulary::Plane {
        return match file.study.azimuths {
            Some(_) => {
                let expected =
                    "none; it turns the ground motion of a block in space, which has depth, depth_ratio, base or feet";
                Err(file.wrong("study.azimuths", expected))
            }
            None => Ok(None),
        };
    }
    refuse_of_plane(file)?;
    let mut blocks = BlocksInSpace { shape: SpaceSpec::default(), feet: None };
    let given = |key: &str| file.get(&format!("parameters.{key}"));
    if let Some(value) = given("base") {
        let word = value.get_ref().as_str().and_then(BaseShape::named);
        let known: Vec<String> = BaseShape::WORDS.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let expected = known.join(" or ");
        blocks.shape.base = Some(word.ok_or_else(|| file.wrong("parameters.base", &expected))?);
    }
    if let Some(value) = given("feet") {
        let feet = feet(value).ok_or_else(|| {
            file.wrong("parameters.feet", "the number of feet of a circular base, or the name of a file of feet")
        })?;
        if let FeetSpec::File(path) = &feet {
            let name = path.display().to_string();
            let refused = |message: String| file.refused("parameters.feet", message);
            let text = std::fs::read_to_string(folder.join(path));
            let text = text.map_err(|error| refused(format!("{name}: cannot be read: {error}")))?;
            blocks.feet = Some((name.clone(), feet_of_table(&name, &text).map_err(refused)?));
        }
        blocks.shape.feet = Some(feet);
    }
    if let Some(value) = given("inertia_tensor") {
        let numbers = value.get_ref().as_array().and_then(|list| list.iter().map(number).collect());
        let expected = "3 moments of inertia in kg.m2, or 3 moments and 3 products";
        let numbers: Vec<f64> = numbers.ok_or_else(|| file.wrong("parameters.inertia_tensor", expected))?;
        blocks.shape.inertia_tensor = Some(numbers);
    }
    Ok(Some(blocks))
}

/// Reads the number of feet, or the name of their file.
fn feet(value: SpannedValue) -> Option<FeetSpec> {
    match value.get_ref() {
        DeValue::String(path) => Some(FeetSpec::File(path.as_ref().into())),
        DeValue::Integer(_) => Some(FeetSpec::Count(number(value)? as usize)),
        _ => None,
    }
}

/// Refuses what only studies of blocks in the plane have.
fn refuse_of_plane(file: &Section<StudyFile>) -> Result<(), StudyFileError> {
    for (path, instead) in [
        ("building", "a building moves its floors along one direction; expected blocks without depth, base and feet"),
        ("study.friction_demand", "in space friction limits the feet themselves; expected friction in [parameters]"),
        ("study.half_cycles", "they are those of ties and dampers; expected blocks without depth, base and feet"),
    ] {
        if file.get(path).is_some() {
            let name = path.rsplit('.').next().unwrap_or(path);
            return Err(file.refused(path, format!("{name} is for a block in the plane: {instead}")));
        }
    }
    Ok(())
}

/// Returns each ground motion in each direction of the study.
pub(super) fn turned(
    file: &Section<StudyFile>,
    motions: Vec<GroundMotion>,
    has_pulse: bool,
) -> Result<Vec<GroundMotion>, StudyFileError> {
    let Some(azimuths) = &file.study.azimuths else { return Ok(motions) };
    let has_x = motions.iter().any(|motion| motion.ground.horizontal.is_some());
    check_azimuth("azimuths", true, has_x, has_pulse).map_err(|message| file.refused("study.azimuths", message))?;
    let of_motion: Vec<Vec<f64>> = match azimuths {
        Azimuths::List(list) => {
            for (number, azimuth) in list.iter().enumerate() {
                if list[..number].contains(azimuth) {
                    return Err(file.wrong(&format!("study.azimuths.{number}"), "each direction once"));
                }
            }
            motions.iter().map(|_| list.clone()).collect()
        }
        Azimuths::Random(random) => {
            let cube = LatinHypercube::new(random.count, motions.len(), random.seed.0);
            let of = |motion: usize| {
                let mut drawn: Vec<f64> = (0..random.count).map(|i| 360.0 * cube.coordinate(i, motion)).collect();
                drawn.sort_by(f64::total_cmp);
                drawn
            };
            (0..motions.len()).map(of).collect()
        }
    };
    let each = motions.iter().zip(of_motion);
    Ok(each.flat_map(|(motion, azimuths)| azimuths.into_iter().map(|azimuth| motion.turned(azimuth))).collect())
}

impl BlocksInSpace {
    /// The numbers of a block with the values of a combination.
    pub(super) fn numbers(&self, parameters: &[SweptParameter], combination: &[f64]) -> NumbersInSpace {
        let mut numbers = NumbersInSpace { space: self.shape.clone(), ..NumbersInSpace::default() };
        for (SweptParameter { parameter, .. }, &value) in parameters.iter().zip(combination) {
            if let Some(number) = parameter.in_space_number() {
                *numbers.number_mut(number) = Some(value);
            }
        }
        numbers
    }

    /// The block of these numbers and its beginning.
    ///
    /// # Errors
    /// The first number that is not valid, or is not read.
    pub(super) fn block(
        &self,
        numbers: &NumbersInSpace,
    ) -> Result<(SpaceParameters, SpaceBody, SpaceInitial), SpecError> {
        let feet = || self.feet.iter().flat_map(|(_, places)| places.iter().copied()).collect();
        let (parameters, initial) = numbers.checked(|_| Ok(feet()))?;
        let body = SpaceBody::new(&parameters)?;
        Ok((parameters, body, initial))
    }

    /// Describes the content of the file of feet, if there is one.
    pub(super) fn fingerprint(&self) -> Option<String> {
        let (file, places) = self.feet.as_ref()?;
        let mut hasher = crc32fast::Hasher::new();
        places.iter().flat_map(|foot| [foot.x, foot.y, foot.gap]).for_each(|x| hasher.update(&x.to_le_bytes()));
        Some(format!("{file}: {} feet, crc32 {:08x}", places.len(), hasher.finalize()))
    }
}

impl RowValues {
    /// The value of a parameter; `None` if it is a number of a block in space that the study does not name.
    pub(super) fn number(&self, parameter: &Parameter) -> Option<f64> {
        match (parameter.variable(), parameter.in_space_number()) {
            (Some(variable), _) => Some(self.variables[variable]),
            (None, Some(number)) => *self.in_space.clone()?.number_mut(number),
            (None, None) => None,
        }
    }

    /// Sets the value of a parameter.
    pub(super) fn set(&mut self, parameter: &Parameter, value: f64) {
        match (parameter.variable(), parameter.in_space_number(), &mut self.in_space) {
            (Some(variable), ..) => self.variables[variable] = value,
            (None, Some(number), Some(in_space)) => *in_space.number_mut(number) = Some(value),
            (None, ..) => unreachable!("{} is no parameter of this block", parameter.name()),
        }
    }
}

impl SweptRun for RunInSpace {
    fn of(sweep: &Sweep, values: &RowValues) -> (BlockScales, RunInSpace) {
        let RowValues { variables, in_space } = values;
        let numbers = in_space.as_ref().expect("a study of blocks in space");
        let (parameters, body, initial) = sweep.block_in_space(numbers).expect("all blocks of a study are valid");
        let scales = match sweep.changes.is_empty() {
            true => BlockScales::from(&body),
            false => sweep.scales_in_space(values).expect("all blocks of a study are valid"),
        };
        let at_rest = RunInSpace::at_rest(parameters, body, variables.settings(Some(sweep.tolerance)));
        let (duration, output_step) = (sweep.duration, sweep.step.unwrap_or(f64::INFINITY));
        (scales, RunInSpace { initial, duration, output_step, ..at_rest.with_pulse(variables.pulse(), 0.0) })
    }

    /// The pulse turns with the records.
    fn under(self, motion: &GroundMotion, scale: f64) -> RunInSpace {
        let pulse = self.setup.pulses[0].pulse;
        RunInSpace { ground: motion.in_space(scale), ..self.with_pulse(pulse, motion.azimuth) }
    }

    fn columns<'a>(_: &'a Sweep) -> Vec<TableColumn<'a, SweepRow<'a, RunInSpace>>> {
        outcome::columns(|row: &SweepRow<RunInSpace>| &row.outcome)
    }
}
