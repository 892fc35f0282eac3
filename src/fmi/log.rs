//! Messages for the importer, by category: finished text.

use std::ffi::{CStr, CString};
use std::fmt::Write;

use crate::fmi::status::Status;

/// Category of a message, named in modelDescription.xml.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// A warning.
    Warning,
    /// A step was discarded.
    Discard,
    /// A call was refused or failed.
    Error,
    /// The instance is unusable.
    Fatal,
    /// One line per event.
    Events,
    /// One line per step.
    Steps,
}

impl Category {
    /// All categories.
    pub const ALL: [Category; 6] =
        [Category::Warning, Category::Discard, Category::Error, Category::Fatal, Category::Events, Category::Steps];

    /// Returns its name.
    pub fn name(self) -> &'static CStr {
        match self {
            Category::Warning => c"logStatusWarning",
            Category::Discard => c"logStatusDiscard",
            Category::Error => c"logStatusError",
            Category::Fatal => c"logStatusFatal",
            Category::Events => c"logEvents",
            Category::Steps => c"logSteps",
        }
    }

    /// Whether only the debug mode logs it.
    pub fn is_of_debugging(self) -> bool {
        match self {
            Category::Warning | Category::Error | Category::Fatal => false,
            Category::Discard | Category::Events | Category::Steps => true,
        }
    }

    fn of_status(status: Status) -> Category {
        match status {
            Status::Ok | Status::Warning => Category::Warning,
            Status::Discard => Category::Discard,
            Status::Error => Category::Error,
            Status::Fatal => Category::Fatal,
        }
    }
}

/// Whether each category is logged, in the order of [`Category::ALL`].
pub type Wanted = [bool; Category::ALL.len()];

/// The importer's logger.
pub trait Messenger {
    /// The characters with a meaning in messages of this version, which stand twice to be shown once.
    const DOUBLED: &[char];

    /// Returns the categories logged after a call of `SetDebugLogging`. They are those `listed`, or all if `None`.
    fn wanted(before: Wanted, logging: bool, listed: Option<&[Category]>) -> Wanted;

    /// Sends a message.
    fn send(&self, instance: &CStr, status: Status, category: &CStr, message: &CStr);
}

/// The log of an instance.
#[derive(Debug)]
pub struct Log<M> {
    messenger: M,
    instance: CString,
    wanted: Wanted,
}

impl<M: Messenger> Log<M> {
    /// Makes a log with the categories that the version of FMI chooses for `logging`.
    pub fn new(messenger: M, instance: CString, logging: bool) -> Log<M> {
        let mut log = Log { messenger, instance, wanted: [true; Category::ALL.len()] };
        log.choose(logging, None);
        log
    }

    /// Chooses the categories that are logged from now on.
    pub fn choose(&mut self, logging: bool, listed: Option<&[Category]>) {
        self.wanted = M::wanted(self.wanted, logging, listed);
    }

    /// Whether this category is logged.
    pub fn wants(&self, category: Category) -> bool {
        self.wanted[category as usize]
    }

    /// Logs the message of a status.
    pub fn status(&self, status: Status, message: &str) {
        self.tell(status, Category::of_status(status), format_args!("{message}"));
    }

    /// Logs a message without allocating memory, cut to 1 kB.
    #[inline]
    pub fn tell(&self, status: Status, category: Category, message: std::fmt::Arguments) {
        if self.wants(category) {
            self.send(status, category, message);
        }
    }

    #[cold]
    fn send(&self, status: Status, category: Category, message: std::fmt::Arguments) {
        let mut line = Line::new(M::DOUBLED);
        // The error means that a long line was cut.
        let _ = line.write_fmt(message);
        self.messenger.send(&self.instance, status, category.name(), line.as_c_str());
    }
}

/// A line of text on the stack, without control characters. It ends with 0.
struct Line {
    bytes: [u8; 1024],
    length: usize,
    doubled: &'static [char],
}

impl Line {
    fn new(doubled: &'static [char]) -> Line {
        Line { bytes: [0; 1024], length: 0, doubled }
    }

    fn as_c_str(&self) -> &CStr {
        CStr::from_bytes_until_nul(&self.bytes).unwrap_or(c"")
    }
}

impl Write for Line {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for character in text.chars() {
            let character = if character.is_control() { '\u{fffd}' } else { character };
            let times = if self.doubled.contains(&character) { 2 } else { 1 };
            // A line is never cut within a pair.
            if self.length + times * character.len_utf8() >= self.bytes.len() {
                return Err(std::fmt::Error);
            }
            for _ in 0..times {
                self.length += character.encode_utf8(&mut self.bytes[self.length..]).len();
            }
        }
        Ok(())
    }
}
