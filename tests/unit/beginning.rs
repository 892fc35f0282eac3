//! Derivatives of initial unknowns with respect to parameters, start values and inputs.

use std::collections::BTreeSet;

use crate::differences::draw::{Draw, KNOWNS};
use crate::differences::{Declared, Host, Pairs, Sizes, compare, declared, real_unknowns};
use proptest::test_runner::TestRunner;
use rocking_block::unit::instance::{Interface, Unit};
use rocking_block::unit::variables::{Kind, Metadata, VARIABLES};

/// The description of FMI 2.0, with positions in place of names.
const XML: &str = include_str!(concat!(env!("OUT_DIR"), "/modelDescription.xml"));

/// Samples of two records, in units of g.
const RECORDS: [&str; 2] = ["0.1\n0.3\n-0.2\n0.25\n0.1\n", "0.2\n-0.1\n-0.2\n0.15\n0.1\n0.0\n0.3\n"];

/// The model itself, in Initialization Mode.
struct Model(Unit);

fn metadata(name: &str) -> &'static Metadata {
    VARIABLES.iter().find(|metadata| metadata.name == name).unwrap_or_else(|| panic!("no {name}"))
}

impl Model {
    /// Sets a variable of any type except String, if the value is accepted.
    fn try_set(&mut self, name: &str, value: f64) -> bool {
        let metadata = metadata(name);
        self.0.set(metadata.kind.base(), &[metadata.reference()], &[value], |value| value).is_ok()
    }

    fn set_text(&mut self, name: &str, text: &str) {
        self.0.set_texts(&[metadata(name).reference()], &[text]).unwrap();
    }

    /// Returns the derivative in the direction of a component of one known.
    fn along(&mut self, unknown: &str, known: &str, component: f64) -> f64 {
        let [unknown, known] = [unknown, known].map(|name| [metadata(name).reference()]);
        let mut derivatives = self.0.directional_derivative(&unknown, &known, &[component], 0.0).unwrap();
        derivatives.next().unwrap().unwrap()
    }

    /// Returns a variable of any type except String, if the parameters make a block.
    fn try_get(&mut self, name: &str) -> Option<f64> {
        let metadata = metadata(name);
        self.0.get(metadata.kind.base(), metadata.reference()).ok()
    }
}

impl Host for Model {
    fn set(&mut self, name: &str, value: f64) {
        assert!(self.try_set(name, value), "{name} = {value}");
    }

    fn get(&mut self, name: &str) -> f64 {
        self.try_get(name).unwrap_or_else(|| panic!("{name}"))
    }

    fn derivatives(&mut self, unknowns: &[&str], known: &str) -> Vec<f64> {
        let unknowns: Vec<u32> = unknowns.iter().map(|name| metadata(name).reference()).collect();
        let known = [metadata(known).reference()];
        self.0.directional_derivative(&unknowns, &known, &[1.0], 0.0).unwrap().map(Result::unwrap).collect()
    }
}

/// Records in a temporary folder.
struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Files {
        let folder = tempfile::tempdir().unwrap();
        for (i, samples) in RECORDS.iter().enumerate() {
            std::fs::write(folder.path().join(format!("{i}.txt")), samples).unwrap();
        }
        Files(folder)
    }

    fn path(&self, record: usize) -> String {
        self.0.path().join(format!("{record}.txt")).to_str().unwrap().to_string()
    }

    /// Starts a model in turn without records, with both, and with both swapped.
    fn start(&self, draw: &Draw, turn: usize) -> Model {
        let interface = if turn.is_multiple_of(2) { Interface::CoSimulation } else { Interface::ModelExchange };
        let mut model = Model(Unit::new(interface));
        draw.values.iter().for_each(|(name, value)| model.set(name, *value));
        if !turn.is_multiple_of(3) {
            for (i, direction) in ["horizontal", "vertical"].into_iter().enumerate() {
                model.set_text(&format!("record.{direction}"), &self.path((turn + i) % 2));
                model.set_text(&format!("record.{direction}_unit"), "g");
            }
        }
        model.0.plan(None, 0.0, None).unwrap();
        model.0.enter_initialization_mode();
        model
    }
}

/// Unknowns that depend on start values and contacts only; some knowns merely decide the contacts.
const STEPS: [&str; 9] = [
    "theta_dot",
    "v_dot",
    "u_dot",
    "u",
    "energy.total",
    "energy.kinetic",
    "energy.potential",
    "power.input",
    "power.dashpots",
];

/// Unknowns that depend on whether the foot slides at the start, and how fast: it moves there only where the block lifts off at once.
/// This is rare, so most of the parameters that decide it change none of them here.
const SLIDING: [&str; 7] =
    ["u_dot", "energy.kinetic", "energy.potential", "energy.total", "slip_rate", "slides", "power.friction"];

/// Whether an unknown is one of the ties and dampers.
fn is_of_links(unknown: &str) -> bool {
    ["tie", "damper"].iter().any(|kind| unknown.contains(kind))
}

/// Whether a known merely decides in which regime a block begins, or whether a tie has broken, on which the unknown depends.
fn only_decides(declared: &Declared, unknown: &str, known: &str) -> bool {
    let own = known.split_once('.').is_some_and(|(link, _)| is_of_links(link) && unknown.contains(link));
    let damps = matches!(known, "dimensionless.xi_v" | "physical.C" | "physical.inertia");
    let decides = damps || known == "friction" || is_of_links(known) || !declared["v_dot"].contains(known);
    // A block that slides from the start, or a tie that breaks there.
    let rare = matches!(unknown, "slip_rate" | "power.friction") || unknown.ends_with(".broken");
    // Rates and damping decide whether a damper breaks, and keeps the elongation of before; damping alone makes one.
    let breaks = known.starts_with("initial.") || known.ends_with(".damping");
    let rare = rare || (breaks && [".plastic", ".elongation"].iter().any(|end| unknown.ends_with(end)));
    let of_contacts = SLIDING.contains(&unknown) || STEPS.contains(&unknown) || is_of_links(unknown);
    rare || known.ends_with(".strength") || (of_contacts && decides && !own)
}

/// Pairs whose known cancels: only round-off depends on it.
const CANCELS: [(&str, &str); 2] =
    [("derived.eta", "dimensionless.p"), ("derived.theta_separation", "dimensionless.p")];

#[test]
fn derivatives_match_differences_of_the_values() {
    let (declared, files) = (declared(XML), Files::new());
    let (mut runner, mut pairs) = (TestRunner::deterministic(), Pairs::new());
    for i in 0..1000 {
        let draw = Draw::next(&mut runner);
        compare(&mut files.start(&draw, i), &draw, &declared, &mut pairs);
    }
    let mut never = Vec::new();
    for unknown in real_unknowns(&declared) {
        for known in KNOWNS.iter().map(|known| known.name).filter(|&known| declared[unknown].contains(known)) {
            let of =
                |unknown: &str, known: &str| pairs.get(&(unknown.into(), known.into())).copied().unwrap_or_default();
            let mut found = of(unknown, known);
            if found.nonzero == 0 {
                // The second tie and damper share their code with the first, which is there more often.
                found = of(&unknown.replace("_2.", "_1."), &known.replace("_2.", "_1."));
            }
            let decides = STEPS.contains(&unknown) && declared["separated"].contains(known)
                || only_decides(&declared, unknown, known);
            if found.compared == 0 || (found.nonzero == 0 && !decides && !CANCELS.contains(&(unknown, known))) {
                never.push(format!("d{unknown}/d{known}: {found:?}"));
            }
        }
    }
    assert!(never.is_empty(), "declared but never nonzero:\n{}", never.join("\n"));
}

/// Changing a known over its range changes the unknowns declared by InitialUnknowns, and no others.
#[test]
fn values_change_with_their_declared_dependencies() {
    let (declared, files) = (declared(XML), Files::new());
    let mut runner = TestRunner::deterministic();
    let mut moved: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut draw = Draw::next(&mut runner);
    for i in 0..5000 {
        let other = Draw::next(&mut runner);
        let mut model = files.start(&draw, i);
        let sizes = Sizes::of(&mut model);
        let before: Vec<f64> = declared.keys().map(|unknown| model.get(unknown)).collect();
        for metadata in VARIABLES.iter().filter(|metadata| metadata.is_settable()) {
            let known = metadata.name;
            let undo: Box<dyn Fn(&mut Model)> = if metadata.kind == Kind::String {
                let old = model.0.text(metadata.reference()).unwrap().to_string();
                let new = match (known, old.as_str()) {
                    ("record.horizontal", "") => files.path(0),
                    ("record.vertical", "") => files.path(1),
                    ("record.horizontal" | "record.vertical", _) => String::new(),
                    (_, "cm/s2") => "g".into(),
                    _ => "cm/s2".into(),
                };
                model.set_text(known, &new);
                Box::new(move |model| model.set_text(known, &old))
            } else if let Some(&(_, new)) = other.values.iter().find(|(name, _)| *name == known) {
                let old = model.get(known);
                model.set(known, new);
                Box::new(move |model| model.set(known, old))
            } else {
                continue;
            };
            for (unknown, before) in declared.keys().zip(&before) {
                let Some(after) = model.try_get(unknown) else { continue };
                if (after - before).abs() > 1e-9 * sizes.unknown(unknown, *before).max(after.abs()) {
                    assert!(declared[unknown].contains(known), "{unknown} depends on {known}: {draw:?}, {other:?}");
                    moved.insert((unknown, known));
                }
            }
            undo(&mut model);
        }
        draw = other;
    }
    // Rare: whether a held block that is drawn up has separated. Channels of a file are not tested here.
    let seldom = |unknown: &str, known: &str| {
        CANCELS.contains(&(unknown, known))
            || only_decides(&declared, unknown, known)
            || matches!(unknown, "regime" | "separated" | "overturned")
            // On which corner a block in the air was last.
            || (unknown, known) == ("u", "initial.v_dot")
            || (STEPS.contains(&unknown) && matches!(known, "physical.C" | "physical.inertia"))
            || matches!(known, "on_separation" | "record.horizontal_channel" | "record.vertical_channel")
            // The vertical record has its own unit here.
            || (unknown, known) == ("record.PGA_vertical", "record.horizontal_unit")
    };
    let mut never = Vec::new();
    for (unknown, knowns) in &declared {
        let stays = |known: &&String| !seldom(unknown, known) && !moved.contains(&(unknown.as_str(), known.as_str()));
        never.extend(knowns.iter().filter(stays).map(|known| format!("{unknown} with {known}")));
    }
    assert!(never.is_empty(), "declared but never changes:\n{}", never.join("\n"));
}

/// A tie that is just taut can get more slack or pretension, and no less. Along a rotation it is taut on one side, and slack on the other.
#[test]
fn derivatives_at_a_tie_that_is_just_taut_are_those_of_the_side_that_exists() {
    const UNKNOWNS: [&str; 6] = ["tie_1.tension", "peak.tie_1.tension", "tie_1.elongation", "v", "N_L", "theta_ddot"];
    const TIE: [(&str, f64); 5] = [
        ("tie_1.block_x", 0.5),
        ("tie_1.block_z", 3.0),
        ("tie_1.ground_x", 1.5),
        ("tie_1.ground_z", -1.0),
        ("tie_1.stiffness", 2e4),
    ];
    let with = |known: &str, value: f64| {
        let mut model = Model(Unit::new(Interface::CoSimulation));
        TIE.iter().for_each(|&(name, value)| model.set(name, value));
        model.set(known, value);
        model.0.plan(None, 0.0, None).unwrap();
        model.0.enter_initialization_mode();
        model
    };
    for (known, step) in [("tie_1.slack", 1e-6), ("tie_1.pretension", 1e-2), ("initial.theta", 1e-9)] {
        let mut at = with(known, 0.0);
        let derivatives = at.derivatives(&UNKNOWNS, known);
        for (unknown, derivative) in UNKNOWNS.iter().zip(derivatives) {
            let difference = (with(known, step).get(unknown) - at.get(unknown)) / step;
            let size = difference.abs().max(1e-3);
            assert!(
                (derivative - difference).abs() < 1e-4 * size,
                "d{unknown}/d{known}: {derivative}, not {difference}"
            );
        }
    }
}

/// Upright on the rigid base, a block tilts to the side to which it is moved: `u = h θ`, `v = b |θ|`, `u̇ = h θ̇`, `M g v`. Its
/// derivatives are one-sided, in the requested direction, while reactions and accelerations, which would jump, keep their values
/// at rest.
#[test]
fn an_upright_block_on_the_rigid_base_leans_in_the_requested_direction() {
    let mut model = Model(Unit::new(Interface::CoSimulation));
    model.set("foundation", 2.0);
    model.0.plan(None, 0.0, None).unwrap();
    model.0.enter_initialization_mode();
    let (b, h) = (0.5 * model.get("derived.width"), 0.5 * model.get("derived.height"));
    let mut along = |unknown, known, component| model.along(unknown, known, component);
    for side in [1.0, -1.0] {
        for (unknown, known, expected) in [
            ("theta", "initial.theta", side),
            ("u", "initial.theta", side * h),
            ("v", "initial.theta", b),
            ("v_L", "initial.theta", b + side * b),
            ("v_R", "initial.theta", b - side * b),
            ("uplift_L", "initial.theta", b + side * b),
            ("energy.potential", "initial.theta", 1000.0 * 9.81 * b),
            ("peak.theta", "initial.theta", 1.0),
            ("peak.uplift", "initial.theta", 2.0 * b),
            ("u_dot", "initial.theta_dot", side * h),
            ("v_dot", "initial.theta_dot", b),
            ("theta_ddot", "initial.theta", 0.0),
            ("N_L", "initial.theta", 0.0),
            ("H", "a_gx", side * 1000.0),
        ] {
            let found = along(unknown, known, side);
            assert!(
                (found - expected).abs() <= 1e-12 * expected.abs(),
                "d{unknown}/d{known} to {side}: {found}, {expected}"
            );
        }
    }
}

/// A sine that starts with the run acts at once if it is moved earlier, and not yet if it is moved later.
#[test]
fn the_beginning_of_a_sine_has_a_derivative_on_each_side() {
    let (amplitude, period) = (1.5, 0.8);
    let mut model = Model(Unit::new(Interface::CoSimulation));
    for (name, value) in [("pulse.shape", 2.0), ("pulse.amplitude", amplitude), ("pulse.period", period)] {
        model.set(name, value);
    }
    model.0.plan(None, 0.0, None).unwrap();
    model.0.enter_initialization_mode();
    let rest = model.get("peak.H");
    assert_eq!(rest, 0.0);
    let mut along = |unknown, component| model.along(unknown, "pulse.start", component);
    assert_eq!([along("theta_ddot", 1.0), along("peak.H", 1.0)], [0.0; 2]);
    let earlier = [along("H", -1.0), along("peak.H", -1.0)];
    // The pulse after some time, on yielding supports: at most M a_p ω.
    let rate = 1000.0 * amplitude * std::f64::consts::TAU / period;
    assert!(earlier[0] != 0.0 && earlier[0].abs() <= rate, "{earlier:?}");
    assert_eq!(earlier[1], earlier[0].abs());
    let mut model = Model(Unit::new(Interface::CoSimulation));
    for (name, value) in
        [("pulse.shape", 2.0), ("pulse.amplitude", amplitude), ("pulse.period", period), ("pulse.start", -1e-9)]
    {
        model.set(name, value);
    }
    model.0.plan(None, 0.0, None).unwrap();
    model.0.enter_initialization_mode();
    let difference = model.get("peak.H") / 1e-9;
    assert!((difference - earlier[1]).abs() < 1e-6 * difference, "{difference}, {earlier:?}");
}
