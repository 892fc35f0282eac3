//! What modelDescription.xml says of each variable, as the build read it.

/// Base type of a variable. What is an enumeration in modelDescription.xml is an Integer in FMI 2.0.
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
    /// The kind by whose functions it is read and set.
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

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set from outside at any time.
    Input,
    /// Set from outside before initialization ends.
    Parameter,
    /// Follows from parameters.
    CalculatedParameter,
    /// Put out.
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
    /// One of its variables, in a sentence.
    pub fn one(self) -> &'static str {
        match self {
            Causality::Input => "an input",
            Causality::Parameter => "a parameter",
            Causality::CalculatedParameter => "a calculated parameter",
            Causality::Output => "an output",
        }
    }
}

/// The part to which a variable belongs. Who handles a part handles each of its variables, or does not compile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Set from outside at any time.
    Input(Input),
    /// A number, set from outside before initialization ends.
    Parameter(Parameter),
    /// A text, set from outside before initialization ends.
    Text(Text),
    /// Follows from parameters.
    Derived(Derived),
    /// Put out.
    Output(Output),
}

/// The items of an enumeration.
pub trait Choice: Copy + 'static {
    /// All items.
    const ALL: &'static [Self];

    /// The number of an item.
    fn number(self) -> i32;

    /// The item of a number, if it has one.
    fn of(value: f64) -> Option<Self> {
        Self::ALL.iter().copied().find(|item| f64::from(item.number()) == value)
    }
}

/// When a variable changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// At all times.
    Continuous,
    /// At events.
    Discrete,
    /// Not after initialization.
    Fixed,
}

/// What modelDescription.xml says of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metadata {
    /// The variable.
    pub variable: Variable,
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: Kind,
    /// What it is for.
    pub causality: Causality,
    /// The same, with the variable among those of its part.
    pub role: Role,
    /// When it changes.
    pub variability: Variability,
    /// Its unit, if it is Real.
    pub unit: Option<&'static str>,
    /// Its start value, with 0 and 1 for false and true.
    pub start: Option<f64>,
    /// Its least value.
    pub min: Option<f64>,
    /// Its greatest value.
    pub max: Option<f64>,
    /// The choices of an enumeration: values and names.
    pub items: &'static [(i32, &'static str)],
}

impl Metadata {
    /// Whether it can be set from outside at all.
    pub fn is_settable(&self) -> bool {
        matches!(self.causality, Causality::Input | Causality::Parameter)
    }

    /// Refuses values that are not finite or outside the limits, with a sentence that names them.
    pub fn admits(&self, value: f64) -> Result<(), String> {
        let (name, min, max) = (self.name, self.min, self.max);
        if self.kind == Kind::Enumeration {
            if self.items.iter().any(|&(item, _)| f64::from(item) == value) {
                return Ok(());
            }
            let choices: Vec<String> = self.items.iter().map(|(value, name)| format!("{value} {name}")).collect();
            return Err(format!("{name} = {value}; expected one of {}", choices.join(", ")));
        }
        within_limits(name, value, min, max)
    }
}

/// Refuses values that are not finite or outside the limits, with a sentence that names them.
fn within_limits(name: &str, value: f64, min: Option<f64>, max: Option<f64>) -> Result<(), String> {
    if value.is_finite() && min.is_none_or(|min| value >= min) && max.is_none_or(|max| value <= max) {
        return Ok(());
    }
    // All digits of 1e300 are no help.
    let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite();
    let value = if plain { format!("{value}") } else { format!("{value:e}") };
    Err(match (min, max) {
        (Some(min), Some(max)) => format!("{name} = {value}; expected {min} to {max}"),
        (Some(min), None) => format!("{name} = {value}; expected at least {min}"),
        (None, Some(max)) => format!("{name} = {value}; expected at most {max}"),
        (None, None) => format!("{name} = {value}; expected a finite number"),
    })
}

impl Fmi3Only {
    /// Refuses values that are not finite or outside the limits, with a sentence that names them.
    pub fn admits(self, value: f64) -> Result<(), String> {
        within_limits(self.name(), value, self.min(), self.max())
    }
}

include!(concat!(env!("OUT_DIR"), "/variables.rs"));
