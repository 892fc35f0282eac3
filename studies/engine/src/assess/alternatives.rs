//! The object → its usual variants and the ranges of its assumptions.

use crate::assess::object::{AssessedObject, ObjectValues};
use crate::input::parameters::Parameter;
use crate::spec::numbers_in_space::{self, NumbersInSpace};
use crate::statistics::range;
use crate::sweep::Sweep;
use crate::sweep::change::Change;
use crate::sweep::parameters::ParameterValues;
use rocking_block::block::{Block, Body, Foundation};
use rocking_block::space::SpaceBody;
use rocking_block::unit::variables::{Kind, VARIABLES, Variable};

/// Width of a wider base over that of the object.
const WIDER: f64 = 1.1;
/// Friction of a base that slides over the static threshold. It is low enough for the block to slide before it rocks.
const SLIDING: f64 = 0.8;
/// Stiffness of a tie over M g/R0. It stretches by a tenth of R0 under the weight of the block.
const TIED: f64 = 10.0;
/// Factors on η and ξ_v.
const FACTORS: [f64; 2] = [0.5, 2.0];
/// Changes of ε and of the coefficient of friction.
const RESTITUTION: f64 = 0.1;
const FRICTION: f64 = 0.1;
/// Change of the factor on Housner's e.
const RESTITUTION_FACTOR: f64 = 0.05;

/// A variant of the object.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// Its name.
    pub name: String,
    /// The changes that make it.
    pub changes: Vec<Change>,
}

/// An uncertain quantity.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Assumption {
    /// Name and unit.
    pub name: String,
    /// Both ends of its range, as changes.
    #[serde(skip)]
    pub changes: [Change; 2],
    /// Their values.
    pub values: [f64; 2],
    /// Its value in the middle of the study.
    pub middle: f64,
    /// Whether the range is that of the study instead of the usual one.
    pub is_given: bool,
}

/// The usual variants and assumptions.
pub(super) struct Usual {
    pub variants: Vec<Alternative>,
    pub assumptions: Vec<Assumption>,
    /// Variants and assumptions that do not fit the object, with the reason.
    pub left_out: Vec<String>,
}

/// Returns the usual variants and assumptions of the object in the middle of a study.
///
/// Ranges are those of the study's parameters. Quantities of the foundation with a single value get a usual range.
pub(super) fn usual(sweep: &Sweep, values: &ObjectValues, object: &AssessedObject) -> Usual {
    let mut left_out = Vec::new();
    let mut fits = |name: &str, changes: &[Change]| match sweep.check_changes(changes) {
        Ok(()) => true,
        Err(message) => {
            left_out.push(format!("{name}: {message}"));
            false
        }
    };
    let variants = [
        ("base 10 % wider", Change::Width(WIDER)),
        ("base that slides", Change::FrictionOverThreshold(SLIDING)),
        ("tied to a wall on both sides", Change::Tied(TIED)),
    ];
    let slides = object.friction() <= SLIDING * object.slope();
    // Only a block in the plane has ties.
    let is_none = |change: &Change| match change {
        Change::FrictionOverThreshold(_) => slides,
        Change::Tied(_) => object.in_space().is_some(),
        _ => false,
    };
    let variants = variants.into_iter().filter(|(name, change)| !is_none(change) && fits(name, &[*change]));
    let variants: Vec<Alternative> =
        variants.map(|(name, change)| Alternative { name: name.into(), changes: vec![change] }).collect();
    let mut assumptions = study_ranges(sweep);
    let of_foundation = match (object, &values.in_space) {
        (AssessedObject::Space(object), Some(numbers)) => foot_ranges(sweep, numbers, &object.body),
        (AssessedObject::Plane(block), _) => foundation_ranges(sweep, block),
        (AssessedObject::Space(_), None) => unreachable!("a block in space has its numbers"),
    };
    for assumption in of_foundation {
        if assumption.changes.iter().all(|change| fits(&assumption.name, &[*change])) {
            assumptions.push(assumption);
        }
    }
    if slides {
        let friction = object.friction();
        left_out.push(format!("base that slides: it slides as it is, with a coefficient of friction of {friction}"));
    }
    Usual { variants, assumptions, left_out }
}

/// Returns the ranges of the study's parameters.
fn study_ranges(sweep: &Sweep) -> Vec<Assumption> {
    let ends = |values: &ParameterValues| match values {
        ParameterValues::Range { from, to, .. } => Some([*from, *to]),
        ParameterValues::List(values) => range(values.iter().copied()).filter(|[low, high]| low < high),
    };
    let real = sweep.parameters.iter().filter(|swept| swept.parameter.kind() == Kind::Real);
    let assumption = real.filter_map(|swept| {
        let values = ends(&swept.values)?;
        // Friction without a limit is no end of a range.
        if values.iter().any(|&value| swept.parameter.shown(value).is_infinite()) {
            return None;
        }
        let changes = values.map(|value| Change::of_parameter(&swept.parameter, value));
        let name = swept.parameter.heading();
        Some(Assumption { name, changes, values, middle: swept.values.at(0.5), is_given: true })
    });
    assumption.collect()
}

/// Returns usual ranges of the parameters of the feet of a block in space. These are η or ω_v, ξ_v, κ, and friction, if the study has a single
/// value.
fn foot_ranges(sweep: &Sweep, numbers: &NumbersInSpace, body: &SpaceBody) -> Vec<Assumption> {
    let known = |name: &str| numbers_in_space::numbers().iter().find(|number| number.name == name);
    let varies = |names: &[&str]| {
        let mut found = sweep.parameters.iter().filter(|swept| names.contains(&swept.parameter.name()));
        found.any(|swept| swept.values.at(0.0) != swept.values.at(1.0))
    };
    let heading = |name: &str| known(name).map_or(name.into(), |number| Parameter::from(number).heading());
    let factors = |name: &'static str, others: &[&str], middle: f64, change: &dyn Fn(f64) -> Option<Change>| {
        let values = FACTORS.map(|factor| factor * middle);
        let [low, high] = FACTORS.map(change);
        let assumption = Assumption { name: heading(name), changes: [low?, high?], values, middle, is_given: false };
        Some(assumption).filter(|_| !varies(others))
    };
    let kappa = body.horizontal_stiffness / body.stiffness;
    let of_kappa = |factor: f64| Some(Change::Number(known("kappa")?, factor * kappa));
    // Feet of a list have ω_v, as do those whose ω_v or stiffness is given.
    let is_eta = numbers.space.omega_v.is_none() && numbers.block.stiffness.is_none();
    let (stiffness, middle) = if is_eta { ("eta", body.omega_v / body.p) } else { ("omega_v", body.omega_v) };
    let friction = numbers.block.hold.friction.filter(|friction| friction.is_finite());
    let of_friction = friction.and_then(|middle| {
        let values = [(middle - FRICTION).max(0.5 * middle), middle + FRICTION];
        let number = known("friction")?;
        let changes = values.map(|value| Change::Number(number, value));
        let assumption = Assumption { name: heading("friction"), changes, values, middle, is_given: false };
        Some(assumption).filter(|_| !varies(&["friction"]))
    });
    let ratio = |change: fn(f64) -> Change| move |factor: f64| Some(change(factor));
    let ranges = [
        factors(stiffness, &["eta", "omega_v", "K"], middle, &ratio(Change::StiffnessRatio)),
        factors("xi_v", &["xi_v", "C"], body.xi_v, &ratio(Change::DampingRatio)),
        factors("kappa", &["kappa"], kappa, &of_kappa),
        of_friction,
    ];
    ranges.into_iter().flatten().collect()
}

/// Returns usual ranges of the parameters of the foundation. These are η, ξ_v, ε, the factor on e, and friction, if the study has a single
/// value.
fn foundation_ranges(sweep: &Sweep, block: &Block) -> Vec<Assumption> {
    let varies = |variable: Variable| {
        let found = sweep.parameters.iter().find(|swept| swept.parameter.variable() == Some(variable));
        found.is_some_and(|swept| swept.values.at(0.0) != swept.values.at(1.0))
    };
    let heading = |variable: Variable| Parameter::from(&VARIABLES[variable as usize]).heading();
    let factors = |variables: [Variable; 2], middle: f64, change: fn(f64) -> Change| {
        let values = FACTORS.map(|factor| factor * middle);
        let name = heading(variables[0]);
        let assumption = Assumption { name, changes: FACTORS.map(change), values, middle, is_given: false };
        Some(assumption).filter(|_| middle > 0.0 && !variables.into_iter().any(varies))
    };
    let steps = |variable: Variable, middle: f64, values: [f64; 2]| {
        let changes = values.map(|value| Change::Parameter(variable, value));
        let assumption = Assumption { name: heading(variable), changes, values, middle, is_given: false };
        Some(assumption).filter(|_| values[0] < values[1] && !varies(variable))
    };
    let Block { epsilon, restitution_factor, body: Body { friction, .. }, .. } = *block;
    let of_base = match block.foundation {
        Foundation::Viscoelastic => [
            factors([Variable::DimensionlessEta, Variable::PhysicalK], block.eta(), Change::StiffnessRatio),
            factors([Variable::DimensionlessXiV, Variable::PhysicalC], block.xi_v, Change::DampingRatio),
            steps(Variable::Epsilon, epsilon, [(epsilon - RESTITUTION).max(0.0), (epsilon + RESTITUTION).min(1.0)]),
        ],
        Foundation::Rigid => {
            let high = (restitution_factor + RESTITUTION_FACTOR).min(1.0).max(restitution_factor);
            let values = [restitution_factor - RESTITUTION_FACTOR, high];
            [steps(Variable::RestitutionFactor, restitution_factor, values), None, None]
        }
    };
    let values = [(friction - FRICTION).max(0.5 * friction), friction + FRICTION];
    let friction = (friction > 0.0).then(|| steps(Variable::Friction, friction, values));
    of_base.into_iter().chain(friction).flatten().collect()
}
