//! A unit of an intensity measure → its SI unit and factor.

/// Returns the SI unit and the value of a unit in it. `gravity` (m/s²) is that of `g`; `None` for an unknown unit.
pub fn si(unit: &str, gravity: f64) -> Option<(&'static str, f64)> {
    let plain = unit.trim().to_ascii_lowercase().replace('²', "2").replace(['*', '.', '·'], " ");
    Some(match plain.as_str() {
        "g" => ("m/s2", gravity),
        "m/s2" => ("m/s2", 1.0),
        "cm/s2" | "gal" => ("m/s2", 0.01),
        "g s" => ("m/s", gravity),
        "m/s" => ("m/s", 1.0),
        "cm/s" => ("m/s", 0.01),
        "m" => ("m", 1.0),
        "cm" => ("m", 0.01),
        "s" => ("s", 1.0),
        "1" => ("1", 1.0),
        _ => return None,
    })
}
