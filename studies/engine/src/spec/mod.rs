//! What a user says of a block, a pulse or a study → the block, the pulse, and the tables of a study's file: each parameter once, with its help, its default and the conditions under which it is read.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`words`] | choices of a user ↔ their words, the same everywhere |
//! | [`block`] | parameters, some of them given → a checked block |
//! | [`space`] | parameters of a block in space beside those of the plane → its parameters |
//! | [`numbers_in_space`] | the numbers of a block in space and of its beginning, by the names that studies give them |
//! | [`pulse`] | parameters, some of them given → a checked pulse |
//! | [`run`] | settings of the runs of a study, some of them given → the settings of the solver |
//! | [`records`] | what is known of accelerogram files → the options of their reader |
//! | [`study`], [`assess`], [`fit`] | the tables of study files, of assessments and of files of tests, for readers and for [`schema`] |
//! | [`values`] | types of values that several tables have |
//! | [`command`] | a block → the options of a command line with the same numbers |
//! | [`limits`] | the JSON Schema of a value → the accepted values in words, and whether a number is one of them |
//! | [`schema`] | these tables → a JSON Schema, for editors and readers |
//! | [`tie`](mod@tie) | `block_z=2,stiffness=1e5` → a tie or a damper |
//!
//! The options of the program are these structs, and Python and the page fill them in. Names in messages stand in backquotes, since each of
//! them writes them in its own way: [`SpecError::spelled`].

pub mod words;

pub mod assess;
pub mod block;
pub mod command;
pub mod fit;
pub mod limits;
pub mod numbers_in_space;
pub mod pulse;
pub mod records;
pub mod run;
pub mod schema;
pub mod space;
pub mod study;
pub mod tie;
pub mod values;

pub use block::{BlockSpec, HoldSpec};
pub use pulse::{GaborSpec, PulseSpec};
pub use records::{ReadingSpec, RecordSpec};
pub use run::{RunSpec, SingleRunSpec};
pub use space::SpaceSpec;
pub use tie::{damper, tie};

use std::borrow::Cow;

use rocking_block::block::BlockError;
use rocking_block::space::SpaceError;

/// Returns a name as an option of the program, without its dashes. `foundation = rigid` has its value.
pub fn option(name: &str) -> String {
    match name {
        "K" => "stiffness".into(),
        "C" => "damping".into(),
        "ties" => "tie".into(),
        "dampers" => "damper".into(),
        name => name.replace(" = ", " ").replace('_', "-"),
    }
}

/// Why a specification does not make a block or a pulse.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// A parameter that would not be read.
    #[error("`{parameter}` has no effect {why}")]
    NoEffect {
        /// Its name.
        parameter: &'static str,
        /// What precludes it.
        why: &'static str,
    },
    /// A parameter that needs another one.
    #[error("`{parameter}` without {missing}")]
    Lacks {
        /// Its name.
        parameter: &'static str,
        /// What is missing, and what is expected.
        missing: &'static str,
    },
    /// A parameter of blocks in the plane, given for one in space.
    #[error("`{parameter}` is for a block in the plane; {instead}")]
    OfPlane {
        /// Its name.
        parameter: &'static str,
        /// What is expected instead.
        instead: &'static str,
    },
    /// A number out of range.
    #[error("`{parameter}` = {value}; expected {expected}")]
    OutOfRange {
        /// Its name.
        parameter: Cow<'static, str>,
        /// The number.
        value: f64,
        /// The range.
        expected: Cow<'static, str>,
    },
    /// A text that is not one of its kind.
    #[error("{message}")]
    Unreadable {
        /// The name of the parameter.
        parameter: Cow<'static, str>,
        /// The fault and the expected text.
        message: String,
    },
    /// A parameter of the block out of range.
    #[error(transparent)]
    Invalid(#[from] BlockError),
    /// A block in space that cannot be.
    #[error(transparent)]
    InSpace(#[from] SpaceError),
}

impl SpecError {
    /// Returns the name of the parameter, if the error is that of one.
    pub fn parameter(&self) -> Option<&str> {
        match self {
            SpecError::NoEffect { parameter, .. }
            | SpecError::Lacks { parameter, .. }
            | SpecError::OfPlane { parameter, .. } => Some(parameter),
            SpecError::OutOfRange { parameter, .. } | SpecError::Unreadable { parameter, .. } => Some(parameter),
            SpecError::Invalid(_) | SpecError::InSpace(_) => None,
        }
    }

    /// Returns the error of a parameter whose name has this prefix.
    fn with_prefix(self, prefix: &str) -> SpecError {
        let mut error = self;
        if let SpecError::OutOfRange { parameter, .. } | SpecError::Unreadable { parameter, .. } = &mut error {
            *parameter = format!("{prefix}{parameter}").into();
        }
        error
    }

    /// Returns the message with each name in backquotes, such as `K`, as `spell` writes it.
    pub fn spelled(&self, spell: impl Fn(&str) -> String) -> String {
        let text = self.to_string();
        match self {
            SpecError::NoEffect { .. }
            | SpecError::Lacks { .. }
            | SpecError::OfPlane { .. }
            | SpecError::OutOfRange { .. } => text
                .split('`')
                .enumerate()
                .map(|(i, part)| if i % 2 == 1 { spell(part) } else { part.into() })
                .collect(),
            SpecError::Unreadable { parameter, .. } => format!("{}: {text}", spell(parameter)),
            SpecError::Invalid(_) | SpecError::InSpace(_) => text,
        }
    }
}

/// Returns a parser of the words of these choices, with a line of help for each.
#[cfg(feature = "clap")]
pub fn choice<T: crate::spec::words::Words + Send + Sync>(
    values: &[(T, &'static str)],
) -> impl clap::builder::TypedValueParser<Value = T> + use<T> {
    use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
    let words = values.iter().map(|(value, help)| PossibleValue::new(value.word()).help(*help));
    PossibleValuesParser::new(words.collect::<Vec<_>>()).try_map(|word| T::named(&word).ok_or("expected a known word"))
}

/// Returns a parser of all words of a choice.
#[cfg(feature = "clap")]
fn choices<T: crate::spec::words::Words + Send + Sync>(
    help: impl Fn(T) -> &'static str,
) -> impl clap::builder::TypedValueParser<Value = T> {
    choice(&T::WORDS.iter().map(|(_, value)| (*value, help(*value))).collect::<Vec<_>>())
}
