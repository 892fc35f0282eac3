//! An instance of any version of FMI: a unit, statuses and messages, without pointers.

use std::ffi::CString;
use std::mem::MaybeUninit;

use crate::fmi::log::{Category, Log};
use crate::fmi::{Status, Version, calls};
use crate::unit::attributes::Kind;
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, Exchanged, Fmu, counted};
use crate::unit::life_cycle::{Interface, Phase};

/// Result of a call. A fault becomes the error status and a message.
pub type Answer = Result<Status, Fault>;

/// An instance: its state, its log and its version's own fields.
#[derive(Debug)]
pub struct Instance<V: Version> {
    /// The importer's log.
    pub log: Log<V::Messenger>,
    /// The content of a saved state.
    pub unit: V::Unit,
    /// Fields of this version of FMI.
    pub version: V,
    /// Strings returned to the importer, kept until its next request for strings.
    texts: Vec<CString>,
}

impl<V: Version> Instance<V> {
    /// Makes a new instance with start values.
    pub fn new(log: Log<V::Messenger>, interface: Interface, version: V) -> Instance<V> {
        Instance { log, unit: V::Unit::new(interface), version, texts: Vec::new() }
    }

    /// Refuses a call that is illegal in the present state.
    ///
    /// # Errors
    /// The call is illegal in this state; the error names the states in which it is legal.
    pub fn admit(&self, call: V::Call) -> Result<(), Fault> {
        calls::admit::<V>(call, self.unit.life().phase, self.unit.life().interface).map_err(Fault)
    }

    /// Whether a panic was caught in an earlier call.
    pub fn is_fatal(&self) -> bool {
        self.unit.life().phase == Phase::Fatal
    }

    /// Chooses the categories that are logged.
    ///
    /// # Errors
    /// An unknown category.
    pub fn set_debug_logging(&mut self, logging: bool, names: &[&str]) -> Answer {
        let categories = names
            .iter()
            .map(|name| {
                Category::ALL.into_iter().find(|c| c.name().to_bytes() == name.as_bytes()).ok_or_else(|| {
                    let known = Category::ALL.map(|c| c.name().to_string_lossy()).join(", ");
                    Fault::new(format!("log category {name:?} does not exist; expected one of {known}"))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        self.log.choose(logging, (!names.is_empty()).then_some(&categories));
        Ok(Status::Ok)
    }

    /// Sets tolerance, start and stop of the run.
    ///
    /// # Errors
    /// Those of [`Fmu::plan`].
    pub fn plan(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Answer {
        match (tolerance, self.unit.plan(tolerance, start, stop)?) {
            (Some(tolerance), Some(used)) => {
                self.log.status(Status::Warning, &format!("tolerance = {tolerance:e} is taken as {used:e}"));
                Ok(Status::Warning)
            }
            _ => Ok(Status::Ok),
        }
    }

    /// Makes a block of the values. A refusal lets the importer correct them.
    ///
    /// # Errors
    /// Those of [`Fmu::exit_initialization_mode`].
    pub fn exit_initialization_mode(&mut self) -> Answer {
        let unread = self.unit.exit_initialization_mode()?;
        let unset = self.unit.unset_sizes();
        let unread: Vec<String> = unread.iter().map(|(name, needed)| format!("{name} needs {needed}")).collect();
        let unset: Vec<String> = unset.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let warnings = [
            ("set, but not read with the other parameters as they are", unread),
            ("not set, but read with parameterization = Physical", unset),
        ];
        let mut status = Status::Ok;
        for (why, parameters) in warnings.into_iter().filter(|(_, parameters)| !parameters.is_empty()) {
            status = Status::Warning;
            self.log.status(status, &format!("{why}: {}", parameters.join(", ")));
        }
        Ok(status)
    }

    /// Sets values of one type, all or none.
    ///
    /// # Errors
    /// Those of [`Fmu::set`].
    pub fn set<T: Copy>(&mut self, kind: Kind, references: &[u32], values: &[T], real: impl Fn(T) -> f64) -> Answer {
        self.unit.set(kind, references, values, real)?;
        Ok(Status::Ok)
    }

    /// Reads values of one type.
    ///
    /// # Errors
    /// Those of [`Fmu::check`] and [`Fmu::get`].
    pub fn get<T>(
        &mut self,
        kind: Kind,
        references: &[u32],
        values: &mut [MaybeUninit<T>],
        convert: impl Fn(f64) -> T,
    ) -> Answer {
        V::Unit::check(references, kind)?;
        let (unit, mut lost) = (&mut self.unit, None);
        let results = references.iter().map(|&reference| {
            let value = unit.get(kind, reference)?;
            if !value.is_finite() {
                lost = lost.or(V::Unit::known(reference).map(|known| known.name));
            }
            Ok(convert(value))
        });
        write(results, values)?;
        match lost {
            None => Ok(Status::Ok),
            Some(name) => Ok(self.answer_without_numbers(name)),
        }
    }

    /// Answers a request whose result is not finite.
    ///
    /// In Model Exchange the importer's solver may have set impossible states and can go back, so the call is discarded. In
    /// Co-Simulation the step before has reported an error.
    pub fn answer_without_numbers(&self, what: &str) -> Status {
        if self.unit.life().interface == Interface::CoSimulation {
            return Status::Ok;
        }
        let message = format!("{what} is not finite; expected states, inputs and loads of possible size");
        self.log.status(Status::Discard, &message);
        Status::Discard
    }

    /// Sets texts, all or none.
    ///
    /// # Errors
    /// Those of [`Fmu::set_texts`].
    pub fn set_texts(&mut self, references: &[u32], texts: &[&str]) -> Answer {
        self.unit.set_texts(references, texts)?;
        Ok(Status::Ok)
    }

    /// Reads texts.
    ///
    /// # Errors
    /// Those of [`Fmu::text`].
    pub fn get_texts(&mut self, references: &[u32]) -> Result<&[CString], Fault> {
        let text = |&reference| {
            let text = self.unit.text(reference)?;
            CString::new(text).map_err(|_| Fault::new(format!("{text:?} holds a 0; expected none")))
        };
        self.texts = references.iter().map(text).collect::<Result<_, _>>()?;
        Ok(&self.texts)
    }

    /// Returns the time derivatives of outputs, of order 1.
    ///
    /// # Errors
    /// Those of [`Fmu::output_derivatives`].
    pub fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [MaybeUninit<f64>],
    ) -> Answer {
        write(self.unit.output_derivatives(references, orders)?, values)
    }

    /// Returns derivatives in a direction of variables and, in FMI 3.0, of time.
    ///
    /// # Errors
    /// Those of [`Fmu::directional_derivative`].
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
        sensitivities: &mut [MaybeUninit<f64>],
    ) -> Answer {
        let mut lost = false;
        let results = self.unit.directional_derivative(unknowns, knowns, direction, time)?;
        write(results.inspect(|result| lost |= result.as_ref().is_ok_and(|x| !x.is_finite())), sensitivities)?;
        if lost { Ok(self.answer_without_numbers("a derivative")) } else { Ok(Status::Ok) }
    }

    /// Model Exchange: applies an event. One call suffices.
    ///
    /// # Errors
    /// Those of [`Fmu::pass_events`].
    pub fn new_discrete_states(&mut self) -> Result<AfterEvent, Fault> {
        let log = &self.log;
        self.unit.pass_events(&mut |event| log.tell(Status::Ok, Category::Events, format_args!("{event}")))
    }

    /// Sets the time (s).
    ///
    /// # Errors
    /// Those of [`Fmu::set_time`].
    pub fn set_time(&mut self, time: f64) -> Answer {
        self.unit.set_time(time)?;
        Ok(Status::Ok)
    }

    /// Sets the continuous states.
    ///
    /// # Errors
    /// Those of [`Fmu::set_states`].
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Answer {
        self.unit.set_states(states)?;
        Ok(Status::Ok)
    }

    /// Returns the states, derivatives, nominal values or event indicators of Model Exchange.
    ///
    /// # Errors
    /// An array of another length, and the errors of [`Fmu::exchanged`].
    pub fn get_exchanged(&mut self, numbers: Exchanged, values: &mut [MaybeUninit<f64>]) -> Answer {
        let expected = match numbers {
            Exchanged::States | Exchanged::Derivatives | Exchanged::Nominals => self.unit.state_count(),
            Exchanged::Indicators => self.unit.indicator_count(),
        };
        counted(values.len(), expected, "numbers")?;
        let mut lost = false;
        self.unit.exchanged(numbers, &mut |numbers| {
            lost = numbers.iter().any(|number| !number.is_finite());
            if !lost {
                values.iter_mut().zip(numbers).for_each(|(value, &number)| _ = value.write(number));
            }
        })?;
        if lost { Ok(self.answer_without_numbers("a derivative or an event indicator")) } else { Ok(Status::Ok) }
    }

    /// Restores a saved state.
    ///
    /// # Errors
    /// Those of [`Instance::check_restorable`].
    pub fn restore(&mut self, saved: &V::Unit) -> Answer {
        self.check_restorable(saved)?;
        self.unit.clone_from(saved);
        Ok(Status::Ok)
    }

    /// Refuses a state of the other interface type, or of another version of FMI alone.
    ///
    /// # Errors
    /// The refused state, with the expected one.
    pub fn check_restorable(&self, saved: &V::Unit) -> Result<(), Fault> {
        let (found, expected) = (saved.life().interface, self.unit.life().interface);
        if found != expected {
            return Err(Fault::new(format!("the state is one of {found:?}; expected one of {expected:?}")));
        }
        let phase = saved.life().phase;
        if V::reached(expected) & phase.bit() == 0 {
            return Err(Fault::new(format!(
                "the state was saved in {phase:?}; expected one to which calls of this version of FMI lead in {expected:?}"
            )));
        }
        Ok(())
    }
}

/// Returns the body of a call that only moves the instance to a state.
pub fn moves_to<V: Version>(phase: Phase) -> impl FnOnce(&mut Instance<V>) -> Answer {
    always(move |unit: &mut V::Unit| unit.set_phase(phase))
}

/// Returns the body of a call that never fails: an operation of the unit.
pub fn always<V: Version>(act: impl FnOnce(&mut V::Unit)) -> impl FnOnce(&mut Instance<V>) -> Answer {
    |instance| {
        act(&mut instance.unit);
        Ok(Status::Ok)
    }
}

/// Writes results to the importer's memory.
///
/// # Errors
/// The first error among the results.
pub fn write<T>(results: impl Iterator<Item = Result<T, Fault>>, elements: &mut [MaybeUninit<T>]) -> Answer {
    for (result, element) in results.zip(elements) {
        element.write(result?);
    }
    Ok(Status::Ok)
}
