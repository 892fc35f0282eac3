//! Inputs over a step, records and pulses in three directions → the forcing at any time of a smooth piece.

use nalgebra::Vector3;
use rocking_records::Record;
use serde::{Deserialize, Serialize};

use crate::excitation::records::ramp_from;
use crate::excitation::{Pulse, Ramp, Wave};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::CombinesWith;
use crate::space::motion::Component;

/// The inputs from a reference time on, each linear in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpaceInputs {
    /// Reference time of the ramps (s).
    pub time: f64,
    /// Ground acceleration (m/s²): to the right, away from the viewer, up.
    pub ground: [Ramp; 3],
    /// Load on the centre of mass (N).
    pub force: [Ramp; 3],
    /// Moment on the block about its centre of mass (N.m).
    pub moment: [Ramp; 3],
}

impl SpaceInputs {
    /// Returns the inputs with another reference time.
    pub fn moved_to(&self, time: f64) -> SpaceInputs {
        let moved = |ramps: [Ramp; 3]| ramps.map(|ramp| ramp.moved(time - self.time));
        SpaceInputs { time, ground: moved(self.ground), force: moved(self.force), moment: moved(self.moment) }
    }

    fn with(&self, others: &SpaceInputs, act: impl Fn(Ramp, Ramp) -> Ramp) -> SpaceInputs {
        let pairs = |a: &[Ramp; 3], b: &[Ramp; 3]| std::array::from_fn(|i| act(a[i], b[i]));
        SpaceInputs {
            time: self.time,
            ground: pairs(&self.ground, &others.ground),
            force: pairs(&self.force, &others.force),
            moment: pairs(&self.moment, &others.moment),
        }
    }

    /// Returns the sum of both, with the reference time of `self`.
    pub fn plus(&self, others: &SpaceInputs) -> SpaceInputs {
        let sum = |a: Ramp, b: Ramp| Ramp { value: a.value + b.value, rate: a.rate + b.rate };
        self.with(&others.moved_to(self.time), sum)
    }

    /// Returns the inputs held constant at their values at the reference time.
    pub fn held(&self) -> SpaceInputs {
        self.with(self, |ramp, _| Ramp::held(ramp.value))
    }

    /// Returns the line from these values to those of `end`, each at its reference time.
    pub fn line_to(&self, end: &SpaceInputs) -> SpaceInputs {
        let duration = end.time - self.time;
        self.with(end, |a, b| Ramp { value: a.value, rate: (b.value - a.value) / duration })
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let ramps = self.ground.iter().chain(&self.force).chain(&self.moment);
        self.time.is_finite() && ramps.flat_map(|ramp| [ramp.value, ramp.rate]).all(f64::is_finite)
    }
}

/// Greatest number of pulses.
pub const MAX_PULSES: usize = 3;

/// A pulse in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectedPulse {
    /// The pulse.
    pub pulse: Pulse,
    /// Its direction, a unit vector.
    pub direction: [f64; 3],
}

impl DirectedPulse {
    /// No pulse.
    pub const NONE: DirectedPulse = DirectedPulse { pulse: Pulse::NONE, direction: [1.0, 0.0, 0.0] };

    /// Returns a horizontal pulse with an azimuth (rad) from +x towards +y.
    pub fn horizontal(pulse: Pulse, azimuth: f64) -> DirectedPulse {
        let (sin, cos) = libm::sincos(azimuth);
        DirectedPulse { pulse, direction: [cos, sin, 0.0] }
    }
}

/// The pulses of a run, which act together.
pub type DirectedPulses = [DirectedPulse; MAX_PULSES];

/// Returns the pulses that move the ground at some time.
fn acting(pulses: &DirectedPulses) -> impl Iterator<Item = &DirectedPulse> {
    pulses.iter().filter(|directed| !directed.pulse.is_none())
}

/// Returns the first beginning or end of a pulse later than `time` (s).
pub fn next_kink(pulses: &DirectedPulses, time: f64) -> Option<f64> {
    acting(pulses).filter_map(|directed| directed.pulse.next_kink(time)).reduce(f64::min)
}

/// Forcing at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceForcing<T> {
    /// `a_g − F/M` (m/s²).
    pub acceleration: Vector3<T>,
    /// Moment (N.m).
    pub moment: Vector3<T>,
}

impl SpaceForcing<Dual> {
    /// Returns a forcing that also changes in a direction of the values of inputs, with a body of this mass (kg).
    pub fn moved(mut self, inputs: &SpaceInputs, mass: f64) -> SpaceForcing<Dual> {
        for i in 0..3 {
            self.acceleration[i].eps += inputs.ground[i].value - inputs.force[i].value / mass;
            self.moment[i].eps += inputs.moment[i].value;
        }
        self
    }
}

/// A vector linear in time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    value: Vector3<f64>,
    rate: Vector3<f64>,
}

impl Line {
    fn of(ramps: &[Ramp; 3]) -> Line {
        Line { value: ramps.map(|ramp| ramp.value).into(), rate: ramps.map(|ramp| ramp.rate).into() }
    }

    #[inline(always)]
    fn at<T: Component>(&self, elapsed: T) -> Vector3<T> {
        self.value.zip_map(&self.rate, |value, rate| elapsed * rate + value)
    }
}

/// The excitation over a smooth piece of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceExcitation {
    time: f64,
    acceleration: Line,
    moment: Line,
    waves: [(Option<Wave>, [f64; 3]); MAX_PULSES],
    frequency: f64,
}

impl SpaceExcitation {
    /// Returns the excitation of a block of this mass (kg) from `time` (s) to the next kink of a pulse.
    pub fn new(time: f64, inputs: &SpaceInputs, pulses: &DirectedPulses, mass: f64) -> SpaceExcitation {
        let mut acceleration = inputs.ground;
        for (ramp, force) in acceleration.iter_mut().zip(inputs.force) {
            *ramp = ramp.minus(force, mass);
        }
        let mut waves = [(None, [0.0; 3]); MAX_PULSES];
        let mut frequency: f64 = 0.0;
        for (wave, DirectedPulse { pulse, direction }) in waves.iter_mut().zip(acting(pulses)) {
            if !pulse.acts_at(time) {
                continue;
            }
            *wave = (pulse.wave(), *direction);
            frequency = frequency.max(pulse.wave().map_or(0.0, |wave| wave.frequency()));
            for (ramp, component) in acceleration.iter_mut().zip(direction) {
                ramp.value += pulse.constant().unwrap_or(0.0) * component;
            }
        }
        let [acceleration, moment] = [acceleration, inputs.moment].map(|ramps| Line::of(&ramps));
        SpaceExcitation { time: inputs.time, acceleration, moment, waves, frequency }
    }

    /// Returns the forcing at `time` (s).
    #[inline(always)]
    pub fn at<T: Component + CombinesWith<f64>>(&self, time: T) -> SpaceForcing<T> {
        let elapsed = time - self.time;
        let mut acceleration = self.acceleration.at(elapsed);
        for (wave, direction) in &self.waves {
            if let Some(wave) = wave {
                let wave = wave.acceleration(time);
                acceleration += Vector3::from(direction.map(|component| wave * component));
            }
        }
        SpaceForcing { acceleration, moment: self.moment.at(elapsed) }
    }

    /// Whether the excitation is constant.
    pub fn is_constant(&self) -> bool {
        let no_waves = self.waves.iter().all(|(wave, _)| wave.is_none());
        no_waves && [self.acceleration, self.moment].iter().all(|line| line.rate == Vector3::zeros())
    }

    /// Returns the greatest circular frequency of the acting pulses (rad/s).
    pub fn frequency(&self) -> f64 {
        self.frequency
    }
}

/// Ground motion from records, linear between samples and zero outside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpaceGround {
    /// The records: both horizontal components and the vertical one.
    pub records: [Option<Record>; 3],
    /// Direction of the first component (rad), from +x towards +y. The second one is a quarter turn ahead.
    pub azimuth: f64,
}

impl SpaceGround {
    /// Refuses components of one motion with other steps or lengths.
    ///
    /// # Errors
    /// Two components that differ, by their names.
    pub fn checked(self) -> Result<SpaceGround, String> {
        const NAMES: [&str; 3] = ["record.x", "record.y", "record.z"];
        let given = || self.records.iter().zip(NAMES).filter_map(|(record, name)| Some((record.as_ref()?, name)));
        let Some((first, first_name)) = given().next() else { return Ok(self) };
        for (record, name) in given() {
            for (what, expected, found) in
                [("time step", first.time_step, record.time_step), ("start", first.start_time, record.start_time)]
            {
                if found != expected {
                    return Err(format!(
                        "{name} has a {what} of {found} s; expected that of {first_name}, {expected} s"
                    ));
                }
            }
            let [expected, found] = [first, record].map(|record| record.acceleration.len());
            if found != expected {
                return Err(format!("{name} has {found} samples; expected the {expected} samples of {first_name}"));
            }
        }
        if !self.azimuth.is_finite() {
            return Err(format!("azimuth = {} is not valid; expected a finite number", self.azimuth));
        }
        Ok(self)
    }

    /// Returns all records multiplied by a factor and delayed by `delay` (s).
    pub fn scaled_and_shifted(self, factor: f64, delay: f64) -> SpaceGround {
        let changed = |record: Record| Record { start_time: record.start_time + delay, ..record.scaled(factor) };
        SpaceGround { records: self.records.map(|record| record.map(changed)), ..self }
    }

    /// Returns the time of the last sample (s), if there is a record.
    pub fn end(&self) -> Option<f64> {
        self.records.iter().flatten().map(|record| record.start_time + record.duration()).reduce(f64::max)
    }

    /// Returns the inputs from `time` (s) to the next sample of any record, and its time (s).
    pub fn inputs_from(&self, time: f64) -> (SpaceInputs, f64) {
        let (mut ground, mut end) = ([Ramp::default(); 3], f64::INFINITY);
        for (record, ramp) in self.records.iter().zip(&mut ground) {
            if let Some(record) = record {
                let (found, until) = ramp_from(record, time, &mut record.guess(time));
                *ramp = found;
                end = end.min(until);
            }
        }
        if self.azimuth != 0.0 {
            let (sin, cos) = libm::sincos(self.azimuth);
            let turned = |[x, y]: [f64; 2]| [x * cos - y * sin, x * sin + y * cos];
            let [x, y, _] = ground;
            let [values, rates] = [turned([x.value, y.value]), turned([x.rate, y.rate])];
            (ground[0], ground[1]) =
                (Ramp { value: values[0], rate: rates[0] }, Ramp { value: values[1], rate: rates[1] });
        }
        (SpaceInputs { time, ground, ..SpaceInputs::default() }, end)
    }
}
