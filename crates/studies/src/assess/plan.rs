//! `[assess]` of a study file → states, hazard, variants, assumptions.

use std::path::Path;

use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use crate::assess::alternatives::{self, Alternative, Assumption};
use crate::fragility::Limit;
use crate::input::parameters::{Parameter, flatten};
use crate::input::study_file::{Section, SpannedValue, StudyFileError, StudyText, number};
use crate::intensity::Measure;
use crate::risk::{HazardCurve, HazardOptions, read_hazard};
use crate::spec::assess::{AssessTable, HazardTable, StateTable, VariantTable};
use crate::spec::study::StudyFile;
use crate::spec::words::Words;
use crate::sweep::Sweep;
use crate::sweep::change::Change;
use crate::sweep::file;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::strength::Strengths;
use rocking_block::block::Block;
use rocking_block::excitation::PulseShape;
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::{Kind, Variable};

/// An assessment that is ready to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the object.
    pub title: String,
    /// Name of the study file.
    pub file: String,
    /// The runs.
    pub sweep: Sweep,
    /// The variables of the object: each parameter in the middle of its range or list.
    pub values: Values,
    /// The object.
    pub block: Block,
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
        let root = Section::of::<StudyFile>(source, "the file", document.span(), document.get_ref())?;
        let assess = root
            .section::<AssessTable>("assess")?
            .ok_or_else(|| root.lacks("[assess]", "title = \"Statue\" at least"))?;
        check_runs(&sweep, &root)?;
        check_names(&sweep, &root)?;
        let values = sweep.middle();
        let block = values.block().map_err(|error| assess_error(&root, source, &error.to_string()))?;
        let has_center_height = values[Variable::PhysicalCenterHeight] > 0.0;
        let measure = measure(&assess, &sweep)?;
        let hazard = hazard(&assess, measure, block.gravity, folder)?;
        let title = assess.text("title")?.ok_or_else(|| assess.lacks("title", "the name of the object"))?;
        let mut inputs = vec![Input::of(file, text.as_bytes())];
        inputs.extend(hazard.iter().map(|(input, _)| input.clone()));
        for name in sweep.motions.iter().flat_map(|motion| &motion.files).filter(|name| !name.is_empty()) {
            if inputs.iter().all(|known| known.file != *name) {
                let bytes = std::fs::read(folder.join(name))
                    .map_err(|error| source.wrong(&(0..0), format!("{name}: cannot be read: {error}")))?;
                inputs.push(Input::of(name, &bytes));
            }
        }
        let usual = alternatives::usual(&sweep, &block);
        let chosen = assess.get("variants").map(|value| variants(source, &assess, value, &sweep)).transpose()?;
        let ranges = assess.get("sensitivity").map(|value| sensitivity(source, &assess, value, &sweep)).transpose()?;
        let (mut variants, mut assumptions) = (usual.variants, usual.assumptions);
        if let Some(chosen) = chosen {
            variants = chosen;
        }
        if let Some(chosen) = ranges {
            assumptions = chosen;
        }
        let pulse = match (assess.text("pulse")?, assess.get("pulse")) {
            (Some(word), Some(value)) => {
                let shape = PulseShape::named(word).filter(|shape| *shape != PulseShape::None);
                let known = PulseShape::WORDS.iter().filter(|(_, shape)| *shape != PulseShape::None);
                let known = || known.map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
                shape.ok_or_else(|| assess.wrong("pulse", value, &format!("one of {}", known())))?
            }
            _ => PulseShape::OneSine,
        };
        let periods = assess.numbers("pulse_periods", |x| x > 0.0, "a list of times > 0 s, as in [0.5, 1.0]")?;
        let years = assess.number("years", |x| x > 0.0, "a number of years above 0")?;
        Ok(Plan {
            title: title.into(),
            file: file.into(),
            height: (!has_center_height).then_some(2.0 * block.h),
            states: states(source, &assess, &sweep)?,
            hazard: hazard.map(|(_, hazard)| hazard),
            years: years.unwrap_or(50.0),
            pulse,
            pulse_periods: periods.unwrap_or_else(|| vec![0.25, 0.5, 1.0, 2.0]),
            left_out: usual.left_out,
            has_usual_variants: assess.get("variants").is_none(),
            sweep,
            values,
            block,
            measure,
            variants,
            assumptions,
            inputs,
        })
    }
}

fn assess_error(root: &Section, source: StudyText, message: &str) -> StudyFileError {
    let span = root.get("assess").map_or(0..0, |value| value.span());
    source.wrong(&span, format!("the object in the middle of the study: {message}"))
}

/// Refuses a study whose runs cannot give a curve.
fn check_runs(sweep: &Sweep, root: &Section) -> Result<(), StudyFileError> {
    let expected = match (&sweep.strengths, &sweep.ensemble) {
        _ if !sweep.motions.iter().all(|motion| motion.ground.horizontal.is_some()) => {
            Some("[[records]] with a horizontal record each")
        }
        (Strengths::Least(..) | Strengths::Hunt(..), _) => {
            Some("levels or scales; an assessment fits curves to runs at strengths that do not depend on each other")
        }
        (_, Some(_)) => Some("no ensemble; an assessment counts each run once"),
        (Strengths::Scales(_) | Strengths::Levels(..), None) => None,
    };
    expected.map_or(Ok(()), |expected| Err(root.lacks("what an assessment needs", expected)))
}

/// Refuses a ground motion that is named twice: its runs would be one curve.
fn check_names(sweep: &Sweep, root: &Section) -> Result<(), StudyFileError> {
    let key = |motion: &GroundMotion| (motion.names.clone(), motion.floor);
    for (number, motion) in sweep.motions.iter().enumerate() {
        if sweep.motions[..number].iter().any(|other| key(other) == key(motion)) {
            let names: Vec<&str> = motion.names.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
            let found = format!("{} twice; expected each ground motion once", names.join(" + "));
            return Err(match root.get("records") {
                Some(value) => root.refused(value, format!("records name {found}")),
                None => root.lacks("other records", &found),
            });
        }
    }
    Ok(())
}

/// Reads the measure; by default that of the levels, else PGV.
fn measure(assess: &Section, sweep: &Sweep) -> Result<Measure, StudyFileError> {
    let chosen: Option<Measure> = assess.parsed("im")?;
    let measure = chosen.or(sweep.strengths.measure()).unwrap_or(Measure::Pgv);
    match assess.get("im") {
        Some(value) if !sweep.measures.contains(&measure) => {
            let known: Vec<String> = sweep.measures.iter().map(ToString::to_string).collect();
            Err(assess.wrong("im", value, &format!("one of {}", known.join(", "))))
        }
        _ => Ok(measure),
    }
}

/// Reads the hazard curve and its file.
fn hazard(
    assess: &Section,
    measure: Measure,
    gravity: f64,
    folder: &Path,
) -> Result<Option<(Input, Hazard)>, StudyFileError> {
    let Some(section) = assess.section::<HazardTable>("hazard")? else { return Ok(None) };
    let expected = "a file of a hazard curve, as in { file = \"hazard.csv\" }";
    let (Some(name), Some(value)) = (section.text("file")?, section.get("file")) else {
        return Err(section.lacks("file", expected));
    };
    if Measure::OF_BLOCK.contains(&measure) {
        let message =
            format!("a hazard curve has no {measure}; expected im = \"PGV\" or another measure of the ground");
        return Err(section.refused(value, message));
    }
    let refused = |message: String| section.refused(value, format!("{name}: {message}"));
    let bytes = std::fs::read(folder.join(name)).map_err(|error| refused(format!("cannot be read: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    let options = HazardOptions {
        measure: Some(measure.to_string()),
        unit: section.text("unit")?.map(String::from),
        site: site(&section)?,
        years: section.number("investigation_time", |x| x > 0.0, "a number of years above 0")?,
        gravity,
    };
    let curve = read_hazard(name, &text, &options).map_err(|error| refused(error.to_string()))?;
    match curve.unit.as_deref() {
        Some(unit) if unit == measure.unit() => {
            Ok(Some((Input::of(name, &bytes), Hazard { file: name.into(), options, curve })))
        }
        found => {
            let found = found.map_or("no unit of the levels".into(), |unit| format!("levels in {unit}"));
            Err(refused(format!("found {found}; expected those of {}", measure.heading())))
        }
    }
}

/// Reads a site: its name, or longitude and latitude as text or as a list.
fn site(section: &Section) -> Result<Option<String>, StudyFileError> {
    match section.get("site").map(|value| value.get_ref().is_array()) {
        Some(true) => {
            let expected = "a name, or longitude and latitude, as in [12.5, 41.9]";
            let numbers = section.numbers("site", |_| true, expected)?.unwrap_or_default();
            match (numbers.as_slice(), section.get("site")) {
                ([longitude, latitude], _) => Ok(Some(format!("{longitude},{latitude}"))),
                (_, Some(value)) => Err(section.wrong("site", value, expected)),
                (_, None) => Ok(None),
            }
        }
        Some(false) | None => Ok(section.text("site")?.map(String::from)),
    }
}

/// Reads the states; by default three limits without a publication behind them. Ties may hold blocks beyond their balance.
fn states(source: StudyText, assess: &Section, sweep: &Sweep) -> Result<Vec<State>, StudyFileError> {
    let holds = sweep.holds();
    let Some(value) = assess.get("states") else {
        let usual = [
            ("rocks visibly", Limit::Rotation(0.1)),
            ("rocks half way", Limit::Rotation(0.5)),
            if holds.has_links() { ("passes its balance", Limit::Balance) } else { ("overturns", Limit::Overturned) },
        ];
        return Ok(usual.map(|(name, limit)| State { name: name.into(), limit, source: None }).to_vec());
    };
    read_tables::<StateTable, _>(source, assess, "states", value, |section| {
        let limit = match (section.get("limit"), section.text("limit")) {
            (Some(value), _) if number(value).is_some() => {
                section.number("limit", |x| x > 0.0, "a number > 0 for |theta|/alpha")?.map(Limit::Rotation)
            }
            _ => section.parsed("limit")?,
        };
        let has_no_effect = match limit {
            Some(Limit::Slip(_)) if !holds.friction => {
                Some("a limit on the slip without friction; expected friction in [parameters]")
            }
            Some(Limit::Plastic(_)) if !holds.yields => Some(
                "a limit on plastic elongations without a tie or damper that yields; expected yield_force in [parameters]",
            ),
            Some(Limit::HalfCycles(_)) if sweep.half_cycles.is_none() => {
                Some("a limit on half cycles without their amplitude; expected half_cycles in [study]")
            }
            _ => None,
        };
        if let (Some(reason), Some(value)) = (has_no_effect, section.get("limit")) {
            return Err(section.refused(value, reason.into()));
        }
        Ok(State {
            name: section.text("name")?.ok_or_else(|| section.lacks("name", "a name of the state"))?.into(),
            limit: limit.ok_or_else(|| {
                section.lacks(
                    "limit",
                    "\"overturned\", \"balance\", a number for |theta|/alpha, \"slip:0.1\" or \"plastic:0.02\"",
                )
            })?,
            source: section.text("source")?.map(String::from),
        })
    })
}

/// Reads the tables of a list.
fn read_tables<Table: DeserializeOwned, T>(
    source: StudyText,
    assess: &Section,
    key: &str,
    value: SpannedValue,
    read: impl Fn(&Section) -> Result<T, StudyFileError>,
) -> Result<Vec<T>, StudyFileError> {
    let name = format!("[[assess.{key}]]");
    let list = value.get_ref().as_array().filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| assess.wrong(key, value, &format!("{name}, a table for each")))?;
    let table = |value: SpannedValue| {
        let table = value.get_ref().as_table().ok_or_else(|| assess.wrong(key, value, "a table"))?;
        read(&Section::of::<Table>(source, &name, value.span(), table)?)
    };
    list.iter().map(table).collect()
}

/// Reads the variants.
fn variants(
    source: StudyText,
    assess: &Section,
    value: SpannedValue,
    sweep: &Sweep,
) -> Result<Vec<Alternative>, StudyFileError> {
    read_tables::<VariantTable, _>(source, assess, "variants", value, |section| {
        let name = section.text("name")?.ok_or_else(|| section.lacks("name", "a name of the variant"))?;
        let number = |key: &str| section.number(key, |x| x > 0.0, "a number > 0");
        let mut changes = Vec::new();
        if let Some(value) = section.get("parameters") {
            let table = value.get_ref().as_table().ok_or_else(|| section.wrong("parameters", value, "a table"))?;
            let mut given = Vec::new();
            flatten(source, "", table, &[], &mut given)?;
            for (name, value) in given {
                let parameter = parameter(section, &name, value)?;
                let found = read_number(section, &parameter, value)?;
                changes.push(Change::Parameter(parameter.metadata.variable, found));
            }
        }
        changes.extend(number("width")?.map(Change::Width));
        changes.extend(number("friction_over_threshold")?.map(Change::FrictionOverThreshold));
        changes.extend(number("ties")?.map(Change::Tied));
        changes.extend(number("dampers")?.map(Change::Damped));
        if changes.is_empty() {
            return Err(section.lacks("change", "one of width, friction_over_threshold, ties, dampers and parameters"));
        }
        let position = section.get("name").unwrap_or(value);
        sweep.check_changes(&changes).map_err(|message| section.refused(position, format!("{name}: {message}")))?;
        Ok(Alternative { name: name.into(), changes })
    })
}

/// Reads the ranges of assumptions.
fn sensitivity(
    source: StudyText,
    assess: &Section,
    value: SpannedValue,
    sweep: &Sweep,
) -> Result<Vec<Assumption>, StudyFileError> {
    let table = value.get_ref().as_table();
    let table = table.ok_or_else(|| assess.wrong("sensitivity", value, "a table, as in { eta = [20, 80] }"))?;
    let mut ranges: Vec<_> = table.iter().collect();
    ranges.sort_by_key(|(key, _)| key.span().start);
    let middle = sweep.middle();
    let read = |(key, value): (&toml::Spanned<_>, SpannedValue)| {
        let name: &std::borrow::Cow<str> = key.get_ref();
        let parameter = parameter(assess, name, value)?;
        let ends = value.get_ref().as_array().filter(|list| list.len() == 2);
        let ends = ends.ok_or_else(|| assess.wrong(name, value, "both ends of a range, as in [20, 80]"))?;
        let values = [read_number(assess, &parameter, &ends[0])?, read_number(assess, &parameter, &ends[1])?];
        let variable = parameter.metadata.variable;
        let changes = values.map(|value| Change::Parameter(variable, value));
        for change in changes {
            let checked = sweep.check_changes(&[change]);
            checked.map_err(|message| source.wrong(&value.span(), message))?;
        }
        Ok(Assumption { name: parameter.heading(), changes, values, middle: middle[variable], is_given: true })
    };
    ranges.into_iter().map(read).collect()
}

/// Finds a real parameter by its name.
fn parameter(section: &Section, name: &str, value: SpannedValue) -> Result<Parameter, StudyFileError> {
    let parameter = Parameter::named(name).map_err(|message| section.refused(value, message))?;
    match parameter.metadata.kind {
        Kind::Real => Ok(parameter),
        Kind::Integer | Kind::Enumeration | Kind::Boolean | Kind::String => {
            Err(section.refused(value, format!("{name} is not a number; expected a parameter with a unit")))
        }
    }
}

fn read_number(section: &Section, parameter: &Parameter, value: SpannedValue) -> Result<f64, StudyFileError> {
    let found = number(value).ok_or_else(|| section.wrong(parameter.name(), value, parameter.expected()))?;
    if found.is_infinite() {
        return Err(section.wrong(parameter.name(), value, "a finite number"));
    }
    parameter.number(found).map_err(|message| section.refused(value, message))
}
