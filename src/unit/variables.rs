//! Attributes of the variables in modelDescription.xml, as read by the build script.

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

/// The group of a variable. Code that handles a group handles each of its variables, or does not compile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Set by the importer at any time.
    Input(Input),
    /// A number, set by the importer before initialization ends.
    Parameter(Parameter),
    /// A number of a restraint, set by the importer before initialization ends.
    Link(Link),
    /// A text, set by the importer before initialization ends.
    Text(Text),
    /// Calculated from parameters.
    Derived(Derived),
    /// A result.
    Output(Output),
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

/// Attributes of a variable in modelDescription.xml.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metadata {
    /// The variable.
    pub variable: Variable,
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// Its causality.
    pub causality: Causality,
    /// Its group, and the variable in it.
    pub role: Role,
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

impl Metadata {
    /// Returns the attributes of the variable with this value reference, if there is one. References count from 1.
    #[inline]
    pub fn of(reference: u32) -> Option<&'static Metadata> {
        VARIABLES.get((reference as usize).wrapping_sub(1))
    }

    /// Returns its name, without the group where the name alone is clear: `alpha`, `K`, `dt`.
    pub fn short_name(&self) -> &'static str {
        let groups = ["dimensionless.", "physical.", "record."];
        groups.iter().find_map(|group| self.name.strip_prefix(group)).unwrap_or(self.name)
    }

    /// Returns the value reference of the variable.
    pub fn reference(&self) -> u32 {
        self.variable as u32 + 1
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

impl Variable {
    /// Returns the variable of a [number of the block](crate::block::BlockParameters::numbers_mut).
    pub(super) fn of_number(name: &str) -> Variable {
        let found = VARIABLES.iter().find(|metadata| metadata.short_name() == name);
        found.unwrap_or_else(|| unreachable!("{name} is in modelDescription.xml")).variable
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
pub struct Fmi3Metadata {
    /// The variable.
    pub variable: Fmi3Variable,
    /// Its name.
    pub name: &'static str,
    /// Its start value; of an array, that of each element.
    pub start: Option<f64>,
    /// Its minimum.
    pub min: Option<f64>,
    /// Its maximum.
    pub max: Option<f64>,
}

impl Fmi3Metadata {
    /// Refuses a value that is not finite or outside the limits.
    ///
    /// # Errors
    /// The value, with the limits.
    pub fn admits(&self, value: f64) -> Result<(), String> {
        within_limits(self.name, value, self.min, self.max)
    }
}

impl Fmi3Variable {
    /// Returns its attributes.
    pub fn metadata(self) -> &'static Fmi3Metadata {
        FMI3_VARIABLES
            .iter()
            .find(|metadata| metadata.variable == self)
            .unwrap_or_else(|| unreachable!("{self:?} is in modelDescription.xml"))
    }

    /// Returns its name.
    pub fn name(self) -> &'static str {
        self.metadata().name
    }
}

include!(concat!(env!("OUT_DIR"), "/variables.rs"));
