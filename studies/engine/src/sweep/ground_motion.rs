//! Records and the requested measures → a ground motion of a sweep.

use std::sync::{Arc, OnceLock};

use crate::building::FloorMotion;
use crate::input::motion::Motion;
use crate::intensity::{Measure, pga};
use rocking_block::block::Block;
use rocking_block::excitation::records::Ground;
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
    /// The floor on which the block stands, in a study with a building. The ground is 0.
    pub floor: Option<usize>,
    intensities: Arc<Intensities>,
    /// PFA and PFV of the floor.
    of_floor: Vec<(Measure, Option<f64>)>,
    /// PGA of the unscaled vertical record (m/s²).
    vertical_pga: Option<f64>,
}

/// Measures of an unscaled horizontal record. Each is computed where the first row needs it, once for all blocks: a part of a study
/// need not have all records.
#[derive(Debug)]
struct Intensities {
    record: Option<Record>,
    /// Gravity of the Arias intensity (m/s²).
    gravity: f64,
    /// `None` stands for a missing value.
    values: Vec<(Measure, OnceLock<Option<f64>>)>,
}

impl Intensities {
    fn get(&self, measure: Measure) -> Option<f64> {
        let (_, value) = self.values.iter().find(|(known, _)| *known == measure)?;
        *value.get_or_init(|| measure.of(self.record.as_ref()?, self.gravity))
    }
}

/// Joins the names of a horizontal and a vertical record.
pub(super) fn joined(names: &[String; 2]) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
    names.join(" + ")
}

impl GroundMotion {
    /// A motion with these measures of the record alone. `gravity` (m/s²) is that of the Arias intensity.
    pub fn new(names: [String; 2], ground: Ground, measures: &[Measure], gravity: f64) -> GroundMotion {
        let values = measures.iter().map(|&measure| (measure, OnceLock::new())).collect();
        let intensities = Arc::new(Intensities { record: ground.horizontal.clone(), gravity, values });
        let vertical_pga = ground.vertical.as_ref().map(pga);
        GroundMotion {
            files: names.clone(),
            motion: Motion::of_names([&names[0], &names[1]]).unwrap_or_default(),
            names,
            ground,
            floor: None,
            intensities,
            of_floor: Vec::new(),
            vertical_pga,
        }
    }

    /// Names of its records: `h.AT2 + v.AT2`.
    pub fn name(&self) -> String {
        joined(&self.names)
    }

    /// The motion of a floor under this ground motion. Measures of the record remain those of the ground.
    pub fn on_floor(&self, motion: FloorMotion) -> GroundMotion {
        let FloorMotion { floor, record, pfa, pfv } = motion;
        let mut on_floor = GroundMotion { floor: Some(floor), ..self.clone() };
        on_floor.ground.horizontal = Some(record);
        on_floor.of_floor = vec![(Measure::Pfa, Some(pfa)), (Measure::Pfv, Some(pfv))];
        on_floor
    }

    /// A measure of the horizontal record times `scale`. A relative one is relative to this block.
    ///
    /// Nothing if the record has no value of it, or if [`GroundMotion::new`] did not name it.
    pub fn intensity(&self, measure: Measure, scale: f64, block: &Block) -> Option<f64> {
        let (of_record, factor) = measure.record_measure(block);
        let of_floor = self.of_floor.iter().find(|(measure, _)| *measure == of_record);
        let value = of_floor.map_or_else(|| self.intensities.get(of_record), |(_, value)| *value);
        let scales: f64 = std::iter::repeat_n(scale.abs(), measure.power().into()).product();
        value.map(|value| value * factor * scales)
    }

    /// The factor on the records at which a measure has this value. Inverse of [`GroundMotion::intensity`].
    ///
    /// Needs `value` > 0 and a measure > 0 that grows with the factor.
    pub fn scale_to(&self, measure: Measure, value: f64, block: &Block) -> f64 {
        let ratio = value / self.intensity(measure, 1.0, block).unwrap_or(f64::NAN);
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
