//! A block, its beginning and its ground → what it does, at evenly spaced times.

use crate::block::Block;
use crate::events::Event;
use crate::excitation::{Inputs, Pulse};
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
    /// Time between two rows of the history (s).
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

impl Run {
    /// Makes the run; `progress` is told the part that is done, 0 to 1.
    pub fn history(&self, mut progress: impl FnMut(f64)) -> Result<History, SimulationError> {
        let start = self.ground.start();
        let (mut inputs, mut until) = self.ground.inputs_from(start);
        let mut simulation = Simulation::new(self.block, self.settings, self.pulse, &self.initial, start, &inputs);
        let mut history = History {
            rows: vec![self.row(&simulation, &inputs)],
            events: Vec::new(),
            peaks: simulation.peaks(),
            counts: simulation.counts(),
            ending: None,
        };
        // The last row is at the end of the run, however long the step before it.
        let rows = (self.duration / self.output_step * (1.0 - 1e-12)).ceil() as u64;
        for i in 1..=rows {
            let time = start + if i == rows { self.duration } else { i as f64 * self.output_step };
            while simulation.time() < time {
                let stop = until.min(time);
                let reached = simulation.advance(stop, &inputs, &mut |event| history.events.push(*event))?;
                if let Progress::Ended(ending, at) = reached {
                    history.ending = Some((ending, at));
                    break;
                }
                if stop == until {
                    (inputs, until) = self.ground.inputs_from(stop);
                }
            }
            history.rows.push(self.row(&simulation, &inputs));
            if history.ending.is_some() {
                break;
            }
            progress(i as f64 / rows as f64);
        }
        history.peaks = simulation.peaks();
        history.counts = simulation.counts();
        Ok(history)
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
