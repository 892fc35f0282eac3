//! The variables of modelDescription.xml, as read by the build script.

pub use crate::unit::attributes::{Attributes, Causality, Choice, Fmi3Attributes, Kind, Variability};

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

/// Attributes of a variable in modelDescription.xml.
pub type Metadata = Attributes<Variable, Role>;

impl Metadata {
    /// Returns the attributes of the variable with this value reference, if there is one. References count from 1.
    #[inline]
    pub fn of(reference: u32) -> Option<&'static Metadata> {
        VARIABLES.get((reference as usize).wrapping_sub(1))
    }

    /// Returns the value reference of the variable.
    pub fn reference(&self) -> u32 {
        self.variable as u32 + 1
    }
}

/// Attributes of a variable that only FMI 3.0 has.
pub type Fmi3Metadata = Fmi3Attributes<Fmi3Variable>;

impl Variable {
    /// Returns the variable of a [number of the block](crate::block::BlockParameters::numbers_mut).
    pub(super) fn of_number(name: &str) -> Variable {
        let found = VARIABLES.iter().find(|metadata| metadata.short_name() == name);
        found.unwrap_or_else(|| unreachable!("{name} is in modelDescription.xml")).variable
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
