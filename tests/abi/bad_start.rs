//! Refused instantiations and initializations.

use std::ffi::{CString, c_int};
use std::ptr::null;

use crate::functions::*;
use crate::host::{FMU, Instance, Message, Messages, call, callbacks};

/// Requested name, type and GUID.
type Request<'a> = (Option<&'a str>, c_int, Option<&'a str>);

/// Tolerance, start and stop.
type Experiment = (Option<f64>, f64, Option<f64>);

/// Message of `fmi2Instantiate`, and whether it returned an instance.
fn instantiate(name: Option<&str>, kind: c_int, guid: Option<&str>) -> (bool, Vec<Message>) {
    let messages = Messages::default();
    let callbacks = callbacks(&messages);
    let [name, guid] = [name, guid].map(|text| text.map(|text| CString::new(text).unwrap()));
    let [name_pointer, guid_pointer] = [&name, &guid].map(|text| text.as_ref().map_or(null(), |text| text.as_ptr()));
    // SAFETY: texts end with 0 or are NULL, the callbacks outlive the instance.
    let given = unsafe {
        let component = (FMU.functions.instantiate)(name_pointer, kind, guid_pointer, null(), &callbacks, 0, 1);
        (FMU.functions.free_instance)(component);
        !component.is_null()
    };
    (given, messages.into_inner().unwrap())
}

#[test]
fn wrong_names_guids_and_types_are_refused_and_the_reason_is_logged() {
    let guid = FMU.description.guid.as_str();
    let wrong = "{00000000-0000-0000-0000-000000000000}";
    let cases: [(Request, &[&str]); 9] = [
        ((Some("block"), CO_SIMULATION, None), &["fmuGUID", guid]),
        ((Some("block"), CO_SIMULATION, Some(wrong)), &["fmuGUID", wrong, guid]),
        ((Some("block"), CO_SIMULATION, Some("")), &["fmuGUID", guid]),
        ((None, CO_SIMULATION, Some(guid)), &["instanceName"]),
        ((Some(""), CO_SIMULATION, Some(guid)), &["instanceName"]),
        ((Some(" \t"), CO_SIMULATION, Some(guid)), &["instanceName"]),
        ((Some("block"), 2, Some(guid)), &["fmuType = 2", "0", "1"]),
        ((Some("block"), 7, Some(guid)), &["fmuType = 7", "1"]),
        ((Some("block"), -1, Some(guid)), &["fmuType = -1", "1"]),
    ];
    for ((name, kind, guid), words) in cases {
        let (given, messages) = instantiate(name, kind, guid);
        assert!(!given, "{name:?} {kind} {guid:?}");
        let [Message { status: ERROR, category, text, .. }] = messages.as_slice() else { panic!("{messages:?}") };
        assert_eq!(category, "logStatusError");
        assert!(words.iter().all(|word| text.contains(word)), "{text:?} should hold {words:?}");
    }
    for kind in [CO_SIMULATION, MODEL_EXCHANGE] {
        assert_eq!(instantiate(Some("block"), kind, Some(guid)), (true, vec![]));
    }
}

#[test]
fn instantiation_without_callbacks_or_logger() {
    let guid = CString::new(FMU.description.guid.as_str()).unwrap();
    let mut callbacks = callbacks(&Messages::default());
    callbacks.logger = None;
    let instantiate = FMU.functions.instantiate;
    // SAFETY: texts end with 0; the test is about NULL callbacks; the others outlive the instance.
    unsafe {
        assert!(instantiate(c"block".as_ptr(), CO_SIMULATION, guid.as_ptr(), null(), null(), 0, 1).is_null());
        assert!(instantiate(c"block".as_ptr(), CO_SIMULATION, c"wrong".as_ptr(), null(), &callbacks, 0, 1).is_null());
        let silent = instantiate(c"block".as_ptr(), CO_SIMULATION, guid.as_ptr(), null(), &callbacks, 0, 1);
        assert!(!silent.is_null());
        assert_eq!((FMU.functions.do_step)(silent, 0.0, 0.1, 1), ERROR);
        (FMU.functions.free_instance)(silent);
    }
}

/// The resource location is not used.
#[test]
fn any_resource_location_does() {
    let odd = ["", "file:/", "file:///", "file:///a b/%20%s%n", "no such place", "http://localhost/x"];
    for location in odd.map(Some).into_iter().chain([None]) {
        let instance = Instance::at("block", location, true);
        instance.initialize(None);
        instance.step(0.0, 0.1);
    }
}

#[test]
fn invalid_geometry_is_refused_until_it_is_corrected() {
    let fine: [(&str, f64); 3] = [("physical.width", 2.0), ("physical.height", 8.0), ("physical.K", 1e6)];
    for (name, value) in fine {
        let instance = Instance::with_start_values(CO_SIMULATION, "block", None, false);
        instance.set("parameterization", 2.0);
        SIZES.iter().for_each(|&(size, value)| instance.set(size, value));
        instance.set(name, 0.0);
        assert_eq!(instance.setup(None, 0.0, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        let word = name.trim_start_matches("physical.");
        instance.refuses(call!(instance, exit_initialization_mode), &["fmi2ExitInitializationMode", word, "0"]);
        instance.refuses(instance.try_step(0.0, 0.1), &["fmi2DoStep", "initializationMode"]);
        instance.set(name, value);
        assert_eq!(call!(instance, exit_initialization_mode), OK, "{:?}", instance.messages());
        instance.step(0.0, 0.1);
    }
}

/// Each parameter is within its limits, but the block made from them overflows.
#[test]
fn parameters_whose_product_overflows_are_refused() {
    let instance = Instance::new("block");
    instance.set("parameterization", 2.0);
    instance.set("physical.K", 1e-300);
    instance.set("mass", 1e12);
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    instance.refuses(call!(instance, exit_initialization_mode), &["fmi2ExitInitializationMode"]);
}

/// A parameter that is not read is reported with the setting that it needs, never silently ignored.
#[test]
fn unused_parameters_cause_a_warning() {
    let cases = [
        ("parameterization", 1.0, "physical.width", 1.25, "parameterization = Physical"),
        ("parameterization", 2.0, "dimensionless.alpha", 1.25, "parameterization = Dimensionless"),
        ("pulse.shape", 1.0, "pulse.amplitude", 5.0, "a pulse.shape"),
        ("pulse.shape", 1.0, "pulse.period", 0.5, "a pulse.shape"),
        ("pulse.shape", 1.0, "pulse.start", 1.0, "a pulse.shape"),
        ("foundation", 2.0, "initial.v", 0.1, "foundation = Viscoelastic"),
        ("initial.settled", 1.0, "initial.v_dot", 0.1, "initial.settled = false"),
        ("parameterization", 1.0, "physical.inertia", 100.0, "parameterization = Physical"),
        ("tie_2.stiffness", 0.0, "tie_2.strength", 100.0, "tie_2.stiffness"),
    ];
    for (other, value, name, unread, needed) in cases {
        let instance = Instance::with_start_values(CO_SIMULATION, "block", None, false);
        instance.set(other, value);
        instance.set(name, unread);
        for size in if other == "parameterization" && value == 2.0 { &SIZES[..] } else { &[] } {
            instance.set(size.0, size.1);
        }
        assert_eq!(instance.setup(None, 0.0, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        assert_eq!(call!(instance, exit_initialization_mode), WARNING);
        let messages = instance.messages();
        let [Message { status: WARNING, category, text, .. }] = messages.as_slice() else { panic!("{messages:?}") };
        assert!(category == "logStatusWarning" && text.ends_with(&format!(": {name} needs {needed}")), "{text}");
        instance.step(0.0, 0.1);
    }
}

/// Sizes of a block; none of them is a start value.
const SIZES: [(&str, f64); 4] =
    [("physical.width", 0.6), ("physical.height", 2.0), ("physical.K", 4e5), ("physical.C", 3e3)];

/// A block given by its sizes never gets default supports without a warning.
#[test]
fn missing_sizes_cause_a_warning() {
    let warned = |foundation: f64, sizes: &[(&str, f64)]| {
        let instance = Instance::with_start_values(CO_SIMULATION, "block", None, false);
        instance.set("parameterization", 2.0);
        instance.set("foundation", foundation);
        sizes.iter().for_each(|&(name, value)| instance.set(name, value));
        assert_eq!(instance.setup(None, 0.0, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        let status = call!(instance, exit_initialization_mode);
        let messages = instance.messages();
        instance.step(0.0, 0.1);
        match messages.as_slice() {
            [] => {
                assert_eq!(status, OK);
                String::new()
            }
            [Message { status: WARNING, category, text, .. }] => {
                assert_eq!((status, category.as_str()), (WARNING, "logStatusWarning"));
                text.rsplit(": ").next().unwrap_or_default().to_string()
            }
            _ => panic!("{messages:?}"),
        }
    };
    assert_eq!(warned(1.0, &SIZES[..2]), "physical.K = 6050000, physical.C = 11000");
    assert_eq!(warned(1.0, &SIZES[..3]), "physical.C = 11000");
    assert_eq!(warned(1.0, &SIZES), "");
    assert_eq!(warned(2.0, &SIZES[..2]), "");
    assert_eq!(warned(2.0, &SIZES[..1]), "physical.height = 1.914348421735829");
}

#[test]
fn an_invalid_experiment_is_refused_and_the_previous_one_stays() {
    let bad: [(Experiment, &[&str]); 8] = [
        ((None, f64::NAN, None), &["startTime", "NaN"]),
        ((None, f64::INFINITY, None), &["startTime", "inf"]),
        ((None, 1.0, Some(1.0)), &["stopTime = 1", "startTime = 1"]),
        ((None, 1.0, Some(0.5)), &["stopTime = 0.5", "startTime = 1"]),
        ((None, 0.0, Some(f64::NAN)), &["stopTime", "NaN"]),
        ((Some(0.0), 0.0, None), &["tolerance = 0"]),
        ((Some(-1e-6), 0.0, None), &["tolerance", "-1e-6"]),
        ((Some(f64::NAN), 0.0, None), &["tolerance", "NaN"]),
    ];
    let instance = Instance::new("block");
    assert_eq!(instance.setup(None, 3.0, Some(4.0)), OK);
    for ((tolerance, start, stop), words) in bad {
        instance.refuses(instance.setup(tolerance, start, stop), words);
    }
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    instance.refuses(instance.try_step(0.0, 0.5), &["t = 3"]);
    instance.step(3.0, 1.0);
    instance.refuses(instance.try_step(4.0, 0.5), &["4.5", "stopTime = 4"]);
}

/// The instance's name is passed back unchanged. Messages are formats without arguments, so that a logger shows them with `printf` and
/// one that cannot read variadic arguments does, too.
#[test]
fn percent_signs_arrive_verbatim() {
    let name = "100%s%n%d {0} \u{e4}";
    let instance = Instance::at(name, None, true);
    instance.refuses(instance.try_step(0.0, 0.1), &["fmi2DoStep"]);
    let category = c"%s%n%1$s".as_ptr();
    let status = call!(instance, set_debug_logging, 1, 1, &category);
    let messages = instance.messages();
    assert_eq!(status, ERROR);
    let [Message { instance, format, text, .. }] = messages.as_slice() else { panic!("{messages:?}") };
    assert_eq!(instance, name);
    assert!(text.contains("\"%s%n%1$s\""), "{text}");
    assert!(format.contains("\"%%s%%n%%1$s\""), "{format}");
}
