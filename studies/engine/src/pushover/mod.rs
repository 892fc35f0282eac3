//! A block → its moment over a slow rotation with its landmarks, and a cycle.
//!
//! A lateral force F at the centre of mass turns the block about its foot: the standing corner, or the middle of the base. Supports, ties
//! and dampers follow their laws at rest, so that dashpots do nothing.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`statics`] | a rotation and the states of restraints → the equilibrium |
//! | `walk` | a path of rotations → equilibria through all events |
//! | [`table`] | equilibria → a table |

pub mod statics;

pub mod table;

mod walk;

use std::f64::consts::FRAC_PI_2;

use rocking_block::block::restraints::{self, LinkKind, RestraintEvent};
use rocking_block::block::{Block, Corner};
use statics::Equilibrium;
use walk::{ROUNDING, Walk};

/// A slow rotation of a block.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Rotation"))]
pub struct Push {
    /// Side to which the lateral force turns the block
    #[cfg_attr(feature = "clap", arg(long = "side", value_name = "SIDE", value_parser = sides(), default_value = "right"))]
    pub over: Corner,
    /// Greatest rotation; by default that at which the centre of mass stands over the corner. The curve ends before it where the
    /// force vanishes [rad]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD"))]
    pub to: Option<f64>,
    /// Also turn the block to and fro by this amplitude: energy, equivalent damping, recentring ratio and residual rotation [rad]
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD"))]
    pub amplitude: Option<f64>,
    /// Number of equal steps to the greatest rotation, and to the amplitude; landmarks stand between them, at their rotations
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_POINTS)))
    )]
    pub points: u32,
}

/// The words of sides as options, with a line of help for each.
#[cfg(feature = "clap")]
fn sides() -> impl clap::builder::TypedValueParser<Value = Corner> {
    crate::spec::choice(&[(Corner::Left, "Over the left corner"), (Corner::Right, "Over the right corner")])
}

/// The reason why a block has no curve.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PushoverError(String);

impl PushoverError {
    /// The vertical forces have no stable balance at a rotation (rad).
    fn no_equilibrium(theta: f64) -> PushoverError {
        PushoverError(format!(
            "theta = {theta} rad: supports, weight, ties and dampers do not balance; expected softer ties or stiffer supports"
        ))
    }
}

/// Greatest number of steps.
pub const MAX_POINTS: u32 = 100_000;

/// What happens at a landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LandmarkKind {
    /// No lateral force yet.
    AtRest,
    /// This corner lifts: decompression.
    LiftOff(Corner),
    /// This corner lands.
    Landing(Corner),
    /// A tie or damper becomes taut or slack, yields, unloads or breaks.
    Restraint(RestraintEvent),
    /// A greatest lateral force.
    Peak,
    /// The lateral force vanishes: from here on the block overturns by itself.
    Balance,
    /// The last corner lifts.
    Separation,
    /// The foot slides, so that the lateral force turns the block no further.
    Slides,
    /// The greatest rotation, to which a lateral force still holds the block.
    End,
}

impl std::fmt::Display for LandmarkKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |corner: &Corner| match corner {
            Corner::Left => "L",
            Corner::Right => "R",
        };
        match self {
            LandmarkKind::AtRest => f.write_str("at rest"),
            LandmarkKind::LiftOff(corner) => write!(f, "{} lifts", name(corner)),
            LandmarkKind::Landing(corner) => write!(f, "{} lands", name(corner)),
            LandmarkKind::Restraint(event) => event.fmt(f),
            LandmarkKind::Peak => f.write_str("greatest force"),
            LandmarkKind::Balance => f.write_str("balance"),
            LandmarkKind::Separation => f.write_str("leaves the ground"),
            LandmarkKind::Slides => f.write_str("slides"),
            LandmarkKind::End => f.write_str("end"),
        }
    }
}

/// A named point of a curve.
#[derive(Clone, Copy, Debug)]
pub struct Landmark {
    /// What happens.
    pub kind: LandmarkKind,
    /// The equilibrium there.
    pub at: Equilibrium,
}

/// The curve of a slow rotation, with its landmarks.
#[derive(Clone, Debug)]
pub struct Pushover {
    /// Equilibria in the order of the path; two at one rotation where forces jump.
    pub rows: Vec<Equilibrium>,
    /// Its landmarks, in the same order.
    pub landmarks: Vec<Landmark>,
    /// The cycles, if asked for.
    pub cycle: Option<Cycle>,
}

/// A closed cycle of rotations between ±amplitude, after a first one.
#[derive(Clone, Debug)]
pub struct Cycle {
    /// Amplitude (rad).
    pub amplitude: f64,
    /// Equilibria of the first rotation to the amplitude and of the closed cycle after it. They are in the order of the path.
    pub rows: Vec<Equilibrium>,
    /// Energy lost by yielding in the closed cycle (J), by the numbers of the restraints.
    pub lost: [f64; restraints::MAX],
    /// That before the closed cycle (J).
    pub lost_before: [f64; restraints::MAX],
    /// Equivalent viscous damping ratio ξ_eq of yielding alone (1): `E_D/(2π M_A A)`. E_D is the energy lost in a cycle of amplitude A, and
    /// M_A the mean of the moments at its two ends.
    ///
    /// L. S. Jacobsen, "Steady forced vibration as influenced by damping", Transactions of the ASME 52 (1930) 169–181. Landings take
    /// energy beside it. NaN where the moments do not resist the rotation.
    pub equivalent_damping: f64,
    /// Recentring ratio λ at the amplitude (1). It is the moment of weight, supports and ties over that of the dampers. Infinite without
    /// dampers.
    ///
    /// With λ above 1 a lifted corner lands again; on supports a rotation in full contact may remain. NZS 3101:2006, appendix B, asks for at
    /// least the overstrength of the dampers, 1.15 or more.
    pub recentring: f64,
    /// Greatest rotation left when the lateral force is taken away slowly after the amplitude (rad).
    pub residual: f64,
}

impl Pushover {
    /// Turns a block slowly over a corner, then in cycles.
    ///
    /// # Errors
    /// A rotation or a number of steps out of range; a block whose vertical forces do not balance, or which does not reach the amplitude.
    pub fn of(block: &Block, push: &Push) -> Result<Pushover, PushoverError> {
        let Push { over, to, amplitude, points } = *push;
        for (name, value) in [("to", to), ("amplitude", amplitude)] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && *value < FRAC_PI_2)) {
                let message = format!("{name} = {value} rad; expected a rotation above 0 and below pi/2 rad");
                return Err(PushoverError(message));
            }
        }
        if !(1..=MAX_POINTS).contains(&points) {
            return Err(PushoverError(format!("points = {points}; expected 1 to {MAX_POINTS} steps")));
        }
        let sign = -over.sign();
        let end = to.unwrap_or_else(|| block.alpha_of(over));
        let (mut rows, mut landmarks) = (Vec::new(), Vec::new());
        let mut walk = Walk::new(block, sign, true, &mut rows, &mut landmarks)?;
        if walk.to(sign * end, end / f64::from(points))? {
            walk.end();
        }
        let peak =
            (rows.iter().enumerate()).max_by(|(_, one), (_, other)| one.force.abs().total_cmp(&other.force.abs()));
        // A curve that still rises at its end has no peak.
        if let Some((_, &at)) = peak.filter(|(row, _)| row + 1 < rows.len()) {
            let passed = landmarks.iter().take_while(|landmark| landmark.at.theta.abs() <= at.theta.abs()).count();
            landmarks.insert(passed, Landmark { kind: LandmarkKind::Peak, at });
        }
        let cycle = amplitude.map(|amplitude| Cycle::of(block, sign, amplitude, points)).transpose()?;
        Ok(Pushover { rows, landmarks, cycle })
    }
}

impl Cycle {
    fn of(block: &Block, sign: f64, amplitude: f64, points: u32) -> Result<Cycle, PushoverError> {
        let (mut rows, mut landmarks) = (Vec::new(), Vec::new());
        let step = amplitude / f64::from(points);
        let mut walk = Walk::new(block, sign, false, &mut rows, &mut landmarks)?;
        let mut lost_before = [0.0; restraints::MAX];
        let mut ends = Vec::new();
        // The first cycle ends where the second, closed one begins.
        for turn in [1.0, -1.0, 1.0, -1.0, 1.0] {
            if ends.len() == 3 {
                lost_before = walk.lost;
            }
            if !walk.to(turn * sign * amplitude, step)? {
                return Err(PushoverError(format!(
                    "cycles of {amplitude} rad end at theta = {} rad, where the block {}; expected a smaller amplitude",
                    walk.at.theta,
                    walk.reason()
                )));
            }
            ends.push(walk.rows.len());
        }
        let after = walk.lost;
        let lost = std::array::from_fn(|number| after[number] - lost_before[number]);
        let (first, closed) = (&rows[..ends[0]], &rows[ends[2] - 1..]);
        let turning = ends[3] - ends[2];
        let (forth, back) = closed.split_at(turning + 1);
        let last = closed[closed.len() - 1];
        let mean = 0.5 * sign * (last.moment - forth[turning].moment);
        let energy: f64 = lost.iter().sum();
        let dampers: f64 = (block.ties().iter().zip(last.resisting))
            .filter(|(link, _)| link.kind == LinkKind::Damper)
            .map(|(_, moment)| moment)
            .sum();
        let residual = residual(forth, sign).max(residual(&[&forth[turning..], back].concat(), -sign));
        Ok(Cycle {
            amplitude,
            lost,
            lost_before,
            equivalent_damping: if mean > 0.0 { energy / (std::f64::consts::TAU * mean * amplitude) } else { f64::NAN },
            recentring: (last.moment - dampers) / dampers,
            residual,
            rows: [first, &closed[1..]].concat(),
        })
    }
}

/// Returns the rotation (rad) at which the lateral force vanishes after an amplitude. The block comes from this side through the upright
/// position.
fn residual(rows: &[Equilibrium], side: f64) -> f64 {
    let crossing = rows.windows(2).find(|pair| pair[1].force * side <= 0.0);
    crossing.map_or(0.0, |pair| {
        let [from, to] = [pair[0], pair[1]];
        let fraction = from.force / (from.force - to.force);
        let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 1.0 };
        let left = (from.theta + fraction * (to.theta - from.theta)) * side;
        if left > ROUNDING * rows[0].theta.abs() { left } else { 0.0 }
    })
}
