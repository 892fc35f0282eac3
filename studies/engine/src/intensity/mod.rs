//! A record → its intensity measures, also relative to the scales of a block.
//!
//! | module | in → out |
//! | --- | --- |
//! | `column` | a heading → a measure with the unit of its numbers |
//! | `sums` | a record → its peaks, Arias intensity, CAV and significant duration |
//! | `oscillator` | a record → the peaks of elastic oscillators: Sa(T), Sv(T), spectrum intensity |
//! | `period` | a record → its mean period |
//! | `rotated` | two components → measures over all directions, RotDnn |
//! | `pair` | two components → one value of a measure: the larger, the geometric mean, RotD50, RotD100 |
//!
//! The acceleration of a [`Record`] is linear between its samples; integrals and peaks between samples are exact for it. Programs
//! that sum over samples differ by the error of their rule, which decreases with the square of the time step; each measure states
//! it. There is no base line correction: velocity and displacement are those of the file, from rest at its first sample.

mod column;
mod oscillator;
mod pair;
mod period;
mod rotated;
mod sums;

use std::str::FromStr;

use rocking_block::block::{Block, Corner};
use rocking_block::space::SpaceBody;
use rocking_records::Record;

pub use column::{MeasureColumn, canonical, si};
pub(crate) use oscillator::OscillatorStep;
pub use oscillator::{DAMPING, OscillatorPeaks, oscillator_peaks, spectral_acceleration, spectrum_intensity};
pub use pair::{ComponentMeasure, OverDirections, over_directions};
pub use period::mean_period;
pub use rotated::{rot_d, rotated};
pub use sums::{arias, cumulative_absolute_velocity, pga, pgd, pgv, significant_duration};

/// An intensity measure: the strength, duration or period of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Peak ground acceleration (m/s²), see [`pga`].
    Pga,
    /// Peak ground velocity (m/s), see [`pgv`].
    Pgv,
    /// Peak ground displacement (m), see [`pgd`].
    Pgd,
    /// PGV/PGA (s), which increases with the period of the strongest motion.
    PgvToPga,
    /// Arias intensity (m/s), see [`arias`].
    Arias,
    /// Cumulative absolute velocity (m/s), see [`cumulative_absolute_velocity`].
    Cav,
    /// Significant duration (s), see [`significant_duration`].
    SignificantDuration,
    /// Mean period (s), see [`mean_period`].
    MeanPeriod,
    /// Housner's spectrum intensity (m), see [`spectrum_intensity`].
    SpectrumIntensity,
    /// Spectral acceleration (m/s²) at this period (s), 5 % damping, see [`spectral_acceleration`].
    Sa(f64),
    /// Spectral velocity (m/s) at this period (s), 5 % damping, see [`OscillatorPeaks::velocity`].
    Sv(f64),
    /// PGA/(g tan α) (1): above one, a block on a rigid base lifts off.
    PgaToUplift,
    /// p·PGV/(g tan α) (1), PGV over one that overturns a block of this size.
    ///
    /// E. G. Dimitrakopoulos, T. S. Paraskeva, Dimensionless fragility curves for rocking response to near-fault excitations, EESD 44
    /// (2015) 2015–2033.
    PgvToOverturning,
    /// Peak floor acceleration (m/s²): greatest absolute acceleration of the floor on which the block stands.
    Pfa,
    /// Peak floor velocity (m/s): greatest absolute velocity of the floor. It includes that of the ground, and is the demand of FEMA P-58
    /// for blocks that overturn.
    Pfv,
    /// p·T_m (1), the mean period relative to the time scale 1/p of the block.
    PeriodToBlock,
    /// A measure of a pair of components over its directions.
    OfPair(ComponentMeasure, OverDirections),
}

/// The scales of a block, to which measures are relative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockScales {
    /// Slenderness angle α (rad): of the side with less base, which lifts and overturns first; in space over the nearest edge.
    pub alpha: f64,
    /// Frequency parameter p (rad/s).
    pub p: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
}

impl From<&Block> for BlockScales {
    fn from(block: &Block) -> BlockScales {
        let [left, right] = Corner::each(|corner| block.alpha_of(corner));
        BlockScales { alpha: left.min(right), p: block.p, gravity: block.gravity }
    }
}

impl From<&SpaceBody> for BlockScales {
    fn from(body: &SpaceBody) -> BlockScales {
        BlockScales { alpha: body.edge_angle, p: body.p, gravity: body.gravity }
    }
}

impl Measure {
    /// Measures of a record alone, without an oscillator period, in the order of the tables.
    pub const OF_RECORD: [Measure; 9] = [
        Measure::Pga,
        Measure::Pgv,
        Measure::Pgd,
        Measure::PgvToPga,
        Measure::Arias,
        Measure::Cav,
        Measure::SignificantDuration,
        Measure::MeanPeriod,
        Measure::SpectrumIntensity,
    ];

    /// Measures of a record relative to a block.
    pub const OF_BLOCK: [Measure; 3] = [Measure::PgaToUplift, Measure::PgvToOverturning, Measure::PeriodToBlock];

    /// Measures of the motion of a floor, which a study with a building has.
    pub const OF_FLOOR: [Measure; 2] = [Measure::Pfa, Measure::Pfv];

    /// Measures of a record alone: [`Measure::OF_RECORD`], then Sa and Sv at each period (s).
    pub fn of_record(periods: &[f64]) -> Vec<Measure> {
        let spectral = [Measure::Sa as fn(f64) -> Measure, Measure::Sv];
        let spectral = spectral.iter().flat_map(|kind| periods.iter().map(|&period| kind(period)));
        Measure::OF_RECORD.into_iter().chain(spectral).collect()
    }

    /// Measures of a pair of records: PGA, PGV, then Sa and Sv at each period (s), each over its directions.
    pub fn of_pair(periods: &[f64]) -> Vec<Measure> {
        let spectral = [ComponentMeasure::Sa as fn(f64) -> ComponentMeasure, ComponentMeasure::Sv];
        let spectral = spectral.iter().flat_map(|kind| periods.iter().map(|&period| kind(period)));
        Measure::over_directions([ComponentMeasure::Pga, ComponentMeasure::Pgv].into_iter().chain(spectral))
    }

    /// Measures of a pair of records relative to a block, each over its directions.
    pub fn of_pair_to_block() -> Vec<Measure> {
        Measure::over_directions([ComponentMeasure::PgaToUplift, ComponentMeasure::PgvToOverturning])
    }

    fn over_directions(measures: impl IntoIterator<Item = ComponentMeasure>) -> Vec<Measure> {
        let each = |measure| OverDirections::ALL.map(|over| Measure::OfPair(measure, over));
        measures.into_iter().flat_map(each).collect()
    }

    /// The column heading, name and unit: `PGV [m/s]`.
    pub fn heading(self) -> String {
        format!("{self} [{}]", self.unit())
    }

    /// The name in tables, without a period; the unit; and the power of a factor on the record that multiplies the measure.
    fn properties(self) -> (&'static str, &'static str, u8) {
        match self {
            Measure::Pga => ("PGA", "m/s2", 1),
            Measure::Pgv => ("PGV", "m/s", 1),
            Measure::Pgd => ("PGD", "m", 1),
            Measure::PgvToPga => ("PGV/PGA", "s", 0),
            Measure::Arias => ("Arias", "m/s", 2),
            Measure::Cav => ("CAV", "m/s", 1),
            Measure::SignificantDuration => ("D5-95", "s", 0),
            Measure::MeanPeriod => ("T_m", "s", 0),
            Measure::SpectrumIntensity => ("SI", "m", 1),
            Measure::Sa(_) => ("Sa", "m/s2", 1),
            Measure::Sv(_) => ("Sv", "m/s", 1),
            Measure::PgaToUplift => ("PGA/(g tan alpha)", "1", 1),
            Measure::PgvToOverturning => ("p PGV/(g tan alpha)", "1", 1),
            Measure::Pfa => ("PFA", "m/s2", 1),
            Measure::Pfv => ("PFV", "m/s", 1),
            Measure::PeriodToBlock => ("p T_m", "1", 0),
            Measure::OfPair(measure, _) => measure.measure().properties(),
        }
    }

    /// The unit.
    pub fn unit(self) -> &'static str {
        self.properties().1
    }

    /// The power of a factor on the record that multiplies the measure, 0 without effect.
    pub fn power(self) -> u8 {
        self.properties().2
    }

    /// The underlying measure of the record, and the factor that relates it to a block of these scales.
    pub fn record_measure(self, scales: BlockScales) -> (Measure, f64) {
        let BlockScales { alpha, p, gravity } = scales;
        let uplift = || gravity * libm::tan(alpha);
        match self {
            Measure::PgaToUplift => (Measure::Pga, 1.0 / uplift()),
            Measure::PgvToOverturning => (Measure::Pgv, p / uplift()),
            Measure::PeriodToBlock => (Measure::MeanPeriod, p),
            Measure::OfPair(measure, over) => {
                let (of_record, factor) = measure.measure().record_measure(scales);
                ComponentMeasure::of(of_record)
                    .map_or((self, 1.0), |of_record| (Measure::OfPair(of_record, over), factor))
            }
            of_record => (of_record, 1.0),
        }
    }

    /// Whether the measure is relative to the slenderness α of a block, and to its frequency parameter p.
    pub fn relative_to(self) -> [bool; 2] {
        match self {
            Measure::OfPair(measure, _) => measure.measure().relative_to(),
            measure => [
                matches!(measure, Measure::PgaToUplift | Measure::PgvToOverturning),
                matches!(measure, Measure::PgvToOverturning | Measure::PeriodToBlock),
            ],
        }
    }

    /// The same measure of a single component, and how those of a pair became one; `None` for that of one component.
    pub fn of_component(self) -> (Measure, Option<OverDirections>) {
        match self {
            Measure::OfPair(measure, over) => (measure.measure(), Some(over)),
            measure => (measure, None),
        }
    }

    /// The value for a record; `gravity` (m/s²) is that of the Arias intensity.
    ///
    /// `None` for measures relative to a block, of a floor or of a pair, and for periods and durations of a record of zeros.
    pub fn of(self, record: &Record, gravity: f64) -> Option<f64> {
        let value = match self {
            Measure::Pga => pga(record),
            Measure::Pgv => pgv(record),
            Measure::Pgd => pgd(record),
            Measure::PgvToPga => pgv(record) / pga(record),
            Measure::Arias => arias(record, gravity),
            Measure::Cav => cumulative_absolute_velocity(record),
            Measure::SignificantDuration => significant_duration(record)?,
            Measure::MeanPeriod => mean_period(record)?,
            Measure::SpectrumIntensity => spectrum_intensity(record),
            Measure::Sa(period) => spectral_acceleration(record, period),
            Measure::Sv(period) => oscillator_peaks(record, period).velocity,
            Measure::Pfa | Measure::Pfv => return None,
            Measure::PgaToUplift | Measure::PgvToOverturning | Measure::PeriodToBlock | Measure::OfPair(..) => {
                return None;
            }
        };
        Some(value).filter(|value| value.is_finite())
    }
}

/// The name in tables and study files.
impl std::fmt::Display for Measure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, ..) = self.properties();
        match self {
            Measure::Sa(period) | Measure::Sv(period) => write!(f, "{name}({period} s)"),
            Measure::OfPair(measure, over) => f.write_str(&measure.name(over.word())),
            _ => f.write_str(name),
        }
    }
}

impl FromStr for Measure {
    type Err = String;

    /// Reads a name in any case, as in `PGV`, `Sa(0.5 s)` or `Sa(0.5)`.
    fn from_str(name: &str) -> Result<Measure, String> {
        let named = || Measure::OF_RECORD.into_iter().chain(Measure::OF_FLOOR).chain(Measure::OF_BLOCK);
        if let Some(measure) = named().find(|measure| measure.to_string().eq_ignore_ascii_case(name)) {
            return Ok(measure);
        }
        let spectral = [("sa(", Measure::Sa as fn(f64) -> Measure), ("sv(", Measure::Sv)];
        let lower = name.to_ascii_lowercase();
        let of_pair = OverDirections::ALL.into_iter().find_map(|over| {
            let word = format!(".{}", over.word().to_ascii_lowercase());
            let at = lower.find(&word).filter(|at| !lower[at + word.len()..].starts_with('0'))?;
            let component = format!("{}{}", &lower[..at], &lower[at + word.len()..]).parse().ok()?;
            ComponentMeasure::of(component).map(|component| Measure::OfPair(component, over))
        });
        if let Some(measure) = of_pair {
            return Ok(measure);
        }
        let found = spectral.iter().find_map(|(start, kind)| {
            let period = lower.strip_prefix(start)?.strip_suffix(')')?;
            let period: f64 = period.strip_suffix('s').unwrap_or(period).trim().parse().ok()?;
            PERIODS.contains(&period).then(|| kind(period))
        });
        found.ok_or_else(|| {
            let known: Vec<String> = named().map(|measure| measure.to_string()).collect();
            format!("found intensity measure `{name}`; expected one of {}, Sa(0.5 s), Sv(0.5 s)", known.join(", "))
        })
    }
}

/// Admissible periods of oscillators (s); others would be typing errors.
pub const PERIODS: std::ops::RangeInclusive<f64> = 0.001..=1000.0;

#[cfg(test)]
pub(super) fn record_of(acceleration: &[f64], dt: f64) -> Record {
    use rocking_records::{ReadOptions, Unit, parse};
    let text: String = acceleration.iter().map(|a| format!("{a:e}\n")).collect();
    let unit = Some(Unit::MetrePerSecondSquared);
    parse("made-up", text.as_bytes(), &ReadOptions { unit, time_step: Some(dt), ..ReadOptions::default() }).unwrap()
}

#[cfg(test)]
#[track_caller]
pub(super) fn near(value: f64, exact: f64, tolerance: f64) {
    assert!((value / exact - 1.0).abs() <= tolerance, "{value}, exactly {exact}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        let of_pairs = [Measure::of_pair(&[0.5]), Measure::of_pair_to_block()].concat();
        let of_records = Measure::of_record(&[0.5, 1.25]).into_iter().chain(Measure::OF_FLOOR).chain(Measure::OF_BLOCK);
        for measure in of_records.chain(of_pairs) {
            assert_eq!(measure.to_string().parse(), Ok(measure));
        }
        let name = Measure::OfPair(ComponentMeasure::PgvToOverturning, OverDirections::RotD100).to_string();
        assert_eq!(name, "p PGV.RotD100/(g tan alpha)");
        for (spelling, measure) in [
            ("pgv", Measure::Pgv),
            ("sa(0.5 S)", Measure::Sa(0.5)),
            ("SA(0.50)", Measure::Sa(0.5)),
            ("Sv(1s)", Measure::Sv(1.0)),
            ("sa(0.5).rotd50", Measure::OfPair(ComponentMeasure::Sa(0.5), OverDirections::RotD50)),
        ] {
            assert_eq!(spelling.parse(), Ok(measure));
        }
        for name in ["PVG", "PGD.RotD50", "PGA.RotD500", "Sa(0,5)", "Sa(s)", "Sa(-1 s)", "Sv(nan s)"] {
            let refused = name.parse::<Measure>().unwrap_err();
            assert!(refused.contains(name) && refused.contains("CAV"), "{refused}");
        }
    }

    /// A factor on the record multiplies each measure by its power of the factor.
    #[test]
    fn measures_scale_with_their_power_of_the_factor() {
        let samples: Vec<f64> =
            (0..3000).map(|i| (0.05 * f64::from(i)).sin() * (0.0011 * f64::from(i)).sin()).collect();
        let record = record_of(&samples, 0.01);
        let weaker = record.clone().scaled(-0.3);
        for measure in Measure::of_record(&[0.5]) {
            let [one, other] = [&record, &weaker].map(|record| measure.of(record, 9.81).unwrap());
            near(other, one * 0.3_f64.powi(measure.power().into()), 1e-12);
        }
    }

    #[test]
    fn a_record_of_zeros_has_no_period_and_no_duration() {
        let none = record_of(&[0.0; 50], 0.01);
        for measure in [Measure::PgvToPga, Measure::SignificantDuration, Measure::MeanPeriod] {
            assert_eq!(measure.of(&none, 9.81), None);
        }
        assert_eq!(Measure::SpectrumIntensity.of(&none, 9.81), Some(0.0));
    }
}
