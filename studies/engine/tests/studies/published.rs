//! Published results, as numbers or in closed form; docs/unit/validation.md has the table.
//!
//! Most are for slender blocks, whose equations are linear while the block stands on one corner. With α = 0.005 rad the
//! linearization error is of the order of α² ≈ 3e-5.

use std::f64::consts::PI;

use rocking_block::block::{Block, Body, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::run::Run;
use rocking_studies::run::outcome::{End, Outcome};

const SLENDER: f64 = 0.005;
const G: f64 = 9.81;

/// A block on the rigid base with this ratio e of the angular velocities after and before an impact.
fn rigid(alpha: f64, p: f64, e: f64) -> Block {
    let of = |restitution_factor| {
        let given = Dimensionless { alpha, p, supports: Supports::Rigid { restitution_factor } };
        Block::from_dimensionless(&given, &Common::default()).unwrap()
    };
    of(e / of(1.0).restitution())
}

fn run(block: Block, pulse: Pulse, initial: Initial, duration: Option<f64>) -> Run {
    let settings = Settings { tolerance: 1e-11, on_separation: OnSeparation::Fly, ..Settings::default() };
    Run { block, settings, pulse, initial, ground: Ground::default(), duration, output_step: 0.01 }
}

fn one_sine(amplitude: f64, period: f64) -> Pulse {
    Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE }
}

/// Bisects to a relative 1e-9 between a value at which nothing happens and one at which it does.
fn threshold(mut not: f64, mut is: f64, happens: impl Fn(f64) -> bool) -> f64 {
    assert!(!happens(not) && happens(is), "{not} to {is} contains no threshold");
    while (is - not).abs() > 1e-9 * is {
        let middle = 0.5 * (not + is);
        if happens(middle) { is = middle } else { not = middle }
    }
    is
}

#[track_caller]
fn close(found: f64, printed: f64, relative: f64) {
    assert!((found / printed - 1.0).abs() <= relative, "found {found}, printed {printed}");
}

/// G. W. Housner, The behavior of inverted pendulum structures during earthquakes, Bull. Seism. Soc. Am. 53 (1963) 403–417:
/// restitution of a rectangle, quarter period, and amplitude after n impacts.
#[test]
fn housner_1963_free_rocking() {
    for alpha in [0.1_f64, 0.2, 0.4] {
        let block = rigid(alpha, 1.0, 1.0 - 1.5 * alpha.sin().powi(2));
        close(block.restitution(), 1.0 - 1.5 * alpha.sin().powi(2), 1e-14);
        close(block.max_restitution(), 1.0 - 1.5 * alpha.sin().powi(2), 1e-12);
    }
    let (p, e, start) = (2.0, 0.9_f64, 0.8);
    let initial = Initial { theta: start * SLENDER, ..Initial::default() };
    let mut run = run(rigid(SLENDER, p, e), Pulse::NONE, initial, Some(8.0));
    run.output_step = 1e-4;
    let history = run.history(|_| ()).unwrap();
    let impacts: Vec<f64> = history.events.iter().map(|event| event.time).collect();
    let quarter = |amplitude: f64| (1.0 / (1.0 - amplitude)).acosh() / p;
    let (mut amplitude, mut time) = (start, quarter(start));
    for n in 1..=5 {
        close(impacts[n - 1], time, 1e-4);
        let after = 1.0 - (1.0 - e.powi(2 * n as i32) * (1.0 - (1.0 - start).powi(2))).sqrt();
        let between = |row: &&rocking_studies::run::Row| {
            row.time > impacts[n - 1] && impacts.get(n).is_some_and(|&next| row.time < next)
        };
        let greatest = history.rows.iter().filter(between).map(|row| row.observation.theta.abs()).fold(0.0, f64::max);
        close(greatest / SLENDER, after, 1e-4);
        (amplitude, time) = (after, time + quarter(after) * 2.0);
    }
    assert!(amplitude < start);
}

/// C.-S. Yim, A. K. Chopra, J. Penzien, Rocking response of rigid blocks to earthquakes, Earthq. Eng. Struct. Dyn. 8 (1980)
/// 565–587: rocking begins where the ground acceleration exceeds g B/H (after West, in J. Milne 1885).
#[test]
fn yim_chopra_penzien_1980_beginning_of_rocking() {
    for alpha in [0.1_f64, 0.3] {
        let rocks = |amplitude: f64| {
            run(rigid(alpha, 2.0, 0.9), one_sine(amplitude, 0.7), Initial::default(), Some(1.0))
                .outcome()
                .counts
                .liftoffs
                > 0
        };
        close(threshold(0.5 * G * alpha, 2.0 * G * alpha, rocks), G * alpha.tan(), 1e-8);
    }
}

/// The linearized motion of a slender block under a one-sine pulse.
///
/// The block overturns if the component of the free motion that grows as exp(pt) points outwards.
struct Linear {
    /// ω_p/p.
    ratio: f64,
    /// a_p/(α g).
    amplitude: f64,
}

impl Linear {
    /// Phase of the pulse at which the block lifts.
    fn lift_off(&self) -> f64 {
        (1.0 / self.amplitude).asin()
    }

    /// θ/α and θ̇/(α p) at the phase `phase` of the pulse, from the given values at `from`, on the corner of sign `side`.
    ///
    /// Exact for `θ'' = θ − side − a sin φ/(α g)`, with derivatives with respect to p t, positive to the right.
    fn go(&self, [theta, rate]: [f64; 2], side: f64, from: f64, phase: f64) -> [f64; 2] {
        let Linear { ratio, amplitude } = *self;
        // A particular solution: side + A sin φ.
        let a = amplitude / (1.0 + ratio * ratio);
        let (x, y) = (theta - side - a * from.sin(), rate - a * ratio * from.cos());
        let tau = (phase - from) / ratio;
        let (cosh, sinh) = (tau.cosh(), tau.sinh());
        [side + a * phase.sin() + x * cosh + y * sinh, a * ratio * phase.cos() + x * sinh + y * cosh]
    }

    /// Whether the block overturns without an impact: `θ/α + θ̇/(α p)` is beyond the corner at the end of the pulse.
    ///
    /// A pulse to the right first tilts the block to the left.
    fn overturns_at_once(&self) -> bool {
        let [theta, rate] = self.go([0.0; 2], -1.0, self.lift_off(), 2.0 * PI);
        theta + rate <= -1.0
    }

    /// Whether it overturns after one impact with the ratio `e` of angular velocities.
    fn overturns_after_an_impact(&self, e: f64) -> bool {
        let at = |phase: f64| self.go([0.0; 2], -1.0, self.lift_off(), phase);
        let mut low = self.lift_off() + 1e-3;
        while at(low)[0] < 0.0 && low < 2.0 * PI {
            low += 1e-3;
        }
        if low >= 2.0 * PI {
            // The pulse ends before the impact: `(1 + θ)'² − (1 + θ)²` is conserved on the way back and gives the rate at the impact.
            let [theta, rate] = at(2.0 * PI);
            let square = rate * rate - (1.0 + theta).powi(2) + 1.0;
            return theta + rate > -1.0 && square > 0.0 && e * square.sqrt() >= 1.0;
        }
        let (mut before, mut after) = (low - 1e-3, low);
        for _ in 0..60 {
            let middle = 0.5 * (before + after);
            if at(middle)[0] < 0.0 { before = middle } else { after = middle }
        }
        let [_, rate] = at(after);
        let [theta, rate] = self.go([0.0, e * rate], 1.0, after, 2.0 * PI);
        theta + rate >= 1.0
    }
}

fn outcome(ratio: f64, amplitude: f64, e: f64) -> Outcome {
    let p = 1.5;
    let pulse = one_sine(amplitude * SLENDER * G, 2.0 * PI / (ratio * p));
    run(rigid(SLENDER, p, e), pulse, Initial::default(), None).outcome()
}

/// J. Zhang, N. Makris, Rocking response of free-standing blocks under cycloidal pulses, J. Eng. Mech. 127 (2001) 473–483:
/// overturning by a one-sine pulse without an impact, in closed form:
/// `a_p/(α g) · (sin ψ + ω cos ψ − ω exp(−(2π − ψ)/ω))/(1 + ω²) = 1`, ω for ω_p/p and sin ψ = α g/a_p.
#[test]
fn zhang_makris_2001_overturning_without_impact() {
    for ratio in [2.0, 4.0, 6.0, 9.0] {
        let at_once = |amplitude: f64| {
            let outcome = outcome(ratio, amplitude, 0.9);
            outcome.end == End::Overturned && outcome.counts.impacts == 0
        };
        let found = threshold(1.05, 60.0, at_once);
        let left = |amplitude: f64| {
            let psi = (1.0 / amplitude).asin();
            let lost = ratio * (-(2.0 * PI - psi) / ratio).exp();
            amplitude * (psi.sin() + ratio * psi.cos() - lost) / (1.0 + ratio * ratio)
        };
        let printed = threshold(1.05, 60.0, |amplitude| left(amplitude) >= 1.0);
        close(threshold(1.05, 60.0, |amplitude| Linear { ratio, amplitude }.overturns_at_once()), printed, 1e-7);
        close(found, printed, 2e-4);
    }
}

/// E. G. Dimitrakopoulos, M. J. DeJong, Revisiting the rocking block: closed-form solutions and similarity laws, Proc. R. Soc. A
/// 468 (2012) 2294–2318: overturning by a one-sine pulse after one impact, from the closed forms of the linear motion before and
/// after it.
#[test]
fn dimitrakopoulos_dejong_2012_overturning_after_an_impact() {
    for (ratio, e) in [(2.0, 0.8), (3.0, 0.9), (4.0, 0.8), (5.0, 0.95)] {
        let least = |happens: &dyn Fn(f64) -> bool| {
            // The lower end of the first range in which it happens.
            let first = (0..2000).map(|i| 1.0 + 0.01 * f64::from(i + 1)).find(|&amplitude| happens(amplitude)).unwrap();
            threshold(first - 0.01, first, happens)
        };
        let printed = least(&|amplitude| Linear { ratio, amplitude }.overturns_after_an_impact(e));
        let overturns = |amplitude: f64| outcome(ratio, amplitude, e).end == End::Overturned;
        let found = threshold(0.98 * printed, 1.005 * printed, overturns);
        assert!(outcome(ratio, 1.001 * found, e).counts.impacts >= 1);
        close(found, printed, 3e-4);
    }
}

/// G. W. Housner (1963) has `a_p/(α g) = sqrt(1 + (ω_p/p)²)` for a half-sine pulse. B. Shi, A. Anooshehpoor, Y. Zeng,
/// J. N. Brune, Rocking and overturning of precariously balanced rocks by earthquakes, Bull. Seism. Soc. Am. 86 (1996)
/// 1364–1371, corrected it: the block,
/// which lifts when α g is reached, needs
/// `a_p/(α g) · (sin ψ + ω cos ψ + ω exp(−(π − ψ)/ω))/(1 + ω²) = 1`, derived here from the linear equation. This model agrees
/// with the correction.
#[test]
fn shi_and_others_1996_half_sine_pulse() {
    use rocking_block::excitation::{Inputs, Ramp};
    use rocking_block::simulation::Simulation;

    for ratio in [1.0_f64, 3.0, 6.0] {
        let p = 1.5;
        let block = rigid(SLENDER, p, 0.9);
        let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
        // A half-sine is a one-sine up to its middle.
        let at_once = |amplitude: f64| {
            let half = PI / (ratio * p);
            let pulse = one_sine(amplitude * SLENDER * G, 2.0 * half);
            let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &Inputs::default());
            simulation.advance(half, &Inputs::default(), &mut |_| ()).unwrap();
            // The opposite input cancels the second half of the pulse, in intervals in which it is nearly linear.
            let mut time = half;
            let pieces = 400;
            for i in 1..=pieces {
                let next = half + half * f64::from(i) / f64::from(pieces);
                let (here, there) = (pulse.acceleration(time), pulse.acceleration(next.next_down()));
                let ramp = Ramp { value: -here, rate: -(there - here) / (next - time) };
                let against = Inputs { time, a_gx: ramp, ..Inputs::default() };
                simulation.advance(next, &against, &mut |_| ()).unwrap();
                time = next;
            }
            simulation.advance(time + 25.0 / p, &Inputs { time, ..Inputs::default() }, &mut |_| ()).unwrap();
            simulation.counts().impacts == 0 && simulation.ending().is_some()
        };
        let found = threshold(1.001, 60.0, at_once);
        let left = |amplitude: f64| {
            let psi = (1.0 / amplitude).asin();
            let gained = ratio * (-(PI - psi) / ratio).exp();
            amplitude * (psi.sin() + ratio * psi.cos() + gained) / (1.0 + ratio * ratio)
        };
        close(found, threshold(1.001, 60.0, |amplitude| left(amplitude) >= 1.0), 3e-4);
        let housner = (1.0 + ratio * ratio).sqrt();
        assert!((found / housner - 1.0).abs() > 0.01, "{found} is not distinguished from Housner's {housner}");
    }
}

/// The pulse of [`housner_1963_free_rocking`]'s linear theory with half the period of rocking, T_p = 2π/p, in runs without stops on the way.
///
/// With r = a_p/(α g) the block lifts at `p t = asin(1/r)`, and overturns without an impact from `√(r² − 1) + r e^(asin(1/r) − π) = 1` on. The
/// pulse is then as fast as the growth of the rotation, and two successive powers of time vanish from the motion after the lift-off.
#[test]
fn a_half_sine_pulse_as_fast_as_the_block_overturns_it_at_any_tolerance() {
    let lasting = |r: f64| (r * r - 1.0).sqrt() + r * ((1.0 / r).asin() - PI).exp() - 1.0;
    let exact = threshold(1.01, 2.0, |r| lasting(r) >= 0.0);
    close(exact, 1.3224, 1e-4);
    for (alpha, tolerance) in [(0.001, 1e-8), (0.001, 1e-6), (0.001, 1e-4), (0.001, 1e-3), (0.01, 1e-3), (0.01, 1e-4)] {
        let p = 2.0;
        let overturns = |r: f64| {
            let pulse =
                Pulse { shape: PulseShape::HalfSine, period: 2.0 * PI / p, amplitude: r * alpha * G, ..Pulse::NONE };
            let settings = Settings { tolerance, on_separation: OnSeparation::Fly, ..Settings::default() };
            let outcome = Run { pulse, ..Run::at_rest(rigid(alpha, p, 1.0), settings) }.outcome();
            outcome.end == End::Overturned && outcome.counts.impacts == 0
        };
        close(threshold(1.3, 1.35, overturns), exact, alpha * alpha + tolerance);
    }
}

/// N. Makris, Y. Roussos, Rocking response of rigid blocks under near-source ground motions, Géotechnique 50 (2000) 243–262: the
/// least one-sine pulse that overturns is near `a_p/(α g) = 1 + (1/6) ω_p/p` for ω_p/p up to 3: an approximation.
#[test]
fn makris_roussos_2000_least_amplitude() {
    for ratio in [1.0, 2.0, 3.0] {
        let overturns = |amplitude: f64| outcome(ratio, amplitude, 0.97).end == End::Overturned;
        let first = (0..400).map(|i| 1.0 + 0.01 * f64::from(i + 1)).find(|&amplitude| overturns(amplitude)).unwrap();
        close(threshold(first - 0.01, first, overturns), 1.0 + ratio / 6.0, 0.1);
    }
}

/// I. N. Psycharis, P. C. Jennings, Rocking of slender rigid bodies allowed to uplift, Earthq. Eng. Struct. Dyn. 11 (1983) 57–76:
/// a block on two springs and dashpots that both touch has, with small rotations, the circular frequency
/// `ω² = (2 K b² − M g h)/(I0 + M h²)` and the damping ratio `ζ = C b²/((I0 + M h²) ω)`.
#[test]
fn psycharis_jennings_1983_rocking_in_full_contact() {
    let dimensionless =
        Dimensionless { alpha: 0.3, p: 1.5, supports: Supports::Viscoelastic(Ratios { eta: 25.0, xi_v: 0.08 }) };
    let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
    let Block { stiffness, damping, body: Body { mass, b, h, .. }, .. } = block;
    let inertia = block.inertia() + mass * h * h;
    let omega = ((2.0 * stiffness * b * b - mass * G * h) / inertia).sqrt();
    let zeta = damping * b * b / (inertia * omega);
    let damped = omega * (1.0 - zeta * zeta).sqrt();

    let initial = Initial { theta: 1e-6, ..Initial::default() };
    let mut run = run(block, Pulse::NONE, initial, Some(10.0 * PI / damped));
    run.output_step = 1e-3 / damped;
    let history = run.history(|_| ()).unwrap();
    // Extremes of the rotation, from the zeros of its rate.
    let extremes: Vec<(f64, f64)> = history
        .rows
        .windows(2)
        .filter(|pair| pair[0].time > 0.0 && pair[0].observation.theta_dot * pair[1].observation.theta_dot < 0.0)
        .map(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let part = a.observation.theta_dot / (a.observation.theta_dot - b.observation.theta_dot);
            (a.time + part * (b.time - a.time), a.observation.theta.abs())
        })
        .collect();
    let (first, last) = (extremes[0], extremes[6]);
    close((last.0 - first.0) / 6.0, PI / damped, 1e-5);
    let decrement = (first.1 / last.1).ln() / 6.0;
    close(decrement, PI * zeta / (1.0 - zeta * zeta).sqrt(), 1e-4);
}
