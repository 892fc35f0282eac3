//! The FMU of FMI 3.0 through the functions that rust-fmi makes from the standard's headers. Its reader of modelDescription.xml
//! (fmi-schema 0.8.0) refuses the standard's attribute `unit` of a variable, and so any FMU with units.

use std::ffi::CString;
use std::io::Read;
use std::path::PathBuf;
use std::ptr::{null, null_mut};

use fmi_sys::fmi3::{Fmi3Binding, fmi3Status_fmi3OK as OK};
use rocking_block::unit::variables::{TOKEN, VARIABLES};

/// Unpacks the library of the FMU, which is in the folder of the profile, two levels above this executable.
fn library() -> (tempfile::TempDir, Fmi3Binding) {
    let executable = std::env::current_exe().unwrap();
    let fmu: PathBuf = executable.ancestors().nth(2).unwrap().join("RockingBlock-fmi3.fmu");
    let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu).unwrap()).unwrap();
    let mut names = archive.file_names().map(|name| name.unwrap().into_owned());
    let name = names.find(|name| name.starts_with("binaries/")).unwrap();
    drop(names);
    let mut bytes = Vec::new();
    archive.by_name(&name).unwrap().read_to_end(&mut bytes).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rocking_block");
    std::fs::write(&path, bytes).unwrap();
    // SAFETY: the library has no initialization of its own, and the types are those of the standard's headers.
    (folder, unsafe { Fmi3Binding::new(path) }.unwrap())
}

fn reference(name: &str) -> u32 {
    VARIABLES.iter().find(|variable| variable.name == name).unwrap_or_else(|| panic!("no {name}")).reference()
}

/// The case `sine_eta40` of the reference trajectories, by steps that return at events, which are handled in Event Mode.
#[test]
fn runs_a_reference_case() {
    let (_folder, fmu) = library();
    let token = CString::new(TOKEN).unwrap();
    let shape = reference("pulse.shape");
    let reals = ["pulse.amplitude", "pulse.period", "mass", "dimensionless.alpha", "dimensionless.p"].map(reference);
    let counters = ["events.impacts", "events.liftoffs"].map(reference);
    let mut trajectory = csv::Reader::from_path("../reference/sine_eta40.csv").unwrap();
    // SAFETY: the instance lives until it is freed at the end; texts end with 0, and arrays are as long as their counts.
    unsafe {
        let block = fmu.fmi3InstantiateCoSimulation(
            c"block".as_ptr(),
            token.as_ptr(),
            null(),
            false,
            false,
            true,
            true,
            null(),
            0,
            null_mut(),
            None,
            None,
        );
        assert!(!block.is_null());
        assert_eq!(fmu.fmi3SetInt64(block, &shape, 1, &2, 1), OK);
        let values = [6.2622, std::f64::consts::TAU / 5.0, 1e5, 0.25, 1.0];
        assert_eq!(fmu.fmi3SetFloat64(block, reals.as_ptr(), reals.len(), values.as_ptr(), values.len()), OK);
        assert_eq!(fmu.fmi3EnterInitializationMode(block, true, 1e-10, 0.0, true, 10.0), OK);
        assert_eq!(fmu.fmi3ExitInitializationMode(block), OK);
        let handle_events = || {
            let [mut more, mut ends, mut nominals, mut states, mut defined] = [true; 5];
            let mut next = f64::NAN;
            let status = fmu.fmi3UpdateDiscreteStates(
                block,
                &mut more,
                &mut ends,
                &mut nominals,
                &mut states,
                &mut defined,
                &mut next,
            );
            assert_eq!((status, more, ends), (OK, false, false));
            assert_eq!(fmu.fmi3EnterStepMode(block), OK);
        };
        handle_events();
        let (mut worst, mut rows, mut events, mut time) = (0.0_f64, 0, 0, 0.0);
        for row in trajectory.deserialize::<Vec<f64>>() {
            let row = row.unwrap();
            while time < row[0] {
                let [mut event, mut ends, mut early] = [false; 3];
                let (size, mut reached) = (row[0] - time, f64::NAN);
                let status = fmu.fmi3DoStep(block, time, size, true, &mut event, &mut ends, &mut early, &mut reached);
                assert_eq!((status, ends, early), (OK, false, reached < row[0]));
                assert!(reached > time, "{reached} after {time}");
                time = reached;
                if event {
                    events += 1;
                    assert_eq!(fmu.fmi3EnterEventMode(block), OK);
                    handle_events();
                }
            }
            let mut theta = 0.0;
            assert_eq!(fmu.fmi3GetFloat64(block, &reference("theta"), 1, &mut theta, 1), OK);
            worst = worst.max((theta - row[1]).abs());
            rows += 1;
        }
        assert_eq!(rows, 1001);
        let mut counted = [0; 2];
        assert_eq!(fmu.fmi3GetInt32(block, counters.as_ptr(), 2, counted.as_mut_ptr(), 2), OK);
        assert!(events > 10 && events <= counted.iter().sum(), "{events} events, {counted:?} impacts and lift-offs");
        assert!(worst < 1e-7 * 0.25, "theta differs by {worst} rad");
        assert_eq!(fmu.fmi3Terminate(block), OK);
        fmu.fmi3FreeInstance(block);
    }
}
