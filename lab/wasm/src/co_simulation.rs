//! The resource of Co-Simulation.

use std::cell::Cell;
use std::mem::MaybeUninit;

use rocking_block::fmi::fmi3::boundary::{self, Stepping};
use rocking_block::fmi::fmi3::calls::Call;
use rocking_block::fmi::fmi3::instance::{Answer, always, moves_to};
use rocking_block::fmi::fmi3::step::StepOutcome;
use rocking_block::fmi::fmi3::types::*;
use rocking_block::fmi::fmi3::values::of_no_type;
use rocking_block::unit::fmu::Fmu;
use rocking_block::unit::life_cycle::Phase;
use rocking_block::unit::snapshot;
use rocking_block::unit::variables::Kind;

use crate::bindings::exports::fmi::fmi3::co_simulation::{
    CoSimulationInstance, DiscreteStatesInfo, DoStepResult, GuestCoSimulationInstance, IntervalFraction,
    IntervalQualifier, Status, VariableDependency,
};
use crate::bindings::fmi::fmi3::intermediate_update_callbacks::intermediate_update;
use crate::instance::{Instance, State, Unit, status};

impl GuestCoSimulationInstance for Instance {
    common_methods!();

    /// Updates happen if the importer allows early return and names variables. It need not have the callback otherwise; a list without
    /// names replaces the `NULL` of C.
    fn instantiate_co_simulation(
        instance_name: String,
        instantiation_token: String,
        _resource_path: String,
        _visible: bool,
        logging_on: bool,
        event_mode_used: bool,
        early_return_allowed: bool,
        required_intermediate_variables: Vec<u32>,
    ) -> Option<CoSimulationInstance> {
        let updates = early_return_allowed && !required_intermediate_variables.is_empty();
        let stepping = Stepping {
            event_mode: event_mode_used.into(),
            early_return: early_return_allowed.into(),
            required: required_intermediate_variables.as_ptr(),
            required_count: required_intermediate_variables.len(),
            update: updates.then_some(update as fmi3IntermediateUpdateCallback),
        };
        Instance::new("fmi3InstantiateCoSimulation", instance_name, instantiation_token, logging_on, Some(stepping))
            .map(CoSimulationInstance::new)
    }

    fn set_input_derivatives(&self, _: Vec<(u32, u32)>, _: Vec<f64>) -> Status {
        self.refuse(Call::SetInputDerivatives)
    }

    fn do_step(
        &self,
        current_communication_point: f64,
        communication_step_size: f64,
        _no_set_fmu_state_prior_to_current_point: bool,
    ) -> Result<DoStepResult, Status> {
        let step = StepOutcome::new(current_communication_point, communication_step_size);
        let result = Cell::new(None);
        let done = |step: &StepOutcome| {
            result.set(Some(DoStepResult {
                last_successful_time: step.reached,
                event_handling_needed: step.event,
                terminate_simulation: step.terminates,
                early_return: step.early,
            }));
            Ok(rocking_block::fmi::Status::Ok)
        };
        // SAFETY: a live instance (standard, 2.3.1).
        let code = unsafe { boundary::do_step::<State>(self.handle(), step, || Ok(()), done) };
        result.take().ok_or(status(code))
    }
}

/// `fmi3IntermediateUpdateCallback`: asks the importer.
unsafe extern "C-unwind" fn update(
    _environment: fmi3InstanceEnvironment,
    time: f64,
    set_requested: fmi3Boolean,
    get_allowed: fmi3Boolean,
    step_finished: fmi3Boolean,
    can_return_early: fmi3Boolean,
    early_return_requested: *mut fmi3Boolean,
    early_return_time: *mut f64,
) {
    let [set_requested, get_allowed, step_finished, can_return_early] =
        [set_requested, get_allowed, step_finished, can_return_early].map(|flag| flag != FMI3_FALSE);
    let (requested, return_time) =
        intermediate_update(time, set_requested, get_allowed, step_finished, can_return_early);
    // SAFETY: memory for the answers (standard, 4.2.2).
    unsafe {
        *early_return_requested = requested.into();
        *early_return_time = return_time;
    }
}
