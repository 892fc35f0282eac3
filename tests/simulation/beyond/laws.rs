//! Random blocks with ties, dampers, friction and uneven bodies: force laws, yield surfaces, events whatever the communication step.
//!
//! The number of a case determines it, and `HARSH_FIRST` is the first one.

use rocking_block::block::restraints::{LinkKind, ObservedRestraint, RestraintEvent, Tie, tie::TieEvent};
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use super::random_number;

/// Returns the numbers of `count` cases.
fn numbers(count: u64) -> std::ops::Range<u64> {
    let first = std::env::var("HARSH_FIRST").map_or(0, |given| given.parse().expect("a whole number"));
    first..first + count
}

/// The parts of a random block beside its ties.
#[derive(Clone, Copy)]
struct Parts {
    /// Whether it has dampers, friction, and an eccentric centre of mass.
    everything: bool,
    /// Whether its ties have no pretension and no slack, so that they are just taut at rest.
    just_taut: bool,
}

/// Returns a random block with ties, and a pulse under which it rocks.
fn random_block(case: u64, parts: Parts) -> (Block, Pulse) {
    let mut seed = case.wrapping_mul(0xD134_2543_DE82_EF95);
    let mut draw = |low: f64, high: f64| low + (high - low) * random_number(&mut seed);
    let mut one_of = |first: f64, second: f64, fraction: f64| if draw(0.0, 1.0) < fraction { first } else { second };
    let rigid = one_of(1.0, 0.0, 0.5) > 0.0;
    let [slides, uneven] = [0.4, 0.5].map(|fraction| parts.everything && one_of(1.0, 0.0, fraction) > 0.0);
    let foundation = if rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
    let ratios = Ratios { eta: draw(20.0, 100.0), xi_v: draw(0.0, 0.4) };
    let dimensionless =
        Dimensionless { alpha: draw(0.1, 0.35), p: draw(0.5, 3.0), supports: Supports::of(foundation, ratios) };
    let common = Common { epsilon: draw(0.0, 0.4), ..Common::default() };
    let plain = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let friction = if slides { draw(0.2, 0.9) } else { 0.0 };
    let common = Common { friction, eccentricity: if uneven { draw(-0.2, 0.2) * plain.b } else { 0.0 }, ..common };
    let (b, h, weight) = (plain.b, plain.h, plain.mass * plain.gravity);
    let links: Vec<Tie> = (0..if parts.everything { 4 } else { 2 })
        .map(|i| {
            let kind = if parts.everything && i % 2 == 1 { LinkKind::Damper } else { LinkKind::Tie };
            let x = draw(-1.0, 1.0) * b;
            let mut sometimes = |fraction: f64, low: f64, high: f64| {
                let number = draw(low, high);
                if draw(0.0, 1.0) < fraction { number } else { 0.0 }
            };
            let is_tie = kind == LinkKind::Tie && !parts.just_taut;
            let tie = Tie {
                damping: sometimes(0.7, 0.01, 0.3) * weight / (plain.p * b),
                pretension: if is_tie { sometimes(0.5, 0.0, 0.1) * weight } else { 0.0 },
                slack: if is_tie { sometimes(0.3, 0.0, 0.05) * b } else { 0.0 },
                yield_force: sometimes(0.8, 0.02, 0.3) * weight,
                hardening: sometimes(0.8, 0.0, 0.7),
                strength: sometimes(0.2, 0.5, 1.5) * weight,
                kind,
                ..Tie::default()
            };
            Tie {
                block: [x, draw(0.0, 2.0) * h],
                ground: [x + draw(-0.5, 0.5) * b, -draw(0.3, 1.0) * h],
                stiffness: draw(0.5, 10.0) * weight / b,
                ..tie
            }
        })
        .collect();
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap().with_ties(&links).unwrap();
    let pulse = Pulse {
        // A jump sets just taut ties in motion at once; under a sine they would leave zero unseen for a while.
        shape: if parts.just_taut { PulseShape::OneCosine } else { PulseShape::OneSine },
        amplitude: draw(0.8, 4.0) * block.gravity * libm::tan(block.alpha),
        period: draw(1.0, 8.0) / block.p,
        start: 0.1,
        ..Pulse::NONE
    };
    (block, pulse)
}

/// Begins a run that flies on.
fn begin(block: Block, pulse: Pulse, tolerance: f64) -> Simulation {
    let settings = Settings { tolerance, on_separation: OnSeparation::Fly, ..Settings::default() };
    Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &Inputs::default())
}

/// The spring of each link stays within its yield surface, `|k (s − s_p) − h s_p| ≤ F_y`, of a tie with the force of a spring that never
/// pushes; no tie pushes; and no pull of a spring that is stretched jumps at an event of links, except where one breaks.
#[test]
fn links_keep_to_their_laws() {
    const ROWS: u32 = 400;
    let inputs = Inputs::default();
    let (mut yields, mut limp, mut worst) = (0, 0, [0.0_f64; 2]);
    for case in numbers(400) {
        let (block, pulse) = random_block(case, Parts { everything: true, just_taut: false });
        let weight = block.mass * block.gravity;
        let mut run = begin(block, pulse, 1e-9);
        let check = |run: &Simulation, worst: &mut f64, limp: &mut u32| {
            for (link, seen) in block.ties().iter().zip(run.observe(&inputs).restraints) {
                let Tie { stiffness, hardening, yield_force, strength, damping, kind, .. } = *link;
                let elastic = stiffness * (seen.elongation - seen.plastic);
                let spring = if kind == LinkKind::Tie { elastic.max(0.0) } else { elastic };
                let beyond = (spring - stiffness * hardening / (1.0 - hardening) * seen.plastic).abs() - yield_force;
                let breaks = strength > 0.0 && seen.pull == 0.0;
                if yield_force > 0.0 && !breaks {
                    *worst = worst.max(beyond / weight);
                    assert!(beyond < 1e-9 * weight, "case {case}, t = {}: {link:?} {seen:?}", run.time());
                }
                let pushes = kind == LinkKind::Tie && seen.pull < 0.0;
                assert!(!pushes, "case {case}, t = {}: {link:?} {seen:?}", run.time());
                *limp += u32::from(kind == LinkKind::Tie && damping > 0.0 && spring > 0.0 && seen.pull == 0.0);
            }
        };
        for row in 1..=ROWS {
            let until = 6.0 / block.p * f64::from(row) / f64::from(ROWS);
            loop {
                let before = run.observe(&inputs).restraints;
                let (mut kinds, time) = (Vec::new(), run.time());
                run.apply_pending_event(&inputs, &mut |event: &Event| kinds.push(event.kind)).unwrap();
                let smooth = |kind: &EventKind| match kind {
                    EventKind::Restraint(RestraintEvent::Tie(_, _, event)) => *event != TieEvent::Break,
                    _ => false,
                };
                if !kinds.is_empty() && kinds.iter().all(smooth) {
                    let after = run.observe(&inputs).restraints;
                    // The dashpot of a slack tie takes hold where the spring does.
                    let held = |link: &ObservedRestraint| (link.elongation - link.plastic).abs() > 1e-9 * block.b;
                    let links = before.iter().zip(&after).filter(|(before, _)| held(before));
                    let jump = links.map(|(before, after)| (after.pull - before.pull).abs()).fold(0.0, f64::max);
                    worst[1] = worst[1].max(jump / weight);
                    assert!(jump < 1e-8 * weight, "case {case}, t = {time}: {kinds:?}, {jump} N");
                    yields +=
                        u32::from(matches!(kinds[0], EventKind::Restraint(RestraintEvent::Tie(_, _, TieEvent::Yield))));
                }
                check(&run, &mut worst[0], &mut limp);
                match run.advance_to_event(until, run.time(), &inputs, &mut |_| ()).unwrap() {
                    Some(Progress::Ended(..)) => break,
                    Some(Progress::Reached) if run.time() >= until => break,
                    Some(Progress::Reached) | None => {}
                }
            }
            check(&run, &mut worst[0], &mut limp);
            if run.ending().is_some() {
                break;
            }
        }
    }
    println!(
        "{yields} yields, {limp} limp ties, beyond by at most {:.1e} of the weight, jumps of {:.1e}",
        worst[0], worst[1]
    );
    assert!(yields > 400 && limp > 400, "{yields} {limp}");
}

/// Impacts and the rotation at the end of blocks with ties do not depend on the communication step. The ties are just taut at rest, so that
/// landings leave them at zero; whether such a tie goes slack before a landing in the same instant is decided by round-off.
#[test]
fn events_of_ties_do_not_depend_on_the_communication_step() {
    let inputs = Inputs::default();
    let mut of_links = 0;
    for case in numbers(150) {
        let (block, pulse) = random_block(case, Parts { everything: false, just_taut: true });
        let end = 4.0 / block.p;
        let mut random = case;
        // From one part to 8,191 of them, as many below 90 as above.
        let parts = 8191_f64.powf(random_number(&mut random)).round();
        let [(events, state), (others, state_of_other)] = [1.0, parts].map(|parts| {
            let mut run = begin(block, pulse, 1e-11);
            let mut events: Vec<(EventKind, f64)> = Vec::new();
            for i in 1..=parts as u32 {
                let until = end * f64::from(i) / parts;
                run.advance(until, &inputs, &mut |event| events.push((event.kind, event.time))).unwrap();
            }
            (events, *run.state())
        });
        of_links += events.iter().filter(|(kind, _)| matches!(kind, EventKind::Restraint(_))).count();
        let away = (state[0] - state_of_other[0]).abs() / block.alpha;
        let [events, others] = [events, others].map(|mut events| {
            events.retain(|(kind, _)| !matches!(kind, EventKind::Restraint(_)));
            events
        });
        let differs = events.iter().zip(&others).find(|(a, b)| a.0 != b.0 || (a.1 - b.1).abs() * block.p > 1e-5);
        let counts = [events.len(), others.len()];
        assert!(differs.is_none() && counts[0] == counts[1], "case {case}: {differs:?}, {counts:?}");
        assert!(away < 1e-7, "case {case}: {away} α");
    }
    assert!(of_links > 1000, "{of_links}");
}

/// An uneven block with two dampers; one yields and breaks. R lands, L lifts, and an impulse that stops R would lift it: R slides until it
/// is pressed on, as with any great friction.
#[test]
fn a_corner_that_its_stop_would_lift_slides() {
    let motion = |friction: f64| {
        let link = |block, ground, stiffness, yield_force, damping, strength| Tie {
            block,
            ground,
            stiffness,
            yield_force,
            damping,
            strength,
            hardening: 0.6,
            kind: LinkKind::Damper,
            ..Tie::default()
        };
        let links = [
            link(
                [-21.70793021083208, 82.92578918941244],
                [-25.83859116362712, -42.74865722998402],
                0.3059351427933851,
                1.131028992505571,
                1.6648973589327059,
                5.852773989603603,
            ),
            link(
                [34.92541017065152, 0.0],
                [29.948842287806553, -31.15947705982342],
                0.17218872317909334,
                4.118745593424238,
                0.0,
                0.0,
            ),
        ];
        let common = Common { mass: 1.0, gamma: 2.0, eccentricity: -9.349001014224582, friction, ..Common::default() };
        let ratios = Ratios { eta: 15.206430647959293, xi_v: 0.3 };
        let supports = Supports::of(Foundation::Viscoelastic, ratios);
        let dimensionless = Dimensionless { alpha: 0.5735561591696126, p: 0.3332243347561277, supports };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap().with_ties(&links).unwrap();
        let pulse =
            Pulse { shape: PulseShape::OneSine, amplitude: 32.406461155942, period: 4.303538729352013, ..Pulse::NONE };
        let settings = Settings { tolerance: 1e-10, ..Settings::default() };
        let inputs = Inputs::default();
        let mut run = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
        let progress = run.advance(10.0, &inputs, &mut |_| ());
        assert_eq!(progress, Ok(Progress::Reached), "μ = {friction}");
        assert!(run.energies().residual.abs() < 1e-8, "μ = {friction}: {:?}", run.energies());
        (run.state()[0], run.counts())
    };
    let (without_limit, great) = (motion(0.0), motion(999.0));
    assert!((without_limit.0 - great.0).abs() < 1e-8, "{without_limit:?}, {great:?}");
    // As a user writes "no limit": it costs nothing, where sliding under it takes two million steps in a millisecond.
    assert_eq!(motion(1e6), without_limit);
}
