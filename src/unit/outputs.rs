//! Outputs of modelDescription.xml → the sources of their values and derivatives.

use std::cell::OnceCell;

use crate::block::restraints::{self, TieState};
use crate::excitation::Inputs;
use crate::numerics::dual::Dual;
use crate::numerics::roots::rate_of_peak;
use crate::run::Ending;
use crate::simulation::outputs::Observation;
use crate::simulation::peaks::{Channel, Peaks};
use crate::simulation::{self, Energies, InitialDerivatives, Simulation};
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
        Output::EnergyFriction,
        Output::EnergyTies,
        Output::EnergyDampers,
    ];
    STATES.into_iter().position(|state| state == output)
}

/// The source of an output's value and of its derivatives.
pub enum Source {
    /// A quantity of an observation. Applied to an observation of rates or sensitivities, its rate or sensitivity.
    Observed(fn(&Observation<f64>) -> f64),
    /// An energy, or its rate.
    Energy(fn(&Energies) -> f64),
    /// The largest value since the start. It rises while the present value equals it and rises.
    Peak(Channel),
    /// A slip, and its rate from the velocity of the foot.
    Slip(fn(&simulation::Slip) -> f64, fn(f64) -> f64),
    /// The largest slip since the start.
    PeakSlip,
    /// The largest pull of the restraint with this number since the start.
    PeakPull(usize),
    /// The largest plastic elongation of the restraint with this number since the start.
    PeakPlastic(usize),
    /// The largest elongation of the restraint with this number since the start.
    PeakElongation(usize),
    /// The energy that the restraint with this number has lost by yielding since the start.
    PlasticWork(usize),
    /// Whether the foot slides.
    Slides,
    /// The regime.
    Regime,
    /// A value that changes only at events.
    Discrete(fn(&Simulation) -> f64),
}

/// Returns the source of an output.
#[expect(clippy::too_many_lines, reason = "a table with a line for each output")]
pub fn source(output: Output) -> Source {
    use Source::{
        Discrete, Energy, Observed, Peak, PeakElongation, PeakPlastic, PeakPull, PeakSlip, PlasticWork, Regime, Slides,
        Slip,
    };
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
        Output::PowerFriction => Observed(|at| at.friction_power),
        Output::PowerTies => Observed(|at| at.restraint_power.ties),
        Output::PowerDampers => Observed(|at| at.restraint_power.dampers),
        Output::SlipRate => Observed(|at| at.slip_rate),
        Output::Tie1Tension => Observed(|at| at.restraints[0].pull),
        Output::Tie2Tension => Observed(|at| at.restraints[1].pull),
        Output::Damper1Force => Observed(|at| at.restraints[2].pull),
        Output::Damper2Force => Observed(|at| at.restraints[3].pull),
        Output::Tie1Elongation => Observed(|at| at.restraints[0].elongation),
        Output::Tie2Elongation => Observed(|at| at.restraints[1].elongation),
        Output::Damper1Elongation => Observed(|at| at.restraints[2].elongation),
        Output::Damper2Elongation => Observed(|at| at.restraints[3].elongation),
        Output::Tie1Plastic => Observed(|at| at.restraints[0].plastic),
        Output::Tie2Plastic => Observed(|at| at.restraints[1].plastic),
        Output::Damper1Plastic => Observed(|at| at.restraints[2].plastic),
        Output::Damper2Plastic => Observed(|at| at.restraints[3].plastic),
        Output::EnergyTotal => Energy(|energies| energies.total),
        Output::EnergyKinetic => Energy(|energies| energies.kinetic),
        Output::EnergyPotential => Energy(|energies| energies.potential),
        Output::EnergyInput => Energy(|energies| energies.input),
        Output::EnergyDashpots => Energy(|energies| energies.dashpots),
        Output::EnergyFriction => Energy(|energies| energies.friction),
        Output::EnergyTies => Energy(|energies| energies.restraints.ties),
        Output::EnergyDampers => Energy(|energies| energies.restraints.dampers),
        Output::EnergyImpacts => Energy(|energies| energies.impacts),
        Output::EnergyConstraint => Energy(|energies| energies.constraint),
        Output::EnergyResidual => Energy(|energies| energies.residual),
        Output::PeakTheta => Peak(Channel::Theta),
        Output::PeakN => Peak(Channel::Reaction),
        Output::PeakH => Peak(Channel::Horizontal),
        Output::PeakUplift => Peak(Channel::Uplift),
        Output::PeakFrictionDemand => Peak(Channel::FrictionDemand),
        Output::PeakSlip => PeakSlip,
        Output::PeakTie1Tension => PeakPull(0),
        Output::PeakTie2Tension => PeakPull(1),
        Output::PeakDamper1Force => PeakPull(2),
        Output::PeakDamper2Force => PeakPull(3),
        Output::PeakTie1Plastic => PeakPlastic(0),
        Output::PeakTie2Plastic => PeakPlastic(1),
        Output::PeakDamper1Plastic => PeakPlastic(2),
        Output::PeakDamper2Plastic => PeakPlastic(3),
        Output::PeakDamper1Elongation => PeakElongation(2),
        Output::PeakDamper2Elongation => PeakElongation(3),
        Output::Damper1Energy => PlasticWork(2),
        Output::Damper2Energy => PlasticWork(3),
        Output::Slip => Slip(|slip| slip.now, |rate| rate),
        Output::SlipTotal => Slip(|slip| slip.total, f64::abs),
        Output::Regime => Regime,
        Output::EventsLastTime => Discrete(|simulation| simulation.last_event()),
        Output::EventsImpacts => Discrete(|simulation| f64::from(simulation.counts().impacts)),
        Output::EventsLiftoffs => Discrete(|simulation| f64::from(simulation.counts().liftoffs)),
        Output::Slides => Slides,
        Output::Tie1Broken => Discrete(|simulation| is_broken(simulation, 0)),
        Output::Tie2Broken => Discrete(|simulation| is_broken(simulation, 1)),
        Output::Damper1Broken => Discrete(|simulation| is_broken(simulation, 2)),
        Output::Damper2Broken => Discrete(|simulation| is_broken(simulation, 3)),
        Output::Separated => Discrete(|simulation| ended_by(simulation, Ending::is_separation)),
        Output::Overturned => Discrete(|simulation| ended_by(simulation, Ending::is_overturning)),
    }
}

fn is_broken(simulation: &Simulation, number: usize) -> f64 {
    flag(simulation.restraints().ties[number] == TieState::Broken)
}

fn ended_by(simulation: &Simulation, is: fn(Ending) -> bool) -> f64 {
    flag(simulation.ending().is_some_and(|(ending, _)| is(ending)))
}

/// Returns 1 for true and 0 for false.
fn flag(is: bool) -> f64 {
    f64::from(u8::from(is))
}

/// The observation and the energies of the present time, computed when an output needs them.
#[derive(Clone, Debug, Default)]
pub struct ObservationCache {
    observed: OnceCell<Observation<f64>>,
    energies: OnceCell<Energies>,
}

/// Values and rates of change at the present time.
pub struct OutputRates {
    /// The observed quantities with their rates.
    pub observed: Observation<Dual>,
    /// Their rates alone.
    pub rates: Observation<f64>,
    /// Rates of the energies.
    pub energies: Energies,
    /// The slip of the foot.
    pub slip: simulation::Slip,
    /// The largest values since the start.
    pub peaks: Peaks,
    /// The forces at which the restraints yield first (N), by their numbers.
    pub yield_forces: [f64; restraints::MAX],
}

impl Source {
    /// Returns the value. The cache evaluates the equations and the energies only if needed, at most once per instant.
    pub fn value(&self, cache: &ObservationCache, simulation: &Simulation, inputs: &Inputs) -> f64 {
        let observed = || cache.observed.get_or_init(|| simulation.observe(inputs));
        match self {
            Source::Observed(of) => of(observed()),
            Source::Energy(of) => of(cache.energies.get_or_init(|| simulation.energies())),
            Source::Regime => f64::from(observed().regime.number()),
            Source::Peak(channel) => simulation.peaks().of(*channel),
            Source::Slip(of, _) => of(&simulation.slip()),
            Source::PeakSlip => simulation.peaks().slip,
            Source::PeakPull(number) => simulation.peaks().pull[*number],
            Source::PeakPlastic(number) => simulation.peaks().plastic[*number],
            Source::PeakElongation(number) => simulation.peaks().elongation[*number],
            Source::PlasticWork(number) => simulation.plastic_work(*number),
            Source::Slides => flag(simulation.slides_under(inputs)),
            Source::Discrete(of) => of(simulation),
        }
    }

    /// Returns the rate of change.
    pub fn rate(&self, now: &OutputRates) -> f64 {
        let OutputRates { observed, rates, energies, slip, peaks, yield_forces } = now;
        match self {
            Source::Observed(of) => of(rates),
            Source::Energy(of) => of(energies),
            Source::Peak(channel) => peaks.rate(*channel, &observed.channels()),
            Source::Slip(_, of) => of(observed.slip_rate.re),
            // From its initial position the foot slips outward in either direction.
            Source::PeakSlip if slip.now == 0.0 => {
                rate_of_peak(peaks.slip, Dual::new(0.0, observed.slip_rate.re.abs()))
            }
            Source::PeakSlip => rate_of_peak(peaks.slip, Dual::new(slip.now, observed.slip_rate.re).abs()),
            Source::PeakPull(number) => rate_of_peak(peaks.pull[*number], observed.restraints[*number].pull.abs()),
            Source::PeakPlastic(number) => {
                rate_of_peak(peaks.plastic[*number], observed.restraints[*number].plastic.abs())
            }
            Source::PeakElongation(number) => {
                rate_of_peak(peaks.elongation[*number], observed.restraints[*number].elongation.abs())
            }
            Source::PlasticWork(number) => rates.restraints[*number].plastic.abs() * yield_forces[*number],
            Source::Slides | Source::Regime | Source::Discrete(_) => 0.0,
        }
    }

    /// Returns the derivative at the beginning, in a direction of start values, parameters and inputs.
    pub fn initial_derivative(&self, derivatives: &InitialDerivatives) -> f64 {
        match self {
            Source::Observed(value) => value(&derivatives.observed),
            Source::Energy(value) => value(&derivatives.energies),
            Source::Peak(channel) => derivatives.peaks.of(*channel),
            Source::PeakPull(number) => derivatives.peaks.pull[*number],
            Source::PeakPlastic(number) => derivatives.peaks.plastic[*number],
            Source::PeakElongation(number) => derivatives.peaks.elongation[*number],
            Source::PlasticWork(_)
            | Source::Slip(..)
            | Source::PeakSlip
            | Source::Slides
            | Source::Regime
            | Source::Discrete(_) => 0.0,
        }
    }

    /// Returns the derivative with respect to inputs and states at one instant. It follows from the derivatives of observation, energies
    /// and slip.
    ///
    /// Peaks and event counts do not depend on the inputs and states of that instant.
    pub fn sensitivity(&self, sensitivities: &Observation<f64>, energies: &Energies, slip: &simulation::Slip) -> f64 {
        match self {
            Source::Observed(of) => of(sensitivities),
            Source::Energy(of) => of(energies),
            Source::Slip(of, _) => of(slip),
            Source::Peak(_)
            | Source::PeakSlip
            | Source::PeakPull(_)
            | Source::PeakPlastic(_)
            | Source::PeakElongation(_)
            | Source::PlasticWork(_)
            | Source::Slides
            | Source::Regime
            | Source::Discrete(_) => 0.0,
        }
    }
}
