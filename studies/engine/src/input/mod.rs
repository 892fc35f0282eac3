//! Study files and accelerogram files → parameters and records.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`study_file`] | a TOML file → its tables, with the line of each key and value |
//! | [`parameters`] | names and values of a study file → the variables of modelDescription.xml |
//! | [`ground_files`] | accelerogram files and their options → records |

pub mod ground_files;
pub mod parameters;
pub mod study_file;
