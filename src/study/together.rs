//! Runs → their outcomes, several of them stepped at once in the lanes of the processor's vectors.
//!
//! Some more runs are under way than there are lanes. Each says what step it takes next, and those that take the same kind of
//! step do so together. They need neither be at the same time nor under the same record. Outcomes are the same bits as those of
//! [`Run::outcome`].

use crate::numerics::wide::Width;
use crate::simulation::SimulationError;
use crate::simulation::lanes::{Kind, Lane, Next, step_together};
use crate::study::history::{Course, Run};
use crate::study::outcome::{Flights, Outcome};

/// Runs under way for each lane: so many that of some kind there is nearly always a full group.
const UNDER_WAY: usize = 8;

/// How the steps of some runs were taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shares {
    /// Steps that were taken in lanes, and short ones that made too great an error there.
    pub together: u64,
    /// Steps that runs took alone.
    pub alone: u64,
    /// Of those, steps that were attempted in a lane first.
    pub again: u64,
    /// Lanes of groups that were not full.
    pub idle: u64,
}

/// A run under way.
struct UnderWay {
    number: usize,
    run: Run,
    course: Course,
    flights: Flights,
}

/// Outcomes of runs, in their order, with vectors of this width; without one, each run is made by itself. `ended` is called
/// after each run, in no order.
pub fn outcomes(width: Option<Width>, runs: impl Iterator<Item = Run>, ended: impl Fn()) -> Vec<Outcome> {
    match width {
        Some(width) => together(width, runs, ended).0,
        None => runs.map(|run| run.outcome()).inspect(|_| ended()).collect(),
    }
}

/// Outcomes of runs, in their order, and how their steps were taken; otherwise as [`outcomes`].
pub fn together(width: Width, runs: impl Iterator<Item = Run>, ended: impl Fn()) -> (Vec<Outcome>, Shares) {
    let mut work = Work {
        width,
        runs: runs.enumerate(),
        ended,
        under_way: Vec::new(),
        waiting: Default::default(),
        outcomes: Vec::new(),
        shares: Shares::default(),
    };
    for tag in 0..UNDER_WAY * width.lanes() {
        if let Some(lane) = work.begin(tag) {
            work.go_on(lane);
        }
    }
    let mut group = Vec::new();
    while work.step(&mut group) {
        group.drain(..).for_each(|lane| work.go_on(lane));
    }
    let outcomes = work.outcomes.into_iter().map(|outcome| outcome.expect("each run has ended")).collect();
    (outcomes, work.shares)
}

/// Runs that are stepped together.
struct Work<R, E> {
    width: Width,
    runs: R,
    ended: E,
    /// By the tags of the lanes.
    under_way: Vec<UnderWay>,
    /// By the kind of their next step, in the order in which they came.
    #[expect(clippy::vec_box, reason = "lanes of near a kilobyte go from one queue to the next")]
    waiting: [Vec<Box<Lane>>; Kind::COUNT],
    outcomes: Vec<Option<Outcome>>,
    shares: Shares,
}

impl<R: Iterator<Item = (usize, Run)>, E: Fn()> Work<R, E> {
    /// Begins the next run in the place of this tag, if there is one.
    fn begin(&mut self, tag: usize) -> Option<Box<Lane>> {
        loop {
            let (number, run) = self.runs.next()?;
            let simulation = run.begin();
            let mut flights = Flights::default();
            flights.begin(&simulation);
            let mut course = run.course(&simulation);
            course.look(&simulation);
            let Some(stop) = course.next_stop(&simulation) else {
                self.outcomes.push(Some(run.outcome_of(&simulation, flights, None)));
                (self.ended)();
                continue;
            };
            self.outcomes.push(None);
            let mut lane = Box::new(Lane::new(simulation, tag));
            lane.send(stop, &course.inputs);
            let begun = UnderWay { number, run, course, flights };
            match self.under_way.get_mut(tag) {
                Some(place) => *place = begun,
                None => self.under_way.push(begun),
            }
            return Some(lane);
        }
    }

    /// Goes on with a run, and with others in its place when it has ended, until one waits for others.
    fn go_on(&mut self, mut lane: Box<Lane>) {
        loop {
            let goes_on = match lane.next_step() {
                Next::Together(kind) => {
                    self.waiting[kind.number()].push(lane);
                    return;
                }
                Next::Alone => self.step_alone(&mut lane),
                Next::Arrived => self.send_on(&mut lane),
            };
            if !goes_on {
                match self.begin(lane.tag) {
                    Some(next) => lane = next,
                    None => return,
                }
            }
        }
    }

    /// Sends a run that has come to a stop to the next; whether it goes on.
    fn send_on(&mut self, lane: &mut Lane) -> bool {
        let UnderWay { run, course, .. } = &mut self.under_way[lane.tag];
        course.stopped(run, lane.simulation());
        match course.next_stop(lane.simulation()) {
            Some(stop) => lane.send(stop, &course.inputs),
            None => self.end(lane, None),
        }
        self.outcomes[self.under_way[lane.tag].number].is_none()
    }

    /// Takes a step of one run; whether it goes on.
    fn step_alone(&mut self, lane: &mut Lane) -> bool {
        let flights = &mut self.under_way[lane.tag].flights;
        self.shares.alone += 1;
        match lane.step_alone(&mut |event| flights.see(event)) {
            Ok(()) => true,
            Err(error) => {
                self.end(lane, Some(error));
                false
            }
        }
    }

    fn end(&mut self, lane: &Lane, failure: Option<SimulationError>) {
        let UnderWay { number, flights, ref run, .. } = self.under_way[lane.tag];
        self.outcomes[number] = Some(run.outcome_of(lane.simulation(), flights, failure));
        (self.ended)();
    }

    /// Takes a step of those of a kind for which most runs wait, and gives those that go on; whether there were any.
    #[expect(clippy::vec_box, reason = "as `waiting`")]
    fn step(&mut self, group: &mut Vec<Box<Lane>>) -> bool {
        let most = |(_, waiting): &(usize, &mut Vec<Box<Lane>>)| waiting.len();
        let Some((number, waiting)) = self.waiting.iter_mut().enumerate().max_by_key(most) else { return false };
        let (lanes, count) = (self.width.lanes(), waiting.len().min(self.width.lanes()));
        group.extend(waiting.drain(..count));
        let taken = if count > 1 { step_together(self.width, Kind::numbered(number), group) } else { 0 };
        if count > 1 {
            self.shares.together += u64::from(taken.count_ones());
            self.shares.idle += (lanes - count) as u64;
            self.shares.again += count as u64 - u64::from(taken.count_ones());
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
