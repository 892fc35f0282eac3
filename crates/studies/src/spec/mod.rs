//! What a user says of a block, a pulse or a study → the block, the pulse, and the tables of a study's file: each parameter once, with its help, its default and the conditions under which it is read.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`words`] | choices of a user ↔ their words, the same everywhere |
//! | [`block`] | parameters, some of them given → a checked block |
//! | [`pulse`] | parameters, some of them given → a checked pulse |
//! | [`study`], [`assess`], [`fit`] | the tables of study files, of assessments and of files of tests, for readers and for [`schema`] |
//! | [`values`] | types of values that several tables have |
//! | [`schema`] | these tables → a JSON Schema, for editors |
//! | [`tie`](mod@tie) | `block_z=2,stiffness=1e5` → a tie or a damper |
//!
//! The options of the program are these structs, and Python and the page fill them in. Names in messages stand in backquotes, since each of
//! them writes them in its own way: [`SpecError::spelled`].

pub mod words;

pub mod assess;
pub mod block;
pub mod fit;
pub mod pulse;
pub mod schema;
pub mod study;
pub mod tie;
pub mod values;

pub use block::{BlockSpec, HoldSpec};
pub use pulse::{GaborSpec, PulseSpec};
pub use tie::{damper, tie};

use rocking_block::block::BlockError;

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
    /// A number out of range.
    #[error("`{parameter}` = {value}; expected {expected}")]
    OutOfRange {
        /// Its name.
        parameter: &'static str,
        /// The number.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// A parameter of the block out of range.
    #[error(transparent)]
    Invalid(#[from] BlockError),
}

impl SpecError {
    /// Returns the message with each name in backquotes, such as `K`, as `spell` writes it.
    pub fn spelled(&self, spell: impl Fn(&str) -> String) -> String {
        let text = self.to_string();
        match self {
            SpecError::NoEffect { .. } | SpecError::Lacks { .. } | SpecError::OutOfRange { .. } => text
                .split('`')
                .enumerate()
                .map(|(i, part)| if i % 2 == 1 { spell(part) } else { part.into() })
                .collect(),
            SpecError::Invalid(_) => text,
        }
    }
}

/// A parser of the words of a choice, with a line of help for each.
#[cfg(feature = "clap")]
fn choices<T: crate::spec::words::Words + Send + Sync>(
    help: impl Fn(T) -> &'static str,
) -> impl clap::builder::TypedValueParser<Value = T> {
    use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
    let values = T::WORDS.iter().map(|(word, choice)| PossibleValue::new(*word).help(help(*choice)));
    PossibleValuesParser::new(values.collect::<Vec<_>>()).try_map(|word| T::named(&word).ok_or("expected a known word"))
}
