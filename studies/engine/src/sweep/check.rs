//! A study that is read → its faults: keys without effect, too many rows, unread parameters, invalid blocks.

use crate::input::parameters::{Parameter, Vocabulary};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText};
use crate::intensity::{BlockScales, Measure};
use crate::output::parts::PartNumber;
use crate::spec::SpecError;
use crate::spec::study::{Distribution, StudyFile};
use crate::sweep::ensemble::{Ensemble, SpreadTarget, SpreadWidth, UncertainQuantity};
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::ParameterValues;
use crate::sweep::rows::RowValues;
use crate::sweep::strength::Strengths;
use crate::sweep::{Sweep, strength};
use rocking_block::block::Block;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// Greatest number of rows of a sweep.
const MAX_ROWS: u64 = 1_000_000_000;

/// A parameter of the file and the place of its value in the text.
pub(super) struct GivenParameter<'a> {
    pub value: SpannedValue<'a>,
    pub parameter: Parameter,
    pub values: ParameterValues,
}

/// The combinations of parameters of a study that are checked before its runs.
///
/// A check takes some 15 µs, so a part checks its own combinations only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checks<'a> {
    /// All.
    All,
    /// Those of some parts. Whether any block reads a parameter is not asked.
    Parts(&'a [PartNumber]),
    /// None: they were checked before.
    None,
}

/// Checks that the strengths of blocks in space are measures of pairs, and those of the plane measures of one component.
pub(super) fn pairs(
    file: &Section<StudyFile>,
    vocabulary: Vocabulary,
    strengths: &Strengths,
) -> Result<(), StudyFileError> {
    let Some(measure) = strengths.measure() else { return Ok(()) };
    let is_of_pair = measure.of_component().1.is_some();
    if is_of_pair == (vocabulary == Vocabulary::Space) {
        return Ok(());
    }
    let expected = match vocabulary {
        Vocabulary::Plane => "one of a single component, such as PGV, for a block in the plane",
        Vocabulary::Space => {
            "one of two components, such as PGV.RotD50, PGA.larger or Sa(0.5 s).geomean, for a block in space"
        }
    };
    Err(file.refused(&strength::path(file), format!("found the measure {measure}; expected {expected}")))
}

/// Refuses the quantities of single runs beside a search.
pub(super) fn of_one_run(file: &Section<StudyFile>, strengths: &Strengths) -> Result<(), StudyFileError> {
    for path in ["study.friction_demand", "study.half_cycles"] {
        if matches!(strengths, Strengths::Least(..)) && file.get(path).is_some() {
            return Err(file.wrong(path, "none beside least, which makes many runs per row"));
        }
    }
    Ok(())
}

/// Checks that a building has records to shake it. A measure of floors needs a building.
pub(super) fn building(
    file: &Section<StudyFile>,
    motions: &[GroundMotion],
    strengths: &Strengths,
) -> Result<(), StudyFileError> {
    let shaken = motions.iter().all(|motion| motion.ground.horizontal.is_some());
    if file.building.is_some() && !shaken {
        return Err(file.refused("building", "building has no effect without a horizontal record in each [[records]]"));
    }
    match strengths.measure() {
        Some(measure) if file.building.is_none() && Measure::OF_FLOOR.contains(&measure) => {
            Err(file.refused(&strength::path(file), format!("{measure} is that of a floor; expected a [building]")))
        }
        _ => Ok(()),
    }
}

/// Checks that an ensemble spreads only quantities of the study. Each row must have the runs for it.
pub(super) fn ensemble(
    file: &Section<StudyFile>,
    ensemble: Option<&Ensemble>,
    without_records: bool,
    strengths: &Strengths,
) -> Result<(), StudyFileError> {
    let (Some(ensemble), path) = (ensemble, "study.ensemble") else { return Ok(()) };
    if without_records && ensemble.spreads.iter().any(|spread| spread.target == SpreadTarget::Scale) {
        return Err(file.refused(path, "scale has no effect without [[records]]"));
    }
    match strengths {
        Strengths::Least(..) => Err(file.wrong(path, "none beside least, which makes many runs per row")),
        Strengths::Hunt(..) => Err(file.wrong(path, "none beside hunt, whose levels follow single runs")),
        Strengths::Scales(_) | Strengths::Levels(..) => Ok(()),
    }
}

/// Checks that all samples of an ensemble make a block, which reads their values. Blocks that are valid at all corners of the spreads are
/// valid between them.
fn samples(ensemble: &Ensemble, sweep: &Sweep, values: &RowValues) -> Result<(), String> {
    let ends = [0.5 / f64::from(ensemble.samples), 1.0 - 0.5 / f64::from(ensemble.samples)];
    for corner in 0..1_usize << ensemble.spreads.len() {
        let mut values = values.clone();
        for (number, spread) in ensemble.spreads.iter().enumerate() {
            let SpreadTarget::Parameter(parameter) = &spread.target else { continue };
            let name = parameter.name();
            let nominal = values.number(parameter);
            let nominal =
                nominal.ok_or_else(|| format!("{name} of the ensemble has no value in [parameters]; expected one"))?;
            if parameter.shown(nominal).is_infinite() {
                return Err(format!("{name} = {} cannot vary; expected a number", parameter.display(nominal)));
            }
            if nominal == 0.0
                && (matches!(spread.width, SpreadWidth::Relative(_)) || spread.distribution == Distribution::Lognormal)
            {
                let expected = "a deviation of a normal or uniform distribution";
                return Err(format!("{name} = 0 has no coefficient of variation; expected {expected}"));
            }
            let sample = parameter.number(spread.value(nominal, ends[corner >> number & 1]));
            let sample = sample.map_err(|message| format!("in a sample of the ensemble, {message}"))?;
            values.set(parameter, sample);
        }
        sweep.scales(&values).map_err(|error| format!("in a sample of the ensemble, {error}"))?;
        let unread = |(name, needed): (&str, &str)| {
            let is = |spread: &UncertainQuantity| matches!(&spread.target, SpreadTarget::Parameter(p) if p.variable().is_some() && p.full_name() == name);
            let name = Parameter::named(name).ok()?.name();
            let spread = ensemble.spreads.iter().find(|spread| is(spread));
            spread.map(|_| format!("{name} of the ensemble is not read; expected {needed}"))
        };
        if let Some(message) = values.variables.unread_by_motion().find_map(unread) {
            return Err(message);
        }
    }
    Ok(())
}

/// Finds a parameter by its name in errors, such as "yield force of tie_1".
fn named<'g, 'a>(given: &'g [GivenParameter<'a>], name: &str) -> Option<&'g GivenParameter<'a>> {
    let named = |name: &str| {
        given.iter().find(|GivenParameter { parameter, .. }| {
            let full = parameter.full_name();
            full == name || full.ends_with(&format!(".{name}")) || full.starts_with(&format!("{name}."))
        })
    };
    match name.rsplit_once(" of ") {
        Some((number, link)) => named(&format!("{link}.{}", number.replace(' ', "_"))).or_else(|| named(link)),
        None => named(name),
    }
}

/// Checks the whole study: the number of rows, unread parameters, and invalid blocks.
pub(super) fn combinations(
    sweep: &Sweep,
    given: &[GivenParameter],
    file: &Section<StudyFile>,
    checks: Checks,
) -> Result<(), StudyFileError> {
    let source = file.source;
    if sweep.half_cycles.is_some() && !sweep.holds().yields {
        return Err(file.wrong("study.half_cycles", "none without a tie or damper with yield_force"));
    }
    let per_combination = sweep.motions.len() as u64 * sweep.strengths.count();
    let combinations = sweep.combinations();
    let rows = combinations.and_then(|count| count.checked_mul(per_combination)).filter(|rows| *rows <= MAX_ROWS);
    if rows.is_none() {
        let message = format!("combinations × records × strengths give too many rows; expected at most {MAX_ROWS}");
        return Err(source.wrong(&(0..0), message));
    }
    // The condition under which a block reads each parameter; `None` once a combination has read it.
    let mut needed: Vec<Option<&str>> = vec![Some("a combination"); given.len()];
    for number in sweep.combinations_to_check(checks) {
        let combination = sweep.combination(number);
        let values = sweep.row_values(&combination);
        let scales = match &values.in_space {
            Some(_) => space_scales(sweep, &values, given, file)?,
            None => (&plane_block(&values.variables, given, source)?).into(),
        };
        check_level(sweep, scales, file)?;
        if let Some(ensemble) = &sweep.ensemble {
            samples(ensemble, sweep, &values).map_err(|message| file.refused("study.ensemble", message))?;
        }
        if !sweep.motions.iter().all(|motion| sweep.moves(&combination, motion)) {
            let initial = if sweep.space.is_some() { "initial.tilt_x" } else { "initial.theta or initial.theta_dot" };
            let message = format!(
                "nothing moves the block; expected [[records]], a pulse.shape with a pulse.amplitude, or an {initial}"
            );
            return Err(source.wrong(&named(given, "amplitude").map_or(0..0, |given| given.value.span()), message));
        }
        for (given, needed) in given.iter().zip(&mut needed).filter(|(_, needed)| needed.is_some()) {
            let name = given.parameter.full_name();
            let mut unread = values.variables.unread_by_motion();
            // A block in space refuses numbers that it would not read.
            let unread = given.parameter.variable().and_then(|_| unread.find(|(unread, _)| *unread == name));
            *needed = unread.map(|(_, needed)| needed);
        }
    }
    match given.iter().zip(&needed).find_map(|(given, needed)| needed.map(|needed| (given, needed))) {
        Some((given, needed)) if checks == Checks::All => {
            let name = given.parameter.name();
            let message = format!("{name} is read by no block of the study; expected {needed}");
            Err(source.wrong(&given.value.span(), message))
        }
        _ => Ok(()),
    }
}

/// Checks that each ground motion has the prescribed measure, for a block of these scales.
fn check_level(sweep: &Sweep, scales: BlockScales, file: &Section<StudyFile>) -> Result<(), StudyFileError> {
    let Some(measure) = sweep.strengths.measure() else { return Ok(()) };
    let has_none = |motion: &&GroundMotion| motion.intensity(measure, 1.0, scales).is_none_or(|value| value <= 0.0);
    match sweep.motions.iter().find(has_none) {
        Some(motion) => {
            let name = if sweep.space.is_some() { motion.name() } else { motion.names.join(" ") };
            let message = format!("the horizontal record of {name} has no {measure} above 0");
            Err(file.refused(&strength::path(file), message))
        }
        None => Ok(()),
    }
}

/// The scales of a block in space.
fn space_scales(
    sweep: &Sweep,
    values: &RowValues,
    given: &[GivenParameter],
    file: &Section<StudyFile>,
) -> Result<BlockScales, StudyFileError> {
    sweep.scales_in_space(values).map_err(|error: SpecError| {
        // Such as "base = circle".
        let name = error.parameter().and_then(|name| name.split(' ').next()).unwrap_or_default();
        let of_shape = file.get(&format!("parameters.{name}"));
        let place = of_shape.or(named(given, name).map(|given| given.value)).map_or(0..0, |value| value.span());
        file.source.wrong(&place, error.spelled(str::to_owned))
    })
}

/// The block in the plane of these values.
fn plane_block(values: &Values, given: &[GivenParameter], source: StudyText) -> Result<Block, StudyFileError> {
    let block = values.block().map_err(|error| {
        let place = named(given, error.name()).map_or(0..0, |given| given.value.span());
        source.wrong(&place, error.to_string())
    })?;
    let is_given = |variable: &&Variable| given.iter().any(|given| given.parameter.variable() == Some(**variable));
    let Some(missing) = values.sizes().into_iter().find(|variable| !is_given(&variable)) else { return Ok(block) };
    let sizes: Vec<&str> = values.sizes().iter().map(|variable| variable.name()).collect();
    let place = named(given, "parameterization").map_or(0..0, |given| given.value.span());
    let message = format!("parameterization = \"Physical\" without {}; expected {}", missing.name(), sizes.join(", "));
    Err(source.wrong(&place, message))
}
