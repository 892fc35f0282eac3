//! A block in space, its initial state and the motion of the ground in three directions → a history.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`facts`] | a block or a history in space → the numbers that summaries state, by name |
//! | [`outcome`] | a run in space → its end, its peaks and its counts |
//! | [`ground`] | records of the components → the motion of the ground, or why they do not belong together |
//! | `stopping_rule` | a block in space after the ground has come to rest → the end of its run |
//! | [`table`] | a history in space → a CSV table |

pub mod facts;
pub mod ground;
pub mod outcome;
mod stopping_rule;
pub mod table;

use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::run::{Ending, Settings, SimulationError};
use rocking_block::space::energies::SpaceEnergies;
use rocking_block::space::excitation::MAX_PULSES;
use rocking_block::space::outputs::SpaceObservation;
use rocking_block::space::run::SpaceCounts;
use rocking_block::space::{
    Base, DirectedPulse, SpaceBody, SpaceEvent, SpaceGround, SpaceInitial, SpaceInputs, SpaceParameters, SpacePeaks,
    SpaceRun, SpaceSetup,
};

use crate::run::outcome::End;
use crate::run::{MemoryError, check_rows, time_of_row};
use crate::space::stopping_rule::{SpaceStoppingRule, is_at_rest, stands};

/// The inputs of a run in space.
#[derive(Clone, Debug)]
pub struct RunInSpace {
    /// The parameters of the block.
    pub parameters: SpaceParameters,
    /// The block, the settings of the integration and the pulses.
    pub setup: SpaceSetup,
    /// Initial state.
    pub initial: SpaceInitial,
    /// Records of the ground motion.
    pub ground: SpaceGround,
    /// Duration (s); without one, the run lasts until the ground has come to rest and the block has come down.
    pub duration: Option<f64>,
    /// Time between two rows of the history (s).
    pub output_step: f64,
}

/// The state of a block in space at one time.
#[derive(Clone, Debug)]
pub struct RowInSpace {
    /// Motion, forces and feet.
    pub observation: SpaceObservation,
    /// Tilt over the critical one in the direction of the lean (1).
    pub tilt_over_critical: f64,
    /// Energies (J).
    pub energies: SpaceEnergies,
    /// Ground acceleration with the pulses (m/s²), along x, y and z.
    pub ground: [f64; 3],
}

/// The history of a run in space.
#[derive(Clone, Debug)]
pub struct HistoryInSpace {
    /// Rows at evenly spaced times and at the end of the run.
    pub rows: Vec<RowInSpace>,
    /// Events.
    pub events: Vec<SpaceEvent>,
    /// Peaks, including those between rows.
    pub peaks: SpacePeaks,
    /// Counters.
    pub counts: SpaceCounts,
    /// Reason and time of an early end (s).
    pub ending: Option<(Ending, f64)>,
    /// How the run ended.
    pub end: End,
    /// Whether the ground and the block are at rest at the end of the run.
    pub is_at_rest: bool,
    /// Whether no foot touched at some time.
    pub separated: bool,
}

/// Returns the names of the feet: by the points of the compass under a rectangle, y to the north, else by numbers from 1.
pub fn foot_names(parameters: &SpaceParameters) -> Vec<String> {
    match &parameters.base {
        Base::Rectangle { .. } => ["SW", "NW", "SE", "NE"].map(String::from).into(),
        Base::Circle { feet, .. } => (1..=*feet).map(|number| number.to_string()).collect(),
        Base::List { feet, .. } => (1..=feet.len()).map(|number| number.to_string()).collect(),
    }
}

impl RunInSpace {
    /// A run of a block from rest without excitation, until its outcome is known, with rows at the start and the end only.
    pub fn at_rest(parameters: SpaceParameters, body: SpaceBody, settings: Settings) -> RunInSpace {
        RunInSpace {
            parameters,
            setup: SpaceSetup { body, settings, pulses: [DirectedPulse::NONE; MAX_PULSES] },
            initial: SpaceInitial::default(),
            ground: SpaceGround::default(),
            duration: None,
            output_step: f64::INFINITY,
        }
    }

    /// The run under a horizontal pulse with an azimuth (degrees).
    #[must_use]
    pub fn with_pulse(mut self, pulse: Pulse, azimuth: f64) -> RunInSpace {
        self.setup.pulses[0] = DirectedPulse::horizontal(pulse, azimuth.to_radians());
        self
    }

    /// Checks that the history fits into memory.
    ///
    /// # Errors
    /// More rows than any reasonable history, or than the memory that the system provides now.
    pub fn check_memory(&self) -> Result<(), MemoryError> {
        let feet = self.setup.body.count() as f64;
        // Two rows in a vector that doubles its capacity, and the numbers of the table.
        let of_row = 2.0 * size_of::<RowInSpace>() as f64 + 400.0 + 160.0 * feet;
        check_rows(self.longest_duration(), self.output_step, 0, of_row)
    }

    fn records(&self) -> impl Iterator<Item = &rocking_records::Record> {
        self.ground.records.iter().flatten()
    }

    fn pulses(&self) -> impl Iterator<Item = &rocking_block::excitation::Pulse> {
        self.setup.pulses.iter().map(|directed| &directed.pulse).filter(|pulse| pulse.shape != PulseShape::None)
    }

    /// Time of the start (s), that of the first sample or an earlier pulse. It is 0 without a record.
    pub fn start(&self) -> f64 {
        let first = self.records().map(|record| record.start_time).reduce(f64::min);
        first.map_or(0.0, |first| self.pulses().map(|pulse| pulse.start).fold(first, f64::min))
    }

    /// Time from which the ground is at rest (s).
    fn ground_at_rest(&self) -> f64 {
        let start = self.start();
        self.pulses().map(|pulse| pulse.end()).chain(self.ground.end()).fold(start, f64::max)
    }

    /// Longest possible duration of the run (s).
    pub fn longest_duration(&self) -> f64 {
        self.duration.unwrap_or_else(|| self.stopping_rule().end() - self.start())
    }

    fn stopping_rule(&self) -> SpaceStoppingRule {
        let is_free = self.records().next().is_none() && self.pulses().next().is_none();
        SpaceStoppingRule::new(&self.setup.body, self.ground_at_rest(), is_free)
    }

    /// Makes the run; `progress` receives the fraction done, 0 to 1.
    ///
    /// # Errors
    /// The solver cannot go on.
    pub fn history(&self, mut progress: impl FnMut(f64)) -> Result<HistoryInSpace, SimulationError> {
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        let mut run = self.begin();
        self.drive(
            &mut run,
            |event| events.push(*event),
            |done, run, inputs| {
                rows.push(self.row(run, inputs));
                progress(done);
            },
        )?;
        let end = self.end(&run);
        let is_at_rest = end == End::Completed && is_at_rest(&run);
        let state = run.state();
        let (peaks, counts, ending, separated) = (state.peaks, state.counts, state.ending, state.separated);
        Ok(HistoryInSpace { rows, events, peaks, counts, ending, end, is_at_rest, separated })
    }

    /// The run at its start.
    fn begin(&self) -> SpaceRun {
        SpaceRun::new(self.setup.clone(), &self.initial, self.start())
    }

    /// Makes the run; `event` receives its events.
    ///
    /// `row` receives the fraction done, the block and the inputs: at the start, at each row and at the end. An error leaves the run at the
    /// last good step.
    fn drive(
        &self,
        run: &mut SpaceRun,
        mut event: impl FnMut(&SpaceEvent),
        mut row: impl FnMut(f64, &SpaceRun, &SpaceInputs),
    ) -> Result<(), SimulationError> {
        let start = run.time();
        let mut rule = self.duration.is_none().then(|| self.stopping_rule());
        let (mut inputs, mut sample) = self.ground.inputs_from(start);
        let (mut rows, mut shown) = (1, start);
        row(0.0, run, &inputs);
        loop {
            if let Some(rule) = rule.as_mut().filter(|rule| rule.next_check() <= run.time()) {
                rule.check(run);
            }
            let end = match (&rule, self.duration) {
                (Some(rule), _) => rule.end(),
                (None, duration) => start + duration.unwrap_or_default(),
            };
            if run.time() >= end || self.is_over(run) {
                break;
            }
            let next_check = rule.as_ref().map_or(f64::INFINITY, SpaceStoppingRule::next_check);
            let next_row = time_of_row(start..end, self.output_step, rows);
            let stop = sample.min(next_row).min(next_check);
            run.advance(stop, &inputs, &mut event)?;
            let ended = self.is_over(run);
            if !ended && stop == sample {
                (inputs, sample) = self.ground.inputs_from(stop);
            }
            if ended || stop == next_row {
                (rows, shown) = (rows + 1, run.time());
                row(((run.time() - start) / (end - start)).min(1.0), run, &inputs);
            }
        }
        // The stopping rule may end a run between two rows.
        if shown < run.time() {
            row(1.0, run, &inputs);
        }
        Ok(())
    }

    /// Whether the run has ended. A block that is held is shown for the given duration.
    fn is_over(&self, run: &SpaceRun) -> bool {
        run.state().ending.is_some() && !(run.is_frozen() && self.duration.is_some())
    }

    /// The end of the run if it ends now, without a failure.
    fn end(&self, run: &SpaceRun) -> End {
        let (time, start) = (run.time(), self.start());
        // A duration up to the last sample may miss it by rounding.
        let ground_is_at_rest = self.ground_at_rest() - time <= 1e-12 * (time - start);
        match run.state().ending {
            Some((ending, _)) if ending.is_overturning() => End::Overturned,
            Some(_) => End::Separated,
            None if ground_is_at_rest && stands(run) => End::Completed,
            None => End::Undecided,
        }
    }

    fn row(&self, run: &SpaceRun, inputs: &SpaceInputs) -> RowInSpace {
        let time = run.time();
        let mut ground = inputs.moved_to(time).ground.map(|ramp| ramp.value);
        for directed in &self.setup.pulses {
            let pulse = directed.pulse.acceleration(time);
            ground.iter_mut().zip(directed.direction).for_each(|(ground, along)| *ground += pulse * along);
        }
        let observation = run.observe(inputs);
        let tilt_over_critical = observation.tilt_over_critical(&self.setup.body);
        RowInSpace { observation, tilt_over_critical, energies: run.energies(), ground }
    }
}

impl HistoryInSpace {
    /// Greatest |stored energy| of the rows (J).
    pub fn greatest_energy(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.stored.total().abs()).fold(0.0, f64::max)
    }

    /// Greatest |residual| of the energy balance in the rows (J).
    pub fn greatest_residual(&self) -> f64 {
        self.rows.iter().map(|row| row.energies.residual.abs()).fold(0.0, f64::max)
    }
}
