//! Outputs of modelDescription.xml → where their values come from, and with them their derivatives.

use crate::simulation::outputs::Observation;
use crate::simulation::peaks::{Channel, Channels, Peaks};
use crate::simulation::{AtBeginning, Ending, Energies, Simulation};
use crate::unit::variables::Output;

/// The place of an output among the continuous states, if it is one.
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

/// Where the value of an output comes from, and with it its derivatives.
pub enum Source {
    /// What is seen at an instant; of rates its rate, of sensitivities its sensitivity.
    Seen(fn(&Observation<f64>) -> f64),
    /// The energies, or their rates.
    Energy(fn(&Energies) -> f64),
    /// The greatest value since the start: it grows with a value that stands at it and grows.
    Peak(Channel),
    /// What changes at events only.
    Discrete(fn(&Observation<f64>, &Simulation) -> f64),
}

/// Where an output comes from.
pub fn source(output: Output) -> Source {
    use Source::{Discrete, Energy, Peak, Seen};
    match output {
        Output::Theta => Seen(|seen| seen.theta),
        Output::ThetaDot => Seen(|seen| seen.theta_dot),
        Output::ThetaDdot => Seen(|seen| seen.theta_ddot),
        Output::V => Seen(|seen| seen.v),
        Output::VDot => Seen(|seen| seen.v_dot),
        Output::VDdot => Seen(|seen| seen.v_ddot),
        Output::U => Seen(|seen| seen.u),
        Output::UDot => Seen(|seen| seen.u_dot),
        Output::UDdot => Seen(|seen| seen.u_ddot),
        Output::NL => Seen(|seen| seen.reaction[0]),
        Output::NR => Seen(|seen| seen.reaction[1]),
        Output::H => Seen(|seen| seen.horizontal),
        Output::MBase => Seen(|seen| seen.base_moment),
        Output::VL => Seen(|seen| seen.corner[0]),
        Output::VR => Seen(|seen| seen.corner[1]),
        Output::UpliftL => Seen(|seen| seen.uplift[0]),
        Output::UpliftR => Seen(|seen| seen.uplift[1]),
        Output::FrictionDemand => Seen(|seen| seen.friction_demand),
        Output::PowerInput => Seen(|seen| seen.power[0]),
        Output::PowerDashpots => Seen(|seen| seen.power[1]),
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
        Output::Regime => Discrete(|seen, _| f64::from(seen.regime.number())),
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
    /// The value.
    pub fn value(&self, seen: &Observation<f64>, energies: &Energies, simulation: &Simulation) -> f64 {
        match self {
            Source::Seen(of) => of(seen),
            Source::Energy(of) => of(energies),
            Source::Peak(channel) => simulation.peaks().of(*channel),
            Source::Discrete(of) => of(seen, simulation),
        }
    }

    /// Its rate of change, from those of what is seen and of the energies; `now` and `peaks` are what stands at a peak, and
    /// grows.
    pub fn rate(&self, rates: &Observation<f64>, energy_rates: &Energies, now: &Channels, peaks: &Peaks) -> f64 {
        match self {
            Source::Seen(of) => of(rates),
            Source::Energy(of) => of(energy_rates),
            Source::Peak(channel) => peaks.rate(*channel, now),
            Source::Discrete(_) => 0.0,
        }
    }

    /// Its derivative at the beginning in a direction of what the block begins from.
    pub fn at_beginning(&self, along: &AtBeginning) -> f64 {
        match self {
            Source::Seen(of) => of(&along.seen),
            Source::Energy(of) => of(&along.energies),
            Source::Peak(channel) => along.peaks.of(*channel),
            Source::Discrete(_) => 0.0,
        }
    }

    /// Its derivative with respect to inputs and states at one instant, from those of what is seen and of the energies. What
    /// was since the start does not depend on them.
    pub fn sensitivity(&self, sensitivities: &Observation<f64>, energies: &Energies) -> f64 {
        match self {
            Source::Seen(of) => of(sensitivities),
            Source::Energy(of) => of(energies),
            Source::Peak(_) | Source::Discrete(_) => 0.0,
        }
    }
}
