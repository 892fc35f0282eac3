//! A safe handle over the exported functions, called as by an importer in C.

use std::ffi::CString;
use std::ptr::{null, null_mut};

use rocking_block::fmi::fmi2::exports::*;
use rocking_block::fmi::fmi2::types::*;
use rocking_block::unit::variables::{Causality, GUID, Kind, Metadata, VARIABLES};

/// Status numbers of the standard.
pub const OK: fmi2Status = 0;
pub const WARNING: fmi2Status = 1;
pub const DISCARD: fmi2Status = 2;
pub const ERROR: fmi2Status = 3;

/// An instance with its saved states, freed together.
pub struct Fmu {
    pub component: fmi2Component,
    pub states: Vec<fmi2FMUstate>,
}

impl Drop for Fmu {
    fn drop(&mut self) {
        for state in &mut self.states {
            // SAFETY: the instance lives, and each state is null or was saved by it and not freed (standard, 2.1.8).
            unsafe { fmi2FreeFMUstate(self.component, state) };
        }
        // SAFETY: the instance lives and is not used after this (standard, 2.1.5).
        unsafe { fmi2FreeInstance(self.component) };
    }
}

/// Returns the value references of the outputs and calculated parameters of a type.
fn readable(kind: Kind) -> Vec<u32> {
    references(|causality, k| k == kind && matches!(causality, Causality::Output | Causality::CalculatedParameter))
}

pub fn references(wanted: impl Fn(Causality, Kind) -> bool) -> Vec<u32> {
    VARIABLES.iter().filter(|v| wanted(v.causality, v.kind.base())).map(Metadata::reference).collect()
}

pub fn reference(name: &str) -> u32 {
    VARIABLES.iter().find(|variable| variable.name == name).unwrap_or_else(|| panic!("no {name}")).reference()
}

impl Fmu {
    pub fn new() -> Fmu {
        let guid = CString::new(GUID).unwrap();
        let callbacks = fmi2CallbackFunctions {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: null_mut(),
        };
        // SAFETY: texts end with 0 and the callbacks live during the call, which copies them.
        let component = unsafe {
            fmi2Instantiate(c"block".as_ptr(), FMI2_CO_SIMULATION, guid.as_ptr(), null(), &raw const callbacks, 0, 0)
        };
        assert!(!component.is_null());
        Fmu { component, states: Vec::new() }
    }

    pub fn setup(&mut self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> fmi2Status {
        let (has_tolerance, has_stop) = (tolerance.is_some().into(), stop.is_some().into());
        let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
        // SAFETY: the instance lives.
        unsafe { fmi2SetupExperiment(self.component, has_tolerance, tolerance, start, has_stop, stop) }
    }

    pub fn enter(&mut self) -> fmi2Status {
        // SAFETY: the instance lives.
        unsafe { fmi2EnterInitializationMode(self.component) }
    }

    pub fn exit(&mut self) -> fmi2Status {
        // SAFETY: the instance lives.
        unsafe { fmi2ExitInitializationMode(self.component) }
    }

    pub fn terminate(&mut self) -> fmi2Status {
        // SAFETY: the instance lives.
        unsafe { fmi2Terminate(self.component) }
    }

    pub fn reset(&mut self) -> fmi2Status {
        // SAFETY: the instance lives.
        unsafe { fmi2Reset(self.component) }
    }

    pub fn step(&mut self, time: f64, step: f64) -> fmi2Status {
        // SAFETY: the instance lives.
        unsafe { fmi2DoStep(self.component, time, step, 0) }
    }

    /// Sets a variable of any type.
    pub fn set(&mut self, reference: u32, value: f64) -> fmi2Status {
        let (integer, c) = (value as i32, self.component);
        // SAFETY: the instance lives, and each pointer is to one element.
        unsafe {
            match Metadata::of(reference).map_or(Kind::Real, |variable| variable.kind.base()) {
                Kind::Boolean => fmi2SetBoolean(c, &raw const reference, 1, &raw const integer),
                Kind::Integer | Kind::Enumeration => fmi2SetInteger(c, &raw const reference, 1, &raw const integer),
                Kind::Real | Kind::String => fmi2SetReal(c, &raw const reference, 1, &raw const value),
            }
        }
    }

    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> fmi2Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2SetReal(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    pub fn set_rates(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> fmi2Status {
        assert_eq!([references.len(); 2], [orders.len(), values.len()]);
        let (n, c) = (references.len(), self.component);
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2SetRealInputDerivatives(c, references.as_ptr(), n, orders.as_ptr(), values.as_ptr()) }
    }

    pub fn reals(&mut self, references: &[u32], values: &mut [f64]) -> fmi2Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2GetReal(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    pub fn integers(&mut self, references: &[u32], values: &mut [i32]) -> fmi2Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2GetInteger(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    pub fn booleans(&mut self, references: &[u32], values: &mut [i32]) -> fmi2Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2GetBoolean(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    pub fn rates(&mut self, references: &[u32], orders: &[i32], values: &mut [f64]) -> fmi2Status {
        assert_eq!([references.len(); 2], [orders.len(), values.len()]);
        let (n, c) = (references.len(), self.component);
        // SAFETY: the instance lives, and the arrays are as long as the count.
        unsafe { fmi2GetRealOutputDerivatives(c, references.as_ptr(), n, orders.as_ptr(), values.as_mut_ptr()) }
    }

    pub fn directional(&mut self, of: &[u32], to: &[u32], direction: &[f64], values: &mut [f64]) -> fmi2Status {
        assert_eq!([of.len(), to.len()], [values.len(), direction.len()]);
        let (direction, values) = (direction.as_ptr(), values.as_mut_ptr());
        // SAFETY: the instance lives, and the arrays are as long as their counts.
        unsafe {
            fmi2GetDirectionalDerivative(
                self.component,
                of.as_ptr(),
                of.len(),
                to.as_ptr(),
                to.len(),
                direction,
                values,
            )
        }
    }

    /// `(fmi2Terminated, fmi2LastSuccessfulTime)`.
    pub fn ended(&mut self) -> (bool, f64) {
        let (mut terminated, mut time) = (0, 0.0);
        // SAFETY: the instance lives, and the places are for one value.
        unsafe {
            assert_eq!(fmi2GetBooleanStatus(self.component, 3, &raw mut terminated), OK);
            assert_eq!(fmi2GetRealStatus(self.component, 2, &raw mut time), OK);
        }
        (terminated != 0, time)
    }

    /// Saves the state into a slot, or into a new slot after the last.
    pub fn save(&mut self, slot: usize) -> fmi2Status {
        if slot >= self.states.len() {
            self.states.push(null_mut());
        }
        let slot = slot.min(self.states.len() - 1);
        // SAFETY: the instance lives, and the state is null or was saved by it and not freed.
        unsafe { fmi2GetFMUstate(self.component, &raw mut self.states[slot]) }
    }

    pub fn restore(&mut self, slot: usize) -> fmi2Status {
        let state = self.states.get(slot).copied().unwrap_or(null_mut());
        // SAFETY: the instance lives, and the state is null or was saved by it and not freed.
        unsafe { fmi2SetFMUstate(self.component, state) }
    }

    pub fn free(&mut self, slot: usize) -> fmi2Status {
        let mut none = null_mut();
        let state = self.states.get_mut(slot).unwrap_or(&mut none);
        // SAFETY: the instance lives, and the state is null or was saved by it and not freed; it is null afterwards.
        unsafe { fmi2FreeFMUstate(self.component, state) }
    }

    /// Returns the bytes of a saved state, or the status of the failure.
    pub fn serialize(&mut self, slot: usize) -> Result<Vec<u8>, fmi2Status> {
        let state = self.states.get(slot).copied().unwrap_or(null_mut());
        let mut size = 0;
        // SAFETY: the instance lives, and the state is null or was saved by it and not freed.
        match unsafe { fmi2SerializedFMUstateSize(self.component, state, &raw mut size) } {
            OK => {}
            status => return Err(status),
        }
        let mut bytes = vec![0; size];
        // SAFETY: the instance lives, and the buffer is as large as its count says.
        match unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr().cast(), size) } {
            OK => Ok(bytes),
            status => Err(status),
        }
    }

    /// Restores a state from bytes into a new slot after the last.
    pub fn deserialize(&mut self, bytes: &[u8]) -> fmi2Status {
        let mut state = null_mut();
        // SAFETY: the instance lives, the count is the number of bytes, and the pointer to the state is valid.
        let status =
            unsafe { fmi2DeSerializeFMUstate(self.component, bytes.as_ptr().cast(), bytes.len(), &raw mut state) };
        assert_eq!(status == OK, !state.is_null(), "a refused state must not be given");
        if status == OK {
            self.states.push(state);
        }
        status
    }

    /// Returns true if steps are quick: the motion is ordinary, or so violent that no step can follow.
    ///
    /// In between, clock and tolerance admit up to 10¹⁵ valid steps.
    pub fn is_quick(&mut self) -> bool {
        let mut motion = [0.0; 5];
        let names = ["theta_dot", "v_dot", "theta_ddot", "v_ddot", "u_ddot"];
        let known = self.reals(&names.map(reference), &mut motion) == OK;
        !known || !motion.iter().any(|rate| (1e7..1e30).contains(&rate.abs()))
    }

    /// Returns the bits of all outputs and calculated parameters, after checking that Reals are finite.
    pub fn bits(&mut self) -> Vec<u64> {
        let real = readable(Kind::Real);
        let mut values = vec![f64::NAN; real.len()];
        assert_eq!(self.reals(&real, &mut values), OK);
        for (&reference, value) in real.iter().zip(&values) {
            assert!(value.is_finite(), "{} = {value}", Metadata::of(reference).unwrap().name);
        }
        let mut bits: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
        let (integer, boolean) = (readable(Kind::Integer), readable(Kind::Boolean));
        let mut values = vec![0; integer.len() + boolean.len()];
        let (integers, booleans) = values.split_at_mut(integer.len());
        assert_eq!(self.integers(&integer, integers), OK);
        assert_eq!(self.booleans(&boolean, booleans), OK);
        bits.extend(values.iter().map(|&value| value as u64));
        bits
    }

    /// Returns the bits of the derivatives of Real outputs, in time (if `stepped`) and with respect to each input.
    pub fn derivative_bits(&mut self, stepped: bool) -> Vec<u64> {
        let outputs = references(|causality, kind| causality == Causality::Output && kind == Kind::Real);
        let mut bits = Vec::new();
        let mut values = vec![f64::NAN; outputs.len()];
        if stepped {
            assert_eq!(self.rates(&outputs, &vec![1; outputs.len()], &mut values), OK);
            bits.extend(finite(&outputs, &values));
        }
        for input in references(|causality, _| causality == Causality::Input) {
            assert_eq!(self.directional(&outputs, &[input], &[1.0], &mut values), OK);
            bits.extend(finite(&outputs, &values));
        }
        bits
    }
}

fn finite<'a>(references: &'a [u32], values: &'a [f64]) -> impl Iterator<Item = u64> + 'a {
    references.iter().zip(values).map(|(&reference, value)| {
        assert!(value.is_finite(), "derivative of {} = {value}", Metadata::of(reference).unwrap().name);
        value.to_bits()
    })
}
