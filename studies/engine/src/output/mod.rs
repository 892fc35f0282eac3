//! Numbered tasks → rows of a CSV file, in order, resumable.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`table`] | columns with units and types → tables of typed values |
//! | [`csv`] | tables → lines of CSV, and back |
//! | [`parquet`] | tables → Parquet, and back, with the feature `parquet` |
//! | [`mod@format`] | a table and what it is → the bytes of a file, in the format of its name |
//! | [`reading`] | tables of unknown columns → typed columns |
//! | [`output_target`] | the name of an output → a file, a stream or standard output |
//! | [`resumable`] | rows → a CSV file that an interrupted study can resume |
//! | [`seal`] | the bytes of a file → a checksum in its end |
//! | [`runner`] | numbered tasks → their results in order, computed on all cores |
//! | [`parts`] | a study → its parts, each a file of a folder |
//! | [`merging`] | the parts of a study → the table of one run |
//! | [`table_files`] | the parts of a study, or other files of one table → its rows |
//! | [`forecast`] | a study → its expected cost, from a sample of its rows |

pub mod csv;
pub mod forecast;
pub mod format;
pub mod merging;
pub mod output_target;
#[cfg_attr(not(feature = "parquet"), path = "no_parquet.rs")]
pub mod parquet;
pub mod parts;
pub mod reading;
pub mod resumable;
pub mod runner;
pub mod seal;
pub mod table;
pub mod table_files;
