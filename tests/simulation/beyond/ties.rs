//! Ties: an elastic tendon through the middle of a rigid base, and ties that break simultaneously.

use rocking_block::block::restraints::{LinkKind, RestraintEvent, Tie, TieState, tie::TieEvent};
use rocking_block::block::{Block, Body, Common, Corner, Foundation, Regime};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::EventKind;

use crate::blocks::{block, block_on};

/// Returns a block with a tendon through the middle of its base, guided at the ground, with a stiffness k b / (M g) of `stiffness` and
/// a pretension T0/(M g).
fn with_tendon(foundation: Foundation, stiffness: f64, pretension: f64) -> Block {
    let block = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
    let weight = block.mass * block.gravity;
    let tendon = Tie {
        // The length at rest is negligible, but gives a direction.
        ground: [0.0, -1e-12],
        stiffness: stiffness * weight / block.b,
        pretension: pretension * weight,
        ..Tie::default()
    };
    block.with_ties(&[tendon]).unwrap()
}

fn released(block: Block, theta: f64) -> Simulation {
    let settings = Settings { tolerance: 1e-12, ..Settings::default() };
    let initial = Initial { theta, ..Initial::default() };
    Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default())
}

/// The equation of Vassiliou and Makris (2015, 10.1061/(ASCE)EM.1943-7889.0000953) on a rigid base: weight and tendon turn the block
/// back, with the tendon's elongation `2 b sin(θ/2)` on the arm `b cos(θ/2)`.
fn angular_acceleration(block: &Block, theta: f64) -> f64 {
    let Block { alpha, body: Body { mass, gravity, r0, b, i0, .. }, .. } = *block;
    let tie = block.ties()[0];
    let tension = tie.pretension + tie.stiffness * 2.0 * b * libm::sin(0.5 * theta);
    -(gravity * r0 * libm::sin(alpha - theta) + tension / mass * b * libm::cos(0.5 * theta)) / (i0 + r0 * r0)
}

/// A released block with a tendon follows this equation, integrated by the classical Runge–Kutta method, until its first impact.
#[test]
fn a_tendon_through_the_base() {
    for (stiffness, pretension) in [(0.0, 0.1), (0.5, 0.0), (2.0, 0.05), (8.0, 0.3)] {
        let block = with_tendon(Foundation::Rigid, f64::max(stiffness, 1e-9), pretension);
        let mut simulation = released(block, 0.15);
        let (step, mut x) = (2e-5, [0.15, 0.0]);
        for i in 1.. {
            let f = |x: [f64; 2]| [x[1], angular_acceleration(&block, x[0])];
            let at = |k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
            let k1 = f(x);
            let k2 = f(at(k1, 0.5 * step));
            let k3 = f(at(k2, 0.5 * step));
            let k4 = f(at(k3, step));
            x = [0, 1].map(|j| x[j] + step / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
            if x[0] < 1e-4 {
                break;
            }
            if i % 500 == 0 {
                simulation.advance(step * f64::from(i), &Inputs::default(), &mut |_| ()).unwrap();
                let seen = simulation.observe(&Inputs::default());
                assert!(
                    (seen.theta - x[0]).abs() < 1e-8 && (seen.theta_dot - x[1]).abs() < 1e-8,
                    "{seen:?}, not {x:?}"
                );
            }
        }
    }
}

/// A quarter of the rocking period of the same block, from the energy by Gauss's rule.
#[test]
fn the_rocking_period_with_a_tendon() {
    let block = with_tendon(Foundation::Rigid, 1.5, 0.1);
    let (from, tie) = (0.12, block.ties()[0]);
    let Block { alpha, body: Body { mass, gravity, r0, b, i0, .. }, .. } = block;
    // Potential energy over the inertia about the corner.
    let potential = |theta: f64| {
        let s = 2.0 * b * libm::sin(0.5 * theta);
        let weight = gravity * r0 * (libm::cos(alpha - theta) - libm::cos(alpha));
        (weight + (tie.pretension * s + 0.5 * tie.stiffness * s * s) / mass) / (i0 + r0 * r0)
    };
    // With θ = from (1 − y²) the integrand is smooth.
    let pieces = 400_u32;
    let nodes = [-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683, 0.906179845938664];
    let weights = [0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366, 0.236926885056189];
    let half = 0.5 / f64::from(pieces);
    let mut quarter = 0.0;
    for piece in 0..pieces {
        for (node, weight) in nodes.into_iter().zip(weights) {
            let y = half * (f64::from(2 * piece) + 1.0 + node);
            let speed = (2.0 * (potential(from) - potential(from * (1.0 - y * y)))).sqrt();
            quarter += half * weight * 2.0 * from * y / speed;
        }
    }
    let mut first = None;
    released(block, from)
        .advance(10.0, &Inputs::default(), &mut |event| {
            first = first.or(matches!(event.kind, EventKind::Landing(_)).then_some(event.time));
        })
        .unwrap();
    let first = first.unwrap();
    assert!((first - quarter).abs() < 1e-8, "{first} s, not {quarter} s");
}

/// The arcs of a tied block become lower than the round-off of the tie's stretch, and each impact takes its part of the speed
/// until the last: `θ̇ → e θ̇`, and no arc adds any.
#[test]
fn each_impact_of_a_tied_block_takes_its_part() {
    let block = block_on(Foundation::Rigid, [0.2, 1.0, 60.0, 0.1], &Common::default());
    let Block { alpha, body: Body { mass, gravity, r0, p, b, h, .. }, .. } = block;
    let tie =
        Tie { block: [0.0, 1.33 * h], ground: [-5.5 * b, 0.0], stiffness: 9.4 * mass * gravity / r0, ..Tie::default() };
    let mut simulation = released(block.with_ties(&[tie]).unwrap(), -0.02);
    simulation.advance(60.0, &Inputs::default(), &mut |_| ()).unwrap();
    let first = p * (2.0 * (libm::cos(alpha - 0.02) - libm::cos(alpha))).sqrt();
    let expected = (libm::log(first / (1e-9 * p)) / -libm::log(block.restitution())).ceil();
    assert_eq!(f64::from(simulation.counts().impacts), expected);
}

/// Two equal ties at one place are one of twice the stiffness, and break in one instant.
#[test]
fn two_ties_that_break_at_once() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let block = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let weight = block.mass * block.gravity;
        let tie = |stiffness: f64, strength: f64| Tie {
            block: [-block.b, block.h],
            ground: [-3.0 * block.b, 0.0],
            stiffness: stiffness * weight,
            slack: 0.01,
            damping: 0.01 * weight,
            strength: strength * weight,
            ..Tie::default()
        };
        let run = |ties: &[Tie]| {
            let initial = Initial { theta_dot: 0.25, ..Initial::default() };
            let settings = Settings { tolerance: 1e-10, ..Settings::default() };
            let block = block.with_ties(ties).unwrap();
            let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
            let mut broken = vec![];
            simulation
                .advance(1.5, &Inputs::default(), &mut |event| {
                    if let EventKind::Restraint(RestraintEvent::Tie(_, _, TieEvent::Break)) = event.kind {
                        broken.push(event.time);
                    }
                })
                .unwrap();
            (simulation, broken)
        };
        let (two, broken) = run(&[tie(0.5, 0.02), tie(0.5, 0.02)]);
        let (one, alone) = run(&[Tie { damping: 0.02 * weight, ..tie(1.0, 0.04) }]);
        assert_eq!((broken.len(), alone.len()), (2, 1));
        assert!(broken[1] - broken[0] < 1e-9 && (broken[0] - alone[0]).abs() < 1e-8, "{broken:?} {alone:?}");
        assert_eq!(two.restraints().ties[..2], [TieState::Broken; 2]);
        let [two, one] = [two, one].map(|simulation| simulation.observe(&Inputs::default()).theta);
        assert!((two - one).abs() < 1e-8, "{two} {one}");
    }
}

/// An impact turns the velocity of a tendon's dashpot, whose force then exceeds the strength in that instant.
#[test]
fn an_impact_that_breaks_a_tendon() {
    let plain = block_on(Foundation::Rigid, [0.2, 1.5, 60.0, 0.1], &Common::default());
    let weight = plain.mass * plain.gravity;
    // The pretension changes little with the elongation; the dashpot adds some tenths of the weight at the impact.
    let tendon = Tie {
        ground: [0.0, -1.0],
        stiffness: 1e-3 * weight / plain.b,
        pretension: 0.4 * weight,
        damping: weight / (plain.b * plain.p),
        ..Tie::default()
    };
    for (strength, breaks) in [(0.45, true), (0.8, false)] {
        let block = plain.with_ties(&[Tie { strength: strength * weight, ..tendon }]).unwrap();
        let mut events = vec![];
        let mut simulation = released(block, 0.15);
        simulation.advance(1.5, &Inputs::default(), &mut |event| events.push(*event)).unwrap();
        let impact = events.iter().find(|event| matches!(event.kind, EventKind::Landing(_))).unwrap().time;
        let broken: Vec<f64> = events
            .iter()
            .filter(|event| event.kind == EventKind::Restraint(RestraintEvent::Tie(LinkKind::Tie, 0, TieEvent::Break)))
            .map(|event| event.time)
            .collect();
        assert_eq!(broken, if breaks { vec![impact] } else { vec![] }, "{events:?}");
        let peak = simulation.peaks().pull[0] / weight;
        assert!(if breaks { peak == strength } else { peak < strength && peak > 0.45 }, "{peak} M g");
    }
}

/// A tie whose dashpot exceeds its strength where it snaps taut breaks in that instant, and the block goes on as if it had no tie.
#[test]
fn a_tie_that_snaps_taut_too_fast_breaks_at_once() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let weight = plain.mass * plain.gravity;
        let tie = Tie {
            block: [-plain.b, plain.h],
            ground: [-3.0 * plain.b, 0.0],
            stiffness: weight,
            slack: 0.01,
            damping: weight,
            ..Tie::default()
        };
        let run = |ties: &[Tie]| {
            let (mut events, settings) = (vec![], Settings { tolerance: 1e-12, ..Settings::default() });
            let initial = Initial { theta_dot: 0.25, ..Initial::default() };
            let block = plain.with_ties(ties).unwrap();
            let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
            simulation.advance(0.6, &Inputs::default(), &mut |event| events.push((event.kind, event.time))).unwrap();
            events.retain(|(kind, _)| matches!(kind, EventKind::Restraint(_)));
            (simulation.observe(&Inputs::default()).theta, events)
        };
        let (untied, _) = run(&[]);
        let (theta, events) = run(&[Tie { strength: 0.01 * weight, ..tie }]);
        let [
            (EventKind::Restraint(RestraintEvent::Tie(LinkKind::Tie, 0, TieEvent::Taut)), taut),
            (EventKind::Restraint(RestraintEvent::Tie(LinkKind::Tie, 0, TieEvent::Break)), broken),
        ] = events[..]
        else {
            panic!("{events:?}")
        };
        assert_eq!(taut, broken);
        assert!((theta - untied).abs() < 1e-9, "{theta}, untied {untied}");
        let (held, events) = run(&[Tie { strength: weight, ..tie }]);
        assert!(
            matches!(
                events[..],
                [(EventKind::Restraint(RestraintEvent::Tie(LinkKind::Tie, 0, TieEvent::Taut)), _), ..]
            ) && held < 0.9 * untied,
            "{held}: {events:?}"
        );
    }
}

/// A tie at the centre of mass whose pretension is `k L` pulls with `k` times its length: in flight the centre of mass moves
/// harmonically, and the rotation is uniform.
#[test]
fn a_tied_flight_is_harmonic() {
    let plain = block([0.2, 1.5, 60.0, 0.1], &Common::default());
    let Body { mass, gravity, h, .. } = plain.body;
    let (omega, reach): (f64, [f64; 2]) = (1.3, [1.1, -0.4]);
    let stiffness = mass * omega * omega;
    let tie = Tie {
        block: [0.0, h],
        ground: [reach[0], h + reach[1]],
        stiffness,
        pretension: stiffness * reach[0].hypot(reach[1]),
        ..Tie::default()
    };
    let (theta, theta_dot, v, v_dot) = (0.03, -0.12, 0.9, 2.0);
    let settings = Settings { tolerance: 1e-12, on_separation: OnSeparation::Fly, ..Settings::default() };
    let initial = Initial { theta, theta_dot, vertical: Some((v, v_dot)) };
    let block = plain.with_ties(&[tie]).unwrap();
    let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
    let (u, u_dot) = (h * libm::sin(theta), h * libm::cos(theta) * theta_dot);
    let balance = [reach[0], reach[1] - gravity / (omega * omega)];
    for i in 1..=10 {
        let time = 0.05 * f64::from(i);
        simulation.advance(time, &Inputs::default(), &mut |event| panic!("{event}")).unwrap();
        let seen = simulation.observe(&Inputs::default());
        let (sin, cos) = libm::sincos(omega * time);
        let at = |from: f64, rate: f64, middle: f64| middle + (from - middle) * cos + rate / omega * sin;
        let exact = [at(u, u_dot, balance[0]), at(v, v_dot, balance[1]), theta + theta_dot * time];
        let found = [seen.u, seen.v, seen.theta];
        assert!(found.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-9), "{found:?}, not {exact:?}");
    }
}

/// The slip of a flight counts when the foot lands, not at an event on the way, such as a tie that becomes taut.
#[test]
fn a_tie_that_is_taut_in_flight_moves_no_foot() {
    let plain = block([0.2, 1.5, 60.0, 0.1], &Common::default());
    let Body { mass, gravity, h, .. } = plain.body;
    let tie = Tie { block: [0.0, h], ground: [0.0, -h], stiffness: mass * gravity, slack: 1.0, ..Tie::default() };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let initial = Initial { theta: 0.1, theta_dot: -2.0, vertical: Some((0.9, 2.0)) };
    let block = plain.with_ties(&[tie]).unwrap();
    let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
    let mut events = 0;
    simulation.advance(0.2, &Inputs::default(), &mut |_| events += 1).unwrap();
    let seen = simulation.observe(&Inputs::default());
    assert_eq!((events, seen.regime), (1, Regime::Separated), "{seen:?}");
    assert!((seen.u - h * libm::sin(seen.theta)).abs() > 1e-3 * h, "the base has not moved: {seen:?}");
    assert_eq!(simulation.slip().now, 0.0);
}

/// A block that is held down at rest sinks as far as its supports yield to weight and pretension, and stays.
#[test]
fn a_pretensioned_block_rests() {
    let plain = block([0.2, 1.5, 60.0, 0.1], &Common::default());
    let weight = plain.mass * plain.gravity;
    let tendon =
        Tie { ground: [0.0, -3.0], stiffness: 2.0 * weight / plain.b, pretension: 0.5 * weight, ..Tie::default() };
    let mut simulation = released(plain.with_ties(&[tendon]).unwrap(), 0.0);
    let seen = simulation.observe(&Inputs::default());
    let pull = seen.restraints[0].pull;
    assert!((seen.reaction[0] + seen.reaction[1] - weight - pull).abs() < 1e-9 * weight, "{seen:?}");
    assert!(pull < 0.5 * weight && pull > 0.4 * weight, "{pull}");
    simulation.advance(10.0, &Inputs::default(), &mut |event| panic!("{event}")).unwrap();
    let after = simulation.observe(&Inputs::default());
    assert!((after.v - seen.v).abs() < 1e-12 && after.theta == 0.0, "{after:?}");
}

/// A block between two anchors lands on a support that has recovered, and lifts from it at once: the impulse that then stops
/// the other corner does not press it down, but leaves it where it is, once.
#[test]
fn a_corner_that_lands_and_lifts_at_once_is_not_pressed_down() {
    let (width, height, mass) = (0.320675, 0.7366, 100.0);
    let (alpha, p) = (libm::atan(width / height), (1.5 * 9.81 / libm::hypot(width, height)).sqrt());
    let strength = mass * 9.81;
    let anchor = |side: f64| Tie {
        block: [0.5 * side * width, height],
        ground: [side * (0.5 * width + 0.1), height],
        stiffness: strength / 0.005,
        strength,
        ..Tie::default()
    };
    let block = block([alpha, p, 50.0, 0.1], &Common { mass, ..Common::default() });
    let block = block.with_ties(&[anchor(-1.0), anchor(1.0)]).unwrap();
    let vertical = Some((5.7088788015638995e-5, -1.064741407632476e-2));
    let initial = Initial { theta: 1.3191414167749134e-3, theta_dot: -2.083400578671516e-3, vertical };
    let inputs = Inputs {
        time: 8.755,
        a_gx: Ramp { value: -9.533410504893904, rate: -216.07096697006946 },
        ..Inputs::default()
    };
    let mut simulation = Simulation::new(
        block,
        Settings { tolerance: 1e-6, ..Settings::default() },
        Pulse::NONE,
        &initial,
        8.755,
        &inputs,
    );
    let mut landed = simulation.clone();
    assert!(landed.advance_to_event(8.76, 8.755, &inputs, &mut |_| ()).unwrap().is_none());
    landed.apply_pending_event(&inputs, &mut |_| ()).unwrap();
    let seen = landed.observe(&inputs);
    let arm = 0.5 * (width * libm::cos(seen.theta) + height * libm::sin(seen.theta));
    let rate = seen.v_dot + arm * seen.theta_dot;
    assert!(rate.abs() < 1e-12, "L moves with {rate} m/s");
    let mut events = Vec::new();
    simulation.advance(8.76, &inputs, &mut |event| events.push(event.kind)).unwrap();
    assert_eq!(events, [EventKind::Landing(Corner::Left)]);
    assert!(simulation.observe(&inputs).uplift[0] > 0.0);
}
