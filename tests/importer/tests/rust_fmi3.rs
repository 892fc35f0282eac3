//! The FMUs of FMI 3.0 through the functions that rust-fmi makes from the standard's headers. Its reader of modelDescription.xml
//! (fmi-schema 0.8.0) refuses the standard's attribute `unit` of a variable, and so any FMU with units.

use std::ffi::CString;
use std::io::Read;
use std::path::PathBuf;
use std::ptr::{null, null_mut};

use fmi_sys::fmi3::{Fmi3Binding, fmi3Status_fmi3OK as OK};
use importer_tests::{Case, IN_SPACE, IN_THE_PLANE};
use rocking_block::unit::{in_space, variables};

/// Unpacks the library of an FMU, which is in the folder of the profile, two levels above this executable.
fn library(unit: &str) -> (tempfile::TempDir, Fmi3Binding) {
    let executable = std::env::current_exe().unwrap();
    let fmu: PathBuf = executable.ancestors().nth(2).unwrap().join(format!("{unit}-fmi3.fmu"));
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

/// Runs a reference trajectory by steps that return at events, which are handled in Event Mode, and compares the outputs to 1e-7 α. The
/// counters count at least the events at which steps have returned.
fn follows(case: &Case, token: &str, reference: impl Fn(&str) -> u32, counters: &[&str]) {
    let (_folder, fmu) = library(case.unit);
    let token = CString::new(token).unwrap();
    let counters: Vec<u32> = counters.iter().map(|name| reference(name)).collect();
    let outputs: Vec<u32> = case.outputs.iter().map(|(name, _)| reference(name)).collect();
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
        for (name, value) in case.choices {
            assert_eq!(fmu.fmi3SetInt64(block, &reference(name), 1, &i64::from(*value), 1), OK);
        }
        for (name, value) in case.reals {
            assert_eq!(fmu.fmi3SetFloat64(block, &reference(name), 1, value, 1), OK);
        }
        assert_eq!(fmu.fmi3EnterInitializationMode(block, true, 1e-10, 0.0, true, case.duration()), OK);
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
        let (mut worst, mut events, mut time) = (0.0_f64, 0, 0.0);
        for row in case.rows() {
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
            let mut values = vec![0.0; outputs.len()];
            let count = outputs.len();
            assert_eq!(fmu.fmi3GetFloat64(block, outputs.as_ptr(), count, values.as_mut_ptr(), count), OK);
            worst = worst.max(case.difference(&row, &values));
        }
        let mut counted = vec![0; counters.len()];
        let count = counters.len();
        assert_eq!(fmu.fmi3GetInt32(block, counters.as_ptr(), count, counted.as_mut_ptr(), count), OK);
        assert!(events > 10 && events <= counted.iter().sum(), "{events} events, {counted:?} counted");
        assert!(worst < 1e-7, "{worst} α");
        assert_eq!(fmu.fmi3Terminate(block), OK);
        fmu.fmi3FreeInstance(block);
    }
}

/// Returns the value reference of a variable by the names of all, from 1 in their order.
fn reference(mut names: impl Iterator<Item = &'static str>, name: &str) -> u32 {
    let place = names.position(|known| known == name).unwrap_or_else(|| panic!("no {name}"));
    u32::try_from(place).unwrap() + 1
}

#[test]
fn runs_a_reference_case() {
    use variables::{TOKEN, VARIABLES};
    let reference = |name: &str| reference(VARIABLES.iter().map(|variable| variable.name), name);
    follows(&IN_THE_PLANE, TOKEN, reference, &["events.impacts", "events.liftoffs"]);
}

#[test]
fn runs_a_reference_case_in_space() {
    use in_space::variables::{TOKEN, VARIABLES};
    let reference = |name: &str| reference(VARIABLES.iter().map(|variable| variable.name), name);
    let counters = ["events.lift_offs", "events.landings", "events.slides", "events.sticks"];
    follows(&IN_SPACE, TOKEN, reference, &counters);
}
