//! A small importer: unpacks the FMU, loads its library, and wraps an instance.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString};
use std::io::Read;
use std::mem::ManuallyDrop;
use std::ptr::{null, null_mut};
use std::rc::Rc;
use std::sync::{LazyLock, Mutex};

use roxmltree::Document;

use crate::functions::*;
use crate::unit;

/// A variable of modelDescription.xml.
#[derive(Clone, Debug)]
pub struct Variable {
    pub reference: u32,
    /// `Float64`, `Int32`, …
    pub kind: String,
    pub causality: String,
    pub attributes: BTreeMap<String, String>,
    pub is_array: bool,
}

/// The unpacked FMU.
pub struct Fmu {
    pub functions: Functions,
    pub files: BTreeMap<String, Vec<u8>>,
    pub token: CString,
    pub variables: BTreeMap<String, Variable>,
}

/// The FMU that the build packed; its library is loaded once and stays.
pub static FMU: LazyLock<Fmu> = LazyLock::new(|| {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(unit::PATH).unwrap()).unwrap();
    let mut files = BTreeMap::new();
    for place in 0..archive.len() {
        let mut entry = archive.by_index(place).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        files.insert(entry.name().unwrap().into_owned(), bytes);
    }
    let text = std::str::from_utf8(&files["modelDescription.xml"]).unwrap();
    let document = Document::parse(text).unwrap();
    let root = document.root_element();
    let list = root.children().find(|node| node.has_tag_name("ModelVariables")).unwrap();
    let variable = |node: roxmltree::Node| {
        let attributes: BTreeMap<String, String> =
            node.attributes().map(|a| (a.name().to_string(), a.value().to_string())).collect();
        let variable = Variable {
            reference: attributes["valueReference"].parse().unwrap(),
            kind: node.tag_name().name().to_string(),
            causality: attributes["causality"].clone(),
            attributes: attributes.clone(),
            is_array: node.children().any(|child| child.has_tag_name("Dimension")),
        };
        (attributes["name"].clone(), variable)
    };
    let variables = list.children().filter(|node| node.is_element()).map(variable).collect();
    let token = CString::new(root.attribute("instantiationToken").unwrap()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rocking_block.so");
    std::fs::write(&path, &files[unit::BINARY]).unwrap();
    // SAFETY: the library has no initialization of its own.
    let library = unsafe { libloading::Library::new(&path) }.unwrap();
    let functions = Functions::load(&library);
    // Not unloaded: the function pointers outlive this closure.
    std::mem::forget(library);
    Fmu { functions, files, token, variables }
});

/// Returns the value reference of a variable.
pub fn reference(name: &str) -> u32 {
    FMU.variables.get(unit::name(name)).unwrap_or_else(|| panic!("there is no variable {name}")).reference
}

/// The importer's reaction to an intermediate update.
pub type OnUpdate = Box<dyn FnMut(&Instance, Update) -> Option<f64>>;

/// An intermediate update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    pub time: f64,
    pub set_requested: bool,
    pub get_allowed: bool,
    pub step_finished: bool,
    pub can_return_early: bool,
}

/// The environment of the callbacks.
pub struct Environment {
    pub messages: Mutex<Vec<(Status, String, String)>>,
    handle: Mutex<Handle>,
    on_update: Mutex<Option<OnUpdate>>,
}

impl Default for Environment {
    fn default() -> Environment {
        Environment { messages: Mutex::default(), handle: Mutex::new(null_mut()), on_update: Mutex::new(None) }
    }
}

pub unsafe extern "C" fn logger(environment: Handle, status: Status, category: Text, message: Text) {
    // SAFETY: the environment is that of the instance, and texts end with 0 (standard, 2.3.1).
    let (environment, [category, message]) = unsafe {
        let text = |text| CStr::from_ptr(text).to_str().expect("messages are UTF-8").to_string();
        (&*environment.cast::<Environment>(), [category, message].map(text))
    };
    environment.messages.lock().unwrap().push((status, category, message));
}

unsafe extern "C" fn update(
    environment: Handle,
    time: f64,
    set_requested: bool,
    get_allowed: bool,
    step_finished: bool,
    can_return_early: bool,
    early_return_requested: *mut bool,
    early_return_time: *mut f64,
) {
    // SAFETY: the environment belongs to the instance, and lives as long.
    let environment = unsafe { &*environment.cast::<Environment>() };
    let update = Update { time, set_requested, get_allowed, step_finished, can_return_early };
    let handle = *environment.handle.lock().unwrap();
    // SAFETY: the environment is in an `Rc` whose count does not change here: neither it nor the instance is dropped.
    let shared = unsafe { Rc::from_raw(std::ptr::from_ref(environment)) };
    let instance = ManuallyDrop::new(Instance { handle, environment: shared });
    let mut on_update = environment.on_update.lock().unwrap();
    if let Some(time) = on_update.as_mut().and_then(|on_update| on_update(&instance, update)) {
        // SAFETY: places for the answers (standard, 4.2.2).
        unsafe {
            *early_return_requested = true;
            *early_return_time = time;
        }
    }
}

/// Options of an instance.
#[derive(Default)]
pub struct Wanted<'a> {
    /// Whether events and steps are logged, too.
    pub logging: bool,
    pub event_mode: bool,
    pub early_return: bool,
    pub intermediate: &'a [&'a str],
    pub on_update: Option<OnUpdate>,
}

/// An instance of the FMU.
pub struct Instance {
    pub handle: Handle,
    environment: Rc<Environment>,
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: not used afterwards.
        unsafe { (FMU.functions.free_instance)(self.handle) }
    }
}

/// Calls a function of the interface on an instance.
macro_rules! call {
    ($instance:expr, $function:ident $(, $argument:expr)*) => {{
        let instance: &$crate::host::Instance = &$instance;
        // SAFETY: a live instance, used by this thread only; arrays are as long as their counts, or deliberately NULL.
        unsafe { ($crate::host::FMU.functions.$function)(instance.handle $(, $argument)*) }
    }};
}
pub(crate) use call;

/// Result of `fmi3DoStep`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    pub event: bool,
    pub terminates: bool,
    pub early: bool,
    pub reached: f64,
}

impl Instance {
    /// Makes an instance for Model Exchange, with the block of the paper's figures.
    pub fn exchanged() -> Instance {
        let environment = Rc::<Environment>::default();
        // SAFETY: texts end with 0, and the environment lives as long as the instance.
        let handle = unsafe {
            (FMU.functions.instantiate_model_exchange)(
                c"block".as_ptr(),
                FMU.token.as_ptr(),
                null(),
                false,
                true,
                Rc::as_ptr(&environment).cast_mut().cast(),
                Some(logger),
            )
        };
        assert!(!handle.is_null(), "{:?}", environment.messages.lock().unwrap());
        let instance = Instance { handle, environment }.without_log_lines();
        instance.set_paper_block();
        instance
    }

    /// Sets the block of the paper's figures, as after a reset.
    #[track_caller]
    pub fn set_paper_block(&self) {
        self.ok(self.try_set("dimensionless.alpha", 0.25));
        self.ok(self.try_set("dimensionless.p", 1.0));
    }

    /// Logs only messages of refused calls.
    fn without_log_lines(self) -> Instance {
        let lines = [c"logEvents".as_ptr(), c"logSteps".as_ptr()];
        self.ok(call!(self, set_debug_logging, false, lines.len(), lines.as_ptr()));
        self
    }

    /// Makes an instance with the block of the paper's figures.
    pub fn new(wanted: Wanted) -> Instance {
        let instance = Instance::with_start_values(wanted);
        instance.set_paper_block();
        instance
    }

    /// Makes an instance with the start values.
    pub fn with_start_values(wanted: Wanted) -> Instance {
        let Wanted { logging, event_mode, early_return, intermediate, on_update } = wanted;
        let has_update = on_update.is_some();
        let environment = Rc::<Environment>::default();
        *environment.on_update.lock().unwrap() = on_update;
        let required: Vec<u32> = intermediate.iter().map(|name| reference(name)).collect();
        // SAFETY: texts end with 0, and the environment lives as long as the instance.
        let handle = unsafe {
            (FMU.functions.instantiate_co_simulation)(
                c"block".as_ptr(),
                FMU.token.as_ptr(),
                null(),
                false,
                true,
                event_mode,
                early_return,
                required.as_ptr(),
                required.len(),
                Rc::as_ptr(&environment).cast_mut().cast(),
                Some(logger),
                has_update.then_some(update as crate::functions::Update),
            )
        };
        assert!(!handle.is_null(), "{:?}", environment.messages.lock().unwrap());
        *environment.handle.lock().unwrap() = handle;
        let instance = Instance { handle, environment };
        if logging { instance } else { instance.without_log_lines() }
    }

    /// Returns the messages since the last call: status, category, message.
    pub fn messages(&self) -> Vec<(Status, String, String)> {
        std::mem::take(&mut self.environment.messages.lock().unwrap())
    }

    /// Expects a refusal with one message that contains all these words.
    #[track_caller]
    pub fn refuses(&self, status: Status, words: &[&str]) {
        let messages = self.messages();
        assert_eq!(status, ERROR, "{messages:?}");
        let [(status, category, text)] = messages.as_slice() else { panic!("one message, not {messages:?}") };
        assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"), "{text}");
        words.iter().for_each(|word| assert!(text.contains(word), "{text:?} should hold {word:?}"));
    }

    #[track_caller]
    pub fn ok(&self, status: Status) {
        assert_eq!(status, OK, "{:?}", self.messages());
    }

    /// Sets a scalar of any type except a text.
    pub fn try_set(&self, name: &str, value: f64) -> Status {
        let variable = &FMU.variables[unit::name(name)];
        let vr = &variable.reference;
        match variable.kind.as_str() {
            "Float64" => call!(self, set_float64, vr, 1, &value, 1),
            "Boolean" => call!(self, set_boolean, vr, 1, &(value != 0.0), 1),
            "Int32" => call!(self, set_int32, vr, 1, &(value as i32), 1),
            "UInt64" => call!(self, set_uint64, vr, 1, &(value as u64), 1),
            "Enumeration" => call!(self, set_int64, vr, 1, &(value as i64), 1),
            other => panic!("{name} is of type {other}"),
        }
    }

    #[track_caller]
    pub fn set(&self, name: &str, value: f64) {
        self.ok(self.try_set(name, value));
    }

    #[track_caller]
    pub fn set_all(&self, values: &[(&str, f64)]) {
        values.iter().for_each(|(name, value)| self.set(name, *value));
    }

    /// Reads a scalar of any type except a text.
    pub fn try_get(&self, name: &str) -> Result<f64, Status> {
        let variable = &FMU.variables[unit::name(name)];
        let vr = &variable.reference;
        let (mut float, mut boolean, mut int32, mut int64, mut size) = (f64::NAN, false, 0, 0, 0);
        let (status, value) = match variable.kind.as_str() {
            "Float64" => (call!(self, get_float64, vr, 1, &mut float, 1), float),
            "Boolean" => (call!(self, get_boolean, vr, 1, &mut boolean, 1), f64::from(u8::from(boolean))),
            "Int32" => (call!(self, get_int32, vr, 1, &mut int32, 1), f64::from(int32)),
            "UInt64" => (call!(self, get_uint64, vr, 1, &mut size, 1), size as f64),
            "Enumeration" => (call!(self, get_int64, vr, 1, &mut int64, 1), int64 as f64),
            other => panic!("{name} is of type {other}"),
        };
        if status == OK { Ok(value) } else { Err(status) }
    }

    #[track_caller]
    pub fn get(&self, name: &str) -> f64 {
        self.try_get(name).unwrap_or_else(|status| panic!("{name}: {status}, {:?}", self.messages()))
    }

    /// Returns the bits of all outputs.
    #[track_caller]
    pub fn output_bits(&self) -> Vec<u64> {
        let outputs = FMU.variables.iter().filter(|(_, v)| v.causality == "output" && !v.is_array);
        outputs.map(|(name, _)| self.get(name).to_bits()).collect()
    }

    /// Initializes the instance at t = 0.
    #[track_caller]
    pub fn initialize(&self, event_mode: bool) {
        self.ok(call!(self, enter_initialization_mode, false, 0.0, 0.0, false, 0.0));
        self.ok(call!(self, exit_initialization_mode));
        if event_mode {
            self.handle_event();
        }
    }

    /// Handles an event and enters Step Mode.
    #[track_caller]
    pub fn handle_event(&self) {
        let [mut more, mut terminates, mut nominals, mut values, mut defined] = [true; 5];
        let mut next = f64::NAN;
        self.ok(call!(
            self,
            update_discrete_states,
            &mut more,
            &mut terminates,
            &mut nominals,
            &mut values,
            &mut defined,
            &mut next
        ));
        assert_eq!([more, terminates, nominals, values, defined], [false; 5]);
        self.ok(call!(self, enter_step_mode));
    }

    pub fn try_step(&self, time: f64, size: f64) -> (Status, Stepped) {
        let [mut event, mut terminates, mut early] = [false; 3];
        let mut reached = f64::NAN;
        let status = call!(self, do_step, time, size, true, &mut event, &mut terminates, &mut early, &mut reached);
        (status, Stepped { event, terminates, early, reached })
    }

    #[track_caller]
    pub fn step(&self, time: f64, size: f64) -> Stepped {
        let (status, stepped) = self.try_step(time, size);
        self.ok(status);
        stepped
    }

    /// Takes a communication step that stops at events, and returns their times.
    #[track_caller]
    pub fn step_by_events(&self, time: f64, end: f64, event_mode: bool) -> Vec<f64> {
        let (mut here, mut events) = (time, Vec::new());
        while here < end {
            let stepped = self.step(here, end - here);
            assert!(stepped.reached > here && stepped.early == (stepped.reached < end), "{stepped:?}");
            here = stepped.reached;
            if stepped.early || stepped.event {
                events.push(here);
            }
            if stepped.event {
                assert!(event_mode);
                self.ok(call!(self, enter_event_mode));
                self.handle_event();
            }
        }
        events
    }
}
