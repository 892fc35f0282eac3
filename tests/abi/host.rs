//! A small importer: unpacks the FMU, loads its library, and wraps an instance.

use std::ffi::{CStr, CString, c_char, c_int};
use std::io::Read;
use std::ptr::{null, null_mut};
use std::sync::{LazyLock, Mutex};

use crate::description::{self, Description};
use crate::functions::*;
use crate::unit;

/// The unpacked FMU.
pub struct Fmu {
    pub functions: Functions,
    pub description: Description,
    /// modelDescription.xml.
    pub xml: String,
    pub binary: Vec<u8>,
}

/// The FMU that the build packed; its library is loaded once and stays.
pub static FMU: LazyLock<Fmu> = LazyLock::new(|| {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(unit::PATH).unwrap()).unwrap();
    let mut entry = |name: &str| {
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    };
    let library = format!("{}.so", unit::IDENTIFIER);
    let binary = entry(&format!("binaries/linux64/{library}"));
    let xml = String::from_utf8(entry("modelDescription.xml")).unwrap();
    let description = description::read(&xml);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(library);
    std::fs::write(&path, &binary).unwrap();
    // SAFETY: the library has no initialization of its own.
    let library = unsafe { libloading::Library::new(&path) }.unwrap();
    let functions = Functions::load(&library);
    // Not unloaded: the function pointers outlive this closure.
    std::mem::forget(library);
    Fmu { functions, description, xml, binary }
});

/// A message received by the logger.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub instance: String,
    pub status: Status,
    pub category: String,
    pub format: String,
    /// The text that C prints by the format alone; empty if that asks for an argument.
    pub text: String,
}

/// The messages collected by the logger.
pub type Messages = Mutex<Vec<Message>>;

unsafe extern "C" fn logger(environment: Environment, instance: Text, status: Status, category: Text, format: Text) {
    // SAFETY: the environment is this instance's `Messages`, and texts end with 0 (standard, 2.1.5).
    let (messages, [instance, category, format]) = unsafe {
        (
            &*environment.cast::<Messages>(),
            [instance, category, format]
                .map(|text| CStr::from_ptr(text).to_str().expect("messages are UTF-8").to_string()),
        )
    };
    let text = printed(&format);
    messages.lock().unwrap().push(Message { instance, status, category, format, text });
}

/// Prints a format without arguments; nothing if it asks for one.
fn printed(format: &str) -> String {
    let pieces: Vec<&str> = format.split("%%").collect();
    if pieces.iter().any(|piece| piece.contains('%')) { String::new() } else { pieces.join("%") }
}

/// The callbacks of this importer.
pub fn callbacks(messages: &Messages) -> Callbacks {
    Callbacks {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: std::ptr::from_ref(messages).cast_mut().cast(),
    }
}

/// An instance of the FMU.
pub struct Instance {
    pub component: Component,
    /// Boxed, because the library holds their addresses.
    messages: Box<Messages>,
    _callbacks: Box<Callbacks>,
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: not used afterwards.
        unsafe { (FMU.functions.free_instance)(self.component) }
    }
}

/// Returns the value reference of a variable.
pub fn reference(name: &str) -> Reference {
    FMU.description.variable(name).reference
}

/// Calls a function of the interface on an instance.
macro_rules! call {
    ($instance:expr, $function:ident $(, $argument:expr)*) => {{
        let instance: &$crate::host::Instance = &$instance;
        // SAFETY: a live instance, used by this thread only; arrays are as long as their counts, or deliberately NULL.
        unsafe { ($crate::host::FMU.functions.$function)(instance.component $(, $argument)*) }
    }};
}
pub(crate) use call;

impl Instance {
    /// Makes an instance that logs only warnings and errors.
    pub fn new(name: &str) -> Instance {
        Instance::at(name, None, false)
    }

    /// Makes an instance with a resource location; logs all categories if `logging`.
    pub fn at(name: &str, location: Option<&str>, logging: bool) -> Instance {
        Instance::of(CO_SIMULATION, name, location, logging)
    }

    /// Makes an instance of an interface type, with the block of the paper's figures.
    pub fn of(interface: c_int, name: &str, location: Option<&str>, logging: bool) -> Instance {
        let instance = Instance::with_start_values(interface, name, location, logging);
        instance.set_paper_block();
        instance
    }

    /// Sets the block of the paper's figures, as after a reset.
    #[track_caller]
    pub fn set_paper_block(&self) {
        self.set("dimensionless.alpha", 0.25);
        self.set("dimensionless.p", 1.0);
    }

    /// Makes an instance of an interface type, with the start values.
    pub fn with_start_values(interface: c_int, name: &str, location: Option<&str>, logging: bool) -> Instance {
        let messages = Box::new(Messages::default());
        let callbacks = Box::new(callbacks(&messages));
        let name = CString::new(name).unwrap();
        let guid = CString::new(FMU.description.guid.as_str()).unwrap();
        let location = location.map(|text| CString::new(text).unwrap());
        let location = location.as_ref().map_or(null(), |text| text.as_ptr());
        // SAFETY: all texts end with 0, the callbacks live as long as the instance.
        let component = unsafe {
            let instantiate = FMU.functions.instantiate;
            instantiate(name.as_ptr(), interface, guid.as_ptr(), location, &*callbacks, 0, logging.into())
        };
        assert!(!component.is_null(), "{:?}", messages.lock().unwrap());
        Instance { component, messages, _callbacks: callbacks }
    }

    /// Returns the messages since the last call.
    pub fn messages(&self) -> Vec<Message> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    /// Expects a refusal with one message that contains all these words.
    #[track_caller]
    pub fn refuses(&self, status: Status, words: &[&str]) {
        let messages = self.messages();
        assert_eq!(status, ERROR, "{messages:?}");
        assert_eq!(messages.len(), 1, "{messages:?}");
        let Message { status, category, text, .. } = &messages[0];
        assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"), "{text}");
        for word in words {
            assert!(text.contains(word), "{text:?} should hold {word:?}");
        }
    }

    /// Sets a variable of any type.
    pub fn try_set(&self, name: &str, value: f64) -> Status {
        let variable = FMU.description.variable(name);
        let reference = &variable.reference;
        match variable.kind.as_str() {
            "Real" => call!(self, set_real, reference, 1, &value),
            "Boolean" => call!(self, set_boolean, reference, 1, &c_int::from(value != 0.0)),
            _ => call!(self, set_integer, reference, 1, &(value as c_int)),
        }
    }

    /// Sets a text.
    pub fn try_set_text(&self, name: &str, text: &str) -> Status {
        let text = CString::new(text).unwrap();
        call!(self, set_string, &reference(name), 1, &text.as_ptr())
    }

    /// Sets a text and expects success.
    #[track_caller]
    pub fn set_text(&self, name: &str, text: &str) {
        assert_eq!(self.try_set_text(name, text), OK, "{name} = {text}: {:?}", self.messages());
    }

    /// Reads a text and expects success.
    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        let mut text = null();
        assert_eq!(call!(self, get_string, &reference(name), 1, &mut text), OK, "{:?}", self.messages());
        // SAFETY: a text that ends with 0 and lasts until the next call (standard, 2.1.7).
        unsafe { CStr::from_ptr(text) }.to_str().expect("texts are UTF-8").to_string()
    }

    /// Sets a variable of any type and expects success.
    #[track_caller]
    pub fn set(&self, name: &str, value: f64) {
        assert_eq!(self.try_set(name, value), OK, "{name} = {value}: {:?}", self.messages());
    }

    /// Sets the rate of an input.
    #[track_caller]
    pub fn set_rate(&self, name: &str, rate: f64) {
        let status = call!(self, set_real_input_derivatives, &reference(name), 1, &1, &rate);
        assert_eq!(status, OK, "{:?}", self.messages());
    }

    /// Reads a variable of any type except a text.
    pub fn try_get(&self, name: &str) -> Result<f64, Status> {
        let variable = FMU.description.variable(name);
        let (mut real, mut integer) = (f64::NAN, c_int::MIN);
        let status = match variable.kind.as_str() {
            "Real" => call!(self, get_real, &variable.reference, 1, &mut real),
            "Boolean" => call!(self, get_boolean, &variable.reference, 1, &mut integer),
            _ => call!(self, get_integer, &variable.reference, 1, &mut integer),
        };
        let value = if variable.kind == "Real" { real } else { f64::from(integer) };
        if status == OK { Ok(value) } else { Err(status) }
    }

    /// Reads a variable of any type and expects success.
    #[track_caller]
    pub fn get(&self, name: &str) -> f64 {
        self.try_get(name).unwrap_or_else(|status| panic!("{name}: {status}, {:?}", self.messages()))
    }

    /// Returns the bits of all variables except texts.
    #[track_caller]
    pub fn bits(&self) -> Vec<u64> {
        let numbers = FMU.description.variables.iter().filter(|variable| variable.kind != "String");
        numbers.map(|variable| self.get(&variable.name).to_bits()).collect()
    }

    /// Returns the bits of all outputs.
    #[track_caller]
    pub fn output_bits(&self) -> Vec<u64> {
        FMU.description.outputs().map(|variable| self.get(&variable.name).to_bits()).collect()
    }

    pub fn setup(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        let (tolerance_defined, stop_defined) = (tolerance.is_some().into(), stop.is_some().into());
        let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop.unwrap_or(0.0));
        call!(self, setup_experiment, tolerance_defined, tolerance, start, stop_defined, stop)
    }

    /// Initializes the instance at t = 0.
    #[track_caller]
    pub fn initialize(&self, tolerance: Option<f64>) {
        assert_eq!(self.setup(tolerance, 0.0, None), OK, "{:?}", self.messages());
        assert_eq!(call!(self, enter_initialization_mode), OK, "{:?}", self.messages());
        assert_eq!(call!(self, exit_initialization_mode), OK, "{:?}", self.messages());
    }

    pub fn try_step(&self, time: f64, step: f64) -> Status {
        call!(self, do_step, time, step, 1)
    }

    /// Takes a step, which must succeed.
    #[track_caller]
    pub fn step(&self, time: f64, step: f64) {
        assert_eq!(self.try_step(time, step), OK, "{:?}", self.messages());
    }

    /// Takes steps of one length to a time that is a multiple of it.
    #[track_caller]
    pub fn go(&self, from: f64, to: f64, step: f64) {
        let last = (to / step).round() as u64;
        for i in (from / step).round() as u64..last {
            let (here, there) = (i as f64 * step, (i + 1) as f64 * step);
            self.step(here, there - here);
        }
    }

    pub fn real_status(&self, kind: StatusKind) -> Result<f64, Status> {
        let mut value = f64::NAN;
        let status = call!(self, get_real_status, kind, &mut value);
        if status == OK { Ok(value) } else { Err(status) }
    }

    pub fn boolean_status(&self, kind: StatusKind) -> Result<bool, Status> {
        let mut value = -1;
        let status = call!(self, get_boolean_status, kind, &mut value);
        if status == OK { Ok(value != 0) } else { Err(status) }
    }

    /// Saves the state, to be freed by `free`.
    #[track_caller]
    pub fn save(&self) -> SavedState {
        let mut state = null_mut();
        assert_eq!(call!(self, get_fmu_state, &mut state), OK);
        assert!(!state.is_null());
        state
    }

    #[track_caller]
    pub fn restore(&self, state: SavedState) {
        assert_eq!(call!(self, set_fmu_state, state), OK, "{:?}", self.messages());
    }

    #[track_caller]
    pub fn free(&self, mut state: SavedState) {
        assert_eq!(call!(self, free_fmu_state, &mut state), OK);
        assert!(state.is_null(), "the standard, 2.1.8: the pointer is set to NULL");
    }

    /// Returns a saved state as bytes.
    #[track_caller]
    pub fn serialize(&self, state: SavedState) -> Vec<c_char> {
        let mut size = 0;
        assert_eq!(call!(self, serialized_size, state, &mut size), OK);
        let mut bytes = vec![0; size];
        assert_eq!(call!(self, serialize, state, bytes.as_mut_ptr(), size), OK);
        bytes
    }
}
