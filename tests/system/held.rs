//! Held corners: full contact would lift them, and the other regime would press them back at once.

use std::f64::consts::TAU;

use nalgebra::{Matrix4, Vector4};
use rocking_block::block::restraints::States;
use rocking_block::block::{
    Block, Body, Common, Contact, Contacts, Corner, Creep, Dimensionless, Ratios, Regime, StandingSlide, Supports,
};
use rocking_block::excitation::{Excitation, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::System;
use rocking_block::system::dynamics::instant;
use rocking_block::system::evaluation::Motion;
use rocking_block::system::events::Transition;
use rocking_block::system::events::{Event, EventFunction, EventKind};
use rocking_block::system::impact;
use rocking_block::system::instant::{Footing, Instant, Pose, State};

use crate::blocks::squat;

/// Returns a short push that unloads L for a moment after it.
fn pulse(amplitude: f64) -> Pulse {
    Pulse { shape: PulseShape::OneSine, amplitude, period: 0.6 * TAU / 8.0, start: 0.0, ..Pulse::NONE }
}

fn start(pulse: Pulse) -> Simulation {
    let settings = Settings { tolerance: 1e-12, ..Settings::default() };
    Simulation::new(squat(&Common::default()), settings, pulse, &Initial::default(), 0.0, &Inputs::default())
}

/// Returns the acceleration (m/s²) of the gap if L left its support now, by Newton's and Euler's equations.
///
/// It is the acceleration of L with the block on R alone, minus that of the top of the recovering support.
fn opening(block: &Block, seen: &Observation<f64>, a_gx: f64) -> f64 {
    let Block { stiffness, damping, body: Body { b, h, i0, mass, gravity, .. }, .. } = *block;
    let (sin, cos) = seen.theta.sin_cos();
    let [left, right] = [-b, b].map(|x| [x * cos - h * sin, -x * sin - h * cos]);
    let rates = [left, right].map(|[x, _]| seen.v_dot - x * seen.theta_dot);
    let n = (0.5 * mass * gravity - stiffness * seen.corner[1] - damping * rates[1]) / mass;
    let turning = seen.theta_dot * seen.theta_dot;
    // ẍ, z̈, θ̈ and H/M; R does not move horizontally.
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        1.0, 0.0, 0.0, -1.0,
        0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, i0, -right[1],
        1.0, 0.0, right[1], 0.0,
    );
    let forces = Vector4::new(-a_gx, n - gravity, -right[0] * n, right[0] * turning);
    let x = matrix.lu().solve(&forces).unwrap();
    let corner = x[1] - left[0] * x[2] - left[1] * turning;
    // C ẏ = K (δ_s − y), and initially ẏ is the rate of the corner.
    corner + stiffness / damping * rates[0]
}

/// Returns the distance of L to the left of the centre of mass (m).
fn corner_arm(block: &Block, theta: f64) -> f64 {
    block.b * theta.cos() + block.h * theta.sin()
}

/// Returns N_L over the weight, and the acceleration at which the gap of L would open.
fn reaction_and_opening(simulation: &Simulation, inputs: &Inputs, pulse: &Pulse) -> (f64, f64) {
    let (block, seen) = (simulation.block(), simulation.observe(inputs));
    let a_gx = pulse.acceleration(simulation.time()) + inputs.a_gx.value;
    (seen.reaction[0] / (block.mass * block.gravity), opening(block, &seen, a_gx))
}

/// The strongest push for which the gap does not open when L bears no load.
const HELD: f64 = 13.140_26;

/// A corner that the other regime would press back moves with its support, without load or event, until it bears load again.
#[test]
fn a_corner_that_would_be_pressed_back_is_held() {
    let (pulse, inputs) = (pulse(HELD), Inputs::default());
    let mut simulation = start(pulse);
    let mut held = Vec::new();
    for i in 1..=8000 {
        let mut none = |event: &Event| panic!("{event}");
        simulation.advance(1e-4 * f64::from(i), &inputs, &mut none).unwrap();
        let (n, opening) = reaction_and_opening(&simulation, &inputs, &pulse);
        assert!(n >= 0.0, "N_L = {n} M g");
        if n == 0.0 {
            let (block, seen) = (simulation.block(), simulation.observe(&inputs));
            let free = block.static_deflection();
            let creeps = (seen.v_dot + corner_arm(block, seen.theta) * seen.theta_dot)
                - block.creep_rate * (free - seen.corner[0]);
            held.push((opening, creeps));
        }
    }
    assert_eq!(simulation.regime(), Regime::FullContact);
    assert!((5..40).contains(&held.len()), "{held:?}");
    for (opening, creeps) in held {
        assert!(opening < 0.0, "the gap would open with {opening} m/s2");
        assert!(creeps.abs() < 1e-12, "L is faster than its support by {creeps} m/s");
    }
    assert!(reaction_and_opening(&simulation, &inputs, &pulse).0 > 0.1);
    // The balance closes by the energy of the changing constraint, which is the only one lost or gained: nothing landed.
    let energies = simulation.energies();
    assert!((energies.impacts + energies.constraint).abs() < 1e-9 * energies.constraint.abs(), "{energies:?}");
    assert!(energies.residual.abs() < 1e-10 * energies.input.abs(), "{energies:?}");
}

/// The derivatives of outputs with respect to the ground acceleration are differences while a corner is held, too.
#[test]
fn derivatives_with_a_held_corner_are_differences() {
    let mut simulation = start(pulse(HELD));
    simulation.advance(0.4003, &Inputs::default(), &mut |event| panic!("{event}")).unwrap();
    let push = |a_gx: f64| Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
    assert_eq!(simulation.observe(&push(0.0)).reaction[0], 0.0);
    let found = simulation.observe_direction(&push(0.0), &push(1.0), 0.0);
    let [before, after] = [-1e-4, 1e-4].map(|a_gx| simulation.observe(&push(a_gx)));
    let of = |seen: &Observation<f64>| [seen.theta_ddot, seen.v_ddot, seen.u_ddot, seen.horizontal, seen.reaction[1]];
    let found = of(&found.map(|x| x.eps));
    for (found, (after, before)) in found.into_iter().zip(of(&after).into_iter().zip(of(&before))) {
        let expected = (after - before) / 2e-4;
        assert!((found - expected).abs() < 1e-6 * expected.abs().max(1e-3), "{found}, not {expected}");
    }
}

/// Under a slightly stronger push the gap opens, and L lifts when its reaction falls to zero.
#[test]
fn a_corner_whose_gap_opens_lifts() {
    let (pulse, inputs) = (pulse(HELD + 5e-5), Inputs::default());
    let mut first = None;
    start(pulse).advance(0.8, &inputs, &mut |event| first = first.or(Some(*event))).unwrap();
    let event = first.expect("an event");
    assert_eq!((event.kind, event.after), (EventKind::LiftOff(Corner::Left), Regime::TiltingRight));
    let mut before = start(pulse);
    before.advance(event.time - 1e-9, &inputs, &mut |event| panic!("{event}")).unwrap();
    let (n, opening) = reaction_and_opening(&before, &inputs, &pulse);
    assert!((0.0..1e-8).contains(&n) && (0.0..0.01).contains(&opening), "N_L = {n} M g, opens with {opening} m/s2");
}

/// A held corner that bears load again lifts when its reaction falls to zero.
#[test]
fn a_corner_that_bears_load_again_is_no_longer_held() {
    let pulse = pulse(HELD);
    let mut simulation = start(pulse);
    simulation.advance(0.8, &Inputs::default(), &mut |event| panic!("{event}")).unwrap();
    let inputs = Inputs { time: 0.8, a_gx: Ramp { value: 0.0, rate: -50.0 }, ..Inputs::default() };
    let mut first = None;
    simulation.clone().advance(1.2, &inputs, &mut |event| first = first.or(Some(*event))).unwrap();
    let event = first.expect("an event");
    assert_eq!(event.kind, EventKind::LiftOff(Corner::Left));
    simulation.advance(event.time - 1e-9, &inputs, &mut |event| panic!("{event}")).unwrap();
    let n =
        simulation.observe(&inputs).reaction[0] / (squat(&Common::default()).mass * squat(&Common::default()).gravity);
    assert!((0.0..1e-7).contains(&n), "N_L = {n} M g");
}

/// Ground motion that opens the gap of a held corner lifts it at once; the opposite motion presses it down.
#[test]
fn a_held_corner_lifts_when_its_gap_opens() {
    let pulse = pulse(HELD);
    for (a_gx, lifts) in [(-1.0, true), (1.0, false)] {
        let mut simulation = start(pulse);
        let mut none = |event: &Event| panic!("{event}");
        simulation.advance(0.4003, &Inputs::default(), &mut none).unwrap();
        let inputs = Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
        let (n, opening) = reaction_and_opening(&simulation, &inputs, &pulse);
        assert!(n == 0.0 && (opening > 0.0) == lifts, "N_L = {n} M g, opens with {opening} m/s2 at {a_gx} m/s2");
        let mut events = Vec::new();
        simulation.advance(0.41, &inputs, &mut |event| events.push(*event)).unwrap();
        if lifts {
            let Some(Event { time, kind: EventKind::LiftOff(Corner::Left), .. }) = events.first() else {
                panic!("{events:?}")
            };
            assert!((time - 0.4003).abs() < 1e-12, "{time}");
        } else {
            assert!(events.is_empty(), "{events:?}");
        }
    }
}

/// A corner that lands without rebound on a support at free height stays or lifts by its acceleration in full contact.
#[test]
fn the_acceleration_decides_whether_a_landed_corner_stays() {
    let mut became = [0; 2];
    for xi_v in [0.0, 0.3] {
        let dimensionless =
            Dimensionless { alpha: 0.9, p: 1.0, supports: Supports::Viscoelastic(Ratios { eta: 8.0, xi_v }) };
        let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
        let system = System { block, flies: false };
        let free = block.static_deflection();
        let pose = Pose {
            time: 0.0,
            state: State::from([libm::asin(free / block.b), -0.4, -free, 0.1]),
            contacts: Contacts::touching([false, true], 0.0),
            footing: Footing::AT_START,
            restraints: States::NONE,
        };
        for i in -400..400 {
            let inputs = Inputs { a_gx: Ramp::held(0.05 * f64::from(i)), ..Inputs::default() };
            let excitation = Excitation::from_time(0.0, &inputs, &Pulse::NONE, &block);
            let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
            let theta = now.instant.theta;
            let (v_dot, theta_dot) =
                impact::landing(&block, Corner::Left, theta, now.instant.v_dot, now.instant.theta_dot);
            let [left, right] = Corner::BOTH.map(|corner| impact::corner_rate(&block, corner, theta, v_dot, theta_dot));
            let state = [theta, theta_dot, 0.0, 0.5 * (left + right)];
            let x = instant(&block, Regime::FullContact, state, pose.footing, now.forcing);
            let lifts = x.corner_ddot[Corner::Left.index()] > 0.0;
            let Transition { pose: after, event, counts, .. } =
                system.transition(&pose, &now, EventFunction::Gap(Corner::Left));
            assert_eq!(
                after.contacts.regime(),
                if lifts { Regime::TiltingRight } else { Regime::FullContact },
                "{x:?}"
            );
            assert_eq!(event, Some(EventKind::Landing(Corner::Left)));
            assert_eq!([counts.impacts, counts.liftoffs], [1, u32::from(lifts)]);
            became[usize::from(lifts)] += 1;
        }
    }
    assert!(became.iter().all(|&count| count > 100), "{became:?} stayed, lifted");
}

/// Supports whose corners rise as fast as they creep carry no load, and the weight presses the block back. Without a limit of friction it
/// slides until it bears again; with one, or where the analysis ends, both corners have left.
#[test]
fn a_block_that_no_support_bears_slides_or_leaves() {
    for [friction, flies, both, held] in std::array::from_fn::<_, 16, _>(|i| [1, 2, 4, 8].map(|bit| i & bit != 0)) {
        if held && !both {
            continue;
        }
        let block = squat(&Common { friction: if friction { 0.5 } else { 0.0 }, ..Common::default() });
        let system = System { block, flies };
        let depth = 0.5 * block.static_deflection();
        let (height, rate) = (block.static_deflection() - depth, block.creep_rate * depth);
        let mut contacts = Contacts::touching([both, true], 0.0);
        if held {
            contacts.set(Corner::Left, Contact::Held(Creep { depth, since: 0.0 }, StandingSlide::Follows));
        }
        let state = State::from([0.0, 0.0, height, rate]);
        let pose = Pose { time: 0.0, state, contacts, footing: Footing::AT_START, restraints: States::NONE };
        let excitation = Excitation::from_time(0.0, &Inputs::default(), &Pulse::NONE, &block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
        let Transition { pose: after, event, counts, .. } =
            system.transition(&pose, &now, EventFunction::Reaction(Corner::Right));
        let case = format!("friction {friction}, flies {flies}, both {both}, held {held}: {event:?}, {after:?}");
        let found = (event, after.contacts.regime(), after.footing.grips(), counts.liftoffs);
        let regime = if both { Regime::FullContact } else { Regime::TiltingRight };
        let expected = if both && !held {
            (None, regime, true, 0)
        } else if flies && !friction {
            (Some(EventKind::Slip), regime, false, 0)
        } else {
            (Some(EventKind::LiftOff(Corner::Right)), Regime::Separated, false, if both { 2 } else { 1 })
        };
        assert_eq!(found, expected, "{case}");
        assert_eq!(after.contacts.held(), (both && !held).then_some(Corner::Right), "{case}");
    }
}

/// The friction of a foot that slides acts at the middle of the base or at the corner that stands: so there, too, full contact may
/// lift a corner that the other regime would press back. It is held, and friction follows from the other corner alone.
#[test]
fn a_corner_of_a_sliding_block_is_held() {
    let friction = 0.6;
    let block = squat(&Common { friction, ..Common::default() });
    let system = System { block, flies: true };
    let free = block.static_deflection();
    let mut became = [0; 2];
    for (i, direction) in (-4000..4000).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
        // L is about to leave its support at the free height, where it stands still.
        let (theta, theta_dot) = (libm::asin(free / block.b), -0.2);
        let middle = [0.0, -corner_arm(&block, 0.0) * libm::cos(theta) * theta_dot];
        let pose = Pose {
            time: 0.0,
            state: State::from([theta, theta_dot, middle[0], middle[1]]),
            contacts: Contacts::touching([true, true], 0.0),
            footing: Footing::Slides { u: 0.0, u_dot: direction, direction },
            restraints: States::NONE,
        };
        let inputs =
            Inputs { m_y: Ramp::held(1e-3 * f64::from(i) * block.mass * block.gravity * block.b), ..Inputs::default() };
        let excitation = Excitation::from_time(0.0, &inputs, &Pulse::NONE, &block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
        if now.instant.corner_ddot[0] <= 0.0 {
            continue;
        }
        let alone = instant(
            &block,
            Regime::TiltingRight,
            [theta, theta_dot, now.instant.corner[1], now.instant.corner_dot[1]],
            pose.footing,
            now.forcing,
        );
        let opens = alone.corner_ddot[0] >= 0.0;
        let Transition { pose: after, event, .. } =
            system.transition(&pose, &now, EventFunction::Reaction(Corner::Left));
        assert_eq!(event, opens.then_some(EventKind::LiftOff(Corner::Left)), "{now:?}");
        assert_eq!(after.contacts.held(), (!opens).then_some(Corner::Left));
        let x = Motion::from_pose(&block, &after, &excitation).at(0.0, after.state).instant;
        assert!((x.horizontal + direction * friction * x.reaction[1]).abs() < 1e-12 && x.reaction[0] == 0.0, "{x:?}");
        became[usize::from(opens)] += 1;
    }
    assert!(became.iter().all(|&count| count > 10), "{became:?} held, lifted");
}

/// Where the middle of the base and the standing corner slide to opposite sides, Filippov's solution holds the other corner: H lies within
/// both limits of friction, the energy balances, and corners do not lift and land again and again.
#[test]
fn friction_is_shared_where_a_corner_is_held_between_opposite_slides() {
    // The last one slides, but no corner is held.
    let cases = [
        ([0.2747, 2.2445, 9.5447, 1.0602], 0.3626, [5.583, 0.3852]),
        ([0.346, 0.886, 10.77, 0.423], 0.38, [6.5, 1.14]),
        ([0.346, 0.886, 10.77, 0.423], 0.37, [6.5, 1.14]),
    ];
    for ([alpha, p, eta, xi_v], friction, [amplitude, period]) in cases {
        let common = Common { epsilon: 0.3, friction, ..Common::default() };
        let block = Block::from_dimensionless(
            &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
            &common,
        )
        .unwrap();
        let settings = Settings { on_separation: OnSeparation::Fly, tolerance: 1e-12, ..Settings::default() };
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, ..Pulse::NONE };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
        let (mut between, mut before) = (0, None);
        for i in 1..=100_000 {
            simulation.advance(2e-5 * f64::from(i), &inputs, &mut |_| ()).unwrap();
            let (seen, energies) = (simulation.observe(&inputs), simulation.energies());
            assert!(energies.residual.abs() < 1e-8 * block.mass * block.gravity * block.r0, "{energies:?}");
            if seen.regime == Regime::FullContact && seen.reaction.contains(&0.0) && simulation.slides() {
                let limit = friction * (seen.reaction[0] + seen.reaction[1]);
                assert!(seen.horizontal.abs() <= limit * (1.0 + 1e-12), "{seen:?}");
                between += u32::from(seen.horizontal.abs() < 0.999 * limit);
                // Friction takes all: nothing is left for lift-offs and landings in the limit.
                if let Some(impacts) = before.replace(energies.impacts) {
                    assert!((energies.impacts - impacts).abs() < 1e-9, "{} J", energies.impacts - impacts);
                }
            } else {
                before = None;
            }
        }
        let counts = simulation.counts();
        assert!(counts.liftoffs <= counts.impacts + 3, "{counts:?}");
        assert_eq!(between > 10, friction != 0.37, "{between} instants of μ = {friction}");
    }
}

/// The motion of a block with a held corner is Filippov's convex combination of full contact and the regime on the other corner, also where
/// this corner slides against the middle of the base.
#[test]
fn a_block_with_a_held_corner_moves_as_a_convex_combination_of_two_regimes() {
    let block = squat(&Common { friction: 0.6, ..Common::default() });
    let Body { b, h, .. } = block.body;
    let free = block.static_deflection();
    let creep = Creep { depth: 1.5 * free, since: 0.0 };
    // R is below L, or above it and pressed on.
    for (right, theta_dot, slide) in [(-0.7, 0.2, StandingSlide::Opposes), (-0.2, 0.2, StandingSlide::Follows)] {
        let (left, right) = (creep.top(Corner::Left, &block, 0.0), right * free);
        let theta = libm::asin((left.re - right) / (2.0 * b));
        let (sin, cos) = theta.sin_cos();
        let across = b * cos * theta_dot;
        let state = State::from([theta, theta_dot, 0.5 * (left.re + right), left.eps - across]);
        // R slides to the other side more slowly than both velocities differ, or to the side of the middle.
        let [speed, against] = match slide {
            StandingSlide::Opposes => [-0.5 * b * sin * theta_dot, -1.0],
            StandingSlide::Follows => [0.3, 1.0],
        };
        let u_dot = (h * cos + b * sin) * theta_dot + speed;
        let slides = |direction| Footing::Slides { u: 0.0, u_dot, direction };
        let mut contacts = Contacts::FULL;
        contacts.set(Corner::Left, Contact::Held(creep, slide));
        let pose = Pose { time: 0.0, state, contacts, footing: slides(1.0), restraints: States::NONE };
        let regimes = |forcing| {
            let on_right = [theta, theta_dot, right, state[3] - across];
            [
                instant(&block, Regime::FullContact, state.0, slides(1.0), forcing),
                instant(&block, Regime::TiltingRight, on_right, slides(against), forcing),
            ]
        };
        let opens = |x: Instant<f64>| x.corner_ddot[0] + block.creep_rate * left.eps;
        for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let excitation = |m_y: f64| {
                let inputs = Inputs { m_y: Ramp::held(m_y), a_gx: Ramp::held(0.7), ..Inputs::default() };
                Excitation::from_time(0.0, &inputs, &Pulse::NONE, &block)
            };
            // The load under which this share of full contact, which lifts L, keeps L on its support.
            let combined = |m_y| {
                let [full, alone] = regimes(excitation(m_y).at(0.0)).map(opens);
                share * full + (1.0 - share) * alone
            };
            let excitation = excitation(1e5 * combined(0.0) / (combined(0.0) - combined(1e5)));
            let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
            let [full, alone] = regimes(now.forcing);
            assert!(opens(full) > 0.0 && opens(alone) < 0.0 && full.slip_rate > 0.0, "{full:?} {alone:?}");
            assert_eq!(alone.slip_rate.signum(), against);
            let values: [fn(&Instant<f64>) -> f64; 6] = [
                |x| x.theta_ddot,
                |x| x.v_ddot,
                |x| x.u_ddot,
                |x| x.horizontal,
                |x| x.friction_power,
                |x| x.corner_ddot[1],
            ];
            for value in values {
                let (found, expected) = (value(&now.instant), share * value(&full) + (1.0 - share) * value(&alone));
                assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} for {expected}, {slide:?}");
            }
        }
    }
}

/// Where the middle of the base and the standing corner slide to opposite sides, the held corner lifts once the standing one stops, which then
/// grips, or follows the ground to the other side.
#[test]
fn a_held_corner_lifts_when_the_other_one_stops() {
    let common = Common { epsilon: 0.3, friction: 0.3626, ..Common::default() };
    let dimensionless = Dimensionless {
        alpha: 0.2747,
        p: 2.2445,
        supports: Supports::Viscoelastic(Ratios { eta: 9.5447, xi_v: 1.0602 }),
    };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let settings = Settings { on_separation: OnSeparation::Fly, tolerance: 1e-12, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 5.583, period: 0.3852, ..Pulse::NONE };
    for (a_gx, grips) in [(2.2, true), (9.0, false)] {
        let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &Inputs::default());
        simulation.advance(0.213, &Inputs::default(), &mut |_| ()).unwrap();
        let inputs = Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() };
        let rejected = simulation.counts().rejected;
        let mut speed = f64::INFINITY;
        loop {
            let seen = simulation.observe(&inputs);
            let (sin, cos) = seen.theta.sin_cos();
            let now = seen.u_dot - (block.h * cos - block.b * sin) * seen.theta_dot;
            if seen.regime != Regime::FullContact {
                // Its last velocity before was that of one step at most.
                assert!(seen.regime == Regime::TiltingLeft && speed < 3e-5 && now <= 0.0, "{speed} m/s, {seen:?}");
                assert_eq!(simulation.footing().grips(), grips, "{seen:?}");
                break;
            }
            // R is held, L slides to the right, and the middle to the left.
            assert!(seen.reaction[1] == 0.0 && seen.slip_rate < 0.0 && now > 0.0 && now < speed, "{seen:?}");
            speed = now;
            simulation.advance(simulation.time() + 2e-6, &inputs, &mut |_| ()).unwrap();
        }
        let (counts, energies) = (simulation.counts(), simulation.energies());
        assert!(counts.rejected - rejected <= 3, "{counts:?}");
        assert!(energies.residual.abs() < 1e-9 * block.mass * block.gravity * block.r0, "{energies:?}");
    }
}
