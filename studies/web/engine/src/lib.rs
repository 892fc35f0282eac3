//! The engine of the page: requests as JSON → replies as JSON with numbers in binary.
//!
//! Compiled to WebAssembly, it is the program's own engine; compiled for any other target, it is tested like the other crates.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`fields`] | text of input fields → numbers and choices; an error for each field |
//! | [`records`] | dropped files and their settings → records |
//! | [`inputs`] | fields → a run |
//! | [`space`] | fields → a run of a block in space; its history → the outcome in words and numbers |
//! | [`command`] | a run → the command line of `rocking` with the same numbers |
//! | [`specification`] | units, defaults and choices of the engine → the fields of the page |
//! | [`outcome`] | a history → its outcome in words |
//! | [`spectrum`] | fields → a spectrum, row by row |
//! | [`ensemble`] | fields → the probability of overturning over the scale, row by row |
//! | [`engine`] | a request → its reply |
//! | [`exports`] | bytes in the memory of WebAssembly ↔ requests and replies |

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod fields;

pub mod records;

pub mod inputs;

pub mod command;

pub mod space;

pub mod specification;

pub mod outcome;

pub mod spectrum;

pub mod ensemble;

pub mod engine;

pub mod exports;
