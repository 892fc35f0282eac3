//! Fields → a run.

use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, BlockError, Foundation};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, Settings};
use rocking_charts::numerals::significant;
use rocking_records::Record;
use rocking_studies::doubts;
use rocking_studies::intensity::pga;
use rocking_studies::run::Run;
use rocking_studies::spec::{BlockSpec, HoldSpec, SingleRunSpec, SpecError, limits};

use crate::fields::{FieldError, Fields};
use crate::records::{self, Direction, DroppedFile};

/// The run and its inputs, as described by the fields.
#[derive(Debug)]
pub struct Inputs {
    /// The run.
    pub run: Run,
    /// The records before scaling.
    pub unscaled: Ground,
    /// Factor on the records.
    pub scale: f64,
    /// The parameters that define the block, all that the page shows.
    pub spec: BlockSpec,
    /// Height of the body (m): twice that of its centre of mass, unless both are given.
    pub body_height: f64,
    /// Excitation of the block.
    pub excitation: Excitation,
    /// Time between rows, if the user chose one (s).
    pub step: Option<f64>,
    /// The excitation in words, as in the program's pictures.
    pub description: String,
    /// Warnings about the block and its records, a line each.
    pub warnings: Vec<String>,
}

/// Kind of excitation, with the names and settings of its files.
#[derive(Clone, Debug, PartialEq)]
pub enum Excitation {
    /// The embedded record, and perhaps a vertical file.
    Embedded,
    /// A dropped file, and perhaps a vertical one.
    File {
        /// Name of the horizontal file.
        name: String,
        /// Its settings.
        settings: records::Settings,
    },
    /// A pulse.
    Pulse,
    /// Free motion from an initial tilt or velocity.
    Release,
}

/// A vertical file and its settings.
pub type Vertical = Option<(String, records::Settings)>;

/// Reads the fields.
///
/// # Errors
/// One for each field at fault.
pub fn read(mut fields: Fields, files: [Option<&DroppedFile>; 2]) -> Result<(Inputs, Vertical), Vec<FieldError>> {
    let (mut spec, body_height) = spec(&mut fields);
    let block = match fields.has_errors() {
        true => None,
        false => block(&mut fields, &spec),
    };
    let block = tied(&mut fields, block);
    spec.hold = spec.hold.with_links(block.as_ref().map_or(&[], |block| block.ties()));
    let (excitation, vertical) = excitation(&mut fields, files);
    let pulse = match excitation {
        Excitation::Pulse => pulse(&mut fields),
        _ => Pulse::NONE,
    };
    let (unscaled, doubtful) = records::ground(&mut fields, files, spec.gravity());
    let scale = match excitation {
        Excitation::Embedded | Excitation::File { .. } => fields.number("scale", |_| true, "a finite factor"),
        Excitation::Pulse | Excitation::Release => 1.0,
    };
    let (tilt, theta_dot) = match excitation {
        Excitation::Release => release(&mut fields),
        _ => (0.0, 0.0),
    };
    let limits = limits::properties::<SingleRunSpec>();
    let of_tolerance = &limits["tolerance"];
    let admits = |number| limits::admits(of_tolerance, number);
    let tolerance = fields.number("tolerance", admits, &limits::expected(of_tolerance));
    let on_separation = fields.choice("on_separation");
    let [duration, step] = ["duration", "step"].map(|field| fields.limited(field, &limits[field]));
    let Some(block) = block else { return Err(fields.into_errors()) };
    if fields.has_errors() {
        return Err(fields.into_errors());
    }
    let theta = tilt * block.alpha;
    if theta.abs() >= 1.57 {
        fields.refuse(FieldError::new("tilt", format!("found {theta} rad; expected a rotation within ±1.57 rad")));
    }
    let ground = unscaled.clone().scaled(scale);
    let output_step = step.or(ground.time_step()).unwrap_or(0.01);
    let settings = Settings { tolerance, on_separation, ..Settings::default() };
    let initial = Initial { theta, theta_dot, ..Initial::default() };
    let description = describe(&excitation, &vertical, &ground, &pulse, block.gravity);
    let mut warnings = doubts::of_blocks([block]);
    warnings.extend(doubts::of_pulses([(pulse, block.gravity)], !ground.is_empty()));
    warnings.extend(doubtful);
    let run = Run { block, settings, initial, pulse, ground, duration, output_step };
    let rows = run.longest_duration() / output_step;
    // A page keeps all rows in memory.
    if rows > 4e6 {
        let field = if step.is_some() { "step" } else { "duration" };
        fields.refuse(FieldError::new(field, format!("found {rows:.0} rows; expected at most 4000000")));
    }
    let body_height = body_height.unwrap_or(2.0 * block.h);
    let inputs = Inputs { run, unscaled, scale, spec, body_height, excitation, step, description, warnings };
    fields.finish((inputs, vertical))
}

/// The parameters of the block without its ties, and the height of the body (m), if it is given.
fn spec(fields: &mut Fields) -> (BlockSpec, Option<f64>) {
    let shape = fields.one_of("shape", &["size", "ratios"]);
    let foundation = fields.choice("foundation");
    let slides = fields.one_of("sliding", &["none", "friction"]) == "friction";
    let spec = BlockSpec {
        mass: Some(fields.number("mass", |x| x > 0.0, "a mass > 0 kg")),
        gamma: Some(fields.number("gamma", |x| x > 0.0, "a number > 0")),
        epsilon: Some(fields.number("epsilon", |x| (0.0..=1.0).contains(&x), "a number from 0 to 1")),
        g: Some(fields.number("g", |x| x > 0.0, "an acceleration > 0 m/s²")),
        foundation: Some(foundation),
        restitution_factor: (foundation == Foundation::Rigid)
            .then(|| fields.number("restitution_factor", |x| x >= 0.0, "a factor of at least 0")),
        hold: HoldSpec {
            eccentricity: Some(fields.number("eccentricity", |_| true, "a length in m")),
            friction: slides.then(|| {
                fields.number("friction", |x| x > 0.0, "a coefficient > 0; without a limit, feet that do not slide")
            }),
            ..HoldSpec::default()
        },
        ..BlockSpec::default()
    };
    if shape == "ratios" {
        let angle = |x: f64| x > 0.0 && x < std::f64::consts::FRAC_PI_2;
        let spec = BlockSpec {
            alpha: Some(fields.number("alpha", angle, "an angle between 0 and π/2 rad")),
            p: Some(fields.number("p", |x| x > 0.0, "a frequency > 0 rad/s")),
            ..spec
        };
        return (with_ratios(fields, spec), None);
    }
    let width = fields.number("width", |x| x > 0.0, "a length > 0 m");
    let body_height = fields.number("height", |x| x > 0.0, "a length > 0 m");
    let within = |x: f64| x > 0.0 && (body_height.is_nan() || x < body_height);
    let center_height = fields.optional("center_height", within, "a height within the body, in m, or nothing");
    let inertia = fields.optional("inertia", |x| x > 0.0, "a moment of inertia > 0 kg·m², or nothing");
    let sized = BlockSpec {
        width: Some(width),
        height: center_height.is_none().then_some(body_height),
        center_height,
        inertia,
        gamma: spec.gamma.filter(|_| inertia.is_none()),
        ..spec.clone()
    };
    let in_stiffness =
        foundation == Foundation::Viscoelastic && fields.one_of("supports", &["ratios", "stiffness"]) == "stiffness";
    let sized = match foundation {
        Foundation::Rigid => sized,
        Foundation::Viscoelastic if in_stiffness => BlockSpec {
            stiffness: Some(fields.number("stiffness", |x| x > 0.0, "a stiffness > 0 N/m")),
            damping: Some(fields.number("damping", |x| x >= 0.0, "a damping of at least 0 N·s/m")),
            ..sized
        },
        Foundation::Viscoelastic if fields.has_errors() => sized,
        // With ratios for its supports a block has α, p and γ of these sizes, for which the supports make no difference.
        Foundation::Viscoelastic => {
            let on_rigid_base = BlockSpec { foundation: Some(Foundation::Rigid), ..sized };
            let Some(Block { alpha, gamma, body, .. }) = block(fields, &on_rigid_base) else {
                return (spec, Some(body_height));
            };
            with_ratios(fields, BlockSpec { alpha: Some(alpha), p: Some(body.p), gamma: Some(gamma), ..spec })
        }
    };
    (sized, Some(body_height))
}

/// The block on supports with η and ξ_v of the fields, unless it is on a rigid base.
fn with_ratios(fields: &mut Fields, spec: BlockSpec) -> BlockSpec {
    match spec.foundation() {
        Foundation::Rigid => spec,
        Foundation::Viscoelastic => BlockSpec {
            eta: Some(fields.number("eta", |x| x > 0.0, "a ratio > 0")),
            xi_v: Some(fields.number("xi_v", |x| x >= 0.0, "a ratio of at least 0")),
            ..spec
        },
    }
}

/// Initial tilt over α and angular velocity (rad/s).
fn release(fields: &mut Fields) -> (f64, f64) {
    let tilt = fields.number("tilt", |_| true, "a rotation over alpha");
    let theta_dot = fields.number("theta_dot", |_| true, "an angular velocity in rad/s");
    if tilt == 0.0 && theta_dot == 0.0 {
        fields.refuse(FieldError::new("tilt", "found no tilt and no velocity; expected at least one other than 0"));
    }
    (tilt, theta_dot)
}

fn block(fields: &mut Fields, spec: &BlockSpec) -> Option<Block> {
    let error = match spec.block() {
        Ok(block) => return Some(block),
        Err(SpecError::Invalid(error)) => block_error(&error, fields.text("shape")),
        Err(error) => FieldError::new(error.parameter().unwrap_or_default(), error.spelled(str::to_owned)),
    };
    fields.refuse(error);
    None
}

/// The block with its ties and dampers.
fn tied(fields: &mut Fields, block: Option<Block>) -> Option<Block> {
    let mut block = block;
    let mut ties = Vec::new();
    for kind in LinkKind::ALL {
        let count = match fields.one_of(kind.word(), &["none", "one", "two"]) {
            "one" => 1,
            "two" => 2,
            _ => 0,
        };
        for number in 1..=count {
            ties.push(tie(fields, kind, number));
            if fields.has_errors() {
                continue;
            }
            let field = format!("{}_{number}_stiffness", kind.word());
            let error = |error: BlockError| FieldError::new(field, error.to_string());
            block = block?.with_ties(&ties).map_err(|found| fields.refuse(error(found))).ok();
        }
    }
    block
}

fn tie(fields: &mut Fields, kind: LinkKind, number: usize) -> Tie {
    let mut tie = Tie { kind, ..Tie::default() };
    for (key, _) in kind.numbers() {
        let (fits, expected): (fn(f64) -> bool, _) = match key {
            "block_x" | "block_z" | "ground_x" | "ground_z" => (|_| true, "a length in m"),
            "stiffness" => (|x| x > 0.0, "a stiffness > 0 N/m"),
            "slack" => (|x| x >= 0.0, "a length of at least 0 m"),
            "damping" => (|x| x >= 0.0, "a damping of at least 0 N·s/m"),
            "strength" => (|x| x >= 0.0, "a force > 0 N, or 0 for one that does not break"),
            "yield_force" => (|x| x >= 0.0, "a force > 0 N, or 0 for one that stays elastic"),
            "hardening" => (|x| (0.0..1.0).contains(&x), "a ratio from 0 to below 1"),
            _ => (|x| x >= 0.0, "a force of at least 0 N"),
        };
        let found = fields.number(&format!("{}_{number}_{key}", kind.word()), fits, expected);
        if let Some(value) = tie.number(key) {
            *value = found;
        }
    }
    if tie.hardening > 0.0 && !tie.yields() {
        let field = format!("{}_{number}_hardening", kind.word());
        fields.refuse(FieldError::new(field, "found a ratio without a yield force; expected both, or 0"));
    }
    tie
}

/// The field of a parameter at fault.
pub fn block_error(error: &BlockError, shape: &str) -> FieldError {
    let field = match error.name() {
        "K" | "omega_v" | "delta_s" => "stiffness",
        "C" => "damping",
        name @ ("mass" | "gamma" | "g" | "epsilon" | "eta" | "xi_v" | "restitution_factor") => name,
        name @ ("eccentricity" | "friction" | "inertia" | "width" | "height") => name,
        _ if shape == "size" => "width",
        "p" => "p",
        _ => "alpha",
    };
    FieldError::new(field, error.to_string())
}

fn excitation(fields: &mut Fields, files: [Option<&DroppedFile>; 2]) -> (Excitation, Vertical) {
    let name = |file: Option<&DroppedFile>| file.map(|file| file.name.clone()).unwrap_or_default();
    let excitation = match fields.text("excitation") {
        "embedded" => Excitation::Embedded,
        "file" => Excitation::File { name: name(files[0]), settings: records::settings(fields, Direction::Horizontal) },
        "pulse" => Excitation::Pulse,
        "release" => Excitation::Release,
        other => {
            let expected = "expected embedded, file, pulse or release";
            fields.refuse(FieldError::new("excitation", format!("found {other}; {expected}")));
            Excitation::Release
        }
    };
    let vertical = match excitation {
        Excitation::Embedded | Excitation::File { .. } => fields.one_of("vertical", &["none", "file"]),
        Excitation::Pulse | Excitation::Release => "none",
    };
    let vertical = (vertical == "file").then(|| (name(files[1]), records::settings(fields, Direction::Vertical)));
    (excitation, vertical)
}

fn pulse(fields: &mut Fields) -> Pulse {
    let shape = fields.choice("pulse");
    if shape == PulseShape::None {
        fields.refuse(FieldError::new("pulse", "found none; expected a shape"));
    }
    let pulse = Pulse {
        shape,
        amplitude: fields.number("amplitude", |x| x != 0.0, "an acceleration in m/s², other than 0"),
        period: fields.number("period", |x| x > 0.0, "a time > 0 s"),
        ..Pulse::NONE
    };
    match shape {
        PulseShape::Gabor => Pulse {
            phase: fields.number("phase", |_| true, "an angle in rad"),
            cycles: fields.number("cycles", |x| x >= 1.0, "a number of at least 1"),
            ..pulse
        },
        _ => pulse,
    }
}

/// Describes the excitation as the program does.
fn describe(excitation: &Excitation, vertical: &Vertical, ground: &Ground, pulse: &Pulse, gravity: f64) -> String {
    let one_line = |record: &Record| record.title.split_whitespace().collect::<Vec<_>>().join(" ");
    let title = |record: &Record, name: &str| match one_line(record) {
        title if title == name => title,
        title => format!("{name}: {title}"),
    };
    let strength = |record: &Record| significant(pga(record) / gravity, 3);
    let name = match excitation {
        Excitation::Embedded => records::EMBEDDED.0,
        Excitation::File { name, .. } => name,
        Excitation::Pulse => return rocking_studies::spec::pulse::text(pulse),
        Excitation::Release => return "free motion".into(),
    };
    let mut parts = Vec::new();
    if let Some(record) = &ground.horizontal {
        parts.push(format!("{}, {} g", title(record, name), strength(record)));
    }
    if let (Some(record), Some((name, _))) = (&ground.vertical, vertical) {
        parts.push(format!("vertical {}, {} g", title(record, name), strength(record)));
    }
    parts.join(" + ")
}
