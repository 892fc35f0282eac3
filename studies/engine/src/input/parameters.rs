//! Names and values of a study file → the variables of modelDescription.xml.

use toml::de::DeTable;

use crate::input::study_file::{SpannedValue, StudyFileError, StudyText};
use crate::output::table::TableColumn;
use crate::spec::words::friction;
use rocking_block::unit::variables::{Causality, Kind, Metadata, VARIABLES, Variable};

/// A parameter of the FMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its description in modelDescription.xml.
    pub metadata: &'static Metadata,
}

impl Parameter {
    /// Finds a parameter by its short name, `alpha`, or that in the FMU, `dimensionless.alpha`.
    ///
    ///
    ///
    /// # Errors
    /// An unknown name, with the similar ones, or a variable that is not set from outside.
    pub fn named(name: &str) -> Result<Parameter, String> {
        // Studies name their record files elsewhere.
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

    /// The name in tables, such as `alpha`. It lacks the group of the FMU where the name alone is clear.
    pub fn name(&self) -> &'static str {
        short(self.metadata.name)
    }

    /// Whether a variable's name begins with this name and a dot.
    pub fn is_group(name: &str) -> bool {
        VARIABLES.iter().any(|known| known.name.strip_prefix(name).is_some_and(|rest| rest.starts_with('.')))
    }

    /// A number of a study as that of the engine, within its limits. Only for friction without a limit do they differ.
    ///
    /// # Errors
    /// The number, with the limits.
    pub fn number(&self, found: f64) -> Result<f64, String> {
        let found = match self.metadata.variable {
            Variable::Friction => friction::of_user(found).map_err(|error| error.to_string())?,
            _ => found,
        };
        self.metadata.admits(found).map(|()| found)
    }

    /// A number of the engine as that of users.
    pub fn shown(&self, value: f64) -> f64 {
        match self.metadata.variable {
            Variable::Friction => friction::to_user(value),
            _ => value,
        }
    }

    /// A value as written in tables. Items and booleans are words, numbers have digits that restore them exactly.
    pub fn display(&self, value: f64) -> String {
        match self.metadata.kind {
            Kind::Boolean => (value != 0.0).to_string(),
            _ => match self.metadata.items.iter().find(|item| f64::from(item.0) == value) {
                Some((_, name)) => word(name),
                None => self.shown(value).to_string(),
            },
        }
    }

    /// The column of its values in the engine. Choices are words, numbers are as users see them.
    pub fn column<'c, R>(self, value: impl Fn(&R) -> f64 + Sync + 'c) -> TableColumn<'c, R> {
        let Metadata { kind, items, unit, .. } = *self.metadata;
        let name = self.name();
        match kind {
            Kind::Boolean => TableColumn::boolean(name, move |row| value(row) != 0.0),
            Kind::Enumeration => {
                let position = move |found: f64| items.iter().position(|item| f64::from(item.0) == found);
                TableColumn::choice(name, items.iter().map(|item| word(item.1)), move |row| {
                    position(value(row)).unwrap_or_else(|| unreachable!("{name} = {}", value(row)))
                })
            }
            Kind::Integer => TableColumn::count(name, move |row| value(row) as i64).with_unit(unit),
            Kind::Real | Kind::String => {
                TableColumn::real(name, "1", move |row| self.shown(value(row))).with_unit(unit)
            }
        }
    }

    /// The column heading, name and unit: `p [rad/s]`. A choice has no unit.
    pub fn heading(&self) -> String {
        let name = self.name();
        self.metadata.unit.map_or(name.into(), |unit| format!("{name} [{unit}]"))
    }

    /// The number of an item such as `one-sine`, in any case. Its name in the FMU, `OneSine`, is accepted too.
    ///
    /// # Errors
    /// An unknown word, with the known ones.
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

    /// The expected kind of value, in words.
    pub fn expected(&self) -> &'static str {
        match self.metadata.kind {
            Kind::Boolean => "true or false",
            Kind::Enumeration => "the name of an item",
            Kind::Integer => "an integer",
            Kind::Real if self.metadata.variable == Variable::Friction => "a number > 0, or \"none\" for no limit",
            Kind::Real | Kind::String => "a number",
        }
    }
}

/// Collects the parameters of a table and its groups, except keys with another meaning (`others`).
///
/// `alpha` may also be `dimensionless.alpha`: in quotes, with a dot, or in a table of its group.
pub(crate) fn flatten<'a>(
    source: StudyText,
    prefix: &str,
    table: &'a DeTable<'a>,
    others: &[&str],
    found: &mut Vec<(String, SpannedValue<'a>)>,
) -> Result<(), StudyFileError> {
    for (key, value) in table {
        if others.contains(&key.get_ref().as_ref()) {
            continue;
        }
        let name = format!("{prefix}{}", key.get_ref());
        match value.get_ref().as_table() {
            Some(group) if Parameter::is_group(&name) => flatten(source, &format!("{name}."), group, &[], found)?,
            _ => {
                let parameter = Parameter::named(&name).map_err(|message| source.wrong(&key.span(), message))?;
                if found.iter().any(|(known, _)| Parameter::named(known) == Ok(parameter)) {
                    return Err(source.wrong(&key.span(), format!("{name} is given twice; expected it once")));
                }
                found.push((name, value));
            }
        }
    }
    Ok(())
}

/// Whether two spellings name the same choice, ignoring case, hyphens and underscores.
pub fn is_same_word(one: &str, other: &str) -> bool {
    let normalized =
        |text: &str| text.chars().filter(|c| !matches!(c, '-' | '_')).flat_map(char::to_lowercase).collect::<String>();
    normalized(one) == normalized(other)
}

/// Turns the FMU's name of a choice into its word. `OneSine` becomes `one-sine`, and `C1` becomes `c1`.
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

/// Strips the group of a parameterization from a name.
fn short(name: &'static str) -> &'static str {
    ["dimensionless.", "physical."].iter().find_map(|group| name.strip_prefix(group)).unwrap_or(name)
}

fn names() -> impl Iterator<Item = &'static str> {
    let parameters = VARIABLES.iter().filter(|metadata| metadata.causality == Causality::Parameter);
    parameters.map(|metadata| short(metadata.name)).filter(|name| !name.starts_with("record."))
}

/// Lists the parameters of the same group, or all.
fn similar(name: &str) -> String {
    let group = name.split('.').next().unwrap_or_default();
    let same: Vec<&str> =
        names().filter(|known| known.split_once('.').is_some_and(|(prefix, _)| prefix == group)).collect();
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
        let expected = "expected one of none, one-sine, one-cosine, c1, c2, half-sine, rectangular, symmetric-ricker, \
                        antisymmetric-ricker, gabor";
        assert!(shape.item("two-sines").unwrap_err().ends_with(expected));
        assert_eq!(Parameter::named("foundation").unwrap().display(2.0), "rigid");
        assert_eq!(Parameter::named("alpha"), Parameter::named("dimensionless.alpha"));
        assert_eq!(Parameter::named("width"), Parameter::named("physical.width"));
        let headings =
            ["dimensionless.p", "epsilon", "foundation"].map(|name| Parameter::named(name).unwrap().heading());
        assert_eq!(headings, ["p [rad/s]", "epsilon [1]", "foundation"]);
    }
}
