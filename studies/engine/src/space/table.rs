//! A history in space → a table.

use std::ops::Range;

use rocking_block::space::SpaceParameters;
use rocking_block::space::outputs::FootObservation;

use crate::output::format::DescribedTable;
use crate::output::table::{Table, TableColumn};
use crate::space::{HistoryInSpace, RowInSpace, foot_names};

/// A column: its name, its unit and its value in a row.
type Column = (&'static str, &'static str, fn(&RowInSpace) -> f64);

/// The columns of every table, named after the variables of the model.
const COLUMNS: [Column; 44] = [
    ("t", "s", |row| row.observation.time),
    ("tilt", "rad", |row| row.observation.attitude.tilt),
    ("tilt/alpha", "1", |row| row.tilt_over_critical),
    ("tilt_x", "rad", |row| row.observation.attitude.tilt_x),
    ("tilt_y", "rad", |row| row.observation.attitude.tilt_y),
    ("azimuth", "rad", |row| row.observation.attitude.azimuth),
    ("twist", "rad", |row| row.observation.attitude.twist),
    ("omega_x", "rad/s", |row| row.observation.omega.x),
    ("omega_y", "rad/s", |row| row.observation.omega.y),
    ("omega_z", "rad/s", |row| row.observation.omega.z),
    ("u", "m", |row| row.observation.displacement.x),
    ("w", "m", |row| row.observation.displacement.y),
    ("v", "m", |row| row.observation.displacement.z),
    ("u_dot", "m/s", |row| row.observation.velocity.x),
    ("w_dot", "m/s", |row| row.observation.velocity.y),
    ("v_dot", "m/s", |row| row.observation.velocity.z),
    ("u_ddot", "m/s2", |row| row.observation.acceleration.x),
    ("w_ddot", "m/s2", |row| row.observation.acceleration.y),
    ("v_ddot", "m/s2", |row| row.observation.acceleration.z),
    ("drift_x", "m", |row| row.observation.drift[0]),
    ("drift_y", "m", |row| row.observation.drift[1]),
    ("touching", "1", |row| row.observation.touching() as f64),
    ("sliding", "1", |row| row.observation.sliding() as f64),
    ("N", "N", |row| row.observation.force.z),
    ("H_x", "N", |row| row.observation.force.x),
    ("H_y", "N", |row| row.observation.force.y),
    ("M_base_x", "N.m", |row| row.observation.moment.x),
    ("M_base_y", "N.m", |row| row.observation.moment.y),
    ("M_z", "N.m", |row| row.observation.moment.z),
    ("uplift", "m", |row| greatest(row, |foot| foot.uplift)),
    ("slip", "m", |row| greatest(row, |foot| foot.slip)),
    ("friction_demand", "1", |row| greatest(row, |foot| foot.friction_demand)),
    ("energy.total", "J", |row| row.energies.stored.total()),
    ("energy.kinetic", "J", |row| row.energies.stored.kinetic),
    ("energy.weight", "J", |row| row.energies.stored.weight),
    ("energy.supports", "J", |row| row.energies.stored.supports),
    ("energy.input", "J", |row| row.energies.input),
    ("energy.dashpots", "J", |row| row.energies.dashpots),
    ("energy.slip", "J", |row| row.energies.slip),
    ("energy.lift_off", "J", |row| row.energies.lift_off),
    ("energy.residual", "J", |row| row.energies.residual),
    ("a_gx", "m/s2", |row| row.ground[0]),
    ("a_gy", "m/s2", |row| row.ground[1]),
    ("a_gz", "m/s2", |row| row.ground[2]),
];

/// A column of each foot: the prefix of its name, its unit and its value.
type OfFoot = (&'static str, &'static str, fn(&FootObservation) -> f64);

/// The columns of each foot.
const OF_FOOT: [OfFoot; 4] = [
    ("N", "N", |foot| foot.normal),
    ("uplift", "m", |foot| foot.uplift),
    ("slip", "m", |foot| foot.slip),
    ("slides", "1", |foot| f64::from(u8::from(foot.slides))),
];

/// Returns the greatest value of all feet.
fn greatest(row: &RowInSpace, of: fn(&FootObservation) -> f64) -> f64 {
    row.observation.feet.iter().map(of).fold(0.0, f64::max)
}

/// Returns the columns of the table of a block: those of every table, then those of each foot.
pub fn columns(parameters: &SpaceParameters) -> Vec<TableColumn<'static, RowInSpace>> {
    let of_block = COLUMNS.iter().map(|&(name, unit, value)| TableColumn::real(name, unit, value));
    let of_feet = foot_names(parameters).into_iter().enumerate().flat_map(|(i, foot)| {
        OF_FOOT.map(|(name, unit, value)| {
            let value = move |row: &RowInSpace| value(&row.observation.feet[i]);
            TableColumn::real(format!("{name}_{foot}"), unit, value)
        })
    });
    of_block.chain(of_feet).collect()
}

/// Returns rows of a history, and a line that says what they are.
pub fn table(parameters: &SpaceParameters, history: &HistoryInSpace, rows: Range<usize>) -> DescribedTable {
    let feet = foot_names(parameters).len();
    let table = Table::of(&columns(parameters), &history.rows[rows]);
    DescribedTable { study: vec![format!("block in space on {feet} feet")], table }
}
