//! The tables of study files → their JSON Schema, for editors.

use crate::spec::words::friction;
use rocking_block::unit::variables::{Causality, DESCRIPTIONS, Kind, Metadata, VARIABLES, Variable};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::input::parameters::Parameter;

/// Parameters by name: a value, a list or a range of each.
pub(super) fn parameters<Range: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let range = generator.subschema_for::<Range>().to_value();
    by_name(generator, "values-of-", "", |parameter| {
        let value = value(parameter);
        let mut forms = vec![value.clone(), json!({ "type": "array", "items": value, "minItems": 1 })];
        if parameter.metadata.kind == Kind::Real {
            forms.push(range.clone());
        }
        Some(json!({ "anyOf": forms }))
    })
}

/// Parameters by name: one value of each.
pub(super) fn values(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "", |parameter| Some(value(parameter)))
}

/// The initial state.
pub(super) fn initial(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "initial.", |parameter| Some(value(parameter)))
}

/// The pulse.
pub(super) fn pulse(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "pulse.", |parameter| Some(value(parameter)))
}

/// Spreads of parameters by name.
pub(super) fn spreads<Spread: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let spread = generator.subschema_for::<Spread>().to_value();
    by_name(generator, "spread-of-", "", |parameter| (parameter.metadata.kind == Kind::Real).then(|| spread.clone()))
}

/// Two numbers of each parameter by name, which may have a group.
pub(super) fn pairs(_: &mut SchemaGenerator) -> Schema {
    let pair = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    let group = json!({ "type": "object", "additionalProperties": pair });
    json_schema!({ "type": "object", "additionalProperties": { "anyOf": [pair, group] } })
}

/// A value of a parameter within its limits.
fn value(parameter: &Parameter) -> Value {
    let Metadata { variable, kind, min, max, items, .. } = *parameter.metadata;
    let number = |kind: &str| {
        let mut schema = json!({ "type": kind });
        let limits = [("minimum", min), ("maximum", max)];
        for (key, limit) in limits.into_iter().filter_map(|(key, limit)| Some((key, limit?))) {
            schema[key] = limit.into();
        }
        schema
    };
    match kind {
        // Users write no limit as a word, the engine as 0.
        Kind::Real if variable == Variable::Friction => {
            json!({ "anyOf": [{ "type": "number", "exclusiveMinimum": 0 }, { "enum": [friction::NONE] }] })
        }
        Kind::Real => number("number"),
        Kind::Integer => number("integer"),
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Enumeration => {
            json!({ "enum": items.iter().map(|item| parameter.display(f64::from(item.0))).collect::<Vec<_>>() })
        }
        Kind::String => json!({ "type": "string" }),
    }
}

/// A table of the parameters whose names begin with a prefix. Their names are short or full, in quotes or in tables of their groups.
///
/// `kind` begins the names of their definitions.
fn by_name(
    generator: &mut SchemaGenerator,
    kind: &str,
    prefix: &str,
    schema: impl Fn(&Parameter) -> Option<Value>,
) -> Schema {
    let mut properties = Map::new();
    let of_users =
        |metadata: &&Metadata| metadata.causality == Causality::Parameter && !metadata.name.starts_with("record.");
    for metadata in VARIABLES.iter().filter(of_users) {
        let parameter = Parameter { metadata };
        let Some(mut schema) = schema(&parameter) else { continue };
        let unit = metadata.unit.map(|unit| format!(" [{unit}]")).unwrap_or_default();
        let default = metadata.start.map(|start| match parameter.display(start) {
            unlimited if unlimited == "inf" => friction::NONE.into(),
            default => default,
        });
        let default = default.map(|default| format!("; by default {default}")).unwrap_or_default();
        schema["description"] = format!("{}{unit}{default}", DESCRIPTIONS[metadata.variable as usize]).into();
        let definition = format!("{kind}{}", metadata.name);
        let reference = json!({ "$ref": format!("#/$defs/{}", definition) });
        generator.definitions_mut().insert(definition, schema);
        for name in [parameter.name(), metadata.name].iter().filter_map(|name| name.strip_prefix(prefix)) {
            if let Some((group, of_group)) = name.split_once('.') {
                let empty = || json!({ "type": "object", "properties": {}, "additionalProperties": false });
                let group = properties.entry(group).or_insert_with(empty);
                group["properties"][of_group] = reference.clone();
            }
            properties.insert(name.into(), reference.clone());
        }
    }
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}
