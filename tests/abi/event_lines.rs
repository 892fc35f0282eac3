//! The lines of events of the planar block.

use crate::functions::*;
use crate::host::Instance;
use crate::logging::{choose, rock};

/// An event, parsed from its line.
#[derive(Debug, PartialEq)]
pub struct LoggedEvent {
    pub time: f64,
    pub what: String,
    pub before: i32,
    pub after: i32,
}

impl LoggedEvent {
    /// Reads `t = 1.234567890 s: lift-off of L, full contact -> tilting right`.
    pub fn read(line: &str) -> LoggedEvent {
        let read = || {
            let (time, rest) = line.strip_prefix("t = ")?.split_once(" s: ")?;
            let (what, regimes) = rest.split_once(", ")?;
            let (before, after) = regimes.split_once(" -> ")?;
            let number = |regime: &str| {
                let names = ["tilting left", "full contact", "tilting right", "separated"];
                names.iter().position(|name| *name == regime).map(|place| place as i32 - 1)
            };
            Some(LoggedEvent {
                time: time.parse().ok()?,
                what: what.into(),
                before: number(before)?,
                after: number(after)?,
            })
        };
        read().unwrap_or_else(|| panic!("{line:?} tells no event"))
    }
}

#[test]
fn lines_of_events_have_the_regimes() {
    let instance = Instance::at("block", None, true);
    assert_eq!(choose(&instance, true, &["logEvents"]), OK);
    let messages = rock(&instance);
    let events: Vec<LoggedEvent> = messages.iter().map(|message| LoggedEvent::read(&message.text)).collect();
    assert!(events.len() > 5);
    assert!(events.windows(2).all(|pair| pair[0].after == pair[1].before), "each goes on from where the last led");
    assert_eq!(events[0].before, 1, "it starts leaning to the right");
    let last = events.last().unwrap();
    assert_eq!(f64::from(last.after), instance.get("regime"));
}
