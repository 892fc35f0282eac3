//! Results → files, pictures and messages.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`formats`] | name of an output → its format |
//! | [`files`] | content → files, checked first and replaced as a whole |
//! | [`summary`] | items → lines of text, and the entries of a JSON object |
//! | [`report`] | a summary → standard output, as text or JSON |
//! | [`progress`] | finished part of the work → a bar on the terminal |
//! | [`interrupt`] | Ctrl-C → the command that continues a study |

pub mod formats;

pub mod files;

pub mod summary;

pub mod report;

pub mod progress;

pub mod interrupt;
