//! The block and its equations: parameters, excitation, accelerations, impacts, transitions.

#[path = "../common/blocks.rs"]
#[allow(dead_code, reason = "each test program uses a part")]
mod blocks;

mod equations;
mod held;
mod impulses;
mod parameters;
mod pulses;
mod rubbing;
mod ties;
mod transitions;
