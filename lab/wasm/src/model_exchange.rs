//! The resource of Model Exchange.

use std::mem::MaybeUninit;

use rocking_block::fmi::fmi3::calls::Call;
use rocking_block::fmi::fmi3::instance::{Answer, always, moves_to};
use rocking_block::fmi::fmi3::values::of_no_type;
use rocking_block::unit::fmu::{Exchanged, Fmu};
use rocking_block::unit::life_cycle::Phase;
use rocking_block::unit::snapshot;
use rocking_block::unit::variables::Kind;

use crate::bindings::exports::fmi::fmi3::model_exchange::{
    CompletedStepResult, DiscreteStatesInfo, GuestModelExchangeInstance, IntervalFraction, IntervalQualifier,
    ModelExchangeInstance, Status, VariableDependency,
};
use crate::instance::{Instance, State, Unit};

impl GuestModelExchangeInstance for Instance {
    common_methods!();

    fn instantiate_model_exchange(
        instance_name: String,
        instantiation_token: String,
        _resource_path: String,
        _visible: bool,
        logging_on: bool,
    ) -> Option<ModelExchangeInstance> {
        Instance::new("fmi3InstantiateModelExchange", instance_name, instantiation_token, logging_on, None)
            .map(ModelExchangeInstance::new)
    }

    transitions! {
        enter_continuous_time_mode EnterContinuousTimeMode moves_to(Phase::ContinuousTimeMode);
    }

    fn set_time(&self, time: f64) -> Status {
        self.call(Call::SetTime, |unit| unit.set_time(time))
    }

    fn set_continuous_states(&self, continuous_states: Vec<f64>) -> Status {
        self.call(Call::SetContinuousStates, |unit| unit.set_continuous_states(&continuous_states))
    }

    fn get_continuous_state_derivatives(&self) -> Result<Vec<f64>, Status> {
        self.get(
            Call::GetContinuousStateDerivatives,
            |unit| unit.unit.state_count(),
            |unit, values| unit.get_exchanged(Exchanged::Derivatives, values),
        )
    }

    fn get_event_indicators(&self) -> Result<Vec<f64>, Status> {
        self.get(
            Call::GetEventIndicators,
            |unit| unit.unit.indicator_count(),
            |unit, values| unit.get_exchanged(Exchanged::Indicators, values),
        )
    }

    fn get_continuous_states(&self) -> Result<Vec<f64>, Status> {
        self.get(
            Call::GetContinuousStates,
            |unit| unit.unit.state_count(),
            |unit, values| unit.get_exchanged(Exchanged::States, values),
        )
    }

    fn get_nominals_of_continuous_states(&self) -> Result<Vec<f64>, Status> {
        self.get(
            Call::GetNominalsOfContinuousStates,
            |unit| unit.unit.state_count(),
            |unit, values| unit.get_exchanged(Exchanged::Nominals, values),
        )
    }

    fn get_number_of_event_indicators(&self) -> Result<u64, Status> {
        self.ask(Call::GetNumberOfEventIndicators, |unit| Ok(unit.unit.indicator_count() as u64))
    }

    fn get_number_of_continuous_states(&self) -> Result<u64, Status> {
        self.ask(Call::GetNumberOfContinuousStates, |unit| Ok(unit.unit.state_count() as u64))
    }

    fn completed_integrator_step(&self, _: bool) -> Result<CompletedStepResult, Status> {
        self.ask(Call::CompletedIntegratorStep, |unit| {
            unit.unit.complete_step();
            Ok(CompletedStepResult { enter_event_mode: false, terminate_simulation: false })
        })
    }
}
