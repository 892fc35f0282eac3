//! A swing of several runs on the rigid base, one in each lane: the operations of
//! [`Simulation`](crate::simulation::Simulation) in their order.

use crate::block::Body;
use crate::excitation::Excitation;
use crate::numerics::control::is_resolved;
use crate::numerics::scalar::{Real, Runs};
use crate::numerics::wide::{Array, Lanes, MAX_LANES, Simd, Task, VectorWidth, Wide};
use crate::simulation::Simulation;
use crate::simulation::force_peaks::{ForcePeaks, PRESSED, visible};
use crate::simulation::lanes::{BatchKind, Lane, NextStep};
use crate::simulation::state::Committed;
use crate::simulation::swings::{EVALUATIONS_PER_SWING, SwingForces, UPRIGHT, allowed_error, longest_swing};
use crate::system::instant::State;
use crate::system::swing::lanes::Swings;
use crate::system::swing::{Bounds, Pivoting, Swing};

/// The quantities of a run on the rigid base for its swings in a lane.
#[derive(Clone, Debug)]
pub struct LaneSwing {
    /// The excitation of the present piece.
    pub excitation: Excitation,
    /// The longest swing in it (s).
    longest: f64,
    /// The allowed error of θ̇ (rad/s per second of the swing).
    allowed: f64,
    /// Horizontal distance of the centre of mass from the pivot of the upright block (m).
    offset: f64,
    /// The sign of a rotation away from the base.
    away: f64,
    /// See [`visible`].
    visible: f64,
}

impl LaneSwing {
    pub fn of(simulation: &Simulation) -> LaneSwing {
        let mut swing = LaneSwing {
            excitation: Excitation::none(),
            longest: 0.0,
            allowed: allowed_error(simulation.block(), simulation.setup.settings.tolerance),
            offset: 0.0,
            away: 0.0,
            visible: visible(simulation.setup.settings.tolerance),
        };
        swing.set_pivot(simulation);
        swing
    }

    /// Adopts the pivot of a run.
    #[inline]
    pub fn set_pivot(&mut self, simulation: &Simulation) {
        if let Some(pivot) = simulation.run.pose.contacts.regime().pivot() {
            (self.offset, self.away) = (simulation.block().offset(pivot), -pivot.sign());
        }
    }

    /// Adopts the excitation of a new piece.
    #[inline(always)]
    pub fn begin_piece(&mut self, body: &Body, excitation: &Excitation) {
        self.longest = longest_swing(body.p, excitation.frequency());
        self.excitation.adopt(excitation);
    }
}

/// Swings in all lanes.
pub struct SwingBatch {
    /// A bit for each lane in which the swing was taken. The numbers of other lanes are meaningless.
    pub taken: u32,
    /// A bit for each of them that ends with a landing.
    lands: u32,
    /// Times (s), θ and θ̇ at their ends.
    end: [Array; 3],
    /// The works of the excitation since the start of the run.
    input: Array,
    /// The greatest rotations (rad) inside that are peaks, or zeros.
    highest: Array,
    /// Peaks of N, H and friction demand, without those at the ends.
    peaks: [Array; 3],
    /// Evaluations of the equations of motion for these peaks.
    evaluations: Array,
    /// The swings of the lanes in which they were not taken.
    pub known: [Option<Box<Swing>>; MAX_LANES],
}

/// Takes a swing of each run of a group. It has at least one run, and at most one per lane.
pub fn swing(width: VectorWidth, is_wave: bool, group: &[Box<Lane>]) -> SwingBatch {
    let count = group.len();
    let mut runs: [&Lane; MAX_LANES] = [&group[count - 1]; MAX_LANES];
    for (lane, run) in group.iter().enumerate() {
        runs[lane] = run;
    }
    width.run(GroupSwing { is_wave, runs, count })
}

/// The swing of a group.
struct GroupSwing<'g> {
    /// Whether pulses act, or an excitation linear in time alone.
    is_wave: bool,
    /// The runs of the lanes; lanes beyond the group repeat its last run.
    runs: [&'g Lane; MAX_LANES],
    /// The number of runs in the group.
    count: usize,
}

impl GroupSwing<'_> {
    /// A number of each lane.
    #[inline(always)]
    fn each<V: Simd>(&self, number: impl Fn(&Lane) -> f64) -> Wide<V> {
        Wide::each(|lane| number(self.runs[lane]))
    }
}

impl Task for GroupSwing<'_> {
    type Output = SwingBatch;

    #[inline(always)]
    fn run<V: Simd>(self) -> SwingBatch {
        let pivoting = Pivoting::<Wide<V>> {
            offset: self.each(|lane| lane.swing.offset),
            h: self.each(|lane| lane.block().h),
            i0: self.each(|lane| lane.block().i0),
            gravity: self.each(|lane| lane.block().gravity),
            away: self.each(|lane| lane.swing.away),
        };
        let excitation = Excitation::in_lanes(self.is_wave, |lane| &self.runs[lane].swing.excitation);
        let (time, stop) = (self.each(|lane| lane.simulation.run.pose.time), self.each(|lane| lane.stop));
        let start =
            [self.each(|lane| lane.simulation.run.pose.state[0]), self.each(|lane| lane.simulation.run.pose.state[1])];
        let remaining = stop - time;
        let most: Wide<V> = self.each(|lane| lane.swing.longest);
        let longest = remaining.less(most).choose(remaining, most);
        let mut swings = Swings::under(&excitation, time);
        swings.make(&pivoting, start, longest, self.each(|lane| lane.swing.allowed));
        let bounds = swings.series.bounds(&pivoting);

        let (zero, infinite) = (Wide::default(), Wide::from(f64::INFINITY));
        let Ends { lands, fraction, is_decided } = Ends::of(&swings, &bounds, pivoting.away);
        let size = swings.series.size;
        let ends_before = size.less(remaining).or(remaining.less(size)).or(lands);
        let end_time = ends_before.choose(time + fraction * size, stop);
        let advances = time.less(end_time);
        let [theta, theta_dot] = swings.series.at(fraction);
        let is_finite = theta.abs().less(infinite).and(theta_dot.abs().less(infinite));
        let usual = is_decided.and(advances).and(is_finite);

        let peak_theta: Wide<V> = self.each(|lane| lane.simulation.run.peaks.theta);
        let (highest, mut taken) = highest_rotation(usual, &swings, &bounds, pivoting.away, fraction, peak_theta);
        let mass: Wide<V> = self.each(|lane| lane.block().mass);
        let mut peaks = ForcePeaks {
            reaction: self.each(|lane| lane.simulation.run.peaks.reaction),
            horizontal: self.each(|lane| lane.simulation.run.peaks.horizontal),
            friction_demand: self.each(|lane| lane.simulation.run.peaks.friction_demand),
            evaluations: zero,
        };
        let others = taken.except(peaks.are_above(bounds.reaction, bounds.horizontal, [mass, pivoting.gravity]));
        if others.any() {
            let swing = &swings.series;
            let segments = SwingForces { pivoting: &pivoting, mass, excitation: &excitation, time, swing, fraction };
            let (forces, pressed) = (swing.forces(fraction, pivoting.gravity), pivoting.gravity * PRESSED);
            let mut holds = others;
            for &[n, _] in forces.coefficients() {
                holds = holds.and(pressed.less(n));
            }
            let visible = self.each(|lane| lane.swing.visible);
            // The next swing begins with the forces at the end.
            let with_end = holds.except(ends_before.except(lands));
            let known = peaks.raise(holds, &segments, &forces, [mass, visible], with_end);
            taken = taken.except(others.except(known));
        }

        let runs = ((1_u64 << self.count) - 1) as u32;
        let taken = taken.bits() & runs;
        let made = bounds.theta.less(infinite).and(zero.less(size)).bits() & runs;
        let mut known = [const { None }; MAX_LANES];
        for (lane, known) in known.iter_mut().enumerate().take(self.count) {
            if (made & !taken) >> lane & 1 == 1 {
                *known = Some(Box::new(swings.of_lane(lane)));
            }
        }
        let input = self.each::<V>(|lane| lane.simulation.run.sums.input) + swings.work(fraction);
        SwingBatch {
            taken,
            lands: taken & lands.bits(),
            end: [end_time.store(), theta.store(), theta_dot.store()],
            input: input.store(),
            highest: highest.store(),
            peaks: [peaks.reaction.store(), peaks.horizontal.store(), peaks.friction_demand.store()],
            evaluations: peaks.evaluations.store(),
            known,
        }
    }
}

/// The ends of swings, as far as the rotation decides them.
struct Ends<V: Simd> {
    /// The lanes in which the block comes down.
    lands: Lanes<V>,
    /// The fraction of the swing up to there; 1 elsewhere.
    fraction: Wide<V>,
    /// The lanes in which this is clear, and the block stays upright.
    is_decided: Lanes<V>,
}

impl<V: Simd> Ends<V> {
    #[inline(always)]
    fn of(swings: &Swings<V>, bounds: &Bounds<Wide<V>>, away: Wide<V>) -> Ends<V> {
        let zero = Wide::default();
        let mut lands = bounds.is_certain.and(bounds.last.less(zero));
        let mut fraction = if lands.any() { swings.series.landing(lands) } else { Wide::from(1.0) };
        let mut is_decided = bounds.is_certain;
        let others = zero.less(swings.series.size).except(is_decided);
        if others.any() {
            let (stays, comes_down, after) = swings.first_landing(others, away);
            is_decided = is_decided.or(stays).or(comes_down);
            (lands, fraction) = (lands.or(comes_down), comes_down.choose(after, fraction));
        }
        let turned = is_decided.except(bounds.theta.less(Wide::from(UPRIGHT)));
        if turned.any() {
            is_decided = is_decided.except(turned.except(swings.excludes_quarter_turn(away)));
        }
        Ends { lands, fraction, is_decided }
    }
}

/// Returns the greatest rotations (rad) in some lanes, and where they are known. They lie inside the swings, up to a fraction, and are zero
/// where they do not exceed their `peak`.
#[inline(always)]
fn highest_rotation<V: Simd>(
    lanes: Lanes<V>,
    swings: &Swings<V>,
    bounds: &Bounds<Wide<V>>,
    away: Wide<V>,
    fraction: Wide<V>,
    peak: Wide<V>,
) -> (Wide<V>, Lanes<V>) {
    let may_turn = lanes.except(bounds.is_greatest_at_end.or(bounds.theta.less(peak)));
    if !may_turn.any() {
        return (Wide::default(), lanes);
    }
    let turns_back = may_turn.and(bounds.turns_back);
    let (place, has_peak) = swings.series.top(turns_back, away, fraction, peak);
    let highest = has_peak.choose(swings.series.theta_at(place)[0].abs(), Wide::default());
    let others = may_turn.except(turns_back);
    if !others.any() {
        return (highest, lanes);
    }
    let (top, known) = swings.highest(others, away, fraction, peak);
    (others.choose(top, highest), lanes.except(others.except(known)))
}

impl Lane {
    /// Comes to the end of a swing.
    #[inline]
    pub(super) fn arrive_by_swing(&mut self, batch: &SwingBatch, lane: usize) {
        let Lane { simulation: Simulation { setup, run }, next, budget, .. } = self;
        let [end, theta, theta_dot] = [batch.end[0][lane], batch.end[1][lane], batch.end[2][lane]];
        run.peaks.include_rotation(batch.highest[lane], &setup.system.block);
        run.peaks.include_rotation(theta.abs(), &setup.system.block);
        let [reaction, horizontal, friction_demand] = batch.peaks;
        let peaks = &mut run.peaks;
        (peaks.reaction, peaks.horizontal, peaks.friction_demand) =
            (reaction[lane], horizontal[lane], friction_demand[lane]);
        run.commit(Committed {
            time: end.max(run.pose.time),
            state: State::from([theta, theta_dot, 0.0, 0.0]),
            footing: run.pose.footing,
            works: [batch.input[lane], run.sums.dashpots],
            evaluations: EVALUATIONS_PER_SWING + batch.evaluations[lane] as u64,
        });
        *next = match run.pose.contacts.regime().pivot() {
            Some(pivot) if batch.lands >> lane & 1 == 1 => NextStep::Landing(pivot),
            Some(_) | None => NextStep::Open { begins_piece: false },
        };
        *budget -= 1;
    }

    /// The kind of the next swing, if a lane can take it.
    #[inline]
    pub(super) fn swing_kind(&self) -> Option<BatchKind> {
        let LaneSwing { excitation, longest, away, .. } = &self.swing;
        let remaining = self.stop - self.simulation.run.pose.time;
        let can = excitation.has_series() && self.budget > 0 && is_resolved(self.simulation.run.pose.time, *longest);
        // Without an excitation, and as if at the base all the time.
        let [theta, theta_dot, ..] = self.simulation.run.pose.state.0;
        let (size, p, alpha) = (remaining.min(*longest), self.block().p, self.block().alpha);
        let last = away * (theta + theta_dot * size) - 0.5 * alpha * p * p * size * size;
        can.then(|| BatchKind::Swing { is_wave: !excitation.is_linear(), lands: last < 0.0 })
    }
}
