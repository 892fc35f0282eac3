//! The equations of motion at an instant: rates, balance of forces, balance of energy.
//!
//! Rates are compared with central differences along the motion, by Runge–Kutta steps of order 4. In units of the fastest
//! circular frequency ω the step is 1e-4, so the truncation error is ω³ · 1e-8 of the function and round-off 1e-12.

use std::f64::consts::TAU;

use rocking_block::block::restraints::States;
use rocking_block::block::restraints::{Tie, TieState};
use rocking_block::block::{Block, Body, Common, Contact, Contacts, Corner, Creep, Foundation, Regime, StandingSlide};
use rocking_block::excitation::{Excitation, Forcing, Pulse, PulseShape};
use rocking_block::numerics::{Equations, State};
use rocking_block::system::evaluation::{Evaluation, Motion};
use rocking_block::system::events::grip::pressure_if_gripped;
use rocking_block::system::events::{EventFunction, gap_opening};
use rocking_block::system::instant::Pose;
use rocking_block::system::instant::{Footing, Instant};

use crate::blocks;
use crate::blocks::uneven as block;

/// Time of all checks: within the pulse, away from zeros of its sine and cosine.
const TIME: f64 = 0.37;

/// Returns changing ground accelerations and loads, and a pulse.
fn excitation(block: &Block) -> Excitation {
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 2.5, period: 0.9, start: 0.1, ..Pulse::NONE };
    Excitation::from_time(TIME, &blocks::ramps(), &pulse, block)
}

/// Returns a plausible pose for every combination of contacts and grips, of blocks with the centre of mass in the middle and beside it.
fn situations() -> Vec<(Block, Pose)> {
    let mut all = Vec::new();
    for (foundation, xi_v, eccentricity) in [
        (Foundation::Viscoelastic, 0.23, 0.0),
        (Foundation::Viscoelastic, 0.0, 0.0),
        (Foundation::Rigid, 0.1, 0.0),
        (Foundation::Viscoelastic, 0.23, 0.3),
        (Foundation::Rigid, 0.1, -0.2),
    ] {
        let block = eccentric(foundation, xi_v, eccentricity);
        let free = Footing::Free { u: 0.31, u_dot: -0.42 };
        for touching in [[true, true], [true, false], [false, true], [false, false]] {
            for footing in [Footing::Grips { offset: 0.17 }, free] {
                if touching == [false, false] && footing.grips() {
                    continue;
                }
                let sunk = Contact::Lifted(Creep { depth: 0.4 * block.static_deflection(), since: 0.35 });
                let mut contacts = Contacts::touching(touching, 0.0);
                for corner in Corner::BOTH.into_iter().filter(|corner| !touching[corner.index()]) {
                    contacts.set(corner, sunk);
                }
                let (w, w_dot) = match foundation {
                    Foundation::Viscoelastic => (-0.3 * block.static_deflection(), 0.07),
                    Foundation::Rigid if touching == [false, false] => (0.2, 0.3),
                    Foundation::Rigid => (0.0, 0.0),
                };
                let (theta, theta_dot) = match (foundation, touching) {
                    (Foundation::Rigid, [true, true]) => (0.0, 0.0),
                    (_, [true, false]) => (-0.11, 0.5),
                    (_, [false, true]) => (0.13, -0.4),
                    (_, [true, true] | [false, false]) => (0.02, 0.3),
                };
                let state = State::from([theta, theta_dot, w, w_dot]);
                all.push((block, Pose { time: TIME, state, contacts, footing, restraints: States::NONE }));
            }
        }
    }
    all
}

/// Returns [`blocks::uneven`] with its centre of mass beside the middle (m).
fn eccentric(foundation: Foundation, xi_v: f64, eccentricity: f64) -> Block {
    let Block { gamma, epsilon, body: Body { mass, .. }, .. } = block(foundation, xi_v);
    let common = Common { mass, gamma, epsilon, eccentricity, ..Common::default() };
    blocks::block_on(foundation, [0.42, 1.7, 11.0, xi_v], &common)
}

/// Returns poses in which one of both corners is held on its support.
fn held() -> Vec<(Block, Pose)> {
    let mut all = Vec::new();
    for (eccentricity, corner) in [(0.0, Corner::Left), (0.3, Corner::Left), (0.3, Corner::Right)] {
        let block = eccentric(Foundation::Viscoelastic, 0.23, eccentricity);
        let mut contacts = Contacts::FULL;
        contacts.set(
            corner,
            Contact::Held(Creep { depth: 0.4 * block.static_deflection(), since: 0.35 }, StandingSlide::Follows),
        );
        let state = State::from([0.02, 0.3, 0.0, 0.0]);
        all.push((
            block,
            Pose { time: TIME, state, contacts, footing: Footing::Grips { offset: 0.17 }, restraints: States::NONE },
        ));
    }
    all
}

/// Returns the height of a support without load above that under the block at rest (m): its share of the weight over its stiffness.
fn free_height(block: &Block, corner: Corner) -> f64 {
    let share = 0.5 * (1.0 - corner.sign() * block.eccentricity / block.b);
    share * block.mass * block.gravity / block.stiffness
}

/// Returns an upper bound of the circular frequencies.
fn fastest(block: &Block) -> f64 {
    block.omega_v * (1.0 + 2.0 * block.xi_v) * 2.0 + if block.xi_v > 0.0 { block.creep_rate } else { 0.0 } + TAU / 0.9
}

/// Returns the block `elapsed` seconds after the pose, by one Runge–Kutta step of order 4.
fn after<'a>(block: &'a Block, pose: &Pose, excitation: &'a Excitation, elapsed: f64) -> Evaluation<'a> {
    let motion = Motion::from_pose(block, pose, excitation);
    let rate = |part: f64, state: State| motion.rate(pose.time + part * elapsed, &state).state;
    let k1 = rate(0.0, pose.state);
    let k2 = rate(0.5, pose.state + k1 * (0.5 * elapsed));
    let k3 = rate(0.5, pose.state + k2 * (0.5 * elapsed));
    let k4 = rate(1.0, pose.state + k3 * elapsed);
    motion.at(pose.time + elapsed, pose.state + (k1 + (k2 + k3) * 2.0 + k4) * (elapsed / 6.0))
}

/// Checks a rate against the central difference of its function; `size` is the magnitude of its terms.
fn check(what: &str, (block, pose): (&Block, &Pose), rate: f64, size: f64, function: impl Fn(&Evaluation) -> f64) {
    let excitation = excitation(block);
    let h = 1e-4 / fastest(block);
    let [before, after] = [-h, h].map(|elapsed| function(&after(block, pose, &excitation, elapsed)));
    let difference = (after - before) / (2.0 * h);
    let allowed = 1e-6 * (rate.abs() + size * fastest(block));
    assert!((rate - difference).abs() <= allowed, "{what} = {rate}, by difference {difference}, {pose:?}");
}

#[test]
fn rates_are_derivatives_along_the_motion() {
    for (block, pose) in situations().into_iter().chain(held()) {
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let (x, at) = (now.instant, (&block, &pose));
        let unit = block.r0;
        check("theta_dot", at, x.theta_dot, 1e-3, |now| now.instant.theta);
        check("theta_ddot", at, x.theta_ddot, 1e-3, |now| now.instant.theta_dot);
        check("w_dot", at, x.w_dot, 1e-3 * unit, |now| now.state[2]);
        check("w_ddot", at, x.w_ddot, 1e-3 * unit, |now| now.instant.w_dot);
        check("u_dot", at, x.u_dot, 1e-3 * unit, |now| now.instant.u);
        check("u_ddot", at, x.u_ddot, 1e-3 * unit, |now| now.instant.u_dot);
        check("v_dot", at, x.v_dot, 1e-3 * unit, |now| now.instant.v);
        check("v_ddot", at, x.v_ddot, 1e-3 * unit, |now| now.instant.v_dot);
        if pose.contacts.regime() != Regime::Separated {
            check("slip_rate", at, x.slip_rate, 1e-3 * unit, |now| now.foot_place());
            check("foot_acceleration", at, now.foot_acceleration(), 1e-3 * unit, |now| now.instant.slip_rate);
        }
        for corner in [0, 1] {
            check("corner_dot", at, x.corner_dot[corner], 1e-3 * unit, |now| now.instant.corner[corner]);
            check("corner_ddot", at, x.corner_ddot[corner], 1e-3 * unit, |now| now.instant.corner_dot[corner]);
        }
    }
}

/// Dual numbers give the rates of all quantities, and the only ones of accelerations and reactions.
#[test]
fn dual_numbers_give_the_rates_of_everything() {
    type Field = (
        &'static str,
        fn(&Instant<f64>) -> f64,
        fn(&Instant<rocking_block::numerics::dual::Dual>) -> rocking_block::numerics::dual::Dual,
    );
    let fields: [Field; 13] = [
        ("theta", |x| x.theta, |x| x.theta),
        ("theta_ddot", |x| x.theta_ddot, |x| x.theta_ddot),
        ("w_ddot", |x| x.w_ddot, |x| x.w_ddot),
        ("u", |x| x.u, |x| x.u),
        ("u_dot", |x| x.u_dot, |x| x.u_dot),
        ("u_ddot", |x| x.u_ddot, |x| x.u_ddot),
        ("v", |x| x.v, |x| x.v),
        ("v_ddot", |x| x.v_ddot, |x| x.v_ddot),
        ("corner_ddot L", |x| x.corner_ddot[0], |x| x.corner_ddot[0]),
        ("corner_ddot R", |x| x.corner_ddot[1], |x| x.corner_ddot[1]),
        ("N_L", |x| x.reaction[0], |x| x.reaction[0]),
        ("N_R", |x| x.reaction[1], |x| x.reaction[1]),
        ("H", |x| x.horizontal, |x| x.horizontal),
    ];
    for (block, pose) in situations().into_iter().chain(held()) {
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let dual = now.with_rates(now.forcing_rate());
        for (name, value, rate) in fields {
            let (one, other) = (value(&now.instant), rate(&dual).re);
            assert!((one - other).abs() <= 1e-14 * (block.gravity + one.abs()), "{name}: {one} and {other}, {pose:?}");
            check(name, (&block, &pose), rate(&dual).eps, 1e-2 * block.gravity, |now| value(&now.instant));
        }
    }
}

/// Returns the positions of the corners relative to the centre of mass: to the right, and up.
fn arms(block: &Block, theta: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = theta.sin_cos();
    [-block.b, block.b].map(|x| {
        let x = x - block.eccentricity;
        [x * cos - block.h * sin, -x * sin - block.h * cos]
    })
}

/// The reactions satisfy Newton's and Euler's equations and the law of the supports in all situations.
#[test]
fn forces_balance_in_all_situations() {
    for (block, pose) in situations() {
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let Evaluation { instant: x, forcing: Forcing { x: a_x, z: a_z, moment, .. }, .. } = now;
        let [left, right] = arms(&block, x.theta);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * (block.gravity + a.abs());
        assert!(close(x.reaction[0] + x.reaction[1], x.v_ddot + block.gravity + a_z), "{pose:?} {x:?}");
        assert!(close(x.horizontal, x.u_ddot + a_x), "{pose:?} {x:?}");
        // H acts at the held point: the middle of the base in full contact, otherwise the corner in contact.
        let foot = match pose.contacts.regime() {
            Regime::TiltingLeft => left[1],
            Regime::TiltingRight => right[1],
            Regime::FullContact | Regime::Separated => 0.5 * (left[1] + right[1]),
        };
        let turning = foot * x.horizontal - left[0] * x.reaction[0] - right[0] * x.reaction[1] + moment;
        assert!(close(block.i0 * x.theta_ddot / block.r0, turning / block.r0), "{pose:?} {x:?}");
        if !pose.footing.grips() {
            assert_eq!(x.horizontal, 0.0);
        }
        if pose.contacts.regime() == Regime::Separated {
            assert_eq!(x.slip_rate, 0.0);
        }
        for (i, corner) in Corner::BOTH.into_iter().enumerate() {
            let height = x.v + block.h + [left, right][i][1];
            assert!((height - x.corner[i]).abs() < 1e-14, "{pose:?} {x:?}");
            match (pose.contacts.touches(corner), block.foundation) {
                (true, Foundation::Viscoelastic) => {
                    let spring = block.stiffness * (free_height(&block, corner) - x.corner[i]);
                    let n = (spring - block.damping * x.corner_dot[i]) / block.mass;
                    assert!(close(x.reaction[i], n), "{pose:?} {x:?}");
                }
                // The base is rigid.
                (true, Foundation::Rigid) => {
                    assert!(x.corner[i].abs() < 1e-14 && x.corner_dot[i].abs() < 1e-14, "{pose:?} {x:?}");
                    assert!(x.corner_ddot[i].abs() < 1e-12, "{pose:?} {x:?}");
                }
                (false, _) => assert_eq!(x.reaction[i], 0.0),
            }
        }
        // A gripping point does not move.
        let at_rest = arms(&block, 0.0);
        let [left, right] = [0, 1].map(|i| x.u + [left, right][i][0] - at_rest[i][0]);
        let at = match pose.contacts.regime() {
            Regime::TiltingLeft => left,
            Regime::TiltingRight => right,
            Regime::FullContact | Regime::Separated => 0.5 * (left + right),
        };
        assert!((at - now.foot_place()).abs() < 1e-14, "{pose:?} {x:?}");
        if let Footing::Grips { offset } = pose.footing {
            assert!((at - offset).abs() < 1e-14, "{pose:?} {x:?}");
        }
    }
}

/// The rate of energy is the power of ground and loads minus `C v̇_I²` per dashpot.
#[test]
fn the_rate_of_energy_is_the_sum_of_the_powers() {
    for (block, pose) in situations() {
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let Evaluation { instant: x, forcing: Forcing { x: a_x, z: a_z, moment, .. }, .. } = now;
        let [input, dashpots] = [now.rate.quadratures[0], now.rate.quadratures[1]];
        let touching = Corner::BOTH.into_iter().filter(|&corner| pose.contacts.touches(corner));
        let rates = touching.map(|corner| x.corner_dot[corner.index()].powi(2)).sum::<f64>();
        let taken = if block.foundation == Foundation::Rigid { 0.0 } else { block.damping / block.mass * rates };
        assert!((dashpots - taken).abs() < 1e-12, "{dashpots} and {taken}");
        let work = moment * x.theta_dot - a_x * x.u_dot - a_z * x.v_dot;
        // For a block without grip the horizontal part has a closed form.
        let in_closed_form = if pose.footing.grips() { 0.0 } else { -a_x * x.u_dot };
        assert!((input + in_closed_form - work).abs() < 1e-12, "{input}, {in_closed_form} and {work}");
        check("power", (&block, &pose), work - dashpots, 1e-3 * block.gravity * block.r0, |now| now.energy());
        let kinetic = 0.5 * (block.i0 * x.theta_dot.powi(2) + x.u_dot.powi(2) + x.v_dot.powi(2));
        let springs = Corner::BOTH.into_iter().filter(|&corner| pose.contacts.touches(corner)).map(|corner| {
            let depth = free_height(&block, corner) - x.corner[corner.index()];
            0.5 * block.stiffness / block.mass * depth * depth
        });
        let at_rest =
            Corner::BOTH.map(|corner| 0.5 * block.stiffness / block.mass * free_height(&block, corner).powi(2));
        let potential = block.gravity * x.v
            + match block.foundation {
                Foundation::Viscoelastic => springs.sum::<f64>() - at_rest.iter().sum::<f64>(),
                Foundation::Rigid => 0.0,
            };
        let unit = block.gravity * block.r0;
        assert!((now.energy() - kinetic - potential).abs() < 1e-13 * unit, "{} {kinetic} {potential}", now.energy());
    }
}

/// A taut tie below the middle pulls the centre of mass of a block down while one of its corners is held.
#[test]
fn ties_pull_a_block_whose_corner_is_held() {
    for (plain, pose) in held() {
        let excitation = excitation(&plain);
        let stiffness = 20.0 * plain.mass * plain.gravity;
        let block = plain.with_ties(&[Tie { ground: [0.0, -1e6], stiffness, ..Tie::default() }]).unwrap();
        let mut tied = pose;
        tied.restraints.ties[0] = TieState::Taut;
        let [free, pulled] = [(&plain, pose), (&block, tied)]
            .map(|(of, pose)| Motion::from_pose(of, &pose, &excitation).at(TIME, pose.state));
        // The end at the block has sunk with the middle of the base, or risen.
        let tension = stiffness * (free.instant.corner[0] + free.instant.corner[1]) * 0.5;
        let change = pulled.instant.v_ddot - free.instant.v_ddot;
        assert!(
            tension.abs() > 0.1 && (change + tension / plain.mass).abs() < 1e-5 * change.abs(),
            "{change} {tension}"
        );
    }
}

/// Event functions have the right rates, and the right values if another definition exists.
#[test]
fn event_functions_have_their_rates() {
    for (block, pose) in situations() {
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let at = (&block, &pose);
        for (i, corner) in Corner::BOTH.into_iter().enumerate() {
            let function = if pose.contacts.touches(corner) {
                EventFunction::Reaction(corner)
            } else {
                EventFunction::Gap(corner)
            };
            let sample = function.sample(&now);
            let expected = match function {
                EventFunction::Gap(_) => {
                    let Contact::Lifted(creep) = pose.contacts.of(corner) else { unreachable!() };
                    let sunk = match block.foundation {
                        Foundation::Viscoelastic => {
                            let depth = creep.depth * (-(TIME - creep.since) * block.creep_rate).exp();
                            free_height(&block, corner) - if block.xi_v > 0.0 { depth } else { 0.0 }
                        }
                        Foundation::Rigid => 0.0,
                    };
                    now.instant.corner[i] - sunk
                }
                _ => now.instant.reaction[i],
            };
            assert!((sample.re - expected).abs() < 1e-14 * (1.0 + expected.abs()), "{function:?} {pose:?}");
            check("function", at, sample.eps, 1e-3 * block.gravity, |now| function.sample(now).re);
        }
        let turn = EventFunction::QuarterTurn.sample(&now);
        assert_eq!(turn.re, std::f64::consts::FRAC_PI_2 - now.instant.theta.abs());
        if now.instant.theta != 0.0 {
            check("quarter turn", at, turn.eps, 1e-3, |now| EventFunction::QuarterTurn.sample(now).re);
        }
        let standing = pose.contacts.regime() != Regime::Separated;
        if standing && !pose.footing.grips() && !(block.foundation == Foundation::Rigid && now.regime.pivot().is_none())
        {
            let slide = EventFunction::GripPressure.sample(&now);
            check("slide", at, slide.eps, 1e-2 * block.gravity, |now| EventFunction::GripPressure.sample(now).re);
        }
    }
}

/// The pressure if gripped is that after a horizontal impulse that stops the slide, from the momenta.
#[test]
fn the_pressure_if_gripped_is_that_after_the_impulse() {
    for (block, pose) in situations() {
        let slides = !pose.footing.grips() && pose.contacts.regime() != Regime::Separated;
        if !slides || block.foundation == Foundation::Rigid {
            continue;
        }
        let excitation = excitation(&block);
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, pose.state);
        let x = now.instant;
        let [left, right] = arms(&block, x.theta);
        let foot = match now.regime {
            Regime::TiltingLeft => left[1],
            Regime::TiltingRight => right[1],
            Regime::FullContact | Regime::Separated => 0.5 * (left[1] + right[1]),
        };
        // u̇ + J + foot (θ̇ + foot J/i0) = 0, with `foot` below zero.
        let impulse = -(x.u_dot + foot * x.theta_dot) / (1.0 + foot * foot / block.i0);
        let theta_dot = x.theta_dot + foot * impulse / block.i0;
        let pressed = |i: usize| {
            let rate = x.v_dot - [left, right][i][0] * theta_dot;
            let n = block.stiffness * (free_height(&block, Corner::BOTH[i]) - x.corner[i]) - block.damping * rate;
            (n - (block.stiffness * block.mass).sqrt() * rate.max(0.0)) / block.mass
        };
        let least = [0, 1].into_iter().filter(|&i| pose.contacts.touches(Corner::BOTH[i])).map(pressed);
        let least = least.fold(f64::INFINITY, f64::min);
        let found = pressure_if_gripped(&block, now.regime, &x);
        assert!((found - least).abs() < 1e-12 * (block.gravity + least.abs()), "{found} and {least}, {pose:?}");
        assert_eq!(EventFunction::GripPressure.sample(&now).re, -found);
    }
}

/// The gap of a released corner opens with the predicted acceleration, by the motion without that corner.
#[test]
fn gaps_open_with_the_predicted_acceleration() {
    let block = block(Foundation::Viscoelastic, 0.23);
    let excitation = excitation(&block);
    for (leaving, touching, theta) in
        [(Corner::Left, [true, true], 0.05), (Corner::Right, [true, true], -0.05), (Corner::Left, [true, false], -0.2)]
    {
        // The corner bears no load: its support moves with it.
        let i = leaving.index();
        let depth = 0.2 * block.static_deflection();
        let (height, rate) = (block.static_deflection() - depth, block.creep_rate * depth);
        let (theta_dot, tilt) = (0.4, leaving.sign() * block.b);
        let (w, w_dot) = match touching {
            [true, true] => (height - tilt * f64::sin(theta), rate - tilt * theta_dot * f64::cos(theta)),
            _ => (height, rate),
        };
        let state = State::from([theta, theta_dot, w, w_dot]);
        let contacts = Contacts::touching(touching, 0.0);
        let pose =
            Pose { time: TIME, state, contacts, footing: Footing::Grips { offset: 0.17 }, restraints: States::NONE };
        let now = Motion::from_pose(&block, &pose, &excitation).at(TIME, state);
        assert!(now.instant.reaction[i].abs() < 1e-12 && (now.instant.corner_dot[i] - rate).abs() < 1e-13);
        let said = gap_opening(&now, leaving, now.instant.corner_dot[i]);

        let mut gone = pose;
        gone.contacts.set(leaving, Contact::Lifted(Creep { depth, since: TIME }));
        match gone.contacts.regime() {
            Regime::Separated => {
                gone.state = State::from([theta, theta_dot, now.instant.v, now.instant.v_dot]);
                gone.footing = Footing::Free { u: now.instant.u, u_dot: now.instant.u_dot };
            }
            _ => {
                let other = leaving.other().index();
                gone.state = State::from([theta, theta_dot, now.instant.corner[other], now.instant.corner_dot[other]]);
            }
        }
        let h = 1e-4 / fastest(&block);
        let gap = |elapsed: f64| EventFunction::Gap(leaving).sample(&after(&block, &gone, &excitation, elapsed));
        assert!(gap(0.0).re.abs() < 1e-15 && gap(0.0).eps.abs() < 1e-13, "{:?}", gap(0.0));
        // No gap exists before the release, hence a difference of three points after it.
        let opens = (4.0 * gap(h).eps - gap(2.0 * h).eps - 3.0 * gap(0.0).eps) / (2.0 * h);
        assert!((said - opens).abs() < 1e-6 * (1.0 + opens.abs()), "{leaving:?}: {said}, by difference {opens}");
        assert_eq!(EventFunction::Held(leaving).sample(&now).re, -said);
    }
}

/// A footing of a forged state is refused if any of its numbers is not finite.
#[test]
fn a_footing_is_finite_if_all_its_numbers_are() {
    let free = |u, u_dot| Footing::Free { u, u_dot }.is_finite();
    assert!(free(1.0, -2.0) && Footing::AT_START.is_finite());
    assert!(!free(f64::NAN, 0.0) && !free(0.0, f64::INFINITY));
    assert!(!Footing::Grips { offset: f64::NAN }.is_finite());
}
