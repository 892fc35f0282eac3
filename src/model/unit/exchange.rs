//! Model Exchange: an importer's solver steps the block.

use crate::model::fault::Fault;
use crate::model::life_cycle::Phase;
use crate::model::unit::{Unit, with_ground};
use crate::simulation::exchange::{INDICATORS, STATES, States};
use crate::system::surfaces::Event;

/// What an importer has to know after an event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AfterEvent {
    /// Whether the run ended.
    pub ended: bool,
    /// Whether states are others than before.
    pub states_changed: bool,
    /// When the excitation has its next kink (s), if it has one.
    pub next_time: Option<f64>,
}

impl Unit {
    /// An event is due, or the beginning.
    pub fn enter_event_mode(&mut self) {
        self.phase = Phase::EventMode;
    }

    /// What becomes of the block at the present time: a new piece of the excitation, transitions, and what follows.
    pub fn pass_events(&mut self, observer: &mut dyn FnMut(&Event)) -> Result<AfterEvent, Fault> {
        let (simulation, inputs) = self.preview()?;
        let before = simulation.states(&inputs);
        let (Some(simulation), Some(ground)) = (&mut self.simulation, &self.ground) else {
            return Err(Fault::new("there is no block yet"));
        };
        let time = simulation.time();
        simulation.begin_exchange();
        let (sum, end) = with_ground(&self.values.inputs(time, &self.rates), ground, time);
        (self.inputs, self.seen) = (sum, None);
        simulation.pass_events(&self.inputs, observer).map_err(|error| {
            self.phase = Phase::Error;
            Fault::new(error.to_string())
        })?;
        let after = simulation.states(&self.inputs);
        (self.states, self.last_step) = (after, None);
        let next_time = [simulation.next_kink(), Some(end)].into_iter().flatten().reduce(f64::min);
        Ok(AfterEvent {
            ended: simulation.ending().is_some() && !simulation.is_frozen(),
            states_changed: after != before,
            next_time: next_time.filter(|time| time.is_finite()),
        })
    }

    /// The motion goes on.
    pub fn enter_continuous_time_mode(&mut self) {
        self.phase = Phase::ContinuousTimeMode;
    }

    /// The importer's clock.
    pub fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        if !time.is_finite() {
            return Err(Fault::new(format!("time = {time}; expected a finite time")));
        }
        let states = self.states;
        self.put(time, states);
        Ok(())
    }

    /// The continuous states.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        let states: States = counted(states.len(), STATES, "states").map(|()| std::array::from_fn(|i| states[i]))?;
        if let Some(i) = states.iter().position(|state| !state.is_finite()) {
            return Err(Fault::new(format!("state {i} = {}; expected a finite number", states[i])));
        }
        let time = self.time();
        self.put(time, states);
        Ok(())
    }

    fn put(&mut self, time: f64, states: States) {
        self.states = states;
        if let Some(simulation) = &mut self.simulation {
            simulation.set_states(time, &states);
        }
        self.seen = None;
    }

    /// The continuous states, as they were set or as the last event left them.
    pub fn states(&mut self) -> Result<States, Fault> {
        if self.phase.is_initialized() {
            return Ok(self.states);
        }
        let (simulation, inputs) = self.preview()?;
        Ok(simulation.states(&inputs))
    }

    /// Their derivatives.
    pub fn derivatives(&mut self) -> Result<States, Fault> {
        let (simulation, inputs) = self.preview()?;
        Ok(simulation.derivatives(&inputs))
    }

    /// The sizes that they typically have.
    pub fn nominals(&mut self) -> Result<States, Fault> {
        let (simulation, _) = self.preview()?;
        Ok(simulation.nominals())
    }

    /// The event indicators.
    pub fn indicators(&mut self) -> Result<[f64; INDICATORS], Fault> {
        let (simulation, inputs) = self.preview()?;
        Ok(simulation.indicators(&inputs))
    }

    /// A step of the importer's solver was accepted.
    pub fn complete_step(&mut self) {
        if let Some(simulation) = &mut self.simulation {
            self.last_step = Some(simulation.complete_step(&self.inputs, self.last_step));
            self.seen = None;
        }
    }
}

/// Refuses an array of another length than the model has.
pub fn counted(found: usize, expected: usize, what: &str) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::new(format!("room for {found} {what}; there are {expected}")))
}
