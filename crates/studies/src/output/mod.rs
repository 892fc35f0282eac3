//! Numbered tasks → rows of a CSV file, in order, resumable.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`mod@fields`] | values → the fields of a row; rows → lines of CSV |
//! | [`output_target`] | the name of an output → a file, a stream or standard output |
//! | [`resumable`] | rows → a CSV file that an interrupted study can resume |
//! | [`runner`] | numbered tasks → their results in order, computed on all cores |

pub mod fields;
pub mod output_target;
pub mod resumable;
pub mod runner;
