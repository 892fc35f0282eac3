//! Equilibria of a pushover → a table.

use super::statics::Equilibrium;
use crate::output::table::{Table, TableColumn};
use rocking_block::block::Block;
use rocking_block::block::restraints::{LinkKind, tie};

/// Returns the table of equilibria. Its columns are those of a history that a slow rotation has, and the lateral force with its moment.
pub fn table(block: &Block, rows: &[Equilibrium]) -> Table {
    let weight = block.mass * block.gravity;
    let mut columns: Vec<TableColumn<Equilibrium>> = vec![
        TableColumn::real("theta", "rad", |at: &Equilibrium| at.theta),
        TableColumn::real("u", "m", |at: &Equilibrium| at.u),
        TableColumn::real("v", "m", |at: &Equilibrium| at.v),
        TableColumn::real("moment", "N.m", |at: &Equilibrium| at.moment),
        TableColumn::real("force", "N", |at: &Equilibrium| at.force),
        TableColumn::real("force/weight", "1", move |at: &Equilibrium| at.force / weight),
        TableColumn::real("N_L", "N", |at: &Equilibrium| at.reaction[0]),
        TableColumn::real("N_R", "N", |at: &Equilibrium| at.reaction[1]),
        TableColumn::real("H", "N", |at: &Equilibrium| at.horizontal),
        TableColumn::count("regime", |at: &Equilibrium| i64::from(at.regime.number())),
    ];
    for (number, (link, tie)) in tie::names(block.ties()).into_iter().zip(block.ties()).enumerate() {
        let mut of_link = |quantity: &str, unit, value: Box<dyn Fn(&Equilibrium) -> f64 + Sync>| {
            columns.push(TableColumn::real(format!("{link}.{quantity}"), unit, value));
        };
        of_link(tie.kind.force(), "N", Box::new(move |at| at.restraints[number].pull));
        of_link("moment", "N.m", Box::new(move |at| at.resisting[number]));
        if tie.kind == LinkKind::Damper || tie.yields() {
            of_link("elongation", "m", Box::new(move |at| at.restraints[number].elongation));
            of_link("plastic", "m", Box::new(move |at| at.restraints[number].plastic));
        }
    }
    Table::of(&columns, rows)
}
