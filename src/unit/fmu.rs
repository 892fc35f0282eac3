//! The trait between the units and the C interfaces: all that [`crate::fmi`] needs of a unit.

use std::fmt::{Debug, Display};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::run::{Ending, Progress};
use crate::unit::attributes::{Kind, Known};
use crate::unit::fault::Fault;
use crate::unit::life_cycle::{Interface, LifeCycle, Phase};

/// A safe state machine without pointers and messages, which both C interfaces serve. A copy of it is a saved state.
///
/// Variables are known by their value references. A refused call changes nothing. Errors of all methods are those of [`Fault`]: a variable, a
/// value or a time that does not fit, or values that make no block.
#[expect(clippy::missing_errors_doc, reason = "the kinds of errors are those above")]
pub trait Fmu: Clone + Debug + Serialize + DeserializeOwned {
    /// An event of a run, as a line of text.
    type Event: Display;
    /// A direction of inputs, parameters and start time, in Initialization Mode.
    type Direction: Default;

    /// `guid` of FMI 2.0.
    const GUID: &'static str;
    /// `instantiationToken` of FMI 3.0.
    const TOKEN: &'static str;
    /// Version of the content of a serialized state. Raise it with every change of the fields.
    const CONTENT_VERSION: u32;
    /// Number of variables in FMI 3.0. Their references count from 1.
    const VARIABLES: usize;

    /// Makes a new instance with start values.
    fn new(interface: Interface) -> Self;
    /// Returns interface type, state and experiment.
    fn life(&self) -> &LifeCycle;
    /// Returns interface type, state and experiment for a change.
    fn life_mut(&mut self) -> &mut LifeCycle;
    /// Whether this can be a state of this FMU, which a checksum cannot ensure.
    fn is_valid(&self) -> bool;
    /// Returns the present time (s); before initialization, the planned start.
    fn time(&self) -> f64;

    /// Returns the variable with this value reference.
    fn known(reference: u32) -> Option<Known>;
    /// Refuses references to unknown variables or variables of another type.
    fn check(references: &[u32], kind: Kind) -> Result<(), Fault>;
    /// Refuses a value that is not finite or outside the limits of a variable.
    fn admits(reference: u32, value: f64) -> Result<(), Fault>;
    /// Returns the value of a variable. Integers and Booleans (0 or 1) become real numbers.
    fn get(&mut self, kind: Kind, reference: u32) -> Result<f64, Fault>;
    /// Sets values of one type, all or none.
    fn set<V: Copy>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &[V],
        real: impl Fn(V) -> f64,
    ) -> Result<(), Fault>;
    /// Returns the text of a variable.
    fn text(&self, reference: u32) -> Result<&str, Fault>;
    /// Sets texts, all or none.
    fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Result<(), Fault>;

    /// Returns the number of values of a variable, more than 1 of an array of FMI 3.0.
    fn size(&self, reference: u32) -> usize;
    /// Passes the values of a Float64 that only FMI 3.0 has to `give`.
    fn read_fmi3_variable(&mut self, reference: u32, give: &mut dyn FnMut(f64)) -> Result<(), Fault>;
    /// Sets all values of a Float64 that only FMI 3.0 has.
    fn set_fmi3_variable(&mut self, reference: u32, values: &[f64]) -> Result<(), Fault>;
    /// Returns a size of arrays.
    fn array_size(&self, reference: u32) -> u64;
    /// Sets a size of arrays, whose elements become zero.
    fn resize(&mut self, reference: u32, size: u64) -> Result<(), Fault>;
    /// Whether the variable is the time.
    fn is_time(reference: u32) -> bool;
    /// Returns the time between two intermediate updates (s).
    fn interval(&self) -> f64;

    /// Sets tolerance, start and stop of the run. Returns the tolerance used if it differs from the requested one.
    fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault>;
    /// Begins initialization.
    fn enter_initialization_mode(&mut self);
    /// Makes a block of the values. Returns the parameters that were set but are not read, each with the setting that it needs.
    fn exit_initialization_mode(&mut self) -> Result<Vec<(&'static str, &'static str)>, Fault>;
    /// Returns the sizes of the block that are read but unset, with their start values.
    fn unset_sizes(&self) -> Vec<(&'static str, f64)>;
    /// Returns to the state after instantiation.
    fn reset(&mut self) {
        *self = Self::new(self.life().interface);
    }
    /// Moves the instance to a state without further effects.
    fn set_phase(&mut self, phase: Phase) {
        self.life_mut().phase = phase;
    }

    /// Advances by `step` (s) from `time` (s) and reports each event. Allocates no memory unless it fails.
    fn advance(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Self::Event)) -> Result<Progress, Fault>;
    /// Sets the time derivatives of inputs over the next step, of order 1.
    fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Fault>;
    /// Returns the exact time derivatives of outputs, of order 1.
    fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault>;
    /// Whether separation or overturning has ended the run.
    fn has_ended(&self) -> bool;

    /// Begins a step in parts as [`Fmu::advance`] does, and returns its end (s).
    fn begin_substeps(&mut self, time: f64, step: f64, observer: &mut dyn FnMut(&Self::Event)) -> Result<f64, Fault>;
    /// Whether [`Fmu::do_substep`] needs the inputs of a new part.
    fn needs_substep(&self) -> bool;
    /// Whether the block is at rest and stays so unless the inputs change.
    fn rests(&self) -> bool;
    /// Begins a part that ends at `end` (s), where inputs can be set by [`Fmu::set_ahead`].
    fn begin_setting_ahead(&mut self, end: f64);
    /// Sets an input at the end of the new part.
    fn set_ahead(&mut self, reference: u32, value: f64);
    /// Makes the inputs linear from their present values to those at the end.
    fn end_setting_ahead(&mut self);
    /// Advances to the end of the part, to `until` (s), or to the first event later than `after` (s), if given.
    fn do_substep(
        &mut self,
        until: f64,
        after: Option<f64>,
        observer: &mut dyn FnMut(&Self::Event),
    ) -> Result<Reached, Fault>;
    /// Leaves the present step, which would have ended at `end` (s).
    fn leave_step(&mut self, end: f64) {
        let time = self.time();
        self.life_mut().leave_step(time, end);
    }
    /// Applies the event at which a step was left, if any.
    fn apply_pending_event(&mut self, observer: &mut dyn FnMut(&Self::Event)) -> Result<(), Fault>;
    /// Enters Event Mode. The present inputs acted up to now.
    fn enter_event_mode(&mut self);

    /// Returns directional derivatives of outputs at the present time or, in Initialization Mode, also of calculated parameters.
    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault>;
    /// Adds components of a variable to a direction, of an array from the index `first` on.
    fn add_to_direction(
        direction: &mut Self::Direction,
        reference: u32,
        first: usize,
        components: &[f64],
    ) -> Result<(), Fault>;
    /// Returns directional derivatives in Initialization Mode.
    fn initial_directional_derivative(
        &mut self,
        unknowns: &[u32],
        direction: &Self::Direction,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault>;

    /// Model Exchange: returns the number of continuous states.
    fn state_count(&self) -> usize;
    /// Model Exchange: returns the number of event indicators.
    fn indicator_count(&self) -> usize;
    /// Model Exchange: applies the events of the present time.
    fn pass_events(&mut self, observer: &mut dyn FnMut(&Self::Event)) -> Result<AfterEvent, Fault>;
    /// Model Exchange: sets the time (s).
    fn set_time(&mut self, time: f64) -> Result<(), Fault>;
    /// Model Exchange: sets the continuous states.
    fn set_states(&mut self, states: &[f64]) -> Result<(), Fault>;
    /// Model Exchange: passes numbers of this kind to `give`.
    fn exchanged(&mut self, numbers: Exchanged, give: &mut dyn FnMut(&[f64])) -> Result<(), Fault>;
    /// Model Exchange: accepts a step of the importer's solver.
    fn complete_step(&mut self);
}

/// The numbers of Model Exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exchanged {
    /// The continuous states.
    States,
    /// Their derivatives.
    Derivatives,
    /// Their nominal values.
    Nominals,
    /// The event indicators.
    Indicators,
}

/// Information for the importer after an event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AfterEvent {
    /// Whether the run ended.
    pub ended: bool,
    /// Whether states may have changed.
    ///
    /// True at each event of Model Exchange: derivatives change, redundant states are projected, and some importers restart
    /// their solver only then.
    pub states_changed: bool,
    /// Time of the next kink of the excitation or predicted event (s), the earlier one.
    pub next_time: Option<f64>,
}

/// Progress of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// The end of the part, or of the step.
    End,
    /// An event, not yet applied.
    Event,
    /// The end of the run, at this time (s).
    Ended(Ending, f64),
}

/// Refuses an array of the wrong length.
///
/// # Errors
/// Another length, with the expected one.
pub fn counted(found: usize, expected: usize, what: &str) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::new(format!("room for {found} {what}; expected {expected}")))
}
