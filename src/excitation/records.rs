//! Records → inputs that are linear in time between their samples.

use serde::{Deserialize, Serialize};

use crate::excitation::{Inputs, Ramp};
use crate::numerics::gradient::DirectionalDual;
use crate::numerics::scalar::Elementary;
use rocking_records::Record;

/// Ground motion from records, linear between samples and zero outside. Each has its own time step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// Horizontal ground acceleration (m/s²), positive to the right.
    pub horizontal: Option<Record>,
    /// Vertical ground acceleration (m/s²), positive up.
    pub vertical: Option<Record>,
}

/// The ground motion between two samples.
#[derive(Clone, Copy, Debug)]
pub struct RecordInterval {
    /// The inputs, linear in time.
    pub inputs: Inputs,
    /// Time of the next sample of any record (s).
    pub end: f64,
    /// Indices of the last samples of both records; those of the next piece are near.
    samples: [usize; 2],
}

impl Ground {
    fn records(&self) -> impl Iterator<Item = &Record> {
        self.horizontal.iter().chain(&self.vertical)
    }

    /// Whether there is no record.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.horizontal.is_none() && self.vertical.is_none()
    }

    /// Returns the time of the first sample (s); 0 without a record.
    pub fn start(&self) -> f64 {
        self.records().map(|record| record.start_time).reduce(f64::min).unwrap_or(0.0)
    }

    /// Returns the time of the last sample (s), if there is a record.
    pub fn end(&self) -> Option<f64> {
        self.records().map(|record| record.start_time + record.duration()).reduce(f64::max)
    }

    /// Returns the smallest time step of the records (s), if there is one.
    pub fn time_step(&self) -> Option<f64> {
        self.records().map(|record| record.time_step).reduce(f64::min)
    }

    /// Returns both records multiplied by a factor.
    pub fn scaled(self, factor: f64) -> Ground {
        let scaled = |record: Option<Record>| record.map(|record| record.scaled(factor));
        Ground { horizontal: scaled(self.horizontal), vertical: scaled(self.vertical) }
    }

    /// Returns both records, delayed by `time` (s).
    pub fn shifted(self, time: f64) -> Ground {
        let shifted =
            |record: Option<Record>| record.map(|record| Record { start_time: record.start_time + time, ..record });
        Ground { horizontal: shifted(self.horizontal), vertical: shifted(self.vertical) }
    }

    /// Whether both records are valid.
    pub fn is_valid(&self) -> bool {
        self.records().all(Record::is_valid)
    }

    /// Describes both records in one line, see [`fingerprint`].
    pub fn fingerprint(&self) -> String {
        let text = |record: &Option<Record>| record.as_ref().map_or("none".into(), fingerprint);
        format!("horizontal {}; vertical {}", text(&self.horizontal), text(&self.vertical))
    }

    /// Returns the piece around `time` (s). The reference time of its inputs is that of the last sample of any record.
    pub fn piece_at(&self, time: f64) -> RecordInterval {
        let last = |record: &Record| match record.sample_at(time) {
            Some(i) if i + 1 < record.acceleration.len() => record.sample_time(i),
            Some(_) => record.start_time + record.duration(),
            None => f64::NEG_INFINITY,
        };
        let beginning = self.records().map(last).reduce(f64::max).filter(|beginning| beginning.is_finite());
        self.piece_from(beginning.unwrap_or(time))
    }

    /// Returns the inputs from `time` (s) to any record's next sample, and its time (s).
    pub fn inputs_from(&self, time: f64) -> (Inputs, f64) {
        let RecordInterval { inputs, end, .. } = self.piece_from(time);
        (inputs, end)
    }

    /// Returns the piece from `time` (s) to the next sample of any record. `time` is the reference time of its inputs.
    pub fn piece_from(&self, time: f64) -> RecordInterval {
        let guess = |record: &Option<Record>| record.as_ref().map_or(0, |record| record.guess(time));
        let samples = [guess(&self.horizontal), guess(&self.vertical)];
        let mut piece = RecordInterval { inputs: Inputs::default(), end: f64::INFINITY, samples };
        self.find_piece(time, &mut piece);
        piece
    }

    /// Makes `piece` the one that begins where it ends.
    #[inline]
    pub fn next_interval(&self, piece: &mut RecordInterval) {
        self.find_piece(piece.end, piece);
    }

    /// Makes `piece` the one from `time` (s) on. The search for the samples before `time` begins at those of `piece`.
    #[inline(always)]
    fn find_piece(&self, time: f64, piece: &mut RecordInterval) {
        // Number by number: a copy of all at once would wait until the processor has stored them.
        let RecordInterval { inputs: Inputs { time: start, a_gx, a_gz, .. }, end, samples: [horizontal, vertical] } =
            piece;
        (*start, *end) = (time, f64::INFINITY);
        for (record, near, place) in [(&self.horizontal, horizontal, a_gx), (&self.vertical, vertical, a_gz)] {
            if let Some(record) = record {
                let (ramp, end_of_ramp) = ramp_from(record, time, near);
                *place = ramp;
                *end = if end_of_ramp < *end { end_of_ramp } else { *end };
            }
        }
    }
}

/// Describes a record in a line that no other one has, independent of its path.
pub fn fingerprint(record: &Record) -> String {
    let Record { acceleration, time_step, start_time, processing, .. } = record;
    let processing = if processing.is_none() { String::new() } else { format!("; {processing}") };
    format!("{} samples, every {time_step} s from {start_time} s, {}{processing}", acceleration.len(), checksum(record))
}

/// Returns the checksum of the samples, such as `crc32 0123abcd`.
pub fn checksum(record: &Record) -> String {
    let mut hasher = crc32fast::Hasher::new();
    record.acceleration.iter().for_each(|a| hasher.update(&a.to_le_bytes()));
    format!("crc32 {:08x}", hasher.finalize())
}

/// Returns the line of a record from `time` (s) on, and its end (s).
///
/// `near` is the index of [`Record::sample_near`] and receives the index found.
#[inline]
pub(crate) fn ramp_from(record: &Record, time: f64, near: &mut usize) -> (Ramp, f64) {
    let Some(i) = record.sample_near(time, *near) else { return (Ramp::default(), record.start_time) };
    *near = i;
    match (record.acceleration.get(i), record.acceleration.get(i + 1)) {
        (Some(a), Some(b)) => (line(*a, *b, record.time_step, time - record.sample_time(i)), record.sample_time(i + 1)),
        _ => (Ramp::default(), f64::INFINITY),
    }
}

/// Returns the line from sample `a` to the next one. Its reference time is `elapsed` after `a`.
fn line<T: Elementary>(a: T, b: T, step: T, elapsed: T) -> Ramp<T> {
    let rate = (b - a) / step;
    Ramp { value: a + rate * elapsed, rate }
}

/// A record with derivatives of its samples and its time axis in a direction.
pub struct VariedRecord<'a, F> {
    /// The record.
    pub record: &'a Record,
    /// Returns the derivative of the sample with this index (m/s²).
    pub sample: F,
    /// Derivative of the time of the first sample (s).
    pub start_time: f64,
    /// Derivative of the time between two samples (s).
    pub time_step: f64,
}

impl<F: Fn(usize) -> f64> VariedRecord<'_, F> {
    /// Returns the acceleration at `time` (s), as in [`Ground::piece_at`], with its derivative.
    pub fn at(&self, time: DirectionalDual) -> DirectionalDual {
        let VariedRecord { record, .. } = self;
        let zero = DirectionalDual::from(0.0);
        let Some(i) = record.sample_at(time.re) else { return zero };
        if i + 1 >= record.acceleration.len() {
            return zero;
        }
        let [a, b] = [i, i + 1].map(|i| DirectionalDual::new(record.acceleration[i], [(self.sample)(i)]));
        let step = DirectionalDual::new(record.time_step, [self.time_step]);
        let start = DirectionalDual::new(record.start_time, [self.start_time]);
        line(a, b, step, time - (start + step * i as f64)).value
    }

    /// Returns the derivative of the peak ground acceleration (m/s²). It is that of the sample of largest magnitude.
    ///
    /// Of equal samples, the one whose magnitude grows most counts.
    pub fn peak(&self) -> f64 {
        let peak = self.record.peak().acceleration.abs();
        let samples = self.record.acceleration.iter().enumerate().filter(|(_, a)| a.abs() == peak);
        let grows = samples.map(|(i, &a)| match (self.sample)(i) {
            rate if a == 0.0 => rate.abs(),
            rate => rate * a.signum(),
        });
        grows.reduce(f64::max).unwrap_or(0.0)
    }

    /// Returns the derivative of the time of the last sample (s).
    pub fn end(&self) -> f64 {
        self.start_time + self.time_step * self.record.acceleration.len().saturating_sub(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_records::{ReadOptions, Unit, parse};

    fn record(text: &str, dt: f64) -> Record {
        let options =
            ReadOptions { unit: Some(Unit::MetrePerSecondSquared), time_step: Some(dt), ..ReadOptions::default() };
        parse("record", text.as_bytes(), &options).unwrap()
    }

    /// The inputs equal the records for any order of samples, and no sample is skipped.
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

    /// The number of samples up to such a time does not fit into an integer.
    #[test]
    fn long_after_a_record_nothing_acts() {
        for (start, dt, time) in [(0.0, 1e-300, 1.0), (-1e308, 0.01, 1e308), (1.0, 1e-20, 1.0), (0.0, 1e308, f64::MAX)]
        {
            let record = Record { start_time: start, ..record("1.0\n2.0\n3.0\n", dt) };
            let ground = Ground { horizontal: Some(record), vertical: None };
            let inputs = Inputs { time, ..Inputs::default() };
            let after = time > ground.end().unwrap();
            assert_eq!(ground.inputs_from(time) == (inputs, f64::INFINITY), after || dt == 1e-20, "{start} {dt}");
            let piece = ground.piece_at(time);
            assert!(piece.inputs.time <= time && time < piece.end, "{start} {dt}: {piece:?}");
        }
    }
}
