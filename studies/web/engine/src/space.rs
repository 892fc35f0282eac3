//! Fields → a run of a block in space; its history → the outcome in words and numbers.

use rocking_block::run::OnSeparation;
use rocking_block::simulation::Settings;
use rocking_block::space::{Base, SpaceBody, SpaceError, SpaceGround, SpaceInitial};
use rocking_charts::numerals::significant;
use rocking_studies::doubts;
use rocking_studies::hull::hull;
use rocking_studies::output::table::TableColumn;
use rocking_studies::run::outcome::End;
use rocking_studies::space::ground::{ComponentNames, of_components};
use rocking_studies::space::table::columns;
use rocking_studies::space::{HistoryInSpace, RowInSpace, RunInSpace};
use rocking_studies::spec::command::CommandLine;
use rocking_studies::spec::words::Words;
use rocking_studies::spec::{BlockSpec, SpaceSpec, SpecError, limits};
use serde_json::{Value, json};

use crate::command::add_motion;
use crate::fields::{FieldError, Fields};
use crate::inputs::{self, Excitation, Shaking};
use crate::records::{self, Direction, Files};

/// A run in space and what the page says of its inputs.
#[derive(Debug)]
pub struct InputsInSpace {
    /// The run.
    pub run: RunInSpace,
    /// The excitation in words.
    pub description: String,
    /// Warnings, a line each.
    pub warnings: Vec<String>,
    /// The command line of the run.
    pub command: String,
    /// Height of the body (m).
    pub body_height: f64,
}

/// The names of the components in messages.
const COMPONENTS: ComponentNames = ComponentNames {
    names: ["the record along x", "the record along y", "the vertical record"],
    resample: "--resample of the program gives all components one step",
    cut: "cut the files to the samples that all have",
};

/// Reads the fields.
///
/// # Errors
/// One for each field at fault.
pub fn read(mut fields: Fields, files: Files) -> Result<InputsInSpace, Vec<FieldError>> {
    let (spec, body_height) = inputs::spec(&mut fields, true);
    let limits = limits::properties::<SpaceSpec>();
    let [depth, kappa] = ["depth", "kappa"].map(|name| Some(fields.required(name, &limits[name])));
    let space = SpaceSpec { depth, kappa, ..SpaceSpec::default() };
    let azimuth = fields.number("azimuth", |_| true, "an angle in degrees");
    let shaking = inputs::shaking(&mut fields, files, spec.gravity());
    let second = records::has_second(&mut fields).then(|| files[Direction::SecondHorizontal as usize]).flatten();
    let second = second.map(|file| file.name.clone());
    let tilt = match shaking.excitation {
        Excitation::Release => fields.number("tilt", |tilt| tilt != 0.0, "a tilt over alpha, other than 0"),
        _ => 0.0,
    };
    if fields.has_errors() {
        return Err(fields.into_errors());
    }
    let made = space.parameters(&spec, |_| Ok(Vec::new()));
    let made = made.and_then(|parameters| Ok((SpaceBody::new(&parameters)?, parameters)));
    let (body, parameters) = made.map_err(|error| vec![fault(&error, fields.text("shape"))])?;
    let Shaking { excitation, vertical, pulse, unscaled, scale, doubtful, settings, duration, step } = shaking;
    let has_record = unscaled.iter().any(Option::is_some);
    let time_step = unscaled.iter().flatten().map(|record| record.time_step).reduce(f64::min);
    let ground = of_components(unscaled, azimuth.to_radians(), COMPONENTS);
    let ground = ground.map_err(|message| vec![FieldError::new(field_of(&message), message)])?;
    let ground: SpaceGround = ground.scaled_and_shifted(scale, 0.0);
    let [x, y, z] = &ground.records;
    let names = [excitation.name(), second.as_deref().unwrap_or_default(), inputs::name_of(&vertical)];
    let components = [("x ", x, names[0]), ("y ", y, names[1]), ("vertical ", z, names[2])];
    let description = inputs::describe(&excitation, &components, &pulse, body.gravity);
    let description = match excitation {
        Excitation::Release => description,
        _ if azimuth == 0.0 => description,
        _ => format!("{description}, azimuth {azimuth}°"),
    };
    let (sin, cos) = libm::sincos(azimuth.to_radians());
    let tilts = [tilt * body.alpha * cos, tilt * body.alpha * sin];
    let initial = SpaceInitial { tilt: tilts, ..SpaceInitial::default() };
    // The default of the page is no mass of the user.
    let has_mass = spec.mass != BlockSpec::defaults().mass;
    let mut warnings = doubts::of_blocks_in_space([(parameters.clone(), body.clone(), has_mass)]);
    warnings.extend(doubts::of_pulses([(pulse, body.gravity)], has_record));
    warnings.extend(doubtful);
    let body_height = body_height.unwrap_or(2.0 * body.center_height);
    let mut line = CommandLine::new("simulate");
    if excitation == Excitation::Release {
        line.unless("tilt-x", tilts[0], 0.0).unless("tilt-y", tilts[1], 0.0);
    } else {
        add_motion(&mut line, (&excitation, &vertical), &pulse, scale, false);
        if let Some(name) = &second {
            line.option("record-y", name);
        }
        line.unless("azimuth", azimuth, 0.0);
    }
    line.block_in_space(&spec, &space);
    let Settings { tolerance, on_separation, .. } = settings;
    line.unless("tolerance", tolerance, Settings::default().tolerance);
    line.unless("on-separation", on_separation.word(), OnSeparation::Fly.word());
    for (name, value) in [("duration", duration), ("step", step)] {
        if let Some(value) = value {
            line.option(name, value);
        }
    }
    line.option("csv", "history.csv");
    let output_step = step.or(time_step).unwrap_or(0.01);
    let at_rest = RunInSpace::at_rest(parameters, body, settings).with_pulse(pulse, azimuth);
    let run = RunInSpace { initial, ground, duration, output_step, ..at_rest };
    inputs::check_rows(&mut fields, run.longest_duration() / output_step, step);
    fields.finish(InputsInSpace { run, description, warnings, command: line.text(), body_height })
}

/// The field of a component that does not belong to the others: the message begins with its name.
fn field_of(message: &str) -> &'static str {
    match message.starts_with(COMPONENTS.names[1]) {
        true => Direction::SecondHorizontal.field(),
        false => Direction::Vertical.field(),
    }
}

/// The message of a block that cannot be, beside its field.
fn fault(error: &SpecError, shape: &str) -> FieldError {
    match error {
        SpecError::Invalid(error) | SpecError::InSpace(SpaceError::Number(error)) => inputs::block_error(error, shape),
        SpecError::InSpace(error) => FieldError::new("eccentricity", error.to_string()),
        error => FieldError::new(inputs::field(error.parameter().unwrap_or_default()), error.spelled(str::to_owned)),
    }
}

/// The columns that move the body on the page.
const SHOWN: [&str; 9] = ["t", "tilt", "azimuth", "twist", "u", "w", "v", "a_gx", "a_gy"];

/// Returns the columns of the table that the page needs.
pub fn shown(run: &RunInSpace) -> Vec<TableColumn<'static, RowInSpace>> {
    let mut all = columns(&run.parameters);
    let place = |name: &&str| SHOWN.iter().position(|shown| shown == name);
    all.retain(|column| place(&column.heading().name.as_str()).is_some());
    all.sort_by_key(|column| place(&column.heading().name.as_str()));
    all
}

/// Returns the reply to a run, without the numbers of its columns.
pub fn reply(number: u64, inputs: &InputsInSpace, history: &HistoryInSpace) -> Value {
    let InputsInSpace { run, description, warnings, command, body_height } = inputs;
    let body = &run.setup.body;
    let [e_x, e_y] = run.parameters.eccentricity;
    let corners = hull(body.feet.iter().map(|foot| [foot.place.x, foot.place.y]).collect());
    json!({
        "number": number,
        "in_space": true,
        "rows": history.rows.len(),
        "series": shown(run).iter().map(|column| column.heading().name.clone()).collect::<Vec<_>>(),
        "units": shown(run).iter().map(|column| column.heading().unit.clone()).collect::<Vec<_>>(),
        "outcome": history.end.word(),
        "sentence": sentence(run, history),
        "numbers": numbers(run, history),
        "description": description,
        "warnings": warnings,
        "command": command,
        "block": {
            "line": rocking_charts::history_in_space::block_line(&run.parameters, body),
            // From the centre of mass.
            "corners": corners,
            "is_round": matches!(run.parameters.base, Base::Circle { .. }),
            "h": body.center_height,
            "height": body_height,
            "eccentricity": [e_x, e_y],
            "g": body.gravity,
        },
    })
}

/// Describes the outcome in a sentence for laymen.
fn sentence(run: &RunInSpace, history: &HistoryInSpace) -> String {
    let HistoryInSpace { peaks, counts, end, ending, rows, .. } = history;
    let last = rows.last().map_or(0.0, |row| row.observation.time);
    let time = significant(ending.map_or(last, |(_, time)| time), 3);
    let part = significant(100.0 * peaks.tilt_over_critical, 3);
    let twist = significant(peaks.twist().to_degrees(), 2);
    let outcome = match end {
        End::Overturned => {
            let azimuth = rows.last().map_or(0.0, |row| row.observation.attitude.azimuth.to_degrees());
            let azimuth = azimuth.round().rem_euclid(360.0);
            format!("The block overturns at {time} s, towards an azimuth of {azimuth}°.")
        }
        End::Separated => {
            format!("The block leaves the ground at {time} s, where the run ends. Let it fly to see whether it lands.")
        }
        End::Completed if counts.lift_offs == 0 => {
            format!(
                "The block stays on all feet. It tilts by at most {part} % of its balance in the direction in which it leans."
            )
        }
        End::Completed => format!(
            "The block rocks to {part} % of its balance in the direction in which it leans, twists by up to {twist}° and stays upright."
        ),
        End::Undecided => {
            format!("Still undecided after {time} s: the run is too short to tell whether the block overturns.")
        }
        End::Failed => "The integration failed.".into(),
    };
    let slides =
        run.parameters.friction < rocking_block::space::SpaceParameters::default().friction && peaks.slip > 0.0;
    let slip = slides.then(|| format!(" A foot slips by up to {} mm.", significant(1e3 * peaks.slip, 3)));
    outcome + &slip.unwrap_or_default()
}

/// The numbers of a history with their names, as the page shows them.
fn numbers(run: &RunInSpace, history: &HistoryInSpace) -> [(&'static str, String); 8] {
    let (body, peaks, counts) = (&run.setup.body, &history.peaks, &history.counts);
    let millimetres = |length: f64| format!("{} mm", significant(1e3 * length, 4));
    let slope = body.edge_distance / body.center_height;
    [
        ("Greatest tilt over that of the balance", significant(peaks.tilt_over_critical, 4)),
        ("Greatest twist", format!("{}°", significant(peaks.twist().to_degrees(), 4))),
        ("Greatest uplift of a foot", millimetres(peaks.uplift)),
        ("Greatest reaction of a foot", format!("{} M g", significant(peaks.normal / (body.mass * body.gravity), 4))),
        ("Greatest slip of a foot", millimetres(peaks.slip)),
        ("Greatest drift of the base", millimetres(peaks.drift())),
        ("Lift-offs, landings", format!("{}, {}", counts.lift_offs, counts.landings)),
        ("Lifts off rigid feet beyond", format!("{} g", significant(slope, 4))),
    ]
}
