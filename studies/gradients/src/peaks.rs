//! The steps in which peaks rise for the last time → the derivatives of the peaks.

use rocking_block::block::{Block, restraints};
use rocking_block::excitation::Excitation;
use rocking_block::numerics::roots::sign_change;
use rocking_block::simulation::follow::StepKind;
use rocking_block::simulation::outputs::{MAX_FRICTION_DEMAND, Observation};
use rocking_block::simulation::peaks::{Channel, Peaks};
use rocking_block::system::instant::Pose;

use crate::{BATCH, Number};

/// The motion over a step, from which it can be evaluated at any time inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    /// The block at its beginning.
    pub start: Pose<Number>,
    /// Derivatives of the time of the event at its beginning; zeros without an event.
    pub start_shift: [f64; BATCH],
    pub excitation: Excitation<Number>,
    /// Kind of the run's step.
    pub kind: StepKind,
    /// Time at its end (s).
    pub end: f64,
    /// Derivatives of the time of the event at its end; zeros without an event.
    pub end_shift: [f64; BATCH],
}

/// Returns the observed quantities at a time (s) of a segment, and a copy with rates. The time counts from the beginning of the segment.
/// The copy has the rates along the motion added to the derivatives.
pub(crate) type ObserveInside<'a> = dyn Fn(&Segment, f64) -> [Observation<Number>; 2] + 'a;

/// A quantity with a peak.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Channel(Channel),
    /// The pull or push of the restraint with this number.
    Pull(usize),
    /// Its plastic elongation.
    Plastic(usize),
    /// Its elongation to either side, of a damper.
    Stroke(usize),
    /// Its shortening, of a tie.
    Shortening(usize),
}

const CHANNELS: [Channel; 5] =
    [Channel::Theta, Channel::Reaction, Channel::Horizontal, Channel::Uplift, Channel::FrictionDemand];

/// The step in which each peak rose last.
#[derive(Clone, Debug)]
pub(crate) struct PeakSegments {
    channels: [Option<Box<Segment>>; CHANNELS.len()],
    pulls: [Option<Box<Segment>>; restraints::MAX],
    plastics: [Option<Box<Segment>>; restraints::MAX],
    elongations: [Option<Box<Segment>>; restraints::MAX],
    /// Derivatives of the peak slip.
    slip: [f64; BATCH],
}

impl PeakSegments {
    pub fn new() -> PeakSegments {
        PeakSegments {
            channels: Default::default(),
            pulls: Default::default(),
            plastics: Default::default(),
            elongations: Default::default(),
            slip: [0.0; BATCH],
        }
    }

    /// Records the start of a block with restraints of these numbers.
    pub fn begin(&mut self, start: &Segment, restraints: impl Iterator<Item = usize>) {
        for slot in &mut self.channels {
            *slot = Some(Box::new(*start));
        }
        for number in restraints {
            self.pulls[number] = Some(Box::new(*start));
            self.plastics[number] = Some(Box::new(*start));
            self.elongations[number] = Some(Box::new(*start));
        }
    }

    /// Records a step with the peaks before and after it. `slip` is the displacement of the foot at its end (m), and its rate before an
    /// event there (m/s).
    pub fn record(&mut self, before: &Peaks, after: &Peaks, slip: (Number, f64), step: &Segment) {
        let record = |slot: &mut Option<Box<Segment>>| match slot {
            Some(last) => **last = *step,
            None => *slot = Some(Box::new(*step)),
        };
        for (slot, channel) in self.channels.iter_mut().zip(CHANNELS) {
            if after.of(channel) != before.of(channel) {
                record(slot);
            }
        }
        for number in 0..restraints::MAX {
            if after.pull[number] != before.pull[number] {
                record(&mut self.pulls[number]);
            }
            if after.plastic[number] != before.plastic[number] {
                record(&mut self.plastics[number]);
            }
            if after.elongation[number] != before.elongation[number] {
                record(&mut self.elongations[number]);
            }
        }
        if after.slip != before.slip {
            self.record_slip(slip.0, slip.1, step.end_shift);
        }
    }

    /// Records a peak of the slip at an event whose time has these derivatives. Its value (m) and rate (m/s) are those of the event.
    pub fn record_slip(&mut self, slip: Number, rate: f64, shift: [f64; BATCH]) {
        self.slip = std::array::from_fn(|i| slip.re.signum() * (slip.eps[i] + rate * shift[i]));
    }

    /// Returns these peaks of a run of the block with their derivatives.
    pub fn peaks(&self, block: &Block<Number>, peaks: &Peaks, observe: &ObserveInside) -> Peaks<Number> {
        let peak = |quantity: Quantity, value: f64, segment: &Option<Box<Segment>>| {
            let eps = segment.as_deref().map_or([0.0; BATCH], |segment| derivatives(observe, segment, quantity));
            Number::new(value, eps)
        };
        let channel = |i: usize| peak(Quantity::Channel(CHANNELS[i]), peaks.of(CHANNELS[i]), &self.channels[i]);
        Peaks {
            theta: channel(0),
            reaction: channel(1),
            horizontal: channel(2),
            uplift: channel(3),
            // A limit of the numbers shown does not vary.
            friction_demand: match peaks.friction_demand < MAX_FRICTION_DEMAND {
                true => channel(4),
                false => Number::from(peaks.friction_demand),
            },
            slip: Number::new(peaks.slip, self.slip),
            pull: std::array::from_fn(|i| match restraints::strength(block, i) {
                // It has broken, perhaps at an impact, at which the pull jumps.
                Some(strength) if strength.re == peaks.pull[i] => strength,
                Some(_) | None => peak(Quantity::Pull(i), peaks.pull[i], &self.pulls[i]),
            }),
            plastic: std::array::from_fn(|i| peak(Quantity::Plastic(i), peaks.plastic[i], &self.plastics[i])),
            elongation: std::array::from_fn(|i| {
                let quantity = if block.restraints.pushes(i) { Quantity::Stroke(i) } else { Quantity::Shortening(i) };
                peak(quantity, peaks.elongation[i], &self.elongations[i])
            }),
        }
    }
}

/// Returns the derivatives of a peak at an end of a segment or inside it. The time of an end may vary; at a maximum the rate is zero.
fn derivatives(observe: &ObserveInside, segment: &Segment, quantity: Quantity) -> [f64; BATCH] {
    // The maximum is bracketed by the neighbours of the highest of these instants.
    const PIECES: u32 = 8;
    let duration = segment.end - segment.start.time.re;
    let at = |elapsed: f64| samples(quantity, &observe(segment, elapsed));
    // A channel has a value for each corner or direction; the greatest counts.
    let greatest = |samples: &[(Number, f64)]| {
        samples.iter().enumerate().max_by(|(_, a), (_, b)| a.0.re.total_cmp(&b.0.re)).map_or(0, |(i, _)| i)
    };
    let times: Vec<f64> = (0..=PIECES).map(|i| duration * f64::from(i) / f64::from(PIECES)).collect();
    let highest = |time: &&f64| {
        let samples = at(**time);
        samples.get(greatest(&samples)).map_or(f64::NEG_INFINITY, |(value, _)| value.re)
    };
    let Some(&top) = times.iter().max_by(|a, b| highest(a).total_cmp(&highest(b))) else { return [f64::NAN; BATCH] };
    let which = greatest(&at(top));
    let rate = |time: f64| at(time)[which].1;
    for (end, shift, outwards) in [(0.0, segment.start_shift, -1.0), (duration, segment.end_shift, 1.0)] {
        let (value, rate) = at(end)[which];
        if top == end && outwards * rate >= 0.0 {
            return std::array::from_fn(|i| value.eps[i] + rate * shift[i]);
        }
    }
    let piece = duration / f64::from(PIECES);
    let (low, high) = if rate(top) >= 0.0 { (top, top + piece) } else { (top - piece, top) };
    let (low, high) = (low.max(0.0), high.min(duration));
    let time = sign_change(low, high, rate(low), rate(high), rate);
    at(time)[which].0.eps
}

/// Returns the values of a quantity for each corner or direction, with their rates.
fn samples(quantity: Quantity, [now, along]: &[Observation<Number>; 2]) -> Vec<(Number, f64)> {
    let size = |x: Number| if x.re < 0.0 { -x } else { x };
    let values = |x: &Observation<Number>| match quantity {
        Quantity::Pull(number) => vec![size(x.restraints[number].pull)],
        Quantity::Plastic(number) => vec![size(x.restraints[number].plastic)],
        Quantity::Stroke(number) => vec![x.restraints[number].elongation, -x.restraints[number].elongation],
        Quantity::Shortening(number) => vec![-x.restraints[number].elongation],
        Quantity::Channel(Channel::Theta) => vec![x.theta, -x.theta],
        Quantity::Channel(Channel::Reaction) => x.reaction.to_vec(),
        Quantity::Channel(Channel::Horizontal) => vec![x.horizontal, -x.horizontal],
        Quantity::Channel(Channel::Uplift) => x.uplift.to_vec(),
        Quantity::Channel(Channel::FrictionDemand) => vec![x.friction_demand],
    };
    let with_rate = |(value, along): (Number, Number)| (value, along.eps[0] - value.eps[0]);
    values(now).into_iter().zip(values(along)).map(with_rate).collect()
}
