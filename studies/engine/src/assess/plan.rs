//! `[assess]` of a study file → states, hazard, variants, assumptions.

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::assess::alternatives::{self, Alternative, Assumption};
use crate::assess::object::{AssessedObject, ObjectValues};
use crate::fragility::Limit;
use crate::input::parameters::{Parameter, Vocabulary, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, THE_FILE, number};
use crate::intensity::{ComponentMeasure, Measure, OverDirections};
use crate::risk::{HazardCurve, HazardOptions, read_hazard};
use crate::spec::assess::{AssessTable, HazardTable, Site, StateTable, VariantTable};
use crate::spec::study::StudyFile;
use crate::spec::words::Words;
use crate::sweep::Sweep;
use crate::sweep::change::Change;
use crate::sweep::file;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::strength::Strengths;
use rocking_block::excitation::PulseShape;
use rocking_block::unit::variables::Kind;

/// An assessment that is ready to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the object.
    pub title: String,
    /// Who answers for the study.
    pub author: Option<String>,
    /// Date of the study.
    pub date: Option<String>,
    /// Name of the study file.
    pub file: String,
    /// The runs.
    pub sweep: Sweep,
    /// The values of the object: each parameter in the middle of its range or list.
    pub values: ObjectValues,
    /// The object.
    pub object: AssessedObject,
    /// Height of its body (m), if the study gives it.
    pub height: Option<f64>,
    /// The intensity measure of curves and hazard.
    pub measure: Measure,
    /// Limits on the response, the least severe first.
    pub states: Vec<State>,
    /// Hazard curve, its file and the options of its reading, if any.
    pub hazard: Option<Hazard>,
    /// Years of the probabilities.
    pub years: f64,
    /// Shape of the pulses whose least amplitude is searched.
    pub pulse: PulseShape,
    /// Their periods T_p (s).
    pub pulse_periods: Vec<f64>,
    /// Variants of the object.
    pub variants: Vec<Alternative>,
    /// Whether they are the usual ones.
    pub has_usual_variants: bool,
    /// Quantities at the ends of their ranges.
    pub assumptions: Vec<Assumption>,
    /// Remarks on usual variants and assumptions that do not fit the object.
    pub left_out: Vec<String>,
    /// The files that were read.
    pub inputs: Vec<Input>,
}

/// A hazard curve and its origin.
#[derive(Clone, Debug)]
pub struct Hazard {
    /// The file.
    pub file: String,
    /// The options of its reading, as in the study.
    pub options: HazardOptions,
    /// The curve.
    pub curve: HazardCurve,
}

/// A limit on the response.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Its name.
    pub name: String,
    /// The limit.
    pub limit: Limit,
    /// The publication or decision behind it.
    pub source: Option<String>,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Input {
    /// Its name, as in the study.
    pub file: String,
    /// SHA-256 of its bytes, as `sha256sum` prints it.
    pub sha256: String,
}

impl Input {
    fn of(file: &str, bytes: &[u8]) -> Input {
        let sha256 = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        Input { file: file.into(), sha256 }
    }
}

impl Plan {
    /// The floors of a building on which the object stands, each once.
    pub fn floors(&self) -> Vec<usize> {
        let mut floors: Vec<usize> = self.sweep.motions.iter().filter_map(|motion| motion.floor).collect();
        floors.sort_unstable();
        floors.dedup();
        floors
    }

    /// Reads a plan from the text of a study file. Its paths are relative to `folder`.
    ///
    /// # Errors
    /// Those of [`file::read`]; a study without records or with one strength of a kind that has no curve; an invalid `[assess]`.
    pub fn read(file: &str, text: &str, folder: &Path) -> Result<Plan, StudyFileError> {
        let sweep = file::read(file, text, folder)?;
        let source = StudyText { file, text };
        let document = source.parse()?;
        let root = Section::<StudyFile>::read(source, THE_FILE, document.span(), document.get_ref())?;
        let expected = "the file has no [assess]; expected title = \"Statue\" at least";
        let assess = root.assess.as_ref().ok_or_else(|| root.refused("", expected))?;
        check_runs(&sweep, &root)?;
        check_names(&sweep, &root)?;
        let values = ObjectValues::middle(&sweep);
        let object = values
            .object(&sweep)
            .map_err(|error| root.refused("assess", format!("the object in the middle of the study: {error}")))?;
        let measure = measure(&root, assess, &sweep)?;
        let gravity = object.scales().gravity;
        let hazard = assess.hazard.as_ref().map(|table| hazard(&root, table, measure, gravity, folder));
        let (input, hazard) = hazard.transpose()?.unzip();
        let mut inputs = vec![Input::of(file, text.as_bytes())];
        inputs.extend(input);
        for name in sweep.motions.iter().flat_map(GroundMotion::read_files) {
            if inputs.iter().all(|known| known.file != *name) {
                let bytes = std::fs::read(folder.join(name))
                    .map_err(|error| source.wrong(&(0..0), format!("{name}: cannot be read: {error}")))?;
                inputs.push(Input::of(name, &bytes));
            }
        }
        let usual = alternatives::usual(&sweep, &values, &object);
        let chosen = assess.variants.as_ref().map(|tables| variants(&root, tables, &sweep)).transpose()?;
        let ranges = assess.sensitivity.as_ref().map(|_| sensitivity(&root, &sweep, &values)).transpose()?;
        let pulse = match &assess.pulse {
            Some(word) => {
                let shape = PulseShape::named(word).filter(|shape| *shape != PulseShape::None);
                let known = PulseShape::WORDS.iter().filter(|(_, shape)| *shape != PulseShape::None);
                let known = || known.map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
                shape.ok_or_else(|| root.wrong("assess.pulse", &format!("one of {}", known())))?
            }
            None => PulseShape::OneSine,
        };
        let periods = assess.pulse_periods.as_ref();
        let periods = periods.map(|periods| periods.iter().map(|period| period.0).collect());
        Ok(Plan {
            title: assess.title.clone(),
            author: assess.author.clone(),
            date: assess.date.clone(),
            file: file.into(),
            height: values.height(&object),
            states: states(&root, assess, &sweep)?,
            hazard,
            years: assess.years.map_or(50.0, |years| years.0),
            pulse,
            pulse_periods: periods.unwrap_or_else(|| vec![0.25, 0.5, 1.0, 2.0]),
            left_out: usual.left_out,
            has_usual_variants: assess.variants.is_none(),
            sweep,
            values,
            object,
            measure,
            variants: chosen.unwrap_or(usual.variants),
            assumptions: ranges.unwrap_or(usual.assumptions),
            inputs,
        })
    }
}

/// Refuses a study whose runs cannot give a curve.
fn check_runs(sweep: &Sweep, root: &Section<StudyFile>) -> Result<(), StudyFileError> {
    let expected = match (&sweep.strengths, &sweep.ensemble) {
        _ if !sweep.motions.iter().all(|motion| motion.ground.horizontal.is_some()) => {
            Some("[[records]] with a horizontal record each, in space x")
        }
        (Strengths::Least(..) | Strengths::Hunt(..), _) => {
            Some("levels or scales; an assessment fits curves to runs at strengths that do not depend on each other")
        }
        (_, Some(_)) => Some("no ensemble; an assessment counts each run once"),
        (Strengths::Scales(_) | Strengths::Levels(..), None) => None,
    };
    let message = |expected| format!("an assessment needs {expected}");
    expected.map_or(Ok(()), |expected| Err(root.refused("", message(expected))))
}

/// Refuses a ground motion that is named twice: its runs would be one curve.
fn check_names(sweep: &Sweep, root: &Section<StudyFile>) -> Result<(), StudyFileError> {
    let key = |motion: &GroundMotion| (motion.name(), motion.floor, motion.azimuth.to_bits());
    for (number, motion) in sweep.motions.iter().enumerate() {
        if sweep.motions[..number].iter().any(|other| key(other) == key(motion)) {
            let found = format!("{} twice; expected each ground motion once", motion.name());
            return Err(root.refused("records", format!("records name {found}")));
        }
    }
    Ok(())
}

/// Reads the measure; by default that of the levels, else PGV.
fn measure(root: &Section<StudyFile>, assess: &AssessTable, sweep: &Sweep) -> Result<Measure, StudyFileError> {
    let chosen = assess.im.as_ref().map(|im| root.parsed("assess.im", im)).transpose()?;
    let measure = chosen.or(sweep.strengths.measure()).unwrap_or(match sweep.space {
        Some(_) => Measure::OfPair(ComponentMeasure::Pgv, OverDirections::RotD50),
        None => Measure::Pgv,
    });
    if assess.im.is_some() && !sweep.measures.contains(&measure) {
        let known: Vec<String> = sweep.measures.iter().map(ToString::to_string).collect();
        return Err(root.wrong("assess.im", &format!("one of {}", known.join(", "))));
    }
    Ok(measure)
}

/// Reads the hazard curve and its file.
fn hazard(
    root: &Section<StudyFile>,
    HazardTable { file: name, unit, site, investigation_time, kind }: &HazardTable,
    measure: Measure,
    gravity: f64,
    folder: &Path,
) -> Result<(Input, Hazard), StudyFileError> {
    if measure.relative_to() != [false; 2] {
        let message =
            format!("a hazard curve has no {measure}; expected im = \"PGV\" or another measure of the ground");
        return Err(root.refused("assess.hazard.file", message));
    }
    let refused = |message: String| root.refused("assess.hazard.file", format!("{name}: {message}"));
    let bytes = std::fs::read(folder.join(name)).map_err(|error| refused(format!("cannot be read: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    let options = HazardOptions {
        measure: Some(measure.to_string()),
        unit: unit.clone(),
        site: site.as_ref().map(|site| match site {
            Site::Name(name) => name.clone(),
            Site::Place([longitude, latitude]) => format!("{longitude},{latitude}"),
        }),
        years: investigation_time.map(|years| years.0),
        kind: kind.clone(),
        gravity,
    };
    let curve = read_hazard(name, &text, &options).map_err(|error| refused(error.to_string()))?;
    match curve.unit.as_deref() {
        Some(unit) if unit == measure.unit() => {
            Ok((Input::of(name, &bytes), Hazard { file: name.clone(), options, curve }))
        }
        found => {
            let found = found.map_or("no unit of the levels".into(), |unit| format!("levels in {unit}"));
            Err(refused(format!("found {found}; expected those of {}", measure.heading())))
        }
    }
}

/// Reads the states; by default three limits without a publication behind them. Ties may hold blocks beyond their balance.
fn states(root: &Section<StudyFile>, assess: &AssessTable, sweep: &Sweep) -> Result<Vec<State>, StudyFileError> {
    let (holds, is_in_space) = (sweep.holds(), sweep.space.is_some());
    let Some(tables) = &assess.states else {
        let usual = [
            ("rocks visibly", Limit::Rotation(0.1)),
            ("rocks half way", Limit::Rotation(0.5)),
            if holds.has_links() { ("passes its balance", Limit::Balance) } else { ("overturns", Limit::Overturned) },
        ];
        let limit = |limit: Limit| if is_in_space { limit.in_space() } else { limit };
        return Ok(usual.map(|(name, of)| State { name: name.into(), limit: limit(of), source: None }).to_vec());
    };
    let state = |(number, StateTable { name, limit, source }): (usize, &StateTable)| {
        let path = format!("assess.states.{number}.limit");
        let limit = limit.limit().map_err(|message| root.refused(&path, message))?;
        let limit = if is_in_space { limit.in_space() } else { limit };
        let has_no_effect = match limit {
            Limit::Plastic(_) | Limit::HalfCycles(_) if is_in_space => Some(
                "a limit for a block in the plane; expected overturned, or one in space: tilt:0.5 over that of the balance, \
                 twist:0.1, slip:0.1 or drift:0.1",
            ),
            Limit::Slip(_) | Limit::Tilt(_) | Limit::Twist(_) | Limit::Drift(_) if is_in_space => None,
            Limit::Slip(_) if !holds.friction => {
                Some("a limit on the slip without friction; expected friction in [parameters]")
            }
            Limit::Plastic(_) if !holds.yields => Some(
                "a limit on plastic elongations without a tie or damper that yields; expected yield_force in [parameters]",
            ),
            Limit::Breaks if !holds.has_links() => Some(
                "a limit on broken ties and dampers without one; expected tie_1.stiffness and tie_1.strength in [parameters]",
            ),
            Limit::Tilt(_) | Limit::Twist(_) | Limit::Drift(_) => {
                Some("a limit for a block in space; expected overturned, a number for |theta|/alpha, or a slip")
            }
            Limit::HalfCycles(_) if sweep.half_cycles.is_none() => {
                Some("a limit on half cycles without their amplitude; expected half_cycles in [study]")
            }
            _ => None,
        };
        match has_no_effect {
            Some(reason) => Err(root.refused(&path, reason)),
            None => Ok(State { name: name.clone(), limit, source: source.clone() }),
        }
    };
    let states: Vec<State> = tables.iter().enumerate().map(state).collect::<Result<_, _>>()?;
    for (number, pair) in (1..).zip(states.windows(2)) {
        if let [mild, severe] = pair
            && is_more_severe(mild.limit, severe.limit)
        {
            let found = format!("{} = {} after {} = {}", severe.name, severe.limit, mild.name, mild.limit);
            let message =
                format!("{found}; expected the least severe state first, to which variants then do not refer");
            return Err(root.refused(&format!("assess.states.{number}.limit"), message));
        }
    }
    Ok(states)
}

/// Returns whether a run beyond the first limit is beyond the second, too, so that the first is the more severe one, or the same.
fn is_more_severe(first: Limit, second: Limit) -> bool {
    match (first, second) {
        (Limit::Overturned, _) => true,
        (Limit::Balance, Limit::Balance) | (Limit::Breaks, Limit::Breaks) => true,
        (Limit::Balance, Limit::Rotation(angle)) => angle < 1.0,
        (Limit::Rotation(first), Limit::Rotation(second))
        | (Limit::Slip(first), Limit::Slip(second))
        | (Limit::Plastic(first), Limit::Plastic(second)) => first >= second,
        (Limit::HalfCycles(first), Limit::HalfCycles(second))
        | (Limit::Tilt(first), Limit::Tilt(second))
        | (Limit::Twist(first), Limit::Twist(second))
        | (Limit::Drift(first), Limit::Drift(second)) => first >= second,
        _ => false,
    }
}

/// Reads the variants.
fn variants(
    root: &Section<StudyFile>,
    tables: &[VariantTable],
    sweep: &Sweep,
) -> Result<Vec<Alternative>, StudyFileError> {
    let variant = |(number, table): (usize, &VariantTable)| {
        let (name, path) = (&table.name, format!("assess.variants.{number}"));
        let (mut given, mut changes) = (Vec::new(), Vec::new());
        if let Some(table) = root.get(&format!("{path}.parameters")).and_then(|value| value.get_ref().as_table()) {
            flatten(root.source, vocabulary(sweep), "", table, &[], &mut given)?;
        }
        for (name, value) in given {
            let parameter = parameter(root.source, vocabulary(sweep), &name, value)?;
            changes.push(Change::of_parameter(&parameter, read_number(root.source, &parameter, value)?));
        }
        changes.extend(table.width.map(|factor| Change::Width(factor.0)));
        changes.extend(table.friction_over_threshold.map(|ratio| Change::FrictionOverThreshold(ratio.0)));
        changes.extend(table.ties.map(|stiffness| Change::Tied(stiffness.0)));
        changes.extend(table.dampers.map(|force| Change::Damped(force.0)));
        if changes.is_empty() {
            let expected = "one of width, friction_over_threshold, ties, dampers and parameters";
            return Err(root.refused(&path, format!("[[assess.variants]] has no change; expected {expected}")));
        }
        let refused = |message: String| root.refused(&format!("{path}.name"), format!("{name}: {message}"));
        sweep.check_changes(&changes).map_err(refused)?;
        Ok(Alternative { name: name.clone(), changes })
    };
    tables.iter().enumerate().map(variant).collect()
}

/// Reads the ranges of assumptions.
fn sensitivity(
    root: &Section<StudyFile>,
    sweep: &Sweep,
    middle: &ObjectValues,
) -> Result<Vec<Assumption>, StudyFileError> {
    let source = root.source;
    let table = root.get("assess.sensitivity").and_then(|value| value.get_ref().as_table());
    let mut ranges: Vec<_> = table.into_iter().flatten().collect();
    ranges.sort_by_key(|(key, _)| key.span().start);
    let read = |(key, value): (&toml::Spanned<std::borrow::Cow<str>>, SpannedValue)| {
        let name = key.get_ref();
        let parameter = parameter(source, vocabulary(sweep), name, value)?;
        let ends = value.get_ref().as_array().filter(|list| list.len() == 2);
        let ends = ends.ok_or_else(|| source.unexpected(name, value, "both ends of a range, as in [20, 80]"))?;
        let values = [read_number(source, &parameter, &ends[0])?, read_number(source, &parameter, &ends[1])?];
        let changes = values.map(|value| Change::of_parameter(&parameter, value));
        for change in changes {
            let checked = sweep.check_changes(&[change]);
            checked.map_err(|message| source.wrong(&value.span(), message))?;
        }
        let middle = middle.number(&parameter).unwrap_or(f64::NAN);
        Ok(Assumption { name: parameter.heading(), changes, values, middle, is_given: true })
    };
    ranges.into_iter().map(read).collect()
}

/// The bodies whose parameters variants and ranges name.
fn vocabulary(sweep: &Sweep) -> Vocabulary {
    if sweep.space.is_some() { Vocabulary::Space } else { Vocabulary::Plane }
}

/// Finds a real parameter by its name.
fn parameter(
    source: StudyText,
    vocabulary: Vocabulary,
    name: &str,
    value: SpannedValue,
) -> Result<Parameter, StudyFileError> {
    let parameter = vocabulary.parameter(name).map_err(|message| source.wrong(&value.span(), message))?;
    match parameter.kind() {
        Kind::Real => Ok(parameter),
        _ => {
            let message = format!("{name} is not a number; expected a parameter with a unit");
            Err(source.wrong(&value.span(), message))
        }
    }
}

fn read_number(source: StudyText, parameter: &Parameter, value: SpannedValue) -> Result<f64, StudyFileError> {
    let unexpected = |expected: &str| source.unexpected(parameter.name(), value, expected);
    let found = number(value).ok_or_else(|| unexpected(&parameter.expected()))?;
    if found.is_infinite() {
        return Err(unexpected("a finite number"));
    }
    parameter.number(found).map_err(|message| source.wrong(&value.span(), message))
}
