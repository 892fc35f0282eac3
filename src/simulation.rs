//! The loop: step → locate the first event → apply it there → settle the regime → go on.

use num_dual::Dual64;
use serde::{Deserialize, Serialize};

use crate::block::{Block, Foundation};
use crate::dynamics::{Flight, Instant, State, energy, instant};
use crate::events::{Creep, Event, EventKind, Moment, Surface, gap_opening, reaction_rate, surfaces};
use crate::excitation::{Excitation, Forcing, Inputs, Pulse};
use crate::impact;
use crate::integrator::{DenseOutput, EVALUATIONS_PER_STEP, Rate, Step};
use crate::outputs::{Observation, View, observe};
use crate::peaks::{self, PeakSamples, Peaks};
use crate::regime::{Corner, Regime};
use crate::roots;

/// What happens at complete separation or overturning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AtEnd {
    /// The run ends.
    Terminate,
    /// Time goes on with the block frozen.
    Hold,
}

/// How to run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Relative tolerance of the integrator, 1e-14…1e-1: error allowed in a step, as an equivalent velocity in units of
    /// the rocking velocity α p.
    pub tolerance: f64,
    /// At complete separation.
    pub on_separation: AtEnd,
    /// At overturning.
    pub on_overturning: AtEnd,
}

impl Settings {
    /// The least and the greatest tolerance that is followed; what lies outside is taken as the nearer one.
    pub const TOLERANCES: [f64; 2] = [1e-14, 1e-1];
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { tolerance: 1e-8, on_separation: AtEnd::Terminate, on_overturning: AtEnd::Terminate }
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
    /// The last touching corner lifted.
    Separated,
    /// The block reached a quarter turn.
    Overturned,
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Ending::Separated => "complete separation",
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
}

/// Energies at one time (J), and what became of them since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    creep: [Creep; 2],
    held: Option<Corner>,
    step_size: f64,
    ending: Option<(Ending, f64)>,
    sums: EnergySums,
    peaks: Peaks,
    counts: Counts,
    last_event: f64,
    events_in_this_instant: u32,
}

/// State and all that follows from it at one time.
#[derive(Clone, Copy)]
struct Point {
    time: f64,
    state: State,
    rate: Rate,
    instant: Instant<f64>,
    forcing: Forcing<f64>,
    peaks: Option<PeakSamples>,
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
            creep: [Creep { depth: 0.0, since: time }; 2],
            held: None,
            step_size: f64::INFINITY,
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
        simulation.sums.initial = kinetic + potential;
        simulation.peaks.include(&simulation.peak_samples(&start, &excitation));
        simulation.counts = Counts::default();
        simulation
    }

    fn place_on_supports(&mut self, initial: &Initial, excitation: &Excitation) {
        let Block { b, h, .. } = self.block;
        let (sin, cos) = libm::sincos(initial.theta);
        let free = self.block.static_deflection();
        let turn = [b * sin, -b * sin];
        let turn_dot = [b * cos * initial.theta_dot, -b * cos * initial.theta_dot];
        // Height and rate of the middle of the base.
        let (middle, middle_dot) = match initial.vertical {
            Some((v, v_dot)) => (v + h * sin * sin / (1.0 + cos), v_dot + h * sin * initial.theta_dot),
            None if turn[0].abs() <= free => (0.0, 0.0),
            // On the lower corner alone, which sinks by δ_s under the whole weight and does not move.
            None => (turn[0].abs() - free, turn_dot[0] * turn[0].signum()),
        };
        let (v, v_dot) = (middle - h * sin * sin / (1.0 + cos), middle_dot - h * sin * initial.theta_dot);
        let corners = [0, 1].map(|i| (middle + turn[i], middle_dot + turn_dot[i]));
        let touching = corners.map(|(height, _)| height <= free);
        // The supports of corners in the air are at their free height; a corner that is drawn up faster than its
        // support can follow leaves it at once, which is no lift-off to be counted.
        self.settle(touching, corners, initial.theta, initial.theta_dot, v, v_dot, excitation);
        self.counts = Counts::default();
        if self.regime == Regime::Separated {
            self.end(Ending::Separated);
        }
    }

    fn place_on_rigid_base(&mut self, initial: &Initial) {
        let lean = if initial.theta != 0.0 { initial.theta } else { initial.theta_dot };
        self.regime = match lean {
            lean if lean < 0.0 => Regime::TiltingLeft,
            lean if lean > 0.0 => Regime::TiltingRight,
            _ => Regime::FullContact,
        };
        self.state = State::new(initial.theta, initial.theta_dot, 0.0, 0.0);
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
            Some((ending, time)) if self.at_end(ending) == AtEnd::Terminate => Ok(Progress::Ended(ending, time)),
            _ => {
                self.time = until;
                Ok(Progress::Reached)
            }
        }
    }

    /// Whether the numbers of a state that came from outside can be gone on from: all finite, and the tolerance one that
    /// is followed. The block is checked by whoever knows what it was made from.
    pub fn is_valid(&self) -> bool {
        let Simulation { settings, pulse, time, state, creep, step_size, sums, last_event, .. } = self;
        let creep = creep.iter().flat_map(|creep| [creep.depth, creep.since]);
        let sums = [sums.initial, sums.input, sums.dashpots, sums.impacts];
        let others = [*time, *last_event, pulse.amplitude, pulse.period, pulse.start];
        let [least, most] = Settings::TOLERANCES;
        (least..=most).contains(&settings.tolerance)
            && *step_size > 0.0
            && pulse.period > 0.0
            && state.iter().copied().chain(creep).chain(sums).chain(others).all(f64::is_finite)
    }

    /// Sets the clock without any motion, to take up the rounding of a master's clock.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Steps from the present time to `stop`, over which the excitation is smooth, or to the end of the run.
    fn smooth_piece(
        &mut self,
        stop: f64,
        excitation: &Excitation,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let mut here = self.point(excitation);
        while self.time < stop && self.ending.is_none() {
            let (block, regime) = (self.block, self.regime);
            let rate = |time: f64, state: &State| rate(&block, regime, excitation.at(time), state).0;
            let (step, mut there) = self.accepted_step(stop, &here, excitation)?;
            let mut dense: Option<DenseOutput> = None;
            let mut evaluations = 0;
            let end = there.rate;
            let mut inside = || {
                *dense.get_or_insert_with(|| {
                    evaluations += 3;
                    step.dense(end, rate)
                })
            };
            let event = self.first_event(&here, &there, excitation, &mut inside);
            let (elapsed, work) = match event {
                Some((elapsed, _)) => {
                    let dense = inside();
                    let time = self.time + elapsed;
                    there = self.point_at(time, dense.state(elapsed), excitation);
                    (elapsed, dense.work(elapsed))
                }
                None => (there.time - here.time, step.work),
            };
            self.update_peaks(&mut here, &mut there, elapsed, excitation, &mut inside);
            self.counts.evaluations += evaluations;
            self.sums.input += work[0];
            self.sums.dashpots += work[1];
            if there.time > self.time {
                self.events_in_this_instant = 0;
            }
            (self.time, self.state) = (there.time, there.state);
            here = match event {
                Some((_, surface)) => {
                    self.apply(surface, &there, excitation, observer)?;
                    self.point(excitation)
                }
                None => there,
            };
            if self.held.is_some_and(|corner| self.bears(corner, &here)) {
                self.held = None;
            }
        }
        Ok(())
    }

    /// A step within the tolerance, from `here` towards `stop`, and the point it leads to.
    #[inline]
    fn accepted_step(
        &mut self,
        stop: f64,
        here: &Point,
        excitation: &Excitation,
    ) -> Result<(Step, Point), SimulationError> {
        let (block, regime, time) = (self.block, self.regime, self.time);
        let (weights, longest) = self.error_weights(excitation.frequency());
        let remaining = stop - time;
        // The rest of the way in equal steps, so that a stop close ahead is not met by a tiny step.
        let steps = (remaining / self.step_size.min(longest)).ceil().max(1.0);
        let mut size = remaining / steps;
        let mut last = steps == 1.0;
        let mut grow = true;
        loop {
            let step =
                Step::attempt(time, size, here.state, here.rate, |t, x| rate(&block, regime, excitation.at(t), x).0);
            self.counts.evaluations += EVALUATIONS_PER_STEP;
            let error = step.error(&weights);
            let factor = Step::size_factor(error);
            if error <= 1.0 {
                let proposal = if grow { size * factor } else { size * factor.min(1.0) };
                self.step_size = if factor < 1.0 { proposal } else { self.step_size.min(longest).max(proposal) };
                self.counts.steps += 1;
                let there = self.point_at(if last { stop } else { time + size }, step.end, excitation);
                if !there.state.iter().chain(there.rate.state.iter()).all(|x| x.is_finite()) {
                    return Err(SimulationError::NotFinite { time });
                }
                return Ok((step, there));
            }
            self.counts.rejected += 1;
            (last, grow) = (false, false);
            size *= factor;
            if time + size == time {
                return Err(if here.rate.state.iter().all(|x| x.is_finite()) && error.is_finite() {
                    SimulationError::StepTooSmall { time, size, tolerance: self.settings.tolerance }
                } else {
                    SimulationError::NotFinite { time }
                });
            }
        }
    }

    /// Reciprocals of the errors that a step may make in each component of the state, and the longest step (s).
    ///
    /// An error counts as the velocity it amounts to: a displacement times the circular frequency of its motion, a
    /// vertical one over R0. Allowed is the tolerance times the velocity of rocking, α p. A step is at most a third of
    /// the shortest period, so that it holds at most one extremum.
    fn error_weights(&self, pulse_frequency: f64) -> (State, f64) {
        let Block { alpha, p, b, h, i0, r0, omega_v, foundation, .. } = self.block;
        const LONGEST: f64 = 2.0;
        let turning = b * b / (i0 + h * h);
        let (rocking, vertical) = match (foundation, self.regime) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => (p, p),
            (_, Regime::FullContact) => (p.max(omega_v * turning.sqrt()), omega_v),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => (p, omega_v * (0.5 * (1.0 + turning)).sqrt()),
        };
        let allowed = 1.0 / (self.settings.tolerance * alpha * p);
        let weights = State::new(rocking * allowed, allowed, vertical * allowed / r0, allowed / r0);
        (weights, LONGEST / rocking.max(vertical).max(pulse_frequency))
    }

    /// The first surface through which the motion falls between two points, and when, in seconds after the first.
    fn first_event(
        &self,
        here: &Point,
        there: &Point,
        excitation: &Excitation,
        inside: &mut impl FnMut() -> DenseOutput,
    ) -> Option<(f64, Surface)> {
        let mut first: Option<(f64, Surface)> = None;
        let duration = there.time - here.time;
        for surface in surfaces(&self.block, self.regime, self.held).into_iter().flatten() {
            let rounding = surface.rounding(&self.block);
            let start = surface.sample(&self.moment(here, excitation));
            let end = surface.sample(&self.moment(there, excitation));
            if !roots::may_fall(start, end, rounding, duration) {
                continue;
            }
            let dense = inside();
            let fall = roots::first_fall(start, end, rounding, duration, |elapsed| {
                let point = self.point_at(here.time + elapsed, dense.state(elapsed), excitation);
                surface.sample(&self.moment(&point, excitation))
            });
            if let Some(elapsed) = fall
                && first.is_none_or(|(earliest, _)| elapsed < earliest)
            {
                first = Some((elapsed, surface));
            }
        }
        first
    }

    /// What the event does, and the regime anew.
    fn apply(
        &mut self,
        surface: Surface,
        at: &Point,
        excitation: &Excitation,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        const MOST_EVENTS_IN_AN_INSTANT: u32 = 64;
        self.events_in_this_instant += 1;
        if self.events_in_this_instant > MOST_EVENTS_IN_AN_INSTANT {
            return Err(SimulationError::NoRegime { time: self.time, count: self.events_in_this_instant });
        }
        let before = self.regime;
        let energy_before = self.energy_of(&at.instant);
        self.last_event = self.time;
        let kind = match surface {
            Surface::Reaction(corner) | Surface::Held(corner) => {
                match self.block.foundation {
                    Foundation::Viscoelastic => self.lift(corner, surface, at, excitation),
                    Foundation::Rigid => self.start_to_rock(corner),
                }
                EventKind::LiftOff(corner)
            }
            Surface::Gap(corner) => {
                match self.block.foundation {
                    Foundation::Viscoelastic => self.land(corner, at, excitation),
                    Foundation::Rigid => self.change_pivot(corner, at),
                }
                EventKind::Landing(corner)
            }
            Surface::QuarterTurn => {
                self.end(Ending::Overturned);
                EventKind::Overturning
            }
        };
        let after = self.point(excitation);
        self.sums.impacts += energy_before - self.energy_of(&after.instant);
        if self.held.is_some() && self.regime == before {
            // Nothing happened that a user would see: the corner is held from here on.
            return Ok(());
        }
        if self.regime == Regime::Separated {
            self.end(Ending::Separated);
        }
        observer(&Event { time: self.time, kind, before, after: self.regime });
        Ok(())
    }

    /// The reaction of `corner` fell through zero.
    fn lift(&mut self, corner: Corner, surface: Surface, at: &Point, excitation: &Excitation) {
        let mut touching = Corner::BOTH.map(|c| self.regime.touches(c));
        let opens = self.regime != Regime::FullContact || gap_opening(&self.moment(at, excitation), corner) >= 0.0;
        self.held = (!opens && matches!(surface, Surface::Reaction(_))).then_some(corner);
        if self.held.is_some() {
            return;
        }
        let corners = corners_of(&at.instant);
        touching[corner.index()] = false;
        self.creep[corner.index()] =
            Creep { depth: self.block.static_deflection() - corners[corner.index()].0, since: self.time };
        self.counts.liftoffs += 1;
        let Instant { theta, theta_dot, v, v_dot, .. } = at.instant;
        self.settle(touching, corners, theta, theta_dot, v, v_dot, excitation);
    }

    /// The gap under `corner` closed while the other corner stands.
    fn land(&mut self, corner: Corner, at: &Point, excitation: &Excitation) {
        let Block { epsilon, b, h, .. } = self.block;
        let i = corner.index();
        let Instant { theta, mut theta_dot, v, mut v_dot, .. } = at.instant;
        let mut corners = corners_of(&at.instant);
        corners[i].0 = self.creep[i].top(&self.block, self.time).value;
        if corners[i].1 < 0.0 {
            (v_dot, theta_dot) = impact::landing(&self.block, corner, theta, v_dot, theta_dot);
            let (sin, cos) = libm::sincos(theta);
            let standing = corner.other();
            let s = standing.sign();
            corners[standing.index()].1 = v_dot + s * (b * cos + s * h * sin) * theta_dot;
            // Exactly ε times the rate before, which the map gives only to rounding.
            corners[i].1 *= epsilon;
            self.counts.impacts += 1;
        }
        self.settle([true; 2], corners, theta, theta_dot, v, v_dot, excitation);
    }

    /// Decides the regime: takes the corners that touch, drops one whose support would have to pull, or would have to
    /// within the resolution of time, and repeats. Heights and rates of the corners are given beside `v`, `v̇`, since
    /// their exact values (a rate of zero, say) decide.
    #[expect(clippy::too_many_arguments, reason = "the state before it is known which coordinates describe it")]
    fn settle(
        &mut self,
        mut touching: [bool; 2],
        corners: [(f64, f64); 2],
        theta: f64,
        theta_dot: f64,
        v: f64,
        v_dot: f64,
        excitation: &Excitation,
    ) {
        let block = self.block;
        let omega_v = block.omega_v;
        self.held = None;
        // Two events closer than this cannot be told apart.
        let resolution = 4.0 * f64::EPSILON * self.time.abs().max(1.0 / omega_v);
        loop {
            self.regime = Regime::of_touching(touching);
            let (w, w_dot) = match self.regime {
                Regime::FullContact => (0.5 * (corners[0].0 + corners[1].0), 0.5 * (corners[0].1 + corners[1].1)),
                Regime::TiltingLeft => corners[0],
                Regime::TiltingRight => corners[1],
                Regime::Separated => (v, v_dot),
            };
            self.state = State::new(theta, theta_dot, w, w_dot);
            let point = self.point(excitation);
            let drop = Corner::BOTH
                .into_iter()
                .filter(|corner| touching[corner.index()])
                .map(|corner| {
                    let (height, rate) = corners[corner.index()];
                    let n = 0.5 * block.gravity - 0.5 * omega_v * omega_v * height - block.xi_v * omega_v * rate;
                    (corner, n)
                })
                .filter(|&(corner, n)| self.cannot_stay(corner, n, resolution, &point, excitation))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((corner, _)) = drop else { break };
            touching[corner.index()] = false;
            self.creep[corner.index()] =
                Creep { depth: block.static_deflection() - corners[corner.index()].0, since: self.time };
            self.counts.liftoffs += 1;
        }
    }

    /// Whether a touching corner with the reaction `n` (per mass) leaves its support now.
    fn cannot_stay(&mut self, corner: Corner, n: f64, resolution: f64, point: &Point, excitation: &Excitation) -> bool {
        if n < 0.0 {
            return true;
        }
        let falling = {
            let rate = reaction_rate(&self.block, &point.instant, corner);
            // Without damping and after a landing at ε = 0 the rate is zero, and the next derivative decides.
            let second = -point.instant.corner_ddot[corner.index()];
            n + rate * resolution < 0.0 || (n == 0.0 && (rate < 0.0 || (rate == 0.0 && second < 0.0)))
        };
        if falling && self.regime == Regime::FullContact && gap_opening(&self.moment(point, excitation), corner) < 0.0 {
            self.held = Some(corner);
            return false;
        }
        falling
    }

    /// On the rigid base, `corner` lifts from rest.
    fn start_to_rock(&mut self, corner: Corner) {
        self.regime = Regime::on(corner.other());
        self.state = State::zeros();
        self.counts.liftoffs += 1;
    }

    /// On the rigid base, the pivot changes to `corner`: `θ̇ → e θ̇` at θ = 0, or rest.
    fn change_pivot(&mut self, corner: Corner, at: &Point) {
        // Rocking comes to rest after infinitely many impacts in finite time; below this part of p they are not told
        // apart any more.
        const REST: f64 = 1e-9;
        let theta_dot = self.block.restitution().max(0.0) * at.state[1];
        self.counts.impacts += 1;
        if theta_dot.abs() < REST * self.block.p {
            self.regime = Regime::FullContact;
            self.state = State::zeros();
        } else {
            self.regime = Regime::on(corner);
            self.state = State::new(0.0, theta_dot, 0.0, 0.0);
            self.counts.liftoffs += 1;
        }
    }

    fn end(&mut self, ending: Ending) {
        self.ending = Some((ending, self.time));
    }

    fn at_end(&self, ending: Ending) -> AtEnd {
        match ending {
            Ending::Separated => self.settings.on_separation,
            Ending::Overturned => self.settings.on_overturning,
        }
    }

    /// Whether a held corner bears weight again.
    fn bears(&self, corner: Corner, at: &Point) -> bool {
        at.instant.reaction[corner.index()] > Surface::Reaction(corner).rounding(&self.block)
    }

    fn energy_of(&self, instant: &Instant<f64>) -> f64 {
        let (kinetic, potential) = energy(&self.block, self.regime, instant);
        kinetic + potential
    }

    /// Takes the step's peaks in. Their rates take dual numbers, so they are formed only where a peak is near: a step is
    /// at most a third of a period long, in which a sinusoid does not grow above twice the greater of its ends.
    fn update_peaks(
        &mut self,
        here: &mut Point,
        there: &mut Point,
        elapsed: f64,
        excitation: &Excitation,
        inside: &mut impl FnMut() -> DenseOutput,
    ) {
        if elapsed <= 0.0 || !(self.near_a_peak(here) || self.near_a_peak(there)) {
            return;
        }
        let start = here.peaks.unwrap_or_else(|| self.peak_samples(here, excitation));
        let end = there.peaks.unwrap_or_else(|| self.peak_samples(there, excitation));
        (here.peaks, there.peaks) = (Some(start), Some(end));
        let mut peaks = self.peaks;
        peaks.include_step(&start, &end, elapsed, |after| {
            let point = self.point_at(here.time + after, inside().state(after), excitation);
            self.peak_samples(&point, excitation)
        });
        self.peaks = peaks;
    }

    fn near_a_peak(&self, point: &Point) -> bool {
        const NEAR: f64 = 0.5;
        let tops = self.creep.map(|creep| creep.top(&self.block, point.time).value);
        let seen = observe(&self.block, self.regime, &point.instant, tops);
        let Peaks { theta, reaction, horizontal, uplift, friction_demand } = self.peaks;
        seen.theta.abs() >= NEAR * theta
            || seen.reaction[0].max(seen.reaction[1]) >= NEAR * reaction
            || seen.horizontal.abs() >= NEAR * horizontal
            || seen.uplift[0].max(seen.uplift[1]) >= NEAR * uplift
            || seen.friction_demand >= NEAR * friction_demand
    }

    fn peak_samples(&self, point: &Point, excitation: &Excitation) -> PeakSamples {
        peaks::samples(&self.view(point).observe_rates(excitation.rate_at(point.time)))
    }

    fn view<'a>(&'a self, point: &'a Point) -> View<'a> {
        View {
            block: &self.block,
            regime: self.regime,
            time: point.time,
            state: &point.state,
            flight: NO_FLIGHT,
            creep: &self.creep,
            forcing: point.forcing,
        }
    }

    /// Present time (s).
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Present state `[θ, θ̇, w, ẇ]`; what w is depends on the regime, see [`crate::dynamics`].
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Present regime.
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

    /// Whether the run ended and is held there: nothing moves and no support bears any more.
    pub fn is_frozen(&self) -> bool {
        self.ending.is_some_and(|(ending, _)| self.at_end(ending) == AtEnd::Hold)
    }

    /// What a user sees now, under these inputs.
    pub fn observe(&self, inputs: &Inputs) -> Observation<f64> {
        let seen = self.with_view(inputs, |view, _| view.observe());
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact rates of change along the motion while the inputs go on.
    pub fn observe_rates(&self, inputs: &Inputs) -> Observation<Dual64> {
        let seen = self.with_view(inputs, |view, rate| view.observe_rates(rate));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    /// The same with, in the dual parts, the exact derivatives with respect to the inputs in the direction whose
    /// components are the values of `direction`: at this instant, so with state and regime as they are.
    pub fn observe_direction(&self, inputs: &Inputs, direction: &Inputs) -> Observation<Dual64> {
        let direction = Excitation::from_time(0.0, direction, &Pulse::NONE, &self.block).at(direction.time);
        let seen = self.with_view(inputs, |view, _| view.observe_direction(direction));
        if self.is_frozen() { seen.frozen() } else { seen }
    }

    fn with_view<R>(&self, inputs: &Inputs, look: impl FnOnce(View, Forcing<f64>) -> R) -> R {
        let excitation = Excitation::from_time(self.time, inputs, &self.pulse, &self.block);
        let view = View {
            block: &self.block,
            regime: self.regime,
            time: self.time,
            state: &self.state,
            flight: NO_FLIGHT,
            creep: &self.creep,
            forcing: excitation.at(self.time),
        };
        look(view, excitation.rate_at(self.time))
    }

    /// Energies and their sums now (J).
    pub fn energies(&self) -> Energies {
        let x = self.point_at(self.time, self.state, &Excitation::none()).instant;
        let (kinetic, potential) = energy(&self.block, self.regime, &x);
        let EnergySums { initial, input, dashpots, impacts } = self.sums;
        let [kinetic, potential, initial, input, dashpots, impacts] =
            [kinetic, potential, initial, input, dashpots, impacts].map(|part| part * self.block.mass);
        let total = kinetic + potential;
        Energies {
            total,
            kinetic,
            potential,
            input,
            dashpots,
            impacts,
            residual: total - initial - input + dashpots + impacts,
        }
    }

    /// Rates at which the energies and their sums change now (W).
    pub fn energy_rates(&self, inputs: &Inputs) -> Energies {
        if self.is_frozen() {
            return Energies::default();
        }
        self.with_view(inputs, |view, _| {
            let block = &self.block;
            let x = view.along(Forcing::default());
            let (kinetic, potential) = energy(block, self.regime, &x);
            let forcing = view.forcing;
            let [input, dashpots] = view.instant().powers(block, self.regime, forcing);
            let [kinetic, potential, input, dashpots] =
                [kinetic.eps, potential.eps, input, dashpots].map(|part| part * block.mass);
            let total = kinetic + potential;
            Energies { total, kinetic, potential, input, dashpots, impacts: 0.0, residual: total - input + dashpots }
        })
    }

    fn moment<'a>(&'a self, point: &'a Point, excitation: &Excitation) -> Moment<'a> {
        Moment {
            block: &self.block,
            time: point.time,
            state: &point.state,
            regime: self.regime,
            instant: &point.instant,
            forcing: point.forcing,
            forcing_rate: excitation.rate_at(point.time),
            creep: &self.creep,
        }
    }

    fn point(&mut self, excitation: &Excitation) -> Point {
        self.counts.evaluations += 1;
        self.point_at(self.time, self.state, excitation)
    }

    #[inline]
    fn point_at(&self, time: f64, state: State, excitation: &Excitation) -> Point {
        let forcing = excitation.at(time);
        let (rate, instant) = rate(&self.block, self.regime, forcing, &state);
        Point { time, state, rate, instant, forcing, peaks: None }
    }
}

fn corners_of(x: &Instant<f64>) -> [(f64, f64); 2] {
    [(x.corner[0], x.corner_dot[0]), (x.corner[1], x.corner_dot[1])]
}

/// Horizontal motion in flight; zero while the run ends at separation.
const NO_FLIGHT: Flight<f64> = (0.0, 0.0);

#[inline]
fn rate(block: &Block, regime: Regime, forcing: Forcing<f64>, state: &State) -> (Rate, Instant<f64>) {
    let x = instant(block, regime, [state[0], state[1], state[2], state[3]], NO_FLIGHT, forcing);
    let powers = x.powers(block, regime, forcing);
    let state = State::new(x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot);
    (Rate { state, powers: powers.into() }, x)
}
