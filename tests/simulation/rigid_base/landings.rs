//! Landings from flight, against the impulses at the corner.
//!
//! A block on ground that falls with 2 g flies level. Loads and a push of the ground then give it arbitrary velocities, in
//! closed form until it lands.

use nalgebra::{Matrix2, Vector2};
use rocking_block::block::restraints::States;
use rocking_block::block::{Block, Contacts, Corner, Regime};
use rocking_block::excitation::{Excitation, Inputs, Pulse, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Initial, OnSeparation, Simulation};
use rocking_block::system::System;
use rocking_block::system::evaluation::Motion;
use rocking_block::system::events::{Event, EventFunction, EventKind};
use rocking_block::system::impact::Velocities;
use rocking_block::system::instant::Pose;
use rocking_block::system::instant::{Footing, State};

use super::{G, block, go, held, seen, start};

/// Duration of the rise and of the push (s).
const TOSS: f64 = 0.1;

/// Horizontal velocity and rotation rate from the push.
#[derive(Clone, Copy, Debug)]
struct Toss {
    u_dot: f64,
    theta_dot: f64,
}

/// The block at the end of the push, in flight.
fn tossed(block: Block, toss: Toss) -> Simulation {
    let falling = held(0.0, -2.0 * G);
    let mut simulation = start(block, OnSeparation::Fly, Pulse::NONE, &Initial::default(), &falling);
    go(&mut simulation, TOSS, &falling);
    let push = Inputs {
        time: TOSS,
        a_gx: Ramp::held(-toss.u_dot / TOSS),
        m_y: Ramp::held(block.inertia() * toss.theta_dot / TOSS),
        ..Inputs::default()
    };
    assert!(go(&mut simulation, 2.0 * TOSS, &push).is_empty());
    simulation
}

fn velocities(x: &Observation<f64>) -> Velocities {
    Velocities { u_dot: x.u_dot, v_dot: x.v_dot, theta_dot: x.theta_dot }
}

/// Returns the first landing, velocities and rotation right before it, and the run right after.
fn first_landing(simulation: &Simulation) -> (Event, Velocities, f64, Simulation) {
    let before = seen(simulation);
    let mut until = simulation.clone();
    let mut events = Vec::new();
    while events.is_empty() {
        let next = until.time() + 0.01;
        events = go(&mut until, next, &Inputs::default());
    }
    let mut after = simulation.clone();
    assert_eq!(go(&mut after, events[0].time + 1e-12, &Inputs::default()).len(), 1);
    // Without inputs only the vertical velocity changes in flight.
    let elapsed = events[0].time - simulation.time();
    let landing = Velocities { v_dot: before.v_dot - G * elapsed, ..velocities(&before) };
    (events[0], landing, before.theta + before.theta_dot * elapsed, after)
}

/// Rule for the vertical rate of the corner after the landing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    /// ε times the landing rate, upwards.
    Epsilon,
    /// Less, because more would gain energy (T. R. Kane and D. A. Levinson, Dynamics, McGraw-Hill 1985: Newton's restitution
    /// together with friction can).
    Energy,
    /// More, because the horizontal stop alone throws the corner up.
    Thrown,
}

/// Solves a landing by hand.
///
/// Impulses J on the corner change its velocity c by W J, with the inverse W of its effective mass, and the energy by
/// `½ Jᵀ (c before + c after)`.
fn by_hand(block: &Block, corner: Corner, theta: f64, before: Velocities) -> (Velocities, Rule) {
    let s = corner.sign();
    let phi = block.alpha + s * theta;
    let (p, q) = (s * block.r0 * phi.sin(), block.r0 * phi.cos());
    let w = Matrix2::new(block.i0 + q * q, -p * q, -p * q, block.i0 + p * p) / block.i0;
    let c = Vector2::new(before.u_dot - q * before.theta_dot, before.v_dot + p * before.theta_dot);
    let impulse = |rate: f64| w.try_inverse().unwrap() * (Vector2::new(0.0, rate) - c);
    let gain = |rate: f64| 0.5 * impulse(rate).dot(&(Vector2::new(0.0, rate) + c));
    let newton = -block.epsilon * c.y;
    let (j, rule) = if impulse(newton).y < 0.0 {
        (Vector2::new(-c.x / w.m11, 0.0), Rule::Thrown)
    } else if gain(newton) > 0.0 {
        let (mut low, mut high) = (0.0, newton);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if gain(middle) > 0.0 { high = middle } else { low = middle }
        }
        (impulse(low), Rule::Energy)
    } else {
        (impulse(newton), Rule::Epsilon)
    };
    let after = Velocities {
        u_dot: before.u_dot + j.x,
        v_dot: before.v_dot + j.y,
        theta_dot: before.theta_dot + (p * j.y - q * j.x) / block.i0,
    };
    (after, rule)
}

#[test]
fn landings_of_a_corner_match_the_impulses() {
    let mut rules = Vec::new();
    for epsilon in [0.0, 0.5, 1.0] {
        for alpha in [0.3, 0.9] {
            for u_dot in [-4.0, -0.5, 0.5, 4.0] {
                for theta_dot in [-0.6, 0.1, 0.6] {
                    let block = block(alpha, 1.5, epsilon);
                    let simulation = tossed(block, Toss { u_dot, theta_dot });
                    let (event, before, theta, landed) = first_landing(&simulation);
                    let (counts, after) = (landed.counts(), seen(&landed));
                    let EventKind::Landing(corner) = event.kind else { panic!("{event}") };
                    let (exact, rule) = by_hand(&block, corner, theta, before);
                    let found = velocities(&after);
                    let size = before.kinetic(&block).sqrt();
                    for (found, exact) in [
                        (found.u_dot, exact.u_dot),
                        (found.v_dot, exact.v_dot),
                        (block.r0 * found.theta_dot, block.r0 * exact.theta_dot),
                    ] {
                        assert!((found - exact).abs() < 1e-9 * size, "{rule:?}, {event}: {after:?}, by hand {exact}");
                    }
                    assert!(found.kinetic(&block) <= before.kinetic(&block) * (1.0 + 1e-9), "{rule:?}, {event}");
                    // Both corners left when the ground fell; unless ε is zero, the corner leaves again.
                    let flies = after.regime == Regime::Separated;
                    assert_eq!([counts.impacts, counts.liftoffs], [1, 2 + u32::from(flies)], "{rule:?}, {event}");
                    if rule == Rule::Epsilon && epsilon == 0.0 {
                        // The corner stands on the base, and round-off does not lift it.
                        assert_eq!((after.regime, after.corner[corner.index()]), (Regime::on(corner), 0.0));
                    } else if rule == Rule::Epsilon {
                        assert_eq!(after.regime, Regime::Separated);
                    }
                    rules.push(rule);
                }
            }
        }
    }
    for rule in [Rule::Epsilon, Rule::Energy, Rule::Thrown] {
        let count = rules.iter().filter(|&&of| of == rule).count();
        assert!(count >= 4, "{count} of {} landings by {rule:?}", rules.len());
    }
}

/// A level block that lands while moving to the right stops if `h u̇ < b |v̇|`, and otherwise trips over its right corner.
///
/// Its left corner would have to be pulled then, so `(i0 + R0²) θ̇ = h u̇ − b |v̇|`.
#[test]
fn a_level_landing_stops_the_block_or_trips_it() {
    let block = block(0.4, 1.5, 0.0);
    for (u_dot, trips) in [(0.5, false), (-0.5, false), (2.0, true), (-2.0, true)] {
        let simulation = tossed(block, Toss { u_dot, theta_dot: 0.0 });
        let (event, before, theta, landed) = first_landing(&simulation);
        let after = seen(&landed);
        assert_eq!((event.before, theta), (Regime::Separated, 0.0));
        let turn = block.h * u_dot.abs() - block.b * before.v_dot.abs();
        assert_eq!(turn > 0.0, trips, "{before:?}");
        if trips {
            let regime = if u_dot > 0.0 { Regime::TiltingRight } else { Regime::TiltingLeft };
            assert_eq!(after.regime, regime, "{event}");
            let theta_dot = u_dot.signum() * turn / (block.i0 + block.r0 * block.r0);
            assert!((after.theta_dot / theta_dot - 1.0).abs() < 1e-9, "{after:?}, by hand {theta_dot}");
            assert!((after.u_dot / (block.h * theta_dot) - 1.0).abs() < 1e-9, "{after:?}");
        } else {
            assert_eq!((after.regime, after.theta_dot, after.u_dot, after.v_dot), (Regime::FullContact, 0.0, 0.0, 0.0));
            assert!(after.u.abs() > 0.01, "the block has moved: {after:?}");
        }
    }
}

/// An elastic landing of a turning block on both corners gains no energy.
///
/// Full rebounds of both corners together with the stop of the base's middle would gain some.
#[test]
fn a_level_landing_gains_no_energy() {
    let block = block(0.3, 1.0, 1.0);
    let system = System { block, flies: true };
    let excitation = Excitation::none();
    let pose = Pose {
        time: 0.0,
        state: State::from([0.0, 0.05, 0.0, -2.0]),
        contacts: Contacts::touching([false; 2], 0.0),
        footing: Footing::Free { u: 0.0, u_dot: 0.0 },
        restraints: States::NONE,
    };
    let at = |pose: &Pose| Motion::from_pose(&block, pose, &excitation).at(pose.time, pose.state);
    let before = at(&pose);
    let transition = system.transition(&pose, &before, EventFunction::Gap(Corner::Left));
    let after = at(&transition.pose);
    assert!(after.energy() <= before.energy() && after.energy() > 0.5 * before.energy(), "{after:?}");
}

/// A sliding corner grips if the horizontal impulse of the grip presses it onto the base.
#[test]
fn a_sliding_corner_grips_if_the_grip_presses_it_down() {
    let block = block(0.3, 1.0, 0.5);
    let system = System { block, flies: true };
    let excitation = Excitation::none();
    for (corner, side) in [(Corner::Right, 1.0), (Corner::Left, -1.0)] {
        let pose = Pose {
            time: 0.0,
            state: State::from([side * 0.1, side * -0.05, 0.0, 0.0]),
            contacts: Contacts::touching(Corner::BOTH.map(|of| of == corner), 0.0),
            footing: Footing::Free { u: side * 0.4, u_dot: side * 0.3 },
            restraints: States::NONE,
        };
        let at = |pose: &Pose| Motion::from_pose(&block, pose, &excitation).at(pose.time, pose.state);
        let before = at(&pose);
        let transition = system.transition(&pose, &before, EventFunction::GripPressure);
        let after = at(&transition.pose);
        assert_eq!((transition.event, after.regime), (Some(EventKind::Grip), Regime::on(corner)));
        // The impulse acts at the corner, r0 cos φ below the centre of mass.
        let height = block.r0 * (block.alpha - 0.1).cos();
        let x = &before.instant;
        let theta_dot = (block.i0 * x.theta_dot + height * x.u_dot
            - side * block.r0 * (block.alpha - 0.1).sin() * -x.v_dot)
            / (block.i0 + block.r0 * block.r0);
        assert!((after.instant.theta_dot - theta_dot).abs() < 1e-14, "{} by hand {theta_dot}", after.instant.theta_dot);
        assert!((after.instant.u - x.u).abs() < 1e-14 && (after.instant.u_dot - height * theta_dot).abs() < 1e-14);
    }
}
