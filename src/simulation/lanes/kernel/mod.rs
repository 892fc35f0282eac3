//! One step of several runs in the same regime, one in each lane: the operations of [`Simulation`](crate::simulation::Simulation)
//! in their order.

use std::f64::consts::FRAC_PI_2;

use crate::block::{Body, Corner, Foundation, RECOVERED, Regime, Restraints};
use crate::excitation::{Excitation, Forcing, Ramp};
use crate::numerics::control::{eighth_root, near_a_peak, short_factor};
use crate::numerics::dop853::{self, DenseStep};
use crate::numerics::dual::Dual;
use crate::numerics::numbers::Numbers;
use crate::numerics::roots::may_fall_by_bounds;
use crate::numerics::scalar::{Real, Runs, Scalar};
use crate::numerics::short;
use crate::numerics::wide::{Array, Four, Lanes, MAX_LANES, Simd, Task, VectorWidth, Wide};
use crate::numerics::{Rate, StageRates, Stages, State};
use crate::simulation::lanes::pulses::Pulses;
use crate::simulation::lanes::{Lane, Stance};
use crate::simulation::outputs::Channels;
use crate::simulation::peaks::Peaks;
use crate::system::evaluation::{self, Evaluation, ForcingAt};
use crate::system::events::{ROUNDING, landing, lift_off, quarter_turn};
use crate::system::instant::Footing;
use crate::system::motion_mode::{Gripping, MotionMode};

/// Round-off of the zero of each event function.
struct Rounding<V> {
    reaction: Wide<V>,
    gap: Wide<V>,
    quarter_turn: Wide<V>,
}

/// The supports of lifted corners: depth (m), beginning (s) of creep, free height (m).
struct LiftedSupports<V> {
    depth: Wide<V>,
    since: Wide<V>,
    free_height: Wide<V>,
}

/// A step in all lanes.
pub struct StepBatch {
    /// A bit for each lane in which the step was taken. The numbers of other lanes are meaningless.
    pub taken: u32,
    /// The states at its end.
    pub state: [Array; 4],
    /// The works of the excitation and of the dashpots since the start of the run.
    pub sums: [Array; 2],
    /// Peaks of θ, N, H, uplift and friction demand since then.
    pub peaks: [Array; 5],
    /// A bit for each lane in which the step made too great an error.
    pub failed: u32,
    /// A bit for each accurate short step that may hold an event or a peak.
    pub eventful: u32,
    /// The accurate steps of order 8 with a possible event or peak, and their lanes.
    pub accepted: Vec<(usize, DenseStep)>,
    /// The factor by which the size of a short step may change. For a step of order 8 it is the root of its error, from which the factor
    /// follows.
    pub root: Array,
}

/// Takes a step of each run of a group: short, or of order 8. A group has at least one run and at most one per lane.
pub fn step(width: VectorWidth, stance: Stance, short: bool, group: &[Box<Lane>]) -> StepBatch {
    let count = group.len();
    let mut runs: [&Lane; MAX_LANES] = [&group[count - 1]; MAX_LANES];
    for (lane, run) in group.iter().enumerate() {
        runs[lane] = run;
    }
    let some;
    let pulses = if runs.iter().any(|run| run.wave.is_some()) {
        some = Pulses::of(width, short, &runs);
        &some
    } else {
        &Pulses::NONE
    };
    match stance {
        Stance::FullContact => {
            width.run(StepTask { mode: Gripping::<true, true, false>, stance, short, runs, count, pulses })
        }
        Stance::OnLeft => {
            width.run(StepTask { mode: Gripping::<true, false, false>, stance, short, runs, count, pulses })
        }
        Stance::OnRight => {
            width.run(StepTask { mode: Gripping::<false, true, false>, stance, short, runs, count, pulses })
        }
    }
}

/// The step of a group under a mode. The method is chosen at run time: a copy of the code
/// around the stages for each method would double the compile time.
struct StepTask<'g, L> {
    mode: L,
    /// How the blocks stand under this mode.
    stance: Stance,
    /// Whether the step is a short one.
    short: bool,
    /// The runs of the lanes; lanes beyond the group repeat its last run.
    runs: [&'g Lane; MAX_LANES],
    /// The number of runs in the group.
    count: usize,
    /// Their pulses.
    pulses: &'g Pulses,
}

/// The blocks of a group and their excitations without pulses, one per lane.
struct Group<V> {
    body: Body<Wide<V>>,
    excitation: Excitation<Wide<V>>,
    footing: Footing<Wide<V>>,
}

/// The excitation of a group at an end of a step, and its forcing there.
type Driven<V> = (Excitation<Wide<V>>, Forcing<Wide<V>>);

/// The motion of a group under a mode.
struct GroupMotion<'m, V, L> {
    mode: L,
    group: &'m Group<V>,
    pulses: &'m Pulses,
}

impl<'m, V: Simd, L: MotionMode> GroupMotion<'m, V, L> {
    #[inline(always)]
    fn at(
        &self,
        forcing_at: ForcingAt<'m, Wide<V>>,
        state: [Wide<V>; 4],
        support_heights: [Dual<Wide<V>>; 2],
    ) -> Evaluation<'m, Wide<V>> {
        let Group { body, footing, .. } = self.group;
        Evaluation::of(self.mode, body, forcing_at, *footing, Numbers(state), support_heights)
    }

    /// Includes the peaks at the ends of a step. Returns the lanes in which a peak may be inside.
    #[inline(always)]
    fn raise_peaks(
        &self,
        peaks: &mut Peaks<Wide<V>>,
        here: &Evaluation<Wide<V>>,
        there: &Evaluation<Wide<V>>,
        duration: Wide<V>,
        longest: Wide<V>,
    ) -> u32 {
        let near = near_a_peak(duration, longest);
        let close = peaks.are_near(here, near).or(peaks.are_near(there, near));
        let (mut start, mut end) = (here.cheap_channels(), there.cheap_channels());
        if close.any() {
            start = in_lanes(close, here.channels(), start);
            end = in_lanes(close, there.channels(), end);
        }
        let inside = peaks.may_rise_inside(&start, &end, duration);
        peaks.include_ends(&start, &end);
        inside.bits()
    }

    /// The lanes in which the functions of L, R and the quarter turn may fall through zero between two instants.
    ///
    /// These are the functions of [`watched`](crate::system::events::watched) under the modes of lanes.
    #[inline(always)]
    fn may_fall(
        &self,
        here: &Evaluation<Wide<V>>,
        there: &Evaluation<Wide<V>>,
        duration: Wide<V>,
        rounding: &Rounding<V>,
    ) -> [u32; 3] {
        let remaining =
            |at: &Evaluation<Wide<V>>| quarter_turn::remaining_angle([at.instant.theta, at.instant.theta_dot]);
        [
            self.corner_may_change(Corner::Left, here, there, duration, rounding),
            self.corner_may_change(Corner::Right, here, there, duration, rounding),
            may_fall_by_bounds(remaining(here), remaining(there), rounding.quarter_turn, duration).bits(),
        ]
    }

    /// The lanes in which a corner may leave its support or come down on it between two instants.
    #[inline(always)]
    fn corner_may_change(
        &self,
        corner: Corner,
        here: &Evaluation<Wide<V>>,
        there: &Evaluation<Wide<V>>,
        duration: Wide<V>,
        rounding: &Rounding<V>,
    ) -> u32 {
        if self.mode.regime().touches(corner) {
            let reaction = |at: &Evaluation<Wide<V>>| lift_off::on_support(at.body, &at.instant, corner);
            may_fall_by_bounds(reaction(here), reaction(there), rounding.reaction, duration).bits()
        } else {
            let gap = |at: &Evaluation<Wide<V>>| landing::gap(&at.instant, at.support_heights, corner);
            may_fall_by_bounds(gap(here), gap(there), rounding.gap, duration).bits()
        }
    }

    /// The lanes in which a block rests under ground that does not change, see [`Evaluation::rests`].
    #[inline(always)]
    fn rests(&self, here: &Evaluation<Wide<V>>, rounding: &Rounding<V>) -> u32 {
        if self.mode.regime() != Regime::FullContact {
            return 0;
        }
        let [accelerations, rates] = here.rest_residuals();
        let (accelerates, moves) = (rounding.reaction.less(accelerations), rounding.reaction.less(rates));
        let (zero, rate) = (Wide::default(), here.forcing_rate());
        let changes = zero.less(rate.x.abs()).or(zero.less(rate.z.abs()));
        !accelerates.or(moves).or(changes).bits()
    }
}

impl<V: Simd, L: MotionMode> Stages<Wide<V>> for GroupMotion<'_, V, L> {
    #[inline(always)]
    fn rate_at(&self, stage: usize, time: Wide<V>, state: &State<Wide<V>>) -> Rate<Wide<V>> {
        let Group { body, excitation, footing } = self.group;
        let forcing = excitation.at_with(Wide::load(&self.pulses.stages[stage]), time);
        evaluation::rate(self.mode, body, forcing, *footing, state)
    }
}

/// The lanes in which a short step keeps within a `fraction` of the allowed error. It has this [`short::squared_error`]. Returns also the
/// factors by which the sizes of the others may change.
#[inline(always)]
fn within_error<V: Simd>(squared: Wide<V>, size: Wide<V>, fraction: Wide<V>) -> (u32, Wide<V>) {
    // Three roots and two quotients take long, and errors are rarely so great that they decide.
    if (squared * (size * size)).less(fraction * fraction * 0.5).all() {
        return (u32::MAX, fraction);
    }
    let error = size * squared.sqrt() / fraction;
    let factor = short_factor(error);
    (error.less(Wide::from(f64::INFINITY)).bits() & !factor.less(Wide::from(1.0)).bits(), factor)
}

/// Some channels in some lanes, others elsewhere.
#[inline(always)]
fn in_lanes<V: Simd>(
    lanes: Lanes<V>,
    some: Channels<Dual<Wide<V>>>,
    others: Channels<Dual<Wide<V>>>,
) -> Channels<Dual<Wide<V>>> {
    Channels {
        theta: pick(lanes, some.theta, others.theta),
        reaction: [
            pick(lanes, some.reaction[0], others.reaction[0]),
            pick(lanes, some.reaction[1], others.reaction[1]),
        ],
        horizontal: pick(lanes, some.horizontal, others.horizontal),
        uplift: [pick(lanes, some.uplift[0], others.uplift[0]), pick(lanes, some.uplift[1], others.uplift[1])],
        friction_demand: pick(lanes, some.friction_demand, others.friction_demand),
    }
}

#[inline(always)]
fn pick<V: Simd>(lanes: Lanes<V>, some: Dual<Wide<V>>, other: Dual<Wide<V>>) -> Dual<Wide<V>> {
    Dual::new(lanes.choose(some.re, other.re), lanes.choose(some.eps, other.eps))
}

impl<L: MotionMode> StepTask<'_, L> {
    /// Four numbers of each lane.
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "`zip` is not inlined")]
    fn transposed<V: Simd>(&self, of: impl Fn(&Lane) -> &Four) -> [Wide<V>; 4] {
        let mut rows = [of(self.runs[0]); MAX_LANES];
        for lane in 1..V::LANES {
            rows[lane] = of(self.runs[lane]);
        }
        Wide::columns(rows)
    }

    /// Heights of the supports that nothing touches, and their rates; zeros for the others. As `Creep::top` finds them.
    #[inline(always)]
    fn support_heights<V: Simd>(&self, time: Wide<V>, lifted: &LiftedSupports<V>, rate: Wide<V>) -> [Dual<Wide<V>>; 2] {
        let mut heights = [Dual::default(); 2];
        if let Some(standing) = self.mode.regime().pivot() {
            let LiftedSupports { depth, since, free_height } = *lifted;
            let elapsed = time - since;
            let (zero, exponent) =
                (Wide::default(), rate * Wide::default().less(elapsed).choose(elapsed, Wide::default()));
            let recovered = Wide::from(RECOVERED).less(exponent);
            let (depth, exponent) = (recovered.choose(zero, depth), recovered.choose(zero, exponent));
            let sunk = if zero.less(depth.abs()).any() { depth * (-exponent).exp() } else { zero };
            heights[standing.other().index()] = Dual::new(free_height - sunk, rate * sunk);
        }
        heights
    }

    #[inline(always)]
    fn lifted<V: Simd>(&self) -> LiftedSupports<V> {
        let [depth, since, _, free_height] = self.transposed(|lane| &lane.transposed.lifted);
        LiftedSupports { depth, since, free_height }
    }

    /// The excitations at both ends of the step, and their forcings at these times.
    #[inline(always)]
    fn ends<V: Simd>(&self, group: &Group<V>, [start, end]: [Wide<V>; 2]) -> [Driven<V>; 2] {
        let (pulses, excitation) = (self.pulses, group.excitation);
        [
            (
                excitation.with_rate(Wide::load(&pulses.rates[0])),
                excitation.at_with(Wide::load(&pulses.stages[0]), start),
            ),
            (excitation.with_rate(Wide::load(&pulses.rates[1])), excitation.at_with(Wide::load(&pulses.end), end)),
        ]
    }

    #[inline(always)]
    fn rounding<V: Simd>(&self, group: &Group<V>, gap: Wide<V>) -> Rounding<V> {
        Rounding { reaction: group.body.gravity * ROUNDING, gap, quarter_turn: Wide::from(ROUNDING * FRAC_PI_2) }
    }

    #[inline(always)]
    fn group<V: Simd>(&self) -> Group<V> {
        let [mass, gravity, r0, b] = self.transposed(|lane| &lane.transposed.body[0]);
        let [h, omega_v, xi_v, i0] = self.transposed(|lane| &lane.transposed.body[1]);
        let [eccentricity, left, right, offset] = self.transposed(|lane| &lane.transposed.body[2]);
        let [_, _, _, p] = self.transposed(|lane| &lane.transposed.limits);
        let [_, _, creep_rate, _] = self.transposed(|lane| &lane.transposed.lifted);
        let body = Body {
            mass,
            i0,
            gravity,
            r0,
            b,
            h,
            eccentricity,
            weight_fraction: [left, right],
            p,
            foundation: Foundation::Viscoelastic,
            omega_v,
            xi_v,
            creep_rate,
            // Blocks with friction or restraints are not stepped in lanes.
            friction: Wide::default(),
            restraints: Restraints::none(),
        };
        let [time, x, x_rate, z] = self.transposed(|lane| &lane.transposed.ground);
        let z_rate = Wide::each(|lane| self.runs[lane].transposed.vertical_rate);
        let ground = [Ramp { value: x, rate: x_rate }, Ramp { value: z, rate: z_rate }];
        Group { body, excitation: Excitation::of_ground(time, ground), footing: Footing::Grips { offset } }
    }
}

impl<L: MotionMode> Task for StepTask<'_, L> {
    type Output = StepBatch;

    #[inline(always)]
    fn run<V: Simd>(self) -> StepBatch {
        let group = self.group::<V>();
        let motion = GroupMotion { mode: self.mode, group: &group, pulses: self.pulses };
        let stance = self.stance.index();
        let weights = Numbers(self.transposed(|lane| &lane.limits[stance].weights.0));
        let [work_weight, fraction, gap_rounding, _] = self.transposed(|lane| &lane.transposed.limits);
        let rounding = self.rounding(&group, gap_rounding);
        let [time, end_time, size, longest] = self.transposed(|lane| &lane.transposed.step);
        let state = Numbers(self.transposed(|lane| &lane.simulation.run.pose.state.0));
        let [input, dashpots, friction_demand, _] = self.transposed(|lane| &lane.transposed.sums);
        let [theta, reaction, horizontal, uplift] = self.transposed(|lane| &lane.transposed.peaks);
        let mut peaks = Peaks::of_channels([theta, reaction, horizontal, uplift, friction_demand]);

        let lifted = self.lifted();
        let [start, stop] = self.ends(&group, [time, end_time]);
        let forcing_at = ForcingAt { excitation: &start.0, time, forcing: start.1 };
        let here = motion.at(forcing_at, state.0, self.support_heights(time, &lifted, group.body.creep_rate));
        let infinite = Wide::from(f64::INFINITY);
        let (end, work, of_stages);
        let mut rates = None;
        if self.short {
            let mut rates = StageRates::beginning_with(here.rate);
            (end, work) = short::attempt_in_loop(time, size, state, &mut rates, &motion);
            of_stages = short::difference(&rates);
        } else {
            let rates = rates.insert(StageRates::beginning_with(here.rate));
            (end, work) = dop853::attempt_in_loop(time, size, state, rates, &motion);
            of_stages = Rate::default();
        }
        let forcing_at = ForcingAt { excitation: &stop.0, time: end_time, forcing: stop.1 };
        let there = motion.at(forcing_at, end.0, self.support_heights(end_time, &lifted, group.body.creep_rate));
        let (error_is_fine, root) = match &rates {
            // Its error depends on the rate at its end, too.
            None => {
                let squared = short::squared_error(of_stages, there.rate, weights, work_weight);
                within_error(squared, size, fraction)
            }
            Some(rates) => {
                let error = dop853::error(rates, size, weights);
                (error.less(infinite).bits() & !Wide::from(1.0).less(error).bits(), eighth_root(error))
            }
        };

        let duration = end_time - time;
        let mut moves = Wide::default().less(duration);
        for i in 0..4 {
            let finite = there.state[i].abs().less(infinite).and(there.rate.state.0[i].abs().less(infinite));
            moves = moves.and(finite);
        }
        let rests = motion.rests(&here, &rounding);
        let [left, right, turn] = motion.may_fall(&here, &there, duration, &rounding);
        let events = left | right | turn;
        let usual = error_is_fine & moves.bits() & !rests;

        let inside = motion.raise_peaks(&mut peaks, &here, &there, duration, longest);
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = peaks;
        let runs = ((1_u64 << self.count) - 1) as u32;
        let eventful = usual & (events | inside) & runs;
        let mut accepted = Vec::new();
        if let Some(rates) = &rates {
            for lane in 0..self.count {
                if eventful >> lane & 1 == 1 {
                    accepted.push((lane, DenseStep::of_lane(lane, [time, size], [state, end], work, rates)));
                }
            }
        }
        StepBatch {
            taken: usual & !(events | inside) & runs,
            eventful: if self.short { eventful } else { 0 },
            accepted,
            failed: !error_is_fine & !rests & runs,
            state: [end.0[0].store(), end.0[1].store(), end.0[2].store(), end.0[3].store()],
            sums: [(input + work.0[0]).store(), (dashpots + work.0[1]).store()],
            peaks: [theta.store(), reaction.store(), horizontal.store(), uplift.store(), friction_demand.store()],
            root: root.store(),
        }
    }
}

#[cfg(test)]
mod tests;
