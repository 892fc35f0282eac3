//! A run from its parameters → its results, and the same with their derivatives.

use rocking_block::block::{Block, Supports};
use rocking_block::excitation::Inputs;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Counts, OnSeparation, Settings, Simulation};
use rocking_block::system::events::EventKind;
use rocking_block::system::instant::Pose;
use rocking_gradients::{Follower, Grazing, Number, Parameters, Varied, advance};

/// A run whose rows are evenly spaced.
#[derive(Clone, Debug)]
pub struct Run {
    pub name: String,
    pub parameters: Parameters,
    pub ground: Ground,
    pub flies: bool,
    pub tolerance: f64,
    pub step: f64,
    pub rows: usize,
    /// Smallest difference of a parameter for its derivatives, as a part of its value.
    pub difference: f64,
}

/// The results of a run.
#[derive(Clone, Debug)]
pub struct Results<T> {
    pub rows: Vec<(f64, Observation<T>)>,
    pub events: Vec<(EventKind, T)>,
    pub peaks: Peaks<T>,
    pub state: [T; 4],
    pub slip: T,
    pub grazing: Option<Grazing>,
    pub counts: Counts,
}

impl Run {
    /// The same block on Housner's rigid base.
    pub fn on_rigid_base(mut self) -> Run {
        self.parameters.block.supports = Supports::HOUSNER;
        self
    }

    pub fn with(&self, name: &str, value: f64) -> Run {
        let mut run = self.clone();
        *run.parameters.number(name).unwrap_or_else(|| panic!("{} has no {name}", self.name)) = value;
        run
    }

    pub fn value(&self, name: &str) -> f64 {
        *self.clone().parameters.number(name).unwrap_or_else(|| panic!("{} has no {name}", self.name))
    }

    pub fn block(&self) -> Block {
        self.parameters.checked_block().unwrap()
    }

    pub fn begin(&self) -> (Simulation, Ground) {
        let Parameters { initial, pulse, scale, .. } = &self.parameters;
        let on_separation = if self.flies { OnSeparation::Fly } else { OnSeparation::Terminate };
        let settings = Settings { tolerance: self.tolerance, on_separation, ..Settings::default() };
        let ground = self.ground.clone().scaled(scale.unwrap_or(1.0));
        let simulation = Simulation::new(self.block(), settings, *pulse, initial, 0.0, &ground.inputs_from(0.0).0);
        (simulation, ground)
    }

    /// Goes through the stops of the run; `row` is called at each row with the inputs from there on.
    fn drive(
        &self,
        simulation: &mut Simulation,
        ground: &Ground,
        mut go: impl FnMut(&mut Simulation, f64, &Inputs, bool),
    ) {
        let (mut inputs, mut until) = ground.inputs_from(0.0);
        go(simulation, 0.0, &inputs, true);
        for row in 1..=self.rows {
            let time = row as f64 * self.step;
            while simulation.time() < time && simulation.ending().is_none() {
                let stop = until.min(time);
                go(simulation, stop, &inputs, false);
                if simulation.time() >= until {
                    (inputs, until) = ground.inputs_from(until);
                }
            }
            go(simulation, simulation.time(), &inputs, true);
            if simulation.ending().is_some() {
                break;
            }
        }
    }

    /// The results of the solver alone.
    pub fn plain(&self) -> Results<f64> {
        let (mut simulation, ground) = self.begin();
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        self.drive(&mut simulation, &ground, |simulation, until, inputs, row| {
            if row {
                rows.push((simulation.time(), simulation.observe(inputs)));
            } else {
                simulation.advance(until, inputs, &mut |event| events.push((event.kind, event.time))).unwrap();
            }
        });
        let (peaks, state, slip) = (simulation.peaks(), simulation.state().0, simulation.slip().now);
        Results { rows, events, peaks, state, slip, grazing: None, counts: simulation.counts() }
    }

    /// The results with their derivatives with respect to these parameters.
    pub fn gradients(&self, names: &[&str]) -> Results<Number> {
        let (mut simulation, ground) = self.begin();
        let varied = Varied::with_respect_to(&self.parameters, simulation.block(), names).unwrap();
        let mut follower = Follower::new(&simulation, varied, &ground.inputs_from(0.0).0);
        let mut rows = Vec::new();
        self.drive(&mut simulation, &ground, |simulation, until, inputs, row| {
            if row {
                rows.push((simulation.time(), follower.observe(simulation, inputs)));
            } else {
                advance(simulation, std::slice::from_mut(&mut follower), until, inputs).unwrap();
            }
        });
        let events =
            follower.events().iter().map(|event| (event.event.kind, Number::new(event.event.time, event.time)));
        let Pose { state, .. } = follower.pose();
        Results {
            rows,
            events: events.collect(),
            peaks: follower.peaks(&simulation),
            state: state.0,
            slip: follower.slip(),
            grazing: follower.grazing(),
            counts: simulation.counts(),
        }
    }
}
