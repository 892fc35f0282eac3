//! Runs → their outcomes, several stepped at once in lanes of vectors.
//!
//! A batch has several times more active runs than lanes. Runs whose next step is of the same kind are stepped together, whatever
//! their times and records. The bits of the outcomes are those of [`Run::outcome`].

use std::borrow::Borrow;

use crate::run::outcome::{EventCounts, Outcome};
use crate::run::{Run, Schedule};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::SimulationError;
use rocking_block::simulation::lanes::{BatchKind, Lane, Next, step_group};

/// Active runs per lane. They fill a group of some kind at nearly every step.
const RUNS_PER_LANE: usize = 8;

/// Numbers of steps taken in lanes and alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneUse {
    /// Steps taken in lanes, including those that were ruled out.
    pub in_lanes: u64,
    /// Steps of single runs.
    pub alone: u64,
    /// Steps of single runs after an attempt in a lane.
    pub repeated: u64,
    /// Empty lanes of groups that were not full.
    pub idle: u64,
}

/// An active run.
struct ActiveRun<R> {
    number: usize,
    run: R,
    schedule: Schedule,
    event_counts: EventCounts,
}

/// Makes runs with vectors of this width, or singly, and returns their outcomes in order.
///
/// `ended` is called after each run, in any order.
pub fn outcomes<R: Borrow<Run>>(
    width: Option<VectorWidth>,
    runs: impl Iterator<Item = R>,
    ended: impl Fn(),
) -> Vec<Outcome> {
    match width {
        // The WebAssembly of this project has no vectors.
        Some(width) if !cfg!(target_family = "wasm") => in_lanes(width, runs, ended).0,
        Some(_) | None => runs.map(|run| run.borrow().outcome()).inspect(|_| ended()).collect(),
    }
}

/// Makes runs in lanes, as [`outcomes`] does, and counts their steps.
pub fn in_lanes<R: Borrow<Run>>(
    width: VectorWidth,
    runs: impl Iterator<Item = R>,
    ended: impl Fn(),
) -> (Vec<Outcome>, LaneUse) {
    let mut batch = Batch {
        width,
        runs: runs.enumerate(),
        ended,
        active: Vec::new(),
        waiting: Default::default(),
        outcomes: Vec::new(),
        lane_use: LaneUse::default(),
    };
    for tag in 0..RUNS_PER_LANE * width.lanes() {
        if let Some(lane) = batch.begin(tag) {
            batch.advance(lane);
        }
    }
    let mut group = Vec::new();
    while batch.step(&mut group) {
        while let Some(lane) = group.pop() {
            batch.advance(lane);
        }
    }
    let outcomes = batch.outcomes.into_iter().map(|outcome| outcome.expect("each run has ended")).collect();
    (outcomes, batch.lane_use)
}

/// The active and the remaining runs of a batch.
struct Batch<R, I, E> {
    width: VectorWidth,
    runs: I,
    ended: E,
    /// Indexed by the tags of the lanes.
    active: Vec<ActiveRun<R>>,
    /// Queues of lanes by the kind of their next step.
    #[expect(clippy::vec_box, reason = "a lane of nearly a kilobyte moves from queue to queue")]
    waiting: [Vec<Box<Lane>>; BatchKind::COUNT],
    outcomes: Vec<Option<Outcome>>,
    lane_use: LaneUse,
}

impl<R: Borrow<Run>, I: Iterator<Item = (usize, R)>, E: Fn()> Batch<R, I, E> {
    /// Starts the next run under this tag, if there is one.
    fn begin(&mut self, tag: usize) -> Option<Box<Lane>> {
        loop {
            let (number, owner) = self.runs.next()?;
            let run = owner.borrow();
            let simulation = run.begin();
            let event_counts = EventCounts::begin(&simulation);
            let mut schedule = run.schedule(&simulation);
            schedule.check(&simulation);
            let Some(stop) = schedule.next_stop(&simulation) else {
                self.outcomes.push(Some(run.outcome_of(&simulation, schedule.lean, event_counts, None)));
                (self.ended)();
                continue;
            };
            self.outcomes.push(None);
            let mut lane = Box::new(Lane::new(simulation, tag));
            lane.send(stop, schedule.inputs());
            let begun = ActiveRun { number, run: owner, schedule, event_counts };
            match self.active.get_mut(tag) {
                Some(ended) => *ended = begun,
                None => self.active.push(begun),
            }
            return Some(lane);
        }
    }

    /// Advances a run until it waits for a group. Its successors follow once it has ended.
    fn advance(&mut self, mut lane: Box<Lane>) {
        loop {
            let continues = match lane.next_step(self.active[lane.tag].schedule.inputs()) {
                Next::Together(kind) => {
                    self.waiting[kind.number()].push(lane);
                    return;
                }
                Next::Alone => self.step_alone(&mut lane),
                Next::Arrived => self.next_stop(&mut lane),
            };
            if !continues {
                match self.begin(lane.tag) {
                    Some(next) => lane = next,
                    None => return,
                }
            }
        }
    }

    /// Sends a run on from a stop to the next; returns whether it continues.
    fn next_stop(&mut self, lane: &mut Lane) -> bool {
        let ActiveRun { run, schedule, .. } = &mut self.active[lane.tag];
        schedule.stopped((*run).borrow(), lane.simulation());
        let stop = schedule.next_stop(lane.simulation());
        match stop {
            Some(stop) => lane.send(stop, schedule.inputs()),
            None => self.end(lane, None),
        }
        stop.is_some()
    }

    /// Takes a step of a single run; returns whether it continues.
    fn step_alone(&mut self, lane: &mut Lane) -> bool {
        let ActiveRun { schedule, event_counts, .. } = &mut self.active[lane.tag];
        self.lane_use.alone += 1;
        match lane.step_alone(schedule.inputs(), &mut |event| event_counts.count_event(event)) {
            Ok(()) => true,
            Err(error) => {
                self.end(lane, Some(error));
                false
            }
        }
    }

    fn end(&mut self, lane: &Lane, failure: Option<SimulationError>) {
        let ActiveRun { number, event_counts, ref run, ref schedule, .. } = self.active[lane.tag];
        self.outcomes[number] = Some(run.borrow().outcome_of(lane.simulation(), schedule.lean, event_counts, failure));
        (self.ended)();
    }

    /// Steps a group of the most frequent kind; returns false if no run waited. The continuing runs are in `group`.
    #[expect(clippy::vec_box, reason = "as `waiting`")]
    fn step(&mut self, group: &mut Vec<Box<Lane>>) -> bool {
        let mut number = 0;
        for other in 1..BatchKind::COUNT {
            if self.waiting[other].len() > self.waiting[number].len() {
                number = other;
            }
        }
        let (lanes, waiting) = (self.width.lanes(), &mut self.waiting[number]);
        let count = waiting.len().min(lanes);
        // The last that came are still in the processor's cache.
        while group.len() < count
            && let Some(lane) = waiting.pop()
        {
            group.push(lane);
        }
        let taken = if count > 1 { step_group(self.width, BatchKind::numbered(number), group) } else { 0 };
        if count > 1 {
            self.lane_use.in_lanes += u64::from(taken.count_ones());
            self.lane_use.idle += (lanes - count) as u64;
            self.lane_use.repeated += count as u64 - u64::from(taken.count_ones());
        }
        for place in (0..count).rev().filter(|place| taken >> place & 1 == 0) {
            if self.step_alone(&mut group[place]) {
                continue;
            }
            match self.begin(group[place].tag) {
                Some(next) => group[place] = next,
                None => drop(group.swap_remove(place)),
            }
        }
        count > 0
    }
}
