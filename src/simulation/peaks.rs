//! Observations and their rates at the ends of a step → peaks since the start, also inside the step.

use serde::{Deserialize, Serialize};

use crate::block::{Body, Corner, Foundation, restraints};
use crate::numerics::dual::Dual;
use crate::numerics::roots::{self, may_rise_inside, rate_of_peak};
use crate::numerics::scalar::{CombinesWith, Real, Runs, Scalar, greatest};
use crate::simulation::outputs::Channels;
use crate::system::evaluation::Evaluation;
use crate::system::events::{landing, lift_off};

/// Greatest absolute values since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peaks<T = f64> {
    /// Of the rotation θ (rad).
    pub theta: T,
    /// Of the reactions N_L and N_R (N).
    pub reaction: T,
    /// Of the horizontal reaction H (N).
    pub horizontal: T,
    /// Of the heights of the corners above their supports (m).
    pub uplift: T,
    /// Of the friction demand (1).
    pub friction_demand: T,
    /// Of the displacement of the foot from the start (m).
    pub slip: T,
    /// Of the pulls of the restraints, or of their pushes (N), by their numbers.
    pub pull: [T; restraints::MAX],
    /// Of their plastic elongations (m).
    pub plastic: [T; restraints::MAX],
    /// Of the elongations (m) of those that push, too, while they act: their strokes. Of the others, of the shortenings.
    pub elongation: [T; restraints::MAX],
}

/// A quantity whose greatest absolute value is a peak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Rotation θ (rad).
    Theta,
    /// Vertical reactions N_L, N_R (N).
    Reaction,
    /// Horizontal reaction H (N).
    Horizontal,
    /// Heights of the corners above their supports (m).
    Uplift,
    /// Friction demand (1).
    FrictionDemand,
}

impl<R: Scalar> Channels<Dual<R>> {
    /// All values that may be a peak; signed quantities in both directions.
    #[inline(always)]
    pub fn candidates(&self) -> [(Channel, Dual<R>); 9] {
        let Channels { theta, reaction, horizontal, uplift, friction_demand } = *self;
        [
            (Channel::Theta, theta),
            (Channel::Theta, -theta),
            (Channel::Reaction, reaction[0]),
            (Channel::Reaction, reaction[1]),
            (Channel::Horizontal, horizontal),
            (Channel::Horizontal, -horizontal),
            (Channel::Uplift, uplift[0]),
            (Channel::Uplift, uplift[1]),
            (Channel::FrictionDemand, friction_demand),
        ]
    }
}

/// Repeats a body for each of the [`Channels::candidates`]. No branch at run time decides between them.
macro_rules! each_candidate {
    (|$i:ident| $body:expr) => {
        each_candidate!(@ $i $body; 0 1 2 3 4 5 6 7 8)
    };
    (@ $i:ident $body:expr; $($place:literal)*) => {
        $({
            let $i = $place;
            $body
        })*
    };
}

impl<T: Real> Peaks<T> {
    /// The peaks of the channels, in their order; those of slip and restraints are zero.
    #[inline(always)]
    pub fn of_channels([theta, reaction, horizontal, uplift, friction_demand]: [T; 5]) -> Peaks<T> {
        let zero = T::from(0.0);
        let [pull, plastic, elongation] = [[zero; restraints::MAX]; 3];
        Peaks { theta, reaction, horizontal, uplift, friction_demand, slip: zero, pull, plastic, elongation }
    }

    /// The peak of a channel.
    #[inline(always)]
    pub fn of(&self, channel: Channel) -> T {
        match channel {
            Channel::Theta => self.theta,
            Channel::Reaction => self.reaction,
            Channel::Horizontal => self.horizontal,
            Channel::Uplift => self.uplift,
            Channel::FrictionDemand => self.friction_demand,
        }
    }

    #[inline(always)]
    fn raise(&mut self, channel: Channel, value: T) {
        let peak = match channel {
            Channel::Theta => &mut self.theta,
            Channel::Reaction => &mut self.reaction,
            Channel::Horizontal => &mut self.horizontal,
            Channel::Uplift => &mut self.uplift,
            Channel::FrictionDemand => &mut self.friction_demand,
        };
        *peak = greatest(*peak, value);
    }

    /// Includes the values at one instant.
    #[inline(always)]
    pub fn include(&mut self, channels: &Channels<Dual<T>>) {
        each_candidate!(|i| {
            let (channel, sample) = channels.candidates()[i];
            self.raise(channel, sample.re);
        });
    }

    /// Includes the values at both ends of a step.
    #[inline(always)]
    pub fn include_ends(&mut self, start: &Channels<Dual<T>>, end: &Channels<Dual<T>>) {
        each_candidate!(|i| {
            let ((channel, start), (_, end)) = (start.candidates()[i], end.candidates()[i]);
            self.raise(channel, greatest(start.re, end.re));
        });
    }

    /// Whether a value may exceed its peak and both ends between two instants, in each run.
    #[inline(always)]
    pub fn may_rise_inside(&self, start: &Channels<Dual<T>>, end: &Channels<Dual<T>>, duration: T) -> T::Runs {
        let mut may = duration.less(duration);
        each_candidate!(|i| {
            let ((channel, start), (_, end)) = (start.candidates()[i], end.candidates()[i]);
            may = may.or(may_rise_inside(self.of(channel), start, end, duration));
        });
        may
    }

    /// Whether the rates of H, the friction demand, and on the rigid base the reactions are needed, in each run. One of these reaches
    /// `near` over its peak.
    #[inline(always)]
    pub fn are_near(&self, now: &Evaluation<T>, near: T) -> T::Runs {
        let mass = now.body.mass;
        let [left, right] = now.instant.reaction;
        let shear = mass * now.instant.horizontal.abs();
        let close =
            (near * self.horizontal).less(shear).or((near * self.friction_demand * mass * (left + right)).less(shear));
        match now.body.foundation {
            Foundation::Rigid => close.or((near * self.reaction).less(mass * greatest(left, right))),
            Foundation::Viscoelastic => close,
        }
    }
}

impl Peaks {
    /// Whether all are finite and none is negative.
    pub fn is_valid(&self) -> bool {
        let Peaks { theta, reaction, horizontal, uplift, friction_demand, slip, pull, plastic, elongation } = *self;
        let channels = [theta, reaction, horizontal, uplift, friction_demand, slip];
        channels.into_iter().chain(pull).chain(plastic).chain(elongation).all(|peak| peak >= 0.0 && peak.is_finite())
    }

    /// Includes a rotation (rad) about a corner of the rigid base.
    #[inline]
    pub fn include_rotation(&mut self, theta: f64, body: &Body) {
        if theta > self.theta {
            self.theta = theta;
            self.uplift = greater(self.uplift, libm::sin(theta) * (2.0 * body.b));
        }
    }

    /// Includes the pulls and the elongations of the restraints at one instant.
    pub fn include_restraints(&mut self, now: &Evaluation) {
        for number in now.body.restraints.numbers() {
            self.include_pull(now.body, number, now.pull(number).re.abs());
            let stroke = now.stroke(number).re;
            let stroke = if now.body.restraints.pushes(number) { stroke.abs() } else { stroke };
            self.elongation[number] = greater(self.elongation[number], stroke);
        }
        self.include_plastic(&now.plastic_elongations());
    }

    /// Includes plastic elongations (m). They have no peak inside a step: yielding ends at an event, where they turn.
    pub fn include_plastic(&mut self, elongations: &[f64; restraints::MAX]) {
        for (peak, plastic) in self.plastic.iter_mut().zip(elongations) {
            *peak = greater(*peak, plastic.abs());
        }
    }

    /// Includes the pulls and strokes of a step between two instants; `inside` gives an instant between them.
    pub fn include_pulls_of_step<'a>(
        &mut self,
        here: &Evaluation,
        there: &Evaluation,
        mut inside: impl FnMut(f64) -> Evaluation<'a>,
    ) {
        for number in here.body.restraints.numbers() {
            let [start, end] = [here, there].map(|now| now.pull(number));
            let duration = there.time - here.time;
            let mut pull = |elapsed: f64| inside(elapsed).pull(number);
            let most = roots::greatest(self.pull[number], start, end, duration, &mut pull);
            self.include_pull(here.body, number, most);
            let mut signs: &[f64] = &[1.0];
            if here.body.restraints.pushes(number) {
                let [start, end] = [-start, -end];
                let mut pushed = |elapsed: f64| -inside(elapsed).pull(number);
                let most = roots::greatest(self.pull[number], start, end, duration, &mut pushed);
                self.include_pull(here.body, number, most);
                signs = &[1.0, -1.0];
            }
            for &sign in signs {
                let [start, end] = [here, there].map(|now| now.stroke(number) * sign);
                let mut stroke = |elapsed: f64| inside(elapsed).stroke(number) * sign;
                let peak = &mut self.elongation[number];
                *peak = greater(*peak, roots::greatest(*peak, start, end, duration, &mut stroke));
            }
        }
    }

    /// Includes a pull (N). An impact may leave a dashpot with more than the strength, at which the restraint breaks.
    fn include_pull(&mut self, body: &Body, number: usize, pull: f64) {
        let pull = restraints::strength(body, number).map_or(pull, |strength| pull.min(strength));
        self.pull[number] = greater(self.pull[number], pull);
    }

    /// Includes a step of `duration` between two instants. `inside` gives a candidate of a channel at a time after the first one and is
    /// called only if a peak may be inside.
    #[inline(always)]
    pub fn include_step(
        &mut self,
        start: &Channels,
        end: &Channels,
        duration: f64,
        inside: &mut dyn FnMut(Channel, usize, f64) -> Dual,
    ) {
        each_candidate!(|i| {
            let ((channel, start), (_, end)) = (start.candidates()[i], end.candidates()[i]);
            let most = self.of(channel);
            if start.re > most || end.re > most || may_rise_inside(most, start, end, duration) {
                let most = roots::greatest(most, start, end, duration, &mut |elapsed| inside(channel, i, elapsed));
                self.raise(channel, most);
            }
        });
    }

    /// The channels at both ends of a step. Rates that take dual numbers are formed only where they [are needed](Peaks::are_near), and
    /// are zero elsewhere.
    #[inline(always)]
    pub fn channels_at_ends(&self, here: &Evaluation, there: &Evaluation, near: f64) -> [Channels; 2] {
        if self.are_near(here, near) || self.are_near(there, near) {
            [here.channels_outlined(), there.channels_outlined()]
        } else {
            [here.cheap_channels(), there.cheap_channels()]
        }
    }

    /// The [`rate_of_peak`] of a channel.
    pub fn rate(&self, channel: Channel, now: &Channels) -> f64 {
        let of_it = now.candidates().into_iter().filter(|&(of, _)| of == channel).map(|(_, sample)| sample);
        of_it.fold(0.0, |rate, sample| greater(rate, rate_of_peak(self.of(channel), sample)))
    }
}

impl Channels {
    /// The derivatives of the peaks of a motion that begins with these values. Their rates are derivatives in a direction. If several
    /// values are greatest, or all are zero, the one that grows most counts.
    pub fn peak_sensitivity(&self) -> Peaks {
        // Both reactions of a block at rest are the same number up to rounding.
        const SAME: f64 = 1.0 - 1e-13;
        let along = |channel: Channel| {
            let zero = Dual::default();
            let of_it = || self.candidates().into_iter().filter(|&(of, _)| of == channel).map(|(_, sample)| sample);
            let greatest = of_it().fold(0.0, |most, sample| greater(most, sample.re));
            let at_it = of_it().chain([zero]).filter(|sample| sample.re >= SAME * greatest);
            at_it.map(|sample| sample.eps).reduce(greater).unwrap_or(0.0)
        };
        Peaks {
            theta: along(Channel::Theta),
            reaction: along(Channel::Reaction),
            horizontal: along(Channel::Horizontal),
            uplift: along(Channel::Uplift),
            friction_demand: along(Channel::FrictionDemand),
            ..Peaks::default()
        }
    }
}

/// The greater value; of 0 and −0 the first one. `f64::max` may return either, depending on processor and compiler.
pub fn greater(first: f64, second: f64) -> f64 {
    if second > first { second } else { first }
}

impl<R: Scalar> Evaluation<'_, R>
where
    Dual<R>: CombinesWith<R>,
{
    /// The quantities whose greatest values are peaks, with all rates.
    #[inline(always)]
    pub fn channels(&self) -> Channels<Dual<R>> {
        Channels::of(self.body, self.regime, &self.with_rates(self.forcing_rate()), self.support_heights)
    }

    /// The channels without rates that need dual numbers.
    ///
    /// Zeros stand for H and the friction demand, and on the rigid base for the rates of the reactions.
    #[inline(always)]
    pub fn cheap_channels(&self) -> Channels<Dual<R>> {
        Channels {
            theta: Dual::new(self.instant.theta, self.instant.theta_dot),
            reaction: [self.reaction(Corner::Left), self.reaction(Corner::Right)],
            horizontal: Dual::default(),
            uplift: [self.uplift(Corner::Left), self.uplift(Corner::Right)],
            friction_demand: Dual::default(),
        }
    }

    #[inline(always)]
    fn reaction(&self, corner: Corner) -> Dual<R> {
        if !self.regime.touches(corner) {
            return Dual::default();
        }
        lift_off::on_support(self.body, &self.instant, corner) * self.body.mass
    }

    #[inline(always)]
    fn uplift(&self, corner: Corner) -> Dual<R> {
        if self.regime.touches(corner) {
            return Dual::default();
        }
        landing::gap(&self.instant, self.support_heights, corner)
    }
}

impl Evaluation<'_> {
    /// [`Evaluation::channels`] without inlining.
    #[inline(never)]
    pub fn channels_outlined(&self) -> Channels {
        self.channels()
    }
}
