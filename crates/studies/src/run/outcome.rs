//! A run → its end, its peaks and its counts.

use crate::output::fields::Fields;
use rocking_block::block::{Block, Regime};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Counts, Simulation, SimulationError};
use rocking_block::system::events::{Event, EventKind};

/// The result of a run without its history; all numbers refer to the run until its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// How the run ended.
    pub end: End,
    /// Time of the end (s).
    pub end_time: f64,
    /// Greatest values.
    pub peaks: Peaks,
    /// Counters.
    pub counts: Counts,
    /// Complete separations.
    pub flights: Flights,
    /// Reason of a failure.
    pub failure: Option<SimulationError>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The block stands: it is at rest, or will come to rest without overturning.
    Completed,
    /// The block overturned: it lies on its side, or it left its supports while overturning (see
    /// [`Ending::at_separation`](rocking_block::simulation::Ending::at_separation)).
    Overturned,
    /// The run ended at complete separation, as its settings require.
    Separated,
    /// The duration ended while the ground still moved or the block could still overturn.
    Undecided,
    /// The integration failed.
    Failed,
}

/// The word in tables.
impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.word())
    }
}

impl End {
    /// All variants.
    pub const ALL: [End; 5] = [End::Completed, End::Overturned, End::Separated, End::Undecided, End::Failed];

    /// The word in tables.
    pub fn word(self) -> &'static str {
        match self {
            End::Completed => "completed",
            End::Overturned => "overturned",
            End::Separated => "separated",
            End::Undecided => "undecided",
            End::Failed => "failed",
        }
    }
}

impl std::str::FromStr for End {
    type Err = String;

    /// Reads a word of a table.
    fn from_str(word: &str) -> Result<End, String> {
        End::ALL.into_iter().find(|end| end.word() == word).ok_or_else(|| {
            let known = End::ALL.map(End::word).join(", ");
            format!("found outcome `{word}`; expected one of {known}")
        })
    }
}

/// Friction and ties of blocks. Their peaks have additional columns after [`Outcome::COLUMNS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holds {
    /// Whether a coefficient of friction limits the horizontal reaction.
    pub friction: bool,
    /// Number of ties.
    pub ties: usize,
}

impl Holds {
    /// Those of a block.
    pub fn of(block: &Block) -> Holds {
        Holds { friction: block.friction > 0.0, ties: block.ties().len() }
    }

    /// Those of either.
    pub fn or(self, other: Holds) -> Holds {
        Holds { friction: self.friction || other.friction, ties: self.ties.max(other.ties) }
    }

    /// Names and units of the columns filled by [`Holds::fields`].
    pub fn columns(self) -> Vec<String> {
        let slip = self.friction.then(|| "peak.slip [m]".to_string());
        slip.into_iter().chain((1..=self.ties).map(|tie| format!("peak.tie_{tie}.tension [N]"))).collect()
    }

    /// The peaks of the slip and of the tensions, the fields of [`Holds::columns`].
    pub fn fields(self, peaks: &Peaks) -> impl Iterator<Item = f64> {
        let slip = self.friction.then_some(peaks.slip);
        slip.into_iter().chain(peaks.pull.into_iter().take(self.ties))
    }
}

/// Complete separations of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flights {
    /// Number of times the last touching corner left the ground; bounces count again.
    pub count: u32,
    /// Time at which the first began (s).
    pub first: Option<f64>,
}

impl Flights {
    /// Counts a block that starts in the air.
    pub(super) fn begin(&mut self, simulation: &Simulation) {
        if simulation.regime() == Regime::Separated {
            self.add(simulation.time());
        }
    }

    /// Counts an event that begins a flight.
    pub(super) fn count_event(&mut self, event: &Event) {
        let touched = match event.kind {
            EventKind::Landing(_) => true,
            EventKind::LiftOff(_)
            | EventKind::Slip
            | EventKind::Grip
            | EventKind::Restraint(_)
            | EventKind::Overturning => event.before != Regime::Separated,
        };
        if touched && event.after == Regime::Separated {
            self.add(event.time);
        }
    }

    fn add(&mut self, time: f64) {
        self.count += 1;
        self.first.get_or_insert(time);
    }
}

impl Outcome {
    /// Names and units of the columns filled by [`Outcome::write`].
    pub const COLUMNS: [&'static str; 11] = [
        "outcome",
        "end_time [s]",
        "peak.theta/alpha [1]",
        "peak.uplift [m]",
        "peak.N [N]",
        "peak.H [N]",
        "peak.friction_demand [1]",
        "first_separation [s]",
        "flights [1]",
        "events.impacts [1]",
        "events.liftoffs [1]",
    ];

    /// Appends the outcome of a block of slenderness α (rad) to a row, the fields of [`Outcome::COLUMNS`].
    ///
    /// The time of the first separation is empty if there is none.
    pub fn write(&self, alpha: f64, fields: &mut Fields) {
        let Outcome { end, end_time, peaks, counts, flights, .. } = self;
        fields.push(end.word());
        let Peaks { theta, uplift, reaction, horizontal, friction_demand, .. } = *peaks;
        fields.extend([*end_time, theta / alpha, uplift, reaction, horizontal, friction_demand]);
        fields.push_option(flights.first);
        fields.extend([flights.count, counts.impacts, counts.liftoffs]);
    }
}
