//! The tables of study files → their JSON Schema, for editors.

use crate::spec::numbers_in_space::{SpaceNumber, numbers};
use crate::spec::space::BaseShape;
use crate::spec::words::{Words, friction};
use rocking_block::space::parameters::FEET;
use rocking_block::unit::variables::{Causality, DESCRIPTIONS, Kind, Metadata, VARIABLES, Variable};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::input::parameters::Parameter;

/// Parameters by name: a value, a list or a range of each.
pub(super) fn parameters<Range: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let range = generator.subschema_for::<Range>().to_value();
    let forms = |kind: Kind, value: Value| {
        let mut forms = vec![value.clone(), json!({ "type": "array", "items": value, "minItems": 1 })];
        if kind == Kind::Real {
            forms.push(range.clone());
        }
        json!({ "anyOf": forms })
    };
    let mut schema = by_name(generator, "values-of-", "", |metadata| Some(forms(metadata.kind, value(metadata))));
    if let Some(properties) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        add_numbers_in_space(properties, |number| forms(Kind::Real, number));
        properties.extend(shape_in_space());
    }
    schema
}

/// Adds the numbers that only a block in space has.
fn add_numbers_in_space(properties: &mut Map<String, Value>, schema: impl Fn(Value) -> Value) {
    let add = |properties: &mut Map<String, Value>, name: &str, number: &SpaceNumber| {
        if properties.get(name).is_none() {
            let help = number.schema["description"].as_str().unwrap_or_default();
            let mut of_number = number.schema.clone();
            if let Some(of_number) = of_number.as_object_mut() {
                ["description", "title"].into_iter().for_each(|key| drop(of_number.remove(key)));
            }
            let mut of_number = schema(of_number);
            of_number["description"] = format!("{help}; of a block in space").into();
            properties.insert(name.into(), of_number);
        }
    };
    for number in numbers() {
        add(properties, number.name, number);
        if let Some((group, name)) = number.name.split_once('.')
            && let Some(group) = properties.get_mut(group).and_then(|group| group["properties"].as_object_mut())
        {
            add(group, name, number);
        }
    }
}

/// The parameters of a block in space that no study varies.
fn shape_in_space() -> [(String, Value); 3] {
    let words: Vec<&str> = BaseShape::WORDS.iter().map(|(word, _)| *word).collect();
    let numbers =
        |count: usize| json!({ "type": "array", "items": { "type": "number" }, "minItems": count, "maxItems": count });
    [
        ("base", json!({ "enum": words, "description": "Shape of the base of a block in space; by default rectangle" })),
        (
            "feet",
            json!({
                "anyOf": [{ "type": "integer", "minimum": FEET[0], "maximum": FEET[1] }, { "type": "string" }],
                "description": "Number of feet of a circular base, or the file of a table of feet [m]; of a block in space",
            }),
        ),
        (
            "inertia_tensor",
            json!({
                "anyOf": [numbers(3), numbers(6)],
                "description": "Ixx, Iyy, Izz and, if any, Ixy, Ixz, Iyz about the centre of mass [kg.m2]; of a block in space",
            }),
        ),
    ]
    .map(|(name, schema)| (name.into(), schema))
}

/// Parameters by name: one value of each.
pub(super) fn values(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "", |metadata| Some(value(metadata)))
}

/// The initial state.
pub(super) fn initial(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "initial.", |metadata| Some(value(metadata)))
}

/// The pulse.
pub(super) fn pulse(generator: &mut SchemaGenerator) -> Schema {
    by_name(generator, "", "pulse.", |metadata| Some(value(metadata)))
}

/// Spreads of parameters by name.
pub(super) fn spreads<Spread: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let spread = generator.subschema_for::<Spread>().to_value();
    let mut schema =
        by_name(generator, "spread-of-", "", |metadata| (metadata.kind == Kind::Real).then(|| spread.clone()));
    if let Some(properties) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        add_numbers_in_space(properties, |_| spread.clone());
    }
    schema
}

/// Two numbers of each parameter by name, which may have a group.
pub(super) fn pairs(_: &mut SchemaGenerator) -> Schema {
    let pair = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    let group = json!({ "type": "object", "additionalProperties": pair });
    json_schema!({ "type": "object", "additionalProperties": { "anyOf": [pair, group] } })
}

/// A value of a parameter within its limits.
fn value(metadata: &'static Metadata) -> Value {
    let Metadata { variable, kind, min, max, items, .. } = *metadata;
    let parameter = Parameter::from(metadata);
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
    schema: impl Fn(&'static Metadata) -> Option<Value>,
) -> Schema {
    let mut properties = Map::new();
    let of_users =
        |metadata: &&Metadata| metadata.causality == Causality::Parameter && !metadata.name.starts_with("record.");
    for metadata in VARIABLES.iter().filter(of_users) {
        let parameter = Parameter::from(metadata);
        let Some(mut schema) = schema(metadata) else { continue };
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
