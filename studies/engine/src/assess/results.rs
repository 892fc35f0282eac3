//! The numbers of a report, in SI units.

use serde::Serialize;

use crate::assess::alternatives::Assumption;
use crate::assess::plan::Input;
use crate::fragility::{Direction, Interval, Limit, RowCounts};
use rocking_block::block::Ratios;

/// The report on an object.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name of the object.
    pub title: String,
    /// Who answers for the study.
    pub author: Option<String>,
    /// Date of the study.
    pub date: Option<String>,
    /// The study file.
    pub study: String,
    /// The object in the middle of the study.
    pub object: ObjectResult,
    /// The building in which it stands, if any.
    pub building: Option<BuildingResult>,
    /// The ground motions.
    pub motions: Vec<MotionResult>,
    /// Number of these that also act reversed.
    pub reversed: usize,
    /// Number of blocks under each ground motion.
    pub blocks: u64,
    /// Description of the strengths.
    pub strengths: Vec<String>,
    /// Number of runs of the study.
    pub runs: u64,
    /// Intensity measure of the curves, with its unit.
    pub im: String,
    /// Shape of the pulses.
    pub pulse: String,
    /// The least pulses that overturn the object.
    pub pulses: Vec<LeastPulse>,
    /// Blocks of the object's shape under all ground motions; none in space.
    pub sizes: Vec<SizeResult>,
    /// Measure or factor to which the ground motions of `sizes` are scaled.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub sizes_strength: String,
    /// The runs by the direction of the ground motion, in a study with azimuths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub directions: Vec<Direction>,
    /// Curves of the states.
    pub states: Vec<StateResult>,
    /// Confidence level of all intervals.
    pub confidence: f64,
    /// Method of the intervals.
    pub intervals: Option<String>,
    /// The hazard curve, if any.
    pub hazard: Option<HazardResult>,
    /// Years of the probabilities.
    pub years: f64,
    /// Position in `states` of the limit of variants, friction and sensitivity.
    pub compared_state: usize,
    /// The object as it is, then its variants.
    pub variants: Vec<Comparison>,
    /// The results for these blocks with limited friction.
    pub sliding: Vec<SlidingResult>,
    /// Quantities at both ends of their ranges.
    pub sensitivity: Vec<Sensitivity>,
    /// Remarks on results that are missing or extrapolated.
    pub remarks: Vec<String>,
    /// The files that were read.
    pub inputs: Vec<Input>,
}

/// The object.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectResult {
    /// Word of the foundation.
    pub foundation: &'static str,
    /// Width of the base (m).
    pub width: f64,
    /// Height of the centre of mass (m).
    pub center_height: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Slenderness α (rad), in space that of the balance over the nearest edge.
    pub alpha: f64,
    /// Least and greatest α of the study (rad).
    pub alpha_range: [f64; 2],
    /// Frequency parameter p (rad/s).
    pub p: f64,
    /// Least and greatest p of the study (rad/s).
    pub p_range: [f64; 2],
    /// Distance R0 from the centre of mass to a corner (m).
    #[serde(rename = "R0")]
    pub r0: f64,
    /// Gravitational acceleration (m/s²).
    pub g: f64,
    /// Coefficient of friction; infinite, null in JSON, without a limit.
    pub friction: f64,
    /// Least and greatest coefficient of the study.
    pub friction_range: [f64; 2],
    /// Distance of the centre of mass from the middle of the base along x (m).
    pub eccentricity: f64,
    /// What only a block in the plane, or only one in space, has.
    #[serde(flatten)]
    pub body: BodyResult,
    /// Whether a parameter is a list of an even number of values, so that the upper of its two middle values was taken.
    pub is_beside_the_middle: bool,
    /// Horizontal acceleration (m/s²) that slowly lifts a corner of the block, in space an edge. `None` for a block with ties.
    pub static_threshold: Option<f64>,
}

/// What only a block in the plane, or only one in space, has.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum BodyResult {
    /// In the plane.
    Plane(PlaneResult),
    /// In space.
    Space(Box<SpaceResult>),
}

/// A block in the plane.
#[derive(Clone, Debug, Serialize)]
pub struct PlaneResult {
    /// Shape factor γ (1).
    pub gamma: f64,
    /// Restitution ε of the landing corner (1).
    pub epsilon: f64,
    /// Of supports only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supports: Option<SupportsResult>,
    /// Restitution e of a rigid base only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub e: Option<f64>,
    /// Number of ties.
    pub ties: usize,
    /// Number of dampers.
    pub dampers: usize,
}

/// A block in space.
#[derive(Clone, Debug, Serialize)]
pub struct SpaceResult {
    /// Shape of the base: `rectangle`, `circle` or `list`.
    pub base: &'static str,
    /// Distance between the feet along y (m).
    pub depth: f64,
    /// Number of feet.
    pub feet: usize,
    /// Distance of the centre of mass from the middle of the base along y (m).
    pub eccentricity_y: f64,
    /// I_xx, I_yy, I_zz, I_xy, I_xz, I_yz about the centre of mass (kg.m²).
    pub inertia: [f64; 6],
    /// Circular frequency ω_v on all feet (rad/s).
    pub omega_v: f64,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: f64,
    /// Stiffness ratio κ (1).
    pub kappa: f64,
    /// Horizontal damping ratio ξ_h (1).
    pub xi_h: f64,
    /// Stiffness of each foot (N/m).
    #[serde(rename = "K")]
    pub stiffness: f64,
    /// Damping of each foot (N.s/m).
    #[serde(rename = "C")]
    pub damping: f64,
    /// Static deflection (m).
    pub delta_s: f64,
}

/// Viscoelastic supports.
#[derive(Clone, Debug, Serialize)]
pub struct SupportsResult {
    /// Stiffness of each (N/m).
    #[serde(rename = "K")]
    pub stiffness: f64,
    /// Damping of each (N.s/m).
    #[serde(rename = "C")]
    pub damping: f64,
    /// The same in the paper's ratios.
    #[serde(flatten)]
    pub ratios: Ratios,
    /// Static deflection (m).
    pub delta_s: f64,
}

/// An elastic building.
#[derive(Clone, Debug, Serialize)]
pub struct BuildingResult {
    /// Number of its floors.
    pub floors: usize,
    /// Floors on which the blocks stand; 0 is the ground.
    pub stands_on: Vec<usize>,
    /// Natural periods of its modes (s), the longest first.
    pub periods: Vec<f64>,
    /// Damping ratios of the modes (1).
    pub damping: Vec<f64>,
    /// Least PGA (m/s²) at which the peak acceleration of a floor meets the static threshold.
    pub least_pga: Option<f64>,
}

/// A ground motion, unscaled.
#[derive(Clone, Debug, Serialize)]
pub struct MotionResult {
    /// Its name.
    pub name: String,
    /// The event and the station, as far as they are known: components, polarities and floors of one are not independent.
    pub motion: String,
    /// The azimuth of its first component (degrees), of an object in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<f64>,
    /// m/s².
    #[serde(rename = "PGA")]
    pub pga: Option<f64>,
    /// m/s.
    #[serde(rename = "PGV")]
    pub pgv: Option<f64>,
    /// Peak acceleration of the floor (m/s²), in a building.
    #[serde(rename = "PFA", skip_serializing_if = "Option::is_none")]
    pub pfa: Option<f64>,
    /// Peak velocity of the floor (m/s), in a building.
    #[serde(rename = "PFV", skip_serializing_if = "Option::is_none")]
    pub pfv: Option<f64>,
    /// Least and greatest factor on it, for the object.
    pub scales: [f64; 2],
}

/// The least pulse of a period that overturns the object.
#[derive(Clone, Debug, Serialize)]
pub struct LeastPulse {
    /// T_p (s).
    pub period: f64,
    /// The floor on which the object stands, in a building whose ground has the pulse.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<usize>,
    /// The azimuth of the pulse (degrees), of an object in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<f64>,
    /// Least amplitude a_p (m/s²) of the ground; `None` if none overturns it.
    pub amplitude: Option<f64>,
    /// `none`; or `upper` or `lower`, if the range of the search only bounds the value.
    pub bound: &'static str,
    /// Greatest amplitude of the search (m/s²).
    pub greatest: f64,
}

/// Blocks of one size under all ground motions.
#[derive(Clone, Debug, Serialize)]
pub struct SizeResult {
    /// Frequency parameter (rad/s).
    pub p: f64,
    /// Blocks that rock and stand.
    pub rocked: u64,
    /// Blocks that do not rock.
    pub at_rest: u64,
    /// Blocks that overturn.
    pub overturned: u64,
    /// Other outcomes.
    pub undecided: u64,
    /// Geometric mean of the peaks |θ|/α of those that rock and stand.
    pub geometric_mean: Option<f64>,
}

/// Runs relative to a limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// Runs whose outcome is known.
    pub known: usize,
    /// Number of runs that exceed the limit.
    pub exceeded: usize,
    /// Runs that failed, separated before the limit, or are undecided.
    pub left_out: usize,
}

impl From<RowCounts> for Counts {
    /// The counts of single runs.
    fn from(rows: RowCounts) -> Counts {
        Counts { known: rows.decided, exceeded: rows.exceeded as usize, left_out: rows.all - rows.decided }
    }
}

impl Counts {
    /// Runs that exceed the limit if all those without a known outcome do.
    pub fn at_most(&self) -> usize {
        self.exceeded + self.left_out
    }

    /// All runs.
    pub fn all(&self) -> usize {
        self.known + self.left_out
    }
}

/// A lognormal fragility curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurveResult {
    /// Median, in the unit of the measure.
    pub median: f64,
    /// Its interval; an end without a bound is `None`.
    pub median_interval: Interval,
    /// Dispersion β (1).
    pub beta: f64,
    /// Its interval.
    pub beta_interval: Interval,
    /// Area under the receiver operating characteristic (1).
    #[serde(rename = "AUC")]
    pub auc: f64,
}

/// A state: its limit, curve and annual rate.
#[derive(Clone, Debug, Serialize)]
pub struct StateResult {
    /// Its name.
    pub name: String,
    /// The limit.
    pub limit: Limit,
    /// The publication or decision behind it.
    pub source: Option<String>,
    /// The runs, relative to the limit.
    pub runs: Counts,
    /// The curve.
    pub curve: Option<CurveResult>,
    /// The reason why there is no curve.
    pub no_curve: Option<String>,
    /// The annual rate, with a hazard curve.
    pub rate: Option<RateResult>,
    /// The greatest measure up to which no run exceeds the limit, and the least one from which on all do, in the unit of the measure.
    pub separate_at: [Option<f64>; 2],
}

/// An annual rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RateResult {
    /// 1/year.
    pub rate: f64,
    /// Its interval (1/year).
    pub rate_interval: Interval,
    /// The rates (1/year) if none, and if all, of the runs without a known outcome exceed the limit, which are left out otherwise. An end
    /// is `None` where the runs have no curve then, and all is where every outcome is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_of_unknown: Option<Interval>,
    /// Probability in the years of the report.
    pub probability: f64,
    /// Fraction of the rate from measures below the runs (1).
    pub below_runs: f64,
    /// Fraction from measures above the runs (1).
    pub above_runs: f64,
    /// Fraction from outside the hazard curve (1).
    pub outside_hazard: f64,
}

/// A hazard curve.
#[derive(Clone, Debug, Serialize)]
pub struct HazardResult {
    /// The file.
    pub file: String,
    /// Number of levels.
    pub levels: usize,
    /// Least and greatest level, in the unit of the measure.
    pub range: [f64; 2],
}

/// A variant of the object, relative to one limit.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Its name.
    pub name: String,
    /// Slenderness α (rad), in space that of the balance over the nearest edge.
    pub alpha: f64,
    /// m/s²; `None` for a block with ties.
    pub static_threshold: Option<f64>,
    /// Coefficient of friction; infinite, null in JSON, without a limit.
    pub friction: f64,
    /// The limit. It is that of the compared state, or the balance of blocks with ties.
    pub limit: Limit,
    /// The runs, relative to the limit.
    pub runs: Counts,
    /// The curve.
    pub curve: Option<CurveResult>,
    /// The reason why there is no curve.
    pub no_curve: Option<String>,
    /// Annual rate (1/year).
    pub rate: Option<f64>,
    /// See [`RateResult::rate_of_unknown`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_of_unknown: Option<Interval>,
    /// See [`StateResult::separate_at`].
    pub separate_at: [Option<f64>; 2],
    /// Greatest slip (m), with limited friction.
    pub peak_slip: Option<f64>,
    /// Greatest tension of a tie over the weight, with ties.
    pub peak_tension: Option<f64>,
    /// Greatest force of a damper over the weight, with dampers.
    pub peak_damper_force: Option<f64>,
    /// Least horizontal distance from the block to the anchor of a tie (m), with ties.
    pub anchor_distance: Option<f64>,
    /// Runs in which a tie broke, with ties that can.
    pub runs_with_broken_ties: Option<usize>,
}

/// The blocks of the study with a coefficient of friction.
#[derive(Clone, Debug, Serialize)]
pub struct SlidingResult {
    /// Coefficient of friction; infinite, null in JSON, without a limit.
    pub friction: f64,
    /// The runs, relative to the limit.
    pub runs: Counts,
    /// Runs that slide more than 1 mm.
    pub slid: usize,
    /// Median slip of all runs (m).
    pub median_slip: f64,
    /// Greatest slip of all runs (m).
    pub greatest_slip: f64,
}

/// A quantity at both ends of its range.
#[derive(Clone, Debug, Serialize)]
pub struct Sensitivity {
    /// The quantity.
    #[serde(flatten)]
    pub assumption: Assumption,
    /// The runs at both ends.
    pub ends: [Comparison; 2],
}
