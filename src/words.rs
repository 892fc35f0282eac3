//! A user's choices ↔ their words, the same on the command line, in study files, tables, messages and Python.

use std::fmt;

use crate::block::Foundation;
use crate::excitation::{Pulse, PulseShape};
use crate::simulation::{OnOverturning, OnSeparation};

/// A choice with a word for each value.
pub trait Words: Copy + PartialEq + 'static {
    /// All values with their words, in lower case with hyphens.
    const WORDS: &'static [(&'static str, Self)];

    /// Returns the word of a value.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, value)| *value == self).map_or("", |(word, _)| word)
    }

    /// Returns the value of a word in any case.
    fn named(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word)).map(|(_, value)| *value)
    }
}

impl Words for Foundation {
    const WORDS: &'static [(&'static str, Foundation)] =
        &[("viscoelastic", Foundation::Viscoelastic), ("rigid", Foundation::Rigid)];
}

impl Words for PulseShape {
    const WORDS: &'static [(&'static str, PulseShape)] = &[
        ("none", PulseShape::None),
        ("one-sine", PulseShape::OneSine),
        ("one-cosine", PulseShape::OneCosine),
        ("c1", PulseShape::C1),
        ("c2", PulseShape::C2),
        ("half-sine", PulseShape::HalfSine),
        ("rectangular", PulseShape::Rectangular),
        ("symmetric-ricker", PulseShape::SymmetricRicker),
        ("antisymmetric-ricker", PulseShape::AntisymmetricRicker),
        ("gabor", PulseShape::Gabor),
    ];
}

/// The shape and the numbers of a pulse, without its start.
impl fmt::Display for Pulse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Pulse { shape, amplitude, period, phase, cycles, .. } = self;
        write!(f, "{} pulse, a_p = {amplitude} m/s², T_p = {period} s", shape.word())?;
        match shape {
            PulseShape::Gabor => write!(f, ", ν = {phase} rad, γ = {cycles}"),
            _ => Ok(()),
        }
    }
}

impl Words for OnSeparation {
    const WORDS: &'static [(&'static str, OnSeparation)] =
        &[("terminate", OnSeparation::Terminate), ("hold", OnSeparation::Hold), ("fly", OnSeparation::Fly)];
}

impl Words for OnOverturning {
    const WORDS: &'static [(&'static str, OnOverturning)] =
        &[("terminate", OnOverturning::Terminate), ("hold", OnOverturning::Hold)];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::variables::{VARIABLES, Variable};

    /// Compares the words of a choice with the items of its variable in modelDescription.xml.
    fn assert_described<T: Words>(variable: Variable, number: fn(T) -> i32) {
        let described = VARIABLES.iter().find(|metadata| metadata.variable == variable).unwrap();
        let bare = |word: &str| word.replace('-', "").to_lowercase();
        let items: Vec<_> = described.items.iter().map(|(number, name)| (*number, bare(name))).collect();
        let words: Vec<_> = T::WORDS.iter().map(|(word, value)| (number(*value), bare(word))).collect();
        assert_eq!(items, words);
        assert!(T::WORDS.iter().all(|(word, value)| value.word() == *word));
        assert!(T::WORDS.iter().all(|(word, value)| T::named(&word.to_uppercase()) == Some(*value)));
        assert!(T::named("otherwise").is_none());
    }

    #[test]
    fn choices_are_those_of_the_model_description() {
        assert_described(Variable::Foundation, |foundation: Foundation| foundation as i32);
        assert_described(Variable::PulseShape, |shape: PulseShape| shape as i32);
        assert_described(Variable::OnSeparation, |on_separation: OnSeparation| on_separation as i32);
        assert_described(Variable::OnOverturning, |on_overturning: OnOverturning| on_overturning as i32);
    }
}
