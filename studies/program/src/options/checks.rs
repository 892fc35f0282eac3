//! Numbers of options → errors for those out of range.

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
