//! Names and values of a study file → the variables of modelDescription.xml.

use roxmltree::{Document, Node};

use crate::model::variables::{Causality, Kind, Metadata, VARIABLES};

/// The names of the items of the enumerations, which are not in the code's table.
const DESCRIPTION: &str = include_str!("../../modelDescription.xml");

/// A parameter of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// What modelDescription.xml says of it.
    pub metadata: &'static Metadata,
    /// Names and numbers of its items, if it is an enumeration.
    pub items: Vec<(String, f64)>,
}

impl Parameter {
    /// The parameter of this name; the error says which ones there are.
    pub fn named(name: &str) -> Result<Parameter, String> {
        let Some(metadata) = VARIABLES.iter().find(|metadata| metadata.name == name) else {
            return Err(format!("there is no parameter {name}; expected one of {}", similar(name)));
        };
        if metadata.causality != Causality::Parameter {
            let causality = metadata.causality;
            return Err(format!("{name} ({causality}) is not set from outside; expected one of {}", similar(name)));
        }
        let items = if metadata.kind == Kind::Enumeration { items(name).unwrap_or_default() } else { Vec::new() };
        Ok(Parameter { metadata, items })
    }

    /// Whether some variable's name begins with this name and a dot.
    pub fn is_group(name: &str) -> bool {
        VARIABLES.iter().any(|known| known.name.strip_prefix(name).is_some_and(|rest| rest.starts_with('.')))
    }

    /// A value as it stands in a table: items and truth values in words, numbers in digits that bring them back exactly.
    pub fn display(&self, value: f64) -> String {
        match self.metadata.kind {
            Kind::Boolean => (value != 0.0).to_string(),
            _ => match self.items.iter().find(|item| item.1 == value) {
                Some((name, _)) => name.clone(),
                None => value.to_string(),
            },
        }
    }

    /// Name and unit, as they stand over a column: `dimensionless.p [rad/s]`. A choice has no unit.
    pub fn heading(&self) -> String {
        let name = self.metadata.name;
        match self.metadata.kind {
            Kind::Real => format!("{name} [{}]", unit(name).unwrap_or_default()),
            Kind::Integer | Kind::Boolean | Kind::Enumeration | Kind::String => name.into(),
        }
    }

    /// The number of an item.
    pub fn item(&self, name: &str) -> Result<f64, String> {
        match self.items.iter().find(|item| item.0 == name) {
            Some((_, value)) => Ok(*value),
            None if self.items.is_empty() => {
                Err(format!("{} = \"{name}\"; expected {}", self.metadata.name, self.expected()))
            }
            None => {
                let known: Vec<&str> = self.items.iter().map(|item| item.0.as_str()).collect();
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
    VARIABLES.iter().filter(|metadata| metadata.causality == Causality::Parameter).map(|metadata| metadata.name)
}

/// The names of the same group, or all.
fn similar(name: &str) -> String {
    let group = name.split('.').next().unwrap_or_default();
    let same: Vec<&str> = names().filter(|known| known.split_once('.').is_some_and(|(of, _)| of == group)).collect();
    if same.is_empty() { names().collect::<Vec<_>>().join(", ") } else { same.join(", ") }
}

/// The unit of a Real variable.
fn unit(name: &str) -> Option<String> {
    let document = Document::parse(DESCRIPTION).ok()?;
    named(&document, "ScalarVariable", name)?.children().find_map(|node| node.attribute("unit")).map(String::from)
}

fn items(name: &str) -> Option<Vec<(String, f64)>> {
    let document = Document::parse(DESCRIPTION).ok()?;
    let variable = named(&document, "ScalarVariable", name)?;
    let declared = variable.children().find_map(|node| node.attribute("declaredType"))?;
    let items = named(&document, "SimpleType", declared)?.descendants().filter(|node| node.has_tag_name("Item"));
    items.map(|item| Some((item.attribute("name")?.to_string(), item.attribute("value")?.parse().ok()?))).collect()
}

/// The element of this kind and name.
fn named<'a>(document: &'a Document<'a>, tag: &str, name: &str) -> Option<Node<'a, 'a>> {
    document.descendants().find(|node| node.has_tag_name(tag) && node.attribute("name") == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names that are read at run time are those of the numbers that the build read.
    #[test]
    fn every_enumeration_has_the_items_of_the_code() {
        for name in names() {
            let parameter = Parameter::named(name).unwrap();
            let numbers: Vec<f64> = parameter.metadata.items.iter().map(|&item| f64::from(item)).collect();
            assert_eq!(parameter.items.iter().map(|item| item.1).collect::<Vec<_>>(), numbers, "{name}");
        }
        assert_eq!(Parameter::named("pulse.shape").unwrap().item("OneCosine"), Ok(3.0));
        assert_eq!(Parameter::named("foundation").unwrap().display(2.0), "Rigid");
        let headings =
            ["dimensionless.p", "epsilon", "foundation"].map(|name| Parameter::named(name).unwrap().heading());
        assert_eq!(headings, ["dimensionless.p [rad/s]", "epsilon [1]", "foundation"]);
    }
}
