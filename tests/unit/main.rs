//! The unit behind both C interfaces: derivatives at the start, instances side by side, random sequences of calls.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/beginning/mod.rs"]
mod differences;
#[path = "../common/fmu.rs"]
mod fmu;
#[path = "../common/misuse.rs"]
mod misuse;
#[path = "../common/sealed.rs"]
mod sealed;

mod beginning;
mod block;
mod exchange;
mod instances;
mod sequences;
