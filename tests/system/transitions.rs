//! Transitions from rare poses, each against its definition.

use rocking_block::block::restraints::States;
use rocking_block::block::{Block, Common, Contact, Contacts, Corner, Creep, Dimensionless, Regime, Supports};
use rocking_block::excitation::{Excitation, Inputs, Pulse, Ramp};
use rocking_block::simulation::{Counts, Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::System;
use rocking_block::system::evaluation::Motion;
use rocking_block::system::events::{EventFunction, EventKind, Transition};
use rocking_block::system::instant::{Footing, Pose, State};

use crate::blocks::squat as block;

/// The block on a rigid base.
fn on_rigid_base(restitution_factor: f64, common: &Common) -> Block {
    let supports = Supports::Rigid { restitution_factor };
    Block::from_dimensionless(&Dimensionless { alpha: 0.9, p: 1.0, supports }, common).unwrap()
}

fn system(block: Block) -> System {
    System { block, flies: true }
}

fn excitation(block: &Block, a_gx: f64) -> Excitation {
    let inputs = Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
    Excitation::from_time(0.0, &inputs, &Pulse::NONE, block)
}

fn transition(system: &System, pose: &Pose, a_gx: f64, function: EventFunction) -> Transition {
    let excitation = excitation(&system.block, a_gx);
    let now = Motion::from_pose(&system.block, pose, &excitation).at(pose.time, pose.state);
    system.transition(pose, &now, function)
}

/// A corner joins a recovering support if their rates agree to round-off, and otherwise keeps its own rate.
#[test]
fn a_corner_joins_its_support_if_their_rates_agree_to_rounding() {
    let block = block(&Common::default());
    let theta = -0.2;
    let creep = Creep { depth: 0.5 * block.static_deflection(), since: -0.1 };
    let top = creep.top(Corner::Left, &block, 0.0);
    assert!(top.eps > 0.1, "{top:?}");
    // Rise of L minus rise of the centre of mass, from rest.
    let corner = block.b * libm::sin(theta) + block.h * (1.0 - libm::cos(theta));
    for (faster, with_its_support) in [(1e-6, true), (-1e-6, false), (-1e-3, false)] {
        // Without rotation and horizontal motion the grip has no effect.
        let rate = top.eps + faster;
        let pose = Pose {
            time: 0.0,
            state: State::from([theta, 0.0, top.re - corner, rate]),
            contacts: {
                let mut contacts = Contacts::touching([false; 2], 0.0);
                contacts.set(Corner::Left, Contact::Lifted(creep));
                contacts
            },
            footing: Footing::Free { u: block.h * libm::sin(theta), u_dot: 0.0 },
            restraints: States::NONE,
        };
        let Transition { pose: after, event, counts, .. } =
            transition(&system(block), &pose, 0.0, EventFunction::Gap(Corner::Left));
        assert_eq!(event, Some(EventKind::Landing(Corner::Left)));
        assert_eq!((after.contacts.regime(), counts.impacts), (Regime::TiltingLeft, 0));
        let [_, _, height, found] = after.state.0;
        assert_eq!(height, top.re);
        if with_its_support {
            assert_eq!(found, top.eps, "faster by {faster} m/s");
        } else {
            assert!((found - rate).abs() < 1e-12, "{found} m/s, expected {rate}");
        }
    }
}

/// With ε = 0 a landed corner stands still, even on a support that creeps at the limit of round-off.
#[test]
fn a_corner_that_lands_without_rebound_stands_still() {
    let block = block(&Common::default());
    let theta = -0.2;
    let slow = 1e-6;
    let creep = Creep { depth: slow / block.creep_rate, since: 0.0 };
    let top = creep.top(Corner::Left, &block, 0.0);
    assert!((top.eps - slow).abs() < 1e-15, "{top:?}");
    let corner = block.b * libm::sin(theta) + block.h * (1.0 - libm::cos(theta));
    let mut contacts = Contacts::touching([false; 2], 0.0);
    contacts.set(Corner::Left, Contact::Lifted(creep));
    let pose = Pose {
        time: 0.0,
        state: State::from([theta, 0.0, top.re - corner, -0.5]),
        contacts,
        footing: Footing::Free { u: block.h * libm::sin(theta), u_dot: 0.0 },
        restraints: States::NONE,
    };
    let Transition { pose: after, counts, .. } =
        transition(&system(block), &pose, 0.0, EventFunction::Gap(Corner::Left));
    assert_eq!((after.contacts.regime(), counts.impacts), (Regime::TiltingLeft, 1));
    assert_eq!(after.state.0[2..], [top.re, 0.0]);
}

/// A block sliding on R on the rigid base lands on L, which grips: R leaves the base.
#[test]
fn a_corner_that_slid_until_the_other_one_landed_has_lifted() {
    for (epsilon, lifts) in [(0.0, 1), (0.6, 2)] {
        let block = on_rigid_base(1.0, &Common { epsilon, ..Common::default() });
        let pose = Pose {
            time: 0.0,
            state: State::from([0.0, -0.4, 0.0, 0.0]),
            contacts: Contacts::touching([false, true], 0.0),
            footing: Footing::Free { u: 0.0, u_dot: -0.4 * block.h },
            restraints: States::NONE,
        };
        let Transition { pose: after, event, counts, .. } =
            transition(&system(block), &pose, 0.0, EventFunction::Gap(Corner::Left));
        assert_eq!(event, Some(EventKind::Landing(Corner::Left)));
        assert!(!after.contacts.touches(Corner::Right), "{after:?}");
        assert_eq!(after.contacts.touches(Corner::Left), lifts == 1, "{after:?}");
        assert_eq!([counts.impacts, counts.liftoffs], [1, lifts]);
    }
}

/// A block without friction may slide from the first instant.
///
/// R is at the free height of its support, without load. The ground moves so fast that R would lift while gripping, and land
/// again when released.
#[test]
fn a_block_slides_from_the_first_instant() {
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
}

/// Corners drawn up faster than their supports can follow leave at once, and the supports stay below them.
#[test]
fn supports_are_where_the_corners_have_just_left_them() {
    let block = block(&Common::default());
    let initial = Initial { theta: 0.01, theta_dot: 0.0, vertical: Some((0.0, 4.0)) };
    let excitation = excitation(&block, 0.0);
    let pose = system(block).beginning(&initial, 0.0, &excitation);
    assert_eq!(pose.contacts.regime(), Regime::Separated);
    for corner in Corner::BOTH {
        let found = pose.contacts.top(corner, &block, 0.0).re;
        assert!(found < 0.5 * block.static_deflection(), "{corner:?}: {found} m");
    }
}

/// A transition evaluates the block once per tried regime.
#[test]
fn evaluations_in_transitions_are_counted() {
    let block = block(&Common::default());
    // R has just lost its load and rises.
    let [theta_dot, height] = [-0.3, block.static_deflection()];
    let pose = Pose {
        time: 0.0,
        state: State::from([-0.1, theta_dot, height - block.b * libm::sin(0.1), 0.0]),
        contacts: Contacts::FULL,
        footing: Footing::AT_START,
        restraints: States::NONE,
    };
    let Transition { pose: after, counts, .. } =
        transition(&system(block), &pose, 0.0, EventFunction::Reaction(Corner::Right));
    assert_eq!((after.contacts.regime(), counts.evaluations), (Regime::TiltingLeft, 1));
}

/// Evaluations beyond start, steps, event and transition are of the dense output, three per step that needs it; or of a swing, one for
/// the series, and one for each instant at which a force may have its peak: the end, and those of N, H and the friction demand.
#[test]
fn evaluations_count_steps_events_and_dense_output() {
    // With friction the block takes Runge-Kutta steps, without it moves by swings. It falls on L and stays, or onto its right side.
    for (friction, theta, landings, per_step, beyond, times) in
        [(1.0, 1.0, 0, 11, 3, 1), (0.0, 1.0, 0, 1, 1, 4), (0.0, 0.3, 1, 1, 1, 4)]
    {
        let block = on_rigid_base(0.0, &Common { friction, ..Common::default() });
        let initial = Initial { theta, ..Initial::default() };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs);
        let mut events = 0;
        simulation.advance(1e3, &inputs, &mut |_| events += 1).unwrap();
        let Counts { impacts, steps, rejected, evaluations, .. } = simulation.counts();
        assert_eq!((events, impacts), (1, landings));
        let rest = evaluations as i64 - 1 - per_step * (steps + rejected) as i64 - 1 - i64::from(landings);
        let most = beyond * times * steps as i64;
        assert!(rest % beyond == 0 && (beyond..=most).contains(&rest), "{rest} of {:?}", simulation.counts());
    }
}
