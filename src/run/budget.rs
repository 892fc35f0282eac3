//! The steps that a call may take.

use crate::numerics::control::is_resolved;
use crate::run::SimulationError;

/// Maximum number of steps in a call. Reasonable calls take far fewer; one with this many ends in seconds.
pub(crate) const MAX_STEPS: u64 = 2_000_000;

/// Takes a step towards `until` (s) from the budget of a call. `fastest` names the number of the body that makes its motion fastest.
///
/// # Errors
/// The budget is spent, or the clock does not resolve steps of `longest` (s) at `time`.
pub(crate) fn spend_step(
    budget: &mut u64,
    [time, until]: [f64; 2],
    longest: f64,
    fastest: impl FnOnce() -> String,
) -> Result<(), SimulationError> {
    if *budget == 0 || !is_resolved(time, longest) {
        return Err(SimulationError::TooManySteps { time, until, steps: MAX_STEPS - *budget, fastest: fastest() });
    }
    *budget -= 1;
    Ok(())
}
