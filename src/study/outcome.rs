//! A run → how it ended, and its greatest values until then.

use crate::contact::Regime;
use crate::simulation::peaks::Peaks;
use crate::simulation::{Counts, Simulation, SimulationError};
use crate::system::surfaces::{Event, EventKind};

/// What a block did, without its history. All numbers are those until the end of the run, however it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// How the run ended.
    pub end: End,
    /// When (s).
    pub end_time: f64,
    /// Greatest values.
    pub peaks: Peaks,
    /// Counters.
    pub counts: Counts,
    /// How often the block left the ground completely, and when first.
    pub flights: Flights,
    /// Why the run failed, if it did.
    pub failure: Option<SimulationError>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The block stands: it is at rest, or bound to come to rest without overturning.
    Completed,
    /// The block overturned: it lies on its side, or it left its supports on the way over (see
    /// [`Ending::at_separation`](crate::simulation::Ending::at_separation)).
    Overturned,
    /// At complete separation, where the run ends there.
    Separated,
    /// The duration was over while the ground still moved or the block might still overturn.
    Undecided,
    /// The integration failed.
    Failed,
}

/// The word that stands in tables.
impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.word())
    }
}

impl End {
    /// All of them.
    pub const ALL: [End; 5] = [End::Completed, End::Overturned, End::Separated, End::Undecided, End::Failed];

    /// The word that stands in tables.
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

    /// The outcome of a word of a table.
    fn from_str(word: &str) -> Result<End, String> {
        End::ALL.into_iter().find(|end| end.word() == word).ok_or_else(|| {
            let known = End::ALL.map(End::word).join(", ");
            format!("found outcome `{word}`; expected one of {known}")
        })
    }
}

/// Complete separations of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flights {
    /// How many there were; each begins where no corner touches any more. A corner that bounces begins another one.
    pub count: u32,
    /// When the first began (s).
    pub first: Option<f64>,
}

impl Flights {
    /// Counts a block that is in the air from the beginning.
    pub(super) fn begin(&mut self, simulation: &Simulation) {
        if simulation.regime() == Regime::Separated {
            self.add(simulation.time());
        }
    }

    /// Counts an event after which the block is in the air where it was not before.
    pub(super) fn see(&mut self, event: &Event) {
        let touched = match event.kind {
            EventKind::Landing(_) => true,
            EventKind::LiftOff(_) | EventKind::Slip | EventKind::Grip | EventKind::Overturning => {
                event.before != Regime::Separated
            }
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
    /// Names and units of the columns that [`Outcome::fields`] fills.
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

    /// The outcome of a block of slenderness α (rad) as it stands in tables, in digits that bring numbers back exactly;
    /// nothing stands for the time of a separation that did not come.
    pub fn fields(&self, alpha: f64) -> [String; Outcome::COLUMNS.len()] {
        let Outcome { end, end_time, peaks, counts, flights, .. } = self;
        [
            end.to_string(),
            end_time.to_string(),
            (peaks.theta / alpha).to_string(),
            peaks.uplift.to_string(),
            peaks.reaction.to_string(),
            peaks.horizontal.to_string(),
            peaks.friction_demand.to_string(),
            flights.first.map(|time| time.to_string()).unwrap_or_default(),
            flights.count.to_string(),
            counts.impacts.to_string(),
            counts.liftoffs.to_string(),
        ]
    }
}
