//! Names and values of a study file → the variables of modelDescription.xml.

use crate::model::variables::{Causality, Kind, Metadata, VARIABLES};

/// A parameter of the FMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// What modelDescription.xml says of it.
    pub metadata: &'static Metadata,
}

impl Parameter {
    /// The parameter of this name; the error says which ones there are.
    pub fn named(name: &str) -> Result<Parameter, String> {
        // Studies have record files of their own.
        let known = VARIABLES.iter().find(|metadata| metadata.name == name && !metadata.name.starts_with("record."));
        let Some(metadata) = known else {
            return Err(format!("there is no parameter {name}; expected one of {}", similar(name)));
        };
        if metadata.causality != Causality::Parameter {
            let causality = metadata.causality;
            return Err(format!("{name} ({causality}) is not set from outside; expected one of {}", similar(name)));
        }
        Ok(Parameter { metadata })
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
                Some((_, name)) => (*name).into(),
                None => value.to_string(),
            },
        }
    }

    /// Name and unit, as they stand over a column: `dimensionless.p [rad/s]`. A choice has no unit.
    pub fn heading(&self) -> String {
        let name = self.metadata.name;
        self.metadata.unit.map_or(name.into(), |unit| format!("{name} [{unit}]"))
    }

    /// The number of an item.
    pub fn item(&self, name: &str) -> Result<f64, String> {
        let items = self.metadata.items;
        match items.iter().find(|item| item.1 == name) {
            Some((value, _)) => Ok(f64::from(*value)),
            None if items.is_empty() => {
                Err(format!("{} = \"{name}\"; expected {}", self.metadata.name, self.expected()))
            }
            None => {
                let known: Vec<&str> = items.iter().map(|item| item.1).collect();
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

fn names() -> impl Iterator<Item = &'static str> {
    let parameters = VARIABLES.iter().filter(|metadata| metadata.causality == Causality::Parameter);
    parameters.map(|metadata| metadata.name).filter(|name| !name.starts_with("record."))
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
        assert_eq!(Parameter::named("pulse.shape").unwrap().item("OneCosine"), Ok(3.0));
        assert_eq!(Parameter::named("foundation").unwrap().display(2.0), "Rigid");
        let headings =
            ["dimensionless.p", "epsilon", "foundation"].map(|name| Parameter::named(name).unwrap().heading());
        assert_eq!(headings, ["dimensionless.p [rad/s]", "epsilon [1]", "foundation"]);
    }
}
