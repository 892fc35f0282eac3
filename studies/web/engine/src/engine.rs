//! A request → its reply.

use std::collections::BTreeMap;

use rocking_block::block::restraints::{LinkKind, tie};
use rocking_block::block::{Corner, Foundation, restraints};
use rocking_block::simulation::Ending;
use rocking_block::system::events::{Event, EventKind};
use rocking_charts::numerals::significant;
use rocking_studies::foundations;
use rocking_studies::output::csv::lines;
use rocking_studies::output::format::{DescribedTable, TableFormat};
use rocking_studies::output::runner::Study as Rows;
use rocking_studies::run::outcome::Holds;
use rocking_studies::run::{History, Row, Run, table};
use rocking_studies::space::{HistoryInSpace, RunInSpace};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::ensemble;
use crate::fields::{FieldError, Fields};
use crate::inputs::{self, Inputs, Vertical};
use crate::records::{Direction, DroppedFile};
use crate::specification::specification;
use crate::{command, outcome, space, spectrum};

/// A request of the page.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "lowercase")]
pub enum Request {
    /// Keeps a dropped file, whose bytes follow the request.
    File {
        /// `record`, `record_y` or `vertical`.
        slot: String,
        /// Name of the file.
        name: String,
    },
    /// Makes a run and keeps it.
    Run {
        /// Its number, by which exports name it.
        #[serde(default)]
        number: u64,
        /// The fields.
        fields: BTreeMap<String, String>,
    },
    /// Rows of the table of the last run.
    Csv {
        /// The number of the run that is meant; without it, whichever is the last.
        run: Option<u64>,
        /// The first row, which the headings precede if it is the first of the run.
        #[serde(default)]
        from: usize,
        /// The row after the last; without it, all rows.
        to: Option<usize>,
    },
    /// The picture of the last run.
    Svg {
        /// As of `Csv`.
        run: Option<u64>,
        /// Whether that of a block in space is the one from above.
        #[serde(default)]
        plan: bool,
    },
    /// Units, defaults and choices of the fields, for the build.
    Specification,
    /// Friction and restitution of pairs of surfaces, with their sources.
    Surfaces,
    /// Prepares a spectrum.
    Spectrum {
        /// The fields.
        fields: BTreeMap<String, String>,
    },
    /// Prepares an ensemble.
    Ensemble {
        /// The fields.
        fields: BTreeMap<String, String>,
    },
    /// Makes rows of the study last prepared.
    Rows {
        /// The first row.
        from: u64,
        /// The row after the last.
        to: u64,
    },
}

/// A reply: JSON, followed by bytes.
#[derive(Debug)]
pub struct Reply {
    /// The description.
    pub json: Value,
    /// Numbers or the content of a file.
    pub bytes: Vec<u8>,
}

/// The JSON and the bytes of a reply, or the faults of the request.
type Answer = Result<(Value, Vec<u8>), Vec<FieldError>>;

/// A fault of no field.
fn refused(message: impl ToString) -> Vec<FieldError> {
    vec![FieldError::new("run", message.to_string())]
}

/// A series of the plots: its name and its value in a row.
type Series = (&'static str, fn(&Row) -> f64);

/// The series of every history, in the order of the reply's numbers. Those of friction and ties follow.
const SERIES: [Series; 12] = [
    ("t", |row| row.time),
    ("theta", |row| row.observation.theta),
    ("u", |row| row.observation.u),
    ("v", |row| row.observation.v),
    ("N_L", |row| row.observation.reaction[0]),
    ("N_R", |row| row.observation.reaction[1]),
    ("H", |row| row.observation.horizontal),
    ("uplift_L", |row| row.observation.uplift[0]),
    ("uplift_R", |row| row.observation.uplift[1]),
    ("regime", |row| row.regime.number().into()),
    ("a_gx", |row| row.ground[0]),
    ("a_gz", |row| row.ground[1]),
];

/// The files, the last run and the study of a page.
#[derive(Default)]
pub struct Engine {
    files: [Option<DroppedFile>; Direction::ALL.len()],
    last: Option<LastRun>,
    /// Its rows are made in pieces.
    study: Option<Box<dyn Rows>>,
}

/// The last run, for its exports.
struct LastRun {
    number: u64,
    made: Made,
    /// The excitation in words.
    description: String,
}

/// A run with its history.
enum Made {
    Plane(Box<(Run, History)>),
    Space(Box<(RunInSpace, HistoryInSpace)>),
}

#[derive(Serialize)]
struct EventSummary {
    t: f64,
    text: String,
    before: i32,
    after: i32,
}

impl Engine {
    /// Answers a request; `bytes` follow it.
    pub fn answer(&mut self, request: Request, bytes: &[u8]) -> Reply {
        let answered = match request {
            Request::File { slot, name } => {
                let slot = Direction::ALL.into_iter().find(|direction| direction.field() == slot);
                let file = (!bytes.is_empty()).then(|| DroppedFile { name, bytes: bytes.to_vec() });
                self.files[slot.unwrap_or(Direction::Horizontal) as usize] = file;
                Ok((json!({}), Vec::new()))
            }
            Request::Run { number, fields } => self.run(number, &fields),
            Request::Csv { run, from, to } => self.csv(run, from, to),
            Request::Svg { run, plan } => self.svg(run, plan),
            Request::Specification => Ok((specification(), Vec::new())),
            Request::Surfaces => Ok((json!({ "pairs": foundations::pairs() }), Vec::new())),
            Request::Spectrum { fields } => self.spectrum(&fields),
            Request::Ensemble { fields } => self.ensemble(&fields),
            Request::Rows { from, to } => self.rows(from, to),
        };
        match answered {
            Ok((mut json, bytes)) => {
                json["ok"] = true.into();
                Reply { json, bytes }
            }
            Err(errors) => Reply { json: json!({ "ok": false, "errors": errors }), bytes: Vec::new() },
        }
    }

    fn inputs(&self, fields: Fields) -> Result<(Inputs, Vertical), Vec<FieldError>> {
        if fields.text("body") == "space" {
            return Err(refused(
                "studies of this page are for a block in the plane; rocking sweep makes them in space",
            ));
        }
        inputs::read(fields, self.files.each_ref().map(Option::as_ref))
    }

    fn run(&mut self, number: u64, fields: &BTreeMap<String, String>) -> Answer {
        let mut read = Fields::new(fields);
        if read.one_of("body", &["plane", "space"]) == "space" {
            return self.run_in_space(number, read);
        }
        let (inputs, vertical) = self.inputs(Fields::new(fields))?;
        let run = &inputs.run;
        let history = run.history(|_| ()).map_err(|error| vec![FieldError::new("tolerance", error.to_string())])?;
        let forces = table::force_columns(&run.block);
        let mut of_block = table::columns(&run.block);
        of_block.retain(|column| column.heading().name == "slip" || forces.contains(&column.heading().name));
        let names =
            SERIES.iter().map(|(name, _)| *name).chain(of_block.iter().map(|column| column.heading().name.as_str()));
        let json = json!({
            "number": number,
            "rows": history.rows.len(),
            "series": names.collect::<Vec<_>>(),
            "outcome": history.end.word(),
            "sentence": outcome::sentence(run, &history),
            "events": events(&history),
            "broken": broken(run, &history),
            "impacts": history.counts.impacts,
            "liftoffs": history.counts.liftoffs,
            "peak": peaks(run, &history),
            "block": parameters(&inputs),
            "description": inputs.description,
            "warnings": inputs.warnings,
            "command": command::simulate(&inputs, &vertical),
            "end_time": history.ending.map(|(_, time)| time),
            "toppled": matches!(history.ending, Some((Ending::Toppled | Ending::Overturned, _))),
        });
        let mut bytes = Vec::with_capacity(8 * (SERIES.len() + of_block.len()) * history.rows.len());
        let mut push = |value: &dyn Fn(&Row) -> f64| {
            history.rows.iter().for_each(|row| bytes.extend_from_slice(&value(row).to_le_bytes()));
        };
        SERIES.iter().for_each(|(_, value)| push(value));
        of_block.iter().for_each(|column| push(&|row| column.number(row)));
        let made = Made::Plane(Box::new((inputs.run, history)));
        self.last = Some(LastRun { number, made, description: inputs.description });
        Ok((json, bytes))
    }

    fn run_in_space(&mut self, number: u64, fields: Fields) -> Answer {
        let inputs = space::read(fields, self.files.each_ref().map(Option::as_ref))?;
        let history =
            inputs.run.history(|_| ()).map_err(|error| vec![FieldError::new("tolerance", error.to_string())])?;
        let json = space::reply(number, &inputs, &history);
        let columns = space::shown(&inputs.run);
        let values = columns.iter().flat_map(|column| history.rows.iter().map(|row| column.number(row)));
        let bytes = values.flat_map(f64::to_le_bytes).collect();
        let made = Made::Space(Box::new((inputs.run, history)));
        self.last = Some(LastRun { number, made, description: inputs.description });
        Ok((json, bytes))
    }

    /// The last run, which has this number.
    fn last(&self, number: Option<u64>) -> Result<&LastRun, Vec<FieldError>> {
        match &self.last {
            None => Err(refused("no run yet; expected one before its export")),
            Some(last) if number.is_some_and(|number| number != last.number) => {
                Err(refused("another run took the place of this one; save it again"))
            }
            Some(last) => Ok(last),
        }
    }

    fn csv(&self, run: Option<u64>, from: usize, to: Option<usize>) -> Answer {
        let made = &self.last(run)?.made;
        let count = match made {
            Made::Plane(made) => made.1.rows.len(),
            Made::Space(made) => made.1.rows.len(),
        };
        let to = to.unwrap_or(count).min(count);
        let (rows, is_first) = (from.min(to)..to, from == 0);
        let found: DescribedTable = match made {
            Made::Plane(made) => table::table(&made.0.block, &made.1, &[], rows).into(),
            Made::Space(made) => rocking_studies::space::table::table(&made.0.parameters, &made.1, rows),
        };
        let bytes = if is_first { found.encode(TableFormat::Csv) } else { lines(&found.table).map(String::into_bytes) };
        Ok((json!({ "rows": count }), bytes.map_err(refused)?))
    }

    fn svg(&self, run: Option<u64>, plan: bool) -> Answer {
        let LastRun { made, description, .. } = self.last(run)?;
        let svg = match made {
            Made::Plane(made) => rocking_charts::history::history(&made.0.block, &made.1, description),
            Made::Space(made) if plan => rocking_charts::plan::plan(&made.0, &made.1, description),
            Made::Space(made) => rocking_charts::history_in_space::history(&made.0, &made.1, description),
        };
        let svg = svg.map_err(refused)?;
        Ok((json!({}), svg.into_bytes()))
    }

    fn spectrum(&mut self, fields: &BTreeMap<String, String>) -> Answer {
        let (inputs, vertical) = self.inputs(Fields::new(fields))?;
        let omega_p = std::f64::consts::TAU / inputs.run.pulse.period;
        let is_pulse = inputs.excitation == inputs::Excitation::Pulse;
        let (spectrum, command) = spectrum::read(Fields::new(fields), inputs, &vertical)?;
        let sizes: Vec<f64> = (0..spectrum.sizes.count).map(|number| spectrum.sizes.p(number)).collect();
        let json = json!({
            "rows": spectrum.rows(),
            "bases": spectrum.bases.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "p": sizes,
            "omega_p": is_pulse.then_some(omega_p),
            "header": spectrum.header().text().unwrap_or_default(),
            "command": command,
        });
        self.study = Some(Box::new(spectrum));
        Ok((json, Vec::new()))
    }

    fn ensemble(&mut self, fields: &BTreeMap<String, String>) -> Answer {
        let (inputs, vertical) = self.inputs(Fields::new(fields))?;
        let study = ensemble::read(Fields::new(fields), inputs, &vertical)?;
        let json = json!({
            "rows": study.sweep.rows(),
            "strengths": study.strengths,
            "header": study.sweep.header().text().unwrap_or_default(),
            "file": study.file,
            "command": "rocking sweep study.toml --csv ensemble.csv",
        });
        self.study = Some(Box::new(study.sweep));
        Ok((json, Vec::new()))
    }

    fn rows(&self, from: u64, to: u64) -> Answer {
        let Some(study) = &self.study else {
            return Err(refused("no study yet; expected one before its rows"));
        };
        let to = to.min(study.rows());
        let rows = study.make_range(from.min(to)..to, None).table;
        Ok((json!({ "rows": rows.rows(), "columns": rows }), lines(&rows).unwrap_or_default().into_bytes()))
    }
}

fn events(history: &History) -> Vec<EventSummary> {
    let summary = |event: &Event| EventSummary {
        t: event.time,
        text: event
            .kind
            .location()
            .map_or(event.kind.word().into(), |location| format!("{} {location}", event.kind.word())),
        before: event.before.number(),
        after: event.after.number(),
    };
    history.events.iter().map(summary).collect()
}

/// The time at which each tie and damper breaks (s), if it does.
fn broken(run: &Run, history: &History) -> Vec<Option<f64>> {
    let time = |(kind, i): (LinkKind, usize)| {
        let event = restraints::RestraintEvent::Tie(kind, i as u8, tie::TieEvent::Break);
        let found = history.events.iter().find(|found| found.kind == EventKind::Restraint(event));
        found.map(|event| event.time)
    };
    Holds::of(&run.block).links().map(time).collect()
}

fn peaks(run: &Run, history: &History) -> Value {
    let (block, peaks) = (&run.block, &history.peaks);
    let weight = block.mass * block.gravity;
    json!({
        "theta": peaks.theta,
        "ratio": significant(peaks.theta / block.alpha, 4),
        "uplift": significant(1e3 * peaks.uplift, 4),
        "reaction": significant(peaks.reaction / weight, 4),
        "horizontal": significant(peaks.horizontal / weight, 4),
        "friction_demand": significant(peaks.friction_demand, 4),
        "force": block.ties().iter().zip(peaks.pull).map(|(_, force)| significant(force, 4)).collect::<Vec<_>>(),
        "plastic": block.ties().iter().zip(peaks.plastic)
            .map(|(tie, plastic)| tie.yields().then(|| significant(1e3 * plastic, 4))).collect::<Vec<_>>(),
        "slip": significant(1e3 * peaks.slip, 4),
    })
}

/// The block in numbers for drawing, and in words.
fn parameters(inputs: &Inputs) -> Value {
    let block = &inputs.run.block;
    let on_supports = block.foundation == Foundation::Viscoelastic;
    let links = tie::names(block.ties()).into_iter().zip(table::force_columns(block)).zip(block.ties());
    let links = links.map(|((name, column), tie)| {
        json!({
            "name": name.replace('_', " "),
            "kind": tie.kind.word(),
            "quantity": tie.kind.force(),
            "column": column,
            "block": tie.block,
            "ground": tie.ground,
        })
    });
    json!({
        "alpha": block.alpha,
        "b": block.b,
        "h": block.h,
        "height": inputs.body_height,
        "eccentricity": block.eccentricity,
        "on_supports": on_supports,
        "deflection": if on_supports { block.static_deflection() } else { 0.0 },
        "weight": block.mass * block.gravity,
        "g": block.gravity,
        "friction": block.friction,
        "links": links.collect::<Vec<_>>(),
        "line": rocking_charts::history::block_line(block),
        "lift_off": significant(libm::tan(Corner::each(|corner| block.alpha_of(corner)).into_iter().fold(f64::INFINITY, f64::min)), 4),
    })
}
