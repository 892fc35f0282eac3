//! Every function on an instance for Model Exchange, against the table of the standard (2.0.5, 3.2.3).

use crate::functions::*;
use crate::host::{Instance, call};
use crate::life_cycle::{TABLE, all_of};
use crate::unit::IMPOSSIBLE;

/// The states of an instance for Model Exchange, by their names in the standard.
const EXCHANGED: [&str; 6] =
    ["instantiated", "initializationMode", "eventMode", "continuousTimeMode", "terminated", "error"];

/// The functions of Model Exchange, with the states in which they are legal by the table of 3.2.3 (2.0.5).
///
/// Each state has a letter, in the order of [`EXCHANGED`]; X is the error.
const OF_EXCHANGE: [(&str, &str); 31] = [
    ("fmi2SetDebugLogging", "IMECTX"),
    ("fmi2SetupExperiment", "I"),
    ("fmi2EnterInitializationMode", "I"),
    ("fmi2ExitInitializationMode", "M"),
    ("fmi2Terminate", "EC"),
    ("fmi2Reset", "IMECTX"),
    ("fmi2GetReal", "MECTX"),
    ("fmi2GetInteger", "MECTX"),
    ("fmi2GetBoolean", "MECTX"),
    ("fmi2GetString", "MECTX"),
    ("fmi2SetReal", "IMEC"),
    ("fmi2SetInteger", "IME"),
    ("fmi2SetBoolean", "IME"),
    ("fmi2SetString", "IME"),
    ("fmi2GetFMUstate", "IMECTX"),
    ("fmi2SetFMUstate", "IMECTX"),
    ("fmi2FreeFMUstate", "IMECTX"),
    ("fmi2SerializedFMUstateSize", "IMECTX"),
    ("fmi2SerializeFMUstate", "IMECTX"),
    ("fmi2DeSerializeFMUstate", "IMECTX"),
    ("fmi2GetDirectionalDerivative", "MECTX"),
    ("fmi2EnterEventMode", "EC"),
    ("fmi2NewDiscreteStates", "E"),
    ("fmi2EnterContinuousTimeMode", "E"),
    ("fmi2CompletedIntegratorStep", "C"),
    // The standard allows Event Mode only without continuous states; several importers set the time there before the first step.
    ("fmi2SetTime", "EC"),
    ("fmi2SetContinuousStates", "C"),
    ("fmi2GetEventIndicators", "MECTX"),
    ("fmi2GetContinuousStates", "MECTX"),
    ("fmi2GetDerivatives", "MECTX"),
    ("fmi2GetNominalsOfContinuousStates", "IMECTX"),
];

/// Functions whose results are not finite after the states that lead to the error.
const NOT_FINITE: [&str; 3] = ["fmi2GetDirectionalDerivative", "fmi2GetDerivatives", "fmi2GetEventIndicators"];

const TO_CONTINUOUS_TIME_MODE: [fn(&Instance) -> Status; 3] = [
    |i| call!(i, enter_initialization_mode),
    |i| call!(i, exit_initialization_mode),
    |i| call!(i, enter_continuous_time_mode),
];

fn exchanged_in(state: &str) -> Instance {
    let instance = Instance::of(MODEL_EXCHANGE, "block", None, false);
    if state == "error" {
        instance.set("on_separation", 3.0);
        TO_CONTINUOUS_TIME_MODE.iter().for_each(|step| assert_eq!(step(&instance), OK));
        assert_eq!(call!(instance, set_continuous_states, IMPOSSIBLE.as_ptr(), IMPOSSIBLE.len()), OK);
        assert_eq!(call!(instance, enter_event_mode), OK);
        assert_eq!(call!(instance, new_discrete_states, &mut EventInfo::default()), ERROR);
        instance.messages();
        return instance;
    }
    let place = EXCHANGED.iter().position(|name| *name == state).unwrap();
    TO_CONTINUOUS_TIME_MODE.iter().take(place).for_each(|step| assert_eq!(step(&instance), OK, "{state}"));
    if state == "terminated" {
        assert_eq!(call!(instance, terminate), OK);
    }
    instance
}

#[test]
fn legality_of_every_call_of_model_exchange() {
    let mut wrong = Vec::new();
    for (state, letter) in EXCHANGED.iter().zip(["I", "M", "E", "C", "T", "X"]) {
        for &(name, _, act) in TABLE {
            let instance = exchanged_in(state);
            let before = all_of(&instance);
            let status = act(&instance);
            let messages = instance.messages();
            let row = OF_EXCHANGE.iter().find(|row| row.0 == name);
            let logs = |word: &str| {
                messages.len() == 1 && messages[0].text.starts_with(name) && messages[0].text.contains(word)
            };
            let right = match row {
                Some((_, states)) if states.contains(letter) => {
                    status == OK || (*state == "error" && status == DISCARD && NOT_FINITE.contains(&name))
                }
                Some(_) => status == ERROR && logs(state) && all_of(&instance) == before,
                None if name == "fmi2CancelStep" => status == ERROR && logs("no step is ever in progress"),
                None => status == ERROR && logs("found an instance for Model Exchange") && all_of(&instance) == before,
            };
            if !right {
                wrong.push(format!("{name} in {state}: {status}, {messages:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
