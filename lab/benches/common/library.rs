//! The library in a packed FMU, as an importer on Linux loads it.

use std::ffi::{CString, c_int};
use std::io::Read;
use std::path::Path;
use std::ptr::{null, null_mut};

use libloading::Library;
use rocking_block::excitation::Inputs;
use rocking_block::fmi::fmi2::types::*;
use rocking_block::unit::variables::GUID;

use crate::fmu::{OK, reference};

type Instantiate = unsafe extern "C" fn(
    fmi2String,
    fmi2Type,
    fmi2String,
    fmi2String,
    *const fmi2CallbackFunctions,
    fmi2Boolean,
    fmi2Boolean,
) -> fmi2Component;
type SetupExperiment =
    unsafe extern "C" fn(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) -> fmi2Status;
type OfInstance = unsafe extern "C" fn(fmi2Component) -> fmi2Status;
type FreeInstance = unsafe extern "C" fn(fmi2Component);
type SetReal = unsafe extern "C" fn(fmi2Component, *const fmi2ValueReference, usize, *const fmi2Real) -> fmi2Status;
type SetRates = unsafe extern "C" fn(
    fmi2Component,
    *const fmi2ValueReference,
    usize,
    *const fmi2Integer,
    *const fmi2Real,
) -> fmi2Status;
type DoStep = unsafe extern "C" fn(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean) -> fmi2Status;

/// The functions of a run under a record.
pub struct PackedFmu {
    library: Library,
    set_real: SetReal,
    set_rates: SetRates,
    do_step: DoStep,
}

impl PackedFmu {
    /// Loads the FMU that `cargo run --release` has packed.
    pub fn of_build() -> PackedFmu {
        const FMU: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/release/RockingBlock.fmu");
        PackedFmu::load(Path::new(FMU))
            .unwrap_or_else(|error| panic!("{FMU}: {error}; expected the FMU of `cargo run --release`"))
    }

    /// Loads the library for Linux on x86-64 from this FMU.
    fn load(fmu: &Path) -> Result<PackedFmu, Box<dyn std::error::Error>> {
        let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu)?)?;
        let mut bytes = Vec::new();
        archive.by_name("binaries/linux64/rocking_block.so")?.read_to_end(&mut bytes)?;
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("rocking_block.so");
        std::fs::write(&path, bytes)?;
        // SAFETY: the library has no initialization of its own, and the types are those of the standard's headers.
        unsafe {
            let library = Library::new(&path)?;
            let set_real = function(&library, "fmi2SetReal");
            let set_rates = function(&library, "fmi2SetRealInputDerivatives");
            let do_step = function(&library, "fmi2DoStep");
            Ok(PackedFmu { library, set_real, set_rates, do_step })
        }
    }

    /// The run of [`super::run_record`]: input, its derivative, step.
    pub fn run_record(&self, intervals: &[(Inputs, f64)]) {
        let PackedFmu { library, set_real, set_rates, do_step } = self;
        let (first, _) = intervals[0];
        let guid = CString::new(GUID).expect("a text without 0");
        let callbacks = fmi2CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        let input = reference("a_gx");
        // SAFETY: texts end with 0, arrays have one element, and the instance lives until it is freed (standard, 2.1.5, 2.1.7).
        unsafe {
            let instantiate = function::<Instantiate>(library, "fmi2Instantiate");
            let name = c"block".as_ptr();
            let block = instantiate(name, FMI2_CO_SIMULATION, guid.as_ptr(), null(), &raw const callbacks, 0, 0);
            assert!(!block.is_null());
            let set = |reference: u32, value: f64| set_real(block, &raw const reference, 1, &raw const value);
            for (name, value) in super::BLOCK {
                assert_eq!(set(reference(name), value), OK);
            }
            assert_eq!(set(input, first.a_gx.value), OK);
            assert_eq!(
                function::<SetupExperiment>(library, "fmi2SetupExperiment")(block, 0, 0.0, first.time, 0, 0.0),
                OK
            );
            for name in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode"] {
                assert_eq!(function::<OfInstance>(library, name)(block), OK);
            }
            let order: c_int = 1;
            for (Inputs { time, a_gx, .. }, until) in intervals {
                assert_eq!(set(input, a_gx.value), OK);
                assert_eq!(set_rates(block, &raw const input, 1, &raw const order, &raw const a_gx.rate), OK);
                assert_eq!(do_step(block, *time, until - time, 0), OK);
            }
            function::<FreeInstance>(library, "fmi2FreeInstance")(block);
        }
    }
}

/// A function of the library.
///
/// # Safety
/// `F` is its type, and it is called only while the library is loaded.
unsafe fn function<F: Copy>(library: &Library, name: &str) -> F {
    // SAFETY: by contract.
    *unsafe { library.get::<F>(name.as_bytes()) }.unwrap_or_else(|error| panic!("{name}: {error}"))
}
