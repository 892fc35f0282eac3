//! Numbered tasks → rows of a CSV file, in order, resumable.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`output_target`] | the name of an output → a file, a stream or standard output |
//! | [`resumable`] | rows → a CSV file that an interrupted study can resume |
//! | [`runner`] | numbered tasks → their results in order, computed on all cores |

pub mod output_target;
pub mod resumable;
pub mod runner;
