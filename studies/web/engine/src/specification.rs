//! The engine's parameters and choices → JSON, from which the build makes the fields of the page.

use rocking_block::block::restraints::LinkKind;
use rocking_block::excitation::PulseShape;
use rocking_block::simulation::Settings;
use rocking_records::{Format, Unit};
use rocking_studies::spec::records::FileSpec;
use rocking_studies::spec::words::Words;
use rocking_studies::spec::{BlockSpec, PulseSpec, SingleRunSpec, SpaceSpec, limits};
use serde_json::{Map, Value, json};

use crate::inputs::field;

/// Returns units and defaults by the names of fields, the numbers of ties with their units, and the words of choices with their
/// labels.
pub fn specification() -> Value {
    let of_structs = [
        limits::properties::<BlockSpec>(),
        limits::properties::<SpaceSpec>(),
        limits::properties::<PulseSpec>(),
        limits::properties::<SingleRunSpec>(),
        limits::properties::<FileSpec>(),
    ];
    let properties = of_structs.iter().filter_map(Value::as_object).flatten();
    let units: Map<String, Value> =
        properties.map(|(name, schema)| (field(name), limits::unit(schema).unwrap_or("1").into())).collect();
    let of_block = BlockSpec::defaults().numbers().map(|(name, value)| (field(name), value));
    let defaults = of_block.into_iter().chain([("tolerance".into(), Some(Settings::default().tolerance))]);
    // JSON has no infinite number, the default of friction.
    let defaults: Map<String, Value> =
        defaults.filter_map(|(name, value)| Some((name, value.filter(|value| value.is_finite())?.into()))).collect();
    let links = LinkKind::ALL.into_iter().map(|kind| {
        let numbers = kind.numbers().map(|number| (number.name.into(), number.quantity.unit().into()));
        (kind.word().into(), numbers.collect::<Map<_, _>>().into())
    });
    let links: Map<String, Value> = links.collect();
    let pulses: Vec<&str> = PulseShape::WORDS.iter().map(|(word, _)| *word).collect();
    let formats = Format::NAMES.split(", ").filter_map(|name| Some((name, name.parse::<Format>().ok()?.to_string())));
    let formats: Vec<(&str, String)> = formats.collect();
    let of_records = Unit::ALL.map(|unit| (unit.to_string().replace('²', "2"), unit.to_string()));
    json!({
        "units": units, "defaults": defaults, "links": links, "pulses": pulses, "formats": formats, "units_of_records": of_records,
    })
}
