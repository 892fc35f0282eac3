//! Fields → a run.

use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, BlockError, Common, Dimensionless, Foundation, Physical};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::ground::Ground;
use rocking_block::simulation::{Initial, Settings};
use rocking_charts::numerals::significant;
use rocking_records::Record;
use rocking_studies::intensity::pga;
use rocking_studies::run::Run;

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
    /// The parameters that define the block.
    pub parameters: Parameters,
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

/// The parameters from which the block was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameters {
    /// The paper's.
    Dimensionless(Dimensionless),
    /// Sizes, and supports in SI units.
    Physical(Physical),
}

impl Parameters {
    /// Whether the moment of inertia replaces γ.
    pub fn has_inertia(&self) -> bool {
        matches!(self, Parameters::Physical(Physical { inertia: Some(_), .. }))
    }
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
    let mut common = common(&mut fields);
    let sizes = (fields.text("shape") == "size").then(|| sizes(&mut fields));
    let parameters = match &sizes {
        Some(sizes) => of_sizes(&mut fields, sizes, &mut common),
        None => Some(Parameters::Dimensionless(ratios(&mut fields, common.foundation))),
    };
    let block = match parameters.filter(|_| !fields.has_errors()) {
        Some(parameters) => block(&mut fields, &parameters, &common),
        None => None,
    };
    let block = tied(&mut fields, block);
    let (excitation, vertical) = excitation(&mut fields, files);
    let pulse = match excitation {
        Excitation::Pulse => pulse(&mut fields),
        _ => Pulse::NONE,
    };
    let unscaled = records::ground(&mut fields, files, common.gravity);
    let scale = match excitation {
        Excitation::Embedded | Excitation::File { .. } => fields.number("scale", |_| true, "a finite factor"),
        Excitation::Pulse | Excitation::Release => 1.0,
    };
    let (tilt, theta_dot) = match excitation {
        Excitation::Release => release(&mut fields),
        _ => (0.0, 0.0),
    };
    let tolerance = fields.number("tolerance", Settings::admits_tolerance, Settings::EXPECTED_TOLERANCE);
    let on_separation = fields.choice("on_separation");
    let duration = fields.optional("duration", |x| x > 0.0, "a time > 0 s, or nothing");
    let step = fields.optional("step", |x| x > 0.0, "a time > 0 s, or nothing");
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
    let mut warnings = Vec::from_iter(block.soft_supports());
    let sources = [(files[0], &unscaled.horizontal, "excitation"), (files[1], &unscaled.vertical, "vertical")];
    for (file, record, field) in sources {
        if let (Some(file), Some(record), "file") = (file, record, fields.text(field)) {
            warnings.extend(records::doubt(file, record));
        }
    }
    let run = Run { block, settings, initial, pulse, ground, duration, output_step };
    let rows = run.longest_duration() / output_step;
    // A page keeps all rows in memory.
    if rows > 4e6 {
        let field = if step.is_some() { "step" } else { "duration" };
        fields.refuse(FieldError::new(field, format!("found {rows:.0} rows; expected at most 4000000")));
    }
    let parameters = parameters.unwrap_or_else(|| unreachable!("a block has parameters"));
    let body_height = sizes.map_or(2.0 * block.h, |sizes| sizes.body_height);
    let inputs = Inputs { run, unscaled, scale, parameters, body_height, excitation, step, description, warnings };
    fields.finish((inputs, vertical))
}

fn common(fields: &mut Fields) -> Common {
    let foundation = fields.choice("foundation");
    let restitution_factor = match foundation {
        Foundation::Rigid => fields.number("restitution_factor", |x| x >= 0.0, "a factor of at least 0"),
        Foundation::Viscoelastic => 1.0,
    };
    Common {
        mass: fields.number("mass", |x| x > 0.0, "a mass > 0 kg"),
        gamma: fields.number("gamma", |x| x > 0.0, "a number > 0"),
        epsilon: fields.number("epsilon", |x| (0.0..=1.0).contains(&x), "a number from 0 to 1"),
        gravity: fields.number("g", |x| x > 0.0, "an acceleration > 0 m/s²"),
        foundation,
        restitution_factor,
        eccentricity: fields.number("eccentricity", |_| true, "a length in m"),
        friction: fields.number("friction", |x| x >= 0.0, "a coefficient > 0, or 0 for no limit"),
    }
}

fn is_in_stiffness(fields: &Fields) -> bool {
    fields.text("shape") == "size" && fields.text("supports") == "stiffness" && fields.text("foundation") != "rigid"
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

/// Sizes of a body as measured.
struct Sizes {
    width: f64,
    body_height: f64,
    /// Height of the centre of mass (m), if it is not half the body's.
    center_height: Option<f64>,
    inertia: Option<f64>,
}

fn sizes(fields: &mut Fields) -> Sizes {
    let width = fields.number("width", |x| x > 0.0, "a length > 0 m");
    let body_height = fields.number("height", |x| x > 0.0, "a length > 0 m");
    let within = |x: f64| x > 0.0 && (body_height.is_nan() || x < body_height);
    Sizes {
        width,
        body_height,
        center_height: fields.optional("center_height", within, "a height within the body, in m, or nothing"),
        inertia: fields.optional("inertia", |x| x > 0.0, "a moment of inertia > 0 kg·m², or nothing"),
    }
}

/// Parameters of a block of these sizes. With ratios for its supports, a given inertia replaces γ in `common`.
fn of_sizes(fields: &mut Fields, sizes: &Sizes, common: &mut Common) -> Option<Parameters> {
    let Sizes { width, body_height, center_height, inertia } = *sizes;
    let height = center_height.map_or(body_height, |height| 2.0 * height);
    if is_in_stiffness(fields) {
        let stiffness = fields.number("stiffness", |x| x > 0.0, "a stiffness > 0 N/m");
        let damping = fields.number("damping", |x| x >= 0.0, "a damping of at least 0 N·s/m");
        return Some(Parameters::Physical(Physical { width, height, stiffness, damping, inertia }));
    }
    let (eta, xi_v) = supports_in_ratios(fields, common.foundation);
    if fields.has_errors() {
        return None;
    }
    // α, p and γ of these sizes, for which the supports make no difference.
    let any_supports = Physical { width, height, stiffness: common.mass, damping: 0.0, inertia };
    let block = block(fields, &Parameters::Physical(any_supports), common)?;
    common.gamma = block.gamma;
    Some(Parameters::Dimensionless(Dimensionless { alpha: block.alpha, p: block.p, eta, xi_v }))
}

fn ratios(fields: &mut Fields, foundation: Foundation) -> Dimensionless {
    let (eta, xi_v) = supports_in_ratios(fields, foundation);
    Dimensionless {
        alpha: fields.number("alpha", |x| x > 0.0 && x < std::f64::consts::FRAC_PI_2, "an angle between 0 and π/2 rad"),
        p: fields.number("p", |x| x > 0.0, "a frequency > 0 rad/s"),
        eta,
        xi_v,
    }
}

/// η and ξ_v.
fn supports_in_ratios(fields: &mut Fields, foundation: Foundation) -> (f64, f64) {
    match foundation {
        Foundation::Viscoelastic => (
            fields.number("eta", |x| x > 0.0, "a ratio > 0"),
            fields.number("xi_v", |x| x >= 0.0, "a ratio of at least 0"),
        ),
        // The rigid base uses neither; these are the defaults of the program.
        Foundation::Rigid => (40.0, 0.1),
    }
}

fn block(fields: &mut Fields, parameters: &Parameters, common: &Common) -> Option<Block> {
    let block = match parameters {
        Parameters::Dimensionless(dimensionless) => Block::from_dimensionless(dimensionless, common),
        Parameters::Physical(physical) => Block::from_physical(physical, common),
    };
    block.map_err(|error| fields.refuse(block_error(&error, fields.text("shape")))).ok()
}

/// The block with its ties.
fn tied(fields: &mut Fields, block: Option<Block>) -> Option<Block> {
    let count = match fields.text("tie") {
        "one" => 1,
        "two" => 2,
        _ => 0,
    };
    let mut block = block;
    let mut ties = Vec::new();
    for number in 1..=count {
        ties.push(tie(fields, number));
        if fields.has_errors() {
            continue;
        }
        let error = |error: BlockError| FieldError::new(format!("tie_{number}_stiffness"), error.to_string());
        block = block?.with_ties(&ties).map_err(|found| fields.refuse(error(found))).ok();
    }
    block
}

fn tie(fields: &mut Fields, number: usize) -> Tie {
    let mut value =
        |key: &str, fits: fn(f64) -> bool, expected| fields.number(&format!("tie_{number}_{key}"), fits, expected);
    let mut length = |key| value(key, |_| true, "a length in m");
    Tie {
        block: [length("block_x"), length("block_z")],
        ground: [length("ground_x"), length("ground_z")],
        stiffness: value("stiffness", |x| x > 0.0, "a stiffness > 0 N/m"),
        pretension: value("pretension", |x| x >= 0.0, "a force of at least 0 N"),
        slack: value("slack", |x| x >= 0.0, "a length of at least 0 m"),
        damping: value("damping", |x| x >= 0.0, "a damping of at least 0 N·s/m"),
        strength: value("strength", |x| x >= 0.0, "a force > 0 N, or 0 for a tie that does not break"),
    }
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
    let has_vertical = fields.text("vertical") == "file";
    let vertical = match excitation {
        Excitation::Embedded | Excitation::File { .. } if has_vertical => {
            Some((name(files[1]), records::settings(fields, Direction::Vertical)))
        }
        _ => None,
    };
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
        Excitation::Pulse => return pulse.to_string(),
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
