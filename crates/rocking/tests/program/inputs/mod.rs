//! Options, study files and records.

mod choices;
mod free_motion;
mod numbers;
mod patterns;
mod record;
mod settings;
mod several;
mod without_effect;
