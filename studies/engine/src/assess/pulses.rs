//! The object → the least pulses that overturn it. In a building they pass from the ground to its floors, in space they have an azimuth.

use crate::assess::object::AssessedObject;
use crate::assess::plan::Plan;
use crate::assess::results::LeastPulse;
use crate::building::Building;
use crate::run::Run;
use crate::search::{self, Scan, Shaken, Threshold};
use crate::space::RunInSpace;
use crate::spec::words::Words;
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::space::Base;
use rocking_records::{Format, Processing, Record, Unit};

/// Values of a scan, as in `rocking search overturning`. The width of bisected changes (m/s²) follows.
pub(super) const POINTS: u64 = 201;
const RESOLUTION: f64 = 1e-6;
/// Samples per period of a pulse that passes through a building.
const SAMPLES: f64 = 200.0;

/// Azimuths of the pulses of an object in space (degrees): along both axes of its base, along one of a circle.
const AZIMUTHS: [f64; 2] = [0.0, 90.0];

/// The places and directions of the pulses: each floor of a building, each axis of a base in space, else the ground.
pub(super) fn places(plan: &Plan) -> Vec<(Option<usize>, Option<f64>)> {
    if let Some(object) = plan.object.in_space() {
        let axes = if matches!(object.parameters.base, Base::Circle { .. }) { 1 } else { AZIMUTHS.len() };
        return AZIMUTHS[..axes].iter().map(|&azimuth| (None, Some(azimuth))).collect();
    }
    let floors = plan.floors();
    if floors.is_empty() { vec![(None, None)] } else { floors.into_iter().map(|floor| (Some(floor), None)).collect() }
}

/// Searches the least amplitude of each period, at each of the [`places`]. Runs on the current rayon pool; `ran` is called after each
/// run.
pub(super) fn least(plan: &Plan, width: Option<VectorWidth>, ran: impl Fn() + Sync) -> Vec<LeastPulse> {
    let settings = plan.values.variables.settings(Some(plan.sweep.tolerance));
    let search = |(period, (floor, azimuth)): (f64, (Option<usize>, Option<f64>))| {
        let pulse = Pulse { shape: plan.pulse, period, amplitude: 1.0, ..Pulse::NONE };
        let (found, greatest) = match (&plan.object, &plan.sweep.building, floor) {
            (AssessedObject::Space(object), ..) => {
                let at_rest = RunInSpace::at_rest(object.parameters.clone(), object.body.clone(), settings);
                threshold(&at_rest.with_pulse(pulse, azimuth.unwrap_or_default()), width, &ran)
            }
            (AssessedObject::Plane(block), Some(building), Some(floor)) => {
                let ground = on_floor(&pulse, building, floor);
                threshold(&Run { ground, ..Run::at_rest(**block, settings) }, width, &ran)
            }
            (AssessedObject::Plane(block), ..) => {
                threshold(&Run { pulse, ..Run::at_rest(**block, settings) }, width, &ran)
            }
        };
        LeastPulse { period, floor, azimuth, amplitude: found.value(), bound: found.bound(), greatest }
    };
    let places = places(plan);
    plan.pulse_periods.iter().flat_map(|&period| places.iter().map(move |&place| (period, place))).map(search).collect()
}

/// Searches the least strength of a run; the greatest one of the search goes with it.
fn threshold<E: Shaken>(run: &E, width: Option<VectorWidth>, ran: &(impl Fn() + Sync)) -> (Threshold, f64) {
    let [from, to] = run.usual_strengths();
    let scan = Scan { from, to, points: POINTS, resolution: RESOLUTION };
    (search::overturning(run, &scan, width, &|_, _| ran()).overturning(), to)
}

/// The motion of a floor under a pulse of the ground.
fn on_floor(pulse: &Pulse, building: &Building, floor: usize) -> Ground {
    let step = pulse.period / SAMPLES;
    let samples = (pulse.end() / step).ceil() as usize + 1;
    let record = Record {
        title: pulse.shape.word().into(),
        format: Format::Columns,
        unit: Unit::MetrePerSecondSquared,
        start_time: 0.0,
        time_step: step,
        acceleration: (0..samples).map(|sample| pulse.acceleration(step * sample as f64)).collect(),
        processing: Processing::default(),
    };
    let horizontal = building.floor_motions(&record).into_iter().find(|motion| motion.floor == floor);
    Ground { horizontal: horizontal.map(|motion| motion.record), vertical: None }
}
