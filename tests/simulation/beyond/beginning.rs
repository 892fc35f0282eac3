//! The first instant of uneven and tied blocks.

use rocking_block::block::restraints::tie::{TieEvent, YieldDirection};
use rocking_block::block::restraints::{LinkKind, RestraintEvent, Tie, TieState};
use rocking_block::block::{Block, Body, Common, Corner, Foundation, Regime};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Ending, Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::EventKind;

use crate::blocks::{block, block_on};

fn first_instant(block: Block, initial: Initial) -> (Simulation, Observation<f64>) {
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
    let seen = simulation.observe(&Inputs::default());
    (simulation, seen)
}

/// A settled start balances supports, weight and the springs of the ties vertically, at any tilt, whether ties press the block down or
/// almost carry it, and whether they are taut only beyond the position that the weight alone would have.
#[test]
fn a_settled_start_is_in_vertical_balance() {
    let mut regimes = vec![];
    for eccentricity in [-0.2, 0.0, 0.3] {
        let plain = block([0.3, 1.5, 20.0, 0.2], &Common { eccentricity, ..Common::default() });
        let Body { mass, gravity, b, h, .. } = plain.body;
        let (weight, sunk) = (mass * gravity, plain.static_deflection());
        for theta in [-0.2, -0.02, 0.0, 0.02, 0.2] {
            for (end, ground, pretension, slack) in [
                ([0.5 * b, h], [0.6 * b, -h], 0.3, 0.0),
                ([-b, 2.0 * h], [-3.0 * b, 0.0], 0.5, 0.0),
                ([b, h], [2.0 * b, 4.0 * h], 0.9, 0.0),
                ([b, 0.5 * h], [1.5 * b, 2.0 * h], 0.0, 0.5 * sunk),
                ([-b, 2.0 * h], [-1.2 * b, 0.0], 8.0, 0.0),
            ] {
                let tie = Tie {
                    block: end,
                    ground,
                    stiffness: 0.5 * plain.stiffness,
                    pretension: pretension * weight,
                    slack,
                    ..Tie::default()
                };
                let (_, seen) =
                    first_instant(plain.with_ties(&[tie]).unwrap(), Initial { theta, ..Initial::default() });
                let case = format!("{eccentricity} m, {theta} rad, {tie:?}: {seen:?}");
                assert!(seen.v_ddot.abs() < 1e-9 * gravity && seen.v_dot.abs() < 1e-12, "{case}");
                regimes.push(seen.regime);
            }
        }
    }
    for regime in [Regime::TiltingLeft, Regime::FullContact, Regime::TiltingRight] {
        assert!(regimes.iter().filter(|&&found| found == regime).count() > 5, "{regimes:?}");
    }
}

/// The initial height and its rate are those of the centre of mass; the foot stands at its initial position. In flight the middle of the base is
/// where it was.
#[test]
fn an_uneven_block_begins_at_its_height() {
    for eccentricity in [-0.2, 0.3] {
        let block = block([0.3, 1.5, 20.0, 0.2], &Common { eccentricity, ..Common::default() });
        let h = block.h;
        for (theta, theta_dot, v, v_dot, regime) in [
            (0.01, 0.1, -0.02, 0.03, Regime::FullContact),
            (-0.2, -0.3, 0.1, -0.2, Regime::TiltingLeft),
            (0.25, 0.2, 0.6, 0.4, Regime::Separated),
        ] {
            let initial = Initial { theta, theta_dot, vertical: Some((v, v_dot)) };
            let (_, seen) = first_instant(block, initial);
            assert_eq!(seen.regime, regime, "{seen:?}");
            let (sin, cos) = theta.sin_cos();
            let near = |found: f64, exact: f64| (found - exact).abs() < 1e-13;
            assert!(near(seen.v, v) && near(seen.v_dot, v_dot) && seen.theta == theta, "{seen:?}");
            // The centre of mass is (e, h) from the middle of the base, at rest and turned.
            let (u, u_dot) = (eccentricity * cos + h * sin - eccentricity, (h * cos - eccentricity * sin) * theta_dot);
            if regime != Regime::TiltingLeft {
                assert!(near(seen.u, u) && near(seen.u_dot, u_dot), "{seen:?}, expected {u} m, {u_dot} m/s");
            }
        }
    }
}

/// A block in the air topples beyond the slenderness angle of the side to which it tilts, which differ if it is eccentric.
#[test]
fn an_uneven_block_topples_beyond_the_angle_of_its_side() {
    for eccentricity in [-0.2, 0.2] {
        let block = block([0.3, 1.5, 20.0, 0.2], &Common { eccentricity, ..Common::default() });
        let angles = Corner::BOTH.map(|corner| block.alpha_of(corner));
        let between = 0.5 * (angles[0] + angles[1]);
        for (corner, side) in [(Corner::Left, -1.0), (Corner::Right, 1.0)] {
            let initial = Initial { theta: side * between, theta_dot: side * 0.1, vertical: Some((block.h, 0.0)) };
            let run = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &Inputs::default());
            let expected = if block.alpha_of(corner) < between { Ending::Toppled } else { Ending::Separated };
            assert_eq!(run.ending(), Some((expected, 0.0)), "{eccentricity} m, {corner:?}, {angles:?} rad");
        }
    }
}

/// A stretched tie begins taut; limp if its dashpot would push; broken if its tension would exceed its strength.
#[test]
fn ties_begin_taut_limp_or_broken() {
    use TieState::{Broken, Limp, Slack, Taut};
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let Body { b, h, mass, gravity, .. } = plain.body;
        let weight = mass * gravity;
        let mut found = vec![];
        for (theta_dot, slack, damping, strength) in [
            (0.0, 0.0, 0.0, 0.0),
            (0.3, 0.0, 1.0, 0.0),
            (-0.3, 0.0, 1.0, 0.0),
            (-2.0, 0.0, 1.0, 0.0),
            (0.3, 0.0, 1.0, 0.5),
            (0.3, 0.0, 1.0, 20.0),
            (-2.0, 0.0, 1.0, 0.01),
            (2.0, 1.0, 1.0, 0.01),
        ] {
            let tie = Tie {
                block: [-b, 2.0 * h],
                ground: [-5.0 * b, 0.0],
                stiffness: 20.0 * weight,
                slack,
                damping: damping * weight,
                strength: strength * weight,
                ..Tie::default()
            };
            let initial = Initial { theta: 0.05, theta_dot, ..Initial::default() };
            let (run, seen) = first_instant(plain.with_ties(&[tie]).unwrap(), initial);
            // The end at the block from the centre of mass, turned, and from the end at the ground.
            let (sin, cos) = seen.theta.sin_cos();
            let [x, z] = [h * sin - b * cos, h * cos + b * sin];
            let [across, up] = [seen.u + x + 5.0 * b, seen.v + h + z];
            let length = across.hypot(up);
            let stretch = length - (4.0 * b).hypot(2.0 * h) - slack;
            let rate = (across * (seen.u_dot + z * theta_dot) + up * (seen.v_dot - x * theta_dot)) / length;
            let tension = tie.stiffness * stretch + tie.damping * rate;
            let expected = match (stretch, tension) {
                (s, _) if s < 0.0 => (Slack, 0.0),
                (_, t) if t < 0.0 => (Limp, 0.0),
                (_, t) if strength > 0.0 && t > tie.strength => (Broken, 0.0),
                (_, t) => (Taut, t),
            };
            assert_eq!(run.restraints().ties[0], expected.0, "{theta_dot} rad/s, {strength}: {tension} N");
            let shown = seen.restraints[0].pull;
            assert!((shown - expected.1).abs() < 1e-11 * weight, "{shown} N, expected {expected:?}");
            found.push(expected.0);
        }
        assert_eq!(found, [Taut, Taut, Taut, Limp, Broken, Taut, Limp, Slack]);
    }
}

/// A link beyond its yield force begins on the line `r k s ± (1 − r) F_y`, and breaks only if this exceeds its strength.
#[test]
fn links_beyond_their_yield_force_begin_to_yield() {
    use LinkKind::{Damper, Tie as Cable};
    use TieState::{Broken, Slack, Taut, Yields};
    use YieldDirection::{Longer, Shorter};
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let Body { b, h, mass, gravity, .. } = plain.body;
        let (weight, hardening) = (mass * gravity, 0.25);
        // Forces over the elastic one.
        for (kind, side, yields_at, breaks_at, expected) in [
            (Cable, 1.0, 0.0, 0.0, Taut),
            (Cable, 1.0, 1.1, 0.0, Taut),
            (Cable, 1.0, 0.4, 0.0, Yields(Longer)),
            (Cable, 1.0, 0.4, 0.6, Yields(Longer)),
            (Cable, 1.0, 0.4, 0.5, Broken),
            (Cable, -1.0, 0.4, 0.5, Slack),
            (Damper, 1.0, 0.4, 0.0, Yields(Longer)),
            (Damper, -1.0, 1.1, 0.0, Taut),
            (Damper, -1.0, 0.4, 0.6, Yields(Shorter)),
            (Damper, -1.0, 0.4, 0.5, Broken),
        ] {
            let bare =
                Tie { block: [0.0, h], ground: [-side * 5.0 * b, h], stiffness: 0.5 * weight, kind, ..Tie::default() };
            let initial = Initial { theta: 0.1, ..Initial::default() };
            let begin = |tie| first_instant(plain.with_ties(&[tie]).unwrap(), initial);
            // The stretch does not depend on the law of the spring, except for the height of a settled block.
            let at = |tie: Tie| {
                let (run, seen) = begin(tie);
                (run.restraints().ties[0], seen.restraints[0], run.plastic_elongations()[0])
            };
            let s = at(bare).1.elongation;
            assert!(s * side > 0.05 * b, "{s} m");
            let elastic = bare.stiffness * s.abs();
            let tie = Tie { yield_force: yields_at * elastic, strength: breaks_at * elastic, hardening, ..bare };
            let (state, shown, plastic) = at(tie);
            let case = format!("{foundation:?}, {tie:?}: {shown:?}");
            assert_eq!(state, expected, "{case}");
            let s = shown.elongation;
            let (pull, lasting) = match state {
                Slack | Broken => (0.0, 0.0),
                Taut => (tie.stiffness * s, 0.0),
                _ => {
                    let pull = hardening * tie.stiffness * s + side * (1.0 - hardening) * tie.yield_force;
                    (pull, s - pull / tie.stiffness)
                }
            };
            assert!((shown.pull - pull).abs() < 1e-12 * weight, "{case}, expected {pull} N");
            assert!((plastic - lasting).abs() < 1e-12 * b && shown.plastic == plastic, "{case}, expected {lasting} m");
        }
    }
}

/// A tie without slack is taut at rest, whatever the round-off of its stretch, and slack if it begins to shorten.
#[test]
fn ties_without_slack_begin_taut() {
    for (i, foundation) in (0..20).flat_map(|i| [(i, Foundation::Viscoelastic), (i, Foundation::Rigid)]) {
        let plain = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let Body { b, h, mass, gravity, .. } = plain.body;
        let reach = 1.0 + 0.37 * f64::from(i);
        let guys = [-1.0, 1.0].map(|side| Tie {
            block: [side * b, 1.3 * h],
            ground: [side * (b + reach), 0.0],
            stiffness: 2.0 * mass * gravity,
            ..Tie::default()
        });
        let begin = |theta_dot| {
            let initial = Initial { theta_dot, ..Initial::default() };
            first_instant(plain.with_ties(&guys).unwrap(), initial).0.restraints().ties
        };
        assert_eq!(begin(0.0)[..2], [TieState::Taut; 2], "{reach} m, {foundation:?}");
        assert_eq!(begin(0.2)[..2], [TieState::Taut, TieState::Slack], "{reach} m, {foundation:?}");
    }
}

/// A pretension above the strength is refused, with the name of the tie.
#[test]
fn a_pretension_above_the_strength_is_refused() {
    let plain = block_on(Foundation::Viscoelastic, [0.25, 2.0, 40.0, 0.1], &Common::default());
    let tie = Tie { block: [0.0, 1.0], ground: [0.0, -1.0], stiffness: 2e5, pretension: 5000.0, ..Tie::default() };
    let damper = Tie { kind: LinkKind::Damper, pretension: 0.0, ..tie };
    let refused = |second: Tie| plain.with_ties(&[tie, damper, second]).map_err(|error| error.to_string());
    let error = refused(Tie { strength: 4999.0, ..tie }).unwrap_err();
    assert_eq!(error, "pretension of tie_2 = 5000 is not valid; expected a force (N) up to the strength");
    for second in [Tie { strength: 5000.0, ..tie }, Tie { stiffness: 2e3, ..tie }, Tie { yield_force: 1.0, ..tie }] {
        let block = refused(second).unwrap();
        let (run, seen) = first_instant(block, Initial::default());
        assert!(seen.v.is_finite() && seen.restraints.iter().all(|link| link.pull.is_finite()), "{seen:?}");
        assert!(run.restraints().ties[1] != TieState::Broken, "{second:?}");
    }
}

/// A link that yields or is broken at the beginning is reported there, once, and only there.
#[test]
fn links_that_yield_or_break_at_the_beginning_are_reported() {
    use TieEvent::{Break, Yield};
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = block_on(foundation, [0.2, 1.5, 60.0, 0.1], &Common::default());
        let Body { b, h, mass, gravity, .. } = plain.body;
        let tie = Tie { block: [0.0, h], ground: [-5.0 * b, h], stiffness: 0.5 * mass * gravity, ..Tie::default() };
        let damper = Tie { kind: LinkKind::Damper, ..tie };
        let [weak, brittle] = [1e-3, 2e-3].map(|part| part * mass * gravity * b);
        let links = [
            tie,
            Tie { yield_force: weak, ..tie },
            Tie { strength: brittle, ..tie },
            Tie { yield_force: weak, ..damper },
        ];
        let initial = Initial { theta: 0.1, ..Initial::default() };
        let (mut run, _) = first_instant(plain.with_ties(&links).unwrap(), initial);
        let mut events = Vec::new();
        for until in [1e-9, 2e-9] {
            run.advance(until, &Inputs::default(), &mut |event| events.push((event.kind, event.time))).unwrap();
        }
        // The block falls back from rest, so that the links unload at once.
        events.retain(|(kind, _)| !matches!(kind, EventKind::Restraint(RestraintEvent::Tie(_, _, TieEvent::Unload))));
        let tie = |kind, number, event| (EventKind::Restraint(RestraintEvent::Tie(kind, number, event)), 0.0);
        let expected = [tie(LinkKind::Tie, 1, Yield), tie(LinkKind::Tie, 2, Break), tie(LinkKind::Damper, 0, Yield)];
        assert_eq!(events, expected, "{foundation:?}");
    }
}

/// A soft tie whose pretension is far above its yield force and stretches it by kilometres yields with a constant force, from the start on.
#[test]
fn a_soft_tie_far_beyond_its_yield_force_yields_on() {
    let plain = block([0.25, 1.1013609019627575, 40.0, 0.1], &Common { mass: 1000.0, ..Common::default() });
    let tie = Tie {
        ground: [0.0, -2.646957107663824],
        stiffness: 0.004343788527091111,
        pretension: 116.24899475697869,
        yield_force: 1.1706410309158282,
        ..Tie::default()
    };
    let settings = Settings { tolerance: 1e-8, on_separation: OnSeparation::Fly, ..Settings::default() };
    let inputs = Inputs { a_gx: Ramp::held(4.644979040014527), ..Inputs::default() };
    let block = plain.with_ties(&[tie]).unwrap();
    let mut run = Simulation::new(block, settings, Pulse::NONE, &Initial::default(), 0.0, &inputs);
    for step in 1..=400 {
        run.advance(f64::from(step) * 0.000256, &inputs, &mut |_| ()).unwrap();
        let pull = run.observe(&inputs).restraints[0].pull;
        assert!((pull - tie.yield_force).abs() < 1e-2 * tie.yield_force, "{pull} N at {} s", run.time());
    }
}
