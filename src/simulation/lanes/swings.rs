//! A swing of several runs on the rigid base, one in each lane: the operations of
//! [`Simulation`](crate::simulation::Simulation) in their order.

use crate::block::{Block, Corner};
use crate::excitation::Excitation;
use crate::numerics::Real;
use crate::numerics::control::is_resolved;
use crate::numerics::wide::{Array, MOST_LANES, Simd, Task, VectorWidth, Wide};
use crate::simulation::Simulation;
use crate::simulation::lanes::{Kind, Lane};
use crate::simulation::rigid_base::{PRESSED, UPRIGHT, allowed_error, longest_swing};
use crate::system::events::Surface;
use crate::system::instant::State;
use crate::system::swing::Swing;
use crate::system::swing::lanes::{Pivoting, Swings};

/// What a run on the rigid base needs for a swing in a lane.
#[derive(Clone, Debug)]
pub struct Swinging {
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
    /// The pivot at which the last swing in a lane has ended, where the block comes down on the other corner.
    landing: Option<Corner>,
    /// The swing that comes next, if a lane has made it.
    pub known: Option<Box<Swing>>,
}

impl Swinging {
    pub fn of(simulation: &Simulation) -> Swinging {
        let mut swinging = Swinging {
            excitation: Excitation::none(),
            longest: 0.0,
            allowed: allowed_error(simulation.block(), simulation.settings.tolerance),
            offset: 0.0,
            away: 0.0,
            landing: None,
            known: None,
        };
        swinging.turn(simulation);
        swinging
    }

    /// Adopts the pivot of a run.
    #[inline]
    pub fn turn(&mut self, simulation: &Simulation) {
        if let Some(pivot) = simulation.pose.contacts.regime().pivot() {
            (self.offset, self.away) = (simulation.block().offset(pivot), -pivot.sign());
        }
    }

    /// Adopts the excitation of a new piece.
    #[inline]
    pub fn begin_piece(&mut self, block: &Block, excitation: Excitation) {
        self.longest = longest_swing(block.p, excitation.frequency());
        self.excitation = excitation;
    }
}

/// Swings in all lanes.
pub struct Swung {
    /// A bit for each lane in which the swing was taken; the numbers of the other lanes are meaningless.
    pub taken: u32,
    /// A bit for each of them that ends with a landing.
    lands: u32,
    /// Times (s), θ and θ̇ at their ends.
    end: [Array; 3],
    /// The works of the excitation since the start of the run.
    input: Array,
    /// The swings of the lanes in which they were not taken, with the lanes.
    pub known: Vec<(usize, Swing)>,
}

/// Takes a swing of each run of a group, which has at least one run and at most one per lane.
pub fn swing(width: VectorWidth, is_wave: bool, group: &[Box<Lane>]) -> Swung {
    let count = group.len();
    let mut runs: [&Lane; MOST_LANES] = [&group[count - 1]; MOST_LANES];
    for (place, run) in runs.iter_mut().zip(group) {
        *place = run;
    }
    width.run(Together { is_wave, runs, count })
}

/// The swing of a group.
struct Together<'g> {
    /// Whether pulses act, or only what is linear in time.
    is_wave: bool,
    /// The runs of the lanes; lanes beyond the group repeat its last run.
    runs: [&'g Lane; MOST_LANES],
    /// The number of runs in the group.
    count: usize,
}

impl Together<'_> {
    /// A number of each lane.
    #[inline(always)]
    fn each<V: Simd>(&self, number: impl Fn(&Lane) -> f64) -> Wide<V> {
        Wide::each(|lane| number(self.runs[lane]))
    }
}

impl Task for Together<'_> {
    type Output = Swung;

    #[inline(always)]
    fn run<V: Simd>(self) -> Swung {
        let pivoting = Pivoting::<V> {
            offset: self.each(|lane| lane.swinging.offset),
            h: self.each(|lane| lane.block().h),
            i0: self.each(|lane| lane.block().i0),
            gravity: self.each(|lane| lane.block().gravity),
            away: self.each(|lane| lane.swinging.away),
        };
        let excitation = Excitation::in_lanes(self.is_wave, |lane| &self.runs[lane].swinging.excitation);
        let (time, stop) = (self.each(|lane| lane.simulation.pose.time), self.each(|lane| lane.stop));
        let start = [self.each(|lane| lane.simulation.pose.state[0]), self.each(|lane| lane.simulation.pose.state[1])];
        let remaining = stop - time;
        let most: Wide<V> = self.each(|lane| lane.swinging.longest);
        let longest = remaining.in_lanes(remaining.less(most), most);
        let mut swings = Swings::under(&excitation, time);
        swings.make(&pivoting, start, longest, self.each(|lane| lane.swinging.allowed));
        let bounds = swings.bounds(&pivoting);

        let (zero, infinite) = (Wide::default(), Wide::from(f64::INFINITY));
        let lands = bounds.is_certain.and(bounds.last.less(zero));
        let part = if lands.any() { swings.landing(lands) } else { Wide::from(1.0) };
        let size = swings.size();
        let continues = size.less(remaining).or(remaining.less(size)).or(lands);
        let end_time = (time + part * size).in_lanes(continues, stop);
        let advances = lands.or(time.less(end_time));
        let known = bounds.is_certain.and(bounds.theta.less(Wide::from(UPRIGHT))).and(advances);

        let mass: Wide<V> = self.each(|lane| lane.block().mass);
        let peak_theta: Wide<V> = self.each(|lane| lane.simulation.peaks.theta);
        let peak_demand: Wide<V> = self.each(|lane| lane.simulation.peaks.friction_demand);
        let [least, greatest] = bounds.reaction;
        let is_below_peaks = (pivoting.gravity * PRESSED)
            .less(least)
            .and((greatest * mass).less(self.each(|lane| lane.simulation.peaks.reaction)))
            .and((bounds.horizontal * mass).less(self.each(|lane| lane.simulation.peaks.horizontal)))
            .and(bounds.horizontal.less(peak_demand * least));
        let no_turn = bounds.is_monotone.or(bounds.theta.less(peak_theta));
        let [theta, theta_dot] = swings.at(part);
        let is_finite = theta.abs().less(infinite).and(theta_dot.abs().less(infinite));

        let runs = ((1_u64 << self.count) - 1) as u32;
        let taken = known.and(is_below_peaks).and(no_turn).and(is_finite).bits() & runs;
        let made = bounds.theta.less(infinite).and(zero.less(size)).bits() & runs;
        let mut known = Vec::new();
        for lane in 0..self.count {
            if (made & !taken) >> lane & 1 == 1 {
                known.push((lane, swings.of_lane(lane)));
            }
        }
        let input = self.each::<V>(|lane| lane.simulation.sums.input) + swings.work(part);
        Swung {
            taken,
            lands: taken & lands.bits(),
            end: [end_time.store(), theta.store(), theta_dot.store()],
            input: input.store(),
            known,
        }
    }
}

impl Lane {
    /// Comes to the end of a swing.
    #[inline]
    pub(super) fn arrive_by_swing(&mut self, swung: &Swung, lane: usize) {
        let Lane { simulation, swinging, begins, budget, .. } = self;
        let [end, theta, theta_dot] = [swung.end[0][lane], swung.end[1][lane], swung.end[2][lane]];
        simulation.counts.evaluations += 1;
        simulation.counts.steps += 1;
        simulation.raise_rotation(theta.abs());
        simulation.sums.input = swung.input[lane];
        simulation.pose.state = State::from([theta, theta_dot, 0.0, 0.0]);
        if end > simulation.pose.time {
            (simulation.pose.time, simulation.events_in_this_instant) = (end, 0);
        }
        swinging.landing = if swung.lands >> lane & 1 == 1 { simulation.pose.contacts.regime().pivot() } else { None };
        *begins = false;
        *budget -= 1;
    }

    /// The kind of the swing that comes next, if it can be taken in a lane.
    #[inline]
    pub(super) fn swing_kind(&self) -> Option<Kind> {
        let Swinging { excitation, longest, .. } = &self.swinging;
        let remaining = self.stop - self.simulation.pose.time;
        let can = excitation.has_series() && self.budget > 0 && is_resolved(remaining, *longest);
        (can && !self.goes_far()).then(|| Kind::Swing { is_wave: !excitation.is_linear() })
    }

    /// Whether the rest of the piece takes several swings. Between frequent stops most swings end without a peak or an event; long ones hold
    /// them, and are faster one after the other in the same run.
    #[inline]
    pub(super) fn goes_far(&self) -> bool {
        self.stop - self.simulation.pose.time > self.swinging.longest
    }

    /// Whether the block has come down in a lane, and its impact is to be applied.
    #[inline]
    pub(super) fn is_landing(&self) -> bool {
        self.swinging.landing.is_some()
    }

    /// The event at the end of the last swing in a lane, which is to be applied.
    #[inline]
    pub(super) fn take_landing(&mut self) -> Option<Surface> {
        self.swinging.landing.take().map(|pivot| Surface::Gap(pivot.other()))
    }
}
