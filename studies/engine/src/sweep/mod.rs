//! Parameters over grids or samples × ground motions × strengths → a table of outcomes.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`parameters`] | parameters and their values → the combinations of a grid or a Latin hypercube |
//! | [`ground_motion`] | records → ground motions with their measures |
//! | [`strength`] | `scales`, `levels`, `hunt` or `least` → factors on the records |
//! | [`hunt`] | the runs of a block under a record → the level of the next one |
//! | [`ensemble`] | distributions of uncertain quantities → samples of each row, probabilities |
//! | [`amplified`] | factors on records → doubts about strong ones |
//! | [`change`] | a block → the same block with another base, foundation, friction or ties |
//! | `rows` | the number of a row → its run; rows → a table |
//! | [`space`] | parameters of a study of blocks in space → blocks and their runs |
//! | `columns` | a row → the columns of the table |
//! | `records` | `[[records]]` of a study file → ground motions |
//! | `check` | a study that is read → its faults |
//! | [`mod@file`] | a study file → a sweep with valid values |

pub mod amplified;
pub mod change;
mod check;
mod columns;
pub mod ensemble;
pub mod file;
pub mod ground_motion;
pub mod hunt;
pub mod parameters;
pub(crate) mod records;
mod rows;
pub mod space;
pub mod strength;

use crate::building::Building;
use crate::doubts;
use crate::intensity::{BlockScales, Measure};
use crate::output::parts::{Part, PartNumber};
use crate::output::resumable::TableHeader;
use crate::output::runner::{Study, StudyRows};
use crate::run::outcome::Holds;
use crate::run::{Run, is_moved};
use crate::space::RunInSpace;
use crate::spec::SpecError;
use crate::spec::numbers_in_space::{BeginningSpec, NumbersInSpace};
use crate::sweep::change::{Change, holds_of_variables, tie_field};
use crate::sweep::check::Checks;
use crate::sweep::ensemble::Ensemble;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::{Design, ParameterValues, SweptParameter};
use crate::sweep::rows::RowValues;
use crate::sweep::space::BlocksInSpace;
use crate::sweep::strength::Strengths;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, BlockError};
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::OnSeparation;
use rocking_block::space::{SpaceBody, SpaceInitial, SpaceParameters};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// A sweep: each combination of parameters × each motion × each strength is a row.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Description of the study, line by line.
    pub text: Vec<String>,
    /// The parameters named in the study.
    pub parameters: Vec<SweptParameter>,
    /// How they are combined.
    pub design: Design,
    /// What blocks in space share; `None` for blocks in the plane.
    pub space: Option<BlocksInSpace>,
    /// Ground motions, at least one; an empty motion is no shaking. Those of blocks in space have a direction each.
    pub motions: Vec<GroundMotion>,
    /// The building on whose floors the blocks stand, if any.
    pub building: Option<Building>,
    /// The strengths of each.
    pub strengths: Strengths,
    /// The samples of each row, if any.
    pub ensemble: Option<Ensemble>,
    /// Measures of the records with a column in the table.
    pub measures: Vec<Measure>,
    /// Behaviour at complete separation, unless `on_separation` is a parameter.
    pub on_separation: OnSeparation,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
    /// Duration of each run (s); without it, until the block has come down.
    pub duration: Option<f64>,
    /// Longest time between two stops (s). Without it, only record samples and pulse ends are stops.
    pub step: Option<f64>,
    /// Friction demand (1) of the column with the longest time above it, if any.
    pub friction_demand: Option<f64>,
    /// Amplitude (m) of the column of half cycles of plastic elongations, if any.
    pub half_cycles: Option<f64>,
    /// Changes of each block, one after the other. The ground motions stay those of the blocks without them.
    pub changes: Vec<Change>,
    /// Doubts about the records and their scale, a sentence each.
    pub remarks: Vec<String>,
}

impl Sweep {
    /// Number of combinations of parameters; `None` if it overflows.
    pub fn combinations(&self) -> Option<u64> {
        self.design.combinations(&self.parameters)
    }

    /// The numbers of the combinations that are checked, in their order.
    fn combinations_to_check<'a>(&'a self, checks: Checks<'a>) -> Box<dyn Iterator<Item = u64> + 'a> {
        match checks {
            Checks::All => Box::new(0..self.combinations().unwrap_or(0)),
            Checks::Parts(parts) => {
                let per_combination = self.motions.len() as u64 * self.strengths.count();
                let of_part = move |part: &PartNumber| {
                    let plan = Part::new(self, *part).plan();
                    (0..plan.rows()).map(move |position| plan.row(position) / per_combination)
                };
                let mut last = None;
                let numbers = parts.iter().flat_map(of_part);
                Box::new(numbers.filter(move |number| last.replace(*number) != Some(*number)))
            }
            Checks::None => Box::new(std::iter::empty()),
        }
    }

    /// The values of the parameters in a combination, in the order of `parameters`.
    pub fn combination(&self, number: u64) -> Vec<f64> {
        self.design.combination(number, &self.parameters)
    }

    /// The variables of the FMU in a combination.
    ///
    /// Variables without a value in the study have the FMU's start value, except `on_separation`. Numbers of a block in space are not
    /// among them.
    pub fn values(&self, combination: &[f64]) -> Values {
        let mut values = Values::default();
        values[Variable::OnSeparation] = f64::from(self.on_separation as i32);
        for (swept, value) in self.parameters.iter().zip(combination) {
            if let Some(variable) = swept.parameter.variable() {
                values[variable] = *value;
            }
        }
        values
    }

    /// Friction and ties of the blocks of the sweep.
    pub fn holds(&self) -> Holds {
        let any = |variable: Variable| {
            let swept = self.parameters.iter().find(|swept| swept.parameter.variable() == Some(variable));
            swept.is_some_and(|swept| match &swept.values {
                ParameterValues::List(values) => values.iter().any(|&value| value > 0.0),
                ParameterValues::Range { to, .. } => *to > 0.0,
            })
        };
        self.changes.iter().fold(holds_of_variables(any), |holds, change| change.holds(holds))
    }

    /// Remarks on blocks and pulses beyond reason, one of each kind.
    fn doubts(&self, checks: Checks) -> Vec<String> {
        let values = || self.combinations_to_check(checks).map(|number| self.values(&self.combination(number)));
        // An empty motion is no shaking.
        let has_record = self.motions.iter().all(|motion| !motion.ground.is_empty());
        let in_plane = values().filter(|_| self.space.is_none());
        let mut remarks = doubts::of_blocks(in_plane.filter_map(|values| self.block(&values).ok()));
        let in_space = self.combinations_to_check(checks).filter_map(|number| {
            let (blocks, numbers) = self.space.as_ref().zip(self.row_values(&self.combination(number)).in_space)?;
            let (parameters, body, _) = blocks.block(&numbers).ok()?;
            Some((parameters, body, numbers.block.mass.is_some()))
        });
        remarks.extend(doubts::of_blocks_in_space(in_space));
        remarks.extend(doubts::of_pulses(values().map(|values| (values.pulse(), values[Variable::G])), has_record));
        remarks
    }

    /// Everything that affects the rows, line by line: the study without comments and `[assess]`.
    pub fn identity(&self) -> Vec<String> {
        let Sweep { parameters, design, space, strengths, ensemble, measures, changes, .. } = self;
        let Sweep { on_separation, tolerance, duration, step, friction_demand, half_cycles, .. } = self;
        let names = parameters.iter().map(|SweptParameter { parameter, values }| (parameter.name(), values));
        let mut lines: Vec<String> = names.map(|swept| format!("{swept:?}")).collect();
        lines.push(format!("{:?}", (design, strengths, ensemble, measures, changes)));
        lines.push(format!("{:?}", (on_separation, tolerance, duration, step, friction_demand)));
        lines.extend(half_cycles.map(|amplitude| format!("half cycles above {amplitude:?}")));
        lines.extend(space.iter().map(|blocks| format!("{blocks:?}")));
        lines.extend(self.described_motions());
        lines
    }

    /// The names and the contents of the ground motions.
    fn described_motions(&self) -> impl Iterator<Item = String> {
        self.motions.iter().map(|motion| {
            let floor = motion.floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
            let names = if self.space.is_some() { motion.name() } else { motion.names.join(" + ") };
            format!("{names}{floor}: {}", motion.fingerprint())
        })
    }

    /// Whether the blocks stand on the floors of a building.
    pub fn has_building(&self) -> bool {
        self.motions.iter().any(|motion| motion.floor.is_some())
    }

    /// The sweep with changed blocks under its ground motions.
    #[must_use]
    pub fn with(&self, changes: &[Change]) -> Sweep {
        Sweep { changes: [&self.changes, changes].concat(), ..self.clone() }
    }

    /// Checks that all blocks are valid with these changes. One of them has to read each changed parameter.
    ///
    /// # Errors
    /// The first invalid parameter, or the condition under which a block would read an unread one.
    pub fn check_changes(&self, changes: &[Change]) -> Result<(), String> {
        let changed = self.with(changes);
        if self.space.is_some() {
            let made = (0..self.combinations().unwrap_or(0)).try_for_each(|number| {
                let numbers = self.row_values(&self.combination(number)).in_space;
                numbers.iter().try_for_each(|numbers| changed.block_in_space(numbers).map(|_| ()))
            });
            return made.map_err(|error| error.spelled(str::to_owned));
        }
        let is_of_tie = |variable| {
            let kind = |change: &Change| match change {
                Change::Tied(_) => Some(LinkKind::Tie),
                Change::Damped(_) => Some(LinkKind::Damper),
                Change::Parameter(..)
                | Change::Number(..)
                | Change::Width(_)
                | Change::StiffnessRatio(_)
                | Change::DampingRatio(_)
                | Change::FrictionOverThreshold(_) => None,
            };
            let mut added = changes.iter().filter_map(kind).map(|kind| [Tie { kind, ..Tie::default() }; 2]);
            added.any(|mut ties| tie_field(&mut ties, variable).is_some())
        };
        // An unread parameter and the condition under which a block reads it; `None` once a combination has read all.
        let mut unread = Some(("", "a combination"));
        for number in 0..self.combinations().unwrap_or(0) {
            let values = self.values(&self.combination(number));
            changed.block(&values).map_err(|error| error.to_string())?;
            let values = changes.iter().fold(values, |values, change| change.values(values));
            let found = changes.iter().find_map(|change| {
                let parameter = change.parameter().filter(|&variable| !is_of_tie(variable))?.name();
                values.unread_by_motion().find(|(name, _)| *name == parameter)
            });
            unread = unread.and(found);
        }
        unread
            .map_or(Ok(()), |(name, needed)| Err(format!("{name} is read by no block of the study; expected {needed}")))
    }

    /// The numbers of the block in space in a combination, if the study is one of blocks in space.
    pub fn numbers_in_space(&self, combination: &[f64]) -> Option<Box<NumbersInSpace>> {
        self.space.as_ref().map(|space| Box::new(space.numbers(&self.parameters, combination)))
    }

    /// The combination in the middle of the study, each parameter in its range's or list's middle.
    pub fn middle(&self) -> Vec<f64> {
        self.parameters.iter().map(|swept| swept.values.at(0.5)).collect()
    }

    /// A ground motion at one of the strengths. It is scaled for a block if the strength is relative to it.
    pub fn ground(&self, motion: usize, strength: u64, block: &Block) -> Ground {
        let motion = &self.motions[motion];
        motion.ground.clone().scaled(self.strengths.scale(strength, motion, block.into()))
    }

    /// The block of these values with the changes of the sweep.
    ///
    /// # Errors
    /// The first parameter that a change makes invalid.
    pub fn block(&self, values: &Values) -> Result<Block, BlockError> {
        let changed = self.changes.iter().fold(values.clone(), |values, change| change.values(values));
        self.changes.iter().try_fold(changed.block()?, |block, change| change.block(block, &self.changes))
    }

    /// The block in space of these numbers with the changes of the sweep, and its beginning.
    ///
    /// # Errors
    /// The first number that is not valid, or is not read, or a change that only a block in the plane has.
    pub fn block_in_space(
        &self,
        numbers: &NumbersInSpace,
    ) -> Result<(SpaceParameters, SpaceBody, SpaceInitial), SpecError> {
        let blocks = self.space.as_ref().unwrap_or_else(|| unreachable!("a study of blocks in space"));
        let mut numbers = numbers.clone();
        self.changes.iter().for_each(|change| change.number(&mut numbers));
        let (mut parameters, mut body, initial) = blocks.block(&numbers)?;
        for change in &self.changes {
            parameters = change.in_space(parameters, &body)?;
            body = SpaceBody::new(&parameters)?;
        }
        Ok((parameters, body, initial))
    }

    /// Whether a record, a pulse or the initial state moves the block.
    pub fn moves(&self, combination: &[f64], motion: &GroundMotion) -> bool {
        let RowValues { variables, in_space } = self.row_values(combination);
        match in_space {
            Some(numbers) => {
                motion.has_record() || !variables.pulse().is_none() || numbers.beginning != BeginningSpec::default()
            }
            None => is_moved(&motion.ground, &variables.pulse(), &variables.initial()),
        }
    }

    /// The scales of the block of a row, without the changes of the sweep.
    fn scales(&self, values: &RowValues) -> Result<BlockScales, String> {
        match self.space {
            Some(_) => self.scales_in_space(values).map_err(|error| error.spelled(str::to_owned)),
            None => values.variables.block().map(|block| (&block).into()).map_err(|error| error.to_string()),
        }
    }

    /// The scales of the block in space of a row.
    fn scales_in_space(&self, values: &RowValues) -> Result<BlockScales, SpecError> {
        let both = self.space.as_ref().zip(values.in_space.as_ref());
        let (blocks, numbers) = both.unwrap_or_else(|| unreachable!("a study of blocks in space"));
        blocks.block(numbers).map(|(_, body, _)| (&body).into())
    }
}

impl Study for Sweep {
    fn header(&self) -> TableHeader {
        let mut study = vec![concat!("rocking-block ", env!("CARGO_PKG_VERSION"), " sweep").to_string()];
        study.extend(self.space.iter().map(|_| "block in space".to_string()));
        study.extend(self.text.iter().cloned());
        study.extend(self.space.iter().filter_map(BlocksInSpace::fingerprint));
        study.push(format!("on_separation = {:?}, where the study does not name it", self.on_separation));
        study.extend(self.changes.iter().map(|change| format!("each block changed: {change:?}")));
        study.extend(self.described_motions());
        let columns = match self.space {
            Some(_) => self.headings_of::<RunInSpace>(),
            None => self.headings_of::<Run>(),
        };
        TableHeader { study, columns }
    }

    fn rows(&self) -> u64 {
        self.combinations().unwrap_or(0) * self.motions.len() as u64 * self.strengths.count()
    }

    fn runs_in_a_row(&self) -> u64 {
        match &self.strengths {
            Strengths::Least(_, scan) => scan.points,
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Hunt(..) => {
                1 + self.ensemble.as_ref().map_or(0, |ensemble| u64::from(ensemble.samples))
            }
        }
    }

    fn rows_together(&self) -> u64 {
        match &self.strengths {
            Strengths::Hunt(_, hunt) => hunt.runs,
            Strengths::Scales(_) | Strengths::Levels(..) | Strengths::Least(..) => 1,
        }
    }

    fn uses_lanes(&self) -> bool {
        self.space.is_none()
    }

    fn make(&self, numbers: &[u64], width: Option<VectorWidth>) -> StudyRows {
        match self.space {
            Some(_) => self.made::<RunInSpace>(numbers, width),
            None => self.made::<Run>(numbers, width),
        }
    }
}
