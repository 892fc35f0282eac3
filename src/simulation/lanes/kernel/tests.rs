//! Decisions of a lane compared with those of a single run.

use proptest::prelude::*;

use super::*;
use crate::block::{Block, Common, Dimensionless, Ratios, Supports};
use crate::block::{Contact, Contacts, Creep};
use crate::excitation::{Inputs, Pulse, PulseShape};
use crate::numerics::control::Attempt;
use crate::numerics::roots;
use crate::simulation::limits::Limits;
use crate::simulation::peaks::Peaks;
use crate::simulation::step_interior::may_contain_event;
use crate::simulation::{Initial, Settings, Simulation};
use crate::system::evaluation::Motion;
use crate::system::events::{EventFunction, watched};
use crate::system::instant;

/// What a lane finds at both ends of a step.
#[derive(Debug, Default, PartialEq)]
struct Found {
    may_contain_event: bool,
    /// The event functions of L, R and the quarter turn.
    may_fall: [bool; 3],
    rests: bool,
    may_rise_inside: bool,
    /// Bits of the peaks.
    peaks: [u64; 5],
}

/// A run before a step, and the state to which the step leads.
#[derive(Clone, Debug)]
struct Case {
    lane: Lane,
    inputs: Inputs,
    there: [f64; 4],
}

struct Look<'g, L> {
    task: StepTask<'g, L>,
    cases: &'g [Case],
}

impl<L: MotionMode> Task for Look<'_, L> {
    type Output = Vec<Found>;

    fn run<V: Simd>(self) -> Vec<Found> {
        let Look { task, cases } = self;
        let group = task.group::<V>();
        let motion = GroupMotion { mode: task.mode, group: &group, pulses: task.pulses };
        let each = |number: &dyn Fn(&Case) -> f64| Wide::<V>::each(|lane| number(&cases[lane]));
        let state = [0, 1, 2, 3].map(|i| each(&|case| case.lane.simulation.run.pose.state[i]));
        let end = [0, 1, 2, 3].map(|i| each(&|case| case.there[i]));
        let (time, end_time) = (each(&|case| case.lane.simulation.run.pose.time), each(&|case| case.lane.end_time()));
        let lifted = task.lifted();
        let [start, stop] = task.ends(&group, [time, end_time]);
        let forcing_at = ForcingAt { excitation: &start.0, time, forcing: start.1 };
        let here = motion.at(forcing_at, state, task.support_heights(time, &lifted, group.body.creep_rate));
        let there = motion.at(
            ForcingAt { excitation: &stop.0, time: end_time, forcing: stop.1 },
            end,
            task.support_heights(end_time, &lifted, group.body.creep_rate),
        );
        let [_, _, gap_rounding, _] = task.transposed(|lane| &lane.transposed.limits);
        let rounding = task.rounding(&group, gap_rounding);
        let longest = each(&|case| case.lane.longest);
        let [theta, reaction, horizontal, uplift] = task.transposed(|lane| &lane.transposed.peaks);
        let [_, _, friction_demand, _] = task.transposed(|lane| &lane.transposed.sums);
        let mut peaks = Peaks::of_channels([theta, reaction, horizontal, uplift, friction_demand]);
        let rests = motion.rests(&here, &rounding);
        let duration = end_time - time;
        let may_fall = motion.may_fall(&here, &there, duration, &rounding);
        let inside = motion.raise_peaks(&mut peaks, &here, &there, duration, longest);
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = peaks;
        let peaks = [theta, reaction, horizontal, uplift, friction_demand].map(Wide::store);
        let found = |i: usize| Found {
            may_contain_event: may_fall.iter().any(|falls| falls >> i & 1 == 1),
            may_fall: may_fall.map(|falls| falls >> i & 1 == 1),
            rests: rests >> i & 1 == 1,
            may_rise_inside: inside >> i & 1 == 1,
            peaks: peaks.map(|peak| peak[i].to_bits()),
        };
        (0..V::LANES).map(found).collect()
    }
}

fn surfaces(mode: impl MotionMode) -> [EventFunction; 3] {
    let [Some(left), Some(right), Some(quarter_turn), None] = watched(mode) else { panic!("{:?}", watched(mode)) };
    [left, right, quarter_turn]
}

impl Case {
    /// What a run finds alone.
    fn alone(&self, mode: impl MotionMode) -> Found {
        let Case { lane, inputs, there } = self;
        let Simulation { setup, run } = &lane.simulation;
        let (system, pose, mut peaks) = (&setup.system, &run.pose, run.peaks);
        let excitation = lane.simulation.excitation(inputs);
        let motion = Motion::under(mode, &system.block, pose, &excitation);
        let here = motion.at(pose.time, pose.state);
        let there = motion.at(lane.end_time(), instant::State::from(*there));
        let duration = there.time - here.time;
        let tolerance = lane.simulation.setup.settings.tolerance;
        let Limits { longest, .. } = Limits::<4>::of(&system.block, tolerance, mode, excitation.frequency());
        let [start, end] = peaks.channels_at_ends(&here, &there, near_a_peak(duration, longest));
        let may_rise_inside = peaks.may_rise_inside(&start, &end, duration);
        peaks.include(&start);
        peaks.include(&end);
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = peaks;
        Found {
            may_contain_event: may_contain_event(mode, &here, &there),
            may_fall: surfaces(mode).map(|function| {
                let (start, end) = (function.sample(&here), function.sample(&there));
                roots::may_fall_by_bounds(start, end, function.rounding(&system.block), duration)
            }),
            rests: excitation.is_constant() && here.rests(),
            may_rise_inside,
            peaks: [theta, reaction, horizontal, uplift, friction_demand].map(f64::to_bits),
        }
    }
}

/// Sizes of motions: around that below which a block rests, too.
fn small() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 2 => Just(1.0), 3 => (-13.6..-12.2).prop_map(libm::exp10)]
}

prop_compose! {
    /// Numbers of the order of 1, from which a state follows.
    fn states()(
        [theta, theta_dot, w, w_dot] in prop::array::uniform4(prop_oneof![1 => Just(0.0), 3 => -1.0..1.0]),
        leans in prop_oneof![Just(0.0), Just(1.0), Just(-1.0)],
    ) -> [f64; 5] {
        [theta, theta_dot, w, w_dot, leans]
    }
}

prop_compose! {
    /// A pulse that begins within 10 s before time zero, or none.
    fn pulse()(
        shape in prop_oneof![
            4 => Just(PulseShape::None),
            1 => Just(PulseShape::OneSine),
            1 => Just(PulseShape::C2),
            1 => Just(PulseShape::Rectangular),
            1 => Just(PulseShape::SymmetricRicker),
            1 => Just(PulseShape::AntisymmetricRicker),
            1 => Just(PulseShape::Gabor),
        ],
        (amplitude, period, before) in (-5.0..5.0, 0.2..8.0, 0.0..10.0_f64),
    ) -> Pulse {
        Pulse { shape, amplitude, period, start: -before, phase: 1.0, ..Pulse::NONE }
    }
}

prop_compose! {
    fn case(regime: Regime)(

        (alpha, p, eta, xi_v) in (0.05..0.8, 0.5..5.0, 5.0..100.0, 0.0..0.8),
        (here, there) in (states(), states()),
        scale in small(),
        (ramps, constant) in (prop::array::uniform4(-1.0..1.0), any::<bool>()),
        // Peaks that hide nothing, so that each counts by itself.
        (depth, peaks) in (0.0..1.0, prop::array::uniform5(prop_oneof![0.0..1.5, Just(1e3)])),
        (time, duration, pulse) in (0.0..10.0, 0.0..1.0, pulse()),
    ) -> Case {
        let block =
            Block::from_dimensionless(&Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) }, &Common::default()).unwrap();
        let free = block.static_deflection();
        let scale = if regime == Regime::FullContact { scale } else { 1.0 };
        // Near a quarter turn, if it leans; else as far as supports give way.
        let state = |[theta, theta_dot, w, w_dot, leans]: [f64; 5]| {
            let rate = scale * block.omega_v * free;
            let [turn, turns] = if leans == 0.0 || scale != 1.0 {
                [scale * theta * free / block.b, theta_dot * rate / block.b]
            } else {
                [leans * (FRAC_PI_2 - 0.05 + 0.05 * theta), 0.2 * block.omega_v * theta_dot]
            };
            [turn, turns, scale * w * free, w_dot * rate]
        };
        let ramp = |i: usize| {
            let rate = if constant { 0.0 } else { 10.0 * ramps[i + 1] };
            Ramp { value: scale * 5.0 * ramps[i], rate }
        };
        let inputs = Inputs { time, a_gx: ramp(0), a_gz: ramp(2), ..Inputs::default() };
        let initial = Initial::default();
        let pulse = Pulse { start: pulse.start + time, ..pulse };
        let mut simulation = Simulation::new(block, Settings::default(), pulse, &initial, time, &inputs);
        simulation.run.pose.state = instant::State::from(state(here));
        simulation.run.pose.contacts = Contacts::FULL;
        for corner in Corner::BOTH.into_iter().filter(|&corner| !regime.touches(corner)) {
            let creep = Creep { depth: depth * free, since: time - depth / block.creep_rate };
            simulation.run.pose.contacts.set(corner, Contact::Lifted(creep));
        }
        let mut lane = Lane::new(simulation, 0);
        lane.send(time + 100.0, &inputs);
        lane.next_step(&inputs);
        lane.attempt = Attempt::to_stop(duration * lane.longest);
        lane.stop = time + lane.attempt.size;
        let mut case = Case { lane, inputs, there: state(there) };
        // Peaks near those of the step.
        let of = |state: [f64; 4]| {
            let pose = &case.lane.simulation.run.pose;
            let excitation = case.lane.simulation.excitation(&inputs);
            let seen = Motion::from_pose(&block, pose, &excitation).at(time, instant::State::from(state));
            let mut peaks = Peaks::default();
            peaks.include(&seen.channels_outlined());
            peaks
        };
        let (a, b) = (of(case.lane.simulation.run.pose.state.0), of(case.there));
        case.lane.simulation.run.peaks = Peaks {
            theta: peaks[0] * a.theta.max(b.theta),
            reaction: peaks[1] * a.reaction.max(b.reaction),
            horizontal: peaks[2] * a.horizontal.max(b.horizontal),
            uplift: peaks[3] * a.uplift.max(b.uplift),
            friction_demand: peaks[4] * a.friction_demand.max(b.friction_demand),
            ..Peaks::default()
        };
        let Lane { simulation, limits, transposed, .. } = &mut case.lane;
        transposed.read(simulation, limits);
        case
    }
}

fn compare(mode: impl MotionMode, cases: &[Case]) -> Result<(), TestCaseError> {
    let runs: [&Lane; MAX_LANES] = std::array::from_fn(|i| &cases[i].lane);
    let stance = Stance::of(mode.regime()).expect("no flight");
    for width in [2, 4, 8].into_iter().filter_map(VectorWidth::at_most) {
        let pulses = &Pulses::of(width, false, &runs);
        let task = StepTask { mode, stance, short: false, runs, count: width.lanes(), pulses };
        let found = width.run(Look { task, cases });
        for (found, case) in found.iter().zip(cases) {
            prop_assert_eq!(found, &case.alone(mode), "{:?}", case);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    /// Where a lane decides otherwise the run would come to other bits than alone.
    #[test]
    fn each_lane_finds_what_a_run_alone_does(
        both in prop::collection::vec(case(Regime::FullContact), MAX_LANES),
        left in prop::collection::vec(case(Regime::TiltingLeft), MAX_LANES),
        right in prop::collection::vec(case(Regime::TiltingRight), MAX_LANES),
    ) {
        compare(Gripping::<true, true, false>, &both)?;
        compare(Gripping::<true, false, false>, &left)?;
        compare(Gripping::<false, true, false>, &right)?;
    }
}
