//! A run and parameters of it → its history with derivatives. They are those of the columns, of the times of events and of the peaks.

use rocking_block::block::Block;
use rocking_block::excitation::Inputs;
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Energies, Simulation, SimulationError};
use rocking_gradients::{BATCH, Follower, Grazing, Number, Parameters, Varied, advance};

use crate::run::{History, Row, Run};

/// The derivatives of a run with respect to one parameter.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// The parameter.
    pub name: String,
    /// Derivatives of the rows of the history at their times. Time and regime are those of the rows.
    pub rows: Vec<Row>,
    /// Derivatives of the times of the events (s per unit of the parameter).
    pub events: Vec<f64>,
    /// Derivatives of the peaks.
    pub peaks: Peaks,
}

/// The derivatives of a run.
#[derive(Clone, Debug, Default)]
pub struct Gradients {
    /// For each parameter.
    pub parameters: Vec<Derivatives>,
    /// The event from which on there are no derivatives, if one grazes.
    pub grazing: Option<Grazing>,
}

/// Returns a block varied with respect to a batch of the named `parameters`. `None` if they lack one.
pub(crate) fn with_respect_to(parameters: &Parameters, block: &Block, names: &[String]) -> Option<Varied> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Varied::with_respect_to(parameters, block, &names)
}

impl Run {
    /// Makes the run with its derivatives with respect to the named `parameters`. These are the parameters of this run; `None` if they lack
    /// one.
    ///
    /// The history has the bits of [`Run::history`].
    ///
    /// # Errors
    /// The solver cannot go on.
    pub fn history_with_gradients(
        &self,
        parameters: &Parameters,
        names: &[String],
        mut progress: impl FnMut(f64),
    ) -> Option<Result<(History, Gradients), SimulationError>> {
        let varied: Option<Vec<Varied>> =
            names.chunks(BATCH).map(|names| with_respect_to(parameters, &self.block, names)).collect();
        let mut simulation = self.begin();
        let mut schedule = self.schedule(&simulation);
        let mut followers: Vec<Follower> =
            varied?.into_iter().map(|varied| Follower::new(&simulation, varied, schedule.inputs())).collect();
        let mut rows = vec![self.row(&simulation, schedule.inputs())];
        let mut of_parameters: Vec<Vec<Row>> = vec![Vec::new(); names.len()];
        add_rows(&mut of_parameters, &followers, &simulation, schedule.inputs(), &rows[0]);
        schedule.check(&simulation);
        while let Some(stop) = schedule.next_stop(&simulation) {
            if let Err(error) = advance(&mut simulation, &mut followers, stop, schedule.inputs()) {
                return Some(Err(error));
            }
            if let Some(done) = schedule.stopped(self, &simulation) {
                let row = self.row(&simulation, schedule.inputs());
                add_rows(&mut of_parameters, &followers, &simulation, schedule.inputs(), &row);
                rows.push(row);
                progress(done);
            }
        }
        let events = followers.first().map_or(Vec::new(), |of| of.events().iter().map(|of| of.event).collect());
        let mut derivatives = Vec::new();
        for (k, (name, rows)) in names.iter().zip(of_parameters).enumerate() {
            let (follower, i) = (&followers[k / BATCH], k % BATCH);
            let of = |number: Number| number.eps[i];
            let Peaks { theta, reaction, horizontal, uplift, friction_demand, slip, pull, plastic, elongation } =
                follower.peaks(&simulation);
            derivatives.push(Derivatives {
                name: name.clone(),
                rows,
                events: follower.events().iter().map(|event| event.time[i]).collect(),
                peaks: Peaks {
                    theta: of(theta),
                    reaction: of(reaction),
                    horizontal: of(horizontal),
                    uplift: of(uplift),
                    friction_demand: of(friction_demand),
                    slip: of(slip),
                    pull: pull.map(of),
                    plastic: plastic.map(of),
                    elongation: elongation.map(of),
                },
            });
        }
        let grazing = followers.iter().filter_map(Follower::grazing).min_by(|a, b| a.time.total_cmp(&b.time));
        let history = self.finished(&simulation, schedule.lean, rows, events);
        Some(Ok((history, Gradients { parameters: derivatives, grazing })))
    }
}

/// Adds the derivatives of a row to those of each parameter.
pub(crate) fn add_rows(
    of_parameters: &mut [Vec<Row>],
    followers: &[Follower],
    simulation: &Simulation,
    inputs: &Inputs,
    row: &Row,
) {
    for (rows, follower) in of_parameters.chunks_mut(BATCH).zip(followers) {
        let seen = follower.observe(simulation, inputs);
        let ([kinetic, total], ground) = follower.energies_and_ground(simulation, inputs);
        for (i, rows) in rows.iter_mut().enumerate() {
            rows.push(Row {
                observation: seen.map(|number| number.eps[i]),
                energies: Energies { kinetic: kinetic.eps[i], total: total.eps[i], ..Energies::default() },
                slip: follower.slip().eps[i],
                ground: ground.map(|number| number.eps[i]),
                ..*row
            });
        }
    }
}
