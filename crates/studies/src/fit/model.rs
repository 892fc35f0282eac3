//! A run, times → a measured quantity at these times, with its derivatives.

use rocking_block::numerics::dual::Dual64;
use rocking_block::simulation::{Energies, Simulation, SimulationError};
use rocking_gradients::{Follower, Parameters, Varied, advance};

use crate::run::gradients::add_rows;
use crate::run::table::{Column, columns};
use crate::run::{Row, Run};

/// A quantity of a run at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Its value.
    pub value: f64,
    /// Its rate (1/s).
    pub rate: f64,
    /// Its derivatives with respect to the parameters, 0 where an event grazes.
    pub derivatives: Vec<f64>,
}

/// A quantity of a run over time.
#[derive(Clone, Debug)]
pub struct Course {
    /// The points.
    pub points: Vec<Point>,
    /// Time at which an event grazes, if one does (s).
    pub grazing: Option<f64>,
    /// Time at which the block has overturned, if it has (s).
    pub ended: Option<f64>,
}

/// The column `output` of a run at increasing `times` (s), with its derivatives with respect to the named parameters.
///
/// Before the run begins the block is held in its initial state; after a quarter turn it lies still.
pub fn course(
    run: &Run,
    parameters: &Parameters,
    names: &[String],
    output: &str,
    times: &[f64],
) -> Result<Course, SimulationError> {
    let column = columns(&run.block).into_iter().find(|column| column.name == output);
    let Some(column) = column else { unreachable!("{output} is checked before") };
    let varied: Option<Vec<Varied>> = names
        .chunks(rocking_gradients::BATCH)
        .map(|names| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            Varied::with_respect_to(parameters, &run.block, &names)
        })
        .collect();
    let Some(varied) = varied else { unreachable!("{names:?} are checked before") };
    let mut simulation = run.begin();
    let mut piece = run.ground.piece_from(simulation.time());
    let start = simulation.time();
    let mut followers: Vec<Follower> =
        varied.into_iter().map(|varied| Follower::new(&simulation, varied, &piece.inputs)).collect();
    let mut points = Vec::with_capacity(times.len());
    for &time in times {
        while simulation.time() < time && simulation.ending().is_none() {
            let stop = piece.end.min(time);
            advance(&mut simulation, &mut followers, stop, &piece.inputs)?;
            if stop == piece.end {
                piece = run.ground.piece_after(&piece);
            }
        }
        let row = run.row(&simulation, &piece.inputs);
        let is_held = time < start;
        let value = |row: &Row| match is_held {
            true => column.value(&Row { observation: row.observation.without_motion(), ..*row }),
            false => column.value(row),
        };
        let (mut derivatives, mut change) = (vec![0.0; names.len()], 0.0);
        if simulation.ending().is_none() {
            let mut rows: Vec<Vec<Row>> = vec![Vec::new(); names.len()];
            add_rows(&mut rows, &followers, &simulation, &piece.inputs, &row);
            derivatives = rows.iter().map(|rows| finite(value(&rows[0]))).collect();
            if !is_held {
                change = finite(rate(&column, &simulation, &piece.inputs, &row));
            }
        }
        points.push(Point { value: value(&row), rate: change, derivatives });
    }
    let grazing = followers.iter().filter_map(Follower::grazing).map(|grazing| grazing.time).reduce(f64::min);
    Ok(Course { points, grazing, ended: simulation.ending().map(|(_, time)| time) })
}

/// The rate of a column along the motion.
fn rate(column: &Column, simulation: &Simulation, inputs: &rocking_block::excitation::Inputs, row: &Row) -> f64 {
    let observation = simulation.observe_rates(inputs).map(|number: Dual64| number.eps);
    let slip = row.observation.slip_rate;
    column.value(&Row { observation, energies: Energies::default(), slip, ground: [0.0; 2], ..*row })
}

fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { 0.0 }
}
