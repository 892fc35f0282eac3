//! A smooth piece of the excitation → steps, the first event in each, peaks and energy sums.

use crate::block::{Block, Foundation};
use crate::dynamics::State;
use crate::events::{Event, Moment, Surface, reaction_rate, surfaces};
use crate::excitation::Excitation;
use crate::integrator::{DenseOutput, EVALUATIONS_PER_STEP, ShortStep, Step};
use crate::outputs::View;
use crate::peaks::{self, PeakSamples, Peaks};
use crate::regime::{Corner, Regime};
use crate::roots::{self, Sample};
use crate::simulation::motion::{Motion, Point};
use crate::simulation::{Simulation, SimulationError};

/// What a step may be.
struct Limits {
    /// Reciprocals of the errors that a step may make in each component of the state.
    weights: State,
    /// The reciprocal of the error that a step may make in each of the works.
    work_weight: f64,
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
        if let Some(corner) = self.leaving_rigid_base(&here, excitation) {
            self.apply(Surface::Reaction(corner), &here, excitation, observer)?;
            here = self.point(excitation);
        }
        while self.time < stop && self.ending.is_none() {
            let limits = self.limits(excitation.frequency());
            if let Some(there) = self.short_step(stop, &here, excitation, &limits) {
                here = there;
                continue;
            }
            let block = self.block;
            let motion = Motion::of(self, &block);
            let rate = |time: f64, state: &State| motion.rate(time, state, excitation);
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
            self.update_peaks(&here, &there, near, excitation, &mut inside);
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

    /// Goes to `stop` by a step of order 5, if that is close enough and nothing happens on the way.
    ///
    /// Where stops come often, as under a record, the errors of more steps add up than the motion needs. So a step may make
    /// a tenth of the error of others, in the motion and in the works.
    #[inline]
    fn short_step(&mut self, stop: f64, here: &Point, excitation: &Excitation, limits: &Limits) -> Option<Point> {
        // Where a short step failed another is tried before long, since the motion may have become slower.
        const GROWTH: f64 = 1.1;
        const LEAST: f64 = 0.1;
        const SHARE: f64 = 0.1;
        let (block, size) = (self.block, stop - self.time);
        if LONGEST * size > limits.longest || self.held.is_some() {
            return None;
        }
        if size > self.short_size {
            self.short_size *= GROWTH;
            return None;
        }
        let motion = Motion::of(self, &block);
        let step = motion.short_step(here, size, excitation);
        let there = motion.point(stop, step.end, excitation);
        self.counts.evaluations += ShortStep::EVALUATIONS + 1;
        let error = step.error(there.rate, &limits.weights, limits.work_weight) / SHARE;
        // The root of order 4 is two square roots, and less than that of order 5.
        let factor = (1.0 / error.sqrt().sqrt()).max(LEAST);
        if factor < 1.0 {
            self.short_size = size * factor;
            return None;
        }
        if self.may_hold_event(here, &there, excitation) {
            return None;
        }
        let [start, end] = self.samples_at_ends(here, &there, limits.near_a_peak(size), excitation);
        if self.peaks.may_rise_inside(&start, &end, size) {
            return None;
        }
        // After an event or a jump of the inputs the beginning is new, too.
        self.peaks.include(&start);
        self.peaks.include(&end);
        self.counts.steps += 1;
        self.sums.input += step.work[0];
        self.sums.dashpots += step.work[1];
        self.events_in_this_instant = 0;
        (self.time, self.state, self.footing) = (there.time, there.state, there.footing);
        Some(there)
    }

    /// Whether a surface may be fallen through between two points.
    fn may_hold_event(&self, here: &Point, there: &Point, excitation: &Excitation) -> bool {
        let (first, last) = (self.moment(here, excitation), self.moment(there, excitation));
        let may_fall = |surface: Surface| {
            let rounding = surface.rounding(&self.block);
            roots::may_fall(surface.sample(&first), surface.sample(&last), rounding, there.time - here.time)
        };
        self.surfaces().any(may_fall)
    }

    /// The surfaces that end the present regime.
    fn surfaces(&self) -> impl Iterator<Item = Surface> {
        surfaces(self.regime, self.held, self.footing.grips()).into_iter().flatten()
    }

    /// A step within the tolerance, from `here` towards `stop`, and the point it leads to.
    #[inline]
    fn accepted_step(
        &mut self,
        stop: f64,
        here: &Point,
        excitation: &Excitation,
        &Limits { weights, longest, .. }: &Limits,
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
            let step = motion.step(here, size, excitation);
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
        let most = match foundation {
            Foundation::Rigid => r0 * alpha * p,
            // The reaction of one support changes by ω_v ẇ/2 or so, per mass.
            Foundation::Viscoelastic => (r0 * alpha * p).min(OF_WEIGHT * gravity / omega_v),
        };
        let upright = 1.0 / (self.settings.tolerance * most);
        let weights = State::new(rocking * allowed, allowed, vertical * upright, upright);
        let longest = LONGEST / rocking.max(vertical).max(pulse_frequency);
        // The energy of a block that rocks with the velocity of which the rest is a part.
        Limits { weights, work_weight: allowed / ((i0 + r0 * r0) * alpha * p), longest }
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
        let (at_start, at_end) = (self.moment(here, excitation), self.moment(there, excitation));
        for surface in self.surfaces() {
            let rounding = surface.rounding(&self.block);
            let (start, end) = (surface.sample(&at_start), surface.sample(&at_end));
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

    /// Takes the step's peaks in.
    fn update_peaks(
        &mut self,
        here: &Point,
        there: &Point,
        near: f64,
        excitation: &Excitation,
        inside: &mut impl FnMut() -> DenseOutput,
    ) {
        let duration = there.time - here.time;
        if duration <= 0.0 {
            return;
        }
        let [start, end] = self.samples_at_ends(here, there, near, excitation);
        let mut peaks = self.peaks;
        peaks.include_step(&start, &end, duration, |after| {
            let point = self.point_at(here.time + after, inside().state(after), excitation);
            self.peak_samples(&point, excitation)
        });
        self.peaks = peaks;
    }

    /// What the peaks are compared with at both ends of a step. The rates of H and of the friction demand, and those of the
    /// reactions on the rigid base, take dual numbers; so they are formed only where one of these is `near` its peak, as a
    /// part of that, and are zero elsewhere.
    fn samples_at_ends(&self, here: &Point, there: &Point, near: f64, excitation: &Excitation) -> [PeakSamples; 2] {
        let Block { mass, foundation, .. } = self.block;
        let Peaks { reaction, horizontal, friction_demand, .. } = self.peaks;
        let close = |point: &Point| {
            let [left, right] = point.instant.reaction;
            let shear = mass * point.instant.horizontal.abs();
            shear > near * horizontal
                || shear > near * friction_demand * mass * (left + right)
                || (foundation == Foundation::Rigid && mass * left.max(right) > near * reaction)
        };
        if close(here) || close(there) {
            return [here, there].map(|point| self.peak_samples(point, excitation));
        }
        [here, there].map(|point| {
            let (x, none) = (&point.instant, Sample::default());
            let reaction = |corner: Corner| {
                let i = corner.index();
                let rate = reaction_rate(&self.block, x.corner_dot[i], x.corner_ddot[i]);
                match self.regime.touches(corner) {
                    true => Sample { value: mass * x.reaction[i], rate: mass * rate },
                    false => none,
                }
            };
            let uplift = |corner: Corner| {
                let (i, top) = (corner.index(), point.tops[corner.index()]);
                match self.regime.touches(corner) {
                    true => none,
                    false => Sample { value: x.corner[i] - top.value, rate: x.corner_dot[i] - top.rate },
                }
            };
            let theta = Sample { value: x.theta, rate: x.theta_dot };
            let [left, right] = Corner::BOTH;
            [theta, theta.negated(), reaction(left), reaction(right), none, none, uplift(left), uplift(right), none]
        })
    }

    pub(super) fn peak_samples(&self, point: &Point, excitation: &Excitation) -> PeakSamples {
        peaks::samples(&self.view(point).observe_rates(excitation.rate_at(point.time)))
    }

    pub(super) fn view<'a>(&'a self, point: &'a Point) -> View<'a> {
        View {
            block: &self.block,
            regime: self.regime,
            state: &point.state,
            footing: point.footing,
            forcing: point.forcing,
            instant: &point.instant,
            tops: point.tops,
        }
    }

    pub(super) fn moment<'a>(&'a self, point: &'a Point, excitation: &'a Excitation) -> Moment<'a> {
        Moment {
            block: &self.block,
            time: point.time,
            state: &point.state,
            regime: self.regime,
            footing: point.footing,
            instant: &point.instant,
            forcing: point.forcing,
            excitation,
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
