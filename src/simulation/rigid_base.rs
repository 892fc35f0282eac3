//! A block on the rigid base → its rest, or swings about a corner, each to the next landing or to the end of the piece.

use crate::block::{Block, Corner, Regime};
use crate::numerics::control::LONGEST;
use crate::numerics::roots::{Sample, greatest, may_rise_inside};
use crate::simulation::inside::{Between, Inside};
use crate::simulation::outputs::{Strain, strain};
use crate::simulation::peaks::{Peaks, greater};
use crate::simulation::smooth_piece::SmoothPiece;
use crate::simulation::step_end::{Finished, StepEnd};
use crate::simulation::stepping::StepStart;
use crate::simulation::{Simulation, SimulationError};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::{Event, Surface};
use crate::system::instant::{Powers, State};
use crate::system::law::Law;
use crate::system::swing::{Bounds, Swing};

/// Whether no event but a landing can be within a swing.
fn is_uneventful(bounds: &Bounds, gravity: f64) -> bool {
    /// The least reaction, as a part of the weight.
    const PRESSED: f64 = 0.01;
    /// The greatest rotation (rad), below a quarter turn.
    const UPRIGHT: f64 = 1.5;
    bounds.is_certain && bounds.reaction[0] > PRESSED * gravity && bounds.theta < UPRIGHT
}

/// Whether no peak can be within a swing, other than the rotation at its end.
fn is_below_peaks(bounds: &Bounds, block: &Block, peaks: &Peaks) -> bool {
    let [least, most] = bounds.reaction;
    let low = bounds.theta < peaks.theta && 2.0 * block.b * bounds.theta < peaks.uplift;
    (bounds.is_monotone || low)
        && most * block.mass < peaks.reaction
        && bounds.horizontal * block.mass < peaks.horizontal
        && bounds.horizontal < peaks.friction_demand * least
}

/// The longest swing (s) under a pulse of this circular frequency (rad/s).
#[inline]
fn longest_swing(p: f64, frequency: f64) -> f64 {
    LONGEST / p.max(frequency)
}

impl Simulation {
    /// Stays at rest to `stop` if no corner lifts before; returns whether it did. Reactions under a linear excitation are linear, and
    /// the friction demand, their quotient, has its peak at an end.
    #[inline(always)]
    pub(super) fn stays_upright<L: Law, const N: usize>(
        &mut self,
        stop: f64,
        motion: &Motion<L, N>,
        here: &Evaluation,
    ) -> bool {
        let there = motion.at(stop, motion.state_of(here));
        let rounding = Surface::Reaction(Corner::Left).rounding(here.block);
        let mut reactions = here.instant.reaction.into_iter().chain(there.instant.reaction);
        if !reactions.all(|reaction| reaction > rounding) {
            return false;
        }
        self.include_forces(here);
        self.include_forces(&there);
        self.counts.evaluations += 1;
        self.counts.steps += 1;
        self.go_to(&there, Powers::zeros());
        true
    }

    /// Includes the forces of an instant in the peaks.
    fn include_forces(&mut self, now: &Evaluation) {
        let Strain { reaction: [left, right], horizontal, friction_demand, .. } =
            strain(now.block, now.regime, &now.instant, [0.0; 2]);
        let Peaks { reaction, horizontal: shear, friction_demand: demand, .. } = &mut self.peaks;
        *reaction = greater(greater(*reaction, left), right);
        *shear = greater(*shear, horizontal.abs());
        *demand = greater(*demand, friction_demand);
    }

    /// Whether N, H or the friction demand may exceed its peak within a part of a swing, by more than a hundredth of the tolerance,
    /// and its values at both ends.
    fn forces_rise(&self, block: &Block, swing: &Swing, part: f64) -> bool {
        const SHARE: f64 = 0.01;
        let Peaks { reaction, horizontal, friction_demand, .. } = self.peaks;
        let [[n, h], [n_end, h_end]] = [0.0, part].map(|part| swing.forces(part, block.gravity));
        let demand = |n: Sample, h: Sample| {
            let value = h.value / n.value;
            Sample { value, rate: (h.rate - value * n.rate) / n.value }
        };
        let (demand, demand_end) = (demand(n, h), demand(n_end, h_end));
        let rises = |most: f64, start: Sample, end: Sample| {
            let most = greater(greater(most, start.value), end.value);
            may_rise_inside(most + SHARE * self.settings.tolerance * most.abs(), start, end, part * swing.size)
        };
        rises(reaction / block.mass, n, n_end)
            || rises(horizontal / block.mass, h, h_end)
            || rises(horizontal / block.mass, h.negated(), h_end.negated())
            || rises(friction_demand, demand, demand_end)
            || rises(friction_demand, demand.negated(), demand_end.negated())
    }

    /// Includes a part of a swing in the peaks, with the forces at its ends and the greatest rotation.
    fn raise_peaks(&mut self, law: impl Law, piece: &SmoothPiece, swing: &Swing, [part, end]: [f64; 2], state: State) {
        let motion = Motion::<_, 4>::under(law, piece.block, &self.pose, piece.excitation);
        self.include_forces(&motion.at(self.pose.time, self.pose.state));
        self.include_forces(&motion.at(end, state));
        self.counts.evaluations += 2;
        let away = |part: f64| {
            let [theta, slope] = swing.theta_at(part);
            let sample = Sample { value: theta, rate: slope };
            if self.pose.contacts.regime() == Regime::TiltingLeft { sample.negated() } else { sample }
        };
        let theta = greatest(self.peaks.theta, away(0.0), away(part), part, away);
        self.raise_rotation(theta);
    }

    /// Includes a rotation (rad) about a corner in the peaks.
    fn raise_rotation(&mut self, theta: f64) {
        if theta > self.peaks.theta {
            self.peaks.theta = theta;
            self.peaks.uplift = greater(self.peaks.uplift, libm::sin(theta) * (2.0 * self.system.block.b));
        }
    }

    /// Follows a block that turns about `pivot`, to the end of the piece or to an event.
    #[inline(never)]
    pub(super) fn swings(
        &mut self,
        law: impl Law,
        pivot: Corner,
        piece: &SmoothPiece,
        mut start: StepStart,
        budget: &mut u64,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<(), SimulationError> {
        let &SmoothPiece { block, excitation, stop, .. } = piece;
        let longest = longest_swing(block.p, excitation.frequency());
        // The longest swing may make the error of a step, others in proportion, so that the errors between frequent stops do not add up.
        let allowed = self.settings.tolerance * block.alpha * block.p / longest_swing(block.p, 0.0);
        let mut most = longest;
        loop {
            self.spend(budget, piece, longest)?;
            let (time, [theta, theta_dot, ..]) = (self.pose.time, self.pose.state.0);
            let remaining = stop - time;
            let swing = Swing::of(block, pivot, excitation, [time, theta, theta_dot], remaining.min(most), allowed);
            if let Some(place) = piece.swing {
                place.set(Some(swing));
            }
            self.counts.evaluations += 1;
            self.counts.steps += 1;
            let bounds = swing.bounds(block, pivot);
            let lands = bounds.is_certain && bounds.last < 0.0;
            let part = if lands { swing.landing() } else { 1.0 };
            let end = if swing.size == remaining && !lands { stop } else { time + part * swing.size };
            let [theta, theta_dot] = swing.at(part);
            let state = State::from([theta, theta_dot, 0.0, 0.0]);
            let is_known = is_uneventful(&bounds, block.gravity) && (lands || end > time);
            if is_known && is_below_peaks(&bounds, block, &self.peaks) {
                self.go_along(end, state, swing.work(part));
            } else if is_known && !self.forces_rise(block, &swing, part) {
                self.raise_peaks(law, piece, &swing, [part, end], state);
                self.go_along(end, state, swing.work(part));
            } else {
                match self.examine(law, &swing, [part, end], state, start.of_piece, piece, observer)? {
                    Finished::TooLong(size) => {
                        most = size;
                        continue;
                    }
                    Finished::Left => return Ok(()),
                    Finished::Lasts => {}
                }
            }
            if lands {
                let now = self.now(block, excitation);
                return self.apply_or_stop(Surface::Gap(pivot.other()), &now, piece, observer);
            }
            (start.of_piece, most) = (false, longest);
            if self.pose.time >= stop || piece.single {
                return Ok(());
            }
        }
    }

    /// Comes to the end of a swing in which nothing happens.
    #[inline(always)]
    fn go_along(&mut self, end: f64, state: State, work: f64) {
        self.raise_rotation(state[0].abs());
        self.sums.input += work;
        self.pose.state = state;
        if end > self.pose.time {
            (self.pose.time, self.events_in_this_instant) = (end, 0);
        }
    }

    /// Looks for events and peaks in a part of a swing by the equations.
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "the step that is examined")]
    fn examine(
        &mut self,
        law: impl Law,
        swing: &Swing,
        [part, end]: [f64; 2],
        state: State,
        begins_piece: bool,
        piece: &SmoothPiece,
        observer: &mut dyn FnMut(&Event),
    ) -> Result<Finished, SimulationError> {
        let &SmoothPiece { block, excitation, .. } = piece;
        let motion = Motion::<_, 4>::under(law, block, &self.pose, excitation);
        let mut here = motion.at(self.pose.time, self.pose.state);
        if begins_piece && let Some(surface) = self.system.fallen(&here) {
            self.counts.steps -= 1;
            self.apply_or_stop(surface, &here, piece, observer)?;
            return Ok(Finished::Left);
        }
        let there = motion.at(end, state);
        self.counts.evaluations += 2;
        if ![state[0], state[1], there.instant.theta_ddot].iter().all(|x| x.is_finite()) {
            return Err(SimulationError::NotFinite { time: here.time });
        }
        if end <= here.time && part == 1.0 {
            let (time, size, tolerance) = (here.time, swing.size, self.settings.tolerance);
            return Err(SimulationError::StepTooSmall { time, size, tolerance });
        }
        let step_end = StepEnd {
            state,
            work: [swing.work(part), 0.0].into(),
            longest: longest_swing(block.p, excitation.frequency()),
        };
        let inside = Inside { motion, between: Between::Swing(here.time, swing), evaluations: 0 };
        self.finish(piece, &mut here, there, &step_end, inside, observer)
    }
}
