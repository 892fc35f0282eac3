//! A run and an amplitude → the half cycles of plastic elongations above it. They are a measure of low-cycle fatigue.

use crate::output::table::TableColumn;
use crate::run::Run;
use crate::run::rows::RunRow;
use rocking_block::block::restraints::MAX;
use rocking_block::excitation::Inputs;
use rocking_block::simulation::Simulation;

/// The beginning of the column's name, before the amplitude.
pub const COLUMN: &str = "half_cycles>";

/// The column of the greatest number of half cycles of any tie or damper. Their amplitude exceeds the given one (m).
pub fn column<'c, I>(amplitude: f64) -> TableColumn<'c, RunRow<I>> {
    TableColumn::count(format!("{COLUMN}{amplitude}"), move |row: &RunRow<I>| {
        row.run.half_cycles(amplitude).into_iter().max().unwrap_or_default()
    })
}

/// The half cycles of a plastic elongation: simple ranges between its turning points.
#[derive(Clone, Copy, Debug, Default)]
struct HalfCycles {
    /// The last turning point, and the last sample (m).
    turn: f64,
    last: f64,
    count: u32,
}

impl HalfCycles {
    /// Takes the next sample; all turning points are samples.
    fn sample(&mut self, plastic: f64, amplitude: f64) {
        if (plastic - self.last) * (self.last - self.turn) < 0.0 {
            *self = HalfCycles { turn: self.last, ..self.ended(amplitude) };
        }
        self.last = plastic;
    }

    /// Counts the half cycle since the last turning point.
    fn ended(self, amplitude: f64) -> HalfCycles {
        let reaches = 0.5 * (self.last - self.turn).abs() > amplitude;
        HalfCycles { count: self.count + u32::from(reaches), ..self }
    }
}

impl Run {
    /// The half cycles of each tie and damper above an amplitude (m).
    ///
    /// The amplitude is half the range between two turning points; the first half cycle begins at zero. A failed run counts as far as it came.
    pub fn half_cycles(&self, amplitude: f64) -> [u32; MAX] {
        let mut cycles = [HalfCycles::default(); MAX];
        let mut sample = |simulation: &Simulation| {
            for (cycles, plastic) in cycles.iter_mut().zip(simulation.plastic_elongations()) {
                cycles.sample(plastic, amplitude);
            }
        };
        let mut simulation = self.begin();
        sample(&simulation);
        let advance = |simulation: &mut Simulation, stop, inputs: &Inputs| {
            // Plastic elongations turn at events only.
            loop {
                let now = simulation.time();
                let progress = simulation.advance_to_event(stop, now, inputs, &mut |_| ())?;
                sample(simulation);
                if let Some(progress) = progress {
                    return Ok(progress);
                }
            }
        };
        let _ = self.drive(&mut simulation, advance, |_, _, _| ());
        cycles.map(|cycles| cycles.ended(amplitude).count)
    }
}
