//! A run, times → a measured quantity at these times, with its derivatives.

use rocking_block::excitation::Inputs;
use rocking_block::numerics::dual::Dual;
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Simulation, SimulationError};
use rocking_gradients::{Follower, Number, Parameters, Sample, Varied, advance_with_samples};

use crate::output::table::TableColumn;
use crate::run::gradients::{add_rows, with_respect_to};
use crate::run::table::columns;
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
pub struct TimeSeries {
    /// The points.
    pub points: Vec<Point>,
    /// Time at which an event grazes, if one does (s).
    pub grazing: Option<f64>,
    /// Time at which the block has overturned, if it has (s).
    pub ended: Option<f64>,
}

/// Returns the column `output` of a run at increasing `times` (s), with derivatives and rate. Derivatives are with respect to the named
/// parameters.
///
/// Before the run begins the block is held in its initial state; after a quarter turn it lies still. With derivatives no step stops at
/// the times. `None` if the run lacks a parameter or the column.
///
/// # Errors
/// The run fails.
pub fn time_series(
    run: &Run,
    parameters: &Parameters,
    names: Option<&[String]>,
    output: &str,
    times: &[f64],
    with_rate: bool,
) -> Option<Result<TimeSeries, SimulationError>> {
    let quantity = Quantity::named(output, run)?;
    let mut simulation = run.begin();
    let start = simulation.time();
    let mut piece = run.ground.piece_from(start);
    let batches: Vec<&[String]> = match names {
        // A follower without parameters yields the values alone.
        Some([]) => vec![&[]],
        Some(names) => names.chunks(rocking_gradients::BATCH).collect(),
        None => Vec::new(),
    };
    let varied: Option<Vec<Varied>> =
        batches.iter().map(|names| with_respect_to(parameters, &run.block, names)).collect();
    let mut followers: Vec<Follower> =
        varied?.into_iter().map(|varied| Follower::new(&simulation, varied, &piece.inputs)).collect();
    let count = names.map_or(0, <[String]>::len);
    let at_stop = |simulation: &Simulation, followers: &[Follower], inputs: &Inputs, is_held: bool| {
        let row = run.row(simulation, inputs);
        let column = |row: &Row| match is_held {
            true => quantity.column.number(&Row { observation: row.observation.without_motion(), ..*row }),
            false => quantity.column.number(row),
        };
        let (mut derivatives, mut rate) = (vec![0.0; count], 0.0);
        if simulation.ending().is_none() {
            let mut rows: Vec<Vec<Row>> = vec![Vec::new(); count];
            add_rows(&mut rows, followers, simulation, inputs, &row);
            derivatives = rows.iter().map(|rows| finite(column(&rows[0]))).collect();
            if with_rate && !is_held {
                let observation = simulation.observe_rates(inputs).map(|number: Dual| number.eps);
                rate = finite(quantity.value(observation, row.observation.slip_rate));
            }
        }
        Point { value: column(&row), rate, derivatives }
    };
    let mut next = times.partition_point(|time| *time < start);
    let mut points = match next {
        0 => Vec::new(),
        held => vec![at_stop(&simulation, &followers, &piece.inputs, true); held],
    };
    points.resize(times.len(), Point { derivatives: vec![0.0; count], ..Point::default() });
    let last = times.last().copied().unwrap_or(start);
    while next < times.len() {
        while simulation.time() < last && simulation.ending().is_none() {
            let stop = piece.end.min(if followers.is_empty() { times[next] } else { last });
            let ahead = &mut points[next..];
            let mut record = |number: usize, follower: usize, sample: &Sample| {
                quantity.record(sample, follower, with_rate, &mut ahead[number]);
            };
            let (inputs, ahead) = (&piece.inputs, &times[next..]);
            match advance_with_samples(&mut simulation, &mut followers, stop, inputs, ahead, &mut record) {
                Ok(sampled) => next += sampled,
                Err(error) => return Some(Err(error)),
            }
            if stop == piece.end {
                run.ground.next_interval(&mut piece);
            }
            if followers.is_empty() && simulation.time() >= times[next] {
                break;
            }
        }
        points[next] = at_stop(&simulation, &followers, &piece.inputs, false);
        next += 1;
    }
    let grazing = followers.iter().filter_map(Follower::grazing).map(|grazing| grazing.time).reduce(f64::min);
    Some(Ok(TimeSeries { points, grazing, ended: simulation.ending().map(|(_, time)| time) }))
}

/// The measured quantity.
struct Quantity {
    column: TableColumn<'static, Row>,
    /// Its index among the states, if it is one, which needs no equations of motion.
    state: Option<usize>,
    /// A row as argument of the column.
    row: Row,
}

impl Quantity {
    fn named(output: &str, run: &Run) -> Option<Quantity> {
        let column = columns(&run.block).into_iter().find(|column| column.heading().name == output)?;
        let state = ["theta", "theta_dot"].iter().position(|name| *name == output);
        let simulation = run.begin();
        let row = run.row(&simulation, &run.ground.piece_from(simulation.time()).inputs);
        Some(Quantity { column, state, row })
    }

    /// Returns the column of an observation with this slip.
    fn value(&self, observation: Observation<f64>, slip: f64) -> f64 {
        self.column.number(&Row { observation, slip, ..self.row })
    }

    /// Records a follower's sample in a point.
    fn record(&self, sample: &Sample, follower: usize, with_rate: bool, point: &mut Point) {
        let batch = point.derivatives.chunks_mut(rocking_gradients::BATCH).nth(follower).unwrap_or_default();
        if let Some(state) = self.state.filter(|state| !with_rate || *state == 0) {
            let Number { re, eps } = sample.pose().state[state];
            (point.value, point.rate) = (re, if with_rate { sample.pose().state[1].re } else { 0.0 });
            batch.iter_mut().zip(eps).for_each(|(derivative, eps)| *derivative = finite(eps));
            return;
        }
        let (observed, slip) = (sample.observe(), sample.slip());
        point.value = self.value(observed.map(|number| number.re), slip.re);
        for (i, derivative) in batch.iter_mut().enumerate() {
            *derivative = finite(self.value(observed.map(|number| number.eps[i]), slip.eps[i]));
        }
        if with_rate && follower == 0 {
            let along = sample.observe_along();
            let change = self.value(along.map(|number| number.eps[0]), slip.eps[0] + observed.slip_rate.re);
            point.rate = finite(change - self.value(observed.map(|number| number.eps[0]), slip.eps[0]));
        }
    }
}

fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { 0.0 }
}
