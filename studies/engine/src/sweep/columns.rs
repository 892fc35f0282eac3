//! A row of a sweep → the columns of its table.

use crate::input::motion::{self, MOTION, Motion};
use crate::intensity::Measure;
use crate::output::table::TableColumn;
use crate::run::outcome::{self, End};
use crate::run::{Run, fatigue, sliding};
use crate::search::{OutcomeMap, Threshold};
use crate::sweep::Sweep;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::rows::{RowInputs, SearchRow, SweepRow, SweptRun};

impl Sweep {
    /// The columns of a study of runs. They describe the block, the ground motion, and the run with its samples.
    pub(super) fn columns_of_runs<'a, E: SweptRun + 'a>(&'a self) -> Vec<TableColumn<'a, SweepRow<'a, E>>> {
        let mut columns = self.columns_of_inputs(|row: &SweepRow<'a, E>| &row.inputs);
        columns.extend(E::columns(self));
        fn samples<'r, E: SweptRun>(row: &'r SweepRow<E>) -> &'r [E::Outcome] {
            &row.samples
        }
        columns.extend(self.ensemble.iter().flat_map(|ensemble| ensemble.columns(samples::<E>)));
        columns
    }

    /// The columns of the run of a block in the plane.
    pub(super) fn columns_of_outcomes(&self) -> Vec<TableColumn<'_, SweepRow<'_, Run>>> {
        let mut columns = outcome::columns(self.holds(), |row: &SweepRow<Run>| &row.outcome);
        columns.extend(self.friction_demand.map(sliding::column));
        columns.extend(self.half_cycles.map(fatigue::column));
        columns
    }

    /// The columns of a study of searches over a measure. They describe the block, the ground motion, and the search.
    pub(super) fn columns_of_searches(&self, measure: Measure) -> Vec<TableColumn<'_, SearchRow<'_>>> {
        let mut columns = self.columns_of_inputs(|row: &SearchRow| &row.0);
        columns.extend(of_search(measure));
        columns
    }

    fn columns_of_inputs<'a, R: 'a>(&'a self, of: fn(&R) -> &RowInputs<'a>) -> Vec<TableColumn<'a, R>> {
        type Of<'a, R> = TableColumn<'a, R>;
        let parameters = self.parameters.iter().enumerate();
        let mut columns: Vec<Of<R>> = vec![Of::row(move |row| of(row).row)];
        columns.extend(
            parameters.map(|(number, swept)| swept.parameter.column(move |row: &R| of(row).combination[number])),
        );
        let mut of_motion = |name: &str, word: fn(&GroundMotion) -> String| {
            columns.push(Of::choice(name, self.motions.iter().map(word), move |row| of(row).motion_number));
        };
        of_motion("record", |motion| motion.names[0].clone());
        if self.space.is_some() {
            of_motion("record_y", |motion| motion.transverse.as_ref().map_or(String::new(), |y| y.name.clone()));
        }
        of_motion("vertical", |motion| motion.names[1].clone());
        let motions: Vec<Motion> = self.motions.iter().map(|motion| motion.motion.clone()).collect();
        let names = self.motions.iter().map(|motion| motion.names.each_ref().map(String::as_str));
        if let Some(words) = motion::column(&motions, names) {
            columns.push(Of::choice(MOTION, words, move |row| of(row).motion_number));
        }
        if self.space.is_some() {
            columns.push(Of::real("azimuth", "deg", move |row| of(row).motion.azimuth));
        }
        if self.has_building() {
            columns.push(Of::count("floor", move |row| of(row).motion.floor.unwrap_or_default()));
        }
        columns.extend([
            Of::optional("scale", "1", move |row| of(row).motion.has_record().then_some(of(row).scale)),
            Of::optional("PGA.vertical", "m/s2", move |row| of(row).motion.vertical_pga(of(row).scale)),
        ]);
        columns.extend(
            self.measures.iter().map(|&measure| {
                Of::optional(measure.to_string(), measure.unit(), move |row| of(row).intensity(measure))
            }),
        );
        columns
    }
}

/// The columns of a search over a measure.
///
/// In order: the worst outcome; the least value that overturns, and whether it is only a bound; the value above which the block
/// always overturns; the number of overturning ranges, and the ranges, such as "0.79 to 0.8; 0.85 to 3".
fn of_search<'a>(measure: Measure) -> Vec<TableColumn<'a, SearchRow<'a>>> {
    fn found<'r>(row: &'r SearchRow) -> &'r OutcomeMap<End> {
        &row.1
    }
    let ranges = |row: &SearchRow| found(row).stretches().into_iter().filter(|stretch| stretch.2 == End::Overturned);
    vec![
        TableColumn::choice("outcome", End::ALL.map(End::word), |row| {
            let stretches = found(row).stretches();
            let any = |end: &End| stretches.iter().any(|stretch| stretch.2 == *end);
            [End::Failed, End::Overturned, End::Undecided].into_iter().find(any).unwrap_or(End::Completed) as usize
        }),
        TableColumn::optional(format!("least.{measure}"), measure.unit(), |row| found(row).overturning().value()),
        TableColumn::choice("least.bound", Threshold::BOUNDS, |row| found(row).overturning().bound_position()),
        TableColumn::optional(format!("always_from.{measure}"), measure.unit(), |row| {
            let stretches = found(row).stretches();
            stretches.last().filter(|stretch| stretch.2 == End::Overturned).map(|stretch| stretch.0)
        }),
        TableColumn::count("overturning_ranges", move |row| ranges(row).count()),
        TableColumn::text(format!("overturning.{measure}"), move |row| {
            ranges(row).map(|(from, to, _)| format!("{from} to {to}")).collect::<Vec<_>>().join("; ")
        })
        .with_unit(Some(measure.unit())),
    ]
}
