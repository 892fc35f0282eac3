//! Pairs of surfaces: friction and restitution with their sources, from one file.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use rocking_block::unit::variables::Variable;
use serde::{Deserialize, Serialize};

/// The file of all values.
const FILE: &str = include_str!("pairs.toml");

/// A value of a pair of surfaces, from one source.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// The quantity.
    pub quantity: Quantity,
    /// The surfaces, the block's first.
    pub surfaces: String,
    /// State of the surfaces, or sizes of the blocks; may be empty.
    pub state: String,
    /// Least value (1).
    pub low: f64,
    /// Greatest value (1); the least one if the source has a single value.
    pub high: f64,
    /// Meaning of the values.
    pub kind: ValueMeaning,
    /// Explanation of the values by the source.
    pub basis: String,
    /// The source.
    pub source: Source,
}

/// A quantity of a pair of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Coulomb's coefficient of friction μ (1).
    Friction,
    /// Restitution e of the rotation over Housner's (1).
    RestitutionFactor,
}

impl Quantity {
    /// Returns the name of the quantity as a parameter of a block.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Friction => Variable::Friction.name(),
            Quantity::RestitutionFactor => Variable::RestitutionFactor.name(),
        }
    }
}

/// Meaning of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ValueMeaning {
    /// The spread of tests.
    Measured,
    /// The least value of tests.
    Lowest,
    /// A standard's value or its limits; a single one is conservative where friction helps.
    Design,
}

impl ValueMeaning {
    /// Returns the word of a meaning.
    pub fn word(self) -> &'static str {
        match self {
            ValueMeaning::Measured => "measured",
            ValueMeaning::Lowest => "lowest",
            ValueMeaning::Design => "design",
        }
    }
}

/// A publication.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Short name.
    pub name: String,
    /// Authors, title, year.
    pub citation: String,
    /// Digital object identifier, if known.
    pub doi: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    sources: BTreeMap<String, Source>,
    pairs: Vec<Row>,
}

/// A pair, as in the file: one of the three values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    surfaces: String,
    state: String,
    friction: Option<[f64; 2]>,
    /// In degrees.
    friction_angle: Option<[f64; 2]>,
    restitution_factor: Option<[f64; 2]>,
    kind: ValueMeaning,
    basis: String,
    source: String,
}

/// Returns all pairs, in the order of the file.
pub fn pairs() -> &'static [Pair] {
    static PAIRS: LazyLock<Vec<Pair>> = LazyLock::new(|| {
        let file: File = toml::from_str(FILE).expect("the file is valid, as tests show");
        let pair = |row: Row| {
            let tangents = |angles: [f64; 2]| angles.map(|angle| libm::tan(angle.to_radians()));
            let friction = row.friction.or(row.friction_angle.map(tangents));
            let (quantity, values) = match (friction, row.restitution_factor) {
                (Some(values), None) => (Quantity::Friction, values),
                (None, Some(values)) => (Quantity::RestitutionFactor, values),
                _ => unreachable!("each pair of the file has one value, as tests show"),
            };
            let Row { surfaces, state, kind, basis, source, .. } = row;
            let source = file.sources[&source].clone();
            Pair { quantity, surfaces, state, low: values[0], high: values[1], kind, basis, source }
        };
        file.pairs.into_iter().map(pair).collect()
    });
    &PAIRS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each value is in order and plausible, and every source is used.
    #[test]
    fn the_file_is_complete() {
        let file: File = toml::from_str(FILE).unwrap();
        for row in &file.pairs {
            let values = [row.friction, row.friction_angle, row.restitution_factor];
            assert_eq!(values.iter().flatten().count(), 1, "{}", row.surfaces);
            assert!(file.sources.contains_key(&row.source) && !row.basis.is_empty(), "{}", row.surfaces);
        }
        for (key, source) in &file.sources {
            assert!(file.pairs.iter().any(|row| row.source == *key), "{key} is not used");
            let year = source.citation.contains("19") || source.citation.contains("20");
            assert!(year || source.doi.is_some(), "{key} has neither a year nor a DOI");
        }
        assert_eq!(pairs().len(), file.pairs.len());
        for Pair { quantity, surfaces, low, high, .. } in pairs() {
            let greatest = match quantity {
                Quantity::Friction => 1.0,
                Quantity::RestitutionFactor => 1.1,
            };
            assert!(0.0 < *low && low <= high && *high <= greatest, "{surfaces}: {low} to {high}");
        }
        let mut keys: Vec<_> =
            pairs().iter().map(|pair| (&pair.surfaces, &pair.state, pair.quantity.name(), &pair.source.name)).collect();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), pairs().len(), "a pair stands twice");
    }

    /// Angles become coefficients: the tangent of 45° would be 1.
    #[test]
    fn angles_are_degrees() {
        let granite = &pairs()[0];
        assert_eq!((granite.surfaces.as_str(), granite.state.as_str()), ("granite on granite", "sawn, dry"));
        assert!((granite.low - 0.6009).abs() < 1e-4 && (granite.high - 0.7002).abs() < 1e-4, "{granite:?}");
    }
}
