//! Records and the requested measures → a ground motion of a sweep.

use std::sync::{Arc, OnceLock};

use crate::building::FloorMotion;
use crate::input::motion::{Motion, REVERSED};
use crate::intensity::{BlockScales, ComponentMeasure, Measure, over_directions, pga};
use rocking_block::excitation::records::{Ground, fingerprint};
use rocking_block::space::SpaceGround;
use rocking_records::Record;

/// A ground motion and its intensity measures.
#[derive(Clone, Debug)]
pub struct GroundMotion {
    /// The horizontal and the vertical file as written in the study, or empty.
    pub files: [String; 2],
    /// Names of the horizontal and the vertical record, each of one content. They are files, with channels where a file has several
    /// records.
    pub names: [String; 2],
    /// Its event and station; empty without records.
    pub motion: Motion,
    /// The records, unscaled. In a building the horizontal one is the absolute acceleration of the floor.
    pub ground: Ground,
    /// The second horizontal component of a block in space, a quarter turn ahead of the first.
    pub transverse: Option<Transverse>,
    /// Direction of the horizontal record for a block in space (degrees), from +x towards +y. It turns both components together.
    pub azimuth: f64,
    /// Whether the horizontal record is reversed, of a study with both polarities.
    pub is_reversed: bool,
    /// The floor on which the block stands, in a study with a building. The ground is 0.
    pub floor: Option<usize>,
    intensities: Arc<Intensities>,
    /// PFA and PFV of the floor.
    of_floor: Vec<(Measure, Option<f64>)>,
    /// PGA of the unscaled vertical record (m/s²).
    vertical_pga: Option<f64>,
}

/// The second horizontal component of a ground motion.
#[derive(Clone, Debug)]
pub struct Transverse {
    /// The file as written in the study.
    pub file: String,
    /// Name of the record, of one content.
    pub name: String,
    /// The record, unscaled.
    pub record: Record,
}

/// Measures of an unscaled horizontal record, or of a pair. Each is computed where the first row needs it, once for all blocks: a part of
/// a study need not have all records.
#[derive(Debug)]
struct Intensities {
    record: Option<Record>,
    /// The second component of a pair; without it, it is one of zeros.
    transverse: Option<Record>,
    /// Gravity of the Arias intensity (m/s²).
    gravity: f64,
    /// `None` stands for a missing value.
    values: Vec<(Measure, OnceLock<Option<f64>>)>,
    /// Those of pairs, in all ways over their directions.
    of_pair: Vec<(ComponentMeasure, OnceLock<Option<[f64; 4]>>)>,
}

impl Intensities {
    fn new(ground: &Ground, transverse: Option<&Record>, measures: &[Measure], gravity: f64) -> Intensities {
        let (mut values, mut of_pair) = (Vec::new(), Vec::new());
        for &measure in measures {
            match measure {
                Measure::OfPair(measure, _) if of_pair.iter().any(|(known, _)| *known == measure) => (),
                Measure::OfPair(measure, _) => of_pair.push((measure, OnceLock::new())),
                measure => values.push((measure, OnceLock::new())),
            }
        }
        Intensities { record: ground.horizontal.clone(), transverse: transverse.cloned(), gravity, values, of_pair }
    }

    fn get(&self, measure: Measure) -> Option<f64> {
        if let Measure::OfPair(measure, over) = measure {
            let (_, values) = self.of_pair.iter().find(|(known, _)| *known == measure)?;
            return values.get_or_init(|| self.over_directions(measure)).map(|values| values[over as usize]);
        }
        let (_, value) = self.values.iter().find(|(known, _)| *known == measure)?;
        *value.get_or_init(|| measure.of(self.record.as_ref()?, self.gravity))
    }

    fn over_directions(&self, measure: ComponentMeasure) -> Option<[f64; 4]> {
        let record = self.record.as_ref()?;
        let none = || Record { acceleration: vec![0.0; record.acceleration.len()].into(), ..record.clone() };
        let transverse = self.transverse.clone().unwrap_or_else(none);
        over_directions(measure, [record, &transverse], self.gravity).ok().flatten()
    }
}

/// Joins the names of both horizontal records and the vertical one, those that there are.
pub(super) fn joined(names: [&str; 3]) -> String {
    let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
    names.join(" + ")
}

impl GroundMotion {
    /// A motion with these measures of the record alone. `gravity` (m/s²) is that of the Arias intensity.
    pub fn new(names: [String; 2], ground: Ground, measures: &[Measure], gravity: f64) -> GroundMotion {
        GroundMotion::of_components(names, ground, None, measures, gravity)
    }

    /// [`GroundMotion::new`] with a second horizontal component, which a block in space needs.
    pub fn of_components(
        names: [String; 2],
        ground: Ground,
        transverse: Option<Transverse>,
        measures: &[Measure],
        gravity: f64,
    ) -> GroundMotion {
        let second = transverse.as_ref().map(|transverse| &transverse.record);
        let intensities = Arc::new(Intensities::new(&ground, second, measures, gravity));
        let vertical_pga = ground.vertical.as_ref().map(pga);
        GroundMotion {
            files: names.clone(),
            motion: Motion::of_names([&names[0], &names[1]]).unwrap_or_default(),
            names,
            ground,
            transverse,
            azimuth: 0.0,
            is_reversed: false,
            floor: None,
            intensities,
            of_floor: Vec::new(),
            vertical_pga,
        }
    }

    /// Names of its records: `h.AT2 + v.AT2`, with a second horizontal component between them.
    pub fn name(&self) -> String {
        let second = self.transverse.as_ref().map_or("", |transverse| &transverse.name);
        joined([&self.names[0], second, &self.names[1]])
    }

    /// The files of its records.
    pub fn read_files(&self) -> impl Iterator<Item = &String> {
        let second = self.transverse.iter().map(|transverse| &transverse.file);
        self.files.iter().chain(second).filter(|file| !file.is_empty())
    }

    /// Describes the content of all records in a line.
    pub fn fingerprint(&self) -> String {
        match &self.transverse {
            Some(transverse) => {
                let second = fingerprint(&transverse.record);
                format!("{}; transverse {second}, azimuth {} degrees", self.ground.fingerprint(), self.azimuth)
            }
            None if self.azimuth != 0.0 => {
                format!("{}, azimuth {} degrees", self.ground.fingerprint(), self.azimuth)
            }
            None => self.ground.fingerprint(),
        }
    }

    /// The motion of a floor under this ground motion. Measures of the record remain those of the ground.
    pub fn on_floor(&self, motion: FloorMotion) -> GroundMotion {
        let FloorMotion { floor, record, pfa, pfv } = motion;
        let mut on_floor = GroundMotion { floor: Some(floor), ..self.clone() };
        on_floor.ground.horizontal = Some(record);
        on_floor.of_floor = vec![(Measure::Pfa, Some(pfa)), (Measure::Pfv, Some(pfv))];
        on_floor
    }

    /// The same motion with its horizontal record reversed, whose measures are the same. The vertical one stays.
    pub fn reversed(&self) -> GroundMotion {
        let mut reversed = GroundMotion { is_reversed: !self.is_reversed, ..self.clone() };
        reversed.names[0] += REVERSED;
        reversed.ground.horizontal = reversed.ground.horizontal.map(|record| record.scaled(-1.0));
        reversed
    }

    /// The motion with its horizontal record in another direction (degrees).
    pub fn turned(&self, azimuth: f64) -> GroundMotion {
        GroundMotion { azimuth, ..self.clone() }
    }

    /// The motion of the ground under a block in space, times `scale`.
    pub fn in_space(&self, scale: f64) -> SpaceGround {
        let second = self.transverse.as_ref().map(|transverse| &transverse.record);
        let records = [self.ground.horizontal.as_ref(), second, self.ground.vertical.as_ref()];
        let records = records.map(|record| record.map(|record| record.clone().scaled(scale)));
        SpaceGround { records, azimuth: self.azimuth.to_radians() }
    }

    /// A measure of the horizontal record times `scale`. A relative one is relative to a block of these scales.
    ///
    /// Nothing if the record has no value of it, or if [`GroundMotion::new`] did not name it.
    pub fn intensity(&self, measure: Measure, scale: f64, scales: BlockScales) -> Option<f64> {
        let (of_record, factor) = measure.record_measure(scales);
        let of_floor = self.of_floor.iter().find(|(measure, _)| *measure == of_record);
        let value = of_floor.map_or_else(|| self.intensities.get(of_record), |(_, value)| *value);
        let factors: f64 = std::iter::repeat_n(scale.abs(), measure.power().into()).product();
        value.map(|value| value * factor * factors)
    }

    /// The factor on the records at which a measure has this value. Inverse of [`GroundMotion::intensity`].
    ///
    /// Needs `value` > 0 and a measure > 0 that grows with the factor.
    pub fn scale_to(&self, measure: Measure, value: f64, scales: BlockScales) -> f64 {
        let ratio = value / self.intensity(measure, 1.0, scales).unwrap_or(f64::NAN);
        if measure.power() == 2 { ratio.sqrt() } else { ratio }
    }

    /// PGA (m/s²) of the vertical record times `scale`.
    pub fn vertical_pga(&self, scale: f64) -> Option<f64> {
        self.vertical_pga.map(|pga| pga * scale.abs())
    }

    /// Whether there is a record at all.
    pub fn has_record(&self) -> bool {
        self.ground.time_step().is_some()
    }
}
