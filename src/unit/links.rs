//! The ties and dampers among the variables: their names and the variables of their parameters.

use std::sync::LazyLock;

use crate::block::restraints::{LinkKind, Tie, tie};
use crate::unit::variables::{VARIABLES, Variable};

/// A tie or damper among the variables: its name and its parameters. A damper has no variables of pretension and slack, which are 0.
pub type LinkVariables = (&'static str, Tie<Option<Variable>>);

/// The ties and dampers among the variables, in the order of their numbers.
pub static LINKS: LazyLock<[LinkVariables; tie::VARIABLES]> = LazyLock::new(|| {
    let (tie, damper) = (LinkKind::Tie, LinkKind::Damper);
    [("tie_1", tie), ("tie_2", tie), ("damper_1", damper), ("damper_2", damper)].map(|(name, kind)| {
        let mut link = Tie { kind, ..Tie::default() };
        for (variable, number) in link.numbers().into_iter().zip(tie::NUMBERS) {
            let path = format!("{name}.{}", number.name);
            *variable = VARIABLES.iter().find(|known| known.name == path).map(|known| known.variable);
        }
        (name, link)
    })
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::restraints::tie::Quantity;

    /// Each number of a tie or damper is a variable with its unit, and at least 0 unless it is a coordinate.
    #[test]
    fn numbers_of_ties_and_dampers_are_variables() {
        for (name, mut link) in *LINKS {
            for number in link.kind.numbers() {
                let found = link.number(number.name).and_then(|variable| *variable);
                let variable = found.unwrap_or_else(|| panic!("{name}.{} is no variable", number.name));
                let metadata = &VARIABLES[variable as usize];
                assert_eq!(metadata.unit.unwrap_or("1"), number.quantity.unit(), "{}", metadata.name);
                let is_signed = metadata.min != Some(0.0);
                assert_eq!(is_signed, number.quantity == Quantity::Coordinate, "{}", metadata.name);
            }
        }
    }
}
