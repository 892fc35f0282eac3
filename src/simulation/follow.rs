//! A run → one step at a time, with the event at its end not yet applied.
//!
//! Serves integration of other quantities beside the motion, such as its derivatives.

use std::cell::Cell;

use crate::block::{Body, Foundation, Regime};
use crate::excitation::{Excitation, Inputs};
use crate::numerics::State;
use crate::numerics::dop853;
use crate::numerics::gradient::{MultiDual, SoaDuals};
use crate::numerics::repeat::{self, StateRate, StepForm};
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::numerics::wide::{DirectionsTask, Number, Packed, with_directions};
use crate::run::{MAX_STEPS, SimulationError};
use crate::simulation::state::{Pending, Simulation};
use crate::simulation::step::{StepsInput, StepsOutcome};
use crate::system::evaluation::{Evaluation, Motion};
use crate::system::events::EventFunction;
use crate::system::instant::{Footing, Pose};
use crate::system::motion_mode::{AnyMode, Gripping, MotionMode, dispatch_mode};
use crate::system::swing::tangent::NO_TANGENTS;

pub use crate::simulation::step::StepKind;

/// Rates of a block in motion.
#[derive(Clone, Copy, Debug)]
pub struct Rates {
    /// Those of the state.
    pub state: State,
    /// u̇ (m/s) and ü (m/s²).
    pub u: [f64; 2],
    /// Velocity of the foot (m/s).
    pub slip: f64,
}

impl Rates {
    /// Those at an instant.
    pub fn of<T: Elementary>(now: &Evaluation<T>) -> Rates {
        let x = &now.instant;
        Rates {
            state: State::from(now.rate.state.0.map(T::value)),
            u: [x.u_dot.value(), x.u_ddot.value()],
            slip: x.slip_rate.value(),
        }
    }
}

/// An event function reaches zero at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct ReachedEvent {
    /// The event function.
    pub function: EventFunction,
    /// The rates of the block there.
    pub rates: Rates,
    /// Rate of its function (1/s of its unit).
    pub rate: f64,
    /// Whether the function hardly falls below zero before it rises again. A neighbouring run lacks such an event.
    pub grazes: bool,
}

/// A run that goes to a stop one step at a time. It has the bits of [`Simulation::advance`].
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    stop: f64,
    begins: bool,
    budget: u64,
    kind: StepKind,
}

impl Steps {
    /// The steps of a run towards `until` (s). They end earlier if the pulse begins or ends before.
    pub fn towards(simulation: &Simulation, until: f64) -> Steps {
        let stop = simulation.setup.pulse.next_kink(simulation.run.pose.time).map_or(until, |kink| kink.min(until));
        Steps { stop, begins: true, budget: MAX_STEPS, kind: StepKind::Stayed }
    }

    /// Takes the next step under these inputs; returns its kind and its final event. [`Simulation::apply_pending_event_with_rates`] applies that event.
    /// `None` if the run has reached the stop, or has ended.
    ///
    /// # Errors
    /// The solver cannot go on: see [`SimulationError`].
    pub fn next(
        &mut self,
        simulation: &mut Simulation,
        inputs: &Inputs,
    ) -> Result<Option<(&StepKind, Option<ReachedEvent>)>, SimulationError> {
        let time = simulation.run.pose.time;
        if time >= self.stop || simulation.run.ending.is_some() {
            return Ok(None);
        }
        let Simulation { setup, run } = &mut *simulation;
        let (excitation, kind) = (setup.excitation(time, inputs), Cell::new(StepKind::Stayed));
        let begins_piece = std::mem::take(&mut self.begins);
        // That of its beginning.
        run.counts.evaluations += u64::from(begins_piece);
        let input = StepsInput {
            begins_piece,
            single: true,
            kind: Some(&kind),
            ..StepsInput::of_piece(setup, &excitation, self.stop)
        };
        let reached = match run.steps(&input, &mut self.budget) {
            Ok(StepsOutcome::Event(function, _)) => Some(function),
            Ok(StepsOutcome::Lasts) => None,
            Err(error) => return Err(error),
        };
        simulation.run.pending = reached.map(|function| Pending { function, piece_start: time });
        self.kind = if simulation.run.pose.time > time { kind.into_inner() } else { StepKind::Stayed };
        let event = reached.map(|function| reached_event(simulation, function, &excitation));
        Ok(Some((&self.kind, event)))
    }
}

/// The event that a function of a run has reached now.
fn reached_event(simulation: &Simulation, function: EventFunction, excitation: &Excitation) -> ReachedEvent {
    // Depth of the dip of an event that grazes, in units of the round-off of a zero, which is 1e-13 of the largest term.
    const DEPTH: f64 = 1e4;
    // Fraction of the fastest period over which the rates are compared.
    const NEAR: f64 = 1e-4;
    let (block, pose) = (simulation.block(), &simulation.run.pose);
    let rate = |pose: &Pose| {
        let now = Motion::from_pose(block, pose, excitation).at(pose.time, pose.state);
        (function.sample(&now).eps, now)
    };
    let (first, now) = rate(pose);
    let duration = NEAR / block.omega_v.max(block.p);
    let x = &now.instant;
    let mut later = *pose;
    later.time += duration;
    later.state = later.state + now.rate.state * duration;
    if let Footing::Free { u, u_dot } | Footing::Slides { u, u_dot, .. } = &mut later.footing {
        (*u, *u_dot) = (*u + x.u_dot * duration, *u_dot + x.u_ddot * duration);
    }
    let curvature = (rate(&later).0 - first) / duration;
    // It falls as `first t + curvature t²/2`.
    let is_shallow = curvature > 0.0 && first * first <= 2.0 * curvature * DEPTH * function.rounding(block);
    ReachedEvent { function, rates: Rates::of(&now), rate: first, grazes: first >= 0.0 || is_shallow }
}

/// Size of a state with the horizontal motion: `[θ, θ̇, w, ẇ, u, u̇]`.
const WITH_U: usize = 6;

/// Times inside a step at which the block is looked at.
pub struct Samples<'a, T> {
    /// The times (s), from the beginning of the step on.
    pub times: &'a [f64],
    /// Receives the block at each of them.
    pub seen: &'a mut dyn FnMut(&Pose<T>),
}

/// Repeats a step of a run from `pose` in numbers with derivatives. Returns state and footing at `end` (s), and the block at the times of
/// the samples.
pub fn repeat_step(
    body: &Body<Number>,
    pose: &Pose<Number>,
    excitation: &Excitation<Number>,
    kind: &StepKind,
    end: f64,
    samples: Samples<Number>,
) -> (State<Number>, Footing<Number>) {
    let mode = AnyMode::of(body, pose);
    if let (StepKind::Swing(swing), Some(corner)) = (kind, mode.regime().pivot()) {
        let [theta, theta_dot, ..] = pose.state.0;
        let mut series = NO_TANGENTS;
        let wanted = (!samples.times.is_empty()).then_some(&mut series);
        let fraction = |time: f64| (time - pose.time.re) / swing.size;
        let start = [pose.time, theta, theta_dot];
        let last = swing.varied(body, corner, excitation, start, fraction(end), wanted);
        let state = |[theta, theta_dot]: [Number; 2]| {
            let zero = Number::from(0.0);
            State::from([theta, theta_dot, zero, zero])
        };
        for &time in samples.times {
            let state = state(swing.varied_by(&series, fraction(time)));
            (samples.seen)(&Pose { time: time.into(), state, ..*pose });
        }
        return (state(last), pose.footing);
    }
    match mode.extended() {
        Some(_) => repeat_under::<WITH_U>(&mode, body, pose, excitation, kind, end, samples),
        None => dispatch_mode!(mode, mode => repeat_under::<4>(&mode, body, pose, excitation, kind, end, samples)),
    }
}

fn repeat_under<const N: usize>(
    mode: &dyn Repeats<N>,
    body: &Body<Number>,
    pose: &Pose<Number>,
    excitation: &Excitation<Number>,
    kind: &StepKind,
    end: f64,
    Samples { times, seen }: Samples<Number>,
) -> (State<Number>, Footing<Number>) {
    let motion = Motion::<_, N, _>::under(AnyMode::of(body, pose), body, pose, excitation);
    let (state, start) = (motion.state_at(pose), pose.time.re);
    let mut inspect = |time: f64, state: State<Number, N>| {
        let (state, footing) = motion.place_at(time.into(), state);
        seen(&Pose { time: time.into(), state, footing, ..*pose });
    };
    let span = |end: f64| [start, end - start];
    let end_state = match kind {
        // A shorter step of order 5 is one, too, and more accurate.
        StepKind::ShortStep => {
            let short =
                |end: f64| mode.repeat(&motion, &TangentStep { state, span: span(end), form: StepForm::Short }, None);
            times.iter().for_each(|&time| inspect(time, short(time)));
            short(end)
        }
        StepKind::Stayed | StepKind::Step | StepKind::Swing(_) | StepKind::Rested => {
            if times.is_empty() {
                mode.repeat(&motion, &TangentStep { state, span: span(end), form: StepForm::Long }, None)
            } else {
                let (size, mut stages) = (end - start, [State::zeros(); dop853::DENSE_STAGES]);
                let step = TangentStep { state, span: span(end), form: StepForm::Dense };
                let end_state = mode.repeat(&motion, &step, Some(&mut stages));
                let inside = dop853::polynomial(state, end_state - state, size, &stages);
                times.iter().for_each(|&time| inspect(time, dop853::evaluate(&inside, (time - start) / size)));
                end_state
            }
        }
    };
    motion.place_at(end.into(), end_state)
}

/// A step that is repeated.
#[derive(Clone, Copy)]
struct TangentStep<const N: usize> {
    state: State<Number, N>,
    /// Its beginning and its size (s).
    span: [f64; 2],
    form: StepForm,
}

/// The stages of a step.
type Stages<const N: usize> = [State<Number, N>; dop853::DENSE_STAGES];

/// A mode under which steps are repeated.
trait Repeats<const N: usize> {
    /// The end of a step under this mode; `stages` receives its stages.
    fn repeat(
        &self,
        motion: &Motion<AnyMode, N, Number>,
        step: &TangentStep<N>,
        stages: Option<&mut Stages<N>>,
    ) -> State<Number, N>;
}

impl<const N: usize> Repeats<N> for AnyMode {
    fn repeat(
        &self,
        motion: &Motion<AnyMode, N, Number>,
        &TangentStep { state, span, form }: &TangentStep<N>,
        stages: Option<&mut Stages<N>>,
    ) -> State<Number, N> {
        let (end, k) = repeat::repeat_step(form, span, state, motion);
        if let Some(stages) = stages {
            *stages = k;
        }
        end
    }
}

impl<const N: usize> StateRate<State<Number, N>> for Motion<'_, AnyMode, N, Number> {
    fn state_rate(&self, time: f64, state: &State<Number, N>) -> State<Number, N> {
        self.rate_at_outlined(Number::from(time), state)
    }
}

impl<const LEFT: bool, const RIGHT: bool, const RIGID: bool> Repeats<4> for Gripping<LEFT, RIGHT, RIGID> {
    fn repeat(
        &self,
        motion: &Motion<AnyMode, 4, Number>,
        step: &TangentStep<4>,
        mut stages: Option<&mut Stages<4>>,
    ) -> State<Number> {
        if self.is_at_rest() {
            // Nothing accelerates.
            let ([_, theta_dot, _, w_dot], zero) = (step.state.0, Number::from(0.0));
            let rate = State::from([theta_dot, zero, w_dot, zero]);
            if let Some(stages) = stages {
                *stages = [rate; dop853::DENSE_STAGES];
            }
            return step.state + rate * step.span[1];
        }
        with_directions(Repeat { mode: *self, motion, step, stages: stages.as_deref_mut() })
            .unwrap_or_else(|| motion.mode().repeat(motion, step, stages))
    }
}

/// A step under a mode that the compiler knows.
struct Repeat<'a, L> {
    mode: L,
    motion: &'a Motion<'a, AnyMode, 4, Number>,
    step: &'a TangentStep<4>,
    stages: Option<&'a mut Stages<4>>,
}

impl<L: MotionMode> DirectionsTask for Repeat<'_, L> {
    type Output = State<Number>;

    #[inline(always)]
    fn run<D: Packed>(self) -> State<Number>
    where
        MultiDual<D>: CombinesWith<Number>,
    {
        let Repeat { mode, motion, step: &TangentStep { state: State { 0: [a, b, c, d] }, span, form }, stages } = self;
        let start = SoaDuals::<D>::of([a.into(), b.into(), c.into(), d.into()]);
        let (end, k) = repeat::repeat_step(form, span, start, &Known { mode, motion });
        if let Some(stages) = stages {
            for i in 0..dop853::DENSE_STAGES {
                stages[i] = stored(&k[i]);
            }
        }
        stored(&end)
    }
}

/// A state as it is stored.
#[inline(always)]
fn stored<D: Packed>(state: &SoaDuals<D>) -> State<Number> {
    let [a, b, c, d] = state.numbers();
    State::from([a.stored(), b.stored(), c.stored(), d.stored()])
}

/// The equations of a mode that the compiler knows.
struct Known<'a, L> {
    mode: L,
    motion: &'a Motion<'a, AnyMode, 4, Number>,
}

impl<D: Packed, L: MotionMode> StateRate<SoaDuals<D>> for Known<'_, L>
where
    MultiDual<D>: CombinesWith<Number>,
{
    #[inline(always)]
    fn state_rate(&self, time: f64, state: &SoaDuals<D>) -> SoaDuals<D> {
        SoaDuals::of(self.motion.state_rate_under(self.mode, MultiDual::from(time), &State::from(state.numbers())).0)
    }
}
