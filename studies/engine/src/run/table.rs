//! A history → a table.

use std::ops::Range;

use crate::output::table::{Series, Table, TableColumn};
use crate::run::gradients::Derivatives;
use crate::run::outcome::Holds;
use crate::run::{History, Row};
use rocking_block::block::Block;
use rocking_block::block::restraints::{LinkKind, ObservedRestraint, tie};

/// A column of every table: its name, its unit and its value in a row.
type FixedColumn = (&'static str, &'static str, fn(&Row) -> f64);

/// The columns of every table, named after the variables of the FMU.
const COLUMNS: [FixedColumn; 27] = [
    ("t", "s", |row| row.time),
    ("theta", "rad", |row| row.observation.theta),
    ("theta_dot", "rad/s", |row| row.observation.theta_dot),
    ("theta_ddot", "rad/s2", |row| row.observation.theta_ddot),
    ("v", "m", |row| row.observation.v),
    ("v_dot", "m/s", |row| row.observation.v_dot),
    ("v_ddot", "m/s2", |row| row.observation.v_ddot),
    ("u", "m", |row| row.observation.u),
    ("u_dot", "m/s", |row| row.observation.u_dot),
    ("u_ddot", "m/s2", |row| row.observation.u_ddot),
    ("N_L", "N", |row| row.observation.reaction[0]),
    ("N_R", "N", |row| row.observation.reaction[1]),
    ("H", "N", |row| row.observation.horizontal),
    ("M_base", "N.m", |row| row.observation.base_moment),
    ("regime", "1", |row| row.regime.number().into()),
    ("uplift_L", "m", |row| row.observation.uplift[0]),
    ("uplift_R", "m", |row| row.observation.uplift[1]),
    ("friction_demand", "1", |row| row.observation.friction_demand),
    ("energy.total", "J", |row| row.energies.total),
    ("energy.kinetic", "J", |row| row.energies.kinetic),
    ("energy.input", "J", |row| row.energies.input),
    ("energy.dashpots", "J", |row| row.energies.dashpots),
    ("energy.impacts", "J", |row| row.energies.impacts),
    ("energy.constraint", "J", |row| row.energies.constraint),
    ("energy.residual", "J", |row| row.energies.residual),
    ("a_gx", "m/s2", |row| row.ground[0]),
    ("a_gz", "m/s2", |row| row.ground[1]),
];

/// The columns of blocks with a coefficient of friction.
const OF_FRICTION: [FixedColumn; 3] = [
    ("slip", "m", |row| row.slip),
    ("slip_rate", "m/s", |row| row.observation.slip_rate),
    ("energy.friction", "J", |row| row.energies.friction),
];

/// Whether a column has derivatives: numbers do, and no sums of energy since the start.
pub fn has_derivative(name: &str) -> bool {
    !matches!(name, "t" | "regime")
        && (!name.starts_with("energy.") || matches!(name, "energy.total" | "energy.kinetic"))
}

/// The name of the column of each link's force, in the order of the links.
pub fn force_columns(block: &Block) -> Vec<String> {
    let links = tie::names(block.ties()).into_iter().zip(block.ties());
    links.map(|(link, tie)| format!("{link}.{}", tie.kind.force())).collect()
}

/// The columns of a block's history. They are those of every table, and those of friction, ties and dampers where the block has them.
pub fn columns(block: &Block) -> Vec<TableColumn<'static, Row>> {
    let holds = Holds::of(block);
    let fixed = |(name, unit, value): FixedColumn| TableColumn::real(name, unit, value);
    let mut columns: Vec<TableColumn<Row>> = COLUMNS.map(fixed).into();
    if holds.friction {
        columns.extend(OF_FRICTION.map(fixed));
    }
    let links = tie::names(block.ties()).into_iter().zip(force_columns(block)).zip(block.ties());
    for (number, ((link, force), tie)) in links.enumerate() {
        let mut of_link = |name: String, unit, of: fn(&ObservedRestraint) -> f64| {
            columns.push(TableColumn::real(name, unit, move |row: &Row| of(&row.observation.restraints[number])));
        };
        of_link(force, "N", |restraint| restraint.pull);
        if tie.kind == LinkKind::Damper || tie.yields() {
            of_link(format!("{link}.elongation"), "m", |restraint| restraint.elongation);
            of_link(format!("{link}.plastic"), "m", |restraint| restraint.plastic);
        }
    }
    if holds.ties > 0 {
        columns.push(fixed(("energy.ties", "J", |row| row.energies.restraints.ties)));
    }
    if holds.dampers > 0 {
        columns.push(fixed(("energy.dampers", "J", |row| row.energies.restraints.dampers)));
    }
    columns
}

/// Returns rows of a block's history, with the derivatives of its columns after them.
pub fn table(block: &Block, history: &History, gradients: &[Derivatives], range: Range<usize>) -> Table {
    let columns = columns(block);
    let mut series: Vec<Series> = columns.iter().map(|column| column.series(&history.rows[range.clone()])).collect();
    for Derivatives { name: parameter, rows, .. } in gradients {
        let per = rocking_gradients::unit(parameter);
        for column in columns.iter().filter(|column| has_derivative(&column.heading().name)) {
            let Series { mut heading, values } = column.series(&rows[range.clone()]);
            heading.name = format!("d({})/d({parameter})", heading.name);
            heading.unit = heading.unit.map(|unit| if per == "1" { unit } else { format!("({unit})/({per})") });
            series.push(Series { heading, values });
        }
    }
    Table::of_series(series)
}
