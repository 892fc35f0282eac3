//! Ties at an instant: their forces by virtual work, from the distance of their ends as the block moves.

use nalgebra::{Matrix3, Vector3};
use rocking_block::block::restraints::tie::{Link, NO_TIES, YieldDirection, pull};
use rocking_block::block::restraints::{self, LinkKind, States, Tie, TieState, TieStates};
use rocking_block::block::{Block, Common, Kinematics, Regime};
use rocking_block::excitation::Forcing;
use rocking_block::numerics::dual::Dual;
use rocking_block::system::dynamics::instant;
use rocking_block::system::forces;
use rocking_block::system::instant::{Footing, Instant};

use crate::blocks;

/// Displacements `[u, v, θ]` of the centre of mass and the rotation (m, rad).
const MOVED: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [0.3, -0.2, 0.4], [-0.5, 0.7, -0.9]];

/// Their rates (m/s, rad/s).
const RATE: [f64; 3] = [0.7, -1.1, 0.6];

/// Returns an uneven block with ties in all directions; the second one is slack at rest, the third one has no stiffness.
fn tied() -> Block {
    let common = Common { mass: 7.0, gamma: 2.3, eccentricity: 0.3, ..Common::default() };
    let plain = blocks::block([0.42, 1.7, 11.0, 0.2], &common);
    let tie = |block, ground, stiffness, pretension, slack, damping| Tie {
        block,
        ground,
        stiffness,
        pretension,
        slack,
        damping,
        ..Tie::default()
    };
    let ties = [
        tie([-0.8, 2.1], [-3.0, 0.4], 90.0, 25.0, 0.0, 6.0),
        tie([1.1, 3.4], [2.0, -1.5], 150.0, 0.0, 0.07, 4.0),
        tie([0.4, 0.3], [0.9, 5.0], 0.0, 0.0, 0.0, 0.0),
        tie([0.2, 5.0], [1.7, 9.0], 60.0, 300.0, 0.0, 3.0),
        tie([-1.0, 0.5], [-0.9, -2.0], 200.0, 80.0, 0.01, 2.0),
    ];
    plain.with_ties(&ties).unwrap()
}

/// Returns the same block with a tie and dampers that yield.
fn yielding() -> Block {
    let block = tied();
    let mut ties: Vec<Tie> = block.ties().iter().map(|tie| Tie { yield_force: 12.0, hardening: 0.2, ..*tie }).collect();
    for tie in &mut ties[1..] {
        *tie = Tie { kind: LinkKind::Damper, pretension: 0.0, slack: 0.0, ..*tie };
    }
    block.with_ties(&ties).unwrap()
}

/// A block has up to eight ties.
#[test]
fn nine_ties_are_refused() {
    let (block, tie) = (tied(), tied().ties()[0]);
    assert_eq!(block.with_ties(&[tie; 8]).unwrap().ties().len(), 8);
    let error = block.with_ties(&[tie; 9]).unwrap_err();
    assert_eq!(error.to_string(), "ties = 9 is not valid; expected at most 8 ties and dampers");
}

/// The ties that there are, with their numbers.
fn real(block: &Block) -> impl Iterator<Item = (usize, &Tie)> {
    block.ties().iter().enumerate().filter(|(_, tie)| tie.stiffness > 0.0)
}

/// The distance of the ends of a tie less that at which it begins to pull (m).
fn stretch(block: &Block, tie: &Tie, [u, v, theta]: [f64; 3]) -> f64 {
    let (sin, cos) = theta.sin_cos();
    // The centre of mass is (e, h) from the middle of the base at rest.
    let (e, h) = (block.eccentricity, block.h);
    let [x, z] = [tie.block[0] - e, tie.block[1] - h];
    let end = [e + u + x * cos + z * sin, h + v + z * cos - x * sin];
    let distance = |end: [f64; 2]| (end[0] - tie.ground[0]).hypot(end[1] - tie.ground[1]);
    distance(end) - distance(tie.block) - tie.slack + tie.pretension / tie.stiffness
}

/// Its derivatives with respect to u, v and θ, by central differences.
fn slopes(block: &Block, tie: &Tie, at: [f64; 3]) -> Vector3<f64> {
    const H: f64 = 1e-5;
    Vector3::from_fn(|i, _| {
        let moved = |by: f64| std::array::from_fn(|j| at[j] + if i == j { by } else { 0.0 });
        (stretch(block, tie, moved(H)) - stretch(block, tie, moved(-H))) / (2.0 * H)
    })
}

/// The block in flight with ties in these states.
fn flying(block: &Block, [u, v, theta]: [f64; 3], ties: TieStates) -> Instant<f64> {
    let [u_dot, v_dot, theta_dot] = RATE;
    let forcing = Forcing { restraints: States { ties, plastic: None }, ..Forcing::default() };
    instant(block, Regime::Separated, [theta, theta_dot, v, v_dot], Footing::Free { u, u_dot }, forcing)
}

#[track_caller]
fn near(found: f64, exact: f64, what: &str) {
    assert!((found - exact).abs() < 1e-8 * (1.0 + exact.abs()), "{what}: {found}, not {exact}");
}

/// A taut tie pulls with `T = k s + c ṡ`, and its work is T times its shortening. Its spring stores `½ k s²` until it is slack or broken,
/// and its dashpot dissipates the rest of the work of T.
#[test]
fn ties_pull_shorten_and_store() {
    use TieState::{Broken, Limp, Slack, Taut};
    let block = tied();
    for at in MOVED {
        for states in
            [[Taut, Taut, Slack, Taut, Taut], [Limp, Taut, Slack, Slack, Broken], [Limp, Slack, Slack, Limp, Slack]]
        {
            let mut ties = NO_TIES;
            ties[..5].copy_from_slice(&states);
            let x = flying(&block, at, ties);
            let (mut force, mut stored, mut taken) = (Vector3::zeros(), 0.0, 0.0);
            let tensions = forces::observe_restraints(&block, &States { ties, plastic: None }, &x);
            for (i, of) in real(&block) {
                let (s, slopes) = (stretch(&block, of, at), slopes(&block, of, at));
                let rate = slopes.dot(&Vector3::from(RATE));
                let found = pull::stretch(&block, of, &Kinematics::of(&x));
                near(found.length, s, "stretch");
                near(found.rate, rate, "rate of the stretch");
                let pull = if states[i] == Taut { of.stiffness * s + of.damping * rate } else { 0.0 };
                // A state that the law excludes may pull with less than nothing, which no tension shows.
                near(tensions[i].pull, pull.max(0.0), "tension");
                force -= slopes * pull;
                if matches!(states[i], Taut | Limp) {
                    stored += 0.5 * of.stiffness * s * s;
                    taken += (pull - of.stiffness * s) * rate;
                }
            }
            let mass = block.mass;
            near(mass * x.u_ddot, force[0], "M ü");
            near(mass * (x.v_ddot + block.gravity), force[1], "M (v̈ + g)");
            near(mass * block.i0 * x.theta_ddot, force[2], "I0 θ̈");
            let (tied, untied) =
                (Forcing { restraints: States { ties, plastic: None }, ..Forcing::default() }, Forcing::default());
            let potential = |forcing: &Forcing<f64>| mass * forces::energy(&block, Regime::Separated, forcing, &x).1;
            near(potential(&tied) - potential(&untied), stored, "stored energy");
            near(mass * forces::dissipated(&block, &tied, &x)[1], taken, "power");
        }
    }
}

/// Equal ties act alike, whichever of the eight they are, alone and in pairs.
#[test]
fn a_tie_acts_whatever_its_number() {
    let block = tied().with_ties(&[tied().ties()[0]; 8]).unwrap();
    let seen = |taut: &[usize]| {
        let mut ties = NO_TIES;
        taut.iter().for_each(|&i| ties[i] = TieState::Taut);
        let x = flying(&block, MOVED[1], ties);
        let forcing = Forcing { restraints: States { ties, plastic: None }, ..Forcing::default() };
        let (energy, power) =
            (forces::energy(&block, Regime::Separated, &forcing, &x).1, forces::dissipated(&block, &forcing, &x)[1]);
        [x.u_ddot, x.v_ddot, x.theta_ddot, energy, power]
    };
    let (none, one) = (seen(&[]), seen(&[0]));
    assert!(none.iter().zip(one).all(|(none, one)| *none != one), "{none:?} {one:?}");
    for i in 0..8 {
        assert_eq!(seen(&[i]), one, "tie {}", i + 1);
        for j in 0..i {
            for ((both, none), one) in seen(&[j, i]).into_iter().zip(none).zip(one) {
                near(both - none, 2.0 * (one - none), &format!("ties {} and {}", j + 1, i + 1));
            }
        }
    }
}

/// The force (N) of a spring that is stretched once by s (m): `k s`, and `r k s ± (1 − r) F_y` beyond the yield force.
fn spring(tie: &Tie, s: f64) -> f64 {
    let Tie { stiffness, yield_force, hardening, kind, .. } = *tie;
    let elastic = stiffness * s;
    match kind {
        LinkKind::Tie if s < 0.0 => 0.0,
        _ if yield_force > 0.0 && elastic.abs() > yield_force => {
            hardening * elastic + (1.0 - hardening) * yield_force.copysign(s)
        }
        LinkKind::Tie | LinkKind::Damper => elastic,
    }
}

/// At rest the springs that are stretched pull, and their pull grows with the height by the static stiffness.
#[test]
fn the_static_stiffness_is_the_slope_of_the_static_pull() {
    const H: f64 = 1e-5;
    let (mut slack, mut yields, mut pushes) = (0, 0, 0);
    for (block, [u, v, theta]) in [tied(), yielding()].into_iter().flat_map(|block| MOVED.map(|moved| (block, moved))) {
        let pull = |v: f64| {
            let place =
                Kinematics { sin_cos: theta.sin_cos().into(), theta_dot: 0.0, center: [u, v], velocity: [0.0; 2] };
            (
                100.0 - restraints::less_static_pull(&block, &place, 100.0, 0.0),
                restraints::static_stiffness(&block, &place, 0.0),
            )
        };
        let mut exact = 0.0;
        for (_, of) in real(&block) {
            let s = stretch(&block, of, [u, v, theta]);
            let force = spring(of, s);
            slack += u32::from(force == 0.0);
            yields += u32::from(force != 0.0 && force != of.stiffness * s);
            pushes += u32::from(force < 0.0);
            exact += force * slopes(&block, of, [u, v, theta])[1];
        }
        let (found, stiffness) = pull(v);
        near(found, exact, "pull");
        near(stiffness, (pull(v + H).0 - pull(v - H).0) / (2.0 * H), "stiffness");
    }
    assert!(slack > 0 && yields > 5 && pushes > 0 && yields > pushes, "{slack} {yields} {pushes}");
}

/// The event functions of ties and dampers have the rates with which their values change along the motion.
#[test]
fn event_functions_have_the_rates_of_their_values() {
    const H: f64 = 1e-5;
    const RATE_OF_RATE: [f64; 3] = [-2.0, 1.5, 0.8];
    let mut ties = yielding().ties().to_vec();
    ties.iter_mut().for_each(|tie| tie.strength = 40.0);
    let block = yielding().with_ties(&ties).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for at in MOVED {
        let place = |time: f64| {
            let [u, v, theta] = std::array::from_fn(|i| at[i] + RATE[i] * time + 0.5 * RATE_OF_RATE[i] * time * time);
            let [u_dot, v_dot, theta_dot] = std::array::from_fn(|i| RATE[i] + RATE_OF_RATE[i] * time);
            Kinematics { sin_cos: theta.sin_cos().into(), theta_dot, center: [u, v], velocity: [u_dot, v_dot] }
        };
        let Kinematics { sin_cos: [sin, cos], theta_dot, center: [u, v], velocity: [u_dot, v_dot] } = place(0.0);
        let dual = |re, eps| Dual { re, eps };
        let rates = Kinematics {
            sin_cos: [dual(sin, cos * theta_dot), dual(cos, -sin * theta_dot)],
            theta_dot: dual(theta_dot, RATE_OF_RATE[2]),
            center: [dual(u, u_dot), dual(v, v_dot)],
            velocity: [dual(u_dot, RATE_OF_RATE[0]), dual(v_dot, RATE_OF_RATE[1])],
        };
        for state in [
            TieState::Slack,
            TieState::Taut,
            TieState::Limp,
            TieState::LimpYields,
            TieState::Yields(YieldDirection::Longer),
            TieState::Yields(YieldDirection::Shorter),
        ] {
            let plastic = Some(std::array::from_fn(|i| 0.01 * i as f64 - 0.02));
            let states = States { ties: [state; 8], plastic };
            for function in restraints::watched(&block, &states.modes()).into_iter().flatten() {
                let value = |time: f64| function.value(&block, &states, &place(time));
                let found = function.sample(&block, &states, || place(0.0), || rates);
                let case = format!("{function:?} of {state:?}");
                near(found.re, value(0.0), &case);
                near(found.eps, (value(H) - value(-H)) / (2.0 * H), &format!("rate of {case}"));
                let restraints::RestraintFunction::Tie(_, kind) = function;
                seen.insert(format!("{kind:?}"));
            }
        }
    }
    assert_eq!(seen.len(), 10, "{seen:?}");
}

/// The work to an elongation is that of the force on the way from the plastic elongation, where the spring is loose: of a tie that was
/// stretched before, and of a damper that was stretched or pressed.
#[test]
fn the_work_to_an_elongation_is_that_of_the_force_on_the_way() {
    const STEPS: u32 = 100_000;
    let [stiffness, yield_force] = [64.0, 8.0];
    for (kind, hardening, plastic, to) in [
        (LinkKind::Tie, 0.25, 0.0, 0.1),
        (LinkKind::Tie, 0.25, 0.2, 0.3),
        (LinkKind::Tie, 0.25, 0.2, 0.9),
        (LinkKind::Tie, 0.25, 0.2, 0.1),
        (LinkKind::Damper, 0.25, 0.2, 0.9),
        (LinkKind::Damper, 0.25, 0.2, 0.15),
        (LinkKind::Damper, 0.25, 0.2, -0.6),
        (LinkKind::Damper, 0.0, -0.3, 0.4),
        (LinkKind::Damper, 0.5, -0.1, -0.7),
    ] {
        let tie = Tie { stiffness, yield_force, hardening, kind, ..Tie::default() };
        let line = |s: f64, sign: f64| hardening * stiffness * s + sign * (1.0 - hardening) * yield_force;
        let step = (to - plastic) / f64::from(STEPS);
        let exact: f64 = (0..STEPS)
            .map(|i| {
                let s = plastic + (f64::from(i) + 0.5) * step;
                let force = (stiffness * (s - plastic)).clamp(line(s, -1.0), line(s, 1.0));
                if kind == LinkKind::Tie { force.max(0.0) * step } else { force * step }
            })
            .sum();
        let found = pull::work_to(Link { tie: &tie, state: TieState::Taut, plastic: Some(plastic) }, to);
        near(found, exact, &format!("work of {tie:?} from {plastic} m to {to} m"));
        let elastic = Tie { yield_force: 0.0, ..tie };
        let found = pull::work_to(Link { tie: &elastic, state: TieState::Taut, plastic: None }, to);
        let stretch = if kind == LinkKind::Tie { to.max(0.0) } else { to };
        near(found, 0.5 * stiffness * stretch * stretch, "work of a spring");
    }
}

/// The bound on circular frequencies and rates of decay is not below those of a free block, and is reached by a tie across the line
/// from the centre of mass.
#[test]
fn the_bound_on_frequencies_is_the_least() {
    let block = tied();
    let inertia = Vector3::new(block.mass, block.mass, block.mass * block.i0);
    let greatest = |block: &Block, of: fn(&Tie) -> f64| {
        let sum: Matrix3<f64> = real(block)
            .map(|(_, tie)| {
                let scaled = slopes(block, tie, [0.0; 3]).component_div(&inertia.map(f64::sqrt));
                scaled * scaled.transpose() * of(tie)
            })
            .sum();
        sum.symmetric_eigenvalues().max()
    };
    assert!(restraints::fastest(&block) >= greatest(&block, |tie| tie.stiffness).sqrt());
    let [x, z] = [0.9, -1.4];
    let end = [block.eccentricity + x, block.h + z];
    for (stiffness, damping) in [(90.0, 0.0), (90.0, 500.0)] {
        let across = Tie { block: end, ground: [end[0] - z, end[1] + x], stiffness, damping, ..Tie::default() };
        for count in 1..=2 {
            let block = block.with_ties(&[across; 2][..count]).unwrap();
            let [spring, dashpot] = [greatest(&block, |tie| tie.stiffness).sqrt(), greatest(&block, |tie| tie.damping)];
            near(restraints::fastest(&block), spring.max(dashpot), "bound");
        }
    }
}
