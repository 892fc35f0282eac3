//! Attributes of variables, for all units: types, causalities, limits.

use crate::unit::fault::Fault;
use crate::unit::life_cycle::Phase;

/// Base type of a variable. An enumeration of modelDescription.xml is an Integer in FMI 2.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A real number.
    Real,
    /// An integer.
    Integer,
    /// True or false.
    Boolean,
    /// An item of an enumeration.
    Enumeration,
    /// A text.
    String,
}

impl Kind {
    /// Returns the type whose functions read and set the variable.
    pub fn base(self) -> Kind {
        match self {
            Kind::Enumeration => Kind::Integer,
            Kind::Real | Kind::Integer | Kind::Boolean | Kind::String => self,
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Kind::Real => "Real",
            Kind::Integer | Kind::Enumeration => "Integer",
            Kind::Boolean => "Boolean",
            Kind::String => "String",
        })
    }
}

/// Causality of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set by the importer at any time.
    Input,
    /// Set by the importer before initialization ends.
    Parameter,
    /// Calculated from parameters.
    CalculatedParameter,
    /// A result.
    Output,
}

impl std::fmt::Display for Causality {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Causality::Input => "input",
            Causality::Parameter => "parameter",
            Causality::CalculatedParameter => "calculated parameter",
            Causality::Output => "output",
        })
    }
}

impl Causality {
    /// Returns the words for one such variable in a sentence.
    pub fn one(self) -> &'static str {
        match self {
            Causality::Input => "an input",
            Causality::Parameter => "a parameter",
            Causality::CalculatedParameter => "a calculated parameter",
            Causality::Output => "an output",
        }
    }
}

/// The items of an enumeration.
pub trait Choice: Copy + 'static {
    /// All items.
    const ALL: &'static [Self];

    /// Returns the number of an item.
    fn number(self) -> i32;

    /// Returns the item with this number, if there is one.
    fn of(value: f64) -> Option<Self> {
        Self::ALL.iter().copied().find(|item| f64::from(item.number()) == value)
    }
}

/// Variability of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// Changes at all times.
    Continuous,
    /// Changes at events.
    Discrete,
    /// Does not change after initialization.
    Fixed,
}

/// Attributes of a variable in the description of a unit. `V` are its variables, `R` their groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attributes<V, R> {
    /// The variable.
    pub variable: V,
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// Its causality.
    pub causality: Causality,
    /// Its group, and the variable in it.
    pub role: R,
    /// Its variability.
    pub variability: Variability,
    /// Its unit, if it is Real.
    pub unit: Option<&'static str>,
    /// Its start value; 0 and 1 for false and true.
    pub start: Option<f64>,
    /// Its minimum.
    pub min: Option<f64>,
    /// Its maximum.
    pub max: Option<f64>,
    /// The choices of an enumeration: values and names.
    pub items: &'static [(i32, &'static str)],
}

impl<V, R> Attributes<V, R> {
    /// Returns its name, without the group where the name alone is clear: `alpha`, `K`, `dt`.
    pub fn short_name(&self) -> &'static str {
        let groups = ["dimensionless.", "physical.", "record."];
        groups.iter().find_map(|group| self.name.strip_prefix(group)).unwrap_or(self.name)
    }

    /// Returns the part that the C interfaces need.
    pub fn known(&self) -> Known {
        let &Attributes { name, kind, causality, variability, .. } = self;
        Known { name, kind, causality, variability, of_fmi3: false, is_size: false }
    }

    /// Whether the importer can set it.
    pub fn is_settable(&self) -> bool {
        matches!(self.causality, Causality::Input | Causality::Parameter)
    }

    /// Refuses a value that is not finite or outside the limits.
    ///
    /// # Errors
    /// The value, with the limits.
    #[inline]
    pub fn admits(&self, value: f64) -> Result<(), String> {
        match self.kind {
            Kind::Enumeration => self.is_item(value),
            Kind::Real | Kind::Integer | Kind::Boolean | Kind::String => {
                within_limits(self.name, value, self.min, self.max)
            }
        }
    }

    /// Refuses a value that is no item of the enumeration; the error names the items.
    fn is_item(&self, value: f64) -> Result<(), String> {
        if self.items.iter().any(|&(item, _)| f64::from(item) == value) {
            return Ok(());
        }
        let choices: Vec<String> = self.items.iter().map(|(value, name)| format!("{value} {name}")).collect();
        Err(format!("{} = {value}; expected one of {}", self.name, choices.join(", ")))
    }
}

/// Refuses a value that is not finite or outside the limits. The error names them.
#[inline]
fn within_limits(name: &str, value: f64, min: Option<f64>, max: Option<f64>) -> Result<(), String> {
    if value.is_finite() && min.is_none_or(|min| value >= min) && max.is_none_or(|max| value <= max) {
        return Ok(());
    }
    Err(outside_limits(name, value, min, max))
}

/// Returns the message of [`within_limits`].
#[cold]
fn outside_limits(name: &str, value: f64, min: Option<f64>, max: Option<f64>) -> String {
    // A long decimal such as that of 1e300 would not help.
    let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite();
    let value = if plain { format!("{value}") } else { format!("{value:e}") };
    match (min, max) {
        (Some(min), Some(max)) => format!("{name} = {value}; expected {min} to {max}"),
        (Some(min), None) => format!("{name} = {value}; expected at least {min}"),
        (None, Some(max)) => format!("{name} = {value}; expected at most {max}"),
        (None, None) => format!("{name} = {value}; expected a finite number"),
    }
}

/// Attributes of a variable that only FMI 3.0 has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fmi3Attributes<V> {
    /// The variable.
    pub variable: V,
    /// Its name.
    pub name: &'static str,
    /// Its start value; of an array, that of each element.
    pub start: Option<f64>,
    /// Its minimum.
    pub min: Option<f64>,
    /// Its maximum.
    pub max: Option<f64>,
}

impl<V> Fmi3Attributes<V> {
    /// Refuses a value that is not finite or outside the limits.
    ///
    /// # Errors
    /// The value, with the limits.
    pub fn admits(&self, value: f64) -> Result<(), String> {
        within_limits(self.name, value, self.min, self.max)
    }
}

/// The part of a variable's attributes that the C interfaces need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// Its causality.
    pub causality: Causality,
    /// Its variability.
    pub variability: Variability,
    /// Whether only FMI 3.0 has it.
    pub of_fmi3: bool,
    /// Whether it is the size of arrays, a UInt64.
    pub is_size: bool,
}

impl Known {
    /// Returns a Float64 that only FMI 3.0 has, or a size of arrays.
    pub fn of_fmi3(name: &'static str, is_size: bool) -> Known {
        let kind = if is_size { Kind::Integer } else { Kind::Real };
        Known { name, kind, causality: Causality::Parameter, variability: Variability::Fixed, of_fmi3: true, is_size }
    }
}

/// Returns the variable with this value reference, if it has this type.
#[inline(always)]
pub(super) fn find<V, R>(
    variables: &'static [Attributes<V, R>],
    reference: u32,
    kind: Kind,
) -> Result<&'static Attributes<V, R>, Fault> {
    // References count from 1.
    match variables.get((reference as usize).wrapping_sub(1)) {
        Some(found) if found.kind.base() == kind => Ok(found),
        other => Err(unknown(reference, kind, other.map(|found| (found.name, found.kind)), variables.len())),
    }
}

/// Returns the refusal of a value reference that is of no variable of this type.
#[cold]
#[inline(never)]
fn unknown(reference: u32, kind: Kind, found: Option<(&str, Kind)>, count: usize) -> Fault {
    Fault::new(match found {
        Some((name, found)) => format!("{name} (value reference {reference}) is of type {found}; expected {kind}"),
        None => format!("value reference {reference} does not exist; expected 1 to {count}"),
    })
}

impl<V, R> Attributes<V, R> {
    /// Refuses a variable that cannot be set in this state.
    #[inline]
    pub(super) fn settable(&self, phase: Phase) -> Result<(), Fault> {
        let Attributes { name, causality, variability, .. } = self;
        if !self.is_settable() {
            return Err(Fault::new(format!("{name} is {}; expected an input or a parameter to set", causality.one())));
        }
        if phase.is_initialized() && *variability == Variability::Fixed {
            return Err(Fault::new(format!(
                "{name} is a fixed parameter; expected it to be set before initialization ends"
            )));
        }
        Ok(())
    }
}
