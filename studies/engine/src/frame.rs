//! Free-standing columns under a beam → their equivalent block, and the forces of the frame.
//!
//! N. Makris, M. F. Vassiliou, Planar rocking response and stability analysis of an array of free-standing columns capped with a
//! freely supported rigid beam, EESD 42 (2013) 431–449, doi:10.1002/eqe.2222. docs/studies/frames.md has the derivation, which holds for
//! any moment of inertia of the columns.

use crate::output::table::{Table, TableColumn};
use crate::run::{History, Row};
use rocking_block::block::{Block, BlockError, Common, Dimensionless, Foundation, Supports};

/// Equal free-standing columns on a rigid base under a rigid beam. The beam rests freely on their tops.
///
/// All columns rotate by the same θ and the beam moves without rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Number N of columns.
    pub columns: u32,
    /// One of the columns.
    pub column: Block,
    /// Mass of the beam m_b (kg).
    pub beam_mass: f64,
    /// The block with the frame's rotation.
    pub block: Block,
}

/// The reason why a frame has no equivalent block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct FrameError(String);

impl From<BlockError> for FrameError {
    /// The equivalent block is not valid.
    fn from(error: BlockError) -> FrameError {
        FrameError(error.to_string())
    }
}

/// Greatest number of columns; a greater one would be a typing error.
const MAX_COLUMNS: u32 = 1_000_000;

/// Motion of the equivalent block: pairs are horizontal and vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockMotion {
    /// Displacement of the centre of mass relative to the ground (m).
    pub displacement: [f64; 2],
    /// Acceleration of the centre of mass relative to the ground (m/s²).
    pub acceleration: [f64; 2],
    /// Reaction of the base on the block (N).
    pub reaction: [f64; 2],
    /// Ground acceleration (m/s²).
    pub ground: [f64; 2],
}

/// Motion of the beam and forces of the frame: pairs are horizontal and vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameResponse {
    /// Displacement of the beam relative to the ground (m).
    pub beam: [f64; 2],
    /// Mean force of the base on a column (N).
    pub base: [f64; 2],
    /// Mean force of a column on the beam (N). The vertical one is below zero where the beam would have to be held down.
    pub top: [f64; 2],
}

impl Frame {
    /// Creates the frame of these columns. `column` stands on the rigid base, and its restitution factor is that of the frame.
    ///
    /// # Errors
    /// [`FrameError`]: a number or a mass out of range, or a column on supports, tied, uneven, sliding or with ε > 0.
    pub fn new(columns: u32, column: Block, beam_mass: f64) -> Result<Frame, FrameError> {
        if !(2..=MAX_COLUMNS).contains(&columns) {
            return Err(FrameError(format!(
                "columns = {columns}; expected 2 to {MAX_COLUMNS}, since one column does not keep the beam level"
            )));
        }
        if !(beam_mass.is_finite() && beam_mass >= 0.0) {
            return Err(FrameError(format!("beam_mass = {beam_mass} is not valid; expected a mass >= 0 kg")));
        }
        equivalent(&column)?;
        let ratio = beam_mass / (f64::from(columns) * column.mass);
        let (moment, inertia) = (1.0 + 2.0 * ratio, 1.0 + 4.0 * ratio);
        let gamma = column.gamma * inertia;
        let r0 = column.r0 * inertia / moment;
        let dimensionless = Dimensionless {
            alpha: column.alpha,
            p: (gamma / (1.0 + gamma) * column.gravity / r0).sqrt(),
            supports: Supports::Rigid { restitution_factor: column.restitution_factor },
        };
        let common = Common {
            mass: f64::from(columns) * column.mass * (moment * moment / inertia),
            gamma,
            epsilon: 0.0,
            gravity: column.gravity,
            ..Common::default()
        };
        let block = Block::from_dimensionless(&dimensionless, &common)?;
        Ok(Frame { columns, column, beam_mass, block })
    }

    /// Ratio γ_b of the masses of the beam and of all columns (1).
    pub fn mass_ratio(&self) -> f64 {
        self.beam_mass / (f64::from(self.columns) * self.column.mass)
    }

    /// Motion of the beam and mean forces per column.
    ///
    /// The frame moves like its block with the mass `m_b/(1 + 4γ_b)` at rest on the ground beside it.
    pub fn response(&self, motion: &BlockMotion) -> FrameResponse {
        let BlockMotion { displacement, acceleration, reaction, ground } = *motion;
        let columns = f64::from(self.columns);
        let lever = 2.0 * self.column.r0 / self.block.r0;
        let at_rest = self.beam_mass / (1.0 + 4.0 * self.mass_ratio());
        let weight = [0.0, self.block.gravity];
        let each = |component: &dyn Fn(usize) -> f64| [component(0), component(1)];
        FrameResponse {
            beam: each(&|i| lever * displacement[i]),
            base: each(&|i| (reaction[i] + at_rest * (ground[i] + weight[i])) / columns),
            top: each(&|i| self.beam_mass * (lever * acceleration[i] + ground[i] + weight[i]) / columns),
        }
    }

    /// The response in a row of the equivalent block's history.
    pub fn response_in(&self, row: &Row) -> FrameResponse {
        let observation = &row.observation;
        self.response(&BlockMotion {
            displacement: [observation.u, observation.v],
            acceleration: [observation.u_ddot, observation.v_ddot],
            reaction: [observation.horizontal, observation.reaction[0] + observation.reaction[1]],
            ground: row.ground,
        })
    }

    /// Time (s) of the first row in which the beam would need holding down. There it leaves the columns and the model ends.
    pub fn beam_leaves(&self, history: &History) -> Option<f64> {
        let first = history.rows.iter().find(|row| self.response_in(row).top[1] < 0.0);
        first.map(|row| row.time).filter(|_| self.beam_mass > 0.0)
    }

    /// The history of the frame.
    pub fn table(&self, history: &History) -> Table {
        let row = |row| FrameRow { row, response: self.response_in(row) };
        let rows: Vec<FrameRow> = history.rows.iter().map(row).collect();
        type Of<'a> = TableColumn<'a, FrameRow<'a>>;
        let mut columns = vec![
            Of::real("t", "s", |frame| frame.row.time),
            Of::real("theta", "rad", |frame| frame.row.observation.theta),
            Of::real("theta_dot", "rad/s", |frame| frame.row.observation.theta_dot),
            Of::real("theta_ddot", "rad/s2", |frame| frame.row.observation.theta_ddot),
        ];
        columns.extend(FrameResponse::columns(|frame: &FrameRow| &frame.response));
        columns.extend([
            Of::real("a_gx", "m/s2", |frame| frame.row.ground[0]),
            Of::real("a_gz", "m/s2", |frame| frame.row.ground[1]),
        ]);
        Table::of(&columns, &rows)
    }
}

/// A row of a history and the response of the frame in it.
struct FrameRow<'a> {
    row: &'a Row,
    response: FrameResponse,
}

impl FrameResponse {
    /// The columns of responses in rows of any kind.
    pub fn columns<'c, R: 'c>(of: fn(&R) -> &FrameResponse) -> [TableColumn<'c, R>; 6] {
        [
            TableColumn::real("beam_u", "m", move |row| of(row).beam[0]),
            TableColumn::real("beam_v", "m", move |row| of(row).beam[1]),
            TableColumn::real("base_H", "N", move |row| of(row).base[0]),
            TableColumn::real("base_N", "N", move |row| of(row).base[1]),
            TableColumn::real("top_H", "N", move |row| of(row).top[0]),
            TableColumn::real("top_N", "N", move |row| of(row).top[1]),
        ]
    }
}

/// Refuses a column with which no block moves like the frame.
fn equivalent(column: &Block) -> Result<(), FrameError> {
    let refused = |property: &str, reason: &str, expected: &str| {
        let message = format!("{property} of the column has no equivalent in a frame: {reason}; expected {expected}");
        Err(FrameError(message))
    };
    if column.foundation != Foundation::Rigid {
        let reason = "on supports the columns also move vertically, and the beam takes part in that motion differently from a block";
        return refused("foundation = viscoelastic", reason, "a rigid base");
    }
    if column.epsilon != 0.0 {
        let reason = "beam and columns would rebound separately, at the tops and at the bases";
        return refused("epsilon", reason, "0; restitution_factor scales e of the frame");
    }
    if column.eccentricity != 0.0 {
        let reason = "the lever arms of columns and beam would differ between the two sides";
        return refused("eccentricity", reason, "0");
    }
    if column.friction != 0.0 {
        let reason = "tops and bases would slide at different times";
        return refused(
            "friction",
            reason,
            "no limit; the forces at bases and tops show the friction that the frame needs",
        );
    }
    if !column.ties().is_empty() {
        let reason = "a tie of a column moves its top and the beam by different amounts";
        return refused("ties", reason, "none");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::restraints::Tie;
    use rocking_block::block::{BlockParameters, KelvinVoigt, Outline, Springs};

    fn column(common: Common) -> Block {
        column_on(Supports::HOUSNER, common)
    }

    fn column_on(supports: Supports<KelvinVoigt>, common: Common) -> Block {
        let outline = Outline::Sizes { width: 1.6, height: 9.6, inertia: None };
        Block::new(&BlockParameters { outline, supports, common }).unwrap()
    }

    fn heavy() -> Common {
        Common { mass: 3e4, ..Common::default() }
    }

    #[track_caller]
    fn near(value: f64, exact: f64) {
        assert!((value - exact).abs() <= 4e-15 * exact.abs(), "{value}, exactly {exact}");
    }

    /// Makris and Vassiliou (2013): p̂ and e of rectangular columns.
    #[test]
    fn rectangular_columns_have_the_published_frequency_parameter_and_restitution() {
        let column = column(heavy());
        for ratio in [0.0, 0.5, 1.0, 4.0, 100.0] {
            let block = Frame::new(4, column, ratio * 4.0 * column.mass).unwrap().block;
            assert_eq!(block.alpha, column.alpha);
            near(block.p, column.p * ((1.0 + 2.0 * ratio) / (1.0 + 3.0 * ratio)).sqrt());
            let (sin, cos_2) = (column.alpha.sin(), (2.0 * column.alpha).cos());
            near(block.restitution(), (1.0 - 1.5 * sin * sin + 3.0 * ratio * cos_2) / (1.0 + 3.0 * ratio));
        }
    }

    /// At rest each base bears its share of the whole weight. Each top bears its share of the beam.
    #[test]
    fn weight_at_rest_is_that_of_columns_and_beam() {
        let column = column(heavy());
        let frame = Frame::new(3, column, 2e5).unwrap();
        let weight = frame.block.mass * frame.block.gravity;
        let rest =
            BlockMotion { displacement: [0.0; 2], acceleration: [0.0; 2], reaction: [0.0, weight], ground: [0.0; 2] };
        let FrameResponse { beam, base, top } = frame.response(&rest);
        assert_eq!((beam, base[0], top[0]), ([0.0; 2], 0.0, 0.0));
        near(base[1], (3.0 * 3e4 + 2e5) * 9.81 / 3.0);
        near(top[1], 2e5 * 9.81 / 3.0);
    }

    #[test]
    fn frames_without_an_equivalent_block_are_refused_with_the_reason() {
        let tie = Tie { block: [0.8, 9.0], ground: [3.0, 0.0], stiffness: 1e6, ..Tie::default() };
        for (column, expected) in [
            (
                column_on(
                    Supports::Viscoelastic(KelvinVoigt::Springs(Springs { stiffness: 1e9, damping: 0.0 })),
                    heavy(),
                ),
                "foundation = viscoelastic of the column has no equivalent in a frame: on supports",
            ),
            (column(Common { epsilon: 0.1, ..heavy() }), "epsilon of the column"),
            (column(Common { eccentricity: 0.1, ..heavy() }), "eccentricity of the column"),
            (column(Common { friction: 0.5, ..heavy() }), "friction of the column"),
            (column(heavy()).with_ties(&[tie]).unwrap(), "ties of the column"),
        ] {
            let refused = Frame::new(2, column, 1e4).unwrap_err().to_string();
            assert!(refused.starts_with(expected), "{refused}");
        }
        let column = column(heavy());
        assert!(Frame::new(1, column, 1e4).unwrap_err().to_string().starts_with("columns = 1; expected 2 to"));
        assert!(Frame::new(2, column, -1.0).unwrap_err().to_string().starts_with("beam_mass = -1 is not valid"));
    }
}
