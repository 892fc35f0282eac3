//! A block, its initial state and its ground motion → a history and an outcome.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`stopping_rule`] | a block after the ground has come to rest → the end of its run |
//! | [`outcome`] | a run → its end, its peaks and its counts |
//! | [`limit`] | the end and the peak of a run → whether a limit is exceeded |
//! | [`sliding`] | a run, a coefficient of friction → the longest time for which the demand exceeds it |
//! | [`fatigue`] | a run, an amplitude → the half cycles of plastic elongations above it |
//! | [`batch`] | runs → their outcomes, several of them stepped at once |
//! | [`rows`] | the inputs and the runs of rows → the rows with their outcomes |
//! | [`gradients`] | a run, parameters → its history with derivatives |
//! | [`table`] | a history → a CSV table |

pub mod batch;
pub mod fatigue;
pub mod gradients;
pub mod limit;
pub mod outcome;
pub mod rows;
pub mod sliding;
pub mod stopping_rule;
pub mod table;

use std::ops::Range;

use crate::run::outcome::{Count, End, EventCounts, Holds, Outcome, Tilt};
use crate::run::sliding::Sliding;
use crate::run::stopping_rule::{StoppingRule, fraction_of_barrier, is_at_rest};
use rocking_block::block::Block;
use rocking_block::block::Regime;
use rocking_block::block::restraints::{MAX, TieStates};
use rocking_block::excitation::records::{Ground, RecordInterval};
use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Counts, Ending, Energies, Initial, Settings, Simulation, SimulationError, Slip};
use rocking_block::system::events::Event;

/// The inputs of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The block.
    pub block: Block,
    /// Settings of the integration.
    pub settings: Settings,
    /// Initial state.
    pub initial: Initial,
    /// Pulse added to the horizontal ground acceleration.
    pub pulse: Pulse,
    /// Records of the ground motion.
    pub ground: Ground,
    /// Duration (s); without one, [`stopping_rule`] ends the run.
    pub duration: Option<f64>,
    /// Time between two rows of the history (s), and so the longest between two stops.
    ///
    /// Infinite for rows at the start and the end only.
    pub output_step: f64,
}

/// Whether a record, a pulse or the initial state moves a block.
pub fn is_moved(ground: &Ground, pulse: &Pulse, initial: &Initial) -> bool {
    !ground.is_empty()
        || !pulse.is_none()
        || initial.theta != 0.0
        || initial.theta_dot != 0.0
        || initial.vertical.is_some()
}

/// The state of the block at one time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Time (s).
    pub time: f64,
    /// Motion and reactions.
    pub observation: Observation<f64>,
    /// Regime.
    pub regime: Regime,
    /// Energies (J).
    pub energies: Energies,
    /// Displacement of the foot from its position at the start (m), positive to the right.
    pub slip: f64,
    /// Ground acceleration, horizontal with the pulse, and vertical (m/s²).
    pub ground: [f64; 2],
}

/// The history of a run.
#[derive(Clone, Debug)]
pub struct History {
    /// Rows at evenly spaced times and at the end of the run.
    pub rows: Vec<Row>,
    /// Events.
    pub events: Vec<Event>,
    /// Peaks, including those between rows.
    pub peaks: Peaks,
    /// Counters.
    pub counts: Counts,
    /// Reason and time of an early end (s).
    pub ending: Option<(Ending, f64)>,
    /// How the run ended.
    pub end: End,
    /// Whether the ground and the block are at rest at the end of the run.
    pub is_at_rest: bool,
    /// How far the foot has slid at the end of the run.
    pub slip: Slip,
    /// The states of the ties and dampers then.
    pub ties: TieStates,
    /// The energies that they have lost by yielding (J).
    pub yield_works: [f64; MAX],
    /// Rotation past the balance and at the end.
    pub lean: Tilt,
}

/// Greatest number of rows of a history, including those of its derivatives. They need some 10 GB of memory.
pub const MAX_ROWS: f64 = 1e7;
/// Memory for a row (bytes). It covers two rows in a vector that doubles its capacity, and the numbers of the table.
const MEMORY_OF_ROW: f64 = 2.0 * size_of::<Row>() as f64 + 256.0;

/// The reason why the history of a run does not fit into memory.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MemoryError {
    /// More rows than any reasonable history.
    #[error("{0}")]
    TooManyRows(String),
    /// The system refuses the memory.
    #[error("{0}")]
    Refused(String),
}

fn with_derivatives(parameters: usize) -> String {
    match parameters {
        0 => String::new(),
        1 => " with the derivatives for 1 parameter".into(),
        several => format!(" with the derivatives for {several} parameters"),
    }
}

/// Checks that the rows of a history of this duration and step (s), with the derivatives with respect to some parameters, fit into memory.
/// `of_row` is the size of a row (bytes).
///
/// # Errors
/// Rows beyond [`MAX_ROWS`], or beyond the memory that the system provides now.
pub(crate) fn check_rows(duration: f64, step: f64, parameters: usize, of_row: f64) -> Result<(), MemoryError> {
    let rows = duration / step * (1 + parameters) as f64;
    let found = || format!("{duration} s in steps of {step} s are {rows:.0} rows{}", with_derivatives(parameters));
    if rows.is_nan() || rows > MAX_ROWS {
        let (found, gigabytes) = (found(), 1e-9 * MAX_ROWS * of_row);
        return Err(MemoryError::TooManyRows(format!(
            "{found}; expected at most 1e7, which need about {gigabytes:.0} GB of memory"
        )));
    }
    // A failed allocation later would abort the process.
    Vec::<u8>::new().try_reserve_exact((rows * of_row) as usize).map_err(|_| {
        let (found, gigabytes) = (found(), 1e-9 * rows * of_row);
        MemoryError::Refused(format!(
            "{found}, for which the system does not provide about {gigabytes:.1} GB of memory; expected longer steps or a shorter duration"
        ))
    })
}

/// Returns the time of a row by its number from 0. A row within rounding of the end is the last.
pub(crate) fn time_of_row(Range { start, end }: Range<f64>, step: f64, number: u64) -> f64 {
    let time = start + number as f64 * step;
    if time < end - 1e-12 * (end - start) { time } else { end }
}

impl Run {
    /// A run from rest without ground motion, ended by [`stopping_rule`].
    pub fn at_rest(block: Block, settings: Settings) -> Run {
        Run {
            block,
            settings,
            initial: Initial::default(),
            pulse: Pulse::NONE,
            ground: Ground::default(),
            duration: None,
            output_step: f64::INFINITY,
        }
    }

    /// Checks that the history and the derivatives with respect to some parameters fit into memory.
    ///
    /// # Errors
    /// Rows beyond [`MAX_ROWS`], or beyond the memory that the system provides now.
    pub fn check_memory(&self, parameters: usize) -> Result<(), MemoryError> {
        check_rows(self.longest_duration(), self.output_step, parameters, MEMORY_OF_ROW)
    }

    /// Makes the run; `progress` receives the fraction done, 0 to 1.
    ///
    /// # Errors
    /// The solver cannot go on.
    pub fn history(&self, mut progress: impl FnMut(f64)) -> Result<History, SimulationError> {
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        let mut simulation = self.begin();
        let advance = |simulation: &mut Simulation, stop, inputs: &Inputs| {
            simulation.advance(stop, inputs, &mut |event| events.push(*event))
        };
        let (lean, driven) = self.drive(&mut simulation, advance, |done, simulation, inputs| {
            rows.push(self.row(simulation, inputs));
            progress(done);
        });
        driven.map(|()| self.finished(&simulation, lean, rows, events))
    }

    /// The history of the run that has ended with this simulation.
    fn finished(&self, simulation: &Simulation, lean: Tilt, rows: Vec<Row>, events: Vec<Event>) -> History {
        let (peaks, counts, ending) = (simulation.peaks(), simulation.counts(), simulation.ending());
        let end = self.end(simulation);
        let is_at_rest = end == End::Completed && is_at_rest(simulation);
        let (slip, ties) = (simulation.slip(), simulation.restraints().ties);
        let yield_works = std::array::from_fn(|number| simulation.plastic_work(number));
        let lean = lean.at_end(simulation);
        History { rows, events, peaks, counts, ending, end, is_at_rest, slip, ties, yield_works, lean }
    }

    /// Makes the run without keeping rows. Its stops, and thus its bits, are those of [`Run::history`].
    pub fn outcome(&self) -> Outcome {
        let mut simulation = self.begin();
        let mut event_counts = EventCounts::begin(&simulation);
        let advance = |simulation: &mut Simulation, stop, inputs: &Inputs| {
            simulation.advance(stop, inputs, &mut |event| event_counts.count_event(event))
        };
        let (lean, driven) = self.drive(&mut simulation, advance, |_, _, _| ());
        self.outcome_of(&simulation, lean, event_counts, driven.err())
    }

    /// The outcome of the run if it ends with this simulation.
    pub(super) fn outcome_of(
        &self,
        simulation: &Simulation,
        lean: Tilt,
        event_counts: EventCounts,
        failure: Option<SimulationError>,
    ) -> Outcome {
        let end = if failure.is_some() { End::Failed } else { self.end(simulation) };
        let end_time = simulation.ending().map_or(simulation.time(), |(_, time)| time);
        let (peaks, counts, EventCounts { flights, breaks }) = (simulation.peaks(), simulation.counts(), event_counts);
        let lean = lean.at_end(simulation);
        let (alpha, Holds { ties, .. }) = (self.block.alpha, Holds::of(&self.block));
        Outcome { end, end_time, peaks, counts, flights, lean, breaks, alpha, ties, failure }
    }

    /// The end of the run if it ends with this simulation, without a failure.
    fn end(&self, simulation: &Simulation) -> End {
        let (time, start) = (simulation.time(), self.start());
        // A duration up to the last sample may miss it by rounding.
        let ground_is_at_rest = self.ground_at_rest() - time <= 1e-12 * (time - start);
        match simulation.ending() {
            Some((ending, _)) if ending.is_overturning() => End::Overturned,
            Some(_) => End::Separated,
            None if ground_is_at_rest && fraction_of_barrier(simulation).is_some() => End::Completed,
            None => End::Undecided,
        }
    }

    /// The longest uninterrupted time (s) with |H|/(N_L + N_R) above a coefficient of friction (1).
    pub fn longest_above(&self, friction: f64) -> f64 {
        let mut sliding = Sliding::new(friction);
        let advance = |simulation: &mut Simulation, stop, inputs: &Inputs| {
            sliding.follow(simulation, stop, inputs);
            simulation.advance(stop, inputs, &mut |_| ())
        };
        // A failed run counts as far as it came.
        let _ = self.drive(&mut self.begin(), advance, |_, _, _| ());
        sliding.longest
    }

    /// Time of the start (s), that of the first sample or an earlier pulse. It is 0 without a record.
    pub fn start(&self) -> f64 {
        let first = self.ground.start();
        if self.pulse.shape == PulseShape::None || self.ground.is_empty() { first } else { first.min(self.pulse.start) }
    }

    pub(crate) fn begin(&self) -> Simulation {
        let start = self.start();
        let (inputs, _) = self.ground.inputs_from(start);
        Simulation::new(self.block, self.settings, self.pulse, &self.initial, start, &inputs)
    }

    /// Time from which the ground is at rest (s).
    fn ground_at_rest(&self) -> f64 {
        let start = self.start();
        let pulse = if self.pulse.shape == PulseShape::None { start } else { self.pulse.end() };
        self.ground.end().unwrap_or(start).max(pulse).max(start)
    }

    /// Longest possible duration of the run (s).
    pub fn longest_duration(&self) -> f64 {
        self.duration.unwrap_or_else(|| self.stopping_rule().end(&self.block) - self.start())
    }

    fn stopping_rule(&self) -> StoppingRule {
        let is_free = self.ground.is_empty() && self.pulse.shape == PulseShape::None;
        StoppingRule::new(self.ground_at_rest(), is_free)
    }

    /// Makes the run: `advance` moves the simulation to each stop, under these inputs.
    ///
    /// `row` receives the fraction done, the block and the inputs, at the start and at each row. Returns how far the block leaned. An error
    /// leaves the simulation at the last good step.
    fn drive<T>(
        &self,
        simulation: &mut Simulation,
        mut advance: impl FnMut(&mut Simulation, f64, &Inputs) -> Result<T, SimulationError>,
        mut row: impl FnMut(f64, &Simulation, &Inputs),
    ) -> (Tilt, Result<(), SimulationError>) {
        let mut schedule = self.schedule(simulation);
        row(0.0, simulation, schedule.inputs());
        schedule.check(simulation);
        while let Some(stop) = schedule.next_stop(simulation) {
            if let Err(error) = advance(simulation, stop, schedule.inputs()) {
                return (schedule.lean, Err(error));
            }
            if let Some(done) = schedule.stopped(self, simulation) {
                row(done, simulation, schedule.inputs());
            }
        }
        (schedule.lean, Ok(()))
    }

    /// The schedule of a run at its start.
    pub(super) fn schedule(&self, simulation: &Simulation) -> Schedule {
        let start = simulation.time();
        let Run { duration, output_step, ref block, .. } = *self;
        let stopping_rule = duration.is_none().then(|| self.stopping_rule());
        let next_check = stopping_rule.map_or(f64::INFINITY, |rule| rule.next_check(block));
        let end = match (duration, &stopping_rule) {
            (Some(duration), _) => start + duration,
            (None, Some(rule)) => rule.end(block),
            (None, None) => start,
        };
        let mut schedule = Schedule {
            start,
            duration,
            output_step: if output_step > 0.0 { output_step } else { f64::INFINITY },
            piece: self.ground.piece_from(start),
            stopping_rule,
            next_check,
            end,
            rows: 0,
            next_row: end,
            stop: start,
            lean: Tilt::default(),
        };
        schedule.lean.follow(simulation);
        schedule.find_next_row();
        schedule
    }

    /// The state of the block now, under these inputs.
    pub(crate) fn row(&self, simulation: &Simulation, inputs: &Inputs) -> Row {
        let time = simulation.time();
        let now = inputs.moved_to(time);
        let observation = simulation.observe(inputs);
        Row {
            time,
            observation,
            regime: observation.regime,
            energies: simulation.energies(),
            slip: simulation.slip().now,
            ground: [now.a_gx.value + self.pulse.acceleration(time), now.a_gz.value],
        }
    }
}

/// The stops of a run in progress, and the inputs until the next one.
///
/// The number of stops is finite: each is a record sample, a row, a check of the stopping rule or the end, all counted by
/// integers.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    start: f64,
    duration: Option<f64>,
    output_step: f64,
    /// The piece of the ground motion that leads to the next stop.
    piece: RecordInterval,
    stopping_rule: Option<StoppingRule>,
    /// Time of the next check of the stopping rule (s).
    next_check: f64,
    /// Time at which the run is over (s), as far as known.
    end: f64,
    /// Number of rows so far, excluding the first.
    rows: u64,
    /// Time of the next row (s).
    next_row: f64,
    stop: f64,
    /// How far the block has leaned so far.
    pub(super) lean: Tilt,
}

impl Schedule {
    /// The inputs until the next stop.
    pub(super) fn inputs(&self) -> &Inputs {
        &self.piece.inputs
    }

    /// Whether the simulation has ended. A block that is held is shown for the given duration.
    fn is_over(&self, simulation: &Simulation) -> bool {
        simulation.ending().is_some() && !(simulation.is_frozen() && self.duration.is_some())
    }

    /// Applies the stopping rule if its next check is due.
    #[inline]
    pub(super) fn check(&mut self, simulation: &Simulation) {
        if let Some(rule) = self.stopping_rule.as_mut().filter(|_| self.next_check <= simulation.time()) {
            rule.check(simulation);
            (self.next_check, self.end) = (rule.next_check(simulation.block()), rule.end(simulation.block()));
            self.find_next_row();
        }
    }

    /// Time of the next stop (s), unless the run is over.
    #[inline]
    pub(super) fn next_stop(&mut self, simulation: &Simulation) -> Option<f64> {
        let continues = simulation.time() < self.end && !self.is_over(simulation);
        self.stop = earlier(self.piece.end, earlier(self.next_row, self.next_check));
        continues.then_some(self.stop)
    }

    /// Finds the time of the next row.
    fn find_next_row(&mut self) {
        self.next_row = time_of_row(self.start..self.end, self.output_step, self.rows + 1);
    }

    /// Records that the run has reached the stop, or ended before. Returns the fraction done if a row is due.
    #[inline]
    pub(super) fn stopped(&mut self, run: &Run, simulation: &Simulation) -> Option<f64> {
        self.lean.follow(simulation);
        let ended = self.is_over(simulation);
        if !ended && self.stop == self.piece.end {
            run.ground.next_interval(&mut self.piece);
        }
        self.check(simulation);
        let Schedule { start, end, .. } = *self;
        if self.stop < self.next_row && !ended {
            return None;
        }
        self.rows += 1;
        self.find_next_row();
        Some(((simulation.time() - start) / (end - start)).min(1.0))
    }
}

/// Returns the earlier of two times that are not NaN. It takes a third of the instructions of `f64::min`.
#[inline]
fn earlier(first: f64, second: f64) -> f64 {
    if second < first { second } else { first }
}

impl History {
    /// Whether the block rests at the end without standing upright, as on a tie.
    pub fn ends_tilted(&self, block: &Block) -> bool {
        self.is_at_rest && self.lean.is_tilted(block.alpha)
    }

    /// The ties that broke.
    pub fn breaks(&self) -> Count {
        let mut event_counts = EventCounts::default();
        self.events.iter().for_each(|event| event_counts.count_event(event));
        event_counts.breaks
    }

    /// Greatest |total energy| of the rows (J).
    pub fn greatest_energy(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.total.abs()).fold(0.0, f64::max)
    }

    /// Greatest |residual| of the energy balance in the rows (J).
    pub fn greatest_residual(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.residual.abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests;
