//! Closed forms, symmetries and balances of runs.

use nalgebra::{Matrix4, Vector4};
use rocking_block::block::{
    Block, BlockParameters, Common, Corner, Dimensionless, KelvinVoigt, Outline, Ratios, Regime, Supports,
};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Ending, Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};
use rocking_block::system::impact;

use crate::blocks::{rigid, supported as block};

pub fn one_sine(amplitude: f64, period: f64) -> Pulse {
    Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE }
}

pub fn start(block: Block, pulse: Pulse, initial: Initial, tolerance: f64) -> Simulation {
    let settings = Settings { tolerance, ..Settings::default() };
    Simulation::new(block, settings, pulse, &initial, 0.0, &Inputs::default())
}

/// Advances without inputs and returns the events.
pub fn go(simulation: &mut Simulation, until: f64) -> Vec<Event> {
    let mut events = Vec::new();
    simulation.advance(until, &Inputs::default(), &mut |event| events.push(*event)).unwrap();
    events
}

pub fn seen(simulation: &Simulation) -> Observation<f64> {
    simulation.observe(&Inputs::default())
}

#[test]
fn at_rest_the_supports_carry_half_the_weight_each() {
    let simulation = start(block(0.25, 1.0, 40.0, 0.1, 0.0), Pulse::NONE, Initial::default(), 1e-8);
    let seen = seen(&simulation);
    assert_eq!(seen.reaction, [4905.0; 2]);
    assert_eq!([seen.theta_ddot, seen.v_ddot, seen.u_ddot, seen.horizontal, seen.base_moment], [0.0; 5]);
    assert_eq!(simulation.energies().total, 0.0);
}

/// In full contact without rotation the block is a linear oscillator of circular frequency ω_v and damping ratio ξ_v.
#[test]
fn vertical_motion_in_full_contact_is_the_damped_oscillator() {
    let block = block(0.25, 1.0, 40.0, 0.1, 0.0);
    let v0 = 0.5 * block.static_deflection();
    let mut simulation = start(block, Pulse::NONE, Initial { vertical: Some((v0, 0.0)), ..Initial::default() }, 1e-12);
    let damped = block.omega_v * (1.0 - block.xi_v * block.xi_v).sqrt();
    for i in 1..=50 {
        let t = 0.02 * f64::from(i);
        assert!(go(&mut simulation, t).is_empty());
        let decay = (-block.xi_v * block.omega_v * t).exp();
        let ratio = block.xi_v * block.omega_v / damped;
        let exact = v0 * decay * ((damped * t).cos() + ratio * (damped * t).sin());
        let found = seen(&simulation).v;
        assert!((found - exact).abs() < 1e-10 * v0, "t = {t}: v = {found}, exact {exact}");
        assert_eq!(seen(&simulation).theta, 0.0);
    }
}

/// G. W. Housner, "The behavior of inverted pendulum structures during earthquakes", BSSA 53 (1963), eq. (6):
/// `T = (4/p) acosh[1/(1 − θ0/α)]`, for a slender block; its error falls with α².
#[test]
fn free_rocking_on_the_rigid_base_has_housners_period() {
    let mut errors = Vec::new();
    for alpha in [0.1, 0.05] {
        let theta0 = 0.5 * alpha;
        let mut simulation =
            start(rigid(alpha, 2.0, 0.0), Pulse::NONE, Initial { theta: theta0, ..Initial::default() }, 1e-12);
        let first = go(&mut simulation, 3.0)[0];
        let quarter = (1.0 / (1.0 - theta0 / alpha)).acosh() / 2.0;
        assert_eq!((first.before, first.after), (Regime::TiltingRight, Regime::TiltingLeft));
        errors.push(first.time / quarter - 1.0);
    }
    assert!(errors[0].abs() < 2e-3, "{errors:?}");
    let ratio = errors[0] / errors[1];
    assert!((ratio - 4.0).abs() < 0.1, "error falls by {ratio}, not 4, when alpha is halved: {errors:?}");
}

#[test]
fn each_impact_on_the_rigid_base_leaves_housners_part_of_the_energy() {
    let block = rigid(0.25, 1.0, 0.0);
    let mut simulation = start(block, Pulse::NONE, Initial { theta: 0.1, ..Initial::default() }, 1e-13);
    let mut before = simulation.energies().total;
    let events = go(&mut simulation.clone(), 5.0);
    assert!(events.len() > 1, "{events:?}");
    for event in events {
        go(&mut simulation, event.time + 1e-9);
        let after = simulation.energies().total;
        let e = 1.0 - 1.5 * 0.25_f64.sin().powi(2);
        assert!((after / before - e * e).abs() < 1e-12, "energy ratio {}, e^2 = {}", after / before, e * e);
        before = after;
    }
}

/// A slow push tilts the block on its supports until one corner carries no load: eq. (29).
#[test]
fn a_slow_push_lifts_a_corner_at_the_separation_angle() {
    let block = block(0.25, 1.0, 40.0, 0.3, 0.0);
    let mut simulation = start(block, Pulse::NONE, Initial::default(), 1e-10);
    let inputs = Inputs { a_gx: Ramp { value: 0.0, rate: -1e-3 }, ..Inputs::default() };
    let mut events = Vec::new();
    while events.is_empty() {
        let until = simulation.time() + 100.0;
        simulation.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
    }
    assert_eq!((events[0].kind, events[0].after), (EventKind::LiftOff(Corner::Left), Regime::TiltingRight));
    let mut again = start(block, Pulse::NONE, Initial::default(), 1e-10);
    again.advance(events[0].time, &inputs, &mut |_| ()).unwrap();
    let theta = again.observe(&inputs).theta;
    // The moment of the weight tilts the block slightly further.
    let exact = ((1.0 + 3.0) / (3.0 * 40.0_f64.powi(2) * 0.25_f64.sin())).asin();
    assert!((theta / exact - 1.0).abs() < 1e-4, "lifts at {theta}, eq. (29) gives {exact}");
    assert!((block.separation_angle() - exact).abs() < 1e-15);
}

/// The impact map against a direct solution of the four balance equations (14)–(17).
#[test]
fn the_impact_map_solves_the_balance_equations() {
    for (i, &(alpha, gamma, epsilon)) in
        [(0.25, 3.0, 0.0), (0.15, 1.5, 0.4), (0.6, 3.0, 1.0), (1.2, 0.7, 0.7)].iter().enumerate()
    {
        let common = Common { gamma, epsilon, mass: 7.0, ..Common::default() };
        let block = Block::from_dimensionless(
            &Dimensionless { alpha, p: 1.3, supports: Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 }) },
            &common,
        )
        .unwrap();
        for theta in [0.0, 0.01, 0.2] {
            let (v_b, theta_b) = (-0.3 - 0.1 * i as f64, -0.7);
            let (m, i0, r0) = (block.mass, block.inertia(), block.r0);
            let u_b = r0 * (alpha - theta).cos() * theta_b;
            let arm = r0 * alpha.cos() * theta.cos();
            let (sin, cos) = (alpha + theta).sin_cos();
            // Unknowns: v̇_a, θ̇_a, ∫H, ∫N.
            let matrix = Matrix4::new(
                0.0,
                m * arm,
                -1.0,
                0.0, //
                m,
                0.0,
                0.0,
                -1.0, //
                0.0,
                i0,
                r0 * cos,
                -r0 * sin, //
                1.0,
                r0 * sin,
                0.0,
                0.0,
            );
            let right = Vector4::new(m * u_b, m * v_b, i0 * theta_b, epsilon * (v_b + r0 * sin * theta_b));
            let exact = matrix.lu().solve(&right).unwrap();
            let (v_a, theta_a) = impact::landing(&block, Corner::Left, theta, v_b, theta_b);
            assert!((v_a - exact[0]).abs() < 1e-12 && (theta_a - exact[1]).abs() < 1e-12, "{v_a} {theta_a} {exact}");
            let (v_m, theta_m) = impact::landing(&block, Corner::Right, -theta, v_b, -theta_b);
            assert_eq!((v_m, theta_m), (v_a, -theta_a), "the landing on R is the mirror image");
        }
    }
}

#[test]
fn elastic_and_plastic_landings() {
    let elastic = block(0.25, 1.0, 40.0, 0.1, 1.0);
    let (v_dot, theta_dot) = impact::landing(&elastic, Corner::Left, 0.0, -0.2, -0.3);
    assert!((v_dot + 0.2).abs() < 1e-15 && (theta_dot + 0.3).abs() < 1e-15);
    let plastic = block(0.25, 1.0, 40.0, 0.1, 0.0);
    // On a rigid base the standing corner R does not move: v̇ = R0 sin α θ̇.
    let theta_dot = -0.3;
    let (v_dot, after) = impact::landing(&plastic, Corner::Left, 0.0, plastic.b * theta_dot, theta_dot);
    let e = plastic.max_restitution();
    assert!((after - e * theta_dot).abs() < 1e-15);
    assert!((v_dot + plastic.b * after).abs() < 1e-14, "the landed corner stands: {v_dot}");
}

/// A mirrored pulse gives the mirrored run.
#[test]
fn a_mirrored_excitation_gives_the_mirrored_motion() {
    for block in [block(0.25, 1.0, 40.0, 0.1, 0.2), rigid(0.25, 1.0, 0.0)] {
        let mut right = start(block, one_sine(6.0, 1.25), Initial::default(), 1e-8);
        let mut left = start(block, one_sine(-6.0, 1.25), Initial::default(), 1e-8);
        for i in 1..=100 {
            let t = 0.1 * f64::from(i);
            let (mine, mirrored) = (go(&mut right, t), go(&mut left, t));
            assert_eq!(mine.len(), mirrored.len());
            let (a, b) = (seen(&right), seen(&left));
            assert_eq!((a.theta, a.theta_dot, a.u, a.horizontal), (-b.theta, -b.theta_dot, -b.u, -b.horizontal));
            assert_eq!((a.v, a.v_dot, a.reaction), (b.v, b.v_dot, [b.reaction[1], b.reaction[0]]));
            assert_eq!((a.friction_demand, right.peaks()), (b.friction_demand, left.peaks()));
            assert_eq!(
                left.regime().number(),
                if right.regime() == Regime::Separated { 2 } else { -right.regime().number() }
            );
        }
        assert!(right.counts().impacts > 3, "{:?}", right.counts());
    }
}

/// Equal α, η, ξ_v, ε, γ and pulses in units of g and 1/p give equal rotations over p t.
#[test]
fn blocks_of_different_size_are_similar() {
    let reference = block(0.2, 1.0, 30.0, 0.15, 0.1);
    let small = block(0.2, 3.7, 30.0, 0.15, 0.1);
    let mut a = start(reference, one_sine(4.0, 1.5), Initial::default(), 1e-11);
    let mut b = start(small, one_sine(4.0, 1.5 / 3.7), Initial::default(), 1e-11);
    for i in 1..=160 {
        let t = 0.1 * f64::from(i);
        go(&mut a, t);
        go(&mut b, t / 3.7);
        let (theta, other) = (seen(&a).theta, seen(&b).theta);
        assert!((theta - other).abs() < 1e-9 * 0.2, "p t = {t}: {theta} and {other}");
    }
    assert_eq!(a.counts().impacts, b.counts().impacts);
    assert!(a.counts().impacts >= 3);
}

/// Both parametrizations of a block give the same motion.
#[test]
fn sizes_and_dimensionless_parameters_are_the_same_block() {
    let d = block(0.25, 1.0, 40.0, 0.1, 0.0);
    let outline = Outline::Sizes { width: 2.0 * d.b, height: 2.0 * d.h, inertia: None };
    let supports = d.springs().with(KelvinVoigt::Springs);
    let p = Block::new(&BlockParameters { outline, supports, common: Common::default() }).unwrap();
    for (a, b) in [
        (d.alpha, p.alpha),
        (d.r0, p.r0),
        (d.p, p.p),
        (d.omega_v, p.omega_v),
        (d.xi_v, p.xi_v),
        (d.inertia(), p.inertia()),
        (d.eta(), p.eta()),
    ] {
        assert!((a / b - 1.0).abs() < 4.0 * f64::EPSILON, "{a} and {b}");
    }
}

/// Energy is constant without dashpots and ground motion; with both, the balance has no residual.
#[test]
fn energy_is_conserved_or_accounted_for() {
    let undamped = block(0.25, 1.0, 20.0, 0.0, 0.0);
    let mut simulation = start(undamped, Pulse::NONE, Initial { theta: 0.01, ..Initial::default() }, 1e-10);
    let initial = simulation.energies().total;
    assert!(go(&mut simulation, 5.0).is_empty());
    let energies = simulation.energies();
    assert!((energies.total / initial - 1.0).abs() < 1e-9, "{energies:?}");
    assert_eq!((energies.dashpots, energies.impacts, energies.input), (0.0, 0.0, 0.0));

    for xi_v in [0.0, 0.05, 0.4] {
        let mut simulation = start(block(0.25, 1.0, 40.0, xi_v, 0.0), one_sine(6.0, 1.25), Initial::default(), 1e-10);
        go(&mut simulation, 6.0);
        let energies = simulation.energies();
        assert!(energies.residual.abs() < 1e-9 * energies.input, "{energies:?}");
        assert!(energies.input > 0.0 && (energies.dashpots > 0.0) == (xi_v > 0.0), "{energies:?}");
    }
}

/// The dashpots dissipate `C ∫ Σ v̇_I² dt`, by Simpson's rule over the history.
#[test]
fn dashpot_energy_is_the_integral_of_its_power() {
    let block = block(0.25, 1.0, 20.0, 0.2, 0.0);
    let initial = Initial { theta: 0.01, ..Initial::default() };
    let mut simulation = start(block, Pulse::NONE, initial, 1e-11);
    let power = |simulation: &Simulation| {
        // In full contact both corners move with their supports.
        let rates = simulation.observe_rates(&Inputs::default()).corner.map(|corner| corner.eps);
        block.damping * (rates[0] * rates[0] + rates[1] * rates[1])
    };
    let (mut sum, h) = (power(&simulation), 1e-3);
    for i in 1..=1000 {
        assert!(go(&mut simulation, h * f64::from(i)).is_empty());
        sum += power(&simulation)
            * if i == 1000 {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            };
    }
    let dashpots = simulation.energies().dashpots;
    assert!((sum * h / 3.0 / dashpots - 1.0).abs() < 1e-6, "Simpson {} and {dashpots}", sum * h / 3.0);
}

/// Motion and events do not depend on the communication steps, within the tolerance.
#[test]
fn the_communication_step_does_not_matter() {
    let block = block(0.25, 1.0, 40.0, 0.1, 0.0);
    let pulse = one_sine(6.2622, 1.25);
    let mut whole = start(block, pulse, Initial::default(), 1e-10);
    let events = go(&mut whole, 10.0);
    assert!(events.len() > 10, "{events:?}");
    for cuts in [7, 100, 1000, 5003] {
        let mut cut = start(block, pulse, Initial::default(), 1e-10);
        let mut found = Vec::new();
        for i in 1..=cuts {
            // Steps of very different sizes.
            let x = f64::from(i) / f64::from(cuts);
            found.extend(go(&mut cut, 10.0 * x * x));
        }
        let error = (seen(&cut).theta - seen(&whole).theta).abs() / block.alpha;
        assert!(error < 1e-8, "{cuts} steps: theta differs by {error:e} alpha");
        assert_eq!(found.len(), events.len());
        for (a, b) in found.iter().zip(&events) {
            assert_eq!((a.kind, a.before, a.after), (b.kind, b.before, b.after));
            assert!((a.time - b.time).abs() < 1e-8, "{a} and {b}");
        }
    }
}

/// A block pushed over ends its run at a quarter turn, one thrown up at complete separation.
#[test]
fn runs_end_where_they_should() {
    let mut overturns = start(block(0.15, 2.0, 40.0, 0.1, 0.0), one_sine(8.0, 1.05), Initial::default(), 1e-10);
    let progress = overturns.advance(10.0, &Inputs::default(), &mut |_| ()).unwrap();
    let Progress::Ended(Ending::Overturned, time) = progress else { panic!("{progress:?}") };
    assert_eq!(overturns.time(), time);
    assert!((seen(&overturns).theta.abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-13);
    assert_eq!(overturns.advance(11.0, &Inputs::default(), &mut |_| ()).unwrap(), progress);

    let thrown = block(0.25, 1.0, 40.0, 0.0, 0.0);
    let deep = -3.0 * thrown.static_deflection();
    let mut separates =
        start(thrown, Pulse::NONE, Initial { vertical: Some((deep, 0.0)), ..Initial::default() }, 1e-12);
    let progress = separates.advance(10.0, &Inputs::default(), &mut |_| ()).unwrap();
    let Progress::Ended(Ending::Separated, time) = progress else { panic!("{progress:?}") };
    // v = −3 δ cos ω t reaches δ, where both springs are free.
    let exact = (-1.0_f64 / 3.0).acos() / thrown.omega_v;
    assert!((time - exact).abs() < 1e-12, "{time} and {exact}");
    assert_eq!(separates.regime(), Regime::Separated);
    assert_eq!(seen(&separates).reaction, [0.0; 2]);
}

/// A lift-off adds kinetic energy of about `M R0² θ̇² sin α cos α |θ|`.
#[test]
fn a_lift_off_adds_the_energy_of_the_new_constraint() {
    let block = block(0.25, 1.0, 20.0, 0.0, 0.0);
    let initial = Initial { theta_dot: 0.15, ..Initial::default() };
    let mut simulation = start(block, Pulse::NONE, initial, 1e-12);
    let mut first = None;
    let mut look = |event: &Event| first = first.or(Some(event.time));
    simulation.clone().advance(1.0, &Inputs::default(), &mut look).unwrap();
    let time = first.unwrap();
    go(&mut simulation, time - 1e-10);
    let (before, at) = (simulation.energies().total, seen(&simulation));
    go(&mut simulation, time + 1e-10);
    assert_eq!(simulation.regime(), Regime::TiltingRight);
    let added = simulation.energies().total - before;
    let estimate =
        block.mass * block.r0.powi(2) * at.theta_dot.powi(2) * block.alpha.sin() * block.alpha.cos() * at.theta.abs();
    assert!((added / estimate - 1.0).abs() < 0.02, "{added} J, estimated {estimate} J");
}

/// Landings with ε = 0 on supports that have almost crept back do not chatter.
///
/// The reaction is then zero up to round-off. Its sign must not make the corner hop endlessly, nor count as a separation.
#[test]
fn landings_without_rebound_do_not_chatter() {
    let pulse = one_sine(6.2622, 1.2566);
    for p in [0.623_335_943_617_854_4, 0.55, 0.6, 0.65] {
        let mut simulation = start(block(0.25, p, 40.0, 0.1, 0.0), pulse, Initial::default(), 1e-8);
        let mut events = Vec::new();
        for i in 1..=1000 {
            events.extend(go(&mut simulation, 0.01 * f64::from(i)));
        }
        assert_eq!(simulation.ending(), None, "p = {p}");
        assert!((6..30).contains(&events.len()), "p = {p}: {} events", events.len());
    }
}

/// The energy of a changed horizontal constraint is the change of kinetic energy without the landing loss.
///
/// The landing of a corner without horizontal motion takes `½ (1 − ε²) v̇_I²` times its effective mass.
#[test]
fn the_energy_of_the_constraint_is_that_of_the_horizontal_motion() {
    let block = block(0.5, 1.0, 15.0, 0.2, 0.4);
    let initial = Initial { theta: 0.3, ..Initial::default() };
    let mut simulation = start(block, Pulse::NONE, initial, 1e-12);
    let (inputs, mut kinds, mut expected) = (Inputs::default(), [0, 0], 0.0);
    while kinds.iter().sum::<u32>() < 6 {
        let start = simulation.time();
        assert!(start < 10.0, "{kinds:?}");
        simulation.advance_to_event(start + 1.0, start, &inputs, &mut |_| ()).unwrap();
        if !simulation.is_at_event() {
            continue;
        }
        let before = (seen(&simulation), simulation.energies().kinetic);
        let mut events = Vec::new();
        simulation.apply_pending_event(&inputs, &mut |event| events.push(*event)).unwrap();
        expected += simulation.energies().kinetic - before.1;
        match events[0].kind {
            EventKind::LiftOff(_) => kinds[0] += 1,
            EventKind::Landing(corner) => {
                let s = corner.sign();
                let phi = block.alpha + s * before.0.theta;
                let rate = before.0.v_dot + s * block.r0 * phi.sin() * before.0.theta_dot;
                let (reach, height) = (block.r0 * phi.sin(), block.r0 * phi.cos());
                let feels = block.mass / (1.0 + reach * reach / (block.i0 + height * height));
                expected += 0.5 * (1.0 - 0.4 * 0.4) * feels * rate * rate;
                kinds[1] += 1;
            }
            other => panic!("{other:?}"),
        }
        let found = simulation.energies().constraint;
        assert!((found - expected).abs() < 1e-10 * before.1, "{found} J, not {expected} J after {}", events[0]);
        assert!(found.abs() > 1e-6 * before.1, "{found} J of {} J", before.1);
    }
    assert_eq!(kinds, [3, 3]);
}

/// A block that separates beyond α and still turning outwards has toppled.
#[test]
fn a_block_that_separates_on_its_way_over_has_toppled() {
    for (theta, theta_dot, ending) in [
        (0.3, 0.1, Ending::Toppled),
        (-0.3, -0.1, Ending::Toppled),
        (0.3, -0.1, Ending::Separated),
        (-0.3, 0.4, Ending::Separated),
        (0.3, 0.0, Ending::Separated),
        (0.1, 0.1, Ending::Separated),
    ] {
        assert_eq!(Ending::at_separation(0.2, theta, theta_dot), ending, "{theta}, {theta_dot}");
    }
    let of = |ending: Ending| (ending.is_separation(), ending.is_overturning());
    assert_eq!(
        [Ending::Separated, Ending::Toppled, Ending::Overturned].map(of),
        [(true, false), (true, true), (false, true)]
    );
}

/// In each initial regime the motion starts with the stated values.
#[test]
fn a_run_begins_with_the_given_motion() {
    let block = block(0.25, 1.0, 20.0, 0.1, 0.0);
    let (free, p) = (block.static_deflection(), block.p);
    for (theta, sinks, regime) in [
        (0.1, 0.5, Regime::TiltingRight),
        (-0.1, 0.5, Regime::TiltingLeft),
        (0.002, 0.0, Regime::FullContact),
        (0.1, -3.0, Regime::Separated),
    ] {
        // Depth of the lower corner below its position at rest, in static deflections.
        let v = block.r0 * (libm::cos(block.alpha - f64::abs(theta)) - libm::cos(block.alpha)) - sinks * free;
        let (theta_dot, v_dot) = (-0.03 * p, 0.02 * block.r0 * p);
        let initial = Initial { theta, theta_dot, vertical: Some((v, v_dot)) };
        let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
        let simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
        let seen = seen(&simulation);
        assert_eq!((seen.regime, seen.theta, seen.theta_dot), (regime, theta, theta_dot));
        assert!((seen.v - v).abs() < 1e-14 * block.r0, "{regime}: v = {}, not {v}", seen.v);
        assert!((seen.v_dot - v_dot).abs() < 1e-14 * block.r0, "{regime}: v_dot = {}, not {v_dot}", seen.v_dot);
    }
}
