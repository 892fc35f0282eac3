//! The samples of a step at both ends → the greatest values since the start, also between the ends.

use serde::{Deserialize, Serialize};

use crate::numerics::dual::Dual;
use crate::numerics::roots::rate_of_peak;
use crate::numerics::scalar::Elementary;
use crate::space::body::SpaceBody;
use crate::space::events::SpaceFunction;
use crate::space::motion::{BodyMotion, FEET_FROM, Lean, slip_of};
use crate::space::outputs::{Attitude, FootObservation, SpaceObservation, drift};

/// The greatest values since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpacePeaks {
    /// Square of the sine of half the tilt.
    pub half_tilt_square: f64,
    /// Tilt over the critical one in the direction of the lean (1).
    pub tilt_over_critical: f64,
    /// Square of the twist about the vertical (rad²).
    pub twist_square: f64,
    /// Square of the distance of the base's middle from its place at rest (m²).
    pub drift_square: f64,
    /// N of any foot (N).
    pub normal: f64,
    /// Height of any foot over its support (m).
    pub uplift: f64,
    /// Length of the slip of any foot (m).
    pub slip: f64,
}

/// Rates of the greatest values. Each is zero unless the present value is the greatest and grows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpacePeakRates {
    /// Of the tilt (rad/s).
    pub tilt: f64,
    /// Of the twist (rad/s).
    pub twist: f64,
    /// Of the distance of the base's middle from its place at rest (m/s).
    pub drift: f64,
    /// Of N of any foot (N/s).
    pub normal: f64,
    /// Of the height of any foot over its support (m/s).
    pub uplift: f64,
    /// Of the length of the slip of any foot (m/s).
    pub slip: f64,
}

/// Quantities of the body's motion with a peak. Squares have the same bits in a mirrored motion.
pub(super) const OF_MOTION: usize = 3;

/// The place among them of the square of the sine of half the tilt.
pub(super) const HALF_TILT: usize = 0;

/// Returns the quantities of [`OF_MOTION`], with their rates.
#[inline]
pub(super) fn of_motion(body: &SpaceBody, motion: &BodyMotion<Dual>) -> [Dual; OF_MOTION] {
    let twist = Attitude::twist_of(&motion.turn);
    let [x, y] = drift(body, motion);
    [motion.turn.half_tilt_square(), twist * twist, x * x + y * y]
}

impl SpacePeaks {
    /// The values at the start of a run.
    pub(super) fn at_start(body: &SpaceBody, state: &[f64]) -> SpacePeaks {
        let still: [Dual; FEET_FROM] = std::array::from_fn(|i| Dual::from(state[i]));
        let motion = BodyMotion::of(&still);
        let mut peaks = SpacePeaks::default();
        peaks.include_motion(body, &of_motion(body, &motion), &motion.turn.lean());
        peaks
    }

    /// Includes the quantities of the motion at an instant.
    pub(super) fn include_motion(&mut self, body: &SpaceBody, of_motion: &[Dual; OF_MOTION], lean: &Lean<Dual>) {
        for (i, quantity) in of_motion.iter().enumerate() {
            let peak = self.of_motion_mut(i);
            *peak = peak.max(quantity.re);
        }
        self.tilt_over_critical = self.tilt_over_critical.max(body.tilt_over_critical(lean).re);
    }

    /// Returns the square of the sine of half a tilt that exceeds [`tilt_over_critical`](SpacePeaks::tilt_over_critical) in no direction.
    ///
    /// No critical tilt is less than that over the nearest edge. `x − x³/6` bounds the sine from below.
    #[inline]
    pub(super) fn harmless_half_tilt_square(&self, body: &SpaceBody) -> f64 {
        let half = 0.5 * self.tilt_over_critical * body.edge_angle;
        let sine = half * (1.0 - half * half * (1.0 / 6.0)).max(0.0);
        sine * sine
    }

    /// Returns a ratio of the tangents of the tilt and of the critical tilt without any tilt over the critical one above the greatest yet.
    ///
    /// `tan θ > θ`, and the critical tilt exceeds `3 τ/(3 + τ²)` with its tangent τ, which is at most that over a corner.
    pub(super) fn harmless_tangent_ratio(&self, body: &SpaceBody) -> f64 {
        self.tilt_over_critical * 3.0 / (3.0 + body.corner_slope * body.corner_slope)
    }

    /// Returns the peak of a quantity of the motion.
    pub(super) fn of_motion_mut(&mut self, quantity: usize) -> &mut f64 {
        match quantity {
            HALF_TILT => &mut self.half_tilt_square,
            1 => &mut self.twist_square,
            _ => &mut self.drift_square,
        }
    }

    /// Returns the peak of a watched function, if it has one.
    pub(super) fn of_function_mut(&mut self, function: SpaceFunction) -> Option<&mut f64> {
        match function {
            SpaceFunction::LiftOff(_) => Some(&mut self.normal),
            SpaceFunction::Landing(_) => Some(&mut self.uplift),
            SpaceFunction::Slides(_) | SpaceFunction::Sticks(_) | SpaceFunction::Overturning => None,
        }
    }

    /// Includes N and the uplift of all feet.
    pub(super) fn include_feet(&mut self, feet: &[FootObservation]) {
        for foot in feet {
            self.normal = self.normal.max(foot.normal);
            self.uplift = self.uplift.max(foot.uplift);
        }
    }

    /// Includes the slips of all feet, which never become shorter.
    pub(super) fn include_slips(&mut self, state: &[f64], feet: usize) {
        for foot in 0..feet {
            self.slip = self.slip.max(state[slip_of(foot, feet)]);
        }
    }

    /// Returns the rates of the greatest values at an instant.
    pub fn rates(&self, now: &SpaceObservation<Dual>) -> SpacePeakRates {
        let of_feet = |peak: f64, of: fn(&FootObservation<Dual>) -> Dual| {
            now.feet.iter().map(|foot| rate_of_peak(peak, of(foot))).fold(0.0, f64::max)
        };
        let [x, y] = now.drift;
        SpacePeakRates {
            tilt: rate_of_peak(self.tilt(), now.attitude.tilt),
            twist: rate_of_peak(self.twist(), now.attitude.twist.abs()),
            drift: rate_of_peak(self.drift(), x.hypot(y)),
            normal: of_feet(self.normal, |foot| foot.normal),
            uplift: of_feet(self.uplift, |foot| foot.uplift),
            slip: of_feet(self.slip, |foot| foot.slip),
        }
    }

    /// Returns the greatest tilt (rad).
    pub fn tilt(&self) -> f64 {
        2.0 * libm::asin(self.half_tilt_square.sqrt().min(1.0))
    }

    /// Returns the greatest twist about the vertical, of either sign (rad).
    pub fn twist(&self) -> f64 {
        self.twist_square.sqrt()
    }

    /// Returns the greatest distance of the base's middle from its place at rest (m).
    pub fn drift(&self) -> f64 {
        self.drift_square.sqrt()
    }

    /// Whether all are finite and none is negative.
    pub fn is_valid(&self) -> bool {
        let SpacePeaks { half_tilt_square, tilt_over_critical, twist_square, drift_square, normal, uplift, slip } =
            *self;
        [half_tilt_square, tilt_over_critical, twist_square, drift_square, normal, uplift, slip]
            .iter()
            .all(|peak| peak.is_finite() && *peak >= 0.0)
    }
}
