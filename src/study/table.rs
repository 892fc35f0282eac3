//! Histories → CSV.

use std::io::Write;

use crate::study::history::{History, Row};

/// A column: its name and how to read it.
type Column = (&'static str, fn(&Row) -> f64);

/// The columns, with the names of the FMU's variables; SI units, angles in radians.
pub const COLUMNS: [Column; 27] = [
    ("t", |row| row.time),
    ("theta", |row| row.seen.theta),
    ("theta_dot", |row| row.seen.theta_dot),
    ("theta_ddot", |row| row.seen.theta_ddot),
    ("v", |row| row.seen.v),
    ("v_dot", |row| row.seen.v_dot),
    ("v_ddot", |row| row.seen.v_ddot),
    ("u", |row| row.seen.u),
    ("u_dot", |row| row.seen.u_dot),
    ("u_ddot", |row| row.seen.u_ddot),
    ("N_L", |row| row.seen.reaction[0]),
    ("N_R", |row| row.seen.reaction[1]),
    ("H", |row| row.seen.horizontal),
    ("M_base", |row| row.seen.base_moment),
    ("regime", |row| row.regime.number().into()),
    ("uplift_L", |row| row.seen.uplift[0]),
    ("uplift_R", |row| row.seen.uplift[1]),
    ("friction_demand", |row| row.seen.friction_demand),
    ("energy.total", |row| row.energies.total),
    ("energy.kinetic", |row| row.energies.kinetic),
    ("energy.input", |row| row.energies.input),
    ("energy.dashpots", |row| row.energies.dashpots),
    ("energy.impacts", |row| row.energies.impacts),
    ("energy.constraint", |row| row.energies.constraint),
    ("energy.residual", |row| row.energies.residual),
    ("a_gx", |row| row.ground[0]),
    ("a_gz", |row| row.ground[1]),
];

/// Writes a history as CSV, each number with the digits that bring it back exactly.
pub fn write(history: &History, out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS.map(|(name, _)| name))?;
    for row in &history.rows {
        writer.write_record(COLUMNS.map(|(_, value)| value(row).to_string()))?;
    }
    writer.flush()?;
    Ok(())
}
