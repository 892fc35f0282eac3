//! Swings against Runge–Kutta steps and their own bounds.

use std::f64::consts::FRAC_PI_2;

use proptest::prelude::*;

use super::*;
use crate::block::{Block, Common, Contact, Contacts, Creep, Dimensionless, Supports};
use crate::excitation::{Inputs, Pulse, PulseShape, Ramp};
use crate::numerics::bernstein::Zero;
use crate::numerics::control::LONGEST;
use crate::numerics::dop853::DenseStep;
use crate::system::evaluation::Motion;
use crate::system::instant::{Footing, Pose, State};

#[derive(Clone, Debug)]
struct Case {
    block: Block,
    excitation: Excitation,
    corner: Corner,
    start: [f64; 2],
    longest: f64,
}

impl Case {
    fn swing(&self, allowed: f64) -> Swing {
        let [theta, theta_dot] = self.start;
        Swing::of(&self.block, self.corner, &self.excitation, [0.5, theta, theta_dot], self.longest, allowed)
    }

    /// The motion by the equations of motion and an integrator of another kind.
    fn motion(&self) -> Motion<'_> {
        let [theta, theta_dot] = self.start;
        let mut contacts = Contacts::FULL;
        contacts.set(self.corner.other(), Contact::Lifted(Creep::default()));
        let state = State::from([theta, theta_dot, 0.0, 0.0]);
        Motion::from_pose(&self.block, &Pose::unrestrained(0.5, state, contacts, Footing::AT_START), &self.excitation)
    }
}

prop_compose! {
    /// A block tilting about a corner under ground motion, a moment, and perhaps a pulse.
    fn case()(
        (alpha, p, gamma, uneven) in (0.05..0.6_f64, 0.5..5.0_f64, 1.0..4.0_f64, -0.8..0.8_f64),
        (theta, theta_dot) in (prop_oneof![3 => 0.0..1.5_f64, 1 => Just(0.0)], prop_oneof![3 => -1.0..1.0_f64, 1 => Just(0.0)]),
        (left, size) in (any::<bool>(), 0.001..1.0_f64),
        ramps in prop::array::uniform6(-1.0..1.0_f64),
        (shape, period, amplitude) in (0..3_usize, 0.3..2.0_f64, -6.0..6.0_f64),
    ) -> Case {
        let numbers = Dimensionless { alpha, p, supports: Supports::HOUSNER };
        let common = Common { gamma, ..Common::default() };
        let even = Block::from_dimensionless(&numbers, &common).unwrap();
        let common = Common { eccentricity: uneven * even.b, ..common };
        let block = Block::from_dimensionless(&numbers, &common).unwrap();
        let ramp = |i: usize, scale: f64| Ramp { value: scale * ramps[i], rate: 10.0 * scale * ramps[i + 1] };
        let inputs = Inputs {
            time: 0.4,
            a_gx: ramp(0, 5.0),
            a_gz: ramp(2, 3.0),
            m_y: ramp(4, 0.3 * block.mass * block.gravity * block.b),
            ..Inputs::default()
        };
        let shape = [PulseShape::None, PulseShape::OneSine, PulseShape::C1][shape];
        let pulse = Pulse { shape, amplitude, period, start: 0.2, ..Pulse::NONE };
        let corner = if left { Corner::Left } else { Corner::Right };
        let start = [-corner.sign() * theta * alpha, theta_dot * alpha * p];
        let excitation = Excitation::from_time(0.5, &inputs, &pulse, &block);
        let longest = size * LONGEST / p.max(excitation.frequency());
        Case { block, excitation, corner, start, longest }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    /// Rotation, rate, work of the excitation and forces agree with Runge–Kutta steps. Bounds hold on the way.
    #[test]
    fn a_swing_follows_the_equations_of_motion(case in case()) {
        const STEPS: u32 = 40;
        let Case { ref block, corner, .. } = case;
        let (swing, motion) = (case.swing(1e-13), case.motion());
        let (bounds, forces) = (swing.bounds(&Pivoting::of(block, corner)), [[1.0, 0.0], [0.0, 1.0]].map(|one| swing.forces(1.0, block.gravity).combined(one)));
        let (rate, height) = (block.alpha * block.p, block.gravity * block.r0 * block.alpha);
        let (size, mut work) = (swing.size / f64::from(STEPS), 0.0);
        let mut now = motion.at(0.5, State::from([case.start[0], case.start[1], 0.0, 0.0]));
        for step in 0..=STEPS {
            let fraction = f64::from(step) / f64::from(STEPS);
            let ([theta, theta_dot], [n, h]) = (swing.at(fraction), forces.each_ref().map(|force| force.at(fraction)));
            let off = [(theta - now.state[0]) / block.alpha, (theta_dot - now.state[1]) / rate, (swing.work(fraction) - work) / height];
            prop_assert!(off.iter().all(|off| off.abs() < 1e-11), "{}: {:?}", fraction, off);
            let (found, i) = (now.rates(), corner.index());
            let reaction = found.reaction[i];
            let off = [n - reaction.re, h - found.horizontal.re].map(|off| off / block.gravity);
            prop_assert!(off.iter().all(|off| off.abs() < 1e-8), "{}: {:?}", fraction, off);
            let [least, most] = bounds.reaction;
            let slack = 1e-8 * block.gravity;
            prop_assert!(least - slack <= n && n <= most + slack, "N {} beyond {:?}", n, bounds);
            prop_assert!(h.abs() <= bounds.horizontal + slack, "H {} beyond {:?}", h, bounds);
            prop_assert!(theta.abs() <= bounds.theta * (1.0 + 1e-14), "{} beyond {:?}", theta, bounds);
            let next = DenseStep::attempt(now.time, size, now.state, motion.rate_of(&now), &motion);
            work += next.work[0];
            now = motion.at(next.end_time, next.end);
        }
    }

    /// θ first comes to zero at the landing, and only there if bounds are certain. A quarter turn is the first, too.
    #[test]
    fn a_landing_is_the_first(case in case()) {
        let (swing, away) = (case.swing(1e-10), -case.corner.sign());
        let bounds = swing.bounds(&Pivoting::of(&case.block, case.corner));
        let (found, quarter) = (swing.first_landing(case.corner), swing.quarter_turn(case.corner));
        prop_assert_ne!(quarter, Zero::Unclear);
        let landing = match bounds.is_certain {
            true if bounds.last < 0.0 => Zero::At(swing.landing(true)),
            true => Zero::None,
            false => found,
        };
        match (landing, found) {
            (Zero::At(certain), Zero::At(found)) => prop_assert!((certain / found - 1.0).abs() < 1e-12),
            _ => prop_assert_eq!(landing, found),
        }
        for (zero, height) in [(landing, [away, 0.0]), (quarter, [-away, FRAC_PI_2])] {
            let rest = |fraction: f64| height[0] * swing.at(fraction)[0] + height[1];
            let fraction = match zero {
                Zero::None => 1.0,
                Zero::At(fraction) => {
                    let [before, after] = [fraction * (1.0 - 1e-13), fraction * (1.0 + 1e-13)].map(rest);
                    prop_assert!(before >= 0.0 && after <= 0.0, "{} to {} at {}", before, after, fraction);
                    fraction
                }
                Zero::Unclear => continue,
            };
            for i in 1..50 {
                let on_the_way = rest(fraction * f64::from(i) / 50.0);
                prop_assert!(on_the_way > 0.0, "{} before {}", on_the_way, fraction);
            }
        }
    }

    /// No rotation on the way exceeds the highest one.
    #[test]
    fn the_highest_rotation_is_found(case in case(), fraction in 0.1..1.0_f64) {
        let (swing, away) = (case.swing(1e-10), -case.corner.sign());
        let at = |fraction: f64| away * swing.at(fraction)[0];
        let ends = at(0.0).max(at(fraction));
        let bounds = swing.bounds(&Pivoting::of(&case.block, case.corner));
        let highest = swing.highest(case.corner, &bounds, fraction, ends).map_or(ends, at);
        for i in 0..=100 {
            prop_assert!(at(fraction * f64::from(i) / 100.0) <= highest * (1.0 + 1e-14), "{} of {}", i, highest);
        }
    }
}

/// A loose tolerance takes few terms. One that no order meets shortens the swing.
#[test]
fn the_order_follows_the_tolerance() {
    let numbers = Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::HOUSNER };
    let common = Common::default();
    let block = Block::from_dimensionless(&numbers, &common).unwrap();
    let excitation = Excitation::none();
    let of = |longest: f64, allowed: f64| {
        let swing = Swing::of(&block, Corner::Right, &excitation, [0.0, 0.1, 0.2], longest, allowed);
        (swing.order, swing.size)
    };
    assert_eq!(of(0.01, 1e-2), (4, 0.01));
    let orders = [1e-4, 1e-7, 1e-10, 1e-13].map(|allowed| of(0.1, allowed).0);
    assert!(orders.windows(2).all(|pair| pair[0] < pair[1]), "{orders:?}");
    let (order, size) = of(2.0, 1e-12);
    assert!(order == ORDER && size < 0.9, "{order}, {size} s");
    // Of a swing that is shortened, no more than necessary.
    let (_, kept) = of(0.95 * size, 1e-12);
    let (_, again) = of(1.05 * size, 1e-12);
    assert!(kept == 0.95 * size && again < 1.05 * size, "{size} s, {kept} s and {again} s");
}

/// Bounds tell without a search whether a free swing lands, and whether it turns back.
#[test]
fn free_swings_are_certain() {
    let numbers = Dimensionless { alpha: 0.25, p: 1.0, supports: Supports::HOUSNER };
    let common = Common::default();
    let block = Block::from_dimensionless(&numbers, &common).unwrap();
    let excitation = Excitation::none();
    // θ̈ is −0.15 rad/s² at θ = 0.1 rad.
    for (theta, theta_dot, longest, lands, turns) in [
        (0.0, 0.05, 1.0, true, true),
        (0.0, 0.1, 0.3, false, false),
        (0.1, 0.05, 0.3, false, false),
        (0.1, 0.05, 0.36, false, true),
        (0.1, -0.3, 0.2, false, false),
        (0.02, -0.1, 0.25, true, false),
    ] {
        for corner in Corner::BOTH {
            let start = [0.0, -corner.sign() * theta, -corner.sign() * theta_dot];
            let swing = Swing::of(&block, corner, &excitation, start, longest, 1e-10);
            let bounds = swing.bounds(&Pivoting::of(&block, corner));
            assert!(bounds.is_certain, "{theta}, {theta_dot}: {bounds:?}");
            assert_eq!(
                (bounds.last < 0.0, !bounds.is_greatest_at_end),
                (lands, turns),
                "{theta}, {theta_dot}: {bounds:?}"
            );
        }
    }
}
