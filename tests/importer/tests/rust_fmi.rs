//! The FMU in rust-fmi, and the interface's C types compared with those made from the standard's headers.

use std::mem::{offset_of, size_of};
use std::path::PathBuf;

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation, Common, InstanceCS};
use fmi::schema::fmi2::Fmi2ModelDescription;
use fmi::traits::FmiImport;
use fmi_sys::fmi2 as headers;
use rocking_block::fmi::fmi2::types as ours;

/// The FMU is in the folder of the profile, two levels above this executable.
fn fmu() -> PathBuf {
    let executable = std::env::current_exe().unwrap();
    executable.ancestors().nth(2).unwrap().join("RockingBlock.fmu")
}

fn reference(description: &Fmi2ModelDescription, name: &str) -> u32 {
    let variable = description.model_variables.variables.iter().find(|variable| variable.name == name);
    variable.unwrap_or_else(|| panic!("no variable {name}")).value_reference
}

/// The case `sine_eta40` of the reference trajectories.
#[test]
fn runs_a_reference_case() {
    let import: Fmi2Import = fmi::import::from_path(fmu()).unwrap();
    let description = import.model_description();
    assert_eq!(description.model_name, "RockingBlock");
    let of = |name: &str| reference(description, name);
    let mut block = InstanceCS::new(&import, "block", false, false).unwrap();
    assert_eq!((Common::get_version(&block), block.get_types_platform()), ("2.0", "default"));
    block.setup_experiment(Some(1e-10), 0.0, Some(10.0)).unwrap();
    block.set_integer(&[of("pulse.shape")], &[2]).unwrap();
    let paper = [of("dimensionless.alpha"), of("dimensionless.p"), of("mass")];
    block.set_real(&paper, &[0.25, 1.0, 1e5]).unwrap();
    block.set_real(&[of("pulse.amplitude"), of("pulse.period")], &[6.2622, std::f64::consts::TAU / 5.0]).unwrap();
    Common::enter_initialization_mode(&mut block).unwrap();
    Common::exit_initialization_mode(&mut block).unwrap();
    let mut trajectory = csv::Reader::from_path("../reference/sine_eta40.csv").unwrap();
    let (mut worst, mut rows) = (0.0_f64, 0);
    for row in trajectory.deserialize::<Vec<f64>>() {
        let row = row.unwrap();
        let mut theta = [0.0];
        if rows > 0 {
            block.do_step(f64::from(rows - 1) * 0.01, 0.01, true).unwrap();
        }
        block.get_real(&[of("theta")], &mut theta).unwrap();
        worst = worst.max((theta[0] - row[1]).abs());
        rows += 1;
    }
    assert_eq!(rows, 1001);
    assert!(worst < 1e-7 * 0.25, "theta differs by {worst} rad");
    Common::terminate(&mut block).unwrap();
}

#[test]
fn the_declarations_are_read() {
    let import: Fmi2Import = fmi::import::from_path(fmu()).unwrap();
    let co_simulation = import.model_description().co_simulation.as_ref().unwrap();
    assert_eq!(co_simulation.model_identifier, "rocking_block");
    assert_eq!(co_simulation.can_handle_variable_communication_step_size, Some(true));
    assert_eq!(co_simulation.can_interpolate_inputs, Some(true));
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
