//! A row of a sweep → the columns of its table.

use crate::intensity::Measure;
use crate::output::table::TableColumn;
use crate::run::outcome::{self, End, Outcome, OutcomeRow};
use crate::run::{fatigue, sliding};
use crate::search::{OutcomeMap, Threshold};
use crate::sweep::strength::Strengths;
use crate::sweep::{RowInputs, Sweep};

impl Sweep {
    /// The columns: of the block, of the ground motion, and of the run or search.
    pub(super) fn columns<'a>(&'a self) -> Vec<TableColumn<'a, SweepRow<'a>>> {
        type Of<'a> = TableColumn<'a, SweepRow<'a>>;
        let parameters = self.parameters.iter().enumerate();
        let mut columns: Vec<Of> = vec![Of::row(|row| row.inputs.row)];
        columns.extend(
            parameters
                .map(|(number, swept)| swept.parameter.column(move |row: &SweepRow| row.inputs.combination[number])),
        );
        let names = |component: usize| self.motions.iter().map(move |motion| motion.names[component].clone());
        columns.extend(
            ["record", "vertical"]
                .into_iter()
                .enumerate()
                .map(|(component, name)| Of::choice(name, names(component), |row| row.inputs.motion_number)),
        );
        if self.has_building() {
            columns.push(Of::count("floor", |row| row.inputs.motion.floor.unwrap_or_default()));
        }
        columns.extend([
            Of::optional("scale", "1", |row| row.inputs.motion.has_record().then_some(row.inputs.scale)),
            Of::optional("PGA.vertical", "m/s2", |row| row.inputs.motion.vertical_pga(row.inputs.scale)),
        ]);
        columns.extend(self.measures.iter().map(|&measure| {
            Of::optional(measure.to_string(), measure.unit(), move |row| row.inputs.intensity(measure))
        }));
        match &self.strengths {
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Hunt(..) => {
                columns.extend(outcome::columns(self.holds()));
            }
            Strengths::Least(measure, _) => columns.extend(of_search(*measure)),
        }
        let run = |row: &SweepRow| self.nominal_run(row.inputs);
        columns.extend(self.friction_demand.map(|friction| sliding::column(friction, run)));
        columns.extend(self.half_cycles.map(|amplitude| fatigue::column(amplitude, run)));
        columns.extend(self.ensemble.iter().flat_map(|ensemble| ensemble.columns(|row: &SweepRow| &row.made[1..])));
        columns
    }
}

/// A row of the table.
pub(super) struct SweepRow<'a> {
    pub(super) inputs: &'a RowInputs<'a>,
    /// The run, followed by its samples, each with its block's slenderness (rad). None in a search.
    pub(super) made: &'a [(f64, Outcome)],
    /// The outcomes over the range of a search.
    pub(super) found: Option<&'a OutcomeMap<End>>,
}

impl OutcomeRow for SweepRow<'_> {
    fn outcome(&self) -> &Outcome {
        &self.made[0].1
    }

    fn alpha(&self) -> f64 {
        self.made[0].0
    }
}

/// The columns of a search over a measure.
///
/// In order: the worst outcome; the least value that overturns, and whether it is only a bound; the value above which the block
/// always overturns; the number of overturning ranges, and the ranges, such as "0.79 to 0.8; 0.85 to 3".
fn of_search<'a>(measure: Measure) -> Vec<TableColumn<'a, SweepRow<'a>>> {
    fn found<'r>(row: &'r SweepRow) -> &'r OutcomeMap<End> {
        row.found.unwrap_or_else(|| unreachable!("the rows of a search"))
    }
    let ranges = |row: &SweepRow| found(row).stretches().into_iter().filter(|stretch| stretch.2 == End::Overturned);
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
