//! The ties and dampers among the variables: their names, the variables of their parameters, and the fault of a pretension.

use std::sync::LazyLock;

use crate::block::Block;
use crate::block::restraints::{LinkKind, Tie, tie};
use crate::unit::fault::Fault;
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

/// Returns the fault of a block whose beginning is not finite, with the ties that may press it past their anchors.
pub fn no_balance(block: &Block) -> Fault {
    let names = tie::names(block.ties()).into_iter().zip(block.ties());
    let names: Vec<String> = names.filter(|(_, tie)| tie.pulls_without_length()).map(|(name, _)| name).collect();
    Fault::new(format!(
        "found no balance of the block at the start; expected a pretension of {} that does not press it past the anchor",
        if names.is_empty() { "ties".into() } else { names.join(", ") }
    ))
}

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
