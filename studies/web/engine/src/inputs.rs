//! Fields → a run.

use rocking_block::block::restraints::tie::LinkNumber;
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
use rocking_studies::spec::space::OF_PLANE;
use rocking_studies::spec::{self, BlockSpec, GaborSpec, PulseSpec, SingleRunSpec, SpecError, limits, option};

use crate::fields::{FieldError, Fields};
use crate::records::{self, Direction, DroppedFile, Files};

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
pub fn read(mut fields: Fields, files: Files) -> Result<(Inputs, Vertical), Vec<FieldError>> {
    let (mut spec, body_height) = spec(&mut fields, false);
    let block = match fields.has_errors() {
        true => None,
        false => block(&mut fields, &spec),
    };
    let block = tied(&mut fields, block);
    spec.hold = spec.hold.with_links(block.as_ref().map_or(&[], |block| block.ties()));
    let Shaking { excitation, vertical, pulse, unscaled, scale, doubtful, settings, duration, step } =
        shaking(&mut fields, files, spec.gravity());
    let (tilt, theta_dot) = match excitation {
        Excitation::Release => release(&mut fields),
        _ => (0.0, 0.0),
    };
    let [horizontal, _, vertical_record] = unscaled;
    let unscaled = Ground { horizontal, vertical: vertical_record };
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
    let initial = Initial { theta, theta_dot, ..Initial::default() };
    let components = [("", &ground.horizontal, excitation.name()), ("vertical ", &ground.vertical, name_of(&vertical))];
    let description = describe(&excitation, &components, &pulse, block.gravity);
    let mut warnings = doubts::of_blocks([block]);
    warnings.extend(doubts::of_pulses([(pulse, block.gravity)], !ground.is_empty()));
    warnings.extend(doubtful);
    let run = Run { block, settings, initial, pulse, ground, duration, output_step };
    check_rows(&mut fields, run.longest_duration() / output_step, step);
    let body_height = body_height.unwrap_or(2.0 * block.h);
    let inputs = Inputs { run, unscaled, scale, spec, body_height, excitation, step, description, warnings };
    fields.finish((inputs, vertical))
}

/// Refuses more rows than a page keeps in memory.
pub fn check_rows(fields: &mut Fields, rows: f64, step: Option<f64>) {
    if rows > 4e6 {
        let field = if step.is_some() { "step" } else { "duration" };
        fields.refuse(FieldError::new(field, format!("found {rows:.0} rows; expected at most 4000000")));
    }
}

/// The motion of the ground and the settings of a run, the same for any body.
pub struct Shaking {
    /// Kind of excitation.
    pub excitation: Excitation,
    /// The vertical file.
    pub vertical: Vertical,
    /// The pulse, if it is the excitation.
    pub pulse: Pulse,
    /// The records along x, y and z before scaling.
    pub unscaled: [Option<Record>; 3],
    /// Factor on the records.
    pub scale: f64,
    /// Doubts about the records.
    pub doubtful: Vec<String>,
    /// Settings of the integration.
    pub settings: Settings,
    /// Duration (s), if given.
    pub duration: Option<f64>,
    /// Time between rows, if given (s).
    pub step: Option<f64>,
}

/// Reads the motion of the ground and the settings; this gravity (m/s²) converts records in g.
pub fn shaking(fields: &mut Fields, files: Files, gravity: f64) -> Shaking {
    let (excitation, vertical) = excitation(fields, files);
    let pulse = match excitation {
        Excitation::Pulse => pulse(fields),
        _ => Pulse::NONE,
    };
    let (unscaled, doubtful) = records::components(fields, files, gravity);
    let scale = match excitation {
        Excitation::Embedded | Excitation::File { .. } => fields.number("scale", |_| true, "a finite factor"),
        Excitation::Pulse | Excitation::Release => 1.0,
    };
    let limits = limits::properties::<SingleRunSpec>();
    let tolerance = fields.required("tolerance", &limits["tolerance"]);
    let on_separation = fields.choice("on_separation");
    let [duration, step] = ["duration", "step"].map(|field| fields.limited(field, &limits[field]));
    let settings = Settings { tolerance, on_separation, ..Settings::default() };
    Shaking { excitation, vertical, pulse, unscaled, scale, doubtful, settings, duration, step }
}

/// The parameters of the block without its ties, in space those of both bodies. The second value is the height of the body (m), if it is
/// given.
pub fn spec(fields: &mut Fields, is_in_space: bool) -> (BlockSpec, Option<f64>) {
    let limits = limits::properties::<BlockSpec>();
    let has_size = fields.one_of("shape", &["size", "ratios"]) == "size";
    let foundation = if is_in_space { Foundation::Viscoelastic } else { fields.choice("foundation") };
    let on_supports = foundation == Foundation::Viscoelastic;
    let in_ratios = on_supports && (!has_size || fields.one_of("supports", &["ratios", "stiffness"]) == "ratios");
    let slides = fields.one_of("sliding", &["none", "friction"]) == "friction";
    let mut spec = BlockSpec { foundation: Some(foundation), ..BlockSpec::default() };
    if has_size {
        spec.width = Some(fields.required("width", &limits["width"]));
    }
    for (name, _) in spec.numbers() {
        let is_read = match name {
            "width" => false,
            "eta" | "xi_v" => in_ratios,
            "K" | "C" => !in_ratios,
            "friction" => slides,
            name => !(is_in_space && OF_PLANE.iter().any(|(known, _)| *known == name)),
        };
        if is_read && spec.without_effect().iter().all(|(without, _)| *without != name) {
            let (field, limits) = (field(name), &limits[name]);
            let found = match name {
                "center_height" | "inertia" => fields.limited(&field, limits),
                _ => Some(fields.required(&field, limits)),
            };
            if let Some(number) = spec.number_mut(name) {
                *number = found;
            }
        }
    }
    let body_height = spec.height;
    if let (Some(center), Some(body)) = (spec.center_height, body_height) {
        if center >= body {
            let message = format!("found {center}; expected a height within the body, below {body} m, or nothing");
            fields.refuse(FieldError::new("center_height", message));
        }
        spec.height = None;
    }
    (spec, body_height)
}

/// The field of a parameter.
pub fn field(name: &str) -> String {
    option(name).replace('-', "_")
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
    let field = |key: &str| format!("{}_{number}_{key}", kind.word());
    for LinkNumber { name: key, quantity, .. } in kind.numbers() {
        let found = match key {
            "stiffness" => fields.number(&field(key), |x| x > 0.0, "a stiffness > 0 N/m"),
            key => fields.number(&field(key), |_| true, &limits::finite(quantity.unit())),
        };
        if let Some(value) = tie.number(key) {
            *value = found;
        }
    }
    if fields.has_errors() {
        return tie;
    }
    if let Err(error) = tie.check(&format!("{}_{number}", kind.word())) {
        let key = error.name().split(" of ").next().unwrap_or_default().replace(' ', "_");
        let key = if tie.number(&key).is_some() { &key } else { "stiffness" };
        fields.refuse(FieldError::new(field(key), error.to_string()));
    } else if let Err(message) = spec::tie::check(&tie) {
        fields.refuse(FieldError::new(field("hardening"), message));
    }
    tie
}

/// The field of a parameter at fault.
pub fn block_error(error: &BlockError, shape: &str) -> FieldError {
    let is_known = BlockSpec::default().numbers().iter().any(|(known, _)| *known == error.name());
    let field = match error.name() {
        "omega_v" | "delta_s" => "stiffness".into(),
        "alpha" | "p" if shape == "size" => "width".into(),
        name if is_known => field(name),
        _ if shape == "size" => "width".into(),
        _ => "alpha".into(),
    };
    FieldError::new(field, error.to_string())
}

fn excitation(fields: &mut Fields, files: Files) -> (Excitation, Vertical) {
    let name = |file: Option<&DroppedFile>| file.map(|file| file.name.clone()).unwrap_or_default();
    let excitation = match fields.text("excitation") {
        "embedded" => Excitation::Embedded,
        "file" => Excitation::File {
            name: name(files[Direction::Horizontal as usize]),
            settings: records::settings(fields, Direction::Horizontal),
        },
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
    let vertical = (vertical == "file")
        .then(|| (name(files[Direction::Vertical as usize]), records::settings(fields, Direction::Vertical)));
    (excitation, vertical)
}

fn pulse(fields: &mut Fields) -> Pulse {
    let shape = fields.choice("pulse");
    if shape == PulseShape::None {
        fields.refuse(FieldError::new("pulse", "found none; expected a shape"));
        return Pulse::NONE;
    }
    let limits = limits::properties::<PulseSpec>();
    let mut number = |name: &str| Some(fields.required(name, &limits[name]));
    let (amplitude, period) = (number("amplitude"), number("period"));
    let gabor = match shape {
        PulseShape::Gabor => GaborSpec { phase: number("phase"), cycles: number("cycles") },
        _ => GaborSpec::default(),
    };
    let spec = PulseSpec { shape: Some(shape), amplitude, period, start: None, gabor };
    match spec.pulse() {
        Ok(pulse) => pulse,
        Err(error) => {
            if !fields.has_errors() {
                fields.refuse(FieldError::new(error.parameter().unwrap_or("pulse"), error.spelled(str::to_owned)));
            }
            Pulse::NONE
        }
    }
}

impl Excitation {
    /// The name of the horizontal file.
    pub fn name(&self) -> &str {
        match self {
            Excitation::Embedded => records::EMBEDDED.0,
            Excitation::File { name, .. } => name,
            Excitation::Pulse | Excitation::Release => "",
        }
    }
}

/// The name of a vertical file.
pub fn name_of(vertical: &Vertical) -> &str {
    vertical.as_ref().map_or("", |(name, _)| name)
}

/// Describes the excitation as the program does. Of each component there is a word, the record and the name of its file.
pub fn describe(
    excitation: &Excitation,
    components: &[(&str, &Option<Record>, &str)],
    pulse: &Pulse,
    gravity: f64,
) -> String {
    let one_line = |record: &Record| record.title.split_whitespace().collect::<Vec<_>>().join(" ");
    let title = |record: &Record, name: &str| match one_line(record) {
        title if title == name => title,
        title => format!("{name}: {title}"),
    };
    let strength = |record: &Record| significant(pga(record) / gravity, 3);
    match excitation {
        Excitation::Pulse => return rocking_studies::spec::pulse::text(pulse),
        Excitation::Release => return "free motion".into(),
        Excitation::Embedded | Excitation::File { .. } => (),
    }
    let part = |(word, record, name): &(&str, &Option<Record>, &str)| {
        record.as_ref().map(|record| format!("{word}{}, {} g", title(record, name), strength(record)))
    };
    components.iter().filter_map(part).collect::<Vec<_>>().join(" + ")
}
