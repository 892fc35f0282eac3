//! Records → inputs that are linear in time between their samples.

use serde::{Deserialize, Serialize};

use crate::excitation::{Inputs, Ramp};
use crate::records::Record;

/// Ground motion: records, linear between samples and zero outside, each with a time step of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// Horizontal ground acceleration, positive to the right.
    pub horizontal: Option<Record>,
    /// Vertical ground acceleration, positive up.
    pub vertical: Option<Record>,
}

impl Ground {
    fn records(&self) -> impl Iterator<Item = &Record> {
        self.horizontal.iter().chain(&self.vertical)
    }

    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.records().next().is_none()
    }

    /// Time of the first sample (s); 0 without a record.
    pub fn start(&self) -> f64 {
        self.records().map(|record| record.start_time).reduce(f64::min).unwrap_or(0.0)
    }

    /// Time of the last sample (s), if there is a record.
    pub fn end(&self) -> Option<f64> {
        self.records().map(|record| record.start_time + record.duration()).reduce(f64::max)
    }

    /// Least time step of the records (s), if there is one.
    pub fn time_step(&self) -> Option<f64> {
        self.records().map(|record| record.time_step).reduce(f64::min)
    }

    /// Both records multiplied by a factor.
    pub fn scaled(self, factor: f64) -> Ground {
        let scaled = |record: Option<Record>| record.map(|record| record.scaled(factor));
        Ground { horizontal: scaled(self.horizontal), vertical: scaled(self.vertical) }
    }

    /// Both records with the zero of their time axes at this time (s).
    pub fn shifted(self, time: f64) -> Ground {
        let shifted =
            |record: Option<Record>| record.map(|record| Record { start_time: record.start_time + time, ..record });
        Ground { horizontal: shifted(self.horizontal), vertical: shifted(self.vertical) }
    }

    /// Whether these can be records.
    pub fn is_valid(&self) -> bool {
        self.records().all(Record::is_valid)
    }

    /// Both records in a line, see [`fingerprint`].
    pub fn fingerprint(&self) -> String {
        let of = |record: &Option<Record>| record.as_ref().map_or("none".into(), fingerprint);
        format!("horizontal {}; vertical {}", of(&self.horizontal), of(&self.vertical))
    }

    /// The piece that acts at `time` (s), between two samples of any record: its inputs, with their reference at its beginning, and
    /// its end (s).
    pub fn piece_at(&self, time: f64) -> (Inputs, f64) {
        let last = |record: &Record| match record.sample_at(time) {
            Some(i) if i + 1 < record.acceleration.len() => record.sample_time(i),
            Some(_) => record.start_time + record.duration(),
            None => f64::NEG_INFINITY,
        };
        let beginning = self.records().map(last).reduce(f64::max).filter(|beginning| beginning.is_finite());
        self.inputs_from(beginning.unwrap_or(time))
    }

    /// Inputs from `time` on, and the time until which they hold: the next sample of any record (s).
    pub fn inputs_from(&self, time: f64) -> (Inputs, f64) {
        let mut until = f64::INFINITY;
        let mut ramp = |record: &Option<Record>| match record {
            Some(record) => {
                let (ramp, end) = ramp_from(record, time);
                until = until.min(end);
                ramp
            }
            None => Ramp::default(),
        };
        let (a_gx, a_gz) = (ramp(&self.horizontal), ramp(&self.vertical));
        (Inputs { time, a_gx, a_gz, ..Inputs::default() }, until)
    }
}

/// A record in a line: what is needed to tell it from another one, wherever its file is.
pub fn fingerprint(record: &Record) -> String {
    let Record { acceleration, time_step, start_time, .. } = record;
    let mut hasher = crc32fast::Hasher::new();
    acceleration.iter().for_each(|a| hasher.update(&a.to_le_bytes()));
    let sum = hasher.finalize();
    format!("{} samples, every {time_step} s from {start_time} s, crc32 {sum:08x}", acceleration.len())
}

/// The straight line on which a record is from `time` on, and the time of its end.
fn ramp_from(record: &Record, time: f64) -> (Ramp, f64) {
    let Some(i) = record.sample_at(time) else { return (Ramp::default(), record.start_time) };
    match (record.acceleration.get(i), record.acceleration.get(i + 1)) {
        (Some(a), Some(b)) => {
            let rate = (b - a) / record.time_step;
            (Ramp { value: a + rate * (time - record.sample_time(i)), rate }, record.sample_time(i + 1))
        }
        _ => (Ramp::default(), f64::INFINITY),
    }
}

impl Record {
    fn sample_time(&self, i: usize) -> f64 {
        self.start_time + i as f64 * self.time_step
    }

    /// The sample at or before `time`, none before the first; after the last one, the last or the number of samples.
    fn sample_at(&self, time: f64) -> Option<usize> {
        if time < self.start_time {
            return None;
        }
        // A division may be off by one either way. A time long after a short record has no number among the integers.
        let end = self.acceleration.len();
        let mut i = (((time - self.start_time) / self.time_step) as usize).min(end);
        while i > 0 && self.sample_time(i) > time {
            i -= 1;
        }
        while i < end && self.sample_time(i + 1) <= time {
            i += 1;
        }
        Some(i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{ReadOptions, Unit, parse};

    fn record(text: &str, dt: f64) -> Record {
        let options =
            ReadOptions { unit: Some(Unit::MetrePerSecondSquared), time_step: Some(dt), ..ReadOptions::default() };
        parse("record", text.as_bytes(), &options).unwrap()
    }

    /// Whatever the order of samples, the inputs are those of the records, and no sample is stepped over.
    #[test]
    fn two_records_of_different_steps_are_followed() {
        let ground = Ground {
            horizontal: Some(record("0.0\n1.0\n-1.0\n0.5\n", 0.01)),
            vertical: Some(record("0.2\n0.4\n0.1\n0.0\n0.3\n", 0.004)),
        };
        let (mut time, mut stops) = (0.0, Vec::new());
        while time < ground.end().unwrap() {
            let (inputs, until) = ground.inputs_from(time);
            for t in [time, 0.5 * (time + until)] {
                let inputs = inputs.moved_to(t);
                // From its last sample on, where `at` still gives that sample, a record is zero.
                let exact = [&ground.horizontal, &ground.vertical].map(|record| {
                    let record = record.as_ref().unwrap();
                    if t < record.duration() { record.at(t) } else { 0.0 }
                });
                assert!((inputs.a_gx.value - exact[0]).abs() < 1e-12);
                assert!((inputs.a_gz.value - exact[1]).abs() < 1e-12);
            }
            stops.push(until);
            time = until;
        }
        let expected = [0.004, 0.008, 0.01, 0.012, 0.016, 0.02, 0.03];
        assert_eq!(stops.len(), expected.len());
        assert!(stops.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{stops:?}");
    }

    /// A time may be more samples after a record than there are integers; all is zero there.
    #[test]
    fn long_after_a_record_nothing_acts() {
        for (start, dt, time) in [(0.0, 1e-300, 1.0), (-1e308, 0.01, 1e308), (1.0, 1e-20, 1.0), (0.0, 1e308, f64::MAX)]
        {
            let record = Record { start_time: start, ..record("1.0\n2.0\n3.0\n", dt) };
            let ground = Ground { horizontal: Some(record), vertical: None };
            let inputs = Inputs { time, ..Inputs::default() };
            let after = time > ground.end().unwrap();
            assert_eq!(ground.inputs_from(time) == (inputs, f64::INFINITY), after || dt == 1e-20, "{start} {dt}");
            let (piece, until) = ground.piece_at(time);
            assert!(piece.time <= time && time < until, "{start} {dt}: {piece:?} until {until}");
        }
    }
}
