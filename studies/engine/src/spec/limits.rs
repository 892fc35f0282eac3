//! The JSON Schema of a value → the accepted values in words, and whether a number is one of them.

use std::borrow::Cow;

use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema};
use serde_json::Value;

use crate::spec::SpecError;

/// Returns the JSON Schema of a file or of one of its tables.
pub fn schema_of<T: JsonSchema>() -> Schema {
    let mut schema = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>();
    without_null(&mut schema);
    schema
}

/// Takes out the type of a missing value, since TOML has none. Formats that no editor needs go, too.
fn without_null(schema: &mut Schema) {
    schema.remove("format");
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &mut types[..] {
            let only = only.take();
            schema.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.retain(|choice| choice["type"] != "null");
        if let [Value::Object(only)] = &mut choices[..] {
            let only = std::mem::take(only);
            schema.remove("anyOf");
            only.into_iter().for_each(|(key, value)| {
                schema.ensure_object().entry(key).or_insert(value);
            });
        }
    }
    transform_subschemas(&mut without_null, schema);
}

/// Checks numbers of a struct by the limits of its fields.
///
/// # Errors
/// The first number out of range.
pub fn check<T: JsonSchema>(numbers: &[(&'static str, Option<f64>)]) -> Result<(), SpecError> {
    let properties = properties::<T>();
    match numbers.iter().find(|(name, number)| number.is_some_and(|number| !admits(&properties[name], number))) {
        Some(&(parameter, Some(value))) => Err(SpecError::OutOfRange {
            parameter: parameter.into(),
            value,
            expected: expected(&properties[parameter]).into(),
        }),
        _ => Ok(()),
    }
}

/// Returns the schemas of the fields of a struct, by their names.
pub fn properties<T: JsonSchema>() -> Value {
    schema_of::<T>().as_value()["properties"].clone()
}

/// Whether a number is finite and within the limits of its schema.
pub fn admits(schema: &Value, number: f64) -> bool {
    let within = |key: &str, is: fn(&f64, &f64) -> bool| schema[key].as_f64().is_none_or(|limit| is(&number, &limit));
    number.is_finite()
        && within("minimum", f64::ge)
        && within("exclusiveMinimum", f64::gt)
        && within("maximum", f64::le)
        && within("exclusiveMaximum", f64::lt)
}

/// Says which values a schema accepts.
pub fn expected(schema: &Value) -> String {
    let forms = schema["anyOf"].as_array();
    if let Some(forms) = forms {
        return forms.iter().map(expected).collect::<Vec<_>>().join(" or ");
    }
    let words: Vec<String> = words(schema).map(|word| format!("\"{word}\"")).collect();
    if let Some((last, others)) = words.split_last() {
        return format!("{} or {last}", others.join(", "));
    }
    match schema["type"].as_str() {
        Some("number") => number(schema),
        Some("integer") => format!("a whole number{}", range(schema, "")),
        Some("string") => "a text in quotes".into(),
        Some("boolean") => "true or false".into(),
        Some("array") => match schema["maxItems"].as_u64() {
            Some(count) => format!("a list of {count} values, each {}", expected(&schema["items"])),
            None => format!("a list, each of its values {}", expected(&schema["items"])),
        },
        _ => "a table".into(),
    }
}

/// Returns the words of a choice; none for other values.
pub fn words(schema: &Value) -> impl Iterator<Item = &str> {
    schema["oneOf"].as_array().into_iter().flatten().filter_map(|word| word["const"].as_str())
}

/// Returns the unit in brackets of a schema's description.
pub fn unit(schema: &Value) -> Option<&str> {
    let (unit, _) = schema["description"].as_str()?.split_once('[')?.1.split_once(']')?;
    (!unit.contains(' ')).then_some(unit)
}

/// Says which numbers a schema accepts, in the unit in brackets of its description.
fn number(schema: &Value) -> String {
    let unit = unit(schema).unwrap_or_default();
    match range(schema, &format!(" {unit}")) {
        range if range.is_empty() => finite(unit),
        range => match noun(unit) {
            noun if noun.starts_with('a') => format!("an {noun}{}", range.trim_end()),
            noun => format!("a {noun}{}", range.trim_end()),
        },
    }
}

/// Says that any finite number in a unit is accepted. The unit may be empty, or 1.
pub fn finite(unit: &str) -> String {
    match unit {
        "" | "1" => "a finite number".into(),
        unit => format!("a finite {} in {unit}", noun(unit)),
    }
}

/// Returns the quantity of a unit.
fn noun(unit: &str) -> &'static str {
    match unit {
        "s" => "time",
        "m" => "length",
        "kg" => "mass",
        "rad" => "angle",
        "Hz" | "rad/s" => "frequency",
        "m/s2" => "acceleration",
        "N" => "force",
        "N/m" => "stiffness",
        "N.s/m" => "damping",
        "kg.m2" => "moment of inertia",
        _ => "number",
    }
}

/// Says the limits of a schema, such as ` > 0 s`.
fn range(schema: &Value, unit: &str) -> String {
    let limit = |key: &str| schema[key].as_f64().map(shown);
    let [least, above, greatest, below] = ["minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum"].map(limit);
    match (least, above, greatest, below) {
        (Some(least), _, Some(greatest), _) => format!(" from {least} to {greatest}{unit}"),
        (Some(least), ..) => format!(" of at least {least}{unit}"),
        (_, Some(above), Some(greatest), _) => format!(" > {above}{unit}, at most {greatest}{unit}"),
        (_, Some(above), _, Some(below)) => format!(" above {above} and below {below}{unit}"),
        (_, Some(above), ..) => format!(" > {above}{unit}"),
        _ => String::new(),
    }
}

/// Writes a limit; powers of ten far from 1 as such.
fn shown(limit: f64) -> Cow<'static, str> {
    match limit.abs() {
        0.0 => "0".into(),
        std::f64::consts::FRAC_PI_2 => "pi/2".into(),
        size if !(1e-3..1e6).contains(&size) && size < 1e9 => format!("{limit:e}").into(),
        _ => limit.to_string().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{RunSpec, SingleRunSpec};

    /// Finds the least and the greatest accepted numbers by trial, as the words say.
    #[test]
    fn words_and_limits_are_those_of_the_schema() {
        let (study, single) = (properties::<RunSpec>(), properties::<SingleRunSpec>());
        for (schema, words, accepted, refused) in [
            (&study["tolerance"], "a number from 1e-14 to 0.1", [1e-14, 0.1], [9e-15, 0.11]),
            (&study["duration"], "a time > 0 s, at most 1e6 s", [1e-300, 1e6], [0.0, 1.1e6]),
            (&study["step"], "a time of at least 1e-6 s", [1e-6, 1e300], [0.9e-6, f64::INFINITY]),
            (&study["friction_demand"], "a number > 0", [1e-300, 1e300], [0.0, f64::NAN]),
            (&single["duration"], "a time > 0 s", [1e-300, 1e300], [0.0, -1.0]),
        ] {
            assert_eq!(expected(schema), words);
            assert!(accepted.iter().all(|&number| admits(schema, number)), "{words}");
            assert!(!refused.iter().any(|&number| admits(schema, number)), "{words}");
        }
    }
}
