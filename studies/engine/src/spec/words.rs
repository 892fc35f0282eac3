//! A user's choices ↔ their words, the same on the command line, in study files, tables, messages and Python.

use rocking_block::block::{Corner, Foundation};
use rocking_block::excitation::PulseShape;
use rocking_block::simulation::{OnOverturning, OnSeparation};

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

impl Words for Corner {
    const WORDS: &'static [(&'static str, Corner)] = &[("left", Corner::Left), ("right", Corner::Right)];
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

impl Words for OnSeparation {
    const WORDS: &'static [(&'static str, OnSeparation)] =
        &[("terminate", OnSeparation::Terminate), ("hold", OnSeparation::Hold), ("fly", OnSeparation::Fly)];
}

impl Words for OnOverturning {
    const WORDS: &'static [(&'static str, OnOverturning)] =
        &[("terminate", OnOverturning::Terminate), ("hold", OnOverturning::Hold)];
}

/// The friction of the feet as users write it. It is a coefficient μ > 0, or infinity for no limit, which a block stores as 0.
pub mod friction {
    use rocking_block::block::BlockError;

    /// The word for no limit.
    pub const NONE: &str = "none";

    /// Returns the number of a block. Zero is refused: it could mean either no limit or no friction.
    ///
    /// # Errors
    /// A friction that is not above 0.
    pub fn of_user(friction: f64) -> Result<f64, BlockError> {
        const EXPECTED: &str = "a number > 0, or none (inf) for no limit; feet without any friction cannot rock";
        match friction {
            f64::INFINITY => Ok(0.0),
            friction if friction > 0.0 => Ok(friction),
            value => Err(BlockError::OutOfRange { name: "friction".into(), value, expected: EXPECTED }),
        }
    }

    /// Reads a number or [`NONE`], in any case.
    ///
    /// # Errors
    /// A text that is neither a number above 0 nor [`NONE`].
    pub fn parse(text: &str) -> Result<f64, String> {
        let found = if text.eq_ignore_ascii_case(NONE) { Ok(f64::INFINITY) } else { text.parse() };
        let found = found.map_err(|_| format!("found `{text}`; expected a number > 0, or {NONE} for no limit"))?;
        of_user(found).map_err(|error| error.to_string())
    }

    /// Returns the number that users see for that of a block. Infinity sorts after all limits.
    pub fn to_user(friction: f64) -> f64 {
        if friction == 0.0 { f64::INFINITY } else { friction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::unit::variables::{VARIABLES, Variable};

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

    #[test]
    fn friction_without_limit_is_infinite_for_users_and_zero_is_refused() {
        for text in ["none", "None", "inf", "Infinity"] {
            assert_eq!(friction::parse(text), Ok(0.0), "{text}");
        }
        assert_eq!(friction::parse("0.35"), Ok(0.35));
        assert_eq!([0.0, 0.35].map(friction::to_user), [f64::INFINITY, 0.35]);
        for (text, expected) in
            [("0", "friction = 0 is"), ("-0.0", "none (inf) for no limit"), ("-1", "friction = -1"), ("NaN", "NaN")]
        {
            let message = friction::parse(text).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
        assert_eq!(friction::parse("low").unwrap_err(), "found `low`; expected a number > 0, or none for no limit");
    }
}
