//! Logged messages, and their choice by category.

use std::ffi::CString;

use crate::functions::*;
use crate::host::{FMU, Instance, Message, call};

/// Calls `fmi2SetDebugLogging` with these categories.
pub fn choose(instance: &Instance, logging: bool, categories: &[&str]) -> Status {
    let texts: Vec<CString> = categories.iter().map(|name| CString::new(*name).unwrap()).collect();
    let pointers: Vec<Text> = texts.iter().map(|text| text.as_ptr()).collect();
    call!(instance, set_debug_logging, logging.into(), pointers.len(), pointers.as_ptr())
}

/// Returns the messages of ten seconds of rocking in 100 steps.
pub fn rock(instance: &Instance) -> Vec<Message> {
    instance.set("initial.theta", 0.1);
    instance.initialize(None);
    assert_eq!(instance.messages(), []);
    instance.go(0.0, 10.0, 0.1);
    instance.messages()
}

fn by_category(messages: &[Message], category: &str) -> usize {
    messages.iter().filter(|message| message.category == category).count()
}

#[test]
fn without_logging_a_run_is_silent() {
    assert_eq!(rock(&Instance::at("quiet", None, false)), []);
    let turned_off = Instance::at("quiet", None, true);
    assert_eq!(choose(&turned_off, false, &[]), OK);
    assert_eq!(rock(&turned_off), []);
}

#[test]
fn events_are_one_line_each_with_their_times() {
    let instance = Instance::at("block", None, true);
    assert_eq!(choose(&instance, true, &["logEvents"]), OK);
    let messages = rock(&instance);
    assert!(messages.iter().all(|m| m.status == OK && m.category == "logEvents" && m.format == m.text));
    assert!(messages.iter().all(|m| m.instance == "block" && !m.text.contains('\n')));
    let time = |text: &str| text.strip_prefix("t = ")?.split_once(" s: ")?.0.parse::<f64>().ok();
    let times: Vec<f64> = messages.iter().map(|message| time(&message.text).expect("a line with a time")).collect();
    assert!(times.len() > 5 && times.is_sorted());
    let landings = messages.iter().filter(|message| message.text.contains("landing on")).count();
    assert_eq!(landings as f64, instance.get("events.impacts"));
    assert!((times[times.len() - 1] - instance.get("events.last_time")).abs() <= 1e-9, "times are logged to 1e-9 s");
}

#[test]
fn categories_are_chosen_by_name() {
    let count = |logging: bool, categories: &[&str]| {
        let instance = Instance::at("block", None, true);
        assert_eq!(choose(&instance, logging, categories), OK);
        let messages = rock(&instance);
        assert_eq!(instance.try_step(0.0, 1.0), ERROR);
        let errors = instance.messages();
        assert!(errors.iter().all(|message| message.category == "logStatusError"));
        (by_category(&messages, "logEvents") > 5, by_category(&messages, "logSteps"), errors.len())
    };
    assert_eq!(count(true, &["logEvents"]), (true, 0, 0));
    assert_eq!(count(true, &["logSteps"]), (false, 100, 0));
    assert_eq!(count(true, &["logStatusError"]), (false, 0, 1));
    assert_eq!(count(true, &["logStatusError", "logSteps"]), (false, 100, 1));
    assert_eq!(count(true, &["logEvents", "logSteps"]), (true, 100, 0));
    assert_eq!(count(true, &[]), (true, 100, 1), "the standard, 2.1.5: no category is all of them");
    assert_eq!(count(false, &[]), (false, 0, 1), "errors are logged without logging, too");
}

/// The categories of the description exist, and no others.
#[test]
fn categories_are_those_of_the_description() {
    let categories = &FMU.description.log_categories;
    assert_eq!(categories.len(), 6);
    let instance = Instance::new("block");
    for category in categories {
        assert_eq!(choose(&instance, true, &[category]), OK, "{category}");
    }
    assert_eq!(choose(&instance, true, &["logStatusError"]), OK);
    for unknown in ["logAll", "LOGEVENTS", "", "logEvents "] {
        instance.refuses(choose(&instance, true, &["logSteps", unknown]), &["fmi2SetDebugLogging", "does not exist"]);
    }
    // The refused call has changed nothing.
    assert_eq!(rock(&instance), []);
}
