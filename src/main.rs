//! The `rocking` program.

fn main() {}
