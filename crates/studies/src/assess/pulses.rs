//! The object → the least pulses that overturn it.

use crate::assess::plan::Plan;
use crate::assess::results::LeastPulse;
use crate::search::{self, OutcomeMap, Scan, Shaking};
use rocking_block::excitation::Pulse;
use rocking_block::numerics::wide::VectorWidth;

/// Values of a scan, and the width to which changes between them are bisected (m/s²), as in `rocking search overturning`.
pub(super) const POINTS: u64 = 201;
const RESOLUTION: f64 = 1e-6;

/// Searches the least amplitude of each period on the current rayon pool; `ran` is called after each run.
pub(super) fn least(plan: &Plan, width: Option<VectorWidth>, ran: impl Fn() + Sync) -> Vec<LeastPulse> {
    let settings = plan.values.settings(Some(plan.sweep.tolerance));
    let search = |&period: &f64| {
        let shaking = Shaking::Pulse(Pulse { shape: plan.pulse, period, ..Pulse::NONE });
        let [from, to] = search::usual_strengths(&plan.block, &shaking);
        let scan = Scan { from, to, points: POINTS, resolution: RESOLUTION };
        let found = search::overturning(&plan.block, &shaking, settings, &scan, width, |_, _| ran());
        let threshold = OutcomeMap::overturning(&found);
        LeastPulse { period, amplitude: threshold.value(), bound: threshold.bound(), greatest: to }
    };
    plan.pulse_periods.iter().map(search).collect()
}
