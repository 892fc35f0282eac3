//! The variables of modelDescriptionInSpace.xml, as read by the build script.

use crate::excitation::Ramp;
use crate::space::SpaceInputs;
pub use crate::unit::attributes::{Attributes, Causality, Choice, Fmi3Attributes, Kind, Variability};

/// The group of a variable. Code that handles a group handles each of its variables, or does not compile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Set by the importer at any time.
    Input(Input),
    /// A number, set by the importer before initialization ends.
    Parameter(Parameter),
    /// A text, set by the importer before initialization ends.
    Text(Text),
    /// Calculated from parameters.
    Derived(Derived),
    /// A result.
    Output(Output),
}

/// Attributes of a variable in modelDescriptionInSpace.xml.
pub type Metadata = Attributes<Variable, Role>;

/// Attributes of a variable that only FMI 3.0 has.
pub type Fmi3Metadata = Fmi3Attributes<Fmi3Variable>;

impl Metadata {
    /// Returns the attributes of the variable with this value reference, if there is one. References count from 1.
    #[inline]
    pub fn of(reference: u32) -> Option<&'static Metadata> {
        VARIABLES.get((reference as usize).wrapping_sub(1))
    }
}

impl Variable {
    /// Returns its attributes.
    pub fn metadata(self) -> &'static Metadata {
        &VARIABLES[self as usize]
    }

    /// Returns its name.
    pub fn name(self) -> &'static str {
        self.metadata().name
    }
}

/// Returns the attributes of a variable that only FMI 3.0 has.
pub fn fmi3_metadata(variable: Fmi3Variable) -> &'static Fmi3Metadata {
    FMI3_VARIABLES
        .iter()
        .find(|metadata| metadata.variable == variable)
        .unwrap_or_else(|| unreachable!("{variable:?} is in modelDescriptionInSpace.xml"))
}

impl Input {
    /// Returns its ramp.
    pub fn of(self, inputs: &mut SpaceInputs) -> &mut Ramp {
        let SpaceInputs { ground, force, moment, .. } = inputs;
        match self {
            Input::AGx => &mut ground[0],
            Input::AGy => &mut ground[1],
            Input::AGz => &mut ground[2],
            Input::FX => &mut force[0],
            Input::FY => &mut force[1],
            Input::FZ => &mut force[2],
            Input::MX => &mut moment[0],
            Input::MY => &mut moment[1],
            Input::MZ => &mut moment[2],
        }
    }
}

include!(concat!(env!("OUT_DIR"), "/variables_in_space.rs"));
