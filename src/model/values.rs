//! Variables ↔ block, initial state, pulse and outputs; every variable of modelDescription.xml is named here, once.

use crate::block::{Block, BlockError, Common, Dimensionless, Foundation, Physical};
use crate::excitation::{Inputs, Pulse, PulseShape, Ramp};
use crate::model::variables::{Causality, VARIABLES, Variable};
use crate::simulation::outputs::Observation;
use crate::simulation::peaks::{Channel, Channels, Peaks};
use crate::simulation::{Ending, Energies, Initial, LiftOff, OnOverturning, OnSeparation, Settings, Simulation};

/// The inputs, in the order of their ramps.
pub const INPUTS: [Variable; 5] = [Variable::AGx, Variable::AGz, Variable::FX, Variable::FZ, Variable::MY];

/// Values of all variables that are set from outside, by value reference; those of the others stay at 0.
///
/// Integers, enumerations and Booleans (0 or 1) are held as the real numbers that they are.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Values(Vec<f64>);

impl Default for Values {
    fn default() -> Values {
        Values(VARIABLES.iter().map(|metadata| metadata.start.unwrap_or(0.0)).collect())
    }
}

impl std::ops::Index<Variable> for Values {
    type Output = f64;

    fn index(&self, variable: Variable) -> &f64 {
        &self.0[variable as usize]
    }
}

impl std::ops::IndexMut<Variable> for Values {
    fn index_mut(&mut self, variable: Variable) -> &mut f64 {
        &mut self.0[variable as usize]
    }
}

const PHYSICAL_PARAMETERIZATION: f64 = 2.0;
const RIGID: f64 = Foundation::Rigid as i32 as f64;
const ON_SUPPORTS: &str = "foundation = Viscoelastic";
const HOLD_AT_SEPARATION: f64 = OnSeparation::Hold as i32 as f64;
const FLY: f64 = OnSeparation::Fly as i32 as f64;
const HOLD_AT_OVERTURNING: f64 = OnOverturning::Hold as i32 as f64;
const KEEP_MOMENTUM: f64 = 2.0;

impl Values {
    /// Whether these are values of this FMU: one a variable, each within its limits.
    pub fn are_valid(&self) -> bool {
        self.0.len() == VARIABLES.len()
            && VARIABLES.iter().zip(&self.0).all(|(metadata, &value)| {
                !metadata.is_settable() || (value.is_finite() && metadata.admits(value).is_ok())
            })
    }

    /// The block that the parameters amount to.
    pub fn block(&self) -> Result<Block, BlockError> {
        let common = Common {
            mass: self[Variable::Mass],
            gamma: self[Variable::Gamma],
            epsilon: self[Variable::Epsilon],
            gravity: self[Variable::G],
            foundation: if self.is_rigid() { Foundation::Rigid } else { Foundation::Viscoelastic },
            restitution_factor: self[Variable::RestitutionFactor],
        };
        if self.is_physical() {
            let physical = Physical {
                width: self[Variable::PhysicalWidth],
                height: self[Variable::PhysicalHeight],
                stiffness: self[Variable::PhysicalK],
                damping: self[Variable::PhysicalC],
            };
            Block::from_physical(&physical, &common)
        } else {
            let dimensionless = Dimensionless {
                alpha: self[Variable::DimensionlessAlpha],
                p: self[Variable::DimensionlessP],
                eta: self[Variable::DimensionlessEta],
                xi_v: self[Variable::DimensionlessXiV],
            };
            Block::from_dimensionless(&dimensionless, &common)
        }
    }

    fn is_physical(&self) -> bool {
        self[Variable::Parameterization] == PHYSICAL_PARAMETERIZATION
    }

    /// Parameters that were given and that nothing reads with the others as they are, each with what it needs.
    pub fn unread(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        const DIMENSIONLESS: [Variable; 4] = [
            Variable::DimensionlessAlpha,
            Variable::DimensionlessP,
            Variable::DimensionlessEta,
            Variable::DimensionlessXiV,
        ];
        const PHYSICAL: [Variable; 4] =
            [Variable::PhysicalWidth, Variable::PhysicalHeight, Variable::PhysicalK, Variable::PhysicalC];
        const VERTICAL: [Variable; 2] = [Variable::InitialV, Variable::InitialVDot];
        const PULSE: [Variable; 3] = [Variable::PulseAmplitude, Variable::PulsePeriod, Variable::PulseStart];
        let (other_group, other) = if self.is_physical() {
            (DIMENSIONLESS, "parameterization = Dimensionless")
        } else {
            (PHYSICAL, "parameterization = Physical")
        };
        let mut unread: Vec<(Variable, &str)> = other_group.map(|variable| (variable, other)).into();
        if self.is_rigid() {
            unread.extend([Variable::LiftOff, VERTICAL[0], VERTICAL[1]].map(|variable| (variable, ON_SUPPORTS)));
        } else {
            unread.push((Variable::RestitutionFactor, "foundation = Rigid"));
            if self[Variable::InitialSettled] != 0.0 {
                unread.extend(VERTICAL.map(|variable| (variable, "initial.settled = false")));
            }
        }
        if self.pulse().shape == PulseShape::None {
            unread.extend(PULSE.map(|variable| (variable, "a pulse.shape")));
        }
        self.given(unread)
    }

    /// Those of [`Values::unread`], and those of the supports on a rigid base, where only calculated parameters have them.
    pub fn unread_by_motion(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let supports = match (self.is_rigid(), self.is_physical()) {
            (false, _) => vec![],
            (true, true) => vec![Variable::PhysicalK, Variable::PhysicalC],
            (true, false) => vec![Variable::DimensionlessEta, Variable::DimensionlessXiV],
        };
        self.unread().chain(self.given(supports.into_iter().map(|variable| (variable, ON_SUPPORTS)).collect()))
    }

    /// Those that do not have their start value, with their names.
    fn given(&self, variables: Vec<(Variable, &'static str)>) -> impl Iterator<Item = (&'static str, &'static str)> {
        let given = |variable: Variable| Some(self[variable]) != VARIABLES[variable as usize].start;
        variables.into_iter().filter(move |(v, _)| given(*v)).map(|(v, needed)| (v.name(), needed))
    }

    fn is_rigid(&self) -> bool {
        self[Variable::Foundation] == RIGID
    }

    /// The beginning.
    pub fn initial(&self) -> Initial {
        let vertical = (self[Variable::InitialV], self[Variable::InitialVDot]);
        Initial {
            theta: self[Variable::InitialTheta],
            theta_dot: self[Variable::InitialThetaDot],
            vertical: (self[Variable::InitialSettled] == 0.0).then_some(vertical),
        }
    }

    /// The pulse.
    pub fn pulse(&self) -> Pulse {
        let shape = [PulseShape::None, PulseShape::OneSine, PulseShape::OneCosine, PulseShape::C1, PulseShape::C2]
            .into_iter()
            .find(|&shape| f64::from(shape as i32) == self[Variable::PulseShape])
            .unwrap_or(PulseShape::None);
        Pulse {
            shape,
            amplitude: self[Variable::PulseAmplitude],
            period: self[Variable::PulsePeriod],
            start: self[Variable::PulseStart],
        }
    }

    /// How to run, with this tolerance or the default one.
    pub fn settings(&self, tolerance: Option<f64>) -> Settings {
        Settings {
            tolerance: tolerance.unwrap_or(Settings::default().tolerance),
            on_separation: match self[Variable::OnSeparation] {
                HOLD_AT_SEPARATION => OnSeparation::Hold,
                FLY => OnSeparation::Fly,
                _ => OnSeparation::Terminate,
            },
            on_overturning: match self[Variable::OnOverturning] {
                HOLD_AT_OVERTURNING => OnOverturning::Hold,
                _ => OnOverturning::Terminate,
            },
            lift_off: if self[Variable::LiftOff] == KEEP_MOMENTUM { LiftOff::KeepMomentum } else { LiftOff::KeepRates },
        }
    }

    /// The inputs from `time` on, changing at these rates.
    pub fn inputs(&self, time: f64, rates: &[f64; INPUTS.len()]) -> Inputs {
        inputs(time, INPUTS.map(|input| self[input]), rates)
    }
}

/// Inputs from their values and rates.
pub fn inputs(time: f64, values: [f64; INPUTS.len()], rates: &[f64; INPUTS.len()]) -> Inputs {
    let ramp = |i: usize| Ramp { value: values[i], rate: rates[i] };
    Inputs { time, a_gx: ramp(0), a_gz: ramp(1), f_x: ramp(2), f_z: ramp(3), m_y: ramp(4) }
}

/// The value of a calculated parameter; `None` for other variables.
pub fn derived(variable: Variable, block: &Block) -> Option<f64> {
    Some(match variable {
        Variable::DerivedAlpha => block.alpha,
        Variable::DerivedR0 => block.r0,
        Variable::DerivedI0 => block.inertia(),
        Variable::DerivedP => block.p,
        Variable::DerivedOmegaV => block.omega_v,
        Variable::DerivedK => block.stiffness,
        Variable::DerivedC => block.damping,
        Variable::DerivedEta => block.eta(),
        Variable::DerivedXiV => block.xi_v,
        Variable::DerivedDeltaS => block.static_deflection(),
        Variable::DerivedE => block.restitution(),
        Variable::DerivedEMax => block.max_restitution(),
        Variable::DerivedThetaSeparation => block.separation_angle(),
        Variable::DerivedWidth => 2.0 * block.b,
        Variable::DerivedHeight => 2.0 * block.h,
        _ => return None,
    })
}

/// The value of an output from what is seen, or its rate where rates are given.
pub fn real_output(
    variable: Variable,
    seen: &Observation<f64>,
    energies: &Energies,
    history: impl FnOnce(Variable) -> f64,
) -> f64 {
    match variable {
        Variable::Theta => seen.theta,
        Variable::ThetaDot => seen.theta_dot,
        Variable::ThetaDdot => seen.theta_ddot,
        Variable::V => seen.v,
        Variable::VDot => seen.v_dot,
        Variable::VDdot => seen.v_ddot,
        Variable::U => seen.u,
        Variable::UDot => seen.u_dot,
        Variable::UDdot => seen.u_ddot,
        Variable::NL => seen.reaction[0],
        Variable::NR => seen.reaction[1],
        Variable::H => seen.horizontal,
        Variable::MBase => seen.base_moment,
        Variable::VL => seen.corner[0],
        Variable::VR => seen.corner[1],
        Variable::UpliftL => seen.uplift[0],
        Variable::UpliftR => seen.uplift[1],
        Variable::EnergyTotal => energies.total,
        Variable::EnergyKinetic => energies.kinetic,
        Variable::EnergyPotential => energies.potential,
        Variable::EnergyInput => energies.input,
        Variable::EnergyDashpots => energies.dashpots,
        Variable::EnergyImpacts => energies.impacts,
        Variable::EnergyConstraint => energies.constraint,
        Variable::EnergyResidual => energies.residual,
        Variable::FrictionDemand => seen.friction_demand,
        Variable::Regime => f64::from(seen.regime.number()),
        other => history(other),
    }
}

/// The value of an output that holds what was since the start; 0 for other variables.
pub fn history(variable: Variable, simulation: &Simulation) -> f64 {
    let peaks = simulation.peaks();
    let counts = simulation.counts();
    let ended_by = |is: fn(Ending) -> bool| f64::from(u8::from(simulation.ending().is_some_and(|(end, _)| is(end))));
    match variable {
        Variable::PeakTheta => peaks.theta,
        Variable::PeakN => peaks.reaction,
        Variable::PeakH => peaks.horizontal,
        Variable::PeakUplift => peaks.uplift,
        Variable::PeakFrictionDemand => peaks.friction_demand,
        Variable::EventsLastTime => simulation.last_event(),
        Variable::EventsImpacts => f64::from(counts.impacts),
        Variable::EventsLiftoffs => f64::from(counts.liftoffs),
        Variable::Separated => ended_by(Ending::is_separation),
        Variable::Overturned => ended_by(Ending::is_overturning),
        _ => 0.0,
    }
}

/// The rate of an output that holds what was since the start: a peak grows with a value that stands at it and grows;
/// the others change at events only.
pub fn history_rate(variable: Variable, now: &Channels, peaks: &Peaks) -> f64 {
    let channel = match variable {
        Variable::PeakTheta => Channel::Theta,
        Variable::PeakN => Channel::Reaction,
        Variable::PeakH => Channel::Horizontal,
        Variable::PeakUplift => Channel::Uplift,
        Variable::PeakFrictionDemand => Channel::FrictionDemand,
        _ => return 0.0,
    };
    peaks.rate(channel, now)
}

impl Variable {
    /// Its name in modelDescription.xml.
    pub fn name(self) -> &'static str {
        VARIABLES[self as usize].name
    }

    /// Whether it is an output.
    pub fn is_output(self) -> bool {
        VARIABLES[self as usize].causality == Causality::Output
    }
}
