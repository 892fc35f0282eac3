//! Names and values of a study file → the variables of modelDescription.xml, or the numbers of a block in space.

use std::borrow::Cow;

use toml::de::DeTable;

use crate::input::study_file::{SpannedValue, StudyFileError, StudyText};
use crate::output::table::TableColumn;
use crate::spec::limits;
use crate::spec::numbers_in_space::{self, SpaceNumber};
use crate::spec::space::{INSTEAD_OF_RIGID, OF_PLANE};
use crate::spec::words::friction;
use rocking_block::unit::variables::{Causality, Kind, Metadata, VARIABLES, Variable};

/// The bodies whose parameters a study may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vocabulary {
    /// A block in the plane: the variables of modelDescription.xml.
    Plane,
    /// A block in space: its numbers and those of its beginning; the pulse and `on_separation` as in the plane.
    Space,
}

impl Vocabulary {
    /// Finds a parameter by its short name, `alpha`, or that in the FMU, `dimensionless.alpha`.
    ///
    /// # Errors
    /// An unknown name, with the similar ones, or a variable that is not set from outside.
    pub fn parameter(self, name: &str) -> Result<Parameter, String> {
        match self {
            Vocabulary::Plane => Parameter::named(name),
            Vocabulary::Space => Parameter::in_space(name),
        }
    }
}

/// A parameter of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    of: Of,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Of {
    /// A variable of modelDescription.xml.
    Variable(&'static Metadata),
    /// A number of a block in space.
    Space(&'static SpaceNumber),
}

impl From<&'static Metadata> for Parameter {
    fn from(metadata: &'static Metadata) -> Parameter {
        Parameter { of: Of::Variable(metadata) }
    }
}

impl From<&'static SpaceNumber> for Parameter {
    fn from(number: &'static SpaceNumber) -> Parameter {
        Parameter { of: Of::Space(number) }
    }
}

impl Parameter {
    /// Finds a parameter of the plane by its short name, `alpha`, or that in the FMU, `dimensionless.alpha`.
    ///
    /// # Errors
    /// Those of [`Vocabulary::parameter`].
    pub fn named(name: &str) -> Result<Parameter, String> {
        // Studies name their record files elsewhere.
        let known = VARIABLES.iter().filter(|metadata| !metadata.name.starts_with("record."));
        let known = known.clone().find(|metadata| metadata.name == name).or_else(|| {
            let parameters = |metadata: &&Metadata| metadata.causality == Causality::Parameter;
            known.clone().filter(parameters).find(|metadata| short(metadata.name) == name)
        });
        let Some(metadata) = known else {
            let in_space = numbers_in_space::numbers().iter().any(|number| number.name == short(name));
            let message = match in_space || name == "inertia_tensor" {
                true => format!("{name} is for a block in space; expected depth, depth_ratio, base or feet beside it"),
                false => format!("there is no parameter {name}; expected one of {}", similar(name)),
            };
            return Err(message);
        };
        if metadata.causality != Causality::Parameter {
            let causality = metadata.causality;
            return Err(format!("{name} ({causality}) is not set from outside; expected one of {}", similar(name)));
        }
        Ok(metadata.into())
    }

    /// Finds a parameter of a block in space.
    fn in_space(name: &str) -> Result<Parameter, String> {
        let numbers = numbers_in_space::numbers();
        let bare = short(name);
        if let Some(number) = numbers.iter().find(|number| number.name == bare) {
            return Ok(number.into());
        }
        let shared =
            |metadata: &Metadata| metadata.variable == Variable::OnSeparation || metadata.name.starts_with("pulse.");
        let instead = match OF_PLANE.into_iter().find(|(known, _)| *known == bare) {
            Some((_, instead)) => instead.replace('`', ""),
            None if bare == "foundation" => INSTEAD_OF_RIGID.replace('`', ""),
            None => {
                "a block in space has depth, depth_ratio, base or feet in [parameters]; expected it without them".into()
            }
        };
        match Parameter::named(name) {
            Ok(Parameter { of: Of::Variable(metadata) }) if shared(metadata) => Ok(metadata.into()),
            Ok(_) => Err(format!("{name} is for a block in the plane; {instead}")),
            Err(_) => {
                let known: Vec<&str> = numbers.iter().map(|number| number.name).collect();
                Err(format!(
                    "there is no parameter {name} of a block in space; expected base, feet, inertia_tensor, on_separation, \
                     pulse.shape, pulse.amplitude, pulse.period, pulse.start, pulse.phase, pulse.cycles or one of {}",
                    known.join(", ")
                ))
            }
        }
    }

    /// The name in tables, such as `alpha`. It lacks the group of the FMU where the name alone is clear.
    pub fn name(&self) -> &'static str {
        short(self.full_name())
    }

    /// The name with its group, such as `dimensionless.alpha`.
    pub fn full_name(&self) -> &'static str {
        match self.of {
            Of::Variable(metadata) => metadata.name,
            Of::Space(number) => number.name,
        }
    }

    /// The variable of modelDescription.xml; `None` for a number of a block in space.
    pub fn variable(&self) -> Option<Variable> {
        match self.of {
            Of::Variable(metadata) => Some(metadata.variable),
            Of::Space(_) => None,
        }
    }

    /// The number of a block in space, if it is one.
    pub fn in_space_number(&self) -> Option<&'static SpaceNumber> {
        match self.of {
            Of::Variable(_) => None,
            Of::Space(number) => Some(number),
        }
    }

    /// The type of its values.
    pub fn kind(&self) -> Kind {
        match self.of {
            Of::Variable(metadata) => metadata.kind,
            Of::Space(_) => Kind::Real,
        }
    }

    /// Its unit, if it is a number.
    pub fn unit(&self) -> Option<&'static str> {
        match self.of {
            Of::Variable(metadata) => metadata.unit,
            Of::Space(number) => Some(&number.unit),
        }
    }

    /// The items of a choice with their numbers.
    fn items(&self) -> &'static [(i32, &'static str)] {
        match self.of {
            Of::Variable(metadata) => metadata.items,
            Of::Space(_) => &[],
        }
    }

    /// Whether its values are words.
    pub fn is_choice(&self) -> bool {
        !self.items().is_empty()
    }

    /// Whether it is the friction of the feet, which may have no limit.
    pub fn is_friction(&self) -> bool {
        self.name() == "friction"
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
        match self.of {
            Of::Variable(metadata) => {
                let found = match metadata.variable {
                    Variable::Friction => friction::of_user(found).map_err(|error| error.to_string())?,
                    _ => found,
                };
                metadata.admits(found).map(|()| found)
            }
            // Specifications have the friction of users.
            Of::Space(_) if self.is_friction() && found == f64::INFINITY => Ok(found),
            Of::Space(number) if limits::admits(&number.schema, found) => Ok(found),
            Of::Space(number) => {
                Err(format!("{} = {found}; expected {}", number.name, limits::expected(&number.schema)))
            }
        }
    }

    /// A number of the engine as that of users.
    pub fn shown(&self, value: f64) -> f64 {
        match self.variable() {
            Some(Variable::Friction) => friction::to_user(value),
            _ => value,
        }
    }

    /// A value as written in tables. Items and booleans are words, numbers have digits that restore them exactly.
    pub fn display(&self, value: f64) -> String {
        match self.kind() {
            Kind::Boolean => (value != 0.0).to_string(),
            _ => match self.items().iter().find(|item| f64::from(item.0) == value) {
                Some((_, name)) => word(name),
                None => self.shown(value).to_string(),
            },
        }
    }

    /// The column of its values in the engine. Choices are words, numbers are as users see them.
    pub fn column<'c, R>(self, value: impl Fn(&R) -> f64 + Sync + 'c) -> TableColumn<'c, R> {
        let (kind, items, unit, name) = (self.kind(), self.items(), self.unit(), self.name());
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
        self.unit().map_or(name.into(), |unit| format!("{name} [{unit}]"))
    }

    /// The number of an item such as `one-sine`, in any case. Its name in the FMU, `OneSine`, is accepted too.
    ///
    /// # Errors
    /// An unknown word, with the known ones.
    pub fn item(&self, name: &str) -> Result<f64, String> {
        let items = self.items();
        match items.iter().find(|item| is_same_word(item.1, name)) {
            Some((value, _)) => Ok(f64::from(*value)),
            None if items.is_empty() => Err(format!("{} = \"{name}\"; expected {}", self.full_name(), self.expected())),
            None => {
                let known: Vec<String> = items.iter().map(|item| word(item.1)).collect();
                Err(format!("{} = \"{name}\"; expected one of {}", self.full_name(), known.join(", ")))
            }
        }
    }

    /// The expected kind of value, in words.
    pub fn expected(&self) -> Cow<'static, str> {
        match (self.kind(), self.of) {
            (Kind::Boolean, _) => "true or false".into(),
            (Kind::Enumeration, _) => "the name of an item".into(),
            (Kind::Integer, _) => "an integer".into(),
            (Kind::Real, _) if self.is_friction() => "a number > 0, or \"none\" for no limit".into(),
            (Kind::Real, Of::Space(number)) => limits::expected(&number.schema).into(),
            (Kind::Real | Kind::String, _) => "a number".into(),
        }
    }
}

/// Collects the parameters of a table and its groups, except keys with another meaning (`others`).
///
/// `alpha` may also be `dimensionless.alpha`: in quotes, with a dot, or in a table of its group.
pub(crate) fn flatten<'a>(
    source: StudyText,
    vocabulary: Vocabulary,
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
            Some(group) if Parameter::is_group(&name) => {
                flatten(source, vocabulary, &format!("{name}."), group, &[], found)?
            }
            _ => {
                let parameter = vocabulary.parameter(&name).map_err(|message| source.wrong(&key.span(), message))?;
                if found.iter().any(|(known, _)| vocabulary.parameter(known) == Ok(parameter)) {
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
fn short(name: &str) -> &str {
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
