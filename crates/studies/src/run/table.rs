//! A history → a CSV table.

use std::io::Write;

use crate::run::{History, Row};

/// A column: its name, its unit and its value in a row.
type Column = (&'static str, &'static str, fn(&Row) -> f64);

/// The columns, named after the variables of the FMU.
pub const COLUMNS: [Column; 27] = [
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

/// Writes a history as CSV; numbers have the digits that restore them exactly.
pub fn write(history: &History, out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS.map(|(name, unit, _)| format!("{name} [{unit}]")))?;
    for row in &history.rows {
        writer.write_record(COLUMNS.map(|(_, _, value)| value(row).to_string()))?;
    }
    writer.flush()?;
    Ok(())
}
