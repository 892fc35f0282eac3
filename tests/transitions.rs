//! Transitions from poses that runs seldom come to, each against what its definition asks for.

use rocking_block::block::{Block, Common, Dimensionless, Foundation};
use rocking_block::contact::{Contact, Contacts, Corner, Creep, Regime};
use rocking_block::excitation::{Excitation, Inputs, Pulse, Ramp};
use rocking_block::simulation::outputs::observe;
use rocking_block::simulation::{Counts, Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::System;
use rocking_block::system::dynamics::{Footing, State};
use rocking_block::system::now::{Motion, Pose};
use rocking_block::system::surfaces::{EventKind, Surface};
use rocking_block::system::transitions::{Along, Start, Transition};

fn block(common: &Common) -> Block {
    Block::from_dimensionless(&Dimensionless { alpha: 0.9, p: 1.0, eta: 8.0, xi_v: 1.5 }, common).unwrap()
}

fn system(block: Block) -> System {
    System { block, flies: true, slowest: System::SLOWEST }
}

fn excitation(block: &Block, a_gx: f64) -> Excitation {
    let inputs = Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
    Excitation::from_time(0.0, &inputs, &Pulse::NONE, block)
}

fn transition(system: &System, pose: &Pose, a_gx: f64, surface: Surface) -> Transition {
    let excitation = excitation(&system.block, a_gx);
    let now = Motion::from_pose(&system.block, pose, &excitation).at(pose.time, pose.state);
    system.transition(pose, &now, surface)
}

/// A support on its way back and a corner that leaves it almost as fast: closer than rounding lets two rates be told apart the
/// two go on together, and otherwise the corner keeps its rate. So it does where it is slower than the support, which presses.
#[test]
fn a_corner_goes_with_its_support_where_their_rates_are_the_same_to_rounding() {
    let block = block(&Common::default());
    let theta = -0.2;
    let creep = Creep { depth: 0.5 * block.static_deflection(), since: -0.1 };
    let top = creep.top(&block, 0.0);
    assert!(top.rate > 0.1, "{top:?}");
    // How much higher L is above its place at rest than the centre of mass is above its own.
    let corner = block.b * libm::sin(theta) + block.h * (1.0 - libm::cos(theta));
    for (faster, with_its_support) in [(1e-6, true), (-1e-6, false), (-1e-3, false)] {
        // It does not turn, nor move horizontally: to be held stops nothing.
        let rate = top.rate + faster;
        let pose = Pose {
            time: 0.0,
            state: State::from([theta, 0.0, top.value - corner, rate]),
            contacts: {
                let mut contacts = Contacts::touching([false; 2], 0.0);
                contacts.set(Corner::Left, Contact::Lifted(creep));
                contacts
            },
            footing: Footing::Free { u: block.h * libm::sin(theta), u_dot: 0.0 },
        };
        let Transition { pose: after, happened, tally } =
            transition(&system(block), &pose, 0.0, Surface::Gap(Corner::Left));
        assert_eq!(happened, Some(EventKind::Landing(Corner::Left)));
        assert_eq!((after.contacts.regime(), tally.impacts), (Regime::TiltingLeft, 0));
        let [_, _, height, found] = after.state.0;
        assert_eq!(height, top.value);
        if with_its_support {
            assert_eq!(found, top.rate, "faster by {faster} m/s");
        } else {
            assert!((found - rate).abs() < 1e-12, "{found} m/s, expected {rate}");
        }
    }
}

/// With ε = 0 a corner that comes down stands still, even on a support that creeps as slowly as rounding lets rates be told apart.
#[test]
fn a_corner_that_lands_without_rebound_stands_still() {
    let block = block(&Common::default());
    let theta = -0.2;
    let slow = 1e-6;
    let creep = Creep { depth: slow / block.creep_rate(), since: 0.0 };
    let top = creep.top(&block, 0.0);
    assert!((top.rate - slow).abs() < 1e-15, "{top:?}");
    let corner = block.b * libm::sin(theta) + block.h * (1.0 - libm::cos(theta));
    let mut contacts = Contacts::touching([false; 2], 0.0);
    contacts.set(Corner::Left, Contact::Lifted(creep));
    let pose = Pose {
        time: 0.0,
        state: State::from([theta, 0.0, top.value - corner, -0.5]),
        contacts,
        footing: Footing::Free { u: block.h * libm::sin(theta), u_dot: 0.0 },
    };
    let Transition { pose: after, tally, .. } = transition(&system(block), &pose, 0.0, Surface::Gap(Corner::Left));
    assert_eq!((after.contacts.regime(), tally.impacts), (Regime::TiltingLeft, 1));
    assert_eq!(after.state.0[2..], [top.value, 0.0]);
}

/// On the rigid base the block slides on R and comes down on L, which holds it: R leaves the base.
#[test]
fn a_corner_that_slid_until_the_other_one_landed_has_lifted() {
    for (epsilon, lifts) in [(0.0, 1), (0.6, 2)] {
        let block = block(&Common { foundation: Foundation::Rigid, epsilon, ..Common::default() });
        let pose = Pose {
            time: 0.0,
            state: State::from([0.0, -0.4, 0.0, 0.0]),
            contacts: Contacts::touching([false, true], 0.0),
            footing: Footing::Free { u: 0.0, u_dot: -0.4 * block.h },
        };
        let Transition { pose: after, happened, tally } =
            transition(&system(block), &pose, 0.0, Surface::Gap(Corner::Left));
        assert_eq!(happened, Some(EventKind::Landing(Corner::Left)));
        assert!(!after.contacts.touches(Corner::Right), "{after:?}");
        assert_eq!(after.contacts.touches(Corner::Left), lifts == 1, "{after:?}");
        assert_eq!([tally.impacts, tally.liftoffs], [1, lifts]);
    }
}

/// R has just come to the end of its support and bears nothing. The ground moves so fast that R, as long as it is held
/// horizontally, would be lifted, and let go would come down again: it slides from the first instant on.
#[test]
fn a_block_that_slides_from_the_first_instant_on_does_so_in_other_numbers_too() {
    let block = block(&Common::default());
    let (theta, a_gx) = (0.05, 30.0);
    let (sin, cos) = libm::sincos(theta);
    let v = block.static_deflection() + block.b * sin - block.h * sin * sin / (1.0 + cos);
    let initial = Initial { theta, theta_dot: 0.0, vertical: Some((v, 0.0)) };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let inputs = Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
    let simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
    let expected = simulation.observe(&inputs);
    assert_eq!((expected.regime, expected.horizontal), (Regime::TiltingRight, 0.0));
    assert!((expected.u_ddot + a_gx).abs() < 1e-12, "{expected:?}");

    let excitation = excitation(&block, a_gx);
    let start = Start { block, initial, forcing: excitation.at(0.0) };
    let Along { goes_on: (regime, x), tops, .. } = system(block).beginning_along(&initial, 0.0, &excitation, &start);
    assert_eq!(observe(&block, regime, &x, tops, start.forcing), expected);
}

/// Drawn up faster than their supports can follow, both corners leave at once: the supports are still below them.
#[test]
fn supports_are_where_the_corners_have_just_left_them() {
    let block = block(&Common::default());
    let initial = Initial { theta: 0.01, theta_dot: 0.0, vertical: Some((0.0, 4.0)) };
    let excitation = excitation(&block, 0.0);
    let pose = system(block).beginning(&initial, 0.0, &excitation);
    assert_eq!(pose.contacts.regime(), Regime::Separated);
    let start = Start { block, initial, forcing: excitation.at(0.0) };
    let Along { tops, .. } = system(block).beginning_along(&initial, 0.0, &excitation, &start);
    for (corner, found) in Corner::BOTH.into_iter().zip(tops) {
        let expected = pose.contacts.top(corner, &block, 0.0).value;
        assert!(expected < 0.5 * block.static_deflection(), "{expected}");
        assert!((found - expected).abs() < 1e-15, "{corner:?}: {found} m, expected {expected} m");
    }
}

/// A transition looks at the block once for each regime that it tries.
#[test]
fn evaluations_in_transitions_are_counted() {
    let block = block(&Common::default());
    // R's reaction has just gone, and it rises.
    let [theta_dot, height] = [-0.3, block.static_deflection()];
    let pose = Pose {
        time: 0.0,
        state: State::from([-0.1, theta_dot, height - block.b * libm::sin(0.1), 0.0]),
        contacts: Contacts::FULL,
        footing: Footing::AT_START,
    };
    let Transition { pose: after, tally, .. } =
        transition(&system(block), &pose, 0.0, Surface::Reaction(Corner::Right));
    assert_eq!((after.contacts.regime(), tally.evaluations), (Regime::TiltingLeft, 1));
}

/// Of all evaluations of a run those that are not of its start, its steps, its event and the event's transition are of the
/// dense output, three for each step that needs it.
#[test]
fn evaluations_are_those_of_steps_events_and_dense_output() {
    // The block falls on L and stays, or on its right side.
    for (theta, landings) in [(0.3, 1), (1.0, 0)] {
        let common = Common { foundation: Foundation::Rigid, restitution_factor: 0.0, ..Common::default() };
        let initial = Initial { theta, ..Initial::default() };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block(&common), Settings::default(), Pulse::NONE, &initial, 0.0, &inputs);
        let mut events = 0;
        simulation.advance(1e3, &inputs, &mut |_| events += 1).unwrap();
        let Counts { impacts, steps, rejected, evaluations, .. } = simulation.counts();
        assert_eq!((events, impacts), (1, landings));
        let rest = evaluations as i64 - 1 - 11 * (steps + rejected) as i64 - 1 - i64::from(landings);
        assert!(rest % 3 == 0 && (3..=3 * steps as i64).contains(&rest), "{rest} of {:?}", simulation.counts());
    }
}
