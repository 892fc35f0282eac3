//! A block, its beginning and its ground → what it does, at evenly spaced times.

use crate::block::Block;
use crate::events::Event;
use crate::excitation::{Inputs, Pulse, PulseShape};
use crate::outputs::Observation;
use crate::peaks::Peaks;
use crate::regime::Regime;
use crate::simulation::{Counts, Ending, Energies, Initial, Progress, Settings, Simulation, SimulationError};
use crate::study::ground::Ground;

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
    /// Duration (s).
    pub duration: f64,
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
}

/// What a block did, without its history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Greatest values until the end of the run.
    pub peaks: Peaks,
    /// Counters.
    pub counts: Counts,
    /// Why and when (s) the run ended, if before its time.
    pub ending: Option<(Ending, f64)>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It came to its end.
    Completed,
    /// At complete separation.
    Separated,
    /// At overturning.
    Overturned,
    /// It could not go on.
    Failed,
}

/// The word that stands in tables.
impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            End::Completed => "completed",
            End::Separated => "separated",
            End::Overturned => "overturned",
            End::Failed => "failed",
        })
    }
}

impl Outcome {
    /// How the run ended.
    pub fn end(outcome: &Result<Outcome, SimulationError>) -> End {
        match outcome {
            Err(_) => End::Failed,
            Ok(Outcome { ending: None, .. }) => End::Completed,
            Ok(Outcome { ending: Some((Ending::Separated, _)), .. }) => End::Separated,
            Ok(Outcome { ending: Some((Ending::Toppled | Ending::Overturned, _)), .. }) => End::Overturned,
        }
    }

    /// Peak rotation |θ|/α in digits that bring it back exactly; where the run did not complete there is none, and the
    /// word of [`Outcome::end`] stands instead.
    pub fn rotation(outcome: &Result<Outcome, SimulationError>, block: &Block) -> String {
        match outcome {
            Ok(Outcome { peaks, ending: None, .. }) => (peaks.theta / block.alpha).to_string(),
            _ => Outcome::end(outcome).to_string(),
        }
    }

    /// Time (s) at which the run ended before its time; nothing if it did not.
    pub fn end_time(outcome: &Result<Outcome, SimulationError>) -> String {
        let ending = outcome.as_ref().ok().and_then(|outcome| outcome.ending);
        ending.map(|(_, time)| time.to_string()).unwrap_or_default()
    }
}

/// Longest duration of a run of a study (s), and shortest time between two of its stops (s): what lies outside is a slip
/// of the keyboard that would never end.
pub const LONGEST: f64 = 1e6;
/// See [`LONGEST`].
pub const SHORTEST: f64 = 1e-6;

/// Duration of a run of a study (s): until 20/p after the ground has come to rest, in which a block that is on its way
/// rocks to its greatest rotation or falls over. (A block takes 9.9/p to rise to 0.9999 α, and as long to come down or to
/// fall.)
pub fn duration(ground: &Ground, pulse: &Pulse, block: &Block) -> f64 {
    let start = ground.start();
    let records = ground.end().map_or(0.0, |end| end - start);
    let pulse = if pulse.shape == PulseShape::None { 0.0 } else { pulse.end() - start };
    records.max(pulse) + 20.0 / block.p
}

impl Run {
    /// Makes the run; `progress` is told the part that is done, 0 to 1.
    pub fn history(&self, mut progress: impl FnMut(f64)) -> Result<History, SimulationError> {
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        let simulation = self.drive(&mut |event| events.push(*event), |part, simulation, inputs| {
            rows.push(self.row(simulation, inputs));
            progress(part);
        })?;
        let (peaks, counts, ending) = (simulation.peaks(), simulation.counts(), simulation.ending());
        Ok(History { rows, events, peaks, counts, ending })
    }

    /// Makes the run without keeping its rows. Its stops are those of [`Run::history`], so that its numbers are the same
    /// to the last bit.
    pub fn outcome(&self) -> Result<Outcome, SimulationError> {
        let simulation = self.drive(&mut |_| (), |_, _, _| ())?;
        Ok(Outcome { peaks: simulation.peaks(), counts: simulation.counts(), ending: simulation.ending() })
    }

    /// Makes the run, and shows each event and, at the beginning and at each row, the part that is done, the block and
    /// the inputs.
    fn drive(
        &self,
        events: &mut dyn FnMut(&Event),
        mut row: impl FnMut(f64, &Simulation, &Inputs),
    ) -> Result<Simulation, SimulationError> {
        let start = self.ground.start();
        let (mut inputs, mut until) = self.ground.inputs_from(start);
        let mut simulation = Simulation::new(self.block, self.settings, self.pulse, &self.initial, start, &inputs);
        row(0.0, &simulation, &inputs);
        // The last row is at the end of the run, however long the step before it.
        let rows = ((self.duration / self.output_step * (1.0 - 1e-12)).ceil() as u64).max(1);
        for i in 1..=rows {
            let time = start + if i == rows { self.duration } else { i as f64 * self.output_step };
            let mut ended = false;
            while simulation.time() < time && !ended {
                let stop = until.min(time);
                ended = matches!(simulation.advance(stop, &inputs, events)?, Progress::Ended(..));
                if !ended && stop == until {
                    (inputs, until) = self.ground.inputs_from(stop);
                }
            }
            row(i as f64 / rows as f64, &simulation, &inputs);
            if ended {
                break;
            }
        }
        Ok(simulation)
    }

    fn row(&self, simulation: &Simulation, inputs: &Inputs) -> Row {
        let time = simulation.time();
        let now = inputs.moved_to(time);
        Row {
            time,
            seen: simulation.observe(inputs),
            regime: simulation.regime(),
            energies: simulation.energies(),
            ground: [now.a_gx.value + self.pulse.acceleration(time), now.a_gz.value],
        }
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
