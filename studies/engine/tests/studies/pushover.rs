//! Slow rotations: closed forms, mirror images, the work of a cycle, and slow runs.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, Body, Common, Corner, Dimensionless, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_studies::pushover::statics::Equilibrium;
use rocking_studies::pushover::table::table;
use rocking_studies::pushover::{LandmarkKind, Push, Pushover};

const SUPPORTS: Supports<Ratios> = Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.2 });

fn block(supports: Supports<Ratios>, eccentricity_ratio: f64, links: &[Tie]) -> Block {
    let given = Dimensionless { alpha: 0.25, p: 1.0, supports };
    let plain = Block::from_dimensionless(&given, &Common::default()).unwrap();
    let common = Common { eccentricity: eccentricity_ratio * plain.b, ..Common::default() };
    Block::from_dimensionless(&given, &common).unwrap().with_ties(links).unwrap()
}

/// Returns a vertical link between a point of the base, over half the width, and the ground half a width below; forces in parts of the weight.
fn vertical(kind: LinkKind, x: f64, [stiffness, yield_force, hardening, pretension]: [f64; 4]) -> Tie {
    let Body { b, mass, gravity, .. } = block(SUPPORTS, 0.0, &[]).body;
    let weight = mass * gravity;
    Tie {
        block: [x * b, 0.0],
        ground: [x * b, -b],
        stiffness: stiffness * weight / b,
        yield_force: yield_force * weight,
        pretension: pretension * weight,
        hardening,
        kind,
        ..Tie::default()
    }
}

fn push(over: Corner, to: Option<f64>, amplitude: Option<f64>) -> Push {
    Push { over, to, amplitude, points: 400 }
}

fn words(pushover: &Pushover) -> Vec<String> {
    pushover.landmarks.iter().map(|landmark| landmark.kind.to_string()).collect()
}

fn close(found: f64, expected: f64, scale: f64, place: &str) {
    assert!((found - expected).abs() <= 1e-12 * scale, "{place}: {found}, not {expected}");
}

#[test]
fn a_free_block_on_a_rigid_base_resists_with_its_weight() {
    for eccentricity in [0.0, 0.3] {
        let block = block(Supports::HOUSNER, eccentricity, &[]);
        let weight = block.mass * block.gravity;
        for over in Corner::BOTH {
            let pushover = Pushover::of(&block, &push(over, None, None)).unwrap();
            let (angle, sign) = (block.alpha_of(over), -over.sign());
            let arm = block.h.hypot(block.offset(over));
            let lifts = format!("{} lifts", if over == Corner::Right { "L" } else { "R" });
            assert_eq!(words(&pushover), ["at rest", &lifts, "greatest force", "balance"]);
            for row in &pushover.rows[1..] {
                let exact = weight * arm * libm::sin(angle - row.theta.abs()) * sign;
                close(row.moment, exact, weight * arm, "moment");
                let exact = weight * libm::tan(angle - row.theta.abs()) * sign;
                close(row.force, exact, weight, "force");
                close(row.horizontal, -row.force, weight, "H");
            }
            let [first, second, .., last] = &pushover.rows[..] else { panic!("{pushover:?}") };
            close(first.force, 0.0, weight, "force at rest");
            assert!(first.theta == 0.0 && second.theta == 0.0 && second.force * sign > 0.1 * weight);
            close(last.theta, sign * angle, 1.0, "end");
        }
    }
}

/// Up to the lift-off at sin θ = δ_s/b, eq. (29), the supports resist with 2 K b² sin θ cos θ; then the weight does, as on a rigid base.
#[test]
fn supports_resist_elastically_until_a_corner_lifts() {
    let block = block(SUPPORTS, 0.0, &[]);
    let weight = block.mass * block.gravity;
    let pushover = Pushover::of(&block, &push(Corner::Right, None, None)).unwrap();
    assert_eq!(words(&pushover), ["at rest", "L lifts", "greatest force", "balance"]);
    let lift_off = pushover.landmarks[1].at;
    close(lift_off.theta, block.separation_angle(), 1.0, "lift-off");
    for row in &pushover.rows {
        let (sin, cos) = row.theta.sin_cos();
        let exact = if row.theta <= lift_off.theta && row.reaction[0] > 0.0 {
            2.0 * block.stiffness * block.b * block.b * sin * cos - weight * block.h * sin
        } else {
            weight * block.r0 * libm::sin(block.alpha - row.theta)
        };
        close(row.moment, exact, weight * block.r0, "moment");
        close(row.reaction[0] + row.reaction[1], weight, weight, "reactions");
    }
}

/// A tendon through the middle of the base of a block on a rigid base, by plane geometry: its place turns about the standing corner.
#[test]
fn a_yielding_tendon_adds_its_bilinear_force_times_its_arm() {
    let (hardening, yield_force, pretension) = (0.1, 0.5, 0.2);
    let tendon = vertical(LinkKind::Tie, 0.0, [2.0, yield_force, hardening, pretension]);
    let block = block(Supports::HOUSNER, 0.0, &[tendon]);
    let Block { alpha, body: Body { b, r0, .. }, .. } = block;
    let weight = block.mass * block.gravity;
    let pushover = Pushover::of(&block, &push(Corner::Right, Some(0.5), None)).unwrap();
    assert_eq!(words(&pushover), ["at rest", "L lifts", "greatest force", "tie 1 yields", "balance"]);
    let geometry = |theta: f64| {
        let [x, z] = [b - b * libm::cos(theta), b * libm::sin(theta) + b];
        let length = x.hypot(z);
        // The distance of the line through (0, −b) along (x, z) from the corner (b, 0).
        (length - b, (b * z - b * x).abs() / length)
    };
    for row in pushover.rows.iter().filter(|row| row.theta > 0.0) {
        let (longer, arm) = geometry(row.theta);
        let elastic = tendon.stiffness * longer + tendon.pretension;
        let yielding = hardening * elastic + (1.0 - hardening) * tendon.yield_force;
        let exact = weight * r0 * libm::sin(alpha - row.theta) + elastic.min(yielding) * arm;
        close(row.moment, exact, weight * r0, "moment");
        close(row.resisting[0], elastic.min(yielding) * arm, weight * r0, "moment of the tendon");
    }
    let first = pushover.landmarks[3].at;
    close(tendon.stiffness * geometry(first.theta).0, tendon.yield_force - tendon.pretension, weight, "yielding");
}

/// The force of a damper under the middle of the base goes twice through its bilinear loop in a cycle.
#[test]
fn a_cycle_loses_the_area_of_pragers_loop() {
    let amplitude = 0.1;
    for (hardening, yield_force) in [(0.0, 0.1), (0.05, 0.3), (0.2, 0.9)] {
        let damper = vertical(LinkKind::Damper, 0.0, [50.0, yield_force, hardening, 0.0]);
        let block = block(Supports::HOUSNER, 0.0, &[damper]);
        let weight = block.mass * block.gravity;
        let found = Pushover::of(&block, &push(Corner::Right, None, Some(amplitude))).unwrap();
        let cycle = found.cycle.unwrap();
        let half = 0.5 * cycle.rows.iter().map(|row| row.restraints[0].elongation).fold(0.0, f64::max);
        let exact = 8.0 * (1.0 - hardening) * damper.yield_force * (half - damper.yield_force / damper.stiffness);
        close(cycle.lost[0], exact, weight * block.b, "energy");
        let last = cycle.rows.last().unwrap();
        close(cycle.equivalent_damping, exact / (TAU * last.moment * amplitude), 1.0, "damping");
        let of_weight = weight * block.r0 * libm::sin(block.alpha - amplitude);
        close(cycle.recentring, of_weight / last.resisting[0], 1.0, "recentring ratio");
        assert_eq!(cycle.residual, 0.0);
    }
}

/// A damper under the lifted corner resists with 2 b F_y, the weight with M g b: beyond F_y = M g/2 the block does not return upright.
#[test]
fn a_recentring_ratio_below_one_leaves_a_rotation() {
    for (yield_force, recentres) in [(0.4, true), (0.6, false)] {
        let damper = vertical(LinkKind::Damper, -1.0, [1000.0, yield_force, 0.0, 0.0]);
        let block = block(Supports::HOUSNER, 0.0, &[damper]);
        let cycle = Pushover::of(&block, &push(Corner::Right, None, Some(0.02))).unwrap().cycle.unwrap();
        assert_eq!(cycle.recentring > 1.0, recentres, "{}", cycle.recentring);
        assert_eq!(cycle.residual == 0.0, recentres, "{}", cycle.residual);
    }
}

/// A block with all that it can have but friction.
fn with_everything(supports: Supports<Ratios>, eccentricity: f64) -> Block {
    let guy =
        Tie { block: [0.0, 8.0], ground: [-9.0, 0.0], stiffness: 2e3, slack: 0.05, damping: 50.0, ..Tie::default() };
    block(
        supports,
        eccentricity,
        &[
            vertical(LinkKind::Tie, 0.0, [2.0, 0.4, 0.1, 0.2]),
            guy,
            vertical(LinkKind::Damper, -0.9, [20.0, 0.05, 0.02, 0.0]),
            vertical(LinkKind::Damper, 0.9, [20.0, 0.05, 0.02, 0.0]),
        ],
    )
}

/// The work of the lateral force around a closed cycle is lost in yielding, whatever else the block has.
#[test]
fn the_work_of_a_cycle_is_lost_in_yielding() {
    for supports in [SUPPORTS, Supports::HOUSNER] {
        for eccentricity in [0.0, 0.2] {
            let block = with_everything(supports, eccentricity);
            let mut push = push(Corner::Left, None, Some(0.06));
            push.points = 4000;
            let cycle = Pushover::of(&block, &push).unwrap().cycle.unwrap();
            let lost: f64 = cycle.lost.iter().sum();
            let start = cycle.rows.iter().position(|row| row.theta == -0.06).unwrap();
            let closed = &cycle.rows[start..];
            // The cycle begins where it ends.
            let (first, last) = (closed[0], closed[closed.len() - 1]);
            assert_eq!(first.theta, last.theta);
            let work: f64 =
                closed.windows(2).map(|pair| 0.5 * (pair[0].force + pair[1].force) * (pair[1].u - pair[0].u)).sum();
            assert!(lost > 0.0 && (work - lost).abs() < 1e-4 * lost, "{supports:?} {eccentricity}: {work} J, {lost} J");
        }
    }
}

#[test]
fn a_mirrored_block_has_the_mirrored_curve() {
    let mirrored =
        |link: &Tie| Tie { block: [-link.block[0], link.block[1]], ground: [-link.ground[0], link.ground[1]], ..*link };
    for supports in [SUPPORTS, Supports::HOUSNER] {
        let original = with_everything(supports, 0.2);
        let mut links: Vec<Tie> = original.ties().iter().map(mirrored).collect();
        links.swap(2, 3);
        let mirror = block(supports, -0.2, &links);
        let [one, other] = [(original, Corner::Right), (mirror, Corner::Left)]
            .map(|(block, over)| Pushover::of(&block, &push(over, None, Some(0.05))).unwrap());
        assert_eq!(one.rows.len(), other.rows.len());
        let weight = original.mass * original.gravity;
        let (one_rows, other_rows) = (one.rows.iter().chain(&one.cycle.as_ref().unwrap().rows), &other.rows);
        for (row, image) in one_rows.zip(other_rows.iter().chain(&other.cycle.as_ref().unwrap().rows)) {
            close(row.theta, -image.theta, 1.0, "theta");
            close(row.force, -image.force, 100.0 * weight, "force");
            close(row.v, image.v, original.r0, "v");
            close(row.reaction[0], image.reaction[1], 100.0 * weight, "reaction");
        }
        let [one, other] = [one.cycle.unwrap(), other.cycle.unwrap()];
        close(one.equivalent_damping, other.equivalent_damping, 1.0, "damping");
        close(one.residual, other.residual, 1.0, "residual");
    }
}

/// Runs of the same block under a slowly growing lateral force follow the curve.
#[test]
fn slow_runs_follow_the_curve() {
    const DURATION: f64 = 2000.0;
    for supports in [SUPPORTS, Supports::HOUSNER] {
        let mut links = vec![
            vertical(LinkKind::Tie, 0.0, [8.0, 0.4, 0.7, 0.2]),
            vertical(LinkKind::Damper, -0.9, [20.0, 0.05, 0.02, 0.0]),
        ];
        // The force never falls, so that a run can follow it, and dashpots end vibrations.
        links.iter_mut().for_each(|link| link.damping = 0.01 * link.stiffness);
        let block = block(supports, 0.0, &links);
        let curve = Pushover::of(&block, &push(Corner::Right, Some(0.12), None)).unwrap();
        let names = words(&curve);
        assert!(names.iter().any(|name| name == "damper 1 yields") && names.iter().any(|name| name == "tie 1 yields"));
        let rising: Vec<&Equilibrium> = curve.rows.iter().filter(|row| row.theta > 0.0).collect();
        // At the lift-off the lever of the force changes from that of the middle of the base to that of the corner.
        let weight = block.mass * block.gravity;
        assert!(rising.windows(2).all(|pair| pair[1].force > pair[0].force - 2e-3 * weight), "{:?}", words(&curve));
        let greatest = rising.last().unwrap().force;
        let rate = greatest / DURATION;
        let inputs = Inputs { f_x: Ramp { value: 0.0, rate }, ..Inputs::default() };
        let settings = Settings { on_separation: OnSeparation::Fly, tolerance: 1e-9, ..Settings::default() };
        let mut run = Simulation::new(block, settings, Pulse::NONE, &Initial::default(), 0.0, &inputs);
        let lift_off =
            curve.landmarks.iter().find(|landmark| landmark.kind == LandmarkKind::LiftOff(Corner::Left)).unwrap();
        let mut compared = 0;
        for row in rising.iter().step_by(16) {
            run.advance(row.force / rate, &inputs, &mut |_| ()).unwrap();
            let [theta, ..] = run.state().0;
            let after = rising.iter().position(|row| row.theta > theta).unwrap_or(rising.len() - 1).max(1);
            let [from, to] = [rising[after - 1], rising[after]];
            let force = from.force + (to.force - from.force) * (theta - from.theta) / (to.theta - from.theta);
            // The dashpots hold a little back. The run passes the jump at the lift-off with a swing.
            let is_near_lift_off = (row.force - lift_off.at.force).abs() < 5e-3 * weight;
            if !is_near_lift_off {
                let difference = (force - row.force) / weight;
                assert!(difference.abs() < 1e-4, "{supports:?}: {difference} at {theta}");
                compared += 1;
            }
        }
        assert!(compared > 20);
    }
}

#[test]
fn friction_ends_the_curve() {
    for supports in [SUPPORTS, Supports::HOUSNER] {
        for over in Corner::BOTH {
            let slippery = Block::from_dimensionless(
                &Dimensionless { alpha: 0.25, p: 1.0, supports },
                &Common { friction: 0.2, ..Common::default() },
            )
            .unwrap();
            let curve = Pushover::of(&slippery, &push(over, None, None)).unwrap();
            assert_eq!(words(&curve), ["at rest", "slides"]);
            let (last, weight) = (curve.rows.last().unwrap(), slippery.mass * slippery.gravity);
            close(last.force, -0.2 * weight * over.sign(), weight, "sliding");
            close(last.horizontal, -last.force, weight, "H");
            close(last.reaction[0] + last.reaction[1], weight, weight, "N");
            close(last.moment, last.force * slippery.h * libm::cos(last.theta), weight * slippery.h, "moment");
        }
    }
}

#[test]
fn friction_and_strength_end_or_break_cycles() {
    let slippery = Block::from_dimensionless(
        &Dimensionless { alpha: 0.25, p: 1.0, supports: SUPPORTS },
        &Common { friction: 0.2, ..Common::default() },
    )
    .unwrap();
    let error = Pushover::of(&slippery, &push(Corner::Right, None, Some(0.1))).unwrap_err();
    assert!(error.to_string().starts_with("cycles of 0.1 rad end at theta = "), "{error}");
    assert!(error.to_string().ends_with(", where the block slides; expected a smaller amplitude"), "{error}");
    let mut weak = vertical(LinkKind::Tie, 0.0, [8.0, 0.0, 0.0, 0.2]);
    weak.strength = 0.3 * slippery.mass * slippery.gravity;
    let block = block(SUPPORTS, 0.0, &[weak]);
    let curve = Pushover::of(&block, &push(Corner::Right, None, None)).unwrap();
    let broken = curve.landmarks.iter().find(|landmark| landmark.kind.to_string() == "tie 1 breaks").unwrap();
    close(broken.at.restraints[0].pull, weak.strength, weak.strength, "strength");
    // Two rows at the rotation where the tie breaks.
    let peak = curve.landmarks.iter().find(|landmark| landmark.kind == LandmarkKind::Peak).unwrap();
    let lets_go = |pair: &&[Equilibrium]| pair[0].restraints[0].pull > 0.0 && pair[1].restraints[0].pull == 0.0;
    let Some(&[before, after]) = curve.rows.windows(2).find(lets_go) else { panic!("{:?}", words(&curve)) };
    assert!(before.force > after.force && [before.theta, after.theta] == [broken.at.theta; 2]);
    assert_eq!([peak.at.force, peak.at.theta], [before.force, before.theta]);
}

#[test]
fn impossible_curves_are_refused() {
    let block = block(SUPPORTS, 0.0, &[]);
    for value in [0.0, -0.1, FRAC_PI_2, PI, f64::NAN] {
        let error = Pushover::of(&block, &push(Corner::Right, Some(value), None)).unwrap_err();
        assert!(error.to_string().starts_with(&format!("to = {value} rad; expected")), "{error}");
        let error = Pushover::of(&block, &push(Corner::Right, None, Some(value))).unwrap_err();
        assert!(error.to_string().starts_with(&format!("amplitude = {value} rad; expected")), "{error}");
    }
    let points = Push { points: 0, ..push(Corner::Right, None, None) };
    assert_eq!(Pushover::of(&block, &points).unwrap_err().to_string(), "points = 0; expected 1 to 100000 steps");
}

#[test]
fn the_table_has_the_columns_of_links() {
    let block = with_everything(SUPPORTS, 0.1);
    let curve = Pushover::of(&block, &push(Corner::Right, None, None)).unwrap();
    let table = table(&block, &curve.rows);
    let names: Vec<&str> = table.columns().iter().map(|column| column.heading.name.as_str()).collect();
    assert_eq!(names[..4], ["theta", "u", "v", "moment"]);
    assert_eq!(names[10..14], ["tie_1.tension", "tie_1.moment", "tie_1.elongation", "tie_1.plastic"]);
    assert_eq!(names[14..17], ["tie_2.tension", "tie_2.moment", "damper_1.force"]);
    assert_eq!(table.rows(), curve.rows.len());
}
