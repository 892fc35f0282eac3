//! A smooth piece of the excitation → steps, the first event in each, peaks and energy sums.

use crate::block::{Block, Foundation};
use crate::dynamics::{Footing, Instant, State, instant, instant_of};
use crate::events::{Creep, Event, Moment, Surface, reaction_rate, surfaces};
use crate::excitation::{Excitation, Forcing};
use crate::integrator::{DenseOutput, EVALUATIONS_PER_STEP, Rate, Step};
use crate::outputs::View;
use crate::peaks::{self, PeakSamples, Peaks};
use crate::regime::{Corner, Regime};
use crate::roots::{self, Sample};
use crate::simulation::{Simulation, SimulationError};

/// State and all that follows from it at one time.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) time: f64,
    pub(super) state: State,
    pub(super) footing: Footing<f64>,
    pub(super) rate: Rate,
    pub(super) instant: Instant<f64>,
    pub(super) forcing: Forcing<f64>,
    /// Heights of the supports that nothing touches.
    pub(super) tops: [Sample; 2],
    pub(super) peaks: Option<PeakSamples>,
}

/// What a step may be.
struct Limits {
    /// Reciprocals of the errors that a step may make in each component of the state.
    weights: State,
    /// The longest step (s).
    longest: f64,
}

/// The longest step over the reciprocal of the fastest circular frequency.
const LONGEST: f64 = 2.0;

impl Limits {
    /// The part of a peak that a value at one end of a step reaches if it may grow above the peak inside.
    ///
    /// In a step of h at a circular frequency ω an oscillation of amplitude A rises by at most A (ωh)²/8 above its ends; this
    /// is eight times as much, since the value may be a sum of larger ones, and at least half, since that is all
    /// that a sinusoid rises in the longest step.
    fn near_a_peak(&self, elapsed: f64) -> f64 {
        let phase = LONGEST * elapsed / self.longest;
        (1.0 - phase * phase).max(0.5)
    }
}

impl Simulation {
    /// Steps from the present time to `stop`, over which the excitation is smooth, or to the end of the run.
    pub(super) fn smooth_piece(
        &mut self,
        stop: f64,
        excitation: &Excitation,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let mut here = self.point(excitation);
        while self.time < stop && self.ending.is_none() {
            let block = self.block;
            let motion = Motion::of(self, &block);
            let rate = |time: f64, state: &State| motion.rate(time, state, excitation);
            let limits = self.limits(excitation.frequency());
            let (step, mut there) = self.accepted_step(stop, &here, excitation, &limits)?;
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
            let near = limits.near_a_peak(elapsed);
            self.update_peaks(&mut here, &mut there, near, excitation, &mut inside);
            self.counts.evaluations += evaluations;
            self.sums.input += work[0];
            self.sums.dashpots += work[1];
            if there.time > self.time {
                self.events_in_this_instant = 0;
            }
            (self.time, self.state, self.footing) = (there.time, there.state, there.footing);
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
        &Limits { weights, longest }: &Limits,
    ) -> Result<(Step, Point), SimulationError> {
        let (block, time) = (self.block, self.time);
        let motion = Motion::of(self, &block);
        let remaining = stop - time;
        // What the clock can resolve on the way. Near time zero it resolves far less, but such steps lead nowhere.
        let shortest = (f64::EPSILON * time.abs().max(stop.abs())).max(f64::MIN_POSITIVE);
        // The rest of the way in equal steps, so that a stop close ahead is not met by a tiny step.
        let steps = (remaining / self.step_size.min(longest).max(shortest)).ceil().max(1.0);
        let mut size = remaining / steps;
        let mut last = steps == 1.0;
        let mut grow = true;
        loop {
            let step = Step::attempt(time, size, here.state, here.rate, |t, x| motion.rate(t, x, excitation));
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
            self.step_size = size;
            if size < shortest {
                return Err(if here.rate.state.iter().all(|x| x.is_finite()) && error.is_finite() {
                    SimulationError::StepTooSmall { time, size, tolerance: self.settings.tolerance }
                } else {
                    SimulationError::NotFinite { time }
                });
            }
        }
    }

    /// What a step may be.
    ///
    /// An error counts as the velocity it amounts to: a displacement times the circular frequency of its motion, a
    /// vertical one over R0. Allowed is the tolerance times the velocity of rocking, α p; of the vertical velocity also
    /// not more than what changes a reaction by some 5 tolerances of the weight, which is less on stiff supports. A step
    /// is at most a third of the shortest period, so that it holds at most one extremum.
    fn limits(&self, pulse_frequency: f64) -> Limits {
        let Block { alpha, p, b, h, i0, r0, omega_v, gravity, foundation, .. } = self.block;
        const OF_WEIGHT: f64 = 10.0;
        // A foot that slides lets the block turn about its centre of mass.
        let turning = if self.footing.grips() { b * b / (i0 + h * h) } else { b * b / i0 };
        let (rocking, vertical) = match (foundation, self.regime) {
            (Foundation::Rigid, _) | (_, Regime::Separated) => (p, p),
            (_, Regime::FullContact) => (p.max(omega_v * turning.sqrt()), omega_v),
            (_, Regime::TiltingLeft | Regime::TiltingRight) => (p, omega_v * (0.5 * (1.0 + turning)).sqrt()),
        };
        let allowed = 1.0 / (self.settings.tolerance * alpha * p);
        // The reaction of one support changes by ω_v ẇ/2 or so, per mass.
        let most = (r0 * alpha * p).min(OF_WEIGHT * gravity / omega_v);
        let upright = 1.0 / (self.settings.tolerance * most);
        let weights = State::new(rocking * allowed, allowed, vertical * upright, upright);
        Limits { weights, longest: LONGEST / rocking.max(vertical).max(pulse_frequency) }
    }

    /// The first surface through which the motion falls between two points, and when, in seconds after the first.
    pub(super) fn first_event(
        &self,
        here: &Point,
        there: &Point,
        excitation: &Excitation,
        inside: &mut impl FnMut() -> DenseOutput,
    ) -> Option<(f64, Surface)> {
        let mut first: Option<(f64, Surface)> = None;
        let duration = there.time - here.time;
        for surface in surfaces(&self.block, self.regime, self.held, self.footing.grips()).into_iter().flatten() {
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

    /// Takes the step's peaks in. Their rates take dual numbers, so they are formed only where a peak is `near`, as a part
    /// of that before.
    fn update_peaks(
        &mut self,
        here: &mut Point,
        there: &mut Point,
        near: f64,
        excitation: &Excitation,
        inside: &mut impl FnMut() -> DenseOutput,
    ) {
        let elapsed = there.time - here.time;
        if elapsed <= 0.0 || !self.may_peak(here, there, near) {
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

    /// Whether a step may hold a new peak: by the tangents where the rates are at hand, and by how near the ends are to
    /// a peak where they are not (H and the friction demand).
    fn may_peak(&self, here: &Point, there: &Point, near: f64) -> bool {
        let Peaks { theta, reaction, horizontal, uplift, friction_demand } = self.peaks;
        let block = &self.block;
        let duration = there.time - here.time;
        let rises = |of: &dyn Fn(&Point) -> Sample, peak: f64| roots::upper_bound(of(here), of(there), duration) > peak;
        let close = |point: &Point| {
            let [left, right] = point.instant.reaction;
            let shear = block.mass * point.instant.horizontal.abs();
            shear > near * horizontal || shear > near * friction_demand * block.mass * (left + right)
        };
        let corner_rises = |corner: Corner| {
            let i = corner.index();
            if self.regime.touches(corner) {
                let force = |point: &Point| {
                    let x = &point.instant;
                    let rate = reaction_rate(block, x.corner_dot[i], x.corner_ddot[i]);
                    Sample { value: block.mass * x.reaction[i], rate: block.mass * rate }
                };
                rises(&force, reaction)
            } else {
                let gap = |point: &Point| {
                    let (x, top) = (&point.instant, point.tops[i]);
                    Sample { value: x.corner[i] - top.value, rate: x.corner_dot[i] - top.rate }
                };
                rises(&gap, uplift)
            }
        };
        let rotation = |sign: f64| {
            move |point: &Point| {
                let x = &point.instant;
                Sample { value: sign * x.theta, rate: sign * x.theta_dot }
            }
        };
        close(here)
            || close(there)
            || corner_rises(Corner::Left)
            || corner_rises(Corner::Right)
            || rises(&rotation(1.0), theta)
            || rises(&rotation(-1.0), theta)
    }

    pub(super) fn peak_samples(&self, point: &Point, excitation: &Excitation) -> PeakSamples {
        peaks::samples(&self.view(point).observe_rates(excitation.rate_at(point.time)))
    }

    pub(super) fn view<'a>(&'a self, point: &'a Point) -> View<'a> {
        View {
            block: &self.block,
            regime: self.regime,
            time: point.time,
            state: &point.state,
            footing: point.footing,
            creep: &self.creep,
            forcing: point.forcing,
        }
    }

    pub(super) fn moment<'a>(&'a self, point: &'a Point, excitation: &Excitation) -> Moment<'a> {
        Moment {
            block: &self.block,
            time: point.time,
            state: &point.state,
            regime: self.regime,
            footing: point.footing,
            instant: &point.instant,
            forcing: point.forcing,
            forcing_rate: excitation.rate_at(point.time),
            tops: point.tops,
        }
    }

    pub(super) fn point(&mut self, excitation: &Excitation) -> Point {
        self.counts.evaluations += 1;
        self.point_at(self.time, self.state, excitation)
    }

    #[inline]
    pub(super) fn point_at(&self, time: f64, state: State, excitation: &Excitation) -> Point {
        Motion::of(self, &self.block).point(time, state, excitation)
    }
}

/// A regime from a time on.
struct Motion<'a> {
    block: &'a Block,
    regime: Regime,
    since: f64,
    footing: Footing<f64>,
    creep: [Creep; 2],
}

impl Motion<'_> {
    /// The motion of a simulation from its present time on, while the regime lasts.
    #[inline]
    fn of<'a>(simulation: &Simulation, block: &'a Block) -> Motion<'a> {
        let Simulation { regime, time, footing, creep, .. } = *simulation;
        Motion { block, regime, since: time, footing, creep }
    }

    #[inline]
    fn point(&self, time: f64, state: State, excitation: &Excitation) -> Point {
        let forcing = excitation.at(time);
        let footing = self.footing_at(time, excitation);
        let instant = instant(self.block, self.regime, state.into(), footing, forcing);
        let rate = self.rate_of(&instant, forcing);
        let tops = Corner::BOTH.map(|corner| match self.regime.touches(corner) {
            true => Sample::default(),
            false => self.creep[corner.index()].top(self.block, time),
        });
        Point { time, state, footing, rate, instant, forcing, tops, peaks: None }
    }

    fn rate(&self, time: f64, state: &State, excitation: &Excitation) -> Rate {
        let forcing = excitation.at(time);
        let footing = self.footing_at(time, excitation);
        instant_of(self.block, self.regime, (*state).into(), footing, forcing, |x| self.rate_of(&x, forcing))
    }

    #[inline(always)]
    fn rate_of(&self, x: &Instant<f64>, forcing: Forcing<f64>) -> Rate {
        Rate {
            state: State::new(x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot),
            powers: x.powers(self.block, self.regime, forcing).into(),
        }
    }

    /// What holds the block at `time`. Where nothing does, `ü = −a_gx` is integrated in closed form.
    #[inline]
    fn footing_at(&self, time: f64, excitation: &Excitation) -> Footing<f64> {
        match self.footing {
            grips @ Footing::Grips { .. } => grips,
            Footing::Free { u, u_dot } => {
                let (velocity, way) = excitation.horizontal_drift(self.since, time);
                Footing::Free { u: u + u_dot * (time - self.since) - way, u_dot: u_dot - velocity }
            }
        }
    }
}
