//! Numbers of options → errors for those out of range.

use rocking_block::simulation::Settings;

/// Refuses a number that is not finite or fails the condition `fits`.
pub fn check(option: &str, value: f64, fits: impl Fn(f64) -> bool, expected: &str) -> anyhow::Result<()> {
    anyhow::ensure!(value.is_finite() && fits(value), "--{option} = {value}; expected {expected}");
    Ok(())
}

/// Checks the value of an option that may be missing, and returns it.
pub fn checked(
    option: &str,
    value: Option<f64>,
    fits: impl Fn(f64) -> bool,
    expected: &str,
) -> anyhow::Result<Option<f64>> {
    value.map_or(Ok(()), |value| check(option, value, fits, expected))?;
    Ok(value)
}

/// Refuses a tolerance too loose or too tight for meaningful results.
pub fn check_tolerance(tolerance: f64) -> anyhow::Result<()> {
    check("tolerance", tolerance, Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE)
}

/// Checks the friction demand of a report.
pub fn check_friction_demand(demand: Option<f64>) -> anyhow::Result<Option<f64>> {
    checked("friction-demand", demand, |x| x > 0.0, "a coefficient of friction > 0")
}
