//! Options, study files and records.

mod choices;
mod doubts;
mod free_motion;
mod identity;
mod numbers;
mod patterns;
mod record;
mod settings;
mod several;
mod without_effect;
