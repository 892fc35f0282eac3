//! A block, its beginning and its ground → what it does, at evenly spaced times.

use crate::block::Block;
use crate::contact::Regime;
use crate::excitation::{Inputs, Pulse, PulseShape};
use crate::records::ground::Ground;
use crate::simulation::outputs::Observation;
use crate::simulation::peaks::Peaks;
use crate::simulation::{Counts, Ending, Energies, Initial, Settings, Simulation, SimulationError};
use crate::study::coming_down::{ComingDown, part_of_barrier};
use crate::study::outcome::{Flights, Outcome};
use crate::system::surfaces::Event;

/// A run to be made.
#[derive(Clone, Debug)]
pub struct Run {
    /// The block.
    pub block: Block,
    /// How to integrate.
    pub settings: Settings,
    /// Where the block is at the beginning.
    pub initial: Initial,
    /// A pulse that is added to the horizontal ground acceleration.
    pub pulse: Pulse,
    /// Records.
    pub ground: Ground,
    /// Duration (s); without one the run goes on until the ground has come to rest and the block has come down, see
    /// [`coming_down`](crate::study::coming_down).
    pub duration: Option<f64>,
    /// Time between two rows of the history (s), and so the longest between two stops; infinite for rows at the beginning
    /// and the end alone.
    pub output_step: f64,
}

/// The block at one time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Time (s).
    pub time: f64,
    /// Motion and reactions.
    pub seen: Observation<f64>,
    /// Regime.
    pub regime: Regime,
    /// Energies (J).
    pub energies: Energies,
    /// Ground acceleration, horizontal with the pulse, and vertical (m/s²).
    pub ground: [f64; 2],
}

/// What a block did.
#[derive(Clone, Debug)]
pub struct History {
    /// Rows at evenly spaced times, and the end of the run.
    pub rows: Vec<Row>,
    /// Events.
    pub events: Vec<Event>,
    /// Greatest values, from between the rows too.
    pub peaks: Peaks,
    /// Counters.
    pub counts: Counts,
    /// Why and when the run ended, if before its time.
    pub ending: Option<(Ending, f64)>,
    /// Whether, at the end of the run, the ground has come to rest and the block is bound to.
    pub has_come_down: bool,
}

/// Longest duration of a run of a study (s), and shortest time between two of its stops (s): what lies outside is a slip
/// of the keyboard that would never end.
pub const LONGEST: f64 = 1e6;
/// See [`LONGEST`].
pub const SHORTEST: f64 = 1e-6;

impl Run {
    /// Makes the run; `progress` gets the part that is done, 0 to 1.
    pub fn history(&self, mut progress: impl FnMut(f64)) -> Result<History, SimulationError> {
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        let mut simulation = self.begin();
        self.drive(&mut simulation, &mut |event| events.push(*event), |part, simulation, inputs| {
            rows.push(self.row(simulation, inputs));
            progress(part);
        })?;
        let (peaks, counts, ending) = (simulation.peaks(), simulation.counts(), simulation.ending());
        let at_rest = simulation.time() >= self.ground_at_rest();
        let has_come_down = at_rest && ending.is_none() && part_of_barrier(&simulation).is_some();
        Ok(History { rows, events, peaks, counts, ending, has_come_down })
    }

    /// Makes the run without keeping its rows. Its stops are those of [`Run::history`], so that its numbers are the same
    /// to the last bit.
    pub fn outcome(&self) -> Outcome {
        let mut flights = Flights::default();
        let mut failure = None;
        let mut simulation = self.begin();
        flights.begin(&simulation);
        if let Err(error) = self.drive(&mut simulation, &mut |event| flights.see(event), |_, _, _| ()) {
            failure = Some(error);
        }
        Outcome::new(&simulation, flights, failure)
    }

    pub(super) fn begin(&self) -> Simulation {
        let start = self.ground.start();
        let (inputs, _) = self.ground.inputs_from(start);
        Simulation::new(self.block, self.settings, self.pulse, &self.initial, start, &inputs)
    }

    /// Time from which the ground is at rest (s).
    fn ground_at_rest(&self) -> f64 {
        let start = self.ground.start();
        let pulse = if self.pulse.shape == PulseShape::None { start } else { self.pulse.end() };
        self.ground.end().unwrap_or(start).max(pulse).max(start)
    }

    /// Longest duration that the run may have (s).
    pub fn longest_duration(&self) -> f64 {
        let coming_down = || ComingDown::new(self.ground_at_rest()).end(&self.block) - self.ground.start();
        self.duration.unwrap_or_else(coming_down)
    }

    /// Makes the run, and shows each event and, at the beginning and at each row, the part that is done, the block and
    /// the inputs. An error leaves the simulation at the last good step.
    fn drive(
        &self,
        simulation: &mut Simulation,
        events: &mut dyn FnMut(&Event),
        mut row: impl FnMut(f64, &Simulation, &Inputs),
    ) -> Result<(), SimulationError> {
        let mut course = self.course(simulation);
        row(0.0, simulation, &course.inputs);
        course.look(simulation);
        while let Some(stop) = course.next_stop(simulation) {
            simulation.advance(stop, &course.inputs, events)?;
            if let Some(part) = course.stopped(self, simulation) {
                row(part, simulation, &course.inputs);
            }
        }
        Ok(())
    }

    /// The course of a run that begins.
    pub(super) fn course(&self, simulation: &Simulation) -> Course {
        let start = simulation.time();
        let (inputs, until) = self.ground.inputs_from(start);
        let Run { duration, output_step, ref block, .. } = *self;
        let coming_down = duration.is_none().then(|| ComingDown::new(self.ground_at_rest()));
        let next_look = coming_down.map_or(f64::INFINITY, |coming_down| coming_down.next_look(block));
        let end = match (duration, &coming_down) {
            (Some(duration), _) => start + duration,
            (None, Some(coming_down)) => coming_down.end(block),
            (None, None) => start,
        };
        Course {
            start,
            duration,
            output_step,
            inputs,
            until,
            coming_down,
            next_look,
            end,
            samples: [0; 2],
            rows: 0,
            stop: start,
        }
    }

    fn row(&self, simulation: &Simulation, inputs: &Inputs) -> Row {
        let time = simulation.time();
        let now = inputs.moved_to(time);
        let seen = simulation.observe(inputs);
        Row {
            time,
            seen,
            regime: seen.regime,
            energies: simulation.energies(),
            ground: [now.a_gx.value + self.pulse.acceleration(time), now.a_gz.value],
        }
    }
}

/// Where a run under way stops next, and what drives the block until then.
#[derive(Clone, Debug)]
pub(super) struct Course {
    start: f64,
    duration: Option<f64>,
    output_step: f64,
    /// Inputs to the next stop.
    pub(super) inputs: Inputs,
    /// Until when they hold (s).
    until: f64,
    coming_down: Option<ComingDown>,
    /// Time of the next look whether the block has come down (s).
    next_look: f64,
    /// Time at which the run is over (s), as far as is known.
    end: f64,
    /// The samples of the records that came last.
    samples: [usize; 2],
    /// Rows so far, without that at the beginning.
    rows: u64,
    stop: f64,
}

impl Course {
    /// A block that is held stays in sight as long as was asked for; else nothing more is to be seen of it.
    fn is_over(&self, simulation: &Simulation) -> bool {
        let is_held = simulation.is_frozen() && self.duration.is_some();
        simulation.ending().is_some() && !is_held
    }

    /// Looks whether the block has come down, if it is time.
    pub(super) fn look(&mut self, simulation: &Simulation) {
        if let Some(coming_down) = self.coming_down.as_mut().filter(|_| self.next_look <= simulation.time()) {
            coming_down.look(simulation);
            (self.next_look, self.end) =
                (coming_down.next_look(simulation.block()), coming_down.end(simulation.block()));
        }
    }

    /// Where the run has to stop next (s), if it is not over.
    pub(super) fn next_stop(&mut self, simulation: &Simulation) -> Option<f64> {
        if simulation.time() >= self.end || self.is_over(simulation) {
            return None;
        }
        self.stop = self.until.min(self.next_row()).min(self.next_look).min(self.end);
        Some(self.stop)
    }

    fn next_row(&self) -> f64 {
        self.start + (self.rows + 1) as f64 * self.output_step
    }

    /// Takes note that the run has come to the stop, or to its end before; the part that is done if a row belongs there.
    pub(super) fn stopped(&mut self, run: &Run, simulation: &Simulation) -> Option<f64> {
        let ended = self.is_over(simulation);
        if !ended && self.stop == self.until {
            (self.inputs, self.until) = run.ground.inputs_near(self.stop, &mut self.samples);
        }
        self.look(simulation);
        let Course { start, end, .. } = *self;
        // The last row is at the end of the run, however short or long the step before it.
        let is_row = self.stop == self.next_row() && self.stop < end - 1e-12 * (end - start);
        if !(is_row || ended || self.stop >= end) {
            return None;
        }
        self.rows += 1;
        Some(((simulation.time() - start) / (end - start)).min(1.0))
    }
}

impl History {
    /// Greatest |energy| of the rows (J).
    pub fn greatest_energy(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.total.abs()).fold(0.0, f64::max)
    }

    /// Greatest |residual| of the energy sum in the rows (J).
    pub fn greatest_residual(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.residual.abs()).fold(0.0, f64::max)
    }
}
