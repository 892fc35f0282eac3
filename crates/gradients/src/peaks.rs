//! The steps in which peaks rise for the last time → the derivatives of the peaks.

use rocking_block::block::restraints;
use rocking_block::excitation::Excitation;
use rocking_block::numerics::roots::sign_change;
use rocking_block::simulation::follow::Course;
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::peaks::{Channel, Peaks};
use rocking_block::system::instant::Pose;

use crate::{BATCH, Number};

/// The motion over a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// The block at its beginning.
    pub start: Pose<Number>,
    /// Derivatives of the time of the event at its beginning; zeros if there is none.
    pub start_shift: [f64; BATCH],
    pub excitation: Excitation<Number>,
    /// The way in which the run went along it.
    pub course: Course,
    /// Time at its end (s).
    pub end: f64,
    /// The same of the event at its end.
    pub end_shift: [f64; BATCH],
}

/// The observed quantities some time (s) after the beginning of a stretch, and the same with their rates along the motion added to their
/// derivatives.
pub(crate) type Within<'a> = dyn Fn(&Stretch, f64) -> [Observation<Number>; 2] + 'a;

/// A quantity that has a peak.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Channel(Channel),
    /// The pull of the restraint with this number.
    Pull(usize),
}

const CHANNELS: [Channel; 5] =
    [Channel::Theta, Channel::Reaction, Channel::Horizontal, Channel::Uplift, Channel::FrictionDemand];

/// For each peak the step in which it rose last.
#[derive(Clone, Debug)]
pub(crate) struct Raised {
    channels: [Option<Box<Stretch>>; CHANNELS.len()],
    pulls: [Option<Box<Stretch>>; restraints::MOST],
    /// Derivatives of the peak slip.
    slip: [f64; BATCH],
}

impl Raised {
    pub fn new() -> Raised {
        Raised { channels: Default::default(), pulls: Default::default(), slip: [0.0; BATCH] }
    }

    /// Takes in the beginning of a block with restraints of these numbers.
    pub fn begin(&mut self, start: &Stretch, restraints: impl Iterator<Item = usize>) {
        for place in &mut self.channels {
            *place = Some(Box::new(*start));
        }
        for number in restraints {
            self.pulls[number] = Some(Box::new(*start));
        }
    }

    /// Takes in a step from and to which the peaks have these values, and at whose end the foot has slipped by `slip`.
    pub fn take_in(&mut self, before: &Peaks, after: &Peaks, slip: Number, step: &Stretch) {
        let take_in = |place: &mut Option<Box<Stretch>>| match place {
            Some(last) => **last = *step,
            None => *place = Some(Box::new(*step)),
        };
        for (place, channel) in self.channels.iter_mut().zip(CHANNELS) {
            if after.of(channel) != before.of(channel) {
                take_in(place);
            }
        }
        for (number, place) in self.pulls.iter_mut().enumerate() {
            if after.pull[number] != before.pull[number] {
                take_in(place);
            }
        }
        if after.slip != before.slip {
            self.slip = slip.eps.map(|eps| slip.re.signum() * eps);
        }
    }

    /// The peaks of a run with these values.
    pub fn peaks(&self, peaks: &Peaks, within: &Within) -> Peaks<Number> {
        let of = |quantity: Quantity, value: f64, stretch: &Option<Box<Stretch>>| {
            let eps = stretch.as_deref().map_or([0.0; BATCH], |stretch| derivatives(within, stretch, quantity, value));
            Number::new(value, eps)
        };
        let channel = |i: usize| of(Quantity::Channel(CHANNELS[i]), peaks.of(CHANNELS[i]), &self.channels[i]);
        Peaks {
            theta: channel(0),
            reaction: channel(1),
            horizontal: channel(2),
            uplift: channel(3),
            friction_demand: channel(4),
            slip: Number::new(peaks.slip, self.slip),
            pull: std::array::from_fn(|i| of(Quantity::Pull(i), peaks.pull[i], &self.pulls[i])),
        }
    }
}

/// Derivatives of the peak of a quantity, which has reached this value in a step: at one of its ends, whose time may vary, or at a
/// maximum inside, where the rate is zero.
fn derivatives(within: &Within, stretch: &Stretch, quantity: Quantity, peak: f64) -> [f64; BATCH] {
    // Where the highest of these instants inside is between its neighbours there is a maximum.
    const PIECES: u32 = 8;
    let duration = stretch.end - stretch.start.time.re;
    let at = |elapsed: f64| samples(quantity, &within(stretch, elapsed));
    let ends = [(at(0.0), stretch.start_shift, -1.0), (at(duration), stretch.end_shift, 1.0)];
    // Of several values of a channel, those of both corners or directions, the greatest.
    let greatest = |samples: &[(Number, f64)]| {
        samples.iter().enumerate().max_by(|(_, a), (_, b)| a.0.re.total_cmp(&b.0.re)).map_or(0, |(i, _)| i)
    };
    const SAME: f64 = 1e-12;
    for (samples, shift, outwards) in &ends {
        let Some((value, rate)) = samples.get(greatest(samples)) else { continue };
        if value.re >= peak - SAME * peak.abs() && outwards * rate >= 0.0 {
            return std::array::from_fn(|i| value.eps[i] + rate * shift[i]);
        }
    }
    let times: Vec<f64> = (0..=PIECES).map(|i| duration * f64::from(i) / f64::from(PIECES)).collect();
    let highest = |time: &&f64| {
        let samples = at(**time);
        samples.get(greatest(&samples)).map_or(f64::NEG_INFINITY, |(value, _)| value.re)
    };
    let Some(&top) = times.iter().max_by(|a, b| highest(a).total_cmp(&highest(b))) else { return [f64::NAN; BATCH] };
    let which = greatest(&at(top));
    let rate = |time: f64| at(time)[which].1;
    let piece = duration / f64::from(PIECES);
    let (low, high) = if rate(top) >= 0.0 { (top, top + piece) } else { (top - piece, top) };
    let (low, high) = (low.max(0.0), high.min(duration));
    let time = sign_change(low, high, rate(low), rate(high), rate);
    at(time)[which].0.eps
}

/// The values of a quantity, whose greatest is its peak, with their rates.
fn samples(quantity: Quantity, [now, along]: &[Observation<Number>; 2]) -> Vec<(Number, f64)> {
    let values = |x: &Observation<Number>| match quantity {
        Quantity::Pull(number) => vec![x.pull[number]],
        Quantity::Channel(Channel::Theta) => vec![x.theta, -x.theta],
        Quantity::Channel(Channel::Reaction) => x.reaction.to_vec(),
        Quantity::Channel(Channel::Horizontal) => vec![x.horizontal, -x.horizontal],
        Quantity::Channel(Channel::Uplift) => x.uplift.to_vec(),
        Quantity::Channel(Channel::FrictionDemand) => vec![x.friction_demand],
    };
    let with_rate = |(value, along): (Number, Number)| (value, along.eps[0] - value.eps[0]);
    values(now).into_iter().zip(values(along)).map(with_rate).collect()
}
