//! Outputs of modelDescription.xml → the sources of their values and derivatives.

use crate::simulation::outputs::Observation;
use crate::simulation::peaks::{Channel, Channels, Peaks};
use crate::simulation::{AtBeginning, Ending, Energies, Simulation};
use crate::unit::variables::Output;

/// Returns the index of an output among the continuous states, if it is one.
pub fn state(output: Output) -> Option<usize> {
    const STATES: [Output; crate::simulation::exchange::STATES] = [
        Output::Theta,
        Output::ThetaDot,
        Output::V,
        Output::VDot,
        Output::U,
        Output::UDot,
        Output::EnergyInput,
        Output::EnergyDashpots,
    ];
    STATES.into_iter().position(|state| state == output)
}

/// The source of an output's value and of its derivatives.
pub enum Source {
    /// A quantity of an observation. From an observation of rates it gives the rate, from one of sensitivities the sensitivity.
    Observed(fn(&Observation<f64>) -> f64),
    /// An energy, or its rate.
    Energy(fn(&Energies) -> f64),
    /// The largest value since the start. It grows while the present value equals it and grows.
    Peak(Channel),
    /// A value that changes only at events.
    Discrete(fn(&Observation<f64>, &Simulation) -> f64),
}

/// Returns the source of an output.
pub fn source(output: Output) -> Source {
    use Source::{Discrete, Energy, Observed, Peak};
    match output {
        Output::Theta => Observed(|at| at.theta),
        Output::ThetaDot => Observed(|at| at.theta_dot),
        Output::ThetaDdot => Observed(|at| at.theta_ddot),
        Output::V => Observed(|at| at.v),
        Output::VDot => Observed(|at| at.v_dot),
        Output::VDdot => Observed(|at| at.v_ddot),
        Output::U => Observed(|at| at.u),
        Output::UDot => Observed(|at| at.u_dot),
        Output::UDdot => Observed(|at| at.u_ddot),
        Output::NL => Observed(|at| at.reaction[0]),
        Output::NR => Observed(|at| at.reaction[1]),
        Output::H => Observed(|at| at.horizontal),
        Output::MBase => Observed(|at| at.base_moment),
        Output::VL => Observed(|at| at.corner[0]),
        Output::VR => Observed(|at| at.corner[1]),
        Output::UpliftL => Observed(|at| at.uplift[0]),
        Output::UpliftR => Observed(|at| at.uplift[1]),
        Output::FrictionDemand => Observed(|at| at.friction_demand),
        Output::PowerInput => Observed(|at| at.power[0]),
        Output::PowerDashpots => Observed(|at| at.power[1]),
        Output::EnergyTotal => Energy(|energies| energies.total),
        Output::EnergyKinetic => Energy(|energies| energies.kinetic),
        Output::EnergyPotential => Energy(|energies| energies.potential),
        Output::EnergyInput => Energy(|energies| energies.input),
        Output::EnergyDashpots => Energy(|energies| energies.dashpots),
        Output::EnergyImpacts => Energy(|energies| energies.impacts),
        Output::EnergyConstraint => Energy(|energies| energies.constraint),
        Output::EnergyResidual => Energy(|energies| energies.residual),
        Output::PeakTheta => Peak(Channel::Theta),
        Output::PeakN => Peak(Channel::Reaction),
        Output::PeakH => Peak(Channel::Horizontal),
        Output::PeakUplift => Peak(Channel::Uplift),
        Output::PeakFrictionDemand => Peak(Channel::FrictionDemand),
        Output::Regime => Discrete(|at, _| f64::from(at.regime.number())),
        Output::EventsLastTime => Discrete(|_, simulation| simulation.last_event()),
        Output::EventsImpacts => Discrete(|_, simulation| f64::from(simulation.counts().impacts)),
        Output::EventsLiftoffs => Discrete(|_, simulation| f64::from(simulation.counts().liftoffs)),
        Output::Separated => Discrete(|_, simulation| ended_by(simulation, Ending::is_separation)),
        Output::Overturned => Discrete(|_, simulation| ended_by(simulation, Ending::is_overturning)),
    }
}

fn ended_by(simulation: &Simulation, is: fn(Ending) -> bool) -> f64 {
    f64::from(u8::from(simulation.ending().is_some_and(|(ending, _)| is(ending))))
}

impl Source {
    /// Returns the value.
    pub fn value(&self, observed: &Observation<f64>, energies: &Energies, simulation: &Simulation) -> f64 {
        match self {
            Source::Observed(of) => of(observed),
            Source::Energy(of) => of(energies),
            Source::Peak(channel) => simulation.peaks().of(*channel),
            Source::Discrete(of) => of(observed, simulation),
        }
    }

    /// Returns the rate of change, from rates of the observation and of the energies.
    ///
    /// `channels` has the present values and rates of the quantities with peaks.
    pub fn rate(&self, rates: &Observation<f64>, energy_rates: &Energies, channels: &Channels, peaks: &Peaks) -> f64 {
        match self {
            Source::Observed(of) => of(rates),
            Source::Energy(of) => of(energy_rates),
            Source::Peak(channel) => peaks.rate(*channel, channels),
            Source::Discrete(_) => 0.0,
        }
    }

    /// Returns the derivative at the beginning, in a direction of start values, parameters and inputs.
    pub fn at_beginning(&self, along: &AtBeginning) -> f64 {
        match self {
            Source::Observed(of) => of(&along.seen),
            Source::Energy(of) => of(&along.energies),
            Source::Peak(channel) => along.peaks.of(*channel),
            Source::Discrete(_) => 0.0,
        }
    }

    /// Returns the derivative with respect to inputs and states at one instant, from those of the observation and of the energies.
    ///
    /// Peaks and event counts do not depend on them.
    pub fn sensitivity(&self, sensitivities: &Observation<f64>, energies: &Energies) -> f64 {
        match self {
            Source::Observed(of) => of(sensitivities),
            Source::Energy(of) => of(energies),
            Source::Peak(_) | Source::Discrete(_) => 0.0,
        }
    }
}
