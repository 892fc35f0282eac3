//! Impacts of a block with friction, as transitions of its pose, against their impulses.

use nalgebra::{Matrix2, Vector2};
use rocking_block::block::restraints::States;
use rocking_block::block::{Block, Common, Contacts, Corner, Foundation};
use rocking_block::excitation::{Excitation, Inputs, Pulse, Ramp};
use rocking_block::system::System;
use rocking_block::system::evaluation::Motion;
use rocking_block::system::events::{EventFunction, EventKind, Transition};
use rocking_block::system::impact::Velocities;
use rocking_block::system::instant::{Footing, Pose, State};

use crate::blocks;

const EPSILON: f64 = 0.3;

fn block(foundation: Foundation, friction: f64) -> Block {
    blocks::block_on(foundation, [0.5, 1.5, 50.0, 0.1], &Common { friction, epsilon: EPSILON, ..Common::default() })
}

/// The change of a pose that falls through a surface, with the velocities right after.
fn transition(block: &Block, pose: &Pose, function: EventFunction) -> (Transition, Velocities) {
    transition_under(Ramp::default(), block, pose, function)
}

/// The same under a ground acceleration.
fn transition_under(a_gx: Ramp, block: &Block, pose: &Pose, function: EventFunction) -> (Transition, Velocities) {
    let inputs = Inputs { a_gx, ..Inputs::default() };
    let excitation = Excitation::from_time(0.0, &inputs, &Pulse::NONE, block);
    let now = Motion::from_pose(block, pose, &excitation).at(pose.time, pose.state);
    let system = System { block: *block, flies: true };
    let after = system.transition(pose, &now, function);
    let instant = Motion::from_pose(block, &after.pose, &excitation).at(pose.time, after.pose.state).instant;
    (after, Velocities { u_dot: instant.u_dot, v_dot: instant.v_dot, theta_dot: instant.theta_dot })
}

#[track_caller]
fn near(block: &Block, found: Velocities, exact: Velocities, case: &str) {
    let pairs = [
        (found.u_dot, exact.u_dot),
        (found.v_dot, exact.v_dot),
        (block.r0 * found.theta_dot, block.r0 * exact.theta_dot),
    ];
    assert!(pairs.iter().all(|(found, exact)| (found - exact).abs() < 1e-12), "{case}: {found:?}, expected {exact:?}");
}

/// A block in flight whose left corner closes its gap, and its velocities.
fn falling(block: &Block, u_dot: f64) -> (Pose, Velocities) {
    let (theta, theta_dot, v_dot) = (-0.2, 0.1, -1.0);
    let free_height = match block.foundation {
        Foundation::Rigid => 0.0,
        Foundation::Viscoelastic => block.static_deflection(),
    };
    // Less the rise of L over that of the centre of mass, from rest.
    let v = free_height - (block.b * libm::sin(theta) + block.h * (1.0 - libm::cos(theta)));
    let pose = Pose {
        time: 0.0,
        state: State::from([theta, theta_dot, v, v_dot]),
        contacts: Contacts::touching([false; 2], 0.0),
        footing: Footing::Free { u: 0.0, u_dot },
        restraints: States::NONE,
    };
    (pose, Velocities { u_dot, v_dot, theta_dot })
}

/// The velocities after impulses at the left corner that leave it with a part of its vertical rate and, if μ times the vertical impulse
/// allows that, without a horizontal one; and whether it does.
fn landed(block: &Block, (pose, before): (Pose, Velocities), part: f64) -> (Velocities, bool) {
    let (sin, cos) = libm::sincos(block.alpha + pose.state[0]);
    let (across, height) = (block.r0 * sin, block.r0 * cos);
    let Velocities { u_dot, v_dot, theta_dot } = before;
    // Impulses change the velocity of the corner by W times them.
    let both = -across * height / block.i0;
    let w = Matrix2::new(1.0 + height * height / block.i0, both, both, 1.0 + across * across / block.i0);
    let before = Vector2::new(u_dot - height * theta_dot, v_dot + across * theta_dot);
    let rate = part * before.y;
    let stop = w.try_inverse().unwrap() * (Vector2::new(0.0, rate) - before);
    let stops = stop.x.abs() <= block.friction * stop.y;
    let impulse = if stops {
        stop
    } else {
        let push = block.friction * stop.x.signum();
        Vector2::new(push, 1.0) * ((rate - before.y) / (w.m21 * push + w.m22))
    };
    let after = Velocities {
        u_dot: u_dot + impulse.x,
        v_dot: v_dot + impulse.y,
        theta_dot: theta_dot + (across * impulse.y - height * impulse.x) / block.i0,
    };
    (after, stops)
}

/// A corner that comes down from flight rebounds from the rigid base with ε of its rate, and keeps ε of it on a support (17). It stops
/// horizontally if Coulomb's limit allows that, and otherwise feels the limit.
#[test]
fn a_corner_from_flight_stops_or_slides() {
    let (mut stopped, mut slid) = (0, 0);
    for (foundation, part) in [(Foundation::Rigid, -EPSILON), (Foundation::Viscoelastic, EPSILON)] {
        for friction in [0.05, 0.2, 0.5] {
            for u_dot in [-3.0, -0.5, -0.1, 0.1, 0.5, 3.0] {
                let block = block(foundation, friction);
                let falling = falling(&block, u_dot);
                let (exact, stops) = landed(&block, falling, part);
                if stops {
                    stopped += 1
                } else {
                    slid += 1
                }
                let case = format!("{foundation:?}, μ = {friction}, {u_dot} m/s");
                assert!(exact.kinetic(&block) <= falling.1.kinetic(&block), "{case}");
                let (after, found) = transition(&block, &falling.0, EventFunction::Gap(Corner::Left));
                near(&block, found, exact, &case);
                assert_eq!(after.event, Some(EventKind::Landing(Corner::Left)), "{case}");
                assert_eq!(after.counts.impacts, 1, "{case}");
            }
        }
    }
    assert!(stopped > 2 && slid > 2, "{stopped} stopped, {slid} slid");
}

/// Where friction turns a corner that comes down into the ground, ε of its rate would gain energy: it rebounds with as much of it as
/// keeps the energy.
#[test]
fn a_rebound_gains_no_energy() {
    let mut kept = 0;
    for friction in [0.2, 0.5, 1.0] {
        for u_dot in [-1.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 4.0] {
            let block = Block { epsilon: 1.0, ..block(Foundation::Rigid, friction) };
            let falling = falling(&block, u_dot);
            let (exact, _) = landed(&block, falling, -1.0);
            let (_, found) = transition(&block, &falling.0, EventFunction::Gap(Corner::Left));
            let case = format!("μ = {friction}, {u_dot} m/s: {found:?}");
            if exact.kinetic(&block) <= falling.1.kinetic(&block) {
                near(&block, found, exact, &case);
                continue;
            }
            kept += 1;
            let across = block.r0 * libm::sin(block.alpha + falling.0.state[0]);
            let rate = |of: Velocities| of.v_dot + across * of.theta_dot;
            let part = rate(found) / rate(falling.1);
            assert!(-1.0 < part && part < 0.0, "{part}, {case}");
            assert!((found.kinetic(&block) / falling.1.kinetic(&block) - 1.0).abs() < 1e-12, "{case}");
            near(&block, found, landed(&block, falling, part).0, &case);
        }
    }
    assert!(kept > 2, "{kept} rebounds kept their energy");
}

/// Where a sliding block changes its pivot, e determines the vertical impulse, and μ times it slows the new pivot. A change that would
/// gain energy keeps it, with less than e.
#[test]
fn a_sliding_block_changes_its_pivot() {
    let mut kept = 0;
    for (friction, epsilon) in [(0.05, 0.0), (0.3, 0.0), (0.6, 0.0), (0.3, 0.9), (0.6, 0.9)] {
        for slip in [-4.0, -2.0, -0.4, -0.02, 0.02, 0.2, 0.4, 0.6, 2.0, 4.0] {
            let block = Block { epsilon, ..block(Foundation::Rigid, friction) };
            let theta_dot = -0.4;
            let u_dot = block.h * theta_dot + slip;
            let pose = Pose {
                time: 0.0,
                state: State::from([0.0, theta_dot, 0.0, 0.0]),
                contacts: Contacts::touching([false, true], 0.0),
                footing: Footing::Slides { u: 0.0, u_dot, direction: slip.signum() },
                restraints: States::NONE,
            };
            // The block turns about R before and about L after: v̇ = b θ̇, then −b θ̇.
            let before = Velocities { u_dot, v_dot: block.b * theta_dot, theta_dot };
            let changed = |theta_dot: f64| {
                let v_dot = -block.b * theta_dot;
                let most = friction * (v_dot - before.v_dot);
                let wanted = block.h * theta_dot - u_dot;
                (Velocities { u_dot: u_dot + wanted.clamp(-most, most), v_dot, theta_dot }, wanted.abs() <= most)
            };
            // Housner's with ε = 0.
            let e = 1.0 - (1.0 - epsilon) * 2.0 * block.b * block.b / (block.i0 + block.r0 * block.r0);
            let (exact, stops) = changed(e * theta_dot);
            let case = format!("μ = {friction}, ε = {epsilon}, {slip} m/s");
            let (after, found) = transition(&block, &pose, EventFunction::Gap(Corner::Left));
            if exact.kinetic(&block) <= before.kinetic(&block) {
                near(&block, found, exact, &case);
                // A pivot that stops may still slide on under the weight of the block.
                assert!(stops || !after.pose.footing.grips(), "{case}");
            } else {
                kept += 1;
                let energy = found.kinetic(&block) / before.kinetic(&block);
                assert!((energy - 1.0).abs() < 1e-12 && found.theta_dot / theta_dot < e, "{case}: {energy}");
                near(&block, found, changed(found.theta_dot).0, &case);
            }
            assert_eq!([after.counts.impacts, after.counts.liftoffs], [1, 1], "{case}");
        }
    }
    assert!(kept > 2, "{kept} changes kept their energy");
}

/// A block that lands level on its supports from flight, without rotation, keeps a part of its speed: μ times the vertical impulse stops
/// the rest.
#[test]
fn a_level_landing_takes_what_friction_allows() {
    // Above tan α = 0.546 friction would pull at a corner, which stays up.
    for friction in [0.1, 0.4] {
        for u_dot in [-2.0, 2.0] {
            let block = block(Foundation::Viscoelastic, friction);
            let v_dot = -1.5;
            let pose = Pose {
                time: 0.0,
                state: State::from([0.0, 0.0, block.static_deflection(), v_dot]),
                contacts: Contacts::touching([false; 2], 0.0),
                footing: Footing::Free { u: 0.0, u_dot },
                restraints: States::NONE,
            };
            let (after, found) = transition(&block, &pose, EventFunction::Gap(Corner::Left));
            assert_eq!(after.counts.impacts, 2);
            // ε of the rate remains, downwards, as in (17); both supports push with the same impulse.
            let vertical = (EPSILON - 1.0) * v_dot;
            let exact = Velocities {
                u_dot: u_dot - u_dot.signum() * friction * vertical,
                v_dot: EPSILON * v_dot,
                theta_dot: found.theta_dot,
            };
            near(&block, found, exact, &format!("μ = {friction}, {u_dot} m/s"));
            assert!(matches!(after.pose.footing, Footing::Slides { direction, .. } if direction == u_dot.signum()));
        }
    }
}

/// A foot that stops grips if `|H| ≤ μ M g` holds it; at exactly that, if H does not grow. Otherwise the foot turns, against the ground.
/// On supports the block gives way to H by a rotation.
#[test]
fn a_foot_that_stops_grips_or_turns() {
    for foundation in [Foundation::Rigid, Foundation::Viscoelastic] {
        let block = block(foundation, 0.25);
        let gives_way = match foundation {
            Foundation::Rigid => 0.0,
            Foundation::Viscoelastic => block.h * block.h / block.i0,
        };
        let limit = block.friction * block.gravity * (1.0 + gives_way);
        // The rotation alone makes H grow.
        let at_limit = if foundation == Foundation::Rigid { 1.0 } else { 0.999 };
        for (part, growth, turns) in [
            (0.0, 0.0, false),
            (0.9, 5.0, false),
            (at_limit, -5.0, false),
            (at_limit, 0.0, false),
            (at_limit, 5.0, at_limit == 1.0),
            (1.1, 5.0, true),
            (1.1, 0.0, true),
            (1.1, -5.0, true),
        ] {
            for side in [-1.0, 1.0] {
                let a_gx = Ramp { value: side * part * limit, rate: side * growth };
                let pose = Pose {
                    time: 0.0,
                    state: State::zeros(),
                    contacts: Contacts::FULL,
                    footing: Footing::Slides { u: 0.2, u_dot: 0.0, direction: side },
                    restraints: States::NONE,
                };
                let (after, _) = transition_under(a_gx, &block, &pose, EventFunction::Speed);
                let case = format!("{foundation:?}, {a_gx:?}: {after:?}");
                assert_eq!(after.event, Some(if turns { EventKind::Slip } else { EventKind::Grip }), "{case}");
                match after.pose.footing {
                    Footing::Slides { direction, .. } => assert!(turns && direction == -side, "{case}"),
                    Footing::Grips { offset } => assert!(!turns && (offset - 0.2).abs() < 1e-15, "{case}"),
                    Footing::Free { .. } => panic!("{case}"),
                }
            }
        }
    }
}

/// Friction takes its limit times the speed of the foot.
#[test]
fn friction_takes_its_limit_times_the_speed() {
    for foundation in [Foundation::Rigid, Foundation::Viscoelastic] {
        for direction in [-1.0, 1.0] {
            let block = block(foundation, 0.25);
            let excitation = Excitation::from_time(0.0, &Inputs::default(), &Pulse::NONE, &block);
            let pose = Pose {
                time: 0.0,
                state: State::zeros(),
                contacts: Contacts::FULL,
                footing: Footing::Slides { u: 0.2, u_dot: 3.0 * direction, direction },
                restraints: States::NONE,
            };
            let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
            let [taken, ..] = now.dissipated();
            assert!((taken - 0.25 * block.gravity * 3.0).abs() < 1e-12, "{foundation:?}, {direction}: {taken}");
        }
    }
}
