//! A run → its end, its peaks and its counts.

use crate::mismatch::Mismatch;
use crate::output::table::TableColumn;
use rocking_block::block::restraints::{self, LinkKind, MAX, Tie, tie};
use rocking_block::block::{Block, Corner, Regime};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Counts, Simulation, SimulationError};
use rocking_block::system::events::{Event, EventKind};

/// The result of a run without its history. All numbers refer to the run until its end.
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
    /// Complete separations: the last touching corner leaves the ground. Bounces count again.
    pub flights: Count,
    /// Rotation past the balance and at the end.
    pub lean: Tilt,
    /// Ties and dampers that broke.
    pub breaks: Count,
    /// Slenderness α of the block (rad).
    pub alpha: f64,
    /// Number of ties of the block, before whose dampers they are numbered.
    pub ties: usize,
    /// Reason of a failure.
    pub failure: Option<SimulationError>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The block stands: it is at rest, or will come to rest without overturning.
    Completed,
    /// The block overturned: it lies on its side, or left its supports while overturning. See
    /// [`Ending::at_separation`](rocking_block::simulation::Ending::at_separation).
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
    type Err = Mismatch;

    /// Reads a word of a table.
    fn from_str(word: &str) -> Result<End, Mismatch> {
        let known = || format!("one of {}", End::ALL.map(End::word).join(", "));
        let found = End::ALL.into_iter().find(|end| end.word() == word);
        found.ok_or_else(|| Mismatch::new(format!("outcome `{word}`"), known()))
    }
}

/// Least peak |θ|/α (1) of a block that rocks.
///
/// Accelerations just above uplift leave peaks down to 1e-19, whose logarithms would dominate means and deviations.
pub const MIN_ROCKING: f64 = 1e-3;

/// Whether a block that stands has rocked: it lifted off and reached [`MIN_ROCKING`]. `liftoffs` is the number of its lift-offs, where it is
/// known.
pub fn rocks(peak: f64, liftoffs: Option<f64>) -> bool {
    peak >= MIN_ROCKING && liftoffs != Some(0.0)
}

/// Friction, ties and dampers of blocks, which have additional columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holds {
    /// Whether a coefficient of friction limits the horizontal reaction.
    pub friction: bool,
    /// Number of ties.
    pub ties: usize,
    /// Number of dampers.
    pub dampers: usize,
    /// Whether a tie or damper can yield.
    pub yields: bool,
}

impl Holds {
    /// Those of a block.
    pub fn of(block: &Block) -> Holds {
        Holds::of_parts(block.friction, block.ties())
    }

    /// Those of a block with this friction and these ties and dampers.
    pub fn of_parts(friction: f64, ties: &[Tie]) -> Holds {
        let count = |kind| ties.iter().filter(|tie| tie.kind == kind).count();
        Holds {
            friction: friction > 0.0,
            ties: count(LinkKind::Tie),
            dampers: count(LinkKind::Damper),
            yields: ties.iter().any(Tie::yields),
        }
    }

    /// Those of either.
    pub fn or(self, other: Holds) -> Holds {
        Holds {
            friction: self.friction || other.friction,
            ties: self.ties.max(other.ties),
            dampers: self.dampers.max(other.dampers),
            yields: self.yields || other.yields,
        }
    }
}

impl Holds {
    /// Kinds of the ties and dampers, and their numbers within these, from 0.
    pub fn links(self) -> impl Iterator<Item = (LinkKind, usize)> {
        let of_kind = |kind, count| (0..count).map(move |i| (kind, i));
        of_kind(LinkKind::Tie, self.ties).chain(of_kind(LinkKind::Damper, self.dampers))
    }

    /// Whether there is a tie or a damper.
    pub fn has_links(self) -> bool {
        self.ties + self.dampers > 0
    }
}

impl Outcome {
    /// Returns the number of the tie or damper with this number of its kind.
    pub fn number(&self, kind: LinkKind, i: usize) -> usize {
        match kind {
            // The places behind the ties of this block are its dampers.
            LinkKind::Tie if i >= self.ties => MAX,
            LinkKind::Tie => i,
            LinkKind::Damper => self.ties + i,
        }
    }
}

/// The columns of the outcomes of blocks. Those of friction, ties and dampers are there if a block has any.
///
/// `of` takes the outcome from a row. The time of the first separation is missing where there is none.
pub fn columns<'c, R: 'c>(holds: Holds, of: fn(&R) -> &Outcome) -> Vec<TableColumn<'c, R>> {
    let mut columns = vec![
        TableColumn::choice("outcome", End::ALL.map(End::word), move |row| of(row).end as usize),
        TableColumn::real("end_time", "s", move |row| of(row).end_time),
        TableColumn::real("peak.theta/alpha", "1", move |row| of(row).peaks.theta / of(row).alpha),
        TableColumn::real("peak.uplift", "m", move |row| of(row).peaks.uplift),
        TableColumn::real("peak.N", "N", move |row| of(row).peaks.reaction),
        TableColumn::real("peak.H", "N", move |row| of(row).peaks.horizontal),
        TableColumn::real("peak.friction_demand", "1", move |row| of(row).peaks.friction_demand),
        TableColumn::optional("first_separation", "s", move |row| of(row).flights.first),
        TableColumn::count("flights", move |row| of(row).flights.count),
        TableColumn::count("events.impacts", move |row| of(row).counts.impacts),
        TableColumn::count("events.liftoffs", move |row| of(row).counts.liftoffs),
    ];
    if holds.friction {
        columns.push(TableColumn::real("peak.slip", "m", move |row| of(row).peaks.slip));
    }
    for (kind, i) in holds.links() {
        let name = |quantity: &str| format!("peak.{}_{}.{quantity}", kind.word(), i + 1);
        let at = move |row: &R, all: &[f64; MAX]| all.get(of(row).number(kind, i)).copied().unwrap_or_default();
        let pull = move |row: &R| at(row, &of(row).peaks.pull);
        columns.push(TableColumn::real(name(kind.force()), "N", pull));
        if kind == LinkKind::Tie {
            let shortening = move |row: &R| at(row, &of(row).peaks.elongation);
            columns.push(TableColumn::real(name("shortening"), "m", shortening));
        }
        if holds.yields {
            columns.push(TableColumn::real(name("plastic"), "m", move |row| at(row, &of(row).peaks.plastic)));
        }
    }
    if holds.has_links() {
        // Ties may hold a block beyond its balance.
        columns.extend([
            TableColumn::real("peak.theta/balance", "1", move |row| of(row).lean.over_balance),
            TableColumn::real("end.theta/alpha", "1", move |row| of(row).lean.end / of(row).alpha),
            TableColumn::count("ties.broken", move |row| of(row).breaks.count),
            TableColumn::optional("first_break", "s", move |row| of(row).breaks.first),
        ]);
    }
    columns
}

/// Incidents of a run, counted from its events.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EventCounts {
    pub flights: Count,
    pub breaks: Count,
}

impl EventCounts {
    /// Starts with the flight of a block that is in the air.
    pub fn begin(simulation: &Simulation) -> EventCounts {
        let mut event_counts = EventCounts::default();
        if simulation.regime() == Regime::Separated {
            event_counts.flights.add(simulation.time());
        }
        event_counts
    }

    /// Counts an event that begins a flight, or breaks a tie or a damper.
    pub fn count_event(&mut self, event: &Event) {
        let touched = match event.kind {
            EventKind::Landing(_) => true,
            EventKind::LiftOff(_)
            | EventKind::Slip
            | EventKind::Grip
            | EventKind::Restraint(_)
            | EventKind::Overturning => event.before != Regime::Separated,
        };
        if touched && event.after == Regime::Separated {
            self.flights.add(event.time);
        }
        if matches!(event.kind, EventKind::Restraint(restraints::RestraintEvent::Tie(_, _, tie::TieEvent::Break))) {
            self.breaks.add(event.time);
        }
    }
}

/// The occurrences of an incident in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// Their number.
    pub count: u32,
    /// Time of the first (s).
    pub first: Option<f64>,
}

impl Count {
    fn add(&mut self, time: f64) {
        self.count += 1;
        self.first.get_or_insert(time);
    }
}

/// How far a block leans, over the balance. That is the rotation that puts the centre of mass over the corner it stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tilt {
    /// Peak |θ| over the balance angle of its side. Beyond 1 the block needs more than its weight to come back.
    pub over_balance: f64,
    /// Rotation θ at the end of the run (rad).
    pub end: f64,
    peak: f64,
}

impl Tilt {
    /// Rotation at rest (α) from which a block is tilted rather than upright. The round-off of rest on supports is below.
    const TILTED: f64 = 0.01;

    /// Whether the block passed its balance.
    pub fn passed_balance(&self) -> bool {
        self.over_balance > 1.0
    }

    /// Whether a block of slenderness α (rad) that rests at the end leans.
    pub fn is_tilted(&self, alpha: f64) -> bool {
        self.end.abs() > Tilt::TILTED * alpha
    }

    /// Includes the motion of an uneven block since the last stop. The end of the run has that of an even one.
    ///
    /// Both sides of a block share a peak. An uneven one has it on the side on which it is when the peak has risen.
    #[inline]
    pub(super) fn follow(&mut self, simulation: &Simulation) {
        let block = simulation.block();
        if block.eccentricity == 0.0 {
            return;
        }
        let (peak, theta) = (simulation.peaks().theta, simulation.state()[0]);
        let side = if theta < 0.0 { Corner::Left } else { Corner::Right };
        let rotation = if peak > self.peak { peak } else { theta.abs() };
        self.over_balance = self.over_balance.max(rotation / block.alpha_of(side));
        self.peak = peak;
    }

    /// Returns the lean of a run that ends with this simulation.
    pub(super) fn at_end(mut self, simulation: &Simulation) -> Tilt {
        let block = simulation.block();
        self.follow(simulation);
        if block.eccentricity == 0.0 {
            self.over_balance = simulation.peaks().theta / block.alpha;
        }
        Tilt { end: simulation.state()[0], ..self }
    }
}
