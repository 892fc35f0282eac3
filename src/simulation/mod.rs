//! The loop: step → locate the first event → apply it there → settle the regime → go on.

mod beginning;
mod flight;
mod motion;
mod placement;
mod report;
mod rigid_base;
mod stepping;
mod transitions;

use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::dynamics::{Footing, State, energy};
use crate::events::{Creep, Event};
use crate::excitation::{Excitation, Inputs, Pulse};
use crate::peaks::Peaks;
use crate::regime::{Corner, Regime};

/// What happens at complete separation, by the numbers of the FMU's `on_separation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum OnSeparation {
    /// The run ends.
    Terminate = 1,
    /// Time goes on with the block frozen.
    Hold = 2,
    /// The block flies, and lands.
    Fly = 3,
}

/// What happens at overturning, by the numbers of the FMU's `on_overturning`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum OnOverturning {
    /// The run ends.
    Terminate = 1,
    /// Time goes on with the block frozen.
    Hold = 2,
}

/// What stays the same when a corner lifts from full contact, where the horizontal constraint changes from the middle of
/// the base to the other corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LiftOff {
    /// θ̇ and v̇, as in the paper: the kinetic energy rises a little.
    #[default]
    KeepRates,
    /// v̇ and the angular momentum about the corner that stands: it falls a little. See docs/lift_off.md.
    KeepMomentum,
}

/// How to run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Relative tolerance of the integrator, 1e-14…1e-1: error allowed in a step, as an equivalent velocity in units of
    /// the rocking velocity α p.
    pub tolerance: f64,
    /// At complete separation.
    pub on_separation: OnSeparation,
    /// At overturning.
    pub on_overturning: OnOverturning,
    /// When a corner lifts from full contact.
    pub lift_off: LiftOff,
}

impl Settings {
    /// The least and the greatest tolerance that is followed; what lies outside is taken as the nearer one.
    pub const TOLERANCES: [f64; 2] = [1e-14, 1e-1];
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            tolerance: 1e-8,
            on_separation: OnSeparation::Terminate,
            on_overturning: OnOverturning::Terminate,
            lift_off: LiftOff::KeepRates,
        }
    }
}

/// Where the block is at the beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Initial {
    /// Rotation θ (rad), positive to the right, |θ| < π/2.
    pub theta: f64,
    /// θ̇ (rad/s).
    pub theta_dot: f64,
    /// `(v, v̇)` of the centre of mass (m, m/s); `None` starts at the vertical equilibrium of `theta`: the supports that
    /// touch carry the weight, and the middle of the base (or the one touching corner) does not move vertically.
    pub vertical: Option<(f64, f64)>,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// The last touching corner lifted from a block that may still come down on its base.
    Separated,
    /// The last touching corner lifted from a block that is on its way over, |θ| ≥ α and θ θ̇ > 0: both separated and
    /// overturned. On supports a block that topples leaves them before it lies on its side.
    Toppled,
    /// The block reached a quarter turn.
    Overturned,
}

impl Ending {
    /// How the run of a block of slenderness α (rad) ends that leaves its last support at the rotation θ (rad) and the
    /// rate θ̇ (rad/s). How often this takes a block for overturned that would have come back is in docs/model.md.
    pub fn at_separation(alpha: f64, theta: f64, theta_dot: f64) -> Ending {
        if theta.abs() >= alpha && theta * theta_dot > 0.0 { Ending::Toppled } else { Ending::Separated }
    }

    /// Whether the block left its supports.
    pub fn is_separation(self) -> bool {
        match self {
            Ending::Separated | Ending::Toppled => true,
            Ending::Overturned => false,
        }
    }

    /// Whether the block overturned or is bound to.
    pub fn is_overturning(self) -> bool {
        match self {
            Ending::Overturned | Ending::Toppled => true,
            Ending::Separated => false,
        }
    }
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Ending::Separated => "complete separation",
            Ending::Toppled => "overturning, with complete separation",
            Ending::Overturned => "overturning",
        })
    }
}

/// How far [`Simulation::advance`] came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// The time that was asked for.
    Reached,
    /// The run ended before, at this time (s).
    Ended(Ending, f64),
}

/// A run that cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The step size fell below what time can resolve.
    #[error("the step size fell to {size:e} s at t = {time} s: the tolerance {tolerance:e} cannot be met there")]
    StepTooSmall {
        /// Time (s).
        time: f64,
        /// Step size (s).
        size: f64,
        /// The tolerance asked for.
        tolerance: f64,
    },
    /// The motion overflowed.
    #[error("the motion is not finite after t = {time} s; ground accelerations or loads are out of all proportion")]
    NotFinite {
        /// Time of the last good state (s).
        time: f64,
    },
    /// The regime changed again and again without time going on.
    #[error("{count} events in the same instant t = {time} s leave no regime that lasts")]
    NoRegime {
        /// Time (s).
        time: f64,
        /// Events so far in that instant.
        count: u32,
    },
}

/// Energy sums since the start, per unit mass (m²/s²).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergySums {
    /// Total energy at the start.
    pub initial: f64,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy that the dashpots took.
    pub dashpots: f64,
    /// Energy that went at changes of regime (negative if some came).
    pub impacts: f64,
    /// Energy that came with changes of the horizontal constraint at lift-off; in `impacts`, with the other sign.
    pub constraint: f64,
}

/// Energies at one time (J), and what became of them since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energies {
    /// Total energy, zero at rest.
    pub total: f64,
    /// Kinetic energy relative to the ground.
    pub kinetic: f64,
    /// Energy of the weight and of the springs that are touched.
    pub potential: f64,
    /// Work of the ground motion and the loads.
    pub input: f64,
    /// Energy that the dashpots took.
    pub dashpots: f64,
    /// Energy that went at changes of regime (negative if some came).
    pub impacts: f64,
    /// Energy that came with changes of the horizontal constraint at lift-off; in `impacts`, with the other sign.
    pub constraint: f64,
    /// What the sum misses: `total − initial − input + dashpots + impacts`, round-off and integration error.
    pub residual: f64,
}

/// Counters since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Landings to which the impact map (or e, on the rigid base) was applied.
    pub impacts: u32,
    /// Corners that lifted.
    pub liftoffs: u32,
    /// Steps of the integrator that were accepted.
    pub steps: u64,
    /// Steps that were repeated with a smaller size.
    pub rejected: u64,
    /// Evaluations of the equations of motion, dense output and restarts included.
    pub evaluations: u64,
}

/// A block in motion. A plain value: a copy goes on exactly as the original does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    block: Block,
    settings: Settings,
    pulse: Pulse,
    time: f64,
    regime: Regime,
    state: State,
    footing: Footing<f64>,
    creep: [Creep; 2],
    held: Option<Corner>,
    step_size: f64,
    short_size: f64,
    ending: Option<(Ending, f64)>,
    sums: EnergySums,
    peaks: Peaks,
    counts: Counts,
    last_event: f64,
    events_in_this_instant: u32,
}

impl Simulation {
    /// A block at its beginning at `time`, with the excitation of that time.
    ///
    /// A support that nothing touches stands at its free height.
    pub fn new(
        block: Block,
        settings: Settings,
        pulse: Pulse,
        initial: &Initial,
        time: f64,
        inputs: &Inputs,
    ) -> Simulation {
        let [least, most] = Settings::TOLERANCES;
        let mut simulation = Simulation {
            block,
            settings: Settings { tolerance: settings.tolerance.clamp(least, most), ..settings },
            pulse,
            time,
            regime: Regime::FullContact,
            state: State::zeros(),
            footing: Footing::AT_START,
            creep: [Creep { depth: 0.0, since: time }; 2],
            held: None,
            step_size: f64::INFINITY,
            short_size: f64::INFINITY,
            ending: None,
            sums: EnergySums::default(),
            peaks: Peaks::default(),
            counts: Counts::default(),
            last_event: time,
            events_in_this_instant: 0,
        };
        let excitation = Excitation::from_time(time, inputs, &simulation.pulse, &block);
        match block.foundation {
            Foundation::Viscoelastic => simulation.place_on_supports(initial, &excitation),
            Foundation::Rigid => simulation.place_on_rigid_base(initial),
        }
        let start = simulation.point(&excitation);
        let (kinetic, potential) = energy(&block, simulation.regime, &start.instant);
        simulation.sums = EnergySums { initial: kinetic + potential, ..EnergySums::default() };
        let shown = simulation.released(&start, &excitation);
        let shown = shown.as_ref().unwrap_or(&simulation);
        let start = shown.point_at(time, shown.state, &excitation);
        let first = shown.peak_samples(&start, &excitation);
        simulation.peaks.include(&first);
        simulation.counts = Counts::default();
        simulation
    }

    /// Goes on to `until` (s), which is not before the present time, under inputs that are linear in time, and tells
    /// `observer` each event as it happens.
    ///
    /// Stops at the end of the run if that comes first; from then on it goes no further, or, where the end is held,
    /// only time does. No memory is allocated. On an error the state is that of the last good step.
    pub fn advance(
        &mut self,
        until: f64,
        inputs: &Inputs,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Progress, SimulationError> {
        while self.time < until && self.ending.is_none() {
            let stop = self.pulse.next_kink(self.time).map_or(until, |kink| kink.min(until));
            let excitation = Excitation::from_time(self.time, inputs, &self.pulse, &self.block);
            self.smooth_piece(stop, &excitation, observer)?;
        }
        match self.ending {
            Some((ending, time)) if !self.is_frozen() => Ok(Progress::Ended(ending, time)),
            _ => {
                self.time = until;
                Ok(Progress::Reached)
            }
        }
    }

    /// Whether the numbers of a state that came from outside can be gone on from: all finite, and the tolerance one that
    /// is followed. The block is checked by whoever knows what it was made from.
    pub fn is_valid(&self) -> bool {
        let Simulation {
            settings, pulse, time, state, footing, creep, step_size, short_size, sums, last_event, ..
        } = self;
        let creep = creep.iter().flat_map(|creep| [creep.depth, creep.since]);
        let sums = [sums.initial, sums.input, sums.dashpots, sums.impacts, sums.constraint];
        let others = [*time, *last_event, pulse.amplitude, pulse.period, pulse.start];
        let [least, most] = Settings::TOLERANCES;
        (least..=most).contains(&settings.tolerance)
            && *step_size > 0.0
            && *short_size > 0.0
            && pulse.period > 0.0
            && footing.is_finite()
            && state.iter().copied().chain(creep).chain(sums).chain(others).all(f64::is_finite)
    }

    /// Sets the clock without any motion, to take up the rounding of a master's clock.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Present time (s).
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Present state `[θ, θ̇, w, ẇ]`; what w is depends on the regime, see [`crate::dynamics`].
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Present regime. Under inputs that have just changed, a block on the rigid base may lift in this very instant:
    /// [`Simulation::observe`] shows it as it goes on.
    pub fn regime(&self) -> Regime {
        self.regime
    }

    /// The block.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// Why and when the run ended, if it did.
    pub fn ending(&self) -> Option<(Ending, f64)> {
        self.ending
    }

    /// Counters since the start.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Greatest values since the start, as of the present time.
    pub fn peaks(&self) -> Peaks {
        self.peaks
    }

    /// Time of the last event (s); the start if there was none.
    pub fn last_event(&self) -> f64 {
        self.last_event
    }
}
