//! The object → blocks of its shape in other sizes. The ground motions are those of the study at one strength.

use crate::assess::plan::Plan;
use crate::assess::results::SizeResult;
use crate::output::table::Table;
use crate::spectrum::statistics::Statistics;
use crate::spectrum::{CheckedSpectrum, FoundationCurve, ScaledFeatures, Sizes, Spectrum};
use crate::sweep::strength::Strengths;
use rocking_block::block::{BlockError, Common};

/// Sizes from half to twice the object, as 1/p: it is one of them.
const SIZES: u64 = 61;
const RANGE: f64 = 2.0;

/// A spectrum of the object's shape.
pub struct SizeSpectrum {
    /// The spectrum.
    pub spectrum: CheckedSpectrum,
    /// Its table.
    pub table: Table,
    /// Statistics over the ground motions.
    pub statistics: Statistics,
    /// The strength of the ground motions, in words.
    pub strength: String,
}

/// Returns the spectrum of an object in the plane, and the strength of its ground motions. It is the middle one of the study's list.
pub(super) fn of(plan: &Plan) -> Result<Option<(CheckedSpectrum, String)>, BlockError> {
    let Plan { sweep, object, values, .. } = plan;
    let Some(block) = object.in_plane() else { return Ok(None) };
    let middle = sweep.strengths.count() / 2;
    let strength = match &sweep.strengths {
        Strengths::Levels(measure, levels) => format!("{measure} = {} {}", levels[middle as usize], measure.unit()),
        Strengths::Scales(scales) => format!("{} times the records", scales[middle as usize]),
        Strengths::Least(..) | Strengths::Hunt(..) => unreachable!("refused by the plan"),
    };
    let (alpha, p) = (block.alpha, block.p);
    let name = |motion: usize| {
        let motion = &sweep.motions[motion];
        let floor = motion.floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
        format!("{}{floor}", motion.names[0])
    };
    let motions = (0..sweep.motions.len()).map(|motion| (name(motion), sweep.ground(motion, middle, block)));
    let spectrum = Spectrum {
        alpha,
        common: Common { eccentricity: 0.0, ..block.common() },
        in_proportion: ScaledFeatures::of(block),
        bases: vec![FoundationCurve::of(block)],
        sizes: Sizes { least: p / RANGE, greatest: p * RANGE, count: SIZES },
        motions: motions.collect(),
        pulse: values.variables.pulse(),
        settings: values.variables.settings(Some(sweep.tolerance)),
        duration: sweep.duration,
        step: sweep.step,
        friction_demand: None,
    };
    Ok(Some((spectrum.checked()?, strength)))
}

impl SizeSpectrum {
    /// The outcomes of each size; empty for a single ground motion, which has no statistics.
    pub(super) fn results(&self) -> Vec<SizeResult> {
        let cells = self.statistics.groups.first().map(|group| group.cells.as_slice()).unwrap_or_default();
        let size = |(number, cell): (u64, &crate::spectrum::statistics::SizeStatistics)| SizeResult {
            p: self.spectrum.sizes.p(number),
            rocked: cell.rocked,
            at_rest: cell.at_rest(),
            overturned: cell.ends.overturned,
            undecided: cell.ends.separated + cell.ends.undecided + cell.ends.failed,
            geometric_mean: cell.geometric_mean(),
        };
        (0..).zip(cells).map(size).collect()
    }
}
