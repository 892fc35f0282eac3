//! Ties, dampers and friction of a block stepped from outside: its events, motion and energies are those of the block itself.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use rocking_block::block::restraints::RestraintEvent;
use rocking_block::block::restraints::tie::{LinkKind, MAX_TIES, TieEvent};

use super::*;
use crate::blocks::rigid;

/// A block, its pulse, its beginning, and the length of the run (s) with that of the importer's steps.
#[derive(Clone, Debug)]
struct Case {
    block: Block,
    pulse: Pulse,
    initial: Initial,
    end: f64,
    h: f64,
}

/// Runs a block by itself and by an importer's solver, and compares them.
fn compare(case: &Case) -> (Vec<Event>, Energies) {
    let Case { block, pulse, ref initial, end, h } = *case;
    let settings = Settings { tolerance: 1e-12, on_separation: OnSeparation::Fly, ..Settings::default() };
    let inputs = Inputs::default();
    let mut inside = Simulation::new(block, settings, pulse, initial, 0.0, &inputs);
    let mut outside = Outside::begin(&inside, inputs);
    let mut events = Vec::new();
    inside.advance(end, &inputs, &mut |event| events.push(*event)).unwrap();
    outside.go(end, h);
    let listed = |events: &[Event]| events.iter().map(|event| format!("\n    {event}")).collect::<String>();
    let lists = || format!("{case:?}\ninside:{}\noutside:{}", listed(&events), listed(&outside.events));
    let [expected, found] = [&events, &outside.events].map(|events| times_by_kind(&block, events));
    let same = |expected: &[f64], found: &[f64]| {
        expected.len() == found.len() && expected.iter().zip(found).all(|(a, b)| (a - b).abs() < INSTANT)
    };
    assert!(expected.keys().eq(found.keys()), "{}", lists());
    for (kind, times) in &expected {
        assert!(same(times, &found[kind]), "{kind}: {times:?}, not {:?} {}", found[kind], lists());
    }
    let theta = [&inside, &outside.simulation].map(|simulation| simulation.state()[0]);
    assert!((theta[0] - theta[1]).abs() < 1e-6 * block.alpha, "{theta:?} {}", lists());
    let [found, expected] = [&outside.simulation, &inside].map(Simulation::energies);
    let size = block.mass * block.gravity * block.r0 * block.alpha * block.alpha;
    for (found, expected) in [
        (found.restraints.ties, expected.restraints.ties),
        (found.restraints.dampers, expected.restraints.dampers),
        (found.friction, expected.friction),
        (found.residual, 0.0),
    ] {
        assert!((found - expected).abs() < 1e-6 * size, "{found} J, not {expected} J: {}", lists());
    }
    let close = |found: [f64; MAX_TIES], expected: [f64; MAX_TIES], share: f64| {
        let most = expected.iter().fold(0.0, |most: f64, peak| most.max(*peak));
        // Round-off takes a tie that is just taut to a pull of 1e-10 N.
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= share * most + 1e-9)
    };
    let [found, expected] = [&outside.simulation, &inside].map(Simulation::peaks);
    let is_close = close(found.pull, expected.pull, 1e-4) && close(found.plastic, expected.plastic, 1e-5);
    assert!(is_close, "{found:?}, not {expected:?}: {}", lists());
    (events, inside.energies())
}

/// Shortest time (s) between events that the importer's solver resolves. A link whose rate ṡ is next to zero turns back after ṡ/s̈, and the
/// error of the solver's velocities is some 1e-6 m/s.
const INSTANT: f64 = 5e-6;

/// Returns the events without those of links that stop. Whether a link without a rate unloads or stays at its yield force is decided by
/// round-off, and has no effect. One may unload and yield again in one instant, yield and unload in one as the block lands, or unload
/// - as the foot grips, in the rest that follows in full contact, or as this rest ends, and yield again later;
/// - at any time while the block turns about the corner on which the link ends: none of these count.
fn without_stops(block: &Block, events: &[Event]) -> Vec<Event> {
    let of_link = |event: &Event, wanted: TieEvent| match event.kind {
        EventKind::Restraint(RestraintEvent::Tie(kind, number, found)) if found == wanted => Some((kind, number)),
        _ => None,
    };
    let at_corner = |(kind, number): (LinkKind, u8)| {
        let mut links = block.restraints.ties.all().iter().filter(|link| link.kind == kind);
        links.nth(number.into()).is_some_and(|link| link.block[1] == 0.0 && link.block[0].abs() == block.b)
    };
    let ends_at_corner = |event: &Event| {
        let plastic = of_link(event, TieEvent::Yield).or(of_link(event, TieEvent::Unload));
        block.foundation == Foundation::Rigid && plastic.is_some_and(at_corner)
    };
    let mut left: Vec<Event> = events.iter().filter(|event| !ends_at_corner(event)).copied().collect();
    let together = |first: f64, second: f64| (first - second).abs() < INSTANT;
    // The speed of a foot grows from zero with the square of the time.
    const BEGINNING_OF_SLIP: f64 = 1e-4;
    let rests = |event: &Event| {
        let before = events.iter().filter(|other| other.time < event.time - BEGINNING_OF_SLIP);
        let last_of_foot = before.rev().find(|other| matches!(other.kind, EventKind::Grip | EventKind::Slip));
        event.after == Regime::FullContact && last_of_foot.is_some_and(|last| last.kind == EventKind::Grip)
    };
    let grips: Vec<f64> = events.iter().filter(|event| event.kind == EventKind::Grip).map(|event| event.time).collect();
    let mut i = 0;
    while i < left.len() {
        let next = |from: TieEvent, to: TieEvent| {
            let link = of_link(&left[i], from)?;
            (i..left.len()).find(|&j| of_link(&left[j], to) == Some(link))
        };
        let time = left[i].time;
        let unloads_at_once = next(TieEvent::Yield, TieEvent::Unload).filter(|&j| together(left[j].time, time));
        if let Some(unloads) = unloads_at_once {
            left.remove(unloads);
            left.remove(i);
            continue;
        }
        let again = next(TieEvent::Unload, TieEvent::Yield);
        let at_rest = grips.iter().any(|&grip| together(grip, time)) || rests(&left[i]);
        let stops = of_link(&left[i], TieEvent::Unload).is_some() && at_rest;
        if stops || again.is_some_and(|again| together(left[again].time, time)) {
            again.map(|again| left.remove(again));
            left.remove(i);
        } else {
            i += 1;
        }
    }
    left
}

/// Returns the times (s) of the events of each kind. Links on one pivot turn back together, and round-off decides which is first.
fn times_by_kind(block: &Block, events: &[Event]) -> std::collections::BTreeMap<String, Vec<f64>> {
    let mut times = std::collections::BTreeMap::<_, Vec<f64>>::new();
    for event in without_stops(block, events) {
        times.entry(format!("{:?}", event.kind)).or_default().push(event.time);
    }
    times
}

fn words(events: &[Event]) -> Vec<String> {
    events.iter().map(|event| event.to_string().split(": ").nth(1).unwrap().to_string()).collect()
}

/// A landing that turns the motion of a yielding damper back unloads it in that instant.
#[test]
fn a_landing_unloads_a_damper_that_yields() {
    let damper =
        Tie { ground: [0.0, -5.0], stiffness: 2e4, yield_force: 300.0, kind: LinkKind::Damper, ..Tie::default() };
    let block = rigid(0.25, 1.0, 0.0).with_ties(&[damper]).unwrap();
    let initial = Initial { theta: -0.2, ..Initial::default() };
    let (events, energies) = compare(&Case { block, pulse: Pulse::NONE, initial, end: 4.0, h: 1e-3 });
    let words = words(&events);
    let unloads_at_landing = |i: usize| {
        words[i].starts_with("damper 1 unloads")
            && !words[i - 1].starts_with("damper")
            && events[i - 1].time == events[i].time
    };
    assert!((1..events.len()).any(unloads_at_landing), "{words:?}");
    assert!(energies.restraints.dampers > 150.0, "{energies:?}");
}

/// The spring of a tie that breaks is lost, and its energy is counted.
#[test]
fn the_energy_of_a_tie_that_breaks_is_lost() {
    for kind in LinkKind::ALL {
        let tie =
            Tie { block: [-0.4, 1.0], ground: [-0.4, -1.0], stiffness: 2e4, strength: 300.0, kind, ..Tie::default() };
        for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
            let block = on(foundation, 0.25, 2.0, 40.0, 0.1).with_ties(&[tie]).unwrap();
            let initial = Initial { theta_dot: 0.4, ..Initial::default() };
            let (events, energies) = compare(&Case { block, pulse: Pulse::NONE, initial, end: 0.3, h: 2e-4 });
            assert!(words(&events).iter().any(|word| word.contains("breaks")), "{events:?}");
            let restraints::RestraintEnergies { ties, dampers } = energies.restraints;
            assert!((ties + dampers - 300.0 * 300.0 / (2.0 * 2e4)).abs() < 1e-9, "{energies:?}");
        }
    }
}

/// A damped tie that becomes taut with more than its strength breaks in that instant. Its strength is the peak of its pull.
#[test]
fn the_pull_of_a_tie_that_breaks_as_it_is_taut_is_a_peak() {
    let tie = Tie {
        block: [-0.5, 1.0],
        ground: [-0.5, -1.0],
        stiffness: 1e4,
        slack: 0.01,
        damping: 1e4,
        strength: 1000.0,
        ..Tie::default()
    };
    let block = on(Foundation::Rigid, 0.25, 2.0, 40.0, 0.1).with_ties(&[tie]).unwrap();
    let initial = Initial { theta_dot: 0.4, ..Initial::default() };
    let (events, _) = compare(&Case { block, pulse: Pulse::NONE, initial, end: 0.3, h: 2e-4 });
    let at = words(&events).iter().position(|word| word.contains("breaks")).unwrap();
    assert_eq!(events[at - 1].time, events[at].time, "{events:?}");
}

prop_compose! {
    fn link(b: f64, h: f64, weight: f64)(
        damper in any::<bool>(),
        side in prop_oneof![Just(-1.0), Just(1.0), Just(0.5)],
        up in prop_oneof![Just(0.0), Just(1.0)],
        deep in 0.3..3.0_f64,
        stiffness in 2.0..40.0,
        yields in prop_oneof![Just(0.0_f64), 0.02..0.2],
        hardening in prop_oneof![Just(0.0), 0.0..0.3],
        strength in prop_oneof![3 => Just(0.0), 1 => 0.1..0.6],
        damping in prop_oneof![Just(0.0), 0.01..0.3],
        // A tie that is just taut at rest is so in each landing, and round-off decides whether it is slack before.
        (pretension, slack) in prop_oneof![(0.01..0.1_f64, 0.0..=0.0), (0.0..1e-300, 0.001..=0.02)],
    ) -> Tie {
        let kind = if damper { LinkKind::Damper } else { LinkKind::Tie };
        let of_tie = |number: f64| if damper { 0.0 } else { number };
        Tie {
            block: [side * b, up * h],
            ground: [side * b, -deep * h],
            stiffness: stiffness * weight / h,
            yield_force: yields * weight,
            hardening,
            strength: strength * weight,
            damping: damping * weight / h,
            // A tie that is beyond its yield force at rest yields at once.
            pretension: of_tie(if yields > 0.0 { pretension.min(0.8 * yields) } else { pretension }) * weight,
            slack: of_tie(slack) * h,
            kind,
        }
    }
}

prop_compose! {
    fn cases()(
        rigid in any::<bool>(),
        [alpha, p, eta, xi_v] in [0.15..0.35_f64, 1.0..3.0, 15.0..50.0, 0.05..0.4],
        friction in prop_oneof![2 => Just(0.0), 1 => 0.2..0.5],
        amplitude in 1.1..3.0,
        period in 0.2..0.8_f64,
        count in 1..4_usize,
        shape in prop_oneof![Just(PulseShape::OneSine), Just(PulseShape::OneCosine), Just(PulseShape::C1)],
    )(
        links in {
            let block = on(if rigid { Foundation::Rigid } else { Foundation::Viscoelastic }, alpha, p, eta, xi_v);
            prop::collection::vec(link(block.b, block.h, block.mass * block.gravity), count)
        },
        rigid in Just(rigid),
        numbers in Just([alpha, p, eta, xi_v, friction, amplitude, period]),
        shape in Just(shape),
    ) -> Case {
        let [alpha, p, eta, xi_v, friction, amplitude, period] = numbers;
        let foundation = if rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
        let mut block = on(foundation, alpha, p, eta, xi_v).with_ties(&links).unwrap();
        block.body.friction = friction;
        let period = 2.0 * std::f64::consts::PI / p * period;
        let amplitude = block.gravity * alpha.tan() * amplitude;
        let pulse = Pulse { shape, amplitude, period, start: 0.0, ..Pulse::NONE };
        Case { block, pulse, initial: Initial::default(), end: 1.0 / p + period, h: 4e-4 / p }
    }
}

/// Random blocks with friction and links that yield and break have the events, motion and energies of Co-Simulation.
#[test]
fn random_blocks_with_links_and_friction_have_the_events_of_the_block_itself() {
    let (config, mut seen) = (crate::cases::cases(60), std::collections::BTreeMap::<String, u32>::new());
    let (count, mut runner) = (config.cases, TestRunner::new(config));
    for number in 0..count {
        let case = cases().new_tree(&mut runner).unwrap().current();
        println!("case {number}");
        for event in compare(&case).0 {
            *seen.entry(event.kind.word().into()).or_default() += 1;
        }
    }
    for word in ["landing", "slip", "grip", "taut", "slack", "yield", "unload", "break"] {
        assert!(seen.get(word).is_some_and(|count| *count >= 5), "{word}: {seen:?}");
    }
}
