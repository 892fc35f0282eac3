//! The tangent series of a swing about a corner of the rigid base, against the equations of motion in numbers with derivatives.

use rocking_block::block::restraints::States;
use rocking_block::block::{Block, BlockParameters, Common, Contact, Contacts, Corner, Creep, Outline, Supports};
use rocking_block::excitation::{Excitation, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::scalar::Elementary;
use rocking_block::simulation::follow::{Samples, StepKind, repeat_step};
use rocking_block::system::instant::{Footing, Pose};
use rocking_block::system::swing::Swing;
use rocking_gradients::{BATCH, Number};

/// A block on the rigid base and its excitation; `number` gives the numbers, each with its own index.
fn setting<T: Elementary>(shape: PulseShape, number: impl Fn(f64, u32) -> T) -> (Block<T>, Excitation<T>) {
    let outline = Outline::Slenderness { alpha: number(0.25, 1), p: number(1.5, 2) };
    let supports = Supports::Rigid { restitution_factor: T::from(1.0) };
    let common = Common {
        mass: number(2.0, 3),
        gamma: number(2.5, 4),
        gravity: number(9.81, 5),
        eccentricity: number(0.2, 6),
        epsilon: T::from(0.0),
        friction: T::from(0.0),
    };
    let block = Block::unchecked(&BlockParameters { outline, supports, common });
    let ramp = |value: f64, i: u32| Ramp { value: number(value, i), rate: number(2.0 * value, i + 1) };
    let none = || Ramp::held(T::from(0.0));
    let inputs = Inputs {
        time: T::from(0.4),
        a_gx: ramp(1.0, 7),
        a_gz: ramp(-0.7, 9),
        m_y: ramp(3.0, 11),
        f_x: none(),
        f_z: none(),
    };
    let pulse = Pulse {
        shape,
        amplitude: number(4.0, 13),
        period: number(1.3, 14),
        start: number(0.2, 15),
        phase: T::from(0.0),
        cycles: T::from(2.0),
    };
    let excitation = Excitation::new(&inputs, (shape != PulseShape::None).then_some(&pulse), block.mass);
    (block, excitation)
}

/// Derivatives of the order of 1 that have nothing in common.
fn varied(value: f64, i: u32) -> Number {
    Number::new(value, std::array::from_fn(|direction| (1.0 + 3.0 * f64::from(i) + 40.0 * direction as f64).sin()))
}

#[test]
fn tangents_of_a_swing_follow_the_equations_of_motion() {
    const TOLERANCE: f64 = 1e-11;
    // Steps of order 8 in place of a part of a swing.
    const STEPS: u32 = 20;
    const PART: f64 = 0.8;
    const START: f64 = 0.5;
    for case in 0..6 {
        let shape = [PulseShape::None, PulseShape::OneSine, PulseShape::C1][case / 2];
        let corner = Corner::BOTH[case % 2];
        let (block, excitation) = setting(shape, varied);
        let (plain, acts) = setting(shape, |value, _| value);
        let mut contacts = Contacts::touching([true, true], Number::from(START));
        contacts.set(corner.other(), Contact::Lifted(Creep::default()));
        let [tilt, rate] = [varied(-0.04 * corner.sign(), 16), varied(0.2, 17)];
        let pose = Pose {
            time: Number::from(START),
            state: [tilt, rate, Number::from(0.0), Number::from(0.0)].into(),
            contacts,
            footing: Footing::Grips { offset: Number::from(0.0) },
            restraints: States::NONE,
        };
        let swing = Swing::of(&plain, corner, &acts, [START, tilt.re, rate.re], 0.3, 1e-14);
        let end = |step: u32| START + PART * swing.size * f64::from(step) / f64::from(STEPS);
        let repeat = |pose: &Pose<Number>, course: &StepKind, end: f64| {
            let samples = Samples { times: &[], seen: &mut |_| () };
            let (state, footing) = repeat_step(&block, pose, &excitation, course, end, samples);
            Pose { time: end.into(), state, footing, ..*pose }
        };
        let found = repeat(&pose, &StepKind::Swing(swing), end(STEPS));
        let expected = (1..=STEPS).fold(pose, |pose, step| repeat(&pose, &StepKind::Step, end(step)));
        for (x, (found, expected)) in found.state.0.into_iter().zip(expected.state.0).enumerate() {
            assert!((found.re - expected.re).abs() < TOLERANCE, "case {case}, {x}: {found:?} instead of {expected:?}");
            for direction in 0..BATCH {
                let (found, expected) = (found.eps[direction], expected.eps[direction]);
                let off = (found - expected).abs();
                assert!(off < TOLERANCE, "case {case}, {x} in {direction}: {found} instead of {expected}");
            }
        }
    }
}
