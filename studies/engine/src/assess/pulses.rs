//! The object → the least pulses that overturn it. In a building they pass from the ground to its floors.

use crate::assess::plan::Plan;
use crate::assess::results::LeastPulse;
use crate::building::Building;
use crate::search::{self, OutcomeMap, Scan, Shaking};
use crate::spec::words::Words;
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_records::{Format, Processing, Record, Unit};

/// Values of a scan, as in `rocking search overturning`. The width of bisected changes (m/s²) follows.
pub(super) const POINTS: u64 = 201;
const RESOLUTION: f64 = 1e-6;
/// Samples per period of a pulse that passes through a building.
const SAMPLES: f64 = 200.0;

/// Searches the least amplitude of each period, on each floor of a building. Runs on the current rayon pool; `ran` is called after each
/// run.
pub(super) fn least(plan: &Plan, width: Option<VectorWidth>, ran: impl Fn() + Sync) -> Vec<LeastPulse> {
    let settings = plan.values.settings(Some(plan.sweep.tolerance));
    let search = |(period, floor): (f64, Option<usize>)| {
        let pulse = Pulse { shape: plan.pulse, period, amplitude: 1.0, ..Pulse::NONE };
        let shaking = match (&plan.sweep.building, floor) {
            (Some(building), Some(floor)) => Shaking::Records(on_floor(&pulse, building, floor)),
            _ => Shaking::Pulse(pulse),
        };
        let [from, to] = search::usual_strengths(&plan.block, &shaking);
        let scan = Scan { from, to, points: POINTS, resolution: RESOLUTION };
        let found = search::overturning(&plan.block, &shaking, settings, &scan, width, &|_, _| ran());
        let threshold = OutcomeMap::overturning(&found);
        LeastPulse { period, floor, amplitude: threshold.value(), bound: threshold.bound(), greatest: to }
    };
    let floors = plan.floors();
    let floors: Vec<Option<usize>> =
        if floors.is_empty() { vec![None] } else { floors.into_iter().map(Some).collect() };
    plan.pulse_periods.iter().flat_map(|&period| floors.iter().map(move |&floor| (period, floor))).map(search).collect()
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
