//! A block, its beginning and its ground → what it does, at evenly spaced times.

use crate::block::Block;
use crate::contact::Regime;
use crate::excitation::{Inputs, Pulse, PulseShape};
use crate::records::ground::Ground;
use crate::simulation::outputs::Observation;
use crate::simulation::peaks::Peaks;
use crate::simulation::{Counts, Ending, Energies, Initial, Settings, Simulation, SimulationError};
use crate::study::coming_down::{ComingDown, is_at_rest, part_of_barrier};
use crate::study::friction::Sliding;
use crate::study::outcome::{End, Flights, Outcome};
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
    /// Duration (s); without one the run goes on until the ground has come to rest and the block has come down, and in free
    /// motion until the block is at rest, see [`coming_down`](crate::study::coming_down).
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
    /// How the run ended.
    pub end: End,
    /// Whether ground and block are at rest at the end of the run.
    pub is_at_rest: bool,
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
        let end = self.end(&simulation);
        let is_at_rest = end == End::Completed && is_at_rest(&simulation);
        Ok(History { rows, events, peaks, counts, ending, end, is_at_rest })
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
        self.outcome_of(&simulation, flights, failure)
    }

    /// The outcome of the run where it ends with this simulation.
    pub(super) fn outcome_of(
        &self,
        simulation: &Simulation,
        flights: Flights,
        failure: Option<SimulationError>,
    ) -> Outcome {
        let end = if failure.is_some() { End::Failed } else { self.end(simulation) };
        let end_time = simulation.ending().map_or(simulation.time(), |(_, time)| time);
        Outcome { end, end_time, peaks: simulation.peaks(), counts: simulation.counts(), flights, failure }
    }

    /// How the run ends if it ends with this simulation, without a failure.
    fn end(&self, simulation: &Simulation) -> End {
        let (time, start) = (simulation.time(), self.ground.start());
        // A duration up to the last sample may miss it by rounding.
        let ground_is_at_rest = self.ground_at_rest() - time <= 1e-12 * (time - start);
        match simulation.ending() {
            Some((ending, _)) if ending.is_overturning() => End::Overturned,
            Some(_) => End::Separated,
            None if ground_is_at_rest && part_of_barrier(simulation).is_some() => End::Completed,
            None => End::Undecided,
        }
    }

    /// The longest time in one piece (s) for which |H|/(N_L + N_R) exceeds a coefficient of friction (1) in this run.
    pub fn longest_above(&self, friction: f64) -> f64 {
        let mut sliding = Sliding::new(friction);
        let mut simulation = self.begin();
        let mut course = self.course(&simulation);
        course.look(&simulation);
        while let Some(stop) = course.next_stop(&simulation) {
            sliding.follow(&simulation, stop, &course.inputs);
            if simulation.advance(stop, &course.inputs, &mut |_| ()).is_err() {
                break;
            }
            course.stopped(self, &simulation);
        }
        sliding.longest
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
        self.duration.unwrap_or_else(|| self.coming_down().end(&self.block) - self.ground.start())
    }

    fn coming_down(&self) -> ComingDown {
        let is_free = self.ground.is_empty() && self.pulse.shape == PulseShape::None;
        ComingDown::new(self.ground_at_rest(), is_free)
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
        let coming_down = duration.is_none().then(|| self.coming_down());
        let next_look = coming_down.map_or(f64::INFINITY, |coming_down| coming_down.next_look(block));
        let end = match (duration, &coming_down) {
            (Some(duration), _) => start + duration,
            (None, Some(coming_down)) => coming_down.end(block),
            (None, None) => start,
        };
        Course {
            start,
            duration,
            output_step: if output_step > 0.0 { output_step } else { f64::INFINITY },
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
///
/// A run makes finitely many stops: each stop takes the next sample of a record, the next row, the next look or the end,
/// and integers count them all.
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
        let goes_on = simulation.time() < self.end && !self.is_over(simulation);
        self.stop = self.until.min(self.next_row()).min(self.next_look);
        goes_on.then_some(self.stop)
    }

    /// Time of the next row (s), the last at the end of the run. A row that rounding alone separates from the end is the last.
    fn next_row(&self) -> f64 {
        let Course { start, end, output_step, rows, .. } = *self;
        let time = start + (rows + 1) as f64 * output_step;
        if time < end - 1e-12 * (end - start) { time } else { end }
    }

    /// Takes note that the run has come to the stop, or to its end before; the part that is done if a row belongs there.
    pub(super) fn stopped(&mut self, run: &Run, simulation: &Simulation) -> Option<f64> {
        let ended = self.is_over(simulation);
        if !ended && self.stop == self.until {
            (self.inputs, self.until) = run.ground.inputs_near(self.stop, &mut self.samples);
        }
        self.look(simulation);
        let Course { start, end, .. } = *self;
        if self.stop < self.next_row() && !ended {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Common, Dimensionless, Foundation};
    use crate::records::{ReadOptions, Record, Unit, parse};

    /// Times of the rows of a block at rest, and the number of stops; more stops than `most` are a failure.
    fn rows(ground: &Ground, duration: f64, output_step: f64, most: usize) -> (Vec<f64>, usize) {
        let dimensionless = Dimensionless { alpha: 0.2, p: 1.0, eta: 40.0, xi_v: 0.1 };
        let common = Common { foundation: Foundation::Rigid, ..Common::default() };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let (settings, initial, pulse) = (Settings::default(), Initial::default(), Pulse::NONE);
        let ground = ground.clone();
        let run = Run { block, settings, initial, pulse, ground, duration: Some(duration), output_step };
        let mut simulation = run.begin();
        let mut course = run.course(&simulation);
        let (mut rows, mut stops) = (vec![simulation.time()], 0);
        while let Some(stop) = course.next_stop(&simulation) {
            stops += 1;
            assert!(
                stops <= most,
                "{duration} s in rows of {output_step} s do not end: {stops} stops, the last at {stop} s"
            );
            simulation.advance(stop, &course.inputs, &mut |_| ()).unwrap();
            if course.stopped(&run, &simulation).is_some() {
                rows.push(simulation.time());
            }
        }
        (rows, stops)
    }

    /// Durations that are a whole number of steps in decimals, a unit of rounding beside one, and anything else.
    #[test]
    fn every_run_ends_with_one_row_at_its_end() {
        let still = |start_time: f64, time_step: f64| {
            let unit = Some(Unit::MetrePerSecondSquared);
            let options = ReadOptions { unit, time_step: Some(time_step), ..ReadOptions::default() };
            let record = parse("still", "0\n".repeat(40).as_bytes(), &options).unwrap();
            Ground { horizontal: Some(Record { start_time, ..record }), vertical: None }
        };
        let grounds = [Ground::default(), still(0.0, 0.015), still(-0.3, 0.01), still(1e5, 0.007)];
        let steps = [0.0001, 0.001, 0.0025, 0.007, 0.01, 0.015, 0.02, 0.03, 0.1, 1.0 / 3.0, 0.7];
        let mut pairs: Vec<(f64, f64, usize)> = Vec::new();
        for step in steps {
            for count in 1..=160_usize {
                // As a user writes it: 60 steps of 0.015 are 0.9.
                let tidy: f64 = format!("{:.10}", count as f64 * step).parse().unwrap();
                pairs.extend([tidy, tidy.next_up(), tidy.next_down()].map(|duration| (duration, step, count)));
                pairs.push(((count as f64 - 0.37) * step, step, count));
            }
        }
        for (number, (duration, step, count)) in pairs.into_iter().enumerate() {
            let ground = &grounds[number % grounds.len()];
            let (times, stops) = rows(ground, duration, step, count + 41);
            let start = ground.start();
            // A clock at 1e5 s does not resolve what separates a tidy duration from its rows.
            let end = start + duration;
            assert_eq!(times.last(), Some(&end), "{duration} s, {step} s");
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{duration} s, {step} s: {times:?}");
            assert!(stops < times.len() + 40);
            if start < 1e5 && step != 1.0 / 3.0 {
                assert_eq!(times.len(), count + 1, "{duration} s, {step} s");
            }
        }
    }

    /// Steps that are none leave the rows at the beginning and at the end.
    #[test]
    fn a_step_of_nothing_makes_no_rows() {
        for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert_eq!(rows(&Ground::default(), 1.0, step, 1).0, [0.0, 1.0], "{step}");
        }
        for duration in [0.0, -1.0, f64::NAN] {
            assert_eq!(rows(&Ground::default(), duration, 0.1, 1).0, [0.0], "{duration}");
        }
    }
}
