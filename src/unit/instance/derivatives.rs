//! Exact directional derivatives: of outputs at the present time and, in Initialization Mode, also of calculated parameters.

use std::collections::BTreeMap;

use crate::block::Block;
use crate::excitation::records::{Ground, VariedRecord};
use crate::excitation::{Excitation, Inputs, Pulse, Ramp};
use crate::numerics::gradient::DirectionalDual;
use crate::simulation::exchange::ContinuousStates;
use crate::simulation::outputs::Observation;
use crate::simulation::{Energies, InitialDerivatives, Simulation, Slip, Start};
use crate::unit::derived::{DerivedSource, derived};
use crate::unit::fault::Fault;
use crate::unit::instance::Unit;
use crate::unit::instance::access::{input, known, output};
use crate::unit::life_cycle::Phase;
use crate::unit::outputs::{source, state};
use crate::unit::values::Values;
use crate::unit::variables::{Fmi3Variable, Input, Kind, Output, Role, VARIABLES, Variable};
use rocking_records::Record;

/// A direction in Initialization Mode: components of inputs, parameters and start time.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Components of variables.
    numbers: [f64; VARIABLES.len()],
    /// Nonzero components of the samples in arrays, by their indices. The horizontal record comes first.
    samples: [BTreeMap<usize, f64>; 2],
    /// Component of the start time.
    time: f64,
}

impl Default for Direction {
    fn default() -> Direction {
        Direction { numbers: [0.0; VARIABLES.len()], samples: Default::default(), time: 0.0 }
    }
}

impl Direction {
    /// Adds a component of an input or a Real parameter.
    ///
    /// # Errors
    /// A reference to no input or Real parameter, or a component that is not finite.
    pub fn add(&mut self, reference: u32, component: f64) -> Result<(), Fault> {
        let metadata = known(reference, Kind::Real)?;
        match metadata.role {
            Role::Input(_) | Role::Parameter(_) | Role::Link(_) => {}
            Role::Derived(_) | Role::Output(_) | Role::Text(_) => {
                let (name, found) = (metadata.name, metadata.causality.one());
                return Err(Fault::new(format!(
                    "{name} is {found}; expected an input or a parameter, as direction while initializing"
                )));
            }
        }
        self.numbers[metadata.variable as usize] += finite(metadata.name, component)?;
        Ok(())
    }

    /// Adds components of a variable of FMI 3.0 alone, from the index `first` on.
    ///
    /// # Errors
    /// A variable without derivatives, or a component that is not finite.
    pub fn add_fmi3_variable(&mut self, variable: Fmi3Variable, first: usize, components: &[f64]) -> Result<(), Fault> {
        let name = variable.name();
        components.iter().try_for_each(|&component| finite(name, component).map(|_| ()))?;
        match variable {
            Fmi3Variable::Time => self.time += components.iter().sum::<f64>(),
            Fmi3Variable::RecordHorizontalSamples => add(&mut self.samples[0], first, components),
            Fmi3Variable::RecordVerticalSamples => add(&mut self.samples[1], first, components),
            // The initial state does not depend on intermediate updates.
            Fmi3Variable::IntermediateInterval => {}
            Fmi3Variable::RecordSamples | Fmi3Variable::Indicator(_) => {
                return Err(Fault::new(format!(
                    "{name} is no real parameter; expected an input or a parameter, as direction while initializing"
                )));
            }
        }
        Ok(())
    }

    /// Returns the value of a variable with its component.
    fn lifted(&self, values: &Values, variable: Variable) -> DirectionalDual {
        DirectionalDual::new(values[variable], [self.numbers[variable as usize]])
    }

    fn of(&self, variable: Variable) -> f64 {
        self.numbers[variable as usize]
    }
}

fn add(sums: &mut BTreeMap<usize, f64>, first: usize, components: &[f64]) {
    for (i, &component) in (first..).zip(components).filter(|(_, component)| **component != 0.0) {
        *sums.entry(i).or_default() += component;
    }
}

fn finite(name: &str, component: f64) -> Result<f64, Fault> {
    if component.is_finite() {
        return Ok(component);
    }
    Err(Fault::new(format!("direction {component} of {name}; expected a finite number")))
}

/// Derivatives of all outputs and calculated parameters, in one direction.
#[expect(clippy::large_enum_variant, reason = "between steps nothing is allocated")]
enum Derivatives {
    /// Derivatives of outputs, at the present time.
    Present(Observation<f64>, Energies, Slip),
    /// Derivatives of outputs and calculated parameters, in Initialization Mode.
    Initial(Box<InitialSensitivities>),
}

struct InitialSensitivities {
    derivatives: InitialDerivatives,
    block: Block<DirectionalDual>,
    /// The block as it would stand on its supports.
    on_supports: Block<DirectionalDual>,
    /// Component of the start time.
    time: f64,
    /// Derivatives of the records' parameters, in the order of [`OfGround`](crate::unit::derived::OfGround).
    ground: [f64; 3],
}

impl Derivatives {
    fn of(&self, reference: u32) -> Result<f64, Fault> {
        match self {
            Derivatives::Present(observed, energies, slip) => {
                Ok(source(output(reference, "an output to differentiate")?).sensitivity(observed, energies, slip))
            }
            Derivatives::Initial(initial) => match unknown(reference)? {
                Unknown::Output(Output::EventsLastTime) => Ok(initial.time),
                Unknown::Output(output) => Ok(source(output).initial_derivative(&initial.derivatives)),
                Unknown::Derived(DerivedSource::Block(derive)) => Ok(derive(&initial.block).eps[0]),
                Unknown::Derived(DerivedSource::Supports(derive)) => Ok(derive(&initial.on_supports).eps[0]),
                Unknown::Derived(DerivedSource::Ground(quantity)) => Ok(initial.ground[quantity as usize]),
            },
        }
    }
}

/// A variable with derivatives in Initialization Mode.
enum Unknown {
    Output(Output),
    Derived(DerivedSource<DirectionalDual>),
}

fn unknown(reference: u32) -> Result<Unknown, Fault> {
    let metadata = known(reference, Kind::Real)?;
    match metadata.role {
        Role::Output(output) => Ok(Unknown::Output(output)),
        Role::Derived(parameter) => Ok(Unknown::Derived(derived(parameter))),
        Role::Input(_) | Role::Parameter(_) | Role::Link(_) | Role::Text(_) => {
            let (name, found) = (metadata.name, metadata.causality.one());
            Err(Fault::new(format!("{name} is {found}; expected an output or a calculated parameter to differentiate")))
        }
    }
}

impl Unit {
    /// Returns exact directional derivatives of Real variables.
    ///
    /// In Initialization Mode: of outputs and calculated parameters, with respect to inputs and parameters. Later: of outputs
    /// at the present time, with respect to inputs, states and `time`.
    ///
    /// # Errors
    /// A reference to no Real variable of these kinds, a component that is not finite, or values that make no block or record.
    pub fn directional_derivative<'a>(
        &mut self,
        unknowns: &'a [u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>> + use<'a>, Fault> {
        let derivatives = if self.life.phase == Phase::InitializationMode {
            let mut sum = Direction { time, ..Direction::default() };
            knowns.iter().zip(direction).try_for_each(|(&reference, &component)| sum.add(reference, component))?;
            self.initial_derivatives(unknowns, &sum)?
        } else {
            self.present_derivatives(unknowns, knowns, direction, time)?
        };
        Ok(unknowns.iter().map(move |&reference| derivatives.of(reference)))
    }

    /// Returns exact derivatives in Initialization Mode. Their direction may have components of FMI 3.0 alone.
    ///
    /// # Errors
    /// A reference to no output or calculated parameter, or values that make no block or record.
    pub fn initial_directional_derivative<'a>(
        &mut self,
        unknowns: &'a [u32],
        direction: &Direction,
    ) -> Result<impl Iterator<Item = Result<f64, Fault>> + use<'a>, Fault> {
        let derivatives = self.initial_derivatives(unknowns, direction)?;
        Ok(unknowns.iter().map(move |&reference| derivatives.of(reference)))
    }

    fn present_derivatives(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        direction: &[f64],
        time: f64,
    ) -> Result<Derivatives, Fault> {
        finite(Fmi3Variable::Time.name(), time)?;
        unknowns.iter().try_for_each(|&reference| output(reference, "an output to differentiate").map(|_| ()))?;
        let (mut along, mut states) = (Inputs::default(), None::<ContinuousStates>);
        for (&reference, &component) in knowns.iter().zip(direction) {
            finite(known(reference, Kind::Real)?.name, component)?;
            match known(reference, Kind::Real)?.role {
                Role::Output(output) if let Some(i) = state(output) => states.get_or_insert_default()[i] += component,
                _ => along[input(reference, "an input or a state as direction")?.0].value += component,
            }
        }
        let (records, _) = self.with_records(&Inputs { time: self.time(), ..Inputs::default() }, self.time());
        along.a_gx.value += time * records.a_gx.rate;
        along.a_gz.value += time * records.a_gz.rate;
        let (simulation, at) = self.preview()?;
        let (observed, energies) = match states {
            None => (simulation.observe_direction(&at, &along, time), Energies::default()),
            Some(states) => simulation.directional(&at, &states, &along, time),
        };
        let slip = states.map_or(Slip::default(), |states| slip_along(simulation, &at, &states));
        let mut observed = observed.map(|x| x.eps);
        if let Some([theta, theta_dot, v, v_dot, u, u_dot, ..]) = states {
            observed = Observation { theta, theta_dot, v, v_dot, u, u_dot, ..observed };
        }
        Ok(Derivatives::Present(observed, energies, slip))
    }

    fn initial_derivatives(&mut self, unknowns: &[u32], direction: &Direction) -> Result<Derivatives, Fault> {
        let mut of_ground = false;
        for &reference in unknowns {
            of_ground |= matches!(unknown(reference)?, Unknown::Derived(DerivedSource::Ground(_)));
        }
        let ground = self.ground()?;
        let unscaled = self.unscaled(direction)?;
        let (simulation, inputs) = self.preview()?;
        let simulation = simulation.clone();
        let values = &self.values;
        let records = [(&ground.horizontal, 0), (&ground.vertical, 1)].map(|(record, i)| {
            let unscaled = unscaled.as_ref().map(|ground| [&ground.horizontal, &ground.vertical][i]);
            record.as_ref().map(|record| varied(values, direction, record, unscaled.and_then(Option::as_ref), i))
        });
        let component = |variable| direction.lifted(values, variable);
        let block = values.varied_block(component);
        let time = DirectionalDual::new(simulation.time(), [direction.time]);
        let motion = records.each_ref().map(|record| record.as_ref().map_or(0.0, |record| record.at(time).eps[0]));
        let input = |input: Input, motion: f64| Ramp {
            value: DirectionalDual::new(inputs[input].value, [direction.of(input.variable()) + motion]),
            rate: DirectionalDual::from(inputs[input].rate),
        };
        let acting = Inputs {
            // The records' derivatives are those at the start time.
            time: DirectionalDual::new(inputs.time, [direction.time]),
            a_gx: input(Input::AGx, motion[0]),
            a_gz: input(Input::AGz, motion[1]),
            f_x: input(Input::FX, 0.0),
            f_z: input(Input::FZ, 0.0),
            m_y: input(Input::MY, 0.0),
        };
        let pulse = acting_pulse(values.pulse_of(component), time);
        let excitation = Excitation::new(&acting, pulse.as_ref(), block.mass);
        let derivatives =
            simulation.initial_sensitivity(&Start { block, initial: values.initial_of(component), excitation, time });
        let ground = if of_ground {
            let end = ground.end();
            let ends =
                [&ground.horizontal, &ground.vertical].into_iter().zip(&records).filter_map(|(record, varied)| {
                    let record = record.as_ref()?;
                    (Some(record.start_time + record.duration()) == end)
                        .then(|| varied.as_ref().map(VariedRecord::end))?
                });
            let [peak, vertical] = records.each_ref().map(|record| record.as_ref().map_or(0.0, VariedRecord::peak));
            [peak, vertical, ends.reduce(f64::max).unwrap_or(0.0)]
        } else {
            [0.0; 3]
        };
        Ok(Derivatives::Initial(Box::new(InitialSensitivities {
            derivatives,
            block,
            on_supports: values.varied_block_on_supports(component),
            time: direction.time,
            ground,
        })))
    }

    /// Returns the records without scale if the scale is zero and the direction contains it.
    fn unscaled(&self, direction: &Direction) -> Result<Option<Ground>, Fault> {
        let lost = self.values[Variable::RecordScale] == 0.0 && direction.of(Variable::RecordScale) != 0.0;
        if lost { self.values.unscaled_ground().map(Some).map_err(Fault) } else { Ok(None) }
    }
}

/// Returns the derivatives of the slip in a direction of states.
///
/// The position of a sliding foot is that of the centre of mass less `h sin θ + e_x cos θ`, whose derivative with respect to θ is the height
/// Q of the centre of mass over the foot.
fn slip_along(simulation: &Simulation, inputs: &Inputs, [theta, _, _, _, u, ..]: &ContinuousStates) -> Slip {
    let now = simulation.observe(inputs);
    let Some(foot) = simulation.regime().foot().filter(|_| simulation.slides()) else { return Slip::default() };
    let (sin, cos) = libm::sincos(now.theta);
    let slip = u - simulation.block().lever(foot, sin, cos).q * theta;
    Slip { now: slip, total: slip * now.slip_rate.signum() }
}

/// Returns the pulse if it acts at `time`.
///
/// A pulse that begins and ends at zero has derivatives at these times; the direction decides whether it acts.
fn acting_pulse(pulse: Pulse<DirectionalDual>, time: DirectionalDual) -> Option<Pulse<DirectionalDual>> {
    let since = time - pulse.start;
    let acts = if pulse.ends_at_zero() {
        [since, pulse.duration() - since].into_iter().all(|x| x.re > 0.0 || (x.re == 0.0 && x.eps[0] >= 0.0))
    } else {
        pulse.map(|x| x.re).acts_at(time.re)
    };
    acts.then_some(pulse)
}

/// Returns a record with its derivatives.
fn varied<'a>(
    values: &Values,
    direction: &'a Direction,
    record: &'a Record,
    unscaled: Option<&'a Record>,
    component: usize,
) -> VariedRecord<'a, impl Fn(usize) -> f64 + use<'a>> {
    let (scale, gravity) = (values[Variable::RecordScale], values[Variable::G]);
    let scaled = direction.of(Variable::RecordScale);
    let of_gravity = if record.unit.is_of_gravity() { direction.of(Variable::G) / gravity } else { 0.0 };
    let sample = move |i: usize| {
        let acceleration = record.acceleration[i];
        let raw = unscaled.map_or_else(|| acceleration / scale, |record| record.acceleration[i]);
        let of_scale = if scaled == 0.0 { 0.0 } else { raw * scaled };
        let of_samples = direction.samples[component].get(&i).map_or(0.0, |derivative| derivative * scale);
        of_scale + acceleration * of_gravity + of_samples
    };
    // A file's own time step is not a parameter.
    let is_set = values[Variable::RecordDt] != 0.0;
    VariedRecord {
        record,
        sample,
        start_time: direction.of(Variable::RecordStart),
        time_step: if is_set { direction.of(Variable::RecordDt) } else { 0.0 },
    }
}
