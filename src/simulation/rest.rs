//! A block at rest on the rigid base → its forces and peaks, until a corner lifts or the piece ends.

use crate::block::{Body, Corner, Regime};
use crate::excitation::{Forcing, ForcingSeries};
use crate::numerics::bernstein::{Pair, Zero};
use crate::run::SimulationError;
use crate::simulation::force_peaks::{ForcePeaks, ForceSegment, UNITS, visible};
use crate::simulation::outputs::Channels;
use crate::simulation::state::{Committed, RunState};
use crate::simulation::step::{StepKind, StepsInput, StepsOutcome};
use crate::simulation::swings::longest_swing;
use crate::system::dynamics::{instant, instant_of};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::EventFunction;
use crate::system::instant::{Footing, Instant, Pose, Powers, State};
use crate::system::motion_mode::MotionMode;
use crate::system::swing::ORDER;

/// Whether both reactions of a block at rest are above their round-off.
fn is_pressed_down(now: &Evaluation) -> bool {
    let rounding = EventFunction::Reaction(Corner::Left).rounding(now.body);
    now.instant.reaction.iter().all(|&reaction| reaction > rounding)
}

/// Forces on a block at rest over a step: N_L/M, N_R/M and H/M (m/s²). They are series in powers of the elapsed fraction.
struct RestForceSeries([[f64; ORDER + 1]; 3]);

impl RestForceSeries {
    /// They are linear in the excitation.
    fn of(body: &Body, footing: Footing<f64>, series: &ForcingSeries<{ ORDER + 1 }>, size: f64) -> RestForceSeries {
        let under = |forcing: Forcing<f64>| {
            let Instant { reaction: [left, right], horizontal, .. } =
                instant(body, Regime::FullContact, [0.0; 4], footing, forcing);
            [left, right, horizontal]
        };
        let none = under(Forcing::default());
        // The differences to both sides, so that a mirrored block has the same numbers.
        let by = |unit: fn(f64) -> Forcing<f64>| {
            let (up, down) = (under(unit(1.0)), under(unit(-1.0)));
            [0, 1, 2].map(|i| 0.5 * (up[i] - down[i]))
        };
        let by_ramp = |ramp: [f64; 2], unit| if ramp == [0.0; 2] { [0.0; 3] } else { by(unit) };
        let by = [
            by(|x| Forcing { x, ..Forcing::default() }),
            by_ramp(series.z, |z| Forcing { z, ..Forcing::default() }),
            by_ramp(series.moment, |moment| Forcing { moment, ..Forcing::default() }),
        ];
        let (mut forces, mut power) = ([[0.0; ORDER + 1]; 3], 1.0);
        for k in 0..ORDER + 1 {
            let linear = |ramp: [f64; 2]| if k < 2 { ramp[k] } else { 0.0 };
            let forcing = [series.x[k], linear(series.z), linear(series.moment)];
            for (i, force) in forces.iter_mut().enumerate() {
                force[k] = (forcing[0] * by[0][i] + forcing[1] * by[1][i] + forcing[2] * by[2][i]) * power;
            }
            power *= size;
        }
        for (force, none) in forces.iter_mut().zip(none) {
            force[0] += none;
        }
        RestForceSeries(forces)
    }

    /// N_L/M and N_R/M up to a fraction of the step.
    fn reactions(&self, fraction: f64) -> Pair {
        let [left, right, _] = &self.0;
        pair(fraction, |k| [left[k], right[k]])
    }

    /// Their sum and H/M up to a fraction of the step.
    fn resultant(&self, fraction: f64) -> Pair {
        let [left, right, shear] = &self.0;
        pair(fraction, |k| [left[k] + right[k], shear[k]])
    }
}

/// Restricts two polynomials over a step to its first `fraction`.
#[inline(always)]
fn pair(fraction: f64, of_power: impl Fn(usize) -> [f64; 2]) -> Pair {
    let (mut powers, mut power) = ([[0.0; 2]; ORDER + 1], 1.0);
    for (k, both) in powers.iter_mut().enumerate() {
        let [p, q] = of_power(k);
        *both = [p * power, q * power];
        power *= fraction;
    }
    Pair::of(powers, ORDER)
}

/// The beginning of a step at rest.
struct RestSegment<'m, 'a, L> {
    motion: &'m Motion<'a, L>,
    /// Time at which the step begins (s), the fraction of it, and its size (s).
    span: [f64; 3],
}

impl<L: MotionMode> ForceSegment<f64> for RestSegment<'_, '_, L> {
    #[inline(always)]
    fn include_at(&self, peaks: &mut ForcePeaks<f64>, runs: bool, place: f64) {
        if runs {
            let [time, fraction, size] = self.span;
            peaks.include_forces(&self.motion.at(time + place * fraction * size, State::zeros()));
        }
    }
}

impl RunState {
    /// Stays at rest while the excitation changes linearly, if no corner lifts before the end. Returns whether it did. Reactions are
    /// linear, too, and the friction demand, their quotient, has its peak at an end.
    #[inline(always)]
    pub(super) fn rest_under_ramp(
        &mut self,
        mode: impl MotionMode,
        input: &StepsInput,
        budget: &mut u64,
    ) -> Result<bool, SimulationError> {
        let (block, &StepsInput { excitation, stop, .. }) = (input.block(), input);
        let Pose { time, state, footing, .. } = self.pose;
        // A corner that is pressed on by more than the round-off of its reaction has not lifted.
        let pressed = EventFunction::Reaction(Corner::Left).rounding(block);
        let channels_at = |time: f64| {
            instant_of(block, mode.foundation(), mode.regime(), state.0, footing, excitation.at(time), |x| {
                let [left, right] = x.reaction;
                (left > pressed && right > pressed).then(|| Channels::of(block, mode.regime(), &x, [0.0; 2]))
            })
        };
        let (here, there) = (channels_at(time), channels_at(stop));
        let (Some(here), Some(there)) = (here, there) else { return Ok(false) };
        input.spend(budget, time, longest_swing(block.p, 0.0))?;
        self.peaks.raise_forces(|forces| {
            forces.include_channels(&here);
            forces.include_channels(&there);
        });
        let works = self.works_after(Powers::zeros());
        self.commit(Committed { time: stop, state, footing, works, evaluations: 1 });
        input.report(|| StepKind::ShortStep);
        Ok(true)
    }

    /// Stays at rest from one instant to another.
    fn stay(&mut self, here: &Evaluation, there: &Evaluation) {
        self.peaks.raise_forces(|forces| {
            forces.include_forces(here);
            forces.include_forces(there);
        });
        self.commit_at(there, Powers::zeros(), 1);
    }

    /// Stays at rest under a pulse until a corner lifts or the piece ends.
    ///
    /// Returns `None` if the first interval is undecided; its steps still count. Later ones are left to the caller.
    #[inline(never)]
    pub(super) fn rest_under_pulse<'a>(
        &mut self,
        mode: impl MotionMode,
        input: &StepsInput<'a>,
        budget: &mut u64,
    ) -> Result<Option<StepsOutcome<'a>>, SimulationError> {
        let (block, &StepsInput { setup, excitation, stop, .. }) = (input.block(), input);
        let longest = longest_swing(block.p, excitation.frequency());
        let motion = Motion::<_, 4>::under(mode, block, &self.pose, excitation);
        let (upright, begin) = (State::zeros(), self.pose.time);
        let mut here = motion.at(self.pose.time, upright);
        let stayed = |time: f64| (time > begin).then_some(StepsOutcome::Lasts);
        while self.pose.time < stop {
            let time = self.pose.time;
            input.spend(budget, time, longest)?;
            let remaining = stop - time;
            let size = remaining / (remaining / longest).ceil().max(1.0);
            let forces = RestForceSeries::of(block, here.footing, &excitation.series(time), size);
            let reactions = forces.reactions(1.0);
            let zeros = Corner::each(|corner| {
                let i = corner.index();
                let reaction = |fraction: f64| motion.at(time + fraction * size, upright).instant.reaction[i];
                if reactions.coefficients().iter().all(|both| both[i] > 0.0) {
                    Zero::None
                } else {
                    reactions.combined(UNITS[i]).zero_of(reaction)
                }
            });
            let (fraction, lifts) = match zeros {
                [Zero::None, Zero::None] => (1.0, None),
                [Zero::At(fraction), Zero::None] => (fraction, Some(Corner::Left)),
                [Zero::None, Zero::At(fraction)] => (fraction, Some(Corner::Right)),
                [Zero::At(left), Zero::At(right)] if left <= right => (left, Some(Corner::Left)),
                [Zero::At(_), Zero::At(right)] => (right, Some(Corner::Right)),
                [Zero::Unclear, _] | [_, Zero::Unclear] => return Ok(stayed(time)),
            };
            let end = if fraction == 1.0 && size == remaining { stop } else { time + fraction * size };
            let there = motion.at(end, upright);
            if !is_pressed_down(&here) || end <= time || (lifts.is_none() && !is_pressed_down(&there)) {
                return Ok(stayed(time));
            }
            self.stay(&here, &there);
            input.report(|| StepKind::ShortStep);
            let reactions = if fraction == 1.0 { reactions } else { forces.reactions(fraction) };
            let each = UNITS.map(|unit| (&reactions, unit));
            let numbers = [block.mass, visible(setup.settings.tolerance)];
            let segment = RestSegment { motion: &motion, span: [time, fraction, size] };
            self.peaks.raise_forces(|peaks| {
                peaks.search(true, &segment, &each, &forces.resultant(fraction), numbers);
            });
            if let Some(corner) = lifts {
                return Ok(Some(StepsOutcome::Event(EventFunction::Reaction(corner), there)));
            }
            if input.single {
                break;
            }
            here = there;
        }
        Ok(Some(StepsOutcome::Lasts))
    }
}
