//! Model Exchange: the importer's solver steps the block.

use crate::excitation::Inputs;
use crate::simulation::exchange::{ContinuousStates, INDICATORS, STATES, nominals};
use crate::system::events::Event;
use crate::unit::fault::Fault;
use crate::unit::fmu::{AfterEvent, counted};
use crate::unit::instance::{Interface, Unit, no_block, with_ground};
use crate::unit::life_cycle::Phase;
use crate::unit::outputs::{ObservationCache, state};
use crate::unit::variables::Output;

impl Unit {
    /// Enters Event Mode. The present inputs acted up to now.
    pub fn enter_event_mode(&mut self) {
        self.complete_step();
        self.life.phase = Phase::EventMode;
    }

    /// Applies the events of the present time: kinks of the excitation and transitions.
    ///
    /// # Errors
    /// Values that make no block or record, or events that leave no regime that lasts.
    pub fn pass_events(&mut self, observer: &mut dyn FnMut(&Event)) -> Result<AfterEvent, Fault> {
        self.preview()?;
        let (Some(simulation), Some(ground)) = (&mut self.simulation, &self.ground) else { return Err(no_block()) };
        let (time, before) = (simulation.time(), simulation.clone());
        let present = time + simulation.clock_rounding();
        self.observed = ObservationCache::default();
        let next_time = loop {
            let (acting, end) = with_ground(&Inputs { time, ..self.inputs }, ground, simulation.time());
            self.acting = Some(acting);
            if let Err(error) = simulation.pass_events(&acting, end, observer) {
                // A failed transition may leave numbers that are not finite.
                *simulation = before;
                self.life.phase = Phase::Error;
                return Err(Fault::new(error.to_string()));
            }
            self.states = simulation.states(&acting);
            match [simulation.next_stop(), Some(end)].into_iter().flatten().reduce(f64::min) {
                // No solver steps to a time so near.
                Some(next) if next <= present && simulation.ending().is_none() => simulation.set_time(next),
                next => break next,
            }
        };
        simulation.set_time(time);
        self.last_inputs = self.inputs;
        Ok(AfterEvent {
            ended: simulation.ending().is_some() && !simulation.is_frozen(),
            states_changed: true,
            next_time: next_time.filter(|time| time.is_finite()),
        })
    }

    /// Sets the time (s).
    ///
    /// # Errors
    /// A time that is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), Fault> {
        if !time.is_finite() {
            return Err(Fault::new(format!("time = {time}; expected a finite time")));
        }
        let states = self.states;
        self.put(time, states);
        Ok(())
    }

    /// Sets the continuous states.
    ///
    /// # Errors
    /// Another number of states, or a state that is not finite.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Fault> {
        let states: ContinuousStates =
            counted(states.len(), STATES, "states").map(|()| std::array::from_fn(|i| states[i]))?;
        if let Some(i) = states.iter().position(|state| !state.is_finite()) {
            return Err(Fault::new(format!("state {i} = {}; expected a finite number", states[i])));
        }
        let time = self.time();
        self.put(time, states);
        Ok(())
    }

    fn put(&mut self, time: f64, states: ContinuousStates) {
        self.states = states;
        if let Some(simulation) = &mut self.simulation {
            simulation.set_states(time, &states);
        }
        self.observed = ObservationCache::default();
    }

    /// Returns the continuous states, as set or as the last event left them.
    ///
    /// # Errors
    /// Values that make no block or record.
    pub fn states(&mut self) -> Result<ContinuousStates, Fault> {
        if self.life.phase.is_initialized() {
            return Ok(self.states);
        }
        let (simulation, inputs) = self.preview()?;
        Ok(simulation.states(&inputs))
    }

    /// Returns the derivatives of the states. Those of displacements are the velocities among the states.
    ///
    /// # Errors
    /// Values that make no block or record.
    pub fn derivatives(&mut self) -> Result<ContinuousStates, Fault> {
        let states = self.states()?;
        let (simulation, inputs) = self.preview()?;
        let mut derivatives = simulation.derivatives(&inputs);
        (derivatives[0], derivatives[2], derivatives[4]) = (states[1], states[3], states[5]);
        Ok(derivatives)
    }

    /// Returns the value of an output that needs no equations of motion. It is a continuous state in Model Exchange, or the rotation.
    pub(super) fn state_output(&self, output: Output) -> Option<f64> {
        match self.life.interface {
            Interface::ModelExchange => {
                state(output).filter(|_| self.life.phase.is_initialized()).map(|i| self.states[i])
            }
            Interface::CoSimulation if output == Output::Theta => Some(self.simulation.as_ref()?.state()[0]),
            Interface::CoSimulation => None,
        }
    }

    /// Returns the nominal values of the states.
    ///
    /// # Errors
    /// Values that make no block.
    pub fn nominals(&mut self) -> Result<ContinuousStates, Fault> {
        match &self.simulation {
            Some(simulation) => Ok(nominals(simulation.block())),
            None => self.block().map(|block| nominals(&block)),
        }
    }

    /// Returns the event indicators.
    ///
    /// # Errors
    /// Values that make no block or record.
    pub fn indicators(&mut self) -> Result<[f64; INDICATORS], Fault> {
        let (simulation, inputs) = self.preview()?;
        Ok(simulation.indicators(&inputs))
    }

    /// Accepts a step of the importer's solver. Inputs count as linear in time over it.
    pub fn complete_step(&mut self) {
        let Some(simulation) = self.simulation.as_mut().filter(|_| self.life.interface == Interface::ModelExchange)
        else {
            return;
        };
        let (last, time) = (simulation.last_completed(), simulation.time());
        if last < time {
            let over = Inputs { time: last, ..self.last_inputs }.line_to(&Inputs { time, ..self.inputs });
            let over = match &self.ground {
                Some(ground) => with_ground(&over, ground, simulation.piece_time()).0,
                None => over,
            };
            simulation.complete_step(&over);
            self.last_inputs = self.inputs;
            self.observed = ObservationCache::default();
        }
    }
}
