//! Names and values of a study file → the variables of modelDescription.xml.

use crate::model::variables::{Causality, Kind, Metadata, VARIABLES};

/// A parameter of the FMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// What modelDescription.xml says of it.
    pub metadata: &'static Metadata,
}

impl Parameter {
    /// The parameter of this name, as in `alpha` or, as in the FMU, `dimensionless.alpha`; the error says which ones there are.
    pub fn named(name: &str) -> Result<Parameter, String> {
        // Studies have record files of their own.
        let known = VARIABLES.iter().filter(|metadata| !metadata.name.starts_with("record."));
        let known = known.clone().find(|metadata| metadata.name == name).or_else(|| {
            let parameters = |metadata: &&Metadata| metadata.causality == Causality::Parameter;
            known.clone().filter(parameters).find(|metadata| short(metadata.name) == name)
        });
        let Some(metadata) = known else {
            return Err(format!("there is no parameter {name}; expected one of {}", similar(name)));
        };
        if metadata.causality != Causality::Parameter {
            let causality = metadata.causality;
            return Err(format!("{name} ({causality}) is not set from outside; expected one of {}", similar(name)));
        }
        Ok(Parameter { metadata })
    }

    /// The name as it stands in tables: `alpha`, without the group of the FMU where the name alone is clear.
    pub fn name(&self) -> &'static str {
        short(self.metadata.name)
    }

    /// Whether some variable's name begins with this name and a dot.
    pub fn is_group(name: &str) -> bool {
        VARIABLES.iter().any(|known| known.name.strip_prefix(name).is_some_and(|rest| rest.starts_with('.')))
    }

    /// A value as it stands in a table: items and truth values in words, numbers in digits that bring them back exactly.
    pub fn display(&self, value: f64) -> String {
        match self.metadata.kind {
            Kind::Boolean => (value != 0.0).to_string(),
            _ => match self.metadata.items.iter().find(|item| f64::from(item.0) == value) {
                Some((_, name)) => word(name),
                None => value.to_string(),
            },
        }
    }

    /// Name and unit, as they stand over a column: `p [rad/s]`. A choice has no unit.
    pub fn heading(&self) -> String {
        let name = self.name();
        self.metadata.unit.map_or(name.into(), |unit| format!("{name} [{unit}]"))
    }

    /// The number of an item, as in `one-sine`; any case will do, and the name in the FMU, `OneSine`.
    pub fn item(&self, name: &str) -> Result<f64, String> {
        let items = self.metadata.items;
        match items.iter().find(|item| is_same_word(item.1, name)) {
            Some((value, _)) => Ok(f64::from(*value)),
            None if items.is_empty() => {
                Err(format!("{} = \"{name}\"; expected {}", self.metadata.name, self.expected()))
            }
            None => {
                let known: Vec<String> = items.iter().map(|item| word(item.1)).collect();
                Err(format!("{} = \"{name}\"; expected one of {}", self.metadata.name, known.join(", ")))
            }
        }
    }

    /// What kind of value it takes.
    pub fn expected(&self) -> &'static str {
        match self.metadata.kind {
            Kind::Boolean => "true or false",
            Kind::Enumeration => "the name of an item",
            Kind::Integer => "an integer",
            Kind::Real | Kind::String => "a number",
        }
    }
}

/// Whether two spellings name the same choice: case, hyphens and underscores do not matter.
pub fn is_same_word(one: &str, other: &str) -> bool {
    let letters =
        |text: &str| text.chars().filter(|c| !matches!(c, '-' | '_')).flat_map(char::to_lowercase).collect::<String>();
    letters(one) == letters(other)
}

/// The word of a choice from its name in the FMU: `one-sine` from `OneSine`, `c1` from `C1`.
fn word(item: &str) -> String {
    let mut word = String::new();
    for c in item.chars() {
        if c.is_uppercase() && !word.is_empty() {
            word.push('-');
        }
        word.extend(c.to_lowercase());
    }
    word
}

/// A name without the group of the parameterization it belongs to.
fn short(name: &'static str) -> &'static str {
    ["dimensionless.", "physical."].iter().find_map(|group| name.strip_prefix(group)).unwrap_or(name)
}

fn names() -> impl Iterator<Item = &'static str> {
    let parameters = VARIABLES.iter().filter(|metadata| metadata.causality == Causality::Parameter);
    parameters.map(|metadata| short(metadata.name)).filter(|name| !name.starts_with("record."))
}

/// The names of the same group, or all.
fn similar(name: &str) -> String {
    let group = name.split('.').next().unwrap_or_default();
    let same: Vec<&str> = names().filter(|known| known.split_once('.').is_some_and(|(of, _)| of == group)).collect();
    if same.is_empty() { names().collect::<Vec<_>>().join(", ") } else { same.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_and_units_are_those_of_the_description() {
        let shape = Parameter::named("pulse.shape").unwrap();
        for spelling in ["one-cosine", "OneCosine", "ONE-COSINE", "one_cosine"] {
            assert_eq!(shape.item(spelling), Ok(3.0), "{spelling}");
        }
        assert_eq!([3.0, 4.0].map(|value| shape.display(value)), ["one-cosine", "c1"]);
        assert!(shape.item("two-sines").unwrap_err().ends_with("expected one of none, one-sine, one-cosine, c1, c2"));
        assert_eq!(Parameter::named("foundation").unwrap().display(2.0), "rigid");
        assert_eq!(Parameter::named("alpha"), Parameter::named("dimensionless.alpha"));
        assert_eq!(Parameter::named("width"), Parameter::named("physical.width"));
        let headings =
            ["dimensionless.p", "epsilon", "foundation"].map(|name| Parameter::named(name).unwrap().heading());
        assert_eq!(headings, ["p [rad/s]", "epsilon [1]", "foundation"]);
    }
}
