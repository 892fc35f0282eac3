//! A smooth piece of the excitation → steps, the first event in each, peaks and energy sums.

use crate::block::{Block, Foundation};
use crate::dynamics::{Footing, Instant, State, instant};
use crate::events::{Event, Moment, Surface, surfaces};
use crate::excitation::{Excitation, Forcing};
use crate::integrator::{DenseOutput, EVALUATIONS_PER_STEP, Rate, Step};
use crate::outputs::{View, observe};
use crate::peaks::{self, PeakSamples, Peaks};
use crate::regime::Regime;
use crate::roots;
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
    pub(super) peaks: Option<PeakSamples>,
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
    pub(super) fn accepted_step(
        &mut self,
        stop: f64,
        here: &Point,
        excitation: &Excitation,
    ) -> Result<(Step, Point), SimulationError> {
        let (block, time) = (self.block, self.time);
        let motion = Motion::of(self, &block);
        let (weights, longest) = self.error_weights(excitation.frequency());
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
            if size < shortest {
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
    /// vertical one over R0. Allowed is the tolerance times the velocity of rocking, α p; of the vertical velocity also
    /// not more than what changes a reaction by some 5 tolerances of the weight, which is less on stiff supports. A step
    /// is at most a third of the shortest period, so that it holds at most one extremum.
    pub(super) fn error_weights(&self, pulse_frequency: f64) -> (State, f64) {
        let Block { alpha, p, b, h, i0, r0, omega_v, gravity, foundation, .. } = self.block;
        const LONGEST: f64 = 2.0;
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
        (weights, LONGEST / rocking.max(vertical).max(pulse_frequency))
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

    /// Takes the step's peaks in. Their rates take dual numbers, so they are formed only where a peak is near: a step is
    /// at most a third of a period long, in which a sinusoid does not grow above twice the greater of its ends.
    pub(super) fn update_peaks(
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

    pub(super) fn near_a_peak(&self, point: &Point) -> bool {
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
            creep: &self.creep,
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
}

impl Motion<'_> {
    /// The motion of a simulation from its present time on, while the regime lasts.
    #[inline]
    fn of<'a>(simulation: &Simulation, block: &'a Block) -> Motion<'a> {
        Motion { block, regime: simulation.regime, since: simulation.time, footing: simulation.footing }
    }

    #[inline]
    fn point(&self, time: f64, state: State, excitation: &Excitation) -> Point {
        let forcing = excitation.at(time);
        let footing = self.footing_at(time, excitation);
        let instant = instant(self.block, self.regime, state.into(), footing, forcing);
        let powers = instant.powers(self.block, self.regime, forcing).into();
        let rate =
            Rate { state: State::new(instant.theta_dot, instant.theta_ddot, instant.w_dot, instant.w_ddot), powers };
        Point { time, state, footing, rate, instant, forcing, peaks: None }
    }

    #[inline]
    fn rate(&self, time: f64, state: &State, excitation: &Excitation) -> Rate {
        self.point(time, *state, excitation).rate
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
