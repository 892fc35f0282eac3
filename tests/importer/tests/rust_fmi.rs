//! The FMUs in rust-fmi, and the interface's C types compared with those made from the standard's headers.

use std::mem::{offset_of, size_of};
use std::path::PathBuf;

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common, InstanceCS};
use fmi::schema::fmi2::Fmi2ModelDescription;
use fmi::traits::FmiImport;
use fmi_sys::fmi2 as headers;
use importer_tests::{Case, IN_SPACE, IN_THE_PLANE};
use rocking_block::fmi::fmi2::types as ours;

/// The FMUs are in the folder of the profile, two levels above this executable.
fn fmu(name: &str) -> PathBuf {
    let executable = std::env::current_exe().unwrap();
    executable.ancestors().nth(2).unwrap().join(name).with_extension("fmu")
}

fn reference(description: &Fmi2ModelDescription, name: &str) -> u32 {
    let variable = description.model_variables.variables.iter().find(|variable| variable.name == name);
    variable.unwrap_or_else(|| panic!("no variable {name}")).value_reference
}

/// Runs a reference trajectory, whose columns have these numbers, and compares the outputs to 1e-7 α.
fn follows(case: &Case) {
    let import: Fmi2Import = fmi::import::from_path(fmu(case.unit)).unwrap();
    let description = import.model_description();
    assert_eq!(description.model_name, case.unit);
    let of = |name: &str| reference(description, name);
    let mut block = InstanceCS::new(&import, "block", false, false).unwrap();
    assert_eq!((Common::get_version(&block), block.get_types_platform()), ("2.0", "default"));
    block.setup_experiment(Some(1e-10), 0.0, Some(case.duration())).unwrap();
    for (name, value) in case.choices {
        block.set_integer(&[of(name)], &[*value]).unwrap();
    }
    for (name, value) in case.reals {
        block.set_real(&[of(name)], &[*value]).unwrap();
    }
    Common::enter_initialization_mode(&mut block).unwrap();
    Common::exit_initialization_mode(&mut block).unwrap();
    let outputs: Vec<u32> = case.outputs.iter().map(|(name, _)| of(name)).collect();
    let (mut worst, mut rows) = (0.0_f64, 0_u32);
    for row in case.rows() {
        if rows > 0 {
            block.do_step(f64::from(rows - 1) * 0.01, 0.01, true).unwrap();
        }
        let mut values = vec![0.0; outputs.len()];
        block.get_real(&outputs, &mut values).unwrap();
        worst = worst.max(case.difference(&row, &values));
        rows += 1;
    }
    assert_eq!(f64::from(rows), (100.0 * case.duration()).round() + 1.0);
    assert!(worst < 1e-7, "{worst} α");
    Common::terminate(&mut block).unwrap();
}

#[test]
fn runs_a_reference_case() {
    follows(&IN_THE_PLANE);
}

#[test]
fn runs_a_reference_case_in_space() {
    follows(&IN_SPACE);
}

#[test]
fn the_declarations_are_read() {
    for (unit, identifier) in [("RockingBlock", "rocking_block"), ("RockingBlockInSpace", "rocking_block_in_space")] {
        let import: Fmi2Import = fmi::import::from_path(fmu(unit)).unwrap();
        let co_simulation = import.model_description().co_simulation.as_ref().unwrap();
        assert_eq!(co_simulation.model_identifier, identifier);
        assert_eq!(co_simulation.can_handle_variable_communication_step_size, Some(true));
        assert_eq!(co_simulation.can_interpolate_inputs, Some(true));
    }
}

/// Any structure that differs from the header's in a field or its position would be misread.
#[test]
fn the_callbacks_lie_as_in_the_header() {
    assert_eq!(size_of::<ours::fmi2CallbackFunctions>(), size_of::<headers::fmi2CallbackFunctions>());
    assert_eq!(size_of::<ours::fmi2EventInfo>(), size_of::<headers::fmi2EventInfo>());
    assert_eq!(
        [
            offset_of!(ours::fmi2CallbackFunctions, logger),
            offset_of!(ours::fmi2CallbackFunctions, allocate_memory),
            offset_of!(ours::fmi2CallbackFunctions, free_memory),
            offset_of!(ours::fmi2CallbackFunctions, step_finished),
            offset_of!(ours::fmi2CallbackFunctions, environment),
        ],
        [
            offset_of!(headers::fmi2CallbackFunctions, logger),
            offset_of!(headers::fmi2CallbackFunctions, allocateMemory),
            offset_of!(headers::fmi2CallbackFunctions, freeMemory),
            offset_of!(headers::fmi2CallbackFunctions, stepFinished),
            offset_of!(headers::fmi2CallbackFunctions, componentEnvironment),
        ]
    );
    assert_eq!(ours::FMI2_CO_SIMULATION, headers::fmi2Type_fmi2CoSimulation as i32);
    assert_eq!(size_of::<ours::fmi2Status>(), size_of::<headers::fmi2Status>());
    assert_eq!(size_of::<ours::fmi2ValueReference>(), size_of::<headers::fmi2ValueReference>());
    assert_eq!(size_of::<ours::fmi2Boolean>(), size_of::<headers::fmi2Boolean>());
}
