//! Outputs and calculated parameters of modelDescriptionInSpace.xml → the sources of their values.

use crate::space::energies::SpaceEnergies;
use crate::space::outputs::{FootObservation, SpaceObservation};
use crate::space::peaks::SpacePeakRates;
use crate::space::run::SpaceRates;
use crate::space::{SpaceBody, SpaceGround, SpaceRun};
use crate::unit::in_space::variables::{Derived, Fmi3Variable, Output};

/// The source of an output's value and of its rate.
pub enum SpaceSource {
    /// A quantity of an observation. Applied to an observation of rates, its rate.
    Observed(fn(&SpaceObservation) -> f64),
    /// A quantity of the foot of a rectangle with this number.
    Foot(usize, fn(&FootObservation) -> f64),
    /// An energy.
    Energy(fn(&SpaceEnergies) -> f64),
    /// The greatest friction demand of the feet.
    FrictionDemand,
    /// A greatest value since the start, and its rate.
    Peak(fn(&SpaceRun) -> f64, fn(&SpacePeakRates) -> f64),
    /// A quantity of the run that changes only at events.
    Discrete(fn(&SpaceRun) -> f64),
}

impl SpaceSource {
    /// Returns the rate of change, from the rates of a block and their observation alone.
    pub fn rate(&self, now: &SpaceRates, observed: &SpaceObservation, is_named: bool) -> f64 {
        match self {
            SpaceSource::Observed(of) => of(observed),
            SpaceSource::Foot(number, of) => observed.feet.get(*number).filter(|_| is_named).map_or(0.0, of),
            SpaceSource::Energy(of) => of(&now.energies),
            SpaceSource::FrictionDemand => now.observed.friction_demand().eps,
            SpaceSource::Peak(_, of) => of(&now.peaks),
            SpaceSource::Discrete(_) => 0.0,
        }
    }
}

/// Numbers of the feet of a rectangle.
const SW: usize = 0;
const NW: usize = 1;
const SE: usize = 2;
const NE: usize = 3;

/// Returns the source of an output.
#[expect(clippy::too_many_lines, reason = "a line for each output")]
pub fn source(output: Output) -> SpaceSource {
    use SpaceSource::{Discrete, Energy, Foot, FrictionDemand, Observed, Peak};
    match output {
        Output::Tilt => Observed(|at| at.attitude.tilt),
        Output::TiltX => Observed(|at| at.attitude.tilt_x),
        Output::TiltY => Observed(|at| at.attitude.tilt_y),
        Output::Azimuth => Observed(|at| at.attitude.azimuth),
        Output::Twist => Observed(|at| at.attitude.twist),
        Output::OmegaX => Observed(|at| at.omega.x),
        Output::OmegaY => Observed(|at| at.omega.y),
        Output::OmegaZ => Observed(|at| at.omega.z),
        Output::OmegaXDot => Observed(|at| at.angular_acceleration.x),
        Output::OmegaYDot => Observed(|at| at.angular_acceleration.y),
        Output::OmegaZDot => Observed(|at| at.angular_acceleration.z),
        Output::U => Observed(|at| at.displacement.x),
        Output::W => Observed(|at| at.displacement.y),
        Output::V => Observed(|at| at.displacement.z),
        Output::UDot => Observed(|at| at.velocity.x),
        Output::WDot => Observed(|at| at.velocity.y),
        Output::VDot => Observed(|at| at.velocity.z),
        Output::UDdot => Observed(|at| at.acceleration.x),
        Output::WDdot => Observed(|at| at.acceleration.y),
        Output::VDdot => Observed(|at| at.acceleration.z),
        Output::QW => Observed(|at| at.quaternion[0]),
        Output::QX => Observed(|at| at.quaternion[1]),
        Output::QY => Observed(|at| at.quaternion[2]),
        Output::QZ => Observed(|at| at.quaternion[3]),
        Output::QWDot => Observed(|at| at.quaternion_rate[0]),
        Output::QXDot => Observed(|at| at.quaternion_rate[1]),
        Output::QYDot => Observed(|at| at.quaternion_rate[2]),
        Output::QZDot => Observed(|at| at.quaternion_rate[3]),
        Output::NSW => Foot(SW, |foot| foot.normal),
        Output::NSE => Foot(SE, |foot| foot.normal),
        Output::NNW => Foot(NW, |foot| foot.normal),
        Output::NNE => Foot(NE, |foot| foot.normal),
        Output::UpliftSW => Foot(SW, |foot| foot.uplift),
        Output::UpliftSE => Foot(SE, |foot| foot.uplift),
        Output::UpliftNW => Foot(NW, |foot| foot.uplift),
        Output::UpliftNE => Foot(NE, |foot| foot.uplift),
        Output::SlipSW => Foot(SW, |foot| foot.slip),
        Output::SlipSE => Foot(SE, |foot| foot.slip),
        Output::SlipNW => Foot(NW, |foot| foot.slip),
        Output::SlipNE => Foot(NE, |foot| foot.slip),
        Output::StretchXSW => Foot(SW, |foot| foot.stretch[0]),
        Output::StretchXSE => Foot(SE, |foot| foot.stretch[0]),
        Output::StretchXNW => Foot(NW, |foot| foot.stretch[0]),
        Output::StretchXNE => Foot(NE, |foot| foot.stretch[0]),
        Output::StretchYSW => Foot(SW, |foot| foot.stretch[1]),
        Output::StretchYSE => Foot(SE, |foot| foot.stretch[1]),
        Output::StretchYNW => Foot(NW, |foot| foot.stretch[1]),
        Output::StretchYNE => Foot(NE, |foot| foot.stretch[1]),
        Output::StretchXRateSW => Foot(SW, |foot| foot.stretch_rate[0]),
        Output::StretchXRateSE => Foot(SE, |foot| foot.stretch_rate[0]),
        Output::StretchXRateNW => Foot(NW, |foot| foot.stretch_rate[0]),
        Output::StretchXRateNE => Foot(NE, |foot| foot.stretch_rate[0]),
        Output::StretchYRateSW => Foot(SW, |foot| foot.stretch_rate[1]),
        Output::StretchYRateSE => Foot(SE, |foot| foot.stretch_rate[1]),
        Output::StretchYRateNW => Foot(NW, |foot| foot.stretch_rate[1]),
        Output::StretchYRateNE => Foot(NE, |foot| foot.stretch_rate[1]),
        Output::SlipRateSW => Foot(SW, |foot| foot.slip_rate),
        Output::SlipRateSE => Foot(SE, |foot| foot.slip_rate),
        Output::SlipRateNW => Foot(NW, |foot| foot.slip_rate),
        Output::SlipRateNE => Foot(NE, |foot| foot.slip_rate),
        Output::Touching => Observed(|at| at.touching() as f64),
        Output::Sliding => Observed(|at| at.sliding() as f64),
        Output::HX => Observed(|at| at.force.x),
        Output::HY => Observed(|at| at.force.y),
        Output::MBaseX => Observed(|at| at.moment.x),
        Output::MBaseY => Observed(|at| at.moment.y),
        Output::MBaseZ => Observed(|at| at.moment.z),
        Output::FrictionDemand => FrictionDemand,
        Output::DriftX => Observed(|at| at.drift[0]),
        Output::DriftY => Observed(|at| at.drift[1]),
        Output::EnergyTotal => Energy(|energies| energies.stored.total()),
        Output::EnergyKinetic => Energy(|energies| energies.stored.kinetic),
        Output::EnergyWeight => Energy(|energies| energies.stored.weight),
        Output::EnergySupports => Energy(|energies| energies.stored.supports),
        Output::EnergyInput => Energy(|energies| energies.input),
        Output::EnergyDashpots => Energy(|energies| energies.dashpots),
        Output::EnergySlip => Energy(|energies| energies.slip),
        Output::PowerInput => Observed(|at| at.powers[0]),
        Output::PowerDashpots => Observed(|at| at.powers[1]),
        Output::PowerSlip => Observed(|at| at.powers[2]),
        Output::EnergyLiftOff => Energy(|energies| energies.lift_off),
        Output::EnergyResidual => Energy(|energies| energies.residual),
        Output::PeakTilt => Peak(SpaceRun::peak_tilt, |rates| rates.tilt),
        Output::PeakTwist => Peak(|run| run.peaks().twist(), |rates| rates.twist),
        Output::PeakDrift => Peak(|run| run.peaks().drift(), |rates| rates.drift),
        Output::PeakN => Peak(|run| run.peaks().normal, |rates| rates.normal),
        Output::PeakUplift => Peak(|run| run.peaks().uplift, |rates| rates.uplift),
        Output::PeakSlip => Peak(|run| run.peaks().slip, |rates| rates.slip),
        Output::EventsLiftOffs => Discrete(|run| run.state().counts.lift_offs as f64),
        Output::EventsLandings => Discrete(|run| run.state().counts.landings as f64),
        Output::EventsSlides => Discrete(|run| run.state().counts.slides as f64),
        Output::EventsSticks => Discrete(|run| run.state().counts.sticks as f64),
        Output::EventsLastTime => Discrete(|run| run.state().last_event),
        Output::Separated => Discrete(|run| flag(run.state().separated)),
        Output::Overturned => {
            Discrete(|run| flag(run.state().ending.is_some_and(|(ending, _)| ending.is_overturning())))
        }
    }
}

/// Returns 1 for true and 0 for false.
fn flag(is: bool) -> f64 {
    f64::from(u8::from(is))
}

/// The source of a calculated parameter's value.
pub enum SpaceDerived {
    /// The block.
    Body(fn(&SpaceBody) -> f64),
    /// The peak of a record, by its direction.
    Peak(usize),
    /// The end of the records.
    End,
}

impl SpaceDerived {
    /// Returns the value of a source in the records.
    pub fn of_ground(&self, ground: &SpaceGround) -> f64 {
        match self {
            SpaceDerived::Body(_) => 0.0,
            SpaceDerived::Peak(axis) => {
                ground.records[*axis].as_ref().map_or(0.0, |record| record.peak().acceleration.abs())
            }
            SpaceDerived::End => ground.end().unwrap_or(0.0),
        }
    }
}

/// Returns the source of a calculated parameter.
pub fn derived(parameter: Derived) -> SpaceDerived {
    use SpaceDerived::{Body, Peak};
    match parameter {
        Derived::DerivedAlpha => Body(|body| body.alpha),
        Derived::DerivedR0 => Body(|body| body.r0),
        Derived::DerivedP => Body(|body| body.p),
        Derived::DerivedOmegaV => Body(|body| body.omega_v),
        Derived::DerivedEta => Body(|body| body.omega_v / body.p),
        Derived::DerivedXiV => Body(|body| body.xi_v),
        Derived::DerivedK => Body(|body| body.stiffness),
        Derived::DerivedC => Body(|body| body.damping),
        Derived::DerivedKH => Body(|body| body.horizontal_stiffness),
        Derived::DerivedCH => Body(|body| body.horizontal_damping),
        Derived::DerivedCenterHeight => Body(|body| body.center_height),
        Derived::DerivedInertiaX => Body(|body| body.inertia[(0, 0)]),
        Derived::DerivedInertiaY => Body(|body| body.inertia[(1, 1)]),
        Derived::DerivedInertiaZ => Body(|body| body.inertia[(2, 2)]),
        Derived::RecordPGAX => Peak(0),
        Derived::RecordPGAY => Peak(1),
        Derived::RecordPGAZ => Peak(2),
        Derived::RecordEnd => SpaceDerived::End,
    }
}

/// Returns the quantity of the feet that an array of FMI 3.0 has, if it is one.
pub fn of_feet(variable: Fmi3Variable) -> Option<fn(&FootObservation) -> f64> {
    match variable {
        Fmi3Variable::N => Some(|foot| foot.normal),
        Fmi3Variable::Uplift => Some(|foot| foot.uplift),
        Fmi3Variable::Slip => Some(|foot| foot.slip),
        Fmi3Variable::StretchX => Some(|foot| foot.stretch[0]),
        Fmi3Variable::StretchY => Some(|foot| foot.stretch[1]),
        Fmi3Variable::StretchXRate => Some(|foot| foot.stretch_rate[0]),
        Fmi3Variable::StretchYRate => Some(|foot| foot.stretch_rate[1]),
        Fmi3Variable::SlipRate => Some(|foot| foot.slip_rate),
        Fmi3Variable::Time
        | Fmi3Variable::FootCount
        | Fmi3Variable::FootX
        | Fmi3Variable::FootY
        | Fmi3Variable::FootGap
        | Fmi3Variable::RecordSamples
        | Fmi3Variable::RecordXSamples
        | Fmi3Variable::RecordYSamples
        | Fmi3Variable::RecordZSamples
        | Fmi3Variable::IntermediateInterval
        | Fmi3Variable::Indicator(_) => None,
    }
}
