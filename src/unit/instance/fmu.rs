//! The planar block as a unit of the C interfaces.

use crate::run::Progress;
use crate::simulation::exchange::{INDICATORS, STATES};
use crate::system::events::Event;
use crate::unit::attributes::{Kind, Known};
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, Exchanged, Fmu, Reached};
use crate::unit::instance::access::known;
use crate::unit::instance::derivatives::Direction;
use crate::unit::instance::{Interface, Unit};
use crate::unit::life_cycle::LifeCycle;
use crate::unit::snapshot::VERSION;
use crate::unit::variables::{FMI3_VARIABLES, Fmi3Variable, GUID, Metadata, Role, TOKEN, VARIABLES};

/// Returns the variable with this value reference if only FMI 3.0 has it.
fn fmi3_variable(reference: u32) -> Option<Fmi3Variable> {
    let index = (reference as usize).checked_sub(VARIABLES.len() + 1)?;
    FMI3_VARIABLES.get(index).map(|metadata| metadata.variable)
}

/// Returns the variable of FMI 3.0 alone behind a reference that the C interfaces have found by [`Fmu::known`].
fn of_fmi3(reference: u32) -> Result<Fmi3Variable, Fault> {
    fmi3_variable(reference).ok_or_else(|| Fault::new(format!("value reference {reference} is not of FMI 3.0 alone")))
}

/// Forwards methods of the trait to those of the same names.
macro_rules! forward {
    ($(fn $name:ident($this:ident: $receiver:ty $(, $argument:ident: $of:ty)*) $(-> $result:ty)?;)*) => {$(
        #[inline]
        fn $name($this: $receiver $(, $argument: $of)*) $(-> $result)? {
            Unit::$name($this $(, $argument)*)
        }
    )*};
}

impl Fmu for Unit {
    type Event = Event;
    type Direction = Direction;

    const GUID: &'static str = GUID;
    const TOKEN: &'static str = TOKEN;
    const CONTENT_VERSION: u32 = VERSION;
    const VARIABLES: usize = VARIABLES.len() + FMI3_VARIABLES.len();

    forward! {
        fn is_valid(self: &Self) -> bool;
        fn time(self: &Self) -> f64;
        fn get(self: &mut Self, kind: Kind, reference: u32) -> Result<f64, Fault>;
        fn text(self: &Self, reference: u32) -> Result<&str, Fault>;
        fn set_texts(self: &mut Self, references: &[u32], texts: &[&str]) -> Result<(), Fault>;
        fn interval(self: &Self) -> f64;
        fn plan(self: &mut Self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Result<Option<f64>, Fault>;
        fn enter_initialization_mode(self: &mut Self);
        fn exit_initialization_mode(self: &mut Self) -> Result<Vec<(&'static str, &'static str)>, Fault>;
        fn unset_sizes(self: &Self) -> Vec<(&'static str, f64)>;
        fn advance(self: &mut Self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<Progress, Fault>;
        fn set_input_derivatives(self: &mut Self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Fault>;
        fn has_ended(self: &Self) -> bool;
        fn begin_substeps(self: &mut Self, time: f64, step: f64, observer: &mut dyn FnMut(&Event)) -> Result<f64, Fault>;
        fn needs_substep(self: &Self) -> bool;
        fn rests(self: &Self) -> bool;
        fn begin_setting_ahead(self: &mut Self, end: f64);
        fn end_setting_ahead(self: &mut Self);
        fn do_substep(self: &mut Self, until: f64, after: Option<f64>, observer: &mut dyn FnMut(&Event)) -> Result<Reached, Fault>;
        fn apply_pending_event(self: &mut Self, observer: &mut dyn FnMut(&Event)) -> Result<(), Fault>;
        fn enter_event_mode(self: &mut Self);
        fn pass_events(self: &mut Self, observer: &mut dyn FnMut(&Event)) -> Result<AfterEvent, Fault>;
        fn set_time(self: &mut Self, time: f64) -> Result<(), Fault>;
        fn set_states(self: &mut Self, states: &[f64]) -> Result<(), Fault>;
        fn complete_step(self: &mut Self);
    }

    fn new(interface: Interface) -> Unit {
        Unit::new(interface)
    }

    #[inline]
    fn state_count(&self) -> usize {
        STATES
    }

    #[inline]
    fn indicator_count(&self) -> usize {
        INDICATORS
    }

    #[inline]
    fn life(&self) -> &LifeCycle {
        &self.life
    }

    #[inline]
    fn life_mut(&mut self) -> &mut LifeCycle {
        &mut self.life
    }

    #[inline]
    fn known(reference: u32) -> Option<Known> {
        match Metadata::of(reference) {
            Some(metadata) => Some(metadata.known()),
            None => fmi3_variable(reference)
                .map(|variable| Known::of_fmi3(variable.name(), variable == Fmi3Variable::RecordSamples)),
        }
    }

    #[inline]
    fn check(references: &[u32], kind: Kind) -> Result<(), Fault> {
        references.iter().try_for_each(|&reference| known(reference, kind).map(|_| ()))
    }

    fn admits(reference: u32, value: f64) -> Result<(), Fault> {
        Metadata::of(reference).map_or(Ok(()), |metadata| metadata.admits(value)).map_err(Fault)
    }

    #[inline]
    fn set<V: Copy>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &[V],
        real: impl Fn(V) -> f64,
    ) -> Result<(), Fault> {
        Unit::set(self, kind, references, values, real)
    }

    fn size(&self, reference: u32) -> usize {
        fmi3_variable(reference).map_or(1, |variable| self.size_of(variable))
    }

    fn read_fmi3_variable(&mut self, reference: u32, give: &mut dyn FnMut(f64)) -> Result<(), Fault> {
        Unit::read_fmi3_variable(self, of_fmi3(reference)?, give)
    }

    fn set_fmi3_variable(&mut self, reference: u32, values: &[f64]) -> Result<(), Fault> {
        Unit::set_fmi3_variable(self, of_fmi3(reference)?, values)
    }

    fn array_size(&self, _: u32) -> u64 {
        self.sample_count() as u64
    }

    fn resize(&mut self, _: u32, size: u64) -> Result<(), Fault> {
        self.resize_samples(size)
    }

    fn is_time(reference: u32) -> bool {
        fmi3_variable(reference) == Some(Fmi3Variable::Time)
    }

    fn set_ahead(&mut self, reference: u32, value: f64) {
        if let Some(Metadata { role: Role::Input(input), .. }) = Metadata::of(reference) {
            Unit::set_ahead(self, *input, value);
        }
    }

    #[inline]
    fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Unit::output_derivatives(self, references, orders)
    }

    #[inline]
    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Unit::directional_derivative(self, unknowns, knowns, direction, time)
    }

    fn add_to_direction(
        direction: &mut Direction,
        reference: u32,
        first: usize,
        components: &[f64],
    ) -> Result<(), Fault> {
        match fmi3_variable(reference) {
            Some(variable) => direction.add_fmi3_variable(variable, first, components),
            None => components.iter().try_for_each(|&component| direction.add(reference, component)),
        }
    }

    fn initial_directional_derivative(
        &mut self,
        unknowns: &[u32],
        direction: &Direction,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>>, Fault> {
        Unit::initial_directional_derivative(self, unknowns, direction)
    }

    #[inline]
    fn exchanged(&mut self, numbers: Exchanged, give: &mut dyn FnMut(&[f64])) -> Result<(), Fault> {
        match numbers {
            Exchanged::States => give(&self.states()?),
            Exchanged::Derivatives => give(&self.derivatives()?),
            Exchanged::Nominals => give(&self.nominals()?),
            Exchanged::Indicators => give(&self.indicators()?),
        }
        Ok(())
    }
}
